//! Turning both directions about the normal changes nothing.

use super::Examination;
use crate::specimen::{Direction, Measure};
use crate::survey::draw;
use crate::verdict::{Check, Ledger};

/// Samples per setting, where peaked lobes have their values.
const SAMPLES: usize = 32;
/// Angle \[rad\] of the turns; no two of them differ by a symmetry that a lobe might have.
const TURNS: [f64; 3] = [0.7, 1.9, 4.1];

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    for setting in examination.settings() {
        let (wo, transport) = (setting.wo, setting.transport);
        let mut generator = examination.plan.generator(&examination.name, &setting, "isotropic");
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(scatter) = scatter else { return };
            let wi = scatter.wi;
            let witness = setting.witness().with_wi(wi).with_uniforms(uniforms);
            // Density and the three channels of f, or probability and weights of a delta.
            let values = |wo: Direction, wi: Direction| -> [f64; 4] {
                if let Measure::SolidAngle(_) = scatter.density {
                    let [r, g, b] = specimen.eval(wo, wi, transport);
                    return [specimen.pdf(wo, wi, transport), r, g, b];
                }
                let delta = specimen.sample(wo, uniforms, transport);
                delta.map_or([0.0; 4], |delta| {
                    let (Measure::SolidAngle(density) | Measure::Discrete(density)) = delta.density;
                    let [r, g, b] = delta.weight;
                    [density, r, g, b]
                })
            };
            let here = values(wo, wi);
            // Both directions are rounded anew.
            let of_wi = examination.rounding_errors(wi, here, |w| values(wo, w));
            let of_wo = examination.rounding_errors(wo, here, |w| values(w, wi));
            for angle in TURNS {
                let there = values(turned(wo, angle), turned(wi, angle));
                for i in 0..4 {
                    let allowed = 2.0 * (of_wi[i] + of_wo[i]);
                    let what = "pdf or f [1/sr], or a delta, after a turn about the normal";
                    ledger.record(Check::new(what, (there[i] - here[i]).abs(), allowed, witness));
                }
            }
        });
    }
}

fn turned([x, y, z]: Direction, angle: f64) -> Direction {
    let (sin, cos) = libm::sincos(angle);
    [cos * x - sin * y, sin * x + cos * y, z]
}

//! Turning both directions about the normal changes nothing.

use super::Examination;
use crate::specimen::{Direction, Measure, Scatter};
use crate::survey::draw;
use crate::verdict::{Check, Ledger};

/// Samples per setting, where peaked lobes have their values.
const SAMPLES: usize = 64;
/// Angle \[rad\] of the turns; no two of them differ by a symmetry that a lobe might have.
const TURNS: [f64; 3] = [0.7, 1.9, 4.1];

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    for setting in examination.settings() {
        let (wo, transport) = (setting.wo, setting.transport);
        let mut generator = examination.plan.generator(&examination.name, &setting, "isotropic");
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(Scatter { wi, density: Measure::SolidAngle(_), .. }) = scatter else { return };
            let witness = setting.witness().with_wi(wi).with_uniforms(uniforms);
            let pdf = |w: Direction| specimen.pdf(wo, w, transport);
            let value = |w: Direction| specimen.eval(wo, w, transport)[0];
            for angle in TURNS {
                let (turned_wo, turned_wi) = (turned(wo, angle), turned(wi, angle));
                let difference = (specimen.pdf(turned_wo, turned_wi, transport) - pdf(wi)).abs();
                // Both directions were rounded anew.
                let allowed = 2.0 * examination.rounding_error(wi, pdf(wi), pdf) + f64::MIN_POSITIVE;
                ledger.record(Check::new(
                    "pdf [1/sr] after a turn about the normal",
                    difference,
                    allowed,
                    witness,
                ));
                let difference = (specimen.eval(turned_wo, turned_wi, transport)[0] - value(wi)).abs();
                let allowed = 2.0 * examination.rounding_error(wi, value(wi), value) + f64::MIN_POSITIVE;
                ledger.record(Check::new(
                    "f [1/sr] after a turn about the normal",
                    difference,
                    allowed,
                    witness,
                ));
            }
        });
        // Deltas have no densities to compare, but each setting counts as examined.
        ledger.record(Check::new("turns about the normal", 0.0, 0.0, setting.witness()));
    }
}

fn turned([x, y, z]: Direction, angle: f64) -> Direction {
    let (sin, cos) = libm::sincos(angle);
    [cos * x - sin * y, sin * x + cos * y, z]
}

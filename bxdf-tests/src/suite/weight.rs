//! `sample`, `eval` and `pdf` say the same, pointwise.

use super::{Examination, moved, normalized, tangents};
use crate::deltas::{Delta, Deltas, MOST_DELTAS};
use crate::plan::Setting;
use crate::specimen::{Direction, Measure, Transport};
use crate::survey::draw;
use crate::verdict::{Check, Ledger};

/// Samples per setting.
const SAMPLES: usize = 512;

/// Move \[rad\] away from a delta that a continuous density does not notice.
const BESIDE: f64 = 1e-6;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let epsilon = claims.precision.epsilon();
    // Both modes, also where nothing is transmitted: they must then agree with the same `eval` and `pdf`.
    for (setting, transport) in examination.settings().into_iter().flat_map(|setting| {
        [Transport::Radiance, Transport::Importance].map(|transport| (setting, transport))
    }) {
        if claims.transmits && setting.transport != transport {
            continue;
        }
        let setting = Setting { transport, ..setting };
        let wo = setting.wo;
        let mut generator = examination.plan.generator(&examination.name, &setting, "weight");
        let mut deltas = Deltas::new(claims.precision);
        let mut one_too_many = 0;
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(scatter) = scatter else { return };
            let wi = scatter.wi;
            let witness = setting.witness().with_wi(wi).with_uniforms(uniforms);
            let crossed = wo[2] * wi[2] < 0.0 && !claims.transmits;
            let what = "a sample on the other side, which is not claimed";
            ledger.record(Check::new(what, f64::from(crossed), 0.0, witness));
            if wo[2] * wi[2] > 0.0 {
                let what = "index that a reflection reports, against 1";
                ledger.record(Check::new(what, (scatter.eta - 1.0).abs(), 0.0, witness));
            }
            let pdf = |w: Direction| specimen.pdf(wo, w, transport);
            let f_cos = |w: Direction| specimen.eval(wo, w, transport).map(|f| f * w[2].abs());
            match scatter.density {
                Measure::SolidAngle(reported) => {
                    let expected = pdf(wi);
                    let allowed = examination.rounding_error(wi, expected, pdf);
                    let what = "reported density against pdf [1/sr]";
                    ledger.record(Check::new(what, (reported - expected).abs(), allowed, witness));
                    for channel in 0..3 {
                        let expected = f_cos(wi)[channel];
                        let allowed = examination.rounding_error(wi, expected, |w| f_cos(w)[channel])
                            + scatter.weight[channel] * allowed;
                        let error = (scatter.weight[channel] * reported - expected).abs();
                        // An infinite weight would allow itself.
                        let error = if allowed.is_finite() { error } else { f64::NAN };
                        ledger.record(Check::new(
                            "weight · pdf against f · |cos θi|",
                            error,
                            allowed,
                            witness,
                        ));
                    }
                }
                Measure::Discrete(probability) => {
                    // Beside the delta a continuous part is what it is at the delta; the delta itself has no density.
                    let highest = |w: Direction| f_cos(w).into_iter().fold(pdf(w), f64::max);
                    let beside = tangents(wi).map(|axis| highest(normalized(moved(wi, axis, BESIDE))));
                    let limit = 2.0 * beside[0].max(beside[1]);
                    let what = "density or f cos [1/sr] at a delta, against twice that beside it";
                    ledger.record(Check::new(what, highest(wi), limit, witness));
                    let excess = probability - 1.0;
                    ledger.record(Check::new(
                        "probability of a delta above 1",
                        excess,
                        4.0 * epsilon,
                        witness,
                    ));
                    if deltas.find_or_add(Delta { scatter, probability }).is_none() {
                        one_too_many = 1;
                    }
                }
            }
        });
        // Every sampler gets a check, one that returns nothing too.
        let (count, most) = ((deltas.len() + one_too_many) as f64, MOST_DELTAS as f64);
        ledger.record(Check::new("deltas of one direction", count, most, setting.witness()));
    }
}

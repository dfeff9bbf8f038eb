//! `sample`, `eval` and `pdf` say the same, pointwise.

use super::Examination;
use crate::specimen::{Measure, Scatter};
use crate::survey::draw;
use crate::verdict::{Check, Ledger};

/// Samples per setting.
const SAMPLES: usize = 512;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let epsilon = claims.precision.epsilon();
    for setting in examination.settings() {
        let (wo, transport) = (setting.wo, setting.transport);
        let mut generator = examination.plan.generator(&examination.name, &setting, "weight");
        let mut deltas: Vec<(Scatter, f64)> = Vec::new();
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |scatter| {
            let Some(scatter) = scatter else { return };
            let wi = scatter.wi;
            let witness = setting.witness().with_wi(wi);
            let pdf = specimen.pdf(wo, wi, transport);
            let f = specimen.eval(wo, wi, transport);
            match scatter.density {
                Measure::SolidAngle(reported) => {
                    let density = |w| specimen.pdf(wo, w, transport);
                    let allowed = examination.rounding_error(wi, pdf, density);
                    let what = "reported density against pdf [1/sr]";
                    ledger.record(Check::new(what, (reported - pdf).abs(), allowed, witness));
                    for channel in 0..3 {
                        let g = |w| specimen.eval(wo, w, transport)[channel] * w[2].abs();
                        let expected = f[channel] * wi[2].abs();
                        let allowed = examination.rounding_error(wi, expected, g)
                            + scatter.weight[channel] * allowed
                            + f64::MIN_POSITIVE;
                        let error = (scatter.weight[channel] * reported - expected).abs();
                        ledger.record(Check::new(
                            "weight · pdf against f · |cos θi|",
                            error,
                            allowed,
                            witness,
                        ));
                    }
                }
                Measure::Discrete(probability) => {
                    let density = f.into_iter().fold(pdf, f64::max);
                    ledger.record(Check::new("eval or pdf at a delta", density, 0.0, witness));
                    let excess = probability - 1.0;
                    ledger.record(Check::new(
                        "probability of a delta above 1",
                        excess,
                        4.0 * epsilon,
                        witness,
                    ));
                    let same = |(known, _): &&(Scatter, f64)| {
                        (0..3).all(|i| (known.wi[i] - wi[i]).abs() <= 16.0 * epsilon)
                    };
                    if let Some((known, first)) = deltas.iter().find(same) {
                        let difference = (0..3)
                            .map(|i| (known.weight[i] - scatter.weight[i]).abs())
                            .fold((first - probability).abs(), f64::max);
                        let what = "a delta reports different probabilities or weights";
                        ledger.record(Check::new(what, difference, 16.0 * epsilon, witness));
                    } else {
                        deltas.push((scatter, probability));
                    }
                }
            }
        });
        // Every sampler gets a check, one that returns nothing too.
        ledger.record(Check::new("deltas of one direction", deltas.len() as f64, 8.0, setting.witness()));
    }
}

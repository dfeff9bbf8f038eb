//! `sample`, `eval` and `pdf` say the same, pointwise.

use super::{Examination, moved, normalized, tangents};
use crate::deltas::{Delta, Deltas, MOST_DELTAS};
use crate::plan::Setting;
use crate::search::{Effort, search, setting, uniform};
use crate::specimen::{Direction, Measure, Scatter, Transport};
use crate::survey::draw;
use crate::verdict::{Check, Ledger};

/// Samples per setting.
const SAMPLES: usize = 256;

/// Move \[rad\] away from a delta that a continuous density does not notice.
const BESIDE: f64 = 1e-6;

/// Of the adversarial search.
const EFFORT: Effort = Effort { sweep: 2048, starts: 3, steps: 200 };
/// The lowest cosine that is searched, over the distance of two numbers about 1. Below it a move by 16 ε tilts the half
/// vector by more than 1e-3, and the rounding of a direction alone decides whether it lies in a narrow lobe.
const GRAZING: f64 = 8e3;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    // Both modes, also where nothing is transmitted: they must then agree with the same `eval` and `pdf`.
    for (setting, transport) in examination.settings().into_iter().flat_map(|setting| {
        [Transport::Radiance, Transport::Importance].map(|transport| (setting, transport))
    }) {
        if claims.transmits && setting.transport != transport {
            continue;
        }
        let setting = Setting { transport, ..setting };
        let mut generator = examination.plan.generator(&examination.name, &setting, "weight");
        let mut deltas = Deltas::new(claims.precision);
        let mut one_too_many = 0;
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLES, |uniforms, scatter| {
            let Some(scatter) = scatter else { return };
            compare(examination, ledger, &setting, uniforms, &scatter);
            let delta = Delta::of(scatter);
            if delta.is_some_and(|delta| deltas.find_or_add(delta).is_none()) {
                one_too_many = 1;
            }
        });
        // Every sampler gets a check, one that returns nothing too.
        let (count, most) = ((deltas.len() + one_too_many) as f64, MOST_DELTAS as f64);
        ledger.record(Check::new("deltas of one direction", count, most, setting.witness()));
    }
    search(examination, ledger, "weight", EFFORT, |examination, ledger, [a, b, c, u, v, w]| {
        let precision = examination.claims.precision;
        let setting = setting(&examination.claims, [a, b, c], GRAZING * precision.epsilon());
        let uniforms = [u, v, w].map(|u| uniform(u, precision));
        if let Some(scatter) = examination.specimen.sample(setting.wo, uniforms, setting.transport)
            && is_resolved(examination, &setting, &scatter)
        {
            compare(examination, ledger, &setting, uniforms, &scatter);
        }
        0.0
    });
}

/// Whether rounding changes the density by no more than a tenth: where a lobe is narrower, the moves that measure the
/// condition step over it, and a search would find nothing else.
fn is_resolved(examination: &Examination<'_>, setting: &Setting, scatter: &Scatter) -> bool {
    let Measure::SolidAngle(reported) = scatter.density else { return true };
    let pdf = |w: Direction| examination.specimen.pdf(setting.wo, w, setting.transport);
    let expected = pdf(scatter.wi);
    let rounding = examination.rounding_error(scatter.wi, expected, pdf);
    // What is not a number goes on to the comparison.
    rounding.is_nan() || expected.is_nan() || rounding <= 0.1 * expected.max(reported)
}

/// What one sample says, against `eval` and `pdf`.
pub(super) fn compare(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    setting: &Setting,
    uniforms: [f64; 3],
    scatter: &Scatter,
) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    let (wo, transport, wi) = (setting.wo, setting.transport, scatter.wi);
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
            let [bending] = examination.refraction_errors(wo, scatter, [expected], |w| [pdf(w)]);
            let allowed = examination.rounding_error(wi, expected, pdf) + bending;
            let what = "reported density against pdf [1/sr]";
            ledger.record(Check::new(what, (reported - expected).abs(), allowed, witness));
            let expected = f_cos(wi);
            let rounding = examination.rounding_errors(wi, expected, f_cos);
            let bending = examination.refraction_errors(wo, scatter, expected, f_cos);
            for channel in 0..3 {
                let weight = scatter.weight[channel];
                let allowed = rounding[channel] + bending[channel] + weight * allowed;
                let error = (weight * reported - expected[channel]).abs();
                // An infinite weight would allow itself.
                let error = if allowed.is_finite() { error } else { f64::NAN };
                ledger.record(Check::new("weight · pdf against f · |cos θi|", error, allowed, witness));
            }
        }
        Measure::Discrete(probability) => {
            // Beside the delta a continuous part is what it is at the delta; the delta itself has no density.
            let highest = |w: Direction| f_cos(w).into_iter().fold(pdf(w), f64::max);
            // Either way, because at grazing angles one of them leads below the horizon.
            let beside = |axis, step| highest(normalized(moved(wi, axis, step)));
            let limit = tangents(wi)
                .into_iter()
                .flat_map(|axis| [BESIDE, -BESIDE].map(|step| 2.0 * beside(axis, step)))
                .fold(0.0, f64::max);
            let what = "density or f cos [1/sr] at a delta, against twice that beside it";
            ledger.record(Check::new(what, highest(wi), limit, witness));
            let excess = 4.0 * claims.precision.epsilon();
            ledger.record(Check::new("probability of a delta above 1", probability - 1.0, excess, witness));
        }
    }
}

//! The density, the deltas and the probability of no sample make one; 1 / pdf of samples averages to solid angles.

use super::{Examination, PValue};
use crate::statistics::{detectable_mean, detectable_rate, ln_binomial_two_sided, ln_mean_two_sided};
use crate::survey::{SolidAngle, Survey, Tally, is_resolved, slack};
use crate::verdict::{Check, Ledger};

/// Error of the mass above which nothing is said about it.
const WORST_ERROR: f64 = 0.01;
/// Mass that samples cannot miss by chance.
const NEVER: f64 = 0.01;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let precision = examination.claims.precision;
    for surveyed in examination.surveys() {
        let decisive = examination.decisive(surveyed, ledger, |survey| {
            let [none, error] = survey.no_sample(precision);
            -none <= error
        });
        let [none, error] = decisive.no_sample(precision);
        let witness = surveyed.setting.witness();
        let mut mass = Check::new("mass of the pdf and the deltas above 1", -none, error, witness);
        mass.inconclusive = (error > WORST_ERROR).then_some("the integral of the pdf does not converge");
        ledger.record(mass);
        if let Some(tally) = &surveyed.tally {
            let never = tally.none == tally.samples && 1.0 - none - error > NEVER;
            let what = "`sample` never returned a direction; ∫ pdf + Σ delta masses";
            ledger.record(Check::new(what, if never { 1.0 - none } else { 0.0 }, 0.0, witness));
        }
        examination.judge(surveyed, ledger, |survey, tally| p_values(examination, survey, tally));
    }
    if let Some(setting) = examination.plan.left_out(&examination.claims) {
        let subject = (examination.specimen, examination.name());
        let is_needless = is_resolved(subject, precision, examination.plan, &setting);
        let what = "a direction that `least_cosine` leaves out although the precision resolves the lobe";
        let value = if is_needless { 1.0 } else { 0.0 };
        ledger.record(Check::new(what, value, 0.0, setting.witness()));
    }
}

/// The rate of no sample and the solid-angle identity.
pub(super) fn p_values(examination: &Examination<'_>, survey: &Survey, tally: &Tally) -> Vec<PValue> {
    let [none, error] = survey.no_sample(examination.claims.precision);
    let ln_p = if none.is_nan() {
        f64::NAN
    } else {
        ln_binomial_two_sided(tally.none, tally.samples, none - error, none + error)
    };
    let what = "an error of the probability of no sample, absolute,";
    let detectable =
        examination.detectable(what, |ln_level, samples| detectable_rate(ln_level, none, error, samples));
    let what = "-log10 p that the rate of no sample is what the pdf leaves";
    let samples = tally.samples;
    let rate =
        PValue { what, ln_p, samples, cells: None, detectable, inconclusive: None, wants_samples: false };
    vec![rate, solid_angle(examination, survey, tally)]
}

/// See [`crate::survey::SolidAngle`].
fn solid_angle(examination: &Examination<'_>, survey: &Survey, tally: &Tally) -> PValue {
    let SolidAngle { mean, second_moment, largest, .. } = survey.solid_angle;
    // Part of a cell where the pdf is 0 may lie between all nodes.
    let slack = slack(examination.claims.precision);
    let range = largest.max(tally.largest_inverse);
    let deviation = (second_moment - mean * mean).max(0.0).sqrt();
    let found = tally.inverse / tally.samples as f64;
    let ln_p = if found.is_nan() {
        f64::NAN
    } else {
        let difference = ((found - mean).abs() - slack).max(0.0);
        ln_mean_two_sided(difference, deviation, range, tally.samples as f64)
    };
    let what = "a variance of the density inside cells, over its square,";
    let detectable = if mean > 0.0 {
        examination.detectable(what, |ln_level, samples| {
            (2.0 * slack + detectable_mean(ln_level, deviation, range, samples)) / mean
        })
    } else {
        None
    };
    let what = "-log10 p that 1 / pdf of the samples averages to the solid angle";
    let samples = tally.samples;
    PValue { what, ln_p, samples, cells: None, detectable, inconclusive: None, wants_samples: false }
}

//! The density, the deltas and the probability of no sample make one.

use super::{Examination, Surveyed};
use crate::statistics::ln_binomial_two_sided;
use crate::verdict::{Check, Ledger};

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    for Surveyed { setting, survey, tally } in examination.surveys() {
        let witness = setting.witness();
        let [none, error] = survey.no_sample(examination.claims.precision);
        ledger.record(Check::new("mass of the pdf and the deltas above 1", -none, error, witness));
        let ln_p = if none.is_nan() {
            f64::NAN
        } else {
            ln_binomial_two_sided(tally.none, tally.samples, none - error, none + error)
        };
        let what = "-log10 p that the rate of no sample is what the pdf leaves";
        ledger.record(Check::p_value(what, ln_p, examination.plan.ln_level(), tally.samples, witness));
    }
}

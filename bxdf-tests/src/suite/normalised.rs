//! The density, the deltas and the probability of no sample make one.

use super::{Examination, PValue};
use crate::statistics::ln_binomial_two_sided;
use crate::verdict::{Check, Ledger};

/// Error of the mass above which nothing is said about it.
const WORST_ERROR: f64 = 0.01;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let precision = examination.claims.precision;
    for surveyed in examination.surveys() {
        let decisive = examination.decisive(surveyed, |survey| {
            let [none, error] = survey.no_sample(precision);
            -none <= error
        });
        let [none, error] = decisive.no_sample(precision);
        let witness = surveyed.setting.witness();
        let mut mass = Check::new("mass of the pdf and the deltas above 1", -none, error, witness);
        mass.inconclusive = (error > WORST_ERROR).then_some("the integral of the pdf does not converge");
        ledger.record(mass);
        examination.judge(surveyed, ledger, |survey, tally| {
            let [none, error] = survey.no_sample(precision);
            let ln_p = if none.is_nan() {
                f64::NAN
            } else {
                ln_binomial_two_sided(tally.none, tally.samples, none - error, none + error)
            };
            let what = "-log10 p that the rate of no sample is what the pdf leaves";
            vec![PValue { what, ln_p, samples: tally.samples, cells: None, inconclusive: None }]
        });
    }
}

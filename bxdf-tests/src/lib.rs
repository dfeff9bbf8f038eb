//! A laboratory for BxDFs.
//!
//! Give it anything that implements [`Specimen`] (three calls and a list of [`Claims`]) and it returns
//! [`Verdict`]s: *holds*, *violated* or *inconclusive*, each with the evidence. It knows no renderer and shares
//! no code with what it examines: it has its own sphere maps and cubature, takes special functions and
//! statistics from statrs and libm, random numbers from rand_pcg.
//!
//! ```no_run
//! # fn specimen() -> Box<dyn bxdf_tests::Specimen> { unimplemented!() }
//! let specimen = specimen();
//! bxdf_tests::assert_conforms(&*specimen);
//! ```
//!
//! A run makes many statistical checks; together they raise a false alarm with probability 1e-6 at most
//! ([`FAMILY_ERROR_RATE`]). Seeds follow from the names of the trials and the run seed, so a verdict does not
//! depend on order or threads. What else is examined changes no sample, only the share of the error rate.

mod binning;
mod claims;
mod deltas;
mod number;
mod plan;
mod quadrature;
mod specimen;
mod statistics;
mod suite;
mod survey;
mod verdict;

pub use claims::{Boundary, Claims, Energy, Precision, Waiver};
pub use plan::{FAMILY_ERROR_RATE, Plan, run_seed};
pub use specimen::{Direction, Measure, Microsurface, Scatter, Specimen, Transport};
pub use suite::{Examination, Suite, examine};
pub use survey::{Albedo, directional_albedo};
pub use verdict::{Outcome, Verdict, Witness};

/// Runs every suite that applies, with a fresh [`run_seed`], and panics with all verdicts that do not hold.
///
/// # Panics
/// If any claim is violated, or the evidence for one is inconclusive.
#[track_caller]
#[expect(clippy::panic, reason = "an assertion for tests")]
pub fn assert_conforms(specimen: &dyn Specimen) {
    let plan = Plan::new(run_seed(), [specimen]);
    let failures: Vec<_> = examine(specimen, &plan)
        .into_iter()
        .filter(|verdict| verdict.outcome != Outcome::Holds)
        .map(|verdict| verdict.to_string())
        .collect();
    if !failures.is_empty() {
        panic!("{} of the claims do not hold:\n{}", failures.len(), failures.join("\n"));
    }
}

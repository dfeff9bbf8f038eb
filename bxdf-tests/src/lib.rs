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
//! bxdf_tests::assert_conforms("my_lobe", &*specimen);
//! ```
//!
//! [`Grid`] makes a named test of every point of a parameter grid and every suite.
//!
//! A call that panics, or returns what no BxDF may return, is a violation that names the call, its arguments and the
//! first wrong value; the other suites and specimens are examined all the same.
//!
//! A run makes many statistical checks; together they raise a false alarm with probability 1e-6 at most
//! ([`FAMILY_ERROR_RATE`]). Seeds follow from the names of the trials and the run seed, so a verdict does not
//! depend on order or threads. What else is examined changes no sample, only the share of the error rate. Every
//! statistical verdict states how small an error it would have found ([`Detectable`]); [`Trial`] gives the p-values
//! themselves.
//!
//! A violated verdict is saved at once ([`Regression`]), and explained where it is reported
//! ([`Examination::explained`]): where samples and density disagree ([`Residual`]), which bug of a dictionary leaves such
//! residuals behind ([`Diagnosis`]), and the smallest case that still fails ([`Smallest`]).
//!
//! Beside a grid of directions, suites `finite`, `weight`, `reciprocal` and `energy` search for the worst directions and
//! uniforms and, for a specimen that is one of a [`Family`], for the worst values of its parameters.

mod binning;
mod calls;
mod claims;
mod contrasts;
mod deltas;
mod diagnosis;
mod extremes;
mod failure;
mod grid;
mod number;
mod plan;
mod quadrature;
mod regression;
mod residual;
mod search;
mod specimen;
pub mod stability;
mod statistics;
mod suite;
mod survey;
mod verdict;

pub use claims::{Boundary, Claims, Energy, Precision, Waiver};
pub use diagnosis::Diagnosis;
pub use extremes::{ExtremeCalls, extreme_calls};
pub use failure::{Smallest, failure_report};
pub use grid::Grid;
pub use plan::{FAMILY_ERROR_RATE, Plan, run_seed};
pub use regression::{Regression, RegressionError, regressions_folder};
pub use residual::{Residual, ResidualCell};
pub use specimen::{
    Direction, Family, Measure, Microsurface, Parameter, Scale, Scatter, Specimen, Transport,
};
pub use suite::{Examination, PValue, Suite, Trial, examine};
pub use survey::{Albedo, directional_albedo};
pub use verdict::{Detectable, MOST_PARAMETERS, Outcome, Verdict, Witness};

/// Runs every suite that applies, with a fresh [`run_seed`], and panics with all verdicts that do not hold.
///
/// Seeds and verdicts bear the given name. For many specimens, or a test per suite, see [`Grid`]. Violated verdicts are
/// saved at once in the folder of [`regressions_folder`].
///
/// # Panics
/// If any claim is violated, or the evidence for one is inconclusive.
#[track_caller]
#[expect(clippy::panic, reason = "an assertion for tests")]
pub fn assert_conforms(name: &str, specimen: &dyn Specimen) {
    let plan = Plan::new(run_seed(), [specimen]);
    let examination = Examination::named(name, specimen, &plan);
    let folder = regressions_folder();
    let mut verdicts: Vec<Verdict> = Vec::new();
    let mut saved = Vec::new();
    for verdict in Suite::ALL.iter().filter_map(|&suite| examination.verdict(suite)) {
        saved.extend(regression::keep(&verdict, &plan, folder.as_deref()));
        verdicts.push(verdict);
    }
    let failures = verdicts.iter().filter(|verdict| verdict.outcome != Outcome::Holds).count();
    if failures == 0 {
        return;
    }
    let verdicts: Vec<Verdict> = verdicts.into_iter().map(|verdict| examination.explained(verdict)).collect();
    // A test runs in a thread that bears its name.
    let thread = std::thread::current();
    let test = thread.name().filter(|&name| name != "main").unwrap_or_default();
    saved.push(format!("again: BXDF_TESTS_SEED={} cargo test {test}", plan.run_seed).trim_end().to_owned());
    panic!(
        "{name}: {failures} of {} suites do not hold\n{}{}",
        verdicts.len(),
        failure_report(&verdicts),
        saved.join("\n"),
    );
}

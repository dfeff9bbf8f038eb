//! Every specimen × every suite that its claims call for, one named test each:
//! `cargo test rough_conductor/` runs one family, `cargo test /chi_square` one suite.
//!
//! Each run has a fresh seed, printed first; `BXDF_TESTS_SEED=…` repeats one.

use bxdf_tests::{Examination, Outcome, Plan, Suite, Verdict, run_seed};
use libtest_mimic::{Arguments, Failed, Trial};
use std::sync::Arc;

/// Cells that χ² must see at every direction of a rough specimen, α = 1e-3 at 89.9° included.
const LEAST_CELLS: usize = 100;

fn is_blind(verdict: &Verdict) -> bool {
    verdict.suite == Suite::ChiSquare
        && verdict.specimen.starts_with("rough_")
        && verdict.least_cells.unwrap_or(0) < LEAST_CELLS
}

fn main() {
    let arguments = Arguments::from_args();
    let specimens = gonio::specimen::catalogue().unwrap_or_else(|error| {
        eprintln!("the catalogue cannot be built: {error}");
        std::process::exit(2)
    });
    // The whole catalogue shares one error rate, whatever filter is given.
    let plan = Plan::new(run_seed(), specimens.iter().map(|specimen| &**specimen));
    if !arguments.list {
        eprintln!("BXDF_TESTS_SEED={} ({} statistical checks)", plan.run_seed, plan.family);
    }
    // Tests run until the process ends, and so live the examinations that they share.
    let plan: &'static Plan = Box::leak(Box::new(plan));
    let examinations: Vec<Arc<Examination<'static>>> =
        specimens.into_iter().map(|specimen| Arc::new(Examination::new(Box::leak(specimen), plan))).collect();
    // Suite by suite: tests side by side then wait for different specimens' samples, not for the same.
    let mut trials = Vec::new();
    for &suite in Suite::ALL {
        for examination in examinations.iter().filter(|examination| suite.applies(examination.claims())) {
            let name = format!("{}/{}", examination.name(), suite.name());
            let examination = Arc::clone(examination);
            let test = move || match examination.verdict(suite) {
                Some(verdict) if verdict.outcome != Outcome::Holds => Err(Failed::from(verdict.to_string())),
                Some(verdict) if is_blind(&verdict) => Err(Failed::from(format!(
                    "χ² saw {:?} cells at one of its directions",
                    verdict.least_cells
                ))),
                Some(_) => Ok(()),
                None => Err(Failed::from("the suite did not apply")),
            };
            trials.push(Trial::test(name, test));
        }
    }
    libtest_mimic::run(&arguments, trials).exit();
}

//! Every specimen × every suite that its claims call for, one named test each:
//! `cargo test rough_conductor/` runs one family, `cargo test /chi_square` one suite.
//!
//! Each run has a fresh seed, printed first; `BXDF_TESTS_SEED=…` repeats one.

use bxdf_tests::{Grid, Suite, Verdict};
use std::process::ExitCode;

/// Cells that χ² must see at every direction of a rough specimen, α = 1e-3 at 89.9° included.
const LEAST_CELLS: usize = 100;

fn is_not_blind(verdict: &Verdict) -> Result<(), String> {
    let is_rough = verdict.suite == Suite::ChiSquare && verdict.specimen.starts_with("rough_");
    if is_rough && verdict.least_cells.unwrap_or(0) < LEAST_CELLS {
        return Err(format!("χ² saw {:?} cells at one of its directions", verdict.least_cells));
    }
    Ok(())
}

fn main() -> ExitCode {
    let specimens = match gonio::specimen::catalogue() {
        Ok(specimens) => specimens,
        Err(error) => {
            eprintln!("the catalogue cannot be built: {error}");
            return ExitCode::from(2);
        }
    };
    let mut grid = Grid::default();
    grid.demand(is_not_blind);
    for specimen in specimens {
        grid.add(specimen.name(), specimen);
    }
    grid.run()
}

//! Every specimen × every suite that its claims call for, one named test each:
//! `cargo test rough_conductor/` runs one family, `cargo test /chi_square` one suite.
//!
//! Each run has a fresh seed, printed first; `BXDF_TESTS_SEED=…` repeats one. A suite that holds because it hardly
//! looked fails: the record of the report says how much it has to see.

use bxdf_tests::{Grid, Suite, Verdict};
use gonio::record::{RecordError, RunRecord};
use std::collections::HashMap;
use std::path::Path;
use std::process::ExitCode;
use std::sync::OnceLock;

/// Cells that χ² must see at every direction of a rough specimen, α = 1e-3 at 89.9° included.
const LEAST_CELLS: usize = 100;

/// Verdicts on record, by specimen and suite.
static RECORD: OnceLock<HashMap<(String, &str), Verdict>> = OnceLock::new();

fn is_not_blind(verdict: &Verdict) -> Result<(), String> {
    let is_rough = verdict.suite == Suite::ChiSquare && verdict.specimen.starts_with("rough_");
    if is_rough && verdict.least_cells.unwrap_or(0) < LEAST_CELLS {
        return Err(format!("χ² saw {:?} cells at one of its directions", verdict.least_cells));
    }
    let recorded =
        RECORD.get().and_then(|record| record.get(&(verdict.specimen.clone(), verdict.suite.name())));
    let Some(recorded) = recorded else { return Ok(()) };
    let cells = |verdict: &Verdict| verdict.least_cells.unwrap_or(0) as u64;
    // Another run seed may leave out some: samples that come to nothing are not compared, a second look of the recorded run
    // counts its samples too, and the fewest cells are those of a direction that only the seed knows.
    for (what, seen, recorded, share) in [
        ("checks", verdict.checks, recorded.checks, 0.7),
        ("random samples", verdict.samples, recorded.samples, 0.5),
        ("cells of χ² at one of its directions", cells(verdict), cells(recorded), 0.25),
    ] {
        if (seen as f64) < share * recorded as f64 {
            return Err(format!("{seen} {what}, where {recorded} are on record"));
        }
    }
    Ok(())
}

fn record() -> Result<RunRecord, RecordError> {
    RunRecord::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../reports/verdicts.json"))
}

fn main() -> ExitCode {
    let (specimens, record) = match (gonio::specimen::catalogue(), record()) {
        (Ok(specimens), Ok(record)) => (specimens, record),
        (Err(error), _) => {
            eprintln!("the catalogue cannot be built: {error}");
            return ExitCode::from(2);
        }
        (_, Err(error)) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    let mut grid = Grid::default();
    grid.demand(is_not_blind);
    let is_there = |name: &str| specimens.iter().any(|specimen| specimen.name() == name);
    if let Some(missing) = record.specimens.iter().find(|examined| !is_there(&examined.name)) {
        eprintln!(
            "{} is on record and not in the catalogue; `cargo run -- report` records anew",
            missing.name
        );
        return ExitCode::from(1);
    }
    RECORD.get_or_init(|| {
        let named = |verdict: Verdict| ((verdict.specimen.clone(), verdict.suite.name()), verdict);
        record.verdicts.into_iter().map(named).collect()
    });
    for specimen in specimens {
        grid.add(specimen.name(), specimen);
    }
    grid.run()
}

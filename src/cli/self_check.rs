//! `gonio verify --self-check`: do the suites find planted bugs?

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::{Outcome, Suite};
use gonio::planted::{Row, Search, SelfCheck, Suites};
use gonio::report::self_check_json;

use super::output::Form;
use super::progress::Progress;
use super::{Failure, General, Run, print};

pub(crate) fn run(run: &Run, seeds: usize, form: Form, general: &General) -> Result<ExitCode, Failure> {
    let progress = Progress::new(SelfCheck::size()?, general);
    let check = SelfCheck::run(run.seed, seeds, run.samples, Suites::All, &|| progress.finished())?;
    drop(progress);
    print(&match form {
        Form::Json => self_check_json(&check)?,
        Form::Full | Form::Junit | Form::Github => matrix(&check)?,
    })?;
    Ok(if check.passes() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The matrix bug × suite, the suite that must find the bug in brackets.
fn matrix(check: &SelfCheck) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let rows = || check.bugs.iter().map(|bug| &bug.row).chain(&check.twins);
    let width = rows().map(|row| row.name.len()).max().unwrap_or(0);
    let header: Vec<_> = Suite::ALL.iter().map(|suite| format!("{:<15}", suite.name())).collect();
    let mut line = |row: &Row, finder: Option<Suite>, end: &str| {
        let cells = Suite::ALL.iter().map(|&suite| {
            let cell = match row.outcome(suite) {
                None => "-",
                Some(Outcome::Holds) => "holds",
                Some(Outcome::Violated) => "caught",
                Some(Outcome::Inconclusive) => "inconclusive",
            };
            let cell = if finder == Some(suite) { format!("[{cell}]") } else { cell.to_owned() };
            format!("{cell:<15}")
        });
        writeln!(text, "{:<width$}  {}", row.name, (cells.collect::<String>() + end).trim_end())
    };
    for bug in &check.bugs {
        let end = match bug.search {
            Search::Caught => format!("{} of {} seeds", bug.caught, check.seeds),
            Search::Missed => format!("MISSED: {} of {} seeds", bug.caught, check.seeds),
            Search::NeedsMoreSamples => {
                format!("{} of {} seeds: needs {} samples", bug.caught, check.seeds, bug.least_samples)
            }
            Search::Elsewhere => format!("by {}", bug.elsewhere.unwrap_or_default()),
        };
        line(&bug.row, bug.suite, &end)?;
    }
    for twin in &check.twins {
        line(twin, None, "twin")?;
    }
    let mut all = format!("{:<width$}  {}\n{text}\n", "", header.join("").trim_end());
    for bug in check.bugs.iter().filter(|bug| bug.search == Search::Missed) {
        writeln!(all, "MISSED {}: {} = {:.4e}, limit {:.4e}", bug.row.name, bug.what, bug.value, bug.limit)?;
    }
    for verdict in &check.failures {
        writeln!(all, "A TWIN FAILS: {verdict}")?;
    }
    writeln!(
        all,
        "{} planted bugs: {} caught, {} missed, {} need more samples, {} beyond the claims; {} twins, {} of their \
         verdicts fail; run seed {}, {} seeds, {} samples per direction",
        check.bugs.len(),
        check.count(Search::Caught),
        check.count(Search::Missed),
        check.count(Search::NeedsMoreSamples),
        check.count(Search::Elsewhere),
        check.twins.len(),
        check.failures.len(),
        check.run_seed,
        check.seeds,
        check.samples,
    )?;
    Ok(all)
}

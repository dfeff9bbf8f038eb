//! `gonio report`: everything into one folder, or a check of what is there.

use std::path::PathBuf;
use std::process::ExitCode;

use bxdf_tests::{Outcome, Plan};
use gonio::report::Report;
use gonio::specimen::catalogue;

use super::progress::Progress;
use super::{Failure, General, Judgement, Run, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// The folder of the report
    #[arg(short, long, default_value = "reports", value_name = "FOLDER")]
    output: PathBuf,
    /// Compares the folder with what would be written and writes nothing; differences are exit code 1
    #[arg(long)]
    check: bool,
    #[command(flatten)]
    run: Run,
    #[command(flatten)]
    judgement: Judgement,
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    if options.output.exists() && !options.output.is_dir() {
        return Err(format!("{} is a file; the report needs a folder", options.output.display()).into());
    }
    let specimens = catalogue()?;
    let mut plan = Plan::new(options.run.seed, specimens.iter().map(|specimen| &**specimen));
    plan.samples = options.run.samples;
    let progress = Progress::new(specimens.len(), general);
    let report = Report::new(&specimens, &plan, &|_, _| progress.finished())?;
    drop(progress);
    let violated = report.verdicts.iter().filter(|verdict| verdict.outcome == Outcome::Violated);
    for verdict in violated {
        print(&format!("{verdict}\n\n"))?;
    }
    if options.check {
        let differences = report.compare(&options.output);
        for difference in &differences {
            print(&format!("{difference}\n"))?;
        }
        if !differences.is_empty() {
            eprintln!("the report is not what would be written; `gonio report` writes it anew");
            return Ok(ExitCode::from(1));
        }
        print(&format!("{} is as it would be written\n", options.output.display()))?;
    } else {
        report.write(&options.output)?;
        let count = |outcome| report.verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
        print(&format!(
            "{} verdicts: {} hold, {} violated, {} inconclusive\n{}\n",
            report.verdicts.len(),
            count(Outcome::Holds),
            count(Outcome::Violated),
            count(Outcome::Inconclusive),
            options.output.join("index.html").display()
        ))?;
    }
    for fault in &report.faults {
        eprintln!("{fault}");
    }
    if !report.faults.is_empty() {
        return Ok(ExitCode::from(1));
    }
    if !report.self_check.passes() {
        eprintln!("a planted bug is missed, or a twin fails; `gonio verify --self-check` shows which");
        return Ok(ExitCode::from(1));
    }
    Ok(options.judgement.exit_code(&report.verdicts))
}

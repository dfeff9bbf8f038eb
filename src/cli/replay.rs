//! `gonio replay`: runs a saved violation again.

use std::path::PathBuf;
use std::process::ExitCode;

use bxdf_tests::{Examination, Outcome, Regression, failure_report};

use super::verify::select;
use super::{Failure, Judgement, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// A file that a violated suite was saved in, as `gonio verify` prints it
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    judgement: Judgement,
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let regression = Regression::read(&options.file)?;
    let (plan, saved) = (regression.plan(), &regression.verdict);
    let (name, suite) = (&saved.specimen, saved.suite);
    let selected = select(std::slice::from_ref(name)).map_err(|error| {
        format!("{error}; where it is another program's, BXDF_TESTS_SEED={} repeats its tests", plan.run_seed)
    })?;
    let specimen = selected.into_iter().find(|specimen| specimen.name() == *name);
    let specimen = specimen.ok_or_else(|| format!("no specimen is named `{name}`, many begin so"))?;
    let examination = Examination::new(&*specimen, &plan);
    let verdict = examination.verdict(suite).ok_or_else(|| {
        format!("suite {} no longer applies to {name}: it claims something else", suite.name())
    })?;
    let bytes = |regression: &Regression| serde_json::to_string(regression);
    let is_same = bytes(&Regression::new(verdict.clone(), &plan))? == bytes(&regression)?;
    let exit_code = options.judgement.exit_code(std::slice::from_ref(&verdict));
    let text = match verdict.outcome {
        Outcome::Holds => format!("{}\nholds now; saved was {}\n", verdict.headline(), saved.headline()),
        _ if is_same => {
            failure_report(&[examination.explained(verdict)]) + "the verdict is the saved one, to the byte\n"
        }
        _ => {
            let report = failure_report(&[examination.explained(verdict)]);
            format!("{report}the verdict is another one than saved, which was {}\n", saved.headline())
        }
    };
    print(&text)?;
    Ok(exit_code)
}

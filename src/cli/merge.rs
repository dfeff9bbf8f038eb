//! `gonio merge`: puts the parts of a run together.

use std::collections::HashMap;
use std::path::PathBuf;
use std::process::ExitCode;

use gonio::record::{RecordError, RunRecord};

use super::output::Outputs;
use super::{Failure, Judgement};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Records that `gonio verify --shard I/N --output json=FILE` wrote, one for each part
    #[arg(required = true, value_name = "FILE")]
    files: Vec<PathBuf>,
    #[command(flatten)]
    judgement: Judgement,
    #[command(flatten)]
    outputs: Outputs,
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let read = |path: &PathBuf| Ok((path.clone(), RunRecord::read(path)?));
    let parts = options.files.iter().map(read).collect::<Result<Vec<_>, RecordError>>()?;
    let record = RunRecord::merge(parts)?;
    options.outputs.emit(&record, &HashMap::new())?;
    Ok(options.judgement.exit_code(&record.verdicts))
}

//! `gonio verify`: runs the suites and prints a line per specimen and the verdict.

use std::collections::HashMap;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use bxdf_tests::{Plan, Specimen, Suite};
use gonio::parameter::did_you_mean;
use gonio::record::{RunRecord, Shard};
use gonio::specimen::{Kind, specimens_of, verify};

use super::output::{Form, Outputs};
use super::progress::Progress;
use super::{Failure, General, Judgement, Run, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Lobes, `stack`, specimens, or beginnings of their names; the catalogue unless given, `grid` for the long form
    names: Vec<String>,
    /// Only this suite; may be given several times. All unless given
    #[arg(long = "suite", value_name = "NAME", value_parser = suite)]
    suites: Vec<Suite>,
    #[command(flatten)]
    run: Run,
    #[command(flatten)]
    judgement: Judgement,
    /// Only part I of N, every N-th specimen; `gonio merge` puts the parts together
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    #[command(flatten)]
    outputs: Outputs,
}

fn suite(name: &str) -> Result<Suite, String> {
    Suite::ALL.iter().copied().find(|suite| suite.name() == name).ok_or_else(|| {
        let names: Vec<_> = Suite::ALL.iter().map(|suite| suite.name()).collect();
        format!("choose one of {}", names.join(", "))
    })
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    let specimens = select(&options.names)?;
    // The error rate is shared by the whole run, whatever part of it this is.
    let mut plan = Plan::new(options.run.seed, specimens.iter().map(|specimen| &**specimen));
    plan.samples = options.run.samples;
    let specimens = match options.shard {
        None => specimens,
        Some(shard) => shard.of(specimens),
    };
    if options.outputs.format == Form::Full {
        print(&format!("run seed {}\n", plan.run_seed))?;
    }
    let progress = Progress::new(specimens.len(), general);
    let suites = if options.suites.is_empty() { Suite::ALL } else { &options.suites };
    let times = Mutex::new(HashMap::new());
    let verdicts = verify(&specimens, suites, &plan, &|name, time| {
        progress.finished();
        times.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), time);
    });
    drop(progress);
    let examined = specimens.iter().map(|specimen| &**specimen);
    let record = RunRecord::new(&plan, suites, options.shard, examined, verdicts);
    options.outputs.emit(&record, &times.into_inner().unwrap_or_else(PoisonError::into_inner))?;
    Ok(options.judgement.exit_code(&record.verdicts))
}

/// The specimens that one of the names means; a name that means none is an error.
fn select(names: &[String]) -> Result<Vec<Box<dyn Specimen>>, Failure> {
    let mut known: Vec<String> = Vec::new();
    let mut used = vec![false; names.len()];
    let mut selected = Vec::new();
    // The long form only if it is named.
    let is_long = |name: &String| name.starts_with(Kind::Grid.name());
    let kinds = || Kind::catalogue().chain(names.iter().any(is_long).then_some(Kind::Grid));
    // Where every name is that of a kind, the others need not be built.
    let by_kind = !names.is_empty() && names.iter().all(|name| kinds().any(|kind| name == kind.name()));
    for kind in kinds().filter(|kind| !by_kind || names.iter().any(|name| name == kind.name())) {
        known.push(kind.name().to_owned());
        for specimen in specimens_of(kind)? {
            let full = specimen.name();
            let mut wanted = names.is_empty();
            for (name, used) in names.iter().zip(&mut used) {
                let fits = name == kind.name() || full.starts_with(name.as_str());
                *used |= fits;
                wanted |= fits;
            }
            let family = full.split('/').next().unwrap_or_default().to_owned();
            if !known.contains(&family) {
                known.push(family);
            }
            known.push(full);
            if wanted {
                selected.push(specimen);
            }
        }
    }
    match names.iter().zip(used).find(|&(_, used)| !used) {
        None => Ok(selected),
        Some((name, _)) => {
            // Whoever names no case is told of no case.
            let is_alike = |known: &&str| name.contains('/') == known.contains('/');
            let hint = did_you_mean(name, known.iter().map(String::as_str).filter(is_alike));
            known.retain(|name| !name.contains('/'));
            let known = known.join(", ");
            Err(format!(
                "no lobe or specimen is named `{name}`{hint}\nknown: {known}; `gonio list` shows more"
            )
            .into())
        }
    }
}

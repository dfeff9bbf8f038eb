//! `gonio verify`: runs the suites and prints a line per specimen and the verdict.

use std::collections::HashMap;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use bxdf_tests::{Plan, Regression, Specimen, Suite, Verdict, regressions_folder};
use gonio::parameter::did_you_mean;
use gonio::planted::PlantedBug;
use gonio::record::{RunRecord, Shard};
use gonio::specimen::{CatalogueError, Kind, specimens_of, verify};
use rayon::prelude::*;

use super::output::{Form, Outputs};
use super::progress::Progress;
use super::{Failure, General, Judgement, Run, extremes, print, self_check};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Lobes, `stack`, materials, specimens, or beginnings of their names; the catalogue unless given, `grid` for the long form,
    /// `planted` for planted bugs
    names: Vec<String>,
    /// Only this suite; may be given several times. All unless given
    #[arg(long = "suite", value_name = "NAME", value_parser = suite)]
    suites: Vec<Suite>,
    #[command(flatten)]
    run: Run,
    /// Planted bugs instead of specimens: every suite must find what it must, and nothing in the correct twins
    #[arg(long, conflicts_with_all = ["names", "suites", "deny", "shard", "outputs"])]
    self_check: bool,
    /// Run seeds of a self-check, from --seed up: how often is each bug found?
    #[arg(long, requires = "self_check", default_value_t = 1, value_name = "K", value_parser = seeds)]
    seeds: usize,
    /// Terms against exact values at the extremes of their inputs, instead of specimens; names are beginnings of theirs
    #[arg(long, conflicts_with_all = ["suites", "self_check", "deny", "shard", "outputs", "regressions"])]
    extremes: bool,
    #[command(flatten)]
    judgement: Judgement,
    /// Only part I of N, every N-th specimen; `gonio merge` puts the parts together
    #[arg(long, value_name = "I/N")]
    shard: Option<Shard>,
    /// Where violations are saved the moment they are found [default: $BXDF_TESTS_REGRESSIONS, or gonio-regressions;
    /// those of planted bugs are only saved where this is given]
    #[arg(long, value_name = "FOLDER", conflicts_with = "self_check")]
    regressions: Option<PathBuf>,
    #[command(flatten)]
    outputs: Outputs,
}

fn seeds(text: &str) -> Result<usize, String> {
    let range = 1..=10_000;
    let number: usize = text.parse().map_err(|_| format!("`{text}` is not a whole number"))?;
    if range.contains(&number) { Ok(number) } else { Err(format!("{number} is not in 1 to {}", range.end())) }
}

fn suite(name: &str) -> Result<Suite, String> {
    Suite::ALL.iter().copied().find(|suite| suite.name() == name).ok_or_else(|| {
        let names: Vec<_> = Suite::ALL.iter().map(|suite| suite.name()).collect();
        format!("choose one of {}", names.join(", "))
    })
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    if options.self_check {
        return self_check::run(&options.run, options.seeds, options.outputs.format, general);
    }
    if options.extremes {
        return extremes::run(&options.names, &options.run, options.outputs.format);
    }
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
    let saved = Mutex::new(HashMap::new());
    let save = |verdict: &Verdict| {
        let is_planted = verdict.specimen.starts_with(PLANTED);
        let folder = options.regressions.clone().or_else(|| regressions_folder().filter(|_| !is_planted));
        let Some(folder) = folder else { return };
        let line = match Regression::new(verdict.clone(), &plan).save(&folder) {
            Ok(path) => format!("saved; again: gonio replay {}", path.display()),
            Err(error) => format!("not saved: {error}"),
        };
        let place = (verdict.specimen.clone(), verdict.suite.name());
        saved.lock().unwrap_or_else(PoisonError::into_inner).insert(place, line);
    };
    let verdicts = verify(&specimens, suites, &plan, &save, &|name, time| {
        progress.finished();
        times.lock().unwrap_or_else(PoisonError::into_inner).insert(name.to_owned(), time);
    });
    drop(progress);
    let examined = specimens.iter().map(|specimen| &**specimen);
    let record = RunRecord::new(&plan, suites, options.shard, examined, verdicts);
    options.outputs.emit(&record, &times.into_inner().unwrap_or_else(PoisonError::into_inner))?;
    let saved = saved.into_inner().unwrap_or_else(PoisonError::into_inner);
    for verdict in &record.verdicts {
        if let Some(line) = saved.get(&(verdict.specimen.clone(), verdict.suite.name())) {
            eprintln!("{line}");
        }
    }
    Ok(options.judgement.exit_code(&record.verdicts))
}

/// Planted bugs stand beside the catalogue, for what a violation says.
const PLANTED: &str = "planted";

/// Kinds with their specimens.
fn built(kinds: impl Iterator<Item = Kind>) -> Result<Vec<(Kind, Vec<Box<dyn Specimen>>)>, CatalogueError> {
    let kinds: Vec<Kind> = kinds.collect();
    kinds.into_par_iter().map(|kind| Ok((kind, specimens_of(kind)?))).collect()
}

/// The specimens that one of the names means; a name that means none is an error.
pub(super) fn select(names: &[String]) -> Result<Vec<Box<dyn Specimen>>, Failure> {
    let mut used = vec![false; names.len()];
    let mut selected = Vec::new();
    // The long form only if it is named.
    let is_long = |name: &String| name.starts_with(Kind::Grid.name());
    let kinds: Vec<Kind> = Kind::catalogue().chain(names.iter().any(is_long).then_some(Kind::Grid)).collect();
    let mut known: Vec<String> = Vec::new();
    for &kind in &kinds {
        let families = kind.families();
        let first = families.iter().filter_map(|family| family.split('/').next());
        for name in [kind.name()].into_iter().chain(first) {
            if !known.iter().any(|known| known == name) {
                known.push(name.to_owned());
            }
        }
    }
    let is_wanted =
        |kind: &Kind| names.is_empty() || names.iter().any(|name| name == kind.name() || kind.may_have(name));
    for (kind, specimens) in built(kinds.iter().copied().filter(is_wanted))? {
        for specimen in specimens {
            let full = specimen.name();
            let mut wanted = names.is_empty();
            for (name, used) in names.iter().zip(&mut used) {
                let fits = name == kind.name() || full.starts_with(name.as_str());
                *used |= fits;
                wanted |= fits;
            }
            if wanted {
                selected.push(specimen);
            }
        }
    }
    if names.iter().any(|name| name.starts_with(PLANTED)) {
        known.push(PLANTED.to_owned());
        for bug in PlantedBug::ALL {
            let full = format!("{PLANTED}/{}", bug.name);
            let fits: Vec<bool> = names.iter().map(|name| full.starts_with(name.as_str())).collect();
            used.iter_mut().zip(&fits).for_each(|(used, fits)| *used |= fits);
            if fits.contains(&true) {
                selected.push(bug.mutant()?);
            }
            known.push(full);
        }
    }
    match names.iter().zip(used).find(|&(_, used)| !used) {
        None => Ok(selected),
        Some((name, _)) => {
            if name.contains('/') {
                let all = built(kinds.iter().copied())?.into_iter().flat_map(|(_, specimens)| specimens);
                known.extend(all.map(|specimen| specimen.name()));
            }
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

//! `gonio verify`: runs the suites and prints a line per specimen and the verdict.

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::{FAMILY_ERROR_RATE, Outcome, Plan, Specimen, Suite, Verdict};
use gonio::parameter::did_you_mean;
use gonio::report::verdicts_json;
use gonio::specimen::{Kind, specimens_of, verify};

use super::progress::Progress;
use super::{Failure, Format, General, Judgement, Run, print};

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
    /// How to print
    #[arg(long, value_enum, default_value = "full")]
    format: Format,
}

fn suite(name: &str) -> Result<Suite, String> {
    Suite::ALL.iter().copied().find(|suite| suite.name() == name).ok_or_else(|| {
        let names: Vec<_> = Suite::ALL.iter().map(|suite| suite.name()).collect();
        format!("choose one of {}", names.join(", "))
    })
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    let specimens = select(&options.names)?;
    let mut plan = Plan::new(options.run.seed, specimens.iter().map(|specimen| &**specimen));
    plan.samples = options.run.samples;
    if options.format == Format::Full {
        print(&format!("run seed {}\n", plan.run_seed))?;
    }
    let progress = Progress::new(specimens.len(), general);
    let suites = if options.suites.is_empty() { Suite::ALL } else { &options.suites };
    let verdicts = verify(&specimens, suites, &plan, &|_| progress.finished());
    drop(progress);
    print(&match options.format {
        Format::Json => verdicts_json(&plan, &verdicts)?,
        Format::Full => full(&specimens, suites, &plan, &verdicts)?,
    })?;
    Ok(options.judgement.exit_code(&verdicts))
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

fn full(
    specimens: &[Box<dyn Specimen>],
    suites: &[Suite],
    plan: &Plan,
    verdicts: &[Verdict],
) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let width = specimens.iter().map(|specimen| specimen.name().len()).max().unwrap_or(0);
    let header: Vec<_> = suites.iter().map(|suite| format!("{:<13}", suite.name())).collect();
    writeln!(text, "{:<width$}  {}", "", header.join("").trim_end())?;
    for specimen in specimens {
        let name = specimen.name();
        let cells = suites.iter().map(|&suite| {
            let verdict = verdicts.iter().find(|verdict| verdict.specimen == name && verdict.suite == suite);
            let cell = match verdict.map(|verdict| verdict.outcome) {
                None => "-",
                Some(Outcome::Holds) => "holds",
                Some(Outcome::Violated) => "VIOLATED",
                Some(Outcome::Inconclusive) => "inconclusive",
            };
            format!("{cell:<13}")
        });
        writeln!(text, "{name:<width$}  {}", cells.collect::<String>().trim_end())?;
    }
    text.push('\n');
    for verdict in verdicts.iter().filter(|verdict| verdict.outcome != Outcome::Holds) {
        writeln!(text, "{verdict}\n")?;
    }
    let count = |outcome| verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
    writeln!(
        text,
        "{} verdicts: {} hold, {} violated, {} inconclusive; {} samples per direction; false alarm of the run ≤ {:e}",
        verdicts.len(),
        count(Outcome::Holds),
        count(Outcome::Violated),
        count(Outcome::Inconclusive),
        plan.samples,
        FAMILY_ERROR_RATE,
    )?;
    if count(Outcome::Violated) > 0 {
        let violated = verdicts.iter().filter(|verdict| verdict.outcome == Outcome::Violated);
        let mut names: Vec<&str> = violated.map(|verdict| verdict.specimen.as_str()).collect();
        names.dedup();
        writeln!(
            text,
            "again: gonio verify {} --seed {} --samples {}",
            names.join(" "),
            plan.run_seed,
            plan.samples
        )?;
    }
    Ok(text)
}

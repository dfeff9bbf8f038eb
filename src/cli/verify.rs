//! `gonio verify`: runs the suites and prints a line per specimen and the verdict.

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::{FAMILY_ERROR_RATE, Outcome, Plan, Specimen, Suite, Verdict};
use gonio::ior::nearest;
use gonio::report::verdicts_json;
use gonio::specimen::{catalogue, verify};

use super::progress::Progress;
use super::{Failure, Format, General, Judgement, Run, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Names of specimens, or beginnings of names; all unless given
    names: Vec<String>,
    #[command(flatten)]
    run: Run,
    #[command(flatten)]
    judgement: Judgement,
    /// How to print
    #[arg(long, value_enum, default_value = "full")]
    format: Format,
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    let specimens = select(catalogue()?, &options.names)?;
    let mut plan = Plan::new(options.run.seed, specimens.iter().map(|specimen| &**specimen));
    plan.samples = options.run.samples;
    if options.format == Format::Full {
        print(&format!("run seed {}\n", plan.run_seed));
    }
    let progress = Progress::new(specimens.len(), general);
    let verdicts = verify(&specimens, &plan, &|_| progress.finished());
    drop(progress);
    print(&match options.format {
        Format::Json => verdicts_json(&plan, &verdicts)?,
        Format::Full => full(&specimens, &plan, &verdicts)?,
    });
    Ok(options.judgement.exit_code(&verdicts))
}

/// The specimens whose name begins with one of the given names; a name that fits none is an error.
fn select(specimens: Vec<Box<dyn Specimen>>, names: &[String]) -> Result<Vec<Box<dyn Specimen>>, Failure> {
    let fits = |specimen: &dyn Specimen, name: &str| {
        let full = specimen.name();
        full.strip_prefix(name)
            .is_some_and(|rest| rest.is_empty() || name.ends_with('/') || rest.starts_with('/'))
            || (name.contains('/') && full.starts_with(name))
    };
    for name in names {
        if !specimens.iter().any(|specimen| fits(&**specimen, name)) {
            let mut families: Vec<String> = Vec::new();
            for specimen in &specimens {
                let full = specimen.name();
                let family = full.split('/').next().unwrap_or_default().to_owned();
                if !families.contains(&family) {
                    families.push(family);
                }
            }
            let known: Vec<String> = specimens.iter().map(|specimen| specimen.name()).collect();
            let near = nearest(name, families.iter().chain(&known).map(String::as_str));
            let hint =
                if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
            return Err(format!(
                "no specimen is named `{name}`{hint}\nfamilies: {}; `gonio list` shows all specimens",
                families.join(", ")
            )
            .into());
        }
    }
    let wanted = |specimen: &dyn Specimen| names.is_empty() || names.iter().any(|name| fits(specimen, name));
    Ok(specimens.into_iter().filter(|specimen| wanted(&**specimen)).collect())
}

fn full(
    specimens: &[Box<dyn Specimen>],
    plan: &Plan,
    verdicts: &[Verdict],
) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    let width = specimens.iter().map(|specimen| specimen.name().len()).max().unwrap_or(0);
    let header: Vec<_> = Suite::ALL.iter().map(|suite| format!("{:<11}", suite.name())).collect();
    writeln!(text, "{:<width$}  {}", "", header.join("").trim_end())?;
    for specimen in specimens {
        let name = specimen.name();
        let cells = Suite::ALL.iter().map(|&suite| {
            let verdict = verdicts.iter().find(|verdict| verdict.specimen == name && verdict.suite == suite);
            let cell = match verdict.map(|verdict| verdict.outcome) {
                None => "-",
                Some(Outcome::Holds) => "holds",
                Some(Outcome::Violated) => "VIOLATED",
                Some(Outcome::Inconclusive) => "unsure",
            };
            format!("{cell:<11}")
        });
        writeln!(text, "{name:<width$}  {}", cells.collect::<String>().trim_end())?;
    }
    text.push('\n');
    for verdict in verdicts.iter().filter(|verdict| verdict.outcome != Outcome::Holds) {
        writeln!(text, "{verdict}\n")?;
    }
    let count = |outcome| verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
    let samples: u64 = verdicts.iter().map(|verdict| verdict.samples).sum();
    writeln!(
        text,
        "{} verdicts: {} hold, {} violated, {} inconclusive; {samples} samples; false alarm of the run ≤ {:e}",
        verdicts.len(),
        count(Outcome::Holds),
        count(Outcome::Violated),
        count(Outcome::Inconclusive),
        FAMILY_ERROR_RATE,
    )?;
    if count(Outcome::Violated) > 0 {
        writeln!(text, "again: gonio verify NAME --seed {} --samples {}", plan.run_seed, plan.samples)?;
    }
    Ok(text)
}

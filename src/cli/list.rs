//! `gonio list`: lobes, specimens and suites.

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::Suite;
use gonio::lobe::LobeKind;
use gonio::specimen::{CatalogueError, specimens_of};
use serde::Serialize;

use super::{Failure, Format, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// How to print
    #[arg(long, value_enum, default_value = "full")]
    format: Format,
}

#[derive(Serialize)]
struct Named {
    name: &'static str,
    summary: &'static str,
}

#[derive(Serialize)]
struct Lobe {
    name: &'static str,
    summary: &'static str,
    specimens: Vec<String>,
}

#[derive(Serialize)]
struct Lists {
    lobes: Vec<Lobe>,
    suites: Vec<Named>,
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let lobe = |&kind: &LobeKind| -> Result<Lobe, CatalogueError> {
        let specimens = specimens_of(kind)?.iter().map(|specimen| specimen.name()).collect();
        Ok(Lobe { name: kind.name(), summary: kind.summary(), specimens })
    };
    let lists = Lists {
        lobes: LobeKind::ALL.iter().map(lobe).collect::<Result<_, _>>()?,
        suites: Suite::ALL
            .iter()
            .map(|suite| Named { name: suite.name(), summary: suite.statement() })
            .collect(),
    };
    let text = match options.format {
        Format::Json => serde_json::to_string_pretty(&lists)? + "\n",
        Format::Full => full(&lists)?,
    };
    print(&text)?;
    Ok(ExitCode::SUCCESS)
}

fn full(lists: &Lists) -> Result<String, std::fmt::Error> {
    let mut text = String::from("Suites\n");
    for Named { name, summary } in &lists.suites {
        writeln!(text, "  {name:<13}{summary}")?;
    }
    writeln!(text, "\nLobes and their specimens; gonio verify NAME… takes any name or the beginning of one")?;
    for Lobe { name, summary, specimens } in &lists.lobes {
        writeln!(text, "\n{name}: {summary}")?;
        for specimen in specimens {
            writeln!(text, "  {specimen}")?;
        }
    }
    Ok(text)
}

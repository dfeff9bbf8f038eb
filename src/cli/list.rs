//! `gonio list`: lobes, stacks, specimens and suites.

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::Suite;
use gonio::specimen::{CatalogueError, Kind, specimens_of};
use rayon::prelude::*;
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
struct Group {
    name: &'static str,
    summary: &'static str,
    specimens: Vec<String>,
}

#[derive(Serialize)]
struct Lists {
    lobes: Vec<Group>,
    stacks: Vec<Group>,
    suites: Vec<Named>,
}

/// The kinds that pass, with their specimens.
fn groups(keep: impl Fn(&Kind) -> bool) -> Result<Vec<Group>, CatalogueError> {
    let group = |kind: Kind| {
        let specimens = specimens_of(kind)?.iter().map(|specimen| specimen.name()).collect();
        Ok(Group { name: kind.name(), summary: kind.summary(), specimens })
    };
    Kind::catalogue().filter(keep).collect::<Vec<_>>().into_par_iter().map(group).collect()
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let lists = Lists {
        lobes: groups(|kind| matches!(kind, Kind::Lobe(_)))?,
        stacks: groups(|kind| matches!(kind, Kind::Stack))?,
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
    writeln!(
        text,
        "\nLobes and stacks with their specimens; gonio verify NAME… takes any name or the beginning of one"
    )?;
    for Group { name, summary, specimens } in lists.lobes.iter().chain(&lists.stacks) {
        writeln!(text, "\n{name}: {summary}")?;
        for specimen in specimens {
            writeln!(text, "  {specimen}")?;
        }
    }
    writeln!(text, "\n{}: {}", Kind::Grid.name(), Kind::Grid.summary())?;
    Ok(text)
}

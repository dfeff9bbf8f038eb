//! `gonio list`: lobes, specimens and suites.

use std::fmt::Write as _;
use std::process::ExitCode;

use bxdf_tests::Suite;
use gonio::lobe::LobeKind;
use gonio::specimen::catalogue;
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
struct Lists {
    lobes: Vec<Named>,
    suites: Vec<Named>,
    specimens: Vec<String>,
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let lists = Lists {
        lobes: LobeKind::ALL
            .iter()
            .map(|kind| Named { name: kind.name(), summary: kind.summary() })
            .collect(),
        suites: Suite::ALL
            .iter()
            .map(|suite| Named { name: suite.name(), summary: suite.statement() })
            .collect(),
        specimens: catalogue()?.iter().map(|specimen| specimen.name()).collect(),
    };
    let text = match options.format {
        Format::Json => serde_json::to_string_pretty(&lists)? + "\n",
        Format::Full => {
            let mut text = String::new();
            for (title, entries) in [("Lobes", &lists.lobes), ("Suites", &lists.suites)] {
                writeln!(text, "{title}")?;
                for Named { name, summary } in entries {
                    writeln!(text, "  {name:<24}{summary}")?;
                }
                text.push('\n');
            }
            writeln!(text, "Specimens (gonio verify NAME… takes a name or the beginning of one)")?;
            for name in &lists.specimens {
                writeln!(text, "  {name}")?;
            }
            text
        }
    };
    print(&text);
    Ok(ExitCode::SUCCESS)
}

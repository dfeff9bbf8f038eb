//! How verdicts are printed, and the files that they go to beside that.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::time::Duration;

use bxdf_tests::{Outcome, failure_report};
use clap::ValueEnum;
use gonio::file::write;
use gonio::ior::import::Message;
use gonio::message::Code;
use gonio::record::RunRecord;

use super::{Failure, print};

/// A form of verdicts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Form {
    /// For people
    Full,
    /// For programs: everything that is known
    Json,
    /// For build servers
    Junit,
    /// Annotations of GitHub Actions
    Github,
}

/// A file in some form.
#[derive(Clone, Debug)]
pub(crate) struct Output {
    form: Form,
    path: PathBuf,
}

impl FromStr for Output {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected KIND=PATH, with KIND one of full, json, junit, github";
        let (form, path) = text.split_once('=').ok_or(expected)?;
        let form = Form::from_str(form, false).map_err(|_| format!("`{form}` is no kind; {expected}"))?;
        if path.is_empty() {
            return Err(expected.to_owned());
        }
        Ok(Self { form, path: path.into() })
    }
}

#[derive(clap::Args)]
pub(crate) struct Outputs {
    /// How to print
    #[arg(long, value_enum, default_value = "full")]
    pub(crate) format: Form,
    /// Also writes the verdicts into a file: full, json, junit or github; may be given several times
    #[arg(long = "output", value_name = "KIND=PATH")]
    outputs: Vec<Output>,
}

impl Outputs {
    /// Writes the files, then prints. `times` is how long each specimen took, where that is known.
    pub(crate) fn emit(&self, record: &RunRecord, times: &HashMap<String, Duration>) -> Result<(), Failure> {
        let text = |form| -> Result<String, Failure> {
            Ok(match form {
                Form::Full => full(record)?,
                Form::Json => record.json()?,
                Form::Junit => record.junit(&|name| times.get(name).copied())?,
                Form::Github => record.github()?,
            })
        };
        for Output { form, path } in &self.outputs {
            write(path, text(*form)?.as_bytes())?;
        }
        print(&text(self.format)?)
    }
}

/// Writes a file whole or not at all; false if another one is there and may not be replaced.
pub(crate) fn write_new(path: &Path, text: &str, overwrite: bool) -> Result<bool, Failure> {
    let there = path.try_exists().map_err(|error| format!("cannot look for {}: {error}", path.display()))?;
    if there && !overwrite {
        let old = fs::read(path).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
        return Ok(old == text.as_bytes());
    }
    write(path, text.as_bytes())?;
    Ok(true)
}

pub(crate) fn exists(path: &Path) -> Message {
    let text = "is there already and differs; --overwrite replaces it".to_owned();
    Message { code: Code::Exists, file: path.display().to_string(), line: None, text }
}

/// A count with its noun.
pub(crate) fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}

fn full(record: &RunRecord) -> Result<String, std::fmt::Error> {
    let RunRecord { suites, specimens, verdicts, .. } = record;
    let mut text = String::new();
    let width = specimens.iter().map(|specimen| specimen.name.len()).max().unwrap_or(0);
    let header: Vec<_> = suites.iter().map(|suite| format!("{:<13}", suite.name())).collect();
    writeln!(text, "{:<width$}  {}", "", header.join("").trim_end())?;
    for specimen in specimens {
        let name = &specimen.name;
        let cells = suites.iter().map(|&suite| {
            let verdict = verdicts.iter().find(|verdict| verdict.specimen == *name && verdict.suite == suite);
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
    text += &failure_report(verdicts);
    let count = |outcome| verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
    writeln!(
        text,
        "{} verdicts: {} hold, {} violated, {} inconclusive; {} samples per direction; false alarm of the run ≤ {:e}",
        verdicts.len(),
        count(Outcome::Holds),
        count(Outcome::Violated),
        count(Outcome::Inconclusive),
        record.samples_per_setting,
        record.family_error_rate,
    )?;
    if count(Outcome::Violated) > 0 {
        let violated = verdicts.iter().filter(|verdict| verdict.outcome == Outcome::Violated);
        let mut names: Vec<&str> = violated.map(|verdict| verdict.specimen.as_str()).collect();
        names.dedup();
        writeln!(
            text,
            "again: gonio verify {} --seed {} --samples {}",
            names.join(" "),
            record.run_seed,
            record.samples_per_setting
        )?;
    }
    Ok(text)
}

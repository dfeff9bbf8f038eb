//! `gonio import`: materials of other programs as a material file, with what was lost.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gonio::material::file::{Document, Entry, Syntax, text_of};
use gonio::material::foreign::{self, Imported};

use super::output::{counted, exists, write_new};
use super::snippet::{self, Lines};
use super::{Failure, print};

#[derive(clap::Args)]
pub(crate) struct Options {
    /// A file of another program: Wavefront .mtl, or MaterialX .mtlx with constant inputs
    file: PathBuf,
    /// File to write, TOML or JSON; standard output unless given, and then without the table of losses
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Replaces the file if it is there
    #[arg(long)]
    overwrite: bool,
}

pub(crate) fn run(options: &Options) -> Result<ExitCode, Failure> {
    let path = options.file.display().to_string();
    let read = match options.file.extension().and_then(|end| end.to_str()).map(str::to_lowercase).as_deref() {
        Some("mtl") => foreign::mtl,
        Some("mtlx") => foreign::materialx,
        _ => return Err(format!("{path} is neither .mtl nor .mtlx").into()),
    };
    let text = match text_of(&options.file) {
        Ok(text) => text,
        Err(finding) => {
            eprintln!("{}", snippet::render(&finding, &path, &Lines::of("")));
            return Ok(ExitCode::from(2));
        }
    };
    let (imported, findings) = read(&text);
    let lines = Lines::of(&text);
    for finding in &findings {
        eprintln!("{}\n", snippet::render(finding, &path, &lines));
    }
    let mut document = Document::default();
    // Different names may be the same without what a material file does not take: later ones get a number.
    let (mut names, mut numbers) = (BTreeSet::new(), BTreeMap::new());
    for material in &imported {
        let plain = plain(&material.name);
        let number: &mut usize = numbers.entry(plain.clone()).or_insert(1);
        let mut name = plain.clone();
        while !names.insert(name.clone()) {
            *number += 1;
            name = format!("{plain}.{number}");
        }
        document.materials.push(Entry::new(name, material.description.clone()));
    }
    let to = options.output.as_deref();
    let written = match to.map_or(Syntax::Toml, Syntax::of) {
        Syntax::Toml => document.to_toml(),
        Syntax::Json => document.to_json(),
    };
    match to {
        None => print(&written)?,
        Some(to) if imported.is_empty() => {
            return Err(format!("nothing to write into {}", to.display()).into());
        }
        Some(to) if !write_new(to, &written, options.overwrite)? => return Err(exists(to).into()),
        Some(to) => print(&losses(&imported, &document, findings.len(), to)?)?,
    }
    Ok(if findings.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// A name that a material file takes.
fn plain(foreign: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || "_-.".contains(c) { c } else { '_' };
    let name: String = foreign.chars().map(plain).collect();
    if name.is_empty() || name.starts_with('.') { format!("_{name}") } else { name }
}

/// What became of every value.
fn losses(
    imported: &[Imported],
    document: &Document,
    refused: usize,
    to: &Path,
) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    // In the order of the fates.
    let mut counts = [0; 3];
    for (Imported { name, description, losses }, entry) in imported.iter().zip(&document.materials) {
        let renamed = if *name == entry.name { String::new() } else { format!(" → {}", entry.name) };
        writeln!(text, "{name}{renamed}: {}", description.model().name())?;
        let width = losses.iter().map(|loss| loss.key.chars().count()).max().unwrap_or(0);
        for loss in losses {
            writeln!(text, "  {:<width$}  {:<9}  {}", loss.key, loss.fate.to_string(), loss.text)?;
            counts[loss.fate as usize] += 1;
        }
    }
    let [exact, converted, dropped] = counts;
    let (materials, findings) = (counted(imported.len(), "material"), counted(refused, "finding"));
    write!(text, "{materials} into {}, {findings}; ", to.display())?;
    writeln!(text, "{exact} values exact, {converted} converted, {dropped} dropped")?;
    Ok(text)
}

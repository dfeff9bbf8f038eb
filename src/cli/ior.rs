//! `gonio ior`: measured optical constants.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use gonio::fresnel::normal_incidence;
use gonio::ior::import::{self, Page};
use gonio::ior::{FittedRgb, Illuminant, IorError, Provenance, Table, builtin, load, provenances};
use gonio::message::Code;
use gonio::parameter::did_you_mean;
use serde::Serialize;

use super::output::{exists, write_new};
use super::{Failure, Format, print};

#[derive(clap::Subcommand)]
pub(crate) enum Verb {
    /// Every embedded data set
    List {
        /// How to print
        #[arg(long, value_enum, default_value = "full")]
        format: Format,
    },
    /// One data set: source, range, colour, RGB index, values
    Show {
        /// Name of a data set, or a CSV file
        table: String,
        /// Wavelength in nanometres to show the value of
        #[arg(long, value_name = "NM")]
        wavelength_nm: Option<f64>,
        /// How to print
        #[arg(long, value_enum, default_value = "full")]
        format: Format,
    },
    /// All data sets of one material beside each other
    Compare {
        /// Name of a material, such as copper
        material: String,
        /// How to print
        #[arg(long, value_enum, default_value = "full")]
        format: Format,
    },
    /// One data set as CSV, with its source
    Export {
        /// Name of a data set, or a CSV file
        table: String,
        /// File to write; standard output unless given
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// Replaces the file if it is there
        #[arg(long)]
        overwrite: bool,
    },
    /// Pages of the refractiveindex.info database as CSV files, which show, export and plot read
    Import {
        /// A checkout of the database, its catalogue, a folder of pages or one page
        path: PathBuf,
        /// Folder to write into; paths within it are those of the pages
        #[arg(short, long, value_name = "FOLDER", default_value = "refractiveindex")]
        output: PathBuf,
        /// Replaces files that are there
        #[arg(long)]
        overwrite: bool,
    },
}

pub(crate) fn run(verb: &Verb) -> Result<ExitCode, Failure> {
    print(&match verb {
        Verb::Import { path, output, overwrite } => return import(path, output, *overwrite),
        Verb::Export { table, output, overwrite } => export(&load(table)?, output.as_deref(), *overwrite)?,
        Verb::List { format } => list(*format)?,
        Verb::Show { table, wavelength_nm, format } => show(&load(table)?, *wavelength_nm, *format)?,
        Verb::Compare { material, format } => compare(material, *format)?,
    })?;
    Ok(ExitCode::SUCCESS)
}

fn list(format: Format) -> Result<String, Failure> {
    let provenances = provenances()?;
    if format == Format::Json {
        return Ok(serde_json::to_string_pretty(&provenances)? + "\n");
    }
    let mut text = String::new();
    writeln!(text, "{:<34}{:<7}{:<16}material", "data set", "grade", "range [nm]")?;
    for Provenance { table, material, grade, .. } in provenances {
        let [low, high] = builtin(table)?.range_nm();
        writeln!(text, "{table:<34}{grade:<7}{:<16}{material}", format!("{low:.0}–{high:.0}"))?;
    }
    writeln!(
        text,
        "\ngrades: A published sets agree, B they spread, C they disagree widely, S single source"
    )?;
    Ok(text)
}

/// What `show` prints.
#[derive(Serialize)]
struct Shown<'a> {
    table: &'a Table,
    range_nm: [f64; 2],
    /// R at normal incidence as linear sRGB under D65, where the table covers 380–780 nm.
    reflectance_rgb: Option<[f64; 3]>,
    fitted: Option<FittedRgb>,
    /// (wavelength \[nm\], η, k, R at normal incidence).
    values: Vec<[f64; 4]>,
}

const SHOWN_NM: [f64; 5] = [450.0, 532.0, 550.0, 589.3, 650.0];

/// `None` where the table does not cover what is asked, other errors as they are.
fn if_covered<T>(result: Result<T, IorError>) -> Result<Option<T>, IorError> {
    match result {
        Ok(value) => Ok(Some(value)),
        Err(IorError::OutsideRange { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

fn values(table: &Table, wavelength_nm: f64) -> Result<[f64; 4], IorError> {
    let index = table.at(wavelength_nm)?;
    Ok([wavelength_nm, index.eta, index.k, normal_incidence(index.eta, index.k)])
}

fn show(table: &Table, wavelength_nm: Option<f64>, format: Format) -> Result<String, Failure> {
    let values = match wavelength_nm {
        // A wavelength that was asked for must be covered; of the usual ones those that are will do.
        Some(wavelength_nm) => vec![values(table, wavelength_nm)?],
        None => {
            let shown = SHOWN_NM.into_iter().map(|nm| if_covered(values(table, nm)));
            shown.collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect()
        }
    };
    let shown = Shown {
        table,
        range_nm: table.range_nm(),
        reflectance_rgb: if_covered(table.reflectance_rgb(1.0, Illuminant::D65))?.map(|rgb| rgb.0),
        fitted: if_covered(table.fitted_rgb())?,
        values,
    };
    if format == Format::Json {
        return Ok(serde_json::to_string_pretty(&shown)? + "\n");
    }
    let mut text = String::new();
    let [low, high] = shown.range_nm;
    writeln!(text, "{}: {} rows, {low} to {high} nm", table.name(), table.rows().len())?;
    if let Some(provenance) = table.provenance() {
        let Provenance {
            material,
            reference,
            doi,
            database_page,
            database_version,
            licence,
            grade,
            note,
            ..
        } = provenance;
        writeln!(text, "  material   {material}\n  source     {reference}")?;
        if !doi.is_empty() {
            writeln!(text, "  DOI        https://doi.org/{doi}")?;
        }
        writeln!(text, "  database   refractiveindex.info {database_version}, {database_page} ({licence})")?;
        writeln!(text, "  grade      {grade}\n  note       {note}")?;
    }
    let triple = |values: [f64; 3]| values.map(|value| format!("{value:.4}")).join("  ");
    match (shown.reflectance_rgb, shown.fitted) {
        (Some(rgb), Some(fitted)) => {
            writeln!(text, "  R(0°) linear sRGB, D65    {}", triple(rgb))?;
            writeln!(text, "  fitted η per channel      {}", triple(fitted.eta))?;
            writeln!(text, "  fitted k per channel      {}", triple(fitted.k))?;
            writeln!(
                text,
                "  largest error of the fit  {:.4} in reflectance, 0° to 88°",
                fitted.largest_error
            )?;
        }
        _ => writeln!(text, "  no colour: that takes 380 to 780 nm")?,
    }
    writeln!(text, "\n  {:>9}  {:>9}  {:>11}  {:>7}", "nm", "η", "k", "R(0°)")?;
    for [nm, eta, k, r] in &shown.values {
        writeln!(text, "  {nm:>9}  {eta:>9.5}  {k:>11.5e}  {r:>7.4}")?;
    }
    Ok(text)
}

/// A row of `compare`.
#[derive(Serialize)]
struct Compared {
    table: String,
    grade: String,
    /// R at normal incidence at 450, 550 and 650 nm, where the table covers them.
    reflectance: [Option<f64>; 3],
    /// R at normal incidence as linear sRGB under D65.
    reflectance_rgb: Option<[f64; 3]>,
}

const COMPARED_NM: [f64; 3] = [450.0, 550.0, 650.0];

fn compare(material: &str, format: Format) -> Result<String, Failure> {
    let all = provenances()?;
    let folder = |table: &str| table.split('/').next().unwrap_or_default().to_owned();
    let chosen: Vec<&Provenance> =
        all.iter().filter(|provenance| folder(&provenance.table) == material).collect();
    if chosen.is_empty() {
        let mut materials: Vec<String> = all.iter().map(|provenance| folder(&provenance.table)).collect();
        materials.dedup();
        let hint = did_you_mean(material, materials.iter().map(String::as_str));
        let known = materials.join(", ");
        return Err(format!("no material is named `{material}`{hint}; choose one of {known}").into());
    }
    let mut rows = Vec::new();
    for provenance in chosen {
        let table = builtin(&provenance.table)?;
        let mut reflectance = [None; 3];
        for (value, nm) in reflectance.iter_mut().zip(COMPARED_NM) {
            *value = if_covered(values(&table, nm))?.map(|[.., r]| r);
        }
        rows.push(Compared {
            table: provenance.table.clone(),
            grade: provenance.grade.clone(),
            reflectance,
            reflectance_rgb: if_covered(table.reflectance_rgb(1.0, Illuminant::D65))?.map(|rgb| rgb.0),
        });
    }
    if format == Format::Json {
        return Ok(serde_json::to_string_pretty(&rows)? + "\n");
    }
    let number = |value: Option<f64>| value.map_or("–".to_owned(), |value| format!("{value:.4}"));
    let mut text = String::new();
    writeln!(
        text,
        "{:<34}{:<7}{:>9}{:>9}{:>9}   linear sRGB under D65",
        "R at normal incidence", "grade", "450 nm", "550 nm", "650 nm"
    )?;
    for row in &rows {
        let [a, b, c] = row.reflectance.map(number);
        let rgb =
            row.reflectance_rgb.map_or("–".to_owned(), |rgb| rgb.map(|v| format!("{v:.4}")).join(" "));
        writeln!(text, "{:<34}{:<7}{a:>9}{b:>9}{c:>9}   {rgb}", row.table, row.grade)?;
    }
    let spread = |i: usize| {
        let values = || rows.iter().filter_map(|row| row.reflectance[i]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    if rows.len() > 1 {
        writeln!(text, "{:<41}{:>9.4}{:>9.4}{:>9.4}", "spread", spread(0), spread(1), spread(2))?;
    }
    Ok(text)
}

/// The table as CSV; nothing where it goes into a file.
fn export(table: &Table, output: Option<&Path>, overwrite: bool) -> Result<String, Failure> {
    let mut remarks = vec![table.name().to_owned()];
    if let Some(provenance) = table.provenance() {
        let Provenance { reference, doi, database_page, database_version, licence, note, .. } = provenance;
        remarks.push(reference.clone());
        remarks.extend((!doi.is_empty()).then(|| format!("https://doi.org/{doi}")));
        remarks.push(format!("refractiveindex.info {database_version}, {database_page} ({licence})"));
        remarks.push(note.clone());
    }
    let csv = table.csv(remarks.iter().map(String::as_str));
    let Some(path) = output else { return Ok(csv) };
    match write_new(path, &csv, overwrite)? {
        true => Ok(String::new()),
        false => Err(exists(path).into()),
    }
}

/// Imports what can be imported, tells on standard error what cannot, and counts.
fn import(path: &Path, output: &Path, overwrite: bool) -> Result<ExitCode, Failure> {
    let import::Sources { pages, mut refused } = import::find(path)?;
    let read = pages.len();
    if read + refused.len() == 0 {
        let path = path.display();
        let text =
            format!("no pages in {path}; expected a checkout with database/catalog-nk.yml, or *.yml files");
        return Err(text.into());
    }
    for message in &refused {
        eprintln!("error[{}]: {message}", message.code);
    }
    let (mut converted, mut with_notes) = (0, 0);
    for source in &pages {
        let page = match Page::read(source) {
            Ok(page) => page,
            Err(message) => {
                eprintln!("error[{}]: {message}", message.code);
                refused.push(message);
                continue;
            }
        };
        let file = output.join(source.path.with_extension("csv"));
        let folder = file.parent().unwrap_or(output);
        fs::create_dir_all(folder).map_err(|error| format!("cannot make {}: {error}", folder.display()))?;
        if !write_new(&file, &page.csv(), overwrite)? {
            let message = exists(&file);
            eprintln!("error[{}]: {message}", message.code);
            refused.push(message);
            continue;
        }
        for note in &page.notes {
            eprintln!("warning[{}]: {note}", note.code);
        }
        converted += 1;
        with_notes += usize::from(!page.notes.is_empty());
    }
    let mut text = format!("{read} pages read, {converted} converted into {}", output.display());
    writeln!(text, ", {with_notes} of them with warnings; {} refused", refused.len())?;
    let mut counts: BTreeMap<Code, usize> = BTreeMap::new();
    for message in &refused {
        *counts.entry(message.code).or_default() += 1;
    }
    for (code, count) in counts {
        writeln!(text, "  {code}  {:<40}{count:>6}", code.title())?;
    }
    print(&text)?;
    Ok(if refused.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

//! `gonio check`: what is wrong with material files, what is unusual in them, and the quick suites on every material.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::thread::sleep;
use std::time::{Duration, SystemTime};

use bxdf_tests::{Outcome, Plan, Specimen, Suite, Transport, Verdict, directional_albedo, failure_report};
use clap::ValueEnum;
use gonio::material::file::{Document, Syntax, read, text_of};
use gonio::material::{Profile, Summary};
use gonio::message::{Finding, Severity};
use gonio::record::{CheckRecord, CheckedFile, CheckedMaterial, Placed, RunRecord};
use gonio::specimen::{BxdfSpecimen, verify};
use rayon::prelude::*;

use super::output::counted;
use super::progress::Progress;
use super::snippet::{self, Lines};
use super::{Failure, General, print};

/// Random samples per direction and transport mode of the quick suites.
const QUICK: usize = 1 << 12;

/// Findings of one file that are shown with its text.
const SHOWN: usize = 100;

#[derive(clap::Args)]
pub(crate) struct Options {
    /// Material files, TOML or JSON
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// How to print
    #[arg(long, value_enum, default_value = "full")]
    format: Form,
    /// Whose ranges colours are held against, in place of the files' own choice: measured, substance, substance_strict,
    /// unity
    #[arg(long, value_name = "NAME", value_parser = profile)]
    profile: Option<Profile>,
    /// Reads and judges the files, and runs no suites
    #[arg(long)]
    lint_only: bool,
    /// Run seed of the suites
    #[arg(long, default_value_t = 0, value_name = "N")]
    seed: u64,
    /// Checks again whenever a file is saved, until interrupted
    #[arg(long)]
    watch: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// For people
    Full,
    /// A line per finding
    Concise,
    /// For programs
    Json,
    /// For build servers
    Junit,
    /// Annotations of GitHub Actions
    Github,
}

fn profile(name: &str) -> Result<Profile, String> {
    let names = || Profile::ALL.map(Profile::name).join(", ");
    Profile::named(name).ok_or_else(|| format!("choose one of {}", names()))
}

pub(crate) fn run(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    if !options.watch {
        return check(options, general);
    }
    loop {
        let before: Vec<_> = options.files.iter().map(|file| stamp(file)).collect();
        if let Err(failure) = check(options, general) {
            eprintln!("error: {failure}");
        }
        eprintln!("watching; interrupt to end");
        // Editors replace files rather than write into them, so names are watched, not files.
        while options.files.iter().zip(&before).all(|(file, before)| stamp(file) == *before) {
            sleep(Duration::from_millis(200));
        }
    }
}

/// When a file was written and how large it is; nothing while it is not there.
fn stamp(file: &Path) -> Option<(SystemTime, u64)> {
    let metadata = fs::metadata(file).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}

/// A file as it was read.
struct Checked {
    path: String,
    text: String,
    document: Document,
    findings: Vec<Finding>,
    is_unreadable: bool,
}

impl Checked {
    fn of(path: &Path, profile: Option<Profile>) -> Self {
        let shown = path.display().to_string();
        let text = match text_of(path) {
            Ok(text) => text,
            Err(finding) => {
                let (text, document) = (String::new(), Document::default());
                return Self { path: shown, text, document, findings: vec![finding], is_unreadable: true };
            }
        };
        let folder = path.parent().unwrap_or(Path::new(""));
        let (mut document, mut findings) = read(&text, Syntax::of(path), folder);
        document.profile = profile.unwrap_or(document.profile);
        findings.extend(document.lint());
        let mut checked = Self { path: shown, text, document, findings, is_unreadable: false };
        checked.sort();
        checked
    }

    /// Findings in the order of the file.
    fn sort(&mut self) {
        self.findings.sort_by_key(|finding| finding.span.as_ref().map_or(0, |span| span.start));
    }

    fn count(&self, severity: Severity) -> usize {
        self.findings.iter().filter(|finding| finding.code.severity() == severity).count()
    }
}

fn check(options: &Options, general: &General) -> Result<ExitCode, Failure> {
    let mut files: Vec<Checked> =
        options.files.iter().map(|path| Checked::of(path, options.profile)).collect();
    let specimens = if options.lint_only { Vec::new() } else { specimens_of(&mut files) };
    if options.format == Form::Full {
        for file in &files {
            print(&findings_of(file))?;
        }
    }
    let run = (!specimens.is_empty()).then(|| suites(&specimens, options.seed, general));
    let record = record_of(&files, run)?;
    print(&match options.format {
        Form::Full => full(&files, &record)?,
        Form::Concise => concise(&record)?,
        Form::Json => record.json()?,
        Form::Junit => record.junit()?,
        Form::Github => record.github()?,
    })?;
    let is_violated = |verdict: &Verdict| verdict.outcome == Outcome::Violated;
    let has_findings =
        files.iter().any(|file| file.count(Severity::Error) + file.count(Severity::Warning) > 0);
    Ok(if files.iter().any(|file| file.is_unreadable) {
        ExitCode::from(2)
    } else if has_findings || record.run.iter().flat_map(|run| &run.verdicts).any(is_violated) {
        ExitCode::from(1)
    } else {
        ExitCode::SUCCESS
    })
}

/// Every material of every file in double precision. One that cannot be made is a finding more and a material less.
fn specimens_of(files: &mut [Checked]) -> Vec<Box<dyn Specimen>> {
    let are_several = files.len() > 1;
    let mut specimens: Vec<Box<dyn Specimen>> = Vec::new();
    for file in files {
        let materials = std::mem::take(&mut file.document.materials);
        let built: Vec<_> = materials.par_iter().map(|entry| entry.description.material::<f64>()).collect();
        for (entry, built) in materials.into_iter().zip(built) {
            match built {
                Ok(material) => {
                    let name = specimen_name(are_several, &file.path, &entry.name);
                    specimens.push(Box::new(BxdfSpecimen::of_material(&name, material)));
                    file.document.materials.push(entry);
                }
                Err(problem) => file.findings.push(entry.refusal(&problem)),
            }
        }
        file.sort();
    }
    specimens
}

/// By the name of its file where there are several.
fn specimen_name(are_several: bool, file: &str, material: &str) -> String {
    if are_several { format!("{file}/{material}") } else { material.to_owned() }
}

fn suites(specimens: &[Box<dyn Specimen>], seed: u64, general: &General) -> (RunRecord, Vec<[f64; 3]>) {
    let mut plan = Plan::new(seed, specimens.iter().map(|specimen| &**specimen));
    plan.samples = QUICK;
    let progress = Progress::new(specimens.len(), general);
    let verdicts = verify(specimens, Suite::ALL, &plan, &|_| {}, &|_, _| progress.finished());
    drop(progress);
    let examined = specimens.iter().map(|specimen| &**specimen);
    let record = RunRecord::new(&plan, Suite::ALL, None, examined, verdicts);
    let albedos = specimens
        .par_iter()
        .map(|specimen| directional_albedo(&**specimen, [0.0, 0.0, 1.0], Transport::Importance, 1e-6).value);
    (record, albedos.collect())
}

/// Everything that a check found, for programs and for the table of materials.
fn record_of(files: &[Checked], run: Option<(RunRecord, Vec<[f64; 3]>)>) -> Result<CheckRecord, Failure> {
    let (run, mut albedos) = match run {
        None => (None, Vec::new().into_iter()),
        Some((run, albedos)) => (Some(run), albedos.into_iter()),
    };
    let mut checked = Vec::new();
    for file in files {
        let mut materials = Vec::new();
        for material in &file.document.materials {
            let specimen = specimen_name(files.len() > 1, &file.path, &material.name) + "/f64";
            materials.push(CheckedMaterial {
                name: material.name.clone(),
                model: material.model(),
                summary: material.description.summary()?,
                albedo: albedos.next(),
                outcome: run.as_ref().and_then(|run| outcome(&run.verdicts, &specimen)),
            });
        }
        let lines = Lines::of(&file.text);
        let findings = file.findings.iter().map(|finding| lines.placed(finding)).collect();
        checked.push(CheckedFile {
            path: file.path.clone(),
            profile: file.document.profile,
            findings,
            materials,
        });
    }
    Ok(CheckRecord::new(checked, run))
}

/// The worst of the verdicts on a specimen, if there are any.
fn outcome(verdicts: &[Verdict], specimen: &str) -> Option<Outcome> {
    let of_specimen = || verdicts.iter().filter(|verdict| verdict.specimen == specimen);
    let worst_first = [Outcome::Violated, Outcome::Inconclusive, Outcome::Holds];
    worst_first.into_iter().find(|&outcome| of_specimen().any(|verdict| verdict.outcome == outcome))
}

fn findings_of(file: &Checked) -> String {
    let lines = Lines::of(&file.text);
    let mut text = String::new();
    for finding in file.findings.iter().take(SHOWN) {
        text += &snippet::render(finding, &file.path, &lines);
        text += "\n\n";
    }
    if file.findings.len() > SHOWN {
        let more = file.findings.len() - SHOWN;
        text += &format!("{more} more in {}; --format concise shows all\n\n", file.path);
    }
    text
}

fn full(files: &[Checked], record: &CheckRecord) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for (file, checked) in files.iter().zip(&record.files) {
        if file.is_unreadable {
            continue;
        }
        let [errors, warnings, notes] =
            [Severity::Error, Severity::Warning, Severity::Note].map(|severity| file.count(severity));
        write!(text, "{}: {}", file.path, counted(checked.materials.len(), "material"))?;
        write!(text, ", {}, {}", counted(errors, "error"), counted(warnings, "warning"))?;
        writeln!(text, ", {}", counted(notes, "note"))?;
        text += &table(&checked.materials)?;
    }
    if let Some(run) = &record.run {
        let failures = failure_report(&run.verdicts);
        if !failures.is_empty() {
            write!(text, "\n{failures}")?;
        }
        let count = |outcome| run.verdicts.iter().filter(|verdict| verdict.outcome == outcome).count();
        writeln!(
            text,
            "{} verdicts: {} hold, {} violated, {} inconclusive",
            run.verdicts.len(),
            count(Outcome::Holds),
            count(Outcome::Violated),
            count(Outcome::Inconclusive)
        )?;
    }
    if let Some(finding) = files.iter().flat_map(|file| &file.findings).next() {
        writeln!(text, "gonio explain {} tells more", finding.code)?;
    }
    Ok(text)
}

/// A line per material; columns as wide as they need to be.
fn table(materials: &[CheckedMaterial]) -> Result<String, std::fmt::Error> {
    let triple = |channels: &[f64; 3]| channels.map(|channel| format!("{channel:.3}")).join(" ");
    let row = |material: &CheckedMaterial| {
        let Summary { alphas, normal_reflectance } = &material.summary;
        let alpha = |[x, y]: &[f64; 2]| if x == y { format!("{x:.3}") } else { format!("{x:.3} × {y:.3}") };
        [
            material.name.clone(),
            material.model.name().to_owned(),
            alphas.iter().map(alpha).collect::<Vec<_>>().join(" over "),
            normal_reflectance.iter().map(triple).collect::<Vec<_>>().join(" over "),
            material.albedo.as_ref().map_or(String::new(), triple),
            material.outcome.map_or(String::new(), |outcome| match outcome {
                Outcome::Holds => "holds".to_owned(),
                Outcome::Violated => "VIOLATED".to_owned(),
                Outcome::Inconclusive => "inconclusive".to_owned(),
            }),
        ]
    };
    let mut rows = vec![["", "model", "α", "R(0°)", "albedo at 0°", ""].map(str::to_owned)];
    rows.extend(materials.iter().map(row));
    if rows.len() == 1 {
        return Ok(String::new());
    }
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: [usize; 6] = std::array::from_fn(width);
    let mut text = String::new();
    for row in &rows {
        let cells = row.iter().zip(widths).filter(|(_, width)| *width > 0);
        let line: Vec<String> = cells.map(|(cell, width)| format!("{cell:<width$}")).collect();
        writeln!(text, "  {}", line.join("  ").trim_end())?;
    }
    Ok(text)
}

fn concise(record: &CheckRecord) -> Result<String, std::fmt::Error> {
    let mut text = String::new();
    for file in &record.files {
        for Placed { severity, place, finding } in &file.findings {
            let place = place.map_or(String::new(), |place| format!("{}:{}:", place.line, place.column));
            writeln!(text, "{}:{place} {severity}[{}]: {}", file.path, finding.code, finding.line())?;
        }
    }
    for verdict in record.run.iter().flat_map(|run| &run.verdicts) {
        if verdict.outcome == Outcome::Violated {
            writeln!(text, "{}/{}: violated: {}", verdict.specimen, verdict.suite.name(), verdict.what)?;
        }
    }
    Ok(text)
}

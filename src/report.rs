//! The report: verdicts and figures as files that are the same on every machine.
//!
//! Everything is made in memory first and written file by file, each under a temporary name that is then
//! renamed: an interrupted run leaves the previous report as it was.

mod compare;
mod extremes;
mod figure;
mod page;

use std::fs;
use std::path::Path;
use std::time::Duration;

use bxdf_tests::{Plan, Specimen, Suite, Verdict};
use serde::Serialize;

use crate::file::{WriteError, write};
use crate::ior::{IorError, Table, builtin};
use crate::planted::{SelfCheck, Suites};
use crate::record::RunRecord;
use crate::specimen::{CatalogueError, verify};
use crate::stability;
pub use compare::Difference;
pub use extremes::{Extremes, Worst};
pub use figure::FresnelFigure;

/// Data sets of the thesis's Figure 5: copper, aluminium, iron, diamond, glass and water.
pub const FIGURE_5: [&str; 6] = [
    "aluminium/Rakic-1995",
    "copper/Johnson-1972",
    "iron/Johnson-1974",
    "diamond/Peter-1923",
    "n_bk7/Schott-2017",
    "water/Hale-1973",
];

/// Wavelength \[nm\] of the sodium D line, at which glasses are quoted.
pub const SODIUM_D_NM: f64 = 589.3;

/// Why a report cannot be made, written or compared.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// Optical constants are missing.
    #[error(transparent)]
    Ior(#[from] IorError),
    /// A specimen of the self-check cannot be built.
    #[error(transparent)]
    Specimen(#[from] CatalogueError),
    /// More curves than can be told apart.
    #[error("{given} data sets given: more than {most} cannot be told apart")]
    TooManyCurves {
        /// How many were given.
        given: usize,
        /// How many there may be.
        most: usize,
    },
    /// A chart cannot be drawn.
    #[error("cannot draw {0}: {1}")]
    Drawing(&'static str, String),
    /// Verdicts cannot be written as JSON.
    #[error("cannot write verdicts as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// `planted.json`.
#[derive(Serialize)]
struct SelfCheckFile<'a> {
    schema: &'static str,
    gonio: &'static str,
    #[serde(flatten)]
    check: &'a SelfCheck,
}

/// A self-check as JSON.
pub fn self_check_json(check: &SelfCheck) -> Result<String, serde_json::Error> {
    let file = SelfCheckFile { schema: "gonio-planted-bugs/1", gonio: env!("CARGO_PKG_VERSION"), check };
    serde_json::to_string_pretty(&file).map(|text| text + "\n")
}

/// A report in memory: file names with their contents.
pub struct Report {
    files: Vec<(&'static str, String)>,
    /// The verdicts that it shows.
    pub verdicts: Vec<Verdict>,
    /// The planted bugs that it shows.
    pub self_check: SelfCheck,
    /// Terms that are not as stable as they are said to be.
    pub faults: Vec<String>,
}

impl Report {
    /// Runs all suites on the specimens and on the planted bugs, measures the terms at the extremes, and draws the figures.
    pub fn new(
        specimens: &[Box<dyn Specimen>],
        plan: &Plan,
        finished: &(dyn Fn(&str, Duration) + Sync),
    ) -> Result<Self, ReportError> {
        let tables: Vec<Table> = FIGURE_5.into_iter().map(builtin).collect::<Result<_, _>>()?;
        let figure = FresnelFigure::new(&tables, SODIUM_D_NM)?;
        let svg = figure.svg()?;
        let verdicts = verify(specimens, Suite::ALL, plan, &|_| (), finished);
        let self_check = SelfCheck::run(plan.run_seed, 1, plan.samples, Suites::All, &|| ())?;
        let terms = stability::terms();
        let measured = stability::measure(&terms, plan);
        let extremes = Extremes::new(terms, measured);
        let page = page::html(&page::Contents {
            specimens,
            plan,
            verdicts: &verdicts,
            self_check: &self_check,
            extremes: &extremes,
            figure: &figure,
            svg: &svg,
        })?;
        let examined = specimens.iter().map(|specimen| &**specimen);
        let record = RunRecord::new(plan, Suite::ALL, None, examined, verdicts);
        let files = vec![
            ("index.html", page),
            ("fresnel.svg", svg),
            ("fresnel.csv", figure.csv()?),
            ("verdicts.json", record.json()?),
            ("planted.json", self_check_json(&self_check)?),
            ("extremes.json", extremes.json(plan.run_seed)?),
        ];
        Ok(Self { files, verdicts: record.verdicts, self_check, faults: extremes.faults() })
    }

    /// Writes every file into `folder`, which is made if need be.
    pub fn write(&self, folder: &Path) -> Result<(), ReportError> {
        fs::create_dir_all(folder).map_err(|error| WriteError::new(folder, &error))?;
        for (name, contents) in &self.files {
            write(&folder.join(name), contents.as_bytes())?;
        }
        Ok(())
    }

    /// Compares with the report in `folder`: structure exactly, numbers within a tolerance.
    pub fn compare(&self, folder: &Path) -> Vec<Difference> {
        self.files.iter().filter_map(|(name, contents)| compare::file(&folder.join(name), contents)).collect()
    }
}

//! What a check of material files found, for programs and build servers.

use bxdf_tests::Outcome;
use serde::Serialize;

use super::RunRecord;
use crate::material::{Model, Profile, Summary};
use crate::message::{Finding, Severity};

/// The form of the file; a change of its fields changes the number.
const SCHEMA: &str = "gonio-check/1";

/// Files with their findings and materials, and the run of the suites on these.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckRecord {
    schema: &'static str,
    gonio: &'static str,
    /// The files, in the order in which they were named.
    pub files: Vec<CheckedFile>,
    /// Verdicts on the materials, if suites ran.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<RunRecord>,
}

/// A material file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckedFile {
    /// Its path as it was named.
    pub path: String,
    /// What its colours were held against.
    pub profile: Profile,
    /// Everything there is to say of it, in its order.
    pub findings: Vec<Placed>,
    /// Its materials; one with an error is left out.
    pub materials: Vec<CheckedMaterial>,
}

/// A material of a file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CheckedMaterial {
    /// Its name.
    pub name: String,
    /// Its model.
    pub model: Model,
    /// How rough it is, and how much it mirrors.
    #[serde(flatten)]
    pub summary: Summary,
    /// Directional albedo at normal incidence per channel, if suites ran.
    pub albedo: Option<[f64; 3]>,
    /// The worst verdict, if suites ran.
    pub outcome: Option<Outcome>,
}

/// A finding with its place in lines and columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Placed {
    /// How bad it is.
    pub severity: Severity,
    /// Where it is; nothing for the file as a whole.
    #[serde(flatten)]
    pub place: Option<Place>,
    /// What it is.
    #[serde(flatten)]
    pub finding: Finding,
}

/// A part of a text: lines and columns from 1, columns in characters, the end behind the last.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Place {
    /// First line.
    pub line: usize,
    /// First column.
    pub column: usize,
    /// Last line.
    pub end_line: usize,
    /// Column behind the last.
    pub end_column: usize,
}

impl CheckRecord {
    /// The record of a check.
    pub fn new(files: Vec<CheckedFile>, run: Option<RunRecord>) -> Self {
        Self { schema: SCHEMA, gonio: env!("CARGO_PKG_VERSION"), files, run }
    }

    /// As JSON.
    ///
    /// # Errors
    /// Never; that of the serializer is passed on rather than unwrapped.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }
}

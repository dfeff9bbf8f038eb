//! Material files: TOML, or the same in JSON.
//!
//! ```toml
//! [gonio]
//! version = 1
//! color = "lin_rec709"          # how colours are written; or "srgb"
//! roughness = "alpha"           # what `roughness` means: α, or "perceptual" for α = roughness²
//!
//! [material.kettle]
//! model = "metal"
//! ior = "copper/Johnson-1972"   # a metal is a data set, never a bare name
//! roughness = 0.25
//! ```
//!
//! A key is the id of a parameter of the model, as in its table; angles may be given in degrees or radians, by the
//! end of the key. Conventions that would change what a number means must be declared before they are used.
//! [`read`] reports everything that is wrong with a file at once, each with the bytes it is about.

mod colour;
mod read;
mod schema;
pub(crate) mod syntax;
mod write;

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Read as _;
use std::ops::Range;
use std::path::{Path, PathBuf};

use super::{Description, MaterialError, Model, Profile, Remark, lint};
use crate::message::{Code, Finding, Severity};

use read::of_problem;
pub use read::read;
pub(crate) use read::read_beside;
pub use schema::schema;

/// The version that is read and written.
const VERSION: f64 = 1.0;

/// Bytes of a file at most.
const LARGEST: u64 = 64 << 20;

/// A place in a file. It says nothing about what stands there, so all are equal.
#[derive(Clone, Debug, Default)]
struct Place(Range<usize>);

impl PartialEq for Place {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// How a material file is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Syntax {
    /// TOML.
    Toml,
    /// JSON.
    Json,
}

impl Syntax {
    /// By the extension of a path; TOML unless it is `.json`.
    pub fn of(path: &Path) -> Self {
        let is_json = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        if is_json { Self::Json } else { Self::Toml }
    }
}

/// What a material file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// What colours are held against.
    pub profile: Profile,
    /// The materials, in the order of the file.
    pub materials: Vec<Entry>,
    /// The folder that data sets are looked for in.
    folder: PathBuf,
}

/// A material of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name.
    pub name: String,
    /// What it is.
    pub description: Description,
    /// Remarks that it silences.
    pub allowed: Vec<Allowance>,
    /// Where things stand in the file.
    places: Places,
}

/// Where a material and its parameters stand in a file; all are equal, as a [`Place`] is.
#[derive(Clone, Debug, Default)]
struct Places {
    name: Range<usize>,
    parameters: BTreeMap<String, Range<usize>>,
}

impl Places {
    /// What a description refuses, where it stands.
    fn finding(&self, problem: &MaterialError) -> Finding {
        let span = problem.parameter().and_then(|path| self.parameters.get(path)).unwrap_or(&self.name);
        of_problem(problem, span.clone())
    }
}

impl PartialEq for Places {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// A remark that is silenced, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Allowance {
    /// The kind of the remark.
    pub code: Code,
    /// The parameter that the remark is about.
    pub path: String,
    /// Why it is meant.
    pub reason: String,
    place: Place,
}

impl Entry {
    /// A material that stands in no file yet.
    pub fn new(name: impl Into<String>, description: Description) -> Self {
        Self { name: name.into(), description, allowed: Vec::new(), places: Places::default() }
    }

    /// An error of the material, where it stands in the file.
    pub fn refusal(&self, problem: &MaterialError) -> Finding {
        self.places.finding(problem)
    }

    /// The model.
    pub fn model(&self) -> Model {
        self.description.model()
    }
}

impl Document {
    /// A file of the given materials.
    pub fn new(profile: Profile, materials: Vec<Entry>) -> Self {
        Self { profile, materials, folder: PathBuf::new() }
    }

    /// What is possible but rarely meant: remarks on each material that it does not allow, and allowances that
    /// allow nothing. No lobe is built for that.
    pub fn lint(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        for material in &self.materials {
            let remarks = match lint(&material.description, self.profile) {
                Ok(remarks) => remarks,
                Err(problem) => {
                    findings.push(material.refusal(&problem));
                    continue;
                }
            };
            let answers = |allowance: &Allowance, remark: &Remark| {
                allowance.code == remark.code && allowance.path == remark.path
            };
            for remark in &remarks {
                if !material.allowed.iter().any(|allowance| answers(allowance, remark)) {
                    findings.push(material.finding(remark));
                }
            }
            for allowance in &material.allowed {
                if !remarks.iter().any(|remark| answers(allowance, remark)) {
                    let Allowance { code, path, place: Place(span), .. } = allowance;
                    let text = format!("`{}` gives no cause for {code} of `{path}`", material.name);
                    let finding = Finding::at(Code::NeedlessAllowance, span.clone(), text);
                    findings.push(finding.label("nothing needs this").help("delete it"));
                }
            }
        }
        findings
    }
}

impl Entry {
    fn finding(&self, remark: &Remark) -> Finding {
        let Remark { code, path, text, label, help } = remark;
        let span = self.places.parameters.get(path).unwrap_or(&self.places.name).clone();
        let mut finding = Finding::at(*code, span, format!("`{}`: {text}", self.name)).label(label.clone());
        finding.help.clone_from(help);
        if code.severity() == Severity::Warning {
            let key = if path.contains('.') { format!("\"{path}\"") } else { path.clone() };
            finding.help.push(format!("if it is meant, say why: allow.{code}.{key} = \"…\""));
        }
        finding
    }
}

/// The text of a file.
///
/// # Errors
/// If it cannot be read: it is not there, a folder, too large, empty or not UTF-8.
pub fn text_of(path: &Path) -> Result<String, Finding> {
    let unreadable = |text: String| Finding::of_file(Code::Unreadable, text);
    let shown = path.display();
    let refused = |error: std::io::Error| unreadable(format!("cannot read {shown}: {error}"));
    if path.is_dir() {
        return Err(unreadable(format!("{shown} is a folder")).help("name the files in it"));
    }
    let mut bytes = Vec::new();
    // Not by what the file system says of its size: a device has none.
    File::open(path).and_then(|file| file.take(LARGEST + 1).read_to_end(&mut bytes)).map_err(refused)?;
    if bytes.len() as u64 > LARGEST {
        let text = format!("{shown} is larger than {} MB", LARGEST >> 20);
        return Err(unreadable(text).help("material files are written by hand; is it another kind of file?"));
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        unreadable(format!("{shown} is not UTF-8: the first other byte is at {at}"))
            .help("save the file in that encoding")
    })?;
    if text.trim().is_empty() {
        return Err(unreadable(format!("{shown} is empty")).help("`gonio explain G111` shows a whole file"));
    }
    Ok(text)
}

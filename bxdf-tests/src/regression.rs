//! Violated verdicts as files, written the moment they are found and before anything else is done with them.

use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use crate::plan::Plan;
use crate::verdict::{Outcome, Verdict};

/// The form of the file; a change of its fields changes the number.
const SCHEMA: &str = "bxdf-tests-regression/1";

/// The samples per direction that a file may ask for: single precision has no more numbers.
const MOST_SAMPLES: usize = 1 << 24;

/// A violated verdict with the plan that repeats it: values first, in case no program can repeat them any
/// more.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Regression {
    /// The verdict, unexplained.
    pub verdict: Verdict,
    /// The run seed.
    pub run_seed: u64,
    /// Random samples per direction.
    pub samples_per_setting: usize,
    /// Statistical checks of the whole run, among which the error rate was shared.
    pub statistical_checks: usize,
    schema: String,
}

/// Why a regression cannot be saved or read.
#[derive(Debug, thiserror::Error)]
pub enum RegressionError {
    /// A file or folder cannot be written.
    #[error("cannot write {path}: {error}", path = .path.display())]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A file cannot be read.
    #[error("cannot read {path}: {error}", path = .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: io::Error,
    },
    /// A file is no regression, or a damaged one.
    #[error("{path} is no saved violation, or damaged: {reason}", path = .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
    /// A file of another version.
    #[error("{path} has the form {found}; this program reads {SCHEMA}", path = .path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its form.
        found: String,
    },
}

/// The part that all versions have.
#[derive(serde::Deserialize)]
struct Version {
    schema: String,
}

impl Regression {
    /// A verdict of a run with the given plan.
    pub fn new(verdict: Verdict, plan: &Plan) -> Self {
        Self {
            verdict: Verdict { residual: None, diagnosis: None, smallest: None, ..verdict },
            run_seed: plan.run_seed,
            samples_per_setting: plan.samples,
            statistical_checks: plan.family,
            schema: SCHEMA.to_owned(),
        }
    }

    /// The plan that repeats the verdict.
    pub fn plan(&self) -> Plan {
        Plan { run_seed: self.run_seed, samples: self.samples_per_setting, family: self.statistical_checks }
    }

    /// Writes `specimen/suite.json` in `folder`, whole or not at all, and on the disk when this returns.
    ///
    /// # Errors
    /// Where the system does not let it be written.
    pub fn save(&self, folder: &Path) -> Result<PathBuf, RegressionError> {
        let mut path = folder.to_owned();
        path.extend(self.verdict.specimen.split('/').map(file_name));
        let parent = path.clone();
        path.push(format!("{}.json", self.verdict.suite.name()));
        let failed = |error| RegressionError::Write { path: path.clone(), error };
        let text = serde_json::to_string_pretty(self).map_err(|error| failed(error.into()))? + "\n";
        std::fs::create_dir_all(&parent).map_err(failed)?;
        let mut file = tempfile::Builder::new().prefix(".saving-").tempfile_in(&parent).map_err(failed)?;
        file.write_all(text.as_bytes()).map_err(failed)?;
        file.as_file().sync_all().map_err(failed)?;
        file.persist(&path).map_err(|error| failed(error.error))?;
        // The new name is on the disk once its folder is. Where folders cannot be opened, the system sees to
        // it.
        if let Ok(folder) = File::open(&parent) {
            folder.sync_all().map_err(failed)?;
        }
        Ok(path)
    }

    /// Reads a file that [`Self::save`] wrote.
    ///
    /// # Errors
    /// Where it cannot be read, is damaged, or has the form of another version.
    pub fn read(path: &Path) -> Result<Self, RegressionError> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| RegressionError::Read { path: path.to_owned(), error })?;
        let damaged = |reason: String| RegressionError::Damaged { path: path.to_owned(), reason };
        let Version { schema } = serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))?;
        if schema != SCHEMA {
            return Err(RegressionError::Version { path: path.to_owned(), found: schema });
        }
        let regression: Self = serde_json::from_str(&text).map_err(|error| damaged(error.to_string()))?;
        let Self { samples_per_setting, statistical_checks, .. } = regression;
        if !(1..=MOST_SAMPLES).contains(&samples_per_setting) || statistical_checks == 0 {
            let numbers = format!("{samples_per_setting} samples per direction, {statistical_checks} checks");
            return Err(damaged(numbers));
        }
        Ok(regression)
    }
}

/// The folder that violations are saved in: `BXDF_TESTS_REGRESSIONS`, else `gonio-regressions` where the
/// tests run, which for cargo is the folder of the package. `None`, nothing is saved, if the variable is set
/// but empty.
pub fn regressions_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("BXDF_TESTS_REGRESSIONS").unwrap_or_else(|| "gonio-regressions".into());
    (!folder.is_empty()).then(|| folder.into())
}

/// Saves a verdict if it is violated, and says where, or why not.
pub(crate) fn keep(verdict: &Verdict, plan: &Plan, folder: Option<&Path>) -> Option<String> {
    let folder = folder.filter(|_| verdict.outcome == Outcome::Violated)?;
    Some(match Regression::new(verdict.clone(), plan).save(folder) {
        Ok(path) => format!("saved: {}", path.display()),
        Err(error) => format!("not saved: {error}"),
    })
}

/// Part of a name as that of a file on every system, and back without doubt: what may not stand there in
/// hexadecimal.
fn file_name(part: &str) -> String {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"-_=+,.".contains(&byte);
    // Not hidden, and neither `.` nor `..`.
    let is_plain_at = |i: usize, byte: u8| is_plain(byte) && !(i == 0 && byte == b'.');
    let bytes = part.bytes().enumerate();
    let name: String = bytes
        .map(
            |(i, byte)| {
                if is_plain_at(i, byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") }
            },
        )
        .collect();
    if name.is_empty() { "%".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_files_and_stay_apart() {
        assert_eq!(file_name("alpha=0.3"), "alpha=0.3");
        assert_eq!(file_name(".."), "%2E.");
        assert_eq!(file_name("a:b\\c %"), "a%3Ab%5Cc%20%25");
        assert_eq!(file_name("α"), "%CE%B1");
        assert_eq!(file_name(""), "%");
    }
}

//! Runs as files: verdicts with what they rest on, runs spread over machines and put together again, and the forms that
//! build servers read.
//!
//! A record is the same bytes whatever the number of threads or shards; what depends on the machine is not in it.

mod check;
mod github;
mod junit;

use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use bxdf_tests::{Claims, FAMILY_ERROR_RATE, Plan, Specimen, Suite, Verdict};
use serde::{Deserialize, Serialize};

pub use check::{CheckRecord, CheckedFile, CheckedMaterial, Place, Placed};

/// The form of the file; a change of its fields changes the number.
const SCHEMA: &str = "gonio-verdicts/3";

/// Verdicts with everything that they rest on: `verdicts.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunRecord {
    schema: String,
    gonio: String,
    /// The run seed.
    pub run_seed: u64,
    /// Random samples per direction and transport mode.
    pub samples_per_setting: usize,
    /// Statistical checks of the whole run, among which the error rate is shared.
    pub statistical_checks: usize,
    /// Probability that any of them raises a false alarm.
    pub family_error_rate: f64,
    /// The suites that ran where they apply.
    pub suites: Vec<Suite>,
    /// The part of the run that this is; `None` if it is the whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<Shard>,
    /// What was examined, in order.
    pub specimens: Vec<Examined>,
    /// Verdicts in the order of the specimens.
    pub verdicts: Vec<Verdict>,
}

/// A specimen as a record names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Examined {
    /// Its name.
    pub name: String,
    /// What it promises.
    pub claims: Claims,
}

/// Part `index` of `count`, counted from 1: every `count`-th specimen, so that parts take equally long.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Shard {
    /// Which part.
    pub index: usize,
    /// Of how many.
    pub count: usize,
}

impl Shard {
    /// The part of a list that is this shard's.
    pub fn of<T>(self, all: Vec<T>) -> Vec<T> {
        all.into_iter().skip(self.index - 1).step_by(self.count).collect()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
        match parts {
            Some((index, count)) if (1..=count).contains(&index) => Ok(Self { index, count }),
            _ => Err(format!("`{text}` is not a part such as 1/4: 1 to 4, of 4")),
        }
    }
}

/// Why records cannot be read or put together.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// A file cannot be read.
    #[error("cannot read {path}: {error}", path = .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A file is no record, or a damaged one.
    #[error("{path} is no record of a run, or damaged: {error}; `gonio verify --output json=FILE` writes one", path = .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it and where.
        error: serde_json::Error,
    },
    /// A record of another version.
    #[error("{path} is written by gonio {found}; this is gonio {here}: run its part again", path = .path.display())]
    Version {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: String,
        /// The version of this program.
        here: String,
    },
    /// Parts of different runs.
    #[error("{path} and {first} are parts of different runs: they differ in {what}", path = .path.display(), first = .first.display())]
    Different {
        /// The file.
        path: PathBuf,
        /// The first file.
        first: PathBuf,
        /// In what they differ.
        what: &'static str,
    },
    /// Parts that do not make a whole.
    #[error("{0}")]
    Parts(String),
}

/// The first two fields of every version.
#[derive(Deserialize)]
struct Version {
    schema: String,
    gonio: String,
}

impl RunRecord {
    /// The record of a run, or of one part of it, of the given suites.
    pub fn new<'a>(
        plan: &Plan,
        suites: &[Suite],
        shard: Option<Shard>,
        specimens: impl IntoIterator<Item = &'a dyn Specimen>,
        verdicts: Vec<Verdict>,
    ) -> Self {
        let examined =
            |specimen: &dyn Specimen| Examined { name: specimen.name(), claims: specimen.claims() };
        Self {
            schema: SCHEMA.to_owned(),
            gonio: env!("CARGO_PKG_VERSION").to_owned(),
            run_seed: plan.run_seed,
            samples_per_setting: plan.samples,
            statistical_checks: plan.family,
            family_error_rate: FAMILY_ERROR_RATE,
            suites: suites.to_vec(),
            shard,
            specimens: specimens.into_iter().map(examined).collect(),
            verdicts,
        }
    }

    /// Reads `verdicts.json`.
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let text =
            fs::read_to_string(path).map_err(|error| RecordError::Read { path: path.to_owned(), error })?;
        let damaged = |error| RecordError::Damaged { path: path.to_owned(), error };
        let Version { schema, gonio } = serde_json::from_str(&text).map_err(damaged)?;
        let here = env!("CARGO_PKG_VERSION");
        if schema != SCHEMA || gonio != here {
            let [found, here] = [(&*gonio, &*schema), (here, SCHEMA)].map(|(v, s)| format!("{v} ({s})"));
            return Err(RecordError::Version { path: path.to_owned(), found, here });
        }
        serde_json::from_str(&text).map_err(damaged)
    }

    /// Puts the parts of one run together: the record of the run in one piece, to the byte.
    pub fn merge(parts: Vec<(PathBuf, Self)>) -> Result<Self, RecordError> {
        let mut parts = parts.into_iter();
        let Some((first, whole)) = parts.next() else {
            return Err(RecordError::Parts("nothing to merge".to_owned()));
        };
        let Some(Shard { count, .. }) = whole.shard else {
            let what = format!("{} is not a part: it was written without --shard", first.display());
            return Err(RecordError::Parts(what));
        };
        let mut places: Vec<Option<(PathBuf, Self)>> = Vec::new();
        places.resize_with(count, || None);
        let mut head = Self { shard: None, specimens: Vec::new(), verdicts: Vec::new(), ..whole.clone() };
        for (path, part) in [(first.clone(), whole)].into_iter().chain(parts) {
            if let Some(what) = head.difference(&part, count) {
                return Err(RecordError::Different { path, first, what });
            }
            let index = part.shard.map_or(0, |shard| shard.index - 1);
            if let Some((other, _)) = &places[index] {
                let (path, other) = (path.display(), other.display());
                return Err(RecordError::Parts(format!("{path} and {other} are the same part")));
            }
            places[index] = Some((path, part));
        }
        let missing: Vec<_> = (1..=count).filter(|i| places[i - 1].is_none()).collect();
        if !missing.is_empty() {
            let missing: Vec<_> = missing.iter().map(|i| format!("{i}/{count}")).collect();
            return Err(RecordError::Parts(format!("missing: part {}", missing.join(", "))));
        }
        // In turns, as they were dealt.
        let mut parts: Vec<_> = places
            .into_iter()
            .flatten()
            .map(|(_, part)| (part.specimens.into_iter(), part.verdicts.into_iter().peekable()))
            .collect();
        'dealt: loop {
            for (specimens, verdicts) in &mut parts {
                let Some(specimen) = specimens.next() else { break 'dealt };
                while let Some(verdict) = verdicts.next_if(|verdict| verdict.specimen == specimen.name) {
                    head.verdicts.push(verdict);
                }
                head.specimens.push(specimen);
            }
        }
        Ok(head)
    }

    /// In what a part does not belong to this run of `count` parts.
    fn difference(&self, part: &Self, count: usize) -> Option<&'static str> {
        let belongs = [
            (part.run_seed == self.run_seed, "the run seed"),
            (part.samples_per_setting == self.samples_per_setting, "the number of samples"),
            (part.statistical_checks == self.statistical_checks, "the specimens of the whole run"),
            (part.suites == self.suites, "the suites"),
            (part.shard.is_some_and(|shard| shard.count == count), "the number of parts"),
        ];
        belongs.into_iter().find(|(same, _)| !same).map(|(_, what)| what)
    }

    /// As JSON.
    pub fn json(&self) -> Result<String, serde_json::Error> {
        serde_json::to_string_pretty(self).map(|text| text + "\n")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::{Kind, specimens_of, verify};

    fn record(shard: Option<Shard>) -> RunRecord {
        let specimens: Vec<_> =
            Kind::catalogue().take(1).flat_map(|kind| specimens_of(kind).unwrap()).collect();
        let mut plan = Plan::new(7, specimens.iter().map(|specimen| &**specimen));
        plan.samples = 1000;
        let mine = match shard {
            None => specimens,
            Some(shard) => shard.of(specimens),
        };
        let suites = [Suite::Weight, Suite::Reciprocal];
        let verdicts = verify(&mine, &suites, &plan, &|_| (), &|_, _| ());
        RunRecord::new(&plan, &suites, shard, mine.iter().map(|specimen| &**specimen), verdicts)
    }

    fn parts(count: usize) -> Vec<(PathBuf, RunRecord)> {
        let part = |index| (PathBuf::from(format!("{index}.json")), record(Some(Shard { index, count })));
        (1..=count).map(part).collect()
    }

    #[test]
    fn parts_make_the_run_in_one_piece_in_any_order() {
        let whole = record(None).json().unwrap();
        for count in [1, 2, 4, 6, 9] {
            let mut parts = parts(count);
            parts.reverse();
            assert_eq!(RunRecord::merge(parts).unwrap().json().unwrap(), whole, "{count} parts");
        }
    }

    #[test]
    fn parts_that_do_not_make_a_whole_are_refused() {
        let refused = |parts: Vec<(PathBuf, RunRecord)>| RunRecord::merge(parts).unwrap_err().to_string();
        let mut incomplete = parts(4);
        incomplete.retain(|(_, part)| part.shard != Some(Shard { index: 2, count: 4 }));
        assert_eq!(refused(incomplete), "missing: part 2/4");
        let mut twice = parts(2);
        twice[1] = (PathBuf::from("again.json"), twice[0].1.clone());
        assert_eq!(refused(twice), "again.json and 1.json are the same part");
        let mut other = parts(2);
        other[1].1.run_seed = 8;
        assert_eq!(
            refused(other),
            "2.json and 1.json are parts of different runs: they differ in the run seed"
        );
        assert!(refused(vec![("a".into(), record(None))]).contains("a is not a part"));
    }

    #[test]
    fn what_is_written_is_read_and_what_is_damaged_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("verdicts.json");
        let mut record = record(None);
        record.verdicts[0].value = f64::NAN;
        record.verdicts[1].witness.wo = Some([f64::INFINITY, -0.1, 0.3]);
        let text = record.json().unwrap();
        fs::write(&path, &text).unwrap();
        assert_eq!(RunRecord::read(&path).unwrap().json().unwrap(), text);
        fs::write(&path, &text[..text.len() / 2]).unwrap();
        assert!(
            RunRecord::read(&path).unwrap_err().to_string().contains("is no record of a run, or damaged")
        );
        fs::write(&path, text.replace(SCHEMA, "gonio-verdicts/2")).unwrap();
        let error = RunRecord::read(&path).unwrap_err().to_string();
        assert!(error.contains("is written by gonio 0.1.0 (gonio-verdicts/2)"), "{error}");
    }

    #[test]
    fn shards_are_read_from_text() {
        assert_eq!("2/4".parse(), Ok(Shard { index: 2, count: 4 }));
        for text in ["", "3", "0/4", "5/4", "a/4", "1/0", "-1/4"] {
            let error = text.parse::<Shard>().unwrap_err();
            assert!(error.contains("is not a part such as 1/4"), "{error}");
        }
    }
}

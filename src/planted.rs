//! Planted bugs: every suite can go red. A small bug in a correct specimen is found by the suite that must find it,
//! for the reason that it was planted; the specimen without the bug, its twin, holds.
//!
//! [`PlantedBug::ALL`] is the list; [`SelfCheck`] runs every suite on every bug and twin: the matrix bug × suite.
//! `planted/list.rs` has the bugs, `planted/specimens.rs` what they are planted in.

mod list;
mod mutant;
mod rough_glass;
mod specimens;
mod terms;

use bxdf_tests::{Examination, Outcome, Plan, Specimen, Suite, Verdict};
use rayon::prelude::*;
use serde::Serialize;

use crate::specimen::CatalogueError;
use mutant::{Bug, Mutant};

/// Who must find a bug.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Finder {
    /// A suite, by a check whose description contains the text.
    Suite(Suite, &'static str),
    /// No suite: the claims do not speak of it. What finds it instead.
    Elsewhere(&'static str),
}

/// A bug in a correct specimen.
#[derive(Debug)]
pub struct PlantedBug {
    /// What is wrong, as one word.
    pub name: &'static str,
    /// Who must find it.
    pub finder: Finder,
    /// Random samples per direction that it takes to find it with probability 0.99 or more.
    pub samples: usize,
    specimen: fn() -> Result<Box<dyn Specimen>, CatalogueError>,
    bugs: &'static [Bug],
    in_family: bool,
}

impl PlantedBug {
    /// Every planted bug.
    pub const ALL: &[Self] = list::BUGS;

    /// The specimen with the bug; its name is that of the bug.
    ///
    /// # Errors
    /// Never for the parameters listed; the constructors' errors are passed on rather than unwrapped.
    pub fn mutant(&self) -> Result<Box<dyn Specimen>, CatalogueError> {
        let name = format!("planted/{}", self.name);
        Ok(Box::new(Mutant::new(name, (self.specimen)()?, self.bugs, self.in_family)))
    }

    /// The correct twin.
    ///
    /// # Errors
    /// As [`Self::mutant`].
    pub fn twin(&self) -> Result<Box<dyn Specimen>, CatalogueError> {
        let specimen = (self.specimen)()?;
        let name = specimen.name();
        let name = name.split('/').next().unwrap_or_default();
        Ok(Box::new(Mutant::new(format!("twin/{name}"), specimen, &[], true)))
    }

    /// Whether the verdict is the one for which the bug was planted.
    pub fn is_caught_by(&self, verdict: &Verdict) -> bool {
        match self.finder {
            Finder::Suite(suite, what) => {
                verdict.suite == suite && verdict.outcome == Outcome::Violated && verdict.what.contains(what)
            }
            Finder::Elsewhere(_) => false,
        }
    }
}

/// How the search for one bug ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Search {
    /// The suite that must find it did, with every seed.
    Caught,
    /// It did not, with one seed at least.
    Missed,
    /// It did not, and needs more samples than were drawn.
    NeedsMoreSamples,
    /// No suite can.
    Elsewhere,
}

/// One row of the matrix: a specimen and what each suite said.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// Name of the bug or of the twin.
    pub name: String,
    /// What each suite concluded with the first seed; those that do not apply are left out.
    pub outcomes: Vec<(Suite, Outcome)>,
}

impl Row {
    /// What a suite concluded; `None` where it does not apply.
    pub fn outcome(&self, suite: Suite) -> Option<Outcome> {
        self.outcomes.iter().find(|(other, _)| *other == suite).map(|&(_, outcome)| outcome)
    }
}

/// What became of one bug.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// The bug with what each suite said.
    #[serde(flatten)]
    pub row: Row,
    /// Name of its twin.
    pub twin: String,
    /// The suite that must find it.
    pub suite: Option<Suite>,
    /// What finds it where no suite can.
    pub elsewhere: Option<&'static str>,
    /// Samples per direction that it takes.
    pub least_samples: usize,
    /// With how many seeds it was caught.
    pub caught: usize,
    /// How the search ended.
    pub search: Search,
    /// Most telling check of the suite that must find it, with the first seed.
    pub what: String,
    /// Value of that check; not a number if the specimen's values are not.
    pub value: f64,
    /// Limit of that check.
    pub limit: f64,
}

/// Which suites look at a bug with the first run seed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Suites {
    /// Every one: the whole matrix.
    All,
    /// The one that must find it; all where none can.
    Finder,
}

/// Every planted bug and every twin against every suite.
#[derive(Clone, Debug, Serialize)]
pub struct SelfCheck {
    /// The first run seed; the others follow it.
    pub run_seed: u64,
    /// How many run seeds. With the first the suites run that were asked for, with the others the one that must find the
    /// bug.
    pub seeds: usize,
    /// Random samples per direction.
    pub samples: usize,
    /// The bugs.
    pub bugs: Vec<Found>,
    /// The twins, each once.
    pub twins: Vec<Row>,
    /// Verdicts on twins that do not hold, with any seed: there must be none.
    pub failures: Vec<Verdict>,
}

impl SelfCheck {
    /// Bugs and twins, which are what [`Self::run`] reports as finished.
    pub fn size() -> Result<usize, CatalogueError> {
        Ok(PlantedBug::ALL.len() + twins()?.len())
    }

    /// Runs the suites, in parallel; the result depends on neither order nor threads.
    ///
    /// # Errors
    /// As [`PlantedBug::mutant`].
    pub fn run(
        run_seed: u64,
        seeds: usize,
        samples: usize,
        suites: Suites,
        finished: &(dyn Fn() + Sync),
    ) -> Result<Self, CatalogueError> {
        let mutants =
            PlantedBug::ALL.par_iter().map(PlantedBug::mutant).collect::<Result<Vec<_>, CatalogueError>>()?;
        let twins = twins()?;
        let plans: Vec<Plan> = (0..seeds as u64)
            .map(|i| {
                let everything = mutants.iter().chain(&twins).map(|specimen| &**specimen);
                Plan { samples, ..Plan::new(run_seed.wrapping_add(i), everything) }
            })
            .collect();
        let bugs = PlantedBug::ALL
            .par_iter()
            .zip(&mutants)
            .with_max_len(1)
            .map(|(bug, mutant)| {
                let found = search(bug, &**mutant, &plans, suites)?;
                finished();
                Ok(found)
            })
            .collect::<Result<_, CatalogueError>>()?;
        let (twins, failures): (Vec<_>, Vec<_>) = twins
            .par_iter()
            .with_max_len(1)
            .map(|twin| {
                let mut verdicts: Vec<Verdict> = Vec::new();
                let mut row = None;
                for plan in &plans {
                    let new = bxdf_tests::examine(&**twin, plan);
                    row.get_or_insert_with(|| self::row(twin.name(), &new));
                    verdicts.extend(new);
                }
                verdicts.retain(|verdict| verdict.outcome != Outcome::Holds);
                finished();
                (row, verdicts)
            })
            .unzip();
        let twins = twins.into_iter().flatten().collect();
        Ok(Self { run_seed, seeds, samples, bugs, twins, failures: failures.concat() })
    }

    /// No bug is missed and every twin holds.
    pub fn passes(&self) -> bool {
        self.failures.is_empty() && self.count(Search::Missed) == 0
    }

    /// How many searches ended so.
    pub fn count(&self, search: Search) -> usize {
        self.bugs.iter().filter(|bug| bug.search == search).count()
    }
}

/// The twins of all bugs, each once, in the order of the list.
fn twins() -> Result<Vec<Box<dyn Specimen>>, CatalogueError> {
    let mut twins: Vec<Box<dyn Specimen>> = Vec::new();
    for (i, bug) in PlantedBug::ALL.iter().enumerate() {
        // Coats take some time to build: ask the function before the name.
        if PlantedBug::ALL[..i].iter().any(|other| core::ptr::fn_addr_eq(other.specimen, bug.specimen)) {
            continue;
        }
        let twin = bug.twin()?;
        if twins.iter().all(|other| other.name() != twin.name()) {
            twins.push(twin);
        }
    }
    Ok(twins)
}

fn row(name: String, verdicts: &[Verdict]) -> Row {
    let name = name.rsplit('/').next().unwrap_or_default().to_owned();
    Row { name, outcomes: verdicts.iter().map(|verdict| (verdict.suite, verdict.outcome)).collect() }
}

fn search(
    bug: &PlantedBug,
    mutant: &dyn Specimen,
    plans: &[Plan],
    suites: Suites,
) -> Result<Found, CatalogueError> {
    let (suite, elsewhere) = match bug.finder {
        Finder::Suite(suite, _) => (Some(suite), None),
        Finder::Elsewhere(where_) => (None, Some(where_)),
    };
    let mut found = Found {
        row: row(mutant.name(), &[]),
        twin: row(bug.twin()?.name(), &[]).name,
        suite,
        elsewhere,
        least_samples: bug.samples,
        caught: 0,
        search: Search::Elsewhere,
        what: String::new(),
        value: f64::NAN,
        limit: f64::NAN,
    };
    let samples = plans.first().map_or(0, |plan| plan.samples);
    for (i, plan) in plans.iter().enumerate() {
        let by_all = i == 0 && (suites == Suites::All || suite.is_none());
        let verdicts = if by_all {
            bxdf_tests::examine(mutant, plan)
        } else {
            let examination = Examination::new(mutant, plan);
            suite.and_then(|suite| examination.verdict(suite)).into_iter().collect()
        };
        found.caught += usize::from(verdicts.iter().any(|verdict| bug.is_caught_by(verdict)));
        if i == 0 {
            found.row = row(mutant.name(), &verdicts);
            if let Some(verdict) = verdicts.into_iter().find(|verdict| Some(verdict.suite) == suite) {
                (found.what, found.value, found.limit) = (verdict.what, verdict.value, verdict.limit);
            }
        }
    }
    if suite.is_some() {
        found.search = if found.caught == plans.len() {
            Search::Caught
        } else if samples < bug.samples {
            Search::NeedsMoreSamples
        } else {
            Search::Missed
        };
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_suite_has_a_planted_bug_and_names_are_unique() {
        for &suite in Suite::ALL {
            let finds = |bug: &&PlantedBug| matches!(bug.finder, Finder::Suite(other, _) if other == suite);
            assert!(
                PlantedBug::ALL.iter().any(|bug| finds(&bug)),
                "no planted bug for suite {}",
                suite.name()
            );
        }
        let mut names: Vec<_> = PlantedBug::ALL.iter().map(|bug| bug.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), PlantedBug::ALL.len());
    }
}

//! What a violated suite says beyond its verdict: where, why, and the smallest case that still fails.

use core::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::diagnosis::{Diagnosis, of_counts, of_weights, roughness};
use crate::plan::{Plan, Setting};
use crate::residual::{Residual, gather};
use crate::specimen::Transport;
use crate::suite::{Examination, Suite, Surveyed};
use crate::survey::Look;
use crate::verdict::{Outcome, Verdict, Witness};

/// Directions that a diagnosis of counts rests on.
const SETTINGS: usize = 5;
/// |cos θo| below which a direction is left out of a diagnosis, unless it is the most telling one.
const LEAST_COSINE: f64 = 0.17;
/// Independent seeds with each of which the smallest case must fail.
const SEEDS: u64 = 10;
/// The smallest number of samples that is tried.
const FEWEST: usize = 64;

/// The smallest case of a statistical violation: the first of the plan's directions, from normal incidence
/// on, and the fewest samples, a power of two, that fail with each of ten independent seeds.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Smallest {
    /// The direction, and what is carried.
    pub witness: Witness,
    /// Random samples.
    pub samples: usize,
}

impl fmt::Display for Smallest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "  smallest case: {} samples, {SEEDS} of {SEEDS} seeds fail", self.samples)?;
        match self.witness.wo {
            Some([x, y, z]) => write!(f, ", at wo ({x:e}, {y:e}, {z:e})"),
            None => Ok(()),
        }
    }
}

impl Examination<'_> {
    /// A violated verdict with what explains it: residuals, a diagnosis and the smallest case, as far as they
    /// are to be had. Others are returned as they are.
    ///
    /// That takes some seconds, so it is not part of [`Self::verdict`].
    pub fn explained(&self, mut verdict: Verdict) -> Verdict {
        // A panic has no limit; it was told with its call.
        if verdict.outcome != Outcome::Violated || verdict.limit.is_nan() {
            return verdict;
        }
        // A specimen that panics now has been told of, or will be by another suite.
        let explanation = || match verdict.suite {
            Suite::ChiSquare | Suite::Normalised => {
                let (residual, diagnosis) = self.counts(&verdict);
                (residual, diagnosis, self.smallest(verdict.suite))
            }
            // The mean weight: either the weights are wrong or the samples.
            Suite::Energy if verdict.what.contains("mean weight") => {
                let diagnosis = self.weights(&verdict).or_else(|| self.counts(&verdict).1);
                (None, diagnosis, self.smallest(verdict.suite))
            }
            Suite::Jacobian => (None, self.counts(&verdict).1, None),
            Suite::Weight => (None, self.weights(&verdict), None),
            _ => (None, None, None),
        };
        if let Ok(explanation) = catch_unwind(AssertUnwindSafe(explanation)) {
            (verdict.residual, verdict.diagnosis, verdict.smallest) = explanation;
        }
        verdict
    }

    /// Residuals at the direction of a verdict, and what explains them there and at some more directions.
    fn counts(&self, verdict: &Verdict) -> (Option<Residual>, Option<Diagnosis>) {
        let Witness { wo, transport, .. } = verdict.witness;
        let is_here = |Surveyed { setting, .. }: &&Surveyed| {
            Some(setting.wo) == wo && Some(setting.transport) == transport
        };
        let Some(here) = self.surveys().iter().find(is_here) else { return (None, None) };
        let others: Vec<&Surveyed> = self
            .surveys()
            .iter()
            .filter(|other| {
                other.tally.is_some() && !is_here(other) && other.setting.wo[2].abs() > LEAST_COSINE
            })
            .collect();
        // Evenly spread over the plan.
        let others = (0..SETTINGS - 1).filter_map(|i| others.get(i * others.len() / (SETTINGS - 1)));
        let mut chosen = vec![here];
        others.for_each(|other| {
            if chosen.iter().all(|known| known.setting != other.setting) {
                chosen.push(other);
            }
        });
        let explain = |chosen: &[&Surveyed]| {
            let settings: Vec<Setting> = chosen.iter().map(|surveyed| surveyed.setting).collect();
            let roughness = roughness(self, &settings);
            let gathered =
                chosen.iter().enumerate().map(|(i, surveyed)| gather(self, surveyed, i, roughness));
            let evidence: Vec<_> = gathered.collect();
            let diagnosis = of_counts(&evidence, roughness);
            (evidence, diagnosis)
        };
        let (mut evidence, diagnosis) = explain(&chosen);
        let residual = evidence.swap_remove(0).residual;
        // Next to the tangent plane ratios are so large that different bugs seem to explain all of them.
        let is_grazing = here.setting.wo[2].abs() <= LEAST_COSINE;
        let elsewhere = if is_grazing && chosen.len() > 1 { explain(&chosen[1..]).1 } else { None };
        (residual, elsewhere.or(diagnosis))
    }

    /// What explains the weights, or the densities that samples report.
    fn weights(&self, verdict: &Verdict) -> Option<Diagnosis> {
        let transport = verdict.witness.transport.unwrap_or(Transport::Radiance);
        let settings = self.settings().into_iter();
        let settings: Vec<Setting> = if self.claims.transmits {
            settings.filter(|setting| setting.transport == transport).collect()
        } else {
            settings.map(|setting| Setting { transport, ..setting }).collect()
        };
        let roughness = roughness(self, &settings);
        of_weights(self, &settings, roughness, verdict.what.contains("reported density"))
    }

    /// The smallest case of a violation of a statistical suite.
    fn smallest(&self, suite: Suite) -> Option<Smallest> {
        let level = self.plan.ln_level();
        let fails = |plan: &Plan, surveyed: &Surveyed, repetition: u64| {
            // A delta too rare for the pilot samples is added as it is met.
            let mut survey = surveyed.survey.clone();
            let subject = (self.specimen, self.name.as_str());
            let plan = plan.repetition(repetition);
            let tally = survey.tally(subject, &self.claims, &plan, &surveyed.setting, Look::FIRST);
            self.p_values(&survey, &tally).iter().any(|(of, p)| *of == suite && p.ln_p < level)
        };
        let violated = |surveyed: &&Surveyed| {
            let p_values = surveyed.tally.as_ref().map(|tally| self.p_values(&surveyed.survey, tally));
            p_values.into_iter().flatten().any(|(of, p)| of == suite && p.ln_p < level)
        };
        let surveyed = self.surveys().iter().find(violated)?;
        let numbers = core::iter::successors(Some(FEWEST), |samples| Some(2 * samples));
        let samples = numbers.take_while(|&samples| samples <= self.plan.samples).find(|&samples| {
            let plan = Plan { samples, ..self.plan.clone() };
            (1..=SEEDS).all(|repetition| fails(&plan, surveyed, repetition))
        })?;
        Some(Smallest { witness: surveyed.setting.witness(), samples })
    }
}

/// What verdicts that do not hold say. Violations that share a diagnosis are shown once, with their number.
pub fn failure_report(verdicts: &[Verdict]) -> String {
    let mut text = String::new();
    let mut told: Vec<&Diagnosis> = Vec::new();
    for verdict in verdicts.iter().filter(|verdict| verdict.outcome != Outcome::Holds) {
        let Some(diagnosis) = &verdict.diagnosis else {
            text += &format!("{verdict}{}\n\n", of_others(verdict, verdicts));
            continue;
        };
        if told.iter().any(|known| known.bug == diagnosis.bug) {
            continue;
        }
        told.push(diagnosis);
        let shares =
            |other: &&Verdict| other.diagnosis.as_ref().is_some_and(|other| other.bug == diagnosis.bug);
        // χ² shows most.
        let shown = verdicts.iter().filter(shares).find(|other| other.suite == Suite::ChiSquare);
        let shown = shown.unwrap_or(verdict);
        let rest: Vec<&Verdict> =
            verdicts.iter().filter(shares).filter(|other| !core::ptr::eq(*other, shown)).collect();
        text += &format!("{shown}{}\n", of_others(shown, verdicts));
        if !rest.is_empty() {
            let mut names: Vec<&str> = rest.iter().map(|other| other.specimen.as_str()).collect();
            names.push(&shown.specimen);
            names.sort_unstable();
            names.dedup();
            text += &format!(
                "  the same diagnosis for {} violations of {} {}, with\n",
                rest.len() + 1,
                names.len(),
                if names.len() == 1 { "specimen" } else { "specimens" }
            );
            rest.iter().for_each(|other| text += &format!("    {}\n", other.headline()));
        }
        text.push('\n');
    }
    text
}

/// What became of the other suites of the same specimen.
pub(crate) fn of_others(verdict: &Verdict, verdicts: &[Verdict]) -> String {
    let names = |outcome: Outcome| -> Option<String> {
        let is_one = |other: &&Verdict| {
            other.specimen == verdict.specimen && other.suite != verdict.suite && other.outcome == outcome
        };
        let names: Vec<_> = verdicts.iter().filter(is_one).map(|other| other.suite.name()).collect();
        (!names.is_empty()).then(|| names.join(", "))
    };
    let mut text = String::new();
    for (outcome, words) in [
        (Outcome::Violated, "also violated"),
        (Outcome::Inconclusive, "inconclusive"),
        (Outcome::Holds, "still hold"),
    ] {
        if let Some(names) = names(outcome) {
            text += &format!("\n  {words}: {names}");
        }
    }
    text
}

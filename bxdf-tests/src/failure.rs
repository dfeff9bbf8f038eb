//! What a violated suite says beyond its verdict: where, why, and the smallest case that still fails.

use core::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

use crate::diagnosis::{Diagnosis, of_counts, of_exchange, of_weights, roughness};
use crate::plan::{Plan, Setting, direction, sides};
use crate::residual::{Residual, gather};
use crate::specimen::{Direction, Parameter, Transport};
use crate::suite::{Examination, Suite, Surveyed};
use crate::survey::Look;
use crate::verdict::{Ledger, MOST_PARAMETERS, Outcome, Verdict, Witness};

/// Directions that a diagnosis of counts rests on.
const SETTINGS: usize = 5;
/// |cos θo| below which a direction is left out of a diagnosis, unless it is the most telling one.
const LEAST_COSINE: f64 = 0.17;
/// Independent seeds with each of which the smallest case must fail.
const SEEDS: u64 = 10;
/// The smallest number of samples that is tried.
const FEWEST: usize = 64;

/// Members of a family that are tried.
const MEMBERS: usize = 24;
/// Simple values of a parameter that are tried.
const VALUES: usize = 10;

/// Polar angles of directions \[deg\] at which a smallest case is looked for, and azimuths of `wi`; those of
/// `wo` are 0.
const SIMPLE_POLAR_DEG: [f64; 4] = [0.0, 30.0, 60.0, 80.0];
const SIMPLE_AZIMUTH_DEG: [f64; 3] = [180.0, 90.0, 0.0];
/// Uniforms of a sample there.
const SIMPLE_UNIFORMS: [f64; 3] = [0.5, 0.25, 0.75];

/// The smallest case that still fails.
///
/// Of a statistical violation: the first of the plan's directions, from normal incidence on, and the fewest
/// samples, a power of two, that fail with each of ten independent seeds. Of a check at one place: directions
/// and uniforms of few digits at which the same check fails.
///
/// For one of a family it is about the simplest member that fails, of a statistical violation no later and
/// with no more samples than the specimen itself: first those whose parameters are all the same simple
/// number, then others. 1 is the simplest number, then 0.5, 2, 0.2, 5, ...
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Smallest {
    /// The parameters of the member of a family; none for the specimen as it is.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<(String, f64)>,
    /// The direction or the place, and what is carried.
    pub witness: Witness,
    /// Random samples; 0 where nothing is a matter of chance.
    pub samples: usize,
}

impl fmt::Display for Smallest {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Witness { wo, wi, uniforms, transport, .. } = self.witness;
        let mut parts: Vec<String> =
            self.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
        // The direction of a sample follows from its uniforms.
        for (name, w) in [("o", wo), ("i", wi.filter(|_| uniforms.is_none()))] {
            let Some([x, y, z]) = w else { continue };
            let degrees = |radians: f64| (1000.0 * radians.to_degrees()).round() / 1000.0 + 0.0;
            let polar = libm::atan2(libm::hypot(x, y), z);
            parts.push(format!("θ{name} {}°", degrees(polar)));
            if degrees(libm::sin(polar)) != 0.0 {
                parts.push(format!("φ{name} {}°", degrees(libm::atan2(y, x))));
            }
        }
        parts.extend(uniforms.map(|[c, u, v]| format!("uniforms {c} {u} {v}")));
        parts
            .extend(transport.filter(|&mode| mode == Transport::Importance).map(|_| "importance".to_owned()));
        if self.samples > 0 {
            parts.push(format!("{} samples ({SEEDS} of {SEEDS} seeds fail)", self.samples));
        }
        write!(f, "  smallest case: {}", parts.join(", "))
    }
}

/// The members of a family with simple parameters: first those where all are the same, then the others, each
/// in the order of its simplicity.
fn simple_members(parameters: &[Parameter]) -> Vec<Vec<f64>> {
    let mut members = vec![(0, Vec::new())];
    for parameter in parameters.iter().take(MOST_PARAMETERS) {
        let values: Vec<f64> = parameter.simple().take(VALUES).collect();
        let with = |(rank, member): &(usize, Vec<f64>)| {
            let with = |(i, &value): (usize, &f64)| (rank + i, [&member[..], &[value]].concat());
            values.iter().enumerate().map(with).collect::<Vec<_>>()
        };
        members = members.iter().flat_map(with).collect();
    }
    members.sort_by_key(|(rank, member)| (member.windows(2).any(|pair| pair[0] != pair[1]), *rank));
    members.into_iter().map(|(_, member)| member).take(MEMBERS).collect()
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
            Suite::Weight => (None, self.weights(&verdict), self.simplest(&verdict)),
            Suite::Reciprocal => (None, self.exchange(), self.simplest(&verdict)),
            Suite::Finite => (None, None, self.simplest(&verdict)),
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
            let diagnosis = of_counts(&evidence, roughness, &self.claims);
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

    /// What explains that directions cannot be exchanged.
    fn exchange(&self) -> Option<Diagnosis> {
        let settings = self.settings().into_iter().filter(|setting| setting.transport == Transport::Radiance);
        let settings: Vec<Setting> = settings.collect();
        of_exchange(self, &settings, roughness(self, &settings))
    }

    /// The smallest case of a violation of a statistical suite.
    fn smallest(&self, suite: Suite) -> Option<Smallest> {
        let here = self.surveys().iter().find_map(|surveyed| {
            let samples = self.fewest(suite, surveyed, self.plan.samples)?;
            Some(Smallest { parameters: Vec::new(), witness: surveyed.setting.witness(), samples })
        })?;
        self.simple_member(suite, |member| member.no_larger(suite, &here)).or(Some(here))
    }

    /// The smallest case of a violation that needs no samples.
    fn simplest(&self, verdict: &Verdict) -> Option<Smallest> {
        let member = self.simple_member(verdict.suite, |member| member.simple_place(verdict));
        member.or_else(|| self.simple_place(verdict))
    }

    /// The smallest case of the first simple member of the family that has one.
    fn simple_member(
        &self,
        suite: Suite,
        case: impl Fn(&Examination<'_>) -> Option<Smallest>,
    ) -> Option<Smallest> {
        let family = self.specimen.family()?;
        simple_members(family.parameters()).into_iter().find_map(|values| {
            let member = || {
                let member = family.at(&values)?;
                let member = Examination::named(self.name.clone(), &*member, self.plan);
                let is_meant = member.claims.waivers.iter().all(|waiver| waiver.suite != suite);
                let case = (is_meant && suite.applies(&member.claims)).then(|| case(&member))??;
                let names = family.parameters().iter().map(|parameter| parameter.name.to_owned());
                Some(Smallest { parameters: names.zip(values.iter().copied()).collect(), ..case })
            };
            // One that panics is no smaller case of this.
            catch_unwind(AssertUnwindSafe(member)).ok().flatten()
        })
    }

    /// The first simple place at which the check of a verdict fails: a pair of directions if there is one,
    /// else a sample.
    fn simple_place(&self, verdict: &Verdict) -> Option<Smallest> {
        let towards = |polar_deg: f64, azimuth_deg: f64, is_above: bool| {
            let [x, y, z] = direction(polar_deg, azimuth_deg.to_radians());
            [x, y, if is_above { z } else { -z }].map(|x| self.claims.precision.round(x))
        };
        let settings: Vec<Setting> = sides(&self.claims)
            .iter()
            .flat_map(|&is_above| SIMPLE_POLAR_DEG.map(|polar_deg| towards(polar_deg, 0.0, is_above)))
            .flat_map(|wo| {
                [Transport::Radiance, Transport::Importance].map(|transport| Setting {
                    wo,
                    transport,
                    is_counted: false,
                })
            })
            .collect();
        let fails = |check: &dyn Fn(&mut Ledger)| {
            let mut ledger = Ledger::about(verdict);
            check(&mut ledger);
            ledger.violation().map(|check| check.witness)
        };
        let wi: Vec<Direction> = [true, false]
            .into_iter()
            .flat_map(|is_above| SIMPLE_POLAR_DEG.map(|polar_deg| (is_above, polar_deg)))
            .flat_map(|(is_above, polar_deg)| {
                SIMPLE_AZIMUTH_DEG.map(|azimuth_deg| towards(polar_deg, azimuth_deg, is_above))
            })
            .collect();
        let of_pair = |setting: &Setting| {
            wi.iter().find_map(|&wi| {
                fails(&|ledger: &mut Ledger| verdict.suite.check_pair(self, ledger, setting, wi))
            })
        };
        let of_sample = |setting: &Setting| {
            (0..27).find_map(|i: usize| {
                let uniforms = [i, i / 3, i / 9].map(|i| SIMPLE_UNIFORMS[i % 3]);
                fails(&|ledger: &mut Ledger| verdict.suite.check_sample(self, ledger, setting, uniforms))
            })
        };
        let witness = settings.iter().find_map(of_pair).or_else(|| settings.iter().find_map(of_sample))?;
        Some(Smallest { parameters: Vec::new(), witness, samples: 0 })
    }

    /// The smallest case of a member of the family that is no larger than another one.
    fn no_larger(&self, suite: Suite, other: &Smallest) -> Option<Smallest> {
        let [.., cosine] = other.witness.wo?;
        // At the same angle but for rounding.
        let no_later = |setting: &Setting| setting.is_counted && setting.wo[2].abs() > cosine.abs() - 1e-9;
        self.settings().into_iter().filter(no_later).find_map(|setting| {
            let samples = self.fewest(suite, &self.look(setting, Look::FIRST), other.samples)?;
            Some(Smallest { parameters: Vec::new(), witness: setting.witness(), samples })
        })
    }

    /// The fewest samples, `most` or less, with which a suite fails at a direction for each of the seeds.
    fn fewest(&self, suite: Suite, surveyed: &Surveyed, most: usize) -> Option<usize> {
        let level = self.plan.ln_level();
        let fails = |Surveyed { survey, tally, .. }: &Surveyed| {
            let p_values = tally.as_ref().map(|tally| self.p_values(survey, tally));
            p_values.into_iter().flatten().any(|(of, p)| of == suite && p.ln_p < level)
        };
        if !fails(surveyed) {
            return None;
        }
        let numbers = core::iter::successors(Some(FEWEST), |samples| Some(2 * samples));
        numbers.take_while(|&samples| samples <= most).find(|&samples| {
            let plan = Plan { samples, ..self.plan.clone() };
            (1..=SEEDS).all(|seed| fails(&self.repeated(surveyed, &plan.repetition(seed))))
        })
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::specimen::Scale;

    #[test]
    fn members_are_tried_from_the_simplest_on() {
        let parameter = |low, high, scale| Parameter { name: "", low, high, scale };
        let alpha = parameter(0.05, 1.0, Scale::Logarithmic);
        let eta = parameter(0.4, 2.5, Scale::Logarithmic);
        let members = simple_members(&[alpha, eta]);
        let first = [[1.0, 1.0], [0.5, 0.5], [1.0, 0.5], [0.5, 1.0], [1.0, 2.0], [0.2, 1.0], [0.5, 2.0]];
        assert_eq!(members[..7], first.map(Vec::from));
        assert_eq!(members.len(), 15);
        let values: Vec<f64> = parameter(-0.5, 0.3, Scale::Linear).simple().collect();
        assert_eq!(
            values,
            [
                0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001, 0.0, -0.5, -0.2, -0.1, -0.05, -0.02, -0.01,
                -0.005, -0.002, -0.001
            ]
        );
        assert_eq!(simple_members(&[alpha; MOST_PARAMETERS]).len(), MEMBERS);
        // Nothing simple lies in the range.
        assert!(simple_members(&[alpha, parameter(0.31, 0.39, Scale::Linear)]).is_empty());
    }
}

//! Verdicts with their evidence.

use crate::diagnosis::Diagnosis;
use crate::failure::Smallest;
use crate::number;
use crate::residual::Residual;
use crate::specimen::{Direction, Parameter, Transport};
use crate::suite::Suite;

/// What a suite concluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// No check found the claim violated.
    Holds,
    /// At least one check contradicts the claim.
    Violated,
    /// The evidence cannot carry a conclusion; the verdict says why.
    Inconclusive,
}

/// Where in the domain something was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Witness {
    /// The given direction.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "number::triple")]
    pub wo: Option<Direction>,
    /// The other direction, or the micro normal.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "number::triple")]
    pub wi: Option<Direction>,
    /// The uniforms of a sample.
    #[serde(default, skip_serializing_if = "Option::is_none", with = "number::triple")]
    pub uniforms: Option<[f64; 3]>,
    /// What was carried.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub transport: Option<Transport>,
    /// Which member of a family it was, unless it was the specimen itself.
    #[serde(skip)]
    pub(crate) parameters: Parameters,
}

/// How many parameters a family may have.
pub const MOST_PARAMETERS: usize = 4;

/// Parameters with their values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Parameters([Option<(&'static str, f64)>; MOST_PARAMETERS]);

impl Parameters {
    pub(crate) fn new(parameters: &[Parameter], values: &[f64]) -> Self {
        let pair = |i: usize| Some((parameters.get(i)?.name, *values.get(i)?));
        Self(core::array::from_fn(pair))
    }

    /// Names and values.
    fn iter(&self) -> impl Iterator<Item = (&'static str, f64)> {
        self.0.into_iter().flatten()
    }
}

impl Witness {
    /// A witness that is one given direction.
    pub fn at(wo: Direction, transport: Transport) -> Self {
        Self { wo: Some(wo), transport: Some(transport), ..Self::default() }
    }
    /// The same with the other direction.
    pub fn with_wi(self, wi: Direction) -> Self {
        Self { wi: Some(wi), ..self }
    }
    /// The same with the uniforms of a sample.
    pub fn with_uniforms(self, uniforms: [f64; 3]) -> Self {
        Self { uniforms: Some(uniforms), ..self }
    }
}

/// The minimum detectable effect of a statistical check: what it would have found with probability 0.99.
///
/// The effect is the relative error of whatever `what` names. For densities it is the root mean square over the samples
/// of the relative deviation; a component picked with probability q (1 + ε) instead of q, apart from the others,
/// deviates by ε √(q / (1 − q)), which is ε for a component that is picked half of the time.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Detectable<Text = String> {
    /// What would be off, in words.
    pub what: Text,
    /// By how much, at the number of samples and the level of the verdict.
    pub effect: f64,
    /// Samples per direction with which an effect of 1 % would be found as surely.
    pub samples_for_one_percent: f64,
}

impl Detectable<&'static str> {
    fn owned(self) -> Detectable {
        let Self { what, effect, samples_for_one_percent } = self;
        Detectable { what: what.to_owned(), effect, samples_for_one_percent }
    }
}

/// One comparison: it holds where `value <= limit`. NaN and infinities never hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Check {
    /// What was measured, in words, with its unit.
    pub(crate) what: &'static str,
    pub(crate) value: f64,
    pub(crate) limit: f64,
    pub(crate) witness: Witness,
    /// Number of random samples behind the value; 0 where none.
    pub(crate) samples: u64,
    /// Number of cells of a χ² table after pooling.
    pub(crate) cells: Option<usize>,
    /// Why the evidence cannot carry a conclusion, unless it already contradicts.
    pub(crate) inconclusive: Option<&'static str>,
    /// What a statistical check would have found.
    pub(crate) detectable: Option<Detectable<&'static str>>,
    /// What the call that was checked returned, where the value is made of that alone.
    pub(crate) returned: Option<Returned>,
}

/// A number that a call of the specimen returned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Returned {
    pub(crate) call: &'static str,
    pub(crate) value: f64,
}

impl Check {
    pub(crate) fn new(what: &'static str, value: f64, limit: f64, witness: Witness) -> Self {
        Self {
            what,
            value,
            limit,
            witness,
            samples: 0,
            cells: None,
            inconclusive: None,
            detectable: None,
            returned: None,
        }
    }

    /// A p-value against its level, on the scale −log₁₀ p.
    pub(crate) fn p_value(
        what: &'static str,
        ln_p: f64,
        ln_level: f64,
        samples: u64,
        witness: Witness,
    ) -> Self {
        let scale = -core::f64::consts::LN_10;
        // + 0.0 turns −0 (p = 1) into 0.
        let value = ln_p / scale + 0.0;
        Self { samples, ..Self::new(what, value, ln_level / scale, witness) }
    }

    pub(crate) fn holds(&self) -> bool {
        self.value.is_finite() && self.value <= self.limit
    }

    fn used(&self) -> f64 {
        used(self.value, self.limit)
    }
}

/// How much of a limit is used up; above 1 is a violation.
fn used(value: f64, limit: f64) -> f64 {
    if !value.is_finite() {
        f64::INFINITY
    } else if limit > 0.0 {
        value / limit
    } else if value <= limit {
        0.0
    } else {
        f64::INFINITY
    }
}

/// Collects the checks of one suite on one specimen and keeps the most telling one.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    checks: u64,
    samples: u64,
    violations: u64,
    least_cells: Option<usize>,
    detectable: Vec<Detectable<&'static str>>,
    worst: Option<Check>,
    inconclusive: Option<Check>,
    /// If given, only checks that it ends with are recorded.
    about: Option<String>,
}

impl Ledger {
    /// A ledger for the check that a verdict is about.
    pub(crate) fn about(verdict: &Verdict) -> Self {
        Self { about: Some(verdict.what.clone()), ..Self::default() }
    }

    pub(crate) fn record(&mut self, check: Check) {
        if self.about.as_ref().is_some_and(|about| !about.ends_with(check.what)) {
            return;
        }
        self.checks += 1;
        self.samples += check.samples;
        self.violations += u64::from(!check.holds());
        self.least_cells = self.least_cells.into_iter().chain(check.cells).min();
        if let Some(detectable) = check.detectable {
            // The least powerful direction speaks for all.
            match self.detectable.iter_mut().find(|known| known.what == detectable.what) {
                Some(known) if known.effect < detectable.effect => *known = detectable,
                Some(_) => {}
                None => self.detectable.push(detectable),
            }
        }
        if check.inconclusive.is_some() {
            self.inconclusive.get_or_insert(check);
        }
        if self.worst.is_none_or(|worst| check.used() > worst.used()) {
            self.worst = Some(check);
        }
    }

    /// Counts checks whose value is 0, in hot loops: there is nothing to tell of them unless they are the first.
    pub(crate) fn count(&mut self, checks: u64, first: impl FnOnce() -> Check) {
        self.checks += checks;
        self.worst.get_or_insert_with(first);
    }

    /// How much of its limit the worst check used; −∞ if there was none.
    pub(crate) fn used(&self) -> f64 {
        self.worst.map_or(f64::NEG_INFINITY, |worst| worst.used())
    }

    /// Whether a check contradicts the claim.
    pub(crate) fn is_violated(&self) -> bool {
        self.violations > 0
    }

    /// The most telling check, if it contradicts the claim.
    pub(crate) fn violation(&self) -> Option<&Check> {
        self.worst.as_ref().filter(|worst| !worst.holds())
    }

    /// Takes over the checks that another ledger holds about the specimen with these parameters.
    pub(crate) fn absorb(&mut self, other: Self, parameters: Parameters) {
        let named = |mut check: Check| {
            check.witness.parameters = parameters;
            check
        };
        self.checks += other.checks;
        self.samples += other.samples;
        self.violations += other.violations;
        self.least_cells = self.least_cells.into_iter().chain(other.least_cells).min();
        self.inconclusive = self.inconclusive.or(other.inconclusive.map(named));
        if other.used() > self.used() {
            self.worst = other.worst.map(named);
        }
    }

    pub(crate) fn into_verdict(self, specimen: String, suite: Suite, run_seed: u64) -> Verdict {
        let nothing = Check {
            inconclusive: Some("no check was made"),
            ..Check::new("nothing", 0.0, 0.0, Witness::default())
        };
        let (outcome, check) = match (self.worst, self.inconclusive) {
            (None, _) => (Outcome::Inconclusive, nothing),
            (Some(worst), _) if self.violations > 0 => (Outcome::Violated, worst),
            (Some(_), Some(check)) => (Outcome::Inconclusive, check),
            (Some(worst), None) => (Outcome::Holds, worst),
        };
        let what = match (outcome, check.inconclusive, check.returned) {
            (Outcome::Inconclusive, Some(reason), _) => format!("{reason}; {}", check.what),
            (Outcome::Violated, _, Some(Returned { call, value })) => {
                format!("`{call}` returned {value:.4e}; {}", check.what)
            }
            _ => check.what.to_owned(),
        };
        Verdict {
            specimen,
            suite,
            outcome,
            waiver: None,
            what,
            value: check.value,
            limit: check.limit,
            checks: self.checks,
            violations: self.violations,
            samples: self.samples,
            least_cells: self.least_cells,
            detectable: self.detectable.into_iter().map(Detectable::owned).collect(),
            parameters: check
                .witness
                .parameters
                .iter()
                .map(|(name, value)| (name.to_owned(), value))
                .collect(),
            run_seed,
            witness: check.witness,
            residual: None,
            diagnosis: None,
            smallest: None,
        }
    }
}

/// What one suite concluded about one specimen, with the most telling of its checks.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Verdict {
    /// Name of the specimen.
    pub specimen: String,
    /// The suite.
    pub suite: Suite,
    /// The conclusion.
    pub outcome: Outcome,
    /// The reason why a violation was expected, where a waiver applied.
    pub waiver: Option<String>,
    /// What the most telling check measured.
    pub what: String,
    /// Its value; p-values are given as −log₁₀ p.
    #[serde(with = "number")]
    pub value: f64,
    /// Its limit; the check holds where the value does not exceed it.
    #[serde(with = "number")]
    pub limit: f64,
    /// How many checks were made.
    pub checks: u64,
    /// How many of them contradict the claim.
    pub violations: u64,
    /// How many random samples they rest on; several suites share the same samples.
    pub samples: u64,
    /// Cells of the smallest χ² table at the finest resolution, after pooling: how much the suite could see.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least_cells: Option<usize>,
    /// What would have been found with probability 0.99 at every direction; empty where nothing is a matter of chance.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detectable: Vec<Detectable>,
    /// Which member of a family the most telling check is about, unless it was the specimen itself.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<(String, f64)>,
    /// The run seed; with the name of the specimen it reproduces the run.
    pub run_seed: u64,
    /// Where the most telling check was made.
    pub witness: Witness,
    /// Where samples and density disagree; like the next two, of a violation after
    /// [`crate::Examination::explained`] only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub residual: Option<Residual>,
    /// The bug that explains it, if the dictionary has one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<Diagnosis>,
    /// The smallest case that still fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub smallest: Option<Smallest>,
}

impl Verdict {
    /// How much of its limit the most telling check used; above 1 is a violation.
    pub fn used(&self) -> f64 {
        used(self.value, self.limit)
    }

    /// Its first line: what was concluded, and from what.
    pub fn headline(&self) -> String {
        let outcome = match self.outcome {
            Outcome::Holds => "holds",
            Outcome::Violated => "VIOLATED",
            Outcome::Inconclusive => "inconclusive",
        };
        let mut line = format!("{}/{} {outcome}: {}", self.specimen, self.suite.name(), self.what);
        // A panic measures nothing.
        if !self.limit.is_nan() {
            line += &format!(" = {:.4e}, limit {:.4e}", self.value, self.limit);
            if self.violations > 0 {
                line += &format!(" ({} of {} checks)", self.violations, self.checks);
            }
        }
        line
    }

    /// The verdict under a waiver: the expected violation is accepted, a claim that holds violates the waiver.
    pub(crate) fn under_waiver(mut self, reason: &str) -> Self {
        match self.outcome {
            Outcome::Violated if reason.trim().is_empty() => {
                self.what = format!("a waiver without a reason; the suite finds: {}", self.what);
            }
            Outcome::Violated => {
                self.outcome = Outcome::Holds;
                self.waiver = Some(reason.to_owned());
            }
            Outcome::Holds => {
                self.outcome = Outcome::Violated;
                self.what =
                    format!("a waiver is no longer needed ({reason}); the suite finds: {}", self.what);
            }
            Outcome::Inconclusive => {}
        }
        self
    }
}

impl core::fmt::Display for Verdict {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.headline())?;
        let Witness { wo, wi, uniforms, transport, .. } = self.witness;
        if !self.parameters.is_empty() {
            let values: Vec<_> =
                self.parameters.iter().map(|(name, value)| format!("{name} = {value}")).collect();
            write!(f, "\n  parameters {}", values.join(", "))?;
        }
        if let Some([x, y, z]) = wo {
            write!(f, "\n  wo ({x:e}, {y:e}, {z:e})")?;
        }
        if let Some([x, y, z]) = wi {
            write!(f, "\n  wi ({x:e}, {y:e}, {z:e})")?;
        }
        if let Some([c, x, y]) = uniforms {
            write!(f, "\n  uniforms ({c:e}, {x:e}, {y:e})")?;
        }
        if let Some(transport) = transport {
            write!(f, "\n  transport {transport:?}")?;
        }
        // What a violation would also have found is of no interest.
        let detectable = if self.outcome == Outcome::Violated { &[] } else { &self.detectable[..] };
        for Detectable { what, effect, samples_for_one_percent } in detectable {
            write!(f, "\n  finds {what} of {:.2} % with probability 0.99", 100.0 * effect)?;
            write!(f, ", of 1 % with {samples_for_one_percent:.1e} samples per direction")?;
        }
        if let Some(residual) = &self.residual {
            write!(f, "\n{residual}")?;
        }
        if let Some(diagnosis) = &self.diagnosis {
            write!(f, "\n{diagnosis}")?;
        }
        if let Some(smallest) = &self.smallest {
            write!(f, "\n{smallest}")?;
        }
        write!(f, "\n  run seed {}", self.run_seed)
    }
}

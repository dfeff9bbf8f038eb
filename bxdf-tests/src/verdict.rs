//! Verdicts with their evidence.

use crate::number;
use crate::specimen::{Direction, Transport};
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
}

impl Check {
    pub(crate) fn new(what: &'static str, value: f64, limit: f64, witness: Witness) -> Self {
        Self { what, value, limit, witness, samples: 0, cells: None, inconclusive: None }
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

    fn holds(&self) -> bool {
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
    worst: Option<Check>,
    inconclusive: Option<Check>,
}

impl Ledger {
    pub(crate) fn record(&mut self, check: Check) {
        self.checks += 1;
        self.samples += check.samples;
        self.violations += u64::from(!check.holds());
        self.least_cells = self.least_cells.into_iter().chain(check.cells).min();
        if check.inconclusive.is_some() {
            self.inconclusive.get_or_insert(check);
        }
        if self.worst.is_none_or(|worst| check.used() > worst.used()) {
            self.worst = Some(check);
        }
    }

    /// How much of its limit the worst check used; −∞ if there was none.
    pub(crate) fn used(&self) -> f64 {
        self.worst.map_or(f64::NEG_INFINITY, |worst| worst.used())
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
        let what = match (outcome, check.inconclusive) {
            (Outcome::Inconclusive, Some(reason)) => format!("{reason}; {}", check.what),
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
            run_seed,
            witness: check.witness,
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
    /// The run seed; with the name of the specimen it reproduces the run.
    pub run_seed: u64,
    /// Where the most telling check was made.
    pub witness: Witness,
}

impl Verdict {
    /// How much of its limit the most telling check used; above 1 is a violation.
    pub fn used(&self) -> f64 {
        used(self.value, self.limit)
    }

    /// The verdict under a waiver: the expected violation is accepted, a claim that holds violates the waiver.
    pub(crate) fn under_waiver(mut self, reason: &str) -> Self {
        match self.outcome {
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
        let outcome = match self.outcome {
            Outcome::Holds => "holds",
            Outcome::Violated => "VIOLATED",
            Outcome::Inconclusive => "inconclusive",
        };
        write!(f, "{}/{} {outcome}: {}", self.specimen, self.suite.name(), self.what)?;
        write!(f, " = {:.4e}, limit {:.4e}", self.value, self.limit)?;
        if self.violations > 0 {
            write!(f, " ({} of {} checks)", self.violations, self.checks)?;
        }
        let Witness { wo, wi, uniforms, transport } = self.witness;
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
        write!(f, "\n  run seed {}", self.run_seed)
    }
}

//! The suites: one contract, one file.

mod chi_square;
mod energy;
mod finite;
mod fresnel;
mod isotropic;
mod microfacet;
mod normalised;
mod reciprocal;
mod weight;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::OnceLock;

use crate::claims::Claims;
use crate::plan::{Plan, Setting};
use crate::specimen::{Direction, Specimen};
use crate::survey::{Look, Survey, Tally};
use crate::verdict::{Check, Ledger, Verdict, Witness};

macro_rules! suites {
    ($($variant:ident $module:ident: $statement:literal, if $applies:expr;)+) => {
        /// A contract, with the suite of checks that examines it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
        #[serde(rename_all = "snake_case")]
        pub enum Suite {
            $(#[doc = $statement] $variant,)+
        }

        impl Suite {
            /// Every suite there is.
            pub const ALL: &[Self] = &[$(Self::$variant,)+];

            /// Its name, as in the names of tests.
            pub fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($module),)+ }
            }

            /// The contract in one line.
            pub fn statement(self) -> &'static str {
                match self { $(Self::$variant => $statement,)+ }
            }

            /// Whether a specimen with these claims is examined.
            pub fn applies(self, claims: &Claims) -> bool {
                match self { $(Self::$variant => ($applies)(claims),)+ }
            }

            fn run(self, examination: &Examination<'_>, ledger: &mut Ledger) {
                match self { $(Self::$variant => $module::run(examination, ledger),)+ }
            }
        }
    };
}

fn always(_: &Claims) -> bool {
    true
}

suites! {
    Finite finite: "values, densities and weights are finite and not negative everywhere", if always;
    Normalised normalised: "∫ pdf + Σ delta masses + P(no sample) = 1", if always;
    ChiSquare chi_square: "samples follow the pdf, the deltas and the rate of no sample", if always;
    Weight weight: "weight · pdf = f · |cos θi|, and the reported density is the pdf", if always;
    Reciprocal reciprocal: "f(wo, wi) = f(wi, wo); across a boundary what importance carries forth radiance carries back", if |claims: &Claims| claims.reciprocal;
    Isotropic isotropic: "turning both directions about the normal changes nothing", if |claims: &Claims| claims.isotropic;
    Energy energy: "no more energy leaves than arrives; two estimates of the albedo agree", if always;
    Fresnel fresnel: "reflectance is that of exact complex Snell refraction", if |claims: &Claims| claims.boundary.is_some();
    Microfacet microfacet: "∫ D cos θ = 1, masking follows from D, the lobe is made of both", if |claims: &Claims| claims.microfacet;
}

/// One specimen under examination; what several suites need is measured once.
pub struct Examination<'a> {
    pub(crate) specimen: &'a dyn Specimen,
    pub(crate) name: String,
    pub(crate) claims: Claims,
    pub(crate) plan: &'a Plan,
    surveys: OnceLock<Vec<Surveyed>>,
}

/// A setting with what was measured at it.
pub(crate) struct Surveyed {
    pub(crate) setting: Setting,
    pub(crate) survey: Survey,
    /// Counted samples, at settings where samples are counted.
    pub(crate) tally: Option<Tally>,
    /// The second look, once something was doubtful.
    second: OnceLock<Box<Surveyed>>,
}

/// A statistical check at one setting.
pub(crate) struct PValue {
    pub(crate) what: &'static str,
    pub(crate) ln_p: f64,
    pub(crate) samples: u64,
    /// Cells of a χ² table after pooling.
    pub(crate) cells: Option<usize>,
    /// Why the evidence cannot carry a conclusion.
    pub(crate) inconclusive: Option<&'static str>,
}

/// ln of the p-value below which the second look decides: 1e-4.
const LN_GREY: f64 = -9.210_340_371_976_182;

impl<'a> Examination<'a> {
    /// Prepares an examination; nothing is measured yet.
    pub fn new(specimen: &'a dyn Specimen, plan: &'a Plan) -> Self {
        Self { specimen, name: specimen.name(), claims: specimen.claims(), plan, surveys: OnceLock::new() }
    }

    /// Name of the specimen.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What the specimen promises.
    pub fn claims(&self) -> &Claims {
        &self.claims
    }

    /// The verdict of one suite; `None` where the specimen claims nothing that it examines.
    ///
    /// A specimen that panics is violated, not the run.
    pub fn verdict(&self, suite: Suite) -> Option<Verdict> {
        let waiver = self.claims.waivers.iter().find(|waiver| waiver.suite == suite);
        let mut ledger = Ledger::default();
        if !suite.applies(&self.claims) {
            // A waiver for a suite that does not run would never be noticed again.
            waiver?;
            let what = "a waiver for a suite that does not apply";
            ledger.record(Check::new(what, f64::NAN, 0.0, Witness::default()));
            return Some(ledger.into_verdict(self.name.clone(), suite, self.plan.run_seed));
        }
        let result = catch_unwind(AssertUnwindSafe(|| suite.run(self, &mut ledger)));
        if let Err(payload) = result {
            // Nothing else that was found is as telling, and a waiver is for a wrong value, not for a crash.
            let mut ledger = Ledger::default();
            ledger.record(Check::new("the specimen panicked", f64::NAN, 0.0, Witness::default()));
            let mut verdict = ledger.into_verdict(self.name.clone(), suite, self.plan.run_seed);
            let text = payload.downcast_ref::<&str>().copied();
            if let Some(text) = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)) {
                verdict.what = format!("{}: {text}", verdict.what);
            }
            return Some(verdict);
        }
        let verdict = ledger.into_verdict(self.name.clone(), suite, self.plan.run_seed);
        Some(match waiver {
            Some(waiver) => verdict.under_waiver(&waiver.reason),
            None => verdict,
        })
    }

    /// The verdicts of all suites that apply.
    pub fn verdicts(&self) -> Vec<Verdict> {
        Suite::ALL.iter().filter_map(|&suite| self.verdict(suite)).collect()
    }

    pub(crate) fn settings(&self) -> Vec<Setting> {
        self.plan.settings(&self.name, &self.claims)
    }

    pub(crate) fn surveys(&self) -> &[Surveyed] {
        self.surveys.get_or_init(|| {
            self.settings().into_iter().map(|setting| self.look(setting, Look::FIRST)).collect()
        })
    }

    fn look(&self, setting: Setting, look: Look) -> Surveyed {
        let mut survey = Survey::new(self.specimen, &self.claims, self.plan, &setting, look);
        let tally =
            setting.is_counted.then(|| survey.tally(self.specimen, &self.claims, self.plan, &setting, look));
        Surveyed { setting, survey, tally, second: OnceLock::new() }
    }

    fn second<'s>(&self, surveyed: &'s Surveyed) -> &'s Surveyed {
        surveyed.second.get_or_init(|| Box::new(self.look(surveyed.setting, Look::second(self.plan))))
    }

    /// The integrals that decide: those of the first look unless they contradict a claim, else those of the second.
    ///
    /// The error bound of a cubature is an estimate; a kink between its nodes can make it too small.
    pub(crate) fn decisive<'s>(&self, surveyed: &'s Surveyed, holds: impl Fn(&Survey) -> bool) -> &'s Survey {
        if holds(&surveyed.survey) { &surveyed.survey } else { &self.second(surveyed).survey }
    }

    /// Records statistical checks at a setting where samples are counted, in two planned stages.
    ///
    /// `p_values` gives named checks with ln p as their value. Where one falls below 1e-4 a second look decides, on
    /// independent samples and against level / 1e-4: together that is the level.
    pub(crate) fn judge(
        &self,
        surveyed: &Surveyed,
        ledger: &mut Ledger,
        p_values: impl Fn(&Survey, &Tally) -> Vec<PValue>,
    ) {
        let level = self.plan.ln_level();
        let p_values = |surveyed: &Surveyed| match &surveyed.tally {
            Some(tally) => p_values(&surveyed.survey, tally),
            None => Vec::new(),
        };
        let first = p_values(surveyed);
        // NaN is not a matter of chance.
        let is_grey = |p: &PValue| p.ln_p < LN_GREY;
        let second = first.iter().any(is_grey).then(|| p_values(self.second(surveyed)));
        for (i, first) in first.iter().enumerate() {
            let (p, ln_p) = match &second {
                Some(second) if is_grey(first) => (&second[i], second[i].ln_p + LN_GREY),
                _ => (first, first.ln_p),
            };
            let witness = surveyed.setting.witness();
            // All p-values of a setting rest on the same samples.
            let samples = if i == 0 { p.samples } else { 0 };
            let check = Check::p_value(p.what, ln_p, level, samples, witness);
            ledger.record(Check { cells: p.cells, inconclusive: p.inconclusive, ..check });
        }
    }

    /// How much `g` may change because directions are rounded: its largest change when `wi` moves by 16 ε, across
    /// or along itself, plus 64 ε of its value and the smallest normal number.
    ///
    /// A lobe of small α turns the rounding of its inputs into a large relative error; nobody can ask for
    /// less than the condition of the problem. Moves along the direction count because a rounded unit vector
    /// has not quite unit length, which at grazing incidence tilts the half vector.
    pub(crate) fn rounding_error(&self, wi: Direction, value: f64, g: impl Fn(Direction) -> f64) -> f64 {
        let epsilon = self.claims.precision.epsilon();
        let [first, second] = tangents(wi);
        let change = [first, second, wi]
            .into_iter()
            .flat_map(|axis| [16.0 * epsilon, -16.0 * epsilon].map(|step| moved(wi, axis, step)))
            .map(|near| (g(near) - value).abs())
            .filter(|change| change.is_finite())
            .fold(0.0, f64::max);
        change + 64.0 * epsilon * value.abs() + self.claims.precision.smallest_normal()
    }
}

/// Two unit vectors orthogonal to the unit vector `w` and to each other.
fn tangents([x, y, z]: Direction) -> [Direction; 2] {
    // Duff et al., JCGT 6(1), 2017.
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

fn moved(w: Direction, axis: Direction, step: f64) -> Direction {
    core::array::from_fn(|i| w[i] + step * axis[i])
}

fn normalized(w: Direction) -> Direction {
    let length = length(w);
    w.map(|x| x / length)
}

fn length([x, y, z]: Direction) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

/// Runs all suites that apply on a specimen.
pub fn examine(specimen: &dyn Specimen, plan: &Plan) -> Vec<Verdict> {
    Examination::new(specimen, plan).verdicts()
}

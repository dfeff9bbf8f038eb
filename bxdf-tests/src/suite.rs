//! The suites: one contract, one file.

mod chi_square;
mod energy;
mod finite;
mod fresnel;
mod isotropic;
mod jacobian;
mod microfacet;
mod normalised;
mod reciprocal;
mod weight;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, OnceLock};

use crate::calls::{Panicked, Watched, text_of};
use crate::claims::Claims;
use crate::plan::{Plan, Setting};
use crate::specimen::{Direction, Scatter, Specimen};
use crate::survey::{Look, Survey, Tally};
use crate::verdict::{Check, Detectable, Ledger, Verdict, Witness};
pub(crate) use fresnel::reference as fresnel_reference;

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

            /// Whether a specimen with these claims gets a verdict. A waiver calls for a suite that does not apply: it
            /// would never be noticed again.
            pub(crate) fn is_called_for(self, claims: &Claims) -> bool {
                self.applies(claims) || claims.waivers.iter().any(|waiver| waiver.suite == self)
            }

            fn run(self, examination: &Examination<'_>, ledger: &mut Ledger) {
                match self { $(Self::$variant => $module::run(examination, ledger),)+ }
            }
        }
    };
}

impl Suite {
    /// The checks of one pair of directions, in suites that have such.
    pub(crate) fn check_pair(
        self,
        examination: &Examination<'_>,
        ledger: &mut Ledger,
        setting: &Setting,
        wi: Direction,
    ) {
        match self {
            Self::Finite => {
                _ = finite::check_values(examination, ledger, [setting.wo, wi], setting.transport)
            }
            Self::Reciprocal => reciprocal::compare(examination, ledger, setting.wo, wi),
            _ => {}
        }
    }

    /// The checks of one sample, in suites that have such.
    pub(crate) fn check_sample(
        self,
        examination: &Examination<'_>,
        ledger: &mut Ledger,
        setting: &Setting,
        uniforms: [f64; 3],
    ) {
        let (wo, transport) = (setting.wo, setting.transport);
        let Some(scatter) = examination.specimen.sample(wo, uniforms, transport) else { return };
        match self {
            Self::Finite => _ = finite::check_sample(examination, ledger, wo, uniforms, transport),
            Self::Weight => weight::compare(examination, ledger, setting, uniforms, &scatter),
            Self::Reciprocal => reciprocal::compare_sample(examination, ledger, setting, uniforms, &scatter),
            _ => {}
        }
    }
}

fn always(_: &Claims) -> bool {
    true
}

suites! {
    Finite finite: "values, densities and weights are finite and not negative everywhere", if always;
    Normalised normalised: "∫ pdf + Σ delta masses + P(no sample) = 1; 1 / pdf of the samples averages to solid angles", if always;
    ChiSquare chi_square: "samples follow the pdf, the deltas and the rate of no sample", if always;
    Weight weight: "weight · pdf = f · |cos θi|, and the reported density is the pdf", if always;
    Jacobian jacobian: "the pdf is 1 / √det(JᵀJ), the density that the map from uniforms gives its directions", if |claims: &Claims| claims.invertible;
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
    surveys: Arc<OnceLock<Vec<Surveyed>>>,
    /// Whether verdicts state what effect they would find.
    states_effects: bool,
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

/// The p-value of a statistical check at one direction.
#[derive(Clone, Debug, PartialEq)]
pub struct PValue {
    /// What is compared, in words.
    pub what: &'static str,
    /// ln p; NaN where something was not a number, which no chance explains.
    pub ln_p: f64,
    /// Random samples behind it; all p-values of a direction rest on the same.
    pub samples: u64,
    /// Cells of a χ² table after pooling.
    pub cells: Option<usize>,
    /// What it finds in the two stages of a verdict.
    pub detectable: Option<Detectable<&'static str>>,
    /// Why the evidence cannot carry a conclusion.
    pub inconclusive: Option<&'static str>,
    /// Whether it could with more samples.
    pub wants_samples: bool,
}

/// What p-values allow to conclude: nothing where rounding decides, and neither the pdf nor the samples.
fn concluded(survey: &Survey, mut p_values: Vec<PValue>) -> Vec<PValue> {
    let reason =
        "the lobe is narrower than the directions that its precision can tell apart (claim `least_cosine`)";
    for p_value in p_values.iter_mut().filter(|_| survey.is_coarse) {
        // NaN is not a matter of rounding.
        p_value.ln_p = if p_value.ln_p.is_nan() { f64::NAN } else { 0.0 };
        p_value.inconclusive = Some(reason);
        (p_value.detectable, p_value.wants_samples) = (None, false);
    }
    p_values
}

/// A direction at which samples are counted, and the p-values of all statistical checks there: what the laboratory's
/// own calibration and power are measured with.
#[derive(Clone, Copy)]
pub struct Trial<'a> {
    examination: &'a Examination<'a>,
    surveyed: &'a Surveyed,
}

impl Trial<'_> {
    /// The direction and what is carried.
    pub fn witness(&self) -> Witness {
        self.surveyed.setting.witness()
    }

    /// The p-values on fresh samples in the same cells, the same for the same repetition. The 0th are those of the first
    /// stage of a verdict.
    pub fn p_values(&self, repetition: u64) -> Vec<(Suite, PValue)> {
        let plan = self.examination.plan.repetition(repetition);
        let Surveyed { survey, tally, .. } = self.examination.repeated(self.surveyed, &plan);
        tally.map_or_else(Vec::new, |tally| self.examination.p_values(&survey, &tally))
    }

    /// Whether both stages of a verdict find a violation on fresh samples; those of the first stage fall into the same cells
    /// again, the second measures its own.
    pub fn is_violated(&self, repetition: u64) -> bool {
        let plan = self.examination.plan.repetition(repetition);
        let Examination { specimen, name, claims, surveys, .. } = self.examination;
        let (name, claims, surveys) = (name.clone(), claims.clone(), Arc::clone(surveys));
        let fresh =
            Examination { specimen: *specimen, name, claims, plan: &plan, surveys, states_effects: false };
        let mut ledger = Ledger::default();
        fresh.judge(&self.examination.repeated(self.surveyed, &plan), &mut ledger, |survey, tally| {
            fresh.p_values(survey, tally).into_iter().map(|(_, p_value)| p_value).collect()
        });
        ledger.is_violated()
    }
}

/// ln of the p-value below which the second look decides: 1e-4.
const LN_GREY: f64 = -9.210_340_371_976_182;

impl<'a> Examination<'a> {
    /// Prepares an examination; nothing is measured yet.
    pub fn new(specimen: &'a dyn Specimen, plan: &'a Plan) -> Self {
        Self::named(specimen.name(), specimen, plan)
    }

    /// Prepares an examination under a name that takes the place of the specimen's own, in seeds and verdicts.
    pub fn named(name: impl Into<String>, specimen: &'a dyn Specimen, plan: &'a Plan) -> Self {
        Self {
            specimen,
            name: name.into(),
            claims: specimen.claims(),
            plan,
            surveys: Arc::default(),
            states_effects: true,
        }
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
    /// A specimen that panics is violated, not the run: the verdict names the call with its arguments.
    pub fn verdict(&self, suite: Suite) -> Option<Verdict> {
        if !suite.is_called_for(&self.claims) {
            return None;
        }
        let waiver = self.claims.waivers.iter().find(|waiver| waiver.suite == suite);
        let mut ledger = Ledger::default();
        if !suite.applies(&self.claims) {
            let what = "a waiver for a suite that does not apply";
            ledger.record(Check::new(what, f64::NAN, 0.0, Witness::default()));
            return Some(ledger.into_verdict(self.name.clone(), suite, self.plan.run_seed));
        }
        let watched = Watched(self.specimen);
        let examination = Examination {
            specimen: &watched,
            name: self.name.clone(),
            claims: self.claims.clone(),
            plan: self.plan,
            surveys: Arc::clone(&self.surveys),
            states_effects: self.states_effects,
        };
        let result = catch_unwind(AssertUnwindSafe(|| suite.run(&examination, &mut ledger)));
        if let Err(payload) = result {
            // Nothing else that was found is as telling, and a waiver is for a wrong value, not for a crash.
            let (what, witness) = match payload.downcast_ref::<Panicked>() {
                Some(Panicked { call, witness, text }) => (format!("`{call}` panicked: {text}"), *witness),
                None => {
                    let text = text_of(&*payload).unwrap_or("no text");
                    (format!("the specimen panicked: {text}"), Witness::default())
                }
            };
            let mut ledger = Ledger::default();
            ledger.record(Check::new("a panic", f64::NAN, f64::NAN, witness));
            let verdict = ledger.into_verdict(self.name.clone(), suite, self.plan.run_seed);
            return Some(Verdict { what, ..verdict });
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

    /// Every direction at which samples are counted, each with its p-values.
    pub fn trials(&self) -> impl Iterator<Item = Trial<'_>> {
        let counted = self.surveys().iter().filter(|surveyed| surveyed.tally.is_some());
        counted.map(|surveyed| Trial { examination: self, surveyed })
    }

    /// The p-values of every statistical check at one direction.
    pub(crate) fn p_values(&self, survey: &Survey, tally: &Tally) -> Vec<(Suite, PValue)> {
        let of = |suite: Suite, p_values: Vec<PValue>| p_values.into_iter().map(move |p| (suite, p));
        of(Suite::Normalised, concluded(survey, normalised::p_values(self, survey, tally)))
            .chain(of(Suite::ChiSquare, concluded(survey, chi_square::p_values(self, survey, tally))))
            .chain(of(Suite::Energy, concluded(survey, energy::p_values(self, survey, tally))))
            .collect()
    }

    /// The effect that both stages of a verdict find with probability 0.995 each, hence together with 0.99, given the
    /// one that a single stage finds as a function of ln level and the number of samples.
    pub(crate) fn detectable(
        &self,
        what: &'static str,
        effect: impl Fn(f64, f64) -> f64,
    ) -> Option<Detectable<&'static str>> {
        if !self.states_effects {
            return None;
        }
        let ln_second = self.plan.ln_level() - LN_GREY;
        let more = Look::second(self.plan).samples as f64;
        let of_both = |samples: f64| effect(LN_GREY, samples).max(effect(ln_second, more * samples));
        let mut samples_for_one_percent = self.plan.samples as f64;
        let effect = of_both(samples_for_one_percent);
        let mut there = effect;
        // The effect falls as √N, or as N where it is that of rare events; a power between the two leads to both.
        for _ in 0..6 {
            samples_for_one_percent *= libm::pow(there / 0.01, 1.4);
            there = of_both(samples_for_one_percent);
        }
        effect.is_finite().then_some(Detectable { what, effect, samples_for_one_percent })
    }

    pub(crate) fn settings(&self) -> Vec<Setting> {
        self.plan.settings(&self.name, &self.claims)
    }

    pub(crate) fn surveys(&self) -> &[Surveyed] {
        self.surveys.get_or_init(|| {
            // Where nothing is counted the integrals say no more than those of the other mode, but for the power.
            let is_needed =
                |setting: &Setting| setting.is_counted || energy::is_power(&self.claims, setting.transport);
            let needed = self.settings().into_iter().filter(is_needed);
            let look = |setting: &Setting| if setting.is_counted { Look::FIRST } else { Look::NOT_COUNTED };
            needed.map(|setting| self.look(setting, look(&setting))).collect()
        })
    }

    pub(crate) fn look(&self, setting: Setting, look: Look) -> Surveyed {
        let subject = (self.specimen, self.name.as_str());
        let mut survey = Survey::new(subject, &self.claims, self.plan, &setting, look);
        let tally =
            setting.is_counted.then(|| survey.tally(subject, &self.claims, self.plan, &setting, look));
        Surveyed { setting, survey, tally, second: OnceLock::new() }
    }

    /// The same cells with the samples of another plan.
    pub(crate) fn repeated(&self, surveyed: &Surveyed, plan: &Plan) -> Surveyed {
        let setting = surveyed.setting;
        // A delta too rare for the pilot samples is added as it is met.
        let mut survey = surveyed.survey.clone();
        let subject = (self.specimen, self.name.as_str());
        let tally = survey.tally(subject, &self.claims, plan, &setting, Look::FIRST);
        Surveyed { setting, survey, tally: Some(tally), second: OnceLock::new() }
    }

    fn second<'s>(&self, surveyed: &'s Surveyed) -> &'s Surveyed {
        surveyed.second.get_or_init(|| Box::new(self.look(surveyed.setting, Look::second(self.plan))))
    }

    /// The integrals that decide: those of the first look unless they contradict a claim, else those of the second.
    ///
    /// The error bound of a cubature is an estimate; a kink between its nodes can make it too small. A suite that is
    /// violated already needs no closer look.
    pub(crate) fn decisive<'s>(
        &self,
        surveyed: &'s Surveyed,
        ledger: &Ledger,
        holds: impl Fn(&Survey) -> bool,
    ) -> &'s Survey {
        let suffices = ledger.is_violated() || holds(&surveyed.survey);
        if suffices { &surveyed.survey } else { &self.second(surveyed).survey }
    }

    /// Records statistical checks at a setting where samples are counted, in two planned stages.
    ///
    /// `p_values` gives named checks with ln p as their value. Where one falls below 1e-4 a second look decides, on
    /// independent samples and against level / 1e-4: together that is the level. Where the first look has too few samples
    /// to say anything, the second stands for it, against the level itself. Once a violation is certain, the first look
    /// at the other settings is enough.
    pub(crate) fn judge(
        &self,
        surveyed: &Surveyed,
        ledger: &mut Ledger,
        p_values: impl Fn(&Survey, &Tally) -> Vec<PValue>,
    ) {
        let level = self.plan.ln_level();
        let p_values = |surveyed: &Surveyed| {
            let survey = &surveyed.survey;
            let found = surveyed.tally.as_ref().map_or_else(Vec::new, |tally| p_values(survey, tally));
            concluded(survey, found)
        };
        let first = p_values(surveyed);
        // NaN is not a matter of chance.
        let is_grey = |p: &PValue| p.ln_p < LN_GREY;
        let is_open = |p: &PValue| is_grey(p) || p.wants_samples;
        let is_doubtful = first.iter().any(is_open) && !ledger.is_violated();
        let second = is_doubtful.then(|| p_values(self.second(surveyed)));
        for (i, first) in first.iter().enumerate() {
            let (p, ln_p) = match &second {
                Some(second) if first.wants_samples => (&second[i], second[i].ln_p),
                Some(second) if is_grey(first) => (&second[i], second[i].ln_p + LN_GREY),
                _ => (first, first.ln_p),
            };
            let witness = surveyed.setting.witness();
            // All p-values of a setting rest on the same samples.
            let samples = if i == 0 { p.samples } else { 0 };
            let check = Check::p_value(p.what, ln_p, level, samples, witness);
            let &PValue { cells, inconclusive, detectable, .. } = p;
            ledger.record(Check { cells, inconclusive, detectable, ..check });
        }
    }

    /// How much `g` may change because directions are rounded: its largest change when `wi` moves by 16 ε, across
    /// or along itself, plus 64 ε of its value and the smallest normal number.
    ///
    /// A lobe of small α turns the rounding of its inputs into a large relative error; nobody can ask for
    /// less than the condition of the problem. Moves along the direction count because a rounded unit vector
    /// has not quite unit length, which at grazing incidence tilts the half vector.
    pub(crate) fn rounding_error(&self, wi: Direction, value: f64, g: impl Fn(Direction) -> f64) -> f64 {
        let [error] = self.rounding_errors(wi, [value], |w| [g(w)]);
        error
    }

    /// [`Self::rounding_error`] of several values that are computed together.
    pub(crate) fn rounding_errors<const N: usize>(
        &self,
        wi: Direction,
        values: [f64; N],
        g: impl Fn(Direction) -> [f64; N],
    ) -> [f64; N] {
        let epsilon = self.claims.precision.epsilon();
        let [first, second] = tangents(wi);
        let mut changes = [0.0_f64; N];
        for axis in [first, second, wi] {
            for step in [16.0 * epsilon, -16.0 * epsilon] {
                let near = g(moved(wi, axis, step));
                for i in 0..N {
                    let change = (near[i] - values[i]).abs();
                    changes[i] = if change.is_finite() { changes[i].max(change) } else { changes[i] };
                }
            }
        }
        let smallest = self.claims.precision.smallest_normal();
        core::array::from_fn(|i| changes[i] + 64.0 * epsilon * values[i].abs() + smallest)
    }

    /// How much the values of `g` may change because the relative index is rounded: as much as when the component of the
    /// refracted direction across the normal, which is the index times that of the other side, moves by 4 ε.
    ///
    /// Near η = 1 at grazing incidence that is far more than rounding the direction itself: 1/η is not the inverse of η
    /// to the digits of η − 1. So it is wherever refraction grazes a facet, because the cosine is the root of a
    /// difference.
    pub(crate) fn index_errors<const N: usize>(
        &self,
        scatter: &Scatter,
        normal: Direction,
        values: [f64; N],
        g: impl Fn(Direction) -> [f64; N],
    ) -> [f64; N] {
        let mut changes = [0.0_f64; N];
        if scatter.eta == 1.0 {
            return changes;
        }
        let wi = scatter.wi;
        let along: f64 = (0..3).map(|i| wi[i] * normal[i]).sum();
        let across = moved(wi, normal, -along);
        let sine_squared: f64 = across.iter().map(|x| x * x).sum();
        let epsilon = self.claims.precision.epsilon();
        for step in [4.0 * epsilon, -4.0 * epsilon] {
            let cosine = (along * along - 2.0 * step * sine_squared).max(0.0).sqrt();
            let near = g(moved(across.map(|x| x * (1.0 + step)), normal, cosine.copysign(along)));
            for i in 0..N {
                let change = (near[i] - values[i]).abs();
                changes[i] = if change.is_finite() { changes[i].max(change) } else { changes[i] };
            }
        }
        changes
    }

    /// [`Self::index_errors`] about the facet that refracts, of values that have the Jacobian of refraction
    /// in them.
    ///
    /// That is 1 / |wo + η wi|², which between nearly matched media has fewer digits than the index: as many
    /// as remain when that is rounded once.
    pub(crate) fn refraction_errors<const N: usize>(
        &self,
        wo: Direction,
        scatter: &Scatter,
        values: [f64; N],
        g: impl Fn(Direction) -> [f64; N],
    ) -> [f64; N] {
        if scatter.eta == 1.0 {
            return [0.0; N];
        }
        let sum: Direction = core::array::from_fn(|i| wo[i] + scatter.eta * scatter.wi[i]);
        let jacobian = 2.0 * self.claims.precision.epsilon() / length(sum);
        let changes = self.index_errors(scatter, normalized(sum), values, g);
        core::array::from_fn(|i| changes[i] + jacobian * values[i])
    }
}

/// Two unit vectors orthogonal to the unit vector `w` and to each other.
pub(crate) fn tangents([x, y, z]: Direction) -> [Direction; 2] {
    // Duff et al., JCGT 6(1), 2017.
    let sign = 1.0_f64.copysign(z);
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [[1.0 + sign * x * x * a, sign * b, -sign * x], [b, sign + y * y * a, -y]]
}

pub(crate) fn moved(w: Direction, axis: Direction, step: f64) -> Direction {
    core::array::from_fn(|i| w[i] + step * axis[i])
}

pub(crate) fn normalized(w: Direction) -> Direction {
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

//! Every suite can go red: a small bug planted in a correct lobe is found by the suite that must find it, for
//! the reason that it was planted; the same lobe without the bug holds.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

#[path = "mutants/rough_glass.rs"]
mod rough_glass;

use bxdf_tests::{
    Claims, Direction, Energy, Examination, Measure, Microsurface, Outcome, Plan, Precision, Scatter,
    Specimen, Suite, Transport, Verdict, run_seed,
};
use gonio::fresnel::{Fresnel, schlick};
use gonio::lobe::{DielectricSpecular, Lambertian, MicrofacetReflection, SpecularReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use rough_glass::{Masking, RoughGlass};
use std::f64::consts::FRAC_1_PI;
use std::sync::Arc;

/// A bug in one term of a lobe: from the correct value, and what it depends on, to the wrong one.
enum Bug {
    /// f per channel, from `wo` and `wi`, in proportion to f; the weight follows.
    Eval(fn(f64, Direction, Direction) -> f64),
    /// f per channel, from `wo`, `wi` and the mode, in proportion to f; the weight follows.
    Mode(fn(f64, Direction, Direction, Transport) -> f64),
    /// The pdf, from `wo` and `wi`; the reported density and the weight follow.
    Pdf(fn(f64, Direction, Direction) -> f64),
    /// f alone, from `wi`.
    Value(fn(f64, Direction) -> f64),
    /// A sample that came out, from `wo`.
    Scatter(fn(Scatter, Direction, Transport) -> Scatter),
    /// The sampler as a whole.
    Sample(fn(&dyn Specimen, Direction, [f64; 3], Transport) -> Option<Scatter>),
    /// A polarised reflectance.
    Fresnel(fn(f64) -> f64),
    /// The density of micro normals.
    Normals(fn(f64) -> f64),
    /// Λ, G₁ and G₂ are those of another micro surface.
    Masking(Distribution<f64>),
    /// G₁, from `w` and `m`.
    Masked(fn(f64, Direction, Direction) -> f64),
    /// G₂, from the micro surface, `wo`, `wi` and `m`; f does not follow.
    Shadowed(fn(&dyn Microsurface, Direction, Direction, Direction) -> f64),
    /// The density of visible normals, from `w` and `m`.
    Visible(fn(f64, Direction, Direction) -> f64),
}

type Lobe = Box<dyn Specimen>;

/// A lobe with a bug, or without one its correct twin.
struct Mutant {
    name: String,
    lobe: Lobe,
    bug: Option<Bug>,
}

impl Specimen for Mutant {
    fn name(&self) -> String {
        self.name.clone()
    }

    fn claims(&self) -> Claims {
        self.lobe.claims()
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let f = self.lobe.eval(wo, wi, transport);
        match &self.bug {
            Some(Bug::Eval(bug)) => f.map(|f| bug(f, wo, wi)),
            Some(Bug::Value(bug)) => f.map(|f| bug(f, wi)),
            Some(Bug::Mode(bug)) => f.map(|f| bug(f, wo, wi, transport)),
            _ => f,
        }
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let pdf = self.lobe.pdf(wo, wi, transport);
        match &self.bug {
            Some(Bug::Pdf(bug)) => bug(pdf, wo, wi),
            _ => pdf,
        }
    }

    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        if let Some(Bug::Sample(bug)) = &self.bug {
            return bug(&*self.lobe, wo, uniforms, transport);
        }
        let scatter = self.lobe.sample(wo, uniforms, transport)?;
        Some(match (&self.bug, scatter.density) {
            (Some(Bug::Scatter(bug)), _) => bug(scatter, wo, transport),
            (Some(Bug::Eval(bug)), _) => weighted(scatter, |weight| bug(weight, wo, scatter.wi)),
            (Some(Bug::Mode(bug)), _) => weighted(scatter, |weight| bug(weight, wo, scatter.wi, transport)),
            (Some(Bug::Pdf(bug)), Measure::SolidAngle(density)) => {
                let wrong = bug(density, wo, scatter.wi);
                let scatter = Scatter { density: Measure::SolidAngle(wrong), ..scatter };
                weighted(scatter, |weight| weight * density / wrong)
            }
            _ => scatter,
        })
    }

    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let reflectances = self.lobe.fresnel(cos_theta_i, from_above)?;
        Some(match &self.bug {
            Some(Bug::Fresnel(bug)) => reflectances.map(|polarised| polarised.map(bug)),
            _ => reflectances,
        })
    }

    fn microsurface(&self) -> Option<&dyn Microsurface> {
        self.lobe.microsurface().map(|_| self as _)
    }
}

impl Mutant {
    fn surface(&self) -> &dyn Microsurface {
        self.lobe.microsurface().unwrap()
    }

    fn masking(&self) -> &dyn Microsurface {
        match &self.bug {
            Some(Bug::Masking(other)) => other,
            _ => self.surface(),
        }
    }
}

impl Microsurface for Mutant {
    fn d(&self, m: Direction) -> f64 {
        let d = self.surface().d(m);
        match &self.bug {
            Some(Bug::Normals(bug)) => bug(d),
            _ => d,
        }
    }

    fn lambda(&self, w: Direction) -> Option<f64> {
        self.masking().lambda(w)
    }

    fn g1(&self, w: Direction, m: Direction) -> f64 {
        match &self.bug {
            Some(Bug::Masked(bug)) => bug(self.surface().g1(w, m), w, m),
            _ => self.masking().g1(w, m),
        }
    }

    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64 {
        match &self.bug {
            Some(Bug::Shadowed(bug)) => bug(self.surface(), wo, wi, m),
            _ => self.masking().g2(wo, wi, m),
        }
    }

    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64> {
        let pdf = self.surface().visible_pdf(w, m)?;
        Some(match &self.bug {
            Some(Bug::Visible(bug)) => bug(pdf, w, m),
            // The bug is in a term, and what is made of the terms inherits it.
            Some(Bug::Normals(_) | Bug::Masking(_)) => self.d(m) * dot(w, m).max(0.0) * self.g1(w, m) / w[2],
            _ => pdf,
        })
    }
}

/// Directions that no list of edges holds.
fn is_inside(w: Direction) -> bool {
    (0.31..0.33).contains(&w[2]) && w[0] > 0.1 && w[1] > 0.1
}

/// Between 0.1 and 1.9, and different wherever anything is: no rule of cubature agrees with another about it.
fn noise(numbers: &[f64]) -> f64 {
    let scrambled = numbers.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, x| {
        (hash ^ x.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    0.1 + 1.8 * (scrambled.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The same sample with another weight per channel.
fn weighted(scatter: Scatter, weight: impl Fn(f64) -> f64) -> Scatter {
    Scatter { weight: scatter.weight.map(weight), ..scatter }
}

fn dot(a: Direction, b: Direction) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The half vector h and wo·h.
fn half(wo: Direction, wi: Direction) -> (Direction, f64) {
    let sum: Direction = std::array::from_fn(|i| wo[i] + wi[i]);
    let length = dot(sum, sum).sqrt();
    (sum.map(|x| x / length), 0.5 * length)
}

fn ggx(alpha: f64) -> Distribution<f64> {
    Distribution::new(Shape::Ggx, alpha, alpha).unwrap()
}

fn beckmann(alpha: f64) -> Distribution<f64> {
    Distribution::new(Shape::Beckmann, alpha, alpha).unwrap()
}

/// Density of reflection about the visible normals of another surface, where the correct one is not 0.
fn reflected(correct: f64, surface: &dyn Microsurface, wo: Direction, wi: Direction) -> f64 {
    let (h, wo_dot_h) = half(wo, wi);
    if correct > 0.0 { surface.visible_pdf(wo, h).unwrap() / (4.0 * wo_dot_h) } else { 0.0 }
}

/// D |w·m| G₁(w) / cos θ: the density of visible normals, without the condition that they are visible.
fn unclamped(surface: &dyn Microsurface, w: Direction, m: Direction) -> f64 {
    surface.d(m) * dot(w, m).abs() * surface.g1(w, w) / w[2]
}

/// Tries other numbers until a direction comes out.
fn insistent(
    lobe: &dyn Specimen,
    wo: Direction,
    uniforms: [f64; 3],
    transport: Transport,
) -> Option<Scatter> {
    let shifted = |i: i32| uniforms.map(|u| (u + 0.618 * f64::from(i)).fract());
    (0..64).find_map(|i| lobe.sample(wo, shifted(i), transport))
}

/// A mirror whose colour at normal incidence goes to white as Schlick has it.
fn schlick_mirror(
    lobe: &dyn Specimen,
    wo: Direction,
    uniforms: [f64; 3],
    transport: Transport,
) -> Option<Scatter> {
    let head_on = lobe.sample([0.0, 0.0, 1.0], uniforms, transport)?;
    let scatter = lobe.sample(wo, uniforms, transport)?;
    Some(Scatter { weight: head_on.weight.map(|f0| schlick(wo[2], f0)), ..scatter })
}

/// Refraction with the index upside down, where that leaves a direction.
fn bent_the_wrong_way(scatter: Scatter, wo: Direction, _: Transport) -> Scatter {
    let [x, y] = [-wo[0] * scatter.eta, -wo[1] * scatter.eta];
    let z = (1.0 - x * x - y * y).sqrt().copysign(-wo[2]);
    let refracts = scatter.wi[2] * wo[2] < 0.0 && z.is_finite();
    if refracts { Scatter { wi: [x, y, z], ..scatter } } else { scatter }
}

/// About gold's complex index for red, green and blue.
const GOLD_ETA: Rgb<f64> = Rgb([0.18, 0.42, 1.37]);
const GOLD_K: Rgb<f64> = Rgb([3.42, 2.35, 1.77]);

fn white_paper() -> Lobe {
    Box::new(BxdfSpecimen::of_lobe("white_paper", Lambertian::<f64>::new(Rgb::WHITE).unwrap()))
}

fn rough_mirror() -> Lobe {
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    Box::new(BxdfSpecimen::of_lobe("rough_mirror", MicrofacetReflection::new(ggx(0.3), white)))
}

fn rough_gold() -> Lobe {
    let gold = Fresnel::conductor(GOLD_ETA, GOLD_K).unwrap();
    Box::new(BxdfSpecimen::of_lobe("rough_gold", MicrofacetReflection::new(beckmann(0.3), gold)))
}

fn glass() -> Lobe {
    Box::new(BxdfSpecimen::of_lobe("glass", DielectricSpecular::new(1.5).unwrap()))
}

fn gold() -> Lobe {
    let gold = Fresnel::conductor(GOLD_ETA, GOLD_K).unwrap();
    Box::new(BxdfSpecimen::of_lobe("gold", SpecularReflection::new(gold)))
}

/// Two mirrors that share a direction, each with its own probability and weight: the gloss of a coat over gold.
struct CoatedGold {
    gloss: BxdfSpecimen<f64>,
    gold: BxdfSpecimen<f64>,
}

/// Probability of the gloss.
const GLOSS: f64 = 0.3;

impl Specimen for CoatedGold {
    fn name(&self) -> String {
        "coated_gold".into()
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] {
        [0.0; 3]
    }
    fn pdf(&self, _: Direction, _: Direction, _: Transport) -> f64 {
        0.0
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let gloss = self.gloss.sample(wo, uniforms, transport)?;
        if uniforms[0] < GLOSS {
            let scatter = Scatter { density: Measure::Discrete(GLOSS), ..gloss };
            return Some(weighted(scatter, |weight| weight / GLOSS));
        }
        let gold = self.gold.sample(wo, uniforms, transport)?;
        let through: [f64; 3] = std::array::from_fn(|i| (1.0 - gloss.weight[i]).powi(2) * gold.weight[i]);
        let share = 1.0 - GLOSS;
        let density = Measure::Discrete(share);
        Some(Scatter { weight: through.map(|weight| weight / share), density, ..gold })
    }
}

fn coated_gold() -> Lobe {
    let gloss = SpecularReflection::new(Fresnel::dielectric(1.5).unwrap());
    let gold = SpecularReflection::new(Fresnel::conductor(GOLD_ETA, GOLD_K).unwrap());
    Box::new(CoatedGold {
        gloss: BxdfSpecimen::of_lobe("gloss", gloss),
        gold: BxdfSpecimen::of_lobe("gold", gold),
    })
}

/// Glass of which nothing is claimed but what every specimen claims.
fn unknown_glass() -> Lobe {
    let claims = Claims { two_sided: true, transmits: true, ..Claims::reflector(Precision::F64) };
    Box::new(BxdfSpecimen::new("unknown_glass", Arc::new(DielectricSpecular::new(1.5).unwrap()), claims))
}

fn rough_glass() -> Lobe {
    Box::new(RoughGlass { distribution: ggx(0.3), masking: Masking::Smith, eta: 1.5 })
}

fn glass_with_cavities() -> Lobe {
    Box::new(RoughGlass { distribution: beckmann(0.3), masking: Masking::Cavities, eta: 1.5 })
}

/// Index of what lies beyond glass over the index on the side of `wo`.
fn beyond(wo: Direction) -> f64 {
    if wo[2] > 0.0 { 1.5 } else { 1.0 / 1.5 }
}

fn crosses(wo: Direction, wi: Direction) -> bool {
    wo[2] * wi[2] < 0.0
}

/// Fewer samples than usual: the bugs are large enough to be found for certain.
const SAMPLES: usize = 1 << 17;

fn verdict(name: String, lobe: Lobe, bug: Option<Bug>, suite: Suite) -> Verdict {
    let mutant = Mutant { name, lobe, bug };
    let mut plan = Plan::new(run_seed(), [&mutant as &dyn Specimen]);
    plan.samples = SAMPLES;
    Examination::new(&mutant, &plan).verdict(suite).unwrap()
}

fn examine(name: &str, suite: Suite, reason: &str, lobe: fn() -> Lobe, bug: Bug) {
    let found = verdict(name.to_owned(), lobe(), Some(bug), suite);
    assert_eq!(found.outcome, Outcome::Violated, "{found}");
    assert!(found.what.contains(reason), "{reason} is the reason, but: {found}");
    let twin = verdict(format!("{name}/twin"), lobe(), None, suite);
    assert_eq!(twin.outcome, Outcome::Holds, "{twin}");
}

/// White paper with other claims about its energy, and what is left of its reflectance.
struct Paper {
    paper: Lobe,
    claims: Claims,
    reflectance: f64,
}

impl Paper {
    fn new(reflectance: f64, claims: impl FnOnce(Claims) -> Claims) -> Self {
        let paper = white_paper();
        Self { claims: claims(paper.claims()), paper, reflectance }
    }
}

impl Specimen for Paper {
    fn name(&self) -> String {
        "paper".into()
    }
    fn claims(&self) -> Claims {
        self.claims.clone()
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.paper.eval(wo, wi, transport).map(|f| self.reflectance * f)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.paper.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let scatter = self.paper.sample(wo, uniforms, transport)?;
        Some(weighted(scatter, |weight| self.reflectance * weight))
    }
}

fn verdict_on(specimen: &dyn Specimen, suite: Suite) -> Verdict {
    let mut plan = Plan::new(run_seed(), [specimen]);
    plan.samples = SAMPLES;
    Examination::new(specimen, &plan).verdict(suite).unwrap()
}

#[test]
fn claims_about_energy_bind_on_both_sides() {
    let exceeding = Energy::Exceeding { at_most: 1.05 };
    let lossless = Energy::Lossless { within: 0.01 };
    for (reflectance, energy, reason) in [
        (1.02, exceeding, None),
        (0.99, exceeding, Some("exceeding 1, which is claimed")),
        (1.06, exceeding, Some("directional albedo above its limit")),
        (0.995, lossless, None),
        (1.005, lossless, None),
        (0.98, lossless, Some("energy lost")),
        (1.02, lossless, Some("directional albedo above its limit")),
    ] {
        let paper = Paper::new(reflectance, |claims| Claims { energy: Some(energy), ..claims });
        let verdict = verdict_on(&paper, Suite::Energy);
        match reason {
            None => assert_eq!(verdict.outcome, Outcome::Holds, "{verdict}"),
            Some(reason) => {
                assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
                assert!(verdict.what.contains(reason), "{reason} is the reason, but: {verdict}");
            }
        }
    }
}

#[test]
fn a_waiver_for_a_suite_that_does_not_apply_is_a_violation() {
    let paper = Paper::new(1.0, |claims| claims.waive(Suite::Fresnel, "paper has no index"));
    let verdict = verdict_on(&paper, Suite::Fresnel);
    assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
    assert!(verdict.what.contains("does not apply"), "{verdict}");
}

/// A specimen whose pdf is noise about that of white paper, under a waiver that does not help.
struct Waived(Mutant);

impl Specimen for Waived {
    fn name(&self) -> String {
        self.0.name()
    }
    fn claims(&self) -> Claims {
        self.0.claims().waive(Suite::Normalised, "noise")
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.0.eval(wo, wi, transport)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.0.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        self.0.sample(wo, uniforms, transport)
    }
}

/// Noise takes all the effort that cubature may spend; one of the directions is enough.
fn is_noisy(wo: Direction) -> bool {
    (0.86..0.87).contains(&wo[2])
}

const NOISY_PDF: Bug = Bug::Pdf(|pdf, wo, wi| if is_noisy(wo) { pdf * noise(&wi) } else { pdf });

#[test]
fn noise_is_inconclusive_and_no_waiver_changes_that() {
    for (lobe, bug, suite, reason) in [
        (white_paper as fn() -> Lobe, NOISY_PDF, Suite::Normalised, "integral of the pdf does not converge"),
        (
            white_paper,
            Bug::Eval(|f, wo, wi| if is_noisy(wo) { f * noise(&wi) } else { f }),
            Suite::Energy,
            "integral of f cos does not converge",
        ),
        (rough_mirror, Bug::Normals(|d| d * noise(&[d])), Suite::Microfacet, "integral does not converge"),
    ] {
        let verdict = verdict("noise".to_owned(), lobe(), Some(bug), suite);
        assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
        assert!(verdict.what.contains(reason), "{reason} is the reason, but: {verdict}");
    }
    let mutant = Mutant { name: "noise".to_owned(), lobe: white_paper(), bug: Some(NOISY_PDF) };
    let verdict = verdict_on(&Waived(mutant), Suite::Normalised);
    assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
}

/// White paper that draws its directions as if it were a mirror of small roughness.
struct Misguided(Lobe);

impl Specimen for Misguided {
    fn name(&self) -> String {
        "misguided".into()
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [if wo[2] > 0.0 && wi[2] > 0.0 { FRAC_1_PI } else { 0.0 }; 3]
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.0.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let scatter = self.0.sample(wo, uniforms, transport)?;
        let pdf = self.pdf(wo, scatter.wi, transport);
        Some(weighted(scatter, |_| FRAC_1_PI * scatter.wi[2] / pdf))
    }
}

#[test]
fn weights_without_bound_are_inconclusive() {
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    let mirror = MicrofacetReflection::new(ggx(0.05), white);
    let misguided = Misguided(Box::new(BxdfSpecimen::of_lobe("mirror", mirror)));
    let verdict = verdict_on(&misguided, Suite::Energy);
    assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
    assert!(verdict.what.contains("weights are so uneven"), "{verdict}");
}

/// Scatters evenly into a cap about the normal that single precision takes for one direction.
struct Needle;

/// 1 − cos of the cap's half angle.
const CAP: f64 = 1e-13;

impl Specimen for Needle {
    fn name(&self) -> String {
        "needle".into()
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F32)
    }
    fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] {
        [0.0; 3]
    }
    fn pdf(&self, wo: Direction, [x, y, z]: Direction, _: Transport) -> f64 {
        let inside = wo[2] > 0.0 && z > 0.0 && (x * x + y * y) / (1.0 + z) < CAP;
        if inside { 0.5 * FRAC_1_PI / CAP } else { 0.0 }
    }
    fn sample(&self, wo: Direction, [_, u, v]: [f64; 3], _: Transport) -> Option<Scatter> {
        let (radius, (sin, cos)) = ((2.0 * CAP * u).sqrt(), (std::f64::consts::TAU * v).sin_cos());
        let density = Measure::SolidAngle(0.5 * FRAC_1_PI / CAP);
        let wi = [radius * cos, radius * sin, 1.0 - CAP * u];
        (wo[2] > 0.0).then_some(Scatter { wi, weight: [0.0; 3], density, eta: 1.0 })
    }
}

#[test]
fn a_lobe_narrower_than_its_cells_is_inconclusive() {
    let verdict = verdict_on(&Needle, Suite::ChiSquare);
    assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
    assert!(verdict.what.contains("narrower than the cells"), "{verdict}");
}

#[test]
fn correct_specimens_of_every_kind_conform() {
    for lobe in [white_paper, rough_mirror, rough_gold, glass, gold, unknown_glass, coated_gold, rough_glass]
    {
        let lobe = lobe();
        let mut plan = Plan::new(run_seed(), [&*lobe]);
        plan.samples = SAMPLES;
        for verdict in bxdf_tests::examine(&*lobe, &plan) {
            assert_eq!(verdict.outcome, Outcome::Holds, "{verdict}");
        }
    }
}

/// One test per row: its name, the suite, what the most telling check must be about, the lobe and the bug.
macro_rules! mutants {
    ($($name:ident: $suite:ident, $reason:literal, $lobe:ident, $bug:expr;)+) => {
        $(#[test]
        fn $name() {
            examine(stringify!($name), Suite::$suite, $reason, $lobe, $bug);
        })+

        #[test]
        fn every_suite_has_a_mutant() {
            let suites = [$(Suite::$suite),+];
            for suite in Suite::ALL {
                assert!(suites.contains(suite), "no mutant for suite {}", suite.name());
            }
        }
    };
}

mutants! {
    value_is_nan_at_grazing: Finite, "f [1/sr]", white_paper,
        Bug::Eval(|f, _, wi| if wi[2].abs() < 1e-7 { f64::NAN } else { f });
    density_is_negative_on_the_other_side: Finite, "pdf [1/sr]", white_paper,
        Bug::Pdf(|pdf, _, wi| if pdf > 0.0 { pdf } else { -1e-6 * wi[2].abs() });
    value_is_negative_where_no_edge_is: Finite, "anywhere inside", white_paper,
        Bug::Value(|f, wi| if is_inside(wi) { -f } else { f });
    weight_is_not_a_number_where_no_edge_is: Finite, "anywhere inside", white_paper,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| if is_inside(scatter.wi) { f64::NAN } else { weight }));
    direction_is_not_of_unit_length: Finite, "length of a sampled direction", rough_mirror,
        Bug::Scatter(|scatter, _, _| Scatter { wi: scatter.wi.map(|x| x * (1.0 + 1e-12)), ..scatter });
    sample_leaves_on_the_other_side: Finite, "on the other side", white_paper,
        Bug::Scatter(|scatter, _, _| Scatter { wi: scatter.wi.map(|x| -x), ..scatter });

    density_is_too_large: Normalised, "mass of the pdf", white_paper,
        Bug::Pdf(|pdf, _, _| 1.005 * pdf);
    sampler_insists_and_pdf_does_not_know: Normalised, "rate of no sample", rough_mirror,
        Bug::Sample(insistent);

    density_without_the_jacobian: ChiSquare, "chi-square", rough_mirror,
        Bug::Pdf(|pdf, wo, wi| pdf * 4.0 * half(wo, wi).1);
    jacobian_with_the_macro_normal: ChiSquare, "chi-square", rough_mirror,
        Bug::Pdf(|pdf, wo, wi| pdf * half(wo, wi).1 / wo[2]);
    roughness_is_squared_in_the_density: ChiSquare, "chi-square", rough_mirror,
        Bug::Pdf(|pdf, wo, wi| reflected(pdf, &ggx(0.3 * 0.3), wo, wi));
    roughness_is_off_in_the_density: ChiSquare, "chi-square", rough_gold,
        Bug::Pdf(|pdf, wo, wi| reflected(pdf, &beckmann(1.1 * 0.3), wo, wi));
    azimuth_covers_half_a_turn: ChiSquare, "chi-square", white_paper,
        Bug::Scatter(|scatter @ Scatter { wi: [x, y, z], .. }, _, _| Scatter { wi: [x, y.abs(), z], ..scatter });
    reflection_is_drawn_too_often: ChiSquare, "chi-square", glass,
        Bug::Sample(|glass, wo, [uc, u, v], transport| glass.sample(wo, [uc / 1.01, u, v], transport));

    weight_forgets_masking: Weight, "weight · pdf", rough_mirror,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0));
    weight_has_the_cosine_twice: Weight, "weight · pdf", white_paper,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| weight * scatter.wi[2].abs()));
    reported_density_is_uniform: Weight, "reported density", white_paper,
        Bug::Scatter(|scatter, _, _| Scatter { density: Measure::SolidAngle(0.5 * FRAC_1_PI), ..scatter });
    delta_has_a_density: Weight, "at a delta", gold,
        Bug::Pdf(|_, wo, wi| f64::from(dot([-wo[0], -wo[1], wo[2]], wi) > 1.0 - 1e-15));
    delta_has_a_density_everywhere: Normalised, "mass of the pdf and the deltas", gold,
        Bug::Pdf(|_, _, _| 1.0);
    importance_has_another_weight: Weight, "weight · pdf", white_paper,
        Bug::Scatter(|scatter, _, transport| {
            weighted(scatter, |weight| if transport == Transport::Importance { 5.0 * weight } else { weight })
        });
    paper_leaks: Weight, "on the other side", white_paper,
        Bug::Sample(|paper, wo, uniforms, transport| {
            let leaks = (0.6..0.7).contains(&uniforms[0]);
            let scatter = paper.sample(wo, uniforms, transport)?;
            Some(if leaks { Scatter { wi: scatter.wi.map(|x| -x), ..scatter } } else { scatter })
        });

    delta_depends_on_the_other_uniforms: Weight, "deltas of one direction", gold,
        Bug::Sample(|gold, wo, uniforms, transport| {
            let scatter = gold.sample(wo, uniforms, transport)?;
            Some(weighted(scatter, |weight| weight * (0.5 + uniforms[1])))
        });
    delta_reports_two_weights: Normalised, "mass of the pdf and the deltas", gold,
        Bug::Sample(|gold, wo, uniforms, transport| {
            let scatter = gold.sample(wo, uniforms, transport)?;
            Some(weighted(scatter, |weight| if uniforms[1] < 0.5 { weight } else { 0.5 * weight }))
        });
    components_report_each_other_s_probability: ChiSquare, "chi-square", coated_gold,
        Bug::Scatter(|scatter, _, _| match scatter.density {
            Measure::Discrete(share) => Scatter { density: Measure::Discrete(1.0 - share), ..scatter },
            Measure::SolidAngle(_) => scatter,
        });
    components_report_their_joint_probability: Normalised, "mass of the pdf and the deltas", coated_gold,
        Bug::Scatter(|scatter, _, _| Scatter { density: Measure::Discrete(1.0), ..scatter });
    one_component_is_not_reciprocal: Reciprocal, "power of a delta", coated_gold,
        // The rarer one, so that the other alone would not show it.
        Bug::Scatter(|scatter, wo, _| match scatter.density {
            Measure::Discrete(share) if share < 0.5 && wo[0] > 0.0 => weighted(scatter, |weight| 0.9 * weight),
            _ => scatter,
        });

    value_prefers_one_direction: Reciprocal, "f(wo, wi) against f(wi, wo)", rough_gold,
        Bug::Eval(|f, wo, _| f * (1.0 + 0.1 * wo[2]));
    radiance_keeps_its_value_in_glass: Reciprocal, "power of a delta", glass,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0));

    radiance_is_halved_in_glass: Reciprocal, "power of a delta", glass,
        Bug::Scatter(|scatter, _, transport| {
            weighted(scatter, |weight| if transport == Transport::Radiance { 0.5 * weight } else { weight })
        });
    mirror_turns_what_it_reflects: Reciprocal, "way back", gold,
        Bug::Scatter(|scatter @ Scatter { wi: [x, y, z], .. }, _, _| Scatter { wi: [-y, x, z], ..scatter });

    unknown_glass_keeps_radiance_and_reports_no_index: Reciprocal, "squeezes", unknown_glass,
        Bug::Scatter(|scatter, _, _| Scatter { eta: 1.0, ..weighted(scatter, |_| 1.0) });
    radiance_keeps_its_value_in_rough_glass: Reciprocal, "f of importance against η² f of radiance", rough_glass,
        Bug::Mode(|f, wo, wi, transport| {
            let keeps = transport == Transport::Radiance && crosses(wo, wi);
            if keeps { f * beyond(wo) * beyond(wo) } else { f }
        });
    both_modes_gain_in_rough_glass: Reciprocal, "f of importance against η² f of radiance", rough_glass,
        // η² where it is lost on the way in and gained on the way out: reciprocal, and no boundary at all.
        Bug::Mode(|f, wo, wi, transport| match transport {
            Transport::Importance if crosses(wo, wi) => f / beyond(wo),
            Transport::Radiance if crosses(wo, wi) => f * beyond(wo),
            _ => f,
        });

    value_knows_the_azimuth: Isotropic, "after a turn", white_paper,
        Bug::Eval(|f, _, wi| f * (1.0 + 0.01 * wi[0]));

    albedo_exceeds_one: Energy, "directional albedo", white_paper,
        Bug::Eval(|f, _, _| 1.02 * f);
    mean_weight_is_not_the_albedo: Energy, "mean weight", rough_mirror,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| 1.01 * weight));
    lossless_boundary_absorbs: Energy, "energy lost", glass,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |weight| 0.999 * weight));
    importance_is_scaled_as_radiance: Energy, "directional albedo", glass,
        Bug::Scatter(|scatter, _, _| weighted(scatter, |_| 1.0 / (scatter.eta * scatter.eta)));

    schlick_instead_of_fresnel: Fresnel, "error of the reflectance", gold,
        Bug::Sample(schlick_mirror);
    amplitude_instead_of_reflectance: Fresnel, "p reflectance", rough_gold,
        Bug::Fresnel(f64::sqrt);
    refraction_into_the_wrong_medium: Fresnel, "Snell", glass,
        Bug::Scatter(bent_the_wrong_way);

    conductor_ends_at_80_degrees: Fresnel, "error of the reflectance", gold,
        Bug::Sample(|gold, wo, uniforms, transport| {
            if wo[2] > 0.17 { gold.sample(wo, uniforms, transport) } else { None }
        });

    index_of_rough_glass_is_upside_down: Fresnel, "index that a refraction reports", rough_glass,
        Bug::Scatter(|scatter, _, _| Scatter { eta: 1.0 / scatter.eta, ..scatter });
    index_of_a_reflection_is_that_of_glass: Weight, "index that a reflection reports", rough_glass,
        Bug::Scatter(|scatter, wo, _| Scatter { eta: beyond(wo), ..scatter });

    transmission_without_the_squared_index: Microfacet, "(1 - F) D G2", rough_glass,
        Bug::Mode(|f, wo, wi, _| if crosses(wo, wi) { f / beyond(wo) / beyond(wo) } else { f });
    transmission_has_another_fresnel_term: Microfacet, "(1 - F) D G2", rough_glass,
        Bug::Mode(|f, wo, wi, _| if crosses(wo, wi) { f * (1.0 - 1e-6 * wo[2].abs()) } else { f });
    shadowing_of_cavities_as_in_reflection: Microfacet, "(1 - F) D G2", glass_with_cavities,
        Bug::Shadowed(|surface, wo, wi, m| {
            let behind = if wi[2] < 0.0 { wi.map(|x| -x) } else { wi };
            surface.g1(wo, m).min(surface.g1(behind, m))
        });
    shadowing_behind_the_surface_is_forgotten: Microfacet, "G2", rough_glass,
        Bug::Shadowed(|surface, wo, wi, m| if wi[2] > 0.0 { surface.g2(wo, wi, m) } else { surface.g1(wo, m) });
    cavities_mask_half_as_much: Microfacet, "weak white furnace", glass_with_cavities,
        Bug::Masked(|_, w, m| (4.0 * m[2] * w[2] / dot(w, m).abs()).min(1.0));
    masking_does_not_follow_lambda: Microfacet, "G1 (1 + Λ)", rough_glass,
        Bug::Masked(|g1, w, m| if dot(w, m) < 0.9 { g1 } else { g1 * (1.0 - 1e-9) });

    value_has_another_fresnel_term: Microfacet, "F D G2", rough_gold,
        Bug::Eval(|f, wo, _| f * (1.0 - 0.1 * wo[2]));
    normals_do_not_cover_the_surface: Microfacet, "∫", rough_mirror,
        Bug::Normals(|d| 1.001 * d);
    masking_of_another_distribution: Microfacet, "∫", rough_mirror,
        Bug::Masking(beckmann(0.3));
    visible_normals_that_face_away: Microfacet, "density of visible normals", rough_mirror,
        Bug::Visible(|pdf, w, m| if pdf > 0.0 { pdf } else { unclamped(&ggx(0.3), w, m) });
}

//! Every suite can go red: each planted bug is found by the suite that must find it, for the reason that it was
//! planted; the same specimen without the bug holds.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Energy, Examination, Measure, Microsurface, Outcome, Plan, Precision, Scatter,
    Specimen, Suite, Transport, Verdict, run_seed,
};
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lambertian, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::planted::{PlantedBug, Search, SelfCheck, Suites};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use std::f64::consts::FRAC_1_PI;

#[test]
fn planted_bugs_are_caught_by_the_suites_that_must_and_twins_hold() {
    let check = SelfCheck::run(run_seed(), 1, Plan::DEFAULT_SAMPLES, Suites::Finder, &|| ()).unwrap();
    let missed: Vec<_> = check.bugs.iter().filter(|bug| bug.search == Search::Missed).collect();
    assert!(missed.is_empty(), "run seed {}: {missed:#?}", check.run_seed);
    let failures: Vec<_> = check.failures.iter().map(ToString::to_string).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
    for bug in check.bugs.iter().filter(|bug| bug.search == Search::Elsewhere) {
        let outcomes = &bug.row.outcomes;
        let holds = outcomes.iter().all(|&(_, outcome)| outcome == Outcome::Holds);
        assert!(holds, "a suite can find {} after all: {outcomes:?}", bug.row.name);
    }
    // Every suite has a bug that it must find, and there are enough of them.
    for &suite in Suite::ALL {
        assert!(check.bugs.iter().any(|bug| bug.suite == Some(suite)), "{}", suite.name());
    }
    assert!(check.count(Search::Caught) >= 100, "{} caught", check.count(Search::Caught));
    assert!(check.count(Search::NeedsMoreSamples) <= 4);
}

/// Millions of samples are the price of a histogram.
#[test]
fn bugs_that_need_more_samples_are_found_without_any() {
    let beyond_reach = PlantedBug::ALL.iter().filter(|bug| bug.samples > Plan::DEFAULT_SAMPLES);
    for bug in beyond_reach {
        let mutant = bug.mutant().unwrap();
        let verdict = verdict_on(&*mutant, Suite::Jacobian);
        assert_eq!(verdict.outcome, Outcome::Violated, "{}: {verdict}", bug.name);
        assert_eq!(verdict.samples, 0);
    }
}

/// What contradicts no claim still changes f: reference values see it.
#[test]
fn bugs_beyond_the_claims_change_the_value() {
    for bug in PlantedBug::ALL {
        if let gonio::planted::Finder::Elsewhere(_) = bug.finder {
            let (wo, wi) = ([0.6, 0.0, 0.8], [0.0, 0.8, 0.6]);
            let [wrong, right] = [bug.mutant().unwrap(), bug.twin().unwrap()]
                .map(|specimen| specimen.eval(wo, wi, Transport::Radiance)[0]);
            assert!((wrong / right - 1.0).abs() > 0.01, "{}: {wrong} {right}", bug.name);
        }
    }
}

fn white_paper() -> BxdfSpecimen<f64> {
    BxdfSpecimen::of_lobe("white_paper", Lambertian::<f64>::new(Rgb::WHITE).unwrap())
}

fn rough_mirror(alpha: f64) -> BxdfSpecimen<f64> {
    let ggx = Distribution::new(Shape::Ggx, alpha, alpha).unwrap();
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    BxdfSpecimen::of_lobe("rough_mirror", MicrofacetReflection::new(ggx, white))
}

/// The same sample with another weight per channel.
fn weighted(scatter: Scatter, weight: impl Fn(f64) -> f64) -> Scatter {
    Scatter { weight: scatter.weight.map(weight), ..scatter }
}

fn verdict_on(specimen: &dyn Specimen, suite: Suite) -> Verdict {
    let plan = Plan::new(run_seed(), [specimen]);
    Examination::new(specimen, &plan).verdict(suite).unwrap()
}

/// White paper with other claims about its energy, and what is left of its reflectance.
struct Paper {
    paper: BxdfSpecimen<f64>,
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

/// Between 0.1 and 1.9, and different wherever anything is: no rule of cubature agrees with another about it.
fn noise(numbers: &[f64]) -> f64 {
    let scrambled = numbers.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, x| {
        (hash ^ x.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15).rotate_left(29)
    });
    0.1 + 1.8 * (scrambled.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Noise takes all the effort that cubature may spend; one of the directions is enough.
fn is_noisy(wo: Direction) -> bool {
    (0.86..0.87).contains(&wo[2])
}

/// What is noise about its correct value.
#[derive(Clone, Copy, PartialEq)]
enum Noise {
    Pdf,
    Value,
    Normals,
}

/// A specimen with noise, under a waiver that does not help where there is one.
struct Noisy {
    specimen: BxdfSpecimen<f64>,
    noise: Noise,
    is_waived: bool,
}

impl Specimen for Noisy {
    fn name(&self) -> String {
        "noise".into()
    }
    fn claims(&self) -> Claims {
        let claims = self.specimen.claims();
        if self.is_waived { claims.waive(Suite::Normalised, "noise") } else { claims }
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let is_noise = self.noise == Noise::Value && is_noisy(wo);
        self.specimen.eval(wo, wi, transport).map(|f| if is_noise { f * noise(&wi) } else { f })
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let is_noise = self.noise == Noise::Pdf && is_noisy(wo);
        self.specimen.pdf(wo, wi, transport) * if is_noise { noise(&wi) } else { 1.0 }
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let scatter = self.specimen.sample(wo, uniforms, transport)?;
        let pdf = self.pdf(wo, scatter.wi, transport);
        let weight = self.eval(wo, scatter.wi, transport).map(|f| f * scatter.wi[2].abs() / pdf);
        Some(Scatter { weight, density: Measure::SolidAngle(pdf), ..scatter })
    }
    fn microsurface(&self) -> Option<&dyn Microsurface> {
        Some(self)
    }
}

impl Noisy {
    fn surface(&self) -> &dyn Microsurface {
        self.specimen.microsurface().unwrap()
    }
}

impl Microsurface for Noisy {
    fn d(&self, m: Direction) -> f64 {
        let d = self.surface().d(m);
        d * noise(&[d])
    }
    fn lambda(&self, w: Direction) -> Option<f64> {
        self.surface().lambda(w)
    }
    fn g1(&self, w: Direction, m: Direction) -> f64 {
        self.surface().g1(w, m)
    }
    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64 {
        self.surface().g2(wo, wi, m)
    }
    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64> {
        let facing = (0..3).map(|i| w[i] * m[i]).sum::<f64>().max(0.0);
        Some(self.d(m) * facing * self.g1(w, m) / w[2])
    }
}

#[test]
fn noise_is_inconclusive_and_no_waiver_changes_that() {
    for (specimen, noise, suite, reason) in [
        (white_paper(), Noise::Pdf, Suite::Normalised, "integral of the pdf does not converge"),
        (white_paper(), Noise::Value, Suite::Energy, "integral of f cos does not converge"),
        (rough_mirror(0.3), Noise::Normals, Suite::Microfacet, "integral does not converge"),
    ] {
        let verdict = verdict_on(&Noisy { specimen, noise, is_waived: false }, suite);
        assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
        assert!(verdict.what.contains(reason), "{reason} is the reason, but: {verdict}");
    }
    let noisy = Noisy { specimen: white_paper(), noise: Noise::Pdf, is_waived: true };
    let verdict = verdict_on(&noisy, Suite::Normalised);
    assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
}

/// White paper that draws its directions as if it were a mirror of small roughness.
struct Misguided(BxdfSpecimen<f64>);

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
    let misguided = Misguided(rough_mirror(0.02));
    let verdict = verdict_on(&misguided, Suite::Energy);
    assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
    assert!(verdict.what.contains("weights are so uneven"), "{verdict}");
}

/// Scatters evenly into a cap about the normal that is as wide as the narrowest cell in single precision.
struct Needle;

/// 1 − cos of the cap's half angle.
const CAP: f64 = 2e-11;

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

//! The statistics find what they say they find: small errors of a roughness and of a selection probability, with a
//! million samples of one direction, at the level of 1 % that others use.
//!
//! The long form prints how often each error is found: `BXDF_TESTS_SEEDS=400 cargo test --test power -- --nocapture`.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Plan, Precision, Scatter, Specimen, Suite, Transport, run_seed,
};
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lambertian, MicrofacetReflection, SpecularReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use rayon::prelude::*;

const SAMPLES: usize = 1_000_000;
const LEVEL: f64 = 0.01;

fn mirror(shape: Shape, alpha: f64) -> BxdfSpecimen<f64> {
    let distribution = Distribution::new(shape, alpha, alpha).unwrap();
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    BxdfSpecimen::of_lobe("mirror", MicrofacetReflection::new(distribution, white))
}

/// A first lobe that is picked with one probability and says that it is picked with another, and a second one.
struct Mixture {
    name: String,
    picked: f64,
    stated: f64,
    first: BxdfSpecimen<f64>,
    second: BxdfSpecimen<f64>,
}

impl Specimen for Mixture {
    fn name(&self) -> String {
        self.name.clone()
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        let (first, second) = (self.first.eval(wo, wi, transport), self.second.eval(wo, wi, transport));
        std::array::from_fn(|i| self.stated * first[i] + (1.0 - self.stated) * second[i])
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        let (first, second) = (self.first.pdf(wo, wi, transport), self.second.pdf(wo, wi, transport));
        self.stated * first + (1.0 - self.stated) * second
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let is_first = uniforms[0] < self.picked;
        let (lobe, share) =
            if is_first { (&self.first, self.stated) } else { (&self.second, 1.0 - self.stated) };
        let scatter = lobe.sample(wo, uniforms, transport)?;
        let density = match scatter.density {
            Measure::Discrete(probability) => Measure::Discrete(probability * share),
            // Not that of the mixture, which takes longer to compute than all else and is another suite's matter.
            density @ Measure::SolidAngle(_) => density,
        };
        Some(Scatter { density, ..scatter })
    }
}

/// A lobe of another roughness than the one that is sampled: the second lobe is never picked, and the only one stated.
fn roughness(shape: Shape, alpha: f64, error: f64) -> Mixture {
    Mixture {
        name: format!("alpha of {shape:?} {alpha} off by {:.2} %", 100.0 * error),
        picked: 1.0,
        stated: 0.0,
        first: mirror(shape, alpha * (1.0 + error)),
        second: mirror(shape, alpha),
    }
}

fn selection(what: &str, error: f64, first: BxdfSpecimen<f64>) -> Mixture {
    let second = BxdfSpecimen::of_lobe("paper", Lambertian::new(Rgb::WHITE).unwrap());
    let name = format!("{what} picked {:.1} % too often", 100.0 * error);
    Mixture { name, picked: 0.5 * (1.0 + error), stated: 0.5, first, second }
}

/// Of how many fresh sets of samples the χ² suite rejects the specimen at `LEVEL`, Bonferroni's correction for
/// its checks included; seen from 30°.
fn found(specimen: &Mixture, seed: u64, seeds: u64) -> u64 {
    let mut plan = Plan::new(seed, [specimen as &dyn Specimen]);
    plan.samples = SAMPLES;
    let examination = Examination::new(specimen, &plan);
    let from_30_degrees = |wo: Direction| (wo[2] - 30.0_f64.to_radians().cos()).abs() < 1e-9;
    let trial = examination
        .trials()
        .find(|trial| trial.witness().wo.is_some_and(from_30_degrees))
        .expect("in the grid");
    let rejected = |repetition: u64| {
        let p_values = trial.p_values(repetition);
        let of_chi_square = || p_values.iter().filter(|(suite, _)| *suite == Suite::ChiSquare);
        let least = of_chi_square().map(|(_, p)| p.ln_p).fold(0.0, f64::min);
        least.exp() * (of_chi_square().count() as f64) < LEVEL
    };
    let found = (1..=seeds).into_par_iter().filter(|&repetition| rejected(repetition)).count() as u64;
    println!("{}: found {found} of {seeds} times", specimen.name);
    found
}

/// The number of seeds, unless the environment says another.
fn seeds(few: u64) -> u64 {
    std::env::var("BXDF_TESTS_SEEDS").map_or(few, |text| text.parse().expect("a whole number"))
}

#[test]
fn errors_of_one_percent_are_always_found() {
    let (seed, seeds) = (run_seed(), seeds(6));
    println!("run seed {seed}");
    let gloss = mirror(Shape::Ggx, 0.1);
    let delta =
        BxdfSpecimen::of_lobe("delta", SpecularReflection::new(Fresnel::constant(Rgb::WHITE).unwrap()));
    for specimen in [
        roughness(Shape::Ggx, 0.5, 0.01),
        selection("gloss over paper", 0.01, gloss),
        selection("delta over paper", 0.01, delta),
    ] {
        assert_eq!(found(&specimen, seed, seeds), seeds, "{}", specimen.name);
    }
}

/// The best possible test finds 0.36 % (GGX) and 0.21 % (Beckmann) with probability 0.95.
#[test]
fn a_roughness_that_is_hardly_off_is_found() {
    let (seed, seeds) = (run_seed(), seeds(20));
    println!("run seed {seed}");
    for specimen in [roughness(Shape::Ggx, 0.5, 0.005), roughness(Shape::Beckmann, 0.5, 0.003)] {
        // With probability 0.95 each, half of 20 or fewer come out once in 10⁸ runs.
        let found = found(&specimen, seed, seeds);
        assert!(2 * found > seeds, "{}: {found}", specimen.name);
    }
}

/// A lobe that loses some of its samples and is too bright in what remains.
struct Off {
    lobe: BxdfSpecimen<f64>,
    lost: f64,
    brighter: f64,
}

impl Specimen for Off {
    fn name(&self) -> String {
        format!("{} off by {:e} and {:e}", self.lobe.name(), self.lost, self.brighter)
    }
    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        self.lobe.eval(wo, wi, transport)
    }
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        self.lobe.pdf(wo, wi, transport)
    }
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let scatter = self.lobe.sample(wo, uniforms, transport).filter(|_| uniforms[0] >= self.lost)?;
        Some(Scatter { weight: scatter.weight.map(|weight| weight * (1.0 + self.brighter)), ..scatter })
    }
}

/// The effect that a check says it finds at every direction, and the share of fresh sets of samples in which the first
/// stage of a verdict finds what a specimen has: at the direction where it finds least, and over all.
fn finds(specimen: &dyn Specimen, seed: u64, suite: Suite, check: &str) -> (f64, [f64; 2]) {
    const STAGE: f64 = -9.210_340_371_976_182;
    let mut plan = Plan::new(seed, [specimen]);
    plan.samples = 1 << 14;
    let examination = Examination::new(specimen, &plan);
    let mut effect: f64 = 0.0;
    let mut shares = Vec::new();
    for trial in examination.trials() {
        let p_values: Vec<_> = (1..=100)
            .into_par_iter()
            .filter_map(|repetition| {
                let p_values = trial.p_values(repetition);
                p_values.into_iter().find(|(of, p)| *of == suite && p.what.contains(check))
            })
            .collect();
        let detectable = p_values.iter().filter_map(|(_, p)| p.detectable);
        effect = detectable.map(|detectable| detectable.effect).fold(effect, f64::max);
        let found = p_values.iter().filter(|(_, p)| p.ln_p < STAGE).count();
        shares.push(found as f64 / p_values.len() as f64);
    }
    let least = shares.iter().copied().fold(1.0, f64::min);
    (effect, [least, shares.iter().sum::<f64>() / shares.len() as f64])
}

#[test]
fn the_minimum_detectable_effect_is_detected_and_a_quarter_of_it_is_not() {
    let seed = run_seed();
    println!("run seed {seed}");
    let delta = || {
        let white = Fresnel::constant(Rgb::WHITE).unwrap();
        BxdfSpecimen::of_lobe("delta", SpecularReflection::new(white))
    };
    let paper = || BxdfSpecimen::of_lobe("paper", Lambertian::new(Rgb::WHITE).unwrap());
    let specimens: [(Suite, &str, &dyn Fn(f64) -> Box<dyn Specimen>); 3] = [
        (Suite::ChiSquare, "coarse cells", &|effect| {
            // A component that is picked half of the time deviates by the error of its probability.
            Box::new(selection("delta over paper", effect, delta()))
        }),
        (Suite::Normalised, "rate of no sample", &|lost| {
            Box::new(Off { lobe: paper(), lost, brighter: 0.0 })
        }),
        (Suite::Energy, "mean weight", &|brighter| {
            Box::new(Off { lobe: mirror(Shape::Ggx, 0.5), lost: 0.0, brighter })
        }),
    ];
    for (suite, check, off_by) in specimens {
        let (effect, _) = finds(&*off_by(0.0), seed, suite, check);
        let (_, [_, share]) = finds(&*off_by(effect), seed, suite, check);
        let (_, [of_quarter, _]) = finds(&*off_by(0.25 * effect), seed, suite, check);
        println!(
            "{check}: {effect:.5} found in {share:.4}, a quarter in {of_quarter:.4} where power is least"
        );
        // 0.995 is what a stage is made for; of 900 sets of samples, more than 27 then miss it once in 10¹² runs.
        assert!(share > 0.97 && of_quarter < 0.5, "{check}");
    }
}

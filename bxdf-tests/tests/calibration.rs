//! The statistics are what they claim to be: on correct specimens every p-value is uniform, neither too small, which
//! raises false alarms, nor too large, which hides bugs.
//!
//! The long forms take more p-values per check, more samples and more run seeds, and print tables:
//! `BXDF_TESTS_P_VALUES=10000 BXDF_TESTS_SAMPLES=262144 cargo test --test calibration uniform -- --nocapture` and
//! `BXDF_TESTS_RUN_SEEDS=10000 cargo test --test calibration accused -- --nocapture`.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot be set up has failed")]

use std::collections::BTreeMap;

use bxdf_tests::{Examination, PValue, Plan, Specimen, Suite, run_seed};
use gonio::fresnel::Fresnel;
use gonio::lobe::{DielectricSpecular, Lambertian, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::{BxdfSpecimen, catalogue};
use rayon::prelude::*;

/// Probability that this test fails on statistics that are right.
const FAMILY: f64 = 1e-6;

/// A number from the environment, or what the short form takes.
fn setting(variable: &str, short: u64) -> u64 {
    std::env::var(variable).map_or(short, |text| text.parse().expect("a whole number"))
}

fn mirror(shape: Shape, alpha: f64) -> Box<dyn Specimen> {
    let distribution = Distribution::<f64>::new(shape, alpha, alpha).unwrap();
    let white = Fresnel::constant(Rgb::WHITE).unwrap();
    let name = format!("{shape:?}, alpha {alpha}");
    Box::new(BxdfSpecimen::of_lobe(&name, MicrofacetReflection::new(distribution, white)))
}

fn specimens() -> Vec<Box<dyn Specimen>> {
    let paper = Lambertian::<f64>::new(Rgb::WHITE).unwrap();
    let glass = DielectricSpecular::<f64>::new(1.5).unwrap();
    vec![
        mirror(Shape::Ggx, 0.01),
        mirror(Shape::Beckmann, 0.02),
        mirror(Shape::Ggx, 0.05),
        mirror(Shape::Beckmann, 0.1),
        mirror(Shape::Ggx, 0.2),
        mirror(Shape::Beckmann, 0.5),
        mirror(Shape::Ggx, 1.0),
        Box::new(BxdfSpecimen::of_lobe("paper", paper)),
        Box::new(BxdfSpecimen::of_lobe("glass", glass)),
    ]
}

/// Whether p-values can only be valid, not uniform: those of small counts, and those of weights that hardly vary, whose
/// mean has the allowance for errors of the cubature and few large values instead of a normal distribution.
fn is_only_valid(suite: Suite, p_values: &[&PValue]) -> bool {
    let ones = p_values.iter().filter(|p| p.ln_p == 0.0).count();
    let hardly_varies = |p: &PValue| {
        // The effect is some nine standard deviations of the mean.
        p.detectable.is_some_and(|detectable| detectable.effect * (p.samples as f64).sqrt() < 9.0 * 0.04)
    };
    match suite {
        Suite::Normalised => 50 * ones > p_values.len(),
        Suite::Energy => p_values.iter().any(|p| hardly_varies(p)),
        _ => p_values.iter().any(|p| p.what.contains("next to nothing")),
    }
}

/// p-values of one check, from all directions of a specimen.
#[derive(Default)]
struct Sample {
    /// Must be uniform.
    uniform: Vec<f64>,
    /// Must not be small too often.
    valid: Vec<f64>,
}

/// p-value of the Kolmogorov–Smirnov test for uniformity (Stephens, JRSS B 32(1), 1970), and the distance.
fn kolmogorov_smirnov(p_values: &[f64]) -> (f64, f64) {
    let mut sorted = p_values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let n = sorted.len() as f64;
    let distance = sorted
        .iter()
        .enumerate()
        .fold(0.0, |distance: f64, (i, p)| distance.max(p - i as f64 / n).max((i as f64 + 1.0) / n - p));
    let lambda = distance * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    let terms = (1..100).map(f64::from).map(|j: f64| {
        let term = 2.0 * (-2.0 * j * j * lambda * lambda).exp();
        if j % 2.0 == 1.0 { term } else { -term }
    });
    (if lambda < 0.2 { 1.0 } else { terms.sum::<f64>() }, distance)
}

/// Prints how uniform p-values are, and says so if they are not.
fn not_uniform(specimen: &str, what: &str, p_values: &[f64]) -> Option<String> {
    if p_values.is_empty() {
        return None;
    }
    let (p, distance) = kolmogorov_smirnov(p_values);
    let percent_below =
        |level: f64| 100.0 * p_values.iter().filter(|&&p| p < level).count() as f64 / p_values.len() as f64;
    println!(
        "  {specimen}, {what}: {} p-values, distance {distance:.4}, p {p:.1e}, below 1 %: {:.2} %, below 0.1 %: {:.3} %",
        p_values.len(),
        percent_below(0.01),
        percent_below(0.001)
    );
    // Some hundred such tests are made.
    (p < FAMILY / 100.0).then(|| format!("{specimen}, {what}: distance {distance} from uniform"))
}

/// Below which share of `count` p-values at most `level` are expected, but for chance.
fn most_below(level: f64, count: usize) -> f64 {
    let n = count as f64;
    // Bernstein.
    let x = -(FAMILY / 1e3).ln();
    level + x / (3.0 * n) + ((x / (3.0 * n)).powi(2) + 2.0 * level * x / n).sqrt()
}

#[test]
fn p_values_on_correct_specimens_are_uniform() {
    let seed = run_seed();
    println!("run seed {seed}");
    let p_values_per_check = setting("BXDF_TESTS_P_VALUES", 800);
    let samples = setting("BXDF_TESTS_SAMPLES", 1 << 13) as usize;
    let mut checks: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    let mut failures = Vec::new();
    for specimen in specimens() {
        let mut plan = Plan::new(seed, [&*specimen]);
        plan.samples = samples;
        let examination = Examination::new(&*specimen, &plan);
        let mut p_values: BTreeMap<&str, Sample> = BTreeMap::new();
        let (mut rejected, mut tables) = (0, 0);
        let repetitions = p_values_per_check.div_ceil(examination.trials().count() as u64);
        for trial in examination.trials() {
            let repeated: Vec<_> =
                (1..=repetitions).into_par_iter().map(|repetition| trial.p_values(repetition)).collect();
            for table in &repeated {
                let chi_square = table.iter().filter(|(suite, _)| *suite == Suite::ChiSquare);
                let least = chi_square.clone().map(|(_, p)| p.ln_p).fold(0.0, f64::min);
                rejected += usize::from(least.exp() * (chi_square.count() as f64) < 0.01);
                tables += 1;
            }
            for check in 0..repeated[0].len() {
                let (suite, first) = &repeated[0][check];
                // The weights of three equal channels are one check.
                if repeated[0][..check].iter().any(|(_, other)| other.what == first.what) {
                    continue;
                }
                let column: Vec<_> = repeated.iter().map(|table| &table[check].1).collect();
                let nothing_to_compare = column.iter().all(|p| p.ln_p == 0.0);
                let sample = p_values.entry(first.what).or_default();
                let kind = if is_only_valid(*suite, &column) || nothing_to_compare {
                    &mut sample.valid
                } else {
                    &mut sample.uniform
                };
                kind.extend(column.iter().map(|p| p.ln_p.exp()));
            }
        }
        let share = rejected as f64 / f64::from(tables);
        println!("{}: {tables} tables, {:.2} % rejected at 1 %", specimen.name(), 100.0 * share);
        if share > most_below(0.01, tables as usize) {
            failures.push(format!("{}: {share} of the tables rejected", specimen.name()));
        }
        for (what, Sample { uniform, valid }) in p_values {
            failures.extend(not_uniform(&specimen.name(), what, &uniform));
            for level in [0.001, 0.01, 0.1] {
                let below = valid.iter().filter(|&&p| p < level).count() as f64;
                if below > most_below(level, valid.len()) * valid.len() as f64 {
                    failures.push(format!("{} {what}: {below} below {level}", specimen.name()));
                }
            }
            checks.entry(what).or_default().extend(uniform);
        }
    }
    for (what, p_values) in checks {
        // Together they see smaller errors than those of one specimen.
        failures.extend(not_uniform("all specimens", what, &p_values));
        // Which of the directions that only the run seed knows have enough to compare is chance.
        if 2 * (p_values.len() as u64) < p_values_per_check && !what.contains("next to nothing") {
            failures.push(format!("{what}: only {} p-values", p_values.len()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Random samples per direction of the quick catalogue: one p-value in the grey zone costs a second look, whatever their
/// number.
const QUICK: usize = 1 << 12;

/// One specimen of each family of the catalogue and of each precision: each lobe, each stack.
fn quick_catalogue() -> Vec<Box<dyn Specimen>> {
    let family = |name: &str| {
        let parts: Vec<&str> = name.split('/').collect();
        (parts[0].to_owned(), parts[parts.len() - 1].to_owned())
    };
    let mut quick: Vec<Box<dyn Specimen>> = Vec::new();
    for specimen in catalogue().unwrap() {
        if quick.iter().all(|known| family(&known.name()) != family(&specimen.name())) {
            quick.push(specimen);
        }
    }
    quick
}

#[test]
fn no_correct_specimen_is_accused() {
    let (seed, run_seeds) = (run_seed(), setting("BXDF_TESTS_RUN_SEEDS", 2));
    let specimens = quick_catalogue();
    let plan = Plan { samples: QUICK, ..Plan::new(seed, specimens.iter().map(|specimen| &**specimen)) };
    println!("run seed {seed}: {} specimens, {run_seeds} run seeds", specimens.len());
    let accused: Vec<String> = specimens
        .par_iter()
        .with_max_len(1)
        .flat_map_iter(|specimen| {
            let examination = Examination::new(&**specimen, &plan);
            let accused: Vec<String> = examination
                .trials()
                .flat_map(|trial| {
                    let violated = (1..=run_seeds).into_par_iter().filter(|&i| trial.is_violated(i));
                    violated
                        .map(|i| format!("{} {i}: {:?}", specimen.name(), trial.witness()))
                        .collect::<Vec<_>>()
                })
                .collect();
            let directions = examination.trials().count();
            println!("  {}: {directions} directions, {} violations", specimen.name(), accused.len());
            accused
        })
        .collect();
    // Each run makes as many checks as the family has.
    let runs = plan.family as f64 * run_seeds as f64;
    println!("{} violations; {runs:e} checks of level {:.1e}", accused.len(), plan.ln_level().exp());
    assert!(accused.is_empty(), "{}", accused.join("\n"));
}

//! Means with their errors, and checks that raise a false alarm with a known probability.

use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};

use rand_pcg::Pcg64;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// The probability, at most, that the checks of this file together raise a false alarm.
const FAMILY_ERROR_RATE: f64 = bxdf_tests::FAMILY_ERROR_RATE;
/// The number of checks among which it is divided.
const MOST_CHECKS: usize = 2000;
/// What the cubature of an albedo may be wrong by: no mean of a walk sees a hundred times as much.
pub(crate) const CUBATURE: f64 = 1e-5;
const LEVEL: f64 = FAMILY_ERROR_RATE / MOST_CHECKS as f64;
static CHECKS: AtomicUsize = AtomicUsize::new(0);

/// The seed of the run, the same for all tests.
fn seed() -> u64 {
    static SEED: OnceLock<u64> = OnceLock::new();
    *SEED.get_or_init(bxdf_tests::run_seed)
}

/// Random numbers for one trial: they follow from its name and the seed of the run, whatever else runs.
pub(crate) fn generator(trial: &str) -> Pcg64 {
    // The 128-bit Fowler–Noll–Vo hash (1a).
    let hash = trial.bytes().fold(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d_u128, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
    });
    Pcg64::new(hash ^ (u128::from(seed()) << 64 | u128::from(seed())), hash)
}

/// The mean of independent values in \[0, 1\].
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Mean {
    samples: f64,
    sum: f64,
    sum_of_squares: f64,
}

impl Mean {
    pub(crate) fn add(&mut self, value: f64) {
        assert!((0.0..=1.0 + 1e-12).contains(&value), "{value} is no fraction of energy");
        self.samples += 1.0;
        self.sum += value;
        self.sum_of_squares += value * value;
    }

    pub(crate) fn value(&self) -> f64 {
        self.sum / self.samples
    }

    fn variance(&self) -> f64 {
        (self.sum_of_squares - self.sum * self.value()).max(0.0) / (self.samples - 1.0)
    }

    pub(crate) fn standard_error(&self) -> f64 {
        (self.variance() / self.samples).sqrt()
    }

    /// How far the value may lie from its expectation before a check reports it: the empirical Bernstein
    /// bound of Maurer and Pontil (COLT 2009, theorem 4). A normal quantile would be 6.2 standard errors;
    /// this is 6.8 and a term for rare values, and holds for every distribution on \[0, 1\].
    fn reach(&self) -> f64 {
        let ln = (4.0 / LEVEL).ln();
        (2.0 * ln).sqrt() * self.standard_error() + 7.0 * ln / (3.0 * (self.samples - 1.0))
    }
}

/// The checks of one test.
pub(crate) struct Checks {
    failures: Vec<String>,
    count: usize,
    largest_z: f64,
    /// Standardised deviations from what is expected, beyond its tolerance.
    deviations: Vec<f64>,
}

impl Checks {
    pub(crate) fn new() -> Self {
        Self { failures: Vec::new(), count: 0, largest_z: 0.0, deviations: Vec::new() }
    }

    fn count_one(&mut self) {
        self.count += 1;
        assert!(
            CHECKS.fetch_add(1, Ordering::Relaxed) < MOST_CHECKS,
            "more checks than share the error rate"
        );
    }

    /// An interval that holds the expectation.
    pub(crate) fn interval(&mut self, mean: &Mean) -> [f64; 2] {
        self.count_one();
        [mean.value() - mean.reach(), mean.value() + mean.reach()]
    }

    /// The expectation of `mean` lies within `tolerance` of `expected`.
    pub(crate) fn expect(&mut self, what: &str, mean: &Mean, expected: f64, tolerance: f64) {
        let [low, high] = self.interval(mean);
        let excess = ((mean.value() - expected).abs() - tolerance).max(0.0);
        let z = if excess > 0.0 { excess / mean.standard_error() } else { 0.0 };
        self.largest_z = self.largest_z.max(z);
        self.deviations.push(z);
        // Also where it is not a number.
        if !(low <= expected + tolerance && expected - tolerance <= high) {
            let (value, error) = (mean.value(), mean.standard_error());
            self.failures.push(format!(
                "{what}: {value:.5} ± {error:.5} where {expected:.5} ± {tolerance:.1e} is expected"
            ));
        }
    }

    /// The expectation of `a` is `factor` times that of `b`.
    pub(crate) fn agree(&mut self, what: &str, a: &Mean, factor: f64, b: &Mean) {
        let difference = (a.value() - factor * b.value()).abs();
        let error = a.standard_error().hypot(factor * b.standard_error());
        let [low_a, high_a] = self.interval(a);
        let [low_b, high_b] = self.interval(b).map(|end| factor * end);
        self.largest_z = self.largest_z.max(difference / error);
        if !(low_a <= high_b && low_b <= high_a) {
            let (a, b) = (a.value(), factor * b.value());
            self.failures.push(format!("{what}: {a:.5} and {b:.5} differ by {difference:.5} ± {error:.5}"));
        }
    }

    /// The deviations so far are together no larger than chance makes them: finds a bias too small for each.
    /// Only for independent means with errors that are about normal.
    pub(crate) fn expect_jointly(&mut self) {
        self.count_one();
        let sum: f64 = self.deviations.iter().map(|z| z * z).sum();
        let count = self.deviations.len();
        let tail = ChiSquared::new(count as f64).unwrap().sf(sum);
        println!("Σz² = {sum:.1} over {count}, tail {tail:.3}");
        if tail.is_nan() || tail < LEVEL {
            self.failures.push(format!("Σz² = {sum:.1} over {count} deviations, tail {tail:e}"));
        }
    }

    /// Reports.
    #[track_caller]
    pub(crate) fn finish(self) {
        let Self { failures, count, largest_z, .. } = self;
        println!("{count} checks, largest deviation {largest_z:.2} standard errors");
        assert!(failures.is_empty(), "seed {}:\n{}", seed(), failures.join("\n"));
    }
}

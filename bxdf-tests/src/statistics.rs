//! Tail probabilities, always computed directly in the tail and as logarithms: 1 − cdf has no digits left
//! where verdicts are made.

use statrs::function::beta::checked_beta_reg;
use statrs::function::gamma::{checked_gamma_lr, checked_gamma_ur, ln_gamma};

/// ln Q(a, x), Q the regularised upper incomplete gamma function; a > 0, x ≥ 0.
///
/// In the tail, Legendre's continued fraction (Abramowitz & Stegun 6.5.31) evaluated by Lentz's method, which
/// has no smallest number; elsewhere statrs.
pub(crate) fn ln_gamma_q(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if x < a + 1.0 + a.sqrt() || x.is_nan() {
        return checked_gamma_ur(a, x).map_or(f64::NAN, f64::ln);
    }
    if x.is_infinite() {
        return f64::NEG_INFINITY;
    }
    let tiny = f64::MIN_POSITIVE;
    let mut b = x + 1.0 - a;
    let mut c = 1.0 / tiny;
    let mut d = 1.0 / b;
    let mut fraction = d;
    for i in 1..10_000 {
        let i = f64::from(i);
        let numerator = -i * (i - a);
        b += 2.0;
        d = 1.0 / (numerator * d + b);
        c = b + numerator / c;
        let factor = c * d;
        fraction *= factor;
        if (factor - 1.0).abs() < f64::EPSILON {
            break;
        }
    }
    a * libm::log(x) - x - ln_gamma(a) + libm::log(fraction)
}

/// ln of the probability that Pearson's statistic of `samples` samples over cells of the given
/// probabilities is at least `statistic`.
///
/// A gamma distribution with the exact first two moments of the statistic: mean k − 1 and variance
/// 2(k − 1) + (Σ 1/pᵢ − k² − 2k + 2) / N. With rare cells the plain χ² tail is too light and raises up to 28 times too many alarms.
pub(crate) fn ln_pearson_tail(statistic: f64, probabilities: &[f64], samples: f64) -> f64 {
    let k = probabilities.len() as f64;
    if k < 2.0 {
        return 0.0;
    }
    let inverse_sum: f64 = probabilities.iter().map(|p| 1.0 / p).sum();
    let mean = k - 1.0;
    let variance = 2.0 * mean + (inverse_sum - k * k - 2.0 * k + 2.0) / samples;
    ln_gamma_q(mean * mean / variance, statistic * mean / variance)
}

/// ln P(X ≥ observed) for X ~ Poisson(mean): an observation in a cell that expects almost nothing.
pub(crate) fn ln_poisson_upper_tail(observed: u64, mean: f64) -> f64 {
    if observed == 0 {
        return 0.0;
    }
    if mean <= 0.0 {
        return f64::NEG_INFINITY;
    }
    let n = observed as f64;
    if mean < n {
        // The terms fall from the first on; over the first they have no smallest number.
        let (mut term, mut sum, mut next) = (1.0, 1.0, n);
        while term > f64::EPSILON * sum {
            next += 1.0;
            term *= mean / next;
            sum += term;
        }
        return n * libm::log(mean) - mean - ln_gamma(n + 1.0) + libm::log(sum);
    }
    checked_gamma_lr(n, mean).map_or(f64::NAN, f64::ln)
}

/// ln of the two-sided p-value of `successes` out of `trials` where the probability lies in \[low, high\]:
/// the most favourable probability of the interval counts.
pub(crate) fn ln_binomial_two_sided(successes: u64, trials: u64, low: f64, high: f64) -> f64 {
    let (k, n) = (successes as f64, trials as f64);
    let rate = k / n;
    let (low, high) = (low.clamp(0.0, 1.0), high.clamp(0.0, 1.0));
    let tail = if rate > high {
        // P(X ≥ k) = I_p(k, n − k + 1)
        if high == 0.0 { Ok(0.0) } else { checked_beta_reg(k, n - k + 1.0, high) }
    } else if rate < low {
        // P(X ≤ k) = I_{1−p}(n − k, k + 1)
        if low == 1.0 { Ok(0.0) } else { checked_beta_reg(n - k, k + 1.0, 1.0 - low) }
    } else if low.is_nan() || high.is_nan() {
        return f64::NAN;
    } else {
        return 0.0;
    };
    tail.map_or(f64::NAN, |tail| (2.0 * tail).clamp(0.0, 1.0).ln())
}

/// ln of Bernstein's bound on the two-sided p-value of a mean of `samples` values in a range of width
/// `range`, with known standard deviation, that differs from its expectation by `difference`.
///
/// Holds for every distribution and every N, so a lobe whose weights are almost always 1 cannot raise a
/// false alarm as it does with a normal tail; in the normal regime it costs a factor below 20 of the p-value.
pub(crate) fn ln_bernstein_two_sided(difference: f64, deviation: f64, range: f64, samples: f64) -> f64 {
    let t = difference.abs();
    if t == 0.0 {
        return 0.0;
    }
    let exponent = samples * t * t / (2.0 * (deviation * deviation + range * t / 3.0));
    (core::f64::consts::LN_2 - exponent).min(0.0)
}

/// The difference at which [`ln_bernstein_two_sided`] reaches `ln_level`.
pub(crate) fn bernstein_reach(ln_level: f64, deviation: f64, range: f64, samples: f64) -> f64 {
    let exponent = core::f64::consts::LN_2 - ln_level;
    let linear = range * exponent / (3.0 * samples);
    linear + (linear * linear + 2.0 * deviation * deviation * exponent / samples).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_gamma_tail_against_forty_digits() {
        let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference-data/golden/gamma_q.csv");
        let mut worst: f64 = 0.0;
        let mut rows = 0;
        for record in csv::Reader::from_path(table).unwrap().records() {
            let [a, x, expected] = [0, 1, 2].map(|i| record.as_ref().unwrap()[i].parse::<f64>().unwrap());
            let error = (ln_gamma_q(a, x) - expected).abs() / (1.0 + expected.abs());
            assert!(error < 1e-11, "ln Q({a}, {x}) = {} for {expected}", ln_gamma_q(a, x));
            worst = worst.max(error);
            rows += 1;
        }
        assert!(rows > 80, "{rows}");
        println!("largest error of ln Q over 1 + |ln Q|: {worst:e}");
    }

    #[test]
    fn ends_of_the_gamma_tail() {
        assert_eq!(ln_gamma_q(7.5, 0.0), 0.0);
        assert_eq!(ln_gamma_q(7.5, f64::INFINITY), f64::NEG_INFINITY);
        assert!(ln_gamma_q(7.5, f64::NAN).is_nan());
    }

    #[test]
    fn binomial_tails_are_the_sums_of_their_terms() {
        // X ~ Binomial(10, 0.3): P(X ≥ 7) = 0.010592078, P(X ≤ 0) = 0.7¹⁰.
        let upper = ln_binomial_two_sided(7, 10, 0.3, 0.3).exp();
        assert!((upper - 2.0 * 0.010_592_078_4).abs() < 1e-9, "{upper}");
        let lower = ln_binomial_two_sided(0, 10, 0.3, 0.3).exp();
        assert!((lower - 2.0 * 0.7_f64.powi(10)).abs() < 1e-12, "{lower}");
        assert_eq!(ln_binomial_two_sided(3, 10, 0.2, 0.4), 0.0);
        assert_eq!(ln_binomial_two_sided(1, 10, 0.0, 0.0), f64::NEG_INFINITY);
        assert_eq!(ln_binomial_two_sided(0, 10, 0.0, 0.0), 0.0);
        assert!(ln_binomial_two_sided(3, 10, f64::NAN, f64::NAN).is_nan());
    }

    #[test]
    fn bernstein_reaches_the_level_where_it_says() {
        for (deviation, range) in [(0.5, 1.0), (0.0, 1.0), (1e-3, 40.0)] {
            let reach = bernstein_reach(-23.0, deviation, range, 1e5);
            assert!((ln_bernstein_two_sided(reach, deviation, range, 1e5) + 23.0).abs() < 1e-9);
        }
    }

    #[test]
    fn poisson_tail_is_the_sum_of_its_terms() {
        let direct = |n: u64, mean: f64| {
            let first = (-mean).exp() * mean.powi(n as i32) / (1..=n).product::<u64>() as f64;
            (0..40).fold((first, 0.0), |(term, sum), i| (term * mean / (n + 1 + i) as f64, sum + term)).1.ln()
        };
        for (n, mean) in [(1, 9e-4), (1, 1.1e-3), (3, 2.9e-3), (3, 3.1e-3), (5, 4.0), (2, 1e-9)] {
            let (ours, expected) = (ln_poisson_upper_tail(n, mean), direct(n, mean));
            assert!((ours - expected).abs() < 1e-12 * expected.abs(), "{n} {mean}: {ours} {expected}");
        }
        // Chernoff's bound n − mean + n ln(mean / n) is off by no more than ln √(2πn) where n is far out.
        let (n, mean) = (20_000.0, 2_000.0);
        let bound = n - mean + n * libm::log(mean / n);
        let tail = ln_poisson_upper_tail(20_000, mean);
        assert!(tail < bound && tail > bound - 6.0, "{tail} {bound}");
        assert_eq!(ln_poisson_upper_tail(1, 0.0), f64::NEG_INFINITY);
        assert_eq!(ln_poisson_upper_tail(0, 0.0), 0.0);
    }
}

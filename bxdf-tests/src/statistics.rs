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

/// ln of the probability that at least one of `count` independent tests gives a p-value as small as this one (Šidák).
pub(crate) fn ln_sidak(ln_p: f64, count: usize) -> f64 {
    // Below e⁻³⁰ the square of p is lost in rounding anyway.
    if ln_p < -30.0 {
        return ln_p + (count as f64).ln();
    }
    (-libm::expm1(count as f64 * libm::log1p(-ln_p.exp()))).ln()
}

/// x at which [`ln_gamma_q`] falls to `ln_q`, for probabilities of a tail: `ln_q` < −1.
///
/// Newton's method. ln Q is concave in x for a > 1 and convex for a < 1; from its first or second step on it comes
/// closer from one side only.
pub(crate) fn gamma_q_quantile(a: f64, ln_q: f64) -> f64 {
    let mut x = if a < 1.0 { -0.25 * ln_q } else { a + 1.0 };
    for _ in 0..100 {
        let ln_tail = ln_gamma_q(a, x);
        let hazard = ((a - 1.0) * libm::log(x) - x - ln_gamma(a) - ln_tail).exp();
        let step = (ln_tail - ln_q) / hazard;
        x += step;
        if step.abs() < 1e-13 * x || !x.is_finite() {
            break;
        }
    }
    x
}

/// ln of the two-sided p-value of a mean of `samples` values in a range of width `range`, with known standard
/// deviation, that differs from its expectation by `difference`: the normal tail erfc √x with Bernstein's exponent x.
///
/// Where the mean is normally distributed, x is z²/2 and this is the normal tail. Where it is not, because
/// a lobe's weights are almost always 1, the exponent keeps rare large values from raising false alarms.
/// Bernstein's bound itself, 2 e⁻ˣ, holds for every distribution but is up to twenty times too large where it
/// matters; that factor is missing from all bounds of its kind (Talagrand, Ann. Inst. H. Poincaré B 31(4), 1995).
pub(crate) fn ln_mean_two_sided(difference: f64, deviation: f64, range: f64, samples: f64) -> f64 {
    let t = difference.abs();
    if t == 0.0 {
        return 0.0;
    }
    let exponent = samples * t * t / (2.0 * (deviation * deviation + range * t / 3.0));
    // erfc √x = Q(1/2, x)
    ln_gamma_q(0.5, exponent)
}

/// The difference at which [`ln_mean_two_sided`] reaches `ln_level`.
pub(crate) fn mean_reach(ln_level: f64, deviation: f64, range: f64, samples: f64) -> f64 {
    bernstein(gamma_q_quantile(0.5, ln_level), deviation, range, samples)
}

/// The difference at which Bernstein's exponent has the given value.
fn bernstein(exponent: f64, deviation: f64, range: f64, samples: f64) -> f64 {
    let linear = range * exponent / (3.0 * samples);
    linear + (linear * linear + 2.0 * deviation * deviation * exponent / samples).sqrt()
}

/// The difference of a mean that reaches `ln_level` with probability 0.995.
///
/// Under the alternative the standard deviation is taken to be the same.
pub(crate) fn detectable_mean(ln_level: f64, deviation: f64, range: f64, samples: f64) -> f64 {
    let missed = bernstein(0.5 * NORMAL_995 * NORMAL_995, deviation, range, samples);
    mean_reach(ln_level, deviation, range, samples) + missed
}

/// By how much a rate must exceed the one that is expected, known up to `error`, for [`ln_binomial_two_sided`] to
/// reach `ln_level` with probability 0.995. Rare events are Poisson's: there the alternative has a variance of its own.
pub(crate) fn detectable_rate(ln_level: f64, rate: f64, error: f64, samples: f64) -> f64 {
    const MANY: f64 = 100.0;
    let mean = samples * (rate + error).max(0.0);
    if mean * (1.0 - rate) > MANY || !mean.is_finite() {
        let deviation = (rate * (1.0 - rate)).sqrt();
        return 2.0 * error + detectable_mean(ln_level, deviation, 1.0, samples);
    }
    // The tail falls with the count: the first count whose tail is small enough.
    let is_enough = |count: u64| core::f64::consts::LN_2 + ln_poisson_upper_tail(count, mean) < ln_level;
    let (mut low, mut high) = (mean.ceil() as u64, mean.ceil() as u64 + 10_000);
    if !is_enough(high) {
        return f64::NAN;
    }
    while low < high {
        let middle = low.midpoint(high);
        (low, high) = if is_enough(middle) { (low, middle) } else { (middle + 1, high) };
    }
    // P(X ≥ n) = 1 − Q(n, mean)
    gamma_q_quantile(high as f64, LN_MISSED) / samples - rate + error
}

/// ln of the probability that one of the two stages misses what is called detectable; together that is 0.01.
const LN_MISSED: f64 = -5.298_317_366_548_036;

/// The noncentrality λ at which χ² of `freedom` degrees of freedom reaches `ln_level` with probability 0.995.
///
/// Noncentral χ² in Sankaran's normal approximation (Biometrika 46, 1959, 235–237); over the degrees of freedom and
/// levels used here the missed probability is right to a tenth of itself, λ to 0.2 %.
pub(crate) fn detectable_noncentrality(ln_level: f64, freedom: f64) -> f64 {
    let threshold = 2.0 * gamma_q_quantile(0.5 * freedom, ln_level);
    let missed = |lambda: f64| sankaran(threshold, freedom, lambda);
    let (mut low, mut high) = (0.0, threshold);
    while missed(high) > -NORMAL_995 {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..50 {
        let middle = 0.5 * (low + high);
        if missed(middle) > -NORMAL_995 { low = middle } else { high = middle }
    }
    high
}

/// The 0.995 quantile of the normal distribution.
const NORMAL_995: f64 = 2.575_829_303_548_901;

/// The normal deviate z with Φ(z) ≈ P(X ≤ x), X of noncentral χ² distribution (Sankaran, 1959).
fn sankaran(x: f64, freedom: f64, lambda: f64) -> f64 {
    let (mean, spread) = (freedom + lambda, freedom + 2.0 * lambda);
    let h = 1.0 - 2.0 * mean * (freedom + 3.0 * lambda) / (3.0 * spread * spread);
    let p = spread / (mean * mean);
    let m = (h - 1.0) * (1.0 - 3.0 * h);
    let expected = 1.0 + h * p * (h - 1.0 - 0.5 * (2.0 - h) * m * p);
    ((x / mean).powf(h) - expected) / (h * (2.0 * p).sqrt() * (1.0 + 0.5 * m * p))
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
    fn the_quantile_is_the_inverse_of_the_tail() {
        for a in [0.5, 1.0, 3.5, 8.0, 128.0, 2000.0] {
            for ln_q in [-1.5, -4.6, -9.2, -23.0, -300.0] {
                let back = ln_gamma_q(a, gamma_q_quantile(a, ln_q));
                assert!((back / ln_q - 1.0).abs() < 1e-11, "{a} {ln_q}: {back}");
            }
        }
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
    fn a_mean_reaches_the_level_where_it_says() {
        for (deviation, range) in [(0.5, 1.0), (0.0, 1.0), (1e-3, 40.0)] {
            let reach = mean_reach(-23.0, deviation, range, 1e5);
            assert!((ln_mean_two_sided(reach, deviation, range, 1e5) + 23.0).abs() < 1e-9);
        }
        // Two-sided normal tail: P(|Z| ≥ 2.575829) = 0.01.
        let p = ln_mean_two_sided(NORMAL_995 * 0.5 / 1e5, 0.5, 0.0, 1e10).exp();
        assert!((p - 0.01).abs() < 1e-12, "{p}");
    }

    #[test]
    fn a_mean_of_rare_events_raises_no_more_alarms_than_it_says() {
        for expected in [1e-4, 0.01, 0.3, 1.0, 4.0, 30.0, 300.0, 1e4_f64] {
            let trials = 1 << 18;
            let samples = trials as f64;
            let rate = expected / samples;
            let most = (expected + 8.0 * expected.sqrt() + 12.0) as u64;
            for count in expected.ceil() as u64..=most {
                let difference = count as f64 / samples - rate;
                let ours = ln_mean_two_sided(difference, (rate * (1.0 - rate)).sqrt(), 1.0, samples);
                let exact = ln_binomial_two_sided(count, trials, rate, rate) - core::f64::consts::LN_2;
                assert!(ours > exact, "{count} for {expected}: {ours} {exact}");
            }
        }
    }

    #[test]
    fn sidak_is_one_minus_the_power() {
        for (p, count) in [(0.3, 3), (1e-3, 7), (1e-9, 2), (1.0, 4)] {
            let direct = 1.0 - f64::powi(1.0 - p, count);
            let ours = ln_sidak(f64::ln(p), count as usize).exp();
            assert!((ours - direct).abs() < 1e-14, "{ours} {direct}");
        }
        assert_eq!(ln_sidak(-50.0, 1), -50.0);
        assert!(ln_sidak(f64::NAN, 2).is_nan());
    }

    /// ln P(X ≤ x), X of noncentral χ² distribution: central ones mixed by Poisson's weights.
    fn missed(x: f64, freedom: f64, lambda: f64) -> f64 {
        let half = 0.5 * lambda;
        let (first, last) =
            ((half - 12.0 * half.sqrt()).max(0.0) as u64, (half + 12.0 * half.sqrt() + 20.0) as u64);
        let term = |j: u64| {
            let j = j as f64;
            let weight = (j * libm::log(half) - half - ln_gamma(j + 1.0)).exp();
            weight * checked_gamma_lr(0.5 * freedom + j, 0.5 * x).unwrap()
        };
        (first..=last).map(term).sum::<f64>()
    }

    #[test]
    fn sankaran_is_close_to_noncentral_chi_square() {
        let mut worst: f64 = 0.0;
        for freedom in [7.0, 16.0, 64.0, 256.0] {
            for ln_level in [-4.6, -9.2, -15.0, -23.0] {
                let lambda = detectable_noncentrality(ln_level, freedom);
                let threshold = 2.0 * gamma_q_quantile(0.5 * freedom, ln_level);
                let missed = missed(threshold, freedom, lambda);
                worst = worst.max((missed / 0.005 - 1.0).abs());
                assert!((missed / 0.005 - 1.0).abs() < 0.1, "{freedom} {ln_level}: {missed}");
            }
        }
        println!("largest relative error of the missed probability: {worst:.3}");
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

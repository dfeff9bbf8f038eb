//! Numbers to 320 bits, for exact values.
//!
//! Arithmetic, roots, logarithms and angles are `dashu-float`'s; what it lacks is added here. A term writes its value so
//! that less than 200 of the bits cancel.

use std::sync::OnceLock;

use bxdf_tests::stability::Exact;
use dashu_float::FBig;
use dashu_float::round::mode::HalfEven;

/// A number of [`BITS`] bits.
pub(super) type Big = FBig<HalfEven, 2>;

/// Bits of the significand.
pub(super) const BITS: usize = 320;

/// The same number; 0 for what is none.
pub(super) fn big(x: f64) -> Big {
    Big::try_from(x).unwrap_or_default().with_precision(BITS).value()
}

/// The nearest double and what is left.
pub(super) fn exact(x: &Big) -> Exact {
    let nearest = x.to_f64().value();
    if !nearest.is_finite() {
        return Exact::from(nearest);
    }
    Exact { nearest, rest: (x - big(nearest)).to_f64().value() }
}

/// x².
pub(super) fn square(x: &Big) -> Big {
    x * x
}

/// π.
pub(super) fn pi() -> &'static Big {
    static PI: OnceLock<Big> = OnceLock::new();
    PI.get_or_init(|| Big::pi(BITS))
}

/// 1 / √π.
pub(super) fn frac_1_sqrt_pi() -> &'static Big {
    static FRACTION: OnceLock<Big> = OnceLock::new();
    FRACTION.get_or_init(|| big(1.0) / pi().sqrt())
}

/// e^{−x} for x ≥ 0; 0 where that is less than any precision holds.
pub(super) fn exp_minus(x: Big) -> Big {
    if x > big(1e6) { big(0.0) } else { (-x).exp() }
}

/// The complementary error function.
///
/// Up to 10 from Kummer's series of erf, whose terms are positive (DLMF 7.6.2, <https://dlmf.nist.gov/7.6>); above, from
/// the asymptotic one (DLMF 7.12.1), whose smallest term is 2⁻¹⁴⁴.
pub(super) fn erfc(x: &Big) -> Big {
    let (one, two) = (big(1.0), big(2.0));
    if *x < Big::ZERO {
        return two - erfc(&-x);
    }
    let square = square(x);
    let gaussian = (-&square).exp();
    if *x <= big(10.0) {
        let (mut term, mut sum) = (x.clone(), x.clone());
        let (twice, ends) = (&two * &square, big(SERIES_ENDS));
        for n in 1..2000 {
            term = term * &twice / big(f64::from(2 * n + 1));
            sum += &term;
            if term < ends {
                break;
            }
        }
        return one - two * gaussian * sum * frac_1_sqrt_pi();
    }
    let (mut term, mut sum) = (one.clone(), one);
    for n in 1..100 {
        term = term * big(f64::from(1 - 2 * n)) / (&two * &square);
        sum += &term;
    }
    gaussian * sum * frac_1_sqrt_pi() / x
}

/// A series is cut where its terms come to less than this: 2⁻²⁶⁰.
const SERIES_ENDS: f64 = f64::from_bits((1023 - 260) << 52);

/// How far arguments of Γ are moved up for Stirling's series.
const MOVED: u32 = 25;

/// Euler's B(p, q) for p, q ≥ 1, from Stirling's series for ln Γ of arguments moved up (DLMF 5.11.1): to 1e-42.
pub(super) fn beta(p: &Big, q: &Big) -> Big {
    let sum = p + q;
    let mut ratio = big(1.0);
    for step in 0..MOVED {
        let step = big(f64::from(step));
        ratio = ratio * (&sum + &step) / ((p + &step) * (q + &step));
    }
    let moved = big(f64::from(MOVED));
    // (p − ½) ln p − p + ½ ln 2π + …, of all three; MOVED is left over once.
    let logarithm = stirling(&(p + &moved)) + stirling(&(q + &moved)) - stirling(&(sum + &moved)) - moved;
    ratio * logarithm.exp() * (big(2.0) * pi()).sqrt()
}

/// ln Γ(x) + x − ½ ln 2π.
fn stirling(x: &Big) -> Big {
    let (inverse, mut power) = (big(1.0) / x, big(1.0) / x);
    let square = square(&inverse);
    let mut series = (x - big(0.5)) * x.ln();
    for (k, bernoulli) in bernoulli_numbers().iter().enumerate() {
        let k = 2.0 * (k + 1) as f64;
        series += bernoulli * &power / big(k * (k - 1.0));
        power *= &square;
    }
    series
}

/// B₂, B₄, … B₄₀, from Σ C(n + 1, k) B_k = 0.
fn bernoulli_numbers() -> &'static [Big] {
    static NUMBERS: OnceLock<Vec<Big>> = OnceLock::new();
    NUMBERS.get_or_init(|| {
        let mut all = vec![big(1.0)];
        for n in 1..=40_u32 {
            let mut binomial = big(1.0);
            let mut sum = big(0.0);
            for (k, number) in all.iter().enumerate() {
                sum += &binomial * number;
                binomial = binomial * big(f64::from(n + 1) - k as f64) / big(k as f64 + 1.0);
            }
            all.push(-sum / big(f64::from(n + 1)));
        }
        all.into_iter().skip(2).step_by(2).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_close(a: &Big, b: &Big) -> bool {
        let error = (a / b - big(1.0)).to_f64().value().abs();
        println!("{error:e}");
        error < 1e-40
    }

    #[test]
    fn special_functions_are_continuous_across_their_forms_and_have_their_closed_values() {
        // erfc at both sides of 10, over the derivative; Abramowitz & Stegun's erf(1) to 15 digits.
        let step = big(1e-30);
        let there = big(10.0) + &step;
        let slope = big(2.0) * frac_1_sqrt_pi() * (-square(&there)).exp();
        assert!(is_close(&erfc(&big(10.0)), &(erfc(&there) + slope * (step + big(0.0)))));
        assert_eq!((big(1.0) - erfc(&big(1.0))).to_f64().value(), 0.842_700_792_949_714_9);
        assert!(is_close(&(erfc(&big(0.7)) + erfc(&big(-0.7))), &big(2.0)));
        // B(p, 2) = 1 / p(p + 1), B(½ + 1, ½ + 1) = π/8.
        for p in [1.0, 1.25, 7.0, 1e6, 1e12] {
            assert!(is_close(&beta(&big(p), &big(2.0)), &(big(1.0) / (big(p) * big(p + 1.0)))));
        }
        assert!(is_close(&beta(&big(1.5), &big(1.5)), &(pi() / big(8.0))));
    }
}

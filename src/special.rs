//! Special functions, from kept libraries.
//!
//! | function | library | largest error measured in `f64`, in ε relative | in `f32` |
//! |---|---|---|---|
//! | erf | `libm` (a port of FreeBSD's msun) | 0.9 | 0.5 |
//! | erfc | `libm` | 1.0 | 1.2 |
//! | erf⁻¹ | `statrs` (rational approximation) | 1.0 | 0.5 |
//!
//! Measured by `bxdf-tests/tests/golden.rs` against `reference-data/golden/special.csv` (60-digit arithmetic).

use crate::real::Real;

/// Inverse error function on (−1, 1); ±∞ at ±1, NaN outside.
pub fn erf_inv(x: f64) -> f64 {
    statrs::function::erf::erf_inv(x)
}

/// Euler's Beta function B(p, q) = Γ(p) Γ(q) / Γ(p + q) for p, q ≥ 1.
///
/// # Definition
/// By Γ itself where both arguments are small. Beyond, Γ overflows and the difference of logarithms cancels, so
/// the leading terms of Stirling's series are cancelled by hand and the remainders of the series are added:
/// Fullerton's form in the SLATEC library (routine `ALBETA`).
#[inline]
pub fn beta<F: Real>(p: F, q: F) -> F {
    let (p, q) = if p <= q { (p, q) } else { (q, p) };
    let sum = p + q;
    let large = F::from_f64(10.0);
    if q < large {
        return p.gamma() * q.gamma() / sum.gamma();
    }
    let ratio = p / sum;
    let rest = (-ratio).ln_1p();
    if p < large {
        let correction = stirling_remainder(q) - stirling_remainder(sum);
        return p.gamma() * (correction + p - p * sum.ln() + (q - F::HALF) * rest).exp();
    }
    let correction = stirling_remainder(p) + stirling_remainder(q) - stirling_remainder(sum);
    let root = F::from_f64(2.506_628_274_631_000_5) / q.sqrt();
    root * (correction + (p - F::HALF) * ratio.ln() + q * rest).exp()
}

/// ln Γ(x) − [(x − ½) ln x − x + ½ ln 2π], by its asymptotic series; x ≥ 10.
#[inline]
fn stirling_remainder<F: Real>(x: F) -> F {
    let inverse = F::ONE / x;
    let square = inverse * inverse;
    // B₂ₖ / (2k (2k − 1))
    let series = [1.0 / 156.0, -691.0 / 360_360.0, 1.0 / 1188.0, -1.0 / 1680.0, 1.0 / 1260.0, -1.0 / 360.0]
        .into_iter()
        .fold(F::ZERO, |sum, coefficient| (sum + F::from_f64(coefficient)) * square);
    (series + F::from_f64(1.0 / 12.0)) * inverse
}

#[cfg(test)]
mod tests {
    use super::beta;

    #[test]
    fn beta_is_continuous_across_its_forms_and_has_its_closed_values() {
        // B(p, 1) = 1 / p, B(p, 2) = 1 / (p (p + 1)).
        for p in [1.0, 1.5, 3.0, 9.99, 10.0, 10.01, 1e3, 1e6, 1e12] {
            for (value, expected) in [(beta(p, 1.0_f64), 1.0 / p), (beta(2.0, p), 1.0 / (p * (p + 1.0)))] {
                assert!((value / expected - 1.0).abs() < 4e-14, "{p}: {value:e}");
                let single = beta(p as f32, 1.0);
                assert!((single * p as f32 - 1.0).abs() < 4e-6, "{p}: {single:e}");
            }
        }
        // B(p, q) = B(p + 1, q) + B(p, q + 1), across both seams.
        for (p, q) in [(9.5, 9.5), (3.0, 9.5), (9.5, 1e3), (40.0, 50.0), (11.0, 9.2)] {
            let (whole, parts) = (beta::<f64>(p, q), beta(p + 1.0, q) + beta(p, q + 1.0));
            assert!((whole / parts - 1.0).abs() < 1e-13, "{p} {q}: {:e}", whole / parts - 1.0);
        }
        assert_eq!(beta(1e19_f32, 1e19), 0.0);
    }
}

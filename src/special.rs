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

/// sin 2πx and cos 2πx for x ∈ \[0, 1\], to 1 ε.
///
/// The kernels of FreeBSD's msun (`k_sin.c`, `k_cos.c`) on \[−π/4, π/4\]; quadrants are selected, not branched to.
#[inline]
pub fn sin_cos_turns(x: f64) -> (f64, f64) {
    let (quadrant, angle) = quadrant_and_angle(x);
    let z = angle * angle;
    let sin = polynomial(
        z,
        [
            1.589_690_995_211_55e-10,
            -2.505_076_025_340_686_3e-8,
            2.755_731_370_707_006_8e-6,
            -1.984_126_982_985_795e-4,
            8.333_333_333_322_49e-3,
            -1.666_666_666_666_663_2e-1,
        ],
    );
    let cos = polynomial(
        z,
        [
            -1.135_964_755_778_819_5e-11,
            2.087_572_321_298_175e-9,
            -2.755_731_435_139_066_3e-7,
            2.480_158_728_947_673e-5,
            -1.388_888_888_887_411e-3,
            4.166_666_666_666_66e-2,
        ],
    );
    turned(quadrant, angle + angle * z * sin, 1.0 - (0.5 * z - z * z * cos))
}

/// [`sin_cos_turns`] to the precision of `f32`: the kernels `k_sinf.c` and `k_cosf.c`, in double precision.
#[inline]
pub fn sin_cos_turns_to_f32(x: f64) -> (f64, f64) {
    let (quadrant, angle) = quadrant_and_angle(x);
    let z = angle * angle;
    let sin = polynomial(
        z,
        [
            2.718_311_493_989_822e-6,
            -1.983_932_960_541_5e-4,
            8.333_329_385_889_463e-3,
            -0.166_666_666_416_265_24,
        ],
    );
    let cos = polynomial(
        z,
        [
            2.439_044_879_627_741_7e-5,
            -1.388_676_377_460_993e-3,
            4.166_662_332_373_906e-2,
            -0.499_999_997_251_031,
        ],
    );
    turned(quadrant, angle + angle * z * sin, 1.0 + z * cos)
}

/// The multiple of a quarter turn nearest to x, and the angle \[rad\] that is left.
#[inline]
fn quadrant_and_angle(x: f64) -> (u32, f64) {
    let quarters = (4.0 * x + 0.5) as u32;
    (quarters, (x - 0.25 * f64::from(quarters)) * core::f64::consts::TAU)
}

/// The sine and cosine of an angle that many quarter turns further on.
#[inline]
fn turned(quadrant: u32, sin: f64, cos: f64) -> (f64, f64) {
    let (sin, cos) = if quadrant & 1 == 0 { (sin, cos) } else { (cos, -sin) };
    if quadrant & 2 == 0 { (sin, cos) } else { (-sin, -cos) }
}

/// Horner's scheme, highest power first.
#[inline]
fn polynomial<const N: usize>(x: f64, coefficients: [f64; N]) -> f64 {
    coefficients.into_iter().fold(0.0, |sum, coefficient| sum * x + coefficient)
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
    use super::{beta, sin_cos_turns};
    use crate::real::Real;

    #[test]
    fn turns_are_those_of_the_library() {
        let turn = |i: u32| f64::from(i) / 40_000.0;
        for x in (0..=40_000).map(turn) {
            let (exact, found) = (libm::sincos(core::f64::consts::TAU * x), sin_cos_turns(x));
            // The library's argument is rounded; at 2π that costs 2 ε.
            assert!((exact.0 - found.0).abs() < 8e-16 && (exact.1 - found.1).abs() < 8e-16, "{x}");
            let single = (x as f32).sin_cos_turns();
            let exact = sin_cos_turns(f64::from(x as f32));
            for (found, exact) in [(single.0, exact.0), (single.1, exact.1)] {
                let error = (f64::from(found) - exact).abs();
                assert!(error <= 0.51 * f64::from(f32::EPSILON) * exact.abs(), "{x}: {found} {exact}");
            }
        }
        assert_eq!(sin_cos_turns(0.25), (1.0, 0.0));
        assert_eq!(sin_cos_turns(0.5), (0.0, -1.0));
        assert_eq!(sin_cos_turns(0.75), (-1.0, 0.0));
    }

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

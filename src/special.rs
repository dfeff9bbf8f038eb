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

macro_rules! implement_turns {
    ($name:ident, $real:ty, $whole:expr, $sin:expr, $cos:expr) => {
        /// sin 2πx and cos 2πx for x ∈ \[0, 1\], to 1 ε of 1 and, at small angles, 2 ε of the sine.
        ///
        /// Polynomials over the angle in quarter turns, on \[−½, ½\]. The quadrant's factors are looked up: a branch on
        /// a random number costs more than the polynomials.
        #[inline]
        pub fn $name(x: $real) -> ($real, $real) {
            // Sine and cosine of whole quarters, in the order that turns (sin, cos) by element-wise products.
            const QUARTERS: [[[$real; 2]; 2]; 4] = [
                [[1.0, 1.0], [0.0, 0.0]],
                [[0.0, 0.0], [1.0, -1.0]],
                [[-1.0, -1.0], [0.0, 0.0]],
                [[0.0, 0.0], [-1.0, 1.0]],
            ];
            const SIN: &[$real] = &$sin;
            const COS: &[$real] = &$cos;
            let quarters = 4.0 * x;
            // The sum has no bits for fractions: it rounds to whole quarters, which then are its lowest bits.
            let rounded = quarters + $whole;
            let angle = quarters - (rounded - $whole);
            let square = angle * angle;
            let polynomial = |sum: $real, coefficient: &$real| sum * square + coefficient;
            let sin = angle * SIN[1..].iter().fold(SIN[0], polynomial);
            let cos = COS[1..].iter().fold(COS[0], polynomial);
            let [along, across] = QUARTERS[rounded.to_bits() as usize & 3];
            (sin * along[0] + cos * across[0], cos * along[1] + sin * across[1])
        }
    };
}

// Minimax polynomials, in relative error of the sine and absolute error of the cosine: 3e-9 and 6e-8.
implement_turns!(
    sin_cos_turns_f32,
    f32,
    12_582_912.0,
    [-4.601_658e-3, 7.968_003e-2, -0.645_963_5, core::f32::consts::FRAC_PI_2],
    [-2.040_825_6e-2, 0.253_602_15, -1.233_697_9, 1.0]
);
// The kernels of FreeBSD's msun, which are over the angle in radians.
implement_turns!(
    sin_cos_turns_f64,
    f64,
    6_755_399_441_055_744.0,
    [
        5.634_704_113_884_751e-8,
        -3.598_649_570_240_692e-6,
        1.604_411_526_673_809_5e-4,
        -4.681_754_132_625_933_4e-3,
        7.969_262_624_606_334e-2,
        -0.645_964_097_506_245,
        core::f64::consts::FRAC_PI_2,
    ],
    [
        -6.324_746_678_866_07e-9,
        4.710_641_505_803_502e-7,
        -2.520_203_791_691_774e-5,
        9.192_602_743_905_533e-4,
        -2.086_348_076_333_076e-2,
        0.253_669_507_901_047_64,
        -1.233_700_550_136_169_7,
        1.0,
    ]
);

/// Euler's Beta function B(p, q) = Γ(p) Γ(q) / Γ(p + q) for p, q ≥ 1.
///
/// # Definition
/// Γ overflows and differences of its logarithms cancel, so the leading terms of Stirling's series are cancelled by
/// hand and the remainders of the series are added: Fullerton's form in the SLATEC library (routine `ALBETA`). Small
/// arguments are moved up by B(p, q) = B(p + 1, q) (p + q) / p, which costs a third of three Γ.
///
/// In double precision for single as well: a dozen roundings come to 8 ulps, as much as everything else of a weight.
#[inline]
pub fn beta<F: Real>(p: F, q: F) -> F {
    F::from_f64(beta_f64(p.to_f64(), q.to_f64()))
}

fn beta_f64(p: f64, q: f64) -> f64 {
    let (p, q) = if p <= q { (p, q) } else { (q, p) };
    let sum = p + q;
    if p >= 10.0 {
        return beta_of_large(p, q);
    }
    if q >= 10.0 {
        let correction = stirling_remainder(q) - stirling_remainder(sum);
        // A power beside the exponential: as part of its exponent, a large logarithm would cost digits.
        let exponent = correction + p + (q - 0.5) * libm::log1p(-p / sum);
        return libm::tgamma(p) * libm::pow(sum, -p) * libm::exp(exponent);
    }
    let (mut above, mut below) = (1.0, 1.0);
    for step in 0..9 {
        let step = f64::from(step);
        above *= (sum + step) * (sum + step + 9.0);
        below *= (p + step) * (q + step);
    }
    above / below * beta_of_large(p + 9.0, q + 9.0)
}

/// [`beta`] for p, q ≥ 10.
fn beta_of_large(p: f64, q: f64) -> f64 {
    let sum = p + q;
    let ratio = p / sum;
    let correction = stirling_remainder(p) + stirling_remainder(q) - stirling_remainder(sum);
    let exponent = correction + (p - 0.5) * libm::log(ratio) + q * libm::log1p(-ratio);
    2.506_628_274_631_000_5 / q.sqrt() * libm::exp(exponent)
}

/// ln Γ(x) − [(x − ½) ln x − x + ½ ln 2π], by its asymptotic series; x ≥ 10.
fn stirling_remainder(x: f64) -> f64 {
    let inverse = 1.0 / x;
    let square = inverse * inverse;
    // B₂ₖ / (2k (2k − 1))
    let series = [1.0 / 156.0, -691.0 / 360_360.0, 1.0 / 1188.0, -1.0 / 1680.0, 1.0 / 1260.0, -1.0 / 360.0]
        .into_iter()
        .fold(0.0, |sum, coefficient| (sum + coefficient) * square);
    (series + 1.0 / 12.0) * inverse
}

#[cfg(test)]
mod tests {
    use super::{beta, sin_cos_turns_f32, sin_cos_turns_f64};

    #[test]
    fn turns_are_those_of_the_library() {
        let mut worst = [0.0_f64; 2];
        for i in 0..=40_000 {
            let x = f64::from(i) / 40_000.0;
            let (exact, found) = (libm::sincos(core::f64::consts::TAU * x), sin_cos_turns_f64(x));
            // The library's argument is rounded; at 2π that costs 2 ε.
            worst[0] = worst[0].max((exact.0 - found.0).abs()).max((exact.1 - found.1).abs());
            let single = sin_cos_turns_f32(x as f32);
            let exact = sin_cos_turns_f64(f64::from(x as f32));
            let error = (f64::from(single.0) - exact.0).abs().max((f64::from(single.1) - exact.1).abs());
            worst[1] = worst[1].max(error);
        }
        println!("largest errors {worst:?}");
        assert!(worst[0] < 4.0 * f64::EPSILON && worst[1] < f64::from(f32::EPSILON));
        assert_eq!(sin_cos_turns_f64(0.25), (1.0, 0.0));
        assert_eq!(sin_cos_turns_f32(0.5), (0.0, -1.0));
        assert_eq!(sin_cos_turns_f64(0.75), (-1.0, 0.0));
    }

    #[test]
    fn beta_is_continuous_across_its_forms_and_has_its_closed_values() {
        // B(p, 1) = 1 / p, B(p, 2) = 1 / (p (p + 1)).
        for p in [1.0, 1.5, 3.0, 9.99, 10.0, 10.01, 1e3, 1e6, 1e12] {
            for (value, expected) in [(beta(p, 1.0_f64), 1.0 / p), (beta(2.0, p), 1.0 / (p * (p + 1.0)))] {
                assert!((value / expected - 1.0).abs() < 4e-14, "{p}: {value:e}");
                let single = beta(p as f32, 1.0);
                assert!((single * p as f32 - 1.0).abs() < 2e-7, "{p}: {single:e}");
            }
        }
        // B(p, q) = B(p + 1, q) + B(p, q + 1), across both seams.
        for (p, q) in [(9.5, 9.5), (3.0, 9.5), (9.5, 1e3), (40.0, 50.0), (11.0, 9.2)] {
            let (whole, parts) = (beta::<f64>(p, q), beta(p + 1.0, q) + beta(p, q + 1.0));
            assert!((whole / parts - 1.0).abs() < 1e-13, "{p} {q}: {:e}", whole / parts - 1.0);
        }
        assert_eq!(beta(1e19_f32, 1e19), 0.0);
        // Where rounding is seen as light: the weight of a crossing next to the tangent plane is q B(1, q).
        for exponent in 0..300 {
            let q = libm::pow(10.0, f64::from(exponent));
            let error = (q * beta(1.0, q) - 1.0) / f64::EPSILON;
            assert!(error.abs() <= 8.0, "{q:e}: {error} ε");
        }
    }
}

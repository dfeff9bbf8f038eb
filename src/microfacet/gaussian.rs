//! Gaussian angles: Cook & Torrance, *ACM TOG* 1(1), 1982, <https://doi.org/10.1145/357290.357293>, with the
//! constant that makes ∫ D cos θ = 1, which they leave free.

use core::f64::consts::{FRAC_PI_2, TAU};

use crate::frame::sin2_theta;
use crate::quadrature::panels;
use crate::real::{Real, Vector};

/// θ / sin θ, 1 at the pole.
#[inline]
fn angle_over_sine<F: Real>(sin2: F, z: F) -> F {
    let sine = sin2.sqrt();
    if sine > F::ZERO { sine.atan2(z) / sine } else { F::ONE }
}

/// D(m) / D(n) = exp(−((θx/αx)² + (θy/αy)²)), where (θx, θy) is the angle θ in the direction of m; `stretched` is
/// (m.x/αx)² + (m.y/αy)², for a unit vector.
#[inline(never)]
pub(crate) fn density<F: Real>(stretched: F, sin2: F, z: F) -> F {
    (-stretched * angle_over_sine(sin2, z).squared()).exp()
}

/// Density \[sr⁻¹\] of [`normal_at`] for Gaussian (θx, θy): a Gaussian over the plane of angles.
#[inline]
pub(super) fn sampling_pdf<F: Real>(m: F::Vec3, alpha_x: F, alpha_y: F) -> F {
    let (x, y) = (m.x() / alpha_x, m.y() / alpha_y);
    let ratio = angle_over_sine(sin2_theta::<F>(m), m.z());
    (-(x * x + y * y) * ratio.squared()).exp() * ratio / (F::PI * alpha_x * alpha_y)
}

/// The normal at the angles (x, y) \[rad\] along the tangents; `None` below the horizon.
#[inline]
pub(super) fn normal_at<F: Real>(x: F, y: F) -> Option<F::Vec3> {
    let theta = (x * x + y * y).sqrt();
    let (sine, cosine) = theta.sin_cos();
    let scale = if theta > F::ZERO { sine / theta } else { F::ONE };
    let is_above = theta < F::HALF * F::PI && cosine > F::ZERO;
    is_above.then(|| F::Vec3::new(x * scale, y * scale, cosine))
}

/// D(n) that makes ∫ D cos θ dω = 1: 1 / ∫∫ exp(−r²) cos θ (sin θ / θ) αx αy r dr dψ over θ < π/2, with
/// (θx, θy) = r (αx cos ψ, αy sin ψ).
///
/// Each quarter of ψ and each radius is integrated by Gauss–Legendre panels; beyond r = 6.5 the rest is below
/// 1e-18.
pub(super) fn normalization(alpha_x: f64, alpha_y: f64) -> f64 {
    let quarter = panels(0.0, 0.25 * TAU, 8, &|psi| {
        let (sin, cos) = libm::sincos(psi);
        let alpha = libm::hypot(alpha_x * cos, alpha_y * sin);
        panels(0.0, (FRAC_PI_2 / alpha).min(6.5), 8, &|r| {
            let theta = r * alpha;
            let sinc = if theta > 0.0 { libm::sin(theta) / theta } else { 1.0 };
            libm::exp(-r * r) * libm::cos(theta) * sinc * r
        })
    });
    1.0 / (4.0 * quarter * alpha_x * alpha_y)
}

#[cfg(test)]
mod tests {
    use super::normalization;

    #[test]
    fn val_normalization_is_that_of_an_independent_quadrature() {
        for (alpha, expected) in [
            (0.05, 127.536_302_6),
            (0.1, 32.043_761_63),
            (0.2, 8.172_225_859),
            (0.3, 3.754_119_178),
            (0.5, 1.499_914_018),
            (1.0, 0.581_188_447),
        ] {
            let error = normalization(alpha, alpha) / expected - 1.0;
            assert!(error.abs() < 1e-9, "{alpha}: {error:e}");
        }
    }
}

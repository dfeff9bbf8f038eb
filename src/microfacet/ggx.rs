//! Trowbridge–Reitz ("GGX"): Walter et al., EGSR 2007, <https://doi.org/10.2312/EGWR/EGSR07/195-206>.

use crate::real::{Real, Vector};

/// π αx αy D(m), with `stretched` = (m.x/αx)² + (m.y/αy)² and |m|²: (|m|² / (stretched + m.z²))².
#[inline]
pub(super) fn density<F: Real>(stretched: F, z: F, length_squared: F) -> F {
    (length_squared / (stretched + z * z)).squared()
}

/// σ = ½ (z + √(z² + s²)); below the horizon the same without cancellation.
#[inline]
pub(super) fn projected_area<F: Real>(z: F, s_squared: F) -> F {
    let root = two_sided_area(z, s_squared);
    if z >= F::ZERO { F::HALF * (z + root) } else { F::HALF * s_squared / (root - z) }
}

/// σ(w) + σ(−w) = √(z² + s²): the length of the stretched direction, which the sampler needs too; written once, so that
/// it is computed once.
#[inline]
pub(super) fn two_sided_area<F: Real>(z: F, s_squared: F) -> F {
    (s_squared + z * z).sqrt()
}

/// Λ = ½ t / (1 + √(1 + t)), t = s²/z²; ½ (√(1 + t) − 1) cancels at normal incidence.
#[inline]
pub(super) fn lambda<F: Real>(z: F, s_squared: F) -> F {
    let t = s_squared / (z * z);
    F::HALF * t / (F::ONE + (F::ONE + t).sqrt())
}

/// Visible normals for roughness 1 seen along `s`, a direction of any length, and themselves of any length: the sum of
/// ŝ and a uniform direction in the cap above −ŝ.z, times |s|.
///
/// Dupuy & Benyoub, *Computer Graphics Forum* 42(8), 2023, <https://doi.org/10.1111/cgf.14867>. Scaled so that nothing
/// is divided: |s| + s.z is twice the projected area, and the sum's height is (1 − u₀) of it.
#[inline(always)]
pub(crate) fn sample_visible_unit<F: Real>(s: F::Vec3, [u0, u1]: [F; 2]) -> F::Vec3 {
    let horizontal = s.x() * s.x() + s.y() * s.y();
    let length = two_sided_area(s.z(), horizontal);
    let height = if s.z() >= F::ZERO { length + s.z() } else { horizontal / (length - s.z()) };
    let below = u0 * height;
    let radius = (below * (length + length - below)).sqrt();
    let (sin_phi, cos_phi) = u1.sin_cos_turns();
    F::Vec3::new(radius * cos_phi + s.x(), radius * sin_phi + s.y(), (F::ONE - u0) * height)
}

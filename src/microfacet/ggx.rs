//! Trowbridge–Reitz ("GGX"): Walter et al., EGSR 2007, <https://doi.org/10.2312/EGWR/EGSR07/195-206>.

use crate::real::{Real, Vector};
use crate::warp::uniform_cap;

/// π αx αy D(m), with `stretched` = (m.x/αx)² + (m.y/αy)²: 1 / (stretched + m.z²)².
#[inline]
pub(super) fn density<F: Real>(stretched: F, z: F) -> F {
    F::ONE / (stretched + z * z).squared()
}

/// σ = ½ (z + √(z² + s²)); below the horizon the same without cancellation.
#[inline]
pub(super) fn projected_area<F: Real>(z: F, s_squared: F) -> F {
    let root = (z * z + s_squared).sqrt();
    if z >= F::ZERO { F::HALF * (z + root) } else { F::HALF * s_squared / (root - z) }
}

/// Λ = ½ t / (1 + √(1 + t)), t = s²/z²; ½ (√(1 + t) − 1) cancels at normal incidence.
#[inline]
pub(super) fn lambda<F: Real>(z: F, s_squared: F) -> F {
    let t = s_squared / (z * z);
    F::HALF * t / (F::ONE + (F::ONE + t).sqrt())
}

/// Visible normals of the unit hemisphere (roughness 1) seen from the unit vector `w`, not of unit length:
/// the sum of `w` and a uniform direction in the cap above −w.z.
///
/// Dupuy & Benyoub, *Computer Graphics Forum* 42(8), 2023, <https://doi.org/10.1111/cgf.14867>.
#[inline]
pub(super) fn sample_visible_unit<F: Real>(w: F::Vec3, [u0, u1]: [F; 2]) -> F::Vec3 {
    let height =
        if w.z() >= F::ZERO { F::ONE + w.z() } else { (w.x() * w.x() + w.y() * w.y()) / (F::ONE - w.z()) };
    let m = uniform_cap([u0, u1], height) + w;
    F::Vec3::new(m.x(), m.y(), m.z().max(F::ZERO))
}

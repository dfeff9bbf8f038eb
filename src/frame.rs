//! The local shading frame: the normal is +z, directions have unit length and leave the surface.

use crate::real::{Real, Vector};

/// `true` if both directions lie on the same side of the surface; a direction in the tangent plane
/// (|cos θ| ≤ [`Real::TANGENT`]) is on neither.
///
/// Signs are compared, not multiplied: the product of two grazing cosines underflows.
#[inline]
pub fn same_side<F: Real>(a: F::Vec3, b: F::Vec3) -> bool {
    (is_above::<F>(a) && is_above::<F>(b)) || (is_above::<F>(-a) && is_above::<F>(-b))
}

/// `true` if `w` lies above the surface and not in its tangent plane.
#[inline]
pub fn is_above<F: Real>(w: F::Vec3) -> bool {
    w.z() > F::TANGENT
}

/// `w` mirrored about the normal.
#[inline]
pub fn mirror<F: Real>(w: F::Vec3) -> F::Vec3 {
    F::Vec3::new(-w.x(), -w.y(), w.z())
}

/// `w` mirrored about the unit vector `m`: 2 (w·m) m − w.
#[inline]
pub fn reflect<F: Real>(w: F::Vec3, m: F::Vec3) -> F::Vec3 {
    m * (F::TWO * w.dot(m)) - w
}

/// `w`, of unit length but for rounding, with that rounding mended: a step of Newton's for 1 / |w|, which needs no root and
/// no division.
#[inline]
pub fn renormalize<F: Real>(w: F::Vec3) -> F::Vec3 {
    w * (F::from_f64(1.5) - F::HALF * w.dot(w))
}

/// `w` with its components along the tangents scaled by `alpha_x` and `alpha_y`; not of unit length.
#[inline]
pub fn stretch<F: Real>(w: F::Vec3, alpha_x: F, alpha_y: F) -> F::Vec3 {
    F::Vec3::new(alpha_x * w.x(), alpha_y * w.y(), w.z())
}

/// sin²θ of the angle between `w` and the normal, free of cancellation at normal incidence.
#[inline]
pub fn sin2_theta<F: Real>(w: F::Vec3) -> F {
    w.x() * w.x() + w.y() * w.y()
}

/// sin² of the angle between two unit vectors, free of cancellation where they are close.
#[inline]
pub fn sin2_between<F: Real>(a: F::Vec3, b: F::Vec3) -> F {
    let cross = F::Vec3::new(
        a.y() * b.z() - a.z() * b.y(),
        a.z() * b.x() - a.x() * b.z(),
        a.x() * b.y() - a.y() * b.x(),
    );
    cross.dot(cross)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn grazing_directions_are_on_the_same_side_although_the_product_of_cosines_underflows() {
        let grazing = glam::Vec3::new(1.0, 0.0, 2.0 * f32::TANGENT);
        assert!(same_side::<f32>(grazing, grazing));
        assert!(!same_side::<f32>(grazing, -grazing));
        assert!(!same_side::<f32>(grazing, glam::Vec3::X));
        assert_eq!(f32::TANGENT, 2.0_f32.powi(-52));
        assert_eq!(f64::TANGENT, 2.0_f64.powi(-500));
    }

    #[test]
    fn mirroring_about_the_normal_is_reflection_about_z() {
        let w = DVec3::new(0.3, -0.4, 0.5).normalize();
        assert!((mirror::<f64>(w) - reflect::<f64>(w, DVec3::Z)).length() < 1e-16);
    }
}

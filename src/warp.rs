//! Maps from the unit square to directions, each beside its density.

use crate::real::{Real, Vector};

/// Maps the unit square to the hemisphere about +z with density cos θ / π.
///
/// z is √(1 − u₀), not √(1 − x² − y²): the latter cancels at grazing angles.
#[inline]
pub fn cosine_hemisphere<F: Real>([u0, u1]: [F; 2]) -> F::Vec3 {
    let radius = u0.sqrt();
    let (sin_phi, cos_phi) = u1.sin_cos_turns();
    F::Vec3::new(radius * cos_phi, radius * sin_phi, (F::ONE - u0).sqrt())
}

/// Density \[sr⁻¹\] of [`cosine_hemisphere`] at a direction with the given cosine; 0 below the horizon.
#[inline]
pub fn cosine_hemisphere_pdf<F: Real>(cos_theta: F) -> F {
    if cos_theta > F::ZERO { cos_theta / F::PI } else { F::ZERO }
}

/// Maps the unit square uniformly to the cap of the unit sphere of the given height about +z.
///
/// `height` = 2 is the sphere, 1 the hemisphere. The sine of the polar angle is √(q (2 − q)) with
/// q = 1 − z, because √(1 − z²) has a relative error of 5e-2 in `f32` near the pole.
#[inline]
pub fn uniform_cap<F: Real>([u0, u1]: [F; 2], height: F) -> F::Vec3 {
    let q = u0 * height;
    let sin_theta = (q * (F::TWO - q)).sqrt();
    let (sin_phi, cos_phi) = u1.sin_cos_turns();
    F::Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, F::ONE - q)
}

/// Density \[sr⁻¹\] of [`uniform_cap`] inside the cap: 1 / (2π height).
#[inline]
pub fn uniform_cap_pdf<F: Real>(height: F) -> F {
    F::ONE / (F::TWO * F::PI * height)
}

/// Maps the unit square to the sphere with density (p + 1)/4π ((1 + cos θ)/2)ᵖ about +z.
///
/// 1 − cos θ is 2m with m = 1 − u₀^(1/(p + 1)), which keeps its digits near the pole.
#[inline]
pub fn power_lobe<F: Real>([u0, u1]: [F; 2], exponent: u32) -> F::Vec3 {
    let m = -(u0.ln() / F::from_f64(f64::from(exponent) + 1.0)).exp_m1();
    let sin_theta = F::TWO * (m * (F::ONE - m)).sqrt();
    let (sin_phi, cos_phi) = u1.sin_cos_turns();
    F::Vec3::new(sin_theta * cos_phi, sin_theta * sin_phi, F::ONE - F::TWO * m)
}

/// Density \[sr⁻¹\] of [`power_lobe`] where ((1 + cos θ)/2)ᵖ has the given value.
#[inline]
pub fn power_lobe_pdf<F: Real>(power: F, exponent: u32) -> F {
    F::from_f64(f64::from(exponent) + 1.0) / (F::FOUR * F::PI) * power
}

/// `w`, given about +z, turned to lie about the unit vector `axis` (Duff et al., JCGT 6(1), 2017).
#[inline]
pub fn about<F: Real>(axis: F::Vec3, w: F::Vec3) -> F::Vec3 {
    let (x, y, z) = (axis.x(), axis.y(), axis.z());
    let sign = F::ONE.copysign(z);
    let a = -F::ONE / (sign + z);
    let b = x * y * a;
    let first = F::Vec3::new(F::ONE + sign * x * x * a, sign * b, -sign * x);
    let second = F::Vec3::new(b, sign + y * y * a, -y);
    first * w.x() + second * w.y() + axis * w.z()
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    /// Density of a map of the unit square at `u`: 1 / |∂w/∂u₀ × ∂w/∂u₁|, by central differences.
    fn density(map: impl Fn([f64; 2]) -> glam::DVec3, u: [f64; 2]) -> f64 {
        let h = 1e-5;
        let du0 = (map([u[0] + h, u[1]]) - map([u[0] - h, u[1]])) / (2.0 * h);
        let du1 = (map([u[0], u[1] + h]) - map([u[0], u[1] - h])) / (2.0 * h);
        1.0 / du0.cross(du1).length()
    }

    #[test]
    fn densities_are_the_jacobians_of_the_maps() {
        for i in 1..10 {
            for j in 1..10 {
                let u = [f64::from(i) / 10.0, f64::from(j) / 10.0];
                let cosine = density(cosine_hemisphere::<f64>, u);
                let z = cosine_hemisphere::<f64>(u).z;
                assert_relative_eq!(cosine, cosine_hemisphere_pdf(z), max_relative = 1e-7);
                for height in [0.01, 1.0, 1.7, 2.0] {
                    let cap = density(|u| uniform_cap(u, height), u);
                    assert_relative_eq!(cap, uniform_cap_pdf(height), max_relative = 1e-7);
                }
                for exponent in [1, 4, 16] {
                    let lobe = density(|u| power_lobe(u, exponent), u);
                    let power = (0.5 * (1.0 + power_lobe::<f64>(u, exponent).z)).powi(exponent as i32);
                    assert_relative_eq!(lobe, power_lobe_pdf(power, exponent), max_relative = 1e-7);
                }
            }
        }
    }

    #[test]
    fn turning_about_an_axis_keeps_lengths_and_the_angle_to_it() {
        let w = glam::DVec3::new(0.48, -0.6, 0.64);
        for axis in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.6, 0.0, -0.8], [-0.48, 0.64, 0.6], [1.0, 0.0, 0.0]]
        {
            let axis = glam::DVec3::from_array(axis);
            let turned = about::<f64>(axis, w);
            assert!(
                (turned.length() - 1.0).abs() < 4e-16 && (turned.dot(axis) - w.z).abs() < 4e-16,
                "{axis}"
            );
        }
    }

    #[test]
    fn extreme_uniforms_give_unit_vectors_off_the_horizon() {
        let largest = 1.0 - f32::EPSILON / 2.0;
        for u0 in [0.0, f32::MIN_POSITIVE, 0.5, largest] {
            for u1 in [0.0, 0.25, largest] {
                let w = cosine_hemisphere([u0, u1]);
                assert!(w.z > 0.0 && (w.length() - 1.0).abs() < 3e-7, "{w}");
                assert!((uniform_cap([u0, u1], 2.0f32).length() - 1.0).abs() < 3e-7);
                assert!((power_lobe::<f32>([u0, u1], 16).length() - 1.0).abs() < 3e-7);
            }
        }
    }
}

//! Beckmann–Spizzichino: Gaussian slopes; Walter et al., EGSR 2007,
//! <https://doi.org/10.2312/EGWR/EGSR07/195-206>.

use crate::real::{Real, Vector};

/// π αx αy D(m), with `stretched` = (m.x/αx)² + (m.y/αy)² and |m|²: exp(−stretched / m.z²) |m|⁴ / m.z⁴.
#[inline]
pub(super) fn density<F: Real>(stretched: F, z: F, length_squared: F) -> F {
    let z2 = z * z;
    let exponential = (-stretched / z2).exp();
    // Where it underflows the other factor may overflow, and 0 · ∞ would be NaN.
    if exponential > F::ZERO { exponential * (length_squared / z2).squared() } else { F::ZERO }
}

/// σ = ½ [z erfc(−z/s) + s e^{−z²/s²} / √π]; max(z, 0) where s = 0.
#[inline]
pub(super) fn projected_area<F: Real>(z: F, s_squared: F) -> F {
    let s = s_squared.sqrt();
    let a = z / s;
    // From here on erfc(−a) = 2 and the other term is below half a unit in the last place of z, also where s = 0.
    if a >= F::from_f64(6.0) {
        return z;
    }
    if !a.is_finite() {
        return F::ZERO;
    }
    F::HALF * (z * (-a).erfc() + s * (-a * a).exp() * frac_1_sqrt_pi())
}

/// Λ = ½ (e^{−a²} / (a √π) − erfc a), a = z/s.
#[inline]
pub(super) fn lambda<F: Real>(z: F, s_squared: F) -> F {
    let a = z / s_squared.sqrt();
    if !a.is_finite() {
        return F::ZERO;
    }
    F::HALF * ((-a * a).exp() * frac_1_sqrt_pi() / a - a.erfc())
}

fn frac_1_sqrt_pi<F: Real>() -> F {
    F::from_f64(0.564_189_583_547_756_3)
}

/// Visible normals for roughness 1 seen from the unit vector `w`, with z = 1.
///
/// The slope along `w` has density ∝ (cot θ − s) e^{−s²} on (−∞, cot θ\]; its integral is inverted by
/// Newton steps inside a bracket that halves whenever a step would leave it. The slope across is Gaussian.
/// Heitz & d'Eon 2014 give the densities, <https://doi.org/10.1111/cgf.12417>; the inversion is our own,
/// because theirs stops after three steps from a fitted start.
#[inline]
pub(super) fn sample_visible_unit<F: Real>(w: F::Vec3, [u0, u1]: [F; 2]) -> F::Vec3 {
    VisibleNormals::<F>::new(w, u0).at(u1)
}

/// The steepness of a Gaussian slope, √(−ln(1 − u)) with the digits of small u.
#[inline]
pub(crate) fn slope_along_normal<F: Real>(u: F) -> F {
    (-(-u).ln_1p()).sqrt()
}

/// [`sample_visible_unit`] of one first uniform, on which the costly part depends alone.
pub(super) enum VisibleNormals<F> {
    /// Seen along the normal all slopes are visible, an isotropic Gaussian: the steepness.
    AlongNormal(F),
    /// The slope along the direction seen from, and cosine and sine of that direction's azimuth.
    Oblique(F, [F; 2]),
}

impl<F: Real> VisibleNormals<F> {
    #[inline]
    pub(super) fn new(w: F::Vec3, u0: F) -> Self {
        let sin_theta = (w.x() * w.x() + w.y() * w.y()).sqrt();
        // Below, the slant changes the density by less than its rounding.
        if sin_theta < F::EPSILON {
            return Self::AlongNormal(slope_along_normal(u0));
        }
        Self::Oblique(invert_slope(w.z() / sin_theta, u0), [w.x() / sin_theta, w.y() / sin_theta])
    }

    #[inline]
    pub(super) fn at(&self, u1: F) -> F::Vec3 {
        match *self {
            Self::AlongNormal(radius) => {
                let (sin_phi, cos_phi) = u1.sin_cos_turns();
                F::Vec3::new(radius * cos_phi, radius * sin_phi, F::ONE)
            }
            Self::Oblique(along, [cos_phi, sin_phi]) => {
                // erf⁻¹ is infinite at ±1, which the uniform reaches at 0.
                let across = (F::TWO * u1 - F::ONE).max(F::HALF * F::EPSILON - F::ONE).erf_inv();
                let (x, y) = (cos_phi * along - sin_phi * across, sin_phi * along + cos_phi * across);
                F::Vec3::new(-x, -y, F::ONE)
            }
        }
    }
}

/// The slope s ≤ c with I(s) = u I(c), where I(s) = ½ [c erfc(−s) + e^{−s²} / √π].
#[inline]
pub(crate) fn invert_slope<F: Real>(c: F, u: F) -> F {
    slope_and_steps(c, u).0
}

/// [`invert_slope`] with the number of its steps: two on average, and no extreme is known that takes more than twenty.
#[inline]
fn slope_and_steps<F: Real>(c: F, u: F) -> (F, u32) {
    // I and its derivative (c − s) e^{−s²} / √π share the exponential.
    let integral = |s: F| {
        let gaussian = (-s * s).exp() * frac_1_sqrt_pi();
        (F::HALF * (c * (-s).erfc() + gaussian), (c - s) * gaussian)
    };
    // Beyond ±7 the density is below the rounding of its integral in double precision.
    let (mut low, mut high) = (-F::from_f64(7.0), c.min(F::from_f64(7.0)));
    let whole = integral(high).0;
    let (target, rest) = (u * whole, (F::ONE - u) * whole);
    if u < F::from_f64(1e-20) && target <= integral(low).0 {
        return (low, 0);
    }
    let mut s = guess_slope(c, u).max(low).min(high);
    let is_near_end = u > F::from_f64(0.9);
    if is_near_end {
        // I ends like a parabola, because I′ is 0 at c: no slope is left of the one that is steepest there.
        let end = c - (F::TWO * rest / ((-c * c).exp() * frac_1_sqrt_pi())).sqrt();
        if end > low {
            s = if s < high { s.max(end) } else { end };
        }
    }
    let most = 64;
    for steps in 1..=most {
        let (value, derivative) = integral(s);
        let excess = value - target;
        if excess.abs() <= F::TWO * F::EPSILON * target {
            // What is left is rounding, and where I is flat steps would follow it to and fro.
            return (s, steps);
        }
        if excess > F::ZERO {
            high = s;
        } else {
            low = s;
        }
        // Newton's step towards the target; of logarithms where I or what it lacks falls like a Gaussian's tail, and of
        // roots where a logarithm would leave the domain.
        let newton = if is_near_end {
            let missing = whole - value;
            let step = missing / derivative * (missing / rest).ln();
            if s + step < high {
                s + step
            } else {
                s + F::TWO / derivative * (missing - (missing * rest).sqrt())
            }
        } else if value > F::TWO * target {
            s - value / derivative * (value / target).ln()
        } else {
            s - excess / derivative
        };
        // Outside of what is known of the slope, and NaN, is answered by halving that.
        let next = if newton >= low && newton <= high { newton } else { F::HALF * (low + high) };
        let step = next - s;
        s = next;
        // The error after a Newton step is about its square over the distance to c, where I′ vanishes.
        if step * step <= F::HALF * F::EPSILON * (c - s).min(F::ONE) || high - low <= F::EPSILON {
            return (s, steps);
        }
    }
    (s, most)
}

/// A first guess of the slope: I is c times a Gaussian integral, inverted by Winitzki's formula, plus a Rayleigh
/// integral; the two inverses are averaged in these proportions.
pub(crate) fn guess_slope<F: Real>(c: F, u: F) -> F {
    let tiny = F::EPSILON * F::EPSILON;
    let rayleigh = -(-u.max(tiny).ln()).sqrt();
    let a = F::from_f64(4.33); // 2 / (π · 0.147)
    let log = (F::FOUR * u * (F::ONE - u)).max(tiny).ln();
    let t = a + F::HALF * log;
    let gaussian = ((t * t - log / F::from_f64(0.147)).sqrt() - t).sqrt().copysign(u - F::HALF);
    let share = F::from_f64(0.282); // 1 / (2 √π)
    (c * gaussian + share * rayleigh) / (c + share)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverted_slopes_satisfy_their_equation() {
        let integral =
            |c: f64, s: f64| 0.5 * (c * libm::erfc(-s) + libm::exp(-s * s) * 0.564_189_583_547_756_3);
        // To the largest cotangent that is inverted.
        for i in 0..140 {
            let c = libm::exp(f64::from(i) / 3.0 - 10.0);
            for j in 0..=1000 {
                let u = (f64::from(j) / 1000.0).min(1.0 - f64::EPSILON / 2.0);
                let s = invert_slope(c, u);
                let end = c.min(7.0);
                assert!(s <= end && s >= -7.0, "c {c} u {u} s {s}");
                let error = (integral(c, s) / integral(c, end) - u).abs();
                assert!(error <= 1e-14, "c {c} u {u} s {s}: {error:e}");
                let single = invert_slope(c as f32, u as f32);
                assert!(single.is_finite() && single <= c as f32);
            }
        }
    }

    /// Steps of the slowest inversion over cotangents and uniforms down to the smallest numbers and up to the last below 1.
    fn most_steps<F: Real>(smallest: f64) -> (u32, [f64; 2]) {
        let below_one = 1.0 - 0.5 * F::EPSILON.to_f64();
        let mut uniforms = vec![0.0, smallest, below_one];
        uniforms.extend((1..1000).map(|i| f64::from(i) / 1000.0));
        for i in 1..640 {
            let near = libm::pow(10.0, -f64::from(i) / 40.0);
            uniforms.extend([near, near.powi(20), (1.0 - near).min(below_one)]);
        }
        let mut worst = (0, [0.0; 2]);
        // From the smallest number to the largest cotangent that is inverted.
        let cotangents = (0..400).map(|i| libm::pow(10.0, -20.0 + f64::from(i) / 11.0));
        for c in cotangents.chain([smallest, 1e-100]).filter(|&c| c * F::EPSILON.to_f64() < 1.0) {
            for &u in &uniforms {
                let (slope, steps) = slope_and_steps(F::from_f64(c), F::from_f64(u));
                assert!(slope.is_finite(), "c {c:e} u {u:e}");
                if steps > worst.0 {
                    worst = (steps, [c, u]);
                }
            }
        }
        worst
    }

    #[test]
    fn the_steps_of_an_inversion_are_bounded_over_its_extremes() {
        let single = most_steps::<f32>(f32::from_bits(1).into());
        let double = most_steps::<f64>(f64::from_bits(1));
        println!("most steps, with c and u: {single:?} {double:?}");
        assert!(single.0 <= 16 && double.0 <= 20, "{single:?} {double:?}");
    }
}

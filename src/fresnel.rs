//! Fresnel reflectance: the exact forms, and each approximation beside its exact form.
//!
//! Angles enter as `cos_theta_i` ∈ \[0, 1\] on the side that light comes from. Indices are relative: `eta`
//! (and `eta + i k` for conductors) is the index of the medium entered divided by the index of the medium
//! left. Forms are chosen so that nothing cancels: R and 1 − R are each accurate relative to their own size.
//!
//! The thesis prints the dielectric amplitudes without their squares (its equations 9 and 10) and offers an
//! approximation for conductors (7 and 8, here [`conductor_thesis`]); this module squares the amplitudes and
//! adds total internal reflection.

use crate::parameter::{OutOfRange, require, require_fractions};
use crate::real::Real;
use crate::rgb::Rgb;

/// A quantity for light polarised perpendicular (`s`) and parallel (`p`) to the plane of incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarized<F> {
    /// Electric field perpendicular to the plane of incidence.
    pub s: F,
    /// Electric field in the plane of incidence.
    pub p: F,
}

impl<F: Real> Polarized<F> {
    /// The mean over both polarisations: the value for unpolarised light.
    #[inline]
    pub fn unpolarized(self) -> F {
        F::HALF * (self.s + self.p)
    }
}

/// What happens to light at the boundary of two dielectrics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DielectricBoundary<F> {
    /// Fraction reflected, \[0, 1\] to rounding.
    pub reflectance: Polarized<F>,
    /// Fraction transmitted, 1 − R but computed without the subtraction.
    pub transmittance: Polarized<F>,
    /// Cosine of the refracted direction; 0 under total internal reflection.
    pub cos_theta_t: F,
}

/// Exact Fresnel equations between two dielectrics.
///
/// # Definition
/// With A = (η − 1)(η + 1), c = cos θi and g = η cos θt = √(A + c²):
/// r_s = −A / (c + g)², r_p = r_s (c g − sin²θi) / (c g + sin²θi), R = r²;
/// T_s = 4 c g / (c + g)², T_p = 4 η² c g / (η² c + g)².
/// Algebraically equal to Born & Wolf, *Principles of Optics* §1.5.2, (20) and (21); the textbook form loses
/// 7e-5 of R in `f32` at η = 1.001.
///
/// # Limits
/// A + c² ≤ 0 is total internal reflection: R = 1. At η = 1, R = 0 for every angle. At grazing incidence
/// T → 0 linearly in c.
///
/// ```
/// let boundary = gonio::fresnel::dielectric(1.0_f64, 1.5);
/// assert!((boundary.reflectance.unpolarized() - 0.04).abs() < 1e-15);
/// ```
#[inline]
pub fn dielectric<F: Real>(cos_theta_i: F, eta: F) -> DielectricBoundary<F> {
    dielectric_from(cos_theta_i, (F::ONE - cos_theta_i) * (F::ONE + cos_theta_i), eta, true)
}

/// [`dielectric`] from either side of a boundary, where sin²θi is known besides; `eta` is the index below over that above
/// from both sides.
///
/// A cosine near 1 does not have the digits of the sine, which into a much rarer medium decides everything: at η = 1e-3
/// the critical angle is at cos θ = 1 − 5e-7. And 1/η does not have the digits of η − 1: between nearly matched media what
/// has come in would not get out again.
#[inline]
pub(crate) fn dielectric_from<F: Real>(c: F, sin2: F, eta: F, from_above: bool) -> DielectricBoundary<F> {
    let bend = (eta - F::ONE) * (eta + F::ONE);
    let (eta, a) = if from_above { (eta, bend) } else { (F::ONE / eta, -bend / (eta * eta)) };
    let g_squared = squared_normal_component(c, sin2, eta, a);
    if g_squared <= F::ZERO {
        let (all, none) = (Polarized { s: F::ONE, p: F::ONE }, Polarized { s: F::ZERO, p: F::ZERO });
        // Index-matched media at exact grazing: nothing is reflected at any angle, so neither here.
        let (reflectance, transmittance) = if a == F::ZERO { (none, all) } else { (all, none) };
        return DielectricBoundary { reflectance, transmittance, cos_theta_t: F::ZERO };
    }
    let g = g_squared.sqrt();
    let eta_squared = eta * eta;
    let r_s = -a / (c + g).squared();
    let r_p = r_s * ((c * g - sin2) / (c * g + sin2));
    DielectricBoundary {
        reflectance: Polarized { s: r_s * r_s, p: r_p * r_p },
        transmittance: Polarized {
            s: F::FOUR * c * g / (c + g).squared(),
            p: F::FOUR * eta_squared * c * g / (eta_squared * c + g).squared(),
        },
        cos_theta_t: g / eta,
    }
}

/// What happens to light at the surface of a conductor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConductorBoundary<F> {
    /// Fraction reflected, \[0, 1\] to rounding.
    pub reflectance: Polarized<F>,
    /// Fraction absorbed, 1 − R but computed without the subtraction.
    pub absorptance: Polarized<F>,
}

/// Exact Fresnel equations for a conductor of relative complex index `eta` + i `k`.
///
/// # Definition
/// With c = cos θi, s = sin θi and N cos θt = √(N² − s²) = a + i b:
/// R_s = |N² − 1|² / ((a + c)² + b²)², R_p = R_s ((a c − s²)² + (b c)²) / ((a c + s²)² + (b c)²),
/// the complex amplitudes of Born & Wolf, *Principles of Optics* §14.2, multiplied out. Every term is a square,
/// so nothing is negative, and 1 − R_s is 4 a c / ((a + c)² + b²). The denominators are sums with a² + b² = |N² − s²|,
/// which is rounded less often. The smaller of a and b comes from a b = η k, because √(½(|N² − s²| ± Re(N² − s²)))
/// cancels for the smaller one.
///
/// # Limits
/// k = 0 is the dielectric, total internal reflection included; η = 0 reflects everything.
#[inline]
pub fn conductor<F: Real>(cos_theta_i: F, eta: F, k: F) -> ConductorBoundary<F> {
    let c = cos_theta_i;
    let s2 = (F::ONE - c) * (F::ONE + c);
    let bend = (eta - F::ONE) * (eta + F::ONE);
    let real = squared_normal_component(c, s2, eta, bend) - k * k;
    let imaginary = F::TWO * eta * k;
    let modulus = hypotenuse(real.abs(), imaginary);
    let (a, b) = if modulus <= F::ZERO {
        (F::ZERO, F::ZERO)
    } else if real >= F::ZERO {
        let a = (F::HALF * (modulus + real)).sqrt();
        (a, eta * k / a)
    } else {
        let b = (F::HALF * (modulus - real)).sqrt();
        (eta * k / b, b)
    };
    let a_c = a * c;
    let sum = modulus + c * c + F::TWO * a_c;
    if sum <= F::ZERO {
        // Only an index-matched medium (η = 1, k = 0) at exact grazing: it reflects nothing at any angle.
        let (none, all) = (Polarized { s: F::ZERO, p: F::ZERO }, Polarized { s: F::ONE, p: F::ONE });
        return ConductorBoundary { reflectance: none, absorptance: all };
    }
    // a − c cancels between nearly matched media, and squares of a tiny N² − 1 underflow.
    let r_s = ((bend - k * k) / sum).squared() + (imaginary / sum).squared();
    let a_s = F::FOUR * a_c / sum;
    let p_sum = modulus * (c * c) + s2 * s2 + F::TWO * a_c * s2;
    // At normal incidence both polarisations are the same, also where an index near 0 makes this 0/0.
    let (p_ratio, p_rest) = if p_sum > F::ZERO {
        (((a_c - s2).squared() + (b * c).squared()) / p_sum, F::FOUR * a_c * s2 / p_sum)
    } else {
        (F::ONE, F::ZERO)
    };
    ConductorBoundary {
        reflectance: Polarized { s: r_s, p: r_s * p_ratio },
        absorptance: Polarized { s: a_s, p: a_s + r_s * p_rest },
    }
}

/// η² − sin²θ = η² − 1 + cos²θ, in the form that does not cancel: the first does near η = 1, the second near η = 0.
#[inline]
fn squared_normal_component<F: Real>(c: F, sin2: F, eta: F, eta_squared_minus_1: F) -> F {
    if eta < F::HALF { eta * eta - sin2 } else { eta_squared_minus_1 + c * c }
}

/// √(x² + y²) of numbers that are not negative, also where their squares underflow.
#[inline]
fn hypotenuse<F: Real>(x: F, y: F) -> F {
    let larger = x.max(y);
    if larger > F::TANGENT {
        (x * x + y * y).sqrt()
    } else if larger > F::ZERO {
        larger * ((x / larger).squared() + (y / larger).squared()).sqrt()
    } else {
        F::ZERO
    }
}

/// The thesis's approximation for conductors, its equations 7 and 8.
///
/// Exact at normal incidence, elsewhere it neglects sin²θ against η² + k²: at most 0.0071 too bright for
/// copper's blue, but wrong by 0.099 for η = 1.5, k = 0.
#[inline]
pub fn conductor_thesis<F: Real>(cos_theta_i: F, eta: F, k: F) -> Polarized<F> {
    let c = cos_theta_i;
    let (c2, modulus, twice) = (c * c, eta * eta + k * k, F::TWO * eta * c);
    Polarized {
        s: (modulus - twice + c2) / (modulus + twice + c2),
        p: (modulus * c2 - twice + F::ONE) / (modulus * c2 + twice + F::ONE),
    }
}

/// Reflectance at normal incidence: ((η − 1)² + k²) / ((η + 1)² + k²).
///
/// The thesis's equation 12 lacks the square.
#[inline]
pub fn normal_incidence<F: Real>(eta: F, k: F) -> F {
    ((eta - F::ONE).squared() + k * k) / ((eta + F::ONE).squared() + k * k)
}

/// Schlick's approximation, f₀ + (1 − f₀)(1 − cos θ)⁵.
///
/// The cosine is that of the *less dense* side; see [`schlick_dielectric`]. The thesis's equation 11 prints
/// the fifth power at the wrong place. Schlick, *Computer Graphics Forum* 13(3), 1994,
/// <https://doi.org/10.1111/1467-8659.1330233>.
#[inline]
pub fn schlick<F: Real>(cos_theta: F, f0: F) -> F {
    let m = F::ONE - cos_theta;
    let m2 = m * m;
    f0 + (F::ONE - f0) * (m2 * m2 * m)
}

/// Schlick's approximation between dielectrics, from either side: it uses the angle on the less dense side
/// and returns 1 under total internal reflection.
#[inline]
pub fn schlick_dielectric<F: Real>(cos_theta_i: F, eta: F) -> F {
    let f0 = normal_incidence(eta, F::ZERO);
    if eta >= F::ONE {
        return schlick(cos_theta_i, f0);
    }
    let g_squared = (eta - F::ONE) * (eta + F::ONE) + cos_theta_i * cos_theta_i;
    if g_squared <= F::ZERO { F::ONE } else { schlick(g_squared.sqrt() / eta, f0) }
}

/// The Lazányi–Szirmay-Kalos error term in the parametrisation by the reflectance at 82°, "F82": Schlick's
/// curve minus b c (1 − c)⁶, exact at 0°, at cos θ = 1/7 and at 90°.
///
/// Lazányi & Szirmay-Kalos, *Fresnel term approximations for metals*, WSCG 2005; Kutz et al., *Novel aspects
/// of the Adobe Standard Material*, 2023.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lazanyi<F> {
    f0: F,
    b: F,
}

impl<F: Real> Lazanyi<F> {
    /// The curve through the reflectance `f0` at normal incidence and `f82` at cos θ = 1/7.
    pub fn new(f0: F, f82: F) -> Self {
        let c = F::ONE / F::from_f64(7.0);
        let m = F::ONE - c;
        let m3 = m * m * m;
        Self { f0, b: (schlick(c, f0) - f82) / (c * m3 * m3) }
    }
    /// The curve for a conductor of relative index `eta` + i `k`.
    pub fn of_conductor(eta: F, k: F) -> Self {
        let at_82 = conductor(F::ONE / F::from_f64(7.0), eta, k).reflectance.unpolarized();
        Self::new(normal_incidence(eta, k), at_82)
    }
    /// Reflectance for unpolarised light.
    #[inline]
    pub fn reflectance(self, cos_theta: F) -> F {
        let m = F::ONE - cos_theta;
        let m3 = m * m * m;
        schlick(cos_theta, self.f0) - self.b * cos_theta * (m3 * m3)
    }
}

/// The Fresnel term of a reflecting lobe.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fresnel<F> {
    /// The same reflectance at every angle.
    Constant(Rgb<F>),
    /// Exact, between dielectrics; `eta` is the index below the surface over the index above.
    Dielectric {
        /// Relative index of refraction.
        eta: F,
    },
    /// Exact, for a conductor below the surface, one complex index per channel.
    Conductor {
        /// Real part of the relative index.
        eta: Rgb<F>,
        /// Extinction: imaginary part of the relative index.
        k: Rgb<F>,
    },
}

impl<F: Real> Fresnel<F> {
    /// A constant reflectance in \[0, 1\] per channel.
    pub fn constant(reflectance: Rgb<F>) -> Result<Self, OutOfRange> {
        Ok(Self::Constant(require_fractions("reflectance", reflectance)?))
    }
    /// A dielectric of relative index `eta` ∈ \[1e-3, 1e3\].
    pub fn dielectric(eta: F) -> Result<Self, OutOfRange> {
        Ok(Self::Dielectric { eta: require_eta(eta)? })
    }
    /// A conductor of relative index `eta` + i `k` per channel, each part in \[0, 1e3\], not both zero.
    pub fn conductor(eta: Rgb<F>, k: Rgb<F>) -> Result<Self, OutOfRange> {
        let limit = F::from_f64(1e3);
        for (&n, &k) in eta.0.iter().zip(&k.0) {
            require("k", k, |k| k >= F::ZERO && k <= limit, "extinction in [0, 1000]")?;
            require(
                "eta",
                n,
                |n| n >= F::ZERO && n <= limit && n + k > F::ZERO,
                "index of refraction in [0, 1000], with eta + k > 0",
            )?;
        }
        Ok(Self::Conductor { eta, k })
    }

    /// The same material met from inside a medium of index `eta`: its own index is divided by it. A constant stays.
    ///
    /// A coated metal needs this: with the index relative to air aluminium under varnish is up to 0.1 too bright.
    pub fn immersed(self, eta: F) -> Result<Self, OutOfRange> {
        let outer = require_eta(eta)?;
        match self {
            Self::Constant(_) => Ok(self),
            Self::Dielectric { eta } => Self::dielectric(eta / outer),
            Self::Conductor { eta, k } => Self::conductor(eta / outer, k / outer),
        }
    }

    /// Reflectance for unpolarised light that arrives from above.
    #[inline]
    pub fn reflectance(&self, cos_theta_i: F) -> Rgb<F> {
        self.reflectance_at(|| cos_theta_i)
    }

    /// [`Self::reflectance`] at a cosine that is computed only where it matters.
    #[inline(always)]
    pub(crate) fn reflectance_at(&self, cos_theta_i: impl FnOnce() -> F) -> Rgb<F> {
        match *self {
            Self::Constant(reflectance) => reflectance,
            Self::Dielectric { eta } => Rgb::splat(dielectric_unpolarized(cos_theta_i(), eta)),
            Self::Conductor { eta, k } => {
                let cos_theta_i = cos_theta_i();
                Rgb([0, 1, 2].map(|channel| conductor_unpolarized(cos_theta_i, eta[channel], k[channel])))
            }
        }
    }
}

/// [`dielectric`] for unpolarised light; a call, so that lobes of constant reflectance stay small.
#[inline(never)]
fn dielectric_unpolarized<F: Real>(cos_theta_i: F, eta: F) -> F {
    dielectric(cos_theta_i, eta).reflectance.unpolarized()
}
/// [`conductor`] for unpolarised light; a call as well.
#[inline(never)]
fn conductor_unpolarized<F: Real>(cos_theta_i: F, eta: F, k: F) -> F {
    conductor(cos_theta_i, eta, k).reflectance.unpolarized()
}

/// A relative index of refraction that dielectric formulas accept.
pub(crate) fn require_eta<F: Real>(eta: F) -> Result<F, OutOfRange> {
    let (low, high) = (F::from_f64(1e-3), F::from_f64(1e3));
    require("eta", eta, |eta| eta >= low && eta <= high, "relative index of refraction in [0.001, 1000]")
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn normal_incidence_has_its_closed_form() {
        for eta in [1.0001, 1.1, 1.5, 2.42, 1.0 / 1.5] {
            let exact = dielectric::<f64>(1.0, eta).reflectance;
            assert_abs_diff_eq!(exact.s, normal_incidence(eta, 0.0), epsilon = 1e-15);
            assert_abs_diff_eq!(exact.p, exact.s, epsilon = 1e-15);
        }
        for (eta, k) in [(0.188, 3.403), (1.5, 0.0), (0.01, 5.0), (0.0, 3.0)] {
            let exact = conductor::<f64>(1.0, eta, k).reflectance;
            assert_abs_diff_eq!(exact.unpolarized(), normal_incidence(eta, k), epsilon = 1e-14);
            let thesis = conductor_thesis::<f64>(1.0, eta, k);
            assert_abs_diff_eq!(thesis.unpolarized(), normal_incidence(eta, k), epsilon = 1e-14);
        }
    }

    #[test]
    fn brewster_angle_reflects_no_p() {
        for eta in [1.1, 1.33, 1.5, 2.42, 1.0 / 1.5] {
            let cos_brewster = 1.0 / f64::sqrt(1.0 + eta * eta);
            assert!(dielectric(cos_brewster, eta).reflectance.p < 1e-30);
        }
        let glass = dielectric(1.0 / f64::sqrt(1.0 + 1.5 * 1.5), 1.5).reflectance;
        assert_abs_diff_eq!(glass.unpolarized(), 0.073_964_497_041_420_12, epsilon = 1e-15);
    }

    #[test]
    fn total_internal_reflection_begins_at_the_critical_cosine() {
        let eta = 1.0 / 1.5;
        let critical = f64::sqrt((1.0 - eta) * (1.0 + eta));
        assert_abs_diff_eq!(critical, 0.745_355_992_499_93, epsilon = 1e-14);
        for c in [0.0, 0.3, critical - 1e-15] {
            assert_eq!(dielectric(c, eta).reflectance, Polarized { s: 1.0, p: 1.0 });
        }
        assert!(dielectric(critical + 1e-12, eta).reflectance.unpolarized() < 1.0);
    }

    #[test]
    fn light_path_is_reversible() {
        for eta in [1.0001, 1.5, 2.42] {
            for c in [0.01, 0.3, 0.7, 1.0] {
                let forth = dielectric::<f64>(c, eta);
                let back = dielectric(forth.cos_theta_t, 1.0 / eta);
                // Near the critical angle g² is a difference of numbers near 1 whose rounding it inherits.
                let g_squared = (c / eta).powi(2);
                let epsilon = 1e-14 + 8.0 * f64::EPSILON / g_squared;
                assert_abs_diff_eq!(forth.reflectance.s, back.reflectance.s, epsilon = epsilon);
                assert_abs_diff_eq!(forth.transmittance.p, back.transmittance.p, epsilon = epsilon);
            }
        }
    }

    #[test]
    fn conductor_without_extinction_is_the_dielectric() {
        for eta in [1.0_f64, 1.5, 0.6] {
            for i in 0..=1000 {
                let c = f64::from(i) / 1000.0;
                let (metal, glass) = (conductor(c, eta, 0.0), dielectric(c, eta));
                assert_abs_diff_eq!(metal.reflectance.s, glass.reflectance.s, epsilon = 1e-14);
                assert_abs_diff_eq!(metal.reflectance.p, glass.reflectance.p, epsilon = 1e-14);
            }
        }
    }

    #[test]
    fn metals_have_a_pseudo_brewster_dip() {
        let aluminium = |c: f64| conductor(c, 1.43, 7.51).reflectance.unpolarized();
        assert_abs_diff_eq!(aluminium(1.0), 0.908, epsilon = 1e-3);
        assert_abs_diff_eq!(aluminium(82.0_f64.to_radians().cos()), 0.834, epsilon = 1e-3);
    }

    #[test]
    fn regress_errors_of_the_approximations() {
        // science: thesis ≤ 0.0071 on copper, 0.099 at k = 0; Schlick 0.036 at 85° for η = 1.5.
        let angles = || (0..=9000).map(|i| (f64::from(i) / 100.0).to_radians().cos());
        let worst = |f: &dyn Fn(f64) -> f64| angles().map(f).fold(0.0_f64, |a, b| a.max(b.abs()));
        let exact = |c, n, k| conductor(c, n, k).reflectance.unpolarized();
        let copper = worst(&|c| conductor_thesis(c, 1.247, 2.456).unpolarized() - exact(c, 1.247, 2.456));
        assert!((0.006..0.008).contains(&copper), "{copper}");
        let glass = worst(&|c| conductor_thesis(c, 1.5, 0.0).unpolarized() - exact(c, 1.5, 0.0));
        assert_abs_diff_eq!(glass, 0.099, epsilon = 1e-3);
        let schlick = worst(&|c| schlick_dielectric(c, 1.5) - exact(c, 1.5, 0.0));
        assert_abs_diff_eq!(schlick, 0.036, epsilon = 1e-3);
        let chromium = Lazanyi::of_conductor(3.145, 3.312);
        let lazanyi = worst(&|c| chromium.reflectance(c) - exact(c, 3.145, 3.312));
        assert!((0.015..0.025).contains(&lazanyi), "{lazanyi}");
    }

    #[test]
    fn index_matched_media_reflect_nothing_even_at_grazing() {
        for c in [0.0, f64::MIN_POSITIVE, 1e-8, 0.5, 1.0] {
            assert_eq!(dielectric(c, 1.0).reflectance.unpolarized(), 0.0);
            assert_eq!(dielectric(c, 1.0).transmittance.unpolarized(), 1.0);
            assert!(conductor(c, 1.0, 0.0).reflectance.unpolarized() < 1e-15, "{c}");
        }
    }

    #[test]
    fn constructors_name_parameter_value_and_range() {
        let error = Fresnel::dielectric(f64::NAN).unwrap_err();
        assert_eq!(
            error.to_string(),
            "eta = NaN is out of range: expected relative index of refraction in [0.001, 1000]"
        );
        assert!(Fresnel::dielectric(0.0_f32).is_err());
        assert!(Fresnel::conductor(Rgb::splat(0.0), Rgb::splat(0.0_f64)).is_err());
        assert!(Fresnel::conductor(Rgb::splat(0.0), Rgb::splat(3.0_f64)).is_ok());
        assert!(Fresnel::constant(Rgb([0.5, 0.5, 1.02_f64])).is_err());
    }
}

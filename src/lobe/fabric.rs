use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, same_side, sin2_theta};
use crate::parameter::{OutOfRange, require, require_fractions};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::warp::{about, cosine_hemisphere, cosine_hemisphere_pdf, power_lobe, power_lobe_pdf};

/// Diffuse reflection of which a share goes back to where it came from, from both sides: satin, velvet.
///
/// # Definition
/// f = ρ/π \[sr⁻¹\] times (1 − b) + b (g(`wo`·`wi`) / E(1) + (1 − Ê(µo)) (1 − Ê(µi)) / (1 − Ē)), with µ =
/// |cos θ|, g(d) = ((1 + d)/2)ᵖ, E(µ) its albedo, a polynomial in µ that is largest at 1, Ê = E / E(1) and Ē
/// the mean of Ê over projected solid angle. The second term returns the energy that the first, scaled to
/// pass nothing above 1, lacks: the albedo is ρ at every angle.
///
/// The thesis (§4.3) weighs light that scatters back more heavily and prints no formula. This weight depends
/// on `wo`·`wi` alone, so it is reciprocal, and it is ours: no measurement stands behind it.
///
/// # Sampling
/// With probability b Ê(µo) a direction about `wo` with density (p + 1)/4π g, none if that is below the
/// horizon; else cosine-weighted. The density is the mixture's.
///
/// # Limits
/// b = 0 is [`crate::lobe::Lambertian`]. At b = 1 and p = 16 hardly anything is scattered forward.
///
/// # Example
/// ```
/// use gonio::{bxdf::{Bxdf, TransportMode}, lobe::Fabric, rgb::Rgb};
/// let satin = Fabric::new(Rgb::splat(0.5_f64), 1.0, 4)?;
/// let (w, mirrored) = (glam::DVec3::new(0.6, 0.0, 0.8), glam::DVec3::new(-0.6, 0.0, 0.8));
/// let f = |wi| satin.eval(w, wi, TransportMode::Radiance)[0];
/// assert!(f(w) > 2.0 * f(mirrored));
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct Fabric<F> {
    reflectance: Rgb<F>,
    backscatter: F,
    exponent: u32,
    /// 1 / E(1).
    peak: F,
    /// (1 − Ê(µ)) / (1 − µ) in powers of µ, the first `exponent` of them.
    missing: [F; LARGEST_EXPONENT],
    /// 1 / (1 − Ē).
    restored: F,
}

/// The largest exponent p.
const LARGEST_EXPONENT: usize = 16;

/// E(µ) in powers of µ, up to the exponent.
///
/// d = µo µi + sin sin cos φ is raised to the k-th power; odd powers of cos φ vanish, and the mean of an even
/// one is C(2j, j) / 4ʲ. What remains over µi is ∫ µiᵏ⁻²ʲ (1 − µi²)ʲ 2 µi dµi = j! / (a (a + 1) … (a + j)), a
/// = (k − 2j)/2 + 1.
fn albedo_polynomial(exponent: usize) -> [f64; LARGEST_EXPONENT + 1] {
    let choose = |n: usize, k: usize| (0..k).fold(1.0, |c, i| c * (n - i) as f64 / (i + 1) as f64);
    let mut powers = [0.0; LARGEST_EXPONENT + 1];
    for k in 0..=exponent {
        for j in 0..=k / 2 {
            let a = (k - 2 * j) as f64 / 2.0 + 1.0;
            let beta = (0..j).fold(1.0 / a, |beta, i| beta * (i + 1) as f64 / (a + (i + 1) as f64));
            let mean = (0..j).fold(choose(2 * j, j), |mean, _| mean / 4.0);
            let term = choose(exponent, k) * choose(k, 2 * j) * mean * beta;
            // µᵏ⁻²ʲ (1 − µ²)ʲ
            for i in 0..=j {
                let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
                powers[k - 2 * j + 2 * i] += sign * term * choose(j, i);
            }
        }
    }
    let scale = (0..exponent).fold(1.0, |scale, _| scale / 2.0);
    powers.map(|power| power * scale)
}

impl<F: Real> Fabric<F> {
    /// A fabric of the given reflectance, \[0, 1\] per channel, of which the fraction `backscatter` (b, \[0,
    /// 1\]) follows a lobe about the direction of incidence that is the narrower the larger the `exponent`
    /// (p: 1, 2, 4, 8 or 16).
    pub fn new(reflectance: Rgb<F>, backscatter: F, exponent: u32) -> Result<Self, OutOfRange> {
        let reflectance = require_fractions("reflectance", reflectance)?;
        let backscatter =
            require("backscatter", backscatter, |b| b >= F::ZERO && b <= F::ONE, "a fraction in [0, 1]")?;
        let p = exponent as usize;
        let is_valid = |_| p.is_power_of_two() && p <= LARGEST_EXPONENT;
        require("exponent", F::from_f64(f64::from(exponent)), is_valid, "one of 1, 2, 4, 8, 16")?;
        let albedo = albedo_polynomial(p);
        let peak: f64 = albedo.iter().sum();
        // E(1) − E(µ) = Σ eₖ (1 − µᵏ) = (1 − µ) Σ (eⱼ₊₁ + … + eₚ) µʲ.
        let missing: [f64; LARGEST_EXPONENT] =
            core::array::from_fn(|j| albedo[j + 1..].iter().rev().sum::<f64>() / peak);
        let mean = albedo.iter().enumerate().map(|(k, e)| e * 2.0 / (k + 2) as f64).sum::<f64>() / peak;
        let f = F::from_f64;
        Ok(Self {
            reflectance,
            backscatter,
            exponent,
            peak: f(1.0 / peak),
            missing: missing.map(f),
            restored: f(1.0 / (1.0 - mean)),
        })
    }

    /// Fraction reflected, per channel.
    pub fn reflectance(&self) -> Rgb<F> {
        self.reflectance
    }

    /// 1 − Ê.
    #[inline]
    pub(crate) fn missing(&self, w: F::Vec3) -> F {
        let mu = w.z().abs();
        let coefficients = &self.missing[..self.exponent as usize];
        let sum = coefficients.iter().rev().fold(F::ZERO, |sum, &coefficient| sum * mu + coefficient);
        sin2_theta::<F>(w) / (F::ONE + mu) * sum
    }

    /// π f / ρ for two directions on the same side.
    #[inline]
    fn pi_f(&self, wo: F::Vec3, wi: F::Vec3) -> F {
        let restored = self.missing(wo) * self.missing(wi) * self.restored;
        (F::ONE - self.backscatter)
            + self.backscatter * (g::<F>(wo, wi, self.exponent) * self.peak + restored)
    }

    /// Density at a direction on the side of `wo`.
    #[inline]
    fn density(&self, wo: F::Vec3, wi: F::Vec3) -> F {
        let missing = self.missing(wo);
        let lobe = power_lobe_pdf(g::<F>(wo, wi, self.exponent), self.exponent);
        let cosine = cosine_hemisphere_pdf(wi.z().abs());
        self.backscatter * (F::ONE - missing) * lobe
            + (F::ONE - self.backscatter + self.backscatter * missing) * cosine
    }
}

/// ((1 + wo·wi)/2)ᵖ, as |wo + wi|²/4: nothing cancels between opposite directions.
#[inline]
pub(crate) fn g<F: Real>(wo: F::Vec3, wi: F::Vec3, exponent: u32) -> F {
    let sum = (wo + wi) * F::HALF;
    let base = sum.dot(sum);
    (0..exponent.trailing_zeros()).fold(base, |power, _| power * power)
}

impl<F: Real> Bxdf<F> for Fabric<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        if same_side::<F>(wo, wi) { self.reflectance * (self.pi_f(wo, wi) / F::PI) } else { Rgb::BLACK }
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        if same_side::<F>(wo, wi) { self.density(wo, wi) } else { F::ZERO }
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        let wi = if uc < self.backscatter * (F::ONE - self.missing(wo)) {
            about::<F>(wo, power_lobe::<F>(u, self.exponent))
        } else {
            let above = cosine_hemisphere::<F>(u);
            if is_above::<F>(wo) { above } else { -above }
        };
        same_side::<F>(wo, wi).then(|| {
            let density = self.density(wo, wi);
            BxdfSample {
                wi,
                weight: self.reflectance * (self.pi_f(wo, wi) * (cosine_hemisphere_pdf(wi.z().abs()) / density)),
                pdf: Pdf::SolidAngle(density),
                eta: F::ONE,
            }
        })
    }

    fn albedo(&self, _: F::Vec3) -> Rgb<F> {
        self.reflectance
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: false }
    }
}

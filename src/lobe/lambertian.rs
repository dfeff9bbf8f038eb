use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, same_side};
use crate::parameter::{OutOfRange, require_fractions};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::warp::{cosine_hemisphere, cosine_hemisphere_pdf};

/// Ideal diffuse reflection, from both sides.
///
/// # Definition
/// f = ρ / π \[sr⁻¹\] where both directions lie on the same side (thesis §4.1.1).
///
/// # Sampling
/// Cosine-weighted hemisphere; the weight is ρ exactly.
///
/// # Example
/// ```
/// use gonio::{bxdf::{Bxdf, TransportMode}, lobe::Lambertian, rgb::Rgb};
/// let white = Lambertian::new(Rgb::splat(1.0_f64))?;
/// let w = glam::DVec3::new(0.6, 0.0, 0.8);
/// assert_eq!(white.eval(w, w, TransportMode::Radiance)[0], std::f64::consts::FRAC_1_PI);
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct Lambertian<F> {
    reflectance: Rgb<F>,
}

impl<F: Real> Lambertian<F> {
    /// A diffuse reflector of the given reflectance, \[0, 1\] per channel.
    pub fn new(reflectance: Rgb<F>) -> Result<Self, OutOfRange> {
        Ok(Self { reflectance: require_fractions("reflectance", reflectance)? })
    }
}

impl<F: Real> Bxdf<F> for Lambertian<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        if same_side::<F>(wo, wi) { self.reflectance / F::PI } else { Rgb::BLACK }
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        if same_side::<F>(wo, wi) { cosine_hemisphere_pdf(wi.z().abs()) } else { F::ZERO }
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, _: F, u: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        let above = cosine_hemisphere::<F>(u);
        let wi = if is_above::<F>(wo) { above } else { -above };
        same_side::<F>(wo, wi).then(|| BxdfSample {
            wi,
            weight: self.reflectance,
            pdf: Pdf::SolidAngle(cosine_hemisphere_pdf(above.z())),
            eta: F::ONE,
        })
    }

    fn albedo(&self, _: F::Vec3) -> Rgb<F> {
        self.reflectance
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: false }
    }
}

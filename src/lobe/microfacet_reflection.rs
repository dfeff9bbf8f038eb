use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, reflect};
use crate::fresnel::Fresnel;
use crate::microfacet::Distribution;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Single-scattering reflection at a rough surface of ideally specular facets.
///
/// # Definition
/// f = F(wo·h) D(h) G₂(wo, wi) / (4 cos θo cos θi) \[sr⁻¹\], h = (wo + wi) / |wo + wi|, with height-correlated
/// Smith masking–shadowing, all over projected areas (see [`crate::microfacet`]). The thesis's equation 14
/// prints the norm with h·w for n·w, pairs Beckmann's G with both distributions, and multiplies G₁ by G₁.
///
/// # Sampling
/// Visible normals: the density is D(h) / (4 σ(wo)) and the weight F G₂ / G₁(wo) ≤ 1. A normal that reflects
/// `wo` into the surface gives no sample.
///
/// # Limits
/// Energy that leaves after several bounces is lost: a white mirror keeps 0.877 at α = 0.3 and normal incidence. A conductor
/// (or a constant) reflects from above only, a dielectric from both sides. Roughness below
/// [`crate::microfacet::ALPHA_MIN`] is refused: that is a specular lobe.
///
/// # Example
/// ```
/// use gonio::bxdf::{Bxdf, TransportMode};
/// use gonio::{fresnel::Fresnel, lobe::MicrofacetReflection, microfacet::{Distribution, Shape}, rgb::Rgb};
/// let ggx = Distribution::new(Shape::Ggx, 0.5_f64, 0.5)?;
/// let mirror = MicrofacetReflection::new(ggx, Fresnel::constant(Rgb::WHITE)?);
/// let f = mirror.eval(glam::DVec3::Z, glam::DVec3::Z, TransportMode::Radiance);
/// assert!((f[0] - 1.0 / std::f64::consts::PI).abs() < 1e-15); // D(n) / 4 = 1 / (4 π α²)
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct MicrofacetReflection<F> {
    distribution: Distribution<F>,
    above: Fresnel<F>,
    below: Option<Fresnel<F>>,
}

impl<F: Real> MicrofacetReflection<F> {
    /// A rough surface of the given distribution of normals and Fresnel term (as seen from above).
    pub fn new(distribution: Distribution<F>, fresnel: Fresnel<F>) -> Self {
        let below = match fresnel {
            Fresnel::Dielectric { eta } => Some(Fresnel::Dielectric { eta: F::ONE / eta }),
            Fresnel::Conductor { .. } | Fresnel::Constant(_) => None,
        };
        Self { distribution, above: fresnel, below }
    }

    /// The distribution of micro normals.
    pub fn distribution(&self) -> &Distribution<F> {
        &self.distribution
    }

    /// The Fresnel term seen from above.
    pub fn fresnel(&self) -> Fresnel<F> {
        self.above
    }

    /// The side that `wo` is on: its Fresnel term, and the sign that brings directions above the surface.
    #[inline]
    fn side(&self, wo: F::Vec3) -> Option<(&Fresnel<F>, F)> {
        if is_above::<F>(wo) {
            Some((&self.above, F::ONE))
        } else if is_above::<F>(-wo) {
            self.below.as_ref().map(|fresnel| (fresnel, -F::ONE))
        } else {
            None
        }
    }
}

impl<F: Real> Bxdf<F> for MicrofacetReflection<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        let Some((fresnel, sign)) = self.side(wo) else { return Rgb::BLACK };
        let (wo, wi) = (wo * sign, wi * sign);
        if !is_above::<F>(wi) {
            return Rgb::BLACK;
        }
        let (reflection, wo_dot_h) = self.distribution.reflection(wo, wi);
        fresnel.reflectance(wo_dot_h) * reflection
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        let Some((_, sign)) = self.side(wo) else { return F::ZERO };
        let (wo, wi) = (wo * sign, wi * sign);
        if is_above::<F>(wi) { self.distribution.reflection_pdf(wo, wi) } else { F::ZERO }
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, _: F, u: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        let (fresnel, sign) = self.side(wo)?;
        let wo = wo * sign;
        let wm = self.distribution.sample_visible(wo, u);
        let wi = reflect::<F>(wo, wm);
        if !is_above::<F>(wi) {
            return None;
        }
        let (pdf, g2_over_g1) = self.distribution.reflection_sample(wo, wi, wm);
        Some(BxdfSample {
            wi: wi * sign,
            weight: fresnel.reflectance(wo.dot(wm).max(F::ZERO)) * g2_over_g1,
            pdf: Pdf::SolidAngle(pdf),
            eta: F::ONE,
        })
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: false }
    }
}

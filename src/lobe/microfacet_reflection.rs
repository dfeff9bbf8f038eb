use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::is_above;
use crate::fresnel::Fresnel;
use crate::lobe::SpecularReflection;
use crate::microfacet::Distribution;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Single-scattering reflection at a rough surface of ideally specular facets.
///
/// # Definition
/// f = F(wo·h) D(h) G₂(wo, wi) / (4 cos θo cos θi) \[sr⁻¹\], h = (wo + wi) / |wo + wi|, all over projected areas (see
/// [`crate::microfacet`]). The distribution brings its masking–shadowing: height-correlated Smith, separable Smith (the
/// thesis's), or V-cavities, with which Beckmann and Gaussian normals make the models of Torrance–Sparrow and
/// Cook–Torrance. The thesis's equation 13 lacks the factor 4 and divides by h·w for n·w; its equation 14 has h·w too and
/// pairs Beckmann's G with both distributions.
///
/// # Sampling
/// Visible normals: the density is D(h) / (4 σ(wo)) and the weight F G₂ / G₁(wo) ≤ 1. A normal that reflects
/// `wo` into the surface gives no sample. V-cavities: a normal, then the wall of its cavity that is seen.
///
/// # Limits
/// Energy that leaves after several bounces is lost: a white mirror keeps 0.877 at α = 0.3 and normal incidence;
/// [`crate::lobe::KullaContyReflection`] returns it. Light from below the surface is not scattered; a dielectric that is
/// lit from both sides is [`crate::lobe::MicrofacetDielectric`]. Where the distribution is smooth
/// ([`crate::microfacet::ALPHA_MIN`]) this is [`SpecularReflection`].
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
    fresnel: Fresnel<F>,
}

impl<F: Real> MicrofacetReflection<F> {
    /// A rough surface of the given distribution of normals and Fresnel term.
    pub fn new(distribution: Distribution<F>, fresnel: Fresnel<F>) -> Self {
        Self { distribution, fresnel }
    }

    /// The distribution of micro normals.
    pub fn distribution(&self) -> &Distribution<F> {
        &self.distribution
    }

    /// The limit of small roughness.
    fn smooth(&self) -> SpecularReflection<F> {
        SpecularReflection::new(self.fresnel)
    }

    /// The Fresnel term.
    pub fn fresnel(&self) -> Fresnel<F> {
        self.fresnel
    }

    /// The value with the lobe's own distribution, or the same one with its kind known.
    #[inline(always)]
    fn eval_with(&self, distribution: &Distribution<F>, wo: F::Vec3, wi: F::Vec3) -> Rgb<F> {
        let facet = distribution.reflection(wo, wi);
        self.fresnel.reflectance_at(|| facet.cos_theta_o()) * facet.value
    }

    /// A sample with the lobe's own distribution, or the same one with its kind known.
    #[inline(always)]
    fn sample_with(&self, distribution: &Distribution<F>, wo: F::Vec3, uc: F, u: [F; 2]) -> Option<BxdfSample<F>> {
        let (wi, facet) = distribution.sample_reflection(wo, uc, u)?;
        Some(BxdfSample {
            wi,
            weight: self.fresnel.reflectance_at(|| facet.cos_theta_o()) * facet.weight,
            pdf: Pdf::SolidAngle(facet.pdf),
            eta: F::ONE,
        })
    }

    // The paths that are not inlined take components: to pass the address of a direction would keep it in memory on the
    // inlined path too.

    #[inline(never)]
    fn eval_any(&self, ox: F, oy: F, oz: F, ix: F, iy: F, iz: F) -> Rgb<F> {
        let (wo, wi) = (F::Vec3::new(ox, oy, oz), F::Vec3::new(ix, iy, iz));
        if self.distribution.is_smooth() { Rgb::BLACK } else { self.eval_with(&self.distribution, wo, wi) }
    }

    #[inline(never)]
    fn pdf_any(&self, ox: F, oy: F, oz: F, ix: F, iy: F, iz: F) -> F {
        let (wo, wi) = (F::Vec3::new(ox, oy, oz), F::Vec3::new(ix, iy, iz));
        if self.distribution.is_smooth() { F::ZERO } else { self.distribution.reflection_pdf(wo, wi).0 }
    }

    #[inline(never)]
    fn sample_any(&self, x: F, y: F, z: F, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let wo = F::Vec3::new(x, y, z);
        if self.distribution.is_smooth() {
            return self.smooth().sample(wo, uc, u, mode);
        }
        self.sample_with(&self.distribution, wo, uc, u)
    }
}

// Inlined without the paths of other distributions: a call costs half of what the arithmetic does.
impl<F: Real> Bxdf<F> for MicrofacetReflection<F> {
    #[inline(always)]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> Rgb<F> {
        if !is_above::<F>(wo) || !is_above::<F>(wi) {
            return Rgb::BLACK;
        }
        match self.distribution.as_rough_ggx() {
            Some(ggx) => self.eval_with(&ggx, wo, wi),
            None => self.eval_any(wo.x(), wo.y(), wo.z(), wi.x(), wi.y(), wi.z()),
        }
    }

    #[inline(always)]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        if !is_above::<F>(wo) || !is_above::<F>(wi) {
            return F::ZERO;
        }
        match self.distribution.as_rough_ggx() {
            Some(ggx) => ggx.reflection_pdf(wo, wi).0,
            None => self.pdf_any(wo.x(), wo.y(), wo.z(), wi.x(), wi.y(), wi.z()),
        }
    }

    #[inline(always)]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        if !is_above::<F>(wo) {
            return None;
        }
        match self.distribution.as_rough_ggx() {
            Some(ggx) => self.sample_with(&ggx, wo, uc, u),
            None => self.sample_any(wo.x(), wo.y(), wo.z(), uc, u, mode),
        }
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        // Of a smooth surface: what a rough one loses does not matter for picking a component.
        self.smooth().albedo(wo)
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: self.distribution.is_smooth() }
    }
}

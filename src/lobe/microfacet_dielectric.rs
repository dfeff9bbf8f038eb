use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode, squeeze};
use crate::frame::{is_above, reflect, renormalize, sin2_between};
use crate::fresnel::{DielectricBoundary, dielectric_from};
use crate::lobe::DielectricSpecular;
use crate::microfacet::{ALPHA_MIN, Distribution, RefractingFacet};
use crate::parameter::OutOfRange;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Single-scattering reflection and transmission at a rough boundary of dielectrics, from both sides.
///
/// # Definition
/// Reflection as [`crate::lobe::MicrofacetReflection`]; across the boundary, with η = η_i / η_o,
/// f = (1 − F) D G₂ |wo·h| |wi·h| η² / (|cos θo cos θi| (wo·h + η wi·h)²) for importance, 1/η² of that for radiance,
/// h ∝ ±(wo + η wi). Walter et al., EGSR 2007, equation 21, <https://doi.org/10.2312/EGWR/EGSR07/195-206>, with the G₂
/// of [`Distribution::g2`] where they multiply G₁ by G₁. The thesis's equation 5 halves the directions of
/// reflection only, and its equation 14 prints a redundant χ⁺ for reflection that is essential here: a facet
/// that faces away transmits nothing.
///
/// # Sampling
/// A visible normal, then reflection with probability F, else refraction; the weights are G₂ / G₁ ≤ 1.
///
/// # Limits
/// Energy that leaves after several bounces is lost, three to four times more from inside: GGX at α = 0.3,
/// η = 1.5 and 0° loses 1.2 % entering and 10.1 % leaving (the darkening of the thesis's Figure 8). Where the refracted lobe is
/// narrower than [`ALPHA_MIN`], α |1 − 1/η|, the boundary counts as smooth: η = 1 passes straight through.
///
/// # Example
/// ```
/// use gonio::bxdf::{Bxdf, TransportMode};
/// use gonio::{lobe::MicrofacetDielectric, microfacet::{Distribution, Shape}};
/// let frosted = MicrofacetDielectric::new(Distribution::new(Shape::Ggx, 0.3_f64, 0.3)?, 1.5)?;
/// let (above, below) = (glam::DVec3::Z, glam::DVec3::NEG_Z);
/// let radiance = frosted.eval(above, below, TransportMode::Radiance)[0];
/// let importance = frosted.eval(above, below, TransportMode::Importance)[0];
/// assert!((importance / radiance - 2.25).abs() < 1e-14);
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct MicrofacetDielectric<F> {
    distribution: Distribution<F>,
    smooth: DielectricSpecular<F>,
    is_smooth: bool,
}

impl<F: Real> MicrofacetDielectric<F> {
    /// A rough boundary with the given index of refraction below the surface over the index above, in
    /// \[0.001, 1000\].
    pub fn new(distribution: Distribution<F>, eta: F) -> Result<Self, OutOfRange> {
        let smooth = DielectricSpecular::new(eta)?;
        // Seen from the denser side the refracted lobe is narrower: both sides must agree.
        let bend = (F::ONE - eta).abs() / eta.max(F::ONE);
        let is_smooth =
            distribution.is_smooth() || distribution.largest_alpha() * bend < F::from_f64(ALPHA_MIN);
        Ok(Self { distribution, smooth, is_smooth })
    }

    /// The same boundary with its reflection and its transmission coloured, each \[0, 1\] per channel.
    pub fn with_tints(self, reflection: Rgb<F>, transmission: Rgb<F>) -> Result<Self, OutOfRange> {
        Ok(Self { smooth: self.smooth.with_tints(reflection, transmission)?, ..self })
    }

    /// Colours of reflection and transmission.
    pub fn tints(&self) -> [Rgb<F>; 2] {
        self.smooth.tints()
    }

    /// `true` if neither reflection nor transmission is coloured.
    pub fn is_lossless(&self) -> bool {
        self.smooth.is_lossless()
    }

    /// The distribution of micro normals.
    pub fn distribution(&self) -> &Distribution<F> {
        &self.distribution
    }

    /// Index below the surface over the index above.
    pub fn eta(&self) -> F {
        self.smooth.eta()
    }

    /// The same boundary in double precision, for integrals.
    pub(crate) fn to_f64(&self) -> MicrofacetDielectric<f64> {
        MicrofacetDielectric {
            distribution: self.distribution.to_f64(),
            smooth: self.smooth.to_f64(),
            is_smooth: self.is_smooth,
        }
    }

    /// Directional albedos of single scattering without tints, and the mean of F over the visible normals, for
    /// directions of the given cosine on one side (`side` = 1: from above, −1: from below).
    ///
    /// An anisotropic distribution is averaged over the azimuth.
    pub(crate) fn single_scattering(&self, cos_theta: f64, side: f64) -> SingleScattering {
        let eta = if side > 0.0 { self.eta() } else { F::ONE / self.eta() };
        let [reflected, transmitted, fresnel] =
            self.distribution.average_over_visible(cos_theta, [12, 8], |wo, wm| {
                let cos_theta_o = wo.dot(wm).max(F::ZERO);
                let boundary = boundary_of::<F>(wo, wm, self.eta(), side > 0.0);
                let reflectance = boundary.reflectance.unpolarized();
                let wi = reflect::<F>(wo, wm);
                let reflected = if is_above::<F>(wi) {
                    reflectance * self.distribution.reflection_about(wo, wi, wm).weight
                } else {
                    F::ZERO
                };
                let wi = refract::<F>(wo, wm, cos_theta_o, &boundary, eta);
                let transmittance = boundary.transmittance.unpolarized();
                let transmitted = if is_above::<F>(-wi) && transmittance > F::ZERO {
                    let facet = RefractingFacet::sampled(wm, cos_theta_o, boundary.cos_theta_t, self.eta(), side > 0.0);
                    transmittance * self.distribution.transmission(wo, wi, &facet).weight
                } else {
                    F::ZERO
                };
                [reflected, transmitted, reflectance].map(F::to_f64)
            });
        SingleScattering { reflected, transmitted, fresnel }
    }

    /// The side that `wo` is on: the sign that brings directions above the surface, and the index of the other side.
    #[inline]
    fn side(&self, wo: F::Vec3) -> Option<(F, F)> {
        if is_above::<F>(wo) {
            Some((F::ONE, self.eta()))
        } else if is_above::<F>(-wo) {
            Some((-F::ONE, F::ONE / self.eta()))
        } else {
            None
        }
    }

    /// The facet that refracts `wo` into `wi`, both turned by `sign` so that `wo` lies above.
    #[inline]
    fn facet_between(&self, wo: F::Vec3, wi: F::Vec3, sign: F) -> Option<RefractingFacet<F>> {
        is_above::<F>(-wi).then(|| RefractingFacet::between(wo, wi, self.eta(), sign > F::ZERO)).flatten()
    }
}

/// What single scattering does with light of one direction, as fractions of it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SingleScattering {
    pub(crate) reflected: f64,
    pub(crate) transmitted: f64,
    /// Reflected by the facets that are met first, before shadowing.
    pub(crate) fresnel: f64,
}

/// The Fresnel terms of a facet, the same from both sides: from the smaller cosine, because the larger one does not have
/// the digits of its distance from the critical angle.
#[inline]
fn boundary_across<F: Real>(facet: &RefractingFacet<F>, eta: F, from_above: bool) -> DielectricBoundary<F> {
    let from_denser = facet.cos_theta_t < facet.cos_theta_o;
    let c = if from_denser { facet.cos_theta_t } else { facet.cos_theta_o };
    dielectric_from(c, (F::ONE - c) * (F::ONE + c), eta, from_above != from_denser)
}

/// The Fresnel terms of the facet `wm` for `wo`; `eta` is the index below the surface over that above.
#[inline]
fn boundary_of<F: Real>(wo: F::Vec3, wm: F::Vec3, eta: F, from_above: bool) -> DielectricBoundary<F> {
    dielectric_from(wo.dot(wm).max(F::ZERO), sin2_between::<F>(wo, wm), eta, from_above)
}

/// [`boundary_of`] the facet that reflects `wo` into `wi`.
#[inline]
fn boundary_between<F: Real>(
    wo: F::Vec3,
    wi: F::Vec3,
    cos_theta_o: F,
    eta: F,
    from_above: bool,
) -> DielectricBoundary<F> {
    let half = (wo - wi) * F::HALF;
    dielectric_from(cos_theta_o, half.dot(half), eta, from_above)
}

/// The direction into which the facet `wm` refracts `wo`; normalised, because 1/η multiplies what rounding has left of
/// both.
#[inline]
fn refract<F: Real>(
    wo: F::Vec3,
    wm: F::Vec3,
    cos_theta_o: F,
    boundary: &DielectricBoundary<F>,
    eta: F,
) -> F::Vec3 {
    (wm * (cos_theta_o / eta - boundary.cos_theta_t) - wo * (F::ONE / eta)).normalize()
}

impl<F: Real> Bxdf<F> for MicrofacetDielectric<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
        let Some((sign, eta)) = self.side(wo).filter(|_| !self.is_smooth) else { return Rgb::BLACK };
        let (wo, wi) = (wo * sign, wi * sign);
        if is_above::<F>(wi) {
            let facet = self.distribution.reflection(wo, wi);
            let boundary = boundary_between::<F>(wo, wi, facet.cos_theta_o(), self.eta(), sign > F::ZERO);
            return self.smooth.tints()[0] * (boundary.reflectance.unpolarized() * facet.value);
        }
        let Some(facet) = self.facet_between(wo, wi, sign) else { return Rgb::BLACK };
        let transmittance = boundary_across(&facet, self.eta(), sign > F::ZERO).transmittance.unpolarized();
        let value = self.distribution.transmission(wo, wi, &facet).value;
        self.smooth.tints()[1] * (transmittance * value * squeeze(eta, mode))
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, _: TransportMode) -> F {
        let Some((sign, _)) = self.side(wo).filter(|_| !self.is_smooth) else { return F::ZERO };
        let (wo, wi) = (wo * sign, wi * sign);
        if is_above::<F>(wi) {
            let (pdf, cos2_theta_o) = self.distribution.reflection_pdf(wo, wi);
            let boundary =
                boundary_between::<F>(wo, wi, cos2_theta_o.sqrt(), self.eta(), sign > F::ZERO);
            return pdf * self.smooth.shares(&boundary)[0];
        }
        self.facet_between(wo, wi, sign).map_or(F::ZERO, |facet| {
            let boundary = boundary_across(&facet, self.eta(), sign > F::ZERO);
            self.distribution.transmission_pdf(wo, &facet) * self.smooth.shares(&boundary)[1]
        })
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        if self.is_smooth {
            return self.smooth.sample(wo, uc, u, mode);
        }
        let (sign, eta) = self.side(wo)?;
        let wo = wo * sign;
        let (wm, uc) = self.distribution.sample_visible(wo, uc, u)?;
        let cos_theta_o = wo.dot(wm).max(F::ZERO);
        let boundary = boundary_of::<F>(wo, wm, self.eta(), sign > F::ZERO);
        let [reflected, transmitted] = self.smooth.shares(&boundary);
        if uc < reflected {
            let wi = renormalize::<F>(reflect::<F>(wo, wm));
            if !is_above::<F>(wi) {
                return None;
            }
            let facet = self.distribution.reflection_about(wo, wi, wm);
            let reflectance = boundary.reflectance.unpolarized() / reflected;
            return Some(BxdfSample {
                wi: wi * sign,
                weight: self.smooth.tints()[0] * (reflectance * facet.weight),
                pdf: Pdf::SolidAngle(reflected * facet.pdf),
                eta: F::ONE,
            });
        }
        let wi = refract::<F>(wo, wm, cos_theta_o, &boundary, eta);
        if !is_above::<F>(-wi) || transmitted <= F::ZERO {
            return None;
        }
        let facet = RefractingFacet::sampled(wm, cos_theta_o, boundary.cos_theta_t, self.eta(), sign > F::ZERO);
        let facet = self.distribution.transmission(wo, wi, &facet);
        let transmittance = boundary.transmittance.unpolarized() / transmitted * squeeze(eta, mode);
        Some(BxdfSample {
            wi: wi * sign,
            weight: self.smooth.tints()[1] * (transmittance * facet.weight),
            pdf: Pdf::SolidAngle(transmitted * facet.pdf),
            eta,
        })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        self.smooth.albedo(wo)
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: true, is_delta: self.is_smooth }
    }
}

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode, squeeze};
use crate::frame::{is_above, mirror, sin2_theta};
use crate::fresnel::{DielectricBoundary, dielectric_from, require_eta};
use crate::parameter::{OutOfRange, require_fractions};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Reflection and refraction at a smooth boundary of dielectrics, from both sides.
///
/// # Definition
/// Two Dirac deltas: the mirrored direction with R(θ; η) and, unless total internal reflection leaves
/// nothing, the refracted direction with T = 1 − R ([`crate::fresnel::dielectric`]; thesis §4.1.4). The
/// thesis does not mention the η² that radiance gains or loses at the boundary: the transmitted weight
/// is 1/η² for [`TransportMode::Radiance`], 1 for [`TransportMode::Importance`].
/// Tints multiply R and T per channel; the thesis's glass has one of each, the physical boundary none.
///
/// # Sampling
/// Reflects where `uc` < q. Without tints q = R, and both weights are then constants. With tints R and T are
/// each multiplied by the largest channel of its tint, and q is the share of the first.
///
/// # Limits
/// η = 1 passes every direction straight through.
///
/// # Example
/// ```
/// use gonio::{bxdf::{Bxdf, Pdf, TransportMode}, lobe::DielectricSpecular};
/// let glass = DielectricSpecular::new(1.5_f64)?;
/// let sample = glass.sample(glam::DVec3::Z, 0.0, [0.0; 2], TransportMode::Radiance).unwrap();
/// assert!(matches!(sample.pdf, Pdf::Discrete(r) if (r - 0.04).abs() < 1e-15));
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct DielectricSpecular<F> {
    eta: F,
    tints: [Rgb<F>; 2],
    /// The largest channel of each tint.
    largest: [F; 2],
}

impl<F: Real> DielectricSpecular<F> {
    /// A boundary with the given index of refraction below the surface over the index above, in \[0.001, 1000\].
    pub fn new(eta: F) -> Result<Self, OutOfRange> {
        Ok(Self { eta: require_eta(eta)?, tints: [Rgb::WHITE; 2], largest: [F::ONE; 2] })
    }

    /// The same boundary with its reflection and its transmission coloured, each \[0, 1\] per channel.
    ///
    /// Physics has no such colours; they stand for what a thin surface layer absorbs (thesis §4.1.4).
    pub fn with_tints(self, reflection: Rgb<F>, transmission: Rgb<F>) -> Result<Self, OutOfRange> {
        let tints = [
            require_fractions("reflection tint", reflection)?,
            require_fractions("transmission tint", transmission)?,
        ];
        let largest = tints.map(|tint| tint[0].max(tint[1]).max(tint[2]));
        Ok(Self { tints, largest, ..self })
    }

    /// The same boundary in double precision.
    pub(crate) fn to_f64(&self) -> DielectricSpecular<f64> {
        DielectricSpecular {
            eta: self.eta.to_f64(),
            tints: self.tints.map(|tint| Rgb(tint.to_f64())),
            largest: self.largest.map(F::to_f64),
        }
    }

    /// Index below the surface over the index above.
    pub fn eta(&self) -> F {
        self.eta
    }

    /// Colours of reflection and transmission.
    pub fn tints(&self) -> [Rgb<F>; 2] {
        self.tints
    }

    /// `true` if neither reflection nor transmission is coloured.
    pub fn is_lossless(&self) -> bool {
        self.tints == [Rgb::WHITE; 2]
    }

    /// The Fresnel terms of a direction.
    #[inline]
    fn boundary(&self, wo: F::Vec3) -> DielectricBoundary<F> {
        dielectric_from(wo.z().abs(), sin2_theta::<F>(wo), self.eta, wo.z() > F::ZERO)
    }

    /// Probabilities of reflection and of transmission: what each carries, tint included.
    #[inline]
    pub(crate) fn shares(&self, boundary: &DielectricBoundary<F>) -> [F; 2] {
        let reflected = self.largest[0] * boundary.reflectance.unpolarized();
        let transmitted = self.largest[1] * boundary.transmittance.unpolarized();
        if self.is_lossless() {
            // R + T = 1 is kept as it is.
            return [reflected, transmitted];
        }
        let sum = reflected + transmitted;
        if sum > F::ZERO { [reflected / sum, transmitted / sum] } else { [F::ZERO; 2] }
    }
}

/// The refracted direction.
///
/// Near the normal its cosine comes from the sines: the one above has lost the digits that a rarer medium below brings out,
/// where the tangential components are multiplied by 1/η.
#[inline]
fn refract<F: Real>(wo: F::Vec3, boundary: &DielectricBoundary<F>, eta: F) -> F::Vec3 {
    let (x, y) = (wo.x() / eta, wo.y() / eta);
    let cos2_theta_t = F::ONE - (x * x + y * y);
    let towards = |cos_theta_t: F| F::Vec3::new(-x, -y, -cos_theta_t.copysign(wo.z()));
    if wo.z() * wo.z() > F::HALF && cos2_theta_t > F::ZERO {
        return towards(cos2_theta_t.sqrt());
    }
    // Next to total internal reflection rounding decides whether there is any: the sines may say so where the cosine does not.
    towards(boundary.cos_theta_t).normalize()
}

impl<F: Real> Bxdf<F> for DielectricSpecular<F> {
    #[inline]
    fn eval(&self, _: F::Vec3, _: F::Vec3, _: TransportMode) -> Rgb<F> {
        Rgb::BLACK
    }

    #[inline]
    fn pdf(&self, _: F::Vec3, _: F::Vec3, _: TransportMode) -> F {
        F::ZERO
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, _: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let from_above = is_above::<F>(wo);
        if !from_above && !is_above::<F>(-wo) {
            return None;
        }
        let eta = if from_above { self.eta } else { F::ONE / self.eta };
        let boundary = self.boundary(wo);
        let [reflected, transmitted] = self.shares(&boundary);
        if uc < reflected {
            return Some(BxdfSample {
                wi: mirror::<F>(wo),
                weight: self.tints[0] * (boundary.reflectance.unpolarized() / reflected),
                pdf: Pdf::Discrete(reflected),
                eta: F::ONE,
            });
        }
        let weight = self.tints[1] * (boundary.transmittance.unpolarized() / transmitted);
        (transmitted > F::ZERO).then(|| BxdfSample {
            wi: refract::<F>(wo, &boundary, eta),
            weight: weight * squeeze(eta, mode),
            pdf: Pdf::Discrete(transmitted),
            eta,
        })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        let boundary = self.boundary(wo);
        self.tints[0] * boundary.reflectance.unpolarized()
            + self.tints[1] * boundary.transmittance.unpolarized()
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: true, is_delta: true }
    }
}

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, mirror};
use crate::fresnel::{dielectric, require_eta};
use crate::parameter::OutOfRange;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Reflection and refraction at a smooth boundary of dielectrics, from both sides.
///
/// # Definition
/// Two Dirac deltas: the mirrored direction with R(θ; η) and, unless total internal reflection leaves
/// nothing, the refracted direction with T = 1 − R ([`crate::fresnel::dielectric`]; thesis §4.1.4). The
/// thesis does not mention the η² that radiance gains or loses at the boundary: the transmitted weight
/// is 1/η² for [`TransportMode::Radiance`], 1 for [`TransportMode::Importance`].
///
/// # Sampling
/// Reflects where `uc` < R; both weights are then constants.
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
}

impl<F: Real> DielectricSpecular<F> {
    /// A boundary with the given index of refraction below the surface over the index above.
    pub fn new(eta: F) -> Result<Self, OutOfRange> {
        Ok(Self { eta: require_eta(eta)? })
    }

    /// Index below the surface over the index above.
    pub fn eta(&self) -> F {
        self.eta
    }
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
        let boundary = dielectric(wo.z().abs(), eta);
        let reflectance = boundary.reflectance.unpolarized();
        if uc < reflectance {
            return Some(BxdfSample {
                wi: mirror::<F>(wo),
                weight: Rgb::WHITE,
                pdf: Pdf::Discrete(reflectance),
                eta: F::ONE,
            });
        }
        let weight = match mode {
            TransportMode::Radiance => F::ONE / (eta * eta),
            TransportMode::Importance => F::ONE,
        };
        Some(BxdfSample {
            wi: F::Vec3::new(-wo.x() / eta, -wo.y() / eta, -boundary.cos_theta_t.copysign(wo.z())),
            weight: Rgb::splat(weight),
            pdf: Pdf::Discrete(boundary.transmittance.unpolarized()),
            eta,
        })
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: true, is_delta: true }
    }
}

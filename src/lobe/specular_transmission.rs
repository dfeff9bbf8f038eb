use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::is_above;
use crate::parameter::{OutOfRange, require_fractions};
use crate::real::Real;
use crate::rgb::Rgb;

/// Ideal transmission: light passes straight through, from both sides.
///
/// # Definition
/// A Dirac delta at `wi` = −`wo` with the weight T per channel (thesis §4.1.3, which has T = 1). The media on
/// the two sides have the same index of refraction, so there is no η² in either transport mode.
///
/// # Limits
/// What is not transmitted is absorbed. The boundary that refracts is [`crate::lobe::DielectricSpecular`],
/// the sheet with its two reflections [`crate::lobe::ThinSheet`].
///
/// # Example
/// ```
/// use gonio::{bxdf::{Bxdf, TransportMode}, lobe::SpecularTransmission, rgb::Rgb};
/// let filter = SpecularTransmission::new(Rgb([0.9_f64, 0.5, 0.1]))?;
/// let wo = glam::DVec3::new(0.6, 0.0, 0.8);
/// let sample = filter.sample(wo, 0.0, [0.0; 2], TransportMode::Radiance).unwrap();
/// assert_eq!((sample.wi, sample.weight), (-wo, Rgb([0.9, 0.5, 0.1])));
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct SpecularTransmission<F> {
    transmittance: Rgb<F>,
}

impl<F: Real> SpecularTransmission<F> {
    /// A surface that transmits the given fraction, \[0, 1\] per channel.
    pub fn new(transmittance: Rgb<F>) -> Result<Self, OutOfRange> {
        Ok(Self { transmittance: require_fractions("transmittance", transmittance)? })
    }

    /// Fraction transmitted, per channel.
    pub fn transmittance(&self) -> Rgb<F> {
        self.transmittance
    }
}

impl<F: Real> Bxdf<F> for SpecularTransmission<F> {
    #[inline]
    fn eval(&self, _: F::Vec3, _: F::Vec3, _: TransportMode) -> Rgb<F> {
        Rgb::BLACK
    }

    #[inline]
    fn pdf(&self, _: F::Vec3, _: F::Vec3, _: TransportMode) -> F {
        F::ZERO
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, _: F, _: [F; 2], _: TransportMode) -> Option<BxdfSample<F>> {
        (is_above::<F>(wo) || is_above::<F>(-wo)).then(|| BxdfSample {
            wi: -wo,
            weight: self.transmittance,
            pdf: Pdf::Discrete(F::ONE),
            eta: F::ONE,
        })
    }

    fn albedo(&self, _: F::Vec3) -> Rgb<F> {
        self.transmittance
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: false, transmits: true, is_delta: true }
    }
}

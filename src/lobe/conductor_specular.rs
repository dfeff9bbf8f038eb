use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, mirror};
use crate::fresnel::Fresnel;
use crate::parameter::OutOfRange;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Mirror reflection at a smooth conductor, from above only.
///
/// # Definition
/// A Dirac delta at the mirrored direction with weight R(θ; η, k), exact per channel
/// ([`crate::fresnel::conductor`]; thesis §4.1.5).
///
/// # Limits
/// A direction below the surface scatters nothing: light does not leave a conductor.
///
/// # Example
/// ```
/// use gonio::{bxdf::{Bxdf, TransportMode}, lobe::ConductorSpecular, rgb::Rgb};
/// let chrome = ConductorSpecular::new(Rgb([3.145_f64, 3.034, 2.456]), Rgb([3.312, 3.330, 3.210]))?;
/// let sample = chrome.sample(glam::DVec3::Z, 0.0, [0.0; 2], TransportMode::Radiance).unwrap();
/// assert!((sample.weight[0] - 0.553).abs() < 1e-3);
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct ConductorSpecular<F> {
    fresnel: Fresnel<F>,
}

impl<F: Real> ConductorSpecular<F> {
    /// A conductor of complex index `eta` + i `k` per channel, relative to the medium above.
    pub fn new(eta: Rgb<F>, k: Rgb<F>) -> Result<Self, OutOfRange> {
        Ok(Self { fresnel: Fresnel::conductor(eta, k)? })
    }

    /// The Fresnel term.
    pub fn fresnel(&self) -> Fresnel<F> {
        self.fresnel
    }
}

impl<F: Real> Bxdf<F> for ConductorSpecular<F> {
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
        is_above::<F>(wo).then(|| BxdfSample {
            wi: mirror::<F>(wo),
            weight: self.fresnel.reflectance(wo.z()),
            pdf: Pdf::Discrete(F::ONE),
            eta: F::ONE,
        })
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: true }
    }
}

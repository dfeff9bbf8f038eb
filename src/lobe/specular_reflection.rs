use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, Pdf, TransportMode};
use crate::frame::{is_above, mirror};
use crate::fresnel::Fresnel;
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

/// Mirror reflection at a smooth surface, from above only.
///
/// # Definition
/// A Dirac delta at the mirrored direction with the weight of the Fresnel term: a constant is the ideal mirror
/// (thesis §4.1.3), [`Fresnel::Conductor`] a smooth metal, exact per channel (thesis §4.1.5), and
/// [`Fresnel::Dielectric`] the gloss of a smooth coat whose base is another component.
///
/// # Limits
/// A direction below the surface scatters nothing. The boundary that transmits as well is
/// [`crate::lobe::DielectricSpecular`].
///
/// # Example
/// ```
/// use gonio::bxdf::{Bxdf, TransportMode};
/// use gonio::{fresnel::Fresnel, lobe::SpecularReflection, rgb::Rgb};
/// let chrome = Fresnel::conductor(Rgb([3.145_f64, 3.034, 2.456]), Rgb([3.312, 3.330, 3.210]))?;
/// let mirror = SpecularReflection::new(chrome);
/// let sample = mirror.sample(glam::DVec3::Z, 0.0, [0.0; 2], TransportMode::Radiance).unwrap();
/// assert!((sample.weight[0] - 0.553).abs() < 1e-3);
/// # Ok::<(), gonio::parameter::OutOfRange>(())
/// ```
#[derive(Clone, Debug)]
pub struct SpecularReflection<F> {
    fresnel: Fresnel<F>,
}

impl<F: Real> SpecularReflection<F> {
    /// A mirror with the given reflectance.
    pub fn new(fresnel: Fresnel<F>) -> Self {
        Self { fresnel }
    }

    /// The Fresnel term.
    pub fn fresnel(&self) -> Fresnel<F> {
        self.fresnel
    }
}

impl<F: Real> Bxdf<F> for SpecularReflection<F> {
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

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        if is_above::<F>(wo) { self.fresnel.reflectance(wo.z()) } else { Rgb::BLACK }
    }

    fn flags(&self) -> LobeFlags {
        LobeFlags { reflects: true, transmits: false, is_delta: true }
    }
}

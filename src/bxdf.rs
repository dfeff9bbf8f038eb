//! The trait that every lobe implements. Start reading here.
//!
//! Conventions: local frame with n = +z; `wo` is given, `wi` is sampled, both have unit length and leave the
//! surface; `eval` is without the cosine; `eta` of a sample is the index of the side entered over the side
//! left.

use core::fmt::Debug;

use crate::real::Real;
use crate::rgb::Rgb;

/// What is carried along a path, and with it who carries the η² of refraction.
///
/// `eval(wo, wi, Importance) = eval(wi, wo, Radiance)`: light that refracts from index 1 into η is squeezed
/// into a smaller solid angle, so radiance changes by η² and importance does not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TransportMode {
    /// From the camera: `wi` is where radiance comes from.
    Radiance,
    /// From a light: `wi` is where power goes.
    Importance,
}

/// What refraction makes of f where `eta` is the index of the side entered over the side left: 1/η² of radiance, 1
/// of importance.
#[inline]
pub(crate) fn squeeze<F: Real>(eta: F, mode: TransportMode) -> F {
    match mode {
        TransportMode::Radiance => F::ONE / (eta * eta),
        TransportMode::Importance => F::ONE,
    }
}

/// The density of a sample, in the measure that it was drawn from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Pdf<F> {
    /// A density over solid angle \[sr⁻¹\], equal to `pdf(wo, wi)`.
    SolidAngle(F),
    /// The probability of a Dirac delta, (0, 1\].
    Discrete(F),
}

/// A sampled direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BxdfSample<F: Real> {
    /// The sampled direction.
    pub wi: F::Vec3,
    /// f · |cos θi| / pdf, what a path multiplies its throughput by; finite for delta lobes too.
    pub weight: Rgb<F>,
    /// Density in its measure.
    pub pdf: Pdf<F>,
    /// Index of refraction of the side entered over the side left; 1 for reflection.
    pub eta: F,
}

/// What a lobe can do, for integrators that treat kinds of scattering differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LobeFlags {
    /// Scatters to the side of `wo`.
    pub reflects: bool,
    /// Scatters to the other side.
    pub transmits: bool,
    /// Scatters into Dirac deltas only: `eval` and `pdf` are 0.
    pub is_delta: bool,
}

/// A bidirectional scattering distribution function with its sampling.
///
/// Implementations are pure: no randomness, no globals, no allocation.
pub trait Bxdf<F: Real>: Debug + Send + Sync {
    /// f(wo, wi) \[sr⁻¹\], without the cosine. Zero where scattering is a Dirac delta.
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F>;
    /// Density \[sr⁻¹\] with which `sample` draws `wi`, given `wo`. Zero where it is a Dirac delta.
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> F;
    /// Draws `wi` from uniforms in \[0, 1): `uc` picks a component, `u` the direction in it.
    ///
    /// `None` takes whatever probability the density and the delta masses leave; it contributes nothing and
    /// counts in the denominator of an estimate.
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>>;
    /// The fraction of the light arriving from `wo` that is scattered anywhere, as far as it is cheap to know.
    ///
    /// A stack picks its components in proportion: an error here costs noise, not correctness.
    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        let _ = wo;
        Rgb::WHITE
    }
    /// What the lobe can do.
    fn flags(&self) -> LobeFlags;
}

//! Car paint (thesis §4.2.7): a coat over metal, whose index is divided by that of the coat.
//!
//! The thesis gives the base a colour c besides its index; here colour is the index's and the coat's.

use super::parameter::Values;
use super::{Build, DISTRIBUTION, MaterialError, Parameter, Rule, alpha, coat, metal, reflection};
use crate::real::Real;

static COAT: [Parameter; 5] = coat::parameters(0.0);

pub(super) const PARAMETERS: &[Parameter] = &[
    metal::IOR,
    metal::REDUCTION,
    metal::ETA,
    metal::K,
    alpha(0.3),
    metal::ANISOTROPY,
    metal::ROTATION,
    DISTRIBUTION,
    coat::group(&COAT),
];

pub(super) const RULES: &[Rule] = metal::RULES;

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    let (fresnel, distribution) = (metal::fresnel::<F>(values)?, metal::distribution(values)?);
    let lobes = coat::over(values, |eta| Ok(reflection(distribution, fresnel.immersed(eta)?)))?;
    metal::turned(Build::isotropic(lobes)?, &distribution, values)
}

//! Plastic (thesis §4.2.6): a coat over a diffuse base. Rubber, ceramic and varnished wood are the same.

use super::parameter::Values;
use super::{Build, MaterialError, Parameter, Rule, coat, matte};
use crate::real::Real;

static COAT: [Parameter; 5] = coat::parameters(0.1);

pub(super) const PARAMETERS: &[Parameter] =
    &[matte::REFLECTANCE, matte::SIGMA, matte::DIFFUSE, coat::group(&COAT)];

pub(super) const RULES: &[Rule] = matte::RULES;

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    Build::isotropic(coat::over(values, |_| matte::lobe(values))?)
}

//! Mirror (thesis §4.2.3): ideal specular reflection, the same at every angle.

use super::parameter::Values;
use super::{Build, MaterialError, Norm, Parameter, ParameterKind, Rule, Value};
use crate::fresnel::Fresnel;
use crate::lobe::SpecularReflection;
use crate::real::Real;

pub(super) const PARAMETERS: &[Parameter] = &[Parameter {
    id: "reflectance",
    label: "reflectance R",
    kind: ParameterKind::Colour,
    default: Some(Value::Number(0.95)),
    norm: Some(Norm {
        range: [0.5, 0.99],
        source: "from stainless steel to silver; at 1 paths between two mirrors never end",
    }),
    unit: "",
    doc: "Share of the light that the mirror returns; 1 is an ideal one.",
}];

pub(super) const RULES: &[Rule] = &[];

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    Build::isotropic([SpecularReflection::new(Fresnel::constant(values.colour("reflectance")?)?).into()])
}

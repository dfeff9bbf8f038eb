//! Fabric (thesis §4.3, which prints no formula): diffuse reflection that favours the way back.

use super::matte::REFLECTANCE;
use super::parameter::Values;
use super::{Build, MaterialError, Norm, Parameter, ParameterKind, Rule, Value};
use crate::lobe;
use crate::real::Real;

pub(super) const PARAMETERS: &[Parameter] = &[
    REFLECTANCE,
    Parameter {
        id: "backscatter",
        label: "share of backscatter b",
        kind: ParameterKind::Number { range: [0.0, 1.0] },
        default: Some(Value::Number(0.5)),
        norm: Some(Norm { range: [0.0, 0.9], source: "ours: at 1 little is scattered forward" }),
        unit: "",
        doc: "Share of the reflected light that favours the way back; 0 is Lambertian.",
    },
    Parameter {
        id: "exponent",
        label: "exponent p of the backscatter",
        kind: ParameterKind::OneOf { numbers: &[1.0, 2.0, 4.0, 8.0, 16.0] },
        default: Some(Value::Number(4.0)),
        norm: None,
        unit: "",
        doc: "The larger, the narrower the lobe about the way back.",
    },
];

pub(super) const RULES: &[Rule] = &[];

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    let exponent = values.number::<f64>("exponent")? as u32;
    let fabric = lobe::Fabric::new(values.colour("reflectance")?, values.number("backscatter")?, exponent)?;
    Build::isotropic([fabric.into()])
}

//! Thin glass: a sheet modelled by a single face. The thesis uses it in §5.5 (Figure 14) and does not present
//! it.

use super::glass::ETA;
use super::parameter::Values;
use super::{Build, MaterialError, Parameter, ParameterKind, Value};
use crate::lobe::ThinSheet;
use crate::real::Real;

pub(super) const PARAMETERS: &[Parameter] = &[
    ETA,
    Parameter {
        id: "thickness",
        label: "thickness d",
        kind: ParameterKind::Number { range: [0.0, 1e9] },
        default: Some(Value::Number(1.0)),
        norm: None,
        unit: "length",
        doc: "Of the sheet, in the unit that absorbance is per. It moves nothing sideways.",
    },
    Parameter {
        id: "absorbance",
        label: "absorbance σ",
        kind: ParameterKind::Colour { range: [0.0, 1e9] },
        default: Some(Value::Number(0.0)),
        norm: None,
        unit: "1/length",
        doc: "Napierian absorption coefficient of the sheet.",
    },
    Parameter {
        id: "transmission",
        label: "transmission tint T",
        kind: ParameterKind::Colour { range: [0.0, 1.0] },
        default: Some(Value::Number(1.0)),
        norm: None,
        unit: "",
        doc: "Multiplies all transmitted light: the \"transmittance factor\" of the thesis's tinted windows.",
    },
];

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    let thickness: F = values.number("thickness")?;
    let optical_thickness = values.colour::<F>("absorbance")? * thickness;
    let sheet = ThinSheet::new(values.number("eta")?, optical_thickness, values.colour("transmission")?)?;
    Build::isotropic([sheet.into()])
}

//! Thin glass: a sheet modelled by a single face. The thesis uses it in §5.5 (Figure 14) and does not present
//! it.

use super::coat::thickness;
use super::glass::{ETA, absorbance, tint};
use super::parameter::Values;
use super::{Build, MaterialError, Parameter, Rule};
use crate::lobe::ThinSheet;
use crate::real::Real;

pub(super) const PARAMETERS: &[Parameter] = &[
    ETA,
    thickness(1.0, "Of the sheet, in the unit that absorbance is per. It moves nothing sideways."),
    absorbance("absorbance", "absorbance σ", "Napierian absorption coefficient of the sheet."),
    tint(
        "transmission",
        "transmission tint T",
        "Multiplies all transmitted light: the \"transmittance factor\" of the thesis's tinted windows.",
    ),
];

pub(super) const RULES: &[Rule] = &[];

/// The sheet that the parameters describe.
pub(super) fn sheet<F: Real>(values: &Values) -> Result<ThinSheet<F>, MaterialError> {
    let thickness: F = values.number("thickness")?;
    let optical_thickness = values.colour::<F>("absorbance")? * thickness;
    Ok(ThinSheet::new(values.number("eta")?, optical_thickness, values.colour("transmission")?)?)
}

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    Build::isotropic([sheet(values)?.into()])
}

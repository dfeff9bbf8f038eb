//! Glass and rough glass (thesis §4.2.4): reflection and refraction at the boundary, absorption on the way.

use super::parameter::Values;
use super::{
    Build, DISTRIBUTION, MaterialError, Norm, Parameter, ParameterKind, Rule, SCATTERING, Value, alpha,
    follows_all_orders, shape,
};
use crate::lobe::{DielectricSpecular, KullaContyDielectric, MicrofacetDielectric};
use crate::microfacet::Distribution;
use crate::real::Real;
use crate::rgb::Rgb;

pub(super) const ETA: Parameter = Parameter {
    id: "eta",
    label: "index of refraction η",
    kind: ParameterKind::Number { range: [1e-3, 1e3] },
    default: Some(Value::Number(1.5)),
    norm: Some(Norm { range: [1.3, 2.42], source: "from ice (Warren 2008) to diamond (Peter 1923)" }),
    unit: "",
    doc: "Index of the inside over that of the outside. Below 1: a bubble.",
};

/// A factor of light per channel.
pub(super) const fn tint(id: &'static str, label: &'static str, doc: &'static str) -> Parameter {
    Parameter {
        id,
        label,
        kind: ParameterKind::Colour,
        default: Some(Value::Number(1.0)),
        norm: None,
        unit: "",
        doc,
    }
}

/// A coefficient of absorption, 0 unless given.
pub(super) const fn absorbance(id: &'static str, label: &'static str, doc: &'static str) -> Parameter {
    Parameter {
        id,
        label,
        kind: ParameterKind::Channels { range: [0.0, 1e9] },
        default: Some(Value::Number(0.0)),
        norm: None,
        unit: "1/length",
        doc,
    }
}

pub(super) const PARAMETERS: &[Parameter] = &[
    ETA,
    tint("reflection", "reflection tint R", "Multiplies reflected light (thesis's R)."),
    tint("transmission", "transmission tint T", "Multiplies refracted light at every boundary (thesis's T)."),
    alpha(0.0),
    DISTRIBUTION,
    SCATTERING,
    absorbance(
        "absorbance_inside",
        "absorbance inside σi",
        "Napierian absorption coefficient of the inside: light keeps e^(-σ d) over a length d.",
    ),
    absorbance("absorbance_outside", "absorbance outside σt", "The same of the outside; normally 0."),
];

pub(super) const RULES: &[Rule] = &[orders_of_a_white_boundary];

/// Higher orders are tabulated for a boundary that loses nothing.
fn orders_of_a_white_boundary(values: &Values) -> Result<(), MaterialError> {
    for other in ["reflection", "transmission"] {
        if follows_all_orders(values)? && values.colour::<f64>(other)? != Rgb::WHITE {
            return Err(MaterialError::Contradiction {
                parameter: "scattering",
                other,
                reason: "higher orders are known for a boundary without tints only",
            });
        }
    }
    Ok(())
}

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    let (eta, alpha) = (values.number("eta")?, values.number("alpha")?);
    let tints = [values.colour("reflection")?, values.colour("transmission")?];
    let distribution = Distribution::new(shape(values, "distribution")?, alpha, alpha)?;
    let rough = MicrofacetDielectric::new(distribution, eta)?;
    let mut lobes = if distribution.is_smooth() {
        vec![DielectricSpecular::new(eta)?.with_tints(tints[0], tints[1])?.into()]
    } else {
        vec![rough.clone().with_tints(tints[0], tints[1])?.into()]
    };
    if follows_all_orders(values)? {
        lobes.push(KullaContyDielectric::new(&rough).into());
    }
    let absorbance = [values.colour("absorbance_outside")?, values.colour("absorbance_inside")?];
    Ok(Build { absorbance, ..Build::isotropic(lobes)? })
}

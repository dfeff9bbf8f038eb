//! The coat of plastic and of car paint: reflection at its interface, and a refractive layer over the base.

use std::sync::Arc;

use super::glass::absorbance;
use super::parameter::Values;
use super::{DISTRIBUTION, MaterialError, Norm, Parameter, ParameterKind, Value, alpha, reflection, shape};
use crate::fresnel::Fresnel;
use crate::lobe::{Coat, Lobe, RefractiveLayer};
use crate::microfacet::Distribution;
use crate::real::Real;

/// The thickness of a layer, in the length that its absorbance is per.
pub(super) const fn thickness(default: f64, doc: &'static str) -> Parameter {
    Parameter {
        id: "thickness",
        label: "thickness d",
        kind: ParameterKind::Number { range: [0.0, 1e9] },
        default: Some(Value::Number(default)),
        norm: None,
        unit: "length",
        doc,
    }
}

/// The members of the group, with the roughness that is usual for the material.
pub(super) const fn parameters(roughness: f64) -> [Parameter; 5] {
    [
        Parameter {
            id: "eta",
            label: "index of refraction η",
            kind: ParameterKind::Number { range: [1.0, 1e3] },
            default: Some(Value::Number(1.5)),
            norm: Some(Norm {
                range: [1.3, 1.7],
                source: "polymers and glazes; polystyrene (Sultanova 2009) has 1.59",
            }),
            unit: "",
            doc: "Index of the coat over that of the outside; a higher one makes it more reflective.",
        },
        thickness(0.0, "In the unit of absorbance; the thesis has none. Only d σ matters: 3 hides the base."),
        absorbance(
            "absorbance",
            "absorbance σ",
            "Napierian absorption coefficient, along the refracted way through the coat.",
        ),
        alpha(roughness),
        DISTRIBUTION,
    ]
}

/// The group.
pub(super) const fn group(parameters: &'static [Parameter]) -> Parameter {
    Parameter {
        id: "coat",
        label: "coat",
        kind: ParameterKind::Group { parameters },
        default: None,
        norm: None,
        unit: "",
        doc: "A layer of a dielectric over the base (thesis 4.1.9).",
    }
}

/// Gloss and layer over what `base` makes of the index of the coat.
pub(super) fn over<F: Real>(
    values: &Values,
    base: impl FnOnce(F) -> Result<Lobe<F>, MaterialError>,
) -> Result<[Lobe<F>; 2], MaterialError> {
    let (eta, alpha) = (values.number("coat.eta")?, values.number("coat.alpha")?);
    let distribution = Distribution::new(shape(values, "coat.distribution")?, alpha, alpha)?;
    let coat = Coat {
        eta,
        thickness: values.number("coat.thickness")?,
        sigma_a: values.colour("coat.absorbance")?,
        roughness: Some(distribution),
    };
    let gloss = reflection(distribution, Fresnel::dielectric(eta)?);
    Ok([gloss, RefractiveLayer::new(coat, Arc::new(base(eta)?))?.into()])
}

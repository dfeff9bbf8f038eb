//! Matte (thesis §4.2.2): one diffuse lobe, from both sides.

use core::f64::consts::FRAC_PI_2;

use super::parameter::Values;
use super::{Build, Choice, MaterialError, Norm, Parameter, ParameterKind, Rule, Value};
use crate::lobe::{Lambertian, Lobe, OrenNayar, OrenNayarModel};
use crate::real::Real;

pub(super) const REFLECTANCE: Parameter = Parameter {
    id: "reflectance",
    label: "reflectance R",
    kind: ParameterKind::Colour,
    default: Some(Value::Number(0.5)),
    norm: Some(Norm { range: [0.02, 0.9], source: "albedos from coal to fresh snow" }),
    unit: "",
    doc: "Share of the light that a diffuse surface returns.",
};

pub(super) const SIGMA: Parameter = Parameter {
    id: "sigma_rad",
    label: "roughness σ",
    kind: ParameterKind::Number { range: [0.0, FRAC_PI_2] },
    default: Some(Value::Number(0.0)),
    norm: Some(Norm {
        range: [0.0, FULL_SIGMA],
        source: "beyond, the fit of Oren & Nayar (1994) is negative in places",
    }),
    unit: "rad",
    doc: "Standard deviation of the slope angle of facets, the thesis's r of matte. 0 is Lambertian.",
};

pub(super) const DIFFUSE: Parameter = Parameter {
    id: "diffuse",
    label: "model of a rough diffuser",
    kind: ParameterKind::Choice {
        choices: &[
            Choice {
                name: "qualitative",
                doc: "Oren-Nayar without interreflection (thesis); above 1 where R > 0.985",
            },
            Choice { name: "full", doc: "Oren-Nayar with interreflection, sigma_rad up to 0.66" },
            Choice { name: "energy_preserving", doc: "EON, with Fujii's r = B / A of the qualitative model" },
        ],
    },
    default: Some(Value::text("qualitative")),
    norm: None,
    unit: "",
    doc: "What sigma_rad means where it is not 0.",
};

pub(super) const PARAMETERS: &[Parameter] = &[REFLECTANCE, SIGMA, DIFFUSE];

/// The largest σ \[rad\] of the full model.
const FULL_SIGMA: f64 = 0.66;

pub(super) const RULES: &[Rule] = &[full_model];

/// The full model is a fit, and only where it was fitted.
fn full_model(values: &Values) -> Result<(), MaterialError> {
    let sigma: f64 = values.number("sigma_rad")?;
    if values.text("diffuse")? != "full" || sigma <= FULL_SIGMA {
        return Ok(());
    }
    Err(MaterialError::Unacceptable {
        parameter: SIGMA.id.to_owned(),
        value: sigma.to_string(),
        expected: format!("with diffuse = \"full\" a number in [0, {FULL_SIGMA}] [rad]"),
    })
}

/// The diffuse lobe that the parameters above describe.
pub(super) fn lobe<F: Real>(values: &Values) -> Result<Lobe<F>, MaterialError> {
    let reflectance = values.colour("reflectance")?;
    let sigma: F = values.number("sigma_rad")?;
    if sigma == F::ZERO {
        return Ok(Lambertian::new(reflectance)?.into());
    }
    let (model, roughness) = match values.text("diffuse")? {
        "full" => (OrenNayarModel::Full, sigma),
        "energy_preserving" => {
            let square = sigma * sigma;
            let a = F::ONE - F::HALF * square / (square + F::from_f64(0.33));
            let b = F::from_f64(0.45) * square / (square + F::from_f64(0.09));
            (OrenNayarModel::EnergyPreserving, b / a)
        }
        _ => (OrenNayarModel::Qualitative, sigma),
    };
    Ok(OrenNayar::new(model, reflectance, roughness)?.into())
}

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    Build::isotropic([lobe(values)?])
}

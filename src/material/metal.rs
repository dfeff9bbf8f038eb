//! Metal (thesis §4.2.5): a conductor by its index per channel, smooth or rough, isotropic or brushed.

use super::parameter::Values;
use super::{
    Build, Choice, DISTRIBUTION, MaterialError, Norm, Parameter, ParameterKind, Rule, SCATTERING, Value,
    alpha, follows_all_orders, reflection, shape,
};
use crate::fresnel::Fresnel;
use crate::ior::{self, IorError};
use crate::lobe::KullaContyReflection;
use crate::microfacet::Distribution;
use crate::real::Real;
use crate::rgb::Rgb;

pub(super) const IOR: Parameter = Parameter {
    id: "ior",
    label: "measured index",
    kind: ParameterKind::DataSet,
    default: Some(Value::text("aluminium/Rakic-1995")),
    norm: None,
    unit: "",
    doc: "Data set of η + ik over wavelength, relative to vacuum.",
};

pub(super) const REDUCTION: Parameter = Parameter {
    id: "reduction",
    label: "from wavelengths to channels",
    kind: ParameterKind::Choice {
        choices: &[
            Choice {
                name: "fitted",
                doc: "the index per channel that is closest to the colour in daylight, 0° to 88°",
            },
            Choice {
                name: "measured",
                doc: "the index at 630, 532 and 465 nm: values for specific wavelengths (thesis)",
            },
        ],
    },
    default: Some(Value::text("fitted")),
    norm: None,
    unit: "",
    doc: "How the data set becomes one complex index per channel.",
};

const fn part(id: &'static str, label: &'static str, norm: Norm, doc: &'static str) -> Parameter {
    Parameter {
        id,
        label,
        kind: ParameterKind::Channels { range: [0.0, 1e3] },
        default: None,
        norm: Some(norm),
        unit: "",
        doc,
    }
}

pub(super) const ETA: Parameter = part(
    "eta",
    "index of refraction η",
    Norm { range: [0.0, 4.0], source: "metals of reference-data/ior, 465 to 630 nm" },
    "Real part per channel, relative to vacuum: in place of a data set, together with k.",
);

pub(super) const K: Parameter = part(
    "k",
    "extinction k",
    Norm { range: [1.0, 10.0], source: "metals of reference-data/ior, 465 to 630 nm" },
    "Imaginary part per channel, together with eta.",
);

pub(super) const ANISOTROPY: Parameter = Parameter {
    id: "anisotropy",
    label: "anisotropy αy / αx",
    kind: ParameterKind::Number { range: [0.01, 100.0] },
    default: Some(Value::Number(1.0)),
    norm: Some(Norm { range: [0.1, 10.0], source: "ours: beyond, a highlight is a line" }),
    unit: "",
    doc: "αx = α / √ratio, αy = α √ratio, neither above 1; the thesis prints \"r_y/r/x\".",
};

pub(super) const ROTATION: Parameter = Parameter {
    id: "rotation_deg",
    label: "rotation of the tangents",
    kind: ParameterKind::Number { range: [-360.0, 360.0] },
    default: Some(Value::Number(0.0)),
    norm: None,
    unit: "°",
    doc: "From the surface's first tangent to the direction x of αx, about the normal (thesis 2.3.5).",
};

pub(super) const PARAMETERS: &[Parameter] =
    &[IOR, REDUCTION, ETA, K, alpha(0.1), ANISOTROPY, ROTATION, DISTRIBUTION, SCATTERING];

pub(super) const RULES: &[Rule] = &[one_index, index_of_a_substance, alphas_below_one];

/// An index is a data set or numbers, both of them.
fn one_index(values: &Values) -> Result<(), MaterialError> {
    let given = [ETA.id, K.id].into_iter().find(|id| values.is_given(id));
    let Some(other) = given else { return Ok(()) };
    if values.is_given(IOR.id) {
        let reason = "an index is a data set or numbers";
        return Err(MaterialError::Contradiction { parameter: IOR.id, other, reason });
    }
    Ok(())
}

/// αx and αy as the ratio divides them.
pub(super) fn alphas(values: &Values) -> Result<[f64; 2], MaterialError> {
    let (alpha, root) = (values.number::<f64>("alpha")?, values.number::<f64>(ANISOTROPY.id)?.sqrt());
    Ok([alpha / root, alpha * root])
}

fn alphas_below_one(values: &Values) -> Result<(), MaterialError> {
    if alphas(values)?.into_iter().all(|alpha| alpha <= 1.0) {
        return Ok(());
    }
    let alpha: f64 = values.number("alpha")?;
    let largest = 1.0 / (alpha * alpha);
    Err(MaterialError::Unacceptable {
        parameter: ANISOTROPY.id.to_owned(),
        value: values.number::<f64>(ANISOTROPY.id)?.to_string(),
        expected: format!(
            "with alpha = {alpha} a ratio in [{:.4}, {largest:.4}]: neither αx nor αy above 1",
            1.0 / largest
        ),
    })
}

/// Wavelengths of the channels where the reduction is `measured` \[nm\].
const WAVELENGTHS_NM: [f64; 3] = [630.0, 532.0, 465.0];

/// η and k of a data set per channel, `fitted` or `measured`.
fn reduced(name: &str, is_measured: bool) -> Result<[[f64; 3]; 2], IorError> {
    let table = ior::load(name)?;
    if !is_measured {
        let fitted = table.fitted_rgb()?;
        return Ok([fitted.eta, fitted.k]);
    }
    let mut channels = [[0.0; 3]; 2];
    for (channel, wavelength_nm) in WAVELENGTHS_NM.into_iter().enumerate() {
        let index = table.at(wavelength_nm)?;
        (channels[0][channel], channels[1][channel]) = (index.eta, index.k);
    }
    Ok(channels)
}

/// η and k of a data set per channel in every way there is, as far as it reaches.
pub(super) fn reductions(name: &str) -> [Option<[[f64; 3]; 2]>; 2] {
    [false, true].map(|is_measured| reduced(name, is_measured).ok())
}

/// η and k of the metal in vacuum per channel.
pub(super) fn index(values: &Values) -> Result<[[f64; 3]; 2], MaterialError> {
    if values.is_given(ETA.id) || values.is_given(K.id) {
        return Ok([values.colour::<f64>(ETA.id)?.0, values.colour::<f64>(K.id)?.0]);
    }
    let is_measured = values.text(REDUCTION.id)? == "measured";
    let source = |source| MaterialError::DataSet { parameter: IOR.id.to_owned(), source };
    reduced(values.text(IOR.id)?, is_measured).map_err(source)
}

/// A data set reaches over what is asked of it, numbers are those of a substance.
fn index_of_a_substance(values: &Values) -> Result<(), MaterialError> {
    // Which of two indices is meant must be known first.
    if one_index(values).is_err() {
        return Ok(());
    }
    let [eta, k] = index(values)?;
    match (0..3).find(|&channel| eta[channel] + k[channel] == 0.0) {
        None => Ok(()),
        Some(channel) => Err(MaterialError::Unacceptable {
            parameter: ETA.id.to_owned(),
            value: Value::Colour(eta).to_string(),
            expected: format!("eta + k > 0 in channel {}", ["red", "green", "blue"][channel]),
        }),
    }
}

/// The Fresnel term of the metal in vacuum.
pub(super) fn fresnel<F: Real>(values: &Values) -> Result<Fresnel<F>, MaterialError> {
    let [eta, k] = index(values)?.map(|part| Rgb(part.map(F::from_f64)));
    Ok(Fresnel::conductor(eta, k)?)
}

/// The micro surface of the metal.
pub(super) fn distribution<F: Real>(values: &Values) -> Result<Distribution<F>, MaterialError> {
    let [alpha_x, alpha_y] = alphas(values)?;
    Ok(Distribution::new(shape(values, "distribution")?, F::from_f64(alpha_x), F::from_f64(alpha_y))?)
}

/// The same build with its tangents where the parameters want them.
pub(super) fn turned<F: Real>(
    build: Build<F>,
    distribution: &Distribution<F>,
    values: &Values,
) -> Result<Build<F>, MaterialError> {
    if distribution.is_smooth() || distribution.is_isotropic() {
        return Ok(build);
    }
    let degrees: f64 = values.number("rotation_deg")?;
    let (sin, cos) = Real::sin_cos(degrees.to_radians());
    let turn = (degrees != 0.0).then_some([F::from_f64(cos), F::from_f64(sin)]);
    Ok(Build { turn, is_isotropic: false, ..build })
}

pub(super) fn build<F: Real>(values: &Values) -> Result<Build<F>, MaterialError> {
    let (fresnel, distribution) = (fresnel(values)?, distribution(values)?);
    let mut lobes = vec![reflection(distribution, fresnel)];
    if follows_all_orders(values)? {
        lobes.push(KullaContyReflection::new(distribution, fresnel).into());
    }
    turned(Build::isotropic(lobes)?, &distribution, values)
}

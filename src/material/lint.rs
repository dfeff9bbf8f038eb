//! What is possible and rarely meant: physics (G2xx) and plausibility (G3xx) of a description, without its lobes.

use serde::Serialize;

use super::{Description, MaterialError, Model, Value, flattened, matte, metal};
use crate::fresnel::normal_incidence;
use crate::ior::{self, Illuminant};
use crate::lobe::OrenNayarModel;
use crate::message::Code;
use crate::microfacet::ALPHA_MIN;
use crate::rgb::{Rgb, linear_to_srgb};

/// Whose idea of plausible colours a file is held against: published ranges disagree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Profile {
    /// The norms of the parameter tables: albedos of real surfaces, per channel.
    #[default]
    Measured,
    /// The PBR Guide, part 2 (Allegorithmic 2018), its tolerant range: luminance of 30 to 240 in sRGB, metals from 180.
    Substance,
    /// The same guide, its strict range: 50 to 240.
    SubstanceStrict,
    /// Unity's material charts: luminance of 50 to 243 in sRGB, metals from 186.
    Unity,
}

impl Profile {
    /// Every profile there is.
    pub const ALL: [Self; 4] = [Self::Measured, Self::Substance, Self::SubstanceStrict, Self::Unity];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Measured => "measured",
            Self::Substance => "substance",
            Self::SubstanceStrict => "substance_strict",
            Self::Unity => "unity",
        }
    }

    /// The profile of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|profile| profile.name() == name)
    }

    /// Smallest and largest luminance in bytes of sRGB, of what is no metal and of metals; `None` where the norms of
    /// the parameters hold.
    fn bytes(self) -> Option<[[f64; 2]; 2]> {
        match self {
            Self::Measured => None,
            Self::Substance => Some([[30.0, 240.0], [180.0, 255.0]]),
            Self::SubstanceStrict => Some([[50.0, 240.0], [180.0, 255.0]]),
            Self::Unity => Some([[50.0, 243.0], [186.0, 255.0]]),
        }
    }
}

/// Something to say about a description.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Remark {
    /// Its kind.
    pub code: Code,
    /// The parameter that it is about.
    pub path: String,
    /// What is unusual, in one line.
    pub text: String,
    /// What to say at its value.
    pub label: String,
    /// Ways out.
    pub help: Vec<String>,
}

impl Remark {
    fn new(code: Code, path: &str, text: impl Into<String>, label: impl Into<String>) -> Self {
        Self { code, path: path.to_owned(), text: text.into(), label: label.into(), help: Vec::new() }
    }

    fn help(mut self, help: impl Into<String>) -> Self {
        self.help.push(help.into());
        self
    }
}

/// Everything that is unusual about a description.
///
/// # Errors
/// If a data set can no longer be read.
pub fn lint(description: &Description, profile: Profile) -> Result<Vec<Remark>, MaterialError> {
    let mut remarks = unusual(description, profile);
    for rule in [albedo_above_one, tint_and_absorption, hidden_base, rough_coat_over_metal, only_deltas] {
        remarks.extend(rule(description)?);
    }
    remarks.extend(of_colour(description, profile)?);
    remarks.extend(of_metal(description, profile)?);
    Ok(remarks)
}

type Judged = Result<Option<Remark>, MaterialError>;

fn number(description: &Description, path: &str) -> Result<f64, MaterialError> {
    description.values().number(path)
}

fn channels(description: &Description, path: &str) -> Result<[f64; 3], MaterialError> {
    Ok(description.values().colour::<f64>(path)?.0)
}

/// Values outside of the norms of their parameters.
fn unusual(description: &Description, profile: Profile) -> Vec<Remark> {
    let mut remarks = Vec::new();
    let table = flattened(description.model().parameters());
    for (path, value) in description.given() {
        let Some(norm) =
            table.iter().find(|(known, _)| known == path).and_then(|(_, parameter)| parameter.norm)
        else {
            continue;
        };
        let is_judged_elsewhere = match path.as_str() {
            // What follows all orders of scattering loses nothing.
            "alpha" => description.values().text("scattering").is_ok_and(|name| name == "all"),
            "k" => matches!(value, Value::Colour(k) if k.contains(&0.0)),
            _ => {
                path == matte::REFLECTANCE.id && is_diffuse(description.model()) && profile.bytes().is_some()
            }
        };
        let [low, high] = norm.range;
        let is_usual = match value {
            Value::Number(number) => (low..=high).contains(number),
            Value::Colour(channels) => channels.iter().all(|channel| (low..=high).contains(channel)),
            Value::Text(_) => true,
        };
        if !is_usual && !is_judged_elsewhere {
            let value = value.shown();
            let text = format!("{path} = {value} is unusual");
            let label = format!("usually in [{low}, {high}]: {}", norm.source);
            remarks.push(Remark::new(Code::Unusual, path, text, label));
        }
    }
    remarks
}

/// The qualitative model of Oren and Nayar leaves out a term that takes light away.
fn albedo_above_one(description: &Description) -> Judged {
    if !matches!(description.model(), Model::Matte | Model::Plastic)
        || number(description, "sigma_rad")? == 0.0
    {
        return Ok(None);
    }
    let model = match description.values().text("diffuse")? {
        "qualitative" => OrenNayarModel::Qualitative,
        "full" => OrenNayarModel::Full,
        _ => return Ok(None),
    };
    let largest = channels(description, "reflectance")?.into_iter().fold(0.0, f64::max);
    if largest * model.largest_albedo() <= 1.0 {
        return Ok(None);
    }
    let text = format!("a reflectance of {largest} in this model of roughness can return more than arrives");
    let label = format!("times {} at worst", model.largest_albedo());
    let remark = Remark::new(Code::AlbedoAboveOne, "reflectance", text, label);
    Ok(Some(remark.help("diffuse = \"energy_preserving\" returns what arrives, and no more")))
}

fn tint_and_absorption(description: &Description) -> Judged {
    let absorbance = match description.model() {
        Model::Glass => "absorbance_inside",
        Model::ThinGlass => "absorbance",
        _ => return Ok(None),
    };
    let is_tinted = channels(description, "transmission")?.into_iter().any(|channel| channel < 1.0);
    let absorbs = channels(description, absorbance)?.into_iter().any(|channel| channel > 0.0);
    let remark = || {
        let text = "a tint and absorption together colour the light twice";
        Remark::new(Code::TintAndAbsorption, "transmission", text, format!("and `{absorbance}` is not 0"))
            .help("absorption follows the thickness of the glass; a tint is the same for all")
    };
    Ok((is_tinted && absorbs).then(remark))
}

/// Optical length from which on light is gone: e⁻⁶ = 0.25 % is left.
const HIDES: f64 = 6.0;

fn hidden_base(description: &Description) -> Judged {
    let (group, passes, what) = match description.model() {
        Model::Plastic | Model::CarPaint => ("coat.", 2.0, "the coat hides its base"),
        Model::ThinGlass => ("", 1.0, "the sheet lets nothing through"),
        _ => return Ok(None),
    };
    let thickness = number(description, &format!("{group}thickness"))?;
    let absorbance = channels(description, &format!("{group}absorbance"))?;
    let least = absorbance.into_iter().fold(f64::INFINITY, f64::min) * thickness;
    let remark = || {
        let percent = 100.0 * (-passes * least).exp();
        let label = format!("× absorbance = {least:.3}: {percent:.2} % is left, at most");
        Remark::new(Code::HiddenBase, &format!("{group}thickness"), what, label)
            .help("only thickness × absorbance counts: make one of them smaller")
    };
    Ok((passes * least > HIDES).then(remark))
}

/// α of a coat from which on the layer over metal is off by more than 0.04.
const ROUGH_COAT: f64 = 0.1;

fn rough_coat_over_metal(description: &Description) -> Judged {
    if description.model() != Model::CarPaint {
        return Ok(None);
    }
    let alpha = number(description, "coat.alpha")?;
    let remark = || {
        let text = format!("the model of a layer is rough itself below a coat of α = {alpha} over metal");
        let label = format!("above {ROUGH_COAT} its albedo can be off by more than 0.04");
        Remark::new(Code::RoughCoatOverMetal, "coat.alpha", text, label)
    };
    Ok((alpha > ROUGH_COAT).then(remark))
}

fn only_deltas(description: &Description) -> Judged {
    let is_smooth = |path| Ok::<_, MaterialError>(number(description, path)? < ALPHA_MIN);
    let (is_delta, path) = match description.model() {
        Model::Mirror => (true, "reflectance"),
        Model::ThinGlass => (true, "eta"),
        Model::Glass => (is_smooth("alpha")?, "alpha"),
        Model::Metal => {
            let alphas = metal::alphas(description.values())?;
            (alphas.into_iter().all(|alpha| alpha < ALPHA_MIN), "alpha")
        }
        Model::Matte | Model::Plastic | Model::CarPaint | Model::Fabric => return Ok(None),
    };
    let remark = || {
        let text = "lights that are points or directions are not seen in a perfectly smooth surface";
        Remark::new(Code::OnlyDelta, path, text, "").help("light it by areas or by an environment")
    };
    Ok(is_delta.then(remark))
}

/// A diffuse colour outside of the profile.
fn of_colour(description: &Description, profile: Profile) -> Judged {
    let Some([range, _]) = profile.bytes().filter(|_| is_diffuse(description.model())) else {
        return Ok(None);
    };
    let path = matte::REFLECTANCE.id;
    Ok(outside(profile, range, Rgb(channels(description, path)?).luminance(), path))
}

fn is_diffuse(model: Model) -> bool {
    matches!(model, Model::Matte | Model::Plastic | Model::Fabric)
}

fn outside(profile: Profile, [low, high]: [f64; 2], luminance: f64, path: &str) -> Option<Remark> {
    // The ranges are of whole bytes.
    let byte = (255.0 * linear_to_srgb(luminance)).round();
    (!(low..=high).contains(&byte)).then(|| {
        let text = format!("a luminance of {luminance:.4}, {byte} in sRGB");
        let label = format!("the profile `{}` wants {low} to {high}", profile.name());
        Remark::new(Code::OutsideProfile, path, text, label)
    })
}

/// Reflectance at normal incidence that the metals of `reference-data/ior` have in every channel, and a little more:
/// from the blue of gold, 0.348, to the red of silver, 0.991.
const METALS: [f64; 2] = [0.3, 0.995];

fn of_metal(description: &Description, profile: Profile) -> Result<Vec<Remark>, MaterialError> {
    if !matches!(description.model(), Model::Metal | Model::CarPaint) {
        return Ok(Vec::new());
    }
    let values = description.values();
    let [eta, k] = metal::index(values)?;
    let is_numbers = values.is_given(metal::ETA.id);
    let path = if is_numbers { metal::ETA.id } else { metal::IOR.id };
    if k.contains(&0.0) {
        let text = "a metal with k = 0 in a channel is a dielectric, and this one lets nothing through";
        let remark = Remark::new(Code::NotAMetal, if is_numbers { "k" } else { path }, text, "");
        // What else is odd about it follows from that.
        return Ok(vec![remark.help("metals have k above 1; glass and plastic take `eta` alone")]);
    }
    let mut remarks = Vec::new();
    let normal: [f64; 3] = std::array::from_fn(|channel| normal_incidence(eta[channel], k[channel]));
    let shown = normal.map(|channel| format!("{channel:.3}")).join(", ");
    if let Some(colour) = outside_gamut(description)? {
        let text = format!(
            "its colour, [{}], is outside of what red, green and blue can show",
            colour.map(|channel| format!("{channel:.4}")).join(", ")
        );
        let label = format!("fitted: [{shown}] at normal incidence");
        remarks.push(Remark::new(Code::OutsideGamut, path, text, label));
    } else if normal.iter().any(|channel| !(METALS[0]..=METALS[1]).contains(channel)) {
        let text = format!("reflects [{shown}] at normal incidence");
        let label = format!("metals reflect {} to {} in every channel", METALS[0], METALS[1]);
        remarks.push(Remark::new(Code::UnusualMetal, path, text, label));
    }
    if let Some([_, range]) = profile.bytes() {
        remarks.extend(outside(profile, range, Rgb(normal).luminance(), path));
    }
    if is_numbers && description.model() == Model::CarPaint {
        let coat = number(description, "coat.eta")?;
        remarks.extend(divided_already(eta, k, coat));
    }
    Ok(remarks)
}

/// The colour of a data set that its fitted index cannot have.
fn outside_gamut(description: &Description) -> Result<Option<[f64; 3]>, MaterialError> {
    let values = description.values();
    if values.is_given(metal::ETA.id) || values.text(metal::REDUCTION.id)? != "fitted" {
        return Ok(None);
    }
    let path = metal::IOR.id;
    let of_source = |source| MaterialError::DataSet { parameter: path.to_owned(), source };
    let colour = ior::load(values.text(path)?).and_then(|table| table.reflectance_rgb(1.0, Illuminant::D65));
    let colour = colour.map_err(of_source)?.0;
    Ok(colour.iter().any(|channel| !(0.0..=1.0).contains(channel)).then_some(colour))
}

/// An index that is that of a known metal over the index of the coat already: it will be divided again.
fn divided_already(eta: [f64; 3], k: [f64; 3], coat: f64) -> Option<Remark> {
    const NEAR: f64 = 0.02;
    if coat - 1.0 <= 2.0 * NEAR {
        // Divided or not, it is the same.
        return None;
    }
    let is_near =
        |a: [f64; 3], b: [f64; 3]| a.into_iter().zip(b).all(|(a, b)| (a * coat - b).abs() <= NEAR * b);
    for provenance in ior::provenances().ok()?.iter().filter(|table| table.class == ior::Class::Metal) {
        let reductions = metal::reductions(&provenance.table).into_iter().flatten();
        for [known_eta, known_k] in reductions {
            if is_near(eta, known_eta) && is_near(k, known_k) {
                let text = format!("this is {} divided by the coat's index of {coat}", provenance.table);
                let remark = Remark::new(Code::DividedIndex, "eta", text, "will be divided by it again");
                return Some(remark.help(format!("ior = \"{}\" in place of eta and k", provenance.table)));
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::PRESETS;
    use crate::message::Severity;

    fn warnings(description: &Description) -> Vec<Code> {
        let remarks = lint(description, Profile::Measured).unwrap();
        let codes = remarks.into_iter().map(|remark| remark.code);
        codes.filter(|code| code.severity() == Severity::Warning).collect()
    }

    #[test]
    fn presets_and_defaults_are_not_unusual_but_for_gold() {
        for preset in PRESETS {
            // The red of gold is outside of Rec. 709, whatever imitates it.
            let expected: &[Code] = if preset.name == "rough_gold" { &[Code::OutsideGamut] } else { &[] };
            assert_eq!(warnings(&preset.description().unwrap()), expected, "{}", preset.name);
        }
        for &model in Model::ALL {
            assert_eq!(warnings(&Description::new(model, []).unwrap()), [], "{}", model.name());
        }
    }
}

//! The materials of the thesis (§4.2, §4.3): prepackaged stacks of lobes with checked parameters.
//!
//! A material is one of the [`Model`]s with values for its parameters. Each model is a file of
//! `src/material/` that states its parameters once, as a table of [`Parameter`]s, and builds its lobes from
//! values that the table has accepted: ranges, defaults, units and texts are written nowhere else.
//! [`PRESETS`] are materials by name.
//!
//! Beside the scattering at its surface a material carries what it absorbs on the way:
//! [`Material::transmittance`].

mod car_paint;
mod coat;
mod description;
mod fabric;
pub mod file;
pub mod foreign;
mod glass;
mod lint;
mod matte;
mod metal;
mod mirror;
mod parameter;
mod plastic;
mod preset;
mod summary;
mod thin_glass;

use serde::{Serialize, Serializer};

use crate::bxdf::{Bxdf, BxdfSample, LobeFlags, TransportMode};
use crate::fresnel::Fresnel;
use crate::ior::IorError;
use crate::lobe::{LayerError, Lobe, MicrofacetReflection, SpecularReflection};
use crate::microfacet::{Distribution, Shape};
use crate::parameter::{OutOfRange, did_you_mean};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;
use crate::stack::Stack;

pub use description::Description;
pub use lint::{Profile, Remark, lint};
pub use parameter::{Choice, Norm, Parameter, ParameterKind, Value, flattened};
pub use preset::{PRESETS, Preset, preset};
pub use summary::Summary;

use description::Rule;
use parameter::Values;

macro_rules! models {
    ($($module:ident :: $name:ident : $summary:literal,)+) => {
        /// The kinds of materials.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Model {
            $(#[doc = $summary] $name,)+
        }

        impl Model {
            /// Every model there is.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// Its name, which is also the name of its file.
            pub fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($module),)+ }
            }

            /// What it is, in one line.
            pub fn summary(self) -> &'static str {
                match self { $(Self::$name => $summary,)+ }
            }

            /// The table of its parameters.
            pub fn parameters(self) -> &'static [Parameter] {
                match self { $(Self::$name => $module::PARAMETERS,)+ }
            }

            /// What it demands of several parameters together.
            fn rules(self) -> &'static [Rule] {
                match self { $(Self::$name => $module::RULES,)+ }
            }

            fn build<F: Real>(self, values: &Values) -> Result<Build<F>, MaterialError> {
                match self { $(Self::$name => $module::build(values),)+ }
            }
        }
    };
}

models! {
    matte::Matte: "diffuse reflection: Lambertian, or Oren-Nayar where rough (thesis 4.2.2)",
    mirror::Mirror: "an ideal mirror without Fresnel's equations (thesis 4.2.3)",
    glass::Glass: "a clear or absorbing dielectric, smooth or rough: glass, gems, water (thesis 4.2.4)",
    thin_glass::ThinGlass: "a single-face sheet of glass (thesis 5.5)",
    metal::Metal: "a conductor by its measured index, smooth, rough or brushed (thesis 4.2.5)",
    plastic::Plastic: "a coat over a diffuse base: plastic, rubber, ceramic, varnished wood (thesis 4.2.6)",
    car_paint::CarPaint: "a coat over metal (thesis 4.2.7)",
    fabric::Fabric: "diffuse reflection that favours the way back: satin, velvet (thesis 4.3)",
}

impl Model {
    /// The model of a name.
    pub fn named(name: &str) -> Result<Self, MaterialError> {
        Self::ALL.iter().copied().find(|model| model.name() == name).ok_or_else(|| {
            let names = || Self::ALL.iter().map(|model| model.name());
            MaterialError::UnknownModel {
                name: name.to_owned(),
                hint: did_you_mean(name, names()),
                known: names().collect::<Vec<_>>().join(", "),
            }
        })
    }
}

impl Serialize for Model {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.name())
    }
}

/// Why a material cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum MaterialError {
    /// No such model.
    #[error("no material is named `{name}`{hint}; materials: {known}")]
    UnknownModel {
        /// What was asked for.
        name: String,
        /// A question about similar names, or nothing.
        hint: String,
        /// All names.
        known: String,
    },
    /// No such preset.
    #[error("no preset is named `{name}`{hint}; `gonio list` shows all")]
    UnknownPreset {
        /// What was asked for.
        name: String,
        /// A question about similar names, or nothing.
        hint: String,
    },
    /// The material has no such parameter.
    #[error("`{parameter}` is not a parameter of {material}{hint}; {material} takes: {takes}")]
    UnknownParameter {
        /// The name of the model.
        material: &'static str,
        /// What was given.
        parameter: String,
        /// A question about similar names, or nothing.
        hint: String,
        /// All its parameters.
        takes: String,
    },
    /// A value of another kind than the parameter takes.
    #[error("{parameter} = {value} is of the wrong type: expected {expected}")]
    WrongType {
        /// Path of the parameter.
        parameter: String,
        /// The value that was given.
        value: String,
        /// What it takes, in words, with the unit.
        expected: String,
    },
    /// A name that the parameter does not take.
    #[error("{parameter} = \"{value}\" is no choice{hint}; expected {expected}")]
    UnknownChoice {
        /// Path of the parameter.
        parameter: String,
        /// The name that was given.
        value: String,
        /// A question about similar names, or nothing.
        hint: String,
        /// What it takes, in words.
        expected: String,
    },
    /// A value that the parameter does not take.
    #[error("{parameter} = {value} is out of range: expected {expected}")]
    Unacceptable {
        /// Path of the parameter.
        parameter: String,
        /// The value that was given.
        value: String,
        /// What it takes, in words, with the unit.
        expected: String,
    },
    /// A data set that is not to be had.
    #[error("{parameter}: {source}")]
    DataSet {
        /// Path of the parameter.
        parameter: String,
        /// What is wrong with it.
        source: IorError,
    },
    /// A parameter without which the others mean nothing.
    #[error("{material} lacks a value for `{parameter}`")]
    Missing {
        /// The name of the model.
        material: &'static str,
        /// Path of the parameter.
        parameter: String,
    },
    /// Parameters that exclude each other.
    #[error("`{parameter}` and `{other}` cannot both be given: {reason}")]
    Contradiction {
        /// Path of the parameter.
        parameter: &'static str,
        /// Path of the other one.
        other: &'static str,
        /// Why not.
        reason: &'static str,
    },
    /// Values that a lobe does not take together.
    #[error(transparent)]
    Lobe(#[from] OutOfRange),
    /// A coat that cannot be put on its base.
    #[error(transparent)]
    Layer(#[from] LayerError),
}

impl MaterialError {
    /// Path of the parameter that it is about, if it is about one.
    pub fn parameter(&self) -> Option<&str> {
        match self {
            Self::UnknownParameter { parameter, .. }
            | Self::WrongType { parameter, .. }
            | Self::UnknownChoice { parameter, .. }
            | Self::Unacceptable { parameter, .. }
            | Self::DataSet { parameter, .. } => Some(parameter),
            Self::Contradiction { other, .. } => Some(other),
            Self::UnknownModel { .. }
            | Self::UnknownPreset { .. }
            | Self::Missing { .. }
            | Self::Lobe(_)
            | Self::Layer(_) => None,
        }
    }
}

/// What a model makes of its values.
#[derive(Clone, Debug)]
struct Build<F: Real> {
    stack: Stack<F>,
    /// cos and sin of the angle by which the tangents are turned about the normal.
    turn: Option<[F; 2]>,
    is_isotropic: bool,
    /// Napierian absorption outside and inside \[1/length\].
    absorbance: [Rgb<F>; 2],
}

impl<F: Real> Build<F> {
    /// Lobes that do not change when they are turned about the normal.
    fn isotropic(lobes: impl IntoIterator<Item = Lobe<F>>) -> Result<Self, MaterialError> {
        let stack = Stack::new(lobes)?;
        Ok(Self { stack, turn: None, is_isotropic: true, absorbance: [Rgb::BLACK; 2] })
    }
}

/// A material: a stack of lobes in a frame whose tangents may be turned, and what its inside and its outside
/// absorb.
///
/// # Definition
/// The sum of its lobes (thesis §4.2.1). Tangents turned by φ about the normal: f(wo, wi) is that of the
/// stack at both directions turned by −φ. Over a length d inside or outside, light keeps e^{−σ d} per channel
/// (Beer–Lambert, Napierian: the thesis's "absorbance" σ).
///
/// # Example
/// ```
/// use gonio::bxdf::Bxdf;
/// use gonio::material::{Material, Model, Value};
/// let copper = Material::<f64>::new(Model::Metal, [
///     ("ior", Value::from("copper/Johnson-1972")),
///     ("alpha", Value::from(0.25)),
/// ])?;
/// assert!(copper.albedo(glam::DVec3::Z)[0] > 0.9);
/// let error = copper.with([("alpha", 1.5.into())]).unwrap_err();
/// assert_eq!(error.to_string(), "alpha = 1.5 is out of range: expected a number in [0, 1] [slope]");
/// # Ok::<(), gonio::material::MaterialError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Material<F: Real> {
    description: Description,
    build: Build<F>,
}

impl<F: Real> Material<F> {
    /// The material that is described by a model and values, as [`Description::new`].
    ///
    /// # Errors
    /// If a parameter or a value is not in the table of the model, or values contradict each other.
    pub fn new<'a>(
        model: Model,
        values: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> Result<Self, MaterialError> {
        Self::of(Description::new(model, values)?)
    }

    /// The same material with other values for some of its parameters.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn with<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, Value)>,
    ) -> Result<Self, MaterialError> {
        Self::of(self.description.with(values)?)
    }

    fn of(description: Description) -> Result<Self, MaterialError> {
        let build = description.model().build(description.values())?;
        Ok(Self { description, build })
    }

    /// What it was made from.
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// The lobes, in the frame of its own tangents.
    pub fn stack(&self) -> &Stack<F> {
        &self.build.stack
    }

    /// `true` if the tangents of the lobes are not those of the surface.
    pub fn is_turned(&self) -> bool {
        self.build.turn.is_some()
    }

    /// `true` if turning the material about the normal changes nothing.
    pub fn is_isotropic(&self) -> bool {
        self.build.is_isotropic
    }

    /// `true` if light that enters goes on inside, until it meets the surface again.
    pub fn has_inside(&self) -> bool {
        self.description.model() == Model::Glass
    }

    /// What is left of light, per channel, after a straight way of the given `length` ≥ 0 below the surface
    /// (`inside`) or above it: e^{−σ length}. Only glass absorbs on the way; a coat and a thin sheet absorb
    /// in their lobes.
    pub fn transmittance(&self, length: F, inside: bool) -> Rgb<F> {
        self.build.absorbance[usize::from(inside)].map(|sigma| (-sigma * length).exp())
    }

    /// A direction in the frame of the stack.
    #[inline]
    fn turned_in(&self, w: F::Vec3) -> F::Vec3 {
        let Some([cos, sin]) = self.build.turn else { return w };
        F::Vec3::new(cos * w.x() + sin * w.y(), cos * w.y() - sin * w.x(), w.z())
    }

    /// A direction of the stack in the frame of the surface.
    #[inline]
    fn turned_out(&self, w: F::Vec3) -> F::Vec3 {
        let Some([cos, sin]) = self.build.turn else { return w };
        F::Vec3::new(cos * w.x() - sin * w.y(), sin * w.x() + cos * w.y(), w.z())
    }
}

impl<F: Real> Bxdf<F> for Material<F> {
    #[inline]
    fn eval(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> Rgb<F> {
        self.build.stack.eval(self.turned_in(wo), self.turned_in(wi), mode)
    }

    #[inline]
    fn pdf(&self, wo: F::Vec3, wi: F::Vec3, mode: TransportMode) -> F {
        self.build.stack.pdf(self.turned_in(wo), self.turned_in(wi), mode)
    }

    #[inline]
    fn sample(&self, wo: F::Vec3, uc: F, u: [F; 2], mode: TransportMode) -> Option<BxdfSample<F>> {
        let sample = self.build.stack.sample(self.turned_in(wo), uc, u, mode)?;
        Some(BxdfSample { wi: self.turned_out(sample.wi), ..sample })
    }

    fn albedo(&self, wo: F::Vec3) -> Rgb<F> {
        self.build.stack.albedo(self.turned_in(wo))
    }

    fn flags(&self) -> LobeFlags {
        self.build.stack.flags()
    }
}

// What several models share.

/// Roughness α of a microfacet surface.
const fn alpha(default: f64) -> Parameter {
    Parameter {
        id: "alpha",
        label: "roughness α",
        kind: ParameterKind::Number { range: [0.0, 1.0] },
        default: Some(Value::Number(default)),
        norm: Some(Norm {
            range: [0.0, 0.5],
            source: "single scattering at α = 0.5 and 0° returns 0.69 (GGX), 0.94 (Beckmann) of F",
        }),
        unit: "slope",
        doc: "The thesis's r, Walter's α: not squared, not \"perceptual\". 0, and all below 1e-4, is smooth.",
    }
}

/// Distribution of micro normals.
const DISTRIBUTION: Parameter = Parameter {
    id: "distribution",
    label: "distribution of micro normals",
    kind: ParameterKind::Choice {
        choices: &[
            Choice { name: "beckmann", doc: "Gaussian slopes" },
            Choice { name: "ggx", doc: "Trowbridge-Reitz: longer tails" },
        ],
    },
    default: Some(Value::text("beckmann")),
    norm: None,
    unit: "",
    doc: "Shape of a rough surface (thesis 2.4.4); Smith masking, correlated; the thesis's is separable.",
};

/// Number of bounces that a rough surface follows.
const SCATTERING: Parameter = Parameter {
    id: "scattering",
    label: "orders of scattering",
    kind: ParameterKind::Choice {
        choices: &[
            Choice {
                name: "single",
                doc: "one bounce at the micro surface; what meets it twice is lost (thesis)",
            },
            Choice { name: "all", doc: "the rest as well, spread diffusely: Kulla & Conty" },
        ],
    },
    default: Some(Value::text("single")),
    norm: None,
    unit: "",
    doc: "The thesis's figure 8 shows the loss of single scattering.",
};

/// The shape that the parameter `distribution` in the group of the given path means.
fn shape(values: &Values, path: &str) -> Result<Shape, MaterialError> {
    Ok(if values.text(path)? == "ggx" { Shape::Ggx } else { Shape::Beckmann })
}

/// Does the material follow all orders of scattering?
fn follows_all_orders(values: &Values) -> Result<bool, MaterialError> {
    Ok(values.text("scattering")? == "all")
}

/// Reflection at facets: a mirror where the surface is smooth.
fn reflection<F: Real>(distribution: Distribution<F>, fresnel: Fresnel<F>) -> Lobe<F> {
    if distribution.is_smooth() {
        SpecularReflection::new(fresnel).into()
    } else {
        MicrofacetReflection::new(distribution, fresnel).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ior::{Class, builtin, provenances};
    use glam::DVec3;

    fn refusal(model: Model, values: &[(&'static str, Value)]) -> String {
        Material::<f64>::new(model, values.iter().cloned()).unwrap_err().to_string()
    }

    #[test]
    fn every_table_is_complete_and_its_defaults_are_accepted() {
        for &model in Model::ALL {
            let all = flattened(model.parameters());
            let values = Values::new(model.name(), model.parameters());
            for (i, (path, parameter)) in all.iter().enumerate() {
                let name = format!("{} {path}", model.name());
                assert!(all[..i].iter().all(|(other, _)| other != path), "{name} twice");
                assert!(!parameter.label.is_empty() && parameter.doc.ends_with('.'), "{name}");
                if let Some(default) = &parameter.default {
                    values.clone().set(path, default.clone()).unwrap();
                }
                if let Some(norm) = parameter.norm {
                    assert!(!norm.source.is_empty(), "{name}");
                    let [low, high] = match parameter.kind {
                        ParameterKind::Number { range } | ParameterKind::Channels { range } => range,
                        ParameterKind::Colour => [0.0, 1.0],
                        _ => panic!("{name} has a norm and no range"),
                    };
                    assert!(low <= norm.range[0] && norm.range[1] <= high, "{name}");
                    if let Some(Value::Number(default)) = parameter.default {
                        assert!(norm.range[0] <= default && default <= norm.range[1], "{name}: {default}");
                    }
                }
            }
        }
    }

    /// Values that the table accepts are values that the lobes take, each by itself.
    #[test]
    fn every_material_can_be_made_at_both_ends_of_every_range_and_with_every_choice() {
        for &model in Model::ALL {
            for (path, parameter) in flattened(model.parameters()) {
                let values: Vec<Value> = match parameter.kind {
                    ParameterKind::Number { range } | ParameterKind::Channels { range } => {
                        range.map(Value::Number).to_vec()
                    }
                    ParameterKind::Colour => [0.0, 1.0].map(Value::Number).to_vec(),
                    ParameterKind::OneOf { numbers } => numbers.iter().copied().map(Value::Number).collect(),
                    ParameterKind::Choice { choices } => {
                        choices.iter().map(|choice| Value::text(choice.name)).collect()
                    }
                    ParameterKind::DataSet | ParameterKind::Group { .. } => continue,
                };
                for value in values {
                    let partner: &[(&str, Value)] = match path.as_str() {
                        "eta" if parameter.default.is_none() => &[("k", Value::Number(3.0))],
                        "k" => &[("eta", Value::Number(0.5))],
                        "anisotropy" => &[("alpha", Value::Number(0.1))],
                        _ => &[],
                    };
                    let given =
                        || [(path.as_str(), value.clone())].into_iter().chain(partner.iter().cloned());
                    let albedo = Material::<f64>::new(model, given()).unwrap().albedo(DVec3::Z);
                    let name = format!("{} {path} = {value}", model.name());
                    assert!(albedo.0.iter().all(|a| a.is_finite()), "{name}: {albedo:?}");
                    // Layers take their time; their bases are the other materials.
                    if !matches!(model, Model::Plastic | Model::CarPaint) {
                        let single = Material::<f32>::new(model, given()).unwrap().albedo(glam::Vec3::Z);
                        assert!(single.0.iter().all(|a| a.is_finite()), "{name}: {single:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn nothing_that_is_out_of_range_can_be_made_and_the_message_says_what_can() {
        for (model, values, message) in [
            (
                Model::Metal,
                vec![("alpha", Value::Number(1.5))],
                "alpha = 1.5 is out of range: expected a number in [0, 1] [slope]",
            ),
            (Model::Metal, vec![("alpha", Value::Number(f64::NAN))], "alpha = NaN is out of range"),
            (
                Model::Plastic,
                vec![("coat.eta", Value::Number(0.9))],
                "coat.eta = 0.9 is out of range: expected a number in [1, 1000]",
            ),
            (
                Model::Matte,
                vec![("reflectance", Value::Colour([0.5, 1.02, 0.5]))],
                "reflectance = [0.5, 1.02, 0.5] is out of range: expected [red, green, blue] or a grey,",
            ),
            (Model::Matte, vec![("reflectance", "red".into())], "reflectance = \"red\" is of the wrong type"),
            (
                Model::Fabric,
                vec![("exponent", Value::Number(3.0))],
                "exponent = 3 is out of range: expected one of 1, 2, 4, 8, 16",
            ),
            (
                Model::Glass,
                vec![("distribution", "blinn".into())],
                "distribution = \"blinn\" is no choice; expected one of \"beckmann\", \"ggx\"",
            ),
            (Model::Metal, vec![("ior", "iron".into())], "ior: `iron` has several data sets"),
            (Model::Metal, vec![("rougness", Value::Number(0.1))], "`rougness` is not a parameter of metal"),
            (Model::CarPaint, vec![("coat.thicknes", Value::Number(0.1))], "did you mean coat.thickness"),
            (
                Model::CarPaint,
                vec![("coat", Value::Number(1.0))],
                "coat = 1 is of the wrong type: expected a group of eta,",
            ),
            (
                Model::Metal,
                vec![("ior", "gold/Johnson-1972".into()), ("k", Value::Number(3.0))],
                "`ior` and `k` cannot both be given",
            ),
            (Model::Metal, vec![("k", Value::Number(3.0))], "metal lacks a value for `eta`"),
            (
                Model::Metal,
                vec![("alpha", Value::Number(0.5)), ("anisotropy", Value::Number(5.0))],
                "anisotropy = 5 is out of range: expected with alpha = 0.5 a ratio in [0.2500, 4.0000]",
            ),
            (Model::Matte, vec![("sigma_rad", Value::Number(0.7)), ("diffuse", "full".into())], "0.66"),
            (
                Model::Glass,
                vec![("transmission", Value::Number(0.5)), ("scattering", "all".into())],
                "`scattering` and `transmission` cannot both be given",
            ),
        ] {
            let error = refusal(model, &values);
            assert!(error.contains(message), "{error}");
        }
        let error = Model::named("plastik").unwrap_err().to_string();
        assert!(error.contains("did you mean plastic"), "{error}");
        let error = preset("rubi").unwrap_err().to_string();
        assert!(error.contains("did you mean ruby"), "{error}");
    }

    #[test]
    fn a_value_is_what_was_given_last_or_the_default() {
        let metal = Material::<f64>::new(Model::Metal, [("alpha", 0.2.into())]).unwrap();
        let rougher = metal.with([("alpha", 0.3.into())]).unwrap();
        assert_eq!(rougher.description().value("alpha").unwrap(), Some(&Value::Number(0.3)));
        assert_eq!(rougher.description().value("anisotropy").unwrap(), Some(&Value::Number(1.0)));
        assert_eq!(rougher.description().value("k").unwrap(), None);
        assert_eq!(rougher.description().given(), [("alpha".to_owned(), Value::Number(0.3))]);
        assert!(rougher.description().value("reflectance").is_err());
        assert_eq!(rougher.description().model(), Model::Metal);
    }

    #[test]
    fn metals_on_file_have_a_usual_index() {
        let [eta_norm, k_norm] = [&metal::ETA, &metal::K].map(|parameter| parameter.norm.unwrap().range);
        for provenance in provenances().unwrap().iter().filter(|table| table.class == Class::Metal) {
            for wavelength_nm in [465.0, 532.0, 630.0] {
                let index = builtin(&provenance.table).unwrap().at(wavelength_nm).unwrap();
                let is_in = |[low, high]: [f64; 2], value: f64| low <= value && value <= high;
                assert!(
                    is_in(eta_norm, index.eta) && is_in(k_norm, index.k),
                    "{} {index:?}",
                    provenance.table
                );
            }
        }
    }

    #[test]
    fn turned_tangents_are_turned_directions() {
        let brushed = |ratio: f64, degrees: f64| {
            Material::<f64>::new(
                Model::Metal,
                [("alpha", 0.3.into()), ("anisotropy", ratio.into()), ("rotation_deg", degrees.into())],
            )
            .unwrap()
        };
        let [wo, wi] = [DVec3::new(0.3, -0.2, 0.8), DVec3::new(0.1, 0.7, 0.5)].map(DVec3::normalize);
        let f = |material: &Material<f64>, wo, wi| material.eval(wo, wi, TransportMode::Radiance)[0];
        let plain = f(&brushed(4.0, 0.0), wo, wi);
        // A quarter turn exchanges the axes.
        assert!((f(&brushed(0.25, 90.0), wo, wi) / plain - 1.0).abs() < 1e-12);
        assert!((f(&brushed(4.0, 90.0), wo, wi) / plain - 1.0).abs() > 0.1);
        // Tangents that are turned counter-clockwise see directions that are turned the same way as before.
        let turn = glam::DMat3::from_rotation_z(30.0_f64.to_radians());
        assert!((f(&brushed(4.0, 30.0), turn * wo, turn * wi) / plain - 1.0).abs() < 1e-12);
        let along = brushed(4.0, 30.0).sample(turn * wo, 0.5, [0.3, 0.7], TransportMode::Radiance).unwrap();
        let before = brushed(4.0, 0.0).sample(wo, 0.5, [0.3, 0.7], TransportMode::Radiance).unwrap();
        assert!((along.wi - turn * before.wi).length() < 1e-12);
    }

    #[test]
    fn smooth_metal_is_a_mirror_and_smooth_plastic_is_glossy() {
        let polished = preset("polished_copper").unwrap().material::<f64>().unwrap();
        assert!(polished.flags().is_delta && !polished.is_turned() && polished.is_isotropic());
        let gloss = preset("ceramic").unwrap().material::<f64>().unwrap();
        assert!(matches!(
            gloss.stack().components(),
            [Lobe::SpecularReflection(_), Lobe::RefractiveLayer(_)]
        ));
        let rough = preset("red_plastic").unwrap().material::<f64>().unwrap();
        assert!(matches!(
            rough.stack().components(),
            [Lobe::MicrofacetReflection(_), Lobe::RefractiveLayer(_)]
        ));
    }

    #[test]
    fn the_index_of_corundum_is_that_of_the_data_set() {
        let measured = builtin("sapphire/Malitson-1972-o").unwrap().at(587.56).unwrap().eta;
        for name in ["ruby", "sapphire"] {
            let stone = preset(name).unwrap().material::<f64>().unwrap();
            let Some(&Value::Number(eta)) = stone.description().value("eta").unwrap() else {
                panic!("{name}")
            };
            assert!((eta - measured).abs() < 5e-4);
        }
    }
}

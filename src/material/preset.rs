//! Materials by name: what the thesis shows, as values that answer to its figures.

use serde::Serialize;

use super::{Description, Material, MaterialError, Model, Value};
use crate::parameter::did_you_mean;
use crate::real::Real;

/// A material with a name.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Preset {
    /// Its name.
    pub name: &'static str,
    /// What it is, in one line.
    pub summary: &'static str,
    /// Where the thesis shows it.
    pub figure: &'static str,
    /// Its model.
    pub model: Model,
    /// The values that differ from the model's defaults, by the paths of their parameters.
    #[serde(serialize_with = "as_map")]
    pub values: &'static [(&'static str, Value)],
}

fn as_map<S: serde::Serializer>(
    values: &&'static [(&'static str, Value)],
    serializer: S,
) -> Result<S::Ok, S::Error> {
    serializer.collect_map(values.iter().map(|(path, value)| (path, value)))
}

impl Preset {
    /// What it is.
    ///
    /// # Errors
    /// Never for those of [`PRESETS`]; the constructor's errors are passed on rather than unwrapped.
    pub fn description(&self) -> Result<Description, MaterialError> {
        Description::new(self.model, self.values.iter().map(|(path, value)| (*path, value.clone())))
    }

    /// The material.
    ///
    /// # Errors
    /// As [`Self::description`].
    pub fn material<F: Real>(&self) -> Result<Material<F>, MaterialError> {
        self.description()?.material()
    }
}

/// The preset of a name.
pub fn preset(name: &str) -> Result<&'static Preset, MaterialError> {
    PRESETS.iter().find(|preset| preset.name == name).ok_or_else(|| MaterialError::UnknownPreset {
        name: name.to_owned(),
        hint: did_you_mean(name, PRESETS.iter().map(|preset| preset.name)),
    })
}

const fn number(number: f64) -> Value {
    Value::Number(number)
}
const fn rgb(red: f64, green: f64, blue: f64) -> Value {
    Value::Colour([red, green, blue])
}
const fn text(text: &'static str) -> Value {
    Value::text(text)
}

/// Index of ruby and sapphire: corundum, sapphire/Malitson-1972-o at 588 nm.
const CORUNDUM: Value = number(1.768);
/// What the thesis's red coats absorb (its figures 10 and 11).
const RED_ABSORBANCE: Value = rgb(0.25, 1.0, 1.0);

/// Every preset. Values that the cited figure does not print are ours.
pub const PRESETS: &[Preset] = &[
    Preset {
        name: "rough_matte",
        summary: "grey plaster with rough facets",
        figure: "figure 9b: r = 0.4",
        model: Model::Matte,
        values: &[("sigma_rad", number(0.4))],
    },
    Preset {
        name: "smooth_matte",
        summary: "grey paper",
        figure: "figures 6 and 9a",
        model: Model::Matte,
        values: &[],
    },
    Preset {
        name: "silvered_mirror",
        summary: "a household mirror",
        figure: "section 4.2.3",
        model: Model::Mirror,
        values: &[("reflectance", rgb(0.95, 0.94, 0.92))],
    },
    Preset {
        name: "rough_glass",
        summary: "etched glass",
        figure: "figure 6: r = 0.1",
        model: Model::Glass,
        values: &[("alpha", number(0.1))],
    },
    Preset {
        name: "ruby",
        summary: "red corundum; absorption in units of the stone",
        figure: "figure 6",
        model: Model::Glass,
        values: &[("eta", CORUNDUM), ("absorbance_inside", rgb(0.1, 4.0, 2.5))],
    },
    Preset {
        name: "emerald",
        summary: "green beryl; absorption in units of the stone",
        figure: "figure 6",
        model: Model::Glass,
        values: &[("eta", number(1.58)), ("absorbance_inside", rgb(3.5, 0.3, 1.8))],
    },
    Preset {
        name: "sapphire",
        summary: "blue corundum; absorption in units of the stone",
        figure: "figure 6",
        model: Model::Glass,
        values: &[("eta", CORUNDUM), ("absorbance_inside", rgb(3.5, 2.0, 0.1))],
    },
    Preset {
        name: "red_absorbing_glass",
        summary: "glass that takes away red alone, by the way that light goes in it",
        figure: "figures 7 and 13",
        model: Model::Glass,
        values: &[("absorbance_inside", rgb(2.0, 0.0, 0.0))],
    },
    Preset {
        name: "frosted_glass",
        summary: "rough GGX glass that loses what bounces twice",
        figure: "figure 8c: r = 0.4",
        model: Model::Glass,
        values: &[("alpha", number(0.4)), ("distribution", text("ggx"))],
    },
    Preset {
        name: "frosted_glass_all_orders",
        summary: "the same without the loss",
        figure: "figure 8c, corrected",
        model: Model::Glass,
        values: &[("alpha", number(0.4)), ("distribution", text("ggx")), ("scattering", text("all"))],
    },
    Preset {
        name: "tinted_window",
        summary: "a car's window as a single sheet",
        figure: "figure 14",
        model: Model::ThinGlass,
        values: &[("eta", number(1.52)), ("transmission", rgb(0.25, 0.28, 0.3))],
    },
    Preset {
        name: "rough_gold",
        summary: "sand-blasted gold",
        figure: "figures 6, 9d and 12a: r = 0.2",
        model: Model::Metal,
        values: &[("ior", text("gold/Johnson-1972")), ("alpha", number(0.2))],
    },
    Preset {
        name: "rough_gold_all_orders",
        summary: "the same with the light that bounces twice, by GGX",
        figure: "figure 9d, corrected",
        model: Model::Metal,
        values: &[
            ("ior", text("gold/Johnson-1972")),
            ("reduction", text("measured")),
            ("alpha", number(0.2)),
            ("distribution", text("ggx")),
            ("scattering", text("all")),
        ],
    },
    Preset {
        name: "rough_aluminium",
        summary: "bead-blasted aluminium",
        figure: "figure 9c: r = 0.2",
        model: Model::Metal,
        values: &[("alpha", number(0.2))],
    },
    Preset {
        name: "polished_copper",
        summary: "copper without roughness, at the thesis's three wavelengths",
        figure: "figure 13",
        model: Model::Metal,
        values: &[
            ("ior", text("copper/Johnson-1972")),
            ("reduction", text("measured")),
            ("alpha", number(0.0)),
        ],
    },
    Preset {
        name: "chrome",
        summary: "the plating of a rim",
        figure: "figure 14",
        model: Model::Metal,
        values: &[("ior", text("chromium/Johnson-1974")), ("alpha", number(0.02))],
    },
    Preset {
        name: "brushed_aluminium",
        summary: "aluminium with scratches at 30° to the surface's first tangent",
        figure: "section 4.2.5",
        model: Model::Metal,
        values: &[("alpha", number(0.2)), ("anisotropy", number(5.0)), ("rotation_deg", number(30.0))],
    },
    Preset {
        name: "red_plastic",
        summary: "glossy red plastic",
        figure: "figure 6",
        model: Model::Plastic,
        values: &[("reflectance", rgb(0.7, 0.05, 0.04))],
    },
    Preset {
        name: "rough_green_plastic",
        summary: "dull green plastic",
        figure: "figure 13",
        model: Model::Plastic,
        values: &[("reflectance", rgb(0.08, 0.5, 0.1)), ("coat.alpha", number(0.4))],
    },
    Preset {
        name: "coated_plastic_0",
        summary: "grey plastic below a clear smooth coat",
        figure: "figure 11a",
        model: Model::Plastic,
        values: &[
            ("coat.alpha", number(0.0)),
            ("coat.absorbance", RED_ABSORBANCE),
            ("coat.thickness", number(0.0)),
        ],
    },
    Preset {
        name: "coated_plastic_0.3",
        summary: "grey plastic below 0.3 of a smooth coat that leaves mostly red",
        figure: "figure 11b",
        model: Model::Plastic,
        values: &[
            ("coat.alpha", number(0.0)),
            ("coat.absorbance", RED_ABSORBANCE),
            ("coat.thickness", number(0.3)),
        ],
    },
    Preset {
        name: "coated_plastic_0.6",
        summary: "grey plastic below 0.6 of a smooth coat that leaves mostly red",
        figure: "figure 11c",
        model: Model::Plastic,
        values: &[
            ("coat.alpha", number(0.0)),
            ("coat.absorbance", RED_ABSORBANCE),
            ("coat.thickness", number(0.6)),
        ],
    },
    Preset {
        name: "coated_plastic_1",
        summary: "grey plastic below 1 of a smooth coat that leaves mostly red",
        figure: "figure 11d",
        model: Model::Plastic,
        values: &[
            ("coat.alpha", number(0.0)),
            ("coat.absorbance", RED_ABSORBANCE),
            ("coat.thickness", number(1.0)),
        ],
    },
    Preset {
        name: "tyre_rubber",
        summary: "black rubber",
        figure: "figure 14",
        model: Model::Plastic,
        values: &[
            ("reflectance", rgb(0.025, 0.025, 0.025)),
            ("coat.eta", number(1.52)),
            ("coat.alpha", number(0.4)),
        ],
    },
    Preset {
        name: "ceramic",
        summary: "a white rough body below a smooth red glaze",
        figure: "figure 10: white base, smooth coat",
        model: Model::Plastic,
        values: &[
            ("reflectance", rgb(0.85, 0.85, 0.85)),
            ("sigma_rad", number(0.4)),
            ("coat.alpha", number(0.0)),
            ("coat.thickness", number(0.5)),
            ("coat.absorbance", RED_ABSORBANCE),
        ],
    },
    Preset {
        name: "varnished_wood",
        summary: "oak below a clear yellowish varnish",
        figure: "section 4.1.9",
        model: Model::Plastic,
        values: &[
            ("reflectance", rgb(0.45, 0.27, 0.13)),
            ("sigma_rad", number(0.3)),
            ("coat.eta", number(1.52)),
            ("coat.alpha", number(0.05)),
            ("coat.thickness", number(0.1)),
            ("coat.absorbance", rgb(0.1, 0.4, 1.5)),
        ],
    },
    Preset {
        name: "red_car_paint",
        summary: "metallic paint: aluminium below a red clear coat",
        figure: "figures 12c and 14",
        model: Model::CarPaint,
        values: &[("coat.thickness", number(1.0)), ("coat.absorbance", RED_ABSORBANCE)],
    },
    Preset {
        name: "coated_aluminium",
        summary: "smooth aluminium below a thick smooth coat that leaves mostly red",
        figure: "figure 10a",
        model: Model::CarPaint,
        values: &[
            ("reduction", text("measured")),
            ("alpha", number(0.0)),
            ("coat.thickness", number(1.8)),
            ("coat.absorbance", RED_ABSORBANCE),
        ],
    },
    Preset {
        name: "coated_aluminium_0.5",
        summary: "very rough aluminium below a thick smooth coat that leaves mostly red",
        figure: "figure 10b",
        model: Model::CarPaint,
        values: &[
            ("reduction", text("measured")),
            ("alpha", number(0.5)),
            ("coat.thickness", number(1.8)),
            ("coat.absorbance", RED_ABSORBANCE),
        ],
    },
    Preset {
        name: "coated_aluminium_0.1",
        summary: "slightly rough aluminium below a thick smooth coat that leaves mostly red",
        figure: "figure 10c",
        model: Model::CarPaint,
        values: &[
            ("reduction", text("measured")),
            ("alpha", number(0.1)),
            ("coat.thickness", number(1.8)),
            ("coat.absorbance", RED_ABSORBANCE),
        ],
    },
    Preset {
        name: "coated_aluminium_0.2",
        summary: "rough aluminium below a thick smooth coat that leaves mostly red",
        figure: "figure 10d",
        model: Model::CarPaint,
        values: &[
            ("reduction", text("measured")),
            ("alpha", number(0.2)),
            ("coat.thickness", number(1.8)),
            ("coat.absorbance", RED_ABSORBANCE),
        ],
    },
    Preset {
        name: "satin",
        summary: "light satin",
        figure: "section 4.3",
        model: Model::Fabric,
        values: &[("reflectance", rgb(0.7, 0.6, 0.5))],
    },
];

//! What the inputs of `standard_surface`, `open_pbr_surface` and `gltf_pbr` mean here.
//!
//! The definitions are the graphs of the MaterialX library (`libraries/bxdf`); I. Georgiev et al., "Autodesk
//! Standard Surface" 1.0.1, 2019; Z. Andersson et al., "OpenPBR Surface specification" 1.1, ASWF 2024;
//! Khronos, "glTF 2.0" with KHR_materials_volume, appendix B. The three share their structure, so that one
//! table of roles serves all. The library's shaders give back what single scattering loses at rough facets:
//! here `scattering` = all, where a model has it.

use super::{
    CLEAR, Draft, FINITE, Fate, INDEX, Imported, Key, Kind, POSITIVE, absorbance, below, f0_of, gulbrandsen,
    largest, metal_like_f82, product, returned_inside, show, show_colour, smallest, weighted_index,
};
use crate::material::Model;
use crate::message::{Code, Finding};
use crate::rgb::Rgb;

/// A shader that is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shader {
    Standard,
    OpenPbr,
    Gltf,
}

impl Shader {
    pub(super) const ALL: [Self; 3] = [Self::Standard, Self::OpenPbr, Self::Gltf];

    pub(super) fn element(self) -> &'static str {
        match self {
            Self::Standard => "standard_surface",
            Self::OpenPbr => "open_pbr_surface",
            Self::Gltf => "gltf_pbr",
        }
    }

    pub(super) fn of_element(element: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|shader| shader.element() == element)
    }

    /// Its inputs, by the version of its definition.
    pub(super) fn keys(self, version: Option<&str>) -> Vec<Key> {
        let mut keys = match self {
            Self::Standard => STANDARD,
            Self::OpenPbr => OPEN_PBR,
            Self::Gltf => GLTF,
        }
        .to_vec();
        // 1.0.0 has its grey in the weight, 1.0.1 in the colour.
        if self == Self::Standard && version == Some("1.0.0") {
            for key in &mut keys {
                match key.role {
                    "base_weight" => key.default = [0.8; 3],
                    "base_color" => key.default = [1.0; 3],
                    _ => {}
                }
            }
        }
        keys
    }
}

const fn key(name: &'static str, role: &'static str, kind: Kind, default: f64) -> Key {
    Key { name, role, kind, default: [default; 3] }
}

/// A direction, whose default the geometry gives.
const fn vector(name: &'static str) -> Key {
    Key { name, role: name, kind: Kind::Vector, default: [f64::NAN; 3] }
}

/// What the shader does not have, at the value that the others would need.
const fn absent(role: &'static str, value: f64) -> Key {
    key("", role, Kind::Share, value)
}

const SIGNED: Kind = Kind::Number([-1.0, 1.0]);

const STANDARD: &[Key] = &[
    key("base", "base_weight", Kind::Share, 1.0),
    key("base_color", "base_color", Kind::Colour, 0.8),
    key("diffuse_roughness", "diffuse_roughness", Kind::Share, 0.0),
    key("metalness", "metalness", Kind::Share, 0.0),
    key("specular", "specular_weight", Kind::Share, 1.0),
    key("specular_color", "specular_color", Kind::Colour, 1.0),
    key("specular_roughness", "roughness", Kind::Share, 0.2),
    key("specular_IOR", "ior", INDEX, 1.5),
    key("specular_anisotropy", "anisotropy", Kind::Share, 0.0),
    key("specular_rotation", "rotation", FINITE, 0.0),
    key("transmission", "transmission", Kind::Share, 0.0),
    key("transmission_color", "transmission_color", Kind::Colour, 1.0),
    key("transmission_depth", "transmission_depth", POSITIVE, 0.0),
    key("transmission_scatter", "scatter", Kind::Light, 0.0),
    key("transmission_scatter_anisotropy", "scatter_anisotropy", SIGNED, 0.0),
    key("transmission_dispersion", "dispersion", POSITIVE, 0.0),
    key("transmission_extra_roughness", "extra_roughness", SIGNED, 0.0),
    key("subsurface", "subsurface", Kind::Share, 0.0),
    key("subsurface_color", "subsurface_color", Kind::Colour, 1.0),
    key("subsurface_radius", "subsurface_radius", Kind::Light, 1.0),
    key("subsurface_scale", "subsurface_scale", POSITIVE, 1.0),
    key("subsurface_anisotropy", "subsurface_anisotropy", SIGNED, 0.0),
    key("sheen", "sheen", Kind::Share, 0.0),
    key("sheen_color", "sheen_color", Kind::Colour, 1.0),
    key("sheen_roughness", "sheen_roughness", Kind::Share, 0.3),
    key("coat", "coat", Kind::Share, 0.0),
    key("coat_color", "coat_color", Kind::Colour, 1.0),
    key("coat_roughness", "coat_roughness", Kind::Share, 0.1),
    key("coat_anisotropy", "coat_anisotropy", Kind::Share, 0.0),
    key("coat_rotation", "coat_rotation", FINITE, 0.0),
    key("coat_IOR", "coat_ior", INDEX, 1.5),
    vector("coat_normal"),
    key("coat_affect_color", "coat_affect_color", Kind::Share, 0.0),
    key("coat_affect_roughness", "coat_affect_roughness", Kind::Share, 0.0),
    key("thin_film_thickness", "film", POSITIVE, 0.0),
    key("thin_film_IOR", "film_ior", INDEX, 1.5),
    key("emission", "emission", POSITIVE, 0.0),
    key("emission_color", "emission_color", Kind::Light, 1.0),
    key("opacity", "opacity", Kind::Colour, 1.0),
    key("thin_walled", "thin_walled", Kind::Flag, 0.0),
    vector("normal"),
    vector("tangent"),
];

const OPEN_PBR: &[Key] = &[
    key("base_weight", "base_weight", Kind::Share, 1.0),
    key("base_color", "base_color", Kind::Colour, 0.8),
    key("base_diffuse_roughness", "diffuse_roughness", Kind::Share, 0.0),
    key("base_metalness", "metalness", Kind::Share, 0.0),
    key("specular_weight", "specular_weight", POSITIVE, 1.0),
    key("specular_color", "specular_color", Kind::Colour, 1.0),
    key("specular_roughness", "roughness", Kind::Share, 0.3),
    key("specular_ior", "ior", INDEX, 1.5),
    key("specular_roughness_anisotropy", "anisotropy", Kind::Share, 0.0),
    key("transmission_weight", "transmission", Kind::Share, 0.0),
    key("transmission_color", "transmission_color", Kind::Colour, 1.0),
    key("transmission_depth", "transmission_depth", POSITIVE, 0.0),
    key("transmission_scatter", "scatter", Kind::Light, 0.0),
    key("transmission_scatter_anisotropy", "scatter_anisotropy", SIGNED, 0.0),
    key("transmission_dispersion_scale", "dispersion_scale", Kind::Share, 0.0),
    key("transmission_dispersion_abbe_number", "dispersion", POSITIVE, 20.0),
    key("subsurface_weight", "subsurface", Kind::Share, 0.0),
    key("subsurface_color", "subsurface_color", Kind::Colour, 0.8),
    key("subsurface_radius", "subsurface_radius", POSITIVE, 1.0),
    Key {
        name: "subsurface_radius_scale",
        role: "subsurface_scale",
        kind: Kind::Light,
        default: [1.0, 0.5, 0.25],
    },
    key("subsurface_scatter_anisotropy", "subsurface_anisotropy", SIGNED, 0.0),
    key("fuzz_weight", "sheen", Kind::Share, 0.0),
    key("fuzz_color", "sheen_color", Kind::Colour, 1.0),
    key("fuzz_roughness", "sheen_roughness", Kind::Share, 0.5),
    key("coat_weight", "coat", Kind::Share, 0.0),
    key("coat_color", "coat_color", Kind::Colour, 1.0),
    key("coat_roughness", "coat_roughness", Kind::Share, 0.0),
    key("coat_roughness_anisotropy", "coat_anisotropy", Kind::Share, 0.0),
    key("coat_ior", "coat_ior", INDEX, 1.6),
    key("coat_darkening", "coat_darkening", Kind::Share, 1.0),
    key("thin_film_weight", "film", Kind::Share, 0.0),
    key("thin_film_thickness", "film_thickness", POSITIVE, 0.5),
    key("thin_film_ior", "film_ior", INDEX, 1.4),
    key("emission_luminance", "emission", POSITIVE, 0.0),
    key("emission_color", "emission_color", Kind::Light, 1.0),
    key("geometry_opacity", "opacity", Kind::Share, 1.0),
    key("geometry_thin_walled", "thin_walled", Kind::Flag, 0.0),
    vector("geometry_normal"),
    vector("geometry_coat_normal"),
    vector("geometry_tangent"),
    vector("geometry_coat_tangent"),
];

const GLTF: &[Key] = &[
    absent("base_weight", 1.0),
    key("base_color", "base_color", Kind::Colour, 1.0),
    key("metallic", "metalness", Kind::Share, 1.0),
    key("roughness", "roughness", Kind::Share, 1.0),
    vector("normal"),
    vector("tangent"),
    key("occlusion", "occlusion", Kind::Share, 1.0),
    key("transmission", "transmission", Kind::Share, 0.0),
    key("specular", "specular_weight", Kind::Share, 1.0),
    key("specular_color", "specular_color", Kind::Light, 1.0),
    key("ior", "ior", INDEX, 1.5),
    key("alpha", "opacity", Kind::Share, 1.0),
    key("alpha_mode", "alpha_mode", Kind::Number([0.0, 2.0]), 0.0),
    key("alpha_cutoff", "alpha_cutoff", Kind::Share, 0.5),
    key("iridescence", "film", Kind::Share, 0.0),
    key("iridescence_ior", "film_ior", INDEX, 1.3),
    key("iridescence_thickness", "film_thickness", POSITIVE, 100.0),
    key("sheen_color", "sheen_color", Kind::Colour, 0.0),
    key("sheen_roughness", "sheen_roughness", Kind::Share, 0.0),
    key("clearcoat", "coat", Kind::Share, 0.0),
    key("clearcoat_roughness", "coat_roughness", Kind::Share, 0.0),
    vector("clearcoat_normal"),
    absent("coat_color", 1.0),
    absent("coat_ior", 1.5),
    key("emissive", "emission_color", Kind::Light, 0.0),
    key("emissive_strength", "emission", POSITIVE, 1.0),
    key("thickness", "thickness", POSITIVE, 0.0),
    key("attenuation_distance", "transmission_depth", POSITIVE, f64::INFINITY),
    key("attenuation_color", "transmission_color", Kind::Colour, 1.0),
    key("anisotropy_strength", "anisotropy", Kind::Share, 0.0),
    key("anisotropy_rotation", "rotation", FINITE, 0.0),
    key("dispersion", "dispersion", POSITIVE, 0.0),
];

/// What describes a coat.
const COAT: [&str; 8] = [
    "coat_color",
    "coat_roughness",
    "coat_anisotropy",
    "coat_rotation",
    "coat_ior",
    "coat_affect_color",
    "coat_affect_roughness",
    "coat_darkening",
];

/// What describes light that passes.
const PASSES: [&str; 7] = [
    "transmission_color",
    "transmission_depth",
    "scatter",
    "scatter_anisotropy",
    "dispersion",
    "dispersion_scale",
    "extra_roughness",
];

/// The inputs of a shader as a description.
pub(super) fn translate(shader: Shader, mut draft: Draft) -> Result<Imported, Vec<Finding>> {
    // What could not be read is missing below.
    let model = if draft.findings.is_empty() { model(shader, &mut draft) } else { None };
    draft.finish(model)
}

fn model(shader: Shader, d: &mut Draft) -> Option<Model> {
    surroundings(shader, d);
    let opacity = match shader {
        // The definition takes the luminance of the colour.
        Shader::Standard => Rgb(d.colour("opacity")).luminance(),
        Shader::OpenPbr => d.number("opacity"),
        Shader::Gltf if d.number("alpha_mode") == 0.0 => 1.0,
        Shader::Gltf => d.number("opacity"),
    };
    d.lacks(&["opacity", "alpha_cutoff"], 1.0 - opacity, "transparency without refraction");
    let film = match shader {
        Shader::Standard => f64::from(d.number("film") > 0.0),
        _ if d.number("film_thickness") == 0.0 => 0.0,
        _ => d.number("film"),
    };
    d.lacks(&["film", "film_thickness", "film_ior"], film, "a film of interference colours");
    let metal = d.share("metalness", &[], d.number("metalness"), "metal");
    let coat = d.share("coat", &COAT, d.number("coat"), "coat");
    let (metal, coat) = (metal?, coat?);
    let sheen = match shader {
        // Its layer lies below the metal's.
        Shader::Standard if metal => 0.0,
        Shader::Gltf => largest(d.colour("sheen_color")),
        _ => d.number("sheen") * largest(d.colour("sheen_color")),
    };
    let role = if shader == Shader::Gltf { "sheen_color" } else { "sheen" };
    d.lacks(&[role, "sheen_color", "sheen_roughness"], sheen, "sheen");
    if metal {
        return conductor(shader, d, coat);
    }
    let transmits = d.share("transmission", &PASSES, d.number("transmission"), "transmission")?;
    if transmits && coat {
        let help = "set the weight of the coat to 0: glass reflects by itself";
        d.refuse(Code::NoEqual, "coat", "a coat over a transmitting body has no equal here", help);
    }
    if !d.findings.is_empty() {
        return None;
    }
    if transmits { transmitting(shader, d) } else { opaque(shader, d, coat) }
}

/// What is not of the scattering at a surface.
fn surroundings(shader: Shader, d: &mut Draft) {
    let emitted = d.number("emission") * largest(d.colour("emission_color"));
    if emitted > 0.0 {
        let text =
            format!("a material does not emit: {} of radiance is to be a light beside it", show(emitted));
        d.note(&["emission", "emission_color"], Fate::Dropped, text);
    }
    let vectors: Vec<_> = d.keys.iter().filter(|key| key.kind == Kind::Vector).map(|key| key.role).collect();
    d.note(&vectors, Fate::Dropped, "directions are the geometry's, not the material's");
    let occluded = 1.0 - d.number("occlusion");
    if shader == Shader::Gltf && occluded > 0.0 {
        let text = format!("shadows are computed: {} of the ambient light was baked away", show(occluded));
        d.dropped("occlusion", text);
    }
}

/// αx and αy, as the shader makes them of its roughness, under a coat or not.
fn alphas(shader: Shader, d: &mut Draft, coat: bool) -> [f64; 2] {
    let (given, anisotropy) = (d.number("roughness"), d.number("anisotropy"));
    let coat_roughness = d.number("coat_roughness");
    let roughness = match shader {
        Shader::Standard if coat => {
            let share = d.number("coat_affect_roughness") * d.number("coat") * coat_roughness;
            d.exact("coat_affect_roughness", "in the roughness of the base");
            given + (1.0 - given) * share
        }
        // The coat widens what passes it twice; lobes add up in the fourth powers of their roughness.
        Shader::OpenPbr if coat => (given.powi(4) + 2.0 * coat_roughness.powi(4)).min(1.0).powf(0.25),
        _ => given,
    };
    let square = roughness * roughness;
    let alphas = match shader {
        // Limits as in the definition of the node roughness_anisotropy.
        Shader::Standard => {
            let aspect = (1.0 - anisotropy.min(0.98)).sqrt();
            [(square / aspect).min(1.0), square * aspect]
        }
        Shader::OpenPbr => {
            let along = square * (2.0 / (1.0 + (1.0 - anisotropy).powi(2))).sqrt();
            [along, along * (1.0 - anisotropy)]
        }
        Shader::Gltf => [square + (1.0 - square) * anisotropy * anisotropy, square],
    };
    let mut text = format!("perceptual: α = r² = {} of GGX", show(square));
    if roughness != given {
        text = format!("{text}, r = {} as widened by the coat", show(roughness));
    }
    if alphas[0] != alphas[1] {
        text =
            format!("{text}, made αx = {} and αy = {} by the anisotropy", show(alphas[0]), show(alphas[1]));
    }
    d.exact("roughness", text);
    alphas
}

/// Anisotropy of a surface that has none here.
fn level(d: &mut Draft, alphas: [f64; 2]) -> f64 {
    let mean = (alphas[0] * alphas[1]).sqrt();
    if alphas[0] != alphas[1] {
        let [x, y] = alphas.map(show);
        let text = format!("αx = {x} and αy = {y}: here both are {}, their geometric mean", show(mean));
        d.note(&["anisotropy", "rotation"], Fate::Dropped, text);
    }
    mean
}

/// The interface of the coat, and what it absorbs.
fn put_coat(shader: Shader, d: &mut Draft) {
    let alpha = d.number("coat_roughness").powi(2);
    let eta = d.number("coat_ior");
    d.set("coat.eta", eta, "coat_ior");
    d.set("coat.alpha", alpha, "coat_roughness");
    d.set("coat.distribution", "ggx", "coat_roughness");
    d.exact("coat_ior", "η of the coat");
    d.exact("coat_roughness", format!("perceptual: α = r² = {} of GGX", show(alpha)));
    if d.number("coat_anisotropy") > 0.0 {
        let ratio = show(1.0 - d.number("coat_anisotropy"));
        let text = format!("the coat is isotropic here; the file has αy = {ratio} αx");
        d.note(&["coat_anisotropy", "coat_rotation"], Fate::Dropped, text);
    }
    let colour = d.colour("coat_color");
    if colour == [1.0; 3] {
        return;
    }
    // Light passes the coat twice: straight down and up it keeps e^{−2σ}.
    let sigma = absorbance(colour, 2.0);
    d.set("coat.thickness", 1.0, "coat_color");
    d.set("coat.absorbance", sigma, "coat_color");
    let text = format!("σ = −ln(c) / 2 = {} at thickness 1", show_colour(sigma));
    if shader == Shader::OpenPbr {
        d.exact("coat_color", text);
    } else {
        // At 90° the way inside is longer by 1 / cos θ'; there both ways are, at most.
        let longest = 1.0 / (1.0 - 1.0 / (eta * eta)).sqrt();
        let error = largest(colour.map(|c| c - c.powf(longest)));
        let text =
            format!("{text}: as the file straight down, darker by up to {} at grazing angles", show(error));
        d.converted("coat_color", text);
    }
}

fn conductor(shader: Shader, d: &mut Draft, coat: bool) -> Option<Model> {
    let base = d.colour("base_color").map(|c| c * d.number("base_weight"));
    let weight = d.number("specular_weight");
    let tint = d.colour("specular_color");
    let (mut eta, mut k);
    match shader {
        Shader::Standard => {
            let edge = tint.map(|c| c * weight);
            let index: [_; 3] = core::array::from_fn(|c| gulbrandsen(base[c], edge[c]));
            (eta, k) = (index.map(|[eta, _]| eta), index.map(|[_, k]| k));
            let text = format!("F at 0° = {}: η and k by Gulbrandsen's formula", show_colour(base));
            d.note(&["base_weight", "base_color"], Fate::Exact, text);
            d.note(&["specular_weight", "specular_color"], Fate::Exact, "edge tint of Gulbrandsen's formula");
        }
        Shader::OpenPbr | Shader::Gltf => {
            let (tint, weight) = if shader == Shader::OpenPbr { (tint, weight) } else { ([1.0; 3], 1.0) };
            if largest(base) * weight > 1.0 {
                let text = format!(
                    "F at 0° is {}: more light would leave than arrives",
                    show(largest(base) * weight)
                );
                d.refuse(
                    Code::Meaningless,
                    "specular_weight",
                    text,
                    "a weight of at most 1 is meant for metals",
                );
                return None;
            }
            let fit = metal_like_f82(base, tint, weight);
            (eta, k) = (fit.eta, fit.k);
            let curve = if shader == Shader::OpenPbr { "the F82 formula" } else { "Schlick's formula" };
            let text = format!("η and k of {curve} at 0° and 82°; elsewhere {}", fit.error_in_words());
            d.note(&["base_weight", "base_color"], fit.fate(), text.clone());
            if shader == Shader::OpenPbr {
                d.note(&["specular_weight", "specular_color"], fit.fate(), text);
            }
        }
    }
    let alphas = alphas(shader, d, coat);
    let alpha = (alphas[0] * alphas[1]).sqrt();
    if coat {
        put_coat(shader, d);
        let immersed = d.number("coat_ior");
        eta = eta.map(|eta| eta * immersed);
        k = k.map(|k| k * immersed);
        if shader == Shader::OpenPbr && d.number("coat_darkening") < 1.0 {
            let kept = (1.0 - d.number("coat_darkening")) * returned_inside(immersed);
            let text = format!("light that the coat returns is followed: darker by up to {}", show(kept));
            d.dropped("coat_darkening", text);
        }
        if d.number("coat_affect_color") > 0.0 {
            // The definition applies it to the diffuse colours only.
            d.exact("coat_affect_color", "without effect on a metal");
        }
    }
    d.set("eta", eta, "base_color");
    d.set("k", k, "base_color");
    d.set("alpha", alpha, "roughness");
    d.set("distribution", "ggx", "roughness");
    if alpha > 0.0 && !coat {
        d.set("scattering", "all", "roughness");
    }
    if alphas[0] != alphas[1] {
        d.set("anisotropy", alphas[1] / alphas[0], "anisotropy");
        let [x, y] = alphas.map(show);
        d.exact("anisotropy", format!("αx = {x}, αy = {y}"));
        let degrees = match shader {
            Shader::Standard => 360.0 * d.number("rotation"),
            _ => d.number("rotation").to_degrees(),
        };
        if degrees != 0.0 {
            d.set("rotation_deg", degrees, "rotation");
            let text = format!(
                "{}° counter-clockwise about the normal, as glTF; shaders differ in the sense",
                show(degrees)
            );
            d.note(&["rotation"], if shader == Shader::Gltf { Fate::Exact } else { Fate::Converted }, text);
        }
    }
    Some(if coat { Model::CarPaint } else { Model::Metal })
}

fn transmitting(shader: Shader, d: &mut Draft) -> Option<Model> {
    let is_thin = match shader {
        Shader::Gltf => d.number("thickness") == 0.0,
        _ => d.number("thin_walled") != 0.0,
    };
    let weight = d.number("specular_weight");
    let tint = d.colour("specular_color");
    let given = d.number("ior");
    // In OpenPBR the weight is of F₀, elsewhere of the reflected light.
    let (eta, reflection) = match shader {
        Shader::OpenPbr => (weighted_index(given, weight), tint),
        _ => (given, tint.map(|c| c * weight)),
    };
    d.set("eta", eta, "ior");
    d.exact("ior", "index of refraction η");
    let alphas = alphas(shader, d, false);
    let alpha = level(d, alphas);
    dispersion(shader, d, given);
    let passes = if shader == Shader::Gltf { d.colour("base_color") } else { d.colour("transmission_color") };
    let passes_role = if shader == Shader::Gltf { "base_color" } else { "transmission_color" };
    let depth = d.number("transmission_depth");
    if largest(d.colour("scatter")) > 0.0 {
        let help = "set the scattering to 0 for a clear body, or take an opaque material";
        d.refuse(Code::NoEqual, "scatter", "a body that scatters within has no equal here", help);
        return None;
    }
    if is_thin {
        if alpha > CLEAR {
            let text = format!("a thin sheet with α = {} has no equal here: sheets are clear", show(alpha));
            d.refuse(Code::NoEqual, "roughness", text, "set the roughness to 0, or give the sheet two faces");
            return None;
        }
        d.set("transmission", passes, passes_role);
        let r = f0_of(eta);
        let text = format!(
            "a sheet with both faces: reflects 2R / (1 + R) = {} straight on, where one face has {}",
            show(2.0 * r / (1.0 + r)),
            show(r)
        );
        // glTF's sheet is what has no thickness, which the file need not say.
        d.rather(if shader == Shader::Gltf { "transmission" } else { "thin_walled" }, Fate::Converted, text);
        d.exact(passes_role, "multiplies what passes");
        let tinted = (1.0 - smallest(reflection)) * 2.0 * r / (1.0 + r);
        d.lacks(&["specular_color", "specular_weight"], tinted, "a tint of what a sheet reflects");
        return Some(Model::ThinGlass);
    }
    d.set("alpha", alpha, "roughness");
    d.set("distribution", "ggx", "roughness");
    if reflection != [1.0; 3] {
        d.set("reflection", reflection, if weight == 1.0 { "specular_color" } else { "specular_weight" });
        let text = format!(
            "tint {} of the reflected light, which the transmitted light does not gain",
            show_colour(reflection)
        );
        d.note(&["specular_weight", "specular_color"], Fate::Converted, text);
    }
    if shader == Shader::OpenPbr && weight != 1.0 {
        d.exact("specular_weight", format!("scales F at 0°: η = {}", show(eta)));
    }
    let extra = d.number("extra_roughness");
    if extra != 0.0 {
        let refracted = (d.number("roughness") + extra).clamp(0.0, 1.0).powi(2);
        let text =
            format!("light refracts with the α of reflection here; the file has α = {}", show(refracted));
        d.dropped("extra_roughness", text);
    }
    let absorbs = match shader {
        Shader::Gltf => d.given("transmission_depth").is_some(),
        _ => depth > 0.0,
    };
    d.exact("thickness", "above 0: a body, not a sheet");
    let mut boundary = if shader == Shader::Gltf { passes } else { [1.0; 3] };
    if absorbs {
        if depth == 0.0 {
            let help = "leave it out for a clear body";
            d.refuse(Code::Meaningless, "transmission_depth", "a colour at the depth 0", help);
            return None;
        }
        let sigma = absorbance(d.colour("transmission_color"), depth);
        d.set("absorbance_inside", sigma, "transmission_color");
        let text = format!("absorbance −ln(c) / d = {} per length of the file", show_colour(sigma));
        d.note(&["transmission_color", "transmission_depth"], Fate::Exact, text);
    } else if shader != Shader::Gltf {
        boundary = passes;
    }
    if boundary != [1.0; 3] {
        d.set("transmission", boundary, passes_role);
    }
    d.exact(passes_role, "a tint at every boundary: twice through a body with two faces");
    if alpha > 0.0 && boundary == [1.0; 3] && reflection == [1.0; 3] {
        d.set("scattering", "all", "roughness");
    }
    Some(Model::Glass)
}

/// By how much one index for all colours is wrong.
fn dispersion(shader: Shader, d: &mut Draft, eta: f64) {
    let number = d.number("dispersion");
    let spread = match shader {
        // An Abbe number, where 0 is none; the same under a scale; 20 over an Abbe number.
        Shader::Standard if number > 0.0 => (eta - 1.0) / number,
        Shader::OpenPbr if number > 0.0 => (eta - 1.0) * d.number("dispersion_scale") / number,
        Shader::Gltf => (eta - 1.0) * number / 20.0,
        _ => 0.0,
    };
    if spread != 0.0 {
        let text = format!(
            "one index for all colours; in the file it is {} more at 486 than at 656 nm",
            show(spread)
        );
        d.note(&["dispersion", "dispersion_scale"], Fate::Dropped, text);
    }
}

fn opaque(shader: Shader, d: &mut Draft, coat: bool) -> Option<Model> {
    let diffuse = diffuse_colour(shader, d, coat);
    let tint = d.colour("specular_color");
    let weight = d.number("specular_weight") * Rgb(tint).luminance();
    let ior = d.number("ior");
    let has_highlight = weight > 0.0 && ior != 1.0;
    if !has_highlight && !coat {
        diffuse_roughness(shader, d, false);
        d.note(&["base_weight", "base_color"], Fate::Exact, "reflectance, with no highlight above");
        d.note(&["specular_weight", "specular_color", "ior"], Fate::Exact, "no highlight");
        d.set("reflectance", diffuse, "base_color");
        return Some(Model::Matte);
    }
    diffuse_roughness(shader, d, true);
    let (eta, seen);
    if coat {
        put_coat(shader, d);
        eta = d.number("coat_ior");
        // OpenPBR's base lies in the coat, the others' in air.
        let relative = if shader == Shader::OpenPbr { ior / eta } else { ior };
        let f0 = weight * f0_of(relative);
        let highlight = ["ior", "specular_weight", "specular_color", "roughness", "anisotropy", "rotation"];
        d.lacks(&highlight, f0, "a highlight below the coat");
        d.note(&highlight, Fate::Exact, "no highlight below the coat");
        let returned = returned_inside(eta);
        let darkening = d.number("coat_darkening");
        d.exact("coat_darkening", "light that the coat returns, in the colour of the base");
        seen = diffuse.map(|rho| {
            let darker = (1.0 - returned) / (1.0 - rho * returned);
            rho * (1.0 - darkening + darkening * darker)
        });
    } else {
        let alphas = alphas(shader, d, false);
        let alpha = level(d, alphas);
        eta = weighted_index(ior, weight);
        d.set("coat.eta", eta, "ior");
        d.set("coat.alpha", alpha, "roughness");
        d.set("coat.distribution", "ggx", "roughness");
        d.exact("ior", format!("index of refraction, with its weight η = {}", show(eta)));
        let spread = (largest(tint) - smallest(tint)) * d.number("specular_weight") * f0_of(ior);
        if weight != 1.0 {
            let text = format!("scales F at 0°: η = {}", show(eta));
            let is_same = shader == Shader::OpenPbr && tint == [1.0; 3];
            let (fate, text) = if is_same {
                (Fate::Exact, text)
            } else {
                let grazing = show_colour(tint.map(|c| c * d.number("specular_weight")));
                (Fate::Converted, format!("{text}; at 90° the file has {grazing} in place of 1"))
            };
            d.note(&["specular_weight"], fate, text.clone());
            if spread > 0.0 {
                let text =
                    format!("{text}; the colour of the highlight is lost, {} straight on", show(spread));
                d.dropped("specular_color", text);
            } else {
                d.note(&["specular_color"], fate, text);
            }
        }
        seen = diffuse;
    }
    let reflectance = below(seen, eta);
    d.set("reflectance", reflectance, "base_color");
    let text = format!(
        "{} below the interface: the share (1 − F) {} leaves, exact if smooth; it spreads by refraction",
        show_colour(reflectance),
        show_colour(seen)
    );
    d.note(&["base_weight", "base_color"], Fate::Converted, text);
    Some(Model::Plastic)
}

/// Diffuse and subsurface reflectance together.
fn diffuse_colour(shader: Shader, d: &mut Draft, coat: bool) -> [f64; 3] {
    let share = d.number("subsurface");
    let is_thin = d.number("thin_walled") != 0.0;
    if is_thin {
        let roles = ["subsurface", "subsurface_color", "subsurface_anisotropy"];
        d.lacks(&roles, share, "light through a thin wall");
    }
    let share = if is_thin { 0.0 } else { share };
    let exponent = match shader {
        Shader::Standard if coat => 1.0 + d.number("coat") * d.number("coat_affect_color"),
        _ => 1.0,
    };
    let [base, inner] =
        ["base_color", "subsurface_color"].map(|role| d.colour(role).map(|c| c.powf(exponent)));
    if exponent != 1.0 {
        d.exact("coat_affect_color", format!("the colours below the coat to the power {}", show(exponent)));
    }
    if share > 0.0 {
        let text =
            "mixed into the reflectance: as much light of the same colour, which leaves where it entered";
        d.note(&["subsurface", "subsurface_color"], Fate::Converted, text);
        let text = "light is not moved along the surface: wrong at details smaller than this";
        d.note(&["subsurface_radius", "subsurface_scale", "subsurface_anisotropy"], Fate::Dropped, text);
    }
    let base = product(base, [d.number("base_weight") * (1.0 - share); 3]);
    core::array::from_fn(|c| base[c] + share * inner[c])
}

/// Largest r = B / A of Fujii's model that an angle σ ≤ π/2 gives.
const LARGEST_FUJII: f64 = 0.776;

fn diffuse_roughness(shader: Shader, d: &mut Draft, is_below: bool) {
    let roughness = d.number("diffuse_roughness");
    if roughness == 0.0 {
        return;
    }
    if shader == Shader::Standard {
        d.set("sigma_rad", roughness, "diffuse_roughness");
        let (fate, text) = if is_below {
            (Fate::Converted, "σ of Oren & Nayar in radians, for directions refracted into the coat")
        } else {
            (Fate::Exact, "σ of Oren & Nayar in radians")
        };
        d.note(&["diffuse_roughness"], fate, text);
        return;
    }
    // EON takes r = B / A itself, which is here given by σ: with s = σ²,
    // (0.45 − 0.5 r) s² + (0.1485 − 0.375 r) s − 0.0297 r = 0.
    let r = roughness.min(LARGEST_FUJII);
    let (a, b, c) = (0.45 - 0.5 * r, 0.1485 - 0.375 * r, -0.0297 * r);
    let s = (-b + (b * b - 4.0 * a * c).sqrt()) / (2.0 * a);
    d.set("sigma_rad", s.sqrt(), "diffuse_roughness");
    d.set("diffuse", "energy_preserving", "diffuse_roughness");
    let text = format!("EON with r = {} at σ = {}", show(r), show(s.sqrt()));
    if r < roughness {
        // f = ρ / π · A_F (1 + r s / t), −1 ≤ s / t ≤ 1.
        let a_f = |r: f64| 1.0 / (1.0 + (0.5 - 2.0 / (3.0 * core::f64::consts::PI)) * r);
        let largest = |r: f64| a_f(r) * (1.0 + r);
        let error = largest(roughness) / largest(r) - 1.0;
        d.converted(
            "diffuse_roughness",
            format!("{text}, the largest here: off by {} of itself", show(error)),
        );
    } else if is_below {
        d.converted("diffuse_roughness", format!("{text}, for directions refracted into the coat"));
    } else {
        d.exact("diffuse_roughness", text);
    }
}

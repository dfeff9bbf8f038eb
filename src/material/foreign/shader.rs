//! What the inputs of `standard_surface`, `open_pbr_surface` and `gltf_pbr` mean here.
//!
//! The definitions are the graphs of the MaterialX library (`libraries/bxdf`). The inputs for the inside of
//! bodies, thin walls and dispersion, which the graphs leave to the renderer, are those of I. Georgiev et
//! al., "Autodesk Standard Surface" 1.0.1, 2019; Z. Andersson et al., "OpenPBR Surface specification" 1.1,
//! ASWF 2024; Khronos, "glTF 2.0" with KHR_materials_volume, appendix B. Of OpenPBR the specification wins,
//! and the table of losses says so, for the weight of a metal (once; the graph has it twice at the edge),
//! for light that a coat returns (the mean reflectance of the interface in place of F at 0°; over metals by
//! their roughness) and for the colour of a coat over a metal (by the way inside; over a diffuse base the
//! graph wins, whose colour is the same at every angle). The three share their structure, so that one table
//! of roles serves all. The library's shaders give back what single scattering loses at rough facets: here
//! `scattering` = all, where a model has it.

use super::{
    CLEAR, Draft, FINITE, Fate, INDEX, Imported, Key, Kind, POSITIVE, SHARE, absorbance, below, f0_of,
    gulbrandsen, largest, lost_to_coat, metal_like_f82, product, returned_inside, show, show_colour,
    smallest, weighted_index,
};
use crate::fresnel::dielectric;
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
        // The graph takes a luminance of the colour; what a channel can lose is more.
        Shader::Standard => smallest(d.colour("opacity")),
        Shader::OpenPbr => d.number("opacity"),
        Shader::Gltf => alpha(d)?,
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
        // Nor is it on what transmits.
        Shader::Standard => {
            (1.0 - d.number("transmission")) * d.number("sheen") * largest(d.colour("sheen_color"))
        }
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

/// The share of a glTF surface that is there, by the mode of its alpha: opaque, mask or blend.
fn alpha(d: &mut Draft) -> Option<f64> {
    let (alpha, cutoff, mode) = (d.number("opacity"), d.number("alpha_cutoff"), d.number("alpha_mode"));
    if mode.fract() != 0.0 {
        let help = "write 0 for opaque, 1 for a mask or 2 for a blend";
        d.refuse(Code::Meaningless, "alpha_mode", "not the number of a mode", help);
        return None;
    }
    d.exact("alpha_mode", "how alpha is read: 0 opaque, 1 mask, 2 blend");
    if mode == 1.0 {
        if alpha >= cutoff {
            let text =
                format!("a mask: {} is not below the cutoff {}, all is there", show(alpha), show(cutoff));
            d.note(&["opacity", "alpha_cutoff"], Fate::Exact, text);
        }
        return Some(f64::from(alpha >= cutoff));
    }
    d.exact("alpha_cutoff", "without effect where alpha is no mask");
    if mode == 0.0 {
        d.exact("opacity", "without effect in the opaque mode");
        return Some(1.0);
    }
    Some(alpha)
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

/// The largest F at 0° of `artistic_ior` in the MaterialX library.
const GULBRANDSEN_LIMIT: f64 = 0.99;

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
    let alphas = widths(shader, roughness, anisotropy);
    let mut text = format!("perceptual: α = r² = {} of GGX", show(square));
    if roughness != given {
        text = format!("{text}, r = {} as widened by the coat", show(roughness));
    }
    if alphas[0] != alphas[1] {
        text =
            format!("{text}, made αx = {} and αy = {} by the anisotropy", show(alphas[0]), show(alphas[1]));
    }
    if coat {
        // The half vector turns by as much inside; refraction at a small angle turns by η of that.
        let text =
            format!("{text}; its highlight is {} times as wide above the coat", show(d.number("coat_ior")));
        d.converted("roughness", text);
    } else {
        d.exact("roughness", text);
    }
    alphas
}

/// αx and αy of a roughness.
fn widths(shader: Shader, roughness: f64, anisotropy: f64) -> [f64; 2] {
    let square = roughness * roughness;
    match shader {
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
    }
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

/// The interface of the coat.
fn put_coat(d: &mut Draft) {
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
}

/// What a coat over a metal absorbs. Over a diffuse base its colour is in that of the base.
fn put_coat_colour(d: &mut Draft) {
    let colour = d.colour("coat_color");
    let eta = d.number("coat_ior");
    // A coat of another index is refused as such.
    if colour == [1.0; 3] || eta < 1.0 {
        return;
    }
    // Light passes the coat twice: straight down and up it keeps e^{−2σ}. At θ the way inside is longer by
    // 1 / cos θ', where the graph has the same colour.
    let sigma = absorbance(colour, 2.0);
    let lost = |degrees: u32| {
        let boundary = dielectric(f64::from(degrees).to_radians().cos(), eta);
        let longer = 1.0 / boundary.cos_theta_t;
        boundary.transmittance.unpolarized() * largest(colour.map(|c| c - c.powf(longer)))
    };
    let error = (0..90).map(lost).fold(0.0, f64::max);
    if error > SHARE {
        let text = format!("darker by up to {} at an angle, by its longer way: no equal here", show(error));
        d.refuse(Code::NoEqual, "coat_color", text, "take a colour nearer to white or a larger index");
        return;
    }
    d.set("coat.thickness", 1.0, "coat_color");
    d.set("coat.absorbance", sigma, "coat_color");
    let text = format!(
        "σ = −ln(c) / 2 = {} at thickness 1, twice straight down; darker by up to {} at an angle, and more \
         after internal reflections",
        show_colour(sigma),
        show(error)
    );
    d.converted("coat_color", text);
}

fn conductor(shader: Shader, d: &mut Draft, coat: bool) -> Option<Model> {
    let base = d.colour("base_color").map(|c| c * d.number("base_weight"));
    let weight = d.number("specular_weight");
    let tint = d.colour("specular_color");
    let (mut eta, mut k);
    let (mut fate, mut text, mut edge);
    match shader {
        Shader::Standard => {
            let edge_tint = tint.map(|c| c * weight);
            let index: [_; 3] = core::array::from_fn(|c| gulbrandsen(base[c], edge_tint[c]));
            (eta, k) = (index.map(|[eta, _]| eta), index.map(|[_, k]| k));
            fate = Fate::Exact;
            text = format!("F at 0° = {}: η and k by Gulbrandsen's formula", show_colour(base));
            if largest(base) > GULBRANDSEN_LIMIT {
                fate = Fate::Converted;
                let error = show(largest(base) - GULBRANDSEN_LIMIT);
                text = format!("{text}; MaterialX's own code stops at {GULBRANDSEN_LIMIT}: off by {error}");
            }
            edge = (fate, "edge tint of Gulbrandsen's formula".to_owned());
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
            fate = fit.fate();
            text = format!("η and k of {curve} at 0° and 82°; elsewhere {}", fit.error_in_words());
            edge = (fate, text.clone());
            if shader == Shader::OpenPbr && weight != 1.0 {
                edge = (Fate::Converted, format!("{text}; the weight once: the graph has it twice at 82°"));
            }
        }
    }
    let alphas = alphas(shader, d, coat);
    let alpha = (alphas[0] * alphas[1]).sqrt();
    if coat {
        put_coat(d);
        put_coat_colour(d);
        let immersed = d.number("coat_ior");
        eta = eta.map(|eta| eta * immersed);
        k = k.map(|k| k * immersed);
        fate = Fate::Converted;
        text = format!("{text}; below the coat at the refracted angle");
        edge = (fate, format!("{}; below the coat at the refracted angle", edge.1));
        let metal_weight = if shader == Shader::OpenPbr { weight } else { 1.0 };
        let darker = lost_to_coat(base.map(|c| c * metal_weight), immersed);
        if shader == Shader::OpenPbr {
            let kept = (1.0 - d.number("coat_darkening")) * darker;
            let help = "set coat_darkening to 1, as light that the coat returns is followed here";
            let what = "light that the coat returns and the file keeps";
            if kept > SHARE {
                let what = format!("{} of {what} has no equal here", show(kept));
                d.refuse(Code::NoEqual, "coat_darkening", what, help);
            } else if kept > 0.0 {
                d.dropped("coat_darkening", format!("{what} is lost: up to {} of the light", show(kept)));
            }
            let text = format!(
                "followed by the roughness as in the specification; the graph is darker by up to {}",
                show(darker)
            );
            d.converted("coat_darkening", text);
        } else {
            text = format!("{text}; darker by up to {} by what the coat returns", show(darker));
        }
        if d.number("coat_affect_color") > 0.0 {
            // The definition applies it to the diffuse colours only.
            d.exact("coat_affect_color", "without effect on a metal");
        }
    }
    d.note(&["base_weight", "base_color"], fate, text);
    if shader != Shader::Gltf {
        d.note(&["specular_weight", "specular_color"], edge.0, edge.1);
    }
    d.set("eta", eta, "base_color");
    d.set("k", k, "base_color");
    d.set("alpha", alpha, if d.given("roughness").is_some() { "roughness" } else { "anisotropy" });
    d.set("distribution", "ggx", "roughness");
    if alpha > 0.0 && !coat {
        d.set("scattering", "all", "roughness");
    }
    if alphas[0] != alphas[1] {
        d.set("anisotropy", alphas[1] / alphas[0], "anisotropy");
        let [x, y] = alphas.map(show);
        d.exact("anisotropy", format!("αx = {x}, αy = {y}"));
        // Whole turns change nothing.
        let degrees = match shader {
            Shader::Standard => 360.0 * (d.number("rotation") % 1.0),
            _ => (d.number("rotation") % core::f64::consts::TAU).to_degrees(),
        };
        if degrees == 0.0 {
            d.exact("rotation", "no turn, or whole ones");
        }
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
    let eta_role = weighted_role(d, eta != given);
    d.set("eta", eta, eta_role);
    d.exact("ior", "index of refraction η");
    let depth = d.number("transmission_depth");
    let interior = ["scatter", "scatter_anisotropy"];
    if is_thin && shader != Shader::Gltf {
        let roles = [&interior[..], &["transmission_depth"]].concat();
        d.note(&roles, Fate::Exact, "a thin wall has no interior");
    } else if depth == 0.0 {
        d.note(&interior, Fate::Exact, "without a depth there is no interior");
    } else if largest(d.colour("scatter")) > 0.0 {
        let help = "set the scattering to 0 for a clear body, or take an opaque material";
        d.refuse(Code::NoEqual, "scatter", "a body that scatters within has no equal here", help);
        return None;
    }
    dispersion(shader, d, given);
    let passes = if shader == Shader::Gltf { d.colour("base_color") } else { d.colour("transmission_color") };
    let passes_role = if shader == Shader::Gltf { "base_color" } else { "transmission_color" };
    // Light may refract by another roughness than it reflects by. Of a sheet the wider α counts.
    let (roughness, anisotropy) = (d.number("roughness"), d.number("anisotropy"));
    let extra = d.number("extra_roughness");
    let single = |[x, y]: [f64; 2]| if is_thin { x.max(y) } else { (x * y).sqrt() };
    let [reflected, refracted] =
        [roughness, (roughness + extra).clamp(0.0, 1.0)].map(|r| single(widths(shader, r, anisotropy)));
    let tinted = largest(reflection.map(|c| (1.0 - c).abs()));
    if is_thin {
        for (role, alpha) in [("roughness", reflected), ("extra_roughness", refracted)] {
            if alpha > CLEAR {
                let text =
                    format!("a thin sheet with α = {} has no equal here: sheets are clear", show(alpha));
                d.refuse(Code::NoEqual, role, text, "set the roughness to 0, or give the sheet two faces");
                return None;
            }
            if alpha > 0.0 {
                let roles = [role, "anisotropy", "rotation"];
                d.note(&roles, Fate::Dropped, format!("taken as clear, with α = {}", show(alpha)));
            }
        }
        d.exact("roughness", "a clear sheet, as here");
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
        let tints = ["specular_weight", "specular_color"];
        let roles = if reflection == tint { &tints[1..] } else { &tints };
        d.lacks(roles, tinted * 2.0 * r / (1.0 + r), "a tint of what a sheet reflects");
        if shader == Shader::OpenPbr && weight != 1.0 {
            d.exact("specular_weight", format!("scales F at 0°: η = {}", show(eta)));
        }
        return Some(Model::ThinGlass);
    }
    let alphas = alphas(shader, d, false);
    let alpha = level(d, alphas);
    d.set("alpha", alpha, "roughness");
    d.set("distribution", "ggx", "roughness");
    if shader == Shader::OpenPbr && weight != 1.0 {
        d.exact("specular_weight", format!("scales F at 0°: η = {}", show(eta)));
    }
    if reflection != [1.0; 3] {
        d.set("reflection", reflection, if weight == 1.0 { "specular_color" } else { "specular_weight" });
        let text = format!(
            "tint {} of the reflected light, which the transmitted light does not gain",
            show_colour(reflection)
        );
        d.note(&["specular_weight", "specular_color"], Fate::Converted, text);
    }
    if refracted != reflected {
        // The total variation between the slopes of two GGX surfaces, (b − a) / (a + b). What is clear either
        // way is not blurred.
        let [low, high] = [reflected.min(refracted), reflected.max(refracted)];
        let moved = if high <= CLEAR { 0.0 } else { (high - low) / (high + low) };
        let text = format!(
            "light refracts with the α of reflection here; the file has α = {}, which sends {} of the light \
             elsewhere",
            show(refracted),
            show(moved)
        );
        if moved > SHARE {
            let help = "set it to 0, and the roughness to that of refraction";
            d.refuse(Code::NoEqual, "extra_roughness", text, help);
            return None;
        }
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
        if smallest(d.colour("transmission_color")) == 0.0 {
            let text = "a channel of 0 at a depth is an infinite absorbance";
            d.refuse(Code::Meaningless, "transmission_color", text, "write the smallest share that is meant");
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

/// The input that an index comes from, which may be weighted.
fn weighted_role(d: &Draft, is_weighted: bool) -> &'static str {
    let mut weights = ["specular_weight", "specular_color"].into_iter().filter(|_| is_weighted);
    weights.find(|role| d.given(role).is_some()).unwrap_or("ior")
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
    let (diffuse, subsurface) = diffuse_colour(shader, d, coat);
    let tint = d.colour("specular_color");
    let weight = d.number("specular_weight") * Rgb(tint).luminance();
    let ior = d.number("ior");
    let has_highlight = weight > 0.0 && ior != 1.0;
    if !has_highlight && !coat {
        diffuse_roughness(shader, d, subsurface, false);
        d.note(&["base_weight", "base_color"], Fate::Exact, "reflectance, with no highlight above");
        d.note(&["specular_weight", "specular_color", "ior"], Fate::Exact, "no highlight");
        d.set("reflectance", diffuse, "base_color");
        return Some(Model::Matte);
    }
    diffuse_roughness(shader, d, subsurface, true);
    let (eta, seen);
    if coat {
        put_coat(d);
        eta = d.number("coat_ior");
        // OpenPBR's base lies in the coat, the others' in air.
        let relative = if shader == Shader::OpenPbr { ior / eta } else { ior };
        let f0 = weight * f0_of(relative);
        let highlight = ["ior", "specular_weight", "specular_color", "roughness", "anisotropy", "rotation"];
        d.lacks(&highlight, f0, "a highlight below the coat");
        d.note(&highlight, Fate::Exact, "no highlight below the coat");
        let returned = returned_inside(eta);
        let darkening = d.number("coat_darkening");
        if darkening == 0.0 {
            d.exact("coat_darkening", "light that the coat returns is in the colour of the base");
        }
        let text = format!(
            "light that the coat returns, K = {} of the mean reflectance; the graph has K = {} of F at 0°",
            show(returned),
            show(1.0 - (1.0 - f0_of(eta)) / (eta * eta))
        );
        d.converted("coat_darkening", text);
        let darkened = diffuse.map(|rho| {
            let darker = (1.0 - returned) / (1.0 - rho * returned);
            rho * (1.0 - darkening + darkening * darker)
        });
        // The graph multiplies what is below the coat, at every angle.
        seen = product(darkened, d.colour("coat_color"));
        if shader == Shader::OpenPbr && d.colour("coat_color") != [1.0; 3] {
            let text = "multiplies the reflectance as in the graph; by the specification more at an angle";
            d.converted("coat_color", text);
        } else {
            d.exact("coat_color", "multiplies the reflectance at every angle");
        }
    } else {
        let alphas = alphas(shader, d, false);
        let alpha = level(d, alphas);
        eta = weighted_index(ior, weight);
        let eta_role = weighted_role(d, eta != ior);
        d.set("coat.eta", eta, eta_role);
        d.set("coat.alpha", alpha, "roughness");
        d.set("coat.distribution", "ggx", "roughness");
        d.exact("ior", format!("index of refraction, with its weight η = {}", show(eta)));
        let spread = (largest(tint) - smallest(tint)) * d.number("specular_weight") * f0_of(ior);
        if d.number("specular_weight") != 1.0 || tint != [1.0; 3] {
            let text = format!("scales F at 0°: η = {}", show(eta));
            // What the shader has in place of 1.
            let grazing = match shader {
                Shader::Standard => tint.map(|c| c * d.number("specular_weight")),
                Shader::OpenPbr => tint,
                Shader::Gltf => [d.number("specular_weight"); 3],
            };
            let (fate, text) = if grazing == [1.0; 3] {
                (Fate::Exact, text)
            } else {
                let grazing = show_colour(grazing);
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

/// Diffuse and subsurface reflectance together, and the share of the latter.
fn diffuse_colour(shader: Shader, d: &mut Draft, coat: bool) -> ([f64; 3], f64) {
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
    (core::array::from_fn(|c| base[c] + share * inner[c]), share)
}

/// Largest r = B / A of Fujii's model that an angle σ ≤ π/2 gives.
const LARGEST_FUJII: f64 = 0.776;

fn diffuse_roughness(shader: Shader, d: &mut Draft, subsurface: f64, is_below: bool) {
    let roughness = d.number("diffuse_roughness");
    if roughness == 0.0 {
        return;
    }
    if subsurface == 1.0 {
        d.exact("diffuse_roughness", "without effect: all is subsurface light, with no diffuse lobe");
        return;
    }
    let converted = [
        (is_below, ", for directions refracted into the coat".to_owned()),
        (subsurface > 0.0, format!(", also of {} of subsurface light, which has none", show(subsurface))),
    ];
    let is_converted = converted.iter().any(|(is, _)| *is);
    let remarks: String = converted.into_iter().filter(|(is, _)| *is).map(|(_, text)| text).collect();
    let fate = if is_converted { Fate::Converted } else { Fate::Exact };
    if shader == Shader::Standard {
        d.set("sigma_rad", roughness, "diffuse_roughness");
        d.note(&["diffuse_roughness"], fate, format!("σ of Oren & Nayar in radians{remarks}"));
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
            format!("{text}, the largest here: off by {} of itself{remarks}", show(error)),
        );
    } else {
        d.note(&["diffuse_roughness"], fate, format!("{text}{remarks}"));
    }
}

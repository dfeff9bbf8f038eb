//! Material files of other programs: what they become, what the tables of losses say, and what is refused.
//!
//! `tests/foreign_materials` holds files of our own in the manner of what Blender, Maya, 3ds Max and the
//! examples of the MaterialX library write.

#![allow(clippy::unwrap_used, clippy::panic, reason = "the helpers of tests may panic as tests do")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use approx::assert_abs_diff_eq;
use gonio::bxdf::{Bxdf, TransportMode};
use gonio::fresnel::{Lazanyi, conductor, dielectric, normal_incidence, schlick};
use gonio::material::foreign::{Fate, Imported, materialx, mtl};
use gonio::material::{Model, Value, flattened};
use gonio::message::{Code, Finding};
use gonio::rgb::xyz_to_linear_srgb;
use rand::RngExt as _;
use rand_pcg::Pcg64;

type Read = (Vec<Imported>, Vec<Finding>);

fn files() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/foreign_materials");
    let mut files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(files.len() > 10);
    files
}

fn text(name: &str) -> String {
    let file = files().into_iter().find(|file| file.file_name().unwrap() == name);
    std::fs::read_to_string(file.unwrap()).unwrap()
}

fn read(name: &str, text: &str) -> Read {
    if name.ends_with(".mtl") { mtl(text) } else { materialx(text) }
}

/// A material of a case file.
fn material(file: &str, name: &str) -> Imported {
    let (materials, _) = read(file, &text(file));
    let names: Vec<_> = materials.iter().map(|material| material.name.clone()).collect();
    let material = materials.into_iter().find(|material| material.name == name);
    material.unwrap_or_else(|| panic!("no {name} among {names:?}"))
}

/// A material of a text that holds one.
fn only((materials, findings): Read) -> Imported {
    assert_eq!(findings, []);
    let [material] = <[_; 1]>::try_from(materials).unwrap();
    material
}

/// One shader of MaterialX with inputs in the form `name=value;name=value`.
fn shader_text(element: &str, inputs: &str) -> String {
    let mut text = format!("<materialx version=\"1.39\"><{element} name=\"it\" type=\"surfaceshader\">");
    for input in inputs.split(';').filter(|input| !input.is_empty()) {
        let (name, value) = input.split_once('=').unwrap();
        write!(text, "<input name=\"{name}\" value=\"{value}\"/>").unwrap();
    }
    format!("{text}</{element}></materialx>")
}

fn shader(element: &str, inputs: &str) -> Read {
    materialx(&shader_text(element, inputs))
}

fn number(material: &Imported, path: &str) -> f64 {
    match material.description.value(path).unwrap() {
        Some(&Value::Number(number)) => number,
        other => panic!("{path} of {} is {other:?}", material.name),
    }
}

fn colour(material: &Imported, path: &str) -> [f64; 3] {
    match material.description.value(path).unwrap() {
        Some(&Value::Number(grey)) => [grey; 3],
        Some(&Value::Colour(colour)) => colour,
        other => panic!("{path} of {} is {other:?}", material.name),
    }
}

fn choice(material: &Imported, path: &str) -> String {
    match material.description.value(path).unwrap() {
        Some(Value::Text(text)) => text.to_string(),
        other => panic!("{path} of {} is {other:?}", material.name),
    }
}

#[track_caller]
fn assert_near(found: [f64; 3], expected: [f64; 3], tolerance: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert_abs_diff_eq!(found, expected, epsilon = tolerance);
    }
}

#[track_caller]
fn assert_model(material: &Imported, model: Model, paths: &[&str]) {
    assert_eq!(material.description.model(), model, "{}", material.name);
    let mut given: Vec<_> = material.description.given().iter().map(|(path, _)| path.as_str()).collect();
    let mut paths = paths.to_vec();
    given.sort_unstable();
    paths.sort_unstable();
    assert_eq!(given, paths, "{}", material.name);
}

/// The fates of the losses as letters, in the order of the file.
fn fates(material: &Imported) -> String {
    let letter = |fate| match fate {
        Fate::Exact => 'e',
        Fate::Converted => 'c',
        Fate::Dropped => 'd',
    };
    material.losses.iter().map(|loss| letter(loss.fate)).collect()
}

/// What the table says of a key.
#[track_caller]
fn loss<'a>(material: &'a Imported, key: &str) -> (Fate, &'a str) {
    let of = |entry: &&str| *entry == key || entry.starts_with(&format!("{key} "));
    let mut found = material.losses.iter().filter(|loss| of(&loss.key.as_str()));
    let loss = found.next().unwrap_or_else(|| panic!("no loss {key} in {:?}", material.losses));
    assert!(found.next().is_none(), "{key} twice");
    (loss.fate, &loss.text)
}

/// 1 − K(0) of an interface with η = 1.5: its mean transmittance from inside, of F̄ = 0.0917779593424.
const ESCAPES_1_5: f64 = (1.0 - 0.091_777_959_342_4) / 2.25;

fn below_1_5(seen: f64) -> f64 {
    seen / (ESCAPES_1_5 + seen * (1.0 - ESCAPES_1_5))
}

// Wavefront .mtl.

#[test]
fn blender_states_its_roughness_as_an_exponent_of_its_own() {
    let ceramic = material("blender.mtl", "Ceramic");
    assert_model(&ceramic, Model::Plastic, &["reflectance", "coat.eta", "coat.alpha", "coat.distribution"]);
    assert_near(colour(&ceramic, "reflectance"), [0.8, 0.65, 0.5].map(below_1_5), 1e-9);
    assert_eq!((number(&ceramic, "coat.eta"), number(&ceramic, "coat.alpha")), (1.5, 0.25));
    assert_eq!(choice(&ceramic, "coat.distribution"), "ggx");
    assert_eq!(fates(&ceramic), "cdcdeeee");
    let (_, text) = loss(&ceramic, "Ns");
    assert!(text.contains("0.25") && text.contains("would be 0.08909"), "{text}");
    assert_eq!(loss(&ceramic, "Ks").0, Fate::Dropped);

    let plaster = material("blender.mtl", "Plaster.001");
    assert_model(&plaster, Model::Matte, &["reflectance"]);
    assert_eq!(colour(&plaster, "reflectance"), [0.5; 3]);
    let (fate, text) = loss(&plaster, "Kd");
    assert!(
        fate == Fate::Converted && text.ends_with("if the program wrote sRGB, 0.214 was meant"),
        "{text}"
    );

    // Without a heading the exponent is Blinn's and Phong's; older headings have another scale.
    let plain = text_of_ns("");
    assert_abs_diff_eq!(number(&plain, "coat.alpha"), (2.0 / 227.0_f64).sqrt(), epsilon = 1e-15);
    assert_eq!(choice(&plain, "coat.distribution"), "beckmann");
    let older = text_of_ns("# Blender MTL File: 'x.blend'\n# Material Count: 1\n");
    assert_abs_diff_eq!(number(&older, "coat.alpha"), 0.25, epsilon = 1e-15);
    let beyond = only(mtl("# Blender 4.0\nnewmtl a\nKd 0.5\nKs 1\nNs 1001\n"));
    assert_abs_diff_eq!(number(&beyond, "coat.alpha"), (2.0 / 1003.0_f64).sqrt(), epsilon = 1e-15);
}

fn text_of_ns(heading: &str) -> Imported {
    only(mtl(&format!("{heading}\nnewmtl a\nKd 0.5\nKs 1\nNs 225\n")))
}

#[test]
fn the_keys_of_renderers_are_metal_lacquer_and_car_paint() {
    let file = "blender_pbr.mtl";
    let brass = material(file, "BrushedBrass");
    let paths = ["eta", "k", "alpha", "distribution", "anisotropy", "rotation_deg"];
    assert_model(&brass, Model::Metal, &paths);
    let [alpha, ratio, degrees] = ["alpha", "anisotropy", "rotation_deg"].map(|path| number(&brass, path));
    assert_eq!((alpha, ratio, degrees), (0.25, 0.55, 90.0));
    let base = [0.887, 0.789, 0.434];
    for channel in 0..3 {
        let [eta, k] = ["eta", "k"].map(|path| colour(&brass, path)[channel]);
        let at = |cos: f64| conductor(cos, eta, k).reflectance.unpolarized();
        assert_abs_diff_eq!(at(1.0), base[channel], epsilon = 1e-9);
        assert_abs_diff_eq!(at(1.0 / 7.0), schlick(1.0 / 7.0, base[channel]), epsilon = 1e-9);
    }
    assert_eq!(fates(&brass), "dcdeeeeeeeeecc");

    let paint = material(file, "CarPaint");
    let paths = ["eta", "k", "alpha", "distribution", "coat.eta", "coat.alpha", "coat.distribution"];
    assert_model(&paint, Model::CarPaint, &paths);
    for (channel, f0) in [0.9, 0.1, 0.05].into_iter().enumerate() {
        // Below the coat the index is divided again.
        let [eta, k] = ["eta", "k"].map(|path| colour(&paint, path)[channel] / 1.5);
        assert_abs_diff_eq!(normal_incidence(eta, k), f0, epsilon = 1e-9);
    }
    assert_abs_diff_eq!(number(&paint, "coat.alpha"), 0.01, epsilon = 1e-15);

    let lacquer = material(file, "Lacquer");
    assert_eq!(lacquer.description.model(), Model::Plastic);
    assert_abs_diff_eq!(number(&lacquer, "coat.alpha"), 0.04, epsilon = 1e-15);
    assert_near(colour(&lacquer, "reflectance"), [0.2, 0.02, 0.01].map(below_1_5), 1e-9);
    assert_eq!(
        fates(&lacquer),
        "cdededed" /* Kd Ni illum Pr Pm Pc Pcr Ps */
            .to_owned()
            + "d"
    );
    assert!(loss(&lacquer, "Pc").1.contains("by up to 0.05 of the light"));
    assert!(loss(&lacquer, "Ps").1.contains("up to 0.05 of the light"));
    assert!(loss(&lacquer, "Pr").1.contains("0.04 of the light"));

    let plastic = material(file, "Plastic");
    assert_eq!(colour(&plastic, "reflectance"), [0.0, 1.0, 0.0]);
    assert_eq!(loss(&plastic, "Ns"), (Fate::Exact, "Pr is in its place"));
    assert_eq!(loss(&plastic, "aniso").0, Fate::Dropped);
}

#[test]
fn maya_writes_opaque_materials_in_the_model_of_glass() {
    let lambert = material("maya.mtl", "lambert2SG");
    assert_model(&lambert, Model::Matte, &["reflectance"]);
    assert_eq!(fates(&lambert), "eceee");
    let phong = material("maya.mtl", "phong1SG");
    assert_model(&phong, Model::Plastic, &["reflectance", "coat.eta", "coat.alpha"]);
    assert_abs_diff_eq!(number(&phong, "coat.alpha"), 0.1_f64.sqrt(), epsilon = 1e-15);
    assert_eq!(loss(&phong, "Ni").0, Fate::Dropped);
    assert_eq!(number(&phong, "coat.eta"), 1.5);
}

#[test]
fn glass_refracts_and_a_pane_does_not() {
    let glass = material("3ds_max.mtl", "Glass Green");
    assert_model(&glass, Model::Glass, &["eta", "transmission", "alpha"]);
    // Two boundaries, of which each takes the root.
    assert_near(colour(&glass, "transmission"), [0.5, 0.9, 0.6], 1e-15);
    assert_eq!((number(&glass, "eta"), number(&glass, "alpha")), (1.52, 0.0));
    assert_eq!(fates(&glass), "deeceeed");
    let pane = material("3ds_max.mtl", "Pane");
    assert_model(&pane, Model::ThinGlass, &["eta", "transmission"]);
    assert_eq!(fates(&pane), "dccee");
    assert!(loss(&pane, "Kd").1.contains("up to 0.05 of the light"));
    assert_eq!(pane.losses[0].key, "Kd 0.5 0.5 0.5");
    let frosted = material("3ds_max.mtl", "Frosted");
    assert_eq!((frosted.description.model(), number(&frosted, "alpha")), (Model::Glass, 0.25));
    // The model of glass with much diffuse light and no word of what passes is opaque.
    let opaque = only(mtl("newmtl a\nKd 0.5\nillum 7\n"));
    assert_eq!(opaque.description.model(), Model::Matte);
}

#[test]
fn illumination_models_of_1995() {
    let mirror = material("classic.mtl", "silver mirror");
    assert_model(&mirror, Model::Mirror, &["reflectance"]);
    assert_eq!(colour(&mirror, "reflectance"), [0.95, 0.94, 0.92]);
    assert_eq!(fates(&mirror), "ecded");
    let copper = material("classic.mtl", "copper");
    assert_model(&copper, Model::Metal, &["eta", "k", "alpha"]);
    assert_eq!(number(&copper, "alpha"), 0.0);
    let snow = material("classic.mtl", "snow");
    let xyz = [0.855_413_1, 0.9, 0.979_963_2];
    assert_eq!(colour(&snow, "reflectance"), xyz_to_linear_srgb(xyz).0);
    assert_eq!(fates(&snow), "eed");
    let brick = material("classic.mtl", "brick");
    assert_eq!(fates(&brick), "cddd");
    assert!(loss(&brick, "Kx").1.starts_with("no key of the format"));
    assert_eq!(material("classic.mtl", "lamp").description.model(), Model::Matte);
}

// MaterialX.

#[test]
fn standard_surface_becomes_what_it_means() {
    let file = "standard_surface.mtlx";
    let plastic = material(file, "Plastic");
    assert_model(&plastic, Model::Plastic, &["reflectance", "coat.eta", "coat.alpha", "coat.distribution"]);
    assert_near(colour(&plastic, "reflectance"), [below_1_5(0.5); 3], 1e-9);
    assert_eq!(number(&plastic, "coat.eta"), 1.5);
    assert_abs_diff_eq!(number(&plastic, "coat.alpha"), 0.04, epsilon = 1e-15);
    assert_eq!(fates(&plastic), "dcceeeeee");

    // Gulbrandsen's formula the other way round: reflectance and edge tint of η and k.
    let gold = material(file, "Gold");
    assert_model(&gold, Model::Metal, &["eta", "k", "alpha", "distribution", "scattering"]);
    let (base, edge) = ([0.944, 0.776, 0.373], [0.998, 0.981, 0.751]);
    for channel in 0..3 {
        let [eta, k] = ["eta", "k"].map(|path| colour(&gold, path)[channel]);
        let r = normal_incidence(eta, k);
        let largest = (1.0 + r.sqrt()) / (1.0 - r.sqrt());
        let g = (largest - eta) / (largest - (1.0 - r) / (1.0 + r));
        assert_abs_diff_eq!(r, base[channel], epsilon = 1e-12);
        assert_abs_diff_eq!(g, edge[channel], epsilon = 1e-12);
    }
    assert_eq!(fates(&gold), "eeeeee");

    let brushed = material(file, "Brushed");
    assert_eq!((number(&brushed, "anisotropy"), number(&brushed, "rotation_deg")), (0.25, 45.0));
    assert_abs_diff_eq!(number(&brushed, "alpha"), 0.09, epsilon = 1e-15);
    assert_eq!(fates(&brushed), "eeeece");

    let glass = material(file, "Glass");
    assert_near(colour(&glass, "absorbance_inside"), [0.9, 0.5, 0.25].map(|c: f64| -c.ln() / 2.0), 1e-15);
    assert_eq!(number(&glass, "eta"), 1.52);
    let whole = glass.description.material::<f64>().unwrap().transmittance(2.0, true);
    assert_near(whole.0, [0.9, 0.5, 0.25], 1e-15);
    assert_eq!(fates(&glass), "eeeeeed");
    assert!(loss(&glass, "transmission_dispersion").1.contains("0.01 more"));
    assert_eq!(glass.losses[5].key, "transmission_depth = 2 meter");

    let paint = material(file, "Car_Paint");
    assert_eq!(paint.description.model(), Model::Plastic);
    let seen = [0.5 * 0.103_779_2 * 0.8, 0.5 * 0.592_120_29 * 0.9, 0.5 * 0.850_649_36];
    assert_near(colour(&paint, "reflectance"), seen.map(below_1_5), 1e-9);
    assert_eq!(number(&paint, "coat.alpha"), 0.0);
    assert_eq!(fates(&paint), "ccdeee");

    let clay = material(file, "Clay");
    assert_model(&clay, Model::Matte, &["reflectance", "sigma_rad"]);
    assert_eq!(number(&clay, "sigma_rad"), 0.4);
    assert_eq!(fates(&clay), "eeed");
    assert_eq!(colour(&material(file, "Grey_of_1_0_0"), "reflectance"), [0.8; 3]);

    let window = material(file, "Window");
    assert_model(&window, Model::ThinGlass, &["eta", "transmission"]);
    assert_eq!(loss(&window, "thin_walled").0, Fate::Converted);
    assert!(loss(&window, "thin_walled").1.contains("0.07692"));

    let skin = material(file, "Skin");
    let eta = number(&skin, "coat.eta");
    assert_abs_diff_eq!(normal_incidence(eta, 0.0), 0.02, epsilon = 1e-12);
    assert_eq!(
        fates(&skin),
        "cccc" /* base_color specular subsurface its colour */
            .to_owned()
            + "dd"
    );
}

#[test]
fn plastic_returns_the_share_that_the_file_means() {
    for ior in [1.3, 1.5, 2.0] {
        let inputs = format!("base=1;base_color=0.1,0.5,1;specular_roughness=0;specular_IOR={ior}");
        let plastic = only(shader("standard_surface", &inputs));
        let plastic = plastic.description.material::<f64>().unwrap();
        for cos in [1.0, 0.5, 0.2] {
            let wo = glam::DVec3::new(f64::sqrt(1.0 - cos * cos), 0.0, cos);
            let f = dielectric(cos, ior).reflectance.unpolarized();
            let expected = [0.1, 0.5, 1.0].map(|seen| f + (1.0 - f) * seen);
            assert_near(plastic.albedo(wo).0, expected, 1e-4);
        }
    }
}

#[test]
fn open_pbr_surface_becomes_what_it_means() {
    let file = "open_pbr_surface.mtlx";
    let paint = material(file, "Paint");
    // Its coat darkens the base as ours does.
    assert_near(colour(&paint, "reflectance"), [0.1, 0.6, 0.9], 1e-12);
    assert_eq!(fates(&paint), "ceeeee");
    let undarkened = only(shader(
        "open_pbr_surface",
        "base_color=0.5,0.5,0.5;coat_weight=1;coat_ior=1.5;coat_darkening=0",
    ));
    assert_near(colour(&undarkened, "reflectance"), [below_1_5(0.5); 3], 1e-9);
    // Its base has another index than the coat.
    assert!(loss(&undarkened, "base_color").1.contains("0.7124"));

    let glass = material(file, "Glass");
    assert_model(&glass, Model::Glass, &["eta", "alpha", "distribution"]);
    assert_eq!(fates(&glass), "eeedd");
    assert!(loss(&glass, "transmission_dispersion_abbe_number").1.contains("0.008125"));

    let aluminium = material(file, "Aluminium");
    for (channel, (f0, tint)) in [(0.912, 0.970), (0.914, 0.979), (0.920, 0.988)].into_iter().enumerate() {
        let [eta, k] = ["eta", "k"].map(|path| colour(&aluminium, path)[channel]);
        let curve = Lazanyi::new(f0, tint * schlick(1.0 / 7.0, f0));
        for (degrees, tolerance) in [(0.0, 1e-9), (81.786_789, 1e-7), (45.0, 0.009), (85.0, 0.009)] {
            let cos = f64::to_radians(degrees).cos();
            let found = conductor(cos, eta, k).reflectance.unpolarized();
            assert_abs_diff_eq!(found, curve.reflectance(cos), epsilon = tolerance);
        }
    }
    // αx = r² √(2 / (1 + (1 − a)²)), αy = (1 − a) αx.
    let along = 0.16 * (2.0 / 1.25_f64).sqrt();
    assert_abs_diff_eq!(number(&aluminium, "alpha"), along * 0.5_f64.sqrt(), epsilon = 1e-15);
    assert_abs_diff_eq!(number(&aluminium, "anisotropy"), 0.5, epsilon = 1e-15);
    assert_eq!(fates(&aluminium), "cecee");

    let metallic = material(file, "Metallic_Paint");
    assert_eq!(metallic.description.model(), Model::CarPaint);
    let widened = (0.5_f64.powi(4) + 2.0 * 0.4_f64.powi(4)).sqrt();
    assert_abs_diff_eq!(number(&metallic, "alpha"), widened, epsilon = 1e-15);
    assert_near(colour(&metallic, "coat.absorbance"), [-0.9_f64.ln(); 3], 1e-15);

    // σ of which Fujii's B / A is the roughness of the file.
    let clay = material(file, "Clay");
    let square = number(&clay, "sigma_rad").powi(2);
    let [a, b] = [1.0 - 0.5 * square / (square + 0.33), 0.45 * square / (square + 0.09)];
    assert_abs_diff_eq!(b / a, 0.5, epsilon = 1e-12);
    assert_eq!(choice(&clay, "diffuse"), "energy_preserving");
    assert_eq!(fates(&clay), "eee");

    let dull = material(file, "Dull");
    assert_abs_diff_eq!(normal_incidence(number(&dull, "coat.eta"), 0.0), 0.01, epsilon = 1e-12);
    assert_eq!(fates(&dull), "cee");
    assert!(loss(&dull, "base_diffuse_roughness").1.contains("off by 0.06975 of itself"));
    // A metal whose whole reflectance has a weight.
    let half =
        only(shader("open_pbr_surface", "base_color=0.8,0.8,0.8;base_metalness=1;specular_weight=0.5"));
    let [eta, k] = ["eta", "k"].map(|path| colour(&half, path)[0]);
    assert_abs_diff_eq!(normal_incidence(eta, k), 0.4, epsilon = 1e-12);
}

#[test]
fn gltf_pbr_becomes_what_it_means() {
    let file = "gltf_pbr.mtlx";
    let copper = material(file, "Copper");
    for (channel, f0) in [0.955, 0.638, 0.538].into_iter().enumerate() {
        let [eta, k] = ["eta", "k"].map(|path| colour(&copper, path)[channel]);
        assert_abs_diff_eq!(normal_incidence(eta, k), f0, epsilon = 1e-12);
    }
    assert_eq!(fates(&copper), "ceeee");
    let toy = material(file, "Toy");
    assert_near(
        colour(&toy, "reflectance"),
        [0.214_041_140_482, 0.010_022_825_574, 0.010_022_825_574].map(below_1_5),
        1e-9,
    );
    assert_eq!(fates(&toy), "ceede");
    assert_eq!(toy.losses[0].key, "base_color = 0.5, 0.1, 0.1 (srgb_texture)");
    let lacquered = material(file, "Lacquered");
    assert_eq!(fates(&lacquered), "cedee");
    let sheet = material(file, "Sheet");
    assert_eq!(
        (sheet.description.model(), colour(&sheet, "transmission")),
        (Model::ThinGlass, [0.8, 0.9, 1.0])
    );
    assert_eq!(fates(&sheet), "eeec");
    let amber = material(file, "Amber");
    assert_near(colour(&amber, "absorbance_inside"), [0.9, 0.5, 0.1].map(|c: f64| -c.ln() / 0.5), 1e-15);
    assert_eq!(fates(&amber), "eeeeeee");
    // The default of the format is a white metal: everything is reflected at every angle.
    let white = only(shader("gltf_pbr", ""));
    assert_eq!((colour(&white, "eta"), colour(&white, "k")), ([0.0; 3], [1.0; 3]));
}

/// The defaults of the definitions in the MaterialX library. Vectors have none that a file could repeat.
const DEFAULTS: [(&str, &str); 3] = [
    (
        "standard_surface",
        "base=1.0;base_color=0.8,0.8,0.8;diffuse_roughness=0;metalness=0;specular=1;\
             specular_color=1,1,1;specular_roughness=0.2;specular_IOR=1.5;specular_anisotropy=0;\
             specular_rotation=0;transmission=0;transmission_color=1,1,1;transmission_depth=0;\
             transmission_scatter=0,0,0;transmission_scatter_anisotropy=0;\
             transmission_dispersion=0;transmission_extra_roughness=0;subsurface=0;\
             subsurface_color=1,1,1;subsurface_radius=1,1,1;subsurface_scale=1;\
             subsurface_anisotropy=0;sheen=0;sheen_color=1,1,1;sheen_roughness=0.3;coat=0;\
             coat_color=1,1,1;coat_roughness=0.1;coat_anisotropy=0.0;coat_rotation=0.0;\
             coat_IOR=1.5;coat_affect_color=0;coat_affect_roughness=0;thin_film_thickness=0;\
             thin_film_IOR=1.5;emission=0;emission_color=1,1,1;opacity=1,1,1;thin_walled=false",
    ),
    (
        "open_pbr_surface",
        "base_weight=1.0;base_color=0.8,0.8,0.8;base_diffuse_roughness=0.0;base_metalness=0.0;\
             specular_weight=1.0;specular_color=1,1,1;specular_roughness=0.3;specular_ior=1.5;\
             specular_roughness_anisotropy=0.0;transmission_weight=0.0;transmission_color=1,1,1;\
             transmission_depth=0.0;transmission_scatter=0,0,0;\
             transmission_scatter_anisotropy=0.0;transmission_dispersion_scale=0.0;\
             transmission_dispersion_abbe_number=20.0;subsurface_weight=0;\
             subsurface_color=0.8,0.8,0.8;subsurface_radius=1.0;\
             subsurface_radius_scale=1.0,0.5,0.25;subsurface_scatter_anisotropy=0.0;\
             fuzz_weight=0.0;fuzz_color=1,1,1;fuzz_roughness=0.5;coat_weight=0.0;coat_color=1,1,1;\
             coat_roughness=0.0;coat_roughness_anisotropy=0.0;coat_ior=1.6;coat_darkening=1.0;\
             thin_film_weight=0;thin_film_thickness=0.5;thin_film_ior=1.4;emission_luminance=0.0;\
             emission_color=1,1,1;geometry_opacity=1;geometry_thin_walled=false",
    ),
    (
        "gltf_pbr",
        "base_color=1,1,1;metallic=1;roughness=1;occlusion=1;transmission=0;specular=1;\
             specular_color=1,1,1;ior=1.5;alpha=1;alpha_mode=0;alpha_cutoff=0.5;iridescence=0;\
             iridescence_ior=1.3;iridescence_thickness=100;sheen_color=0,0,0;sheen_roughness=0;\
             clearcoat=0;clearcoat_roughness=0;emissive=0,0,0;emissive_strength=1;thickness=0;\
             attenuation_color=1,1,1",
    ),
];

#[test]
fn an_input_at_its_default_loses_nothing() {
    for (element, inputs) in DEFAULTS {
        let material = only(shader(element, inputs));
        assert_eq!(material.losses.len(), inputs.split(';').count(), "{element}");
        for loss in &material.losses {
            // The diffuse colour is raised to that below the interface, whatever it is.
            let is_colour = loss.key.starts_with("base") && loss.text.contains("below the interface");
            assert!(loss.fate == Fate::Exact || is_colour, "{element}: {loss:?}");
            assert_ne!(loss.text, "without effect on this material", "{element}: {loss:?}");
        }
    }
}

#[test]
fn colours_are_decoded_into_linear_rec_709() {
    let file = "colour_spaces.mtlx";
    assert_near(colour(&material(file, "aces"), "reflectance"), [0.5; 3], 1e-12);
    // The matrix as ACES prints it (aces-dev, AP1 to Rec. 709 with D60 to D65 by Bradford), to its digits.
    let matrix =
        [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
    let rec709 = matrix.map(|row| row[0] * 0.5 + row[1] * 0.3 + row[2] * 0.2);
    assert_near(colour(&material(file, "aces_red"), "reflectance"), rec709, 1e-5);
    let srgb = material(file, "srgb");
    assert_near(colour(&srgb, "reflectance"), [0.214_041_140_482, 0.04 / 12.92, 1.0], 1e-12);
    assert_eq!(loss(&srgb, "base_color").0, Fate::Exact);
    assert_near(colour(&material(file, "gamma"), "reflectance"), [0.5_f64.powf(2.2); 3], 1e-15);
    let in_space = |space: &str, value: &str| {
        let text = format!(
            "<materialx version=\"1.38\" colorspace=\"{space}\"><gltf_pbr name=\"a\">\
             <input name=\"metallic\" value=\"0\"/><input name=\"specular\" value=\"0\"/>\
             <input name=\"base_color\" value=\"{value}\"/></gltf_pbr></materialx>"
        );
        colour(&only(materialx(&text)), "reflectance")
    };
    // A half in each: itself, IEC 61966-2-1, or the power of the name (of Adobe RGB 563 / 256).
    let srgb = 0.214_041_140_482_232_6;
    for (space, half) in [
        ("lin_rec709", 0.5),
        ("none", 0.5),
        ("srgb_texture", srgb),
        ("g18_rec709", 0.287_174_588_749_259),
        ("gamma18", 0.287_174_588_749_259),
        ("g22_rec709", 0.217_637_640_824_031),
        ("gamma22", 0.217_637_640_824_031),
        ("rec709_display", 0.189_464_570_813_798),
        ("gamma24", 0.189_464_570_813_798),
        ("acescg", 0.5),
        ("lin_ap1", 0.5),
        ("g22_ap1", 0.217_637_640_824_031),
        ("lin_displayp3", 0.5),
        ("srgb_displayp3", srgb),
        ("lin_adobergb", 0.5),
        ("adobergb", 0.217_755_528_144_395),
    ] {
        assert_eq!(in_space(space, "1,1,1"), [1.0; 3], "{space}");
        assert_eq!(in_space(space, "0,0,0"), [0.0; 3], "{space}");
        assert_near(in_space(space, "0.5,0.5,0.5"), [half; 3], 1e-12);
    }
    // Primaries at half strength over grey have the chromaticities of their space.
    for (space, primaries) in [
        ("lin_displayp3", [[0.68, 0.32], [0.265, 0.69], [0.15, 0.06]]),
        ("lin_adobergb", [[0.64, 0.33], [0.21, 0.71], [0.15, 0.06]]),
    ] {
        for (channel, [x, y]) in primaries.into_iter().enumerate() {
            let mut mixed = [0.4; 3];
            mixed[channel] = 0.5;
            let ours = in_space(space, &mixed.map(|c| c.to_string()).join(",")).map(|c| c - 0.4);
            let theirs = xyz_to_linear_srgb([x / y, 1.0, (1.0 - x - y) / y]).0;
            let sum = |colour: [f64; 3]| colour.iter().sum::<f64>();
            assert_near(ours.map(|c| c / sum(ours)), theirs.map(|c| c / sum(theirs)), 1e-9);
        }
    }
}

/// An input that no arm of the translation knows would be told as without effect.
#[test]
fn every_input_of_every_shader_has_its_fate() {
    // The fate of an input (x: refused at its place, o: at that of another), the input at a value that is not
    // the default, and the others that make it count.
    let cases = [
        (
            "standard_surface",
            "c base=0.5 | c base_color=0.1,0.2,0.3 | c diffuse_roughness=0.3 | e metalness=1 | \
             c specular=0.5 | d specular_color=0.5,0.6,0.7 | e specular_roughness=0.4 | \
             e specular_IOR=1.6 | d specular_anisotropy=0.5 | \
             c specular_rotation=0.1 metalness=1;specular_anisotropy=0.5 | e transmission=1 | \
             e transmission_color=0.5,0.5,0.5 transmission=1 | \
             e transmission_depth=2 transmission=1;transmission_color=0.5,0.5,0.5 | \
             x transmission_scatter=1,1,1 transmission=1;transmission_depth=1 | \
             d transmission_dispersion=30 transmission=1 | \
             x transmission_extra_roughness=0.1 transmission=1 | c subsurface=0.5 | \
             c subsurface_color=0.5,0.4,0.3 subsurface=0.5 | \
             d subsurface_radius=2,2,2 subsurface=0.5 | d subsurface_scale=2 subsurface=0.5 | \
             d subsurface_anisotropy=0.2 subsurface=0.5 | d sheen=0.05 | e coat=1 | \
             e coat_color=0.5,0.6,0.7 coat=1 | e coat_roughness=0.2 coat=1 | \
             d coat_anisotropy=0.2 coat=1 | d coat_rotation=0.2 coat=1;coat_anisotropy=0.2 | \
             e coat_IOR=1.4 coat=1 | d coat_normal=0,0,1 | e coat_affect_color=0.5 coat=1 | \
             e coat_affect_roughness=0.5 coat=1;metalness=1 | x thin_film_thickness=300 | \
             d emission=1 | d emission_color=0.5,0.5,0.5 emission=1 | d opacity=0.95,0.95,0.95 | \
             c thin_walled=true transmission=1;specular_roughness=0 | d normal=0,0,1 | \
             d tangent=1,0,0 | d sheen_color=0.5,0.5,0.5 sheen=0.05 | \
             d sheen_roughness=0.5 sheen=0.05 | o thin_film_IOR=1.4 thin_film_thickness=300 | \
             d coat_color=0.5,0.5,0.5 coat=0.05 | d transmission_depth=3 transmission=0.05",
        ),
        (
            "open_pbr_surface",
            "c base_weight=0.5 | c base_color=0.1,0.2,0.3 | c base_diffuse_roughness=0.3 | \
             e base_metalness=1 | e specular_weight=0.5 | d specular_color=0.5,0.6,0.7 | \
             e specular_roughness=0.4 | e specular_ior=1.6 | d specular_roughness_anisotropy=0.5 | \
             e transmission_weight=1 | e transmission_color=0.5,0.5,0.5 transmission_weight=1 | \
             e transmission_depth=2 transmission_weight=1;transmission_color=0.5,0.5,0.5 | \
             x transmission_scatter=1,1,1 transmission_weight=1;transmission_depth=1 | \
             d transmission_dispersion_scale=1 transmission_weight=1 | \
             d transmission_dispersion_abbe_number=30 transmission_weight=1;transmission_dispersion_scale=1 | \
             c subsurface_weight=0.5 | c subsurface_color=0.5,0.4,0.3 subsurface_weight=0.5 | \
             d subsurface_radius=2 subsurface_weight=0.5 | \
             d subsurface_radius_scale=1,1,1 subsurface_weight=0.5 | \
             d subsurface_scatter_anisotropy=0.2 subsurface_weight=0.5 | d fuzz_weight=0.05 | \
             e coat_weight=1 | c coat_color=0.5,0.6,0.7 coat_weight=1 | \
             e coat_roughness=0.2 coat_weight=1 | d coat_roughness_anisotropy=0.2 coat_weight=1 | \
             e coat_ior=1.4 coat_weight=1 | c coat_darkening=0.5 coat_weight=1 | \
             x coat_darkening=0.5 coat_weight=1;base_metalness=1 | d thin_film_weight=0.05 | \
             d emission_luminance=1 | d geometry_opacity=0.95 | \
             c geometry_thin_walled=true transmission_weight=1;specular_roughness=0 | \
             d geometry_normal=0,0,1 | d geometry_coat_normal=0,0,1 | d geometry_tangent=1,0,0 | \
             d geometry_coat_tangent=1,0,0 | d fuzz_color=0.5,0.5,0.5 fuzz_weight=0.05 | \
             d fuzz_roughness=0.2 fuzz_weight=0.05 | \
             d thin_film_thickness=0.3 thin_film_weight=0.05 | \
             d thin_film_ior=1.5 thin_film_weight=0.05 | \
             o transmission_scatter_anisotropy=0.5 transmission_weight=1;transmission_scatter=1,1,1;transmission_depth=1",
        ),
        (
            "gltf_pbr",
            "c base_color=0.1,0.2,0.3 | e metallic=0 | e roughness=0.4 | d normal=0,0,1 | \
             d tangent=1,0,0 | d occlusion=0.5 | c transmission=1 metallic=0;roughness=0 | \
             c specular=0.5 metallic=0 | d specular_color=0.5,0.6,0.7 metallic=0 | \
             e ior=1.6 metallic=0 | d alpha=0.95 alpha_mode=2 | d iridescence=0.05 | \
             d sheen_color=0.05,0,0 | e clearcoat=1 | e clearcoat_roughness=0.2 clearcoat=1 | \
             d clearcoat_normal=0,0,1 | d emissive=1,1,1 | d emissive_strength=2 emissive=1,1,1 | \
             e attenuation_distance=2 metallic=0;transmission=1;thickness=1;attenuation_color=0.5,0.5,0.5 | \
             e attenuation_color=0.5,0.5,0.5 metallic=0;transmission=1;thickness=1;attenuation_distance=2 | \
             e anisotropy_strength=0.5 roughness=0.3 | \
             e anisotropy_rotation=0.5 roughness=0.3;anisotropy_strength=0.5 | \
             d dispersion=1 metallic=0;transmission=1;thickness=1 | \
             d sheen_roughness=0.2 sheen_color=0.05,0,0 | d iridescence_ior=1.5 iridescence=0.05 | \
             d iridescence_thickness=200 iridescence=0.05 | \
             e thickness=1 metallic=0;transmission=1 | e alpha_mode=1 alpha=0.5 | \
             e alpha_cutoff=0.2 alpha=0.95;alpha_mode=1",
        ),
    ];
    let mut silent = String::new();
    for (element, cases) in cases {
        for case in cases.split(" | ") {
            let (fate, case) = case.split_at(1);
            let (input, others) = case[1..].split_once(' ').unwrap_or((&case[1..], ""));
            let (materials, findings) = shader(element, &format!("{input};{others}"));
            let name = input.split_once('=').unwrap().0;
            let found = match materials.first() {
                Some(material) if loss(material, name).1 == "without effect on this material" => {
                    "silent".into()
                }
                Some(material) => {
                    let i = material.losses.iter().position(|loss| loss.key.starts_with(name)).unwrap();
                    fates(material)[i..=i].to_owned()
                }
                // At the place of the input.
                None => {
                    let text = shader_text(element, &format!("{input};{others}"));
                    let place = findings[0].span.clone().map_or("", |span| &text[span]);
                    let is_here = place.contains(&format!("\"{name}\""));
                    let is_sole = findings.len() == 1 && findings[0].code == Code::NoEqual;
                    match (is_sole, is_here) {
                        (true, true) => "x",
                        (true, false) => "o",
                        (false, _) => "not the only finding",
                    }
                    .to_owned()
                }
            };
            if found != fate {
                writeln!(silent, "{element}: {found} {input} {others}").unwrap();
            }
        }
    }
    assert!(silent.is_empty(), "{silent}");
}

/// One material of `.mtl` with keys in the form `Key=value;Key=value`, or one of a shader.
fn of_inputs(format: &str, inputs: &str) -> (String, Read) {
    if format == "mtl" {
        let lines = inputs.split(';').filter(|input| !input.is_empty());
        let text = lines.fold("newmtl it\n".to_owned(), |text, line| text + &line.replace('=', " ") + "\n");
        let read = mtl(&text);
        return (text, read);
    }
    let text = shader_text(format, inputs);
    let read = materialx(&text);
    (text, read)
}

/// What becomes of the first input of each case: its fate as a letter (x: refused as without an equal, m: as
/// meaningless, each at the place of the input) and a part of what is said.
fn assert_told(cases: &[(&str, &str, &str, &str)]) {
    let mut wrong = String::new();
    for (format, inputs, fate, part) in cases {
        let (text, (materials, findings)) = of_inputs(format, inputs);
        let name = inputs.split('=').next().unwrap();
        let (found, told) = match (materials.first(), findings.first()) {
            (Some(material), _) => {
                let of = |key: &str| key == name || key.starts_with(&format!("{name} "));
                let i = material.losses.iter().position(|loss| of(&loss.key)).unwrap();
                (fates(material)[i..=i].to_owned(), material.losses[i].text.clone())
            }
            (None, Some(finding)) => {
                let letter = if finding.code == Code::NoEqual { "x" } else { "m" };
                let place = &text[finding.span.clone().unwrap()];
                let is_here =
                    place.contains(&format!("\"{name}\"")) || place.starts_with(&format!("{name} "));
                let told = if is_here { "" } else { place }.to_owned() + &finding.text;
                (if is_here { letter } else { "elsewhere" }.to_owned(), told)
            }
            (None, None) => panic!("nothing of {text}"),
        };
        if found != *fate || !told.contains(part) {
            writeln!(wrong, "{format} {inputs}: {found} {told}\n  expected {fate} {part}").unwrap();
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn the_alpha_of_gltf_is_read_by_its_mode() {
    assert_told(&[
        ("gltf_pbr", "alpha=0.6;alpha_mode=1", "e", "not below the cutoff"),
        ("gltf_pbr", "alpha_cutoff=0.2;alpha=0.6;alpha_mode=1", "e", "not below the cutoff"),
        ("gltf_pbr", "alpha=0.5;alpha_mode=1", "e", "not below the cutoff"),
        ("gltf_pbr", "alpha=0.95;alpha_mode=1;alpha_cutoff=0.99", "x", "1 of transparency"),
        ("gltf_pbr", "alpha=0.95;alpha_mode=2", "d", "0.05 of the light"),
        ("gltf_pbr", "alpha=0.2;alpha_mode=0", "e", ""),
        ("gltf_pbr", "alpha_mode=0.5", "m", "not the number of a mode"),
        ("standard_surface", "opacity=0.9,1,1", "d", "0.1 of the light"),
        ("standard_surface", "opacity=0.85,1,1", "x", "0.15 of transparency"),
    ]);
}

/// (1 − F) c ρ at every angle, as the graph multiplies what is below the coat by its colour.
#[test]
fn a_coloured_coat_returns_the_share_that_the_file_means() {
    for (format, inputs, seen) in [
        (
            "standard_surface",
            "specular=0;base_color=0.8,0.8,0.5;coat=1;coat_color=0.5,0.9,1;coat_roughness=0",
            [0.4, 0.72, 0.5],
        ),
        (
            "open_pbr_surface",
            "specular_weight=0;base_color=0.8,0.8,0.5;coat_weight=1;coat_color=0.5,0.9,1;coat_ior=1.5;\
             coat_darkening=0",
            [0.4, 0.72, 0.5],
        ),
        ("gltf_pbr", "metallic=0;specular=0;base_color=0.8,0.8,0.5;clearcoat=1", [0.8, 0.8, 0.5]),
        // Darkened as well, by (1 − K) / (1 − ρ K).
        (
            "open_pbr_surface",
            "specular_weight=0;base_color=0.8,0.8,0.5;coat_weight=1;coat_color=0.5,0.9,1;coat_ior=1.5",
            [(0.8, 0.5), (0.8, 0.9), (0.5, 1.0)]
                .map(|(rho, c)| c * rho * ESCAPES_1_5 / (1.0 - rho * (1.0 - ESCAPES_1_5))),
        ),
    ] {
        let plastic = only(shader(format, inputs)).description.material::<f64>().unwrap();
        assert_near(plastic.albedo(glam::DVec3::Z).0, seen.map(|seen| 0.04 + 0.96 * seen), 1e-4);
        let f = dielectric(0.4, 1.5).reflectance.unpolarized();
        let wo = glam::DVec3::new(f64::sqrt(1.0 - 0.16), 0.0, 0.4);
        assert_near(plastic.albedo(wo).0, seen.map(|seen| f + (1.0 - f) * seen), 1e-4);
    }
}

/// F + (1 − F) c R in the file; here light that the coat returns is followed: F + (1 − F)² c R / (1 − F c R).
#[test]
fn a_smooth_metal_below_a_coloured_coat_returns_what_the_file_means() {
    let (metal, c) = ([0.8, 0.6, 0.3], 0.81);
    let expected = metal.map(|r| 0.04 + 0.96 * 0.96 * c * r / (1.0 - 0.04 * c * r));
    let of_file = metal.map(|r| 0.04 + 0.96 * c * r);
    for (format, inputs) in [
        (
            "standard_surface",
            "metalness=1;base=1;base_color=0.8,0.6,0.3;specular_roughness=0;coat=1;coat_roughness=0;\
             coat_color=0.81,0.81,0.81",
        ),
        (
            "open_pbr_surface",
            "base_metalness=1;base_color=0.8,0.6,0.3;specular_roughness=0;coat_weight=1;coat_ior=1.5;\
             coat_color=0.81,0.81,0.81",
        ),
    ] {
        let paint = only(shader(format, inputs)).description.material::<f64>().unwrap();
        // Each mirror has its interval of the first uniform.
        let count = 10_000;
        let mut albedo = [0.0; 3];
        for i in 0..count {
            let uc = (f64::from(i) + 0.5) / f64::from(count);
            let sample = paint.sample(glam::DVec3::Z, uc, [0.5; 2], TransportMode::Radiance).unwrap();
            albedo = std::array::from_fn(|c| albedo[c] + sample.weight[c] / f64::from(count));
        }
        assert_near(albedo, expected, 2e-3);
        assert_near(albedo, of_file, 0.015);
    }
}

#[test]
fn the_highlight_of_mtl_is_no_more_wrong_than_a_tenth() {
    for (text, model) in [
        ("Kd 0.1\nKs 0.9\nillum 3\n", Model::Mirror),
        ("Kd 0.1 0.05 0\nKs 0.9\nillum 5\n", Model::Metal),
        // Less is lost as plastic.
        ("Kd 0.1\nKs 0.05\nillum 3\n", Model::Plastic),
    ] {
        assert_eq!(only(mtl(&format!("newmtl a\n{text}"))).description.model(), model, "{text}");
    }
    assert_told(&[
        ("mtl", "Kd=0.1;Ks=0.9;illum=3", "d", "0.1 of the light"),
        ("mtl", "Ks=0.63 0.55 0.37;Kd=0.75 0.6 0.2;illum=3", "x", "off by 0.59"),
        ("mtl", "Ks=0.1;Kd=0.75 0.6 0.2;illum=3", "d", "off by 0.06"),
        ("mtl", "Ks=0.63 0.55 0.37;Kd=0.75 0.6 0.2", "d", "0.59"),
        ("mtl", "Ks=0.63 0.55 0.37;Kd=0.75 0.6 0.2;illum=2", "d", "0.26 of colour"),
        ("mtl", "illum=0;Kd=0.5", "c", "without lighting"),
        ("mtl", "illum=1;Kd=0.5", "e", "chooses the model"),
    ]);
}

#[test]
fn what_light_meets_in_a_transmitting_body_is_told() {
    let clear = "transmission=1;specular_roughness=0";
    let thin = "transmission=1;thin_walled=true;specular_roughness=0";
    let open_thin = "transmission_weight=1;geometry_thin_walled=true;specular_roughness=0";
    let owned: Vec<(&str, String, &str, &str)> = vec![
        ("standard_surface", format!("transmission_extra_roughness=1;{thin}"), "x", "α = 1"),
        ("standard_surface", format!("transmission_extra_roughness=0.05;{thin}"), "d", "taken as clear"),
        ("standard_surface", format!("transmission_extra_roughness=1;{clear}"), "x", "1 of the light"),
        ("standard_surface", format!("transmission_extra_roughness=0.05;{clear}"), "d", "α = 0.0025"),
        (
            "standard_surface",
            "transmission_extra_roughness=0.02;transmission=1;specular_roughness=0.3".to_owned(),
            "d",
            "0.06445 of the light",
        ),
        (
            "standard_surface",
            "transmission_extra_roughness=0.1;transmission=1;specular_roughness=0.3".to_owned(),
            "x",
            "0.28 of the light",
        ),
        ("standard_surface", format!("transmission_scatter=1,1,1;{clear}"), "e", "no interior"),
        (
            "standard_surface",
            format!("transmission_scatter_anisotropy=0.5;transmission_scatter=1,1,1;{clear}"),
            "e",
            "no interior",
        ),
        (
            "standard_surface",
            format!("transmission_scatter=1,1,1;transmission_depth=1;{thin}"),
            "e",
            "no interior",
        ),
        ("standard_surface", format!("transmission_depth=1;{thin}"), "e", "no interior"),
        (
            "standard_surface",
            format!("transmission_scatter=1,1,1;transmission_depth=1;{clear}"),
            "x",
            "scatters within",
        ),
        (
            "open_pbr_surface",
            "transmission_scatter=1,1,1;transmission_weight=1".to_owned(),
            "e",
            "no interior",
        ),
        (
            "standard_surface",
            "specular_roughness=0.05;transmission=1;thin_walled=true".to_owned(),
            "d",
            "taken as clear",
        ),
        (
            "standard_surface",
            "specular_anisotropy=0.5;specular_roughness=0.05;transmission=1;thin_walled=true".to_owned(),
            "d",
            "taken as clear",
        ),
        ("open_pbr_surface", format!("specular_weight=0.5;{open_thin}"), "e", "scales F at 0°"),
        ("open_pbr_surface", format!("specular_color=0.5,1,1;{open_thin}"), "d", "0.03846 of the light"),
        (
            "gltf_pbr",
            "roughness=0;anisotropy_strength=0.5;metallic=0;transmission=1".to_owned(),
            "x",
            "α = 0.25",
        ),
        (
            "gltf_pbr",
            "specular_color=1.5,1,1;metallic=0;roughness=0;transmission=1".to_owned(),
            "d",
            "0.03846 of the light",
        ),
        (
            "gltf_pbr",
            "specular_color=3,1,1;metallic=0;roughness=0;transmission=1".to_owned(),
            "x",
            "0.1538 of a tint",
        ),
        ("gltf_pbr", "transmission=0.95;metallic=0;roughness=0".to_owned(), "d", "wrong by up to 0.05"),
        ("gltf_pbr", "transmission=0.95;metallic=0;roughness=0".to_owned(), "d", "a sheet with both faces"),
        (
            "standard_surface",
            format!("transmission_color=0,1,1;transmission_depth=1;{clear}"),
            "m",
            "infinite",
        ),
    ];
    let cases: Vec<_> = owned.iter().map(|(a, b, c, d)| (*a, b.as_str(), *c, *d)).collect();
    assert_told(&cases);
}

#[test]
fn what_has_no_diffuse_lobe_has_no_diffuse_roughness_and_no_sheen() {
    assert_told(&[
        ("standard_surface", "diffuse_roughness=0.5;subsurface=1", "e", "no diffuse lobe"),
        ("open_pbr_surface", "base_diffuse_roughness=0.5;subsurface_weight=1", "e", "no diffuse lobe"),
        ("standard_surface", "diffuse_roughness=0.5;subsurface=0.5;specular=0", "c", "0.5 of subsurface"),
        (
            "open_pbr_surface",
            "base_diffuse_roughness=0.5;subsurface_weight=0.5;specular_weight=0",
            "c",
            "0.5 of subsurface",
        ),
        ("standard_surface", "sheen=1;transmission=1", "e", ""),
        ("standard_surface", "sheen=1;transmission=0.95;specular_roughness=0", "d", "0.05 of the light"),
        ("open_pbr_surface", "fuzz_weight=1;transmission_weight=1", "x", "1 of sheen"),
    ]);
    let body = only(shader("standard_surface", "diffuse_roughness=0.5;subsurface=1;specular=0"));
    assert_model(&body, Model::Matte, &["reflectance"]);
}

#[test]
fn whole_turns_change_nothing() {
    let metal = "metalness=1;specular_anisotropy=0.5";
    let turned = only(shader("standard_surface", &format!("specular_rotation=3.25;{metal}")));
    assert_abs_diff_eq!(number(&turned, "rotation_deg"), 90.0, epsilon = 1e-9);
    let turned = only(shader("standard_surface", &format!("specular_rotation=1e300;{metal}")));
    assert_eq!(number(&turned, "rotation_deg"), 0.0);
    let radians = "anisotropy_rotation=13;anisotropy_strength=0.5;roughness=0.3";
    let turned = only(shader("gltf_pbr", radians));
    assert_abs_diff_eq!(number(&turned, "rotation_deg"), 13_f64.to_degrees() - 720.0, epsilon = 1e-9);
    let turned = only(mtl("newmtl a\nKd 0.8\nPm 1\nPr 0.3\naniso 0.5\nanisor -2.25\n"));
    assert_abs_diff_eq!(number(&turned, "rotation_deg"), -90.0, epsilon = 1e-9);
}

#[test]
fn a_metal_below_a_coat_is_seen_through_refraction() {
    assert_told(&[
        ("standard_surface", "base_color=0.8,0.8,0.8;metalness=1;coat=1", "c", "refracted"),
        ("standard_surface", "specular_color=0.8,0.8,0.8;metalness=1;coat=1", "c", "refracted"),
        ("standard_surface", "specular_roughness=0.3;metalness=1;coat=1", "c", "1.5 times as wide"),
        ("gltf_pbr", "roughness=0.3;clearcoat=1", "c", "1.5 times as wide"),
        ("mtl", "Kd=0.6;Pm=1;Pc=1;Pr=0.3", "c", "darker by up to 0.2229"),
        ("mtl", "Pr=0.3;Kd=0.6;Pm=1;Pc=1", "c", "0.09 of GGX; its highlight is 1.5 times as wide"),
        ("mtl", "Pr=0.3;Kd=0.6;Pm=1", "e", "0.09 of GGX"),
        ("mtl", "Ns=20;Kd=0.6;Pm=1;Pc=1", "c", "1.5 times as wide"),
        ("gltf_pbr", "base_color=0.6,0.6,0.6;clearcoat=1", "c", "darker by up to 0.2229"),
        ("open_pbr_surface", "coat_darkening=0.4;coat_weight=1;base_metalness=1;coat_ior=1.5", "x", "0.1095"),
        (
            "open_pbr_surface",
            "coat_darkening=0.5;coat_weight=1;base_metalness=1;coat_ior=1.5",
            "d",
            "0.09123",
        ),
        ("open_pbr_surface", "coat_darkening=1;coat_weight=1;base_metalness=1", "c", "specification"),
        ("open_pbr_surface", "coat_darkening=1;coat_weight=1", "c", "mean reflectance"),
        ("open_pbr_surface", "coat_darkening=0;coat_weight=1", "e", "in the colour of the base"),
        ("open_pbr_surface", "coat_color=1,1,1;coat_weight=1", "e", "at every angle"),
        ("open_pbr_surface", "coat_color=0.5,1,1;coat_weight=1", "c", "by the specification more"),
        ("standard_surface", "coat_color=0.5,0.5,0.5;coat=1;metalness=1", "c", "at an angle"),
        ("open_pbr_surface", "coat_color=0.5,0.5,0.5;coat_weight=1;base_metalness=1", "c", "at an angle"),
        ("open_pbr_surface", "specular_weight=0.5;base_metalness=1", "c", "the graph has it twice"),
        ("standard_surface", "base_color=0.995,0.9,0.9;base=1;metalness=1", "c", "0.005"),
        ("standard_surface", "base_color=0.98,0.9,0.9;base=1;metalness=1", "e", "Gulbrandsen"),
    ]);
}

#[test]
fn the_highlight_at_grazing_angles_is_that_of_the_shader() {
    assert_told(&[
        ("standard_surface", "specular=0.5", "c", "at 90° the file has 0.5 in place of 1"),
        ("standard_surface", "specular_color=0.5,0.5,0.5", "c", "at 90° the file has 0.5 in place of 1"),
        ("standard_surface", "specular=0.5;specular_color=0.5,0.5,0.5", "c", "0.25 in place"),
        ("gltf_pbr", "specular=0.5;metallic=0", "c", "at 90° the file has 0.5 in place of 1"),
        ("gltf_pbr", "specular_color=0.5,0.5,0.5;metallic=0", "e", "scales F at 0°"),
        ("gltf_pbr", "specular_color=2,2,2;specular=0.5;metallic=0", "c", "at 90° the file has 0.5"),
        ("gltf_pbr", "specular=0.5;specular_color=2,2,2;metallic=0", "c", "at 90° the file has 0.5"),
        ("open_pbr_surface", "specular_weight=0.5", "e", "scales F at 0°"),
        ("open_pbr_surface", "specular_color=0.5,0.5,0.5", "c", "at 90° the file has 0.5 in place of 1"),
        ("open_pbr_surface", "specular_weight=2;specular_color=0.5,0.5,0.5", "c", "at 90° the file has 0.5"),
        ("open_pbr_surface", "specular_color=0.5,0.6,0.7", "d", "colour of the highlight is lost"),
    ]);
}

/// What a file may say and no parameter here can hold is no mistake of the file.
#[test]
fn limits_of_ours_are_not_mistakes_of_the_file() {
    assert_told(&[
        ("gltf_pbr", "anisotropy_strength=0.5;roughness=0", "x", ""),
        (
            "open_pbr_surface",
            "specular_roughness_anisotropy=0.5;specular_roughness=1;base_metalness=1",
            "x",
            "",
        ),
        ("mtl", "aniso=1;Pr=1;Pm=1;Kd=0.8", "x", ""),
        ("open_pbr_surface", "specular_weight=30", "x", ""),
        ("gltf_pbr", "specular_color=30,30,30;metallic=0", "x", ""),
        ("open_pbr_surface", "specular_weight=25;specular_ior=1.5", "x", ""),
        ("standard_surface", "coat_IOR=0.9;coat=1", "x", ""),
        ("mtl", "Ni=0;Kd=0.5;Ks=0.5", "m", "index of 0"),
    ]);
}

#[test]
fn names_of_several_lines_are_shown_in_one() {
    let read = mtl("newmtl a \\\n  b\nKd 0.5\n");
    assert_eq!(read.0[0].name, "a b");
    let long = format!("newmtl {}\nKd 0.5\nPm 0.5\n", "n".repeat(200));
    let (_, findings) = mtl(&long);
    assert!(findings[0].text.contains(&format!("`{}…`", "n".repeat(80))), "{}", findings[0].text);
    let (_, findings) = mtl(&format!("newmtl {}\nKd 0.5\nKs 0.5\nNi 0.5\n", "n".repeat(200)));
    assert!(findings[0].text.contains(&format!("`{}…`", "n".repeat(80))), "{}", findings[0].text);
}

// Tables of losses and refusals.

/// Every statement and every input is in the table once, in the order of the file and with its place.
#[test]
fn the_table_of_losses_is_complete() {
    for file in files() {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        let text = text(&name);
        let (materials, _) = read(&name, &text);
        for material in &materials {
            let mut end = 0;
            for loss in &material.losses {
                assert!(loss.text.len() > 5, "{loss:?}");
                let place = &text[loss.span.clone()];
                let word = loss.key.split(' ').next().unwrap();
                assert!(place.contains(word) && !place.contains("newmtl"), "{place} {loss:?}");
                // The inputs of a surfacematerial come first, wherever it stands.
                assert!(loss.span.start >= end || name.ends_with("mtlx"), "{loss:?}");
                end = loss.span.end;
            }
            let statements = if name.ends_with(".mtl") {
                let text = text.replace("\\\r\n", " ");
                let is_statement = |line: &&str| !line.trim().is_empty() && !line.trim().starts_with('#');
                let mut lines = text.lines().filter(is_statement).skip_while(|line| {
                    line.trim().split_once(' ').is_none_or(|(_, name)| name != material.name)
                });
                lines.next();
                lines.take_while(|line| !line.trim().starts_with("newmtl")).count()
            } else {
                continue;
            };
            assert_eq!(material.losses.len(), statements, "{} of {name}", material.name);
        }
    }
    let count = |name: &str| material("standard_surface.mtlx", name).losses.len();
    assert_eq!(["Plastic", "Gold", "Glass", "Skin"].map(count), [9, 6, 7, 6]);
}

/// Whatever is imported can be made, and returns no more than tables of its lobes are wrong by.
#[test]
fn every_imported_material_can_be_made() {
    for file in files() {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        for material in read(&name, &text(&name)).0 {
            // Lobes of plastic and car paint take their time, and differ in values only.
            let model = material.description.model();
            if matches!(model, Model::Plastic | Model::CarPaint) {
                continue;
            }
            let albedo = material.description.material::<f64>().unwrap().albedo(glam::DVec3::Z);
            assert!(albedo.0.iter().all(|a| (0.0..=1.0 + 1e-4).contains(a)), "{} {albedo:?}", material.name);
            assert!(!flattened(model.parameters()).is_empty());
        }
    }
}

/// Code, place and a part of the text of every finding.
#[track_caller]
fn assert_findings(text: &str, findings: &[Finding], expected: &[(Code, &str, &str)]) {
    let mut wrong = String::new();
    for (i, (code, place, part)) in expected.iter().enumerate() {
        let Some(finding) = findings.get(i) else {
            writeln!(wrong, "missing: {code} {place}").unwrap();
            continue;
        };
        let found = finding.span.clone().map_or("", |span| &text[span]);
        if finding.code != *code || found != *place || !finding.text.contains(part) {
            writeln!(wrong, "{} {found}: {}\n  expected {code} {place}: {part}", finding.code, finding.text)
                .unwrap();
        }
    }
    for finding in findings.iter().skip(expected.len()) {
        writeln!(wrong, "unexpected: {finding:?}").unwrap();
    }
    assert!(wrong.is_empty(), "{wrong}");
}

#[test]
fn mtl_that_has_no_meaning_here_is_refused_where_it_stands() {
    use Code::{ForeignSyntax, Meaningless, NoEqual, NotConstant};
    let text = text("refused.mtl");
    let (materials, findings) = mtl(&text);
    let names: Vec<_> = materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["ok"]);
    assert_findings(
        &text,
        &findings,
        &[
            (ForeignSyntax, "Kd 0.1 0.2 0.3", "before any newmtl"),
            (NoEqual, "Pm 0.5", "0.5 of metal"),
            (NoEqual, "d 0.4", "0.6 of transparency without refraction"),
            (NoEqual, "Kd 0.5", "illum 7 adds 0.5"),
            (Meaningless, "Kd 1.2 1.2 1.2", "expected each in [0, 1]"),
            (ForeignSyntax, "0,5", "decimals have a point"),
            (ForeignSyntax, "Kd 0.5 0.2", "three numbers, or one for a grey"),
            (NotConstant, "Kd spectral paint.rfl 1.0", "file of spectra"),
            (NoEqual, "d -halo 0.5", "halo"),
            (Meaningless, "Ni 0", "an index of 0"),
            (Meaningless, "Tr 1", "contradicts `d`"),
            (Meaningless, "Kd 0.6", "given twice"),
            (NoEqual, "illum 10", "shadows"),
            (Meaningless, "illum 2.5", "not the number of a model"),
            (NoEqual, "newmtl empty", "without Kd"),
            (Meaningless, "Kd nan", "out of range"),
            (Meaningless, "Kd xyz 0.1 0.5 0.1", "in Rec. 709"),
            (NoEqual, "Pc 1", "coat over glass"),
            (NoEqual, "Ps 0.8", "0.8 of sheen"),
            (Meaningless, "newmtl twice", "second material"),
            (ForeignSyntax, "newmtl", "without the name"),
        ],
    );
    let text = self::text("blender.mtl");
    assert_findings(
        &text,
        &mtl(&text).1,
        &[(NotConstant, "map_Kd textures/oak_diffuse.png", "`Wood` is no constant")],
    );
    assert_findings("", &mtl("# nothing\n").1, &[(ForeignSyntax, "", "no material")]);
}

#[test]
fn materialx_that_has_no_meaning_here_is_refused_where_it_stands() {
    use Code::{ForeignSyntax, Meaningless, NoEqual, NotConstant};
    let text = text("refused.mtlx");
    let (materials, findings) = materialx(&text);
    let names: Vec<_> = materials.iter().map(|material| material.name.as_str()).collect();
    assert_eq!(names, ["fine"]);
    let input = |rest: &str| -> &'static str { format!("<input name={rest} />").leak() };
    assert_findings(
        &text,
        &findings,
        &[
            (NotConstant, "<standard_surface", "stands in a node graph"),
            (
                NotConstant,
                input(r#""base_color" type="color3" nodegraph="NG_wood" output="out""#),
                "`base_color` of `Wood`",
            ),
            (
                NotConstant,
                input(r#""specular_roughness" type="float" nodename="noise""#),
                "it comes by nodename",
            ),
            (
                NotConstant,
                input(r#""surfaceshader" type="surfaceshader" nodename="SR_lost""#),
                "not a node of this file",
            ),
            (ForeignSyntax, "<surfacematerial", "`Bare` has no surfaceshader"),
            (
                NotConstant,
                input(r#""base_color" type="color3" interfacename="tint""#),
                "it comes by interfacename",
            ),
            (NoEqual, input(r#""metalness" type="float" value="0.5""#), "0.5 of metal"),
            (NoEqual, input(r#""transmission" type="float" value="0.5""#), "0.5 of transmission"),
            (NoEqual, input(r#""coat" type="float" value="0.5""#), "0.5 of coat"),
            (NoEqual, input(r#""coat" type="float" value="1""#), "coat over a transmitting body"),
            (NoEqual, input(r#""thin_film_thickness" type="float" value="550""#), "interference"),
            (NoEqual, input(r#""sheen" type="float" value="1""#), "1 of sheen"),
            (NoEqual, input(r#""opacity" type="color3" value="0.5, 0.5, 0.5""#), "0.5 of transparency"),
            (
                NoEqual,
                input(r#""transmission_scatter" type="color3" value="0.5, 0.5, 0.5""#),
                "scatters within",
            ),
            (NoEqual, "<standard_surface", "thin sheet with α = 0.04"),
            (
                Meaningless,
                input(r#""transmission_color" type="color3" value="0, 0.5, 0.5""#),
                "infinite absorbance",
            ),
            (
                Meaningless,
                input(r#""base_color" type="color3" value="1.5, 0.5, 0.5""#),
                "expected each in [0, 1]",
            ),
            (Meaningless, input(r#""specular_IOR" type="float" value="0""#), "a number in [0.001, 1000]"),
            (
                NoEqual,
                input(r#""base_color" type="color3" value="0.9999, 0.5, 0.5""#),
                "as metal eta = [39997",
            ),
            (
                Meaningless,
                input(r#""base_colour" type="color3" value="0.5, 0.5, 0.5""#),
                "did you mean base_color",
            ),
            (ForeignSyntax, "0.5, 0.5", "three numbers"),
            (ForeignSyntax, "very", "expected a number"),
            (ForeignSyntax, "yes", "true or false"),
            (Meaningless, input(r#""specular_IOR" type="float" value="inf""#), "in [0.001, 1000]"),
            (ForeignSyntax, input(r#""base" type="float""#), "no value"),
            (Meaningless, input(r#""base" type="float" value="0.6""#), "given twice"),
            (NoEqual, "<UsdPreviewSurface", "is not read"),
        ],
    );
    assert!(
        findings.iter().filter(|finding| finding.code == NotConstant).all(|finding| !finding.help.is_empty())
    );
    let text = self::text("colour_spaces.mtlx");
    assert_findings(
        &text,
        &materialx(&text).1,
        &[
            (
                Meaningless,
                input(r#""base_color" type="color3" value="0, 1, 0""#),
                "in linear Rec. 709 [-0.6218, 1.141, -0.129]",
            ),
            (Meaningless, "srgb_textur", "did you mean srgb_texture"),
        ],
    );
    for (text, code, place, part) in [
        ("", ForeignSyntax, "", "not XML"),
        ("<materialx version=\"1.38\">\n  <a>\n</materialx>", ForeignSyntax, "<", "not XML"),
        ("<scene/>", ForeignSyntax, "<scene", "the root is `scene`"),
        ("<materialx/>", ForeignSyntax, "<materialx", "has no version"),
        ("<materialx version=\"1.37\"/>", Meaningless, "1.37", "MaterialX 1.37 is not read"),
        ("<materialx version=\"1.390\"/>", Meaningless, "1.390", "is not read"),
        ("<materialx version=\"1.39\"/>", ForeignSyntax, "", "no material in the file"),
        ("<materialx version=\"1.39\"><gltf_pbr/></materialx>", ForeignSyntax, "<gltf_pbr", "without a name"),
        (
            "<!DOCTYPE materialx><materialx version=\"1.39\"/>",
            ForeignSyntax,
            "<",
            "document type declaration",
        ),
    ] {
        assert_findings(text, &materialx(text).1, &[(code, place, part)]);
    }
}

/// A tenth of the light is the most that is dropped with a line in the table.
#[test]
fn what_would_be_wrong_by_more_than_a_tenth_is_refused() {
    for (inputs, lost) in [
        ("coat=1;specular_IOR=1.9", "up to 0.09631 of the light"),
        ("coat=1;specular_IOR=2", "0.1111 of a highlight below the coat has no equal"),
        ("metalness=0.9", "taken as 1: wrong by up to 0.1 of the light"),
        ("metalness=0.89", "0.89 of metal beside the rest has no equal"),
        ("sheen=0.5;sheen_color=0.2,0.1,0.1", "sheen is lost: up to 0.1 of the light"),
        ("sheen=0.5;sheen_color=0.3,0.1,0.1", "0.15 of sheen has no equal"),
        ("thin_walled=true;subsurface=0.2", "0.2 of light through a thin wall has no equal"),
    ] {
        let (materials, findings) = shader("standard_surface", inputs);
        let losses = materials.iter().flat_map(|material| &material.losses).map(|loss| &loss.text);
        let told: Vec<_> = losses.chain(findings.iter().map(|finding| &finding.text)).collect();
        assert!(told.iter().any(|text| text.contains(lost)), "{inputs}: {told:?}");
        assert_eq!(materials.is_empty(), lost.contains("has no equal"), "{inputs}");
    }
}

/// What would exhaust the stack, memory or time is refused, and soon.
#[test]
fn crafted_xml_is_refused() {
    let start = std::time::Instant::now();
    let wrap = |inner: String| format!("<materialx version=\"1.39\">{inner}</materialx>");
    let repeat = |count: usize, part: &dyn Fn(usize) -> String| (0..count).map(part).collect::<String>();
    let entities = repeat(20, &|i| format!("<!ENTITY a{} \"&a{i};&a{i};&a{i};&a{i};\">", i + 1));
    for (text, part) in [
        (format!("<!DOCTYPE a [<!ENTITY a0 \"a\">{entities}]>{}", wrap("&a20;".to_owned())), "document type"),
        (wrap("<a>".repeat(60_000) + &"</a>".repeat(60_000)), "no material"),
        (wrap("<a>".repeat(400_000)), "65536 nodes"),
        (wrap("<a/>".repeat(100_000)), "65536 nodes"),
        (wrap(format!("<a {}/>", repeat(100_000, &|i| format!("a{i}=\"\" ")))), "256 attributes"),
        (wrap(repeat(30_000, &|i| format!("<a xmlns:a{i}=\"{i}\">"))), "64 namespaces"),
        (wrap(" ".repeat(5 << 20)), "4194304 bytes"),
        (wrap("<standard_surface name=\"a\" type=\"surfaceshader\"/>".repeat(20_000)), "second material"),
    ] {
        let (materials, findings) = materialx(&text);
        assert!(materials.len() <= 1 && findings[0].text.contains(part), "{part}: {}", findings[0].text);
    }
    // Seconds without optimisation; without the limits, minutes.
    assert!(start.elapsed().as_secs() < 60, "{:?}", start.elapsed());
}

#[test]
fn windows_tabs_byte_order_marks_and_comments_change_nothing() {
    let plain = only(mtl("newmtl a b\nKd 0.5 0.4 0.3\nKs 0.5\nNs 10\nillum 2\n"));
    for text in [
        "\u{feff}newmtl a b\r\nKd 0.5 0.4 0.3\r\nKs 0.5\r\nNs 10\r\nillum 2",
        "# c\n\tnewmtl\ta b # c\n\n\tKd\t0.5\t0.4  0.3\n Ks 0.5\nNs 10\nillum 2",
        "newmtl a b\rKd 0.5 \\\r 0.4 \\\r\n0.3 # c \\\rKs 0.5 #c\rNs 10 #\rillum 2\r",
    ] {
        let material = only(mtl(text));
        assert_eq!(material.name, "a b");
        assert_eq!(material.description, plain.description, "{text:?}");
    }
    let text = text("standard_surface.mtlx");
    let (expected, _) = materialx(&text);
    for text in [text.replace('\n', "\r\n"), format!("\u{feff}{text}"), text.replace('"', "'")] {
        let (materials, findings) = materialx(&text);
        assert_eq!(findings, []);
        let descriptions =
            |materials: &[Imported]| materials.iter().map(|m| m.description.clone()).collect::<Vec<_>>();
        assert_eq!(descriptions(&materials), descriptions(&expected));
        for loss in materials.iter().flat_map(|material| &material.losses) {
            let place = &text[loss.span.clone()];
            assert!(place.starts_with("<input") && place.ends_with("/>"), "{place}");
        }
    }
}

/// Reads a damaged file; the places of what comes out are of the file.
fn survive(name: &str, text: &str) {
    let (materials, findings) = read(name, text);
    for span in findings.iter().filter_map(|finding| finding.span.clone()) {
        assert!(text.get(span.clone()).is_some(), "{span:?} of {text:?}");
    }
    for loss in materials.iter().flat_map(|material| &material.losses) {
        assert!(text.get(loss.span.clone()).is_some(), "{loss:?} of {text:?}");
    }
}

#[test]
fn a_file_cut_anywhere_is_read_or_refused() {
    for file in files() {
        let name = file.file_name().unwrap().to_str().unwrap().to_owned();
        let text = text(&name);
        for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
            survive(&name, &text[..end]);
        }
    }
}

#[test]
fn a_damaged_file_is_read_or_refused() {
    let seed = bxdf_tests::run_seed();
    println!("BXDF_TESTS_SEED={seed}");
    let mut random = Pcg64::new(seed.into(), 0);
    let files = files();
    for i in 0..4000 {
        let name = files[i % files.len()].file_name().unwrap().to_str().unwrap();
        let mut bytes = text(name).into_bytes();
        for _ in 0..random.random_range(1..20) {
            let place = random.random_range(0..bytes.len());
            match random.random_range(0..4) {
                0 => bytes[place] = random.random(),
                1 => {
                    bytes.remove(place);
                }
                2 => bytes.insert(place, b"\"<>/=\\\n #-,.e0919&\t\r"[random.random_range(0..20)]),
                _ => {
                    let end = random.random_range(place..bytes.len().min(place + 40));
                    let part = bytes[place..end].to_vec();
                    let at = random.random_range(0..bytes.len());
                    bytes.splice(at..at, part);
                }
            }
        }
        survive(name, &String::from_utf8_lossy(&bytes));
    }
}

/// Keys with numbers from the ends of what floats hold: nothing panics, and nothing that is imported has lost its
/// value on the way.
#[test]
fn numbers_from_the_ends_of_their_ranges_are_read_or_refused() {
    const NUMBERS: [&str; 16] = [
        "0", "1", "0.5", "0.05", "0.95", "1.5", "1e-300", "5e-324", "1e300", "1e-9", "0.999999", "1e3", "-1",
        "-0", "nan", "inf",
    ];
    let seed = bxdf_tests::run_seed();
    println!("BXDF_TESTS_SEED={seed}");
    let mut random = Pcg64::new(seed.into(), 1);
    // Those of glTF that have no default or are not of every version of the definition.
    let others = "attenuation_distance=1;anisotropy_strength=0;anisotropy_rotation=0;dispersion=0";
    let keys = DEFAULTS.map(|(element, inputs)| {
        let others = if element == "gltf_pbr" { others } else { "" };
        let inputs = inputs.split(';').chain(others.split(';')).filter(|input| !input.is_empty());
        inputs.map(|input| input.split_once('=').unwrap()).collect::<Vec<_>>()
    });
    let shaders = DEFAULTS.map(|(element, _)| element);
    let mtl_keys =
        "Ka Kd Ks Ke Tf Ns Ni d Tr illum Pr Pm Ps Pc Pcr aniso anisor".split(' ').collect::<Vec<_>>();
    let mut imported = 0;
    for i in 0..6000 {
        let mut text = String::new();
        let mut number = || NUMBERS[random.random_range(0..NUMBERS.len())];
        // A few of the keys; a repeated one is refused.
        let numbers: [[&str; 3]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| number()));
        let count = random.random_range(1..=numbers.len());
        let (materials, findings) = if i % 4 == 3 {
            for numbers in &numbers[..count] {
                let key = mtl_keys[random.random_range(0..mtl_keys.len())];
                let illum = random.random_range(0..=10).to_string();
                writeln!(text, "{key} {}", if key == "illum" { &illum } else { numbers[0] }).unwrap();
            }
            mtl(&format!("newmtl a\n{text}"))
        } else {
            // Many keys count on another base, below a coat or in glass alone.
            let bases = [
                ["metalness=1;", "coat=1;", "transmission=1;"],
                ["base_metalness=1;", "coat_weight=1;", "transmission_weight=1;"],
                ["metallic=0;thickness=1;", "clearcoat=1;", "metallic=0;transmission=1;thickness=1;"],
            ][i % 4];
            let [base, coat, glass] = bases;
            text += [String::new(), base.into(), coat.into(), glass.into(), format!("{base}{coat}")]
                [random.random_range(0..5)]
            .as_str();
            for numbers in &numbers[..count] {
                let (key, default) = keys[i % 4][random.random_range(0..keys[i % 4].len())];
                let value = match default {
                    "false" => "true".to_owned(),
                    _ if default.contains(',') => numbers.join(","),
                    _ => numbers[0].to_owned(),
                };
                write!(text, "{key}={value};").unwrap();
            }
            shader(shaders[i % 4], &text)
        };
        assert!(!materials.is_empty() || !findings.is_empty(), "{text}");
        imported += materials.len();
        for material in materials {
            for (path, value) in material.description.given() {
                let is_finite = match value {
                    Value::Number(number) => number.is_finite(),
                    Value::Colour(colour) => colour.iter().all(|c| c.is_finite()),
                    Value::Text(_) => true,
                };
                assert!(is_finite, "{path} = {value} of {text}");
            }
            for loss in material.losses {
                assert!(!loss.text.contains("NaN"), "{loss:?} of {text}");
            }
        }
    }
    println!("{imported} of 6000 imported");
    assert!(imported > 600, "{imported} of 6000");
}

//! Scene files: TOML, or the same in JSON. A material file with a camera, objects and lights beside its materials.
//!
//! ```toml
//! [gonio]
//! version = 1
//! color = "lin_rec709"
//!
//! [camera]
//! position = [0, -5, 1]
//! target = [0, 0, 0]
//! field_of_view_deg = 30            # of the width
//! size = [256, 256]
//!
//! [surroundings]
//! radiance = 0.5                    # a grey, or [red, green, blue]
//!
//! [[object]]
//! shape = "sphere"
//! center = [0, 0, 0]
//! radius = 1
//! material = "rough_gold"           # of this file, or a preset
//!
//! [[light]]
//! kind = "point"
//! position = [3, -3, 4]
//! intensity = 40
//! ```
//!
//! The parts of a mesh, as an OBJ names them by `usemtl`, wear `materials.PART`, else `material`, else what the `.mtl` file
//! of the OBJ says as far as [`crate::material::foreign`] understands it.
//!
//! Light is linear with primaries of Rec. 709, whatever `color` says of materials. Everything that is wrong is reported
//! at once, each with the bytes it is about.

use std::ops::Range;
use std::path::{Path, PathBuf};

use glam::{Mat3, Vec3};

use super::generated;
use super::mesh_file;
use super::scene::{Object, Scene, Surroundings};
use super::shape::{Quad, Shape, Sphere};
use super::{Camera, Light, Mesh, Settings, Triangles};
use crate::material::file::syntax::{Content, Entry, Node};
use crate::material::file::{Document, Syntax, read_beside, text_of};
use crate::material::foreign::mtl;
use crate::material::{Description, Material, PRESETS, preset};
use crate::message::{Code, Finding, Severity};
use crate::parameter::did_you_mean;
use crate::rgb::Rgb;

/// A scene that comes with gonio.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// What it is called.
    pub name: &'static str,
    /// What it shows.
    pub summary: &'static str,
    /// Its file.
    pub text: &'static str,
}

include!(concat!(env!("OUT_DIR"), "/scenes.rs"));

/// Tables of a scene beside those of its materials.
const TABLES: [&str; 5] = ["camera", "render", "surroundings", "object", "light"];

/// Everything that a scene file says.
#[derive(Debug)]
pub struct Rendering {
    /// What there is.
    pub scene: Scene,
    /// Who looks at it.
    pub camera: Camera,
    /// How.
    pub settings: Settings,
    /// Samples per pixel.
    pub samples: u32,
    /// Files that the scene is read from, itself not among them.
    pub files: Vec<PathBuf>,
}

/// The scene that a text describes, unless anything is wrong with it, and what there is to say about it. Paths of files
/// are relative to `folder`.
pub fn read(text: &str, syntax: Syntax, folder: &Path) -> (Option<Rendering>, Vec<Finding>) {
    let (document, root, findings) = read_beside(&TABLES, text, syntax, folder);
    let mut reader = Reader {
        folder,
        document: &document,
        findings,
        materials: Vec::new(),
        names: Vec::new(),
        files: Vec::new(),
    };
    let rendering = reader.rendering(&root);
    let mut findings = reader.findings;
    findings.sort_by_key(|finding| finding.span.as_ref().map_or(0, |span| span.start));
    let is_wrong = findings.iter().any(|finding| finding.code.severity() == Severity::Error);
    (rendering.filter(|_| !is_wrong), findings)
}

struct Reader<'a> {
    folder: &'a Path,
    document: &'a Document,
    findings: Vec<Finding>,
    /// Those that objects use, by name.
    materials: Vec<Material<f32>>,
    names: Vec<String>,
    files: Vec<PathBuf>,
}

/// A table of the file, of which keys are taken one by one; what nobody takes means nothing.
struct Keys<'n> {
    entries: &'n [Entry],
    span: Range<usize>,
    place: &'static str,
    known: Vec<&'static str>,
}

impl<'n> Keys<'n> {
    fn entry(&mut self, key: &'static str) -> Option<&'n Entry> {
        self.known.push(key);
        self.entries.iter().find(|entry| entry.key == key)
    }
}

/// Whether a key may be left out.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Need {
    Needed,
    Optional,
}
use Need::{Needed, Optional};

impl Reader<'_> {
    fn error(&mut self, code: Code, span: &Range<usize>, text: impl Into<String>) {
        self.findings.push(Finding::at(code, span.clone(), text));
    }

    fn rendering(&mut self, root: &Node) -> Option<Rendering> {
        let tables = root.table()?;
        let of = |key: &str| tables.iter().find(|entry| entry.key == key);
        let camera = match of("camera") {
            Some(entry) => self.camera(entry),
            None => {
                self.findings.push(
                    Finding::of_file(Code::Missing, "there is no camera")
                        .help("[camera]\nposition = [0, -5, 1]\ntarget = [0, 0, 0]\nsize = [256, 256]"),
                );
                None
            }
        };
        let (settings, samples) =
            of("render").map_or((Settings::default(), 64), |entry| self.settings(entry));
        let surroundings = of("surroundings").map(|entry| self.surroundings(entry)).unwrap_or_default();
        let mut objects = Vec::new();
        for (entry, node) in self.list(of("object"), "object") {
            self.object(entry, node, &mut objects);
        }
        let lights: Vec<Light> = self
            .list(of("light"), "light")
            .into_iter()
            .filter_map(|(entry, node)| self.light(entry, node))
            .collect();
        if objects.is_empty()
            && self.findings.iter().all(|finding| finding.code.severity() != Severity::Error)
        {
            self.findings.push(
                Finding::of_file(Code::Missing, "there is no object").help("[[object]]\nshape = \"sphere\""),
            );
        }
        let is_dark = surroundings.radiance == Rgb::BLACK && surroundings.background.is_none();
        if is_dark && lights.is_empty() && objects.iter().all(|object| object.emission == Rgb::BLACK) {
            self.findings.push(
                Finding::of_file(Code::Missing, "there is no light").help("[surroundings]\nradiance = 1"),
            );
        }
        let materials = core::mem::take(&mut self.materials);
        match Scene::new(objects, materials, lights, surroundings) {
            Ok(scene) => Some(Rendering {
                scene,
                camera: camera?,
                settings,
                samples,
                files: core::mem::take(&mut self.files),
            }),
            Err(error) => {
                self.findings.push(Finding::of_file(Code::Contradiction, error.to_string()));
                None
            }
        }
    }

    /// The tables of a list.
    fn list<'n>(&mut self, entry: Option<&'n Entry>, name: &str) -> Vec<(&'n Entry, &'n Node)> {
        let Some(entry) = entry else { return Vec::new() };
        match &entry.value.content {
            Content::List(nodes) => nodes.iter().map(|node| (entry, node)).collect(),
            _ => {
                let text = format!("`{name}` is a list of tables, not {}", entry.value.kind());
                let finding = Finding::at(Code::WrongType, entry.value.span.clone(), text);
                self.findings.push(finding.help(format!("[[{name}]] begins one")));
                Vec::new()
            }
        }
    }

    fn keys<'n>(&mut self, node: &'n Node, span: &Range<usize>, place: &'static str) -> Option<Keys<'n>> {
        let Some(entries) = node.table() else {
            self.error(Code::WrongType, &node.span, format!("{place} is a table, not {}", node.kind()));
            return None;
        };
        Some(Keys { entries, span: span.clone(), place, known: Vec::new() })
    }

    /// Complains of keys that nobody has taken.
    fn finish(&mut self, keys: &Keys<'_>) {
        for entry in keys.entries.iter().filter(|entry| !keys.known.contains(&entry.key.as_str())) {
            let hint = did_you_mean(&entry.key, keys.known.iter().copied());
            let finding = Finding::at(
                Code::UnknownKey,
                entry.span.clone(),
                format!("unknown key `{}`{hint}", entry.key),
            )
            .label(format!("not a key of {}", keys.place))
            .help(format!("{} takes: {}", keys.place, keys.known.join(" · ")));
            self.findings.push(finding);
        }
    }

    /// What a key holds, as `parse` understands it.
    fn value<T>(
        &mut self,
        keys: &mut Keys<'_>,
        key: &'static str,
        need: Need,
        expected: &str,
        parse: impl Fn(&Node) -> Option<T>,
    ) -> Option<T> {
        let Some(entry) = keys.entry(key) else {
            if need == Needed {
                let finding =
                    Finding::at(Code::Missing, keys.span.clone(), format!("{} lacks `{key}`", keys.place));
                self.findings.push(finding.help(format!("{key} = {expected}")));
            }
            return None;
        };
        let value = parse(&entry.value);
        if value.is_none() {
            let text = format!("`{key}` cannot be {}", described(&entry.value));
            let finding = Finding::at(Code::WrongType, entry.value.span.clone(), text);
            self.findings.push(finding.label(format!("expected {expected}")));
        }
        value
    }

    fn number(&mut self, keys: &mut Keys<'_>, key: &'static str, need: Need) -> Option<f32> {
        self.value(keys, key, need, "a number", number)
    }

    fn whole(&mut self, keys: &mut Keys<'_>, key: &'static str, range: [u32; 2], otherwise: u32) -> u32 {
        let [low, high] = range;
        let parse = |node: &Node| {
            let Content::Number(x) = node.content else { return None };
            let is_whole = x.fract() == 0.0 && x >= f64::from(low) && x <= f64::from(high);
            is_whole.then_some(x as u32)
        };
        let expected = format!("a whole number in {low} to {high}");
        self.value(keys, key, Optional, &expected, parse).unwrap_or(otherwise)
    }

    fn vector(&mut self, keys: &mut Keys<'_>, key: &'static str, need: Need) -> Option<Vec3> {
        self.value(keys, key, need, "[x, y, z]", vector)
    }

    fn light_of(&mut self, keys: &mut Keys<'_>, key: &'static str, need: Need) -> Option<Rgb<f32>> {
        self.value(keys, key, need, "a grey or [red, green, blue], at least 0", |node| {
            let light = number(node).map(Vec3::splat).or_else(|| vector(node))?;
            (light.min_element() >= 0.0).then_some(Rgb(light.to_array()))
        })
    }

    fn text(&mut self, keys: &mut Keys<'_>, key: &'static str, need: Need, expected: &str) -> Option<String> {
        self.value(keys, key, need, expected, |node| match &node.content {
            Content::Text(text) => Some(text.clone()),
            _ => None,
        })
    }

    /// What a constructor made, or its complaint.
    fn made<T, E: core::fmt::Display>(&mut self, keys: &Keys<'_>, made: Result<T, E>) -> Option<T> {
        made.map_err(|error| self.error(Code::OutOfRange, &keys.span, format!("{}: {error}", keys.place)))
            .ok()
    }

    fn camera(&mut self, entry: &Entry) -> Option<Camera> {
        let mut keys = self.keys(&entry.value, &entry.span, "[camera]")?;
        let position = self.vector(&mut keys, "position", Needed);
        let target = self.vector(&mut keys, "target", Needed);
        let up = self.vector(&mut keys, "up", Optional).unwrap_or(Vec3::Z);
        let angle = self.number(&mut keys, "field_of_view_deg", Optional).unwrap_or(40.0);
        let size = self.value(&mut keys, "size", Needed, "[width, height], 1 to 65536 each", |node| {
            let Content::List(nodes) = &node.content else { return None };
            let [width, height] = nodes.as_slice() else { return None };
            let pixels = |node: &Node| match node.content {
                Content::Number(x) if x.fract() == 0.0 && (1.0..=65_536.0).contains(&x) => Some(x as usize),
                _ => None,
            };
            Some([pixels(width)?, pixels(height)?])
        });
        self.finish(&keys);
        let camera = Camera::new(position?, target?, up, angle.to_radians(), size?);
        self.made(&keys, camera)
    }

    fn settings(&mut self, entry: &Entry) -> (Settings, u32) {
        let default = Settings::default();
        let Some(mut keys) = self.keys(&entry.value, &entry.span, "[render]") else { return (default, 64) };
        let samples = self.whole(&mut keys, "samples", [1, 1 << 24], 64);
        let most_bounces = self.whole(&mut keys, "most_bounces", [0, 1 << 24], default.most_bounces);
        let roulette_from = self.whole(&mut keys, "roulette_from", [0, 1 << 24], default.roulette_from);
        let seed = u64::from(self.whole(&mut keys, "seed", [0, u32::MAX], 0));
        self.finish(&keys);
        (Settings { most_bounces, roulette_from, seed, ..default }, samples)
    }

    fn surroundings(&mut self, entry: &Entry) -> Surroundings {
        let Some(mut keys) = self.keys(&entry.value, &entry.span, "[surroundings]") else {
            return Surroundings::default();
        };
        let radiance = self.light_of(&mut keys, "radiance", Optional).unwrap_or(Rgb::BLACK);
        let background = self.light_of(&mut keys, "background", Optional);
        self.finish(&keys);
        Surroundings { radiance, background }
    }

    fn light(&mut self, entry: &Entry, node: &Node) -> Option<Light> {
        let mut keys = self.keys(node, &entry.span, "[[light]]")?;
        const KINDS: &str = "\"point\" or \"sphere\"";
        let kind = self.text(&mut keys, "kind", Needed, KINDS)?;
        let light = match kind.as_str() {
            "point" => {
                let position = self.vector(&mut keys, "position", Needed);
                let intensity = self.light_of(&mut keys, "intensity", Needed);
                self.finish(&keys);
                Light::point(position?, intensity?)
            }
            "sphere" => {
                let center = self.vector(&mut keys, "center", Needed);
                let radius = self.number(&mut keys, "radius", Needed);
                let radiance = self.light_of(&mut keys, "radiance", Needed);
                self.finish(&keys);
                let (center, radius, radiance) = (center?, radius?, radiance?);
                Sphere::new(center, radius).and_then(|sphere| Light::sphere(sphere, radiance))
            }
            other => {
                let hint = did_you_mean(other, ["point", "sphere"].into_iter());
                let text = format!("no light is a \"{other}\"{hint}; expected {KINDS}");
                self.error(Code::UnknownName, &node.span, text);
                return None;
            }
        };
        self.made(&keys, light)
    }

    fn object(&mut self, entry: &Entry, node: &Node, objects: &mut Vec<Object>) {
        let Some(mut keys) = self.keys(node, &entry.span, "[[object]]") else { return };
        if let Content::Table(entries) = &node.content
            && let Some(first) = entries.first()
        {
            keys.span = first.span.clone();
        }
        const SHAPES: [&str; 3] = ["sphere", "quad", "mesh"];
        let Some(shape) = self.text(&mut keys, "shape", Needed, "\"sphere\", \"quad\" or \"mesh\"") else {
            return;
        };
        let emission = self.light_of(&mut keys, "emission", Optional).unwrap_or(Rgb::BLACK);
        let material = self.text(&mut keys, "material", Optional, "the name of a material");
        let place =
            keys.entries.iter().find(|entry| entry.key == "material").map(|entry| entry.value.span.clone());
        let material = material.and_then(|name| self.material(&name, &place.unwrap_or(node.span.clone())));
        match shape.as_str() {
            "sphere" => {
                let center = self.vector(&mut keys, "center", Needed);
                let radius = self.number(&mut keys, "radius", Needed);
                self.finish(&keys);
                let (Some(center), Some(radius)) = (center, radius) else { return };
                let sphere = self.made(&keys, Sphere::new(center, radius));
                objects.extend(sphere.map(|sphere| Object { shape: Box::new(sphere), material, emission }));
            }
            "quad" => {
                let corner = self.vector(&mut keys, "corner", Needed);
                let edges = self.value(&mut keys, "edges", Needed, "[[x, y, z], [x, y, z]]", |node| {
                    let Content::List(nodes) = &node.content else { return None };
                    let [a, b] = nodes.as_slice() else { return None };
                    Some([vector(a)?, vector(b)?])
                });
                self.finish(&keys);
                let (Some(corner), Some(edges)) = (corner, edges) else { return };
                let quad = self.made(&keys, Quad::new(corner, edges));
                objects.extend(quad.map(|quad| Object { shape: Box::new(quad), material, emission }));
            }
            "mesh" => self.mesh(&mut keys, material, emission, objects),
            other => {
                let hint = did_you_mean(other, SHAPES.into_iter());
                let text = format!("no shape is a \"{other}\"{hint}; expected one of {}", SHAPES.join(", "));
                self.error(Code::UnknownName, &node.span, text);
            }
        }
    }

    /// A material of the file or a preset, by its index among those in use.
    fn material(&mut self, name: &str, span: &Range<usize>) -> Option<usize> {
        if let Some(index) = self.names.iter().position(|known| known == name) {
            return Some(index);
        }
        let of_file = self.document.materials.iter().find(|entry| entry.name == name);
        let description = match of_file {
            Some(entry) => Ok(entry.description.clone()),
            None => preset(name).and_then(|preset| preset.description()),
        };
        let Ok(description) = description else {
            let known = self.document.materials.iter().map(|entry| entry.name.as_str());
            let hint = did_you_mean(name, known.chain(PRESETS.iter().map(|preset| preset.name)));
            let finding = Finding::at(
                Code::UnknownName,
                span.clone(),
                format!("no material is named \"{name}\"{hint}"),
            );
            self.findings.push(finding.help("[material.NAME] makes one; `gonio list` shows the presets"));
            return None;
        };
        self.made_material(name, description, span)
    }

    fn made_material(&mut self, name: &str, description: Description, span: &Range<usize>) -> Option<usize> {
        if let Some(index) = self.names.iter().position(|known| known == name) {
            return Some(index);
        }
        match description.material() {
            Ok(material) => {
                self.materials.push(material);
                self.names.push(name.to_owned());
                Some(self.names.len() - 1)
            }
            Err(problem) => {
                self.error(Code::OutOfRange, span, format!("material \"{name}\": {problem}"));
                None
            }
        }
    }

    fn mesh(
        &mut self,
        keys: &mut Keys<'_>,
        material: Option<usize>,
        emission: Rgb<f32>,
        objects: &mut Vec<Object>,
    ) {
        let file = self.text(keys, "file", Optional, "the path of an .obj or .ply file");
        let name = self.text(keys, "generated", Optional, "the name of a generated mesh");
        let resolution = self.whole(keys, "resolution", [1, 1 << 24], 256);
        let scale = self.number(keys, "scale", Optional).unwrap_or(1.0);
        let turn = self.number(keys, "rotation_deg", Optional).unwrap_or(0.0);
        let translation = self.vector(keys, "translation", Optional).unwrap_or(Vec3::ZERO);
        let groups = self.groups(keys);
        self.finish(keys);
        if scale <= 0.0 {
            self.error(
                Code::OutOfRange,
                &keys.span,
                format!("scale = {scale} is out of range: expected a number > 0"),
            );
            return;
        }
        let mut imported = Vec::new();
        let parts = match (file, name) {
            (Some(file), None) => self.parts_of_file(keys, &file, &mut imported),
            (None, Some(name)) => {
                let parts = generated::Shape::from_name(&name).and_then(|shape| shape.build(resolution));
                let named = |part: generated::Part| (Some(part.name.to_owned()), part.mesh);
                self.made(keys, parts).map(|parts| parts.into_iter().map(named).collect())
            }
            _ => {
                let finding = Finding::at(
                    Code::Missing,
                    keys.span.clone(),
                    "a mesh has either a `file` or is `generated`",
                );
                let names = generated::Shape::ALL.map(|(name, _)| name).join(", ");
                self.findings.push(finding.help(format!("generated = one of {names}")));
                None
            }
        };
        let turn = Mat3::from_rotation_z(turn.to_radians());
        for (part, mut triangles) in parts.unwrap_or_default() {
            let of_part = groups.iter().find(|(name, _)| Some(name) == part.as_ref());
            let of_part = of_part.map(|&(_, index)| index).or(material).or_else(|| {
                let (name, description) = imported.iter().find(|(name, _)| Some(name) == part.as_ref())?;
                self.made_material(&format!("{name} of .mtl"), description.clone(), &keys.span)
            });
            if let (None, Some(part), true) = (of_part, &part, emission == Rgb::BLACK) {
                let text = format!("part \"{part}\" has no material and is black");
                let finding = Finding::at(Code::MeshRemark, keys.span.clone(), text);
                let help = format!("materials.{part} = \"…\", or material = \"…\" for all parts");
                self.findings.push(finding.help(help));
            }
            for position in &mut triangles.positions {
                *position = (turn * (Vec3::from(*position) * scale) + translation).to_array();
            }
            for normal in &mut triangles.normals {
                *normal = (turn * Vec3::from(*normal)).to_array();
            }
            let mesh = self.made(keys, Mesh::new(triangles));
            objects.extend(mesh.map(|mesh| {
                let mesh = if emission == Rgb::BLACK { mesh } else { mesh.emitting() };
                Object { shape: Box::new(mesh) as Box<dyn Shape>, material: of_part, emission }
            }));
        }
    }

    /// `materials.PART = "name"`: materials of the parts of a mesh.
    fn groups(&mut self, keys: &mut Keys<'_>) -> Vec<(String, usize)> {
        let Some(entry) = keys.entry("materials") else { return Vec::new() };
        let mut groups = Vec::new();
        for entry in entry.value.table().unwrap_or_default() {
            match &entry.value.content {
                Content::Text(name) => {
                    groups.extend(
                        self.material(name, &entry.value.span).map(|index| (entry.key.clone(), index)),
                    );
                }
                _ => self.error(
                    Code::WrongType,
                    &entry.value.span,
                    format!("`{}` names a material", entry.key),
                ),
            }
        }
        groups
    }

    /// The parts of a mesh file; materials of its libraries go to `imported`.
    fn parts_of_file(
        &mut self,
        keys: &Keys<'_>,
        file: &str,
        imported: &mut Vec<(String, Description)>,
    ) -> Option<Vec<(Option<String>, Triangles)>> {
        let path = self.folder.join(file);
        self.files.push(path.clone());
        let (data, warnings) = match mesh_file::read(&path) {
            Ok(read) => read,
            Err(error) => {
                self.error(Code::Unreadable, &keys.span, error.to_string());
                return None;
            }
        };
        let mut remark = |text: String| {
            let text = format!("{file}: {text}");
            self.findings.push(Finding::at(Code::MeshRemark, keys.span.clone(), text));
        };
        warnings.into_iter().for_each(&mut remark);
        for library in &data.material_libraries {
            let library = path.parent().unwrap_or(Path::new("")).join(library);
            match text_of(&library) {
                Ok(text) => {
                    let (materials, findings) = mtl(&text);
                    imported.extend(materials.into_iter().map(|found| (found.name, found.description)));
                    let shown = library.display();
                    findings.iter().for_each(|finding| remark(format!("{shown}: {}", finding.line())));
                    self.files.push(library);
                }
                Err(finding) => remark(finding.text),
            }
        }
        Some(data.parts())
    }
}

fn number(node: &Node) -> Option<f32> {
    match node.content {
        Content::Number(x) if (x as f32).is_finite() => Some(x as f32),
        _ => None,
    }
}

fn vector(node: &Node) -> Option<Vec3> {
    let Content::List(nodes) = &node.content else { return None };
    let [x, y, z] = nodes.as_slice() else { return None };
    Some(Vec3::new(number(x)?, number(y)?, number(z)?))
}

/// A value in words.
fn described(node: &Node) -> String {
    match &node.content {
        Content::Number(x) => x.to_string(),
        Content::Text(text) => format!("\"{text}\""),
        _ => node.kind().to_owned(),
    }
}

//! Materials from the files of other programs, each with a table of what became of every value.
//!
//! A file says more, less and other things than a [`Description`] does. Every key that it sets is in the
//! table of losses once: carried without error ([`Fate::Exact`]), by a rule whose error the table states
//! ([`Fate::Converted`]), or left out ([`Fate::Dropped`]). What would be wrong by more than a tenth of the
//! light is not imported: half a metal has no equal among the materials of the thesis. The exception is Ks
//! of `.mtl` outside of the illumination models of reflection: in practice it is a strength without a unit,
//! so that the highlight is Fresnel's and the table states by how much the two differ.
//!
//! # What becomes what
//! | in the file | here |
//! |---|---|
//! | diffuse colour without a highlight | matte |
//! | diffuse colour below a highlight or a coat | plastic, the colour raised to that below the interface |
//! | colour of a coat over a diffuse colour; over a metal | in that colour; absorbance of the coat |
//! | metal by its colour at 0° and at its edge | metal, η and k per channel |
//! | the same below a coat | car paint, η and k times the index of the coat, which divides them again |
//! | a transmitting body; a thin one | glass; thin glass |
//! | reflection without Fresnel's equations (`.mtl`, illum 3) | mirror |
//!
//! Roughness r of `.mtl` (Pr), glTF, OpenPBR and Standard Surface is perceptual: α = r². The exponent of
//! Blinn and Phong is α = √(2 / (Ns + 2)), of equal height of the peak (Walter et al., "Microfacet models
//! for refraction through rough surfaces", EGSR 2007, doi:10.2312/EGWR/EGSR07/195-206, §5.2). A transmitted
//! colour c at depth d is an absorbance −ln(c) / d, which is exact in Napierian units.
//!
//! # Example
//! ```
//! use gonio::material::{Model, foreign};
//! let (materials, findings) = foreign::mtl("newmtl chalk\nKd 0.8\nillum 1\n");
//! assert!(findings.is_empty());
//! assert_eq!(materials[0].description.model(), Model::Matte);
//! ```

mod materialx;
mod mtl;
mod shader;

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;

use serde::Serialize;

use super::{Description, Model, Value};
use crate::fresnel::{Lazanyi, conductor, dielectric, normal_incidence, schlick};
use crate::message::{Code, Finding};
use crate::quadrature::cosine_average;

pub use materialx::materialx;
pub use mtl::mtl;

/// A material of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// Its name in the file.
    pub name: String,
    /// The nearest material here.
    pub description: Description,
    /// What became of each value that the file sets, in its order.
    pub losses: Vec<Loss>,
}

/// What became of a value.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Loss {
    /// The key with its value, as in the file.
    pub key: String,
    /// How it was carried.
    pub fate: Fate,
    /// What became of it, and by how much it can be wrong.
    pub text: String,
    /// Its bytes in the file.
    pub span: Range<usize>,
}

/// How a value was carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Fate {
    /// Without error, be it in another unit, or it has no effect.
    Exact,
    /// By a rule that can be wrong.
    Converted,
    /// Not at all.
    Dropped,
}

impl fmt::Display for Fate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Exact => "exact",
            Self::Converted => "converted",
            Self::Dropped => "dropped",
        })
    }
}

/// The largest share of the light that is dropped with a line in the table; above, a material has no equal.
const SHARE: f64 = 0.1;

/// A sheet that blurs less than this α is taken as clear.
const CLEAR: f64 = 0.01;

/// What a key of a format takes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// A number in \[0, 1\].
    Share,
    /// A number in a range.
    Number([f64; 2]),
    /// Reflectances or transmittances per channel.
    Colour,
    /// A colour that may be above 1.
    Light,
    /// True or false, as 1 or 0.
    Flag,
    /// A direction of the geometry.
    Vector,
}

/// Numbers ≥ 0.
const POSITIVE: Kind = Kind::Number([0.0, f64::MAX]);
/// Indices of refraction.
const INDEX: Kind = Kind::Number([1e-3, 1e3]);
/// Finite numbers.
const FINITE: Kind = Kind::Number([f64::MIN, f64::MAX]);

impl Kind {
    fn is_colour(self) -> bool {
        matches!(self, Self::Colour | Self::Light)
    }

    /// How many numbers it has.
    fn len(self) -> usize {
        if self.is_colour() || self == Self::Vector { 3 } else { 1 }
    }

    /// What it takes in words, if that is not the given value.
    fn refuses(self, value: [f64; 3]) -> Option<String> {
        let [low, high] = match self {
            Self::Share | Self::Colour | Self::Flag => [0.0, 1.0],
            Self::Number(range) => range,
            Self::Light => [0.0, f64::MAX],
            Self::Vector => [f64::MIN, f64::MAX],
        };
        let is_in = |&x: &f64| x >= low && x <= high;
        if value[..self.len()].iter().all(is_in) {
            return None;
        }
        Some(if high == f64::MAX && low == 0.0 {
            "expected a number that is not negative".to_owned()
        } else if high == f64::MAX {
            "expected a finite number".to_owned()
        } else {
            format!("expected {} in [{low}, {high}]", if self.len() == 1 { "a number" } else { "each" })
        })
    }
}

/// A key of a format.
#[derive(Clone, Copy, Debug)]
struct Key {
    /// What it is called there.
    name: &'static str,
    /// What it is, the same for several formats.
    role: &'static str,
    kind: Kind,
    default: [f64; 3],
}

/// A key that a file sets.
#[derive(Clone, Debug)]
struct Input {
    /// Empty for what has no meaning here.
    role: &'static str,
    /// As in the file, with its value.
    text: String,
    span: Range<usize>,
    value: [f64; 3],
    is_default: bool,
    fate: Option<(Fate, String)>,
}

/// A material of a file on its way into a description.
#[derive(Debug)]
struct Draft {
    name: String,
    span: Range<usize>,
    keys: Vec<Key>,
    inputs: Vec<Input>,
    /// Where among the inputs a role is.
    roles: BTreeMap<&'static str, usize>,
    values: Vec<(&'static str, Value, Range<usize>)>,
    findings: Vec<Finding>,
}

impl Draft {
    fn new(name: String, span: Range<usize>, keys: Vec<Key>) -> Self {
        let (inputs, roles, values, findings) = Default::default();
        Self { name, span, keys, inputs, roles, values, findings }
    }

    /// The next input of the file.
    fn push(&mut self, input: Input) {
        if !input.role.is_empty() {
            self.roles.insert(input.role, self.inputs.len());
        }
        self.inputs.push(input);
    }

    fn input(&self, role: &str) -> Option<&Input> {
        self.roles.get(role).map(|i| &self.inputs[*i])
    }

    /// The value that the file gives.
    fn given(&self, role: &str) -> Option<[f64; 3]> {
        self.input(role).map(|input| input.value)
    }

    /// The value that the file gives, or the format.
    fn colour(&self, role: &str) -> [f64; 3] {
        let default = || self.keys.iter().find(|key| key.role == role).map(|key| key.default);
        self.given(role).or_else(default).unwrap_or_default()
    }

    fn number(&self, role: &str) -> f64 {
        self.colour(role)[0]
    }

    /// Where a role stands in the file, or the material.
    fn place(&self, role: &str) -> Range<usize> {
        self.input(role).map_or(self.span.clone(), |input| input.span.clone())
    }

    /// What became of inputs, unless that has been said.
    fn note(&mut self, roles: &[&str], fate: Fate, text: impl Into<String>) {
        let text = text.into();
        for role in roles {
            if let Some(i) = self.roles.get(role) {
                self.inputs[*i].fate.get_or_insert((fate, text.clone()));
            }
        }
    }

    /// The same in place of what was said before, or behind it where that is a loss.
    fn rather(&mut self, role: &str, fate: Fate, text: impl Into<String>) {
        if let Some(i) = self.roles.get(role) {
            let text = text.into();
            self.inputs[*i].fate = Some(match self.inputs[*i].fate.take() {
                Some((Fate::Dropped, lost)) => (Fate::Dropped, format!("{lost}; {text}")),
                _ => (fate, text),
            });
        }
    }

    fn exact(&mut self, role: &str, text: impl Into<String>) {
        self.note(&[role], Fate::Exact, text);
    }

    fn converted(&mut self, role: &str, text: impl Into<String>) {
        self.note(&[role], Fate::Converted, text);
    }

    fn dropped(&mut self, role: &str, text: impl Into<String>) {
        self.note(&[role], Fate::Dropped, text);
    }

    /// A value of the description that comes from a role.
    fn set(&mut self, path: &'static str, value: impl Into<Value>, role: &str) {
        self.values.retain(|(other, ..)| *other != path);
        self.values.push((path, value.into(), self.place(role)));
    }

    /// The material cannot be imported for what a role says.
    fn refuse(&mut self, code: Code, role: &str, text: impl fmt::Display, help: &str) {
        let text = match self.input(role) {
            Some(input) => format!("`{}` of `{}`: {text}", input.text, quoted(&self.name)),
            None => format!("`{}`: {text}", quoted(&self.name)),
        };
        self.findings.push(Finding::at(code, self.place(role), text).help(help));
    }

    /// Is there nearly all (`true`) or nearly none (`false`) of something that cannot be there in part?
    /// Otherwise the material is refused. Where there is nearly none, the inputs that describe it, `others`, are
    /// lost with it.
    fn share(&mut self, role: &str, others: &[&str], weight: f64, what: &str) -> Option<bool> {
        let is_there = weight > 0.5;
        let lost = if is_there { 1.0 - weight } else { weight };
        if lost > SHARE {
            let text = format!("{} of {what} beside the rest has no equal here", show(weight));
            self.refuse(Code::NoEqual, role, text, "decide for 0 or 1, or mix the images of two materials");
            return None;
        }
        if lost > 0.0 {
            let whole = if is_there { 1 } else { 0 };
            let text = format!("taken as {whole}: wrong by up to {} of the light", show(lost));
            if !is_there {
                self.note(others, Fate::Dropped, text.clone());
            }
            self.dropped(role, text);
        } else {
            self.exact(role, format!("{} {what}: it chooses the model", if is_there { "all" } else { "no" }));
        }
        Some(is_there)
    }

    /// Refuses a share of something that no material here has, or drops it with the inputs that describe it.
    fn lacks(&mut self, roles: &[&str], weight: f64, what: &str) {
        if weight > SHARE {
            let help = "set it to 0 where the look can do without";
            self.refuse(
                Code::NoEqual,
                roles[0],
                format!("{} of {what} has no equal here", show(weight)),
                help,
            );
        } else if weight > 0.0 {
            self.note(roles, Fate::Dropped, format!("{what} is lost: up to {} of the light", show(weight)));
        }
    }

    /// The material, or why there is none.
    fn finish(mut self, model: Option<Model>) -> Result<Imported, Vec<Finding>> {
        let Some(model) = model.filter(|_| self.findings.is_empty()) else { return Err(self.findings) };
        let values = self.values.iter().map(|(path, value, _)| (*path, value.clone()));
        let (description, mut problems) = Description::examined(model, values);
        if problems.is_empty() {
            problems = description.contradictions();
        }
        let name = quoted(&self.name);
        for problem in problems {
            let place = self.values.iter().find(|(path, ..)| Some(*path) == problem.parameter());
            let span = place.map_or(self.span.clone(), |(.., span)| span.clone());
            let text = match self.inputs.iter().find(|input| input.span == span) {
                Some(input) => format!("`{}` of `{name}`: as {} {problem}", input.text, model.name()),
                None => format!("`{name}`: as {} {problem}", model.name()),
            };
            // The file may say so; the parameter here cannot.
            let help = "take a value within the range, or import the other materials without this one";
            self.findings.push(Finding::at(Code::NoEqual, span, text).help(help));
        }
        if !self.findings.is_empty() {
            return Err(self.findings);
        }
        let losses = self.inputs.into_iter().map(|input| {
            let unused = if input.is_default { "the default" } else { "without effect on this material" };
            let (fate, text) = input.fate.unwrap_or((Fate::Exact, unused.to_owned()));
            Loss { key: input.text, fate, text, span: input.span }
        });
        Ok(Imported { name: self.name, losses: losses.collect(), description })
    }
}

/// Text of a file in one line of a message.
fn quoted(text: &str) -> String {
    let mut line: String = text.chars().take(80).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(80).is_some() {
        line.push('…');
    }
    line
}

/// A number with four digits.
fn show(number: f64) -> String {
    if number == 0.0 || !number.is_finite() {
        return number.to_string();
    }
    if !(1e-6..1e6).contains(&number.abs()) {
        return format!("{number:.3e}");
    }
    let digits = (3.0 - number.abs().log10().floor()).max(0.0);
    let text = format!("{number:.*}", digits as usize);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn show_colour(colour: [f64; 3]) -> String {
    if colour[0] == colour[1] && colour[1] == colour[2] {
        return show(colour[0]);
    }
    format!("[{}]", colour.map(show).join(", "))
}

fn product(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

fn largest(colour: [f64; 3]) -> f64 {
    colour.into_iter().fold(f64::MIN, f64::max)
}

fn smallest(colour: [f64; 3]) -> f64 {
    colour.into_iter().fold(f64::MAX, f64::min)
}

/// Napierian absorbance of a medium that leaves `colour` of the light after `depth`: −ln(c) / d.
fn absorbance(colour: [f64; 3], depth: f64) -> [f64; 3] {
    // 0 − x has no negative zero.
    colour.map(|c| 0.0 - c.ln() / depth)
}

/// F₀ of a dielectric.
fn f0_of(eta: f64) -> f64 {
    normal_incidence(eta, 0.0)
}

/// The index whose F₀ is `weight` times that of `eta`: (1 + ε) / (1 − ε), ε = ±√(w F₀) (OpenPBR 1.1, specular
/// weight).
fn weighted_index(eta: f64, weight: f64) -> f64 {
    if weight == 1.0 {
        return eta;
    }
    let root = (eta - 1.0) / (eta + 1.0) * weight.sqrt();
    (1.0 + root) / (1.0 - root)
}

/// Share of diffuse light from inside that the interface of a coat returns: 1 − (1 − F̄) / η², F̄ the mean
/// reflectance from outside.
fn returned_inside(eta: f64) -> f64 {
    // Rounding leaves −1e-16 at η = 1, where all is let through.
    let mean = cosine_average(&|root| dielectric(root * root, eta).reflectance.unpolarized());
    (1.0 - (1.0 - mean) / (eta * eta)).max(0.0)
}

/// What a metal of reflectance ρ at 0° loses at most to a coat that returns the share K of its light, where a
/// file has no internal reflections: ρ − ρ (1 − K) / (1 − ρ K). Smooth metals lose less.
fn lost_to_coat(f0: [f64; 3], eta: f64) -> f64 {
    // A coat of another index is refused as such.
    let returned = if eta >= 1.0 { returned_inside(eta) } else { 0.0 };
    largest(f0.map(|rho| if rho < 1.0 { returned * rho * (1.0 - rho) / (1.0 - rho * returned) } else { 0.0 }))
}

/// The reflectance below an interface that lets the share (1 − F) `seen` of the light out: ρ / (t + ρ (1 −
/// t)).
///
/// Other programs lay a diffuse lobe below a highlight as (1 − F) ρ; light that is returned inside is not
/// followed. Over a Lambertian base the refractive layer has the albedo (1 − F) t ρ′ / (1 − ρ′ (1 − t)), t =
/// 1 − K(0), which is the same at every angle with ρ′ as above.
fn below(seen: [f64; 3], eta: f64) -> [f64; 3] {
    // A coat of another index is refused as such, not for what would follow.
    if !(1.0..1e3).contains(&eta) {
        return seen;
    }
    let t = 1.0 - returned_inside(eta);
    seen.map(|rho| if rho == 0.0 { 0.0 } else { rho / (t + rho * (1.0 - t)) })
}

/// η and k of a metal of reflectance r at 0° and edge tint g.
///
/// O. Gulbrandsen, "Artist friendly metallic Fresnel", JCGT 3(4), 2014,
/// <https://jcgt.org/published/0003/04/03/>: η = g (1 − r) / (1 + r) + (1 − g) (1 + √r) / (1 − √r), k² = (r
/// (η + 1)² − (η − 1)²) / (1 − r). At r = 1 the limit for g = 1: η = 0, k = 1, which reflects all at every
/// angle, as every r = 1 does.
fn gulbrandsen(r: f64, g: f64) -> [f64; 2] {
    if r == 1.0 {
        return [0.0, 1.0];
    }
    let root = r.sqrt();
    let eta = g * (1.0 - r) / (1.0 + r) + (1.0 - g) * (1.0 + root) / (1.0 - root);
    let k_squared = (r * (eta + 1.0).powi(2) - (eta - 1.0).powi(2)) / (1.0 - r);
    // At g = 0 and at r = 0 it is 0 but for rounding.
    [eta, k_squared.max(0.0).sqrt()]
}

/// η and k per channel that come closest to a formula for metals.
struct MetalFit {
    eta: [f64; 3],
    k: [f64; 3],
    /// By how much the reflectance of a channel is off, at most and in the mean over a white sky.
    error: [f64; 2],
}

impl MetalFit {
    /// White metals are met but for rounding.
    fn fate(&self) -> Fate {
        if self.error[0] < 1e-12 { Fate::Exact } else { Fate::Converted }
    }

    fn error_in_words(&self) -> String {
        let [most, mean] = self.error.map(show);
        format!("off by up to {most}, {mean} in the mean")
    }
}

/// The metal that has the reflectance w `f0` at 0° and w `tint` times that of Schlick's at cos θ = 1/7: the
/// curve of Lazányi & Szirmay-Kalos with the edge at 82° (Kutz, Hašan & Edmondson, "Novel aspects of the
/// Adobe Standard Material", 2023). `tint` 1 is Schlick's formula. Where no complex index reflects as asked
/// at 82°, the nearest.
fn metal_like_f82(f0: [f64; 3], tint: [f64; 3], weight: f64) -> MetalFit {
    let mut fit = MetalFit { eta: [0.0; 3], k: [0.0; 3], error: [0.0; 2] };
    for channel in 0..3 {
        let f0 = f0[channel];
        let edge = 1.0 / 7.0;
        let curve = Lazanyi::new(f0, tint[channel] * schlick(edge, f0));
        let wanted = |cos: f64| weight * curve.reflectance(cos);
        let at = |[eta, k]: [f64; 2], cos: f64| conductor(cos, eta, k).reflectance.unpolarized();
        // Reflectance at 82° rises with the edge tint.
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let is_low = at(gulbrandsen(weight * f0, middle), edge) < wanted(edge);
            *(if is_low { &mut low } else { &mut high }) = middle;
        }
        let index = gulbrandsen(weight * f0, high);
        [fit.eta[channel], fit.k[channel]] = index;
        let mut mean = 0.0;
        for degrees in 0..90 {
            let (sin, cos) = (f64::from(degrees) + 0.5).to_radians().sin_cos();
            let error = (at(index, cos) - wanted(cos)).abs();
            fit.error[0] = fit.error[0].max(error);
            mean += error * 2.0 * sin * cos * 1_f64.to_radians();
        }
        fit.error[1] = fit.error[1].max(mean);
    }
    fit
}

//! Wavefront `.mtl`: the keys of 1995 and those that renderers have added for metals, roughness and coats.
//!
//! Alias|Wavefront, "File Formats" 4.2, 1995, chapter 5; the keys Pr, Pm, Ps, Pc, Pcr, aniso, anisor and norm
//! are Exocortex's "Extending Wavefront MTL to support PBR".

use std::collections::BTreeSet;
use std::ops::Range;

use super::{
    Draft, FINITE, Fate, Imported, Input, Key, Kind, POSITIVE, SHARE, below, f0_of, largest, lost_to_coat,
    metal_like_f82, quoted, show, show_colour, smallest,
};
use crate::material::Model;
use crate::message::{Code, Finding};
use crate::parameter::did_you_mean;
use crate::rgb::srgb_to_linear;
use crate::rgb::xyz_to_linear_srgb;

const fn key(name: &'static str, kind: Kind) -> Key {
    // The format states no defaults.
    Key { name, role: name, kind, default: [f64::NAN; 3] }
}

const KEYS: [Key; 18] = [
    key("Ka", Kind::Light),
    key("Kd", Kind::Colour),
    key("Ks", Kind::Colour),
    key("Ke", Kind::Light),
    key("Tf", Kind::Colour),
    key("Ns", POSITIVE),
    key("Ni", POSITIVE),
    key("d", Kind::Share),
    key("Tr", Kind::Share),
    key("illum", Kind::Number([0.0, 10.0])),
    key("sharpness", POSITIVE),
    key("Pr", Kind::Share),
    key("Pm", Kind::Share),
    key("Ps", Kind::Share),
    key("Pc", Kind::Share),
    key("Pcr", Kind::Share),
    key("aniso", Kind::Share),
    key("anisor", FINITE),
];

/// Maps of what is dropped anyway, and why.
const DROPPED_MAPS: [(&str, &str); 10] = [
    ("map_ka", "ambient light is computed"),
    ("map_ke", "a material does not emit"),
    ("map_aat", "it smooths textures"),
    ("map_bump", "bumps are the geometry's"),
    ("bump", "bumps are the geometry's"),
    ("norm", "bumps are the geometry's"),
    ("disp", "displacement is the geometry's"),
    ("map_disp", "displacement is the geometry's"),
    ("refl", "what is reflected is the scene's"),
    ("map_refl", "what is reflected is the scene's"),
];

/// The materials of a `.mtl` file, and what is wrong with those that are not among them.
///
/// Keys are read in any case, colours as linear Rec. 709: the format names no colour space, and programs
/// differ. A file with the heading of Blender has its rule for Ns. Transparency by `d` alone has no equal,
/// but in the illumination models of glass (4, 9: a sheet of thin glass; 6, 7: glass).
pub fn mtl(text: &str) -> (Vec<Imported>, Vec<Finding>) {
    let (mut materials, mut findings) = (Vec::new(), Vec::new());
    let mut drafts: Vec<Draft> = Vec::new();
    let mut taken = BTreeSet::new();
    for words in statements(text) {
        let span = words[0].start..words[words.len() - 1].end;
        let keyword = &text[words[0].clone()];
        if keyword.eq_ignore_ascii_case("newmtl") {
            let raw = words.get(1).map_or("", |first| &text[first.start..span.end]);
            // A continued name is one line.
            let name = if raw.contains(['\n', '\r']) {
                words[1..].iter().map(|word| &text[word.clone()]).collect::<Vec<_>>().join(" ")
            } else {
                raw.to_owned()
            };
            let mut draft = Draft::new(name.clone(), span.clone(), KEYS.to_vec());
            if name.is_empty() {
                let text = "newmtl without the name of a material";
                draft.findings.push(Finding::at(Code::ForeignSyntax, span, text));
            } else if !taken.insert(name.clone()) {
                let text = format!("a second material of the name `{}`", quoted(&name));
                draft.findings.push(Finding::at(Code::Meaningless, span, text));
            }
            drafts.push(draft);
        } else if let Some(draft) = drafts.last_mut() {
            match read(text, &words, draft) {
                Ok(input) => draft.push(input),
                Err(finding) => draft.findings.push(finding),
            }
        } else {
            let text = format!("`{}` before any newmtl", quoted(keyword));
            let finding = Finding::at(Code::ForeignSyntax, span, text);
            findings.push(finding.help("begin each material with `newmtl` and its name"));
        }
    }
    if drafts.is_empty() && findings.is_empty() {
        let text = "no material in the file; expected `newmtl` and a name";
        findings.push(Finding::of_file(Code::ForeignSyntax, text));
    }
    let program = Program::of_file(text);
    for mut draft in drafts {
        // What could not be read is missing in the model.
        let model = if draft.findings.is_empty() { model(&mut draft, program) } else { None };
        match draft.finish(model) {
            Ok(material) => materials.push(material),
            Err(refused) => findings.extend(refused),
        }
    }
    (materials, findings)
}

/// The words of each statement, without comments; a backslash at the end of a line continues it.
fn statements(text: &str) -> Vec<Vec<Range<usize>>> {
    let bytes = text.as_bytes();
    let mut all: Vec<Vec<Range<usize>>> = Vec::new();
    let mut words: Vec<Range<usize>> = Vec::new();
    let is_end = |byte: u8| byte == b'\n' || byte == b'\r';
    let mut i = if text.starts_with('\u{feff}') { '\u{feff}'.len_utf8() } else { 0 };
    // A line ends in LF, CR LF or CR; behind a backslash it goes on.
    let continued = |i: usize| match bytes.get(i..) {
        Some([b'\\', b'\r', b'\n', ..]) => Some(i + 3),
        Some([b'\\', b'\r' | b'\n', ..]) => Some(i + 2),
        _ => None,
    };
    while i < bytes.len() {
        if let Some(next) = continued(i) {
            i = next;
        } else if is_end(bytes[i]) {
            all.extend((!words.is_empty()).then(|| std::mem::take(&mut words)));
            i += 1;
        } else if bytes[i].is_ascii_whitespace() || bytes[i] == b'\x0b' {
            i += 1;
        } else if bytes[i] == b'#' {
            i += bytes[i..].iter().take_while(|byte| !is_end(**byte)).count();
        } else {
            let start = i;
            while i < bytes.len() && !bytes[i].is_ascii_whitespace() && continued(i).is_none() {
                i += 1;
            }
            words.push(start..i);
        }
    }
    all.extend((!words.is_empty()).then_some(words));
    all
}

/// A statement of a material.
fn read(text: &str, words: &[Range<usize>], draft: &Draft) -> Result<Input, Finding> {
    let word = |i: usize| words.get(i).map_or("", |range: &Range<usize>| &text[range.clone()]);
    let span = words[0].start..words[words.len() - 1].end;
    let shown = quoted(&words.iter().map(|range| &text[range.clone()]).collect::<Vec<_>>().join(" "));
    let material = quoted(&draft.name);
    let keyword = word(0);
    let lower = keyword.to_ascii_lowercase();
    let dropped = |why: String| {
        let fate = Some((Fate::Dropped, why));
        let text = shown.clone();
        Ok(Input { role: "", text, span: span.clone(), value: [0.0; 3], is_default: false, fate })
    };
    if let Some((_, why)) = DROPPED_MAPS.iter().find(|(map, _)| *map == lower) {
        return dropped((*why).to_owned());
    }
    if lower.starts_with("map_") || lower == "decal" {
        let message = format!("`{}` of `{material}` is no constant but a texture", quoted(keyword));
        let help = "bake a constant: remove the map, and give its linear mean in the key without `map_`";
        return Err(Finding::at(Code::NotConstant, span, message).help(help));
    }
    let Some(key) = KEYS.iter().find(|key| key.name.eq_ignore_ascii_case(keyword)) else {
        return dropped(format!(
            "no key of the format{}",
            did_you_mean(&quoted(keyword), KEYS.iter().map(|key| key.name))
        ));
    };
    if draft.input(key.role).is_some() {
        let message = format!("`{}` of `{material}` is given twice", key.name);
        return Err(Finding::at(Code::Meaningless, span, message).help("keep one of the two"));
    }
    if key.name == "d" && word(1).eq_ignore_ascii_case("-halo") {
        let message =
            format!("`{shown}` of `{material}`: a halo, which fades with the angle, has no equal here");
        return Err(Finding::at(Code::NoEqual, span, message).help("write `d` with one number"));
    }
    let is = |name: &str| key.kind.is_colour() && word(1).eq_ignore_ascii_case(name);
    if is("spectral") {
        let message = format!("`{shown}` of `{material}` is no constant but a file of spectra");
        let help = "write the colour under daylight as three numbers, linear Rec. 709";
        return Err(Finding::at(Code::NotConstant, span, message).help(help));
    }
    let first = if is("xyz") { 2 } else { 1 };
    let malformed = |what: &str| {
        let message = format!("`{shown}` of `{material}`: expected {what}");
        Finding::at(Code::ForeignSyntax, span.clone(), message)
    };
    let numbers: Result<Vec<f64>, _> = words[first.min(words.len())..]
        .iter()
        .map(|range| {
            let word = &text[range.clone()];
            word.parse().map_err(|_| {
                let hint = if word.contains(',') { "; decimals have a point" } else { "" };
                let message = format!("`{}` in `{shown}` of `{material}` is no number{hint}", quoted(word));
                Finding::at(Code::ForeignSyntax, range.clone(), message)
            })
        })
        .collect();
    let value = match numbers?[..] {
        [number] => [number; 3],
        [x, y, z] if key.kind.is_colour() => [x, y, z],
        _ if key.kind.is_colour() => return Err(malformed("three numbers, or one for a grey")),
        _ => return Err(malformed("one number")),
    };
    let value = if first == 2 { xyz_to_linear_srgb(value).0 } else { value };
    if let Some(expected) = key.kind.refuses(value) {
        let linear =
            if first == 2 { format!(" is {} in Rec. 709, and", show_colour(value)) } else { String::new() };
        let message = format!("`{shown}` of `{material}`{linear} is out of range: {expected}");
        let help = if largest(value) > 1.0 && key.kind == Kind::Colour {
            "a colour in 0 to 255 is to be divided by 255 and taken from sRGB to linear"
        } else {
            "correct the value in the file"
        };
        return Err(Finding::at(Code::Meaningless, span, message).help(help));
    }
    Ok(Input { role: key.role, text: shown, span, value, is_default: false, fate: None })
}

/// The program that wrote the file, where its Ns is not an exponent.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Program {
    Unknown,
    /// Ns is (1 − r)² times this, r perceptual: 1000, and 900 in files that name no version.
    Blender(f64),
}

impl Program {
    fn of_file(text: &str) -> Self {
        let mut comments =
            text.lines().map(str::trim).take_while(|line| line.is_empty() || line.starts_with('#'));
        let heading = comments.find_map(|line| line.trim_start_matches(['#', ' ']).strip_prefix("Blender "));
        match heading {
            Some(rest) if rest.starts_with("MTL") => Self::Blender(900.0),
            Some(_) => Self::Blender(1000.0),
            None => Self::Unknown,
        }
    }
}

/// Index of the interface of plastic and of coats where the file has none.
const USUAL_ETA: f64 = 1.5;

fn model(d: &mut Draft, program: Program) -> Option<Model> {
    let has = |d: &Draft, role: &str| d.given(role).is_some_and(|colour| largest(colour) > 0.0);
    for role in ["Ka", "Ke"] {
        if has(d, role) {
            let what = if role == "Ka" { "ambient light is computed" } else { "a material does not emit" };
            d.dropped(role, format!("{what}; {} is lost", show_colour(d.colour(role))));
        }
    }
    d.dropped("sharpness", "of reflection maps, which are not read");
    let is_pbr = ["Pr", "Pm", "Pc", "Pcr", "Ps", "aniso"].iter().any(|role| d.given(role).is_some());
    let ks = d.given("Ks").unwrap_or(if is_pbr { [0.5; 3] } else { [0.0; 3] });
    let illum = d.given("illum").map_or(if largest(ks) > 0.0 { 2.0 } else { 1.0 }, |illum| illum[0]);
    if illum.fract() != 0.0 {
        d.refuse(
            Code::Meaningless,
            "illum",
            "not the number of a model",
            "write a whole number from 0 to 10",
        );
        return None;
    }
    if illum == 10.0 {
        let help = "choose another illumination model, or leave the object to the scene";
        d.refuse(Code::NoEqual, "illum", "a surface that only catches shadows has no equal here", help);
        return None;
    }
    let illum = illum as u8;
    if illum == 0 {
        d.converted(
            "illum",
            "a constant colour without lighting: taken as the reflectance of a matte surface",
        );
    }
    d.exact("illum", "it chooses the model");
    let dissolve = dissolve(d)?;
    let metalness = d.given("Pm").map_or(0.0, |pm| pm[0]);
    let metal = d.share("Pm", &[], metalness, "metal");
    let coat = d.share("Pc", &["Pcr"], d.given("Pc").map_or(0.0, |pc| pc[0]), "coat");
    d.lacks(&["Ps"], d.given("Ps").map_or(0.0, |ps| ps[0]), "sheen");
    let (metal, coat) = (metal?, coat?);
    let kd = d.given("Kd");
    let diffuse = kd.map_or(0.0, largest) * dissolve;
    let tf = d.given("Tf").unwrap_or([1.0; 3]);
    let refracts = matches!(illum, 6 | 7) && !metal && largest(tf) > 0.0;
    if refracts && diffuse > SHARE && d.given("Tf").is_some() {
        let text =
            format!("illum {illum} adds {} of diffuse to refracted light: no equal here", show(diffuse));
        d.refuse(Code::NoEqual, "Kd", text, "set Kd to 0 for glass, or illum to 2 for an opaque material");
    }
    let glass = refracts && diffuse <= SHARE;
    let sheet = matches!(illum, 4 | 9) && !metal && dissolve <= SHARE;
    if (glass || sheet) && coat {
        d.refuse(Code::NoEqual, "Pc", "a coat over glass has no equal here", "set Pc to 0");
    }
    if !(glass || sheet) {
        let roles = if d.given("d").is_some() { ["d", "Tr"] } else { ["Tr", "d"] };
        d.lacks(&roles, 1.0 - dissolve, "transparency without refraction");
    }
    if !d.findings.is_empty() {
        return None;
    }
    if glass || sheet {
        return transmitting(d, program, illum, glass, diffuse);
    }
    d.note(&["d", "Tr", "Tf"], Fate::Exact, "nothing passes");
    let Some(kd) = kd.or((largest(ks) > 0.0 && !is_pbr).then_some([0.0; 3])) else {
        d.refuse(Code::NoEqual, "newmtl", "without Kd there is nothing to reflect", "give the colour as Kd");
        return None;
    };
    if metal {
        return Some(conductor(d, program, kd, "Kd", coat));
    }
    let has_highlight = illum >= 2 && largest(ks) > 0.0;
    let reflects = matches!(illum, 3 | 5 | 8);
    // Elsewhere Ks is a strength without a unit.
    let is_reflectance = has_highlight && reflects && !is_pbr && program == Program::Unknown;
    let f0 = f0_of(d.given("Ni").map(|ni| ni[0]).filter(|eta| *eta > 1.0).unwrap_or(USUAL_ETA));
    let error = largest(ks.map(|ks| (ks - f0).abs()));
    // Without a diffuse lobe the lesser is lost.
    let is_bare = kd == [0.0; 3] || is_reflectance && largest(kd) <= SHARE.min(error);
    if has_highlight && reflects && !is_pbr && is_bare {
        if largest(kd) > 0.0 {
            let lost = show(largest(kd));
            d.dropped(
                "Kd",
                format!("no diffuse lobe beside the reflection: up to {lost} of the light is lost"),
            );
        }
        d.dropped(
            "Ns",
            "reflections are sharp in this illumination model; highlights of lights are with them",
        );
        if illum == 5 {
            return Some(conductor(d, program, ks, "Ks", false));
        }
        colour_note(d, "Ks", Fate::Exact, "reflectance at every angle");
        d.note(&["Ni"], Fate::Exact, "without Fresnel's equations in this illumination model");
        d.set("reflectance", ks, "Ks");
        return Some(Model::Mirror);
    }
    if is_reflectance && error > SHARE {
        let text = format!(
            "a diffuse surface reflects Fresnel's {} straight on: off by {}, and so it has no equal here",
            show(f0),
            show(error)
        );
        d.refuse(
            Code::NoEqual,
            "Ks",
            text,
            "set Kd to 0 for a mirror (illum 3) or a metal (5), or illum to 2",
        );
        return None;
    }
    opaque(d, program, [kd, ks], has_highlight, coat)
}

/// `d`, or what `Tr` leaves.
fn dissolve(d: &mut Draft) -> Option<f64> {
    match (d.given("d"), d.given("Tr")) {
        (Some([dissolve, ..]), Some([transparency, ..])) => {
            if (1.0 - transparency - dissolve).abs() > 1e-3 {
                let text = "contradicts `d`: the one is 1 less the other";
                d.refuse(Code::Meaningless, "Tr", text, "keep `d`, which is 1 for an opaque material");
                return None;
            }
            Some(dissolve)
        }
        (Some([dissolve, ..]), None) => Some(dissolve),
        (None, Some([transparency, ..])) => Some(1.0 - transparency),
        (None, None) => Some(1.0),
    }
}

/// A colour whose space the format leaves open; `fate` is its own where there is no doubt about that.
fn colour_note(d: &mut Draft, role: &str, fate: Fate, text: impl Into<String>) {
    let Some(colour) = d.given(role) else { return };
    let text = text.into();
    let decoded = colour.map(srgb_to_linear);
    if decoded == colour || d.input(role).is_some_and(|input| input.text.contains("xyz")) {
        d.note(&[role], fate, text);
    } else {
        let decoded = show_colour(decoded);
        d.converted(role, format!("{text}; taken as linear: if the program wrote sRGB, {decoded} was meant"));
    }
}

/// Sets α and the distribution at their paths by the file's Pr or Ns, if there is one.
fn alpha(
    d: &mut Draft,
    program: Program,
    [path, distribution]: [&'static str; 2],
    coat: bool,
) -> Option<f64> {
    let widened = if coat {
        format!("; its highlight is {USUAL_ETA} times as wide above the coat")
    } else {
        String::new()
    };
    if let Some([roughness, ..]) = d.given("Pr") {
        let alpha = roughness * roughness;
        let text = format!("perceptual: α = r² = {} of GGX{widened}", show(alpha));
        d.note(&["Pr"], if coat { Fate::Converted } else { Fate::Exact }, text);
        d.exact("Ns", "Pr is in its place");
        d.set(path, alpha, "Pr");
        d.set(distribution, "ggx", "Pr");
        return Some(alpha);
    }
    let [exponent, ..] = d.given("Ns")?;
    let beckmann = (2.0 / (exponent + 2.0)).sqrt();
    let alpha = match program {
        Program::Blender(scale) if exponent <= scale => {
            let alpha = (1.0 - (exponent / scale).sqrt()).powi(2);
            let text = format!(
                "Blender's Ns = {scale} (1 − r)²: α = r² = {}; an exponent of Blinn and Phong would be {}{widened}",
                show(alpha),
                show(beckmann)
            );
            d.converted("Ns", text);
            d.set(distribution, "ggx", "Ns");
            alpha
        }
        Program::Blender(_) | Program::Unknown => {
            let text = format!(
                "α = √(2 / (Ns + 2)) = {}: the same peak, where the exponent is Blinn and Phong's{widened}",
                show(beckmann)
            );
            d.converted("Ns", text);
            beckmann
        }
    };
    d.set(path, alpha, "Ns");
    Some(alpha)
}

fn transmitting(d: &mut Draft, program: Program, illum: u8, glass: bool, diffuse: f64) -> Option<Model> {
    let eta = index(d)?;
    d.set("eta", eta, "Ni");
    d.exact("Ni", "index of refraction η");
    if diffuse > 0.0 {
        d.dropped("Kd", format!("glass has no diffuse lobe: up to {} of the light is lost", show(diffuse)));
    }
    d.exact("Kd", "nothing of it is left beside what passes");
    d.dropped("Ks", format!("reflects by Fresnel's equations: {} straight on", show(f0_of(eta))));
    let tf = d.given("Tf").unwrap_or([1.0; 3]);
    if !glass {
        d.note(&["d", "Tr"], Fate::Converted, "a sheet passes what it does not reflect");
        d.set("transmission", tf, "Tf");
        colour_note(d, "Tf", Fate::Exact, "multiplies what passes");
        d.note(&["Ns", "Pr"], Fate::Dropped, "a sheet is clear here, as its reflections are in the file");
        return Some(Model::ThinGlass);
    }
    let text = format!("in illum {illum} Tf tells what passes");
    d.note(&["d", "Tr"], Fate::Exact, text);
    d.set("transmission", tf.map(f64::sqrt), "Tf");
    let shown = show_colour(tf.map(f64::sqrt));
    colour_note(
        d,
        "Tf",
        Fate::Exact,
        format!("√Tf = {shown} at every boundary: Tf through a body with two faces"),
    );
    d.set("alpha", 0.0, "Ns");
    // Blender's Ns is of the surface, an exponent of the highlights alone.
    if d.given("Pr").is_some() || program != Program::Unknown {
        alpha(d, program, ["alpha", "distribution"], false);
    }
    d.dropped("Ns", "refraction is sharp in this illumination model; highlights of lights are with it");
    Some(Model::Glass)
}

/// Ni, or what is usual.
fn index(d: &mut Draft) -> Option<f64> {
    let eta = d.given("Ni").map_or(USUAL_ETA, |ni| ni[0]);
    if eta == 0.0 {
        d.refuse(Code::Meaningless, "Ni", "an index of 0 is no surface's", "write 1.5, or leave Ni out");
        return None;
    }
    Some(eta)
}

/// A metal of the given reflectance at 0°.
fn conductor(d: &mut Draft, program: Program, f0: [f64; 3], role: &str, coat: bool) -> Model {
    let fit = metal_like_f82(f0, [1.0; 3], 1.0);
    let scale = if coat { USUAL_ETA } else { 1.0 };
    d.set("eta", fit.eta.map(|eta| eta * scale), role);
    d.set("k", fit.k.map(|k| k * scale), role);
    let text = format!("η and k of Schlick's formula at 0° and 82°; elsewhere {}", fit.error_in_words());
    let (fate, text) = if coat {
        let darker = show(lost_to_coat(f0, USUAL_ETA));
        let text = format!(
            "{text}; below the coat at the refracted angle; darker by up to {darker} by what the coat returns"
        );
        (Fate::Converted, text)
    } else {
        (fit.fate(), text)
    };
    colour_note(d, role, fate, text);
    d.exact("Ni", "η and k follow from the colour of a metal");
    d.dropped("Ks", "a metal's highlight has the colour of the metal");
    d.exact("Kd", "no diffuse reflection");
    let alpha = if role == "Ks" {
        d.set("alpha", 0.0, "Ks");
        Some(0.0)
    } else {
        alpha(d, program, ["alpha", "distribution"], coat)
    };
    let aniso = d.given("aniso").map_or(0.0, |aniso| aniso[0]);
    if aniso > 0.0 && alpha != Some(0.0) {
        // Burley, "Physically based shading at Disney", 2012: αx / αy = 1 / (1 − 0.9 aniso).
        let ratio = 1.0 - 0.9 * aniso;
        d.set("anisotropy", ratio, "aniso");
        d.converted(
            "aniso",
            format!("αy / αx = 1 − 0.9 aniso = {}, Burley's rule; the format has none", show(ratio)),
        );
        if let Some([turns, ..]) = d.given("anisor") {
            // Whole turns change nothing.
            let degrees = 360.0 * (turns % 1.0);
            d.set("rotation_deg", degrees, "anisor");
            let degrees = show(degrees);
            d.converted("anisor", format!("{degrees}°; the format has no unit, this is turns"));
        }
    }
    if coat {
        put_coat(d);
        return Model::CarPaint;
    }
    Model::Metal
}

fn put_coat(d: &mut Draft) {
    let roughness = d.given("Pcr").map_or(0.0, |pcr| pcr[0]);
    d.set("coat.eta", USUAL_ETA, "Pc");
    d.set("coat.alpha", roughness * roughness, "Pcr");
    d.set("coat.distribution", "ggx", "Pcr");
    d.exact("Pcr", format!("perceptual: α = r² = {} of GGX", show(roughness * roughness)));
}

fn opaque(
    d: &mut Draft,
    program: Program,
    [kd, ks]: [[f64; 3]; 2],
    has_highlight: bool,
    coat: bool,
) -> Option<Model> {
    if !has_highlight && !coat {
        d.set("reflectance", kd, "Kd");
        colour_note(d, "Kd", Fate::Exact, "reflectance");
        d.note(&["Ks", "Ns", "Ni", "Pr", "aniso", "anisor"], Fate::Exact, "no highlight");
        return Some(Model::Matte);
    }
    let given = d.given("Ni").map(|ni| ni[0]);
    let mut eta;
    if coat {
        let f0 = f0_of(given.filter(|eta| *eta > 1.0).unwrap_or(USUAL_ETA));
        d.lacks(&["Ni", "Ks", "Ns", "Pr", "aniso", "anisor"], f0, "a highlight below the coat");
        eta = USUAL_ETA;
        put_coat(d);
    } else {
        eta = index(d)?;
        if eta == 1.0 {
            eta = USUAL_ETA;
            let text =
                "1 reflects nothing, and the file has a highlight: η = 1.5, 0.04 of the light straight on";
            d.dropped("Ni", text);
        }
        d.set("coat.eta", eta, "Ni");
        d.exact("Ni", "index of refraction η");
        alpha(d, program, ["coat.alpha", "coat.distribution"], false);
        let f0 = f0_of(eta);
        let mut text =
            format!("the strength of the highlight is Fresnel's: {} straight on, more at an angle", show(f0));
        if d.given("Pr").is_none() && program == Program::Unknown {
            let [error, spread] = [largest(ks.map(|ks| (ks - f0).abs())), largest(ks) - smallest(ks)];
            text = format!("{text}; off by {} if Ks is meant as a reflectance", show(error));
            if spread > 0.0 {
                text = format!("{text}, of which {} of colour", show(spread));
            }
        }
        d.dropped("Ks", text);
        d.note(&["aniso", "anisor"], Fate::Dropped, "plastic is isotropic here: the highlight is round");
    }
    let reflectance = below(kd, eta);
    d.set("reflectance", reflectance, "Kd");
    let shown = show_colour(reflectance);
    let text = format!("{shown} below the interface: the share (1 − F) Kd of the light leaves");
    // The file adds its highlight to Kd and does not take F off.
    colour_note(d, "Kd", Fate::Converted, text);
    Some(Model::Plastic)
}

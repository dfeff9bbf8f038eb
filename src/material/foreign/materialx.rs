//! Flat MaterialX 1.38 and 1.39: `standard_surface`, `open_pbr_surface` and `gltf_pbr` with constant inputs.
//!
//! "MaterialX Specification" 1.39, D. Smythe, J. Stone et al., <https://materialx.org/Specification.html>.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use roxmltree::{Document, Node, ParsingOptions};

use super::shader::{Shader, translate};
use super::{Draft, Fate, Imported, Input, Kind, quoted, show_colour};
use crate::message::{Code, Finding};
use crate::parameter::did_you_mean;
use crate::rgb::srgb_to_linear;

/// What a file of constants stays far below. The reader compares each attribute with the others of its
/// element and carries namespaces from element to element, so that their numbers must be small.
const BYTES: usize = 4 << 20;
const NODES: u32 = 1 << 16;
const ATTRIBUTES: usize = 256;
const NAMESPACES: usize = 64;

/// The materials of a MaterialX file, and what is wrong with those that are not among them.
///
/// A material is a `surfacematerial` with its shader, or a shader that no material names. Colours are taken
/// as linear Rec. 709 unless a `colorspace` is in force: `srgb_texture`, `g18_rec709`, `g22_rec709`,
/// `rec709_display` (exponent 2.4), `acescg` and `lin_ap1` (to the white of D65 by Bradford's transform),
/// `g22_ap1`, `adobergb`, `lin_adobergb`, `srgb_displayp3`, `lin_displayp3`. Colours outside of the gamut of
/// Rec. 709 are refused.
pub fn materialx(text: &str) -> (Vec<Imported>, Vec<Finding>) {
    let document = match parse(text) {
        Ok(document) => document,
        Err(finding) => return (Vec::new(), vec![finding]),
    };
    let (mut materials, mut findings) = (Vec::new(), Vec::new());
    let mut reader = Reader::new(document.root_element());
    for node in reader.root.children().filter(Node::is_element) {
        match reader.material(node) {
            None => {}
            Some(Ok(material)) => materials.push(material),
            Some(Err(refused)) => findings.extend(refused),
        }
    }
    if materials.is_empty() && findings.is_empty() {
        let shaders = Shader::ALL.map(|shader| shader.element()).join(", ");
        let text = format!("no material in the file; expected a surfacematerial or one of {shaders}");
        findings.push(Finding::of_file(Code::ForeignSyntax, text));
    }
    (materials, findings)
}

/// The file as a tree, if it is MaterialX of a version that is read.
fn parse(text: &str) -> Result<Document<'_>, Finding> {
    let large =
        |what: String| Finding::of_file(Code::ForeignSyntax, format!("the file has more than {what}"));
    if text.len() > BYTES {
        return Err(large(format!("{BYTES} bytes")));
    }
    // `=` before a quote: an attribute, or text that looks like one.
    let is_attribute = |rest: &&str| rest.trim_start().starts_with(['"', '\'']);
    let attributes = |element: &str| element.split('=').skip(1).filter(is_attribute).count();
    if text.split('<').any(|element| attributes(element) > ATTRIBUTES) {
        return Err(large(format!("{ATTRIBUTES} attributes in one element")));
    }
    if text.matches("xmlns").count() > NAMESPACES {
        return Err(large(format!("{NAMESPACES} namespaces")));
    }
    let options = ParsingOptions { allow_dtd: false, nodes_limit: NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let message = match &error {
            roxmltree::Error::NodesLimitReached => return large(format!("{NODES} nodes")),
            roxmltree::Error::DtdDetected => "a document type declaration is not read".to_owned(),
            error => quoted(&error.to_string()),
        };
        let place = offset(text, error.pos());
        let length = text[place..].chars().next().map_or(0, char::len_utf8);
        Finding::at(Code::ForeignSyntax, place..place + length, format!("not XML: {message}"))
    })?;
    let root = document.root_element();
    let tag = root.tag_name().name();
    if tag != "materialx" {
        let text = format!("the root is `{}`; expected `materialx`", quoted(tag));
        return Err(Finding::at(Code::ForeignSyntax, heading(root), text));
    }
    let Some(version) = root.attribute_node("version") else {
        let text = "`materialx` has no version; expected version=\"1.38\" or \"1.39\"";
        return Err(Finding::at(Code::ForeignSyntax, heading(root), text));
    };
    let mut numbers = version.value().split('.');
    if !matches!((numbers.next(), numbers.next()), (Some("1"), Some("38" | "39"))) {
        let text = format!("MaterialX {} is not read; expected 1.38 or 1.39", quoted(version.value()));
        let help =
            "the MaterialX library upgrades older files: open the file in one of its tools and save it";
        return Err(Finding::at(Code::Meaningless, version.range_value(), text).help(help));
    }
    Ok(document)
}

/// The byte at a line and a column of characters, both from 1.
fn offset(text: &str, position: roxmltree::TextPos) -> usize {
    let line = text.split_inclusive('\n').take((position.row as usize).saturating_sub(1));
    let start = line.map(str::len).sum::<usize>();
    let column = (position.col as usize).saturating_sub(1);
    text[start..].char_indices().nth(column).map_or(text.len(), |(byte, _)| start + byte)
}

/// `<name` of an element.
fn heading(node: Node<'_, '_>) -> Range<usize> {
    let Range { start, end } = node.range();
    let text = &node.document().input_text()[start..end];
    let length = text.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(text.len());
    start..start + length
}

fn name<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute("name").unwrap_or_default()
}

struct Reader<'a, 'input> {
    root: Node<'a, 'input>,
    named: BTreeMap<&'a str, Node<'a, 'input>>,
    /// Shaders that belong to a material.
    owned: BTreeSet<usize>,
    /// Names of materials so far.
    taken: BTreeSet<String>,
}

impl<'a, 'input> Reader<'a, 'input> {
    fn new(root: Node<'a, 'input>) -> Self {
        let elements = || root.children().filter(Node::is_element);
        let named: BTreeMap<_, _> = elements().map(|node| (name(node), node)).collect();
        let materials = elements().filter(|node| node.has_tag_name("surfacematerial"));
        let inputs = materials.flat_map(|material| material.children());
        let shaders = inputs.filter_map(|input| named.get(input.attribute("nodename")?));
        let owned = shaders.map(|shader| shader.id().get_usize()).collect();
        Self { root, named, owned, taken: BTreeSet::new() }
    }

    /// What an element of the document is: nothing of ours, a material, or one that is refused.
    fn material(&mut self, node: Node<'a, 'input>) -> Option<Result<Imported, Vec<Finding>>> {
        let is_material = |node: Node<'_, '_>| node.has_tag_name("surfacematerial");
        let is_shader = |node: Node<'_, '_>| node.attribute("type") == Some("surfaceshader");
        let known = |node: Node<'_, '_>| Shader::of_element(node.tag_name().name());
        if is_material(node) {
            return Some(self.of_surfacematerial(node));
        }
        if node.has_tag_name("nodegraph") {
            let inner = node.descendants().find(|&inner| is_material(inner) || known(inner).is_some())?;
            let text = format!("`{}` stands in a node graph, which is not read", quoted(name(inner)));
            let finding = Finding::at(Code::NotConstant, heading(inner), text);
            return Some(Err(vec![finding.help("move the shader out of the graph, with constant inputs")]));
        }
        if self.owned.contains(&node.id().get_usize()) || !(known(node).is_some() || is_shader(node)) {
            return None;
        }
        let draft = Draft::new(name(node).to_owned(), heading(node), Vec::new());
        Some(self.of_shader(node, draft))
    }

    fn of_surfacematerial(&mut self, node: Node<'a, 'input>) -> Result<Imported, Vec<Finding>> {
        let mut draft = Draft::new(name(node).to_owned(), heading(node), Vec::new());
        let mut shader = None;
        for input in node.children().filter(|node| node.has_tag_name("input")) {
            let span = input.range();
            match name(input) {
                "surfaceshader" if shader.is_none() => shader = Some(input),
                "displacementshader" | "backsurfaceshader" | "volumeshader" => {
                    let text = "displacement, back side and volume are not of the material of a front side";
                    draft.push(Input {
                        role: "",
                        text: quoted(name(input)),
                        span,
                        value: [0.0; 3],
                        is_default: false,
                        fate: Some((Fate::Dropped, text.to_owned())),
                    });
                }
                other => {
                    let text =
                        format!("`{}` is no input of a surfacematerial, or stands twice", quoted(other));
                    draft.findings.push(Finding::at(Code::Meaningless, span, text));
                }
            }
        }
        let Some(input) = shader else {
            let text = format!("the material `{}` has no surfaceshader", quoted(&draft.name));
            draft.findings.push(Finding::at(Code::ForeignSyntax, draft.span.clone(), text));
            return Err(draft.findings);
        };
        let is_direct = ["nodegraph", "interfacename"].iter().all(|key| input.attribute(*key).is_none());
        let shader = input.attribute("nodename").filter(|_| is_direct).and_then(|name| self.named.get(name));
        let Some(&shader) = shader else {
            let text = format!("the shader of `{}` is not a node of this file", quoted(&draft.name));
            let finding = Finding::at(Code::NotConstant, input.range(), text);
            draft.findings.push(finding.help("name a shader beside the material by `nodename`"));
            return Err(draft.findings);
        };
        self.of_shader(shader, draft)
    }

    fn of_shader(&mut self, node: Node<'a, 'input>, mut draft: Draft) -> Result<Imported, Vec<Finding>> {
        let element = node.tag_name().name();
        let Some(shader) = Shader::of_element(element) else {
            let known = Shader::ALL.map(|shader| shader.element()).join(", ");
            let text = format!("the shader `{}` is not read; expected {known}", quoted(element));
            let help = "the MaterialX library translates shaders into each other";
            draft.findings.push(Finding::at(Code::NoEqual, heading(node), text).help(help));
            return Err(draft.findings);
        };
        if draft.name.trim().is_empty() {
            let text = "a material without a name";
            draft.findings.push(Finding::at(Code::ForeignSyntax, draft.span.clone(), text));
        } else if !self.taken.insert(draft.name.clone()) {
            let text = format!("a second material of the name `{}`", quoted(&draft.name));
            draft.findings.push(Finding::at(Code::Meaningless, draft.span.clone(), text));
        }
        draft.keys = shader.keys(node.attribute("version"));
        for input in node.children().filter(|node| node.has_tag_name("input")) {
            match read(input, &draft) {
                Ok(input) => draft.push(input),
                Err(finding) => draft.findings.push(finding),
            }
        }
        translate(shader, draft)
    }
}

/// An input with a constant value.
fn read(node: Node<'_, '_>, draft: &Draft) -> Result<Input, Finding> {
    let (span, name) = (node.range(), name(node));
    let shown = quoted(name);
    let material = quoted(&draft.name);
    let Some(key) = draft.keys.iter().find(|key| key.name == name && !name.is_empty()) else {
        let hint =
            did_you_mean(&shown, draft.keys.iter().map(|key| key.name).filter(|name| !name.is_empty()));
        let text = format!("`{shown}` of `{material}` is no input of the shader{hint}");
        return Err(Finding::at(Code::Meaningless, span, text));
    };
    if draft.input(key.role).is_some() {
        let text = format!("`{shown}` of `{material}` is given twice");
        return Err(Finding::at(Code::Meaningless, span, text));
    }
    let connection = ["nodename", "nodegraph", "output", "interfacename"];
    let connection = connection.into_iter().find(|attribute| node.has_attribute(*attribute));
    let is_file = node.attribute("type") == Some("filename");
    if connection.is_some() || is_file {
        let from = connection.unwrap_or("a file");
        let text = format!("`{shown}` of `{material}` is no constant: it comes by {from}");
        let finding = Finding::at(Code::NotConstant, span, text).label("connected here");
        return Err(finding.help(format!("bake a constant: `{shown}` with a value=\"…\" and no connection")));
    }
    let Some(value) = node.attribute_node("value") else {
        if key.kind == Kind::Vector && node.has_attribute("defaultgeomprop") {
            let fate = Some((Fate::Exact, "the geometry's, as here".to_owned()));
            let text = shown;
            return Ok(Input { role: key.role, text, span, value: [0.0; 3], is_default: true, fate });
        }
        let text = format!("`{shown}` of `{material}` has no value");
        return Err(Finding::at(Code::ForeignSyntax, span, text));
    };
    let malformed = || {
        let what = match key.kind {
            Kind::Flag => "true or false",
            kind if kind.len() == 3 => "three numbers with commas between them",
            _ => "a number",
        };
        let text = format!("`{shown}` of `{material}` is `{}`; expected {what}", quoted(value.value()));
        Finding::at(Code::ForeignSyntax, value.range_value(), text)
    };
    let numbers: Vec<f64> = match (key.kind, value.value().trim()) {
        (Kind::Flag, "true") => vec![1.0],
        (Kind::Flag, "false") => vec![0.0],
        (Kind::Flag, _) => return Err(malformed()),
        (_, text) => {
            let numbers: Result<_, _> = text.split(',').map(|number| number.trim().parse()).collect();
            numbers.map_err(|_| malformed())?
        }
    };
    let stored = match numbers[..] {
        [number] if key.kind.len() == 1 => [number; 3],
        [x, y, z] if key.kind.len() == 3 => [x, y, z],
        _ => return Err(malformed()),
    };
    let mut text = format!("{shown} = {}", quoted(value.value()));
    let mut linear = stored;
    let mut decoded = String::new();
    let space = node.ancestors().find_map(|node| node.attribute_node("colorspace"));
    if let Some(space) = space.filter(|_| key.kind.is_colour()) {
        linear = to_linear_rec709(space.value(), stored).ok_or_else(|| {
            let hint = did_you_mean(&quoted(space.value()), SPACES.iter().map(|(name, ..)| *name));
            let text = format!("the colour space `{}` is not known{hint}", quoted(space.value()));
            let help = "give the colour in lin_rec709 or srgb_texture";
            Finding::at(Code::Meaningless, space.range_value(), text).help(help)
        })?;
        if linear != stored {
            text = format!("{text} ({})", space.value());
            decoded = format!(", in linear Rec. 709 {}", show_colour(linear));
        }
    }
    if let Some(unit) = node.attribute("unit") {
        text = format!("{text} {}", quoted(unit));
    }
    if let Some(expected) = key.kind.refuses(linear) {
        let message = format!("`{text}` of `{material}`{decoded} is out of range: {expected}");
        return Err(Finding::at(Code::Meaningless, span, message));
    }
    Ok(Input { role: key.role, text, span, value: linear, is_default: linear == key.default, fate: None })
}

/// How stored values become linear.
#[derive(Clone, Copy)]
enum Transfer {
    Linear,
    Srgb,
    Power(f64),
}

/// Linear AP1 at the white of ACES to linear Rec. 709 at D65, by Bradford's transform; the derivation of RP
/// 177 with the chromaticities of Academy S-2014-004 (ACEScg).
const FROM_AP1: [[f64; 3]; 3] = [
    [1.705_050_992_657_983, -0.621_792_120_657_005, -0.083_258_872_000_979],
    [-0.130_256_417_507_043, 1.140_804_736_575_402, -0.010_548_319_068_358],
    [-0.024_003_356_804_618, -0.128_968_976_064_971, 1.152_972_332_869_589],
];
/// Linear Display P3 to linear Rec. 709, both at D65.
const FROM_P3: [[f64; 3]; 3] = [
    [1.224_940_176_280_56, -0.224_940_176_280_56, 0.0],
    [-0.042_056_954_709_688, 1.042_056_954_709_688, 0.0],
    [-0.019_637_554_590_334, -0.078_636_045_550_632, 1.098_273_600_140_966],
];
/// Linear Adobe RGB (1998) to linear Rec. 709, both at D65.
const FROM_ADOBE: [[f64; 3]; 3] = [
    [1.398_355_743_960_778, -0.398_355_743_960_778, 0.0],
    [0.0, 1.0, 0.0],
    [0.0, -0.042_928_989_294_473, 1.042_928_989_294_473],
];

/// The colour spaces of the specification and of the MaterialX library, with older names for the same.
const SPACES: [(&str, Transfer, Option<[[f64; 3]; 3]>); 16] = [
    ("lin_rec709", Transfer::Linear, None),
    ("none", Transfer::Linear, None),
    ("srgb_texture", Transfer::Srgb, None),
    ("g18_rec709", Transfer::Power(1.8), None),
    ("gamma18", Transfer::Power(1.8), None),
    ("g22_rec709", Transfer::Power(2.2), None),
    ("gamma22", Transfer::Power(2.2), None),
    ("rec709_display", Transfer::Power(2.4), None),
    ("gamma24", Transfer::Power(2.4), None),
    ("acescg", Transfer::Linear, Some(FROM_AP1)),
    ("lin_ap1", Transfer::Linear, Some(FROM_AP1)),
    ("g22_ap1", Transfer::Power(2.2), Some(FROM_AP1)),
    ("lin_displayp3", Transfer::Linear, Some(FROM_P3)),
    ("srgb_displayp3", Transfer::Srgb, Some(FROM_P3)),
    ("lin_adobergb", Transfer::Linear, Some(FROM_ADOBE)),
    ("adobergb", Transfer::Power(563.0 / 256.0), Some(FROM_ADOBE)),
];

/// A colour of a space in linear Rec. 709; `None` if the space is not known.
fn to_linear_rec709(space: &str, stored: [f64; 3]) -> Option<[f64; 3]> {
    let (_, transfer, matrix) = SPACES.iter().find(|(name, ..)| *name == space)?;
    let linear = stored.map(|value| match transfer {
        Transfer::Linear => value,
        Transfer::Srgb => srgb_to_linear(value),
        Transfer::Power(exponent) => value.powf(*exponent),
    });
    let Some(matrix) = matrix else { return Some(linear) };
    let row = |row: [f64; 3]| row[0] * linear[0] + row[1] * linear[1] + row[2] * linear[2];
    // The rows add up to 1 but for rounding, and white is white.
    let exact = |value: f64| if (value - value.round()).abs() < 1e-12 { value.round() } else { value };
    Some(matrix.map(row).map(exact))
}

//! From the tree of a file to its materials: everything that is wrong is reported, what is right is kept.

use std::ops::Range;
use std::path::Path;

use super::colour::ColourSpace;
use super::syntax::{self, Content, Node};
use super::{Allowance, Document, Entry, Place, Places, Syntax, VERSION};
use crate::ior::{IorError, builtin};
use crate::material::{
    Description, MaterialError, Model, Parameter, ParameterKind, Profile, Value, flattened,
};
use crate::message::{Code, Finding, Severity};
use crate::parameter::{did_you_mean, figure};

/// What `roughness` means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Roughness {
    Alpha,
    Perceptual,
}

/// α by a name that needs a declaration.
pub(super) const ROUGHNESS: &str = "roughness";

/// What it may be declared to mean.
pub(super) const ROUGHNESSES: [&str; 2] = ["alpha", "perceptual"];

/// Units that a key may end in, with what an angle in them is in radians.
const UNITS: [(&str, Option<f64>); 8] = [
    ("rad", Some(1.0)),
    ("deg", Some(core::f64::consts::PI / 180.0)),
    ("nm", None),
    ("um", None),
    ("mm", None),
    ("cm", None),
    ("m", None),
    ("in", None),
];

/// What a file says, and everything that is wrong with it; a material with errors is left out. Paths of data sets
/// are relative to `folder`.
pub fn read(text: &str, syntax: Syntax, folder: &Path) -> (Document, Vec<Finding>) {
    let (document, _, mut findings) = read_beside(&[], text, syntax, folder);
    findings.sort_by_key(|finding| finding.span.as_ref().map_or(0, |span| span.start));
    (document, findings)
}

/// The same of a file in which tables of other names stand beside those of materials, and its tree.
pub(crate) fn read_beside(
    others: &[&'static str],
    text: &str,
    syntax: Syntax,
    folder: &Path,
) -> (Document, Node, Vec<Finding>) {
    let (root, findings) = syntax::parse(text, syntax);
    let broken = syntax::broken(text, syntax, &findings);
    let (undeclared, refusals) = ([false; 2], 0);
    let mut reader =
        Reader { folder, others, broken, findings, colour: None, roughness: None, undeclared, refusals };
    let document = reader.document(&root);
    (document, root, reader.findings)
}

struct Reader<'a> {
    folder: &'a Path,
    /// Tables and keys that are somebody else's.
    others: &'a [&'static str],
    /// Parts of the file that are not judged: their syntax is wrong already.
    broken: Vec<Range<usize>>,
    findings: Vec<Finding>,
    colour: Option<ColourSpace>,
    roughness: Option<Roughness>,
    /// Whether a missing declaration of colour and of roughness has been reported: once is enough.
    undeclared: [bool; 2],
    /// How often something was refused, told or not: what a missing declaration leaves without meaning is told once.
    refusals: usize,
}

/// What a key of a material means.
enum Key {
    /// A parameter, with the factor from the unit of the key to that of the parameter.
    Parameter(&'static Parameter, f64),
    /// α by another name.
    Roughness(&'static Parameter),
}

/// What a material gives a parameter, and where.
struct Given {
    path: String,
    value: Value,
    span: Range<usize>,
}

impl Reader<'_> {
    fn report(&mut self, finding: Finding) {
        self.refusals += usize::from(finding.code.severity() == Severity::Error);
        self.findings.push(finding);
    }

    /// Refuses what needs a declaration that is missing, and tells so the first time.
    fn refuse_undeclared(&mut self, which: usize, finding: Finding) {
        if std::mem::replace(&mut self.undeclared[which], true) {
            self.refusals += 1;
        } else {
            self.report(finding.label("not declared which"));
        }
    }

    /// Whether something stands where the syntax is broken.
    fn is_broken(&self, span: &Range<usize>) -> bool {
        // They are in order and apart.
        let after = self.broken.partition_point(|broken| broken.end <= span.start);
        self.broken.get(after).is_some_and(|broken| broken.start < span.end.max(span.start + 1))
    }

    fn document(&mut self, root: &Node) -> Document {
        let mut document = Document { folder: self.folder.to_owned(), ..Document::default() };
        let entries = root.table().unwrap_or_default();
        if root.table().is_none() {
            let text = format!("a material file is a table, not {}", root.kind());
            self.report(Finding::at(Code::WrongType, root.span.clone(), text));
        }
        match entries.iter().find(|entry| entry.key == "gonio") {
            Some(header) if !self.is_broken(&header.span) => document.profile = self.header(&header.value),
            None if self.broken.is_empty() => self.report(
                Finding::of_file(Code::Missing, "there is no table `gonio`")
                    .help("begin with\n[gonio]\nversion = 1\ncolor = \"lin_rec709\""),
            ),
            // What it declares is not known.
            _ => self.undeclared = [true; 2],
        }
        for entry in entries {
            match (entry.key.as_str(), entry.value.table()) {
                // Where editors look for the schema.
                ("gonio" | "$schema", _) => {}
                ("material", Some(materials)) => {
                    for material in materials {
                        let read = self.material(&material.key, &material.span, &material.value);
                        document.materials.extend(read);
                    }
                }
                ("material", None) if !self.is_broken(&entry.span) => {
                    let text = format!("`material` holds tables, not {}", entry.value.kind());
                    let finding = Finding::at(Code::WrongType, entry.value.span.clone(), text);
                    self.report(finding.help("[material.NAME] begins a material"));
                }
                _ if self.is_broken(&entry.span) => {}
                (key, _) if self.others.contains(&key) => {}
                (key, _) => {
                    let known = ["gonio", "material"].into_iter().chain(self.others.iter().copied());
                    let hint = did_you_mean(key, known);
                    let text = format!("unknown table or key `{key}`{hint}");
                    let finding = Finding::at(Code::UnknownKey, entry.span.clone(), text);
                    let others: String = self.others.iter().map(|other| format!(", {other}")).collect();
                    self.report(finding.help(format!("a file has [gonio] and [material.NAME]{others}")));
                }
            }
        }
        document
    }

    /// Conventions of the file; the profile is all that outlives it.
    fn header(&mut self, node: &Node) -> Profile {
        const KEYS: [&str; 4] = ["version", "color", "roughness", "profile"];
        let mut profile = Profile::default();
        let Some(entries) = node.table() else {
            let text = format!("`gonio` is a table, not {}", node.kind());
            self.report(Finding::at(Code::WrongType, node.span.clone(), text));
            return profile;
        };
        if !entries.iter().any(|entry| entry.key == "version") {
            let finding = Finding::at(Code::Missing, node.span.clone(), "there is no `version`");
            self.report(finding.help("version = 1"));
        }
        for entry in entries {
            let (key, value) = (entry.key.as_str(), &entry.value);
            match (key, &value.content) {
                ("version", &Content::Number(VERSION)) => {}
                ("version", &Content::Number(version)) => self.report(
                    Finding::at(
                        Code::OutOfRange,
                        value.span.clone(),
                        format!("version {version} is unknown"),
                    )
                    .label("this gonio reads version 1"),
                ),
                ("color", Content::Text(name)) => {
                    let names = ColourSpace::ALL.map(ColourSpace::name);
                    self.colour = self.named(&names, value, name, ColourSpace::named);
                    // What is wrong here is no reason to complain there.
                    self.undeclared[0] |= self.colour.is_none();
                }
                ("roughness", Content::Text(name)) => {
                    self.roughness = self.named(&ROUGHNESSES, value, name, |name| match name {
                        "alpha" => Some(Roughness::Alpha),
                        "perceptual" => Some(Roughness::Perceptual),
                        _ => None,
                    });
                    self.undeclared[1] |= self.roughness.is_none();
                }
                ("profile", Content::Text(name)) => {
                    let names: Vec<_> = Profile::ALL.iter().map(|profile| profile.name()).collect();
                    profile = self.named(&names, value, name, Profile::named).unwrap_or_default();
                }
                (known, _) if KEYS.contains(&known) => {
                    let text = format!("`{known}` cannot be {}", value.kind());
                    let wanted = if known == "version" { "a number" } else { "a text" };
                    let finding = Finding::at(Code::WrongType, value.span.clone(), text);
                    self.report(finding.label(format!("expected {wanted}")));
                    self.undeclared[0] |= known == "color";
                    self.undeclared[1] |= known == "roughness";
                }
                _ => self.unknown_key(&entry.span, key, "[gonio]", KEYS.into_iter()),
            }
        }
        profile
    }

    /// What one of a few names means; a finding where it is none of them.
    fn named<T>(
        &mut self,
        names: &[&str],
        node: &Node,
        name: &str,
        meaning: impl Fn(&str) -> Option<T>,
    ) -> Option<T> {
        let found = meaning(name);
        if found.is_none() {
            let hint = did_you_mean(name, names.iter().copied());
            let text = format!("unknown name \"{name}\"{hint}");
            let finding = Finding::at(Code::UnknownName, node.span.clone(), text);
            self.report(finding.label(format!("expected one of {}", names.join(", "))));
        }
        found
    }

    fn unknown_key<'k>(
        &mut self,
        span: &Range<usize>,
        key: &str,
        place: &str,
        known: impl Iterator<Item = &'k str>,
    ) {
        let known: Vec<_> = known.collect();
        let hint = did_you_mean(key, known.iter().copied());
        let finding = Finding::at(Code::UnknownKey, span.clone(), format!("unknown key `{key}`{hint}"))
            .label(format!("not a key of {place}"))
            .help(format!("{place} takes: {}", known.join(" · ")));
        self.report(finding);
    }

    fn material(&mut self, name: &str, span: &Range<usize>, node: &Node) -> Option<Entry> {
        if self.is_broken(span) || self.holds_broken(node) {
            return None;
        }
        let before = self.refusals;
        // It becomes the name of a specimen and of a file.
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "_-.".contains(c);
        if name.is_empty() || name.starts_with('.') || !name.chars().all(is_plain) {
            let text = format!("`{}` is no name of a material", name.escape_debug());
            let finding = Finding::at(Code::OutOfRange, span.clone(), text);
            self.report(finding.help("letters, digits, _, - and dots, which do not come first"));
        }
        let Some(entries) = node.table() else {
            let text = format!("material `{name}` is a table, not {}", node.kind());
            self.report(Finding::at(Code::WrongType, node.span.clone(), text));
            return None;
        };
        let model = match entries.iter().find(|entry| entry.key == "model") {
            Some(entry) => self.model(&entry.value),
            None => {
                let models: Vec<_> = Model::ALL.iter().map(|model| model.name()).collect();
                let finding = Finding::at(Code::Missing, span.clone(), format!("`{name}` has no `model`"))
                    .help(format!("model = one of {}", models.join(", ")));
                self.report(finding);
                None
            }
        };
        let mut allowed = Vec::new();
        for entry in entries.iter().filter(|entry| entry.key == "allow") {
            self.allowances(&entry.value, &mut allowed);
        }
        // Without a model nothing can be said of the rest.
        let model = model?;
        let of_parameters: Vec<_> =
            entries.iter().filter(|entry| !["model", "allow"].contains(&entry.key.as_str())).collect();
        let mut given = Vec::new();
        for entry in of_parameters {
            self.parameter(model, model.parameters(), "", entry, &mut given);
        }
        let values = given.iter().map(|given| (given.path.as_str(), given.value.clone()));
        let (description, mut problems) = Description::examined(model, values);
        let parameters = given.iter().map(|given| (given.path.clone(), given.span.clone())).collect();
        let places = Places { name: span.clone(), parameters };
        // What was refused is not missing, and its default contradicts nothing.
        if self.refusals == before && problems.is_empty() {
            problems = description.contradictions();
        }
        for problem in &problems {
            self.report(places.finding(problem));
        }
        let is_sound = self.refusals == before;
        is_sound.then_some(Entry { name: name.to_owned(), description, allowed, places })
    }

    fn holds_broken(&self, node: &Node) -> bool {
        let is_broken =
            |entry: &syntax::Entry| self.is_broken(&entry.span) || self.holds_broken(&entry.value);
        self.is_broken(&node.span) || node.table().is_some_and(|entries| entries.iter().any(is_broken))
    }

    fn model(&mut self, node: &Node) -> Option<Model> {
        let Content::Text(name) = &node.content else {
            let text = format!("`model` is a name, not {}", node.kind());
            self.report(Finding::at(Code::WrongType, node.span.clone(), text));
            return None;
        };
        let names: Vec<_> = Model::ALL.iter().map(|model| model.name()).collect();
        self.named(&names, node, name, |name| Model::named(name).ok())
    }

    /// `allow.CODE.PARAMETER = "reason"`.
    fn allowances(&mut self, node: &Node, allowed: &mut Vec<Allowance>) {
        const EXAMPLE: &str = "allow.G301.alpha = \"why it is meant\"";
        let wrong =
            |node: &Node, text: &str| Finding::at(Code::WrongType, node.span.clone(), text).help(EXAMPLE);
        let Some(codes) = node.table() else {
            return self.report(wrong(node, &format!("`allow` cannot be {}", node.kind())));
        };
        for entry in codes {
            let Some(code) = Code::named(&entry.key).filter(|code| code.severity() == Severity::Warning)
            else {
                let text = format!("`{}` cannot be allowed", entry.key);
                let finding = Finding::at(Code::UnknownName, entry.span.clone(), text);
                self.report(finding.label("not the code of a warning"));
                continue;
            };
            if entry.value.table().is_none() {
                self.report(wrong(&entry.value, "an allowance names the parameter that it is about"));
                continue;
            }
            // `coat.alpha` may be written as one key or as two.
            let mut pending: Vec<(String, &Range<usize>, &Node)> =
                vec![(String::new(), &entry.span, &entry.value)];
            while let Some((path, span, node)) = pending.pop() {
                match &node.content {
                    Content::Table(entries) => {
                        pending.extend(
                            entries
                                .iter()
                                .rev()
                                .map(|entry| (join(&path, &entry.key), &entry.span, &entry.value)),
                        );
                    }
                    Content::Text(reason) if !reason.trim().is_empty() => {
                        if allowed.iter().any(|other| other.code == code && other.path == path) {
                            let text = format!("{code} of `{path}` is allowed twice");
                            let finding = Finding::at(Code::Twice, span.clone(), text);
                            self.report(finding.label("here it is allowed again").help("keep one of them"));
                        } else {
                            let (reason, place) = (reason.clone(), Place(span.clone()));
                            allowed.push(Allowance { code, path, reason, place });
                        }
                    }
                    _ => self.report(wrong(node, "an allowance needs a reason")),
                }
            }
        }
    }

    /// Reads one key of a material or of a group of its parameters.
    fn parameter(
        &mut self,
        model: Model,
        table: &'static [Parameter],
        group: &str,
        entry: &syntax::Entry,
        given: &mut Vec<Given>,
    ) {
        let Some(key) = self.key(model, table, group, entry) else { return };
        let (Key::Parameter(parameter, _) | Key::Roughness(parameter)) = key;
        let path = join(group, parameter.id);
        if let ParameterKind::Group { parameters } = parameter.kind {
            match entry.value.table() {
                Some(members) => {
                    for member in members {
                        self.parameter(model, parameters, &path, member, given);
                    }
                }
                None => self.wrong_type(parameter, &entry.value),
            }
            return;
        }
        if given.iter().any(|other| other.path == path) {
            let text = format!("`{}` says again what `{path}` is", entry.key);
            let finding = Finding::at(Code::Twice, entry.span.clone(), text);
            return self.report(finding.label("here it is given again").help("keep one of them"));
        }
        let value = match key {
            Key::Roughness(parameter) => self.alpha_of(parameter, entry),
            Key::Parameter(parameter, 1.0) => self.value(parameter, &entry.value),
            Key::Parameter(parameter, factor) => self.in_unit(parameter, factor, entry),
        };
        if let Some(value) = value {
            given.push(Given { path, value, span: entry.value.span.clone() });
        }
    }

    /// What a key means, if it means anything.
    fn key(
        &mut self,
        model: Model,
        table: &'static [Parameter],
        group: &str,
        entry: &syntax::Entry,
    ) -> Option<Key> {
        let key = entry.key.as_str();
        let spelled = table.iter().find_map(|parameter| {
            let (_, factor) = spellings(parameter).into_iter().find(|(spelling, _)| spelling == key)?;
            Some(if key == ROUGHNESS { Key::Roughness(parameter) } else { Key::Parameter(parameter, factor) })
        });
        if spelled.is_some() {
            return spelled;
        }
        let (stem, unit) = in_parts(key);
        let Some(parameter) = table.iter().find(|parameter| in_parts(parameter.id).0 == stem) else {
            let place = match group {
                "" => format!("model `{}`", model.name()),
                group => format!("`{group}` of model `{}`", model.name()),
            };
            let known: Vec<String> = table.iter().flat_map(spellings).map(|(spelling, _)| spelling).collect();
            self.unknown_key(&entry.span, key, &place, known.iter().map(String::as_str));
            if let (Some(elsewhere), Some(finding)) = (elsewhere(model, group, key), self.findings.last_mut())
            {
                finding.help.push(elsewhere);
            }
            return None;
        };
        let text = match unit {
            Some(unit) => format!("`{key}`: {stem} is not in {unit}"),
            None => format!("`{key}` does not say its unit"),
        };
        let known: Vec<String> = spellings(parameter).into_iter().map(|(spelling, _)| spelling).collect();
        let finding = Finding::at(Code::WrongUnit, entry.span.clone(), text);
        self.report(finding.label(format!("write {}", known.join(" or "))).help(parameter.doc));
        None
    }

    /// A number that is given in another unit than the parameter's, which is `factor` times as large.
    fn in_unit(&mut self, parameter: &Parameter, factor: f64, entry: &syntax::Entry) -> Option<Value> {
        let Value::Number(number) = self.value(parameter, &entry.value)? else { return None };
        let ParameterKind::Number { range } = parameter.kind else { return None };
        let range = range.map(|bound| bound / factor);
        if number >= range[0] && number <= range[1] {
            return Some(Value::Number(number * factor));
        }
        let text = format!("{} = {number} is out of range", entry.key);
        let finding = Finding::at(Code::OutOfRange, entry.value.span.clone(), text);
        self.report(finding.label(format!("expected a number in [{}]", range.map(figure).join(", "))));
        None
    }

    /// α that a roughness means.
    fn alpha_of(&mut self, parameter: &Parameter, entry: &syntax::Entry) -> Option<Value> {
        let convention = match self.roughness {
            Some(convention) => convention,
            None => {
                let text = "`roughness` is α to some and √α to others";
                let finding = Finding::at(Code::Undeclared, entry.span.clone(), text)
                    .help("write `alpha`, which needs no declaration")
                    .help("or declare under [gonio]: roughness = \"alpha\", or \"perceptual\" for α = roughness²");
                self.refuse_undeclared(1, finding);
                return None;
            }
        };
        let Content::Number(roughness) = entry.value.content else {
            self.wrong_type(parameter, &entry.value);
            return None;
        };
        if convention == Roughness::Alpha {
            return Some(Value::Number(roughness));
        }
        if (0.0..=1.0).contains(&roughness) {
            return Some(Value::Number(roughness * roughness));
        }
        let text = format!("roughness = {roughness} is out of range");
        let finding = Finding::at(Code::OutOfRange, entry.value.span.clone(), text);
        self.report(finding.label("expected a number in [0, 1]"));
        None
    }

    fn wrong_type(&mut self, parameter: &Parameter, node: &Node) {
        let is_number = |node: &&Node| matches!(node.content, Content::Number(_));
        let count = match &node.content {
            Content::List(nodes) => match nodes.iter().find(|node| !is_number(node)) {
                Some(other) => format!(" with {} in it", other.kind()),
                None => format!(" of {}", nodes.len()),
            },
            _ => String::new(),
        };
        let text = format!("`{}` cannot be {}{count}", parameter.id, node.kind());
        let finding = Finding::at(Code::WrongType, node.span.clone(), text);
        self.report(finding.label(format!("expected {}", parameter.expected())));
    }

    /// The value that stands there, if it is of the kind that the parameter takes.
    fn value(&mut self, parameter: &Parameter, node: &Node) -> Option<Value> {
        let value = match (parameter.kind, &node.content) {
            (ParameterKind::Colour, _) => return self.colour(parameter, node),
            (ParameterKind::Channels { .. }, Content::List(nodes)) => triple(nodes).map(Value::Colour),
            (
                ParameterKind::Channels { .. } | ParameterKind::Number { .. } | ParameterKind::OneOf { .. },
                &Content::Number(number),
            ) => Some(Value::Number(number)),
            (ParameterKind::Choice { .. }, Content::Text(text)) => Some(Value::from(text.clone())),
            (ParameterKind::DataSet, Content::Text(text)) => return self.data_set(text, node),
            _ => None,
        };
        if value.is_none() {
            self.wrong_type(parameter, node);
        }
        value
    }

    /// A data set by its whole name, or a file beside this one.
    fn data_set(&mut self, text: &str, node: &Node) -> Option<Value> {
        let path = Path::new(text);
        if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("csv")) {
            return Some(Value::from(self.folder.join(path).display().to_string()));
        }
        // The only set of a substance today is one of several tomorrow.
        if let (false, Ok(table)) = (text.contains('/'), builtin(text)) {
            let text = format!("`{text}` is a substance, not a data set");
            let finding = Finding::at(Code::AmbiguousDataSet, node.span.clone(), text);
            self.report(finding.label(format!("write \"{}\"", table.name())));
            return None;
        }
        Some(Value::from(text.to_owned()))
    }

    /// A colour in linear Rec. 709, from `0.5`, `[r, g, b]` or `{ srgb = [r, g, b] }`.
    fn colour(&mut self, parameter: &Parameter, node: &Node) -> Option<Value> {
        let (space, node) = match node.table() {
            None => (self.colour, node),
            Some([entry]) => match ColourSpace::named(&entry.key) {
                Some(space) => (Some(space), &entry.value),
                None => {
                    let names = ColourSpace::ALL.map(ColourSpace::name);
                    let hint = did_you_mean(&entry.key, names.into_iter());
                    let text = format!("unknown colour space `{}`{hint}", entry.key);
                    let finding = Finding::at(Code::UnknownName, entry.span.clone(), text);
                    self.report(finding.label(format!("expected {}", names.join(" or "))));
                    return None;
                }
            },
            Some(_) => {
                self.wrong_type(parameter, node);
                return None;
            }
        };
        let colour = match &node.content {
            &Content::Number(grey) => Some([grey; 3]),
            Content::List(nodes) => triple(nodes),
            _ => None,
        };
        let Some(colour) = colour else {
            self.wrong_type(parameter, node);
            return None;
        };
        let id = parameter.id;
        if let Some(&channel) = colour.iter().find(|channel| **channel > 1.0) {
            let text = format!("{id} has a channel of {channel}: more light would leave than arrives");
            let finding = Finding::at(Code::ReflectanceAboveOne, node.span.clone(), text);
            let finding = finding.label(format!("expected {}", parameter.expected()));
            let is_byte = channel > 2.0 && colour.iter().all(|c| c.fract() == 0.0 && *c <= 255.0);
            let bytes = colour.map(|channel| format!("{:.4}", channel / 255.0)).join(", ");
            self.report(match is_byte {
                true => finding.help(format!("of 255? {{ srgb = [{bytes}] }}")),
                false => finding,
            });
            return None;
        }
        if let Some(channel) = colour.iter().find(|channel| !(0.0..=1.0).contains(*channel)) {
            let text = format!("{id} has a channel of {channel}, out of range");
            let finding = Finding::at(Code::OutOfRange, node.span.clone(), text);
            self.report(finding.label(format!("expected {}", parameter.expected())));
            return None;
        }
        let Some(space) = space else {
            let text = "a colour means nothing without its space";
            let finding = Finding::at(Code::Undeclared, node.span.clone(), text)
                .help("declare under [gonio]: color = \"lin_rec709\", or \"srgb\" for values of a colour picker")
                .help(format!("or here alone: {id} = {{ srgb = {} }}", Value::Colour(colour)));
            self.refuse_undeclared(0, finding);
            return None;
        };
        Some(Value::Colour(space.linear(colour)))
    }
}

/// Where a key would mean something, if anywhere.
fn elsewhere(model: Model, group: &str, key: &str) -> Option<String> {
    let is_spelling =
        |parameter: &Parameter| spellings(parameter).iter().any(|(spelling, _)| spelling == key);
    let takes = |table: &'static [Parameter], group: &str| {
        flattened(table).into_iter().find_map(|(path, parameter)| {
            let (of, _) = path.rsplit_once('.').unwrap_or(("", &path));
            (of != group && is_spelling(parameter)).then(|| join(of, key))
        })
    };
    if let Some(path) = takes(model.parameters(), group) {
        return Some(format!("`{path}` is a key of model `{}`", model.name()));
    }
    let others = Model::ALL.iter().filter(|other| other.parameters().iter().any(is_spelling));
    let others: Vec<_> = others.map(|other| other.name()).collect();
    (!others.is_empty()).then(|| format!("`{key}` is a key of {}", others.join(", ")))
}

/// Three numbers.
fn triple(nodes: &[Node]) -> Option<[f64; 3]> {
    let number = |node: &Node| if let Content::Number(number) = node.content { Some(number) } else { None };
    let numbers: Option<Vec<f64>> = nodes.iter().map(number).collect();
    numbers?.try_into().ok()
}

/// The keys that give a parameter, each with the factor from its unit to that of the parameter; the factor of
/// `roughness` is that of α by convention.
pub(super) fn spellings(parameter: &Parameter) -> Vec<(String, f64)> {
    let mut keys = vec![(parameter.id.to_owned(), 1.0)];
    if parameter.id == "alpha" {
        keys.push((ROUGHNESS.to_owned(), 1.0));
    }
    let (stem, unit) = in_parts(parameter.id);
    let radians = |unit: &str| UNITS.iter().find(|(known, _)| *known == unit)?.1;
    if let Some(own) = unit.and_then(radians) {
        let others = UNITS.iter().filter(|(other, _)| Some(*other) != unit);
        keys.extend(others.filter_map(|(other, factor)| Some((format!("{stem}_{other}"), (*factor)? / own))));
    }
    keys
}

/// A key without the unit that it ends in, and the unit.
fn in_parts(key: &str) -> (&str, Option<&str>) {
    match key.rsplit_once('_') {
        Some((stem, unit)) if UNITS.iter().any(|(known, _)| *known == unit) => (stem, Some(unit)),
        _ => (key, None),
    }
}

fn join(group: &str, id: &str) -> String {
    if group.is_empty() { id.to_owned() } else { format!("{group}.{id}") }
}

/// What a description refuses, as a finding.
pub(super) fn of_problem(problem: &MaterialError, span: Range<usize>) -> Finding {
    let code = match problem {
        MaterialError::UnknownModel { .. }
        | MaterialError::UnknownPreset { .. }
        | MaterialError::UnknownChoice { .. } => Code::UnknownName,
        MaterialError::UnknownParameter { .. } => Code::UnknownKey,
        MaterialError::WrongType { .. } => Code::WrongType,
        MaterialError::Unacceptable { .. } | MaterialError::Lobe(_) | MaterialError::Layer(_) => {
            Code::OutOfRange
        }
        MaterialError::Missing { .. } => Code::Missing,
        MaterialError::Contradiction { .. } => Code::Contradiction,
        MaterialError::DataSet { source, .. } => match source {
            IorError::Unknown { .. } => Code::UnknownName,
            IorError::Ambiguous { .. } => Code::AmbiguousDataSet,
            IorError::OutsideRange { .. } => Code::OutOfRange,
            IorError::Bad(_) => Code::Unreadable,
        },
    };
    match problem {
        MaterialError::Unacceptable { parameter, value, expected } => {
            Finding::at(code, span, format!("{parameter} = {value} is out of range"))
                .label(format!("expected {expected}"))
        }
        MaterialError::UnknownChoice { parameter, value, hint, expected } => {
            Finding::at(code, span, format!("{parameter} = \"{value}\" is no choice{hint}"))
                .label(format!("expected {expected}"))
        }
        MaterialError::Missing { parameter, .. } => Finding::at(code, span, problem.to_string())
            .label(format!("`{parameter}` is missing"))
            .help("eta and k belong together; or name a data set: ior = \"copper/Johnson-1972\""),
        MaterialError::DataSet { source: IorError::Ambiguous { material, choices }, .. } => {
            Finding::at(code, span, format!("`{material}` has several data sets that differ"))
                .label("which of them?")
                .help(format!("R at 0°, 550 nm: {}", choices.join(" · ")))
        }
        problem => Finding::at(code, span, problem.to_string()),
    }
}

//! From materials to the text of a file that reads as the same materials.

use std::fmt::Write as _;
use std::path::Path;

use serde::{Serialize, Serializer};
use serde_json::json;

use super::colour::ColourSpace;
use super::{Allowance, Document, Entry, VERSION};
use crate::material::{Profile, Value};

impl Document {
    /// The file in TOML, with all values as [`super::read`] found them: colours linear, α, units of the tables.
    pub fn to_toml(&self) -> String {
        let mut text = String::from("[gonio]\n");
        for (key, value) in self.header() {
            // Writing to a string does not fail.
            let _ = writeln!(text, "{key} = {}", literal(&value));
        }
        for material in &self.materials {
            let _ = writeln!(text, "\n[material.{}]", quoted_key(&material.name));
            for (key, value) in self.contents(material) {
                let _ = writeln!(text, "{} = {}", quoted_key(&key), literal(&value));
            }
        }
        text
    }

    /// The same in JSON.
    pub fn to_json(&self) -> String {
        let materials =
            self.materials.iter().map(|material| (material.name.clone(), self.contents(material)));
        let file = Tree::Table(vec![
            ("gonio".to_owned(), Tree::Table(self.header())),
            (
                "material".to_owned(),
                Tree::Table(materials.map(|(name, tree)| (name, Tree::Table(tree))).collect()),
            ),
        ]);
        // Numbers and texts can always be written.
        serde_json::to_string_pretty(&file).unwrap_or_default() + "\n"
    }

    fn header(&self) -> Contents {
        let text = |text: &str| Tree::Text(text.to_owned());
        let mut header = vec![
            ("version".to_owned(), Tree::Number(VERSION)),
            ("color".to_owned(), text(ColourSpace::LinRec709.name())),
        ];
        if self.profile != Profile::default() {
            header.push(("profile".to_owned(), text(self.profile.name())));
        }
        header
    }

    /// The keys of a material in the order of the table of parameters, groups as tables.
    fn contents(&self, material: &Entry) -> Contents {
        let mut contents = vec![("model".to_owned(), Tree::Text(material.model().name().to_owned()))];
        for (path, value) in material.description.given() {
            let value = match value {
                Value::Number(number) => Tree::Number(*number),
                Value::Colour(channels) => Tree::Channels(*channels),
                // Files are named from the folder of this one.
                Value::Text(text) => Tree::Text(match Path::new(&**text).strip_prefix(&self.folder) {
                    Ok(path) if text.contains('.') => path.display().to_string(),
                    _ => text.to_string(),
                }),
            };
            insert(&mut contents, path.split('.'), value);
        }
        for Allowance { code, path, reason, .. } in &material.allowed {
            let keys = ["allow", code.id(), path];
            insert(&mut contents, keys.into_iter(), Tree::Text(reason.clone()));
        }
        contents
    }
}

/// Keys with what they stand for, in order.
type Contents = Vec<(String, Tree)>;

/// What a key stands for.
enum Tree {
    Number(f64),
    Channels([f64; 3]),
    Text(String),
    Table(Contents),
}

impl Serialize for Tree {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(number) => number.serialize(serializer),
            Self::Channels(channels) => channels.serialize(serializer),
            Self::Text(text) => text.serialize(serializer),
            Self::Table(contents) => serializer.collect_map(contents.iter().map(|(key, tree)| (key, tree))),
        }
    }
}

/// Puts a value at the end of a path of tables.
fn insert<'a>(contents: &mut Contents, mut path: impl Iterator<Item = &'a str>, value: Tree) {
    let Some(key) = path.next() else { return };
    let mut path = path.peekable();
    if path.peek().is_none() {
        contents.push((key.to_owned(), value));
        return;
    }
    let at = contents.iter().position(|(known, _)| known == key).unwrap_or_else(|| {
        contents.push((key.to_owned(), Tree::Table(Vec::new())));
        contents.len() - 1
    });
    if let Tree::Table(contents) = &mut contents[at].1 {
        insert(contents, &mut path as &mut dyn Iterator<Item = &'a str>, value);
    }
}

/// A value in TOML on one line.
fn literal(tree: &Tree) -> String {
    match tree {
        Tree::Table(contents) => {
            let members =
                contents.iter().map(|(key, tree)| format!("{} = {}", quoted_key(key), literal(tree)));
            format!("{{ {} }}", members.collect::<Vec<_>>().join(", "))
        }
        Tree::Text(text) => quoted(text),
        Tree::Number(number) if number.fract() == 0.0 && number.abs() < 1e15 => number.to_string(),
        // The shortest digits that are the number again, with a point or an exponent.
        Tree::Number(number) => format!("{number:?}"),
        Tree::Channels(channels) => format!("{channels:?}"),
    }
}

/// Escapes of JSON are escapes of TOML, which asks for one more.
fn quoted(text: &str) -> String {
    json!(text).to_string().replace('\u{7f}', "\\u007f")
}

/// A key that may hold dots.
fn quoted_key(key: &str) -> String {
    let is_bare = !key.is_empty() && key.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c));
    if is_bare { key.to_owned() } else { quoted(key) }
}

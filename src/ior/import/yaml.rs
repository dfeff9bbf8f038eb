//! The part of YAML that the database is written in, as a tree with line numbers.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use saphyr_parser::{Event, Parser, ScalarStyle};

use super::Problem;
use crate::message::Code;

/// Deepest nesting that is read; the catalogue needs eight levels.
const DEEPEST: usize = 32;

/// A value and the line that it begins on, from 1.
#[derive(Debug)]
pub(super) struct Node {
    pub(super) line: usize,
    pub(super) value: Value,
}

#[derive(Debug)]
pub(super) enum Value {
    Text(Text),
    List(Vec<Node>),
    Map(Map),
}

/// Values by key, each with the line of the key.
pub(super) type Map = BTreeMap<String, (usize, Node)>;

#[derive(Debug)]
pub(super) struct Text {
    text: String,
    /// Every line of the text is a line of the file.
    literal: bool,
    line: usize,
}

impl Text {
    pub(super) fn as_str(&self) -> &str {
        self.text.trim()
    }

    /// The lines that are not blank, with their numbers in the file.
    pub(super) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let number = |i| if self.literal { self.line + i } else { self.line };
        let lines = self.text.lines().enumerate().map(move |(i, line)| (number(i), line.trim()));
        lines.filter(|(_, line)| !line.is_empty())
    }
}

impl Node {
    pub(super) fn text(&self) -> Option<&Text> {
        if let Value::Text(text) = &self.value { Some(text) } else { None }
    }

    pub(super) fn list(&self) -> Option<&[Node]> {
        if let Value::List(list) = &self.value { Some(list) } else { None }
    }

    pub(super) fn map(&self) -> Option<&Map> {
        if let Value::Map(map) = &self.value { Some(map) } else { None }
    }
}

/// A list or mapping whose end has not come yet.
enum Open {
    List(Vec<Node>),
    Map(Map, Option<(usize, String)>),
}

/// Reads one document. Anchors and tags are passed over; references to anchors are refused, since a few of
/// them can stand for more than fits into memory.
pub(super) fn parse(bytes: &[u8]) -> Result<Node, Problem> {
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let before = bytes.get(..error.valid_up_to()).unwrap_or_default();
        let line = 1 + before.iter().filter(|&&byte| byte == b'\n').count();
        Problem::at(line, Code::PageSyntax, "not UTF-8; save the file in that encoding")
    })?;
    read(text).or_else(|problem| read(&indented(text)).map_err(|_| problem))
}

/// With a space before what can only be the rest of a quoted text. Within quotes it counts for nothing, but YAML asks for
/// it; PyYAML does not, and some pages of the database lack it.
fn indented(text: &str) -> String {
    let is_rest = |line: &str| {
        let key = line.split(':').next().unwrap_or_default();
        let is_key =
            key.len() < line.len() && key.bytes().all(|byte| byte.is_ascii_uppercase() || byte == b'_');
        !is_key && line.starts_with(|first: char| !first.is_whitespace() && !"#-.%".contains(first))
    };
    text.split_inclusive('\n').flat_map(|line| [if is_rest(line) { " " } else { "" }, line]).collect()
}

fn read(text: &str) -> Result<Node, Problem> {
    let mut parser = Parser::new_from_str(text);
    let mut open: Vec<(usize, Open)> = Vec::new();
    let mut root = None;
    while let Some(event) = parser.next_event() {
        let (event, span) = event.map_err(|error| {
            Problem::at(error.marker().line(), Code::PageSyntax, format!("not YAML: {}", error.info()))
        })?;
        let line = span.start.line();
        let refused = |what: &str| Problem::at(line, Code::PageSyntax, what);
        let node = match event {
            Event::Scalar(text, style, ..) => {
                let literal = style == ScalarStyle::Literal;
                // The span of a literal begins after its leading blank lines; the text holds them.
                let blank = if literal { text.bytes().take_while(|&byte| byte == b'\n').count() } else { 0 };
                let line = line.saturating_sub(blank);
                let value = Value::Text(Text { text: text.into_owned(), literal, line });
                Node { line, value }
            }
            Event::SequenceStart(..) | Event::MappingStart(..) if open.len() == DEEPEST => {
                return Err(refused("nested more than 32 levels deep; no page of the database is"));
            }
            Event::SequenceStart(..) => {
                open.push((line, Open::List(Vec::new())));
                continue;
            }
            Event::MappingStart(..) => {
                open.push((line, Open::Map(Map::new(), None)));
                continue;
            }
            Event::SequenceEnd | Event::MappingEnd => match open.pop() {
                Some((line, Open::List(list))) => Node { line, value: Value::List(list) },
                Some((line, Open::Map(map, _))) => Node { line, value: Value::Map(map) },
                None => continue,
            },
            Event::Alias(_) => return Err(refused("a reference (`*…`) to an anchor; write the value out")),
            Event::DocumentStart(_) if root.is_some() => {
                return Err(refused("a second document begins; keep one in a file"));
            }
            _ => continue,
        };
        match open.last_mut() {
            None => root = Some(node),
            Some((_, Open::List(list))) => list.push(node),
            Some((_, Open::Map(map, key))) => match key.take() {
                None => {
                    let text = node.text().ok_or_else(|| refused("a key that is not a text"))?;
                    *key = Some((node.line, text.as_str().to_owned()));
                }
                Some((line, key)) => match map.entry(key) {
                    Entry::Vacant(entry) => _ = entry.insert((line, node)),
                    Entry::Occupied(entry) => {
                        let (key, (first, _)) = (entry.key(), entry.get());
                        let text = format!("`{key}` is given twice, first on line {first}; keep one");
                        return Err(Problem::at(line, Code::PageSchema, text));
                    }
                },
            },
        }
    }
    root.ok_or_else(|| Problem::at(1, Code::PageSyntax, "the file is empty"))
}

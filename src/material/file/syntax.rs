//! TOML and JSON as one tree whose parts know where they stand.

use std::collections::BTreeSet;
use std::ops::Range;

use jsonc_parser::errors::ParseErrorKind;
use jsonc_parser::{CollectOptions, ParseOptions, ast, parse_to_ast};
use toml::Spanned;
use toml::de::{DeString, DeTable, DeValue};

use super::Syntax;
use crate::message::{Code, Finding};

/// Levels of tables and lists within each other; a material needs five.
const DEEPEST: usize = 32;

/// A part of a file with the bytes that it takes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) content: Content,
    pub(crate) span: Range<usize>,
}

/// What stands there.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Content {
    Table(Vec<Entry>),
    List(Vec<Node>),
    Number(f64),
    Text(String),
    /// Something that no material has, in words.
    Other(&'static str),
}

/// A key with its value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) key: String,
    /// The bytes of the key.
    pub(crate) span: Range<usize>,
    pub(crate) value: Node,
}

impl Node {
    /// What it is, in words.
    pub(crate) fn kind(&self) -> &'static str {
        match self.content {
            Content::Table(_) => "a table",
            Content::List(_) => "a list",
            Content::Number(_) => "a number",
            Content::Text(_) => "a text",
            Content::Other(kind) => kind,
        }
    }

    /// Its entries, if it is a table.
    pub(crate) fn table(&self) -> Option<&[Entry]> {
        if let Content::Table(entries) = &self.content { Some(entries) } else { None }
    }
}

/// The tree of a text and what is wrong with its syntax; where the syntax allows, all of it.
pub(super) fn parse(text: &str, syntax: Syntax) -> (Node, Vec<Finding>) {
    match syntax {
        Syntax::Toml => on_a_large_stack(|| toml(text)),
        Syntax::Json => json(text),
    }
}

/// The parser of TOML takes 80 tables within each other, under keys of 80 parts, and a function call or two for each.
fn on_a_large_stack<T: Send>(work: impl Fn() -> T + Sync) -> T {
    const STACK: usize = 64 << 20;
    std::thread::scope(|scope| {
        match std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, &work) {
            Ok(thread) => thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)),
            // Without another thread there is this one.
            Err(_) => work(),
        }
    })
}

fn empty(text: &str) -> Node {
    Node { content: Content::Table(Vec::new()), span: 0..text.len() }
}

fn toml(text: &str) -> (Node, Vec<Finding>) {
    let (root, mut errors) = DeTable::parse_recoverable(text);
    errors.sort_by_key(|error| error.span().map_or(0, |span| span.start));
    let mut findings: Vec<Finding> = Vec::new();
    let mut end_of_echo = 0;
    for error in errors {
        let span = error.span().unwrap_or(0..text.len());
        if span.start < end_of_echo {
            continue;
        }
        // What follows an error on its line is its echo; what follows a table that is given twice, all of it.
        let line = line_of(text, span.start);
        let is_table = text.get(line.clone()).is_some_and(|line| line.trim_start().starts_with('['));
        end_of_echo = if is_table { section_of(text, span.start).end } else { line.end };
        findings.push(if error.message() == "duplicate key" {
            let key = text.get(span.clone()).unwrap_or_default();
            Finding::at(Code::Twice, span, format!("`{key}` is given twice"))
                .label("here it is given again")
                .help("keep one of them")
        } else {
            Finding::at(Code::Syntax, span, format!("not TOML: {}", error.message()))
        });
    }
    let span = root.span();
    let node = Node { content: Content::Table(of_toml_table(root.get_ref(), 1)), span };
    if let Some(span) = too_deep(&node, 1).filter(|_| findings.is_empty()) {
        findings.push(deep(span));
    }
    (node, findings)
}

/// The line that a byte is in, with its break.
fn line_of(text: &str, at: usize) -> Range<usize> {
    let bytes = text.as_bytes();
    let at = at.min(bytes.len());
    let start = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    let end = bytes[at..].iter().position(|byte| *byte == b'\n').map_or(bytes.len(), |end| at + end + 1);
    start..end
}

/// The lines from the header of the table of TOML that a byte is in to the next header.
fn section_of(text: &str, at: usize) -> Range<usize> {
    let is_header = |line: &Range<usize>| text[line.clone()].trim_start().starts_with('[');
    let Range { mut start, mut end } = line_of(text, at);
    while start > 0 && !is_header(&line_of(text, start)) {
        start = line_of(text, start - 1).start;
    }
    while end < text.len() && !is_header(&line_of(text, end)) {
        end = line_of(text, end).end;
    }
    start..end
}

/// The parts of a text that cannot be trusted, given what is wrong with its syntax.
pub(super) fn broken(text: &str, syntax: Syntax, findings: &[Finding]) -> Vec<Range<usize>> {
    let mut broken: Vec<Range<usize>> = Vec::new();
    for finding in findings {
        let at = finding.span.as_ref().map_or(0, |span| span.start);
        // A file may be nothing but errors: each section is looked for once.
        if broken.last().is_none_or(|last| at >= last.end) {
            broken.push(match (syntax, finding.code, &finding.span) {
                (Syntax::Toml, ..) => section_of(text, at),
                // The tree is whole but for this.
                (Syntax::Json, Code::Twice, Some(span)) => span.clone(),
                (Syntax::Json, ..) => 0..text.len() + 1,
            });
        }
    }
    broken
}

fn of_toml_table(table: &DeTable<'_>, depth: usize) -> Vec<Entry> {
    let entry = |(key, value): (&Spanned<DeString<'_>>, &Spanned<DeValue<'_>>)| Entry {
        key: key.get_ref().to_string(),
        span: key.span(),
        value: of_toml(value, depth + 1),
    };
    let mut entries: Vec<Entry> = table.iter().map(entry).collect();
    entries.sort_by_key(|entry| entry.span.start);
    entries
}

/// The tree of a value, down to one level below the deepest that is allowed: dotted keys within tables within tables
/// would take more stack than a thread has.
fn of_toml(value: &Spanned<DeValue<'_>>, depth: usize) -> Node {
    let content = match value.get_ref() {
        DeValue::Array(_) if depth > DEEPEST => Content::List(Vec::new()),
        DeValue::Table(_) if depth > DEEPEST => Content::Table(Vec::new()),
        DeValue::String(text) => Content::Text(text.to_string()),
        DeValue::Integer(number) => {
            // Beyond 64 bits, or what no literal is: nothing that a parameter takes.
            i64::from_str_radix(number.as_str(), number.radix())
                .map_or(Content::Other("a number of more than 64 bits"), |n| Content::Number(n as f64))
        }
        DeValue::Float(number) => {
            number.as_str().parse().map_or(Content::Other("no number"), Content::Number)
        }
        DeValue::Boolean(_) => Content::Other("a truth value"),
        DeValue::Datetime(_) => Content::Other("a date"),
        DeValue::Array(list) => Content::List(list.iter().map(|node| of_toml(node, depth + 1)).collect()),
        DeValue::Table(table) => Content::Table(of_toml_table(table, depth)),
    };
    Node { content, span: value.span() }
}

fn json(text: &str) -> (Node, Vec<Finding>) {
    let strict = ParseOptions {
        allow_comments: false,
        allow_loose_object_property_names: false,
        allow_trailing_commas: false,
        allow_missing_commas: false,
        allow_single_quoted_strings: false,
        allow_hexadecimal_numbers: false,
        allow_unary_plus_numbers: false,
        allow_bare_decimal_point_numbers: false,
        allow_non_finite_numbers: false,
        allow_extended_string_escapes: false,
    };
    // Some editors mark UTF-8; to JSON the mark is as good as spaces, of which it takes three.
    let unmarked = text.strip_prefix('\u{feff}').map(|rest| format!("   {rest}"));
    let text = unmarked.as_deref().unwrap_or(text);
    match parse_to_ast(text, &CollectOptions::default(), &strict) {
        Ok(parsed) => {
            let mut findings = Vec::new();
            let Some(value) = parsed.value else {
                let finding = Finding::of_file(Code::Syntax, "not JSON: the file is empty");
                return (empty(text), vec![finding]);
            };
            let node = of_json(&value, &mut findings);
            if let Some(span) = too_deep(&node, 1) {
                findings.push(deep(span));
            }
            (node, findings)
        }
        Err(error) => {
            let range = error.range();
            let span = range.start..range.end;
            let finding = match error.kind() {
                ParseErrorKind::NestingDepthExceeded => deep(span),
                kind => Finding::at(Code::Syntax, span, format!("not JSON: {}", lower(&kind.to_string()))),
            };
            (empty(text), vec![finding])
        }
    }
}

fn of_json(value: &ast::Value<'_>, findings: &mut Vec<Finding>) -> Node {
    use jsonc_parser::common::Ranged as _;
    let range = value.range();
    let content = match value {
        ast::Value::StringLit(text) => Content::Text(text.value.to_string()),
        ast::Value::NumberLit(number) => {
            number.value.parse().map_or(Content::Other("no number"), Content::Number)
        }
        ast::Value::BooleanLit(_) => Content::Other("a truth value"),
        ast::Value::NullKeyword(_) => Content::Other("null"),
        ast::Value::Array(list) => {
            Content::List(list.elements.iter().map(|node| of_json(node, findings)).collect())
        }
        ast::Value::Object(object) => {
            let mut entries: Vec<Entry> = Vec::new();
            let mut keys = BTreeSet::new();
            for property in &object.properties {
                let (key, range) = (property.name.as_str(), property.name.range());
                let span = range.start..range.end;
                if !keys.insert(key) {
                    let twice = Finding::at(Code::Twice, span, format!("`{key}` is given twice"));
                    findings.push(twice.label("here it is given again").help("keep one of them"));
                } else {
                    let value = of_json(&property.value, findings);
                    entries.push(Entry { key: key.to_owned(), span, value });
                }
            }
            Content::Table(entries)
        }
    };
    Node { content, span: range.start..range.end }
}

fn lower(text: &str) -> String {
    let mut characters = text.chars();
    let first = characters.next().map(|first| first.to_lowercase().to_string());
    first.unwrap_or_default() + characters.as_str()
}

/// Where tables and lists are nested too deeply.
fn too_deep(node: &Node, depth: usize) -> Option<Range<usize>> {
    let is_leaf = !matches!(node.content, Content::Table(_) | Content::List(_));
    if !is_leaf && depth > DEEPEST {
        return Some(node.span.clone());
    }
    match &node.content {
        Content::Table(entries) => entries.iter().find_map(|entry| too_deep(&entry.value, depth + 1)),
        Content::List(nodes) => nodes.iter().find_map(|node| too_deep(node, depth + 1)),
        _ => None,
    }
}

fn deep(span: Range<usize>) -> Finding {
    Finding::at(Code::Syntax, span, format!("more than {DEEPEST} tables or lists within each other"))
        .help("a material has tables within a table within a table, no more")
}

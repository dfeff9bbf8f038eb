//! What several targets hold readers to.

use std::path::Path;

use gonio::material::Profile;
use gonio::material::file::{Document, Entry, Syntax, read};
use gonio::material::foreign::Imported;
use gonio::message::Finding;

/// Reading and judging a material file does not panic, findings are about the text, and what was read is written and
/// read again.
pub fn material(text: &str, syntax: Syntax) {
    let (document, findings) = read(text, syntax, Path::new(""));
    are_about(text, findings.into_iter().chain(document.lint()));
    is_read_again(&document, syntax);
}

/// Importing does not panic, findings are about the text, and what was imported can be written and read.
pub fn foreign(text: &str, import: impl Fn(&str) -> (Vec<Imported>, Vec<Finding>)) {
    let (materials, findings) = import(text);
    are_about(text, findings);
    let entry = |(i, material): (usize, Imported)| Entry::new(format!("m{i}"), material.description);
    let materials = materials.into_iter().enumerate().map(entry).collect();
    is_read_again(&Document::new(Profile::default(), materials), Syntax::Toml);
}

fn are_about(text: &str, findings: impl IntoIterator<Item = Finding>) {
    for span in findings.into_iter().filter_map(|finding| finding.span) {
        assert!(text.get(span).is_some());
    }
}

fn is_read_again(document: &Document, syntax: Syntax) {
    let written = match syntax {
        Syntax::Toml => document.to_toml(),
        Syntax::Json => document.to_json(),
    };
    let (again, findings) = read(&written, syntax, Path::new(""));
    assert!(findings.is_empty());
    assert_eq!(again, *document);
}

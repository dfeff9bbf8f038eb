//! Wavefront `.mtl`: importing does not panic, and what was imported can be written and read.
#![no_main]

use std::path::Path;

use gonio::material::file::{Document, Entry, Syntax, read};
use gonio::material::Profile;
use gonio::material::foreign::mtl;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (materials, findings) = mtl(text);
    for span in findings.into_iter().filter_map(|finding| finding.span) {
        assert!(text.get(span).is_some());
    }
    let entry = |(i, material): (usize, gonio::material::foreign::Imported)| {
        Entry::new(format!("m{i}"), material.description)
    };
    let materials = materials.into_iter().enumerate().map(entry).collect();
    let document = Document::new(Profile::default(), materials);
    let (again, findings) = read(&document.to_toml(), Syntax::Toml, Path::new(""));
    assert!(findings.is_empty());
    assert_eq!(again.materials.len(), document.materials.len());
});

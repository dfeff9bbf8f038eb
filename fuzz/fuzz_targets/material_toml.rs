//! Material files in TOML: reading and judging do not panic, and what was read is written and read again.
#![no_main]

use std::path::Path;

use gonio::material::file::{Syntax, read};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let (document, findings) = read(text, Syntax::Toml, Path::new(""));
    for span in findings.into_iter().chain(document.lint()).filter_map(|finding| finding.span) {
        assert!(text.get(span).is_some());
    }
    let (again, findings) = read(&document.to_toml(), Syntax::Toml, Path::new(""));
    assert!(findings.is_empty());
    assert_eq!(again, document);
});

//! Reading and judging a file of a thousand materials, every preset some thirty times.

#![expect(clippy::expect_used, reason = "a benchmark that cannot be set up has failed")]

use std::path::Path;

use divan::Bencher;
use gonio::material::file::{Document, Entry, Syntax, read};
use gonio::material::{PRESETS, Profile};

fn main() {
    divan::main();
}

fn thousand() -> Document {
    let presets = PRESETS.iter().cycle().take(1000).enumerate();
    let entry = |(i, preset): (usize, &gonio::material::Preset)| {
        Entry::new(format!("{}.{i}", preset.name), preset.description().expect("presets are sound"))
    };
    Document::new(Profile::Measured, presets.map(entry).collect())
}

#[divan::bench(args = ["toml", "json"])]
fn lint(bencher: Bencher<'_, '_>, syntax: &str) {
    let document = thousand();
    let (text, syntax) = match syntax {
        "toml" => (document.to_toml(), Syntax::Toml),
        _ => (document.to_json(), Syntax::Json),
    };
    bencher.bench_local(|| {
        let (document, findings) = read(&text, syntax, Path::new(""));
        assert_eq!((document.materials.len(), findings.len()), (1000, 0));
        document.lint()
    });
}

//! Pages of the refractiveindex.info database: importing them does not panic.
#![no_main]

use std::path::PathBuf;

use gonio::ior::import::{Page, Source};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let source =
        Source { file: PathBuf::from("page.yml"), path: PathBuf::from("page.yml"), title: String::new() };
    if let Ok(page) = Page::parse(&source, bytes) {
        assert!(page.csv().contains("wavelength_nm"));
    }
});

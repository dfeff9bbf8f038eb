//! Material files in JSON.
#![no_main]

use gonio::material::file::Syntax;
use gonio_fuzz::material;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| material(text, Syntax::Json));

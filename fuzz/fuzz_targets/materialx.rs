//! MaterialX.
#![no_main]

use gonio::material::foreign::materialx;
use gonio_fuzz::foreign;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| foreign(text, materialx));

//! The command line of gonio.
fn main() {}

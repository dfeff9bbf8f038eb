//! Parameters, their ranges and their names: every constructor refuses a value that its formula cannot take, and
//! every unknown name is answered with near ones.

use crate::real::Real;
use crate::rgb::Rgb;

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

/// `fractions` itself if every channel is a fraction of the light that meets it.
pub(crate) fn require_fractions<F: Real>(
    parameter: &'static str,
    fractions: Rgb<F>,
) -> Result<Rgb<F>, OutOfRange> {
    for value in fractions.0 {
        let is_fraction = |value| value >= F::ZERO && value <= F::ONE;
        require(parameter, value, is_fraction, "a fraction in [0, 1] per channel")?;
    }
    Ok(fractions)
}

/// A question about the known names most like `name`, to be appended to an error: `; did you mean …?`, or nothing
/// where none is alike.
pub fn did_you_mean<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> String {
    let name = name.to_lowercase();
    let mut scored: Vec<_> = known
        .map(|candidate| {
            let likeness = |known: &str| strsim::jaro_winkler(&name, &known.to_lowercase());
            let whole = likeness(candidate);
            let parts = candidate.split('/').map(likeness);
            (parts.fold(whole, f64::max), candidate)
        })
        .filter(|&(score, _)| score > 0.8)
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    let alike: Vec<_> = scored.into_iter().take(3).map(|(_, candidate)| candidate).collect();
    if alike.is_empty() { String::new() } else { format!("; did you mean {}?", alike.join(", ")) }
}

/// The shortest digits that are the number again; an exponent where there would be many zeros.
pub(crate) fn figure(x: f64) -> String {
    match x.abs() {
        0.0 => "0".to_owned(),
        1e-4..1e9 => x.to_string(),
        _ => format!("{x:e}"),
    }
}

//! Comparing a report with an earlier one: everything but numbers exactly, numbers within a tolerance.
//!
//! The lobes and the laboratory compute the same bits everywhere, but for what statrs computes with the platform's
//! logarithm: tail probabilities, and the tails of the inverse error function.

use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

/// Numbers agree if they differ by no more than this fraction of the larger one …
const RELATIVE: f64 = 1e-6;
/// … or by this much, which is less than any quantity of interest and more than the rounding errors among them …
const ABSOLUTE: f64 = 1e-12;
/// … or, for the whole numbers that are coordinates in drawings, by this much; four are a pixel.
const UNITS: f64 = 2.0;

/// A file that is not as it would be made now.
#[derive(Debug)]
pub struct Difference {
    /// The file.
    pub path: PathBuf,
    /// Line, and what is there and what would be, or why there is nothing to compare.
    pub reason: String,
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.reason)
    }
}

pub(super) fn file(path: &Path, expected: &str) -> Option<Difference> {
    let reason = match fs::read_to_string(path) {
        Ok(found) => text(&found, expected)?,
        Err(error) => format!("cannot be read: {error}"),
    };
    Some(Difference { path: path.to_owned(), reason })
}

/// The first difference between two texts.
fn text(found: &str, expected: &str) -> Option<String> {
    let (mut found_lines, mut expected_lines) = (found.lines(), expected.lines());
    let mut in_drawing = false;
    for number in 1.. {
        let (found, expected) = match (found_lines.next(), expected_lines.next()) {
            (None, None) => return None,
            (found, expected) => (found.unwrap_or("(end of file)"), expected.unwrap_or("(end of file)")),
        };
        in_drawing |= expected.contains("<svg");
        if !same_line(found, expected, in_drawing) {
            return Some(format!(
                "line {number} is\n  {}\nand would be\n  {}",
                short(found),
                short(expected)
            ));
        }
        in_drawing &= !expected.contains("</svg>");
    }
    None
}

fn short(line: &str) -> String {
    line.chars().take(200).collect()
}

fn same_line(a: &str, b: &str, in_drawing: bool) -> bool {
    if a == b {
        return true;
    }
    let (a, b) = (tokens(a), tokens(b));
    a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a == b || same_number(a, b, in_drawing))
}

fn same_number(a: &str, b: &str, in_drawing: bool) -> bool {
    let (Ok(a), Ok(b)) = (a.parse::<f64>(), b.parse::<f64>()) else { return false };
    let difference = (a - b).abs();
    let are_coordinates = in_drawing && a.fract() == 0.0 && b.fract() == 0.0;
    difference <= ABSOLUTE.max(RELATIVE * a.abs().max(b.abs())) || (are_coordinates && difference <= UNITS)
}

/// Splits a line into numbers and the text between them.
fn tokens(line: &str) -> Vec<&str> {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+' | 'e' | 'E');
    let mut tokens = Vec::new();
    let mut rest = line;
    while !rest.is_empty() {
        let numeric = rest.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '-' | '.'));
        let end = rest
            .char_indices()
            .skip(1)
            .find(|&(_, c)| if numeric { !is_part(c) } else { c.is_ascii_digit() || matches!(c, '-' | '.') })
            .map_or(rest.len(), |(end, _)| end);
        let (token, tail) = rest.split_at(end);
        tokens.push(token);
        rest = tail;
    }
    tokens
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn last_digits_may_differ_and_nothing_else() {
        assert_eq!(text("a 1.23456789 b\n", "a 1.23456790 b\n"), None);
        assert!(text("a 1.2345\n", "a 1.2346\n").is_some());
        assert!(text("a 1.0 holds\n", "a 1.0 violated\n").is_some());
        assert!(text("a\nb\n", "a\n").is_some());
        assert!(text("a\n", "a\nb\n").is_some());
        assert!(text("1e-11\n", "2e-11\n").is_some());
        assert_eq!(text("4.4e-16\n", "8.9e-16\n"), None);
        assert_eq!(text("\"p\": -1e-5,", "\"p\": -1.0000001e-5,"), None);
    }

    #[test]
    fn drawings_may_move_by_half_a_pixel() {
        assert_eq!(text("<svg>\n<a x=\"10\"/>\n</svg>\n", "<svg>\n<a x=\"12\"/>\n</svg>\n"), None);
        assert!(text("<svg>\n<a x=\"10\"/>\n</svg>\n", "<svg>\n<a x=\"13\"/>\n</svg>\n").is_some());
        assert!(text("<svg>\n</svg>\n10\n", "<svg>\n</svg>\n12\n").is_some());
        assert!(text("<svg>\nR 0.912\n</svg>\n", "<svg>\nR 0.913\n</svg>\n").is_some());
    }
}

//! A broken copy of the rough conductor, and what its developer reads: `missing_jacobian.txt`.

mod laboratory;

use bxdf_tests::assert_conforms;
use foreign_renderer::{Bxdf, Float3, Mode, RoughConductor, Sample};
use laboratory::{Material, rough_conductor};
use std::process::Command;

/// The rough conductor with the density of the normal, not of the direction: 1 / (4 wo·h) is missing.
struct MissingJacobian(RoughConductor);

impl Bxdf for MissingJacobian {
    fn evaluate(&self, wo: Float3, wi: Float3, mode: Mode) -> [f32; 3] {
        self.0.evaluate(wo, wi, mode)
    }
    fn density(&self, wo: Float3, wi: Float3) -> f32 {
        // wo·h is half the length of wo + wi.
        let sum = wo + wi;
        2.0 * sum.dot(sum).sqrt() * self.0.density(wo, wi)
    }
    fn sample(&self, wo: Float3, component: f32, u: [f32; 2], mode: Mode) -> Option<Sample> {
        let sample = self.0.sample(wo, component, u, mode)?;
        let density = self.density(wo, sample.wi);
        let weight = self.evaluate(wo, sample.wi, mode).map(|f| f * sample.wi.z.abs() / density);
        Some(Sample { weight, density, ..sample })
    }
}

#[test]
#[should_panic(expected = "gold/missing_jacobian/chi_square VIOLATED")]
fn broken_copy_does_not_conform() {
    let Material { bxdf, claims, ggx, .. } = rough_conductor(0.3);
    // What is saved is no regression of this renderer.
    std::env::set_current_dir(env!("CARGO_TARGET_TMPDIR")).unwrap();
    let fresnel = |bxdf: &MissingJacobian, cosine, _| bxdf.0.fresnel(cosine);
    assert_conforms("gold/missing_jacobian", &Material { bxdf: MissingJacobian(bxdf), claims, ggx, fresnel });
}

/// Runs the test above as the first line of the snapshot says, and compares what it prints.
#[test]
fn failure_reads_as_shown() {
    let (command, expected) = include_str!("missing_jacobian.txt").split_once('\n').unwrap();
    assert_eq!(command, "$ BXDF_TESTS_SEED=1 cargo test broken_copy -- --nocapture");
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["broken_copy", "--nocapture"])
        .env("BXDF_TESTS_SEED", "1")
        .env("RUST_BACKTRACE", "0")
        .output()
        .unwrap();
    let text = String::from_utf8(output.stderr).unwrap();
    // From the line after `thread … panicked at …` to the hint about backtraces.
    let message = text.split_once(".rs:").and_then(|(_, rest)| rest.split_once('\n')).unwrap().1;
    let message: Vec<_> = message.lines().take_while(|line| !line.starts_with("note:")).collect();
    let expected: Vec<_> = expected.lines().collect();
    let is_as_shown = message.len() == expected.len()
        && message.iter().zip(&expected).all(|(line, expected)| {
            let (words, expected): (Vec<_>, Vec<_>) =
                (line.split(' ').collect(), expected.split(' ').collect());
            // The largest error in units of what rounding explains is at another point wherever rounding is
            // another.
            let any_number = line.contains("/jacobian VIOLATED");
            let is_alike = |word: &str, expected: &str| {
                is_alike(word, expected) || any_number && number(word).is_ok() && number(expected).is_ok()
            };
            words.len() == expected.len()
                && words.iter().zip(expected).all(|(word, expected)| is_alike(word, expected))
        });
    assert!(is_as_shown, "missing_jacobian.txt shows another failure than this:\n{}", message.join("\n"));
}

fn number(word: &str) -> Result<f64, std::num::ParseFloatError> {
    word.trim_matches(['(', ')', ',', '+']).parse()
}

/// Processors and mathematical libraries round differently: a number may differ by 1 %, a character of the
/// map by one.
fn is_alike(word: &str, expected: &str) -> bool {
    if let (Ok(x), Ok(y)) = (number(word), number(expected)) {
        return x == y || (x - y).abs() <= 0.01 * y.abs();
    }
    let is_map = |word: &str| word.len() == 36 && word.chars().all(|c| ".123456789abcdefghi".contains(c));
    let step = |c: char| match c {
        '.' => 0,
        '1'..='9' => i32::from(c as u8 - b'0'),
        _ => -i32::from(c as u8 - b'a') - 1,
    };
    word == expected
        || is_map(word)
            && is_map(expected)
            && word.chars().zip(expected.chars()).all(|(a, b)| (step(a) - step(b)).abs() <= 1)
}

//! Suite `jacobian` on samplers whose density is known: what it must see, and what it must not take for an
//! error.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{
    Claims, Direction, Examination, Measure, Outcome, Plan, Precision, Scatter, Specimen, Suite, Transport,
    Verdict, run_seed,
};
use std::f64::consts::{FRAC_1_PI, FRAC_PI_4, TAU};

/// A map of the unit square to itself.
type Warp = fn([f64; 2]) -> [f64; 2];

/// Paper that warps the uniforms of the cosine-weighted hemisphere.
struct Paper {
    precision: Precision,
    /// From the uniforms.
    warp: Warp,
    /// Density of the warped uniforms.
    density: fn([f64; 2]) -> f64,
    /// What the pdf says over what it is.
    scale: f64,
}

fn cosine_hemisphere([u, v]: [f64; 2]) -> Direction {
    let ((sin, cos), radius) = ((TAU * v).sin_cos(), u.sqrt());
    [radius * cos, radius * sin, (1.0 - u).sqrt()]
}

impl Specimen for Paper {
    fn name(&self) -> String {
        "paper".into()
    }
    fn claims(&self) -> Claims {
        Claims { invertible: true, ..Claims::reflector(self.precision) }
    }
    fn eval(&self, wo: Direction, wi: Direction, _: Transport) -> [f64; 3] {
        [if wo[2] > 0.0 && wi[2] > 0.0 { FRAC_1_PI } else { 0.0 }; 3]
    }
    fn pdf(&self, wo: Direction, [x, y, z]: Direction, _: Transport) -> f64 {
        let warped = [x * x + y * y, (y.atan2(x) / TAU).rem_euclid(1.0)];
        if wo[2] > 0.0 && z > 0.0 { self.scale * (self.density)(warped) * FRAC_1_PI * z } else { 0.0 }
    }
    fn sample(&self, wo: Direction, [_, x, y]: [f64; 3], transport: Transport) -> Option<Scatter> {
        let wi = cosine_hemisphere((self.warp)([x, y]));
        let wi = if self.precision == Precision::F32 { wi.map(|x| f64::from(x as f32)) } else { wi };
        let pdf = self.pdf(wo, wi, transport);
        let weight = [FRAC_1_PI * wi[2] / pdf; 3];
        (pdf > 0.0).then_some(Scatter { wi, weight, density: Measure::SolidAngle(pdf), eta: 1.0 })
    }
}

/// Shirley & Chiu, *Journal of Graphics Tools* 2(3), 1997, <https://doi.org/10.1080/10867651.1997.10487479>:
/// it keeps areas, and has kinks along both diagonals of the square.
fn concentric_disk(uniforms: [f64; 2]) -> [f64; 2] {
    let [x, y] = uniforms.map(|u| 2.0 * u - 1.0);
    if x == 0.0 && y == 0.0 {
        return [0.0, 0.0];
    }
    let (radius, angle) =
        if x.abs() > y.abs() { (x, FRAC_PI_4 * (y / x)) } else { (y, FRAC_PI_4 * (2.0 - x / y)) };
    let turns = angle / TAU + if radius < 0.0 { 0.5 } else { 0.0 };
    [radius * radius, turns.rem_euclid(1.0)]
}

/// Pieces of equal length, with kinks between them.
const PIECES: f64 = 40.0;
/// Slopes take turns about 1.
const SLOPES: [f64; 2] = [0.6, 1.4];

/// The first uniform from a table that is interpolated, as samplers have it: kinks within the reach of every
/// step.
fn tabulated([x, y]: [f64; 2]) -> [f64; 2] {
    let pair = 2.0 / PIECES;
    let (start, rest) = (pair * (x / pair).floor(), x % pair);
    let first = rest.min(0.5 * pair);
    [start + SLOPES[0] * first + SLOPES[1] * (rest - first), y]
}

fn density_of_tabulated([u, _]: [f64; 2]) -> f64 {
    let pair = 2.0 / PIECES;
    1.0 / SLOPES[usize::from(u % pair > 0.5 * pair * SLOPES[0])]
}

const EVEN: fn([f64; 2]) -> f64 = |_| 1.0;

/// Maps with their densities.
const MAPS: [(Warp, fn([f64; 2]) -> f64); 4] = [
    (|uniforms| uniforms, EVEN),
    // It turns the square inside out, which no density knows.
    (|[x, y]| [1.0 - x, y], EVEN),
    (concentric_disk, EVEN),
    (tabulated, density_of_tabulated),
];

fn verdict(specimen: &dyn Specimen, run_seed: u64) -> Verdict {
    let plan = Plan::new(run_seed, [specimen]);
    Examination::new(specimen, &plan).verdict(Suite::Jacobian).unwrap()
}

#[test]
fn maps_with_their_own_densities_hold_also_next_to_kinks() {
    let seed = run_seed();
    for precision in [Precision::F32, Precision::F64] {
        for (i, (warp, density)) in MAPS.into_iter().enumerate() {
            for repetition in 0..50 {
                let paper = Paper { precision, warp, density, scale: 1.0 };
                let verdict = verdict(&paper, seed.wrapping_add(repetition));
                assert_eq!(verdict.outcome, Outcome::Holds, "map {i}, {precision:?}: {verdict}");
                // Of 288 points; next to a kink there is nothing to say.
                let least = if i == 3 { 100 } else { 200 };
                assert!(verdict.checks > least, "map {i}, {precision:?}: {} checks", verdict.checks);
            }
        }
    }
}

#[test]
fn densities_that_are_a_little_off_are_violations() {
    for (precision, error) in [(Precision::F32, 3e-3), (Precision::F64, 3e-3), (Precision::F64, 1e-6)] {
        for (warp, density) in MAPS {
            for scale in [1.0 + error, 1.0 - error] {
                let verdict = verdict(&Paper { precision, warp, density, scale }, run_seed());
                assert_eq!(verdict.outcome, Outcome::Violated, "{precision:?} {error}: {verdict}");
            }
        }
    }
}

#[test]
fn a_density_without_the_jacobian_is_a_violation() {
    let [_, _, _, (warp, _)] = MAPS;
    for precision in [Precision::F32, Precision::F64] {
        let verdict = verdict(&Paper { precision, warp, density: EVEN, scale: 1.0 }, run_seed());
        assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
    }
}

/// Claims that its sampler can be inverted.
struct Claiming {
    precision: Precision,
    sample: fn([f64; 3]) -> (Direction, Measure),
    pdf: fn(Direction) -> f64,
}

impl Specimen for Claiming {
    fn name(&self) -> String {
        "claiming".into()
    }
    fn claims(&self) -> Claims {
        Claims { invertible: true, ..Claims::reflector(self.precision) }
    }
    fn eval(&self, _: Direction, _: Direction, _: Transport) -> [f64; 3] {
        [0.0; 3]
    }
    fn pdf(&self, _: Direction, wi: Direction, _: Transport) -> f64 {
        (self.pdf)(wi)
    }
    fn sample(&self, _: Direction, uniforms: [f64; 3], _: Transport) -> Option<Scatter> {
        let (wi, density) = (self.sample)(uniforms);
        Some(Scatter { wi, weight: [0.0; 3], density, eta: 1.0 })
    }
}

/// Half of the directions even in solid angle, half by the cosine.
#[test]
fn a_mixture_cannot_be_inverted() {
    let pdf = |wi: Direction| 0.5 * FRAC_1_PI * (0.5 + wi[2]);
    let sample = |[uc, u, v]: [f64; 3]| {
        let wi = cosine_hemisphere([if uc < 0.5 { u * (2.0 - u) } else { u }, v]);
        (wi, Measure::SolidAngle(0.5 * FRAC_1_PI * (0.5 + wi[2])))
    };
    let verdict = verdict(&Claiming { precision: Precision::F64, sample, pdf }, run_seed());
    assert_eq!(verdict.outcome, Outcome::Violated, "{verdict}");
}

#[test]
fn what_cannot_be_judged_is_inconclusive_and_says_why() {
    // A cap about the normal that single precision takes for one direction.
    const CAP: f64 = 1e-13;
    let needle = |[_, u, v]: [f64; 3]| {
        let ((sin, cos), radius) = ((TAU * v).sin_cos(), (2.0 * CAP * u).sqrt());
        ([radius * cos, radius * sin, 1.0 - CAP * u], Measure::SolidAngle(0.5 * FRAC_1_PI / CAP))
    };
    let mirror = |_: [f64; 3]| ([0.0, 0.0, 1.0], Measure::Discrete(1.0));
    for (sample, pdf, reason) in [
        (
            needle as fn([f64; 3]) -> (Direction, Measure),
            (|_| 0.5 * FRAC_1_PI / CAP) as fn(Direction) -> f64,
            "rounding hides the Jacobian",
        ),
        (mirror, |_| 0.0, "no sample has a density"),
    ] {
        let verdict = verdict(&Claiming { precision: Precision::F32, sample, pdf }, run_seed());
        assert_eq!(verdict.outcome, Outcome::Inconclusive, "{verdict}");
        assert!(verdict.what.contains(reason), "{reason} is the reason, but: {verdict}");
    }
}

//! The pdf is the density that the sampler's own map gives its directions: no chance is involved, and no
//! histogram sees as much.
//!
//! Where a direction comes from one pair of uniforms (x, y) only, its density is q / |∂wi/∂x × ∂wi/∂y|, the
//! probability of its side at (x, y) over √det(JᵀJ), J being the Jacobian matrix of `wi`. Its columns are
//! finite differences, each with a bound of its error; that of the density follows from the two and from what
//! the pdf owes to rounding.

use super::{Examination, length};
use crate::Precision;
use crate::plan::Setting;
use crate::search::halton;
use crate::specimen::{Direction, Measure, Scatter};
use crate::verdict::{Check, Ledger};
use rand::RngExt;

/// Points (x, y) per setting.
const POINTS: usize = 32;
/// The least distance from a point to the border of the unit square.
const MARGIN: f64 = 1.0 / 1024.0;
/// What points are multiples of, so that single precision has them and all steps from them.
const UNIT: f64 = 1.0 / 16_777_216.0;
/// Steps of a derivative, each half as long as the one before.
const STEPS: usize = 8;
/// The longer of two last steps that check the others, over the longest of those.
const FINEST: f64 = 1.0 / 2048.0;
/// By how much an extrapolation can be better than those that it was made from.
const FASTEST: f64 = 16.0;
/// Relative error of the expected density above which nothing is said about the pdf.
const WORST_ERROR: f64 = 0.1;
/// How well thresholds of the first uniform are known; single precision is coarser.
const SHORTEST: f64 = 0.25 * f64::EPSILON;
/// Pieces of the first uniform that are told apart: the two sides, a delta, no sample.
const MOST_PIECES: usize = 4;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (mut met, mut judged) = (false, false);
    for setting in examination.settings() {
        let mut generator = examination.plan.generator(&examination.name, &setting, "jacobian");
        for point in halton(&[generator.random(), generator.random()]).take(POINTS) {
            let point =
                [point[0], point[1]].map(|x| UNIT * ((MARGIN + (1.0 - 2.0 * MARGIN) * x) / UNIT).round());
            let map = Map { examination, setting, point };
            for piece in pieces(examination.claims.precision, |uc| map.side(uc)) {
                let Some(sample) = map.sample(piece.inside, [0.0; 2]) else { continue };
                met = true;
                if let Some(check) = map.compare(&piece, &sample) {
                    judged = true;
                    ledger.record(check);
                }
            }
        }
    }
    if !judged {
        let reason = if met { "rounding hides the Jacobian of the map" } else { "no sample has a density" };
        let witness = examination.settings().first().map(Setting::witness).unwrap_or_default();
        ledger.record(Check { inconclusive: Some(reason), ..Check::new(WHAT, 0.0, 0.0, witness) });
    }
}

const WHAT: &str = "pdf against 1 / sqrt(det(JT J)) of the sampler [1/sr]";

/// The map from uniforms to directions about one point of the unit square.
struct Map<'a> {
    examination: &'a Examination<'a>,
    setting: Setting,
    point: [f64; 2],
}

impl Map<'_> {
    /// What comes out at a distance from the point, unless that is a delta or nothing.
    fn sample(&self, uc: f64, [x, y]: [f64; 2]) -> Option<Scatter> {
        let uniforms = [uc, self.point[0] + x, self.point[1] + y];
        let sample = self.examination.specimen.sample(self.setting.wo, uniforms, self.setting.transport);
        sample.filter(|sample| matches!(sample.density, Measure::SolidAngle(_)))
    }

    /// The side of what comes out: above?
    fn side(&self, uc: f64) -> Option<bool> {
        self.sample(uc, [0.0; 2]).map(|sample| sample.wi[2] > 0.0)
    }

    /// The check of one sample; `None` where the error of the expected density is too large to say anything.
    fn compare(&self, piece: &Piece, sample: &Scatter) -> Option<Check> {
        let (Setting { wo, transport, .. }, examination) = (self.setting, self.examination);
        let (specimen, epsilon) = (examination.specimen, examination.claims.precision.epsilon());
        let wi = sample.wi;
        let along = |axis: usize| {
            let at = |step: f64| {
                let mut steps = [0.0; 2];
                steps[axis] = step;
                let near = self.sample(piece.inside, steps)?.wi;
                (near[2] * wi[2] > 0.0).then_some(near)
            };
            let x = self.point[axis];
            derivative(at, wi, longest(x.min(1.0 - x)), 16.0 * epsilon)
        };
        let (x, y) = (along(0)?, along(1)?);
        let size = length(wi);
        // Across `wi`: what rounding does to its length is no part of the solid angle.
        let solid_angle = triple(x.value, y.value, wi).abs() / (size * size * size);
        let error = x.error * (length(y.value) + y.error) + y.error * length(x.value);
        let expected = piece.probability / solid_angle;
        let relative = (error / solid_angle + piece.error / piece.probability) / (1.0 - error / solid_angle);
        if error >= solid_angle || relative > WORST_ERROR {
            return None;
        }
        let pdf = |w: Direction| specimen.pdf(wo, w, transport);
        let found = pdf(wi);
        let [bending] = examination.refraction_errors(wo, sample, [found], |w| [pdf(w)]);
        let allowed = expected * relative + examination.rounding_error(wi, found, pdf) + bending;
        // What is not a number goes on to the comparison.
        let is_hidden = allowed > WORST_ERROR * expected.max(found);
        let witness = self.setting.witness().with_wi(wi);
        let witness = witness.with_uniforms([piece.inside, self.point[0], self.point[1]]);
        (!is_hidden).then(|| Check::new(WHAT, (found - expected).abs(), allowed, witness))
    }
}

fn triple(a: Direction, b: Direction, c: Direction) -> f64 {
    (0..3).map(|i| (a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3]) * c[i]).sum()
}

/// An interval of the first uniform from which the same side comes out.
struct Piece {
    /// Its length, and the error of that.
    probability: f64,
    error: f64,
    /// A uniform inside: at an end of the unit interval it stays inside when (x, y) moves.
    inside: f64,
}

/// The pieces of the unit interval that differ in what comes out.
fn pieces<T: PartialEq>(precision: Precision, outcome: impl Fn(f64) -> T) -> Vec<Piece> {
    let epsilon = precision.epsilon();
    let last = 1.0 - 0.5 * epsilon;
    let end = outcome(last);
    // A threshold with its error: that of the bisection, and what the specimen owes to rounding.
    let mut start = (0.0, 0.0);
    let mut known = outcome(0.0);
    let mut pieces = Vec::new();
    while known != end && pieces.len() + 1 < MOST_PIECES {
        let (mut low, mut high, mut next) = (start.0, last, None);
        while high - low > SHORTEST {
            let middle = precision.round(0.5 * (low + high));
            if middle <= low || middle >= high {
                break;
            }
            match outcome(middle) {
                here if here == known => low = middle,
                here => (high, next) = (middle, Some(here)),
            }
        }
        let stop = (high, high - low + epsilon * high);
        let inside = if start.0 == 0.0 { 0.0 } else { precision.round(0.5 * (start.0 + high)) };
        pieces.push(Piece { probability: stop.0 - start.0, error: start.1 + stop.1, inside });
        start = stop;
        match next {
            Some(next) => known = next,
            None => break,
        }
    }
    pieces.push(Piece { probability: 1.0 - start.0, error: start.1, inside: last });
    pieces
}

/// The longest step at a distance from the border of the unit square: most of the way, with all parts
/// multiples of [`UNIT`].
fn longest(distance: f64) -> f64 {
    let part = 2.0 * UNIT / FINEST;
    part * (0.75 * distance / part).floor()
}

/// A derivative with a bound of its error.
struct Derivative {
    value: Direction,
    error: f64,
}

/// What central differences of one step give, or extrapolations from several.
struct Difference {
    slope: Direction,
    /// Half the change of slope at the point itself: it vanishes with the step unless the map has a kink
    /// there.
    kink: Direction,
    /// The part of the slope that rounding may be.
    noise: f64,
    /// How far the slope is from those that it was extrapolated from, or a fraction of how far those were
    /// from theirs.
    change: f64,
}

impl Difference {
    fn new(forth: Direction, here: Direction, back: Direction, step: f64, noise: f64) -> Self {
        Self {
            slope: core::array::from_fn(|i| (forth[i] - back[i]) / (2.0 * step)),
            kink: core::array::from_fn(|i| (forth[i] - 2.0 * here[i] + back[i]) / (2.0 * step)),
            noise: noise / step,
            change: 0.0,
        }
    }
}

/// The derivative at step 0 from central differences, extrapolated from all steps (Ridders, *Advances in
/// Engineering Software* 4(2), 1982, <https://doi.org/10.1016/S0141-1195(82)80057-0>): the extrapolation of
/// the smallest error. Each value of `at` is off by `noise` at most. `None` where no three steps in a row
/// lead anywhere.
///
/// Extrapolations agree with those from fewer steps where the map is smooth. Elsewhere two may agree by
/// accident: so it takes three steps, none counts as much better than those that it was made from, and two
/// much shorter steps must confirm the best. Next to a kink all agree on the mean of both slopes: so what
/// they leave of the kink is an error too.
fn derivative(
    at: impl Fn(f64) -> Option<Direction>,
    here: Direction,
    longest: f64,
    noise: f64,
) -> Option<Derivative> {
    let mut best: Option<Derivative> = None;
    let mut coarse: Vec<Difference> = Vec::new();
    let mut step = longest;
    for _ in 0..STEPS {
        let mut fine = Vec::with_capacity(STEPS);
        // Where nothing comes out, or something on the other side, steps are too long.
        if let (Some(forth), Some(back)) = (at(step), at(-step)) {
            fine.push(Difference::new(forth, here, back, step, noise));
            // Slopes err by even powers of the step, kinks by odd ones.
            let mut power = 4.0;
            for coarse in &coarse {
                let last = &fine[fine.len() - 1];
                let slope = extrapolated(coarse.slope, last.slope, power);
                let kink = extrapolated(coarse.kink, last.kink, 0.5 * power);
                let noise = (power * last.noise + coarse.noise) / (power - 1.0);
                let change = distance(slope, last.slope).max(distance(slope, coarse.slope));
                let change = change.max(last.change.max(coarse.change) / FASTEST);
                let error = 2.0 * (change + length(kink)) + noise;
                if fine.len() > 1 && best.as_ref().is_none_or(|best| error < best.error) {
                    best = Some(Derivative { value: slope, error });
                }
                fine.push(Difference { slope, kink, noise, change });
                power *= 4.0;
            }
        }
        coarse = fine;
        step *= 0.5;
    }
    let mut best = best?;
    let [fine, finer] = [FINEST, 0.5 * FINEST].map(|part| {
        let step = part * longest;
        Some(Difference::new(at(step)?, here, at(-step)?, step, noise))
    });
    let (fine, finer) = (fine?, finer?);
    // Two values at the point and one on either side make a kink, and half of the step doubles it.
    let kink = length(extrapolated(fine.kink, finer.kink, 2.0)) - 10.0 * fine.noise;
    let change = distance(best.value, fine.slope) - fine.noise;
    best.error += change.max(0.0) + 2.0 * kink.max(0.0);
    Some(best)
}

/// To step 0 from a step and half of it, where the error is `power` times smaller.
fn extrapolated(coarse: Direction, fine: Direction, power: f64) -> Direction {
    core::array::from_fn(|i| fine[i] + (fine[i] - coarse[i]) / (power - 1.0))
}

fn distance(a: Direction, b: Direction) -> f64 {
    length(core::array::from_fn(|i| a[i] - b[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The error of the derivative of a map along the x-axis, and its bound.
    fn errors(map: impl Fn(f64) -> f64, x: f64, exact: f64, noise: f64) -> [f64; 2] {
        let at = |step: f64| Some([map(x + step), 0.0, 0.0]);
        let found = derivative(at, [map(x), 0.0, 0.0], longest(x.min(1.0 - x)), noise).unwrap();
        [(found.value[0] - exact).abs(), found.error]
    }

    #[test]
    fn derivatives_of_smooth_maps_have_six_digits() {
        for i in 1..200 {
            let x = f64::from(i) / 256.0;
            let noise = 2.0 * f64::EPSILON;
            for (map, exact) in [
                (f64::sqrt as fn(f64) -> f64, 0.5 / x.sqrt()),
                (f64::sin, x.cos()),
                (f64::ln, 1.0 / x),
                (|x| (7.0 * x).exp(), 7.0 * (7.0 * x).exp()),
            ] {
                let [error, bound] = errors(map, x, exact, noise * map(x).abs().max(1.0));
                assert!(error <= bound && bound < 1e-6 * exact.abs().max(1.0), "{x}: {error:e} {bound:e}");
            }
        }
    }

    /// A kink, a jump or a change of curvature, at any distance from the point: at the point itself, inside
    /// the shortest step, between two steps, beyond the longest.
    #[test]
    fn a_kink_nearby_is_part_of_the_error() {
        for noise in [f64::EPSILON, 1e-7] {
            let mut blind = 0;
            for (i, x) in [0.003, 0.2, 0.47, 0.81].into_iter().enumerate() {
                for j in 0..2000 {
                    let distance = if j == 0 { 0.0 } else { libm::exp2(-f64::from(j) / 50.0) };
                    let sign = if j % 2 == 0 { 1.0 } else { -1.0 };
                    let change = [1.0, -0.7, 0.01, 20.0][(i + j as usize / 2) % 4];
                    let kink = x + sign * distance;
                    for power in 0..3 {
                        let rounded = |y: f64| if noise > 1e-10 { f64::from(y as f32) } else { y };
                        let beyond = |at: f64| if at > kink { change * (at - kink).powi(power) } else { 0.0 };
                        let map = |at: f64| rounded(at.sin() + beyond(at));
                        // At a kink itself neither slope is wrong, nor is anything between them.
                        let of = |power: i32, step: f64| f64::from(power) * step.powi(power - 1);
                        let slope = if x > kink && power > 0 { change * of(power, x - kink) } else { 0.0 };
                        let noise = noise * (1.0 + 2.0 * change.abs());
                        let [error, bound] = errors(map, x, x.cos() + slope, noise);
                        assert!(
                            error <= bound || bound > 0.5,
                            "{x} {power} {change} {distance:e}: {error:e} {bound:e}"
                        );
                        blind += u32::from(bound > WORST_ERROR);
                    }
                }
            }
            println!("noise {noise:e}: {blind} of 24000 not judged");
        }
    }

    #[test]
    fn pieces_are_those_of_the_thresholds() {
        for precision in [Precision::F32, Precision::F64] {
            for thresholds in [[0.04, 0.97], [1e-6, 0.5], [0.3, 0.999_999]] {
                let thresholds = thresholds.map(|x| precision.round(x));
                let found = pieces(precision, |uc| thresholds.iter().filter(|&&end| uc >= end).count());
                let [low, high] = thresholds;
                let expected = [low, high - low, 1.0 - high];
                assert_eq!(found.len(), 3);
                let mut start = 0.0;
                for (piece, expected) in found.iter().zip(expected) {
                    let error = (piece.probability - expected).abs();
                    assert!(error <= piece.error && piece.error < 5.0 * precision.epsilon(), "{error:e}");
                    assert!((start..start + expected).contains(&piece.inside));
                    start += expected;
                }
            }
            let [whole] = &pieces(precision, |_| ())[..] else { panic!("more than one piece") };
            assert_eq!((whole.probability, whole.error), (1.0, 0.0));
        }
    }
}

//! An adversarial search: walks directions, uniforms and parameters towards the worst value of a suite's own checks.
//!
//! First a sweep of the unit cube by the sequence of Halton (1960, <https://doi.org/10.1007/BF01386213>) with a random
//! shift, then a compass search from its best points (Kolda, Lewis & Torczon 2003,
//! <https://doi.org/10.1137/S003614450242889>). No derivatives: at rounding errors there are none.

use crate::plan::{Setting, sides};
use crate::specimen::{Direction, Parameter, Transport};
use crate::suite::{Examination, moved, normalized, tangents};
use crate::verdict::{Check, Ledger, MOST_PARAMETERS, Parameters, Witness};
use crate::{Claims, Precision};
use core::f64::consts::{FRAC_PI_2, TAU};
use rand::RngExt;
use rand_pcg::Pcg64;

/// How long a search goes on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Effort {
    /// Points of the sweep.
    pub(crate) sweep: usize,
    /// Best points of the sweep that are refined.
    pub(crate) starts: usize,
    /// Points of each refinement.
    pub(crate) steps: usize,
}

/// First step of a refinement along each axis of the cube, and the last, below which it ends.
const STEPS: [f64; 2] = [0.05, 1e-7];

/// The largest value in the unit cube that is found, and where. Ends early at an infinite one.
fn maximise(
    dimensions: usize,
    effort: Effort,
    generator: &mut Pcg64,
    mut value: impl FnMut(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let shift: Vec<f64> = (0..dimensions).map(|_| generator.random()).collect();
    let mut found: Vec<(f64, Vec<f64>)> = Vec::with_capacity(effort.sweep);
    for point in halton(&shift).take(effort.sweep) {
        let here = value(&point);
        found.push((here, point));
        if here == f64::INFINITY {
            break;
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    let has_ended = found.first().is_some_and(|&(value, _)| value == f64::INFINITY);
    found.truncate(if has_ended { 1 } else { effort.starts });
    for (best, point) in &mut found {
        refine(best, point, effort.steps, &mut value);
    }
    found.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((f64::NEG_INFINITY, shift))
}

/// A step along every axis in turn, forth and back, as long as one of them finds a larger value; then shorter ones.
pub(crate) fn refine(
    best: &mut f64,
    point: &mut [f64],
    evaluations: usize,
    value: &mut impl FnMut(&[f64]) -> f64,
) {
    let [mut step, smallest] = STEPS;
    let mut failures = 0;
    let moves = (0..point.len()).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]).cycle();
    for (axis, sign) in moves.take(evaluations) {
        if step < smallest || *best == f64::INFINITY {
            break;
        }
        let here = point[axis];
        point[axis] = (here + sign * step).clamp(0.0, 1.0);
        let there = value(point);
        if there > *best {
            (*best, failures) = (there, 0);
            continue;
        }
        point[axis] = here;
        failures += 1;
        if failures == 2 * point.len() {
            (step, failures) = (0.25 * step, 0);
        }
    }
}

/// The bases of the sequence, one per coordinate; the first coordinates are covered best.
const PRIMES: [u32; 16] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53];

/// The points of the Halton sequence, moved by `shift` modulo 1. It has no more than 16 coordinates.
pub(crate) fn halton(shift: &[f64]) -> impl Iterator<Item = Vec<f64>> {
    (0..).map(|i| shift.iter().zip(PRIMES).map(|(shift, base)| (shift + inverse(i, base)).fract()).collect())
}

/// The digits of `i` in a base, mirrored at the point.
fn inverse(mut i: u32, base: u32) -> f64 {
    let (mut sum, mut place) = (0.0, 1.0);
    while i > 0 {
        place /= f64::from(base);
        sum += place * f64::from(i % base);
        i /= base;
    }
    sum
}

/// The worst point found.
pub(crate) struct Found<const N: usize> {
    value: f64,
    /// Values of the parameters; none for the specimen as it is.
    pub(crate) parameters: Vec<f64>,
    /// Coordinates in the unit cube.
    pub(crate) point: [f64; N],
}

/// Searches the specimen as it is and then, if it is one of a family, the family.
///
/// `checks` makes the checks of one point of the cube and gives a value; what is maximised is the larger of that and the
/// most used limit of the checks. All checks on the way are recorded.
pub(crate) fn search<const N: usize>(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    purpose: &str,
    effort: Effort,
    checks: impl Fn(&Examination<'_>, &mut Ledger, [f64; N]) -> f64,
) -> Found<N> {
    let mut walk = |ranges: &[Parameter]| {
        let name = format!("{} | {purpose} search over {} parameters", examination.name, ranges.len());
        let values = |fractions: &[f64]| -> Vec<f64> {
            ranges.iter().zip(fractions).map(|(range, &fraction)| range.at(fraction)).collect()
        };
        let coordinates = |point: &[f64]| core::array::from_fn(|i| point[ranges.len() + i]);
        let mut generator = examination.plan.named_generator(&name);
        let (value, point) = maximise(ranges.len() + N, effort, &mut generator, |point| {
            check_member(examination, ledger, &values(point), |member, ledger| {
                checks(member, ledger, coordinates(point))
            })
        });
        Found { value, parameters: values(&point), point: coordinates(&point) }
    };
    let alone = walk(&[]);
    let Some(family) = examination.specimen.family() else { return alone };
    let (count, most) = (family.parameters().len(), MOST_PARAMETERS);
    if count > most {
        let what = "number of the family's parameters";
        ledger.record(Check::new(what, count as f64, most as f64, Witness::default()));
        return alone;
    }
    let member = walk(family.parameters());
    if member.value > alone.value { member } else { alone }
}

/// Makes checks of the specimen as it is or, given values of parameters, of that member of its family; the larger of the
/// value that they give and the most used limit.
pub(crate) fn check_member(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    values: &[f64],
    checks: impl FnOnce(&Examination<'_>, &mut Ledger) -> f64,
) -> f64 {
    let mut here = Ledger::default();
    let (value, parameters) = match examination.specimen.family() {
        Some(family) if !values.is_empty() => {
            let Some(member) = family.at(values) else { return f64::NEG_INFINITY };
            let member = Examination::new(&*member, examination.plan);
            (checks(&member, &mut here), Parameters::new(family.parameters(), values))
        }
        _ => (checks(examination, &mut here), Parameters::default()),
    };
    let used = here.used();
    ledger.absorb(here, parameters);
    if value.is_nan() { f64::INFINITY } else { value.max(used) }
}

/// Fractions of a coordinate that are spent on the neighbourhood of either end.
const ENDS: f64 = 0.2;
/// Cosine or sine where the neighbourhood of the tangent plane or of the normal begins.
const NEAR: f64 = 0.1;
/// The closest that a direction comes to the normal or to another direction \[rad\].
const CLOSEST: f64 = 1e-7;

/// From `far` down to `near` as x goes from 0 to 1, evenly in the logarithm.
fn logarithmic(x: f64, far: f64, near: f64) -> f64 {
    far * libm::pow(near / far, x)
}

/// A direction above the surface: the inner part of the first coordinate is even in solid angle, its ends are even in
/// the logarithm of the distance to the normal and of that to the tangent plane, down to the cosine `lowest`.
pub(crate) fn direction([polar, azimuth]: [f64; 2], lowest: f64, precision: Precision) -> Direction {
    let highest = (1.0 - NEAR * NEAR).sqrt();
    let (sine, cosine) = if polar < ENDS {
        let sine = logarithmic(1.0 - polar / ENDS, NEAR, CLOSEST);
        (sine, ((1.0 - sine) * (1.0 + sine)).sqrt())
    } else {
        let cosine = if polar > 1.0 - ENDS {
            logarithmic((polar - 1.0 + ENDS) / ENDS, NEAR, lowest)
        } else {
            highest + (NEAR - highest) * (polar - ENDS) / (1.0 - 2.0 * ENDS)
        };
        (((1.0 - cosine) * (1.0 + cosine)).sqrt(), cosine)
    };
    let (sin, cos) = libm::sincos(TAU * azimuth);
    // Rounded here, so that both orders of a pair are the same two directions.
    [sine * cos, sine * sin, cosine].map(|x| precision.round(x))
}

/// A direction about another one: even in the logarithm of the angle between them.
pub(crate) fn around(axis: Direction, [distance, azimuth]: [f64; 2], precision: Precision) -> Direction {
    let (sin, cos) = libm::sincos(logarithmic(distance, FRAC_PI_2, CLOSEST));
    let (sin_phi, cos_phi) = libm::sincos(TAU * azimuth);
    let [first, second] = tangents(axis);
    let across = moved(first.map(|x| cos_phi * x), second, sin_phi);
    normalized(moved(axis.map(|x| cos * x), across, sin)).map(|x| precision.round(x))
}

/// A uniform in \[0, 1) that is exact in the precision: even inside, even in the logarithm of the distance to the ends.
pub(crate) fn uniform(x: f64, precision: Precision) -> f64 {
    let below_one = 1.0 - 0.5 * precision.epsilon();
    let [end, near] = [0.5 * ENDS, 0.5 * precision.epsilon()];
    let u = if x < end {
        logarithmic(1.0 - x / end, end, near)
    } else if x > 1.0 - end {
        1.0 - logarithmic((x - 1.0 + end) / end, end, near)
    } else {
        x
    };
    precision.round(u).min(below_one)
}

/// A direction, its side and what is carried, from three coordinates.
pub(crate) fn setting(claims: &Claims, [polar, azimuth, choice]: [f64; 3], lowest: f64) -> Setting {
    let sides = sides(claims);
    let choice = (4.0 * choice) as usize;
    let transport = if choice.is_multiple_of(2) { Transport::Radiance } else { Transport::Importance };
    let [x, y, z] = direction([polar, azimuth], lowest, claims.precision);
    let from_above = sides[(choice / 2) % sides.len()];
    Setting { wo: [x, y, if from_above { z } else { -z }], transport, is_counted: false }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::Plan;

    #[test]
    fn halton_mirrors_digits() {
        let points: Vec<Vec<f64>> = halton(&[0.0, 0.5]).take(5).collect();
        let first = [0.0, 0.5, 0.25, 0.75, 0.125];
        let second = [0.0, 1.0 / 3.0, 2.0 / 3.0, 1.0 / 9.0, 4.0 / 9.0].map(|x: f64| (x + 0.5).fract());
        for (i, point) in points.iter().enumerate() {
            assert!(
                (point[0] - first[i]).abs() < 1e-15 && (point[1] - second[i]).abs() < 1e-15,
                "{points:?}"
            );
        }
    }

    #[test]
    fn a_narrow_peak_is_climbed_to_its_top() {
        let plan = Plan { run_seed: crate::run_seed(), samples: 0, family: 1 };
        let peak = [0.3, 0.71, 0.0, 1.0];
        let height = |point: &[f64]| {
            let squared: f64 = point.iter().zip(peak).map(|(x, top)| (x - top) * (x - top)).sum();
            libm::exp(-50.0 * squared)
        };
        let effort = Effort { sweep: 256, starts: 2, steps: 400 };
        let (value, point) = maximise(4, effort, &mut plan.named_generator("peak"), height);
        assert_eq!(value, height(&point));
        for (x, top) in point.iter().zip(peak) {
            assert!((x - top).abs() < 1e-4, "{point:?}");
        }
    }

    #[test]
    fn an_infinite_value_ends_the_walk() {
        let plan = Plan { run_seed: crate::run_seed(), samples: 0, family: 1 };
        let mut evaluations = 0;
        let effort = Effort { sweep: 256, starts: 2, steps: 400 };
        let (value, _) = maximise(2, effort, &mut plan.named_generator("end"), |_| {
            evaluations += 1;
            if evaluations == 7 { f64::INFINITY } else { 0.0 }
        });
        assert_eq!((value, evaluations), (f64::INFINITY, 7));
    }

    #[test]
    fn coordinates_reach_the_extremes() {
        for precision in [Precision::F32, Precision::F64] {
            let [normal, plane] = [0.0, 1.0].map(|polar| direction([polar, 0.3], 1e-7, precision));
            assert!(
                libm::hypot(normal[0], normal[1]) < 1.1 * CLOSEST && normal[2] > 1.0 - CLOSEST,
                "{normal:?}"
            );
            assert!((plane[2] - 1e-7).abs() < 1e-14, "{plane:?}");
            assert!(uniform(0.0, precision) <= precision.epsilon() && uniform(1.0, precision) < 1.0);
            for i in 0..=1000 {
                let x = f64::from(i) / 1000.0;
                let w = direction([x, x], 1e-30, precision);
                let length = w.iter().map(|x| x * x).sum::<f64>().sqrt();
                assert!((length - 1.0).abs() <= precision.epsilon() && w[2] > 0.0, "{w:?}");
            }
        }
    }
}

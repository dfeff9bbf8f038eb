//! Swapping the directions changes nothing, and swaps the transport mode.

use super::{Examination, normalized};
use crate::plan::Setting;
use crate::specimen::{Direction, Measure, Scatter, Transport};
use crate::survey::{draw, uniforms};
use crate::verdict::{Check, Ledger, Witness};
use rand_pcg::Pcg64;

/// Sampled directions per setting, where peaked lobes have their values.
const SAMPLED: usize = 128;
/// Pairs of directions anywhere, a third of them grazing.
const ANYWHERE: usize = 3000;

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    let (specimen, claims) = (examination.specimen, &examination.claims);
    for setting in examination.settings() {
        let mut generator = examination.plan.generator(&examination.name, &setting, "reciprocal");
        let mut sampled = Vec::new();
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLED, |uniforms, scatter| {
            sampled.extend(scatter.map(|scatter| (uniforms, scatter)));
        });
        let mut deltas: Vec<Direction> = Vec::new();
        for (uniforms, scatter) in sampled {
            match scatter.density {
                Measure::SolidAngle(_) => compare(examination, ledger, setting.wo, scatter.wi),
                // Once each: all samples of a delta are the same.
                Measure::Discrete(_) if deltas.contains(&scatter.wi) => {}
                Measure::Discrete(_) => {
                    deltas.push(scatter.wi);
                    compare_delta(examination, ledger, &setting, uniforms, &scatter);
                }
            }
        }
    }
    let mut generator = examination.plan.named_generator(&format!("{} | reciprocal", examination.name));
    for i in 0..ANYWHERE {
        let wo = anywhere(&mut generator, examination, i % 3 == 0);
        let wi = anywhere(&mut generator, examination, i % 2 == 0);
        compare(examination, ledger, wo, wi);
    }
}

/// A direction on the sphere, uniform or close to the tangent plane.
fn anywhere(generator: &mut Pcg64, examination: &Examination<'_>, grazing: bool) -> Direction {
    let [a, b, c] = uniforms(generator, examination.claims.precision);
    let z = 2.0 * a - 1.0;
    let z = if grazing { z * libm::exp(-16.0 * c) } else { z };
    let (sin, cos) = libm::sincos(core::f64::consts::TAU * b);
    let radius = ((1.0 - z) * (1.0 + z)).sqrt();
    let w = normalized([radius * cos, radius * sin, z]);
    // Rounded here, so that both orders of the pair are the same two directions.
    match examination.claims.precision {
        crate::Precision::F32 => w.map(|x| f64::from(x as f32)),
        crate::Precision::F64 => w,
    }
}

/// f_importance(a, b) = f_radiance(b, a), and on the same side f(a, b) = f(b, a).
fn compare(examination: &Examination<'_>, ledger: &mut Ledger, a: Direction, b: Direction) {
    let specimen = examination.specimen;
    let same_side = a[2] * b[2] > 0.0;
    let transports: &[Transport] =
        if same_side { &[Transport::Radiance, Transport::Importance] } else { &[Transport::Importance] };
    let backward = specimen.eval(b, a, Transport::Radiance);
    for &transport in transports {
        let forward = specimen.eval(a, b, transport);
        for channel in 0..3 {
            let (f, g) = (forward[channel], backward[channel]);
            if f == g {
                ledger.record(Check::new(WHAT, 0.0, 1.0, Witness::at(a, transport).with_wi(b)));
                continue;
            }
            let allowed = examination.rounding_error(b, f, |w| specimen.eval(a, w, transport)[channel])
                + examination.rounding_error(a, g, |w| specimen.eval(b, w, Transport::Radiance)[channel]);
            ledger.record(Check::new(WHAT, (f - g).abs(), allowed, Witness::at(a, transport).with_wi(b)));
        }
    }
}

const WHAT: &str = "f(wo, wi) against f(wi, wo) [1/sr]";

/// The power of a delta is the same in both directions, and what importance carries forth radiance carries back.
fn compare_delta(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    setting: &Setting,
    uniforms: [f64; 3],
    forth: &Scatter,
) {
    let witness = setting.witness().with_wi(forth.wi).with_uniforms(uniforms);
    let backward = match setting.transport {
        Transport::Radiance => Transport::Importance,
        Transport::Importance => Transport::Radiance,
    };
    let back = |wo: Direction| way_back(examination, wo, setting.wo, backward, uniforms);
    // The way back starts at a rounded direction. Near the critical angle rounding can close it, which is right if a
    // move of the direction opens it again; at grazing incidence it leads elsewhere.
    let reverse = back(forth.wi);
    let here = reverse.map_or([0.0; 3], |reverse| power(&reverse, backward));
    let epsilon = examination.claims.precision.epsilon();
    if let Some(reverse) = reverse {
        let miss = |w: Direction| back(w).map_or(f64::INFINITY, |scatter| distance(scatter.wi, setting.wo));
        let missed = distance(reverse.wi, setting.wo);
        let allowed = examination.rounding_error(forth.wi, missed, miss)
            + index_error(forth, epsilon, missed, miss)
            + 16.0 * epsilon;
        let what = "distance of a delta's way back from where it came";
        ledger.record(Check::new(what, missed, allowed, witness));
    }
    let there = power(forth, setting.transport);
    for channel in 0..3 {
        let value = |w: Direction| back(w).map_or(0.0, |scatter| power(&scatter, backward)[channel]);
        let allowed = examination.rounding_error(forth.wi, here[channel], value)
            + index_error(forth, epsilon, here[channel], value);
        let what = "power of a delta against its way back in the other transport mode";
        ledger.record(Check::new(what, (there[channel] - here[channel]).abs(), allowed, witness));
    }
}

/// How much `g` may change because the relative index is rounded: as much as when the tangential component of the
/// refracted direction, which is the index times that of the other side, moves by 4 ε.
///
/// Near η = 1 at grazing incidence that is far more than rounding the direction itself: 1/η is not the inverse of η
/// to the digits of η − 1.
fn index_error(delta: &Scatter, epsilon: f64, value: f64, g: impl Fn(Direction) -> f64) -> f64 {
    if delta.eta == 1.0 {
        return 0.0;
    }
    let [x, y, z] = delta.wi;
    [4.0 * epsilon, -4.0 * epsilon]
        .into_iter()
        .map(|step| {
            let cosine = (z * z - 2.0 * step * (x * x + y * y)).max(0.0).sqrt();
            (g([x * (1.0 + step), y * (1.0 + step), cosine.copysign(z)]) - value).abs()
        })
        .filter(|change| change.is_finite())
        .fold(0.0, f64::max)
}

/// What a delta carries per channel, in the measure of power: radiance is 1/η² of it.
fn power(delta: &Scatter, transport: Transport) -> [f64; 3] {
    let Measure::Discrete(probability) = delta.density else { return [f64::NAN; 3] };
    let gain = match transport {
        Transport::Radiance => delta.eta * delta.eta,
        Transport::Importance => 1.0,
    };
    delta.weight.map(|weight| weight * probability * gain)
}

/// The delta from `wo` that comes closest to `target`: a sweep over the component's uniform meets every delta of
/// more than 1/64; the uniforms of the way forth and the ends of the range meet rare ones.
fn way_back(
    examination: &Examination<'_>,
    wo: Direction,
    target: Direction,
    transport: Transport,
    [uc, u0, u1]: [f64; 3],
) -> Option<Scatter> {
    let last = 1.0 - 0.5 * examination.claims.precision.epsilon();
    (0..64)
        .map(|i| f64::from(i) / 64.0)
        .chain([last, uc])
        .filter_map(|uc| examination.specimen.sample(wo, [uc, u0, u1], transport))
        .filter(|scatter| matches!(scatter.density, Measure::Discrete(_)) && scatter.wi[2] * target[2] > 0.0)
        .min_by(|a, b| distance(a.wi, target).total_cmp(&distance(b.wi, target)))
}

fn distance(a: Direction, b: Direction) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

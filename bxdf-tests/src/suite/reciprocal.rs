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
        draw(specimen, &setting, claims.precision, &mut generator, SAMPLED, |scatter| {
            sampled.extend(scatter)
        });
        for scatter in sampled {
            match scatter.density {
                Measure::SolidAngle(_) => compare(examination, ledger, setting.wo, scatter.wi),
                Measure::Discrete(_) => compare_delta(examination, ledger, &setting, &scatter),
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

/// The power of a delta is the same in both directions. Across a boundary radiance carries η² more or less.
fn compare_delta(examination: &Examination<'_>, ledger: &mut Ledger, setting: &Setting, forth: &Scatter) {
    let (specimen, transport) = (examination.specimen, setting.transport);
    let witness = setting.witness().with_wi(forth.wi);
    let power = |scatter: &Scatter| -> [f64; 3] {
        let Measure::Discrete(probability) = scatter.density else { return [f64::NAN; 3] };
        let gain = match transport {
            Transport::Radiance => scatter.eta * scatter.eta,
            Transport::Importance => 1.0,
        };
        scatter.weight.map(|weight| weight * probability * gain)
    };
    let back = |wo: Direction, wi: Direction| -> Option<Scatter> {
        // One delta or the other, depending on the component: a sweep meets both.
        let closest = |scatter: &Scatter| (0..3).map(|i| (scatter.wi[i] - wi[i]).powi(2)).sum::<f64>();
        (0..64)
            .filter_map(|i| specimen.sample(wo, [f64::from(i) / 64.0, 0.5, 0.5], transport))
            .chain(specimen.sample(
                wo,
                [1.0 - 0.5 * examination.claims.precision.epsilon(), 0.5, 0.5],
                transport,
            ))
            .min_by(|a, b| closest(a).total_cmp(&closest(b)))
    };
    // The way back from the other side starts at a rounded direction, which near the critical angle or at
    // grazing incidence matters; so a neighbourhood of it is asked.
    let Some(reverse) = back(forth.wi, setting.wo) else {
        ledger.record(Check::new("a delta has no way back", f64::NAN, 0.0, witness));
        return;
    };
    let (a, b) = (power(forth), power(&reverse));
    for channel in 0..3 {
        let value = |w: Direction| back(w, setting.wo).map_or(f64::NAN, |scatter| power(&scatter)[channel]);
        let allowed = examination.rounding_error(forth.wi, b[channel], value);
        let what = "power of a delta against its way back";
        ledger.record(Check::new(what, (a[channel] - b[channel]).abs(), allowed, witness));
    }
}

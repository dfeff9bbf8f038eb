//! Swapping the directions changes nothing, and swaps the transport mode.

use super::{Examination, normalized};
use crate::deltas::{Deltas, distance};
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
                Measure::SolidAngle(_) => {
                    compare(examination, ledger, setting.wo, scatter.wi);
                    if setting.wo[2] * scatter.wi[2] < 0.0 {
                        compare_modes(examination, ledger, &setting, &scatter);
                    }
                }
                // Once per direction: all deltas that share it are compared together.
                Measure::Discrete(_) if deltas.contains(&scatter.wi) => {}
                Measure::Discrete(_) => {
                    deltas.push(scatter.wi);
                    compare_deltas(examination, ledger, &setting, uniforms, &scatter);
                    if setting.wo[2] * scatter.wi[2] < 0.0 {
                        compare_solid_angles(examination, ledger, &setting, uniforms, &scatter);
                    }
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
    w.map(|x| examination.claims.precision.round(x))
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

/// Importance carries η² times what radiance carries, η the index that the sample reports.
fn compare_modes(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    Setting { wo, transport, .. }: &Setting,
    scatter: &Scatter,
) {
    let value = |w: Direction, transport| examination.specimen.eval(*wo, w, transport);
    let importance = value(scatter.wi, Transport::Importance);
    let radiance = value(scatter.wi, Transport::Radiance);
    let squared = scatter.eta * scatter.eta;
    for channel in 0..3 {
        let (f, g) = (importance[channel], squared * radiance[channel]);
        let allowed = examination.rounding_error(scatter.wi, f, |w| value(w, Transport::Importance)[channel])
            + examination.rounding_error(scatter.wi, g, |w| squared * value(w, Transport::Radiance)[channel]);
        let what = "f of importance against η² f of radiance [1/sr]";
        let witness = Witness::at(*wo, *transport).with_wi(scatter.wi);
        ledger.record(Check::new(what, (f - g).abs(), allowed, witness));
    }
}

/// All deltas towards one direction together: their power is the same in both directions, and what importance carries
/// forth radiance carries back.
fn compare_deltas(
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
    let sweep = |wo, transport| {
        Deltas::sweep(examination.specimen, examination.claims.precision, wo, transport, uniforms)
    };
    // Where the way back leads, and with what power.
    let back = |w: Direction| {
        let deltas = sweep(w, backward);
        let wi = deltas.closest(setting.wo)?.scatter.wi;
        Some((wi, deltas.power_towards(wi, backward)))
    };
    // The way back starts at a rounded direction. Near the critical angle rounding can close it, which is right if a
    // move of the direction opens it again; at grazing incidence it leads elsewhere.
    let reverse = back(forth.wi);
    let epsilon = examination.claims.precision.epsilon();
    if let Some((wi, _)) = reverse {
        let miss = |w: Direction| back(w).map_or(f64::INFINITY, |(wi, _)| distance(wi, setting.wo));
        let missed = distance(wi, setting.wo);
        let allowed = examination.rounding_error(forth.wi, missed, miss)
            + index_error(forth, epsilon, missed, miss)
            + 16.0 * epsilon;
        let what = "distance of a delta's way back from where it came";
        ledger.record(Check::new(what, missed, allowed, witness));
    }
    let there = sweep(setting.wo, setting.transport).power_towards(forth.wi, setting.transport);
    let here = reverse.map_or([0.0; 3], |(_, power)| power);
    for channel in 0..3 {
        let value = |w: Direction| back(w).map_or(0.0, |(_, power)| power[channel]);
        let allowed = examination.rounding_error(forth.wi, here[channel], value)
            + index_error(forth, epsilon, here[channel], value);
        let what = "power of a delta against its way back in the other transport mode";
        ledger.record(Check::new(what, (there[channel] - here[channel]).abs(), allowed, witness));
    }
}

/// Move of the tangential components of `wo` that shows how a refraction squeezes solid angles.
const SQUEEZED: f64 = 1e-3;

/// The index that a refracted delta reports is the one that bends it: projected solid angle shrinks by η², whatever
/// the law of refraction, or radiance is not conserved.
///
/// dω |cos θ| is the area of the tangential components; so η² |∂(wi.x, wi.y) / ∂(wo.x, wo.y)| = 1.
fn compare_solid_angles(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    setting: &Setting,
    uniforms: [f64; 3],
    forth: &Scatter,
) {
    let [x, y, z] = setting.wo;
    let precision = examination.claims.precision;
    let sine = libm::hypot(x, y);
    let inward = if sine > 0.0 { [-x / sine, -y / sine] } else { [1.0, 0.0] };
    let sideways = [-inward[1], inward[0]];
    // How far the refracted direction moves when `wo` does. Moves lead away from the horizon, so none leaves it.
    let moves = [[1.0, 0.0], [0.7, 0.7]].map(|[a, b]: [f64; 2]| {
        let [dx, dy] = [0, 1].map(|i| SQUEEZED * (a * inward[i] + b * sideways[i]));
        let cosine = ((1.0 - (x + dx).powi(2)) - (y + dy).powi(2)).max(0.0).sqrt();
        let wo = [x + dx, y + dy, cosine.copysign(z)].map(|x| precision.round(x));
        let deltas = Deltas::sweep(examination.specimen, precision, wo, setting.transport, uniforms);
        let wi = deltas.closest(forth.wi).map(|delta| delta.scatter.wi);
        wi.map(|wi| [[wo[0] - x, wo[1] - y], [wi[0] - forth.wi[0], wi[1] - forth.wi[1]]])
    });
    let [Some(first), Some(second)] = moves else { return };
    let area = |side: usize| first[side][0] * second[side][1] - first[side][1] * second[side][0];
    let squeezed = (area(1) / area(0)).abs();
    let allowed = 128.0 * precision.epsilon() / SQUEEZED + 8.0 * SQUEEZED;
    let what = "η² of a refracted delta times how it squeezes solid angles, against 1";
    let witness = setting.witness().with_wi(forth.wi).with_uniforms(uniforms);
    ledger.record(Check::new(what, (forth.eta * forth.eta * squeezed - 1.0).abs(), allowed, witness));
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

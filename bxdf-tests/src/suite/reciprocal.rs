//! Swapping the directions changes nothing, and swaps the transport mode.

use super::{Examination, normalized};
use crate::deltas::{Deltas, distance};
use crate::plan::Setting;
use crate::search::{Effort, around, direction, search, setting, uniform};
use crate::specimen::{Direction, Measure, Scatter, Transport};
use crate::survey::{draw, uniforms};
use crate::verdict::{Check, Ledger, Witness};
use rand_pcg::Pcg64;

/// Sampled directions per setting, where peaked lobes have their values.
const SAMPLED: usize = 128;
/// Pairs of directions anywhere, a third of them grazing.
const ANYWHERE: usize = 3000;
/// Of the adversarial search.
const EFFORT: Effort = Effort { sweep: 2048, starts: 3, steps: 200 };
/// Of the search among deltas: each check follows several sweeps over all of them.
const EFFORT_DELTAS: Effort = Effort { sweep: 32, starts: 1, steps: 24 };
/// The lowest cosine that is searched.
const GRAZING: f64 = 1e-7;

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
            if let Measure::Discrete(_) = scatter.density {
                // Once per direction: all deltas that share it are compared together.
                if deltas.contains(&scatter.wi) {
                    continue;
                }
                deltas.push(scatter.wi);
            }
            compare_sample(examination, ledger, &setting, uniforms, &scatter);
        }
    }
    let mut generator = examination.plan.named_generator(&format!("{} | reciprocal", examination.name));
    for i in 0..ANYWHERE {
        let wo = anywhere(&mut generator, examination, i % 3 == 0);
        let wi = anywhere(&mut generator, examination, i % 2 == 0);
        compare(examination, ledger, wo, wi);
    }
    search(examination, ledger, "reciprocal", EFFORT, |examination, ledger, [a, b, c, u, v, w]| {
        let (specimen, precision) = (examination.specimen, examination.claims.precision);
        let setting = setting(&examination.claims, [a, b, c], GRAZING);
        let wo @ [x, y, z] = setting.wo;
        compare(examination, ledger, wo, around([-x, -y, z], [u, v], precision));
        let [i, j, k] = direction([u, v], GRAZING, precision);
        compare(examination, ledger, wo, [i, j, if w < 0.5 { k } else { -k }]);
        let uniforms = [u, v, w].map(|u| uniform(u, precision));
        let sample = specimen.sample(wo, uniforms, setting.transport);
        if let Some(scatter @ Scatter { density: Measure::SolidAngle(_), .. }) = sample {
            compare_sample(examination, ledger, &setting, uniforms, &scatter);
        }
        0.0
    });
    search(examination, ledger, "reciprocal delta", EFFORT_DELTAS, |examination, ledger, [a, b, c, u]| {
        let setting = setting(&examination.claims, [a, b, c], GRAZING);
        let uniforms = [uniform(u, examination.claims.precision), 0.5, 0.5];
        let sample = examination.specimen.sample(setting.wo, uniforms, setting.transport);
        if let Some(scatter @ Scatter { density: Measure::Discrete(_), .. }) = sample {
            compare_deltas(examination, ledger, &setting, uniforms, &scatter);
        }
        0.0
    });
}

/// A sampled direction, or all deltas towards it.
pub(super) fn compare_sample(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    setting: &Setting,
    uniforms: [f64; 3],
    scatter: &Scatter,
) {
    let crosses = setting.wo[2] * scatter.wi[2] < 0.0;
    match scatter.density {
        Measure::SolidAngle(_) => {
            compare(examination, ledger, setting.wo, scatter.wi);
            if crosses {
                compare_modes(examination, ledger, setting, uniforms, scatter);
            }
        }
        Measure::Discrete(_) => {
            compare_deltas(examination, ledger, setting, uniforms, scatter);
            if crosses {
                compare_solid_angles(examination, ledger, setting, uniforms, scatter);
            }
        }
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
pub(super) fn compare(examination: &Examination<'_>, ledger: &mut Ledger, a: Direction, b: Direction) {
    let specimen = examination.specimen;
    let same_side = a[2] * b[2] > 0.0;
    let transports: &[Transport] =
        if same_side { &[Transport::Radiance, Transport::Importance] } else { &[Transport::Importance] };
    let backward = specimen.eval(b, a, Transport::Radiance);
    for &transport in transports {
        let forward = specimen.eval(a, b, transport);
        let witness = Witness::at(a, transport).with_wi(b);
        if forward == backward {
            ledger.record(Check::new(WHAT, 0.0, 1.0, witness));
            continue;
        }
        let forth = examination.rounding_errors(b, forward, |w| specimen.eval(a, w, transport));
        let back = examination.rounding_errors(a, backward, |w| specimen.eval(b, w, Transport::Radiance));
        for channel in 0..3 {
            let (difference, allowed) =
                ((forward[channel] - backward[channel]).abs(), forth[channel] + back[channel]);
            ledger.record(Check::new(WHAT, difference, allowed, witness));
        }
    }
}

const WHAT: &str = "f(wo, wi) against f(wi, wo) [1/sr]";

/// Importance carries η² times what radiance carries, η the index that the sample reports.
fn compare_modes(
    examination: &Examination<'_>,
    ledger: &mut Ledger,
    setting: &Setting,
    uniforms: [f64; 3],
    scatter: &Scatter,
) {
    let squared = scatter.eta * scatter.eta;
    let value = |w: Direction, transport| examination.specimen.eval(setting.wo, w, transport);
    let importance = |w: Direction| value(w, Transport::Importance);
    let radiance = |w: Direction| value(w, Transport::Radiance).map(|f| squared * f);
    let (forth, back) = (importance(scatter.wi), radiance(scatter.wi));
    let allowed = [
        examination.rounding_errors(scatter.wi, forth, importance),
        examination.rounding_errors(scatter.wi, back, radiance),
    ];
    for channel in 0..3 {
        let what = "f of importance against η² f of radiance [1/sr]";
        let witness = setting.witness().with_wi(scatter.wi).with_uniforms(uniforms);
        let difference = (forth[channel] - back[channel]).abs();
        ledger.record(Check::new(what, difference, allowed[0][channel] + allowed[1][channel], witness));
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
    // How far the way back misses where it came from, and its power per channel.
    let back = |w: Direction| {
        let deltas = sweep(w, backward);
        let Some(wi) = deltas.closest(setting.wo).map(|delta| delta.scatter.wi) else {
            return [f64::INFINITY, 0.0, 0.0, 0.0];
        };
        let [r, g, b] = deltas.power_towards(wi, backward);
        [distance(wi, setting.wo), r, g, b]
    };
    // The way back starts at a rounded direction. Near the critical angle rounding can close it, which is right if a
    // move of the direction opens it again; at grazing incidence it leads elsewhere.
    let reverse = back(forth.wi);
    let epsilon = examination.claims.precision.epsilon();
    let rounding = examination.rounding_errors(forth.wi, reverse, back);
    let bending = examination.index_errors(forth, [0.0, 0.0, 1.0], reverse, back);
    let allowed: [f64; 4] = core::array::from_fn(|i| rounding[i] + bending[i]);
    let missed = reverse[0];
    if missed.is_finite() {
        let what = "distance of a delta's way back from where it came";
        ledger.record(Check::new(what, missed, allowed[0] + 16.0 * epsilon, witness));
    }
    let there = sweep(setting.wo, setting.transport).power_towards(forth.wi, setting.transport);
    for channel in 0..3 {
        let what = "power of a delta against its way back in the other transport mode";
        let difference = (there[channel] - reverse[1 + channel]).abs();
        ledger.record(Check::new(what, difference, allowed[1 + channel], witness));
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

//! Why `wo` and `wi` cannot be exchanged: bugs that are symmetric in neither the directions nor the transport
//! modes.
//!
//! f of importance is compared with f of radiance on the way back, which reciprocity makes the same, and on
//! the same way, where it is η² of it; deltas by their power. Logarithms of both ratios are fitted together,
//! point by point.

use super::{
    Diagnosis, EXPLAINED_EXACTLY, LEAST_COSINE, LEAST_RATIO, Pair, Roughness, constant, points, rounded,
};
use crate::deltas::{Deltas, distance};
use crate::plan::Setting;
use crate::specimen::{Direction, Transport};
use crate::suite::{Examination, fresnel_reference};

/// How far the way back of a delta may miss where it came from.
const MISSED: f64 = 1e-3;

/// What one channel of f says at a pair of directions, or the power of a delta.
struct Exchange {
    pair: Pair,
    /// ln of importance over radiance on the way back, and over η² radiance on the same way.
    measured: [f64; 2],
}

/// A bug of `eval`.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Bug {
    /// cos θi over cos θo, to a power.
    Cosines(i32),
    /// Smith's masking of `wo` over that of `wi`, to a power.
    Masking(i32),
    /// Fresnel's transmittance along `wo` over that along `wi`, into a coat of this index, to a power.
    Coat(i32, f64),
    /// How often radiance and importance are divided by η²: once and not at all, if all is right.
    Squared(i32, i32),
    /// A factor of importance, or the inverse of one of radiance.
    Constant(f64),
}

impl Bug {
    /// What the bug makes of the measured numbers; not a number where it cannot be said.
    fn predicts(self, roughness: Option<Roughness>, pair: &Pair) -> [f64; 2] {
        let ln_ratio = |of: &dyn Fn(f64) -> f64| libm::log(of(pair.cos_o) / of(pair.cos_i));
        match self {
            Self::Cosines(n) => [-f64::from(n) * ln_ratio(&|cosine| cosine), 0.0],
            Self::Masking(n) => {
                let masking = |cosine| roughness.map_or(f64::NAN, |model| model.g1(model.alpha, cosine));
                [f64::from(n) * ln_ratio(&masking), 0.0]
            }
            Self::Coat(n, eta) if pair.is_reflection => {
                let transmittance = |cosine| {
                    let [s, p] = fresnel_reference(cosine, eta, 0.0);
                    1.0 - 0.5 * (s + p)
                };
                [f64::from(n) * ln_ratio(&transmittance), 0.0]
            }
            Self::Squared(radiance, importance) if !pair.is_reflection => {
                // η of the way back is the inverse.
                let powers = [1 - importance - radiance, radiance - importance - 1];
                powers.map(|n| f64::from(n) * libm::log(pair.eta * pair.eta))
            }
            Self::Constant(factor) => [libm::log(factor); 2],
            Self::Coat(..) | Self::Squared(..) => [0.0; 2],
        }
    }

    /// What is wrong, which ratio shows it, and what that is.
    fn told(self, roughness: Option<Roughness>, is_delta: bool) -> [String; 3] {
        let place = if is_delta { "the weight of a delta" } else { "eval()" };
        let (back, modes) = if is_delta {
            ("power of a delta / power of its way back", "power of a delta in importance / in radiance")
        } else {
            ("f(wo, wi) / f(wi, wo)", "f of importance / (η² f of radiance)")
        };
        // The direction that has something once too often, or the other one has it once too rarely.
        let names = |n: i32| if n > 0 { ["wo", "wi"] } else { ["wi", "wo"] };
        let [bug, ratio, model] = match self {
            Self::Cosines(n) => {
                let [one, other] = names(-n).map(|name| name.replace('w', "cos θ"));
                [
                    format!("the cosine {one} is once too often in {place}, or {other} is missing"),
                    back.to_owned(),
                    format!("{one} / {other}"),
                ]
            }
            Self::Masking(n) => {
                let ([one, other], alpha) = (names(n), roughness.map_or(f64::NAN, |model| model.alpha));
                [
                    format!("masking of {other} is missing in {place}, or that of {one} is once too often"),
                    back.to_owned(),
                    format!("G1({one}) / G1({other}), α = {},", rounded(alpha)),
                ]
            }
            Self::Coat(n, eta) => {
                let [one, other] = names(n);
                [
                    format!(
                        "the base of a coat is not symmetric: the transmittance along {other} is missing in \
                         {place}, or that along {one} is once too often"
                    ),
                    back.to_owned(),
                    format!("T({one}) / T({other}), T into a coat of index {},", rounded(eta)),
                ]
            }
            Self::Squared(radiance, importance) => {
                let wrong = match (radiance, importance) {
                    (0, 0) => "is missing for radiance",
                    (-1, 0) => "is inverted for radiance",
                    (0, _) => "is in the wrong transport mode",
                    (1, _) => "is applied to both transport modes",
                    _ => "is once too often for radiance",
                };
                let power = match radiance - importance - 1 {
                    -2 => "1/η⁴",
                    -1 => "1/η²",
                    _ => "η²",
                };
                [
                    format!("η² of refraction {wrong} in {place}"),
                    modes.to_owned(),
                    format!("{power} across the boundary"),
                ]
            }
            Self::Constant(factor) => [
                format!("a constant factor is wrong for one transport mode in {place}"),
                modes.to_owned(),
                constant(factor),
            ],
        };
        [bug, ratio, model]
    }
}

/// The values of f at sampled pairs of directions.
fn of_values(examination: &Examination<'_>, settings: &[Setting]) -> Vec<Exchange> {
    let specimen = examination.specimen;
    let exchanges = points(examination, settings).into_iter().flat_map(|point| {
        let (pair, eta) = (point.pair, if point.pair.is_reflection { 1.0 } else { point.pair.eta });
        let forth = specimen.eval(pair.wo, pair.wi, Transport::Importance);
        let back = specimen.eval(pair.wi, pair.wo, Transport::Radiance);
        let other = specimen.eval(pair.wo, pair.wi, Transport::Radiance).map(|f| eta * eta * f);
        exchange(pair, forth, back, other)
    });
    exchanges.collect()
}

/// The powers of deltas.
fn of_deltas(examination: &Examination<'_>, settings: &[Setting]) -> Vec<Exchange> {
    let sweep = |wo: Direction, transport| {
        Deltas::sweep(examination.specimen, examination.claims.precision, wo, transport, [0.5; 3])
    };
    let wos = settings.iter().map(|setting| setting.wo).filter(|wo| wo[2].abs() > LEAST_COSINE);
    let exchanges = wos.flat_map(|wo| {
        let [importance, radiance] =
            [Transport::Importance, Transport::Radiance].map(|transport| sweep(wo, transport));
        let of_delta = |wi: Direction, eta: f64| {
            let back = sweep(wi, Transport::Radiance);
            let returned = back.closest(wo)?.scatter.wi;
            let forth = importance.power_towards(wi, Transport::Importance);
            let other = radiance.power_towards(wi, Transport::Radiance);
            let back = back.power_towards(returned, Transport::Radiance);
            (distance(returned, wo) < MISSED).then(|| exchange(Pair::new(wo, wi, eta), forth, back, other))
        };
        let exchanges: Vec<_> =
            importance.iter().filter_map(|delta| of_delta(delta.scatter.wi, delta.scatter.eta)).collect();
        exchanges.into_iter().flatten()
    });
    exchanges.collect()
}

/// The channels in which nothing is 0.
fn exchange(pair: Pair, forth: [f64; 3], back: [f64; 3], other: [f64; 3]) -> Vec<Exchange> {
    let channels = (0..3).filter(|&i| forth[i] > 0.0 && back[i] > 0.0 && other[i] > 0.0);
    let ln = |i: usize| [back, other].map(|below| libm::log(forth[i] / below[i]));
    channels.map(|i| Exchange { pair, measured: ln(i) }).collect()
}

/// The bug that explains why exchanging the directions changes something; `settings` give `wo`.
pub(crate) fn of_exchange(
    examination: &Examination<'_>,
    settings: &[Setting],
    roughness: Option<Roughness>,
) -> Option<Diagnosis> {
    let of_values = || explain(&of_values(examination, settings), roughness, false);
    of_values().or_else(|| explain(&of_deltas(examination, settings), roughness, true))
}

fn explain(exchanges: &[Exchange], roughness: Option<Roughness>, is_delta: bool) -> Option<Diagnosis> {
    let numbers = || exchanges.iter().flat_map(|exchange| exchange.measured);
    let (before, count) = (numbers().map(|y| y * y).sum::<f64>(), 2 * exchanges.len());
    if count == 0 || before < count as f64 * LEAST_RATIO * LEAST_RATIO {
        return None;
    }
    let rest = |bug: Bug| {
        let left = exchanges.iter().map(|Exchange { pair, measured: [a, b] }| {
            let [x, y] = bug.predicts(roughness, pair);
            (a - x) * (a - x) + (b - y) * (b - y)
        });
        left.sum::<f64>()
    };
    let factor = libm::exp(numbers().sum::<f64>() / count as f64);
    let simple = [
        Bug::Constant(factor),
        Bug::Cosines(1),
        Bug::Cosines(-1),
        Bug::Squared(0, 0),
        Bug::Squared(-1, 0),
        Bug::Squared(2, 0),
        Bug::Squared(0, 1),
        Bug::Squared(1, 1),
        Bug::Masking(1),
        Bug::Masking(-1),
    ];
    let coats = [1, -1].map(|n| Bug::Coat(n, index(|eta| rest(Bug::Coat(n, eta)))));
    let fits = simple.into_iter().chain(coats).map(|bug| (bug, rest(bug)));
    let fits: Vec<_> = fits.filter(|(_, rest)| rest.is_finite()).collect();
    let best = fits.iter().map(|&(_, rest)| rest).fold(f64::INFINITY, f64::min);
    let &(bug, rest) = fits.iter().find(|&&(_, rest)| rest <= best + 1e-4 * before)?;
    let explained = 1.0 - rest / before;
    if explained.is_nan() || explained < EXPLAINED_EXACTLY {
        return None;
    }
    let [bug, ratio, model] = bug.told(roughness, is_delta);
    Some(Diagnosis { bug, ratio, model, explained })
}

/// The index of a coat, up to 4, that leaves least.
fn index(rest: impl Fn(f64) -> f64) -> f64 {
    let least = |etas: &mut dyn Iterator<Item = f64>| {
        etas.min_by(|&a, &b| rest(a).total_cmp(&rest(b))).unwrap_or(f64::NAN)
    };
    let mut step = 0.05;
    let mut eta = least(&mut (1..=60).map(|i| 1.0 + step * f64::from(i)));
    while step > 1e-4 {
        step *= 0.5;
        eta = least(&mut [eta, eta - step, eta + step].into_iter());
    }
    eta
}

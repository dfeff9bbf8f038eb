//! Maps from random numbers to normals and directions.

use bxdf_tests::Precision;

use super::big::{Big, big, erfc, exact, frac_1_sqrt_pi, pi, square};
use super::geometry::direction;
use super::{Axis, Form, Region, Term};
use crate::microfacet::{ALPHA_MIN, beckmann, ggx};
use crate::real::{Real, Vector};
use crate::warp::{cosine_hemisphere, power_lobe, uniform_cap};

/// Random numbers: from the smallest step of the generator to the largest below 1.
fn uniform(precision: Precision) -> [f64; 2] {
    let step = 0.5 * precision.epsilon();
    [step, 1.0 - step]
}

/// A random number is what it is: nothing was rounded to get it, so that a map of it alone has no excuse.
const RANDOM: usize = 0;

pub(super) fn terms() -> Vec<Term> {
    vec![
        Term {
            name: "sampling/turn_sine",
            statement: "sine of a random azimuth",
            inputs: &["u"],
            variables: RANDOM,
            range: "u in [0, 1)",
            exact: |x| Some(exact(&turn(x[0]).0)),
            regions: uniforms,
            forms: forms![
                stable "polynomial over quarter turns" sine_of_turn,
                control "sin(2π u) of the rounded product" sine_of_product,
            ],
        },
        Term {
            name: "sampling/cap_sine",
            statement: "sine of a uniform direction in a cap",
            inputs: &["u", "height"],
            variables: RANDOM,
            range: "u in [0, 1), heights in [1e-3, 2]",
            exact: |x| {
                let q = big(x[0]) * big(x[1]);
                (0.0..1.0).contains(&x[0]).then(|| exact(&(&q * (big(2.0) - &q)).sqrt()))
            },
            regions: |precision| {
                let [low, high] = uniform(precision);
                vec![Region {
                    name: "next to the pole",
                    axes: vec![Axis::logarithmic("u", low, high), Axis::logarithmic("height", 1e-3, 2.0)],
                    inputs: |x| x.to_vec(),
                }]
            },
            forms: forms![
                stable "√(q (2 − q))" cap_sine,
                control "√(1 − z²)" cap_sine_of_cosine,
            ],
        },
        Term {
            name: "sampling/cosine_hemisphere_z",
            statement: "cosine of a cosine-weighted direction",
            inputs: &["u0", "u1"],
            variables: RANDOM,
            range: "u in [0, 1)",
            exact: |x| (0.0..1.0).contains(&x[0]).then(|| exact(&(big(1.0) - big(x[0])).sqrt())),
            regions: |precision| {
                let [low, high] = uniform(precision);
                vec![Region {
                    name: "next to the horizon",
                    axes: vec![Axis::logarithmic("1 − u0", low, high), Axis::linear("u1", 0.0, high)],
                    inputs: |x| vec![1.0 - x[0], x[1]],
                }]
            },
            forms: forms![
                stable "√(1 − u)" cosine_z,
                control "√(1 − x² − y²)" cosine_z_of_disk,
            ],
        },
        Term {
            name: "sampling/power_lobe_sine",
            statement: "sine of a direction of density ((1 + cos θ)/2)ᵖ, p = 16",
            inputs: &["u"],
            variables: RANDOM,
            range: "u in (0, 1)",
            exact: |x| {
                let rest = -((big(x[0]).ln() / big(17.0)).exp_m1());
                (x[0] > 0.0 && x[0] < 1.0).then(|| exact(&(big(2.0) * (&rest * (big(1.0) - &rest)).sqrt())))
            },
            regions: uniforms,
            forms: forms![
                stable "m = −expm1(ln u / (p + 1))" power_sine,
                control "m = 1 − u^(1/(p + 1))" power_sine_of_power,
            ],
        },
        Term {
            name: "sampling/gaussian_slope",
            statement: "slope of a Gaussian normal seen from above",
            inputs: &["u"],
            variables: RANDOM,
            range: "u in [0, 1)",
            exact: |x| (0.0..1.0).contains(&x[0]).then(|| exact(&(-((-big(x[0])).ln_1p())).sqrt())),
            regions: uniforms,
            forms: forms![
                stable "√(−ln1p(−u))" gaussian_slope,
                control "√(−ln(1 − u))" gaussian_slope_of_logarithm,
            ],
        },
        Term {
            name: "sampling/beckmann_slope",
            statement: "slope of the visible Beckmann normal",
            inputs: &["cot θ", "u"],
            variables: 2,
            range: "cot θ in [1e-6, 1e6], slopes in [−5, 5]",
            exact: |x| beckmann_slope(x[0], x[1]).map(|slope| exact(&slope)),
            regions: |precision| {
                let [_, high] = uniform(precision);
                vec![Region {
                    name: "all slopes",
                    axes: vec![Axis::logarithmic("cot θ", 1e-6, 1e6), Axis::linear("u", 0.0, high)],
                    inputs: |x| x.to_vec(),
                }]
            },
            forms: forms![
                stable "Newton steps inside a bracket" slope_of_newton,
                control "three steps from Winitzki's erf⁻¹" slope_of_three_steps,
            ],
        },
        visible_normal(
            "sampling/visible_normal_x",
            "x of GGX's visible normal at unit roughness",
            0,
            forms![
                stable "|s| ŝ + cap, of any length" visible_x,
            ],
        ),
        visible_normal(
            "sampling/visible_normal_z",
            "z of GGX's visible normal at unit roughness",
            2,
            forms![
                stable "(1 − u) (|s| + s.z)" visible_z,
                control "z of the cap + s.z" visible_z_of_sum,
            ],
        ),
    ]
}

fn uniforms(precision: Precision) -> Vec<Region> {
    let [low, high] = uniform(precision);
    vec![
        Region { name: "u next to 0", axes: vec![Axis::logarithmic("u", low, high)], inputs: |x| x.to_vec() },
        Region {
            name: "u next to 1",
            axes: vec![Axis::logarithmic("1 − u", low, high)],
            inputs: |x| vec![1.0 - x[0]],
        },
    ]
}

/// A component of GGX's visible normal.
fn visible_normal(name: &'static str, statement: &'static str, component: usize, forms: Vec<Form>) -> Term {
    Term {
        name,
        statement,
        inputs: &["s.x", "s.y", "s.z", "u0", "u1"],
        variables: 5,
        range: "α in [1e-4, 1], directions from above and from grazing below, u in [0, 1)",
        exact: match component {
            0 => |x| visible(x).map(|[x, ..]| exact(&x)),
            _ => |x| visible(x).map(|[.., z]| exact(&z)),
        },
        regions: |precision| {
            let [low, high] = uniform(precision);
            vec![Region {
                name: "grazing incidence",
                axes: vec![
                    Axis::linear("θ", 0.0, 1.58),
                    Axis::logarithmic("u0", low, high),
                    Axis::logarithmic("α", ALPHA_MIN, 1.0),
                    Axis::linear("u1", 0.0, high),
                ],
                inputs: |x| {
                    let [wx, wy, wz] = direction(x[0], 0.7);
                    vec![x[2] * wx, x[2] * wy, wz, x[1], x[3]]
                },
            }]
        },
        forms,
    }
}

/// sin 2πu and cos 2πu.
fn turn(u: f64) -> (Big, Big) {
    (big(2.0) * pi() * big(u)).sin_cos()
}

/// |s| times the sum of ŝ and of the direction of the uniforms in the cap above −ŝ.z.
fn visible(x: &[f64]) -> Option<[Big; 3]> {
    if !(0.0..1.0).contains(&x[3]) || !(0.0..1.0).contains(&x[4]) {
        return None;
    }
    let [sx, sy, sz, u0] = [x[0], x[1], x[2], x[3]].map(big);
    let length = (square(&sx) + square(&sy) + square(&sz)).sqrt();
    let height = &length + &sz;
    let below = &u0 * &height;
    let radius = (&below * (big(2.0) * &length - &below)).sqrt();
    let (sin, cos) = turn(x[4]);
    Some([&radius * cos + sx, radius * sin + sy, (big(1.0) - u0) * height])
}

/// The slope s with I(s) = u I(min(c, 7)), I(s) = ½ [c erfc(−s) + e^{−s²} / √π], by Newton's steps from the double that
/// solves it; `None` beyond ±5, where the density is below 1e-10 of its peak.
fn beckmann_slope(c: f64, u: f64) -> Option<Big> {
    if !(c > 0.0 && (0.0..1.0).contains(&u)) {
        return None;
    }
    let start = beckmann::invert_slope(c, u);
    let c = big(c);
    if start.abs() > 5.0 {
        return None;
    }
    let gaussian = |s: &Big| (-square(s)).exp() * frac_1_sqrt_pi();
    let integral = |s: &Big| (&c * erfc(&-s) + gaussian(s)) / big(2.0);
    let end = if c < big(7.0) { c.clone() } else { big(7.0) };
    let target = big(u) * integral(&end);
    let mut slope = big(start);
    for _ in 0..3 {
        let derivative = (&c - &slope) * gaussian(&slope);
        if derivative <= Big::ZERO {
            return None;
        }
        slope = &slope - (integral(&slope) - &target) / derivative;
    }
    Some(slope)
}

fn sine_of_turn<F: Real>(x: &[F]) -> F {
    x[0].sin_cos_turns().0
}

fn sine_of_product<F: Real>(x: &[F]) -> F {
    (F::TWO * F::PI * x[0]).sin_cos().0
}

fn cap_sine<F: Real>(x: &[F]) -> F {
    // At azimuth 0.
    uniform_cap::<F>([x[0], F::ZERO], x[1]).x()
}

fn cap_sine_of_cosine<F: Real>(x: &[F]) -> F {
    let z = F::ONE - x[0] * x[1];
    (F::ONE - z * z).sqrt()
}

fn cosine_z<F: Real>(x: &[F]) -> F {
    cosine_hemisphere::<F>([x[0], x[1]]).z()
}

fn cosine_z_of_disk<F: Real>(x: &[F]) -> F {
    let w = cosine_hemisphere::<F>([x[0], x[1]]);
    (F::ONE - w.x() * w.x() - w.y() * w.y()).max(F::ZERO).sqrt()
}

fn power_sine<F: Real>(x: &[F]) -> F {
    power_lobe::<F>([x[0], F::ZERO], 16).x()
}

fn power_sine_of_power<F: Real>(x: &[F]) -> F {
    let m = F::ONE - (x[0].ln() / F::from_f64(17.0)).exp();
    F::TWO * (m * (F::ONE - m)).sqrt()
}

fn gaussian_slope<F: Real>(x: &[F]) -> F {
    beckmann::slope_along_normal(x[0])
}

fn gaussian_slope_of_logarithm<F: Real>(x: &[F]) -> F {
    (-(F::ONE - x[0]).ln()).sqrt()
}

fn slope_of_newton<F: Real>(x: &[F]) -> F {
    beckmann::invert_slope(x[0], x[1])
}

/// A fixed number of steps, as in Heitz & d'Eon's and Mitsuba's samplers.
fn slope_of_three_steps<F: Real>(x: &[F]) -> F {
    let [c, u] = [x[0], x[1]];
    let integral = |s: F| F::HALF * (c * (-s).erfc() + (-s * s).exp() / F::PI.sqrt());
    let end = c.min(F::from_f64(7.0));
    let target = u * integral(end);
    let mut s = beckmann::guess_slope(c, u).min(end);
    for _ in 0..3 {
        s = s - (integral(s) - target) / ((c - s) * (-s * s).exp() / F::PI.sqrt());
    }
    s
}

fn visible_of<F: Real>(x: &[F]) -> F::Vec3 {
    ggx::sample_visible_unit::<F>(F::Vec3::new(x[0], x[1], x[2]), [x[3], x[4]])
}

fn visible_x<F: Real>(x: &[F]) -> F {
    visible_of(x).x()
}

fn visible_z<F: Real>(x: &[F]) -> F {
    visible_of(x).z()
}

/// Dupuy & Benyoub 2023, as printed, times |s|.
fn visible_z_of_sum<F: Real>(x: &[F]) -> F {
    let length = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt();
    let z = (F::ONE - x[3]) * (F::ONE + x[2] / length) - x[2] / length;
    (z + x[2] / length) * length
}

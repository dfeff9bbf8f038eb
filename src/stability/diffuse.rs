//! Diffuse lobes.

use bxdf_tests::Precision;

use super::big::{Big, big, exact, pi, square};
use super::geometry::{at_cosine, tangent};
use super::{Axis, Form, Region, Term};
use crate::bxdf::{Bxdf as _, TransportMode};
use crate::lobe::{Fabric, OrenNayar, OrenNayarModel, fabric_power, oren_nayar_loss};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

const DIRECTION: &[&str] = &["w.x", "w.y", "w.z"];

/// The exponent of the fabric that is measured.
const EXPONENT: u32 = 4;

pub(super) fn terms() -> Vec<Term> {
    vec![
        Term {
            name: "diffuse/oren_nayar",
            statement: "qualitative Oren-Nayar at reflectance 1",
            inputs: &["wo.x", "wo.y", "wo.z", "wi.x", "wi.y", "wi.z", "σ"],
            variables: 6,
            range: "σ in [0, π/2], directions off the tangent plane",
            exact: |x| (x[2] > 0.0 && x[5] > 0.0).then(|| exact(&oren_nayar(x))),
            regions: |precision| {
                vec![Region {
                    name: "both grazing",
                    axes: vec![
                        Axis::logarithmic("cos θo", tangent(precision), 0.5),
                        Axis::logarithmic("cos θi", tangent(precision), 0.5),
                        Axis::linear("difference of azimuths", 0.0, 3.1),
                        Axis::linear("σ", 0.0, 1.57),
                    ],
                    inputs: |x| [&at_cosine(x[0], 0.3)[..], &at_cosine(x[1], 0.3 + x[2]), &[x[3]]].concat(),
                }]
            },
            forms: forms![
                stable "(xo xi + yo yi) / max(cos θo, cos θi)" oren_nayar_of_components,
                control "cos φ sin α tan β from angles" oren_nayar_of_angles,
            ],
        },
        Term {
            name: "diffuse/eon_loss",
            statement: "1 − E of Fujii's Oren-Nayar, over A r / π",
            inputs: DIRECTION,
            variables: 3,
            range: "any direction off the tangent plane",
            exact: |x| (x[2] > 0.0).then(|| exact(&eon_loss(x))),
            regions: |precision| {
                vec![Region {
                    name: "grazing to normal",
                    axes: vec![
                        Axis::logarithmic("cos θ", tangent(precision), 1.0),
                        Axis::linear("azimuth", 0.0, 6.3),
                    ],
                    inputs: |x| at_cosine(x[0], x[1]).to_vec(),
                }]
            },
            forms: forms![
                stable "(1 − S)(π/2 − 2/3) + S (asin µ − …)" eon_loss_in_use,
                control "1 − E as published, (S/µ)(1 − S³) − S" eon_loss_as_published,
            ],
        },
        Term {
            name: "diffuse/fabric_loss",
            statement: "1 − Ê of the fabric's lobe, p = 4",
            inputs: DIRECTION,
            variables: 3,
            range: "any direction off the normal",
            exact: |x| (x[2] > 0.0 && x[2] < 1.0).then(|| exact(&fabric_loss(x))),
            regions: |precision| {
                vec![Region {
                    name: "normal incidence",
                    axes: vec![
                        Axis::logarithmic("1 − cos θ", precision.epsilon(), 0.9),
                        Axis::linear("azimuth", 0.0, 6.3),
                    ],
                    inputs: |x| {
                        // 1 − cos² has the digits that the cosine lost.
                        let sin_theta = (x[0] * (2.0 - x[0])).sqrt();
                        let (sin_phi, cos_phi) = libm::sincos(x[1]);
                        vec![sin_theta * cos_phi, sin_theta * sin_phi, 1.0 - x[0]]
                    },
                }]
            },
            forms: forms![
                stable "sin² θ / (1 + µ) times a polynomial" fabric_loss_in_use,
                control "1 − E(µ) / E(1)" fabric_loss_by_difference,
            ],
        },
        Term {
            name: "diffuse/fabric_lobe",
            statement: "((1 + wo·wi)/2)⁴",
            inputs: &["wo.x", "wo.y", "wo.z", "wi.x", "wi.y", "wi.z"],
            variables: 6,
            range: "any two directions",
            exact: |x| {
                let sum = (0..3).fold(big(0.0), |sum, i| sum + square(&(big(x[i]) + big(x[3 + i]))));
                Some(exact(&square(&square(&(sum / big(4.0))))))
            },
            regions: |precision| {
                let smallest = match precision {
                    Precision::F32 => 1e-3,
                    Precision::F64 => 1e-7,
                };
                vec![Region {
                    name: "opposite directions",
                    axes: vec![
                        Axis::logarithmic("angle to −wo", smallest, 3.0),
                        Axis::logarithmic("cos θo", 1e-6, 1.0),
                    ],
                    inputs: |x| {
                        let wo = at_cosine(x[1], 0.4);
                        // −wo turned about the second tangent.
                        let (sin, cos) = libm::sincos(x[0]);
                        let wi = [-wo[0] * cos + wo[2] * sin, -wo[1], -wo[2] * cos - wo[0] * sin];
                        [wo, wi].concat()
                    },
                }]
            },
            forms: forms![
                stable "|wo + wi|² / 4" fabric_lobe_in_use,
                control "(1 + wo·wi) / 2" fabric_lobe_of_dot,
            ],
        },
    ]
}

fn oren_nayar(x: &[f64]) -> Big {
    let [xo, yo, zo, xi, yi, zi, sigma] = [0, 1, 2, 3, 4, 5, 6].map(|i| big(x[i]));
    let variance = square(&sigma);
    let a = big(1.0) - &variance / (big(2.0) * (&variance + decimal(33)));
    let b = decimal(45) * &variance / (&variance + decimal(9));
    let s = xo * xi + yo * yi;
    let t = if zo > zi { zo } else { zi };
    let slant = if s > Big::ZERO { s / t } else { big(0.0) };
    (a + b * slant) / pi()
}

/// Hundredths, as the model prints them.
fn decimal(hundredths: u8) -> Big {
    big(f64::from(hundredths)) / big(100.0)
}

fn eon_loss(x: &[f64]) -> Big {
    let sine = (square(&big(x[0])) + square(&big(x[1]))).sqrt();
    let mu = big(x[2]);
    let above = big(1.0) + &sine;
    let one_minus_sine = square(&mu) / &above;
    let two_thirds = big(2.0) / big(3.0);
    let product = &mu * &one_minus_sine * (big(2.0) + &sine) / (big(3.0) * above);
    one_minus_sine * (pi() / big(2.0) - two_thirds) + &sine * (mu.atan2(&sine) - product)
}

/// (1 − Ê) / (1 − µ) times sin² / (1 + µ), E from the moments of its definition.
fn fabric_loss(x: &[f64]) -> Big {
    let (one, mu) = (big(1.0), big(x[2]));
    let sin2 = square(&big(x[0])) + square(&big(x[1]));
    let (peak, here) = (fabric_albedo(&one), fabric_albedo(&mu));
    sin2 / (&one + &mu) * (&peak - here) / (peak * (one - mu))
}

/// 2⁴ E(µ) = Σ C(4, k) ∫ (cos γ)ᵏ, γ the angle between both directions, over projected solid angle / π.
fn fabric_albedo(mu: &Big) -> Big {
    // Σ_j C(k, 2j) µᵏ⁻²ʲ (1 − µ²)ʲ C(2j, j) / 4ʲ B((k − 2j)/2 + 1, j + 1), times C(4, k), by hand.
    let (one, mu2) = (big(1.0), square(mu));
    let rest = &one - &mu2;
    let fraction = |numerator: f64, denominator: f64| big(numerator) / big(denominator);
    let first = fraction(2.0, 3.0) * mu;
    let second = &mu2 / big(2.0) + &rest / big(4.0);
    let third = mu * (fraction(2.0, 5.0) * &mu2 + fraction(2.0, 5.0) * &rest);
    let fourth = square(&mu2) / big(3.0) + &mu2 * &rest / big(2.0) + square(&rest) / big(8.0);
    one + big(4.0) * first + big(6.0) * second + big(4.0) * third + fourth
}

fn first<F: Real>(x: &[F]) -> F::Vec3 {
    F::Vec3::new(x[0], x[1], x[2])
}

fn second<F: Real>(x: &[F]) -> F::Vec3 {
    F::Vec3::new(x[3], x[4], x[5])
}

fn oren_nayar_of_components<F: Real>(x: &[F]) -> F {
    OrenNayar::new(OrenNayarModel::Qualitative, Rgb::WHITE, x[6])
        .map_or(F::NAN, |lobe| lobe.eval(first(x), second(x), TransportMode::Radiance)[0])
}

/// As printed: max(0, cos φ) sin α tan β, α ≥ β, from the angles.
fn oren_nayar_of_angles<F: Real>(x: &[F]) -> F {
    let f = F::from_f64;
    let variance = x[6] * x[6];
    let (a, b) =
        (F::ONE - F::HALF * variance / (variance + f(0.33)), f(0.45) * variance / (variance + f(0.09)));
    let [theta_o, theta_i] = [x[2], x[5]].map(|z| (F::ONE - z * z).sqrt().atan2(z));
    let phi = x[1].atan2(x[0]) - x[4].atan2(x[3]);
    let (alpha, beta) = (theta_o.max(theta_i), theta_o.min(theta_i));
    let (sin_beta, cos_beta) = beta.sin_cos();
    (a + b * phi.sin_cos().1.max(F::ZERO) * alpha.sin_cos().0 * sin_beta / cos_beta) / F::PI
}

fn eon_loss_in_use<F: Real>(x: &[F]) -> F {
    oren_nayar_loss::<F>(first(x))
}

/// Portsmouth, Kutz & Hill 2025: π/2 − 2/3 less G = S (acos µ − S µ) + ⅔ ((S/µ)(1 − S³) − S).
fn eon_loss_as_published<F: Real>(x: &[F]) -> F {
    let mu = x[2];
    let sine = (F::ONE - mu * mu).sqrt();
    let two_thirds = F::from_f64(2.0 / 3.0);
    let g = sine * (sine.atan2(mu) - sine * mu)
        + two_thirds * ((sine / mu) * (F::ONE - sine * sine * sine) - sine);
    F::HALF * F::PI - two_thirds - g
}

fn fabric_loss_in_use<F: Real>(x: &[F]) -> F {
    Fabric::new(Rgb::WHITE, F::ONE, EXPONENT).map_or(F::NAN, |fabric| fabric.missing(first(x)))
}

fn fabric_loss_by_difference<F: Real>(x: &[F]) -> F {
    let mu = x[2];
    let (mu2, rest) = (mu * mu, F::ONE - mu * mu);
    let f = F::from_f64;
    let albedo = F::ONE
        + f(8.0 / 3.0) * mu
        + f(6.0) * (F::HALF * mu2 + f(0.25) * rest)
        + f(1.6) * mu * (mu2 + rest)
        + (mu2 * mu2 / f(3.0) + F::HALF * mu2 * rest + f(0.125) * rest * rest);
    F::ONE - albedo / f(8.6)
}

fn fabric_lobe_in_use<F: Real>(x: &[F]) -> F {
    fabric_power::<F>(first(x), second(x), EXPONENT)
}

fn fabric_lobe_of_dot<F: Real>(x: &[F]) -> F {
    (F::HALF * (F::ONE + first(x).dot(second(x)))).squared().squared()
}

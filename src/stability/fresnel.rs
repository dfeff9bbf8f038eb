//! Reflection at smooth boundaries.

use bxdf_tests::Precision;
use bxdf_tests::stability::Exact;

use super::big::{Big, big, exact};
use super::geometry::tangent;
use super::{Axis, Form, Region, Term};
use crate::fresnel::{conductor, dielectric};
use crate::real::Real;

pub(super) fn terms() -> Vec<Term> {
    let (of_dielectric, of_conductor): (&[&str], &[&str]) = (&["cos θ", "η"], &["cos θ", "η", "k"]);
    let dielectrics = "cos θ from the tangent plane (2⁻⁵² in f32, 2⁻⁵⁰⁰ in f64) to 1, η in [1/4, 4]";
    let conductors =
        "cos θ from the tangent plane (2⁻⁵² in f32, 2⁻⁵⁰⁰ in f64) to 1, η in [0, 4], k in [0, 20]";
    vec![
        Term {
            name: "fresnel/dielectric_reflectance",
            statement: "R between dielectrics, unpolarised",
            inputs: of_dielectric,
            variables: 1,
            range: dielectrics,
            exact: |x| exact_dielectric(x, |boundary| boundary.reflectance),
            regions: dielectric_regions,
            forms: forms![
                stable "r = (1 − η²) / (c + g)²" reflectance,
                control "r = (c − η cos θt) / (c + η cos θt)" reflectance_of_amplitudes,
            ],
        },
        Term {
            name: "fresnel/dielectric_transmittance",
            statement: "T between dielectrics, unpolarised",
            inputs: of_dielectric,
            variables: 1,
            range: dielectrics,
            exact: |x| exact_dielectric(x, |boundary| boundary.transmittance),
            regions: dielectric_regions,
            forms: forms![
                stable "4 c g / (c + g)²" transmittance,
                control "1 − R" rest_of_reflectance,
            ],
        },
        Term {
            name: "fresnel/refracted_cosine",
            statement: "cosine of the refracted direction",
            inputs: of_dielectric,
            variables: 1,
            range: dielectrics,
            exact: |x| exact_dielectric(x, |boundary| boundary.cos_theta_t),
            regions: dielectric_regions,
            forms: forms![
                stable "√((η − 1)(η + 1) + c²) / η" refracted_cosine,
                control "√(1 − sin² θ / η²)" refracted_cosine_of_sine,
            ],
        },
        Term {
            name: "fresnel/conductor_reflectance",
            statement: "R of a conductor, unpolarised",
            inputs: of_conductor,
            variables: 1,
            range: conductors,
            exact: |x| exact_conductor(x, |boundary| boundary.reflectance),
            regions: conductor_regions,
            forms: forms![
                stable "|N² − 1|² / ((a + c)² + b²)²; a b = η k" conductor_reflectance,
                control "both roots by difference" conductor_reflectance_of_differences,
            ],
        },
        Term {
            name: "fresnel/conductor_absorptance",
            statement: "1 − R of a conductor, unpolarised",
            inputs: of_conductor,
            variables: 1,
            range: conductors,
            exact: |x| exact_conductor(x, |boundary| boundary.absorptance),
            regions: conductor_regions,
            forms: forms![
                stable "4 a c / ((a + c)² + b²)" absorptance,
                control "1 − R" rest_of_conductor,
                control "1 − R, both roots by difference" rest_of_differences,
            ],
        },
    ]
}

fn dielectric_regions(precision: Precision) -> Vec<Region> {
    let epsilon = precision.epsilon();
    vec![
        Region {
            name: "grazing incidence",
            axes: vec![
                Axis::logarithmic("cos θ", tangent(precision), 0.1),
                Axis::logarithmic("η", 0.25, 4.0),
            ],
            inputs: |x| x.to_vec(),
        },
        Region {
            name: "normal incidence",
            axes: vec![Axis::logarithmic("1 − cos θ", 0.5 * epsilon, 0.5), Axis::logarithmic("η", 0.25, 4.0)],
            inputs: |x| vec![1.0 - x[0], x[1]],
        },
        Region {
            name: "nearly matched media",
            axes: vec![
                Axis::logarithmic("|η − 1|", epsilon, 0.5),
                Axis::logarithmic("cos θ", 1e-3, 1.0),
                Axis::among("side", [-1.0, 1.0]),
            ],
            inputs: |x| vec![x[1], 1.0 + x[2] * x[0]],
        },
        Region {
            name: "critical angle",
            axes: vec![
                Axis::logarithmic("distance of cos θ", epsilon, 0.1),
                Axis::linear("η", 0.25, 0.999),
                Axis::among("side", [-1.0, 1.0]),
            ],
            inputs: |x| {
                let critical = ((1.0 - x[1]) * (1.0 + x[1])).sqrt();
                vec![(critical * (1.0 + x[2] * x[0])).min(1.0), x[1]]
            },
        },
    ]
}

fn conductor_regions(precision: Precision) -> Vec<Region> {
    let indices = [0.0, 1e-3, 0.05, 0.6, 1.0, 1.5, 4.0];
    vec![
        Region {
            name: "grazing incidence",
            axes: vec![
                Axis::logarithmic("cos θ", tangent(precision), 0.1),
                Axis::logarithmic("k", 1e-30, 20.0),
                Axis::among("η", indices),
            ],
            inputs: |x| vec![x[0], x[2], x[1]],
        },
        Region {
            name: "normal incidence",
            axes: vec![
                Axis::logarithmic("1 − cos θ", 0.5 * precision.epsilon(), 1.0),
                Axis::logarithmic("k", 1e-30, 20.0),
                Axis::among("η", indices),
            ],
            inputs: |x| vec![1.0 - x[0], x[2], x[1]],
        },
        Region {
            name: "nearly matched media",
            axes: vec![
                Axis::logarithmic("|η − 1|", precision.epsilon(), 0.5),
                Axis::logarithmic("k", 1e-12, 1.0),
                Axis::among("side", [-1.0, 1.0]),
                Axis::logarithmic("cos θ", 1e-3, 1.0),
            ],
            inputs: |x| vec![x[3], 1.0 + x[2] * x[0], x[1]],
        },
        Region {
            name: "no extinction",
            axes: vec![Axis::logarithmic("cos θ", 1e-6, 1.0), Axis::linear("η", 0.25, 4.0)],
            inputs: |x| vec![x[0], x[1], 0.0],
        },
    ]
}

/// What is exact of a boundary of dielectrics.
pub(super) struct Dielectric {
    pub(super) reflectance: Big,
    pub(super) transmittance: Big,
    pub(super) cos_theta_t: Big,
}

fn exact_dielectric(x: &[f64], of: fn(Dielectric) -> Big) -> Option<Exact> {
    dielectric_boundary(x[0], x[1]).map(|boundary| exact(&of(boundary)))
}

/// The boundary for a cosine and an index; `None` outside the domain.
pub(super) fn dielectric_boundary(cos_theta: f64, eta: f64) -> Option<Dielectric> {
    if !(0.0..=1.0).contains(&cos_theta) || eta <= 0.0 || (cos_theta == 0.0 && eta == 1.0) {
        return None;
    }
    let (one, c, eta) = (big(1.0), big(cos_theta), big(eta));
    let bend = (&eta - &one) * (&eta + &one);
    let g_squared = &bend + &c * &c;
    if g_squared <= Big::ZERO {
        return Some(Dielectric { reflectance: one, transmittance: big(0.0), cos_theta_t: big(0.0) });
    }
    let g = g_squared.sqrt();
    let sum = &c + &g;
    let r_s = bend / (&sum * &sum);
    let sin2 = (&one - &c) * (&one + &c);
    let cg = &c * &g;
    let ratio = (&cg - &sin2) / (&cg + &sin2);
    let eta2 = &eta * &eta;
    let p_sum = &eta2 * &c + &g;
    // Of both polarisations half.
    let transmittance = big(2.0) * &cg * (big(1.0) / (&sum * &sum) + eta2 / (&p_sum * &p_sum));
    let reflectance = &r_s * &r_s * (one + &ratio * &ratio) / big(2.0);
    Some(Dielectric { reflectance, transmittance, cos_theta_t: g / eta })
}

struct Conductor {
    reflectance: Big,
    absorptance: Big,
}

fn exact_conductor(x: &[f64], of: fn(Conductor) -> Big) -> Option<Exact> {
    if !(0.0..=1.0).contains(&x[0]) || x[1] < 0.0 || x[2] < 0.0 {
        return None;
    }
    let (one, c, eta, k) = (big(1.0), big(x[0]), big(x[1]), big(x[2]));
    let sin2 = (&one - &c) * (&one + &c);
    let real = &eta * &eta - &k * &k - &sin2;
    let half_imaginary = &eta * &k;
    let modulus = (&real * &real + big(4.0) * &half_imaginary * &half_imaginary).sqrt();
    // The smaller root from the product of both.
    let larger =
        if real >= Big::ZERO { (modulus + &real) / big(2.0) } else { (modulus - &real) / big(2.0) }.sqrt();
    let smaller = if larger == Big::ZERO { big(0.0) } else { half_imaginary / &larger };
    let (a, b) = if real >= Big::ZERO { (larger, smaller) } else { (smaller, larger) };
    let square = |x: Big| &x * &x;
    let b2 = square(b);
    let (sum, difference) = (square(&a + &c) + &b2, square(&a - &c) + &b2);
    let (ac, bc2) = (&a * &c, &b2 * &c * &c);
    let (p_sum, p_difference) = (square(&ac + &sin2) + &bc2, square(&ac - &sin2) + &bc2);
    if sum == Big::ZERO || p_sum == Big::ZERO {
        return None;
    }
    let r_s = difference / &sum;
    let four_ac = big(4.0) * ac;
    let a_s = &four_ac / sum;
    let reflectance = &r_s * (one + p_difference / &p_sum) / big(2.0);
    let absorptance = a_s + r_s * four_ac * sin2 / p_sum / big(2.0);
    Some(exact(&of(Conductor { reflectance, absorptance })))
}

fn reflectance<F: Real>(x: &[F]) -> F {
    dielectric(x[0], x[1]).reflectance.unpolarized()
}

fn transmittance<F: Real>(x: &[F]) -> F {
    dielectric(x[0], x[1]).transmittance.unpolarized()
}

fn refracted_cosine<F: Real>(x: &[F]) -> F {
    dielectric(x[0], x[1]).cos_theta_t
}

fn refracted_cosine_of_sine<F: Real>(x: &[F]) -> F {
    let sin2_theta_t = (F::ONE - x[0] * x[0]) / (x[1] * x[1]);
    if sin2_theta_t < F::ONE { (F::ONE - sin2_theta_t).sqrt() } else { F::ZERO }
}

/// Born & Wolf, *Principles of Optics*, §1.5.2 (21a), squared.
fn reflectance_of_amplitudes<F: Real>(x: &[F]) -> F {
    let (c, eta, cos_t) = (x[0], x[1], refracted_cosine_of_sine(x));
    let s = (c - eta * cos_t) / (c + eta * cos_t);
    let p = (eta * c - cos_t) / (eta * c + cos_t);
    F::HALF * (s * s + p * p)
}

fn rest_of_reflectance<F: Real>(x: &[F]) -> F {
    F::ONE - reflectance(x)
}

fn conductor_reflectance<F: Real>(x: &[F]) -> F {
    conductor(x[0], x[1], x[2]).reflectance.unpolarized()
}

fn absorptance<F: Real>(x: &[F]) -> F {
    conductor(x[0], x[1], x[2]).absorptance.unpolarized()
}

/// The textbook's a² + b² and 2a cos θ, with a from the difference of the modulus and the real part.
fn conductor_reflectance_of_differences<F: Real>(x: &[F]) -> F {
    let (c, eta, k) = (x[0], x[1], x[2]);
    let (c2, s2) = (c * c, F::ONE - c * c);
    let real = eta * eta - k * k - s2;
    let modulus = (real * real + F::FOUR * eta * eta * k * k).sqrt();
    let a = (F::HALF * (modulus + real)).max(F::ZERO).sqrt();
    let twice = F::TWO * a * c;
    let s = (modulus + c2 - twice) / (modulus + c2 + twice);
    let (t3, t4) = (modulus * c2 + s2 * s2, twice * s2);
    F::HALF * s * (F::ONE + (t3 - t4) / (t3 + t4))
}

fn rest_of_conductor<F: Real>(x: &[F]) -> F {
    F::ONE - conductor_reflectance(x)
}

fn rest_of_differences<F: Real>(x: &[F]) -> F {
    F::ONE - conductor_reflectance_of_differences(x)
}

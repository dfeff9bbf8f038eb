//! Densities of micro normals, masking and shadowing, and the lobes made of them.

use bxdf_tests::Precision;

use super::big::{Big, beta, big, erfc, exact, exp_minus, frac_1_sqrt_pi, pi, square};
use super::geometry::{at_cosine, direction, tangent};
use super::{Axis, Form, Region, Term};
use crate::microfacet::{ALPHA_MIN, Distribution, RefractingFacet, Shadowing, Shape, gaussian};
use crate::real::{Real, Vector};
use crate::special;

const NORMAL: &[&str] = &["m.x", "m.y", "m.z", "αx", "αy"];
const DIRECTION: &[&str] = &["w.x", "w.y", "w.z", "αx", "αy"];
const PAIR: &[&str] = &["wo.x", "wo.y", "wo.z", "wi.x", "wi.y", "wi.z", "αx", "αy"];
const ROUGHNESS: &str = "α in [1e-4, 1], each axis; directions off the tangent plane";

pub(super) fn terms() -> Vec<Term> {
    let mut terms = normals();
    terms.extend(masking());
    terms.extend(scattering());
    terms
}

fn normals() -> Vec<Term> {
    vec![
        Term {
            name: "microfacet/ggx_d",
            statement: "D of GGX",
            inputs: NORMAL,
            variables: 5,
            range: ROUGHNESS,
            exact: |x| facing(x).map(|()| exact(&ggx_d(x))),
            regions: normal_regions,
            forms: forms![
                stable "over (m.x/αx)² + (m.y/αy)² + m.z²" d_of_ggx,
                control "over n·m" d_of_ggx_by_cosine,
                control "over tan² θ = 1/cos² θ − 1" d_of_ggx_by_tangent,
            ],
        },
        Term {
            name: "microfacet/beckmann_d",
            statement: "D of Beckmann",
            inputs: NORMAL,
            variables: 5,
            range: ROUGHNESS,
            exact: |x| facing(x).map(|()| exact(&beckmann_d(x))),
            regions: normal_regions,
            forms: forms![
                stable "exp(−((m.x/αx)² + (m.y/αy)²)/m.z²) / m.z⁴" d_of_beckmann,
                control "over tan² θ = 1/cos² θ − 1" d_of_beckmann_by_tangent,
            ],
        },
        Term {
            name: "microfacet/gaussian_d",
            statement: "D of the Gaussian over its peak",
            inputs: NORMAL,
            variables: 5,
            range: ROUGHNESS,
            exact: |x| facing(x).map(|()| exact(&gaussian_d(x))),
            regions: normal_regions,
            forms: forms![
                stable "θ from atan2(√(x² + y²), z)" d_of_gaussian,
                control "θ from atan2(√(1 − z²), z)" d_of_gaussian_by_cosine,
            ],
        },
    ]
}

fn masking() -> Vec<Term> {
    vec![
        Term {
            name: "microfacet/ggx_projected_area",
            statement: "σ of GGX, what a direction sees of the facets",
            inputs: DIRECTION,
            variables: 3,
            range: "α in [1e-4, 1]; any direction",
            exact: |x| Some(exact(&ggx_area(&x[..3], &x[3..]))),
            regions: area_regions,
            forms: forms![
                stable "½ (z + √(z² + s²)); below, s² over the difference" area_of_ggx,
                control "½ (z + √(z² + s²))" area_of_ggx_by_sum,
            ],
        },
        Term {
            name: "microfacet/beckmann_projected_area",
            statement: "σ of Beckmann",
            inputs: DIRECTION,
            variables: 3,
            range: "α in [1e-4, 1]; from grazing from below (cot θ > −2α) up",
            exact: |x| Some(exact(&beckmann_area(&x[..3], &x[3..]))),
            regions: slope_regions,
            forms: forms![
                stable "½ (z erfc(−a) + s exp(−a²)/√π), a = z/s" area_of_beckmann,
                control "z / G₁, G₁ rational (Walter 2007)" area_of_beckmann_by_rational_g1,
            ],
        },
        Term {
            name: "microfacet/ggx_lambda",
            statement: "Λ of GGX",
            inputs: DIRECTION,
            variables: 3,
            range: ROUGHNESS,
            exact: |x| above(&x[..3]).map(|()| exact(&(ggx_area(&x[..3], &x[3..]) / big(x[2]) - big(1.0)))),
            regions: slope_regions,
            forms: forms![
                stable "½ t / (1 + √(1 + t)), t = s²/z²" lambda_of_ggx,
                control "½ (√(1 + t) − 1)" lambda_of_ggx_by_difference,
            ],
        },
        Term {
            name: "microfacet/beckmann_lambda",
            statement: "Λ of Beckmann",
            inputs: DIRECTION,
            variables: 3,
            range: "α in [1e-4, 1]; cot θ up to 5α, beyond which Λ < 1e-13",
            exact: |x| above(&x[..3]).and_then(|()| beckmann_lambda(&x[..3], &x[3..])).map(|x| exact(&x)),
            regions: slope_regions,
            forms: forms![
                stable "½ (exp(−a²)/(a √π) − erfc a), a = z/s" lambda_of_beckmann,
                control "½ (erf a − 1 + exp(−a²)/(a √π))" lambda_of_beckmann_by_erf,
            ],
        },
        Term {
            name: "microfacet/ggx_g1",
            statement: "G₁ of GGX after Smith",
            inputs: DIRECTION,
            variables: 3,
            range: ROUGHNESS,
            exact: |x| above(&x[..3]).map(|()| exact(&(big(x[2]) / ggx_area(&x[..3], &x[3..])))),
            regions: slope_regions,
            forms: forms![stable "cos θ / σ" g1_of_ggx,],
        },
        Term {
            name: "microfacet/beckmann_g1",
            statement: "G₁ of Beckmann after Smith",
            inputs: DIRECTION,
            variables: 3,
            range: ROUGHNESS,
            exact: |x| above(&x[..3]).map(|()| exact(&(big(x[2]) / beckmann_area(&x[..3], &x[3..])))),
            regions: slope_regions,
            forms: forms![
                stable "cos θ / σ" g1_of_beckmann,
                control "rational (Walter 2007)" rational_g1_of_beckmann,
            ],
        },
        Term {
            name: "microfacet/correlated_g2",
            statement: "G₂ of reflection, GGX, height-correlated Smith",
            inputs: PAIR,
            variables: 6,
            range: ROUGHNESS,
            exact: |x| {
                let (area, wo, wi) = areas(x)?;
                Some(exact(&(&wo * &wi / (&area[1] * &wo + (&area[0] - &wo) * &wi))))
            },
            regions: pair_regions,
            forms: forms![
                stable "cos cos / (σi cos θo + (σo − cos θo) cos θi)" correlated_g2,
            ],
        },
        Term {
            name: "microfacet/separable_g2",
            statement: "G₂ of reflection, GGX, separable Smith",
            inputs: PAIR,
            variables: 6,
            range: ROUGHNESS,
            exact: |x| {
                let (area, wo, wi) = areas(x)?;
                Some(exact(&(wo * wi / (&area[0] * &area[1]))))
            },
            regions: pair_regions,
            forms: forms![stable "cos cos / (σo σi)" separable_g2,],
        },
        Term {
            name: "microfacet/v_cavity_g2",
            statement: "G₂ of V-cavities about the half vector",
            inputs: PAIR,
            variables: 6,
            range: ROUGHNESS,
            exact: |x| {
                let (_, wo, wi) = areas(x)?;
                // Of h any length will do: it is above and below the line.
                let h: Vec<Big> = (0..3).map(|i| big(x[i]) + big(x[3 + i])).collect();
                let facing = (0..3).fold(big(0.0), |sum, i| sum + &h[i] * big(x[i]));
                let facing_wi = (0..3).fold(big(0.0), |sum, i| sum + &h[i] * big(x[3 + i]));
                let masking = big(2.0) * &h[2] * wo / facing;
                let shadowing = big(2.0) * &h[2] * wi / facing_wi;
                Some(exact(&masking.min(shadowing).min(big(1.0))))
            },
            regions: pair_regions,
            forms: forms![stable "min(1, 2 cos θh cos θ / (w·h))" v_cavity_g2,],
        },
        Term {
            name: "microfacet/transmission_g2",
            statement: "G₂ of transmission, B(1 + Λo, 1 + Λi)",
            inputs: &["1 + Λo", "1 + Λi"],
            variables: 2,
            range: "Λ from 0 to 1e12",
            exact: |x| (x[0] >= 1.0 && x[1] >= 1.0).then(|| exact(&beta(&big(x[0]), &big(x[1])))),
            regions: |_| {
                vec![Region {
                    name: "all Λ",
                    axes: vec![Axis::logarithmic("Λo", 1e-6, 1e12), Axis::logarithmic("Λi", 1e-6, 1e12)],
                    inputs: |x| vec![1.0 + x[0], 1.0 + x[1]],
                }]
            },
            forms: forms![
                stable "Stirling's series, leading terms cancelled by hand" beta_function,
                control "Γ(p) Γ(q) / Γ(p + q)" beta_by_gamma,
            ],
        },
    ]
}

fn scattering() -> Vec<Term> {
    vec![
        Term {
            name: "microfacet/ggx_reflection",
            statement: "f of GGX without F, height-correlated Smith",
            inputs: PAIR,
            variables: 6,
            range: ROUGHNESS,
            exact: |x| {
                let (area, wo, wi) = areas(x)?;
                let denominator = &area[1] * &wo + (&area[0] - &wo) * &wi;
                Some(exact(&(half_d(x) / (big(4.0) * denominator))))
            },
            regions: pair_regions,
            forms: forms![
                stable "h of any length, over projected areas" reflection_of_ggx,
                control "D over n·h, G₂ / (4 cos cos)" reflection_of_ggx_by_cosine,
            ],
        },
        Term {
            name: "microfacet/ggx_reflection_pdf",
            statement: "density of reflection off a visible normal of GGX",
            inputs: PAIR,
            variables: 6,
            range: ROUGHNESS,
            exact: |x| {
                let (area, ..) = areas(x)?;
                Some(exact(&(half_d(x) / (big(4.0) * &area[0]))))
            },
            regions: pair_regions,
            forms: forms![stable "D / (4 σo)" pdf_of_ggx,],
        },
        Term {
            name: "microfacet/visible_normal_pdf",
            statement: "density of visible normals of GGX",
            inputs: &["w.x", "w.y", "w.z", "m.x", "m.y", "m.z", "αx", "αy"],
            variables: 6,
            range: "α in [1e-4, 1], each axis; any direction; normals that face it",
            exact: |x| {
                let dot = (0..3).fold(big(0.0), |sum, i| sum + big(x[i]) * big(x[3 + i]));
                (x[5] > 0.0 && dot > Big::ZERO)
                    .then(|| exact(&(ggx_d(&x[3..]) * dot / ggx_area(&x[..3], &x[6..]))))
            },
            regions: |precision| {
                vec![Region {
                    name: "grazing incidence",
                    axes: vec![
                        Axis::logarithmic("cos θ", tangent(precision), 1.0),
                        Axis::logarithmic("α", ALPHA_MIN, 1.0),
                        Axis::logarithmic("tan θm / α", 1e-3, 10.0),
                        Axis::linear("azimuth of m", 0.0, 6.3),
                    ],
                    inputs: |x| {
                        [&at_cosine(x[0], 0.4)[..], &normal(x[2] * x[1], x[3]), &[x[1], x[1]]].concat()
                    },
                }]
            },
            forms: forms![stable "D w·m / σ(w)" visible_pdf_of_ggx,],
        },
        Term {
            name: "microfacet/beckmann_reflection",
            statement: "f of Beckmann without F, height-correlated Smith",
            inputs: PAIR,
            variables: 6,
            range: ROUGHNESS,
            exact: |x| {
                let (wo, wi) = (big(x[2]), big(x[5]));
                let [area_o, area_i] = [&x[..3], &x[3..6]].map(|w| beckmann_area(w, &x[6..]));
                let h: Vec<Big> = (0..3).map(|i| big(x[i]) + big(x[3 + i])).collect();
                let z2 = square(&h[2]);
                let exponent = stretched(&h, [&big(x[6]), &big(x[7])]) / &z2;
                let length_squared = square(&h[0]) + square(&h[1]) + &z2;
                // D h⁴ of h of any length.
                let d = exp_minus(exponent) * square(&(length_squared / z2)) / (pi() * big(x[6]) * big(x[7]));
                let denominator = &area_i * &wo + (&area_o - &wo) * &wi;
                (x[2] > 0.0 && x[5] > 0.0).then(|| exact(&(d / (big(4.0) * denominator))))
            },
            regions: pair_regions,
            forms: forms![
                stable "h of any length, over projected areas" reflection_of_beckmann,
                control "over tan² θ = 1/cos² θ − 1, G₂ / (4 cos cos)" reflection_of_beckmann_by_tangent,
            ],
        },
        Term {
            name: "microfacet/refraction_jacobian",
            statement: "dωm / dωi of a facet that refracts wo into wi",
            inputs: &["wo.x", "wo.y", "wo.z", "wi.x", "wi.y", "wi.z", "η"],
            variables: 6,
            range: "η in [1, 4], |η − 1| from 2 ε, directions through a facet up to 45° from the normal",
            exact: |x| {
                let eta = big(x[6]);
                let sum: Vec<Big> = (0..3).map(|i| big(x[i]) + &eta * big(x[3 + i])).collect();
                let squared = sum.iter().fold(big(0.0), |total, x| total + square(x));
                let length = squared.sqrt();
                // The facet lies along the sum, on the side of wo; the light ends on the other.
                let along =
                    |w: &[f64]| (0..3).fold(big(0.0), |total, i| total + &sum[i] * big(w[i])) / &length;
                let (cos_o, cos_t) = (along(&x[..3]), along(&x[3..6]));
                let is_refraction = &cos_o * &cos_t < Big::ZERO && sum[2] != Big::ZERO && x[5] < 0.0;
                let cos_t = if cos_t < Big::ZERO { -cos_t } else { cos_t };
                is_refraction.then(|| exact(&(cos_t * square(&eta) / squared)))
            },
            regions: refraction_regions,
            forms: forms![
                stable "near the normal, cos θo − η cos θi from the sines" refraction_jacobian,
            ],
        },
    ]
}

fn refraction_regions(precision: Precision) -> Vec<Region> {
    vec![Region {
        name: "nearly matched media",
        axes: vec![
            Axis::logarithmic("η − 1", 2.0 * precision.epsilon(), 3.0),
            Axis::logarithmic("θ to the facet", 1e-6, 1.5),
            Axis::linear("slope of the facet", 0.0, 1.0),
            Axis::linear("azimuth", 0.0, 6.3),
        ],
        inputs: |x| {
            let eta = 1.0 + x[0];
            let facet = normal(x[2], x[3]);
            // wo in the plane of the facet's normal and of the first tangent, θ from the normal.
            let tangent = [facet[2], 0.0, -facet[0]];
            let length = libm::hypot(tangent[0], tangent[2]);
            let (sin, cos) = libm::sincos(x[1]);
            let cos_t = (1.0 - (sin / eta).powi(2)).sqrt();
            let turned =
                |along: f64, across: f64| [0, 1, 2].map(|i| along * facet[i] + across * tangent[i] / length);
            [&turned(cos, sin)[..], &turned(-cos_t, -sin / eta), &[eta]].concat()
        },
    }]
}

/// The direction of the given tangent and azimuth \[rad\].
fn normal(tan_theta: f64, phi: f64) -> [f64; 3] {
    direction(libm::atan(tan_theta), phi)
}

fn normal_regions(precision: Precision) -> Vec<Region> {
    vec![
        Region {
            name: "narrow lobes",
            axes: vec![
                Axis::logarithmic("tan θ / α", 1e-3, 8.0),
                Axis::logarithmic("α", ALPHA_MIN, 1.0),
                Axis::linear("azimuth", 0.0, 6.3),
            ],
            inputs: |x| [&normal(x[0] * x[1], x[2])[..], &[x[1], x[1]]].concat(),
        },
        Region {
            name: "next to the horizon",
            axes: vec![
                Axis::logarithmic("cos θ", tangent(precision), 0.5),
                Axis::logarithmic("α", ALPHA_MIN, 1.0),
                Axis::linear("azimuth", 0.0, 6.3),
            ],
            inputs: |x| [&at_cosine(x[0], x[2])[..], &[x[1], x[1]]].concat(),
        },
    ]
}

fn area_regions(precision: Precision) -> Vec<Region> {
    let mut regions = slope_regions(precision);
    regions.push(Region {
        name: "below the horizon",
        axes: vec![
            Axis::logarithmic("−cos θ", 1e-3, 1.0),
            Axis::logarithmic("αx", ALPHA_MIN, 1.0),
            Axis::logarithmic("αy", ALPHA_MIN, 1.0),
        ],
        inputs: |x| [&at_cosine(-x[0], 0.7)[..], &x[1..]].concat(),
    });
    regions
}

fn slope_regions(precision: Precision) -> Vec<Region> {
    vec![
        Region {
            name: "grazing incidence",
            axes: vec![
                Axis::logarithmic("cos θ", tangent(precision), 0.5),
                Axis::logarithmic("αx", ALPHA_MIN, 1.0),
                Axis::logarithmic("αy", ALPHA_MIN, 1.0),
            ],
            inputs: |x| [&at_cosine(x[0], 0.7)[..], &x[1..]].concat(),
        },
        Region {
            name: "normal incidence",
            axes: vec![
                Axis::logarithmic("θ", precision.epsilon(), 1.0),
                Axis::logarithmic("αx", ALPHA_MIN, 1.0),
                Axis::logarithmic("αy", ALPHA_MIN, 1.0),
            ],
            inputs: |x| [&direction(x[0], 0.7)[..], &x[1..]].concat(),
        },
        Region {
            name: "at the slope of the facets",
            axes: vec![
                Axis::linear("cot θ / α", -2.0, 4.0),
                Axis::logarithmic("α", ALPHA_MIN, 1.0),
                Axis::linear("azimuth", 0.0, 6.3),
            ],
            inputs: |x| {
                let theta = core::f64::consts::FRAC_PI_2 - libm::atan(x[0] * x[1]);
                [&direction(theta, x[2])[..], &[x[1], x[1]]].concat()
            },
        },
    ]
}

/// Pairs of directions above the surface.
fn pair_regions(precision: Precision) -> Vec<Region> {
    // wi is wo mirrored at a facet.
    fn mirrored(wo: [f64; 3], facet: [f64; 3]) -> Vec<f64> {
        let dot: f64 = wo.iter().zip(facet).map(|(w, m)| w * m).sum();
        wo.into_iter().chain((0..3).map(|i| 2.0 * dot * facet[i] - wo[i])).collect()
    }
    vec![
        Region {
            name: "narrow lobes",
            axes: vec![
                Axis::linear("tan θh / α", 1e-3, 4.0),
                Axis::logarithmic("α", ALPHA_MIN, 1.0),
                Axis::linear("θo", 0.0, 1.57),
                Axis::linear("azimuth", 0.0, 6.3),
            ],
            inputs: |x| {
                [mirrored(direction(x[2], 0.3), normal(x[0] * x[1], x[3])), vec![x[1], x[1]]].concat()
            },
        },
        Region {
            name: "one axis narrow",
            axes: vec![
                Axis::logarithmic("αy", ALPHA_MIN, 1.0),
                Axis::linear("θo", 0.0, 1.57),
                Axis::linear("tan θh / α", 0.0, 2.0),
                Axis::linear("azimuth", 0.0, 6.3),
            ],
            inputs: |x| {
                let (sin, cos) = libm::sincos(x[3]);
                let (slope_x, slope_y) = (x[2] * cos, x[2] * x[0] * sin);
                let facet = normal(libm::hypot(slope_x, slope_y), libm::atan2(slope_y, slope_x));
                [mirrored(direction(x[1], 0.3), facet), vec![1.0, x[0]]].concat()
            },
        },
        Region {
            name: "both grazing",
            axes: vec![
                Axis::logarithmic("cos θo", tangent(precision), 0.1),
                Axis::logarithmic("cos θi", tangent(precision), 0.1),
                Axis::logarithmic("α", ALPHA_MIN, 1.0),
                Axis::among("difference of azimuths", [0.0, 0.5, 2.0, core::f64::consts::PI]),
            ],
            inputs: |x| [&at_cosine(x[0], 0.0)[..], &at_cosine(x[1], x[3]), &[x[2], x[2]]].concat(),
        },
        Region {
            name: "wi = wo",
            axes: vec![Axis::linear("θ", 0.0, 1.57), Axis::logarithmic("α", ALPHA_MIN, 1.0)],
            inputs: |x| {
                let w = direction(x[0], 1.0);
                [&w[..], &w, &[x[1], x[1]]].concat()
            },
        },
    ]
}

fn facing(x: &[f64]) -> Option<()> {
    (x[2] > 0.0).then_some(())
}

fn above(w: &[f64]) -> Option<()> {
    (w[2] > 0.0).then_some(())
}

/// (x/αx)² + (y/αy)².
fn stretched(m: &[Big], alpha: [&Big; 2]) -> Big {
    square(&(&m[0] / alpha[0])) + square(&(&m[1] / alpha[1]))
}

fn bigs(x: &[f64]) -> Vec<Big> {
    x.iter().map(|&x| big(x)).collect()
}

fn ggx_d(x: &[f64]) -> Big {
    let x = bigs(x);
    let sum = stretched(&x, [&x[3], &x[4]]) + square(&x[2]);
    big(1.0) / (pi() * &x[3] * &x[4] * square(&sum))
}

fn beckmann_d(x: &[f64]) -> Big {
    let x = bigs(x);
    let z2 = square(&x[2]);
    let exponent = stretched(&x, [&x[3], &x[4]]) / &z2;
    exp_minus(exponent) / (pi() * &x[3] * &x[4] * square(&z2))
}

fn gaussian_d(x: &[f64]) -> Big {
    let x = bigs(x);
    let sine = (square(&x[0]) + square(&x[1])).sqrt();
    if sine == Big::ZERO {
        return big(1.0);
    }
    let exponent = stretched(&x, [&x[3], &x[4]]) * square(&(sine.atan2(&x[2]) / &sine));
    exp_minus(exponent)
}

/// s² = (αx x)² + (αy y)².
fn seen(w: &[f64], alpha: &[f64]) -> Big {
    square(&(big(w[0]) * big(alpha[0]))) + square(&(big(w[1]) * big(alpha[1])))
}

fn ggx_area(w: &[f64], alpha: &[f64]) -> Big {
    let z = big(w[2]);
    (&z + (square(&z) + seen(w, alpha)).sqrt()) / big(2.0)
}

fn beckmann_area(w: &[f64], alpha: &[f64]) -> Big {
    let (z, s) = (big(w[2]), seen(w, alpha).sqrt());
    if s == Big::ZERO {
        return if w[2] > 0.0 { z } else { big(0.0) };
    }
    let a = &z / &s;
    if a > big(1e3) {
        // Less than 2⁻¹⁰⁰⁰⁰⁰⁰ of it is missing.
        return z;
    }
    (&z * erfc(&-&a) + s * (-square(&a)).exp() * frac_1_sqrt_pi()) / big(2.0)
}

/// Λ = ½ (e^{−a²} / (a √π) − erfc a), where a = z/s is at most 5.
fn beckmann_lambda(w: &[f64], alpha: &[f64]) -> Option<Big> {
    let s = seen(w, alpha).sqrt();
    if big(w[2]) > big(5.0) * &s {
        return None;
    }
    let a = big(w[2]) / s;
    Some(((-square(&a)).exp() / &a * frac_1_sqrt_pi() - erfc(&a)) / big(2.0))
}

/// σ of both directions of a pair, and their cosines.
fn areas(x: &[f64]) -> Option<([Big; 2], Big, Big)> {
    (x[2] > 0.0 && x[5] > 0.0)
        .then(|| ([ggx_area(&x[..3], &x[6..]), ggx_area(&x[3..6], &x[6..])], big(x[2]), big(x[5])))
}

/// D of h = wo + wi, which need not be of unit length.
fn half_d(x: &[f64]) -> Big {
    let h: Vec<Big> = (0..3).map(|i| big(x[i]) + big(x[3 + i])).collect();
    let (alpha_x, alpha_y) = (big(x[6]), big(x[7]));
    let length_squared = square(&h[0]) + square(&h[1]) + square(&h[2]);
    let sum = stretched(&h, [&alpha_x, &alpha_y]) + square(&h[2]);
    square(&(length_squared / sum)) / (pi() * alpha_x * alpha_y)
}

/// A value of the distribution of the last two inputs.
fn of<F: Real>(
    shape: Shape,
    shadowing: Option<Shadowing>,
    x: &[F],
    value: impl Fn(&Distribution<F>) -> F,
) -> F {
    let [.., alpha_x, alpha_y] = *x else { return F::ZERO };
    let distribution = Distribution::new(shape, alpha_x, alpha_y).ok();
    let distribution = match shadowing {
        None => distribution,
        Some(shadowing) => distribution.and_then(|distribution| distribution.with_shadowing(shadowing).ok()),
    };
    distribution.map_or(F::NAN, |distribution| value(&distribution))
}

fn first<F: Real>(x: &[F]) -> F::Vec3 {
    F::Vec3::new(x[0], x[1], x[2])
}

fn second<F: Real>(x: &[F]) -> F::Vec3 {
    F::Vec3::new(x[3], x[4], x[5])
}

fn d_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.d(first(x)))
}

fn d_of_beckmann<F: Real>(x: &[F]) -> F {
    of(Shape::Beckmann, None, x, |beckmann| beckmann.d(first(x)))
}

fn d_of_gaussian<F: Real>(x: &[F]) -> F {
    let (u, v) = (x[0] / x[3], x[1] / x[4]);
    gaussian::density(u * u + v * v, x[0] * x[0] + x[1] * x[1], x[2])
}

fn d_of_gaussian_by_cosine<F: Real>(x: &[F]) -> F {
    let theta = (F::ONE - x[2] * x[2]).sqrt().atan2(x[2]);
    (-(theta / x[3]).squared()).exp()
}

/// Walter et al. 2007, (33), as 3D engines write it.
fn d_of_ggx_by_cosine<F: Real>(x: &[F]) -> F {
    let alpha2 = x[3] * x[3];
    let sum = x[2] * x[2] * (alpha2 - F::ONE) + F::ONE;
    alpha2 / (F::PI * sum * sum)
}

/// tan² θ from the cosine alone, as in pbrt-v4's `TrowbridgeReitzDistribution::D`.
fn tan2_theta<F: Real>(z: F) -> F {
    (F::ONE - z * z) / (z * z)
}

fn d_of_ggx_by_tangent<F: Real>(x: &[F]) -> F {
    let (alpha2, cos2) = (x[3] * x[3], x[2] * x[2]);
    let sum = F::ONE + tan2_theta(x[2]) / alpha2;
    F::ONE / (F::PI * alpha2 * cos2 * cos2 * sum * sum)
}

fn d_of_beckmann_by_tangent<F: Real>(x: &[F]) -> F {
    let (alpha2, cos2) = (x[3] * x[3], x[2] * x[2]);
    (-tan2_theta(x[2]) / alpha2).exp() / (F::PI * alpha2 * cos2 * cos2)
}

fn area_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.projected_area(first(x)))
}

fn area_of_beckmann<F: Real>(x: &[F]) -> F {
    of(Shape::Beckmann, None, x, |beckmann| beckmann.projected_area(first(x)))
}

fn s_squared<F: Real>(x: &[F]) -> F {
    (x[0] * x[3]).squared() + (x[1] * x[4]).squared()
}

fn area_of_ggx_by_sum<F: Real>(x: &[F]) -> F {
    F::HALF * (x[2] + (x[2] * x[2] + s_squared(x)).sqrt())
}

/// Walter et al. 2007, (27).
fn rational_g1_of_beckmann<F: Real>(x: &[F]) -> F {
    let f = F::from_f64;
    let a = x[2] / s_squared(x).sqrt();
    if a >= f(1.6) {
        F::ONE
    } else {
        (f(3.535) + f(2.181) * a) * a / (F::ONE + (f(2.276) + f(2.577) * a) * a)
    }
}

fn area_of_beckmann_by_rational_g1<F: Real>(x: &[F]) -> F {
    x[2] / rational_g1_of_beckmann(x)
}

fn lambda_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.lambda(first(x)).unwrap_or_default())
}

fn lambda_of_ggx_by_difference<F: Real>(x: &[F]) -> F {
    let t = s_squared(x) / (x[2] * x[2]);
    F::HALF * ((F::ONE + t).sqrt() - F::ONE)
}

fn lambda_of_beckmann<F: Real>(x: &[F]) -> F {
    of(Shape::Beckmann, None, x, |beckmann| beckmann.lambda(first(x)).unwrap_or_default())
}

fn lambda_of_beckmann_by_erf<F: Real>(x: &[F]) -> F {
    let a = x[2] / s_squared(x).sqrt();
    F::HALF * (a.erf() - F::ONE + (-a * a).exp() / (a * F::PI.sqrt()))
}

fn g1_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.g1(first(x), first(x)))
}

fn g1_of_beckmann<F: Real>(x: &[F]) -> F {
    of(Shape::Beckmann, None, x, |beckmann| beckmann.g1(first(x), first(x)))
}

/// The half vector does not matter to Smith's masking, as long as both directions face it.
fn correlated_g2<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.g2(first(x), second(x), F::Vec3::new(F::ZERO, F::ZERO, F::ONE)))
}

fn separable_g2<F: Real>(x: &[F]) -> F {
    let up = F::Vec3::new(F::ZERO, F::ZERO, F::ONE);
    of(Shape::Ggx, Some(Shadowing::SmithSeparable), x, |ggx| ggx.g2(first(x), second(x), up))
}

fn v_cavity_g2<F: Real>(x: &[F]) -> F {
    let h = (first(x) + second(x)).normalize();
    of(Shape::Ggx, Some(Shadowing::VCavity), x, |ggx| ggx.g2(first(x), second(x), h))
}

fn beta_function<F: Real>(x: &[F]) -> F {
    special::beta(x[0], x[1])
}

fn beta_by_gamma<F: Real>(x: &[F]) -> F {
    x[0].gamma() * x[1].gamma() / (x[0] + x[1]).gamma()
}

fn reflection_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.reflection(first(x), second(x)).value)
}

fn reflection_of_ggx_by_cosine<F: Real>(x: &[F]) -> F {
    let h = (first(x) + second(x)).normalize();
    let d = d_of_ggx_by_cosine(&[h.x(), h.y(), h.z(), x[6], x[7]]);
    d * correlated_g2(x) / (F::FOUR * x[2] * x[5])
}

fn reflection_of_beckmann<F: Real>(x: &[F]) -> F {
    of(Shape::Beckmann, None, x, |beckmann| beckmann.reflection(first(x), second(x)).value)
}

fn reflection_of_beckmann_by_tangent<F: Real>(x: &[F]) -> F {
    let h = (first(x) + second(x)).normalize();
    let d = d_of_beckmann_by_tangent(&[h.x(), h.y(), h.z(), x[6], x[7]]);
    let g2 = of(Shape::Beckmann, None, x, |beckmann| beckmann.g2(first(x), second(x), h));
    d * g2 / (F::FOUR * x[2] * x[5])
}

fn refraction_jacobian<F: Real>(x: &[F]) -> F {
    RefractingFacet::<F>::between(first(x), second(x), x[6], true).map_or(F::NAN, |facet| facet.jacobian())
}

fn pdf_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.reflection_pdf(first(x), second(x)).0)
}

fn visible_pdf_of_ggx<F: Real>(x: &[F]) -> F {
    of(Shape::Ggx, None, x, |ggx| ggx.visible_pdf(first(x), second(x)))
}

//! Textbook forms of microfacet terms, over tangents and n·m as papers print them: what a bug is made of.

use bxdf_tests::Direction;
use std::f64::consts::PI;

pub(super) fn dot(a: Direction, b: Direction) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// a + s b.
pub(super) fn add(a: Direction, s: f64, b: Direction) -> Direction {
    core::array::from_fn(|i| a[i] + s * b[i])
}

pub(super) fn normalized(w: Direction) -> Direction {
    let length = dot(w, w).sqrt();
    w.map(|x| x / length)
}

/// The half vector h of reflection and wo·h.
pub(super) fn half(wo: Direction, wi: Direction) -> (Direction, f64) {
    let sum = add(wo, 1.0, wi);
    let length = dot(sum, sum).sqrt();
    (sum.map(|x| x / length), 0.5 * length)
}

/// The mirror direction of `wo` at the facet `m`.
pub(super) fn mirrored(wo: Direction, m: Direction) -> Direction {
    add(wo.map(|x| -x), 2.0 * dot(wo, m), m)
}

/// tan²θ_m over the roughness of its azimuth, squared.
fn slope2([x, y, z]: Direction, [ax, ay]: [f64; 2]) -> f64 {
    ((x / ax).powi(2) + (y / ay).powi(2)) / (z * z)
}

/// D of GGX \[sr⁻¹\].
pub(super) fn ggx_d(m: Direction, alpha: [f64; 2]) -> f64 {
    1.0 / (PI * alpha[0] * alpha[1] * m[2].powi(4) * (1.0 + slope2(m, alpha)).powi(2))
}

/// D of Beckmann \[sr⁻¹\].
pub(super) fn beckmann_d(m: Direction, alpha: [f64; 2]) -> f64 {
    libm::exp(-slope2(m, alpha)) / (PI * alpha[0] * alpha[1] * m[2].powi(4))
}

/// α² tan²θ.
fn stretched2([x, y, z]: Direction, [ax, ay]: [f64; 2]) -> f64 {
    ((x * ax).powi(2) + (y * ay).powi(2)) / (z * z)
}

/// Smith's Λ of GGX.
pub(super) fn ggx_lambda(w: Direction, alpha: [f64; 2]) -> f64 {
    0.5 * ((1.0 + stretched2(w, alpha)).sqrt() - 1.0)
}

/// Smith's Λ of Beckmann.
pub(super) fn beckmann_lambda(w: Direction, alpha: [f64; 2]) -> f64 {
    let a = 1.0 / stretched2(w, alpha).sqrt();
    if a.is_infinite() { 0.0 } else { 0.5 * (libm::exp(-a * a) / (a * PI.sqrt()) - libm::erfc(a)) }
}

/// G₁ of Beckmann as Walter et al. fit it by a rational function, within 0.35 %.
pub(super) fn beckmann_g1_rational(w: Direction, alpha: [f64; 2]) -> f64 {
    let a = 1.0 / stretched2(w, alpha).sqrt();
    if a < 1.6 { (3.535 * a + 2.181 * a * a) / (1.0 + 2.276 * a + 2.577 * a * a) } else { 1.0 }
}

/// G₂ of height-correlated Smith masking–shadowing over D's own G₁ at `wo`.
pub(super) fn correlated(lambda_o: f64, lambda_i: f64) -> f64 {
    1.0 / (1.0 + lambda_o + lambda_i)
}

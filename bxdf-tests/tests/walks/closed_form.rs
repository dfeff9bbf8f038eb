//! What is known of coats without a walk.

use crate::fresnel;

/// ∫ f from a to b by the tanh–sinh rule: roots and poles of the derivatives at the ends do no harm.
/// Takahasi and Mori 1974, <https://doi.org/10.2977/prims/1195192451>.
pub(crate) fn integrate(a: f64, b: f64, f: impl Fn(f64) -> f64) -> f64 {
    const STEP: f64 = 1.0 / 32.0;
    let half_pi = core::f64::consts::FRAC_PI_2;
    let sum: f64 = (-112..=112)
        .map(|i| {
            let t = STEP * f64::from(i);
            let u = half_pi * t.sinh();
            // tanh u, from the nearer end: 1 − tanh|u| = 2 / (1 + e^(2|u|)).
            let from_end = (b - a) / (1.0 + (2.0 * u.abs()).exp());
            let x = if u < 0.0 { a + from_end } else { b - from_end };
            let weight = 0.5 * (b - a) * STEP * half_pi * t.cosh() / u.cosh().powi(2);
            // At an end to rounding there is nothing left to add.
            if x > a && x < b { weight * f(x) } else { 0.0 }
        })
        .sum();
    sum
}

/// The cosine, inside, at which total internal reflection begins.
fn critical_cosine(eta: f64) -> f64 {
    (1.0 - 1.0 / (eta * eta)).sqrt()
}

/// F_dr from outside: 2 ∫ F(μ) μ dμ.
pub(crate) fn diffuse_reflectance_outside(eta: f64) -> f64 {
    integrate(0.0, 1.0, |mu| 2.0 * mu * fresnel::dielectric(mu, eta))
}

/// K(τ) = 2 ∫ F(μ) e^(−2τ/μ) μ dμ inside the coat: diffuse light that comes back from the interface. K(0) is
/// F_dr from inside.
pub(crate) fn recirculation(eta: f64, optical_depth: f64) -> f64 {
    let f = |mu: f64| 2.0 * mu * fresnel::dielectric(mu, 1.0 / eta) * (-2.0 * optical_depth / mu).exp();
    let critical = critical_cosine(eta);
    integrate(0.0, critical, f) + integrate(critical, 1.0, f)
}

/// Albedo of a smooth coat over a Lambertian base at cosine `mu`, without what the interface reflects: every
/// bounce starts anew, so the series is geometric.
/// (1 − F) e^(−τ/μ') ρ S / (1 − ρ K(τ)), S = 2 ∫ (1 − F(μ)) e^(−τ/μ) μ dμ inside.
pub(crate) fn smooth_over_lambertian(mu: f64, eta: f64, optical_depth: f64, albedo: f64) -> f64 {
    let mu_inside = (1.0 - (1.0 - mu * mu) / (eta * eta)).sqrt();
    let entering = (1.0 - fresnel::dielectric(mu, eta)) * (-optical_depth / mu_inside).exp();
    let leaving = integrate(critical_cosine(eta), 1.0, |mu| {
        2.0 * mu * (1.0 - fresnel::dielectric(mu, 1.0 / eta)) * (-optical_depth / mu).exp()
    });
    entering * albedo * leaving / (1.0 - albedo * recirculation(eta, optical_depth))
}

/// The same over a smooth conductor, whose bounces share one angle; `eta_k` over the index outside.
pub(crate) fn smooth_over_smooth_conductor(
    mu: f64,
    eta: f64,
    optical_depth: f64,
    [eta_base, k_base]: [f64; 2],
) -> f64 {
    let mu_inside = (1.0 - (1.0 - mu * mu) / (eta * eta)).sqrt();
    let f = fresnel::dielectric(mu, eta);
    let bounce = fresnel::conductor(mu_inside, eta_base / eta, k_base / eta)
        * (-2.0 * optical_depth / mu_inside).exp();
    (1.0 - f) * (1.0 - f) * bounce / (1.0 - f * bounce)
}

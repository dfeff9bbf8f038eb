//! Light that bounces between a coat and its base until it leaves: ground truth for layered lobes.
//!
//! The layer is wide compared with its thickness, so a path is a sequence of directions without positions
//! (Guo, Hašan, Zhao 2018, "Position-free Monte Carlo simulation for arbitrary layered BSDFs",
//! <https://doi.org/10.1145/3272127.3275053>). It absorbs and does not scatter.

use crate::fresnel;
use crate::smith::{self, Boundary};
use crate::statistics::Mean;
use crate::surface::Surface;
use crate::vector::{Vector, cosine_hemisphere, dot, normalize, reflect, refract, scale};
use libm::lgamma;
use rand::RngExt;
use rand_pcg::Pcg64;

/// The boundary between the outside and the coat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Interface {
    Smooth,
    /// A microfacet lobe: what meets a second facet is lost.
    SingleScattering(Surface),
    /// The walk of [`smith`]: nothing is lost.
    MultipleScattering(Surface),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Coat {
    pub(crate) interface: Interface,
    /// Index of the coat over the index outside.
    pub(crate) eta: f64,
    /// σ_a · thickness: a crossing at angle θ inside leaves e^(−optical_depth / cos θ).
    pub(crate) optical_depth: f64,
}

/// What lies below. The index of a conductor is over the index *outside* the coat; the coat divides it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Base {
    Lambertian {
        albedo: f64,
    },
    SmoothConductor {
        eta: f64,
        k: f64,
    },
    /// Single scattering with height-correlated masking–shadowing.
    RoughConductor {
        surface: Surface,
        eta: f64,
        k: f64,
    },
}

/// Directional albedo of the whole, and its parts.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Estimate {
    pub(crate) total: Mean,
    /// Reflected by the interface without entering the coat.
    pub(crate) interface: Mean,
    /// Has met the base.
    pub(crate) base: Mean,
    /// Has met the base once.
    pub(crate) first_bounce: Mean,
}

/// A direction with the fraction of energy that goes on into it.
type Scattered = Option<(Vector, f64)>;

/// Bounces on the base before energy is turned into probability.
const BOUNCES_BEFORE_ROULETTE: usize = 5;

/// Albedo for light from `wo`, above the coat.
pub(crate) fn walk(coat: &Coat, base: &Base, wo: Vector, samples: usize, rng: &mut Pcg64) -> Estimate {
    let mut estimate = Estimate::default();
    for _ in 0..samples {
        let (energy, bounces) = path(coat, base, wo, rng);
        let if_bounces = |condition: bool| if condition { energy } else { 0.0 };
        estimate.total.add(energy);
        estimate.interface.add(if_bounces(bounces == 0));
        estimate.base.add(if_bounces(bounces > 0));
        estimate.first_bounce.add(if_bounces(bounces == 1));
    }
    estimate
}

/// The energy that comes out again, and after how many bounces on the base.
fn path(coat: &Coat, base: &Base, wo: Vector, rng: &mut Pcg64) -> (f64, usize) {
    const LOST: (f64, usize) = (0.0, 0);
    let Some((mut ray, mut energy)) = coat.scatter(wo, rng) else { return LOST };
    let mut bounces = 0;
    while ray[2] < 0.0 {
        if bounces > BOUNCES_BEFORE_ROULETTE {
            if rng.random::<f64>() >= energy {
                return LOST;
            }
            energy = 1.0;
        }
        energy *= coat.transmittance(ray);
        let Some((up, reflectance)) = base.scatter(coat.eta, scale(-1.0, ray), rng) else { return LOST };
        bounces += 1;
        energy *= reflectance * coat.transmittance(up);
        // The interface sees the ray arrive from below.
        let Some((out, share)) = coat.scatter(scale(-1.0, up), rng) else { return LOST };
        energy *= share;
        ray = out;
    }
    (energy, bounces)
}

impl Coat {
    fn transmittance(&self, ray: Vector) -> f64 {
        (-self.optical_depth / ray[2].abs()).exp()
    }

    /// Scattering at the interface of light that arrives from `wo`, on either side. Reflect or refract is
    /// decided at random.
    fn scatter(&self, wo: Vector, rng: &mut Pcg64) -> Scattered {
        let side = wo[2].signum();
        let eta = if side > 0.0 { self.eta } else { 1.0 / self.eta };
        // With the side of `wo` up.
        let w = scale(side, wo);
        let (surface, m) = match self.interface {
            Interface::MultipleScattering(surface) => {
                let exit = smith::scatter(&surface, Boundary::Dielectric { eta: self.eta }, wo, rng);
                return Some((exit.direction, exit.weight));
            }
            Interface::SingleScattering(surface) => (Some(surface), surface.visible_normal(w, rng)),
            Interface::Smooth => (None, [0.0, 0.0, 1.0]),
        };
        let reflects = rng.random::<f64>() < fresnel::dielectric(dot(w, m), eta);
        let out = normalize(if reflects { reflect(w, m) } else { refract(w, m, eta) });
        if reflects != (out[2] > 0.0) {
            return None;
        }
        let share = surface.map_or(1.0, |surface| {
            let [lambda_o, lambda_i] = [w, scale(out[2].signum(), out)].map(|w| surface.lambda(w));
            if reflects {
                reflection_share(lambda_o, lambda_i)
            } else {
                // B(1 + Λo, 1 + Λi) / G₁(wo): the two sides of one height field.
                let (o, i) = (1.0 + lambda_o, 1.0 + lambda_i);
                (lgamma(o) + lgamma(i) - lgamma(o + i)).exp() * o
            }
        });
        Some((scale(side, out), share))
    }
}

impl Base {
    /// Scattering of light that arrives from `w` in a coat of index `eta_coat`.
    fn scatter(&self, eta_coat: f64, w: Vector, rng: &mut Pcg64) -> Scattered {
        match *self {
            Self::Lambertian { albedo } => Some((cosine_hemisphere(rng), albedo)),
            Self::SmoothConductor { eta, k } => {
                Some(([-w[0], -w[1], w[2]], fresnel::conductor(w[2], eta / eta_coat, k / eta_coat)))
            }
            Self::RoughConductor { surface, eta, k } => {
                let m = surface.visible_normal(w, rng);
                let out = normalize(reflect(w, m));
                let reflectance = fresnel::conductor(dot(w, m), eta / eta_coat, k / eta_coat);
                (out[2] > 0.0)
                    .then(|| (out, reflectance * reflection_share(surface.lambda(w), surface.lambda(out))))
            }
        }
    }
}

/// G₂ / G₁(wo) of height-correlated masking–shadowing.
fn reflection_share(lambda_o: f64, lambda_i: f64) -> f64 {
    (1.0 + lambda_o) / (1.0 + lambda_o + lambda_i)
}

//! Light that bounces on a rough surface until it leaves: ground truth for every order of scattering.
//!
//! Heitz, Hanika, d'Eon, Dachsbacher 2016, "Multiple-Scattering Microfacet BSDFs with the Smith Model",
//! <https://doi.org/10.1145/2897824.2925943>. The height of the ray enters only as the fraction of the
//! surface that lies below it, so no distribution of heights has to be chosen.

use crate::fresnel;
use crate::statistics::Mean;
use crate::surface::Surface;
use crate::vector::{Vector, cosine_hemisphere, dot, normalize, reflect, refract, scale};
use rand::RngExt;
use rand_pcg::Pcg64;

/// What a facet does with light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Boundary {
    /// Reflects everything.
    Mirror,
    /// Complex index of the conductor over the index above it.
    Conductor { eta: f64, k: f64 },
    /// Index below the surface over the index above.
    Dielectric { eta: f64 },
}

/// Where a walk left the surface.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Exit {
    pub(crate) direction: Vector,
    /// The fraction of energy left, \[0, 1\]. Reflect or refract is decided at random and costs none.
    pub(crate) weight: f64,
    /// The number of facets met.
    pub(crate) order: usize,
}

/// No walk is that long.
const LONGEST: usize = 100_000;

/// One walk of light that arrives from `wo`, from either side where the boundary is a dielectric.
pub(crate) fn scatter(surface: &Surface, boundary: Boundary, wo: Vector, rng: &mut Pcg64) -> Exit {
    // Seen from below the surface is the same surface, point-mirrored, with the reciprocal index.
    let mut side = wo[2].signum();
    let mut eta = match boundary {
        Boundary::Dielectric { eta } if side > 0.0 => eta,
        Boundary::Dielectric { eta } => 1.0 / eta,
        _ => f64::NAN,
    };
    let mut ray = scale(-side, wo);
    // The fraction of the surface below the ray.
    let mut below = 1.0_f64;
    let mut weight = 1.0;
    for order in 0..LONGEST {
        let lambda = surface.lambda(ray);
        let u = 1.0 - rng.random::<f64>();
        if ray[2] > 0.0 && u <= below.powf(lambda) {
            return Exit { direction: scale(side, ray), weight, order };
        }
        // On its way up the ray meets more of the surface below it, on its way down (Λ ≤ −1) less.
        below = (below * u.powf(-1.0 / lambda)).min(1.0);
        let w = scale(-1.0, ray);
        let m = surface.visible_normal(w, rng);
        // Rounding may turn a facet seen edge-on away.
        let cosine = dot(w, m).max(0.0);
        let reflectance = match boundary {
            Boundary::Mirror => 1.0,
            Boundary::Conductor { eta, k } => fresnel::conductor(cosine, eta, k),
            Boundary::Dielectric { .. } => fresnel::dielectric(cosine, eta),
        };
        if matches!(boundary, Boundary::Dielectric { .. }) && rng.random::<f64>() >= reflectance {
            // refract() points to the far side, where the walk goes on with that side up.
            ray = normalize(scale(-1.0, refract(w, m, eta)));
            side = -side;
            below = 1.0 - below;
            eta = 1.0 / eta;
        } else {
            if !matches!(boundary, Boundary::Dielectric { .. }) {
                weight *= reflectance;
            }
            ray = normalize(reflect(w, m));
        }
    }
    panic!("a walk of {LONGEST} facets on {surface:?} with {boundary:?} from {wo:?}");
}

/// Orders that are told apart; the last holds all higher ones.
pub(crate) const ORDERS: usize = 4;

/// Energy scattered to either side.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Sides {
    /// To the side that the light comes from.
    pub(crate) reflected: Mean,
    /// To the other side.
    pub(crate) transmitted: Mean,
}

/// Directional albedo, all orders together and one by one.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Estimate {
    pub(crate) total: Sides,
    /// `orders[0]` is single scattering.
    pub(crate) orders: [Sides; ORDERS],
}

impl Estimate {
    fn add(&mut self, exit: &Exit, reflected: bool) {
        let split = |sides: &mut Sides, weight: f64| {
            sides.reflected.add(if reflected { weight } else { 0.0 });
            sides.transmitted.add(if reflected { 0.0 } else { weight });
        };
        split(&mut self.total, exit.weight);
        for (i, sides) in self.orders.iter_mut().enumerate() {
            split(sides, if exit.order.min(ORDERS) == i + 1 { exit.weight } else { 0.0 });
        }
    }
}

/// Albedo for light from `wo`.
pub(crate) fn walk(
    surface: &Surface,
    boundary: Boundary,
    wo: Vector,
    samples: usize,
    rng: &mut Pcg64,
) -> Estimate {
    let mut estimate = Estimate::default();
    for _ in 0..samples {
        let exit = scatter(surface, boundary, wo, rng);
        estimate.add(&exit, exit.direction[2] * wo[2] > 0.0);
    }
    estimate
}

/// Albedo averaged over the hemisphere of one side (1: above, −1: below), weighted by the cosine.
pub(crate) fn average_walk(
    surface: &Surface,
    boundary: Boundary,
    side: f64,
    samples: usize,
    rng: &mut Pcg64,
) -> Estimate {
    let mut estimate = Estimate::default();
    for _ in 0..samples {
        let exit = scatter(surface, boundary, scale(side, cosine_hemisphere(rng)), rng);
        estimate.add(&exit, exit.direction[2] * side > 0.0);
    }
    estimate
}

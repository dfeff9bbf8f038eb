//! Our lobes against the walks: the laboratory integrates the lobe, the walk says what the integral should
//! be.

use crate::fresnel;
use crate::layered::{self, Base, Coat, Interface};
use crate::smith::{self, Boundary};
use crate::statistics::{CUBATURE, Checks, generator};
use crate::surface::{Shape, Surface};
use crate::vector::{Vector, direction, refract, scale};
use bxdf_tests::{Claims, Direction, Measure, Precision, Scatter, Specimen, Transport, directional_albedo};
use gonio::fresnel::Fresnel;
use gonio::lobe::MicrofacetReflection;
use gonio::microfacet::{self, Distribution};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use rayon::prelude::*;

const GOLD_532: [f64; 2] = [0.54386, 2.23087];

/// The distribution of ours that a surface of the walks stands for.
pub(crate) fn distribution(surface: &Surface) -> Distribution<f64> {
    let shape = match surface.shape {
        Shape::Ggx => microfacet::Shape::Ggx,
        Shape::Beckmann => microfacet::Shape::Beckmann,
    };
    Distribution::new(shape, surface.alpha[0], surface.alpha[1]).unwrap()
}

/// Our Fresnel term for a boundary of the walks.
pub(crate) fn fresnel_term(boundary: Boundary) -> Fresnel<f64> {
    match boundary {
        Boundary::Mirror => Fresnel::constant(Rgb::WHITE),
        Boundary::Conductor { eta, k } => Fresnel::conductor(Rgb::splat(eta), Rgb::splat(k)),
        Boundary::Dielectric { eta } => Fresnel::dielectric(eta),
    }
    .unwrap()
}

/// Light that meets one facet.
#[test]
fn microfacet_reflection_is_the_first_order_of_the_walk() {
    let mut cases = Vec::new();
    for shape in [Shape::Ggx, Shape::Beckmann] {
        for alpha in [[0.1; 2], [0.3; 2], [1.0; 2], [0.2, 0.6]] {
            let conductor = Boundary::Conductor { eta: GOLD_532[0], k: GOLD_532[1] };
            for boundary in [Boundary::Mirror, conductor, Boundary::Dielectric { eta: 1.5 }] {
                for polar_deg in [0.0, 60.0, 80.0] {
                    cases.push((Surface { shape, alpha }, boundary, direction(polar_deg, 25.0)));
                }
            }
        }
    }
    let results: Vec<_> = cases
        .par_iter()
        .map(|(surface, boundary, wo)| {
            let lobe = MicrofacetReflection::new(distribution(surface), fresnel_term(*boundary));
            let albedo =
                directional_albedo(&BxdfSpecimen::of_lobe("rough", lobe), *wo, Transport::Radiance, CUBATURE);
            let mut rng = generator(&format!("first order {surface:?} {boundary:?} {wo:?}"));
            (albedo, smith::walk(surface, *boundary, *wo, 1 << 16, &mut rng))
        })
        .collect();
    let mut checks = Checks::new();
    for (case, (albedo, estimate)) in cases.iter().zip(&results) {
        let first = &estimate.orders[0].reflected;
        checks.expect(&format!("{case:?}"), first, albedo.value[0], albedo.error[0]);
    }
    checks.expect_jointly();
    checks.finish();
}

/// One bounce on a rough conductor below a smooth coat, as a lobe: the base seen through the interface.
struct FirstBounce {
    coat: Coat,
    base: BxdfSpecimen<f64>,
}

impl FirstBounce {
    /// The direction inside that belongs to one outside, and what passes the interface and the coat that way.
    fn inside(&self, w: Vector) -> (Vector, f64) {
        let inside = scale(-1.0, refract(w, [0.0, 0.0, 1.0], self.coat.eta));
        let passes = 1.0 - fresnel::dielectric(w[2], self.coat.eta);
        (inside, passes * (-self.coat.optical_depth / inside[2]).exp())
    }
}

impl Specimen for FirstBounce {
    fn name(&self) -> String {
        "first bounce".to_owned()
    }

    fn claims(&self) -> Claims {
        Claims::reflector(Precision::F64)
    }

    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3] {
        if wi[2] <= 0.0 {
            return [0.0; 3];
        }
        let [(o, share_o), (i, share_i)] = [wo, wi].map(|w| self.inside(w));
        let eta2 = self.coat.eta * self.coat.eta;
        self.base.eval(o, i, transport).map(|f| share_o * share_i * f / eta2)
    }

    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64 {
        if wi[2] <= 0.0 {
            return 0.0;
        }
        let [(o, _), (i, _)] = [wo, wi].map(|w| self.inside(w));
        self.base.pdf(o, i, transport) * wi[2] / (self.coat.eta * self.coat.eta * i[2])
    }

    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter> {
        let sample = self.base.sample(self.inside(wo).0, uniforms, transport)?;
        let [x, y] = [0, 1].map(|axis| self.coat.eta * sample.wi[axis]);
        // Total internal reflection keeps the rest inside.
        let cos2 = 1.0 - x * x - y * y;
        let wi = (cos2 > 0.0).then(|| [x, y, cos2.sqrt()])?;
        let density = self.pdf(wo, wi, transport);
        let weight = self.eval(wo, wi, transport).map(|f| f * wi[2] / density);
        Some(Scatter { wi, weight, density: Measure::SolidAngle(density), eta: 1.0 })
    }
}

/// What the walk returns after one bounce, against our rough conductor inside the interface.
#[test]
fn first_bounce_below_a_smooth_coat_is_the_base_seen_through_it() {
    let [eta, k] = GOLD_532;
    let mut cases = Vec::new();
    for shape in [Shape::Ggx, Shape::Beckmann] {
        for alpha in [0.2, 1.0] {
            for optical_depth in [0.0, 0.3] {
                for polar_deg in [0.0, 60.0, 80.0] {
                    let coat = Coat { interface: Interface::Smooth, eta: 1.5, optical_depth };
                    cases.push((Surface::isotropic(shape, alpha), coat, direction(polar_deg, 0.0)));
                }
            }
        }
    }
    let results: Vec<_> = cases
        .par_iter()
        .map(|&(surface, coat, wo)| {
            let below = Boundary::Conductor { eta: eta / coat.eta, k: k / coat.eta };
            let lobe = MicrofacetReflection::new(distribution(&surface), fresnel_term(below));
            let specimen = FirstBounce { coat, base: BxdfSpecimen::of_lobe("base", lobe) };
            let base = Base::RoughConductor { surface, eta, k };
            let mut rng = generator(&format!("first bounce {surface:?} {coat:?} {wo:?}"));
            let estimate = layered::walk(&coat, &base, wo, 1 << 17, &mut rng);
            (directional_albedo(&specimen, wo, Transport::Radiance, CUBATURE), estimate)
        })
        .collect();
    let mut checks = Checks::new();
    for (case, (albedo, estimate)) in cases.iter().zip(&results) {
        checks.expect(&format!("{case:?}"), &estimate.first_bounce, albedo.value[0], albedo.error[0]);
    }
    checks.expect_jointly();
    checks.finish();
}

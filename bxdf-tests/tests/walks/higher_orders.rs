//! What is added to single scattering, against walks that follow every order.

use crate::lobes::{distribution, fresnel_term};
use crate::smith::{self, Boundary};
use crate::statistics::{CUBATURE, Checks, generator};
use crate::surface::Surface;
use crate::vector::{Vector, direction, scale};
use crate::walk_facts::{SHAPES, product};
use bxdf_tests::{Specimen, Transport, directional_albedo};
use gonio::fresnel::Fresnel;
use gonio::lobe::{
    KullaContyDielectric, KullaContyReflection, Lobe, MicrofacetDielectric, MicrofacetReflection,
};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use rayon::prelude::*;

const ALPHAS: [f64; 12] = [0.05, 0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];

/// A lobe of single scattering and the lobe of its higher orders.
struct AllOrders {
    single: BxdfSpecimen<f64>,
    higher: BxdfSpecimen<f64>,
}

impl AllOrders {
    fn new(single: impl Into<Lobe<f64>>, higher: impl Into<Lobe<f64>>) -> Self {
        let of = |lobe| BxdfSpecimen::of_lobe("orders", lobe);
        Self { single: of(single.into()), higher: of(higher.into()) }
    }

    fn reflector(surface: &Surface, fresnel: Fresnel<f64>) -> Self {
        let distribution = distribution(surface);
        let higher = KullaContyReflection::new(distribution, fresnel);
        Self::new(MicrofacetReflection::new(distribution, fresnel), higher)
    }

    fn glass(surface: &Surface, eta: f64) -> Self {
        let single = MicrofacetDielectric::new(distribution(surface), eta).unwrap();
        let higher = KullaContyDielectric::new(&single);
        // One channel for reflection and one for transmission.
        let [reflection, transmission] = [Rgb([1.0, 0.0, 0.0]), Rgb([0.0, 1.0, 0.0])];
        Self::new(single.with_tints(reflection, transmission).unwrap(), higher)
    }

    /// R and T in the measure of power, and the bound of the cubature.
    fn sides(&self, wo: Vector) -> [f64; 3] {
        let single = directional_albedo(&self.single, wo, Transport::Importance, CUBATURE);
        let [reflected, transmitted] = [wo[2].signum(), -wo[2].signum()].map(|side| self.higher_to(wo, side));
        let [r, t, _] = single.value;
        [r + reflected, t + transmitted, single.error[0].max(single.error[1])]
    }

    /// R alone, in one channel.
    fn reflected(&self, wo: Vector) -> [f64; 2] {
        let single = directional_albedo(&self.single, wo, Transport::Importance, CUBATURE);
        [single.value[0] + self.higher_to(wo, wo[2].signum()), single.error[0]]
    }

    /// Higher orders do not depend on the azimuth and are tabulated over √μ: the midpoint rule, in phase with the table.
    fn higher_to(&self, wo: Vector, side: f64) -> f64 {
        const NODES: u32 = 1024;
        let at = |i: u32| {
            let root = (f64::from(i) + 0.5) / f64::from(NODES);
            let mu = root * root;
            let wi = [(1.0 - mu * mu).sqrt(), 0.0, side * mu];
            let [f, ..] = self.higher.eval(wo, wi, Transport::Importance);
            2.0 * core::f64::consts::TAU * root.powi(3) * f / f64::from(NODES)
        };
        (0..NODES).map(at).sum()
    }
}

#[test]
fn a_rough_mirror_with_its_higher_orders_loses_nothing() {
    let largest = product(&SHAPES, &ALPHAS).into_par_iter().map(|(shape, alpha)| {
        let mirror =
            AllOrders::reflector(&Surface::isotropic(shape, alpha), Fresnel::constant(Rgb::WHITE).unwrap());
        let mut largest: f64 = 0.0;
        for polar_deg in [0.0, 30.0, 60.0, 75.0, 85.0, 89.0, 89.9] {
            let [total, bound] = mirror.reflected(direction(polar_deg, 0.0));
            let error = (total - 1.0).abs() + bound;
            assert!(error < 3e-3, "{shape:?} {alpha} {polar_deg}°: {total}");
            largest = largest.max(error);
        }
        largest
    });
    println!("largest error {:.1e}", largest.reduce(|| 0.0, f64::max));
}

/// Gold at 465, 532 and 630 nm, chromium at 532 nm.
#[test]
fn rough_metals_are_close_to_the_walk() {
    let metals = [[1.33185, 1.86929], [0.54386, 2.23087], [0.18836, 3.40338], [3.03429, 3.33000]];
    let surfaces = product(&SHAPES, &[0.2, 0.4, 0.6, 0.8, 1.0]);
    let cases = product(&product(&surfaces, &metals), &[0.0, 60.0, 80.0]);
    let results: Vec<_> = cases
        .into_par_iter()
        .map(|(((shape, alpha), [eta, k]), polar_deg)| {
            let (surface, wo) = (Surface::isotropic(shape, alpha), direction(polar_deg, 0.0));
            let conductor = Boundary::Conductor { eta, k };
            let metal = AllOrders::reflector(&surface, fresnel_term(conductor));
            let [albedo, bound] = metal.reflected(wo);
            let what = format!("{shape:?} {alpha} of {eta} + {k}i at {polar_deg}°");
            let estimate = smith::walk(&surface, conductor, wo, 1 << 15, &mut generator(&what));
            (what, albedo, bound, estimate.total.reflected)
        })
        .collect();
    assert_eq!(results.len(), 120);
    let mut checks = Checks::new();
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    for (what, albedo, bound, walked) in &results {
        // The error lies in −0.044 … +0.001.
        checks.expect(what, walked, albedo + 0.0215, 0.0225 + bound);
        let error = albedo - walked.value();
        range = [range[0].min(error), range[1].max(error)];
    }
    println!("errors {:+.4} … {:+.4}", range[0], range[1]);
    checks.finish();
}

#[test]
fn rough_glass_with_its_higher_orders_loses_nothing() {
    let surfaces = product(&SHAPES, &[0.1, 0.3, 0.5, 1.0]);
    let cases = product(&surfaces, &[1.5, 2.4]);
    let largest = cases.into_par_iter().map(|((shape, alpha), eta)| {
        let glass = AllOrders::glass(&Surface::isotropic(shape, alpha), eta);
        let mut largest: f64 = 0.0;
        for (side, polar_deg) in product(&[1.0, -1.0], &[0.0, 45.0, 75.0, 89.0]) {
            let wo = scale(side, direction(polar_deg, 0.0));
            let [reflected, transmitted, bound] = glass.sides(wo);
            let error = (reflected + transmitted - 1.0).abs() + 2.0 * bound;
            println!(
                "{shape:?} {alpha}, η {eta}, side {side}, {polar_deg}°: {reflected} + {transmitted} {:+.1e}",
                reflected + transmitted - 1.0
            );
            assert!(
                error < 3e-3,
                "{shape:?} {alpha}, η {eta}, side {side}, {polar_deg}°: {reflected} + {transmitted}"
            );
            largest = largest.max(error);
        }
        largest
    });
    println!("largest error {:.1e}", largest.reduce(|| 0.0, f64::max));
}

/// What crosses rough glass. Rougher glass scatters far from evenly from inside: at α = 1 the error reaches 0.11.
#[test]
fn rough_glass_lets_through_about_as_much_as_the_walk() {
    let surfaces = product(&SHAPES, &[0.1, 0.3, 0.5]);
    let sides = [(1.0, 0.0043), (-1.0, 0.024)];
    let results: Vec<_> = product(&surfaces, &sides)
        .into_par_iter()
        .flat_map_iter(|((shape, alpha), (side, within))| {
            let surface = Surface::isotropic(shape, alpha);
            let glass = AllOrders::glass(&surface, 1.5);
            [0.0, 45.0, 75.0].into_iter().map(move |polar_deg| {
                let wo = scale(side, direction(polar_deg, 0.0));
                let [_, transmitted, bound] = glass.sides(wo);
                let what = format!("glass {surface:?}, side {side}, {polar_deg}°");
                let boundary = Boundary::Dielectric { eta: 1.5 };
                let estimate = smith::walk(&surface, boundary, wo, 1 << 17, &mut generator(&what));
                (what, transmitted, bound, within, estimate.total.transmitted)
            })
        })
        .collect();
    assert_eq!(results.len(), 36);
    let mut checks = Checks::new();
    for (what, transmitted, bound, within, walked) in &results {
        checks.expect(what, walked, *transmitted, within + bound);
    }
    for (side, within) in sides {
        let of = results.iter().filter(|result| result.3 == within);
        let errors = of.map(|(_, transmitted, .., walked)| (transmitted - walked.value()).abs());
        println!("side {side}: largest error {:.4}", errors.fold(0.0, f64::max));
    }
    checks.finish();
}

//! Expected values from outside, reached through the whole of the laboratory.

use bxdf_tests::{Transport, directional_albedo};
use gonio::fresnel::Fresnel;
use gonio::lobe::MicrofacetReflection;
use gonio::microfacet::{Distribution, Shadowing, Shape};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;

/// The closed form is a one-dimensional integral, printed to 17 digits by `print_golden.py`; the laboratory
/// integrates `eval` over the sphere and knows nothing of it.
#[test]
fn val_albedo_of_a_rough_mirror_at_normal_incidence() {
    let table = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference-data/golden/rough_mirror.csv");
    let mut rows = 0;
    let mut largest: f64 = 0.0;
    for record in csv::Reader::from_path(table).unwrap().records() {
        let columns: [f64; 5] = core::array::from_fn(|i| record.as_ref().unwrap()[i].parse().unwrap());
        let alpha = columns[0];
        for (shape, shadowing, expected) in [
            (Shape::Ggx, Shadowing::SmithCorrelated, columns[1]),
            (Shape::Beckmann, Shadowing::SmithCorrelated, columns[2]),
            (Shape::Ggx, Shadowing::VCavity, columns[3]),
            (Shape::Beckmann, Shadowing::VCavity, columns[4]),
        ] {
            let distribution =
                Distribution::new(shape, alpha, alpha).unwrap().with_shadowing(shadowing).unwrap();
            let mirror = MicrofacetReflection::new(distribution, Fresnel::constant(Rgb::WHITE).unwrap());
            let specimen = BxdfSpecimen::of_lobe("mirror", mirror);
            let albedo = directional_albedo(&specimen, [0.0, 0.0, 1.0], Transport::Radiance, 1e-7);
            let error = (albedo.value[0] - expected).abs();
            let what = format!("{shape:?} {shadowing:?} {alpha}: {albedo:?} for {expected}");
            assert!(albedo.error[0] <= 1e-6, "{what}");
            // Walls of V-cavities begin to hide each other at a kink, where a bound may be a little too low.
            let slack = if shadowing == Shadowing::VCavity { 1e-6 } else { 1e-14 };
            assert!(error <= albedo.error[0] + slack, "{what}");
            largest = largest.max(error);
            rows += 1;
        }
    }
    assert_eq!(rows, 48);
    println!("largest error {largest:e}");
}

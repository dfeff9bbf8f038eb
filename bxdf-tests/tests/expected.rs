//! Expected values from outside, reached through the whole of the laboratory.

use bxdf_tests::{Transport, directional_albedo};
use gonio::fresnel::Fresnel;
use gonio::lobe::MicrofacetReflection;
use gonio::microfacet::{Distribution, Shape};
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
        let [alpha, ggx, beckmann] = [0, 1, 2].map(|i| record.as_ref().unwrap()[i].parse::<f64>().unwrap());
        for (shape, expected) in [(Shape::Ggx, ggx), (Shape::Beckmann, beckmann)] {
            let distribution = Distribution::new(shape, alpha, alpha).unwrap();
            let mirror = MicrofacetReflection::new(distribution, Fresnel::constant(Rgb::WHITE).unwrap());
            let specimen = BxdfSpecimen::of_lobe("mirror", mirror);
            let albedo = directional_albedo(&specimen, [0.0, 0.0, 1.0], Transport::Radiance);
            let error = (albedo.value[0] - expected).abs();
            assert!(albedo.error[0] <= 1e-6, "{shape:?} {alpha}: bound {:e}", albedo.error[0]);
            assert!(error <= albedo.error[0] + 1e-14, "{shape:?} {alpha}: {:?} for {expected}", albedo);
            largest = largest.max(error);
            rows += 1;
        }
    }
    assert_eq!(rows, 24);
    println!("largest error {largest:e}");
}

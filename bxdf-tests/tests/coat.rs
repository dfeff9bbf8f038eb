//! Refractive layers against closed forms.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::sync::Arc;

use bxdf_tests::{Claims, Precision, Transport, directional_albedo};
use gonio::bxdf::Bxdf;
use gonio::fresnel::Fresnel;
use gonio::lobe::{Coat, Lambertian, RefractiveLayer, SpecularReflection};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;

/// Albedo per channel of the coat with its smooth gloss, at the polar angle \[deg\].
fn total(coat: Coat<f64>, base: Arc<dyn Bxdf<f64>>, polar_deg: f64) -> [f64; 3] {
    let gloss = SpecularReflection::new(Fresnel::dielectric(coat.eta).unwrap());
    let layer = RefractiveLayer::new(coat, base).unwrap();
    let (sin, cos) = polar_deg.to_radians().sin_cos();
    let of = |bxdf: Arc<dyn Bxdf<f64>>| {
        let specimen = BxdfSpecimen::new("coat", bxdf, Claims::reflector(Precision::F64));
        directional_albedo(&specimen, [sin, 0.0, cos], Transport::Radiance, 1e-7).value
    };
    let (gloss, layer) = (of(Arc::new(gloss)), of(Arc::new(layer)));
    std::array::from_fn(|i| gloss[i] + layer[i])
}

/// Printed for a coat of red varnish: the thesis's Figure 11.
#[test]
fn val_coloured_coat_over_a_diffuse_base() {
    for (thickness, polar_deg, red, blue) in [
        (0.0, 0.0, 0.31607, 0.31607),
        (0.3, 0.0, 0.24949, 0.15209),
        (0.6, 0.0, 0.20671, 0.09559),
        (1.0, 0.0, 0.16720, 0.06315),
        (0.0, 60.0, 0.35111, 0.35111),
        (0.3, 60.0, 0.28462, 0.18860),
        (0.6, 60.0, 0.24211, 0.13527),
        (1.0, 60.0, 0.20328, 0.10673),
    ] {
        let coat = Coat { eta: 1.5, thickness, sigma_a: Rgb([0.25, 1.0, 1.0]), roughness: None };
        let base = Arc::new(Lambertian::new(Rgb::splat(0.5)).unwrap());
        let albedo = total(coat, base, polar_deg);
        assert!((albedo[0] - red).abs() < 1e-5, "{thickness} {polar_deg}: {albedo:?}");
        assert!((albedo[2] - blue).abs() < 1e-5, "{thickness} {polar_deg}: {albedo:?}");
    }
}

/// Printed for aluminium at 532 nm below 1.8 units of the same varnish: the thesis's Figure 10(a).
#[test]
fn val_coloured_coat_over_smooth_metal() {
    let aluminium = Fresnel::conductor(Rgb::splat(0.939), Rgb::splat(6.420)).unwrap();
    for (polar_deg, red, blue) in [(0.0, 0.37473, 0.06219), (60.0, 0.33783, 0.09807)] {
        let coat = Coat { eta: 1.5, thickness: 1.8, sigma_a: Rgb([0.25, 1.0, 1.0]), roughness: None };
        let base = Arc::new(SpecularReflection::new(aluminium.immersed(coat.eta).unwrap()));
        let albedo = total(coat, base, polar_deg);
        assert!((albedo[0] - red).abs() < 1e-5, "{polar_deg}: {albedo:?}");
        assert!((albedo[2] - blue).abs() < 1e-5, "{polar_deg}: {albedo:?}");
    }
}

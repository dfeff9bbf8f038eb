//! Materials against the numbers of the thesis's figures, through their parameters alone.
#![expect(clippy::unwrap_used, clippy::panic, reason = "a test that cannot be set up has failed")]

use bxdf_tests::{Transport, directional_albedo};
use gonio::bxdf::{Bxdf, Pdf, TransportMode};
use gonio::ior::builtin;
use gonio::material::{Material, Model, Value, preset};
use gonio::real::Real;
use gonio::specimen::BxdfSpecimen;

type DVec3 = <f64 as Real>::Vec3;

/// Share of the light from a direction, in importance, that is scattered.
fn albedo(material: &Material<f64>, polar_deg: f64) -> [f64; 3] {
    let (sin, cos) = polar_deg.to_radians().sin_cos();
    let specimen = BxdfSpecimen::of_material("material", material.clone());
    directional_albedo(&specimen, [sin, 0.0, cos], Transport::Importance, 1e-7).value
}

/// Figure 11: grey plastic below a smooth coat of growing thickness; red, then green and blue.
#[test]
fn val_plastic_of_growing_thickness() {
    for (name, polar_deg, red, blue) in [
        ("coated_plastic_0", 0.0, 0.31607, 0.31607),
        ("coated_plastic_0.3", 0.0, 0.24949, 0.15209),
        ("coated_plastic_0.6", 0.0, 0.20671, 0.09559),
        ("coated_plastic_1", 0.0, 0.16720, 0.06315),
        ("coated_plastic_0", 60.0, 0.35111, 0.35111),
        ("coated_plastic_0.3", 60.0, 0.28462, 0.18860),
        ("coated_plastic_0.6", 60.0, 0.24211, 0.13527),
        ("coated_plastic_1", 60.0, 0.20328, 0.10673),
    ] {
        let found = albedo(&preset(name).unwrap().material().unwrap(), polar_deg);
        for (found, expected) in found.into_iter().zip([red, blue, blue]) {
            assert!((found - expected).abs() < 1e-4, "{name} at {polar_deg}°: {found}, not {expected}");
        }
    }
}

/// Figure 10(a): smooth aluminium below 1.8 units of the same coat. The expected values are of the index at
/// 532 nm in all channels; the preset has that in green.
#[test]
fn val_coated_aluminium() {
    let figure = preset("coated_aluminium").unwrap().material::<f64>().unwrap();
    let index = builtin("aluminium/Rakic-1995").unwrap().at(532.0).unwrap();
    let values = figure.description().given().iter().filter(|(path, _)| path != "reduction");
    let values = values.map(|(path, value)| (path.as_str(), value.clone()));
    let grey = [("eta", Value::Number(index.eta)), ("k", Value::Number(index.k))];
    let grey = Material::<f64>::new(Model::CarPaint, values.chain(grey)).unwrap();
    for (polar_deg, red, green) in [(0.0, 0.37473, 0.06219), (60.0, 0.33783, 0.09807)] {
        let found = albedo(&grey, polar_deg);
        assert!((found[0] - red).abs() < 1e-4, "red at {polar_deg}°: {}, not {red}", found[0]);
        for found in [found[1], albedo(&figure, polar_deg)[1]] {
            assert!((found - green).abs() < 1e-4, "green at {polar_deg}°: {found}, not {green}");
        }
    }
}

/// What the gloss and what the metal below it mirror leaves in one direction, at grazing incidence too, where
/// the direction in the coat has lost the cosine.
#[test]
fn a_coat_over_a_mirror_returns_one_ray() {
    let coated = preset("coated_aluminium").unwrap().material::<f64>().unwrap();
    for cosine in [1.0_f64, 0.5, 1e-3, 3e-7, 1e-12] {
        let wo = DVec3::new(((1.0 - cosine) * (1.0 + cosine)).sqrt(), 0.0, cosine);
        for uc in [0.0, 0.5, 0.97, 1.0 - f64::EPSILON] {
            let sample = coated.sample(wo, uc, [0.5; 2], TransportMode::Radiance).unwrap();
            assert_eq!(sample.wi, DVec3::new(-wo.x, -wo.y, wo.z), "uc {uc}");
        }
    }
}

/// Probability times weight of the two ways on from a smooth boundary: reflected, and across with its
/// direction.
fn ways(glass: &Material<f64>, wo: DVec3) -> (f64, f64, DVec3) {
    let sample = |uc| {
        let sample = glass.sample(wo, uc, [0.5; 2], TransportMode::Radiance).unwrap();
        let Pdf::Discrete(probability) = sample.pdf else { panic!("a smooth boundary has no density") };
        (probability * sample.weight[0], sample.wi)
    };
    let ((reflected, _), (across, inside)) = (sample(0.0), sample(1.0 - f64::EPSILON));
    (reflected, across, inside)
}

/// A sphere of absorbing glass, of radius 1 under a sky of radiance 1: R + (1 − R)² a / (1 − R a) with a =
/// e^(−2σ cos θt). Every bounce and every way through it is the material's.
#[test]
fn val_absorbing_glass_sphere() {
    for (sigma, expected) in [(0.5, [0.38410, 0.47089, 0.60337]), (2.0, [0.05689, 0.12095, 0.40641])] {
        let values = [("eta", 1.5.into()), ("absorbance_inside", Value::Number(sigma))];
        let glass = Material::<f64>::new(Model::Glass, values).unwrap();
        for (polar_deg, expected) in [0.0_f64, 60.0, 80.0].into_iter().zip(expected) {
            let (sin, cos) = polar_deg.to_radians().sin_cos();
            let (reflected, enters, inside) = ways(&glass, DVec3::new(sin, 0.0, cos));
            // A chord meets the sphere at the same angle at both ends.
            let chord = glass.transmittance(-2.0 * inside.z, true)[0];
            let (returned, leaves, _) = ways(&glass, inside);
            let mut radiance = reflected;
            let mut throughput = enters * chord;
            for _ in 0..200 {
                radiance += throughput * leaves;
                throughput *= returned * chord;
            }
            assert!(
                (radiance - expected).abs() < 1e-5,
                "σ {sigma}, {polar_deg}°: {radiance}, not {expected}"
            );
        }
        assert_eq!(glass.transmittance(1.0, false).0, [1.0; 3]);
    }
}

/// Figure 8: rough glass darkens, and all orders of scattering do not.
#[test]
fn rough_glass_loses_light_unless_it_follows_all_orders() {
    let total = |name: &str| albedo(&preset(name).unwrap().material().unwrap(), 180.0)[0];
    assert!(total("frosted_glass") < 0.85, "{}", total("frosted_glass"));
    assert!((total("frosted_glass_all_orders") - 1.0).abs() < 3e-3);
}

/// Absorption of a window is Beer's along the refracted way: the closed form of the thin sheet, η = 1.5, σ d
/// = 0.3, 60°.
#[test]
fn val_thin_glass() {
    let values = [("absorbance", 0.6.into()), ("thickness", Value::Number(0.5))];
    let window = Material::<f64>::new(Model::ThinGlass, values).unwrap();
    let (reflected, across, _) = ways(&window, DVec3::new(60.0_f64.to_radians().sin(), 0.0, 0.5));
    assert!((reflected - 0.12481).abs() < 1e-5 && (across - 0.57670).abs() < 1e-5, "{reflected} {across}");
}

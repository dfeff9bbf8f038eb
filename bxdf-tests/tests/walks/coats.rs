//! Refractive layers against walks and closed forms.

use std::sync::Arc;

use crate::closed_form::{
    diffuse_reflectance_outside, integrate, recirculation, smooth_over_lambertian,
    smooth_over_smooth_conductor,
};
use crate::fresnel;
use crate::layered::{self, Base, Interface};
use crate::lobes::distribution;
use crate::statistics::{CUBATURE, Checks, generator};
use crate::surface::{Shape, Surface};
use crate::vector::{Vector, direction};
use crate::walk_facts::{SHAPES, product};
use bxdf_tests::{Albedo, Energy, Specimen, Transport, directional_albedo};
use gonio::bxdf::Bxdf;
use gonio::fresnel::Fresnel;
use gonio::lobe::{
    Coat, Lambertian, Lobe, MicrofacetDielectric, MicrofacetReflection, RefractiveLayer, SpecularReflection,
};
use gonio::rgb::Rgb;
use gonio::specimen::BxdfSpecimen;
use gonio::stack::Stack;
use rayon::prelude::*;

const NORMAL: Vector = [0.0, 0.0, 1.0];
const UP_TO_80: [f64; 4] = [0.0, 45.0, 60.0, 80.0];
/// Index and extinction at 532 nm of the oracle's tables: Rakić 1995, Johnson and Christy 1972 and 1974.
const METALS: [(&str, [f64; 2]); 4] = [
    ("aluminium", [0.93878, 6.41954]),
    ("gold", [0.54386, 2.23087]),
    ("silver", [0.05401, 3.42899]),
    ("chromium", [3.03429, 3.33000]),
];

fn lambertian(reflectance: [f64; 3]) -> Arc<dyn Bxdf<f64>> {
    Arc::new(Lambertian::new(Rgb(reflectance)).unwrap())
}

/// A metal whose constants are over the index outside of a coat of index `eta`.
fn rough_metal([eta_base, k]: [f64; 2], eta: f64, surface: &Surface) -> Arc<dyn Bxdf<f64>> {
    let fresnel = Fresnel::conductor(Rgb::splat(eta_base), Rgb::splat(k)).unwrap().immersed(eta).unwrap();
    Arc::new(MicrofacetReflection::new(distribution(surface), fresnel))
}

/// A coat with one optical depth per channel.
fn coat(eta: f64, optical_depths: [f64; 3], roughness: Option<Surface>) -> Coat<f64> {
    let roughness = roughness.as_ref().map(distribution);
    Coat { eta, thickness: 1.0, sigma_a: Rgb(optical_depths), roughness }
}

fn layer(coat: Coat<f64>, base: Arc<dyn Bxdf<f64>>) -> RefractiveLayer<f64> {
    RefractiveLayer::new(coat, base).unwrap()
}

fn albedo_of(lobes: Vec<Lobe<f64>>, wo: Vector) -> Albedo {
    let stack = Stack::new(lobes).unwrap();
    directional_albedo(
        &BxdfSpecimen::of_stack("coat", stack, Energy::Conserving),
        wo,
        Transport::Radiance,
        CUBATURE,
    )
}

/// A smooth coat with its gloss.
fn with_gloss(layer: &RefractiveLayer<f64>, eta: f64) -> Vec<Lobe<f64>> {
    let gloss = SpecularReflection::new(Fresnel::dielectric(eta).unwrap());
    vec![gloss.into(), layer.clone().into()]
}

/// R and T of single scattering at the interface of a rough coat, from outside.
fn interface(surface: &Surface, eta: f64, wo: Vector) -> [f64; 2] {
    let boundary = MicrofacetDielectric::new(distribution(surface), eta).unwrap();
    let tinted = boundary.with_tints(Rgb([1.0, 0.0, 0.0]), Rgb([0.0, 1.0, 0.0])).unwrap();
    let albedo =
        directional_albedo(&BxdfSpecimen::of_lobe("interface", tinted), wo, Transport::Importance, CUBATURE);
    [albedo.value[0], albedo.value[1]]
}

/// The signed extremes, for the eye.
fn print_range(what: &str, errors: impl IntoIterator<Item = f64>) {
    let [low, high] = errors
        .into_iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], error| [low.min(error), high.max(error)]);
    println!("{what}: errors {low:+.4} … {high:+.4}");
}

/// Over white, f(n, n) = (1 − F₀)² e^(−2τ) / (π η² (1 − K(τ))), and its average over the hemisphere is
/// (1 − F_dr) / (1 − F₀) times that. So `eval` tells the diffuse reflectance of the interface from either side.
#[test]
fn a_layer_over_white_knows_the_diffuse_reflectance_of_its_interface() {
    let mut largest = [0.0_f64; 2];
    let mut compare = |which: usize, what: &str, found: f64, expected: f64| {
        let error = (found - expected).abs();
        largest[which] = largest[which].max(error);
        assert!(error < [1e-9, 1e-6][which], "{what}: {found} for {expected}");
    };
    for eta in [1.1, 1.33, 1.5, 1.8, 2.0, 2.4] {
        let optical_depths = [0.0, 0.1, 0.6];
        let layer =
            BxdfSpecimen::of_lobe("layer", layer(coat(eta, optical_depths, None), lambertian([1.0; 3])));
        let f = |wi: Vector| layer.eval(NORMAL, wi, Transport::Radiance);
        let enters = 1.0 - fresnel::dielectric(1.0, eta);
        for (channel, tau) in optical_depths.into_iter().enumerate() {
            let once = (enters / eta).powi(2) * (-2.0 * tau).exp() / core::f64::consts::PI;
            let found = 1.0 - once / f(NORMAL)[channel];
            let which = usize::from(tau > 0.0);
            compare(which, &format!("η {eta} τ {tau}: K"), found, recirculation(eta, tau));
        }
        let mean = integrate(0.0, 1.0, |mu| 2.0 * mu * f([(1.0 - mu * mu).sqrt(), 0.0, mu])[0]);
        let found = 1.0 - enters * mean / f(NORMAL)[0];
        compare(0, &format!("η {eta}: from outside"), found, diffuse_reflectance_outside(eta));
    }
    println!("largest error {:.1e}, with absorption {:.1e}", largest[0], largest[1]);
}

/// Printed: K(τ) for η = 1.5.
#[test]
fn val_what_an_absorbing_layer_returns_to_its_base() {
    let table = [(0.05, 0.472329), (0.1, 0.382344), (0.3, 0.178853), (0.6, 0.064206), (1.0, 0.018106)];
    for (tau, expected) in table {
        let layer = BxdfSpecimen::of_lobe("layer", layer(coat(1.5, [tau; 3], None), lambertian([1.0; 3])));
        let once = (0.96_f64 / 1.5).powi(2) * (-2.0 * tau).exp() / core::f64::consts::PI;
        let found = 1.0 - once / layer.eval(NORMAL, NORMAL, Transport::Radiance)[0];
        assert!((found - expected).abs() < 1e-6, "τ {tau}: {found} for {expected}");
    }
}

/// 72 walks, three reflectances at a time.
#[test]
fn smooth_coat_over_lambertian_returns_what_the_walk_does() {
    let reflectances = [[0.2, 0.5, 0.8], [1.0; 3]];
    let cases = product(&product(&[1.3, 1.5, 1.8], &[0.0, 0.3]), &[0.0, 60.0, 80.0]);
    let results: Vec<_> = product(&cases, &reflectances)
        .into_par_iter()
        .flat_map_iter(|(((eta, tau), polar_deg), reflectance)| {
            let wo = direction(polar_deg, 0.0);
            let layer = layer(coat(eta, [tau; 3], None), lambertian(reflectance));
            let albedo = albedo_of(with_gloss(&layer, eta), wo);
            let channels = if reflectance[0] == reflectance[1] { 1 } else { 3 };
            (0..channels).map(move |channel| {
                let base = Base::Lambertian { albedo: reflectance[channel] };
                let walked = layered::Coat { interface: Interface::Smooth, eta, optical_depth: tau };
                let what = format!("coat {walked:?} over {base:?} at {polar_deg}°");
                let exact = fresnel::dielectric(wo[2], eta)
                    + smooth_over_lambertian(wo[2], eta, tau, reflectance[channel]);
                let estimate = layered::walk(&walked, &base, wo, 1 << 16, &mut generator(&what));
                (what, albedo.value[channel], albedo.error[channel], exact, estimate.total)
            })
        })
        .collect();
    assert_eq!(results.len(), 72);
    let mut checks = Checks::new();
    for (what, albedo, bound, exact, total) in &results {
        assert!((albedo - exact).abs() < bound + 1e-6, "{what}: {albedo} ± {bound:e} for {exact}");
        checks.expect(what, total, *albedo, *bound);
    }
    print_range("closed form", results.iter().map(|(_, albedo, _, exact, _)| albedo - exact));
    checks.expect_jointly();
    checks.finish();
}

/// All bounces share one angle: exact.
#[test]
fn smooth_coat_over_smooth_metal_is_a_geometric_series() {
    for (_, index) in METALS {
        let fresnel = Fresnel::conductor(Rgb::splat(index[0]), Rgb::splat(index[1])).unwrap();
        for eta in [1.3, 1.5, 1.8] {
            let base = SpecularReflection::new(fresnel.immersed(eta).unwrap());
            let optical_depths = [0.0, 0.3, 1.8];
            let layer = layer(coat(eta, optical_depths, None), Arc::new(base));
            for polar_deg in [0.0, 45.0, 80.0, 89.0] {
                let wo = direction(polar_deg, 0.0);
                let albedo = albedo_of(with_gloss(&layer, eta), wo);
                for (channel, tau) in optical_depths.into_iter().enumerate() {
                    let expected = fresnel::dielectric(wo[2], eta)
                        + smooth_over_smooth_conductor(wo[2], eta, tau, index);
                    let error = (albedo.value[channel] - expected).abs();
                    assert!(error < 1e-13, "{index:?} {eta} {tau} {polar_deg}°: {albedo:?} for {expected}");
                }
            }
        }
    }
}

/// The series over a rough metal is an approximation.
#[test]
fn smooth_coat_over_rough_metal_is_close_to_the_walk() {
    let cases = product(&METALS, &[0.1, 0.2, 0.3, 0.5]);
    let results: Vec<_> = cases
        .into_par_iter()
        .flat_map_iter(|((name, index), alpha)| {
            let surface = Surface::isotropic(Shape::Ggx, alpha);
            let optical_depths = [0.0, 0.1, 0.3];
            let layer = layer(coat(1.5, optical_depths, None), rough_metal(index, 1.5, &surface));
            UP_TO_80.into_iter().flat_map(move |polar_deg| {
                let wo = direction(polar_deg, 0.0);
                let albedo = albedo_of(with_gloss(&layer, 1.5), wo);
                [0, 2].map(|channel| {
                    let tau = optical_depths[channel];
                    let walked = layered::Coat { interface: Interface::Smooth, eta: 1.5, optical_depth: tau };
                    let base = Base::RoughConductor { surface, eta: index[0], k: index[1] };
                    let what = format!("coat over {name}, α {alpha}, τ {tau}, {polar_deg}°");
                    let estimate = layered::walk(&walked, &base, wo, SAMPLES, &mut generator(&what));
                    (what, albedo.value[channel], albedo.error[channel], estimate.total)
                })
            })
        })
        .collect();
    assert_eq!(results.len(), 128);
    let mut checks = Checks::new();
    for (what, albedo, bound, total) in &results {
        // The error lies in −0.020 … +0.001.
        checks.expect(what, total, albedo + 0.0095, 0.0105 + bound);
    }
    print_range("rough metal", results.iter().map(|(_, albedo, _, total)| albedo - total.value()));
    checks.finish();
}

/// Walks per case where a bound is a few thousandths.
const SAMPLES: usize = 1 << 16;

/// T ↦ T / (R + T) over any Lambertian base; over white, without absorption, that is all there is.
#[test]
fn rough_coat_over_lambertian_is_close_to_the_walk() {
    let reflectances = [0.5, 0.8, 1.0];
    let cases = product(&SHAPES, &[0.1, 0.3, 0.5]);
    let results: Vec<_> = cases
        .into_par_iter()
        .flat_map_iter(|(shape, alpha)| {
            let surface = Surface::isotropic(shape, alpha);
            let layer = layer(coat(1.5, [0.0; 3], Some(surface)), lambertian(reflectances));
            [0.0, 60.0, 80.0].into_iter().flat_map(move |polar_deg| {
                let wo = direction(polar_deg, 0.0);
                let [reflected, transmitted] = interface(&surface, 1.5, wo);
                let gloss = reflected / (reflected + transmitted);
                let albedo = albedo_of(vec![layer.clone().into()], wo);
                let white = albedo.value[2] + gloss;
                assert!((white - 1.0).abs() < 3e-3, "{surface:?} {polar_deg}°: {white} of white");
                [0, 1, 2].map(|channel| {
                    let walked = layered::Coat {
                        interface: Interface::MultipleScattering(surface),
                        eta: 1.5,
                        optical_depth: 0.0,
                    };
                    let base = Base::Lambertian { albedo: reflectances[channel] };
                    let what = format!("{surface:?} over {base:?} at {polar_deg}°");
                    let estimate = layered::walk(&walked, &base, wo, SAMPLES, &mut generator(&what));
                    (what, polar_deg, albedo.value[channel] + gloss, albedo.error[channel], estimate.total)
                })
            })
        })
        .collect();
    assert_eq!(results.len(), 54);
    let mut checks = Checks::new();
    for (what, polar_deg, albedo, bound, total) in &results {
        checks.expect(what, total, *albedo, bound + if *polar_deg > 60.0 { 0.021 } else { 0.003 });
    }
    let range = |grazing: bool| {
        let of = results.iter().filter(move |result| (result.1 > 60.0) == grazing);
        of.map(|(_, _, albedo, _, total)| albedo - total.value())
    };
    print_range("up to 60°", range(false));
    print_range("at 80°", range(true));
    checks.finish();
}

/// The same over a metal: directions are not broadened, so it is an approximation for small roughness.
#[test]
fn rough_coat_over_rough_metal_is_close_to_the_walk() {
    let [(_, index), ..] = METALS;
    let cases = product(&[(0.05, 0.012), (0.1, 0.041)], &[0.1, 0.2, 0.5]);
    let results: Vec<_> = cases
        .into_par_iter()
        .flat_map_iter(|((alpha_coat, bound), alpha)| {
            let [above, below] = [alpha_coat, alpha].map(|alpha| Surface::isotropic(Shape::Ggx, alpha));
            let optical_depths = [0.0, 0.1, 0.3];
            let layer = layer(coat(1.5, optical_depths, Some(above)), rough_metal(index, 1.5, &below));
            UP_TO_80.into_iter().flat_map(move |polar_deg| {
                let wo = direction(polar_deg, 0.0);
                let [reflected, transmitted] = interface(&above, 1.5, wo);
                let gloss = reflected / (reflected + transmitted);
                let albedo = albedo_of(vec![layer.clone().into()], wo);
                [0, 2].map(|channel| {
                    let tau = optical_depths[channel];
                    let interface = Interface::MultipleScattering(above);
                    let walked = layered::Coat { interface, eta: 1.5, optical_depth: tau };
                    let base = Base::RoughConductor { surface: below, eta: index[0], k: index[1] };
                    let what =
                        format!("coat of α {alpha_coat} over metal of α {alpha}, τ {tau}, {polar_deg}°");
                    let estimate = layered::walk(&walked, &base, wo, SAMPLES, &mut generator(&what));
                    let cubature = albedo.error[channel];
                    (what, bound, albedo.value[channel] + gloss, cubature, estimate.total)
                })
            })
        })
        .collect();
    assert_eq!(results.len(), 48);
    let mut checks = Checks::new();
    for (what, bound, albedo, cubature, total) in &results {
        checks.expect(what, total, *albedo, bound + cubature);
    }
    for of in [0.012, 0.041] {
        let with = results.iter().filter(|result| result.1 == of);
        print_range(&format!("bound {of}"), with.map(|(_, _, albedo, _, total)| albedo - total.value()));
    }
    checks.finish();
}

/// The discrepancy between smooth and rough coats that the thesis describes in its §7: over white without absorption
/// both return everything, but for what the gloss of single scattering loses, R / (R + T) − R.
#[test]
fn smooth_and_rough_coats_over_white_return_as_much() {
    let white = || lambertian([1.0; 3]);
    let smooth = layer(coat(1.5, [0.0; 3], None), white());
    for polar_deg in [0.0, 30.0, 60.0, 80.0, 87.0] {
        let albedo = albedo_of(with_gloss(&smooth, 1.5), direction(polar_deg, 0.0));
        let error = (albedo.value[0] - 1.0).abs();
        assert!(error < albedo.error[0] + 1e-6, "smooth at {polar_deg}°: {albedo:?}");
    }
    // Largest deficit up to 60°, and at 87°, where it is largest.
    let cases = [
        (Shape::Ggx, 0.1, 0.0062, 0.029),
        (Shape::Ggx, 0.3, 0.0062, 0.052),
        (Shape::Ggx, 0.5, 0.0062, 0.123),
        (Shape::Beckmann, 0.1, 0.0062, 0.032),
        (Shape::Beckmann, 0.3, 0.0062, 0.009),
        (Shape::Beckmann, 0.5, 0.0062, 0.009),
    ];
    cases.par_iter().for_each(|&(shape, alpha, up_to_60, at_most)| {
        let surface = Surface::isotropic(shape, alpha);
        let gloss = MicrofacetReflection::new(distribution(&surface), Fresnel::dielectric(1.5).unwrap());
        let layer = layer(coat(1.5, [0.0; 3], Some(surface)), white());
        for polar_deg in [0.0, 30.0, 60.0, 80.0, 87.0] {
            let wo = direction(polar_deg, 0.0);
            let albedo = albedo_of(vec![gloss.clone().into(), layer.clone().into()], wo);
            let [reflected, transmitted] = interface(&surface, 1.5, wo);
            let deficit = reflected / (reflected + transmitted) - reflected;
            let total = albedo.value[0];
            println!("{shape:?} {alpha} {polar_deg}°: total {total:.4}, deficit {deficit:.4}");
            // 3e-3: tables of the layer.
            assert!((total + deficit - 1.0).abs() < 3e-3, "{surface:?} {polar_deg}°: {total} {deficit}");
            let limit = if polar_deg > 60.0 { at_most } else { up_to_60 };
            assert!(deficit < limit + 5e-4 && deficit > -5e-4, "{surface:?} {polar_deg}°: deficit {deficit}");
        }
    });
}

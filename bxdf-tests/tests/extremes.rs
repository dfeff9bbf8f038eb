//! Random calls at the extremes of directions, uniforms and parameters, on every lobe, stack and material.
//!
//! The long form: `BXDF_TESTS_CALLS=100000000 cargo test --test extremes -- --nocapture`, so many for each family in each
//! precision; it prints what each family came to.
#![expect(clippy::unwrap_used, reason = "a test that cannot be set up has failed")]

use std::collections::BTreeMap;
use std::sync::Arc;

use bxdf_tests::stability::STABLE_ULPS;
use bxdf_tests::{ExtremeCalls, Specimen, extreme_calls, run_seed};
use gonio::bxdf::Bxdf;
use gonio::fresnel::Fresnel;
use gonio::lobe::{
    Coat, DielectricSpecular, Fabric, Lambertian, Lobe, MicrofacetDielectric, MicrofacetReflection,
    OrenNayar, OrenNayarModel, RefractiveLayer, SpecularReflection, SpecularTransmission, ThinSheet,
};
use gonio::microfacet::{ALPHA_MIN, Distribution, Shadowing, Shape};
use gonio::real::Real;
use gonio::rgb::Rgb;
use gonio::specimen::{BxdfSpecimen, catalogue};
use rayon::prelude::*;

/// Calls per family and precision unless told otherwise.
const CALLS: u64 = 1_000_000;
/// Calls of one piece of work.
const BATCH: u64 = 50_000;
/// What rounding may add to a weight, in single precision; in double it is held to the same.
const WEIGHT: f64 = STABLE_ULPS * f32::EPSILON as f64;
/// The largest deviation of a sampled direction's length from 1 \[ulp\].
const LENGTH: f64 = 4.0;

/// Lobes whose parameters are at the ends of their ranges or next to a switch.
fn edges<F: Real>() -> Vec<Box<dyn Specimen>> {
    let f = F::from_f64;
    let grey = |x: f64| Rgb::splat(f(x));
    let epsilon = F::EPSILON.to_f64();
    let mut lobes: Vec<(String, Lobe<F>)> = Vec::new();
    let mut add = |name: String, lobe: Lobe<F>| lobes.push((name, lobe));
    for reflectance in [0.0, 1.0] {
        add(format!("lambertian_{reflectance}"), Lambertian::new(grey(reflectance)).unwrap().into());
        for roughness in [0.0, 1e-30, 1.0] {
            let eon =
                OrenNayar::new(OrenNayarModel::EnergyPreserving, grey(reflectance), f(roughness)).unwrap();
            add(format!("energy_preserving_{reflectance}_{roughness}"), eon.into());
        }
        for (model, sigma) in
            [(OrenNayarModel::Qualitative, F::HALF * F::PI), (OrenNayarModel::Full, f(0.66))]
        {
            let steep = OrenNayar::new(model, grey(reflectance), sigma).unwrap();
            add(format!("oren_nayar_{model:?}_{reflectance}"), steep.into());
        }
        for (backscatter, exponent) in [(0.0, 1), (1.0, 16)] {
            let fabric = Fabric::new(grey(reflectance), f(backscatter), exponent).unwrap();
            add(format!("fabric_{reflectance}_{backscatter}_{exponent}"), fabric.into());
        }
        add(
            format!("transmission_{reflectance}"),
            SpecularTransmission::new(grey(reflectance)).unwrap().into(),
        );
    }
    let conductors = [
        (0.0, 1e-30),
        (0.0, 20.0),
        (1e-30, 1e-30),
        (1.0, 0.0),
        (1.0, 1e-30),
        (1.0 + epsilon, 0.0),
        (4.0, 0.0),
        (1e3, 1e3),
    ]
    .map(|(eta, k)| (format!("{eta}+i{k}"), Fresnel::conductor(grey(eta), grey(k)).unwrap()));
    let indices = [1.0, 1.0 + epsilon, 1.0 - epsilon, 1e-3, 0.25, 4.0, 1e3, 1.0001, 1.5, 1.0 / 1.5];
    let mut distributions = Vec::new();
    for shape in [Shape::Ggx, Shape::Beckmann, Shape::Gaussian] {
        for [x, y] in [[ALPHA_MIN, ALPHA_MIN], [9e-5, 9e-5], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [0.05, 0.05]]
        {
            let smith = Distribution::new(shape, f(x), f(y)).unwrap();
            distributions.push((format!("{shape:?}_{x}_{y}"), smith));
            for shadowing in [Shadowing::SmithSeparable, Shadowing::VCavity] {
                if let Ok(other) = smith.with_shadowing(shadowing) {
                    distributions.push((format!("{shape:?}_{shadowing:?}_{x}_{y}"), other));
                }
            }
        }
    }
    for (name, fresnel) in &conductors {
        add(format!("conductor_{name}"), SpecularReflection::new(*fresnel).into());
    }
    for eta in indices {
        add(format!("dielectric_{eta}"), DielectricSpecular::new(f(eta)).unwrap().into());
        for depth in [0.0, 1e-30, 1e3] {
            let sheet = ThinSheet::new(f(eta), grey(depth), Rgb::WHITE).unwrap();
            add(format!("sheet_{eta}_{depth}"), sheet.into());
        }
    }
    for (i, (name, distribution)) in distributions.iter().enumerate() {
        // Each roughness with some of the indices, each index with some roughness.
        let (metal, fresnel) = &conductors[i % conductors.len()];
        add(format!("{metal}_{name}"), MicrofacetReflection::new(*distribution, *fresnel).into());
        for k in 0..3 {
            let eta = indices[(3 * i + k) % indices.len()];
            let glass = MicrofacetDielectric::new(*distribution, f(eta)).unwrap();
            add(format!("glass_{eta}_{name}"), glass.into());
        }
    }
    let narrow = Distribution::new(Shape::Ggx, f(ALPHA_MIN), f(ALPHA_MIN)).unwrap();
    let bases: [(&str, Arc<dyn Bxdf<F>>); 3] = [
        ("plane", Arc::new(SpecularReflection::new(Fresnel::constant(Rgb::WHITE).unwrap()))),
        ("white", Arc::new(Lambertian::new(Rgb::WHITE).unwrap())),
        ("mirror", Arc::new(MicrofacetReflection::new(narrow, Fresnel::constant(Rgb::WHITE).unwrap()))),
    ];
    for (eta, depth, alpha) in [
        (1.0, 0.0, None),
        (1.0 + epsilon, 1e-30, None),
        (4.0, 1e3, None),
        (1.5, 0.0, Some(1.0)),
        (1e3, 0.0, None),
        (1e3, 0.0, Some(0.3)),
    ] {
        for (base_name, base) in &bases {
            let roughness = alpha.map(|alpha| Distribution::new(Shape::Ggx, f(alpha), f(alpha)).unwrap());
            let coat = Coat { eta: f(eta), thickness: F::ONE, sigma_a: grey(depth), roughness };
            let layer = RefractiveLayer::new(coat, Arc::clone(base)).unwrap();
            add(format!("coat_{eta}_{depth}_{alpha:?}_{base_name}"), layer.into());
        }
    }
    lobes
        .into_iter()
        .map(|(name, lobe)| {
            Box::new(BxdfSpecimen::of_lobe(&format!("edges/{name}"), lobe)) as Box<dyn Specimen>
        })
        .collect()
}

/// The largest weight that theory allows the samples of a specimen, in the measure of power; `None` where they have no bound
/// of their own: mixtures whose parts are picked by estimates, cosine-sampled lobes that rise towards grazing directions,
/// and Gaussian normals, whose density is only nearly theirs.
fn bound(name: &str) -> Option<f64> {
    let family = name.split('/').next().unwrap_or_default();
    let is_perfect = match family {
        "lambertian" | "ideal_mirror" | "ideal_transmission" | "higher_orders" => true,
        "smooth_conductor" | "smooth_dielectric" | "smooth_gloss" | "smooth_limit" | "coloured_glass" => true,
        "rough_mirror" | "rough_gloss" | "rough_conductor" | "rough_dielectric" => true,
        // A base with peaks is picked at least one time in ten. The series has a spike at grazing incidence that the cosine
        // does not sample: where a smooth coat is nearly matched, and at the Brewster angle of a dense one.
        "coat" => return Some(10.0 + WEIGHT),
        "edges" if name.contains("coat") => {
            let has_spike = name.contains("coat_1.00") || name.contains("coat_1000_0_None");
            return (!has_spike).then_some(10.0 + WEIGHT);
        }
        "edges" => ["lambertian", "transmission", "conductor", "dielectric", "glass", "+i"]
            .iter()
            .any(|lobe| name.contains(lobe)),
        // One of three channels may pick the component for all.
        "thin_sheet" => return Some(3.0 + WEIGHT),
        _ => false,
    };
    (is_perfect && !name.to_lowercase().contains("gaussian")).then_some(1.0 + WEIGHT)
}

#[test]
fn calls_at_the_extremes_return_what_a_bxdf_may_return() {
    let seed = run_seed();
    println!("BXDF_TESTS_SEED={seed}");
    let calls: u64 = std::env::var("BXDF_TESTS_CALLS").map_or(CALLS, |text| text.parse().expect("a number"));
    let mut families: BTreeMap<(String, String), Vec<Box<dyn Specimen>>> = BTreeMap::new();
    for specimen in catalogue().unwrap().into_iter().chain(edges::<f32>()).chain(edges::<f64>()) {
        let name = specimen.name();
        let family = name.split('/').next().unwrap_or_default().to_owned();
        let precision = name.rsplit('/').next().unwrap_or_default().to_owned();
        families.entry((family, precision)).or_default().push(specimen);
    }
    let mut failures = Vec::new();
    for ((family, precision), specimens) in families {
        let share = calls.div_ceil(specimens.len() as u64);
        let work: Vec<(&dyn Specimen, u64, u64)> = specimens
            .iter()
            .flat_map(|specimen| {
                (0..share.div_ceil(BATCH))
                    .map(move |batch| (&**specimen, batch, BATCH.min(share - batch * BATCH)))
            })
            .collect();
        let found: Vec<(String, ExtremeCalls)> = work
            .into_par_iter()
            .map(|(specimen, batch, calls)| (specimen.name(), extreme_calls(specimen, seed, batch, calls)))
            .collect();
        let calls_made: u64 = found.iter().map(|(_, found)| found.calls).sum();
        let largest =
            |of: fn(&ExtremeCalls) -> f64| found.iter().map(|(_, found)| of(found)).fold(0.0, f64::max);
        let (weight, length) =
            (largest(|found| found.largest_weight), largest(|found| found.largest_length_error));
        println!("{family:26} {precision} {calls_made:9} calls, weight {weight:.9}, length {length:.2} ulp");
        for (name, found) in found {
            if found.largest_length_error > LENGTH {
                failures.push(format!(
                    "{name}: a direction is {} ulps off unit length",
                    found.largest_length_error
                ));
            }
            if bound(&name).is_some_and(|bound| found.largest_weight > bound) {
                failures.push(format!("{name}: a weight of {}", found.largest_weight));
            }
            failures.extend(found.fault);
        }
        assert!(calls_made >= calls || !failures.is_empty(), "{family}: {calls_made} calls");
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

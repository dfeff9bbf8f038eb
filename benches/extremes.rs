#![expect(clippy::expect_used, reason = "a benchmark that cannot be set up has failed")]
//! Time of `sample`, `eval` and `pdf` at the extremes of their inputs over the time of ordinary ones.
//!
//! `cargo bench --bench extremes`. Nothing may loop, or stall on denormals: a ratio above 4 is a defect. Pools take turns
//! within one run, so that the machine's moods meet all of them; each figure is the median of the rounds, with the quartiles
//! of the ratio.

use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use gonio::bxdf::Bxdf;
use gonio::fresnel::Fresnel;
use gonio::lobe::{
    Coat, DielectricSpecular, Fabric, KullaContyDielectric, KullaContyReflection, Lambertian,
    MicrofacetDielectric, MicrofacetReflection, OrenNayar, OrenNayarModel, RefractiveLayer,
    SpecularReflection, SpecularTransmission, ThinSheet,
};
use gonio::microfacet::{Distribution, Shadowing, Shape};
use gonio::real::{Real, Vector};
use gonio::rgb::Rgb;
use rand::{RngExt, SeedableRng};
use vertex::{Vertex, path};

mod vertex;

const ROUNDS: usize = 41;
const VERTICES: usize = 512;
const POOLS: [&str; 5] = ["ordinary", "grazing", "normal incidence", "ends of uniforms", "wi about wo"];

/// From ½ down to `lowest`, evenly in the logarithm.
fn tiny(x: f64, lowest: f64) -> f64 {
    (0.5_f64.ln() + x * (lowest.ln() - 0.5_f64.ln())).exp().max(lowest)
}

fn direction<F: Real>(sine: f64, cosine: f64, azimuth: f64) -> F::Vec3 {
    let (sin, cos) = (core::f64::consts::TAU * azimuth).sin_cos();
    F::Vec3::from_f64([sine * cos, sine * sin, cosine])
}

fn pool<F: Real>(kind: &str) -> Vec<Vertex<F>> {
    let mut generator = rand_pcg::Pcg64Mcg::seed_from_u64(0);
    let smallest = if F::NAME == "f32" { f64::from(f32::from_bits(1)) } else { f64::from_bits(1) };
    // Of the steps of any generator.
    let step = 0.5 * F::EPSILON.to_f64();
    let mut uniform = || f64::from(generator.random::<f32>());
    (0..VERTICES)
        .map(|_| {
            let [wo, wi] = [(); 2].map(|()| {
                let (x, azimuth) = (uniform(), uniform());
                match kind {
                    "grazing" => {
                        let cosine = tiny(x, smallest);
                        direction::<F>((1.0 - cosine * cosine).sqrt(), cosine, azimuth)
                    }
                    "normal incidence" => {
                        let sine = tiny(x, smallest);
                        direction::<F>(sine, (1.0 - sine * sine).sqrt(), azimuth)
                    }
                    _ => direction::<F>(x.sqrt(), (1.0 - x).sqrt(), azimuth),
                }
            });
            let wi = if kind == "wi about wo" { wo } else { wi };
            let u = [(); 3].map(|()| {
                let (x, end) = (uniform(), uniform());
                F::from_f64(match kind {
                    "ends of uniforms" if end < 0.1 => 0.0,
                    "ends of uniforms" if end < 0.5 => tiny(x, step),
                    "ends of uniforms" => 1.0 - tiny(x, step),
                    _ => x,
                })
            });
            (wo, wi, u)
        })
        .collect()
}

fn lobes<F: Real>() -> Vec<(&'static str, Box<dyn Bxdf<F>>)> {
    let f = F::from_f64;
    let white = Fresnel::constant(Rgb::WHITE).expect("a valid reflectance");
    let gold =
        Fresnel::conductor(Rgb([0.13, 0.45, 1.42].map(f)), Rgb([4.1, 2.4, 1.9].map(f))).expect("a metal");
    let rough = |shape, alpha| Distribution::new(shape, f(alpha), f(alpha)).expect("a valid roughness");
    let cavities = rough(Shape::Beckmann, 0.3).with_shadowing(Shadowing::VCavity).expect("cavities");
    let glass = |shape, alpha| MicrofacetDielectric::new(rough(shape, alpha), f(1.5)).expect("a valid index");
    let eon = OrenNayar::new(OrenNayarModel::EnergyPreserving, Rgb::WHITE, f(0.5)).expect("a roughness");
    let coat = Coat { eta: f(1.5), thickness: F::ONE, sigma_a: Rgb::splat(f(0.1)), roughness: None };
    let paper = Arc::new(Lambertian::new(Rgb::WHITE).expect("a reflectance"));
    vec![
        ("lambertian", Box::new(Lambertian::new(Rgb::WHITE).expect("a reflectance"))),
        ("oren_nayar", Box::new(eon)),
        ("fabric", Box::new(Fabric::new(Rgb::WHITE, f(0.5), 4).expect("a fabric"))),
        ("specular_reflection", Box::new(SpecularReflection::new(gold))),
        ("specular_transmission", Box::new(SpecularTransmission::new(Rgb::WHITE).expect("a transmittance"))),
        ("dielectric_specular", Box::new(DielectricSpecular::new(f(1.5)).expect("an index"))),
        ("thin_sheet", Box::new(ThinSheet::new(f(1.5), Rgb::splat(f(0.1)), Rgb::WHITE).expect("a sheet"))),
        ("reflection, GGX 0.3", Box::new(MicrofacetReflection::new(rough(Shape::Ggx, 0.3), gold))),
        ("reflection, GGX 1e-4", Box::new(MicrofacetReflection::new(rough(Shape::Ggx, 1e-4), gold))),
        ("reflection, Beckmann 0.3", Box::new(MicrofacetReflection::new(rough(Shape::Beckmann, 0.3), gold))),
        (
            "reflection, Beckmann 1e-4",
            Box::new(MicrofacetReflection::new(rough(Shape::Beckmann, 1e-4), gold)),
        ),
        ("reflection, Gaussian 0.3", Box::new(MicrofacetReflection::new(rough(Shape::Gaussian, 0.3), gold))),
        ("reflection, V-cavities 0.3", Box::new(MicrofacetReflection::new(cavities, gold))),
        ("glass, GGX 0.3", Box::new(glass(Shape::Ggx, 0.3))),
        ("glass, Beckmann 1e-3", Box::new(glass(Shape::Beckmann, 1e-3))),
        ("higher orders", Box::new(KullaContyReflection::new(rough(Shape::Ggx, 0.5), white))),
        ("higher orders of glass", Box::new(KullaContyDielectric::new(&glass(Shape::Ggx, 0.5)))),
        ("coat over Lambert", Box::new(RefractiveLayer::new(coat, paper).expect("a coat"))),
    ]
}

fn median(sorted: &mut [f64], quantile: f64) -> f64 {
    sorted.sort_by(f64::total_cmp);
    sorted[(quantile * (sorted.len() - 1) as f64) as usize]
}

/// The largest ratio.
fn measure<F: Real>() -> f64 {
    let pools = POOLS.map(pool::<F>);
    let mut largest: f64 = 0.0;
    println!("\n{}: ns per vertex, and times of the extremes over it (quartiles)", F::NAME);
    for (name, lobe) in lobes::<F>() {
        let mut times: [Vec<f64>; POOLS.len()] = Default::default();
        for _ in 0..ROUNDS {
            for (pool, times) in pools.iter().zip(&mut times) {
                let start = Instant::now();
                black_box(path(&*lobe, black_box(pool)));
                times.push(start.elapsed().as_secs_f64() * 1e9 / VERTICES as f64);
            }
        }
        let ordinary = times[0].clone();
        print!("{name:28} {:7.1}", median(&mut times[0], 0.5));
        for (kind, times) in POOLS.iter().zip(&times).skip(1) {
            let mut ratios: Vec<f64> =
                times.iter().zip(&ordinary).map(|(time, ordinary)| time / ordinary).collect();
            let ratio = median(&mut ratios, 0.5);
            print!("  {kind} {ratio:.2} ({:.2}–{:.2})", median(&mut ratios, 0.25), median(&mut ratios, 0.75));
            largest = largest.max(ratio);
        }
        println!();
    }
    largest
}

fn main() {
    let largest = measure::<f32>().max(measure::<f64>());
    println!("\nlargest ratio {largest:.2}");
}

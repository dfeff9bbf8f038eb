#![expect(clippy::expect_used, reason = "a benchmark that cannot be set up has failed")]
//! Time of a path's work at one vertex: `sample`, then `eval` and `pdf` for another direction.
//!
//! `cargo bench --bench lobes`; each figure is the time of 1,024 vertices whose directions come from a pool, so that
//! nothing is predicted or hoisted. Compare within one run only.

use divan::{Bencher, black_box, counter::ItemsCount};
use gonio::bxdf::Bxdf;
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lambertian, MicrofacetDielectric, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::real::Real;
use gonio::rgb::Rgb;
use gonio::warp::cosine_hemisphere;
use rand::{RngExt, SeedableRng};
use vertex::{Vertex, path};

mod vertex;

fn main() {
    divan::main();
}

const VERTICES: usize = 1024;

fn pool<F: Real>() -> Vec<Vertex<F>> {
    let mut generator = rand_pcg::Pcg64Mcg::seed_from_u64(0);
    let mut uniform = || F::from_f64(f64::from(generator.random::<f32>()));
    (0..VERTICES)
        .map(|_| {
            let [wo, wi] = [(); 2].map(|()| cosine_hemisphere::<F>([uniform(), uniform()]));
            (wo, wi, [uniform(), uniform(), uniform()])
        })
        .collect()
}

fn vertices<F: Real>(bencher: Bencher<'_, '_>, lobe: &impl Bxdf<F>) {
    let pool = pool::<F>();
    bencher.counter(ItemsCount::new(VERTICES)).bench_local(|| path(lobe, black_box(&pool)));
}

fn rough<F: Real>(shape: Shape) -> Distribution<F> {
    Distribution::new(shape, F::from_f64(0.3), F::from_f64(0.3)).expect("a valid roughness")
}

#[divan::bench(types = [f32, f64])]
fn lambertian<F: Real>(bencher: Bencher<'_, '_>) {
    vertices(bencher, &Lambertian::<F>::new(Rgb::WHITE).expect("a valid reflectance"));
}

#[divan::bench(types = [f32, f64])]
fn ggx_reflection<F: Real>(bencher: Bencher<'_, '_>) {
    let white = Fresnel::constant(Rgb::WHITE).expect("a valid reflectance");
    vertices(bencher, &MicrofacetReflection::<F>::new(rough(Shape::Ggx), white));
}

#[divan::bench(types = [f32, f64])]
fn beckmann_reflection<F: Real>(bencher: Bencher<'_, '_>) {
    let white = Fresnel::constant(Rgb::WHITE).expect("a valid reflectance");
    vertices(bencher, &MicrofacetReflection::<F>::new(rough(Shape::Beckmann), white));
}

#[divan::bench(types = [f32, f64])]
fn ggx_dielectric<F: Real>(bencher: Bencher<'_, '_>) {
    let glass = MicrofacetDielectric::new(rough(Shape::Ggx), F::from_f64(1.5)).expect("a valid index");
    vertices::<F>(bencher, &glass);
}

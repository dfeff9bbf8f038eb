//! A sphere in a uniform environment, rendered in single precision: no pixel is brighter or darker than the same walk
//! in double precision makes it, on other random numbers.
//!
//! The lobes are at the extremes, where a bad form shows as a speck or a rim: highlights of α = 1e-3, media of
//! η = 1.0001. The longer form takes more pixels: `BXDF_TESTS_PIXELS=512 cargo test --test furnace -- --nocapture`.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test that cannot be set up has failed")]

use bxdf_tests::run_seed;
use bxdf_tests::stability::STABLE_ULPS;
use gonio::bxdf::{Bxdf, TransportMode};
use gonio::fresnel::Fresnel;
use gonio::lobe::{Lobe, MicrofacetDielectric, MicrofacetReflection};
use gonio::microfacet::{Distribution, Shape};
use gonio::real::{Real, Vector};
use gonio::rgb::Rgb;
use rand::RngExt;
use rand_pcg::Pcg64;
use rayon::prelude::*;

/// Pixels along an edge of the image.
const PIXELS: usize = 64;
/// Paths per pixel in single precision; the reference takes [`MORE`] times as many.
const PATHS: usize = 64;
const MORE: usize = 4;
/// A path that is still inside after so many scatterings is given up, in both precisions.
const MOST_SCATTERINGS: usize = 64;
/// Standard deviations of the difference: at 5 one of 1.7 million pixels is suspect by chance, and a suspect is looked at
/// again, with 64 times as many fresh paths.
const MOST_DEVIATIONS: f64 = 5.0;
const SECOND_LOOK: usize = 64;
/// What rounding may make of the weight of a path with two scatterings, each as stable as every term has to be. All paths of
/// a pixel may be off by the same.
const ROUNDING: f64 = 2.0 * STABLE_ULPS * f32::EPSILON as f64;

/// The mean of the radiance of paths, with its variance.
#[derive(Clone, Copy, Default)]
struct Mean {
    paths: f64,
    sum: f64,
    squares: f64,
}

impl Mean {
    fn of(paths: usize, mut radiance: impl FnMut() -> f64) -> Self {
        (0..paths).map(|_| radiance()).fold(Self::default(), |mean, x| Self {
            paths: mean.paths + 1.0,
            sum: mean.sum + x,
            squares: mean.squares + x * x,
        })
    }

    fn value(self) -> f64 {
        self.sum / self.paths
    }

    /// The difference in standard deviations, beyond rounding. Both have the same distribution but for that: its
    /// variance is that of all paths.
    fn deviations(self, reference: Self) -> f64 {
        let paths = self.paths + reference.paths;
        let mean = (self.sum + reference.sum) / paths;
        let variance = ((self.squares + reference.squares) / paths - mean * mean).max(0.0);
        let deviation = (variance * (1.0 / self.paths + 1.0 / reference.paths)).sqrt();
        let difference = (self.value() - reference.value()).abs();
        if difference <= ROUNDING { 0.0 } else { (difference - ROUNDING) / deviation.max(f64::MIN_POSITIVE) }
    }
}

/// A sphere of radius 1 about the origin, seen along −z.
struct Sphere<F: Real> {
    lobe: Lobe<F>,
    /// Whether light passes through it.
    is_clear: bool,
}

impl<F: Real> Sphere<F> {
    /// Radiance along one path that meets the sphere at `p` and was looked at from +z.
    fn radiance(&self, mut p: F::Vec3, generator: &mut Pcg64) -> f64 {
        let mut toward = F::Vec3::new(F::ZERO, F::ZERO, F::ONE);
        let mut throughput = F::ONE;
        for _ in 0..MOST_SCATTERINGS {
            let frame = tangents::<F>(p);
            let wo = F::Vec3::new(toward.dot(frame[0]), toward.dot(frame[1]), toward.dot(p));
            let [uc, u0, u1] = [(); 3].map(|()| uniform::<F>(generator));
            let Some(sample) = self.lobe.sample(wo, uc, [u0, u1], TransportMode::Radiance) else {
                return 0.0;
            };
            throughput *= sample.weight[0];
            let wi = sample.wi;
            if wi.z() > F::ZERO {
                // Out into the environment.
                return throughput.to_f64();
            }
            assert!(self.is_clear, "light goes into a mirror");
            let direction = frame[0] * wi.x() + frame[1] * wi.y() + p * wi.z();
            // Along the chord; p·direction is wi.z, but for rounding.
            p = (p - direction * (F::TWO * wi.z())).normalize();
            toward = -direction;
        }
        0.0
    }

    fn pixel(&self, at: [f64; 2], paths: usize, generator: &mut Pcg64) -> Mean {
        let [x, y] = at.map(F::from_f64);
        let p = F::Vec3::new(x, y, (F::ONE - x * x - y * y).sqrt());
        Mean::of(paths, || self.radiance(p, generator))
    }
}

fn uniform<F: Real>(generator: &mut Pcg64) -> F {
    // As each precision has them: a double rounded to single may come to 1.
    if F::NAME == "f32" {
        F::from_f64(f64::from(generator.random::<f32>()))
    } else {
        F::from_f64(generator.random::<f64>())
    }
}

/// Two unit vectors orthogonal to the unit vector `n` and to each other (Duff et al., JCGT 6(1), 2017).
fn tangents<F: Real>(n: F::Vec3) -> [F::Vec3; 2] {
    let (x, y, z) = (n.x(), n.y(), n.z());
    let sign = F::ONE.copysign(z);
    let a = -F::ONE / (sign + z);
    let b = x * y * a;
    [F::Vec3::new(F::ONE + sign * x * x * a, sign * b, -sign * x), F::Vec3::new(b, sign + y * y * a, -y)]
}

/// A lobe by what it is made of, in any precision.
#[derive(Clone, Copy)]
enum Material {
    Mirror(Shape, f64),
    Glass(Shape, f64, f64),
}

impl Material {
    fn sphere<F: Real>(self) -> Sphere<F> {
        // The double of what single precision holds: next to a switch to smooth the last digit decides.
        let parameter = |x: f64| F::from_f64(f64::from(x as f32));
        let rough = |shape, alpha| {
            let alpha = parameter(alpha);
            Distribution::new(shape, alpha, alpha).unwrap()
        };
        match self {
            Self::Mirror(shape, alpha) => {
                let white = Fresnel::constant(Rgb::WHITE).unwrap();
                let lobe = MicrofacetReflection::new(rough(shape, alpha), white);
                Sphere { lobe: lobe.into(), is_clear: false }
            }
            Self::Glass(shape, alpha, eta) => {
                let lobe = MicrofacetDielectric::new(rough(shape, alpha), parameter(eta)).unwrap();
                Sphere { lobe: lobe.into(), is_clear: true }
            }
        }
    }
}

/// Renders the sphere and compares every pixel; the pixels that two looks find wrong.
fn render(name: &str, material: Material) -> Vec<String> {
    let pixels = std::env::var("BXDF_TESTS_PIXELS").map_or(PIXELS, |text| text.parse().expect("a number"));
    let (single, double) = (material.sphere::<f32>(), material.sphere::<f64>());
    let seed = u128::from(run_seed());
    let centres: Vec<[f64; 2]> = (0..pixels * pixels)
        .map(|i| [i % pixels, i / pixels].map(|k| (2.0 * k as f64 + 1.0) / pixels as f64 - 1.0))
        // Rounded: both precisions see the same point. The rim is as close as the last number below 1.
        .map(|[x, y]| [f64::from(x as f32), f64::from(y as f32)])
        .filter(|[x, y]| x * x + y * y < 1.0 - 1e-6)
        .collect();
    let rendered: Vec<(Mean, Option<String>)> = centres
        .par_iter()
        .enumerate()
        .map(|(i, &at)| {
            let mut generator = Pcg64::new(seed, i as u128);
            let mut look = |paths: usize| {
                let image = single.pixel(at, paths, &mut generator);
                let reference = double.pixel(at, MORE * paths, &mut generator);
                (image, reference.value(), image.deviations(reference))
            };
            let (image, _, deviations) = look(PATHS);
            // NaN is suspect too.
            let is_fine = |deviations: f64| deviations <= MOST_DEVIATIONS;
            if is_fine(deviations) {
                return (image, None);
            }
            let (again, reference, deviations) = look(SECOND_LOOK * PATHS);
            let wrong = (!is_fine(deviations)).then(|| {
                let value = again.value();
                format!("{name}, {at:?}: {value} for {reference}, {deviations:.1} standard deviations off")
            });
            (image, wrong)
        })
        .collect();
    let values = || rendered.iter().map(|(image, _)| image.value());
    let mean = values().sum::<f64>() / rendered.len() as f64;
    let (least, most) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
    println!("{name}: {} pixels, {least:.7} to {most:.7}, mean {mean:.7}", rendered.len());
    rendered.into_iter().filter_map(|(_, wrong)| wrong).collect()
}

#[test]
fn no_pixel_of_a_sphere_in_a_furnace_stands_out_in_single_precision() {
    println!("BXDF_TESTS_SEED={}", run_seed());
    let (ggx, beckmann) = (Shape::Ggx, Shape::Beckmann);
    let images = [
        ("GGX mirror, α = 1e-3", Material::Mirror(ggx, 1e-3)),
        ("Beckmann mirror, α = 1e-3", Material::Mirror(beckmann, 1e-3)),
        ("GGX mirror, α = 1e-4", Material::Mirror(ggx, 1e-4)),
        ("smooth glass, η = 1.0001", Material::Glass(ggx, 0.0, 1.0001)),
        ("GGX glass, α = 1e-3, η = 1.0001", Material::Glass(ggx, 1e-3, 1.0001)),
        ("GGX glass, α = 1, η = 1.0001", Material::Glass(ggx, 1.0, 1.0001)),
        ("Beckmann glass, α = 1, η = 1.0001", Material::Glass(beckmann, 1.0, 1.0001)),
        ("smooth glass, η = 1.5", Material::Glass(ggx, 0.0, 1.5)),
        ("GGX glass, α = 1e-3, η = 1.5", Material::Glass(ggx, 1e-3, 1.5)),
        ("Beckmann glass, α = 1e-3, η = 1.5", Material::Glass(beckmann, 1e-3, 1.5)),
    ];
    let wrong: Vec<String> = images.into_iter().flat_map(|(name, material)| render(name, material)).collect();
    assert!(wrong.is_empty(), "{} pixels\n{}", wrong.len(), wrong[..wrong.len().min(10)].join("\n"));
}

//! The path tracer against scenes whose answer is known: every pixel by its z-score, the family of all of them at one
//! level.
//!
//! `GONIO_TESTS_PATHS=1000000 cargo test --test closed_forms -- --nocapture` takes more paths per pixel.
#![expect(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::float_cmp,
    reason = "a test that cannot be set up has failed"
)]

use std::sync::OnceLock;
use std::sync::atomic::AtomicBool;

use bxdf_tests::run_seed;
use glam::Vec3;
use gonio::bxdf::{Bxdf, TransportMode};
use gonio::material::{Material, Model, Value, preset};
use gonio::render::{
    Camera, Film, Light, Mesh, Object, Quad, Ray, Scene, Settings, Shape, Sphere, Strategy, Surroundings,
    Triangles, render, trace,
};
use gonio::rgb::Rgb;
use rand::RngExt as _;
use rand::distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;

/// Probability that all tests of this file together fail on a correct renderer.
const FAMILY: f64 = 1e-6;
/// More z-scores than the file looks at.
const CHECKS: f64 = 1e4;

/// The seed of the run, which `BXDF_TESTS_SEED` repeats.
fn seed() -> u64 {
    static SEED: OnceLock<u64> = OnceLock::new();
    *SEED.get_or_init(|| {
        let seed = run_seed();
        println!("BXDF_TESTS_SEED={seed}");
        seed
    })
}

/// Random numbers of one sample.
fn uniforms<T>(sample: u64) -> T
where
    StandardUniform: Distribution<T>,
{
    Pcg64Mcg::new(u128::from(seed()) << 64 | u128::from(2 * sample + 1)).random()
}

fn paths() -> u64 {
    std::env::var("GONIO_TESTS_PATHS").map_or(20_000, |text| text.parse().expect("a whole number"))
}

fn glass(values: &[(&'static str, Value)]) -> Material<f32> {
    Material::new(Model::Glass, values.iter().cloned()).unwrap()
}

fn matte(reflectance: f64) -> Material<f32> {
    Material::new(Model::Matte, [("reflectance", reflectance.into()), ("sigma_rad", Value::Number(0.0))])
        .unwrap()
}

fn unit_sphere() -> Box<dyn Shape> {
    Box::new(Sphere::new(Vec3::ZERO, 1.0).unwrap())
}

fn object(shape: Box<dyn Shape>) -> Object {
    Object { shape, material: Some(0), emission: Rgb::BLACK }
}

fn white() -> Surroundings {
    Surroundings { radiance: Rgb::WHITE, background: None }
}

/// A ray that meets the unit sphere at the given angle of incidence.
fn at_incidence(degrees: f32) -> Ray {
    let sine = degrees.to_radians().sin();
    Ray { origin: Vec3::new(sine, -3.0, 0.0), direction: Vec3::Y }
}

/// Mean, and standard deviation of the mean, of a channel.
#[derive(Clone, Copy, Debug, Default)]
struct Estimate {
    mean: f64,
    deviation: f64,
}

impl Estimate {
    fn of(sample: impl Fn(u64) -> [f64; 3] + Sync) -> [Self; 3] {
        let count = paths();
        let add = |[a, b]: [[f64; 3]; 2], [c, d]: [[f64; 3]; 2]| {
            let sum = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + b[i]);
            [sum(a, c), sum(b, d)]
        };
        let [sums, squares] = (0..count)
            .into_par_iter()
            .map(|i| {
                let values = sample(i);
                [values, values.map(|x| x * x)]
            })
            .reduce(|| [[0.0; 3]; 2], add);
        let n = count as f64;
        [0, 1, 2].map(|i| {
            let mean = sums[i] / n;
            let variance = ((squares[i] / n - mean * mean) / (n - 1.0)).max(0.0);
            Self { mean, deviation: variance.sqrt() }
        })
    }

    fn along(scene: &Scene, settings: &Settings, ray: Ray) -> [Self; 3] {
        Self::of(|i| trace(scene, settings, ray, 0, i).to_f64())
    }

    /// Fails unless the difference to a value of the given standard deviation is one that chance makes. Single precision
    /// rounds each path by some 1e-6.
    fn must_be(self, expected: Self, what: &str) {
        let deviation = self.deviation.hypot(expected.deviation);
        // The normal deviation that is exceeded with the level of the family.
        let most = statrs_quantile(FAMILY / CHECKS);
        let difference = self.mean - expected.mean;
        println!("{what}: {:.6} ± {:.1e}, expected {:.6}", self.mean, deviation, expected.mean);
        assert!(
            difference.abs() <= most * deviation + 5e-6 * expected.mean.abs().max(1e-3),
            "{what}: {} instead of {}, {:.1} standard deviations",
            self.mean,
            expected.mean,
            difference / deviation
        );
    }
}

/// Two-sided normal quantile for small levels, from above: e^(−z²/2) bounds the tail.
fn statrs_quantile(level: f64) -> f64 {
    (-2.0 * (level / 2.0).ln()).sqrt()
}

fn exactly(mean: f64) -> Estimate {
    Estimate { mean, deviation: 0.0 }
}

fn settings() -> Settings {
    Settings { seed: seed(), ..Settings::default() }
}

/// S1: of a convex body under uniform light each point shows its directional albedo.
#[test]
fn a_convex_body_in_uniform_light_shows_its_albedo() {
    for name in ["polished_copper", "red_plastic", "ceramic", "satin"] {
        let Ok(description) = preset(name) else { panic!("{name}") };
        let single = description.material::<f32>().unwrap();
        let double = description.material::<f64>().unwrap();
        let scene = Scene::new(vec![object(unit_sphere())], vec![single], vec![], white()).unwrap();
        for degrees in [0.0_f32, 45.0, 80.0] {
            let shown = Estimate::along(&scene, &settings(), at_incidence(degrees));
            let wo = glam::DVec3::new(
                f64::from(degrees).to_radians().sin(),
                0.0,
                f64::from(degrees).to_radians().cos(),
            );
            let albedo = Estimate::of(|i| {
                let uniforms: [f64; 3] = uniforms(i);
                let sample =
                    double.sample(wo, uniforms[0], [uniforms[1], uniforms[2]], TransportMode::Radiance);
                sample.map_or([0.0; 3], |sample| sample.weight.to_f64())
            });
            for channel in 0..3 {
                shown[channel].must_be(albedo[channel], &format!("{name} at {degrees}°, channel {channel}"));
            }
        }
    }
}

/// Six quads that look inside a cube of side 2.
fn room() -> Vec<Box<dyn Shape>> {
    let axes = [Vec3::X, Vec3::Y, Vec3::Z];
    let mut walls: Vec<Box<dyn Shape>> = Vec::new();
    for k in 0..3 {
        let (n, a, b) = (axes[k], axes[(k + 1) % 3], axes[(k + 2) % 3]);
        // n = a × b points away from the low wall and out of the high one.
        walls.push(Box::new(Quad::new(-n - a - b, [2.0 * a, 2.0 * b]).unwrap()));
        walls.push(Box::new(Quad::new(n - a - b, [2.0 * b, 2.0 * a]).unwrap()));
    }
    walls
}

/// S2: in a closed body whose walls emit Le and reflect ρ diffusely, radiance is Le / (1 − ρ) everywhere.
#[test]
fn a_closed_room_of_glowing_walls_is_filled_with_their_series() {
    for reflectance in [0.0, 0.5, 0.9] {
        for strategy in [Strategy::Both, Strategy::Lights, Strategy::Materials] {
            let walls =
                room().into_iter().map(|shape| Object { emission: Rgb::splat(0.25), ..object(shape) });
            let scene =
                Scene::new(walls.collect(), vec![matte(reflectance)], vec![], Surroundings::default())
                    .unwrap();
            let settings = Settings { strategy, most_bounces: 4096, ..settings() };
            let ray = Ray { origin: Vec3::new(0.1, 0.2, -0.3), direction: Vec3::new(0.36, 0.48, 0.8) };
            let expected = exactly(0.25 / (1.0 - reflectance));
            Estimate::along(&scene, &settings, ray)[1]
                .must_be(expected, &format!("ρ = {reflectance}, {strategy:?}"));
        }
    }
}

/// S3: lossless glass in uniform light cannot be seen; η² goes in and comes out again.
#[test]
fn lossless_glass_vanishes_in_uniform_light() {
    let rough = |alpha: f64| glass(&[("alpha", alpha.into()), ("scattering", Value::from("all"))]);
    let bodies: [(&str, Material<f32>, f64); 4] = [
        ("smooth", glass(&[]), 0.0),
        ("diamond", glass(&[("eta", 2.42.into())]), 0.0),
        ("bubble", glass(&[("eta", (1.0 / 1.5).into())]), 0.0),
        // Tables of higher orders conserve energy to 3e-3 per bounce.
        ("rough", rough(0.3), 2e-2),
    ];
    for (name, material, tolerance) in bodies {
        for (shape_name, shape) in [("sphere", unit_sphere()), ("mesh", octahedron())] {
            let scene = Scene::new(vec![object(shape)], vec![material.clone()], vec![], white()).unwrap();
            let settings = Settings { most_bounces: 4096, ..settings() };
            for degrees in [0.0, 30.0, 60.0, 80.0] {
                let ray = Ray { origin: Vec3::new(0.01, -3.0, 0.02), ..at_incidence(degrees) };
                let origin = ray.origin + Vec3::X * at_incidence(degrees).origin.x * 0.5;
                let shown = Estimate::along(&scene, &settings, Ray { origin, ..ray })[0];
                let allowed = Estimate { mean: 1.0, deviation: tolerance / 4.0 };
                shown.must_be(allowed, &format!("{name} {shape_name} at {degrees}°"));
            }
        }
    }
}

fn octahedron() -> Box<dyn Shape> {
    let positions = vec![
        [1.0, 0.0, 0.0],
        [-1.0, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [0.0, -1.0, 0.0],
        [0.0, 0.0, 1.0],
        [0.0, 0.0, -1.0],
    ];
    let corners =
        vec![[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]];
    Box::new(Mesh::new(Triangles { positions, normals: vec![], corners }).unwrap())
}

/// S4: R + (1 − R)² a / (1 − R a), a = e^(−2 σ cos θt), of a sphere of radius 1 in uniform light.
#[test]
fn an_absorbing_sphere_shows_the_geometric_series_of_its_bounces() {
    for (sigma, expected) in [(0.5, [0.38410, 0.47089, 0.60337]), (2.0, [0.05689, 0.12095, 0.40641])] {
        let material = glass(&[("absorbance_inside", sigma.into())]);
        let scene = Scene::new(vec![object(unit_sphere())], vec![material], vec![], white()).unwrap();
        for (degrees, expected) in [0.0, 60.0, 80.0].into_iter().zip(expected) {
            let shown = Estimate::along(&scene, &settings(), at_incidence(degrees))[0];
            // Printed to five digits.
            shown
                .must_be(Estimate { mean: expected, deviation: 1e-6 }, &format!("σ = {sigma} at {degrees}°"));
        }
    }
}

/// S5: what a sheet of glass does not absorb it shows of one side or of the other.
#[test]
fn a_thin_sheet_shows_both_its_sides() {
    let sheet = Material::new(Model::ThinGlass, [("eta", Value::Number(1.5))]).unwrap();
    let double = Material::<f64>::new(Model::ThinGlass, [("eta", Value::Number(1.5))]).unwrap();
    let quad = Quad::new(Vec3::new(-1.0, 0.0, -1.0), [Vec3::X * 2.0, Vec3::Z * 2.0]).unwrap();
    let lamp = Quad::new(Vec3::new(-50.0, 9.0, -50.0), [Vec3::X * 100.0, Vec3::Z * 100.0]).unwrap();
    let objects =
        vec![object(Box::new(quad)), Object { shape: Box::new(lamp), material: None, emission: Rgb::WHITE }];
    let scene = Scene::new(objects, vec![sheet], vec![], Surroundings::default()).unwrap();
    for degrees in [0.0_f32, 60.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let direction = Vec3::new(sin, cos, 0.0);
        let shown = Estimate::along(&scene, &settings(), Ray { origin: -direction * 2.0, direction })[0];
        let wo = glam::DVec3::new(
            f64::from(degrees).to_radians().sin(),
            0.0,
            f64::from(degrees).to_radians().cos(),
        );
        // r = 2 R / (1 + R) of the face is reflected; the lamp is behind, the front is dark.
        let reflected = double.sample(wo, 0.0, [0.0; 2], TransportMode::Radiance).unwrap().pdf;
        let gonio::bxdf::Pdf::Discrete(reflected) = reflected else { panic!("a sheet is a delta") };
        shown.must_be(exactly(1.0 - reflected), &format!("at {degrees}°"));
    }
}

fn lit_scene(material: Material<f32>, light: Object) -> Scene {
    let floor = Quad::new(Vec3::new(-4.0, -4.0, -1.0), [Vec3::X * 8.0, Vec3::Y * 8.0]).unwrap();
    let floor = Object { material: Some(1), ..object(Box::new(floor)) };
    Scene::new(
        vec![object(unit_sphere()), floor, light],
        vec![material, matte(0.5)],
        vec![],
        Surroundings::default(),
    )
    .unwrap()
}

fn metal(alpha: f64, distribution: &'static str) -> Material<f32> {
    let values = [
        ("ior", Value::from("gold/Johnson-1972")),
        ("alpha", alpha.into()),
        ("distribution", distribution.into()),
    ];
    Material::new(Model::Metal, values).unwrap()
}

/// S6: light found by sampling lights, by sampling the material and by both weighted is the same light.
#[test]
fn strategies_agree() {
    let lamps: [(&str, fn() -> Box<dyn Shape>); 3] = [
        ("sphere", || Box::new(Sphere::new(Vec3::new(1.5, -1.5, 2.5), 0.6).unwrap())),
        ("quad", || Box::new(Quad::new(Vec3::new(0.5, -2.5, 2.0), [Vec3::Y * 2.0, Vec3::X * 2.0]).unwrap())),
        ("mesh", || {
            let positions = vec![[0.5, -2.5, 2.0], [0.5, -0.5, 2.2], [2.5, -0.5, 2.0], [2.5, -2.5, 1.9]];
            let triangles = Triangles { positions, normals: vec![], corners: vec![[0, 1, 2], [0, 2, 3]] };
            Box::new(Mesh::new(triangles).unwrap().emitting())
        }),
    ];
    for (lamp_name, lamp) in lamps {
        for (name, material) in [
            ("gold", metal(0.3, "ggx")),
            ("paper", matte(0.8)),
            ("glass", glass(&[("alpha", 0.3.into())])),
            ("plastic", Material::new(Model::Plastic, [("coat.alpha", Value::Number(0.2))]).unwrap()),
        ] {
            let light = || Object { shape: lamp(), material: None, emission: Rgb([9.0, 6.0, 3.0]) };
            let scene = lit_scene(material, light());
            for (i, target) in
                [Vec3::new(0.4, -0.6, 0.5), Vec3::new(-0.3, -0.8, -0.3), Vec3::new(2.0, -1.0, -1.0)]
                    .into_iter()
                    .enumerate()
            {
                let origin = Vec3::new(0.5, -6.0, 1.0);
                let ray = Ray { origin, direction: (target - origin).normalize() };
                let of = |strategy| {
                    let settings =
                        Settings { strategy, most_bounces: 4, seed: seed() ^ strategy as u64, ..settings() };
                    Estimate::along(&scene, &settings, ray)[0]
                };
                let both = of(Strategy::Both);
                assert!(both.mean > 0.01, "nothing to see: {both:?}");
                for strategy in [Strategy::Lights, Strategy::Materials] {
                    of(strategy).must_be(both, &format!("{name}, {lamp_name}, ray {i}, {strategy:?}"));
                }
            }
        }
    }
}

/// A spherical light without geometry and an emitting sphere light a diffuse surface alike; a mirror shows one of them.
#[test]
fn a_light_without_geometry_lights_and_is_not_seen() {
    let sphere = Sphere::new(Vec3::new(0.0, 0.0, 3.0), 0.5).unwrap();
    let floor =
        || object(Box::new(Quad::new(Vec3::new(-4.0, -4.0, 0.0), [Vec3::X * 8.0, Vec3::Y * 8.0]).unwrap()));
    let lamp = Object { shape: Box::new(sphere), material: None, emission: Rgb::splat(5.0) };
    let ray = Ray { origin: Vec3::new(0.0, -2.0, 1.0), direction: Vec3::new(0.0, 0.8, -0.6) };
    // E = π L (r/d)² cos θ for a spherical source that is wholly above the horizon.
    let at = ray.origin + ray.direction * (1.0 / 0.6);
    let way = Vec3::new(0.0, 0.0, 3.0) - at;
    let cos = f64::from(way.z / way.length());
    let expected = exactly(0.8 * 5.0 * 0.25 / f64::from(way.length_squared()) * cos);
    let seen = Scene::new(vec![floor(), lamp], vec![matte(0.8)], vec![], Surroundings::default()).unwrap();
    for strategy in [Strategy::Materials, Strategy::Lights, Strategy::Both] {
        let settings = Settings { strategy, ..settings() };
        Estimate::along(&seen, &settings, ray)[0]
            .must_be(expected, &format!("emitting sphere, {strategy:?}"));
    }
    let light = Light::sphere(sphere, Rgb::splat(5.0)).unwrap();
    let unseen = Scene::new(vec![floor()], vec![matte(0.8)], vec![light], Surroundings::default()).unwrap();
    Estimate::along(&unseen, &settings(), ray)[0].must_be(expected, "light without geometry");
    let up = Ray { origin: Vec3::new(0.0, 0.0, 1.0), direction: Vec3::Z };
    assert_eq!(trace(&seen, &settings(), up, 0, 0)[0], 5.0);
    assert_eq!(trace(&unseen, &settings(), up, 0, 0)[0], 0.0);
    let point = Light::point(Vec3::new(0.0, 0.0, 3.0), Rgb::splat(2.0)).unwrap();
    let pointed = Scene::new(vec![floor()], vec![matte(0.8)], vec![point], Surroundings::default()).unwrap();
    let expected = 0.8 / std::f64::consts::PI * 2.0 * cos / f64::from(way.length_squared());
    Estimate::along(&pointed, &settings(), ray)[0].must_be(exactly(expected), "point light");
}

/// S7: inside of glass in uniform light, radiance is η² in every direction.
#[test]
fn radiance_inside_of_glass_is_squeezed() {
    let positions: Vec<[f32; 3]> = (0..8)
        .map(|i| {
            [
                if i & 1 == 0 { -1.0 } else { 1.0 },
                if i & 2 == 0 { -1.0 } else { 1.0 },
                if i & 4 == 0 { -0.2 } else { 0.2 },
            ]
        })
        .collect();
    let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let corners = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let slab = Mesh::new(Triangles { positions, normals: vec![], corners }).unwrap();
    let scene =
        Scene::new(vec![object(Box::new(slab))], vec![glass(&[("alpha", 0.2.into())])], vec![], white())
            .unwrap()
            .seen_from_inside(0);
    // Single scattering loses; a smooth slab does not, but some of its paths stay inside for ever.
    let ray = Ray { origin: Vec3::new(0.1, 0.1, 0.0), direction: Vec3::new(0.1, 0.2, 1.0).normalize() };
    let rough = Estimate::along(&scene, &Settings { most_bounces: 4096, ..settings() }, ray)[0];
    assert!(rough.mean < 2.25 && rough.mean > 1.9, "{rough:?}");
    let smooth = Scene::new(vec![object(unit_sphere())], vec![glass(&[])], vec![], white())
        .unwrap()
        .seen_from_inside(0);
    let ray = Ray { origin: Vec3::new(0.1, 0.1, 0.0), ..ray };
    let shown = Estimate::along(&smooth, &Settings { most_bounces: 4096, ..settings() }, ray)[0];
    shown.must_be(exactly(2.25), "inside of a smooth sphere");
}

/// S8: light from a lamp to a sensor, and importance from the sensor's place to the lamp's, are one number.
#[test]
fn radiance_and_importance_agree() {
    // Corner and edges: below the sphere, above it, and inside of it, where radiance is squeezed and importance is not.
    type Area = (Vec3, [Vec3; 2]);
    let below: Area = (Vec3::new(-0.5, -0.5, -2.0), [Vec3::X, Vec3::Y]);
    let above: Area = (Vec3::new(-0.3, -0.6, 2.5), [Vec3::Y, Vec3::X]);
    let inside: Area = (Vec3::new(-0.3, -0.2, 0.1), [Vec3::Y * 0.6, Vec3::X * 0.6]);
    for material in
        [glass(&[]), glass(&[("alpha", 0.3.into())]), glass(&[("eta", 0.8.into()), ("alpha", 0.1.into())])]
    {
        let measured = |(corner, edges): Area, to: Area, transport: TransportMode, starts_inside: bool| {
            let quad = |(corner, edges): Area| Quad::new(corner, edges).unwrap();
            let target = Object { shape: Box::new(quad(to)), material: None, emission: Rgb::WHITE };
            let objects = vec![object(unit_sphere()), target];
            let scene = Scene::new(objects, vec![material.clone()], vec![], Surroundings::default()).unwrap();
            let scene = if starts_inside { scene.seen_from_inside(0) } else { scene };
            let settings = Settings { transport, seed: seed() ^ transport as u64, ..settings() };
            let normal = edges[0].cross(edges[1]).normalize();
            let estimate = Estimate::of(|i| {
                // Cosine-distributed directions from points of the area: power over π and the area.
                let u: [f32; 4] = uniforms(i);
                let local = gonio::warp::cosine_hemisphere::<f32>([u[2], u[3]]);
                let direction = gonio::warp::about::<f32>(normal, local);
                let origin = corner + edges[0] * u[0] + edges[1] * u[1];
                trace(&scene, &settings, Ray { origin, direction }, 1, i).to_f64()
            })[0];
            let area = f64::from(quad((corner, edges)).area());
            Estimate { mean: area * estimate.mean, deviation: area * estimate.deviation }
        };
        for (name, other, is_inside) in [("above", above, false), ("inside", inside, true)] {
            let radiance = measured(below, other, TransportMode::Radiance, false);
            let importance = measured(other, below, TransportMode::Importance, is_inside);
            assert!(radiance.mean > 1e-3, "{name}: {radiance:?}");
            importance.must_be(radiance, &format!("{name}, {:?}", material.description().given()));
        }
    }
}

/// Single precision keeps rays off the surface that they leave, at any size and at any place.
#[test]
fn glass_of_any_size_vanishes() {
    for scale in [1e-3_f32, 1.0, 1e3] {
        for offset in [0.0, 100.0 * scale] {
            let center = Vec3::splat(offset);
            let sphere = Sphere::new(center, scale).unwrap();
            let scene =
                Scene::new(vec![object(Box::new(sphere))], vec![glass(&[])], vec![], white()).unwrap();
            let eye = center + Vec3::new(0.0, -4.0, 0.5) * scale;
            let camera = Camera::new(eye, center, Vec3::Z, 0.6, [48, 48]).unwrap();
            let mut film = Film::new(camera.size());
            let settings = Settings { most_bounces: 4096, ..settings() };
            let outcome = render(&scene, &camera, &settings, &mut film, 16, &AtomicBool::new(false));
            assert!(outcome.is_complete);
            let variance = film.variance();
            for (i, pixel) in film.radiance().into_iter().enumerate() {
                let deviation = variance[i][0].sqrt();
                let off = (pixel[0] - 1.0).abs();
                assert!(
                    off <= 12.0 * deviation + 1e-4,
                    "scale {scale}, offset {offset}, pixel {i}: {pixel:?}"
                );
            }
            // A ray that starts on the wrong side of its surface is lost.
            assert!(outcome.lost_paths * 10_000 <= 48 * 48 * 16, "{outcome:?} at {scale}, {offset}");
        }
    }
}

/// Passes, threads and interruptions change no bit.
#[test]
fn passes_and_threads_change_no_bit() {
    let light = Object {
        shape: Box::new(Sphere::new(Vec3::new(1.5, -1.5, 2.5), 0.6).unwrap()),
        material: None,
        emission: Rgb::splat(9.0),
    };
    let scene = lit_scene(metal(0.3, "ggx"), light);
    let camera = Camera::new(Vec3::new(0.0, -5.0, 1.0), Vec3::ZERO, Vec3::Z, 0.6, [40, 30]).unwrap();
    let settings = settings();
    let run = |passes: &[u32], threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let mut film = Film::new(camera.size());
            for &samples in passes {
                render(&scene, &camera, &settings, &mut film, samples, &AtomicBool::new(false));
            }
            film
        })
    };
    let once = run(&[8], 1);
    assert_eq!(once, run(&[1, 2, 5], 3));
    assert_eq!(once.samples(), 8);
    let bytes = run(&[3], 2).checkpoint(7);
    let mut resumed = Film::resumed(&bytes, 7, camera.size()).unwrap();
    let stopped = render(&scene, &camera, &settings, &mut resumed, 5, &AtomicBool::new(true));
    assert!(!stopped.is_complete);
    assert_eq!(resumed.samples(), 3);
    render(&scene, &camera, &settings, &mut resumed, 5, &AtomicBool::new(false));
    assert_eq!(once, resumed);
    assert!(Film::resumed(&bytes, 8, camera.size()).unwrap_err().to_string().contains("another scene"));
    assert!(Film::resumed(&bytes, 7, [40, 31]).unwrap_err().to_string().contains("another size"));
    assert!(Film::resumed(&bytes[..999], 7, camera.size()).unwrap_err().to_string().contains("length"));
    assert!(Film::resumed(&bytes[..20], 7, camera.size()).unwrap_err().to_string().contains("head"));
    assert!(Film::resumed(b"PNG", 7, camera.size()).is_err());
}

//! Path tracing: what arrives along one ray of the camera.

use glam::Vec3;
use rand::RngExt as _;
use rand_pcg::Pcg64Mcg;

use super::mesh::scramble;
use super::scene::{Medium, Scene};
use super::shape::{Ray, Surface};
use crate::bxdf::{Bxdf as _, Pdf, TransportMode};
use crate::rgb::Rgb;

/// How light that comes straight from a source is found.
///
/// All have the same mean; the others are there to prove it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strategy {
    /// By sampling lights and by sampling the material, each weighted by the power heuristic (Veach 1997, §9.2.4).
    Both,
    /// By sampling lights, but for what only the material can find: deltas and the surroundings.
    Lights,
    /// By sampling the material, but for what only lights can find: those without geometry.
    Materials,
}

/// How paths are traced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// The most bounces of a path; 0 sees emission only.
    pub most_bounces: u32,
    /// From this bounce on a path ends by chance, in proportion to what it can still carry.
    pub roulette_from: u32,
    /// How direct light is found.
    pub strategy: Strategy,
    /// What is carried: radiance from the camera on, or importance from a light on.
    pub transport: TransportMode,
    /// Fixes every random number.
    pub seed: u64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            most_bounces: 64,
            roulette_from: 5,
            strategy: Strategy::Both,
            transport: TransportMode::Radiance,
            seed: 0,
        }
    }
}

/// What one path found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    /// Emission that is seen, and light after one bounce.
    pub(super) direct: Rgb<f32>,
    /// Light after more bounces.
    pub(super) indirect: Rgb<f32>,
    /// Where the ray of the camera ended.
    pub(super) first: Option<(usize, Surface)>,
    /// The path left the scene inside of something.
    pub(super) is_lost: bool,
}

/// The random numbers of one sample of one pixel: no other work changes them.
pub(super) fn generator(seed: u64, pixel: u64, sample: u64) -> Pcg64Mcg {
    let low = scramble(seed ^ scramble(pixel ^ scramble(sample)));
    Pcg64Mcg::new(u128::from(scramble(low)) << 64 | u128::from(low))
}

/// Unit vectors of a surface: two tangents and the normal.
pub(super) struct Frame([Vec3; 3]);

impl Frame {
    /// The frame of the smooth surface, or of the shape itself where the smooth one turns its back to `wo`.
    #[inline]
    pub(super) fn new(surface: &Surface, wo: Vec3) -> Self {
        let (n, geometric) = (surface.shading_normal, surface.geometric_normal);
        let agree = (n.dot(wo) > 0.0) == (geometric.dot(wo) > 0.0);
        let n = if agree { n } else { geometric };
        let tangent = if agree {
            surface.tangent
        } else {
            (surface.tangent - n * n.dot(surface.tangent))
                .try_normalize()
                .unwrap_or_else(|| super::shape::some_tangent(n))
        };
        Self([tangent, n.cross(tangent), n])
    }

    #[inline]
    pub(super) fn to_local(&self, w: Vec3) -> Vec3 {
        let [t, b, n] = self.0;
        Vec3::new(w.dot(t), w.dot(b), w.dot(n))
    }

    #[inline]
    fn to_world(&self, w: Vec3) -> Vec3 {
        let [t, b, n] = self.0;
        t * w.x + b * w.y + n * w.z
    }
}

/// The weight of a sample of density `a` where the other strategy would have drawn it with density `b`.
#[inline]
fn power_heuristic(a: f32, b: f32) -> f32 {
    // By the ratio, because squares leave the range.
    if b <= 0.0 {
        1.0
    } else if a > b {
        1.0 / (1.0 + (b / a) * (b / a))
    } else {
        (a / b) * (a / b) / (1.0 + (a / b) * (a / b))
    }
}

/// Light along a path that is built from the camera on (thesis §3; Kajiya, SIGGRAPH 1986).
pub(super) fn trace(scene: &Scene, settings: &Settings, ray: Ray, generator: &mut Pcg64Mcg) -> Found {
    let mode = settings.transport;
    let mut found = Found { direct: Rgb::BLACK, indirect: Rgb::BLACK, first: None, is_lost: false };
    let mut ray = ray;
    let mut throughput = Rgb::WHITE;
    // η² along the way: radiance inside of glass is larger, but its paths do not matter more.
    let mut squeezed = 1.0_f32;
    let mut medium = scene.medium();
    // Where the ray begins and with which density it was drawn; nothing after deltas and at the camera.
    let mut drawn: Option<(Vec3, f32)> = None;
    for bounce in 0.. {
        let add = |found: &mut Found, light: Rgb<f32>, bounces: u32| {
            let sum = if bounces <= 1 { &mut found.direct } else { &mut found.indirect };
            *sum = *sum + light;
        };
        let Some((index, hit)) = scene.intersect(&ray) else {
            let surroundings = scene.surroundings();
            let seen = surroundings.background.filter(|_| bounce == 0).unwrap_or(surroundings.radiance);
            add(&mut found, throughput * seen, bounce);
            found.is_lost = medium.is_some_and(|medium| medium.is_inside);
            break;
        };
        let object = &scene.objects()[index];
        let surface = object.shape.surface(&ray, hit);
        if bounce == 0 {
            found.first = Some((index, surface));
        }
        throughput = throughput * scene.transmittance(medium, hit.distance);
        let wo = -ray.direction;
        let is_outside = wo.dot(surface.geometric_normal) > 0.0;
        if is_outside && object.emission != Rgb::BLACK {
            let weight = match (drawn, settings.strategy) {
                (None, _) | (_, Strategy::Materials) => 1.0,
                (Some(_), Strategy::Lights) => 0.0,
                (Some((from, pdf)), Strategy::Both) => {
                    power_heuristic(pdf, scene.light_pdf(index, from, &surface))
                }
            };
            add(&mut found, throughput * object.emission * weight, bounce);
        }
        let Some(of_object) = object.material.filter(|_| bounce < settings.most_bounces) else { break };
        let material = scene.material(of_object);
        let frame = Frame::new(&surface, wo);
        let local = frame.to_local(wo);
        // What a ray that leaves to this side is in.
        let beyond = |is_inside: bool| {
            let crosses = is_inside == is_outside && material.has_inside();
            if crosses { Some(Medium { material: of_object, is_inside }) } else { medium }
        };
        if scene.has_lights() && !material.flags().is_delta {
            let [uc, u0, u1] = generator.random::<[f32; 3]>();
            if let Some(arrival) = scene.sample_light(surface.position, uc, [u0, u1]) {
                let wi = frame.to_local(arrival.direction);
                let is_inside = arrival.direction.dot(surface.geometric_normal) < 0.0;
                let f = if is_inside == (wi.z < 0.0) { material.eval(local, wi, mode) } else { Rgb::BLACK };
                let weight = match (arrival.pdf, settings.strategy) {
                    (None, _) | (_, Strategy::Lights) => 1.0,
                    (Some(_), Strategy::Materials) => 0.0,
                    (Some(pdf), Strategy::Both) => power_heuristic(pdf, material.pdf(local, wi, mode)),
                };
                if f != Rgb::BLACK && weight > 0.0 && scene.arrives(&surface, &arrival) {
                    let kept = scene.transmittance(beyond(is_inside), arrival.distance);
                    let light = arrival.weight * f * (wi.z.abs() * weight) * kept;
                    add(&mut found, throughput * light, bounce + 1);
                }
            }
        }
        let [uc, u0, u1] = generator.random::<[f32; 3]>();
        let Some(sample) = material.sample(local, uc, [u0, u1], mode) else { break };
        let wi = frame.to_world(sample.wi);
        let is_inside = wi.dot(surface.geometric_normal) < 0.0;
        // The shape and the smooth surface that it stands for disagree: no light.
        if is_inside != (sample.wi.z < 0.0) {
            break;
        }
        throughput = throughput * sample.weight;
        if mode == TransportMode::Radiance {
            squeezed *= sample.eta * sample.eta;
        }
        drawn = match sample.pdf {
            Pdf::SolidAngle(pdf) => Some((surface.position, pdf)),
            Pdf::Discrete(_) => None,
        };
        medium = beyond(is_inside);
        ray = surface.leave(wi);
        if bounce >= settings.roulette_from {
            // A path that has lost nothing goes on.
            let survives = throughput.0.into_iter().fold(0.0, f32::max) * squeezed;
            if survives < 1.0 {
                if generator.random::<f32>() >= survives {
                    break;
                }
                throughput = throughput / survives;
            }
        } else if throughput == Rgb::BLACK {
            break;
        }
    }
    found
}

//! The minimal integrator: a path tracer that shows materials, and whose answers are checked against closed forms.
//!
//! World space is z up, right-handed; lengths have the unit of the scene, which absorption is per. Colours are
//! linear with Rec. 709 primaries. Single precision throughout: positions carry a bound of their rounding, so that
//! no ray meets the surface that it leaves.
//!
//! A surface has one outside, where its normal points; glass fills its inside (thesis §4.2.4). Only the front of an
//! opaque material is seen; its back is black.

mod camera;
mod film;
pub mod generated;
pub mod image;
mod light;
mod mesh;
pub mod mesh_file;
mod path;
mod scene;
pub mod scene_file;
mod shape;

use std::sync::atomic::{AtomicBool, Ordering};

use rand::RngExt as _;
use rayon::prelude::*;

use crate::bxdf::Bxdf as _;
use crate::rgb::Rgb;

pub use camera::Camera;
pub use film::{CheckpointError, Film};
pub use light::Light;
pub use mesh::{Mesh, MeshError, Triangles};
pub use path::{Settings, Strategy};
pub use scene::{Object, Scene, SceneError, Surroundings};
pub use shape::{Bounds, Emission, Hit, Quad, Ray, Shape, Sphere, Surface};

use film::LAYER_SAMPLES;

/// What became of a call of [`render`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// All samples were added; if not, none was.
    pub is_complete: bool,
    /// Paths that left the scene inside of something: a surface with a hole, or a camera in glass that the scene does
    /// not know of.
    pub lost_paths: u64,
}

/// Adds `samples` per pixel to a film of the camera's size, unless `stop` is set meanwhile: then the film stays as it
/// was.
///
/// The same samples give the same bits, in one call or in many, on any number of threads.
///
/// A film of another size is left as it is.
pub fn render(
    scene: &Scene,
    camera: &Camera,
    settings: &Settings,
    film: &mut Film,
    samples: u32,
    stop: &AtomicBool,
) -> Outcome {
    let before = film.samples;
    let [width, _] = film.size;
    if film.size != camera.size() {
        return Outcome { is_complete: false, lost_paths: 0 };
    }
    let mut pixels = film.pixels.clone();
    let rows = pixels.par_chunks_mut(width).enumerate().map(|(row, pixels)| {
        let mut lost = 0;
        for (column, pixel) in pixels.iter_mut().enumerate() {
            let index = (row * width + column) as u64;
            for sample in before..before + samples {
                if stop.load(Ordering::Relaxed) {
                    return lost;
                }
                let mut generator = path::generator(settings.seed, index, u64::from(sample));
                let [dx, dy] = generator.random::<[f32; 2]>();
                let ray = camera.ray(column as f32 + dx, row as f32 + dy);
                let found = path::trace(scene, settings, ray, &mut generator);
                pixel.add(&found);
                lost += u64::from(found.is_lost);
                if sample < LAYER_SAMPLES {
                    add_layers(scene, ray, &found, pixel);
                }
            }
        }
        lost
    });
    let lost_paths = rows.sum();
    let is_complete = !stop.load(Ordering::Relaxed);
    if is_complete {
        film.pixels = pixels;
        film.samples += samples;
    }
    Outcome { is_complete, lost_paths }
}

/// What one path finds along a ray: radiance, or importance if that is carried. `pixel` and `sample` pick its random
/// numbers.
pub fn trace(scene: &Scene, settings: &Settings, ray: Ray, pixel: u64, sample: u64) -> Rgb<f32> {
    let found = path::trace(scene, settings, ray, &mut path::generator(settings.seed, pixel, sample));
    found.direct + found.indirect
}

/// Albedo and normal of what a ray of the camera meets.
fn add_layers(scene: &Scene, ray: Ray, found: &path::Found, pixel: &mut film::Pixel) {
    let Some((index, surface)) = found.first else { return };
    let frame = path::Frame::new(&surface, -ray.direction);
    let albedo = scene.objects()[index]
        .material
        .map(|material| scene.material(material).albedo(frame.to_local(-ray.direction)));
    for channel in 0..3 {
        pixel.albedo[channel] += albedo.map_or(0.0, |albedo| albedo[channel]);
        pixel.normal[channel] += surface.shading_normal[channel];
    }
}

//! How noisy the thesis's scenes are at equal samples: `cargo bench --bench noise`.
//!
//! Figure 6: the Cornell box lit by an emitting sphere against the same sphere without geometry. Figures 7 and 8: rough
//! glass of GGX against Beckmann. No time is measured; the numbers depend on the seed alone.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use gonio::material::file::Syntax;
use gonio::render::scene_file::{BUILTIN, read};
use gonio::render::{Film, Settings, Strategy, render};

/// Samples per pixel, and pixels of a side.
const SAMPLES: u32 = 64;
const SIDE: usize = 128;

fn main() {
    println!("{SAMPLES} samples per pixel, {SIDE} × {SIDE} pixels; standard error of a pixel over its mean");
    println!("{:20} {:10} {:>8} {:>8} {:>8}  fireflies", "scene", "strategy", "median", "90 %", "mean");
    for (name, strategy) in [
        ("cornell_a", Strategy::Materials),
        ("cornell_a", Strategy::Lights),
        ("cornell_a", Strategy::Both),
        ("cornell_b", Strategy::Both),
        ("bunny_smooth", Strategy::Both),
        ("bunny_rough_05", Strategy::Both),
        ("bunny_rough_20", Strategy::Both),
        ("bunny_rough_40", Strategy::Both),
        ("bunny_beckmann_40", Strategy::Both),
    ] {
        let Some(scene) = BUILTIN.iter().find(|scene| scene.name == name) else { continue };
        let Some(rendering) = read(scene.text, Syntax::Toml, Path::new("")).0 else { continue };
        let Ok(camera) = rendering.camera.with_size([SIDE, SIDE]) else { continue };
        let mut film = Film::new(camera.size());
        let settings = Settings { strategy, seed: 1, ..rendering.settings };
        render(&rendering.scene, &camera, &settings, &mut film, SAMPLES, &AtomicBool::new(false));
        let (radiance, variance) = (film.radiance(), film.variance());
        let mut errors: Vec<f64> = (0..radiance.len())
            .map(|i| {
                let [mean, variance] = [&radiance, &variance].map(|all| all[i].iter().sum::<f64>() / 3.0);
                (mean, variance)
            })
            .filter(|&(mean, _)| mean > 0.0)
            .map(|(mean, variance)| variance.sqrt() / mean)
            .collect();
        errors.sort_by(f64::total_cmp);
        let at = |share: f64| 100.0 * errors[((errors.len() - 1) as f64 * share) as usize];
        // Pixels whose value is one sample: its error is as large as itself.
        let fireflies = errors.iter().filter(|&&error| error > 0.5).count();
        let mean = 100.0 * errors.iter().sum::<f64>() / errors.len() as f64;
        println!(
            "{name:20} {:10} {:6.1} % {:6.1} % {mean:6.1} %  {:.2} % of pixels",
            format!("{strategy:?}"),
            at(0.5),
            at(0.9),
            100.0 * fireflies as f64 / errors.len() as f64
        );
    }
}

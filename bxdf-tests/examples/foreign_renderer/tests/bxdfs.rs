//! Every material at every point of its grid, one test per suite: `cargo test alpha=0.05`, `cargo test /chi_square`.

mod laboratory;

use bxdf_tests::{Claims, Grid};
use foreign_renderer::{Ggx, RoughDielectric};
use laboratory::{Material, claims, rough_conductor};

fn rough_dielectric(alpha: f32, eta: f32) -> Material<RoughDielectric> {
    let ggx = Ggx { alpha };
    let claims = Claims { transmits: true, ..claims([eta; 3], [0.0; 3]) };
    let fresnel = |bxdf: &RoughDielectric, cosine, from_above| [bxdf.fresnel(cosine, from_above); 3];
    Material { bxdf: RoughDielectric { ggx, eta }, claims, ggx, fresnel }
}

fn main() -> std::process::ExitCode {
    let mut grid = Grid::default();
    for alpha in [0.05, 0.2, 0.6] {
        grid.add(format!("gold/alpha={alpha}"), Box::new(rough_conductor(alpha)));
        for eta in [1.33, 1.5] {
            let name = format!("glass/eta={eta}/alpha={alpha}");
            grid.add(name, Box::new(rough_dielectric(alpha, eta)));
        }
    }
    grid.run()
}

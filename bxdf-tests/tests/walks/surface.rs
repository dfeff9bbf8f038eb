//! Rough surfaces with independent heights and normals (Smith's model), without a line of
//! `gonio::microfacet`.

use crate::vector::{Vector, add_scaled, cross, dot, normalize, scale};
use core::f64::consts::{PI, TAU};
use libm::erfc;
use rand::RngExt;
use rand_pcg::Pcg64;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    Ggx,
    Beckmann,
}

/// A distribution of facets; `alpha` along x and y in slope units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Surface {
    pub(crate) shape: Shape,
    pub(crate) alpha: [f64; 2],
}

impl Surface {
    pub(crate) fn isotropic(shape: Shape, alpha: f64) -> Self {
        Self { shape, alpha: [alpha; 2] }
    }

    /// Density of facet normals D(m) \[sr⁻¹\]; Walter et al. 2007, equations 25 and 33, over slopes.
    pub(crate) fn d(&self, m: Vector) -> f64 {
        let slope2 = (m[0] / (self.alpha[0] * m[2])).powi(2) + (m[1] / (self.alpha[1] * m[2])).powi(2);
        let area = PI * self.alpha[0] * self.alpha[1] * m[2].powi(4);
        match self.shape {
            Shape::Ggx => 1.0 / (area * (1.0 + slope2).powi(2)),
            Shape::Beckmann => (-slope2).exp() / area,
        }
    }

    /// Smith's Λ(w) for directions on either side: Λ(−w) = −1 − Λ(w). Heitz et al. 2016, §4.
    pub(crate) fn lambda(&self, w: Vector) -> f64 {
        let a = w[2].abs() / (self.alpha[0] * w[0]).hypot(self.alpha[1] * w[1]);
        let upward = match self.shape {
            Shape::Ggx => {
                // ½(√(1 + 1/a²) − 1) without the difference.
                let t = 1.0 / (a * a);
                0.5 * t / (1.0 + (1.0 + t).sqrt())
            }
            Shape::Beckmann => 0.5 * ((-a * a).exp() / (a * PI.sqrt()) - erfc(a)),
        };
        if w[2] > 0.0 { upward } else { -1.0 - upward }
    }

    /// A facet normal with density D(m) ⟨w, m⟩ / σ(w): what `w` sees. `w` may lie below the horizon, as for a
    /// ray on its way up.
    pub(crate) fn visible_normal(&self, w: Vector, rng: &mut Pcg64) -> Vector {
        let stretched = normalize([self.alpha[0] * w[0], self.alpha[1] * w[1], w[2]]);
        let m = match self.shape {
            Shape::Ggx => visible_normal_of_sphere(stretched, rng),
            Shape::Beckmann => visible_gaussian_normal(stretched, rng),
        };
        normalize([self.alpha[0] * m[0], self.alpha[1] * m[1], m[2]])
    }
}

/// GGX with α = 1 is the upper half of a sphere: a point on its projection along `w`.
/// Heitz 2018, "Sampling the GGX Distribution of Visible Normals", JCGT 7(4); it holds below the horizon too.
fn visible_normal_of_sphere(w: Vector, rng: &mut Pcg64) -> Vector {
    let horizontal = w[0].hypot(w[1]);
    let t1 = if horizontal > 0.0 { [-w[1] / horizontal, w[0] / horizontal, 0.0] } else { [1.0, 0.0, 0.0] };
    let t2 = cross(w, t1);
    let radius = rng.random::<f64>().sqrt();
    let (sin_phi, cos_phi) = (TAU * rng.random::<f64>()).sin_cos();
    let p1 = radius * cos_phi;
    let chord = (1.0 - p1 * p1).sqrt();
    // 1 + z without cancellation near the nadir.
    let one_plus_z = if w[2] < 0.0 { horizontal * horizontal / (1.0 - w[2]) } else { 1.0 + w[2] };
    let p2 = chord - 0.5 * one_plus_z * (chord - radius * sin_phi);
    let height = (1.0 - p1 * p1 - p2 * p2).max(0.0).sqrt();
    let m = add_scaled(add_scaled(scale(p1, t1), p2, t2), height, w);
    [m[0], m[1], m[2].max(0.0)]
}

/// Beckmann with α = 1: Gaussian slopes, the one towards `w` seen in proportion to cot θ − s.
fn visible_gaussian_normal(w: Vector, rng: &mut Pcg64) -> Vector {
    let horizontal = w[0].hypot(w[1]);
    let (cos_phi, sin_phi) =
        if horizontal > 0.0 { (w[0] / horizontal, w[1] / horizontal) } else { (1.0, 0.0) };
    let along = visible_slope(w[2] / horizontal, rng);
    let across = gaussian(rng);
    [-(cos_phi * along - sin_phi * across), -(sin_phi * along + cos_phi * across), 1.0]
}

/// A number with density e^(−s²) / √π, by Box and Muller.
fn gaussian(rng: &mut Pcg64) -> f64 {
    rayleigh(rng) * (TAU * rng.random::<f64>()).cos()
}

/// A number with density 2 r e^(−r²).
fn rayleigh(rng: &mut Pcg64) -> f64 {
    (-open_uniform(rng).ln()).sqrt()
}

fn open_uniform(rng: &mut Pcg64) -> f64 {
    1.0 - rng.random::<f64>()
}

/// A slope with density proportional to (c − s) e^(−s²) below c, by rejection: no distribution function is
/// inverted, unlike in the samplers this is to judge.
fn visible_slope(c: f64, rng: &mut Pcg64) -> f64 {
    loop {
        if c == f64::INFINITY {
            return gaussian(rng);
        }
        let (s, acceptance) = if c >= 0.0 {
            // From (c + |s|) e^(−s²), a Gaussian and a two-sided Rayleigh.
            let gaussian_mass = c * PI.sqrt();
            let s = if rng.random::<f64>() * (1.0 + gaussian_mass) < gaussian_mass {
                gaussian(rng)
            } else if rng.random::<bool>() {
                rayleigh(rng)
            } else {
                -rayleigh(rng)
            };
            (s, (c - s) / (c + s.abs()))
        } else {
            // With r = c − s: r e^(−r²) e^(−2|c|r), one of the exponentials for the acceptance.
            let slope = -2.0 * c;
            if slope < 1.6 {
                let r = rayleigh(rng);
                (c - r, (-slope * r).exp())
            } else {
                let r = -(open_uniform(rng) * open_uniform(rng)).ln() / slope;
                (c - r, (-r * r).exp())
            }
        };
        if rng.random::<f64>() < acceptance {
            return s;
        }
    }
}

/// σ(w) = (1 + Λ(w)) cos θ and the means of m.x² and m.z over visible normals, by quadrature over D.
pub(crate) fn visible_moments(surface: &Surface, w: Vector) -> [f64; 3] {
    const CELLS: usize = 512;
    let mut moments = [0.0; 3];
    for i in 0..CELLS {
        let (sin_theta, cos_theta) = (0.5 * PI * (i as f64 + 0.5) / CELLS as f64).sin_cos();
        for j in 0..CELLS {
            let (sin_phi, cos_phi) = (TAU * (j as f64 + 0.5) / CELLS as f64).sin_cos();
            let m = [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta];
            let seen = surface.d(m) * dot(w, m).max(0.0) * sin_theta;
            for (moment, value) in moments.iter_mut().zip([1.0, m[0] * m[0], m[2]]) {
                *moment += seen * value;
            }
        }
    }
    let area = PI * PI / (CELLS * CELLS) as f64;
    [moments[0] * area, moments[1] / moments[0], moments[2] / moments[0]]
}

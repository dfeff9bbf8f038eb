use crate::Float3;
use std::f32::consts::{PI, TAU};

/// Micro normals after Trowbridge & Reitz ("GGX") under Smith's separable masking: Walter et al., EGSR 2007,
/// <https://doi.org/10.2312/EGWR/EGSR07/195-206>. All directions here are above the surface.
#[derive(Clone, Copy, Debug)]
pub struct Ggx {
    /// Roughness, a slope.
    pub alpha: f32,
}

impl Ggx {
    /// D \[sr⁻¹\] in the direction of `m`, of any length.
    pub fn d(&self, m: Float3) -> f32 {
        if m.z <= 0.0 {
            return 0.0;
        }
        let (x, y) = (m.x / self.alpha, m.y / self.alpha);
        let ratio = m.dot(m) / (x * x + y * y + m.z * m.z);
        ratio * ratio / (PI * self.alpha * self.alpha)
    }

    /// Area of the facets that `w` sees per area of the surface, (1 + Λ) cos θ. Unlike Λ it is finite at 90°.
    pub fn seen_area(&self, w: Float3) -> f32 {
        0.5 * (w.z + self.stretched(w).dot(self.stretched(w)).sqrt())
    }

    /// Smith's Λ.
    pub fn lambda(&self, w: Float3) -> f32 {
        let t = self.alpha * self.alpha * (w.x * w.x + w.y * w.y) / (w.z * w.z);
        0.5 * t / (1.0 + (1.0 + t).sqrt())
    }

    /// Masking G₁.
    pub fn g1(&self, w: Float3) -> f32 {
        w.z / self.seen_area(w)
    }

    /// Density \[sr⁻¹\] of the normals that [`Self::sample_visible`] draws.
    pub fn visible_density(&self, w: Float3, m: Float3) -> f32 {
        self.d(m) * w.dot(m).max(0.0) / self.seen_area(w)
    }

    /// Draws a unit normal among those that `w` sees: Dupuy & Benyoub, *Computer Graphics Forum* 42(8), 2023,
    /// <https://doi.org/10.1111/cgf.14867>.
    pub fn sample_visible(&self, w: Float3, [u, v]: [f32; 2]) -> Float3 {
        let w = self.stretched(w).normalized();
        let height = (1.0 - u) * (1.0 + w.z);
        let below = u * (1.0 + w.z);
        let radius = (below * (2.0 - below)).sqrt();
        let (sin, cos) = (TAU * v).sin_cos();
        self.stretched(Float3::new(radius * cos + w.x, radius * sin + w.y, height)).normalized()
    }

    fn stretched(&self, w: Float3) -> Float3 {
        Float3::new(self.alpha * w.x, self.alpha * w.y, w.z)
    }
}

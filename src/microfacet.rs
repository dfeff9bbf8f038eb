//! Microfacet distributions, written with the projected area σ instead of G₁ and Λ.
//!
//! σ(w) is the area of the facets that a direction sees, per unit of macro surface: σ(w) = (1 + Λ(w)) cos θ.
//! It is finite at grazing angles and below the horizon, so nothing is divided by a cosine and no tangent is
//! taken: G₁ = cos θ / σ, the density of visible normals is D max(0, w·m) / σ(w), and the reflected density
//! D / (4σ).
//!
//! | term | meaning |
//! |---|---|
//! | `alpha_x`, `alpha_y` | roughness in slope units along each tangent (Walter's α, the thesis's r) |
//! | `d` | density of micro normals \[sr⁻¹\]: ∫ D cos θ dω = 1 |
//! | `projected_area` | σ above |
//! | `lambda`, `g1`, `g2` | Smith's auxiliary function, masking, masking–shadowing |

mod beckmann;
mod ggx;

use crate::frame::{sin2_theta, stretch};
use crate::parameter::{OutOfRange, require};
use crate::real::{Real, Vector};

/// The shape of a distribution of micro normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Trowbridge–Reitz, "GGX": an ellipsoid's normals. Long tails.
    Ggx,
    /// Beckmann–Spizzichino: Gaussian slopes.
    Beckmann,
}

/// A distribution of micro normals with Smith masking–shadowing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distribution<F> {
    shape: Shape,
    alpha_x: F,
    alpha_y: F,
}

/// The smallest roughness at which a microfacet lobe is evaluated.
///
/// Rounding the *input* directions alone costs D a relative error of about 1.2 · 2⁻²⁴ / α in `f32`, so
/// at 1e-4 seven digits have become three. The albedo of the smooth limit differs by α² = 1e-8.
pub const ALPHA_MIN: f64 = 1e-4;

impl<F: Real> Distribution<F> {
    /// A distribution with roughness `alpha_x`, `alpha_y` ∈ \[[`ALPHA_MIN`], 1\] in slope units.
    pub fn new(shape: Shape, alpha_x: F, alpha_y: F) -> Result<Self, OutOfRange> {
        let low = F::from_f64(ALPHA_MIN);
        let valid = |alpha: F| alpha >= low && alpha <= F::ONE;
        let expected = "roughness in slope units in [0.0001, 1] (0 is a specular lobe)";
        Ok(Self {
            shape,
            alpha_x: require("alpha_x", alpha_x, valid, expected)?,
            alpha_y: require("alpha_y", alpha_y, valid, expected)?,
        })
    }

    /// Density of micro normals at the unit vector `m` \[sr⁻¹\]; 0 where `m` is not above the surface.
    ///
    /// Written over the components of `m`: the form over n·m alone is wrong by 7 % in `f32` at α = 1e-3.
    #[inline]
    pub fn d(&self, m: F::Vec3) -> F {
        if m.z() <= F::ZERO {
            return F::ZERO;
        }
        let (x, y) = (m.x() / self.alpha_x, m.y() / self.alpha_y);
        let stretched = x * x + y * y;
        let area = F::PI * self.alpha_x * self.alpha_y;
        match self.shape {
            Shape::Ggx => ggx::density(stretched, m.z()) / area,
            Shape::Beckmann => beckmann::density(stretched, m.z()) / area,
        }
    }

    /// σ(w): area of the micro surface that the unit vector `w` sees, per unit of macro surface.
    ///
    /// Positive for directions below the horizon as well, where it is what a ray inside the micro surface sees.
    #[inline]
    pub fn projected_area(&self, w: F::Vec3) -> F {
        let (x, y) = (self.alpha_x * w.x(), self.alpha_y * w.y());
        let s_squared = x * x + y * y;
        match self.shape {
            Shape::Ggx => ggx::projected_area(w.z(), s_squared),
            Shape::Beckmann => beckmann::projected_area(w.z(), s_squared),
        }
    }

    /// Smith masking G₁(w) = cos θ / σ(w): the visible fraction of the facets that face `w`.
    #[inline]
    pub fn g1(&self, w: F::Vec3) -> F {
        if w.z() <= F::ZERO { F::ZERO } else { w.z() / self.projected_area(w) }
    }

    /// Height-correlated Smith masking–shadowing over 4 cos θo cos θi, for reflection:
    /// 1 / (4 (σ_o cos θi + σ_i cos θo − cos θo cos θi)).
    ///
    /// Heitz, *JCGT* 3(2), 2014, equation 99, <https://jcgt.org/published/0003/02/03/>.
    #[inline]
    pub fn visibility(&self, wo: F::Vec3, wi: F::Vec3) -> F {
        F::ONE / (F::FOUR * self.visibility_denominator(self.projected_area(wo), wo, wi))
    }

    /// σ_o cos θi + σ_i cos θo − cos θo cos θi; each term is positive, as σ ≥ cos θ.
    #[inline]
    fn visibility_denominator(&self, sigma_o: F, wo: F::Vec3, wi: F::Vec3) -> F {
        self.projected_area(wi) * wo.z() + (sigma_o - wo.z()) * wi.z()
    }

    /// Height-correlated Smith masking–shadowing for reflection; both directions above the surface.
    #[inline]
    pub fn g2(&self, wo: F::Vec3, wi: F::Vec3) -> F {
        wo.z() * wi.z() / self.visibility_denominator(self.projected_area(wo), wo, wi)
    }

    /// Density \[sr⁻¹\] of [`Self::sample_visible`]: D(m) max(0, w·m) / σ(w).
    #[inline]
    pub fn visible_pdf(&self, w: F::Vec3, m: F::Vec3) -> F {
        self.d(m) * w.dot(m).max(F::ZERO) / self.projected_area(w)
    }

    /// Draws a micro normal in proportion to the area that the unit vector `w` sees of it.
    ///
    /// Heitz & d'Eon, *Computer Graphics Forum* 33(4), 2014, <https://doi.org/10.1111/cgf.12417>.
    #[inline]
    pub fn sample_visible(&self, w: F::Vec3, u: [F; 2]) -> F::Vec3 {
        // A distribution stretched by α is the unit-roughness one, seen from the stretched direction.
        let stretched = stretch::<F>(w, self.alpha_x, self.alpha_y).normalize();
        let m = match self.shape {
            Shape::Ggx => ggx::sample_visible_unit::<F>(stretched, u),
            Shape::Beckmann => beckmann::sample_visible_unit::<F>(stretched, u),
        };
        stretch::<F>(m, self.alpha_x, self.alpha_y).normalize()
    }

    /// Reflection from `wo` into `wi`, both above the surface: D(h) G₂ / (4 cos θo cos θi) and wo·h.
    #[inline]
    pub fn reflection(&self, wo: F::Vec3, wi: F::Vec3) -> (F, F) {
        let h = (wo + wi).normalize();
        // Opposite directions at grazing incidence: rounding can bring the facet to face away.
        (self.d(h) * self.visibility(wo, wi), wo.dot(h).max(F::ZERO))
    }

    /// Density \[sr⁻¹\] of reflecting `wo` about a visible normal into `wi`: D(h) / (4 σ(wo)).
    #[inline]
    pub fn reflection_pdf(&self, wo: F::Vec3, wi: F::Vec3) -> F {
        let h = (wo + wi).normalize();
        self.d(h) / (F::FOUR * self.projected_area(wo))
    }

    /// For `wi`, the reflection of `wo` about the visible normal `m`: [`Self::reflection_pdf`], and
    /// G₂(wo, wi) / G₁(wo), the weight before the Fresnel term.
    #[inline]
    pub fn reflection_sample(&self, wo: F::Vec3, wi: F::Vec3, m: F::Vec3) -> (F, F) {
        let sigma_o = self.projected_area(wo);
        let pdf = self.d(m) / (F::FOUR * sigma_o);
        (pdf, wi.z() * sigma_o / self.visibility_denominator(sigma_o, wo, wi))
    }

    /// `true` if the distribution does not change under rotation about the normal.
    pub fn is_isotropic(&self) -> bool {
        self.alpha_x == self.alpha_y
    }

    /// Smith's Λ(w) = σ(w) / cos θ − 1, for `w` above the surface.
    #[inline]
    pub fn lambda(&self, w: F::Vec3) -> F {
        let s_squared = sin2_theta::<F>(stretch::<F>(w, self.alpha_x, self.alpha_y));
        match self.shape {
            Shape::Ggx => ggx::lambda(w.z(), s_squared),
            Shape::Beckmann => beckmann::lambda(w.z(), s_squared),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roughness_out_of_range_is_refused_with_its_value() {
        for alpha in [0.0, -0.1, 1e-5, 1.5, f64::NAN, f64::INFINITY] {
            let error = Distribution::new(Shape::Ggx, 0.5, alpha).unwrap_err().to_string();
            assert!(error.starts_with(&format!("alpha_y = {alpha} is out of range")), "{error}");
            assert!(Distribution::new(Shape::Beckmann, alpha as f32, 0.5).is_err());
        }
        assert!(Distribution::new(Shape::Ggx, 1e-4_f32, 1.0).is_ok());
    }
}

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
//!
//! Masking–shadowing is Smith's (facets scattered at random over a height field), or that of V-shaped cavities
//! (Torrance–Sparrow, Cook–Torrance, Blinn): a choice of the distribution, not another lobe.

pub(crate) mod beckmann;
pub(crate) mod gaussian;
pub(crate) mod ggx;
mod shadowing;

pub use shadowing::{NoSmithForm, Shadowing};

use crate::frame::{is_above, reflect, renormalize, sin2_theta, stretch};
use crate::parameter::{OutOfRange, require};
use crate::quadrature::{kronecker, unit_square};
use crate::real::{Real, Vector};
use crate::special::beta;

/// The shape of a distribution of micro normals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// Trowbridge–Reitz, "GGX": an ellipsoid's normals. Long tails.
    Ggx,
    /// Beckmann–Spizzichino: Gaussian slopes.
    Beckmann,
    /// Gaussian angles (Cook–Torrance 1982): D ∝ e^{−(θ/α)²}. Its masking is that of V-cavities.
    Gaussian,
}

/// A distribution of micro normals with its masking–shadowing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distribution<F> {
    shape: Shape,
    shadowing: Shadowing,
    alpha_x: F,
    alpha_y: F,
    /// 1 / αx and 1 / αy.
    inverse_alpha: [F; 2],
    is_smooth: bool,
    /// A rough surface of GGX with height-correlated masking, what scenes use most.
    is_rough_ggx: bool,
    /// D(n): 1 / (π αx αy), but for the Gaussian.
    peak: F,
}

/// The smallest roughness at which a microfacet lobe is evaluated.
///
/// Rounding the *input* directions alone costs D a relative error of about 1.2 · 2⁻²⁴ / α in `f32`, so
/// at 1e-4 seven digits have become three. The albedo of the smooth limit differs by α² = 1e-8.
pub const ALPHA_MIN: f64 = 1e-4;

/// Scattering about one facet, as a lobe needs it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FacetScattering<F> {
    /// f without the Fresnel term \[sr⁻¹\]; for transmission in the measure of importance.
    pub value: F,
    /// Density \[sr⁻¹\] of scattering `wo` about a sampled normal into `wi`.
    pub pdf: F,
    /// value · |cos θi| / pdf.
    pub weight: F,
    /// Squared cosine between `wo` and the facet.
    cos2_theta_o: F,
}

impl<F: Real> FacetScattering<F> {
    /// Cosine between `wo` and the facet, ≥ 0.
    #[inline]
    pub fn cos_theta_o(&self) -> F {
        self.cos2_theta_o.sqrt()
    }
}

impl<F: Real> Distribution<F> {
    /// A distribution with roughness `alpha_x`, `alpha_y` ∈ \[0, 1\] in slope units (radians for the Gaussian) and
    /// height-correlated Smith masking (V-cavities for the Gaussian).
    ///
    /// Where both are below [`ALPHA_MIN`] the surface is smooth and its lobes are Dirac deltas; where one is, the
    /// other makes a line of the highlight, and the smaller one counts as [`ALPHA_MIN`].
    pub fn new(shape: Shape, alpha_x: F, alpha_y: F) -> Result<Self, OutOfRange> {
        let low = F::from_f64(ALPHA_MIN);
        let valid = |alpha: F| alpha >= F::ZERO && alpha <= F::ONE;
        let expected = "roughness in slope units in [0, 1]";
        let alpha_x = require("alpha_x", alpha_x, valid, expected)?;
        let alpha_y = require("alpha_y", alpha_y, valid, expected)?;
        let is_smooth = alpha_x < low && alpha_y < low;
        let (alpha_x, alpha_y) = (alpha_x.max(low), alpha_y.max(low));
        let (shadowing, peak) = match shape {
            Shape::Ggx | Shape::Beckmann => {
                // Rounded once.
                let facets = core::f64::consts::PI * alpha_x.to_f64() * alpha_y.to_f64();
                (Shadowing::SmithCorrelated, F::from_f64(1.0 / facets))
            }
            Shape::Gaussian => {
                (Shadowing::VCavity, F::from_f64(gaussian::normalization(alpha_x.to_f64(), alpha_y.to_f64())))
            }
        };
        let inverse_alpha = [F::ONE / alpha_x, F::ONE / alpha_y];
        let is_rough_ggx = shape == Shape::Ggx && !is_smooth;
        Ok(Self { shape, shadowing, alpha_x, alpha_y, inverse_alpha, is_smooth, is_rough_ggx, peak })
    }

    /// The same normals with another masking–shadowing.
    ///
    /// # Errors
    /// The Gaussian's projected area has no closed form: it takes V-cavities only.
    pub fn with_shadowing(self, shadowing: Shadowing) -> Result<Self, NoSmithForm> {
        if self.shape == Shape::Gaussian && shadowing != Shadowing::VCavity {
            return Err(NoSmithForm);
        }
        let is_correlated = shadowing == Shadowing::SmithCorrelated;
        let is_rough_ggx = self.shape == Shape::Ggx && is_correlated && !self.is_smooth;
        Ok(Self { shadowing, is_rough_ggx, ..self })
    }

    /// The same distribution in double precision, for integrals: what a nearly smooth surface loses is less than the
    /// rounding of single precision.
    pub(crate) fn to_f64(self) -> Distribution<f64> {
        let Self { shape, shadowing, alpha_x, alpha_y, inverse_alpha, is_smooth, is_rough_ggx, peak } = self;
        Distribution {
            shape,
            shadowing,
            alpha_x: alpha_x.to_f64(),
            alpha_y: alpha_y.to_f64(),
            inverse_alpha: inverse_alpha.map(F::to_f64),
            is_smooth,
            is_rough_ggx,
            peak: peak.to_f64(),
        }
    }

    /// The shape.
    pub fn shape(&self) -> Shape {
        self.shape
    }

    /// `true` if the roughness is too small to be resolved: lobes are then Dirac deltas.
    pub fn is_smooth(&self) -> bool {
        self.is_smooth
    }

    /// `true` if the distribution does not change under rotation about the normal.
    pub fn is_isotropic(&self) -> bool {
        self.alpha_x == self.alpha_y
    }

    /// The larger roughness.
    pub fn largest_alpha(&self) -> F {
        self.alpha_x.max(self.alpha_y)
    }

    /// The smaller roughness.
    pub fn smallest_alpha(&self) -> F {
        self.alpha_x.min(self.alpha_y)
    }

    /// The masking–shadowing.
    pub fn shadowing(&self) -> Shadowing {
        self.shadowing
    }

    /// `true` if normals are sampled in exact proportion to their visible area.
    pub fn samples_visible_normals(&self) -> bool {
        self.shape != Shape::Gaussian
    }

    /// Density of micro normals at the unit vector `m` \[sr⁻¹\]; 0 where `m` is not above the surface.
    ///
    /// Written over the components of `m`: the form over n·m alone is wrong by 7 % in `f32` at α = 1e-3.
    #[inline]
    pub fn d(&self, m: F::Vec3) -> F {
        if m.z() > F::ZERO { F::TWO * self.half_density(self.unstretch(m), F::ONE) } else { F::ZERO }
    }

    /// ½ D at a normal above the surface, of any length: as it is at unit roughness, and its squared length at this one.
    #[inline(always)]
    fn half_density(&self, unit: F::Vec3, length_squared: F) -> F {
        let (stretched, z) = (sin2_theta::<F>(unit), unit.z());
        let relative = match self.shape {
            Shape::Ggx => ggx::density(stretched, z, length_squared),
            Shape::Beckmann => beckmann::density(stretched, z, length_squared),
            Shape::Gaussian => gaussian::density(stretched, sin2_theta::<F>(self.stretch(unit)), z),
        };
        F::HALF * self.peak * relative
    }

    /// A direction, or a normal from unit roughness to this one.
    #[inline(always)]
    fn stretch(&self, w: F::Vec3) -> F::Vec3 {
        stretch::<F>(w, self.alpha_x, self.alpha_y)
    }

    /// A normal from this roughness to unit roughness.
    #[inline(always)]
    fn unstretch(&self, m: F::Vec3) -> F::Vec3 {
        stretch::<F>(m, self.inverse_alpha[0], self.inverse_alpha[1])
    }

    /// σ(w): area of the micro surface that the unit vector `w` sees, per unit of macro surface, after Smith.
    ///
    /// Positive for directions below the horizon as well, where it is what a ray inside the micro surface sees.
    #[inline(always)]
    pub fn projected_area(&self, w: F::Vec3) -> F {
        let s_squared = sin2_theta::<F>(self.stretch(w));
        match self.shape {
            Shape::Beckmann => beckmann::projected_area(w.z(), s_squared),
            // No constructor gives a Gaussian Smith's masking.
            Shape::Ggx | Shape::Gaussian => ggx::projected_area(w.z(), s_squared),
        }
    }

    /// σ(w) + σ(−w) = 2 σ(w) − cos θ: what `w` sees of the micro surface from both sides, for `w` above it.
    #[inline(always)]
    fn two_sided_area(&self, w: F::Vec3) -> F {
        let s_squared = sin2_theta::<F>(self.stretch(w));
        match self.shape {
            Shape::Beckmann => F::TWO * beckmann::projected_area(w.z(), s_squared) - w.z(),
            Shape::Ggx | Shape::Gaussian => ggx::two_sided_area(w.z(), s_squared),
        }
    }

    /// Smith's Λ(w) = σ(w) / cos θ − 1, for `w` above the surface; `None` for V-cavities.
    #[inline]
    pub fn lambda(&self, w: F::Vec3) -> Option<F> {
        let s_squared = sin2_theta::<F>(self.stretch(w));
        match (self.shadowing, self.shape) {
            (Shadowing::VCavity, _) | (_, Shape::Gaussian) => None,
            (_, Shape::Ggx) => Some(ggx::lambda(w.z(), s_squared)),
            (_, Shape::Beckmann) => Some(beckmann::lambda(w.z(), s_squared)),
        }
    }

    /// Masking G₁(w, m): the fraction of the facets of normal `m` that `w` sees among those that face it.
    ///
    /// Smith's is cos θ / σ(w) for all of them, that of V-cavities min(1, 2 cos θm cos θ / (w·m)).
    #[inline]
    pub fn g1(&self, w: F::Vec3, m: F::Vec3) -> F {
        let facing = w.dot(m);
        if w.z() <= F::ZERO || facing <= F::ZERO {
            return F::ZERO;
        }
        match self.shadowing {
            Shadowing::VCavity => shadowing::v_cavity(m.z(), w.z(), facing),
            Shadowing::SmithCorrelated | Shadowing::SmithSeparable => w.z() / self.projected_area(w),
        }
    }

    /// Masking–shadowing G₂(wo, wi, m) of a facet seen from both directions: `wo` above the surface, `wi` above it
    /// (reflection) or below (transmission).
    #[inline]
    pub fn g2(&self, wo: F::Vec3, wi: F::Vec3, m: F::Vec3) -> F {
        if wi.z() < F::ZERO {
            return self.g2_transmission(wo, -wi, m);
        }
        match self.shadowing {
            Shadowing::SmithCorrelated => {
                let sigma_o = self.projected_area(wo);
                wo.z() * wi.z() / (self.projected_area(wi) * wo.z() + (sigma_o - wo.z()) * wi.z())
            }
            Shadowing::SmithSeparable => self.g1(wo, m) * self.g1(wi, m),
            Shadowing::VCavity => self.g1(wo, m).min(self.g1(wi, m)),
        }
    }

    /// G₂ across the surface, of `wo` above it and the *reverse* of a direction below it.
    ///
    /// Smith: B(1 + Λo, 1 + Λi), because what hides a point of the height field from above is what it shows
    /// below. Heitz et al., *ACM TOG* 35(4), 2016, <https://doi.org/10.1145/2897824.2925943>. With the correlated
    /// form of reflection T is too large by up to 109 % (α = 1, 75°). V-cavities: `wo` sees the upper part of a
    /// facet and the other direction its lower part; they share max(0, G₁o + G₁i − 1) of it.
    #[inline]
    fn g2_transmission(&self, wo: F::Vec3, back: F::Vec3, m: F::Vec3) -> F {
        match self.shadowing {
            Shadowing::VCavity => {
                // What the other direction hides is exact where it hides little; of a grazing one nothing is lost in 1.
                let (a, b) = (self.g1(wo, m), self.g1(back, m));
                (a.min(b) - (F::ONE - a.max(b))).max(F::ZERO)
            }
            Shadowing::SmithCorrelated | Shadowing::SmithSeparable => {
                // Half an ulp below 1 is to the power of the other one.
                let over_cosine = |w: F::Vec3| (self.projected_area(w) / w.z()).max(F::ONE);
                beta(over_cosine(wo), over_cosine(back))
            }
        }
    }

    /// Density \[sr⁻¹\] of [`Self::sample_visible`].
    #[inline]
    pub fn visible_pdf(&self, w: F::Vec3, m: F::Vec3) -> F {
        let facing = w.dot(m).max(F::ZERO);
        match self.shadowing {
            Shadowing::VCavity => self.folded_pdf(w, m, facing) * facing,
            Shadowing::SmithCorrelated | Shadowing::SmithSeparable => {
                self.d(m) * facing / self.projected_area(w)
            }
        }
    }

    /// [`Self::visible_pdf`] of V-cavities over w·m: q(m) min(2 / (w·m), 1 / (cos θm cos θ)), where q is the density of
    /// normals before the visible one of the two walls of a cavity is picked.
    #[inline]
    fn folded_pdf(&self, w: F::Vec3, m: F::Vec3, facing: F) -> F {
        if m.z() <= F::ZERO {
            return F::ZERO;
        }
        let density = match self.shape {
            Shape::Ggx | Shape::Beckmann => self.d(m) * m.z(),
            Shape::Gaussian => gaussian::sampling_pdf(m, self.alpha_x, self.alpha_y),
        };
        density * (F::TWO / facing).min(F::ONE / (m.z() * w.z()))
    }

    /// Draws a micro normal in proportion to the area that the unit vector `w` sees of it (for the Gaussian: nearly
    /// so), and returns it with what is left of the uniform `uc`.
    ///
    /// Smith: Heitz & d'Eon, *Computer Graphics Forum* 33(4), 2014, <https://doi.org/10.1111/cgf.12417>. V-cavities: a
    /// normal regardless of visibility, then it or its mirror image, the other wall of the cavity. `None` where a
    /// Gaussian normal falls below the horizon.
    #[inline(always)]
    pub fn sample_visible(&self, w: F::Vec3, uc: F, u: [F; 2]) -> Option<(F::Vec3, F)> {
        if self.shadowing == Shadowing::VCavity {
            return self.sample_wall(w, uc, u);
        }
        Some((self.stretch(self.sample_unit(w, u)).normalize(), uc))
    }

    /// A visible normal of any length, as it is at unit roughness: a distribution stretched by α is the one of unit
    /// roughness, seen from the stretched direction.
    #[inline(always)]
    fn sample_unit(&self, w: F::Vec3, u: [F; 2]) -> F::Vec3 {
        match self.shape {
            Shape::Beckmann => beckmann::sample_visible_unit::<F>(self.stretch(w).normalize(), u),
            Shape::Ggx | Shape::Gaussian => ggx::sample_visible_unit::<F>(self.stretch(w), u),
        }
    }

    #[inline(never)]
    fn sample_wall(&self, w: F::Vec3, uc: F, u: [F; 2]) -> Option<(F::Vec3, F)> {
        let slope = |radius: F| {
            let (sin_phi, cos_phi) = u[1].sin_cos_turns();
            (self.alpha_x * radius * cos_phi, self.alpha_y * radius * sin_phi)
        };
        let radius = match self.shape {
            Shape::Ggx => (u[0] / (F::ONE - u[0])).sqrt(),
            Shape::Beckmann | Shape::Gaussian => beckmann::slope_along_normal(u[0]),
        };
        let (x, y) = slope(radius);
        let m = match self.shape {
            Shape::Ggx | Shape::Beckmann => F::Vec3::new(x, y, F::ONE).normalize(),
            Shape::Gaussian => gaussian::normal_at::<F>(x, y)?,
        };
        let mirrored = F::Vec3::new(-m.x(), -m.y(), m.z());
        let (facing, other) = (w.dot(m).max(F::ZERO), w.dot(mirrored).max(F::ZERO));
        let share = facing / (facing + other);
        Some(if uc < share { (m, uc / share) } else { (mirrored, (uc - share) / (F::ONE - share)) })
    }

    /// The same distribution with its kind known to the compiler, if it is a rough surface of GGX with height-correlated
    /// masking: a lobe then compiles the path that scenes take most without branches for the others.
    #[inline(always)]
    pub(crate) fn as_rough_ggx(&self) -> Option<Self> {
        if !self.is_rough_ggx {
            return None;
        }
        Some(Self { shape: Shape::Ggx, shadowing: Shadowing::SmithCorrelated, is_smooth: false, ..*self })
    }

    /// Reflection from `wo` into `wi`, both above the surface, about h = (wo + wi) / |wo + wi|:
    /// D(h) G₂ / (4 cos θo cos θi).
    ///
    /// h is not made a unit vector: D takes any length, and wo·h is half that of wo + wi.
    #[inline(always)]
    pub fn reflection(&self, wo: F::Vec3, wi: F::Vec3) -> FacetScattering<F> {
        let sum = wo + wi;
        let length_squared = sum.dot(sum);
        let cos2_theta_o = length_squared * (F::HALF * F::HALF);
        if self.shadowing == Shadowing::VCavity {
            return self.reflect_off_wall(wo, wi, sum.normalize(), cos2_theta_o.sqrt());
        }
        self.reflect_off(wo, wi, self.half_density(self.unstretch(sum), length_squared), cos2_theta_o)
    }

    /// The density of [`Self::reflection`] alone, and the squared cosine between `wo` and h.
    #[inline(always)]
    pub fn reflection_pdf(&self, wo: F::Vec3, wi: F::Vec3) -> (F, F) {
        let sum = wo + wi;
        let length_squared = sum.dot(sum);
        let cos2_theta_o = length_squared * (F::HALF * F::HALF);
        if self.shadowing == Shadowing::VCavity {
            return (self.reflect_off_wall(wo, wi, sum.normalize(), cos2_theta_o.sqrt()).pdf, cos2_theta_o);
        }
        let half_d = self.half_density(self.unstretch(sum), length_squared);
        (half_d / (self.two_sided_area(wo) + wo.z()), cos2_theta_o)
    }

    /// Reflects `wo` about a normal from [`Self::sample_visible`]; `None` where that leads into the surface.
    #[inline(always)]
    pub fn sample_reflection(&self, wo: F::Vec3, uc: F, u: [F; 2]) -> Option<(F::Vec3, FacetScattering<F>)> {
        let (facet, unit) = if self.shadowing == Shadowing::VCavity {
            let (m, _) = self.sample_wall(wo, uc, u)?;
            (m, self.unstretch(m))
        } else {
            let unit = self.sample_unit(wo, u);
            (self.stretch(unit), unit)
        };
        let (length_squared, along) = (facet.dot(facet), wo.dot(facet));
        let scale = along / length_squared;
        // The facet is doubled and not its scale, which is known later.
        let reflected = (facet + facet) * scale - wo;
        // What the facet scatters depends on the length to rounding, and need not wait for it.
        let wi = renormalize::<F>(reflected);
        if !is_above::<F>(wi) {
            return None;
        }
        let cos2_theta_o = along * scale;
        if self.shadowing == Shadowing::VCavity {
            return Some((wi, self.reflect_off_wall(wo, reflected, facet, along)));
        }
        Some((wi, self.reflect_off(wo, reflected, self.half_density(unit, length_squared), cos2_theta_o)))
    }

    /// [`Self::reflection`] about a facet `m` that was sampled.
    #[inline(always)]
    pub fn reflection_about(&self, wo: F::Vec3, wi: F::Vec3, m: F::Vec3) -> FacetScattering<F> {
        let cos_theta_o = wo.dot(m).max(F::ZERO);
        if self.shadowing == Shadowing::VCavity {
            return self.reflect_off_wall(wo, wi, m, cos_theta_o);
        }
        let cos2_theta_o = cos_theta_o.squared();
        self.reflect_off(wo, wi, self.half_density(self.unstretch(m), F::ONE), cos2_theta_o)
    }

    /// Smith, over A = σ(w) + σ(−w), so that 2σ = A + cos θ: height-correlated D / (2 (A_i cos θo + A_o cos θi)) (Heitz,
    /// *JCGT* 3(2), 2014, equation 99, <https://jcgt.org/published/0003/02/03/>), separable D / (4 σ_o σ_i). The density
    /// is D / (4 σ_o).
    #[inline(always)]
    fn reflect_off(&self, wo: F::Vec3, wi: F::Vec3, half_d: F, cos2_theta_o: F) -> FacetScattering<F> {
        let (area_o, area_i) = (self.two_sided_area(wo), self.two_sided_area(wi));
        let seen_o = area_o + wo.z();
        let lit = seen_o * wi.z();
        let denominator = if self.shadowing == Shadowing::SmithSeparable {
            F::HALF * seen_o * (area_i + wi.z())
        } else {
            // The difference is A_o cos θi and not smaller than what is subtracted. It spares keeping A_o, whose register
            // would make the square root of a loop's next sample wait for this one.
            area_i * wo.z() + (lit - wo.z() * wi.z())
        };
        FacetScattering {
            value: half_d / denominator,
            pdf: half_d / seen_o,
            weight: lit / denominator,
            cos2_theta_o,
        }
    }

    /// Reflection by V-cavities, over the cosine between `wo` and the facet: its square loses digits where the facet is
    /// grazed, which no factor makes up for.
    #[inline(never)]
    fn reflect_off_wall(&self, wo: F::Vec3, wi: F::Vec3, m: F::Vec3, cos_theta_o: F) -> FacetScattering<F> {
        let cos2_theta_o = cos_theta_o.squared();
        let (low, high) = (wo.z().min(wi.z()), wo.z().max(wi.z()));
        let open = F::ONE / (F::FOUR * low * high);
        let closed = m.z() / (F::TWO * high * cos_theta_o);
        let value = self.d(m) * open.min(closed);
        let pdf = self.folded_pdf(wo, m, cos_theta_o) / F::FOUR;
        FacetScattering { value, pdf, weight: value * wi.z() / pdf, cos2_theta_o }
    }

    /// Directional albedo of single scattering at F = 1 for directions of the given cosine.
    pub(crate) fn single_scattering(&self, cos_theta: f64) -> f64 {
        let [albedo] = self.average_over_visible(cos_theta, [12, 6], |wo, wm| {
            let wi = reflect::<F>(wo, wm);
            [if is_above::<F>(wi) { self.reflection_about(wo, wi, wm).weight.to_f64() } else { 0.0 }]
        });
        albedo
    }

    /// The average of `values` of a direction of the given cosine and the normals that it sees, and over the azimuth
    /// where the distribution is anisotropic: by cubature over the unit square of [`Self::sample_visible`].
    pub(crate) fn average_over_visible<const N: usize>(
        &self,
        cos_theta: f64,
        panels: [usize; 2],
        values: impl Fn(F::Vec3, F::Vec3) -> [f64; N],
    ) -> [f64; N] {
        let azimuths = if self.is_isotropic() { 1 } else { 16 };
        // The limit of grazing incidence, not the tangent plane itself.
        let cos_theta = cos_theta.max(1e-9);
        let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
        let mut sums = [0.0; N];
        for azimuth in 0..azimuths {
            let turn = core::f64::consts::TAU * f64::from(azimuth) / f64::from(azimuths);
            let (sin_phi, cos_phi) = libm::sincos(turn);
            let wo = F::Vec3::from_f64([sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]);
            let [columns, rows] = unit_square(panels, self.is_isotropic());
            for (i, &[u0, width]) in columns.iter().enumerate() {
                let normals = self.visible_normals(wo, F::from_f64(u0));
                for (j, &[u1, height]) in rows.iter().enumerate() {
                    let uc = F::from_f64(kronecker(i * rows.len() + j)[0]);
                    let Some(wm) = normals(uc, F::from_f64(u1)) else { continue };
                    let share = width * height / f64::from(azimuths);
                    sums.iter_mut().zip(values(wo, wm)).for_each(|(sum, value)| *sum += share * value);
                }
            }
        }
        sums
    }

    /// [`Self::sample_visible`] of one first uniform, as a function of `uc` and the second.
    fn visible_normals(&self, w: F::Vec3, u0: F) -> impl Fn(F, F) -> Option<F::Vec3> {
        // What this shape takes long for does not depend on the second.
        let is_smith = self.shadowing != Shadowing::VCavity;
        let column = (is_smith && self.shape == Shape::Beckmann)
            .then(|| beckmann::VisibleNormals::<F>::new(self.stretch(w).normalize(), u0));
        move |uc, u1| match &column {
            Some(column) => Some(self.stretch(column.at(u1)).normalize()),
            None => self.sample_visible(w, uc, [u0, u1]).map(|(wm, _)| wm),
        }
    }

    /// Transmission from `wo` above the surface into `wi` below it through a facet that refracts one into the other.
    ///
    /// # Definition
    /// D(m) G₂ |wo·m| |wi·m| η² / (|cos θo cos θi| (wo·m + η wi·m)²), importance; Walter et al., EGSR 2007,
    /// equation 21, <https://doi.org/10.2312/EGWR/EGSR07/195-206>.
    #[inline]
    pub fn transmission(&self, wo: F::Vec3, wi: F::Vec3, facet: &RefractingFacet<F>) -> FacetScattering<F> {
        let pdf = self.transmission_pdf(wo, facet);
        let cos2_theta_o = facet.cos_theta_o.squared();
        let g2 = self.g2_transmission(wo, -wi, facet.m);
        // Both cosines can be so small that their product is nothing; so is G₂ then.
        if g2 <= F::ZERO {
            return FacetScattering { value: F::ZERO, pdf, weight: F::ZERO, cos2_theta_o };
        }
        let value = self.d(facet.m) * (g2 / wo.z() / -wi.z()) * facet.cos_theta_o * facet.jacobian;
        let weight = match self.shadowing {
            Shadowing::VCavity => value * -wi.z() / pdf,
            // D, the facet's cosine and the Jacobian cancel.
            Shadowing::SmithCorrelated | Shadowing::SmithSeparable => g2 * (self.projected_area(wo) / wo.z()),
        };
        FacetScattering { value, pdf, weight, cos2_theta_o }
    }

    /// Density \[sr⁻¹\] of refracting `wo` at a visible facet.
    #[inline]
    pub fn transmission_pdf(&self, wo: F::Vec3, facet: &RefractingFacet<F>) -> F {
        self.visible_pdf(wo, facet.m) * facet.jacobian
    }
}

/// A facet that refracts a direction above the surface into one below it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefractingFacet<F: Real> {
    /// Its normal, above the surface.
    pub m: F::Vec3,
    /// Cosine above it, > 0.
    pub cos_theta_o: F,
    /// Cosine below it, > 0.
    pub cos_theta_t: F,
    jacobian: F,
}

impl<F: Real> RefractingFacet<F> {
    /// The facet between `wo` and `wi` on the two sides of a boundary, turned so that `wo` lies above, where the index of
    /// refraction is `eta` times that above: m = ±(wo + η wi) / |wo + η wi|. `None` where no facet does that.
    ///
    /// `from_above` is false where `wo` came from below and was turned: `eta` is then that of the boundary as it was, so
    /// that both directions of light see the same facet. Between nearly matched media 1/η would not do, because it does not
    /// have the digits of η − 1.
    #[inline]
    pub fn between(wo: F::Vec3, wi: F::Vec3, eta: F, from_above: bool) -> Option<Self> {
        let (above, below) = if from_above { (wo, wi) } else { (-wi, -wo) };
        let height = Self::height(above, below, eta);
        let sum = F::Vec3::new(above.x() + eta * below.x(), above.y() + eta * below.y(), height);
        let m = sum.normalize();
        let m = if m.z() < F::ZERO { -m } else { m };
        let (cos_theta_o, cos_theta_t) = (wo.dot(m), -wi.dot(m));
        let faces_both = cos_theta_o > F::ZERO && cos_theta_t > F::ZERO && m.z() > F::ZERO;
        // wo·m + η wi·m is the length of the sum, because m has its direction; from below η times that.
        let squeezed = if from_above { eta * eta } else { F::ONE };
        let jacobian = cos_theta_t * squeezed / sum.dot(sum);
        faces_both.then_some(Self { m, cos_theta_o, cos_theta_t, jacobian })
    }

    /// cos θo − η cos θi.
    ///
    /// Near the normal cosines are rounded to 1, and nearly matched media would be left with rounding alone: there the
    /// difference of the cosines comes from the sines.
    #[inline]
    fn height(wo: F::Vec3, wi: F::Vec3, eta: F) -> F {
        let (cos_theta_o, cos_theta_i) = (wo.z(), -wi.z());
        if cos_theta_o.min(cos_theta_i) < F::from_f64(0.75) {
            return cos_theta_o - eta * cos_theta_i;
        }
        let difference = (sin2_theta::<F>(wi) - sin2_theta::<F>(wo)) / (cos_theta_o + cos_theta_i);
        difference - (eta - F::ONE) * cos_theta_i
    }

    /// dωm / dωi = |wi·m| η² / (wo·m + η wi·m)².
    pub fn jacobian(&self) -> F {
        self.jacobian
    }

    /// The facet of the sampled normal `m`, with its cosines on both sides; `eta` and `from_above` as for
    /// [`Self::between`].
    #[inline]
    pub fn sampled(m: F::Vec3, cos_theta_o: F, cos_theta_t: F, eta: F, from_above: bool) -> Self {
        // |wo + η wi| = |cos θo − η cos θt| = |η² − 1| / (cos θo + η cos θt), which does not cancel.
        let sum = if from_above {
            eta * (cos_theta_o + eta * cos_theta_t)
        } else {
            eta * cos_theta_o + cos_theta_t
        };
        let bend = (eta - F::ONE) * (eta + F::ONE);
        Self { m, cos_theta_o, cos_theta_t, jacobian: cos_theta_t * (sum / bend).squared() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roughness_out_of_range_is_refused_with_its_value() {
        for alpha in [-0.1, 1.5, f64::NAN, f64::INFINITY] {
            let error = Distribution::new(Shape::Ggx, 0.5, alpha).unwrap_err().to_string();
            assert!(error.starts_with(&format!("alpha_y = {alpha} is out of range")), "{error}");
            assert!(Distribution::new(Shape::Beckmann, alpha as f32, 0.5).is_err());
        }
    }

    #[test]
    fn the_surface_is_smooth_where_neither_roughness_is_resolved() {
        let is_smooth = |x: f32, y: f32| Distribution::new(Shape::Ggx, x, y).unwrap().is_smooth();
        assert!(is_smooth(0.0, 0.0) && is_smooth(9.9e-5, 9.9e-5));
        assert!(!is_smooth(1e-4, 1e-4) && !is_smooth(0.0, 0.3));
    }

    #[test]
    fn the_gaussian_takes_v_cavities_only() {
        let gaussian = Distribution::new(Shape::Gaussian, 0.2_f64, 0.2).unwrap();
        assert_eq!(gaussian.shadowing(), Shadowing::VCavity);
        assert_eq!(gaussian.with_shadowing(Shadowing::SmithSeparable), Err(NoSmithForm));
    }

    #[test]
    fn facets_between_nearly_matched_media_are_exact_in_single_precision() {
        let eta = 1.0001_f32;
        for sine in [1e-6, 3e-5, 1e-4, 2e-4, 1e-3] {
            let wi = glam::DVec3::new(sine, 0.0, -f64::sqrt(1.0 - sine * sine));
            let single = RefractingFacet::between(glam::Vec3::Z, wi.as_vec3(), eta, true).unwrap();
            let double = RefractingFacet::between(glam::DVec3::Z, wi, f64::from(eta), true).unwrap();
            let error = (single.m.as_dvec3() - double.m).length();
            assert!(error < 1e-5, "{sine}: {error:e}");
            let ratio = f64::from(single.jacobian) / double.jacobian;
            assert!((ratio - 1.0).abs() < 1e-5, "{sine}: {ratio}");
        }
    }
}

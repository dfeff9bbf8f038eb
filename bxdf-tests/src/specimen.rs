//! What the laboratory examines: anybody's BxDF behind one trait.

use crate::claims::Claims;

/// A unit vector in the local frame: the normal is +z, both directions leave the surface.
pub type Direction = [f64; 3];

/// What is carried along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Transport {
    /// From the camera.
    Radiance,
    /// From a light.
    Importance,
}

/// The measure of a sample's density.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// A density over solid angle \[sr⁻¹\].
    SolidAngle(f64),
    /// The probability of a Dirac delta: that of the component that was picked, also where several share a direction.
    /// Deltas that are alike in direction, probability, weights and index count as one of that probability; a
    /// specimen with such components merges them.
    Discrete(f64),
}

/// A direction that a specimen sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    /// The sampled direction.
    pub wi: Direction,
    /// f · |cos θi| / pdf per channel.
    pub weight: [f64; 3],
    /// The density that `sample` itself reports.
    pub density: Measure,
    /// Index of refraction of the side entered over the side left; 1 for reflection.
    pub eta: f64,
}

/// A BxDF under examination.
///
/// The three calls are the contract; everything else is claimed in [`Claims`]. A renderer with its own vector
/// type converts at this door, about twenty lines: see `tests/your_renderer.rs`, and
/// `examples/foreign_renderer` for a whole crate.
///
/// A specimen in single precision declares [`crate::Precision::F32`] and receives uniforms that are exact in
/// `f32`; it rounds directions itself.
pub trait Specimen: Send + Sync {
    /// Its name where a test gives it none: that of its type unless it says otherwise. Seeds are derived from names.
    fn name(&self) -> String {
        let path = core::any::type_name::<Self>().split('<').next().unwrap_or_default();
        path.rsplit("::").next().unwrap_or_default().to_owned()
    }
    /// What the specimen promises.
    fn claims(&self) -> Claims;
    /// f(wo, wi) \[sr⁻¹\] per channel, without the cosine; 0 where scattering is a delta.
    fn eval(&self, wo: Direction, wi: Direction, transport: Transport) -> [f64; 3];
    /// Density \[sr⁻¹\] with which `sample` draws `wi` given `wo`; 0 where scattering is a delta.
    fn pdf(&self, wo: Direction, wi: Direction, transport: Transport) -> f64;
    /// Draws `wi` from three uniforms in \[0, 1); `None` where no direction comes out.
    ///
    /// The first uniform picks among components, deltas included; the others the direction. A specimen may mix
    /// at most eight deltas with a density.
    fn sample(&self, wo: Direction, uniforms: [f64; 3], transport: Transport) -> Option<Scatter>;

    /// [`Self::eval`] for many directions; override it where batches are faster.
    fn eval_many(&self, wo: Direction, wi: &[Direction], transport: Transport, values: &mut [[f64; 3]]) {
        for (value, &wi) in values.iter_mut().zip(wi) {
            *value = self.eval(wo, wi, transport);
        }
    }
    /// [`Self::pdf`] for many directions; override it where batches are faster.
    fn pdf_many(&self, wo: Direction, wi: &[Direction], transport: Transport, densities: &mut [f64]) {
        for (density, &wi) in densities.iter_mut().zip(wi) {
            *density = self.pdf(wo, wi, transport);
        }
    }
    /// [`Self::sample`] for many uniforms; override it where batches are faster.
    fn sample_many(
        &self,
        wo: Direction,
        uniforms: &[[f64; 3]],
        transport: Transport,
        scatters: &mut [Option<Scatter>],
    ) {
        for (scatter, &uniforms) in scatters.iter_mut().zip(uniforms) {
            *scatter = self.sample(wo, uniforms, transport);
        }
    }

    /// The specimen's own Fresnel reflectances \[s, p\] per channel at `cos_theta_i` on the given side
    /// (`true`: from above), for suite `fresnel`. `None` where it does not expose them.
    fn fresnel(&self, cos_theta_i: f64, from_above: bool) -> Option<[[f64; 2]; 3]> {
        let _ = (cos_theta_i, from_above);
        None
    }
    /// The micro surface behind the lobe, for suite `microfacet`.
    fn microsurface(&self) -> Option<&dyn Microsurface> {
        None
    }
    /// The specimens that differ from this one in the values of parameters only: the adversarial search of suites
    /// `finite`, `weight`, `reciprocal` and `energy` looks for the worst of them.
    fn family(&self) -> Option<&dyn Family> {
        None
    }
}

/// Specimens that differ in the values of their parameters only.
pub trait Family: Send + Sync {
    /// The parameters, at most [`crate::MOST_PARAMETERS`] of them.
    fn parameters(&self) -> &[Parameter];
    /// The member with these values, in the order of the parameters, and with its own claims; `None` where there is none.
    fn at(&self, values: &[f64]) -> Option<Box<dyn Specimen>>;
}

/// A parameter of a family, with the range that is searched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// Its name, as the witness shows it.
    pub name: &'static str,
    /// The smallest value; above 0 on a logarithmic scale.
    pub low: f64,
    /// The largest value.
    pub high: f64,
    /// What is evenly spaced.
    pub scale: Scale,
}

/// What a search spaces evenly.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scale {
    /// Values.
    Linear,
    /// Logarithms of values.
    Logarithmic,
}

impl Parameter {
    /// The value at a fraction of the range.
    pub(crate) fn at(&self, fraction: f64) -> f64 {
        match self.scale {
            Scale::Linear => self.low + fraction * (self.high - self.low),
            Scale::Logarithmic => self.low * libm::pow(self.high / self.low, fraction),
        }
    }

    /// Simple values in the range: 1, then 2 and 5 times powers of ten, the further from 1 on a logarithmic
    /// scale the later; on a linear one 0 and negative values follow.
    pub(crate) fn simple(&self) -> impl Iterator<Item = f64> {
        const SIMPLE: [f64; 19] = [
            1.0, 0.5, 2.0, 0.2, 5.0, 0.1, 10.0, 0.05, 20.0, 0.02, 50.0, 0.01, 100.0, 0.005, 200.0, 0.002,
            500.0, 0.001, 1000.0,
        ];
        let others = [0.0].into_iter().chain(SIMPLE.map(|value| -value));
        let others = others.filter(|_| self.scale == Scale::Linear);
        SIMPLE.into_iter().chain(others).filter(|value| (self.low..=self.high).contains(value))
    }
}

/// The terms of a microfacet model, as the specimen computes them, for any kind of masking.
///
/// Micro normals `m` are above the macro surface, and so are `w` and `wo`. For a two-sided specimen that is lit from
/// below, the suite points both directions the other way.
pub trait Microsurface: Send + Sync {
    /// Density of micro normals D(m) \[sr⁻¹\].
    fn d(&self, m: Direction) -> f64;
    /// Smith's Λ(w); `None` where masking does not come from one function of `w`, as with V-cavities.
    fn lambda(&self, w: Direction) -> Option<f64>;
    /// Masking G₁(w, m) of facets that face `w`; Smith's does not depend on `m`.
    fn g1(&self, w: Direction, m: Direction) -> f64;
    /// Masking–shadowing G₂(wo, wi, m): of reflection where `wi` is above, of transmission where it is below.
    fn g2(&self, wo: Direction, wi: Direction, m: Direction) -> f64;
    /// Density of visible normals D G₁ max(0, w·m) / cos θ \[sr⁻¹\] seen from `w`; `None` where the sampler draws its
    /// normals from another density.
    fn visible_pdf(&self, w: Direction, m: Direction) -> Option<f64>;
}

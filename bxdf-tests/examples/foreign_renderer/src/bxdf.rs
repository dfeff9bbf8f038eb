use crate::Float3;

/// What a path carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// From the camera: radiance, which changes by 1/η² across a boundary.
    Camera,
    /// From a light.
    Light,
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// The direction, leaving the surface.
    pub wi: Float3,
    /// f · |cos θi| / density per channel.
    pub weight: [f32; 3],
    /// Density over solid angle \[sr⁻¹\].
    pub density: f32,
    /// Index of the side entered over the side left.
    pub eta: f32,
}

/// A material in the local frame: the normal is +z, all directions leave the surface and are unit vectors.
pub trait Bxdf: Send + Sync {
    /// f(wo, wi) \[sr⁻¹\] per channel, without the cosine.
    fn evaluate(&self, wo: Float3, wi: Float3, mode: Mode) -> [f32; 3];
    /// Density \[sr⁻¹\] of [`Self::sample`].
    fn density(&self, wo: Float3, wi: Float3) -> f32;
    /// Draws a direction from one uniform for the component and two for the direction.
    fn sample(&self, wo: Float3, component: f32, u: [f32; 2], mode: Mode) -> Option<Sample>;
}

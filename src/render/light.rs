//! Lights without geometry, which only next-event estimation finds; emitting shapes are objects of the scene.

use glam::Vec3;

use super::shape::{Emission, Shape, Sphere};
use crate::parameter::{OutOfRange, require};
use crate::rgb::Rgb;

/// A light that no ray can meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A point.
    Point {
        /// Where it is.
        position: Vec3,
        /// Radiant intensity per channel \[W/sr\].
        intensity: Rgb<f32>,
    },
    /// A sphere that lights the scene and is not seen, not even in mirrors (thesis, Figure 6b).
    Sphere {
        /// Its place and size.
        sphere: Sphere,
        /// What each point of it emits per channel \[W/(m² sr)\].
        radiance: Rgb<f32>,
    },
}

/// Light that arrives from a light, if nothing stands between.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    pub(super) direction: Vec3,
    pub(super) distance: f32,
    /// Radiance over density; of points, irradiance.
    pub(super) weight: Rgb<f32>,
    /// Density \[sr⁻¹\] for those that a ray could meet as well.
    pub(super) pdf: Option<f32>,
}

impl Light {
    /// A point light.
    ///
    /// # Errors
    /// If a number is not finite or an intensity negative.
    pub fn point(position: Vec3, intensity: Rgb<f32>) -> Result<Self, OutOfRange> {
        require("position", position.length(), |length| length.is_finite(), "finite coordinates")?;
        Ok(Self::Point { position, intensity: require_light("intensity", intensity)? })
    }

    /// A spherical light without geometry.
    ///
    /// # Errors
    /// If a radiance is not finite or negative.
    pub fn sphere(sphere: Sphere, radiance: Rgb<f32>) -> Result<Self, OutOfRange> {
        Ok(Self::Sphere { sphere, radiance: require_light("radiance", radiance)? })
    }

    pub(super) fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Arrival> {
        match self {
            Self::Point { position, intensity } => {
                let way = *position - from;
                let distance = way.length();
                let weight = *intensity / (distance * distance);
                let is_apart = distance > 0.0 && weight.0.iter().all(|x| x.is_finite());
                is_apart.then(|| Arrival { direction: way / distance, distance, weight, pdf: None })
            }
            Self::Sphere { sphere, radiance } => {
                let Emission { direction, distance, pdf } = sphere.sample(from, u)?;
                Some(Arrival { direction, distance, weight: *radiance / pdf, pdf: None })
            }
        }
    }

    /// Power \[W\], by which lights are picked.
    pub(super) fn power(&self) -> f32 {
        let pi = core::f32::consts::PI;
        match self {
            Self::Point { intensity, .. } => 4.0 * pi * intensity.luminance(),
            Self::Sphere { sphere, radiance } => pi * sphere.area() * radiance.luminance(),
        }
    }
}

/// `light` itself if every channel is finite and not negative.
pub(super) fn require_light(parameter: &'static str, light: Rgb<f32>) -> Result<Rgb<f32>, OutOfRange> {
    for value in light.0 {
        require(parameter, value, |x| x >= 0.0 && x.is_finite(), "light >= 0 per channel")?;
    }
    Ok(light)
}

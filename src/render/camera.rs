//! A pinhole camera.

use glam::Vec3;

use super::shape::Ray;
use crate::parameter::{OutOfRange, require};

/// A pinhole camera that sees a rectangle of square pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    position: Vec3,
    /// Unit vectors: where it looks, right and down.
    axes: [Vec3; 3],
    /// Half the width of the picture at distance 1.
    half_width: f32,
    /// To the left upper corner of the picture.
    corner: Vec3,
    /// One pixel to the right and one down.
    steps: [Vec3; 2],
    size: [usize; 2],
}

impl Camera {
    /// A camera at `position` that looks at `target`; `field_of_view` \[rad\] is the angle of the picture's width.
    ///
    /// # Errors
    /// If it looks nowhere or along `up`, the angle is not in (0, π), or the size not in 1 to 65,536 pixels.
    pub fn new(
        position: Vec3,
        target: Vec3,
        up: Vec3,
        field_of_view: f32,
        size: [usize; 2],
    ) -> Result<Self, OutOfRange> {
        let way = (target - position).length();
        require("target", way, |way| way > 0.0 && way.is_finite(), "a point apart from the position")?;
        let forward = (target - position) / way;
        let across = forward.cross(up);
        require("up", across.length(), |x| x > 0.0 && x.is_finite(), "not along the direction of view")?;
        let is_angle = |angle: f32| angle > 0.0 && angle < core::f32::consts::PI;
        require("field of view", field_of_view, is_angle, "an angle in (0, π)")?;
        let right = across.normalize();
        Self {
            position,
            axes: [forward, right, forward.cross(right)],
            half_width: libm::tanf(0.5 * field_of_view),
            corner: forward,
            steps: [Vec3::ZERO; 2],
            size,
        }
        .with_size(size)
    }

    /// The same view in so many pixels, which are square: another ratio shows more or less above and below.
    ///
    /// # Errors
    /// If the size is not in 1 to 65,536 pixels.
    pub fn with_size(self, size: [usize; 2]) -> Result<Self, OutOfRange> {
        for pixels in size {
            require("size", pixels as f32, |_| (1..=65_536).contains(&pixels), "1 to 65536 pixels")?;
        }
        let [forward, right, down] = self.axes;
        let [width, height] = size.map(|pixels| pixels as f32);
        let step = 2.0 * self.half_width / width;
        let corner = forward - right * (0.5 * width * step) - down * (0.5 * height * step);
        Ok(Self { corner, steps: [right * step, down * step], size, ..self })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The ray through a point of the picture, in pixels from the left upper corner.
    #[inline]
    pub fn ray(&self, x: f32, y: f32) -> Ray {
        let direction = (self.corner + self.steps[0] * x + self.steps[1] * y).normalize();
        Ray { origin: self.position, direction }
    }
}

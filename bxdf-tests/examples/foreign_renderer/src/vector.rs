use std::ops::{Add, Mul, Neg};

/// Three components in single precision.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Float3 {
    pub x: f32,
    pub y: f32,
    pub z: f32,
}

impl Float3 {
    pub const fn new(x: f32, y: f32, z: f32) -> Self {
        Self { x, y, z }
    }

    pub fn dot(self, other: Self) -> f32 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Above the tangent plane, by a cosine whose square does not underflow.
    pub fn is_above(self) -> bool {
        self.z > 1e-18
    }

    pub fn normalized(self) -> Self {
        self * (1.0 / self.dot(self).sqrt())
    }
}

impl Add for Float3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl Mul<f32> for Float3 {
    type Output = Self;
    fn mul(self, scale: f32) -> Self {
        Self::new(self.x * scale, self.y * scale, self.z * scale)
    }
}

impl Neg for Float3 {
    type Output = Self;
    fn neg(self) -> Self {
        self * -1.0
    }
}

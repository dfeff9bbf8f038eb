//! Colour: linear RGB triples with Rec. 709 / sRGB primaries and a D65 white.

use core::ops::{Add, Div, Index, Mul};

use crate::real::Real;

/// A linear RGB triple; reflectances are unitless, values of a BxDF are in sr⁻¹.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rgb<F>(pub [F; 3]);

impl<F: Real> Rgb<F> {
    /// Nothing in any channel.
    pub const BLACK: Self = Self([F::ZERO; 3]);
    /// One in every channel.
    pub const WHITE: Self = Self([F::ONE; 3]);

    /// The same value in every channel.
    #[inline]
    pub fn splat(value: F) -> Self {
        Self([value; 3])
    }
    /// `f` applied to each channel.
    #[inline]
    pub fn map<T>(self, f: impl FnMut(F) -> T) -> Rgb<T> {
        Rgb(self.0.map(f))
    }
    /// Relative luminance Y, 1 for white: 0.2126 R + 0.7152 G + 0.0722 B (Rec. ITU-R BT.709-6, §3.2).
    #[inline]
    pub fn luminance(self) -> F {
        let [r, g, b] = self.0;
        F::from_f64(0.2126) * r + F::from_f64(0.7152) * g + F::from_f64(0.0722) * b
    }
    /// The same triple in double precision; exact.
    #[inline]
    pub fn to_f64(self) -> [f64; 3] {
        self.0.map(F::to_f64)
    }
}

impl<F: Real> Add for Rgb<F> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self([self.0[0] + other.0[0], self.0[1] + other.0[1], self.0[2] + other.0[2]])
    }
}

impl<F: Real> Mul for Rgb<F> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        Self([self.0[0] * other.0[0], self.0[1] * other.0[1], self.0[2] * other.0[2]])
    }
}

impl<F: Real> Mul<F> for Rgb<F> {
    type Output = Self;
    #[inline]
    fn mul(self, factor: F) -> Self {
        self.map(|value| value * factor)
    }
}

impl<F: Real> Div<F> for Rgb<F> {
    type Output = Self;
    #[inline]
    fn div(self, divisor: F) -> Self {
        self.map(|value| value / divisor)
    }
}

impl<F> Index<usize> for Rgb<F> {
    type Output = F;
    #[inline]
    fn index(&self, channel: usize) -> &F {
        &self.0[channel]
    }
}

/// CIE XYZ (Y = 1 for the white) to linear sRGB. Values outside \[0, 1\] are colours outside the gamut
/// and are kept: gold's red is 1.038.
///
/// The matrix is the inverse of the one that IEC 61966-2-1 derives from the primaries and the D65 white
/// (0.3127, 0.3290).
pub fn xyz_to_linear_srgb([x, y, z]: [f64; 3]) -> Rgb<f64> {
    const MATRIX: [[f64; 3]; 3] = [
        [3.240_969_941_904_521, -1.537_383_177_570_093, -0.498_610_760_293_003],
        [-0.969_243_636_280_88, 1.875_967_501_507_72, 0.041_555_057_407_176],
        [0.055_630_079_696_994, -0.203_976_958_888_977, 1.056_971_514_242_879],
    ];
    Rgb(MATRIX.map(|row| row[0] * x + row[1] * y + row[2] * z))
}

/// The inverse of the transfer function of sRGB (IEC 61966-2-1:1999, 5.2): linear light of a stored value in
/// \[0, 1\].
pub(crate) fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

/// The transfer function itself.
pub(crate) fn linear_to_srgb(light: f64) -> f64 {
    if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn d65_white_is_white() {
        let (x, y) = (0.3127, 0.3290);
        let white = xyz_to_linear_srgb([x / y, 1.0, (1.0 - x - y) / y]);
        for channel in white.0 {
            assert_abs_diff_eq!(channel, 1.0, epsilon = 1e-12);
        }
    }

    #[test]
    fn luminance_is_y() {
        for xyz in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
            // The standard rounds its weights to four digits.
            assert_abs_diff_eq!(xyz_to_linear_srgb(xyz).luminance(), xyz[1], epsilon = 3e-4);
        }
    }

    #[test]
    fn the_transfer_function_of_srgb_has_its_known_values_and_its_inverse() {
        assert!((srgb_to_linear(0.5) - 0.214_041_140_482_232_55).abs() < 1e-12);
        for byte in 0..=255 {
            let stored = f64::from(byte) / 255.0;
            // The standard's two limits are of four digits.
            assert!((linear_to_srgb(srgb_to_linear(stored)) - stored).abs() < 1e-5, "{byte}");
        }
    }
}

//! Pictures for people: tone mapping, false colours, PNG.

use super::{ImageError, Picture};
use crate::rgb::{linear_to_srgb, srgb_to_linear};

/// What a pixel with a channel that is not a number becomes.
const FAULT: [u8; 3] = [255, 0, 255];

impl Picture {
    /// A PNG for viewing: exposure by 2^`exposure_stops`, the tone mapper Khronos PBR Neutral, the transfer
    /// function of sRGB (IEC 61966-2-1:1999), 8 bit. Negative values become black; a pixel with +∞ becomes
    /// white, one with NaN magenta, so that faults show.
    pub fn to_png(&self, exposure_stops: f32) -> Result<Vec<u8>, ImageError> {
        if !(-64.0..=64.0).contains(&exposure_stops) {
            let expected = "stops between -64 and 64";
            return Err(ImageError::OutOfRange { name: "exposure", value: exposure_stops, expected });
        }
        let factor = f64::from(exposure_stops).exp2();
        self.encode(|pixel| tone_map(pixel.map(|value| value * factor)))
    }

    /// A PNG without exposure and tone mapping: values are clipped to \[0, 1\]. For pictures that have a
    /// scale, such as those of [`Picture::false_color`].
    pub fn to_png_clipped(&self) -> Result<Vec<u8>, ImageError> {
        self.encode(|pixel| pixel)
    }

    /// The largest channel of each pixel in false colours: black for 0, through violet, red and orange to
    /// pale yellow for `scale` and more. For maps of errors; NaN stays NaN, negative values become black.
    ///
    /// The colours are those of magma, in which equal steps look equal.
    pub fn false_color(&self, scale: f32) -> Result<Self, ImageError> {
        if !(scale > 0.0 && scale.is_finite()) {
            let expected = "a positive, finite value for the brightest colour";
            return Err(ImageError::OutOfRange { name: "scale", value: scale, expected });
        }
        let color = |pixel: &[f32; 3]| {
            if pixel.iter().any(|value| value.is_nan()) {
                return [f32::NAN; 3];
            }
            let largest = pixel.iter().copied().fold(0.0, f32::max);
            magma(f64::from(largest) / f64::from(scale)).map(|value| srgb_to_linear(value) as f32)
        };
        let pixels = self.pixels.iter().map(color).collect();
        Ok(Self { width: self.width, height: self.height, pixels })
    }

    fn encode(&self, map: impl Fn([f64; 3]) -> [f64; 3]) -> Result<Vec<u8>, ImageError> {
        let failed =
            |error: png::EncodingError| ImageError::Encoding { format: "PNG", reason: error.to_string() };
        let color = |pixel: &[f32; 3]| {
            if pixel.iter().any(|value| value.is_nan()) {
                FAULT
            } else if pixel.contains(&f32::INFINITY) {
                [255; 3]
            } else {
                // Casts to integers saturate, so that nothing wraps.
                map(pixel.map(|value| f64::from(value.max(0.0))))
                    .map(|light| (linear_to_srgb(light) * 255.0).round() as u8)
            }
        };
        let bytes: Vec<u8> = self.pixels.iter().flat_map(color).collect();
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, self.width, self.height);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let mut writer = encoder.write_header().map_err(failed)?;
        writer.write_image_data(&bytes).map_err(failed)?;
        writer.finish().map_err(failed)?;
        Ok(file)
    }
}

/// Fresnel reflection at normal incidence for a relative index of 1.5; the specification calls it F90.
pub(super) const OFFSET: f64 = 0.04;
/// Peak above which highlights are compressed, less the offset; K_s.
pub(super) const SHOULDER: f64 = 0.8 - OFFSET;
/// Speed of the desaturation; K_d.
const DESATURATION: f64 = 0.15;

/// The tone mapper Khronos PBR Neutral: linear, non-negative colours to \[0, 1\]. Colours between 0.08 and
/// 0.8 only lose the 0.04 that a glossy dielectric adds to its base colour.
///
/// Khronos Group, ToneMapping, PBR Neutral Specification, 2024,
/// <https://github.com/KhronosGroup/ToneMapping/blob/main/PBR_Neutral/README.md>.
pub(super) fn tone_map(color: [f64; 3]) -> [f64; 3] {
    let least = color[0].min(color[1]).min(color[2]);
    let offset = if least <= 2.0 * OFFSET { least - least * least / (4.0 * OFFSET) } else { OFFSET };
    let color = color.map(|value| value - offset);
    let peak = color[0].max(color[1]).max(color[2]);
    if peak <= SHOULDER {
        return color;
    }
    let compressed = 1.0 - (1.0 - SHOULDER).powi(2) / (peak + 1.0 - 2.0 * SHOULDER);
    let saturation = 1.0 / (DESATURATION * (peak - compressed) + 1.0);
    color.map(|value| value * compressed / peak * saturation + compressed * (1.0 - saturation))
}

/// The colour map magma at `position`, held at its ends; values of sRGB. Every fifteenth colour of the 256
/// that Nathaniel Smith and Stéfan van der Walt published (CC0, <https://bids.github.io/colormap/>), linear
/// between: within 0.011 of theirs. The first, #000004, is black here.
pub(super) fn magma(position: f64) -> [f64; 3] {
    const COLORS: [[f64; 3]; 18] = [
        [0.0000, 0.0000, 0.0000],
        [0.0355, 0.0284, 0.1252],
        [0.1028, 0.0630, 0.2579],
        [0.1915, 0.0648, 0.3962],
        [0.2914, 0.0646, 0.4755],
        [0.3843, 0.0979, 0.5010],
        [0.4758, 0.1346, 0.5079],
        [0.5692, 0.1675, 0.5041],
        [0.6649, 0.1981, 0.4888],
        [0.7611, 0.2312, 0.4602],
        [0.8521, 0.2761, 0.4186],
        [0.9259, 0.3468, 0.3750],
        [0.9697, 0.4469, 0.3603],
        [0.9894, 0.5579, 0.3917],
        [0.9966, 0.6683, 0.4562],
        [0.9967, 0.7768, 0.5410],
        [0.9924, 0.8843, 0.6401],
        [0.9871, 0.9914, 0.7495],
    ];
    let last = COLORS.len() - 1;
    let place = position.clamp(0.0, 1.0) * last as f64;
    let low = (place as usize).min(last - 1);
    let t = place - low as f64;
    std::array::from_fn(|i| COLORS[low][i] + (COLORS[low + 1][i] - COLORS[low][i]) * t)
}

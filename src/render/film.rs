//! What has been found so far, pixel by pixel, and how it is kept between runs.

use crate::rgb::Rgb;

use super::image::{ImageError, Layers, Picture};
use super::path::Found;

/// Sums over the samples of one pixel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pixel {
    pub(super) direct: [f64; 3],
    pub(super) indirect: [f64; 3],
    /// Of the squares of the sum of both.
    pub(super) squares: [f64; 3],
    /// Albedo of what the first samples see.
    pub(super) albedo: [f32; 3],
    /// Shading normal of what they see.
    pub(super) normal: [f32; 3],
}

/// How many numbers a pixel has in a checkpoint, and their bytes.
const BYTES: usize = 9 * 8 + 6 * 4;
/// What a checkpoint begins with.
const MAGIC: &[u8; 16] = b"gonio checkpt 1\n";

/// Samples that albedo and normal are taken of; more would show nothing new.
pub(super) const LAYER_SAMPLES: u32 = 16;

/// A picture that more samples can be added to.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    pub(super) size: [usize; 2],
    pub(super) samples: u32,
    pub(super) pixels: Vec<Pixel>,
}

/// Why a checkpoint cannot be gone on with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CheckpointError {
    /// Other bytes than a checkpoint has.
    #[error("this is no checkpoint of gonio, or not a whole one: {0}")]
    Damaged(&'static str),
    /// Of another scene, size or seed.
    #[error("the checkpoint is of {0} than this rendering: render anew, without --resume")]
    Other(&'static str),
}

impl Film {
    /// A black picture of the given width and height.
    pub fn new(size: [usize; 2]) -> Self {
        Self { size, samples: 0, pixels: vec![Pixel::default(); size[0] * size[1]] }
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Samples per pixel so far.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Mean radiance per pixel and channel, row by row from the left upper corner.
    pub fn radiance(&self) -> Vec<[f64; 3]> {
        self.means(|pixel, channel| pixel.direct[channel] + pixel.indirect[channel])
    }

    /// The part of it that comes straight or after one bounce.
    pub fn direct(&self) -> Vec<[f64; 3]> {
        self.means(|pixel, channel| pixel.direct[channel])
    }

    /// The part of it that comes after more bounces.
    pub fn indirect(&self) -> Vec<[f64; 3]> {
        self.means(|pixel, channel| pixel.indirect[channel])
    }

    fn means(&self, of: impl Fn(&Pixel, usize) -> f64) -> Vec<[f64; 3]> {
        let samples = f64::from(self.samples.max(1));
        self.pixels.iter().map(|pixel| [0, 1, 2].map(|channel| of(pixel, channel) / samples)).collect()
    }

    /// Variance of the mean per pixel and channel; infinite before the second sample.
    pub fn variance(&self) -> Vec<[f64; 3]> {
        let n = f64::from(self.samples);
        self.pixels
            .iter()
            .map(|pixel| {
                [0, 1, 2].map(|channel| {
                    let sum = pixel.direct[channel] + pixel.indirect[channel];
                    let spread = (pixel.squares[channel] - sum * sum / n).max(0.0);
                    if self.samples > 1 { spread / (n * (n - 1.0)) } else { f64::INFINITY }
                })
            })
            .collect()
    }

    /// Albedo of the nearest surface per pixel and channel, of the first samples.
    pub fn albedo(&self) -> Vec<[f32; 3]> {
        let samples = self.samples.clamp(1, LAYER_SAMPLES) as f32;
        self.pixels.iter().map(|pixel| pixel.albedo.map(|sum| sum / samples)).collect()
    }

    /// Shading normal of the nearest surface per pixel, of the first samples; shorter where they differ.
    pub fn normal(&self) -> Vec<[f32; 3]> {
        let samples = self.samples.clamp(1, LAYER_SAMPLES) as f32;
        self.pixels.iter().map(|pixel| pixel.normal.map(|sum| sum / samples)).collect()
    }

    /// Root of the mean variance over the mean radiance: the noise of the picture.
    pub fn noise(&self) -> f64 {
        let sum = |all: Vec<[f64; 3]>| all.into_iter().flatten().sum::<f64>();
        let values = 3.0 * self.pixels.len() as f64;
        let mean = sum(self.radiance()) / values;
        if mean > 0.0 { (sum(self.variance()) / values).sqrt() / mean } else { 0.0 }
    }

    /// The whole state as bytes; `rendering` tells what it is a rendering of.
    pub fn checkpoint(&self, rendering: u64) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        let [width, height] = self.size.map(|pixels| pixels as u64);
        for number in [rendering, width, height, u64::from(self.samples)] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.reserve(self.pixels.len() * BYTES);
        for pixel in &self.pixels {
            for sum in [pixel.direct, pixel.indirect, pixel.squares].into_iter().flatten() {
                bytes.extend(sum.to_le_bytes());
            }
            for sum in [pixel.albedo, pixel.normal].into_iter().flatten() {
                bytes.extend(sum.to_le_bytes());
            }
        }
        bytes
    }

    /// The state that [`Self::checkpoint`] wrote for the same rendering and size.
    ///
    /// # Errors
    /// If the bytes are none of a checkpoint, or of another rendering.
    pub fn resumed(bytes: &[u8], rendering: u64, size: [usize; 2]) -> Result<Self, CheckpointError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Damaged("it begins otherwise"))?;
        let (head, rest) = rest.split_at_checked(32).ok_or(CheckpointError::Damaged("its head is cut"))?;
        let number =
            |i: usize| head[8 * i..8 * i + 8].iter().rev().fold(0, |sum, &b| sum << 8 | u64::from(b));
        if number(0) != rendering {
            return Err(CheckpointError::Other("another scene, seed or other settings"));
        }
        if [number(1), number(2)] != size.map(|pixels| pixels as u64) {
            return Err(CheckpointError::Other("another size"));
        }
        let samples = u32::try_from(number(3)).map_err(|_| CheckpointError::Damaged("too many samples"))?;
        if rest.len() != size[0] * size[1] * BYTES {
            return Err(CheckpointError::Damaged("its length is not that of its size"));
        }
        let pixels = rest.chunks_exact(BYTES).map(|bytes| {
            let double = |i: usize| {
                let mut eight = [0; 8];
                eight.copy_from_slice(&bytes[8 * i..8 * i + 8]);
                f64::from_le_bytes(eight)
            };
            let single = |i: usize| {
                let mut four = [0; 4];
                four.copy_from_slice(&bytes[72 + 4 * i..76 + 4 * i]);
                f32::from_le_bytes(four)
            };
            Pixel {
                direct: [0, 1, 2].map(double),
                indirect: [3, 4, 5].map(double),
                squares: [6, 7, 8].map(double),
                albedo: [0, 1, 2].map(single),
                normal: [3, 4, 5].map(single),
            }
        });
        Ok(Self { size, samples, pixels: pixels.collect() })
    }
}

impl Pixel {
    pub(super) fn add(&mut self, found: &Found) {
        let [direct, indirect] = [found.direct, found.indirect].map(Rgb::to_f64);
        for channel in 0..3 {
            let sum = direct[channel] + indirect[channel];
            self.direct[channel] += direct[channel];
            self.indirect[channel] += indirect[channel];
            self.squares[channel] += sum * sum;
        }
    }
}

impl Layers {
    /// The layers of a film.
    ///
    /// # Errors
    /// If it is larger than a picture may be.
    pub fn of(film: &Film) -> Result<Self, ImageError> {
        let [width, height] = film.size.map(|pixels| pixels as u32);
        let single =
            |values: Vec<[f64; 3]>| values.into_iter().map(|value| value.map(|x| x as f32)).collect();
        let picture = |pixels| Picture::new(width, height, pixels);
        Ok(Self {
            color: picture(single(film.radiance()))?,
            direct: picture(single(film.direct()))?,
            indirect: picture(single(film.indirect()))?,
            albedo: picture(film.albedo())?,
            normal: picture(film.normal())?,
            variance: picture(single(film.variance()))?,
            samples: vec![film.samples as f32; film.pixels.len()],
        })
    }
}

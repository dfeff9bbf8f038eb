//! What differs between two pictures.

use super::{ImageError, Picture, flip};

/// Keeps the relative error finite where the reference is black; the value is common for renderings.
const FLOOR: f64 = 0.01;

/// What differs between an image and its reference. Means are over all channels of all pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of image − reference, with its sign: positive where the image is too bright.
    pub mean_error: f64,
    /// Root of the mean of (image − reference)².
    pub rms: f64,
    /// Mean of (image − reference)² / (reference² + 0.01), as in Rousselle et al. 2011
    /// (DOI 10.1145/2024156.2024193): it weighs dark parts as much as bright ones.
    pub relative_mse: f64,
    /// Where the images differ most.
    pub largest: Largest,
    /// Mean LDR-FLIP, from 0 for equal pictures to 1, as seen on a display that clips colours to \[0, 1\] and
    /// shows 67 pixels per degree (Andersson et al., HPG 2020, DOI 10.1145/3406183).
    pub flip_mean: f64,
    /// |image − reference| of each channel; see [`Picture::false_color`].
    pub map: Picture,
}

/// The largest difference of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Largest {
    /// image − reference.
    pub error: f64,
    /// Column, from 0 at the left.
    pub x: u32,
    /// Row, from 0 at the top.
    pub y: u32,
    /// 0 for red, 1 for green, 2 for blue.
    pub channel: usize,
}

/// Compares two pictures of one size, all of whose colours are finite.
pub fn compare(image: &Picture, reference: &Picture) -> Result<Comparison, ImageError> {
    let size = |picture: &Picture| (picture.width, picture.height);
    if size(image) != size(reference) {
        return Err(ImageError::DifferentSizes { image: size(image), reference: size(reference) });
    }
    finite("image", image)?;
    finite("reference", reference)?;
    let (mut sum, mut squares, mut relative) = (0.0, 0.0, 0.0);
    let mut largest = Largest { error: 0.0, x: 0, y: 0, channel: 0 };
    let mut map = image.clone();
    for (index, (pixel, expected)) in map.pixels.iter_mut().zip(&reference.pixels).enumerate() {
        for channel in 0..3 {
            let expected = f64::from(expected[channel]);
            let error = f64::from(pixel[channel]) - expected;
            sum += error;
            squares += error * error;
            relative += error * error / (expected * expected + FLOOR);
            if error.abs() > largest.error.abs() {
                let (x, y) = reference.place(index);
                largest = Largest { error, x, y, channel };
            }
            pixel[channel] = error.abs() as f32;
        }
    }
    let count = 3.0 * image.pixels.len() as f64;
    Ok(Comparison {
        mean_error: sum / count,
        rms: (squares / count).sqrt(),
        relative_mse: relative / count,
        largest,
        flip_mean: flip::mean(image, reference),
        map,
    })
}

fn finite(which: &'static str, picture: &Picture) -> Result<(), ImageError> {
    let fault = |pixel: &[f32; 3]| pixel.iter().any(|value| !value.is_finite());
    match picture.pixels.iter().position(fault) {
        None => Ok(()),
        Some(index) => {
            let (x, y) = picture.place(index);
            Err(ImageError::NotFinite { which, x, y, value: picture.pixels[index] })
        }
    }
}

//! The layers of a rendering, as OpenEXR.

use std::io::Cursor;

use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
use exr::prelude::{LayerAttributes, WritableImage as _};

use super::{ImageError, Picture};

/// What a rendering leaves, as layers of one OpenEXR file.
#[derive(Clone, Debug, PartialEq)]
pub struct Layers {
    /// Radiance: channels R, G, B.
    pub color: Picture,
    /// The part of it that comes straight or after one bounce: channels direct.R, direct.G, direct.B.
    pub direct: Picture,
    /// The part that comes after more bounces: channels indirect.R, indirect.G, indirect.B.
    pub indirect: Picture,
    /// Albedo of what the first ray hits: channels albedo.R, albedo.G, albedo.B.
    pub albedo: Picture,
    /// Its normal in the frame of the scene: channels normal.X, normal.Y, normal.Z.
    pub normal: Picture,
    /// Variance of the mean of each colour: channels variance.R, variance.G, variance.B.
    pub variance: Picture,
    /// Samples of each pixel, row by row from the top left: channel samples.Y.
    pub samples: Vec<f32>,
}

impl Layers {
    /// A file of 32-bit floats in scan lines, ZIP compressed; equal layers give equal bytes.
    pub fn to_exr(&self) -> Result<Vec<u8>, ImageError> {
        let Self { color, direct, indirect, albedo, normal, variance, samples } = self;
        let size = |picture: &Picture| format!("{} × {} pixels", picture.width, picture.height);
        let others = [
            ("direct", direct),
            ("indirect", indirect),
            ("albedo", albedo),
            ("normal", normal),
            ("variance", variance),
        ];
        for (layer, picture) in others {
            if (picture.width, picture.height) != (color.width, color.height) {
                return Err(ImageError::LayerSize { layer, found: size(picture), expected: size(color) });
            }
        }
        if samples.len() != color.pixels.len() {
            let found = format!("{} values", samples.len());
            return Err(ImageError::LayerSize { layer: "samples", found, expected: size(color) });
        }
        let mut channels = Vec::new();
        channels.extend(split(color, ["R", "G", "B"]));
        channels.extend(split(direct, ["direct.R", "direct.G", "direct.B"]));
        channels.extend(split(indirect, ["indirect.R", "indirect.G", "indirect.B"]));
        channels.extend(split(albedo, ["albedo.R", "albedo.G", "albedo.B"]));
        channels.extend(split(normal, ["normal.X", "normal.Y", "normal.Z"]));
        channels.extend(split(variance, ["variance.R", "variance.G", "variance.B"]));
        channels.push(AnyChannel::new("samples.Y", FlatSamples::F32(samples.clone())));
        encode(color, channels)
    }
}

impl Picture {
    /// A file with the channels R, G, B, as [`Layers::to_exr`] makes it.
    pub fn to_exr(&self) -> Result<Vec<u8>, ImageError> {
        encode(self, split(self, ["R", "G", "B"]).into())
    }
}

fn split(picture: &Picture, names: [&str; 3]) -> [AnyChannel<FlatSamples>; 3] {
    std::array::from_fn(|i| {
        let values = picture.pixels.iter().map(|pixel| pixel[i]).collect();
        AnyChannel::new(names[i], FlatSamples::F32(values))
    })
}

fn encode(size: &Picture, channels: Vec<AnyChannel<FlatSamples>>) -> Result<Vec<u8>, ImageError> {
    let layer = Layer::new(
        (size.width as usize, size.height as usize),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        AnyChannels::sort(channels.into()),
    );
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|error| ImageError::Encoding { format: "OpenEXR", reason: error.to_string() })?;
    Ok(bytes.into_inner())
}

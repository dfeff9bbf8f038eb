//! Pictures: what a rendering leaves, as OpenEXR for programs and as PNG for people, and their comparison.
//!
//! Colours are linear with Rec. 709 primaries. Start at [`Picture`]; [`Layers`] are the layers of one
//! rendering, [`read()`] reads files, [`compare()`] measures what differs.

mod compare;
mod display;
mod flip;
mod layers;
mod read;

pub use compare::{Comparison, Largest, compare};
pub use layers::Layers;
pub use read::read;

/// Pixels of a picture at most, 2^28: 16 384 × 16 384, of which the colours alone take 3 GiB.
pub const LARGEST: u64 = 1 << 28;

/// Linear colours (Rec. 709 primaries), row by row from the top left.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    width: u32,
    height: u32,
    pixels: Vec<[f32; 3]>,
}

impl Picture {
    /// Takes `width` × `height` pixels, row by row from the top left.
    pub fn new(width: u32, height: u32, pixels: Vec<[f32; 3]>) -> Result<Self, ImageError> {
        let expected = area(width, height)?;
        if pixels.len() as u64 != expected {
            return Err(ImageError::WrongLength { width, height, found: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }
    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.width
    }
    /// Rows.
    pub fn height(&self) -> u32 {
        self.height
    }
    /// The pixels, row by row from the top left.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// Column and row of a pixel.
    fn place(&self, index: usize) -> (u32, u32) {
        let (index, width) = (index as u64, u64::from(self.width));
        ((index % width) as u32, (index / width) as u32)
    }
}

/// The number of pixels, if a picture may have as many.
fn area(width: u32, height: u32) -> Result<u64, ImageError> {
    let pixels = u64::from(width) * u64::from(height);
    if pixels == 0 || pixels > LARGEST { Err(ImageError::Size { width, height }) } else { Ok(pixels) }
}

/// A picture that cannot be made, read, written or compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImageError {
    /// Sizes that no picture has.
    #[error("{width} × {height} pixels; a picture has at least one and at most 2^28 = 268435456")]
    Size {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// The number of pixels is not the product of the sizes.
    #[error(
        "{found} pixels for a picture of {width} × {height}; it takes {}",
        u64::from(*width) * u64::from(*height)
    )]
    WrongLength {
        /// Pixels in a row.
        width: u32,
        /// Rows.
        height: u32,
        /// The pixels given.
        found: usize,
    },
    /// A layer differs in size from the colours.
    #[error("the layer `{layer}` has {found}, the colours {expected}; all layers need the same size")]
    LayerSize {
        /// The layer.
        layer: &'static str,
        /// Its size.
        found: String,
        /// The size of the colours.
        expected: String,
    },
    /// Two pictures to compare differ in size.
    #[error(
        "the image has {} × {} pixels, the reference {} × {}; render both at one size",
        image.0, image.1, reference.0, reference.1
    )]
    DifferentSizes {
        /// Width and height of the image.
        image: (u32, u32),
        /// Width and height of the reference.
        reference: (u32, u32),
    },
    /// A pixel of a picture to compare is infinite or not a number.
    #[error(
        "the {which} has the colour {value:?} at column {x}, row {y}; \
         only finite colours can be compared, so find the fault in what made it"
    )]
    NotFinite {
        /// `image` or `reference`.
        which: &'static str,
        /// Column, from 0 at the left.
        x: u32,
        /// Row, from 0 at the top.
        y: u32,
        /// The colour.
        value: [f32; 3],
    },
    /// A setting out of its range.
    #[error("{name} is {value}; expected {expected}")]
    OutOfRange {
        /// The setting.
        name: &'static str,
        /// Its value.
        value: f32,
        /// What is expected.
        expected: &'static str,
    },
    /// A file that cannot be read.
    #[error("cannot read {path}: {reason}")]
    Unreadable {
        /// The file.
        path: String,
        /// Why, and the way out.
        reason: String,
    },
    /// An encoder failed, which it never does in memory for the pictures it is given.
    #[error("cannot encode the picture as {format}: {reason}")]
    Encoding {
        /// PNG or OpenEXR.
        format: &'static str,
        /// What the encoder says.
        reason: String,
    },
}

#[cfg(test)]
mod tests;

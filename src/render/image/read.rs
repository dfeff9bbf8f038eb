//! Reading pictures.

use std::fs::File;
use std::io::{BufRead, BufReader, Seek, SeekFrom};
use std::path::Path;

use exr::compression::Compression;
use exr::meta::MetaData;
use exr::meta::header::Header;
use exr::prelude::{ReadChannels as _, ReadLayers as _, ReadSpecificChannel as _, Vec2, read as exr_reader};

use super::{ImageError, Picture, area};
use crate::rgb::srgb_to_linear;

/// DEFLATE packs 258 bytes into two bits at best (RFC 1951, 3.2.5), so no file holds more than this per byte.
const LARGEST_EXPANSION: u64 = 1032;
/// Bytes of a block of OpenEXR that are unpacked at most; 32 lines of 16 384 pixels with 128 channels of 32
/// bits have as many.
const LARGEST_BLOCK: usize = 1 << 28;

/// Reads a picture, by the extension of the file:
///
/// * `.png`: grey, RGB or palette of up to 16 bits, sRGB to linear. Transparency is dropped, other colour
///   spaces in the file are not heeded.
/// * `.exr`: the channels R, G, B of the first part that has them, of any sample type, in tiles or scan
///   lines, compressed as RLE, ZIP, ZIPS, PIZ or PXR24 or not at all. The data window alone counts.
pub fn read(path: &Path) -> Result<Picture, ImageError> {
    let refused = |reason: String| ImageError::Unreadable { path: path.display().to_string(), reason };
    let extension = path.extension().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let png = match extension.as_str() {
        "png" => true,
        "exr" => false,
        _ => return Err(refused("its extension is unknown; pictures end in .png or .exr".into())),
    };
    let metadata = path.metadata().map_err(|error| refused(error.to_string()))?;
    if !metadata.is_file() {
        // Opening a pipe would wait for its other end.
        return Err(refused("it is not a file, but a folder or device".into()));
    }
    let file = File::open(path).map_err(|error| refused(error.to_string()))?;
    let file = BufReader::new(file);
    if png { decode_png(file, metadata.len()) } else { decode_exr(file) }.map_err(refused)
}

/// A complaint of a decoder, with the way out.
fn damaged(error: impl std::fmt::Display) -> String {
    format!("{error}; the file is damaged or of another kind, so write it again")
}

pub(super) fn decode_png(source: impl BufRead + Seek, bytes: u64) -> Result<Picture, String> {
    let mut decoder = png::Decoder::new(source);
    decoder.set_transformations(png::Transformations::EXPAND);
    decoder.set_ignore_text_chunk(true);
    decoder.set_ignore_iccp_chunk(true);
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = (header.width, header.height);
    let pixels = area(width, height).map_err(|error| error.to_string())?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let size = reader.output_buffer_size().ok_or_else(|| damaged("its rows are too long"))?;
    // Checked before memory is taken: every pixel has one bit at least, and expands to at most eight bytes.
    if pixels > bytes.saturating_mul(8 * LARGEST_EXPANSION) {
        return Err(damaged(format!("{width} × {height} pixels cannot come from {bytes} bytes")));
    }
    let mut samples = vec![0; size];
    let frame = reader.next_frame(&mut samples).map_err(damaged)?;
    let wide = frame.bit_depth == png::BitDepth::Sixteen;
    let channels = frame.color_type.samples();
    let scale = if wide { 65535.0 } else { 255.0 };
    let linear: Vec<f32> =
        (0..=scale as u32).map(|value| srgb_to_linear(f64::from(value) / scale) as f32).collect();
    let value = |index: usize| {
        let stored = if wide {
            u16::from_be_bytes([samples[2 * index], samples[2 * index + 1]])
        } else {
            u16::from(samples[index])
        };
        linear[usize::from(stored)]
    };
    let color = |pixel: usize| match channels {
        1 | 2 => [value(pixel * channels); 3],
        _ => std::array::from_fn(|i| value(pixel * channels + i)),
    };
    let pixels = (0..pixels as usize).map(color).collect();
    Ok(Picture { width, height, pixels })
}

pub(super) fn decode_exr(mut source: impl BufRead + Seek) -> Result<Picture, String> {
    let meta = MetaData::read_from_buffered(&mut source, false).map_err(damaged)?;
    for header in &meta.headers {
        check(header)?;
    }
    let wanted = ["R", "G", "B"];
    let has = |header: &Header, name: &str| header.channels.list.iter().any(|channel| channel.name == *name);
    if !meta.headers.iter().any(|header| wanted.iter().all(|name| has(header, name))) {
        let found = meta.headers.iter().flat_map(|header| &header.channels.list);
        let found: Vec<_> = found.take(20).map(|channel| channel.name.to_string()).collect();
        return Err(format!("no channels R, G and B; found {}", found.join(", ")));
    }
    source.seek(SeekFrom::Start(0)).map_err(|error| error.to_string())?;
    let image = exr_reader()
        .no_deep_data()
        .largest_resolution_level()
        .specific_channels()
        .required("R")
        .required("G")
        .required("B")
        .collect_pixels(
            |size, _| Storage { width: size.width(), pixels: Vec::new() },
            |storage: &mut Storage, place, (red, green, blue): (f32, f32, f32)| {
                storage.set(place, [red, green, blue]);
            },
        )
        .first_valid_layer()
        .all_attributes()
        // A panic in a worker would end the process, and every worker would hold a block.
        .non_parallel()
        .from_buffered(source)
        .map_err(damaged)?;
    let Vec2(width, height) = image.layer_data.size;
    let picture = Picture::new(width as u32, height as u32, image.layer_data.channel_data.pixels.pixels);
    picture.map_err(damaged)
}

/// Pixels as they are decoded. Memory grows with those that are there, not with those that a header claims.
struct Storage {
    width: usize,
    pixels: Vec<[f32; 3]>,
}

impl Storage {
    fn set(&mut self, Vec2(x, y): Vec2<usize>, color: [f32; 3]) {
        let index = y * self.width + x;
        if index >= self.pixels.len() {
            self.pixels.resize(index + 1, [0.0; 3]);
        }
        self.pixels[index] = color;
    }
}

/// Refuses what the decoder would take too much memory for, or take for something else.
fn check(header: &Header) -> Result<(), String> {
    let Vec2(width, height) = header.layer_size;
    let sizes = (u32::try_from(width).unwrap_or(u32::MAX), u32::try_from(height).unwrap_or(u32::MAX));
    area(sizes.0, sizes.1).map_err(|error| error.to_string())?;
    // The decoders of the lossy kinds panic on damaged files.
    use Compression::{PIZ, PXR24, RLE, Uncompressed, ZIP1, ZIP16};
    if !matches!(header.compression, Uncompressed | RLE | ZIP1 | ZIP16 | PIZ | PXR24) {
        return Err(format!("{} is not read; write it with ZIP", header.compression));
    }
    let block = header.max_block_byte_size();
    if block > LARGEST_BLOCK {
        return Err(format!(
            "a block of {block} bytes; at most {LARGEST_BLOCK} are read, so use smaller tiles"
        ));
    }
    if header.channels.list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
        return Err("a channel with fewer samples than pixels; write all channels at full size".into());
    }
    Ok(())
}

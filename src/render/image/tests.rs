use std::fs;
use std::io::Cursor;

use exr::prelude::{
    Blocks, Compression, Encoding, Image, Layer, LayerAttributes, LineOrder, SpecificChannels, Vec2,
    WritableImage as _, f16,
};
use rand::{Rng as _, RngExt as _, SeedableRng as _};
use rand_pcg::Pcg64Mcg;

use super::display::{OFFSET, SHOULDER, magma, tone_map};
use super::read::{decode_exr, decode_png};
use super::*;
use crate::rgb::{linear_to_srgb, srgb_to_linear};

/// A picture from values of sRGB between 0 and 255.
fn stored(width: u32, height: u32, color: impl Fn(u32, u32) -> [u32; 3]) -> Picture {
    let linear = |value| srgb_to_linear(f64::from(value) / 255.0) as f32;
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| color(x, y).map(linear)).collect();
    Picture::new(width, height, pixels).unwrap()
}

fn gray(width: u32, height: u32) -> Picture {
    stored(width, height, |_, _| [128; 3])
}

fn noise(width: u32, height: u32, seed: u64) -> Picture {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let pixels = (0..width * height).map(|_| std::array::from_fn(|_| random.random())).collect();
    Picture::new(width, height, pixels).unwrap()
}

fn bits(picture: &Picture) -> Vec<[u32; 3]> {
    picture.pixels().iter().map(|pixel| pixel.map(f32::to_bits)).collect()
}

fn layers(width: u32, height: u32) -> Layers {
    let [color, albedo, normal, variance] = [1, 2, 3, 4].map(|seed| noise(width, height, seed));
    let samples = (0..width * height).map(|index| index as f32).collect();
    let (direct, indirect) = (albedo.clone(), normal.clone());
    Layers { color, direct, indirect, albedo, normal, variance, samples }
}

fn png_bytes(bytes: &[u8]) -> Result<Picture, String> {
    decode_png(Cursor::new(bytes), bytes.len() as u64)
}

fn exr_bytes(bytes: &[u8]) -> Result<Picture, String> {
    decode_exr(Cursor::new(bytes))
}

/// The 8-bit values of a PNG.
fn values(file: &[u8]) -> Vec<u8> {
    let mut reader = png::Decoder::new(Cursor::new(file)).read_info().unwrap();
    let mut values = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut values).unwrap();
    values
}

#[test]
fn a_picture_has_as_many_pixels_as_its_sizes_say() {
    let error = Picture::new(3, 2, vec![[0.0; 3]; 5]).unwrap_err();
    assert_eq!(error.to_string(), "5 pixels for a picture of 3 × 2; it takes 6");
    for (width, height) in [(0, 2), (2, 0), (16_384, 16_385), (u32::MAX, u32::MAX)] {
        let error = Picture::new(width, height, vec![]).unwrap_err();
        assert_eq!(error, ImageError::Size { width, height });
    }
    let error = Picture::new(1_000_000_000, 1_000_000_000, vec![]).unwrap_err().to_string();
    assert!(error.starts_with("1000000000 × 1000000000 pixels; "), "{error}");
}

#[test]
fn exr_keeps_every_bit_of_every_layer() {
    let mut layers = layers(37, 21);
    let odd = [f32::NAN, f32::INFINITY, -0.0];
    layers.color.pixels[5] = odd;
    layers.color.pixels[6] = [f32::MIN_POSITIVE / 8.0, f32::MAX, -3.5];
    let bytes = layers.to_exr().unwrap();
    assert_eq!(bits(&exr_bytes(&bytes).unwrap()), bits(&layers.color));

    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.exr");
    fs::write(&path, &bytes).unwrap();
    let file = exr::prelude::read_first_flat_layer_from_file(&path).unwrap();
    assert_eq!(file.layer_data.encoding.compression, Compression::ZIP16);
    let mut channels: Vec<(String, Vec<u32>)> = Vec::new();
    for channel in &file.layer_data.channel_data.list {
        let samples = channel.sample_data.values_as_f32().map(f32::to_bits).collect();
        channels.push((channel.name.to_string(), samples));
    }
    let names: Vec<_> = channels.iter().map(|(name, _)| name.as_str()).collect();
    let expected = "B G R albedo.B albedo.G albedo.R direct.B direct.G direct.R \
                    indirect.B indirect.G indirect.R normal.X normal.Y normal.Z samples.Y \
                    variance.B variance.G variance.R";
    assert_eq!(names.join(" "), expected);
    for (name, samples) in &channels {
        let (layer, channel) = name.split_once('.').unwrap_or(("color", name));
        let expected: Vec<u32> = match layer {
            "samples" => layers.samples.iter().map(|value| value.to_bits()).collect(),
            _ => {
                let picture = match layer {
                    "color" => &layers.color,
                    "albedo" => &layers.albedo,
                    "direct" => &layers.direct,
                    "indirect" => &layers.indirect,
                    "normal" => &layers.normal,
                    _ => &layers.variance,
                };
                let index = "RGBXYZ".find(channel).unwrap() % 3;
                picture.pixels.iter().map(|pixel| pixel[index].to_bits()).collect()
            }
        };
        assert!(*samples == expected, "{name}");
    }
}

#[test]
fn equal_pictures_give_equal_bytes() {
    let layers = layers(70, 40);
    assert!(layers.to_exr() == layers.clone().to_exr());
    assert!(layers.color.to_png(1.0) == layers.color.clone().to_png(1.0));
    assert!(layers.color.to_png(1.0) != layers.color.to_png(0.0));
    // These change with a version of an encoder, which is worth a look.
    let bytes = layers.to_exr().unwrap();
    assert!(!bytes.windows(4).any(|window| window == b"capD"), "a date differs from run to run");
}

#[test]
fn layers_of_different_sizes_are_refused() {
    let mut different = layers(4, 3);
    different.normal = gray(3, 4);
    let error = different.to_exr().unwrap_err().to_string();
    let expected =
        "the layer `normal` has 3 × 4 pixels, the colours 4 × 3 pixels; all layers need the same size";
    assert_eq!(error, expected);
    let mut different = layers(4, 3);
    different.samples.pop();
    let error = different.to_exr().unwrap_err().to_string();
    assert!(error.starts_with("the layer `samples` has 11 values"), "{error}");
}

#[test]
fn exr_is_read_in_every_form() {
    let expected = noise(50, 33, 9);
    for compression in [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
        Compression::PXR24,
    ] {
        for (blocks, line_order) in [
            (Blocks::ScanLines, LineOrder::Increasing),
            (Blocks::ScanLines, LineOrder::Decreasing),
            (Blocks::Tiles(Vec2(16, 7)), LineOrder::Increasing),
        ] {
            let encoding = Encoding { compression, blocks, line_order };
            let read = exr_bytes(&exr_with(&expected, encoding, |value| value)).unwrap();
            let exact = compression != Compression::PXR24;
            assert!(!exact || read == expected, "{encoding:?}");
            let read = exr_bytes(&exr_with(&expected, encoding, f16::from_f32)).unwrap();
            let half = expected.pixels.iter().flatten().map(|value| f16::from_f32(*value).to_f32());
            assert!(read.pixels.iter().flatten().copied().eq(half), "{encoding:?}");
        }
    }
    let encoding = Encoding { compression: Compression::B44, ..Encoding::UNCOMPRESSED };
    let error = exr_bytes(&exr_with(&expected, encoding, |value| value)).unwrap_err();
    assert!(error == "b44 compression is not read; write it with ZIP", "{error}");
}

fn exr_with<T: exr::prelude::IntoSample>(
    picture: &Picture,
    encoding: Encoding,
    convert: impl Fn(f32) -> T + Sync,
) -> Vec<u8> {
    let width = picture.width as usize;
    let pixel = |Vec2(x, y): Vec2<usize>| {
        let [red, green, blue] = picture.pixels[y * width + x];
        (convert(red), convert(green), convert(blue))
    };
    let channels = SpecificChannels::rgb(pixel);
    let size = (width, picture.height as usize);
    let layer = Layer::new(size, LayerAttributes::named("first"), encoding, channels);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer).write().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn the_part_with_colours_is_found() {
    let picture = noise(5, 4, 1);
    let depth = SpecificChannels::build().with_channel("Z").with_pixel_fn(|_| (1.0_f32,));
    let depth = Layer::new((5, 4), LayerAttributes::named("depth"), Encoding::SMALL_LOSSLESS, depth);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(depth).write().to_buffered(&mut bytes).unwrap();
    let error = exr_bytes(&bytes.into_inner()).unwrap_err();
    assert_eq!(error, "no channels R, G and B; found Z");

    let part = |name: &str, names: [&str; 3]| {
        let channel = |i: usize| {
            let samples = picture.pixels.iter().map(|pixel| pixel[i]).collect();
            exr::prelude::AnyChannel::new(names[i], exr::prelude::FlatSamples::F32(samples))
        };
        let channels =
            exr::prelude::AnyChannels::sort([channel(0), channel(1), channel(2)].into_iter().collect());
        Layer::new((5, 4), LayerAttributes::named(name), Encoding::UNCOMPRESSED, channels)
    };
    let layers = vec![part("normals", ["X", "Y", "Z"]), part("colours", ["R", "G", "B"])];
    let attributes = exr::prelude::ImageAttributes::with_size((5, 4));
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layers(attributes, exr::prelude::SmallVec::from_vec(layers))
        .write()
        .to_buffered(&mut bytes)
        .unwrap();
    assert!(exr_bytes(&bytes.into_inner()).unwrap() == picture);
}

#[test]
fn png_keeps_colours_within_half_a_step() {
    let picture = noise(64, 64, 5);
    let read = png_bytes(&picture.to_png_clipped().unwrap()).unwrap();
    assert_eq!((read.width(), read.height()), (64, 64));
    for (read, expected) in read.pixels().iter().flatten().zip(picture.pixels().iter().flatten()) {
        let [read, expected] = [read, expected].map(|light| linear_to_srgb(f64::from(*light)) * 255.0);
        assert!((read - expected).abs() <= 0.5 + 1e-4, "{read} {expected}");
    }
    // Every stored value is read and written as itself.
    let steps = stored(256, 1, |x, _| [x; 3]);
    let read = png_bytes(&steps.to_png_clipped().unwrap()).unwrap();
    assert!(read == steps);
}

#[test]
fn the_srgb_curve_has_its_known_values() {
    for (stored, linear) in [(0.0, 0.0), (1.0, 1.0), (0.5, 0.214_041_140), (0.735_356_983, 0.5)] {
        assert!((srgb_to_linear(stored) - linear).abs() < 1e-8);
        assert!((linear_to_srgb(linear) - stored).abs() < 1e-8);
    }
    let levels = [(0.18, 118), (0.5, 188), (0.214_041_14, 128), (0.001, 3), (0.0031308, 10), (1.0, 255)];
    for (light, expected) in levels {
        let picture = Picture::new(1, 1, vec![[light; 3]]).unwrap();
        assert_eq!(values(&picture.to_png_clipped().unwrap()), [expected; 3], "{light}");
    }
}

#[test]
fn png_is_read_in_every_form() {
    use png::{BitDepth, ColorType};
    let form = |color, depth, width, data: &[u8], palette: Option<&[u8]>| {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, width, 1);
        encoder.set_color(color);
        encoder.set_depth(depth);
        if let Some(palette) = palette {
            encoder.set_palette(palette);
            encoder.set_trns(&[0][..]);
        }
        encoder.write_header().unwrap().write_image_data(data).unwrap();
        png_bytes(&file).unwrap().pixels
    };
    let linear = |value: f64| srgb_to_linear(value) as f32;
    let third = linear(1.0 / 3.0);
    assert_eq!(form(ColorType::Grayscale, BitDepth::One, 2, &[0b0100_0000], None), [[0.0; 3], [1.0; 3]]);
    assert_eq!(form(ColorType::Grayscale, BitDepth::Two, 2, &[0b0111_0000], None), [[third; 3], [1.0; 3]]);
    assert_eq!(form(ColorType::Grayscale, BitDepth::Eight, 1, &[85], None), [[third; 3]]);
    assert_eq!(form(ColorType::GrayscaleAlpha, BitDepth::Eight, 1, &[85, 7], None), [[third; 3]]);
    assert_eq!(form(ColorType::Rgba, BitDepth::Eight, 1, &[255, 85, 0, 7], None), [[1.0, third, 0.0]]);
    let wide = [0x12, 0x34, 0x55, 0x55, 0xff, 0xff];
    let expected = [[linear(f64::from(0x1234) / 65535.0), third, 1.0]];
    assert_eq!(form(ColorType::Rgb, BitDepth::Sixteen, 1, &wide, None), expected);
    assert_eq!(form(ColorType::Grayscale, BitDepth::Sixteen, 1, &wide[2..4], None), [[third; 3]]);
    let palette = [0, 85, 255, 255, 0, 0];
    let pixels = form(ColorType::Indexed, BitDepth::One, 2, &[0b0100_0000], Some(&palette));
    assert_eq!(pixels, [[0.0, third, 1.0], [1.0, 0.0, 0.0]]);
}

#[test]
fn the_tone_mapper_keeps_base_colours_but_for_the_offset() {
    for color in [[0.08, 0.3, 0.8], [0.8; 3], [0.08; 3], [0.5, 0.2, 0.1]] {
        for (mapped, given) in tone_map(color).into_iter().zip(color) {
            assert!((mapped - (given - OFFSET)).abs() < 1e-15);
        }
    }
    assert_eq!(tone_map([0.0; 3]), [0.0; 3]);
    assert!((tone_map([0.04; 3])[0] - 0.01).abs() < 1e-15, "f = x − x²/(4 F90) below the toe");
    assert!((SHOULDER - 0.76).abs() < 1e-15);
    // By hand from the specification: p = 1.96, p_n = 1 − 0.24²/1.44 = 0.96, g = 1/1.15.
    let mapped = tone_map([2.0, 1.0, 0.5]);
    let expected = |value: f64| (value - 0.04) * 0.96 / 1.96 / 1.15 + 0.96 * (1.0 - 1.0 / 1.15);
    for (mapped, value) in mapped.into_iter().zip([2.0, 1.0, 0.5]) {
        assert!((mapped - expected(value)).abs() < 1e-14);
    }
}

#[test]
fn the_tone_mapper_is_monotone_and_below_one() {
    let mut random = Pcg64Mcg::seed_from_u64(3);
    for _ in 0..2000 {
        let color: [f64; 3] = std::array::from_fn(|_| random.random_range(0.0..1.0));
        let mut before = [0.0; 3];
        for stops in -40..160 {
            let factor = f64::from(stops as f32 / 8.0).exp2();
            let mapped = tone_map(color.map(|value| value * factor));
            let peak = mapped.into_iter().fold(0.0, f64::max);
            assert!(mapped.iter().all(|value| (0.0..1.0).contains(value)), "{color:?} {stops}: {mapped:?}");
            assert!(peak >= before.into_iter().fold(0.0, f64::max), "{color:?} {stops}");
            before = mapped;
        }
    }
    for value in [0.001, 0.079_999, 0.8, 3.0] {
        let step = 1e-9;
        let difference = tone_map([value + step; 3])[0] - tone_map([value; 3])[0];
        assert!(difference > 0.0 && difference <= step * 1.001, "continuous at {value}");
    }
}

#[test]
fn faults_show_in_a_png() {
    let pixels = vec![
        [f32::NAN, 0.0, 0.0],
        [0.5, f32::INFINITY, 0.5],
        [f32::NEG_INFINITY; 3],
        [-1.0, -0.0, -f32::MAX],
        [f32::MAX; 3],
        [f32::INFINITY, f32::NAN, 0.0],
    ];
    let picture = Picture::new(6, 1, pixels).unwrap();
    for file in [picture.to_png_clipped().unwrap(), picture.to_png(64.0).unwrap()] {
        let expected = [[255, 0, 255], [255; 3], [0; 3], [0; 3], [255; 3], [255, 0, 255]];
        assert_eq!(values(&file), expected.concat());
    }
}

#[test]
fn the_exposure_is_in_stops() {
    let png =
        |light: f32, stops| values(&Picture::new(1, 1, vec![[light; 3]]).unwrap().to_png(stops).unwrap());
    assert_eq!(png(0.1, 2.0), png(0.4, 0.0));
    let expected = (linear_to_srgb(0.36) * 255.0).round() as u8;
    assert_eq!(png(0.1, 2.0), [expected; 3]);
    for stops in [f32::NAN, f32::INFINITY, 65.0, -64.5] {
        let error = gray(1, 1).to_png(stops).unwrap_err().to_string();
        assert_eq!(error, format!("exposure is {stops}; expected stops between -64 and 64"));
    }
}

#[test]
fn false_colours_run_from_black_to_the_scale() {
    let pixels = vec![[0.0; 3], [0.5, 2.0, 1.0], [7.0; 3], [f32::NAN, 0.0, 0.0], [-1.0; 3], [1.0, 0.0, 0.0]];
    let map = Picture::new(6, 1, pixels).unwrap().false_color(2.0).unwrap();
    let brightest = [252, 253, 191];
    let middle = magma(0.5).map(|value| (value * 255.0).round() as u8);
    let expected = [[0; 3], brightest, brightest, [255, 0, 255], [0; 3], middle];
    assert_eq!(values(&map.to_png_clipped().unwrap()), expected.concat());
    // The entry 128 of the published table.
    for (value, published) in magma(128.0 / 255.0).into_iter().zip([0.716387, 0.214982, 0.475290]) {
        assert!((value - published).abs() < 0.011, "{value} {published}");
    }
    let mut before = 0.0;
    for i in 1..=100 {
        let [red, green, blue] = magma(f64::from(i) / 100.0).map(srgb_to_linear);
        let luminance = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
        assert!(luminance > before, "{i}");
        before = luminance;
    }
    for scale in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        let error = gray(1, 1).false_color(scale).unwrap_err().to_string();
        assert!(error.starts_with(&format!("scale is {scale}; expected a positive")), "{error}");
    }
}

#[test]
fn a_comparison_says_how_much_and_where() {
    let reference = Picture::new(2, 1, vec![[1.0, 0.0, 0.5], [0.25; 3]]).unwrap();
    let mut image = reference.clone();
    let same = compare(&image, &reference).unwrap();
    assert_eq!((same.mean_error, same.rms, same.relative_mse, same.flip_mean), (0.0, 0.0, 0.0, 0.0));
    assert_eq!(same.largest, Largest { error: 0.0, x: 0, y: 0, channel: 0 });

    image.pixels[0][1] = 0.5;
    image.pixels[1][2] = -0.75;
    let comparison = compare(&image, &reference).unwrap();
    let near = |value: f64, expected: f64| assert!((value - expected).abs() < 1e-15, "{value} {expected}");
    near(comparison.mean_error, -0.5 / 6.0);
    near(comparison.rms, (1.25_f64 / 6.0).sqrt());
    near(comparison.relative_mse, (0.25 / 0.01 + 1.0 / 0.0725) / 6.0);
    assert_eq!(comparison.largest, Largest { error: -1.0, x: 1, y: 0, channel: 2 });
    assert_eq!(comparison.map.pixels, [[0.0, 0.5, 0.0], [0.0, 0.0, 1.0]]);

    let mut tall = gray(3, 4);
    tall.pixels[7] = [9.0; 3];
    let largest = compare(&tall, &gray(3, 4)).unwrap().largest;
    assert_eq!((largest.x, largest.y), (1, 2));
}

#[test]
fn what_cannot_be_compared_is_refused() {
    let error = compare(&gray(4, 3), &gray(3, 4)).unwrap_err().to_string();
    assert_eq!(error, "the image has 4 × 3 pixels, the reference 3 × 4; render both at one size");
    let mut faulty = gray(4, 3);
    faulty.pixels[6][1] = f32::NAN;
    for (error, which) in [
        (compare(&faulty, &gray(4, 3)).unwrap_err().to_string(), "image"),
        (compare(&gray(4, 3), &faulty).unwrap_err().to_string(), "reference"),
    ] {
        assert!(error.starts_with(&format!("the {which} has the colour [0.2")), "{error}");
        assert!(error.contains("NaN") && error.contains("column 2, row 1"), "{error}");
    }
}

/// The values are those of NVIDIA's own implementation, `flip-evaluator` 1.7 (PyPI), which computes in single
/// precision, hence the tolerance: `evaluate(reference, test, "LDR")` on the same 8-bit values.
#[test]
fn flip_agrees_with_its_authors_implementation() {
    let ramp = |x: u32, y: u32| [(3 * x + y) % 256, (x * x + 7 * y) % 256, (5 * x + 11 * y) % 256];
    let bluer = |x: u32, y: u32| [ramp(x, y)[0], ramp(x, y)[1], (5 * x + 11 * y + 40) % 256];
    let checker = |x: u32, y: u32| if (x / 4 + y / 4) % 2 == 1 { [255; 3] } else { [40; 3] };
    let shifted = |x: u32, y: u32| checker(x + 1, y);
    let dot = |x: u32, y: u32| if (x, y) == (13, 9) { [230, 20, 20] } else { [128; 3] };
    let (green, blue) = (stored(8, 5, |_, _| [0, 255, 0]), stored(8, 5, |_, _| [0, 0, 255]));
    let wide = |color: &dyn Fn(u32, u32) -> [u32; 3]| stored(40, 30, color);
    for (reference, test, published) in [
        (wide(&ramp), wide(&bluer), 0.388_931_173),
        (wide(&checker), wide(&shifted), 0.297_224_118),
        (gray(40, 30), wide(&dot), 0.003_068_143),
        (wide(&ramp), wide(&checker), 0.814_007_536),
        (green, blue, 1.0),
        (stored(1, 1, |_, _| [0, 255, 0]), gray(1, 1), 0.980_607_271),
    ] {
        let mean = compare(&test, &reference).unwrap().flip_mean;
        assert!((mean - published).abs() < 2e-5, "{mean} {published}");
        let exchanged = compare(&reference, &test).unwrap().flip_mean;
        assert!((mean - exchanged).abs() < 1e-12, "symmetric");
    }
}

#[test]
fn flip_sees_what_a_display_shows() {
    let [bright, brighter] = [1.0, 50.0].map(|light| Picture::new(2, 2, vec![[light; 3]; 4]).unwrap());
    assert_eq!(compare(&bright, &brighter).unwrap().flip_mean, 0.0);
}

#[test]
fn unreadable_files_are_named_with_the_reason() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let complaint = |name: &str, expected: &str| {
        let path = at(name);
        let error = read(&path).unwrap_err().to_string();
        assert!(error.starts_with(&format!("cannot read {}: ", path.display())), "{error}");
        assert!(error.contains(expected), "{error}");
    };
    complaint("a.jpg", "pictures end in .png or .exr");
    complaint("a", "pictures end in .png or .exr");
    complaint("missing.png", "No such file");
    complaint("missing.exr", "No such file");
    fs::create_dir(at("folder.png")).unwrap();
    complaint("folder.png", "a folder or device");
    let (png, exr) = (gray(9, 9).to_png_clipped().unwrap(), gray(9, 9).to_exr().unwrap());
    fs::write(at("other.png"), &exr).unwrap();
    complaint("other.png", "damaged or of another kind");
    fs::write(at("other.exr"), &png).unwrap();
    complaint("other.exr", "damaged or of another kind");
    fs::write(at("empty.png"), b"").unwrap();
    complaint("empty.png", "damaged");
    fs::write(at("cut.png"), &png[..png.len() / 2]).unwrap();
    complaint("cut.png", "damaged");
    fs::write(at("cut.exr"), &exr[..exr.len() - 9]).unwrap();
    complaint("cut.exr", "damaged");
    fs::write(at("GOOD.PNG"), &png).unwrap();
    assert!(read(&at("GOOD.PNG")).unwrap() == gray(9, 9));
}

#[test]
fn files_that_claim_huge_pictures_are_refused() {
    // A header of PNG, then the checksum that belongs to it.
    let header = |width: u32, height: u32| {
        let mut chunk = b"IHDR".to_vec();
        chunk.extend(width.to_be_bytes());
        chunk.extend(height.to_be_bytes());
        chunk.extend([16, 6, 0, 0, 0]);
        let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
        file.extend(&chunk);
        file.extend(crc(&chunk).to_be_bytes());
        file.extend(b"\0\0\0\x02IDAT\x78\x01");
        file.extend(crc(b"IDAT\x78\x01").to_be_bytes());
        file
    };
    let error = png_bytes(&header(1_000_000_000, 1_000_000_000)).unwrap_err();
    assert!(error.starts_with("1000000000 × 1000000000 pixels; a picture has"), "{error}");
    let error = png_bytes(&header(16_384, 16_384)).unwrap_err();
    assert!(error.starts_with("16384 × 16384 pixels cannot come from 47 bytes"), "{error}");
    assert!(png_bytes(&header(1 << 28, 1)).is_err());

    let file = gray(3, 2).to_exr().unwrap();
    let window = file.windows(10).position(|window| window == b"dataWindow").unwrap() + 10 + 1 + 6 + 4;
    let claim = |width: i32, height: i32| {
        let mut file = file.clone();
        file[window + 8..window + 12].copy_from_slice(&(width - 1).to_le_bytes());
        file[window + 12..window + 16].copy_from_slice(&(height - 1).to_le_bytes());
        exr_bytes(&file).unwrap_err()
    };
    let error = claim(1_000_000_000, 1_000_000_000);
    assert!(error.starts_with("1000000000 × 1000000000 pixels; a picture has"), "{error}");
    let error = claim(1 << 28, 1);
    assert!(error.contains("a block of") && error.contains("smaller tiles"), "{error}");
    assert!(claim(16_384, 16_384).contains("damaged"));
}

#[test]
fn channels_of_fewer_samples_are_refused() {
    let mut file = gray(4, 2).to_exr().unwrap();
    // Name, type, four bytes, then the sampling of the first channel.
    let channel = file.windows(6).position(|window| window == b"B\0\x02\0\0\0").unwrap();
    assert_eq!(file[channel + 10], 1);
    file[channel + 10] = 2;
    let error = exr_bytes(&file).unwrap_err();
    assert_eq!(error, "a channel with fewer samples than pixels; write all channels at full size");
}

fn crc(bytes: &[u8]) -> u32 {
    let step = |crc: u32, _| if crc & 1 == 1 { (crc >> 1) ^ 0xedb8_8320 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), step))
}

/// Rounds of mutation for each file; `IMAGE_FUZZ_ROUNDS` asks for more.
fn rounds() -> u32 {
    std::env::var("IMAGE_FUZZ_ROUNDS").ok().and_then(|rounds| rounds.parse().ok()).unwrap_or(200)
}

fn mutated(file: &[u8], random: &mut Pcg64Mcg) -> Vec<u8> {
    let mut file = file.to_vec();
    for _ in 0..random.random_range(1..6) {
        // Headers come first and hold what decoders believe.
        let end = if random.random_bool(0.5) { file.len() } else { file.len().min(400) };
        let place = random.random_range(0..end);
        match random.random_range(0..5) {
            0 => file[place] = random.next_u32() as u8,
            1 => file[place] ^= 1 << random.random_range(0..8),
            2 => file[place] = [0, 1, 0x7f, 0x80, 0xff][random.random_range(0..5)],
            3 => file.truncate(place + 1),
            _ => {
                let value = [0, 1, i32::MAX, i32::MIN, -1, 1 << 20][random.random_range(0..6)].to_le_bytes();
                for (to, from) in file[place..].iter_mut().zip(value) {
                    *to = from;
                }
            }
        }
    }
    file
}

#[test]
fn no_bytes_make_a_reader_panic() {
    let mut random = Pcg64Mcg::seed_from_u64(17);
    let picture = noise(19, 23, 2);
    let mut exr_files = vec![layers(19, 23).to_exr().unwrap()];
    for compression in
        [Compression::Uncompressed, Compression::RLE, Compression::ZIP1, Compression::PIZ, Compression::PXR24]
    {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(8, 8))] {
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            exr_files.push(exr_with(&picture, encoding, f16::from_f32));
            exr_files.push(exr_with(&picture, encoding, |value| value));
        }
    }
    for _ in 0..rounds() {
        for file in &exr_files {
            let _ = exr_bytes(&mutated(file, &mut random));
        }
        let file = picture.to_png(0.0).unwrap();
        for _ in 0..10 {
            let mut file = mutated(&file, &mut random);
            mend_checksums(&mut file);
            let _ = png_bytes(&file);
        }
    }
}

/// Without it nearly every mutation of a PNG ends at a checksum.
fn mend_checksums(file: &mut [u8]) {
    let mut place = 8;
    while let Some(length) = file.get(place..place + 4) {
        let length = u32::from_be_bytes([length[0], length[1], length[2], length[3]]) as usize;
        let (start, end) = (place + 4, place.saturating_add(8).saturating_add(length));
        let Some(checksum) = file.get(start..end).map(crc) else { return };
        let Some(stored) = file.get_mut(end..end + 4) else { return };
        stored.copy_from_slice(&checksum.to_be_bytes());
        place = end + 4;
    }
}

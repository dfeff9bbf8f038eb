//! LDR-FLIP: how much of a difference people see who flip between two pictures.
//!
//! Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström and Fairchild, *FLIP: A difference evaluator for
//! alternating images*, Proc. ACM Comput. Graph. Interact. Tech. 3(2), 2020, DOI 10.1145/3406183. Symbols in
//! backquotes are those of the paper. All filters are sums of separable ones and are applied as such.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use super::Picture;

/// `p` for a display that is 0.7 m wide, has 3840 pixels and is seen from 0.7 m, as the authors assume.
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;
/// `a` and `b` of the Gaussians of the contrast sensitivity, for luminance, red–green and blue–yellow.
const SENSITIVITY: [&[(f64, f64)]; 3] = [&[(1.0, 0.0047)], &[(1.0, 0.0053)], &[(34.1, 0.04), (13.5, 0.025)]];
/// `w`, the width in degrees of the edges that people detect.
const FEATURE_WIDTH: f64 = 0.082;
/// Linear sRGB to XYZ with the white D65.
const TO_XYZ: [[f64; 3]; 3] = [
    [10_135_552.0 / 24_577_794.0, 8_788_810.0 / 24_577_794.0, 4_435_075.0 / 24_577_794.0],
    [2_613_072.0 / 12_288_897.0, 8_788_810.0 / 12_288_897.0, 887_015.0 / 12_288_897.0],
    [1_425_312.0 / 73_733_382.0, 8_788_810.0 / 73_733_382.0, 70_074_185.0 / 73_733_382.0],
];
/// Its inverse.
const FROM_XYZ: [[f64; 3]; 3] = [
    [3.241_003_275, -1.537_398_934, -0.498_615_861],
    [-0.969_224_334, 1.875_930_071, 0.041_554_224],
    [0.055_639_423, -0.204_011_202, 1.057_148_933],
];

/// The mean over all pixels, for colours clipped to \[0, 1\].
pub(super) fn mean(image: &Picture, reference: &Picture) -> f64 {
    let (image, reference) = (View::new(image), View::new(reference));
    let largest = hyab(appearance([0.0, 1.0, 0.0]), appearance([0.0, 0.0, 1.0])).powf(0.7);
    let pixels = image.appearance.len();
    let error = |i: usize| {
        let color = spread(hyab(image.appearance[i], reference.appearance[i]).powf(0.7), largest);
        let edges = (image.edges[i] - reference.edges[i]).abs();
        let points = (image.points[i] - reference.points[i]).abs();
        let feature = (FRAC_1_SQRT_2 * edges.max(points)).sqrt();
        color.powf(1.0 - feature)
    };
    (0..pixels).map(error).sum::<f64>() / pixels as f64
}

/// What an observer makes of a picture: colours, and the strength of edges and points, at each pixel.
struct View {
    appearance: Vec<[f64; 3]>,
    edges: Vec<f64>,
    points: Vec<f64>,
}

impl View {
    fn new(picture: &Picture) -> Self {
        let width = picture.width as usize;
        let opponent = picture.pixels.iter().map(|pixel| {
            let [x, y, z] = to_xyz(pixel.map(|value| f64::from(value).clamp(0.0, 1.0)));
            [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
        });
        let opponent: Vec<_> = opponent.collect();
        let channel = |i: usize| -> Vec<f64> { opponent.iter().map(|color| color[i]).collect() };
        let [luminance, red_green, blue_yellow] =
            [0, 1, 2].map(|i| sensitivity(&channel(i), width, SENSITIVITY[i]));
        let appearance = (0..opponent.len()).map(|i| {
            let y = (luminance[i] + 16.0) / 116.0;
            let xyz = [y + red_green[i] / 500.0, y, y - blue_yellow[i] / 200.0];
            let xyz: [f64; 3] = std::array::from_fn(|i| xyz[i] * white(i));
            appearance(multiply(&FROM_XYZ, xyz).map(|value| value.clamp(0.0, 1.0)))
        });
        let gray: Vec<f64> = opponent.iter().map(|color| (color[0] + 16.0) / 116.0).collect();
        let deviation = 0.5 * FEATURE_WIDTH * PIXELS_PER_DEGREE;
        let gauss = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        let radius = (3.0 * deviation).ceil() as usize;
        let smooth = kernel(radius, gauss);
        let strength = |kernel: &[f64]| -> Vec<f64> {
            let across = convolve(&gray, width, kernel, &smooth);
            let down = convolve(&gray, width, &smooth, kernel);
            across.iter().zip(&down).map(|(x, y)| x.hypot(*y)).collect()
        };
        Self {
            appearance: appearance.collect(),
            edges: strength(&kernel(radius, |x| -x * gauss(x))),
            points: strength(&kernel(radius, |x| (x * x / (deviation * deviation) - 1.0) * gauss(x))),
        }
    }
}

/// L*a*b* of a linear colour, with the chroma scaled by lightness as Hunt found.
fn appearance(color: [f64; 3]) -> [f64; 3] {
    let compress = |t: f64| {
        let delta: f64 = 6.0 / 29.0;
        if t > delta.powi(3) { t.cbrt() } else { t / (3.0 * delta * delta) + 4.0 / 29.0 }
    };
    let [x, y, z] = to_xyz(color).map(compress);
    let lightness = 116.0 * y - 16.0;
    [lightness, 0.01 * lightness * 500.0 * (x - y), 0.01 * lightness * 200.0 * (y - z)]
}

/// The distance HyAB: city blocks in lightness, Euclidean in chroma.
fn hyab(one: [f64; 3], other: [f64; 3]) -> f64 {
    (one[0] - other[0]).abs() + (one[1] - other[1]).hypot(one[2] - other[2])
}

/// Spreads errors over \[0, 1\]: those below `p_c` of the largest up to `p_t`, the others above.
fn spread(error: f64, largest: f64) -> f64 {
    let (limit, share) = (0.4 * largest, 0.95);
    if error < limit {
        share / limit * error
    } else {
        share + (error - limit) / (largest - limit) * (1.0 - share)
    }
}

/// Filters a channel with Gaussians of the contrast sensitivity, whose weights sum to 1.
fn sensitivity(channel: &[f64], width: usize, gaussians: &[(f64, f64)]) -> Vec<f64> {
    let radius = (3.0 * (0.04 / (2.0 * PI * PI)).sqrt() * PIXELS_PER_DEGREE).ceil() as usize;
    let gauss = |b: f64| move |x: f64| (-(PI * x / PIXELS_PER_DEGREE).powi(2) / b).exp();
    let sum = |b: f64| (-(radius as i64)..=radius as i64).map(|x| gauss(b)(x as f64)).sum::<f64>();
    let weights: Vec<f64> = gaussians.iter().map(|&(a, b)| a * (PI / b).sqrt() * sum(b).powi(2)).collect();
    let total: f64 = weights.iter().sum();
    let mut filtered = vec![0.0; channel.len()];
    for (&(_, b), weight) in gaussians.iter().zip(weights) {
        let kernel = kernel(radius, gauss(b));
        add(&mut filtered, &convolve(channel, width, &kernel, &kernel), weight / total);
    }
    filtered
}

/// `weight` at −radius … radius, scaled so that the positive weights sum to 1 and the negative ones to −1.
fn kernel(radius: usize, weight: impl Fn(f64) -> f64) -> Vec<f64> {
    let radius = radius as i64;
    let weights: Vec<f64> = (-radius..=radius).map(|x| weight(x as f64)).collect();
    let positive: f64 = weights.iter().filter(|weight| **weight > 0.0).sum();
    let negative: f64 = -weights.iter().filter(|weight| **weight < 0.0).sum::<f64>();
    weights.iter().map(|weight| weight / if *weight < 0.0 { negative } else { positive }).collect()
}

/// Filters rows with `across` and columns with `down`; beyond the border the nearest pixel counts.
fn convolve(plane: &[f64], width: usize, across: &[f64], down: &[f64]) -> Vec<f64> {
    let (height, radius) = (plane.len() / width, across.len() / 2);
    let mut rows = vec![0.0; plane.len()];
    for (row, source) in rows.chunks_exact_mut(width).zip(plane.chunks_exact(width)) {
        let border = |value: f64| std::iter::repeat_n(value, radius);
        let left = border(source[0]);
        let padded: Vec<f64> = left.chain(source.iter().copied()).chain(border(source[width - 1])).collect();
        for (offset, weight) in across.iter().enumerate() {
            add(row, &padded[offset..offset + width], *weight);
        }
    }
    let mut filtered = vec![0.0; plane.len()];
    for (y, row) in filtered.chunks_exact_mut(width).enumerate() {
        for (offset, weight) in down.iter().enumerate() {
            let from = (y + offset).saturating_sub(radius).min(height - 1);
            add(row, &rows[from * width..(from + 1) * width], *weight);
        }
    }
    filtered
}

fn add(to: &mut [f64], from: &[f64], weight: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += weight * from;
    }
}

fn multiply(matrix: &[[f64; 3]; 3], vector: [f64; 3]) -> [f64; 3] {
    matrix.map(|row| row[0] * vector[0] + row[1] * vector[1] + row[2] * vector[2])
}

/// X, Y or Z of white.
fn white(i: usize) -> f64 {
    TO_XYZ[i].iter().sum()
}

/// XYZ of a linear colour, each 1 for white.
fn to_xyz(color: [f64; 3]) -> [f64; 3] {
    let xyz = multiply(&TO_XYZ, color);
    std::array::from_fn(|i| xyz[i] / white(i))
}

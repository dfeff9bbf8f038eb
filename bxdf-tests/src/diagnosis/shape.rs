//! The dictionary: ratios that bugs leave behind.

use core::f64::consts::{FRAC_1_PI, PI, TAU};

use crate::specimen::{Direction, Specimen, Transport};

/// A pair of directions with the cosines that ratios are made of, all of them positive.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair {
    pub(super) wo: Direction,
    pub(super) wi: Direction,
    pub(super) is_reflection: bool,
    pub(super) cos_o: f64,
    pub(super) cos_i: f64,
    /// n·h, with h the half vector wo + η wi.
    cos_h: f64,
    wo_h: f64,
    wi_h: f64,
    /// Index of the other side over that of `wo`.
    pub(super) eta: f64,
}

fn dot(a: Direction, b: Direction) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

impl Pair {
    pub(crate) fn new(wo: Direction, wi: Direction, eta: f64) -> Self {
        let is_reflection = wo[2] * wi[2] > 0.0;
        let bending = if is_reflection { 1.0 } else { eta };
        let sum: Direction = core::array::from_fn(|i| wo[i] + bending * wi[i]);
        let length = dot(sum, sum).sqrt();
        let h = sum.map(|x| x / length);
        let [cos_o, cos_i, cos_h] = [wo[2], wi[2], h[2]].map(f64::abs);
        let [wo_h, wi_h] = [wo, wi].map(|w| dot(w, h).abs());
        Self { wo, wi, is_reflection, cos_o, cos_i, cos_h, wo_h, wi_h, eta }
    }

    /// |dωh / dωi|: 1 / (4 wo·h), of refraction Walter's (EGSR 2007, eq. 17).
    fn jacobian(&self) -> f64 {
        if self.is_reflection {
            return 0.25 / self.wo_h;
        }
        // wo·h and wi·h have opposite signs.
        let length = self.wo_h - self.eta * self.wi_h;
        self.eta * self.eta * self.wi_h / (length * length)
    }
}

/// Micro normals that explain a pdf as that of reflection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Roughness {
    is_beckmann: bool,
    /// Visible normals rather than D cos θ.
    is_visible: bool,
    pub(super) alpha: f64,
}

impl Roughness {
    fn tan2(cos: f64) -> f64 {
        (1.0 - cos * cos).max(0.0) / (cos * cos)
    }

    fn d(self, alpha: f64, pair: &Pair) -> f64 {
        let t = Self::tan2(pair.cos_h) / (alpha * alpha);
        let shape = if self.is_beckmann { libm::exp(-t) } else { 1.0 / ((1.0 + t) * (1.0 + t)) };
        FRAC_1_PI * shape / (alpha * alpha * pair.cos_h.powi(4))
    }

    /// Smith's masking 1 / (1 + Λ), of Beckmann by Walter et al. 2007.
    pub(super) fn g1(self, alpha: f64, cos: f64) -> f64 {
        let slope = alpha * Self::tan2(cos).sqrt();
        if slope == 0.0 {
            1.0
        } else if self.is_beckmann {
            let a = 1.0 / slope;
            2.0 / (1.0 + libm::erf(a) + libm::exp(-a * a) / (a * PI.sqrt()))
        } else {
            2.0 / (1.0 + (1.0 + slope * slope).sqrt())
        }
    }

    /// Density of reflected directions if the roughness were α.
    fn density(self, alpha: f64, pair: &Pair) -> f64 {
        let d = self.d(alpha, pair);
        if self.is_visible {
            0.25 * d * self.g1(alpha, pair.cos_o) / pair.cos_o
        } else {
            d * pair.cos_h * pair.jacobian()
        }
    }

    /// f with the roughness of the pdf over f with α² or √α in its place.
    pub(super) fn ratio_of_values(self, power: Power, pair: &Pair) -> f64 {
        let of = |alpha: f64| self.d(alpha, pair) * self.g1(alpha, pair.cos_o) * self.g1(alpha, pair.cos_i);
        of(self.alpha) / of(power.of(self.alpha))
    }

    /// The distribution that fits densities up to a constant; `None` where none does.
    pub(super) fn fit(points: &[(Pair, f64)]) -> Option<Self> {
        const LEAST_POINTS: usize = 64;
        /// Rms of ln density.
        const CLOSE: f64 = 0.05;
        if points.len() < LEAST_POINTS {
            return None;
        }
        let spread = |model: Self| {
            let differences =
                || points.iter().map(|(pair, pdf)| libm::log(pdf / model.density(model.alpha, pair)));
            let mean = differences().sum::<f64>() / points.len() as f64;
            (differences().map(|d| (d - mean) * (d - mean)).sum::<f64>() / points.len() as f64).sqrt()
        };
        let mut best: Option<(f64, Self)> = None;
        for (is_beckmann, is_visible) in [(false, true), (false, false), (true, true), (true, false)] {
            let at = |ln_alpha: f64| Self { is_beckmann, is_visible, alpha: libm::exp(ln_alpha) };
            let coarse = (0..80).map(|i| libm::log(1e-3) + 0.1 * f64::from(i));
            let (mut middle, mut step) =
                (coarse.min_by(|a, b| spread(at(*a)).total_cmp(&spread(at(*b))))?, 0.1);
            while step > 1e-4 {
                step *= 0.5;
                let near = [middle, middle - step, middle + step];
                middle = near.into_iter().min_by(|a, b| spread(at(*a)).total_cmp(&spread(at(*b))))?;
            }
            let here = spread(at(middle));
            if here < best.map_or(CLOSE, |(least, _)| least) {
                best = Some((here, at(middle)));
            }
        }
        best.map(|(_, model)| model)
    }
}

/// A ratio of the dictionary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    Constant,
    /// cos θi to a power.
    CosI(i32),
    /// cos θo to a power.
    CosO(i32),
    /// The Jacobian of the half vector to a power.
    Jacobian(i32),
    /// n·wo / wo·h.
    OutOverHalf,
    /// n·h / wo·h to a power.
    NormalOverHalf(i32),
    /// n·h to a power.
    CosH(i32),
    /// η² to a power, across the boundary.
    Eta(i32),
    /// Roughness α to a power in place of α.
    Alpha(Power),
    /// x and y exchanged.
    Exchanged,
    /// `wi` turned about the normal \[deg\].
    Turned(i32),
    /// `wi` mirrored at the surface.
    Flipped,
    /// `wo` and `wi` exchanged.
    Reversed,
    /// On the side of `wo`, or on the other one.
    Side(bool),
}

/// α² or √α.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Power {
    Square,
    Root,
}

impl Power {
    fn of(self, alpha: f64) -> f64 {
        match self {
            Self::Square => alpha * alpha,
            Self::Root => alpha.sqrt(),
        }
    }
}

/// Every shape, from the simplest on: where two explain the same the first is named.
pub(crate) const SHAPES: [Shape; 24] = [
    Shape::Constant,
    Shape::CosI(1),
    Shape::CosI(-1),
    Shape::CosO(1),
    Shape::CosO(-1),
    Shape::Jacobian(1),
    Shape::Jacobian(-1),
    Shape::OutOverHalf,
    Shape::NormalOverHalf(1),
    Shape::NormalOverHalf(-1),
    Shape::CosH(1),
    Shape::CosH(-1),
    Shape::Eta(1),
    Shape::Eta(-1),
    Shape::Alpha(Power::Square),
    Shape::Alpha(Power::Root),
    Shape::Exchanged,
    Shape::Turned(90),
    Shape::Turned(-90),
    Shape::Turned(180),
    Shape::Flipped,
    Shape::Reversed,
    Shape::Side(true),
    Shape::Side(false),
];

pub(super) fn exchanged([x, y, z]: Direction) -> Direction {
    [y, x, z]
}

fn turned([x, y, z]: Direction, degrees: i32) -> Direction {
    match degrees {
        90 => [-y, x, z],
        -90 => [y, -x, z],
        _ => [-x, -y, z],
    }
}

impl Shape {
    /// The ratio, where it follows from the directions alone.
    pub(super) fn ratio(self, roughness: Option<Roughness>, pair: &Pair) -> Option<f64> {
        Some(match self {
            Self::Constant => 1.0,
            Self::CosI(n) => pair.cos_i.powi(n),
            Self::CosO(n) => pair.cos_o.powi(n),
            Self::Jacobian(n) => pair.jacobian().powi(n),
            Self::OutOverHalf => pair.cos_o / pair.wo_h,
            Self::NormalOverHalf(n) => (pair.cos_h / pair.wo_h).powi(n),
            Self::CosH(n) => pair.cos_h.powi(n),
            Self::Eta(_) if pair.is_reflection => 1.0,
            Self::Eta(n) => pair.eta.powi(2 * n),
            Self::Alpha(power) => {
                let model = roughness.filter(|_| pair.is_reflection)?;
                model.density(power.of(model.alpha), pair) / model.density(model.alpha, pair)
            }
            Self::Side(same) => f64::from(u8::from(pair.is_reflection == same)),
            Self::Exchanged | Self::Turned(_) | Self::Flipped | Self::Reversed => return None,
        })
    }

    /// The density of samples that would be this times the pdf, or the pdf of other directions.
    pub(crate) fn density(
        self,
        specimen: &dyn Specimen,
        transport: Transport,
        roughness: Option<Roughness>,
        pair: &Pair,
        pdf: f64,
    ) -> f64 {
        let Pair { wo, wi, .. } = *pair;
        match self {
            Self::Exchanged => specimen.pdf(exchanged(wo), exchanged(wi), transport),
            Self::Turned(degrees) => specimen.pdf(wo, turned(wi, degrees), transport),
            Self::Flipped => specimen.pdf(wo, [wi[0], wi[1], -wi[2]], transport),
            Self::Reversed => specimen.pdf(wi, wo, transport),
            _ if pdf == 0.0 => 0.0,
            _ => self.ratio(roughness, pair).map_or(pdf, |ratio| pdf * ratio),
        }
    }

    /// The shape with its amplitude, as a formula.
    pub(super) fn formula(self, amplitude: f64, roughness: Option<Roughness>) -> String {
        let times = |formula: &str| match rounded(amplitude).as_str() {
            "1" => formula.to_owned(),
            a => format!("{a} {formula}"),
        };
        match self {
            Self::Constant => constant(amplitude),
            Self::CosI(1) => times("cos θi"),
            Self::CosI(_) => times("(1 / cos θi)"),
            Self::CosO(1) => times("cos θo"),
            Self::CosO(_) => times("(1 / cos θo)"),
            Self::Jacobian(1) => times("(1 / (4 wo·h))"),
            Self::Jacobian(_) => times("(4 wo·h)"),
            Self::OutOverHalf => times("(n·wo) / (wo·h)"),
            Self::NormalOverHalf(1) => times("(n·h) / (wo·h)"),
            Self::NormalOverHalf(_) => times("(wo·h) / (n·h)"),
            Self::CosH(1) => times("n·h"),
            Self::CosH(_) => times("(1 / n·h)"),
            Self::Eta(1) => "η² across the boundary".to_owned(),
            Self::Eta(_) => "1/η² across the boundary".to_owned(),
            Self::Alpha(power) => {
                let alpha = roughness.map_or(f64::NAN, |model| model.alpha);
                format!("D(α = {}) / D(α = {})", rounded(power.of(alpha)), rounded(alpha))
            }
            Self::Exchanged => "the lobe with x and y exchanged".to_owned(),
            Self::Turned(degrees) => format!("the lobe of wi turned by {degrees}°"),
            Self::Flipped => "the lobe mirrored at the surface".to_owned(),
            Self::Reversed => "the lobe with wo and wi exchanged".to_owned(),
            Self::Side(same) => format!(
                "{} on one side, 0 on the {}",
                rounded(amplitude),
                if same { "other" } else { "side of wo" }
            ),
        }
    }
}

/// A number in three digits.
pub(super) fn rounded(x: f64) -> String {
    let digits = (2.0 - libm::log10(x.abs()).floor()).clamp(0.0, 9.0) as usize;
    let text = format!("{x:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// A constant, with its name if it has one.
pub(super) fn constant(x: f64) -> String {
    let names = [
        (2.0, "2"),
        (PI, "π"),
        (4.0, "4"),
        (TAU, "2π"),
        (4.0 * PI, "4π"),
        (PI * PI, "π²"),
        (8.0, "8"),
        (3.0, "3"),
    ];
    let is = |y: f64| (x / y - 1.0).abs() < 0.005;
    let name = names.iter().find_map(|&(y, name)| match (is(y), is(1.0 / y)) {
        (true, _) => Some(name.to_owned()),
        (_, true) => Some(format!("1/{name}")),
        _ => None,
    });
    match name {
        Some(name) if name != rounded(x) => format!("{} ({name})", rounded(x)),
        _ => rounded(x),
    }
}

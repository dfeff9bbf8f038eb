//! Why a suite is violated: a dictionary of common bugs, each a predicted ratio, fitted to what was measured.
//!
//! For samples against the pdf the ratio is that of observed to expected counts, fitted by weighted least
//! squares to the cells of χ² at several directions together; for weights it is weight · pdf / (f cos θi),
//! point by point. A bug is named where it explains enough of the sum of squares, less what noise adds to it;
//! otherwise nothing is named. All of it rests on the three calls of a specimen and on nothing else.

mod exchange;
mod shape;

use core::fmt;

use crate::claims::Claims;
use crate::plan::Setting;
use crate::residual::{Evidence, Row};
use crate::specimen::{Measure, Transport};
use crate::suite::Examination;
use crate::survey::draw;
pub(crate) use exchange::of_exchange;
pub(crate) use shape::{Pair, Roughness, SHAPES};
use shape::{Power, Shape, constant, exchanged, rounded};

/// The share of the sum of squares that a bug must explain.
const EXPLAINED: f64 = 0.7;
/// The same where there is no noise.
const EXPLAINED_EXACTLY: f64 = 0.95;
/// Counts are compared where less noise than this hides them, in standard deviations of the sum of squares.
const LEAST_SIGNAL: f64 = 6.0;
/// A probability that is not looked at.
const SLIGHT: f64 = 1e-3;
/// Cosine below which rounding and not the bug may decide a ratio.
const LEAST_COSINE: f64 = 0.05;
/// Rms of ln ratio below which weights are as they should be, but for rounding.
const LEAST_RATIO: f64 = 1e-3;
/// Samples per setting whose ratios are fitted.
const SAMPLES: usize = 256;

/// A bug of the dictionary that explains a violation.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Diagnosis {
    /// What is wrong, the same words for the same bug.
    pub bug: String,
    /// What was compared.
    pub ratio: String,
    /// What it was found to be.
    pub model: String,
    /// The share of the sum of squared residuals that this explains.
    pub explained: f64,
}

impl fmt::Display for Diagnosis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { bug, ratio, model, explained } = self;
        write!(f, "  diagnosis: {bug}\n    {ratio} = {model} explains {:.0} %", 100.0 * explained)
    }
}

/// What two numbers were compared.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Compared {
    /// Counted samples over those that the pdf makes expect.
    Counts,
    /// The density that a sample reports over the pdf.
    Reported,
    /// weight · pdf over f cos θi.
    Weight,
}

impl Compared {
    fn ratio(self) -> &'static str {
        match self {
            Self::Counts => "observed / expected",
            Self::Reported => "reported density / pdf",
            Self::Weight => "weight · pdf / (f cos θi)",
        }
    }

    /// A factor that the first number has and the second has not (`is_missing`), or the other way round.
    fn factor(self, factor: &str, is_missing: bool) -> String {
        match (self, is_missing) {
            (Self::Counts, true) => format!("{factor} is missing in pdf()"),
            (Self::Counts, false) => format!("{factor} is once too often in pdf()"),
            (Self::Reported, true) => {
                format!(
                    "{factor} is missing in pdf(), or once too often in the density that sample() reports"
                )
            }
            (Self::Reported, false) => {
                format!(
                    "{factor} is missing in the density that sample() reports, or once too often in pdf()"
                )
            }
            (Self::Weight, true) => format!("{factor} is missing in eval(), or once too often in the weight"),
            (Self::Weight, false) => {
                format!("{factor} is missing in the weight, or once too often in eval()")
            }
        }
    }

    /// What is wrong where the ratio has a shape.
    fn bug(self, shape: Shape) -> String {
        let place = match self {
            Self::Counts => "pdf()",
            Self::Reported => "pdf() or in the density that sample() reports",
            Self::Weight => "eval() or in the weight",
        };
        match shape {
            Shape::Constant => format!("a constant factor is wrong in {place}"),
            Shape::CosI(n) => self.factor("the cosine cos θi", n > 0),
            Shape::CosO(n) => self.factor("the cosine cos θo", n > 0),
            Shape::Jacobian(n) => {
                self.factor("the Jacobian of the half vector, 1 / (4 wo·h) of reflection,", n > 0)
            }
            Shape::OutOverHalf => {
                format!("the Jacobian of the half vector is 1 / (4 wo·h), not 1 / (4 n·wo), in {place}")
            }
            Shape::NormalOverHalf(1) => {
                format!("the Jacobian of the half vector is 1 / (4 wo·h), not 1 / (4 n·h), in {place}")
            }
            Shape::NormalOverHalf(_) => format!("n·h stands where wo·h belongs, in {place}"),
            Shape::CosH(n) => self.factor("the cosine n·h of the micro normal", n > 0),
            Shape::Eta(n) => self.factor("η² of refraction", n > 0),
            Shape::Alpha(Power::Square) => format!("roughness: α in {place} where the other has α²"),
            Shape::Alpha(Power::Root) => format!("roughness: α² in {place} where the other has α"),
            Shape::Exchanged => format!("αx and αy are exchanged, or the frame is turned by 90°, in {place}"),
            Shape::Turned(degrees) => {
                format!("the azimuth of wi is turned by {}° between sample() and pdf()", degrees.abs())
            }
            Shape::Flipped => "sample() returns wi on the wrong side of the surface".to_owned(),
            Shape::Reversed => "wo and wi are exchanged between sample() and pdf()".to_owned(),
            Shape::Side(true) => "sample() never leads to the other side, where pdf() is not 0".to_owned(),
            Shape::Side(false) => "sample() never stays on the side of wo, where pdf() is not 0".to_owned(),
        }
    }
}

/// How much of the prediction is fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Amplitude {
    /// Nothing.
    One,
    /// One factor for all settings.
    Shared,
    /// A factor for each setting.
    Each,
}

/// An explanation of counts.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Candidate {
    Shaped(usize, Amplitude),
    /// Samples where the pdf is 0 on a whole side.
    Stray,
    /// Reflection and transmission, or deltas and the rest, picked with other probabilities.
    Sides,
    Deltas,
}

/// A fitted explanation.
struct Fit {
    /// Sum of squares that is left, less the noise in it.
    rest: f64,
    /// Of the first setting.
    amplitude: f64,
    parameters: usize,
}

/// Σ (observed − fixed − A · scaled)² / variance, A per group of rows.
fn least_squares(
    rows: &[&Row],
    groups: usize,
    group: impl Fn(&Row) -> usize,
    predict: impl Fn(&Row) -> [f64; 2],
) -> Fit {
    let mut sums = vec![[0.0; 2]; groups];
    for row in rows {
        let [fixed, scaled] = predict(row);
        let [above, below] = &mut sums[group(row)];
        *above += scaled * (row.observed - fixed) / variance(row);
        *below += scaled * scaled / variance(row);
    }
    let amplitudes: Vec<f64> = sums.iter().map(|&[a, b]| if b > 0.0 { a / b } else { 0.0 }).collect();
    let rest = rows
        .iter()
        .map(|row| {
            let [fixed, scaled] = predict(row);
            let left = row.observed - fixed - amplitudes[group(row)] * scaled;
            (left * left - row.observed) / variance(row)
        })
        .sum();
    let parameters = amplitudes.iter().filter(|&&a| a != 0.0).count();
    Fit { rest, amplitude: amplitudes.first().copied().unwrap_or(f64::NAN), parameters }
}

/// Between those of what was observed and what was expected: neither may be 0.
fn variance(row: &Row) -> f64 {
    (0.5 * (row.observed + row.expected)).max(1.0)
}

/// A lobe that claims to be isotropic has no axes to exchange; a density of four-fold symmetry would fit that.
fn may_explain(shape: &Shape, claims: &Claims) -> bool {
    !(claims.isotropic && *shape == Shape::Exchanged)
}

/// The bug that explains the counts of several settings, the first of them the most telling one.
pub(crate) fn of_counts(
    evidence: &[Evidence],
    roughness: Option<Roughness>,
    claims: &Claims,
) -> Option<Diagnosis> {
    let counts = Counts { evidence, rows: evidence.iter().flat_map(|evidence| &evidence.rows).collect() };
    let before = counts.shared(|row| [row.expected, 0.0]).rest;
    let noise = (2.0 * counts.rows.len() as f64).sqrt();
    if before.is_nan() || before < LEAST_SIGNAL * noise {
        return None;
    }
    let is_possible = |candidate: &Candidate| match candidate {
        Candidate::Shaped(shape, _) => may_explain(&SHAPES[*shape], claims),
        _ => true,
    };
    let fits: Vec<(Candidate, Fit)> =
        candidates().filter(is_possible).map(|candidate| (candidate, counts.fit(candidate))).collect();
    // Each number that is fitted explains some of the noise, too.
    let score = |fit: &Fit| fit.rest + 2.0 * noise * fit.parameters.saturating_sub(1) as f64;
    let scores = fits.iter().map(|(_, fit)| score(fit));
    let best = scores.filter(|score| score.is_finite()).fold(f64::INFINITY, f64::min);
    // Cubature and the fit of a roughness are right to some 1e-3 of a ratio, hence to 1e-4 of the squares.
    let enough = best.max(0.0) + 3.0 * noise + 1e-4 * before;
    let (candidate, fit) = fits.iter().find(|(_, fit)| score(fit) <= enough)?;
    let explained = 1.0 - fit.rest.max(0.0) / before;
    if explained.is_nan() || explained < EXPLAINED {
        return None;
    }
    let (bug, model) = counts.told(*candidate, fit, roughness)?;
    Some(Diagnosis { bug, ratio: Compared::Counts.ratio().to_owned(), model, explained })
}

/// The counts of several settings.
struct Counts<'a> {
    evidence: &'a [Evidence],
    rows: Vec<&'a Row>,
}

impl Counts<'_> {
    /// A fit with one amplitude for all settings.
    fn shared(&self, predict: impl Fn(&Row) -> [f64; 2]) -> Fit {
        least_squares(&self.rows, 1, |_| 0, predict)
    }

    /// A fit with an amplitude for each setting.
    fn each(&self, predict: impl Fn(&Row) -> [f64; 2]) -> Fit {
        least_squares(&self.rows, self.evidence.len(), |row| row.setting, predict)
    }

    /// Observed and expected counts of part of a setting.
    fn sum(&self, setting: usize, part: impl Fn(&Row) -> bool) -> [f64; 2] {
        let rows = self.evidence[setting].rows.iter().filter(|row| part(row));
        rows.fold([0.0; 2], |[observed, expected], row| [observed + row.observed, expected + row.expected])
    }

    /// Whether samples lie where the pdf is 0 on the whole side.
    fn is_stray(&self, row: &Row) -> bool {
        let [observed, expected] = self.sum(row.setting, |other| other.is_same_side == row.is_same_side);
        expected < 1.0 && observed > 10.0
    }

    /// A fit that moves what is expected from one part of each setting to the other.
    fn moved(&self, part: impl Fn(&Row) -> bool) -> Fit {
        let totals: Vec<[f64; 2]> = (0..self.evidence.len())
            .map(|setting| [self.sum(setting, &part)[1], self.sum(setting, |row| !part(row))[1]])
            .collect();
        self.each(|row| {
            let [inside, outside] = totals[row.setting];
            if inside < 1.0 || outside < 1.0 {
                return [row.expected, 0.0];
            }
            [row.expected, if part(row) { row.expected / inside } else { -row.expected / outside }]
        })
    }

    fn fit(&self, candidate: Candidate) -> Fit {
        // Deltas are as expected.
        let shaped = |shape: usize| {
            move |row: &Row| if row.is_delta { [row.expected, 0.0] } else { [0.0, row.shaped[shape]] }
        };
        match candidate {
            Candidate::Shaped(shape, Amplitude::One) => {
                let fit = self.shared(|row| [row.shaped[shape], 0.0]);
                Fit { amplitude: 1.0, ..fit }
            }
            Candidate::Shaped(shape, Amplitude::Shared) => self.shared(shaped(shape)),
            Candidate::Shaped(shape, Amplitude::Each) => self.each(shaped(shape)),
            Candidate::Stray => {
                self.shared(|row| [if self.is_stray(row) { row.observed } else { row.expected }, 0.0])
            }
            Candidate::Sides => self.moved(|row| row.is_same_side),
            Candidate::Deltas => self.moved(|row| row.is_delta),
        }
    }

    /// The bug and the formula in words, with numbers of the first setting.
    fn told(
        &self,
        candidate: Candidate,
        fit: &Fit,
        roughness: Option<Roughness>,
    ) -> Option<(String, String)> {
        let first = self.evidence.first()?;
        let total = self.sum(0, |_| true).map(|count| count / first.samples);
        let (integral, none) = (total[1], first.none / first.samples);
        let rate = |rate: f64| {
            let rate = rounded(rate);
            format!("the rate of a sample over the integral of pdf(), {rate} at the first direction,")
        };
        let percent = |x: f64| format!("{} %", rounded(100.0 * x));
        let picked = |name: &str, [observed, expected]: [f64; 2]| {
            let [picked, stated] = [observed / total[0], expected / total[1]];
            let [picked, stated] = [picked, stated].map(|share| percent(share / first.samples));
            let bug = format!("{name} is picked with another probability than pdf() says");
            (bug, format!("that of {picked} to {stated} at the first direction"))
        };
        Some(match candidate {
            Candidate::Shaped(0, Amplitude::Shared) if fit.amplitude.abs() < SLIGHT => (
                "no sample falls where pdf() has a density".to_owned(),
                format!("0, deltas apart; pdf and deltas integrate to {}: this", rounded(integral)),
            ),
            // Where the pdf makes one and leaves nothing, the rate of a sample and a constant factor are the
            // same.
            Candidate::Shaped(0, amplitude)
                if integral < 1.0 + SLIGHT
                    && none > 1.0 - integral + SLIGHT
                    && (amplitude == Amplitude::Each || integral > 1.0 - SLIGHT) =>
            (
                "sample() comes to nothing more often than pdf() leaves: it is normalised over what comes out"
                    .to_owned(),
                rate(fit.amplitude),
            ),
            Candidate::Shaped(0, Amplitude::Each) if none < 1.0 - integral - SLIGHT => (
                "sample() comes to nothing less often than pdf() leaves, as if it tried again".to_owned(),
                rate(fit.amplitude),
            ),
            Candidate::Shaped(0, Amplitude::Each) => (
                "a factor that depends on wo alone is wrong in pdf()".to_owned(),
                format!("a number for each wo, {} at the first,", constant(fit.amplitude)),
            ),
            Candidate::Shaped(shape, Amplitude::Each) => (
                if SHAPES[shape] == Shape::NormalOverHalf(1) {
                    "normals are drawn with the density D (n·h), pdf() is that of visible normals".to_owned()
                } else {
                    "visible normals are drawn, pdf() is that of D (n·h)".to_owned()
                },
                SHAPES[shape].formula(1.0, roughness) + ", times a number for each wo,",
            ),
            Candidate::Shaped(shape, _) => {
                (Compared::Counts.bug(SHAPES[shape]), SHAPES[shape].formula(fit.amplitude, roughness))
            }
            Candidate::Stray => {
                let [stray, _] = self.sum(0, |row| self.is_stray(row));
                let share = percent(stray / first.samples);
                let bug = "sample() returns directions on a side of the surface where pdf() is 0".to_owned();
                (bug, format!("1 and infinity on that side, where {share} of the samples lie,"))
            }
            Candidate::Sides => picked("reflection", self.sum(0, |row| row.is_same_side)),
            Candidate::Deltas => picked("a delta", self.sum(0, |row| row.is_delta)),
        })
    }
}

/// What may explain counts, from the simplest on.
fn candidates() -> impl Iterator<Item = Candidate> {
    let amplitude = |shape: &Shape| match shape {
        Shape::Eta(_)
        | Shape::Alpha(_)
        | Shape::Exchanged
        | Shape::Turned(_)
        | Shape::Flipped
        | Shape::Reversed => Amplitude::One,
        _ => Amplitude::Shared,
    };
    let shaped = SHAPES.iter().enumerate().map(move |(i, shape)| Candidate::Shaped(i, amplitude(shape)));
    let each = SHAPES
        .iter()
        .enumerate()
        .filter(|(_, shape)| matches!(shape, Shape::Constant | Shape::NormalOverHalf(_)));
    let each = each.map(|(i, _)| Candidate::Shaped(i, Amplitude::Each));
    shaped.chain([Candidate::Stray, Candidate::Sides, Candidate::Deltas]).chain(each)
}

/// What one sample says about weight and density.
struct Point {
    pair: Pair,
    transport: Transport,
    pdf: f64,
    f: [f64; 3],
    weight: [f64; 3],
    reported: f64,
}

/// Samples of the given settings, away from grazing directions.
fn points(examination: &Examination<'_>, settings: &[Setting]) -> Vec<Point> {
    let Examination { specimen, name, claims, plan, .. } = examination;
    let mut points = Vec::new();
    for setting in settings {
        let mut generator = plan.generator(name, setting, "diagnosis");
        draw(*specimen, setting, claims.precision, &mut generator, SAMPLES, |_, scatter| {
            let Some(scatter) = scatter else { return };
            let Measure::SolidAngle(reported) = scatter.density else { return };
            let (wo, wi, transport) = (setting.wo, scatter.wi, setting.transport);
            if wi[2].abs() < LEAST_COSINE || wo[2].abs() < LEAST_COSINE {
                return;
            }
            points.push(Point {
                pair: Pair::new(wo, wi, scatter.eta),
                transport,
                pdf: specimen.pdf(wo, wi, transport),
                f: specimen.eval(wo, wi, transport),
                weight: scatter.weight,
                reported,
            });
        });
    }
    points
}

/// The distribution of micro normals that explains the pdf of reflection at the given settings.
pub(crate) fn roughness(examination: &Examination<'_>, settings: &[Setting]) -> Option<Roughness> {
    let points = points(examination, settings);
    let reflected = points.iter().filter(|point| point.pair.is_reflection && point.pdf > 0.0);
    Roughness::fit(&reflected.map(|point| (point.pair, point.pdf)).collect::<Vec<_>>())
}

/// The bug that explains the ratios of weights, or of reported densities (`is_density`), to what they should
/// be.
pub(crate) fn of_weights(
    examination: &Examination<'_>,
    settings: &[Setting],
    roughness: Option<Roughness>,
    is_density: bool,
) -> Option<Diagnosis> {
    let points = points(examination, settings);
    let compared = if is_density { Compared::Reported } else { Compared::Weight };
    // ln of the measured ratio, with the point it belongs to.
    let mut measured: Vec<(&Point, usize, f64)> = Vec::new();
    for point in &points {
        for channel in 0..if is_density { 1 } else { 3 } {
            let [above, below] = if is_density {
                [point.reported, point.pdf]
            } else {
                [point.weight[channel] * point.reported, point.f[channel] * point.pair.cos_i]
            };
            if above > 0.0 && below > 0.0 {
                measured.push((point, channel, libm::log(above / below)));
            }
        }
    }
    let specimen = examination.specimen;
    let ratio = |shape: Option<Shape>, &(point, channel, _): &(&Point, usize, f64)| {
        let Point { pair, transport, f, pdf, .. } = point;
        let (wo, wi) = (pair.wo, pair.wi);
        match shape {
            // A weight that is not divided by the pdf.
            None => *pdf,
            Some(Shape::Exchanged) if is_density => {
                specimen.pdf(exchanged(wo), exchanged(wi), *transport) / pdf
            }
            Some(Shape::Exchanged) => {
                specimen.eval(exchanged(wo), exchanged(wi), *transport)[channel] / f[channel]
            }
            // In a weight the other roughness is that of f.
            Some(Shape::Alpha(power)) if !is_density => {
                let model = roughness.filter(|_| pair.is_reflection);
                model.map_or(f64::NAN, |model| model.ratio_of_values(power, pair))
            }
            Some(shape) => shape.ratio(roughness, pair).unwrap_or(f64::NAN),
        }
    };
    let before: f64 = measured.iter().map(|(_, _, y)| y * y).sum();
    if before < measured.len() as f64 * LEAST_RATIO * LEAST_RATIO {
        return None;
    }
    let is_possible =
        |shape: &Shape| !matches!(shape, Shape::Side(_)) && may_explain(shape, &examination.claims);
    let shapes = SHAPES.iter().copied().filter(is_possible);
    // What has nothing to fit comes first.
    let fits = core::iter::once(None).chain(shapes.map(Some));
    let fits = fits.map(|shape| {
        let left: Vec<f64> = measured.iter().map(|point| point.2 - libm::log(ratio(shape, point))).collect();
        let is_free = !matches!(shape, None | Some(Shape::Eta(_) | Shape::Exchanged));
        let mean = if is_free { left.iter().sum::<f64>() / left.len() as f64 } else { 0.0 };
        (shape, left.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>(), libm::exp(mean))
    });
    let fits: Vec<_> = fits.filter(|(_, rest, _)| rest.is_finite()).collect();
    let best = fits.iter().map(|&(_, rest, _)| rest).fold(f64::INFINITY, f64::min);
    let &(shape, rest, amplitude) = fits.iter().find(|&&(_, rest, _)| rest <= best + 1e-4 * before)?;
    let explained = 1.0 - rest / before;
    if explained.is_nan() || explained < EXPLAINED_EXACTLY {
        return None;
    }
    let (bug, model) = match shape {
        None => ("the weight is not divided by the pdf".to_owned(), "pdf".to_owned()),
        Some(shape @ Shape::Alpha(_)) if !is_density => {
            (compared.bug(shape), format!("1 over {}", shape.formula(amplitude, roughness)))
        }
        Some(shape) => (compared.bug(shape), shape.formula(amplitude, roughness)),
    };
    Some(Diagnosis { bug, ratio: compared.ratio().to_owned(), model, explained })
}

//! Smooth contrasts: weighted sums of the counts in a table that see a smooth error of the density with one degree
//! of freedom, where χ² spreads the same evidence over as many as it has cells.
//!
//! Rows are put in an order and their probabilities laid end to end, so that every sample has a rank u, uniform
//! on \[0, 1\]. The contrast is the sum of a score of u over the samples (Neyman, *"Smooth" test for goodness of fit*,
//! Skand. Aktuarietidskr. 20, 1937). Three orders, two scores each:
//!
//! * from high density to low, which needs no model of the lobe. For D of GGX the linear score is the derivative
//!   of ln D by ln α, for Beckmann it is the exponential score; so these are the best tests of the roughness where the
//!   level lines of the density are those of D. Deltas come first and the lack of a sample last, so they see how
//!   probable those are, too;
//! * by polar angle, and by azimuth about the mirror direction: tilted and stretched lobes.
//!
//! A contrast is a sum of the counts that χ² rests on, with exact expectation and variance from the same cubature: it
//! costs nothing while samples are drawn, and sums over parts of a run add.

use crate::statistics::ln_mean_two_sided;

/// How many contrasts there are.
pub(crate) const CONTRASTS: usize = 6;

/// What their p-values are about.
pub(crate) const WHAT: [&str; CONTRASTS] = [
    "-log10 p of the smooth contrast over the density, linear",
    "-log10 p of the smooth contrast over the density, exponential",
    "-log10 p of the smooth contrast over the polar angle, linear",
    "-log10 p of the smooth contrast over the polar angle, quadratic",
    "-log10 p of the smooth contrast over the azimuth, linear",
    "-log10 p of the smooth contrast over the azimuth, quadratic",
];

/// Where a row of a table stands in each order; `None` where it has no place.
pub(crate) type Place = [Option<f64>; 3];

/// A row with its place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Placed {
    pub(crate) place: Place,
    pub(crate) probability: f64,
    /// Bound on its error.
    pub(crate) error: f64,
    pub(crate) observed: u64,
}

/// A contrast of unit variance per sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contrast {
    /// Its mean over the samples less what is expected.
    pub(crate) difference: f64,
    /// Bound on the error of what is expected.
    pub(crate) error: f64,
    /// Its largest absolute value at a sample.
    pub(crate) range: f64,
}

impl Contrast {
    /// ln of its two-sided p-value: expected counts that are off by their error can only hide something.
    pub(crate) fn ln_p(&self, samples: f64) -> f64 {
        if self.difference.is_nan() || self.error.is_nan() {
            return f64::NAN;
        }
        ln_mean_two_sided((self.difference.abs() - self.error).max(0.0), 1.0, self.range, samples)
    }
}

/// The integral of a score from 0 to u; 0 at both ends, and of unit variance.
type Score = fn(f64) -> f64;

/// √3 (2u − 1), Legendre's first.
fn linear(u: f64) -> f64 {
    3.0_f64.sqrt() * u * (u - 1.0)
}

/// √5 (6u² − 6u + 1), Legendre's second.
fn quadratic(u: f64) -> f64 {
    5.0_f64.sqrt() * u * (u - 1.0) * (2.0 * u - 1.0)
}

/// −ln(1 − u) − 1, the score of the scale of an exponential distribution.
fn exponential(u: f64) -> f64 {
    let rest = 1.0 - u;
    if rest > 0.0 { rest * libm::log(rest) } else { 0.0 }
}

const SCORES: [[Score; 2]; 3] = [[linear, exponential], [linear, quadratic], [linear, quadratic]];

/// Probability below which a row has no score of its own: its share of a contrast would be noise.
const LEAST: f64 = 1e-9;

/// The contrasts of a table; `None` where one has nothing to compare.
pub(crate) fn contrasts(rows: &[Placed], samples: f64) -> [Option<Contrast>; CONTRASTS] {
    let mut contrasts = [None; CONTRASTS];
    for (axis, scores) in SCORES.into_iter().enumerate() {
        let mut order: Vec<(f64, usize)> =
            rows.iter().enumerate().filter_map(|(i, row)| Some((row.place[axis]?, i))).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = order.iter().map(|&(_, i)| rows[i].probability).sum();
        for (score, contrast) in scores.into_iter().zip(&mut contrasts[2 * axis..]) {
            let mut values = vec![0.0; rows.len()];
            let mut rank = 0.0;
            for &(_, i) in &order {
                let width = rows[i].probability / total;
                let next = f64::min(rank + width, 1.0);
                if width > LEAST {
                    values[i] = (score(next) - score(rank)) / width;
                }
                rank = next;
            }
            *contrast = standardised(rows, values, samples);
        }
    }
    contrasts
}

/// The contrast with the given value per row, of zero mean and unit variance.
fn standardised(rows: &[Placed], mut values: Vec<f64>, samples: f64) -> Option<Contrast> {
    let mass: f64 = rows.iter().map(|row| row.probability).sum();
    let mean = rows.iter().zip(&values).map(|(row, value)| row.probability * value).sum::<f64>() / mass;
    values.iter_mut().for_each(|value| *value -= mean);
    let sum = |of: &dyn Fn(&Placed, f64) -> f64| -> f64 {
        rows.iter().zip(&values).map(|(row, &value)| of(row, value)).sum()
    };
    let deviation = sum(&|row, value| row.probability * value * value).sqrt();
    let contrast = Contrast {
        difference: sum(&|row, value| value * (row.observed as f64 / samples - row.probability)) / deviation,
        error: sum(&|row, value| value.abs() * row.error) / deviation,
        range: values.iter().fold(0.0, |range: f64, value| range.max(value.abs())) / deviation,
    };
    // One row alone has nothing to be compared with; NaN is told.
    (deviation.is_nan() || deviation > LEAST).then_some(contrast)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A thousand rows in the same order along each axis, with the given density of the rank.
    fn table(samples: f64, density: impl Fn(f64) -> f64) -> Vec<Placed> {
        (0..1000)
            .map(|i| {
                let u = (f64::from(i) + 0.5) / 1000.0;
                let observed = (samples * 1e-3 * density(u)).round() as u64;
                Placed { place: [Some(u); 3], probability: 1e-3, error: 0.0, observed }
            })
            .collect()
    }

    #[test]
    fn a_tilt_along_a_contrast_is_measured_by_it_alone() {
        let tilt = 0.01;
        let linear = table(1e9, |u| 1.0 + tilt * 3.0_f64.sqrt() * (2.0 * u - 1.0));
        let quadratic = table(1e9, |u| 1.0 + tilt * 5.0_f64.sqrt() * (6.0 * u * u - 6.0 * u + 1.0));
        let differences = |rows: &[Placed]| contrasts(rows, 1e9).map(|contrast| contrast.unwrap().difference);
        for (rows, expected) in [
            (linear, [1.0, 0.75_f64.sqrt(), 1.0, 0.0, 1.0, 0.0]),
            (quadratic, {
                // The exponential score has the quadratic one in it by √5 / 6.
                [0.0, 5.0_f64.sqrt() / 6.0, 0.0, 1.0, 0.0, 1.0]
            }),
        ] {
            for (difference, expected) in differences(&rows).into_iter().zip(expected) {
                assert!((difference - tilt * expected).abs() < 3e-5, "{difference} {expected}");
            }
        }
    }

    #[test]
    fn the_roughness_of_both_distributions_is_a_score() {
        // Radial cdfs: GGX s/(1 + s), Beckmann 1 − exp(−s), s = tan² θ / α². α off by ε: s as if over (1 + ε)².
        let epsilon = 1e-3;
        let scaled = |s: f64| s / (1.0 + epsilon) / (1.0 + epsilon);
        let density = |u: f64, quantile: fn(f64) -> f64, cdf: fn(f64) -> f64| {
            let h = 2e-5;
            (cdf(scaled(quantile(u + h))) - cdf(scaled(quantile(u - h)))) / (2.0 * h)
        };
        let ggx = table(1e10, |u| density(u, |u| u / (1.0 - u), |s| s / (1.0 + s)));
        let beckmann = table(1e10, |u| density(u, |u| -libm::log(1.0 - u), |s| 1.0 - (-s).exp()));
        // Fisher's information on ln α: 4/3 and 4; all of it in one contrast each, but for the last of the rows.
        let [linear, _, ..] = contrasts(&ggx, 1e10).map(Option::unwrap);
        assert!((linear.difference.abs() / epsilon / (4.0_f64 / 3.0).sqrt() - 1.0).abs() < 0.01);
        let [_, exponential, ..] = contrasts(&beckmann, 1e10).map(Option::unwrap);
        assert!((exponential.difference.abs() / epsilon / 2.0 - 1.0).abs() < 0.01);
    }

    #[test]
    fn what_cannot_be_compared_is_left_out_and_what_is_not_a_number_is_told() {
        let alone = Placed { place: [Some(0.0); 3], probability: 1.0, error: 0.0, observed: 7 };
        assert!(contrasts(&[alone], 7.0).iter().all(Option::is_none));
        let broken = Placed { probability: f64::NAN, ..alone };
        assert!(contrasts(&[alone, broken], 7.0)[0].unwrap().ln_p(7.0).is_nan());
    }
}

//! Samples follow the pdf: Pearson's χ² at three resolutions, with the deltas and the no-sample cell in the
//! same table, and smooth contrasts of the finest.

use super::{Examination, PValue, Surveyed};
use crate::binning::{Point, RESOLUTIONS};
use crate::contrasts::{self, Place, Placed, contrasts};
use crate::statistics::{
    detectable_mean, detectable_noncentrality, ln_binomial_two_sided, ln_pearson_tail, ln_poisson_upper_tail,
    ln_sidak,
};
use crate::survey::{Survey, Tally};
use crate::verdict::{Check, Detectable, Ledger};

/// Expected count below which cells are pooled.
const POOLED_BELOW: f64 = 5.0;
/// Tables of fewer pools are judged cell by cell.
const FEW_POOLS: usize = 8;
/// Cells at the finest resolution below which χ² sees nothing of a continuous lobe.
const LEAST_CELLS: usize = 16;
/// Mass of a continuous lobe beside deltas from which on its pilot samples make twice that many cells.
const LEAST_MASS: f64 = 0.02;
/// Error of the expected count, squared and in units of its variance, above which cells are pooled.
const POOLED_ABOVE: f64 = 0.25;
/// The same of the no-sample cell, above which it is left out: p-values would be noticeably too large.
const BLURRED_ABOVE: f64 = 0.0025;
/// Error of an expected count that does not matter to the row that it is pooled with.
const NEGLIGIBLE: f64 = 0.25;
/// The error of the expected counts may reach this fraction of the statistic's standard deviation.
const TOLERATED: f64 = 0.25;

const WHAT: [&str; RESOLUTIONS] = [
    "-log10 p of chi-square, coarse cells",
    "-log10 p of chi-square, medium cells",
    "-log10 p of chi-square, fine cells",
];

/// What they find: a deviation of the density that their cells resolve.
const DEVIATION: [&str; RESOLUTIONS] = [
    "a deviation of the density, rms over coarse cells,",
    "a deviation of the density, rms over medium cells,",
    "a deviation of the density, rms over fine cells,",
];

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    for surveyed in examination.surveys() {
        examination.judge(surveyed, ledger, |survey, tally| p_values(examination, survey, tally));
        let unusable = |surveyed: &Surveyed| surveyed.tally.as_ref().and_then(|tally| tally.unusable);
        let second = || surveyed.second.get().and_then(|second| unusable(second));
        if let Some(scatter) = unusable(surveyed).or_else(second) {
            let what = "a sample that is not a direction with a weight";
            let witness = surveyed.setting.witness().with_wi(scatter.wi);
            ledger.record(Check::new(what, f64::NAN, 0.0, witness));
        }
    }
}

/// A row of the table: probability, bound on its error, observed count.
#[derive(Clone, Copy, Debug, Default)]
struct Row {
    probability: f64,
    error: f64,
    observed: u64,
}

impl Row {
    fn add(&mut self, other: Row) {
        self.probability += other.probability;
        self.error += other.error;
        self.observed += other.observed;
    }
}

/// χ² at each resolution, the most surprising of the cells that expect next to nothing, and the contrasts.
pub(super) fn p_values(examination: &Examination<'_>, survey: &Survey, tally: &Tally) -> Vec<PValue> {
    let mut finest: Vec<Row> = Vec::new();
    let mut samples = tally.samples as f64;
    let mut p_values: Vec<PValue> = (0..RESOLUTIONS)
        .map(|level| {
            let rows;
            (rows, samples) = table(examination, survey, tally, level);
            let is_finest = level == RESOLUTIONS - 1;
            if is_finest {
                finest.clone_from(&rows);
            }
            let pearson = pearson(rows, samples);
            let is_blind = is_finest && pearson.cells < LEAST_CELLS && survey.integral.value[0] > LEAST_MASS;
            let inconclusive = match (pearson.is_uncertain, is_blind) {
                (true, _) => Some("the expected counts are too uncertain"),
                (_, true) => Some("the lobe is narrower than the cells that its precision can tell apart"),
                _ => None,
            };
            let detectable = examination
                .detectable(DEVIATION[level], |ln_level, samples| pearson.detectable(ln_level, samples));
            let cells = is_finest.then_some(pearson.cells);
            let ln_p = pearson.ln_p;
            let samples = tally.samples;
            // A second look has a finer cubature too.
            let wants_samples = inconclusive.is_some();
            PValue { what: WHAT[level], ln_p, samples, cells, detectable, inconclusive, wants_samples }
        })
        .collect();
    let rare = || finest.iter().filter(|row| samples * row.probability < POOLED_BELOW);
    let surprise = rare()
        .map(|row| ln_poisson_upper_tail(row.observed, samples * (row.probability.max(0.0) + row.error)))
        .fold(0.0, least);
    let of = |what: &'static str, ln_p: f64, detectable: Option<Detectable<&'static str>>| PValue {
        what,
        ln_p,
        samples: tally.samples,
        cells: None,
        detectable,
        inconclusive: None,
        wants_samples: false,
    };
    let surprise = ln_sidak(surprise, rare().count().max(1));
    p_values.push(of("-log10 p of samples where the pdf is next to nothing", surprise, None));
    let contrasts = contrasts(&placed(survey, &finest), samples);
    p_values.extend(contrasts.iter().zip(contrasts::WHAT).map(|(contrast, what)| {
        let Some(contrast) = contrast else { return of(what, 0.0, None) };
        let tilt = "a smooth tilt of the density along a contrast, rms,";
        let detectable = examination.detectable(tilt, |ln_level, samples| {
            2.0 * contrast.error + detectable_mean(ln_level, 1.0, contrast.range, samples)
        });
        of(what, contrast.ln_p(samples), detectable)
    }));
    p_values
}

/// The rows of the finest table with their places: cells, deltas, and the lack of a sample if that is one of them.
fn placed(survey: &Survey, rows: &[Row]) -> Vec<Placed> {
    // From high density to low, from the upper pole to the lower, from behind the mirror direction around it.
    let cells = survey.partition.cells.iter().map(|cell| {
        let [v, azimuth] = cell.centre;
        let polar = if cell.hemisphere == 0 { v } else { 2.0 - v };
        [Some(-cell.ln_density), Some(polar), Some(azimuth)]
    });
    let deltas = survey.deltas.iter().map(|delta| {
        let Point { hemisphere, at: [v, azimuth] } = survey.partition.chart.point(delta.scatter.wi);
        let polar = if hemisphere == 0 { v } else { 2.0 - v };
        [Some(f64::NEG_INFINITY), Some(polar), Some(azimuth)]
    });
    let none: Place = [Some(f64::INFINITY), None, None];
    let places = cells.chain(deltas).chain([none]);
    let placed =
        |(&Row { probability, error, observed }, place)| Placed { place, probability, error, observed };
    rows.iter().zip(places).map(placed).collect()
}

/// The rows at one resolution, and how many samples they are about.
///
/// The no-sample cell takes what is left of 1 and so inherits the errors of all cells. Where that would blur the statistic
/// (edges and grazing angles, single precision above all) the table is conditioned on the samples that came out; suite
/// `normalised` examines the rate itself.
fn table(examination: &Examination<'_>, survey: &Survey, tally: &Tally, level: usize) -> (Vec<Row>, f64) {
    let mut rows = vec![Row::default(); survey.partition.groups[level]];
    for ((cell, &[probability, error]), &observed) in
        survey.partition.cells.iter().zip(&survey.cell_mass).zip(&tally.cells)
    {
        rows[cell.groups[level]].add(Row { probability, error, observed });
    }
    for (delta, &observed) in survey.deltas.iter().zip(&tally.deltas) {
        rows.push(Row { probability: delta.probability, error: 0.0, observed });
    }
    let [probability, error] = survey.no_sample(examination.claims.precision);
    let none = Row { probability: probability.max(0.0), error, observed: tally.none };
    let samples = tally.samples as f64;
    let is_blurred = if samples * none.probability < POOLED_BELOW {
        samples * error > NEGLIGIBLE
    } else {
        samples * error * error > BLURRED_ABOVE * none.probability
    };
    if is_blurred {
        let rest = rows.iter().map(|row| row.probability).sum::<f64>();
        for row in &mut rows {
            row.probability /= rest;
            row.error /= rest;
        }
        return (rows, samples - tally.none as f64);
    }
    rows.push(none);
    (rows, samples)
}

/// The smaller of the two; NaN, a tail that could not be computed, wins and stays.
fn least(a: f64, b: f64) -> f64 {
    if b.is_nan() || b < a { b } else { a }
}

/// Whether a row must be pooled: it expects too little, or what it expects is too uncertain.
fn is_poor(row: &Row, samples: f64) -> bool {
    samples * row.probability < POOLED_BELOW
        || samples * row.error * row.error > POOLED_ABOVE * row.probability
}

/// Pearson's statistic over pooled rows.
struct Pearson {
    ln_p: f64,
    /// Rows after pooling.
    cells: usize,
    /// The expected counts are too uncertain for a conclusion.
    is_uncertain: bool,
    /// √Σ δ²/p of the errors δ of the probabilities p.
    error: f64,
    /// The smallest probability of a row after pooling.
    least: f64,
}

impl Pearson {
    /// The rms deviation, relative and over the cells, that reaches a level with probability 0.995.
    fn detectable(&self, ln_level: f64, samples: f64) -> f64 {
        let freedom = self.cells as f64 - 1.0;
        if freedom < 1.0 {
            return f64::NAN;
        }
        2.0 * self.error
            + if self.cells < FEW_POOLS {
                // Each of the binomials may have to see its share alone.
                let range = 1.0 / (self.least * (1.0 - self.least)).sqrt();
                freedom.sqrt() * detectable_mean(ln_level - freedom.ln(), 1.0, range, samples)
            } else {
                (detectable_noncentrality(ln_level, freedom) / samples).sqrt()
            }
    }
}

fn pearson(mut rows: Vec<Row>, samples: f64) -> Pearson {
    if rows.iter().any(|row| row.probability.is_nan()) {
        return Pearson { ln_p: f64::NAN, cells: 0, is_uncertain: false, error: f64::NAN, least: f64::NAN };
    }
    // Pooled by expectation and its error, never by what was observed.
    rows.sort_by(|a, b| a.probability.total_cmp(&b.probability));
    let mut pools: Vec<Row> = vec![Row::default()];
    for row in rows {
        if let Some(last) = pools.last_mut()
            && is_poor(last, samples)
        {
            last.add(row);
        } else {
            pools.push(row);
        }
    }
    // The pool filled last may lack expectation; it joins its neighbour rather than being dropped.
    if pools.len() > 1
        && let Some(last) = pools.pop_if(|last| is_poor(last, samples))
        && let Some(neighbour) = pools.last_mut()
    {
        neighbour.add(last);
    }
    let least = pools.iter().fold(1.0, |least: f64, pool| least.min(pool.probability));
    let error = pools.iter().map(|pool| pool.error.powi(2) / pool.probability).sum::<f64>().sqrt();
    if pools.len() < FEW_POOLS {
        let ln_p = ln_few_pools(&pools, samples);
        return Pearson { ln_p, cells: pools.len(), is_uncertain: false, error, least };
    }
    let total: f64 = pools.iter().map(|pool| pool.probability).sum();
    let probabilities: Vec<f64> = pools.iter().map(|pool| pool.probability / total).collect();
    let statistic: f64 = pools
        .iter()
        .map(|pool| {
            (pool.observed as f64 - samples * pool.probability).powi(2) / (samples * pool.probability)
        })
        .sum();
    let quadrature = samples * error * error;
    // √X² is a distance; expected counts that are off by δ move it by no more than the length of δ/√E.
    let distance = statistic.sqrt() - quadrature.sqrt();
    let statistic = if distance < 0.0 { 0.0 } else { distance * distance };
    let deviation = (2.0 * (pools.len() as f64 - 1.0).max(1.0)).sqrt();
    Pearson {
        ln_p: ln_pearson_tail(statistic, &probabilities, samples),
        cells: pools.len(),
        is_uncertain: quadrature > TOLERATED * deviation,
        error,
        least,
    }
}

/// ln p of a table of few pools, for whose tail two moments are not enough: each is counted exactly among the
/// samples that those before it leave. These binomials are independent and together the multinomial.
fn ln_few_pools(pools: &[Row], samples: f64) -> f64 {
    let mut rest = Row { probability: 1.0, error: 0.0, observed: samples as u64 };
    // The last pool is what the others leave; a single one is all.
    let tests = pools.len().saturating_sub(1).max(1);
    let surprise = pools[..tests].iter().map(|pool| {
        let low = (pool.probability - pool.error) / (rest.probability + rest.error);
        let high = (pool.probability + pool.error) / (rest.probability - rest.error).max(0.0);
        let ln_p = ln_binomial_two_sided(pool.observed, rest.observed, low, high);
        rest = Row {
            probability: rest.probability - pool.probability,
            error: rest.error + pool.error,
            observed: rest.observed - pool.observed.min(rest.observed),
        };
        ln_p
    });
    ln_sidak(surprise.fold(0.0, least), tests)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(probability: f64, observed: u64) -> Row {
        Row { probability, error: 0.0, observed }
    }

    #[test]
    fn the_leftover_of_pooling_is_merged_not_dropped() {
        // 0.5 expected in the rare row, 20 observed: dropping the leftover would hide them.
        let rows = vec![row(0.5 - 2.5e-4, 480), row(0.5 - 2.5e-4, 500), row(5e-4, 20)];
        let merged = pearson(rows, 1000.0).ln_p;
        let dropped = pearson(vec![row(0.5, 490), row(0.5, 490)], 1000.0).ln_p;
        assert!(merged > dropped - 5.0);
        let all = pearson(vec![row(0.98, 940), row(0.02, 60)], 1000.0).ln_p;
        assert!(all < -25.0, "{all}");
    }

    #[test]
    fn uncertain_expectations_are_inconclusive_and_never_a_violation() {
        let table = |first: u64, error| {
            (0..10)
                .map(|i| Row { error, ..row(0.1, if i == 0 { first } else { (10_000 - first) / 9 }) })
                .collect()
        };
        assert!(pearson(table(1300, 0.0), 1e4).ln_p < -15.0);
        let Pearson { ln_p, is_uncertain, .. } = pearson(table(1100, 0.0014), 1e4);
        assert!(ln_p > -1.0 && is_uncertain, "{ln_p}");
        let Pearson { ln_p, is_uncertain, .. } = pearson(table(1300, 0.0001), 1e4);
        assert!(ln_p < -15.0 && !is_uncertain, "{ln_p}");
    }

    #[test]
    fn a_tail_that_cannot_be_computed_is_not_forgotten() {
        for p_values in [[f64::NAN, -3.0, -50.0], [-50.0, f64::NAN, -3.0], [-3.0, -50.0, f64::NAN]] {
            assert!(ln_sidak(p_values.into_iter().fold(0.0, least), 3).is_nan());
        }
        assert_eq!(ln_sidak([-3.0, -50.0].into_iter().fold(0.0, least), 1), -50.0);
        let broken = vec![Row { error: f64::NAN, ..row(0.5, 500) }, row(0.5, 500)];
        assert!(pearson(broken, 1000.0).ln_p.is_nan());
    }

    #[test]
    fn few_cells_are_counted_exactly() {
        // P(X ≥ 17), X ~ Binomial(1e5, 5e-5), is 2.0e-5; doubled for two sides.
        let few = pearson(vec![row(5e-5, 17), row(1.0 - 5e-5, 99_983)], 1e5).ln_p.exp();
        assert!((few - 3.97e-5).abs() < 5e-7, "{few:e}");
        // Where the first is as expected, the second counts among the rest: P(X ≥ 1400), X ~ Binomial(4000, 1/3).
        let rows = vec![row(0.2, 1000), row(4.0 / 15.0, 1400), row(8.0 / 15.0, 2600)];
        let alone = ln_binomial_two_sided(1400, 4000, 1.0 / 3.0, 1.0 / 3.0);
        let few = pearson(rows, 5000.0).ln_p;
        assert!((few - ln_sidak(alone, 2)).abs() < 1e-12, "{few}");
    }
}

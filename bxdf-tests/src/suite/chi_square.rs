//! Samples follow the pdf: Pearson's χ² at three resolutions, with the deltas and the no-sample cell in the
//! same table.

use super::{Examination, PValue, Surveyed};
use crate::binning::RESOLUTIONS;
use crate::statistics::{ln_binomial_two_sided, ln_pearson_tail, ln_poisson_upper_tail};
use crate::survey::{Survey, Tally};
use crate::verdict::{Check, Ledger};

/// Expected count below which cells are pooled.
const POOLED_BELOW: f64 = 5.0;
/// Tables of fewer pools are judged cell by cell.
const FEW_POOLS: usize = 8;
/// Cells at the finest resolution below which χ² sees nothing of a continuous lobe.
const LEAST_CELLS: usize = 16;
/// Error of the expected count, squared and in units of its variance, above which cells are pooled.
const POOLED_ABOVE: f64 = 0.25;
/// The error of the expected counts may reach this fraction of the statistic's standard deviation.
const TOLERATED: f64 = 0.25;

const WHAT: [&str; RESOLUTIONS] = [
    "-log10 p of chi-square, coarse cells",
    "-log10 p of chi-square, medium cells",
    "-log10 p of chi-square, fine cells",
];

pub(super) fn run(examination: &Examination<'_>, ledger: &mut Ledger) {
    for surveyed in examination.surveys() {
        examination.judge(surveyed, ledger, |survey, tally| tails(examination, survey, tally));
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

/// χ² at each resolution, and the most surprising of the cells that expect next to nothing.
fn tails(examination: &Examination<'_>, survey: &Survey, tally: &Tally) -> Vec<PValue> {
    let mut rare: Vec<Row> = Vec::new();
    let mut samples = tally.samples as f64;
    let mut tails: Vec<PValue> = (0..RESOLUTIONS)
        .map(|level| {
            let rows;
            (rows, samples) = table(examination, survey, tally, level);
            if level == RESOLUTIONS - 1 {
                rare = rows.iter().copied().filter(|row| samples * row.probability < POOLED_BELOW).collect();
            }
            let Pearson { ln_p, cells, is_uncertain } = pearson(rows, samples);
            let is_finest = level == RESOLUTIONS - 1;
            let is_blind = is_finest && cells < LEAST_CELLS && survey.integral.value[0] > 0.01;
            let inconclusive = match (is_uncertain, is_blind) {
                (true, _) => Some("the expected counts are too uncertain"),
                (_, true) => Some("the lobe is narrower than the cells that its precision can tell apart"),
                _ => None,
            };
            let cells = is_finest.then_some(cells);
            PValue { what: WHAT[level], ln_p, samples: tally.samples, cells, inconclusive }
        })
        .collect();
    let surprise = rare
        .iter()
        .map(|row| ln_poisson_upper_tail(row.observed, samples * (row.probability.max(0.0) + row.error)))
        .fold(0.0, least);
    tails.push(PValue {
        what: "-log10 p of samples where the pdf is next to nothing",
        ln_p: bonferroni(surprise, rare.len().max(1)),
        samples: 0,
        cells: None,
        inconclusive: None,
    });
    tails
}

/// The rows at one resolution, and how many samples they are about.
///
/// The no-sample cell takes what is left of 1 and so inherits the errors of all cells. Where that is too much
/// (single precision at grazing angles) the table is conditioned on the samples that came out; suite
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
    if is_poor(&none, samples) && samples * error > 1.0 {
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

/// ln of the smallest of `count` p-values, corrected for their number: at most 0, NaN stays.
fn bonferroni(ln_p: f64, count: usize) -> f64 {
    let corrected = ln_p + (count as f64).ln();
    if corrected > 0.0 { 0.0 } else { corrected }
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
}

fn pearson(mut rows: Vec<Row>, samples: f64) -> Pearson {
    if rows.iter().any(|row| row.probability.is_nan()) {
        return Pearson { ln_p: f64::NAN, cells: 0, is_uncertain: false };
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
    if pools.len() < FEW_POOLS {
        // Two moments do not describe the tail of so few cells; each is counted exactly instead.
        let surprise = pools
            .iter()
            .map(|Row { probability, error, observed }| {
                let (low, high) = (probability - error, probability + error);
                ln_binomial_two_sided(*observed, samples as u64, low, high)
            })
            .fold(0.0, least);
        let ln_p = bonferroni(surprise, pools.len());
        return Pearson { ln_p, cells: pools.len(), is_uncertain: false };
    }
    let total: f64 = pools.iter().map(|pool| pool.probability).sum();
    let probabilities: Vec<f64> = pools.iter().map(|pool| pool.probability / total).collect();
    let statistic: f64 = pools
        .iter()
        .map(|pool| {
            (pool.observed as f64 - samples * pool.probability).powi(2) / (samples * pool.probability)
        })
        .sum();
    let quadrature: f64 = pools.iter().map(|pool| samples * pool.error.powi(2) / pool.probability).sum();
    // √X² is a distance; expected counts that are off by δ move it by no more than the length of δ/√E.
    let distance = statistic.sqrt() - quadrature.sqrt();
    let statistic = if distance < 0.0 { 0.0 } else { distance * distance };
    let deviation = (2.0 * (pools.len() as f64 - 1.0).max(1.0)).sqrt();
    Pearson {
        ln_p: ln_pearson_tail(statistic, &probabilities, samples),
        cells: pools.len(),
        is_uncertain: quadrature > TOLERATED * deviation,
    }
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
            assert!(bonferroni(p_values.into_iter().fold(0.0, least), 3).is_nan());
        }
        assert_eq!(bonferroni([-3.0, -50.0].into_iter().fold(0.0, least), 1), -50.0);
        let broken = vec![Row { error: f64::NAN, ..row(0.5, 500) }, row(0.5, 500)];
        assert!(pearson(broken, 1000.0).ln_p.is_nan());
    }

    #[test]
    fn few_cells_are_counted_exactly() {
        // P(X ≥ 17), X ~ Binomial(1e5, 5e-5), is 2.0e-5; doubled for two sides and for two cells.
        let few = pearson(vec![row(5e-5, 17), row(1.0 - 5e-5, 99_983)], 1e5).ln_p.exp();
        assert!((few - 7.94e-5).abs() < 1e-6, "{few:e}");
    }
}

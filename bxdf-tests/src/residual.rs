//! Where samples and density disagree: counts over a coarse map for people, and over the cells of χ² for
//! [`crate::diagnosis`].

use core::f64::consts::{PI, TAU};
use core::fmt::{self, Write as _};

use crate::deltas::Delta;
use crate::diagnosis::{Pair, Roughness, SHAPES};
use crate::quadrature::{Effort, Integral, NODES, Region, integrate};
use crate::specimen::Direction;
use crate::suite::{Examination, Surveyed};
use crate::survey::draw;

/// Rows of a map per hemisphere, and its columns: 10° either way.
const ROWS: usize = 9;
const COLUMNS: usize = 36;
/// Samples per call of the partition.
const BATCH: usize = 1024;
/// Samples over those of the plan, as in a second look, up to a million.
const MORE: usize = 4;
const MOST: usize = 1 << 20;
/// The resolution of the partition that a diagnosis rests on: some 64 cells.
const MEDIUM: usize = 1;

/// Residuals of counted directions over polar angle and azimuth, on samples apart from those of the verdict.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Residual {
    /// Samples that were drawn.
    pub samples: u64,
    /// The share of them that came out.
    pub sampled: f64,
    /// ∫ pdf + Σ delta masses, which it should be.
    pub expected: f64,
    /// Polar angles of `wi` \[deg\] between which the rows lie, 10° each.
    pub polar_deg: [f64; 2],
    /// z = (observed − expected) / √expected per cell, with √1 where less than one sample is expected, in
    /// hundredths. Row by row from the upper pole down; the columns are azimuths of 10° each from −180° to
    /// 180°, counted from the mirror direction of `wo`.
    pub z: Vec<Vec<f64>>,
    /// The cell of the largest |z|.
    pub worst: ResidualCell,
}

/// A cell of a map.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct ResidualCell {
    /// Polar angles of `wi` \[deg\].
    pub polar_deg: [f64; 2],
    /// Azimuths of `wi` from the mirror direction \[deg\].
    pub azimuth_deg: [f64; 2],
    /// Counted samples.
    pub observed: u64,
    /// Samples that the pdf makes expect.
    pub expected: f64,
    /// (observed − expected) / √expected.
    pub z: f64,
}

/// A character of the map: each step is twice the one before.
fn symbol(z: f64) -> char {
    const STEPS: usize = 9;
    if z.abs() < 3.0 {
        return '.';
    }
    let step = (libm::log2(z.abs() / 3.0) as usize).min(STEPS - 1);
    let first = if z > 0.0 { b'1' } else { b'a' };
    char::from(first + step as u8)
}

impl fmt::Display for Residual {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { samples, sampled, expected, polar_deg, z, worst } = self;
        write!(f, "  probability sampled {sampled:.4}, pdf integrates to {expected:.4} ({samples} samples)")?;
        write!(
            f,
            "\n  residual z = (observed - expected) / sqrt(expected) over polar angle of wi and its \
             azimuth from the mirror direction"
        )?;
        write!(f, "\n  [deg] -180     -90       0        90      180")?;
        let mut low = polar_deg[0];
        for row in z {
            write!(f, "\n  {low:>3}-{:<3} ", low + 10.0)?;
            row.iter().try_for_each(|&z| f.write_char(symbol(z)))?;
            low += 10.0;
        }
        write!(
            f,
            "\n  . |z| < 3; too many samples: 1 z > 3, 2 > 6, 3 > 12, ...; too few: a z < -3, b < -6, ..."
        )?;
        let ResidualCell { polar_deg: [a, b], azimuth_deg: [c, d], observed, expected, z } = worst;
        write!(
            f,
            "\n  worst cell: polar angle {a}-{b}, azimuth {c} to {d}: {observed} for {expected:.1}, z {z:+.1}"
        )
    }
}

/// A row of the table that a diagnosis rests on.
pub(crate) struct Row {
    /// Which of the settings.
    pub(crate) setting: usize,
    pub(crate) observed: f64,
    pub(crate) expected: f64,
    /// Expected counts if the samples followed each of the shapes.
    pub(crate) shaped: [f64; SHAPES.len()],
    pub(crate) is_delta: bool,
    /// On the side of `wo`.
    pub(crate) is_same_side: bool,
}

/// What is known of one setting.
pub(crate) struct Evidence {
    pub(crate) rows: Vec<Row>,
    /// Samples, and how many came to nothing.
    pub(crate) samples: f64,
    pub(crate) none: f64,
    /// `None` where an expectation is not a number.
    pub(crate) residual: Option<Residual>,
}

/// The row and column of a point of the chart.
fn place(hemisphere: usize, [v, azimuth]: [f64; 2]) -> [usize; 2] {
    let polar = libm::acos((1.0 - v).clamp(-1.0, 1.0));
    let row = ((polar * 2.0 * ROWS as f64 / PI) as usize).min(ROWS - 1);
    let column = (((azimuth + PI) * COLUMNS as f64 / TAU) as usize).min(COLUMNS - 1);
    [if hemisphere == 0 { row } else { 2 * ROWS - 1 - row }, column]
}

/// The borders of the map that lie inside an interval, and its ends.
fn cuts([low, high]: [f64; 2], borders: &[f64]) -> Vec<f64> {
    let inside = borders.iter().copied().filter(|&at| low < at && at < high);
    [low].into_iter().chain(inside).chain([high]).collect()
}

/// Draws samples of a setting and integrates what they are compared with.
pub(crate) fn gather(
    examination: &Examination<'_>,
    Surveyed { setting, survey, .. }: &Surveyed,
    index: usize,
    roughness: Option<Roughness>,
) -> Evidence {
    let Examination { specimen, name, claims, plan, .. } = examination;
    let (wo, transport, partition) = (setting.wo, setting.transport, &survey.partition);
    let chart = &partition.chart;
    let samples = plan.samples.max((MORE * plan.samples).min(MOST));
    let mut deltas = survey.deltas.clone();
    let mut of_delta = vec![0_u64; deltas.len()];
    let mut of_cell = vec![0_u64; partition.cells.len()];
    let mut map = [[(0_u64, 0.0_f64); COLUMNS]; 2 * ROWS];
    let (mut none, mut eta) = (0_u64, 1.0);
    let mut waiting: Vec<Direction> = Vec::with_capacity(BATCH);
    let mut generator = plan.generator(name, setting, "residual");
    draw(*specimen, setting, claims.precision, &mut generator, samples, |_, scatter| {
        let Some(scatter) = scatter else {
            none += 1;
            return;
        };
        if scatter.wi[2] * wo[2] < 0.0 && scatter.eta > 0.0 {
            eta = scatter.eta;
        }
        if let Some(delta) = Delta::of(scatter) {
            if let Some(delta) = deltas.find_or_add(delta) {
                of_delta.resize(deltas.len(), 0);
                of_delta[delta] += 1;
            }
            return;
        }
        if !scatter.wi.iter().all(|x| x.is_finite()) {
            return;
        }
        let point = chart.point(scatter.wi);
        let [row, column] = place(point.hemisphere, point.at);
        map[row][column].0 += 1;
        waiting.push(scatter.wi);
        if waiting.len() == BATCH {
            partition.cells_of(&waiting).for_each(|cell| of_cell[cell] += 1);
            waiting.clear();
        }
    });
    partition.cells_of(&waiting).for_each(|cell| of_cell[cell] += 1);

    let side = usize::from(wo[2] < 0.0);
    let empty = |hemisphere: usize| Row {
        setting: index,
        observed: 0.0,
        expected: 0.0,
        shaped: [0.0; SHAPES.len()],
        is_delta: false,
        is_same_side: hemisphere == side,
    };
    let mut rows: Vec<Row> = (0..partition.groups[MEDIUM]).map(|_| empty(0)).collect();
    let polar: Vec<f64> = (1..ROWS).map(|i| 1.0 - libm::cos(0.5 * PI * i as f64 / ROWS as f64)).collect();
    let azimuths: Vec<f64> = (1..COLUMNS).map(|i| TAU * i as f64 / COLUMNS as f64 - PI).collect();
    let mut directions = vec![[0.0; 3]; NODES];
    let mut densities = vec![0.0; NODES];
    // One rule for each region: a diagnosis needs no more digits than samples have.
    let effort = Effort { absolute: f64::INFINITY, leading: 1, rectangles: 0, tries_few_nodes: true };
    for (cell, &observed) in partition.cells.iter().zip(&of_cell) {
        let row = &mut rows[cell.groups[MEDIUM]];
        row.is_same_side = cell.hemisphere == side;
        row.observed += observed as f64;
        for piece in &cell.pieces {
            let ([low, high], region) = ([piece.rectangle.low, piece.rectangle.high], piece.clone());
            let strips = region.cut(0, &cuts([low[0], high[0]], &polar));
            let regions =
                strips.into_iter().flat_map(|strip| strip.cut(1, &cuts([low[1], high[1]], &azimuths)));
            for region in regions {
                let Region { rectangle, .. } = &region;
                let middle = core::array::from_fn(|axis| 0.5 * (rectangle.low[axis] + rectangle.high[axis]));
                let [i, j] = place(cell.hemisphere, middle);
                let integral: Integral<{ 1 + SHAPES.len() }> =
                    integrate(&[region], effort, &mut |points, out| {
                        chart.directions(cell.hemisphere, points, &mut directions);
                        specimen.pdf_many(wo, &directions, transport, &mut densities);
                        for ((out, &wi), &pdf) in out.iter_mut().zip(&directions).zip(&densities) {
                            let pair = Pair::new(wo, wi, eta);
                            out[0] = pdf;
                            for (out, shape) in out[1..].iter_mut().zip(SHAPES) {
                                *out = shape.density(*specimen, transport, roughness, &pair, pdf);
                            }
                        }
                    });
                let counts = integral.value.map(|value| value * samples as f64);
                map[i][j].1 += counts[0];
                row.expected += counts[0];
                row.shaped.iter_mut().zip(&counts[1..]).for_each(|(sum, count)| *sum += count);
            }
        }
    }
    let total = rows.iter().map(|row| row.expected).sum::<f64>() / samples as f64;
    rows.extend(deltas.iter().zip(&of_delta).map(|(delta, &observed)| {
        let expected = samples as f64 * delta.probability;
        let hemisphere = usize::from(delta.scatter.wi[2] < 0.0);
        Row {
            observed: observed as f64,
            expected,
            shaped: [expected; SHAPES.len()],
            is_delta: true,
            ..empty(hemisphere)
        }
    }));
    let sampled = 1.0 - none as f64 / samples as f64;
    Evidence {
        rows,
        samples: samples as f64,
        none: none as f64,
        residual: residual(&map, samples as u64, [sampled, total + survey.delta_mass()]),
    }
}

fn residual(
    map: &[[(u64, f64); COLUMNS]; 2 * ROWS],
    samples: u64,
    [sampled, expected]: [f64; 2],
) -> Option<Residual> {
    let z = |&(observed, expected): &(u64, f64)| (observed as f64 - expected) / expected.max(1.0).sqrt();
    if !map.iter().flatten().all(|cell| z(cell).is_finite()) {
        return None;
    }
    // A hemisphere of which nobody speaks is left out.
    let is_live = |rows: &[[(u64, f64); COLUMNS]]| {
        rows.iter().flatten().any(|&(observed, expected)| observed > 0 || expected > 1.0)
    };
    let first = if is_live(&map[..ROWS]) { 0 } else { ROWS };
    let last = if is_live(&map[ROWS..]) || first == ROWS { 2 * ROWS } else { ROWS };
    let [row, column] = (first..last)
        .flat_map(|row| (0..COLUMNS).map(move |column| [row, column]))
        .max_by(|&[i, j], &[k, l]| z(&map[i][j]).abs().total_cmp(&z(&map[k][l]).abs()))?;
    let degrees = |i: usize| 10.0 * i as f64;
    let (worst, hundredths) = (map[row][column], |z: f64| (100.0 * z).round() / 100.0);
    Some(Residual {
        samples,
        sampled,
        expected,
        polar_deg: [degrees(first), degrees(last)],
        // + 0.0 turns −0 into 0.
        z: map[first..last]
            .iter()
            .map(|row| row.iter().map(|cell| hundredths(z(cell)) + 0.0).collect())
            .collect(),
        worst: ResidualCell {
            polar_deg: [degrees(row), degrees(row + 1)],
            azimuth_deg: [degrees(column) - 180.0, degrees(column + 1) - 180.0],
            observed: worst.0,
            expected: worst.1,
            z: z(&worst),
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_grow_by_powers_of_two_to_either_side() {
        let line: String =
            [2.9, 3.0, 5.9, 6.0, 13.0, 1e9, -2.0, -3.0, -6.5, -1e9].map(symbol).iter().collect();
        assert_eq!(line, ".11239.abi");
    }

    #[test]
    fn places_are_those_of_the_angles() {
        let v = |degrees: f64| 1.0 - libm::cos(degrees.to_radians());
        assert_eq!(place(0, [v(5.0), -PI]), [0, 0]);
        assert_eq!(place(0, [v(89.0), PI]), [8, 35]);
        assert_eq!(place(0, [v(41.0), 5_f64.to_radians()]), [4, 18]);
        // 41° from the lower pole is 139°.
        assert_eq!(place(1, [v(41.0), -5_f64.to_radians()]), [13, 17]);
    }
}

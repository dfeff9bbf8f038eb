//! Functions that are too costly for a lobe, tabulated when it is made.

use crate::real::Real;

/// Intervals between the points of a table.
pub(crate) const INTERVALS: usize = 64;

/// `N` functions on \[0, 1\], linear between equally spaced points.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Table<F, const N: usize> {
    points: Vec<[F; N]>,
}

impl<F: Real, const N: usize> Table<F, N> {
    /// Tabulates `values` at 65 points.
    pub(crate) fn new(values: impl FnMut(f64) -> [F; N]) -> Self {
        Self::with_intervals(INTERVALS, values)
    }

    /// Tabulates `values` at the ends of one or more intervals.
    pub(crate) fn with_intervals(intervals: usize, mut values: impl FnMut(f64) -> [F; N]) -> Self {
        let points = (0..=intervals).map(|i| values(i as f64 / intervals as f64)).collect();
        Self { points }
    }

    /// The values at `x` ∈ \[0, 1\].
    #[inline]
    pub(crate) fn at(&self, x: F) -> [F; N] {
        let intervals = self.points.len() - 1;
        let position = x.max(F::ZERO).min(F::ONE) * F::from_f64(intervals as f64);
        let low = (position.to_f64() as usize).min(intervals - 1);
        let t = position - F::from_f64(low as f64);
        let (a, b) = (&self.points[low], &self.points[low + 1]);
        core::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
    }
}

#[cfg(test)]
mod tests {
    use super::Table;

    #[test]
    fn a_table_is_exact_at_its_points_and_for_lines() {
        let table: Table<f32, 2> = Table::new(|x| [2.0 * x as f32, (x * x) as f32]);
        for i in 0..=64 {
            let x = i as f32 / 64.0;
            assert_eq!(table.at(x), [2.0 * x, x * x]);
        }
        assert_eq!(table.at(0.3)[0], 0.6);
        assert!((table.at(0.3)[1] - 0.09).abs() < 7e-5);
    }
}

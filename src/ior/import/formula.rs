//! The dispersion formulas of the database.
//!
//! As in its document "Dispersion formulas" (2014) and in its own viewer; λ in micrometres, missing
//! coefficients are zero. A term whose numerator is zero is left out: formula 4 without its second fraction
//! is otherwise 0/(λ² − 0⁰), which is 0/0 at λ = 1 µm.
//!
//! | formula | name | |
//! |---|---|---|
//! | 1 | Sellmeier | n² − 1 = C₁ + Σ Cᵢ λ² / (λ² − Cᵢ₊₁²) |
//! | 2 | Sellmeier-2 | n² − 1 = C₁ + Σ Cᵢ λ² / (λ² − Cᵢ₊₁) |
//! | 3 | polynomial | n² = C₁ + Σ Cᵢ λ^Cᵢ₊₁ |
//! | 4 | RefractiveIndex.INFO | n² = C₁ + C₂ λ^C₃ / (λ² − C₄^C₅) + C₆ λ^C₇ / (λ² − C₈^C₉) + Σ Cᵢ λ^Cᵢ₊₁ |
//! | 5 | Cauchy | n = C₁ + Σ Cᵢ λ^Cᵢ₊₁ |
//! | 6 | gases | n − 1 = C₁ + Σ Cᵢ / (Cᵢ₊₁ − λ⁻²) |
//! | 7 | Herzberger | n = C₁ + C₂ L + C₃ L² + C₄ λ² + C₅ λ⁴ + C₆ λ⁶ with L = 1 / (λ² − 0.028) |
//! | 8 | retro | (n² − 1) / (n² + 2) = C₁ + C₂ λ² / (λ² − C₃) + C₄ λ² |
//! | 9 | exotic | n² = C₁ + C₂ / (λ² − C₃) + C₄ (λ − C₅) / ((λ − C₅)² + C₆) |

use super::Problem;
use crate::message::Code;

/// Rows that a formula may be sampled with; a page that needs more has a pole in its range.
const MOST_ROWS: usize = 100_000;

/// A dispersion formula over a range of wavelengths.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Formula {
    /// Line of its coefficients.
    pub(super) line: usize,
    /// 1 to 9.
    pub(super) number: usize,
    pub(super) coefficients: Vec<f64>,
    pub(super) range_nm: [f64; 2],
}

impl Formula {
    /// Most coefficients that each formula has.
    pub(super) const MOST_COEFFICIENTS: [usize; 9] = [17, 17, 17, 17, 11, 11, 6, 4, 6];

    /// Whether the coefficient of this index, from 0, is the first of a pair that must be complete.
    pub(super) fn needs_partner(number: usize, index: usize) -> bool {
        match number {
            1..=3 | 5 | 6 => index % 2 == 1,
            4 => index >= 9 && index % 2 == 1,
            _ => false,
        }
    }

    /// Real part of the index at a wavelength.
    pub(super) fn at(&self, wavelength_nm: f64) -> Result<f64, Problem> {
        let um = wavelength_nm / 1e3;
        let (square, value) = self.value(um);
        let failed = |what: String| {
            let text = format!("formula {} gives {what} at {um} µm, within its range", self.number);
            Problem::at(
                self.line,
                Code::PageRange,
                text + "; correct the coefficients or narrow the range in a copy",
            )
        };
        if square && value < 0.0 {
            return Err(failed(format!("n² = {value}, which is negative,")));
        }
        let n = if square { libm::sqrt(value) } else { value };
        if n > 0.0 && n <= 1e3 { Ok(n) } else { Err(failed(format!("n = {n}, not in (0, 1000],"))) }
    }

    /// n², and true; or n, and false.
    fn value(&self, um: f64) -> (bool, f64) {
        let c = |i: usize| self.coefficients.get(i - 1).copied().unwrap_or(0.0);
        let power = libm::pow;
        let square = um * um;
        let term = |numerator: f64, rest: f64| if numerator == 0.0 { 0.0 } else { numerator * rest };
        // The sum over pairs of coefficients from the second on.
        let pairs = |f: &dyn Fn(f64) -> f64| -> f64 {
            (2..=self.coefficients.len()).step_by(2).map(|i| term(c(i), f(c(i + 1)))).sum()
        };
        match self.number {
            1 => (true, 1.0 + c(1) + pairs(&|b| square / (square - b * b))),
            2 => (true, 1.0 + c(1) + pairs(&|b| square / (square - b))),
            3 => (true, c(1) + pairs(&|exponent| power(um, exponent))),
            4 => {
                let fraction = |i| term(c(i), power(um, c(i + 1)) / (square - power(c(i + 2), c(i + 3))));
                let powers = (10..=16).step_by(2).map(|i| term(c(i), power(um, c(i + 1))));
                (true, c(1) + fraction(2) + fraction(6) + powers.sum::<f64>())
            }
            5 => (false, c(1) + pairs(&|exponent| power(um, exponent))),
            6 => (false, 1.0 + c(1) + pairs(&|b| 1.0 / (b - 1.0 / square))),
            7 => {
                let l = 1.0 / (square - 0.028);
                let powers = c(4) * square + c(5) * square * square + c(6) * square * square * square;
                (false, c(1) + term(c(2), l) + term(c(3), l * l) + powers)
            }
            8 => {
                let x = c(1) + term(c(2), square / (square - c(3))) + c(4) * square;
                (true, (1.0 + 2.0 * x) / (1.0 - x))
            }
            _ => {
                let shifted = um - c(5);
                let rational = term(c(4), shifted / (shifted * shifted + c(6)));
                (true, c(1) + term(c(2), 1.0 / (square - c(3))) + rational)
            }
        }
    }

    /// Rows (wavelength \[nm\], n) between which a straight line leaves n − 1 by no more than 1e-5 of itself.
    pub(super) fn rows(&self) -> Result<Vec<[f64; 2]>, Problem> {
        /// Intervals to begin with, of equal ratio: ranges reach over decades.
        const INTERVALS: u32 = 32;
        let [low, high] = self.range_nm;
        let row = |nm| Ok([nm, self.at(nm)?]);
        let mut rows = vec![row(low)?];
        let mut ends = vec![row(high)?];
        for i in (1..INTERVALS).map(f64::from) {
            ends.push(row(low * libm::pow(high / low, 1.0 - i / f64::from(INTERVALS)))?);
        }
        while let (Some(&b), Some(&a)) = (ends.last(), rows.last()) {
            let mut inner = [[0.0; 2]; 3];
            let mut straight = true;
            for (row, t) in inner.iter_mut().zip([0.25, 0.5, 0.75]) {
                let nm = a[0] + t * (b[0] - a[0]);
                *row = [nm, self.at(nm)?];
                let off = row[1] - (a[1] + t * (b[1] - a[1]));
                straight &= off.abs() <= 1e-5 * (row[1] - 1.0).abs() + 1e-9;
            }
            if straight {
                rows.extend(ends.pop());
            } else {
                ends.push(inner[1]);
            }
            if rows.len() + ends.len() > MOST_ROWS || inner[1][0] <= a[0] {
                let text = format!("formula {} has a pole near {} µm", self.number, a[0] / 1e3);
                let text =
                    text + ", within its range; correct the coefficients or narrow the range in a copy";
                return Err(Problem::at(self.line, Code::PageRange, text));
            }
        }
        Ok(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_abs_diff_eq;

    fn formula(number: usize, coefficients: &[f64], range_nm: [f64; 2]) -> Formula {
        Formula { line: 1, number, coefficients: coefficients.to_vec(), range_nm }
    }

    /// Coefficients of pages of the database, and n computed from the printed equations outside of gonio.
    #[test]
    fn val_every_formula() {
        let cases: [(usize, &[f64], f64, f64); 11] = [
            // Sapphire, ordinary ray: Malitson and Dodge 1972.
            (
                1,
                &[0.0, 1.4313493, 0.0726631, 0.65054713, 0.1193242, 5.3414021, 18.028251],
                0.5875618,
                1.768172093292356,
            ),
            // Schott N-BK7; its data sheet: 1.51680.
            (
                2,
                &[0.0, 1.03961212, 0.00600069867, 0.231792344, 0.0200179144, 1.01046945, 103.560653],
                0.5875618,
                1.5168000345005885,
            ),
            // PMMA: Beadie 2015.
            (
                3,
                &[
                    2.1778, 6.1209e-3, 2.0, -1.5004e-3, 4.0, 2.3678e-2, -2.0, -4.2137e-3, -4.0, 7.3417e-4,
                    -6.0, -4.5042e-5, -8.0,
                ],
                0.5875618,
                1.4925274362752206,
            ),
            // Rutile, ordinary ray: Devore 1951, whose table says 2.613 at the sodium D line.
            (4, &[5.913, 0.2441, 0.0, 0.0803, 1.0, 0.0, 0.0, 0.0, 1.0], 0.5893, 2.612913999089378),
            // The same without the coefficients that are zero, where λ² − 0⁰ = 0.
            (4, &[5.913, 0.2441, 0.0, 0.0803, 1.0], 1.0, 2.485641292414243),
            // Norland optical adhesive 61; its maker: 1.56.
            (5, &[1.5375, 0.00829045, -2.0, -0.000211046, -4.0], 0.5875618, 1.5597435859249962),
            // Air: Ciddor 1996.
            (6, &[0.0, 0.05792105, 238.0185, 0.00167917, 57.362], 0.5893, 1.000277147315978),
            // Argon: Bideau-Mehu 1981.
            (6, &[0.0, 2.50141e-3, 91.012, 5.00283e-4, 87.892, 5.22343e-2, 214.02], 0.5, 1.000283422366243),
            // Silicon: Edwards and Ochoa 1980; the sixth coefficient is missing.
            (7, &[3.41983, 0.159906, -0.123109, 1.26878e-6, -1.95104e-9], 10.0, 3.421524557665201),
            // Silver bromide: Schröter 1931.
            (8, &[0.452505, 0.09939, 0.070537, -0.00015], 0.589, 2.257365444285956),
            // Urea, extraordinary ray: Rosker 1985.
            (9, &[2.51527, 0.024, 0.03, 0.02, 1.52, 0.8771], 0.5893, 1.6063115648309017),
        ];
        for (number, coefficients, um, n) in cases {
            let at = formula(number, coefficients, [100.0, 20_000.0]).at(um * 1e3).unwrap();
            assert_abs_diff_eq!(at, n, epsilon = 1e-14);
        }
    }

    #[test]
    fn a_straight_line_between_rows_leaves_the_formula_by_1e_5_of_n_minus_1() {
        let air = formula(6, &[0.0, 0.05792105, 238.0185, 0.00167917, 57.362], [230.0, 1690.0]);
        let silica = [0.0, 0.6961663, 0.0684043, 0.4079426, 0.1162414, 0.8974794, 9.896161];
        for formula in [air, formula(1, &silica, [210.0, 6700.0])] {
            let rows = formula.rows().unwrap();
            assert_eq!([rows[0][0], rows[rows.len() - 1][0]], formula.range_nm);
            for pair in rows.windows(2) {
                for t in (1..20).map(|i| f64::from(i) / 20.0) {
                    let n = formula.at(pair[0][0] + t * (pair[1][0] - pair[0][0])).unwrap();
                    let line = pair[0][1] + t * (pair[1][1] - pair[0][1]);
                    assert!((n - line).abs() <= 1.05e-5 * (n - 1.0) + 1e-9, "{pair:?}: {n} {line}");
                }
            }
        }
    }
}

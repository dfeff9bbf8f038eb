//! Reducing a table to three channels: reflectance as a colour, and the complex index that imitates it.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use serde::Serialize;

use super::{IorError, Table, embedded::SPECTRA};
use crate::fresnel::conductor;
use crate::rgb::{Rgb, xyz_to_linear_srgb};

/// The light under which a reflectance is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illuminant {
    /// CIE standard illuminant D65, daylight: the white of sRGB.
    D65,
    /// Equal energy at every wavelength, adapted to the white of sRGB (Bradford).
    E,
}

/// One complex index per channel whose reflectance imitates that of the full spectrum.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FittedRgb {
    /// Real part per channel.
    pub eta: [f64; 3],
    /// Extinction per channel.
    pub k: [f64; 3],
    /// Largest difference in reflectance from the integrated curve, 0° to 88°, any channel.
    pub largest_error: f64,
}

/// Angles of the fit: 0° to 88°; at 90° every index reflects everything.
const ANGLES: usize = 45;

impl Table {
    /// Reflectance at an angle of incidence from vacuum as linear sRGB, unpolarised: R(λ) times the illuminant,
    /// integrated against the CIE 1931 2° observer over 380–780 nm in steps of 5 nm.
    ///
    /// Colours outside the gamut are not clamped: the red of gold is 1.038.
    ///
    /// # Errors
    /// If the table does not cover 380 to 780 nm.
    pub fn reflectance_rgb(&self, cos_theta: f64, illuminant: Illuminant) -> Result<Rgb<f64>, IorError> {
        let mut xyz = [0.0; 3];
        let mut white = [0.0; 3];
        for [wavelength_nm, x_bar, y_bar, z_bar, d65, e] in SPECTRA {
            let index = self.at(wavelength_nm)?;
            let reflectance = conductor(cos_theta, index.eta, index.k).reflectance.unpolarized();
            let power = match illuminant {
                Illuminant::D65 => d65,
                Illuminant::E => e,
            };
            for (i, matching) in [x_bar, y_bar, z_bar].into_iter().enumerate() {
                xyz[i] += matching * power * reflectance;
                white[i] += matching * power;
            }
        }
        let xyz = xyz.map(|value| value / white[1]);
        let white = white.map(|value| value / white[1]);
        Ok(xyz_to_linear_srgb(match illuminant {
            Illuminant::D65 => xyz,
            Illuminant::E => adapt_to_d65(xyz, white),
        }))
    }

    /// The complex index per channel whose Fresnel curve is closest to [`Self::reflectance_rgb`] under D65 over
    /// 0° to 88°, by least squares.
    ///
    /// The thesis asks for one complex value per channel (§4.2.5). Gold lies outside sRGB: its red channel saturates
    /// at η = 0, which reflects everything.
    ///
    /// # Errors
    /// If the table does not cover 380 to 780 nm.
    pub fn fitted_rgb(&self) -> Result<FittedRgb, IorError> {
        // That of an embedded table is always the same.
        static FITS: Mutex<BTreeMap<String, FittedRgb>> = Mutex::new(BTreeMap::new());
        if self.provenance.is_none() {
            return self.fit_rgb();
        }
        if let Some(fitted) = FITS.lock().unwrap_or_else(PoisonError::into_inner).get(&self.name) {
            return Ok(*fitted);
        }
        let fitted = self.fit_rgb()?;
        FITS.lock().unwrap_or_else(PoisonError::into_inner).insert(self.name.clone(), fitted);
        Ok(fitted)
    }

    fn fit_rgb(&self) -> Result<FittedRgb, IorError> {
        let angles = cosines();
        let mut curves = [[0.0; ANGLES]; 3];
        for (i, &cos_theta) in angles.iter().enumerate() {
            let rgb = self.reflectance_rgb(cos_theta, Illuminant::D65)?;
            for channel in 0..3 {
                curves[channel][i] = rgb[channel];
            }
        }
        let mut fitted = FittedRgb { eta: [0.0; 3], k: [0.0; 3], largest_error: 0.0 };
        // Where a channel saturates at η = 0, every k is as good; the table's own range keeps it sensible.
        let mut largest_k: f64 = 0.0;
        for [wavelength_nm, ..] in SPECTRA {
            largest_k = largest_k.max(self.at(wavelength_nm)?.k);
        }
        // Dominant wavelengths of the primaries, as a start.
        for (channel, wavelength_nm) in [630.0, 532.0, 465.0].into_iter().enumerate() {
            let start = self.at(wavelength_nm)?;
            let [eta, k] = fit(&curves[channel], [start.eta, start.k], largest_k);
            fitted.eta[channel] = eta;
            fitted.k[channel] = k;
            let error =
                residuals(&curves[channel], [eta, k]).into_iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            fitted.largest_error = fitted.largest_error.max(error);
        }
        Ok(fitted)
    }
}

/// Bradford adaptation from `white` to the white of sRGB, as in ICC.1:2022, annex E.
fn adapt_to_d65(xyz: [f64; 3], white: [f64; 3]) -> [f64; 3] {
    const CONES: [[f64; 3]; 3] =
        [[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]];
    const INVERSE: [[f64; 3]; 3] = [
        [0.986_992_905_466_712_3, -0.147_054_256_420_990_13, 0.159_962_651_663_731_25],
        [0.432_305_269_723_394_5, 0.518_360_271_536_777_5, 0.049_291_228_212_855_6],
        [-0.008_528_664_575_177_33, 0.040_042_821_654_084_87, 0.968_486_695_787_550_2],
    ];
    const D65: [f64; 3] = [0.3127 / 0.3290, 1.0, (1.0 - 0.3127 - 0.3290) / 0.3290];
    let apply = |matrix: &[[f64; 3]; 3], v: [f64; 3]| matrix.map(|r| r[0] * v[0] + r[1] * v[1] + r[2] * v[2]);
    let [cones, from, to] = [xyz, white, D65].map(|v| apply(&CONES, v));
    apply(&INVERSE, core::array::from_fn(|i| cones[i] * to[i] / from[i]))
}

fn cosines() -> [f64; ANGLES] {
    core::array::from_fn(|i| libm::cos((2.0 * i as f64).to_radians()))
}

fn residuals(curve: &[f64; ANGLES], [eta, k]: [f64; 2]) -> [f64; ANGLES] {
    let angles = cosines();
    core::array::from_fn(|i| conductor(angles[i], eta, k).reflectance.unpolarized() - curve[i])
}

/// Levenberg–Marquardt in two unknowns, with η ≥ 0 and 0 ≤ k ≤ `largest_k`.
fn fit(curve: &[f64; ANGLES], start: [f64; 2], largest_k: f64) -> [f64; 2] {
    let cost = |residuals: &[f64; ANGLES]| residuals.iter().map(|r| r * r).sum::<f64>();
    let (mut at, mut damping) = (start, 1e-3);
    let mut here = residuals(curve, at);
    for _ in 0..200 {
        let slopes: [[f64; ANGLES]; 2] = core::array::from_fn(|p| {
            let step = 1e-6 * at[p].max(1e-3);
            let mut moved = at;
            moved[p] += step;
            let there = residuals(curve, moved);
            core::array::from_fn(|i| (there[i] - here[i]) / step)
        });
        let dot = |a: &[f64; ANGLES], b: &[f64; ANGLES]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let (a, b, d) =
            (dot(&slopes[0], &slopes[0]), dot(&slopes[0], &slopes[1]), dot(&slopes[1], &slopes[1]));
        let gradient = [dot(&slopes[0], &here), dot(&slopes[1], &here)];
        let (a, d) = (a * (1.0 + damping), d * (1.0 + damping));
        let determinant = a * d - b * b;
        if determinant <= 0.0 {
            break;
        }
        let step = [
            (d * gradient[0] - b * gradient[1]) / determinant,
            (a * gradient[1] - b * gradient[0]) / determinant,
        ];
        let next = [(at[0] - step[0]).max(0.0), (at[1] - step[1]).clamp(0.0, largest_k)];
        let there = residuals(curve, next);
        // N = 0 reflects everything, as each η = 0 does, but is no material.
        if next != [0.0; 2] && cost(&there) < cost(&here) {
            let moved = (next[0] - at[0]).abs() + (next[1] - at[1]).abs();
            (at, here, damping) = (next, there, damping * 0.3);
            if moved < 1e-9 {
                break;
            }
        } else {
            damping *= 10.0;
            if damping > 1e12 {
                break;
            }
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::super::builtin;
    use super::*;
    use approx::assert_abs_diff_eq;

    #[test]
    fn val_colours_of_metals_under_d65() {
        for (table, expected) in [
            ("copper/Johnson-1972", [0.9317, 0.6227, 0.5223]),
            ("iron/Johnson-1974", [0.5297, 0.5132, 0.4942]),
            ("brass/Querry-1985-Cu70Zn30", [0.910, 0.778, 0.423]),
            ("gold/Johnson-1972", [1.0376, 0.7284, 0.3646]),
            ("aluminium/Rakic-1995", [0.9073, 0.9159, 0.9223]),
        ] {
            let rgb = builtin(table).unwrap().reflectance_rgb(1.0, Illuminant::D65).unwrap();
            for channel in 0..3 {
                assert_abs_diff_eq!(rgb[channel], expected[channel], epsilon = 1e-3);
            }
        }
        let gold = builtin("gold/Johnson-1972").unwrap().reflectance_rgb(1.0, Illuminant::E).unwrap();
        for (channel, expected) in [1.0444, 0.7353, 0.3637].into_iter().enumerate() {
            assert_abs_diff_eq!(gold[channel], expected, epsilon = 1e-3);
        }
    }

    #[test]
    fn a_table_of_two_rows_is_fitted_too() {
        let text = "wavelength_nm,eta,k\n300,0.2,1\n900,0.2,6\n";
        let fitted = Table::read("two", text.as_bytes()).unwrap().fitted_rgb().unwrap();
        assert!(fitted.largest_error < 1e-3, "{fitted:?}");
    }

    #[test]
    fn val_fitted_indices() {
        for (table, eta, k) in [
            ("copper/Johnson-1972", [0.221, 1.044, 1.295], [3.352, 2.624, 2.361]),
            ("aluminium/Rakic-1995", [1.496, 0.984, 0.604], [7.635, 6.546, 5.343]),
            ("chromium/Johnson-1974", [3.247, 3.114, 2.285], [3.287, 3.336, 3.117]),
            ("nickel/Johnson-1974", [2.033, 1.903, 1.728], [4.199, 3.570, 2.895]),
        ] {
            let fitted = builtin(table).unwrap().fitted_rgb().unwrap();
            for channel in 0..3 {
                assert_abs_diff_eq!(fitted.eta[channel], eta[channel], epsilon = 0.02);
                assert_abs_diff_eq!(fitted.k[channel], k[channel], epsilon = 0.02);
            }
        }
        let gold = builtin("gold/Johnson-1972").unwrap().fitted_rgb().unwrap();
        assert!(gold.eta[0] < 1e-6);
    }
}

//! Golden values of `reference-data/golden`, printed there by mpmath with 60 digits.

#![expect(clippy::panic, clippy::unwrap_used, reason = "helpers of tests")]

use core::f64::consts::PI;
use gonio::fresnel::conductor;
use gonio::ior::builtin;
use gonio::microfacet::{Distribution, Shape};
use gonio::real::{Real, Vector};
use serde::{Deserialize, de::DeserializeOwned};

/// The rows of a file of golden values.
fn golden<Row: DeserializeOwned>(file: &str) -> Vec<Row> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../reference-data/golden/");
    let rows = csv::Reader::from_path(format!("{folder}{file}"))
        .and_then(|mut reader| reader.deserialize().collect::<Result<_, _>>());
    rows.unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn smallest_normal<F: Real>() -> f64 {
    F::TANGENT.squared().to_f64()
}

#[derive(Deserialize)]
struct FresnelRow {
    material: String,
    wavelength_nm: f64,
    eta: f64,
    k: f64,
    theta_deg: f64,
    reflectance_s: f64,
    reflectance_p: f64,
    reflectance: f64,
}

#[test]
fn val_reflectance_of_metals_glass_water_and_diamond() {
    let rows: Vec<FresnelRow> = golden("fresnel.csv");
    assert!(rows.len() > 1000, "{}", rows.len());
    let mut worst = 0.0_f64;
    for row in rows {
        let found = conductor(libm::cos(row.theta_deg.to_radians()), row.eta, row.k).reflectance;
        let pairs = [
            (found.s, row.reflectance_s),
            (found.p, row.reflectance_p),
            (found.unpolarized(), row.reflectance),
        ];
        for (found, exact) in pairs {
            let error = (found - exact).abs();
            assert!(error <= 1e-9, "{} at {}°: {found}, not {exact}", row.material, row.theta_deg);
            worst = worst.max(error);
        }
    }
    println!("largest error of a reflectance: {worst:.1e}");
}

#[test]
fn val_indices_of_metals_are_those_of_the_golden_file() {
    // Interpolated in the refractiveindex.info database without gonio, rounded to 6 decimals in η and 5 in k.
    let rows: Vec<FresnelRow> = golden("fresnel.csv");
    for (material, source) in [
        ("copper", "Johnson-1972"),
        ("aluminium", "Rakic-1995"),
        ("iron", "Johnson-1974"),
        ("gold", "Johnson-1972"),
        ("silver", "Johnson-1972"),
    ] {
        let table = builtin(&format!("{material}/{source}")).unwrap();
        let of_material: Vec<_> = rows.iter().filter(|row| row.material == material).collect();
        assert!(!of_material.is_empty(), "{material}");
        for row in of_material {
            let index = table.at(row.wavelength_nm).unwrap();
            let errors = [index.eta - row.eta, index.k - row.k].map(f64::abs);
            let is_rounding = errors[0] <= 0.500_01e-6 && errors[1] <= 0.500_01e-5;
            assert!(is_rounding, "{} at {} nm: {index:?}", table.name(), row.wavelength_nm);
        }
    }
}

#[derive(Deserialize)]
struct SpecialRow {
    function: String,
    x: f64,
    value: f64,
}

/// Largest relative error of a function in units of ε, over the rows whose argument `F` represents; it must not
/// exceed `limit`. Subnormal values have no ε digits: there the error is limited in units of the smallest number.
#[track_caller]
fn check_special<F: Real>(function: &str, call: fn(F) -> F, limit: f64) {
    let epsilon = F::EPSILON.to_f64();
    let (mut rows, mut worst, mut at) = (0, 0.0, f64::NAN);
    for row in golden::<SpecialRow>("special.csv").into_iter().filter(|row| row.function == function) {
        let x = F::from_f64(row.x);
        if x.to_f64() != row.x {
            continue;
        }
        let found = call(x).to_f64();
        let ulps = (found - row.value).abs() / (epsilon * row.value.abs().max(smallest_normal::<F>()));
        assert!(ulps <= limit, "{function}({:?}) = {found:e}, not {:e}: {ulps:.2} ε", row.x, row.value);
        rows += 1;
        if ulps > worst {
            (worst, at) = (ulps, row.x);
        }
    }
    println!("{} {function}: {worst:.2} ε at {at:?} ({rows} rows)", F::NAME);
    assert!(rows > 80, "{function}: {rows} rows");
}

#[test]
fn val_special_functions_f64() {
    // Measured: 0.89, 1.00, 0.98.
    check_special::<f64>("erf", Real::erf, 0.95);
    check_special::<f64>("erfc", Real::erfc, 1.05);
    check_special::<f64>("erf_inv", Real::erf_inv, 1.05);
}

#[test]
fn val_special_functions_f32() {
    // Measured: 0.45, 1.12, 0.49.
    check_special::<f32>("erf", Real::erf, 0.5);
    check_special::<f32>("erfc", Real::erfc, 1.2);
    check_special::<f32>("erf_inv", Real::erf_inv, 0.52);
}

#[derive(Deserialize)]
struct DistributionRow {
    distribution: String,
    alpha_x: f64,
    alpha_y: f64,
    x: f64,
    y: f64,
    z: f64,
    d: f64,
    projected_area: f64,
}

/// Relative error that the four operations leave in a formula without cancellation, in units of ε; in `f32` the
/// rounding of direction and roughness is part of it.
const ROUNDING: f64 = 5.0;

/// Values below this are written as 0.
const WRITTEN_AS_ZERO: f64 = 1e-300;

impl DistributionRow {
    fn shape(&self) -> Shape {
        match &*self.distribution {
            "ggx" => Shape::Ggx,
            "beckmann" => Shape::Beckmann,
            other => panic!("no distribution is named {other}"),
        }
    }

    /// What is allowed between D and its golden value.
    ///
    /// Beckmann's D is the exponential of −tan²/α²: the relative error of the exponent, 4 ε, becomes an absolute
    /// one; where the exponential is subnormal its quotient by π αx αy z⁴ inherits the lost digits.
    fn tolerance_d<F: Real>(&self) -> f64 {
        let (exponent, underflow) = match self.shape() {
            Shape::Ggx => (0.0, 0.0),
            Shape::Beckmann | Shape::Gaussian => {
                let z2 = self.z * self.z;
                let exponent = ((self.x / self.alpha_x).powi(2) + (self.y / self.alpha_y).powi(2)) / z2;
                (exponent, smallest_normal::<F>() / (PI * self.alpha_x * self.alpha_y * z2 * z2))
            }
        };
        (ROUNDING + 4.0 * exponent) * F::EPSILON.to_f64() * self.d + underflow + WRITTEN_AS_ZERO
    }

    /// What is allowed between σ and its golden value.
    ///
    /// Below the horizon Beckmann's σ is a difference of two terms ∝ e^(−a²), a = cos θ / s, and for large a only
    /// 1/(2a²) of either: errors grow as a² (1 + a²).
    fn tolerance_area<F: Real>(&self) -> f64 {
        let s2 = (self.alpha_x * self.x).powi(2) + (self.alpha_y * self.y).powi(2);
        let a2 = match self.shape() {
            Shape::Beckmann if self.z < 0.0 => self.z * self.z / s2,
            _ => 0.0,
        };
        (ROUNDING + a2 * (1.0 + a2)) * F::EPSILON.to_f64() * self.projected_area
            + smallest_normal::<F>()
            + WRITTEN_AS_ZERO
    }
}

fn check_distributions<F: Real>() {
    let epsilon = F::EPSILON.to_f64();
    let rows: Vec<DistributionRow> = golden("distribution.csv");
    assert!(rows.len() >= 350, "{}", rows.len());
    let mut worst = [0.0_f64; 2];
    for row in rows {
        let [alpha_x, alpha_y] = [row.alpha_x, row.alpha_y].map(F::from_f64);
        let distribution = Distribution::new(row.shape(), alpha_x, alpha_y).unwrap();
        let w = F::Vec3::from_f64([row.x, row.y, row.z]);
        let d = (distribution.d(w).to_f64(), row.d, row.tolerance_d::<F>());
        let area = (distribution.projected_area(w).to_f64(), row.projected_area, row.tolerance_area::<F>());
        for (i, (found, exact, tolerance)) in [d, area].into_iter().enumerate() {
            let error = (found - exact).abs();
            assert!(
                error <= tolerance,
                "{} {} {alpha_x} {alpha_y} at {w:?}: {found:e}, not {exact:e}, tolerance {tolerance:e}",
                ["D", "area"][i],
                row.distribution,
            );
            if tolerance < 20.0 * epsilon * exact {
                worst[i] = worst[i].max(error / exact / epsilon);
            }
        }
        assert!(row.z > 0.0 || d.0 == 0.0, "normals of a height field do not point down");
    }
    println!("{}: D {:.1} ε, projected area {:.1} ε outside the tails", F::NAME, worst[0], worst[1]);
}

#[test]
fn val_microfacet_distributions_f64() {
    check_distributions::<f64>();
}

#[test]
fn val_microfacet_distributions_f32() {
    check_distributions::<f32>();
}

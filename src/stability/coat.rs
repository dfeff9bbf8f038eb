//! Layers: what several crossings of a boundary leave.

use std::sync::Arc;

use bxdf_tests::Precision;

use super::big::{Big, big, exact, square};
use super::fresnel::{Dielectric, dielectric_boundary};
use super::geometry::tangent;
use super::{Axis, Form, Region, Term};
use crate::bxdf::{Bxdf as _, TransportMode};
use crate::fresnel::{Fresnel, dielectric};
use crate::lobe::{Coat, RefractiveLayer, SpecularReflection, ThinSheet};
use crate::real::{Real, Vector};
use crate::rgb::Rgb;

pub(super) fn terms() -> Vec<Term> {
    let sheets = "cos θ off the tangent plane, η in [1, 4], τ in [0, 1000]";
    vec![
        Term {
            name: "coat/series_over_mirror",
            statement: "albedo of a mirror under a coat, all internal reflections",
            inputs: &["cos θ", "τ", "η", "R"],
            variables: 2,
            range: "cos θ off the tangent plane, η in [1, 4], τ in [0, 1000], R in [0, 1]",
            exact: |x| {
                let Dielectric { reflectance, transmittance, cos_theta_t } = inside(x)?;
                let (there_and_back, lost) = crossing(2.0 * x[1], &cos_theta_t);
                let base = big(x[3]);
                let rest = &transmittance + reflectance * ((big(1.0) - &base) + &base * lost);
                Some(exact(&(square(&transmittance) * base * there_and_back / rest)))
            },
            regions: |precision| {
                vec![Region {
                    name: "grazing to normal",
                    axes: vec![
                        Axis::logarithmic("cos θ", tangent(precision), 1.0),
                        Axis::among("τ", depths()),
                        Axis::among("R", [0.0, 0.5, 0.999, 1.0]),
                        Axis::linear("η", 1.0, 4.0),
                    ],
                    inputs: |x| vec![x[0], x[1], x[3], x[2]],
                }]
            },
            forms: forms![
                stable "1 − F R a² = T + F (1 − R a²)" series_in_use,
                control "1 − F R a² subtracted" series_by_difference,
            ],
        },
        Term {
            name: "coat/thin_sheet_transmittance",
            statement: "T of a sheet with both its faces",
            inputs: &["cos θ", "τ", "η"],
            variables: 2,
            range: sheets,
            exact: |x| {
                let Dielectric { reflectance, transmittance, cos_theta_t } = inside(x)?;
                Some(exact(&through_sheet(&reflectance, &transmittance, x[1], &cos_theta_t)[0]))
            },
            regions: sheet_regions,
            forms: forms![
                stable "1 − R a = T + R (1 − a)" sheet_in_use,
                control "1 − R² a² subtracted" sheet_by_difference,
            ],
        },
        Term {
            name: "coat/thin_sheet_reflectance",
            statement: "R of a sheet with both its faces",
            inputs: &["cos θ", "τ", "η"],
            variables: 2,
            range: sheets,
            exact: |x| {
                let Dielectric { reflectance, transmittance, cos_theta_t } = inside(x)?;
                let [transmitted, a] = through_sheet(&reflectance, &transmittance, x[1], &cos_theta_t);
                Some(exact(&(&reflectance + &reflectance * a * transmitted)))
            },
            regions: sheet_regions,
            forms: forms![stable "R + R a Ts" sheet_reflectance_in_use,],
        },
    ]
}

/// Optical depths.
fn depths() -> [f64; 8] {
    [0.0, 1e-30, 1e-9, 1e-3, 0.1, 1.0, 30.0, 1e3]
}

fn sheet_regions(precision: Precision) -> Vec<Region> {
    vec![Region {
        name: "grazing to normal",
        axes: vec![
            Axis::logarithmic("cos θ", tangent(precision), 1.0),
            Axis::among("τ", depths()),
            Axis::linear("η", 1.0, 4.0),
        ],
        inputs: |x| x.to_vec(),
    }]
}

/// The boundary; `None` outside the domain.
fn inside(x: &[f64]) -> Option<Dielectric> {
    (x[0] > 0.0 && x[2] >= 1.0).then(|| dielectric_boundary(x[0], x[2])).flatten()
}

/// a = e^{−τ / cos θ}, and 1 − a.
fn crossing(tau: f64, cos_theta: &Big) -> (Big, Big) {
    let exponent = big(tau) / cos_theta;
    if exponent > big(1e6) { (big(0.0), big(1.0)) } else { ((-&exponent).exp(), -(-exponent).exp_m1()) }
}

/// T² a / (1 − R² a²), and a.
fn through_sheet(reflectance: &Big, transmittance: &Big, tau: f64, cos_theta_t: &Big) -> [Big; 2] {
    let (a, lost) = crossing(tau, cos_theta_t);
    let (rest, more) = (transmittance + reflectance * lost, big(1.0) + reflectance * &a);
    [square(transmittance) * &a / (rest * more), a]
}

fn layer<F: Real>(x: &[F]) -> Option<RefractiveLayer<F>> {
    let coat = Coat { eta: x[2], thickness: F::ONE, sigma_a: Rgb::splat(x[1]), roughness: None };
    let mirror = SpecularReflection::new(Fresnel::constant(Rgb::splat(x[3])).ok()?);
    RefractiveLayer::new(coat, Arc::new(mirror)).ok()
}

fn series_in_use<F: Real>(x: &[F]) -> F {
    let sin_theta = ((F::ONE - x[0]) * (F::ONE + x[0])).sqrt();
    let wo = F::Vec3::new(sin_theta, F::ZERO, x[0]);
    let sample = layer(x).and_then(|layer| layer.sample(wo, F::ZERO, [F::ZERO; 2], TransportMode::Radiance));
    sample.map_or(F::NAN, |sample| sample.weight[0])
}

fn series_by_difference<F: Real>(x: &[F]) -> F {
    let there = dielectric(x[0], x[2]);
    let returned = (-(x[1] + x[1]) / there.cos_theta_t).exp() * x[3];
    let transmittance = there.transmittance.unpolarized();
    transmittance * transmittance * returned / (F::ONE - there.reflectance.unpolarized() * returned)
}

fn sheet<F: Real>(x: &[F]) -> [F; 2] {
    ThinSheet::new(x[2], Rgb::splat(x[1]), Rgb::WHITE)
        .map_or([F::NAN; 2], |sheet| sheet.fractions(x[0]).map(|fraction| fraction[0]))
}

fn sheet_in_use<F: Real>(x: &[F]) -> F {
    sheet(x)[1]
}

fn sheet_reflectance_in_use<F: Real>(x: &[F]) -> F {
    sheet(x)[0]
}

fn sheet_by_difference<F: Real>(x: &[F]) -> F {
    let face = dielectric(x[0], x[2]);
    let a = (-x[1] / face.cos_theta_t).exp();
    let (r, t) = (face.reflectance.unpolarized(), face.transmittance.unpolarized());
    t * t * a / (F::ONE - r * r * a * a)
}

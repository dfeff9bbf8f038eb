//! Sines and half vectors.

use bxdf_tests::Precision;

use super::big::{big, exact};
use super::{Axis, Form, Region, Term};
use crate::frame::sin2_theta;
use crate::real::{Real, Vector};

pub(super) fn terms() -> Vec<Term> {
    vec![Term {
        name: "geometry/sin2_theta",
        statement: "sin² θ of a direction",
        inputs: &["x", "y", "z"],
        variables: 3,
        range: "θ from 1e-7 (f32) or 1e-15 (f64) to 90°",
        exact: |x| {
            let [x, y] = [big(x[0]), big(x[1])];
            Some(exact(&(&x * &x + &y * &y)))
        },
        regions: |precision| {
            vec![Region {
                name: "normal incidence",
                axes: vec![
                    Axis::logarithmic("θ", smallest_angle(precision), 0.5),
                    Axis::linear("azimuth", 0.0, 6.3),
                ],
                inputs: |x| direction(x[0], x[1]).to_vec(),
            }]
        },
        forms: forms![
            stable "x² + y²" from_components,
            control "1 − z²" from_cosine,
        ],
    }]
}

/// The direction of the given angles \[rad\].
pub(super) fn direction(theta: f64, phi: f64) -> [f64; 3] {
    let (sin_theta, cos_theta) = libm::sincos(theta);
    let (sin_phi, cos_phi) = libm::sincos(phi);
    [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]
}

/// The direction of the given cosine and azimuth \[rad\].
pub(super) fn at_cosine(cos_theta: f64, phi: f64) -> [f64; 3] {
    let sin_theta = ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt();
    let (sin_phi, cos_phi) = libm::sincos(phi);
    [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]
}

/// A cosine next to the largest of directions in the tangent plane.
pub(super) fn tangent(precision: Precision) -> f64 {
    2.0 * match precision {
        Precision::F32 => f64::from(f32::TANGENT),
        Precision::F64 => f64::TANGENT,
    }
}

fn smallest_angle(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 1e-7,
        Precision::F64 => 1e-15,
    }
}

fn from_components<F: Real>(x: &[F]) -> F {
    sin2_theta::<F>(F::Vec3::new(x[0], x[1], x[2]))
}

fn from_cosine<F: Real>(x: &[F]) -> F {
    F::ONE - x[2] * x[2]
}

//! Directions: unit vectors with the surface normal at +z.

use rand::RngExt;
use rand_pcg::Pcg64;

pub(crate) type Vector = [f64; 3];

pub(crate) fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn scale(factor: f64, a: Vector) -> Vector {
    a.map(|component| factor * component)
}

/// a + factor · b.
pub(crate) fn add_scaled(a: Vector, factor: f64, b: Vector) -> Vector {
    core::array::from_fn(|i| a[i] + factor * b[i])
}

pub(crate) fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn normalize(a: Vector) -> Vector {
    scale(1.0 / dot(a, a).sqrt(), a)
}

/// The direction at a polar angle and an azimuth, both in degrees.
pub(crate) fn direction(polar_deg: f64, azimuth_deg: f64) -> Vector {
    let (sin_theta, cos_theta) = polar_deg.to_radians().sin_cos();
    let (sin_phi, cos_phi) = azimuth_deg.to_radians().sin_cos();
    [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta]
}

/// A direction above the surface with density cos θ / π.
pub(crate) fn cosine_hemisphere(rng: &mut Pcg64) -> Vector {
    let radius_squared: f64 = rng.random();
    let (sin_phi, cos_phi) = (core::f64::consts::TAU * rng.random::<f64>()).sin_cos();
    let radius = radius_squared.sqrt();
    [radius * cos_phi, radius * sin_phi, (1.0 - radius_squared).sqrt()]
}

/// The mirror image of `w` about the normal `m`, both leaving the surface.
pub(crate) fn reflect(w: Vector, m: Vector) -> Vector {
    add_scaled(scale(-1.0, w), 2.0 * dot(w, m), m)
}

/// The direction into which `w` refracts at a facet of normal `m`, on the far side; `eta` is the index of
/// that side over the index on the side of `w`. Not to be called under total internal reflection.
pub(crate) fn refract(w: Vector, m: Vector, eta: f64) -> Vector {
    let cos_i = dot(w, m);
    let cos_t = (1.0 - (1.0 - cos_i * cos_i) / (eta * eta)).sqrt();
    add_scaled(scale(-1.0 / eta, w), cos_i / eta - cos_t, m)
}

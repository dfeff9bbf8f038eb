//! Shapes: what rays meet. One trait, so that a scene can hold shapes of one's own.

use core::fmt::Debug;

use glam::Vec3;

use crate::parameter::{OutOfRange, require};
use crate::warp::{about, uniform_cap, uniform_cap_pdf};

/// A half-line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it begins.
    pub origin: Vec3,
    /// Where it goes, of unit length.
    pub direction: Vec3,
}

/// A box with sides along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// The least coordinates.
    pub low: Vec3,
    /// The greatest coordinates.
    pub high: Vec3,
}

/// Where a ray meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance along the ray, > 0.
    pub distance: f32,
    /// Which part of the shape, such as a triangle of a mesh.
    pub part: u32,
}

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// The point, found from the shape and not from the length of the ray.
    pub position: Vec3,
    /// How far off the shape rounding may have put it, along each axis.
    pub error: f32,
    /// Unit normal of the shape itself. It points outside: which side a ray is on is decided by it.
    pub geometric_normal: Vec3,
    /// Unit normal of the surface that is meant, where a mesh stands for a smooth one.
    pub shading_normal: Vec3,
    /// A unit tangent, perpendicular to the shading normal: the first axis of an anisotropic material.
    pub tangent: Vec3,
}

impl Surface {
    /// The beginning of a ray from here, on the side that it leaves to and beyond the error of the position
    /// (Pharr, Jakob & Humphreys, *Physically Based Rendering*, 4th ed., §6.8.6).
    #[inline]
    pub fn leave(&self, direction: Vec3) -> Ray {
        let n = self.geometric_normal;
        let distance = self.error * (n.x.abs() + n.y.abs() + n.z.abs());
        Ray { origin: self.position + n * distance.copysign(direction.dot(n)), direction }
    }
}

/// A point of an emitter, as seen from another point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Emission {
    /// Unit direction towards it.
    pub direction: Vec3,
    /// Distance to it, a little less so that it does not hide itself.
    pub distance: f32,
    /// Density \[sr⁻¹\].
    pub pdf: f32,
}

/// What rays can meet, in world space.
///
/// `intersect` finds a distance only; `surface` says the rest, once, about the nearest shape.
pub trait Shape: Debug + Send + Sync {
    /// A box that holds it.
    fn bounds(&self) -> Bounds;
    /// Where a ray meets it first, if that is nearer than `limit`.
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<Hit>;
    /// Does a ray meet it anywhere nearer than `limit`?
    fn occludes(&self, ray: &Ray, limit: f32) -> bool {
        self.intersect(ray, limit).is_some()
    }
    /// The surface at a hit of this ray.
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface;
    /// Its area.
    fn area(&self) -> f32;
    /// Draws a point of the side that the normal points to, as seen from `from`; `None` where that point turns its back,
    /// or where the shape cannot be sampled at all.
    fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Emission>;
    /// Density \[sr⁻¹\] with which `sample` draws the direction to a surface point that `from` sees.
    fn pdf(&self, from: Vec3, surface: &Surface) -> f32;
    /// Whether it has an inside: what is behind its normals. Glass fills it.
    fn is_closed(&self) -> bool;
}

/// Rounding of a position that some ten operations have made of coordinates of this size.
#[inline]
pub(super) fn rounding(size: f32) -> f32 {
    8.0 * f32::EPSILON * size
}

/// A unit vector perpendicular to the normal, for surfaces that have no direction of their own.
#[inline]
pub(super) fn some_tangent(normal: Vec3) -> Vec3 {
    about::<f32>(normal, Vec3::X)
}

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    center: Vec3,
    radius: f32,
}

impl Sphere {
    /// The sphere of the given centre and radius > 0.
    ///
    /// # Errors
    /// If a coordinate is not finite or the radius not positive.
    pub fn new(center: Vec3, radius: f32) -> Result<Self, OutOfRange> {
        require("center", center.length(), |length| length.is_finite(), "finite coordinates")?;
        require("radius", radius, |r| r > 0.0 && r.is_finite(), "a length > 0")?;
        Ok(Self { center, radius })
    }
}

impl Shape for Sphere {
    fn bounds(&self) -> Bounds {
        let margin = Vec3::splat(self.radius * (1.0 + f32::EPSILON));
        Bounds { low: self.center - margin, high: self.center + margin }
    }

    /// The discriminant from the distance of the line to the centre, which does not cancel for small spheres far away
    /// (Haines et al., *Ray Tracing Gems*, 2019, ch. 7).
    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        let from_center = ray.origin - self.center;
        let along = from_center.dot(ray.direction);
        let nearest = (from_center - ray.direction * along).length();
        let discriminant = (self.radius - nearest) * (self.radius + nearest);
        if discriminant < 0.0 {
            return None;
        }
        let away = from_center.length();
        let product = (away - self.radius) * (away + self.radius);
        let far = if along < 0.0 { discriminant.sqrt() - along } else { -discriminant.sqrt() - along };
        let near = product / far;
        let (first, second) = if far > near { (near, far) } else { (far, near) };
        let distance = if first > 0.0 { first } else { second };
        (distance > 0.0 && distance < limit).then_some(Hit { distance, part: 0 })
    }

    #[inline]
    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let normal = (ray.origin + ray.direction * hit.distance - self.center).normalize();
        let horizontal = Vec3::new(-normal.y, normal.x, 0.0);
        Surface {
            position: self.center + normal * self.radius,
            error: rounding(self.size()),
            geometric_normal: normal,
            shading_normal: normal,
            tangent: horizontal.try_normalize().unwrap_or(Vec3::X),
        }
    }

    fn area(&self) -> f32 {
        4.0 * core::f32::consts::PI * self.radius * self.radius
    }

    /// The cone that the sphere fills.
    fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Emission> {
        let height = self.cap(from)?;
        let to_center = self.center - from;
        let length = to_center.length();
        let local = uniform_cap::<f32>(u, height);
        let sine = length * (local.x * local.x + local.y * local.y).sqrt();
        // Of a sphere that is larger by what rounding may do: near the rim a little to the side is much in depth.
        let around = self.radius + 4.0 * rounding(self.size().max(from.abs().max_element()));
        let half_chord = ((around - sine) * (around + sine)).max(0.0).sqrt();
        let direction = about::<f32>(to_center / length, local);
        Some(Emission { direction, distance: length * local.z - half_chord, pdf: uniform_cap_pdf(height) })
    }

    fn pdf(&self, from: Vec3, _: &Surface) -> f32 {
        self.cap(from).map_or(0.0, uniform_cap_pdf)
    }

    fn is_closed(&self) -> bool {
        true
    }
}

impl Sphere {
    fn size(&self) -> f32 {
        self.center.abs().max_element() + self.radius
    }

    /// 1 − cos θ of the cone that it fills from a point outside.
    #[inline]
    fn cap(&self, from: Vec3) -> Option<f32> {
        let sine = self.radius / (self.center - from).length();
        let cos_squared = (1.0 - sine) * (1.0 + sine);
        (cos_squared > 0.0).then(|| sine * sine / (1.0 + cos_squared.sqrt()))
    }
}

/// A parallelogram.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Quad {
    corner: Vec3,
    edges: [Vec3; 2],
    /// Dual to the edges: scalar products with them are coordinates along the edges.
    duals: [Vec3; 2],
    normal: Vec3,
    area: f32,
}

impl Quad {
    /// The parallelogram of a corner and two edges; its normal is along `edges[0]` × `edges[1]`.
    ///
    /// # Errors
    /// If a coordinate is not finite or the area is zero.
    pub fn new(corner: Vec3, edges: [Vec3; 2]) -> Result<Self, OutOfRange> {
        require("corner", corner.length(), |length| length.is_finite(), "finite coordinates")?;
        let cross = edges[0].cross(edges[1]);
        let area = require(
            "area",
            cross.length(),
            |area| area > 0.0 && area.is_finite(),
            "> 0: two edges that are not parallel",
        )?;
        let normal = cross / area;
        let duals = [edges[1].cross(normal) / area, normal.cross(edges[0]) / area];
        Ok(Self { corner, edges, duals, normal, area })
    }

    #[inline]
    fn coordinates(&self, point: Vec3) -> [f32; 2] {
        self.duals.map(|dual| dual.dot(point - self.corner))
    }

    fn size(&self) -> f32 {
        let Bounds { low, high } = self.bounds();
        low.abs().max(high.abs()).max_element()
    }
}

impl Shape for Quad {
    fn bounds(&self) -> Bounds {
        let [a, b] = self.edges;
        let corners = [self.corner, self.corner + a, self.corner + b, self.corner + a + b];
        let low = corners.into_iter().fold(self.corner, Vec3::min);
        let high = corners.into_iter().fold(self.corner, Vec3::max);
        // Planes have boxes without volume, which rounding must not miss.
        let margin = Vec3::splat(rounding(low.abs().max(high.abs()).max_element()));
        Bounds { low: low - margin, high: high + margin }
    }

    #[inline]
    fn intersect(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        let distance = self.normal.dot(self.corner - ray.origin) / self.normal.dot(ray.direction);
        if !(distance > 0.0 && distance < limit) {
            return None;
        }
        let inside = self.coordinates(ray.origin + ray.direction * distance);
        inside.iter().all(|x| (0.0..=1.0).contains(x)).then_some(Hit { distance, part: 0 })
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let [u, v] = self.coordinates(ray.origin + ray.direction * hit.distance);
        Surface {
            position: self.corner + self.edges[0] * u + self.edges[1] * v,
            error: rounding(self.size()),
            geometric_normal: self.normal,
            shading_normal: self.normal,
            tangent: self.edges[0].normalize(),
        }
    }

    fn area(&self) -> f32 {
        self.area
    }

    fn sample(&self, from: Vec3, u: [f32; 2]) -> Option<Emission> {
        let point = self.corner + self.edges[0] * u[0] + self.edges[1] * u[1];
        towards(from, point, self.normal, self.area, self.size())
    }

    fn pdf(&self, from: Vec3, surface: &Surface) -> f32 {
        density(from, surface.position, self.normal, self.area)
    }

    fn is_closed(&self) -> bool {
        false
    }
}

/// A point that was drawn uniformly on an area, in the measure of solid angle.
#[inline]
pub(super) fn towards(from: Vec3, point: Vec3, normal: Vec3, area: f32, size: f32) -> Option<Emission> {
    let way = point - from;
    let distance = way.length();
    let direction = way / distance;
    let cosine = -direction.dot(normal);
    let pdf = distance * distance / (cosine * area);
    // On the plane of the emitter there is nothing to see of it.
    let is_seen = cosine > 0.0 && pdf.is_finite();
    let margin = 4.0 * rounding(size.max(from.abs().max_element())) / cosine.max(0.01);
    is_seen.then_some(Emission { direction, distance: distance - margin, pdf })
}

/// Density \[sr⁻¹\] of [`towards`].
#[inline]
pub(super) fn density(from: Vec3, point: Vec3, normal: Vec3, area: f32) -> f32 {
    let way = point - from;
    let squared = way.length_squared();
    let cosine = -way.dot(normal) / squared.sqrt();
    if cosine > 0.0 { squared / (cosine * area) } else { 0.0 }
}

//! Triangle meshes: the only place that knows the library of bounding-volume hierarchies.

use core::fmt;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::RayHit;

use super::shape::{Bounds, Emission, Hit, Ray, Shape, Surface, density, rounding, some_tangent, towards};

/// Triangles that share vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Triangles {
    /// Corners.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals of the smooth surface, one per position; none for flat triangles.
    pub normals: Vec<[f32; 3]>,
    /// Three positions each, counter-clockwise seen from outside.
    pub corners: Vec<[u32; 3]>,
}

/// Why triangles are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// No triangle has an area.
    #[error("a mesh needs a triangle with an area")]
    Empty,
    /// More triangles than indices can tell.
    #[error("{0} triangles are too many: expected at most 2^31")]
    TooMany(usize),
    /// A triangle with a corner that is not there.
    #[error("triangle {triangle} names position {index}, and there are {positions}")]
    Index {
        /// Which triangle, from 0.
        triangle: usize,
        /// What it names.
        index: u32,
        /// How many there are.
        positions: usize,
    },
    /// A position or normal that is not finite.
    #[error("{what} {index} is not finite: {value:?}")]
    NotFinite {
        /// `position` or `normal`.
        what: &'static str,
        /// Which one, from 0.
        index: usize,
        /// What it is.
        value: [f32; 3],
    },
    /// Neither no normals nor one per position.
    #[error("{normals} normals for {positions} positions: expected one each, or none")]
    Normals {
        /// How many there are.
        normals: usize,
        /// How many there should be.
        positions: usize,
    },
}

/// A mesh of triangles, with smooth normals where it has some.
pub struct Mesh {
    triangles: Triangles,
    hierarchy: CwBvh,
    bounds: Bounds,
    is_closed: bool,
    area: f32,
    /// Sums of areas, for emitters only.
    areas: Vec<f32>,
}

impl fmt::Debug for Mesh {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Mesh of {} triangles", self.triangles.corners.len())
    }
}

/// The box of one triangle, grown by rounding so that no ray that meets the triangle misses it.
fn box_of(corners: [Vec3; 3]) -> Aabb {
    let [a, b, c] = corners.map(Vec3A::from);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let margin = Vec3A::splat(rounding(low.abs().max(high.abs()).max_element()) * 0.25);
    Aabb::new(low - margin, high + margin)
}

impl Mesh {
    /// The mesh of these triangles; those without an area are left out.
    ///
    /// # Errors
    /// If an index or a number is bad, or nothing is left.
    pub fn new(mut triangles: Triangles) -> Result<Self, MeshError> {
        check(&triangles)?;
        let positions = &triangles.positions;
        let corners_of = |corners: &[u32; 3]| corners.map(|i| Vec3::from(positions[i as usize]));
        triangles.corners.retain(|corners| {
            let [a, b, c] = corners_of(corners);
            (b - a).cross(c - a).length_squared() > 0.0
        });
        if triangles.corners.is_empty() {
            return Err(MeshError::Empty);
        }
        let boxes: Vec<Aabb> = triangles.corners.iter().map(|corners| box_of(corners_of(corners))).collect();
        let indices = (0..boxes.len() as u32).collect();
        let mut hierarchy = PlocBuilder::with_capacity(boxes.len()).build(
            PlocSearchDistance::Low,
            &boxes,
            indices,
            SortPrecision::U64,
            0,
        );
        drop(boxes);
        ReinsertionOptimizer::default().run(&mut hierarchy, 0.02, None);
        let mut hierarchy = bvh2_to_cwbvh(&hierarchy, 3, true, false);
        // In the order of the hierarchy, so that no index stands between a leaf and its triangles.
        let order = core::mem::take(&mut hierarchy.primitive_indices);
        let ordered: Vec<_> = order.iter().map(|&i| triangles.corners[i as usize]).collect();
        triangles.corners = ordered;
        let (low, high) = (hierarchy.total_aabb.min.into(), hierarchy.total_aabb.max.into());
        let area = triangles.corners.iter().map(|corners| area_of(corners_of(corners))).sum::<f64>() as f32;
        let is_closed = is_closed(&triangles.corners, positions);
        Ok(Self { triangles, hierarchy, bounds: Bounds { low, high }, is_closed, area, areas: Vec::new() })
    }

    /// The same mesh, able to emit: it can be sampled.
    #[must_use]
    pub fn emitting(mut self) -> Self {
        let mut sum = 0.0;
        let areas = self.triangles.corners.iter().map(|&corners| {
            sum += area_of(self.corners(corners));
            sum as f32
        });
        self.areas = areas.collect();
        self
    }

    /// How many triangles it has.
    pub fn triangles(&self) -> usize {
        self.triangles.corners.len()
    }

    #[inline]
    fn corners(&self, corners: [u32; 3]) -> [Vec3; 3] {
        corners.map(|i| Vec3::from(self.triangles.positions[i as usize]))
    }

    #[inline]
    fn part(&self, part: usize) -> [Vec3; 3] {
        self.corners(self.triangles.corners[part])
    }
}

fn area_of([a, b, c]: [Vec3; 3]) -> f64 {
    0.5 * f64::from((b - a).cross(c - a).length())
}

fn check(triangles: &Triangles) -> Result<(), MeshError> {
    let Triangles { positions, normals, corners } = triangles;
    if corners.len() > 1 << 31 {
        return Err(MeshError::TooMany(corners.len()));
    }
    if !normals.is_empty() && normals.len() != positions.len() {
        return Err(MeshError::Normals { normals: normals.len(), positions: positions.len() });
    }
    for (what, values) in [("position", positions), ("normal", normals)] {
        if let Some(index) = values.iter().position(|value| !Vec3::from(*value).is_finite()) {
            return Err(MeshError::NotFinite { what, index, value: values[index] });
        }
    }
    for (triangle, corners) in corners.iter().enumerate() {
        if let Some(&index) = corners.iter().find(|&&index| index as usize >= positions.len()) {
            return Err(MeshError::Index { triangle, index, positions: positions.len() });
        }
    }
    Ok(())
}

/// Whether each edge has one triangle on either side, by place: files repeat vertices where normals differ.
fn is_closed(corners: &[[u32; 3]], positions: &[[f32; 3]]) -> bool {
    // Sum and sum of hashes over directed edges: opposite edges cancel. Collisions would take luck.
    let place = |i: u32| {
        let [x, y, z] = positions[i as usize].map(|x| u64::from((x + 0.0).to_bits()));
        scramble(x ^ scramble(y ^ scramble(z)))
    };
    let sum = corners.iter().fold(0_u64, |sum, &[a, b, c]| {
        let [a, b, c] = [a, b, c].map(place);
        let edge = |from: u64, to: u64| {
            let (low, high) = (from.min(to), from.max(to));
            let hash = scramble(low ^ scramble(high));
            if from < to { hash } else { hash.wrapping_neg() }
        };
        sum.wrapping_add(edge(a, b)).wrapping_add(edge(b, c)).wrapping_add(edge(c, a))
    });
    sum == 0
}

/// The finaliser of SplitMix64 (Steele, Lea & Flood, OOPSLA 2014, <https://doi.org/10.1145/2714064.2660195>).
#[inline]
pub(super) fn scramble(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// A ray with what every triangle needs of it: axes such that it goes along the third, and the shear that makes it so.
struct ShearedRay {
    origin: Vec3,
    axes: [usize; 3],
    shear: Vec3,
}

impl ShearedRay {
    #[inline]
    fn new(ray: &Ray) -> Self {
        let d = ray.direction;
        let size = d.abs();
        let z = if size.x > size.y && size.x > size.z {
            0
        } else if size.y > size.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if d[z] < 0.0 {
            core::mem::swap(&mut x, &mut y);
        }
        Self { origin: ray.origin, axes: [x, y, z], shear: Vec3::new(d[x] / d[z], d[y] / d[z], 1.0 / d[z]) }
    }

    /// Distance and barycentric coordinates; infinity where the triangle is missed.
    ///
    /// Watertight: rays through a shared edge meet one of its triangles (Woop, Benthin & Wald, JCGT 2(1), 2013,
    /// <https://jcgt.org/published/0002/01/05/>).
    #[inline]
    fn meets(&self, corners: [Vec3; 3]) -> (f32, [f32; 3]) {
        const MISS: (f32, [f32; 3]) = (f32::INFINITY, [0.0; 3]);
        let [x, y, z] = self.axes;
        let [a, b, c] = corners.map(|corner| {
            let p = corner - self.origin;
            Vec3::new(p[x] - self.shear.x * p[z], p[y] - self.shear.y * p[z], p[z])
        });
        let mut u = c.x * b.y - c.y * b.x;
        let mut v = a.x * c.y - a.y * c.x;
        let mut w = b.x * a.y - b.y * a.x;
        if u == 0.0 || v == 0.0 || w == 0.0 {
            let exact = |p: f32, q: f32, r: f32, s: f32| {
                (f64::from(p) * f64::from(q) - f64::from(r) * f64::from(s)) as f32
            };
            u = exact(c.x, b.y, c.y, b.x);
            v = exact(a.x, c.y, a.y, c.x);
            w = exact(b.x, a.y, b.y, a.x);
        }
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return MISS;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return MISS;
        }
        let inverse = 1.0 / determinant;
        let distance = (u * a.z + v * b.z + w * c.z) * self.shear.z * inverse;
        if distance > 0.0 { (distance, [u * inverse, v * inverse, w * inverse]) } else { MISS }
    }
}

impl Shape for Mesh {
    fn bounds(&self) -> Bounds {
        self.bounds
    }

    fn intersect(&self, ray: &Ray, limit: f32) -> Option<Hit> {
        let sheared = ShearedRay::new(ray);
        let mut hit = RayHit::none();
        let query = obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, limit);
        self.hierarchy.ray_traverse(query, &mut hit, |_, part| sheared.meets(self.part(part)).0);
        (hit.t < limit).then_some(Hit { distance: hit.t, part: hit.primitive_id })
    }

    fn occludes(&self, ray: &Ray, limit: f32) -> bool {
        let sheared = ShearedRay::new(ray);
        let query = obvhs::ray::Ray::new(ray.origin.into(), ray.direction.into(), 0.0, limit);
        !self.hierarchy.ray_traverse_miss(query, |_, part| sheared.meets(self.part(part)).0)
    }

    fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        let indices = self.triangles.corners[hit.part as usize];
        let corners = self.corners(indices);
        let (_, [u, v, w]) = ShearedRay::new(ray).meets(corners);
        let [a, b, c] = corners;
        let geometric_normal = (b - a).cross(c - a).normalize();
        let blend = |[a, b, c]: [Vec3; 3]| a * u + b * v + c * w;
        let smooth = match self.triangles.normals.as_slice() {
            [] => None,
            normals => blend(indices.map(|i| Vec3::from(normals[i as usize]))).try_normalize(),
        };
        let shading_normal = smooth.filter(|n| n.dot(geometric_normal) > 0.0).unwrap_or(geometric_normal);
        Surface {
            position: blend(corners),
            error: rounding(a.abs().max(b.abs()).max(c.abs()).max_element()),
            geometric_normal,
            shading_normal,
            tangent: some_tangent(shading_normal),
        }
    }

    fn area(&self) -> f32 {
        self.area
    }

    fn sample(&self, from: Vec3, [u0, u1]: [f32; 2]) -> Option<Emission> {
        let target = u0 * self.areas.last()?;
        let part = self.areas.partition_point(|&sum| sum <= target).min(self.areas.len() - 1);
        let before = if part > 0 { self.areas[part - 1] } else { 0.0 };
        // What is left of the number is uniform again.
        let rest = ((target - before) / (self.areas[part] - before)).clamp(0.0, 1.0);
        let [a, b, c] = self.part(part);
        let root = rest.sqrt();
        let point = a * (1.0 - root) + b * (root * (1.0 - u1)) + c * (root * u1);
        let normal = (b - a).cross(c - a).normalize();
        towards(from, point, normal, self.area, a.abs().max(b.abs()).max(c.abs()).max_element())
    }

    fn pdf(&self, from: Vec3, surface: &Surface) -> f32 {
        density(from, surface.position, surface.geometric_normal, self.area)
    }

    fn is_closed(&self) -> bool {
        self.is_closed
    }
}

//! Meshes made by formula, in place of the scanned and modelled ones of the thesis.
//!
//! Every closed mesh is the image of a sphere under one smooth map (ring, sector) → point that cannot run
//! into itself for a reason its function states. Shapes are 1 to 2 units large, z is up, figures face +x,
//! faces are wound counter-clockwise seen from outside. Arithmetic is `f64` with `libm`, so every machine
//! makes the same bits.

use core::f64::consts::{PI, TAU};
use core::ops::RangeInclusive;

use rayon::prelude::*;

use super::mesh::Triangles;

fn mesh(positions: Vec<[f32; 3]>, normals: Vec<[f32; 3]>, corners: Vec<[u32; 3]>) -> Triangles {
    Triangles { positions, normals, corners }
}

/// A mesh that wears one material.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What a scene calls it, to say which material it wears.
    pub name: &'static str,
    /// Its triangles.
    pub mesh: Triangles,
}

/// Why a shape was not made.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No shape has this name.
    #[error("no generated shape is called `{name}`; there are {}", names())]
    UnknownName {
        /// The name asked for.
        name: String,
    },
    /// The resolution is too coarse for the shape to come out right or too fine to hold.
    #[error("`{shape}` cannot have {value} {quantity}: the range is {} to {}", range.start(), range.end())]
    Resolution {
        /// The name of the shape.
        shape: &'static str,
        /// What the resolution counts.
        quantity: &'static str,
        /// The number asked for.
        value: u32,
        /// The numbers possible.
        range: RangeInclusive<u32>,
    },
}

fn names() -> String {
    Shape::ALL.map(|(name, _)| name).join(", ")
}

/// The generated shapes, as a scene file names them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// [`displaced_sphere`], for the bunny.
    DisplacedSphere,
    /// [`statue`], for the Happy Buddha.
    Statue,
    /// [`material_ball`], for Blender's material test scene.
    MaterialBall,
    /// [`car_body`], for the car.
    CarBody,
    /// [`fine_displaced_sphere`], for the engine.
    FineDisplacedSphere,
}

impl Shape {
    /// Every shape beside its name in a scene file.
    pub const ALL: [(&str, Self); 5] = [
        ("displaced_sphere", Self::DisplacedSphere),
        ("statue", Self::Statue),
        ("material_ball", Self::MaterialBall),
        ("car_body", Self::CarBody),
        ("fine_displaced_sphere", Self::FineDisplacedSphere),
    ];

    /// The name in a scene file.
    pub fn name(self) -> &'static str {
        Self::ALL[self as usize].0
    }

    /// The shape of this name.
    pub fn from_name(name: &str) -> Result<Self, Error> {
        let found = Self::ALL.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, shape)| shape).ok_or_else(|| Error::UnknownName { name: name.to_owned() })
    }

    /// What the resolution counts, and its range.
    pub const fn resolution(self) -> (&'static str, RangeInclusive<u32>) {
        match self {
            Self::FineDisplacedSphere => ("triangles", FINE_TRIANGLES),
            _ => ("rings", RINGS),
        }
    }

    /// The shape's parts at this resolution.
    pub fn build(self, resolution: u32) -> Result<Vec<Part>, Error> {
        let (quantity, range) = self.resolution();
        if !range.contains(&resolution) {
            return Err(Error::Resolution { shape: self.name(), quantity, value: resolution, range });
        }
        let whole = |mesh| vec![Part { name: self.name(), mesh }];
        Ok(match self {
            Self::DisplacedSphere => whole(displaced_sphere(resolution)),
            Self::Statue => whole(statue(resolution)),
            Self::MaterialBall => material_ball(resolution),
            Self::CarBody => car_body(resolution),
            Self::FineDisplacedSphere => whole(fine_displaced_sphere(resolution)),
        })
    }
}

/// Rings of the shapes that count them. With fewer, folds fall between the rings.
const RINGS: RangeInclusive<u32> = 128..=2048;

/// Triangles of the fine sphere.
const FINE_TRIANGLES: RangeInclusive<u32> = 10_000..=16_000_000;

fn clamp(value: u32, range: RangeInclusive<u32>) -> u32 {
    value.clamp(*range.start(), *range.end())
}

type Point = [f64; 3];

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn difference(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn cross(a: Point, b: Point) -> Point {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn mix(a: f64, b: f64, t: f64) -> f64 {
    a + (b - a) * t
}

/// 0 below `from`, 1 above `to`, smooth between.
fn step(from: f64, to: f64, x: f64) -> f64 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// exp(−|x|²) of offsets given in widths.
fn bump<const N: usize>(x: [f64; N]) -> f64 {
    libm::exp(-x.iter().map(|x| x * x).sum::<f64>())
}

/// The p-norm with p = 2^`doublings`: a smooth maximum of non-negative numbers, and of two the gauge of a
/// superellipse.
fn norm<const N: usize>(values: [f64; N], doublings: u32) -> f64 {
    let power = |x| (0..doublings).fold(x, |x: f64, _| x * x);
    let sum = values.into_iter().map(power).sum();
    (0..doublings).fold(sum, |x: f64, _| x.sqrt())
}

/// The unit circle's point at `angle`, moved out to the superellipse of exponent 2^`doublings`.
fn superellipse(angle: f64, doublings: u32) -> [f64; 2] {
    let (sin, cos) = libm::sincos(angle);
    let size = norm([cos, sin], doublings);
    [cos / size, sin / size]
}

/// Step of the central differences that make normals: large beside rounding, small beside any fold.
const STEP: f64 = 1e-6;

/// The point at (u, v) and the unit normal ∂u × ∂v.
fn vertex(point: impl Fn(f64, f64) -> Point, u: f64, v: f64) -> ([f32; 3], [f32; 3]) {
    let along_u = difference(point(u + STEP, v), point(u - STEP, v));
    let along_v = difference(point(u, v + STEP), point(u, v - STEP));
    let normal = cross(along_u, along_v);
    let length = dot(normal, normal).sqrt();
    (point(u, v).map(|x| x as f32), normal.map(|x| (x / length) as f32))
}

/// The sphere's image under `point`, which takes (u, v): u from the upper pole, 0, to the lower, 1; v about
/// the axis, counter-clockwise seen from above, with period 1. It has 2 (`rings` − 1) `sectors` triangles.
fn closed(rings: u32, sectors: u32, point: impl Fn(f64, f64) -> Point + Sync) -> Triangles {
    let last = (rings - 1) * sectors + 1;
    // Across a pole, u continues on the other side; so (a, b) of a square about the pole are four points
    // around it.
    let pole = |u: f64, sign: f64| {
        let square = |a: f64, b: f64| match (a, b) {
            (0.0, 0.0) => point(u, 0.0),
            (_, 0.0) => point(u + sign * STEP, if a > 0.0 { 0.0 } else { 0.5 }),
            _ => point(u + sign * STEP, if b * sign > 0.0 { 0.25 } else { 0.75 }),
        };
        vertex(square, 0.0, 0.0)
    };
    let vertices = (0..=last).into_par_iter().map(|index| match index {
        0 => pole(0.0, 1.0),
        _ if index == last => pole(1.0, -1.0),
        _ => {
            let (ring, sector) = ((index - 1) / sectors + 1, (index - 1) % sectors);
            vertex(&point, f64::from(ring) / f64::from(rings), f64::from(sector) / f64::from(sectors))
        }
    });
    let (positions, normals) = vertices.unzip();
    let at = |ring: u32, sector: u32| match ring {
        0 => 0,
        _ if ring == rings => last,
        _ => 1 + (ring - 1) * sectors + sector % sectors,
    };
    let mut triangles = Vec::with_capacity(2 * (rings as usize - 1) * sectors as usize);
    for ring in 0..rings {
        for sector in 0..sectors {
            let [a, b] = [at(ring, sector), at(ring + 1, sector)];
            let [d, c] = [at(ring, sector + 1), at(ring + 1, sector + 1)];
            // At a pole two corners are one.
            let upper = (b != c).then_some([a, b, c]);
            triangles.extend(upper.into_iter().chain((a != d).then_some([a, c, d])));
        }
    }
    mesh(positions, normals, triangles)
}

/// The unit square's image under `point`, one-sided: normals are ∂u × ∂v. It has 2 `rows` `columns`
/// triangles.
fn sheet(rows: u32, columns: u32, point: impl Fn(f64, f64) -> Point) -> Triangles {
    let at = |row: u32, column: u32| row * (columns + 1) + column;
    let vertices = (0..=at(rows, columns)).map(|index| {
        let (row, column) = (index / (columns + 1), index % (columns + 1));
        vertex(&point, f64::from(row) / f64::from(rows), f64::from(column) / f64::from(columns))
    });
    let (positions, normals) = vertices.unzip();
    let squares = (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column)));
    let triangles = squares.flat_map(|(row, column)| {
        let [a, b] = [at(row, column), at(row + 1, column)];
        [[a, b, b + 1], [a, b + 1, a + 1]]
    });
    mesh(positions, normals, triangles.collect())
}

/// Several meshes as one.
fn join(meshes: impl IntoIterator<Item = Triangles>) -> Triangles {
    let (mut positions, mut normals, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for one in meshes {
        let offset = positions.len() as u32;
        positions.extend(one.positions);
        normals.extend(one.normals);
        triangles.extend(one.corners.into_iter().map(|triangle| triangle.map(|index| index + offset)));
    }
    mesh(positions, normals, triangles)
}

/// The uniform cubic B-spline of `control` at `t` ∈ \[0, 1\]. The first number of a control point is a
/// radius: 0 at both ends, and continued there with the opposite sign, which makes the surface smooth at its
/// poles. Where the other numbers are monotone in the control points, they are in the curve.
fn spline<const N: usize>(control: &[[f64; N]], t: f64) -> [f64; N] {
    let last = control.len() as isize - 1;
    let position = t * last as f64;
    let segment = (position as isize).clamp(0, last - 1);
    let x = position - segment as f64;
    let rest = 1.0 - x;
    let middle = |x: f64| (3.0 * x - 6.0) * x * x + 4.0;
    let weights = [rest * rest * rest, middle(x), middle(rest), x * x * x];
    let mut sum = [0.0; N];
    for (index, weight) in (segment - 1..).zip(weights) {
        let inside = if index < 0 { -index } else { last - (last - index).abs() };
        let point = control[inside as usize];
        for i in 0..N {
            let sign = if i == 0 && inside != index { -1.0 } else { 1.0 };
            sum[i] += weight / 6.0 * sign * point[i];
        }
    }
    sum
}

/// The spline through (radius, height) turned about the z axis; it is embedded because the spline is a simple
/// curve.
fn revolve(control: &[[f64; 2]], u: f64, v: f64) -> Point {
    let [radius, z] = spline(control, u);
    let (sin, cos) = libm::sincos(TAU * v);
    [radius * cos, radius * sin, z]
}

/// The star-shaped surface at distance `radius`(direction) > 0 from the origin: one point in each direction.
fn star(u: f64, v: f64, radius: impl Fn(Point) -> f64) -> Point {
    let (sin_theta, cos_theta) = libm::sincos(PI * u);
    let (sin_phi, cos_phi) = libm::sincos(TAU * v);
    let direction = [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta];
    let radius = radius(direction);
    direction.map(|x| x * radius)
}

/// Where a ray from the origin leaves an ellipsoid that contains the origin. The ellipsoid has half lengths
/// along x, y and z, is then turned up by `pitch` and about z by `yaw`, in degrees; its centre is given in
/// its half lengths.
fn ellipsoid(half: Point, [pitch, yaw]: [f64; 2], centre: Point) -> impl Fn(Point) -> f64 + Sync {
    let (sin_pitch, cos_pitch) = libm::sincos(pitch / 180.0 * PI);
    let (sin_yaw, cos_yaw) = libm::sincos(yaw / 180.0 * PI);
    let axes = [
        [cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch].map(|x| x / half[0]),
        [-sin_yaw, cos_yaw, 0.0].map(|x| x / half[1]),
        [-sin_pitch * cos_yaw, -sin_pitch * sin_yaw, cos_pitch].map(|x| x / half[2]),
    ];
    move |direction| {
        let d = axes.map(|axis| dot(axis, direction));
        let (along, square) = (dot(d, centre), dot(d, d));
        (along + (along * along + square * (1.0 - dot(centre, centre))).sqrt()) / square
    }
}

/// An animal with long thin ears, for the bunny: it sits facing +x on z = −0.72, 1.4 long and 1.5 high, with
/// the origin in its neck. Star-shaped, because it is a smooth union of ellipsoids about the origin, cut by a
/// ground plane. `rings` is clamped to 128–2048; there are 4 `rings` (`rings` − 1) triangles.
pub fn displaced_sphere(rings: u32) -> Triangles {
    let rings = clamp(rings, RINGS);
    let parts = [
        ellipsoid([0.56, 0.37, 0.45], [25.0, 0.0], [-0.68, 0.0, -0.45]),
        ellipsoid([0.3, 0.19, 0.21], [-20.0, 0.0], [0.45, 0.0, 0.6]),
        ellipsoid([0.46, 0.12, 0.05], [112.0, -40.0], [0.88, 0.0, 0.3]),
        ellipsoid([0.46, 0.12, 0.05], [112.0, 40.0], [0.88, 0.0, 0.3]),
    ];
    // Direction with y ≥ 0, mirrored to the other side; sharpness; height as a share of the radius.
    const BUMPS: [(Point, f64, f64); 7] = [
        ([-0.33, 0.42, -0.40], 25.0, 0.13),
        ([0.0, 0.38, -0.70], 60.0, 0.12),
        ([0.3, 0.13, -0.70], 60.0, 0.3),
        ([-0.8, 0.0, -0.42], 80.0, 0.11),
        ([0.34, 0.17, 0.12], 160.0, 0.06),
        ([0.4, 0.10, 0.0], 60.0, 0.09),
        ([0.43, 0.0, 0.03], 400.0, 0.03),
    ];
    let bumps = BUMPS.map(|(axis, sharpness, height)| {
        let length = dot(axis, axis).sqrt();
        (axis.map(|x| x / length), sharpness, height)
    });
    let radius = |direction: Point| {
        let union = norm(parts.each_ref().map(|exit| exit(direction)), 4);
        let mirrored = [direction[0], direction[1].abs(), direction[2]];
        let raised = bumps
            .iter()
            .map(|&(axis, sharpness, height)| height * libm::exp(sharpness * (dot(axis, mirrored) - 1.0)));
        let body = union * (1.0 + raised.sum::<f64>());
        1.0 / norm([1.0 / body, (-direction[2]).max(0.0) / 0.72], 5)
    };
    closed(rings, 2 * rings, |u, v| star(u, v, radius))
}

/// A seated figure on a lotus base, for the Happy Buddha: it faces +x on z = 0, 1.6 high and 1.4 wide.
/// Embedded, because heights fall along the profile and every horizontal section is star-shaped about the
/// axis. `rings` is clamped to 128–2048; there are 4 `rings` (`rings` − 1) triangles.
pub fn statue(rings: u32) -> Triangles {
    let rings = clamp(rings, RINGS);
    // Half width, height, depth over width.
    #[rustfmt::skip]
    const PROFILE: &[[f64; 3]] = &[
        [0.0, 1.62, 1.0], [0.06, 1.61, 1.0], [0.08, 1.57, 1.0], [0.07, 1.52, 1.0],
        [0.14, 1.49, 1.1], [0.18, 1.43, 1.1], [0.19, 1.35, 1.1], [0.18, 1.27, 1.1],
        [0.16, 1.20, 1.1], [0.11, 1.16, 1.0], [0.11, 1.12, 1.0], [0.18, 1.08, 0.9],
        [0.34, 1.04, 0.6], [0.39, 0.97, 0.6], [0.39, 0.88, 0.65], [0.38, 0.79, 0.7],
        [0.37, 0.70, 0.8], [0.38, 0.61, 0.85], [0.42, 0.52, 0.85], [0.56, 0.46, 0.75],
        [0.66, 0.41, 0.72], [0.68, 0.35, 0.72], [0.66, 0.29, 0.72], [0.58, 0.25, 0.8],
        [0.56, 0.23, 0.8], [0.64, 0.20, 0.8], [0.68, 0.15, 0.8], [0.66, 0.09, 0.8],
        [0.60, 0.05, 0.85], [0.66, 0.03, 0.85], [0.66, 0.0, 0.85], [0.64, 0.0, 0.85],
        [0.4, 0.0, 0.85], [0.2, 0.0, 0.85], [0.0, 0.0, 0.85],
    ];
    closed(rings, 2 * rings, |u, v| {
        let [width, z, aspect] = spline(PROFILE, u);
        let (sin, cos) = libm::sincos(TAU * v);
        let ellipse = width / norm([cos / aspect, sin], 1);
        let relief = statue_relief(z, libm::atan2(sin, cos));
        [ellipse * relief * cos, ellipse * relief * sin, z]
    })
}

/// What the statue's ellipses are multiplied by at a height and an angle from the front.
fn statue_relief(z: f64, front: f64) -> f64 {
    let side = front.abs();
    let window = |low: f64, high: f64| step(low - 0.04, low + 0.04, z) * step(high + 0.04, high - 0.04, z);
    // Upper and lower row of lotus petals.
    let petal = libm::cos(14.0 * front);
    let lotus = 0.05 * petal * (bump([(z - 0.17) / 0.05]) - bump([(z - 0.07) / 0.04]));
    let legs =
        0.14 * bump([(z - 0.35) / 0.1, (side - 1.05) / 0.4]) - 0.06 * bump([(z - 0.38) / 0.06, front / 0.2]);
    let belly = 0.3 * bump([(z - 0.68) / 0.13, front / 0.7]);
    // The arms hang at the sides and turn to the lap below the elbows.
    let arm_angle = mix(0.3, 1.6, step(0.46, 0.74, z));
    let arms = window(0.5, 1.0)
        * (0.28 * bump([(side - arm_angle) / 0.32]) - 0.1 * bump([(side - arm_angle + 0.5) / 0.2]));
    let robe = window(0.52, 1.0) * 0.014 * libm::sin(50.0 * z + 8.0 * front);
    let skirt = window(0.3, 0.48) * 0.012 * libm::cos(60.0 * z + 6.0 * front);
    let face = 0.16 * bump([(z - 1.325) / 0.04, front / 0.11])
        + 0.04 * bump([(z - 1.385) / 0.025, side / 0.6])
        - 0.05 * bump([(z - 1.355) / 0.02, (side - 0.4) / 0.18])
        + 0.06 * bump([(z - 1.262) / 0.015, front / 0.22])
        + 0.05 * bump([(z - 1.21) / 0.03, front / 0.3]);
    let ears = 0.25 * bump([(z - 1.29) / 0.1, (side - 1.6) / 0.12]);
    let hair = window(1.46, 1.6) * 0.04 * libm::cos(20.0 * front) * libm::cos(130.0 * z);
    1.0 + lotus + legs + belly + arms + robe + skirt + face + ears + hair
}

/// A ball with a round opening and a groove, the ball within it, and a dished base: `outer`, `inner` and
/// `base`. The opening faces +x and up; the base is 1.4 across and stands on z = 0, the top is at 1.6. All
/// three are surfaces of revolution of simple curves, apart by at least 0.005. `rings` is clamped to
/// 128–2048.
pub fn material_ball(rings: u32) -> Vec<Part> {
    let rings = clamp(rings, RINGS);
    vec![
        Part { name: "outer", mesh: closed(rings, 2 * rings, ball_shell) },
        Part {
            name: "inner",
            mesh: closed(rings, 2 * rings, |u, v| {
                let [x, y, z] = star(u, v, |_| BALL_INNER);
                [x, y, z + BALL_HEIGHT]
            }),
        },
        Part { name: "base", mesh: closed(rings, 2 * rings, |u, v| revolve(BALL_BASE, u, v)) },
    ]
}

const BALL_HEIGHT: f64 = 0.9;
const BALL_OUTER: f64 = 0.7;
const BALL_THICKNESS: f64 = 0.1;
const BALL_INNER: f64 = 0.5;
/// Radius and height; the dish is a little wider than the ball.
#[rustfmt::skip]
const BALL_BASE: &[[f64; 2]] = &[
    [0.0, 0.18], [0.2, 0.208], [0.4, 0.303], [0.5, 0.37], [0.54, 0.37], [0.58, 0.33], [0.58, 0.22],
    [0.6, 0.17], [0.68, 0.15], [0.7, 0.12], [0.7, 0.06], [0.7, 0.0], [0.66, 0.0], [0.4, 0.0],
    [0.2, 0.0], [0.0, 0.0],
];

/// Outside, lip and inside of a thick sphere that is open within 50° of an axis between +x and +z.
fn ball_shell(u: f64, v: f64) -> Point {
    const EDGE: f64 = 130.0 / 180.0 * PI;
    // Polar angle from the closed side, radius, and how far round the lip.
    let (theta, radius, lip) = if u < 0.52 {
        let theta = u / 0.52 * EDGE;
        (theta, BALL_OUTER - 0.03 * bump([(theta - 1.6) / 0.04]), 0.0)
    } else if u < 0.58 {
        let lip = (u - 0.52) / 0.06 * PI;
        (
            EDGE,
            BALL_OUTER - BALL_THICKNESS / 2.0 * (1.0 - libm::cos(lip)),
            BALL_THICKNESS / 2.0 * libm::sin(lip),
        )
    } else {
        ((1.0 - u) / 0.42 * EDGE, BALL_OUTER - BALL_THICKNESS, 0.0)
    };
    let (sin_theta, cos_theta) = libm::sincos(theta);
    let (sin_phi, cos_phi) = libm::sincos(TAU * v);
    let across = radius * sin_theta + lip * cos_theta;
    let [x, y, z] = [across * cos_phi, across * sin_phi, radius * cos_theta - lip * sin_theta];
    let (sin_tilt, cos_tilt) = libm::sincos(35.0 / 180.0 * PI);
    [-sin_tilt * x - cos_tilt * z, y, cos_tilt * x - sin_tilt * z + BALL_HEIGHT]
}

/// A car that faces +x on z = 0, 2 long, 0.84 wide: `body` (with pillars and roof), `windows` (single faces
/// for thin glass, facing out), `tyres` and `rims`. `rings` is clamped to 128–2048.
pub fn car_body(rings: u32) -> Vec<Part> {
    let rings = clamp(rings, RINGS);
    let few = rings / 4;
    let hull = closed(rings + rings / 2, 3 * rings, car_hull);
    let roof = closed(rings / 2, rings, |u, v| {
        let ([across, up], [x, y]) = (section(u), superellipse(TAU * v, 2));
        let crown = 0.035 * (1.0 - across * across);
        car_roof([x * across, y * across], CAR_ROOF + 0.012 + 0.01 * up + crown)
    });
    let pillars = [42.0, 92.0, 137.0, 223.0, 268.0, 318.0f64].map(|angle| {
        closed(few, few, move |u, v| {
            let ([across, up], (sin, cos)) = (section(u), libm::sincos(TAU * v));
            let angle = angle / 360.0 + 0.007 * across * cos;
            let [x, y, z] = car_cabin(angle, 0.5 + 0.49 * up);
            let inward = 1.0 - 0.03 * across * sin;
            [(x - CAR_CABIN) * inward + CAR_CABIN, y * inward, z]
        })
    });
    let windows =
        [[-38.0, 38.0], [46.0, 89.0], [95.0, 133.0], [141.0, 219.0], [227.0, 265.0], [271.0, 314.0f64]];
    let windows =
        windows.map(|[from, to]| sheet(few, few, move |u, v| car_cabin(mix(from, to, v) / 360.0, 1.0 - u)));
    let wheels = |profile: &'static [[f64; 2]], spokes: f64| {
        join([[0.6, 0.33], [-0.6, 0.33], [0.6, -0.33], [-0.6, -0.33]].map(|[x, y]: [f64; 2]| {
            closed(rings / 2, rings, move |u, v| {
                let [across, along, out] = revolve(profile, u, v);
                let radius = (across * across + along * along).sqrt();
                let spoke =
                    spokes * step(0.01, 0.05, radius) * step(0.08, 0.06, radius) * libm::cos(5.0 * TAU * v);
                // Turned about x, so that the axle is y, then for the left side about z.
                let side = y.signum();
                [x - side * across, y + side * (out + spoke), WHEEL + along]
            })
        }))
    };
    vec![
        Part { name: "body", mesh: join([hull, roof].into_iter().chain(pillars)) },
        Part { name: "windows", mesh: join(windows) },
        Part { name: "tyres", mesh: wheels(TYRE, 0.0) },
        Part { name: "rims", mesh: wheels(RIM, 0.004) },
    ]
}

/// Radius and distance outwards along the axle.
#[rustfmt::skip]
const TYRE: &[[f64; 2]] = &[
    [0.0, 0.02], [0.05, 0.02], [0.09, 0.02], [0.1, 0.03], [0.102, 0.06], [0.115, 0.065],
    [0.137, 0.06], [0.142, 0.045], [0.142, 0.0], [0.142, -0.045], [0.132, -0.06], [0.1, -0.06],
    [0.05, -0.06], [0.0, -0.06],
];
/// Lies in the tyre's recess.
#[rustfmt::skip]
const RIM: &[[f64; 2]] = &[
    [0.0, 0.046], [0.012, 0.046], [0.02, 0.042], [0.05, 0.046], [0.075, 0.05], [0.085, 0.056],
    [0.092, 0.056], [0.092, 0.035], [0.08, 0.03], [0.05, 0.03], [0.0, 0.03],
];

/// The height of the axles.
const WHEEL: f64 = 0.142;
/// The x coordinate of the middle of the cabin's foot.
const CAR_CABIN: f64 = -0.12;
/// The height of the upper edge of the windows.
const CAR_ROOF: f64 = 0.555;

/// A rounded box's half section: how far from the axis, and how high, both up to 1.
fn section(u: f64) -> [f64; 2] {
    let [up, across] = superellipse(PI * u, 3);
    [across, up]
}

/// Height of the bonnet, waist and boot.
fn car_deck(x: f64) -> f64 {
    0.37 - if x > 0.0 { 0.06 } else { 0.04 } * x * x
}

/// Height of the floor, the sills and the wheel arches.
fn car_underside(x: f64, y: f64) -> f64 {
    let wheel = (x.abs() - 0.6) / 0.17;
    let square = wheel * wheel;
    let arch = WHEEL + 0.16 * (1.0 - 0.5 * square - 0.5 * square * square);
    let floor = 0.09 + 0.05 * libm::pow(x, 8.0);
    mix(floor, norm([arch.max(0.0), floor], 2), step(0.2, 0.25, y.abs()))
}

/// Embedded, because it is two graphs over one outline, the upper above the lower.
fn car_hull(u: f64, v: f64) -> Point {
    let ([across, up], [x, y]) = (section(u), superellipse(TAU * v, 2));
    let x = x * across;
    let y = 0.42 * y * across * (1.0 - 0.1 * x * x * x * x);
    let edge = car_deck(x) - 0.04;
    let below = car_underside(x, y);
    // The cabin is a tub inside the windows, with seats.
    let cabin = norm([(x - CAR_CABIN) / 0.47, y / 0.33], 2);
    let seat =
        |back: f64| 0.16 * bump([norm([(x - back) / 0.08, (y.abs() - 0.16) / 0.12], 2)].map(|q| q * q));
    let tub = norm([0.18 + seat(-0.13) + seat(-0.44), below + 0.03], 4);
    let above = mix(tub, car_deck(x), step(0.8, 1.0, cabin));
    [x, y, edge + if up > 0.0 { above - edge } else { edge - below } * up]
}

/// The roof's outline at (x, y) on the unit superellipse, and inside it.
fn car_roof([x, y]: [f64; 2], z: f64) -> Point {
    [0.3 * x - 0.17, 0.27 * y, z]
}

/// The surface of windows and pillars at an angle in turns and a height from 0, the waist, to 1, the roof.
fn car_cabin(angle: f64, t: f64) -> Point {
    let [x, y] = superellipse(TAU * angle, 2);
    let foot = [0.53 * x + CAR_CABIN, 0.355 * y];
    let roof = car_roof([x, y], CAR_ROOF);
    let bulged = t * (0.7 + 0.3 * t);
    [mix(foot[0], roof[0], bulged), mix(foot[1], roof[1], bulged), mix(car_deck(foot[0]) + 0.002, roof[2], t)]
}

/// A finned ball, for the engine: within 1 % of `triangles`, which is clamped to 10 000–16 000 000.
/// Star-shaped about the origin.
pub fn fine_displaced_sphere(triangles: u32) -> Triangles {
    let (rings, sectors) = fine_grid(clamp(triangles, FINE_TRIANGLES));
    let radius = |[x, y, z]: Point| {
        // The cosines of two and six times the angle about the axis; 0 at the poles, where the ribs have
        // ended.
        let double = (x * x - y * y) / (x * x + y * y).max(f64::MIN_POSITIVE);
        let rib = step(0.7, 0.95, 4.0 * double * double * double - 3.0 * double);
        let fin = step(-0.5, 0.5, libm::sin(40.0 * z));
        let raised = (1.0 - (1.0 - rib) * (1.0 - fin)) * step(0.88, 0.83, z.abs());
        0.9 + 0.1 * raised + 0.0015 * libm::sin(150.0 * x) * libm::sin(150.0 * y)
    };
    closed(rings, sectors, |u, v| star(u, v, radius))
}

/// Rings and sectors, twice as many, that make this number of triangles.
fn fine_grid(triangles: u32) -> (u32, u32) {
    let rings = (f64::from(triangles).sqrt() / 2.0).round() + 1.0;
    let sectors = (f64::from(triangles) / (2.0 * (rings - 1.0))).round();
    (rings as u32, sectors as u32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    fn corners(mesh: &Triangles, triangle: [u32; 3]) -> [Point; 3] {
        triangle.map(|index| mesh.positions[index as usize].map(f64::from))
    }

    fn face_normal([a, b, c]: [Point; 3]) -> Point {
        cross(difference(b, a), difference(c, a))
    }

    /// Six times the volume under the triangle seen from the origin.
    fn determinant([a, b, c]: [Point; 3]) -> f64 {
        dot(a, cross(b, c))
    }

    /// Closed, consistently wound, of the given number of components, each like a sphere and of positive
    /// volume.
    fn check_closed(name: &str, mesh: &Triangles, components: usize) {
        let mut edges = HashMap::new();
        for t in &mesh.corners {
            for k in 0..3 {
                *edges.entry((t[k], t[(k + 1) % 3])).or_insert(0) += 1;
            }
        }
        for (&(a, b), &count) in &edges {
            assert_eq!((count, edges.get(&(b, a))), (1, Some(&1)), "{name}: edge {a} {b}");
        }
        let mut root: Vec<u32> = (0..mesh.positions.len() as u32).collect();
        fn find(root: &mut [u32], mut i: u32) -> u32 {
            while root[i as usize] != i {
                root[i as usize] = root[root[i as usize] as usize];
                i = root[i as usize];
            }
            i
        }
        for t in &mesh.corners {
            for k in 1..3 {
                let (a, b) = (find(&mut root, t[0]), find(&mut root, t[k]));
                root[a as usize] = b;
            }
        }
        // Volume, and vertices − edges + faces.
        let mut sums: HashMap<u32, (f64, i64)> = HashMap::new();
        for i in 0..mesh.positions.len() as u32 {
            sums.entry(find(&mut root, i)).or_default().1 += 1;
        }
        for &t in &mesh.corners {
            let sum = sums.entry(find(&mut root, t[0])).or_default();
            sum.0 += determinant(corners(mesh, t)) / 6.0;
            sum.1 += 1;
        }
        for &(a, b) in edges.keys() {
            if a < b {
                sums.entry(find(&mut root, a)).or_default().1 -= 1;
            }
        }
        assert_eq!(sums.len(), components, "{name}: components");
        for (volume, euler) in sums.into_values() {
            assert_eq!(euler, 2, "{name}: Euler characteristic");
            assert!(volume > 1e-5, "{name}: volume {volume}");
        }
    }

    /// Faces have an area, and normals are units that agree with them.
    fn check_faces(name: &str, mesh: &Triangles) {
        assert_eq!(mesh.positions.len(), mesh.normals.len());
        for p in &mesh.positions {
            assert!(p.iter().all(|x| x.is_finite()), "{name}: {p:?}");
        }
        for n in &mesh.normals {
            let n = n.map(f64::from);
            assert!((dot(n, n) - 1.0).abs() < 3e-7, "{name}: normal {n:?}");
        }
        for &t in &mesh.corners {
            let face = face_normal(corners(mesh, t));
            assert!(dot(face, face) > 0.0, "{name}: no area at {:?}", corners(mesh, t));
            for i in t {
                let n = mesh.normals[i as usize].map(f64::from);
                assert!(
                    dot(face, n) > 0.0,
                    "{name}: normal {n:?} on face {face:?} at {:?}",
                    corners(mesh, t)
                );
            }
        }
    }

    /// All parts of the shapes at some resolutions, each with its number of closed components.
    fn parts() -> Vec<(Part, usize)> {
        let mut parts = Vec::new();
        for (_, shape) in Shape::ALL {
            let resolutions: &[u32] =
                if shape == Shape::FineDisplacedSphere { &[10_000, 100_000] } else { &[128, 201] };
            for &resolution in resolutions {
                for part in shape.build(resolution).unwrap() {
                    let components = match part.name {
                        "windows" => 0,
                        "body" => 8,
                        "tyres" | "rims" => 4,
                        _ => 1,
                    };
                    parts.push((part, components));
                }
            }
        }
        parts
    }

    #[test]
    fn closed_parts_are_closed_oriented_and_spheres() {
        for (part, components) in parts().iter().filter(|(_, components)| *components > 0) {
            check_closed(part.name, &part.mesh, *components);
        }
    }

    #[test]
    fn faces_have_areas_and_normals_agree() {
        for (part, _) in parts() {
            check_faces(part.name, &part.mesh);
        }
    }

    #[test]
    fn star_shaped_meshes_cover_each_direction_once() {
        for mesh in [displaced_sphere(128), displaced_sphere(201), fine_displaced_sphere(100_000)] {
            let mut solid_angle = 0.0;
            for &t in &mesh.corners {
                let c = corners(&mesh, t);
                assert!(determinant(c) > 0.0);
                // Van Oosterom and Strackee, 1983.
                let [a, b, c] = c.map(|p| p.map(|x| x / dot(p, p).sqrt()));
                let below = 1.0 + dot(a, b) + dot(b, c) + dot(c, a);
                solid_angle += 2.0 * libm::atan2(determinant([a, b, c]), below);
            }
            assert!((solid_angle - 4.0 * PI).abs() < 1e-6, "{solid_angle}");
        }
    }

    #[test]
    fn the_statue_has_star_shaped_sections_at_falling_heights() {
        let rings = 300;
        let mesh = statue(rings);
        let mut above = f32::INFINITY;
        for ring in 0..rings - 1 {
            let first = (1 + ring * 2 * rings) as usize;
            let row = &mesh.positions[first..first + 2 * rings as usize];
            for (sector, [x, y, z]) in row.iter().copied().enumerate() {
                assert_eq!(z, row[0][2]);
                let angle = TAU * sector as f64 / f64::from(2 * rings);
                let off = f64::from(y) * libm::cos(angle) - f64::from(x) * libm::sin(angle);
                let along = f64::from(x) * libm::cos(angle) + f64::from(y) * libm::sin(angle);
                assert!(off.abs() < 1e-6 && along > 1e-3, "ring {ring} sector {sector}");
                let outer = mesh.positions[first - (if ring > 0 { 2 * rings as usize } else { 0 }) + sector];
                let shrinks = x.hypot(y) < outer[0].hypot(outer[1]);
                assert!(z < above || (z == 0.0 && above == 0.0 && shrinks), "ring {ring}: {z}");
            }
            above = row[0][2];
        }
        assert_eq!(mesh.positions[mesh.positions.len() - 1], [0.0; 3]);
    }

    /// Whether no two sides of a closed polygon meet.
    fn is_simple(polygon: &[[f64; 2]]) -> bool {
        let n = polygon.len();
        let area = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| {
            (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        };
        (0..n).all(|i| {
            let (a, b) = (polygon[i], polygon[(i + 1) % n]);
            (i + 2..n).filter(|j| (j + 1) % n != i).all(|j| {
                let (c, d) = (polygon[j], polygon[(j + 1) % n]);
                let apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
                apart(0)
                    || apart(1)
                    || area(a, b, c) * area(a, b, d) > 0.0
                    || area(c, d, a) * area(c, d, b) > 0.0
            })
        })
    }

    #[test]
    fn profiles_of_surfaces_of_revolution_are_simple() {
        assert!(!is_simple(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]));
        let rings = 200;
        let mut meshes: Vec<Triangles> = material_ball(rings).into_iter().map(|part| part.mesh).collect();
        meshes.extend([TYRE, RIM].map(|profile| closed(rings, 2 * rings, |u, v| revolve(profile, u, v))));
        for mesh in meshes {
            let at = |ring: u32, sector: u32| 1 + (ring - 1) * 2 * rings + sector;
            let last = mesh.positions.len() as u32 - 1;
            let there = (1..rings).map(|ring| at(ring, 0));
            let back = (1..rings).rev().map(|ring| at(ring, rings));
            let section = [0].into_iter().chain(there).chain([last]).chain(back);
            let section: Vec<[f64; 2]> = section
                .map(|i| mesh.positions[i as usize].map(f64::from))
                .inspect(|p| assert!(p[1].abs() < 1e-6))
                .map(|p| [p[0], p[2]])
                .collect();
            assert!(is_simple(&section));
        }
    }

    #[test]
    fn the_hull_of_the_car_is_two_graphs() {
        for rings in [128, 129] {
            let sectors = 3 * rings;
            let hull = closed(rings, sectors, car_hull);
            let at = |ring: u32, sector: u32| match ring {
                0 => hull.positions[0].map(f64::from),
                _ if ring == rings => hull.positions[hull.positions.len() - 1].map(f64::from),
                _ => hull.positions[(1 + (ring - 1) * sectors + sector % sectors) as usize].map(f64::from),
            };
            let turn = |[a, b, c]: [Point; 3]| face_normal([a, b, c].map(|p| [p[0], p[1], 0.0]))[2];
            for ring in 0..rings / 2 {
                for sector in 0..sectors {
                    let quad =
                        |i: u32, j: u32| [at(i, sector), at(j, sector), at(j, sector + 1), at(i, sector + 1)];
                    let upper = quad(ring, ring + 1);
                    let lower = quad(rings - ring, rings - ring - 1);
                    for i in 0..4 {
                        assert!((upper[i][0] - lower[i][0]).abs() + (upper[i][1] - lower[i][1]).abs() < 1e-6);
                        let equator = rings % 2 == 0 && ring + 1 == rings / 2 && (i == 1 || i == 2);
                        assert!(upper[i][2] - lower[i][2] > 1e-5 || equator, "{:?} {:?}", upper[i], lower[i]);
                    }
                    let [a, b, c, d] = upper;
                    // The sides are so steep that their plan is within rounding of a line.
                    let turns = [turn([a, b, c]), turn([a, b, d]), turn([c, d, a]), turn([c, d, b])];
                    assert!(turns.into_iter().all(|turn| turn > -1e-8), "{turns:?} at {a:?}");
                    // The diagonals cross where 1 − s of the way from a to c is t of the way from b to d.
                    if turns.into_iter().all(|turn| turn > 1e-7) {
                        let s = turn([a, b, d]) / (turn([a, b, d]) + turn([c, d, b]));
                        let t = turn([b, c, a]) / (turn([b, c, a]) + turn([d, a, c]));
                        let below = mix(lower[1][2], lower[3][2], t);
                        assert!(mix(a[2], c[2], s) > below, "at {a:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn parts_do_not_touch() {
        let ball = material_ball(128);
        let distance = |p: &[f32; 3]| {
            let p = p.map(f64::from);
            dot(p, [p[0], p[1], p[2] - 2.0 * BALL_HEIGHT]) + BALL_HEIGHT * BALL_HEIGHT
        };
        let nearest =
            |mesh: &Triangles| mesh.positions.iter().map(distance).fold(f64::INFINITY, f64::min).sqrt();
        assert!(nearest(&ball[0].mesh) > BALL_INNER + 0.09);
        assert!(nearest(&ball[2].mesh) > BALL_OUTER + 0.005, "{}", nearest(&ball[2].mesh));

        let rings = 128;
        let car = car_body(rings);
        let hull = closed(rings + rings / 2, 3 * rings, car_hull).positions.len();
        let roof = closed(rings / 2, rings, |u, v| star(u, v, |_| 1.0)).positions.len();
        let (roof, pillars) = car[0].mesh.positions[hull..].split_at(roof);
        let lowest = roof.iter().fold(f32::INFINITY, |z, p| z.min(p[2]));
        for [x, _, z] in pillars.iter().chain(&car[1].mesh.positions).copied() {
            assert!(f64::from(z) > car_deck(f64::from(x)) && z < lowest, "{x} {z}");
        }
        for [x, y, z] in car[2].mesh.positions.iter().copied() {
            assert!(
                f64::from(z) < car_underside(x.into(), y.into()) - 0.005 || y.abs() > 0.42,
                "{x} {y} {z}"
            );
        }
    }

    #[test]
    fn sizes_are_as_documented() {
        let bounds = |parts: &[Part]| {
            let points = parts.iter().flat_map(|part| &part.mesh.positions);
            points.fold([[f32::INFINITY; 3], [f32::NEG_INFINITY; 3]], |[low, high], p| {
                [core::array::from_fn(|i| low[i].min(p[i])), core::array::from_fn(|i| high[i].max(p[i]))]
            })
        };
        let expected = [
            (Shape::DisplacedSphere, [[-0.89, -0.42, -0.72], [0.48, 0.42, 0.80]]),
            (Shape::Statue, [[-0.56, -0.70, 0.0], [0.56, 0.70, 1.62]]),
            (Shape::MaterialBall, [[-0.7, -0.7, 0.0], [0.7, 0.7, 1.6]]),
            (Shape::CarBody, [[-1.0, -0.42, 0.0], [1.0, 0.42, 0.61]]),
        ];
        for (shape, [low, high]) in expected {
            let [from, to] = bounds(&shape.build(200).unwrap());
            for i in 0..3 {
                assert!((from[i] - low[i]).abs() < 0.01, "{shape:?} {from:?}");
                assert!((to[i] - high[i]).abs() < 0.01, "{shape:?} {to:?}");
            }
            assert!(low[2] != 0.0 || from[2].abs() < 1e-6, "{shape:?} stands at {}", from[2]);
        }
        for p in fine_displaced_sphere(50_000).positions {
            assert!((0.89..1.01).contains(&dot(p.map(f64::from), p.map(f64::from)).sqrt()));
        }
    }

    #[test]
    fn numbers_of_triangles() {
        let count = |parts: Vec<Part>| parts.iter().map(|part| part.mesh.corners.len()).collect::<Vec<_>>();
        assert_eq!(count(Shape::DisplacedSphere.build(128).unwrap()), [4 * 128 * 127]);
        assert_eq!(count(Shape::Statue.build(129).unwrap()), [4 * 129 * 128]);
        assert_eq!(count(Shape::MaterialBall.build(128).unwrap()), [4 * 128 * 127; 3]);
        let body = 6 * 128 * 191 + 2 * 128 * 63 + 6 * 2 * 32 * 31;
        assert_eq!(count(car_body(128)), [body, 6 * 2 * 32 * 32, 4 * 2 * 128 * 63, 4 * 2 * 128 * 63]);
        // Out of range is clamped.
        assert_eq!(statue(0), statue(128));
        for target in [10_000, 12_345, 99_999, 1_000_000, 7_840_000, 16_000_000] {
            let (rings, sectors) = fine_grid(target);
            let made = 2 * (rings - 1) * sectors;
            assert!(made.abs_diff(target) <= target / 100, "{made} for {target}");
            if target < 100_000 {
                assert_eq!(fine_displaced_sphere(target).corners.len(), made as usize);
            }
        }
    }

    #[test]
    fn the_bits_depend_on_nothing() {
        let all = || [128, 20_000].map(|r| Shape::ALL.map(|(_, shape)| shape.build(r)));
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let bits = |parts: &[Part]| {
            let numbers = parts.iter().flat_map(|part| part.mesh.positions.iter().chain(&part.mesh.normals));
            // FNV-1a, by words.
            let hash =
                |hash: u64, word: f32| (hash ^ u64::from(word.to_bits())).wrapping_mul(0x100_0000_01b3);
            numbers.flatten().fold(0xcbf2_9ce4_8422_2325, |sum, &x| hash(sum, x))
        };
        let one = pool(1).install(all);
        assert!(one == pool(3).install(all) && one == all());
        let hashes: Vec<u64> = one.iter().flatten().flatten().map(|parts| bits(parts)).collect();
        assert_eq!(hashes, HASHES);
    }

    /// Of positions and normals with 128 rings, and 20 000 triangles, computed on x86-64.
    const HASHES: [u64; 5] = [
        4348896439195869735,
        4636121012166689677,
        7362847620080345111,
        6456989417421485892,
        4072249789017398398,
    ];

    #[test]
    fn names_and_ranges() {
        for (name, shape) in Shape::ALL {
            assert_eq!(Shape::from_name(name), Ok(shape));
            assert_eq!(shape.name(), name);
            let (_, range) = shape.resolution();
            assert!(shape.build(range.start() - 1).is_err() && shape.build(range.end() + 1).is_err());
        }
        let message = Shape::from_name("bunny").unwrap_err().to_string();
        assert!(message.contains("`bunny`") && message.contains("material_ball, car_body"), "{message}");
        let message = Shape::Statue.build(7).unwrap_err().to_string();
        assert_eq!(message, "`statue` cannot have 7 rings: the range is 128 to 2048");
    }
}

//! Triangle meshes from files: Wavefront OBJ and PLY.
//!
//! Both are read whole, and nothing is allocated from what a file claims, only from what it holds. Faces of
//! more than three corners are split into triangles: as the fan of their first corner where that is right, as
//! it is for every convex face, and by cutting off ears where it is not. Only a face that is not convex and
//! has more than 256 corners keeps the fan, with a warning. Triangles without area, in double precision, are
//! removed, with a warning.

mod obj;
mod ply;

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use rayon::prelude::*;

pub use obj::read as read_obj;
pub use ply::read as read_ply;

use super::mesh::Triangles;

/// Triangles as a file has them, vertices shared.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    /// Where the vertices are; finite.
    pub positions: Vec<[f32; 3]>,
    /// One per position, or none at all; finite, but of any length, as in the file.
    pub normals: Vec<[f32; 3]>,
    /// Three positions each, in the order of the file.
    pub triangles: Vec<[u32; 3]>,
    /// Triangles by material, in order, without gaps; one unnamed group where the file names none. A material
    /// that the file takes up again has another group.
    pub groups: Vec<Group>,
    /// `.mtl` files that an OBJ names, relative to its folder.
    pub material_libraries: Vec<String>,
}

/// Consecutive triangles of one material.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Group {
    /// The name of the material, if the file gives one.
    pub material: Option<String>,
    /// The triangles.
    pub triangles: Range<usize>,
}

impl MeshData {
    /// The triangles of each material; groups of one material are one.
    pub fn parts(self) -> Vec<(Option<String>, Triangles)> {
        let mut parts: Vec<(Option<String>, Vec<[u32; 3]>)> = Vec::new();
        for Group { material, triangles } in self.groups {
            let corners = self.triangles.get(triangles).unwrap_or_default();
            match parts.iter_mut().find(|(name, _)| *name == material) {
                Some((_, known)) => known.extend(corners),
                None => parts.push((material, corners.to_vec())),
            }
        }
        if let [(_, corners)] = parts.as_mut_slice() {
            let (corners, positions) = (core::mem::take(corners), self.positions);
            let name = parts.swap_remove(0).0;
            return vec![(name, Triangles { positions, normals: self.normals, corners })];
        }
        let of_part = |corners: Vec<[u32; 3]>| {
            let mut places = std::collections::HashMap::new();
            let mut part = Triangles::default();
            for corners in corners {
                part.corners.push(corners.map(|index| {
                    *places.entry(index).or_insert_with(|| {
                        part.positions.push(self.positions[index as usize]);
                        part.normals.extend(self.normals.get(index as usize));
                        part.positions.len() as u32 - 1
                    })
                }));
            }
            part
        };
        parts.into_iter().map(|(name, corners)| (name, of_part(corners))).collect()
    }
}

/// A file that is not a mesh: where, and what is wrong.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}{problem}", location(.file.as_deref(), .place))]
pub struct MeshError {
    /// The file, if it was read from one.
    pub file: Option<PathBuf>,
    /// Where in the file.
    pub place: Place,
    /// What is wrong.
    pub problem: Problem,
}

/// A place in a mesh file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The whole of it.
    File,
    /// A line, from 1.
    Line(u64),
    /// An element of a PLY, such as a face, from 0.
    Element(String, u64),
}

/// What is wrong with a mesh file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// It cannot be read.
    #[error("{0}")]
    Unreadable(String),
    /// Its extension is of no format that is known.
    #[error("the extension is {0}; expected `obj` or `ply`")]
    UnknownExtension(String),
    /// No triangle has an area.
    #[error("the mesh is empty; expected at least one face with an area")]
    Empty,
    /// A text or value that should be something else: what it is for, what it is, and what is expected.
    #[error("{0} is {1}; expected {2}")]
    Unexpected(&'static str, String, String),
    /// Too few corners of a face.
    #[error("a face has {0} corners; expected 3 or more")]
    TooFewCorners(u64),
    /// Too many vertices.
    #[error("there are {0} vertices or normals; expected {MOST_VERTICES} at most")]
    TooMany(u64),
    /// The header of a PLY claims more than there can be: of what, how many, and the bytes that are left for
    /// it.
    #[error("the header claims {1} of `{0}`, for which {2} bytes are too few")]
    Claim(String, u64, usize),
    /// A PLY ends within its data.
    #[error("the file ends here; the header claims more")]
    Truncated,
    /// The header of a PLY lacks something.
    #[error("the header has no {0}")]
    Missing(&'static str),
}

impl Problem {
    fn at(self, place: Place) -> MeshError {
        MeshError { file: None, place, problem: self }
    }
}

/// How messages begin: `mesh.obj:12: ` as of a compiler, or `line 12: ` where there is no file.
fn location(file: Option<&Path>, place: &Place) -> String {
    let file = file.map(|file| file.display().to_string());
    match (file, place) {
        (None, Place::File) => String::new(),
        (Some(file), Place::File) => format!("{file}: "),
        (Some(file), Place::Line(line)) => format!("{file}:{line}: "),
        (None, place) => format!("{place}: "),
        (Some(file), place) => format!("{file}: {place}: "),
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File => write!(f, "file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Element(name, index) => write!(f, "{name} {index} (from 0)"),
        }
    }
}

/// Vertices at most, so that an index and twice an index fit 32 bits.
const MOST_VERTICES: usize = (u32::MAX / 2) as usize;

/// Corners at most of a face whose ears are cut off; the time of that grows with their third power.
const MOST_EARS: usize = 256;

/// Reads a mesh from an `.obj` or a `.ply` file, with warnings.
///
/// # Errors
///
/// When the file cannot be read, is of neither format, or is not valid.
pub fn read(path: &Path) -> Result<(MeshData, Vec<String>), MeshError> {
    let in_file = |error: MeshError| MeshError { file: Some(path.to_owned()), ..error };
    let extension = path.extension().unwrap_or_default().to_string_lossy().into_owned();
    let parse = match extension.to_ascii_lowercase().as_str() {
        "obj" => read_obj,
        "ply" => read_ply,
        _ => return Err(in_file(Problem::UnknownExtension(quoted(extension.as_bytes())).at(Place::File))),
    };
    let bytes = std::fs::read(path)
        .map_err(|error| in_file(Problem::Unreadable(error.to_string()).at(Place::File)))?;
    parse(&bytes).map_err(in_file)
}

/// Splits off the next word, a number that is rounded correctly; `what` it is for.
fn coordinate(what: &'static str, text: &mut &[u8]) -> Result<f32, Problem> {
    let start = text.trim_ascii_start();
    let ends = |length: usize| start.get(length).is_none_or(u8::is_ascii_whitespace);
    match fast_float2::parse_partial::<f32, _>(start) {
        Ok((number, length)) if ends(length) => {
            *text = &start[length..];
            finite(what, number, || quoted(&start[..length]))
        }
        _ => Err(Problem::Unexpected(what, quoted(word(&mut &start[..])), "a number".to_owned())),
    }
}

/// A coordinate, which must be finite; `shown` is what stands in the file.
fn finite(what: &'static str, number: f32, shown: impl FnOnce() -> String) -> Result<f32, Problem> {
    if number.is_finite() {
        return Ok(number);
    }
    Err(Problem::Unexpected(what, shown(), "a number that is finite in single precision".to_owned()))
}

/// A text for a message, which may be a whole file without spaces.
fn quoted(text: &[u8]) -> String {
    match text.get(..60) {
        Some(start) => format!("`{}…`", lossy(start)),
        None if text.is_empty() => "missing".to_owned(),
        None => format!("`{}`", lossy(text)),
    }
}

/// A text for a message or a name, whatever its bytes.
fn lossy(text: &[u8]) -> String {
    String::from_utf8_lossy(text).into_owned()
}

/// Splits off the next word, which is empty at the end.
fn word<'a>(text: &mut &'a [u8]) -> &'a [u8] {
    let trimmed = text.trim_ascii_start();
    let end = trimmed.iter().position(u8::is_ascii_whitespace).unwrap_or(trimmed.len());
    let (word, rest) = trimmed.split_at(end);
    *text = rest;
    word
}

/// Faces as triangles: until [`Faces::finish`], each is the fan of its first corner.
#[derive(Debug, Default)]
struct Faces {
    triangles: Vec<[u32; 3]>,
    /// First triangle and number of corners of each face of more than three.
    polygons: Vec<(usize, usize)>,
    /// Triangles without area, as numbered before they were removed.
    removed: Vec<usize>,
    /// Triangles that were not.
    kept: usize,
    /// Faces that are not convex and too large to cut off their ears.
    unsplit: usize,
}

impl Faces {
    /// Adds a face of three corners or more.
    fn push(&mut self, corners: &[u32]) {
        if corners.len() > 3 {
            self.polygons.push((self.triangles.len(), corners.len()));
        }
        self.triangles.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
    }

    /// The face, from 0, that a triangle of before the removal belongs to.
    fn face_of(&self, triangle: usize) -> usize {
        let before = self.polygons.iter().take_while(|&&(start, _)| start < triangle);
        triangle - before.map(|&(start, corners)| (triangle - start).min(corners - 3)).sum::<usize>()
    }

    /// Splits faces that are not convex anew and removes triangles without area.
    fn finish(&mut self, positions: &[[f32; 3]]) {
        for &(start, count) in &self.polygons {
            let fan = &mut self.triangles[start..start + count - 2];
            let corners: Vec<u32> =
                fan[0].into_iter().chain(fan[1..].iter().map(|triangle| triangle[2])).collect();
            let points: Vec<[f64; 3]> =
                corners.iter().map(|&i| positions[i as usize].map(f64::from)).collect();
            match split(&points) {
                Split::Fan => {}
                Split::TooLarge => self.unsplit += 1,
                Split::Ears(ears) => {
                    for (triangle, ear) in fan.iter_mut().zip(ears) {
                        *triangle = ear.map(|corner| corners[corner]);
                    }
                }
            }
        }
        let mut index = 0;
        self.triangles.retain(|triangle| {
            let corners = triangle.map(|i| positions[i as usize].map(f64::from));
            let has_area = area(corners) != [0.0; 3];
            if !has_area {
                self.removed.push(index);
            }
            index += 1;
            has_area
        });
        self.kept = self.triangles.len();
    }

    /// Where a triangle of before the removal stands now.
    fn now(&self, triangle: usize) -> usize {
        triangle - self.removed.partition_point(|&removed| removed < triangle)
    }
}

/// How to split a face into triangles.
enum Split {
    /// As the fan of its first corner.
    Fan,
    /// Into these triangles of its corners.
    Ears(Vec<[usize; 3]>),
    /// Not as a fan, but it is too large.
    TooLarge,
}

/// Splits a face. A fan is right if all its triangles turn the same way as the face.
fn split(points: &[[f64; 3]]) -> Split {
    let count = points.len();
    let fan = (2..count).map(|i| area([points[0], points[i - 1], points[i]]));
    let normal =
        fan.clone().fold([0.0; 3], |sum, area| [sum[0] + area[0], sum[1] + area[1], sum[2] + area[2]]);
    let turns = |corners: [usize; 3]| dot(area(corners.map(|corner| points[corner])), normal);
    if fan.clone().all(|area| dot(area, normal) > 0.0) {
        return Split::Fan;
    }
    if count > MOST_EARS {
        return Split::TooLarge;
    }
    let mut left: Vec<usize> = (0..count).collect();
    let mut ears = Vec::with_capacity(count - 2);
    while left.len() > 3 {
        let size = left.len();
        let corners = |i: usize| [left[(i + size - 1) % size], left[i], left[(i + 1) % size]];
        // An ear turns the way of the face and has no other corner inside; around a hole, corners stand
        // twice.
        let is_ear = |&i: &usize| {
            let [a, b, c] = corners(i);
            let inside = |&p: &usize| {
                ![a, b, c].map(|corner| points[corner]).contains(&points[p])
                    && [[a, b, p], [b, c, p], [c, a, p]].into_iter().all(|side| turns(side) >= 0.0)
            };
            turns([a, b, c]) > 0.0 && !left.iter().any(inside)
        };
        // A face that crosses itself, or has no area, may have none.
        let ear = (0..size).find(is_ear).unwrap_or(1);
        ears.push(corners(ear));
        left.remove(ear);
    }
    ears.push([left[0], left[1], left[2]]);
    Split::Ears(ears)
}

/// Twice the area of a triangle along its normal.
fn area([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let [u, v] = [b, c].map(|p| [p[0] - a[0], p[1] - a[1], p[2] - a[2]]);
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Finishes the faces of all parts of a file and joins them, with warnings. `place` is where a face of a part
/// stands.
fn join(
    positions: &[[f32; 3]],
    parts: &mut [Faces],
    place: impl Fn(usize, usize) -> Place,
) -> Result<(Vec<[u32; 3]>, Vec<String>), MeshError> {
    parts.par_iter_mut().for_each(|part| part.finish(positions));
    let mut warnings = Vec::new();
    let removed: usize = parts.iter().map(|part| part.removed.len()).sum();
    let first =
        parts.iter().enumerate().find_map(|(i, part)| Some((i, part.face_of(*part.removed.first()?))));
    if let Some((part, face)) = first {
        warnings.push(format!(
            "triangles without area are left out: {removed}, the first at {}",
            place(part, face)
        ));
    }
    let unsplit: usize = parts.iter().map(|part| part.unsplit).sum();
    if unsplit > 0 {
        let what = format!("faces of more than {MOST_EARS} corners that are not convex");
        warnings.push(format!("{what} are split as if they were: {unsplit}"));
    }
    let mut triangles = Vec::with_capacity(parts.iter().map(|part| part.triangles.len()).sum());
    for part in parts {
        triangles.append(&mut std::mem::take(&mut part.triangles));
    }
    if triangles.is_empty() {
        return Err(Problem::Empty.at(Place::File));
    }
    Ok((triangles, warnings))
}

#[cfg(test)]
mod tests {
    use rand::{RngExt as _, SeedableRng as _};

    use super::*;

    /// Files with a few bytes changed, left out, doubled or exchanged for ones that mean something.
    pub(super) fn mutated(file: &[u8], count: usize) -> impl Iterator<Item = Vec<u8>> {
        let mut random = rand_pcg::Pcg32::seed_from_u64(1);
        (0..count).map(move |_| {
            let mut bytes = file.to_vec();
            for _ in 0..random.random_range(1..4) {
                let at = random.random_range(0..bytes.len());
                match random.random_range(0..5) {
                    0 => bytes[at] = random.random(),
                    1 => bytes.truncate(at.max(1)),
                    2 => bytes.insert(at, bytes[at]),
                    3 => drop(bytes.drain(at..bytes.len().min(at + 3))),
                    _ => bytes[at] = b"0123456789-./\\ \n\r#vfe"[random.random_range(0..21)],
                }
                if bytes.is_empty() {
                    bytes.push(b'v');
                }
            }
            bytes
        })
    }

    fn faces(polygons: &[&[u32]]) -> Faces {
        let mut faces = Faces::default();
        polygons.iter().for_each(|corners| faces.push(corners));
        faces
    }

    fn total_area(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> f64 {
        let size = |triangle: &[u32; 3]| {
            let area = area(triangle.map(|i| positions[i as usize].map(f64::from)));
            dot(area, area).sqrt() / 2.0
        };
        triangles.iter().map(size).sum()
    }

    #[test]
    fn faces_that_are_not_convex_keep_their_area() {
        // An L, a star, an arrow and a square with a hole, from each of their corners and both ways round.
        let l = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let star = (0..10).map(|i| {
            let (angle, radius) =
                (f64::from(i) * 0.2 * std::f64::consts::PI, if i % 2 == 0 { 2.0 } else { 0.5 });
            [(radius * angle.cos()) as f32, (radius * angle.sin()) as f32]
        });
        let star_area = 10.0 * 0.5 * 2.0 * 0.5 * (0.2 * std::f64::consts::PI).sin();
        let arrow = vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
        let (outer, inner) = ([[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0]], [[1.0, 1.0], [1.0, 2.0]]);
        let hole = [&outer[..], &outer[..1], &inner, &[[2.0, 2.0], [2.0, 1.0]], &inner[..1]].concat();
        for (corners, expected) in [(l, 3.0), (star.collect(), star_area), (arrow, 1.0), (hole, 8.0)] {
            let positions: Vec<[f32; 3]> = corners.iter().map(|&[x, y]| [x, 3.0, y]).collect();
            let mut order: Vec<u32> = (0..positions.len() as u32).collect();
            for turn in 0..2 * order.len() {
                if turn == order.len() {
                    order.reverse();
                }
                order.rotate_left(1);
                let mut faces = faces(&[&order]);
                faces.finish(&positions);
                assert!(faces.removed.is_empty(), "{order:?}");
                assert_eq!(faces.triangles.len(), order.len() - 2);
                let sum = total_area(&positions, &faces.triangles);
                assert!((sum - expected).abs() < 1e-6, "{sum} {expected} {order:?}");
            }
        }
    }

    #[test]
    fn corners_on_an_edge_cost_nothing() {
        let positions = [[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        let mut faces = faces(&[&[0, 1, 2, 3, 4]]);
        faces.finish(&positions);
        assert_eq!(faces.triangles.len(), 3);
        assert_eq!(total_area(&positions, &faces.triangles), 4.0);
    }

    #[test]
    fn large_faces_that_are_not_convex_are_named() {
        let positions: Vec<[f32; 3]> = (0..300)
            .map(|i| {
                let (angle, radius) = (i as f32 / 300.0 * std::f32::consts::TAU, (1 + i % 2) as f32);
                [radius * angle.cos(), radius * angle.sin(), 0.0]
            })
            .collect();
        let corners: Vec<u32> = (0..300).collect();
        let (triangles, warnings) = join(&positions, &mut [faces(&[&corners])], |_, _| Place::File).unwrap();
        assert_eq!(triangles.len(), 298);
        assert_eq!(
            warnings,
            ["faces of more than 256 corners that are not convex are split as if they were: 1"]
        );
        let round: Vec<u32> = (0..300).step_by(2).chain([298]).collect();
        let convex: Vec<u32> = round[..150].to_vec();
        assert_eq!(join(&positions, &mut [faces(&[&convex])], |_, _| Place::File).unwrap().1, [""; 0]);
    }

    #[test]
    fn faces_are_found_from_triangles() {
        let faces = faces(&[&[0, 1, 2], &[0, 1, 2, 3, 4], &[0, 1, 2], &[0, 1, 2, 3], &[0, 1, 2]]);
        let found: Vec<usize> = (0..faces.triangles.len()).map(|triangle| faces.face_of(triangle)).collect();
        assert_eq!(found, [0, 1, 1, 1, 2, 3, 3, 4]);
    }

    #[test]
    fn coordinates_are_rounded_once() {
        // Just above the middle of two numbers, which rounding to double precision first would lose.
        let text = "1.000000059604644775390625000000000000000001";
        assert_eq!(coordinate("x", &mut text.as_bytes()), Ok(1.0 + f32::EPSILON));
        assert_eq!(text.parse::<f64>().unwrap() as f32, 1.0);
        let mut random = rand_pcg::Pcg32::seed_from_u64(2);
        for _ in 0..100_000 {
            let text = format!("{:e}", f32::from_bits(random.random()));
            let expected: f32 = text.parse().unwrap();
            assert_eq!(
                coordinate("x", &mut text.as_bytes()).ok(),
                Some(expected).filter(|number| number.is_finite())
            );
        }
    }

    #[test]
    fn files_are_told_by_their_extension() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.OBJ");
        std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3").unwrap();
        assert_eq!(read(&path).unwrap().0.triangles, [[0, 1, 2]]);
        std::fs::write(&path, "v 0 0 x").unwrap();
        let message = |path: &Path| read(path).unwrap_err().to_string();
        assert!(message(&path).ends_with("a.OBJ:1: a coordinate of `v` is `x`; expected a number"));
        let ply = folder.path().join("b.ply");
        std::fs::write(&ply, "v 0 0 x").unwrap();
        assert!(message(&ply).ends_with("b.ply:1: the first line is `v 0 0 x`; expected `ply`"));
        assert_eq!(message(Path::new("c.stl")), "c.stl: the extension is `stl`; expected `obj` or `ply`");
        assert_eq!(message(Path::new("c")), "c: the extension is missing; expected `obj` or `ply`");
        assert!(message(Path::new("/no/such.ply")).starts_with("/no/such.ply: "));
    }
}

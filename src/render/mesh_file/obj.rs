//! Wavefront OBJ.

use std::borrow::Cow;

use rayon::prelude::*;

use super::{
    Faces, Group, MOST_VERTICES, MeshData, MeshError, Place, Problem, coordinate, join, lossy, quoted, word,
};

/// Bytes of a chunk of lines: many chunks for each thread, each large against what is kept of it.
const CHUNK: usize = 4 << 20;

/// Reads a Wavefront OBJ, with warnings.
///
/// Read are `v`, `vn`, `f`, `usemtl` and `mtllib`. Texture coordinates only have their indices checked; names
/// of objects and groups, smoothing, points and lines are passed over; other statements too, with a warning.
/// A line that ends in `\` goes on in the next. Indices count from 1, or backwards from the last if negative;
/// they may point to vertices that follow. A vertex is a pair of position and normal; normals are left out,
/// with a warning, if only some faces have them.
///
/// # Errors
///
/// When a number, an index or a face is not valid, or the mesh is empty or too large.
pub fn read(bytes: &[u8]) -> Result<(MeshData, Vec<String>), MeshError> {
    read_in_chunks(bytes, CHUNK)
}

fn read_in_chunks(bytes: &[u8], size: usize) -> Result<(MeshData, Vec<String>), MeshError> {
    let mut chunks = chunks(bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), size);
    let total = count(&mut chunks)?;
    let mut positions = vec![[0.0; 3]; total.positions];
    let mut normals = vec![[0.0; 3]; total.normals];
    let parts = parse(&chunks, &total, &mut positions, &mut normals)?;
    let (mut parts, mut faces): (Vec<Part>, Vec<Faces>) = parts.into_iter().unzip();

    let mut warnings = warnings(&parts);
    let has_normals = parts.iter().all(|part| part.without_normal.is_none());
    if !has_normals || parts.iter().all(|part| part.with_normal.is_none()) {
        normals = Vec::new();
    } else if parts.iter().any(|part| part.normals.is_some()) {
        (positions, normals) = unify(&positions, &normals, &mut parts, &mut faces);
    } else {
        // Each position goes with the normal of the same index; those without a partner belong to no face.
        let count = positions.len().min(normals.len());
        positions.truncate(count);
        normals.truncate(count);
    }
    let place = |part: usize, face| Place::Line(line_of_face(&chunks[part], face));
    let (triangles, joined) = join(&positions, &mut faces, place)?;
    warnings.extend(joined);
    let groups = groups(&parts, &faces, triangles.len());
    let material_libraries = parts.into_iter().flat_map(|part| part.libraries).collect();
    Ok((MeshData { positions, normals, triangles, groups, material_libraries }, warnings))
}

/// How many lines, vertices and such there are, or are before something.
#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    lines: u64,
    positions: usize,
    normals: usize,
    textures: usize,
}

/// Whole lines of the file, and what comes before them.
#[derive(Debug)]
struct Chunk<'a> {
    text: &'a [u8],
    before: Counts,
    here: Counts,
}

impl<'a> Chunk<'a> {
    fn lines(&self) -> Lines<'a> {
        Lines { rest: self.text, next: self.before.lines + 1 }
    }
}

/// Splits a file at ends of lines that do not go on.
fn chunks(mut text: &[u8], size: usize) -> Vec<Chunk<'_>> {
    let mut chunks = Vec::new();
    while !text.is_empty() {
        let from = size.min(text.len());
        let end = memchr::memchr_iter(b'\n', &text[from..]).map(|end| from + end);
        let end = end.filter(|&end| !goes_on(&text[..end])).map(|end| end + 1).next().unwrap_or(text.len());
        let (chunk, rest) = text.split_at(end);
        chunks.push(Chunk { text: chunk, before: Counts::default(), here: Counts::default() });
        text = rest;
    }
    chunks
}

/// Whether a line, with or without its carriage return, goes on in the next.
fn goes_on(line: &[u8]) -> bool {
    line.strip_suffix(b"\r").unwrap_or(line).ends_with(b"\\")
}

/// Lines with their numbers, lines that go on joined.
struct Lines<'a> {
    rest: &'a [u8],
    next: u64,
}

impl<'a> Lines<'a> {
    /// A line as it stands in the file.
    fn physical(&mut self) -> &'a [u8] {
        let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        self.next += 1;
        line.strip_suffix(b"\r").unwrap_or(line)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = (u64, Cow<'a, [u8]>);

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let number = self.next;
        let mut line = self.physical();
        if !goes_on(line) {
            return Some((number, Cow::Borrowed(line)));
        }
        let mut joined = Vec::new();
        while let Some(start) = line.strip_suffix(b"\\") {
            joined.extend_from_slice(start);
            joined.push(b' ');
            line = self.physical();
        }
        joined.extend_from_slice(line);
        Some((number, Cow::Owned(joined)))
    }
}

/// Counts what each chunk has, and so what comes before it; returns the sums.
fn count(chunks: &mut [Chunk<'_>]) -> Result<Counts, MeshError> {
    chunks.par_iter_mut().for_each(|chunk| {
        let mut lines = chunk.lines();
        for (_, line) in lines.by_ref() {
            match word(&mut &line[..]) {
                b"v" => chunk.here.positions += 1,
                b"vn" => chunk.here.normals += 1,
                b"vt" => chunk.here.textures += 1,
                _ => {}
            }
        }
        chunk.here.lines = lines.next - 1;
    });
    let mut total = Counts::default();
    for chunk in chunks {
        chunk.before = total;
        total.lines += chunk.here.lines;
        total.positions += chunk.here.positions;
        total.normals += chunk.here.normals;
        total.textures += chunk.here.textures;
    }
    match total.positions.max(total.normals) {
        many if many > MOST_VERTICES => Err(Problem::TooMany(many as u64).at(Place::File)),
        _ => Ok(total),
    }
}

/// What a chunk says besides its vertices and faces.
#[derive(Debug, Default)]
struct Part {
    /// Indices of the normals of the triangles, once one differs from that of the position.
    normals: Option<Vec<[u32; 3]>>,
    /// The first line of a face whose corners have normals, and of one where a corner has none.
    with_normal: Option<u64>,
    without_normal: Option<u64>,
    /// The first triangle of each material.
    materials: Vec<(usize, String)>,
    libraries: Vec<String>,
    /// Statements that are not known, and the first of them.
    unknown: usize,
    first_unknown: Option<(u64, String)>,
}

/// Parses the chunks; vertices go where they belong.
fn parse(
    chunks: &[Chunk<'_>],
    total: &Counts,
    mut positions: &mut [[f32; 3]],
    mut normals: &mut [[f32; 3]],
) -> Result<Vec<(Part, Faces)>, MeshError> {
    let mut jobs = Vec::with_capacity(chunks.len());
    for chunk in chunks {
        let positions = positions.split_off_mut(..chunk.here.positions).unwrap_or_default();
        let normals = normals.split_off_mut(..chunk.here.normals).unwrap_or_default();
        jobs.push((chunk, positions, normals));
    }
    let parse = |(chunk, positions, normals)| parse_chunk(chunk, total, positions, normals);
    let parts: Vec<_> = jobs.into_par_iter().map(parse).collect();
    // Of several errors the first in the file, not the first in time.
    parts.into_iter().collect()
}

fn parse_chunk(
    chunk: &Chunk<'_>,
    total: &Counts,
    positions: &mut [[f32; 3]],
    normals: &mut [[f32; 3]],
) -> Result<(Part, Faces), MeshError> {
    let (mut part, mut faces, mut face) = (Part::default(), Faces::default(), Face::default());
    let mut so_far = chunk.before;
    let (mut positions, mut normals) = (positions.iter_mut(), normals.iter_mut());
    for (number, line) in chunk.lines() {
        let mut rest = &line[..];
        let at = |problem: Problem| problem.at(Place::Line(number));
        match word(&mut rest) {
            b"v" => {
                let position = vector("a coordinate of `v`", rest).map_err(at)?;
                positions.next().into_iter().for_each(|slot| *slot = position);
                so_far.positions += 1;
            }
            b"vn" => {
                let normal = vector("a coordinate of `vn`", rest).map_err(at)?;
                normals.next().into_iter().for_each(|slot| *slot = normal);
                so_far.normals += 1;
            }
            b"vt" => so_far.textures += 1,
            b"f" => {
                face.read(rest, &so_far, total).map_err(at)?;
                part.push_normals(&face, number, &faces);
                faces.push(&face.positions);
            }
            b"usemtl" => part.materials.push((faces.triangles.len(), lossy(rest.trim_ascii()))),
            b"mtllib" => part.libraries.extend(libraries(rest)),
            b"" | b"o" | b"g" | b"s" | b"l" | b"p" => {}
            comment if comment.starts_with(b"#") => {}
            other => {
                part.unknown += 1;
                part.first_unknown.get_or_insert_with(|| (number, quoted(other)));
            }
        }
    }
    Ok((part, faces))
}

/// The three numbers of a `v` or `vn`; a weight or a colour may follow.
fn vector(what: &'static str, mut text: &[u8]) -> Result<[f32; 3], Problem> {
    let mut vector = [0.0; 3];
    for number in &mut vector {
        *number = coordinate(what, &mut text)?;
    }
    loop {
        text = text.trim_ascii_start();
        if text.is_empty() || text.starts_with(b"#") {
            return Ok(vector);
        }
        coordinate(what, &mut text)?;
    }
}

/// The names after `mtllib`: several may stand there, and each may have spaces, so they are told by their
/// ends.
fn libraries(text: &[u8]) -> Vec<String> {
    let text = lossy(text.trim_ascii());
    let mut names = vec![String::new()];
    for piece in text.split_inclusive(char::is_whitespace) {
        if let Some(name) = names.last_mut() {
            name.push_str(piece);
        }
        if piece.trim_end().to_ascii_lowercase().ends_with(".mtl") {
            names.push(String::new());
        }
    }
    names.into_iter().map(|name| name.trim().to_owned()).filter(|name| !name.is_empty()).collect()
}

/// The corners of a face, from 0.
#[derive(Debug, Default)]
struct Face {
    positions: Vec<u32>,
    /// As many as there are positions, unless some corner has none.
    normals: Vec<u32>,
}

impl Face {
    fn read(&mut self, mut text: &[u8], so_far: &Counts, total: &Counts) -> Result<(), Problem> {
        self.positions.clear();
        self.normals.clear();
        loop {
            text = text.trim_ascii_start();
            if text.is_empty() || text.starts_with(b"#") {
                break;
            }
            let corner = text;
            let bad = |what, expected| Problem::Unexpected(what, quoted(word(&mut &corner[..])), expected);
            let index = |rest: &mut &[u8], what, so_far, total| {
                let expected = || format!("an index from 1 to {total}, or from -{so_far} to -1");
                index(rest, so_far, total).ok_or_else(|| bad(what, expected()))
            };
            let position = index(&mut text, "the vertex of a corner", so_far.positions, total.positions)?;
            self.positions.push(position);
            if let Some(rest) = text.strip_prefix(b"/") {
                text = rest;
                if !matches!(text.first(), None | Some(b'/' | b' ' | b'\t')) {
                    index(&mut text, "the texture coordinate of a corner", so_far.textures, total.textures)?;
                }
            }
            if let Some(rest) = text.strip_prefix(b"/") {
                text = rest;
                self.normals.push(index(&mut text, "the normal of a corner", so_far.normals, total.normals)?);
            }
            if text.first().is_some_and(|byte| !byte.is_ascii_whitespace()) {
                return Err(bad("a corner", "`v`, `v/vt`, `v//vn` or `v/vt/vn`".to_owned()));
            }
        }
        match self.positions.len() {
            count @ ..3 => Err(Problem::TooFewCorners(count as u64)),
            _ => Ok(()),
        }
    }
}

/// Splits off an index and counts it from 0.
fn index(text: &mut &[u8], so_far: usize, total: usize) -> Option<u32> {
    let digits = text.strip_prefix(b"-").unwrap_or(text);
    let backwards = digits.len() < text.len();
    let (mut value, mut length) = (0_usize, 0);
    while let Some(digit @ b'0'..=b'9') = digits.get(length) {
        value = value.wrapping_mul(10).wrapping_add(usize::from(digit - b'0'));
        length += 1;
    }
    *text = &digits[length..];
    // More digits would have wrapped.
    if value == 0 || length > 18 {
        return None;
    }
    let index = if backwards { so_far.checked_sub(value)? } else { value - 1 };
    (index < total).then_some(index as u32)
}

impl Part {
    /// Notes the normals of a face, before the face itself is added.
    fn push_normals(&mut self, face: &Face, line: u64, faces: &Faces) {
        if face.normals.len() != face.positions.len() {
            self.without_normal.get_or_insert(line);
            return;
        }
        self.with_normal.get_or_insert(line);
        if self.normals.is_none() && face.normals != face.positions {
            self.normals = Some(faces.triangles.clone());
        }
        if let Some(normals) = &mut self.normals {
            let corners = &face.normals;
            normals.extend(corners[1..].windows(2).map(|pair| [corners[0], pair[0], pair[1]]));
        }
    }
}

/// Makes each pair of a position and a normal a vertex, ordered by position and then by normal.
fn unify(
    positions: &[[f32; 3]],
    normals: &[[f32; 3]],
    parts: &mut [Part],
    faces: &mut [Faces],
) -> (Vec<[f32; 3]>, Vec<[f32; 3]>) {
    let pair = |position: u32, normal: u32| u64::from(position) << 32 | u64::from(normal);
    let pairs = parts.par_iter_mut().zip(&mut *faces).map(|(part, faces)| {
        let normals = part.normals.get_or_insert_with(|| faces.triangles.clone());
        let corners = faces.triangles.as_flattened().iter().zip(normals.as_flattened());
        let mut pairs: Vec<u64> = corners.map(|(&position, &normal)| pair(position, normal)).collect();
        pairs.sort_unstable();
        pairs.dedup();
        pairs
    });
    let mut pairs: Vec<u64> = pairs.flatten_iter().collect();
    pairs.par_sort_unstable();
    pairs.dedup();
    // The pairs of each position stand together, so that only those need to be searched.
    let mut starts = vec![0_u32; positions.len() + 1];
    pairs.iter().for_each(|pair| starts[(pair >> 32) as usize + 1] += 1);
    (1..starts.len()).for_each(|i| starts[i] += starts[i - 1]);
    parts.par_iter_mut().zip(faces).for_each(|(part, faces)| {
        let normals = part.normals.take().unwrap_or_default();
        let corners = faces.triangles.as_flattened_mut().iter_mut().zip(normals.as_flattened());
        for (corner, &normal) in corners {
            let [start, end] = [0, 1].map(|next| starts[*corner as usize + next] as usize);
            let among = pairs[start..end].partition_point(|&other| other < pair(*corner, normal));
            *corner = (start + among) as u32;
        }
    });
    let vertices =
        pairs.par_iter().map(|pair| (positions[(pair >> 32) as usize], normals[*pair as u32 as usize]));
    vertices.unzip()
}

fn warnings(parts: &[Part]) -> Vec<String> {
    let mut warnings = Vec::new();
    let with = parts.iter().find_map(|part| part.with_normal);
    if let (Some(with), Some(without)) = (with, parts.iter().find_map(|part| part.without_normal)) {
        let which = format!("line {with} has normals, that of line {without} has not");
        warnings.push(format!("the normals are left out, as only some faces have them: that of {which}"));
    }
    if let Some((line, name)) = parts.iter().find_map(|part| part.first_unknown.as_ref()) {
        let count: usize = parts.iter().map(|part| part.unknown).sum();
        warnings.push(format!("statements that are not read: {count}, the first {name} at line {line}"));
    }
    warnings
}

/// The line of a face of a chunk, from 0.
fn line_of_face(chunk: &Chunk<'_>, face: usize) -> u64 {
    let mut lines = chunk.lines().filter(|(_, line)| word(&mut &line[..]) == b"f");
    lines.nth(face).map_or(chunk.before.lines + 1, |(number, _)| number)
}

/// Runs of triangles of the same material.
fn groups(parts: &[Part], faces: &[Faces], total: usize) -> Vec<Group> {
    let mut groups = vec![Group { material: None, triangles: 0..total }];
    let mut before = 0;
    for (part, faces) in parts.iter().zip(faces) {
        for (triangle, material) in &part.materials {
            let start = before + faces.now(*triangle);
            if let Some(last) = groups.last_mut() {
                last.triangles.end = start;
            }
            groups.push(Group { material: Some(material.clone()), triangles: start..total });
        }
        before += faces.kept;
    }
    groups.retain(|group| !group.triangles.is_empty());
    groups.dedup_by(|next, group| {
        let same = next.material == group.material;
        if same {
            group.triangles.end = next.triangles.end;
        }
        same
    });
    groups
}

#[cfg(test)]
mod tests {
    use super::super::tests::mutated;
    use super::*;

    /// Five vertices, of which 1, 2, 5, 3 are a square and 4 is above the first.
    const VERTICES: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\n";

    fn mesh(text: &str) -> MeshData {
        let (mesh, warnings) = read(text.as_bytes()).unwrap();
        assert_eq!(warnings, Vec::<String>::new());
        mesh
    }

    fn message(text: &str) -> String {
        read(format!("{VERTICES}{text}").as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn the_syntax_is_read() {
        let plain = mesh(&format!("{VERTICES}f 1 2 3\nf 1 2 5 3\n"));
        assert_eq!(plain.positions.len(), 5);
        assert_eq!(plain.positions[4], [1.0, 1.0, 0.0]);
        assert_eq!(plain.triangles, [[0, 1, 2], [0, 1, 4], [0, 4, 2]]);
        assert_eq!(plain.groups, [Group { material: None, triangles: 0..3 }]);
        assert!(plain.normals.is_empty());
        for same in [
            format!("\u{feff}# a\n\n{VERTICES}f 1 2 3 # b\nf 1 2 5 3"),
            format!("{VERTICES}f 1 2 3\nf 1 2 5 3\n").replace('\n', "\r\n"),
            format!("{VERTICES}f -5 -4 -3\nf 1 -4 5 -3\n"),
            format!("f 1 2 3\nf 1 2 5 3\n{VERTICES}"),
            format!("{VERTICES}  f\t1  2 3 \nf 1 2\\\n5 \\\r\n3\n"),
            format!("o a\ng b c\ns 1\n{VERTICES}l 1 2\np 1\nf 1 2 3\nf 1 2 5 3\n"),
            format!("{VERTICES}vt 0 0\nvt 1 1\nf 1/1 2/2 3/-1\nf 1/1 2/1 5/1 3/1\n"),
            format!("{VERTICES}vn 0 0 1\nf 1 2 3\nf 1 2 5 3\n"),
            format!("{VERTICES}f 1/ 2/ 3/\nf 1/ 2/ 5/ 3/\n"),
            VERTICES.replace(" 1 0 0", " +1.0 0e5 -.0 1 0.5 0.5") + "f 1 2 3\nf 1 2 5 3\n\\",
        ] {
            assert_eq!(mesh(&same), plain, "{same}");
        }
    }

    #[test]
    fn a_line_that_goes_on_is_one_line() {
        let text = "v 0 0 \\\nv\nf";
        assert!(
            read(text.as_bytes()).unwrap_err().to_string().starts_with("line 1: a coordinate of `v` is `v`")
        );
        let split = format!("{VERTICES}f 1 \\\n\\\n2 3\nf 1 2 9");
        assert!(read(split.as_bytes()).unwrap_err().to_string().starts_with("line 9: the vertex"));
    }

    #[test]
    fn vertices_are_pairs_of_position_and_normal() {
        // The common case keeps the order of the file and what no face uses, as far as there are both.
        let same = mesh(&format!("{VERTICES}{}f 1//1 2//2 3//-3\n", VERTICES.replace('v', "vn")));
        assert_eq!(same.triangles, [[0, 1, 2]]);
        assert_eq!(same.normals, same.positions);
        assert_eq!(same.normals.len(), 5);
        let fewer = mesh(&format!("{VERTICES}vn 0 0 1\nvn 0 1 0\nvn 1 0 0\nf 1//1 2//2 3//3\n"));
        assert_eq!((fewer.positions.len(), fewer.normals.len()), (3, 3));

        let text = format!("{VERTICES}vn 0 0 1\nvn 1 0 0\nf 2//2 3//2 1//2\nf 2//1 3//2 5//1\n");
        let pairs = mesh(&text);
        assert_eq!(pairs.triangles, [[2, 3, 0], [1, 3, 4]]);
        let [o, x, y, xy] = [0, 1, 2, 4].map(|i| same.positions[i]);
        assert_eq!(pairs.positions, [o, x, x, y, xy]);
        let [z, x] = [[0.0, 0.0, 1.0], x];
        assert_eq!(pairs.normals, [x, z, x, x, z]);
        let textured = text.replace("//", "/1/").replace("f 2", "vt 0 0\nf 2");
        assert_eq!(mesh(&textured), pairs);

        let (some, warnings) =
            read(format!("{VERTICES}vn 0 0 1\nf 1 2 3\nf 1//1 2//1 3//1\n").as_bytes()).unwrap();
        assert!(some.normals.is_empty());
        assert_eq!(some.positions.len(), 5);
        assert_eq!(warnings.len(), 1);
        assert!(warnings[0].ends_with("that of line 8 has normals, that of line 7 has not"), "{warnings:?}");
    }

    #[test]
    fn materials_are_groups() {
        let text = format!(
            "mtllib a.mtl my b.MTL\t c.mtl rest\n{VERTICES}f 1 2 3\nusemtl red \nf 1 1 2\nusemtl a b\n\
             f 1 2 5 3\nf 1 1 2\nusemtl a b\nf 1 2 4\nusemtl red\nf 1 2 4\nusemtl last\nmtllib d.mtl\n"
        );
        for size in 1..text.len() {
            let (mesh, warnings) = read_in_chunks(text.as_bytes(), size).unwrap();
            assert_eq!(warnings, ["triangles without area are left out: 2, the first at line 9"]);
            assert_eq!(mesh.material_libraries, ["a.mtl", "my b.MTL", "c.mtl", "rest", "d.mtl"]);
            let group = |material: Option<&str>, triangles| Group {
                material: material.map(str::to_owned),
                triangles,
            };
            assert_eq!(mesh.groups, [group(None, 0..1), group(Some("a b"), 1..4), group(Some("red"), 4..5)]);
        }
    }

    #[test]
    fn bad_lines_are_named() {
        let expected = "expected an index from 1 to 5, or from -5 to -1";
        for corner in
            ["0", "6", "-6", "99999999999999999999", "18446744073709551617", "", "-", "x", "/1", "1.5"]
        {
            let error = message(&format!("# remark\nf 1 2 {corner}\n"));
            match corner {
                "" => assert_eq!(error, "line 7: a face has 2 corners; expected 3 or more"),
                "1.5" => {
                    assert_eq!(
                        error,
                        "line 7: a corner is `1.5`; expected `v`, `v/vt`, `v//vn` or `v/vt/vn`"
                    );
                }
                _ => assert_eq!(error, format!("line 7: the vertex of a corner is `{corner}`; {expected}")),
            }
        }
        assert_eq!(
            message("vn 0 0 1\nf 1//1 2//2 3//1\n"),
            "line 7: the normal of a corner is `2//2`; expected an index from 1 to 1, or from -1 to -1"
        );
        assert!(message("f 1//-1 2//1 3//1\nvn 0 0 1\n").contains("or from -0 to -1"));
        assert!(
            message("vt 0\nf 1/2 2/1 3/1\n").contains("line 7: the texture coordinate of a corner is `1/2`")
        );
        assert!(message("f 1// 2 3").contains("the normal of a corner is `1//`"));
        assert!(message("vt 0\nvn 0 0 1\nf 1/1/1/1 2 3").contains("a corner is `1/1/1/1`"));
        assert!(message("f").contains("a face has 0 corners"));
        let finite = "expected a number that is finite in single precision";
        for number in ["nan", "inf", "-inf", "1e39", "-4e38"] {
            assert_eq!(
                message(&format!("v 0 {number} 0\n")),
                format!("line 6: a coordinate of `v` is `{number}`; {finite}")
            );
        }
        for number in ["1x", "--1", "0x1", "1e", "1,5", "#"] {
            let error = message(&format!("vn 0 {number} 0\n"));
            assert_eq!(error, format!("line 6: a coordinate of `vn` is `{number}`; expected a number"));
        }
        assert_eq!(message("v 1 2"), "line 6: a coordinate of `v` is missing; expected a number");
        assert_eq!(message("v 1 2 3 x"), "line 6: a coordinate of `v` is `x`; expected a number");
        assert_eq!(message(""), "the mesh is empty; expected at least one face with an area");
        assert_eq!(read(b"").unwrap_err().problem, Problem::Empty);
        // The first error of the file, whatever the chunks.
        let two = format!("{VERTICES}f 1 2 3\nf 1 2 7\n{}f 1 2 8\n", "f 1 2 3\n".repeat(100));
        for size in 1..200 {
            assert!(
                read_in_chunks(two.as_bytes(), size).unwrap_err().to_string().contains("line 7: the vertex")
            );
        }
    }

    #[test]
    fn statements_that_are_not_read_are_counted() {
        let text = format!("{VERTICES}cstype bezier\nf 1 2 3\nsurf 0 1 0 1 1 2 3 4\n");
        let (_, warnings) = read(text.as_bytes()).unwrap();
        assert_eq!(warnings, ["statements that are not read: 2, the first `cstype` at line 6"]);
    }

    /// A sphere with other normals at every third vertex, quadrilaterals, relative indices and materials.
    fn sphere(n: usize) -> String {
        let mut text = String::from("mtllib sphere.mtl\n");
        for i in 0..=n {
            for j in 0..n {
                let (theta, phi) = ((i as f64 + 0.5) / (n as f64 + 1.0) * 3.1, j as f64 / n as f64 * 6.2);
                let [x, y, z] = [theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos()];
                text += &format!("v {x:.6} {y:.7} {z:e}\nvn {x:.3} {y} {z:.1}\nvt 0 0\n");
            }
        }
        for i in 0..n {
            text += &format!("usemtl {}\n", i / 3);
            for j in 0..n {
                let k = (j + 1) % n;
                let [a, b, c, d] =
                    [i * n + j, (i + 1) * n + j, (i + 1) * n + k, i * n + k].map(|corner| corner + 1);
                let back = d as i64 - 1 - ((n + 1) * n) as i64;
                let other = if a % 3 == 0 { 1 } else { a };
                text += &format!("f {a}/1/{other} {b}/2/{b} {c}//{c} {back}/-1/{d}\n");
            }
        }
        text
    }

    #[test]
    fn threads_and_chunks_do_not_matter() {
        let text = sphere(24);
        let whole = read_in_chunks(text.as_bytes(), usize::MAX).unwrap();
        assert_eq!(whole.0.triangles.len(), 2 * 24 * 24);
        assert_eq!(whole.0.groups.len(), 8);
        for threads in [1, 2, 7] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            for size in [1, 10, 100, 1000, 12345] {
                assert_eq!(pool.install(|| read_in_chunks(text.as_bytes(), size)).unwrap(), whole);
            }
        }
    }

    #[test]
    fn tobj_reads_the_same() {
        let text = sphere(24);
        let (mesh, _) = read_in_chunks(text.as_bytes(), 1000).unwrap();
        let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &tobj::GPU_LOAD_OPTIONS, |_| {
            tobj::load_mtl_buf(&mut &b""[..])
        })
        .unwrap();
        // It makes a model of each material.
        let corners = models.iter().flat_map(|model| {
            let at = |values: &[f32], i: usize| [0, 1, 2].map(|axis| values[3 * i + axis]);
            let of =
                move |&i: &u32| (at(&model.mesh.positions, i as usize), at(&model.mesh.normals, i as usize));
            model.mesh.indices.iter().map(of)
        });
        let ours = mesh
            .triangles
            .as_flattened()
            .iter()
            .map(|&i| (mesh.positions[i as usize], mesh.normals[i as usize]));
        assert_eq!(ours.collect::<Vec<_>>(), corners.collect::<Vec<_>>());
    }

    #[test]
    fn no_bytes_panic() {
        let text = format!(
            "usemtl a\nmtllib b.mtl\n{VERTICES}vn 0 0 1\nvn 1 0 0\nf 1//1 2//2 \\\n5//1 -3//-1\nf 1 2 4\n"
        );
        let read = |bytes: Vec<u8>| {
            let whole = read_in_chunks(&bytes, usize::MAX);
            assert_eq!(read_in_chunks(&bytes, 7), whole, "{}", lossy(&bytes));
            whole.is_ok()
        };
        let valid = mutated(text.as_bytes(), 20_000).filter(|bytes| read(bytes.clone())).count();
        assert!(valid > 1000, "{valid}");
    }
}

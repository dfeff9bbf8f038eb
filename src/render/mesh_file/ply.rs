//! PLY, as text and binary.

use super::{
    Faces, Group, MOST_VERTICES, MeshData, MeshError, Place, Problem, coordinate, finite, join, lossy,
    quoted, word,
};

/// Reads a PLY, with warnings.
///
/// Read are `x`, `y`, `z` and, if there are all three, `nx`, `ny`, `nz` of the element `vertex`, and
/// `vertex_indices` or `vertex_index` of the element `face`; other properties and elements are passed over.
/// In a file of text each vertex and face has its line.
///
/// # Errors
///
/// When the header, a number, an index or a face is not valid, or the mesh is empty or too large.
pub fn read(bytes: &[u8]) -> Result<(MeshData, Vec<String>), MeshError> {
    let mut data = Data { format: Format::Text, rest: bytes, line: b"", number: 0 };
    let elements = read_header(&mut data).map_err(|problem| problem.at(data.place("", 0)))?;
    let mut body = Body::default();
    for element in &elements {
        body.read(element, &elements, &mut data)?;
    }
    let Body { positions, normals, faces } = body;
    let place = |_, face| Place::Element("face".to_owned(), face as u64);
    let (triangles, mut warnings) = join(&positions, &mut [faces], place)?;
    if data.left() > 0 {
        warnings.push(format!("bytes after the last element are left out: {}", data.left()));
    }
    let groups = vec![Group { material: None, triangles: 0..triangles.len() }];
    Ok((MeshData { positions, normals, triangles, groups, material_libraries: Vec::new() }, warnings))
}

/// How the data are written.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Text,
    Binary { is_big: bool },
}

struct Element {
    name: String,
    count: u64,
    properties: Vec<Property>,
}

struct Property {
    role: Role,
    /// Of the length, if it is a list.
    length: Option<Type>,
    value: Type,
}

/// What a property is for.
#[derive(Clone, Copy, PartialEq)]
enum Role {
    /// Of a position, or from the third of a normal.
    Coordinate(usize),
    Corners,
    None,
}

#[derive(Clone, Copy)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn of(name: &[u8]) -> Result<Self, Problem> {
        Ok(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return Err(unexpected("a type", name, "one like `uchar`, `int`, `float` or `float32`")),
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn is_integer(self) -> bool {
        !matches!(self, Self::F32 | Self::F64)
    }
}

fn unexpected(what: &'static str, text: &[u8], expected: &str) -> Problem {
    Problem::Unexpected(what, quoted(text), expected.to_owned())
}

/// Reads the header, and the format into `data`.
fn read_header(data: &mut Data<'_>) -> Result<Vec<Element>, Problem> {
    let first = data.take_line().unwrap_or_default();
    if first != b"ply" {
        return Err(unexpected("the first line", first, "`ply`"));
    }
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    loop {
        let mut line = data.take_line().ok_or(Problem::Missing("end: expected `end_header`"))?;
        match word(&mut line) {
            b"format" => {
                format = Some(match word(&mut line) {
                    b"ascii" => Format::Text,
                    b"binary_little_endian" => Format::Binary { is_big: false },
                    b"binary_big_endian" => Format::Binary { is_big: true },
                    other => {
                        let expected = "`ascii`, `binary_little_endian` or `binary_big_endian`";
                        return Err(unexpected("the format", other, expected));
                    }
                });
            }
            b"element" => {
                let (name, count) = (word(&mut line), word(&mut line));
                if elements.iter().any(|element| element.name.as_bytes() == name) {
                    return Err(unexpected("an element", name, "each name once"));
                }
                let number = integer(count).and_then(|count| u64::try_from(count).ok());
                let bad = || unexpected("the count of an element", count, "a whole number, 0 or more");
                elements.push(Element {
                    name: lossy(name),
                    count: number.ok_or_else(bad)?,
                    properties: Vec::new(),
                });
            }
            b"property" => match elements.last_mut() {
                Some(element) => element.properties.push(Property::read(line, &element.name)?),
                None => return Err(Problem::Missing("`element` before this `property`")),
            },
            b"end_header" => break,
            b"" | b"comment" | b"obj_info" => {}
            other => {
                let expected = "`format`, `element`, `property`, `comment` or `end_header`";
                return Err(unexpected("a line of the header", other, expected));
            }
        }
    }
    let format = format.ok_or(Problem::Missing("`format`"))?;
    let has = |role| elements.iter().any(|element| element.has(role));
    if !(0..3).all(|i| has(Role::Coordinate(i))) {
        return Err(Problem::Missing("properties `x`, `y` and `z` of an element `vertex`"));
    }
    if !has(Role::Corners) {
        return Err(Problem::Missing("list `vertex_indices` of an element `face`"));
    }
    data.format = format;
    Ok(elements)
}

impl Element {
    fn has(&self, role: Role) -> bool {
        self.properties.iter().any(|property| property.role == role)
    }
}

impl Property {
    fn read(mut line: &[u8], element: &str) -> Result<Self, Problem> {
        let first = word(&mut line);
        let length = (first == b"list").then(|| Type::of(word(&mut line))).transpose()?;
        let value = Type::of(if length.is_some() { word(&mut line) } else { first })?;
        let name = word(&mut line);
        let role = match (element, name) {
            ("vertex", b"x") => Role::Coordinate(0),
            ("vertex", b"y") => Role::Coordinate(1),
            ("vertex", b"z") => Role::Coordinate(2),
            ("vertex", b"nx") => Role::Coordinate(3),
            ("vertex", b"ny") => Role::Coordinate(4),
            ("vertex", b"nz") => Role::Coordinate(5),
            ("face", b"vertex_indices" | b"vertex_index") => Role::Corners,
            _ => Role::None,
        };
        let fits = match role {
            Role::Coordinate(_) => length.is_none(),
            Role::Corners => length.is_some() && value.is_integer(),
            Role::None => true,
        };
        if !fits || length.is_some_and(|length| !length.is_integer()) {
            let expected = "a number if it is of a vertex, a list of integers if it is of a face";
            return Err(unexpected("the type of a property", name, expected));
        }
        Ok(Self { role, length, value })
    }
}

/// What is kept of the data.
#[derive(Default)]
struct Body {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    faces: Faces,
}

impl Body {
    fn read(&mut self, element: &Element, all: &[Element], data: &mut Data<'_>) -> Result<(), MeshError> {
        // Without properties there are no data, however many the header claims.
        if element.properties.is_empty() {
            return Ok(());
        }
        let least: u64 = element.properties.iter().map(|property| data.least(property)).sum();
        // The last digit of a text needs no space after it; a byte of binary data that lacks is found later.
        if element.count.checked_mul(least).is_none_or(|least| least > data.left() as u64 + 1) {
            let claim = Problem::Claim(element.name.clone(), element.count, data.left());
            return Err(claim.at(Place::File));
        }
        let is_vertices = |element: &&Element| element.has(Role::Coordinate(0));
        let vertices = all.iter().find(is_vertices).map_or(0, |element| element.count);
        if vertices > MOST_VERTICES as u64 {
            return Err(Problem::TooMany(vertices).at(Place::File));
        }
        let (is_vertex, is_face) = (element.has(Role::Coordinate(0)), element.has(Role::Corners));
        let has_normals = (3..6).all(|i| element.has(Role::Coordinate(i)));
        match element.count as usize {
            count if is_vertex => {
                self.positions.reserve_exact(count);
                self.normals.reserve_exact(if has_normals { count } else { 0 });
            }
            count if is_face => self.faces.triangles.reserve_exact(count),
            _ => {}
        }
        let (mut vector, mut corners) = ([0.0; 6], Vec::new());
        for index in 0..element.count {
            let mut read = || {
                data.begin()?;
                for property in &element.properties {
                    match (property.role, property.length) {
                        (Role::Coordinate(i), _) => vector[i] = data.coordinate(property.value)?,
                        (Role::Corners, Some(length)) => {
                            read_corners(data, length, property.value, vertices, &mut corners)?;
                        }
                        (_, Some(length)) => {
                            let count = data.length(length)?;
                            data.skip(property.value, count)?;
                        }
                        (_, None) => data.skip(property.value, 1)?,
                    }
                }
                data.end()
            };
            read().map_err(|problem| problem.at(data.place(&element.name, index)))?;
            let [x, y, z, nx, ny, nz] = vector;
            if is_vertex {
                self.positions.push([x, y, z]);
            }
            if has_normals {
                self.normals.push([nx, ny, nz]);
            }
            if is_face {
                self.faces.push(&corners);
            }
        }
        Ok(())
    }
}

fn read_corners(
    data: &mut Data<'_>,
    length: Type,
    value: Type,
    vertices: u64,
    corners: &mut Vec<u32>,
) -> Result<(), Problem> {
    corners.clear();
    let count = data.length(length)?;
    if count < 3 {
        return Err(Problem::TooFewCorners(count));
    }
    for _ in 0..count {
        let index = data.integer(value)?;
        if !(0..vertices as i64).contains(&index) {
            let expected = format!("an index from 0, less than {vertices}");
            return Err(Problem::Unexpected("a corner", format!("`{index}`"), expected));
        }
        corners.push(index as u32);
    }
    Ok(())
}

/// The data of a file, value by value.
struct Data<'a> {
    format: Format,
    rest: &'a [u8],
    /// What is left of the latest line of a text, and its number.
    line: &'a [u8],
    number: u64,
}

const COORDINATE: &str = "a coordinate of a vertex";

impl<'a> Data<'a> {
    fn is_text(&self) -> bool {
        self.format == Format::Text
    }

    fn take_line(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        let end = memchr::memchr(b'\n', self.rest).unwrap_or(self.rest.len());
        let line = &self.rest[..end];
        self.rest = self.rest.get(end + 1..).unwrap_or_default();
        self.number += 1;
        Some(line.trim_ascii())
    }

    /// Bytes at least of a property: in a text a digit and a space.
    fn least(&self, property: &Property) -> u64 {
        if self.is_text() { 2 } else { property.length.unwrap_or(property.value).size() as u64 }
    }

    /// Bytes that are left.
    fn left(&self) -> usize {
        if self.is_text() { self.rest.trim_ascii_end().len() } else { self.rest.len() }
    }

    /// Begins an element, which is a line of a text.
    fn begin(&mut self) -> Result<(), Problem> {
        while self.is_text() && self.line.is_empty() {
            self.line = self.take_line().ok_or(Problem::Truncated)?;
        }
        Ok(())
    }

    /// Ends it.
    fn end(&mut self) -> Result<(), Problem> {
        match self.line.trim_ascii() {
            [] => Ok(()),
            more => Err(unexpected("the rest of the line", more, "no more than the header says")),
        }
    }

    /// A coordinate, rounded once.
    fn coordinate(&mut self, value: Type) -> Result<f32, Problem> {
        if self.is_text() {
            return coordinate(COORDINATE, &mut self.line);
        }
        let value = self.binary(value)?;
        finite(COORDINATE, value as f32, || format!("`{value}`"))
    }

    /// A value of an integer type.
    fn integer(&mut self, value: Type) -> Result<i64, Problem> {
        if self.is_text() {
            let text = word(&mut self.line);
            return integer(text).ok_or_else(|| unexpected("an index or a length", text, "a whole number"));
        }
        Ok(self.binary(value)? as i64)
    }

    /// The length of a list.
    fn length(&mut self, value: Type) -> Result<u64, Problem> {
        let length = self.integer(value)?;
        let bad = |_| Problem::Unexpected("a length", format!("`{length}`"), "0 or more".to_owned());
        u64::try_from(length).map_err(bad)
    }

    /// Passes over data.
    fn skip(&mut self, value: Type, count: u64) -> Result<(), Problem> {
        if self.is_text() {
            let is_missing = (0..count).any(|_| word(&mut self.line).is_empty());
            let bad = || unexpected("a value", b"", "as many as the header says");
            return if is_missing { Err(bad()) } else { Ok(()) };
        }
        let bytes = usize::try_from(count).ok().and_then(|count| count.checked_mul(value.size()));
        self.rest = bytes.and_then(|bytes| self.rest.get(bytes..)).ok_or(Problem::Truncated)?;
        Ok(())
    }

    /// A value of binary data; an `f64` holds every type.
    #[inline]
    fn binary(&mut self, value: Type) -> Result<f64, Problem> {
        Ok(match value {
            Type::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Type::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Type::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Type::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Type::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Type::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Type::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Type::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    /// Bytes in little-endian order.
    #[inline]
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], Problem> {
        let (&(mut bytes), rest) = self.rest.split_first_chunk::<N>().ok_or(Problem::Truncated)?;
        self.rest = rest;
        if self.format == (Format::Binary { is_big: true }) {
            bytes.reverse();
        }
        Ok(bytes)
    }

    /// Where the latest stands, an element and its number.
    fn place(&self, element: &str, index: u64) -> Place {
        if self.is_text() { Place::Line(self.number) } else { Place::Element(element.to_owned(), index) }
    }
}

fn integer(text: &[u8]) -> Option<i64> {
    std::str::from_utf8(text).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::super::tests::mutated;
    use super::*;

    fn header(format: &str, vertices: u64, faces: u64) -> String {
        format!(
            "ply\nformat {format} 1.0\ncomment x\nelement vertex {vertices}\nproperty float x\n\
             property double y\nproperty uchar red\nproperty float32 z\nelement face {faces}\n\
             property short flags\nproperty list uchar int vertex_indices\n\
             property list uint16 float uv\nend_header\n"
        )
    }

    fn text(faces: &[&str]) -> String {
        let vertices = "0 0 255 0\n1 0 255 0\n0 1 255 0\n0 0 255 1\n1 1 255 0\n";
        header("ascii", 5, faces.len() as u64) + vertices + &faces.join("\n")
    }

    fn binary(is_big: bool, faces: &[&[i32]]) -> Vec<u8> {
        let name = if is_big { "binary_big_endian" } else { "binary_little_endian" };
        let mut bytes = header(name, 5, faces.len() as u64).into_bytes();
        let mut put = |mut value: Vec<u8>| {
            if is_big {
                value.reverse();
            }
            bytes.extend(value);
        };
        for [x, y, z] in
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 1.0, 0.0_f32]]
        {
            put(x.to_le_bytes().to_vec());
            put(f64::from(y).to_le_bytes().to_vec());
            put(vec![255]);
            put(z.to_le_bytes().to_vec());
        }
        for face in faces {
            put(vec![7, 0]);
            put(vec![face.len() as u8]);
            face.iter().for_each(|index| put(index.to_le_bytes().to_vec()));
            put(2_u16.to_le_bytes().to_vec());
            put(0.5_f32.to_le_bytes().to_vec());
            put(0.5_f32.to_le_bytes().to_vec());
        }
        bytes
    }

    fn message(bytes: &[u8]) -> String {
        read(bytes).unwrap_err().to_string()
    }

    #[test]
    fn the_three_formats_are_the_same() {
        let (mesh, warnings) = read(text(&["7 3 0 1 3 2 .5 .5", "7 4 0 1 4 2 2 .5 .5"]).as_bytes()).unwrap();
        assert_eq!(warnings, Vec::<String>::new());
        assert_eq!(mesh.positions[3..], [[0.0, 0.0, 1.0], [1.0, 1.0, 0.0]]);
        assert_eq!(mesh.triangles, [[0, 1, 3], [0, 1, 4], [0, 4, 2]]);
        assert_eq!(mesh.groups, [Group { material: None, triangles: 0..3 }]);
        assert!(mesh.normals.is_empty());
        for is_big in [false, true] {
            let bytes = binary(is_big, &[&[0, 1, 3], &[0, 1, 4, 2]]);
            assert_eq!(read(&bytes).unwrap(), (mesh.clone(), Vec::new()));
        }
        let carriage = text(&["7 3 0 1 3 2 .5 .5", "7 4 0 1 4 2 2 .5 .5", "", ""]).replace('\n', "\r\n");
        let carriage = carriage.replace("face 4", "face 2");
        assert_eq!(read(carriage.as_bytes()).unwrap(), (mesh, Vec::new()));
    }

    #[test]
    fn every_type_is_read() {
        for (name, bytes) in [
            ("char", &[1_u8][..]),
            ("uint8", &[1]),
            ("short", &[1, 0]),
            ("ushort", &[1, 0]),
            ("int32", &[1, 0, 0, 0]),
            ("uint", &[1, 0, 0, 0]),
        ] {
            let header = format!(
                "ply\nformat binary_little_endian 1.0\nelement nothing 1000000000000\nelement other 2\n\
                 property {name} a\nproperty list {name} {name} b\nelement face 1\n\
                 property list {name} {name} vertex_index\nelement vertex 4\nproperty float x\n\
                 property float y\nproperty float z\nproperty float nx\nproperty float ny\n\
                 property float nz\nend_header\n"
            );
            let zero = vec![0; bytes.len()];
            let with = |value: u8| [&[value], &zero[1..]].concat();
            let mut file =
                [header.into_bytes(), bytes.repeat(6), with(3), with(0), with(1), with(3)].concat();
            for i in 0..4_u8 {
                for value in [f32::from(i), f32::from(i * i), 0.0, 0.0, 0.0, f32::from(i)] {
                    file.extend(value.to_le_bytes());
                }
            }
            let (mesh, _) = read(&file).unwrap();
            assert_eq!(mesh.positions[3], [3.0, 9.0, 0.0], "{name}");
            assert_eq!(mesh.normals[3], [0.0, 0.0, 3.0], "{name}");
            assert_eq!(mesh.triangles, [[0, 1, 3]], "{name}");
        }
    }

    #[test]
    fn bad_data_are_named() {
        let line = |face| message(text(&["7 3 0 1 3 2 .5 .5", face]).as_bytes());
        assert_eq!(
            line("7 3 0 1 5 2 .5 .5"),
            "line 20: a corner is `5`; expected an index from 0, less than 5"
        );
        assert_eq!(line("7 3 0 -1 3 0"), "line 20: a corner is `-1`; expected an index from 0, less than 5");
        assert_eq!(line("7 2 0 1 0"), "line 20: a face has 2 corners; expected 3 or more");
        assert_eq!(line("7 -3 0 1 0"), "line 20: a length is `-3`; expected 0 or more");
        assert_eq!(line("7 3 0 1 x 0"), "line 20: an index or a length is `x`; expected a whole number");
        assert_eq!(line("7 3 0 1"), "line 20: an index or a length is missing; expected a whole number");
        assert_eq!(line("7 3 0 1 3 2 1"), "line 20: a value is missing; expected as many as the header says");
        assert_eq!(
            line("7 3 0 1 3 0 8 9"),
            "line 20: the rest of the line is `8 9`; expected no more than the header says"
        );
        let vertex = |from: &str, to: &str| {
            message(text(&["7 3 0 1 3 0"]).replacen(from, to, 1).as_bytes())
                .replace("a coordinate of a vertex", "it")
        };
        let finite = "expected a number that is finite in single precision";
        assert_eq!(vertex("0 0 255 1", "0 NaN 255 1"), format!("line 17: it is `NaN`; {finite}"));
        assert_eq!(vertex("0 0 255 1", "0 0 255 1e39"), format!("line 17: it is `1e39`; {finite}"));
        assert_eq!(vertex("0 0 255 1", "0 0 255 1x"), "line 17: it is `1x`; expected a number");
        assert_eq!(vertex("0 0 255 1", "0 0 255"), "line 17: it is missing; expected a number");

        for is_big in [false, true] {
            let whole = binary(is_big, &[&[0, 1, 3], &[0, 1, 4, 2]]);
            let corner = message(&binary(is_big, &[&[0, 1, 3], &[0, 1, 9]]));
            assert_eq!(corner, "face 1 (from 0): a corner is `9`; expected an index from 0, less than 5");
            assert_eq!(
                message(&whole[..whole.len() - 1]),
                "face 1 (from 0): the file ends here; the header claims more"
            );
            for length in 0..whole.len() {
                assert!(read(&whole[..length]).is_err(), "{length}");
            }
            let mut infinite = whole.clone();
            let y = header(if is_big { "binary_big_endian" } else { "binary_little_endian" }, 5, 2).len()
                + 17
                + 4;
            let value = if is_big { 1e39_f64.to_be_bytes() } else { 1e39_f64.to_le_bytes() };
            infinite[y..y + 8].copy_from_slice(&value);
            let error = message(&infinite).replace("000000000000000000000000000000000000000", "e39");
            assert_eq!(error, format!("vertex 1 (from 0): a coordinate of a vertex is `1e39`; {finite}"));
            let more = [&whole[..], b"abc"].concat();
            assert_eq!(read(&more).unwrap().1, ["bytes after the last element are left out: 3"]);
        }
    }

    #[test]
    fn claims_are_held_against_the_size() {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            for claim in [1_000_000_000_000, u64::MAX / 2] {
                let error = message(header(format, claim, 1).as_bytes());
                assert!(error.contains(&format!("the header claims {claim} of `vertex`")), "{error}");
            }
        }
        let error = message(text(&["7 3 0 1 3 0"]).replace("face 1", "face 1000000000000").as_bytes());
        assert_eq!(error, "the header claims 1000000000000 of `face`, for which 11 bytes are too few");
        let list = text(&["7 3 0 1 3 1000000000000000"]);
        assert!(message(list.as_bytes()).contains("a value is missing"));
        assert_eq!(
            message(text(&["7 3 0 1 3 0"]).replace("face 1", "face 2").as_bytes()),
            "line 19: the file ends here; the header claims more"
        );
    }

    #[test]
    fn bad_headers_are_named() {
        let change = |from: &str, to: &str| message(text(&["7 3 0 1 3 0"]).replacen(from, to, 1).as_bytes());
        assert_eq!(message(b""), "line 0: the first line is missing; expected `ply`");
        assert_eq!(change("ply", "plx"), "line 1: the first line is `plx`; expected `ply`");
        assert!(change("ascii", "utf8").starts_with("line 2: the format is `utf8`; expected `ascii`, "));
        assert!(change("element", "elements").starts_with("line 4: a line of the header is `elements`"));
        assert!(change("vertex 5", "vertex -5").starts_with("line 4: the count of an element is `-5`"));
        assert!(change("float x", "real x").starts_with("line 5: a type is `real`"));
        assert!(change("float x", "list int float x").starts_with("line 5: the type of a property is `x`"));
        assert!(
            change("uchar int", "float int").starts_with("line 11: the type of a property is `vertex_ind")
        );
        assert!(
            change("element face", "element vertex").contains("an element is `vertex`; expected each name")
        );
        assert!(
            change("element vertex 5\n", "").contains("the header has no `element` before this `property`")
        );
        assert!(change(" y", " why").contains("the header has no properties `x`, `y` and `z`"));
        assert!(change("vertex_indices", "corners").contains("the header has no list `vertex_indices`"));
        assert!(change("format ascii 1.0\n", "").contains("the header has no `format`"));
        assert!(change("end_header\n", "comment\n").starts_with("line 14: a line of the header is `0`"));
        assert!(message(b"ply\nformat ascii 1.0\n").contains("expected `end_header`"));
    }

    #[test]
    fn faces_without_area_are_counted() {
        let (mesh, warnings) =
            read(&binary(false, &[&[0, 1, 4, 2], &[1, 1, 2], &[0, 1, 3], &[0, 3, 0]])).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 4], [0, 4, 2], [0, 1, 3]]);
        assert_eq!(warnings, ["triangles without area are left out: 2, the first at face 1 (from 0)"]);
        assert_eq!(
            message(&binary(false, &[&[1, 1, 2]])),
            "the mesh is empty; expected at least one face with an area"
        );
        assert_eq!(
            message(&binary(false, &[])),
            "the mesh is empty; expected at least one face with an area"
        );
    }

    #[test]
    fn no_bytes_panic() {
        let files = [
            text(&["7 3 0 1 3 0", "7 4 0 1 4 2 0"]).into_bytes(),
            binary(false, &[&[0, 1, 3], &[0, 1, 4, 2]]),
        ];
        let files = files.into_iter().chain([binary(true, &[&[0, 1, 3], &[0, 1, 4, 2]])]);
        for file in files {
            let valid = mutated(&file, 20_000).filter(|bytes| read(bytes).is_ok()).count();
            assert!(valid > 100, "{valid}");
        }
    }
}

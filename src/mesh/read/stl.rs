//! STL, ASCII and binary: triangles without shared vertices, joined here where positions are exactly equal.

use std::collections::HashMap;

use super::{
    Format, Place, ReadError,
    binary::{Bytes, widen},
    faces::Faces,
    text::{Text, float, quoted},
};
use crate::mesh::Mesh;

/// Bytes before a binary file's first triangle: 80 of anything, and the count.
const HEADER: usize = 84;
/// Bytes of a binary triangle: a normal, three positions, two bytes of anything.
const TRIANGLE: usize = 50;

/// Reads an STL file.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, ReadError> {
    let announced = bytes.first_chunk::<HEADER>().map(|header| {
        let [.., a, b, c, d] = *header;
        u32::from_le_bytes([a, b, c, d]) as usize
    });
    // Binary files may begin with "solid" too, so the length decides first.
    let exact = announced.is_some_and(|count| (bytes.len() - HEADER) == count * TRIANGLE);
    if !exact && is_text(bytes) {
        return read_text(Text::new(bytes));
    }
    let Some(announced) = announced else {
        let defect =
            format!("it does not begin with \"solid\", and has {} bytes of the {HEADER} of a header", bytes.len());
        return Err(ReadError::Header { format: Format::Stl, defect });
    };
    read_binary(bytes, announced)
}

/// True for a file whose first word is "solid" and that has "facet" or "endsolid" as the first word of a line near it.
fn is_text(bytes: &[u8]) -> bool {
    const NEAR: usize = 4096;
    let mut text = Text::new(&bytes[..bytes.len().min(NEAR)]);
    if !text.word().is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return false;
    }
    while text.next_line() {
        let word = text.word_on_line().unwrap_or_default();
        if word.eq_ignore_ascii_case(b"facet") || word.eq_ignore_ascii_case(b"endsolid") {
            return true;
        }
    }
    bytes.is_ascii()
}

/// Numbers positions in the order in which they first come; those that are equal share a number.
struct Weld<const BYTES: usize> {
    numbers: HashMap<[[u8; BYTES]; 3], u32>,
    vertices: Vec<[f64; 3]>,
}

impl<const BYTES: usize> Weld<BYTES> {
    fn new() -> Self {
        Self { numbers: HashMap::new(), vertices: Vec::new() }
    }

    /// The number of a position that is equal to others of the same key.
    fn vertex(&mut self, key: [[u8; BYTES]; 3], position: impl FnOnce() -> [f64; 3]) -> u32 {
        let next = self.vertices.len() as u32;
        let number = *self.numbers.entry(key).or_insert(next);
        if number == next {
            self.vertices.push(position());
        }
        number
    }
}

fn read_binary(bytes: &[u8], announced: usize) -> Result<Mesh, ReadError> {
    let mut bytes = Bytes::new(bytes, HEADER, false);
    let held = bytes.left() / TRIANGLE;
    if held < announced {
        return Err(ReadError::Truncated {
            inside: format!("triangle {held} (counted from 0)"),
            place: Place::Byte(bytes.at() + bytes.left()),
            expected: format!("{announced} triangles were announced"),
        });
    }
    let mut weld = Weld::new();
    let mut faces = Faces::default();
    faces.reserve(announced);
    for triangle in 0..announced {
        let mut corners = [0; 3];
        let at = bytes.at();
        let mut record = || {
            bytes.skip(12)?;
            let mut values = [0.0; 9];
            for value in &mut values {
                *value = bytes.f32()?;
            }
            bytes.skip(2)?;
            Some(values)
        };
        // The length was checked above.
        let Some(values) = record() else { break };
        for (corner, position) in corners.iter_mut().zip(values.as_chunks::<3>().0) {
            if let Some(value) = position.iter().find(|value| !value.is_finite()) {
                return Err(not_finite(triangle, Place::Byte(at), f64::from(*value)));
            }
            // Adding 0 makes −0 equal to 0.
            *corner = weld.vertex(position.map(|value| (value + 0.0).to_bits().to_le_bytes()), || position.map(widen));
        }
        faces.push(&corners);
    }
    faces.into_mesh(weld.vertices, 0)
}

fn read_text(mut text: Text<'_>) -> Result<Mesh, ReadError> {
    let mut weld = Weld::new();
    let mut faces = Faces::default();
    let mut polygon = Vec::new();
    let mut solid = false;
    let mut facet = false;
    while let Some(word) = text.word() {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" => {
                solid = true;
                text.rest_of_line();
            }
            b"endsolid" if !facet => {
                solid = false;
                text.rest_of_line();
            }
            b"facet" if !facet => {
                facet = true;
                // A normal may follow, often wrong and sometimes nan: the corners' order says as much.
                let mut after = text;
                if after.word().is_some_and(|word| word.eq_ignore_ascii_case(b"normal")) {
                    text = after;
                    for _ in 0..3 {
                        text.word();
                    }
                }
            }
            b"outer" if facet => {
                text.word();
                polygon.clear();
            }
            b"vertex" if facet => {
                let line = text.line();
                let mut position = [0.0; 3];
                for value in &mut position {
                    let Some(word) = text.word() else { return Err(truncated(&text, &faces)) };
                    *value = float(word).ok_or_else(|| {
                        let found = quoted(word);
                        malformed(text.line(), &faces, &format!("has {found} where a number should be"))
                    })?;
                }
                if let Some(value) = position.into_iter().find(|value| !value.is_finite()) {
                    return Err(not_finite(faces.len(), Place::Line(line), value));
                }
                let key = position.map(|value| (value + 0.0).to_bits().to_le_bytes());
                polygon.push(weld.vertex(key, || position));
            }
            b"endloop" if facet => {
                if polygon.len() < 3 {
                    let corners = polygon.len();
                    return Err(malformed(
                        text.line(),
                        &faces,
                        &format!("has {corners} corners where it should have 3"),
                    ));
                }
                faces.push(&polygon);
            }
            b"endfacet" if facet => facet = false,
            _ => {
                return Err(malformed(text.line(), &faces, &format!("has {} where a keyword should be", quoted(word))));
            }
        }
    }
    if solid { Err(truncated(&text, &faces)) } else { faces.into_mesh(weld.vertices, 0) }
}

fn malformed(line: usize, faces: &Faces, defect: &str) -> ReadError {
    let defect = format!("facet {} (counted from 0) {defect}", faces.len());
    ReadError::Malformed { place: Place::Line(line), defect }
}

fn not_finite(facet: usize, place: Place, value: f64) -> ReadError {
    ReadError::Malformed {
        place,
        defect: format!("facet {facet} (counted from 0) has a coordinate that is not finite: {value}"),
    }
}

fn truncated(text: &Text<'_>, faces: &Faces) -> ReadError {
    ReadError::Truncated {
        inside: format!("facet {} (counted from 0)", faces.len()),
        place: Place::Line(text.line()),
        expected: "endsolid was to follow".to_owned(),
    }
}

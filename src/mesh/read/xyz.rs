//! XYZ: a point a line.
//!
//! Read are: numbers apart by blanks, commas or semicolons, of which the first three are a position and the rest
//! (normals, colours, intensities) are passed over; comments from `#` or `//` on; a count of points alone on the first
//! line, as in PTS files.

use super::{
    Place, ReadError,
    text::{Text, float, integer, quoted},
};
use crate::mesh::Mesh;

/// Reads an XYZ file; the mesh has no triangles.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, ReadError> {
    let mut text = Text::new(bytes);
    let mut points = Vec::new();
    let mut first = true;
    loop {
        let line = text.line();
        let mut words = words(text.rest_of_line());
        if let Some(word) = words.next() {
            let mut after = words.clone();
            if !(std::mem::take(&mut first) && integer(word).is_some_and(|count| count >= 0) && after.next().is_none())
            {
                points.push(point([Some(word), words.next(), words.next()], points.len(), line)?);
            }
        }
        if !text.next_line() {
            return Ok(Mesh::new(points, Vec::new()));
        }
    }
}

/// The words of a line before its comment.
fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> + Clone {
    line.split(|&byte| byte <= b' ' || byte == b',' || byte == b';')
        .filter(|word| !word.is_empty())
        .take_while(|word| !word.starts_with(b"#") && !word.starts_with(b"//"))
}

fn point(words: [Option<&[u8]>; 3], vertex: usize, line: usize) -> Result<[f64; 3], ReadError> {
    let place = Place::Line(line);
    let mut position = [0.0; 3];
    for (coordinate, word) in position.iter_mut().zip(words) {
        let defect = |found: &str| ReadError::Malformed {
            place,
            defect: format!("point {vertex} (counted from 0) has {found} where a number should be"),
        };
        let word = word.ok_or_else(|| defect("nothing"))?;
        *coordinate = float(word).ok_or_else(|| defect(&quoted(word)))?;
        if !coordinate.is_finite() {
            return Err(ReadError::NotFinite { vertex, place, value: coordinate.to_string(), base: 0 });
        }
    }
    Ok(position)
}

//! OFF: Geomview's format, and what other programs take for it.
//!
//! Read are: any of the prefixes `ST`, `C`, `N`, `4` and `n` in any case; `BINARY`; counts on the keyword's own line
//! or glued to it (`OFF490 518 0`); no keyword; no edge count; comments; colours and anything else after a vertex or
//! a face on its line. A vertex or a face may run over several lines if it ends with a line. Where that fails,
//! the whole text is tried as one stream of numbers without colours, as Geomview takes it.

use super::{Format, Place, ReadError, faces::Faces, text::Text};
use crate::mesh::Mesh;

mod binary;
mod header;
mod text;

use header::Header;

/// Reads an OFF file.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, ReadError> {
    let mut text = Text::new(bytes);
    let header = Header::read(&mut text)?;
    if header.binary {
        return binary::read(bytes, bytes.len() - text.left(), header);
    }
    text::read(text, header, text::Layout::Lines).or_else(|error| {
        // The first reading's complaint is the one that fits a file made of lines.
        text::read(text, header, text::Layout::Stream).map_err(|_| error)
    })
}

fn refuse(defect: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Off, defect: defect.into() }
}

fn malformed(line: usize, defect: impl Into<String>) -> ReadError {
    ReadError::Malformed { place: Place::Line(line), defect: defect.into() }
}

/// A homogeneous position in space, or `None` where it is at infinity.
fn divide([x, y, z]: [f64; 3], w: f64) -> Option<[f64; 3]> {
    if w == 1.0 {
        return Some([x, y, z]);
    }
    (w != 0.0).then(|| [x / w, y / w, z / w])
}

/// How many vertices and faces a file says it has.
#[derive(Debug, Clone, Copy)]
struct Counts {
    vertices: usize,
    faces: usize,
}

/// What has been read.
struct Parts {
    vertices: Vec<[f64; 3]>,
    faces: Faces,
}

impl Parts {
    /// Room for what is announced, as far as `left` bytes can hold it.
    fn new(counts: Counts, left: usize) -> Self {
        // The shortest vertex is "0 0 0\n", the shortest face "3 0 1 2\n".
        let mut faces = Faces::default();
        faces.reserve(counts.faces.min(left / 8));
        Self { vertices: Vec::with_capacity(counts.vertices.min(left / 6)), faces }
    }
}

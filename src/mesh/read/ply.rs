//! PLY: ASCII and binary in either byte order, any properties in any order.
//!
//! Of the elements `vertex` (scalars x, y, z of any type), `face` (list `vertex_indices` or `vertex_index`) and
//! `tristrips` (list of the same names; −1 begins a new strip) make the mesh; all others are passed over.

use super::{Format, ReadError, faces::Faces, text::Text};
use crate::mesh::Mesh;

mod ascii;
mod binary;
mod header;

use header::{Element, Encoding, Header, Role};

/// Reads a PLY file.
pub(super) fn read(bytes: &[u8]) -> Result<Mesh, ReadError> {
    let mut text = Text::new(bytes);
    let header = Header::read(&mut text)?;
    let mut parts = Parts::new(&header, text.left());
    match header.encoding {
        Encoding::Ascii => ascii::read(text, &header, &mut parts)?,
        Encoding::Binary { big } => binary::read(bytes, bytes.len() - text.left(), big, &header, &mut parts)?,
    }
    parts.faces.into_mesh(parts.vertices, 0)
}

fn refuse(defect: impl Into<String>) -> ReadError {
    ReadError::Header { format: Format::Ply, defect: defect.into() }
}

/// What has been read.
struct Parts {
    vertices: Vec<[f64; 3]>,
    faces: Faces,
    /// How many vertices are announced; faces may stand before them.
    announced: usize,
    strip: Vec<i64>,
}

impl Parts {
    fn new(header: &Header, left: usize) -> Self {
        let count =
            |role| header.elements.iter().find(|element| element.role == role).map_or(0, |element| element.count);
        let mut faces = Faces::default();
        // The shortest face: a count byte and three of index; the shortest vertex: three bytes.
        faces.reserve(count(Role::Face).min(left / 4));
        let announced = count(Role::Vertex);
        Self { vertices: Vec::with_capacity(announced.min(left / 3)), faces, announced, strip: Vec::new() }
    }

    /// Takes a number of a polygon or strip; an error is the vertex that does not exist.
    #[inline]
    fn corner(&mut self, role: Role, vertex: i64) -> Result<(), i64> {
        if role == Role::Strips {
            if vertex < -1 || vertex >= self.announced as i64 {
                return Err(vertex);
            }
            self.strip.push(vertex);
        } else {
            if vertex < 0 || vertex >= self.announced as i64 {
                return Err(vertex);
            }
            self.faces.corner(vertex as u32);
        }
        Ok(())
    }

    /// Ends a polygon, or cuts strips into triangles of alternating turn.
    #[inline]
    fn close(&mut self, role: Role, arity: usize) {
        if role != Role::Strips {
            self.faces.close(arity as u32);
            return;
        }
        for strip in self.strip.split(|&vertex| vertex < 0) {
            for (i, &[a, b, c]) in strip.array_windows().enumerate() {
                let (a, b, c) = (a as u32, b as u32, c as u32);
                // A vertex named twice in a row turns the strip and makes no triangle.
                if a != b && b != c && c != a {
                    self.faces.push(&if i % 2 == 0 { [a, b, c] } else { [b, a, c] });
                }
            }
        }
        self.strip.clear();
    }
}

/// What is being read, for messages.
fn inside(element: &Element, number: usize) -> String {
    format!("{} {number} (counted from 0)", element.name)
}

//! The triangle mesh as a value, its readers, its checks, its content hash and the procedural shapes.
//!
//! ```text
//! bytes ─► read ─► Mesh ─► survey      (what is wrong with it, and where)
//!                   └────► canonical ─► hash, and everything that is computed
//! ```

pub mod deform;
pub mod synth;
pub mod write;

use std::fmt;

use serde::{Deserialize, Serialize};

pub use self::{
    read::{Format, Place, ReadError, read},
    survey::{Defect, DefectKind, Spot, Survey, survey},
};

pub(crate) mod by_vertex;
mod canonical;
pub(crate) mod halfedge;
mod read;
mod survey;
pub(crate) mod vector;

/// blake3 of a mesh's canonical geometry: equal for the same shape in any file, format and vertex order.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct GeometryHash(pub [u8; 32]);

impl fmt::Display for GeometryHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl fmt::Debug for GeometryHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "GeometryHash({self})")
    }
}

/// An indexed triangle mesh: vertex positions and oriented triangles.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    vertices: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Takes the parts as they are; [`Mesh::triangles`] may name vertices that do not exist.
    #[must_use]
    pub fn new(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> Self {
        Self { vertices, triangles }
    }

    /// Positions, in the file's unit of length.
    #[must_use]
    pub fn vertices(&self) -> &[[f64; 3]] {
        &self.vertices
    }

    /// Triangles as 0-based vertex indices.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The corners of a triangle, or `None` when it names a vertex that does not exist.
    #[must_use]
    pub fn corners(&self, triangle: [u32; 3]) -> Option<[[f64; 3]; 3]> {
        let [a, b, c] = triangle.map(|vertex| self.vertices.get(vertex as usize).copied());
        Some([a?, b?, c?])
    }

    /// The sum of the triangles' areas, in the file's unit squared; triangles that name a missing vertex have none.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.triangles
            .iter()
            .filter_map(|&triangle| self.corners(triangle))
            .map(|[a, b, c]| 0.5 * vector::length(vector::cross(vector::sub(b, a), vector::sub(c, a))))
            // Not `sum`: of nothing it is −0.
            .fold(0.0, |sum, area| sum + area)
    }

    /// The least and the greatest corner of the box around all vertices, used or not; `None` without vertices.
    #[must_use]
    pub fn bounding_box(&self) -> Option<([f64; 3], [f64; 3])> {
        let (first, rest) = self.vertices.split_first()?;
        Some(rest.iter().fold((*first, *first), |(mut least, mut greatest), position| {
            for axis in 0..3 {
                least[axis] = least[axis].min(position[axis]);
                greatest[axis] = greatest[axis].max(position[axis]);
            }
            (least, greatest)
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_and_box_of_a_right_triangle() {
        let mesh = Mesh::new(vec![[0.0, 0.0, 1.0], [3.0, 0.0, 1.0], [0.0, -4.0, 1.0]], vec![[0, 1, 2]]);
        assert_eq!(mesh.area(), 6.0);
        assert_eq!(mesh.bounding_box(), Some(([0.0, -4.0, 1.0], [3.0, 0.0, 1.0])));
        assert_eq!(Mesh::default().bounding_box(), None);
    }

    #[test]
    fn a_triangle_of_missing_vertices_has_no_area() {
        assert_eq!(Mesh::new(vec![[0.0; 3]], vec![[0, 1, 2]]).area().to_bits(), 0);
    }
}

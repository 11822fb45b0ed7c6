//! The triangle mesh as a value, its readers, its checks, its content hash and the procedural shapes.

use std::fmt;

use serde::{Deserialize, Serialize};

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
}

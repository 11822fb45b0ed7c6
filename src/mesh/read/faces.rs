//! Polygons → triangles.

use super::ReadError;
use crate::mesh::Mesh;

mod cutter;
mod ears;

use cutter::Cutter;

/// Polygons of more corners are refused: the time to cut one grows with the square of their number, and is a second
/// here at worst.
pub(super) const MOST_CORNERS: u32 = 10_000;

/// The polygons of a file, their corners one after the other.
#[derive(Debug, Default)]
pub(super) struct Faces {
    corners: Vec<u32>,
    arities: Vec<u32>,
}

impl Faces {
    /// How many polygons there are.
    pub(super) fn len(&self) -> usize {
        self.arities.len()
    }

    /// Makes room for triangles.
    pub(super) fn reserve(&mut self, triangles: usize) {
        self.arities.reserve(triangles);
        self.corners.reserve(3 * triangles);
    }

    /// Adds a corner to the polygon that [`Faces::close`] ends.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Ends the polygon of the last `arity` corners.
    #[inline]
    pub(super) fn close(&mut self, arity: u32) {
        self.arities.push(arity);
    }

    /// Adds a polygon.
    pub(super) fn push(&mut self, polygon: &[u32]) {
        self.corners.extend_from_slice(polygon);
        self.close(polygon.len() as u32);
    }

    /// The mesh of these polygons, which the format counts from `base`. Every corner must be one of `vertices`, and
    /// every position finite.
    ///
    /// # Errors
    /// [`ReadError::TooManyCorners`].
    pub(super) fn into_mesh(self, vertices: Vec<[f64; 3]>, base: u8) -> Result<Mesh, ReadError> {
        let triangles = self.corners.len().saturating_sub(2 * self.arities.len());
        let mut cutter = Cutter::new(&vertices, triangles);
        let mut rest = &self.corners[..];
        for (face, arity) in self.arities.into_iter().enumerate() {
            if arity > MOST_CORNERS {
                return Err(ReadError::TooManyCorners { face: face + usize::from(base), corners: arity, base });
            }
            let (polygon, others) = rest.split_at(arity as usize);
            rest = others;
            match *polygon {
                [a, b, c] => cutter.triangles.push([a, b, c]),
                [] | [_] | [_, _] => {}
                _ => cutter.cut(polygon),
            }
        }
        let triangles = cutter.triangles;
        Ok(Mesh::new(vertices, triangles))
    }
}

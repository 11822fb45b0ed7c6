//! One form for all orders in which a file may list the same vertices and triangles, and its hash.

use super::{GeometryHash, Mesh};
use crate::watch::{Pulse, Stopped, Unwatched};

/// Domain of the geometry hash. Whoever changes the canonical form changes this line.
const CONTEXT: &str = "eigenselect 2026 canonical triangle mesh v1";

impl Mesh {
    /// The same surface, independent of the order in which its file listed it.
    ///
    /// Vertices that no triangle names are left out, unless there are no triangles at all; so are triangles that name
    /// a missing vertex, which no reader lets through. −0 becomes 0; vertices ascend by (x, y, z), vertices at one
    /// position keep their order; each triangle begins at its smallest index and keeps its orientation; triangles
    /// ascend.
    ///
    /// Everything downstream computes on this form, so that meshes of equal [`Mesh::hash`] give the same bits.
    /// Meshes with several vertices at one position may differ in their hash for another order of these vertices:
    /// a shape is then computed twice, never taken for another.
    #[must_use]
    pub fn canonical(&self) -> Self {
        // Nothing stops it.
        self.canonical_watched(&Pulse::new(&Unwatched)).unwrap_or_default()
    }

    /// [`Mesh::canonical`] that ends soon after the watch cancels.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(crate) fn canonical_watched(&self, pulse: &Pulse) -> Result<Self, Stopped> {
        let count = self.vertices.len();
        let mut named = Vec::with_capacity(self.triangles.len());
        for &triangle in &self.triangles {
            pulse.beat(5)?;
            if triangle.iter().all(|&vertex| (vertex as usize) < count) {
                named.push(triangle);
            }
        }
        // Without triangles every vertex is a point of a cloud.
        let mut used = vec![self.triangles.is_empty(); count];
        for vertex in named.iter().flatten() {
            used[*vertex as usize] = true;
        }
        // Adding 0 turns −0 into 0 and changes nothing else.
        let mut order: Vec<([f64; 3], u32)> = (0..)
            .zip(&self.vertices)
            .filter(|&(vertex, _)| used[vertex as usize])
            .map(|(vertex, position)| (position.map(|coordinate| coordinate + 0.0), vertex))
            .collect();
        pulse.beat(20 * count)?;
        pulse.sort(&mut order, &|(a, i), (b, j)| {
            a[0].total_cmp(&b[0])
                .then_with(|| a[1].total_cmp(&b[1]))
                .then_with(|| a[2].total_cmp(&b[2]))
                .then_with(|| i.cmp(j))
        })?;
        let mut place = vec![0u32; count];
        for (new, &(_, old)) in (0..).zip(&order) {
            place[old as usize] = new;
        }
        for triangle in &mut named {
            let [a, b, c] = triangle.map(|vertex| place[vertex as usize]);
            // The least of the three, not the one at the smallest index: a vertex may be named twice.
            *triangle = [a, b, c].min([b, c, a]).min([c, a, b]);
            pulse.beat(10)?;
        }
        pulse.sort(&mut named, &Ord::cmp)?;
        Ok(Self { vertices: order.into_iter().map(|(position, _)| position).collect(), triangles: named })
    }

    /// blake3 of the canonical form: equal for the same shape in another vertex order, face order or file format.
    ///
    /// A format that holds f32 (binary PLY and STL) is read as the shortest decimals of its values (see
    /// [`super::read()`]), so a binary file written from a text file of up to six significant digits has the text
    /// file's hash.
    #[must_use]
    pub fn hash(&self) -> GeometryHash {
        let mesh = self.canonical();
        let mut hasher = blake3::Hasher::new_derive_key(CONTEXT);
        // blake3 is at its best on kilobytes at a time.
        let mut block = Vec::with_capacity(24 * 1024);
        hasher.update(&(mesh.vertices.len() as u64).to_le_bytes());
        for chunk in mesh.vertices.chunks(1024) {
            block.clear();
            block.extend(chunk.iter().flatten().flat_map(|coordinate| coordinate.to_bits().to_le_bytes()));
            hasher.update(&block);
        }
        hasher.update(&(mesh.triangles.len() as u64).to_le_bytes());
        for chunk in mesh.triangles.chunks(2048) {
            block.clear();
            block.extend(chunk.iter().flatten().flat_map(|vertex| vertex.to_le_bytes()));
            hasher.update(&block);
        }
        GeometryHash(*hasher.finalize().as_bytes())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn tetrahedron() -> Mesh {
        Mesh::new(
            vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        )
    }

    #[test]
    fn the_form_is_what_it_says() {
        let mesh = Mesh::new(
            vec![[1.0, 0.0, 0.0], [9.0, 9.0, 9.0], [-0.0, 0.0, 0.0], [0.0, 1.0, -0.0]],
            vec![[3, 0, 2], [2, 3, 0], [7, 0, 2], [2, 0, 0]],
        );
        let cloud = Mesh::new(mesh.vertices.clone(), Vec::new()).canonical();
        assert_eq!(cloud.vertices(), [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [9.0, 9.0, 9.0]]);
        let canonical = mesh.canonical();
        assert_eq!(canonical.vertices(), [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0]]);
        assert!(canonical.vertices().iter().flatten().all(|coordinate| coordinate.is_sign_positive()));
        assert_eq!(canonical.triangles(), [[0, 1, 2], [0, 1, 2], [0, 2, 2]]);
    }

    #[test]
    fn the_hash_sees_geometry_orientation_and_connectivity() {
        let mesh = tetrahedron();
        let mut moved = mesh.clone();
        moved.vertices[0][0] = f64::MIN_POSITIVE;
        let mut turned = mesh.clone();
        turned.triangles[0].swap(0, 1);
        let mut fewer = mesh.clone();
        fewer.triangles.pop();
        for other in [moved, turned, fewer, Mesh::default()] {
            assert_ne!(other.hash(), mesh.hash());
        }
    }

    #[test]
    fn the_hash_does_not_change_between_versions() {
        assert_eq!(
            tetrahedron().hash().to_string(),
            "f668e05a39a611f6371e192c214f2a4d7faa38d0adaac831df26ee2c5c949916"
        );
    }

    proptest! {
        #[test]
        fn order_does_not_matter(
            vertices in Just((0..4usize).collect::<Vec<_>>()).prop_shuffle(),
            triangles in Just((0..4usize).collect::<Vec<_>>()).prop_shuffle(),
            turns in prop::array::uniform4(0..3usize),
            unused in any::<[f64; 3]>(),
        ) {
            let mesh = tetrahedron();
            let mut place = [0u32; 4];
            for (new, &old) in (0..).zip(&vertices) {
                place[old] = new;
            }
            let mut positions: Vec<[f64; 3]> = vertices.iter().map(|&old| mesh.vertices[old]).collect();
            positions.push(unused);
            let turned = triangles
                .iter()
                .map(|&old| {
                    let mut triangle = mesh.triangles[old].map(|vertex| place[vertex as usize]);
                    triangle.rotate_left(turns[old]);
                    triangle
                })
                .collect();
            let other = Mesh::new(positions, turned);
            prop_assert_eq!(other.canonical(), mesh.canonical());
            prop_assert_eq!(other.hash(), mesh.hash());
            prop_assert_eq!(other.canonical().canonical(), mesh.canonical());
        }
    }
}

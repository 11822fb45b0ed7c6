//! One form for all orders in which a file may list the same vertices and triangles, and its hash.

use super::{GeometryHash, Mesh, by_vertex::ByVertex};
use crate::watch::{Pulse, Stopped, Unwatched};

/// Domain of the geometry hash. Whoever changes the canonical form changes this line.
const CONTEXT: &str = "eigenselect 2026 canonical triangle mesh v1";

/// A number for each coordinate that ascends as [`f64::total_cmp`] has them; −0 is 0.
fn rank(coordinate: f64) -> u64 {
    // Adding 0 turns −0 into 0 and changes nothing else.
    let bits = (coordinate + 0.0).to_bits();
    // Of negative numbers all bits are turned, of others the sign.
    bits ^ (((bits as i64 >> 63) as u64) | 1 << 63)
}

/// The triangle from its smallest index on: the least of the three, as a vertex may be named twice.
fn first_least([a, b, c]: [u32; 3]) -> [u32; 3] {
    // As one number each, which takes no guess at which it will be.
    let number = |[a, b, c]: [u32; 3]| u128::from(a) << 64 | u128::from(b) << 32 | u128::from(c);
    let least = number([a, b, c]).min(number([b, c, a])).min(number([c, a, b]));
    [(least >> 64) as u32, (least >> 32) as u32, least as u32]
}

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
        if self.is_canonical(pulse)? {
            return Ok(self.clone());
        }
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
        let kept = (0..).zip(&self.vertices).filter(|&(vertex, _)| used[vertex as usize]);
        let mut order: Vec<(u64, u32)> = kept.map(|(vertex, position)| (rank(position[0]), vertex)).collect();
        pulse.beat(20 * count)?;
        let beside = |vertex: u32| self.vertices[vertex as usize].map(rank);
        pulse.sort(&mut order, &|(a, i), (b, j)| {
            a.cmp(b).then_with(|| beside(*i).cmp(&beside(*j))).then_with(|| i.cmp(j))
        })?;
        let mut place = vec![0u32; count];
        for (new, &(_, old)) in (0..).zip(&order) {
            place[old as usize] = new;
        }
        for triangle in &mut named {
            *triangle = first_least(triangle.map(|vertex| place[vertex as usize]));
            pulse.beat(10)?;
        }
        let named = || named.iter().map(|&triangle| (triangle[0], triangle));
        let mut by_first = ByVertex::new(order.len(), named, pulse)?;
        for list in by_first.lists() {
            pulse.sort(list, &Ord::cmp)?;
        }
        let vertices = order.into_iter().map(|(_, old)| self.vertices[old as usize].map(|coordinate| coordinate + 0.0));
        Ok(Self { vertices: vertices.collect(), triangles: by_first.into_items() })
    }

    /// Whether this is the canonical form already.
    fn is_canonical(&self, pulse: &Pulse) -> Result<bool, Stopped> {
        let mut before = [0; 3];
        for position in &self.vertices {
            pulse.beat(3)?;
            let here = position.map(rank);
            if here < before || position.iter().any(|coordinate| coordinate.to_bits() == (-0.0_f64).to_bits()) {
                return Ok(false);
            }
            before = here;
        }
        let mut used = vec![self.triangles.is_empty(); self.vertices.len()];
        let mut before = [0; 3];
        for &triangle in &self.triangles {
            pulse.beat(5)?;
            let [a, b, c] = triangle;
            if triangle < before || triangle > [b, c, a] || triangle > [c, a, b] {
                return Ok(false);
            }
            before = triangle;
            for vertex in triangle {
                let Some(used) = used.get_mut(vertex as usize) else { return Ok(false) };
                *used = true;
            }
        }
        Ok(used.into_iter().all(|used| used))
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

//! An intrinsic triangulation: triangles that know the lengths of their sides and what these are glued to.
//!
//! Nothing here knows positions. Two corners of a triangle may be one vertex, and two triangles may share more than one
//! edge; neither is a special case.

use super::element::{Element, of_lengths};
use crate::watch::{Pulse, Stopped};

/// No side: a boundary.
pub(super) const NONE: u32 = u32::MAX;

/// How much of the mean edge every triangle is opened where one is too flat (Sharp and Crane 2020, § 4.5): eigenvalues
/// move by about as much, and cotangents stay below some 1e3 times the ratio of edge lengths.
const OPENING: f64 = 1e-6;

/// An edge is Delaunay if the cotangents opposite of it sum to more than minus this part of their size: what rounding
/// alone can make of four vertices on a circle.
const COCIRCULAR: f64 = 1e-10;

/// Flips after which it ends, for each triangle: usually it is one or two.
const MOST_FLIPS: usize = 100;

/// Triangles with sides glued in pairs, all running in opposite directions along what they share.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Glued {
    /// The vertices at the corners, counterclockwise.
    pub corners: Vec<[u32; 3]>,
    /// For each corner the length of the side opposite of it.
    pub lengths: Vec<[f64; 3]>,
    /// For each side, named as 3 · triangle + opposite corner, the side it is glued to, or [`NONE`].
    pub twins: Vec<u32>,
}

/// What flipping to Delaunay came to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Flips {
    /// How many edges were flipped.
    pub count: usize,
    /// It ended because all edges are Delaunay that can be flipped.
    pub complete: bool,
}

impl Glued {
    /// Lengthens all edges by the same, by just so much that every triangle inequality holds with room to spare;
    /// returns how much that is, nothing for a good mesh.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn mollify(&mut self, pulse: &Pulse) -> Result<f64, Stopped> {
        let mut sum = 0.0;
        for lengths in &self.lengths {
            for length in lengths {
                sum += length;
            }
            pulse.beat(4)?;
        }
        // Coordinates extend over one to two: where all triangles are points, any small length does.
        let mean = if sum > 0.0 { sum / (3 * self.lengths.len()) as f64 } else { 1.0 };
        let room = OPENING * mean;
        let mut short = 0.0_f64;
        for &[a, b, c] in &self.lengths {
            short = short.max(room + a - b - c).max(room + b - c - a).max(room + c - a - b);
            pulse.beat(6)?;
        }
        for lengths in self.lengths.iter_mut().take_while(|_| short > 0.0) {
            for length in lengths {
                *length += short;
            }
            pulse.beat(4)?;
        }
        Ok(short)
    }

    /// Flips edges until all are Delaunay (the angles opposite of each sum to at most π).
    ///
    /// It ends. The harmonic index, Σ (a² + b² + c²)/area over the triangles, is least for a Delaunay triangulation,
    /// and a flip is made only if it lowers the sum of the two numbers at hand; the lengths take finitely many values,
    /// so no state comes twice. How long it takes is bounded by a count of flips; what is left then is a triangulation
    /// of the same surface.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn flip_to_delaunay(&mut self, pulse: &Pulse) -> Result<Flips, Stopped> {
        let mut queue: Vec<u32> = (0..self.twins.len() as u32).rev().collect();
        pulse.beat(2 * queue.len())?;
        let mut queued = pulse.filled(true, self.twins.len())?;
        let most = MOST_FLIPS * self.corners.len() + 1000;
        let mut count = 0;
        while let Some(side) = queue.pop() {
            queued[side as usize] = false;
            pulse.beat(50)?;
            let twin = self.twins[side as usize];
            if twin == NONE || twin / 3 == side / 3 || !self.improve(side, twin) {
                continue;
            }
            count += 1;
            if count >= most {
                return Ok(Flips { count, complete: false });
            }
            for triangle in [side / 3, twin / 3] {
                for side in 3 * triangle..3 * triangle + 3 {
                    if !queued[side as usize] {
                        queued[side as usize] = true;
                        queue.push(side);
                    }
                }
            }
        }
        Ok(Flips { count, complete: true })
    }

    /// Flips the edge of two glued sides if it is not Delaunay and the flip lowers the harmonic index.
    fn improve(&mut self, side: u32, twin: u32) -> bool {
        let (t, s) = ((side / 3) as usize, (side % 3) as usize);
        let (u, r) = ((twin / 3) as usize, (twin % 3) as usize);
        let (first, second) = (of_lengths(self.lengths[t]), of_lengths(self.lengths[u]));
        let (x, y) = (first.cotangents[s], second.cotangents[r]);
        let needed = x + y < -COCIRCULAR * (x.abs() + y.abs() + 1.0);
        if !needed {
            return false;
        }
        // The edge from p to q with the corners k before and l behind it, laid out in the plane along the first axis.
        let edge = self.lengths[t][s];
        let (qk, kp) = (self.lengths[t][(s + 1) % 3], self.lengths[t][(s + 2) % 3]);
        let (pl, lq) = (self.lengths[u][(r + 1) % 3], self.lengths[u][(r + 2) % 3]);
        let along = |from_p: f64, from_q: f64| 0.5 * (edge + (from_p - from_q) * (from_p + from_q) / edge);
        let across = 2.0 * (first.area + second.area) / edge;
        let diagonal = (along(kp, qk) - along(pl, lq)).hypot(across);
        let (new_first, new_second) = ([pl, diagonal, kp], [qk, diagonal, lq]);
        let (before, after) = (
            index(self.lengths[t], &first) + index(self.lengths[u], &second),
            index(new_first, &of_lengths(new_first)) + index(new_second, &of_lengths(new_second)),
        );
        // False also where one is not a number.
        let better = after < before;
        if !better {
            return false;
        }
        let k = self.corners[t][s];
        let (p, q) = (self.corners[t][(s + 1) % 3], self.corners[t][(s + 2) % 3]);
        let l = self.corners[u][r];
        self.corners[t] = [k, p, l];
        self.corners[u] = [l, q, k];
        self.lengths[t] = new_first;
        self.lengths[u] = new_second;
        self.rename((t, s), (u, r));
        true
    }

    /// Glues the sides around a flipped edge again under their new names.
    fn rename(&mut self, (t, s): (usize, usize), (u, r): (usize, usize)) {
        let name = |triangle: usize, side: usize| (3 * triangle + side % 3) as u32;
        // p–l, k–p, q–k and l–q.
        let old = [name(u, r + 1), name(t, s + 2), name(t, s + 1), name(u, r + 2)];
        let new = [name(t, 0), name(t, 2), name(u, 0), name(u, 2)];
        let twins = old.map(|side| self.twins[side as usize]);
        for (&side, twin) in new.iter().zip(twins) {
            let twin = old.iter().position(|&old| old == twin).map_or(twin, |at| new[at]);
            self.twins[side as usize] = twin;
            if twin != NONE {
                self.twins[twin as usize] = side;
            }
        }
        self.twins[name(t, 1) as usize] = name(u, 1);
        self.twins[name(u, 1) as usize] = name(t, 1);
    }

    /// The triangles with their metrics.
    pub(super) fn elements(&self) -> impl Iterator<Item = ([u32; 3], Element)> + '_ {
        self.corners.iter().zip(&self.lengths).map(|(&corners, &lengths)| (corners, of_lengths(lengths)))
    }
}

/// A triangle's part of the harmonic index.
fn index([a, b, c]: [f64; 3], element: &Element) -> f64 {
    if element.area > 0.0 { (a * a + b * b + c * c) / element.area } else { f64::INFINITY }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{
        super::{
            cover::{Rims, cover},
            surface::Surface,
        },
        *,
    };
    use crate::mesh::Mesh;
    use crate::watch::Unwatched;

    /// A strip of points by rows, each cell cut along one of its diagonals.
    fn sheet(points: &[[f64; 3]], width: usize, cuts: u64) -> Mesh {
        let mut triangles = Vec::new();
        for row in 0..points.len() / width - 1 {
            for column in 0..width - 1 {
                let p = (row * width + column) as u32;
                let (q, r, s) = (p + 1, p + 1 + width as u32, p + width as u32);
                if cuts >> (p % 64) & 1 == 0 {
                    triangles.extend([[p, q, r], [p, r, s]]);
                } else {
                    triangles.extend([[p, q, s], [q, r, s]]);
                }
            }
        }
        Mesh::new(points.to_vec(), triangles)
    }

    fn glue(mesh: &Mesh, rims: Rims) -> Option<Glued> {
        let pulse = Pulse::new(&Unwatched);
        Surface::of(mesh, false, &pulse).ok().map(|surface| cover(&surface, rims, &pulse).unwrap().glued)
    }

    fn mollify(glued: &mut Glued) -> f64 {
        glued.mollify(&Pulse::new(&Unwatched)).unwrap()
    }

    fn flip(glued: &mut Glued) -> Flips {
        glued.flip_to_delaunay(&Pulse::new(&Unwatched)).unwrap()
    }

    /// Every side is glued to one that is glued to it, has its length and runs the other way.
    fn assert_glued(glued: &Glued) {
        for side in 0..glued.twins.len() {
            let twin = glued.twins[side] as usize;
            if twin == NONE as usize {
                continue;
            }
            assert_eq!(glued.twins[twin], side as u32);
            assert_eq!(glued.lengths[side / 3][side % 3], glued.lengths[twin / 3][twin % 3]);
            let ends = |side: usize| {
                let corners = glued.corners[side / 3];
                (corners[(side + 1) % 3], corners[(side + 2) % 3])
            };
            let (from, to) = ends(side);
            assert_eq!(ends(twin), (to, from));
        }
    }

    /// The edges that are not Delaunay by more than `tolerance`.
    fn not_delaunay(glued: &Glued, tolerance: f64) -> usize {
        let cotangent = |side: usize| of_lengths(glued.lengths[side / 3]).cotangents[side % 3];
        let sides = (0..glued.twins.len()).filter(|&side| glued.twins[side] != NONE);
        sides
            .filter(|&side| {
                let (x, y) = (cotangent(side), cotangent(glued.twins[side] as usize));
                x + y < -tolerance * (1.0 + x.abs() + y.abs())
            })
            .count()
    }

    fn area(glued: &Glued) -> f64 {
        glued.elements().map(|(_, element)| element.area).sum()
    }

    #[test]
    fn a_bad_diagonal_is_flipped_to_the_right_length() {
        // A flat kite whose long diagonal from 0 to 2 is an edge: the other one is 0.2 long.
        let mesh = Mesh::new(
            vec![[0.0, 0.0, 0.0], [1.0, -0.1, 0.0], [2.0, 0.0, 0.0], [1.0, 0.1, 0.0]],
            vec![[0, 1, 2], [0, 2, 3]],
        );
        let mut glued = glue(&mesh, Rims::Open).unwrap();
        assert_eq!(mollify(&mut glued), 0.0);
        let before = area(&glued);
        assert_eq!(flip(&mut glued), Flips { count: 1, complete: true });
        assert_glued(&glued);
        // Coordinates are over two.
        let diagonal = glued.lengths.iter().flatten().fold(1.0_f64, |least, &length| least.min(length));
        assert!((diagonal - 0.1).abs() < 1e-15 && (area(&glued) - before).abs() < 1e-15);
        let mut triangles = glued.corners.clone();
        for triangle in &mut triangles {
            triangle.sort_unstable();
        }
        triangles.sort_unstable();
        assert_eq!(triangles, [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn the_tufted_cover_of_one_triangle_is_a_pillow() {
        let mesh = Mesh::new(vec![[0.0; 3], [1.0, 0.0, 0.0], [0.4, 0.3, 0.0]], vec![[0, 1, 2]]);
        let mut glued = glue(&mesh, Rims::Tufted).unwrap();
        assert_glued(&glued);
        assert!(glued.twins.iter().all(|&twin| twin != NONE));
        // The angle at 2 is obtuse, and the two of them at the edge 0–1 are beyond π: that edge becomes a loop at 2.
        flip(&mut glued);
        assert_glued(&glued);
        assert!(glued.corners.iter().all(|corners| corners.iter().filter(|&&corner| corner == 2).count() == 2));
        assert_eq!(not_delaunay(&glued, 1e-9), 0);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// Anything from good to collapsed: heights, repeated and collinear points, needles.
        #[test]
        fn flipping_ends_with_delaunay_edges(
            steps in prop::collection::vec((0..4u8, -6..0i32, -1.0..1.0f64), 30),
            cuts in any::<u64>(),
            tufted in any::<bool>(),
        ) {
            let points: Vec<[f64; 3]> = (0..30)
                .map(|at| {
                    let (kind, power, value) = steps[at];
                    let (x, y) = ((at % 6) as f64, (at / 6) as f64);
                    let small = 10_f64.powi(power) * value;
                    match kind {
                        0 => [x, y, 0.0],
                        1 => [x + value, y + small, small],
                        2 => [x, y * small, value],
                        _ => [x.floor() + small, 0.0, 0.0],
                    }
                })
                .collect();
            let mesh = sheet(&points, 6, cuts);
            let Some(mut glued) = glue(&mesh, if tufted { Rims::Tufted } else { Rims::Open }) else { return Ok(()) };
            mollify(&mut glued);
            let before = area(&glued);
            prop_assert!(glued.elements().all(|(_, element)| element.area > 0.0));
            let flips = flip(&mut glued);
            prop_assert!(flips.complete);
            assert_glued(&glued);
            prop_assert!((area(&glued) - before).abs() < 1e-6 * before, "{} {}", area(&glued), before);
            prop_assert!(glued.elements().all(|(_, element)| element.cotangents.iter().all(|x| x.is_finite())));
            prop_assert_eq!(not_delaunay(&glued, 1e-4), 0);
        }
    }
}

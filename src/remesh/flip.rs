//! Edges are flipped towards the Delaunay triangulation.

use super::{
    RemeshError,
    set::Set,
    shape::{SLIVER, quality},
    work::{IDLE, Work},
};
use crate::mesh::halfedge::{next, prev, sides, triangle_of};

/// What it costs to see whether an edge wants to be flipped, in nanoseconds, about.
const SIGHT: usize = 40;

impl Work<'_> {
    /// Flips edges whose opposite angles sum to more than π, in so many passes at most.
    pub(super) fn flip(&mut self, passes: usize) -> Result<(), RemeshError> {
        let mut open = std::mem::take(&mut self.open);
        let [mut blunt, other] = std::mem::take(&mut self.sets);
        open.clear();
        blunt.clear(self.mesh.slots());
        for triangle in 0..self.mesh.triangle_slots() {
            self.pulse.beat(3 * IDLE)?;
            self.find_blunt(triangle, &mut blunt);
        }
        let mut next = 0;
        while let Some(h) = blunt.from(next) {
            self.pulse.beat(SIGHT)?;
            next = h + 1;
            if self.mesh.is_edge(h) {
                let t = self.mesh.twin(h);
                if self.try_flip(h, &mut open) {
                    // The five edges are others' sides now.
                    for side in [h, t].into_iter().flat_map(|side| sides(triangle_of(side))) {
                        blunt.insert(side.min(self.mesh.twin(side)));
                    }
                }
            }
        }
        // From then on only edges beside flipped ones.
        let (mut from, mut to) = (0, open.len());
        for _ in 1..passes {
            for at in from..to {
                self.pulse.beat(SIGHT)?;
                self.try_flip(open[at], &mut open);
            }
            (from, to) = (to, open.len());
        }
        (self.open, self.sets) = (open, [blunt, other]);
        Ok(())
    }

    /// Notes the edges across a triangle's angles of more than π/2: of two angles that sum to more than π, one is.
    fn find_blunt(&self, triangle: u32, blunt: &mut Set) {
        let first = sides(triangle)[0];
        if !self.mesh.has(first) {
            return;
        }
        let [a, b, c] = self.mesh.corners(triangle);
        let (p, q, r) = (self.mesh.point(a), self.mesh.point(b), self.mesh.point(c));
        let (u, w, t) = (q - p, r - q, p - r);
        // The cosine is that of the angle between one side and the other turned round. What is no number is looked at.
        let is_acute = [u.dot(t) <= 0.0, w.dot(u) <= 0.0, t.dot(w) <= 0.0];
        if is_acute != [true; 3] {
            for (corner, is_acute) in (first..).zip(is_acute) {
                if !is_acute {
                    let across = next(corner);
                    blunt.insert(across.min(self.mesh.twin(across)));
                }
            }
        }
    }

    fn try_flip(&mut self, h: u32, beside: &mut Vec<u32>) -> bool {
        let flips = !self.mesh.is_marked(h) && self.wants_flip(h) && self.mesh.can_flip(h);
        if flips {
            let t = self.mesh.twin(h);
            self.mesh.flip(h);
            // The edges around: h, t and what follows the new diagonal in each of its triangles but it.
            beside.extend([h, t, prev(h), prev(t)]);
        }
        flips
    }

    fn wants_flip(&self, h: u32) -> bool {
        let t = self.mesh.twin(h);
        let (a, b, c, d) = (self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h), self.mesh.apex(t));
        let [pa, pb, pc, pd] = [a, b, c, d].map(|x| self.mesh.point(x));
        let (ca, cb, da, db) = (pa - pc, pb - pc, pa - pd, pb - pd);
        // The angles at c and d sum to more than π where the sine of the sum is negative; the sine of each is positive.
        let (cos_c, cos_d) = (ca.dot(cb), da.dot(db));
        if cos_c >= 0.0 && cos_d >= 0.0 {
            return false;
        }
        let (sin_c, sin_d) = (ca.cross(cb).norm(), da.cross(db).norm());
        if sin_c * cos_d + cos_c * sin_d >= -1e-6 * (sin_c * cos_d.abs() + sin_d * cos_c.abs()) {
            return false;
        }
        if self.is_ghost(a) || self.is_ghost(b) || self.is_ghost(c) || self.is_ghost(d) {
            return false;
        }
        self.flipped_quality(h) > SLIVER || self.flip_betters(h)
    }

    /// Whether the worse of the edge's two triangles would be better with the other diagonal.
    pub(super) fn flip_betters(&self, h: u32) -> bool {
        self.flipped_quality(h) > self.side_quality(h).min(self.side_quality(self.mesh.twin(h)))
    }

    /// The worse quality of the two triangles that there would be with the other diagonal.
    fn flipped_quality(&self, h: u32) -> f64 {
        let t = self.mesh.twin(h);
        let (a, b, c, d) = (self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h), self.mesh.apex(t));
        let [pa, pb, pc, pd] = [a, b, c, d].map(|x| self.mesh.point(x));
        let [na, nb, nc, nd] = [a, b, c, d].map(|x| self.normals[x as usize]);
        quality([pa, pd, pc], na + nd + nc).min(quality([pb, pc, pd], nb + nc + nd))
    }
}

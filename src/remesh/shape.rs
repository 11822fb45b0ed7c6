//! How good triangles are, and getting rid of bad ones.

use super::{
    RemeshError,
    work::{IDLE, Kind, MOVE, Work},
};
use crate::mesh::vector::V3;

/// Twice the area over the square of the longest side, below which a triangle is not made.
pub(super) const SLIVER: f64 = 0.15;
/// The same below which a triangle is bad: least angles of some 20°.
const BAD: f64 = 0.33;
/// Passes over bad triangles, at most.
const MENDS: usize = 4;
/// How much of its length the normal of a triangle has along those of its corners, at least.
const FACING: f64 = 0.3;

/// How good a triangle is: twice its area over the square of its longest side, at most 0.87; less by 1 when it does
/// not face as the normals of its corners do on the whole.
pub(super) fn quality([p, q, r]: [V3; 3], normals: V3) -> f64 {
    let (u, w, t) = (q - p, r - q, p - r);
    let cross = w.cross(u) * -1.0;
    let double_area = cross.norm();
    let shape = double_area / u.dot(u).max(w.dot(w)).max(t.dot(t)).max(1e-300);
    if cross.dot(normals) >= FACING * double_area * normals.norm() { shape } else { shape - 1.0 }
}

/// Whether the [`quality`] of a triangle is more than `least`, which is positive: told without roots.
fn is_better([p, q, r]: [V3; 3], normals: V3, least: f64) -> bool {
    let (u, w, t) = (q - p, r - q, p - r);
    let cross = u.cross(w);
    let double_area2 = cross.dot(cross);
    let longest2 = u.dot(u).max(w.dot(w)).max(t.dot(t));
    let facing = cross.dot(normals);
    double_area2 > least * least * longest2 * longest2
        && facing > 0.0
        && facing * facing >= FACING * FACING * double_area2 * normals.dot(normals)
}

impl Work<'_> {
    /// The quality of the triangle of a half-edge; of a ghost's, the best.
    pub(super) fn side_quality(&self, h: u32) -> f64 {
        let corners = [self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h)];
        if corners.into_iter().any(|a| self.is_ghost(a)) {
            return f64::INFINITY;
        }
        let normals = corners.into_iter().fold(V3::default(), |sum, a| sum + self.normals[a as usize]);
        quality(corners.map(|a| self.mesh.point(a)), normals)
    }

    /// Whether the triangle whose first half-edge is `h` is bad; a ghost's is not.
    fn is_bad(&self, h: u32) -> bool {
        let [a, b, c] = self.mesh.corners(h);
        if [a, b, c].into_iter().any(|x| self.is_ghost(x)) {
            return false;
        }
        let corners = [self.mesh.point(a), self.mesh.point(b), self.mesh.point(c)];
        let normals = self.normals[a as usize] + self.normals[b as usize] + self.normals[c as usize];
        !is_better(corners, normals, BAD)
    }

    /// Rids the mesh of bad triangles: an edge of theirs is collapsed, the shortest first, or their longest flipped,
    /// where that leaves the worst triangle better than it was.
    pub(super) fn mend(&mut self) -> Result<usize, RemeshError> {
        let mut left = 0;
        for _ in 0..MENDS {
            left = 0;
            for h in (0..self.mesh.slots()).step_by(3) {
                self.pulse.beat(3 * IDLE)?;
                if !self.mesh.has(h) || !self.is_bad(h) {
                    continue;
                }
                left += 1;
                self.pulse.beat(3 * MOVE)?;
                let mut sides = [h, h + 1, h + 2].map(|side| (self.length2(side), side));
                sides.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
                if sides.into_iter().any(|(_, side)| self.try_collapse(side, 2.0, f64::INFINITY)) {
                    continue;
                }
                let longest = sides[2].1;
                if !self.mesh.is_marked(longest) && self.mesh.can_flip(longest) && self.flip_betters(longest) {
                    self.mesh.flip(longest);
                }
            }
            if left == 0 {
                break;
            }
        }
        Ok(left)
    }

    /// The worst quality around `a` if it were at `p`, leaving out the triangles that have `other`.
    pub(super) fn ring_quality(&self, a: u32, p: V3, normal: V3, other: u32) -> f64 {
        let mut worst = f64::INFINITY;
        let free = self.kinds[a as usize] == Kind::Free;
        for h in self.mesh.around(a) {
            let (x, y) = (self.mesh.end(h), self.mesh.apex(h));
            if x == other || y == other || (!free && (self.is_ghost(x) || self.is_ghost(y))) {
                continue;
            }
            let normals = normal + self.normals[x as usize] + self.normals[y as usize];
            worst = worst.min(quality([p, self.mesh.point(x), self.mesh.point(y)], normals));
        }
        worst
    }

    /// Whether the triangles around `a`, which is free or has no ghost beside it, are better than slivers if it were
    /// at `p`, but for those that have `other`: [`Work::ring_quality`] without roots.
    pub(super) fn ring_is_good(&self, a: u32, p: V3, normal: V3, other: u32) -> bool {
        self.kinds[a as usize] == Kind::Free
            && self.mesh.around(a).all(|h| {
                let (x, y) = (self.mesh.end(h), self.mesh.apex(h));
                if x == other || y == other {
                    return true;
                }
                let normals = normal + self.normals[x as usize] + self.normals[y as usize];
                is_better([p, self.mesh.point(x), self.mesh.point(y)], normals, SLIVER)
            })
    }

    /// Whether `a` may move to `p`: the triangles around it are good there, or better than now.
    pub(super) fn may_move(&self, a: u32, p: V3, normal: V3) -> bool {
        if self.ring_is_good(a, p, normal, a) {
            return true;
        }
        let new = self.ring_quality(a, p, normal, a);
        new > self.ring_quality(a, self.mesh.point(a), self.normals[a as usize], a)
    }
}

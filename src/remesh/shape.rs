//! How good triangles are, and getting rid of bad ones.

use super::{
    RemeshError,
    work::{IDLE, Kind, MOVE, Work},
};
use crate::mesh::{
    halfedge::{sides, triangle_of},
    vector::{V3, greater},
};

/// Twice the area over the square of the longest side, below which a triangle is not made.
pub(super) const SLIVER: f64 = 0.15;
/// The same below which a triangle is bad: least angles of some 20°.
const BAD: f64 = 0.33;
/// Passes over bad triangles, at most.
const MENDS: usize = 4;
/// How much of its length the normal of a triangle has along those of its corners, at least.
const FACING: f64 = 0.3;

/// The square of the longest of a triangle's sides.
fn longest2([u, w, t]: [V3; 3]) -> f64 {
    greater(greater(u.dot(u), w.dot(w)), t.dot(t))
}

/// How good a triangle is: twice its area over the square of its longest side, at most 0.87; less by 1 when it does
/// not face as the normals of its corners do on the whole.
pub(super) fn quality([p, q, r]: [V3; 3], normals: V3) -> f64 {
    let (u, w, t) = (q - p, r - q, p - r);
    let cross = w.cross(u) * -1.0;
    let double_area = cross.norm();
    let shape = double_area / greater(longest2([u, w, t]), 1e-300);
    if cross.dot(normals) >= FACING * double_area * normals.norm() { shape } else { shape - 1.0 }
}

/// Whether the [`quality`] of a triangle is more than `least`, which is positive: told without roots, from the cross
/// product of two of its sides and the square of the longest.
fn is_better(cross: V3, longest2: f64, normals: V3, least: f64) -> bool {
    let double_area2 = cross.dot(cross);
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

    /// Whether a triangle is bad; a ghost's is not.
    fn is_bad(&self, triangle: u32) -> bool {
        let [a, b, c] = self.mesh.corners(triangle);
        if self.has_ghost(triangle) {
            return false;
        }
        let (p, q, r) = (self.mesh.point(a), self.mesh.point(b), self.mesh.point(c));
        let (u, w, t) = (q - p, r - q, p - r);
        let normals = self.normals[a as usize] + self.normals[b as usize] + self.normals[c as usize];
        !is_better(u.cross(w), longest2([u, w, t]), normals, BAD)
    }

    /// Rids the mesh of bad triangles: an edge of theirs is collapsed, the shortest first, or their longest flipped,
    /// where that leaves the worst triangle better than it was.
    pub(super) fn mend(&mut self) -> Result<usize, RemeshError> {
        let [mut now, mut later] = std::mem::take(&mut self.sets);
        now.clear(self.mesh.triangle_slots());
        let mut left = 0;
        for pass in 0..MENDS {
            left = 0;
            later.clear(self.mesh.triangle_slots());
            let mut next = 0;
            // First all of them, then what was bad and what has changed since it was looked at.
            while let Some(triangle) = if pass == 0 { Some(next) } else { now.from(next) } {
                if triangle == self.mesh.triangle_slots() {
                    break;
                }
                next = triangle + 1;
                self.pulse.beat(3 * IDLE)?;
                if !self.mesh.has(sides(triangle)[0]) || !self.is_bad(triangle) {
                    continue;
                }
                left += 1;
                self.pulse.beat(3 * MOVE)?;
                later.insert(triangle);
                self.mend_one(triangle, |changed| {
                    now.insert(changed);
                    later.insert(changed);
                });
            }
            if left == 0 {
                break;
            }
            std::mem::swap(&mut now, &mut later);
        }
        self.sets = [now, later];
        Ok(left)
    }

    /// Mends a triangle if it can, and tells the triangles that this changes.
    fn mend_one(&mut self, triangle: u32, mut changed: impl FnMut(u32)) {
        let mut sides = sides(triangle).map(|side| (self.length2(side), side));
        sides.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
        for (_, side) in sides {
            let ends = [self.mesh.start(side), self.mesh.end(side)];
            if self.try_collapse(side, 2.0, f64::INFINITY) {
                let left = ends.into_iter().filter(|&a| self.mesh.has_vertex(a));
                left.flat_map(|a| self.mesh.around(a)).for_each(|h| changed(triangle_of(h)));
                return;
            }
        }
        let longest = sides[2].1;
        if !self.mesh.is_marked(longest) && self.mesh.can_flip(longest) && self.flip_betters(longest) {
            changed(triangle);
            changed(triangle_of(self.mesh.twin(longest)));
            self.mesh.flip(longest);
        }
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

    /// Whether the triangles of a vertex with these neighbours, in turn around it and none of them a ghost, are better
    /// than slivers if it were at `p`, but for those that have `other`: [`Work::ring_quality`] without roots.
    pub(super) fn ring_is_good(&self, ring: &[u32], p: V3, normal: V3, other: u32) -> bool {
        let Some(&last) = ring.last() else { return true };
        let (mut x, mut q) = (last, self.mesh.point(last));
        let mut u = q - p;
        let mut u2 = u.dot(u);
        for &y in ring {
            let r = self.mesh.point(y);
            let t = r - p;
            let t2 = t.dot(t);
            if x != other && y != other {
                let w = r - q;
                let normals = normal + self.normals[x as usize] + self.normals[y as usize];
                if !is_better(u.cross(w), greater(greater(u2, w.dot(w)), t2), normals, SLIVER) {
                    return false;
                }
            }
            (x, q, u, u2) = (y, r, t, t2);
        }
        true
    }

    /// Whether `a`, whose neighbours are those of `ring`, may move to `p`: the triangles around it are good there, or
    /// better than now.
    pub(super) fn may_move(&self, a: u32, ring: &[u32], p: V3, normal: V3) -> bool {
        if self.kinds[a as usize] == Kind::Free && self.ring_is_good(ring, p, normal, a) {
            return true;
        }
        let new = self.ring_quality(a, p, normal, a);
        new > self.ring_quality(a, self.mesh.point(a), self.normals[a as usize], a)
    }
}

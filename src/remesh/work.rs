//! The mesh on its way: its vertices with their places on the surface, and the moves on its edges.

use std::ops::Range;

use super::{
    RemeshError,
    surface::{Spot, Surface},
};
use crate::{
    mesh::{halfedge::HalfEdges, vector::V3},
    watch::Watch,
};

/// Rounds of split, collapse, flip and relax.
const ROUNDS: usize = 4;
/// Rounds of relax and flip after the count is exact.
const FINISH: usize = 4;
/// Edges longer than this are split, shorter than that collapsed, in lengths aimed at.
pub(super) const LONG: f64 = 4.0 / 3.0;
const SHORT: f64 = 0.8;
/// Twice the area over the square of the longest side, below which a triangle is not made.
pub(super) const SLIVER: f64 = 0.15;
/// Passes over bad triangles, at most.
const MENDS: usize = 4;
/// The quality below which a triangle is bad: least angles of some 20°.
const BAD: f64 = 0.33;
/// Units of work between two looks at the watch.
const LOOK: u32 = 1024;

/// What a vertex may do: less, the greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Moves on the surface.
    Free,
    /// Moves along its crease.
    Crease,
    /// Stays.
    Corner,
}

/// The mesh under work.
pub(super) struct Work<'a> {
    pub(super) surface: &'a Surface,
    pub(super) mesh: HalfEdges,
    pub(super) ghosts: Range<u32>,
    pub(super) kinds: Vec<Kind>,
    /// The half-edge of the surface at which each vertex lies: of its triangle, of its crease, from its corner.
    pub(super) sides: Vec<u32>,
    /// The surface's normals at the vertices.
    pub(super) normals: Vec<V3>,
    /// The length of edge aimed at.
    pub(super) length: f64,
    /// Whether creases and the shape of triangles are given up for the count.
    pub(super) loose: bool,
    pub(super) watch: &'a dyn Watch,
}

fn distance2(p: V3, q: V3) -> f64 {
    let off = p - q;
    off.dot(off)
}

/// How good a triangle is: twice its area over the square of its longest side, at most 0.87; less by 1 when it does
/// not face as the normals of its corners do on the whole.
fn quality([p, q, r]: [V3; 3], normals: V3) -> f64 {
    let (u, w, t) = (q - p, r - q, p - r);
    let cross = w.cross(u) * -1.0;
    let double_area = cross.norm();
    let shape = double_area / u.dot(u).max(w.dot(w)).max(t.dot(t)).max(1e-300);
    if cross.dot(normals) >= 0.3 * double_area * normals.norm() { shape } else { shape - 1.0 }
}

impl<'a> Work<'a> {
    pub(super) fn new(surface: &'a Surface, ghosts: Range<u32>, length: f64, watch: &'a dyn Watch) -> Self {
        let mesh = surface.mesh.clone();
        let slots = mesh.vertex_slots();
        let mut kinds = Vec::with_capacity(slots as usize);
        let mut sides = Vec::with_capacity(slots as usize);
        for a in 0..slots {
            let crease = mesh.has_vertex(a).then(|| surface.creases_at(a).next()).flatten();
            let (kind, side) = match crease {
                Some(_) if surface.is_corner(a) => (Kind::Corner, surface.side_at(a)),
                Some(h) => (Kind::Crease, h),
                None => (Kind::Free, surface.side_at(a)),
            };
            kinds.push(kind);
            sides.push(side);
        }
        let normals = (0..slots).map(|a| surface.normal(a)).collect();
        Self { surface, mesh, ghosts, kinds, sides, normals, length, loose: false, watch }
    }

    /// Does the whole work.
    pub(super) fn run(mut self, count: usize) -> Result<HalfEdges, RemeshError> {
        let total = ROUNDS + FINISH + 2;
        self.watch.progress(0, total);
        if self.count() > count {
            self.collapse()?;
        }
        // The longest first, so that halves stay near to the shape of the whole.
        let mut longest = self.longest();
        while longest > LONG * self.length {
            longest *= 0.7;
            for _ in 0..2 {
                self.split(longest.max(LONG * self.length))?;
                self.flip(1)?;
            }
        }
        self.watch.progress(1, total);
        for round in 0..ROUNDS {
            self.split(LONG * self.length)?;
            self.collapse()?;
            self.flip(4)?;
            self.relax()?;
            self.flip(1)?;
            self.relax()?;
            // As if the vertices were spread evenly; creases and thin parts make it differ.
            let ratio = (self.count() as f64 / count as f64).clamp(0.5, 2.0);
            self.length *= ratio.sqrt();
            self.watch.progress(round + 2, total);
        }
        self.flip(2)?;
        self.mend()?;
        self.reach(count)?;
        for round in 0..FINISH {
            self.flip(2)?;
            self.relax()?;
            self.watch.progress(ROUNDS + round + 2, total);
        }
        self.flip(4)?;
        self.balance()?;
        self.watch.progress(total, total);
        Ok(self.mesh)
    }

    pub(super) fn look(&self, at: u32) -> Result<(), RemeshError> {
        if at.is_multiple_of(LOOK) && self.watch.cancelled() { Err(RemeshError::Cancelled) } else { Ok(()) }
    }

    /// The number of vertices, without ghosts.
    pub(super) fn count(&self) -> usize {
        self.mesh.vertex_count() - self.ghosts.len()
    }

    pub(super) fn is_ghost(&self, a: u32) -> bool {
        self.ghosts.contains(&a)
    }

    /// Whether the half-edge is the one for its edge, and that no ghost's.
    pub(super) fn is_edge(&self, h: u32) -> bool {
        self.mesh.is_edge(h) && !self.is_ghost(self.mesh.start(h)) && !self.is_ghost(self.mesh.end(h))
    }

    pub(super) fn length2(&self, h: u32) -> f64 {
        distance2(self.mesh.point(self.mesh.start(h)), self.mesh.point(self.mesh.end(h)))
    }

    fn longest(&self) -> f64 {
        let lengths = (0..self.mesh.slots()).filter(|&h| self.is_edge(h)).map(|h| self.length2(h));
        lengths.fold(0.0, f64::max).sqrt()
    }

    /// Splits the edges that are longer than `longest`, and what is left of them.
    fn split(&mut self, longest: f64) -> Result<(), RemeshError> {
        let longest2 = longest * longest;
        // A few more than an even mesh of such edges has: where the surface is folded, edges may grow by splits.
        let most = self.count() + (2.0 * self.surface.area() / longest2) as usize;
        // A split moves edges to new slots at the end: they are not looked at until the next pass.
        for h in 0..self.mesh.slots() {
            self.look(h)?;
            if self.is_edge(h) && self.length2(h) > longest2 && self.count() < most {
                self.try_split(h);
            }
        }
        Ok(())
    }

    /// Puts a vertex on the surface in the middle of an edge, unless that folds the mesh.
    pub(super) fn try_split(&mut self, h: u32) -> bool {
        let (a, b) = (self.mesh.start(h), self.mesh.end(h));
        let middle = self.mesh.point(a).lerp(self.mesh.point(b), 0.5);
        let kind = if self.mesh.is_marked(h) { Kind::Crease } else { Kind::Free };
        let spot = self.spot(middle, [a, b], kind);
        // Where the surface near by is far from the middle, halves could be as long as the whole, without end.
        if distance2(spot.at, middle) > 0.15 * self.length2(h) && !self.loose {
            return false;
        }
        let t = self.mesh.twin(h);
        let halves = [[a, self.mesh.apex(t)], [self.mesh.apex(t), b], [b, self.mesh.apex(h)], [self.mesh.apex(h), a]];
        let half = |[x, y]: [u32; 2]| {
            if self.is_ghost(x) || self.is_ghost(y) {
                return f64::INFINITY;
            }
            let normals = spot.normal + self.normals[x as usize] + self.normals[y as usize];
            quality([spot.at, self.mesh.point(x), self.mesh.point(y)], normals)
        };
        let new = halves.into_iter().map(half).fold(f64::INFINITY, f64::min);
        if new < 0.0 && !self.loose && new < self.side_quality(h).min(self.side_quality(t)) {
            return false;
        }
        self.mesh.split(h, spot.at);
        self.kinds.push(kind);
        self.sides.push(spot.side);
        self.normals.push(spot.normal);
        true
    }

    /// The quality of the triangle of a half-edge; of a ghost's, the best.
    pub(super) fn side_quality(&self, h: u32) -> f64 {
        let corners = [self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h)];
        if corners.into_iter().any(|a| self.is_ghost(a)) {
            return f64::INFINITY;
        }
        let normals = corners.into_iter().fold(V3::default(), |sum, a| sum + self.normals[a as usize]);
        quality(corners.map(|a| self.mesh.point(a)), normals)
    }

    /// The point of the surface, or of the crease, near `p` by way of two vertices.
    fn spot(&self, p: V3, from: [u32; 2], kind: Kind) -> Spot {
        let mut best: Option<(Spot, f64)> = None;
        let mut take = |spot: Spot| {
            let off = distance2(spot.at, p);
            if best.is_none_or(|(_, least)| off < least) {
                best = Some((spot, off));
            }
        };
        for a in from {
            let side = self.sides[a as usize];
            match (kind, self.kinds[a as usize]) {
                (Kind::Free, _) => take(self.surface.nearest(p, side)),
                (_, Kind::Crease) => take(self.surface.nearest_on_crease(p, side)),
                _ => {
                    let corner = self.surface.mesh.start(side);
                    for crease in self.surface.creases_at(corner) {
                        take(self.surface.nearest_on_crease(p, crease));
                    }
                }
            }
        }
        best.map_or_else(|| self.surface.nearest(p, self.sides[from[0] as usize]), |(spot, _)| spot)
    }

    /// Collapses edges that are too short.
    fn collapse(&mut self) -> Result<(), RemeshError> {
        let shortest2 = (SHORT * self.length).powi(2);
        for h in 0..self.mesh.slots() {
            self.look(h)?;
            if self.is_edge(h) && self.length2(h) < shortest2 {
                self.try_collapse(h, LONG * self.length, SLIVER);
            }
        }
        Ok(())
    }

    /// Collapses an edge unless that makes an edge of `longest`, leaves a crease, or makes triangles that are worse
    /// than `good` and than those there are.
    pub(super) fn try_collapse(&mut self, h: u32, longest: f64, good: f64) -> bool {
        let (a, b) = (self.mesh.start(h), self.mesh.end(h));
        // The one that may do less is the end, which stays.
        let h = if self.kinds[a as usize] > self.kinds[b as usize] { self.mesh.twin(h) } else { h };
        let (a, b) = (self.mesh.start(h), self.mesh.end(h));
        let (mine, its) = (self.kinds[a as usize], self.kinds[b as usize]);
        let marked = self.mesh.is_marked(h);
        if mine == Kind::Corner || (mine == Kind::Crease && !marked) || !self.mesh.can_collapse(h) {
            return false;
        }
        if mine == Kind::Crease && self.joins_creases(h) {
            return false;
        }
        let spot = if mine == its {
            let middle = self.mesh.point(a).lerp(self.mesh.point(b), 0.5);
            self.spot(middle, [a, b], mine)
        } else {
            Spot { side: self.sides[b as usize], at: self.mesh.point(b), normal: self.normals[b as usize] }
        };
        let longest2 = longest * longest;
        let reaches = |x: u32| self.is_ghost(x) || distance2(self.mesh.point(x), spot.at) < longest2;
        if !self.mesh.neighbours(a).all(reaches) || !self.mesh.neighbours(b).all(reaches) {
            return false;
        }
        let new = self.ring_quality(a, spot.at, spot.normal, b).min(self.ring_quality(b, spot.at, spot.normal, a));
        let fits = self.loose || new > good || {
            let old = |x: u32| self.ring_quality(x, self.mesh.point(x), self.normals[x as usize], x);
            new > old(a).min(old(b))
        };
        if fits {
            self.mesh.collapse(h, spot.at);
            self.sides[b as usize] = spot.side;
            self.normals[b as usize] = spot.normal;
        }
        fits
    }

    /// Rids the mesh of bad triangles: an edge of theirs is collapsed, the shortest first, or their longest flipped,
    /// where that leaves the worst triangle better than it was.
    fn mend(&mut self) -> Result<(), RemeshError> {
        for _ in 0..MENDS {
            let mut left = 0;
            for h in (0..self.mesh.slots()).step_by(3) {
                self.look(h / 3)?;
                if !self.mesh.has(h) || self.side_quality(h) > BAD {
                    continue;
                }
                left += 1;
                let mut sides = [h, h + 1, h + 2].map(|side| (self.length2(side), side));
                sides.sort_unstable_by(|x, y| x.0.total_cmp(&y.0));
                if sides.into_iter().any(|(_, side)| self.try_collapse(side, 2.0 * self.length, f64::INFINITY)) {
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
        Ok(())
    }

    /// Whether a collapse would lay one crease on another.
    fn joins_creases(&self, h: u32) -> bool {
        [h, self.mesh.twin(h)].into_iter().any(|side| {
            let (on, back) = (crate::mesh::halfedge::next(side), crate::mesh::halfedge::prev(side));
            self.mesh.is_marked(on) && self.mesh.is_marked(back)
        })
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

    /// Whether `a` may move to `p`: the triangles around it are good there, or better than now.
    pub(super) fn may_move(&self, a: u32, p: V3, normal: V3) -> bool {
        let new = self.ring_quality(a, p, normal, a);
        new > SLIVER || new > self.ring_quality(a, self.mesh.point(a), self.normals[a as usize], a)
    }

    /// Flips edges whose opposite angles sum to more than π, in so many passes at most.
    pub(super) fn flip(&mut self, passes: usize) -> Result<(), RemeshError> {
        for _ in 0..passes {
            let mut flipped = 0;
            for h in 0..self.mesh.slots() {
                self.look(h)?;
                if self.mesh.is_edge(h) && !self.mesh.is_marked(h) && self.wants_flip(h) && self.mesh.can_flip(h) {
                    self.mesh.flip(h);
                    flipped += 1;
                }
            }
            if flipped == 0 {
                break;
            }
        }
        Ok(())
    }

    fn wants_flip(&self, h: u32) -> bool {
        let t = self.mesh.twin(h);
        let (a, b, c, d) = (self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h), self.mesh.apex(t));
        let [pa, pb, pc, pd] = [a, b, c, d].map(|x| self.mesh.point(x));
        let (ca, cb, da, db) = (pa - pc, pb - pc, pa - pd, pb - pd);
        // The angles at c and d sum to more than π where the sine of the sum is negative; the sine of each is positive.
        let (cos_c, cos_d) = (ca.dot(cb), da.dot(db));
        if cos_c + cos_d >= 0.0 && cos_c >= 0.0 && cos_d >= 0.0 {
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
    fn flip_betters(&self, h: u32) -> bool {
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

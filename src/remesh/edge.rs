//! The moves that add a vertex or take one away.

use super::{
    shape::{SLIVER, quality},
    surface::Spot,
    work::{Kind, Work, distance2},
};
use crate::mesh::{
    halfedge::{next, prev},
    vector::V3,
};

impl Work<'_> {
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
        self.limits.push(spot.limit);
        true
    }

    /// The point of the surface, or of the crease, near `p` by way of two vertices.
    fn spot(&self, p: V3, from: [u32; 2], kind: Kind) -> Spot {
        let mut best: Option<(Spot, f64)> = None;
        let mut take = |spot: Spot| {
            let off = distance2(spot.at, p);
            if best.is_none_or(|(_, least)| off < least) {
                best = Some((spot, off));
            }
            off
        };
        // So near that there is hardly a nearer one.
        let near2 = 0.01 * distance2(self.mesh.point(from[0]), self.mesh.point(from[1]));
        for a in from {
            let side = self.sides[a as usize];
            match (kind, self.kinds[a as usize]) {
                (Kind::Free, _) => {
                    if take(self.surface.nearest(p, side)) < near2 {
                        break;
                    }
                }
                (_, Kind::Crease) => _ = take(self.surface.nearest_on_crease(p, side)),
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

    /// Collapses an edge unless that makes an edge of `longest`, leaves a crease, or makes triangles that are worse
    /// than `good` and than those there are.
    pub(super) fn try_collapse(&mut self, h: u32, longest: f64, good: f64) -> bool {
        let (a, b) = (self.mesh.start(h), self.mesh.end(h));
        // The one that may do less is the end, which stays.
        let h = if self.kinds[a as usize] > self.kinds[b as usize] { self.mesh.twin(h) } else { h };
        let [mut from, mut to] = std::mem::take(&mut self.rings);
        let spot = self.collapsed(h, longest, good, [&mut from, &mut to]);
        self.rings = [from, to];
        let Some(spot) = spot else { return false };
        let b = self.mesh.end(h) as usize;
        self.mesh.collapse(h, spot.at);
        self.sides[b] = spot.side;
        self.normals[b] = spot.normal;
        self.limits[b] = spot.limit;
        true
    }

    /// Where the end of an edge goes when its start collapses into it, if it may; `rings` is scratch.
    fn collapsed(&self, h: u32, longest: f64, good: f64, rings: [&mut Vec<u32>; 2]) -> Option<Spot> {
        let (a, b) = (self.mesh.start(h), self.mesh.end(h));
        let (mine, its) = (self.kinds[a as usize], self.kinds[b as usize]);
        let marked = self.mesh.is_marked(h);
        if mine == Kind::Corner || (mine == Kind::Crease && (!marked || self.joins_creases(h))) {
            return None;
        }
        let spot = if mine == its {
            let middle = self.mesh.point(a).lerp(self.mesh.point(b), 0.5);
            self.spot(middle, [a, b], mine)
        } else {
            Spot {
                side: self.sides[b as usize],
                at: self.mesh.point(b),
                normal: self.normals[b as usize],
                limit: self.limits[b as usize],
            }
        };
        // What most often forbids it comes first.
        let longest2 = longest * longest * self.within(spot.limit);
        let reaches = |x: u32| {
            self.is_ghost(x) || distance2(self.mesh.point(x), spot.at) < longest2 * self.within(self.limits[x as usize])
        };
        let [from, to] = rings;
        for (ring, x) in [(&mut *from, a), (&mut *to, b)] {
            self.mesh.ring(x, ring);
            if !ring.iter().all(|&y| reaches(y)) {
                return None;
            }
        }
        let [from, to] = [&*from, &*to];
        if !self.mesh.can_collapse_rings(h, from, to, if good > 1.0 { 3 } else { 4 }) {
            return None;
        }
        let is_good = |x: u32, ring: &[u32], other| {
            good <= SLIVER
                && self.kinds[x as usize] == Kind::Free
                && self.ring_is_good(ring, spot.at, spot.normal, other)
        };
        let fits = self.loose || (is_good(a, from, b) && is_good(b, to, a)) || {
            let new = self.ring_quality(a, spot.at, spot.normal, b).min(self.ring_quality(b, spot.at, spot.normal, a));
            let old = |x: u32| self.ring_quality(x, self.mesh.point(x), self.normals[x as usize], x);
            new > good || new > old(a).min(old(b))
        };
        fits.then_some(spot)
    }

    /// Whether a collapse would lay one crease on another.
    fn joins_creases(&self, h: u32) -> bool {
        [h, self.mesh.twin(h)].into_iter().any(|side| {
            let (on, back) = (next(side), prev(side));
            self.mesh.is_marked(on) && self.mesh.is_marked(back)
        })
    }
}

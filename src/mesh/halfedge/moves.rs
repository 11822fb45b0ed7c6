//! The three moves on an edge, and when the surface stays a manifold: split, flip and collapse.

use super::{GONE, HalfEdges, Triangle, next, prev};
use crate::mesh::vector::V3;

impl HalfEdges {
    /// Makes two half-edges one edge, which is marked if one of them was.
    fn join(&mut self, h: u32, t: u32) {
        *self.twin_mut(h) = t;
        *self.twin_mut(t) = h;
        if self.is_marked(h) || self.is_marked(t) {
            self.mark(h, true);
        }
    }

    /// Puts a vertex at `at` on the edge of `h`, and gives its index.
    pub fn split(&mut self, h: u32, at: V3) -> u32 {
        let t = self.twin(h);
        let (b, c, d) = (self.end(h), self.apex(h), self.apex(t));
        let m = self.points.len() as u32;
        self.points.push(at);
        self.live += 1;
        let (bc, ad) = (next(h), next(t));
        let (beyond_bc, beyond_ad) = (self.twin(bc), self.twin(ad));
        // h's triangle (a b c) becomes (a m c) and a new (m b c); t's (b a d) becomes (b m d) and a new (m a d).
        let a = self.start(h);
        let f = self.slots();
        let g = f + 4;
        self.triangles.push(Triangle { start: [m, b, c, GONE], twin: [GONE, GONE, GONE, 0] });
        self.triangles.push(Triangle { start: [m, a, d, GONE], twin: [GONE, GONE, GONE, 0] });
        *self.start_mut(next(h)) = m;
        *self.start_mut(next(t)) = m;
        // The marks of what was (b c) and (a d) move out with the edges.
        for (inner, outer) in [(bc, f + 1), (ad, g + 1)] {
            self.mark_side(outer, self.is_marked(inner));
            self.mark_side(inner, false);
        }
        self.join(h, g);
        self.join(t, f);
        self.join(bc, f + 2);
        self.join(ad, g + 2);
        self.join(f + 1, beyond_bc);
        self.join(g + 1, beyond_ad);
        self.out.push(f);
        self.out[a as usize] = h;
        self.out[b as usize] = t;
        self.out[c as usize] = f + 2;
        self.out[d as usize] = g + 2;
        m
    }

    /// Whether [`HalfEdges::flip`] keeps the surface a manifold with no vertex of fewer than four neighbours.
    pub fn can_flip(&self, h: u32) -> bool {
        let t = self.twin(h);
        let (c, d) = (self.apex(h), self.apex(t));
        c != d
            && self.degree(self.start(h)) > 4
            && self.degree(self.end(h)) > 4
            && self.neighbours(c).all(|other| other != d)
    }

    /// Replaces the edge, which is not marked, by the other diagonal of its two triangles; `h` and its twin are no
    /// longer that edge.
    pub fn flip(&mut self, h: u32) {
        let t = self.twin(h);
        let (bc, ca, ad, db) = (next(h), prev(h), next(t), prev(t));
        let (a, b, c, d) = (self.start(h), self.start(t), self.start(ca), self.start(db));
        let (beyond_bc, beyond_ad) = (self.twin(bc), self.twin(ad));
        // (a b c), (b a d) → (a d c), (b c d).
        *self.start_mut(bc) = d;
        *self.start_mut(ad) = c;
        self.mark_side(bc, false);
        self.mark_side(ad, false);
        self.join(h, beyond_ad);
        self.join(t, beyond_bc);
        self.join(bc, ad);
        self.out[a as usize] = h;
        self.out[b as usize] = t;
        self.out[c as usize] = ca;
        self.out[d as usize] = db;
    }

    /// Whether the ends of the edge have no common neighbour but the two across it, so that the surface stays a
    /// manifold when they become one vertex; and none of the two across falls below four neighbours.
    pub fn can_collapse(&self, h: u32) -> bool {
        self.can_collapse_to(h, 4)
    }

    /// The same with so many neighbours, at least 3.
    pub fn can_collapse_to(&self, h: u32, least: usize) -> bool {
        let [from, to] = [self.start(h), self.end(h)].map(|a| self.neighbours(a).collect::<Vec<u32>>());
        self.can_collapse_rings(h, &from, &to, least)
    }

    /// The same where the neighbours of the edge's start and of its end are known.
    pub fn can_collapse_rings(&self, h: u32, from: &[u32], to: &[u32], least: usize) -> bool {
        let (c, d) = (self.apex(h), self.apex(self.twin(h)));
        let more = |x: u32| self.around(x).nth(least).is_some();
        if c == d || self.live <= 8 || from.len() + to.len() < 4 + least || !more(c) || !more(d) {
            return false;
        }
        // Most vertices have fewer neighbours than this.
        let mut few = [GONE; 16];
        let common = if let Some(some) = few.get_mut(..to.len()) {
            some.copy_from_slice(to);
            from.iter().filter(|x| few.contains(x)).count()
        } else {
            from.iter().filter(|x| to.contains(x)).count()
        };
        common == 2
    }

    /// Makes the edge's start one with its end, which moves to `at`.
    pub fn collapse(&mut self, h: u32, at: V3) {
        let t = self.twin(h);
        let (a, b) = (self.start(h), self.end(h));
        let (c, d) = (self.apex(h), self.apex(t));
        let mut spoke = h;
        loop {
            *self.start_mut(spoke) = b;
            spoke = self.twin(prev(spoke));
            if spoke == h {
                break;
            }
        }
        let (bc, ca, ad, db) = (self.twin(next(h)), self.twin(prev(h)), self.twin(next(t)), self.twin(prev(t)));
        self.join(bc, ca);
        self.join(ad, db);
        for gone in [h, t] {
            *self.triangle_mut(gone) = Triangle { start: [GONE; 4], twin: [0; 4] };
        }
        // The way back from a is one from b by now.
        for (vertex, side) in [(b, ca), (c, bc), (d, ad)] {
            self.out[vertex as usize] = side;
        }
        self.out[a as usize] = GONE;
        self.points[b as usize] = at;
        self.live -= 1;
    }
}

//! A closed triangle surface that can be re-meshed in place: corners, twins, and the three moves on an edge.
//!
//! Triangle f owns the half-edges 3f, 3f + 1, 3f + 2; each starts at `start` and has its `twin` in the neighbour.
//! All moves keep the surface a closed oriented 2-manifold of the same genus: they refuse what would not. Edges can be
//! marked; a mark goes where its edge goes.

use super::{by_vertex::ByVertex, vector::V3};
use crate::watch::{Pulse, Stopped};

mod moves;
#[cfg(test)]
mod tests;

/// Marks a removed half-edge or vertex.
const GONE: u32 = u32::MAX;

/// The surface and the positions of its vertices.
#[derive(Debug, Clone)]
pub struct HalfEdges {
    pub points: Vec<V3>,
    start: Vec<u32>,
    twin: Vec<u32>,
    /// Whether the half-edge's edge is marked; both of its half-edges say so.
    marked: Vec<bool>,
    /// A half-edge that starts at the vertex.
    out: Vec<u32>,
    live: usize,
}

/// The area per vertex of the even triangle mesh with edges of length 1: √3/2.
pub const AREA_PER_VERTEX: f64 = 0.866_025_403_784_438_6;

/// The next half-edge in the triangle.
pub const fn next(h: u32) -> u32 {
    if h % 3 == 2 { h - 2 } else { h + 1 }
}

/// The previous half-edge in the triangle.
pub const fn prev(h: u32) -> u32 {
    if h.is_multiple_of(3) { h + 2 } else { h - 1 }
}

impl HalfEdges {
    /// The connectivity of a closed oriented manifold surface, no edge marked; none when an edge lacks its other side.
    ///
    /// # Errors
    /// When the watch cancels.
    pub fn new(points: Vec<V3>, triangles: &[[u32; 3]], pulse: &Pulse) -> Result<Option<Self>, Stopped> {
        let start = triangles.as_flattened().to_vec();
        let from_start = || (0_u32..).zip(&start).map(|(h, &a)| (a, h));
        let fans = ByVertex::new(points.len(), from_start, pulse)?;
        let mut out = vec![GONE; points.len()];
        let mut twin = vec![GONE; start.len()];
        for (h, &a) in (0_u32..).zip(&start) {
            out[a as usize] = h;
            let mut back = fans.of(start[next(h) as usize]).iter();
            let Some(&t) = back.find(|&&t| start[next(t) as usize] == a && twin[t as usize] == GONE) else {
                return Ok(None);
            };
            twin[t as usize] = h;
            pulse.beat(15)?;
        }
        let live = out.iter().filter(|&&h| h != GONE).count();
        let marked = vec![false; start.len()];
        Ok(Some(Self { points, start, twin, marked, out, live }))
    }

    /// The number of vertices left.
    pub const fn vertex_count(&self) -> usize {
        self.live
    }

    /// One more than the highest vertex index, removed ones included.
    pub fn vertex_slots(&self) -> u32 {
        self.out.len() as u32
    }

    /// One more than the highest half-edge index, removed ones included.
    pub fn slots(&self) -> u32 {
        self.start.len() as u32
    }

    pub fn has_vertex(&self, a: u32) -> bool {
        self.out[a as usize] != GONE
    }

    pub fn has(&self, h: u32) -> bool {
        self.start[h as usize] != GONE
    }

    pub fn start(&self, h: u32) -> u32 {
        self.start[h as usize]
    }

    pub fn end(&self, h: u32) -> u32 {
        self.start[next(h) as usize]
    }

    pub fn twin(&self, h: u32) -> u32 {
        self.twin[h as usize]
    }

    /// Whether the edge is marked.
    pub fn is_marked(&self, h: u32) -> bool {
        self.marked[h as usize]
    }

    /// Marks the edge, or takes its mark away.
    pub fn mark(&mut self, h: u32, marked: bool) {
        let t = self.twin(h);
        self.marked[h as usize] = marked;
        self.marked[t as usize] = marked;
    }

    /// The vertex across the edge, in the triangle of `h`.
    pub fn apex(&self, h: u32) -> u32 {
        self.start[prev(h) as usize]
    }

    /// The corners of the triangle whose first half-edge is `h`.
    pub fn corners(&self, h: u32) -> [u32; 3] {
        let h = h as usize;
        [self.start[h], self.start[h + 1], self.start[h + 2]]
    }

    pub fn point(&self, a: u32) -> V3 {
        self.points[a as usize]
    }

    pub fn length(&self, h: u32) -> f64 {
        (self.point(self.end(h)) - self.point(self.start(h))).norm()
    }

    /// The half-edges that start at `a`, in turn around it.
    pub fn around(&self, a: u32) -> impl Iterator<Item = u32> {
        let first = self.out[a as usize];
        let mut at = (first != GONE).then_some(first);
        std::iter::from_fn(move || {
            let h = at?;
            let after = self.twin[prev(h) as usize];
            at = (after != first).then_some(after);
            Some(h)
        })
    }

    /// The neighbours of `a`.
    pub fn neighbours(&self, a: u32) -> impl Iterator<Item = u32> {
        self.around(a).map(|h| self.end(h))
    }

    pub fn degree(&self, a: u32) -> usize {
        self.around(a).count()
    }

    /// The half-edges one per edge: those with the lower index.
    pub fn is_edge(&self, h: u32) -> bool {
        self.has(h) && h < self.twin(h)
    }

    /// The triangles left, as corners.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        self.start.as_chunks::<3>().0.iter().copied().filter(|t| t[0] != GONE)
    }

    /// The vertices and triangles left, in their order, renumbered; without the vertices from `but` and their
    /// triangles.
    pub fn parts(&self, but: std::ops::Range<u32>) -> (Vec<V3>, Vec<[u32; 3]>) {
        let mut renamed = vec![GONE; self.out.len()];
        let mut points = Vec::with_capacity(self.live);
        for a in (0..self.vertex_slots()).filter(|&a| self.has_vertex(a) && !but.contains(&a)) {
            renamed[a as usize] = points.len() as u32;
            points.push(self.point(a));
        }
        let triangles = self.triangles().map(|t| t.map(|a| renamed[a as usize]));
        (points, triangles.filter(|t| !t.contains(&GONE)).collect())
    }

    /// Number of components and sum of their genera.
    pub fn topology(&self) -> (usize, i64) {
        let mut seen = vec![false; self.out.len()];
        let (mut components, mut half_edges) = (0, 0_i64);
        for first in 0..self.vertex_slots() {
            if !self.has_vertex(first) || std::mem::replace(&mut seen[first as usize], true) {
                continue;
            }
            components += 1;
            let mut open = vec![first];
            while let Some(a) = open.pop() {
                for b in self.neighbours(a) {
                    half_edges += 1;
                    if !std::mem::replace(&mut seen[b as usize], true) {
                        open.push(b);
                    }
                }
            }
        }
        // V − E + F = 2 (components − genus), and 3 F = 2 E.
        let euler = self.live as i64 - half_edges / 6;
        (components, components as i64 - euler / 2)
    }
}

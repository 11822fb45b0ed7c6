//! A closed triangle surface that can be re-meshed in place: corners, twins, and the three moves on an edge.
//!
//! Triangle f owns the half-edges 4f, 4f + 1, 4f + 2, so that the next one is found without a division; each starts at
//! `start` and has its `twin` in the neighbour.
//! All moves keep the surface a closed oriented 2-manifold of the same genus: they refuse what would not. Edges can be
//! marked; a mark goes where its edge goes.

use super::{by_vertex::ByVertex, vector::V3};
use crate::watch::{Pulse, Stopped};

mod moves;
#[cfg(test)]
mod tests;

/// Marks a removed half-edge or vertex.
const GONE: u32 = u32::MAX;

/// A triangle: half of a line of the cache, so that a look at any part of it is a look at all.
#[derive(Debug, Clone, Copy)]
#[repr(align(32))]
struct Triangle {
    /// The corners, where the half-edges start; the last is `GONE`, all are once the triangle is removed.
    start: [u32; 4],
    /// The twins, all 0 once the triangle is removed; the last is a bit for each half-edge whose edge is marked.
    twin: [u32; 4],
}

/// The surface and the positions of its vertices.
#[derive(Debug, Clone)]
pub struct HalfEdges {
    pub points: Vec<V3>,
    triangles: Vec<Triangle>,
    /// A half-edge that starts at the vertex.
    out: Vec<u32>,
    live: usize,
}

/// The area per vertex of the even triangle mesh with edges of length 1: √3/2.
pub const AREA_PER_VERTEX: f64 = 0.866_025_403_784_438_6;

/// The next half-edge in the triangle.
pub const fn next(h: u32) -> u32 {
    // 2 is the only corner with its second bit set.
    h + 1 - 3 * ((h >> 1) & 1)
}

/// The previous half-edge in the triangle.
pub const fn prev(h: u32) -> u32 {
    if h.is_multiple_of(4) { h + 2 } else { h - 1 }
}

/// The triangle of a half-edge.
pub const fn triangle_of(h: u32) -> u32 {
    h >> 2
}

/// The half-edges of a triangle.
pub const fn sides(triangle: u32) -> [u32; 3] {
    let h = 4 * triangle;
    [h, h + 1, h + 2]
}

impl HalfEdges {
    /// The connectivity of a closed oriented manifold surface, no edge marked; none when an edge lacks its other side.
    ///
    /// # Errors
    /// When the watch cancels.
    pub fn new(points: Vec<V3>, triangles: &[[u32; 3]], pulse: &Pulse) -> Result<Option<Self>, Stopped> {
        let from_start = || (0..).zip(triangles).flat_map(|(at, &corners)| corners.into_iter().zip(sides(at)));
        let fans = ByVertex::new(points.len(), from_start, pulse)?;
        let mut mesh = Self::apart(points, triangles, pulse)?;
        for (a, h) in from_start() {
            let mut back = fans.of(mesh.end(h)).iter();
            let Some(&t) = back.find(|&&t| mesh.end(t) == a && mesh.twin(t) == GONE) else {
                return Ok(None);
            };
            *mesh.twin_mut(t) = h;
            pulse.beat(15)?;
        }
        Ok(Some(mesh))
    }

    /// The same where it is known already which half-edges are each other's twins: of triangle f, that of its edge i is
    /// at 3 f + i, and it is told in the same way.
    ///
    /// # Errors
    /// When the watch cancels.
    pub fn of_twins(points: Vec<V3>, triangles: &[[u32; 3]], twins: &[u32], pulse: &Pulse) -> Result<Self, Stopped> {
        let mut mesh = Self::apart(points, triangles, pulse)?;
        for (triangle, twins) in mesh.triangles.iter_mut().zip(twins.as_chunks::<3>().0) {
            for (twin, &its) in triangle.twin.iter_mut().zip(twins) {
                *twin = its + its / 3;
            }
            pulse.beat(5)?;
        }
        Ok(mesh)
    }

    /// Triangles without twins.
    fn apart(points: Vec<V3>, triangles: &[[u32; 3]], pulse: &Pulse) -> Result<Self, Stopped> {
        let mut out = vec![GONE; points.len()];
        let mut made = Vec::with_capacity(triangles.len());
        for (at, &[a, b, c]) in (0..).zip(triangles) {
            made.push(Triangle { start: [a, b, c, GONE], twin: [GONE, GONE, GONE, 0] });
            for (corner, h) in [a, b, c].into_iter().zip(sides(at)) {
                out[corner as usize] = h;
            }
            pulse.beat(10)?;
        }
        let live = out.iter().filter(|&&h| h != GONE).count();
        Ok(Self { points, triangles: made, out, live })
    }

    /// The number of vertices left.
    pub const fn vertex_count(&self) -> usize {
        self.live
    }

    /// One more than the highest vertex index, removed ones included.
    pub fn vertex_slots(&self) -> u32 {
        self.out.len() as u32
    }

    /// One more than the highest triangle index, removed ones included.
    pub fn triangle_slots(&self) -> u32 {
        self.triangles.len() as u32
    }

    /// One more than the highest half-edge index, removed ones and those that no triangle has included.
    pub fn slots(&self) -> u32 {
        4 * self.triangle_slots()
    }

    pub fn has_vertex(&self, a: u32) -> bool {
        self.out[a as usize] != GONE
    }

    pub fn has(&self, h: u32) -> bool {
        self.start(h) != GONE
    }

    fn triangle(&self, h: u32) -> &Triangle {
        &self.triangles[(h >> 2) as usize]
    }

    fn triangle_mut(&mut self, h: u32) -> &mut Triangle {
        &mut self.triangles[(h >> 2) as usize]
    }

    pub fn start(&self, h: u32) -> u32 {
        self.triangle(h).start[(h & 3) as usize]
    }

    fn start_mut(&mut self, h: u32) -> &mut u32 {
        &mut self.triangle_mut(h).start[(h & 3) as usize]
    }

    pub fn end(&self, h: u32) -> u32 {
        self.start(next(h))
    }

    pub fn twin(&self, h: u32) -> u32 {
        self.triangle(h).twin[(h & 3) as usize]
    }

    fn twin_mut(&mut self, h: u32) -> &mut u32 {
        &mut self.triangle_mut(h).twin[(h & 3) as usize]
    }

    /// Whether the edge is marked.
    pub fn is_marked(&self, h: u32) -> bool {
        (self.triangle(h).twin[3] >> (h & 3)) & 1 == 1
    }

    /// Marks the edge, or takes its mark away.
    pub fn mark(&mut self, h: u32, marked: bool) {
        self.mark_side(h, marked);
        self.mark_side(self.twin(h), marked);
    }

    /// Marks the edge as seen from one of its triangles.
    fn mark_side(&mut self, h: u32, marked: bool) {
        let marks = &mut self.triangle_mut(h).twin[3];
        *marks = (*marks & !(1 << (h & 3))) | (u32::from(marked) << (h & 3));
    }

    /// The vertex across the edge, in the triangle of `h`.
    pub fn apex(&self, h: u32) -> u32 {
        self.start(prev(h))
    }

    /// The corners of a triangle.
    pub fn corners(&self, triangle: u32) -> [u32; 3] {
        let [a, b, c, _] = self.triangles[triangle as usize].start;
        [a, b, c]
    }

    pub fn point(&self, a: u32) -> V3 {
        self.points[a as usize]
    }

    pub fn length(&self, h: u32) -> f64 {
        (self.point(self.end(h)) - self.point(self.start(h))).norm()
    }

    /// The half-edge from `a` at which [`HalfEdges::around`] begins.
    pub fn side_from(&self, a: u32) -> u32 {
        self.out[a as usize]
    }

    /// The half-edges that start at `a`, in turn around it.
    pub fn around(&self, a: u32) -> impl Iterator<Item = u32> {
        let first = self.out[a as usize];
        let mut at = (first != GONE).then_some(first);
        std::iter::from_fn(move || {
            let h = at?;
            let after = self.twin(prev(h));
            at = (after != first).then_some(after);
            Some(h)
        })
    }

    /// The neighbours of `a`, in turn around it, into a list.
    pub fn ring(&self, a: u32, ring: &mut Vec<u32>) {
        ring.clear();
        let first = self.out[a as usize];
        if first == GONE {
            return;
        }
        ring.push(self.end(first));
        let mut h = first;
        loop {
            // Across the triangle's other side at `a`, and that side's other end.
            let side = prev(h);
            h = self.twin(side);
            if h == first {
                return;
            }
            ring.push(self.start(side));
        }
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
        h & 3 != 3 && h < self.twin(h)
    }

    /// The same of each half-edge of a triangle.
    pub fn is_edges(&self, triangle: u32) -> [bool; 3] {
        let [h, i, j] = sides(triangle);
        let [t, u, v, _] = self.triangles[triangle as usize].twin;
        [h < t, i < u, j < v]
    }

    /// The triangles left, as corners.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> {
        let corners = self.triangles.iter().map(|&Triangle { start: [a, b, c, _], .. }| [a, b, c]);
        corners.filter(|t| t[0] != GONE)
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

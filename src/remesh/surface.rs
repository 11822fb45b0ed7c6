//! The input's surface: the nearest point near by, found by walking from triangle to triangle, and the way along its
//! creases.

use crate::{
    mesh::{
        halfedge::{HalfEdges, next, prev, sides, triangle_of},
        vector::{V3, greater},
    },
    watch::{Pulse, Stopped},
};

/// The length of normals on creases: the surface has several there, so that its normals beside say more of a triangle.
const FAINT: f64 = 0.01;

/// The surface that all vertices lie on. Half-edges of its creases are marked.
pub(super) struct Surface {
    pub(super) mesh: HalfEdges,
    /// Triangles from here on belong to ghosts.
    faces: u32,
    /// The normals of the triangles, as long as twice their areas, and these lengths.
    spans: Vec<(V3, f64)>,
    /// Unit normals of the vertices; zero where there is none, which is on creases.
    normals: Vec<V3>,
    /// The vertices on creases, and those where creases meet, bend or end.
    creased: Vec<bool>,
    corners: Vec<bool>,
    /// The greatest length of an edge at each vertex.
    limits: Vec<f64>,
}

/// A point of the surface.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spot {
    /// A half-edge of the triangle it lies in; on a crease, the crease's there.
    pub(super) side: u32,
    pub(super) at: V3,
    pub(super) normal: V3,
    /// The greatest length of an edge there.
    pub(super) limit: f64,
}

/// The nearest point of one triangle.
struct Near {
    at: V3,
    /// Barycentric coordinates.
    share: [f64; 3],
    distance2: f64,
}

impl Surface {
    /// The surface of a mesh that has `faces` triangles and those of its ghosts after them; without creases yet.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn new(mesh: HalfEdges, faces: u32, pulse: &Pulse) -> Result<Self, Stopped> {
        let count = mesh.vertex_slots() as usize;
        let mut spans = Vec::with_capacity(faces as usize);
        let mut normals = vec![V3::default(); count];
        for face in 0..faces {
            pulse.beat(30)?;
            let [a, b, c] = mesh.corners(face);
            let p = mesh.point(a);
            let normal = (mesh.point(b) - p).cross(mesh.point(c) - p);
            spans.push((normal, normal.norm()));
            for a in [a, b, c] {
                let at = &mut normals[a as usize];
                *at = *at + normal;
            }
        }
        for normal in &mut normals {
            *normal = normal.unit();
            pulse.beat(10)?;
        }
        Ok(Self {
            mesh,
            faces,
            spans,
            normals,
            creased: vec![false; count],
            corners: vec![false; count],
            limits: vec![0.0; count],
        })
    }

    /// The sum of the triangles' areas.
    pub(super) fn area(&self, pulse: &Pulse) -> Result<f64, Stopped> {
        let mut sum = 0.0;
        for (_, span) in &self.spans {
            sum += 0.5 * span;
            pulse.beat(4)?;
        }
        Ok(sum)
    }

    /// A third of the area of the triangles around each vertex.
    pub(super) fn areas(&self, pulse: &Pulse) -> Result<Vec<f64>, Stopped> {
        let mut areas = vec![0.0; self.mesh.vertex_slots() as usize];
        for (face, (_, span)) in (0..).zip(&self.spans) {
            let share = span / 6.0;
            pulse.beat(10)?;
            for a in self.mesh.corners(face) {
                areas[a as usize] += share;
            }
        }
        Ok(areas)
    }

    /// The normal of a triangle, as long as twice its area, and this length.
    pub(super) fn span(&self, face: u32) -> (V3, f64) {
        self.spans[face as usize]
    }

    /// The normal of a triangle, as long as twice its area.
    pub(super) fn face_normal(&self, face: u32) -> V3 {
        self.span(face).0
    }

    pub(super) fn face_count(&self) -> u32 {
        self.faces
    }

    /// The greatest length of an edge at a vertex.
    pub(super) fn limit(&self, a: u32) -> f64 {
        self.limits[a as usize]
    }

    pub(super) fn set_limits(&mut self, limits: Vec<f64>) {
        self.limits = limits;
    }

    pub(super) fn is_corner(&self, a: u32) -> bool {
        self.corners[a as usize]
    }

    /// The normal at a vertex, or a faint one on a crease.
    pub(super) fn normal(&self, a: u32) -> V3 {
        let normal = self.normals[a as usize];
        if normal != V3::default() {
            return normal;
        }
        let real = self.mesh.around(a).filter(|&h| self.is_real(h));
        real.fold(V3::default(), |sum, h| sum + self.face_normal(triangle_of(h))).unit() * FAINT
    }

    /// Takes over the marks of the mesh as creases; `is_corner` tells which of the vertices on them are corners.
    pub(super) fn set_creases(
        &mut self,
        is_corner: impl Fn(&HalfEdges, u32) -> bool,
        pulse: &Pulse,
    ) -> Result<(), Stopped> {
        for triangle in 0..self.mesh.triangle_slots() {
            pulse.beat(6)?;
            for h in sides(triangle) {
                let a = self.mesh.start(h);
                if self.mesh.is_marked(h) && !std::mem::replace(&mut self.creased[a as usize], true) {
                    pulse.beat(30)?;
                    self.normals[a as usize] = V3::default();
                    self.corners[a as usize] = is_corner(&self.mesh, a);
                }
            }
        }
        Ok(())
    }

    /// Whether a crease goes through a vertex; the boundary is one.
    pub(super) fn is_creased(&self, a: u32) -> bool {
        self.creased[a as usize]
    }

    pub(super) fn is_real(&self, h: u32) -> bool {
        triangle_of(h) < self.faces
    }

    /// The half-edge, or its twin where that one is a ghost's.
    fn real(&self, h: u32) -> u32 {
        if self.is_real(h) { h } else { self.mesh.twin(h) }
    }

    /// A half-edge of a real triangle from `a`.
    pub(super) fn side_at(&self, a: u32) -> u32 {
        self.mesh.around(a).find(|&h| self.is_real(h)).unwrap_or(0)
    }

    /// The point of the surface nearest to `p` among those that a descent from the triangle of `side` reaches.
    pub(super) fn nearest(&self, p: V3, side: u32) -> Spot {
        let (face, Near { at, share, .. }) = self.descend(p, side);
        let [x, y, z] = share;
        let [a, b, c] = self.mesh.corners(face);
        let limit = self.limit(a) * x + self.limit(b) * y + self.limit(c) * z;
        Spot { side: sides(face)[0], at, normal: self.normal_in(face, share), limit }
    }

    /// The point of [`Surface::nearest`] and its triangle alone.
    pub(super) fn nearest_point(&self, p: V3, side: u32) -> (V3, u32) {
        let (face, near) = self.descend(p, side);
        (near.at, face)
    }

    /// The triangle that a descent from that of `side` ends in, and its point nearest to `p`.
    fn descend(&self, p: V3, side: u32) -> (u32, Near) {
        const NONE: u32 = u32::MAX;
        // The triangle with the nearest point yet, and the one that had it before.
        let (mut face, mut before) = (NONE, NONE);
        let mut near = Near { at: p, share: [0.0; 3], distance2: f64::INFINITY };
        // What to look at: the triangle of `h`, or all around its start.
        let (mut h, mut around) = (side, false);
        loop {
            let (first, corner) = (h, near.at);
            let lead = |b: u32| (self.mesh.point(b) - corner).dot(p - corner);
            let mut along = if around { lead(self.mesh.end(h)) } else { 0.0 };
            let (mut better, mut limit) = (NONE, near.distance2 * (1.0 - 1e-9));
            loop {
                let other = triangle_of(h);
                // Those that are not nearer for sure: where both sides at the corner lead away from `p`, the one that
                // it is in, and the one that it came from.
                let mut is_out = other >= self.faces || other == face || other == before;
                if around {
                    let on = lead(self.mesh.apex(h));
                    is_out |= along <= 0.0 && on <= 0.0;
                    along = on;
                }
                if !is_out || face == NONE {
                    let it = self.near(other, p);
                    if it.distance2 < limit || face == NONE {
                        (better, limit, near) = (other, it.distance2, it);
                    }
                }
                h = self.mesh.twin(prev(h));
                if !around || h == first {
                    break;
                }
            }
            if better == NONE {
                break;
            }
            (before, face) = (face, better);
            // Only triangles at the nearest point can be nearer: that across a side, or those around a corner.
            let [a, b, c] = sides(face);
            (h, around) = match near.share {
                [x, y, z] if x > 0.0 && y > 0.0 && z > 0.0 => break,
                [_, 0.0, 0.0] => (self.mesh.side_from(self.mesh.start(a)), true),
                [0.0, _, 0.0] => (self.mesh.side_from(self.mesh.start(b)), true),
                [0.0, 0.0, _] => (self.mesh.side_from(self.mesh.start(c)), true),
                [_, _, 0.0] => (self.mesh.twin(a), false),
                [0.0, _, _] => (self.mesh.twin(b), false),
                _ => (self.mesh.twin(c), false),
            };
        }
        (face, near)
    }

    /// The normal within a triangle: between those of its corners; a corner on a crease has the triangle's own.
    fn normal_in(&self, face: u32, share: [f64; 3]) -> V3 {
        let (mut sum, mut creased) = (V3::default(), 0.0);
        for (a, share) in self.mesh.corners(face).into_iter().zip(share) {
            let normal = self.normals[a as usize];
            if normal == V3::default() {
                creased += share;
            } else {
                sum = sum + normal * share;
            }
        }
        if creased > 0.0 {
            sum = sum + self.face_normal(face).unit() * creased;
        }
        sum.unit()
    }

    /// The nearest point of a triangle (Ericson, *Real-Time Collision Detection*, 5.1.5). Of a triangle without an
    /// area, one of its sides.
    fn near(&self, face: u32, p: V3) -> Near {
        let [a, b, c] = self.mesh.corners(face);
        let corners = [self.mesh.point(a), self.mesh.point(b), self.mesh.point(c)];
        let (share, at) = nearest_of_triangle(p, corners);
        let off = p - at;
        Near { at, share, distance2: off.dot(off) }
    }

    /// The point nearest to `p` on the crease of `side`, among those that a descent along it reaches; it does not go
    /// beyond corners.
    pub(super) fn nearest_on_crease(&self, p: V3, side: u32) -> Spot {
        let mut h = side;
        let (mut t, mut at, mut distance2) = self.near_edge(h, p);
        loop {
            // Away from the end that is nearest.
            let end = if t <= 0.0 {
                self.mesh.start(h)
            } else if t >= 1.0 {
                self.mesh.end(h)
            } else {
                break;
            };
            if self.is_corner(end) {
                break;
            }
            let edge = self.mesh.twin(h);
            let Some(further) = self.mesh.around(end).find(|&o| self.mesh.is_marked(o) && o != h && o != edge) else {
                break;
            };
            let (t2, at2, further2) = self.near_edge(further, p);
            if further2 >= distance2 * (1.0 - 1e-9) {
                break;
            }
            (h, t, at, distance2) = (further, t2, at2, further2);
        }
        let normals = [h, self.mesh.twin(h)]
            .map(|side| if self.is_real(side) { self.face_normal(triangle_of(side)).unit() } else { V3::default() });
        let [one, two] = [self.mesh.start(h), self.mesh.end(h)].map(|a| self.limit(a));
        Spot { side: self.real(h), at, normal: (normals[0] + normals[1]).unit() * FAINT, limit: one + (two - one) * t }
    }

    /// The creases from a vertex.
    pub(super) fn creases_at(&self, a: u32) -> impl Iterator<Item = u32> {
        self.mesh.around(a).filter(|&h| self.mesh.is_marked(h)).map(|h| self.real(h))
    }

    pub(super) fn is_boundary(&self, h: u32) -> bool {
        self.is_real(h) != self.is_real(self.mesh.twin(h))
    }

    fn near_edge(&self, h: u32, p: V3) -> (f64, V3, f64) {
        let a = self.mesh.point(self.mesh.start(h));
        let along = self.mesh.point(self.mesh.start(next(h))) - a;
        let length2 = along.dot(along);
        let t = if length2 > 0.0 { ((p - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
        let at = a + along * t;
        let off = p - at;
        (t, at, off.dot(off))
    }
}

/// The barycentric coordinates and the place of the point of a triangle that is nearest to `p`.
#[inline(always)]
#[expect(clippy::inline_always, reason = "half of its time goes into passing corners and result through memory")]
pub(super) fn nearest_of_triangle(p: V3, [a, b, c]: [V3; 3]) -> ([f64; 3], V3) {
    let (ab, ac, ap) = (b - a, c - a, p - a);
    let (d1, d2) = (ab.dot(ap), ac.dot(ap));
    if d1 <= 0.0 && d2 <= 0.0 {
        return ([1.0, 0.0, 0.0], a);
    }
    let bp = p - b;
    let (d3, d4) = (ab.dot(bp), ac.dot(bp));
    if d3 >= 0.0 && d4 <= d3 {
        return ([0.0, 1.0, 0.0], b);
    }
    let vc = d1 * d4 - d3 * d2;
    if vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0 {
        let t = d1 / greater(d1 - d3, f64::MIN_POSITIVE);
        return ([1.0 - t, t, 0.0], a + ab * t);
    }
    let cp = p - c;
    let (d5, d6) = (ab.dot(cp), ac.dot(cp));
    if d6 >= 0.0 && d5 <= d6 {
        return ([0.0, 0.0, 1.0], c);
    }
    let vb = d5 * d2 - d1 * d6;
    if vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0 {
        let t = d2 / greater(d2 - d6, f64::MIN_POSITIVE);
        return ([1.0 - t, 0.0, t], a + ac * t);
    }
    let va = d3 * d6 - d5 * d4;
    if va <= 0.0 && d4 >= d3 && d5 >= d6 {
        let t = (d4 - d3) / greater(d4 - d3 + d5 - d6, f64::MIN_POSITIVE);
        return ([0.0, 1.0 - t, t], b + (c - b) * t);
    }
    let scale = 1.0 / (va + vb + vc);
    let (y, z) = (vb * scale, vc * scale);
    ([1.0 - y - z, y, z], a + ab * y + ac * z)
}

//! The last touches: slivers mended, vertices shaken as the tessellation will have it.

use super::polygonise::Surface;
use super::random::Random;
use super::remesh::{Remesher, SLIVER};
use super::vector::angle_of;
use crate::mesh::halfedge::sides;

impl Remesher<'_> {
    /// Rids the mesh of the slivers that the rounds could not: their shortest edge is collapsed, or the longest
    /// flipped, where that leaves the worst triangle better than it was.
    pub(super) fn mend(&mut self) {
        for _ in 0..6 {
            let mut left = false;
            for sides in (0..self.mesh.triangle_slots()).map(sides) {
                if !self.mesh.has(sides[0]) || self.side_quality(sides[0]) > SLIVER {
                    continue;
                }
                left = true;
                let by_length = |x: &&u32, y: &&u32| self.mesh.length(**x).total_cmp(&self.mesh.length(**y));
                let (Some(&short), Some(&long)) = (sides.iter().min_by(by_length), sides.iter().max_by(by_length))
                else {
                    continue;
                };
                if !self.try_collapse(short, f64::INFINITY, true) && self.flip_betters(long) && self.mesh.can_flip(long)
                {
                    self.mesh.flip(long);
                }
            }
            if !left {
                break;
            }
            self.relax();
        }
    }

    /// Pushes vertices at random along the surface, by at most `share` of their shortest edge.
    pub(super) fn jitter(&mut self, share: f64, random: &mut Random) {
        if share <= 0.0 {
            return;
        }
        for a in 0..self.mesh.vertex_slots() {
            if !self.mesh.has_vertex(a) {
                continue;
            }
            let (s, t) = self.normals[a as usize].tangents();
            let push = (s * random.about_zero(1.0) + t * random.about_zero(1.0)) * (share * self.shortest(a));
            let (p, normal) = self.onto(self.mesh.point(a) + push);
            if self.may_move(a, p, normal) {
                self.mesh.points[a as usize] = p;
                self.normals[a as usize] = normal;
            }
        }
    }

    /// Pushes vertices at random off the surface, with a deviation of `share` of their shortest edge.
    pub(super) fn roughen(&mut self, share: f64, random: &mut Random) {
        if share <= 0.0 {
            return;
        }
        for a in 0..self.mesh.vertex_slots() {
            if !self.mesh.has_vertex(a) {
                continue;
            }
            let normal = self.normals[a as usize];
            let p = self.mesh.point(a) + normal * (random.bell() * share * self.shortest(a));
            if self.may_move(a, p, normal) {
                self.mesh.points[a as usize] = p;
            }
        }
    }

    pub(super) fn shortest(&self, a: u32) -> f64 {
        self.mesh.around(a).map(|h| self.mesh.length(h)).fold(f64::MAX, f64::min)
    }
}

/// The smallest angle of any triangle, in degrees.
pub fn least_angle(surface: &Surface) -> f64 {
    let point = |i: u32| surface.points[i as usize];
    let mut least_tangent = f64::INFINITY;
    for t in &surface.triangles {
        for i in 0..3 {
            let (u, w) = (point(t[(i + 1) % 3]) - point(t[i]), point(t[(i + 2) % 3]) - point(t[i]));
            let (sine, cosine) = (u.cross(w).norm(), u.dot(w));
            if cosine > 0.0 {
                least_tangent = least_tangent.min(sine / cosine);
            }
        }
    }
    angle_of(1.0, least_tangent).to_degrees()
}

//! Vertices move along the surface towards the middle of their surroundings.

use super::{
    RemeshError,
    work::{IDLE, Kind, MOVE, Work, distance2},
};
use crate::{
    mesh::{halfedge::sides, vector::V3},
    watch::Stopped,
};

/// Ways that are not worth going, in squares of the length aimed at.
const STILL: f64 = 4e-4;
/// The share of the gaps that mends the area of a ball.
const SHARE: f64 = 0.625;
/// The greatest share of the gaps.
const GREATEST: f64 = 4.0;

impl Work<'_> {
    /// Moves every vertex once, one after the other.
    pub(super) fn relax(&mut self) -> Result<(), RemeshError> {
        let inverse = 1.0 / self.length;
        let weight = |a| {
            let share = self.size(a) * inverse;
            1.0 / (share * share * share * share)
        };
        let weights: Vec<f64> = (0..self.mesh.vertex_slots()).map(weight).collect();
        self.pulse.beat(5 * weights.len())?;
        let mut ring = std::mem::take(&mut self.rings[0]);
        for a in 0..self.mesh.vertex_slots() {
            self.pulse.beat(MOVE)?;
            if !self.mesh.has_vertex(a) || self.is_ghost(a) {
                continue;
            }
            self.mesh.ring(a, &mut ring);
            let spot = match self.kinds[a as usize] {
                Kind::Corner => continue,
                Kind::Crease => {
                    let Some(middle) = self.middle_of_crease(a) else { continue };
                    self.surface.nearest_on_crease(middle, self.sides[a as usize])
                }
                Kind::Free => {
                    let middle = self.middle(a, &ring, &weights);
                    if distance2(middle, self.mesh.point(a)) < STILL * self.size(a) * self.size(a) {
                        continue;
                    }
                    self.surface.nearest(middle, self.sides[a as usize])
                }
            };
            if self.may_move(a, &ring, spot.at, spot.normal) {
                self.mesh.points[a as usize] = spot.at;
                self.sides[a as usize] = spot.side;
                self.normals[a as usize] = spot.normal;
                self.limits[a as usize] = spot.limit;
            }
        }
        self.rings[0] = ring;
        Ok(())
    }

    /// Moves the free vertices off the surface by a common share of how far the triangles around them lie beneath it,
    /// so that the area is the surface's.
    ///
    /// With all vertices on a curved surface the triangles are chords, and the area of a ball of radius r comes out too
    /// small by 5/24 (length/r)². The share that mends that is 5/8 of the mean gap at the triangles' centres. On relief
    /// that is finer than the triangles it is more, and makes what is left of the relief stronger. It is found by two
    /// secants, and bounded where more than relief was lost.
    pub(super) fn balance(&mut self) -> Result<(), RemeshError> {
        let wanted = self.surface.area(self.pulse)?;
        let shifts = self.shifts()?;
        let mut moved: Vec<V3> = Vec::with_capacity(shifts.len());
        let mut area = |share: f64| -> Result<f64, Stopped> {
            moved.clear();
            moved.extend(self.mesh.points.iter().zip(&shifts).map(|(&point, &shift)| point + shift * share));
            self.pulse.beat(5 * moved.len())?;
            let mut sum = 0.0;
            for triangle in self.mesh.triangles().filter(|t| !t.iter().any(|&a| self.is_ghost(a))) {
                let [p, q, r] = triangle.map(|a| moved[a as usize]);
                sum += 0.5 * (q - p).cross(r - p).norm();
                self.pulse.beat(15)?;
            }
            Ok(sum)
        };
        let (now, then) = (area(0.0)?, area(SHARE)?);
        let secant = |share: f64, then: f64| {
            if then > now { (share * (wanted - now) / (then - now)).clamp(0.0, GREATEST) } else { 0.0 }
        };
        let first = secant(SHARE, then);
        let share = secant(first, area(first)?);
        for (point, shift) in self.mesh.points.iter_mut().zip(shifts) {
            *point = *point + shift * share;
        }
        Ok(())
    }

    /// For each free vertex the mean gap between the triangles around it and the surface, along its normal.
    fn shifts(&self) -> Result<Vec<V3>, Stopped> {
        let slots = self.mesh.vertex_slots() as usize;
        let (mut gaps, mut weights) = (vec![0.0; slots], vec![0.0; slots]);
        for triangle in 0..self.mesh.triangle_slots() {
            self.pulse.beat(IDLE)?;
            let corners = self.mesh.corners(triangle);
            if !self.mesh.has(sides(triangle)[0]) || corners.iter().any(|&a| self.is_ghost(a)) {
                continue;
            }
            let [p, q, r] = corners.map(|a| self.mesh.point(a));
            self.pulse.beat(MOVE)?;
            let normal = (q - p).cross(r - p);
            let area = normal.norm();
            let centre = (p + q + r) * (1.0 / 3.0);
            let (at, _) = self.surface.nearest_point(centre, self.sides[corners[0] as usize]);
            let gap = (at - centre).dot(normal.unit());
            for a in corners {
                gaps[a as usize] += gap * area;
                weights[a as usize] += area;
            }
        }
        let shift = |a: usize| match self.kinds[a] {
            Kind::Free if weights[a] > 0.0 => {
                self.normals[a] * (gaps[a] / weights[a]).clamp(-0.25 * self.size(a as u32), 0.25 * self.size(a as u32))
            }
            _ => V3::default(),
        };
        Ok((0..slots).map(shift).collect())
    }

    /// The centre of mass of the triangles around a free vertex with these neighbours, in its tangent plane.
    fn middle(&self, a: u32, ring: &[u32], weights: &[f64]) -> V3 {
        let here = self.mesh.point(a);
        let (mut sum, mut weight, mut normal) = (V3::default(), 0.0, V3::default());
        let Some(&first) = ring.first() else { return here };
        let own = weights[a as usize];
        let (mut u, mut dense) = (self.mesh.point(first) - here, weights[first as usize]);
        for &y in ring[1..].iter().chain([&first]) {
            let (w, denser) = (self.mesh.point(y) - here, weights[y as usize]);
            let cross = u.cross(w);
            // Centroidal cells have sizes s where the density is s⁻⁴.
            let area = cross.norm() * (own + dense + denser);
            sum = sum + (u + w) * area;
            weight += area;
            normal = normal + cross;
            (u, dense) = (w, denser);
        }
        if weight <= 0.0 {
            return here;
        }
        let pull = sum * (1.0 / (3.0 * weight));
        let normal = normal.unit();
        here + pull - normal * pull.dot(normal)
    }

    /// The middle between the neighbours along the crease.
    fn middle_of_crease(&self, a: u32) -> Option<V3> {
        let mut neighbours = self.mesh.around(a).filter(|&h| self.mesh.is_marked(h)).map(|h| self.mesh.end(h));
        let (b, c) = (neighbours.next()?, neighbours.next()?);
        Some(self.mesh.point(b).lerp(self.mesh.point(c), 0.5))
    }
}

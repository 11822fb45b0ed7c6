//! Creases: edges of the solid that are sharper than the mesh can follow. Vertices are laid onto them instead.

use super::remesh::Remesher;
use super::vector::{V3, v};

/// What the surface does around a vertex.
enum Bend {
    /// It bends with this curvature, which is for edge lengths to follow.
    Round(f64),
    /// It has a crease.
    Crease,
}

impl Remesher<'_> {
    /// The curvatures for edge lengths to follow, at every vertex; those at creases are no shorter for them.
    pub(super) fn bends(&self) -> Vec<f64> {
        let at = |a: u32| match self.mesh.has_vertex(a).then(|| self.bend(a)) {
            Some(Bend::Round(curvature)) => curvature,
            Some(Bend::Crease) => 1.0 / self.mean,
            None => 0.0,
        };
        (0..self.mesh.vertex_slots()).map(at).collect()
    }

    fn bend(&self, a: u32) -> Bend {
        let (p, normal) = (self.mesh.point(a), self.normals[a as usize]);
        let curvature = self.solid.curvature(p, normal, 0.3 * self.mean);
        // A thin limb bends as sharply as a crease does, but there is little below its surface.
        let sharp = curvature * self.mean > 2.0;
        if sharp && self.solid.distance(p - normal * (0.8 * self.mean)) < -0.3 * self.mean {
            Bend::Crease
        } else {
            Bend::Round(curvature)
        }
    }

    /// Whether the surface is flat at `a` and turned at a neighbour.
    fn is_beside_crease(&self, a: u32, curvature: f64) -> bool {
        let normal = self.normals[a as usize];
        curvature * self.mean < 0.4 && self.mesh.neighbours(a).any(|b| normal.dot(self.normals[b as usize]) < 0.85)
    }

    /// Moves vertices near a crease that is sharper than the mesh onto it: to where the tangent planes at the
    /// triangles around meet (Ohtake and Belyaev 2002).
    pub(super) fn sharpen(&mut self) {
        for a in 0..self.mesh.vertex_slots() {
            if !self.mesh.has_vertex(a) {
                continue;
            }
            let here = self.mesh.point(a);
            if let Bend::Round(curvature) = self.bend(a)
                && !self.is_beside_crease(a, curvature)
            {
                continue;
            }
            let mut planes = Planes::near(here);
            for h in self.mesh.around(a) {
                let (q, r) = (self.mesh.point(self.mesh.end(h)), self.mesh.point(self.mesh.apex(h)));
                let (p, normal) = self.onto((here + q + r) * (1.0 / 3.0));
                planes.add(p, normal, (q - here).cross(r - here).norm());
            }
            let (meeting, normal) = planes.meet();
            let push = meeting - here;
            let most = 0.4 * self.shortest(a);
            let p = if push.norm() > most { here + push.unit() * most } else { meeting };
            if self.may_move(a, p, normal) {
                self.mesh.points[a as usize] = p;
                self.normals[a as usize] = normal;
            }
        }
    }
}

/// The point that is nearest to a set of weighted planes, by least squares.
struct Planes {
    /// Where the point stays in the directions that the planes leave free.
    from: V3,
    weight: f64,
    normal: V3,
    /// Σ w n nᵀ as its rows, and Σ w n (n·(p − from)).
    rows: [V3; 3],
    right: V3,
}

impl Planes {
    fn near(from: V3) -> Self {
        Self { from, weight: 0.0, normal: V3::default(), rows: [V3::default(); 3], right: V3::default() }
    }

    fn add(&mut self, p: V3, normal: V3, weight: f64) {
        self.weight += weight;
        self.normal = self.normal + normal * weight;
        for (row, n) in self.rows.iter_mut().zip([normal.x, normal.y, normal.z]) {
            *row = *row + normal * (n * weight);
        }
        self.right = self.right + normal * (normal.dot(p - self.from) * weight);
    }

    /// The point, and the mean normal.
    fn meet(mut self) -> (V3, V3) {
        let ease = 0.03 * self.weight;
        self.rows[0].x += ease;
        self.rows[1].y += ease;
        self.rows[2].z += ease;
        let [a, b, c] = self.rows;
        // The matrix is symmetric, so its rows are its columns: Cramer's rule.
        let volume = a.dot(b.cross(c));
        let r = self.right;
        let push = v(r.dot(b.cross(c)), a.dot(r.cross(c)), a.dot(b.cross(r))) * (1.0 / volume.max(1e-300));
        (self.from + push, self.normal.unit())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{
        polygonise::polygonise,
        primitive::Primitive,
        random::Random,
        sizing::Tessellation,
        solid::Solid,
        vector::{Frame, V3, v},
    };
    use super::*;

    #[test]
    fn planes_meet_in_a_corner() {
        let mut planes = Planes::near(v(0.9, 1.1, 0.8));
        for normal in [v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(0.0, 0.0, 1.0)] {
            planes.add(v(1.0, 1.0, 1.0), normal, 1.0);
        }
        let (corner, normal) = planes.meet();
        assert!((corner - v(1.0, 1.0, 1.0)).norm() < 0.03, "{corner:?}");
        assert!((normal - v(1.0, 1.0, 1.0).unit()).norm() < 1e-12);
    }

    #[test]
    fn a_box_keeps_its_edges() {
        let frame = Frame::at(V3::default()).turned(v(0.6, 0.0, 0.8), 0.5);
        let solid: Solid = Primitive::cuboid(frame, v(0.5, 0.5, 0.5), 0.01).into();
        let style = Tessellation { vertices: 400, adapt: 0.4, waves: Vec::new(), depth: 0.0, jitter: 0.0, noise: 0.0 };
        let remesher = Remesher::new(&solid, polygonise(&solid, 0.06), 0.06).unwrap();
        let surface = remesher.run(&style, &mut Random::new(1, "box", 0, 0, "mesh"));
        let p = |i: u32| surface.points[i as usize];
        let volume: f64 = surface.triangles.iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c))) / 6.0).sum();
        // Edges of length 0.12 that miss the box's edges would cut some hundredths off.
        assert!((0.985..1.005).contains(&volume), "{volume}");
    }
}

//! The polygonised surface → a mesh with the wanted number of well-shaped triangles.
//!
//! Rounds of splitting long edges, collapsing short ones, flipping to Delaunay and relaxing along the surface (Botsch
//! and Kobbelt 2004), with edge lengths that follow the curvature (Dunyach et al. 2013). Every new or moved vertex is
//! projected onto the solid's field, so the rounds do not wear the shape down.

use super::polygonise::Surface;
use super::random::Random;
use super::sizing::{Tessellation, even_length, sizes};
use super::solid::Solid;
use super::vector::V3;
use crate::{
    mesh::halfedge::HalfEdges,
    watch::{Pulse, Unwatched},
};

/// Rounds after which the mesh has settled, and at most.
const ROUNDS: (usize, usize) = (7, 16);
/// Of the wanted number of vertices, how far off is near enough.
const NEAR: f64 = 0.05;
/// Twice the area over the square of the longest side, below which a triangle is not made.
pub(super) const SLIVER: f64 = 0.15;

/// A surface on its way to a mesh.
#[derive(Clone)]
pub struct Remesher<'a> {
    pub(super) solid: &'a Solid,
    pub(super) mesh: HalfEdges,
    /// The surface's normals at the vertices.
    pub(super) normals: Vec<V3>,
    /// Of the grid that the surface was polygonised on.
    step: f64,
    /// The length that the edges would have if all were alike.
    pub(super) mean: f64,
}

impl<'a> Remesher<'a> {
    /// Takes the surface of `solid` as polygonised on a grid of `step`; none when it is not closed.
    pub fn new(solid: &'a Solid, surface: Surface, step: f64) -> Option<Self> {
        let mesh = HalfEdges::new(surface.points, &surface.triangles, &Pulse::new(&Unwatched)).ok()??;
        let mut normals = vec![V3::default(); mesh.vertex_slots() as usize];
        for [a, b, c] in mesh.triangles() {
            let [p, q, r] = [a, b, c].map(|x| mesh.point(x));
            let area = (q - p).cross(r - p);
            for x in [a, b, c] {
                normals[x as usize] = normals[x as usize] + area;
            }
        }
        for normal in &mut normals {
            *normal = normal.unit();
        }
        Some(Self { solid, mesh, normals, step, mean: step })
    }

    /// Number of components and genus.
    pub fn topology(&self) -> (usize, i64) {
        self.mesh.topology()
    }

    /// Re-meshes to about `style.vertices` vertices and roughens the result as `style` says.
    pub fn run(mut self, style: &Tessellation, random: &mut Random) -> Surface {
        let target = style.vertices as f64;
        // The grid's slivers go first: curvature need not be known at every one of them.
        let fine = vec![1.1 * self.step; self.mesh.vertex_slots() as usize];
        for _ in 0..3 {
            self.collapse(&fine, false);
        }
        let mut aim = target;
        for round in 0..ROUNDS.1 {
            self.mean = even_length(&self.mesh, aim);
            let mut wanted = sizes(&self.mesh, style, &self.bends(), aim);
            self.split(&mut wanted);
            self.collapse(&wanted, true);
            self.flip();
            self.relax();
            self.flip();
            self.relax();
            self.sharpen();
            self.flip();
            let ratio = self.mesh.vertex_count() as f64 / target;
            if round + 1 >= ROUNDS.0 && (ratio - 1.0).abs() < NEAR {
                break;
            }
            if round > 0 {
                aim = (aim / ratio.clamp(0.6, 1.6)).clamp(0.3 * target, 3.0 * target);
            }
        }
        self.mend();
        self.jitter(style.jitter, random);
        self.roughen(style.noise, random);
        let (points, triangles) = self.mesh.parts(0..0);
        Surface { points, triangles }
    }

    /// The point of the surface nearest `p`, about, and the normal there.
    pub(super) fn onto(&self, p: V3) -> (V3, V3) {
        self.solid.project(p, 2.0 * self.step)
    }

    fn split(&mut self, wanted: &mut Vec<f64>) {
        for h in 0..self.mesh.slots() {
            if !self.mesh.is_edge(h) {
                continue;
            }
            let (a, b) = (self.mesh.start(h), self.mesh.end(h));
            let size = 0.5 * (wanted[a as usize] + wanted[b as usize]);
            if self.mesh.length(h) > 4.0 / 3.0 * size {
                let (p, normal) = self.onto(self.mesh.point(a).lerp(self.mesh.point(b), 0.5));
                self.mesh.split(h, p);
                self.normals.push(normal);
                wanted.push(size);
            }
        }
    }

    /// Collapses short edges into their middle, which is put onto the surface where `exact`.
    fn collapse(&mut self, wanted: &[f64], exact: bool) {
        for h in 0..self.mesh.slots() {
            if !self.mesh.is_edge(h) {
                continue;
            }
            let (a, b) = (self.mesh.start(h), self.mesh.end(h));
            let size = 0.5 * (wanted[a as usize] + wanted[b as usize]);
            if self.mesh.length(h) < 0.8 * size {
                self.try_collapse(h, 1.5 * size, exact);
            }
        }
    }

    /// Collapses an edge into its middle unless that makes an edge of `longest`, or triangles that are bad and worse
    /// than those there are.
    pub(super) fn try_collapse(&mut self, h: u32, longest: f64, exact: bool) -> bool {
        if !self.mesh.can_collapse(h) {
            return false;
        }
        let (a, b) = (self.mesh.start(h), self.mesh.end(h));
        let [pa, pb] = [a, b].map(|x| self.mesh.point(x));
        let [na, nb] = [a, b].map(|x| self.normals[x as usize]);
        let middle = pa.lerp(pb, 0.5);
        let (p, normal) = if exact { self.onto(middle) } else { (middle, (na + nb).unit()) };
        let new = self.ring_quality(a, p, normal, Some(b)).min(self.ring_quality(b, p, normal, Some(a)));
        let old = || self.ring_quality(a, pa, na, None).min(self.ring_quality(b, pb, nb, None));
        let reaches = |x: u32| (self.mesh.point(x) - p).norm() < longest;
        let fits = (new > SLIVER || new > old())
            && self.mesh.neighbours(a).all(reaches)
            && self.mesh.neighbours(b).all(reaches);
        if fits {
            self.mesh.collapse(h, p);
            self.normals[b as usize] = normal;
        }
        fits
    }

    /// The quality of the triangle of a half-edge.
    pub(super) fn side_quality(&self, h: u32) -> f64 {
        let [a, b, c] = [self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h)];
        let [p, q, r] = [a, b, c].map(|x| self.mesh.point(x));
        self.quality([p, q, r], self.normals[a as usize], [b, c])
    }

    /// Whether the worse of the edge's two triangles would be better, flipped.
    pub(super) fn flip_betters(&self, h: u32) -> bool {
        let t = self.mesh.twin(h);
        let new = self.flipped_quality(h);
        new > self.side_quality(h).min(self.side_quality(t))
    }

    /// The worse quality of the two triangles that there would be with the other diagonal.
    fn flipped_quality(&self, h: u32) -> f64 {
        let t = self.mesh.twin(h);
        let (a, b, c, d) = (self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h), self.mesh.apex(t));
        let [pa, pb, pc, pd] = [a, b, c, d].map(|x| self.mesh.point(x));
        let normal = |x: u32| self.normals[x as usize];
        self.quality([pa, pd, pc], normal(a), [d, c]).min(self.quality([pb, pc, pd], normal(b), [c, d]))
    }

    /// How good a triangle is: twice its area over the square of its longest side, at most 0.87; negative when it does
    /// not face as its corners' normals do on the whole.
    fn quality(&self, [p, q, r]: [V3; 3], normal: V3, others: [u32; 2]) -> f64 {
        let cross = (q - p).cross(r - p);
        let double_area = cross.norm();
        let (u, w, t) = (q - p, r - q, p - r);
        let shape = double_area / u.dot(u).max(w.dot(w)).max(t.dot(t)).max(1e-300);
        // Against their sum: at a crease one corner's normal may be at a right angle to the triangle.
        let sum = others.iter().fold(normal, |sum, &x| sum + self.normals[x as usize]);
        if cross.dot(sum) > 0.5 * double_area * sum.norm() { shape } else { shape - 1.0 }
    }

    /// The worst quality around `a` if it were at `p`, leaving out the triangles that have `other`.
    fn ring_quality(&self, a: u32, p: V3, normal: V3, other: Option<u32>) -> f64 {
        let mut worst = f64::INFINITY;
        for h in self.mesh.around(a) {
            let (x, y) = (self.mesh.end(h), self.mesh.apex(h));
            if other != Some(x) && other != Some(y) {
                worst = worst.min(self.quality([p, self.mesh.point(x), self.mesh.point(y)], normal, [x, y]));
            }
        }
        worst
    }

    /// Whether `a` may move to `p`: the triangles around it are good there, or better than now.
    pub(super) fn may_move(&self, a: u32, p: V3, normal: V3) -> bool {
        let new = self.ring_quality(a, p, normal, None);
        new > SLIVER || new > self.ring_quality(a, self.mesh.point(a), self.normals[a as usize], None)
    }

    /// Flips edges whose opposite angles sum to more than π, until none is left or nearly so.
    fn flip(&mut self) {
        for _ in 0..4 {
            let mut flipped = 0;
            for h in 0..self.mesh.slots() {
                if self.mesh.is_edge(h) && self.wants_flip(h) && self.mesh.can_flip(h) {
                    self.mesh.flip(h);
                    flipped += 1;
                }
            }
            if flipped == 0 {
                break;
            }
        }
    }

    fn wants_flip(&self, h: u32) -> bool {
        let t = self.mesh.twin(h);
        let (a, b, c, d) = (self.mesh.start(h), self.mesh.end(h), self.mesh.apex(h), self.mesh.apex(t));
        let [pa, pb, pc, pd] = [a, b, c, d].map(|x| self.mesh.point(x));
        let cotangent = |apex: V3| {
            let (u, w) = (pa - apex, pb - apex);
            u.dot(w) / u.cross(w).norm().max(1e-30)
        };
        let excess = -(cotangent(pc) + cotangent(pd));
        let (one, two) = ((pb - pa).cross(pc - pa), (pa - pb).cross(pd - pb));
        if one.dot(two) > 0.85 * one.norm() * two.norm() {
            if excess < 1e-6 {
                return false;
            }
        } else {
            // Across or along a crease: the diagonal that lies nearer to the surface.
            let off = |p: V3, q: V3| self.solid.distance(p.lerp(q, 0.5)).abs();
            let (now, then) = (off(pa, pb), off(pc, pd));
            if then >= now || (excess < 1e-6 && then > 0.5 * now) {
                return false;
            }
        }
        let new = self.flipped_quality(h);
        new > SLIVER || new > self.side_quality(h).min(self.side_quality(t))
    }

    /// Moves every vertex along the surface towards the middle of its neighbours.
    pub(super) fn relax(&mut self) {
        for a in 0..self.mesh.vertex_slots() {
            if !self.mesh.has_vertex(a) {
                continue;
            }
            let (sum, count) =
                self.mesh.neighbours(a).fold((V3::default(), 0.0), |(sum, n), b| (sum + self.mesh.point(b), n + 1.0));
            let here = self.mesh.point(a);
            let pull = sum * (1.0 / count) - here;
            let normal = self.normals[a as usize];
            let along = (pull - normal * pull.dot(normal)) * 0.8;
            let (p, normal) = self.onto(here + along);
            if self.may_move(a, p, normal) {
                self.mesh.points[a as usize] = p;
                self.normals[a as usize] = normal;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::finish::least_angle;
    use super::super::polygonise::polygonise;
    use super::super::primitive::Primitive;
    use super::super::vector::{Frame, v};
    use super::*;

    fn topology(surface: Surface) -> (usize, i64) {
        let mesh = HalfEdges::new(surface.points, &surface.triangles, &Pulse::new(&Unwatched));
        mesh.unwrap().unwrap().topology()
    }

    fn plain(vertices: usize) -> Tessellation {
        Tessellation { vertices, adapt: 0.4, waves: Vec::new(), depth: 0.0, jitter: 0.0, noise: 0.0 }
    }

    fn remeshed(solid: &Solid, style: &Tessellation) -> Surface {
        let surface = polygonise(solid, 0.06);
        let remesher = Remesher::new(solid, surface, 0.06).unwrap();
        remesher.run(style, &mut Random::new(1, "test", 0, 0, "mesh"))
    }

    #[test]
    fn a_torus_is_cut_into_good_triangles_on_its_surface() {
        let solid: Solid = Primitive::ring(Frame::at(v(0.0, 0.0, 0.0)), 1.0, 0.3).into();
        for count in [500, 4000] {
            let surface = remeshed(&solid, &plain(count));
            assert!((surface.points.len() as f64 / count as f64 - 1.0).abs() < 0.1, "{}", surface.points.len());
            assert!(least_angle(&surface) > 15.0, "{}", least_angle(&surface));
            assert!(surface.points.iter().all(|&p| solid.distance(p).abs() < 1e-5));
            assert_eq!(topology(surface), (1, 1));
        }
    }

    #[test]
    fn thin_limbs_keep_their_round() {
        let solid = Solid::union(
            0.05,
            [
                Primitive::limb(v(0.0, 0.0, 0.0), v(0.0, 0.0, 0.0), 1.0, 1.0),
                Primitive::limb(v(0.9, 0.0, 0.0), v(2.5, 0.0, 0.0), 0.08, 0.06),
            ]
            .map(Solid::from),
        );
        let surface = remeshed(&solid, &plain(600));
        let on_limb = surface.points.iter().filter(|p| p.x > 1.2).count();
        assert!(on_limb > 60, "{on_limb} vertices on the limb");
        assert_eq!(topology(surface), (1, 0));
    }
}

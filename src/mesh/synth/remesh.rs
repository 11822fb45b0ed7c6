//! The polygonised surface → a mesh with the wanted number of well-shaped triangles.
//!
//! Rounds of splitting long edges, collapsing short ones, flipping to Delaunay and relaxing along the surface (Botsch
//! and Kobbelt 2004), with edge lengths that follow the curvature (Dunyach et al. 2013). Every new or moved vertex is
//! projected onto the solid's field, so the rounds do not wear the shape down.

use super::halfedge::HalfEdges;
use super::polygonise::Surface;
use super::random::Random;
use super::sizing::{Tessellation, sizes};
use super::solid::Solid;
use super::vector::V3;

/// Rounds after which the mesh has settled, and at most.
const ROUNDS: (usize, usize) = (7, 16);
/// Of the wanted number of vertices, how far off is near enough.
const NEAR: f64 = 0.05;
/// Twice the area over the square of the longest side, below which a triangle is not made.
const SLIVER: f64 = 0.15;

/// A surface on its way to a mesh.
pub struct Remesher<'a> {
    solid: &'a Solid,
    mesh: HalfEdges,
    normals: Vec<V3>,
    /// Over which the field is differentiated.
    step: f64,
}

impl<'a> Remesher<'a> {
    /// Takes the surface of `solid` as polygonised on a grid of `step`; none when it is not closed.
    pub fn new(solid: &'a Solid, surface: Surface, step: f64) -> Option<Self> {
        let mesh = HalfEdges::new(surface)?;
        let mut remesher = Self { solid, normals: vec![V3::default(); mesh.vertex_slots() as usize], mesh, step };
        for (normal, &p) in remesher.normals.iter_mut().zip(&remesher.mesh.points) {
            *normal = solid.gradient(p, 0.2 * step).unit();
        }
        Some(remesher)
    }

    /// Number of components and genus.
    pub fn topology(&self) -> (usize, i64) {
        self.mesh.topology()
    }

    /// Re-meshes to about `style.vertices` vertices and roughens the result as `style` says.
    pub fn run(mut self, style: &Tessellation, random: &mut Random) -> Surface {
        let target = style.vertices as f64;
        // The grid's slivers go first: curvature need not be known at every one of them.
        let fine = vec![1.6 * self.step; self.mesh.vertex_slots() as usize];
        for _ in 0..3 {
            self.collapse(&fine);
        }
        let mut aim = target;
        for round in 0..ROUNDS.1 {
            let bends = self.bends();
            let mut wanted = sizes(&self.mesh, style, &bends, aim);
            self.split(&mut wanted);
            self.collapse(&wanted);
            self.flip();
            self.relax();
            self.flip();
            self.relax();
            let ratio = self.mesh.vertex_count() as f64 / target;
            if round + 1 >= ROUNDS.0 && (ratio - 1.0).abs() < NEAR {
                break;
            }
            if round > 0 {
                aim = (aim / ratio.clamp(0.6, 1.6)).clamp(0.3 * target, 3.0 * target);
            }
        }
        self.flip();
        self.jitter(style.jitter, random);
        self.roughen(style.noise, random);
        self.mesh.surface()
    }

    /// The point of the surface nearest `p`, about, and the normal there.
    fn onto(&self, p: V3) -> (V3, V3) {
        let q = self.solid.project(p, 0.2 * self.step, 2.0 * self.step);
        (q, self.solid.gradient(q, 0.2 * self.step).unit())
    }

    fn bends(&self) -> Vec<f64> {
        let at = |a: u32| {
            if self.mesh.has_vertex(a) {
                self.solid.curvature(self.mesh.point(a), self.normals[a as usize], self.step)
            } else {
                0.0
            }
        };
        (0..self.mesh.vertex_slots()).map(at).collect()
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

    fn collapse(&mut self, wanted: &[f64]) {
        for h in 0..self.mesh.slots() {
            if !self.mesh.is_edge(h) {
                continue;
            }
            let (a, b) = (self.mesh.start(h), self.mesh.end(h));
            let size = 0.5 * (wanted[a as usize] + wanted[b as usize]);
            if self.mesh.length(h) >= 0.8 * size || !self.mesh.can_collapse(h) {
                continue;
            }
            let (p, normal) = self.onto(self.mesh.point(a).lerp(self.mesh.point(b), 0.5));
            let [pa, pb] = [a, b].map(|x| self.mesh.point(x));
            let new = self.ring_quality(a, p, normal, Some(b)).min(self.ring_quality(b, p, normal, Some(a)));
            let old = || {
                let at_a = self.ring_quality(a, pa, self.normals[a as usize], None);
                at_a.min(self.ring_quality(b, pb, self.normals[b as usize], None))
            };
            let reaches = |x: u32| (self.mesh.point(x) - p).norm() < 1.5 * size;
            if (new > SLIVER || new > old())
                && self.mesh.neighbours(a).all(reaches)
                && self.mesh.neighbours(b).all(reaches)
            {
                self.mesh.collapse(h, p);
                self.normals[b as usize] = normal;
            }
        }
    }

    /// How good a triangle is: twice its area over the square of its longest side, at most 0.87; negative when it does
    /// not face as its corners' normals do.
    fn quality(&self, [p, q, r]: [V3; 3], normal: V3, others: [u32; 2]) -> f64 {
        let cross = (q - p).cross(r - p);
        let double_area = cross.norm();
        let (u, w, t) = (q - p, r - q, p - r);
        let shape = double_area / u.dot(u).max(w.dot(w)).max(t.dot(t)).max(1e-300);
        let faces = cross.dot(normal) > 0.25 * double_area
            && others.iter().all(|&x| cross.dot(self.normals[x as usize]) > 0.1 * double_area);
        if faces { shape } else { shape - 1.0 }
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
    fn may_move(&self, a: u32, p: V3, normal: V3) -> bool {
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
        if cotangent(pc) + cotangent(pd) > -1e-6 {
            return false;
        }
        let normal = |x: u32| self.normals[x as usize];
        let new = self.quality([pa, pd, pc], normal(a), [d, c]).min(self.quality([pb, pc, pd], normal(b), [c, d]));
        new > SLIVER
            || new > self.quality([pa, pb, pc], normal(a), [b, c]).min(self.quality([pb, pa, pd], normal(b), [a, d]))
    }

    /// Moves every vertex along the surface towards the middle of its neighbours.
    fn relax(&mut self) {
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

    /// Pushes vertices at random along the surface, by at most `share` of their shortest edge.
    fn jitter(&mut self, share: f64, random: &mut Random) {
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
    fn roughen(&mut self, share: f64, random: &mut Random) {
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

    fn shortest(&self, a: u32) -> f64 {
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
    super::vector::angle_of(1.0, least_tangent).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::super::polygonise::polygonise;
    use super::super::primitive::Primitive;
    use super::super::vector::{Frame, v};
    use super::*;

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
            assert_eq!(HalfEdges::new(surface).unwrap().topology(), (1, 1));
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
        assert_eq!(HalfEdges::new(surface).unwrap().topology(), (1, 0));
    }
}

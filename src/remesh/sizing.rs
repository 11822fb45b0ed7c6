//! How long edges may be where the surface is thin or turns fast.
//!
//! A mesh with edges of length s flattens what is smaller. How much of the area that costs can be told from the
//! normals: of a disc of radius s, only |∫ n dA| is left when its middle stands for all of it. The share that goes,
//! `1 − |∫ n dA| / ∫ dA`, is s²/4r² on a ball of radius r, s²/8r² on a tube, and all of it on a limb thinner than s.
//!
//! A limb is as thin however near one looks, until one looks nearer than its radius; the rim of a sheet stays sharp.
//! The two are told apart by where the normals of the disc point: all around, or to both sides of a plane.

use super::surface::Surface;
use crate::{
    mesh::{
        halfedge::{next, sides, triangle_of},
        vector::{V3, v},
    },
    watch::{Pulse, Stopped},
};

/// The share of the area that may go: six edges around a tube.
const LOSS: f64 = 0.125;
/// Where more than this goes, one has to look nearer.
const THIN: f64 = 4.0 * LOSS;
/// Where more than this goes still when looked at from nearest, nothing is gained by short edges.
const SHARP: f64 = 3.0 * LOSS;
/// The shortest edges there may be, as a share of the usual.
const LEAST: f64 = 1.0 / 10.0;
/// The same beside the rim of a sheet.
const RIM: f64 = 1.0 / 3.0;
/// From which on normals point all around: of the tensor ∫ n nᵀ dA / ∫ dA, the sum of the products of two eigenvalues.
/// It is 0 on a sheet, 1/4 on a tube, 1/3 on a ball.
const ROUND: f64 = 0.23;
/// By how much edges may grow longer per length of way.
const GROWTH: f64 = 0.4;
/// No limit, in usual edges.
const FREE: f64 = 4.0;
/// Limits beside which no shorter ones are looked for, in usual edges.
const FLAT: f64 = 2.0;
/// How near to the middle of a disc the edge lies across which it goes on, in squares of its radius.
const BEYOND: f64 = 0.5;
/// Discs of more triangles than this are looked at in part.
const MOST: usize = 96;

/// For each vertex of the surface the greatest length of an edge there; `length` is the usual one.
///
/// # Errors
/// When the watch cancels.
pub(super) fn find(surface: &Surface, length: f64, pulse: &Pulse) -> Result<Vec<f64>, Stopped> {
    let mesh = &surface.mesh;
    let mut disc = Disc::new(surface);
    let none = FREE * length;
    let mut limits = vec![f64::INFINITY; mesh.vertex_slots() as usize];
    for a in 0..mesh.vertex_slots() {
        pulse.beat(50)?;
        // Edges of creases lie along them, and beside flat places it is flat.
        let is_flat = |b: u32| (FLAT * length..=none).contains(&limits[b as usize]);
        let is_beside_flat = |h: u32| is_flat(mesh.end(h)) && mesh.length(h) < 0.5 * length;
        let is_inner = surface.is_real(mesh.side_from(a)) && !surface.is_creased(a);
        if !is_inner || mesh.around(a).any(is_beside_flat) {
            continue;
        }
        pulse.beat(1000)?;
        let mut radius = length;
        let (mut loss, round) = disc.loss(a, radius);
        let mut least = if round > ROUND { LEAST } else { RIM };
        while loss > THIN && radius > least * length {
            radius *= 0.5;
            loss = disc.loss(a, radius).0;
            pulse.beat(1000)?;
        }
        if loss > SHARP {
            least = RIM;
        }
        limits[a as usize] = (radius * (LOSS / loss.max(1e-3)).sqrt()).clamp(least * length, none);
    }
    for limit in &mut limits {
        *limit = limit.min(none);
    }
    grade(surface, &mut limits, none, pulse)?;
    Ok(limits)
}

/// Sees to it that limits grow slowly from where they are short.
fn grade(surface: &Surface, limits: &mut [f64], none: f64, pulse: &Pulse) -> Result<(), Stopped> {
    let mesh = &surface.mesh;
    let mut open: Vec<u32> = (0..mesh.vertex_slots()).filter(|&a| limits[a as usize] < none).collect();
    let mut is_open: Vec<bool> = limits.iter().map(|&limit| limit < none).collect();
    let mut at = 0;
    while let Some(&a) = open.get(at) {
        at += 1;
        pulse.beat(40)?;
        is_open[a as usize] = false;
        let limit = limits[a as usize];
        for h in mesh.around(a).filter(|&h| surface.is_real(h) || surface.is_real(mesh.twin(h))) {
            let b = mesh.end(h) as usize;
            // The root is for where it may matter.
            if limits[b] > limit {
                let longest = limit + GROWTH * mesh.length(h);
                if longest < limits[b] {
                    limits[b] = longest;
                    if !std::mem::replace(&mut is_open[b], true) {
                        open.push(b as u32);
                    }
                }
            }
        }
    }
    Ok(())
}

/// The surface around one vertex after the other.
struct Disc<'a> {
    surface: &'a Surface,
    /// For which vertex a triangle was last met.
    met: Vec<u32>,
    turn: u32,
    open: Vec<u32>,
}

impl<'a> Disc<'a> {
    fn new(surface: &'a Surface) -> Self {
        Self { surface, met: vec![0; surface.face_count() as usize], turn: 0, open: Vec::new() }
    }

    /// The share of the area within `radius` of the vertex that is gone when the vertex stands for all of it, and
    /// whether normals point all around, as [`ROUND`] has it.
    fn loss(&mut self, a: u32, radius: f64) -> (f64, f64) {
        let mesh = &self.surface.mesh;
        let (here, radius2) = (mesh.point(a), radius * radius);
        self.turn += 1;
        self.open.clear();
        let mut sum = Sum::default();
        let towards = |b: u32| (mesh.point(b) - here).unit();
        let mut u = towards(mesh.end(mesh.side_from(a)));
        for h in mesh.around(a) {
            // Of a large triangle, its sector of the disc.
            let (face, w) = (triangle_of(h), towards(mesh.apex(h)));
            self.met[face as usize] = self.turn;
            sum.add(self.surface.span(face), 0.5 * radius2 * (u - w).norm());
            self.go_on(next(h));
            u = w;
        }
        let mut seen = 0;
        while let Some(h) = self.open.pop() {
            let face = triangle_of(h);
            if self.met[face as usize] == self.turn {
                continue;
            }
            self.met[face as usize] = self.turn;
            let (p, along) = (mesh.point(mesh.start(h)), mesh.point(mesh.end(h)) - mesh.point(mesh.start(h)));
            let t = ((here - p).dot(along) / along.dot(along).max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            let off = p + along * t - here;
            if off.dot(off) >= BEYOND * radius2 {
                continue;
            }
            sum.add(self.surface.span(face), 0.5 * radius2);
            seen += 1;
            if seen == MOST {
                break;
            }
            for side in sides(face) {
                if side != h {
                    self.go_on(side);
                }
            }
        }
        sum.loss()
    }

    /// Notes the triangle across a side as one to be looked at.
    fn go_on(&mut self, side: u32) {
        let mesh = &self.surface.mesh;
        let t = mesh.twin(side);
        let face = triangle_of(t) as usize;
        if self.met.get(face).is_some_and(|&turn| turn != self.turn) && !mesh.is_marked(side) {
            self.open.push(t);
        }
    }
}

/// Sums over triangles.
#[derive(Default)]
struct Sum {
    area: f64,
    normal: V3,
    /// Of n nᵀ dA, the diagonal and what is beside it.
    squares: V3,
    products: V3,
}

impl Sum {
    /// Adds a triangle as [`Surface::span`] tells of it, up to an area of `most`.
    fn add(&mut self, (normal, span): (V3, f64), most: f64) {
        let (normal, area) = (normal * 0.5, 0.5 * span);
        if area > 0.0 {
            let share = if most >= area { 1.0 } else { most / area };
            let by = share / area;
            self.area += area * share;
            self.normal = self.normal + normal * share;
            self.squares = self.squares + v(normal.x * normal.x, normal.y * normal.y, normal.z * normal.z) * by;
            self.products = self.products + v(normal.y * normal.z, normal.z * normal.x, normal.x * normal.y) * by;
        }
    }

    fn loss(&self) -> (f64, f64) {
        if self.area <= 0.0 {
            return (0.0, 0.0);
        }
        let by = 1.0 / (self.area * self.area);
        let square = self.squares.dot(self.squares) + 2.0 * self.products.dot(self.products);
        (1.0 - self.normal.norm() / self.area, 0.5 * (1.0 - square * by))
    }
}

//! The mesh on its way: its vertices with their places on the surface, and the moves on its edges.

use std::ops::Range;

use super::{RemeshError, set::Set, shape::SLIVER, surface::Surface};
use crate::{
    mesh::{
        halfedge::{AREA_PER_VERTEX, HalfEdges, sides},
        vector::{V3, greater, lesser},
    },
    watch::{Pulse, Stopped, Watch},
};

/// Rounds of split, collapse, flip and relax.
const ROUNDS: usize = 1;
/// Meshes of so many vertices get one round of both kinds more, smaller ones up to three.
const SMALL: usize = 6000;
/// Rounds of relax and flip after the count is exact; up to [`EXTRA`] more while there are [`MANY`] bad triangles.
const FINISH: usize = 2;
const EXTRA: usize = 5;
/// One triangle of so many.
const MANY: usize = 400;
/// Splits and collapses leave this many times fewer vertices than a mesh has whose edges are all as aimed at.
const FILL: f64 = 1.0;
/// How much longer edges may be than without thin parts.
const MOST: f64 = 1.3;
/// Edges longer than this are split, shorter than that collapsed, in lengths aimed at.
pub(super) const LONG: f64 = 4.0 / 3.0;
const SHORT: f64 = 0.8;

/// What it costs to look at a half-edge that stays as it is, and to try a move, in nanoseconds, about.
pub(super) const IDLE: usize = 10;
pub(super) const MOVE: usize = 500;

/// What a vertex may do: less, the greater.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Kind {
    /// Moves on the surface.
    Free,
    /// Moves along its crease.
    Crease,
    /// Stays.
    Corner,
}

/// The mesh under work.
pub(super) struct Work<'a> {
    pub(super) surface: &'a Surface,
    pub(super) mesh: HalfEdges,
    pub(super) ghosts: Range<u32>,
    pub(super) kinds: Vec<Kind>,
    /// The half-edge of the surface at which each vertex lies: of its triangle, of its crease, from its corner.
    pub(super) sides: Vec<u32>,
    /// The surface's normals at the vertices.
    pub(super) normals: Vec<V3>,
    /// The greatest length of an edge at each vertex.
    pub(super) limits: Vec<f64>,
    /// The length of edge aimed at where the surface is not thin.
    pub(super) length: f64,
    /// The length that is aimed at everywhere at least.
    least: f64,
    /// The area of the surface around each of its vertices.
    areas: Vec<f64>,
    /// Whether creases and the shape of triangles are given up for the count.
    pub(super) loose: bool,
    /// For reuse: edges to be looked at, those and triangles to be looked at in their order, neighbours.
    pub(super) open: Vec<u32>,
    pub(super) sets: [Set; 2],
    pub(super) rings: [Vec<u32>; 2],
    pub(super) pulse: &'a Pulse<'a>,
}

pub(super) fn distance2(p: V3, q: V3) -> f64 {
    let off = p - q;
    off.dot(off)
}

impl<'a> Work<'a> {
    pub(super) fn new(
        surface: &'a Surface,
        ghosts: Range<u32>,
        length: f64,
        pulse: &'a Pulse<'a>,
    ) -> Result<Self, Stopped> {
        let mesh = surface.mesh.clone();
        let slots = mesh.vertex_slots();
        let mut kinds = Vec::with_capacity(slots as usize);
        let mut sides = Vec::with_capacity(slots as usize);
        let mut normals = Vec::with_capacity(slots as usize);
        pulse.beat(15 * surface.mesh.triangle_slots() as usize)?;
        for a in 0..slots {
            pulse.beat(60)?;
            let crease = surface.is_creased(a).then(|| surface.creases_at(a).next()).flatten();
            let (kind, side) = match crease {
                Some(_) if surface.is_corner(a) => (Kind::Corner, surface.side_at(a)),
                Some(h) => (Kind::Crease, h),
                None => (Kind::Free, surface.side_at(a)),
            };
            kinds.push(kind);
            sides.push(side);
            normals.push(surface.normal(a));
        }
        let limits = (0..slots).map(|a| surface.limit(a)).collect();
        Ok(Self {
            surface,
            mesh,
            ghosts,
            kinds,
            sides,
            normals,
            limits,
            length,
            least: 0.0,
            areas: surface.areas(pulse)?,
            loose: false,
            open: Vec::new(),
            sets: Default::default(),
            rings: Default::default(),
            pulse,
        })
    }

    /// Does the whole work.
    pub(super) fn run(mut self, count: usize, watch: &dyn Watch) -> Result<HalfEdges, RemeshError> {
        self.fit(count)?;
        // A small mesh costs little, and its shape depends more on each vertex.
        let more = (SMALL / count).min(3);
        let (rounds, finish) = (ROUNDS + more, FINISH + more);
        let total = rounds + finish + 1;
        watch.progress(0, total);
        if self.count() > count {
            self.collapse()?;
        }
        // The longest first, so that halves stay near to the shape of the whole.
        let mut longest = self.longest()?;
        while longest > LONG {
            longest *= 0.6;
            self.split(longest.max(LONG))?;
            self.flip(2)?;
        }
        for round in 0..rounds {
            self.split(LONG)?;
            self.collapse()?;
            self.flip(4)?;
            self.relax()?;
            // As if the vertices were spread evenly; creases and thin parts make it differ.
            let ratio = (self.count() as f64 / count as f64).clamp(0.5, 2.0);
            self.length *= ratio.sqrt();
            watch.progress(round + 1, total);
        }
        self.flip(4)?;
        for round in 0..finish + EXTRA {
            let bad = self.mend()?;
            if round >= finish && bad * MANY < 2 * count {
                break;
            }
            self.reach(count)?;
            self.flip(4)?;
            self.relax()?;
            watch.progress(rounds + round.min(finish - 1) + 1, total);
        }
        self.reach(count)?;
        self.flip(4)?;
        self.balance()?;
        watch.progress(total, total);
        Ok(self.mesh)
    }

    /// The number of vertices, without ghosts.
    pub(super) fn count(&self) -> usize {
        self.mesh.vertex_count() - self.ghosts.len()
    }

    pub(super) fn is_ghost(&self, a: u32) -> bool {
        self.ghosts.contains(&a)
    }

    /// Whether the half-edge is the one for its edge, and that no ghost's.
    pub(super) fn is_edge(&self, h: u32) -> bool {
        self.mesh.is_edge(h) && !self.is_ghost(self.mesh.start(h)) && !self.is_ghost(self.mesh.end(h))
    }

    pub(super) fn length2(&self, h: u32) -> f64 {
        distance2(self.mesh.point(self.mesh.start(h)), self.mesh.point(self.mesh.end(h)))
    }

    /// The length aimed at where `limit` is the greatest.
    pub(super) fn within(&self, limit: f64) -> f64 {
        lesser(greater(limit, self.least), self.length)
    }

    /// The length of edge aimed at around a vertex.
    pub(super) fn size(&self, a: u32) -> f64 {
        self.within(self.limits[a as usize])
    }

    /// The square of an edge's length over the one aimed at.
    pub(super) fn stretch2(&self, h: u32) -> f64 {
        self.length2(h) / self.aim2(h)
    }

    /// The square of the length aimed at for an edge.
    pub(super) fn aim2(&self, h: u32) -> f64 {
        self.size(self.mesh.start(h)) * self.size(self.mesh.end(h))
    }

    /// Whether a corner of the triangle is a ghost.
    pub(super) fn has_ghost(&self, triangle: u32) -> bool {
        !self.ghosts.is_empty() && self.mesh.corners(triangle).into_iter().any(|a| self.is_ghost(a))
    }

    /// The squares of the lengths of a triangle's sides, and of the lengths aimed at for them.
    #[inline(always)]
    #[expect(clippy::inline_always, reason = "a fifth of the time of a pass over all triangles")]
    pub(super) fn lengths2(&self, triangle: u32) -> ([f64; 3], [f64; 3]) {
        let [a, b, c] = self.mesh.corners(triangle);
        let (p, q, r) = (self.mesh.point(a), self.mesh.point(b), self.mesh.point(c));
        let (x, y, z) = (self.size(a), self.size(b), self.size(c));
        ([distance2(p, q), distance2(q, r), distance2(r, p)], [x * y, y * z, z * x])
    }

    /// Whether a triangle has a side that is its edge's, no ghost's maybe, and of such a length.
    pub(super) fn any_side(&self, triangle: u32, is_such: impl Fn(f64, f64) -> bool) -> bool {
        if !self.mesh.has(sides(triangle)[0]) {
            return false;
        }
        let ([l0, l1, l2], [a0, a1, a2]) = self.lengths2(triangle);
        let [e0, e1, e2] = self.mesh.is_edges(triangle);
        (e0 & is_such(l0, a0)) | (e1 & is_such(l1, a1)) | (e2 & is_such(l2, a2))
    }

    /// Chooses the usual length for `count` vertices. Where the short edges of thin parts would make it much longer,
    /// they get longer too.
    fn fit(&mut self, count: usize) -> Result<(), Stopped> {
        let even = self.length;
        self.least = 0.0;
        loop {
            self.length = even;
            for _ in 0..4 {
                self.length *= (self.need(self.length)? / (FILL * count as f64)).sqrt();
            }
            if self.length <= MOST * even {
                return Ok(());
            }
            self.least = (1.25 * self.least).max(0.1 * even);
        }
    }

    /// How many vertices an even mesh has whose edges are `length` long where they may be.
    fn need(&self, length: f64) -> Result<f64, Stopped> {
        let surface = self.surface;
        let mut sum = 0.0;
        for (a, area) in (0..).zip(&self.areas) {
            let size = lesser(greater(surface.limit(a), self.least), length);
            sum += area / (size * size);
            self.pulse.beat(5)?;
        }
        Ok(sum / AREA_PER_VERTEX)
    }

    fn longest(&self) -> Result<f64, Stopped> {
        let mut longest2 = 0.0_f64;
        for triangle in 0..self.mesh.triangle_slots() {
            self.pulse.beat(3 * IDLE)?;
            if self.mesh.has(sides(triangle)[0]) && !self.has_ghost(triangle) {
                let (lengths2, aims2) = self.lengths2(triangle);
                for (length2, aim2) in lengths2.into_iter().zip(aims2) {
                    longest2 = greater(longest2, length2 / aim2);
                }
            }
        }
        Ok(longest2.sqrt())
    }

    /// Splits the edges that are longer than `longest`, and what is left of them.
    fn split(&mut self, longest: f64) -> Result<(), RemeshError> {
        let longest2 = longest * longest;
        // A few more than an even mesh of such edges has: where the surface is folded, edges may grow by splits.
        let most = self.count() + (2.0 * self.need(self.length)? / longest2) as usize;
        // A split moves edges to new slots at the end: they are not looked at until the next pass.
        for triangle in 0..self.mesh.triangle_slots() {
            self.pulse.beat(3 * IDLE)?;
            if !self.any_side(triangle, |length2, aim2| length2 > longest2 * aim2) {
                continue;
            }
            for h in sides(triangle) {
                if self.is_edge(h) && self.length2(h) > longest2 * self.aim2(h) && self.count() < most {
                    self.pulse.beat(MOVE)?;
                    self.try_split(h);
                }
            }
        }
        Ok(())
    }

    /// Collapses edges that are too short.
    fn collapse(&mut self) -> Result<(), RemeshError> {
        let shortest2 = SHORT * SHORT;
        for triangle in 0..self.mesh.triangle_slots() {
            self.pulse.beat(3 * IDLE)?;
            if !self.any_side(triangle, |length2, aim2| length2 < shortest2 * aim2) {
                continue;
            }
            for h in sides(triangle) {
                if self.is_edge(h) && self.length2(h) < shortest2 * self.aim2(h) {
                    self.pulse.beat(MOVE)?;
                    self.try_collapse(h, LONG, SLIVER);
                }
            }
        }
        Ok(())
    }
}

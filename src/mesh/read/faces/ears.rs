//! Ear cutting of one ring: the best ear first, every corner kept.
//!
//! Of our own, because the `earcut` crate (0.4.12) leaves out corners on straight lines, where the neighbour across has
//! them and a slit would open; and because a ring that runs over itself takes it cubic time (four vertices named a
//! thousand times: 6 s). Here the work is bounded by the square of the number of corners, whatever the ring.

use std::{cmp::Reverse, collections::BinaryHeap};

use crate::mesh::vector::{cross, dot, length, sub};

/// Points within this part of the ring's extent of a line count as on it.
const ON_LINE: f64 = 1e-12;

/// A ring of corners being cut.
#[derive(Default)]
pub(super) struct Ears {
    /// In a unit in which the ring's extent is about 1.
    points: Vec<[f64; 3]>,
    /// Their shadows in the plane where the ring's is greatest, counterclockwise.
    flat: Vec<[f64; 2]>,
    before: Vec<u32>,
    after: Vec<u32>,
    /// Corners whose angle is less than straight.
    convex: Vec<bool>,
    /// How often a corner has changed; what the heap says of an earlier state is void.
    state: Vec<u32>,
    /// Corners that may lie in an ear: those that were not convex at first.
    blockers: Vec<u32>,
    /// Ears by quality, then the first corner: (bits of a positive f64, corner, state).
    heap: BinaryHeap<(u64, Reverse<u32>, u32)>,
    /// Points that may still be tested.
    budget: usize,
}

impl Ears {
    /// Cuts the ring of these points, of which there are at least three, into two triangles fewer than there are
    /// corners, each in the ring's direction. What has no ear (a ring without area, or one that crosses itself) becomes
    /// a fan.
    pub(super) fn cut(&mut self, points: impl Iterator<Item = [f64; 3]>, mut take: impl FnMut([u32; 3])) {
        self.points.clear();
        self.points.extend(points);
        let count = self.points.len() as u32;
        let mut left = count;
        let mut at = 0;
        self.before.clear();
        self.before.extend((0..count).map(|corner| (corner + count - 1) % count));
        self.after.clear();
        self.after.extend((0..count).map(|corner| (corner + 1) % count));
        if self.project() {
            self.begin(count);
            while left > 3 {
                let Some(ear) = self.best(at) else { break };
                let (a, c) = (self.before[ear as usize], self.after[ear as usize]);
                take([a, ear, c]);
                self.after[a as usize] = c;
                self.before[c as usize] = a;
                // A corner that is gone is its own neighbour.
                self.after[ear as usize] = ear;
                left -= 1;
                at = a;
                self.look(a);
                self.look(c);
            }
        }
        while left >= 3 {
            let (b, c) = (self.after[at as usize], self.after[self.after[at as usize] as usize]);
            take([at, b, c]);
            self.after[at as usize] = c;
            left -= 1;
        }
    }

    /// Finds the shadow; false where the ring has no area.
    fn project(&mut self) -> bool {
        let origin = self.points[0];
        let extent = self.points.iter().flat_map(|&point| sub(point, origin)).fold(0.0, |e: f64, d| e.max(d.abs()));
        if !(extent.is_finite() && extent > 0.0) {
            return false;
        }
        // A power of two scales without rounding: what is on a line stays on it.
        let unit = extent.log2().floor().clamp(-1000.0, 1000.0).exp2();
        for point in &mut self.points {
            *point = point.map(|coordinate| coordinate / unit);
        }
        let origin = self.points[0];
        let mut normal = [0.0; 3];
        for pair in self.points.windows(2) {
            let part = cross(sub(pair[0], origin), sub(pair[1], origin));
            for (sum, part) in normal.iter_mut().zip(part) {
                *sum += part;
            }
        }
        let axis = (1..3).fold(0, |best, axis| if normal[axis].abs() > normal[best].abs() { axis } else { best });
        // Also false where it is not a number.
        if !(normal[axis].is_finite() && normal[axis].abs() > ON_LINE) {
            return false;
        }
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
        self.flat.clear();
        self.flat.extend(self.points.iter().map(|point| [point[u] - origin[u], point[v] - origin[v]]));
        true
    }

    fn begin(&mut self, count: u32) {
        let corners = count as usize;
        self.convex.clear();
        self.convex.resize(corners, true);
        self.state.clear();
        self.state.resize(corners, 0);
        self.heap.clear();
        self.blockers.clear();
        // A simple ring needs at most three tests for each pair of corners.
        self.budget = 4 * corners * corners;
        for corner in 0..count {
            self.convex[corner as usize] = self.turn(corner) > 0.0;
            if !self.convex[corner as usize] {
                self.blockers.push(corner);
            }
        }
        for corner in 0..count {
            self.look(corner);
        }
    }

    /// Twice the area of the shadow of the triangle at a corner.
    fn turn(&self, corner: u32) -> f64 {
        let [a, b, c] = self.triangle(corner).map(|corner| self.flat[corner as usize]);
        area(a, b, c)
    }

    fn triangle(&self, corner: u32) -> [u32; 3] {
        [self.before[corner as usize], corner, self.after[corner as usize]]
    }

    /// The best ear, or `None` where there is none among the corners after `start`.
    fn best(&mut self, start: u32) -> Option<u32> {
        for again in [false, true] {
            if again {
                // A corner may have become an ear because one that is no neighbour went.
                let mut corner = start;
                loop {
                    self.look(corner);
                    corner = self.after[corner as usize];
                    if corner == start {
                        break;
                    }
                }
            }
            while let Some((_, Reverse(corner), state)) = self.heap.pop() {
                if self.state[corner as usize] == state && self.after[corner as usize] != corner {
                    return Some(corner);
                }
            }
        }
        None
    }

    /// Looks whether a corner is an ear, after its neighbours have changed.
    fn look(&mut self, corner: u32) {
        let state = &mut self.state[corner as usize];
        *state += 1;
        let state = *state;
        self.convex[corner as usize] = self.turn(corner) > 0.0;
        if self.convex[corner as usize] && self.is_free(corner) {
            let quality = self.quality(corner);
            self.heap.push((quality.to_bits(), Reverse(corner), state));
        }
    }

    /// Whether no other corner lies in the triangle at a corner or on its sides.
    fn is_free(&mut self, corner: u32) -> bool {
        let [i, j, k] = self.triangle(corner);
        let [a, b, c] = [i, j, k].map(|corner| self.flat[corner as usize]);
        // How far outside counts as on the side: an area, for each side.
        let slack = |[px, py]: [f64; 2], [qx, qy]: [f64; 2]| -ON_LINE * ((qx - px).abs() + (qy - py).abs());
        let slacks = [slack(a, b), slack(b, c), slack(c, a)];
        let blockers = &self.blockers;
        if blockers.len() > self.budget {
            return false;
        }
        self.budget -= blockers.len();
        !blockers.iter().any(|&other| {
            let point = self.flat[other as usize];
            let gone = self.after[other as usize] == other || self.convex[other as usize];
            // A corner at the place of one of these three is where the ring touches itself, as a bridge to a hole does.
            let same = [i, j, k].contains(&other) || point == a || point == b || point == c;
            !gone
                && !same
                && area(a, b, point) >= slacks[0]
                && area(b, c, point) >= slacks[1]
                && area(c, a, point) >= slacks[2]
        })
    }

    /// The area of the triangle at a corner in units of its longest side, in space and not in the shadow: positive, and
    /// greatest for equal sides.
    fn quality(&self, corner: u32) -> f64 {
        let [a, b, c] = self.triangle(corner).map(|corner| self.points[corner as usize]);
        let sides = [sub(b, a), sub(c, b), sub(a, c)];
        let longest = sides.map(|side| dot(side, side)).into_iter().fold(0.0, f64::max);
        length(cross(sides[0], sides[1])) / longest
    }
}

/// Twice the area of a triangle, positive where it runs counterclockwise.
fn area([ax, ay]: [f64; 2], [bx, by]: [f64; 2], [cx, cy]: [f64; 2]) -> f64 {
    (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
}

//! The exact number of vertices: the longest edges are split, or the shortest collapsed.

use super::{
    RemeshError,
    shape::SLIVER,
    work::{IDLE, Kind, LONG, MOVE, Work},
};
use crate::{mesh::halfedge::sides, watch::Stopped};

impl Work<'_> {
    /// Splits or collapses until there are `count` vertices.
    pub(super) fn reach(&mut self, count: usize) -> Result<(), RemeshError> {
        while self.count() < count {
            let before = self.count();
            // Not all of one pass: their halves may be longer than the next.
            let share = (count - before).min(self.mesh.triangle_slots() as usize / 16 + 1);
            for (length2, h) in self.edges_by_length(share, true)? {
                self.pulse.beat(MOVE)?;
                if self.stretch2(h) == length2 {
                    self.try_split(h);
                }
            }
            // Where every split would fold the mesh, the fold is there already.
            self.loose = self.count() == before;
        }
        let (mut longest, mut share) = (LONG, 4_usize);
        while self.count() > count {
            let before = self.count();
            for (length2, h) in self.edges_by_length(share.saturating_mul(before - count + 16), false)? {
                self.pulse.beat(MOVE)?;
                if self.count() == count {
                    return Ok(());
                }
                if self.mesh.has(h) && self.stretch2(h) == length2 {
                    self.try_collapse(h, longest, SLIVER);
                }
            }
            if self.count() == before {
                // What held the rest: that few were looked at, that edges would be long, that creases would go, that
                // triangles would be bad.
                if share < usize::MAX {
                    share = usize::MAX;
                } else if longest.is_finite() {
                    longest = if longest > 8.0 { f64::INFINITY } else { 1.5 * longest };
                } else if !self.loose {
                    self.loosen()?;
                } else {
                    return Err(RemeshError::TooFew { wanted: count, least: before });
                }
            }
        }
        Ok(())
    }

    /// Gives up all creases but the boundary, and the shape of triangles.
    fn loosen(&mut self) -> Result<(), Stopped> {
        self.loose = true;
        for triangle in 0..self.mesh.triangle_slots() {
            self.pulse.beat(3 * IDLE)?;
            for h in sides(triangle) {
                if self.is_edge(h) && self.mesh.is_marked(h) && !self.is_boundary(h) {
                    self.mesh.mark(h, false);
                }
            }
        }
        for a in 0..self.mesh.vertex_slots() {
            self.pulse.beat(50)?;
            if self.mesh.has_vertex(a) && !self.is_ghost(a) {
                let at = a as usize;
                let crease = self.mesh.around(a).any(|h| self.mesh.is_marked(h));
                if !crease {
                    self.kinds[at] = Kind::Free;
                } else if self.kinds[at] == Kind::Corner {
                    let corner = self.surface.mesh.start(self.sides[at]);
                    if let Some(side) = self.surface.creases_at(corner).find(|&h| self.surface.is_boundary(h)) {
                        self.kinds[at] = Kind::Crease;
                        self.sides[at] = side;
                    }
                }
            }
        }
        Ok(())
    }

    fn is_boundary(&self, h: u32) -> bool {
        self.is_ghost(self.mesh.apex(h)) || self.is_ghost(self.mesh.apex(self.mesh.twin(h)))
    }

    /// The so many longest edges, or shortest, with their squared lengths over those aimed at: these first.
    fn edges_by_length(&self, share: usize, longest: bool) -> Result<Vec<(f64, u32)>, Stopped> {
        // Where a few are wanted, they are sought among those far from the length aimed at.
        let far2 = if longest { [1.5, 1.0, 0.0] } else { [0.6, 1.0, f64::INFINITY] };
        let mut edges = Vec::new();
        for far2 in far2 {
            edges.clear();
            let is_far =
                |length2: f64, aim2: f64| if longest { length2 >= far2 * aim2 } else { length2 <= far2 * aim2 };
            for triangle in 0..self.mesh.triangle_slots() {
                self.pulse.beat(3 * IDLE)?;
                if !self.any_side(triangle, is_far) {
                    continue;
                }
                let (lengths2, aims2) = self.lengths2(triangle);
                for (h, (length2, aim2)) in sides(triangle).into_iter().zip(lengths2.into_iter().zip(aims2)) {
                    if self.is_edge(h) && is_far(length2, aim2) {
                        edges.push((length2 / aim2, h));
                    }
                }
            }
            if edges.len() >= share {
                break;
            }
        }
        let order = |x: &(f64, u32), y: &(f64, u32)| {
            let ascending = x.0.total_cmp(&y.0).then(x.1.cmp(&y.1));
            if longest { ascending.reverse() } else { ascending }
        };
        if share < edges.len() {
            edges.select_nth_unstable_by(share, order);
            self.pulse.beat(15 * edges.len())?;
            edges.truncate(share);
        }
        self.pulse.sort(&mut edges, &order)?;
        Ok(edges)
    }
}

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
        // Where a few are wanted, they are sought among those far from the length aimed at, then beyond it.
        let (far2, beyond2) = if longest { (1.5, 1.0) } else { (0.6, 1.0) };
        let is_past = |length2: f64, limit: f64| if longest { length2 >= limit } else { length2 <= limit };
        let (mut edges, mut nearer) = (Vec::new(), Vec::new());
        for all in [false, true] {
            edges.clear();
            nearer.clear();
            for triangle in 0..self.mesh.triangle_slots() {
                self.pulse.beat(3 * IDLE)?;
                if !self.mesh.has(sides(triangle)[0]) {
                    continue;
                }
                let (lengths2, aims2) = self.lengths2(triangle);
                let is_edge = self.mesh.is_edges(triangle);
                for (side, h) in sides(triangle).into_iter().enumerate() {
                    let (length2, aim2) = (lengths2[side], aims2[side]);
                    if is_edge[side] & (is_past(length2, beyond2 * aim2) | all) && self.is_edge(h) {
                        let far = is_past(length2, far2 * aim2);
                        let place = if far { &mut edges } else { &mut nearer };
                        place.push((length2 / aim2, h));
                    }
                }
            }
            if edges.len() < share {
                edges.append(&mut nearer);
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

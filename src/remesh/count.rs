//! The exact number of vertices: the longest edges are split, or the shortest collapsed.

use super::{
    RemeshError,
    work::{Kind, LONG, SLIVER, Work},
};

impl Work<'_> {
    /// Splits or collapses until there are `count` vertices.
    pub(super) fn reach(&mut self, count: usize) -> Result<(), RemeshError> {
        while self.count() < count {
            let before = self.count();
            let edges = self.edges_by_length();
            // Not all of one pass: their halves may be longer than the next.
            let share = (count - self.count()).min(edges.len().div_ceil(8));
            for &(length2, h) in edges.iter().rev().take(share) {
                self.look(h)?;
                if self.length2(h) == length2 {
                    self.try_split(h);
                }
            }
            // Where every split would fold the mesh, the fold is there already.
            self.loose = self.count() == before;
        }
        let mut longest = LONG * self.length;
        while self.count() > count {
            let before = self.count();
            for (length2, h) in self.edges_by_length() {
                self.look(h)?;
                if self.count() == count {
                    return Ok(());
                }
                if self.mesh.has(h) && self.length2(h) == length2 {
                    self.try_collapse(h, longest, SLIVER);
                }
            }
            if self.count() == before {
                // What held the rest: that edges would be long, that creases would go, that triangles would be bad.
                if longest.is_finite() {
                    longest = if longest > 8.0 * self.length { f64::INFINITY } else { 1.5 * longest };
                } else if !self.loose {
                    self.loosen();
                } else {
                    return Err(RemeshError::TooFew { wanted: count, least: before });
                }
            }
        }
        Ok(())
    }

    /// Gives up all creases but the boundary, and the shape of triangles.
    fn loosen(&mut self) {
        self.loose = true;
        for h in 0..self.mesh.slots() {
            if self.is_edge(h) && self.mesh.is_marked(h) && !self.is_boundary(h) {
                self.mesh.mark(h, false);
            }
        }
        for a in 0..self.mesh.vertex_slots() {
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
    }

    fn is_boundary(&self, h: u32) -> bool {
        self.is_ghost(self.mesh.apex(h)) || self.is_ghost(self.mesh.apex(self.mesh.twin(h)))
    }

    /// The squared lengths of all edges, ascending.
    fn edges_by_length(&self) -> Vec<(f64, u32)> {
        let edges = (0..self.mesh.slots()).filter(|&h| self.is_edge(h));
        let mut edges: Vec<_> = edges.map(|h| (self.length2(h), h)).collect();
        edges.sort_unstable_by(|(x, h), (y, o)| x.total_cmp(y).then(h.cmp(o)));
        edges
    }
}

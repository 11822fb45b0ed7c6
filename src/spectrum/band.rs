//! The unit of work and of storage.

use serde::{Deserialize, Serialize};

/// All eigenvalues of one piece of a mesh between two shifts.
///
/// The shifts depend on the mesh and the operator alone, so a band is the same bits whenever and in whatever company
/// it was computed; but the last one may end early, where as many are certified as were asked for. It is certified by
/// itself: as many eigenvalues lie in it as the two inertia counts differ.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Which piece of the mesh: 0 for all small ones together, then those with a sparse solver of their own.
    pub part: u32,
    /// Position among the bands of that piece, from 0, without gaps.
    pub place: u32,
    /// Lower end, the upper end of the band before it; 0 for the first one.
    pub lower: f64,
    /// Upper end, where the inertia was counted; `f64::MAX` when nothing lies above.
    pub upper: f64,
    /// How many eigenvalues of the piece lie below `lower`.
    pub below: usize,
    /// How many eigenvalues of the piece lie below `upper`.
    pub above: usize,
    /// How many of its first values the process at its lower end saw; that at its upper end saw the others.
    pub seen: usize,
    /// Whether it ends early: its values are the first ones of the band that is there when more are asked for.
    pub early: bool,
    /// How many of `values` are the zeros of the kernel.
    pub zeros: usize,
    /// The eigenvalues, ascending: `above - below` of them.
    pub values: Vec<f64>,
    /// For each of them a bound on its error.
    pub errors: Vec<f64>,
}

impl Band {
    /// Whether the band is consistent in itself and follows `before`.
    pub(super) fn follows(&self, before: Option<&Self>) -> bool {
        let start = before.map_or((0.0, 0, 0), |before| (before.upper, before.above, before.place + 1));
        let ascending = self.values.is_sorted() && self.values.iter().all(|value| value.is_finite());
        (self.lower, self.below, self.place) == start
            && self.lower < self.upper
            && self.above.checked_sub(self.below) == Some(self.values.len())
            && self.errors.len() == self.values.len()
            && self.seen <= self.values.len()
            && self.zeros <= self.values.len()
            && self.values[..self.zeros].iter().all(|&value| value == 0.0)
            && ascending
    }
}

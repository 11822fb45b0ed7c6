//! Where the shifts of a chain are, in the scaled unit, and how many eigenvalues there are to be between two of them.

use super::{FEW_ROWS, Piece};

/// How many eigenvalues the slices of a piece aim at.
#[derive(Debug, Clone, Copy)]
pub(in crate::spectrum) struct Aims {
    /// Those after the lowest one, so that some hundred eigenvalues cost little.
    next: f64,
    /// The others. Wider ones take fewer factorisations and solves and a longer basis.
    wide: f64,
}

impl Aims {
    /// What the lowest slice aims at, if it were as wide on both sides of zero. The smallest eigenvalues are a small
    /// part of the distance from its upper end, and what rounding does to that is a large part of them.
    pub(super) const LOWEST: f64 = 54.0;
    /// Where a basis would come to hold much of the space.
    pub(super) const FEW: Self = Self { next: 54.0, wide: 87.0 };
    pub(super) const MANY: Self = Self { next: 72.0, wide: 100.0 };

    /// What the slice above so many eigenvalues aims at.
    pub(in crate::spectrum) fn above(self, above: usize) -> f64 {
        if above == 0 {
            Self::LOWEST
        } else if (above as f64) < 2.0 * self.next {
            self.next
        } else {
            self.wide
        }
    }

    /// How many eigenvalues a process looks for between slices above so many.
    pub(super) fn between(self, below: usize, above: usize) -> f64 {
        0.5 * (self.above(below) + self.above(above))
    }
}

impl Piece {
    /// How many eigenvalues its slices aim at.
    pub(in crate::spectrum) fn aims(&self) -> Aims {
        if self.pencil.order() < FEW_ROWS { Aims::FEW } else { Aims::MANY }
    }
}

/// Where a chain has got to, in the scaled unit.
#[derive(Debug, Clone, Copy)]
pub(in crate::spectrum) struct End {
    /// The place of the next band.
    pub(super) place: u32,
    /// The last shift.
    pub(super) upper: f64,
    /// How many eigenvalues lie below it.
    pub(super) above: usize,
    /// How far the next shift is to be from it.
    pub(super) step: f64,
    /// Half way to the next shift.
    pub(super) middle: f64,
}

impl End {
    /// Where the last shift is.
    pub(in crate::spectrum) fn upper(&self) -> f64 {
        self.upper
    }

    /// How many eigenvalues lie below it.
    pub(in crate::spectrum) fn above(&self) -> usize {
        self.above
    }

    /// Whether both are at the same shift.
    pub(in crate::spectrum) fn is(&self, other: &Self) -> bool {
        self.place == other.place && self.upper == other.upper
    }

    /// The end of a slice.
    pub(super) fn new(place: u32, lower: f64, upper: f64, counts: (usize, usize), aims: Aims) -> Self {
        let step = distance(lower, upper, counts, aims);
        Self { place: place + 1, upper, above: counts.1, step, middle: upper + 0.5 * step }
    }
}

/// A shift that was placed, in the scaled unit, and the slice below it.
#[derive(Debug, Clone, Copy)]
pub(in crate::spectrum) struct Shift {
    pub(super) place: u32,
    pub(super) lower: f64,
    pub upper: f64,
    pub(super) below: usize,
    pub above: usize,
    pub(super) middle: f64,
    pub(super) attempt: u32,
    pub(super) aims: Aims,
}

impl Shift {
    /// Both ends of the slice and its eigenvalues.
    pub(in crate::spectrum) fn span(&self) -> (f64, f64, usize) {
        (self.lower, self.upper, self.above - self.below)
    }

    pub(in crate::spectrum) fn end(&self) -> End {
        End::new(self.place, self.lower, self.upper, (self.below, self.above), self.aims)
    }

    /// Where to try next when an eigenvalue turned out to be too near: moved by a rule that knows nothing but this
    /// piece, so that it moves the same way every time.
    pub(in crate::spectrum) fn moved(&self) -> (f64, u32) {
        (self.upper + 0.013 * (self.upper - self.lower), self.attempt + 1)
    }
}

/// The distance to the next shift, from what the slice before had.
fn distance(lower: f64, upper: f64, (below, above): (usize, usize), aims: Aims) -> f64 {
    let count = (above - below).max(1) as f64;
    // The first slice begins at zero and is half as wide as the one after it.
    let before = if lower == 0.0 { 2.0 * upper } else { upper - lower };
    (aims.above(above) / count * (upper - lower)).clamp(0.5 * before, 2.5 * before)
}

/// Where a chain can end, by what the process at its last shift has seen on its right side.
#[derive(Debug, Clone, Copy)]
pub(in crate::spectrum) struct Ending {
    /// A shift between two of the eigenvalues there, in the scaled unit.
    pub sigma: f64,
    /// How many of them are below it.
    pub count: usize,
}

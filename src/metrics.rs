//! Features and labels → distances, rankings, classification error, average dynamic recall.
//!
//! Definitions shared by everything above:
//!
//! - A model is asked against the training models D: as one of them with itself left out, or as a query. Who asks whom
//!   is an [`Exam`].
//! - It goes to the class of its nearest model. ε = wrong / asked.
//! - Ties go to the smaller distance, then to the lower model index, everywhere. Distances are compared by their
//!   [sums](Distance::sum): a square root would merge sums that differ in their last bits.
//! - A mean over nothing is the worst figure there is: ε = 1, mean ADR = 0. So are the figures of an empty selection.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined is not compiled for the wider vectors of pulp's dispatch"
)]

pub use self::{
    chance::Chance,
    distance::Distance,
    exam::Exam,
    features::Features,
    ranking::{adr, confusion, figures, rank},
    recall::Recall,
    sample::Sample,
    scale::Scale,
    sweep::{Sweep, sweep},
};
pub(crate) use self::{
    columns::Columns,
    distance::{Chi2, L1, L2, RELATIVELY, Term, Wesd2, Wesd15, by_distance},
    found::{gained, gained_with_itself, precision, ranking, ranks, sums},
    lanes::{add_where_u32s, add_where_u64s, count_u32s},
    nearest::{Nearest, before},
};

mod chance;
mod columns;
mod distance;
mod exam;
mod features;
mod found;
mod lanes;
mod nearest;
mod ranking;
mod recall;
mod sample;
#[cfg(test)]
pub(crate) mod samples;
mod scale;
mod shortlist;
mod sweep;

/// The computation was told that its result is no longer wanted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

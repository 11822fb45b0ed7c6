//! Which eigenvalues tell the classes apart: first-k, hill climbing with backward steps, AdaBoost.

pub(crate) use self::ranges::Ranges;
pub use self::{
    boost::{LEAST_ERROR, Stop, TIE, boost, boost_by, held_out, stop_at},
    climb::{BEAM, Climb, Cost, PATIENCE, Search, Step, climb, climb_by},
    strong::{Round, SelCount, Strong, decide, probability},
    weak::{Test, Weak},
};

mod boost;
mod climb;
mod ranges;
mod strong;
mod weak;

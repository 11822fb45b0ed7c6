//! Which eigenvalues tell the classes apart: first-k, hill climbing with backward steps, AdaBoost.

pub(crate) use self::ranges::Ranges;
pub use self::{
    boost::{LEAST_ERROR, TIE, boost},
    climb::{Climb, Cost, Step, climb},
    strong::{Round, SelCount, Strong, decide, probability},
};

mod boost;
mod climb;
mod ranges;
mod strong;

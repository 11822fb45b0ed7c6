//! The experiment of the paper as plain rows: curves, selections and Tables 1 to 4.
//!
//! Figures on D are leave-one-out for first-k and hill climbing; AdaBoost's ε on D is that of the models it was trained
//! on, as in the paper. Figures on Q ask models that took no part in any selection.

use serde::{Deserialize, Serialize};

pub use self::{
    boosted::{Boosted, Mark, boosted, marks},
    climbed::{Climbed, climbed},
    first_k::{Curve, FirstK, first_k},
    honest::{
        Decisions, Honest, HonestPair, HonestRow, Interval, Learner, Plan, Recipe, SPLITS, Searched, Splits, Spread,
        Tuned, TunedRow, honest, mcnemar, paired, splits, tuned,
    },
    retrieval::{Draws, Gate, Pick, ReadAs, Reading, Retrieved, Scheme, Sources, retrieval},
    tables::{Cell, Table, tables, tables_of},
    why::Method,
};
pub use crate::metrics::Sample;

mod boosted;
mod climbed;
mod first_k;
mod honest;
mod retrieval;
mod tables;
pub mod why;

/// One figure on the training models (leave-one-out) and, beside it, on the query models.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// On D, each model against all the others.
    pub train: f64,
    /// On Q, each model against D; none where there are no query models.
    pub query: Option<f64>,
}

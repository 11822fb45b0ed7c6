//! The experiment of the paper as plain rows: curves, selections and Tables 1 to 4.

use serde::{Deserialize, Serialize};

use crate::selection::{Climb, Strong};

/// One figure on the training models (leave-one-out) and, beside it, on the query models.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Score {
    /// On D, each model against all the others.
    pub train: f64,
    /// On Q, each model against D; none where there are no query models.
    pub query: Option<f64>,
}

/// A figure for every k = 1…kmax; entry k − 1 belongs to k.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    /// On D, leave-one-out.
    pub train: Vec<f64>,
    /// On Q against D; empty where there are no query models.
    pub query: Vec<f64>,
}

impl Curve {
    /// The figures at `k`, counted from 1.
    #[must_use]
    pub fn at(&self, k: usize) -> Option<Score> {
        let index = k.checked_sub(1)?;
        Some(Score { train: *self.train.get(index)?, query: self.query.get(index).copied() })
    }
}

/// The first k eigenvalues, for all k in one pass.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FirstK {
    /// Classification error ε against k (Figure 3).
    pub error: Curve,
    /// Mean ADR against k (Figure 6).
    pub adr: Curve,
    /// The smallest k with the least ε on D.
    pub best_error: usize,
    /// The smallest k with the greatest mean ADR on D.
    pub best_adr: usize,
}

/// Hill climbing for one cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Climbed {
    /// The eigenvalues it selected, and how it got there.
    pub climb: Climb,
    /// ε with the selected eigenvalues.
    pub error: Score,
    /// Mean ADR with the selected eigenvalues.
    pub adr: Score,
}

/// AdaBoost after T rounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Boosted {
    /// One strong classifier per class, cut to T rounds.
    pub classes: Vec<Strong>,
    /// ε of the class with the largest p(C|M).
    pub error: Score,
    /// Mean over the classes of the number of distinct eigenvalues chosen.
    pub mean_chosen: f64,
    /// The same with every eigenvalue that tied for the least error.
    pub mean_ties: f64,
    /// The class decided for every model, in the order of the study's models.
    pub decided: Vec<u32>,
}

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// There is no such figure (no query models, say).
    Missing,
    /// A count.
    Count(u64),
    /// A figure, shown with this many decimals.
    Number {
        /// The figure itself, unrounded.
        value: f64,
        /// Decimals shown.
        decimals: u8,
    },
    /// Words.
    Text(String),
}

/// A table of the paper, ready to be shown or written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Its number in the paper.
    pub number: u32,
    /// What it shows.
    pub title: String,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// As many cells in each row as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

/// An eigenvalue that AdaBoost selected for a class, as Figures 4 and 5 draw it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// The eigenvalue index, from 1.
    pub index: u32,
    /// Sum of the weights α of the rounds that took it.
    pub alpha: f64,
    /// Least feature value at `index` among the class's training models.
    pub low: f64,
    /// Mean of them.
    pub mean: f64,
    /// Greatest of them.
    pub high: f64,
}

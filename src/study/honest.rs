//! How much of a figure is selection bias: nested cross-validation beside the paper's protocol.
//!
//! The paper selects eigenvalues and scores them on the same models D. Here all models, D and Q, are dealt into folds
//! many times over; each fold is asked against the others, and whatever a method selects (k, a subset, classifiers) it
//! selects on those others alone: hill climbing and the choice of k by leave-one-out among them. So every model is
//! asked once in every repeat, by a selection that has never seen it (Varma and Simon, *Bias in error estimation when
//! using cross-validation for model selection*, BMC Bioinformatics 7, 2006).
//!
//! Intervals are percentiles of a bootstrap over models (Efron and Tibshirani, *An introduction to the bootstrap*,
//! 1993): they say what other models of these classes would give, and do not hold how the selections themselves would
//! vary with another collection.

use serde::{Deserialize, Serialize};

pub use self::{
    learner::Learner,
    nested::honest,
    splits::{Decisions, SPLITS, Searched, Splits, Spread, splits},
    test::{mcnemar, paired},
    tuned::{Recipe, Tuned, TunedRow, tuned},
};

mod deal;
mod learner;
mod nested;
mod splits;
mod test;
mod tuned;

/// How models are dealt and drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Plan {
    /// Folds of each repeat; with 4 and 20 models of each class, every fold is split as the paper splits the whole.
    pub folds: usize,
    /// How often all models are dealt anew.
    pub repeats: usize,
    /// Draws of the bootstrap and of the permutation test.
    pub resamples: usize,
    /// What all of that depends on.
    pub seed: u64,
}

impl Default for Plan {
    fn default() -> Self {
        Self { folds: 4, repeats: 5, resamples: 2000, seed: 1 }
    }
}

/// A mean and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Interval {
    /// The mean over models and repeats.
    pub mean: f64,
    /// 2.5 % of the bootstrap's means lie below.
    pub low: f64,
    /// 2.5 % of the bootstrap's means lie above.
    pub high: f64,
}

/// One method, by the paper's protocol and honestly.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct HonestRow {
    /// Which method.
    pub method: Learner,
    /// The paper's protocol: ε on D, where it was selected, too (leave-one-out but for AdaBoost).
    pub apparent: f64,
    /// ε on Q after selection on D; none without query models.
    pub query: Option<f64>,
    /// ε of nested cross-validation.
    pub error: Interval,
    /// Mean ADR of nested cross-validation, each model asked against the other folds; none for AdaBoost, which ranks
    /// no models.
    pub adr: Option<Interval>,
    /// ε of each repeat of nested cross-validation.
    pub repeats: Vec<f64>,
    /// In how many repeats each model was given a wrong class: the training models in their order, then the queries.
    pub wrong: Vec<u32>,
    /// Eigenvalues selected, the mean over the folds of all repeats (and over the classes for AdaBoost).
    pub selected: f64,
}

/// Two methods on the same models in the same folds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct HonestPair {
    /// Index of the first method among the rows.
    pub first: usize,
    /// Index of the second.
    pub second: usize,
    /// ε of the first minus ε of the second in nested cross-validation; negative when the first is better.
    pub difference: Interval,
    /// Two-sided p of the permutation test: how often as great a difference comes about when, model by model, it is a
    /// coin's throw which method is which (Pitman 1937; sums over all repeats, so that a model counts once).
    pub permutation: f64,
    /// Two-sided p of McNemar's exact test on Q (McNemar 1947); none without query models.
    pub mcnemar: Option<f64>,
}

/// The honest table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Honest {
    /// How models were dealt and drawn.
    pub plan: Plan,
    /// A row for each method, in the order asked for.
    pub rows: Vec<HonestRow>,
    /// Every pair of methods, each once.
    pub pairs: Vec<HonestPair>,
}

impl Honest {
    /// The row with the least ε in nested cross-validation, of several the first.
    #[must_use]
    pub fn best(&self) -> Option<&HonestRow> {
        self.rows.iter().min_by(|a, b| a.error.mean.total_cmp(&b.error.mean))
    }
}

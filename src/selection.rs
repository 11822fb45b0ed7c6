//! Which eigenvalues tell the classes apart: first-k, hill climbing with backward steps, AdaBoost.

use serde::{Deserialize, Serialize};

/// What hill climbing minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cost {
    /// The classification error ε (Table 2).
    #[default]
    Error,
    /// 1 − mean ADR (Table 4).
    Adr,
}

/// Which number of eigenvalues AdaBoost is said to have selected.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SelCount {
    /// Distinct eigenvalues among the rounds' weak classifiers.
    #[default]
    Chosen,
    /// Every eigenvalue that tied for the least weighted error in some round.
    Ties,
}

/// One accepted move of hill climbing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The eigenvalue index, from 1.
    pub index: u32,
    /// True when it was added, false when it was removed.
    pub added: bool,
    /// The cost after the move.
    pub cost: f64,
}

/// What hill climbing found.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Climb {
    /// Eigenvalue indices, from 1, ascending.
    pub selected: Vec<u32>,
    /// The accepted moves in their order.
    pub steps: Vec<Step>,
}

impl Climb {
    /// The largest index that any accepted move touched: the run over a shorter spectrum that still holds it is the
    /// same run.
    #[must_use]
    pub fn reach(&self) -> u32 {
        self.steps.iter().map(|step| step.index).max().unwrap_or(0)
    }
}

/// One round of AdaBoost: the weak classifier it took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Round {
    /// The eigenvalue index, from 1, that the weak classifier looks at.
    pub index: u32,
    /// Its weighted error ε_t, before the lower bound.
    pub error: f64,
    /// Its weight α_t in the strong classifier.
    pub alpha: f64,
    /// All indices that tied for the least error, ascending; `index` is the first.
    pub ties: Vec<u32>,
}

/// The strong classifier of one class against the rest.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Strong {
    /// The rounds in their order; fewer than asked for when the least error reached ½.
    pub rounds: Vec<Round>,
}

//! Strong classifiers: what AdaBoost made, and what they say of a model.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};

use super::{ranges::Ranges, weak::Test};

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
    /// What it asks of that eigenvalue; none when it is whether the class's range holds it, as in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub test: Option<Test>,
}

/// The strong classifier of one class against the rest.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Strong {
    /// The rounds in their order; fewer than asked for when the least error reached ½.
    pub rounds: Vec<Round>,
}

impl Strong {
    /// The classifier after its first `rounds` rounds.
    #[must_use]
    pub fn cut(&self, rounds: usize) -> Self {
        Self { rounds: self.rounds.iter().take(rounds).cloned().collect() }
    }

    /// The largest index that a round chose: the run over a shorter spectrum that still holds it chooses the same, and
    /// its ties are these without the indices that it lacks.
    #[must_use]
    pub fn reach(&self) -> u32 {
        self.rounds.iter().map(|round| round.index).max().unwrap_or(0)
    }

    /// How many eigenvalues were selected, by that count.
    #[must_use]
    pub fn selected(&self, count: SelCount) -> usize {
        let rounds = self.rounds.iter();
        let distinct: BTreeSet<u32> = match count {
            SelCount::Chosen => rounds.map(|round| round.index).collect(),
            SelCount::Ties => rounds.flat_map(|round| round.ties.iter().copied()).collect(),
        };
        distinct.len()
    }

    /// S = Σ `α_t` `h_t` for a model with these features.
    pub(crate) fn score(&self, class: usize, ranges: &Ranges, features: &[f64]) -> f64 {
        let says = |round: &Round| if ranges.says(class, round, features) { round.alpha } else { -round.alpha };
        self.rounds.iter().map(says).sum()
    }
}

/// p(C|M) = e^S / (e^S + e^−S).
#[must_use]
pub fn probability(score: f64) -> f64 {
    1.0 / (1.0 + (-2.0 * score).exp())
}

/// The class with the largest p(C|M), of several the lowest; `scores` holds S for every class, or none for a class
/// that has no training models and cannot be chosen.
///
/// p grows with S, so S is compared: p rounds to 1 where S still tells classes apart.
#[must_use]
pub fn decide(scores: &[Option<f64>]) -> Option<u32> {
    let mut best: Option<(f64, u32)> = None;
    for (class, score) in (0..).zip(scores) {
        if let Some(score) = *score
            && best.is_none_or(|(greatest, _)| score > greatest)
        {
            best = Some((score, class));
        }
    }
    best.map(|(_, class)| class)
}

#[cfg(test)]
mod tests {
    use super::{Round, SelCount, Strong, decide, probability};

    fn strong() -> Strong {
        let round = |index, ties: &[u32]| Round { index, error: 0.1, alpha: 1.0, ties: ties.to_vec(), test: None };
        Strong { rounds: vec![round(3, &[3, 4]), round(3, &[3]), round(9, &[9, 12])] }
    }

    #[test]
    fn counts_and_cuts() {
        assert_eq!(strong().selected(SelCount::Chosen), 2);
        assert_eq!(strong().selected(SelCount::Ties), 4);
        assert_eq!(strong().reach(), 9);
        assert_eq!(strong().cut(2).reach(), 3);
        assert_eq!(strong().cut(7), strong());
        assert_eq!(Strong::default().reach(), 0);
    }

    #[test]
    fn the_larger_score_wins_where_probabilities_are_both_one() {
        assert_eq!(probability(30.0), probability(31.0));
        assert_eq!(decide(&[Some(30.0), Some(31.0)]), Some(1));
        assert_eq!(probability(0.0), 0.5);
        assert!((probability(1.0) - 1f64.exp() / (1f64.exp() + (-1f64).exp())).abs() < 1e-15);
    }

    #[test]
    fn ties_go_to_the_lowest_class_and_absent_classes_cannot_win() {
        assert_eq!(decide(&[Some(-2.0), Some(-1.0), Some(-1.0)]), Some(1));
        assert_eq!(decide(&[None, Some(-1.0)]), Some(1));
        assert_eq!(decide(&[None]), None);
    }
}

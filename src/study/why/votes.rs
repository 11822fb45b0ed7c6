//! What the strong classifiers of AdaBoost say of one model, and which eigenvalues made them say it.

use std::{collections::BTreeMap, sync::Arc};

use super::seat;
use crate::{
    metrics::Sample,
    selection::{Ranges, Strong, probability},
};

/// A class as its strong classifier sees the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vote {
    /// The class.
    pub class: u32,
    /// S = Σ `α_t` `h_t`.
    pub score: f64,
    /// p = e^S / (e^S + e^−S).
    pub probability: f64,
}

/// The classes in the order in which their strong classifiers take the model for theirs.
#[derive(Debug, Clone, PartialEq)]
pub struct Votes {
    /// The row of the model: training models first, then query models.
    pub asked: usize,
    /// Its class.
    pub class: u32,
    /// The surest first.
    pub votes: Vec<Vote>,
    /// By class: what each eigenvalue it looks at adds to S, ascending by index.
    terms: Vec<Vec<(u32, f64)>>,
}

/// Asks the strong classifiers, one per class, about the model at row `asked` of the sample. None when there is no such
/// row.
///
/// # Panics
/// When there is not one classifier for each class, or one looks at an index beyond the sample's features.
#[must_use]
pub fn votes(sample: &Arc<Sample>, asked: usize, classes: &[Strong]) -> Option<Votes> {
    assert_eq!(classes.len(), sample.classes, "one strong classifier for each class");
    let (exam, place) = seat(sample, asked)?;
    let ranges = Ranges::new(sample);
    let features = exam.row(place);
    let terms: Vec<Vec<(u32, f64)>> = classes
        .iter()
        .enumerate()
        .map(|(class, strong)| {
            let mut terms = BTreeMap::new();
            for round in strong.rounds.iter().filter(|_| ranges.known(class)) {
                let says = if ranges.says(class, round, features) { round.alpha } else { -round.alpha };
                *terms.entry(round.index).or_insert(0.0) += says;
            }
            terms.into_iter().collect()
        })
        .collect();
    let mut votes: Vec<Vote> = classes
        .iter()
        .enumerate()
        .filter(|(class, _)| ranges.known(*class))
        .map(|(class, strong)| {
            let score = strong.score(class, &ranges, features);
            Vote { class: class as u32, score, probability: probability(score) }
        })
        .collect();
    votes.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.class.cmp(&b.class)));
    Some(Votes { asked, class: exam.label(place), votes, terms })
}

impl Votes {
    /// What each eigenvalue adds to the S of the class at `place` of [`Votes::votes`], ascending by index: above 0 it
    /// speaks for the class, below against it.
    #[must_use]
    pub fn terms(&self, place: usize) -> &[(u32, f64)] {
        self.votes.get(place).and_then(|vote| self.terms.get(vote.class as usize)).map_or(&[], Vec::as_slice)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        metrics::Features,
        selection::{Round, boost},
        study::boosted,
        watch::Unwatched,
    };

    #[test]
    fn votes_by_hand() {
        let sample = Arc::new(Sample {
            train: Features::from_rows([[1.0, 0.0], [2.0, 9.0], [6.0, 0.0]]),
            train_labels: vec![0, 0, 1],
            query: Features::from_rows([[1.5, 20.0]]),
            query_labels: vec![1],
            classes: 3,
        });
        let round = |index, alpha| Round { index, error: 0.1, alpha, ties: vec![index], test: None };
        let classes = [
            Strong { rounds: vec![round(2, 0.25), round(1, 1.0), round(2, 0.5)] },
            Strong { rounds: vec![round(1, 2.0)] },
            Strong::default(),
        ];
        let votes = votes(&sample, 3, &classes).unwrap();
        let scores: Vec<(u32, f64)> = votes.votes.iter().map(|vote| (vote.class, vote.score)).collect();
        assert_eq!(scores, [(0, 0.25), (1, -2.0)]);
        assert_eq!(votes.terms(0), [(1, 1.0), (2, -0.75)]);
        assert_eq!((votes.terms(1), votes.terms(2)), ([(1, -2.0)].as_slice(), [].as_slice()));
        assert_eq!(votes.class, 1);
    }

    #[test]
    fn the_first_vote_is_the_decision() {
        let sample = Arc::new(crate::metrics::samples::sample(3, 5, 12, 4));
        let classes = boost(&sample, 4, &Unwatched).unwrap();
        let boosted = boosted(&sample, &classes);
        for (row, &decided) in boosted.decided.iter().enumerate() {
            assert_eq!(votes(&sample, row, &classes).unwrap().votes[0].class, decided);
        }
        assert!(votes(&sample, boosted.decided.len(), &classes).is_none());
    }
}

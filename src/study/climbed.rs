//! What hill climbing selected, scored.

use serde::{Deserialize, Serialize};

use super::Score;
use crate::{
    metrics::{Distance, Exam, Sample, figures},
    selection::Climb,
};

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

/// Scores a selection made by hill climbing. Features beyond the climb's do not matter: the sample may be wider than
/// the one climbed.
///
/// # Panics
/// When the climb selected an index beyond the sample's features.
#[must_use]
pub fn climbed(sample: &Sample, distance: Distance, climb: &Climb) -> Climbed {
    let order = climb.order();
    let train = figures(Exam::leave_one_out(sample), distance, &order);
    let queries = Exam::queries(sample);
    let query = (!queries.is_empty()).then(|| figures(queries, distance, &order));
    Climbed {
        climb: climb.clone(),
        error: Score { train: train.0, query: query.map(|query| query.0) },
        adr: Score { train: train.1, query: query.map(|query| query.1) },
    }
}

#[cfg(test)]
mod tests {
    use super::climbed;
    use crate::{
        metrics::{
            Distance,
            samples::{one_class, sample, samples},
        },
        selection::{Climb, Cost, climb},
        study::Score,
        watch::Unwatched,
    };

    #[test]
    fn the_score_is_the_last_cost() {
        for sample in samples() {
            for distance in Distance::ALL {
                let error = climb(&sample, distance, Cost::Error, &Unwatched).unwrap();
                if let Some(last) = error.steps.last() {
                    assert_eq!(climbed(&sample, distance, &error).error.train, last.cost);
                }
                let adr = climb(&sample, distance, Cost::Adr, &Unwatched).unwrap();
                if let Some(last) = adr.steps.last() {
                    assert_eq!(1.0 - climbed(&sample, distance, &adr).adr.train, last.cost);
                }
            }
        }
    }

    #[test]
    fn a_wider_sample_scores_the_same() {
        let sample = sample(1, 6, 20, 0);
        let climb = climb(&sample.prefix(10), Distance::L1, Cost::Adr, &Unwatched).unwrap();
        assert_eq!(climbed(&sample, Distance::L1, &climb), climbed(&sample.prefix(10), Distance::L1, &climb));
    }

    #[test]
    fn nothing_selected_or_nobody_asked() {
        let climbed = climbed(&one_class(), Distance::L2, &Climb::default());
        assert_eq!(
            (climbed.error, climbed.adr),
            (Score { train: 1.0, query: None }, Score { train: 0.0, query: None })
        );
    }
}

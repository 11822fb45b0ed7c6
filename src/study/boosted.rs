//! What AdaBoost selected, scored and as marks on the spectrum.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Score;
use crate::{
    metrics::{Exam, Sample},
    selection::{Ranges, SelCount, Strong, decide},
};

/// AdaBoost after T rounds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Boosted {
    /// One strong classifier per class, cut to T rounds.
    pub classes: Vec<Strong>,
    /// ε of the class with the largest p(C|M).
    pub error: Score,
    /// Mean over the classes that have training models of the number of distinct eigenvalues chosen.
    pub mean_chosen: f64,
    /// The same with every eigenvalue that tied for the least error.
    pub mean_ties: f64,
    /// The class decided for every model: the training models in their order, then the query models. [`Boosted::NONE`]
    /// where no class has training models.
    pub decided: Vec<u32>,
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

impl Boosted {
    /// The decision for no class.
    pub const NONE: u32 = u32::MAX;
}

/// Lets the strong classifiers, one per class, decide on every model.
///
/// # Panics
/// When there is not one classifier for each class, or one looks at an index beyond the sample's features.
#[must_use]
pub fn boosted(sample: &Sample, classes: &[Strong]) -> Boosted {
    assert_eq!(classes.len(), sample.classes, "one strong classifier for each class");
    let ranges = Ranges::new(sample);
    let decision = |features: &[f64]| {
        let score = |class: usize| ranges.known(class).then(|| classes[class].score(class, &ranges, features));
        decide(&(0..classes.len()).map(score).collect::<Vec<_>>()).unwrap_or(Boosted::NONE)
    };
    let decisions = |exam: Exam<'_>| (0..exam.len()).map(|asked| decision(exam.row(asked))).collect::<Vec<_>>();
    let wrong = |decided: &[u32], labels: &[u32]| {
        let wrong = decided.iter().zip(labels).filter(|(decided, label)| decided != label).count();
        if labels.is_empty() { 1.0 } else { wrong as f64 / labels.len() as f64 }
    };
    let (train, query) = (decisions(Exam::leave_one_out(sample)), decisions(Exam::queries(sample)));
    let error = Score {
        train: wrong(&train, &sample.train_labels),
        query: (!query.is_empty()).then(|| wrong(&query, &sample.query_labels)),
    };
    let mean = |count: SelCount| {
        let known = || (0..classes.len()).filter(|&class| ranges.known(class));
        let sum: usize = known().map(|class| classes[class].selected(count)).sum();
        sum as f64 / known().count().max(1) as f64
    };
    Boosted {
        classes: classes.to_vec(),
        error,
        mean_chosen: mean(SelCount::Chosen),
        mean_ties: mean(SelCount::Ties),
        decided: [train, query].concat(),
    }
}

/// For each class, the eigenvalues its strong classifier looks at, ascending.
///
/// # Panics
/// When there are more classifiers than classes, or one looks at an index beyond the sample's features.
#[must_use]
pub fn marks(sample: &Sample, classes: &[Strong]) -> Vec<Vec<Mark>> {
    let (ranges, sizes) = (Ranges::new(sample), sample.class_sizes());
    let mark = |class: usize, index: u32, alpha: f64| {
        let col = index as usize - 1;
        let (low, high) = ranges.class(class);
        let members = (0..sample.train.rows()).filter(|&model| sample.train_labels[model] as usize == class);
        let sum: f64 = members.map(|model| sample.train.row(model)[col]).sum();
        Mark { index, alpha, low: low[col], mean: sum / sizes[class] as f64, high: high[col] }
    };
    let of_class = |(class, strong): (usize, &Strong)| {
        let mut alphas = BTreeMap::new();
        for round in &strong.rounds {
            *alphas.entry(round.index).or_insert(0.0) += round.alpha;
        }
        alphas.into_iter().map(|(index, alpha)| mark(class, index, alpha)).collect()
    };
    classes.iter().enumerate().map(of_class).collect()
}

#[cfg(test)]
mod tests {
    use super::{Boosted, Mark, boosted, marks};
    use crate::{
        metrics::{Features, Sample, samples::only_queries},
        selection::{Round, Strong, boost},
        watch::Unwatched,
    };

    fn sample() -> Sample {
        Sample {
            train: Features::from_rows([[1.0, 0.0], [2.0, 0.0], [6.0, 0.0], [5.0, 0.0]]),
            train_labels: vec![0, 0, 1, 1],
            query: Features::from_rows([[1.5, 0.0], [5.5, 0.0], [9.0, 0.0]]),
            query_labels: vec![0, 1, 1],
            classes: 3,
        }
    }

    fn round(index: u32, alpha: f64) -> Round {
        Round { index, error: 0.1, alpha, ties: vec![index, 2], test: None }
    }

    #[test]
    fn decisions_by_hand() {
        let strong = boost(&sample(), 3, &Unwatched).unwrap();
        let boosted = boosted(&sample(), &strong);
        // 9 lies outside of both ranges, S is the same for both: the lower class.
        assert_eq!(boosted.decided, [0, 0, 1, 1, 0, 1, 0]);
        assert_eq!((boosted.error.train, boosted.error.query), (0.0, Some(1.0 / 3.0)));
        assert_eq!((boosted.mean_chosen, boosted.mean_ties), (1.0, 1.0));
    }

    #[test]
    fn counts_follow_chosen_and_ties() {
        let classes = [vec![round(1, 1.0), round(1, 0.5)], vec![round(1, 1.0), round(2, 0.5)], vec![]];
        let classes = classes.map(|rounds| Strong { rounds });
        let boosted = boosted(&sample(), &classes);
        assert_eq!((boosted.mean_chosen, boosted.mean_ties), (1.5, 2.0));
    }

    #[test]
    fn without_training_models_no_class_is_decided() {
        let sample = only_queries();
        let boosted = boosted(&sample, &boost(&sample, 3, &Unwatched).unwrap());
        assert!(boosted.decided.iter().all(|&class| class == Boosted::NONE));
        assert_eq!((boosted.error.train, boosted.error.query), (1.0, Some(1.0)));
    }

    #[test]
    fn marks_by_hand() {
        let classes = [vec![], vec![round(2, 0.5), round(1, 1.0), round(1, 0.25)], vec![]];
        let marks = marks(&sample(), &classes.map(|rounds| Strong { rounds }));
        assert_eq!(marks.len(), 3);
        assert!(marks[0].is_empty() && marks[2].is_empty());
        let first = Mark { index: 1, alpha: 1.25, low: 5.0, mean: 5.5, high: 6.0 };
        assert_eq!(marks[1], [first, Mark { index: 2, alpha: 0.5, low: 0.0, mean: 0.0, high: 0.0 }]);
    }
}

//! The training models around one model, and what each eigenvalue adds to a distance.

use std::sync::Arc;

use super::seat;
use crate::metrics::{Distance, Exam, Sample, adr, rank};

/// A training model as another one finds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbour {
    /// Its row among the training models.
    pub model: usize,
    /// Its class.
    pub class: u32,
    /// Its distance over the selection.
    pub distance: f64,
}

/// The training models in the order in which one model finds them.
#[derive(Debug, Clone, PartialEq)]
pub struct Neighbours {
    /// The row of the model that asks: training models first, then query models.
    pub asked: usize,
    /// Its class.
    pub class: u32,
    /// The eigenvalues compared (indices from 1), in the order in which their terms are added.
    pub selection: Vec<u32>,
    /// The nearest first.
    pub found: Vec<Neighbour>,
    /// The ADR of this ranking; none where nothing relevant can be found.
    pub adr: Option<f64>,
    distance: Distance,
    sample: Arc<Sample>,
}

/// Ranks the training models by their distance from the model at row `asked` of the sample (training models first, then
/// query models). None when there is no such row.
///
/// # Panics
/// When an index of the selection is out of range.
#[must_use]
pub fn neighbours(sample: &Arc<Sample>, asked: usize, distance: Distance, selection: &[u32]) -> Option<Neighbours> {
    let (exam, place) = seat(sample, asked)?;
    let order = if selection.is_empty() { Vec::new() } else { rank(exam, place, distance, selection) };
    let of = |&model: &u32| {
        let model = model as usize;
        let sum = distance.sum(exam.row(place), exam.models().row(model), selection);
        Neighbour { model, class: exam.labels()[model], distance: distance.from_sum(sum) }
    };
    let class = exam.label(place);
    let found = order.iter().map(of).collect();
    let adr = adr(&order, exam.labels(), class);
    Some(Neighbours { asked, class, selection: selection.to_vec(), found, adr, distance, sample: Arc::clone(sample) })
}

impl Neighbours {
    /// The nearest neighbour of the model's own class, a place in [`Neighbours::found`].
    #[must_use]
    pub fn own(&self) -> Option<usize> {
        self.found.iter().position(|neighbour| neighbour.class == self.class)
    }

    fn row(&self) -> &[f64] {
        seat(&self.sample, self.asked).map_or(&[], |(exam, place): (Exam<'_>, usize)| exam.row(place))
    }

    /// The features of the model that asks and of a neighbour. None when there is no such neighbour.
    #[must_use]
    pub fn features(&self, neighbour: usize) -> Option<(&[f64], &[f64])> {
        let found = self.found.get(neighbour)?;
        Some((self.row(), self.sample.train.row(found.model)))
    }

    /// What each eigenvalue of the selection adds to the distance to a neighbour, as shares of the whole: the
    /// index and its share, ascending by index. Empty where there is no such neighbour or no distance at all.
    ///
    /// For L2 the shares are those of the squared distance, whose terms add up.
    #[must_use]
    pub fn shares(&self, neighbour: usize) -> Vec<(u32, f64)> {
        let terms = self.terms(neighbour);
        let total: f64 = terms.iter().map(|(_, term)| term).sum();
        if total > 0.0 { terms.into_iter().map(|(index, term)| (index, term / total)).collect() } else { Vec::new() }
    }

    /// What each eigenvalue adds to the distance to a neighbour (squared for L2), ascending by index.
    #[must_use]
    pub fn terms(&self, neighbour: usize) -> Vec<(u32, f64)> {
        let Some((asked, found)) = self.features(neighbour) else { return Vec::new() };
        let mut terms: Vec<(u32, f64)> =
            self.selection.iter().map(|&index| (index, self.distance.sum(asked, found, &[index]))).collect();
        terms.sort_unstable_by_key(|(index, _)| *index);
        terms
    }

    /// How much farther each eigenvalue puts the nearest model of the own class than this neighbour: the terms of the
    /// own class less those of the neighbour. What is above 0 speaks for the neighbour, what is below for the own
    /// class; they add up to the difference of the two sums. Empty where one of the two does not exist.
    #[must_use]
    pub fn difference(&self, neighbour: usize) -> Vec<(u32, f64)> {
        let Some(own) = self.own() else { return Vec::new() };
        let others = self.terms(neighbour);
        self.terms(own).into_iter().zip(others).map(|((index, own), (_, other))| (index, own - other)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Features;

    /// Two classes on a plane, and a query.
    fn plane() -> Arc<Sample> {
        Arc::new(Sample {
            train: Features::from_rows([[0.0, 0.0], [0.0, 4.0], [3.0, 0.0]]),
            train_labels: vec![0, 0, 1],
            query: Features::from_rows([[2.0, 1.0]]),
            query_labels: vec![0],
            classes: 2,
        })
    }

    #[test]
    fn a_query_by_hand() {
        let found = neighbours(&plane(), 3, Distance::L2, &[1, 2]).unwrap();
        let order: Vec<usize> = found.found.iter().map(|n| n.model).collect();
        assert_eq!(order, [2, 0, 1]);
        assert_eq!(found.found[0].distance, 2_f64.sqrt());
        assert_eq!((found.class, found.own()), (0, Some(1)));
        // Relevant at ranks 2 and 3 of Q = 2: r_1/1 = 0, r_2/2 = 1/2.
        assert_eq!(found.adr, Some(0.25));
        assert_eq!(found.shares(0), [(1, 0.5), (2, 0.5)]);
        assert_eq!(found.terms(1), [(1, 4.0), (2, 1.0)]);
        // The first eigenvalue puts the query nearer to the other class, the second says nothing.
        assert_eq!(found.difference(0), [(1, 3.0), (2, 0.0)]);
    }

    #[test]
    fn a_training_model_is_not_its_own_neighbour() {
        let found = neighbours(&plane(), 0, Distance::L1, &[2]).unwrap();
        let order: Vec<usize> = found.found.iter().map(|n| n.model).collect();
        assert_eq!(order, [2, 1]);
        assert!(found.shares(0).is_empty(), "no distance, no shares");
        assert!(found.shares(9).is_empty() && found.features(9).is_none());
        assert!(neighbours(&plane(), 4, Distance::L1, &[2]).is_none());
        assert!(neighbours(&plane(), 0, Distance::L1, &[]).unwrap().found.is_empty());
    }
}

//! The weak classifiers: where the positives' values lie.

use super::Round;
use crate::metrics::Sample;

/// For every class, the range of its training models' values at every eigenvalue.
///
/// The paper's weak classifier (section 3.3) says +1 when the greatest |`λ_k(M)` − `λ_k(R)|` over the positives R is at
/// most the greatest such difference among the positives: when `λ_k(M)` lies within their range.
pub(crate) struct Ranges {
    cols: usize,
    low: Vec<f64>,
    high: Vec<f64>,
    sizes: Vec<usize>,
}

impl Ranges {
    pub(crate) fn new(sample: &Sample) -> Self {
        let cols = sample.train.cols();
        let mut low = vec![f64::INFINITY; sample.classes * cols];
        let mut high = vec![f64::NEG_INFINITY; sample.classes * cols];
        for (row, &label) in sample.train_labels.iter().enumerate() {
            let at = label as usize * cols..(label as usize + 1) * cols;
            let range = low[at.clone()].iter_mut().zip(&mut high[at]);
            for ((low, high), &value) in range.zip(sample.train.row(row)) {
                *low = low.min(value);
                *high = high.max(value);
            }
        }
        Self { cols, low, high, sizes: sample.class_sizes() }
    }

    /// Whether the class has training models.
    pub(crate) fn known(&self, class: usize) -> bool {
        self.sizes[class] > 0
    }

    /// Least and greatest value of a class at every eigenvalue.
    pub(crate) fn class(&self, class: usize) -> (&[f64], &[f64]) {
        let at = class * self.cols..(class + 1) * self.cols;
        (&self.low[at.clone()], &self.high[at])
    }

    /// Whether a weak classifier of `class` says +1 to a model with these features.
    pub(crate) fn says(&self, class: usize, round: &Round, features: &[f64]) -> bool {
        match &round.test {
            Some(test) => test.says(features[round.index as usize - 1]),
            None => self.holds(class, round.index, features),
        }
    }

    /// Whether the range of `class` at `index` (from 1) holds a model with these features.
    fn holds(&self, class: usize, index: u32, features: &[f64]) -> bool {
        let col = index as usize - 1;
        let (low, high) = self.class(class);
        (low[col]..=high[col]).contains(&features[col])
    }
}

//! The labelled feature vectors of one study.

use super::Features;

/// Training models D and query models Q with their classes: what every selection and every figure is computed from.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sample {
    /// Features of D.
    pub train: Features,
    /// The class of each row of `train`.
    pub train_labels: Vec<u32>,
    /// Features of Q, as many columns as `train`; it may have no rows.
    pub query: Features,
    /// The class of each row of `query`.
    pub query_labels: Vec<u32>,
    /// How many classes there are; every label is below it. A class may have no models.
    pub classes: usize,
}

impl Sample {
    /// The same models with their first `cols` features.
    ///
    /// # Panics
    /// When there are fewer than `cols`.
    #[must_use]
    pub fn prefix(&self, cols: usize) -> Self {
        let cut = |features: &Features| if features.rows() == 0 { features.clone() } else { features.prefix(cols) };
        Self { train: cut(&self.train), query: cut(&self.query), ..self.clone() }
    }

    /// How many training models each class has.
    #[must_use]
    pub fn class_sizes(&self) -> Vec<usize> {
        let mut sizes = vec![0; self.classes];
        for &label in &self.train_labels {
            sizes[label as usize] += 1;
        }
        sizes
    }
}

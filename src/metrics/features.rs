//! The feature vectors of many models.

/// A feature vector per model: `rows` models by `cols` features, row after row. All features are finite.
///
/// Column j belongs to eigenvalue index j + 1.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Features {
    rows: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Features {
    /// Stacks rows of equal length.
    ///
    /// # Panics
    /// When the rows differ in length.
    #[must_use]
    pub fn from_rows<R: AsRef<[f64]>>(rows: impl IntoIterator<Item = R>) -> Self {
        let mut features = Self::default();
        for row in rows {
            let row = row.as_ref();
            assert!(features.rows == 0 || row.len() == features.cols, "rows of different lengths");
            features.cols = row.len();
            features.rows += 1;
            features.data.extend_from_slice(row);
        }
        features
    }

    /// Number of models.
    #[must_use]
    pub const fn rows(&self) -> usize {
        self.rows
    }

    /// Number of features of each model.
    #[must_use]
    pub const fn cols(&self) -> usize {
        self.cols
    }

    /// The features of model `row`.
    ///
    /// # Panics
    /// When `row` is not below [`Features::rows`].
    #[must_use]
    pub fn row(&self, row: usize) -> &[f64] {
        &self.data[row * self.cols..(row + 1) * self.cols]
    }

    /// The first `cols` features of every model.
    ///
    /// # Panics
    /// When there are fewer than `cols`.
    #[must_use]
    pub fn prefix(&self, cols: usize) -> Self {
        Self::from_rows((0..self.rows).map(|row| &self.row(row)[..cols]))
    }
}

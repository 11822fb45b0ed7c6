//! Feature after feature instead of model after model.

use super::Features;

/// Lanes to which the columns are padded, so that loops over a column have no remainder.
const LANES: usize = 16;

/// The columns of [`Features`], each one contiguous and padded with zeros to a multiple of 16 models.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    stride: usize,
    cols: usize,
    data: Vec<f64>,
}

impl Columns {
    pub(crate) fn new(features: &Features) -> Self {
        let stride = features.rows().next_multiple_of(LANES);
        let cols = features.cols();
        let mut data = vec![0.0; stride * cols];
        for row in 0..features.rows() {
            for (col, &value) in features.row(row).iter().enumerate() {
                data[col * stride + row] = value;
            }
        }
        Self { stride, cols, data }
    }

    /// Length of a padded column.
    pub(crate) const fn stride(&self) -> usize {
        self.stride
    }

    /// How many columns there are.
    pub(crate) const fn len(&self) -> usize {
        self.cols
    }

    /// The values of feature `col`, counted from 0, of all models, and the padding.
    #[inline(always)]
    pub(crate) fn col(&self, col: usize) -> &[f64] {
        &self.data[col * self.stride..(col + 1) * self.stride]
    }
}

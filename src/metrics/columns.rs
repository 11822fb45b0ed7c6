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

/// [`Features`] in panels of 8 models and 8 features: what is read together lies together. The last panels are padded
/// with zeros.
#[derive(Debug, Clone)]
pub(crate) struct Panels {
    /// Panels that have the same features.
    models: usize,
    /// Feature by feature.
    panels: Vec<[[f64; Self::MODELS]; Self::FEATURES]>,
}

impl Panels {
    /// The models of a panel: the lanes of the widest vector.
    pub(crate) const MODELS: usize = 8;
    /// The features of a panel.
    pub(crate) const FEATURES: usize = 8;

    pub(crate) fn new(features: &Features) -> Self {
        let models = features.rows().div_ceil(Self::MODELS);
        let mut panels = vec![[[0.0; Self::MODELS]; Self::FEATURES]; models * features.cols().div_ceil(Self::FEATURES)];
        for row in 0..features.rows() {
            let of_row = panels[row / Self::MODELS..].iter_mut().step_by(models);
            for (panel, values) in of_row.zip(features.row(row).chunks(Self::FEATURES)) {
                panel.iter_mut().zip(values).for_each(|(of_feature, &value)| of_feature[row % Self::MODELS] = value);
            }
        }
        Self { models, panels }
    }

    /// The panel of the models and features that begin with these numbers.
    #[inline(always)]
    pub(crate) fn at(&self, model: usize, feature: usize) -> &[[f64; Self::MODELS]; Self::FEATURES] {
        &self.panels[feature / Self::FEATURES * self.models + model / Self::MODELS]
    }
}

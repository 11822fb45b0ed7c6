//! The features in single precision, for a first look.

use crate::metrics::{Columns, RELATIVELY, Term};

/// Whatever is too small a number for single precision is well below this.
const LEAST: f64 = f64::from_bits((1023 - 100) << 52);
/// Terms that are off by less, and sums of them, are finite in single precision.
const MOST_OFF: f64 = f64::from_bits((1023 + 60) << 52);
/// No sum of a relative is taken for more.
const FARTHEST: f64 = f64::from_bits((1023 + 100) << 52);
/// What is left of a distance that is shortened by more than twice what it may be off relatively.
pub(super) const SHORTENED: f32 = (1.0 - 4.0 * RELATIVELY) as f32;
/// The same of one that is lengthened.
pub(super) const LENGTHENED: f32 = (1.0 + 4.0 * RELATIVELY) as f32;

/// All features, as [`Term::singles`] has them.
pub(super) struct Singles {
    models: usize,
    values: Vec<f32>,
    /// By feature: see [`Singles::margin`].
    margins: Vec<f32>,
}

impl Singles {
    pub(super) fn new<T: Term>(columns: &Columns, models: usize) -> Self {
        let (mut values, mut margins) = (Vec::with_capacity(models * columns.len()), Vec::new());
        for col in 0..columns.len() {
            match T::singles(&columns.col(col)[..models]) {
                Some((singles, off)) if off < MOST_OFF => {
                    values.extend(singles);
                    margins.push((4.0 * off).max(LEAST) as f32);
                }
                _ => {
                    values.resize(values.len() + models, 0.0);
                    margins.push(f32::MAX);
                }
            }
        }
        Self { models, values, margins }
    }

    /// More than twice what distances with feature `index` (from 1) on top may be off, beside what they are relatively.
    /// A distance that is [`SHORTENED`] and has this taken from it is less than another only where that is so in double
    /// precision, too. Greater than all distances where it is not known how far off they are.
    pub(super) fn margin(&self, index: u32) -> f32 {
        self.margins[index as usize - 1]
    }

    /// The features `indices` (from 1) of all models, model by model in so many lanes. Lanes left over repeat the last.
    pub(super) fn side_by_side(&self, indices: &[u32], lanes: usize) -> Vec<f32> {
        let mut values = vec![0.0; lanes * self.models];
        for lane in 0..lanes {
            let col = indices[lane.min(indices.len() - 1)] as usize - 1;
            let column = &self.values[col * self.models..(col + 1) * self.models];
            for (value, &of_model) in values[lane..].iter_mut().step_by(lanes).zip(column) {
                *value = of_model;
            }
        }
        values
    }
}

/// The sum of a relative: finite, so that margins can be taken from it.
pub(super) fn of_relative(sum: f64) -> f32 {
    sum.min(FARTHEST) as f32
}

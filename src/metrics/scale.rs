//! How much each feature counts, learnt from the training models.

use serde::{Deserialize, Serialize};

use super::{Features, Sample};

/// What every feature is divided by or weighted with, feature by feature: learnt on D, applied to D and Q.
///
/// A weight for each eigenvalue instead of a subset of them: a weight of 0 leaves one out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Features as they are, the paper's.
    #[default]
    None,
    /// Standardised: less the mean over D, divided by the standard deviation over D.
    Standard,
    /// Divided by the standard deviation within the classes, pooled over them (a Mahalanobis distance without
    /// covariances).
    Within,
    /// Standardised, and weighted by the ratio of the deviations between and within classes: the root of
    /// Fisher's ratio.
    Fisher,
}

/// Variances of one feature over the training models.
struct Spread {
    mean: f64,
    /// Of all models.
    total: f64,
    /// Of models around their class's mean.
    within: f64,
}

impl Scale {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::None, Self::Standard, Self::Within, Self::Fisher];

    /// The sample with scaled features.
    ///
    /// A feature that is the same in all training models tells nothing and becomes 0. One that is the same within every
    /// class has no spread to be measured by there: that over D takes its place.
    #[must_use]
    pub fn apply(self, sample: &Sample) -> Sample {
        if self == Self::None {
            return sample.clone();
        }
        let steps: Vec<(f64, f64)> = (0..sample.train.cols()).map(|col| self.step(&Spread::of(sample, col))).collect();
        let scaled = |features: &Features| {
            Features::from_rows((0..features.rows()).map(|row| {
                let values = features.row(row).iter().zip(&steps);
                values.map(|(value, &(shift, factor))| (value - shift) * factor).collect::<Vec<_>>()
            }))
        };
        Sample { train: scaled(&sample.train), query: scaled(&sample.query), ..sample.clone() }
    }

    /// What is taken off a feature, and what it is multiplied with then.
    fn step(self, spread: &Spread) -> (f64, f64) {
        let &Spread { mean, total, within } = spread;
        // What rounding leaves of a feature that does not vary.
        if total <= (1e-12 * mean).powi(2) {
            return (mean, 0.0);
        }
        let within = if within <= 1e-24 * total { total } else { within };
        match self {
            Self::None => (0.0, 1.0),
            Self::Standard => (mean, 1.0 / total.sqrt()),
            Self::Within => (0.0, 1.0 / within.sqrt()),
            Self::Fisher => (mean, ((total - within).max(0.0) / within / total).sqrt()),
        }
    }
}

impl Spread {
    /// Of feature `col`, counted from 0. Unbiased: by the number of models less one, or less the number of classes.
    fn of(sample: &Sample, col: usize) -> Self {
        let sizes = sample.class_sizes();
        let models = || sample.train_labels.iter().enumerate().map(|(row, &label)| (sample.train.row(row)[col], label));
        let count = sample.train.rows();
        let known = sizes.iter().filter(|&&size| size > 0).count();
        let mean = models().map(|(value, _)| value).sum::<f64>() / count.max(1) as f64;
        let mut means = vec![0.0; sample.classes];
        for (value, label) in models() {
            means[label as usize] += value / sizes[label as usize] as f64;
        }
        let total: f64 = models().map(|(value, _)| (value - mean).powi(2)).sum();
        let within: f64 = models().map(|(value, label)| (value - means[label as usize]).powi(2)).sum();
        Self {
            mean,
            total: total / count.saturating_sub(1).max(1) as f64,
            within: within / count.saturating_sub(known).max(1) as f64,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Scale;
    use crate::metrics::{
        Distance, Exam, Features, Sample, figures,
        samples::{nobody, sample},
    };

    #[test]
    fn by_hand() {
        let sample = Sample {
            train: Features::from_rows([[0.0, 3.0, 1.0], [2.0, 3.0, 1.0], [4.0, 3.0, 2.0], [6.0, 3.0, 2.0]]),
            train_labels: vec![0, 0, 1, 1],
            query: Features::from_rows([[3.0, 9.0, 1.5]]),
            query_labels: vec![0],
            classes: 2,
        };
        // First feature: mean 3, total (9 + 1 + 1 + 9)/3, within 4·1/(4 − 2).
        let (total, within) = (20.0 / 3.0_f64, 2.0_f64);
        let standard = Scale::Standard.apply(&sample);
        assert_eq!(standard.train.row(0)[0], -3.0 * (1.0 / total.sqrt()));
        // The second does not vary in D, whatever a query has.
        assert_eq!((standard.train.row(0)[1], standard.query.row(0)[..2].to_vec()), (0.0, vec![0.0, 0.0]));
        let ratio = Scale::Within.apply(&sample).train.row(3)[0] / 6.0;
        assert!((ratio - 1.0 / within.sqrt()).abs() < 1e-15);
        let fisher = Scale::Fisher.apply(&sample).train.row(3)[0];
        assert!((fisher - 3.0 / total.sqrt() * ((total - within) / within).sqrt()).abs() < 1e-14);
        // The third is the same within each class: it counts by its spread over D, and is not infinite.
        assert!((Scale::Within.apply(&sample).train.row(3)[2] - 2.0 * 3.0_f64.sqrt()).abs() < 1e-14);
        assert_eq!(Scale::None.apply(&sample), sample);
    }

    #[test]
    fn units_do_not_matter_once_scaled() {
        let sample = sample(3, 6, 8, 0);
        let factors = [3.0, 1e-6, 1e6, 7.0, 0.1, 1.0, 12.0, 5.0];
        let stretch = |features: &Features| {
            let row = |row: usize| features.row(row).iter().zip(factors).map(|(v, f)| v * f).collect::<Vec<_>>();
            Features::from_rows((0..features.rows()).map(row))
        };
        let stretched = Sample { train: stretch(&sample.train), query: stretch(&sample.query), ..sample.clone() };
        let whole: Vec<u32> = (1..=8).collect();
        for scale in [Scale::Standard, Scale::Within, Scale::Fisher] {
            let of = |sample: &Sample| figures(Exam::leave_one_out(&scale.apply(sample)), Distance::L2, &whole);
            assert_eq!(of(&sample), of(&stretched), "{scale:?}");
        }
        let of = |sample: &Sample| figures(Exam::leave_one_out(sample), Distance::L2, &whole);
        assert_ne!(of(&sample), of(&stretched));
    }

    #[test]
    fn a_prefix_scales_alike() {
        let sample = sample(1, 5, 9, 0);
        for scale in Scale::ALL {
            assert_eq!(scale.apply(&sample).prefix(4), scale.apply(&sample.prefix(4)));
        }
        assert_eq!(Scale::Fisher.apply(&nobody()).train.rows(), 0);
    }
}

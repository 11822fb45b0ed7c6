//! Where along the spectrum the models of a class keep together, apart from all others.

use crate::{metrics::Sample, selection::Ranges};

/// Neighbouring eigenvalues at which a class keeps apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The first index, from 1.
    pub first: u32,
    /// The last index.
    pub last: u32,
    /// The mean of the purities in it.
    pub purity: f64,
}

/// A class's training models against all others, eigenvalue by eigenvalue.
///
/// The *purity* of a class at an eigenvalue is the share of its own among the training models whose value lies within
/// the range of the class: 1 where none of the others does, the class's share of all where all of them do. It is what
/// the paper's weak classifier (section 3.3) sees before any weight: all positives are in the range, and its error are
/// the others in it.
#[derive(Debug, Clone, PartialEq)]
pub struct Shared {
    /// The class.
    pub class: usize,
    /// How many training models it has.
    pub models: usize,
    /// The purity at each eigenvalue; entry k − 1 belongs to index k.
    pub purity: Vec<f64>,
    /// Where the purity keeps well above chance, the purest first.
    pub bands: Vec<Band>,
    /// The purity that a band keeps to: half way between chance and the class's best.
    pub level: f64,
}

/// Finds where the training models of a class keep together, over the first `kmax` eigenvalues. None when it has fewer
/// than two.
///
/// A band is a longest run of eigenvalues whose purity is at least half way from chance (the class's share of D) to the
/// class's best.
#[must_use]
pub fn shared(sample: &Sample, class: usize, kmax: usize) -> Option<Shared> {
    let sizes = sample.class_sizes();
    let models = *sizes.get(class)?;
    let cols = sample.train.cols().min(kmax);
    if models < 2 || cols == 0 {
        return None;
    }
    let ranges = Ranges::new(sample);
    let mut inside = vec![0_u32; cols];
    let (low, high) = ranges.class(class);
    for row in 0..sample.train.rows() {
        for (col, &value) in sample.train.row(row)[..cols].iter().enumerate() {
            inside[col] += u32::from((low[col]..=high[col]).contains(&value));
        }
    }
    let purity: Vec<f64> = inside.iter().map(|&count| models as f64 / f64::from(count.max(1))).collect();
    let chance = models as f64 / sample.train.rows() as f64;
    let best = purity.iter().copied().fold(chance, f64::max);
    let level = f64::midpoint(chance, best);
    let mut bands = Vec::new();
    let mut first = None;
    for col in 0..=cols {
        let pure = purity.get(col).is_some_and(|&purity| purity >= level && best > chance);
        match (first, pure) {
            (None, true) => first = Some(col),
            (Some(from), false) => {
                let sum: f64 = purity[from..col].iter().sum();
                bands.push(Band { first: from as u32 + 1, last: col as u32, purity: sum / (col - from) as f64 });
                first = None;
            }
            _ => {}
        }
    }
    bands.sort_by(|a, b| b.purity.total_cmp(&a.purity).then(a.first.cmp(&b.first)));
    Some(Shared { class, models, purity, bands, level })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Features;

    #[test]
    fn bands_by_hand() {
        let sample = Sample {
            train: Features::from_rows([
                [0.0, 1.0, 1.0, 1.0, 5.0],
                [0.0, 2.0, 2.0, 9.0, 6.0],
                [0.0, 9.0, 1.5, 5.0, 0.0],
                [0.0, 8.0, 9.0, 6.0, 1.0],
            ]),
            train_labels: vec![0, 0, 1, 1],
            query: Features::default(),
            query_labels: Vec::new(),
            classes: 3,
        };
        let found = shared(&sample, 0, 5).unwrap();
        // Everybody has 0 first; the second tells all apart, the third all but one; in the fourth all lie within.
        assert_eq!(found.purity, [0.5, 1.0, 2.0 / 3.0, 0.5, 1.0]);
        assert_eq!(found.level, 0.75);
        let band = |first, last| Band { first, last, purity: 1.0 };
        assert_eq!(found.bands, [band(2, 2), band(5, 5)]);
        assert!(shared(&sample, 2, 5).is_none() && shared(&sample, 7, 5).is_none());
    }

    #[test]
    fn a_class_that_nothing_tells_apart_has_no_band() {
        let sample = Sample {
            train: Features::from_rows([[1.0], [1.0], [1.0]]),
            train_labels: vec![0, 0, 1],
            query: Features::default(),
            query_labels: Vec::new(),
            classes: 2,
        };
        assert!(shared(&sample, 0, 5).unwrap().bands.is_empty());
    }
}

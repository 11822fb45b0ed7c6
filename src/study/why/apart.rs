//! Which eigenvalues tell two classes apart.

use crate::metrics::Sample;

/// The training models of one class against those of another, eigenvalue by eigenvalue.
///
/// The *separation* at an eigenvalue is the rank-biserial correlation (Cureton 1956), `2·AUC − 1`: over all pairs of a
/// model of the class and one of the other, the share of those in which the class has the greater value less the share
/// of those in which it has the smaller. It is 1 where every model of the class lies above every one of the other, −1
/// where it lies below, 0 where neither is the greater; it does not depend on how values are scaled.
#[derive(Debug, Clone, PartialEq)]
pub struct Apart {
    /// The class.
    pub class: usize,
    /// The other one.
    pub other: usize,
    /// How many training models the two have.
    pub models: (usize, usize),
    /// The separation at each eigenvalue, −1 to 1; entry k − 1 belongs to index k.
    pub separation: Vec<f64>,
}

impl Apart {
    /// Indices from 1 with their separation, the strongest first, the lower index first among equals.
    #[must_use]
    pub fn strongest(&self) -> Vec<(u32, f64)> {
        let mut all: Vec<(u32, f64)> = (1..).zip(self.separation.iter().copied()).collect();
        all.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
        all
    }
}

/// Compares two classes over the first `kmax` eigenvalues. None when one of them has no training model.
#[must_use]
pub fn apart(sample: &Sample, class: usize, other: usize, kmax: usize) -> Option<Apart> {
    let of = |class: usize| {
        let own = |row: &usize| sample.train_labels[*row] as usize == class;
        (0..sample.train.rows()).filter(own).collect::<Vec<_>>()
    };
    let (mine, others) = (of(class), of(other));
    if mine.is_empty() || others.is_empty() {
        return None;
    }
    let cols = sample.train.cols().min(kmax);
    let separation = (0..cols).map(|col| {
        let value = |row: usize| sample.train.row(row)[col];
        let sign = |&row: &usize| {
            others
                .iter()
                .map(|&other| match value(row).partial_cmp(&value(other)) {
                    Some(std::cmp::Ordering::Greater) => 1.0,
                    Some(std::cmp::Ordering::Less) => -1.0,
                    _ => 0.0,
                })
                .sum::<f64>()
        };
        mine.iter().map(sign).sum::<f64>() / (mine.len() * others.len()) as f64
    });
    Some(Apart { class, other, models: (mine.len(), others.len()), separation: separation.collect() })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::Features;

    fn sample(train: &[(u32, &[f64])]) -> Sample {
        Sample {
            train: Features::from_rows(train.iter().map(|(_, row)| row.to_vec())),
            train_labels: train.iter().map(|(class, _)| *class).collect(),
            query: Features::from_rows(std::iter::empty::<Vec<f64>>()),
            query_labels: Vec::new(),
            classes: 3,
        }
    }

    #[test]
    fn separation_is_the_share_of_pairs_in_order() {
        let sample = sample(&[
            (0, &[0.0, 5.0, 1.0, 1.0]),
            (0, &[0.0, 6.0, 2.0, 3.0]),
            (1, &[0.0, 1.0, 3.0, 2.0]),
            (1, &[0.0, 2.0, 4.0, 3.0]),
            (2, &[9.0, 9.0, 9.0, 9.0]),
        ]);
        let found = apart(&sample, 0, 1, 10).unwrap();
        // At the last one 1 < 2, 1 < 3, 3 > 2, 3 = 3.
        assert_eq!(found.separation, [0.0, 1.0, -1.0, -0.25]);
        assert_eq!(found.strongest(), [(2, 1.0), (3, -1.0), (4, -0.25), (1, 0.0)]);
        let turned = apart(&sample, 1, 0, 2).unwrap();
        assert_eq!((turned.separation.as_slice(), turned.models), ([0.0, -1.0].as_slice(), (2, 2)));
        assert_eq!(apart(&sample, 0, 7, 2), None);
    }
}

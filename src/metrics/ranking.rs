//! Rankings, and the figures of one selection.

use rayon::prelude::*;

use super::{Distance, Exam};

/// The training models in the order in which a model asked for them finds them, nearest first.
///
/// Distances are over the features `selection` (indices from 1), summed in the order given; equal ones are ordered by
/// model index.
///
/// # Panics
/// When `asked` or an index is out of range.
#[must_use]
pub fn rank(exam: Exam<'_>, asked: usize, distance: Distance, selection: &[u32]) -> Vec<u32> {
    nearest(exam, asked, distance, selection, usize::MAX)
}

/// The first `count` of the ranking, or all there are.
fn nearest(exam: Exam<'_>, asked: usize, distance: Distance, selection: &[u32], count: usize) -> Vec<u32> {
    let row = exam.row(asked);
    let models = (0..exam.models().rows()).filter(|&model| Some(model) != exam.left_out(asked));
    let mut ranking: Vec<(f64, u32)> =
        models.map(|model| (distance.sum(row, exam.models().row(model), selection), model as u32)).collect();
    let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
    if count < ranking.len() {
        ranking.select_nth_unstable_by(count, order);
        ranking.truncate(count);
    }
    ranking.sort_unstable_by(order);
    ranking.into_iter().map(|(_, model)| model).collect()
}

/// ADR of one ranking, `labels` being the classes of the training models: (1/Q) Σ_{i=1..Q} `r_i`/i with Q the number of
/// models of class `label` in the ranking. None when there are none.
///
/// # Panics
/// When the ranking names a model without a label.
#[must_use]
pub fn adr(ranking: &[u32], labels: &[u32], label: u32) -> Option<f64> {
    let relevant = |model: &u32| labels[*model as usize] == label;
    let count = ranking.iter().filter(|model| relevant(model)).count();
    let mut found = 0_u32;
    let sum: f64 = (1_u32..)
        .zip(ranking)
        .take(count)
        .map(|(i, model)| {
            found += u32::from(relevant(model));
            f64::from(found) / f64::from(i)
        })
        .sum();
    (count > 0).then(|| sum / count as f64)
}

/// ε and mean ADR with the features `selection`.
///
/// ε counts the models asked that are not of the class of their nearest model; mean ADR is over those that have
/// something relevant to find. An empty selection tells nothing apart: ε = 1, mean ADR = 0.
///
/// # Panics
/// When an index is out of range.
#[must_use]
pub fn figures(exam: Exam<'_>, distance: Distance, selection: &[u32]) -> (f64, f64) {
    if selection.is_empty() {
        return (1.0, 0.0);
    }
    let (relevant, recall, labels) = (exam.relevant(), exam.recall(), exam.labels());
    let ask = |asked: usize| {
        let ranking = nearest(exam, asked, distance, selection, relevant[asked].max(1));
        let right = |model: &u32| labels[*model as usize] == exam.label(asked);
        let found = ranking.iter().zip(recall.weights(relevant[asked])).filter(|(model, _)| right(model));
        (usize::from(!ranking.first().is_some_and(right)), found.map(|(_, &weight)| weight).sum::<u128>())
    };
    let (wrong, sum) = (0..exam.len()).into_par_iter().map(ask).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    (share(wrong, exam.len()), recall.mean(sum))
}

/// How often a model of the class of the row was taken for one of the class of the column. Decisions for no class
/// (a number that is none of the classes) are left out.
#[must_use]
pub fn confusion(classes: usize, truth: &[u32], decided: &[u32]) -> Vec<Vec<u32>> {
    let mut counts = vec![vec![0; classes]; classes];
    for (&truth, &decided) in truth.iter().zip(decided) {
        if let Some(count) = counts.get_mut(truth as usize).and_then(|row| row.get_mut(decided as usize)) {
            *count += 1;
        }
    }
    counts
}

/// `wrong` of `asked`, 1 when none was asked.
pub(super) fn share(wrong: usize, asked: usize) -> f64 {
    if asked == 0 { 1.0 } else { wrong as f64 / asked as f64 }
}

#[cfg(test)]
mod tests {
    use super::{adr, confusion, figures, rank};
    use crate::metrics::{
        Distance, Exam, Features, Sample,
        samples::{nobody, only_queries, samples},
    };

    /// Four models on a line: a a b a, and two queries.
    fn line() -> Sample {
        Sample {
            train: Features::from_rows([[0.0], [2.0], [3.0], [4.0]]),
            train_labels: vec![0, 0, 1, 0],
            query: Features::from_rows([[2.5], [9.0]]),
            query_labels: vec![1, 0],
            classes: 2,
        }
    }

    #[test]
    fn rankings_by_hand() {
        let line = line();
        let of = |exam, asked| rank(exam, asked, Distance::L1, &[1]);
        // 2 lies as far from 0 as from 4: the lower model comes first.
        assert_eq!(of(Exam::leave_one_out(&line), 1), [2, 0, 3]);
        assert_eq!(of(Exam::leave_one_out(&line), 2), [1, 3, 0]);
        assert_eq!(of(Exam::queries(&line), 0), [1, 2, 3, 0]);
    }

    #[test]
    fn adr_by_hand() {
        let labels = [0, 0, 1, 0];
        // Of the first 1, 2, 3 retrieved, 1, 1, 2 are relevant: (1 + 1/2 + 2/3)/3.
        assert_eq!(adr(&[1, 2, 3, 0], &labels, 0), Some((1.0 + 0.5 + 2.0 / 3.0) / 3.0));
        assert_eq!(adr(&[1, 2, 3, 0], &labels, 1), Some(0.0));
        assert_eq!(adr(&[1, 2, 3, 0], &labels, 5), None);
    }

    #[test]
    fn figures_by_hand() {
        let line = line();
        // Nearest: 0 → 1 (a), 1 → 2 (b), 2 → 1 (a), 3 → 2 (b): three of four are wrong. Model 2 is alone in its class
        // and out of the mean. ADR: 0 finds a b: (1 + 1/2)/2; 1 finds b a: (0 + 1/2)/2; 3 finds b a: 1/4.
        let (error, mean) = figures(Exam::leave_one_out(&line), Distance::L2, &[1]);
        assert_eq!(error, 0.75);
        assert!((mean - (0.75 + 0.25 + 0.25) / 3.0).abs() < 1e-15);
        // 2.5 is as near to model 1 as to model 2, and goes to the former.
        assert_eq!(
            figures(Exam::queries(&line), Distance::L2, &[1]),
            (0.5, 0.5 * (0.0 + (1.0 + 0.5 + 2.0 / 3.0) / 3.0))
        );
    }

    #[test]
    fn mean_adr_is_the_mean_of_adr() {
        for sample in samples() {
            for exam in [Exam::leave_one_out(&sample), Exam::queries(&sample)] {
                let selection = [2, 1, 3];
                let adrs: Vec<f64> = (0..exam.len())
                    .filter_map(|asked| {
                        let ranking = rank(exam, asked, Distance::Chi2, &selection);
                        adr(&ranking, exam.labels(), exam.label(asked))
                    })
                    .collect();
                let mean = adrs.iter().sum::<f64>() / adrs.len().max(1) as f64;
                assert!((figures(exam, Distance::Chi2, &selection).1 - mean).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn figures_of_nothing_are_the_worst() {
        assert_eq!(figures(Exam::leave_one_out(&line()), Distance::L2, &[]), (1.0, 0.0));
        assert_eq!(figures(Exam::leave_one_out(&nobody()), Distance::L2, &[1]), (1.0, 0.0));
        assert_eq!(figures(Exam::queries(&only_queries()), Distance::L2, &[1]), (1.0, 0.0));
    }

    #[test]
    fn confusion_by_hand() {
        assert_eq!(confusion(2, &[0, 0, 1, 1], &[0, 1, 1, u32::MAX]), [[1, 1], [0, 1]]);
    }
}

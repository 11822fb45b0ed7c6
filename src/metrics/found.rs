//! Where the relevant models stand in rankings: recall with the model asked in it, and precision.

use super::{Columns, Distance, Exam, Recall, Term, by_distance};

/// The distance sums of one model asked to all training models, over the features `selection` (indices from 1) in the
/// order given.
///
/// # Panics
/// When an index is out of range.
pub(crate) fn sums(exam: Exam<'_>, columns: &Columns, asked: usize, distance: Distance, selection: &[u32]) -> Vec<f64> {
    by_distance!(distance, T => {
        let values = exam.row(asked);
        let mut sums = vec![0.0; columns.stride()];
        pulp::Arch::new().dispatch(Add::<T> { sums: &mut sums, values, columns, selection, term: std::marker::PhantomData });
        sums.truncate(exam.models().rows());
        sums
    })
}

/// The training models by their distance sums, nearest first, then by index; without the one left out.
pub(crate) fn ranking(sums: &[f64], left_out: Option<usize>) -> Vec<u32> {
    let mut ranking: Vec<u32> = (0..sums.len() as u32).filter(|&model| Some(model as usize) != left_out).collect();
    ranking.sort_unstable_by(|&a, &b| sums[a as usize].total_cmp(&sums[b as usize]).then(a.cmp(&b)));
    ranking
}

struct Add<'a, T> {
    sums: &'a mut [f64],
    values: &'a [f64],
    columns: &'a Columns,
    selection: &'a [u32],
    term: std::marker::PhantomData<T>,
}

impl<T: Term> pulp::NullaryFnOnce for Add<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        for &index in self.selection {
            let col = index as usize - 1;
            for (sum, &other) in self.sums.iter_mut().zip(self.columns.col(col)) {
                *sum += T::term(self.values[col], other);
            }
        }
    }
}

/// The ranks, from 1, of the relevant models in a ranking.
pub(crate) fn ranks(ranking: impl IntoIterator<Item = u32>, labels: &[u32], label: u32) -> Vec<usize> {
    let relevant = |(_, model): &(usize, u32)| labels[*model as usize] == label;
    (1..).zip(ranking).filter(relevant).map(|(rank, _)| rank).collect()
}

/// ADR of relevant models at these ranks of `relevant` there are, in the units of a [`Recall`] that knows that number.
pub(crate) fn gained(recall: &Recall, relevant: usize, ranks: &[usize]) -> u128 {
    let weights = recall.weights(relevant);
    ranks.iter().filter_map(|rank| weights.get(rank - 1)).sum()
}

/// The same when the model asked is the first that it finds, and one more to find.
pub(crate) fn gained_with_itself(recall: &Recall, relevant: usize, ranks: &[usize]) -> u128 {
    let weights = recall.weights(relevant + 1);
    weights[0] + ranks.iter().filter_map(|rank| weights.get(*rank)).sum::<u128>()
}

/// Precision when i/`levels` of the relevant models (rounded up) have been found, for i = 1…`levels`. What is never
/// found has a precision of 0.
pub(crate) fn precision(relevant: usize, ranks: &[usize], levels: usize) -> Vec<f64> {
    let at = |level: usize| {
        let found = (level * relevant).div_ceil(levels).max(1);
        ranks.get(found - 1).map_or(0.0, |&rank| found as f64 / rank as f64)
    };
    (1..=levels).map(at).collect()
}

#[cfg(test)]
mod tests {
    use super::{gained, gained_with_itself, precision, ranking, ranks, sums};
    use crate::metrics::{Columns, Distance, Exam, Recall, adr, rank, samples::samples};

    #[test]
    fn rankings_are_those_of_the_definition() {
        for sample in samples() {
            let columns = Columns::new(&sample.train);
            for exam in [Exam::leave_one_out(&sample), Exam::queries(&sample)] {
                let recall = exam.recall();
                for (asked, distance) in (0..exam.len()).flat_map(|asked| Distance::ALL.map(|d| (asked, d))) {
                    let sums = sums(exam, &columns, asked, distance, &[3, 1]);
                    let ranking = ranking(&sums, exam.left_out(asked));
                    assert_eq!(ranking, rank(exam, asked, distance, &[3, 1]));
                    let relevant = exam.relevant()[asked];
                    let Some(adr) = adr(&ranking, exam.labels(), exam.label(asked)) else { continue };
                    let ranks = ranks(ranking, exam.labels(), exam.label(asked));
                    let ours = gained(&recall, relevant, &ranks) as f64 / recall.scale() as f64;
                    assert!((ours - adr).abs() < 1e-14);
                }
            }
        }
    }

    #[test]
    fn recall_by_hand() {
        // Found at ranks 1 and 3 of 2: r = 1, 1 → (1 + 1/2)/2. With itself: 1, 2, 2 of 3 → (1 + 2/2 + 2/3)/3.
        let recall = Recall::new(&[2, 3]);
        let share = |sum: u128| sum as f64 / recall.scale() as f64;
        assert!((share(gained(&recall, 2, &[1, 3])) - 0.75).abs() < 1e-15);
        assert!((share(gained_with_itself(&recall, 2, &[1, 3])) - (2.0 + 2.0 / 3.0) / 3.0).abs() < 1e-15);
    }

    #[test]
    fn precision_by_hand() {
        assert_eq!(ranks([4, 2, 0, 1], &[7, 8, 7, 7, 8], 7), [2, 3]);
        assert_eq!(precision(2, &[2, 3], 2), [0.5, 2.0 / 3.0]);
        assert_eq!(precision(2, &[2, 3], 4), [0.5, 0.5, 2.0 / 3.0, 2.0 / 3.0]);
        // The second is never found.
        assert_eq!(precision(2, &[1], 2), [1.0, 0.0]);
    }
}

//! ε and mean ADR of the first k features, for every k in one pass.

use std::{marker::PhantomData, ops::Range};

use pulp::Simd;
use rayon::prelude::*;

use super::{Cancelled, Columns, Distance, Exam, Recall, Term, by_distance, shortlist::Shortlist};
use crate::watch::Watch;

/// Columns between two looks at the watch.
const POLL: usize = 32;
/// Models asked side by side: a column is then read from afar for all of them at once.
const GROUP: usize = 8;

/// ε and mean ADR for every k = 1…kmax; entry k − 1 belongs to k.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sweep {
    /// Classification error.
    pub error: Vec<f64>,
    /// Mean ADR.
    pub adr: Vec<f64>,
}

/// Sums over the asked models, for every k. Integers: in whatever order threads add them, they are the same.
#[derive(Clone)]
struct Tally {
    wrong: Vec<u32>,
    recall: Vec<u128>,
}

/// Computes the curves of an exam.
///
/// A distance over the first k + 1 features is that over the first k and one term more, and its nearest models are
/// nearly the same. The figures for k depend on the first k features alone, bit for bit.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn sweep(exam: Exam<'_>, distance: Distance, watch: &dyn Watch) -> Result<Sweep, Cancelled> {
    by_distance!(distance, T => sweep_by::<T>(exam, watch))
}

fn sweep_by<T: Term>(exam: Exam<'_>, watch: &dyn Watch) -> Result<Sweep, Cancelled> {
    let columns = Columns::new(exam.models());
    let (relevant, recall) = (exam.relevant(), exam.recall());
    let nothing = || Tally { wrong: vec![0; columns.len()], recall: vec![0; columns.len()] };
    let start = || (nothing(), vec![Shortlist::new(columns.stride()); GROUP]);
    let tally = (0..exam.len().div_ceil(GROUP))
        .into_par_iter()
        .try_fold(start, |(mut tally, mut shortlists), group| {
            let asked = group * GROUP..exam.len().min((group + 1) * GROUP);
            for (asked, shortlist) in asked.clone().zip(&mut shortlists) {
                shortlist.begin(exam.models().rows(), exam.left_out(asked), relevant[asked].max(1));
            }
            pulp::Arch::new().dispatch(Ask::<T> {
                exam,
                asked,
                relevant: &relevant,
                recall: &recall,
                columns: &columns,
                watch,
                shortlists: &mut shortlists,
                tally: &mut tally,
                term: PhantomData,
            })?;
            Ok((tally, shortlists))
        })
        .map(|part| part.map(|(tally, _)| tally))
        .try_reduce(nothing, |mut a, b| {
            a.wrong.iter_mut().zip(b.wrong).for_each(|(a, b)| *a += b);
            a.recall.iter_mut().zip(b.recall).for_each(|(a, b)| *a += b);
            Ok(a)
        })?;
    Ok(Sweep {
        error: tally.wrong.iter().map(|&wrong| super::ranking::share(wrong as usize, exam.len())).collect(),
        adr: tally.recall.iter().map(|&sum| recall.mean(sum)).collect(),
    })
}

/// Adds the figures of some asked models to the tally.
struct Ask<'a, T> {
    exam: Exam<'a>,
    asked: Range<usize>,
    relevant: &'a [usize],
    recall: &'a Recall,
    columns: &'a Columns,
    watch: &'a dyn Watch,
    shortlists: &'a mut [Shortlist],
    tally: &'a mut Tally,
    term: PhantomData<T>,
}

impl<T: Term> pulp::WithSimd for Ask<'_, T> {
    type Output = Result<(), Cancelled>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { exam, asked, relevant, recall, columns, watch, shortlists, tally, .. } = self;
        let labels = exam.labels();
        for k in 0..columns.len() {
            if k % POLL == 0 && watch.cancelled() {
                return Err(Cancelled);
            }
            let (others, _) = S::as_simd_f64s(columns.col(k));
            for (asked, shortlist) in asked.clone().zip(&mut *shortlists) {
                let value = simd.splat_f64s(exam.row(asked)[k]);
                let (sums, _) = S::as_mut_simd_f64s(&mut shortlist.sums);
                for (sum, &other) in sums.iter_mut().zip(others) {
                    *sum = simd.add_f64s(*sum, T::terms(simd, value, other));
                }
                let (label, weights) = (exam.label(asked), recall.weights(relevant[asked]));
                let (mut wrong, mut gained) = (1, 0);
                shortlist.find(
                    simd,
                    #[inline(always)]
                    |model| labels[model as usize] == label,
                    #[inline(always)]
                    |rank| {
                        wrong &= u32::from(rank > 0);
                        gained += weights.get(rank).copied().unwrap_or(0);
                    },
                );
                tally.wrong[k] += wrong;
                tally.recall[k] += gained;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::{Sweep, sweep};
    use crate::{
        metrics::{
            Cancelled, Distance, Exam, Sample, figures,
            samples::{nobody, only_queries, sample, samples},
        },
        watch::{Unwanted, Unwatched},
    };

    fn exams(sample: &Sample) -> [Exam<'_>; 2] {
        [Exam::leave_one_out(sample), Exam::queries(sample)]
    }

    #[test]
    fn every_k_equals_the_selection_of_the_first_k() {
        for sample in samples() {
            for (exam, distance) in exams(&sample).into_iter().flat_map(|exam| Distance::ALL.map(|d| (exam, d))) {
                let curves = sweep(exam, distance, &Unwatched).unwrap();
                for k in 1..=sample.train.cols() {
                    let first: Vec<u32> = (1..=k as u32).collect();
                    assert_eq!((curves.error[k - 1], curves.adr[k - 1]), figures(exam, distance, &first));
                }
            }
        }
    }

    #[test]
    fn a_prefix_of_the_features_gives_a_prefix_of_the_curves() {
        let sample = sample(3, 8, 40, 0);
        let narrow = sample.prefix(17);
        for distance in Distance::ALL {
            for (wide, narrow) in exams(&sample).into_iter().zip(exams(&narrow)) {
                let wide = sweep(wide, distance, &Unwatched).unwrap();
                let narrow = sweep(narrow, distance, &Unwatched).unwrap();
                assert_eq!((&wide.error[..17], &wide.adr[..17]), (&narrow.error[..], &narrow.adr[..]));
            }
        }
    }

    #[test]
    fn threads_do_not_matter() {
        let sample = sample(4, 9, 30, 0);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| sweep(Exam::leave_one_out(&sample), Distance::L2, &Unwatched).unwrap())
        };
        assert_eq!(run(1), run(5));
    }

    #[test]
    fn without_models_there_is_nothing_to_say() {
        assert_eq!(sweep(Exam::leave_one_out(&nobody()), Distance::L2, &Unwatched), Ok(Sweep::default()));
        assert_eq!(sweep(Exam::queries(&only_queries()), Distance::L2, &Unwatched), Ok(Sweep::default()));
    }

    #[test]
    fn stops_when_cancelled() {
        let sample = sample(5, 5, 5, 0);
        assert_eq!(sweep(Exam::leave_one_out(&sample), Distance::L2, &Unwanted), Err(Cancelled));
    }
}

//! ε and mean ADR of the first k features, for every k in one pass.

use std::marker::PhantomData;

use pulp::Simd;
use rayon::prelude::*;

use super::{
    Cancelled, Distance, Exam, Recall, Term, by_distance,
    columns::Panels,
    ranking,
    shortlist::{List, SPAN, Shortlist},
};
use crate::watch::Watch;

/// ε and mean ADR for every k = 1…kmax; entry k − 1 belongs to k.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Sweep {
    /// Classification error.
    pub error: Vec<f64>,
    /// Mean ADR.
    pub adr: Vec<f64>,
}

/// Models asked side by side: features are then read from afar for all of them at once.
const GROUP: usize = 8;

/// How often models asked found a relevant one, for every k. In whatever order threads add them, they are the same.
#[derive(Clone)]
struct Tally {
    /// By number Q of relevant models, as far as it occurs; then by k; then by rank, from 0. The last of the Q + 1
    /// ranks stands for all beyond.
    found: Vec<Vec<u32>>,
}

impl Tally {
    fn new(relevant: &[usize], cols: usize) -> Self {
        let mut found = vec![Vec::new(); relevant.iter().max().map_or(0, |most| most + 1)];
        for &count in relevant {
            found[count].resize(cols * (count + 1), 0);
        }
        Self { found }
    }

    fn add(mut self, other: &Self) -> Self {
        for (a, b) in self.found.iter_mut().zip(&other.found) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        self
    }

    /// How many found a relevant model first, and the sum of the recall, with the features up to `col`, from 0.
    fn at(&self, col: usize, recall: &Recall) -> (usize, u128) {
        let (mut right, mut sum) = (0, 0);
        for (relevant, found) in self.found.iter().enumerate().skip(1).filter(|(_, found)| !found.is_empty()) {
            let found = &found[col * (relevant + 1)..];
            right += found[0] as usize;
            let weights = recall.weights(relevant).iter();
            sum += weights.zip(found).map(|(weight, &count)| weight * u128::from(count)).sum::<u128>();
        }
        (right, sum)
    }
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
    let (rows, cols, panels) = (exam.models().rows(), exam.models().cols(), Panels::new(exam.models()));
    let (relevant, recall) = (exam.relevant(), exam.recall());
    let start = || (Tally::new(&relevant, cols), vec![Shortlist::new(rows); GROUP], List::new(rows));
    let nothing = || Tally::new(&relevant, cols);
    let tally = (0..exam.len().div_ceil(GROUP))
        .into_par_iter()
        .try_fold(start, |(mut tally, mut shortlists, mut list), group| {
            if watch.cancelled() {
                return Err(Cancelled);
            }
            // Who has nothing to find is never right.
            let asked = (group * GROUP..exam.len().min((group + 1) * GROUP)).filter(|&asked| relevant[asked] > 0);
            let asked: Vec<usize> = asked.collect();
            for (&asked, shortlist) in asked.iter().zip(&mut shortlists) {
                shortlist.begin(exam.left_out(asked), relevant[asked]);
            }
            pulp::Arch::new().dispatch(Ask::<T> {
                exam,
                asked: &asked,
                relevant: &relevant,
                panels: &panels,
                shortlists: &mut shortlists,
                list: &mut list,
                tally: &mut tally,
                term: PhantomData,
            });
            Ok((tally, shortlists, list))
        })
        .map(|part| part.map(|(tally, ..)| tally))
        .try_reduce(nothing, |a, b| Ok(a.add(&b)))?;
    let (right, sums): (Vec<_>, Vec<_>) = (0..cols).map(|col| tally.at(col, &recall)).unzip();
    Ok(Sweep {
        error: right.into_iter().map(|right| ranking::share(exam.len() - right, exam.len())).collect(),
        adr: sums.into_iter().map(|sum| recall.mean(sum)).collect(),
    })
}

/// Adds what some models asked find to the tally.
struct Ask<'a, T> {
    exam: Exam<'a>,
    asked: &'a [usize],
    relevant: &'a [usize],
    panels: &'a Panels,
    shortlists: &'a mut [Shortlist],
    list: &'a mut List,
    tally: &'a mut Tally,
    term: PhantomData<T>,
}

impl<T: Term> pulp::WithSimd for Ask<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { exam, asked, relevant, panels, shortlists, list, tally, .. } = self;
        let labels = exam.labels();
        for first in (0..exam.models().cols()).step_by(SPAN) {
            for (&asked, shortlist) in asked.iter().zip(&mut *shortlists) {
                shortlist.list::<S, T>(simd, first, exam.row(asked), panels, list);
                let (label, relevant) = (exam.label(asked), relevant[asked]);
                for (at, &model) in list.models().iter().enumerate() {
                    if labels[model as usize] == label {
                        let before = list.before(simd, at);
                        let counts = tally.found[relevant][first * (relevant + 1)..].chunks_exact_mut(relevant + 1);
                        for (counts, &rank) in counts.zip(&before) {
                            counts[relevant.min(rank as usize)] += 1;
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Sweep, sweep};
    use crate::{
        metrics::{
            Cancelled, Distance, Exam, Features, Sample, figures,
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
    fn many_models_and_features_equal_the_selection_of_the_first_k() {
        // Several panels of models and spans of features, with many equal distances and with none, in order of class
        // and out of it; a class of one; sums that become infinite.
        for (levels, huge) in [(0, false), (3, false), (0, true)] {
            let mut sample = sample(6, 9, 29, levels);
            let order: Vec<usize> = (0..sample.train.rows()).map(|row| row * 7 % sample.train.rows()).collect();
            sample.train_labels = order.iter().map(|&row| sample.train_labels[row]).collect();
            sample.train = Features::from_rows(order.iter().map(|&row| {
                let mut features = sample.train.row(row).to_vec();
                features[20] *= if huge && row % 3 == 0 { 1e200 } else { 1.0 };
                features
            }));
            for (exam, distance) in exams(&sample).into_iter().flat_map(|exam| Distance::ALL.map(|d| (exam, d))) {
                let curves = sweep(exam, distance, &Unwatched).unwrap();
                for k in 1..=29 {
                    let first: Vec<u32> = (1..=k as u32).collect();
                    let found = (curves.error[k - 1], curves.adr[k - 1]);
                    assert_eq!(found, figures(exam, distance, &first), "{distance:?} {k} {levels} {huge}");
                }
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

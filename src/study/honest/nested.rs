//! Asking every method for every fold.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::{
    Honest, HonestPair, HonestRow, Learner, Plan,
    deal::{Fold, Parts, Tally},
    learner::Verdict,
    test::{mcnemar, paired},
};
use crate::{
    metrics::{Cancelled, Distance, Exam, Sample, Scale},
    watch::Watch,
};

/// Examines every method by the paper's protocol and by nested cross-validation over all models, and every pair of
/// methods against each other.
///
/// `sample` is not scaled: a scale is learnt where everything else is learnt, inside the fold.
///
/// With more folds than models, some folds are empty. The watch is told how many of the (repeats × folds × methods)
/// parts are done.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn honest(
    sample: &Sample,
    scale: Scale,
    distance: Distance,
    methods: &[Learner],
    plan: Plan,
    watch: &dyn Watch,
) -> Result<Honest, Cancelled> {
    let scaled = scale.apply(sample);
    let queries = Exam::queries(&scaled);
    let paper = |&method: &Learner| {
        let exams = [Exam::leave_one_out(&scaled), queries];
        method.learn(&scaled, distance, &exams, watch)
    };
    let paper: Vec<Vec<Verdict>> = methods.par_iter().map(paper).collect::<Result<_, _>>()?;
    let tallies = nested(sample, scale, distance, methods, plan, watch)?;
    let row = |(at, &method): (usize, &Learner)| {
        let tally = &tallies[at];
        HonestRow {
            method,
            apparent: share(&paper[at][0].wrong),
            query: (!queries.is_empty()).then(|| share(&paper[at][1].wrong)),
            error: tally.error(plan),
            adr: tally.adr(plan),
            repeats: tally.repeats.clone(),
            wrong: tally.wrong.clone(),
            selected: tally.selected,
        }
    };
    let rows = methods.iter().enumerate().map(row).collect();
    let all = 0..methods.len();
    let pairs = all.clone().flat_map(|first| (first + 1..all.end).map(move |second| (first, second)));
    let pair = |(first, second): (usize, usize)| {
        let (difference, permutation) = paired(&tallies[first].wrong, &tallies[second].wrong, plan);
        let (a, b) = (&paper[first][1].wrong, &paper[second][1].wrong);
        let mcnemar = (!queries.is_empty()).then(|| mcnemar(a, b));
        HonestPair { first, second, difference, permutation, mcnemar }
    };
    Ok(Honest { plan, rows, pairs: pairs.map(pair).collect() })
}

fn share(wrong: &[bool]) -> f64 {
    if wrong.is_empty() { 1.0 } else { wrong.iter().filter(|&&wrong| wrong).count() as f64 / wrong.len() as f64 }
}

fn nested(
    sample: &Sample,
    scale: Scale,
    distance: Distance,
    methods: &[Learner],
    plan: Plan,
    watch: &dyn Watch,
) -> Result<Vec<Tally>, Cancelled> {
    let parts = Parts::new(sample, plan);
    let folds = parts.folds();
    let all: Vec<(Fold, usize)> =
        folds.into_iter().flat_map(|fold| (0..methods.len()).map(move |method| (fold, method))).collect();
    let done = AtomicUsize::new(0);
    let part = |&(fold, method): &(Fold, usize)| {
        if watch.cancelled() {
            return Err(Cancelled);
        }
        let split = scale.apply(&parts.split(fold));
        let verdict = methods[method].learn(&split, distance, &[Exam::queries(&split)], watch)?.pop();
        watch.progress(done.fetch_add(1, Ordering::Relaxed) + 1, all.len());
        Ok((fold, method, verdict))
    };
    let verdicts: Vec<_> = all.par_iter().map(part).collect::<Result<_, _>>()?;
    let mut tallies: Vec<Tally> = methods.iter().map(|_| Tally::new(parts.models(), plan)).collect();
    for (fold, method, verdict) in verdicts {
        let Some(Verdict { wrong, adr, selected }) = verdict else { continue };
        tallies[method].add(&parts, fold, &wrong, adr.as_deref(), selected);
    }
    Ok(tallies)
}

#[cfg(test)]
mod tests {
    use super::{Plan, honest};
    use crate::{
        metrics::{Cancelled, Chance, Distance, Exam, Features, Sample, Scale, figures, samples::sample},
        selection::{Cost, Search, climb},
        study::Learner,
        watch::{Unwanted, Unwatched},
    };

    const PLAN: Plan = Plan { folds: 3, repeats: 2, resamples: 200, seed: 5 };
    const METHODS: [Learner; 5] =
        [Learner::FirstK, Learner::HILL, Learner::BOOST, Learner::Hill(Cost::Adr, Search::Strict), Learner::Fixed(4)];

    #[test]
    fn the_paper_s_protocol_stands_beside_it() {
        let sample = sample(2, 7, 20, 0);
        let found = honest(&sample, Scale::None, Distance::L2, &METHODS, PLAN, &Unwatched).unwrap();
        let order = climb(&sample, Distance::L2, Cost::Error, &Unwatched).unwrap().order();
        assert_eq!(found.rows[1].apparent, figures(Exam::leave_one_out(&sample), Distance::L2, &order).0);
        assert_eq!(found.rows[1].query, Some(figures(Exam::queries(&sample), Distance::L2, &order).0));
        assert_eq!(found.pairs.len(), 10);
        for row in &found.rows {
            assert!(row.error.low <= row.error.mean && row.error.mean <= row.error.high);
            let mean = row.repeats.iter().sum::<f64>() / 2.0;
            assert!((mean - row.error.mean).abs() < 1e-12);
            assert_eq!(row.adr.is_none(), row.method == Learner::BOOST);
        }
    }

    /// With as many folds as models each is asked against all others: what selects nothing gets the leave-one-out
    /// figures of all models.
    #[test]
    fn one_model_in_each_fold_is_leave_one_out() {
        let part = sample(3, 5, 10, 0);
        let rows = (0..part.train.rows()).map(|row| part.train.row(row));
        let all = Sample {
            train: Features::from_rows(rows.chain((0..part.query.rows()).map(|row| part.query.row(row)))),
            train_labels: [part.train_labels.clone(), part.query_labels.clone()].concat(),
            query: Features::default(),
            query_labels: Vec::new(),
            classes: part.classes,
        };
        let plan = Plan { folds: all.train.rows(), repeats: 1, ..PLAN };
        let found = honest(&part, Scale::None, Distance::L1, &[Learner::Fixed(4)], plan, &Unwatched).unwrap();
        let (error, adr) = figures(Exam::leave_one_out(&all), Distance::L1, &[1, 2, 3, 4]);
        assert!((found.rows[0].error.mean - error).abs() < 1e-12);
        assert!((found.rows[0].adr.unwrap().mean - adr).abs() < 1e-12);
    }

    /// Labels that say nothing: what is selected on the models that score it looks better than it is, and nested
    /// cross-validation knows.
    #[test]
    fn selection_bias_shows() {
        let mut chance = Chance::new(7, 0);
        let mut row = || (0..60).map(|_| chance.below(1000) as f64).collect::<Vec<_>>();
        let labels: Vec<u32> = (0..60).map(|model| model % 2).collect();
        let sample = Sample {
            train: Features::from_rows((0..60).map(|_| row())),
            train_labels: labels,
            classes: 2,
            ..Sample::default()
        };
        let found = honest(&sample, Scale::None, Distance::L2, &[Learner::HILL], PLAN, &Unwatched).unwrap();
        assert!(found.rows[0].apparent < 0.3, "{}", found.rows[0].apparent);
        assert!(found.rows[0].error.mean > 0.35, "{}", found.rows[0].error.mean);
    }

    #[test]
    fn a_scale_is_learnt_inside_the_fold() {
        let sample = sample(6, 7, 12, 0);
        let of = |sample: &Sample, scale| {
            honest(sample, scale, Distance::L2, &[Learner::ALL], PLAN, &Unwatched).unwrap().rows.remove(0)
        };
        let (inside, before) = (of(&sample, Scale::Fisher), of(&Scale::Fisher.apply(&sample), Scale::None));
        assert_eq!((inside.apparent, inside.query), (before.apparent, before.query));
        assert_ne!(inside.adr, before.adr);
    }

    #[test]
    fn two_methods_that_are_one_do_not_differ() {
        let sample = sample(4, 6, 12, 0);
        let found =
            honest(&sample, Scale::None, Distance::L2, &[Learner::Fixed(3), Learner::Fixed(3)], PLAN, &Unwatched)
                .unwrap();
        let pair = found.pairs[0];
        assert_eq!((pair.difference.mean, pair.permutation, pair.mcnemar), (0.0, 1.0, Some(1.0)));
    }

    #[test]
    fn threads_do_not_matter() {
        let sample = sample(4, 9, 15, 0);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| honest(&sample, Scale::None, Distance::L2, &METHODS, PLAN, &Unwatched).unwrap())
        };
        assert_eq!(run(1), run(5));
    }

    #[test]
    fn stops_when_cancelled() {
        assert_eq!(honest(&sample(5, 5, 5, 0), Scale::None, Distance::L2, &METHODS, PLAN, &Unwanted), Err(Cancelled));
    }
}

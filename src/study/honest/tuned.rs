//! Nearest neighbours with everything that one would tune tuned inside the fold: features, weights, distance and k.
//!
//! A table of settings with the best of them marked is selection on what scores it once more. Here each setting's error
//! on models it has not seen stands in the table for every k, and the figure to go by is that of a method that picks
//! setting and k anew in each fold, by leave-one-out among the other folds.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Interval, Plan,
    deal::{Parts, Tally, interval},
    learner::nearest,
};
use crate::{
    metrics::{Cancelled, Distance, Exam, Sample, Scale},
    spectrum::Normalisation,
    study::first_k,
    watch::{Silent, Watch},
};

/// How models are compared, but for the number of eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Recipe {
    /// What is made of the eigenvalues.
    pub normalisation: Normalisation,
    /// How much each of them counts, learnt inside the fold.
    pub scale: Scale,
    /// Between two models.
    pub distance: Distance,
}

impl Recipe {
    /// Those that are tried, the simpler first: equally good ones go to the first.
    #[must_use]
    pub fn all() -> Vec<Self> {
        const PLAIN: [Distance; 3] = [Distance::L2, Distance::L1, Distance::Chi2];
        const WESD: [Distance; 2] = [Distance::Wesd15, Distance::Wesd2];
        let of = |normalisation, scale, distance| Self { normalisation, scale, distance };
        let mut all: Vec<Self> = Vec::new();
        for normalisation in Normalisation::ALL {
            all.extend(PLAIN.map(|distance| of(normalisation, Scale::None, distance)));
        }
        // A distance made for eigenvalues themselves.
        for normalisation in [Normalisation::None, Normalisation::Area, Normalisation::Max] {
            all.extend(WESD.map(|distance| of(normalisation, Scale::None, distance)));
        }
        // Scaled, λ·area and λ·area/(4πk) are the same.
        for normalisation in [Normalisation::Area, Normalisation::Max, Normalisation::Log] {
            for scale in [Scale::Standard, Scale::Within, Scale::Fisher] {
                all.extend([Distance::L2, Distance::L1].map(|distance| of(normalisation, scale, distance)));
            }
        }
        all
    }
}

/// What nested cross-validation says of one recipe.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TunedRow {
    /// Which.
    pub recipe: Recipe,
    /// ε on models not seen, with k chosen inside the fold.
    pub error: Interval,
    /// ε on models not seen with the first k eigenvalues, for every k: nothing is selected. Entry k − 1 belongs to k.
    pub curve: Vec<f64>,
    /// The median of the k that were chosen.
    pub k: usize,
    /// In how many folds of all repeats it was the best of all recipes.
    pub taken: usize,
}

/// Nearest neighbours, tuned.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Tuned {
    /// How models were dealt and drawn.
    pub plan: Plan,
    /// ε on models not seen, with recipe and k chosen inside the fold.
    pub error: Interval,
    /// Mean ADR of the same.
    pub adr: Interval,
    /// ε of each repeat.
    pub repeats: Vec<f64>,
    /// How often each model was given a wrong class.
    pub wrong: Vec<u32>,
    /// The least k chosen, the median and the greatest.
    pub k: [usize; 3],
    /// A row for each recipe, in the order asked for.
    pub rows: Vec<TunedRow>,
}

/// One recipe in one fold.
struct Try {
    /// ε by leave-one-out among the other folds, at the best k.
    inner: f64,
    k: usize,
    /// ε on the fold for every k.
    outer: Vec<f64>,
    wrong: Vec<bool>,
    adr: Vec<Option<f64>>,
}

/// Tries every recipe in every fold of every repeat, each time learnt and tuned without the fold.
///
/// `samples` has for each normalisation of the recipes the features of the same models, not scaled. None without models
/// or recipes. The watch is only asked whether to go on: parts are too small to count.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn tuned(
    samples: &[(Normalisation, &Sample)],
    recipes: &[Recipe],
    plan: Plan,
    watch: &dyn Watch,
) -> Result<Option<Tuned>, Cancelled> {
    let of = |recipe: &Recipe| samples.iter().find(|(known, _)| *known == recipe.normalisation);
    let known: Vec<(Recipe, Parts<'_>)> =
        recipes.iter().filter_map(|recipe| Some((*recipe, Parts::new(of(recipe)?.1, plan)))).collect();
    let Some((_, parts)) = known.first() else { return Ok(None) };
    let (models, folds) = (parts.models(), parts.folds());
    if models == 0 {
        return Ok(None);
    }
    let places: Vec<(usize, usize)> =
        (0..folds.len()).flat_map(|fold| (0..known.len()).map(move |recipe| (fold, recipe))).collect();
    let attempt = |&(fold, recipe): &(usize, usize)| {
        let (Recipe { scale, distance, .. }, ref parts) = known[recipe];
        let split = scale.apply(&parts.split(folds[fold]));
        let curves = first_k(&split, distance, &Silent(watch))?;
        let k = curves.best_error;
        let first: Vec<u32> = (1..=k as u32).collect();
        let verdict = nearest(&split, distance, Exam::queries(&split), &first);
        Ok(Try {
            inner: curves.error.at(k).map_or(1.0, |score| score.train),
            k,
            outer: curves.error.query,
            wrong: verdict.wrong,
            adr: verdict.adr.unwrap_or_default(),
        })
    };
    let tries: Vec<Try> = places.par_iter().map(attempt).collect::<Result<_, _>>()?;
    let tried = |fold: usize, recipe: usize| &tries[fold * known.len() + recipe];
    let first_least = |fold: usize| {
        (0..known.len()).min_by(|&a, &b| tried(fold, a).inner.total_cmp(&tried(fold, b).inner)).unwrap_or(0)
    };
    let chosen: Vec<usize> = (0..folds.len()).map(first_least).collect();

    let tally = |recipe: &dyn Fn(usize) -> usize| {
        let mut tally = Tally::new(models, plan);
        for (at, &fold) in folds.iter().enumerate() {
            let found = tried(at, recipe(at));
            tally.add(parts, fold, &found.wrong, Some(&found.adr), found.k as f64);
        }
        tally
    };
    let row = |(at, &(recipe, _)): (usize, &(Recipe, Parts<'_>))| {
        let width = (0..folds.len()).map(|fold| tried(fold, at).outer.len()).max().unwrap_or(0);
        let mut curve = vec![0.0; width];
        for (nth, &fold) in folds.iter().enumerate() {
            let share = parts.asked(fold).count() as f64 / (models * plan.repeats) as f64;
            curve.iter_mut().zip(&tried(nth, at).outer).for_each(|(sum, error)| *sum += share * error);
        }
        TunedRow {
            recipe,
            error: tally(&|_| at).error(plan),
            curve,
            k: spread((0..folds.len()).map(|fold| tried(fold, at).k).collect())[1],
            taken: chosen.iter().filter(|&&chosen| chosen == at).count(),
        }
    };
    let best = tally(&|fold| chosen[fold]);
    Ok(Some(Tuned {
        plan,
        error: best.error(plan),
        adr: best.adr(plan).unwrap_or(interval(&[], plan, 0.0)),
        k: spread(chosen.iter().enumerate().map(|(fold, &recipe)| tried(fold, recipe).k).collect()),
        rows: known.iter().enumerate().map(row).collect(),
        repeats: best.repeats,
        wrong: best.wrong,
    }))
}

/// The least, the median (of an even number the lower) and the greatest.
fn spread(mut values: Vec<usize>) -> [usize; 3] {
    values.sort_unstable();
    [0, values.len().saturating_sub(1) / 2, values.len().saturating_sub(1)]
        .map(|at| values.get(at).copied().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::{Recipe, spread, tuned};
    use crate::{
        metrics::{Cancelled, Chance, Distance, Features, Sample, Scale, samples::sample},
        spectrum::Normalisation,
        study::{Learner, Plan, honest},
        watch::{Unwanted, Unwatched},
    };

    const PLAN: Plan = Plan { folds: 3, repeats: 2, resamples: 200, seed: 5 };
    const L2: Recipe = Recipe { normalisation: Normalisation::Max, scale: Scale::None, distance: Distance::L2 };

    #[test]
    fn one_recipe_is_first_k_in_nested_cross_validation() {
        let sample = sample(2, 7, 20, 0);
        for recipe in [L2, Recipe { scale: Scale::Fisher, distance: Distance::L1, ..L2 }] {
            let tuned = tuned(&[(L2.normalisation, &sample)], &[recipe], PLAN, &Unwatched).unwrap().unwrap();
            let methods = [Learner::FirstK, Learner::Fixed(4), Learner::ALL];
            let honest = honest(&sample, recipe.scale, recipe.distance, &methods, PLAN, &Unwatched).unwrap();
            assert_eq!((tuned.error, Some(tuned.adr)), (honest.rows[0].error, honest.rows[0].adr));
            assert_eq!((tuned.repeats, tuned.rows[0].error), (honest.rows[0].repeats.clone(), tuned.error));
            assert_eq!((tuned.rows[0].taken, tuned.rows[0].curve.len()), (6, 20));
            for (k, row) in [(4, 1), (20, 2)] {
                assert!((tuned.rows[0].curve[k - 1] - honest.rows[row].error.mean).abs() < 1e-12);
            }
        }
    }

    /// Two samples of the same models, one of which says nothing of the classes: the other is chosen.
    #[test]
    fn what_tells_classes_apart_is_chosen() {
        let good = sample(4, 9, 15, 0);
        let mut chance = Chance::new(3, 0);
        let mut noise = |rows: usize| {
            Features::from_rows((0..rows).map(|_| (0..15).map(|_| chance.below(997) as f64).collect::<Vec<_>>()))
        };
        let bad = Sample { train: noise(good.train.rows()), query: noise(good.query.rows()), ..good.clone() };
        let samples = [(Normalisation::None, &bad), (Normalisation::Max, &good)];
        let recipes = [Recipe { normalisation: Normalisation::None, ..L2 }, L2];
        let tuned = tuned(&samples, &recipes, PLAN, &Unwatched).unwrap().unwrap();
        assert_eq!((tuned.rows[0].taken, tuned.rows[1].taken), (0, 6));
        assert_eq!(tuned.error, tuned.rows[1].error);
        assert!(tuned.rows[0].error.mean > 2.0 * tuned.error.mean);
    }

    #[test]
    fn recipes_are_tried_once_each() {
        let all = Recipe::all();
        for (at, recipe) in all.iter().enumerate() {
            assert!(!all[..at].contains(recipe), "{recipe:?}");
        }
        assert_eq!(all[0], Recipe { normalisation: Normalisation::None, ..L2 });
    }

    #[test]
    fn spreads_by_hand() {
        assert_eq!((spread(vec![5, 1, 9]), spread(vec![4, 2, 8, 6]), spread(vec![])), ([1, 5, 9], [2, 4, 8], [0; 3]));
    }

    #[test]
    fn stops_when_cancelled_and_is_nothing_of_nobody() {
        let sample = sample(5, 5, 5, 0);
        assert_eq!(tuned(&[(L2.normalisation, &sample)], &[L2], PLAN, &Unwanted), Err(Cancelled));
        assert_eq!(tuned(&[], &[L2], PLAN, &Unwatched), Ok(None));
        let nobody = Sample::default();
        assert_eq!(tuned(&[(L2.normalisation, &nobody)], &[L2], PLAN, &Unwatched), Ok(None));
    }
}

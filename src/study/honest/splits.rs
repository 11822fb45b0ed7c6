//! What the paper's figures would be on other splits of the same models.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    deal::pooled,
    learner::{Boosting, strong},
};
use crate::{
    metrics::{Cancelled, Chance, Distance, Exam, Features, Sample, figures},
    selection::{Cost, Ranges, Search, Stop, Weak, climb_by, decide},
    study::{boosted, first_k},
    watch::{Silent, Watch},
};

/// Splits that are drawn, and what they depend on.
pub const SPLITS: usize = 24;
const SEED: u64 = 7;
/// A stream of chance for each split, away from those of other uses.
const STREAM: u64 = 1000;

/// The least, the mean and the greatest of a figure over splits.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Spread {
    /// The least.
    pub low: f64,
    /// The mean.
    pub mean: f64,
    /// The greatest.
    pub high: f64,
}

/// The figures on D of Tables 1 to 4 over random splits, and by other readings of the paper.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Splits {
    /// Least ε of the first k.
    pub first_k_error: Spread,
    /// ε of hill climbing for ε.
    pub climb_error: Spread,
    /// ε of AdaBoost.
    pub boosted: Spread,
    /// Greatest mean ADR of the first k.
    pub first_k_adr: Spread,
    /// Mean ADR of hill climbing for it.
    pub climb_adr: Spread,
    /// AdaBoost's other decisions, on D as it is.
    pub decisions: Decisions,
    /// Hill climbing by each of [`Search::ALL`], on D as it is.
    pub searches: Vec<Searched>,
}

/// Hill climbing by certain moves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Searched {
    /// Which moves.
    pub search: Search,
    /// ε on D of the climb for ε.
    pub error: f64,
    /// Mean ADR on D of the climb for it.
    pub adr: f64,
}

/// ε on D of AdaBoost when its classifiers decide in other ways than by the greatest p(C|M).
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Decisions {
    /// By the greatest S as a share of its Σ α, so that classes with more rounds do not count for more.
    pub share: f64,
    /// By the first class, in the data set's order, whose S is positive: yes or no, class after class.
    pub first: f64,
}

/// Draws D anew [`SPLITS`] times, of all models of D and Q as many of each class as D has, and computes the figures on
/// it: hill climbing by the moves of `search`, AdaBoost with so many rounds at most, of such classifiers and to such an
/// end.
///
/// Without query models every D is the same one.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn splits(
    sample: &Sample,
    distance: Distance,
    search: Search,
    boosting: (usize, Weak, Stop),
    watch: &dyn Watch,
) -> Result<Splits, Cancelled> {
    let draw = |nth: usize| {
        let drawn = drawn(sample, Chance::new(SEED, STREAM + nth as u64));
        let curves = first_k(&drawn, distance, &Silent(watch))?;
        let climbed = |cost: Cost| {
            let climb = climb_by(&drawn, distance, cost, search, &Silent(watch))?;
            Ok(figures(Exam::leave_one_out(&drawn), distance, &climb.order()))
        };
        let error = curves.error.at(curves.best_error).map_or(1.0, |score| score.train);
        let adr = curves.adr.at(curves.best_adr).map_or(0.0, |score| score.train);
        let boosted = boosted(&drawn, &strong(&drawn, boosting, &Silent(watch))?).error.train;
        Ok([error, climbed(Cost::Error)?.0, boosted, adr, climbed(Cost::Adr)?.1])
    };
    let found: Vec<[f64; 5]> = (0..SPLITS).into_par_iter().map(draw).collect::<Result<_, _>>()?;
    let searched = |search: Search| searched(sample, distance, search, watch);
    let searches = Search::ALL.into_par_iter().map(searched).collect::<Result<_, _>>()?;
    let spread = |at: usize| {
        let values = || found.iter().map(|figures| figures[at]);
        Spread {
            low: values().fold(f64::INFINITY, f64::min),
            mean: values().sum::<f64>() / SPLITS as f64,
            high: values().fold(f64::NEG_INFINITY, f64::max),
        }
    };
    Ok(Splits {
        first_k_error: spread(0),
        climb_error: spread(1),
        boosted: spread(2),
        first_k_adr: spread(3),
        climb_adr: spread(4),
        decisions: decisions(sample, boosting, watch)?,
        searches,
    })
}

fn searched(sample: &Sample, distance: Distance, search: Search, watch: &dyn Watch) -> Result<Searched, Cancelled> {
    let climbed = |cost: Cost| {
        let climb = climb_by(sample, distance, cost, search, &Silent(watch))?;
        Ok(figures(Exam::leave_one_out(sample), distance, &climb.order()))
    };
    Ok(Searched { search, error: climbed(Cost::Error)?.0, adr: climbed(Cost::Adr)?.1 })
}

fn decisions(sample: &Sample, boosting: Boosting, watch: &dyn Watch) -> Result<Decisions, Cancelled> {
    let (classes, ranges) = (strong(sample, boosting, &Silent(watch))?, Ranges::new(sample));
    let sums: Vec<f64> = classes.iter().map(|strong| strong.rounds.iter().map(|round| round.alpha).sum()).collect();
    let (mut share, mut first) = (0, 0);
    for (row, &label) in sample.train_labels.iter().enumerate() {
        let score =
            |class: usize| ranges.known(class).then(|| classes[class].score(class, &ranges, sample.train.row(row)));
        let scores: Vec<Option<f64>> = (0..sample.classes).map(score).collect();
        let shares: Vec<Option<f64>> = scores
            .iter()
            .zip(&sums)
            .map(|(score, sum)| score.map(|score| score / sum.max(f64::MIN_POSITIVE)))
            .collect();
        share += usize::from(decide(&shares) != Some(label));
        let positive = scores.iter().position(|score| score.is_some_and(|score| score > 0.0));
        first += usize::from(positive != Some(label as usize));
    }
    let asked = sample.train_labels.len().max(1) as f64;
    Ok(Decisions { share: share as f64 / asked, first: first as f64 / asked })
}

/// Training models drawn from all, as many of each class as there were; nobody is asked.
fn drawn(sample: &Sample, mut chance: Chance) -> Sample {
    let models = pooled(sample);
    let mut taken = Vec::new();
    for (class, size) in (0_u32..).zip(sample.class_sizes()) {
        let mut members: Vec<usize> = (0..models.len()).filter(|&model| models[model].1 == class).collect();
        chance.shuffle(&mut members);
        taken.extend_from_slice(&members[..size.min(members.len())]);
    }
    // In the order of the models, by which ties are settled.
    taken.sort_unstable();
    Sample {
        train: Features::from_rows(taken.iter().map(|&model| models[model].0)),
        train_labels: taken.iter().map(|&model| models[model].1).collect(),
        query: Features::default(),
        query_labels: Vec::new(),
        classes: sample.classes,
    }
}

#[cfg(test)]
mod tests {
    use super::{boosted, drawn, splits, strong};
    use crate::{
        metrics::{Cancelled, Chance, Distance, Features, Sample, samples::sample},
        selection::{Search, Stop, Weak},
        study::first_k,
        watch::{Unwanted, Unwatched},
    };

    const BOOSTING: (usize, Weak, Stop) = (5, Weak::Range, Stop::Fixed);

    #[test]
    fn a_split_has_as_many_of_each_class_and_differs_from_the_next() {
        let sample = sample(2, 7, 6, 0);
        let of = |stream| drawn(&sample, Chance::new(1, stream));
        assert_eq!(of(1).class_sizes(), sample.class_sizes());
        assert_eq!(of(1), of(1));
        assert_ne!(of(1).train, of(2).train);
    }

    #[test]
    fn without_queries_every_split_is_the_same() {
        let all = sample(3, 7, 8, 0);
        let alone = Sample { query: Features::default(), query_labels: Vec::new(), ..all.clone() };
        let same = splits(&alone, Distance::L2, Search::Strict, BOOSTING, &Unwatched).unwrap();
        let curves = first_k(&alone, Distance::L2, &Unwatched).unwrap();
        let error = curves.error.at(curves.best_error).unwrap().train;
        assert_eq!((same.first_k_error.low, same.first_k_error.high), (error, error));
        assert_eq!(same.climb_adr.low, same.climb_adr.high);
        // Every model lies in the ranges of its own class, so no share is greater than that of the right one.
        assert!(same.decisions.share <= same.decisions.first && same.decisions.first <= 1.0);
        assert_eq!(same.searches[0].error, same.climb_error.low);
        let spread = splits(&all, Distance::L2, Search::Strict, BOOSTING, &Unwatched).unwrap().first_k_adr;
        assert!(spread.low < spread.mean && spread.mean < spread.high, "{spread:?}");
        assert_eq!(splits(&all, Distance::L2, Search::Strict, BOOSTING, &Unwanted), Err(Cancelled));
    }

    #[test]
    fn splits_are_computed_as_the_table_that_they_stand_in() {
        let all = sample(3, 7, 8, 0);
        let alone = Sample { query: Features::default(), query_labels: Vec::new(), ..all };
        for search in Search::ALL {
            let found = splits(&alone, Distance::L1, search, BOOSTING, &Unwatched).unwrap();
            let own = found.searches.iter().find(|searched| searched.search == search).unwrap();
            assert_eq!((found.climb_error.low, found.climb_adr.high), (own.error, own.adr));
        }
        for boosting in [(5, Weak::Threshold, Stop::Fixed), (5, Weak::Interval, Stop::Early)] {
            let found = splits(&alone, Distance::L1, Search::Strict, boosting, &Unwatched).unwrap();
            let classes = strong(&alone, boosting, &Unwatched).unwrap();
            assert_eq!(found.boosted.low, boosted(&alone, &classes).error.train);
        }
    }
}

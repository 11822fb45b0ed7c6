//! AdaBoost, one strong classifier for each class against the rest (paper section 3.3).
//!
//! A weak classifier never errs on the positives, whose range it is. Its weighted error ε_t is therefore the weight of
//! the negatives within that range, and which ones those are does not change over the rounds.

pub use self::general::{Stop, boost_by, held_out, stop_at};

use rayon::prelude::*;

use super::{
    ranges::Ranges,
    strong::{Round, Strong},
};
use crate::{
    metrics::{Cancelled, Sample},
    watch::Watch,
};

mod general;

/// Lower bound of ε in α = ½ ln((1 − ε)/ε), which is infinite for a weak classifier that makes no error. With
/// it α is at most 11.5.
pub const LEAST_ERROR: f64 = 1e-10;

/// Weighted errors within this of one another are equal. The weights sum to 1 and are rounded to 1e-16 each round, so
/// that errors that are equal in exact arithmetic may differ a little; those that are not equal differ by much more.
pub const TIE: f64 = 1e-12;

/// Negatives whose weights are summed by one look-up: as many as a byte has bits.
const BITS: usize = 8;

/// Runs `rounds` rounds for every class.
///
/// Each round takes the weak classifier with the least weighted error, of several (to within [`TIE`]) the one with the
/// lowest index. A class stops early when the least error is ½: nothing better than chance is left. A class without
/// training models has no rounds. Once a weak classifier makes no error, the weights change no more and every further
/// round takes it again.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn boost(sample: &Sample, rounds: usize, watch: &dyn Watch) -> Result<Vec<Strong>, Cancelled> {
    let ranges = Ranges::new(sample);
    (0..sample.classes).into_par_iter().map(|class| boost_class(sample, &ranges, class, rounds, watch)).collect()
}

fn boost_class(
    sample: &Sample,
    ranges: &Ranges,
    class: usize,
    rounds: usize,
    watch: &dyn Watch,
) -> Result<Strong, Cancelled> {
    if !ranges.known(class) {
        return Ok(Strong::default());
    }
    run(Negatives::new(sample, ranges, class), rounds, watch)
}

/// The weak classifiers of one class, and the weights of the models.
trait Weighted {
    /// The round that takes the weak classifier with the least weighted error, or none when that is ½.
    fn best(&self) -> Option<Round>;

    /// Gives weight to what the round got wrong: w ← w·exp(−α·h·y)/Z. False when it got nothing wrong, which leaves
    /// the weights as they were.
    fn update(&mut self, round: &Round) -> bool;
}

/// Runs the rounds of one class.
fn run(mut weighted: impl Weighted, rounds: usize, watch: &dyn Watch) -> Result<Strong, Cancelled> {
    let mut strong = Strong::default();
    while strong.rounds.len() < rounds {
        if watch.cancelled() {
            return Err(Cancelled);
        }
        let Some(round) = weighted.best() else { break };
        if weighted.update(&round) {
            strong.rounds.push(round);
        } else {
            // Nothing changes any more.
            let left = rounds - strong.rounds.len();
            strong.rounds.extend(std::iter::repeat_n(round, left));
        }
    }
    Ok(strong)
}

/// The round that takes the least of these errors, or none when that is ½.
///
/// An error takes the lead only when it is lower by more than [`TIE`], so that the choice among the first columns is
/// the choice among all of them if that lies there.
fn best(errors: &[f64]) -> Option<Round> {
    let mut lead = 0;
    for (col, &error) in errors.iter().enumerate() {
        if error < errors[lead] - TIE {
            lead = col;
        }
    }
    let error = *errors.get(lead)?;
    let ties = (lead..errors.len()).filter(|&col| (errors[col] - error).abs() <= TIE);
    let alpha = 0.5 * ((1.0 - error.max(LEAST_ERROR)) / error.max(LEAST_ERROR)).ln();
    let ties = ties.map(|col| col as u32 + 1).collect();
    let round = Round { index: lead as u32 + 1, error, alpha, ties, test: None };
    (error < 0.5 - TIE).then_some(round)
}

/// The models outside of a class: their weights, and where they are taken for members.
struct Negatives {
    /// How many features there are.
    cols: usize,
    /// Sum of the positives' weights. They are always classified rightly, hence always of equal weight.
    positive: f64,
    /// Weights of the negatives, padded with zeros to a multiple of [`BITS`].
    weights: Vec<f64>,
    /// For every group of [`BITS`] negatives and every feature, a bit for each that lies within the positives' range.
    within: Vec<u8>,
}

impl Negatives {
    fn new(sample: &Sample, ranges: &Ranges, class: usize) -> Self {
        let others: Vec<usize> =
            (0..sample.train.rows()).filter(|&model| sample.train_labels[model] as usize != class).collect();
        let cols = sample.train.cols();
        let groups = others.len().div_ceil(BITS);
        let mut within = vec![0; groups * cols];
        let (low, high) = ranges.class(class);
        for (at, &model) in others.iter().enumerate() {
            let (group, bit) = (at / BITS, at % BITS);
            let bits = &mut within[group * cols..(group + 1) * cols];
            let values = sample.train.row(model);
            pulp::Arch::new().dispatch(|| {
                for (((bits, value), low), high) in bits.iter_mut().zip(values).zip(low).zip(high) {
                    *bits |= u8::from((low..=high).contains(&value)) << bit;
                }
            });
        }
        let mut weights = vec![0.0; groups * BITS];
        weights[..others.len()].fill(0.5 / others.len() as f64);
        Self { cols, positive: 0.5, weights, within }
    }

    /// The weighted error of every feature's weak classifier. Without negatives none errs.
    fn errors(&self) -> Vec<f64> {
        let mut errors = vec![0.0; self.cols];
        if self.cols == 0 {
            return errors;
        }
        for (within, weights) in self.within.chunks_exact(self.cols).zip(self.weights.chunks_exact(BITS)) {
            // The weight of those negatives of the group whose bits are set.
            let mut sums = [0.0; 1 << BITS];
            for (bit, weight) in weights.iter().enumerate() {
                let (known, next) = sums.split_at_mut(1 << bit);
                next.iter_mut().zip(known).for_each(|(next, known)| *next = *known + weight);
            }
            for (error, &bits) in errors.iter_mut().zip(within) {
                *error += sums[bits as usize];
            }
        }
        errors
    }
}

impl Weighted for Negatives {
    fn best(&self) -> Option<Round> {
        best(&self.errors())
    }

    fn update(&mut self, round: &Round) -> bool {
        let col = round.index as usize - 1;
        let within: Vec<u8> = self.within.iter().skip(col).step_by(self.cols).copied().collect();
        if within.iter().all(|&bits| bits == 0) {
            return false;
        }
        let (less, more) = ((-round.alpha).exp(), round.alpha.exp());
        for (at, weight) in self.weights.iter_mut().enumerate() {
            let wrong = within[at / BITS] >> (at % BITS) & 1 == 1;
            *weight *= if wrong { more } else { less };
        }
        self.positive *= less;
        let total = self.positive + self.weights.iter().sum::<f64>();
        self.positive /= total;
        self.weights.iter_mut().for_each(|weight| *weight /= total);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::{LEAST_ERROR, TIE, boost};
    use crate::{
        metrics::{
            Cancelled, Features, Sample,
            samples::{nobody, one_class, sample, samples},
        },
        selection::{Round, Strong},
        watch::{Unwanted, Unwatched},
    };

    /// The paper's formulas, model by model.
    fn by_definition(sample: &Sample, class: u32, rounds: usize) -> Vec<Round> {
        let count = sample.train.rows();
        let value = |model: usize, col: usize| sample.train.row(model)[col];
        let (positives, negatives): (Vec<usize>, Vec<usize>) =
            (0..count).partition(|&model| sample.train_labels[model] == class);
        let sign = |truth: bool| if truth { 1.0 } else { -1.0 };
        let says = |col: usize, model: usize| {
            let farthest =
                |model: usize| positives.iter().map(|&r| (value(model, col) - value(r, col)).abs()).fold(0.0, f64::max);
            let threshold = positives.iter().map(|&q| farthest(q)).fold(0.0, f64::max);
            sign(farthest(model) <= threshold)
        };
        let truth = |model: usize| sign(sample.train_labels[model] == class);
        let mut weights: Vec<f64> = (0..count)
            .map(|model| 0.5 / if truth(model) > 0.0 { positives.len() } else { negatives.len() } as f64)
            .collect();
        let mut taken = Vec::new();
        while taken.len() < rounds && !positives.is_empty() {
            let errors: Vec<f64> = (0..sample.train.cols())
                .map(|col| (0..count).filter(|&m| says(col, m) != truth(m)).map(|m| weights[m]).sum())
                .collect();
            let error = errors.iter().copied().fold(f64::INFINITY, f64::min);
            if error >= 0.5 - TIE {
                break;
            }
            let ties: Vec<u32> = (1..).zip(&errors).filter(|(_, e)| *e - error <= TIE).map(|(k, _)| k).collect();
            let alpha = 0.5 * ((1.0 - error.max(LEAST_ERROR)) / error.max(LEAST_ERROR)).ln();
            for (model, weight) in weights.iter_mut().enumerate() {
                *weight *= (-alpha * says(ties[0] as usize - 1, model) * truth(model)).exp();
            }
            let total: f64 = weights.iter().sum();
            for weight in &mut weights {
                *weight /= total;
            }
            taken.push(Round { index: ties[0], error, alpha, ties, test: None });
        }
        taken
    }

    #[test]
    fn boosts_as_defined() {
        let mut ran = 0;
        for sample in samples() {
            let strong = boost(&sample, 12, &Unwatched).unwrap();
            assert_eq!(strong.len(), sample.classes);
            for (class, strong) in (0..).zip(strong) {
                let expected = by_definition(&sample, class, 12);
                assert_eq!(strong.rounds.len(), expected.len());
                for (round, expected) in strong.rounds.iter().zip(&expected) {
                    assert_eq!((round.index, &round.ties), (expected.index, &expected.ties));
                    assert!((round.error - expected.error).abs() < 1e-13);
                    assert!((round.alpha - expected.alpha).abs() < 1e-10);
                    ran += usize::from(round.error > 0.0);
                }
            }
        }
        assert!(ran > 300);
    }

    #[test]
    fn fewer_rounds_are_a_slice() {
        for sample in samples() {
            let long = boost(&sample, 30, &Unwatched).unwrap();
            for rounds in [0, 1, 7, 29] {
                let cut: Vec<Strong> = long.iter().map(|strong| strong.cut(rounds)).collect();
                assert_eq!(boost(&sample, rounds, &Unwatched).unwrap(), cut);
            }
        }
    }

    #[test]
    fn choices_within_fewer_features_are_the_same_there() {
        let mut shorter = 0;
        for seed in 0..6 {
            let sample = sample(seed, 7, 30, if seed % 2 == 0 { 0 } else { 4 });
            let wide = boost(&sample, 4, &Unwatched).unwrap();
            for cols in 1..30 {
                let narrow = boost(&sample.prefix(cols), 4, &Unwatched).unwrap();
                for (wide, narrow) in wide.iter().zip(&narrow).filter(|(wide, _)| wide.reach() as usize <= cols) {
                    let mut wide = wide.clone();
                    for round in &mut wide.rounds {
                        round.ties.retain(|&index| index as usize <= cols);
                    }
                    assert_eq!(narrow, &wide);
                    shorter += 1;
                }
            }
        }
        assert!(shorter > 100);
    }

    #[test]
    fn a_perfect_weak_classifier_is_taken_every_round() {
        let sample = Sample {
            train: Features::from_rows([[0.0, 1.0, 1.0], [0.0, 2.0, 1.5], [0.0, 5.0, 7.0], [0.0, 6.0, 9.0]]),
            train_labels: vec![0, 0, 1, 1],
            classes: 3,
            ..Sample::default()
        };
        let strong = boost(&sample, 5, &Unwatched).unwrap();
        let alpha = 0.5 * ((1.0 - LEAST_ERROR) / LEAST_ERROR).ln();
        let round = Round { index: 2, error: 0.0, alpha, ties: vec![2, 3], test: None };
        assert_eq!(strong[0].rounds, vec![round; 5]);
        // The third class has no models.
        assert_eq!(strong[2], Strong::default());
    }

    #[test]
    fn stops_when_nothing_is_better_than_chance() {
        // Class 0 spans the whole line.
        let sample = Sample {
            train: Features::from_rows([[0.0], [9.0], [4.0], [5.0]]),
            train_labels: vec![0, 0, 1, 1],
            classes: 2,
            ..Sample::default()
        };
        let strong = boost(&sample, 5, &Unwatched).unwrap();
        assert_eq!(strong[0], Strong::default());
        assert_eq!(strong[1].rounds.len(), 5);
    }

    #[test]
    fn few_or_no_models() {
        assert_eq!(boost(&nobody(), 5, &Unwatched).unwrap(), [Strong::default(), Strong::default()]);
        // Without negatives every weak classifier is perfect.
        let strong = boost(&one_class(), 2, &Unwatched).unwrap();
        assert_eq!(strong[0].rounds[1].ties, [1, 2]);
        assert_eq!(strong[0].rounds[0].error, 0.0);
    }

    #[test]
    fn stops_when_cancelled() {
        assert_eq!(boost(&sample(5, 5, 5, 0), 20, &Unwanted), Err(Cancelled));
    }
}

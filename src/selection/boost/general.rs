//! AdaBoost with weak classifiers that are chosen anew under each round's weights, and when to stop it.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Weighted, best, boost, run};
use crate::{
    metrics::{Cancelled, Features, Sample},
    selection::{
        Ranges, Round, Strong, Weak, decide,
        weak::{Field, Test},
    },
    watch::Watch,
};

/// When AdaBoost's rounds end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Stop {
    /// After T rounds, the paper's.
    #[default]
    Fixed,
    /// Where models held out of an inner run are told best, after T rounds at the latest ([`held_out`]).
    Early,
}

/// [`boost`] with other weak classifiers.
///
/// Rounds, weights and ties are as there, but that a weak classifier may err on the positives, too. Among questions
/// about one eigenvalue with equal errors the first is taken: lower values before higher, inside before outside.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn boost_by(sample: &Sample, rounds: usize, weak: Weak, watch: &dyn Watch) -> Result<Vec<Strong>, Cancelled> {
    if weak == Weak::Range {
        return boost(sample, rounds, watch);
    }
    let field = Field::new(sample);
    (0..sample.classes)
        .into_par_iter()
        .map(|class| of_class(sample, &field, class as u32, rounds, weak, watch))
        .collect()
}

fn of_class(
    sample: &Sample,
    field: &Field,
    class: u32,
    rounds: usize,
    weak: Weak,
    watch: &dyn Watch,
) -> Result<Strong, Cancelled> {
    let members = sample.train_labels.iter().filter(|&&label| label == class).count();
    let others = sample.train_labels.len() - members;
    if members == 0 {
        return Ok(Strong::default());
    }
    let start = |&label: &u32| if label == class { 0.5 / members as f64 } else { -0.5 / others as f64 };
    let weights = sample.train_labels.iter().map(start).collect();
    run(Signed { sample, field, weak, weights }, rounds, watch)
}

/// Weak classifiers that may err on members and on others.
struct Signed<'a> {
    sample: &'a Sample,
    field: &'a Field,
    weak: Weak,
    /// Those of the others negative.
    weights: Vec<f64>,
}

impl Weighted for Signed<'_> {
    fn best(&self) -> Option<Round> {
        let Self { field, weights, .. } = self;
        let sum = |sign: f64| weights.iter().filter(|&&s| s * sign > 0.0).map(|s| s.abs()).sum::<f64>();
        let (positive, negative) = (sum(1.0), sum(-1.0));
        let found: Vec<(f64, Test)> =
            (0..field.cols()).map(|col| field.best(col, self.weak, weights, positive, negative)).collect();
        let errors: Vec<f64> = found.iter().map(|&(error, _)| error.max(0.0)).collect();
        let round = best(&errors)?;
        let test = found[round.index as usize - 1].1;
        Some(Round { test: Some(test), ..round })
    }

    fn update(&mut self, round: &Round) -> bool {
        let Some(test) = round.test else { return false };
        let col = round.index as usize - 1;
        let (less, more) = ((-round.alpha).exp(), round.alpha.exp());
        let mut any = false;
        for (model, weight) in self.weights.iter_mut().enumerate() {
            let wrong = test.says(self.sample.train.row(model)[col]) != (*weight > 0.0);
            *weight *= if wrong { more } else { less };
            any |= wrong;
        }
        let total: f64 = self.weights.iter().map(|weight| weight.abs()).sum();
        for weight in &mut self.weights {
            *weight /= total;
        }
        any
    }
}

/// ε after 1…`rounds` rounds on training models that took no part in them: every third of each class.
///
/// The least number of rounds with the least ε ([`stop_at`]) is where to stop. Empty when no class has three models.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn held_out(sample: &Sample, rounds: usize, weak: Weak, watch: &dyn Watch) -> Result<Vec<f64>, Cancelled> {
    let mut seen = vec![0_usize; sample.classes];
    let out: Vec<bool> = sample
        .train_labels
        .iter()
        .map(|&label| {
            seen[label as usize] += 1;
            seen[label as usize].is_multiple_of(3)
        })
        .collect();
    let side = |asked: bool| (0..out.len()).filter(|&model| out[model] == asked).collect::<Vec<_>>();
    let rows = |models: &[usize]| Features::from_rows(models.iter().map(|&model| sample.train.row(model)));
    let labels = |models: &[usize]| models.iter().map(|&model| sample.train_labels[model]).collect::<Vec<_>>();
    let (learnt, asked) = (side(false), side(true));
    if asked.is_empty() {
        return Ok(Vec::new());
    }
    let inner =
        Sample { train: rows(&learnt), train_labels: labels(&learnt), classes: sample.classes, ..Sample::default() };
    let classes = boost_by(&inner, rounds, weak, watch)?;
    let ranges = Ranges::new(&inner);
    let known = |class: usize| ranges.known(class);
    let mut scores: Vec<Vec<f64>> = vec![vec![0.0; classes.len()]; asked.len()];
    let mut errors = Vec::with_capacity(rounds);
    for nth in 0..rounds {
        let mut wrong = 0;
        for (&model, scores) in asked.iter().zip(&mut scores) {
            let features = sample.train.row(model);
            for (class, strong) in classes.iter().enumerate() {
                if let Some(round) = strong.rounds.get(nth) {
                    scores[class] += if ranges.says(class, round, features) { round.alpha } else { -round.alpha };
                }
            }
            let scores: Vec<_> = scores.iter().enumerate().map(|(class, &s)| known(class).then_some(s)).collect();
            wrong += usize::from(decide(&scores) != Some(sample.train_labels[model]));
        }
        errors.push(wrong as f64 / asked.len() as f64);
    }
    Ok(errors)
}

/// How many rounds have the least error, of several numbers the least; all of `rounds` when nothing was held out.
#[must_use]
pub fn stop_at(held_out: &[f64], rounds: usize) -> usize {
    let mut best = None;
    for (nth, &error) in (1..).zip(&held_out[..rounds.min(held_out.len())]) {
        if best.is_none_or(|(least, _)| error < least) {
            best = Some((error, nth));
        }
    }
    best.map_or(rounds, |(_, nth)| nth)
}

#[cfg(test)]
mod tests {
    use super::{boost_by, held_out, stop_at};
    use crate::{
        metrics::{
            Cancelled, Features, Sample,
            samples::{nobody, one_class, sample, samples},
        },
        selection::{Strong, Weak, boost},
        watch::{Unwanted, Unwatched},
    };

    const NEW: [Weak; 2] = [Weak::Interval, Weak::Threshold];

    #[test]
    fn ranges_are_the_paper_s_rounds() {
        let sample = sample(1, 6, 9, 0);
        assert_eq!(boost_by(&sample, 7, Weak::Range, &Unwatched), boost(&sample, 7, &Unwatched));
    }

    /// The training error of one class falls under the product of `2·sqrt(ε_t (1 − ε_t))` (Freund and Schapire 1997),
    /// which holds only when weights, errors and α fit together.
    #[test]
    fn the_training_error_keeps_below_its_bound() {
        let mut fell = 0;
        for sample in samples().iter().filter(|sample| sample.train.rows() > 3) {
            for weak in NEW {
                let classes = boost_by(sample, 15, weak, &Unwatched).unwrap();
                for (class, strong) in (0..).zip(&classes) {
                    let members = sample.train_labels.iter().filter(|&&label| label == class).count();
                    let (mut bound, mut scores) = (1.0, vec![0.0; sample.train.rows()]);
                    for round in &strong.rounds {
                        let error = round.error.max(crate::selection::LEAST_ERROR);
                        bound *= 2.0 * (error * (1.0 - error)).sqrt();
                        for (model, score) in scores.iter_mut().enumerate() {
                            let value = sample.train.row(model)[round.index as usize - 1];
                            *score += if round.test.unwrap().says(value) { round.alpha } else { -round.alpha };
                        }
                        let size = |label: u32| if label == class { members } else { scores.len() - members };
                        let weight = |label: u32| 0.5 / size(label) as f64;
                        let wrong: f64 = (0..scores.len())
                            .filter(|&model| (scores[model] > 0.0) != (sample.train_labels[model] == class))
                            .map(|model| weight(sample.train_labels[model]))
                            .sum();
                        assert!(wrong <= bound + 1e-9, "{wrong} {bound}");
                        fell += usize::from(bound < 0.2);
                    }
                }
            }
        }
        assert!(fell > 100, "{fell}");
    }

    #[test]
    fn fewer_rounds_are_a_slice() {
        for (sample, weak) in samples().iter().flat_map(|sample| NEW.map(|weak| (sample, weak))) {
            let long = boost_by(sample, 12, weak, &Unwatched).unwrap();
            let cut: Vec<Strong> = long.iter().map(|strong| strong.cut(5)).collect();
            assert_eq!(boost_by(sample, 5, weak, &Unwatched).unwrap(), cut);
        }
    }

    #[test]
    fn two_heaps_of_one_class_are_told_by_an_interval_outside() {
        let sample = Sample {
            train: Features::from_rows([[1.0], [9.0], [4.0], [5.0]]),
            train_labels: vec![0, 0, 1, 1],
            classes: 2,
            ..Sample::default()
        };
        // The range of class 0 holds all; outside of 2.5 to 7 lies it alone.
        assert_eq!(boost(&sample, 3, &Unwatched).unwrap()[0], Strong::default());
        let strong = &boost_by(&sample, 3, Weak::Interval, &Unwatched).unwrap()[0];
        let test = strong.rounds[0].test.unwrap();
        assert_eq!((strong.rounds[0].error, test.low, test.high, test.inside), (0.0, Some(2.5), Some(7.0), false));
        assert_eq!(strong.rounds.len(), 3);
    }

    #[test]
    fn stops_where_the_models_held_out_are_told_best() {
        assert_eq!(stop_at(&[0.5, 0.25, 0.25, 0.125], 3), 2);
        assert_eq!(stop_at(&[0.5, 0.25, 0.25, 0.125], 4), 4);
        assert_eq!(stop_at(&[], 7), 7);
        let sample = sample(2, 9, 20, 0);
        for weak in Weak::ALL {
            let errors = held_out(&sample, 10, weak, &Unwatched).unwrap();
            assert_eq!(errors.len(), 10);
            assert_eq!(held_out(&sample, 4, weak, &Unwatched).unwrap(), errors[..4]);
            assert!(errors.iter().all(|error| (0.0..=1.0).contains(error)));
            assert!(errors[stop_at(&errors, 10) - 1] <= errors[0]);
        }
    }

    #[test]
    fn few_or_no_models() {
        for weak in NEW {
            assert_eq!(boost_by(&nobody(), 5, weak, &Unwatched).unwrap(), [Strong::default(), Strong::default()]);
            assert_eq!(boost_by(&one_class(), 2, weak, &Unwatched).unwrap()[0].rounds.len(), 2);
            assert!(held_out(&nobody(), 5, weak, &Unwatched).unwrap().is_empty());
        }
    }

    #[test]
    fn stops_when_cancelled() {
        assert_eq!(boost_by(&sample(5, 5, 5, 0), 20, Weak::Interval, &Unwanted), Err(Cancelled));
    }
}

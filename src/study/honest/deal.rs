//! Dealing models into folds, and adding up what is said of them.

use super::{Interval, Plan, test::bootstrap};
use crate::metrics::{Chance, Features, Sample};

/// Streams of chance: one for the bootstrap, one for the permutations, and from here on one for each repeat.
const DEALS: u64 = 2;

/// A fold of a repeat, both from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fold {
    repeat: usize,
    fold: usize,
}

/// All models of a sample, the training models and then the queries, dealt into folds as often as the plan says.
///
/// How they are dealt follows from their labels alone: methods on other features of the same models are asked in the
/// same folds.
pub(super) struct Parts<'a> {
    models: Vec<(&'a [f64], u32)>,
    classes: usize,
    folds: usize,
    /// For each repeat the fold of every model.
    deals: Vec<Vec<usize>>,
}

impl<'a> Parts<'a> {
    pub(super) fn new(sample: &'a Sample, plan: Plan) -> Self {
        let models = pooled(sample);
        let labels: Vec<u32> = models.iter().map(|&(_, label)| label).collect();
        let folds = plan.folds.max(1);
        let deals = (0..plan.repeats)
            .map(|repeat| deal(&labels, sample.classes, folds, Chance::new(plan.seed, DEALS + repeat as u64)))
            .collect();
        Self { models, classes: sample.classes, folds, deals }
    }

    /// How many models there are.
    pub(super) fn models(&self) -> usize {
        self.models.len()
    }

    /// Every fold of every repeat.
    pub(super) fn folds(&self) -> Vec<Fold> {
        let folds = self.folds;
        (0..self.deals.len()).flat_map(|repeat| (0..folds).map(move |fold| Fold { repeat, fold })).collect()
    }

    /// The models of a fold.
    pub(super) fn asked(&self, Fold { repeat, fold }: Fold) -> impl Iterator<Item = usize> + '_ {
        let deal = &self.deals[repeat];
        (0..self.models.len()).filter(move |&model| deal[model] == fold)
    }

    /// One fold asked against the others.
    pub(super) fn split(&self, Fold { repeat, fold }: Fold) -> Sample {
        let side = |asked: bool| {
            let dealt = self.models.iter().zip(&self.deals[repeat]);
            dealt.filter(move |&(_, &of)| (of == fold) == asked).map(|(&model, _)| model)
        };
        let rows = |asked: bool| Features::from_rows(side(asked).map(|(row, _)| row));
        let labels = |asked: bool| side(asked).map(|(_, label)| label).collect();
        Sample {
            train: rows(false),
            train_labels: labels(false),
            query: rows(true),
            query_labels: labels(true),
            classes: self.classes,
        }
    }
}

/// The training models and then the queries, as rows and labels.
pub(super) fn pooled(sample: &Sample) -> Vec<(&[f64], u32)> {
    let train = (0..sample.train.rows()).map(|row| (sample.train.row(row), sample.train_labels[row]));
    let query = (0..sample.query.rows()).map(|row| (sample.query.row(row), sample.query_labels[row]));
    train.chain(query).collect()
}

/// The fold of every model. Models are dealt class by class, so that every fold has as even a share of each as can be.
fn deal(labels: &[u32], classes: usize, folds: usize, mut chance: Chance) -> Vec<usize> {
    let mut fold = vec![0; labels.len()];
    // Goes on where the last class ended, so that small classes do not all begin at the first fold.
    let mut next = 0;
    for class in 0..classes {
        let mut members: Vec<usize> = (0..labels.len()).filter(|&model| labels[model] as usize == class).collect();
        chance.shuffle(&mut members);
        for model in members {
            fold[model] = next % folds;
            next += 1;
        }
    }
    fold
}

/// What all repeats say of one method: sums by model.
pub(super) struct Tally {
    /// How often each model was given a wrong class.
    pub(super) wrong: Vec<u32>,
    /// Mean ADR of each model, where it has something to find; none at all for methods that rank no models.
    adr: Option<Vec<Option<f64>>>,
    /// ε of each repeat.
    pub(super) repeats: Vec<f64>,
    /// Eigenvalues selected, the mean over the folds.
    pub(super) selected: f64,
}

impl Tally {
    pub(super) fn new(models: usize, plan: Plan) -> Self {
        Self { wrong: vec![0; models], adr: None, repeats: vec![0.0; plan.repeats], selected: 0.0 }
    }

    /// Adds what was said of the models of a fold, in their order.
    pub(super) fn add(
        &mut self,
        parts: &Parts<'_>,
        fold: Fold,
        wrong: &[bool],
        adr: Option<&[Option<f64>]>,
        selected: f64,
    ) {
        let repeats = self.repeats.len() as f64;
        self.selected += selected / (repeats * parts.folds as f64);
        for (nth, model) in parts.asked(fold).enumerate() {
            self.wrong[model] += u32::from(wrong[nth]);
            self.repeats[fold.repeat] += f64::from(u8::from(wrong[nth])) / parts.models() as f64;
            if let Some(adr) = adr.and_then(|adr| adr[nth]) {
                let sums = self.adr.get_or_insert_with(|| vec![None; parts.models()]);
                *sums[model].get_or_insert(0.0) += adr / repeats;
            }
        }
    }

    /// ε with its interval.
    pub(super) fn error(&self, plan: Plan) -> Interval {
        let asked = plan.repeats.max(1) as f64;
        let wrong: Vec<f64> = self.wrong.iter().map(|&wrong| f64::from(wrong) / asked).collect();
        interval(&wrong, plan, 1.0)
    }

    /// Mean ADR with its interval.
    pub(super) fn adr(&self, plan: Plan) -> Option<Interval> {
        let adr = self.adr.as_ref()?;
        Some(interval(&adr.iter().copied().flatten().collect::<Vec<_>>(), plan, 0.0))
    }
}

/// The mean of values of models, with its interval.
pub(super) fn interval(values: &[f64], plan: Plan, of_nothing: f64) -> Interval {
    bootstrap(values, plan.resamples, Chance::new(plan.seed, 0)).unwrap_or(Interval {
        mean: of_nothing,
        low: of_nothing,
        high: of_nothing,
    })
}

#[cfg(test)]
mod tests {
    use super::deal;
    use crate::metrics::Chance;

    #[test]
    fn folds_share_every_class() {
        let labels: Vec<u32> = (0..40).map(|model| model % 4).collect();
        let fold = deal(&labels, 4, 4, Chance::new(1, 2));
        for class in 0..4 {
            for part in 0..4 {
                let members = (0..40).filter(|&model| labels[model] == class && fold[model] == part).count();
                assert!((2..=3).contains(&members), "{members}");
            }
        }
        assert_ne!(fold, deal(&labels, 4, 4, Chance::new(1, 3)));
    }
}

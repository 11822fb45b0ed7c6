//! Costs as integers.

use super::{Cost, block::network};
use crate::metrics::{Exam, Recall, Sample};

/// What the nearest models of a model asked cost: 1 for the wrong class, or what its ADR lacks of 1 in the exact units
/// of [`Recall`].
pub(super) struct Judge<'a> {
    cost: Cost,
    exam: Exam<'a>,
    recall: Recall,
    /// By class: its training models.
    members: Vec<Vec<u32>>,
    /// By class: what sorts its members but one.
    networks: Vec<Vec<(u32, u32)>>,
    /// By class: the weights of ranks in units, rounded up.
    credits: Vec<Vec<u64>>,
    unit: u128,
}

impl<'a> Judge<'a> {
    pub(super) fn new(sample: &'a Sample, cost: Cost) -> Self {
        let exam = Exam::leave_one_out(sample);
        let mut members = vec![Vec::new(); sample.classes];
        for (model, &label) in (0..).zip(&sample.train_labels) {
            members[label as usize].push(model);
        }
        let networks = members.iter().map(|members| network(members.len().saturating_sub(1))).collect();
        let recall = exam.recall();
        let unit = recall.full().div_ceil(1 << 62).max(1);
        let credits = |members: &Vec<u32>| match members.len() {
            0 | 1 => Vec::new(),
            count => recall.weights(count - 1).iter().map(|weight| weight.div_ceil(unit) as u64).collect(),
        };
        let credits = members.iter().map(credits).collect();
        Self { cost, exam, recall, members, networks, credits, unit }
    }

    /// The losses of a [`Block`](super::block::Block) are in these units. When it is 1, they are exact; otherwise they
    /// are rounded down.
    pub(super) const fn unit(&self) -> u128 {
        match self.cost {
            Cost::Error => 1,
            Cost::Adr => self.unit,
        }
    }

    /// What a relevant model adds to the ADR of a model asked, by rank − 1, and what all of them add at best. In units.
    pub(super) fn credits(&self, asked: usize) -> (&[u64], u64) {
        (&self.credits[self.exam.label(asked) as usize], (self.recall.scale() / self.unit) as u64)
    }

    pub(super) const fn cost(&self) -> Cost {
        self.cost
    }

    /// How many models there are.
    pub(super) fn models(&self) -> u32 {
        self.exam.len() as u32
    }

    /// Whether a model is of the class of the model asked.
    pub(super) fn related(&self, asked: usize, model: u32) -> bool {
        self.exam.labels()[model as usize] == self.exam.label(asked)
    }

    /// The models of the same class, the model itself among them, ascending.
    pub(super) fn class(&self, asked: usize) -> &[u32] {
        &self.members[self.exam.label(asked) as usize]
    }

    /// The sorting network for the models of the same class without the model itself.
    pub(super) fn network(&self, asked: usize) -> &[(u32, u32)] {
        &self.networks[self.exam.label(asked) as usize]
    }

    /// How many models there are to find.
    fn relevant(&self, asked: usize) -> usize {
        self.class(asked).len() - 1
    }

    /// How many of the nearest models the cost looks at.
    pub(super) fn looks_at(&self, asked: usize) -> usize {
        match self.cost {
            Cost::Error => 1,
            Cost::Adr => self.relevant(asked),
        }
    }

    /// The loss of one model asked, whose nearest models are `top`.
    pub(super) fn loss(&self, asked: usize, top: &[(f64, u32)]) -> u128 {
        let right = |entry: &(f64, u32)| self.related(asked, entry.1);
        match self.cost {
            Cost::Error => u128::from(!top.first().is_some_and(right)),
            Cost::Adr if self.relevant(asked) == 0 => 0,
            Cost::Adr => {
                let weights = self.recall.weights(self.relevant(asked));
                let found = top.iter().zip(weights).filter(|(entry, _)| right(entry));
                self.recall.scale() - found.map(|(_, &weight)| weight).sum::<u128>()
            }
        }
    }

    /// The loss when nothing is right.
    pub(super) fn worst(&self) -> u128 {
        match self.cost {
            Cost::Error => self.exam.len() as u128,
            Cost::Adr => self.recall.full(),
        }
    }

    /// The cost of a total loss: ε or 1 − mean ADR.
    pub(super) fn cost_of(&self, loss: u128) -> f64 {
        match self.cost {
            Cost::Error => loss as f64 / self.exam.len() as f64,
            Cost::Adr => 1.0 - self.recall.mean(self.recall.full() - loss),
        }
    }
}

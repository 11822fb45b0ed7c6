//! Costs as integers.

use super::Cost;
use crate::metrics::{Exam, Recall, Sample};

/// What the nearest models of a model asked cost: 1 for the wrong class, or what its ADR lacks of 1 in the exact units
/// of [`Recall`].
pub(super) struct Judge<'a> {
    cost: Cost,
    exam: Exam<'a>,
    relevant: Vec<usize>,
    recall: Recall,
}

impl<'a> Judge<'a> {
    pub(super) fn new(sample: &'a Sample, cost: Cost) -> Self {
        let exam = Exam::leave_one_out(sample);
        Self { cost, exam, relevant: exam.relevant(), recall: exam.recall() }
    }

    /// How many of the nearest models the cost looks at.
    pub(super) fn looks_at(&self, asked: usize) -> usize {
        match self.cost {
            Cost::Error => 1,
            Cost::Adr => self.relevant[asked],
        }
    }

    /// The loss of one model asked, whose nearest models are `top`.
    #[inline(always)]
    pub(super) fn loss(&self, asked: usize, top: &[(f64, u32)]) -> u128 {
        let label = self.exam.label(asked);
        let right = |entry: &(f64, u32)| self.exam.labels()[entry.1 as usize] == label;
        match self.cost {
            Cost::Error => u128::from(!top.first().is_some_and(right)),
            Cost::Adr if self.relevant[asked] == 0 => 0,
            Cost::Adr => {
                let found = top.iter().zip(self.recall.weights(self.relevant[asked])).filter(|(entry, _)| right(entry));
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
    pub(super) fn cost(&self, loss: u128) -> f64 {
        match self.cost {
            Cost::Error => loss as f64 / self.exam.len() as f64,
            Cost::Adr => 1.0 - self.recall.mean(self.recall.full() - loss),
        }
    }
}

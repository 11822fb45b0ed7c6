//! Costs as integers.

use std::ops::Range;

use super::{Cost, block::network, row::NEAR, sketch::RANKS};
use crate::metrics::{Exam, Recall, Sample};

/// What the nearest models of a model asked cost: 1 for the wrong class, or what its ADR lacks of 1 in the exact units
/// of [`Recall`].
pub(super) struct Judge<'a> {
    cost: Cost,
    exam: Exam<'a>,
    recall: Recall,
    /// By class: its training models.
    members: Vec<Vec<u32>>,
    /// By class: how many training models those before it have.
    starts: Vec<u32>,
    /// By class: what sorts its members but one.
    networks: Vec<Vec<(u32, u32)>>,
    /// By class: the weights of ranks in units, rounded up.
    credits: Vec<Vec<u64>>,
    unit: u128,
    /// By class: the same in rough units, with what follows the last rank.
    rough: Vec<[u32; RANKS]>,
    rough_unit: u128,
    /// Bits that a rough loss has beyond a byte.
    rough_bits: u32,
}

/// Into so many units at most is an ADR of 1 cut where losses are rough.
const ROUGH: u128 = 1 << 24;

impl<'a> Judge<'a> {
    pub(super) fn new(sample: &'a Sample, cost: Cost) -> Self {
        let exam = Exam::leave_one_out(sample);
        let mut members = vec![Vec::new(); sample.classes];
        for (model, &label) in (0..).zip(&sample.train_labels) {
            members[label as usize].push(model);
        }
        let starts = members.iter().scan(0, |next, members| {
            let start = *next;
            *next += members.len() as u32;
            Some(start)
        });
        let starts = starts.collect();
        let networks = members.iter().map(|members| network(members.len().saturating_sub(1))).collect();
        let recall = exam.recall();
        let unit = recall.full().div_ceil(1 << 62).max(1);
        let credits = |members: &Vec<u32>| match members.len() {
            0 | 1 => Vec::new(),
            count => recall.weights(count - 1).iter().map(|weight| weight.div_ceil(unit) as u64).collect(),
        };
        let credits = members.iter().map(credits).collect();
        let rough_unit = match cost {
            Cost::Error => 1,
            Cost::Adr => recall.scale().div_ceil(ROUGH).max(1),
        };
        let rough = |members: &Vec<u32>| {
            let mut credits = [0; RANKS];
            if cost == Cost::Error {
                credits[0] = 1;
            } else if members.len() > 1 {
                for (credit, weight) in credits.iter_mut().zip(recall.weights(members.len() - 1)) {
                    *credit = weight.div_ceil(rough_unit) as u32;
                }
            }
            credits
        };
        let rough = members.iter().map(rough).collect();
        let most = if cost == Cost::Error { 1 } else { recall.scale() / rough_unit };
        let rough_bits = (u128::BITS - most.leading_zeros()).saturating_sub(u8::BITS);
        Self { cost, exam, recall, members, starts, networks, credits, unit, rough, rough_unit, rough_bits }
    }

    /// Whether the classes are small enough for [`Judge::rough_credits`].
    pub(super) fn fits_tables(&self) -> bool {
        self.most_relevant() + NEAR < RANKS
    }

    /// The losses of a [`Sketch`](super::sketch::Sketch) are in these units, rounded down.
    pub(super) const fn rough_unit(&self) -> u128 {
        self.rough_unit
    }

    /// What a relevant model makes good of the loss of a model asked, by rank − 1, and the loss without any. In rough
    /// units.
    pub(super) fn rough_credits(&self, asked: usize) -> (&[u32; RANKS], u32) {
        let whole = match self.cost {
            Cost::Error => 1,
            Cost::Adr => (self.recall.scale() / self.rough_unit) as u32,
        };
        (&self.rough[self.exam.label(asked) as usize], whole)
    }

    /// A rough loss of one model asked in 256ths of the greatest, or up to twice as many.
    pub(super) fn roughly_in_brief(&self, loss: u64) -> u8 {
        (loss >> self.rough_bits) as u8
    }

    /// What a relevant model makes good of the loss of a model asked, by rank − 1; beyond, nothing.
    pub(super) fn gains(&self, asked: usize) -> &[u128] {
        match self.cost {
            Cost::Error => &[1],
            Cost::Adr => self.recall.weights(self.relevant(asked)),
        }
    }

    /// The loss of a model asked that finds nothing.
    pub(super) fn whole(&self, asked: usize) -> u128 {
        match self.cost {
            Cost::Error => 1,
            Cost::Adr if self.relevant(asked) == 0 => 0,
            Cost::Adr => self.recall.scale(),
        }
    }

    /// The classes of the models, and for each class how many models those before it have.
    pub(super) fn classes(&self) -> (&[u32], &[u32]) {
        (self.exam.labels(), &self.starts)
    }

    /// Where the models of the class of the model asked stand when models are ordered by class.
    pub(super) fn class_range(&self, asked: usize) -> Range<usize> {
        let start = self.starts[self.exam.label(asked) as usize] as usize;
        start..start + self.class(asked).len()
    }

    /// How many models there are to find at most.
    pub(super) fn most_relevant(&self) -> usize {
        self.members.iter().map(|members| members.len().saturating_sub(1)).max().unwrap_or(0)
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

    /// Whether a model is of the class of the model asked.
    pub(super) fn related(&self, asked: usize, model: u32) -> bool {
        self.exam.labels()[model as usize] == self.exam.label(asked)
    }

    /// How many models there are.
    pub(super) const fn models(&self) -> usize {
        self.exam.len()
    }

    /// The class of every model.
    pub(super) fn labels(&self) -> &[u32] {
        self.exam.labels()
    }

    /// The class of a model.
    pub(super) fn label(&self, model: usize) -> u32 {
        self.exam.label(model)
    }

    /// The models of every class, ascending.
    pub(super) fn members(&self) -> &[Vec<u32>] {
        &self.members
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
        let found = top.iter().zip(self.gains(asked)).filter(|(entry, _)| self.related(asked, entry.1));
        self.whole(asked) - found.map(|(_, &gain)| gain).sum::<u128>()
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

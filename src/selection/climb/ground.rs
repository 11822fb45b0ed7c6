//! The distances under a selection, and what one eigenvalue more or fewer would make of them.

use std::{marker::PhantomData, sync::Arc};

use rayon::prelude::*;

use super::{
    ask::Ask,
    habits::Habits,
    judge::Judge,
    line::{Line, RoughLosses},
    race::{Bound, Outcome},
    row::Row,
    single::Singles,
};
use crate::{
    metrics::{Cancelled, Columns, Features, Nearest, Sample, Term},
    watch::Watch,
};

/// Models asked between two looks at the watch and at the bound.
pub(super) const POLL: usize = 16;

/// All training models under the selection.
#[derive(Clone)]
pub(super) struct Ground<'a, T> {
    sample: &'a Sample,
    pub(super) judge: &'a Judge<'a>,
    pub(super) columns: Columns,
    pub(super) singles: Arc<Singles>,
    /// In the order in which they were added, which is the order in which sums are built up: a sum does not depend on
    /// which candidates were tried.
    selected: Vec<u32>,
    pub(super) rows: Vec<Row>,
    /// Models, those with the greatest loss first: they soon tell a bad candidate.
    pub(super) asked: Vec<u32>,
    term: PhantomData<T>,
}

impl<'a, T: Term> Ground<'a, T> {
    /// Nothing is selected.
    pub(super) fn new(sample: &'a Sample, judge: &'a Judge<'a>) -> Self {
        let columns = Columns::new(&sample.train);
        let models = sample.train.rows();
        let singles = Arc::new(Singles::new::<T>(&columns, models));
        let rows = vec![Row::new(columns.stride()); models];
        let asked = (0..models as u32).collect();
        let mut ground = Self { sample, judge, columns, singles, selected: Vec::new(), rows, asked, term: PhantomData };
        ground.refresh(None);
        ground
    }

    /// The selected indices.
    pub(super) fn selected(&self) -> &[u32] {
        &self.selected
    }

    /// The indices that are not selected, ascending.
    pub(super) fn outside(&self) -> Vec<u32> {
        (1..=self.columns.len() as u32).filter(|index| !self.selected.contains(index)).collect()
    }

    /// Adds an index, or removes it if it is selected.
    pub(super) fn toggle(&mut self, index: u32) {
        let count = self.selected.len();
        self.selected.retain(|&selected| selected != index);
        if self.selected.len() < count {
            self.refresh(None);
        } else {
            self.selected.push(index);
            self.refresh(Some(index));
        }
    }

    /// Brings the rows up to date: with one index added to what they hold, or from scratch.
    fn refresh(&mut self, added: Option<u32>) {
        let Self { sample, judge, columns, selected, .. } = self;
        self.rows.par_iter_mut().enumerate().for_each(|(model, row)| {
            let (sums, features) = (&mut row.sums[..], &sample.train);
            let refresh = Refresh::<T> { sums, columns, features, model, selected, added, term: PhantomData };
            pulp::Arch::new().dispatch(refresh);
            if selected.is_empty() {
                row.forget();
            } else {
                row.update(model, judge);
            }
        });
        let rows = &self.rows;
        self.asked.sort_unstable_by_key(|&model| (std::cmp::Reverse(rows[model as usize].loss), model));
    }

    /// The losses with each of some indices added or, if not `added`, removed.
    pub(super) fn moved(
        &self,
        added: bool,
        indices: &[u32],
        bound: &Bound,
        habits: &Habits,
        watch: &dyn Watch,
    ) -> Result<Vec<Outcome>, Cancelled> {
        if self.selected.is_empty() {
            return indices.iter().map(|&index| self.alone(index, bound, habits, watch)).collect();
        }
        let arch = pulp::Arch::new();
        if added {
            arch.dispatch(Ask::<T, true> { ground: self, indices, bound, habits, watch })
        } else if self.selected.len() == 1 {
            Ok(vec![Outcome::Whole(self.judge.worst())])
        } else {
            arch.dispatch(Ask::<T, false> { ground: self, indices, bound, habits, watch })
        }
    }

    /// The loss with `index` alone.
    fn alone(&self, index: u32, bound: &Bound, habits: &Habits, watch: &dyn Watch) -> Result<Outcome, Cancelled> {
        let values = &self.columns.col(index as usize - 1)[..self.rows.len()];
        if !T::grows(values) {
            return self.exactly(index, bound, watch);
        }
        let judge = self.judge;
        let (labels, starts) = judge.classes();
        let mut line = Line::new(values, labels, starts);
        if judge.fits_tables() {
            let losses = pulp::Arch::new().dispatch(RoughLosses { line: &line, judge, term: PhantomData::<T> });
            let loss: u64 = losses.iter().map(|&loss| u64::from(loss)).sum();
            for (seen, &loss) in habits.of(index).iter_mut().zip(&losses) {
                *seen = judge.roughly_in_brief(u64::from(loss));
            }
            let loss = u128::from(loss) * judge.rough_unit();
            if (loss, index) >= bound.mark() {
                return if watch.cancelled() { Err(Cancelled) } else { Ok(Outcome::GivenUp(loss as f64)) };
            }
        }
        let mut nearest = Nearest::new(self.rows.len(), self.columns.stride());
        self.one_by_one(index, bound, watch, |model| {
            let (looks, gains, mut gained) = (judge.looks_at(model), judge.gains(model), 0);
            let found = |rank: usize| gained += gains[rank];
            if !T::GROWS_EXACTLY {
                return judge.loss(model, line.nearest::<T>(model, looks));
            }
            if line.find::<T>(model, judge.class_range(model), looks, found) {
                return judge.whole(model) - gained;
            }
            nearest.begin(Some(model));
            self.loss_of(model, &[index], &mut nearest)
        })
    }

    /// The loss with `index` removed.
    pub(super) fn without(&self, index: u32, bound: &Bound, watch: &dyn Watch) -> Result<Outcome, Cancelled> {
        let rest: Vec<u32> = self.selected.iter().copied().filter(|&other| other != index).collect();
        let mut nearest = Nearest::new(self.rows.len(), self.columns.stride());
        self.one_by_one(index, bound, watch, |model| {
            nearest.begin(Some(model));
            self.loss_of(model, &rest, &mut nearest)
        })
    }

    /// The loss with `index` added.
    pub(super) fn exactly(&self, index: u32, bound: &Bound, watch: &dyn Watch) -> Result<Outcome, Cancelled> {
        let mut nearest = Nearest::new(self.rows.len(), self.columns.stride());
        self.one_by_one(index, bound, watch, |model| {
            nearest.begin(Some(model));
            nearest.sums.copy_from_slice(&self.rows[model].sums);
            self.loss_of(model, &[index], &mut nearest)
        })
    }

    /// The loss of one model at the distances in `nearest` and the features `indices` on top.
    fn loss_of(&self, model: usize, indices: &[u32], nearest: &mut Nearest) -> u128 {
        pulp::Arch::new().dispatch(LossOf { ground: self, model, indices, nearest })
    }

    /// Adds up the losses of all models asked, until `index` can't stay below the bound.
    fn one_by_one(
        &self,
        index: u32,
        bound: &Bound,
        watch: &dyn Watch,
        mut loss_of: impl FnMut(usize) -> u128,
    ) -> Result<Outcome, Cancelled> {
        let mut loss = 0;
        for (nth, models) in self.asked.chunks(POLL).enumerate() {
            if watch.cancelled() {
                return Err(Cancelled);
            }
            loss += models.iter().map(|&model| loss_of(model as usize)).sum::<u128>();
            if (loss, index) >= bound.mark() {
                let asked = (nth + 1) * POLL;
                return Ok(Outcome::GivenUp(loss as f64 / self.share(&self.asked[..asked.min(self.asked.len())])));
            }
        }
        Ok(Outcome::Whole(loss))
    }

    /// The share of some models in the whole loss.
    pub(super) fn share(&self, asked: &[u32]) -> f64 {
        let loss = |models: &[u32]| models.iter().map(|&model| self.rows[model as usize].loss).sum::<u64>();
        loss(asked).max(1) as f64 / loss(&self.asked).max(1) as f64
    }
}

/// The loss of one model at the distances in `nearest` and the features `indices` on top.
struct LossOf<'a, T> {
    ground: &'a Ground<'a, T>,
    model: usize,
    indices: &'a [u32],
    nearest: &'a mut Nearest,
}

impl<T: Term> pulp::NullaryFnOnce for LossOf<'_, T> {
    type Output = u128;

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Self { ground, model, indices, nearest } = self;
        for &index in indices {
            add::<T>(&mut nearest.sums, &ground.columns, ground.sample.train.row(model), index);
        }
        if let Some(loss) = by_counting(ground.judge, model, &nearest.sums) {
            return loss;
        }
        let strangers = ground.rows[model].near.iter();
        nearest.seed(ground.judge.looks_at(model), strangers.map(|&(_, other)| other));
        ground.judge.loss(model, nearest.update())
    }
}

/// The loss of one model at the distances `sums`, by how many models come before each of its relatives: those that are
/// nearer, and of those as near the lower ones. None when distances are infinite, as is that of the model itself.
#[inline(always)]
fn by_counting(judge: &Judge<'_>, model: usize, sums: &[f64]) -> Option<u128> {
    let relatives = judge.class(model).iter().filter(|&&other| other as usize != model);
    let mut relatives: Vec<(f64, u32)> = relatives.map(|&other| (sums[other as usize], other)).collect();
    relatives.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let (gains, mut gained) = (judge.gains(model), 0);
    for (sum, relative) in relatives {
        if sum == f64::INFINITY {
            return None;
        }
        let (lower, higher) = sums.split_at(relative as usize);
        let mut before = 0_u64;
        for &other in lower {
            before += u64::from(other <= sum);
        }
        for &other in higher {
            before += u64::from(other < sum);
        }
        // Relatives that come later rank no higher.
        let Some(&gain) = gains.get(before as usize) else { break };
        gained += gain;
    }
    Some(judge.whole(model) - gained)
}

/// Brings the sums of one row up to date.
struct Refresh<'a, T> {
    sums: &'a mut [f64],
    columns: &'a Columns,
    features: &'a Features,
    model: usize,
    selected: &'a [u32],
    added: Option<u32>,
    term: PhantomData<T>,
}

impl<T: Term> pulp::NullaryFnOnce for Refresh<'_, T> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { sums, columns, features, model, selected, added, .. } = self;
        let values = features.row(model);
        if let Some(index) = added {
            add::<T>(sums, columns, values, index);
            return;
        }
        sums[..features.rows()].fill(0.0);
        sums[features.rows()..].fill(f64::INFINITY);
        sums[model] = f64::INFINITY;
        for &index in selected {
            add::<T>(sums, columns, values, index);
        }
    }
}

/// Adds the terms of feature `index` (from 1) between a model with these values and all others.
#[inline(always)]
fn add<T: Term>(sums: &mut [f64], columns: &Columns, values: &[f64], index: u32) {
    let col = index as usize - 1;
    for (sum, &other) in sums.iter_mut().zip(columns.col(col)) {
        *sum += T::term(values[col], other);
    }
}

//! The distances under a selection, and what one eigenvalue more or fewer would make of them.

use std::marker::PhantomData;

use pulp::Simd;
use rayon::prelude::*;

use super::{
    block::{Block, LANES, LEAST, Losses, MOST},
    judge::Judge,
    line::Line,
    race::{Mark, Outcome},
};
use crate::{
    metrics::{Cancelled, Columns, Features, Nearest, Sample, Term},
    watch::Watch,
};

/// Strangers looked at in a brief evaluation.
const BRIEF: usize = 48;
/// Models asked between two looks at the watch and at the bound.
const POLL: usize = 16;

/// What is known of one model under the selection.
#[derive(Clone)]
pub(super) struct Row {
    /// Distance sums to all models; infinite for itself and for the padding.
    pub(super) sums: Vec<f64>,
    /// The models of other classes, nearest first.
    pub(super) strangers: Vec<(f64, u32)>,
    /// Its loss.
    loss: u128,
}

/// All training models under the selection.
#[derive(Clone)]
pub(super) struct Ground<'a, T> {
    sample: &'a Sample,
    judge: &'a Judge<'a>,
    columns: Columns,
    /// In the order in which they were added, which is the order in which sums are built up: a sum does not depend on
    /// which candidates were tried.
    selected: Vec<u32>,
    rows: Vec<Row>,
    /// Models, those with the greatest loss first: they soon tell a bad candidate.
    asked: Vec<u32>,
    term: PhantomData<T>,
}

impl<'a, T: Term> Ground<'a, T> {
    /// Nothing is selected.
    pub(super) fn new(sample: &'a Sample, judge: &'a Judge<'a>) -> Self {
        let columns = Columns::new(&sample.train);
        let models = sample.train.rows();
        let row = |_| Row { sums: vec![0.0; columns.stride()], strangers: Vec::new(), loss: 0 };
        let rows = (0..models).map(row).collect();
        let asked = (0..models as u32).collect();
        let mut ground = Self { sample, judge, columns, selected: Vec::new(), rows, asked, term: PhantomData };
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
            row.sort(model, judge);
        });
        let rows = &self.rows;
        self.asked.sort_unstable_by_key(|&model| (std::cmp::Reverse(rows[model as usize].loss), model));
    }

    /// The losses with each of some indices added.
    pub(super) fn with(
        &self,
        indices: &[u32],
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
    ) -> Result<Vec<Outcome>, Cancelled> {
        if self.selected.is_empty() {
            return indices.iter().map(|&index| self.alone(index, bound, watch)).collect();
        }
        pulp::Arch::new().dispatch(Ask { ground: self, indices, bound, watch })
    }

    /// The loss with `index` alone.
    fn alone(&self, index: u32, bound: &dyn Fn() -> Mark, watch: &dyn Watch) -> Result<Outcome, Cancelled> {
        if !T::GROWS {
            return self.exactly(index, bound, watch);
        }
        let mut line = Line::new(&self.columns.col(index as usize - 1)[..self.rows.len()]);
        self.one_by_one(index, bound, watch, |model| {
            self.judge.loss(model, line.nearest::<T>(model, self.judge.looks_at(model)))
        })
    }

    /// The loss with `index` removed.
    pub(super) fn without(
        &self,
        index: u32,
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
    ) -> Result<Vec<Outcome>, Cancelled> {
        if self.selected.len() == 1 {
            return Ok(vec![Outcome::Whole(self.judge.worst())]);
        }
        let rest: Vec<u32> = self.selected.iter().copied().filter(|&other| other != index).collect();
        let mut nearest = Nearest::new(self.rows.len(), self.columns.stride());
        let outcome = self.one_by_one(index, bound, watch, |model| {
            nearest.begin(Some(model));
            self.loss_of(model, &rest, &mut nearest)
        })?;
        Ok(vec![outcome])
    }

    /// The loss with `index` added.
    fn exactly(&self, index: u32, bound: &dyn Fn() -> Mark, watch: &dyn Watch) -> Result<Outcome, Cancelled> {
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
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
        mut loss_of: impl FnMut(usize) -> u128,
    ) -> Result<Outcome, Cancelled> {
        let mut loss = 0;
        for (nth, models) in self.asked.chunks(POLL).enumerate() {
            if watch.cancelled() {
                return Err(Cancelled);
            }
            loss += models.iter().map(|&model| loss_of(model as usize)).sum::<u128>();
            if (loss, index) >= bound() {
                let asked = (nth + 1) * POLL;
                return Ok(Outcome::GivenUp(loss as f64 / self.share(asked)));
            }
        }
        Ok(Outcome::Whole(loss))
    }

    /// The share in the whole loss of the first `count` models asked.
    fn share(&self, count: usize) -> f64 {
        let loss = |models: &[u32]| models.iter().map(|&model| self.rows[model as usize].loss).sum::<u128>();
        let asked = loss(&self.asked[..count.min(self.asked.len())]);
        asked.max(1) as f64 / loss(&self.asked).max(1) as f64
    }
}

/// Adds up the losses of all models asked for each of the candidates `indices`, a vector of them at a time, until none
/// of those can stay below the bound.
///
/// First all models are asked briefly, which is enough to give up on most candidates; then those whose losses are not
/// known yet are asked again; and for those candidates that may be best, ties are looked into.
struct Ask<'a, T> {
    ground: &'a Ground<'a, T>,
    indices: &'a [u32],
    bound: &'a dyn Fn() -> Mark,
    watch: &'a dyn Watch,
}

impl<T: Term> pulp::WithSimd for Ask<'_, T> {
    type Output = Result<Vec<Outcome>, Cancelled>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let mut outcomes = Vec::with_capacity(self.indices.len());
        for indices in self.indices.chunks(S::F64_LANES) {
            self.block(simd, indices, &mut outcomes)?;
        }
        Ok(outcomes)
    }
}

impl<T: Term> Ask<'_, T> {
    /// The outcomes of candidates that fit one vector.
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, indices: &[u32], outcomes: &mut Vec<Outcome>) -> Result<(), Cancelled> {
        let Ground { rows, asked, judge, columns, .. } = self.ground;
        let mut block = Block::<S>::new(columns, indices, rows.len());
        let unit = judge.unit() as f64;
        let mut least = [0; LANES];
        let mut unsure = Vec::new();
        for (nth, models) in asked.chunks(POLL).enumerate() {
            for &model in models {
                let row = &rows[model as usize];
                let (losses, sure) = block.losses::<T, LEAST>(simd, model as usize, row, judge, BRIEF);
                add_lanes(&mut least, &losses);
                if !sure {
                    unsure.push((model, losses));
                }
            }
            if self.may_stop(indices, &least)? {
                // Those not asked are taken to change as those asked did.
                let share = self.ground.share((nth + 1) * POLL);
                outcomes
                    .extend(indices.iter().zip(least).map(|(_, loss)| Outcome::GivenUp(loss as f64 * unit / share)));
                return Ok(());
            }
        }
        for models in unsure.chunks(POLL) {
            for &(model, briefly) in models {
                let row = &rows[model as usize];
                let (losses, _) = block.losses::<T, LEAST>(simd, model as usize, row, judge, usize::MAX);
                for ((least, briefly), loss) in least.iter_mut().zip(briefly).zip(losses) {
                    *least += loss - briefly;
                }
            }
            if self.may_stop(indices, &least)? {
                outcomes.extend(indices.iter().zip(least).map(|(_, loss)| Outcome::GivenUp(loss as f64 * unit)));
                return Ok(());
            }
        }
        let mut most = [0; LANES];
        for &model in asked {
            let row = &rows[model as usize];
            let (losses, _) = block.losses::<T, MOST>(simd, model as usize, row, judge, usize::MAX);
            add_lanes(&mut most, &losses);
        }
        let unit = judge.unit();
        for ((&index, least), most) in indices.iter().zip(least).zip(most) {
            let loss = u128::from(least) * unit;
            outcomes.push(if unit == 1 && least == most {
                Outcome::Whole(loss)
            } else if (loss, index) >= (self.bound)() {
                Outcome::GivenUp(loss as f64)
            } else {
                self.ground.exactly(index, self.bound, self.watch)?
            });
        }
        Ok(())
    }

    /// Whether no candidate can stay below the bound.
    fn may_stop(&self, indices: &[u32], least: &Losses) -> Result<bool, Cancelled> {
        if self.watch.cancelled() {
            return Err(Cancelled);
        }
        let bound = (self.bound)();
        let unit = self.ground.judge.unit();
        Ok(indices.iter().zip(least).all(|(&index, &loss)| (u128::from(loss) * unit, index) >= bound))
    }
}

#[inline(always)]
fn add_lanes(sums: &mut Losses, lanes: &Losses) {
    for (sum, lane) in sums.iter_mut().zip(lanes) {
        *sum += lane;
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
        let strangers = ground.rows[model].strangers.iter();
        nearest.seed(ground.judge.looks_at(model), strangers.map(|&(_, other)| other));
        ground.judge.loss(model, nearest.update())
    }
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

impl Row {
    /// Sorts the strangers of `model` by the sums as they are now, and works out its loss.
    fn sort(&mut self, model: usize, judge: &Judge<'_>) {
        let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
        let models = || (0..judge.models()).map(|other| (self.sums[other as usize], other));
        self.strangers.clear();
        self.strangers.extend(models().filter(|&(_, other)| !judge.related(model, other)));
        self.strangers.sort_unstable_by(order);
        // As many strangers as there are relatives are enough to know the rank of every relative that matters.
        let mut top: Vec<_> = self.strangers.iter().copied().take(judge.looks_at(model)).collect();
        top.extend(models().filter(|&(_, other)| judge.related(model, other) && other as usize != model));
        top.sort_unstable_by(order);
        self.loss = judge.loss(model, &top);
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

//! The distances under a selection, and what one eigenvalue more or fewer would make of them.

use std::marker::PhantomData;

use pulp::Simd;
use rayon::prelude::*;

use super::{
    block::{Block, LANES},
    judge::Judge,
    line::Line,
    race::{Mark, Outcome},
};
use crate::{
    metrics::{Cancelled, Columns, Features, Nearest, Sample, Term},
    watch::Watch,
};

/// Strangers kept sorted for every model. A multiple of the chunks in which a [`Block`] counts them.
pub(super) const HEAD: usize = 64;
/// Strangers looked at in a brief evaluation.
const BRIEF: usize = 24;
/// Models asked between two looks at the watch and at the bound.
const POLL: usize = 16;

/// What is known of one model under the selection.
pub(super) struct Row {
    /// Distance sums to all models; infinite for itself and for the padding.
    pub(super) sums: Vec<f64>,
    /// The models of other classes: the nearest [`HEAD`] ascending, then the rest.
    pub(super) strangers: Vec<(f64, u32)>,
    /// Its loss.
    loss: u128,
}

/// All training models under the selection.
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

    /// The losses with each of at most [`LANES`] indices added.
    pub(super) fn with(
        &self,
        indices: &[u32],
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
    ) -> Result<Vec<Outcome>, Cancelled> {
        if self.selected.is_empty() {
            return indices.iter().map(|&index| self.alone(index, bound, watch)).collect();
        }
        let block = Block::new(&self.columns, indices, self.rows.len());
        self.ask(indices, bound, watch, With { ground: self, block })
    }

    /// The loss with `index` alone.
    fn alone(&self, index: u32, bound: &dyn Fn() -> Mark, watch: &dyn Watch) -> Result<Outcome, Cancelled> {
        let line = Line::new(&self.columns.col(index as usize - 1)[..self.rows.len()]);
        Ok(self.ask(&[index], bound, watch, Alone { ground: self, line })?[0])
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
        let rest = self.selected.iter().copied().filter(|&other| other != index).collect();
        let nearest = Nearest::new(self.rows.len(), self.columns.stride());
        self.ask(&[index], bound, watch, Without { ground: self, rest, nearest })
    }

    fn ask<M: Move>(
        &self,
        indices: &[u32],
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
        of: M,
    ) -> Result<Vec<Outcome>, Cancelled> {
        pulp::Arch::new().dispatch(Ask { ground: self, indices, bound, watch, of })
    }
}

/// A move that is tried, or several of a kind, one in each lane.
trait Move {
    /// The losses of one model asked, and whether they are known. If `briefly`, they may be less than they are in the
    /// end.
    fn losses<S: Simd>(&mut self, simd: S, model: usize, briefly: bool) -> ([u128; LANES], bool);
}

/// Adding a block of candidates to what is selected.
struct With<'a, T> {
    ground: &'a Ground<'a, T>,
    block: Block,
}

impl<T: Term> Move for With<'_, T> {
    #[inline(always)]
    fn losses<S: Simd>(&mut self, simd: S, model: usize, briefly: bool) -> ([u128; LANES], bool) {
        let depth = if briefly { BRIEF } else { usize::MAX };
        self.block.losses::<T, S>(simd, model, &self.ground.rows[model], self.ground.judge, depth)
    }
}

/// Selecting one feature alone.
struct Alone<'a, T> {
    ground: &'a Ground<'a, T>,
    line: Line<'a>,
}

impl<T: Term> Move for Alone<'_, T> {
    #[inline(always)]
    fn losses<S: Simd>(&mut self, _: S, model: usize, _: bool) -> ([u128; LANES], bool) {
        let judge = self.ground.judge;
        (in_first_lane(judge.loss(model, self.line.nearest::<T>(model, judge.looks_at(model)))), true)
    }
}

/// Removing one feature, which leaves the rest.
struct Without<'a, T> {
    ground: &'a Ground<'a, T>,
    rest: Vec<u32>,
    nearest: Nearest,
}

impl<T: Term> Move for Without<'_, T> {
    #[inline(always)]
    fn losses<S: Simd>(&mut self, _: S, model: usize, _: bool) -> ([u128; LANES], bool) {
        let Self { ground, rest, nearest } = self;
        nearest.begin(Some(model));
        for &index in rest.iter() {
            add::<T>(&mut nearest.sums, &ground.columns, ground.sample.train.row(model), index);
        }
        let strangers = ground.rows[model].strangers.iter();
        nearest.seed(ground.judge.looks_at(model), strangers.map(|&(_, other)| other));
        (in_first_lane(ground.judge.loss(model, nearest.update())), true)
    }
}

fn in_first_lane(loss: u128) -> [u128; LANES] {
    let mut losses = [0; LANES];
    losses[0] = loss;
    losses
}

/// Adds up the losses of all models asked for each of the candidates `indices`, until none of them can stay below the
/// bound.
///
/// First all models are asked briefly, which is enough to give up on most candidates; then those whose losses are not
/// known yet are asked again.
struct Ask<'a, T, M> {
    ground: &'a Ground<'a, T>,
    indices: &'a [u32],
    bound: &'a dyn Fn() -> Mark,
    watch: &'a dyn Watch,
    of: M,
}

impl<T, M: Move> pulp::WithSimd for Ask<'_, T, M> {
    type Output = Result<Vec<Outcome>, Cancelled>;

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) -> Self::Output {
        let Ground { rows, asked, .. } = self.ground;
        let (mut losses, mut before) = ([0; LANES], 0);
        let mut unsure = Vec::new();
        for models in asked.chunks(POLL) {
            for &model in models {
                let (least, sure) = self.of.losses(simd, model as usize, true);
                add_lanes(&mut losses, &least);
                before += rows[model as usize].loss;
                if !sure {
                    unsure.push((model, least));
                }
            }
            if self.may_stop(&losses)? {
                // Those not asked are taken to change as those asked did.
                let whole = rows.iter().map(|row| row.loss).sum::<u128>();
                let share = before.max(1) as f64 / whole.max(1) as f64;
                return Ok(self.outcomes(&losses, |loss| Outcome::GivenUp(loss as f64 / share)));
            }
        }
        for models in unsure.chunks(POLL) {
            for &(model, least) in models {
                let (exact, _) = self.of.losses(simd, model as usize, false);
                for ((loss, least), exact) in losses.iter_mut().zip(least).zip(exact) {
                    *loss += exact - least;
                }
            }
            if self.may_stop(&losses)? {
                return Ok(self.outcomes(&losses, |loss| Outcome::GivenUp(loss as f64)));
            }
        }
        Ok(self.outcomes(&losses, Outcome::Whole))
    }
}

impl<T, M> Ask<'_, T, M> {
    /// Whether no candidate can stay below the bound.
    fn may_stop(&self, losses: &[u128; LANES]) -> Result<bool, Cancelled> {
        if self.watch.cancelled() {
            return Err(Cancelled);
        }
        let bound = (self.bound)();
        Ok(self.indices.iter().zip(losses).all(|(&index, &loss)| (loss, index) >= bound))
    }

    fn outcomes(&self, losses: &[u128; LANES], outcome: impl Fn(u128) -> Outcome) -> Vec<Outcome> {
        self.indices.iter().zip(losses).map(|(_, &loss)| outcome(loss)).collect()
    }
}

#[inline(always)]
fn add_lanes(sums: &mut [u128; LANES], lanes: &[u128; LANES]) {
    for (sum, lane) in sums.iter_mut().zip(lanes) {
        *sum += lane;
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
        let mut top: Vec<_> = models().filter(|&(_, other)| judge.related(model, other)).collect();
        top.retain(|&(_, other)| other as usize != model);
        if HEAD < self.strangers.len() {
            self.strangers.select_nth_unstable_by(HEAD, order);
        }
        let head = HEAD.min(self.strangers.len());
        self.strangers[..head].sort_unstable_by(order);
        // As many strangers as there are relatives are enough to know the rank of every relative that matters.
        let enough = judge.looks_at(model);
        if enough > head {
            self.strangers.sort_unstable_by(order);
        }
        top.extend(self.strangers.iter().take(enough));
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

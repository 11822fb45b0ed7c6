//! The distances under a selection, and what one eigenvalue more or fewer would make of them.

use std::marker::PhantomData;

use rayon::prelude::*;

use super::{
    judge::Judge,
    race::{Mark, Outcome},
};
use crate::{
    metrics::{Cancelled, Columns, Nearest, Sample, Term},
    watch::Watch,
};

/// Nearest models kept sorted for every model, at least.
const HEAD: usize = 64;
/// Models asked between two looks at the watch and at the bound.
const POLL: usize = 16;

/// What is known of one model under the selection.
struct Row {
    /// Distance sums to all models; infinite for itself and for the padding.
    sums: Vec<f64>,
    /// The nearest models, ascending.
    head: Vec<(f64, u32)>,
    /// Its loss.
    loss: u128,
}

/// All training models under the selection.
pub(super) struct Ground<'a, T> {
    sample: &'a Sample,
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
    pub(super) fn new(sample: &'a Sample, judge: &Judge<'_>) -> Self {
        let columns = Columns::new(&sample.train);
        let models = sample.train.rows();
        let row = |_| Row { sums: vec![0.0; columns.stride()], head: Vec::new(), loss: 0 };
        let rows = (0..models).map(row).collect();
        let mut ground = Self {
            sample,
            columns,
            selected: Vec::new(),
            rows,
            asked: (0..models as u32).collect(),
            term: PhantomData,
        };
        ground.refresh(None, judge);
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
    pub(super) fn toggle(&mut self, index: u32, judge: &Judge<'_>) {
        let count = self.selected.len();
        self.selected.retain(|&selected| selected != index);
        if self.selected.len() < count {
            self.refresh(None, judge);
        } else {
            self.selected.push(index);
            self.refresh(Some(index), judge);
        }
    }

    /// Brings the rows up to date: with one index added to what they hold, or from scratch.
    fn refresh(&mut self, added: Option<u32>, judge: &Judge<'_>) {
        let Self { sample, columns, selected, .. } = self;
        let (models, features) = (sample.train.rows(), &sample.train);
        self.rows.par_iter_mut().enumerate().for_each(|(model, row)| {
            pulp::Arch::new().dispatch(|| {
                let values = features.row(model);
                if let Some(index) = added {
                    add::<T>(&mut row.sums, columns, values, index);
                } else {
                    row.sums[..models].fill(0.0);
                    row.sums[models..].fill(f64::INFINITY);
                    row.sums[model] = f64::INFINITY;
                    for &index in selected.iter() {
                        add::<T>(&mut row.sums, columns, values, index);
                    }
                }
            });
            let others = (0..models).filter(|&other| other != model).map(|other| (row.sums[other], other as u32));
            row.head.clear();
            row.head.extend(others);
            let order = |a: &(f64, u32), b: &(f64, u32)| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1));
            let head = HEAD.max(2 * judge.looks_at(model));
            if head < row.head.len() {
                row.head.select_nth_unstable_by(head, order);
                row.head.truncate(head);
            }
            row.head.sort_unstable_by(order);
            row.loss = judge.loss(model, &row.head);
        });
        let rows = &self.rows;
        self.asked.sort_unstable_by_key(|&model| (std::cmp::Reverse(rows[model as usize].loss), model));
    }

    /// The loss with `index` added.
    pub(super) fn with(
        &self,
        index: u32,
        judge: &Judge<'_>,
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
    ) -> Result<Outcome, Cancelled> {
        let col = self.columns.col(index as usize - 1);
        let by_value =
            if self.selected.is_empty() { ByValue::new(&col[..self.rows.len()]) } else { ByValue::default() };
        self.ask(index, bound, watch, |model, nearest| {
            let count = judge.looks_at(model);
            if self.selected.is_empty() {
                nearest.begin(Some(model));
                nearest.seed(count, by_value.around(model));
                add_column::<T>(&mut nearest.sums, col, col[model]);
                return judge.loss(model, nearest.update());
            }
            let row = &self.rows[model];
            nearest.begin_list(Some(model));
            for &(sum, other) in &row.head {
                if !nearest.offer((sum + T::term(col[model], col[other as usize]), other), sum, count) {
                    return judge.loss(model, nearest.list());
                }
            }
            // The head did not reach far enough (or it is all there is).
            nearest.sums.copy_from_slice(&row.sums);
            add_column::<T>(&mut nearest.sums, col, col[model]);
            judge.loss(model, nearest.update())
        })
    }

    /// The loss with `index` removed.
    pub(super) fn without(
        &self,
        index: u32,
        judge: &Judge<'_>,
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
    ) -> Result<Outcome, Cancelled> {
        if self.selected.len() == 1 {
            return Ok(Outcome::GivenUp(judge.worst() as f64));
        }
        self.ask(index, bound, watch, |model, nearest| {
            nearest.begin(Some(model));
            for &other in self.selected.iter().filter(|&&other| other != index) {
                add::<T>(&mut nearest.sums, &self.columns, self.sample.train.row(model), other);
            }
            nearest.seed(judge.looks_at(model), self.rows[model].head.iter().map(|&(_, other)| other));
            judge.loss(model, nearest.update())
        })
    }

    /// Adds up the losses of all models asked, until they pass the bound.
    #[inline(always)]
    fn ask(
        &self,
        index: u32,
        bound: &dyn Fn() -> Mark,
        watch: &dyn Watch,
        mut loss_of: impl FnMut(usize, &mut Nearest) -> u128,
    ) -> Result<Outcome, Cancelled> {
        let mut nearest = Nearest::new(self.rows.len(), self.columns.stride());
        let (mut loss, mut before) = (0, 0);
        pulp::Arch::new().dispatch(|| {
            for (at, models) in self.asked.chunks(POLL).enumerate() {
                if watch.cancelled() {
                    return Err(Cancelled);
                }
                for &model in models {
                    loss += loss_of(model as usize, &mut nearest);
                    before += self.rows[model as usize].loss;
                }
                if (loss, index) >= bound() {
                    // Those not asked are taken to change as those asked did.
                    let whole = self.rows.iter().map(|row| row.loss).sum::<u128>() as f64;
                    let share = if before > 0 { before as f64 / whole } else { (at + 1) as f64 };
                    return Ok(Outcome::GivenUp(loss as f64 / share));
                }
            }
            Ok(Outcome::Lower(loss))
        })
    }
}

/// Adds the terms of feature `index` (from 1) between a model with these values and all others.
#[inline(always)]
fn add<T: Term>(sums: &mut [f64], columns: &Columns, values: &[f64], index: u32) {
    let col = index as usize - 1;
    add_column::<T>(sums, columns.col(col), values[col]);
}

#[inline(always)]
fn add_column<T: Term>(sums: &mut [f64], col: &[f64], value: f64) {
    for (sum, &other) in sums.iter_mut().zip(col) {
        *sum += T::term(value, other);
    }
}

/// Models ordered by the value of one feature.
#[derive(Default)]
struct ByValue {
    order: Vec<u32>,
    /// Where each model stands in `order`.
    places: Vec<u32>,
}

impl ByValue {
    fn new(col: &[f64]) -> Self {
        let mut order: Vec<u32> = (0..col.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| col[a as usize].total_cmp(&col[b as usize]).then(a.cmp(&b)));
        let mut places = vec![0; col.len()];
        for (place, &model) in (0..).zip(&order) {
            places[model as usize] = place;
        }
        Self { order, places }
    }

    /// The other models, by turns below and above in value.
    fn around(&self, model: usize) -> impl Iterator<Item = u32> {
        let place = self.places[model] as usize;
        let reach = place.max(self.order.len() - 1 - place);
        (1..=reach).flat_map(move |step| {
            let below = place.checked_sub(step).map(|at| self.order[at]);
            below.into_iter().chain(self.order.get(place + step).copied())
        })
    }
}

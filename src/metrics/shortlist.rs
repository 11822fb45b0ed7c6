//! The few models that may be among the nearest while feature after feature is added.

use std::hint::black_box;

use pulp::Simd;

use super::{Term, add_where_u64s, columns::Panels};

/// Features added in one go: the lanes of the widest vector.
pub(super) const SPAN: usize = Panels::FEATURES;
/// Models of a panel.
const PANEL: usize = Panels::MODELS;
/// More than so many are not counted against one another.
const MANY: usize = 64;

/// The models that may be among the `looks` nearest to a model asked, span after span of features.
///
/// Terms are not negative and sums are rounded to the nearest, so that sums never fall. If `looks` models are within a
/// reach at the end of a span, whoever is among the nearest `looks` anywhere in the span is within that reach there,
/// and was so before. Models that are beyond the reach are not looked at, nor are their sums taken any further.
#[derive(Debug, Clone)]
pub(super) struct Shortlist {
    looks: usize,
    left_out: Option<usize>,
    models: usize,
    /// The sum of every model through the features that its panel was taken through. Infinite for what is not to be
    /// found: the model left out and the padding.
    sums: Vec<[f64; PANEL]>,
    panels: Vec<Panel>,
    /// Models that were the nearest `looks` at the end of a span not long ago; none at first.
    nearest: Vec<u32>,
}

/// How far a panel of models was taken.
#[derive(Debug, Clone, Copy)]
struct Panel {
    /// Through so many features.
    through: usize,
    /// The least of its sums there, if none of its models is on the list.
    least: f64,
    /// Whether one of its models is on the list.
    listed: bool,
}

/// The models within reach in one span, and their sums.
#[derive(Debug, Clone)]
pub(super) struct List {
    /// Ascending.
    models: Vec<u32>,
    /// By model on the list: its sums after each feature.
    paths: Vec<[f64; SPAN]>,
    /// By panel, if it was taken through the span: the sums of its models after each feature.
    records: Vec<Record>,
    /// By model on the list: its last sum.
    ends: Vec<f64>,
}

type Record = [[f64; PANEL]; SPAN];

impl Shortlist {
    /// For so many models.
    pub(super) fn new(models: usize) -> Self {
        let panels = models.div_ceil(PANEL);
        let panel = Panel { through: 0, least: 0.0, listed: true };
        Self {
            looks: 0,
            left_out: None,
            models,
            sums: vec![[0.0; PANEL]; panels],
            panels: vec![panel; panels],
            nearest: Vec::new(),
        }
    }

    /// Begins with no features, for a model asked that looks at the nearest `looks`: no more than there are without the
    /// one left out.
    pub(super) fn begin(&mut self, left_out: Option<usize>, looks: usize) {
        (self.looks, self.left_out) = (looks, left_out);
        let sums = self.sums.as_flattened_mut();
        sums[..self.models].fill(0.0);
        sums[self.models..].fill(f64::INFINITY);
        if let Some(model) = left_out {
            sums[model] = f64::INFINITY;
        }
        self.panels.fill(Panel { through: 0, least: 0.0, listed: true });
        self.nearest.clear();
    }

    /// Lists the models for the span of features from `first` on, which follows the last one. `asked` holds the
    /// features of the model asked.
    #[inline(always)]
    pub(super) fn list<S: Simd, T: Term>(
        &mut self,
        simd: S,
        first: usize,
        asked: &[f64],
        features: &Panels,
        list: &mut List,
    ) {
        let span = first..asked.len().min(first + SPAN);
        let states = self.panels.iter_mut().zip(&mut self.sums).zip(&mut list.records);
        for (nth, ((panel, sums), record)) in states.enumerate() {
            if panel.listed {
                panel.record::<S, T>(simd, sums, &asked[span.clone()], features.at(nth * PANEL, first), record);
            }
        }
        // Those nearest not long ago are as many as are looked for, wherever they are at the end.
        let mut reach = if self.nearest.is_empty() { f64::INFINITY } else { 0.0 };
        for &model in &self.nearest {
            reach = self.sums.as_flattened()[model as usize].max(reach);
        }
        list.models.resize(self.sums.len() * PANEL, 0);
        let mut count = 0;
        let states = self.panels.iter_mut().zip(&mut self.sums).zip(&mut list.records);
        for (nth, ((panel, sums), record)) in states.enumerate() {
            if !panel.listed {
                if panel.least > reach {
                    continue;
                }
                while panel.through < first {
                    let next = panel.through;
                    panel.add::<S, T>(simd, sums, &asked[next..next + SPAN], features.at(nth * PANEL, next));
                }
                panel.record::<S, T>(simd, sums, &asked[span.clone()], features.at(nth * PANEL, first), record);
            }
            let before = count;
            for (model, &sum) in (nth * PANEL..).zip(&record[0]) {
                list.models[count] = model as u32;
                count += usize::from(sum <= reach);
            }
            panel.listed = count > before;
            if !panel.listed {
                panel.least = least(simd, sums);
            }
        }
        list.models.truncate(count);
        if reach == f64::INFINITY {
            // Even what is not to be found is within.
            list.models.retain(|&model| (model as usize) < self.models && Some(model as usize) != self.left_out);
        }
        list.paths.resize(list.models.len(), [0.0; SPAN]);
        for (path, &model) in list.paths.iter_mut().zip(&list.models) {
            let (panel, place) = (model as usize / PANEL, model as usize % PANEL);
            for (sum, sums) in path.iter_mut().zip(&list.records[panel]) {
                *sum = sums[place];
            }
        }
        self.renew(simd, list);
    }

    /// Finds the nearest at the end of the span, and whoever is level with them.
    #[inline(always)]
    fn renew<S: Simd>(&mut self, simd: S, list: &mut List) {
        let (sums, count) = (self.sums.as_flattened(), list.models.len());
        list.ends.clear();
        list.ends.extend(list.models.iter().map(|&model| sums[model as usize]));
        let farthest = if count > MANY {
            *list.ends.select_nth_unstable_by(self.looks - 1, f64::total_cmp).1
        } else {
            nth(simd, &mut list.ends, self.looks - 1)
        };
        self.nearest.resize(count, 0);
        let mut nearest = 0;
        for &model in &list.models {
            self.nearest[nearest] = model;
            nearest += usize::from(sums[model as usize] <= farthest);
        }
        self.nearest.truncate(nearest);
    }
}

/// The `nth` least of some values, from 0, by how many are less than each.
#[inline(always)]
fn nth<S: Simd>(simd: S, values: &mut Vec<f64>, nth: usize) -> f64 {
    let count = values.len();
    values.resize(count.next_multiple_of(PANEL), f64::INFINITY);
    let (nth, one) = (simd.splat_u64s(nth as u64), simd.splat_u64s(black_box(1)));
    let mut found = simd.splat_f64s(0.0);
    for &own in S::as_simd_f64s(values).0 {
        let mut before = simd.splat_u64s(0);
        for &value in &values[..count] {
            let less = simd.less_than_f64s(simd.splat_f64s(value), own);
            before = add_where_u64s(simd, less, before, one);
        }
        let within = simd.less_than_or_equal_u64s(before, nth);
        found = simd.select_f64s(within, simd.max_f64s(found, own), found);
    }
    simd.reduce_max_f64s(found)
}

impl List {
    /// For so many models.
    pub(super) fn new(models: usize) -> Self {
        let records = vec![[[0.0; PANEL]; SPAN]; models.div_ceil(PANEL)];
        Self { models: Vec::new(), paths: Vec::new(), records, ends: Vec::new() }
    }

    /// The models on the list, ascending.
    pub(super) fn models(&self) -> &[u32] {
        &self.models
    }

    /// How many models come before the one at `at` on the list, after each feature of the span; equal sums are ordered
    /// by model. If they are `looks` or more, there may be others.
    #[inline(always)]
    pub(super) fn before<S: Simd>(&self, simd: S, at: usize) -> [u64; SPAN] {
        let mut before = [0; SPAN];
        let (sums, _) = S::as_simd_f64s(self.paths.as_flattened());
        let (counts, _) = S::as_mut_simd_u64s(&mut before);
        let vectors = counts.len();
        let (lower, higher) = sums.split_at(at * vectors);
        let (own, higher) = higher.split_at(vectors);
        // Were it known to be one, masks would be made numbers to be subtracted: one instruction more.
        let one = simd.splat_u64s(black_box(1));
        for (nth, (&own, before)) in own.iter().zip(counts).enumerate() {
            let mut count = simd.splat_u64s(0);
            for &sum in lower.iter().skip(nth).step_by(vectors) {
                let earlier = simd.less_than_or_equal_f64s(sum, own);
                count = add_where_u64s(simd, earlier, count, one);
            }
            for &sum in higher.iter().skip(nth).step_by(vectors) {
                let earlier = simd.less_than_f64s(sum, own);
                count = add_where_u64s(simd, earlier, count, one);
            }
            *before = count;
        }
        before
    }
}

impl Panel {
    /// Takes the sums through a span.
    #[inline(always)]
    fn add<S: Simd, T: Term>(&mut self, simd: S, sums: &mut [f64; PANEL], asked: &[f64], features: &Record) {
        let (sums, _) = S::as_mut_simd_f64s(sums);
        for (nth, place) in sums.iter_mut().enumerate() {
            let mut sum = *place;
            for (&asked, others) in asked.iter().zip(features) {
                sum = simd.add_f64s(sum, T::terms(simd, simd.splat_f64s(asked), S::as_simd_f64s(others).0[nth]));
            }
            *place = sum;
        }
        self.through += asked.len();
    }

    /// The same, keeping the sums after each feature.
    #[inline(always)]
    fn record<S: Simd, T: Term>(
        &mut self,
        simd: S,
        sums: &mut [f64; PANEL],
        asked: &[f64],
        features: &Record,
        record: &mut Record,
    ) {
        let (sums, _) = S::as_mut_simd_f64s(sums);
        for (nth, place) in sums.iter_mut().enumerate() {
            let mut sum = *place;
            for ((&asked, others), record) in asked.iter().zip(features).zip(&mut *record) {
                sum = simd.add_f64s(sum, T::terms(simd, simd.splat_f64s(asked), S::as_simd_f64s(others).0[nth]));
                S::as_mut_simd_f64s(record).0[nth] = sum;
            }
            *place = sum;
        }
        self.through += asked.len();
    }
}

#[inline(always)]
fn least<S: Simd>(simd: S, sums: &[f64; PANEL]) -> f64 {
    let mut least = simd.splat_f64s(f64::INFINITY);
    for &sums in S::as_simd_f64s(sums).0 {
        least = simd.min_f64s(least, sums);
    }
    simd.reduce_min_f64s(least)
}

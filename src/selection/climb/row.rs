//! What is known of one model under the selection.

use std::{iter::once, sync::OnceLock};

use super::{judge::Judge, order::ascending, single::of_relative};
use crate::metrics::before;

/// Strangers that are kept in order.
pub(super) const NEAR: usize = 48;

/// One model under the selection.
#[derive(Clone)]
pub(super) struct Row {
    /// Distance sums to all models; infinite for itself and for the padding.
    pub(super) sums: Vec<f64>,
    /// The nearest models of other classes, up to [`NEAR`], nearest first.
    pub(super) near: Vec<(f64, u32)>,
    /// The same in single precision, as are all distances of a
    /// [`Sketch`](super::sketch::Sketch).
    pub(super) strangers: Vec<(f32, u32)>,
    /// The other models of its class in single precision.
    pub(super) kin: Vec<(f32, u32)>,
    /// The other models of other classes, in any order, once they are looked at.
    far: OnceLock<Vec<(f64, u32)>>,
    /// Its loss, roughly: it says whom to ask first.
    pub(super) loss: u64,
}

impl Row {
    /// For rows of `stride` sums; nothing is known yet.
    pub(super) fn new(stride: usize) -> Self {
        Self {
            sums: vec![0.0; stride],
            near: Vec::new(),
            strangers: Vec::new(),
            kin: Vec::new(),
            far: OnceLock::new(),
            loss: 1,
        }
    }

    /// Forgets all but the sums.
    pub(super) fn forget(&mut self) {
        self.near.clear();
        self.far.take();
        self.loss = 1;
    }

    /// The models of other classes than that of `model`, whose row it is, that are not in order.
    pub(super) fn far(&self, model: usize, judge: &Judge<'_>) -> &[(f64, u32)] {
        let Some(&last) = self.near.get(NEAR - 1) else { return &[] };
        self.far.get_or_init(|| {
            let models = (0..).zip(judge.labels()).zip(&self.sums);
            let strangers = models.filter(|((_, label), _)| **label != judge.label(model));
            strangers.map(|((other, _), &sum)| (sum, other)).filter(|&other| before(last, other)).collect()
        })
    }

    /// The models of other classes that are in order, and then those of `far`, in chunks of `size`, each with a
    /// distance that none in it or after it is below. The last chunk is empty: it stands for those that are left.
    #[inline(always)]
    pub(super) fn chunks<'a>(
        &'a self,
        far: &'a [(f64, u32)],
        size: usize,
    ) -> impl Iterator<Item = (f64, &'a [(f64, u32)])> {
        let beyond = self.near.last().map_or(0.0, |last| last.0);
        let near = self.near.chunks(size).map(|chunk| (chunk[0].0, chunk));
        let (far, left) = (far.chunks(size).map(move |chunk| (beyond, chunk)), once((beyond, &[][..])));
        near.chain(far).chain(left)
    }

    /// Puts the strangers of `model` in order by the sums as they are now, and works out its loss.
    pub(super) fn update(&mut self, model: usize, judge: &Judge<'_>) {
        // As many as have to be in order are within this: those that were.
        let sums = &self.sums;
        let reach = match self.near.len() {
            NEAR => self.near.iter().fold(0.0, |reach, &(_, other)| sums[other as usize].max(reach)),
            _ => f64::INFINITY,
        };
        self.far.take();
        // Written always and counted where it belongs: a branch could not be foreseen.
        self.near.resize(sums.len(), (0.0, 0));
        let (label, mut count) = (judge.label(model), 0);
        for ((other, &of), &sum) in (0..).zip(judge.labels()).zip(sums) {
            self.near[count] = (sum, other);
            count += usize::from(of != label) & usize::from(sum <= reach);
        }
        self.near.truncate(count);
        if count > 2 * NEAR {
            // Sums are not negative, so that their bits are in their order.
            self.near.select_nth_unstable_by_key(NEAR, |&(sum, other)| (sum.to_bits(), other));
            self.near.truncate(NEAR);
            self.near.sort_unstable_by_key(|&(_, other)| other);
        }
        let order = ascending(self.near.len(), |at| self.near[at].0);
        self.near = order.into_iter().take(NEAR).map(|at| self.near[at as usize]).collect();
        self.strangers.clear();
        self.strangers.extend(self.near.iter().map(|&(sum, other)| (sum as f32, other)));
        let relatives = judge.class(model).iter().filter(|&&other| other as usize != model);
        self.kin.clear();
        self.kin.extend(relatives.clone().map(|&other| (of_relative(sums[other as usize]), other)));
        let mut relatives: Vec<f64> = relatives.map(|&other| sums[other as usize]).collect();
        relatives.sort_unstable_by(f64::total_cmp);
        let (credits, whole) = judge.rough_credits(model);
        let (mut before, mut gained) = (0, 0);
        for (nth, &relative) in relatives.iter().enumerate() {
            while self.near.get(before).is_some_and(|stranger| stranger.0 < relative) {
                before += 1;
            }
            gained += credits.get(nth + before).copied().unwrap_or(0);
        }
        self.loss = u64::from(whole.saturating_sub(gained));
    }
}

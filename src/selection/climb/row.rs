//! What is known of one model under the selection.

use super::{judge::Judge, order::ascending};

/// Strangers that are kept in order.
pub(super) const NEAR: usize = 48;

/// One model under the selection.
#[derive(Clone)]
pub(super) struct Row {
    /// Distance sums to all models; infinite for itself and for the padding.
    pub(super) sums: Vec<f64>,
    /// The nearest models of other classes, up to [`NEAR`], nearest first.
    pub(super) near: Vec<(f64, u32)>,
    /// The other models of other classes, in any order.
    far: Vec<(f64, u32)>,
    /// Its loss, roughly: it says whom to ask first.
    pub(super) loss: u64,
}

impl Row {
    /// For rows of `stride` sums; nothing is known yet.
    pub(super) fn new(stride: usize) -> Self {
        Self { sums: vec![0.0; stride], near: Vec::new(), far: Vec::new(), loss: 0 }
    }

    /// How many models of other classes there are.
    pub(super) fn strangers(&self) -> usize {
        self.near.len() + self.far.len()
    }

    /// The models of other classes in chunks of `size`, each with a distance that none in it or after it is below.
    #[inline(always)]
    pub(super) fn chunks(&self, size: usize) -> impl Iterator<Item = (f64, &[(f64, u32)])> {
        let beyond = self.near.last().map_or(0.0, |last| last.0);
        let near = self.near.chunks(size).map(|chunk| (chunk[0].0, chunk));
        near.chain(self.far.chunks(size).map(move |chunk| (beyond, chunk)))
    }

    /// Puts the strangers of `model` in order by the sums as they are now, and works out its loss.
    pub(super) fn update(&mut self, model: usize, judge: &Judge<'_>) {
        // As many as have to be in order are within this: those that were.
        let sums = &self.sums;
        let reach = match self.near.len() {
            NEAR => self.near.iter().fold(0.0, |reach, &(_, other)| sums[other as usize].max(reach)),
            _ => f64::INFINITY,
        };
        // Written always and counted where it belongs: a branch could not be foreseen.
        self.near.resize(sums.len(), (0.0, 0));
        self.far.resize(sums.len(), (0.0, 0));
        let (label, mut near, mut far) = (judge.label(model), 0, 0);
        for ((other, &of), &sum) in (0..).zip(judge.labels()).zip(sums) {
            (self.near[near], self.far[far]) = ((sum, other), (sum, other));
            let (stranger, within) = (usize::from(of != label), usize::from(sum <= reach));
            near += stranger & within;
            far += stranger & (1 - within);
        }
        self.near.truncate(near);
        self.far.truncate(far);
        if near > 2 * NEAR {
            // Sums are not negative, so that their bits are in their order.
            self.near.select_nth_unstable_by_key(NEAR, |&(sum, other)| (sum.to_bits(), other));
            self.far.extend(self.near.drain(NEAR..));
            self.near.sort_unstable_by_key(|&(_, other)| other);
        }
        let order = ascending(self.near.len(), |at| self.near[at].0);
        let ordered: Vec<_> = order.into_iter().map(|at| self.near[at as usize]).collect();
        let (near, others) = ordered.split_at(NEAR.min(ordered.len()));
        self.near.clear();
        self.near.extend_from_slice(near);
        self.far.extend_from_slice(others);
        let relatives = judge.class(model).iter().filter(|&&other| other as usize != model);
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

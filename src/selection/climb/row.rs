//! What is known of one model under the selection.

use super::judge::Judge;

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
        self.near.clear();
        self.far.clear();
        for (other, &sum) in (0..judge.models()).zip(sums).filter(|&(other, _)| !judge.related(model, other)) {
            if sum <= reach { &mut self.near } else { &mut self.far }.push((sum, other));
        }
        // Sums are not negative, so that their bits are in their order.
        let order = |entry: &(f64, u32)| (entry.0.to_bits(), entry.1);
        if self.near.len() > NEAR {
            self.near.select_nth_unstable_by_key(NEAR, order);
            self.far.extend(self.near.drain(NEAR..));
        }
        self.near.sort_unstable_by_key(order);
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

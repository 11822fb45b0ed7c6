//! Several candidates at once, one in each lane of a vector.
//!
//! What a candidate costs a model asked follows from how many strangers (models of other classes) come before each of
//! its relatives (models of its class). Strangers are looked at by their distance without the candidate, which no
//! candidate makes smaller: once that is beyond the farthest relative that still matters, no more need be.
//!
//! Lanes know distances but not models, so that pairs at equal distance are settled for the whole block: in favour of
//! the relatives, which gives the [`LEAST`] loss, or in favour of the strangers, which gives the [`MOST`]. Where both
//! are the same, that is the loss.

use std::hint::black_box;

use pulp::Simd;

use super::{Cost, judge::Judge, row::Row};
use crate::metrics::{Columns, Term, add_where_u64s};

/// Of a stranger and a relative at equal distance, the relative comes first.
pub(super) const LEAST: bool = true;
/// Of a stranger and a relative at equal distance, the stranger comes first.
pub(super) const MOST: bool = false;

/// The lanes of the widest vector.
pub(super) const LANES: usize = 8;
/// Strangers counted in one go.
const CHUNK: usize = 8;

/// A loss for each lane, in [`Judge::unit`]s.
pub(super) type Losses = [u64; LANES];

/// The features of as many candidates as a vector has lanes, side by side.
pub(super) struct Block<S: Simd> {
    /// By model.
    values: Vec<S::f64s>,
    /// The distances of the relatives of the model asked; ascending in each lane once they are sorted.
    relatives: Vec<S::f64s>,
    /// How many strangers come before each of them, as far as they have been counted.
    before: Vec<S::u64s>,
}

impl<S: Simd> Block<S> {
    /// For the features `indices` (from 1), at most as many as there are lanes.
    #[inline(always)]
    pub(super) fn new(columns: &Columns, indices: &[u32], models: usize) -> Self {
        let values = side_by_side(columns, indices, S::F64_LANES, models);
        Self { values: S::as_simd_f64s(&values).0.to_vec(), relatives: Vec::new(), before: Vec::new() }
    }

    /// The losses of one model asked under each of the candidates, when of the strangers only those in order are looked
    /// at or, if `all`, the others, too. True when that was enough to know them; otherwise they are at least so much.
    #[inline(always)]
    pub(super) fn losses<T: Term, const TIES: bool>(
        &mut self,
        simd: S,
        asked: usize,
        row: &Row,
        judge: &Judge<'_>,
        all: bool,
    ) -> (Losses, bool) {
        self.relatives.clear();
        for &model in judge.class(asked) {
            if model as usize != asked {
                self.relatives.push(self.sums::<T>(simd, asked, (row.sums[model as usize], model)));
            }
        }
        let strangers = judge.models() - judge.class(asked).len();
        let (mut far, mut again): (&[_], _) = (&[], all);
        loop {
            let whole = row.near.len() + far.len() == strangers;
            let found = match judge.cost() {
                Cost::Error => self.errors::<T, TIES>(simd, asked, row.chunks(far, 1), whole),
                Cost::Adr => self.recall::<T, TIES>(simd, asked, judge, row.chunks(far, CHUNK), whole),
            };
            if found.1 || !again {
                return found;
            }
            (far, again) = (row.far(asked, judge), false);
        }
    }

    /// The distances to a model that is `sum` away without the candidates.
    #[inline(always)]
    fn sums<T: Term>(&self, simd: S, asked: usize, (sum, model): (f64, u32)) -> S::f64s {
        simd.add_f64s(simd.splat_f64s(sum), T::terms(simd, self.values[asked], self.values[model as usize]))
    }

    /// A loss of 1 where a stranger comes before the nearest relative.
    #[inline(always)]
    fn errors<'a, T: Term, const TIES: bool>(
        &self,
        simd: S,
        asked: usize,
        strangers: impl Iterator<Item = (f64, &'a [(f64, u32)])>,
        whole: bool,
    ) -> (Losses, bool) {
        let nearest = simd.splat_f64s(f64::INFINITY);
        let nearest = self.relatives.iter().fold(nearest, |nearest, &sums| simd.min_f64s(nearest, sums));
        let reach = simd.reduce_max_f64s(nearest);
        // Without relatives or strangers nothing right is there to be found.
        let mut right = simd.less_than_f64s(nearest, simd.splat_f64s(f64::INFINITY));
        let mut sure = whole;
        for (from, chunk) in strangers {
            if from > reach || none::<S>(simd, right) {
                sure = true;
                break;
            }
            for &stranger in chunk {
                let sums = self.sums::<T>(simd, asked, stranger);
                let behind = if TIES == LEAST {
                    simd.less_than_or_equal_f64s(nearest, sums)
                } else {
                    simd.less_than_f64s(nearest, sums)
                };
                right = simd.and_m64s(right, behind);
            }
        }
        let wrong = [simd.select_u64s(right, simd.splat_u64s(0), simd.splat_u64s(1))];
        let mut losses = [0; LANES];
        for (loss, &wrong) in losses.iter_mut().zip(lanes::<S>(&wrong)) {
            *loss = wrong;
        }
        (losses, sure)
    }

    /// What the ADR lacks of 1.
    #[inline(always)]
    fn recall<'a, T: Term, const TIES: bool>(
        &mut self,
        simd: S,
        asked: usize,
        judge: &Judge<'_>,
        strangers: impl Iterator<Item = (f64, &'a [(f64, u32)])>,
        whole: bool,
    ) -> (Losses, bool) {
        if self.relatives.is_empty() {
            return ([0; LANES], true);
        }
        self.sort(simd, judge.network(asked));
        let (live, sure) = self.count::<T, TIES>(simd, asked, strangers);
        let sure = sure || whole;
        let (weights, whole) = judge.credits(asked);
        let mut losses = [whole; LANES];
        for (nth, before) in self.before[..live].iter().enumerate() {
            for (loss, &before) in losses.iter_mut().zip(lanes::<S>(std::slice::from_ref(before))) {
                // Credits are rounded up where units are coarse, so all of them may be more than the whole.
                *loss = loss.saturating_sub(weights.get(nth + before as usize).copied().unwrap_or(0));
            }
        }
        (losses, sure)
    }

    /// Sorts the relatives of every lane by a sorting network.
    #[inline(always)]
    fn sort(&mut self, simd: S, network: &[(u32, u32)]) {
        for &(a, b) in network {
            let (low, high) = (self.relatives[a as usize], self.relatives[b as usize]);
            self.relatives[a as usize] = simd.min_f64s(low, high);
            self.relatives[b as usize] = simd.max_f64s(low, high);
        }
    }

    /// Counts, for each relative, the strangers before it. Returns how many of the nearest relatives are among the
    /// first Q of any lane, and false when there may be strangers before them that were not among those counted.
    #[inline(always)]
    fn count<'a, T: Term, const TIES: bool>(
        &mut self,
        simd: S,
        asked: usize,
        chunks: impl Iterator<Item = (f64, &'a [(f64, u32)])>,
    ) -> (usize, bool) {
        let count = self.relatives.len();
        self.before.clear();
        self.before.resize(count, simd.splat_u64s(0));
        // The relatives before `first` are nearer than any stranger left.
        let (mut first, mut live) = (0, count);
        let one = simd.splat_u64s(black_box(1));
        for (from, chunk) in chunks {
            while live > 0 && none::<S>(simd, self.matter(simd, live - 1)) {
                live -= 1;
            }
            let near = simd.splat_f64s(from);
            while first < live && none::<S>(simd, simd.greater_than_or_equal_f64s(self.relatives[first], near)) {
                first += 1;
            }
            if first == live {
                return (live, true);
            }
            let mut strangers = [simd.splat_f64s(f64::INFINITY); CHUNK];
            for (sums, &stranger) in strangers.iter_mut().zip(chunk) {
                *sums = self.sums::<T>(simd, asked, stranger);
            }
            for (before, &relative) in self.before[first..live].iter_mut().zip(&self.relatives[first..live]) {
                for &stranger in &strangers {
                    let first = if TIES == LEAST {
                        simd.less_than_f64s(stranger, relative)
                    } else {
                        simd.less_than_or_equal_f64s(stranger, relative)
                    };
                    *before = add_where_u64s(simd, first, *before, one);
                }
            }
        }
        (live, false)
    }

    /// The lanes in which the relative at `at` is still among the first Q.
    #[inline(always)]
    fn matter(&self, simd: S, at: usize) -> S::m64s {
        simd.less_than_u64s(self.before[at], simd.splat_u64s((self.relatives.len() - at) as u64))
    }
}

/// The features `indices` (from 1) of all models, model by model in so many lanes. Lanes left over repeat the last one.
pub(super) fn side_by_side(columns: &Columns, indices: &[u32], lanes: usize, models: usize) -> Vec<f64> {
    let mut values = vec![0.0; lanes * models];
    for lane in 0..lanes {
        let column = columns.col(indices[lane.min(indices.len() - 1)] as usize - 1);
        for (value, &of_model) in values[lane..].iter_mut().step_by(lanes).zip(column) {
            *value = of_model;
        }
    }
    values
}

#[inline(always)]
fn none<S: Simd>(simd: S, mask: S::m64s) -> bool {
    simd.first_true_m64s(mask) == S::F64_LANES
}

#[inline(always)]
fn lanes<S: Simd>(vectors: &[S::u64s]) -> &[u64] {
    bytemuck::cast_slice(vectors)
}

/// The exchanges of Batcher's odd-even merge sort for `count` entries: `(a, b)` with a < b, the lesser goes to a.
pub(super) fn network(count: usize) -> Vec<(u32, u32)> {
    let mut exchanges = Vec::new();
    let mut sorted = 1;
    while sorted < count {
        let mut apart = sorted;
        while apart >= 1 {
            for start in (apart % sorted..count.saturating_sub(apart)).step_by(2 * apart) {
                for a in start..(start + apart).min(count - apart) {
                    if a / (2 * sorted) == (a + apart) / (2 * sorted) {
                        exchanges.push((a as u32, (a + apart) as u32));
                    }
                }
            }
            apart /= 2;
        }
        sorted *= 2;
    }
    exchanges
}

#[cfg(test)]
mod tests {
    use super::network;

    #[test]
    fn networks_sort() {
        // A network that sorts all sequences of zeros and ones sorts everything.
        for count in 0..=14_usize {
            let network = network(count);
            for bits in 0..1_u32 << count {
                let mut values: Vec<u32> = (0..count).map(|at| bits >> at & 1).collect();
                for &(a, b) in &network {
                    if values[a as usize] > values[b as usize] {
                        values.swap(a as usize, b as usize);
                    }
                }
                assert!(values.is_sorted(), "{count}");
            }
        }
    }
}

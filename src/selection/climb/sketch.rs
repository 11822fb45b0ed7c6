//! Many candidates at once, roughly: twice as many as a [`Block`](super::block::Block) holds.
//!
//! Distances are computed as they are and then cut to the upper half of their bits. As integers these are in the order
//! of the distances, which are not negative: what is less when cut was less before. A stranger is counted before a
//! relative only when it is less when cut, so that the losses are those of [`LEAST`](super::block::LEAST) or a little
//! less: never more than the true ones. That is enough to give up on nearly all candidates.

use std::hint::black_box;

use pulp::{Simd, bytemuck::cast};

use super::{Cost, block::side_by_side, judge::Judge, row::Row};
use crate::metrics::{Columns, Term, add_where_u32s};

/// The lanes of the widest vector.
pub(super) const LANES: usize = 16;
/// Entries of a table of [`Judge::rough_credits`]: more than there can be relatives and strangers before one.
pub(super) const RANKS: usize = 256;
/// Strangers counted in one go.
const CHUNK: usize = 8;

/// A loss for each lane, in [`Judge::rough_unit`]s.
pub(super) type Losses = [u64; LANES];

/// The features of as many candidates as two vectors have lanes.
pub(super) struct Sketch<S: Simd> {
    /// By model. The first vector's candidates are in the odd lanes of what is cut, the second's in the even ones.
    values: Vec<[S::f64s; 2]>,
    odd: S::m32s,
    relatives: Vec<S::u32s>,
    before: Vec<S::u32s>,
}

impl<S: Simd> Sketch<S> {
    /// Whether the lanes of this machine can be halved, and the classes are small enough.
    pub(super) fn fits(judge: &Judge<'_>) -> bool {
        S::F32_LANES == 2 * S::F64_LANES && cfg!(target_endian = "little") && judge.fits_tables()
    }

    /// For the features `indices` (from 1), at most as many as there are lanes.
    #[inline(always)]
    pub(super) fn new(simd: S, columns: &Columns, indices: &[u32], models: usize) -> Self {
        let values = side_by_side(columns, indices, 2 * S::F64_LANES, models);
        let (vectors, _) = S::as_simd_f64s(&values);
        let (pairs, _) = vectors.as_chunks::<2>();
        let parity: Vec<u32> = (0..S::F32_LANES as u32).map(|lane| lane % 2).collect();
        let odd = simd.equal_u32s(simd.partial_load_u32s(&parity), simd.splat_u32s(1));
        Self { values: pairs.to_vec(), odd, relatives: Vec::new(), before: Vec::new() }
    }

    /// The lane of the candidate at `at`.
    #[inline(always)]
    pub(super) const fn lane(at: usize) -> usize {
        let half = S::F64_LANES;
        if at < half { 2 * at + 1 } else { 2 * (at - half) }
    }

    /// The loss of each candidate.
    #[inline(always)]
    pub(super) fn by_candidate(losses: &Losses) -> impl Iterator<Item = u64> {
        (0..2 * S::F64_LANES).map(move |at| losses[Self::lane(at)])
    }

    /// Adds what one model asked loses at least under each of the candidates.
    #[inline(always)]
    pub(super) fn add_losses<T: Term>(
        &mut self,
        simd: S,
        asked: usize,
        row: &Row,
        judge: &Judge<'_>,
        losses: &mut Losses,
    ) {
        self.relatives.clear();
        for &model in judge.class(asked) {
            if model as usize != asked {
                self.relatives.push(self.cut::<T>(simd, asked, (row.sums[model as usize], model)));
            }
        }
        if self.relatives.is_empty() {
            // Nothing right is there to be found, or nothing to be lost.
            let lost = u64::from(judge.cost() == Cost::Error);
            for loss in losses {
                *loss += lost;
            }
            return;
        }
        if judge.cost() == Cost::Error {
            // The nearest alone matters.
            let mut nearest = self.relatives[0];
            for &sums in &self.relatives[1..] {
                nearest = simd.min_u32s(nearest, sums);
            }
            self.relatives.clear();
            self.relatives.push(nearest);
        } else {
            for &(a, b) in judge.network(asked) {
                let (low, high) = (self.relatives[a as usize], self.relatives[b as usize]);
                self.relatives[a as usize] = simd.min_u32s(low, high);
                self.relatives[b as usize] = simd.max_u32s(low, high);
            }
        }
        let live = self.count::<T>(simd, asked, row);
        let ((credits, whole), filled) = (judge.rough_credits(asked), judge.class(asked).len());
        let mut gained = simd.splat_u32s(0);
        for (nth, &before) in (0..).zip(&self.before[..live]) {
            let rank = simd.add_u32s(before, simd.splat_u32s(nth));
            gained = simd.add_u32s(gained, look_up(simd, credits, rank, filled));
        }
        let gained: &[u32] = pulp::bytemuck::cast_slice(std::slice::from_ref(&gained));
        for (loss, &gained) in losses.iter_mut().zip(gained) {
            // Credits are rounded up, so all of them may be more than the whole.
            *loss += u64::from(whole.saturating_sub(gained));
        }
    }

    /// The distances to a model that is `sum` away without the candidates, cut.
    #[inline(always)]
    fn cut<T: Term>(&self, simd: S, asked: usize, (sum, model): (f64, u32)) -> S::u32s {
        let sum = simd.splat_f64s(sum);
        let ([a, b], [c, d]) = (self.values[asked], self.values[model as usize]);
        let one = as_u32s(simd, simd.add_f64s(sum, T::terms(simd, a, c)));
        let two = as_u32s(simd, simd.add_f64s(sum, T::terms(simd, b, d)));
        simd.select_u32s(self.odd, one, simd.rotate_left_u32s(two, 1))
    }

    /// Counts, for each relative, the strangers before it. Returns how many of the nearest relatives are among the
    /// first Q of any lane.
    #[inline(always)]
    fn count<T: Term>(&mut self, simd: S, asked: usize, row: &Row) -> usize {
        let count = self.relatives.len();
        self.before.clear();
        self.before.resize(count, simd.splat_u32s(0));
        // Were it known to be one, masks would be made numbers to be subtracted: one instruction more.
        let one = simd.splat_u32s(black_box(1));
        // The relatives before `first` are nearer than any stranger left.
        let (mut first, mut live) = (0, count);
        for chunk in row.near.chunks(CHUNK) {
            while live > 0 && none::<S>(simd, self.matter(simd, live - 1)) {
                live -= 1;
            }
            let near = simd.splat_u32s((chunk[0].0.to_bits() >> 32) as u32);
            while first < live && none::<S>(simd, simd.greater_than_or_equal_u32s(self.relatives[first], near)) {
                first += 1;
            }
            if first == live {
                return live;
            }
            let mut strangers = [simd.splat_u32s(u32::MAX); CHUNK];
            for (sums, &stranger) in strangers.iter_mut().zip(chunk) {
                *sums = self.cut::<T>(simd, asked, stranger);
            }
            for (before, &relative) in self.before[first..live].iter_mut().zip(&self.relatives[first..live]) {
                let mut count = *before;
                for &stranger in &strangers {
                    let less = simd.less_than_u32s(stranger, relative);
                    count = add_where_u32s(simd, less, count, one);
                }
                *before = count;
            }
        }
        live
    }

    /// The lanes in which the relative at `at` is still among the first Q.
    #[inline(always)]
    fn matter(&self, simd: S, at: usize) -> S::m32s {
        simd.less_than_u32s(self.before[at], simd.splat_u32s((self.relatives.len() - at) as u32))
    }
}

/// The entries of a table that is 0 from the entry `filled` on.
#[inline(always)]
fn look_up<S: Simd>(simd: S, table: &[u32; RANKS], at: S::u32s, filled: usize) -> S::u32s {
    debug_assert!(filled <= RANKS, "the table ends before");
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    if let Some(v4) = (&simd as &dyn std::any::Any).downcast_ref::<pulp::x86::V4>()
        && filled < 32
    {
        // Two registers hold what there is, and a 0 at the end for all beyond.
        let (low, high) = S::as_simd_u32s(&table[..32]).0.split_at(1);
        let at = simd.min_u32s(at, simd.splat_u32s(31));
        let found = v4.avx512f._mm512_permutex2var_epi32(cast(low[0]), cast(at), cast(high[0]));
        return cast(found);
    }
    let places: &[u32] = pulp::bytemuck::cast_slice(std::slice::from_ref(&at));
    let mut found = [0; LANES];
    for (found, &place) in found.iter_mut().zip(places) {
        *found = table[place as usize % RANKS];
    }
    simd.partial_load_u32s(&found[..S::U32_LANES])
}

/// The same bits.
#[inline(always)]
fn as_u32s<S: Simd>(simd: S, a: S::f64s) -> S::u32s {
    cast(simd.transmute_u64s_f64s(a))
}

#[inline(always)]
fn none<S: Simd>(simd: S, mask: S::m32s) -> bool {
    simd.first_true_m32s(mask) == S::F32_LANES
}

#[cfg(test)]
mod tests {
    use pulp::{Simd, WithSimd};

    use super::{LANES, RANKS, look_up};

    /// How many entries differ from the table's when all are looked up, lanes in no order.
    struct Wrong<'a>(&'a [u32; RANKS], usize);

    impl WithSimd for Wrong<'_> {
        type Output = usize;

        fn with_simd<S: Simd>(self, simd: S) -> usize {
            let Self(table, filled) = self;
            let places: Vec<u32> = (0..RANKS as u32).map(|at| at * 91 % RANKS as u32).collect();
            let found = |places: &[u32]| {
                let found = look_up(simd, table, simd.partial_load_u32s(places), filled);
                pulp::bytemuck::cast_slice::<_, u32>(&[found]).to_vec()
            };
            let found = places.chunks(LANES.min(S::U32_LANES)).flat_map(found);
            found.zip(&places).filter(|&(found, &place)| found != table[place as usize]).count()
        }
    }

    #[test]
    fn every_entry_is_found() {
        for filled in [0, 1, 14, 16, 17, 31, 32, 33, 200] {
            let mut table = [0; RANKS];
            table[..filled].iter_mut().zip(7..).for_each(|(entry, value)| *entry = value);
            assert_eq!(pulp::Arch::new().dispatch(Wrong(&table, filled)), 0, "{filled}");
            assert_eq!(Wrong(&table, filled).with_simd(pulp::Scalar::new()), 0, "{filled}");
        }
    }
}

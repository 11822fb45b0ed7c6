//! Many candidates at once, roughly: twice as many as a [`Block`](super::block::Block) holds.
//!
//! Distances are computed in single precision. A stranger is counted before a relative only when it is nearer by more
//! than both may be [off](Singles::margin), so that the losses are those of [`LEAST`](super::block::LEAST) or a little
//! less: never more than the true ones. That is enough to give up on nearly all candidates.
//!
//! A removal takes a term from a sum instead of adding one. What is left may be off relatively to all of the sum.

use std::hint::black_box;

use pulp::{Simd, bytemuck::cast};

use super::{
    Cost,
    judge::Judge,
    row::Row,
    single::{LENGTHENED, SHORTENED, Singles},
};
use crate::metrics::{Term, add_where_u32s};

/// The lanes of the widest vector.
pub(super) const LANES: usize = 16;
/// Entries of a table of [`Judge::rough_credits`]: more than there can be relatives and strangers before one.
pub(super) const RANKS: usize = 256;
/// Strangers counted in one go.
const CHUNK: usize = 12;

/// A loss for each lane, in [`Judge::rough_unit`]s.
pub(super) type Losses = [u64; LANES];

/// The features of as many candidates as a vector has lanes.
pub(super) struct Sketch<S: Simd> {
    /// By model.
    values: Vec<S::f32s>,
    margins: S::f32s,
    /// The distances of the relatives of the model asked, shortened and less the margins.
    relatives: [S::f32s; RANKS],
    /// How many strangers come before each of them, as far as they have been counted.
    before: [S::u32s; RANKS],
}

impl<S: Simd> Sketch<S> {
    /// Whether a vector holds more candidates than a block's, and the classes are small enough.
    pub(super) fn fits(judge: &Judge<'_>) -> bool {
        S::F32_LANES > S::F64_LANES && judge.fits_tables()
    }

    /// For the features `indices` (from 1), at most as many as there are lanes.
    #[inline(always)]
    pub(super) fn new(simd: S, singles: &Singles, indices: &[u32]) -> Self {
        let values = singles.side_by_side(indices, S::F32_LANES);
        let mut margins = [f32::MAX; LANES];
        for (margin, &index) in margins.iter_mut().zip(indices) {
            *margin = singles.margin(index);
        }
        Self {
            values: S::as_simd_f32s(&values).0.to_vec(),
            margins: simd.partial_load_f32s(&margins[..S::F32_LANES]),
            relatives: [simd.splat_f32s(0.0); RANKS],
            before: [simd.splat_u32s(0); RANKS],
        }
    }

    /// Adds what one model asked loses at least under each of the candidates.
    #[inline(always)]
    pub(super) fn add_losses<T: Term, const ADDED: bool>(
        &mut self,
        simd: S,
        asked: usize,
        row: &Row,
        judge: &Judge<'_>,
        losses: &mut Losses,
    ) {
        let mut count = row.kin.len();
        if count == 0 {
            // Nothing right is there to be found, or nothing to be lost.
            let lost = u64::from(judge.cost() == Cost::Error);
            for loss in losses {
                *loss += lost;
            }
            return;
        }
        let (own, shortened) = (self.values[asked], simd.splat_f32s(SHORTENED));
        for (relative, &kin) in self.relatives.iter_mut().zip(&row.kin) {
            let sum = simd.splat_f32s(kin.0);
            let term = T::single_terms(simd, own, self.values[kin.1 as usize]);
            let sums = if ADDED {
                simd.mul_f32s(simd.add_f32s(sum, term), shortened)
            } else {
                simd.sub_f32s(simd.mul_f32s(sum, shortened), term)
            };
            *relative = simd.sub_f32s(sums, self.margins);
        }
        if judge.cost() == Cost::Error {
            // The nearest alone matters.
            for at in 1..count {
                self.relatives[0] = simd.min_f32s(self.relatives[0], self.relatives[at % RANKS]);
            }
            count = 1;
        } else {
            for &(a, b) in judge.network(asked) {
                let (a, b) = (a as usize % RANKS, b as usize % RANKS);
                let (low, high) = (self.relatives[a], self.relatives[b]);
                self.relatives[a] = simd.min_f32s(low, high);
                self.relatives[b] = simd.max_f32s(low, high);
            }
        }
        let live = self.count::<T, ADDED>(simd, own, row, count);
        let ((credits, whole), filled) = (judge.rough_credits(asked), judge.class(asked).len());
        let mut gained = simd.splat_u32s(0);
        for (nth, &before) in (0..).zip(&self.before[..live]) {
            let rank = simd.add_u32s(before, simd.splat_u32s(nth));
            gained = simd.add_u32s(gained, look_up(simd, credits, rank, filled));
        }
        let gained: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&gained));
        for (loss, &gained) in losses.iter_mut().zip(gained) {
            // Credits are rounded up, so all of them may be more than the whole.
            *loss += u64::from(whole.saturating_sub(gained));
        }
    }

    /// Counts, for each of `count` relatives, the strangers before it. Returns how many of the nearest relatives are
    /// among the first Q of any lane.
    #[inline(always)]
    fn count<T: Term, const ADDED: bool>(&mut self, simd: S, own: S::f32s, row: &Row, count: usize) -> usize {
        let Self { values, relatives, before, .. } = self;
        let (relatives, before) = (&relatives[..count], &mut before[..count]);
        before.fill(simd.splat_u32s(0));
        // Were it known to be one, masks would be made numbers to be subtracted: one instruction more.
        let one = simd.splat_u32s(black_box(1));
        // The relatives before `first` are nearer than any stranger left.
        let (mut first, mut live) = (0, count);
        for chunk in row.strangers.chunks(CHUNK) {
            while live > 0 && none::<S>(simd, matter(simd, before[live - 1], count - live + 1)) {
                live -= 1;
            }
            // A removal may bring strangers as near as can be.
            let near = simd.splat_f32s(if ADDED { chunk[0].0 } else { f32::NEG_INFINITY });
            while first < live && none::<S>(simd, simd.greater_than_or_equal_f32s(relatives[first], near)) {
                first += 1;
            }
            if first == live {
                return live;
            }
            let mut strangers = [simd.splat_f32s(f32::INFINITY); CHUNK];
            for (stranger, &of) in strangers.iter_mut().zip(chunk) {
                let term = T::single_terms(simd, own, values[of.1 as usize]);
                *stranger = if ADDED {
                    simd.add_f32s(simd.splat_f32s(of.0), term)
                } else {
                    simd.sub_f32s(simd.splat_f32s(of.0 * LENGTHENED), term)
                };
            }
            for (before, &relative) in before[first..live].iter_mut().zip(&relatives[first..live]) {
                let mut count = *before;
                for &stranger in &strangers {
                    count = add_where_u32s(simd, simd.less_than_f32s(stranger, relative), count, one);
                }
                *before = count;
            }
        }
        live
    }
}

/// The lanes in which a relative is still among the first Q, when those and itself that come no nearer are `rest`.
#[inline(always)]
fn matter<S: Simd>(simd: S, before: S::u32s, rest: usize) -> S::m32s {
    simd.less_than_u32s(before, simd.splat_u32s(rest as u32))
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
    let places: &[u32] = bytemuck::cast_slice(std::slice::from_ref(&at));
    let mut found = [0; LANES];
    for (found, &place) in found.iter_mut().zip(places) {
        *found = table[place as usize % RANKS];
    }
    simd.partial_load_u32s(&found[..S::U32_LANES])
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
                bytemuck::cast_slice::<_, u32>(&[found]).to_vec()
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

//! Several candidates at once, one in each lane of a vector.
//!
//! What a candidate costs a model asked follows from how many strangers (models of other classes) come before each of
//! its relatives (models of its class). Strangers are looked at by their distance without the candidate, which no
//! candidate makes smaller: once that is beyond the farthest relative that still matters, no more need be.

use pulp::Simd;

use super::{
    Cost,
    ground::{HEAD, Row},
    judge::Judge,
};
use crate::metrics::{Columns, Term};

/// Candidates in a block.
pub(super) const LANES: usize = 8;
/// Strangers counted in one go.
const CHUNK: usize = 8;

/// A number for each candidate of a block.
type Lanes = [f64; LANES];

/// A count for each candidate of a block.
type Counts = [u64; LANES];

/// The features of a few candidates, side by side.
pub(super) struct Block {
    /// By model.
    values: Vec<Lanes>,
    /// The relatives of the model asked that may still be among the first Q, ascending by model.
    relatives: Vec<u32>,
    /// Their distances.
    sums: Vec<Lanes>,
    /// How many models come before each of them, as far as they have been counted.
    before: Vec<Counts>,
    /// Distances of a chunk of strangers: as they are, and a little nearer.
    strangers: [[Lanes; CHUNK]; 2],
}

impl Block {
    /// For the features `indices` (from 1), at most [`LANES`]. Lanes left over repeat the last one.
    pub(super) fn new(columns: &Columns, indices: &[u32], models: usize) -> Self {
        let mut values = vec![[0.0; LANES]; models];
        for lane in 0..LANES {
            let index = indices[lane.min(indices.len() - 1)];
            for (values, &value) in values.iter_mut().zip(columns.col(index as usize - 1)) {
                values[lane] = value;
            }
        }
        let strangers = [[[0.0; LANES]; CHUNK]; 2];
        Self { values, relatives: Vec::new(), sums: Vec::new(), before: Vec::new(), strangers }
    }

    /// The losses of one model asked under each of the candidates, when at most `depth` strangers are looked at. True
    /// when that was enough to know them; otherwise they are at least so much.
    #[inline(always)]
    pub(super) fn losses<T: Term, S: Simd>(
        &mut self,
        simd: S,
        asked: usize,
        row: &Row,
        judge: &Judge<'_>,
        depth: usize,
    ) -> ([u128; LANES], bool) {
        self.relatives.clear();
        self.sums.clear();
        for &model in judge.class(asked) {
            if model as usize != asked {
                let mut sums = [0.0; LANES];
                set_sums::<T, S>(simd, &mut sums, &self.values, asked, (row.sums[model as usize], model));
                self.relatives.push(model);
                self.sums.push(sums);
            }
        }
        match judge.cost() {
            Cost::Error => self.errors::<T, S>(simd, asked, row, depth),
            Cost::Adr if self.relatives.is_empty() => ([0; LANES], true),
            Cost::Adr => {
                let (weights, scale) = judge.weights(asked);
                let mut losses = [scale; LANES];
                self.count_relatives(simd);
                let sure = self.count_strangers::<T, S>(simd, asked, row, depth);
                for before in &self.before {
                    for (loss, &before) in losses.iter_mut().zip(before) {
                        *loss -= weights.get(before as usize).copied().unwrap_or(0);
                    }
                }
                (losses, sure)
            }
        }
    }

    /// A loss of 1 where a stranger comes before the nearest relative.
    #[inline(always)]
    fn errors<T: Term, S: Simd>(&self, simd: S, asked: usize, row: &Row, depth: usize) -> ([u128; LANES], bool) {
        if self.relatives.is_empty() {
            return ([1; LANES], true);
        }
        let (mut nearest, mut models) = ([f64::INFINITY; LANES], [f64::INFINITY; LANES]);
        let mut wrong = [0; LANES];
        let mut strangers = [0.0; LANES];
        {
            let (nearest, models) = (vectors_mut::<S>(&mut nearest), vectors_mut::<S>(&mut models));
            for (&model, sums) in self.relatives.iter().zip(&self.sums) {
                let model = simd.splat_f64s(f64::from(model));
                for ((nearest, models), &sums) in nearest.iter_mut().zip(&mut *models).zip(vectors::<S>(sums)) {
                    let nearer = simd.less_than_f64s(sums, *nearest);
                    *nearest = simd.select_f64s(nearer, sums, *nearest);
                    *models = simd.select_f64s(nearer, model, *models);
                }
            }
        }
        let reach = greatest(&nearest);
        let mut sure = depth >= row.strangers.len();
        for (at, &(sum, model)) in row.strangers.iter().enumerate().take(depth) {
            if (at < HEAD && sum > reach) || wrong == [1; LANES] {
                sure = true;
                break;
            }
            set_sums::<T, S>(simd, &mut strangers, &self.values, asked, (sum, model));
            let (nearest, models) = (vectors::<S>(&nearest), vectors::<S>(&models));
            let model = simd.splat_f64s(f64::from(model));
            let wrong = S::as_mut_simd_u64s(&mut wrong).0;
            for (((wrong, &sums), &nearest), &models) in
                wrong.iter_mut().zip(vectors::<S>(&strangers)).zip(nearest).zip(models)
            {
                let tie = simd.and_m64s(simd.equal_f64s(sums, nearest), simd.less_than_f64s(model, models));
                let first = simd.or_m64s(simd.less_than_f64s(sums, nearest), tie);
                *wrong = simd.select_u64s(first, simd.splat_u64s(1), *wrong);
            }
        }
        (wrong.map(u128::from), sure)
    }

    /// Counts, for each relative, the relatives before it.
    #[inline(always)]
    fn count_relatives<S: Simd>(&mut self, simd: S) {
        self.before.clear();
        for (later, b) in self.sums.iter().enumerate() {
            let mut before = [0; LANES];
            for (a, earlier) in self.sums[..later].iter().zip(&mut self.before) {
                let counts = S::as_mut_simd_u64s(earlier).0.iter_mut().zip(S::as_mut_simd_u64s(&mut before).0);
                for (((earlier, before), &a), &b) in counts.zip(vectors::<S>(a)).zip(vectors::<S>(b)) {
                    // Of a pair at equal distance the lower model comes first.
                    *earlier = count(simd, *earlier, simd.less_than_f64s(b, a));
                    *before = count(simd, *before, simd.less_than_or_equal_f64s(a, b));
                }
            }
            self.before.push(before);
        }
    }

    /// Counts, for each relative, the strangers before it. Relatives that turn out not to be among the first Q of any
    /// candidate are dropped. False when more than `depth` strangers would have to be looked at.
    #[inline(always)]
    fn count_strangers<T: Term, S: Simd>(&mut self, simd: S, asked: usize, row: &Row, depth: usize) -> bool {
        let (Some(&lowest), Some(&highest)) = (self.relatives.first(), self.relatives.last()) else { return true };
        let first = self.relatives.len() as u64;
        for (nth, chunk) in row.strangers.chunks(CHUNK).enumerate() {
            let reach = self.drop_beyond(simd, first);
            if self.relatives.is_empty() || (nth * CHUNK < HEAD && chunk[0].0 > reach) {
                return true;
            }
            if nth * CHUNK >= depth {
                return false;
            }
            // Of a pair at equal distance the lower model comes first, as if it were a little nearer. Where classes lie
            // side by side, a stranger is lower than all relatives or higher than all.
            let apart = chunk.iter().all(|&(_, model)| model < lowest || model > highest);
            let [exact, nearer] = &mut self.strangers;
            exact[chunk.len()..].fill([f64::INFINITY; LANES]);
            for (&stranger, (exact, nearer)) in chunk.iter().zip(exact.iter_mut().zip(&mut *nearer)) {
                set_sums::<T, S>(simd, exact, &self.values, asked, stranger);
                if !apart {
                    *nearer = *exact;
                    bring_nearer(simd, nearer);
                } else if stranger.1 < lowest {
                    bring_nearer(simd, exact);
                }
            }
            let relatives = self.relatives.iter().zip(&self.sums).zip(&mut self.before);
            for ((&relative, sums), before) in relatives {
                if apart {
                    count_chunk(simd, before, sums, |at| &exact[at]);
                } else {
                    let lower = |at: usize| chunk.get(at).is_some_and(|&(_, model)| model < relative);
                    count_chunk(simd, before, sums, |at| if lower(at) { &nearer[at] } else { &exact[at] });
                }
            }
        }
        true
    }

    /// Drops the relatives that have at least `first` models before them in every lane. Returns the greatest distance
    /// of any that have fewer.
    #[inline(always)]
    fn drop_beyond<S: Simd>(&mut self, simd: S, first: u64) -> f64 {
        let mut reach = simd.splat_f64s(-1.0);
        let mut at = 0;
        while at < self.relatives.len() {
            let mut farthest = simd.splat_f64s(-1.0);
            let before = S::as_simd_u64s(&self.before[at]).0;
            for (&sums, &before) in vectors::<S>(&self.sums[at]).iter().zip(before) {
                let within = simd.less_than_u64s(before, simd.splat_u64s(first));
                farthest = simd.max_f64s(farthest, simd.select_f64s(within, sums, farthest));
            }
            if simd.reduce_max_f64s(farthest) >= 0.0 {
                reach = simd.max_f64s(reach, farthest);
                at += 1;
            } else {
                self.relatives.swap_remove(at);
                self.sums.swap_remove(at);
                self.before.swap_remove(at);
            }
        }
        simd.reduce_max_f64s(reach)
    }
}

/// Counts the strangers of a chunk that come before a relative.
#[inline(always)]
fn count_chunk<'a, S: Simd>(simd: S, before: &mut Counts, sums: &Lanes, strangers: impl Fn(usize) -> &'a Lanes) {
    for (at, (before, &sums)) in S::as_mut_simd_u64s(before).0.iter_mut().zip(vectors::<S>(sums)).enumerate() {
        for stranger in 0..CHUNK {
            *before = count(simd, *before, simd.less_than_f64s(vectors::<S>(strangers(stranger))[at], sums));
        }
    }
}

/// Makes distances a little less.
#[inline(always)]
fn bring_nearer<S: Simd>(simd: S, sums: &mut Lanes) {
    for sums in vectors_mut::<S>(sums) {
        let bits = simd.sub_u64s(simd.transmute_u64s_f64s(*sums), simd.splat_u64s(1));
        let positive = simd.greater_than_f64s(*sums, simd.splat_f64s(0.0));
        *sums = simd.select_f64s(positive, simd.transmute_f64s_u64s(bits), simd.splat_f64s(-1.0));
    }
}

/// One more where the mask is set.
#[inline(always)]
fn count<S: Simd>(simd: S, counts: S::u64s, mask: S::m64s) -> S::u64s {
    simd.add_u64s(counts, simd.select_u64s(mask, simd.splat_u64s(1), simd.splat_u64s(0)))
}

/// The distances to a model that is `sum` away without the candidates.
#[inline(always)]
fn set_sums<T: Term, S: Simd>(simd: S, sums: &mut Lanes, values: &[Lanes], asked: usize, (sum, model): (f64, u32)) {
    let (a, b) = (vectors::<S>(&values[asked]), vectors::<S>(&values[model as usize]));
    for ((sums, &a), &b) in vectors_mut::<S>(sums).iter_mut().zip(a).zip(b) {
        *sums = simd.add_f64s(simd.splat_f64s(sum), T::terms(simd, a, b));
    }
}

#[inline(always)]
fn vectors<S: Simd>(lanes: &Lanes) -> &[S::f64s] {
    S::as_simd_f64s(lanes).0
}

#[inline(always)]
fn vectors_mut<S: Simd>(lanes: &mut Lanes) -> &mut [S::f64s] {
    S::as_mut_simd_f64s(lanes).0
}

fn greatest(lanes: &Lanes) -> f64 {
    lanes.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

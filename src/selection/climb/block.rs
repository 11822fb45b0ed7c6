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

    /// Adds the loss of one model asked under each of the candidates.
    #[inline(always)]
    pub(super) fn add_losses<T: Term, S: Simd>(
        &mut self,
        simd: S,
        asked: usize,
        row: &Row,
        judge: &Judge<'_>,
        losses: &mut [u128; LANES],
    ) {
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
            Cost::Error => self.add_errors::<T, S>(simd, asked, row, losses),
            Cost::Adr if self.relatives.is_empty() => {}
            Cost::Adr => {
                let (weights, scale) = judge.weights(asked);
                for loss in losses.iter_mut() {
                    *loss += scale;
                }
                self.count_relatives(simd);
                self.count_strangers::<T, S>(simd, asked, row);
                for before in &self.before {
                    for (loss, &before) in losses.iter_mut().zip(before) {
                        *loss -= weights.get(before as usize).copied().unwrap_or(0);
                    }
                }
            }
        }
    }

    /// A loss of 1 where a stranger comes before the nearest relative.
    #[inline(always)]
    fn add_errors<T: Term, S: Simd>(&self, simd: S, asked: usize, row: &Row, losses: &mut [u128; LANES]) {
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
        for (at, &(sum, model)) in row.strangers.iter().enumerate() {
            if at < HEAD && sum > reach {
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
        for (loss, wrong) in losses.iter_mut().zip(wrong) {
            *loss += if self.relatives.is_empty() { 1 } else { u128::from(wrong) };
        }
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
                    let later_first = simd.less_than_f64s(b, a);
                    *earlier = simd.select_u64s(later_first, simd.add_u64s(*earlier, simd.splat_u64s(1)), *earlier);
                    *before = simd.select_u64s(later_first, *before, simd.add_u64s(*before, simd.splat_u64s(1)));
                }
            }
            self.before.push(before);
        }
    }

    /// Counts, for each relative, the strangers before it. Relatives that turn out not to be among the first Q of any
    /// candidate are dropped.
    #[inline(always)]
    fn count_strangers<T: Term, S: Simd>(&mut self, simd: S, asked: usize, row: &Row) {
        let first = self.relatives.len() as u64;
        for (nth, chunk) in row.strangers.chunks(CHUNK).enumerate() {
            let reach = self.drop_beyond(simd, first);
            if self.relatives.is_empty() || (nth * CHUNK < HEAD && chunk[0].0 > reach) {
                break;
            }
            let [exact, nearer] = &mut self.strangers;
            for ((&stranger, exact), nearer) in chunk.iter().zip(exact).zip(nearer) {
                set_sums::<T, S>(simd, exact, &self.values, asked, stranger);
                for (&exact, nearer) in vectors::<S>(exact).iter().zip(vectors_mut::<S>(nearer)) {
                    // Of a pair at equal distance the lower model comes first, as if it were a little nearer.
                    let bits = simd.sub_u64s(simd.transmute_u64s_f64s(exact), simd.splat_u64s(1));
                    let positive = simd.greater_than_f64s(exact, simd.splat_f64s(0.0));
                    *nearer = simd.select_f64s(positive, simd.transmute_f64s_u64s(bits), simd.splat_f64s(-1.0));
                }
            }
            for ((&relative, sums), before) in self.relatives.iter().zip(&self.sums).zip(&mut self.before) {
                let counts = S::as_mut_simd_u64s(before).0.iter_mut();
                for (at, (count, &sums)) in counts.zip(vectors::<S>(sums)).enumerate() {
                    let mut sum = *count;
                    for (distances, &(_, model)) in (0..).zip(chunk) {
                        let distances = &self.strangers[usize::from(model < relative)][distances];
                        let before = simd.less_than_f64s(vectors::<S>(distances)[at], sums);
                        sum = simd.select_u64s(before, simd.add_u64s(sum, simd.splat_u64s(1)), sum);
                    }
                    *count = sum;
                }
            }
        }
    }

    /// Drops the relatives that have at least `first` models before them in every lane. Returns the greatest distance
    /// of any that have fewer.
    #[inline(always)]
    fn drop_beyond<S: Simd>(&mut self, simd: S, first: u64) -> f64 {
        let mut reach = -1.0;
        let mut at = 0;
        while at < self.relatives.len() {
            let mut farthest = simd.splat_f64s(-1.0);
            let before = S::as_simd_u64s(&self.before[at]).0;
            for (&sums, &before) in vectors::<S>(&self.sums[at]).iter().zip(before) {
                let within = simd.less_than_u64s(before, simd.splat_u64s(first));
                farthest = simd.max_f64s(farthest, simd.select_f64s(within, sums, farthest));
            }
            let farthest = simd.reduce_max_f64s(farthest);
            if farthest >= 0.0 {
                at += 1;
                reach = if farthest > reach { farthest } else { reach };
            } else {
                self.relatives.swap_remove(at);
                self.sums.swap_remove(at);
                self.before.swap_remove(at);
            }
        }
        reach
    }
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

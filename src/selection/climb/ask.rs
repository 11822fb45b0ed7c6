//! The candidates of one addition or removal, evaluated side by side.

use pulp::Simd;

use super::{
    Cost,
    block::{Block, LANES, LEAST, Losses, MOST},
    ground::{Ground, POLL},
    habits::Habits,
    race::{Bound, Outcome},
    sketch::{self, Sketch},
};
use crate::{
    metrics::{Cancelled, Term},
    watch::Watch,
};

/// Fewer candidates than this are looked into one by one.
const FEW: usize = 4;

/// Adds up the losses of all models asked for each of the candidates `indices`, a vector of them at a time, until none
/// of those can stay below the bound.
///
/// First all models are asked briefly, which is enough to give up on most candidates; then those whose losses are not
/// known yet are asked again; and for those candidates that may be best, ties are looked into.
///
/// The candidates are added if `ADDED`; otherwise they are removed, and those left after the first look are evaluated
/// one by one.
pub(super) struct Ask<'a, T, const ADDED: bool> {
    pub(super) ground: &'a Ground<'a, T>,
    pub(super) indices: &'a [u32],
    pub(super) bound: &'a Bound,
    pub(super) habits: &'a Habits,
    pub(super) watch: &'a dyn Watch,
}

impl<T: Term, const ADDED: bool> pulp::WithSimd for Ask<'_, T, ADDED> {
    type Output = Result<Vec<Outcome>, Cancelled>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        if !Sketch::<S>::fits(self.ground.judge) {
            let mut outcomes = Vec::with_capacity(self.indices.len());
            for indices in self.indices.chunks(if ADDED { S::F64_LANES } else { 1 }) {
                if ADDED {
                    self.block(simd, indices, &mut outcomes)?;
                } else {
                    outcomes.push(self.alone(indices[0])?);
                }
            }
            return Ok(outcomes);
        }
        let mut outcomes = Vec::with_capacity(self.indices.len());
        for indices in self.indices.chunks(S::F32_LANES) {
            let (mut some, roughly) = self.sketch(simd, indices)?;
            let mut left: Vec<usize> = (0..indices.len()).filter(|&at| some[at].is_none()).collect();
            // The best by its sketch is likely the best: with its loss known, the sketches of most others are enough.
            left.sort_unstable_by_key(|&at| (roughly[at], indices[at]));
            let mut first = true;
            while !left.is_empty() {
                // For the error the nearest few models are enough: side by side is quicker even for one.
                let alone = !ADDED || (self.ground.judge.cost() == Cost::Adr && (first || left.len() < FEW));
                let count = if alone { 1 } else { left.len().min(S::F64_LANES) };
                let places: Vec<usize> = left.drain(..count).collect();
                let mut exact = Vec::with_capacity(count);
                if alone {
                    exact.push(self.alone(indices[places[0]])?);
                } else {
                    let indices: Vec<u32> = places.iter().map(|&at| indices[at]).collect();
                    self.block(simd, &indices, &mut exact)?;
                }
                for (at, outcome) in places.into_iter().zip(exact) {
                    if let Outcome::Whole(loss) = outcome {
                        self.bound.lower((loss, indices[at]));
                    }
                    some[at] = Some(outcome);
                }
                let bound = self.bound.mark();
                left.retain(|&at| {
                    let open = (roughly[at], indices[at]) < bound;
                    if !open {
                        some[at] = Some(Outcome::GivenUp(roughly[at] as f64));
                    }
                    open
                });
                first = false;
            }
            outcomes.extend(some.into_iter().flatten());
        }
        Ok(outcomes)
    }
}

impl<T: Term, const ADDED: bool> Ask<'_, T, ADDED> {
    /// The outcome of one candidate.
    fn alone(&self, index: u32) -> Result<Outcome, Cancelled> {
        if ADDED {
            self.ground.exactly(index, self.bound, self.watch)
        } else {
            self.ground.without(index, self.bound, self.watch)
        }
    }

    /// The outcomes of those candidates, as many as fit, that a sketch is enough to give up on. When it is not enough
    /// for all, their losses are at least those that come with them.
    #[inline(always)]
    fn sketch<S: Simd>(&self, simd: S, indices: &[u32]) -> Result<(Vec<Option<Outcome>>, Vec<u128>), Cancelled> {
        let Ground { rows, asked, judge, singles, .. } = self.ground;
        let mut sketch = Sketch::<S>::new(simd, singles, indices);
        let unit = judge.rough_unit();
        let asked = self.habits.order(indices, asked);
        let mut losses = [0; sketch::LANES];
        let mut seen = Vec::with_capacity(asked.len());
        let mut outcomes = vec![None; indices.len()];
        let mut roughly = vec![0; indices.len()];
        for (nth, models) in asked.chunks(POLL).enumerate() {
            if self.watch.cancelled() {
                return Err(Cancelled);
            }
            for &model in models {
                let before = losses;
                sketch.add_losses::<T, ADDED>(simd, model as usize, &rows[model as usize], judge, &mut losses);
                let mut lost = [0; sketch::LANES];
                for ((lost, now), before) in lost.iter_mut().zip(losses).zip(before) {
                    *lost = judge.roughly_in_brief(now - before);
                }
                seen.push(lost);
            }
            let bound = self.bound.mark();
            for (roughly, loss) in roughly.iter_mut().zip(losses) {
                *roughly = u128::from(loss) * unit;
            }
            let beaten = |(&index, &loss): (&u32, &u128)| (loss, index) >= bound;
            let last = (nth + 1) * POLL >= asked.len();
            if last || indices.iter().zip(&roughly).all(beaten) {
                // Those not asked are taken to change as those asked did.
                let share = self.ground.share(&asked[..seen.len()]);
                let given_up = |of: (&u32, &u128)| beaten(of).then_some(Outcome::GivenUp(*of.1 as f64 / share));
                outcomes = indices.iter().zip(&roughly).map(given_up).collect();
                break;
            }
        }
        for (at, &index) in indices.iter().enumerate() {
            let mut of_index = self.habits.of(index);
            for (&model, lost) in asked.iter().zip(&seen) {
                of_index[model as usize] = lost[at];
            }
        }
        Ok((outcomes, roughly))
    }

    /// The outcomes of candidates that fit one vector.
    #[inline(always)]
    fn block<S: Simd>(&self, simd: S, indices: &[u32], outcomes: &mut Vec<Outcome>) -> Result<(), Cancelled> {
        let Ground { rows, asked, judge, columns, .. } = self.ground;
        let mut block = Block::<S>::new(columns, indices, rows.len());
        let unit = judge.unit() as f64;
        let mut least = [0; LANES];
        let mut unsure = Vec::new();
        for (nth, models) in asked.chunks(POLL).enumerate() {
            for &model in models {
                let row = &rows[model as usize];
                let (losses, sure) = block.losses::<T, LEAST>(simd, model as usize, row, judge, false);
                add_lanes(&mut least, &losses);
                if !sure {
                    unsure.push((model, losses));
                }
            }
            if self.may_stop(indices, &least)? {
                // Those not asked are taken to change as those asked did.
                let share = self.ground.share(&asked[..asked.len().min((nth + 1) * POLL)]);
                outcomes
                    .extend(indices.iter().zip(least).map(|(_, loss)| Outcome::GivenUp(loss as f64 * unit / share)));
                return Ok(());
            }
        }
        for models in unsure.chunks(POLL) {
            for &(model, briefly) in models {
                let row = &rows[model as usize];
                let (losses, _) = block.losses::<T, LEAST>(simd, model as usize, row, judge, true);
                for ((least, briefly), loss) in least.iter_mut().zip(briefly).zip(losses) {
                    *least += loss - briefly;
                }
            }
            if self.may_stop(indices, &least)? {
                outcomes.extend(indices.iter().zip(least).map(|(_, loss)| Outcome::GivenUp(loss as f64 * unit)));
                return Ok(());
            }
        }
        let mut most = [0; LANES];
        for &model in asked {
            let row = &rows[model as usize];
            let (losses, _) = block.losses::<T, MOST>(simd, model as usize, row, judge, true);
            add_lanes(&mut most, &losses);
        }
        let unit = judge.unit();
        for ((&index, least), most) in indices.iter().zip(least).zip(most) {
            let loss = u128::from(least) * unit;
            outcomes.push(if unit == 1 && least == most {
                Outcome::Whole(loss)
            } else if (loss, index) >= self.bound.mark() {
                Outcome::GivenUp(loss as f64)
            } else {
                self.ground.exactly(index, self.bound, self.watch)?
            });
        }
        Ok(())
    }

    /// Whether no candidate can stay below the bound.
    fn may_stop(&self, indices: &[u32], least: &Losses) -> Result<bool, Cancelled> {
        if self.watch.cancelled() {
            return Err(Cancelled);
        }
        let bound = self.bound.mark();
        let unit = self.ground.judge.unit();
        Ok(indices.iter().zip(least).all(|(&index, &loss)| (u128::from(loss) * unit, index) >= bound))
    }
}

#[inline(always)]
fn add_lanes(sums: &mut Losses, lanes: &Losses) {
    for (sum, lane) in sums.iter_mut().zip(lanes) {
        *sum += lane;
    }
}

//! The losses under a single feature, roughly: enough to give up on nearly all of them.

use std::marker::PhantomData;

use pulp::Simd;

use super::Line;
use crate::{
    metrics::{Term, count_u32s},
    selection::climb::{Cost, judge::Judge, sketch::RANKS},
};

/// The lanes of the widest vector.
const LANES: usize = 16;

/// What every model asked loses at least under the feature of a line, in [`Judge::rough_unit`]s, by model.
///
/// Of the models as many steps up and down as a model asked looks at, the distances are cut to the upper half of their
/// bits, as in a [`Sketch`](crate::selection::climb::sketch::Sketch). A relative has before it, at least, those on its
/// own side and those on the other side that are nearer when cut.
pub(in crate::selection::climb) struct RoughLosses<'a, 'b, T> {
    pub(in crate::selection::climb) line: &'a Line<'b>,
    pub(in crate::selection::climb) judge: &'a Judge<'a>,
    pub(in crate::selection::climb) term: PhantomData<T>,
}

impl<T: Term> pulp::WithSimd for RoughLosses<'_, '_, T> {
    type Output = Vec<u32>;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> Vec<u32> {
        let Self { line, judge, .. } = self;
        let models = line.order.len();
        let up = Side::new(line.ordered.iter().copied());
        let down = Side::new(line.ordered.iter().rev().copied());
        let (mut steps_up, mut steps_down) = ([0; RANKS], [0; RANKS]);
        let mut losses = vec![0; models];
        for class in judge.members() {
            let Some(&first) = class.first() else { continue };
            let first = first as usize;
            let ((credits, whole), looks) = (judge.rough_credits(first), judge.looks_at(first));
            let width = looks.next_multiple_of(LANES);
            let kin = &line.kin[judge.class_range(first)];
            for (at, &place) in kin.iter().enumerate() {
                let place = place as usize;
                let (from_below, from_above) = (place, models - 1 - place);
                let lost = &mut losses[line.order[place] as usize];
                if kin.len() == 1 {
                    *lost = u32::from(judge.cost() == Cost::Error);
                    continue;
                }
                if !up.ends::<T>(from_below, looks) || !down.ends::<T>(from_above, looks) {
                    continue;
                }
                *lost = whole;
                let higher = at + 1..at + 1 + up_to(looks, kin[at + 1..].iter().map(|&other| other as usize - place));
                let lower = at - up_to(looks, kin[..at].iter().rev().map(|&other| place - other as usize))..at;
                if higher.is_empty() && lower.is_empty() {
                    continue;
                }
                up.cut_steps::<T>(from_below, &mut steps_up[..width]);
                down.cut_steps::<T>(from_above, &mut steps_down[..width]);
                let mut gained = 0;
                for &other in kin[lower.start..higher.end].iter().filter(|&&other| other as usize != place) {
                    let other = other as usize;
                    let distance =
                        if other > place { steps_up[other - place - 1] } else { steps_down[place - other - 1] };
                    let before =
                        nearer(simd, &steps_up[..width], distance) + nearer(simd, &steps_down[..width], distance);
                    gained += credits[before.min(RANKS - 1)];
                }
                // Credits are rounded up, so all of them may be more than the whole.
                *lost = whole.saturating_sub(gained);
            }
        }
        losses
    }
}

/// A line walked along in one direction.
struct Side {
    /// The values in order, and as many more as are read beyond.
    values: Vec<f64>,
    models: usize,
}

impl Side {
    #[inline(always)]
    fn new(values: impl ExactSizeIterator<Item = f64>) -> Self {
        let models = values.len();
        let mut padded = Vec::with_capacity(models + RANKS);
        padded.extend(values);
        padded.resize(models + RANKS, 0.0);
        Self { values: padded, models }
    }

    /// The distance to the model so many steps on, cut to the upper half of its bits.
    #[inline(always)]
    fn cut<T: Term>(&self, from: usize, steps: usize) -> u32 {
        (T::term(self.values[from], self.values[from + steps]).to_bits() >> 32) as u32
    }

    /// The same for the next models, and the greatest number there is where there are none.
    #[inline(always)]
    fn cut_steps<T: Term>(&self, from: usize, steps: &mut [u32]) {
        let width = steps.len();
        let (parts, _) = steps.as_chunks_mut::<LANES>();
        let (others, _) = self.values[from + 1..].as_chunks::<LANES>();
        for (part, others) in parts.iter_mut().zip(others) {
            for (cut, &other) in part.iter_mut().zip(others) {
                *cut = (T::term(self.values[from], other).to_bits() >> 32) as u32;
            }
        }
        steps[width.min(self.models - 1 - from)..].fill(u32::MAX);
    }

    /// Whether all beyond the next `looks` models are certainly farther than these. Distances grow but for their
    /// rounding, which is less than one of what is left when they are cut.
    #[inline(always)]
    fn ends<T: Term>(&self, from: usize, looks: usize) -> bool {
        from + looks + 1 >= self.models || self.cut::<T>(from, looks + 1) > self.cut::<T>(from, looks) + 1
    }
}

/// How many of some ascending numbers are at most `most`.
#[inline(always)]
fn up_to(most: usize, numbers: impl Iterator<Item = usize>) -> usize {
    numbers.take_while(|&number| number <= most).count()
}

/// How many of some distances are less than `distance`.
#[inline(always)]
fn nearer<S: Simd>(simd: S, steps: &[u32], distance: u32) -> usize {
    let (distance, mut count) = (simd.splat_u32s(distance), 0);
    for &steps in S::as_simd_u32s(steps).0 {
        count += count_u32s(simd, simd.less_than_u32s(steps, distance));
    }
    count
}

#[cfg(test)]
mod tests {
    use std::marker::PhantomData;

    use super::RoughLosses;
    use crate::{
        metrics::{
            Chi2, Features, L1, L2, Sample, Term, Wesd2, Wesd15,
            samples::{Lcg, sample},
        },
        selection::climb::{Cost, judge::Judge, line::Line},
    };

    /// Rough losses against those of the nearest models: never more and, unless distances are equal, no less than
    /// rounding makes them.
    fn check<T: Term>(values: &[f64], labels: &[u32], equal: bool) {
        let train = Features::from_rows(values.iter().map(|&value| [value]));
        let sample = Sample { train, train_labels: labels.to_vec(), classes: 6, ..Sample::default() };
        assert!(T::grows(values));
        for cost in [Cost::Error, Cost::Adr] {
            let judge = Judge::new(&sample, cost);
            let (labels, starts) = judge.classes();
            let mut line = Line::new(values, labels, starts);
            let arguments = || RoughLosses { line: &line, judge: &judge, term: PhantomData::<T> };
            let losses = pulp::Arch::new().dispatch(arguments());
            assert_eq!(losses, pulp::WithSimd::with_simd(arguments(), pulp::Scalar::new()));
            for (model, &loss) in losses.iter().enumerate() {
                let looks = judge.looks_at(model);
                let exact = judge.loss(model, line.nearest::<T>(model, looks));
                assert!(u128::from(loss) * judge.rough_unit() <= exact, "{model} {cost:?}");
                let rounding = looks as u128 + 1;
                assert!(equal || (u128::from(loss) + rounding) * judge.rough_unit() >= exact, "{model} {cost:?}");
            }
        }
    }

    #[test]
    fn losses_are_bounded_and_mostly_known() {
        let mut random = Lcg(9);
        for (largest, levels) in [(3, 1e12), (9, 1e12), (40, 1e12), (9, 30.0), (40, 4.0)] {
            // Classes of several sizes, one of them a single model.
            let mut labels = sample(5, largest, 1, 0).train_labels;
            labels.retain(|&label| label < 5);
            labels.push(5);
            let values: Vec<f64> = labels.iter().map(|_| 0.5 + (random.next() * levels).round() / levels).collect();
            let equal = levels < 1e3;
            check::<L2>(&values, &labels, equal);
            check::<L1>(&values, &labels, equal);
            check::<Chi2>(&values, &labels, equal);
            check::<Wesd15>(&values, &labels, equal);
            check::<Wesd2>(&values, &labels, equal);
        }
    }
}

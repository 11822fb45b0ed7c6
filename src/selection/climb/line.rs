//! Models on a line: neighbours by a single feature.

use crate::metrics::{Term, before};

/// How much nearer than a model between them a model may seem, because the terms are rounded.
const SLACK: f64 = 1.0 + 1e-12;

/// Models ordered by the value of one feature.
pub(super) struct Line<'a> {
    values: &'a [f64],
    order: Vec<u32>,
    /// Where each model stands in `order`.
    places: Vec<u32>,
    nearest: Vec<(f64, u32)>,
}

impl<'a> Line<'a> {
    pub(super) fn new(values: &'a [f64]) -> Self {
        let mut order: Vec<u32> = (0..values.len() as u32).collect();
        order.sort_unstable_by(|&a, &b| values[a as usize].total_cmp(&values[b as usize]).then(a.cmp(&b)));
        let mut places = vec![0; values.len()];
        for (place, &model) in (0..).zip(&order) {
            places[model as usize] = place;
        }
        Self { values, order, places, nearest: Vec::new() }
    }

    /// The `count` models nearest to a model (all others when there are fewer), ascending by distance, then by model.
    ///
    /// Distances grow as one walks away from it to either side.
    #[inline(always)]
    pub(super) fn nearest<T: Term>(&mut self, model: usize, count: usize) -> &[(f64, u32)] {
        self.nearest.clear();
        let place = self.places[model] as usize;
        let (below, above) = (self.order[..place].iter().rev(), self.order[place + 1..].iter());
        let entry = |&other: &u32| (T::term(self.values[model], self.values[other as usize]), other);
        let (mut below, mut above) = (below.map(entry).peekable(), above.map(entry).peekable());
        if count == 0 {
            return &[];
        }
        loop {
            let next = match (below.peek(), above.peek()) {
                (Some(a), Some(b)) if a.0 < b.0 => below.next(),
                (Some(_), None) => below.next(),
                _ => above.next(),
            };
            let Some(next) = next else { break };
            if self.nearest.len() < count {
                self.nearest.push(next);
            } else {
                let last = self.nearest[count - 1];
                if next.0 > last.0 * SLACK {
                    break;
                }
                if !before(next, last) {
                    continue;
                }
                self.nearest[count - 1] = next;
            }
            let mut at = self.nearest.len() - 1;
            while at > 0 && before(self.nearest[at], self.nearest[at - 1]) {
                self.nearest.swap(at, at - 1);
                at -= 1;
            }
        }
        &self.nearest
    }
}

#[cfg(test)]
mod tests {
    use super::Line;
    use crate::metrics::{Chi2, L1, L2, Term, samples::Lcg};

    fn check<T: Term>(values: &[f64]) {
        let mut line = Line::new(values);
        for model in 0..values.len() {
            let mut all: Vec<(f64, u32)> = (0..values.len())
                .filter(|&other| other != model)
                .map(|other| (T::term(values[model], values[other]), other as u32))
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for count in [0, 1, 2, 5, 100] {
                assert_eq!(line.nearest::<T>(model, count), &all[..count.min(all.len())]);
            }
        }
    }

    #[test]
    fn finds_what_sorting_finds() {
        let mut random = Lcg(3);
        for levels in [1.0, 3.0, 10.0, 1e15] {
            for offset in [0.0_f64, 0.5, 1e9] {
                let mut value = || ((random.next() - offset.min(0.5)) * levels).round() / levels + offset;
                let values: Vec<f64> = (0..40).map(|_| value()).collect();
                check::<L2>(&values);
                check::<L1>(&values);
                check::<Chi2>(&values);
            }
        }
        check::<L2>(&[0.0; 7]);
        check::<L1>(&[1.0]);
    }
}

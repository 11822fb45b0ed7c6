//! Models on a line: neighbours by a single feature.

use std::ops::Range;

use super::order::ascending;
use crate::metrics::{Term, before};
pub(super) use rough::RoughLosses;

mod rough;

/// How much nearer than a model between them a model may seem, because the terms are rounded.
const SLACK: f64 = 1.0 + 1e-12;

/// Models ordered by the value of one feature.
pub(super) struct Line<'a> {
    values: &'a [f64],
    order: Vec<u32>,
    /// The values in that order.
    ordered: Vec<f64>,
    /// Where each model stands in `order`.
    places: Vec<u32>,
    /// Class after class, where its models stand, ascending.
    kin: Vec<u32>,
    /// Where each model stands in `kin`.
    among_kin: Vec<u32>,
    nearest: Vec<(f64, u32)>,
}

impl<'a> Line<'a> {
    /// `starts` holds for each class how many models those before it have.
    pub(super) fn new(values: &'a [f64], labels: &[u32], starts: &[u32]) -> Self {
        let order = ascending(values.len(), |model| values[model]);
        let (mut places, mut among_kin) = (vec![0; values.len()], vec![0; values.len()]);
        let (mut kin, mut next) = (vec![0; values.len()], starts.to_vec());
        for (place, &model) in (0..).zip(&order) {
            places[model as usize] = place;
            let next = &mut next[labels[model as usize] as usize];
            kin[*next as usize] = place;
            among_kin[model as usize] = *next;
            *next += 1;
        }
        let ordered = order.iter().map(|&model| values[model as usize]).collect();
        Self { values, order, ordered, places, kin, among_kin, nearest: Vec::new() }
    }

    /// Calls `found` with the rank, from 0, of each model of the same class (which stands in `class` of all classes'
    /// models) among the `looks` nearest to a model. False when equal distances make it doubtful which these are; then
    /// [`Line::nearest`] knows. Only for terms that [grow exactly](Term::GROWS_EXACTLY).
    pub(super) fn find<T: Term>(
        &self,
        model: usize,
        class: Range<usize>,
        looks: usize,
        mut found: impl FnMut(usize),
    ) -> bool {
        let (place, at) = (self.places[model] as usize, self.among_kin[model] as usize);
        let here = self.ordered[place];
        let (below, above) = self.ordered.split_at(place);
        let above = &above[1..];
        // How far away the next, the second … to either side are.
        let down = |steps: usize| T::term(here, below[below.len() - steps]);
        let up = |steps: usize| T::term(here, above[steps - 1]);
        if looks == 0 {
            return true;
        }
        // Whoever is beyond the next `looks` must be farther than these.
        if (below.len() > looks && down(looks) == down(looks + 1))
            || (above.len() > looks && up(looks) == up(looks + 1))
        {
            return false;
        }
        let higher = self.kin[at + 1..class.end].iter().map(|&other| other as usize - place);
        let lower = self.kin[class.start..at].iter().rev().map(|&other| place - other as usize);
        side(higher, (above.len(), &up), (below.len(), &down), looks, &mut found)
            && side(lower, (below.len(), &down), (above.len(), &up), looks, &mut found)
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

/// [`Line::find`] to one side: `steps` to the models of the class, and for either side the number of models and how far
/// away they are.
#[inline(always)]
fn side(
    steps: impl Iterator<Item = usize>,
    (count, here): (usize, &impl Fn(usize) -> f64),
    (opposite, there): (usize, &impl Fn(usize) -> f64),
    looks: usize,
    found: &mut impl FnMut(usize),
) -> bool {
    // How many are nearer on the other side.
    let mut across = 0;
    for steps in steps.take_while(|&steps| steps <= looks) {
        let distance = here(steps);
        while across < opposite.min(looks) && there(across + 1) < distance {
            across += 1;
        }
        if (across < opposite && there(across + 1) == distance)
            || (steps > 1 && here(steps - 1) == distance)
            || (steps < count && here(steps + 1) == distance)
        {
            return false;
        }
        let rank = steps - 1 + across;
        if rank >= looks {
            break;
        }
        found(rank);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::Line;
    use crate::metrics::{Chi2, L1, L2, Term, samples::Lcg};

    fn check<T: Term>(values: &[f64]) {
        let mut line = Line::new(values, &vec![0; values.len()], &[0]);
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

    /// Models of three classes; the ranks of those of one's own class among the nearest, found and by definition.
    fn check_find<T: Term>(values: &[f64]) -> (usize, usize) {
        let labels: Vec<u32> = (0..values.len() as u32).map(|model| model * 7 % 3).collect();
        let size = |class: u32| labels.iter().filter(|&&label| label == class).count();
        let starts = [0, size(0) as u32, (size(0) + size(1)) as u32];
        let mut line = Line::new(values, &labels, &starts);
        let (mut sure, mut unsure) = (0, 0);
        for (model, looks) in (0..values.len()).flat_map(|model| [0, 1, 2, 5, 30, 100].map(|looks| (model, looks))) {
            let start = starts[labels[model] as usize] as usize;
            let mut ranks = Vec::new();
            if line.find::<T>(model, start..start + size(labels[model]), looks, |rank| ranks.push(rank)) {
                ranks.sort_unstable();
                let nearest = line.nearest::<T>(model, looks).iter().enumerate();
                let related = nearest.filter(|(_, (_, other))| labels[*other as usize] == labels[model]);
                assert_eq!(ranks, related.map(|(rank, _)| rank).collect::<Vec<_>>(), "{model} {looks}");
                sure += 1;
            } else {
                unsure += 1;
            }
        }
        (sure, unsure)
    }

    #[test]
    fn relatives_are_found_where_no_distances_are_equal() {
        let mut random = Lcg(4);
        for levels in [1.0, 10.0, 1e15] {
            let values: Vec<f64> = (0..40).map(|_| ((random.next() - 0.5) * levels).round() / levels).collect();
            for (sure, unsure) in [check_find::<L2>(&values), check_find::<L1>(&values)] {
                // Nothing is asked of those who look at none.
                assert!(if levels == 1e15 { unsure == 0 } else { unsure > 40 && sure >= 40 }, "{sure} {unsure}");
            }
        }
    }
}

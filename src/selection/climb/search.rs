//! Which way the climb goes.

use std::collections::BTreeSet;

use super::{
    BEAM, Climb, PATIENCE, Search, Step,
    ground::Ground,
    habits::Habits,
    judge::Judge,
    race::{Mark, Race},
    sketch::LANES,
};
use crate::{
    metrics::{Cancelled, Sample, Term},
    watch::Watch,
};

pub(super) fn run<T: Term>(
    sample: &Sample,
    judge: &Judge<'_>,
    search: Search,
    watch: &dyn Watch,
) -> Result<Climb, Cancelled> {
    let from = Place { ground: Ground::<T>::new(sample, judge), steps: Vec::new(), loss: judge.worst() };
    let habits = Habits::new(sample.train.rows(), sample.train.cols());
    let party = Party { judge, race: Race::new(sample.train.cols()), habits, watch };
    let steps = match search {
        Search::Strict => party.strict(from)?,
        Search::Level => party.level(from)?,
        Search::Beam => party.beam(from)?,
    };
    let mut climb = Climb { selected: Vec::new(), steps };
    climb.selected = climb.order();
    climb.selected.sort_unstable();
    Ok(climb)
}

/// Where a climb stands, and how it came there.
#[derive(Clone)]
struct Place<'a, T> {
    ground: Ground<'a, T>,
    steps: Vec<Step>,
    loss: u128,
}

impl<T: Term> Place<'_, T> {
    /// The indices selected, ascending.
    fn selection(&self) -> Vec<u32> {
        let mut selection = self.ground.selected().to_vec();
        selection.sort_unstable();
        selection
    }

    fn go(&mut self, (loss, index): Mark, added: bool, judge: &Judge<'_>) {
        self.loss = loss;
        self.ground.toggle(index);
        self.steps.push(Step { index, added, cost: judge.cost_of(loss) });
    }
}

struct Party<'a> {
    judge: &'a Judge<'a>,
    race: Race,
    habits: Habits,
    watch: &'a dyn Watch,
}

impl Party<'_> {
    /// The `keep` best additions (or removals) below `loss` among those that `allowed` allows.
    fn best<T: Term>(
        &self,
        place: &Place<'_, T>,
        added: bool,
        loss: u128,
        keep: usize,
        allowed: impl Fn(u32) -> bool,
    ) -> Result<Vec<Mark>, Cancelled> {
        let (ground, habits, watch) = (&place.ground, &self.habits, self.watch);
        let mut candidates = if added { ground.outside() } else { ground.selected().to_vec() };
        candidates.retain(|&index| allowed(index));
        self.race.run(&candidates, loss, keep, LANES, |block, bound| ground.moved(added, block, bound, habits, watch))
    }

    /// Forward while the cost falls, backward while it falls, and again, until neither falls from where it stands.
    fn strict<T: Term>(&self, mut place: Place<'_, T>) -> Result<Vec<Step>, Cancelled> {
        // How many ways in a row led nowhere: both have been tried from here once that is two.
        let (mut added, mut idle) = (true, 0);
        while idle < 2 {
            idle += 1;
            while let Some(&mark) = self.best(&place, added, place.loss, 1, |_| true)?.first() {
                place.go(mark, added, self.judge);
                idle = 1;
            }
            added = !added;
        }
        Ok(place.steps)
    }

    /// The same, and on the level to where it has not been.
    fn level<T: Term>(&self, mut place: Place<'_, T>) -> Result<Vec<Step>, Cancelled> {
        let mut seen = BTreeSet::from([Vec::new()]);
        // The moves to the least cost, and how many were made since.
        let (mut least, mut reached, mut level) = (place.loss, 0, 0);
        loop {
            let moves = place.steps.len();
            for added in [true, false] {
                while level < PATIENCE {
                    let selection = place.selection();
                    let new = |index: u32| {
                        let mut next = selection.clone();
                        match next.binary_search(&index) {
                            Ok(at) => drop(next.remove(at)),
                            Err(at) => next.insert(at, index),
                        }
                        !seen.contains(&next)
                    };
                    // The empty selection is the worst there is: from there the cost has to fall.
                    let below = place.loss + u128::from(!selection.is_empty());
                    let Some(&mark) = self.best(&place, added, below, 1, new)?.first() else { break };
                    level = if mark.0 < place.loss { 0 } else { level + 1 };
                    place.go(mark, added, self.judge);
                    seen.insert(place.selection());
                    if place.loss < least {
                        (least, reached) = (place.loss, place.steps.len());
                    }
                }
            }
            if place.steps.len() == moves || level >= PATIENCE {
                place.steps.truncate(reached);
                return Ok(place.steps);
            }
        }
    }

    /// Several selections side by side.
    fn beam<T: Term>(&self, from: Place<'_, T>) -> Result<Vec<Step>, Cancelled> {
        let (mut least, mut steps) = (from.loss, Vec::new());
        let mut beam = vec![from];
        let mut idle = 0;
        while idle < 2 {
            idle += 1;
            // Of equal losses the selection that comes first in the order of its indices.
            let mut next: Vec<(u128, Vec<u32>, usize, u32)> = Vec::new();
            for (at, place) in beam.iter().enumerate() {
                let anything = self.judge.worst() + 1;
                for (loss, index) in self.best(place, true, anything, BEAM, |_| true)? {
                    let mut selection = place.selection();
                    selection.push(index);
                    selection.sort_unstable();
                    next.push((loss, selection, at, index));
                }
            }
            next.sort_unstable();
            next.dedup_by(|a, b| a.1 == b.1);
            let mut places = Vec::with_capacity(BEAM);
            for (loss, _, at, index) in next.into_iter().take(BEAM) {
                let mut place = beam[at].clone();
                place.go((loss, index), true, self.judge);
                while let Some(&mark) = self.best(&place, false, place.loss, 1, |_| true)?.first() {
                    place.go(mark, false, self.judge);
                }
                if place.loss < least {
                    (least, steps, idle) = (place.loss, place.steps.clone(), 0);
                }
                places.push(place);
            }
            if places.is_empty() {
                break;
            }
            beam = places;
        }
        Ok(steps)
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        metrics::{
            Distance, Exam, figures,
            samples::{nobody, one_class, sample, samples},
        },
        selection::{Cost, Search, climb, climb_by},
        watch::Unwatched,
    };

    #[test]
    fn none_ends_above_the_strict_climb_and_all_say_what_they_cost() {
        let (mut lower, mut level) = (0, 0);
        for sample in (0..12).map(|seed| sample(seed, 6, 16, if seed % 3 == 0 { 4 } else { 0 })) {
            for cost in [Cost::Error, Cost::Adr] {
                let last = |search| {
                    let climb = climb_by(&sample, Distance::L2, cost, search, &Unwatched).unwrap();
                    let (error, adr) = figures(Exam::leave_one_out(&sample), Distance::L2, &climb.order());
                    let said = climb.steps.last().map_or(1.0, |step| step.cost);
                    assert_eq!(said, if cost == Cost::Error { error } else { 1.0 - adr });
                    said
                };
                let strict = last(Search::Strict);
                assert!(last(Search::Level) <= strict);
                level += u32::from(last(Search::Level) < strict);
                lower += u32::from(last(Search::Beam) < strict);
            }
        }
        assert!(lower > 5 && level > 0, "{lower} {level}");
    }

    #[test]
    fn the_strict_climb_is_the_climb() {
        for sample in samples() {
            let of = |search| climb_by(&sample, Distance::L1, Cost::Error, search, &Unwatched);
            assert_eq!(of(Search::Strict), climb(&sample, Distance::L1, Cost::Error, &Unwatched));
        }
    }

    #[test]
    fn a_level_stretch_is_crossed() {
        // Every move that was taken on the level leads on to a lower cost: what comes after the last fall is cut off.
        let mut crossed = 0;
        for seed in 0..40 {
            let sample = sample(seed, 5, 14, 3);
            let climb = climb_by(&sample, Distance::L1, Cost::Error, Search::Level, &Unwatched).unwrap();
            let costs: Vec<f64> = climb.steps.iter().map(|step| step.cost).collect();
            assert!(costs.is_sorted_by(|a, b| a >= b));
            if let [.., before, last] = costs[..] {
                assert!(last < before, "seed {seed}: {costs:?}");
            }
            crossed += usize::from(costs.windows(2).any(|pair| pair[0] == pair[1]));
        }
        assert!(crossed > 3, "{crossed}");
    }

    #[test]
    fn threads_do_not_matter() {
        let sample = sample(4, 9, 24, 4);
        for search in Search::ALL {
            let run = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| climb_by(&sample, Distance::L1, Cost::Adr, search, &Unwatched).unwrap())
            };
            assert_eq!(run(1), run(4));
        }
    }

    #[test]
    fn few_or_no_models() {
        for search in Search::ALL {
            for sample in [nobody(), one_class()] {
                let climb = climb_by(&sample, Distance::L2, Cost::Error, search, &Unwatched).unwrap();
                assert!(climb.selected.len() <= 1, "{climb:?}");
            }
        }
    }
}

//! Hill climbing with backward steps (HCBw, paper section 3.2).
//!
//! From an empty selection: *forward*, the one eigenvalue that lowers the cost most is added, as long as one lowers it;
//! *backward*, the one whose removal lowers the cost most is removed, as long as one does; then forward again, until
//! neither moves. Every move strictly lowers the cost, so that the climb ends. Costs are compared as integers
//! ([`Judge`]): a tie is a tie, and goes to the lowest index. The empty selection has a cost of 1.

#![allow(
    clippy::inline_always,
    reason = "what is not inlined is not compiled for the wider vectors of pulp's dispatch"
)]

use serde::{Deserialize, Serialize};

use self::judge::Judge;
use crate::{
    metrics::{Cancelled, Distance, Sample, by_distance},
    watch::Watch,
};

mod ask;
mod block;
mod ground;
mod habits;
mod judge;
mod line;
mod order;
mod race;
mod row;
mod search;
mod single;
mod sketch;

/// What hill climbing minimises.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Cost {
    /// The classification error ε (Table 2).
    #[default]
    Error,
    /// 1 − mean ADR (Table 4).
    Adr,
}

/// Which moves hill climbing takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Search {
    /// Those that lower the cost, the paper's.
    #[default]
    Strict,
    /// Where none does, those that leave it as it is, too, to selections not seen before: up to [`PATIENCE`] in a row.
    /// What is found ends where the least cost was first reached.
    Level,
    /// [`BEAM`] selections at a time, each with its best additions, whether they lower the cost or not, and with
    /// removals while these do; until the least cost has not fallen for two additions.
    Beam,
}

impl Search {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Strict, Self::Level, Self::Beam];
}

/// Moves in a row that may leave the cost as it is.
pub const PATIENCE: usize = 10;
/// Selections that a beam keeps.
pub const BEAM: usize = 6;

/// One accepted move of hill climbing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Step {
    /// The eigenvalue index, from 1.
    pub index: u32,
    /// True when it was added, false when it was removed.
    pub added: bool,
    /// The cost after the move.
    pub cost: f64,
}

/// What hill climbing found.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Climb {
    /// Eigenvalue indices, from 1, ascending.
    pub selected: Vec<u32>,
    /// The accepted moves in their order.
    pub steps: Vec<Step>,
}

impl Climb {
    /// The largest index that any accepted move touched: the run over a shorter spectrum that still holds it is the
    /// same run.
    #[must_use]
    pub fn reach(&self) -> u32 {
        self.steps.iter().map(|step| step.index).max().unwrap_or(0)
    }

    /// The selected indices in the order in which they came to stay. The climb sums distances in this order.
    #[must_use]
    pub fn order(&self) -> Vec<u32> {
        let mut order = Vec::new();
        for step in &self.steps {
            if step.added {
                order.push(step.index);
            } else {
                order.retain(|&index| index != step.index);
            }
        }
        order
    }
}

/// Climbs over all features of the training models, leave-one-out, as the paper does.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn climb(sample: &Sample, distance: Distance, cost: Cost, watch: &dyn Watch) -> Result<Climb, Cancelled> {
    climb_by(sample, distance, cost, Search::Strict, watch)
}

/// Climbs by other moves.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn climb_by(
    sample: &Sample,
    distance: Distance,
    cost: Cost,
    search: Search,
    watch: &dyn Watch,
) -> Result<Climb, Cancelled> {
    let judge = Judge::new(sample, cost);
    by_distance!(distance, T => search::run::<T>(sample, &judge, search, watch))
}

#[cfg(test)]
mod tests {
    use super::{Climb, Cost, Step, climb};
    use crate::{
        metrics::{
            Cancelled, Distance, Exam, Features, Sample, figures,
            samples::{nobody, one_class, sample, samples},
        },
        watch::{Unwanted, Unwatched},
    };

    /// The definition, candidate by candidate.
    fn by_definition(sample: &Sample, distance: Distance, cost: Cost) -> Climb {
        let cost_of = |selection: &[u32]| {
            let (error, adr) = figures(Exam::leave_one_out(sample), distance, selection);
            if cost == Cost::Error { error } else { 1.0 - adr }
        };
        let mut climb = Climb::default();
        let mut selected: Vec<u32> = Vec::new();
        let mut least = 1.0;
        loop {
            let moves = climb.steps.len();
            for added in [true, false] {
                loop {
                    let mut best = None;
                    for index in (1..=sample.train.cols() as u32).filter(|index| selected.contains(index) != added) {
                        let mut next = selected.clone();
                        next.retain(|&other| other != index);
                        if added {
                            next.push(index);
                        }
                        let cost = cost_of(&next);
                        if cost < least {
                            least = cost;
                            best = Some((index, next));
                        }
                    }
                    let Some((index, next)) = best else { break };
                    selected = next;
                    climb.steps.push(Step { index, added, cost: least });
                }
            }
            if climb.steps.len() == moves {
                break;
            }
        }
        selected.sort_unstable();
        Climb { selected, ..climb }
    }

    #[test]
    fn climbs_as_defined() {
        for sample in samples() {
            for distance in Distance::ALL {
                for cost in [Cost::Error, Cost::Adr] {
                    let climb = climb(&sample, distance, cost, &Unwatched).unwrap();
                    assert_eq!(climb, by_definition(&sample, distance, cost));
                }
            }
        }
    }

    #[test]
    fn copies_of_a_model_change_nothing_of_the_definition() {
        for seed in 0..2 {
            for (largest, cols) in [(6, 12), (14, 10)] {
                let mut sample = sample(seed, largest, cols, 0);
                let mut rows: Vec<Vec<f64>> =
                    (0..sample.train.rows()).map(|row| sample.train.row(row).to_vec()).collect();
                // Within a class, and the same shape under two labels.
                for (copied, label) in [(0, sample.train_labels[0]), (1, sample.train_labels[1]), (2, 1), (0, 1)] {
                    rows.push(rows[copied].clone());
                    sample.train_labels.push(label);
                }
                sample.train = Features::from_rows(rows);
                for distance in Distance::ALL {
                    for cost in [Cost::Error, Cost::Adr] {
                        let climb = climb(&sample, distance, cost, &Unwatched).unwrap();
                        assert_eq!(climb, by_definition(&sample, distance, cost), "{seed} {distance:?} {cost:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn features_of_any_size_climb_as_defined() {
        for seed in 0..3 {
            let plain = sample(seed, 9, 10, 0);
            for (from, size) in [(1e5, 1.0), (0.0, 1e-25), (0.0, 1e-60), (0.0, 1e25), (0.0, 1e170), (3.0, 1e-3)] {
                // Some columns stay as they are: sums are made of both.
                let rows = (0..plain.train.rows()).map(|row| {
                    let features = plain.train.row(row).iter().enumerate();
                    features
                        .map(|(col, value)| if col % 4 == 3 { *value } else { from + size * value })
                        .collect::<Vec<_>>()
                });
                let sample = Sample { train: Features::from_rows(rows), ..plain.clone() };
                for distance in Distance::ALL {
                    for cost in [Cost::Error, Cost::Adr] {
                        let climb = climb(&sample, distance, cost, &Unwatched).unwrap();
                        assert_eq!(climb, by_definition(&sample, distance, cost), "{seed} {from} {size} {distance:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn large_classes_whose_recall_is_rounded_climb_as_defined() {
        // Two classes of 44 and 43 that one column tells apart, so that models find all of their class.
        let all = sample(3, 44, 4, 0);
        let mut large = Sample { classes: 2, ..Sample::default() };
        let known = (0..all.train.rows()).filter(|&row| all.train_labels[row] < 2);
        let rows: Vec<Vec<f64>> = known
            .map(|row| {
                let label = all.train_labels[row];
                large.train_labels.push(label);
                let mut features = all.train.row(row).to_vec();
                features[2] += 100.0 * f64::from(label);
                features
            })
            .collect();
        large.train = Features::from_rows(rows);
        let climb = climb(&large, Distance::L2, Cost::Adr, &Unwatched).unwrap();
        assert_eq!(climb, by_definition(&large, Distance::L2, Cost::Adr));
        assert_eq!(climb.selected, [3]);
    }

    #[test]
    fn steps_back_as_defined() {
        let mut removals = 0;
        for seed in 0..120 {
            let sample = sample(seed, 6, 20, 0);
            for cost in [Cost::Error, Cost::Adr] {
                let climb = climb(&sample, Distance::L2, cost, &Unwatched).unwrap();
                if climb.steps.iter().any(|step| !step.added) {
                    removals += 1;
                    assert_eq!(climb, by_definition(&sample, Distance::L2, cost));
                }
            }
        }
        assert!(removals > 5, "{removals}");
    }

    #[test]
    fn the_order_is_that_of_the_additions_that_stayed() {
        let climb = Climb {
            selected: vec![2, 4],
            steps: [(7, true), (4, true), (2, true), (7, false)]
                .map(|(index, added)| Step { index, added, cost: 0.5 })
                .to_vec(),
        };
        assert_eq!((climb.order(), climb.reach()), (vec![4, 2], 7));
    }

    #[test]
    fn a_climb_that_reaches_less_is_the_same_over_fewer_features() {
        let mut shorter = 0;
        for seed in 0..12 {
            let sample = sample(seed, 7, 24, if seed % 2 == 0 { 0 } else { 5 });
            for cost in [Cost::Error, Cost::Adr] {
                let wide = climb(&sample, Distance::L2, cost, &Unwatched).unwrap();
                for cols in wide.reach() as usize..24 {
                    assert_eq!(climb(&sample.prefix(cols), Distance::L2, cost, &Unwatched).unwrap(), wide);
                    shorter += 1;
                }
            }
        }
        assert!(shorter > 20);
    }

    #[test]
    fn threads_do_not_matter() {
        let sample = sample(4, 14, 40, 4);
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| climb(&sample, Distance::L1, Cost::Adr, &Unwatched).unwrap())
        };
        let one = run(1);
        for threads in 2..6 {
            assert_eq!(run(threads), one);
        }
    }

    #[test]
    fn useless_features_are_not_selected() {
        let mut sample = one_class();
        sample.train_labels = vec![0, 1, 2];
        sample.classes = 3;
        // Everyone is alone in its class: whatever is selected, all are wrong.
        assert_eq!(climb(&sample, Distance::L2, Cost::Error, &Unwatched), Ok(Climb::default()));
        assert_eq!(climb(&sample, Distance::L2, Cost::Adr, &Unwatched), Ok(Climb::default()));
        assert_eq!(climb(&nobody(), Distance::L2, Cost::Error, &Unwatched), Ok(Climb::default()));
        let lone =
            Sample { train: Features::from_rows([[1.0]]), train_labels: vec![0], classes: 1, ..Sample::default() };
        assert_eq!(climb(&lone, Distance::L2, Cost::Adr, &Unwatched), Ok(Climb::default()));
    }

    #[test]
    fn of_equal_features_the_lowest_is_taken() {
        let row = |value: f64| [0.0, value, value, 2.0 * value];
        let sample = Sample {
            train: Features::from_rows([0.0, 0.1, 1.0, 1.1].map(row)),
            train_labels: vec![0, 0, 1, 1],
            classes: 2,
            ..Sample::default()
        };
        let climb = climb(&sample, Distance::L2, Cost::Error, &Unwatched).unwrap();
        assert_eq!(climb.selected, [2]);
        assert_eq!(climb.steps, [Step { index: 2, added: true, cost: 0.0 }]);
    }

    #[test]
    fn stops_when_cancelled() {
        assert_eq!(climb(&sample(5, 5, 5, 0), Distance::L2, Cost::Adr, &Unwanted), Err(Cancelled));
    }
}

//! Methods that learn from labelled models and are asked for others.

use serde::{Deserialize, Serialize};

use crate::{
    metrics::{Cancelled, Columns, Distance, Exam, Sample, gained, ranking, ranks, sums},
    selection::{Cost, Ranges, Search, SelCount, Stop, Strong, Weak, boost_by, climb_by, decide, held_out, stop_at},
    study::first_k,
    watch::Watch,
};

/// A way from labelled models to the class of another one.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Learner {
    /// Nearest neighbour over the first k eigenvalues, k with the least leave-one-out ε.
    FirstK,
    /// Nearest neighbour over the first k eigenvalues, k with the greatest leave-one-out mean ADR.
    FirstKAdr,
    /// Nearest neighbour over as many of the first eigenvalues: nothing is selected.
    Fixed(u32),
    /// Nearest neighbour over what hill climbing selects, for a cost and by certain moves.
    Hill(Cost, Search),
    /// AdaBoost's strong classifiers.
    Boost {
        /// Rounds, at most.
        rounds: u32,
        /// What they are made of.
        weak: Weak,
        /// When they end.
        stop: Stop,
    },
}

/// What a method made of the training models, asked for the queries.
pub(super) struct Verdict {
    /// For each model asked: whether it was given a wrong class.
    pub(super) wrong: Vec<bool>,
    /// For each, its ADR, or none when it has nothing to find; none at all for methods that rank no models.
    pub(super) adr: Option<Vec<Option<f64>>>,
    /// How many eigenvalues were selected.
    pub(super) selected: f64,
}

impl Learner {
    /// The paper's three for ε, hill climbing for mean ADR, and two that select nothing.
    pub const DEFAULT: [Self; 6] =
        [Self::FirstK, Self::HILL, Self::BOOST, Self::Hill(Cost::Adr, Search::Strict), Self::Fixed(50), Self::ALL];
    /// Hill climbing for ε, as in the paper.
    pub const HILL: Self = Self::Hill(Cost::Error, Search::Strict);
    /// AdaBoost as in the paper.
    pub const BOOST: Self = Self::Boost { rounds: 20, weak: Weak::Range, stop: Stop::Fixed };
    /// Nearest neighbour over all eigenvalues.
    pub const ALL: Self = Self::Fixed(u32::MAX);

    /// Its name in tables.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::FirstK => "first-k".to_owned(),
            Self::FirstKAdr => "first-k (ADR)".to_owned(),
            Self::Fixed(u32::MAX) => "all".to_owned(),
            Self::Fixed(k) => format!("first {k}"),
            Self::Hill(cost, search) => {
                let cost = if cost == Cost::Error { "" } else { " (ADR)" };
                let search = match search {
                    Search::Strict => "",
                    Search::Level => ", level",
                    Search::Beam => ", beam",
                };
                format!("HCBw{cost}{search}")
            }
            Self::Boost { rounds, weak, stop } => {
                let weak = match weak {
                    Weak::Range => "",
                    Weak::Interval => ", intervals",
                    Weak::Threshold => ", thresholds",
                };
                let rounds = match stop {
                    Stop::Fixed => format!("T = {rounds}"),
                    Stop::Early => format!("T ≤ {rounds}"),
                };
                format!("AdaBoost{weak}, {rounds}")
            }
        }
    }

    /// Learns on the training models; `exams` are asked, in their order.
    pub(super) fn learn(
        self,
        sample: &Sample,
        distance: Distance,
        exams: &[Exam<'_>],
        watch: &dyn Watch,
    ) -> Result<Vec<Verdict>, Cancelled> {
        let first = |k: usize| (1..=k as u32).collect::<Vec<_>>();
        let selection = match self {
            Self::Boost { rounds, weak, stop } => {
                return boosted(sample, (rounds as usize, weak, stop), exams, watch);
            }
            Self::FirstK | Self::FirstKAdr => {
                let curves = first_k(sample, distance, watch)?;
                first(if self == Self::FirstK { curves.best_error } else { curves.best_adr })
            }
            Self::Fixed(k) => first((k as usize).min(sample.train.cols())),
            Self::Hill(cost, search) => climb_by(sample, distance, cost, search, watch)?.order(),
        };
        Ok(exams.iter().map(|&exam| nearest(sample, distance, exam, &selection)).collect())
    }
}

/// The class of the nearest model. Without anything selected all decisions are wrong.
pub(super) fn nearest(sample: &Sample, distance: Distance, exam: Exam<'_>, selection: &[u32]) -> Verdict {
    let columns = Columns::new(&sample.train);
    let (relevant, recall) = (exam.relevant(), exam.recall());
    let ask = |asked: usize| {
        let ranking = ranking(&sums(exam, &columns, asked, distance, selection), exam.left_out(asked));
        let label = exam.label(asked);
        let wrong = selection.is_empty() || ranking.first().is_none_or(|&first| exam.labels()[first as usize] != label);
        let ranks = ranks(ranking, exam.labels(), label);
        let adr = || match gained(&recall, relevant[asked], &ranks) {
            _ if selection.is_empty() => 0.0,
            gained => gained as f64 / recall.scale() as f64,
        };
        (wrong, (relevant[asked] > 0).then(adr))
    };
    let (wrong, adr) = (0..exam.len()).map(ask).unzip();
    Verdict { wrong, adr: Some(adr), selected: selection.len() as f64 }
}

/// How AdaBoost is run: rounds at most, what is asked of an eigenvalue, and when it ends.
pub(super) type Boosting = (usize, Weak, Stop);

/// AdaBoost's classifiers.
pub(super) fn strong(
    sample: &Sample,
    (rounds, weak, stop): Boosting,
    watch: &dyn Watch,
) -> Result<Vec<Strong>, Cancelled> {
    let rounds = match stop {
        Stop::Fixed => rounds,
        Stop::Early => stop_at(&held_out(sample, rounds, weak, watch)?, rounds),
    };
    boost_by(sample, rounds, weak, watch)
}

fn boosted(
    sample: &Sample,
    boosting: Boosting,
    exams: &[Exam<'_>],
    watch: &dyn Watch,
) -> Result<Vec<Verdict>, Cancelled> {
    let strong = strong(sample, boosting, watch)?;
    let ranges = Ranges::new(sample);
    let known: Vec<usize> = (0..sample.classes).filter(|&class| ranges.known(class)).collect();
    let selected: usize = known.iter().map(|&class| strong[class].selected(SelCount::Chosen)).sum();
    let ask = |exam: &Exam<'_>| {
        let wrong = |asked: usize| {
            let score =
                |class: usize| ranges.known(class).then(|| strong[class].score(class, &ranges, exam.row(asked)));
            decide(&(0..sample.classes).map(score).collect::<Vec<_>>()) != Some(exam.label(asked))
        };
        let wrong = (0..exam.len()).map(wrong).collect();
        Verdict { wrong, adr: None, selected: selected as f64 / known.len().max(1) as f64 }
    };
    Ok(exams.iter().map(ask).collect())
}

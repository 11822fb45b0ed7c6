//! Why a model was put where it was: the decisions of a method, the neighbours of one model, what each eigenvalue
//! added, and where in the spectrum the models of a class keep together.
//!
//! Everything here is an explanation of figures that other rooms compute: the share of wrong decisions is their ε, the
//! terms add up to the distance.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub use self::{
    apart::{Apart, apart},
    bands::{Band, Shared, shared},
    neighbours::{Neighbour, Neighbours, neighbours},
    votes::{Vote, Votes, votes},
};
use super::Boosted;
use crate::metrics::{Distance, Exam, Sample};

mod apart;
mod bands;
mod neighbours;
mod votes;

/// How the class of a model is decided.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// The nearest training model over the first k eigenvalues.
    #[default]
    FirstK,
    /// The same with the k of the least ε on D.
    BestK,
    /// The nearest training model over what hill climbing for ε selected.
    ClimbError,
    /// The nearest training model over what hill climbing for mean ADR selected.
    ClimbAdr,
    /// The strong classifier that is surest.
    Boost,
}

impl Method {
    /// All of them, in the order of the tables.
    pub const ALL: [Self; 5] = [Self::FirstK, Self::BestK, Self::ClimbError, Self::ClimbAdr, Self::Boost];

    /// Its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FirstK => "first k",
            Self::BestK => "first k, best",
            Self::ClimbError => "HCBw for ε",
            Self::ClimbAdr => "HCBw for ADR",
            Self::Boost => "AdaBoost",
        }
    }

    /// The method so many places further, going round.
    #[must_use]
    pub fn turned(self, by: isize) -> Self {
        Self::ALL[(self as isize + by).rem_euclid(Self::ALL.len() as isize) as usize]
    }
}

/// The class that a method decided for every model: the training models in their order (each against all others, except
/// for AdaBoost, which has learnt from them), then the query models. [`Boosted::NONE`] where there is no class to
/// decide for.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Decisions {
    /// The class decided.
    pub decided: Vec<u32>,
    /// The true class.
    pub truth: Vec<u32>,
    /// How many of the models are training models.
    pub train: usize,
}

impl Decisions {
    /// What a strong classifier of every class decided.
    #[must_use]
    pub fn of_boosted(sample: &Sample, boosted: &Boosted) -> Self {
        Self { decided: boosted.decided.clone(), truth: truth(sample), train: sample.train.rows() }
    }

    /// Share of wrong decisions on D and on Q; none where there is no model.
    #[must_use]
    pub fn error(&self) -> (Option<f64>, Option<f64>) {
        let share = |from: usize, to: usize| {
            let wrong = (from..to).filter(|&model| self.decided[model] != self.truth[model]).count();
            (to > from).then(|| wrong as f64 / (to - from) as f64)
        };
        (share(0, self.train), share(self.train, self.truth.len()))
    }
}

fn truth(sample: &Sample) -> Vec<u32> {
    [sample.train_labels.as_slice(), &sample.query_labels].concat()
}

/// Puts every model into the class of its nearest training model over the features `selection` (indices from 1).
///
/// An empty selection tells nothing apart and decides for no class.
///
/// # Panics
/// When an index is out of range.
#[must_use]
pub fn decisions(sample: &Sample, distance: Distance, selection: &[u32]) -> Decisions {
    let nearest = |exam: Exam<'_>, asked: usize| {
        if selection.is_empty() {
            return Boosted::NONE;
        }
        let row = exam.row(asked);
        let models = (0..exam.models().rows()).filter(|&model| Some(model) != exam.left_out(asked));
        let first = models
            .map(|model| (distance.sum(row, exam.models().row(model), selection), model))
            .min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        first.map_or(Boosted::NONE, |(_, model)| exam.labels()[model])
    };
    let of = |exam: Exam<'_>| (0..exam.len()).into_par_iter().map(|asked| nearest(exam, asked)).collect::<Vec<_>>();
    let decided = [of(Exam::leave_one_out(sample)), of(Exam::queries(sample))].concat();
    Decisions { decided, truth: truth(sample), train: sample.train.rows() }
}

/// The exam and the place in it of the model at `row` of a sample: training models first, then query models.
fn seat(sample: &Sample, row: usize) -> Option<(Exam<'_>, usize)> {
    let train = sample.train.rows();
    if row < train {
        Some((Exam::leave_one_out(sample), row))
    } else {
        (row - train < sample.query.rows()).then(|| (Exam::queries(sample), row - train))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{figures, samples::samples};

    #[test]
    fn the_share_of_wrong_decisions_is_the_error() {
        for sample in samples() {
            for distance in Distance::ALL {
                let selection = [2, 1];
                let found = decisions(&sample, distance, &selection);
                let (train, query) = found.error();
                let of = |exam: Exam<'_>| (!exam.is_empty()).then(|| figures(exam, distance, &selection).0);
                assert_eq!(train, of(Exam::leave_one_out(&sample)));
                assert_eq!(query, of(Exam::queries(&sample)));
            }
        }
    }

    #[test]
    fn nothing_selected_decides_nothing() {
        let sample = &samples()[0];
        assert!(decisions(sample, Distance::L2, &[]).decided.iter().all(|&class| class == Boosted::NONE));
    }

    #[test]
    fn methods_go_round() {
        assert_eq!(Method::FirstK.turned(-1), Method::Boost);
        assert_eq!(Method::Boost.turned(1), Method::FirstK);
    }
}

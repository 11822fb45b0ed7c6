//! Where the views that explain look: a method, a cell of the confusion matrix, a neighbour.

use crate::{
    dataset::Role,
    query::Answer,
    study::{Method, why::Decisions},
};

/// Which models a confusion matrix counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Side {
    /// All of them.
    #[default]
    Both,
    /// Those of D.
    Train,
    /// Those of Q.
    Query,
}

impl Side {
    /// The side after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Both => Self::Train,
            Self::Train => Self::Query,
            Self::Query => Self::Both,
        }
    }

    /// What it counts.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Both => "D and Q",
            Self::Train => "D",
            Self::Query => "Q",
        }
    }

    /// Whether it counts a model of this role.
    #[must_use]
    pub fn takes(self, role: Role) -> bool {
        match self {
            Self::Both => true,
            Self::Train => role == Role::Train,
            Self::Query => role == Role::Query,
        }
    }
}

/// What the explaining views look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Why {
    /// The method explained.
    pub method: Method,
    /// The models counted.
    pub side: Side,
    /// The cell of the confusion matrix: true class and decided class; may lie outside after classes went.
    pub cell: (usize, usize),
    /// The place among the neighbours; may lie beyond their end.
    pub neighbour: usize,
    /// Where there is room for one of them: the two spectra instead of the terms.
    pub overlaid: bool,
    /// Where there is room for one of them: the sweep instead of the pins.
    pub swept: bool,
}

impl Why {
    /// Moves the cell and stops at the ends.
    pub fn shift(&mut self, down: isize, right: isize, classes: usize) {
        let last = classes.saturating_sub(1);
        let moved = |at: usize, by: isize| at.min(last).saturating_add_signed(by).min(last);
        self.cell = (moved(self.cell.0, down), moved(self.cell.1, right));
    }

    /// The places in the answer's list of the models in a cell, nearest to the list's order.
    #[must_use]
    pub fn models(&self, answer: &Answer, decisions: &Decisions, places: &[usize]) -> Vec<usize> {
        let (truth, decided) = self.cell;
        let mut found: Vec<usize> = decisions
            .truth
            .iter()
            .zip(&decisions.decided)
            .zip(places)
            .filter(|((t, d), _)| **t as usize == truth && **d as usize == decided)
            .map(|(_, &place)| place)
            .filter(|&place| answer.models.get(place).is_some_and(|model| self.side.takes(model.role)))
            .collect();
        found.sort_unstable();
        found
    }
}

/// A confusion matrix, and what stands out in it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Matrix {
    /// Rows: the true class; columns: the class decided.
    pub counts: Vec<Vec<u32>>,
    /// Models counted.
    pub total: u32,
    /// Of them in the wrong class.
    pub wrong: u32,
    /// The cells off the diagonal that hold something, the fullest first: true class, class decided, models.
    pub worst: Vec<(usize, usize, u32)>,
}

impl Matrix {
    /// Counts the decisions for the models of a side; `places` names the model of each decision.
    #[must_use]
    pub fn new(side: Side, answer: &Answer, decisions: &Decisions, places: &[usize]) -> Self {
        let classes = answer.classes.len();
        let mut counts = vec![vec![0; classes]; classes];
        let (mut total, mut wrong) = (0, 0);
        for ((&truth, &decided), &place) in decisions.truth.iter().zip(&decisions.decided).zip(places) {
            if !answer.models.get(place).is_some_and(|model| side.takes(model.role)) {
                continue;
            }
            total += 1;
            wrong += u32::from(truth != decided);
            if let Some(count) =
                counts.get_mut(truth as usize).and_then(|row: &mut Vec<u32>| row.get_mut(decided as usize))
            {
                *count += 1;
            }
        }
        let mut worst: Vec<(usize, usize, u32)> = (0..classes)
            .flat_map(|truth| (0..classes).map(move |decided| (truth, decided)))
            .filter(|(truth, decided)| truth != decided)
            .map(|(truth, decided)| (truth, decided, counts[truth][decided]))
            .filter(|(.., count)| *count > 0)
            .collect();
        worst.sort_by_key(|&(truth, decided, count)| (std::cmp::Reverse(count), truth, decided));
        Self { counts, total, wrong, worst }
    }
}

impl Matrix {
    /// Of a class: how many models are in the wrong class, and how many there are.
    #[must_use]
    pub fn wrong_of(&self, class: usize) -> (u32, u32) {
        let row = self.counts.get(class).map_or(&[][..], Vec::as_slice);
        let all: u32 = row.iter().sum();
        (all - row.get(class).copied().unwrap_or(0), all)
    }

    /// The class with the greatest share of its models in the wrong class, the first of several; none when all are
    /// right.
    #[must_use]
    pub fn most_confused(&self) -> Option<usize> {
        let share = |class: usize| {
            let (wrong, all) = self.wrong_of(class);
            f64::from(wrong) / f64::from(all.max(1))
        };
        let classes = (0..self.counts.len()).filter(|&class| share(class) > 0.0);
        classes.fold(None, |best: Option<usize>, class| match best {
            Some(best) if share(best) >= share(class) => Some(best),
            _ => Some(class),
        })
    }

    /// The classes that a class is taken for, the most frequent first, with how often.
    #[must_use]
    pub fn taken_for(&self, class: usize) -> Vec<(usize, u32)> {
        self.worst.iter().filter(|(truth, ..)| *truth == class).map(|&(_, decided, count)| (decided, count)).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::query::{ModelRow, ModelState};

    fn answer() -> Answer {
        let model = |role| ModelRow {
            name: String::new(),
            path: std::path::PathBuf::new(),
            class: 0,
            role,
            state: ModelState::Waiting,
            size: None,
            measure: None,
            defects: Arc::default(),
            eigenvalues: None,
        };
        Answer {
            classes: Arc::new(vec!["a".to_owned(), "b".to_owned()]),
            models: Arc::new([Role::Train, Role::Train, Role::Query, Role::Train].map(model).to_vec()),
            ..Answer::default()
        }
    }

    #[test]
    fn models_are_counted_by_side_and_found_by_cell() {
        let (answer, places) = (answer(), [0, 1, 3, 2]);
        let decisions = Decisions { decided: vec![0, 1, 1, 1], truth: vec![0, 0, 0, 0], train: 3 };
        let both = Matrix::new(Side::Both, &answer, &decisions, &places);
        assert_eq!((both.total, both.wrong, both.counts[0].as_slice()), (4, 3, [1, 3].as_slice()));
        assert_eq!(both.worst, [(0, 1, 3)]);
        assert_eq!((both.wrong_of(0), both.wrong_of(1), both.wrong_of(9)), ((3, 4), (0, 0), (0, 0)));
        assert_eq!((both.most_confused(), both.taken_for(0)), (Some(0), vec![(1, 3)]));
        assert_eq!(Matrix::new(Side::Query, &answer, &decisions, &places).worst, [(0, 1, 1)]);
        let mut why = Why { cell: (0, 1), ..Why::default() };
        assert_eq!(why.models(&answer, &decisions, &places), [1, 2, 3]);
        why.side = Side::Train;
        assert_eq!(why.models(&answer, &decisions, &places), [1, 3]);
        // A place that is gone is not counted.
        assert_eq!(Matrix::new(Side::Both, &answer, &decisions, &[0, 1, 9, 9]).total, 2);
    }

    #[test]
    fn the_cell_stays_inside() {
        let mut why = Why { cell: (9, 0), ..Why::default() };
        why.shift(0, 1, 3);
        assert_eq!(why.cell, (2, 1));
        why.shift(-9, 9, 3);
        assert_eq!(why.cell, (0, 2));
        why.shift(1, 1, 0);
        assert_eq!(why.cell, (0, 0));
    }
}

//! The list of models: which are listed, and which is looked at.

use crate::query::{Answer, ModelRow, ModelState};

/// Which models are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// All of them.
    #[default]
    All,
    /// Those with a defect, or that take no part.
    Defects,
    /// Those that take no part.
    Out,
}

impl Filter {
    /// The filter after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::All => Self::Defects,
            Self::Defects => Self::Out,
            Self::Out => Self::All,
        }
    }

    /// What it lists.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "all models",
            Self::Defects => "models with defects",
            Self::Out => "models that take no part",
        }
    }

    /// Whether it lists this model.
    #[must_use]
    pub fn takes(self, model: &ModelRow) -> bool {
        let out = matches!(model.state, ModelState::Out { .. });
        match self {
            Self::All => true,
            Self::Defects => out || !model.defects.is_empty(),
            Self::Out => out,
        }
    }
}

/// The model looked at, and which are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ModelList {
    /// Which models are listed.
    pub filter: Filter,
    /// Position in the filtered list; may lie beyond its end after the list became shorter.
    pub at: usize,
}

impl ModelList {
    /// Indices of the listed models.
    #[must_use]
    pub fn listed(&self, answer: &Answer) -> Vec<usize> {
        let listed = |index: &usize| self.filter.takes(&answer.models[*index]);
        (0..answer.models.len()).filter(listed).collect()
    }

    /// Moves by so many rows and stops at the ends.
    pub fn shift(&mut self, by: isize, answer: &Answer) {
        let last = self.listed(answer).len().saturating_sub(1);
        self.at = self.at.min(last).saturating_add_signed(by).min(last);
    }

    /// Lists others, and keeps looking at the same model where it is among them.
    pub fn cycle(&mut self, answer: &Answer) {
        let looked_at = self.listed(answer).get(self.at).copied();
        self.filter = self.filter.next();
        let listed = self.listed(answer);
        self.at = looked_at.and_then(|model| listed.iter().position(|other| *other == model)).unwrap_or(0);
    }
}

//! The list of models: which are listed, in which order, and which is looked at.

use std::cmp::Ordering;

use crate::query::{Answer, ModelRow, ModelState};

/// Which models are listed by how they stand.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Filter {
    /// All of them.
    #[default]
    All,
    /// Those that are being read or solved now, or wait for it.
    Working,
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
            Self::Out => Self::Working,
            Self::Working => Self::All,
        }
    }

    /// What it lists.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::All => "all models",
            Self::Working => "models not solved yet",
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
            Self::Working => matches!(model.state, ModelState::Waiting | ModelState::Working { .. }),
            Self::Defects => out || !model.defects.is_empty(),
            Self::Out => out,
        }
    }
}

/// In which order models are listed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sort {
    /// The data set's.
    #[default]
    Place,
    /// By name, numbers in it by their value.
    Name,
    /// By the number of vertices, most first.
    Vertices,
    /// By the time the spectrum took, longest first.
    Time,
    /// By the number of defects, most first.
    Defects,
}

impl Sort {
    /// The order after this one.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Place => Self::Name,
            Self::Name => Self::Vertices,
            Self::Vertices => Self::Time,
            Self::Time => Self::Defects,
            Self::Defects => Self::Place,
        }
    }

    /// What it goes by.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Place => "the data set's order",
            Self::Name => "by name",
            Self::Vertices => "by vertices",
            Self::Time => "by time",
            Self::Defects => "by defects",
        }
    }

    fn compare(self, a: &ModelRow, b: &ModelRow) -> Ordering {
        let seconds = |model: &ModelRow| match model.state {
            ModelState::Ready { seconds, .. } => seconds,
            _ => 0.0,
        };
        match self {
            Self::Place => Ordering::Equal,
            Self::Name => natural(&a.name, &b.name),
            Self::Vertices => b.size.cmp(&a.size),
            Self::Time => seconds(b).total_cmp(&seconds(a)),
            Self::Defects => b.defects.len().cmp(&a.defects.len()),
        }
    }
}

/// Compares names with the numbers in them by their value: `m2` before `m10`.
fn natural(a: &str, b: &str) -> Ordering {
    let (mut a, mut b) = (a.chars().peekable(), b.chars().peekable());
    let number = |chars: &mut std::iter::Peekable<std::str::Chars<'_>>| {
        let mut value = 0_u128;
        while let Some(digit) = chars.peek().and_then(|c| c.to_digit(10)) {
            value = value.saturating_mul(10).saturating_add(u128::from(digit));
            chars.next();
        }
        value
    };
    loop {
        let order = match (a.peek().copied(), b.peek().copied()) {
            (None, None) => return Ordering::Equal,
            (None, _) => return Ordering::Less,
            (_, None) => return Ordering::Greater,
            (Some(x), Some(y)) if x.is_ascii_digit() && y.is_ascii_digit() => number(&mut a).cmp(&number(&mut b)),
            (Some(x), Some(y)) => {
                a.next();
                b.next();
                x.cmp(&y)
            }
        };
        if order != Ordering::Equal {
            return order;
        }
    }
}

/// Some models, chosen elsewhere.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Only {
    /// What they have in common.
    pub label: String,
    /// Their places in the answer's list.
    pub models: Vec<usize>,
}

/// The model looked at, and which are listed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ModelList {
    /// Which models are listed by how they stand.
    pub filter: Filter,
    /// Only these are listed.
    pub only: Option<Only>,
    /// Only models with this in their name or class are listed, whatever the case; all when it is empty.
    pub needle: String,
    /// The order.
    pub sort: Sort,
    /// The other way round.
    pub reversed: bool,
    /// Position in the list; may lie beyond its end after the list became shorter.
    pub at: usize,
}

impl ModelList {
    /// Indices of the listed models, in the order of the list.
    #[must_use]
    pub fn listed(&self, answer: &Answer) -> Vec<usize> {
        let needle = self.needle.to_lowercase();
        let class = |model: &ModelRow| answer.classes.get(model.class as usize).map_or("", String::as_str);
        let named = |model: &ModelRow| {
            needle.is_empty()
                || model.name.to_lowercase().contains(&needle)
                || class(model).to_lowercase().contains(&needle)
        };
        let chosen = |index: &usize| self.only.as_ref().is_none_or(|only| only.models.binary_search(index).is_ok());
        let mut listed: Vec<usize> = (0..answer.models.len())
            .filter(|index| chosen(index) && self.filter.takes(&answer.models[*index]) && named(&answer.models[*index]))
            .collect();
        listed.sort_by(|&a, &b| self.sort.compare(&answer.models[a], &answer.models[b]));
        if self.reversed {
            listed.reverse();
        }
        listed
    }

    /// The model looked at.
    #[must_use]
    pub fn model(&self, answer: &Answer) -> Option<usize> {
        let listed = self.listed(answer);
        listed.get(self.at.min(listed.len().saturating_sub(1))).copied()
    }

    /// Moves by so many rows and stops at the ends.
    pub fn shift(&mut self, by: isize, answer: &Answer) {
        let last = self.listed(answer).len().saturating_sub(1);
        self.at = self.at.min(last).saturating_add_signed(by).min(last);
    }

    /// Looks at a model; lists all of them when it is not among those listed.
    pub fn look_at(&mut self, model: usize, answer: &Answer) {
        let find = |list: &Self| list.listed(answer).iter().position(|other| *other == model);
        if let Some(at) = find(self) {
            self.at = at;
        } else {
            *self = Self { sort: self.sort, reversed: self.reversed, ..Self::default() };
            self.at = find(self).unwrap_or(0);
        }
    }

    /// Lists other models or in another order, and keeps looking at the same one where it is among them.
    pub fn change(&mut self, answer: &Answer, change: impl FnOnce(&mut Self)) {
        let looked_at = self.model(answer);
        change(self);
        let listed = self.listed(answer);
        self.at = looked_at.and_then(|model| listed.iter().position(|other| *other == model)).unwrap_or(0);
    }

    /// True when some models may not be listed.
    #[must_use]
    pub fn narrowed(&self) -> bool {
        self.filter != Filter::All || self.only.is_some() || !self.needle.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_names_go_by_their_value() {
        let mut names = ["m10", "m9", "b", "m", "m09x", "m100000000000000000000000000000000000000000"];
        names.sort_by(|a, b| natural(a, b));
        assert_eq!(names, ["b", "m", "m9", "m09x", "m10", "m100000000000000000000000000000000000000000"]);
    }
}

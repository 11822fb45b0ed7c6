//! Names of models where their class stands beside them.

use std::collections::HashSet;

use crate::query::{Answer, ModelRow};

/// How models are named in lists: by the last part of their name, where that with class and side tells them apart.
pub(super) struct Names {
    short: bool,
}

/// The part after the last separator.
fn last(name: &str) -> &str {
    name.rsplit('/').next().unwrap_or(name)
}

impl Names {
    pub(super) fn new(answer: &Answer) -> Self {
        let mut seen = HashSet::with_capacity(answer.models.len());
        Self { short: answer.models.iter().all(|m| seen.insert((m.class, m.role, last(&m.name)))) }
    }

    pub(super) fn of<'m>(&self, model: &'m ModelRow) -> &'m str {
        if self.short { last(&model.name) } else { &model.name }
    }
}

/// The name of a class, empty where there is none.
pub(super) fn class(answer: &Answer, class: usize) -> &str {
    answer.classes.get(class).map_or("", String::as_str)
}

//! Undo and redo of parameters.

use crate::query::{Parameter, Settings};

/// The most changes that can be taken back.
const DEPTH: usize = 1000;

/// The settings before each change, and after each undo.
///
/// Turning one parameter repeatedly is one change: nobody wants to press undo twenty times to take back a T that was
/// turned from 20 to 40.
#[derive(Debug, Clone, Default)]
pub struct History {
    past: Vec<Settings>,
    future: Vec<Settings>,
    turning: Option<Parameter>,
}

impl History {
    /// Remembers `before`, which a change is about to replace. `turned` names the parameter when it is turned by steps.
    pub fn remember(&mut self, before: &Settings, turned: Option<Parameter>) {
        self.future.clear();
        if turned.is_some() && self.turning == turned && !self.past.is_empty() {
            return;
        }
        self.turning = turned;
        if self.past.len() == DEPTH {
            self.past.remove(0);
        }
        self.past.push(before.clone());
    }

    /// The next turn begins a change of its own.
    pub const fn pause(&mut self) {
        self.turning = None;
    }

    /// The settings before the last change; `now` can be had back with [`History::redo`].
    pub fn undo(&mut self, now: &Settings) -> Option<Settings> {
        self.turning = None;
        let before = self.past.pop()?;
        self.future.push(now.clone());
        Some(before)
    }

    /// The settings that the last undo took away.
    pub fn redo(&mut self, now: &Settings) -> Option<Settings> {
        self.turning = None;
        let after = self.future.pop()?;
        self.past.push(now.clone());
        Some(after)
    }

    /// How many changes can be taken back, and how many undone ones can be had back.
    #[must_use]
    pub const fn depth(&self) -> (usize, usize) {
        (self.past.len(), self.future.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rounds(rounds: usize) -> Settings {
        Settings { rounds, ..Settings::default() }
    }

    #[test]
    fn a_run_of_turns_is_one_change() {
        let mut history = History::default();
        history.remember(&rounds(20), Some(Parameter::Rounds));
        history.remember(&rounds(21), Some(Parameter::Rounds));
        history.remember(&rounds(22), Some(Parameter::K));
        assert_eq!(history.depth(), (2, 0));
        assert_eq!(history.undo(&rounds(30)), Some(rounds(22)));
        assert_eq!(history.undo(&rounds(22)), Some(rounds(20)));
        assert_eq!(history.undo(&rounds(20)), None);
        assert_eq!(history.redo(&rounds(20)), Some(rounds(22)));
        assert_eq!(history.redo(&rounds(22)), Some(rounds(30)));
        assert_eq!(history.redo(&rounds(30)), None);
    }

    #[test]
    fn a_pause_ends_the_run() {
        let mut history = History::default();
        history.remember(&rounds(20), Some(Parameter::Rounds));
        history.pause();
        history.remember(&rounds(21), Some(Parameter::Rounds));
        assert_eq!(history.depth(), (2, 0));
    }

    #[test]
    fn a_change_forgets_what_was_undone() {
        let mut history = History::default();
        history.remember(&rounds(20), None);
        assert_eq!(history.undo(&rounds(21)), Some(rounds(20)));
        history.remember(&rounds(20), None);
        assert_eq!(history.depth(), (1, 0));
    }

    #[test]
    fn the_oldest_change_is_forgotten_first() {
        let mut history = History::default();
        for round in 0..=DEPTH {
            history.remember(&rounds(round), None);
        }
        assert_eq!(history.depth().0, DEPTH);
        let mut last = None;
        while let Some(settings) = history.undo(&rounds(0)) {
            last = Some(settings);
        }
        assert_eq!(last, Some(rounds(1)));
    }
}

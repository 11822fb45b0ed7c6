//! What the engine did, in lines: the newest are kept and shown, all of them can be written to a file.

use std::{
    collections::VecDeque,
    time::{Duration, Instant},
};

/// So many lines are kept.
const MOST: usize = 1000;
/// No line is longer, in characters.
const LONGEST: usize = 400;

/// How much a line matters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Weight {
    /// What was done.
    Note,
    /// What may need a look.
    Warning,
    /// What failed.
    Error,
}

impl Weight {
    /// In one word.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A line of the journal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Line {
    /// Since the session began.
    pub at: Duration,
    /// How much it matters.
    pub weight: Weight,
    /// What it says, in one line.
    pub text: String,
}

impl Line {
    /// The line as a file has it. Control characters of names do not get there.
    #[must_use]
    pub fn written(&self) -> String {
        format!("{:10.3} {:<7} {}\n", self.at.as_secs_f64(), self.weight.name(), self.text)
    }
}

/// The newest lines, the oldest first.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Journal {
    lines: VecDeque<Line>,
    /// Lines that were let go.
    gone: usize,
}

impl Journal {
    /// Takes in a line; the oldest goes when there are too many.
    pub fn take(&mut self, line: Line) {
        if self.lines.len() == MOST {
            self.lines.pop_front();
            self.gone += 1;
        }
        self.lines.push_back(line);
    }

    /// How many lines there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.lines.len()
    }

    /// True when nothing was told yet.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty()
    }

    /// How many lines were let go.
    #[must_use]
    pub const fn gone(&self) -> usize {
        self.gone
    }

    /// The lines, the newest first.
    pub fn newest(&self) -> impl Iterator<Item = &Line> {
        self.lines.iter().rev()
    }
}

/// Makes lines of what is told since it was begun.
#[derive(Debug, Clone, Copy)]
pub(super) struct Clock(Instant);

impl Clock {
    pub(super) fn begin() -> Self {
        Self(Instant::now())
    }

    pub(super) fn line(self, weight: Weight, text: &str) -> Line {
        let cut = text.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect();
        Line { at: self.0.elapsed(), weight, text: cut }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_newest_lines_are_kept_in_bounded_memory() {
        let (clock, mut journal) = (Clock::begin(), Journal::default());
        for number in 0..3 * MOST {
            journal.take(clock.line(Weight::Note, &format!("{number} {}", "x".repeat(10_000))));
        }
        assert_eq!((journal.len(), journal.gone()), (MOST, 2 * MOST));
        assert!(journal.newest().next().unwrap().text.starts_with("2999 "));
        assert!(journal.newest().all(|line| line.text.len() <= LONGEST));
    }

    #[test]
    fn a_line_is_one_line_whatever_names_are_in_it() {
        let line = Clock::begin().line(Weight::Warning, "a\u{1b}[2J\nb");
        assert_eq!(line.text, "a\u{fffd}[2J\u{fffd}b");
        assert!(line.written().ends_with("warning a\u{fffd}[2J\u{fffd}b\n"));
    }
}

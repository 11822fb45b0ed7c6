//! Headings, and what they say of the values below.

use super::{look::Role, pane::Pane, text};
use crate::workbench::State;

/// What is to be known of values before they are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Note {
    /// They are what was asked for.
    Settled,
    /// They belong to other parameters, or to fewer models than are there.
    Stale,
    /// They are over so many models while others are still being solved.
    Partial(usize, usize),
}

/// What is to be known of values that are `stale` or not.
pub(super) fn note(state: &State, stale: bool) -> Note {
    let progress = &state.answer.progress;
    if stale {
        Note::Stale
    } else if progress.complete() {
        Note::Settled
    } else {
        Note::Partial(state.answer.members.len(), progress.total)
    }
}

/// Writes a heading and its note, in short where there is little room; returns the column after it.
pub(super) fn heading(pane: &mut Pane<'_>, y: u16, title: &str, note: Note) -> u16 {
    let room = (pane.width() as usize).saturating_sub(1);
    let x = pane.put(1, y, &text::fit(title, room), Role::Strong);
    let (mark, words) = match note {
        Note::Settled => return x,
        Note::Stale => (" ◌", " stale".to_owned()),
        Note::Partial(some, all) => (" ◐", format!(" {some} of {all} models")),
    };
    let free = room.saturating_sub(x as usize);
    let x = pane.put(x, y, mark, Role::Warn);
    if pane.width() >= 40 && free >= text::width(&words) + 2 { pane.put(x, y, &words, Role::Warn) } else { x }
}

/// Writes what stands where nothing is there to be shown.
pub(super) fn nothing(state: &State, pane: &mut Pane<'_>, y: u16) {
    let progress = &state.answer.progress;
    let message = if state.fatal.is_some() {
        "the engine has ended"
    } else if !progress.complete() || progress.total == 0 {
        "waiting for spectra"
    } else if state.answer.members.is_empty() {
        "no model takes part: see Models"
    } else {
        "not there yet"
    };
    pane.put(1, y, &text::fit(message, (pane.width() as usize).saturating_sub(1)), Role::Faint);
}

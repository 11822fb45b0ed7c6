//! The pipeline as the database ran it since the last change.
//!
//! ```text
//!  stage               ran memory   disk  stale failed    time
//!  ● content hash        0    380      0      0      0    0 ms
//!  ◐ spectrum           12      0    202    166      0   4.1 s
//!  ● features          214      0      0      0      0    3 ms
//!  ├ ● first-k           1      0      0      0      0    9 ms ‹
//!  ├ ● HCBw ε …
//!  └ ● AdaBoost
//!  ○ tables
//!
//!  Warnings
//!  ! cow.off: not a mesh
//! ```
//!
//! The stages that the chosen parameter would run again carry `‹`.

use super::{
    heading::{Note, heading},
    look::Role,
    number,
    pane::{self, Pane},
    text,
};
use crate::{
    query::{Stage, StageRow},
    workbench::{State, parameters},
};

/// Columns of the tree.
const NAME: u16 = 15;
/// Columns of each number: ran, memory, disk, stale, failed, time.
const NARROW: [u16; 6] = [5, 5, 5, 6, 7, 7];
/// The same where there is room.
const WIDE: [u16; 6] = [8, 8, 8, 8, 8, 10];

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let rows = state.answer.stages.len() as u16;
    table(state, &mut pane.part(pane::cut_top(&mut rest, rows + 1)));
    if rest.height >= 3 {
        let line = pane::cut_top(&mut rest, 2);
        explain(state, &mut pane.part(line));
    }
    if rest.height > 3 {
        pane::cut_top(&mut rest, 1);
    }
    warnings(state, &mut pane.part(rest));
}

/// How a stage stands, as one character.
pub(super) fn mark(state: &State, row: &StageRow) -> (&'static str, Role) {
    let there = row.ran + row.memory + row.disk;
    if state.awaits(row.stage) {
        ("◌", Role::Warn)
    } else if row.stale > 0 && there > 0 {
        ("◐", Role::Warn)
    } else if row.stale > 0 {
        ("○", Role::Faint)
    } else if row.failed > 0 {
        if there > 0 { ("!", Role::Warn) } else { ("×", Role::Bad) }
    } else if there > 0 {
        ("●", Role::Good)
    } else {
        ("○", Role::Faint)
    }
}

fn branch(stage: Stage) -> &'static str {
    match stage {
        Stage::FirstK | Stage::ClimbError | Stage::ClimbAdr => "├ ",
        Stage::Boost => "└ ",
        _ => "",
    }
}

fn table(state: &State, pane: &mut Pane<'_>) {
    let wide = pane.width() > NAME + WIDE.iter().sum::<u16>() + 2;
    let columns = if wide { WIDE } else { NARROW };
    let end = |column: usize| NAME + columns[..=column].iter().sum::<u16>();
    pane.put(1, 0, "stage", Role::Faint);
    let heads = ["ran", if wide { "memory" } else { "mem" }, "disk", "stale", "failed", "time"];
    for (column, head) in heads.into_iter().enumerate() {
        pane.put_right(end(column), 0, head, Role::Faint);
    }
    for (y, row) in (1..).zip(&state.answer.stages) {
        let (mark, role) = mark(state, row);
        pane.spans(
            1,
            y,
            [(branch(row.stage), Role::Faint), (mark, role), (" ", Role::Plain), (row.stage.name(), Role::Plain)],
        );
        let roles = [Role::Strong, Role::Plain, Role::Plain, Role::Warn, Role::Bad];
        let counts = [row.ran, row.memory, row.disk, row.stale, row.failed];
        for (column, (count, role)) in counts.into_iter().zip(roles).enumerate() {
            let (shown, role) = if count == 0 { ("·".to_owned(), Role::Faint) } else { (count.to_string(), role) };
            pane.put_right(end(column), y, &shown, role);
        }
        let time = if row.ran + row.disk == 0 { "·".to_owned() } else { number::seconds(row.seconds) };
        pane.put_right(end(5), y, &time, Role::Plain);
        if parameters::invalidates(state.parameter).contains(&row.stage) {
            pane.put(end(5), y, if wide { "  ‹" } else { "‹" }, Role::Strong);
        }
    }
}

fn explain(state: &State, pane: &mut Pane<'_>) {
    let parameter = state.parameter;
    let text = if parameters::invalidates(parameter).is_empty() {
        format!("{} runs nothing again", parameter.name())
    } else {
        format!("‹ what {} runs again or slices anew", parameter.name())
    };
    pane.put(1, 1, &text::fit(&text, (pane.width() as usize).saturating_sub(1)), Role::Faint);
}

fn warnings(state: &State, pane: &mut Pane<'_>) {
    let warnings = &state.answer.warnings;
    if pane.height() < 2 {
        return;
    }
    let title = if warnings.is_empty() { "No warnings".to_owned() } else { format!("Warnings ({})", warnings.len()) };
    heading(pane, 0, &title, Note::Settled);
    let room = (pane.width() as usize).saturating_sub(4);
    let height = pane.height() as usize - 1;
    // The newest come last in the answer and first here.
    let lines: Vec<(bool, String)> = warnings
        .iter()
        .rev()
        .flat_map(|warning| text::wrap(warning, room).into_iter().enumerate().map(|(n, line)| (n == 0, line)))
        .collect();
    // The last line says that there is more.
    let height = if lines.len() > height { height - 1 } else { height };
    let scroll = state.scroll.min(lines.len().saturating_sub(height));
    for (y, (first, line)) in (1..).zip(lines.iter().skip(scroll).take(height)) {
        pane.put(1, y, if *first { "!" } else { " " }, Role::Warn);
        pane.put(3, y, line, Role::Plain);
    }
    if lines.len() > scroll + height {
        let (width, bottom) = (pane.width().saturating_sub(1), pane.height().saturating_sub(1));
        pane.put_right(width, bottom, " PgDn ↓ ", Role::Chosen);
    }
}

//! The pipeline as the database ran it since the last change.
//!
//! ```text
//!  stage               ran memory   disk  stale failed    time   saved
//!  ● content hash        0    380      0      0      0    0 ms  214 ms
//! ┃◐ spectrum           12      0    202    166      0   4.1 s   1m02s
//! ┃● features ‹        214      0      0      0      0    3 ms       ·
//! ┃├ ● first-k ‹         1      0      0      0      0    9 ms       ·
//! ┃├ ● HCBw ε …
//! ┃└ ● AdaBoost
//! ┃○ tables
//!
//! ┃ last change: kmax 500 → 600
//!  ‹ what normalisation runs again or slices anew
//!  4.1 s spent, 1m02s saved   214 MB in use
//!
//!  Warnings
//!  ! cow.off: not a mesh
//! ```
//!
//! The path of the last change stands at `┃`; the stages that the chosen parameter would run again carry `‹`.

use ratatui::layout::Rect;

use super::{
    heading::{Note, heading},
    look::Role,
    number,
    pane::{self, Pane},
    text,
};
use crate::{
    query::{Stage, StageRow},
    workbench::{State, View, lists, parameters},
};

/// Columns of the tree.
const NAME: u16 = 15;
/// Columns of each number: ran, memory, disk, stale, failed, time, saved.
const NARROW: [u16; 7] = [4, 4, 5, 5, 4, 7, 7];
/// The same where there is room.
const WIDE: [u16; 7] = [8, 8, 8, 8, 8, 10, 10];
/// What the last change runs again stands at this.
const PATH: &str = "┃";

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let rows = state.answer.stages.len() as u16;
    table(state, &mut pane.part(pane::cut_top(&mut rest, rows + 1)));
    if rest.height >= 3 {
        let lines = said(state, rest.width);
        let gap = u16::from(rest.height as usize > lines.len() + 3);
        pane::cut_top(&mut rest, gap);
        for (mark, line, role) in lines {
            let mut pane = pane.part(pane::cut_top(&mut rest, 1));
            pane.put(0, 0, mark, Role::Train);
            pane.put(2, 0, &line, role);
        }
    }
    if rest.height > 2 {
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
    let (memory, stale, failed) = if wide { ("memory", "stale", "failed") } else { ("mem", "todo", "out") };
    let heads = ["ran", memory, "disk", stale, failed, "time", "saved"];
    let lit = state.changed.as_ref().map_or(&[][..], |change| &change.stages);
    let listing = &state.lists[View::Pipeline as usize];
    // The tree is one in its own order alone.
    let own = listing.by == 0 && !listing.reversed;
    let tree = |stage: Stage| if own { branch(stage) } else { "" };
    let cursor = (state.view == View::Pipeline).then_some(state.stage);
    for (column, head) in heads.into_iter().enumerate() {
        pane.put_right(end(column), 0, head, Role::Faint);
    }
    for (y, place) in (1..).zip(lists::stages(state)) {
        let row = &state.answer.stages[place];
        let (mark, role) = mark(state, row);
        let changed = lit.contains(&row.stage);
        let name = if changed { Role::Strong } else { Role::Plain };
        if changed {
            pane.put(0, y, PATH, Role::Train);
        }
        let x = pane.spans(
            1,
            y,
            [(tree(row.stage), Role::Faint), (mark, role), (" ", Role::Plain), (row.stage.name(), name)],
        );
        if parameters::invalidates(state.parameter).contains(&row.stage) {
            pane.put(x, y, if x + 1 < NAME { " ‹" } else { "‹" }, Role::Strong);
        }
        let roles = [Role::Strong, Role::Plain, Role::Plain, Role::Warn, Role::Bad];
        let counts = [row.ran, row.memory, row.disk, row.stale, row.failed];
        for (column, (count, role)) in counts.into_iter().zip(roles).enumerate() {
            let (shown, role) = if count == 0 { ("·".to_owned(), Role::Faint) } else { (count.to_string(), role) };
            pane.put_right(end(column), y, &shown, role);
        }
        let none = || ("·".to_owned(), Role::Faint);
        let spent = if row.ran + row.disk == 0 { none() } else { (number::seconds(row.seconds), Role::Plain) };
        let saved = if row.saved > 0.0 { (number::seconds(row.saved), Role::Good) } else { none() };
        pane.put_right(end(5), y, &spent.0, spent.1);
        pane.put_right(end(6), y, &saved.0, saved.1);
        if cursor == Some(place) {
            let style = pane.style(Role::Chosen);
            pane.paint(Rect::new(1, y, pane.width().saturating_sub(1), 1), style);
        }
    }
}

/// What the table's marks mean, what the work cost, and which models are out although nothing is wrong: each line with
/// its mark.
fn said(state: &State, width: u16) -> Vec<(&'static str, String, Role)> {
    let room = (width as usize).saturating_sub(3);
    let parameter = state.parameter;
    let again = if parameters::invalidates(parameter).is_empty() {
        format!("{} runs nothing again", parameter.name())
    } else {
        format!("‹ what {} runs again or slices anew", parameter.name())
    };
    let sum = |of: fn(&StageRow) -> f64| state.answer.stages.iter().map(of).filter(|s| s.is_finite()).sum::<f64>();
    let mut spent = format!("{} spent", number::seconds(sum(|row| row.seconds)));
    let saved = sum(|row| row.saved);
    if saved > 0.0 {
        spent = format!("{spent}, {} saved", number::seconds(saved));
    }
    if let Some(memory) = state.answer.memory {
        spent = format!("{spent} · {:.0} MB in use", memory as f64 / 1e6);
    }
    let changed = state.changed.as_ref().map(|change| (PATH, format!("last change: {}", change.what), Role::Plain));
    let short = state.answer.short.iter().flat_map(|short| text::wrap(short, room)).map(|line| ("", line, Role::Plain));
    let lines = changed.into_iter().chain([("", again, Role::Faint), ("", spent, Role::Plain)]).chain(short);
    lines.map(|(mark, line, role)| (mark, text::fit(&line, room), role)).collect()
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
        .filter(|warning| state.lists[View::Pipeline as usize].takes([warning.as_str()]))
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

//! The keys, from the keymap, over everything else.
//!
//! ```text
//! ╭ Keys ─────────────────────╮
//! │ Everywhere                │
//! │   ← →      turn           │
//! │ …                         │
//! ╰───────────────── ↓ 12 more╯
//! ```

use ratatui::layout::Rect;

use super::{look::Role, pane::Pane, text};
use crate::workbench::{
    State,
    keymap::{self, Context},
};

enum Row {
    Heading(&'static str),
    Keys(String, String),
    Gap,
}

fn rows(ascii: bool) -> Vec<Row> {
    let bindings = keymap::bindings();
    let mut rows = Vec::new();
    for context in Context::ALL {
        let mut here = bindings.iter().filter(|binding| binding.context == context).peekable();
        if here.peek().is_some() {
            if !rows.is_empty() {
                rows.push(Row::Gap);
            }
            rows.push(Row::Heading(context.name()));
            rows.extend(here.map(|binding| Row::Keys(text::keys(&binding.label, ascii), binding.about.clone())));
        }
    }
    rows
}

/// Columns of labels on screens that are too narrow for the longest.
const LABEL: usize = 16;
/// Columns between two columns of keys.
const GAP: u16 = 3;

/// Draws the box in the middle of the pane, in as many columns as it needs and there is room for.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let rows = rows(pane.look().ascii);
    let widest = |of: fn(&Row) -> usize| rows.iter().map(of).max().unwrap_or(0);
    let keys = widest(|row| if let Row::Keys(keys, _) = row { text::width(keys) } else { 0 });
    let about = widest(|row| if let Row::Keys(_, about) = row { text::width(about) } else { 0 });
    // Where there is little room the longest labels reach into what the others leave for words.
    let keys = if keys + about + 8 > pane.width() as usize { keys.min(LABEL) } else { keys };
    let one = (keys + about + 4) as u16;
    let room = (pane.height().saturating_sub(2) as usize).max(1);
    let across = rows.len().div_ceil(room).min((pane.width().saturating_sub(4) / (one + GAP)) as usize).max(1);
    let lines = rows.len().div_ceil(across).min(room);
    let wide = (across as u16 * (one + GAP) - GAP + 4).min(pane.width());
    let high = (lines as u16 + 2).min(pane.height());
    let area = pane.area();
    let place = Rect::new(area.x + (area.width - wide) / 2, area.y + (area.height - high) / 2, wide, high);
    let mut pane = pane.part(place);
    pane.clear();
    frame(&mut pane, " Keys ");
    let first = state.help.unwrap_or(0).min(rows.len().saturating_sub(lines * across));
    for (place, row) in rows.iter().skip(first).take(lines * across).enumerate() {
        let (x, y) = (2 + (place / lines) as u16 * (one + GAP), 1 + (place % lines) as u16);
        match row {
            Row::Heading(heading) => {
                pane.put(x, y, heading, Role::Strong);
            }
            Row::Keys(label, about) => {
                let end = pane.put(x + 2, y, label, Role::Train);
                let at = (x + 4 + keys as u16).max(end + 2);
                pane.put(at, y, &text::fit(about, wide.saturating_sub(at + 2) as usize), Role::Plain);
            }
            Row::Gap => {}
        }
    }
    let below = rows.len().saturating_sub(first + lines * across);
    let more = match (first, below) {
        (0, 0) => String::new(),
        (_, 0) => format!(" ↑ {first} more "),
        (_, below) => format!(" ↓ {below} more "),
    };
    pane.put_right(wide.saturating_sub(2), high.saturating_sub(1), &more, Role::Faint);
}

/// Draws a box around the pane, with a title in its upper edge.
pub(super) fn frame(pane: &mut Pane<'_>, title: &str) {
    let (right, bottom) = (pane.width().saturating_sub(1), pane.height().saturating_sub(1));
    let style = pane.style(Role::Faint);
    for x in 0..=right {
        pane.dot(x, 0, '─', style);
        pane.dot(x, bottom, '─', style);
    }
    for y in 0..=bottom {
        pane.dot(0, y, '│', style);
        pane.dot(right, y, '│', style);
    }
    for (x, y, corner) in [(0, 0, '╭'), (right, 0, '╮'), (0, bottom, '╰'), (right, bottom, '╯')] {
        pane.dot(x, y, corner, style);
    }
    pane.put(2, 0, title, Role::Strong);
}

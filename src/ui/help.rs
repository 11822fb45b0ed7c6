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

/// Draws the box in the middle of the pane.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let rows = rows(pane.look().ascii);
    let column = |of: fn(&Row) -> usize| rows.iter().map(of).max().unwrap_or(0);
    let keys = column(|row| if let Row::Keys(keys, _) = row { text::width(keys) } else { 0 });
    let about = column(|row| if let Row::Keys(_, about) = row { text::width(about) } else { 0 });
    let wide = (keys + about + 8).min(pane.width() as usize) as u16;
    let high = (rows.len() + 2).min(pane.height() as usize) as u16;
    let area = pane.area();
    let place = Rect::new(area.x + (area.width - wide) / 2, area.y + (area.height - high) / 2, wide, high);
    let mut pane = pane.part(place);
    pane.clear();
    frame(&mut pane);
    let lines = high.saturating_sub(2) as usize;
    let first = state.help.unwrap_or(0).min(rows.len().saturating_sub(lines));
    for (y, row) in (1..).zip(rows.iter().skip(first).take(lines)) {
        match row {
            Row::Heading(heading) => {
                pane.put(2, y, heading, Role::Strong);
            }
            Row::Keys(label, about) => {
                pane.put(4, y, label, Role::Train);
                let at = 6 + keys as u16;
                pane.put(at, y, &text::fit(about, (wide.saturating_sub(at + 2)) as usize), Role::Plain);
            }
            Row::Gap => {}
        }
    }
    let below = rows.len().saturating_sub(first + lines);
    let more = match (first, below) {
        (0, 0) => String::new(),
        (_, 0) => format!(" ↑ {first} more "),
        (_, below) => format!(" ↓ {below} more "),
    };
    pane.put_right(wide.saturating_sub(2), high.saturating_sub(1), &more, Role::Faint);
}

fn frame(pane: &mut Pane<'_>) {
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
    pane.put(2, 0, " Keys ", Role::Strong);
}

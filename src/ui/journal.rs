//! What the engine did, over everything else, the newest first.
//!
//! ```text
//! ╭ Journal ───────────────────────────────╮
//! │     12.4 s  note     study of 379 …    │
//! │      0.1 s  warning  notes.txt: …      │
//! ╰──────────────────────────── ↓ 12 more ╯
//! ```

use ratatui::layout::Rect;

use super::{help::frame, look::Role, pane::Pane, text};
use crate::workbench::{State, journal::Weight};

/// Draws the box, scrolled down by so many lines.
pub(super) fn draw(state: &State, scroll: usize, pane: &mut Pane<'_>) {
    let area = pane.area();
    let (wide, high) = (area.width.saturating_sub(4).max(area.width.min(20)), area.height.saturating_sub(2));
    let place = Rect::new(area.x + (area.width - wide) / 2, area.y + (area.height - high) / 2, wide, high);
    let mut pane = pane.part(place);
    pane.clear();
    frame(&mut pane, " Journal ");
    let journal = &state.journal;
    let rows = (high as usize).saturating_sub(2);
    if journal.is_empty() {
        pane.put(2, 1, "nothing was told yet", Role::Faint);
        return;
    }
    let first = scroll.min(journal.len().saturating_sub(rows));
    for (y, line) in (1..).zip(journal.newest().skip(first).take(rows)) {
        let at = format!("{:9.2} s", line.at.as_secs_f64());
        let (word, role) = match line.weight {
            Weight::Note => ("note", Role::Faint),
            Weight::Warning => ("warning", Role::Warn),
            Weight::Error => ("error", Role::Bad),
        };
        let x = pane.spans(2, y, [(at.as_str(), Role::Faint), ("  ", Role::Plain)]);
        pane.put(x, y, word, role);
        pane.put(x + 9, y, &text::fit(&line.text, (wide as usize).saturating_sub(x as usize + 11)), Role::Plain);
    }
    let below = journal.len().saturating_sub(first + rows);
    let gone = match journal.gone() {
        0 => String::new(),
        gone => format!("{gone} older ones are gone  "),
    };
    let more = if below > 0 { format!(" {gone}↓ {below} more ") } else { format!(" {gone}").trim_end().to_owned() };
    pane.put_right(wide.saturating_sub(2), high.saturating_sub(1), &more, Role::Faint);
}

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
use crate::workbench::{
    State,
    journal::{Line, Weight},
};

/// Columns of the time and the weight.
const LEFT: u16 = 22;

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
    if journal.is_empty() || rows == 0 {
        pane.put(2, 1, "nothing was told yet", Role::Faint);
        return;
    }
    let lines: Vec<&Line> = journal.newest().collect();
    let room = (wide as usize).saturating_sub(2 + LEFT as usize + 2);
    let texts: Vec<Vec<String>> = lines.iter().map(|line| text::wrap(&line.text, room)).collect();
    // Not further than to where the oldest line stands at the bottom.
    let mut left = rows;
    let fits = |high: &usize| {
        let fits = *high <= left;
        left -= left.min(*high);
        fits
    };
    let last = lines.len() - texts.iter().rev().map(|text| text.len().max(1)).take_while(fits).count();
    let first = scroll.min(last);
    let (mut y, mut shown) = (0, 0);
    for (line, text) in lines.iter().zip(&texts).skip(first) {
        let at = format!("{:9.2} s", line.at.as_secs_f64());
        let (word, role) = match line.weight {
            Weight::Note => ("note", Role::Faint),
            Weight::Warning => ("warning", Role::Warn),
            Weight::Error => ("error", Role::Bad),
        };
        let x = pane.spans(2, y + 1, [(at.as_str(), Role::Faint), ("  ", Role::Plain)]);
        pane.put(x, y + 1, word, role);
        for (dy, text) in (1..).zip(text.iter().take(rows - y as usize)) {
            pane.put(2 + LEFT, y + dy, text, Role::Plain);
        }
        y += text.len().max(1) as u16;
        shown += 1;
        if y as usize >= rows {
            break;
        }
    }
    let below = lines.len().saturating_sub(first + shown);
    let gone = match journal.gone() {
        0 => String::new(),
        gone => format!("{gone} older ones are gone  "),
    };
    let more = if below > 0 { format!(" {gone}↓ {below} more ") } else { format!(" {gone}").trim_end().to_owned() };
    pane.put_right(wide.saturating_sub(2), high.saturating_sub(1), &more, Role::Faint);
}

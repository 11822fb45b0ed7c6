//! The command palette, over everything else.
//!
//! ```text
//! ╭ : dist l1█ ────────────────────────╮
//! │ distance = l1                      │
//! │ choose distance: how features …  d │
//! ╰──────────────────────────── 1 of 2 ╯
//! ```

use ratatui::layout::Rect;

use super::{help, look::Role, pane::Pane, text};
use crate::workbench::{Action, State, palette};

/// Columns and rows of the box at most.
const MOST: (u16, u16) = (76, 20);

/// Draws the box in the upper middle of the pane.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let Some(open) = &state.palette else { return };
    let picks = palette::picks(state);
    let area = pane.area();
    let wide = MOST.0.min(area.width);
    let high = MOST.1.min(area.height);
    let place = Rect::new(area.x + (area.width - wide) / 2, area.y + (area.height - high) / 3, wide, high);
    let mut pane = pane.part(place);
    pane.clear();
    help::frame(&mut pane, "");
    let (before, after) = open.entry.parts();
    let room = (wide as usize).saturating_sub(8);
    let mut after = after.chars();
    let under = after.next().unwrap_or(' ').to_string();
    let x = pane.spans(
        2,
        0,
        [
            (" : ", Role::Strong),
            (&text::fit_end(&before, room), Role::Plain),
            (&under, Role::Chosen),
            (after.as_str(), Role::Plain),
        ],
    );
    pane.put(x, 0, " ", Role::Plain);
    let rows = high.saturating_sub(2) as usize;
    let at = open.at.min(picks.len().saturating_sub(1));
    let first = at.saturating_sub(rows.saturating_sub(1));
    for (y, (place, pick)) in (1..).zip(picks.iter().enumerate().skip(first).take(rows)) {
        let key = text::keys(&pick.key, pane.look().ascii);
        let room = (wide as usize).saturating_sub(5 + text::width(&key));
        let by = place as isize - at as isize;
        pane.target(Rect::new(1, y, wide.saturating_sub(2), 1), [Action::Scroll(by), Action::Pick]);
        pane.put(2, y, &text::fit(&pick.text, room), Role::Plain);
        pane.put_right(wide.saturating_sub(2), y, &key, Role::Train);
        if place == at {
            let style = pane.style(Role::Chosen);
            pane.paint(Rect::new(1, y, wide.saturating_sub(2), 1), style);
        }
    }
    let count =
        if picks.is_empty() { " nothing like this ".to_owned() } else { format!(" {} of {} ", at + 1, picks.len()) };
    pane.put_right(wide.saturating_sub(2), high.saturating_sub(1), &count, Role::Faint);
}

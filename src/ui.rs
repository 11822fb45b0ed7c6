//! State → frame. [`render`] is pure: it reads the state and fills the frame, one file for each view.
//!
//! ```text
//! ┌ header ─ data set, layout, members ──────────────────────────────┐
//! │ tabs ─ the views and their keys                                  │
//! ├─────────────────────┬────────────────────────────────────────────┤
//! │ parameters          │ view                                       │
//! │                     │                                            │
//! ├─────────────────────┴────────────────────────────────────────────┤
//! │ footer ─ progress, notices, a value being typed; keys            │
//! └──────────────────────────────────────────────────────────────────┘
//! ```
//!
//! Narrow screens have the parameters in a strip above the view. Whatever the size, nothing is drawn outside of the
//! frame and nothing panics: everything goes through `Pane`, which clips.
//!
//! Colours are the terminal's own sixteen, and none of them carries a meaning alone: there is always a mark, a word or
//! an attribute beside it ([`Look`]).

use self::{
    look::Role,
    pane::{Pane, Targets},
};
pub use self::{
    look::{Look, Shades},
    text::clean,
};
use crate::workbench::{Action, State, View, shape::TALL};
use ratatui::{Frame, buffer::Buffer, layout::Rect};

mod ascii;
mod compare;
mod confusion;
mod curves;
mod dots;
mod footer;
mod header;
mod heading;
mod help;
mod journal;
mod look;
mod models;
mod names;
mod neighbours;
mod number;
mod overview;
mod palette;
mod pane;
mod panel;
mod pipeline;
mod plot;
mod selection;
mod shape;
mod tables;
mod text;

/// Below this many columns or rows there is one line that says so.
const LEAST: (u16, u16) = (24, 6);
/// From this many columns on, the parameters stand beside the view.
const BESIDE: (u16, u16) = (80, 17);

/// Draws the state.
pub fn render(state: &State, look: Look, frame: &mut Frame<'_>) {
    let area = frame.area();
    let mut pane = Pane::new(frame.buffer_mut(), area, look);
    if area.width < LEAST.0 || area.height < LEAST.1 {
        too_small(&mut pane);
    } else {
        screen(state, &mut pane);
    }
    if look.ascii {
        ascii::plain(frame.buffer_mut());
    }
}

/// What a click at a column and row of the screen does; nothing where there is nothing to be clicked.
#[must_use]
pub fn clicked(state: &State, look: Look, (column, row): (u16, u16)) -> Vec<Action> {
    let area = Rect::new(0, 0, state.size.0, state.size.1);
    if area.width < LEAST.0 || area.height < LEAST.1 {
        return Vec::new();
    }
    let mut buffer = Buffer::empty(area);
    let targets = Targets::default();
    screen(state, &mut Pane::new(&mut buffer, area, look).with_targets(&targets));
    let hit = |(area, _): &(Rect, Vec<Action>)| area.contains((column, row).into());
    // What was drawn last lies on top.
    targets.into_inner().into_iter().rfind(hit).map(|(_, actions)| actions).unwrap_or_default()
}

fn too_small(pane: &mut Pane<'_>) {
    let (columns, rows) = LEAST;
    let message = format!("needs {columns}×{rows}");
    pane.put(0, 0, &text::fit(&message, pane.width() as usize), Role::Plain);
}

fn screen(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let tall = rest.height >= TALL;
    header::draw(state, &mut pane.part(pane::cut_top(&mut rest, 1)));
    if tall {
        header::tabs(state, &mut pane.part(pane::cut_top(&mut rest, 1)));
    }
    let foot = pane::cut_bottom(&mut rest, if tall { 2 } else { 1 });
    footer::draw(state, &mut pane.part(foot));
    if state.view == View::Shape || state.alone {
        if tall {
            let rule = pane::cut_top(&mut rest, 1);
            pane.rule(rule.y);
        }
    } else if pane.width() >= BESIDE.0 && pane.height() >= BESIDE.1 {
        let rule = pane::cut_top(&mut rest, 1);
        pane.rule(rule.y);
        let wide = if pane.width() >= 120 { 34 } else { 28 };
        let panel = pane::cut_left(&mut rest, wide);
        let post = pane::cut_left(&mut rest, 1);
        pane.post(post.x, post.y, post.height, true);
        panel::column(state, &mut pane.part(panel));
    } else {
        let strip = panel::strip_height(state, rest.width, rest.height);
        panel::strip(state, &mut pane.part(pane::cut_top(&mut rest, strip)));
        if rest.height > 8 {
            let rule = pane::cut_top(&mut rest, 1);
            pane.rule(rule.y);
        }
    }
    let below = Rect { height: pane.area().bottom().saturating_sub(rest.y + foot.height), ..rest };
    view(state, &mut pane.part(below));
    if state.help.is_some() {
        help::draw(state, pane);
    } else if let Some(scroll) = state.told {
        journal::draw(state, scroll, pane);
    } else if state.palette.is_some() {
        palette::draw(state, pane);
    }
}

fn view(state: &State, pane: &mut Pane<'_>) {
    match state.view {
        View::Overview => overview::draw(state, pane),
        View::Curves => curves::draw(state, pane),
        View::Tables => tables::draw(state, pane),
        View::Selection => selection::draw(state, pane),
        View::Pipeline => pipeline::draw(state, pane),
        View::Models => models::draw(state, pane),
        View::Confusion => confusion::draw(state, pane),
        View::Neighbours => neighbours::draw(state, pane),
        View::Shape => shape::draw(state, pane),
        View::Compare => compare::draw(state, pane),
    }
}

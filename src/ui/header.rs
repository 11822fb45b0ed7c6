//! What is looked at, and the tabs.
//!
//! ```text
//!  eigenselect  shrec07 · Princeton .cla        20 classes · 380 models · D 285 · Q 95
//!  1 Overview  2 Curves  3 Tables  4 Selection  5!Pipeline  6×Models  …
//! ```

use ratatui::layout::Rect;

use super::{look::Role, number, pane::Pane, text};
use crate::{
    dataset::Role as Side,
    workbench::{Action, State, View},
};

/// One line: program, data set, its members.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let answer = &state.answer;
    let total = |side: Side| answer.models.iter().filter(|model| model.role == side).count();
    let taking = |side: Side| {
        answer.members.iter().filter_map(|&m| answer.models.get(m)).filter(|model| model.role == side).count()
    };
    let side = |name: &str, side: Side| match (taking(side), total(side)) {
        (_, 0) => String::new(),
        (all, total) if all == total => format!(" · {name} {all}"),
        (some, total) => format!(" · {name} {some}/{total}"),
    };
    let classes = answer.classes.len();
    let sides = side("D", Side::Train) + &side("Q", Side::Query);
    let word = if classes == 1 { "class" } else { "classes" };
    let long = format!("{classes} {word} · {}{sides}", number::count(answer.models.len(), "model"));
    let short = sides.trim_start_matches(" · ").to_owned();
    let width = pane.width() as usize;
    let name = if width >= 60 { " eigenselect  " } else { " " };
    let x = pane.put(0, 0, name, Role::Strong);
    let room = width.saturating_sub(name.len() + 1);
    let title = text::fit_end(&state.title, room.min(if width >= 60 { room / 2 } else { room }));
    let x = pane.put(x, 0, &title, Role::Plain);
    let free = (width as u16).saturating_sub(x + 1);
    let fitting = [long, short].into_iter().find(|members| free > text::width(members) as u16 + 2);
    let members = fitting.filter(|_| classes > 0).unwrap_or_default();
    let wanted = text::width(&members) as u16;
    if free > wanted + 2 {
        pane.put_right(width as u16 - 1, 0, &members, Role::Plain);
        let room = (free - wanted - 2) as usize;
        let layout = text::width(&text::clean(&answer.layout));
        if layout > 0 && room >= (layout + 3).min(24) {
            pane.put(x, 0, &format!(" · {}", text::fit(&answer.layout, room - 3)), Role::Faint);
        }
    }
}

/// What stands between a view's digit and its name where something in it wants to be seen.
fn alert(state: &State, view: View) -> Option<char> {
    match view {
        View::Pipeline if !state.answer.warnings.is_empty() => Some('!'),
        View::Models if state.answer.progress.out > 0 => Some('×'),
        _ => None,
    }
}

/// One line: the views, their keys, and what in them wants to be seen. Names give way to brief ones, then the gaps to
/// single ones, then all names but the one of the view shown.
pub(super) fn tabs(state: &State, pane: &mut Pane<'_>) {
    let digits = ('1'..='9').chain(['0']);
    let width = pane.width() as usize;
    let long: usize = View::ALL.iter().map(|view| view.name().len() + 4).sum();
    let brief: usize = View::ALL.iter().map(|view| view.brief().len() + 3).sum();
    let (gap, name): (&str, fn(View) -> &'static str) = match width {
        _ if long <= width => (" ", View::name),
        _ if brief <= width => ("", View::brief),
        _ => ("", |_| ""),
    };
    let mut x = 0;
    for (digit, view) in digits.zip(View::ALL) {
        let here = view == state.view;
        let role = if here { Role::Chosen } else { Role::Plain };
        let shown = if here && name(view).is_empty() { view.name() } else { name(view) };
        let alert = alert(state, view);
        let mark = alert.map_or_else(|| if shown.is_empty() { "" } else { " " }.to_owned(), String::from);
        let warn = if here { role } else { Role::Warn };
        let digit = format!(" {gap}{digit}");
        let digit = if gap.is_empty() { digit } else { digit[1..].to_owned() };
        let from = x;
        x = pane.spans(x, 0, [(digit.as_str(), role), (mark.as_str(), warn), (shown, role), (gap, role)]);
        pane.target(Rect::new(from, 0, x - from, 1), [Action::Show(view)]);
    }
}

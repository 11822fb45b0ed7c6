//! What is looked at, and the tabs.
//!
//! ```text
//!  eigenselect  shrec07 · Princeton .cla        20 classes · 380 models · D 285 · Q 95
//!  1 Overview  2 Curves  3 Tables  4 Selection  5 Pipeline !2  6 Models ×1
//! ```

use super::{look::Role, number, pane::Pane, text};
use crate::{
    dataset::Role as Side,
    workbench::{State, View},
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

/// One line: the views, their keys, and what in them wants to be seen.
pub(super) fn tabs(state: &State, pane: &mut Pane<'_>) {
    let answer = &state.answer;
    let tabs: Vec<(View, String, String)> = (1..)
        .zip(View::ALL)
        .map(|(digit, view)| {
            let alert = match view {
                View::Pipeline if !answer.warnings.is_empty() => format!(" !{}", answer.warnings.len()),
                View::Models if answer.progress.out > 0 => format!(" ×{}", answer.progress.out),
                _ => String::new(),
            };
            (view, format!("{digit} {}", view.name()), alert)
        })
        .collect();
    let wanted: usize = tabs.iter().map(|(_, label, alert)| text::width(label) + text::width(alert) + 2).sum();
    let short = wanted > pane.width() as usize;
    let mut x = 0;
    for (view, label, alert) in &tabs {
        let here = *view == state.view;
        let shown = if short && !here { &label[..1] } else { label };
        let role = if here { Role::Chosen } else { Role::Plain };
        x = pane.spans(
            x,
            0,
            [(" ", role), (shown, role), (alert.as_str(), if here { role } else { Role::Warn }), (" ", role)],
        );
    }
}

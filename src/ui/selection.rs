//! Which eigenvalues AdaBoost selected.
//!
//! ```text
//!  Figure 5  selected bands, a column per class
//!  1.0 ┤ ░  ▒  █        denser: more of the weight α
//!  0.5 ┤ █  ░
//!  0.0 ┤    █  ░
//!        1  2  3  …
//!  3 human: 18 eigenvalues, by weight
//!   12  α 1.73  0.021 – 0.034 …
//! ```
//!
//! On small screens one of the map, Figure 4, the way of hill climbing and the class's shared bands; on large ones all.

use super::{
    footer,
    heading::{Note, heading, note, nothing},
    look::Role,
    number,
    pane::{self, Pane},
    text,
};
use crate::{
    query::Stage,
    study::Mark,
    workbench::{ALL_FIGURES, Figure, State, View},
};

pub(super) use self::bands::unit;

mod apart;
mod bands;
mod climb;
mod scatter;
mod shared;

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let listed = match rest.height {
        0..12 => 0,
        12..24 => 4,
        _ => 10,
    };
    let list = pane::cut_bottom(&mut rest, listed);
    if state.size.0 >= ALL_FIGURES {
        let half = rest.width / 2;
        let mut left = pane::cut_left(&mut rest, half);
        let below = rest.height / 3;
        let (bands, way) = (pane::cut_bottom(&mut left, below), pane::cut_bottom(&mut rest, below));
        map(state, &mut pane.part(left));
        shared::draw(state, &mut pane.part(bands));
        scatter(state, &mut pane.part(rest));
        climb::draw(state, &mut pane.part(way));
    } else {
        match state.figure {
            Figure::Map => map(state, &mut pane.part(rest)),
            Figure::Marks => scatter(state, &mut pane.part(rest)),
            Figure::Climb => climb::draw(state, &mut pane.part(rest)),
            Figure::Shared => shared::draw(state, &mut pane.part(rest)),
        }
    }
    if listed > 0 {
        strongest(state, &mut pane.part(list));
    }
}

/// True while the marks are not those of the parameters on the screen.
fn stale(state: &State) -> bool {
    state.stale(&state.answer.marks, Stage::Boost)
}

/// Figure 5.
pub(super) fn map(state: &State, pane: &mut Pane<'_>) {
    let title = format!("Figure 5: bands selected, {}", unit(state.settings.normalisation));
    figure(state, &title, bands::draw, pane);
}

/// Figure 4.
fn scatter(state: &State, pane: &mut Pane<'_>) {
    figure(state, "Figure 4: eigenvalues selected", scatter::draw, pane);
}

/// A figure made of the marks, below its title.
fn figure(state: &State, title: &str, draw: fn(&State, &[Vec<Mark>], &mut Pane<'_>), pane: &mut Pane<'_>) {
    let Some(marks) = state.answer.marks.value.as_deref() else {
        heading(pane, 0, title, Note::Settled);
        return nothing(state, pane, 1);
    };
    heading(pane, 0, title, note(state, stale(state)));
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let mut pane = pane.part(pane::inset(rest, 1));
    draw(state, marks, &mut pane);
    if stale(state) {
        pane.fade();
    }
}

/// The class's selected eigenvalues, the weightiest first.
fn strongest(state: &State, pane: &mut Pane<'_>) {
    let class = state.settings.class;
    let (Some(name), Some(marks)) = (state.class(), state.answer.marks.value.as_deref().and_then(|m| m.get(class)))
    else {
        return;
    };
    let said =
        format!("{} {}: {}, by weight α", class + 1, text::clean(name), number::count(marks.len(), "eigenvalue"));
    pane.put(1, 0, &text::fit(&said, (pane.width() as usize).saturating_sub(2)), Role::Strong);
    let mut order: Vec<&Mark> = marks.iter().collect();
    let most = order.iter().map(|mark| mark.alpha).fold(f64::MIN_POSITIVE, f64::max);
    order.sort_by(|a, b| b.alpha.total_cmp(&a.alpha));
    let listing = &state.lists[View::Selection as usize];
    order.retain(|mark| listing.takes([mark.index.to_string().as_str()]));
    listing.sort(&mut order, |by, a, b| match by {
        1 => a.index.cmp(&b.index),
        _ => (a.high - a.low).total_cmp(&(b.high - b.low)),
    });
    let rows = pane.height() as usize - 1;
    let columns = (pane.width() as usize / COLUMN).max(1);
    let scroll = state.scroll.min(order.len().saturating_sub(rows * columns));
    for (place, mark) in order.into_iter().skip(scroll).take(rows * columns).enumerate() {
        let x = (1 + place / rows * COLUMN) as u16;
        let y = (1 + place % rows) as u16;
        let (full, _) = footer::bar(mark.alpha / most, 5);
        let index = text::right(&mark.index.to_string(), 4);
        // A class that one eigenvalue tells from all others has a weight of hundreds.
        let alpha = if mark.alpha < 100.0 { format!("{:.2}", mark.alpha) } else { format!("{:.0}", mark.alpha) };
        let alpha = text::right(&alpha, 6);
        let x = pane.spans(
            x,
            y,
            [
                (index.as_str(), Role::Strong),
                (alpha.as_str(), Role::Plain),
                (" ", Role::Plain),
                (text::left(&full, 5).as_str(), Role::Train),
                (" ", Role::Plain),
            ],
        );
        let (low, high) = (number::short(mark.low), number::short(mark.high));
        let room = pane.width().saturating_sub(x) as usize;
        if text::width(&low) + 1 + text::width(&high) <= room {
            pane.spans(x, y, [(low.as_str(), Role::Plain), ("–", Role::Faint), (high.as_str(), Role::Plain)]);
        } else {
            pane.put(x, y, &text::fit(&format!("{low}–{high}"), room), Role::Plain);
        }
    }
    if stale(state) {
        pane.fade();
    }
}

/// Columns of one eigenvalue in the list.
const COLUMN: usize = 33;

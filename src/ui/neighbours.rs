//! Why one model is put where it is: its ranked neighbours, and what each eigenvalue adds.
//!
//! ```text
//!  12 human Q, first k → armadillo ×  ADR 0.412
//!    name      class        distance
//!  ▸ × 283     armadillo D  0.0123 ████▌
//!    ✓ 5       human     D  0.0140 █████
//!  ─────────────────────────────────────────────
//!  What speaks for armadillo (▲) and for human (▼)
//!  (each eigenvalue's term along the spectrum)
//!  λ9 +0.41  λ2 +0.20  λ4 −0.12
//! ```
//!
//! For AdaBoost the classes stand in the place of the neighbours, with the sum S of their weak classifiers. The lower
//! part shows the terms or the two spectra, on large screens both, and small pictures of the models.

use ratatui::layout::Rect;

use super::{
    footer,
    heading::{Note, heading, note, nothing},
    look::Role,
    names::{self, Names},
    number,
    pane::{self, Pane},
    shape, text,
};
use crate::{
    dataset::Role as Member,
    query::{Finding, ModelRow, Question},
    study::why::{Neighbours, Votes},
    workbench::{Action, Answered, State, Why, first_pictured, lists, pictured, shape::THUMB},
};

mod terms;

/// What was found of the model.
#[derive(Clone, Copy)]
enum Reasons<'a> {
    Neighbours(&'a Neighbours, &'a [usize]),
    Votes(&'a Votes),
}

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let Some(model) = state.model() else {
        heading(pane, 0, "Neighbours", Note::Settled);
        return nothing(state, pane, 1);
    };
    let row = &state.answer.models[model];
    let Why { method, .. } = state.why;
    let (reasons, stale) = match state.answered(&Question::Reasons { method, model }) {
        Answered::Found(Finding::Neighbours(found), places, stale) => (Reasons::Neighbours(found, places), stale),
        Answered::Found(Finding::Votes(votes), _, stale) => (Reasons::Votes(votes), stale),
        Answered::Nothing(reason) => {
            title(state, row, None, Note::Settled, pane);
            pane.put(1, 1, &text::fit(reason, (pane.width() as usize).saturating_sub(2)), Role::Warn);
            return;
        }
        _ => {
            title(state, row, None, Note::Settled, pane);
            return nothing(state, pane, 1);
        }
    };
    title(state, row, Some(reasons), note(state, stale), pane);
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let at = place(state, reasons);
    let pictured = pictured(state);
    if !pictured.is_empty() {
        let below = pane::cut_bottom(&mut rest, THUMB.1 + 1);
        let count = if let Reasons::Neighbours(found, _) = reasons { found.found.len() } else { 0 };
        let chosen = (count > 0).then(|| 1 + at - first_pictured(state, count));
        shape::strip(state, &pictured, chosen, &mut pane.part(below));
    }
    let body = rest;
    if rest.width >= 100 {
        let half = rest.width * 2 / 5;
        let list = pane::cut_left(&mut rest, half);
        let post = pane::cut_left(&mut rest, 1);
        ranked(state, reasons, at, &mut pane.part(list));
        pane.post(post.x, post.y, post.height, false);
        let votes = matches!(reasons, Reasons::Votes(_));
        let high = if votes { rest.height } else { rest.height / 2 };
        let upper = pane::cut_top(&mut rest, high);
        terms::draw(state, row, reasons, at, &mut pane.part(upper));
        if !votes {
            terms::overlay(state, row, reasons, at, &mut pane.part(rest));
        }
    } else {
        let below = if rest.height >= 11 { rest.height * 3 / 5 } else { 0 };
        let above = rest.height - below;
        let list = pane::cut_top(&mut rest, above);
        ranked(state, reasons, at, &mut pane.part(list));
        let rule = pane::cut_top(&mut rest, 1);
        if rule.height > 0 {
            pane.part(rule).rule(rule.y);
        }
        if state.why.overlaid && !matches!(reasons, Reasons::Votes(_)) {
            terms::overlay(state, row, reasons, at, &mut pane.part(rest));
        } else {
            terms::draw(state, row, reasons, at, &mut pane.part(rest));
        }
    }
    if stale {
        pane.part(body).fade();
    }
}

/// The cursor's place in the list.
fn place(state: &State, reasons: Reasons<'_>) -> usize {
    let count = match reasons {
        Reasons::Neighbours(found, _) => found.found.len(),
        Reasons::Votes(votes) => votes.votes.len(),
    };
    state.why.neighbour.min(count.saturating_sub(1))
}

const fn side(member: Member) -> (&'static str, Role) {
    match member {
        Member::Train => ("D", Role::Train),
        Member::Query => ("Q", Role::Query),
    }
}

/// One line: the model, the method and its decision.
fn title(state: &State, row: &ModelRow, reasons: Option<Reasons<'_>>, note: Note, pane: &mut Pane<'_>) {
    let names = Names::new(&state.answer);
    let own = names::class(&state.answer, row.class as usize);
    let width = pane.width() as usize;
    let name = text::fit_end(names.of(row), width / 4);
    let x = pane.put(1, 0, &name, Role::Strong);
    let x = pane.put(x + 1, 0, &text::fit(own, width / 4), Role::Strong);
    let (letter, role) = side(row.role);
    let x = pane.put(x + 1, 0, letter, role);
    let x = pane.spans(x, 0, [(", ", Role::Plain), (state.why.method.name(), Role::Plain)]);
    let decided = match reasons {
        Some(Reasons::Neighbours(found, _)) => found.found.first().map(|first| first.class),
        Some(Reasons::Votes(votes)) => votes.votes.first().map(|first| first.class),
        None => None,
    };
    let Some(decided) = decided else { return };
    let right = decided == row.class;
    let class = names::class(&state.answer, decided as usize);
    let (mark, role) = if right { ("✓", Role::Good) } else { ("×", Role::Bad) };
    let room = width.saturating_sub(x as usize + 7);
    let mut x =
        pane.spans(x, 0, [(" → ", Role::Faint), (&text::fit(class, room), Role::Plain), (" ", role), (mark, role)]);
    if note == Note::Stale {
        x = pane.put(x, 0, " ◌", Role::Warn);
    }
    if let Some(Reasons::Neighbours(found, _)) = reasons
        && let Some(adr) = found.adr
    {
        let said = format!("ADR {adr:.3}");
        if width > x as usize + text::width(&said) + 2 {
            pane.put_right(pane.width().saturating_sub(1), 0, &said, Role::Plain);
        }
    }
}

/// The neighbours, or the classes for AdaBoost.
fn ranked(state: &State, reasons: Reasons<'_>, at: usize, pane: &mut Pane<'_>) {
    let rows = (pane.height() as usize).saturating_sub(1);
    let count = match reasons {
        Reasons::Neighbours(found, _) => found.found.len(),
        Reasons::Votes(votes) => votes.votes.len(),
    };
    if count == 0 {
        pane.put(1, 0, "nothing is selected, so nothing is near", Role::Faint);
        return;
    }
    let listed = match reasons {
        Reasons::Neighbours(found, places) => lists::ranks(state, found, places),
        Reasons::Votes(votes) => lists::voted(state, votes),
    };
    let line = listed.iter().position(|rank| *rank == at).unwrap_or(0);
    let first = line.saturating_sub(rows / 2).min(listed.len().saturating_sub(rows));
    let listed: Vec<usize> = listed.into_iter().skip(first).take(rows).collect();
    match reasons {
        Reasons::Neighbours(found, places) => neighbours(state, found, places, (&listed, at), pane),
        Reasons::Votes(votes) => classes(state, votes, (&listed, at), pane),
    }
}

fn neighbours(
    state: &State,
    found: &Neighbours,
    places: &[usize],
    (listed, at): (&[usize], usize),
    pane: &mut Pane<'_>,
) {
    let names = Names::new(&state.answer);
    let width = pane.width() as usize;
    // rank 4, mark 2, distance 9, bar 7.
    let free = width.saturating_sub(5 + 2 + 9 + 8);
    let class =
        state.answer.classes.iter().map(|c| text::width(&text::clean(c))).max().unwrap_or(0).min(free / 2).max(5);
    let name = free.saturating_sub(class + 1).clamp(4, 24);
    let (name_at, class_at) = (7_u16, 7 + name as u16 + 1);
    let distance_end = class_at + class as u16 + 9;
    pane.put(name_at, 0, "nearest", Role::Faint);
    pane.put(class_at, 0, "class", Role::Faint);
    pane.put_right(distance_end, 0, "distance", Role::Faint);
    let scale = listed.iter().map(|&rank| found.found[rank].distance).fold(0.0, f64::max);
    for (y, &place) in (1..).zip(listed) {
        let neighbour = &found.found[place];
        let own = neighbour.class == found.class;
        let (mark, role) = if own { ("✓", Role::Good) } else { ("×", Role::Bad) };
        pane.put_right(4, y, &(place + 1).to_string(), Role::Faint);
        pane.put(5, y, mark, role);
        if let Some(row) = places.get(neighbour.model).and_then(|&model| state.answer.models.get(model)) {
            pane.put(name_at, y, &text::fit_end(names.of(row), name), Role::Plain);
        }
        let named = text::fit(names::class(&state.answer, neighbour.class as usize), class);
        pane.put(class_at, y, &named, if own { Role::Plain } else { Role::Strong });
        pane.put_right(distance_end, y, &number::short(neighbour.distance), Role::Plain);
        let (bar, _) = footer::bar(neighbour.distance / scale.max(f64::MIN_POSITIVE), 6);
        pane.put(distance_end + 1, y, &bar, if own { Role::Good } else { Role::Bad });
        choose(listed, at, y, pane);
    }
}

fn classes(state: &State, votes: &Votes, (listed, at): (&[usize], usize), pane: &mut Pane<'_>) {
    let width = pane.width() as usize;
    let name = width.saturating_sub(7 + 9 + 8).clamp(5, 24);
    let end = 7 + name as u16;
    pane.put(7, 0, "class", Role::Faint);
    pane.put_right(end + 8, 0, "S", Role::Faint);
    pane.put_right(end + 15, 0, "p", Role::Faint);
    for (y, &place) in (1..).zip(listed) {
        let vote = &votes.votes[place];
        let own = vote.class == votes.class;
        let (mark, role) = if own { ("✓", Role::Good) } else { ("×", Role::Bad) };
        pane.put_right(4, y, &(place + 1).to_string(), Role::Faint);
        pane.put(5, y, mark, role);
        let named = text::fit(names::class(&state.answer, vote.class as usize), name);
        pane.put(7, y, &named, if own { Role::Strong } else { Role::Plain });
        pane.put_right(end + 8, y, &format!("{:+.2}", vote.score).replace('-', "−"), Role::Plain);
        pane.put_right(end + 15, y, &format!("{:.3}", vote.probability), Role::Plain);
        choose(listed, at, y, pane);
    }
}

/// Marks the row of the cursor; a click moves it here, or opens what it is on.
fn choose(listed: &[usize], at: usize, y: u16, pane: &mut Pane<'_>) {
    let cursor = listed.iter().position(|place| *place == at).unwrap_or(0);
    let by = isize::try_from(y).unwrap_or(1) - 1 - cursor as isize;
    let action = if by == 0 { Action::Open } else { Action::Scroll(by) };
    pane.target(Rect::new(0, y, pane.width(), 1), [action]);
    if by == 0 {
        let style = pane.style(Role::Chosen);
        pane.paint(Rect::new(0, y, pane.width(), 1), style);
    }
}

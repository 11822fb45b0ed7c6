//! Every model, and the one looked at.
//!
//! ```text
//!  380 models · all models
//!    name            class    vertices  spectrum
//!  ● 1               human   D  10 002  disk   500
//!  ▸ ◐ 2             human   D   9 500  212/500
//!  × 351             spring  Q          351.off: zero-area faces
//!  ─────────────────────────────────────────────────
//!  351  human  D  data/351.off        (the details: beside the list where there is room)
//!  defects …
//!  λ against k, Weyl's line dotted
//! ```

use ratatui::layout::Rect;

use super::{
    dots::Stroke,
    look::Role,
    names::{self, Names},
    number,
    pane::{self, Pane},
    plot::{Axis, Plot, Series},
    shape, text,
};
use crate::{
    dataset::Role as Side,
    query::{Answer, ModelRow, ModelState, Source},
    workbench::{Action, Filter, Sort, State, pictured, shape::THUMB},
};

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let listed = state.models.listed(&state.answer);
    let mut rest = pane.area();
    let head = pane::cut_top(&mut rest, 1);
    heading(state, listed.len(), &mut pane.part(head));
    if rest.width >= 110 {
        let half = rest.width / 2;
        let list = pane::cut_left(&mut rest, half);
        let post = pane::cut_left(&mut rest, 1);
        list_of(state, &listed, &mut pane.part(list));
        pane.post(post.x, post.y, post.height, false);
    } else {
        let below = if rest.height >= 12 { rest.height / 2 } else { 0 };
        let above = rest.height - below;
        let list = pane::cut_top(&mut rest, above);
        list_of(state, &listed, &mut pane.part(list));
        let rule = pane::cut_top(&mut rest, 1);
        if rule.height > 0 {
            pane.part(rule).rule(rule.y);
        }
    }
    if let Some(model) = state.model() {
        if !pictured(state).is_empty() && rest.height >= 2 * THUMB.1 {
            let below = pane::cut_bottom(&mut rest, THUMB.1 + 1);
            shape::strip(state, &[model], None, &mut pane.part(below));
        }
        details(&state.answer, &state.answer.models[model], &mut pane.part(rest));
    }
}

fn heading(state: &State, listed: usize, pane: &mut Pane<'_>) {
    let all = state.answer.models.len();
    let list = &state.models;
    let mut said = match (&list.only, list.filter) {
        _ if !list.narrowed() => number::count(all, "model"),
        (Some(only), Filter::All) => format!("{listed} of {all}: {}", only.label),
        (Some(only), filter) => format!("{listed} of {all}: {} among {}", filter.name(), only.label),
        (None, filter) => format!("{listed} of {all}: {}", filter.name()),
    };
    if !list.needle.is_empty() {
        said = format!("{said} with \"{}\"", list.needle);
    }
    if list.sort != Sort::default() {
        said = format!("{said}, {}", list.sort.name());
    }
    if list.reversed {
        said += ", reversed";
    }
    let at = format!("{}/{listed}", (list.at + 1).min(listed));
    let room = (pane.width() as usize).saturating_sub(at.len() + 3);
    pane.put(1, 0, &text::fit(&said, room), Role::Strong);
    pane.put_right(pane.width().saturating_sub(1), 0, &at, Role::Faint);
}

const fn side(side: Side) -> &'static str {
    match side {
        Side::Train => "D",
        Side::Query => "Q",
    }
}

const fn side_role(side: Side) -> Role {
    match side {
        Side::Train => Role::Train,
        Side::Query => Role::Query,
    }
}

fn mark(model: &ModelRow) -> (&'static str, Role) {
    match &model.state {
        ModelState::Waiting => ("○", Role::Faint),
        ModelState::Working { .. } => ("◐", Role::Warn),
        ModelState::Ready { .. } if model.defects.is_empty() => ("●", Role::Good),
        ModelState::Ready { .. } => ("!", Role::Warn),
        ModelState::Out { .. } => ("×", Role::Bad),
    }
}

fn list_of(state: &State, listed: &[usize], pane: &mut Pane<'_>) {
    let answer = &state.answer;
    let width = pane.width() as usize;
    // mark 3, side 3, vertices 8, spectrum 14; the rest is shared by name and class.
    let free = width.saturating_sub(3 + 3 + 8 + 15);
    let longest = |of: &dyn Fn(&ModelRow) -> usize| answer.models.iter().map(of).max().unwrap_or(0);
    let names = Names::new(answer);
    let class_name = |model: &ModelRow| names::class(answer, model.class as usize);
    let class = longest(&|m| text::width(class_name(m))).clamp(5, (free / 2).max(5));
    let name = longest(&|m| text::width(names.of(m))).clamp(5, free.saturating_sub(class + 1).max(5));
    let (class_at, side_at) = ((3 + name + 1) as u16, (3 + name + 1 + class + 1) as u16);
    let (size_end, state_at) = (side_at + 10, side_at + 12);
    pane.put(3, 0, "name", Role::Faint);
    pane.put(class_at, 0, "class", Role::Faint);
    pane.put_right(size_end, 0, "vertices", Role::Faint);
    pane.put(state_at, 0, "spectrum", Role::Faint);
    if listed.is_empty() {
        pane.put(3, 1, if answer.models.is_empty() { "no models yet" } else { "none" }, Role::Faint);
        return;
    }
    let rows = (pane.height() as usize).saturating_sub(1);
    let at = state.models.at.min(listed.len() - 1);
    let first = at.saturating_sub(rows / 2).min(listed.len().saturating_sub(rows));
    for (y, (place, &index)) in (1..).zip(listed.iter().enumerate().skip(first).take(rows)) {
        let model = &answer.models[index];
        let by = place as isize - at as isize;
        let action = if by == 0 { Action::Open } else { Action::Scroll(by) };
        pane.target(Rect::new(0, y, pane.width(), 1), [action]);
        let (mark, role) = mark(model);
        pane.put(1, y, mark, role);
        pane.put(3, y, &text::fit_end(names.of(model), name), Role::Plain);
        pane.put(class_at, y, &text::fit(class_name(model), class), Role::Plain);
        pane.put(side_at, y, side(model.role), side_role(model.role));
        if let Some((vertices, _)) = model.size {
            pane.put_right(size_end, y, &vertices.to_string(), Role::Plain);
        }
        let (said, role) = standing(model);
        pane.put(state_at, y, &text::fit(&said, width.saturating_sub(state_at as usize + 1)), role);
        if place == at {
            let style = pane.style(Role::Chosen);
            pane.paint(Rect::new(0, y, pane.width(), 1), style);
        }
    }
}

const fn source(source: Source) -> &'static str {
    match source {
        Source::Ran => "ran",
        Source::Memory => "memory",
        Source::Disk => "disk",
    }
}

/// Where a model's spectrum is, in a few words.
fn standing(model: &ModelRow) -> (String, Role) {
    match &model.state {
        ModelState::Waiting => ("waiting".to_owned(), Role::Faint),
        ModelState::Working { done, total } => (format!("{done}/{total}"), Role::Warn),
        // A time of an earlier session is known for most.
        ModelState::Ready { source: from, seconds, .. } if *seconds > 0.0 => {
            (format!("{:<6} {:>6}", source(*from), number::seconds(*seconds)), Role::Plain)
        }
        ModelState::Ready { source: from, .. } => (source(*from).to_owned(), Role::Plain),
        ModelState::Out { reason } => (reason.clone(), Role::Bad),
    }
}

/// Everything there is on one model.
fn details(answer: &Answer, model: &ModelRow, pane: &mut Pane<'_>) {
    let width = (pane.width() as usize).saturating_sub(2);
    let class = names::class(answer, model.class as usize);
    let x = pane.put(1, 0, &text::fit_end(Names::new(answer).of(model), width / 2), Role::Strong);
    let x = pane.put(x + 2, 0, &text::fit(class, width / 3), Role::Plain);
    let x = pane.put(x + 2, 0, side(model.role), side_role(model.role));
    let path = text::fit_end(&model.path.to_string_lossy(), width.saturating_sub(x as usize + 2));
    pane.put_right(pane.width().saturating_sub(1), 0, &path, Role::Faint);
    let mut lines: Vec<(String, Role)> = Vec::new();
    lines.extend(text::wrap(&summary(model, pane.width() >= 64), width).into_iter().map(|line| (line, Role::Plain)));
    if let ModelState::Out { reason } = &model.state {
        lines.extend(text::wrap(&format!("× {reason}"), width).into_iter().map(|line| (line, Role::Bad)));
    }
    let defects: Vec<String> = model
        .defects
        .iter()
        .flat_map(|defect| text::wrap(defect, width.saturating_sub(2)).into_iter().enumerate())
        .map(|(n, line)| if n == 0 { format!("! {line}") } else { format!("  {line}") })
        .collect();
    // What is wrong comes before the plot, which takes what is left; on high panes it keeps half of it.
    let high = pane.height() as usize;
    let room = (if high >= 24 { high / 2 } else { high }).saturating_sub(lines.len() + 1);
    let cut = defects.len() > room;
    let shown = if cut { room.saturating_sub(1) } else { defects.len() };
    lines.extend(defects.iter().take(shown).map(|line| (line.clone(), Role::Warn)));
    if cut {
        let begun = defects.iter().take(shown).filter(|line| line.starts_with('!')).count();
        let left = number::count(model.defects.len() - begun, "more defect");
        lines.push((format!("! {left}"), Role::Warn));
    }
    let mut y = 1;
    for (line, role) in &lines {
        pane.put(1, y, line, *role);
        y += 1;
    }
    let mut rest = pane.area();
    pane::cut_top(&mut rest, y);
    spectrum(model, &mut pane.part(pane::inset(rest, 1)));
}

fn summary(model: &ModelRow, long: bool) -> String {
    let mut parts = Vec::new();
    if let Some((vertices, triangles)) = model.size {
        parts.push(format!("{vertices} vertices"));
        if long {
            parts.push(format!("{triangles} triangles"));
        }
    }
    match &model.state {
        ModelState::Waiting => parts.push("waiting".to_owned()),
        ModelState::Working { done, total } => {
            parts.push(format!("{done} of {total} {}", if long { "eigenvalues" } else { "λ" }));
        }
        ModelState::Ready { source: from, count, seconds } => {
            let how = match from {
                Source::Ran => format!("in {}", number::seconds(*seconds)),
                from if long && *seconds > 0.0 => {
                    format!("from {}, solved in {}", source(*from), number::seconds(*seconds))
                }
                from => format!("from {}", source(*from)),
            };
            parts.push(format!("{count} {} {how}", if long { "eigenvalues" } else { "λ" }));
        }
        ModelState::Out { .. } => {}
    }
    if model.defects.is_empty() && model.size.is_some() {
        parts.push("no defects".to_owned());
    }
    parts.join(" · ")
}

/// λ against k, with the line that Weyl's law predicts.
fn spectrum(model: &ModelRow, pane: &mut Pane<'_>) {
    let Some(eigenvalues) = model.eigenvalues.as_deref().filter(|values| !values.is_empty()) else { return };
    if pane.height() < 5 {
        return;
    }
    let count = eigenvalues.len();
    let weyl = model.measure.filter(|measure| *measure > 0.0).map(|measure| 4.0 * std::f64::consts::PI / measure);
    let line = weyl.map_or_else(Vec::new, |slope| vec![(1.0, slope), (count as f64, slope * count as f64)]);
    let x = pane.spans(0, 0, [("━ λ", Role::Train), (" against k", Role::Plain)]);
    if weyl.is_some() {
        pane.spans(x, 0, [("   ", Role::Plain), ("┅ Weyl 4πk/area", Role::Query)]);
    }
    let top = line.iter().map(|(_, y)| *y).chain(eigenvalues.iter().copied());
    let plot = Plot {
        x: Axis::indices(count, false),
        y: Axis::around(top.chain([0.0])),
        series: vec![
            Series { points: line, role: Role::Query, stroke: Stroke::Dotted, plain: '.' },
            Series {
                points: (1..).map(f64::from).zip(eigenvalues.iter().copied()).collect(),
                role: Role::Train,
                stroke: Stroke::Solid,
                plain: '#',
            },
        ],
        marks: Vec::new(),
        guide: None,
    };
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    plot.draw(&mut pane.part(rest));
}

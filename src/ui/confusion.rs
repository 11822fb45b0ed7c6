//! Which classes are taken for which: rows are the true classes, columns the classes decided.
//!
//! ```text
//!  HCBw for ε: ε D 0.263  Q 0.347                   D and Q
//!                    1 1 1 …        the column's class, its tens above its ones
//!    1 2 3 4 5 6 7 8 9 0 1 2 …
//!  1 human       17 · · 2 · …       · none; right ones faint; the cursor's cell reversed
//!  2 cup          · 19 …
//!
//!  human taken for armadillo: 2 of 20
//! ```
//!
//! Where there is room, the fullest wrong cells and the models of the cursor's cell stand beside the matrix.

use ratatui::layout::Rect;

use super::{
    footer,
    heading::{self, Note, note, nothing},
    look::Role,
    names::{self, Names},
    number,
    pane::{self, Pane},
    text,
};
use crate::{
    dataset::Role as Member,
    query::{Finding, Question},
    study::why::Decisions,
    workbench::{Answered, Matrix, State, lists},
};

/// The least and the most columns of a class's name.
const NAME: (u16, u16) = (6, 14);

/// Columns of how many of a class are wrong.
const WRONG: u16 = 7;

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let method = state.why.method;
    let (decisions, places, stale) = match state.answered(&Question::Decisions(method)) {
        Answered::Found(Finding::Decisions(decisions), places, stale) => (decisions, places, stale),
        Answered::Nothing(reason) => {
            heading::heading(pane, 0, &format!("Confusion, {}", method.name()), Note::Settled);
            pane.put(1, 1, &text::fit(reason, (pane.width() as usize).saturating_sub(2)), Role::Warn);
            return;
        }
        _ => {
            heading::heading(pane, 0, &format!("Confusion, {}", method.name()), Note::Settled);
            return nothing(state, pane, 1);
        }
    };
    let matrix = Matrix::new(state.why.side, &state.answer, decisions, places);
    let mut rest = pane.area();
    let head = pane::cut_top(&mut rest, 1);
    title(state, decisions, stale, &mut pane.part(head));
    let body = rest;
    let wanted = gutter(state) + cell(&matrix) * matrix.counts.len() as u16 + WRONG + 1;
    let classes = matrix.counts.len() as u16;
    let roomy = rest.height >= 12 && rest.width >= wanted + 34;
    if roomy {
        let wide = wanted.max(rest.width / 2);
        let left = pane::cut_left(&mut rest, wide);
        let post = pane::cut_left(&mut rest, 1);
        pane.post(post.x, post.y, post.height, false);
        cells(state, &matrix, &mut pane.part(left));
        let high = (matrix.worst.len() as u16 + 2).min(rest.height / 2);
        let above = pane::cut_top(&mut rest, high);
        worst(state, &matrix, &mut pane.part(above));
        members(state, decisions, places, &mut pane.part(rest));
    } else if rest.height >= classes + 10 {
        let mut below = rest;
        let above = pane::cut_top(&mut below, classes + 2);
        cells(state, &matrix, &mut pane.part(above));
        pane::cut_top(&mut below, 1);
        let half = below.width / 2;
        let left = pane::cut_left(&mut below, half);
        worst(state, &matrix, &mut pane.part(left));
        members(state, decisions, places, &mut pane.part(below));
    } else {
        let high = if rest.height >= 8 { 2 } else { 1 };
        let below = pane::cut_bottom(&mut rest, high);
        cells(state, &matrix, &mut pane.part(rest));
        let mut below = pane.part(below);
        let y = below.height().saturating_sub(1);
        let room = (below.width() as usize).saturating_sub(2);
        if y > 0 {
            let said = most_confused(state, &matrix, &|said| text::width(said) <= room);
            below.put(1, 0, &text::fit(&said, room), Role::Plain);
        }
        let said = cell_in_words(state, &matrix);
        below.put(1, y, &text::fit(&said, room), Role::Strong);
    }
    if stale {
        pane.part(body).fade();
    }
}

fn title(state: &State, decisions: &Decisions, stale: bool, pane: &mut Pane<'_>) {
    let (train, query) = decisions.error();
    let x = heading::heading(pane, 0, &format!("Confusion, {}", state.why.method.name()), note(state, stale));
    let side = state.why.side.name();
    let end = pane.width().saturating_sub(1);
    let room = end.saturating_sub(text::width(side) as u16 + 2);
    let x = x + 2;
    if room > x + 16 {
        let error = |error: Option<f64>| number::ratio(error);
        let x = pane.spans(x, 0, [("ε D ", Role::Plain), (&error(train), Role::Train)]);
        pane.spans(x, 0, [("  Q ", Role::Plain), (&error(query), Role::Query)]);
    }
    pane.put_right(end, 0, side, Role::Faint);
}

/// Columns of a count: one more than the widest takes, so that counts never touch.
fn cell(matrix: &Matrix) -> u16 {
    let most = matrix.counts.iter().flatten().copied().max().unwrap_or(0);
    most.max(1).ilog10() as u16 + 2
}

/// Columns of a row's number and name.
fn gutter(state: &State) -> u16 {
    let longest = state.answer.classes.iter().map(|class| text::width(&text::clean(class))).max().unwrap_or(0) as u16;
    4 + longest.clamp(NAME.0, NAME.1) + 1
}

/// The matrix, as many rows and columns as fit around the cursor.
fn cells(state: &State, matrix: &Matrix, pane: &mut Pane<'_>) {
    let classes = matrix.counts.len();
    if classes == 0 || pane.height() < 3 {
        return;
    }
    let gutter = gutter(state).min(pane.width() / 2);
    let wide = cell(matrix);
    let rows = (pane.height() as usize - 2).min(classes);
    let columns = ((pane.width().saturating_sub(gutter) / wide) as usize).min(classes);
    let (truth, decided) = (state.why.cell.0.min(classes - 1), state.why.cell.1.min(classes - 1));
    let first_row = truth.saturating_sub(rows / 2).min(classes - rows);
    let first_column = decided.saturating_sub(columns / 2).min(classes - columns);
    let x_of = |column: usize| gutter + wide * (column - first_column) as u16;
    for column in first_column..first_column + columns {
        let number = column + 1;
        let role = if column == decided { Role::Strong } else { Role::Faint };
        if number >= 10 {
            pane.put_right(x_of(column) + wide, 0, &(number / 10).to_string(), role);
        }
        pane.put_right(x_of(column) + wide, 1, &(number % 10).to_string(), role);
    }
    let end = x_of(first_column + columns) + WRONG;
    let counted = columns == classes && end <= pane.width();
    if counted {
        pane.put_right(end, 1, "wrong", Role::Faint);
    }
    for (y, row) in (2..).zip(first_row..first_row + rows) {
        let own = row == truth;
        if counted {
            let (wrong, _) = matrix.wrong_of(row);
            let role = if matrix.most_confused() == Some(row) { Role::Bad } else { Role::Plain };
            pane.put_right(end, y, &wrong.to_string(), if wrong == 0 { Role::Faint } else { role });
        }
        let name = text::fit(names::class(&state.answer, row), gutter as usize - 5);
        pane.put_right(3, y, &(row + 1).to_string(), if own { Role::Strong } else { Role::Faint });
        // Rows that were not asked for by name step back.
        let role = match (own, state.order().takes([state.class_name(row)])) {
            (true, _) => Role::Strong,
            (false, true) => Role::Plain,
            (false, false) => Role::Faint,
        };
        pane.put(4, y, &name, role);
        let all: u32 = matrix.counts[row].iter().sum();
        for column in first_column..first_column + columns {
            let count = matrix.counts[row][column];
            let role = match count {
                0 => Role::Faint,
                _ if row == column => Role::Good,
                _ if 4 * count >= all => Role::Bad,
                _ => Role::Warn,
            };
            let shown = if count == 0 { "·".to_owned() } else { count.to_string() };
            pane.put_right(x_of(column) + wide, y, &shown, role);
            if own && column == decided {
                let style = pane.style(Role::Chosen);
                pane.paint(Rect::new(x_of(column), y, wide, 1), style);
            }
        }
    }
    if first_row + rows < classes || first_row > 0 {
        let more = format!("{}–{} of {classes}", first_row + 1, first_row + rows);
        pane.put(1, 0, &text::fit(&more, gutter as usize - 1), Role::Faint);
    }
}

fn cell_in_words(state: &State, matrix: &Matrix) -> String {
    let (truth, decided) = state.why.cell;
    let Some(row) = matrix.counts.get(truth) else { return String::new() };
    let count = row.get(decided).copied().unwrap_or(0);
    let (own, other) = (names::class(&state.answer, truth), names::class(&state.answer, decided));
    let all: u32 = row.iter().sum();
    if truth == decided {
        format!("{own} recognised: {count} of {all}")
    } else {
        format!("{own} taken for {other}: {count} of {all}")
    }
}

/// The class that is wrong most often, and what its models are taken for, as far as that fits.
fn most_confused(state: &State, matrix: &Matrix, fits: &dyn Fn(&str) -> bool) -> String {
    let Some(class) = matrix.most_confused() else { return "every model is recognised".to_owned() };
    let (wrong, all) = matrix.wrong_of(class);
    let others = matrix.taken_for(class);
    let own = names::class(&state.answer, class);
    let said = |lead: &str, named: usize| {
        let words = others.iter().take(named);
        let words = words.map(|&(other, count)| format!("{} {count}", names::class(&state.answer, other)));
        let more = others.len() - named;
        let words: Vec<String> = words.chain((more > 0).then(|| format!("{more} more"))).collect();
        format!("{lead}: {own}, {wrong} of {all}: {}", words.join(", "))
    };
    let leads = ["most often wrong", "most wrong"].into_iter();
    let mut tried = leads.flat_map(|lead| (1..=others.len()).rev().map(move |named| (lead, named)));
    let found = tried.find_map(|(lead, named)| Some(said(lead, named)).filter(|said| fits(said)));
    found.unwrap_or_else(|| format!("most wrong: {own}, {wrong} of {all}"))
}

/// The fullest wrong cells.
fn worst(state: &State, matrix: &Matrix, pane: &mut Pane<'_>) {
    let wide = (pane.width() as usize).saturating_sub(2);
    let said = format!("{} of {} in the wrong class", matrix.wrong, matrix.total);
    let said = if text::width(&said) <= wide { said } else { format!("{} of {} wrong", matrix.wrong, matrix.total) };
    pane.put(1, 0, &text::fit(&said, wide), Role::Strong);
    let lines = text::wrap(&most_confused(state, matrix, &|said| text::wrap(said, wide).len() <= 2), wide);
    let high = if pane.height() >= 8 { lines.len().min(2) as u16 } else { 0 };
    for (y, line) in (1..=high).zip(&lines) {
        pane.put(1, y, line, Role::Plain);
    }
    let listed = lists::confusions(state, matrix);
    let most = matrix.worst.first().map_or(1, |(.., count)| *count);
    let room = (pane.width() as usize).saturating_sub(4 + 9);
    let at = listed.iter().position(|&(truth, decided, _)| (truth, decided) == state.why.cell);
    let rows = (pane.height() as usize).saturating_sub(2 + high as usize);
    let first = at.map_or(0, |at| at.saturating_sub(rows.saturating_sub(1)));
    for (y, &(truth, decided, count)) in (1 + high..).zip(listed.iter().skip(first).take(rows)) {
        let (own, other) = (names::class(&state.answer, truth), names::class(&state.answer, decided));
        let (bar, _) = footer::bar(f64::from(count) / f64::from(most), 6);
        let pair = text::left(&format!("{own} → {other}"), room);
        let x = pane.spans(1, y, [(pair.as_str(), Role::Plain), (" ", Role::Plain)]);
        pane.put_right(x + 3, y, &count.to_string(), Role::Strong);
        pane.put(x + 4, y, &bar, Role::Warn);
        if (truth, decided) == state.why.cell {
            let style = pane.style(Role::Chosen);
            pane.paint(Rect::new(0, y, pane.width(), 1), style);
        }
    }
}

/// The models of the cursor's cell.
fn members(state: &State, decisions: &Decisions, places: &[usize], pane: &mut Pane<'_>) {
    let matrix = Matrix::new(state.why.side, &state.answer, decisions, places);
    let width = (pane.width() as usize).saturating_sub(2);
    pane.put(1, 0, &text::fit(&cell_in_words(state, &matrix), width), Role::Strong);
    let models = state.why.models(&state.answer, decisions, places);
    let names = Names::new(&state.answer);
    let rows = (pane.height() as usize).saturating_sub(1);
    let cut = models.len() > rows;
    for (y, &model) in (1..).zip(models.iter().take(if cut { rows.saturating_sub(1) } else { rows })) {
        let row = &state.answer.models[model];
        let side = match row.role {
            Member::Train => ("D", Role::Train),
            Member::Query => ("Q", Role::Query),
        };
        let x = pane.spans(1, y, [side, (" ", Role::Plain)]);
        pane.put(x, y, &text::fit_end(names.of(row), width.saturating_sub(x as usize)), Role::Plain);
    }
    if cut {
        let more = format!("{} more: Enter lists them", models.len() - rows.saturating_sub(1));
        pane.put(1, rows as u16, &text::fit(&more, width), Role::Faint);
    }
}

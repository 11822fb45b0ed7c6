//! Tables 1 to 4, one below the other, or two by two where there is room; below each row
//! the differences to the pins.
//!
//! ```text
//!  Table 1: Classification error ε with the first k eigenvalues
//!                               ε on D,  ε on Q,
//!  method   ε on D  k0  ε on Q   k = 10   k = 10
//!  first-k   0.242   8   0.300    0.274    0.311
//!
//!  Table 2: …                                      PgDn ↓
//! ```

use ratatui::{layout::Rect, style::Modifier};

use super::{
    heading::{Note, heading, note, nothing},
    look::Role,
    number,
    pane::{self, Pane},
    text,
};
use crate::{
    query::Stage,
    study::{self, Cell, Table},
    workbench::{State, View, lists, pins},
};

/// Columns between two columns of a table.
const GAP: usize = 2;
/// The least a column of words is cut to.
const LEAST: usize = 6;

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let Some(tables) = newest(state) else {
        heading(pane, 0, "Tables", Note::Settled);
        nothing(state, pane, 1);
        return;
    };
    let across = if pane.width() >= 150 { 2 } else { 1 };
    let width = pane.width() / across;
    let (tables, notes): (Vec<Table>, Vec<Note>) = tables.into_iter().unzip();
    let tables = pins::against(state, &tables);
    let sheets: Vec<Sheet> =
        tables.iter().zip(notes).map(|(table, note)| Sheet::new(state, table, note, width)).collect();
    // In reading order, each line of tables as high as its highest.
    let lines: Vec<(&[Sheet], u16)> = sheets
        .chunks(across as usize)
        .map(|line| (line, line.iter().map(|sheet| sheet.lines.len() as u16 + 1).max().unwrap_or(0)))
        .collect();
    let all = lines.iter().map(|(_, rows)| rows).sum::<u16>().saturating_sub(1);
    // The last line says that there is more.
    let room = if all > pane.height() { pane.height().saturating_sub(1) } else { pane.height() };
    let scroll = (state.scroll.min(usize::from(u16::MAX)) as u16).min(all.saturating_sub(room));
    let mut top = 0;
    for (line, rows) in lines {
        for (place, sheet) in (0..).zip(line) {
            let mut area = pane.area();
            pane::cut_left(&mut area, place * width);
            area = Rect { width: area.width.min(width), height: area.height.min(room), ..area };
            sheet.draw(&mut pane.part(area), i32::from(top) - i32::from(scroll));
        }
        top += rows;
    }
    let below = all.saturating_sub(scroll + room);
    let (right, bottom) = (pane.width().saturating_sub(1), pane.height().saturating_sub(1));
    if below > 0 {
        pane.put_right(right, bottom, " PgDn ↓ ", Role::Chosen);
    } else if scroll > 0 {
        pane.put_right(right, bottom, " PgUp ↑ ", Role::Chosen);
    }
}

/// The tables with what is to be known of each. While some of their parts are on their way each table is of the newest
/// there is, and those whose own parts are there are not stale.
fn newest(state: &State) -> Option<Vec<(Table, Note)>> {
    let answer = &state.answer;
    if !state.stale(&answer.tables, Stage::Tables) {
        let note = note(state, false);
        return Some(answer.tables.value.as_ref()?.iter().map(|table| (table.clone(), note)).collect());
    }
    let (first_k, boosted) = (answer.first_k.value.as_deref(), answer.boosted.value.as_deref());
    let (error, adr) = (answer.climb_error.value.as_deref(), answer.climb_adr.value.as_deref());
    if first_k.is_none() && boosted.is_none() && error.is_none() && adr.is_none() {
        return None;
    }
    // The curves are there for every k; T belongs to the rounds that are there.
    let (k, rounds, sel) = (state.settings.k, answer.settings.rounds, state.settings.sel);
    let stale = [
        state.stale(&answer.first_k, Stage::FirstK),
        state.stale(&answer.climb_error, Stage::ClimbError),
        state.stale(&answer.boosted, Stage::Boost),
        state.stale(&answer.first_k, Stage::FirstK) || state.stale(&answer.climb_adr, Stage::ClimbAdr),
    ];
    let tables = study::tables_of(first_k, error, adr, boosted, k, rounds, sel);
    Some(tables.into_iter().zip(stale).map(|(table, stale)| (table, note(state, stale))).collect())
}

/// What a line of a table is.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Title,
    Head,
    /// The last line of heads.
    Foot,
    Row,
}

/// A table laid out for a width.
struct Sheet {
    lines: Vec<(Kind, Vec<String>)>,
    widths: Vec<usize>,
    numeric: Vec<bool>,
    note: Note,
}

impl Sheet {
    fn new(state: &State, table: &Table, note: Note, width: u16) -> Self {
        let room = (width as usize).saturating_sub(2);
        let columns: Vec<String> = table.columns.iter().map(|head| tight(head)).collect();
        let rows: Vec<Vec<String>> =
            listed(state, table).into_iter().map(|row| row.iter().map(number::cell).collect()).collect();
        let shown = fitting(&columns, &rows, room);
        let title = tight(&format!("Table {}: {}", table.number, table.title));
        let title = text::wrap(&format!("{title}{}", left_out(state, columns.len() - shown)), room);
        // Differences are words for their sign, below the figures that the first row has.
        let words = |column: usize| matches!(table.rows.first().and_then(|row| row.get(column)), Some(Cell::Text(_)));
        let widths = widths(&columns[..shown], &rows, room);
        let heads: Vec<Vec<String>> =
            columns.iter().zip(&widths).map(|(head, width)| text::wrap(head, *width)).collect();
        let high = heads.iter().map(Vec::len).max().unwrap_or(0);
        // Heads stand on their last line, as near to the figures as they can.
        let head = |line: usize| {
            let from_below = high - line;
            let word = |head: &Vec<String>| {
                head.len().checked_sub(from_below).and_then(|at| head.get(at)).cloned().unwrap_or_default()
            };
            (if from_below == 1 { Kind::Foot } else { Kind::Head }, heads.iter().map(word).collect())
        };
        let mut lines: Vec<(Kind, Vec<String>)> = title.into_iter().map(|line| (Kind::Title, vec![line])).collect();
        lines.extend((0..high).map(head));
        lines.extend(rows.into_iter().map(|row| (Kind::Row, row)));
        Self { lines, widths, numeric: (0..shown).map(|column| !words(column)).collect(), note }
    }

    /// Draws it with its first line at `top`, which may lie above the pane.
    fn draw(&self, pane: &mut Pane<'_>, top: i32) {
        let titles = self.lines.iter().filter(|(kind, _)| *kind == Kind::Title).count();
        for (line, (kind, cells)) in (0..).zip(&self.lines) {
            let Some(y) = u16::try_from(top + line).ok().filter(|y| *y < pane.height()) else { continue };
            if *kind == Kind::Title {
                let last = line as usize + 1 == titles;
                heading(
                    pane,
                    y,
                    cells.first().map_or("", String::as_str),
                    if last { self.note } else { Note::Settled },
                );
                continue;
            }
            self.cells(*kind, cells, y, pane);
            if self.note == Note::Stale && *kind == Kind::Row {
                let area = Rect { y: pane.area().y + y, height: 1, ..pane.area() };
                pane.part(area).fade();
            }
        }
    }

    fn cells(&self, kind: Kind, cells: &[String], y: u16, pane: &mut Pane<'_>) {
        let mut x = 1;
        for ((cell, &wide), &numeric) in cells.iter().zip(&self.widths).zip(&self.numeric) {
            let shown = if numeric { text::right(cell, wide) } else { text::left(cell, wide) };
            let style = match kind {
                Kind::Foot => pane.style(Role::Faint).add_modifier(Modifier::UNDERLINED),
                Kind::Head => pane.style(Role::Faint),
                _ if cell == number::NONE => pane.style(Role::Faint),
                _ => pane.style(Role::Plain),
            };
            x = pane.styled(x, y, &shown, style) + GAP as u16;
        }
    }
}

/// The rows of a table as they are listed.
fn listed<'a>(state: &State, table: &'a Table) -> Vec<&'a Vec<Cell>> {
    let order = &state.lists[View::Tables as usize];
    let named = |row: &&Vec<Cell>| {
        let words = row.iter().filter_map(|cell| if let Cell::Text(text) = cell { Some(text.as_str()) } else { None });
        order.takes(words)
    };
    let mut rows: Vec<&Vec<Cell>> = table.rows.iter().filter(named).collect();
    // A table without the column stays as it is.
    let heads = lists::columns(state);
    let column = heads.get(order.by).and_then(|head| table.columns.iter().position(|own| own == head));
    order.sort(&mut rows, |_, a, b| {
        column.map_or(std::cmp::Ordering::Equal, |column| compare(a.get(column), b.get(column)))
    });
    rows
}

/// Numbers by their value, words by their letters, what is missing last.
fn compare(a: Option<&Cell>, b: Option<&Cell>) -> std::cmp::Ordering {
    let number = |cell: Option<&Cell>| match cell? {
        Cell::Text(_) => None,
        cell => number::cell(cell).replace('−', "-").parse::<f64>().ok(),
    };
    match (a, b) {
        (Some(Cell::Text(a)), Some(Cell::Text(b))) => a.cmp(b),
        (a, b) => lists::ascending(number(a), number(b)),
    }
}

/// How many columns there is room for, the first two at least, with no word of theirs cut.
fn fitting(heads: &[String], rows: &[Vec<String>], room: usize) -> usize {
    let fits = |columns: &usize| {
        let words: usize = (0..*columns).map(|column| broken(heads, rows, column)).sum();
        words + GAP * columns.saturating_sub(1) <= room
    };
    (2..=heads.len()).rev().find(fits).unwrap_or(heads.len().min(2))
}

/// What is said of columns that there is no room for.
fn left_out(state: &State, columns: usize) -> String {
    match columns {
        0 => String::new(),
        _ if state.alone => format!(" ({} left out)", number::count(columns, "column")),
        _ => format!(" (z: {} more)", number::count(columns, "column")),
    }
}

/// The width of the widest cell of a column.
fn cells(rows: &[Vec<String>], column: usize) -> usize {
    rows.iter().filter_map(|row| row.get(column)).map(|cell| text::width(cell)).max().unwrap_or(0)
}

/// The width of a column whose head is broken between all of its words.
fn broken(heads: &[String], rows: &[Vec<String>], column: usize) -> usize {
    cells(rows, column).max(heads[column].split_whitespace().map(text::width).max().unwrap_or(0))
}

/// `T = 20` as one word, which is not broken.
fn tight(words: &str) -> String {
    words.replace(" = ", "=")
}

/// Columns of each column: as wide as its widest cell and its head. When that is too much, heads are broken between
/// words, the widest first; when that is not enough, cells are cut.
fn widths(heads: &[String], rows: &[Vec<String>], room: usize) -> Vec<usize> {
    let columns = heads.len();
    let head = |column: usize| text::width(&text::clean(&heads[column]));
    let broken: Vec<usize> = (0..columns).map(|column| broken(heads, rows, column)).collect();
    let cut: Vec<usize> = broken.iter().map(|&width| width.min(LEAST)).collect();
    let mut widths: Vec<usize> = (0..columns).map(|column| cells(rows, column).max(head(column))).collect();
    let gaps = GAP * columns.saturating_sub(1);
    for least in [&broken, &cut] {
        while widths.iter().sum::<usize>() + gaps > room {
            let widest = (0..columns).filter(|&c| widths[c] > least[c]).max_by_key(|&c| widths[c]);
            let Some(column) = widest else { break };
            widths[column] -= 1;
        }
    }
    widths
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_go_before_words_are_cut() {
        let words = |line: &[&str]| line.iter().map(|&word| word.to_owned()).collect::<Vec<String>>();
        let heads = words(&["method", "ε on D", "k0", "ε on Q, k=10", "p on D"]);
        let rows = [
            words(&["first-k", "0.242", "8", "0.316", "–"]),
            words(&["first-k − A", "+0.000", "+0", "+0.000", "1.000"]),
        ];
        // 11, 6 and 2, then 6 and 5, with two between.
        for (room, columns) in [(38, 5), (37, 4), (31, 4), (30, 3), (20, 2), (5, 2)] {
            assert_eq!(fitting(&heads, &rows, room), columns, "{room}");
        }
        assert_eq!(widths(&heads[..4], &rows, 31), [11, 6, 2, 6]);
        assert_eq!(fitting(&heads[..1], &rows, 3), 1);
    }
}

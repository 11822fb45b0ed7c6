//! Words into lines: widths, columns, hanging indents, and names made harmless.

use std::borrow::Cow;

use unicode_width::UnicodeWidthStr;

use crate::study::Cell;

/// Columns a line of text may fill.
pub(super) const WIDTH: usize = 100;
/// Shown where there is no figure.
pub(super) const NONE: &str = "–";

/// Text from a file without what a terminal would obey: control characters and overrides of the writing direction
/// become U+FFFD.
pub(crate) fn plain(text: &str) -> Cow<'_, str> {
    let harmful = |c: char| c.is_control() || matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    if text.contains(harmful) { Cow::Owned(text.replace(harmful, "\u{fffd}")) } else { Cow::Borrowed(text) }
}

/// A figure with `decimals`, without a sign where it rounds to zero; [`NONE`] for what is not a number.
pub(super) fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.bytes().all(|byte| matches!(byte, b'0' | b'.')) => zero.to_owned(),
        _ => text,
    }
}

/// A figure that may be missing.
pub(super) fn maybe(value: Option<f64>, decimals: usize) -> String {
    value.map_or_else(|| NONE.to_owned(), |value| number(value, decimals))
}

/// A table's cell as words.
pub(super) fn cell(cell: &Cell) -> String {
    match cell {
        Cell::Missing => NONE.to_owned(),
        Cell::Count(count) => count.to_string(),
        Cell::Number { value, decimals } => number(*value, usize::from(*decimals)),
        Cell::Text(text) => plain(text).into_owned(),
    }
}

/// Whether a column of cells is aligned to the right: all figures, or missing.
pub(super) fn is_figure(cell: &Cell) -> bool {
    !matches!(cell, Cell::Text(_))
}

/// `one model`, `2 models`.
pub(super) fn count(n: usize, one: &str, many: &str) -> String {
    format!("{n} {}", if n == 1 { one } else { many })
}

/// Seconds as `0.42 s`, `12.3 s`, `4 min 05 s`, `2 h 03 min`.
pub(super) fn duration(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    match whole {
        0..10 => format!("{seconds:.2} s"),
        10..60 => format!("{seconds:.1} s"),
        60..3600 => format!("{} min {:02} s", whole / 60, whole % 60),
        _ => format!("{} h {:02} min", whole / 3600, whole / 60 % 60),
    }
}

/// An aligned table: the heads, a rule, the rows; `right` says which columns are aligned to the right.
pub(super) fn columns(heads: &[String], rows: &[Vec<String>], right: &[bool], indent: &str) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.chain(heads.get(column)).map(|text| text.width()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..heads.len()).map(width).collect();
    let line = |row: &[String]| {
        let mut line = indent.to_owned();
        for (column, (text, width)) in row.iter().zip(&widths).enumerate() {
            let pad = " ".repeat(width - text.width());
            line.push_str(if column == 0 { "" } else { "  " });
            if right.get(column).copied().unwrap_or(false) {
                line.push_str(&pad);
                line.push_str(text);
            } else {
                line.push_str(text);
                line.push_str(&pad);
            }
        }
        line.truncate(line.trim_end().len());
        line.push('\n');
        line
    };
    let total = widths.iter().sum::<usize>() + 2 * widths.len().saturating_sub(1);
    let mut table = line(heads);
    table.push_str(indent);
    table.push_str(&"─".repeat(total));
    table.push('\n');
    table.extend(rows.iter().map(|row| line(row)));
    table
}

/// `first` and then the pieces, a separator between them, broken to [`WIDTH`]; later lines are indented as wide as
/// `first` is, unless that is more than half of the line. A piece is never broken.
pub(super) fn wrap<S: AsRef<str>>(first: &str, pieces: impl IntoIterator<Item = S>, separator: &str) -> String {
    let mut column = first.width();
    let indent = if column > WIDTH / 2 { 6 } else { column };
    let mut text = first.to_owned();
    let mut pieces = pieces.into_iter().peekable();
    let mut fresh = true;
    while let Some(piece) = pieces.next() {
        let piece = piece.as_ref();
        let tail = if pieces.peek().is_some() { separator } else { "" };
        let need = piece.width() + tail.trim_end().width();
        if !fresh && column + need > WIDTH {
            text.truncate(text.trim_end().len());
            text.push('\n');
            text.push_str(&" ".repeat(indent));
            column = indent;
        }
        text.push_str(piece);
        text.push_str(tail);
        column += piece.width() + tail.width();
        fresh = false;
    }
    text.truncate(text.trim_end().len());
    text.push('\n');
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_taken_out() {
        assert_eq!(plain("ant\u{1b}[2J\u{9b}1\r\n\u{202e}x"), "ant\u{fffd}[2J\u{fffd}1\u{fffd}\u{fffd}\u{fffd}x");
        assert!(matches!(plain("Ameise ü 蚂蚁"), Cow::Borrowed(_)));
    }

    #[test]
    fn columns_line_up_by_display_width() {
        let heads = ["class".to_owned(), "ε".to_owned()];
        let rows = [vec!["蚂蚁".to_owned(), "0.5".to_owned()], vec!["a".to_owned(), "10.25".to_owned()]];
        let table = columns(&heads, &rows, &[false, true], "  ");
        assert_eq!(table, "  class      ε\n  ────────────\n  蚂蚁     0.5\n  a      10.25\n");
    }

    #[test]
    fn long_lists_break_under_their_beginning_and_stay_in_the_width() {
        let text = wrap("  path  ", (0..60).map(|i| format!("+{i} 0.5")), " · ");
        assert!(text.lines().count() > 3);
        assert!(text.lines().all(|line| line.width() <= WIDTH), "{text}");
        assert!(text.lines().skip(1).all(|line| line.starts_with("        +")), "{text}");
        assert_eq!(wrap("none", [""; 0], ","), "none\n");
    }

    #[test]
    fn durations_read_well() {
        let shown = [0.0, 0.4237, 9.4, 12.34, 59.96, 245.0, 7384.0].map(duration);
        assert_eq!(shown, ["0.00 s", "0.42 s", "9.40 s", "12.3 s", "1 min 00 s", "4 min 05 s", "2 h 03 min"]);
    }
}

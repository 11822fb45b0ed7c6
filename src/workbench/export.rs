//! What a view shows as a table, and the table as CSV, JSON or text; what it shows as a figure, for SVG and PNG.
//!
//! Numbers are those that the view rounds: in CSV and JSON with the fewest digits that read back as the same double, in
//! text with six. A figure that does not exist is an empty field, and null in JSON.

use std::fmt::Write as _;

use serde_json::{Map, Value, json};

pub use self::{
    figures::{Drawing, drawing},
    rows::table,
};

mod experiment;
mod figures;
mod rows;

/// Rows under named columns.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Table {
    /// The names of the columns, in lower case and without spaces.
    pub columns: Vec<String>,
    /// The rows, each as long as the columns.
    pub rows: Vec<Vec<Value>>,
}

/// How a view is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Written {
    /// As a table.
    Table(Format),
    /// As a figure of lines and letters.
    Svg,
    /// As a figure of pixels.
    Png,
}

/// How a table is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A line a row, the columns' names first.
    Csv,
    /// An array with an object for each row.
    Json,
    /// Aligned columns.
    Text,
}

/// The endings of the files that a view can be written to.
pub const ENDINGS: [&str; 5] = ["csv", "json", "txt", "svg", "png"];

impl Written {
    /// What the ending of a file's name asks for.
    ///
    /// # Errors
    /// A line that says which endings there are.
    pub fn of(name: &str) -> Result<Self, String> {
        let ending = name.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
        match ending.as_deref() {
            Some("csv") => Ok(Self::Table(Format::Csv)),
            Some("json") => Ok(Self::Table(Format::Json)),
            Some("txt") => Ok(Self::Table(Format::Text)),
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err("the name must end in .csv, .json, .txt, .svg or .png, or in .toml for a recipe".to_owned()),
        }
    }
}

/// The name with the ending after its own, going round: Tab while a file's name is typed.
#[must_use]
pub fn next_ending(name: &str) -> String {
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    let at = ENDINGS.iter().position(|known| known.eq_ignore_ascii_case(ending));
    // What is no ending of ours belongs to the name.
    let stem = if at.is_some() { stem } else { name };
    format!("{stem}.{}", ENDINGS[at.map_or(0, |at| (at + 1) % ENDINGS.len())])
}

impl Table {
    pub(super) fn new(columns: &[&str]) -> Self {
        Self { columns: columns.iter().map(|name| (*name).to_owned()).collect(), rows: Vec::new() }
    }

    /// Writes the table.
    #[must_use]
    pub fn write(&self, format: Format) -> String {
        match format {
            Format::Csv => self.csv(),
            Format::Json => self.json(),
            Format::Text => self.text(),
        }
    }

    fn csv(&self) -> String {
        let line = |cells: &mut dyn Iterator<Item = String>| cells.map(quoted).collect::<Vec<_>>().join(",") + "\n";
        let mut text = line(&mut self.columns.iter().cloned());
        for row in &self.rows {
            text += &line(&mut row.iter().map(plain));
        }
        text
    }

    fn json(&self) -> String {
        let object = |row: &Vec<Value>| {
            let pairs = self.columns.iter().cloned().zip(row.iter().cloned());
            Value::Object(pairs.collect::<Map<_, _>>())
        };
        let mut text = "[".to_owned();
        for (place, row) in self.rows.iter().enumerate() {
            let _ = write!(text, "{}\n  {}", if place > 0 { "," } else { "" }, object(row));
        }
        text + "\n]\n"
    }

    fn text(&self) -> String {
        let cells = |row: &[Value]| row.iter().map(short).collect::<Vec<_>>();
        let lines: Vec<Vec<String>> =
            std::iter::once(self.columns.clone()).chain(self.rows.iter().map(|row| cells(row))).collect();
        let wide = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..self.columns.len()).map(wide).collect();
        let number = |column: usize| self.rows.iter().all(|row| !row[column].is_string());
        let mut text = String::new();
        for line in &lines {
            let mut shown = String::new();
            for (column, (cell, wide)) in line.iter().zip(&widths).enumerate() {
                let gap = " ".repeat(wide - cell.chars().count());
                let _ = if number(column) { write!(shown, "{gap}{cell}  ") } else { write!(shown, "{cell}{gap}  ") };
            }
            text += shown.trim_end();
            text.push('\n');
        }
        text
    }
}

/// A value without quotes.
fn plain(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

/// A value without quotes, a fraction with six significant digits.
fn short(value: &Value) -> String {
    match value.as_f64().filter(|number| !value.is_u64() && *number != 0.0) {
        Some(number) if (1e-4..1e6).contains(&number.abs()) => {
            let decimals = (5.0 - number.abs().log10().floor()).max(0.0) as usize;
            format!("{number:.decimals$}")
        }
        Some(number) => format!("{number:.5e}"),
        None => plain(value),
    }
}

/// A field as RFC 4180 has it.
fn quoted(field: String) -> String {
    if field.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", field.replace('"', "\"\"")) } else { field }
}

/// A figure, or nothing where it is none.
pub(super) fn figure(value: Option<f64>) -> Value {
    value.filter(|value| value.is_finite()).map_or(Value::Null, |value| json!(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let mut table = Table::new(&["name", "value"]);
        table.rows.push(vec![json!("a, \"b\""), json!(0.1)]);
        table.rows.push(vec![json!("c"), figure(Some(f64::NAN))]);
        table
    }

    #[test]
    fn the_three_formats() {
        assert_eq!(table().write(Format::Csv), "name,value\n\"a, \"\"b\"\"\",0.1\nc,\n");
        assert_eq!(table().write(Format::Text), "name       value\na, \"b\"  0.100000\nc\n");
        let read: Value = serde_json::from_str(&table().write(Format::Json)).unwrap();
        assert_eq!(read, json!([{"name": "a, \"b\"", "value": 0.1}, {"name": "c", "value": null}]));
        let empty: Value = serde_json::from_str(&Table::default().write(Format::Json)).unwrap();
        assert_eq!(empty, json!([]));
    }

    #[test]
    fn the_ending_names_the_format() {
        assert_eq!(Written::of("a/b.CSV"), Ok(Written::Table(Format::Csv)));
        assert_eq!(Written::of("b.json"), Ok(Written::Table(Format::Json)));
        assert_eq!(Written::of("b.svg"), Ok(Written::Svg));
        assert!(Written::of("b").is_err() && Written::of("csv").is_err());
        assert!(ENDINGS.iter().all(|ending| Written::of(&format!("a.{ending}")).is_ok()));
    }

    #[test]
    fn endings_go_round() {
        assert_eq!(next_ending("a.b.csv"), "a.b.json");
        assert_eq!(next_ending("curves.PNG"), "curves.csv");
        assert_eq!(next_ending("notes.xls"), "notes.xls.csv");
        assert_eq!(next_ending(""), ".csv");
    }
}

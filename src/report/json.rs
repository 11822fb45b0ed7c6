//! The report as JSON: schema `eigenselect-report`, version 1.
//!
//! Everything but the object `run` follows from the files, the parameters and the program's version: equal input
//! gives equal bytes, whether spectra were computed or read from the store. Drop `run` before comparing two reports
//! (`jq 'del(.run)'`).
//!
//! Numbers are written with the fewest digits that read back as the same double. A figure that does not exist is
//! `null`. Eigenvalue indices count from 1, and `λ_1` = 0 counts. `train` is the figure on D (each training model
//! against all the others), `query` the figure on Q (each query model against D).
//!
//! | key | value |
//! |---|---|
//! | `schema` | `{"name": "eigenselect-report", "version": 1}` |
//! | `program` | `{"name", "version"}` |
//! | `data` | `root`, `layout` in words; numbers of `classes`, `models`, `train`, `query` (both: taking part), `skipped` |
//! | `parameters` | name → value, as `--set NAME=VALUE` takes them; `class` counts from 1 |
//! | `complete` | whether everything was computed (always, in a report of `tui report`) |
//! | `classes` | array of `{"name", "train", "query", "skipped"}` |
//! | `models` | array of `{"name", "file", "class", "role": "train"\|"query", "state": "ready"\|"skipped"\|"waiting", "reason" (of a skipped one), "vertices", "triangles", "measure" (1ᵀB1), "eigenvalues" (how many are used), "decided" (AdaBoost's class), "defects": [text]}` |
//! | `skipped` | array of `{"name", "file", "reason"}` |
//! | `warnings` | array of text: what was passed over in the folder |
//! | `tables` | array of `{"number", "title", "columns": [text], "rows": [[number\|text\|null]]}`, figures unrounded |
//! | `curves` | `{"error": {"train": [ε at k = 1, 2, …], "query": […]}, "adr": {…}}`; `query` is empty without Q |
//! | `selections.first_k` | `best_error`, `best_adr`, `at_k`, each `{"k", "error": {"train", "query"}, "adr": {…}}` |
//! | `selections.hill_climbing` | `error` and `adr` (the cost), each `{"selected": [index], "steps": [{"index", "added", "cost"}], "error": {"train", "query"}, "adr": {…}}` |
//! | `selections.adaboost` | `{"error": {…}, "mean_chosen", "mean_ties", "classes": [{"class", "selected": [{"index", "alpha", "low", "mean", "high"}], "rounds": [{"index", "error", "alpha", "ties": [index]}]}]}`; `low`, `mean`, `high` of the class's training features |
//! | `spectra` | with `--spectra` only: array of `{"name", "eigenvalues": [λ]}`, ascending, without normalisation |
//! | `run` | `seconds`, `threads`, `cache`, `spectra: {"computed", "memory", "disk"}`, `stages`, `models: [{"name", "source": "ran"\|"memory"\|"disk", "seconds"}]`, `warnings` |
//!
//! Within version 1 keys may be added; none is renamed, removed or given another meaning.

use std::io;

use serde::{Serialize, Serializer, ser::SerializeSeq};
use serde_json::ser::Formatter;

use super::Document;
use crate::study::{Cell, Table};

/// The schema's name.
pub const SCHEMA: &str = "eigenselect-report";
/// The schema's version.
pub const VERSION: u32 = 1;

/// How deep in the nesting members stand on lines of their own; deeper ones share a line.
const DEPTH: usize = 2;

/// Writes the document: a line for each member of each top-level value, so that a model is a line and a curve is a
/// line, and a line end at the end.
///
/// # Errors
/// Only those of `out`.
pub fn write(document: &Document, out: &mut dyn io::Write) -> io::Result<()> {
    lines(document, out)
}

/// Writes any value so.
pub(super) fn lines<T: Serialize + ?Sized>(value: &T, out: &mut dyn io::Write) -> io::Result<()> {
    let mut serializer = serde_json::Serializer::with_formatter(&mut *out, Lines::default());
    value.serialize(&mut serializer).map_err(io::Error::from)?;
    out.write_all(b"\n")
}

/// [`Document::tables`] with bare numbers for figures.
pub(super) fn tables<S: Serializer>(tables: &[Table], serializer: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Plain<'a> {
        number: u32,
        title: &'a str,
        columns: &'a [String],
        rows: Vec<Vec<Bare<'a>>>,
    }
    #[derive(Serialize)]
    #[serde(untagged)]
    enum Bare<'a> {
        Missing,
        Count(u64),
        Number(f64),
        Text(&'a str),
    }
    fn bare(cell: &Cell) -> Bare<'_> {
        match cell {
            Cell::Missing => Bare::Missing,
            Cell::Count(count) => Bare::Count(*count),
            Cell::Number { value, .. } => Bare::Number(*value),
            Cell::Text(text) => Bare::Text(text),
        }
    }
    let mut array = serializer.serialize_seq(Some(tables.len()))?;
    for table in tables {
        array.serialize_element(&Plain {
            number: table.number,
            title: &table.title,
            columns: &table.columns,
            rows: table.rows.iter().map(|row| row.iter().map(bare).collect()).collect(),
        })?;
    }
    array.end()
}

/// Breaks lines down to [`DEPTH`] and not below.
#[derive(Default)]
struct Lines {
    depth: usize,
    /// Whether the innermost array or object has a member.
    filled: bool,
}

impl Lines {
    fn line<W: ?Sized + io::Write>(&self, out: &mut W) -> io::Result<()> {
        out.write_all(b"\n")?;
        (0..self.depth).try_for_each(|_| out.write_all(b"  "))
    }

    fn open<W: ?Sized + io::Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        self.depth += 1;
        self.filled = false;
        out.write_all(bracket)
    }

    fn close<W: ?Sized + io::Write>(&mut self, out: &mut W, bracket: &[u8]) -> io::Result<()> {
        let broken = self.filled && self.depth <= DEPTH;
        self.depth -= 1;
        // Its owner has a member now: this one.
        self.filled = true;
        if broken {
            self.line(out)?;
        }
        out.write_all(bracket)
    }

    fn member<W: ?Sized + io::Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.filled = true;
        let broken = self.depth <= DEPTH;
        match (first, broken) {
            (true, false) => Ok(()),
            (true, true) => self.line(out),
            (false, false) => out.write_all(b", "),
            (false, true) => {
                out.write_all(b",")?;
                self.line(out)
            }
        }
    }
}

impl Formatter for Lines {
    fn begin_array<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"[")
    }

    fn end_array<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"]")
    }

    fn begin_array_value<W: ?Sized + io::Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.member(out, first)
    }

    fn begin_object<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.open(out, b"{")
    }

    fn end_object<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        self.close(out, b"}")
    }

    fn begin_object_key<W: ?Sized + io::Write>(&mut self, out: &mut W, first: bool) -> io::Result<()> {
        self.member(out, first)
    }

    fn begin_object_value<W: ?Sized + io::Write>(&mut self, out: &mut W) -> io::Result<()> {
        out.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use serde_json::Value;

    use super::*;
    use crate::report::{Origin, example};

    fn json(document: &Document) -> String {
        let mut bytes = Vec::new();
        write(document, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn the_schema_stays() {
        insta::assert_snapshot!(json(&example::document()));
    }

    #[test]
    fn every_number_reads_back_as_the_same_double() {
        let document = example::document();
        let value: Value = serde_json::from_str(&json(&document)).unwrap();
        let written: Vec<f64> =
            value["curves"]["adr"]["train"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        assert_eq!(written, document.curves.unwrap().adr.train);
        let spectra = document.spectra.unwrap();
        for (row, spectrum) in value["spectra"].as_array().unwrap().iter().zip(&spectra) {
            let read: Vec<f64> = row["eigenvalues"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
            assert_eq!(read, spectrum.eigenvalues);
        }
    }

    #[test]
    fn parameters_can_be_set_again_from_the_report() {
        let document = example::document();
        let value: Value = serde_json::from_str(&json(&document)).unwrap();
        let mut settings = crate::query::Settings::default();
        for (name, value) in value["parameters"].as_object().unwrap() {
            let parameter = crate::query::Parameter::named(name).unwrap();
            let word = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
            settings.set(parameter, &word, document.classes.len()).unwrap();
        }
        assert_eq!(settings, document.parameters.0);
    }

    #[test]
    fn what_differs_from_run_to_run_is_in_run_alone() {
        let answer = example::answer();
        let mut warm = answer.clone();
        let rows = std::sync::Arc::make_mut(&mut warm.models);
        for row in rows.iter_mut() {
            if let crate::query::ModelState::Ready { source, count, seconds } = &mut row.state {
                // A store that was filled for a greater kmax holds more than was asked for.
                (*source, *count, *seconds) = (crate::query::Source::Disk, *count + 100, 0.0);
                let more = row.eigenvalues.iter().flat_map(|values| values.iter().copied()).chain([1e6; 100]);
                row.eigenvalues = Some(std::sync::Arc::new(more.collect()));
            }
        }
        warm.stages.clear();
        warm.serial += 7;
        warm.warnings = std::sync::Arc::new(vec!["cache: read-only".to_owned()]);
        let parts = |document: &Document| {
            let text = json(document);
            let (figures, run) = text.split_once("\n  \"run\": ").unwrap();
            (figures.to_owned(), run.to_owned())
        };
        let cold = parts(&Document::new(&answer, &example::origin()));
        let warm = parts(&Document::new(&warm, &Origin { seconds: 0.1, threads: 9, ..example::origin() }));
        assert_eq!(cold.0, warm.0);
        assert_ne!(cold.1, warm.1);
    }

    #[test]
    fn undefined_figures_are_null_and_names_cannot_break_the_text() {
        let mut document = example::document();
        document.data.root = "a\"b\u{1b}\\\n".to_owned();
        document.curves.as_mut().unwrap().error.train[0] = f64::NAN;
        let value: Value = serde_json::from_str(&json(&document)).unwrap();
        assert_eq!(value["data"]["root"], "a\"b\u{1b}\\\n");
        assert!(value["curves"]["error"]["train"][0].is_null());
    }
}

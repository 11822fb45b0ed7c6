//! The report as CSV: one tidy table, or a folder with a file for each table.
//!
//! # The tidy table
//!
//! [`write_long`] writes one figure a row, in the columns `section,item,index,measure,set,value`. `value` is always a
//! number, so the column needs no conversion; rows without a figure are left out.
//!
//! | section | item | index | measure | set |
//! |---|---|---|---|---|
//! | `curve` | `first-k` | k | `error`, `adr` | `train`, `query` |
//! | `table1` … `table4` | the words in the row | row, from 1 | the column's head | |
//! | `score` | `hcbw-error`, `hcbw-adr`, `adaboost` | | `error`, `adr` | `train`, `query` |
//! | `selected` | `hcbw-error`, `hcbw-adr` | eigenvalue | `step` (the last move that took it, from 1) | |
//! | `selected` | a class (AdaBoost) | eigenvalue | `alpha`, `low`, `mean`, `high` | |
//! | `model` | the model | | `vertices`, `triangles`, `eigenvalues`, `defects` (how many), `measure` (1ᵀB1) | `train`, `query` |
//! | `spectrum` | the model | k | `eigenvalue` (with `--spectra`) | `train`, `query` |
//!
//! # The folder
//!
//! [`files`] has `parameters.csv`, `classes.csv`, `models.csv`, `skipped.csv`, `table1.csv` …, `curves.csv` (k against
//! the four curves), `hill_climbing.csv` (a move a row), `adaboost_rounds.csv`, `adaboost_selected.csv` and, with
//! `--spectra`, `spectra.csv`. A figure that does not exist is an empty field.
//!
//! Numbers are written with the fewest digits that read back as the same double.

use std::io;

use ::csv::Writer;

use super::{ClimbPart, Document, ModelRecord};
use crate::{
    dataset::Role,
    study::{Cell, Curve, Score, Table},
};

/// The folder's files: name and content.
///
/// # Errors
/// Never in practice: the writing is to memory.
pub fn files(document: &Document) -> io::Result<Vec<(String, Vec<u8>)>> {
    let mut files = vec![
        ("parameters.csv".to_owned(), parameters(document)?),
        ("classes.csv".to_owned(), classes(document)?),
        ("models.csv".to_owned(), models(document)?),
        ("skipped.csv".to_owned(), skipped(document)?),
    ];
    for one in &document.tables {
        files.push((format!("table{}.csv", one.number), table(one)?));
    }
    if let Some(curves) = &document.curves {
        files.push(("curves.csv".to_owned(), self::curves(&curves.error, &curves.adr)?));
    }
    let climbs = &document.selections.hill_climbing;
    if climbs.error.is_some() || climbs.adr.is_some() {
        files.push(("hill_climbing.csv".to_owned(), hill_climbing(document)?));
    }
    if document.selections.adaboost.is_some() {
        files.push(("adaboost_rounds.csv".to_owned(), adaboost_rounds(document)?));
        files.push(("adaboost_selected.csv".to_owned(), adaboost_selected(document)?));
    }
    if document.spectra.is_some() {
        files.push(("spectra.csv".to_owned(), spectra(document)?));
    }
    Ok(files)
}

/// A number with the fewest digits that read back as the same double; nothing when it is none.
fn digits(value: f64) -> String {
    if value.is_finite() { format!("{value:?}") } else { String::new() }
}

fn maybe(value: Option<f64>) -> String {
    value.map_or_else(String::new, digits)
}

fn optional(value: Option<usize>) -> String {
    value.map_or_else(String::new, |value| value.to_string())
}

const fn role(role: Role) -> &'static str {
    match role {
        Role::Train => "train",
        Role::Query => "query",
    }
}

/// Writes rows to memory.
fn sheet<F>(heads: &[&str], rows: F) -> io::Result<Vec<u8>>
where
    F: FnOnce(&mut Writer<Vec<u8>>) -> ::csv::Result<()>,
{
    let mut writer = Writer::from_writer(Vec::new());
    writer.write_record(heads)?;
    rows(&mut writer)?;
    writer.into_inner().map_err(::csv::IntoInnerError::into_error)
}

fn parameters(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["parameter", "value"], |out| {
        document.parameters.pairs().try_for_each(|(parameter, value)| out.write_record([parameter.name(), &value]))
    })
}

fn classes(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["class", "train", "query", "skipped"], |out| {
        document.classes.iter().try_for_each(|class| {
            let counts = [class.train, class.query, class.skipped].map(|n| n.to_string());
            out.write_record([&class.name, &counts[0], &counts[1], &counts[2]])
        })
    })
}

fn models(document: &Document) -> io::Result<Vec<u8>> {
    let heads = [
        "model",
        "file",
        "class",
        "role",
        "state",
        "vertices",
        "triangles",
        "measure",
        "eigenvalues",
        "decided",
        "defects",
    ];
    sheet(&heads, |out| {
        document.models.iter().try_for_each(|model| {
            out.write_record([
                model.name.as_str(),
                &model.file,
                &model.class,
                role(model.role),
                match model.state {
                    super::ModelStatus::Ready => "ready",
                    super::ModelStatus::Skipped => "skipped",
                    super::ModelStatus::Waiting => "waiting",
                },
                &optional(model.vertices),
                &optional(model.triangles),
                &maybe(model.measure),
                &optional(model.eigenvalues),
                model.decided.as_deref().unwrap_or_default(),
                &model.defects.join(" | "),
            ])
        })
    })
}

fn skipped(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["model", "file", "reason"], |out| {
        document.skipped.iter().try_for_each(|model| out.write_record([&model.name, &model.file, &model.reason]))
    })
}

/// One table, its heads first.
pub(super) fn table(table: &Table) -> io::Result<Vec<u8>> {
    let heads: Vec<&str> = table.columns.iter().map(String::as_str).collect();
    sheet(&heads, |out| {
        table.rows.iter().try_for_each(|row| {
            out.write_record(row.iter().map(|cell| match cell {
                Cell::Missing => String::new(),
                Cell::Count(count) => count.to_string(),
                Cell::Number { value, .. } => digits(*value),
                Cell::Text(text) => text.clone(),
            }))
        })
    })
}

fn curves(error: &Curve, adr: &Curve) -> io::Result<Vec<u8>> {
    sheet(&["k", "error_train", "error_query", "adr_train", "adr_query"], |out| {
        (0..error.train.len()).try_for_each(|at| {
            let value = |values: &[f64]| maybe(values.get(at).copied());
            let values = [value(&error.train), value(&error.query), value(&adr.train), value(&adr.query)];
            out.write_record([&(at + 1).to_string(), &values[0], &values[1], &values[2], &values[3]])
        })
    })
}

/// The two hill climbings by name.
fn climbs(document: &Document) -> impl Iterator<Item = (&'static str, &ClimbPart)> {
    let climbs = &document.selections.hill_climbing;
    [("hcbw-error", climbs.error.as_ref()), ("hcbw-adr", climbs.adr.as_ref())]
        .into_iter()
        .filter_map(|(name, climbed)| Some((name, climbed?)))
}

fn hill_climbing(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["method", "step", "move", "index", "cost"], |out| {
        climbs(document).try_for_each(|(name, climbed)| {
            (1..).zip(&climbed.steps).try_for_each(|(at, step): (usize, _)| {
                let word = if step.added { "add" } else { "remove" };
                out.write_record([name, &at.to_string(), word, &step.index.to_string(), &digits(step.cost)])
            })
        })
    })
}

fn adaboost_rounds(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["class", "round", "index", "error", "alpha", "ties"], |out| {
        document.selections.adaboost.iter().flat_map(|boost| &boost.classes).try_for_each(|class| {
            (1..).zip(&class.rounds).try_for_each(|(at, round): (usize, _)| {
                let ties: Vec<String> = round.ties.iter().map(ToString::to_string).collect();
                out.write_record([
                    &class.class,
                    &at.to_string(),
                    &round.index.to_string(),
                    &digits(round.error),
                    &digits(round.alpha),
                    &ties.join(" "),
                ])
            })
        })
    })
}

fn adaboost_selected(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["class", "index", "alpha", "low", "mean", "high"], |out| {
        document.selections.adaboost.iter().flat_map(|boost| &boost.classes).try_for_each(|class| {
            class.selected.iter().try_for_each(|mark| {
                let figures = [mark.alpha, mark.low, mark.mean, mark.high].map(digits);
                out.write_record([
                    &class.class,
                    &mark.index.to_string(),
                    &figures[0],
                    &figures[1],
                    &figures[2],
                    &figures[3],
                ])
            })
        })
    })
}

fn spectra(document: &Document) -> io::Result<Vec<u8>> {
    sheet(&["model", "k", "eigenvalue"], |out| {
        document.spectra.iter().flatten().try_for_each(|row| {
            (1..)
                .zip(&row.eigenvalues)
                .try_for_each(|(k, &value): (usize, _)| out.write_record([&row.name, &k.to_string(), &digits(value)]))
        })
    })
}

/// Rows of the tidy table.
struct Long<'a> {
    out: Writer<&'a mut dyn io::Write>,
}

impl Long<'_> {
    fn row(
        &mut self,
        section: &str,
        item: &str,
        index: Option<usize>,
        measure: &str,
        set: &str,
        value: f64,
    ) -> io::Result<()> {
        if value.is_finite() {
            self.out.write_record([section, item, &optional(index), measure, set, &digits(value)])?;
        }
        Ok(())
    }

    fn score(&mut self, item: &str, measure: &str, score: Score) -> io::Result<()> {
        self.row("score", item, None, measure, "train", score.train)?;
        score.query.map_or(Ok(()), |query| self.row("score", item, None, measure, "query", query))
    }
}

/// Writes the tidy table.
///
/// # Errors
/// Only those of `out`.
pub fn write_long(document: &Document, out: &mut dyn io::Write) -> io::Result<()> {
    let mut long = Long { out: Writer::from_writer(out) };
    long.out.write_record(["section", "item", "index", "measure", "set", "value"])?;
    for one in &document.tables {
        long_table(&mut long, one)?;
    }
    if let Some(curves) = &document.curves {
        for (measure, curve) in [("error", &curves.error), ("adr", &curves.adr)] {
            for (set, values) in [("train", &curve.train), ("query", &curve.query)] {
                for (at, &value) in values.iter().enumerate() {
                    long.row("curve", "first-k", Some(at + 1), measure, set, value)?;
                }
            }
        }
    }
    for (name, climbed) in climbs(document) {
        long.score(name, "error", climbed.error)?;
        long.score(name, "adr", climbed.adr)?;
        for &index in &climbed.selected {
            let last = climbed.steps.iter().rposition(|step| step.added && step.index == index);
            if let Some(last) = last {
                long.row("selected", name, Some(index as usize), "step", "", (last + 1) as f64)?;
            }
        }
    }
    if let Some(boost) = &document.selections.adaboost {
        long.score("adaboost", "error", boost.error)?;
        for class in &boost.classes {
            for mark in &class.selected {
                let figures = [("alpha", mark.alpha), ("low", mark.low), ("mean", mark.mean), ("high", mark.high)];
                for (measure, value) in figures {
                    long.row("selected", &class.class, Some(mark.index as usize), measure, "", value)?;
                }
            }
        }
    }
    long_models(&mut long, document)?;
    long.out.flush()
}

fn long_table(long: &mut Long<'_>, table: &Table) -> io::Result<()> {
    let section = format!("table{}", table.number);
    for (at, row) in table.rows.iter().enumerate() {
        let words = row.iter().filter_map(|cell| if let Cell::Text(text) = cell { Some(text.as_str()) } else { None });
        let item = words.collect::<Vec<_>>().join(" ");
        for (head, cell) in table.columns.iter().zip(row) {
            let value = match cell {
                Cell::Count(count) => *count as f64,
                Cell::Number { value, .. } => *value,
                Cell::Missing | Cell::Text(_) => continue,
            };
            long.row(&section, &item, Some(at + 1), head, "", value)?;
        }
    }
    Ok(())
}

fn long_models(long: &mut Long<'_>, document: &Document) -> io::Result<()> {
    for model in &document.models {
        let figures = [
            ("vertices", model.vertices),
            ("triangles", model.triangles),
            ("eigenvalues", model.eigenvalues),
            ("defects", Some(model.defects.len())),
        ];
        for (measure, value) in figures {
            if let Some(value) = value {
                long.row("model", &model.name, None, measure, role(model.role), value as f64)?;
            }
        }
        if let Some(measure) = model.measure {
            long.row("model", &model.name, None, "measure", role(model.role), measure)?;
        }
    }
    let set = |name: &str| {
        let found: Option<&ModelRecord> = document.models.iter().find(|model| model.name == name);
        found.map_or("", |model| role(model.role))
    };
    for row in document.spectra.iter().flatten() {
        let set = set(&row.name);
        for (at, &value) in row.eigenvalues.iter().enumerate() {
            long.row("spectrum", &row.name, Some(at + 1), "eigenvalue", set, value)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    fn long(document: &Document) -> String {
        let mut bytes = Vec::new();
        write_long(document, &mut bytes).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    #[test]
    fn the_tidy_table_stays() {
        insta::assert_snapshot!(long(&example::document()));
    }

    #[test]
    fn the_folder_stays() {
        let files = files(&example::document()).unwrap();
        let shown = files.iter().map(|(name, bytes)| format!("== {name}\n{}", String::from_utf8_lossy(bytes)));
        insta::assert_snapshot!(shown.collect::<Vec<_>>().join("\n"));
    }

    #[test]
    fn every_value_of_the_tidy_table_is_a_number() {
        let text = long(&example::document());
        let mut reader = ::csv::Reader::from_reader(text.as_bytes());
        let mut rows = 0;
        for record in reader.records() {
            let record = record.unwrap();
            assert_eq!(record.len(), 6);
            assert!(record[5].parse::<f64>().unwrap().is_finite(), "{record:?}");
            rows += 1;
        }
        assert!(rows > 100);
    }

    #[test]
    fn curves_read_back_as_the_same_doubles() {
        let document = example::document();
        let (_, bytes) = files(&document).unwrap().into_iter().find(|(name, _)| name == "curves.csv").unwrap();
        let mut reader = ::csv::Reader::from_reader(&bytes[..]);
        let read: Vec<f64> = reader.records().map(|record| record.unwrap()[4].parse().unwrap()).collect();
        assert_eq!(read, document.curves.unwrap().adr.query);
    }
}

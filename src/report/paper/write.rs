//! The document as files.

use std::{
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
};

use serde::Serialize;

use super::{Examined, Found, Head, Paper, Rows, Section, Variation, tuned};
use crate::{
    figure::{FigureError, PRINT},
    report::{csv, json, markdown},
    study::{Retrieved, Table, Tuned},
};

/// Why a document was not written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// A table.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// A figure.
    #[error(transparent)]
    Figure(#[from] FigureError),
    /// A file or the folder.
    #[error("{}: cannot be written: {source}", path.display())]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
}

/// Writes files into a folder, which is made if it is absent; returns their names.
pub(super) fn save(folder: &Path, files: Vec<(String, Vec<u8>)>) -> Result<Vec<String>, WriteError> {
    let at = |path: PathBuf| move |source| WriteError::File { path, source };
    fs::create_dir_all(folder).map_err(at(folder.to_owned()))?;
    let save = |(name, bytes): (String, Vec<u8>)| {
        let path = folder.join(&name);
        fs::write(&path, bytes).map_err(at(path))?;
        Ok(name)
    };
    files.into_iter().map(save).collect()
}

/// The JSON.
#[derive(Serialize)]
struct Whole<'a> {
    #[serde(flatten)]
    head: &'a Head,
    #[serde(serialize_with = "json::tables")]
    tables: Vec<Table>,
    spectra: &'a [Rows],
    variation: Option<&'a Variation>,
    retrieved: &'a [Retrieved],
    honest: &'a [Examined],
    tuned: Option<&'a Tuned>,
}

impl Paper {
    /// Every file of the document, with its name: `paper.md`, `paper.json`, a CSV per table, an SVG and a PNG per
    /// figure.
    ///
    /// # Errors
    /// [`WriteError`], when a figure is too large to be drawn.
    pub fn files(&self) -> Result<Vec<(String, Vec<u8>)>, WriteError> {
        let mut files = vec![("paper.md".to_owned(), self.markdown().into_bytes())];
        for section in &self.sections {
            if let Some((stem, table)) = &section.table {
                files.push((format!("{stem}.csv"), csv::table(table)?));
            }
            if let Some((stem, figure)) = &section.figure {
                files.push((format!("{stem}.svg"), figure.svg().into_bytes()));
                files.push((format!("{stem}.png"), figure.png(PRINT)?));
            }
        }
        let tables = self.sections.iter().filter_map(|section| Some(section.table.as_ref()?.1.clone())).collect();
        let Found { rows, variation, retrieved, honest, tuned } = &self.found;
        let tuned = tuned.as_ref().map(|(tuned, models)| (&**tuned, &models[..]));
        files.push(("pairs.csv".to_owned(), csv::table(&tuned::pairs(honest, tuned))?));
        let (variation, tuned) = (variation.as_ref().ok(), tuned.map(|(tuned, _)| tuned));
        let whole = Whole { head: &self.head, tables, spectra: rows, variation, retrieved, honest, tuned };
        let mut bytes = Vec::new();
        json::lines(&whole, &mut bytes)?;
        files.push(("paper.json".to_owned(), bytes));
        Ok(files)
    }

    /// The document as Markdown; tables and figures lie beside it.
    #[must_use]
    pub fn markdown(&self) -> String {
        let mut text = String::new();
        let Head { program, data, layout, classes, parameters } = &self.head;
        let escape = markdown::escape;
        let _ = writeln!(text, "# Selecting eigenvalues for shape comparison: {}\n", escape(data));
        let most = self.found.rows.iter().max_by_key(|rows| rows.train + rows.query);
        let (train, query) = most.map_or((0, 0), |rows| (rows.train, rows.query));
        let _ = writeln!(text, "- Layout: {}", escape(layout));
        let _ = writeln!(text, "- {} classes, {train} training models (D), {query} query models (Q)", classes.len());
        let pairs: Vec<String> = parameters.pairs().map(|(name, value)| format!("{}={value}", name.name())).collect();
        let _ = writeln!(text, "- Parameters beside the spectrum: `{}`", pairs.join(" "));
        let _ = writeln!(text, "- {} {}", program.name, program.version);
        for section in &self.sections {
            self::section(section, &mut text);
        }
        self.out(&mut text);
        text
    }

    /// Models that a spectrum had to do without.
    fn out(&self, text: &mut String) {
        let rows = self.found.rows.iter().flat_map(|rows| {
            rows.out.iter().map(|(model, why)| vec![rows.name.clone(), markdown::escape(model), markdown::escape(why)])
        });
        let rows: Vec<Vec<String>> = rows.collect();
        if !rows.is_empty() {
            let _ = writeln!(text, "\n## Models that take no part\n");
            text.push_str(&markdown::table(&["spectrum", "model", "why"], &[false; 3], rows));
        }
    }
}

fn section(section: &Section, text: &mut String) {
    let _ = writeln!(text, "\n## {}", section.heading);
    if let Some((stem, figure)) = &section.figure {
        // Twice the size that it is printed in, as far as a screen has room.
        let width = if figure.across > 1 { 960 } else { 640 };
        let name = section.heading.replace('"', "&quot;");
        let _ = writeln!(text, "\n<img src=\"{stem}.svg\" width=\"{width}\" alt=\"{name}\">");
    }
    for words in &section.words {
        let _ = writeln!(text, "\n{words}");
    }
    if let Some((_, table)) = &section.table {
        text.push('\n');
        text.push_str(&markdown::rows(table));
    }
}

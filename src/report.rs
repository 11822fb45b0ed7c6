//! Rows → text, Markdown, CSV, JSON.
//!
//! A [`Document`] is made from an [`Answer`](crate::query::Answer) and is what every writer writes: one room per
//! format, and none of them computes a figure. What depends on the moment (times, what came from where) is in
//! [`Document::run`] alone, so two documents of equal input are equal but for it.
//!
//! | format | room | made for |
//! |---|---|---|
//! | text | [`text`] | reading in a terminal or a mail |
//! | Markdown | [`markdown`] | a notebook, a wiki page |
//! | CSV | [`mod@csv`] | pandas, R, a spreadsheet |
//! | JSON | [`mod@json`] | programs, and checks of every figure; its schema is stable |
//!
//! [`figures`] are made of the same rows. [`paper`] is another document: the whole experiment of the paper, beside its
//! published figures, with figures for print. [`spectrum`] writes the eigenvalues of single meshes, also as the `.ev`
//! file of ShapeDNA and LaPy.

use std::io;

pub use self::document::{
    Boost, ClassPart, ClassRow, ClimbPart, Climbs, Curves, Data, Document, FirstKPart, Identity, ModelRecord,
    ModelStatus, Origin, Parameters, Read, Run, RunModel, Selections, Skipped, SpectrumRow, StoreCounts,
};

pub(crate) use self::layout::plain;

pub mod csv;
mod document;
pub mod figures;
pub mod json;
mod layout;
pub mod markdown;
pub mod paper;
mod plot;
pub mod spectrum;
pub mod text;

#[cfg(test)]
mod example;

/// How a report is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Format {
    /// Aligned plain text.
    #[default]
    Text,
    /// Markdown with tables.
    Markdown,
    /// One tidy table in long format.
    Csv,
    /// The whole document.
    Json,
}

impl Document {
    /// Writes the document in one piece.
    ///
    /// # Errors
    /// Only those of `out`.
    pub fn write(&self, format: Format, out: &mut dyn io::Write) -> io::Result<()> {
        match format {
            Format::Text => out.write_all(text::render(self).as_bytes()),
            Format::Markdown => out.write_all(markdown::render(self).as_bytes()),
            Format::Csv => csv::write_long(self, out),
            Format::Json => json::write(self, out),
        }
    }
}

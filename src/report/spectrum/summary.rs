//! A line for each mesh: whether it has a spectrum, and what was done to it.

use std::fmt::Write as _;

use unicode_width::UnicodeWidthStr as _;

use super::{MeshSpectrum, Spectra};
use crate::report::layout::plain;

/// A mesh's line, cell by cell.
fn row(spectrum: &MeshSpectrum) -> [String; 6] {
    let found = spectrum.eigenvalues.len();
    let zeros = spectrum.eigenvalues.iter().filter(|value| **value == 0.0).count();
    let done = if spectrum.notes.is_empty() { "nothing".to_owned() } else { spectrum.notes.join("; ") };
    [
        plain(&spectrum.file).into_owned(),
        spectrum.vertices.to_string(),
        spectrum.triangles.to_string(),
        if found == spectrum.order { format!("all {found}") } else { found.to_string() },
        zeros.to_string(),
        plain(&done).into_owned(),
    ]
}

impl Spectra {
    /// A table of all meshes: their sizes, how many eigenvalues are certified, how many of these are zero, and what was
    /// done to the mesh; then the meshes that were refused, with the reason.
    #[must_use]
    pub fn summary(&self) -> String {
        let head = ["mesh", "vertices", "faces", "certified", "zeros", "what was done"].map(str::to_owned);
        let refused = self.failed.iter().map(|failed| {
            let none = || "–".to_owned();
            [
                plain(&failed.file).into_owned(),
                none(),
                none(),
                none(),
                none(),
                format!("refused: {}", plain(&failed.reason)),
            ]
        });
        let rows: Vec<[String; 6]> = std::iter::once(head).chain(self.spectra.iter().map(row)).chain(refused).collect();
        let width = |column: usize| rows.iter().map(|row| row[column].width()).max().unwrap_or(0);
        let widths = [0, 1, 2, 3, 4].map(width);
        let mut text = String::new();
        for row in &rows {
            for (column, (cell, width)) in row.iter().zip(widths).enumerate() {
                let pad = " ".repeat(width - cell.width());
                let _ = if column == 0 { write!(text, "{cell}{pad}") } else { write!(text, "  {pad}{cell}") };
            }
            let _ = writeln!(text, "  {}", row[5]);
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::spectrum::Failed;

    #[test]
    fn columns_line_up_by_display_width() {
        let mut spectra = Spectra::new();
        for file in ["蚂蚁.off", "ant.off"] {
            spectra.failed.push(Failed { file: file.to_owned(), reason: "none".to_owned() });
        }
        let text = spectra.summary();
        let places: Vec<usize> =
            text.lines().skip(1).map(|line| line[..line.find("refused").unwrap()].width()).collect();
        assert_eq!(places[0], places[1], "{text}");
    }
}

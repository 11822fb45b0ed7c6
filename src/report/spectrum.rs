//! Eigenvalues of single meshes as text, CSV, JSON and ShapeDNA's `.ev`.
//!
//! # JSON
//!
//! Schema `eigenselect-spectra`, version 1, written as [`super::json`] is: `schema`, `program`; `spectra`, an array
//! of what [`MeshSpectrum`] holds, in the order of the command line; `failed`, an array of `{"file", "reason"}`; and
//! `run`, the only part that differs from run to run.
//!
//! # CSV
//!
//! `mesh,k,eigenvalue,error`: k from 1 for the first eigenvalue of the mesh, `error` a bound on the eigenvalue's error.
//!
//! # `.ev`
//!
//! [`ev`] writes the text format in which ShapeDNA and LaPy (`lapy.io.read_ev`) keep eigenvalues: lines of
//! `Key: value`, then `Eigenvalues:` and on the next line `{ λ_1 ; λ_2 ; … }`. Numbers are written with the fewest
//! digits that read back as the same double. Creator and file stand before ` : `, as the format's times do: LaPy 1.7
//! takes `Creator:`, `File:` and `User:` for integers and stops; with the space, all its versions pass over them.

use std::{fmt::Write as _, io};

use serde::Serialize;

use super::{
    Identity,
    document::StoreCounts,
    json,
    layout::{count, number, plain},
};
use crate::{
    laplacian::{Boundary, Mass, Operator, Triangulation},
    mesh::{GeometryHash, Survey},
    query::Source,
    spectrum::{Choice, Count, Spectrum, Window},
};

mod summary;

/// The JSON schema's name.
pub const SCHEMA: &str = "eigenselect-spectra";
/// Its version.
pub const VERSION: u32 = 1;

/// The spectrum of one mesh file.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshSpectrum {
    /// The file as the user wrote it.
    pub file: String,
    /// Hash of the geometry: equal for the same shape in another file, format or order.
    pub geometry: String,
    /// Vertices, used or not.
    pub vertices: usize,
    /// Triangles, polygons having been cut.
    pub triangles: usize,
    /// Area in the file's unit of length squared.
    pub area: f64,
    /// Connected parts.
    pub components: usize,
    /// Edges of one triangle.
    pub boundary_edges: usize,
    /// Vertices − edges + triangles.
    pub euler: i64,
    /// Of a closed, orientable manifold: the sum over its parts.
    pub genus: Option<u64>,
    /// What is wrong with the mesh, one line each, each with its place.
    pub defects: Vec<String>,
    /// The eigenproblem.
    pub operator: Operator,
    /// The mass matrix; none for cot.
    pub mass: Option<Mass>,
    /// The condition on the boundary.
    pub boundary: Boundary,
    /// Which triangles were asked for; `notes` say what was done.
    pub triangulation: Triangulation,
    /// Total mass 1ᵀB1: the area for FEM, the number of vertices for cot.
    pub measure: f64,
    /// How many eigenvalues the mesh has altogether.
    pub order: usize,
    /// What was done to the mesh, and what else is to be known.
    pub notes: Vec<String>,
    /// How many eigenvalues lie below the first one of these: 0 unless those near some λ were asked for.
    pub below: usize,
    /// λ ascending, zeros exactly 0: as many as were asked for, or all there are.
    pub eigenvalues: Vec<f64>,
    /// For each of them a bound on its error, in its unit.
    pub errors: Vec<f64>,
    /// The counts that prove that none is missing.
    pub certificate: Vec<InertiaCount>,
}

/// Of a piece of the mesh, so many eigenvalues lie below a shift: as many as `L − σB` has negative pivots.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InertiaCount {
    /// Which piece: 0 for all small ones together, then the large ones.
    pub part: u32,
    /// σ; none where nothing lies above.
    pub shift: Option<f64>,
    /// How many eigenvalues of the piece lie below it.
    pub below: usize,
}

impl MeshSpectrum {
    /// The first `count` eigenvalues of the mesh in `file`.
    #[must_use]
    pub fn new(
        file: String,
        geometry: GeometryHash,
        survey: &Survey,
        choice: Choice,
        spectrum: &Spectrum,
        count: usize,
    ) -> Self {
        let (mut eigenvalues, mut errors) = (spectrum.eigenvalues(), spectrum.residuals());
        eigenvalues.truncate(count);
        errors.truncate(count);
        // A store may know of more bands than were needed: those above the last eigenvalue are no part of the proof.
        let last = eigenvalues.last().copied().unwrap_or(0.0);
        let bands = spectrum.bands.iter().filter(|band| band.lower <= last);
        let counts = bands.map(|band| Count { part: band.part, shift: band.upper, below: band.above }).collect();
        let window = Window {
            values: eigenvalues,
            errors,
            below: 0,
            certificate: counts,
            order: spectrum.order,
            measure: spectrum.measure,
            notes: spectrum.notes.clone(),
            timings: spectrum.timings.clone(),
        };
        Self::near(file, geometry, survey, choice, window)
    }

    /// Some eigenvalues, which follow each other, of the mesh in `file`.
    #[must_use]
    pub fn near(file: String, geometry: GeometryHash, survey: &Survey, choice: Choice, window: Window) -> Self {
        let certificate = window.certificate.iter().map(|count| InertiaCount {
            part: count.part,
            shift: (count.shift < f64::MAX).then_some(count.shift),
            below: count.below,
        });
        Self {
            file,
            geometry: geometry.to_string(),
            vertices: survey.vertices,
            triangles: survey.triangles,
            area: survey.area,
            components: survey.components,
            boundary_edges: survey.boundary_edges,
            euler: survey.euler,
            genus: survey.genus,
            defects: survey.defects.iter().map(ToString::to_string).collect(),
            operator: choice.operator,
            mass: (choice.operator == Operator::Fem).then_some(choice.mass),
            boundary: choice.boundary,
            triangulation: choice.triangulation,
            measure: window.measure,
            order: window.order,
            certificate: certificate.collect(),
            notes: window.notes,
            below: window.below,
            eigenvalues: window.values,
            errors: window.errors,
        }
    }

    /// The greatest bound on a relative error.
    fn relative_error(&self) -> f64 {
        let positive = self.eigenvalues.iter().zip(&self.errors).filter(|(value, _)| **value > 0.0);
        positive.map(|(value, error)| error / value).fold(0.0, f64::max)
    }

    /// `fem, consistent mass`, and what else is not the default.
    fn problem(&self) -> String {
        let operator = match (self.operator, self.mass) {
            (Operator::Fem, Some(Mass::Lumped)) => "fem, lumped mass",
            (Operator::Fem, Some(Mass::Blended)) => "fem, blended mass",
            (Operator::Fem, _) => "fem, consistent mass",
            (Operator::Cot, _) => "cot",
        };
        let boundary = match self.boundary {
            Boundary::Neumann => "",
            Boundary::Dirichlet => ", Dirichlet",
        };
        let triangulation = match self.triangulation {
            Triangulation::Auto => "",
            Triangulation::Given => ", given triangles",
            Triangulation::Delaunay => ", intrinsic Delaunay",
            Triangulation::Tufted => ", tufted cover",
        };
        format!("{operator}{boundary}{triangulation}")
    }
}

/// The spectra of several meshes, and the meshes that have none.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spectra {
    /// Name and version of the schema.
    pub schema: Identity<u32>,
    /// Name and version of the program.
    pub program: Identity<&'static str>,
    /// In the order of the command line.
    pub spectra: Vec<MeshSpectrum>,
    /// Those that failed.
    pub failed: Vec<Failed>,
    /// What differs from run to run.
    pub run: SpectraRun,
}

/// A mesh without a spectrum.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Failed {
    /// The file as the user wrote it.
    pub file: String,
    /// Why.
    pub reason: String,
}

/// What differs from run to run.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct SpectraRun {
    /// Where the spectra came from.
    pub spectra: StoreCounts,
    /// How long each solve took, in the order of `spectra`; 0 when none ran.
    pub seconds: Vec<f64>,
    /// How many Lanczos processes each solve ran: fewer where an earlier one had left bands, 0 when none ran.
    pub processes: Vec<usize>,
}

impl Spectra {
    /// Begins with no mesh.
    #[must_use]
    pub fn new() -> Self {
        Self {
            schema: Identity { name: SCHEMA, version: VERSION },
            program: Identity { name: env!("CARGO_PKG_NAME"), version: env!("CARGO_PKG_VERSION") },
            spectra: Vec::new(),
            failed: Vec::new(),
            run: SpectraRun::default(),
        }
    }

    /// Adds a spectrum that came from `source` within `seconds`, by so many Lanczos processes.
    pub fn push(&mut self, spectrum: MeshSpectrum, source: Source, seconds: f64, processes: usize) {
        self.run.spectra.add(source);
        self.run.seconds.push(seconds);
        self.run.processes.push(processes);
        self.spectra.push(spectrum);
    }

    /// Writes everything as JSON.
    ///
    /// # Errors
    /// Only those of `out`.
    pub fn write_json(&self, out: &mut dyn io::Write) -> io::Result<()> {
        json::lines(self, out)
    }

    /// Writes `mesh,k,eigenvalue,error`.
    ///
    /// # Errors
    /// Only those of `out`.
    pub fn write_csv(&self, out: &mut dyn io::Write) -> io::Result<()> {
        let mut writer = ::csv::Writer::from_writer(out);
        writer.write_record(["mesh", "k", "eigenvalue", "error"])?;
        for spectrum in &self.spectra {
            for (k, (value, error)) in (spectrum.below + 1..).zip(spectrum.eigenvalues.iter().zip(&spectrum.errors)) {
                writer.write_record([&spectrum.file, &k.to_string(), &format!("{value:?}"), &format!("{error:?}")])?;
            }
        }
        writer.flush()
    }

    /// Everything as aligned text.
    #[must_use]
    pub fn text(&self) -> String {
        let blocks = self.spectra.iter().zip(&self.run.seconds).map(|(spectrum, &seconds)| text(spectrum, seconds));
        blocks.collect::<Vec<_>>().join("\n")
    }
}

impl Default for Spectra {
    fn default() -> Self {
        Self::new()
    }
}

fn text(spectrum: &MeshSpectrum, seconds: f64) -> String {
    let mut text = format!("{}\n", plain(&spectrum.file));
    let boundary = match spectrum.boundary_edges {
        0 => "closed".to_owned(),
        edges => count(edges, "boundary edge", "boundary edges"),
    };
    let genus = spectrum.genus.map_or_else(String::new, |genus| format!(", genus {genus}"));
    if spectrum.triangles == 0 {
        let _ = writeln!(text, "  points    {} without faces", spectrum.vertices);
    } else {
        let _ = writeln!(
            text,
            "  mesh      {} vertices, {}, {}, {boundary}{genus}, area {}",
            spectrum.vertices,
            count(spectrum.triangles, "triangle", "triangles"),
            count(spectrum.components, "component", "components"),
            significant(spectrum.area)
        );
    }
    let found = match (spectrum.eigenvalues.len(), spectrum.below) {
        (found, _) if found == spectrum.order => format!("all {found} eigenvalues"),
        (found, 0) => format!("{found} of {} eigenvalues", spectrum.order),
        (found, below) => format!("{found} of {} eigenvalues, with {below} below them", spectrum.order),
    };
    let took = if seconds > 0.0 { format!(" in {} s", number(seconds, 2)) } else { ", from the cache".to_owned() };
    let _ = writeln!(text, "  spectrum  {}: {found}{took}", spectrum.problem());
    let _ = writeln!(
        text,
        "  proof     none missing ({}); relative errors below {}",
        count(spectrum.certificate.len(), "inertia count", "inertia counts"),
        format_args!("{:.1e}", spectrum.relative_error())
    );
    for note in spectrum.defects.iter().chain(&spectrum.notes) {
        let _ = writeln!(text, "  note      {}", plain(note));
    }
    let scaled = match spectrum.operator {
        Operator::Fem => "λ · area",
        Operator::Cot => "λ · vertices",
    };
    let _ = writeln!(text, "\n  {:>5}  {:>22}  {scaled:>16}", "k", "λ");
    for (k, value) in (spectrum.below + 1..).zip(&spectrum.eigenvalues) {
        let _ = writeln!(text, "  {k:>5}  {value:>22?}  {:>16.8}", value * spectrum.measure);
    }
    text
}

/// Six significant digits.
fn significant(value: f64) -> String {
    let exponent = if value == 0.0 { 0 } else { value.abs().log10().floor() as i32 };
    match exponent {
        -4..=5 => format!("{value:.*}", (5 - exponent) as usize),
        _ => format!("{value:.5e}"),
    }
}

/// The spectrum as a ShapeDNA eigenvalue file.
#[must_use]
pub fn ev(spectrum: &MeshSpectrum) -> String {
    let program = concat!(env!("CARGO_PKG_NAME"), " ", env!("CARGO_PKG_VERSION"));
    let mut text = String::new();
    let _ = writeln!(text, " Creator : {program} ({})", spectrum.problem());
    let _ = writeln!(text, " File : {}", plain(&spectrum.file));
    // Linear elements on the mesh as it is, a surface.
    text.push_str(" Refine: 0\n Degree: 1\n Dimension: 2\n");
    let _ = writeln!(text, " Elements: {}", spectrum.triangles);
    let _ = writeln!(text, " DoF: {}", spectrum.order);
    let _ = writeln!(text, " NumEW: {}", spectrum.eigenvalues.len());
    let _ = writeln!(text, "\n Area: {:?}", spectrum.area);
    let _ = writeln!(text, " EulerChar: {}", spectrum.euler);
    let values: Vec<String> = spectrum.eigenvalues.iter().map(|value| format!("{value:?}")).collect();
    let _ = writeln!(text, "\nEigenvalues:\n{{ {} }}", values.join(" ; "));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn example() -> MeshSpectrum {
        MeshSpectrum {
            file: "shapes/ring.off".to_owned(),
            geometry: "00ff".to_owned(),
            vertices: 500,
            triangles: 1000,
            area: 12.5,
            components: 1,
            boundary_edges: 0,
            euler: 0,
            genus: Some(1),
            defects: vec!["1 unused vertex (vertex 7)".to_owned()],
            operator: Operator::Fem,
            mass: Some(Mass::Consistent),
            boundary: Boundary::Neumann,
            triangulation: Triangulation::Auto,
            measure: 12.5,
            order: 499,
            notes: vec![],
            below: 0,
            eigenvalues: vec![0.0, 1e-7 / 3.0, 0.1 + 0.2, 123_456.789],
            errors: vec![0.0, 1e-19, 1.5e-15, 2e-10],
            certificate: vec![InertiaCount { part: 1, shift: Some(2.5), below: 3 }],
        }
    }

    fn spectra() -> Spectra {
        let mut spectra = Spectra::new();
        spectra.program.version = "1.2.3";
        spectra.push(example(), Source::Ran, 0.25, 2);
        let cot = MeshSpectrum { operator: Operator::Cot, mass: None, boundary_edges: 3, genus: None, ..example() };
        spectra.push(MeshSpectrum { file: "b.obj".to_owned(), measure: 500.0, ..cot }, Source::Disk, 0.0, 0);
        let near = MeshSpectrum { file: "c.off".to_owned(), below: 12, ..example() };
        spectra.push(near, Source::Ran, 0.5, 1);
        spectra.failed.push(Failed { file: "x.off".to_owned(), reason: "there are no faces".to_owned() });
        spectra
    }

    #[test]
    fn text_and_json_stay() {
        let mut json = Vec::new();
        spectra().write_json(&mut json).unwrap();
        let (text, summary) = (spectra().text(), spectra().summary());
        insta::assert_snapshot!(format!("{text}\n{summary}\n{}", String::from_utf8(json).unwrap()));
    }

    /// Reads as `lapy.io.read_ev` does: keys before a colon, values between braces, split at semicolons.
    #[test]
    fn ev_reads_back_as_the_same_doubles() {
        let text = ev(&example());
        let value = |key: &str| {
            let line = text.lines().find_map(|line| line.trim_start().strip_prefix(key)).unwrap();
            line.strip_prefix(':').unwrap().trim().to_owned()
        };
        // LaPy 1.7 would read a word after these as an integer, and fail.
        assert!(!["Creator:", "File:", "User:"].iter().any(|key| text.contains(key)), "{text}");
        assert!(text.contains(" File : shapes/ring.off\n"), "{text}");
        let integers = ["Refine", "Degree", "Dimension", "Elements", "DoF", "NumEW", "EulerChar"];
        assert_eq!(integers.map(|key| value(key).parse::<i64>().unwrap()), [0, 1, 2, 1000, 499, 4, 0]);
        assert_eq!(value("Area").parse::<f64>().unwrap(), 12.5);
        let mut lines = text.lines().skip_while(|line| !line.starts_with("Eigenvalues"));
        let list = lines.nth(1).unwrap().trim().strip_prefix('{').unwrap().strip_suffix('}').unwrap();
        let read: Vec<f64> = list.split(';').map(|value| value.trim().parse().unwrap()).collect();
        assert_eq!(read, example().eigenvalues);
    }

    #[test]
    fn csv_reads_back_as_the_same_doubles() {
        let mut bytes = Vec::new();
        spectra().write_csv(&mut bytes).unwrap();
        let mut reader = ::csv::Reader::from_reader(&bytes[..]);
        let rows: Vec<_> = reader.records().map(|record| record.unwrap()).collect();
        assert_eq!(rows.len(), 12);
        let read: Vec<f64> = rows.iter().take(4).map(|row| row[2].parse().unwrap()).collect();
        assert_eq!(read, example().eigenvalues);
        assert_eq!((&rows[4][0], &rows[4][1]), ("b.obj", "1"));
        assert_eq!((&rows[8][0], &rows[8][1]), ("c.off", "13"));
    }

    #[test]
    fn six_digits_whatever_the_size() {
        let shown = [0.0, 12.5, 123_456.7, 0.001_234_567_8, 1e-9, 3.2e12].map(significant);
        assert_eq!(shown, ["0.00000", "12.5000", "123457", "0.00123457", "1.00000e-9", "3.20000e12"]);
    }
}

//! Figure 1: how much the spectrum of one shape varies, over variants made of it and over its class.

use std::{path::Path, sync::Mutex};

use serde::Serialize;

use super::Section;
use crate::{
    dataset::Role,
    figure::{Axis, Dash, Figure, Layer, Mark, Panel, Style},
    laplacian::Operator,
    mesh::{self, Format, Mesh, deform},
    query::{Answer, ModelRow},
    remesh::remesh,
    spectrum::{Choice, Normalisation, solve},
    study::{Cell, Table},
    watch::{Silent, Watch},
};

/// Eigenvalues of each variant, as in the paper.
pub const EIGENVALUES: usize = 100;

/// The spectra of one shape's variants and of its class.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Variation {
    /// The model that the variants are made of.
    pub model: String,
    /// Its class.
    pub class: String,
    /// Itself, then its variants.
    pub variants: Vec<Spectra>,
    /// The training models of its class.
    pub members: Vec<Spectra>,
}

/// The first eigenvalues of one shape under both operators.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Spectra {
    /// What it is.
    pub name: String,
    /// Vertices.
    pub vertices: usize,
    /// `λ/λ_max` of FEM (the area drops out), or none where they cannot be had.
    pub fem: Option<Vec<f64>>,
    /// λ of cot.
    pub cot: Option<Vec<f64>>,
    /// Why there is none.
    pub why: Option<String>,
}

/// A variant that is yet to be solved.
type Made = (&'static str, Result<Mesh, String>);

/// The variants of a mesh, itself first.
fn variants(mesh: &Mesh, vertices: usize, watch: &dyn Watch) -> Vec<Made> {
    let remeshed = |count: usize| remesh(mesh, count, watch).map_err(|error| error.to_string());
    let quarter = mesh.vertices().len() / 4;
    vec![
        ("original", Ok(mesh.clone())),
        ("rotated", Ok(deform::rotate(mesh, [1.0, 2.0, 3.0], 1.0))),
        ("scaled by 2", Ok(deform::scale(mesh, 2.0))),
        ("bent by 60°", Ok(deform::bend(mesh, std::f64::consts::FRAC_PI_3))),
        ("smoothed", Ok(deform::smooth(mesh, 10))),
        ("noise, 10 % of an edge", Ok(deform::noise(mesh, 0.1, 1))),
        ("refined, each face in four", Ok(deform::refine(mesh))),
        ("simplified to a quarter", remeshed(quarter)),
        ("re-meshed", remeshed(vertices)),
    ]
}

/// Makes and solves the variants of the mesh in the file at `path`, one of them re-meshed to `vertices`, on `threads`
/// threads. A variant that cannot be had is there with the reason.
///
/// # Errors
/// When the file cannot be read as a mesh.
pub fn of_file(
    path: &Path,
    base: Choice,
    vertices: usize,
    threads: usize,
    watch: &dyn Watch,
) -> Result<Vec<Spectra>, String> {
    let watch = &Silent(watch);
    let format = Format::of(path).ok_or_else(|| "not a mesh by its name".to_owned())?;
    let bytes = std::fs::read(path).map_err(|error| format!("cannot be read: {error}"))?;
    let mesh = mesh::read(&bytes, format).map_err(|error| error.to_string())?.canonical();
    let made = variants(&mesh, vertices, watch);
    let jobs: Vec<(usize, Operator)> =
        (0..made.len()).flat_map(|at| [Operator::Fem, Operator::Cot].map(|operator| (at, operator))).collect();
    let spectra = made.iter().map(|(name, mesh)| Spectra {
        name: (*name).to_owned(),
        vertices: mesh.as_ref().map_or(0, |mesh| mesh.vertices().len()),
        fem: None,
        cot: None,
        why: mesh.as_ref().err().cloned(),
    });
    let (jobs, spectra) = (Mutex::new(jobs.into_iter()), Mutex::new(spectra.collect::<Vec<_>>()));
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((at, operator)) = jobs.lock().ok().and_then(|mut jobs| jobs.next()) {
                    let Ok(mesh) = &made[at].1 else { continue };
                    let choice = Choice::new(operator, base.mass)
                        .with_boundary(base.boundary)
                        .with_triangulation(base.triangulation);
                    let found = solve(&mesh.canonical(), choice, EIGENVALUES, &[], watch);
                    let Ok(mut spectra) = spectra.lock() else { return };
                    let row = &mut spectra[at];
                    match found {
                        Ok(found) => row.put(operator, &found.eigenvalues()),
                        Err(error) => row.why = Some(error.to_string()),
                    }
                }
            });
        }
    });
    spectra.into_inner().map_err(|_| "internal error, please report it".to_owned())
}

impl Spectra {
    /// Those of a model of the data set under one operator; the eigenvalues may be more than are shown.
    #[must_use]
    pub fn of_model(name: &str, vertices: usize, operator: Operator, eigenvalues: &[f64]) -> Self {
        let mut spectra = Self { name: name.to_owned(), vertices, fem: None, cot: None, why: None };
        spectra.put(operator, eigenvalues);
        spectra
    }

    /// Takes in the eigenvalues of one operator; they may be more than are shown.
    pub(super) fn put(&mut self, operator: Operator, eigenvalues: &[f64]) {
        let count = EIGENVALUES.min(eigenvalues.len());
        match operator {
            Operator::Fem => self.fem = Some(Normalisation::Max.apply(eigenvalues, 1.0, count)),
            Operator::Cot => self.cot = Some(eigenvalues[..count].to_vec()),
        }
    }

    /// What is shown of one operator.
    #[must_use]
    pub fn of(&self, operator: Operator) -> Option<&[f64]> {
        match operator {
            Operator::Fem => self.fem.as_deref(),
            Operator::Cot => self.cot.as_deref(),
        }
    }
}

/// Marks and dashes that tell the variants apart.
const LOOKS: [(Dash, Option<Mark>); 9] = [
    (Dash::Solid, None),
    (Dash::Dashed, Some(Mark::Cross)),
    (Dash::Dotted, Some(Mark::Plus)),
    (Dash::Solid, Some(Mark::Circle)),
    (Dash::Dashed, None),
    (Dash::DashDot, None),
    (Dash::Solid, Some(Mark::Square)),
    (Dash::Solid, Some(Mark::Triangle)),
    (Dash::Dashed, Some(Mark::Diamond)),
];

impl Variation {
    /// Takes in the spectra of the class whose turn it is.
    pub(super) fn learn(&mut self, operator: Operator, answer: &Answer) {
        let class = answer.settings.class as u32;
        self.class = answer.classes.get(answer.settings.class).cloned().unwrap_or_default();
        let members = answer.members.iter().map(|&at| &answer.models[at]);
        for model in members.filter(|model| model.class == class && model.role == Role::Train) {
            let Some(eigenvalues) = &model.eigenvalues else { continue };
            if self.members.iter().all(|member| member.name != model.name) {
                let vertices = model.size.map_or(0, |(vertices, _)| vertices);
                self.members.push(Spectra { name: model.name.clone(), vertices, fem: None, cot: None, why: None });
            }
            if let Some(member) = self.members.iter_mut().find(|member| member.name == model.name) {
                member.put(operator, eigenvalues);
            }
        }
        self.model = self.members.first().map(|member| member.name.clone()).unwrap_or_default();
    }

    /// The row of the model that the variants are made of.
    pub(super) fn model_of<'a>(&self, answer: &'a Answer) -> Option<&'a ModelRow> {
        answer.models.iter().find(|model| model.name == self.model)
    }

    /// The figure: variants and class under both operators, as far as they are there.
    #[must_use]
    pub fn figure(&self) -> Figure {
        let panel = |title: &str, operator: Operator, of: &[Spectra], named: bool| Panel {
            title: title.to_owned(),
            x: Axis::linear("k").within(0.0, EIGENVALUES as f64),
            y: Axis::linear(if operator == Operator::Fem { "λ/max" } else { "λ" }),
            layers: of
                .iter()
                .enumerate()
                .filter_map(|(at, spectra)| Some((at, spectra, spectra.of(operator)?)))
                .map(|(at, spectra, values)| {
                    let (dash, mark) = if named { LOOKS[at % LOOKS.len()] } else { (Dash::Solid, None) };
                    Layer::Line {
                        name: if named { spectra.name.clone() } else { String::new() },
                        style: Style { hue: at, dash, mark },
                        points: values.iter().enumerate().map(|(at, &value)| [(at + 1) as f64, value]).collect(),
                    }
                })
                .collect(),
        };
        let (model, class) = (&self.model, &self.class);
        let mut panels = vec![
            panel(&format!("(a) variants of {model}, FEM"), Operator::Fem, &self.variants, true),
            panel(&format!("(b) variants of {model}, cot"), Operator::Cot, &self.variants, true),
            panel(&format!("(c) the training models of {class}, FEM"), Operator::Fem, &self.members, false),
            panel(&format!("(d) the training models of {class}, cot"), Operator::Cot, &self.members, false),
        ];
        panels.retain(|panel| !panel.layers.is_empty());
        Figure { title: String::new(), panels, across: 2 }
    }

    pub(super) fn section(&self) -> Section {
        let model = &self.model;
        let words = vec![format!(
            "The first {EIGENVALUES} eigenvalues of {model}, of variants made of it, and of its class: FEM divided by the \
             greatest, cot as they are. The table has the mean over k of |λ − λ'|/λ' against the original λ', with the \
             zeros left out."
        )];
        Section {
            heading: format!("Figure 1: Variation of the first {EIGENVALUES} eigenvalues"),
            words,
            table: Some(("figure-1-variation".to_owned(), self.table())),
            figure: Some(("figure-1".to_owned(), self.figure())),
        }
    }

    /// For each variant the mean over k of |λ − λ'|/λ' against the original λ', the zeros left out: of FEM and of cot.
    #[must_use]
    pub fn differences(&self) -> Vec<[Option<f64>; 2]> {
        let difference = |spectra: &Spectra, operator| {
            let (ours, theirs) = (spectra.of(operator)?, self.variants.first()?.of(operator)?);
            // Zeros are such to rounding.
            let least = 1e-9 * theirs.last().copied().unwrap_or(0.0);
            let terms: Vec<f64> =
                ours.iter().zip(theirs).filter(|(_, b)| **b > least).map(|(a, b)| (a - b).abs() / b).collect();
            (!terms.is_empty()).then(|| terms.iter().sum::<f64>() / terms.len() as f64)
        };
        let both = |spectra: &Spectra| [Operator::Fem, Operator::Cot].map(|operator| difference(spectra, operator));
        self.variants.iter().map(both).collect()
    }

    fn table(&self) -> Table {
        let cell = |value: Option<f64>| value.map_or(Cell::Missing, |value| Cell::Number { value, decimals: 5 });
        let row = |(spectra, [fem, cot]): (&Spectra, [Option<f64>; 2])| {
            vec![
                Cell::Text(spectra.name.clone()),
                Cell::Count(spectra.vertices as u64),
                cell(fem),
                cell(cot),
                Cell::Text(spectra.why.clone().unwrap_or_default()),
            ]
        };
        let columns = ["variant", "vertices", "FEM", "cot", "why there is none"].map(String::from).to_vec();
        let title = format!("Mean relative difference of the first {EIGENVALUES} eigenvalues");
        Table { number: 0, title, columns, rows: self.variants.iter().zip(self.differences()).map(row).collect() }
    }
}

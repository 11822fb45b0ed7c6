//! Figure 1: how much the spectrum of one shape varies, over variants made of it and over its class.

use std::{
    path::Path,
    sync::{Mutex, OnceLock},
};

use serde::Serialize;

use super::Section;
use crate::{
    dataset::Role,
    figure::{Axis, Dash, Figure, Layer, Mark, Panel, Style},
    laplacian::Operator,
    mesh::{self, Format, Mesh, deform},
    query::{Answer, ModelRow, Problem, Singles},
    report::{figures, markdown},
    spectrum::{Choice, Normalisation},
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
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
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

/// A variant: its name, how it is made of the mesh, and to how many vertices it is re-meshed then.
type Made = (&'static str, fn(&Mesh) -> Mesh, Option<usize>);

/// The variants of a mesh, itself first. A quarter of its vertices may be too few to re-mesh it to.
fn variants(mesh: &Mesh, vertices: usize) -> [Made; 9] {
    [
        ("original", Mesh::clone, None),
        ("rotated", |mesh| deform::rotate(mesh, [1.0, 2.0, 3.0], 1.0), None),
        ("scaled by 2", |mesh| deform::scale(mesh, 2.0), None),
        ("bent by 60°", |mesh| deform::bend(mesh, std::f64::consts::FRAC_PI_3), None),
        ("smoothed", |mesh| deform::smooth(mesh, 10), None),
        ("noise, 10 % of an edge", |mesh| deform::noise(mesh, 0.1, 1), None),
        ("refined, each face in four", deform::refine, None),
        ("simplified to a quarter", Mesh::clone, Some(mesh.vertices().len() / 4)),
        ("re-meshed", Mesh::clone, Some(vertices)),
    ]
}

/// Makes the variants of the mesh in the file at `path`, one of them re-meshed to `vertices`, and solves them on
/// `threads` threads where `singles` does not know their spectra. A variant that cannot be had is there with the
/// reason.
///
/// # Errors
/// When the file cannot be read as a mesh.
pub fn of_file(
    singles: &Singles,
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
    let variants = variants(&mesh, vertices);
    let spectra = variants.map(|(name, ..)| Spectra { name: name.to_owned(), ..Spectra::default() });
    let made: [OnceLock<Mesh>; 9] = Default::default();
    let jobs = (0..made.len()).flat_map(|at| [Operator::Fem, Operator::Cot].map(|operator| (at, operator)));
    let (jobs, spectra) = (Mutex::new(jobs), Mutex::new(spectra.to_vec()));
    let next = || jobs.lock().ok().and_then(|mut jobs| jobs.next());
    let work = || {
        while let Some((at, operator)) = next() {
            let (_, make, remesh) = variants[at];
            let made = made[at].get_or_init(|| make(&mesh));
            let choice =
                Choice::new(operator, base.mass).with_boundary(base.boundary).with_triangulation(base.triangulation);
            let found = singles.of_mesh(made, Problem { remesh, choice }, EIGENVALUES, watch);
            let Ok(mut spectra) = spectra.lock() else { return };
            let row = &mut spectra[at];
            match (found, remesh) {
                (Ok(found), _) => {
                    row.vertices = remesh.unwrap_or(made.vertices().len());
                    row.put(operator, &found.eigenvalues());
                }
                (Err(error), None) => {
                    row.vertices = made.vertices().len();
                    row.why = Some(error.to_string());
                }
                (Err(error), Some(_)) => row.why = Some(error.to_string()),
            }
        }
    };
    // The calling thread is one of them.
    std::thread::scope(|scope| {
        for _ in 1..threads {
            let _ = std::thread::Builder::new().name("variant".into()).spawn_scoped(scope, work);
        }
        work();
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
            Operator::Fem => self.fem = Some(normalisation(operator).apply(eigenvalues, 1.0, count)),
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

/// How the eigenvalues of an operator are shown.
const fn normalisation(operator: Operator) -> Normalisation {
    match operator {
        Operator::Fem => Normalisation::Max,
        Operator::Cot => Normalisation::None,
    }
}

/// What is above it is not a zero that was rounded.
fn least(eigenvalues: &[f64]) -> f64 {
    1e-9 * eigenvalues.last().copied().unwrap_or(0.0)
}

/// Colours, dashes and marks that tell the variants apart.
const LOOKS: [Style; 9] = [
    Style { hue: 0, dash: Dash::Solid, mark: None },
    Style { hue: 1, dash: Dash::Dashed, mark: Some(Mark::Cross) },
    Style { hue: 2, dash: Dash::Dotted, mark: Some(Mark::Plus) },
    Style { hue: 3, dash: Dash::Solid, mark: Some(Mark::Circle) },
    Style { hue: 4, dash: Dash::Dashed, mark: None },
    Style { hue: 5, dash: Dash::DashDot, mark: None },
    Style { hue: 6, dash: Dash::Solid, mark: Some(Mark::Square) },
    Style { hue: 7, dash: Dash::Solid, mark: Some(Mark::Triangle) },
    Style { hue: 8, dash: Dash::Dashed, mark: Some(Mark::Diamond) },
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

    /// The figure: variants, how far they are from the original, and the class, under both operators, as far as they
    /// are there.
    #[must_use]
    pub fn figure(&self) -> Figure {
        let curve = |values: &[f64]| (1_u32..).zip(values).map(|(k, &value)| [f64::from(k), value]).collect();
        let variants = |operator: Operator, of: &dyn Fn(&[f64]) -> Vec<[f64; 2]>| -> Vec<Layer> {
            let known = |(at, spectra): (usize, &Spectra)| {
                let points = of(spectra.of(operator)?);
                Some(Layer::Line { name: spectra.name.clone(), style: LOOKS[at % LOOKS.len()], points })
            };
            self.variants.iter().enumerate().filter_map(known).collect()
        };
        let change = |operator: Operator| {
            let original = self.variants.first().and_then(|first| first.of(operator)).unwrap_or_default();
            let least = least(original);
            variants(operator, &|values| {
                let known = (1_u32..).zip(values.iter().zip(original)).filter(|(_, (_, original))| **original > least);
                known.map(|(k, (value, original))| [f64::from(k), 100.0 * (value / original - 1.0)]).collect()
            })
        };
        // The others first, so that the model shown lies over them.
        let members = |operator: Operator| -> Vec<Layer> {
            let known = |spectra: &Spectra| {
                let (hue, name) = if spectra.name == self.model { (0, "original") } else { (6, "its class") };
                let points = curve(spectra.of(operator)?);
                Some((hue, Layer::Line { name: name.to_owned(), style: Style::line(hue, Dash::Solid), points }))
            };
            let mut known: Vec<_> = self.members.iter().filter_map(known).collect();
            known.sort_by_key(|(hue, _)| std::cmp::Reverse(*hue));
            known.into_iter().map(|(_, layer)| layer).collect()
        };
        let panel = |title: String, operator: Operator, layers: Vec<Layer>| Panel {
            title,
            x: Axis::linear("index k").within(0.0, EIGENVALUES as f64),
            y: Axis::linear(figures::unit(normalisation(operator))),
            layers,
        };
        let changed = |title: &str, operator: Operator| Panel {
            y: Axis::linear("change of λ, %"),
            ..panel(title.to_owned(), operator, change(operator))
        };
        let (model, class) = (&self.model, &self.class);
        let (fem, cot) = (Operator::Fem, Operator::Cot);
        let mut panels = vec![
            panel(format!("(a) variants of {model}, FEM"), fem, variants(fem, &curve)),
            panel(format!("(b) variants of {model}, cot"), cot, variants(cot, &curve)),
            changed("(c) against the original, FEM", fem),
            changed("(d) against the original, cot", cot),
            panel(format!("(e) {model} and its class, {class}, FEM"), fem, members(fem)),
            panel(format!("(f) {model} and its class, {class}, cot"), cot, members(cot)),
        ];
        panels.retain(|panel| !panel.layers.is_empty());
        Figure { title: String::new(), panels, across: 2 }
    }

    pub(super) fn section(&self) -> Section {
        let (model, class) = (markdown::escape(&self.model), markdown::escape(&self.class));
        let mut words = vec![format!(
            "(a, b) The first {EIGENVALUES} eigenvalues of {model} and of variants made of it: FEM divided by the last of \
             them, cot as they are. (c, d) The same as a change against the original. (e, f) {model} among the training \
             models of its class, {class}. The table has the mean over k of |λ − λ'|/λ' against the original λ', with the \
             zeros left out."
        )];
        words.extend(self.seen());
        Section {
            heading: format!("Figure 1: Variation of the first {EIGENVALUES} eigenvalues"),
            words,
            table: Some(("figure-1-variation".to_owned(), self.table())),
            figure: Some(("figure-1".to_owned(), self.figure())),
        }
    }

    /// What the figure shows, in words.
    fn seen(&self) -> Option<String> {
        let differences = self.differences();
        let named = || self.variants.iter().zip(&differences).skip(1);
        let most = |operator: usize, wanted: &dyn Fn(&Spectra) -> bool| {
            let known = named().filter(|(spectra, _)| wanted(spectra));
            let known = known.filter_map(|(spectra, of)| Some((spectra.name.as_str(), of[operator]?)));
            known.max_by(|(_, a), (_, b)| a.total_cmp(b))
        };
        let ((fem, fem_by), (cot, cot_by)) = (most(0, &|_| true)?, most(1, &|_| true)?);
        let vertices = self.variants.first()?.vertices;
        let (alike, alike_by) = most(1, &|spectra| spectra.vertices == vertices)?;
        Some(format!(
            "No variant moves the FEM eigenvalues by more than {:.1} % in the mean ({fem}). Cot eigenvalues have no mass \
             matrix, so they fall as vertices are added and rise as they are taken away: by {:.0} % in the mean where \
             that is most ({cot}), and by {:.1} % at most where the vertices stay ({alike}).",
            100.0 * fem_by,
            100.0 * cot_by,
            100.0 * alike_by
        ))
    }

    /// For each variant the mean over k of |λ − λ'|/λ' against the original λ', the zeros left out: of FEM and of cot.
    #[must_use]
    pub fn differences(&self) -> Vec<[Option<f64>; 2]> {
        let difference = |spectra: &Spectra, operator| {
            let (ours, theirs) = (spectra.of(operator)?, self.variants.first()?.of(operator)?);
            let least = least(theirs);
            let terms: Vec<f64> =
                ours.iter().zip(theirs).filter(|(_, b)| **b > least).map(|(a, b)| (a - b).abs() / b).collect();
            (!terms.is_empty()).then(|| terms.iter().sum::<f64>() / terms.len() as f64)
        };
        let both = |spectra: &Spectra| [Operator::Fem, Operator::Cot].map(|operator| difference(spectra, operator));
        self.variants.iter().map(both).collect()
    }

    fn table(&self) -> Table {
        let cell = |value: Option<f64>| value.map_or(Cell::Missing, |value| Cell::Number { value, decimals: 5 });
        // Reasons only where there are any.
        let reasons = self.variants.iter().any(|spectra| spectra.why.is_some());
        let row = |(spectra, [fem, cot]): (&Spectra, [Option<f64>; 2])| {
            let mut cells =
                vec![Cell::Text(spectra.name.clone()), Cell::Count(spectra.vertices as u64), cell(fem), cell(cot)];
            if reasons {
                cells.push(Cell::Text(spectra.why.clone().unwrap_or_default()));
            }
            cells
        };
        let mut columns = ["variant", "vertices", "mean relative change, FEM", "mean relative change, cot"].to_vec();
        if reasons {
            columns.push("why there is none");
        }
        Table {
            number: 0,
            title: format!("Mean relative difference of the first {EIGENVALUES} eigenvalues"),
            columns: columns.into_iter().map(String::from).collect(),
            rows: self.variants.iter().zip(self.differences()).map(row).collect(),
        }
    }
}

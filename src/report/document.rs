//! What a report says, in one value.

use serde::{Serialize, Serializer, ser::SerializeMap};

use crate::{
    dataset::Role,
    query::{Parameter, Settings, Source, StageRow},
    selection::{Round, Step},
    study::{Curve, Mark, Score, Table},
};

mod make;

/// Where an answer came from, and what its run was like: what the answer itself does not know.
#[derive(Debug, Clone, Default)]
pub struct Origin<'a> {
    /// The data set's folder as the user wrote it.
    pub root: &'a str,
    /// What is to be known of the data set: files passed over, classes without models. Warnings of the answer belong to
    /// the run.
    pub passed_over: &'a [String],
    /// Wall-clock time of the run, seconds.
    pub seconds: f64,
    /// Threads the run was given.
    pub threads: usize,
    /// The store's folder, if there is one.
    pub cache: Option<&'a str>,
    /// Whether the document carries every model's eigenvalues.
    pub spectra: bool,
}

/// A report: every field but [`Document::run`] follows from the files, the parameters and the program's version.
///
/// Serialised, it is the JSON report; see [`super::json`] for its schema.
#[derive(Debug, Clone, Serialize)]
pub struct Document {
    /// Name and version of the schema.
    pub schema: Identity<u32>,
    /// Name and version of the program.
    pub program: Identity<&'static str>,
    /// The data set.
    pub data: Data,
    /// The parameters by their names.
    pub parameters: Parameters,
    /// True when every model is accounted for and every part below is there and belongs to these parameters.
    pub complete: bool,
    /// The classes in the data set's order.
    pub classes: Vec<ClassRow>,
    /// Every model in the data set's order.
    pub models: Vec<ModelRecord>,
    /// Those that take no part.
    pub skipped: Vec<Skipped>,
    /// What was passed over when the folder was read.
    pub warnings: Vec<String>,
    /// Tables 1 to 4.
    #[serde(serialize_with = "super::json::tables")]
    pub tables: Vec<Table>,
    /// ε and mean ADR of the first k eigenvalues.
    pub curves: Option<Curves>,
    /// Which eigenvalues each method selected.
    pub selections: Selections,
    /// Eigenvalues of every model that takes part, when they were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spectra: Option<Vec<SpectrumRow>>,
    /// What differs from run to run.
    pub run: Run,
}

/// A name with a version.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Identity<V> {
    /// The name.
    pub name: &'static str,
    /// The version.
    pub version: V,
}

/// The data set and its counts.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Data {
    /// The folder as the user wrote it.
    pub root: String,
    /// How it was understood.
    pub layout: String,
    /// Classes.
    pub classes: usize,
    /// Models in the data set.
    pub models: usize,
    /// Training models (D) that take part.
    pub train: usize,
    /// Query models (Q) that take part.
    pub query: usize,
    /// Models that take no part.
    pub skipped: usize,
}

/// The parameters; serialised as a map from [`Parameter::name`] to what `--set` takes, numbers as numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Parameters(pub Settings);

impl Parameters {
    /// Name and value of every parameter in the order in which they are shown.
    pub fn pairs(&self) -> impl Iterator<Item = (Parameter, String)> + '_ {
        Parameter::ALL.into_iter().map(|parameter| (parameter, self.0.get(parameter)))
    }
}

impl Serialize for Parameters {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(Some(Parameter::ALL.len()))?;
        for (parameter, value) in self.pairs() {
            match value.parse::<u64>() {
                Ok(number) if parameter.choices().is_empty() => map.serialize_entry(parameter.name(), &number)?,
                _ => map.serialize_entry(parameter.name(), &value)?,
            }
        }
        map.end()
    }
}

/// A class and how many of its models take part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct ClassRow {
    /// Its name.
    pub name: String,
    /// Training models that take part.
    pub train: usize,
    /// Query models that take part.
    pub query: usize,
    /// Models that take no part.
    pub skipped: usize,
}

/// How far a model has come.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum ModelStatus {
    /// Its spectrum is there and it takes part.
    Ready,
    /// It takes no part; [`Document::skipped`] says why.
    Skipped,
    /// Its spectrum is not there yet (only in a report of an unfinished run).
    Waiting,
}

/// A model as reports list it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModelRecord {
    /// Its name, unique in the data set.
    pub name: String,
    /// Its file, below the data set's folder, with `/` between folders.
    pub file: String,
    /// Its class.
    pub class: String,
    /// Its side of the split.
    pub role: Role,
    /// How far it has come.
    pub state: ModelStatus,
    /// Why it takes no part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Vertices, once it has been read.
    pub vertices: Option<usize>,
    /// Triangles, once it has been read.
    pub triangles: Option<usize>,
    /// Total mass 1ᵀB1: the area for FEM, the number of vertices for cot.
    pub measure: Option<f64>,
    /// Eigenvalues used: kmax, or all there are where the mesh has fewer.
    pub eigenvalues: Option<usize>,
    /// The class AdaBoost decides for it.
    pub decided: Option<String>,
    /// What is wrong with the mesh, and what was done about it.
    pub defects: Vec<String>,
}

/// A model that takes no part.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Skipped {
    /// Its name.
    pub name: String,
    /// Its file.
    pub file: String,
    /// Why.
    pub reason: String,
}

/// ε and mean ADR against k; entry k − 1 belongs to k.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Curves {
    /// Classification error.
    pub error: Curve,
    /// Mean average dynamic recall.
    pub adr: Curve,
}

/// What the methods selected.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Selections {
    /// The first k eigenvalues.
    pub first_k: Option<FirstKPart>,
    /// Hill climbing with backward steps.
    pub hill_climbing: Climbs,
    /// AdaBoost.
    pub adaboost: Option<Boost>,
}

/// A k with its two figures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Read {
    /// How many of the first eigenvalues.
    pub k: usize,
    /// ε there.
    pub error: Score,
    /// Mean ADR there.
    pub adr: Score,
}

/// Where the curves are read off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FirstKPart {
    /// The smallest k with the least ε on D.
    pub best_error: Option<Read>,
    /// The smallest k with the greatest mean ADR on D.
    pub best_adr: Option<Read>,
    /// At the parameter k; none when it exceeds kmax.
    pub at_k: Option<Read>,
}

/// Hill climbing for both costs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Climbs {
    /// For ε.
    pub error: Option<ClimbPart>,
    /// For 1 − mean ADR.
    pub adr: Option<ClimbPart>,
}

/// Hill climbing for one cost.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClimbPart {
    /// Eigenvalue indices, ascending.
    pub selected: Vec<u32>,
    /// The accepted moves in their order.
    pub steps: Vec<Step>,
    /// ε with the selected eigenvalues.
    pub error: Score,
    /// Mean ADR with them.
    pub adr: Score,
}

/// AdaBoost after T rounds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Boost {
    /// ε of the class with the largest p(C|M).
    pub error: Score,
    /// Mean over the classes of the number of distinct eigenvalues chosen.
    pub mean_chosen: f64,
    /// The same with every eigenvalue that tied for the least error.
    pub mean_ties: f64,
    /// One strong classifier per class.
    pub classes: Vec<ClassPart>,
}

/// The strong classifier of one class.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClassPart {
    /// The class.
    pub class: String,
    /// Its eigenvalues with their summed α, ascending.
    pub selected: Vec<Mark>,
    /// Its rounds in order.
    pub rounds: Vec<Round>,
}

/// The eigenvalues of one model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpectrumRow {
    /// The model.
    pub name: String,
    /// λ, ascending, without normalisation: those used, kmax at most.
    pub eigenvalues: Vec<f64>,
}

/// Where the spectra came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct StoreCounts {
    /// Solved in this run.
    pub computed: usize,
    /// Still in memory.
    pub memory: usize,
    /// Read from the store.
    pub disk: usize,
}

impl StoreCounts {
    /// Counts one more.
    pub(crate) const fn add(&mut self, source: Source) {
        match source {
            Source::Ran => self.computed += 1,
            Source::Memory => self.memory += 1,
            Source::Disk => self.disk += 1,
        }
    }
}

/// What differs from run to run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Run {
    /// Wall-clock time, seconds.
    pub seconds: f64,
    /// Threads.
    pub threads: usize,
    /// The store's folder.
    pub cache: Option<String>,
    /// Where the spectra came from.
    pub spectra: StoreCounts,
    /// What each stage did.
    pub stages: Vec<StageRow>,
    /// Where each model's spectrum came from.
    pub models: Vec<RunModel>,
    /// What went wrong without harm to a figure (a store that cannot be written, say).
    pub warnings: Vec<String>,
}

/// Where one model's spectrum came from.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunModel {
    /// The model.
    pub name: String,
    /// Where from.
    pub source: Source,
    /// How long the solve took when it ran, seconds.
    pub seconds: f64,
}

impl Document {
    /// The name of the class whose detail the parameters ask for.
    #[must_use]
    pub fn class(&self) -> &str {
        self.classes.get(self.parameters.0.class).map_or("", |class| &class.name)
    }
}

//! What the database says, as plain data: nothing here borrows from it.

use std::{path::PathBuf, sync::Arc, time::Duration};

use serde::Serialize;

use super::Settings;
use crate::{
    dataset::Role,
    study::{Boosted, Climbed, FirstK, Mark, Table},
};

/// Where a value came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Source {
    /// It was computed now.
    Ran,
    /// It was still in memory.
    Memory,
    /// It was read from the store.
    Disk,
}

/// A stage of the pipeline, in its order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// A file's bytes → their blake3 hash.
    Content,
    /// Bytes → mesh, its geometry hash and its defects.
    Survey,
    /// Mesh → Laplacian → certified eigenvalues.
    Spectrum,
    /// Eigenvalues → normalised features.
    Features,
    /// ε and mean ADR for every k.
    FirstK,
    /// Hill climbing for ε.
    ClimbError,
    /// Hill climbing for mean ADR.
    ClimbAdr,
    /// AdaBoost's rounds for every class.
    Boost,
    /// Tables, marks and slices.
    Tables,
}

impl Stage {
    /// All of them, in the pipeline's order.
    pub const ALL: [Self; 9] = [
        Self::Content,
        Self::Survey,
        Self::Spectrum,
        Self::Features,
        Self::FirstK,
        Self::ClimbError,
        Self::ClimbAdr,
        Self::Boost,
        Self::Tables,
    ];

    /// Its name on screen and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Content => "content hash",
            Self::Survey => "mesh",
            Self::Spectrum => "spectrum",
            Self::Features => "features",
            Self::FirstK => "first-k",
            Self::ClimbError => "HCBw ε",
            Self::ClimbAdr => "HCBw ADR",
            Self::Boost => "AdaBoost",
            Self::Tables => "tables",
        }
    }
}

/// What one stage has done since the last change of a parameter or a file.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StageRow {
    /// Which stage.
    pub stage: Stage,
    /// Values computed.
    pub ran: usize,
    /// Values that were in memory and still held.
    pub memory: usize,
    /// Values read from the store.
    pub disk: usize,
    /// Values not there yet.
    pub stale: usize,
    /// Values that could not be had; the models' rows say why.
    pub failed: usize,
    /// Processor time of the values computed and read, seconds, over all threads.
    pub seconds: f64,
    /// What the values that were in memory or on disk cost when they were made, seconds, as far as that is known.
    pub saved: f64,
}

/// How far one model has come.
#[derive(Debug, Clone, PartialEq)]
pub enum ModelState {
    /// Not begun.
    Waiting,
    /// Being read or solved now: `done` of `total` eigenvalues.
    Working {
        /// Eigenvalues found so far.
        done: usize,
        /// Eigenvalues asked for.
        total: usize,
    },
    /// Its spectrum is there.
    Ready {
        /// Where the spectrum came from.
        source: Source,
        /// Eigenvalues there are (at least as many as asked for, unless the mesh has fewer).
        count: usize,
        /// How long the solve took, seconds, in this session or an earlier one; 0 where that is not known.
        seconds: f64,
    },
    /// It takes no part, and why: unreadable, refused, not solvable, or too few eigenvalues for kmax.
    Out {
        /// In one line, naming the file and the defect.
        reason: String,
    },
}

/// One model as the screen lists it.
#[derive(Debug, Clone, PartialEq)]
pub struct ModelRow {
    /// Its name in the data set.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// Index into [`Answer::classes`].
    pub class: u32,
    /// Its side of the split.
    pub role: Role,
    /// How far it has come.
    pub state: ModelState,
    /// Vertices and triangles, once it has been read.
    pub size: Option<(usize, usize)>,
    /// What is wrong with the mesh, one line each, each with its place; and what was done about it.
    pub defects: Arc<Vec<String>>,
    /// Total mass 1ᵀB1 (area for FEM, number of vertices for cot), once its spectrum is there: Weyl's line is
    /// 4πk/measure.
    pub measure: Option<f64>,
    /// The eigenvalues (ascending, as solved, without normalisation), once they are there.
    pub eigenvalues: Option<Arc<Vec<f64>>>,
}

/// How far the spectra have come.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Progress {
    /// Models whose spectrum is there.
    pub ready: usize,
    /// Models that take no part.
    pub out: usize,
    /// Models in the data set.
    pub total: usize,
    /// Spectra solved per second, over the last few seconds of solving.
    pub rate: Option<f64>,
    /// Time left at that rate.
    pub left: Option<Duration>,
}

impl Progress {
    /// True when every model is either ready or out.
    #[must_use]
    pub const fn complete(&self) -> bool {
        self.ready + self.out >= self.total
    }
}

/// A value that may still belong to earlier parameters or to fewer models.
#[derive(Debug, Clone, PartialEq)]
pub struct Part<T> {
    /// The newest value there is.
    pub value: Option<Arc<T>>,
    /// True while a newer one is on its way.
    pub stale: bool,
}

impl<T> Default for Part<T> {
    fn default() -> Self {
        Self { value: None, stale: true }
    }
}

/// Everything the screen shows, at one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Answer {
    /// Grows with every change; of two answers the greater one is newer.
    pub serial: u64,
    /// The parameters this answer belongs to.
    pub settings: Settings,
    /// How the folder was understood, in one line.
    pub layout: String,
    /// Class names.
    pub classes: Arc<Vec<String>>,
    /// Every model of the data set, in its order.
    pub models: Arc<Vec<ModelRow>>,
    /// Indices into `models` of those that take part in the values below, in the study's order.
    pub members: Arc<Vec<usize>>,
    /// How far the spectra have come.
    pub progress: Progress,
    /// A row per stage, in [`Stage::ALL`]'s order.
    pub stages: Vec<StageRow>,
    /// Curves of the first k eigenvalues.
    pub first_k: Part<FirstK>,
    /// Hill climbing for ε.
    pub climb_error: Part<Climbed>,
    /// Hill climbing for mean ADR.
    pub climb_adr: Part<Climbed>,
    /// AdaBoost after T rounds.
    pub boosted: Part<Boosted>,
    /// For each class, the eigenvalues AdaBoost selected (Figures 4 and 5), ascending.
    pub marks: Part<Vec<Vec<Mark>>>,
    /// Tables 1 to 4.
    pub tables: Part<Vec<Table>>,
    /// What leaves models out although nothing is wrong, in one line: they have fewer than kmax eigenvalues.
    pub short: Option<String>,
    /// Bytes of memory that the process has, where the system says so.
    pub memory: Option<u64>,
    /// What the user should know: passed-over files, a store that cannot be written. Newest last.
    pub warnings: Arc<Vec<String>>,
}

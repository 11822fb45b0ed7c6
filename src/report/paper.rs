//! The whole experiment of the paper as one document: every table beside its published values, every figure.
//!
//! The experiment is made on eight spectra: original and re-meshed models, FEM and cot, normalised and not. [`collect`]
//! turns a host through them; [`Paper::new`] makes tables, figures and words of what it said, and
//! [`Paper::files`] writes them as Markdown, CSV, JSON, SVG and PNG. [`write()`] does all of that. Nothing in the files
//! depends on the moment, so a second run gives the same bytes.

use std::{path::Path, sync::Arc};

use serde::Serialize;

pub use self::{
    published::{Column, Published, Row, published},
    variation::{Subject, Variation},
    write::WriteError,
};
use super::document::{Identity, Parameters};
use crate::{
    dataset::Role,
    figure::Figure,
    laplacian::Operator,
    query::{Answer, Cancelled, Finding, Host, ModelState, Question, Settings},
    spectrum::Normalisation,
    study::{Boosted, Climbed, FirstK, Honest, Mark, Retrieved, Splits, Spread, Table, Tuned},
    watch::{Silent, Watch},
};

mod differences;
mod figures;
mod honest;
mod published;
mod retrieved;
mod tables;
mod tuned;
pub mod variation;
mod write;

/// One of the paper's spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub struct Variant {
    /// Whether the models are re-meshed first.
    pub remeshed: bool,
    /// Which eigenproblem.
    pub operator: Operator,
    /// Whether each spectrum is divided by its last eigenvalue.
    pub normalised: bool,
}

impl Variant {
    /// The one that the paper finds best: its Figures 4, 5 and 7 and its Table 5 are of it.
    pub const BEST: Self = Self { remeshed: true, operator: Operator::Fem, normalised: true };

    /// The eight of Figure 3, in the order in which they are computed: those that share eigenvalues together.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for remeshed in [false, true] {
            for operator in [Operator::Fem, Operator::Cot] {
                all.extend([false, true].map(|normalised| Self { remeshed, operator, normalised }));
            }
        }
        all
    }

    /// Its name in tables and legends.
    #[must_use]
    pub fn name(self) -> String {
        let models = if self.remeshed { "re-meshed" } else { "original" };
        let operator = match self.operator {
            Operator::Fem => "FEM",
            Operator::Cot => "cot",
        };
        format!("{models} {operator} {}", if self.normalised { "norm." } else { "un-norm." })
    }

    /// Its column in the paper's tables; normalised cot spectra have none.
    #[must_use]
    pub const fn column(self) -> Option<Column> {
        Some(match (self.remeshed, self.operator, self.normalised) {
            (false, Operator::Fem, false) => Column::OriginalFem,
            (false, Operator::Fem, true) => Column::OriginalFemNormalised,
            (false, Operator::Cot, false) => Column::OriginalCot,
            (true, Operator::Fem, false) => Column::RemeshedFem,
            (true, Operator::Fem, true) => Column::RemeshedFemNormalised,
            (true, Operator::Cot, false) => Column::RemeshedCot,
            (_, Operator::Cot, true) => return None,
        })
    }

    /// The parameters `base` turned to this spectrum.
    #[must_use]
    pub fn settings(self, base: &Settings) -> Settings {
        let normalisation = if self.normalised { Normalisation::Max } else { Normalisation::None };
        let remesh = self.remeshed.then(|| base.remesh.unwrap_or(crate::remesh::USUAL));
        Settings { operator: self.operator, normalisation, remesh, ..base.clone() }
    }
}

/// The study of one spectrum.
#[derive(Debug, Clone, Serialize)]
pub struct Rows {
    /// Which spectrum.
    pub spectrum: Variant,
    /// Its name.
    pub name: String,
    /// Training models that take part.
    pub train: usize,
    /// Query models that take part.
    pub query: usize,
    /// Those that do not, with the reason.
    pub out: Vec<(String, String)>,
    /// Figures 3 and 6, Tables 1 and 4.
    pub first_k: Arc<FirstK>,
    /// Table 2.
    pub climb_error: Arc<Climbed>,
    /// Table 4.
    pub climb_adr: Arc<Climbed>,
    /// Table 3.
    pub boosted: Arc<Boosted>,
    /// Figures 4 and 5.
    pub marks: Arc<Vec<Vec<Mark>>>,
    /// The same tables on other splits of the models and by other readings, for spectra that the paper has.
    pub splits: Option<Arc<Splits>>,
}

impl Rows {
    /// A figure on other splits; none where all splits are the same for want of queries.
    fn spread(&self, of: fn(&Splits) -> Spread) -> Option<Spread> {
        self.splits.as_deref().filter(|_| self.query > 0).map(of)
    }
}

/// Why there is no document.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// The watch said so; finished spectra are kept.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// A spectrum cannot be studied.
    #[error("{spectrum}: {reason}")]
    Study {
        /// Which.
        spectrum: String,
        /// Why.
        reason: String,
    },
    /// The document is made, but it cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
}

/// Makes the document for the host's parameters and writes it to `folder`, which is made if it is absent. Returns the
/// names of the files there; those of an earlier document that it has, too, are written over.
///
/// `root` is what the document calls the data set. `watch` hears of models finished, of all spectra together, and is
/// polled every few milliseconds: before it is written, a cancelled document leaves no trace but spectra in the store.
/// On another thread than the host's, a host beside it does.
///
/// # Errors
/// [`PaperError`].
pub fn write(host: &mut Host, root: &str, folder: &Path, watch: &dyn Watch) -> Result<Vec<String>, PaperError> {
    let base = host.settings().clone();
    let found = collect(host, &base, watch)?;
    let files = Paper::new(host, root, found).files()?;
    if watch.cancelled() {
        return Err(Cancelled.into());
    }
    Ok(write::save(folder, files)?)
}

/// Makes the study on every spectrum in turn; `base` says what is not part of the paper's plan (kmax, distance, T …).
///
/// `watch` hears of models finished, of all spectra together. The host is left at `base`. The variants of Figure 1 are
/// of the first training model of `base`'s class that has a spectrum, solved on as many threads as the host has.
///
/// # Errors
/// [`PaperError`].
pub fn collect(host: &mut Host, base: &Settings, watch: &dyn Watch) -> Result<Found, PaperError> {
    let variants = Variant::all();
    let mut found = Found {
        rows: Vec::new(),
        variation: Err("it is made last".to_owned()),
        retrieved: Arc::default(),
        honest: Vec::new(),
        tuned: None,
    };
    let turns = variants.len() + 1;
    for (turn, &variant) in variants.iter().enumerate() {
        host.set(variant.settings(base));
        let answer = host.run(&Turn { watch, at: turn, of: turns })?;
        let mut rows = Rows::new(variant, &answer)?;
        // What else the unknown split and the paper's words allow, where there is something to compare it with.
        if variant.column().is_some()
            && let Ok(Finding::Splits(splits)) = host.find(Question::Splits, watch)?
        {
            rows.splits = Some(splits);
        }
        found.rows.push(rows);
        if variant == Variant::BEST
            && let Ok(Finding::Retrieval(rows)) = host.find(Question::Retrieval, watch)?
        {
            found.retrieved = rows;
        }
        if variant.operator == Operator::Fem && variant.normalised {
            found.examine(host, &variant.name(), &answer.members, watch)?;
        }
    }
    // What a reader would ask next: features that know how large the shape is for its frequencies.
    host.set(Settings { operator: Operator::Fem, normalisation: Normalisation::Log, remesh: None, ..base.clone() });
    let answer = host.run(&Turn { watch, at: variants.len(), of: turns })?;
    found.examine(host, "original FEM ln(λ·area)", &answer.members, watch)?;
    if let Ok(Finding::Tuned(tuned)) = host.find(Question::Tuned, watch)? {
        found.tuned = Some((tuned, answer.members));
    }
    host.set(base.clone());
    let subject = Subject::new(base, &host.answer());
    found.variation = variation::of_class(&host.singles(), &subject, host.threads(), &Silent(watch));
    if watch.cancelled() {
        return Err(Cancelled.into());
    }
    Ok(found)
}

/// All that the document is made of.
#[derive(Debug, Clone)]
pub struct Found {
    /// A study per spectrum.
    pub rows: Vec<Rows>,
    /// Figure 1, or why there is none.
    pub variation: Result<Variation, String>,
    /// Table 5 and Figure 7, on [`Variant::BEST`].
    pub retrieved: Arc<Vec<Retrieved>>,
    /// Nested cross-validation.
    pub honest: Vec<Examined>,
    /// Nearest neighbours tuned inside the fold, on the FEM spectra of the original models, and the places of these.
    pub tuned: Option<(Arc<Tuned>, Arc<Vec<usize>>)>,
}

/// Nested cross-validation on one kind of features.
#[derive(Debug, Clone, Serialize)]
pub struct Examined {
    /// The features.
    pub features: String,
    /// The places of the models that take part: methods are compared in pairs on the same models alone.
    #[serde(skip)]
    pub models: Arc<Vec<usize>>,
    /// What was found.
    #[serde(flatten)]
    pub honest: Arc<Honest>,
}

impl Found {
    /// Examines what the host has just studied.
    fn examine(
        &mut self,
        host: &mut Host,
        features: &str,
        models: &Arc<Vec<usize>>,
        watch: &dyn Watch,
    ) -> Result<(), Cancelled> {
        if let Ok(Finding::Honest(honest)) = host.find(Question::Honest, watch)? {
            self.honest.push(Examined { features: features.to_owned(), models: Arc::clone(models), honest });
        }
        Ok(())
    }
}

/// One run of several, told as a part of the whole.
struct Turn<'a> {
    watch: &'a dyn Watch,
    at: usize,
    of: usize,
}

impl Watch for Turn<'_> {
    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }

    fn progress(&self, done: usize, total: usize) {
        self.watch.progress(self.at * total + done, self.of * total);
    }
}

impl Rows {
    fn new(spectrum: Variant, answer: &Answer) -> Result<Self, PaperError> {
        let name = spectrum.name();
        let out: Vec<(String, String)> = answer
            .models
            .iter()
            .filter_map(|model| match &model.state {
                ModelState::Out { reason } => Some((model.name.clone(), reason.clone())),
                _ => None,
            })
            .collect();
        let study = (|| {
            Some((
                answer.first_k.value.clone()?,
                answer.climb_error.value.clone()?,
                answer.climb_adr.value.clone()?,
                answer.boosted.value.clone()?,
                answer.marks.value.clone()?,
            ))
        })();
        let Some((first_k, climb_error, climb_adr, boosted, marks)) = study else {
            let why =
                answer.warnings.last().cloned().or_else(|| out.first().map(|(model, why)| format!("{model}: {why}")));
            let reason = why.unwrap_or_else(|| "two training models at least are needed".to_owned());
            return Err(PaperError::Study { spectrum: name, reason });
        };
        let members = |role| answer.members.iter().filter(|&&at| answer.models[at].role == role).count();
        let (train, query) = (members(Role::Train), members(Role::Query));
        Ok(Self { spectrum, name, train, query, out, first_k, climb_error, climb_adr, boosted, marks, splits: None })
    }
}

/// The document.
#[derive(Debug, Clone)]
pub struct Paper {
    head: Head,
    found: Found,
    sections: Vec<Section>,
}

/// What the document says of itself; the beginning of its JSON.
#[derive(Debug, Clone, Serialize)]
struct Head {
    program: Identity<&'static str>,
    data: String,
    layout: String,
    classes: Arc<Vec<String>>,
    parameters: Parameters,
}

/// A part of the document: words, perhaps a table, perhaps a figure.
#[derive(Debug, Clone)]
struct Section {
    heading: String,
    words: Vec<String>,
    table: Option<(String, Table)>,
    figure: Option<(String, Figure)>,
}

impl Paper {
    /// The document of what [`collect`] found in the data set at `root`.
    #[must_use]
    pub fn new(host: &Host, root: &str, found: Found) -> Self {
        let head = Head {
            program: Identity { name: env!("CARGO_PKG_NAME"), version: env!("CARGO_PKG_VERSION") },
            data: root.to_owned(),
            layout: host.layout().to_owned(),
            classes: Arc::new(host.classes().to_vec()),
            parameters: Parameters(host.settings().clone()),
        };
        let mut sections = tables::sections(&head, &found.rows);
        sections.extend(differences::sections(&head, &found.rows));
        sections.push(variation::section(found.variation.as_ref()));
        sections.extend(figures::sections(&head, &found.rows));
        sections.extend(retrieved::sections(&found.retrieved));
        sections.extend(honest::sections(&found.honest));
        let tuned = found.tuned.as_ref().map(|(tuned, models)| (&**tuned, &models[..]));
        sections.extend(tuned.into_iter().flat_map(|tuned| tuned::sections(tuned, &found.honest)));
        Self { head, found, sections }
    }
}

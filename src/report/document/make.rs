//! Answer → document.

use std::{collections::BTreeMap, path::Path};

use super::{
    Boost, ClassPart, ClassRow, ClimbPart, Climbs, Curves, Data, Document, FirstKPart, Identity, ModelRecord,
    ModelStatus, Origin, Parameters, Read, Run, RunModel, Selections, Skipped, SpectrumRow, StoreCounts,
};
use crate::{
    dataset::Role,
    query::{Answer, ModelRow, ModelState},
    report::json,
    selection::Climb,
    study::{Climbed, FirstK},
};

impl Document {
    /// The report of `answer`.
    #[must_use]
    pub fn new(answer: &Answer, origin: &Origin<'_>) -> Self {
        let settings = &answer.settings;
        let class_name = |class: u32| answer.classes.get(class as usize).cloned().unwrap_or_default();
        let decided: BTreeMap<usize, u32> = match &answer.boosted.value {
            Some(boosted) => answer.members.iter().copied().zip(boosted.decided.iter().copied()).collect(),
            None => BTreeMap::new(),
        };
        let models: Vec<ModelRecord> = answer
            .models
            .iter()
            .enumerate()
            .map(|(at, row)| ModelRecord {
                name: row.name.clone(),
                file: below(&row.path, origin.root),
                class: class_name(row.class),
                role: row.role,
                state: status(&row.state),
                reason: reason(row),
                vertices: row.size.map(|(vertices, _)| vertices),
                triangles: row.size.map(|(_, triangles)| triangles),
                measure: row.measure,
                eigenvalues: used(row, settings.kmax),
                decided: decided.get(&at).and_then(|&class| answer.classes.get(class as usize).cloned()),
                defects: row.defects.to_vec(),
            })
            .collect();
        let ready = |role: Role| models.iter().filter(|m| m.state == ModelStatus::Ready && m.role == role).count();
        let skipped: Vec<Skipped> = models
            .iter()
            .filter_map(|model| {
                let reason = model.reason.clone()?;
                Some(Skipped { name: model.name.clone(), file: model.file.clone(), reason })
            })
            .collect();

        Self {
            schema: Identity { name: json::SCHEMA, version: json::VERSION },
            program: Identity { name: env!("CARGO_PKG_NAME"), version: env!("CARGO_PKG_VERSION") },
            data: Data {
                root: origin.root.to_owned(),
                layout: answer.layout.clone(),
                classes: answer.classes.len(),
                models: models.len(),
                train: ready(Role::Train),
                query: ready(Role::Query),
                skipped: skipped.len(),
            },
            parameters: Parameters(settings.clone()),
            complete: complete(answer),
            classes: classes(answer),
            skipped,
            warnings: origin.passed_over.to_vec(),
            tables: answer.tables.value.as_deref().cloned().unwrap_or_default(),
            curves: answer
                .first_k
                .value
                .as_deref()
                .map(|first| Curves { error: first.error.clone(), adr: first.adr.clone() }),
            selections: Selections {
                first_k: answer.first_k.value.as_deref().map(|first| first_k(first, settings.k)),
                hill_climbing: Climbs {
                    error: answer.climb_error.value.as_deref().map(ClimbPart::from),
                    adr: answer.climb_adr.value.as_deref().map(ClimbPart::from),
                },
                adaboost: boost(answer),
            },
            spectra: origin.spectra.then(|| spectra(answer)),
            run: run(answer, origin),
            models,
        }
    }
}

/// Whether nothing is missing and nothing is stale.
fn complete(answer: &Answer) -> bool {
    answer.progress.complete()
        && answer.first_k.value.is_some()
        && answer.tables.value.is_some()
        && ![
            answer.first_k.stale,
            answer.climb_error.stale,
            answer.climb_adr.stale,
            answer.boosted.stale,
            answer.marks.stale,
            answer.tables.stale,
        ]
        .contains(&true)
}

/// The path below `root`, with `/` between folders on every system.
fn below(path: &Path, root: &str) -> String {
    let path = path.strip_prefix(root).unwrap_or(path);
    let parts: Vec<_> = path.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    match parts.first() {
        Some(first) if first == "/" => format!("/{}", parts[1..].join("/")),
        _ => parts.join("/"),
    }
}

fn status(state: &ModelState) -> ModelStatus {
    match state {
        ModelState::Ready { .. } => ModelStatus::Ready,
        ModelState::Out { .. } => ModelStatus::Skipped,
        ModelState::Waiting | ModelState::Working { .. } => ModelStatus::Waiting,
    }
}

fn reason(row: &ModelRow) -> Option<String> {
    match &row.state {
        ModelState::Out { reason } => Some(reason.clone()),
        _ => None,
    }
}

/// How many eigenvalues are used. A store may hold more than were asked for; that must not show.
fn used(row: &ModelRow, kmax: usize) -> Option<usize> {
    match row.state {
        ModelState::Ready { count, .. } => Some(count.min(kmax)),
        _ => None,
    }
}

fn classes(answer: &Answer) -> Vec<ClassRow> {
    let mut rows: Vec<ClassRow> =
        answer.classes.iter().map(|name| ClassRow { name: name.clone(), train: 0, query: 0, skipped: 0 }).collect();
    for model in answer.models.iter() {
        let Some(row) = rows.get_mut(model.class as usize) else { continue };
        match (status(&model.state), model.role) {
            (ModelStatus::Ready, Role::Train) => row.train += 1,
            (ModelStatus::Ready, Role::Query) => row.query += 1,
            (ModelStatus::Skipped, _) => row.skipped += 1,
            (ModelStatus::Waiting, _) => {}
        }
    }
    rows
}

fn first_k(first: &FirstK, k: usize) -> FirstKPart {
    let read = |k: usize| Some(Read { k, error: first.error.at(k)?, adr: first.adr.at(k)? });
    FirstKPart { best_error: read(first.best_error), best_adr: read(first.best_adr), at_k: read(k) }
}

fn boost(answer: &Answer) -> Option<Boost> {
    let boosted = answer.boosted.value.as_deref()?;
    let marks = answer.marks.value.as_deref();
    let classes = answer
        .classes
        .iter()
        .zip(&boosted.classes)
        .enumerate()
        .map(|(at, (class, strong))| ClassPart {
            class: class.clone(),
            selected: marks.and_then(|marks| marks.get(at)).cloned().unwrap_or_default(),
            rounds: strong.rounds.clone(),
        })
        .collect();
    Some(Boost { error: boosted.error, mean_chosen: boosted.mean_chosen, mean_ties: boosted.mean_ties, classes })
}

fn spectra(answer: &Answer) -> Vec<SpectrumRow> {
    let kmax = answer.settings.kmax;
    let rows = answer.models.iter().filter_map(|model| {
        let values = model.eigenvalues.as_deref()?;
        Some(SpectrumRow { name: model.name.clone(), eigenvalues: values[..values.len().min(kmax)].to_vec() })
    });
    rows.collect()
}

fn run(answer: &Answer, origin: &Origin<'_>) -> Run {
    let mut counts = StoreCounts::default();
    let mut models = Vec::new();
    for row in answer.models.iter() {
        if let ModelState::Ready { source, seconds, .. } = row.state {
            counts.add(source);
            models.push(RunModel { name: row.name.clone(), source, seconds });
        }
    }
    let short = answer.short.iter().cloned();
    let warnings = short.chain(answer.warnings.iter().filter(|w| !origin.passed_over.contains(w)).cloned()).collect();
    Run {
        seconds: origin.seconds,
        threads: origin.threads,
        cache: origin.cache.map(str::to_owned),
        spectra: counts,
        stages: answer.stages.clone(),
        models,
        warnings,
    }
}

impl From<&Climbed> for ClimbPart {
    fn from(climbed: &Climbed) -> Self {
        let Climb { selected, steps } = climbed.climb.clone();
        Self { selected, steps, error: climbed.error, adr: climbed.adr }
    }
}

//! What the worker tells for the journal.

use std::{path::PathBuf, sync::Arc, time::Duration};

use super::{Desk, GRACE};
use crate::{
    query::{Answer, ModelState, Parameter, Settings, Stage},
    workbench::{
        Trial, Update, experiment,
        journal::{Clock, Weight},
    },
};

/// So many models that take no part are named.
const NAMED: usize = 40;

/// What was told already.
#[derive(Debug)]
pub(super) struct Told {
    clock: Clock,
    opened: bool,
    complete: bool,
    warnings: Arc<Vec<String>>,
}

impl Told {
    pub(super) fn begin() -> Self {
        Self { clock: Clock::begin(), opened: false, complete: false, warnings: Arc::default() }
    }
}

impl Desk<'_> {
    /// Tells a line.
    pub(super) fn note(&self, weight: Weight, text: &str) {
        (self.notify)(Update::Note(self.told.clock.line(weight, text)));
    }

    /// Tells what an answer has that those before had not: the data set, warnings, spectra that are all there.
    pub(super) fn account(&mut self, answer: &Answer) {
        if !std::mem::replace(&mut self.told.opened, true) {
            let (models, classes) = (answer.models.len(), answer.classes.len());
            let threads = self.setup.threads;
            let text = format!(
                "{}: {}, {models} models of {classes} classes; cache {}, {threads} threads",
                self.setup.root.display(),
                answer.layout,
                self.setup.store.dir().display()
            );
            self.note(Weight::Note, &text);
        }
        if *answer.warnings != *self.told.warnings {
            for warning in answer.warnings.iter().filter(|warning| !self.told.warnings.contains(warning)) {
                self.note(Weight::Warning, warning);
            }
            self.told.warnings = Arc::clone(&answer.warnings);
        }
        let complete = answer.progress.complete();
        if complete && !self.told.complete {
            self.note_spectra(answer);
        }
        self.told.complete = complete;
    }

    fn note_spectra(&self, answer: &Answer) {
        let Some(row) = answer.stages.iter().find(|row| row.stage == Stage::Spectrum) else { return };
        let text = format!(
            "spectra: {} computed, {} from memory, {} from the cache, {} models take no part; {:.1} s of processor time",
            row.ran, row.memory, row.disk, answer.progress.out, row.seconds
        );
        self.note(Weight::Note, &text);
        let out = answer.models.iter().filter_map(|model| match &model.state {
            ModelState::Out { reason } => Some(format!("{} takes no part: {reason}", model.name)),
            _ => None,
        });
        out.take(NAMED).for_each(|text| self.note(Weight::Warning, &text));
    }

    /// Turns the parameters, and tells what was turned.
    pub(super) fn turn(&mut self, settings: Settings) {
        let old = self.host.settings().clone();
        let turned: Vec<String> = Parameter::ALL
            .into_iter()
            .filter(|parameter| settings.get(*parameter) != old.get(*parameter))
            .map(|parameter| format!("{} = {}", parameter.name(), settings.get(parameter)))
            .collect();
        if self.host.set(settings) {
            self.told.complete &= self.host.complete();
            self.note(Weight::Note, &turned.join(", "));
            self.restudy();
            self.publish_within(GRACE);
        }
    }

    pub(super) fn note_study(&self, models: usize, took: Duration) {
        self.note(Weight::Note, &format!("study of {models} models in {:.3} s", took.as_secs_f64()));
    }

    /// Passes figures under other parameters on.
    pub(super) fn tried(&self, trial: Trial) {
        let now = self.host.settings();
        let differs = |parameter: &Parameter| trial.settings.get(*parameter) != now.get(*parameter);
        let of = Parameter::ALL.into_iter().filter(differs);
        let said: Vec<String> =
            of.map(|parameter| format!("{} = {}", parameter.name(), trial.settings.get(parameter))).collect();
        let said = if said.is_empty() { "the parameters of the screen".to_owned() } else { said.join(", ") };
        self.note(Weight::Note, &format!("tried {said}"));
        (self.notify)(Update::Trial(Arc::new(trial)));
    }

    /// Passes on what became of a file.
    pub(super) fn written(&self, path: PathBuf, outcome: Result<(), String>) {
        match &outcome {
            Ok(()) => self.note(Weight::Note, &format!("{} is written", path.display())),
            Err(reason) => self.note(Weight::Error, &format!("{}: {reason}", path.display())),
        }
        (self.notify)(Update::Written(path, outcome));
    }

    /// Passes on news of the paper's document.
    pub(super) fn paper_told(&self, told: experiment::Told) {
        match &told {
            experiment::Told::Done(Ok(files)) => {
                self.note(Weight::Note, &format!("the document is written: {files} files"));
            }
            experiment::Told::Done(Err(reason)) => self.note(Weight::Error, &format!("the document: {reason}")),
            experiment::Told::Progress(..) => {}
        }
        (self.notify)(Update::Paper(told));
    }
}

//! The paper's experiment on the screen: curves of all its spectra over each other, the variants of a shape, and the
//! whole document.
//!
//! Spectra other than those of the screen's parameters are computed only once they are switched on.

use std::{collections::BTreeSet, sync::Arc};

use super::{Command, Effect, Entry, Purpose, State, Trial, View, leave, pins, update};
use crate::{
    query::{ModelState, Settings, Source},
    report::paper::{
        Variant,
        variation::{self, Subject, Variation},
    },
    study::FirstK,
};

/// Curves of other spectra that are kept.
const KEPT: usize = 24;
/// Processor time of one eigenvalue of one vertex, in seconds: that of SHREC 2007 with 500 eigenvalues, until solves
/// of this session say it better.
const RATE: f64 = 1.05e-7;
/// The part of a solve that re-meshing adds.
const REMESHING: f64 = 0.1;
/// Vertices of a model that was not read yet.
const UNREAD: usize = 5000;

/// What the view of curves shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Face {
    /// ε and mean ADR of the screen's parameters.
    #[default]
    Own,
    /// Figures 3 and 6: those of the paper's spectra over each other.
    Spectra,
    /// Figure 7: precision against recall.
    Recall,
    /// Figure 1: how much the spectrum of a shape varies.
    Variation,
}

impl Face {
    /// All of them, in the order in which they are turned to.
    pub const ALL: [Self; 4] = [Self::Own, Self::Spectra, Self::Recall, Self::Variation];

    /// The face after this one, going round.
    #[must_use]
    pub const fn next(self) -> Self {
        match self {
            Self::Own => Self::Spectra,
            Self::Spectra => Self::Recall,
            Self::Recall => Self::Variation,
            Self::Variation => Self::Own,
        }
    }
}

/// The document that is being written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Document {
    /// Where.
    pub folder: String,
    /// Models finished, of all spectra together.
    pub done: usize,
    /// All models, of all spectra together; 0 before anything is known.
    pub total: usize,
    /// It was called off, and has not ended yet.
    pub called_off: bool,
}

/// News of the document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Told {
    /// So many models of so many are finished.
    Progress(usize, usize),
    /// It is written, as so many files, or why not.
    Done(Result<usize, String>),
}

/// Figure 1 that was made.
#[derive(Debug, Clone, PartialEq)]
pub struct Varied {
    /// What it is of.
    pub subject: Subject,
    /// The figure's rows, or why there are none.
    pub variation: Result<Variation, String>,
}

/// Figure 1 that is being made.
#[derive(Debug, Clone, PartialEq)]
pub struct Varying {
    /// What it is of.
    pub subject: Subject,
    /// Spectra that are there.
    pub done: usize,
    /// All of them.
    pub total: usize,
}

impl Varying {
    fn of(subject: Subject) -> Self {
        let total = variation::solves(subject.models.len());
        Self { subject, done: 0, total }
    }
}

/// What of the experiment is on the screen.
#[derive(Debug, Clone, Default)]
pub struct Experiment {
    /// What the view of curves shows.
    pub face: Face,
    /// The spectra switched on, places in [`Variant::all`].
    pub on: BTreeSet<usize>,
    /// The spectrum that the keys act on.
    pub at: usize,
    /// Curves of other spectra, the newest last.
    curves: Vec<(Settings, Arc<FirstK>)>,
    /// The trial under way, its models finished and all of them.
    pub trying: Option<(Settings, usize, usize)>,
    /// The document that is being written.
    pub document: Option<Document>,
    /// Figure 1 that is being made.
    pub varying: Option<Varying>,
    /// Figure 1 that was made last.
    pub varied: Option<Arc<Varied>>,
}

/// How a spectrum's curves stand.
#[derive(Debug, Clone, PartialEq)]
pub enum Standing {
    /// They are there.
    There(Arc<FirstK>),
    /// Switched on, and being computed: models finished, and all.
    Computing(usize, usize),
    /// Switched on, others before it.
    Waiting,
    /// Not switched on: the processor time that it would take, in seconds, when nothing of it is in the store.
    Off(f64),
}

/// The parameters that the curves of a spectrum depend on, the others at their first values.
fn settings(state: &State, variant: Variant) -> Settings {
    let first = Settings::default();
    let only = Settings {
        k: first.k,
        rounds: first.rounds,
        cost: first.cost,
        sel: first.sel,
        class: first.class,
        search: first.search,
        weak: first.weak,
        stop: first.stop,
        ..state.settings.clone()
    };
    variant.settings(&only)
}

impl State {
    /// How the curves of the spectrum at a place of [`Variant::all`] stand.
    #[must_use]
    pub fn standing(&self, place: usize) -> Standing {
        let all = Variant::all();
        let Some(&variant) = all.get(place) else { return Standing::Waiting };
        let wanted = settings(self, variant);
        let own = variant.settings(&self.settings) == self.settings && self.answer.settings == self.settings;
        let own = self.answer.first_k.value.as_ref().filter(|_| own && !self.answer.first_k.stale);
        let kept = self.experiment.curves.iter().rev().find(|(settings, _)| *settings == wanted);
        if let Some(first_k) = own.or(kept.map(|(_, first_k)| first_k)) {
            return Standing::There(Arc::clone(first_k));
        }
        if !self.experiment.on.contains(&place) {
            return Standing::Off(self.cost(&wanted));
        }
        match &self.experiment.trying {
            Some((settings, done, total)) if *settings == wanted => Standing::Computing(*done, *total),
            _ => Standing::Waiting,
        }
    }

    /// Processor time that the spectra of other parameters would take, in seconds.
    fn cost(&self, wanted: &Settings) -> f64 {
        let problem = wanted.problem();
        let known = |settings: &Settings| settings.problem() == problem && settings.kmax >= wanted.kmax;
        if known(&self.answer.settings) || self.experiment.curves.iter().any(|(settings, _)| known(settings)) {
            return 0.0;
        }
        let kmax = self.settings.kmax as f64;
        let (mut seconds, mut work) = (0.0, 0.0);
        for model in self.answer.models.iter() {
            if let (ModelState::Ready { source: Source::Ran, seconds: took, .. }, Some(size)) =
                (&model.state, model.size)
            {
                seconds += took;
                work += size.0 as f64 * self.answer.settings.kmax as f64;
            }
        }
        let rate = if work > 0.0 { seconds / work } else { RATE };
        let vertices = |size: Option<(usize, usize)>| size.map_or(UNREAD, |size| size.0);
        let more = if wanted.remesh.is_some() { 1.0 + REMESHING } else { 1.0 };
        let of = |size| wanted.remesh.unwrap_or_else(|| vertices(size)) as f64 * kmax * rate * more;
        self.answer.models.iter().map(|model| of(model.size)).sum()
    }

    /// Figure 1 of the class on the screen, or why there is none; none before it was made.
    #[must_use]
    pub fn variation(&self) -> Option<Result<&Variation, &str>> {
        let varied = self.experiment.varied.as_ref().filter(|varied| varied.subject == self.subject())?;
        Some(varied.variation.as_ref().map_err(String::as_str))
    }

    /// What Figure 1 is of.
    #[must_use]
    pub fn subject(&self) -> Subject {
        Subject::new(&self.settings, &self.answer)
    }
}

/// Spectra that are switched on and not there.
pub(super) fn untried(state: &State) -> impl Iterator<Item = Settings> {
    let all = Variant::all();
    let missing = |place: &usize| !matches!(state.standing(*place), Standing::There(_));
    state
        .experiment
        .on
        .iter()
        .copied()
        .filter(missing)
        .filter_map(move |place| all.get(place).map(|variant| settings(state, *variant)))
}

/// Takes in curves under other parameters.
pub(super) fn take(state: &mut State, trial: &Trial) {
    let Some(first_k) = trial.figures.first_k.clone() else { return };
    let mine = Variant::all().into_iter().any(|variant| settings(state, variant) == trial.settings);
    if mine {
        let experiment = &mut state.experiment;
        experiment.curves.retain(|(settings, _)| *settings != trial.settings);
        if experiment.curves.len() == KEPT {
            experiment.curves.remove(0);
        }
        experiment.curves.push((trial.settings.clone(), first_k));
    }
}

/// The spectrum before or after, where they are listed.
pub(super) fn step(state: &mut State, by: isize) {
    let last = Variant::all().len() as isize;
    state.experiment.at = (state.experiment.at as isize + by).rem_euclid(last) as usize;
}

/// Switches on, or off, what the view of curves shows.
pub(super) fn switch(state: &mut State) -> Vec<Effect> {
    match state.experiment.face {
        Face::Spectra => {
            let at = state.experiment.at;
            if state.experiment.on.insert(at) {
                return Vec::new();
            }
            state.experiment.on.remove(&at);
            again(state)
        }
        Face::Variation if state.experiment.varying.take().is_some() => vec![Effect::Send(Command::StopVarying)],
        Face::Variation => vary(state),
        Face::Own | Face::Recall => {
            update::say(state, "f turns to the paper's spectra, which are switched on and off");
            Vec::new()
        }
    }
}

/// Switches everything off.
pub(super) fn switch_off(state: &mut State) -> Vec<Effect> {
    state.experiment.on.clear();
    again(state)
}

/// Calls off what is no longer to be tried.
fn again(state: &mut State) -> Vec<Effect> {
    let untried = pins::untried(state);
    if untried == state.tried {
        return Vec::new();
    }
    state.experiment.trying = None;
    state.tried.clone_from(&untried);
    vec![Effect::Send(Command::Try(untried))]
}

/// Asks where the document is to be written; calls off the one that is being written.
pub(super) fn document(state: &mut State) -> Vec<Effect> {
    if let Some(document) = &mut state.experiment.document {
        document.called_off = true;
        return vec![Effect::Send(Command::StopPaper)];
    }
    state.purpose = Purpose::Folder;
    state.entry = Some(Entry::of("paper"));
    Vec::new()
}

/// Begins to write the document to a folder.
pub(super) fn begin(state: &mut State, folder: &str) -> Vec<Effect> {
    state.entry = None;
    state.experiment.document = Some(Document { folder: folder.to_owned(), done: 0, total: 0, called_off: false });
    update::say(state, format!("writing the paper's document to {folder}; X calls it off"));
    vec![Effect::Send(Command::Paper(folder.into()))]
}

/// Takes in news of the document.
pub(super) fn told(state: &mut State, told: Told) {
    match told {
        Told::Progress(done, total) => {
            if let Some(document) = &mut state.experiment.document {
                (document.done, document.total) = (done, total);
            }
        }
        Told::Done(outcome) => {
            let Some(document) = state.experiment.document.take() else { return };
            let text = match &outcome {
                Ok(files) => format!("{}/paper.md is written, with {files} files", document.folder),
                Err(reason) => format!("{}: {reason}", document.folder),
            };
            leave::notice(state, text, outcome.is_err() && !document.called_off);
        }
    }
}

/// Has Figure 1 made of what is on the screen.
fn vary(state: &mut State) -> Vec<Effect> {
    let subject = state.subject();
    state.experiment.varying = Some(Varying::of(subject.clone()));
    vec![Effect::Send(Command::Vary(subject))]
}

/// Has it made again where it is there: the files it is of may be others now. What did not change is known.
pub(super) fn vary_again(state: &mut State) -> Vec<Effect> {
    if state.variation().is_some() { vary(state) } else { Vec::new() }
}

/// Takes in how far it is.
pub(super) fn varying(state: &mut State, subject: &Subject, done: usize) {
    if let Some(varying) = state.experiment.varying.as_mut().filter(|varying| varying.subject == *subject) {
        varying.done = done;
    }
}

/// Takes it in.
pub(super) fn varied(state: &mut State, varied: Arc<Varied>) {
    if state.experiment.varying.take_if(|varying| varying.subject == varied.subject).is_some() {
        state.experiment.varied = Some(varied);
    }
}

/// True while the view shows the precision and recall of the screen's parameters.
pub(super) fn asks_retrieval(state: &State) -> bool {
    state.view == View::Curves && state.experiment.face == Face::Recall
}

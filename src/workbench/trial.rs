//! The study's figures under other parameters than those on the screen: of pins, and of the values of a sweep.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use crate::{
    query::{Answer, Finding, Host, Question, Settings},
    selection::SelCount,
    study::{Boosted, Climbed, FirstK, Method, Score, mcnemar, why::Decisions},
    watch::Watch,
};

/// What a method decided, with the place of each row's model.
pub type Decided = (Arc<Decisions>, Arc<Vec<usize>>);

/// The figures of the study under some parameters, as far as they are there.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// Curves of the first k.
    pub first_k: Option<Arc<FirstK>>,
    /// Hill climbing for ε.
    pub climb_error: Option<Arc<Climbed>>,
    /// Hill climbing for mean ADR.
    pub climb_adr: Option<Arc<Climbed>>,
    /// AdaBoost.
    pub boosted: Option<Arc<Boosted>>,
    /// By method, in the order of [`Method::ALL`].
    pub decided: [Option<Decided>; Method::ALL.len()],
}

impl Figures {
    /// Those of an answer that are not stale; the decisions are not among them.
    #[must_use]
    pub fn of(answer: &Answer) -> Self {
        Self {
            first_k: answer.first_k.value.clone().filter(|_| !answer.first_k.stale),
            climb_error: answer.climb_error.value.clone().filter(|_| !answer.climb_error.stale),
            climb_adr: answer.climb_adr.value.clone().filter(|_| !answer.climb_adr.stale),
            boosted: answer.boosted.value.clone().filter(|_| !answer.boosted.stale),
            decided: Default::default(),
        }
    }

    /// True when nothing is missing.
    #[must_use]
    pub fn complete(&self) -> bool {
        self.first_k.is_some()
            && self.climb_error.is_some()
            && self.climb_adr.is_some()
            && self.boosted.is_some()
            && self.decided.iter().all(Option::is_some)
    }

    /// ε of a method.
    #[must_use]
    pub fn error(&self, method: Method, settings: &Settings) -> Option<Score> {
        match method {
            Method::FirstK => self.first_k.as_ref()?.error.at(settings.k),
            Method::BestK => self.first_k.as_ref().and_then(|first_k| first_k.error.at(first_k.best_error)),
            Method::ClimbError => self.climb_error.as_ref().map(|climbed| climbed.error),
            Method::ClimbAdr => self.climb_adr.as_ref().map(|climbed| climbed.error),
            Method::Boost => self.boosted.as_ref().map(|boosted| boosted.error),
        }
    }

    /// Mean ADR of a method; AdaBoost ranks no models.
    #[must_use]
    pub fn adr(&self, method: Method, settings: &Settings) -> Option<Score> {
        match method {
            Method::FirstK => self.first_k.as_ref()?.adr.at(settings.k),
            Method::BestK => self.first_k.as_ref().and_then(|first_k| first_k.adr.at(first_k.best_adr)),
            Method::ClimbError => self.climb_error.as_ref().map(|climbed| climbed.adr),
            Method::ClimbAdr => self.climb_adr.as_ref().map(|climbed| climbed.adr),
            Method::Boost => None,
        }
    }

    /// ε of a method on D and on Q, its mean ADR on D and on Q.
    #[must_use]
    pub fn scores(&self, method: Method, settings: &Settings) -> [Option<f64>; 4] {
        let (error, adr) = (self.error(method, settings), self.adr(method, settings));
        let train = |score: Option<Score>| score.map(|score| score.train);
        let query = |score: Option<Score>| score.and_then(|score| score.query);
        [train(error), query(error), train(adr), query(adr)]
    }

    /// How many eigenvalues a method uses.
    #[must_use]
    pub fn selected(&self, method: Method, settings: &Settings) -> Option<f64> {
        match method {
            Method::FirstK => Some(settings.k as f64),
            Method::BestK => self.first_k.as_ref().map(|first_k| first_k.best_error as f64),
            Method::ClimbError => self.climb_error.as_ref().map(|climbed| climbed.climb.selected.len() as f64),
            Method::ClimbAdr => self.climb_adr.as_ref().map(|climbed| climbed.climb.selected.len() as f64),
            Method::Boost => self.boosted.as_ref().map(|boosted| match settings.sel {
                SelCount::Chosen => boosted.mean_chosen,
                SelCount::Ties => boosted.mean_ties,
            }),
        }
    }

    /// The p of the paired test ([`mcnemar`]) on one side of the split between these figures and others: how likely
    /// decisions that are equally often right differ at least as much. None where one of the two is missing or the
    /// models differ.
    #[must_use]
    pub fn test(&self, other: &Self, method: Method, queries: bool) -> Option<f64> {
        let at = method as usize;
        let ((mine, places), (others, others_places)) = (self.decided[at].as_ref()?, other.decided[at].as_ref()?);
        let range = if queries { mine.train..mine.truth.len() } else { 0..mine.train };
        if range.is_empty() || places != others_places || (mine.train, &mine.truth) != (others.train, &others.truth) {
            return None;
        }
        let wrong = |decisions: &Decisions| {
            range.clone().map(|model| decisions.decided[model] != decisions.truth[model]).collect::<Vec<_>>()
        };
        Some(mcnemar(&wrong(mine), &wrong(others)))
    }
}

/// Figures under some parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct Trial {
    /// The parameters.
    pub settings: Settings,
    /// The figures.
    pub figures: Figures,
}

/// Says to a trial that it is no longer wanted.
#[derive(Debug, Clone, Default)]
pub struct Recall(Arc<AtomicBool>);

impl Recall {
    /// Calls it off.
    pub fn call(&self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Watch for Recall {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Progress is told so often at most.
const OFTEN: Duration = Duration::from_millis(150);

/// A recall that also tells progress, not too often.
pub(super) struct Watching<F> {
    recall: Recall,
    tell: F,
    last: Mutex<Option<Instant>>,
}

impl<F: Fn(usize, usize) + Sync> Watching<F> {
    pub(super) const fn new(recall: Recall, tell: F) -> Self {
        Self { recall, tell, last: Mutex::new(None) }
    }
}

impl<F: Fn(usize, usize) + Sync> Watch for Watching<F> {
    fn cancelled(&self) -> bool {
        self.recall.cancelled()
    }

    fn progress(&self, done: usize, total: usize) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.is_none_or(|last| last.elapsed() >= OFTEN) {
            *last = Some(Instant::now());
            (self.tell)(done, total);
        }
    }
}

/// Makes the study under each of the parameters, one after the other, with a host of their own. Ends early when it is
/// called off. `trying` hears how far the spectra of each are.
pub(super) fn run(
    mut host: Host,
    all: Vec<Settings>,
    recall: &Recall,
    tell: &dyn Fn(Trial),
    trying: &(dyn Fn(&Settings, usize, usize) + Sync),
) {
    for settings in all {
        host.set(settings.clone());
        let watch = Watching::new(recall.clone(), |done, total| trying(&settings, done, total));
        let Ok(answer) = host.run(&watch) else { return };
        let mut figures = Figures::of(&answer);
        if let Some(members) = host.members() {
            for method in Method::ALL.into_iter().take_while(|_| !recall.cancelled()) {
                let reply = host.ask(members.clone(), Question::Decisions(method)).answer();
                if let Some((Ok(Finding::Decisions(decisions)), places)) = reply.map(|r| (r.finding, r.places)) {
                    figures.decided[method as usize] = Some((decisions, places));
                }
            }
        }
        tell(Trial { settings, figures });
    }
}

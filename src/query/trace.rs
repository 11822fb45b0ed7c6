//! What ran, what came from disk, and how long it took.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use super::{Source, Stage};

/// A tracked function of the database, as the trace names it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Query {
    /// A file's bytes → their hash.
    Content,
    /// Bytes → facts of the mesh.
    Facts,
    /// Mesh → certified eigenvalues.
    Spectrum,
    /// Eigenvalues of all members → feature vectors.
    Sample,
    /// ε and mean ADR for every k.
    FirstK,
    /// Hill climbing.
    Climb,
    /// AdaBoost's rounds.
    Boost,
    /// AdaBoost's ε on models held out.
    HeldOut,
    /// The first-k curves, cut to kmax.
    FirstKRows,
    /// A hill climbing's result at kmax with its scores.
    ClimbRows,
    /// AdaBoost cut to T rounds, with its scores.
    BoostRows,
    /// Figures 4 and 5.
    MarkRows,
    /// Tables 1 to 4.
    TableRows,
    /// What a method decides for every model.
    DecisionRows,
    /// The neighbours of a model.
    NeighbourRows,
    /// What the strong classifiers say of a model.
    VoteRows,
    /// Where the models of a class keep together.
    SharedRows,
    /// Which eigenvalues tell two classes apart.
    ApartRows,
    /// Table 5 and Figure 7.
    RetrievalRows,
    /// Nested cross-validation.
    HonestRows,
    /// Nearest neighbours tuned inside the fold.
    TunedRows,
    /// The paper's figures on other splits.
    SplitRows,
}

/// Work done at one stage.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Tally {
    pub(crate) ran: usize,
    pub(crate) disk: usize,
    pub(crate) busy: Duration,
    /// Of this, the time of what ran.
    pub(crate) ran_busy: Duration,
}

#[derive(Debug, Default)]
struct Record {
    tallies: BTreeMap<Stage, Tally>,
    /// What one value of a stage cost when the stage last ran; kept when a new account is started.
    costs: BTreeMap<Stage, Duration>,
    executed: Vec<Query>,
}

/// Collects what happens on every thread. Clones share one record.
#[derive(Debug, Clone, Default)]
pub struct Trace(Arc<Mutex<Record>>);

impl Trace {
    fn record(&self) -> MutexGuard<'_, Record> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Counts one value made at `stage`.
    pub(crate) fn made(&self, stage: Stage, source: Source, busy: Duration) {
        let mut record = self.record();
        let tally = record.tallies.entry(stage).or_default();
        match source {
            Source::Ran => {
                tally.ran += 1;
                tally.ran_busy += busy;
            }
            Source::Disk => tally.disk += 1,
            Source::Memory => {}
        }
        tally.busy += busy;
        if source == Source::Ran {
            record.costs.insert(stage, busy);
        }
    }

    /// What one value of a stage cost when the stage last ran; nothing where it never did.
    pub(crate) fn cost(&self, stage: Stage) -> Duration {
        self.record().costs.get(&stage).copied().unwrap_or_default()
    }

    /// Notes that the body of a tracked function ran to its end.
    pub(crate) fn executed(&self, query: Query) {
        self.record().executed.push(query);
    }

    /// Runs `body`, and counts it as one execution of `query` at `stage`.
    pub(crate) fn run<T>(&self, query: Query, stage: Stage, body: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let value = body();
        self.made(stage, Source::Ran, start.elapsed());
        self.executed(query);
        value
    }

    /// Runs `body`, which cuts a result of `stage` to what is shown: its time counts there, the stage itself did not
    /// run.
    pub(crate) fn cut<T>(&self, query: Query, stage: Stage, body: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let value = body();
        self.made(stage, Source::Memory, start.elapsed());
        self.executed(query);
        value
    }

    pub(crate) fn tally(&self, stage: Stage) -> Tally {
        self.record().tallies.get(&stage).copied().unwrap_or_default()
    }

    /// Starts a new account: after a change of a parameter or a file.
    pub(crate) fn restart(&self) {
        let mut record = self.record();
        *record = Record { costs: std::mem::take(&mut record.costs), ..Record::default() };
    }

    /// The tracked functions whose bodies ran since the account was started, in the order in which they ended.
    #[must_use]
    pub fn log(&self) -> Vec<Query> {
        self.record().executed.clone()
    }
}

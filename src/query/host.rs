//! The owner of the database and the pool: takes changes, hears the pool, says what is there.

use std::{
    collections::{HashMap, VecDeque},
    path::PathBuf,
    sync::{Arc, mpsc},
    time::Instant,
};

use salsa::Setter;
use thiserror::Error;

use super::{
    Part, Query, Settings, Source, Stage,
    db::{Database, Knobs, ModelFile},
    library::{Facts, Failure, Found, Library},
    pool::{Job, Listener, News, Pool, What},
    stamp::Stamp,
    trace::Trace,
};
use crate::{
    dataset::DataSet,
    mesh::Format,
    store::Store,
    study::{Boosted, Climbed, FirstK, Mark, Table},
};

mod studying;
mod telling;

/// What a host is made of.
#[derive(Debug, Clone)]
pub struct Config {
    /// The labelled models.
    pub data: DataSet,
    /// The parameters to begin with.
    pub settings: Settings,
    /// Where spectra are kept between sessions.
    pub store: Store,
    /// How many models are solved at once, each on one thread.
    pub threads: usize,
}

/// The run was cancelled; what was finished is kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("interrupted")]
pub struct Cancelled;

#[derive(Debug)]
struct Row {
    file: ModelFile,
    job: Option<Job>,
    facts: Option<Arc<Facts>>,
    found: Option<Result<Solved, (Stage, Failure)>>,
    working: Option<(usize, usize)>,
}

#[derive(Debug, Clone)]
struct Solved {
    found: Found,
    eigenvalues: Arc<Vec<f64>>,
}

/// The newest values of the study.
#[derive(Debug, Default)]
struct Shown {
    places: Arc<Vec<usize>>,
    first_k: Part<FirstK>,
    climb_error: Part<Climbed>,
    climb_adr: Part<Climbed>,
    boosted: Part<Boosted>,
    marks: Part<Vec<Vec<Mark>>>,
    tables: Part<Vec<Table>>,
}

/// The incremental instrument: owns the inputs, the database and the pool.
pub struct Host {
    database: Database,
    library: Library,
    pool: Pool,
    news: Option<mpsc::Receiver<News>>,
    files: HashMap<PathBuf, ModelFile>,
    data: DataSet,
    classes: Arc<Vec<String>>,
    settings: Settings,
    /// The greatest kmax so far: a smaller one is a slice of it.
    reach: usize,
    rows: Vec<Row>,
    list: u64,
    stopped: bool,
    shown: Shown,
    failure: Option<Failure>,
    solved_at: VecDeque<Instant>,
    serial: u64,
}

impl std::fmt::Debug for Host {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Host").field("data", &self.data.root).field("settings", &self.settings).finish_non_exhaustive()
    }
}

impl Host {
    /// A host that hears its own pool: for [`Host::run`].
    #[must_use]
    pub fn new(config: Config) -> Self {
        let (sender, news) = mpsc::channel();
        let listener: Listener = Arc::new(move |news| {
            // Without a receiver the host is being dropped.
            let _ = sender.send(news);
        });
        Self { news: Some(news), ..Self::open(config, false, listener) }
    }

    /// A host behind a screen: its pool leaves the processor to the screen, and tells `listener`; the news must come
    /// back through [`Host::hear`].
    pub(crate) fn with_listener(config: Config, listener: Listener) -> Self {
        Self::open(config, true, listener)
    }

    fn open(config: Config, polite: bool, listener: Listener) -> Self {
        let Config { data, settings, store, threads } = config;
        let library = Library::open(store, Trace::default(), &data.root);
        Self::over(library, data, settings, (threads, polite), listener)
    }

    /// A host on the same models for other parameters: it shares all that is costly, and has a database, a pool and an
    /// account of its own.
    pub(crate) fn beside(&self, settings: Settings) -> Self {
        let (sender, news) = mpsc::channel();
        let listener: Listener = Arc::new(move |news| {
            let _ = sender.send(news);
        });
        let library = self.library.apart();
        Self {
            news: Some(news),
            ..Self::over(library, self.data.clone(), settings, (self.pool.size(), true), listener)
        }
    }

    fn over(
        library: Library,
        data: DataSet,
        settings: Settings,
        (threads, polite): (usize, bool),
        listener: Listener,
    ) -> Self {
        let database = Database::new(library.clone());
        let classes = Arc::new(data.classes.clone());
        Knobs::new(
            &database,
            settings.problem(),
            settings.kmax,
            settings.normalisation,
            settings.weights,
            settings.distance,
            settings.search,
            settings.weak,
            settings.stop,
            settings.k,
            settings.rounds,
            settings.sel,
            Arc::clone(&classes),
        );
        let pool = Pool::start(threads, polite, library.clone(), listener);
        let mut host = Self {
            database,
            library,
            pool,
            news: None,
            files: HashMap::new(),
            data: DataSet { models: Vec::new(), ..data.clone() },
            classes,
            reach: settings.kmax,
            settings,
            rows: Vec::new(),
            list: 0,
            stopped: false,
            shown: Shown::default(),
            failure: None,
            solved_at: VecDeque::new(),
            serial: 0,
        };
        host.update(data);
        host
    }

    /// The parameters in force.
    #[must_use]
    pub const fn settings(&self) -> &Settings {
        &self.settings
    }

    /// How many models are solved at once.
    #[must_use]
    pub fn threads(&self) -> usize {
        self.pool.size()
    }

    /// How the folder was understood, in one line.
    #[must_use]
    pub fn layout(&self) -> &str {
        &self.data.layout
    }

    /// Class names.
    #[must_use]
    pub fn classes(&self) -> &[String] {
        &self.classes
    }

    /// The tracked functions that ran since the last change.
    #[must_use]
    pub fn log(&self) -> Vec<Query> {
        self.library.trace().log()
    }

    /// Turns the parameters to `settings`. Returns whether anything changed.
    ///
    /// Waits until computations under way have noticed (at most some 10 ms); solves are left alone unless they are no
    /// longer wanted.
    pub fn set(&mut self, settings: Settings) -> bool {
        if settings == self.settings {
            return false;
        }
        let old = std::mem::replace(&mut self.settings, settings);
        self.reach = self.reach.max(self.settings.kmax);
        let new = &self.settings;
        self.library.trace().restart();
        self.database.write(|db| {
            let knobs = Knobs::get(db);
            // Setters do not compare, and an input that is set to its own value still runs all that reads it.
            if old.problem() != new.problem() {
                knobs.set_problem(db).to(new.problem());
            }
            if old.kmax != new.kmax {
                knobs.set_kmax(db).to(new.kmax);
            }
            if old.search != new.search {
                knobs.set_search(db).to(new.search);
            }
            if old.weak != new.weak {
                knobs.set_weak(db).to(new.weak);
            }
            if old.stop != new.stop {
                knobs.set_stop(db).to(new.stop);
            }
            if old.weights != new.weights {
                knobs.set_scale(db).to(new.weights);
            }
            if old.normalisation != new.normalisation {
                knobs.set_normalisation(db).to(new.normalisation);
            }
            if old.distance != new.distance {
                knobs.set_distance(db).to(new.distance);
            }
            if old.k != new.k {
                knobs.set_k(db).to(new.k);
            }
            if old.rounds != new.rounds {
                knobs.set_rounds(db).to(new.rounds);
            }
            if old.sel != new.sel {
                knobs.set_sel(db).to(new.sel);
            }
        });
        let problem = self.settings.problem();
        if problem != old.problem() {
            for row in &mut self.rows {
                row.found = None;
                row.working = None;
            }
        }
        if problem != old.problem() || self.settings.kmax != old.kmax {
            self.want();
        }
        self.shown.outdate();
        self.failure = None;
        true
    }

    /// Takes another look at the data set: `data` is what is in the folder now.
    pub fn update(&mut self, data: DataSet) {
        self.library.trace().restart();
        let mut old: HashMap<ModelFile, Row> = self.rows.drain(..).map(|row| (row.file, row)).collect();
        let classes = Arc::new(data.classes.clone());
        let files = &mut self.files;
        let rows = &mut self.rows;
        let troubled = self.failure.is_some();
        let doubted = self.library.doubt_fresh();
        let same_classes = *classes == *self.classes;
        self.database.write(|db| {
            if !same_classes {
                let knobs = Knobs::get(db);
                knobs.set_classes(db).to(Arc::clone(&classes));
            }
            for model in &data.models {
                let Some(format) = Format::of(&model.path) else { continue };
                let stamp = Stamp::of(&model.path);
                let file = *files.entry(model.path.clone()).or_insert_with_key(|path| {
                    ModelFile::new(db, path.clone(), format, model.class, model.role, stamp)
                });
                if file.class(db) != model.class {
                    file.set_class(db).to(model.class);
                }
                if file.role(db) != model.role {
                    file.set_role(db).to(model.role);
                }
                // What failed at its bytes is read again: the file may have been in the middle of a change.
                let failed = troubled || old.get(&file).is_some_and(Row::unread);
                let moved = file.stamp(db) != stamp;
                if moved || failed || doubted.contains(&model.path) {
                    file.set_stamp(db).to(stamp);
                }
                let fresh = Row { file, job: None, facts: None, found: None, working: None };
                rows.push(old.remove(&file).filter(|_| !moved).unwrap_or(fresh));
            }
        });
        self.data = data;
        self.classes = classes;
        self.failure = None;
        self.shown.outdate();
        self.want();
    }

    /// Stops the solving; what is finished is kept and can be used.
    pub fn stop(&mut self) {
        self.stopped = true;
        self.list = self.pool.want(Vec::new());
        for row in &mut self.rows {
            row.working = None;
        }
    }

    /// Goes on after [`Host::stop`].
    pub fn resume(&mut self) {
        self.stopped = false;
        self.want();
    }

    /// Whether [`Host::stop`] is in force.
    #[must_use]
    pub const fn stopped(&self) -> bool {
        self.stopped
    }

    /// Tells the pool what is wanted now.
    fn want(&mut self) {
        let (problem, count) = (self.settings.problem(), self.settings.kmax);
        let mut within = HashMap::<u32, usize>::new();
        let mut jobs = Vec::with_capacity(self.rows.len());
        for (slot, (row, model)) in self.rows.iter_mut().zip(&self.data.models).enumerate() {
            let Some(format) = Format::of(&model.path) else { continue };
            let stamp = row.file.stamp(&self.database);
            let job = Job { path: model.path.clone(), format, stamp, problem, count };
            row.job = Some(job.clone());
            let turn = within.entry(model.class).or_default();
            jobs.push((*turn, slot, job));
            *turn += 1;
        }
        if self.stopped {
            return;
        }
        // One model of each class in turn: the study is of use long before the last spectrum is there.
        jobs.sort_by_key(|&(turn, slot, _)| (turn, slot));
        self.list = self.pool.want(jobs.into_iter().map(|(_, slot, job)| (slot, job)).collect());
    }

    /// Takes in what the pool has told. Returns whether a model was finished by it.
    pub(crate) fn hear(&mut self, news: News) -> bool {
        if news.list != self.list {
            return false;
        }
        let Some(row) = self.rows.get_mut(news.slot) else { return false };
        match news.what {
            What::Read(facts) => {
                row.facts = Some(facts);
                row.working = Some((0, self.settings.kmax));
                false
            }
            What::Progress { done, total } => {
                row.working = Some((done, total));
                false
            }
            What::Done { facts, found } => {
                row.working = None;
                row.facts = facts.or(row.facts.take());
                if found.as_ref().is_ok_and(|found| found.source == Source::Ran) {
                    self.solved_at.push_back(Instant::now());
                    if self.solved_at.len() > 64 {
                        self.solved_at.pop_front();
                    }
                }
                row.found = Some(found.map(|mut found| {
                    // What the pool found in memory was come by earlier in this session.
                    if let (Source::Memory, Some(Ok(before))) = (found.source, &row.found) {
                        found.source = before.found.source;
                    }
                    let eigenvalues = Arc::new(found.spectrum.eigenvalues());
                    Solved { found, eigenvalues }
                }));
                true
            }
        }
    }

    /// Whether every model is either ready or out.
    pub(crate) fn complete(&self) -> bool {
        self.rows.iter().all(|row| match &row.found {
            Some(Ok(solved)) => solved.eigenvalues.len() >= self.settings.kmax.min(solved.found.spectrum.order),
            Some(Err(_)) => true,
            None => false,
        })
    }

    /// Whether some files could not be read as they were when the folder was last looked at.
    pub(crate) fn unread(&self) -> bool {
        self.failure.is_some() || self.rows.iter().any(Row::unread)
    }

    /// Says something to the user besides the answers.
    pub(crate) fn warn(&mut self, warning: &str) {
        self.failure = Some(warning.into());
    }

    /// Keeps what the next session needs to start quickly.
    pub(crate) fn save(&self) {
        self.library.save_contents();
    }
}

impl<T> Part<T> {
    fn fresh(value: Arc<T>) -> Self {
        Self { value: Some(value), stale: false }
    }
}

impl Shown {
    /// Marks every value as one of earlier parameters.
    fn outdate(&mut self) {
        self.first_k.stale = true;
        self.climb_error.stale = true;
        self.climb_adr.stale = true;
        self.boosted.stale = true;
        self.marks.stale = true;
        self.tables.stale = true;
    }
}

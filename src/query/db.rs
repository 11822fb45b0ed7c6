//! The salsa database: inputs, keys, and the pipeline's stages as tracked functions.
//!
//! A stage is memoised under all it depends on (its key), so going back to an earlier value of a parameter finds the
//! earlier result in memory. [`super::rows`] holds the thin functions above it that read the parameters.

use std::{
    path::PathBuf,
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
};

use super::{
    Problem, Stage,
    library::{Facts, Failure, FileAt, Library, Missing},
    stamp::{ContentHash, Stamp},
    trace::{Query, Trace},
};
use crate::{
    dataset::Role,
    mesh::Format,
    metrics::{Distance, Features, Scale},
    selection::{self, Climb, Cost, Search, SelCount, Stop, Strong, Weak},
    spectrum::{Normalisation, Spectrum},
    study::{self, FirstK, Sample},
    watch::Watch,
};

/// What tracked functions may ask for besides their inputs.
#[salsa::db]
pub(crate) trait Db: salsa::Database {
    fn library(&self) -> &Library;
    fn revoked(&self) -> &Revoked;
}

/// True while the database is about to be written, so that kernels which know no database can stop.
#[derive(Debug, Clone, Default)]
pub(crate) struct Revoked(Arc<AtomicBool>);

impl Watch for Revoked {
    fn cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The database. Clones share it; every clone must be dropped before a write goes through.
#[salsa::db]
#[derive(Clone)]
pub(crate) struct Database {
    storage: salsa::Storage<Self>,
    library: Library,
    revoked: Revoked,
}

#[salsa::db]
impl salsa::Database for Database {}

#[salsa::db]
impl Db for Database {
    fn library(&self) -> &Library {
        &self.library
    }

    fn revoked(&self) -> &Revoked {
        &self.revoked
    }
}

impl Database {
    pub(crate) fn new(library: Library) -> Self {
        let revoked = Revoked::default();
        let flag = revoked.clone();
        let storage = salsa::Storage::new(Some(Box::new(move |event: salsa::Event| {
            if matches!(event.kind, salsa::EventKind::DidSetCancellationFlag) {
                flag.0.store(true, Ordering::Relaxed);
            }
        })));
        Self { storage, library, revoked }
    }

    /// Writes to the inputs. Waits until the computations under way have noticed.
    pub(crate) fn write<T>(&mut self, write: impl FnOnce(&mut Self) -> T) -> T {
        let value = write(self);
        self.revoked.0.store(false, Ordering::Relaxed);
        value
    }
}

/// A mesh file and its labels.
#[salsa::input]
#[derive(Debug)]
pub(crate) struct ModelFile {
    #[returns(ref)]
    pub(crate) path: PathBuf,
    #[returns(copy)]
    pub(crate) format: Format,
    #[returns(copy)]
    pub(crate) class: u32,
    #[returns(copy)]
    pub(crate) role: Role,
    #[returns(copy)]
    pub(crate) stamp: Option<Stamp>,
}

/// The parameters, each its own field: a function is run again only for those it reads.
#[salsa::input(singleton)]
#[derive(Debug)]
pub(crate) struct Knobs {
    #[returns(copy)]
    pub(crate) problem: Problem,
    #[returns(copy)]
    pub(crate) kmax: usize,
    #[returns(copy)]
    pub(crate) normalisation: Normalisation,
    #[returns(copy)]
    pub(crate) scale: Scale,
    #[returns(copy)]
    pub(crate) distance: Distance,
    #[returns(copy)]
    pub(crate) search: Search,
    #[returns(copy)]
    pub(crate) weak: Weak,
    #[returns(copy)]
    pub(crate) stop: Stop,
    #[returns(copy)]
    pub(crate) k: usize,
    #[returns(copy)]
    pub(crate) rounds: usize,
    #[returns(copy)]
    pub(crate) sel: SelCount,
    #[returns(ref)]
    pub(crate) classes: Arc<Vec<String>>,
}

/// Revisions after which a key that nothing asks for any more may be forgotten: so many turns of a knob can be taken
/// back from memory.
const REMEMBERED: usize = 64;

/// Some models whose spectra are there, and how many eigenvalues each of them has at least.
#[salsa::interned(revisions = REMEMBERED)]
#[derive(Debug)]
pub(crate) struct Cohort<'db> {
    #[returns(ref)]
    pub(crate) members: Arc<[ModelFile]>,
    #[returns(copy)]
    pub(crate) reach: usize,
}

/// One model's spectrum.
#[salsa::interned(revisions = REMEMBERED)]
#[derive(Debug)]
pub(crate) struct SpectrumKey<'db> {
    #[returns(copy)]
    pub(crate) file: ModelFile,
    #[returns(copy)]
    pub(crate) problem: Problem,
    #[returns(copy)]
    pub(crate) count: usize,
}

/// The features of a cohort.
#[salsa::interned(revisions = REMEMBERED)]
#[derive(Debug)]
pub(crate) struct SampleKey<'db> {
    #[returns(copy)]
    pub(crate) cohort: Cohort<'db>,
    #[returns(copy)]
    pub(crate) problem: Problem,
    #[returns(copy)]
    pub(crate) normalisation: Normalisation,
    #[returns(copy)]
    pub(crate) scale: Scale,
    /// How many features each model has.
    #[returns(copy)]
    pub(crate) width: usize,
}

/// First-k on a sample.
#[salsa::interned(revisions = REMEMBERED)]
#[derive(Debug)]
pub(crate) struct FirstKKey<'db> {
    #[returns(copy)]
    pub(crate) sample: SampleKey<'db>,
    #[returns(copy)]
    pub(crate) distance: Distance,
}

/// A hill climbing on a sample.
#[salsa::interned(revisions = REMEMBERED)]
#[derive(Debug)]
pub(crate) struct ClimbKey<'db> {
    #[returns(copy)]
    pub(crate) sample: SampleKey<'db>,
    #[returns(copy)]
    pub(crate) distance: Distance,
    #[returns(copy)]
    pub(crate) cost: Cost,
    #[returns(copy)]
    pub(crate) search: Search,
}

/// A run of AdaBoost on a sample.
#[salsa::interned(revisions = REMEMBERED)]
#[derive(Debug)]
pub(crate) struct BoostKey<'db> {
    #[returns(copy)]
    pub(crate) sample: SampleKey<'db>,
    #[returns(copy)]
    pub(crate) weak: Weak,
    #[returns(copy)]
    pub(crate) rounds: usize,
}

pub(super) fn trace(db: &dyn Db) -> &Trace {
    db.library().trace()
}

/// Leaves a computation that is no longer wanted: a kernel says `Cancelled` only once a write is waiting.
pub(super) fn leave(db: &dyn Db) -> ! {
    loop {
        db.unwind_if_revision_cancelled();
        std::thread::yield_now();
    }
}

/// The file's bytes → their hash.
#[salsa::tracked(returns(clone))]
pub(crate) fn content(db: &dyn Db, file: ModelFile) -> Result<ContentHash, Failure> {
    let stamp = file.stamp(db).ok_or_else(|| Failure::from("the file is gone"));
    let content = stamp.and_then(|stamp| db.library().content(file.path(db), stamp));
    trace(db).executed(Query::Content);
    content
}

fn file_at(db: &dyn Db, file: ModelFile) -> Result<FileAt<'_>, Failure> {
    Ok(FileAt { path: file.path(db), format: file.format(db), content: content(db, file)? })
}

/// The file's bytes → what is known of the mesh.
#[salsa::tracked(returns(clone))]
pub(crate) fn facts(db: &dyn Db, file: ModelFile) -> Result<Arc<Facts>, Failure> {
    let facts = file_at(db, file).and_then(|file| db.library().facts(file).map_err(|failure| failure.reason));
    trace(db).executed(Query::Facts);
    facts
}

/// Mesh → certified eigenvalues, at least as many as the key says or all there are.
#[salsa::tracked(returns(clone))]
pub(crate) fn spectrum<'db>(db: &'db dyn Db, key: SpectrumKey<'db>) -> Result<Arc<Spectrum>, Failure> {
    let file = key.file(db);
    let found = facts(db, file).and_then(|facts| {
        let file = file_at(db, file)?;
        match db.library().spectrum(file, (&facts, None), key.problem(db), key.count(db), db.revoked()) {
            Ok(found) => Ok(found.spectrum),
            Err(Missing::Failed(reason) | Missing::Unread(reason)) => Err(reason),
            Err(Missing::Cancelled) => leave(db),
        }
    });
    trace(db).executed(Query::Spectrum);
    found
}

/// Eigenvalues of all members → their features.
#[salsa::tracked(returns(clone), lru = 16)]
pub(crate) fn sample<'db>(db: &'db dyn Db, key: SampleKey<'db>) -> Result<Arc<Sample>, Failure> {
    let cohort = key.cohort(db);
    let spectra = cohort.members(db).iter().map(|&file| {
        let key = SpectrumKey::new(db, file, key.problem(db), cohort.reach(db));
        // The others' spectra are there; this one's reason must say whose it is.
        let named = |reason| Failure::from(format!("{}: {reason}", file.path(db).display()));
        spectrum(db, key).map(|spectrum| (file, spectrum)).map_err(named)
    });
    let spectra: Vec<_> = spectra.collect::<Result<_, _>>()?;
    Ok(trace(db).run(Query::Sample, Stage::Features, || {
        let side = |role: Role| {
            let side = spectra.iter().filter(|(file, _)| file.role(db) == role);
            let rows = side.clone().map(|(_, spectrum)| {
                key.normalisation(db).apply(&spectrum.eigenvalues(), spectrum.measure, key.width(db))
            });
            (Features::from_rows(rows), side.map(|(file, _)| file.class(db)).collect())
        };
        let (train, train_labels) = side(Role::Train);
        let (query, query_labels) = side(Role::Query);
        let classes = Knobs::get(db).classes(db).len();
        Arc::new(key.scale(db).apply(&Sample { train, train_labels, query, query_labels, classes }))
    }))
}

/// ε and mean ADR for every k up to the sample's width.
#[salsa::tracked(returns(clone))]
pub(crate) fn first_k<'db>(db: &'db dyn Db, key: FirstKKey<'db>) -> Result<Arc<FirstK>, Failure> {
    let sample = sample(db, key.sample(db))?;
    Ok(trace(db).run(Query::FirstK, Stage::FirstK, || {
        let first_k = study::first_k(&sample, key.distance(db), db.revoked());
        Arc::new(first_k.unwrap_or_else(|_| leave(db)))
    }))
}

/// Hill climbing over all of the sample's features.
#[salsa::tracked(returns(clone))]
pub(crate) fn climb<'db>(db: &'db dyn Db, key: ClimbKey<'db>) -> Result<Arc<Climb>, Failure> {
    let sample = sample(db, key.sample(db))?;
    let stage = climb_stage(key.cost(db));
    Ok(trace(db).run(Query::Climb, stage, || {
        let climb = selection::climb_by(&sample, key.distance(db), key.cost(db), key.search(db), db.revoked());
        Arc::new(climb.unwrap_or_else(|_| leave(db)))
    }))
}

pub(crate) fn climb_stage(cost: Cost) -> Stage {
    match cost {
        Cost::Error => Stage::ClimbError,
        Cost::Adr => Stage::ClimbAdr,
    }
}

/// AdaBoost for every class over all of the sample's features.
#[salsa::tracked(returns(clone))]
pub(crate) fn boost<'db>(db: &'db dyn Db, key: BoostKey<'db>) -> Result<Arc<Vec<Strong>>, Failure> {
    let sample = sample(db, key.sample(db))?;
    Ok(trace(db).run(Query::Boost, Stage::Boost, || {
        let strong = selection::boost_by(&sample, key.rounds(db), key.weak(db), db.revoked());
        Arc::new(strong.unwrap_or_else(|_| leave(db)))
    }))
}

/// AdaBoost's ε on models held out of an inner run, after 1… rounds.
#[salsa::tracked(returns(clone))]
pub(crate) fn held_out<'db>(db: &'db dyn Db, key: BoostKey<'db>) -> Result<Arc<Vec<f64>>, Failure> {
    let sample = sample(db, key.sample(db))?;
    Ok(trace(db).run(Query::HeldOut, Stage::Boost, || {
        let errors = selection::held_out(&sample, key.rounds(db), key.weak(db), db.revoked());
        Arc::new(errors.unwrap_or_else(|_| leave(db)))
    }))
}

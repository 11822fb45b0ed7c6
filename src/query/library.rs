//! Everything that is costly to make, kept in memory and in the store: content hashes, facts of meshes, spectra.
//!
//! Each value is a pure function of its key, so it does not matter who made it, when, or in which session. The pool
//! fills the library, the tracked functions of the database read from it. Here are the spectra, in `reading` what comes
//! before them.

use std::{
    cell::Cell,
    collections::{HashMap, HashSet},
    path::{Path, PathBuf},
    sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize};

pub(super) use self::reading::{prepare, read};
use super::{
    Problem, Source, Stage,
    costs::Costs,
    stamp::{ContentHash, Stamp},
    trace::Trace,
};
use crate::{
    mesh::{Format, GeometryHash, Mesh, Survey},
    spectrum::{self, Band, Crew, Request, Spectrum, SpectrumError},
    store::{Key, Store},
    watch::Watch,
};

mod reading;

/// Why a model takes no part, in one line.
pub type Failure = Arc<str>;

/// What is known of a mesh without its vertices at hand.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Facts {
    /// Hash of the canonical geometry.
    pub geometry: GeometryHash,
    /// Sizes, topology and defects.
    pub survey: Survey,
}

impl Facts {
    /// Fails where no spectrum can be had of the mesh.
    pub(super) fn admit(&self) -> Result<(), Missing> {
        self.survey.refusal().map_or(Ok(()), |refusal| Err(Missing::Failed(refusal.into())))
    }
}

/// A mesh file at one moment: where it is and what is in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FileAt<'a> {
    pub(crate) path: &'a Path,
    pub(crate) format: Format,
    pub(crate) content: ContentHash,
}

/// A file that was looked into.
#[derive(Debug)]
pub(crate) struct Examined {
    /// The hash of its bytes.
    pub(crate) content: ContentHash,
    /// What is known of its mesh.
    pub(crate) facts: Arc<Facts>,
    /// The mesh in its canonical form, where it had to be read for that.
    pub(crate) mesh: Option<Mesh>,
}

/// A spectrum and how it was come by.
#[derive(Debug, Clone)]
pub(crate) struct Found {
    pub(crate) spectrum: Arc<Spectrum>,
    pub(crate) source: Source,
    /// Seconds the solve took, whenever it ran; 0 where that is not known.
    pub(crate) seconds: f64,
}

/// Why there is no spectrum.
#[derive(Debug, Clone)]
pub(crate) enum Missing {
    /// It is no longer wanted. Its finished bands are kept.
    Cancelled,
    /// There is none to be had.
    Failed(Failure),
    /// The file could not be read as it was when the folder was looked at.
    Unread(Failure),
}

/// The finished bands of a solve that takes long are stored so often, so that not even a crash loses more.
const KEEP: Duration = Duration::from_secs(1);

#[derive(Debug, Default)]
struct Memory {
    contents: HashMap<PathBuf, (Stamp, ContentHash)>,
    /// The same for files whose stamps are too fresh to be told from later ones: until the next look at the folder.
    fresh: HashMap<PathBuf, (Stamp, ContentHash)>,
    facts: HashMap<(ContentHash, Format), Result<Arc<Facts>, Failure>>,
    spectra: HashMap<(GeometryHash, Problem), Found>,
    refused: HashMap<(GeometryHash, Problem), Failure>,
    /// Spectra being solved now, so that two files of one shape are one solve.
    solving: HashSet<(GeometryHash, Problem)>,
    /// Bands of solves that were cancelled.
    begun: HashMap<(GeometryHash, Problem), Vec<Band>>,
    contents_unsaved: bool,
    /// The mesh that was looked at last.
    looked_at: Option<(Surface, Arc<Mesh>)>,
}

/// Which mesh: whose, and to how many vertices it was re-meshed.
type Surface = (ContentHash, Format, Option<usize>);

/// The library. Clones share it.
#[derive(Debug, Clone)]
pub(crate) struct Library(Arc<Inner>, Trace);

#[derive(Debug)]
struct Inner {
    memory: Mutex<Memory>,
    solved: Condvar,
    store: Store,
    index: Key,
    costs: Costs,
    crew: Crew,
}

impl Library {
    /// A library over `store`; the content hashes last seen below `root` are taken from there.
    pub(crate) fn open(store: Store, trace: Trace, root: &Path) -> Self {
        let index = Key::new("contents").field(root.as_os_str().as_encoded_bytes());
        let contents = store.get::<Vec<(PathBuf, Stamp, ContentHash)>>(&index).unwrap_or_default();
        let contents = contents.into_iter().map(|(path, stamp, content)| (path, (stamp, content))).collect();
        let memory = Mutex::new(Memory { contents, ..Memory::default() });
        let costs = Costs::open(&store, root);
        let crew = Crew::default();
        Self(Arc::new(Inner { memory, solved: Condvar::new(), store, index, costs, crew }), trace)
    }

    /// The same library with an account of its own: work for others is not counted here.
    pub(crate) fn apart(&self) -> Self {
        Self(Arc::clone(&self.0), Trace::default())
    }

    fn memory(&self) -> MutexGuard<'_, Memory> {
        self.0.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn trace(&self) -> &Trace {
        &self.1
    }

    /// What values cost when they were made.
    pub(super) fn costs(&self) -> &Costs {
        &self.0.costs
    }

    /// Threads without a model of their own help here.
    pub(crate) fn crew(&self) -> &Crew {
        &self.0.crew
    }

    pub(crate) fn store(&self) -> &Store {
        &self.0.store
    }

    /// Takes another look at files whose stamps could not stand for their content: returns their paths.
    pub(crate) fn doubt_fresh(&self) -> HashSet<PathBuf> {
        std::mem::take(&mut self.memory().fresh).into_keys().collect()
    }

    /// Writes the content hashes and what values cost for the next session, if there is something new.
    pub(crate) fn save_contents(&self) {
        self.costs().save(&self.0.store);
        let mut memory = self.memory();
        if std::mem::take(&mut memory.contents_unsaved) {
            let mut list: Vec<_> =
                memory.contents.iter().map(|(path, &(stamp, content))| (path.clone(), stamp, content)).collect();
            drop(memory);
            list.sort();
            self.0.store.put(&self.0.index, &list);
        }
    }

    /// At least `count` eigenvalues of the mesh in `file`, or all it has. It is read where `mesh` is none and no
    /// spectrum is known.
    pub(crate) fn spectrum(
        &self,
        file: FileAt<'_>,
        (facts, mesh): (&Facts, Option<Mesh>),
        problem: Problem,
        count: usize,
        watch: &dyn Watch,
    ) -> Result<Found, Missing> {
        facts.admit()?;
        self.made((facts.geometry, problem), count, || prepare(file, mesh, problem, watch), watch)
    }

    /// At least `count` eigenvalues of a mesh that is in no file, or all it has: known under its geometry, as if it
    /// were in one.
    pub(crate) fn spectrum_of(
        &self,
        mesh: &Mesh,
        problem: Problem,
        count: usize,
        watch: &dyn Watch,
    ) -> Result<Found, Missing> {
        self.made((mesh.hash(), problem), count, || Ok(problem.prepare(mesh.canonical(), watch)?), watch)
    }

    /// The spectrum from memory or the store, else of the mesh that `prepare` makes.
    fn made(
        &self,
        name: (GeometryHash, Problem),
        count: usize,
        prepare: impl FnOnce() -> Result<Mesh, Missing>,
        watch: &dyn Watch,
    ) -> Result<Found, Missing> {
        if let Some(known) = self.claim(name, count, watch)? {
            return Ok(known);
        }
        let _claim = Claim { library: self, name };
        self.find(name, count, prepare, watch)
    }

    /// The spectrum from memory, or none and the right to make it. Waits while another thread makes it.
    fn claim(&self, name: (GeometryHash, Problem), count: usize, watch: &dyn Watch) -> Result<Option<Found>, Missing> {
        let mut memory = self.memory();
        loop {
            if let Some(found) = memory.spectra.get(&name).filter(|found| suffices(&found.spectrum, count)) {
                return Ok(Some(Found { source: Source::Memory, ..found.clone() }));
            }
            if let Some(reason) = memory.refused.get(&name) {
                return Err(Missing::Failed(reason.clone()));
            }
            if watch.cancelled() {
                return Err(Missing::Cancelled);
            }
            if memory.solving.insert(name) {
                return Ok(None);
            }
            let waited = self.0.solved.wait_timeout(memory, Duration::from_millis(20));
            memory = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// From the store, else solved.
    fn find(
        &self,
        name: (GeometryHash, Problem),
        count: usize,
        prepare: impl FnOnce() -> Result<Mesh, Missing>,
        watch: &dyn Watch,
    ) -> Result<Found, Missing> {
        let start = Instant::now();
        let (geometry, problem) = name;
        let key_of = |kind| problem.key(Key::new(kind).number(u64::from(spectrum::KERNEL)).field(&geometry.0));
        let key = key_of("spectrum");
        let stored = self.0.store.get::<Spectrum>(&key);
        if let Some(spectrum) = stored.as_ref().filter(|spectrum| suffices(spectrum, count)) {
            let found = Found {
                spectrum: Arc::new(spectrum.clone()),
                source: Source::Disk,
                seconds: self.costs().of_spectrum(&key),
            };
            self.memory().spectra.insert(name, found.clone());
            self.trace().made(Stage::Spectrum, Source::Disk, start.elapsed());
            return Ok(found);
        }
        let begun_key = key_of("begun");
        let known = self.known_bands(name, stored, &begun_key);
        let mesh = prepare().map_err(|missing| match missing {
            Missing::Failed(reason) => self.refuse(name, &reason),
            other => other,
        })?;
        let kept = Cell::new(Instant::now());
        let keep = |bands: &[Band]| {
            if kept.get().elapsed() >= KEEP {
                self.0.store.put(&begun_key, &bands.to_vec());
                kept.set(Instant::now());
            }
        };
        let request = Request { count, known: &known, crew: Some(&self.0.crew), keep: &keep };
        match spectrum::solve_with(&mesh, problem.choice, &request, watch) {
            Ok(mut spectrum) => {
                spectrum.notes.splice(0..0, problem.note());
                self.0.store.update::<Spectrum>(&key, |stored| {
                    let longer = stored.as_ref().is_none_or(|stored| stored.count() < spectrum.count());
                    longer.then(|| spectrum.clone())
                });
                let seconds = self.costs().solved(&key, start.elapsed().as_secs_f64(), !known.is_empty());
                let found = Found { spectrum: Arc::new(spectrum), source: Source::Ran, seconds };
                let mut memory = self.memory();
                memory.begun.remove(&name);
                memory.spectra.insert(name, found.clone());
                drop(memory);
                self.trace().made(Stage::Spectrum, Source::Ran, start.elapsed());
                Ok(found)
            }
            Err(SpectrumError::Cancelled { finished }) => {
                if finished.len() > known.len() {
                    self.0.store.put(&begun_key, &finished);
                }
                self.memory().begun.insert(name, finished);
                Err(Missing::Cancelled)
            }
            Err(error) => Err(self.refuse(name, &error)),
        }
    }

    /// Remembers that there is no such spectrum.
    fn refuse(&self, name: (GeometryHash, Problem), error: &dyn ToString) -> Missing {
        let reason: Failure = error.to_string().into();
        self.memory().refused.insert(name, reason.clone());
        Missing::Failed(reason)
    }

    /// The bands that are there already, of a shorter spectrum or of a solve that was cancelled.
    fn known_bands(&self, name: (GeometryHash, Problem), stored: Option<Spectrum>, begun: &Key) -> Vec<Band> {
        let memory = self.memory();
        let shorter = memory.spectra.get(&name).map(|found| found.spectrum.bands.clone());
        let in_memory = memory.begun.get(&name).cloned();
        drop(memory);
        let begun = in_memory.or_else(|| self.0.store.get(begun));
        [stored.map(|spectrum| spectrum.bands), shorter, begun]
            .into_iter()
            .flatten()
            .max_by_key(Vec::len)
            .unwrap_or_default()
    }
}

/// The right to make a spectrum. Given back when it is dropped, by a panic too: else all others would wait for ever.
struct Claim<'a> {
    library: &'a Library,
    name: (GeometryHash, Problem),
}

impl Drop for Claim<'_> {
    fn drop(&mut self) {
        self.library.memory().solving.remove(&self.name);
        self.library.0.solved.notify_all();
    }
}

fn suffices(spectrum: &Spectrum, count: usize) -> bool {
    spectrum.count() >= count.min(spectrum.order)
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicBool, Ordering};

    use super::*;
    use crate::{
        laplacian::{Mass, Operator},
        mesh::{self, synth},
        spectrum::Choice,
        store,
        watch::{Patience, Unwatched},
    };

    /// Cancels once the first eigenvalues are there.
    #[derive(Default)]
    struct AfterSome(AtomicBool);

    impl Watch for AfterSome {
        fn cancelled(&self) -> bool {
            self.0.load(Ordering::Relaxed)
        }

        fn progress(&self, done: usize, _: usize) {
            self.0.fetch_or(done > 0, Ordering::Relaxed);
        }
    }

    #[test]
    fn the_bands_of_a_cancelled_solve_are_there_in_the_next_session() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shape.obj");
        let options = synth::Options { vertices: 1500, ..synth::Options::default() };
        let mesh = synth::generate(&options, 0, 0).unwrap();
        mesh::write::obj(&mesh, &mut std::fs::File::create(&path).unwrap()).unwrap();
        let open = || {
            let store = Store::open(&folder.path().join("cache"), store::Options::default());
            Library::open(store, Trace::default(), folder.path())
        };
        let (choice, count) = (Choice::new(Operator::Fem, Mass::Consistent), 400);
        let ask = |library: &Library, watch: &dyn Watch| {
            let content = library.content(&path, Stamp::of(&path).unwrap()).unwrap();
            let file = FileAt { path: &path, format: Format::Obj, content };
            let facts = library.facts(file).unwrap();
            library.spectrum(file, (&facts, None), choice.into(), count, watch)
        };
        assert!(matches!(ask(&open(), &AfterSome::default()), Err(Missing::Cancelled)));
        let begun = store::stats(&folder.path().join("cache")).unwrap();
        assert!(begun.kinds.iter().any(|kind| kind.kind == "begun" && kind.tally.files == 1), "{begun:?}");
        let resumed = ask(&open(), &Unwatched).unwrap();
        let direct = spectrum::solve(&mesh.canonical(), choice, count, &[], &Unwatched).unwrap();
        assert_eq!(resumed.spectrum.eigenvalues(), direct.eigenvalues());
        assert!(matches!(ask(&open(), &Unwatched), Ok(Found { source: Source::Disk, .. })));
    }

    #[test]
    fn a_panic_gives_back_the_right_to_make_a_spectrum() {
        let library = Library::open(Store::none(), Trace::default(), Path::new(""));
        let mesh = synth::generate(&synth::Options::default(), 0, 0).unwrap();
        let name = (mesh.hash(), Choice::default().into());
        let make = || library.made(name, 5, || panic!("a defect"), &Unwatched);
        assert!(std::panic::catch_unwind(std::panic::AssertUnwindSafe(make)).is_err());
        // Cancels if it would wait.
        let found = library.made(name, 5, || Ok(mesh.canonical()), &Patience::of(2000)).unwrap();
        assert_eq!(found.source, Source::Ran);
    }
}

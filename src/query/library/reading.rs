//! What comes before a spectrum: the hash of a file's bytes, the facts of its mesh, and the mesh itself.

use std::{path::Path, sync::Arc, time::Instant};

use super::{Examined, Facts, Failure, FileAt, Library, Missing};
use crate::{
    mesh::{self, Format, Mesh},
    query::{
        Problem, Source, Stage,
        aside::aside,
        stamp::{ContentHash, Stamp},
    },
    remesh::RemeshError,
    store::Key,
    watch::{Stopped, Unwatched, Watch},
};

/// Increase when readers or checks would say something else of the same bytes.
const READER: u64 = 2;

impl Library {
    /// Looks into the file at `path`. A large one is read on another thread, which is left alone when the watch
    /// cancels.
    ///
    /// # Errors
    /// The stage that failed, and why.
    pub(crate) fn examine(
        &self,
        path: &Path,
        format: Format,
        stamp: Stamp,
        watch: &dyn Watch,
    ) -> Result<Examined, (Stage, Missing)> {
        let (library, owned) = (self.clone(), path.to_owned());
        let examine = move || {
            let content = library.content(&owned, stamp).map_err(|reason| (Stage::Content, Missing::Unread(reason)))?;
            let known = library.facts_and_mesh(FileAt { path: &owned, format, content });
            let (facts, mesh) = known.map_err(|unread| (Stage::Survey, unread.into()))?;
            Ok(Examined { content, facts, mesh })
        };
        aside(path, watch, examine).map_err(|Stopped| (Stage::Content, Missing::Cancelled))?
    }

    /// The hash of the file's bytes, from its stamp when that was seen before.
    pub(crate) fn content(&self, path: &Path, stamp: Stamp) -> Result<ContentHash, Failure> {
        {
            let memory = self.memory();
            let mut known = [&memory.contents, &memory.fresh].into_iter().filter_map(|hashes| hashes.get(path));
            if let Some(&(_, content)) = known.find(|(seen, _)| *seen == stamp) {
                return Ok(content);
            }
        }
        let start = Instant::now();
        let content = ContentHash::of(&bytes(path)?);
        if Stamp::of(path) != Some(stamp) {
            return Err("the file is being changed; it is read again at the next look at the folder".into());
        }
        let mut memory = self.memory();
        if stamp.settled() {
            memory.contents.insert(path.to_owned(), (stamp, content));
            memory.contents_unsaved = true;
        } else {
            memory.fresh.insert(path.to_owned(), (stamp, content));
        }
        drop(memory);
        self.costs().made(Stage::Content, start.elapsed());
        self.trace().made(Stage::Content, Source::Ran, start.elapsed());
        Ok(content)
    }

    /// What is known of the mesh in `file`. A file that cannot be read as a mesh fails with its defect.
    pub(crate) fn facts(&self, file: FileAt<'_>) -> Result<Arc<Facts>, Unread> {
        self.facts_and_mesh(file).map(|(facts, _)| facts)
    }

    /// The same with the mesh in its canonical form, where it had to be read.
    fn facts_and_mesh(&self, file: FileAt<'_>) -> Result<(Arc<Facts>, Option<Mesh>), Unread> {
        let name = (file.content, file.format);
        if let Some(known) = self.memory().facts.get(&name) {
            return known.clone().map(|facts| (facts, None)).map_err(|reason| Unread { reason, decided: true });
        }
        let start = Instant::now();
        let key = Key::new("facts").number(READER).field(&file.content.0).field(file.format.ending().as_bytes());
        let (known, source) = if let Some(facts) = self.0.store.get::<Facts>(&key) {
            (Ok((Arc::new(facts), None)), Source::Disk)
        } else {
            let read = load(file).map(|mesh| {
                let (survey, mesh) = (mesh::survey(&mesh), mesh.canonical());
                (Arc::new(Facts { geometry: mesh.hash(), survey }), Some(mesh))
            });
            if let Ok((facts, _)) = &read {
                self.0.store.put(&key, &**facts);
            }
            (read, Source::Ran)
        };
        // Only what the bytes decide is remembered; that a file has gone is not.
        let facts = match &known {
            Ok((facts, _)) => Some(Ok(Arc::clone(facts))),
            Err(failure) => failure.decided.then(|| Err(Arc::clone(&failure.reason))),
        };
        if let Some(facts) = facts {
            self.memory().facts.insert(name, facts);
        }
        if source == Source::Ran {
            self.costs().made(Stage::Survey, start.elapsed());
        }
        self.trace().made(Stage::Survey, source, start.elapsed());
        known
    }

    /// The mesh that a problem is on, to look at. It is kept until another is looked at: one function after another is
    /// asked for on it.
    pub(crate) fn prepared(&self, file: FileAt<'_>, problem: Problem) -> Result<Arc<Mesh>, Missing> {
        let name = (file.content, file.format, problem.remesh);
        if let Some((_, mesh)) = self.memory().looked_at.as_ref().filter(|(known, _)| *known == name) {
            return Ok(Arc::clone(mesh));
        }
        let mesh = Arc::new(prepare(file, None, problem, &Unwatched)?);
        self.memory().looked_at = Some((name, Arc::clone(&mesh)));
        Ok(mesh)
    }
}

/// The mesh that a problem on the mesh in `file` is on, in its canonical form. `known` is as for [`read`].
pub(in crate::query) fn prepare(
    file: FileAt<'_>,
    known: Option<Mesh>,
    problem: Problem,
    watch: &dyn Watch,
) -> Result<Mesh, Missing> {
    Ok(problem.prepare(read(file, known, watch)?, watch)?)
}

/// The mesh in `file` in its canonical form: the one that is `known`, else read as [`Library::examine`] reads.
pub(in crate::query) fn read(file: FileAt<'_>, known: Option<Mesh>, watch: &dyn Watch) -> Result<Mesh, Missing> {
    if let Some(mesh) = known {
        return Ok(mesh);
    }
    let (path, FileAt { format, content, .. }) = (file.path.to_owned(), file);
    let read = move || load(FileAt { path: &path, format, content }).map(|mesh| mesh.canonical());
    Ok(aside(file.path, watch, read).map_err(|Stopped| Missing::Cancelled)??)
}

impl From<RemeshError> for Missing {
    fn from(error: RemeshError) -> Self {
        match error {
            RemeshError::Cancelled => Self::Cancelled,
            error => Self::Failed(error.to_string().into()),
        }
    }
}

/// Why a file is no mesh.
#[derive(Debug, Clone)]
pub(crate) struct Unread {
    pub(crate) reason: Failure,
    /// Whether the bytes decide it, so that it holds as long as they do.
    pub(crate) decided: bool,
}

impl From<Unread> for Missing {
    fn from(Unread { reason, decided }: Unread) -> Self {
        if decided { Self::Failed(reason) } else { Self::Unread(reason) }
    }
}

impl From<Failure> for Unread {
    fn from(reason: Failure) -> Self {
        Self { reason, decided: false }
    }
}

fn bytes(path: &Path) -> Result<Vec<u8>, Failure> {
    std::fs::read(path).map_err(|error| format!("cannot be read: {error}").into())
}

/// Reads the mesh, and makes sure that it is still the one meant.
fn load(file: FileAt<'_>) -> Result<Mesh, Unread> {
    let bytes = bytes(file.path)?;
    if ContentHash::of(&bytes) != file.content {
        return Err(Failure::from("the file is being changed; it is read again at the next look at the folder").into());
    }
    mesh::read(&bytes, file.format).map_err(|error| Unread { reason: error.to_string().into(), decided: true })
}

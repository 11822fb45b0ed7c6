//! The spectrum of a mesh file on its own: what a study does for each of its models.

use std::{path::Path, sync::Arc};

use super::{
    Problem, Source,
    library::{FileAt, Library, Missing},
    stamp::Stamp,
    trace::Trace,
};
use crate::{
    mesh::{Format, GeometryHash, Survey},
    spectrum::{Crew, Spectrum},
    store::Store,
    watch::Watch,
};

/// A mesh file's spectrum, with what is known of the mesh.
#[derive(Debug, Clone)]
pub struct Single {
    /// Hash of the canonical geometry.
    pub geometry: GeometryHash,
    /// Sizes, topology and defects.
    pub survey: Survey,
    /// At least as many eigenvalues as were asked for, or all there are.
    pub spectrum: Arc<Spectrum>,
    /// Where the spectrum came from.
    pub source: Source,
    /// How long the solve took, seconds; 0 when none ran.
    pub seconds: f64,
}

/// Why there is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum SingleError {
    /// The watch said so.
    #[error("interrupted")]
    Cancelled,
    /// The file cannot be read, or its mesh has no spectrum; in one line, without the file's name.
    #[error("{0}")]
    Failed(String),
}

/// Solves single files, any number at once; with a store, as a study would, so that each profits from the other.
#[derive(Debug)]
pub struct Singles {
    library: Library,
}

impl Singles {
    /// Keeps spectra in `store`, or in memory alone.
    #[must_use]
    pub fn new(store: Option<Store>) -> Self {
        Self { library: Library::open(store.unwrap_or_else(Store::none), Trace::default(), Path::new("")) }
    }

    /// Threads that have no file of their own can help here with those of others.
    #[must_use]
    pub fn crew(&self) -> &Crew {
        self.library.crew()
    }

    /// The first `count` eigenvalues, or more, of the mesh in the file at `path`.
    ///
    /// # Errors
    /// [`SingleError`].
    pub fn solve(&self, path: &Path, problem: Problem, count: usize, watch: &dyn Watch) -> Result<Single, SingleError> {
        let failed = |reason: &dyn ToString| SingleError::Failed(reason.to_string());
        let format =
            Format::of(path).ok_or_else(|| failed(&"the name ends in none of .obj, .off, .ply, .stl, .xyz"))?;
        let stamp = match std::fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => return Err(failed(&"a folder, not a mesh")),
            Ok(_) => Stamp::of(path),
            Err(error) => return Err(failed(&format!("cannot be read: {error}"))),
        };
        let stamp = stamp.ok_or_else(|| failed(&"the file is gone"))?;
        let missed = |missing| match missing {
            Missing::Cancelled => SingleError::Cancelled,
            Missing::Failed(reason) | Missing::Unread(reason) => failed(&reason),
        };
        let (content, facts) =
            self.library.examine(path, format, stamp, watch).map_err(|(_, missing)| missed(missing))?;
        let file = FileAt { path, format, content };
        let found = self.library.spectrum(file, &facts, problem, count, watch).map_err(missed)?;
        Ok(Single {
            geometry: facts.geometry,
            survey: facts.survey.clone(),
            spectrum: found.spectrum,
            source: found.source,
            seconds: found.seconds,
        })
    }
}

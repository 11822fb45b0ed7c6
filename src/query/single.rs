//! The spectrum of a mesh file on its own: what a study does for each of its models.

use std::{path::Path, sync::Arc, time::Instant};

use super::{
    Problem, Source,
    aside::aside,
    library::{FileAt, Library, Missing},
    stamp::Stamp,
    trace::Trace,
};
use crate::{
    mesh::{self, Format, GeometryHash, Survey},
    remesh::RemeshError,
    spectrum::{self, Crew, Request, Spectrum, SpectrumError},
    store::Store,
    watch::{Stopped, Watch},
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
    library: Option<Library>,
    /// For solves without a store.
    alone: Crew,
}

impl Singles {
    /// Keeps spectra in `store`, or nowhere.
    #[must_use]
    pub fn new(store: Option<Store>) -> Self {
        let library = store.map(|store| Library::open(store, Trace::default(), Path::new("")));
        Self { library, alone: Crew::default() }
    }

    /// Threads that have no file of their own can help here with those of others.
    #[must_use]
    pub fn crew(&self) -> &Crew {
        self.library.as_ref().map_or(&self.alone, Library::crew)
    }

    /// The first `count` eigenvalues, or more, of the mesh in the file at `path`.
    ///
    /// # Errors
    /// [`SingleError`].
    pub fn solve(&self, path: &Path, problem: Problem, count: usize, watch: &dyn Watch) -> Result<Single, SingleError> {
        let failed = |reason: &dyn ToString| SingleError::Failed(reason.to_string());
        let format =
            Format::of(path).ok_or_else(|| failed(&"the name ends in none of .obj, .off, .ply, .stl, .xyz"))?;
        let Some(library) = &self.library else {
            return solve_alone(path, format, problem, (count, &self.alone), watch);
        };
        let stamp = match std::fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => return Err(failed(&"a folder, not a mesh")),
            Ok(_) => Stamp::of(path),
            Err(error) => return Err(failed(&format!("cannot be read: {error}"))),
        };
        let stamp = stamp.ok_or_else(|| failed(&"the file is gone"))?;
        let (reader, owned) = (library.clone(), path.to_owned());
        let examine = move || {
            let content = reader.content(&owned, stamp)?;
            let facts = reader.facts(FileAt { path: &owned, format, content });
            facts.map(|facts| (content, facts)).map_err(|failure| failure.reason)
        };
        let examined = aside(path, watch, examine).map_err(|Stopped| SingleError::Cancelled)?;
        let (content, facts) = examined.map_err(|reason| failed(&reason))?;
        let file = FileAt { path, format, content };
        let found = library.spectrum(file, &facts, problem, count, watch).map_err(|missing| match missing {
            Missing::Cancelled => SingleError::Cancelled,
            Missing::Failed(reason) | Missing::Unread(reason) => failed(&reason),
        })?;
        Ok(Single {
            geometry: facts.geometry,
            survey: facts.survey.clone(),
            spectrum: found.spectrum,
            source: found.source,
            seconds: found.seconds,
        })
    }
}

/// The same without a store.
fn solve_alone(
    path: &Path,
    format: Format,
    problem: Problem,
    (count, crew): (usize, &Crew),
    watch: &dyn Watch,
) -> Result<Single, SingleError> {
    let start = Instant::now();
    let owned = path.to_owned();
    let examine = move || {
        let bytes = std::fs::read(&owned).map_err(|error| format!("cannot be read: {error}"))?;
        let mesh = mesh::read(&bytes, format).map_err(|error| error.to_string())?;
        let survey = mesh::survey(&mesh);
        match survey.refusal() {
            Some(reason) => Err(reason),
            None => Ok((mesh.hash(), survey, mesh.canonical())),
        }
    };
    let examined = aside(path, watch, examine).map_err(|Stopped| SingleError::Cancelled)?;
    let (geometry, survey, canonical) = examined.map_err(SingleError::Failed)?;
    let prepared = problem.prepare(canonical, watch).map_err(|error| match error {
        RemeshError::Cancelled => SingleError::Cancelled,
        error => SingleError::Failed(error.to_string()),
    })?;
    let request = Request { crew: Some(crew), ..Request::new(count) };
    let solved = spectrum::solve_with(&prepared, problem.choice, &request, watch);
    let mut spectrum = solved.map_err(|error| match error {
        SpectrumError::Cancelled { .. } => SingleError::Cancelled,
        error => SingleError::Failed(error.to_string()),
    })?;
    spectrum.notes.splice(0..0, problem.note());
    Ok(Single {
        geometry,
        survey,
        spectrum: Arc::new(spectrum),
        source: Source::Ran,
        seconds: start.elapsed().as_secs_f64(),
    })
}

//! The spectrum of a mesh file on its own: what a study does for each of its models.

use std::{path::Path, sync::Arc, time::Instant};

use super::{
    Problem, Source,
    library::{Examined, Facts, FileAt, Library, Missing, prepare, read},
    stamp::Stamp,
    trace::Trace,
};
use crate::{
    mesh::{Format, GeometryHash, Mesh, Survey},
    spectrum::{self, Crew, Spectrum, SpectrumError, Window},
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

/// The eigenvalues of a mesh file that are nearest to a λ, with what is known of the mesh.
#[derive(Debug, Clone)]
pub struct Near {
    /// Hash of the canonical geometry.
    pub geometry: GeometryHash,
    /// Sizes, topology and defects.
    pub survey: Survey,
    /// As many eigenvalues as were asked for, or all there are.
    pub window: Window,
    /// How long the solve took, seconds.
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

/// Solves single files and meshes, any number at once; with a store, as a study would, so that each profits from the
/// other.
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

    /// Keeps spectra where a study does.
    pub(super) const fn over(library: Library) -> Self {
        Self { library }
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
        let (file, facts, mesh) = self.examine(path, watch)?;
        let found = self.library.spectrum(file, (&facts, mesh), problem, count, watch)?;
        Ok(Single {
            geometry: facts.geometry,
            survey: facts.survey.clone(),
            spectrum: found.spectrum,
            source: found.source,
            seconds: found.seconds,
        })
    }

    /// The `count` eigenvalues nearest to `target` of the mesh in the file at `path`. Nothing of it is kept.
    ///
    /// # Errors
    /// [`SingleError`].
    pub fn near(
        &self,
        path: &Path,
        problem: Problem,
        target: f64,
        count: usize,
        watch: &dyn Watch,
    ) -> Result<Near, SingleError> {
        let (file, facts, mesh) = self.examine(path, watch)?;
        facts.admit()?;
        let mesh = prepare(file, mesh, problem, watch)?;
        let start = Instant::now();
        let mut window = spectrum::near(&mesh, problem.choice, target, count, watch).map_err(|error| match error {
            SpectrumError::Cancelled { .. } => SingleError::Cancelled,
            error => SingleError::Failed(error.to_string()),
        })?;
        window.notes.splice(0..0, problem.note());
        let seconds = start.elapsed().as_secs_f64();
        Ok(Near { geometry: facts.geometry, survey: facts.survey.clone(), window, seconds })
    }

    /// The mesh in the file at `path`, in its canonical form.
    ///
    /// # Errors
    /// [`SingleError`].
    pub fn mesh(&self, path: &Path, watch: &dyn Watch) -> Result<Mesh, SingleError> {
        let (file, _, mesh) = self.examine(path, watch)?;
        Ok(read(file, mesh, watch)?)
    }

    /// The file, what is known of its mesh, and the mesh where it had to be read.
    fn examine<'a>(
        &self,
        path: &'a Path,
        watch: &dyn Watch,
    ) -> Result<(FileAt<'a>, Arc<Facts>, Option<Mesh>), SingleError> {
        let failed = |reason: &dyn ToString| SingleError::Failed(reason.to_string());
        let format =
            Format::of(path).ok_or_else(|| failed(&"the name ends in none of .obj, .off, .ply, .stl, .xyz"))?;
        let stamp = match std::fs::metadata(path) {
            Ok(metadata) if metadata.is_dir() => return Err(failed(&"a folder, not a mesh")),
            Ok(_) => Stamp::of(path),
            Err(error) => return Err(failed(&format!("cannot be read: {error}"))),
        };
        let stamp = stamp.ok_or_else(|| failed(&"the file is gone"))?;
        let examined = self.library.examine(path, format, stamp, watch).map_err(|(_, missing)| missing)?;
        let Examined { content, facts, mesh } = examined;
        Ok((FileAt { path, format, content }, facts, mesh))
    }

    /// The first `count` eigenvalues, or more, of a mesh that is in no file.
    ///
    /// # Errors
    /// [`SingleError`].
    pub fn of_mesh(
        &self,
        mesh: &Mesh,
        problem: Problem,
        count: usize,
        watch: &dyn Watch,
    ) -> Result<Arc<Spectrum>, SingleError> {
        Ok(self.library.spectrum_of(mesh, problem, count, watch)?.spectrum)
    }
}

impl From<Missing> for SingleError {
    fn from(missing: Missing) -> Self {
        match missing {
            Missing::Cancelled => Self::Cancelled,
            Missing::Failed(reason) | Missing::Unread(reason) => Self::Failed(reason.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        mesh::{self, synth},
        spectrum::Choice,
        store::Options,
        watch::{Unwanted, Unwatched},
    };

    #[test]
    fn a_mesh_and_its_file_have_one_spectrum() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shape.obj");
        let mesh = synth::generate(&synth::Options { vertices: 400, ..synth::Options::default() }, 0, 0).unwrap();
        mesh::write::obj(&mesh, &mut std::fs::File::create(&path).unwrap()).unwrap();
        let open = || Singles::new(Some(Store::open(&folder.path().join("cache"), Options::default())));
        for problem in [Problem::from(Choice::default()), Problem { remesh: Some(300), choice: Choice::default() }] {
            assert_eq!(open().of_mesh(&mesh, problem, 20, &Unwanted).unwrap_err(), SingleError::Cancelled);
            let found = open().of_mesh(&mesh, problem, 20, &Unwatched).unwrap();
            let prepared = problem.prepare(mesh.canonical(), &Unwatched).unwrap();
            let direct = spectrum::solve(&prepared, problem.choice, 20, &[], &Unwatched).unwrap();
            assert_eq!(found.eigenvalues(), direct.eigenvalues());
            let of_file = open().solve(&path, problem, 20, &Unwatched).unwrap();
            assert_eq!((of_file.source, of_file.spectrum.eigenvalues()), (Source::Disk, found.eigenvalues()));
        }
        let point = Mesh::new(vec![[0.0; 3]], Vec::new());
        let refused = open().of_mesh(&point, Choice::default().into(), 20, &Unwatched).unwrap_err();
        assert!(matches!(refused, SingleError::Failed(_)), "{refused}");
    }

    #[test]
    fn what_has_no_spectrum_has_no_part_of_one() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("flat.off");
        std::fs::write(&path, "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n").unwrap();
        let (singles, problem) = (Singles::new(None), Problem::from(Choice::default()));
        let refused = singles.solve(&path, problem, 2, &Unwatched).unwrap_err();
        assert_eq!(refused, SingleError::Failed("no face has an area".to_owned()));
        assert_eq!(singles.near(&path, problem, 5.0, 2, &Unwatched).unwrap_err(), refused);
    }

    #[test]
    fn a_file_is_read_as_a_mesh_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shape.obj");
        let mesh = synth::generate(&synth::Options { vertices: 400, ..synth::Options::default() }, 0, 0).unwrap();
        mesh::write::obj(&mesh, &mut std::fs::File::create(&path).unwrap()).unwrap();
        let (singles, problem) = (Singles::new(None), Problem::from(Choice::default()));
        let (file, facts, read) = singles.examine(&path, &Unwatched).unwrap();
        assert_eq!(read, Some(mesh.canonical()));
        std::fs::remove_file(&path).unwrap();
        let found = singles.library.spectrum(file, (&facts, read), problem, 20, &Unwatched).unwrap();
        assert!(found.spectrum.count() >= 20);
    }

    #[test]
    fn the_mesh_of_a_file_is_in_its_canonical_form() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("shape.off");
        std::fs::write(&path, "OFF\n3 1 0\n1 0 0\n0 1 0\n0 0 0\n3 0 1 2\n").unwrap();
        let singles = Singles::new(None);
        for _ in 0..2 {
            assert_eq!(singles.mesh(&path, &Unwatched).unwrap().vertices()[0], [0.0; 3]);
        }
        std::fs::write(&path, "OFF\n3 1 0\n1 0 0\n").unwrap();
        assert!(matches!(singles.mesh(&path, &Unwatched), Err(SingleError::Failed(_))));
    }
}

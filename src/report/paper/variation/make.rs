//! The spectra behind Figure 1, from the store or solved.

use std::{
    path::PathBuf,
    sync::{
        Mutex, OnceLock,
        atomic::{AtomicUsize, Ordering},
    },
};

use super::{EIGENVALUES, Spectra, Variation};
use crate::{
    dataset::Role,
    laplacian::Operator,
    mesh::{Mesh, deform},
    query::{Answer, Problem, Settings, SingleError, Singles},
    remesh,
    spectrum::Choice,
    watch::{Silent, Watch},
};

/// Both are shown.
const OPERATORS: [Operator; 2] = [Operator::Fem, Operator::Cot];

/// Variants of a shape, itself among them.
const VARIANTS: usize = 9;

/// A variant: its name, how it is made of the mesh, and to how many vertices it is re-meshed then.
type Made = (&'static str, fn(&Mesh) -> Mesh, Option<usize>);

/// The variants of a mesh, itself first. A quarter of its vertices may be too few to re-mesh it to.
fn variants(mesh: &Mesh, vertices: usize) -> [Made; VARIANTS] {
    [
        ("original", Mesh::clone, None),
        ("rotated", |mesh| deform::rotate(mesh, [1.0, 2.0, 3.0], 1.0), None),
        ("scaled by 2", |mesh| deform::scale(mesh, 2.0), None),
        ("bent by 60°", |mesh| deform::bend(mesh, std::f64::consts::FRAC_PI_3), None),
        ("smoothed", |mesh| deform::smooth(mesh, 10), None),
        ("noise, 10 % of an edge", |mesh| deform::noise(mesh, 0.1, 1), None),
        ("refined, each face in four", deform::refine, None),
        ("simplified to a quarter", Mesh::clone, Some(mesh.vertices().len() / 4)),
        ("re-meshed", Mesh::clone, Some(vertices)),
    ]
}

/// What Figure 1 is of: a class, its training models, and what their spectra depend on.
#[derive(Debug, Clone, PartialEq)]
pub struct Subject {
    /// The class.
    pub class: String,
    /// The names and files of its training models.
    pub models: Vec<(String, PathBuf)>,
    /// The eigenproblem of FEM; that of cot has the same boundary and triangulation.
    pub choice: Choice,
    /// Vertices of the variant that is re-meshed.
    pub vertices: usize,
}

impl Subject {
    /// The class of these parameters, among the models of `answer`.
    #[must_use]
    pub fn new(settings: &Settings, answer: &Answer) -> Self {
        let class = settings.class;
        let mine = answer.models.iter().filter(|model| model.class as usize == class && model.role == Role::Train);
        Self {
            class: answer.classes.get(class).cloned().unwrap_or_default(),
            models: mine.map(|model| (model.name.clone(), model.path.clone())).collect(),
            // The mass is there whichever operator is set.
            choice: Choice::new(Operator::Fem, settings.mass)
                .with_boundary(settings.boundary)
                .with_triangulation(settings.triangulation),
            vertices: settings.remesh.unwrap_or(remesh::USUAL),
        }
    }

    fn problem(&self, operator: Operator) -> Problem {
        let Choice { mass, boundary, triangulation, .. } = self.choice;
        Choice::new(operator, mass).with_boundary(boundary).with_triangulation(triangulation).into()
    }
}

/// Spectra that Figure 1 of a class of so many training models has.
#[must_use]
pub const fn solves(models: usize) -> usize {
    OPERATORS.len() * (VARIANTS + models)
}

/// Figure 1: makes the variants of the first training model that has a spectrum, and has their spectra and those of the
/// class, as meshes come, solved on `threads` threads where `singles` does not know them. What cannot be had is there
/// with the reason.
///
/// `watch` hears of spectra that are there, of [`solves`], and is polled every few milliseconds.
///
/// # Errors
/// When it is cancelled, or no training model has a spectrum.
pub fn of_class(singles: &Singles, subject: &Subject, threads: usize, watch: &dyn Watch) -> Result<Variation, String> {
    let (shown, mesh, count) = first(singles, subject, watch)?;
    let variants = variants(&mesh, subject.vertices);
    let work = Work {
        singles,
        subject,
        mesh: &mesh,
        count,
        watch,
        made: Default::default(),
        rows: Mutex::new((
            variants.map(|(name, ..)| Spectra::of(name, 0)).to_vec(),
            subject.models.iter().map(|(name, _)| Spectra::of(name, 0)).collect(),
        )),
        variants,
        next: AtomicUsize::new(0),
        done: AtomicUsize::new(0),
    };
    // The calling thread is one of them.
    std::thread::scope(|scope| {
        for _ in 1..threads {
            let _ = std::thread::Builder::new().name("variant".into()).spawn_scoped(scope, || work.run());
        }
        work.run();
    });
    if watch.cancelled() {
        return Err(SingleError::Cancelled.to_string());
    }
    let (variants, members) = work.rows.into_inner().map_err(|_| "internal error, please report it".to_owned())?;
    Ok(Variation { model: shown.to_owned(), class: subject.class.clone(), variants, members })
}

/// The first training model that has a spectrum: its name, its mesh, and how many eigenvalues are shown.
fn first<'a>(singles: &Singles, subject: &'a Subject, watch: &dyn Watch) -> Result<(&'a str, Mesh, usize), String> {
    let mut why = "the class has no training model".to_owned();
    for (name, path) in &subject.models {
        let solved = singles.solve(path, subject.problem(Operator::Fem), EIGENVALUES, &Silent(watch));
        match solved.and_then(|single| Ok((singles.mesh(path, watch)?, single.spectrum.count()))) {
            Ok((mesh, count)) => return Ok((name, mesh, count.min(EIGENVALUES))),
            Err(reason) if watch.cancelled() => return Err(reason.to_string()),
            Err(reason) => why = format!("{name}: {reason}"),
        }
    }
    Err(why)
}

/// What the threads share.
struct Work<'a> {
    singles: &'a Singles,
    subject: &'a Subject,
    mesh: &'a Mesh,
    /// Eigenvalues of each spectrum: as many as the original has.
    count: usize,
    watch: &'a dyn Watch,
    variants: [Made; VARIANTS],
    made: [OnceLock<Mesh>; VARIANTS],
    /// Of the variants, of the models.
    rows: Mutex<(Vec<Spectra>, Vec<Spectra>)>,
    next: AtomicUsize,
    done: AtomicUsize,
}

impl Work<'_> {
    /// Has one spectrum after the other, the variants' first, until none is left or the watch cancels.
    fn run(&self) {
        let total = solves(self.subject.models.len());
        loop {
            let turn = self.next.fetch_add(1, Ordering::Relaxed);
            if turn >= total || self.watch.cancelled() {
                return;
            }
            let (place, operator) = (turn / OPERATORS.len(), OPERATORS[turn % OPERATORS.len()]);
            let found = match place.checked_sub(VARIANTS) {
                None => self.variant(place, operator),
                Some(member) => self.member(member, operator),
            };
            let Ok(mut rows) = self.rows.lock() else { return };
            let row = match place.checked_sub(VARIANTS) {
                None => &mut rows.0[place],
                Some(member) => &mut rows.1[member],
            };
            match found {
                Ok((vertices, eigenvalues)) => {
                    row.vertices = vertices;
                    // Divided by another one than the original's last, they could not be compared.
                    if eigenvalues.len() < self.count {
                        row.why = Some(format!("it has {} eigenvalues, not {}", eigenvalues.len(), self.count));
                    } else {
                        row.put(operator, &eigenvalues[..self.count]);
                    }
                }
                Err(reason) => row.why = Some(reason),
            }
            // Told in order, under the lock.
            self.watch.progress(self.done.fetch_add(1, Ordering::Relaxed) + 1, total);
        }
    }

    /// Vertices and eigenvalues of a variant.
    fn variant(&self, at: usize, operator: Operator) -> Result<(usize, Vec<f64>), String> {
        let (_, make, remesh) = self.variants[at];
        let made = self.made[at].get_or_init(|| make(self.mesh));
        let problem = Problem { remesh, ..self.subject.problem(operator) };
        let found = self.singles.of_mesh(made, problem, self.count, &Silent(self.watch));
        let found = found.map_err(|error| error.to_string())?;
        Ok((remesh.unwrap_or(made.vertices().len()), found.eigenvalues()))
    }

    /// Those of a training model.
    fn member(&self, at: usize, operator: Operator) -> Result<(usize, Vec<f64>), String> {
        let path = &self.subject.models[at].1;
        let found = self.singles.solve(path, self.subject.problem(operator), self.count, &Silent(self.watch));
        let found = found.map_err(|error| error.to_string())?;
        Ok((found.survey.vertices, found.spectrum.eigenvalues()))
    }
}

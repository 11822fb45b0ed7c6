//! (L, B) → the first eigenvalues, certified complete.
//!
//! [`solve()`] walks up the λ axis from shift to shift. At each shift σ a sparse factorisation L − σB = M D Mᵀ counts
//! the eigenvalues below it: they are as many as D has negative entries (Sylvester). A block Lanczos process with the
//! same factor finds those near the shift on both sides. The eigenvalues between two shifts come from the process at
//! the lower and the process at the upper one, and they are accepted only when their number is the difference of the
//! two counts. Such a slice is a [`Band`]. No eigenvalue depends on how many were asked for, so more of them are always
//! the same bits as before and further ones. Only where the answer ends does: where the process at the last shift sees
//! as many eigenvalues above it as are still wanted, a count above those ends it, without a process of its own.
//!
//! Every eigenvalue comes with a [bound](Spectrum::residuals) on its error; what it rests on is told in [`mod@slice`].
//! [`eigenvectors()`] of chosen eigenvalues and the eigenvalues [`near()`] a target are computed on demand.
//!
//! A mesh of several pieces is solved piece by piece. Everything runs on the calling thread, unless a [`Crew`] helps:
//! then the processes of several shifts run at once, and the result is still the same bits.

use serde::{Deserialize, Serialize};
use thiserror::Error;

pub use self::{
    band::Band,
    crew::Crew,
    normalise::Normalisation,
    timings::{Cost, Timings},
    vectors::Eigenvector,
    window::Window,
};
pub use crate::laplacian::Choice;
use crate::{
    laplacian::{Laplacian, LaplacianError, assemble_watched},
    mesh::Mesh,
    watch::{Stopped, Watch},
};

use self::timings::Meter;

mod band;
mod band_reduction;
mod block;
mod crew;
mod dense;
mod factor;
#[cfg(test)]
mod faults;
mod implicit_ql;
mod krylov;
mod lanes;
mod normalise;
mod panel;
mod part;
mod pencil;
mod poll;
mod product;
#[cfg(test)]
#[path = "../tests/operators/shapes.rs"]
mod shapes;
mod slice;
mod small;
mod solve;
mod team;
#[cfg(test)]
mod tests;
mod thorough;
mod timings;
mod vectors;
mod window;

/// The version of everything that decides the values: raised whenever any eigenvalue could change in any bit.
pub const KERNEL: u32 = 12;

/// Why there is no spectrum.
#[derive(Debug, Error)]
pub enum SpectrumError {
    /// The watch cancelled. The bands finished by then, known ones included, save their time when handed in again.
    #[error("cancelled")]
    Cancelled {
        /// All bands so far.
        finished: Vec<Band>,
    },
    /// The mesh has no eigenvalues to speak of; the text names the defect and its place.
    #[error("{0}")]
    Refused(String),
    /// The number of eigenvalues found does not equal the number counted, whatever was tried. No value is returned
    /// that is not certified.
    #[error("the eigenvalues near λ = {at:e} could not be certified complete")]
    Uncertified {
        /// Where, in the unit of λ.
        at: f64,
        /// All bands before.
        finished: Vec<Band>,
    },
}

impl From<LaplacianError> for SpectrumError {
    fn from(error: LaplacianError) -> Self {
        match error {
            LaplacianError::Cancelled(_) => Self::Cancelled { finished: Vec::new() },
            error => Self::Refused(error.to_string()),
        }
    }
}

impl From<Stopped> for SpectrumError {
    fn from(_: Stopped) -> Self {
        Self::Cancelled { finished: Vec::new() }
    }
}

impl SpectrumError {
    /// The same; when it is a cancellation that came before any band, with these as the finished ones.
    fn keeping(self, known: &[Band]) -> Self {
        match self {
            Self::Cancelled { finished } if finished.len() < known.len() => {
                Self::Cancelled { finished: known.to_vec() }
            }
            other => other,
        }
    }
}

/// The lower end of a mesh's spectrum, certified complete.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Spectrum {
    /// The finished bands by part and place: at least those that the request needed, and all known ones.
    pub bands: Vec<Band>,
    /// How many pieces the bands are of.
    pub parts: u32,
    /// How many eigenvalues there can be: the number of vertices in use that no Dirichlet condition holds.
    pub order: usize,
    /// 1ᵀB1 of the whole surface: the area for finite elements, the number of vertices in use for the cotangent
    /// operator.
    pub measure: f64,
    /// How many eigenvalues are zero: the number of connected components that no boundary condition holds, and of parts
    /// that hang on by weights of zero, such as the tip of a triangle a million million times as long as wide.
    pub zeros: usize,
    /// What was done to the mesh, one line each.
    pub notes: Vec<String>,
    /// What this solve took, by part; nothing for a spectrum that was read from a store.
    #[serde(skip)]
    pub timings: Timings,
}

/// An inertia count: so many eigenvalues of one piece lie below a shift.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Count {
    /// Which piece, as in [`Band::part`].
    pub part: u32,
    /// λ of the shift.
    pub shift: f64,
    /// Eigenvalues of the piece below it.
    pub below: usize,
}

impl Spectrum {
    /// The certified eigenvalues, ascending and with their multiplicities; zeros are exactly `0.0`. All eigenvalues of
    /// the mesh up to the last one are among them.
    #[must_use]
    pub fn eigenvalues(&self) -> Vec<f64> {
        self.certified().into_iter().map(|(value, _)| value).collect()
    }

    /// For each of the [eigenvalues](Self::eigenvalues) a bound on its error, in its unit: of second order in the
    /// residuals, with the gap to the other eigenvalues as the counts prove it, and a measured term for rounding.
    #[must_use]
    pub fn residuals(&self) -> Vec<f64> {
        self.certified().into_iter().map(|(_, error)| error).collect()
    }

    /// How many eigenvalues are certified.
    #[must_use]
    pub fn count(&self) -> usize {
        let limit = self.frontier();
        self.bands.iter().map(|band| band.values.iter().filter(|&&value| value <= limit).count()).sum()
    }

    /// The inertia counts that prove the eigenvalues complete.
    #[must_use]
    pub fn certificate(&self) -> Vec<Count> {
        self.bands.iter().map(|band| Count { part: band.part, shift: band.upper, below: band.above }).collect()
    }

    /// Eigenvalues up to here are known of every piece.
    fn frontier(&self) -> f64 {
        let mut last = vec![0.0_f64; self.parts as usize];
        // The small pieces, if there are any, are solved whole.
        last.iter_mut().take(1).for_each(|small| *small = f64::MAX);
        for band in &self.bands {
            if let Some(last) = last.get_mut(band.part as usize) {
                *last = last.max(band.upper);
            }
        }
        last.into_iter().fold(f64::MAX, f64::min)
    }

    fn certified(&self) -> Vec<(f64, f64)> {
        let limit = self.frontier();
        let mut all: Vec<(f64, f64)> = self
            .bands
            .iter()
            .flat_map(|band| band.values.iter().copied().zip(band.errors.iter().copied()))
            .filter(|&(value, _)| value <= limit)
            .collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }
}

/// The first `count` eigenvalues of a mesh, or all when it has fewer vertices; often some more, since bands are solved
/// whole. `known` are bands of the same mesh, choice and [`KERNEL`], as an earlier call gave them; they are taken over
/// where they continue each other from λ = 0.
///
/// The result is the same bits whatever is known, but for further bands that `known` holds. Time grows with the number
/// of bands that are not known, at 70 to 100 eigenvalues each.
///
/// Memory is bounded whatever the mesh and however many eigenvalues: by 8 MB, 4 kB for each row of the matrices, 24
/// bytes for each number in a factor ([`Timings::entries`]) and 1 kB for each vertex and face (18 faces for each point
/// of a cloud), on one thread. Each thread that helps takes another 4 kB a row and 16 bytes for a number in a factor.
///
/// # Errors
/// When the watch cancels, when the mesh cannot be assembled (see [`LaplacianError`]), or when the eigenvalues found
/// cannot be proved complete.
pub fn solve(
    mesh: &Mesh,
    choice: Choice,
    count: usize,
    known: &[Band],
    watch: &dyn Watch,
) -> Result<Spectrum, SpectrumError> {
    solve_with(mesh, choice, &Request { known, ..Request::new(count) }, watch)
}

/// What is asked of [`solve_with()`].
#[derive(Clone, Copy)]
pub struct Request<'a> {
    /// So many eigenvalues.
    pub count: usize,
    /// Bands that are there already.
    pub known: &'a [Band],
    /// Other threads may help, and scratch memory is kept for the next mesh.
    pub crew: Option<&'a Crew>,
    /// Called on the calling thread with all bands that are finished, known ones included, when there is a new one.
    pub keep: &'a dyn Fn(&[Band]),
}

impl Request<'_> {
    /// So many eigenvalues, on the calling thread alone.
    #[must_use]
    pub fn new(count: usize) -> Self {
        Self { count, known: &[], crew: None, keep: &|_| {} }
    }
}

impl std::fmt::Debug for Request<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Request").field("count", &self.count).field("known", &self.known.len()).finish_non_exhaustive()
    }
}

/// [`solve()`], with other threads if there are any that help. The result is the same bits, whoever helps.
///
/// # Errors
/// As [`solve()`].
pub fn solve_with(
    mesh: &Mesh,
    choice: Choice,
    request: &Request,
    watch: &dyn Watch,
) -> Result<Spectrum, SpectrumError> {
    let mut meter = Meter::start();
    let laplacian =
        assemble_watched(mesh, choice, watch).map_err(|error| SpectrumError::from(error).keeping(request.known))?;
    meter.charge(Cost::Assembly);
    let mut tools = request.crew.map(|crew| crew.take(laplacian.matrix.order())).unwrap_or_default();
    let solved = solve::solve(&laplacian, request, watch, &mut tools);
    if let Some(crew) = request.crew {
        crew.give_back(tools);
    }
    let mut spectrum = solved?;
    spectrum.timings.add(&meter.timings);
    Ok(spectrum)
}

/// [`solve()`] for matrices that are assembled already.
///
/// # Errors
/// As [`solve()`].
pub fn solve_laplacian(
    laplacian: &Laplacian,
    count: usize,
    known: &[Band],
    watch: &dyn Watch,
) -> Result<Spectrum, SpectrumError> {
    let request = Request { known, ..Request::new(count) };
    solve::solve(laplacian, &request, watch, &mut part::Tools::default())
}

/// The eigenvectors of chosen eigenvalues of a mesh whose `spectrum` is known, one for each index in `wanted`.
///
/// Their values belong to the vertices of the mesh. Each is the same bits whichever others are asked for with it. The
/// mesh and the choice must be those of the spectrum.
///
/// # Errors
/// When the watch cancels, when the mesh cannot be assembled, when an index is not below [`Spectrum::count`], or when
/// the vectors found do not belong to the eigenvalues.
pub fn eigenvectors(
    mesh: &Mesh,
    choice: Choice,
    spectrum: &Spectrum,
    wanted: &[usize],
    watch: &dyn Watch,
) -> Result<Vec<Eigenvector>, SpectrumError> {
    let laplacian = assemble_watched(mesh, choice, watch)?;
    let mut vectors = eigenvectors_laplacian(&laplacian, spectrum, wanted, watch)?;
    for vector in &mut vectors {
        let mut values = vec![0.0; mesh.vertices().len()];
        for (&vertex, &value) in laplacian.vertices.iter().zip(&vector.values) {
            values[vertex as usize] = value;
        }
        vector.values = values;
    }
    Ok(vectors)
}

/// [`eigenvectors()`] for matrices that are assembled already; the values belong to their rows.
///
/// # Errors
/// As [`eigenvectors()`].
pub fn eigenvectors_laplacian(
    laplacian: &Laplacian,
    spectrum: &Spectrum,
    wanted: &[usize],
    watch: &dyn Watch,
) -> Result<Vec<Eigenvector>, SpectrumError> {
    vectors::eigenvectors(laplacian, spectrum, wanted, watch)
}

/// The `count` eigenvalues of a mesh that are nearest to `target`, without those below them, certified complete.
///
/// Time grows with `count` and hardly depends on where the target is. The bounds are those of
/// [`Spectrum::residuals`].
///
/// # Errors
/// As [`solve()`], and when the target is negative or not finite.
pub fn near(
    mesh: &Mesh,
    choice: Choice,
    target: f64,
    count: usize,
    watch: &dyn Watch,
) -> Result<Window, SpectrumError> {
    if !(target.is_finite() && target >= 0.0) {
        return Err(SpectrumError::Refused(format!("eigenvalues are sought near λ = {target}, not at 0 or above")));
    }
    window::near(&assemble_watched(mesh, choice, watch)?, target, count, watch)
}

/// All eigenvalues of a mesh in a range, ends included, certified complete.
///
/// # Errors
/// As [`near()`].
pub fn between(
    mesh: &Mesh,
    choice: Choice,
    range: std::ops::RangeInclusive<f64>,
    watch: &dyn Watch,
) -> Result<Window, SpectrumError> {
    let (start, end) = range.into_inner();
    if !(start.is_finite() && end.is_finite() && start <= end) {
        return Err(SpectrumError::Refused(format!("there is nothing between λ = {start} and λ = {end}")));
    }
    window::between(&assemble_watched(mesh, choice, watch)?, &(start.max(0.0)..end), watch)
}

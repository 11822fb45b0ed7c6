//! The arguments of `tui spectrum`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::values::{count, target, vertices};
use crate::{
    laplacian::{Boundary, Choice, Mass, Operator, Triangulation},
    query::Problem,
};

const SPECTRUM_NOTES: &str = "\
Eigenvalues are ascending, multiplicities repeated, and certified: the number found below a bound
σ equals the number of negative pivots of L − σB. A mesh of c components has c zeros. A mesh that
fails is named on standard error, the others are written, and the exit code is 1.

Examples:
  tui spectrum bunny.obj
  tui spectrum a.off b.off --count 500 --format csv --out spectra.csv
  tui spectrum bunny.obj --near 2000 --count 20
  tui spectrum bunny.ply --mass lumped --out bunny.ev        readable with LaPy's read_ev";

/// `tui spectrum`.
#[derive(Debug, Args)]
#[command(after_help = SPECTRUM_NOTES)]
pub(in crate::cli) struct SpectrumArguments {
    /// Mesh files: OBJ, OFF, PLY or STL; points without faces also as XYZ
    #[arg(value_name = "MESH", required = true)]
    pub(in crate::cli) meshes: Vec<PathBuf>,
    /// How many eigenvalues, the zeros included
    #[arg(long, value_name = "N", default_value_t = 100, value_parser = count)]
    pub(in crate::cli) count: usize,
    /// Those nearest to λ instead of the first ones, without those below them; not kept in the cache
    #[arg(long, value_name = "λ", value_parser = target, allow_negative_numbers = true)]
    pub(in crate::cli) near: Option<f64>,
    /// Re-mesh to so many vertices first
    #[arg(long, value_name = "N", value_parser = vertices)]
    pub(in crate::cli) remesh: Option<usize>,
    /// The eigenproblem: finite elements (L f = λ B f), or cotangent weights alone (L f = λ f)
    #[arg(long, value_enum, default_value = "fem")]
    pub(in crate::cli) operator: OperatorName,
    /// The mass matrix B of fem
    #[arg(long, value_enum, default_value = "consistent")]
    pub(in crate::cli) mass: MassName,
    /// What holds on the boundary, the edges of one face: no slope, or zero
    #[arg(long, value_enum, default_value = "neumann")]
    pub(in crate::cli) boundary: BoundaryName,
    /// The triangles that are summed over
    #[arg(long, value_enum, default_value = "auto")]
    pub(in crate::cli) triangulation: TriangulationName,
    /// How to write them [default: by the ending of --out, else text]
    #[arg(long, value_enum)]
    pub(in crate::cli) format: Option<SpectrumFormat>,
    /// Write to a file; with ev and several meshes, to a folder with a file for each
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) out: Option<PathBuf>,
    /// Keep spectra in DIR [default: the folder `cache` beside the data set, else the user's cache folder]
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    pub(in crate::cli) cache: Option<PathBuf>,
    /// Neither read nor keep spectra
    #[arg(long)]
    pub(in crate::cli) no_cache: bool,
    /// Meshes solved at once [default: all processors]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(in crate::cli) threads: Option<u16>,
}

/// `--format` of spectra.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum SpectrumFormat {
    /// aligned plain text
    Text,
    /// a line for each mesh: its size, how many are certified, what was done to it
    Summary,
    /// mesh,k,eigenvalue,error
    Csv,
    /// everything known of each spectrum
    Json,
    /// the eigenvalue file of ShapeDNA and LaPy
    Ev,
}

/// `--operator`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum OperatorName {
    Fem,
    Cot,
}

impl From<OperatorName> for Operator {
    fn from(name: OperatorName) -> Self {
        match name {
            OperatorName::Fem => Self::Fem,
            OperatorName::Cot => Self::Cot,
        }
    }
}

/// `--mass`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum MassName {
    Consistent,
    Lumped,
    /// their mean
    Blended,
}

impl From<MassName> for Mass {
    fn from(name: MassName) -> Self {
        match name {
            MassName::Consistent => Self::Consistent,
            MassName::Lumped => Self::Lumped,
            MassName::Blended => Self::Blended,
        }
    }
}

/// `--boundary`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum BoundaryName {
    Neumann,
    Dirichlet,
}

impl From<BoundaryName> for Boundary {
    fn from(name: BoundaryName) -> Self {
        match name {
            BoundaryName::Neumann => Self::Neumann,
            BoundaryName::Dirichlet => Self::Dirichlet,
        }
    }
}

/// `--triangulation`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum TriangulationName {
    /// the given ones; for points and soups, which have none that hang together, others
    Auto,
    /// the faces of the mesh
    Given,
    /// the intrinsic Delaunay triangulation of the surface: for bad triangles
    Delaunay,
    /// the same of its tufted cover: for non-manifold meshes and soups
    Tufted,
}

impl From<TriangulationName> for Triangulation {
    fn from(name: TriangulationName) -> Self {
        match name {
            TriangulationName::Auto => Self::Auto,
            TriangulationName::Given => Self::Given,
            TriangulationName::Delaunay => Self::Delaunay,
            TriangulationName::Tufted => Self::Tufted,
        }
    }
}

impl SpectrumArguments {
    /// What the spectra are of, besides the meshes.
    pub(in crate::cli) fn problem(&self) -> Problem {
        let choice = Choice::new(self.operator.into(), self.mass.into())
            .with_boundary(self.boundary.into())
            .with_triangulation(self.triangulation.into());
        Problem { remesh: self.remesh, choice }
    }
}

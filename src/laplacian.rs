//! Mesh → stiffness matrix L and mass matrix B.
//!
//! [`assemble()`] takes any triangle list: closed or with a boundary, of one piece or many, manifold or not,
//! consistently oriented or not, and points without faces as well. Every triangle adds the positive semi-definite
//! matrix of its own metric, so L is positive semi-definite whatever the connectivity, and its kernel has one dimension
//! per connected component that no Dirichlet condition holds. What cannot be taken as it is (a repeated face, a face
//! without area) is mended locally, and [`Laplacian::notes`] says so.
//!
//! ```text
//! mesh ─► surface ─┬─ as given ───────────────► elements ─► joins ─► matrix ─► restrict ─► Laplacian
//!                  └─ cover ─► flips (glued) ─────┘            (sums)           (Dirichlet)
//! points ─► cloud ─────┘
//! ```
//!
//! What is summed over is chosen by [`Triangulation`]:
//!
//! | | triangles | for |
//! |---|---|---|
//! | `given` | those of the mesh | good meshes |
//! | `delaunay` | those of the intrinsic Delaunay triangulation of the same surface (Bobenko and Springborn 2007): edges between two faces are flipped, all others stay | bad triangles |
//! | `tufted` | those of the intrinsic Delaunay triangulation of the tufted cover (Sharp and Crane 2020), halved | non-manifold meshes, polygon soups |
//! | `auto` | as given; local triangulations and `tufted` for points; vertices joined and `tufted` for soups | the default |
//!
//! Why `auto` keeps to the given triangles wherever there are some that hang together: the element matrices of
//! a non-manifold or inconsistently oriented mesh are those of its faces, which need neither neighbours nor
//! orientation, so there is nothing to repair; and spectra of a data set stay comparable with those of other programs.

pub(crate) use self::matrix::MassMatrix;
pub use self::{
    assemble::{LaplacianError, assemble, assemble_watched},
    choice::{Boundary, Choice, Mass, Operator, Triangulation},
    matrix::Symmetric,
    surface::Extent,
};

mod assemble;
mod choice;
mod cloud;
mod cover;
mod element;
mod glued;
mod joins;
mod matrix;
mod restrict;
mod surface;

/// The pair (L, B) of a mesh, with what the eigensolver needs to know of it.
///
/// The coordinates are divided by 2^[`exponent`](Self::exponent) before anything is computed, which is exact and keeps
/// every number of a huge or tiny mesh near one. L does not notice; B is 4^exponent times smaller than the mesh's.
#[derive(Debug, Clone, PartialEq)]
pub struct Laplacian {
    /// L and B on one pattern.
    pub matrix: Symmetric,
    /// Which vertex of the mesh each row belongs to, ascending; vertices without a triangle have no row, nor have those
    /// that a Dirichlet condition holds.
    pub vertices: Vec<u32>,
    /// For each row its connected component, numbered from 0 by their first rows.
    pub component: Vec<u32>,
    /// How many connected components there are. Those that no Dirichlet condition holds have the constants in L's
    /// kernel.
    pub components: usize,
    /// 1ᵀB1 of the whole surface, boundary included, in the scaled unit.
    pub(crate) total: f64,
    /// The coordinates were divided by two to this power.
    pub exponent: i32,
    /// What was done to the mesh, one line each.
    pub notes: Vec<String>,
}

impl Laplacian {
    /// 1ᵀB1 of the whole surface in the mesh's own unit: its area for finite elements, the number of its vertices for
    /// [`Operator::Cot`]. Vertices that a Dirichlet condition holds count as well.
    #[must_use]
    pub fn measure(&self) -> f64 {
        if self.matrix.unit_mass() { self.total } else { self.total * 4_f64.powi(self.exponent) }
    }

    /// What an eigenvalue of the scaled pair is multiplied with to be one of the mesh: 1 for [`Operator::Cot`].
    #[must_use]
    pub fn unit(&self) -> f64 {
        if self.matrix.unit_mass() { 1.0 } else { 4_f64.powi(-self.exponent) }
    }
}

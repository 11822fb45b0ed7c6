//! Mesh → stiffness matrix L and mass matrix B.
//!
//! [`assemble()`] takes any triangle list: closed or with a boundary (natural, so Neumann, conditions), of one piece or
//! many, manifold or not, consistently oriented or not. Every triangle adds the positive semi-definite matrix of its
//! own metric, so L is positive semi-definite whatever the connectivity, and its kernel has one dimension per
//! connected component. What cannot be taken as it is (a repeated face, a face without area) is mended locally, and
//! [`Laplacian::notes`] says so.

use serde::{Deserialize, Serialize};

pub(crate) use self::matrix::MassMatrix;
pub use self::{
    assemble::{Extent, LaplacianError, assemble},
    matrix::Symmetric,
};

mod assemble;
mod element;
mod matrix;

/// Which eigenproblem is solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Operator {
    /// Linear finite elements, `L f = λ B f`. Unit of λ: 1/length².
    #[default]
    Fem,
    /// Cotangent weights without a mass matrix, `L f = λ f`. λ has no unit.
    Cot,
}

/// The mass matrix B of [`Operator::Fem`]; without effect on [`Operator::Cot`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mass {
    /// That of linear elements: `B_ii = Σ area/6`, `B_ij = Σ area/12` over the triangles at the edge.
    #[default]
    Consistent,
    /// Diagonal: a third of the area of the triangles around a vertex.
    Lumped,
}

/// The pair (L, B) of a mesh, with what the eigensolver needs to know of it.
///
/// The coordinates are divided by 2^[`exponent`](Self::exponent) before anything is computed, which is exact and keeps
/// every number of a huge or tiny mesh near one. L does not notice; B is 4^exponent times smaller than the mesh's.
#[derive(Debug, Clone, PartialEq)]
pub struct Laplacian {
    /// L and B on one pattern.
    pub matrix: Symmetric,
    /// Which vertex of the mesh each row belongs to, ascending; vertices without a triangle have no row.
    pub vertices: Vec<u32>,
    /// For each row its connected component, numbered from 0 by their first rows.
    pub component: Vec<u32>,
    /// How many connected components there are: the dimension of L's kernel.
    pub components: usize,
    /// The coordinates were divided by two to this power.
    pub exponent: i32,
    /// What was done to the mesh, one line each.
    pub notes: Vec<String>,
}

impl Laplacian {
    /// 1ᵀB1 in the mesh's own unit: its area for finite elements, the number of rows for [`Operator::Cot`].
    #[must_use]
    pub fn measure(&self) -> f64 {
        let sum = self.matrix.total_mass();
        if self.matrix.unit_mass() { sum } else { sum * 4_f64.powi(self.exponent) }
    }

    /// What an eigenvalue of the scaled pair is multiplied with to be one of the mesh: 1 for [`Operator::Cot`].
    #[must_use]
    pub fn unit(&self) -> f64 {
        if self.matrix.unit_mass() { 1.0 } else { 4_f64.powi(-self.exponent) }
    }
}

//! Mesh → stiffness matrix L and mass matrix B.

use serde::{Deserialize, Serialize};

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

//! Which eigenproblem of a mesh is meant.

use serde::{Deserialize, Serialize};

/// What the operator is.
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
    /// That of linear elements: `B_ii = Σ area/6`, `B_ij = Σ area/12` over the triangles at the edge. Eigenvalues lie
    /// above those of the polyhedral surface.
    #[default]
    Consistent,
    /// Diagonal: a third of the area of the triangles around a vertex. Eigenvalues are mostly too small.
    Lumped,
    /// The mean of the two: `B_ii = Σ area/4`, `B_ij = Σ area/24`. Their errors of second order are opposite on regular
    /// triangles and nearly so on good ones (blended quadrature, Ainsworth and Wajid 2010), so the mean's error is
    /// many times smaller there.
    Blended,
}

impl Mass {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Consistent, Self::Lumped, Self::Blended];
}

/// What holds on the boundary: on the edges of exactly one face.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Boundary {
    /// The natural condition: eigenfunctions arrive at the boundary without slope.
    #[default]
    Neumann,
    /// Eigenfunctions are zero on the boundary: its vertices have no row.
    Dirichlet,
}

/// Which triangles are summed over; see the [module](super).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Triangulation {
    /// The given ones where they hang together, else what [`Triangulation::Tufted`] does.
    #[default]
    Auto,
    /// The faces of the mesh.
    Given,
    /// The intrinsic Delaunay triangulation of the surface; edges that are not between exactly two faces stay.
    Delaunay,
    /// The intrinsic Delaunay triangulation of the tufted cover; vertices at one position are one.
    Tufted,
}

impl Triangulation {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 4] = [Self::Auto, Self::Given, Self::Delaunay, Self::Tufted];
}

/// Which eigenproblem.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub struct Choice {
    /// The operator.
    pub operator: Operator,
    /// Its mass matrix; always [`Mass::Consistent`] for [`Operator::Cot`], which has none.
    pub mass: Mass,
    /// The condition on the boundary.
    pub boundary: Boundary,
    /// The triangles.
    pub triangulation: Triangulation,
}

impl Choice {
    /// The choice of an operator and a mass matrix, with the natural boundary condition and the automatic choice of
    /// triangles; equal for choices that are the same eigenproblem.
    #[must_use]
    pub const fn new(operator: Operator, mass: Mass) -> Self {
        let mass = match operator {
            Operator::Fem => mass,
            Operator::Cot => Mass::Consistent,
        };
        Self { operator, mass, boundary: Boundary::Neumann, triangulation: Triangulation::Auto }
    }

    /// The same with another boundary condition.
    #[must_use]
    pub const fn with_boundary(self, boundary: Boundary) -> Self {
        Self { boundary, ..self }
    }

    /// The same on other triangles.
    #[must_use]
    pub const fn with_triangulation(self, triangulation: Triangulation) -> Self {
        Self { triangulation, ..self }
    }

    /// Numbers that stand for the choice where spectra are stored. A number that has been given out keeps its meaning
    /// for ever, whatever the order of the variants.
    #[must_use]
    pub const fn numbers(self) -> [u64; 4] {
        [
            match self.operator {
                Operator::Fem => 0,
                Operator::Cot => 1,
            },
            match self.mass {
                Mass::Consistent => 0,
                Mass::Lumped => 1,
                Mass::Blended => 2,
            },
            match self.boundary {
                Boundary::Neumann => 0,
                Boundary::Dirichlet => 1,
            },
            match self.triangulation {
                Triangulation::Auto => 0,
                Triangulation::Given => 1,
                Triangulation::Delaunay => 2,
                Triangulation::Tufted => 3,
            },
        ]
    }
}

//! The sum over the triangles.

use super::{Choice, Mass, Operator, matrix::MassMatrix, matrix::Symmetric};
use crate::{
    mesh::by_vertex::ByVertex,
    watch::{Pulse, Stopped},
};

/// Collects the contributions of the triangles to the edges, in the order of the triangles.
pub(super) struct Joins {
    /// Per contribution: smaller vertex, larger vertex, weight of L, area.
    edges: Vec<(u32, u32, f64, f64)>,
    /// Per vertex: the area of its triangles.
    area: Vec<f64>,
    /// Per vertex: the area of the triangles that have an edge from the vertex to itself.
    loops: Vec<f64>,
}

impl Joins {
    pub(super) fn new(vertices: usize, triangles: usize) -> Self {
        Self { edges: Vec::with_capacity(3 * triangles), area: vec![0.0; vertices], loops: vec![0.0; vertices] }
    }

    /// Adds a triangle: for each corner the weight of L on the edge opposite of it. Corners may be one vertex, as in an
    /// intrinsic triangulation.
    pub(super) fn add(&mut self, corners: [u32; 3], weights: [f64; 3], area: f64) {
        for at in 0..3 {
            let (a, b) = (corners[(at + 1) % 3], corners[(at + 2) % 3]);
            if a == b {
                // No difference of a function over this edge, but its two basis functions overlap.
                self.loops[a as usize] += area;
            } else {
                self.edges.push((a.min(b), a.max(b), weights[at], area));
            }
            self.area[corners[at] as usize] += area;
        }
    }

    /// L and B.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn finish(self, choice: Choice, pulse: &Pulse) -> Result<Symmetric, Stopped> {
        let n = self.area.len();
        let by_low = || self.edges.iter().map(|&(low, high, weight, area)| (low, (high, weight, area)));
        let mut sorted = ByVertex::new(n, by_low, pulse)?;
        let mut columns = Vec::with_capacity(n + 1);
        columns.push(0);
        let mut rows = Vec::with_capacity(n + self.edges.len() / 2);
        let mut stiffness = Vec::with_capacity(rows.capacity());
        let mut coupling = Vec::with_capacity(rows.capacity());
        let mut diagonal = vec![0.0; n];
        for (column, list) in sorted.lists().enumerate() {
            pulse.beat(20 * list.len())?;
            list.sort_by_key(|entry| entry.0);
            rows.push(column as u32);
            stiffness.push(0.0);
            coupling.push((self.area[column] + self.loops[column]) / 6.0);
            for group in list.chunk_by(|a, b| a.0 == b.0) {
                let weight = group.iter().fold(0.0, |sum, entry| sum + entry.1);
                rows.push(group[0].0);
                stiffness.push(-weight);
                coupling.push(group.iter().fold(0.0, |sum, entry| sum + entry.2) / 12.0);
                diagonal[column] += weight;
                diagonal[group[0].0 as usize] += weight;
            }
            columns.push(rows.len());
        }
        for column in 0..n {
            stiffness[columns[column]] = diagonal[column];
        }
        let lumped = |area: &f64| area / 3.0;
        let mass = match (choice.operator, choice.mass) {
            (Operator::Cot, _) => MassMatrix::Unit,
            (Operator::Fem, Mass::Consistent) => MassMatrix::Full(coupling),
            (Operator::Fem, Mass::Lumped) => MassMatrix::Diagonal(self.area.iter().map(lumped).collect()),
            (Operator::Fem, Mass::Blended) => {
                for value in &mut coupling {
                    *value *= 0.5;
                }
                for (area, &diagonal) in self.area.iter().zip(&columns) {
                    coupling[diagonal] += 0.5 * lumped(area);
                }
                MassMatrix::Full(coupling)
            }
        };
        Ok(Symmetric { columns, rows, stiffness, mass })
    }
}

//! L and B of one connected piece, ready for the solver.

use super::factor::{Symbolic, order};
use crate::laplacian::{MassMatrix, Symmetric};

/// The pair (L, B) in the order of elimination, with the structure of its factor.
#[derive(Debug)]
pub(super) struct Pencil {
    pub matrix: Symmetric,
    pub symbolic: Symbolic,
    pub mass: Product,
}

/// B by rows, for products with blocks.
#[derive(Debug)]
pub(super) enum Product {
    /// The identity.
    Unit,
    /// A diagonal.
    Diagonal(Vec<f64>),
    /// Both triangles by rows: offsets, columns, values.
    Rows(Vec<u32>, Vec<u32>, Vec<f64>),
}

impl Pencil {
    /// Orders and analyses. `None` when the ordering runs out of memory.
    pub(super) fn new(matrix: &Symmetric) -> Option<Self> {
        let matrix = matrix.select(&order(matrix)?);
        let symbolic = Symbolic::new(&matrix);
        let mass = match &matrix.mass {
            MassMatrix::Unit => Product::Unit,
            MassMatrix::Diagonal(values) => Product::Diagonal(values.clone()),
            MassMatrix::Full(values) => by_rows(&matrix, values),
        };
        Some(Self { matrix, symbolic, mass })
    }

    /// Number of rows.
    pub(super) fn order(&self) -> usize {
        self.matrix.order()
    }
}

fn by_rows(matrix: &Symmetric, values: &[f64]) -> Product {
    let n = matrix.order();
    let mut offsets = vec![0_u32; n + 1];
    for column in 0..n {
        for at in matrix.range(column) {
            let row = matrix.rows[at] as usize;
            offsets[row + 1] += 1;
            if row != column {
                offsets[column + 1] += 1;
            }
        }
    }
    for at in 0..n {
        offsets[at + 1] += offsets[at];
    }
    let mut next = offsets.clone();
    let mut columns = vec![0_u32; offsets[n] as usize];
    let mut entries = vec![0.0; offsets[n] as usize];
    let mut put = |row: usize, column: usize, value: f64| {
        let at = next[row] as usize;
        columns[at] = column as u32;
        entries[at] = value;
        next[row] += 1;
    };
    // By columns of the lower triangle: each row receives its left part in order, then diagonal and right part.
    for column in 0..n {
        for at in matrix.range(column) {
            let row = matrix.rows[at] as usize;
            put(row, column, values[at]);
            if row != column {
                put(column, row, values[at]);
            }
        }
    }
    Product::Rows(offsets, columns, entries)
}

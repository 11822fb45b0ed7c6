//! L and B of one connected piece, ready for the solver.

use super::{
    factor::{Order, Symbolic, order},
    product::{ByRows, Product},
};
use crate::{
    laplacian::{MassMatrix, Symmetric},
    watch::{Pulse, Stopped},
};

/// The pair (L, B) in the order of elimination, with the structure of its factor.
#[derive(Debug)]
pub(super) struct Pencil {
    pub matrix: Symmetric,
    pub symbolic: Symbolic,
    pub mass: Product,
    /// The dimension of the kernel of L.
    pub kernel: usize,
}

impl Pencil {
    /// Orders and analyses. `None` when the ordering runs out of memory.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn watched(matrix: &Symmetric, pulse: &Pulse) -> Result<Option<Self>, Stopped> {
        match order(matrix, pulse)? {
            Some(order) => Ok(Some(Self::ordered(matrix, &order, pulse)?)),
            None => Ok(None),
        }
    }

    /// The same without a watch.
    #[cfg(test)]
    pub(super) fn new(matrix: &Symmetric) -> Option<Self> {
        Self::watched(matrix, &Pulse::new(&crate::watch::Unwatched)).ok()?
    }

    /// Analyses the matrices in an order of elimination.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn ordered(matrix: &Symmetric, order: &Order, pulse: &Pulse) -> Result<Self, Stopped> {
        let matrix = matrix.select(&order.rows, pulse)?;
        let symbolic = Symbolic::new(&matrix, order, pulse)?;
        pulse.beat(30 * matrix.rows.len())?;
        let mass = match &matrix.mass {
            MassMatrix::Unit => Product::Unit,
            MassMatrix::Diagonal(values) => Product::Diagonal(values.clone()),
            MassMatrix::Full(values) => Product::Rows(ByRows::new(&matrix, values, pulse)?),
        };
        pulse.beat(10 * matrix.rows.len())?;
        let kernel = free_parts(&matrix).count;
        Ok(Self { matrix, symbolic, mass, kernel })
    }

    /// Number of rows.
    pub(super) fn order(&self) -> usize {
        self.matrix.order()
    }
}

/// The parts of a connected piece that nothing holds, each with its constants in the kernel of L.
#[derive(Debug)]
pub(super) struct FreeParts {
    /// The part of each row, or [`HELD`](Self::HELD).
    pub of: Vec<u32>,
    /// How many there are.
    pub count: usize,
}

impl FreeParts {
    /// In no such part.
    pub(super) const HELD: u32 = u32::MAX;
}

/// Where the rows of L sum to zero, but for rounding. Usually that is the whole of a piece, or nothing where a boundary
/// condition holds it: then rows beside the held vertices miss an entry. But the tip of a triangle that is a million
/// million times as long as it is wide may hang on by weights that are zero in double precision.
pub(super) fn free_parts(matrix: &Symmetric) -> FreeParts {
    let n = matrix.order();
    let mut sums = vec![(0.0, 0.0_f64, 0_u32); n];
    let mut leader: Vec<u32> = (0..n as u32).collect();
    let find = |leader: &mut [u32], mut at: u32| {
        while leader[at as usize] != at {
            leader[at as usize] = leader[leader[at as usize] as usize];
            at = leader[at as usize];
        }
        at
    };
    for (row, column, l, _) in matrix.entries() {
        let add = |(sum, size, count): &mut (f64, f64, u32)| {
            (*sum, *size, *count) = (*sum + l, *size + l.abs(), *count + 1);
        };
        add(&mut sums[row]);
        if row != column {
            add(&mut sums[column]);
            if l != 0.0 {
                let (a, b) = (find(&mut leader, row as u32), find(&mut leader, column as u32));
                leader[a.max(b) as usize] = a.min(b);
            }
        }
    }
    // The diagonal entry was the sum of the others, in some order.
    let held = |&(sum, size, count): &(f64, f64, u32)| sum.abs() > 2.0 * f64::from(count) * f64::EPSILON * size;
    let mut of = vec![0; n];
    for (row, _) in sums.iter().enumerate().filter(|(_, sums)| held(sums)) {
        of[find(&mut leader, row as u32) as usize] = FreeParts::HELD;
    }
    let mut count = 0;
    for row in 0..n {
        // The first of its part has the smallest number, and its part is known.
        let first = find(&mut leader, row as u32) as usize;
        if first == row && of[row] != FreeParts::HELD {
            of[row] = count;
            count += 1;
        }
        of[row] = of[first];
    }
    FreeParts { of, count: count as usize }
}

//! Two symmetric matrices on one sparsity pattern.

use crate::watch::{Pulse, Stopped};

/// L and B: the lower triangles of two symmetric n × n matrices on one pattern, by columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Symmetric {
    /// n + 1 offsets into the arrays below.
    pub(crate) columns: Vec<usize>,
    /// Row indices: the diagonal first, then ascending.
    pub(crate) rows: Vec<u32>,
    /// Entries of L.
    pub(crate) stiffness: Vec<f64>,
    /// B.
    pub(crate) mass: MassMatrix,
}

/// The values of B.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MassMatrix {
    /// The identity.
    Unit,
    /// A diagonal, one value per row.
    Diagonal(Vec<f64>),
    /// On the pattern of L.
    Full(Vec<f64>),
}

impl Symmetric {
    /// n, the number of rows.
    #[must_use]
    pub fn order(&self) -> usize {
        self.columns.len().saturating_sub(1)
    }

    /// The entries of the lower triangle as (row, column, L, B), column by column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64, f64)> + '_ {
        (0..self.order()).flat_map(move |column| {
            self.range(column).map(move |at| {
                let row = self.rows[at] as usize;
                let mass = match &self.mass {
                    MassMatrix::Unit => f64::from(u8::from(row == column)),
                    MassMatrix::Diagonal(values) if row == column => values[row],
                    MassMatrix::Diagonal(_) => 0.0,
                    MassMatrix::Full(values) => values[at],
                };
                (row, column, self.stiffness[at], mass)
            })
        })
    }

    /// True when B is the identity.
    #[must_use]
    pub fn unit_mass(&self) -> bool {
        matches!(self.mass, MassMatrix::Unit)
    }

    /// 1ᵀB1.
    #[must_use]
    pub fn total_mass(&self) -> f64 {
        match &self.mass {
            MassMatrix::Unit => self.order() as f64,
            MassMatrix::Diagonal(values) => values.iter().sum(),
            MassMatrix::Full(_) => {
                self.entries().map(|(row, column, _, mass)| if row == column { mass } else { 2.0 * mass }).sum()
            }
        }
    }

    /// Where the entries of a column are.
    pub(crate) fn range(&self, column: usize) -> std::ops::Range<usize> {
        self.columns[column]..self.columns[column + 1]
    }

    /// The principal submatrices on `keep` (distinct indices), in that order. The kept rows must not be coupled to
    /// others, or their entries are lost.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(crate) fn select(&self, keep: &[u32], pulse: &Pulse) -> Result<Self, Stopped> {
        let mut new = vec![u32::MAX; self.order()];
        for (at, &row) in keep.iter().enumerate() {
            new[row as usize] = at as u32;
        }
        // Each entry belongs to the column of the smaller new index.
        let mut count = vec![0_usize; keep.len() + 1];
        let place = |row: u32, column: u32| {
            let (a, b) = (new[row as usize], new[column as usize]);
            (a.min(b), a.max(b))
        };
        for &column in keep {
            for at in self.range(column as usize) {
                let (low, high) = place(self.rows[at], column);
                if high != u32::MAX {
                    count[low as usize + 1] += 1;
                }
            }
            pulse.beat(30)?;
        }
        for at in 0..keep.len() {
            count[at + 1] += count[at];
        }
        let columns = count.clone();
        let mut order = pulse.filled((0_u32, 0_usize), columns[keep.len()])?;
        for &column in keep {
            for at in self.range(column as usize) {
                let (low, high) = place(self.rows[at], column);
                if high != u32::MAX {
                    order[count[low as usize]] = (high, at);
                    count[low as usize] += 1;
                }
            }
            pulse.beat(60)?;
        }
        for column in 0..keep.len() {
            order[columns[column]..columns[column + 1]].sort_unstable();
            pulse.beat(40)?;
        }
        let mass = match &self.mass {
            MassMatrix::Unit => MassMatrix::Unit,
            MassMatrix::Diagonal(values) => {
                MassMatrix::Diagonal(keep.iter().map(|&row| values[row as usize]).collect())
            }
            MassMatrix::Full(values) => MassMatrix::Full(order.iter().map(|&(_, at)| values[at]).collect()),
        };
        pulse.beat(5 * order.len())?;
        let rows = order.iter().map(|&(row, _)| row).collect();
        pulse.beat(2 * order.len())?;
        let stiffness = order.iter().map(|&(_, at)| self.stiffness[at]).collect();
        pulse.beat(5 * order.len())?;
        Ok(Self { columns, rows, stiffness, mass })
    }

    /// Neighbours of every row as (offsets, indices): the off-diagonal pattern of both triangles.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(crate) fn graph(&self, pulse: &Pulse) -> Result<(Vec<usize>, Vec<u32>), Stopped> {
        let n = self.order();
        let mut offsets = vec![0_usize; n + 1];
        let pairs = |visit: &mut dyn FnMut(usize, usize)| {
            for column in 0..n {
                pulse.beat(20)?;
                for at in self.range(column) {
                    let row = self.rows[at] as usize;
                    if row != column {
                        visit(row, column);
                    }
                }
            }
            Ok(())
        };
        pairs(&mut |row, column| {
            offsets[row + 1] += 1;
            offsets[column + 1] += 1;
        })?;
        for at in 0..n {
            offsets[at + 1] += offsets[at];
        }
        pulse.beat(2 * n)?;
        let mut next = offsets.clone();
        let mut neighbours = pulse.filled(0_u32, offsets[n])?;
        pairs(&mut |row, column| {
            neighbours[next[row]] = column as u32;
            next[row] += 1;
            neighbours[next[column]] = row as u32;
            next[column] += 1;
        })?;
        Ok((offsets, neighbours))
    }
}

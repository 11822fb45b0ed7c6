//! What single precision costs where orthogonalisation takes out much.

use super::{Basis, Krylov, Scratch, product};
use crate::spectrum::{
    block::Square,
    lanes::WIDTH,
    poll::{Poll, Stop},
};

impl Krylov<'_> {
    /// Takes what is left of the basis out of the block after the newest, once more.
    pub(super) fn again(
        &mut self,
        blocks: usize,
        lost: &mut [Square],
        beta: &mut Square,
        poll: &mut Poll,
    ) -> Result<(), Stop> {
        let Scratch { next, work, .. } = &mut *self.scratch;
        work.flat().copy_from_slice(next.flat());
        let more = self.orthogonalise(blocks, None, poll)?;
        for (lost, more) in lost.iter_mut().zip(&more) {
            let more = product(more, beta);
            for (lost, more) in lost.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
                *lost += more;
            }
        }
        *beta = product(&self.normalise(blocks, poll)?, beta);
        Ok(())
    }

    /// By how much the projected operator is off because the basis is in single precision: the components that
    /// orthogonalisation took out are those along rounded vectors, whose products with each other are not quite those
    /// of an orthonormal basis.
    pub(in crate::spectrum) fn leak(&self) -> f64 {
        match self.basis {
            Basis::Single => {
                let columns = self.lost.iter().flat_map(|lost| (0..WIDTH).map(|column| norm(lost, column)));
                f64::from(f32::EPSILON) * columns.fold(0.0, f64::max)
            }
            Basis::Double(_) => 0.0,
        }
    }
}

/// The norm of a column of squares that stand on each other.
pub(super) fn norm(squares: &[Square], column: usize) -> f64 {
    squares.iter().flatten().map(|row| row[column] * row[column]).sum::<f64>().sqrt()
}

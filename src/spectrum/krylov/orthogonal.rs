//! Keeping a basis orthogonal, and what it costs that it is in single precision and not orthogonal to the last digit.
//!
//! Not every step needs all earlier blocks for that. A loss that is small grows in one step by a ratio of couplings,
//! and counts in the second order only (see [`projected()`](super::projected())), as long as what is taken out of a
//! block stays in the projected operator (partial reorthogonalisation: Simon 1984; for blocks Grimes, Lewis and Simon
//! 1994, § 4.3). They estimate the losses; here they are measured where they are taken out.

use super::{Basis, Krylov, Scratch, product};
use crate::spectrum::{
    block::{Dots, Multiply, Square, Update},
    lanes::{Buffer, Row, WIDTH, dispatch},
    panel::{Panel, PanelDots, PanelUpdate},
    pencil::Product,
    poll::{Poll, Stop},
    timings::Cost,
};

/// The first blocks, which every step is made orthogonal to: they hold the eigenvectors nearest to the shift, along
/// which losses grow a hundredfold in a step where they grow tenfold along others.
pub(super) const FIRST: usize = 3;

/// Where orthogonalisation to the others took less than this share out of a block, the next step may leave them to the
/// step after it.
const SLIGHT: f64 = 2e-6;

impl Krylov<'_> {
    /// How many blocks the next step is made orthogonal to.
    pub(super) fn against(&self) -> usize {
        let blocks = self.blocks();
        let all = self.due || matches!(self.basis, Basis::Double(_));
        if all { blocks } else { FIRST.min(blocks) }
    }

    /// Makes `work` B-orthogonal to the first so many blocks and to the locked vectors, and returns its components
    /// along the blocks, without those along the newest one that are known already.
    pub(super) fn orthogonalise(
        &mut self,
        blocks: usize,
        known: Option<&Square>,
        poll: &mut Poll,
    ) -> Result<Vec<Square>, Stop> {
        let Scratch { blocks: basis, images, exact, now, work, mass, newest, room, .. } = &mut *self.scratch;
        let mut sums = Vec::new();
        match self.basis {
            Basis::Single => {
                let basis: Vec<&[Panel]> = basis[..blocks].iter().map(Vec::as_slice).collect();
                // VᵀBw is (BV)ᵀw where there is BV, and else Vᵀ(Bw).
                let (w, sums) = (work.rows(), &mut sums);
                if blocks <= FIRST {
                    let images: Vec<&[Panel]> = images[..blocks].iter().map(Vec::as_slice).collect();
                    let less = known.map(|alpha| (now.rows(), alpha));
                    dispatch(PanelDots { basis: &images, mass: &Product::Unit, w, less, room, sums });
                } else {
                    let less = known.map(|alpha| (newest.rows(), alpha));
                    dispatch(PanelDots { basis: &basis, mass: &self.pencil.mass, w, less, room, sums });
                }
                poll.spend(work.rows().len() * blocks * WIDTH / 2)?;
                let single: Vec<_> = sums.iter().map(|sum| sum.map(|row| row.map(|value| value as f32))).collect();
                let less = known.map(|alpha| (now.rows(), alpha));
                dispatch(PanelUpdate { basis: &basis, factors: &single, w: work.rows_mut(), less });
                poll.spend(work.rows().len() * blocks * WIDTH / 2)?;
            }
            Basis::Double(locked) => {
                let all: Vec<&[Row]> = exact[..blocks].iter().chain(locked).map(Buffer::rows).collect();
                dispatch(Multiply { mass: &self.pencil.mass, x: work.rows(), to: mass.rows_mut() });
                poll.charge(Cost::Products);
                sums.resize(all.len(), Square::default());
                dispatch(Dots { basis: &all, t: mass.rows(), sums: &mut sums });
                poll.spend(work.rows().len() * all.len() * WIDTH)?;
                dispatch(Update { basis: &all, factors: &sums, w: work.rows_mut() });
                poll.spend(work.rows().len() * all.len() * WIDTH)?;
                sums.truncate(blocks);
            }
        }
        poll.charge(Cost::Orthogonalisation);
        Ok(sums)
    }

    /// Whether a block is to be made orthogonal once more.
    ///
    /// Where more was taken out than is left, one pass in single precision leaves too much of it: the space is
    /// exhausted but for what hardly differs, as where some triangles are many orders smaller than the others. And
    /// where little is left, what a step did not look for may be too much of that: it is some ten times what the step
    /// before took out.
    pub(super) fn spoilt(&self, lost: &[Square], beta: &Square) -> bool {
        let unseen = if lost.len() < self.blocks() { self.taken / (10.0 * SLIGHT) } else { 0.0 };
        (0..WIDTH).any(|column| norm(lost, column).max(unseen) > norm(&[*beta], column))
    }

    /// Takes what is left of the basis out of the block after the newest, once more.
    pub(super) fn again(
        &mut self,
        blocks: usize,
        lost: &mut Vec<Square>,
        beta: &mut Square,
        poll: &mut Poll,
    ) -> Result<(), Stop> {
        let Scratch { next, work, .. } = &mut *self.scratch;
        work.flat().copy_from_slice(next.flat());
        let more = self.orthogonalise(blocks, None, poll)?;
        lost.resize(blocks, Square::default());
        for (lost, more) in lost.iter_mut().zip(&more) {
            let more = product(more, beta);
            for (lost, more) in lost.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
                *lost += more;
            }
        }
        *beta = product(&self.normalise(blocks, poll)?, beta);
        Ok(())
    }

    /// Notes what orthogonalisation took out of a block, and what the next step has to do.
    pub(super) fn note(&mut self, lost: &[Square], beta: &Square) {
        let largest = |squares: &[Square]| (0..WIDTH).map(|column| norm(squares, column)).fold(0.0, f64::max);
        if let Basis::Single = self.basis {
            let rounded = largest(lost) * f64::from(f32::EPSILON);
            let couplings = self.alpha.iter().zip(self.beta.iter().chain([beta]));
            let skew = lost.iter().zip(couplings).map(|(lost, (alpha, beta))| {
                let (lost, coupling) = (largest(&[*lost]), largest(&[*alpha, *beta]));
                lost * (lost / coupling).min(1.0)
            });
            self.off = self.off.max(rounded).max(skew.sum());
        }
        let others = &lost[FIRST.min(lost.len())..];
        let slight = (0..WIDTH).all(|column| norm(others, column) <= SLIGHT * norm(&[*beta], column));
        self.due = !slight || lost.len() < self.alpha.len();
        self.taken = largest(others);
    }

    /// By how much the projected operator is off, for two reasons. The components C that orthogonalisation took out
    /// are those along vectors rounded to single precision, whose products with each other are not quite those of an
    /// orthonormal basis. And that basis is off orthogonality by some Ω, and the operator by ‖Ω‖ ‖C‖
    /// ([`projected()`](super::projected())). C came of Ω, multiplied by couplings: of what was taken out along a block
    /// its share in the coupling there is what Ω was.
    pub(in crate::spectrum) fn leak(&self) -> f64 {
        self.off
    }
}

/// The norm of a column of squares that stand on each other.
pub(super) fn norm(squares: &[Square], column: usize) -> f64 {
    squares.iter().flatten().map(|row| row[column] * row[column]).sum::<f64>().sqrt()
}

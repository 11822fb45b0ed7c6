//! Keeping a basis orthogonal, in single precision and not in every step.
//!
//! Let V be the basis, T the block tridiagonal matrix of the recurrence, and C what orthogonalisation takes out of
//! the products besides, so that `S V = V (T + C)` but for the last block, with entries of C above the diagonal of
//! blocks only. With `VᵀBV = RᵀR` by Cholesky's decomposition, N = V R⁻¹ is orthonormal, and
//! `NᵀBSN = R (T + C) R⁻¹`. The left side is symmetric, and below the diagonal the right side is that of T alone,
//! scaled by the blocks on the diagonal of R. These are 1 up to the squares of what the basis lacks, and so is the
//! diagonal of the product that of T, as long as neighbouring blocks are orthogonal to rounding. So T is the
//! projected operator, whatever C is (Simon 1984, *The Lanczos algorithm with partial reorthogonalization*), and two
//! things are needed:
//!
//! - neighbouring blocks orthogonal to all digits: that is the recurrence's work, in double precision;
//! - all others to about the root of the accuracy that is wanted. What single precision leaves, some 3e-9, grows
//!   tenfold in a step, so that most steps can do without. Because a block comes of the two before it, it is the last
//!   two that are made orthogonal together (Grimes, Lewis and Simon 1994, *A shifted block Lanczos algorithm*, § 4.3),
//!   in one pass over the basis: for its bytes are what that costs. [`Losses`] says when it is due.
//!
//! A basis in double precision is made orthogonal to all blocks in every step. It is for pieces where the squares
//! count, too, so that there C is known and enters the operator ([`projected()`](super::projected())).

use std::ops::Range;

use super::{Basis, Krylov, Scratch, product};
use crate::spectrum::{
    block::{Dots, Square, Update},
    lanes::{Buffer, Row, WIDTH, dispatch},
    panel::{PairUpdate, Panel, PanelDots, PanelUpdate, Right, STRETCH, Sums, factor, total},
    poll::{Poll, Stop},
    product::{Multiply, Product},
    timings::Cost,
};

/// The first blocks, which every step is made orthogonal to: they hold the eigenvectors nearest to the shift, along
/// which losses grow a hundredfold in a step where they grow tenfold along others.
pub(super) const FIRST: usize = 3;

/// What a pass in single precision leaves of orthogonality.
const FLOOR: f64 = 5e-9;

/// How far the newest block may be from orthogonal when the next one is made without looking at the basis, where the
/// eigenvalues that are wanted reach as far from the shift σ as zero does. By its square s² times a few 1/h the
/// projected operator may be off, if h is the farthest of their distances, and λ there by that times h². Relative to λ
/// this is a few s² h/σ: where h is smaller beside σ, as in all slices but the lowest, more may be lost for the same.
const SLIGHT: f64 = 4e-7;

/// How far a block may be from orthogonal to stay in the basis.
const MOST: f64 = 1e-4;

/// How far the blocks of a basis are from orthogonal to those before them, but for the first ones.
#[derive(Debug, Default)]
pub(super) struct Losses {
    /// How far the newest block may be off.
    slight: f64,
    /// The newest block and the one before it, as estimated.
    newest: f64,
    before: f64,
    /// The largest square of what a block lacks, times its couplings: since the last pass as estimated, and before.
    since: f64,
    square: f64,
    /// Half of what a block has lost in length because it was mended: what the next block is coupled to is shorter.
    shortened: Option<Square>,
    /// The largest error of what was taken out, for being a combination of rounded vectors.
    rounded: f64,
}

impl Losses {
    /// Nothing is lost yet.
    pub(super) fn new(sigma: f64, basis: Basis) -> Self {
        let slight = match basis {
            Basis::Single { reach } => SLIGHT * (sigma / reach).max(1.0).sqrt(),
            Basis::Double(_) => SLIGHT,
        };
        Self { slight, ..Self::default() }
    }

    /// Whether the next step has to look at the whole basis.
    fn due(&self) -> bool {
        self.newest > self.slight
    }

    /// What a step loses with couplings of these norms along the basis and to the block before the newest, and so
    /// little left at least: the recurrence of the basis, multiplied with the basis (Simon 1984), in norms.
    fn grown(&self, along: f64, before: f64, left: f64) -> f64 {
        ((along * self.newest + before * self.before) / left).max(FLOOR)
    }

    /// A pass over the basis has mended the newest block, which was so far off and has couplings of that norm.
    fn mend(&mut self, off: f64, coupled: f64) {
        // The blocks since the last pass were estimated as the newest one was.
        let since = self.since * (off / self.newest).powi(2).max(1.0);
        self.square = self.square.max(since).max(off * FLOOR.max(off * off) * coupled);
        (self.newest, self.since) = (FLOOR, 0.0);
    }

    fn round(&mut self, taken: &[Square]) {
        self.rounded = self.rounded.max(largest(taken) * f64::from(f32::EPSILON));
    }

    /// A new block that is so far off, after one with couplings of that norm.
    fn push(&mut self, off: f64, coupled: f64) {
        self.since = self.since.max(self.newest * self.newest * coupled);
        (self.before, self.newest) = (self.newest, off);
    }

    #[cfg(test)]
    pub(super) fn spoil(&mut self, off: f64) {
        self.newest = off;
    }

    /// By how much the projected operator is off, in the Frobenius norm of a block, on both sides of it.
    fn leak(&self) -> f64 {
        2.0 * WIDTH as f64 * self.square.max(self.since) + self.rounded
    }
}

impl Krylov<'_> {
    /// Whether the next step is made orthogonal to all blocks, together with the newest one.
    pub(super) fn due(&self) -> bool {
        self.blocks() > FIRST + 1 && self.losses.due()
    }

    /// The coupling of the newest block to the one before it.
    fn coupled(&self) -> f64 {
        self.beta.last().map_or(0.0, |beta| largest(&[*beta]))
    }

    /// The largest coupling of blocks of the basis but for the first ones: ‖T‖ among them.
    fn reach(&self) -> f64 {
        let couplings = self.alpha.iter().zip(&self.beta).skip(FIRST);
        couplings.map(|(alpha, beta)| largest(&[*alpha, *beta])).fold(0.0, f64::max)
    }

    /// Makes `work` B-orthogonal to the basis, as far as the step has to: takes the newest block times `along` out of
    /// it, and what is there of others. `seen` are its components along the first blocks, if they are known. Returns
    /// the norm of what was there, if it was looked for along all older blocks.
    pub(super) fn orthogonalise(
        &mut self,
        along: &Square,
        seen: Vec<Square>,
        poll: &mut Poll,
    ) -> Result<Option<f64>, Stop> {
        let older = self.blocks() - 1;
        let lost = match self.basis {
            Basis::Double(_) => {
                let Scratch { now, work, .. } = &mut *self.scratch;
                dispatch(Update { basis: &[now.rows()], factors: &[*along], w: work.rows_mut() });
                let lost = self.clean(older + 1, poll)?;
                self.lost.push(lost);
                None
            }
            Basis::Single { .. } if self.due() => Some(self.pair(along, poll)?),
            Basis::Single { .. } => {
                let count = older.min(FIRST);
                let Scratch { blocks, images, now, work, .. } = &mut *self.scratch;
                let mut sums = seen;
                let less = Some((now.rows(), along));
                if sums.is_empty() {
                    let right = Right { mass: &Product::Unit, w: work.rows(), less };
                    sums = products(&images.first(count), None, right, poll)?.iter().map(total).collect();
                }
                take_out(&blocks.first(count), &sums, work.rows_mut(), less, poll)?;
                self.losses.round(&sums);
                (count == older).then(|| largest(&sums))
            }
        };
        poll.charge(Cost::Orthogonalisation);
        Ok(lost)
    }

    /// Makes the newest block V and `work` orthogonal to all older blocks.
    ///
    /// With C the components of V, and D those of w = `work` − V M: `V' = V − Σ Vₖ Cₖ` and
    /// `w' = w − Σ Vₖ Dₖ + V Σ CₖᵀDₖ`, so that these two neighbours stay orthogonal to the second order, too.
    fn pair(&mut self, along: &Square, poll: &mut Poll) -> Result<f64, Stop> {
        let older = self.blocks() - 1;
        let Scratch { blocks, now, work, image, .. } = &mut *self.scratch;
        let (basis, copy) = blocks.split(older);
        let right = Right { mass: &self.pencil.mass, w: work.rows(), less: Some((image.rows(), along)) };
        let sums = products(&basis, Some(image.rows()), right, poll)?;
        let side = |side: usize| -> Vec<Square> { sums.iter().map(|sums| sums.map(|rows| rows[side])).collect() };
        let (mut c, d) = (side(0), side(1));
        // It is orthogonal to the block before it to more digits than are seen here.
        c[older - 1] = Square::default();
        let along: Square = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let both = c.iter().zip(&d).flat_map(|(c, d)| c.iter().zip(d));
                both.fold(along[i][j], |left, (c, d)| left - c[i] * d[j])
            })
        });
        if let Some(alpha) = self.alpha.last_mut() {
            *alpha = symmetric(&along);
        }
        let factors: Vec<_> = c.iter().zip(&d).map(|(c, d)| factor(c, d)).collect();
        let (w, v) = (work.rows_mut(), now.rows_mut());
        poll.meter.timings.pairs += 2 * older;
        poll.meter.timings.passed += older;
        for rows in stretches(w.len(), older).rev() {
            poll.spend(rows.len() * older * WIDTH)?;
            dispatch(PairUpdate { basis: &basis, factors: &factors, v, copy, w, along: &along, rows });
        }
        // The newest block has become shorter by half of CᵀC, and T is that of blocks of length one: what is below its
        // diagonal block there is so much more, and what is beside it so much less.
        let lacks: Square = std::array::from_fn(|i| {
            std::array::from_fn(|j| 0.5 * c.as_flattened().iter().fold(0.0, |sum, row| sum + row[i] * row[j]))
        });
        if let Some(beta) = self.beta.last_mut() {
            let less = product(&lacks, beta);
            for (beta, less) in beta.as_flattened_mut().iter_mut().zip(less.as_flattened()) {
                *beta -= less;
            }
        }
        self.losses.mend(largest(&c), largest(&[along]).max(self.coupled()));
        self.losses.shortened = Some(lacks);
        self.losses.round(&d);
        Ok(largest(&d))
    }

    /// Makes `work` orthogonal to the first so many blocks, but for the last of them if the basis is in single
    /// precision ([`next_to`](Self::next_to) does that), and to the locked vectors. Returns its components along the
    /// blocks.
    pub(super) fn clean(&mut self, blocks: usize, poll: &mut Poll) -> Result<Vec<Square>, Stop> {
        let Scratch { blocks: basis, exact, work, image, .. } = &mut *self.scratch;
        let len = work.rows().len();
        let mut sums = Vec::new();
        match self.basis {
            Basis::Single { .. } => {
                let basis = basis.first(blocks.saturating_sub(1));
                let right = Right { mass: &self.pencil.mass, w: work.rows(), less: None };
                sums = products(&basis, None, right, poll)?.iter().map(total).collect();
                take_out(&basis, &sums, work.rows_mut(), None, poll)?;
            }
            Basis::Double(locked) => {
                let all: Vec<&[Row]> = exact[..blocks].iter().chain(locked).map(Buffer::rows).collect();
                dispatch(Multiply { mass: &self.pencil.mass, x: work.rows(), to: image.rows_mut() });
                poll.charge(Cost::Products);
                sums.resize(all.len(), Square::default());
                dispatch(Dots { basis: &all, t: image.rows(), sums: &mut sums });
                poll.spend(len * all.len() * WIDTH)?;
                dispatch(Update { basis: &all, factors: &sums, w: work.rows_mut() });
                poll.spend(len * all.len() * WIDTH)?;
                sums.truncate(blocks);
            }
        }
        poll.charge(Cost::Orthogonalisation);
        Ok(sums)
    }

    /// Makes `work` orthogonal to the newest block; `image` is B times it before, and not after.
    pub(super) fn next_to(&mut self) {
        let Scratch { now, work, image, .. } = &mut *self.scratch;
        let mut sum = [Square::default()];
        dispatch(Dots { basis: &[now.rows()], t: image.rows(), sums: &mut sum });
        dispatch(Update { basis: &[now.rows()], factors: &sum, w: work.rows_mut() });
    }

    /// Whether so little is left of a column that it is not orthogonal to the newest block to rounding.
    pub(super) fn shrunk(&self, gram: &Square) -> bool {
        let Some(alpha) = self.alpha.last() else { return false };
        (0..WIDTH).any(|column| {
            let before = self.beta.last().map_or(0.0, |beta| beta[column].iter().map(|value| value * value).sum());
            gram[column][column] < 1e-2 * (norm(&[*alpha], column).powi(2) + before)
        })
    }

    /// Notes what a step has lost, and takes what is left of the basis out of the next block if that is too much: where
    /// hardly anything was left of it, the space being exhausted but for what hardly differs, as where some triangles
    /// are many orders smaller than the others.
    pub(super) fn note(&mut self, lost: Option<f64>, beta: &mut Square, poll: &mut Poll) -> Result<(), Stop> {
        if matches!(self.basis, Basis::Double(_)) {
            return self.note_all(beta, poll);
        }
        if let Some(shortened) = self.losses.shortened.take() {
            let more = product(beta, &shortened);
            for (beta, more) in beta.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
                *beta += more;
            }
        }
        let blocks = self.blocks();
        let left = (0..WIDTH).map(|column| norm(&[*beta], column)).fold(f64::INFINITY, f64::min);
        let mut off = match lost {
            Some(lost) => FLOOR * (lost / left).max(1.0),
            None => self.losses.grown(self.reach(), self.coupled(), left),
        };
        if off.is_nan() || off > MOST {
            self.clean(blocks, poll)?;
            self.gram(poll);
            self.next_to();
            *beta = product(&self.normalise(blocks, poll)?, beta);
            off = FLOOR;
        }
        let own = self.alpha.last().map_or(0.0, |alpha| largest(&[*alpha, *beta]));
        self.losses.push(off, own.max(self.coupled()));
        Ok(())
    }

    /// The same for a basis in double precision: where more was taken out than is left, it is looked for once more.
    fn note_all(&mut self, beta: &mut Square, poll: &mut Poll) -> Result<(), Stop> {
        let Some(mut lost) = self.lost.pop() else { return Ok(()) };
        if (0..WIDTH).any(|column| norm(&lost, column) > norm(&[*beta], column)) {
            let more = self.clean(self.blocks(), poll)?;
            for (lost, more) in lost.iter_mut().zip(&more) {
                let more = product(more, beta);
                for (lost, more) in lost.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
                    *lost += more;
                }
            }
            *beta = product(&self.normalise(self.blocks(), poll)?, beta);
        }
        self.lost.push(lost);
        Ok(())
    }

    /// By how much the projected operator is off: ‖T‖ times the square of what the basis is off orthogonality by, and
    /// what comes of rounding.
    pub(in crate::spectrum) fn leak(&self) -> f64 {
        self.losses.leak()
    }
}

/// [`PanelDots`] over all rows.
fn products(basis: &[&[Panel]], v: Option<&[Row]>, right: Right, poll: &mut Poll) -> Result<Vec<Sums>, Stop> {
    let mut sums = vec![Sums::default(); basis.len()];
    for rows in stretches(right.w.len(), basis.len()) {
        poll.spend(rows.len() * basis.len() * WIDTH)?;
        dispatch(PanelDots { basis, v, right, rows, sums: &mut sums });
    }
    Ok(sums)
}

/// [`PanelUpdate`] of all rows.
fn take_out(
    basis: &[&[Panel]],
    factors: &[Square],
    w: &mut [Row],
    less: Option<(&[Row], &Square)>,
    poll: &mut Poll,
) -> Result<(), Stop> {
    poll.meter.timings.pairs += basis.len();
    poll.meter.timings.passed += basis.len();
    let factors: Vec<_> = factors.iter().map(|square| factor(square, square)).collect();
    for rows in stretches(w.len(), basis.len()).rev() {
        poll.spend(rows.len() * basis.len() * WIDTH)?;
        dispatch(PanelUpdate { basis, factors: &factors, w, less, rows });
    }
    Ok(())
}

/// Ranges of rows that a pass over so many blocks takes a few milliseconds for.
fn stretches(len: usize, blocks: usize) -> impl DoubleEndedIterator<Item = Range<usize>> {
    let step = ((1 << 22) / (blocks.max(1) * WIDTH * STRETCH)).max(1) * STRETCH;
    (0..len.div_ceil(step)).map(move |at| at * step..len.min((at + 1) * step))
}

/// The symmetric part.
pub(super) fn symmetric(square: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (square[i][j] + square[j][i])))
}

/// The norm of a column of squares that stand on each other.
pub(super) fn norm(squares: &[Square], column: usize) -> f64 {
    squares.iter().flatten().map(|row| row[column] * row[column]).sum::<f64>().sqrt()
}

/// The largest of these norms.
fn largest(squares: &[Square]) -> f64 {
    (0..WIDTH).map(|column| norm(squares, column)).fold(0.0, f64::max)
}

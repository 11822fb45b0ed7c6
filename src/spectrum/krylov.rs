//! Shift-invert block Lanczos.
//!
//! The operator (L − σB)⁻¹B is self-adjoint in the inner product of B; its eigenvalues are θ = 1/(λ − σ), so the λ
//! nearest to σ on both sides come first. The basis is kept [orthogonal], because what is lost there comes back as
//! copies of eigenvalues.

pub(super) use self::random::Random;
use self::{
    orthogonal::{FIRST, Losses, symmetric},
    projected::{cholesky, product, projected},
};
use super::{
    band_reduction::block_eigen,
    block::{Combine, Dots, Residual, Square, Update},
    factor::Factor,
    lanes::{Buffer, Row, WIDTH, dispatch},
    panel::{Blocks, Normalise, Panel, Recur, Sums, total},
    pencil::Pencil,
    poll::{Poll, Stop},
    product::Multiply,
    small::{eigen, identity},
    timings::Cost,
};

mod orthogonal;
mod projected;
mod random;

/// Inverse iterations on the start block. They take out of it what lies far from the shift at the price of a solve
/// each, where a Lanczos step costs a block of the basis as well.
const WARMING: usize = 3;

/// How much of each column must be independent of the columns before it in a block that stays (by Cholesky's
/// decomposition Q is orthonormal to rounding over that), and in one that is only to be multiplied again.
const STRICTLY: f64 = 1e-2;
const ROUGHLY: f64 = 1e-9;

/// The most blocks of a basis in single precision.
pub(super) const LONGEST: usize = 49;

/// Decompositions of a block after which it is taken as it is.
const ROUNDS: usize = 7;

/// Memory that one run leaves to the next.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// The basis in single precision, and B times its first blocks.
    blocks: Blocks,
    images: Blocks,
    /// The basis in double precision.
    exact: Vec<Buffer>,
    /// The newest block V of the basis and the one before it, in double precision.
    now: Buffer,
    past: Buffer,
    /// A⁻¹B V, then the next block before it is normalised.
    work: Buffer,
    /// B V, until nothing is to be compared with it any more, then B `work`.
    image: Buffer,
    small: Vec<f64>,
    tails: Vec<Row>,
    #[cfg(test)]
    pub tamper: super::faults::Tamper,
}

/// An approximate eigenvalue.
#[derive(Debug, Clone, Copy)]
pub(super) struct Ritz {
    /// λ = σ + 1/θ.
    pub value: f64,
    /// θ.
    pub theta: f64,
    /// Norm of the residual of θ in the norm of B.
    pub residual: f64,
}

/// How a basis is kept.
#[derive(Debug, Clone, Copy)]
pub(super) enum Basis<'a> {
    /// In single precision: half the bytes, for eigenvalues alone, of which those are wanted that are so near to the
    /// shift.
    Single { reach: f64 },
    /// In double precision, and orthogonal to these vectors, in whole blocks: for eigenvectors, and where the basis
    /// comes to hold much of the space.
    Double(&'a [Buffer]),
}

impl<'a> Basis<'a> {
    fn locked(self) -> &'a [Buffer] {
        match self {
            Self::Single { .. } => &[],
            Self::Double(locked) => locked,
        }
    }
}

/// A Lanczos process at one shift.
pub(super) struct Krylov<'a> {
    pencil: &'a Pencil,
    factor: &'a Factor,
    sigma: f64,
    scratch: &'a mut Scratch,
    basis: Basis<'a>,
    /// Diagonal blocks of the projected operator.
    alpha: Vec<Square>,
    /// Blocks below the diagonal: `beta[j]` couples block j to block j + 1.
    beta: Vec<Square>,
    /// How far the basis is from orthogonal, if it is in single precision.
    losses: Losses,
    /// For each step what orthogonalisation took out of the product, if the basis is in double precision.
    lost: Vec<Vec<Square>>,
    /// For each vector of the first block by how much the solve was wrong: see [`accuracy`](Self::accuracy).
    wrong: [f64; WIDTH],
    /// Whether the products with S were those with a symmetric operator, as they are unless something is wrong.
    symmetric: bool,
    random: Random,
}

impl<'a> Krylov<'a> {
    /// Starts with a random block of this seed.
    ///
    /// # Errors
    /// When cancelled.
    pub(super) fn start(
        pencil: &'a Pencil,
        factor: &'a Factor,
        sigma: f64,
        seed: u64,
        basis: Basis<'a>,
        scratch: &'a mut Scratch,
        poll: &mut Poll,
    ) -> Result<Self, Stop> {
        let len = pencil.order() * WIDTH;
        let Scratch { now, past, work, image, .. } = &mut *scratch;
        for buffer in [now, past, work, image] {
            buffer.reserve(len);
            poll.spend(8 * len)?;
        }
        if matches!(basis, Basis::Single { .. }) {
            scratch.blocks.reserve(pencil.order(), LONGEST);
            scratch.images.reserve(pencil.order(), FIRST);
        }
        let mut random = Random(seed);
        for values in scratch.work.flat().chunks_mut(1 << 18) {
            values.fill_with(|| random.next());
            poll.spend(8 * values.len())?;
        }
        let mut this = Self {
            pencil,
            factor,
            sigma,
            scratch,
            basis,
            alpha: Vec::new(),
            beta: Vec::new(),
            losses: Losses::new(sigma, basis),
            lost: Vec::new(),
            wrong: [0.0; WIDTH],
            symmetric: true,
            random,
        };
        for _ in 0..WARMING {
            let (_, inverse) = this.decompose(0, ROUGHLY, poll)?;
            let Scratch { work, image, .. } = &mut *this.scratch;
            std::mem::swap(work, image);
            dispatch(Combine { x: work.rows_mut(), factor: &inverse });
            poll.charge(Cost::Blocks);
            this.apply(poll)?;
        }
        this.normalise(0, poll)?;
        this.keep();
        Ok(this)
    }

    /// Blocks in the basis, of which the last one has not been multiplied yet.
    pub(super) fn blocks(&self) -> usize {
        self.beta.len() + 1
    }

    /// One more block.
    ///
    /// # Errors
    /// When cancelled.
    pub(super) fn step(&mut self, poll: &mut Poll) -> Result<(), Stop> {
        let blocks = self.blocks();
        self.apply(poll)?;
        if blocks == 1 {
            self.measure();
            poll.charge(Cost::Solves);
        }
        let (along, seen) = self.recur();
        poll.spend(2 * WIDTH * self.scratch.work.rows().len())?;
        let lost = self.orthogonalise(&along, seen, poll)?;
        let mut beta = self.normalise(blocks, poll)?;
        self.note(lost, &mut beta, poll)?;
        self.beta.push(beta);
        self.keep();
        Ok(())
    }

    /// `work = A⁻¹ image`, where `work` holds a copy of `image`.
    fn apply(&mut self, poll: &mut Poll) -> Result<(), Stop> {
        self.factor.solve(&self.pencil.symbolic, self.scratch.work.rows_mut(), poll)?;
        #[cfg(test)]
        self.scratch.tamper.solution(self.scratch.work.rows_mut());
        Ok(())
    }

    /// Lets a test take out, repeat or move what was found.
    #[cfg(test)]
    pub(super) fn tamper(&mut self, sides: &mut super::slice::Sides) {
        self.scratch.tamper.sides(sides);
    }

    /// Looks how well `work` solves (L − σB) work = image, for the first block.
    fn measure(&mut self) {
        // There is no block before it.
        let Scratch { now, past, work, image, .. } = &mut *self.scratch;
        past.flat().copy_from_slice(image.flat());
        let r = past.rows_mut();
        dispatch(Residual { matrix: &self.pencil.matrix, sigma: self.sigma, x: work.rows(), r });
        let mut sum = [Square::default()];
        dispatch(Dots { basis: &[now.rows()], t: past.rows(), sums: &mut sum });
        self.wrong = std::array::from_fn(|j| sum[0].iter().fold(0.0, |most, row| row[j].abs().max(most)));
    }

    /// By how much the errors of the factorisation and the solves shift eigenvalues, from the first block.
    ///
    /// The solution w = S v of a solve has the residual r = Bv − (L − σB) w = E w, where E is what the solve was for
    /// in excess of L − σB, and shifts the eigenvalue of x by xᵀEx. Of this the products vᵀr of the first block with
    /// the residuals of the first block, divided by the norms of w, are samples; the largest one is returned.
    pub(super) fn accuracy(&self) -> f64 {
        let (Some(alpha), Some(beta)) = (self.alpha.first(), self.beta.first()) else { return 0.0 };
        let norm = |j: usize| alpha.iter().chain(beta).map(|row| row[j] * row[j]).sum::<f64>().sqrt();
        self.wrong.iter().enumerate().fold(0.0, |most, (j, wrong)| (wrong / norm(j)).max(most))
    }

    /// The three-term recurrence: takes what is along the block before the newest out of `work`. Returns its components
    /// along the newest, which are left for [`orthogonalise`](Self::orthogonalise) to take out, and along the first
    /// blocks, if that is all it has to look at.
    fn recur(&mut self) -> (Square, Vec<Square>) {
        let few = matches!(self.basis, Basis::Single { .. }) && self.blocks() > FIRST + 1 && !self.due();
        let Scratch { past, work, image, images, .. } = &mut *self.scratch;
        let mut along = [Square::default()];
        let mut seen = vec![Sums::default(); if few { FIRST } else { 0 }];
        if let Some(beta) = self.beta.last() {
            let factor: Square = std::array::from_fn(|i| std::array::from_fn(|j| beta[j][i]));
            let (past, newest, w) = (past.rows(), image.rows(), work.rows_mut());
            let basis = images.first(seen.len());
            along[0] = dispatch(Recur { past, factor: &factor, newest, w, basis: &basis, sums: &mut seen });
        } else {
            dispatch(Dots { basis: &[image.rows()], t: work.rows(), sums: &mut along });
        }
        let [along] = along;
        let alpha = symmetric(&along);
        let coupled = alpha.iter().chain(self.beta.last().into_iter().flatten()).flatten();
        let largest = coupled.fold(0.0_f64, |most, entry| most.max(entry.abs()));
        let skew = along.as_flattened().iter().zip(alpha.as_flattened());
        let skew = skew.fold(0.0_f64, |most, (along, alpha)| most.max((along - alpha).abs()));
        // False for NaN too.
        self.symmetric &= skew <= 5e-6 * largest;
        self.alpha.push(alpha);
        (along, seen.iter().map(total).collect())
    }

    /// `work = Q R` with `QᵀBQ = 1` by Cholesky's decomposition of the Gram matrix. Q is to be the block `at` of the
    /// basis and takes the place of `work`; `BQ` is in `image` and, where the block before the newest was, in `past`.
    /// Columns that depend on the others are replaced by random ones, with zeros in R.
    fn normalise(&mut self, at: usize, poll: &mut Poll) -> Result<Square, Stop> {
        let (total, inverse) = self.decompose(at, STRICTLY, poll)?;
        let Scratch { blocks, images, past, work, image, .. } = &mut *self.scratch;
        let mut single: [&mut [Panel]; 2] = [&mut [], &mut []];
        if matches!(self.basis, Basis::Single { .. }) {
            single[0] = blocks.block_mut(at);
            if at < FIRST {
                single[1] = images.block_mut(at);
            }
        }
        let (x, y, copy) = (work.rows_mut(), image.rows_mut(), past.rows_mut());
        dispatch(Normalise { x, y, factor: &inverse, copy, single });
        poll.charge(Cost::Blocks);
        poll.spend(4 * WIDTH * work.rows().len())?;
        Ok(total)
    }

    /// Finds R and a matrix M such that `work M` is B-orthonormal, with `B work` in `image`; `work` may have changed
    /// for that, so that it was `work M R` at first.
    fn decompose(&mut self, blocks: usize, share: f64, poll: &mut Poll) -> Result<(Square, Square), Stop> {
        let mut total: Square = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        if blocks == 0 && !self.basis.locked().is_empty() {
            self.clean(0, poll)?;
        }
        let mut round = 0;
        loop {
            let mut gram = self.gram(poll);
            if blocks > 0 && (round > 0 || self.shrunk(&gram)) {
                self.next_to();
                gram = self.gram(poll);
            }
            let work = &mut self.scratch.work;
            poll.spend(2 * WIDTH * work.rows().len())?;
            let (upper, inverse, worst, lost) = cholesky(&gram);
            // The rows of lost columns are zero, so that their random replacements stay out of R.
            total = product(&upper, &total);
            round += 1;
            if (lost == 0 && worst > share) || round == ROUNDS {
                return Ok((total, inverse));
            }
            dispatch(Combine { x: work.rows_mut(), factor: &inverse });
            poll.charge(Cost::Blocks);
            // Cholesky's Q is off by rounding over `worst`: it takes a second round, but Q still has the basis's
            // complement to nearly all digits.
            if lost == 0 && worst > 1e-6 {
                continue;
            }
            // Nearly dependent columns have lost their orthogonality to the basis, replaced ones never had it.
            for at in (0..WIDTH).filter(|at| lost >> at & 1 == 1) {
                for row in self.scratch.work.rows_mut() {
                    row[at] = self.random.next();
                }
            }
            for _ in 0..=usize::from(lost != 0) {
                self.clean(blocks, poll)?;
            }
        }
    }

    /// `image = B work`; returns the Gram matrix of `work`.
    fn gram(&mut self, poll: &mut Poll) -> Square {
        let Scratch { work, image, .. } = &mut *self.scratch;
        let gram = dispatch(Multiply { mass: &self.pencil.mass, x: work.rows(), to: image.rows_mut() });
        poll.charge(Cost::Products);
        gram
    }

    /// Takes `work` as the next block of the basis, and has B times it, which is in `past`, multiplied next.
    fn keep(&mut self) {
        let at = self.beta.len();
        let Scratch { exact, now, past, work, .. } = &mut *self.scratch;
        if matches!(self.basis, Basis::Double(_)) {
            if exact.len() == at {
                exact.push(Buffer::default());
            }
            exact[at].reserve(self.pencil.order() * WIDTH);
            exact[at].rows_mut().copy_from_slice(work.rows());
        }
        std::mem::swap(past, now);
        std::mem::swap(now, work);
    }

    /// The Ritz values of the basis without its last block, by distance from the shift. None when the products with
    /// the operator cannot have been right.
    pub(super) fn ritz(&mut self, poll: &mut Poll) -> Option<Vec<Ritz>> {
        if !self.symmetric {
            return None;
        }
        let blocks = self.alpha.len();
        poll.charge(Cost::Rest);
        let Scratch { small, tails, .. } = &mut *self.scratch;
        let theta = match self.basis {
            Basis::Single { .. } => block_eigen(&self.alpha, &self.beta, tails)?,
            Basis::Double(_) => {
                let n = blocks * WIDTH;
                projected(&self.alpha, &self.beta, &self.lost, small);
                tails.clear();
                tails.resize(n, [0.0; WIDTH]);
                for at in 0..WIDTH {
                    tails[n - WIDTH + at][at] = 1.0;
                }
                eigen(small, n, tails)?
            }
        };
        poll.charge(Cost::Dense);
        let last = &self.beta[blocks - 1];
        let mut found: Vec<Ritz> = theta
            .iter()
            .zip(tails.iter())
            .map(|(&theta, tail)| {
                let square: f64 =
                    last.iter().map(|row| row.iter().zip(tail).fold(0.0, |sum, (r, s)| sum + r * s).powi(2)).sum();
                Ritz { value: self.sigma + 1.0 / theta, theta, residual: square.sqrt() }
            })
            .collect();
        found.sort_by(|a, b| b.theta.abs().total_cmp(&a.theta.abs()));
        Some(found)
    }
}

impl Krylov<'_> {
    /// The Ritz vectors of the values among [`ritz`](Self::ritz)'s that `wanted` names, eight to a block, padded with
    /// zeros. For a basis in double precision.
    pub(super) fn vectors(&mut self, wanted: &[Ritz]) -> Option<Vec<Buffer>> {
        let blocks = self.alpha.len();
        let n = blocks * WIDTH;
        projected(&self.alpha, &self.beta, &self.lost, &mut self.scratch.small);
        let mut all = identity(n);
        let theta = eigen(&self.scratch.small, n, &mut all)?;
        // Equal values belong to different columns.
        let mut columns: Vec<usize> = Vec::with_capacity(wanted.len());
        for ritz in wanted {
            let new = |at: &usize| theta[*at] == ritz.theta && !columns.contains(at);
            if let Some(at) = (0..n).find(new) {
                columns.push(at);
            }
        }
        let basis: Vec<&[Row]> = self.scratch.exact[..blocks].iter().map(Buffer::rows).collect();
        let made = columns.chunks(WIDTH).map(|columns| {
            let mut factors = vec![Square::default(); blocks];
            for (at, &column) in columns.iter().enumerate() {
                for (block, factor) in factors.iter_mut().enumerate() {
                    for (row, value) in factor.iter_mut().zip(all[column * blocks + block]) {
                        row[at] = -value;
                    }
                }
            }
            let mut to = Buffer::default();
            to.reserve(self.pencil.order() * WIDTH);
            to.flat().fill(0.0);
            dispatch(Update { basis: &basis, factors: &factors, w: to.rows_mut() });
            to
        });
        Some(made.collect())
    }
}

#[cfg(test)]
mod tests;

//! Shift-invert block Lanczos.
//!
//! The operator (L − σB)⁻¹B is self-adjoint in the inner product of B; its eigenvalues are θ = 1/(λ − σ), so the λ
//! nearest to σ on both sides come first. The basis is kept B-orthogonal in full, block against all earlier blocks,
//! because what is lost there comes back as copies of eigenvalues (Grimes, Lewis and Simon 1994, § 4).

use super::{
    block::{Combine, Dots, Multiply, Square, Update},
    factor::Factor,
    lanes::{Buffer, Row, WIDTH, dispatch},
    panel::{Panel, PanelDots, PanelUpdate, Round, panels},
    pencil::Pencil,
    poll::{Poll, Stop},
    small::{eigen, identity},
    timings::Cost,
};

/// Inverse iterations on the start block. They take out of it what lies far from the shift at the price of a solve
/// each, where a Lanczos step costs a block of the basis as well.
const WARMING: usize = 3;

/// How much of each column must be independent of the columns before it in a block that stays (by Cholesky's
/// decomposition Q is orthonormal to rounding over that), and in one that is only to be multiplied again.
const STRICTLY: f64 = 1e-3;
const ROUGHLY: f64 = 1e-9;

/// Memory that one run leaves to the next.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    /// The basis in single precision.
    blocks: Vec<Vec<Panel>>,
    /// The basis in double precision, where eigenvectors are wanted of it.
    exact: Vec<Buffer>,
    /// The newest block of the basis and the one before it.
    now: Buffer,
    past: Buffer,
    /// A⁻¹B V, then the next block before it is normalised.
    work: Buffer,
    /// B times that.
    mass: Buffer,
    /// B V of the newest block.
    newest: Buffer,
    small: Vec<f64>,
    tails: Vec<Row>,
    room: Vec<Row>,
    sums: Vec<Square>,
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

/// What a basis is for.
#[derive(Debug, Clone, Copy)]
pub(super) enum Purpose<'a> {
    /// Eigenvalues alone: it is kept in single precision.
    Values,
    /// Eigenvectors too: it is kept in double precision, and orthogonal to these vectors, in whole blocks.
    Vectors(&'a [Buffer]),
}

impl<'a> Purpose<'a> {
    fn locked(self) -> &'a [Buffer] {
        match self {
            Self::Values => &[],
            Self::Vectors(locked) => locked,
        }
    }
}

/// A Lanczos process at one shift.
pub(super) struct Krylov<'a> {
    pencil: &'a Pencil,
    factor: &'a Factor,
    sigma: f64,
    scratch: &'a mut Scratch,
    purpose: Purpose<'a>,
    /// Diagonal blocks of the projected operator.
    alpha: Vec<Square>,
    /// Blocks below the diagonal: `beta[j]` couples block j to block j + 1.
    beta: Vec<Square>,
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
        purpose: Purpose<'a>,
        scratch: &'a mut Scratch,
        poll: &mut Poll,
    ) -> Result<Self, Stop> {
        let len = pencil.order() * WIDTH;
        let Scratch { now, past, work, mass, newest, .. } = &mut *scratch;
        for buffer in [now, past, work, mass, newest] {
            buffer.reserve(len);
        }
        let mut random = Random(seed);
        scratch.work.flat().fill_with(|| random.next());
        let mut this = Self { pencil, factor, sigma, scratch, purpose, alpha: Vec::new(), beta: Vec::new(), random };
        for _ in 0..WARMING {
            this.normalise(0, ROUGHLY, poll)?;
            this.apply(poll)?;
        }
        this.normalise(0, STRICTLY, poll)?;
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
        self.recur();
        poll.charge(Cost::Orthogonalisation);
        self.orthogonalise(blocks, poll)?;
        let beta = self.normalise(blocks, STRICTLY, poll)?;
        self.beta.push(beta);
        self.keep();
        Ok(())
    }

    /// `work = A⁻¹ newest`.
    fn apply(&mut self, poll: &mut Poll) -> Result<(), Stop> {
        self.scratch.work.flat().copy_from_slice(self.scratch.newest.flat());
        poll.charge(Cost::Rest);
        self.factor.solve(&self.pencil.symbolic, self.scratch.work.rows_mut(), poll)
    }

    /// The three-term recurrence: takes out of `work` its large components, those along the last two blocks. Only
    /// then is one pass of orthogonalisation enough: it multiplies what orthogonality the basis lacks with what it
    /// removes.
    fn recur(&mut self) {
        let at = self.alpha.len();
        let Scratch { now, past, work, newest, .. } = &mut *self.scratch;
        if let Some(before) = at.checked_sub(1) {
            let beta = &self.beta[before];
            let factor: Square = std::array::from_fn(|i| std::array::from_fn(|j| beta[j][i]));
            dispatch(Update { basis: &[past.rows()], factors: &[factor], w: work.rows_mut() });
        }
        let mut sum = [Square::default()];
        dispatch(Dots { basis: &[newest.rows()], t: work.rows(), sums: &mut sum });
        let [sum] = sum;
        let alpha: Square = std::array::from_fn(|i| std::array::from_fn(|j| 0.5 * (sum[i][j] + sum[j][i])));
        dispatch(Update { basis: &[now.rows()], factors: &[alpha], w: work.rows_mut() });
        self.alpha.push(alpha);
    }

    /// Makes `work` B-orthogonal to the locked vectors and to so many blocks.
    fn orthogonalise(&mut self, blocks: usize, poll: &mut Poll) -> Result<(), Stop> {
        let Scratch { blocks: basis, exact, now, past, work, mass, room, sums: single, .. } = &mut *self.scratch;
        if self.purpose.locked().is_empty() && blocks == 0 {
            return Ok(());
        }
        let double = matches!(self.purpose, Purpose::Vectors(_));
        let recent = if double { &exact[..blocks] } else { &[] };
        let last = if double { 0 } else { blocks };
        let all: Vec<&[Row]> = self
            .purpose
            .locked()
            .iter()
            .chain(recent)
            .chain([&*now, &*past].into_iter().take(last))
            .map(Buffer::rows)
            .collect();
        dispatch(Multiply { mass: &self.pencil.mass, x: work.rows(), to: mass.rows_mut() });
        poll.charge(Cost::Products);
        let mut sums = vec![Square::default(); all.len()];
        dispatch(Dots { basis: &all, t: mass.rows(), sums: &mut sums });
        poll.spend(work.rows().len() * all.len() * WIDTH)?;
        dispatch(Update { basis: &all, factors: &sums, w: work.rows_mut() });
        poll.spend(work.rows().len() * all.len() * WIDTH)?;
        if !double {
            let basis: Vec<&[Panel]> = basis[..blocks.saturating_sub(2)].iter().map(Vec::as_slice).collect();
            dispatch(PanelDots { basis: &basis, t: mass.rows(), room, sums: single });
            poll.spend(work.rows().len() * basis.len() * WIDTH / 2)?;
            let factors: Vec<_> = single.iter().map(|square| square.map(|row| row.map(|value| value as f32))).collect();
            dispatch(PanelUpdate { basis: &basis, factors: &factors, w: work.rows_mut() });
            poll.spend(work.rows().len() * basis.len() * WIDTH / 2)?;
        }
        poll.charge(Cost::Orthogonalisation);
        Ok(())
    }

    /// `work = Q R` with `QᵀBQ = 1` by Cholesky's decomposition of the Gram matrix; Q in `work`, `BQ` in `newest`.
    /// Columns that depend on the others are replaced by random ones, with zeros in R.
    fn normalise(&mut self, blocks: usize, share: f64, poll: &mut Poll) -> Result<Square, Stop> {
        let mut total: Square = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        if blocks == 0 && !self.purpose.locked().is_empty() {
            self.orthogonalise(0, poll)?;
        }
        for _ in 0..6 {
            let Scratch { work, mass, newest, .. } = &mut *self.scratch;
            let gram = dispatch(Multiply { mass: &self.pencil.mass, x: work.rows(), to: mass.rows_mut() });
            poll.charge(Cost::Products);
            let (upper, inverse, worst, lost) = cholesky(&gram);
            dispatch(Combine { x: work.rows(), factor: &inverse, to: newest.rows_mut() });
            std::mem::swap(work, newest);
            dispatch(Combine { x: mass.rows(), factor: &inverse, to: newest.rows_mut() });
            poll.charge(Cost::Blocks);
            poll.spend(4 * WIDTH * work.rows().len())?;
            // The rows of lost columns are zero, so that their random replacements stay out of R.
            total = product(&upper, &total);
            if lost == 0 && worst > share {
                return Ok(total);
            }
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
                self.orthogonalise(blocks, poll)?;
            }
        }
        Ok(total)
    }

    /// Takes `work` as the next block of the basis.
    fn keep(&mut self) {
        let at = self.beta.len();
        let Scratch { blocks, exact, now, past, work, .. } = &mut *self.scratch;
        match self.purpose {
            Purpose::Values => {
                if blocks.len() == at {
                    blocks.push(Vec::new());
                }
                blocks[at].resize(panels(work.rows().len()), Panel::default());
                dispatch(Round { x: work.rows(), to: &mut blocks[at] });
            }
            Purpose::Vectors(_) => {
                if exact.len() == at {
                    exact.push(Buffer::default());
                }
                exact[at].reserve(self.pencil.order() * WIDTH);
                exact[at].rows_mut().copy_from_slice(work.rows());
            }
        }
        std::mem::swap(past, now);
        std::mem::swap(now, work);
    }

    /// The Ritz values of the basis without its last block, by distance from the shift.
    pub(super) fn ritz(&mut self, poll: &mut Poll) -> Option<Vec<Ritz>> {
        let blocks = self.alpha.len();
        let n = blocks * WIDTH;
        let Scratch { small, tails, .. } = &mut *self.scratch;
        projected(&self.alpha, &self.beta, small);
        tails.clear();
        tails.resize(n, [0.0; WIDTH]);
        for at in 0..WIDTH {
            tails[n - WIDTH + at][at] = 1.0;
        }
        poll.charge(Cost::Rest);
        let theta = eigen(small, n, tails)?;
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
        projected(&self.alpha, &self.beta, &mut self.scratch.small);
        let mut all = identity(n);
        let theta = eigen(&mut self.scratch.small, n, &mut all)?;
        let columns: Vec<usize> =
            wanted.iter().filter_map(|ritz| theta.iter().position(|theta| *theta == ritz.theta)).collect();
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

/// The projected operator as a full matrix.
pub(super) fn projected(alpha: &[Square], beta: &[Square], to: &mut Vec<f64>) {
    let n = alpha.len() * WIDTH;
    to.clear();
    to.resize(n * n, 0.0);
    for (block, alpha) in alpha.iter().enumerate() {
        let first = block * WIDTH;
        for i in 0..WIDTH {
            for j in 0..WIDTH {
                to[(first + i) * n + first + j] = alpha[i][j];
                if block + 1 < n / WIDTH {
                    to[(first + WIDTH + i) * n + first + j] = beta[block][i][j];
                    to[(first + j) * n + first + WIDTH + i] = beta[block][i][j];
                }
            }
        }
    }
}

/// Upper triangular R with `RᵀR = G`, its inverse, the smallest ratio of a pivot to its diagonal entry, and which
/// columns depend on those before them (their rows of R and columns of the inverse are zero).
fn cholesky(gram: &Square) -> (Square, Square, f64, u32) {
    let mut upper = Square::default();
    let mut worst = 1.0_f64;
    let mut lost = 0_u32;
    for k in 0..WIDTH {
        let mut pivot = gram[k][k];
        for row in &upper[..k] {
            pivot -= row[k] * row[k];
        }
        let ratio = pivot / gram[k][k];
        // False for NaN too.
        let independent = ratio > 1e-13 && gram[k][k] > 0.0;
        if !independent {
            lost |= 1 << k;
            continue;
        }
        worst = worst.min(ratio);
        let root = pivot.sqrt();
        upper[k][k] = root;
        for j in k + 1..WIDTH {
            let mut sum = 0.5 * (gram[k][j] + gram[j][k]);
            for row in &upper[..k] {
                sum -= row[k] * row[j];
            }
            upper[k][j] = sum / root;
        }
    }
    let mut inverse = Square::default();
    for j in (0..WIDTH).filter(|j| lost >> j & 1 == 0) {
        inverse[j][j] = 1.0 / upper[j][j];
        for i in (0..j).rev().filter(|i| lost >> i & 1 == 0) {
            let sum = (i + 1..=j).fold(0.0, |sum, k| sum + upper[i][k] * inverse[k][j]);
            inverse[i][j] = -sum / upper[i][i];
        }
    }
    (upper, inverse, worst, lost)
}

fn product(a: &Square, b: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..WIDTH).fold(0.0, |sum, k| sum + a[i][k] * b[k][j])))
}

/// Numbers between −1 and 1 (splitmix64).
#[derive(Debug)]
pub(super) struct Random(pub u64);

impl Random {
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

#[cfg(test)]
mod tests;

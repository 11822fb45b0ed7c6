//! Eigenvalues of symmetric block tridiagonal matrices, by a reduction that keeps the band.
//!
//! A sweep of QR decompositions makes the blocks below the diagonal upper triangular, so that eight entries are left
//! below each diagonal entry. Then column after column is reduced to one of them by a Householder reflection of eight
//! rows, and the bulge that it makes is chased along the band by further ones (Schwarz 1968, *Tridiagonalization of a
//! symmetric band matrix*, there with rotations; Murata and Horikoshi 1975; Lang 1993, *A parallel algorithm for
//! reducing symmetric banded matrices to tridiagonal form*). Only the first column of a bulge is reduced, the others
//! wait for the next columns' turn. That is 12 n² rows of eight operations in place of n³ / 8.
//!
//! The matrix is turned over first, its last row becoming the first. What is wanted of the eigenvectors are their last
//! rows, and those of the transformation are then changed by the first reflection of each column only. It is also what
//! is accurate for a matrix that falls off towards its end, as those of a Lanczos process do (Parlett 1998, *The
//! Symmetric Eigenvalue Problem*, section 8.13).

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::{
    block::Square,
    implicit_ql::{ImplicitQl, NOTHING, unit_scale},
    lanes::{Kernel, Lanes, Row, WIDTH, dispatch, sum},
};

/// Eigenvalues of the symmetric block tridiagonal matrix with the diagonal blocks `alpha` and the blocks `beta` below
/// them (those beyond are not looked at), in no particular order, and into `tails` the last eight entries of each
/// eigenvector. `None` when a number is not finite.
///
/// Only the lower triangles of `alpha` are read. The values have errors of a few roundings of the matrix's norm.
pub(super) fn block_eigen(alpha: &[Square], beta: &[Square], tails: &mut Vec<Row>) -> Option<Vec<f64>> {
    let n = alpha.len() * WIDTH;
    tails.clear();
    tails.resize(n, [0.0; WIDTH]);
    if n == 0 {
        return Some(Vec::new());
    }
    for at in 0..WIDTH {
        tails[WIDTH - 1 - at][at] = 1.0;
    }
    let mut band = Band::new(alpha, beta)?;
    let (mut diagonal, mut beside) = (vec![0.0; n], vec![0.0; n]);
    dispatch(Reduce { band: &mut band, tails, diagonal: &mut diagonal, beside: &mut beside });
    // The iteration is to find the values at the large end first, while few roundings are in them.
    diagonal.reverse();
    beside[..n - 1].reverse();
    tails.reverse();
    if !dispatch(ImplicitQl { vectors: tails, per: 1, diagonal: &mut diagonal, beside: &mut beside }) {
        return None;
    }
    for value in &mut diagonal {
        *value /= band.scale;
    }
    diagonal.iter().all(|value| value.is_finite()).then_some(diagonal)
}

/// Numbers kept of a column: eight above the diagonal, which mean nothing, and sixteen from it on, as many as there are
/// beside a bulge.
const HEIGHT: usize = 3 * WIDTH;

/// A symmetric matrix by columns, in half-bandwidth 15, followed by zeros for what reaches beyond its end.
struct Band {
    columns: Vec<f64>,
    n: usize,
    /// What the matrix has been multiplied by.
    scale: f64,
}

/// Where the entries of a column from this row on begin.
#[inline(always)]
fn place(row: usize, column: usize) -> usize {
    column * HEIGHT + WIDTH + row - column
}

/// H = I − τ v vᵀ on eight rows.
#[derive(Clone, Copy)]
struct Reflection<R> {
    row: Row,
    v: R,
    tau: f64,
}

/// The reflection that leaves nothing of x after the entry `first` and does not touch those before it, and what it
/// makes of that entry.
#[inline(always)]
fn reflection<L: Lanes>(lanes: L, x: &Row, first: usize) -> (Reflection<L::Reg>, f64) {
    let mut row = *x;
    row[..=first].fill(0.0);
    let head = x[first];
    let tail = sum(&lanes.row(lanes.mul(lanes.load(&row), lanes.load(&row))));
    if tail <= NOTHING {
        return (Reflection { row: [0.0; WIDTH], v: lanes.zero(), tau: 0.0 }, head);
    }
    let square = head.mul_add(head, tail);
    let norm = square.sqrt();
    let entry = if head > 0.0 { -norm } else { norm };
    row[first] = head - entry;
    // 2 / vᵀv
    let tau = 1.0 / head.abs().mul_add(norm, square);
    (Reflection { row, v: lanes.load(&row), tau }, entry)
}

/// Half the diagonal and all below it, by columns: what gives a symmetric matrix when its transpose is added.
const LOWER: Square = {
    let mut columns = [[0.0; WIDTH]; WIDTH];
    let mut column = 0;
    while column < WIDTH {
        columns[column][column] = 0.5;
        let mut row = column + 1;
        while row < WIDTH {
            columns[column][row] = 1.0;
            row += 1;
        }
        column += 1;
    }
    columns
};

/// Columns times a vector.
#[inline(always)]
fn times<L: Lanes>(lanes: L, columns: &[L::Reg; WIDTH], v: &Row) -> L::Reg {
    let [mut even, mut odd] = [lanes.zero(); 2];
    for at in 0..WIDTH / 2 {
        even = lanes.add_mul(even, columns[2 * at], lanes.splat(v[2 * at]));
        odd = lanes.add_mul(odd, columns[2 * at + 1], lanes.splat(v[2 * at + 1]));
    }
    lanes.add(even, odd)
}

impl Band {
    /// The matrix turned over, with entries of at most 2.
    fn new(alpha: &[Square], beta: &[Square]) -> Option<Self> {
        let blocks = alpha.len();
        let beta = &beta[..blocks - 1];
        let scale = unit_scale(alpha.iter().chain(beta).flatten().flatten())?;
        let n = blocks * WIDTH;
        let mut columns = vec![0.0; (n + 3 * WIDTH) * HEIGHT];
        for (block, alpha) in alpha.iter().rev().enumerate() {
            let first = block * WIDTH;
            for column in 0..WIDTH {
                let (rows, _) = columns[place(first, first + column)..].as_chunks_mut::<WIDTH>();
                let turned = WIDTH - 1 - column;
                rows[0] =
                    std::array::from_fn(|row| scale * alpha[turned.max(WIDTH - 1 - row)][turned.min(WIDTH - 1 - row)]);
                if block + 1 < blocks {
                    let beta = &beta[blocks - 2 - block];
                    rows[1] = std::array::from_fn(|row| scale * beta[turned][WIDTH - 1 - row]);
                }
            }
        }
        Some(Self { columns, n, scale })
    }

    /// Eight rows of eight columns.
    #[inline(always)]
    fn window<L: Lanes>(&self, lanes: L, row: usize, column: usize) -> [L::Reg; WIDTH] {
        let numbers = &self.columns[place(row, column)..][..WIDTH * HEIGHT];
        let mut window = [lanes.zero(); WIDTH];
        for (at, to) in window.iter_mut().enumerate() {
            let (rows, _) = numbers[at * (HEIGHT - 1)..].as_chunks();
            *to = lanes.load(&rows[0]);
        }
        window
    }

    #[inline(always)]
    fn put<L: Lanes>(&mut self, lanes: L, row: usize, column: usize, values: [L::Reg; WIDTH]) {
        let numbers = &mut self.columns[place(row, column)..][..WIDTH * HEIGHT];
        for (at, value) in values.into_iter().enumerate() {
            let (rows, _) = numbers[at * (HEIGHT - 1)..].as_chunks_mut();
            rows[0] = lanes.row(value);
        }
    }

    /// The square on the diagonal from row `at` on becomes H D H.
    #[inline(always)]
    fn both<L: Lanes>(&mut self, lanes: L, at: usize, h: &Reflection<L::Reg>) {
        let mut d = self.window(lanes, at, at);
        let (mut lower, mut along) = (d, d);
        for ((lower, along), mask) in lower.iter_mut().zip(&mut along).zip(&LOWER) {
            *lower = lanes.mul(*lower, lanes.load(mask));
            *along = lanes.mul(*lower, h.v);
        }
        let upper = lanes.sums(along);
        let p = lanes.mul(lanes.add(times(lanes, &lower, &h.row), upper), lanes.splat(h.tau));
        let shift = 0.5 * h.tau * sum(&lanes.row(lanes.mul(p, h.v)));
        let w = lanes.sub_mul(p, h.v, lanes.splat(shift));
        let row = lanes.row(w);
        for (column, (&row, &v)) in d.iter_mut().zip(row.iter().zip(&h.row)) {
            let once = lanes.sub_mul(*column, h.v, lanes.splat(row));
            *column = lanes.sub_mul(once, w, lanes.splat(v));
        }
        self.put(lanes, at, at, d);
    }

    /// The square below that becomes L H; returned.
    #[inline(always)]
    fn right<L: Lanes>(&self, lanes: L, at: usize, h: &Reflection<L::Reg>) -> [L::Reg; WIDTH] {
        let mut l = self.window(lanes, at + WIDTH, at);
        let y = lanes.mul(times(lanes, &l, &h.row), lanes.splat(h.tau));
        for (column, &v) in l.iter_mut().zip(&h.row) {
            *column = lanes.sub_mul(*column, y, lanes.splat(v));
        }
        l
    }

    /// H L
    #[inline(always)]
    fn left<L: Lanes>(lanes: L, h: &Reflection<L::Reg>, l: &mut [L::Reg; WIDTH]) {
        let mut along = *l;
        for column in &mut along {
            *column = lanes.mul(*column, h.v);
        }
        let z = lanes.row(lanes.mul(lanes.sums(along), lanes.splat(h.tau)));
        for (column, &z) in l.iter_mut().zip(&z) {
            *column = lanes.sub_mul(*column, h.v, lanes.splat(z));
        }
    }

    /// Sets what a reflection has left of a column from this row on.
    #[inline(always)]
    fn clear(&mut self, row: usize, column: usize, entry: f64, rows: usize) {
        let numbers = &mut self.columns[place(row, column)..][..rows];
        numbers.fill(0.0);
        numbers[0] = entry;
    }

    /// Eight rows of one column.
    #[inline(always)]
    fn column(&self, row: usize, column: usize) -> &Row {
        let (rows, _) = self.columns[place(row, column)..].as_chunks();
        &rows[0]
    }

    /// Makes the blocks below the diagonal upper triangular.
    #[inline(always)]
    fn triangular<L: Lanes>(&mut self, lanes: L) {
        for at in (0..self.n - WIDTH).step_by(WIDTH) {
            let below = at + WIDTH;
            for step in 0..WIDTH - 1 {
                let (h, entry) = reflection(lanes, self.column(below, at + step), step);
                if h.tau != 0.0 {
                    let mut l = self.window(lanes, below, at);
                    Self::left(lanes, &h, &mut l);
                    self.put(lanes, below, at, l);
                    self.both(lanes, below, &h);
                    let next = self.right(lanes, below, &h);
                    self.put(lanes, below + WIDTH, below, next);
                }
                self.clear(below + step, at + step, entry, WIDTH - step);
            }
        }
    }

    /// Applies a reflection to both sides of the rows from `at` on. The first column of the bulge that this makes is
    /// reduced by the reflection that is returned, of the next eight rows.
    #[inline(always)]
    fn chase<L: Lanes>(&mut self, lanes: L, at: usize, h: &Reflection<L::Reg>) -> Reflection<L::Reg> {
        self.both(lanes, at, h);
        let mut l = self.right(lanes, at, h);
        let (next, entry) = reflection(lanes, &lanes.row(l[0]), 0);
        Self::left(lanes, &next, &mut l);
        l[0] = lanes.load(&[entry, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        self.put(lanes, at + WIDTH, at, l);
        next
    }
}

/// Columns that are reduced at a time, so that a reflection does not have to wait for the one before it: each bulge
/// follows the one before.
const BULGES: usize = 2;
/// By so many windows of eight rows: a bulge needs what is two windows further down.
const DISTANCE: usize = 3;

/// Reduces the matrix to tridiagonal form.
struct Reduce<'a> {
    band: &'a mut Band,
    /// The first rows of the transformation, by columns.
    tails: &'a mut [Row],
    diagonal: &'a mut [f64],
    beside: &'a mut [f64],
}

impl Kernel for Reduce<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { band, tails, diagonal, beside } = self;
        let n = band.n;
        band.triangular(lanes);
        for first in (0..n).step_by(BULGES) {
            let mut newest = [reflection(lanes, &[0.0; WIDTH], 0).0; BULGES];
            let windows = (n - first).div_ceil(WIDTH);
            for step in 0..windows + DISTANCE * (BULGES - 1) {
                for (bulge, h) in newest.iter_mut().enumerate() {
                    let Some(window) = step.checked_sub(DISTANCE * bulge) else { continue };
                    let k = first + bulge;
                    let at = k + 1 + window * WIDTH;
                    if window == 0 && k < n {
                        diagonal[k] = *band.column(k, k).first().unwrap_or(&0.0);
                        let (start, entry) = reflection(lanes, band.column(k + 1, k), 0);
                        beside[k] = entry;
                        apply(lanes, &mut tails[k + 1..n.min(k + 1 + WIDTH)], &start);
                        *h = start;
                    }
                    if at < n {
                        *h = band.chase(lanes, at, h);
                    }
                }
            }
        }
    }
}

/// Rows times H.
#[inline(always)]
fn apply<L: Lanes>(lanes: L, rows: &mut [Row], h: &Reflection<L::Reg>) {
    let mut along = lanes.zero();
    for (row, &v) in rows.iter().zip(&h.row) {
        along = lanes.add_mul(along, lanes.load(row), lanes.splat(v));
    }
    let along = lanes.mul(along, lanes.splat(h.tau));
    for (row, &v) in rows.iter_mut().zip(&h.row) {
        *row = lanes.row(lanes.sub_mul(lanes.load(row), along, lanes.splat(v)));
    }
}

#[cfg(test)]
mod tests;

//! Kernels on blocks of eight vectors.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::lanes::{Kernel, Lanes, Row, WIDTH};
use crate::laplacian::{MassMatrix, Symmetric};

/// Eight by eight numbers, by rows.
pub(super) type Square = [Row; WIDTH];

/// Rows that stay in the first cache while all blocks of a basis pass by.
const TILE: usize = 128;

/// A row less a row of U times M, `factor` holding the rows of M.
#[inline(always)]
pub(super) fn less<L: Lanes>(lanes: L, from: L::Reg, u: &Row, factor: &[L::Reg; WIDTH]) -> L::Reg {
    factor.iter().zip(u).fold(from, |left, (&factor, &value)| lanes.sub_mul(left, lanes.splat(value), factor))
}

/// A row times M, `factor` holding the rows of M.
#[inline(always)]
pub(super) fn combine<L: Lanes>(lanes: L, row: &Row, factor: &[L::Reg; WIDTH]) -> L::Reg {
    let mut sum = lanes.zero();
    for (&factor, &value) in factor.iter().zip(row) {
        sum = lanes.add_mul(sum, lanes.splat(value), factor);
    }
    sum
}

/// Adds Vᵢᵀ t to the i-th square for every block of a basis.
pub(super) struct Dots<'a, 'b> {
    pub basis: &'a [&'b [Row]],
    pub t: &'a [Row],
    pub sums: &'a mut [Square],
}

impl Kernel for Dots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, t, sums } = self;
        for (tile, t) in t.chunks(TILE).enumerate() {
            let first = tile * TILE;
            for (block, total) in basis.iter().zip(sums.iter_mut()) {
                let block = &block[first..first + t.len()];
                let mut sum: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&total[at]));
                for (row, t) in block.iter().zip(t) {
                    let t = lanes.load(t);
                    for (sum, &value) in sum.iter_mut().zip(row) {
                        *sum = lanes.add_mul(*sum, lanes.splat(value), t);
                    }
                }
                for (total, sum) in total.iter_mut().zip(sum) {
                    *total = lanes.row(sum);
                }
            }
        }
    }
}

/// `w −= Σ Vᵢ Cᵢ` over the blocks of a basis.
pub(super) struct Update<'a, 'b> {
    pub basis: &'a [&'b [Row]],
    pub factors: &'a [Square],
    pub w: &'a mut [Row],
}

impl Kernel for Update<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, w } = self;
        for (tile, w) in w.chunks_mut(TILE).enumerate() {
            let first = tile * TILE;
            for (block, factor) in basis.iter().zip(factors) {
                let block = &block[first..first + w.len()];
                let factor: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&factor[at]));
                for (w, row) in w.iter_mut().zip(block) {
                    *w = lanes.row(less(lanes, lanes.load(w), row, &factor));
                }
            }
        }
    }
}

/// `x = x M` with an eight by eight M.
pub(super) struct Combine<'a> {
    pub x: &'a mut [Row],
    pub factor: &'a Square,
}

impl Kernel for Combine<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { x, factor } = self;
        let factor: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&factor[at]));
        for row in x {
            *row = lanes.row(combine(lanes, row, &factor));
        }
    }
}

/// `r −= (L − σB) x`
pub(super) struct Residual<'a> {
    pub matrix: &'a Symmetric,
    pub sigma: f64,
    pub x: &'a [Row],
    pub r: &'a mut [Row],
}

impl Kernel for Residual<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { matrix, sigma, x, r } = self;
        for (column, own) in x.iter().enumerate() {
            let own = lanes.load(own);
            let mut sum = lanes.load(&r[column]);
            for at in matrix.range(column) {
                let row = matrix.rows[at] as usize;
                let mass = match &matrix.mass {
                    MassMatrix::Full(values) => values[at],
                    MassMatrix::Diagonal(values) if row == column => values[row],
                    MassMatrix::Unit if row == column => 1.0,
                    _ => 0.0,
                };
                let value = lanes.splat(matrix.stiffness[at] - sigma * mass);
                sum = lanes.sub_mul(sum, value, lanes.load(&x[row]));
                if row != column {
                    r[row] = lanes.row(lanes.sub_mul(lanes.load(&r[row]), value, own));
                }
            }
            r[column] = lanes.row(sum);
        }
    }
}

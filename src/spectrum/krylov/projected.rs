//! Small matrices of a process: the projected operator, and decompositions of Gram matrices.

use crate::spectrum::{block::Square, lanes::WIDTH};

/// The projected operator as a full matrix.
///
/// It is block tridiagonal whatever orthogonalisation took out of the products
/// ([`orthogonal`](super::orthogonal)), up to squares of what the basis lacks. Where the components C that were taken
/// out are given, they are known to the first order in another way: with `VᵀBV = 1 + Ω` and the orthonormal
/// N = V (1 + Ω)^(−1/2), `NᵀBSN = T + C + (ΩT − TΩ)/2`. The left side is symmetric and the last term skew, so it is
/// `T + (C + Cᵀ)/2`.
pub(super) fn projected(alpha: &[Square], beta: &[Square], lost: &[Vec<Square>], to: &mut Vec<f64>) {
    let blocks = alpha.len();
    let n = blocks * WIDTH;
    to.clear();
    to.resize(n * n, 0.0);
    let mut add = |row: usize, column: usize, value: f64| to[row * n + column] += value;
    for block in 0..blocks {
        let first = block * WIDTH;
        for i in 0..WIDTH {
            for j in 0..WIDTH {
                add(first + i, first + j, alpha[block][i][j]);
                if block + 1 < blocks {
                    add(first + WIDTH + i, first + j, beta[block][i][j]);
                    add(first + j, first + WIDTH + i, beta[block][i][j]);
                }
                for (other, lost) in lost.get(block).into_iter().flatten().enumerate() {
                    add(other * WIDTH + i, first + j, 0.5 * lost[i][j]);
                    add(first + j, other * WIDTH + i, 0.5 * lost[i][j]);
                }
            }
        }
    }
}

/// Upper triangular R with `RᵀR = G`, its inverse, the smallest ratio of a pivot to its diagonal entry, and which
/// columns depend on those before them (their rows of R and columns of the inverse are zero).
pub(super) fn cholesky(gram: &Square) -> (Square, Square, f64, u32) {
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

pub(super) fn product(a: &Square, b: &Square) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..WIDTH).fold(0.0, |sum, k| sum + a[i][k] * b[k][j])))
}

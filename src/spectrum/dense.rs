//! All eigenvalues of a small connected piece.

use super::{
    lanes::WIDTH,
    pencil::has_kernel,
    slice::{Found, in_lambda},
    small::{eigen, identity},
};
use crate::laplacian::Symmetric;

/// Up to this many rows a piece is solved densely.
pub(super) const LARGEST: usize = 160;

/// All eigenvalues of a connected piece, ascending, the first one exactly zero if it has a kernel. `None` when a
/// decomposition fails.
///
/// Two dense problems are solved, because neither is accurate everywhere: the inverse one, `B x = θ (L + τB) x` with
/// λ = 1/θ − τ, has an error that grows with λ, the direct one `L x = λ B x` has one that shrinks, both in proportion
/// to λ. Each eigenvalue is taken from the problem with the smaller bound.
pub(super) fn dense(matrix: &Symmetric) -> Option<Vec<Found>> {
    let n = matrix.order();
    let kernel = has_kernel(matrix);
    if n == 1 {
        let (_, _, stiffness, mass) = matrix.entries().next()?;
        let value = if kernel { 0.0 } else { stiffness / mass };
        let error = 2.0 * f64::EPSILON * value;
        return value.is_finite().then(|| vec![Found::exactly(value, error)]);
    }
    let (l, b) = full(matrix);
    let tau = 4.0 * std::f64::consts::PI / matrix.total_mass();
    let shifted: Vec<f64> = l.iter().zip(&b).map(|(l, b)| l + tau * b).collect();
    let mut inverse: Vec<f64> =
        reduced(&b, &shifted, n)?.into_iter().map(|theta| 1.0 / theta.max(f64::MIN_POSITIVE) - tau).collect();
    inverse.sort_by(f64::total_cmp);
    let mut direct = reduced(&l, &b, n)?;
    direct.sort_by(f64::total_cmp);
    let largest = direct[n - 1];
    let unit = 4.0 * n as f64 * f64::EPSILON;
    let mut found: Vec<Found> = inverse
        .iter()
        .zip(&direct)
        .map(|(&inverse, &direct)| {
            let shifted = inverse.min(largest) + tau;
            let (first, second) = (in_lambda(unit / tau, shifted), unit * largest);
            let (value, error) = if first <= second { (inverse, first) } else { (direct, second) };
            Found::exactly(value, error)
        })
        .collect();
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    if kernel {
        if found[0].value.abs() > 1e-7 * tau {
            return None;
        }
        found[0] = Found::exactly(0.0, 0.0);
    }
    if found[usize::from(kernel)].value <= 0.0 {
        return None;
    }
    Some(found)
}

/// The vector of the eigenvalue with that index, ascending, with xᵀBx = 1.
pub(super) fn direct(matrix: &Symmetric, index: usize) -> Option<Vec<f64>> {
    let (l, b) = full(matrix);
    Some(pairs(&l, &b, matrix.order())?.swap_remove(index).1)
}

/// Both matrices in full.
fn full(matrix: &Symmetric) -> (Vec<f64>, Vec<f64>) {
    let n = matrix.order();
    let (mut l, mut b) = (vec![0.0; n * n], vec![0.0; n * n]);
    for (row, column, stiffness, mass) in matrix.entries() {
        for (i, j) in [(row, column), (column, row)] {
            l[i * n + j] = stiffness;
            b[i * n + j] = mass;
        }
    }
    (l, b)
}

/// The eigenpairs of `A x = λ B x`, ascending, with xᵀBx = 1.
pub(super) fn pairs(a: &[f64], b: &[f64], n: usize) -> Option<Vec<(f64, Vec<f64>)>> {
    let c = cholesky(b, n)?;
    let m = congruent(a, &c, n);
    let mut vectors = identity(n);
    let per = n.div_ceil(WIDTH);
    let values = eigen(&m, n, &mut vectors)?;
    let mut found: Vec<(f64, Vec<f64>)> = values
        .iter()
        .enumerate()
        .map(|(at, &value)| {
            // x = C⁻ᵀ z
            let mut x: Vec<f64> = (0..n).map(|row| vectors[at * per + row / WIDTH][row % WIDTH]).collect();
            for i in (0..n).rev() {
                x[i] /= c[i * n + i];
                for k in 0..i {
                    x[k] -= c[i * n + k] * x[i];
                }
            }
            (value, x)
        })
        .collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(found)
}

/// Eigenvalues of C⁻¹ A C⁻ᵀ with `CCᵀ = B`.
fn reduced(a: &[f64], b: &[f64], n: usize) -> Option<Vec<f64>> {
    eigen(&congruent(a, &cholesky(b, n)?, n), n, &mut [])
}

/// The lower triangular C with `CCᵀ = B`.
fn cholesky(b: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut c = b.to_vec();
    for j in 0..n {
        for k in 0..j {
            let factor = c[j * n + k];
            for i in j..n {
                c[i * n + j] -= c[i * n + k] * factor;
            }
        }
        let pivot = c[j * n + j];
        if !(pivot.is_normal() && pivot > 0.0) {
            return None;
        }
        let root = pivot.sqrt();
        for i in j..n {
            c[i * n + j] /= root;
        }
    }
    Some(c)
}

/// C⁻¹ A C⁻ᵀ.
fn congruent(a: &[f64], c: &[f64], n: usize) -> Vec<f64> {
    let mut m = a.to_vec();
    // Twice X = C⁻¹ M, transposing in between.
    for _ in 0..2 {
        for i in 0..n {
            let (above, row) = m.split_at_mut(i * n);
            let row = &mut row[..n];
            for k in 0..i {
                let factor = c[i * n + k];
                for (x, y) in row.iter_mut().zip(&above[k * n..(k + 1) * n]) {
                    *x -= factor * y;
                }
            }
            let inverse = 1.0 / c[i * n + i];
            for x in row.iter_mut() {
                *x *= inverse;
            }
        }
        for i in 0..n {
            for j in 0..i {
                m.swap(i * n + j, j * n + i);
            }
        }
    }
    for i in 0..n {
        for j in 0..i {
            let mean = 0.5 * (m[i * n + j] + m[j * n + i]);
            m[i * n + j] = mean;
            m[j * n + i] = mean;
        }
    }
    m
}

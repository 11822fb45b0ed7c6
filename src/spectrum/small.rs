//! Dense symmetric eigenproblems of at most a few hundred rows.
//!
//! Householder reduction to tridiagonal form (Wilkinson and Reinsch 1971) and the [QL iteration](super::implicit_ql).
//! What a Lanczos process needs of its projected operator, which is banded, is cheaper: see
//! [`band_reduction`](super::band_reduction).

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::{
    implicit_ql::ImplicitQl,
    lanes::{Kernel, Lanes, Row, WIDTH, dispatch},
};

/// Eigenvalues of the symmetric matrix `a` (n × n, both triangles), in no particular order, or `None` when the
/// iteration does not converge (then `a` was not finite).
///
/// `vectors` has for each of the n columns the same number of rows of eight values: on entry rows of a matrix Z by
/// columns, on return Z times the eigenvectors.
pub(super) fn eigen(a: &[f64], n: usize, vectors: &mut [Row]) -> Option<Vec<f64>> {
    if n == 0 {
        return Some(Vec::new());
    }
    let mut diagonal = vec![0.0; n];
    let mut beside = vec![0.0; n];
    let per = vectors.len() / n;
    dispatch(Tridiagonal { a, vectors, per, diagonal: &mut diagonal, beside: &mut beside });
    dispatch(ImplicitQl { vectors, per, diagonal: &mut diagonal, beside: &mut beside }).then_some(diagonal)
}

struct Tridiagonal<'a> {
    a: &'a [f64],
    vectors: &'a mut [Row],
    per: usize,
    diagonal: &'a mut [f64],
    beside: &'a mut [f64],
}

impl Kernel for Tridiagonal<'_> {
    type Output = ();

    /// Each step is one pass over what is left of the matrix: the reflection of the step before is applied to a row,
    /// A −= v pᵀ + p vᵀ, and the row then has its share in the product that the next reflection needs.
    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { a, vectors, per, diagonal, beside } = self;
        let n = diagonal.len();
        let width = n.div_ceil(WIDTH);
        let mut rows = vec![[0.0; WIDTH]; n * width];
        for (to, from) in rows.chunks_mut(width).zip(a.chunks(n)) {
            to.as_flattened_mut()[..n].copy_from_slice(from);
        }
        // Zero before the first entry that belongs to them.
        let [mut v, mut p, mut next, mut product] = std::array::from_fn(|_| vec![[0.0; WIDTH]; width]);
        for k in 0..n {
            let first = k + 1;
            let here = &mut rows[k * width..];
            pass::<L, 1>(lanes, here, [&v, &p, &next], &mut product, k, k / WIDTH);
            let row = &here.as_flattened()[..n];
            diagonal[k] = row[k];
            if first == n {
                break;
            }
            let column = &row[first..];
            let tail = column[1..].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            let norm = column.iter().fold(0.0, |sum, x| sum + x * x).sqrt();
            next.as_flattened_mut().fill(0.0);
            let mut tau = 0.0;
            if tail == 0.0 {
                beside[k] = column[0];
            } else {
                // H = I − τ v vᵀ with H x = −sign(x₀) ‖x‖ e₀.
                let next = &mut next.as_flattened_mut()[..n];
                next[first..].copy_from_slice(column);
                let alpha = if next[first] > 0.0 { -norm } else { norm };
                next[first] -= alpha;
                beside[k] = alpha;
            }
            if tail != 0.0 {
                tau = 2.0 / inner(lanes, &next, &next);
            }
            product.fill([0.0; WIDTH]);
            let (mut at, from) = (first, first / WIDTH);
            while at + ROWS <= n {
                pass::<L, ROWS>(lanes, &mut rows[at * width..], [&v, &p, &next], &mut product, at, from);
                at += ROWS;
            }
            for at in at..n {
                pass::<L, 1>(lanes, &mut rows[at * width..], [&v, &p, &next], &mut product, at, from);
            }
            product.as_flattened_mut()[..first].fill(0.0);
            // In this order, because τ² may overflow.
            let shift = 0.5 * tau * (tau * inner(lanes, &next, &product));
            for (p, (product, v)) in p.iter_mut().zip(product.iter().zip(&next)) {
                let scaled = lanes.mul(lanes.load(product), lanes.splat(tau));
                *p = lanes.row(lanes.sub_mul(scaled, lanes.load(v), lanes.splat(shift)));
            }
            std::mem::swap(&mut v, &mut next);
            next.fill([0.0; WIDTH]);
            let v = &v.as_flattened()[first..n];
            for group in 0..per {
                let mut sum = lanes.zero();
                for (at, &value) in v.iter().enumerate() {
                    sum = lanes.add_mul(sum, lanes.load(&vectors[(first + at) * per + group]), lanes.splat(value));
                }
                let sum = lanes.mul(sum, lanes.splat(tau));
                for (at, &value) in v.iter().enumerate() {
                    let row = &mut vectors[(first + at) * per + group];
                    *row = lanes.row(lanes.sub_mul(lanes.load(row), sum, lanes.splat(value)));
                }
            }
        }
    }
}

/// Rows that a pass takes together.
const ROWS: usize = 4;

/// Applies A −= v pᵀ + p vᵀ to the `R` rows from row `at` on, which `rows` begins with, and adds them times their
/// entries of `next` to `product`; in the columns from the eight numbered `from` on.
#[inline(always)]
fn pass<L: Lanes, const R: usize>(
    lanes: L,
    rows: &mut [Row],
    [v, p, next]: [&[Row]; 3],
    product: &mut [Row],
    at: usize,
    from: usize,
) {
    let width = v.len();
    let mut here = [[lanes.zero(); 3]; R];
    for (row, here) in (at..).zip(&mut here) {
        for (entry, from) in here.iter_mut().zip([v, p, next]) {
            *entry = lanes.splat(from[row / WIDTH][row % WIDTH]);
        }
    }
    let rows = &mut rows[..R * width];
    for column in from..width {
        let (over_v, over_p) = (lanes.load(&v[column]), lanes.load(&p[column]));
        let mut sum = lanes.load(&product[column]);
        for (row, [v, p, next]) in here.into_iter().enumerate() {
            let a = &mut rows[row * width + column];
            let value = lanes.sub_mul(lanes.sub_mul(lanes.load(a), v, over_p), p, over_v);
            *a = lanes.row(value);
            sum = lanes.add_mul(sum, value, next);
        }
        product[column] = lanes.row(sum);
    }
}

/// xᵀy.
#[inline(always)]
fn inner<L: Lanes>(lanes: L, x: &[Row], y: &[Row]) -> f64 {
    let mut sum = lanes.zero();
    for (x, y) in x.iter().zip(y) {
        sum = lanes.add_mul(sum, lanes.load(x), lanes.load(y));
    }
    lanes.row(sum).iter().sum()
}

/// The unit matrix as the rows that [`eigen`] takes: all rows of the eigenvectors are wanted.
pub(super) fn identity(n: usize) -> Vec<Row> {
    let per = n.div_ceil(WIDTH);
    let mut rows = vec![[0.0; WIDTH]; n * per];
    for column in 0..n {
        rows[column * per + column / WIDTH][column % WIDTH] = 1.0;
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_diagonalise() {
        for n in [1, 2, 3, 7, 24, 61] {
            let mut state = 7_u64;
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (state >> 33) as f64 / f64::from(1 << 30) - 1.0
            };
            let mut a = vec![0.0; n * n];
            for row in 0..n {
                for column in 0..=row {
                    let value = if row == column { 0.0 } else { next() };
                    a[row * n + column] = value;
                    a[column * n + row] = value;
                }
            }
            let full = a.clone();
            let per = n.div_ceil(WIDTH);
            let mut vectors = identity(n);
            let values = eigen(&a, n, &mut vectors).unwrap();
            let entry = |row: usize, column: usize| vectors[column * per + row / WIDTH][row % WIDTH];
            for (column, value) in values.iter().enumerate() {
                for row in 0..n {
                    let product: f64 = (0..n).map(|k| full[row * n + k] * entry(k, column)).sum();
                    assert!((product - value * entry(row, column)).abs() < 1e-12);
                    let inner: f64 = (0..n).map(|k| entry(k, row) * entry(k, column)).sum();
                    assert!((inner - f64::from(u8::from(row == column))).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn not_finite_is_no_answer() {
        assert_eq!(eigen(&[f64::NAN; 4], 2, &mut []), None);
    }
}

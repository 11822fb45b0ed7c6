//! Dense symmetric eigenproblems of at most a few hundred rows.
//!
//! Householder reduction to tridiagonal form and the implicit QL iteration (Wilkinson and Reinsch 1971), with the
//! transformations applied to as many rows as are asked for: a Lanczos process needs the last eight of the
//! eigenvectors, not all of them.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::lanes::{Kernel, Lanes, Row, WIDTH, dispatch};

/// Eigenvalues of the symmetric matrix `a` (n × n, both triangles), in no particular order, or `None` when the
/// iteration does not converge (then `a` was not finite).
///
/// `vectors` has for each of the n columns the same number of rows of eight values: on entry rows of a matrix Z by
/// columns, on return Z times the eigenvectors.
pub(super) fn eigen(a: &mut [f64], n: usize, vectors: &mut [Row]) -> Option<Vec<f64>> {
    if n == 0 {
        return Some(Vec::new());
    }
    let mut diagonal = vec![0.0; n];
    let mut beside = vec![0.0; n];
    let per = vectors.len() / n;
    dispatch(Tridiagonal { a, n, vectors, per, diagonal: &mut diagonal, beside: &mut beside });
    let done = dispatch(Ql { vectors, per, diagonal: &mut diagonal, beside: &mut beside });
    (done && diagonal.iter().all(|value| value.is_finite())).then_some(diagonal)
}

struct Tridiagonal<'a> {
    a: &'a mut [f64],
    n: usize,
    vectors: &'a mut [Row],
    per: usize,
    diagonal: &'a mut [f64],
    beside: &'a mut [f64],
}

impl Kernel for Tridiagonal<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { a, n, vectors, per, diagonal, beside } = self;
        let mut v = vec![0.0; n];
        let mut p = vec![0.0; n];
        for k in 0..n.saturating_sub(1) {
            diagonal[k] = a[k * n + k];
            let first = k + 1;
            let column = &a[k * n + first..(k + 1) * n];
            let norm = column.iter().fold(0.0, |sum, x| sum + x * x).sqrt();
            let tail = column[1..].iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            if tail == 0.0 {
                beside[k] = column[0];
                continue;
            }
            // H = I − τ v vᵀ with H x = −sign(x₀) ‖x‖ e₀.
            let v = &mut v[..n - first];
            v.copy_from_slice(column);
            let alpha = if v[0] > 0.0 { -norm } else { norm };
            v[0] -= alpha;
            let tau = 2.0 / v.iter().fold(0.0, |sum, x| sum + x * x);
            beside[k] = alpha;
            let p = &mut p[..n - first];
            p.fill(0.0);
            for (at, &value) in v.iter().enumerate() {
                let row = &a[(first + at) * n + first..(first + at + 1) * n];
                for (p, x) in p.iter_mut().zip(row) {
                    *p = x.mul_add(value, *p);
                }
            }
            let inner = v.iter().zip(p.iter()).fold(0.0, |sum, (v, p)| sum + v * p);
            let shift = 0.5 * tau * tau * inner;
            for (p, v) in p.iter_mut().zip(v.iter()) {
                *p = tau * *p - shift * v;
            }
            for at in 0..v.len() {
                let row = &mut a[(first + at) * n + first..(first + at + 1) * n];
                let (x, y) = (-v[at], -p[at]);
                for ((a, p), v) in row.iter_mut().zip(p.iter()).zip(v.iter()) {
                    *a = v.mul_add(y, p.mul_add(x, *a));
                }
            }
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
        diagonal[n - 1] = a[n * n - 1];
    }
}

struct Ql<'a> {
    vectors: &'a mut [Row],
    per: usize,
    diagonal: &'a mut [f64],
    /// Subdiagonal in 0..n−1.
    beside: &'a mut [f64],
}

impl Kernel for Ql<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> bool {
        let Self { vectors, per, diagonal: d, beside: e } = self;
        let n = d.len();
        e[n - 1] = 0.0;
        for low in 0..n {
            let mut rounds = 0;
            loop {
                let mut high = low;
                while high + 1 < n {
                    let scale = d[high].abs() + d[high + 1].abs();
                    if e[high].abs() <= f64::EPSILON * scale {
                        break;
                    }
                    high += 1;
                }
                if high == low {
                    break;
                }
                rounds += 1;
                if rounds > 60 {
                    return false;
                }
                let mut g = (d[low + 1] - d[low]) / (2.0 * e[low]);
                let r = g.hypot(1.0);
                g = d[high] - d[low] + e[low] / (g + r.copysign(g));
                let (mut sine, mut cosine, mut p) = (1.0, 1.0, 0.0);
                let mut broke = false;
                for at in (low..high).rev() {
                    let f = sine * e[at];
                    let b = cosine * e[at];
                    let r = (f * f + g * g).sqrt();
                    e[at + 1] = r;
                    if r == 0.0 {
                        d[at + 1] -= p;
                        e[high] = 0.0;
                        broke = true;
                        break;
                    }
                    sine = f / r;
                    cosine = g / r;
                    g = d[at + 1] - p;
                    let r = (d[at] - g) * sine + 2.0 * cosine * b;
                    p = sine * r;
                    d[at + 1] = g + p;
                    g = cosine * r - b;
                    let (s, c) = (lanes.splat(sine), lanes.splat(cosine));
                    let (left, right) = vectors[at * per..(at + 2) * per].split_at_mut(per);
                    for (left, right) in left.iter_mut().zip(right) {
                        let (x, y) = (lanes.load(left), lanes.load(right));
                        *right = lanes.row(lanes.add_mul(lanes.mul(c, y), s, x));
                        *left = lanes.row(lanes.sub_mul(lanes.mul(c, x), s, y));
                    }
                }
                if broke {
                    continue;
                }
                d[low] -= p;
                e[low] = g;
                e[high] = 0.0;
            }
        }
        true
    }
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
            let values = eigen(&mut a, n, &mut vectors).unwrap();
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
        assert_eq!(eigen(&mut [f64::NAN; 4], 2, &mut []), None);
    }
}

//! Quadratic forms of a vector: its Rayleigh quotient and its residual.

use crate::laplacian::{MassMatrix, Symmetric};

/// xᵀLx / xᵀBx, with the form of L as a sum over pairs of rows: `Σ −Lᵢⱼ (xᵢ − xⱼ)²` and the row sums times xᵢ², since
/// xᵀLx itself cancels by the ratio of the largest eigenvalue to this one.
pub(super) fn rayleigh(matrix: &Symmetric, x: &[f64]) -> f64 {
    let mut sums = vec![0.0; x.len()];
    let mut form = Sum::default();
    for (row, column, l, _) in matrix.entries() {
        sums[row] += l;
        if row != column {
            sums[column] += l;
            let apart = x[row] - x[column];
            form.add(-l * apart * apart);
        }
    }
    sums.iter().zip(x).for_each(|(row, x)| form.add(row * x * x));
    let mut mass = Sum::default();
    x.iter().zip(&mass_product(matrix, x)).for_each(|(x, b)| mass.add(x * b));
    form.total() / mass.total()
}

/// A compensated sum (Neumaier 1974).
#[derive(Default)]
struct Sum {
    high: f64,
    low: f64,
}

impl Sum {
    fn add(&mut self, value: f64) {
        let sum = self.high + value;
        self.low += if self.high.abs() >= value.abs() { self.high - sum + value } else { value - sum + self.high };
        self.high = sum;
    }

    fn total(&self) -> f64 {
        self.high + self.low
    }
}

/// B x.
pub(super) fn mass_product(matrix: &Symmetric, x: &[f64]) -> Vec<f64> {
    match &matrix.mass {
        MassMatrix::Unit => x.to_vec(),
        MassMatrix::Diagonal(values) => values.iter().zip(x).map(|(b, x)| b * x).collect(),
        MassMatrix::Full(_) => {
            let mut product = vec![0.0; x.len()];
            for (row, column, _, b) in matrix.entries() {
                product[row] += b * x[column];
                if row != column {
                    product[column] += b * x[row];
                }
            }
            product
        }
    }
}

/// A bound on ‖Lx − λBx‖ in the norm of B⁻¹ for xᵀBx = 1, and so on the distance of λ from an eigenvalue (Parlett,
/// *The Symmetric Eigenvalue Problem*, § 15.9).
///
/// A consistent B is at least a quarter of its lumped D in the order of forms, because that holds for the matrix
/// area/12 (1 + I) of every triangle, so rᵀB⁻¹r ≤ 4 rᵀD⁻¹r.
pub(super) fn residual(matrix: &Symmetric, lambda: f64, x: &[f64]) -> f64 {
    let n = matrix.order();
    let (mut r, mut lumped) = (vec![0.0; n], vec![0.0; n]);
    for (row, column, l, b) in matrix.entries() {
        r[row] += (l - lambda * b) * x[column];
        lumped[row] += b;
        if row != column {
            r[column] += (l - lambda * b) * x[row];
            lumped[column] += b;
        }
    }
    let square: f64 = r.iter().zip(&lumped).map(|(r, d)| r * r / d).sum();
    let factor = if matches!(matrix.mass, MassMatrix::Full(_)) { 2.0 } else { 1.0 };
    factor * square.sqrt()
}

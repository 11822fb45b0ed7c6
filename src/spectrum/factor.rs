//! Sparse L − σB = P M D Mᵀ Pᵀ of our own: fill-reducing order, symbolic analysis once, a multifrontal numeric
//! factorisation per shift, and triangular solves for eight right-hand sides at once.
//!
//! It exists beside faer's because a certified and cancellable eigensolver asks for what a library does not give: the
//! signs of D as they come, a look at the watch between any two supernodes, and solves on rows of eight values.

pub(super) use self::{
    numeric::Factor,
    order::{Order, order},
    symbolic::Symbolic,
};

mod front;
mod numeric;
mod order;
mod solve;
mod symbolic;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        laplacian::{Choice, Mass, Operator, assemble},
        spectrum::{
            krylov::Random,
            lanes::{Buffer, WIDTH},
            pencil::Pencil,
            poll::Poll,
            shapes,
        },
        watch::Unwatched,
    };

    /// The largest entry of A x − b for random b, relative to that of |A| |x|.
    fn residual(pencil: &Pencil, sigma: f64) -> f64 {
        let n = pencil.order();
        let mut factor = Factor::default();
        let mut poll = Poll::new(&Unwatched);
        factor.compute(&pencil.symbolic, &pencil.matrix, sigma, &mut poll).unwrap();
        let mut random = Random(3);
        let mut x = Buffer::default();
        x.reserve(n * WIDTH);
        x.flat().fill_with(|| random.next());
        let b = x.rows().to_vec();
        factor.solve(&pencil.symbolic, x.rows_mut(), &mut poll).unwrap();
        let (mut product, mut size) = (vec![[0.0; WIDTH]; n], 0.0_f64);
        for (row, column, l, m) in pencil.matrix.entries() {
            let value = l - sigma * m;
            let mut add = |to: usize, from: usize| {
                for (sum, x) in product[to].iter_mut().zip(&x.rows()[from]) {
                    *sum += value * x;
                    size = size.max((value * x).abs());
                }
            };
            add(row, column);
            if row != column {
                add(column, row);
            }
        }
        let worst =
            product.iter().flatten().zip(b.iter().flatten()).fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
        worst / size
    }

    #[test]
    fn solves_to_rounding() {
        for (mesh, sigma) in
            [(shapes::icosphere(3), 31.0), (shapes::icosphere(4), 100.0), (shapes::rectangle(40, 13), 50.0)]
        {
            for (operator, mass) in
                [(Operator::Fem, Mass::Consistent), (Operator::Fem, Mass::Lumped), (Operator::Cot, Mass::Lumped)]
            {
                let laplacian = assemble(&mesh, Choice::new(operator, mass)).unwrap();
                let pencil = Pencil::new(&laplacian.matrix).unwrap();
                let sigma = if operator == Operator::Cot { 0.01 * sigma } else { sigma };
                let worst = residual(&pencil, sigma);
                assert!(worst < 1e-13, "{worst:e}");
            }
        }
    }
}

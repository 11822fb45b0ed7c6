//! The basis, the residuals, and blocks that lose a column.

use super::{orthogonal::norm, *};
use crate::{
    laplacian::{Choice, assemble},
    mesh::Mesh,
    spectrum::{panel::ROWS, shapes},
    watch::Unwatched,
};

/// The pencil of a mesh and its factor at a shift.
fn factored(mesh: &Mesh, sigma: f64) -> (Pencil, Factor) {
    let pencil = Pencil::new(&assemble(mesh, Choice::default()).unwrap().matrix).unwrap();
    let mut factor = Factor::default();
    factor.compute(&pencil.symbolic, &pencil.matrix, sigma, &mut Poll::new(&Unwatched)).unwrap();
    (pencil, factor)
}

/// How far the basis of a finished process is from orthonormal.
fn defect(krylov: &Krylov) -> f64 {
    let n = krylov.pencil.order();
    let mut product = vec![[0.0; WIDTH]; n];
    let rows = |block: usize| -> Vec<Row> {
        match krylov.basis {
            Basis::Double(_) => krylov.scratch.exact[block].rows().to_vec(),
            Basis::Single => {
                let panels = &krylov.scratch.blocks[block];
                (0..n).map(|at| panels[at / ROWS].0.map(|column| f64::from(column[at % ROWS]))).collect()
            }
        }
    };
    let mut worst = 0.0_f64;
    for i in 0..krylov.blocks() {
        dispatch(Multiply { mass: &krylov.pencil.mass, x: &rows(i), to: &mut product });
        for j in 0..krylov.blocks() {
            let mut sum = [Square::default()];
            dispatch(Dots { basis: &[&rows(j)], t: &product, sums: &mut sum });
            for (k, row) in sum[0].iter().enumerate() {
                for (l, entry) in row.iter().enumerate() {
                    worst = worst.max((entry - f64::from(u8::from(i == j && k == l))).abs());
                }
            }
        }
    }
    worst
}

#[test]
fn the_basis_is_orthonormal_and_the_residuals_are_true() {
    let sigma = 123.0;
    let (pencil, factor) = factored(&shapes::rectangle(50, 31), sigma);
    let (mut poll, mut scratch) = (Poll::new(&Unwatched), Scratch::default());
    let mut run = |basis| {
        let mut krylov = Krylov::start(&pencil, &factor, sigma, 5, basis, &mut scratch, &mut poll).unwrap();
        for _ in 0..14 {
            krylov.step(&mut poll).unwrap();
        }
        let ritz = krylov.ritz(&mut poll).unwrap();
        let vectors = matches!(basis, Basis::Double(_)).then(|| krylov.vectors(&ritz[..40]).unwrap());
        (ritz, vectors.unwrap_or_default(), defect(&krylov))
    };
    let (single, _, rounded) = run(Basis::Single);
    let (ritz, vectors, defect) = run(Basis::Double(&[]));
    assert!(defect < 1e-12, "{defect:e}");
    // Single precision leaves so much; the projected operator feels its square.
    assert!(rounded < 5e-7, "{rounded:e}");
    for (single, double) in single[..40].iter().zip(&ritz) {
        let bound = 1e-12 * double.theta.abs() + 10.0 * double.residual;
        assert!((single.theta - double.theta).abs() < bound, "{single:?} {double:?}");
    }
    let n = pencil.order();
    for (at, ritz) in ritz[..40].iter().enumerate() {
        let x: Vec<f64> = vectors[at / WIDTH].rows().iter().map(|row| row[at % WIDTH]).collect();
        let (mut lx, mut bx) = (vec![0.0; n], vec![0.0; n]);
        for (row, column, l, b) in pencil.matrix.entries() {
            lx[row] += l * x[column];
            bx[row] += b * x[column];
            if row != column {
                lx[column] += l * x[row];
                bx[column] += b * x[row];
            }
        }
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let quotient = dot(&x, &lx) / dot(&x, &bx);
        // The quotient's own error is of second order.
        let bound = ritz.residual * ritz.residual / ritz.theta.abs().powi(3) * 100.0;
        assert!((dot(&x, &bx) - 1.0).abs() < 1e-12);
        assert!((quotient - ritz.value).abs() < 1e-13 * (ritz.value + sigma) + bound, "{quotient} {ritz:?}");
    }
}

#[test]
fn dependent_columns_are_replaced() {
    let (pencil, factor) = factored(&shapes::rectangle(20, 20), 50.0);
    let (mut poll, mut scratch) = (Poll::new(&Unwatched), Scratch::default());
    let mut krylov = Krylov::start(&pencil, &factor, 50.0, 5, Basis::Single, &mut scratch, &mut poll).unwrap();
    for row in krylov.scratch.work.rows_mut() {
        row[3] = 2.0 * row[1] - row[0];
        row[7] = 0.0;
    }
    let before = krylov.scratch.work.rows().to_vec();
    let upper = krylov.normalise(0, &mut poll).unwrap();
    let gram =
        dispatch(Multiply { mass: &pencil.mass, x: krylov.scratch.next.rows(), to: krylov.scratch.mass.rows_mut() });
    for (i, row) in gram.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-11, "{i} {j} {entry}");
        }
    }
    for (before, q) in before.iter().zip(krylov.scratch.next.rows()) {
        for (j, before) in before.iter().enumerate() {
            let product: f64 = (0..WIDTH).map(|k| q[k] * upper[k][j]).sum();
            assert!((product - before).abs() < 1e-10, "column {j}: {product} {before}");
        }
    }
}

#[test]
fn few_steps_need_all_blocks() {
    let sigma = 321.0;
    let (pencil, factor) = factored(&shapes::rectangle(60, 41), sigma);
    let (mut poll, mut scratch) = (Poll::new(&Unwatched), Scratch::default());
    let mut krylov = Krylov::start(&pencil, &factor, sigma, 5, Basis::Single, &mut scratch, &mut poll).unwrap();
    while krylov.blocks() < 24 || krylov.against() == krylov.blocks() {
        krylov.step(&mut poll).unwrap();
    }
    let saved = krylov.lost.iter().enumerate().filter(|(at, lost)| lost.len() <= *at).count();
    assert!((6..=11).contains(&saved), "{saved}");
    assert!(krylov.lost.windows(2).enumerate().all(|(at, pair)| pair[0].len() > at || pair[1].len() > at + 1));
    let off = defect(&krylov);
    assert!(off < 5e-6, "{off:e}");
    // What is off comes to so little in the projected operator.
    let least = norm(&[*krylov.beta.last().unwrap()], 0);
    assert!(krylov.leak() > 0.0 && krylov.leak() < 1e-9 * least, "{:e} {least:e}", krylov.leak());

    // A step that looked at the first blocks alone is not enough where little is left.
    let (few, all) = (vec![Square::default(); 3], vec![Square::default(); krylov.blocks()]);
    let left =
        |size: f64| -> Square { std::array::from_fn(|i| std::array::from_fn(|j| if i == j { size } else { 0.0 })) };
    assert!(!krylov.spoilt(&few, &left(least)) && krylov.spoilt(&few, &left(1e-5 * least)));
    assert!(!krylov.spoilt(&all, &left(1e-5 * least)));
}

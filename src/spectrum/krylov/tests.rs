//! The basis, the residuals, and blocks that lose a column.

use super::*;
use crate::{
    laplacian::{Choice, assemble},
    mesh::Mesh,
    spectrum::{lanes::SETS, panel::ROWS, shapes},
    watch::Unwatched,
};

/// The pencil of a mesh and its factor at a shift.
fn factored(mesh: &Mesh, sigma: f64) -> (Pencil, Factor) {
    let pencil = Pencil::new(&assemble(mesh, Choice::default()).unwrap().matrix).unwrap();
    let mut factor = Factor::default();
    factor.compute(&pencil.symbolic, &pencil.matrix, sigma, &mut Poll::new(&Unwatched)).unwrap();
    (pencil, factor)
}

/// A block of a basis.
fn rows(krylov: &Krylov, block: usize) -> Vec<Row> {
    match krylov.basis {
        Basis::Double(_) => krylov.scratch.exact[block].rows().to_vec(),
        Basis::Single { .. } => {
            let panels = krylov.scratch.blocks.first(block + 1)[block];
            let rows = 0..krylov.pencil.order();
            rows.map(|at| panels[at / ROWS].0[at % ROWS / 2][0].0.map(|pair| f64::from(pair[at % 2]))).collect()
        }
    }
}

/// How far the basis of a finished process is from orthonormal.
fn defect(krylov: &Krylov) -> f64 {
    let n = krylov.pencil.order();
    let mut product = vec![[0.0; WIDTH]; n];
    let mut worst = 0.0_f64;
    for i in 0..krylov.blocks() {
        dispatch(Multiply { mass: &krylov.pencil.mass, x: &rows(krylov, i), to: &mut product });
        for j in 0..krylov.blocks() {
            let mut sum = [Square::default()];
            dispatch(Dots { basis: &[&rows(krylov, j)], t: &product, sums: &mut sum });
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
    let (single, _, rounded) = run(Basis::Single { reach: sigma });
    let (ritz, vectors, defect) = run(Basis::Double(&[]));
    assert!(defect < 1e-12, "{defect:e}");
    // So much may be lost; the projected operator feels its square.
    assert!(rounded < 2e-6, "{rounded:e}");
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
    let mut krylov =
        Krylov::start(&pencil, &factor, 50.0, 5, Basis::Single { reach: 50.0 }, &mut scratch, &mut poll).unwrap();
    for row in krylov.scratch.work.rows_mut() {
        row[3] = 2.0 * row[1] - row[0];
        row[7] = 0.0;
    }
    let before = krylov.scratch.work.rows().to_vec();
    let upper = krylov.normalise(0, &mut poll).unwrap();
    let gram = krylov.gram(&mut poll);
    for (i, row) in gram.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-11, "{i} {j} {entry}");
        }
    }
    for (before, q) in before.iter().zip(krylov.scratch.work.rows()) {
        for (j, before) in before.iter().enumerate() {
            let product: f64 = (0..WIDTH).map(|k| q[k] * upper[k][j]).sum();
            assert!((product - before).abs() < 1e-10, "column {j}: {product} {before}");
        }
    }
}

/// How far a basis in double precision is from orthonormal: what neighbouring blocks lack, and what the others lack.
fn lacks(exact: &[Vec<Row>], pencil: &Pencil) -> (f64, f64) {
    let mut product = vec![[0.0; WIDTH]; pencil.order()];
    let (mut near, mut far) = (0.0_f64, 0.0_f64);
    for (i, block) in exact.iter().enumerate() {
        dispatch(Multiply { mass: &pencil.mass, x: block, to: &mut product });
        for (j, other) in exact[..=i].iter().enumerate() {
            let mut sum = [Square::default()];
            dispatch(Dots { basis: &[other], t: &product, sums: &mut sum });
            for (k, row) in sum[0].iter().enumerate() {
                for (l, entry) in row.iter().enumerate() {
                    let off = (entry - f64::from(u8::from(i == j && k == l))).abs();
                    if i - j < 2 { near = near.max(off) } else { far = far.max(off) }
                }
            }
        }
    }
    (near, far)
}

#[test]
fn few_steps_look_at_the_whole_basis_and_neighbours_stay_orthogonal() {
    let sigma = 321.0;
    let (pencil, factor) = factored(&shapes::rectangle(60, 41), sigma);
    let (mut poll, mut scratch) = (Poll::new(&Unwatched), Scratch::default());
    let mut krylov =
        Krylov::start(&pencil, &factor, sigma, 5, Basis::Single { reach: sigma }, &mut scratch, &mut poll).unwrap();
    let mut passes = Vec::new();
    let mut exact: Vec<Vec<Row>> = Vec::new();
    while krylov.blocks() < 24 {
        if krylov.due() {
            passes.push(krylov.blocks());
        }
        krylov.step(&mut poll).unwrap();
        // The block before the newest is the one that a pass changes.
        exact.push(krylov.scratch.past.rows().to_vec());
    }
    assert!((4..=7).contains(&passes.len()), "{passes:?}");
    let (near, far) = lacks(&exact, &pencil);
    // What a block lacked that was mended, squared; single precision would leave 3e-9.
    assert!(near < 4e-10, "{near:e}");
    // Something is lost, or the test would not say anything.
    assert!((1e-8..2e-6).contains(&far), "{far:e}");
    // What is off comes to so little in the projected operator.
    let least = krylov.beta.last().unwrap().as_flattened().iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    assert!(krylov.leak() > 0.0 && krylov.leak() < 1e-9 * least, "{:e} {least:e}", krylov.leak());
    // It is no less than what the operator loses in the second order.
    assert!(krylov.leak() > far * far * least, "{:e}", krylov.leak());

    let ritz = krylov.ritz(&mut poll).unwrap();
    let mut double = Krylov::start(&pencil, &factor, sigma, 5, Basis::Double(&[]), &mut scratch, &mut poll).unwrap();
    while double.blocks() < 24 {
        double.step(&mut poll).unwrap();
    }
    let double = double.ritz(&mut poll).unwrap();
    for (single, double) in ritz[..60].iter().zip(&double) {
        let bound = 1e-14 * ritz[0].theta.abs() + double.residual.powi(2) / double.theta.abs();
        assert!((single.theta - double.theta).abs() < bound, "{single:?} {double:?}");
    }
}

#[test]
fn a_block_that_is_mended_leaves_no_trace() {
    let sigma = 321.0;
    let (pencil, factor) = factored(&shapes::rectangle(60, 41), sigma);
    let (mut poll, mut scratch) = (Poll::new(&Unwatched), Scratch::default());
    let mut run = |spoil: f64| {
        let mut krylov =
            Krylov::start(&pencil, &factor, sigma, 5, Basis::Single { reach: sigma }, &mut scratch, &mut poll).unwrap();
        while krylov.blocks() < 22 {
            if krylov.blocks() == 12 && spoil != 0.0 {
                // As if it had never been orthogonal to an older block.
                let longer = (1.0 + spoil * spoil).sqrt();
                for value in krylov.beta.last_mut().unwrap().as_flattened_mut() {
                    *value *= longer;
                }
                let mut image = vec![[0.0; WIDTH]; pencil.order()];
                let older = rows(&krylov, 6);
                dispatch(Multiply { mass: &pencil.mass, x: &older, to: &mut image });
                let Scratch { now, image: newest, work, .. } = &mut *krylov.scratch;
                for (to, more) in [(now, &older), (newest, &image), (work, &image)] {
                    for (to, more) in to.rows_mut().iter_mut().zip(more) {
                        for (to, more) in to.iter_mut().zip(more) {
                            *to = (*to + spoil * more) / longer;
                        }
                    }
                }
                krylov.losses.spoil(spoil);
            }
            krylov.step(&mut poll).unwrap();
        }
        krylov.ritz(&mut poll).unwrap()
    };
    let sorted = |ritz: Vec<Ritz>| {
        let mut theta: Vec<f64> = ritz.iter().map(|ritz| ritz.theta).collect();
        theta.sort_by(f64::total_cmp);
        theta
    };
    let (clean, spoilt) = (sorted(run(0.0)), sorted(run(1e-4)));
    let most = clean.iter().zip(&spoilt).fold(0.0_f64, |most, (clean, spoilt)| most.max((clean - spoilt).abs()));
    // A tenth of what its square comes to, where nothing is done about the block's length.
    assert!(most < 4e-13, "{most:e}");
}

#[test]
fn all_instruction_sets_give_the_same_bits() {
    let sigma = 321.0;
    let run = |sets: u8, basis: Basis, blocks: usize| -> Vec<(u64, u64)> {
        SETS.set(sets);
        let (pencil, factor) = factored(&shapes::rectangle(40, 31), sigma);
        let (mut poll, mut scratch) = (Poll::new(&Unwatched), Scratch::default());
        let mut krylov = Krylov::start(&pencil, &factor, sigma, 5, basis, &mut scratch, &mut poll).unwrap();
        let mut passes = 0;
        while krylov.blocks() < blocks {
            passes += usize::from(matches!(basis, Basis::Single { .. }) && krylov.due());
            krylov.step(&mut poll).unwrap();
        }
        assert!(passes > 0 || matches!(basis, Basis::Double(_)));
        krylov.ritz(&mut poll).unwrap().iter().map(|ritz| (ritz.theta.to_bits(), ritz.residual.to_bits())).collect()
    };
    for (basis, blocks) in [(Basis::Single { reach: sigma }, 16), (Basis::Double(&[]), 6)] {
        let best = run(2, basis, blocks);
        assert_eq!(best, run(1, basis, blocks));
        assert_eq!(best, run(0, basis, blocks));
    }
    SETS.set(2);
}

//! Against the full matrix, and where couplings, numbers or the whole matrix are nothing.

use super::*;
use crate::spectrum::{krylov::Random, small::eigen};

/// Random blocks, those of each row `fall` times the size of those of the row before.
fn random(blocks: usize, fall: f64, seed: u64) -> (Vec<Square>, Vec<Square>) {
    let mut random = Random(seed);
    let (mut alpha, mut beta) = (Vec::new(), Vec::new());
    let mut size = 1.0;
    for _ in 0..blocks {
        let mut square = |size: f64| -> Square { [(); WIDTH].map(|()| [(); WIDTH].map(|()| size * random.next())) };
        let full = square(size);
        alpha.push(std::array::from_fn(|i| std::array::from_fn(|j| full[i][j] + full[j][i])));
        size *= fall;
        let [mut upper, little] = [square(size), square(1e-8 * size)];
        for (i, row) in upper.iter_mut().enumerate() {
            row[..i].copy_from_slice(&little[i][..i]);
        }
        beta.push(upper);
    }
    (alpha, beta)
}

fn full(alpha: &[Square], beta: &[Square]) -> Vec<f64> {
    let n = alpha.len() * WIDTH;
    let mut a = vec![0.0; n * n];
    for row in 0..n {
        for column in 0..=row {
            let [(block, i), (left, j)] = [row, column].map(|at| (at / WIDTH, at % WIDTH));
            let value = match block - left {
                0 => alpha[block][i][j],
                1 => beta[left][i][j],
                _ => 0.0,
            };
            a[row * n + column] = value;
            a[column * n + row] = value;
        }
    }
    a
}

/// Eigenvalues, ascending, with the norms of the last block times their tails.
fn sorted(values: &[f64], tails: &[Row], last: &Square) -> Vec<(f64, f64)> {
    let norm = |tail: &Row| {
        let entry = |row: &Row| row.iter().zip(tail).map(|(a, b)| a * b).sum::<f64>();
        last.iter().map(|row| entry(row).powi(2)).sum::<f64>().sqrt()
    };
    let mut found: Vec<(f64, f64)> = values.iter().zip(tails).map(|(&value, tail)| (value, norm(tail))).collect();
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    found
}

fn size(blocks: &[Square]) -> f64 {
    blocks.iter().flatten().map(|row| row.iter().map(|x| x.abs()).sum::<f64>()).fold(0.0, f64::max)
}

/// The values and tails are those of the full matrix. Of values nearer to each other than `apart` times the norm
/// the tails are compared together.
#[track_caller]
fn assert_as_full(alpha: &[Square], beta: &[Square], apart: f64) {
    let n = alpha.len() * WIDTH;
    let mut expected = vec![[0.0; WIDTH]; n];
    for at in 0..WIDTH {
        expected[n - WIDTH + at][at] = 1.0;
    }
    let values = eigen(&full(alpha, beta), n, &mut expected).unwrap();
    let last = &beta[alpha.len() - 1];
    let expected = sorted(&values, &expected, last);
    let mut tails = Vec::new();
    let values = block_eigen(alpha, beta, &mut tails).unwrap();
    // The tails of all eigenvectors are eight orthonormal rows.
    for i in 0..WIDTH {
        for j in 0..WIDTH {
            let inner: f64 = tails.iter().map(|tail| tail[i] * tail[j]).sum();
            assert!((inner - f64::from(u8::from(i == j))).abs() < 1e-13, "{inner}");
        }
    }
    let found = sorted(&values, &tails, last);
    let norm = size(alpha) + 2.0 * size(&beta[..alpha.len() - 1]);
    for (found, expected) in found.iter().zip(&expected) {
        assert!((found.0 - expected.0).abs() <= 32.0 * f64::EPSILON * norm, "{n}: {found:?} {expected:?}");
    }
    let mut first = 0;
    while first < n {
        let mut end = first + 1;
        while end < n && expected[end].0 - expected[end - 1].0 <= apart * norm {
            end += 1;
        }
        let together = |list: &[(f64, f64)]| list[first..end].iter().map(|(_, norm)| norm * norm).sum::<f64>().sqrt();
        let (found, expected) = (together(&found), together(&expected));
        assert!((found - expected).abs() <= 1e-14 / apart.min(1e-3) * size(&[*last]), "{n}: {found} {expected}");
        first = end;
    }
}

#[test]
fn eigenvalues_and_tails_are_those_of_the_full_matrix() {
    for blocks in [1, 2, 3, 4, 7, 18, 25] {
        for fall in [1.0, 0.7, 1e-2, 1e-4] {
            let (alpha, beta) = random(blocks, fall, 3 + blocks as u64);
            assert_as_full(&alpha, &beta, 1e-3);
        }
    }
}

#[test]
fn couplings_may_be_missing() {
    for rank in [0, 1, 5] {
        let (alpha, mut beta) = random(6, 0.5, 11);
        for row in &mut beta[2][rank..] {
            row.fill(0.0);
        }
        for row in &mut beta[4] {
            row[rank] = 0.0;
        }
        assert_as_full(&alpha, &beta, 1e-3);
    }
}

#[test]
fn equal_eigenvalues_are_all_found() {
    let (alpha, beta) = random(3, 1.0, 17);
    // Three copies that know nothing of one another.
    let mut none = beta.clone();
    none[2] = Square::default();
    let (alpha, mut beta) = ([&alpha[..]; 3].concat(), [&none[..]; 3].concat());
    beta[8] = random(1, 1.0, 19).1[0];
    assert_as_full(&alpha, &beta, 1e-10);
    // Only couplings, so that the spectrum is symmetric; one value eight times; nothing at all.
    let zero = [Square::default(); 9];
    let unit: Square = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
    assert_as_full(&zero, &beta, 1e-10);
    assert_as_full(&[unit; 9], &zero, 1e-10);
    assert_as_full(&zero, &zero, 1e-10);
    let mut values = block_eigen(&zero, &[unit; 9], &mut Vec::new()).unwrap();
    values.sort_by(f64::total_cmp);
    for (at, value) in values.iter().rev().enumerate() {
        let expected = 2.0 * (std::f64::consts::PI * (at / WIDTH + 1) as f64 / 10.0).cos();
        assert!((value - expected).abs() < 1e-14, "{value} {expected}");
    }
}

#[test]
fn entries_may_fall_to_nothing() {
    let (alpha, beta) = random(25, 1e-30, 31);
    let mut tails = Vec::new();
    let mut values = block_eigen(&alpha, &beta, &mut tails).unwrap();
    // The other blocks are nothing beside the first.
    let mut first = block_eigen(&alpha[..1], &beta[..1], &mut Vec::new()).unwrap();
    for list in [&mut values, &mut first] {
        list.sort_by(|a, b| b.abs().total_cmp(&a.abs()));
    }
    for (at, value) in values.iter().enumerate() {
        let expected = first.get(at).copied().unwrap_or(0.0);
        assert!((value - expected).abs() < 1e-14, "{value} {expected}");
    }
    assert!(tails.iter().flatten().all(|x| x.abs() <= 1.0 + 1e-14));
}

#[test]
fn size_does_not_matter() {
    let (alpha, beta) = random(4, 0.3, 23);
    let scaled = |blocks: &[Square], by: f64| -> Vec<Square> {
        blocks.iter().map(|block| block.map(|row| row.map(|x| x * by))).collect()
    };
    let mut tails = [Vec::new(), Vec::new()];
    let values = block_eigen(&alpha, &beta, &mut tails[0]).unwrap();
    for by in [2.0_f64.powi(-900), 2.0_f64.powi(900)] {
        let other = block_eigen(&scaled(&alpha, by), &scaled(&beta, by), &mut tails[1]).unwrap();
        assert!(values.iter().zip(&other).all(|(a, b)| a * by == *b));
        assert_eq!(tails[0], tails[1]);
    }
}

#[test]
fn not_finite_is_no_answer() {
    for bad in [f64::NAN, f64::INFINITY] {
        let (alpha, mut beta) = random(3, 1.0, 29);
        beta[1][3][5] = bad;
        assert_eq!(block_eigen(&alpha, &beta, &mut Vec::new()), None);
        let (mut alpha, beta) = random(3, 1.0, 29);
        alpha[2][7][0] = bad;
        assert_eq!(block_eigen(&alpha, &beta, &mut Vec::new()), None);
    }
}

//! The kernels against plain sums.

use super::*;
use crate::spectrum::{krylov::Random, lanes::dispatch};

/// Rows that fill two tiles, a panel, and an odd part of another.
const LEN: usize = 2 * STRETCH + ROWS + 5;

const BLOCKS: usize = 5;

fn random(seed: u64) -> Vec<Row> {
    let mut random = Random(seed);
    (0..LEN).map(|_| std::array::from_fn(|_| random.next())).collect()
}

fn square(seed: u64) -> Square {
    let mut random = Random(seed);
    std::array::from_fn(|_| std::array::from_fn(|_| random.next()))
}

/// A block that is the same in single precision, and its panels.
fn block(seed: u64) -> (Vec<Row>, Vec<Panel>) {
    let rows: Vec<Row> = random(seed).into_iter().map(|row| row.map(|value| f64::from(value as f32))).collect();
    let mut all = vec![Panel::default(); panels(LEN)];
    for (at, row) in rows.iter().enumerate() {
        for (to, &value) in all[at / ROWS].0[at % ROWS / 2][0].0.iter_mut().zip(row) {
            to[at % 2] = value as f32;
        }
    }
    (rows, all)
}

/// Eᵀ F
fn dots(e: &[Row], f: &[Row]) -> Square {
    std::array::from_fn(|i| std::array::from_fn(|j| e.iter().zip(f).map(|(e, f)| e[i] * f[j]).sum()))
}

/// E − U M
fn less(e: &[Row], u: &[Row], m: &Square) -> Vec<Row> {
    let row = |(e, u): (&Row, &Row)| -> Row {
        std::array::from_fn(|j| e[j] - u.iter().zip(m).map(|(u, m)| u * m[j]).sum::<f64>())
    };
    e.iter().zip(u).map(row).collect()
}

fn near(a: &[Row], b: &[Row], tolerance: f64) {
    assert_eq!(a.len(), b.len());
    let off = a.as_flattened().iter().zip(b.as_flattened()).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
    assert!(off < tolerance, "{off:e}");
}

/// Sums over so many rows are off by a few roundings of single precision at their size.
const SUMMED: f64 = 4e-5;

#[test]
fn products_are_sums_over_all_rows() {
    let (rows, all): (Vec<_>, Vec<_>) = (0..BLOCKS).map(|at| block(at as u64 + 1)).unzip();
    let basis: Vec<&[Panel]> = all.iter().map(Vec::as_slice).collect();
    let (v, w, m) = (random(11), random(12), square(13));
    let right = Right { mass: &Product::Unit, w: &w, less: Some((&v, &m)) };
    let expected = less(&w, &v, &m);
    for beside in [None, Some(&v[..])] {
        let mut sums = vec![Sums::default(); BLOCKS];
        // In two parts, as where a pass is long.
        for rows in [0..STRETCH, STRETCH..LEN] {
            dispatch(PanelDots { basis: &basis, v: beside, right, rows, sums: &mut sums });
        }
        for (block, sums) in rows.iter().zip(&sums) {
            match beside {
                None => near(&total(sums), &dots(block, &expected), SUMMED),
                Some(v) => {
                    near(&sums.map(|[first, _]| first), &dots(block, v), SUMMED);
                    near(&sums.map(|[_, second]| second), &dots(block, &expected), SUMMED);
                }
            }
        }
    }
}

#[test]
fn the_recurrence_takes_out_one_block_and_looks_at_others() {
    let (rows, all): (Vec<_>, Vec<_>) = (0..3).map(|at| block(at + 1)).unzip();
    let basis: Vec<&[Panel]> = all.iter().map(Vec::as_slice).collect();
    let (past, newest, mut w, factor) = (random(11), random(12), random(13), square(14));
    let expected = less(&w, &past, &factor);
    let mut sums = vec![Sums::default(); 3];
    let (w, sums) = (&mut w, &mut sums);
    let gram = dispatch(Recur { past: &past, factor: &factor, newest: &newest, w, basis: &basis, sums });
    near(w, &expected, 1e-14);
    near(&gram, &dots(&newest, &expected), 1e-12);
    for (block, sums) in rows.iter().zip(sums) {
        near(&total(sums), &dots(block, &expected), SUMMED);
    }
}

#[test]
fn updates_take_out_what_is_along_the_basis() {
    // As small as what orthogonalisation takes out.
    let small = |seed| square(seed).map(|row| row.map(|value| 1e-7 * value));
    let (rows, all): (Vec<_>, Vec<_>) = (0..BLOCKS).map(|at| block(at as u64 + 1)).unzip();
    let basis: Vec<&[Panel]> = all.iter().map(Vec::as_slice).collect();
    let (c, d): (Vec<_>, Vec<_>) = (0..BLOCKS as u64).map(|at| (small(20 + at), small(30 + at))).unzip();
    let (v, w, m) = (random(11), random(12), square(13));
    let off = |from: &[Row], factors: &[Square]| {
        rows.iter().zip(factors).fold(from.to_vec(), |left, (block, factor)| less(&left, block, factor))
    };
    // Forty products of 1e-7 with a rounding of single precision each.
    let tolerance = 4e-13;

    let mut got = w.clone();
    let factors: Vec<_> = d.iter().map(|d| factor(d, d)).collect();
    for rows in [STRETCH..LEN, 0..STRETCH] {
        let less = Some((&v[..], &m));
        dispatch(PanelUpdate { basis: &basis, factors: &factors, w: &mut got, less, rows });
    }
    near(&got, &less(&off(&w, &d), &v, &m), tolerance);

    let (mut new, mut got, mut copy) = (v.clone(), w.clone(), vec![Panel::default(); panels(LEN)]);
    let factors: Vec<_> = c.iter().zip(&d).map(|(c, d)| factor(c, d)).collect();
    for rows in [STRETCH..LEN, 0..STRETCH] {
        let (v, copy, w) = (&mut new, &mut copy, &mut got);
        dispatch(PairUpdate { basis: &basis, factors: &factors, v, copy, w, along: &m, rows });
    }
    near(&new, &off(&v, &c), tolerance);
    near(&got, &less(&off(&w, &d), &v, &m), tolerance);
    for (at, row) in new.iter().enumerate() {
        let twin = &copy[at / ROWS].0[at % ROWS / 2][0];
        assert_eq!(twin.0.map(|pair| pair[at % 2]), row.map(|value| value as f32));
    }
}

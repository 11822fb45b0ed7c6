//! Orthogonalisation of two blocks together against many.
//!
//! A row of both blocks is a register of sixteen numbers, and every number of the basis is multiplied with one. So a
//! product of two blocks is one register for each vector of the basis, of which hardly any are added up, and no lanes
//! are ever moved.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::ops::Range;

use super::{
    block::{self, Square},
    lanes::{Kernel, Lanes, Row, WIDTH},
    panel::{Panel, ROWS, panels, read},
    product::Product,
};

/// Eight by eight numbers for each of two blocks, row beside row.
pub(super) type Squares = [[Row; 2]; WIDTH];

/// A row of both blocks.
type Both = [f32; 2 * WIDTH];

/// As many rows as a panel has.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
struct Rows([Both; ROWS]);

const NOTHING: Rows = Rows([[0.0; 2 * WIDTH]; ROWS]);

/// Panels of a block that are taken at a time: a page of memory, as much as the hardware fetches ahead.
const TILE: usize = 8;

/// Panels over which products are added up one by one, before their sum is added to others.
const RUN: usize = 2;

/// Products `Vᵢᵀ R` of every block of a basis with two right sides: with v and with `B w − v M`.
///
/// They are summed in single precision over the rows of a tile, and in double precision over the tiles, and are added
/// to what is there.
pub(super) struct PairDots<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub v: &'a [Row],
    pub mass: &'a Product,
    pub w: &'a [Row],
    /// M.
    pub along: &'a Square,
    /// Whole tiles, but for the last one of all.
    pub rows: Range<usize>,
    /// For each block.
    pub sums: &'a mut [Squares],
}

impl Kernel for PairDots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, v, mass, w, along, rows, sums } = self;
        let along = along.each_ref().map(|row| lanes.load(row));
        let mut tile = [NOTHING; TILE];
        let mut group = [[0.0; WIDTH]; ROWS];
        let last = panels(rows.end);
        for first in (rows.start / ROWS..last).step_by(TILE) {
            let range = first..last.min(first + TILE);
            for (panel, tile) in range.clone().zip(&mut tile) {
                let rows = panel * ROWS..rows.end.min((panel + 1) * ROWS);
                let group = &mut group[..rows.len()];
                mass.group(lanes, w, panel, group);
                if group.len() < ROWS {
                    *tile = NOTHING;
                }
                for ((to, w), v) in tile.0.iter_mut().zip(group).zip(&v[rows]) {
                    let left = block::less(lanes, lanes.load(w), v, &along);
                    *to = lanes.wide_row(lanes.narrow([lanes.load(v), left]));
                }
            }
            let tile = &tile[..range.len()];
            for ((number, block), sums) in basis.iter().enumerate().zip(sums.iter_mut()) {
                let (block, next) = (&block[range.clone()], after(basis, number, &range, Some(range.end)));
                if L::MANY {
                    dots::<L, WIDTH>(lanes, block, next, tile, 0, sums);
                } else {
                    dots::<L, { WIDTH / 2 }>(lanes, block, next, tile, 0, sums);
                    dots::<L, { WIDTH / 2 }>(lanes, block, &[], tile, WIDTH / 2, sums);
                }
            }
        }
    }
}

/// What comes after some panels of a block: the same ones of the next block, and after the last block those of the
/// first one from `then` on. None of them may be there.
#[inline(always)]
pub(super) fn after<'a>(
    basis: &[&'a [Panel]],
    number: usize,
    range: &Range<usize>,
    then: Option<usize>,
) -> &'a [Panel] {
    match (basis.get(number + 1), then) {
        (Some(next), _) => &next[range.clone()],
        (None, Some(then)) => basis[0].get(then..then + range.len()).unwrap_or_default(),
        (None, None) => &[],
    }
}

/// Has the panel fetched that comes when this one is done.
#[inline(always)]
fn fetch<L: Lanes>(lanes: L, panel: Option<&Panel>) {
    for column in panel.map_or(&[][..], |panel| &panel.0) {
        lanes.fetch(column);
    }
}

/// Adds the products of `N` vectors of a block, from `i` on, with a tile.
#[inline(always)]
fn dots<L: Lanes, const N: usize>(
    lanes: L,
    block: &[Panel],
    next: &[Panel],
    tile: &[Rows],
    i: usize,
    sums: &mut Squares,
) {
    let mut sum = [lanes.wide_splat(0.0); N];
    for (run, (block, tile)) in block.chunks(RUN).zip(tile.chunks(RUN)).enumerate() {
        let mut part = [lanes.wide_splat(0.0); N];
        for (at, (panel, rows)) in block.iter().zip(tile).enumerate() {
            fetch(lanes, next.get(run * RUN + at));
            for (at, row) in rows.0.iter().enumerate() {
                let row = lanes.wide(row);
                for (part, vector) in part.iter_mut().zip(&panel.0[i..i + N]) {
                    *part = lanes.wide_add_mul(*part, lanes.wide_splat(vector[at]), row);
                }
            }
        }
        for (sum, part) in sum.iter_mut().zip(part) {
            *sum = lanes.wide_add(*sum, part);
        }
    }
    for (sums, sum) in sums[i..i + N].iter_mut().zip(sum) {
        for (to, sum) in sums.iter_mut().zip(lanes.widen(sum)) {
            *to = lanes.row(lanes.add(lanes.load(to), sum));
        }
    }
}

/// `v −= Σ Vᵢ Cᵢ` and `w −= Σ Vᵢ Dᵢ + v M` with v as it was before, over the blocks of a basis, for C and D so small
/// that single precision is enough for the sums. A copy of v in single precision is made anew.
///
/// It goes from the end to the beginning, for the end of the basis is what the cache has of it after [`PairDots`].
pub(super) struct PairUpdate<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    /// The rows of C and D beside each other.
    pub factors: &'a [[Both; WIDTH]],
    pub v: &'a mut [Row],
    pub copy: &'a mut [Panel],
    pub w: &'a mut [Row],
    /// M.
    pub along: &'a Square,
    /// Whole tiles, but for the last one of all.
    pub rows: Range<usize>,
}

impl Kernel for PairUpdate<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, v, copy, w, along, rows } = self;
        let along = along.each_ref().map(|row| lanes.load(row));
        let mut sums = [NOTHING; TILE];
        let last = panels(rows.end);
        for first in (rows.start / ROWS..last).step_by(TILE).rev() {
            let range = first..last.min(first + TILE);
            let sums = &mut sums[..range.len()];
            sums.fill(NOTHING);
            for ((number, block), factors) in basis.iter().enumerate().zip(factors) {
                let (block, next) = (&block[range.clone()], after(basis, number, &range, first.checked_sub(TILE)));
                if L::MANY {
                    update::<L, WIDTH, ROWS>(lanes, block, next, factors, sums, 0);
                } else {
                    update::<L, { WIDTH / 2 }, 2>(lanes, block, next, factors, sums, 0);
                    update::<L, { WIDTH / 2 }, 2>(lanes, block, &[], factors, sums, WIDTH / 2);
                }
            }
            for (panel, sums) in range.zip(sums) {
                let rows = panel * ROWS..rows.end.min((panel + 1) * ROWS);
                let (v, w) = (&mut v[rows.clone()], &mut w[rows]);
                for ((v, w), sum) in v.iter_mut().zip(w).zip(&sums.0) {
                    let [off, sum] = lanes.widen(lanes.wide(sum));
                    *w = lanes.row(block::less(lanes, lanes.sub(lanes.load(w), sum), v, &along));
                    *v = lanes.row(lanes.sub(lanes.load(v), off));
                }
                copy[panel].0 = read(lanes, v).map(|column| lanes.wide_row(column));
            }
        }
    }
}

/// Adds the products of `N` vectors of a block, from `k` on, with their factors, `R` rows at a time.
#[inline(always)]
fn update<L: Lanes, const N: usize, const R: usize>(
    lanes: L,
    block: &[Panel],
    next: &[Panel],
    factors: &[Both; WIDTH],
    sums: &mut [Rows],
    k: usize,
) {
    let mut factor = [lanes.wide_splat(0.0); N];
    for (to, factor) in factor.iter_mut().zip(&factors[k..]) {
        *to = lanes.wide(factor);
    }
    for (at, (panel, sums)) in block.iter().zip(sums).enumerate() {
        fetch(lanes, next.get(at));
        for (rows, sums) in sums.0.as_chunks_mut::<R>().0.iter_mut().enumerate() {
            let mut sum = [lanes.wide_splat(0.0); R];
            for (to, sum) in sum.iter_mut().zip(sums.iter()) {
                *to = lanes.wide(sum);
            }
            for (&factor, vector) in factor.iter().zip(&panel.0[k..k + N]) {
                for (sum, &value) in sum.iter_mut().zip(&vector[rows * R..]) {
                    *sum = lanes.wide_add_mul(*sum, lanes.wide_splat(value), factor);
                }
            }
            for (to, sum) in sums.iter_mut().zip(sum) {
                *to = lanes.wide_row(sum);
            }
        }
    }
}

//! Blocks of eight vectors in single precision, for orthogonalisation of one or two blocks against many.
//!
//! A register has sixteen numbers, a [`Twin`]: two rows of one block, or one row of two blocks, number beside number. A
//! basis is kept as twins of two rows. Two rows of a block are multiplied with the same two rows of a vector of the
//! basis, by turns; a row of two blocks with one number. So lanes are moved only where rows enter and leave, and a
//! product needs no more sums than it has numbers, or twice as many.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

use super::{
    block::{self, Square},
    lanes::{Kernel, Lanes, Row, Twin, WIDTH},
    product::{GROUP, Product},
};

pub(super) use self::blocks::Blocks;

mod blocks;

/// Rows in a panel.
pub(super) const ROWS: usize = GROUP;

/// Sixteen rows of a block, two by two.
#[derive(Debug, Clone, Copy, Default, Pod, Zeroable)]
#[repr(transparent)]
pub(super) struct Panel(pub Beside<1>);

const TWOS: usize = ROWS / 2;

/// As many rows of so many blocks: two rows are as many registers.
pub(super) type Beside<const BLOCKS: usize> = [[Twin; BLOCKS]; TWOS];

/// Nothing, in all of a tile.
const fn nothing<const BLOCKS: usize>() -> [Beside<BLOCKS>; TILE] {
    [[[Twin([[0.0; 2]; WIDTH]); BLOCKS]; TWOS]; TILE]
}

/// Panels that a block of so many rows takes; the rows that it lacks are zero.
const fn panels(rows: usize) -> usize {
    rows.div_ceil(ROWS)
}

/// Sixteen rows at most, two by two.
#[inline(always)]
fn set<L: Lanes>(lanes: L, to: &mut Beside<1>, rows: &[Row]) {
    let (twos, rest) = rows.as_chunks::<2>();
    for (to, [first, second]) in to.as_flattened_mut().iter_mut().zip(twos) {
        *to = lanes.twin(lanes.beside([lanes.load(first), lanes.load(second)]));
    }
    if rows.len() < ROWS {
        to[twos.len()..].fill([Twin::default()]);
        if let [last] = rest {
            to[twos.len()] = [lanes.twin(lanes.beside([lanes.load(last), lanes.zero()]))];
        }
    }
}

/// `x = x M` and `y = copy = y M` for a block x and y = Bx, where M makes x orthonormal; both results are rounded to
/// single precision as well, for the basis, if there is room for them.
pub(super) struct Normalise<'a> {
    pub x: &'a mut [Row],
    pub y: &'a mut [Row],
    pub factor: &'a Square,
    pub copy: &'a mut [Row],
    pub single: [&'a mut [Panel]; 2],
}

impl Kernel for Normalise<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { x, y, factor, copy, single: [first, second] } = self;
        let factor: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&factor[at]));
        let groups = x.chunks_mut(ROWS).zip(y.chunks_mut(ROWS)).zip(copy.chunks_mut(ROWS));
        for (at, ((x, y), copy)) in groups.enumerate() {
            for x in x.iter_mut() {
                *x = lanes.row(block::combine(lanes, x, &factor));
            }
            for (y, copy) in y.iter_mut().zip(copy) {
                *y = lanes.row(block::combine(lanes, y, &factor));
                *copy = *y;
            }
            for (to, rows) in [(first.get_mut(at), x), (second.get_mut(at), y)] {
                if let Some(to) = to {
                    set(lanes, &mut to.0, rows);
                }
            }
        }
    }
}

/// Panels of a block that are taken at a time: a page of memory, as much as the hardware fetches ahead.
const TILE: usize = 8;

/// Rows by which the work of the kernels below can be parted.
pub(super) const STRETCH: usize = TILE * ROWS;

/// Panels whose products are added up in single precision, panel by panel. With twice as many the bounds of eigenvalues
/// are up to twice as wide.
const RUN: usize = 2;

/// The products of a block of a basis with the sixteen numbers of a register, number beside number: for two blocks
/// their products, for two rows of one block what comes of either of them.
pub(super) type Sums = [[Row; 2]; WIDTH];

/// Both of these together.
pub(super) fn total(sums: &Sums) -> Square {
    sums.map(|[one, other]| std::array::from_fn(|at| one[at] + other[at]))
}

/// A product R = B w, or B w − U M if such a pair is given.
#[derive(Clone, Copy)]
pub(super) struct Right<'a> {
    pub mass: &'a Product,
    pub w: &'a [Row],
    /// U and M.
    pub less: Option<(&'a [Row], &'a Square)>,
}

/// Products `Vᵢᵀ R` of every block of a basis, and `Vᵢᵀ v` if a block v is given, too.
///
/// They are summed in single precision over the rows of a few panels, and in double precision over those, and are added
/// to what is there: R in the first place for R alone, else v in the first and R in the second.
pub(super) struct PanelDots<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub v: Option<&'a [Row]>,
    pub right: Right<'a>,
    /// Of one [`STRETCH`] or several.
    pub rows: Range<usize>,
    /// For each block.
    pub sums: &'a mut [Sums],
}

impl Kernel for PanelDots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, v, right: Right { mass, w, less }, rows, sums } = self;
        let less = less.map(|(u, factor)| (u, factor.each_ref().map(|row| lanes.load(row))));
        let (mut tile, mut pairs) = (nothing::<1>(), nothing::<2>());
        let mut group = [[0.0; WIDTH]; ROWS];
        let last = panels(rows.end);
        for first in (rows.start / ROWS..last).step_by(TILE) {
            let range = first..last.min(first + TILE);
            for ((panel, tile), pairs) in range.clone().zip(&mut tile).zip(&mut pairs) {
                let rows = panel * ROWS..rows.end.min((panel + 1) * ROWS);
                let group = &mut group[..rows.len()];
                mass.group(lanes, w, panel, group);
                if let Some((u, factor)) = &less {
                    for (to, u) in group.iter_mut().zip(&u[rows.clone()]) {
                        *to = lanes.row(block::less(lanes, lanes.load(to), u, factor));
                    }
                }
                if let Some(v) = v {
                    if group.len() < ROWS {
                        *pairs = Default::default();
                    }
                    for ((to, right), v) in pairs.as_flattened_mut().iter_mut().zip(group).zip(&v[rows]) {
                        *to = lanes.twin(lanes.beside([lanes.load(v), lanes.load(right)]));
                    }
                } else {
                    set(lanes, tile, group);
                }
            }
            if v.is_some() {
                all_dots(lanes, basis, &range, &pairs, sums);
            } else {
                all_dots(lanes, basis, &range, &tile, sums);
            }
        }
    }
}

/// `w −= past M`; returns `newestᵀ w`, and adds to the i-th sums `Vᵢᵀ w` for every block of a basis.
pub(super) struct Recur<'a, 'b> {
    pub past: &'a [Row],
    pub factor: &'a Square,
    pub newest: &'a [Row],
    pub w: &'a mut [Row],
    pub basis: &'a [&'b [Panel]],
    pub sums: &'a mut [Sums],
}

impl Kernel for Recur<'_, '_> {
    type Output = Square;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Square {
        let Self { past, factor, newest, w, basis, sums } = self;
        let factor: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&factor[at]));
        let mut gram = [lanes.zero(); WIDTH];
        let mut tile = nothing::<1>();
        for (at, w) in w.chunks_mut(STRETCH).enumerate() {
            let range = at * TILE..at * TILE + panels(w.len());
            for ((tile, w), first) in tile.iter_mut().zip(w.chunks_mut(ROWS)).zip((at * STRETCH..).step_by(ROWS)) {
                let rows = first..first + w.len();
                for ((w, past), newest) in w.iter_mut().zip(&past[rows.clone()]).zip(&newest[rows]) {
                    let sum = block::less(lanes, lanes.load(w), past, &factor);
                    *w = lanes.row(sum);
                    for (gram, &value) in gram.iter_mut().zip(newest) {
                        *gram = lanes.add_mul(*gram, lanes.splat(value), sum);
                    }
                }
                if !basis.is_empty() {
                    set(lanes, tile, w);
                }
            }
            all_dots(lanes, basis, &range, &tile, sums);
        }
        gram.map(|sum| lanes.row(sum))
    }
}

/// What comes after some panels of a block: the same ones of the next block, and after the last block those of the
/// first one from `then` on. None of them may be there.
#[inline(always)]
fn after<'a>(basis: &[&'a [Panel]], number: usize, range: &Range<usize>, then: Option<usize>) -> &'a [Panel] {
    match (basis.get(number + 1), then) {
        (Some(next), _) => &next[range.clone()],
        (None, Some(then)) => basis[0].get(then..then + range.len()).unwrap_or_default(),
        (None, None) => &[],
    }
}

/// What is multiplied with a register: two numbers of a vector if it has two rows, or one of them if it has two blocks.
#[inline(always)]
fn splat<L: Lanes, const BLOCKS: usize>(lanes: L, two: &Twin, vector: usize, row: usize) -> L::Wide {
    let two = two.0[vector];
    if BLOCKS == 1 { lanes.wide_splat_two(two) } else { lanes.wide_splat(two[row]) }
}

/// Adds the products of these panels of every block of a basis with a tile.
#[inline(always)]
fn all_dots<L: Lanes, const BLOCKS: usize>(
    lanes: L,
    basis: &[&[Panel]],
    range: &Range<usize>,
    tile: &[Beside<BLOCKS>; TILE],
    sums: &mut [Sums],
) {
    for ((number, block), sums) in basis.iter().enumerate().zip(sums) {
        let (block, next) = (&block[range.clone()], after(basis, number, range, Some(range.end)));
        if L::MANY {
            dots::<L, BLOCKS, WIDTH>(lanes, block, next, tile, 0, sums);
        } else {
            dots::<L, BLOCKS, { WIDTH / 2 }>(lanes, block, next, tile, 0, sums);
            dots::<L, BLOCKS, { WIDTH / 2 }>(lanes, block, &[], tile, WIDTH / 2, sums);
        }
    }
}

/// Adds the products of `N` vectors of a block, from `i` on, with a tile.
#[inline(always)]
fn dots<L: Lanes, const BLOCKS: usize, const N: usize>(
    lanes: L,
    block: &[Panel],
    next: &[Panel],
    tile: &[Beside<BLOCKS>; TILE],
    i: usize,
    sums: &mut Sums,
) {
    for (run, (block, tile)) in block.chunks(RUN).zip(tile.chunks(RUN)).enumerate() {
        let mut sum = [lanes.wide_splat(0.0); N];
        for (at, (panel, rows)) in block.iter().zip(tile).enumerate() {
            let next = next.get(run * RUN + at).unwrap_or(panel);
            let mut parts = [[lanes.wide_splat(0.0); N]; BLOCKS];
            for ((two, next), rows) in panel.0.iter().zip(&next.0).zip(rows) {
                lanes.fetch(&next[0]);
                for ((at, row), part) in rows.iter().enumerate().zip(&mut parts) {
                    let row = lanes.wide(row);
                    for (vector, part) in part.iter_mut().enumerate() {
                        *part = lanes.wide_add_mul(*part, splat::<L, BLOCKS>(lanes, &two[0], i + vector, at), row);
                    }
                }
            }
            for part in parts {
                for (sum, part) in sum.iter_mut().zip(part) {
                    *sum = lanes.wide_add(*sum, part);
                }
            }
        }
        for (sums, sum) in sums[i..i + N].iter_mut().zip(sum) {
            for (to, sum) in sums.iter_mut().zip(lanes.apart(sum)) {
                *to = lanes.row(lanes.add(lanes.load(to), sum));
            }
        }
    }
}

/// `w −= Σ Vᵢ Cᵢ` over the blocks of a basis, for C so small that single precision is enough for the sum, and
/// `w −= U M` if such a pair is given.
///
/// It goes from the end to the beginning, for the end of the basis is what the cache has of it after [`PanelDots`].
pub(super) struct PanelUpdate<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    /// The rows of each C, from [`factor`].
    pub factors: &'a [[Twin; WIDTH]],
    pub w: &'a mut [Row],
    /// U and M.
    pub less: Option<(&'a [Row], &'a Square)>,
    /// Of one [`STRETCH`] or several.
    pub rows: Range<usize>,
}

impl Kernel for PanelUpdate<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, w, less, rows } = self;
        let less = less.map(|(u, factor)| (u, factor.each_ref().map(|row| lanes.load(row))));
        let mut sums = nothing::<1>();
        let last = panels(rows.end);
        for first in (rows.start / ROWS..last).step_by(TILE).rev() {
            let range = first..last.min(first + TILE);
            let sums = &mut sums[..range.len()];
            all_updates(lanes, basis, factors, &range, sums);
            for (panel, sums) in range.zip(sums) {
                let rows = panel * ROWS..rows.end.min((panel + 1) * ROWS);
                for ((w, [sum]), row) in w[rows.clone()].chunks_mut(2).zip(sums).zip(rows.step_by(2)) {
                    for ((w, sum), row) in w.iter_mut().zip(lanes.apart(lanes.wide(sum))).zip(row..) {
                        let mut left = lanes.sub(lanes.load(w), sum);
                        if let Some((u, factor)) = &less {
                            left = block::less(lanes, left, &u[row], factor);
                        }
                        *w = lanes.row(left);
                    }
                }
            }
        }
    }
}

/// `v −= Σ Vᵢ Cᵢ` and `w −= Σ Vᵢ Dᵢ + v M` with v as it was before, over the blocks of a basis, for C and D so small
/// that single precision is enough for the sums. A copy of v in single precision is made anew. In the same order as
/// [`PanelUpdate`].
pub(super) struct PairUpdate<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    /// The rows of each C and D, from [`factor`].
    pub factors: &'a [[Twin; WIDTH]],
    pub v: &'a mut [Row],
    pub copy: &'a mut [Panel],
    pub w: &'a mut [Row],
    /// M.
    pub along: &'a Square,
    /// Of one [`STRETCH`] or several.
    pub rows: Range<usize>,
}

impl Kernel for PairUpdate<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, v, copy, w, along, rows } = self;
        let along = along.each_ref().map(|row| lanes.load(row));
        let mut sums = nothing::<2>();
        let last = panels(rows.end);
        for first in (rows.start / ROWS..last).step_by(TILE).rev() {
            let range = first..last.min(first + TILE);
            let sums = &mut sums[..range.len()];
            all_updates(lanes, basis, factors, &range, sums);
            for (panel, sums) in range.zip(sums) {
                let rows = panel * ROWS..rows.end.min((panel + 1) * ROWS);
                let (v, w) = (&mut v[rows.clone()], &mut w[rows]);
                for ((v, w), sum) in v.iter_mut().zip(w).zip(sums.as_flattened()) {
                    let [off, sum] = lanes.apart(lanes.wide(sum));
                    *w = lanes.row(block::less(lanes, lanes.sub(lanes.load(w), sum), v, &along));
                    *v = lanes.row(lanes.sub(lanes.load(v), off));
                }
                set(lanes, &mut copy[panel].0, v);
            }
        }
    }
}

/// What the updates multiply with: the rows of two matrices beside each other, or of one beside itself.
pub(super) fn factor(first: &Square, second: &Square) -> [Twin; WIDTH] {
    std::array::from_fn(|i| Twin(std::array::from_fn(|j| [first[i][j] as f32, second[i][j] as f32])))
}

/// Sets sums to the products of these panels of all blocks with their factors.
#[inline(always)]
fn all_updates<L: Lanes, const BLOCKS: usize>(
    lanes: L,
    basis: &[&[Panel]],
    factors: &[[Twin; WIDTH]],
    range: &Range<usize>,
    sums: &mut [Beside<BLOCKS>],
) {
    sums.fill([[Twin::default(); BLOCKS]; TWOS]);
    for ((number, block), factors) in basis.iter().enumerate().zip(factors) {
        let (block, next) = (&block[range.clone()], after(basis, number, range, range.start.checked_sub(TILE)));
        if L::MANY {
            update::<L, BLOCKS, WIDTH, TWOS>(lanes, block, next, factors, sums, 0);
        } else {
            update::<L, BLOCKS, { WIDTH / 2 }, 1>(lanes, block, next, factors, sums, 0);
            update::<L, BLOCKS, { WIDTH / 2 }, 1>(lanes, block, &[], factors, sums, WIDTH / 2);
        }
    }
}

/// Adds the products of `N` vectors of a block, from `k` on, with their factors, `T` times two rows at a time.
#[inline(always)]
fn update<L: Lanes, const BLOCKS: usize, const N: usize, const T: usize>(
    lanes: L,
    block: &[Panel],
    next: &[Panel],
    factors: &[Twin; WIDTH],
    sums: &mut [Beside<BLOCKS>],
    k: usize,
) {
    let mut factor = [lanes.wide_splat(0.0); N];
    for (to, factor) in factor.iter_mut().zip(&factors[k..]) {
        *to = lanes.wide(factor);
    }
    for (at, (panel, sums)) in block.iter().zip(sums).enumerate() {
        let next = next.get(at).unwrap_or(panel);
        for twin in next.0.as_flattened() {
            lanes.fetch(twin);
        }
        for (twos, sums) in panel.0.as_flattened().as_chunks::<T>().0.iter().zip(sums.as_chunks_mut::<T>().0) {
            let mut sum = [[lanes.wide_splat(0.0); BLOCKS]; T];
            for (to, sum) in sum.as_flattened_mut().iter_mut().zip(sums.as_flattened()) {
                *to = lanes.wide(sum);
            }
            for (vector, &factor) in factor.iter().enumerate() {
                for (two, sum) in twos.iter().zip(&mut sum) {
                    for (row, sum) in sum.iter_mut().enumerate() {
                        *sum = lanes.wide_add_mul(*sum, splat::<L, BLOCKS>(lanes, two, k + vector, row), factor);
                    }
                }
            }
            for (to, &sum) in sums.as_flattened_mut().iter_mut().zip(sum.as_flattened()) {
                *to = lanes.twin(sum);
            }
        }
    }
}

#[cfg(test)]
mod tests;

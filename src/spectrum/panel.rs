//! Blocks of eight vectors in single precision, for orthogonalisation against many of them.
//!
//! That work is bounded by the memory's bandwidth, so halving the numbers halves its time. Sixteen entries of one
//! vector lie together, so that both kernels below multiply whole registers without moving their lanes.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::ops::Range;

use super::{
    block::{self, Square},
    lanes::{Kernel, Lanes, Row, WIDTH},
    pair::after,
    product::{GROUP, Product},
};

/// Rows in a panel.
pub(super) const ROWS: usize = GROUP;

/// Sixteen rows of a block, vector by vector.
#[derive(Debug, Clone, Copy, Default)]
#[repr(C, align(64))]
pub(super) struct Panel(pub [[f32; ROWS]; WIDTH]);

/// Panels that a block of so many rows takes; the rows that it lacks are zero.
pub(super) const fn panels(rows: usize) -> usize {
    rows.div_ceil(ROWS)
}

/// Reads sixteen rows into a panel's registers.
#[inline(always)]
pub(super) fn read<L: Lanes>(lanes: L, rows: &[Row]) -> [L::Wide; WIDTH] {
    match rows.as_array::<ROWS>() {
        Some(rows) => lanes.columns(rows),
        None => lanes.columns(&std::array::from_fn(|at| rows.get(at).copied().unwrap_or_default())),
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
                    to.0 = read(lanes, rows).map(|column| lanes.wide_row(column));
                }
            }
        }
    }
}

/// Panels of both factors that stay in a near cache.
const TILE: usize = 32;

/// Products `Vᵢᵀ R` of every block of a basis with `R = B w`, or `B w − U M` if such a pair is given.
///
/// Products are summed in single precision over the rows of a tile, and in double precision over the tiles. They are
/// added to what is there, 64 rows for each block, of which [`totals`] makes squares.
pub(super) struct PanelDots<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub mass: &'a Product,
    pub w: &'a [Row],
    /// U and M.
    pub less: Option<(&'a [Row], &'a Square)>,
    /// Of one [`STRETCH`] or several.
    pub rows: Range<usize>,
    pub room: &'a mut [Row],
}

/// Rows by which the kernels below can be divided.
pub(super) const STRETCH: usize = TILE * ROWS;

impl Kernel for PanelDots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, mass, w, less, rows, room } = self;
        let less = less.map(|(u, factor)| (u, factor.each_ref().map(|row| lanes.load(row))));
        let len = rows.end;
        let mut tile = [Panel::default(); TILE];
        let mut group = [[0.0; WIDTH]; ROWS];
        for at in rows.start / STRETCH..len.div_ceil(STRETCH) {
            let rows = at * STRETCH..len.min((at + 1) * STRETCH);
            let used = panels(rows.len());
            for (panel, first) in tile[..used].iter_mut().zip(rows.step_by(ROWS)) {
                let group = &mut group[..ROWS.min(len - first)];
                mass.group(lanes, w, first / ROWS, group);
                if let Some((u, factor)) = &less {
                    for (to, u) in group.iter_mut().zip(&u[first..]) {
                        *to = lanes.row(block::less(lanes, lanes.load(to), u, factor));
                    }
                }
                panel.0 = read(lanes, group).map(|column| lanes.wide_row(column));
            }
            let range = at * TILE..at * TILE + used;
            for ((number, block), total) in basis.iter().enumerate().zip(room.chunks_mut(WIDTH * WIDTH)) {
                let next = after(basis, number, &range, Some(range.end));
                with_tile(lanes, &block[range.clone()], next, &tile[..used], total);
            }
        }
    }
}

/// `w −= past M`; returns `newestᵀ w`, and sets the i-th square to `Vᵢᵀ w` for every block of a basis.
pub(super) struct Recur<'a, 'b> {
    pub past: &'a [Row],
    pub factor: &'a Square,
    pub newest: &'a [Row],
    pub w: &'a mut [Row],
    pub basis: &'a [&'b [Panel]],
    /// 64 rows for each block.
    pub room: &'a mut Vec<Row>,
    pub sums: &'a mut Vec<Square>,
}

impl Kernel for Recur<'_, '_> {
    type Output = Square;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Square {
        let Self { past, factor, newest, w, basis, room, sums } = self;
        let factor: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&factor[at]));
        let mut gram = [lanes.zero(); WIDTH];
        room.clear();
        room.resize(basis.len() * WIDTH * WIDTH, [0.0; WIDTH]);
        let mut tile = [Panel::default(); TILE];
        for (at, w) in w.chunks_mut(TILE * ROWS).enumerate() {
            let first = at * TILE * ROWS;
            let used = panels(w.len());
            for ((panel, w), first) in tile.iter_mut().zip(w.chunks_mut(ROWS)).zip((first..).step_by(ROWS)) {
                let rows = first..first + w.len();
                for ((w, past), newest) in w.iter_mut().zip(&past[rows.clone()]).zip(&newest[rows]) {
                    let sum = block::less(lanes, lanes.load(w), past, &factor);
                    *w = lanes.row(sum);
                    for (gram, &value) in gram.iter_mut().zip(newest) {
                        *gram = lanes.add_mul(*gram, lanes.splat(value), sum);
                    }
                }
                if !basis.is_empty() {
                    panel.0 = read(lanes, w).map(|column| lanes.wide_row(column));
                }
            }
            let range = at * TILE..at * TILE + used;
            for ((number, block), total) in basis.iter().enumerate().zip(room.chunks_mut(WIDTH * WIDTH)) {
                let next = after(basis, number, &range, Some(range.end));
                with_tile(lanes, &block[range.clone()], next, &tile[..used], total);
            }
        }
        totals(room, sums);
        gram.map(|sum| lanes.row(sum))
    }
}

/// Adds the products of the vectors of a block with those of a tile, and has fetched what comes next.
#[inline(always)]
fn with_tile<L: Lanes>(lanes: L, block: &[Panel], next: &[Panel], tile: &[Panel], total: &mut [Row]) {
    if L::MANY {
        for (part, j) in (0..WIDTH).step_by(2).enumerate() {
            let quarter = TILE / 4;
            let next = next.get(part * quarter..(part + 1) * quarter).unwrap_or_default();
            dots::<L, WIDTH, 2>(lanes, block, next, tile, (0, j), total);
        }
    } else {
        for i in (0..WIDTH).step_by(2) {
            for j in (0..WIDTH).step_by(2) {
                dots::<L, 2, 2>(lanes, block, &[], tile, (i, j), total);
            }
        }
    }
}

/// The products that eight partial sums each say.
pub(super) fn totals(room: &[Row], sums: &mut Vec<Square>) {
    sums.clear();
    sums.extend(room.chunks(WIDTH * WIDTH).map(|total| -> Square {
        std::array::from_fn(|i| std::array::from_fn(|j| total[i * WIDTH + j].iter().sum()))
    }));
}

/// Adds the products of `M` vectors of a block with `N` of the tile, as eight partial sums each.
#[inline(always)]
fn dots<L: Lanes, const M: usize, const N: usize>(
    lanes: L,
    block: &[Panel],
    next: &[Panel],
    tile: &[Panel],
    (i, j): (usize, usize),
    total: &mut [Row],
) {
    let mut sum = [[lanes.wide_splat(0.0); N]; M];
    for (at, (x, y)) in block.iter().zip(tile).enumerate() {
        // A quarter of a panel for each panel.
        if let Some(next) = next.get(at / 4) {
            lanes.fetch_near(&next.0[at % 4 * 2]);
            lanes.fetch_near(&next.0[at % 4 * 2 + 1]);
        }
        let y: [L::Wide; N] = std::array::from_fn(|at| lanes.wide(&y.0[j + at]));
        for (at, sum) in sum.iter_mut().enumerate() {
            let x = lanes.wide(&x.0[i + at]);
            for (sum, &y) in sum.iter_mut().zip(&y) {
                *sum = lanes.wide_add_mul(*sum, x, y);
            }
        }
    }
    for (at, sum) in sum.iter().enumerate() {
        let total = &mut total[(i + at) * WIDTH + j..][..N];
        for (total, &sum) in total.iter_mut().zip(sum) {
            let [low, high] = lanes.widen(sum);
            *total = lanes.row(lanes.add(lanes.load(total), lanes.add(low, high)));
        }
    }
}

/// Panels that are read from one block after the other: as much as the hardware fetches ahead.
const PAGE: usize = 8;

/// `w −= Σ Vᵢ Cᵢ` over the blocks of a basis, for C so small that single precision is enough for the sum, and
/// `w −= U M` if such a pair is given.
///
/// It goes from the end to the beginning, for the end of the basis is what the cache has of it after [`PanelDots`].
pub(super) struct PanelUpdate<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub factors: &'a [Single],
    pub w: &'a mut [Row],
    /// U and M.
    pub less: Option<(&'a [Row], &'a Square)>,
    /// Of one [`STRETCH`] or several.
    pub rows: Range<usize>,
}

/// Eight by eight numbers in single precision, by rows.
pub(super) type Single = [[f32; WIDTH]; WIDTH];

impl Kernel for PanelUpdate<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, w, less, rows } = self;
        let less = less.map(|(u, factor)| (u, factor.each_ref().map(|row| lanes.load(row))));
        let mut sums = [Panel::default(); PAGE];
        let start = rows.start / ROWS;
        for (at, w) in w[rows].chunks_mut(PAGE * ROWS).enumerate().rev() {
            let first = start + at * PAGE;
            let range = first..first + panels(w.len());
            let sums = &mut sums[..range.len()];
            sums.fill(Panel::default());
            // Two blocks at a time, so that sums are loaded and stored half as often.
            for number in (0..basis.len()).step_by(2) {
                let next = |number| after(basis, number, &range, first.checked_sub(PAGE));
                let one = &basis[number][range.clone()];
                if let Some(other) = basis.get(number + 1) {
                    let factors = [&factors[number], &factors[number + 1]];
                    let blocks = [one, &other[range.clone()]];
                    subtotal(lanes, blocks, [next(number + 1), next(number + 2)], factors, sums);
                } else {
                    subtotal(lanes, [one], [next(number)], [&factors[number]], sums);
                }
            }
            for ((group, w), sums) in range.zip(w.chunks_mut(ROWS)).zip(sums.iter()) {
                let changes = lanes.rows(std::array::from_fn(|column| lanes.wide(&sums.0[column])));
                for (w, change) in w.iter_mut().zip(changes) {
                    *w = lanes.row(lanes.sub(lanes.load(w), change));
                }
                if let Some((u, factor)) = &less {
                    for (w, u) in w.iter_mut().zip(&u[group * ROWS..]) {
                        *w = lanes.row(block::less(lanes, lanes.load(w), u, factor));
                    }
                }
            }
        }
    }
}

/// Adds the products of the panels of some blocks with their factors to as many panels, and has fetched what comes
/// next.
#[inline(always)]
fn subtotal<L: Lanes, const B: usize>(
    lanes: L,
    blocks: [&[Panel]; B],
    next: [&[Panel]; B],
    factors: [&Single; B],
    sums: &mut [Panel],
) {
    let mut at = 0;
    if L::MANY {
        while at + 2 <= sums.len() {
            for next in &next {
                for next in next.iter().skip(at).take(2) {
                    for column in &next.0 {
                        lanes.fetch(column);
                    }
                }
            }
            update::<L, B, 2, WIDTH>(lanes, blocks, factors, sums, (at, 0));
            at += 2;
        }
        if at < sums.len() {
            update::<L, B, 1, WIDTH>(lanes, blocks, factors, sums, (at, 0));
        }
    } else {
        while at < sums.len() {
            for j in (0..WIDTH).step_by(2) {
                update::<L, B, 1, 2>(lanes, blocks, factors, sums, (at, j));
            }
            at += 1;
        }
    }
}

/// Adds the products of `P` panels of some blocks, from `at` on, with the `N` columns of their factors from `j` on.
#[inline(always)]
fn update<L: Lanes, const B: usize, const P: usize, const N: usize>(
    lanes: L,
    blocks: [&[Panel]; B],
    factors: [&Single; B],
    to: &mut [Panel],
    (at, j): (usize, usize),
) {
    let Some(to) = to[at..].first_chunk_mut::<P>() else { return };
    let mut sum: [[L::Wide; N]; P] =
        std::array::from_fn(|panel| std::array::from_fn(|at| lanes.wide(&to[panel].0[j + at])));
    for (block, factor) in blocks.iter().zip(factors) {
        let Some(block) = block[at..].first_chunk::<P>() else { return };
        for (k, factor) in factor.iter().enumerate() {
            let x: [L::Wide; P] = std::array::from_fn(|at| lanes.wide(&block[at].0[k]));
            for (at, &factor) in factor[j..j + N].iter().enumerate() {
                let factor = lanes.wide_splat(factor);
                for (sum, &x) in sum.iter_mut().zip(&x) {
                    sum[at] = lanes.wide_add_mul(sum[at], x, factor);
                }
            }
        }
    }
    for (to, sum) in to.iter_mut().zip(sum) {
        for (to, sum) in to.0[j..j + N].iter_mut().zip(sum) {
            *to = lanes.wide_row(sum);
        }
    }
}

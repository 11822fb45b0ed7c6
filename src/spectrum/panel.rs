//! Blocks of eight vectors in single precision, for orthogonalisation against many of them.
//!
//! That work is bounded by the memory's bandwidth, so halving the numbers halves its time. Sixteen entries of one
//! vector lie together, so that both kernels below multiply whole registers without moving their lanes.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::{
    block::{self, Square},
    lanes::{Kernel, Lanes, Row, WIDTH},
    pencil::Product,
};

/// Rows in a panel.
pub(super) const ROWS: usize = 16;

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
fn read<L: Lanes>(lanes: L, rows: &[Row]) -> [L::Wide; WIDTH] {
    match rows.as_array::<ROWS>() {
        Some(rows) => lanes.columns(rows),
        None => lanes.columns(&std::array::from_fn(|at| rows.get(at).copied().unwrap_or_default())),
    }
}

/// `q = x M` and `x = b = y M` for a block x and y = Bx, where M makes x orthonormal; both results are rounded to
/// single precision as well, for the basis, if there is room for them.
pub(super) struct Normalise<'a> {
    pub x: &'a mut [Row],
    pub y: &'a [Row],
    pub factor: &'a Square,
    pub q: &'a mut [Row],
    pub b: &'a mut [Row],
    pub single: [&'a mut [Panel]; 2],
}

impl Kernel for Normalise<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { x, y, factor, q, b, single: [first, second] } = self;
        let factor: [L::Reg; WIDTH] = std::array::from_fn(|at| lanes.load(&factor[at]));
        let combine = |row: &Row| {
            let mut sum = lanes.zero();
            for (&factor, &value) in factor.iter().zip(row) {
                sum = lanes.add_mul(sum, lanes.splat(value), factor);
            }
            lanes.row(sum)
        };
        let groups = x.chunks_mut(ROWS).zip(y.chunks(ROWS)).zip(q.chunks_mut(ROWS).zip(b.chunks_mut(ROWS)));
        for (at, ((x, y), (q, b))) in groups.enumerate() {
            for (q, x) in q.iter_mut().zip(x.iter()) {
                *q = combine(x);
            }
            for ((b, y), x) in b.iter_mut().zip(y).zip(x) {
                *b = combine(y);
                *x = *b;
            }
            for (to, rows) in [(first.get_mut(at), q), (second.get_mut(at), b)] {
                if let Some(to) = to {
                    to.0 = read(lanes, rows).map(|column| lanes.wide_row(column));
                }
            }
        }
    }
}

/// Panels of both factors that stay in the first cache.
const TILE: usize = 16;

/// Sets the i-th square to `Vᵢᵀ B w` for every block of a basis, or to `Vᵢᵀ (B w − U M)` if such a pair is given.
///
/// Products are summed in single precision over the rows of a tile, and in double precision over the tiles.
pub(super) struct PanelDots<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub mass: &'a Product,
    pub w: &'a [Row],
    /// U and M.
    pub less: Option<(&'a [Row], &'a Square)>,
    /// 64 rows for each block.
    pub room: &'a mut Vec<Row>,
    pub sums: &'a mut Vec<Square>,
}

impl Kernel for PanelDots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, mass, w, less, room, sums } = self;
        let pair = less.map(|(u, factor)| (u, factor.each_ref().map(|row| lanes.load(row))));
        room.clear();
        room.resize(basis.len() * WIDTH * WIDTH, [0.0; WIDTH]);
        let mut tile = [Panel::default(); TILE];
        let mut group = [[0.0; WIDTH]; ROWS];
        for at in 0..w.len().div_ceil(TILE * ROWS) {
            let rows = at * TILE * ROWS..w.len().min((at + 1) * TILE * ROWS);
            let used = panels(rows.len());
            let tile = &mut tile[..used];
            for (panel, first) in tile.iter_mut().zip(rows.step_by(ROWS)) {
                let group = &mut group[..ROWS.min(w.len() - first)];
                for (to, row) in group.iter_mut().zip(first..) {
                    let mut sum = mass.row(lanes, w, row);
                    if let Some((u, factor)) = &pair {
                        sum = block::less(lanes, sum, &u[row], factor);
                    }
                    *to = lanes.row(sum);
                }
                panel.0 = read(lanes, group).map(|column| lanes.wide_row(column));
            }
            let range = at * TILE..at * TILE + used;
            for (block, total) in basis.iter().zip(room.chunks_mut(WIDTH * WIDTH)) {
                let block = &block[range.clone()];
                if L::MANY {
                    // The block comes from afar, and all of a panel at once, one line after the other.
                    for j in (0..WIDTH).step_by(2) {
                        dots::<L, WIDTH, 2>(lanes, block, tile, (0, j), total);
                    }
                } else {
                    for i in (0..WIDTH).step_by(2) {
                        for j in (0..WIDTH).step_by(2) {
                            dots::<L, 2, 2>(lanes, block, tile, (i, j), total);
                        }
                    }
                }
            }
        }
        sums.clear();
        sums.extend(room.chunks(WIDTH * WIDTH).map(|total| -> Square {
            std::array::from_fn(|i| std::array::from_fn(|j| total[i * WIDTH + j].iter().sum()))
        }));
    }
}

/// Adds the products of `M` vectors of a block with `N` of the tile, as eight partial sums each.
#[inline(always)]
fn dots<L: Lanes, const M: usize, const N: usize>(
    lanes: L,
    block: &[Panel],
    tile: &[Panel],
    (i, j): (usize, usize),
    total: &mut [Row],
) {
    let mut sum = [[lanes.wide_splat(0.0); N]; M];
    for (x, y) in block.iter().zip(tile) {
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
    pub factors: &'a [[[f32; WIDTH]; WIDTH]],
    pub w: &'a mut [Row],
    /// U and M.
    pub less: Option<(&'a [Row], &'a Square)>,
}

impl Kernel for PanelUpdate<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, w, less } = self;
        let pair = less.map(|(u, factor)| (u, factor.each_ref().map(|row| lanes.load(row))));
        let mut sums = [Panel::default(); PAGE];
        for (at, w) in w.chunks_mut(PAGE * ROWS).enumerate().rev() {
            let first = at * PAGE;
            let sums = &mut sums[..panels(w.len())];
            sums.fill(Panel::default());
            for (block, factor) in basis.iter().zip(factors) {
                let block = &block[first..first + sums.len()];
                if L::MANY {
                    let (pairs, rest) = block.as_chunks::<2>();
                    let (to, last) = sums.as_chunks_mut::<2>();
                    for (to, pair) in to.iter_mut().zip(pairs) {
                        update::<L, 2, WIDTH>(lanes, pair, factor, to, 0);
                    }
                    for (to, one) in last.iter_mut().zip(rest) {
                        update::<L, 1, WIDTH>(lanes, std::array::from_ref(one), factor, std::array::from_mut(to), 0);
                    }
                } else {
                    for (to, one) in sums.iter_mut().zip(block) {
                        for j in (0..WIDTH).step_by(2) {
                            update::<L, 1, 2>(lanes, std::array::from_ref(one), factor, std::array::from_mut(to), j);
                        }
                    }
                }
            }
            for ((group, w), sum) in (first..).zip(w.chunks_mut(ROWS)).zip(sums) {
                let change = lanes.rows(std::array::from_fn(|at| lanes.wide(&sum.0[at])));
                for ((row, w), change) in (group * ROWS..).zip(w).zip(change) {
                    let mut left = lanes.sub(lanes.load(w), change);
                    if let Some((u, factor)) = &pair {
                        left = block::less(lanes, left, &u[row], factor);
                    }
                    *w = lanes.row(left);
                }
            }
        }
    }
}

/// Adds the products of `P` panels of a block with the `N` columns of its factor from `j` on.
#[inline(always)]
fn update<L: Lanes, const P: usize, const N: usize>(
    lanes: L,
    block: &[Panel; P],
    factor: &[[f32; WIDTH]; WIDTH],
    to: &mut [Panel; P],
    j: usize,
) {
    let mut sum: [[L::Wide; N]; P] =
        std::array::from_fn(|panel| std::array::from_fn(|at| lanes.wide(&to[panel].0[j + at])));
    for (k, factor) in factor.iter().enumerate() {
        let x: [L::Wide; P] = std::array::from_fn(|at| lanes.wide(&block[at].0[k]));
        for (at, &factor) in factor[j..j + N].iter().enumerate() {
            let factor = lanes.wide_splat(factor);
            for (sum, &x) in sum.iter_mut().zip(&x) {
                sum[at] = lanes.wide_add_mul(sum[at], x, factor);
            }
        }
    }
    for (to, sum) in to.iter_mut().zip(sum) {
        for (to, sum) in to.0[j..j + N].iter_mut().zip(sum) {
            *to = lanes.wide_row(sum);
        }
    }
}

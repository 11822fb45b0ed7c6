//! Blocks of eight vectors in single precision, for orthogonalisation against many of them.
//!
//! That work is bounded by the memory's bandwidth, so halving the numbers halves its time. Sixteen entries of one
//! vector lie together, so that both kernels below multiply whole registers without moving their lanes.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::{
    block::Square,
    lanes::{Kernel, Lanes, Row, WIDTH},
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

/// Rounds a block to single precision.
pub(super) struct Round<'a> {
    pub x: &'a [Row],
    pub to: &'a mut [Panel],
}

impl Kernel for Round<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        for (to, x) in self.to.iter_mut().zip(self.x.chunks(ROWS)) {
            to.0 = read(lanes, x).map(|column| lanes.wide_row(column));
        }
    }
}

/// Panels of both factors that stay in the first cache.
const TILE: usize = 32;

/// Sets the i-th square to Vᵢᵀ t for every block of a basis.
///
/// Products are summed in single precision over the rows of a tile, and in double precision over the tiles.
pub(super) struct PanelDots<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub t: &'a [Row],
    /// 64 rows for each block.
    pub room: &'a mut Vec<Row>,
    pub sums: &'a mut Vec<Square>,
}

impl Kernel for PanelDots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, t, room, sums } = self;
        room.clear();
        room.resize(basis.len() * WIDTH * WIDTH, [0.0; WIDTH]);
        let mut tile = [Panel::default(); TILE];
        for (at, rows) in t.chunks(TILE * ROWS).enumerate() {
            let used = panels(rows.len());
            let tile = &mut tile[..used];
            for (panel, rows) in tile.iter_mut().zip(rows.chunks(ROWS)) {
                panel.0 = read(lanes, rows).map(|column| lanes.wide_row(column));
            }
            for (block, total) in basis.iter().zip(room.chunks_mut(WIDTH * WIDTH)) {
                let block = &block[at * TILE..at * TILE + used];
                if L::MANY {
                    for (i, j) in [(0, 0), (0, 4), (4, 0), (4, 4)] {
                        dots::<L, 4>(lanes, block, tile, (i, j), total);
                    }
                } else {
                    for i in (0..WIDTH).step_by(2) {
                        for j in (0..WIDTH).step_by(2) {
                            dots::<L, 2>(lanes, block, tile, (i, j), total);
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

/// Adds the products of `N` vectors of a block with `N` of the tile, as eight partial sums each.
#[inline(always)]
fn dots<L: Lanes, const N: usize>(
    lanes: L,
    block: &[Panel],
    tile: &[Panel],
    (i, j): (usize, usize),
    total: &mut [Row],
) {
    let mut sum = [[lanes.wide_splat(0.0); N]; N];
    for (x, y) in block.iter().zip(tile) {
        let x: [L::Wide; N] = std::array::from_fn(|at| lanes.wide(&x.0[i + at]));
        let y: [L::Wide; N] = std::array::from_fn(|at| lanes.wide(&y.0[j + at]));
        for (sum, &x) in sum.iter_mut().zip(&x) {
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

/// `w −= Σ Vᵢ Cᵢ` over the blocks of a basis, for C so small that single precision is enough for the sum.
pub(super) struct PanelUpdate<'a, 'b> {
    pub basis: &'a [&'b [Panel]],
    pub factors: &'a [[[f32; WIDTH]; WIDTH]],
    pub w: &'a mut [Row],
}

impl Kernel for PanelUpdate<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { basis, factors, w } = self;
        let mut sum = [[lanes.wide_splat(0.0); WIDTH]; 2];
        for (at, w) in w.chunks_mut(2 * ROWS).enumerate() {
            let first = 2 * at;
            if L::MANY && w.len() > ROWS {
                sum = update::<L, 2, WIDTH>(lanes, basis, factors, first, 0);
            } else {
                for (half, sum) in sum.iter_mut().enumerate().take(panels(w.len())) {
                    for j in (0..WIDTH).step_by(2) {
                        let [pair] = update::<L, 1, 2>(lanes, basis, factors, first + half, j);
                        sum[j..j + 2].copy_from_slice(&pair);
                    }
                }
            }
            for (w, sum) in w.chunks_mut(ROWS).zip(sum) {
                let change = lanes.rows(sum);
                for (w, change) in w.iter_mut().zip(change) {
                    *w = lanes.row(lanes.sub(lanes.load(w), change));
                }
            }
        }
    }
}

/// The sums for `P` panels from `first` on and the `N` vectors from `j` on.
#[inline(always)]
fn update<L: Lanes, const P: usize, const N: usize>(
    lanes: L,
    basis: &[&[Panel]],
    factors: &[[[f32; WIDTH]; WIDTH]],
    first: usize,
    j: usize,
) -> [[L::Wide; N]; P] {
    let mut sum = [[lanes.wide_splat(0.0); N]; P];
    for (block, factor) in basis.iter().zip(factors) {
        let block = &block[first..first + P];
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
    sum
}

//! The dense part of the factorisation: the pivots of one front.
//!
//! A front is a square of numbers by columns, of which the lower triangle counts. Its size is rounded up to eight,
//! the extra rows and columns being zero.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::ops::Range;

use crate::spectrum::{
    lanes::{Kernel, Lanes, Row, WIDTH, dispatch},
    poll::{Poll, Stop},
};

/// A front, its size (a multiple of eight) and how many of its columns are eliminated.
///
/// What remains is the unit lower trapezoid of L in the first `width` columns, the pivots in `pivots`, and the update
/// matrix in the other columns.
///
/// L − σB is indefinite, and without a choice of pivots the factors of a 10 000-vertex mesh grow by 10⁶. Pivots are
/// therefore taken from the diagonal of the front's own columns, a large one first (as in LAPACK's `pstrf`), which
/// leaves the structure of the factor as it is.
#[derive(Debug)]
pub(super) struct Front<'a> {
    pub values: &'a mut [f64],
    /// As large as the pivot columns of the front: D Lᵀ.
    pub scaled: &'a mut [f64],
    pub size: usize,
    pub width: usize,
    pub pivots: &'a mut [f64],
    /// For each pivot the column that it was.
    pub order: &'a mut [u32],
}

/// A pivot is taken where it stands unless another one is so many times larger.
const MUCH_LARGER: f64 = 4.0;

/// Multiplications of a front that are not worth a look at the watch in between.
const SMALL: usize = 1 << 18;

impl Front<'_> {
    /// Eliminates.
    ///
    /// # Errors
    /// When cancelled.
    pub(super) fn eliminate(&mut self, poll: &mut Poll) -> Result<(), Stop> {
        let (size, width) = (self.size, self.width);
        for at in 0..width {
            self.pivots[at] = self.values[at * size + at];
            self.order[at] = at as u32;
        }
        if size * size * width <= SMALL {
            dispatch(Whole { front: self });
            return poll.spend(size * size * width);
        }
        for done in (0..width).step_by(WIDTH) {
            dispatch(Pivots { front: self, done });
            poll.spend(WIDTH * size * (width - done))?;
        }
        dispatch(Beside { front: self });
        for next in (width.next_multiple_of(WIDTH)..size).step_by(WIDTH) {
            dispatch(Others { front: self, next });
            poll.spend(WIDTH * width * (size - next))?;
        }
        Ok(())
    }
}

/// Writes zeros to the lower triangle of a front, by blocks of eight rows, as it is worked on.
pub(super) struct Clear<'a> {
    pub values: &'a mut [f64],
    pub size: usize,
}

impl Kernel for Clear<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        for (column, values) in self.values.chunks_exact_mut(self.size).enumerate() {
            let rows: &mut [Row] = values.as_chunks_mut().0;
            for row in &mut rows[column / WIDTH..] {
                *row = lanes.row(lanes.zero());
            }
        }
    }
}

/// All of it.
struct Whole<'a, 'f> {
    front: &'a mut Front<'f>,
}

impl Kernel for Whole<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let (size, width) = (self.front.size, self.front.width);
        for done in (0..width).step_by(WIDTH) {
            Pivots { front: &mut *self.front, done }.run(lanes);
        }
        Beside { front: &mut *self.front }.run(lanes);
        for next in (width.next_multiple_of(WIDTH)..size).step_by(WIDTH) {
            Others { front: &mut *self.front, next }.run(lanes);
        }
    }
}

/// The pivots from `done` on, eight or what is left, and their share in the pivot columns after them.
struct Pivots<'a, 'f> {
    front: &'a mut Front<'f>,
    done: usize,
}

impl Kernel for Pivots<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let done = self.done;
        let Front { values, scaled, size, width, pivots, order } = self.front;
        let (size, width) = (*size, *width);
        let end = (done + WIDTH).min(width);
        for pivot in done..end {
            let most = largest(&pivots[pivot..width]);
            // Mostly it is not, so that where the largest one is need not be known.
            if most > MUCH_LARGER * pivots[pivot].abs() {
                let best = (pivot..width).find(|&at| pivots[at].abs() == most).unwrap_or(pivot);
                exchange(values, scaled, size, done, pivot, best);
                pivots.swap(pivot, best);
                order.swap(pivot, best);
            }
            column(lanes, values, scaled, size, done, pivot);
            pivots[pivot] = scaled[pivot * size + pivot];
            let later = pivot * size + pivot + 1..pivot * size + width;
            let products = scaled[later.clone()].iter().zip(&values[later]);
            for (pivot, (scaled, own)) in pivots[pivot + 1..width].iter_mut().zip(products) {
                *pivot -= scaled * own;
            }
        }
        let mut next = done + WIDTH;
        while next < width {
            let (left, right) = values.split_at_mut(next * size);
            subtract(lanes, left, scaled, &mut right[..WIDTH * size], size, next, done..end);
            next += WIDTH;
        }
    }
}

/// The columns in one block of eight with the last pivots. They have the pivots of earlier blocks already.
struct Beside<'a, 'f> {
    front: &'a mut Front<'f>,
}

impl Kernel for Beside<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Front { values, scaled, size, width, .. } = self.front;
        let (size, width) = (*size, *width);
        let first = width - width % WIDTH;
        for other in width..width.next_multiple_of(WIDTH) {
            let (left, right) = values.split_at_mut(other * size);
            for pivot in first..width {
                let factor = lanes.splat(scaled[pivot * size + other]);
                let from: &[Row] = left[pivot * size + first..(pivot + 1) * size].as_chunks().0;
                let to: &mut [Row] = right[first..size].as_chunks_mut().0;
                for (to, from) in to.iter_mut().zip(from) {
                    *to = lanes.row(lanes.sub_mul(lanes.load(to), lanes.load(from), factor));
                }
            }
        }
    }
}

/// All pivots' share in the eight columns from `next` on.
struct Others<'a, 'f> {
    front: &'a mut Front<'f>,
    next: usize,
}

impl Kernel for Others<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Front { values, scaled, size, width, .. } = self.front;
        let (left, right) = values.split_at_mut(self.next * *size);
        subtract(lanes, left, scaled, &mut right[..WIDTH * *size], *size, self.next, 0..*width);
    }
}

/// The largest of some numbers, without their signs.
#[inline(always)]
pub(super) fn largest(values: &[f64]) -> f64 {
    let larger = |most: f64, value: &f64| if value.abs() > most { value.abs() } else { most };
    // In several chains, for each comparison waits for the one before it.
    let (chunks, rest) = values.as_chunks::<WIDTH>();
    let mut most = [0.0; WIDTH];
    for chunk in chunks {
        for (most, value) in most.iter_mut().zip(chunk) {
            *most = larger(*most, value);
        }
    }
    let most = if chunks.is_empty() { 0.0 } else { most.iter().fold(0.0, larger) };
    rest.iter().fold(most, larger)
}

/// Exchanges rows and columns `a < b` of a front of which the columns before `a` are eliminated, and those from `done`
/// on are not yet applied to the others.
fn exchange(front: &mut [f64], scaled: &mut [f64], size: usize, done: usize, a: usize, b: usize) {
    for column in 0..a {
        front.swap(column * size + a, column * size + b);
    }
    for column in done..a {
        scaled.swap(column * size + a, column * size + b);
    }
    front.swap(a * size + a, b * size + b);
    for between in a + 1..b {
        front.swap(a * size + between, between * size + b);
    }
    let (left, right) = front.split_at_mut(b * size);
    left[a * size + b + 1..(a + 1) * size].swap_with_slice(&mut right[b + 1..size]);
}

/// Applies the pivots from `done` on to column `pivot`, and divides it by its pivot.
#[inline(always)]
fn column<L: Lanes>(lanes: L, front: &mut [f64], scaled: &mut [f64], size: usize, done: usize, pivot: usize) {
    let first = pivot - pivot % WIDTH;
    let (left, right) = front.split_at_mut(pivot * size);
    let own: &mut [Row] = right[first..size].as_chunks_mut().0;
    for earlier in done..pivot {
        let factor = lanes.splat(scaled[earlier * size + pivot]);
        let from: &[Row] = left[earlier * size + first..(earlier + 1) * size].as_chunks().0;
        for (to, from) in own.iter_mut().zip(from) {
            *to = lanes.row(lanes.sub_mul(lanes.load(to), lanes.load(from), factor));
        }
    }
    let copy: &mut [Row] = scaled[pivot * size + first..(pivot + 1) * size].as_chunks_mut().0;
    let inverse = lanes.splat(1.0 / own[0][pivot - first]);
    for (own, copy) in own.iter_mut().zip(copy) {
        *copy = *own;
        *own = lanes.row(lanes.mul(lanes.load(own), inverse));
    }
}

/// Pivots that are applied to a tile of the front before it is written back.
const DEPTH: usize = 128;

/// Subtracts the share of some pivots in L D Lᵀ from the eight columns that start with column `first`, from row
/// `first` on.
#[inline(always)]
fn subtract<L: Lanes>(
    lanes: L,
    left: &[f64],
    scaled: &[f64],
    columns: &mut [f64],
    size: usize,
    first: usize,
    pivots: Range<usize>,
) {
    let mut start = pivots.start;
    while start < pivots.end {
        let end = (start + DEPTH).min(pivots.end);
        let mut row = first;
        if L::MANY {
            while row + 2 * WIDTH <= size {
                tile::<L, 2, 8>(lanes, left, scaled, columns, size, [row, first, 0], start..end);
                row += 2 * WIDTH;
            }
            while row < size {
                tile::<L, 1, 8>(lanes, left, scaled, columns, size, [row, first, 0], start..end);
                row += WIDTH;
            }
        } else {
            while row < size {
                tile::<L, 1, 4>(lanes, left, scaled, columns, size, [row, first, 0], start..end);
                tile::<L, 1, 4>(lanes, left, scaled, columns, size, [row, first, 4], start..end);
                row += WIDTH;
            }
        }
        start = end;
    }
}

/// `R` rows of eight times `C` columns; `place` is the first row, the first column of the eight, and which of the
/// eight comes first.
#[inline(always)]
fn tile<L: Lanes, const R: usize, const C: usize>(
    lanes: L,
    left: &[f64],
    scaled: &[f64],
    columns: &mut [f64],
    size: usize,
    place: [usize; 3],
    pivots: Range<usize>,
) {
    let [row, first, skip] = place;
    let mut sum = [[lanes.zero(); R]; C];
    for pivot in pivots {
        let rows: &[Row] = left[pivot * size + row..][..R * WIDTH].as_chunks().0;
        let factors = &scaled[pivot * size + first + skip..][..C];
        let rows: [L::Reg; R] = std::array::from_fn(|at| lanes.load(&rows[at]));
        for (sum, &factor) in sum.iter_mut().zip(factors) {
            let factor = lanes.splat(factor);
            for (sum, &row) in sum.iter_mut().zip(&rows) {
                *sum = lanes.add_mul(*sum, row, factor);
            }
        }
    }
    for (at, sum) in sum.into_iter().enumerate() {
        let target: &mut [Row] = columns[(skip + at) * size + row..][..R * WIDTH].as_chunks_mut().0;
        for (target, sum) in target.iter_mut().zip(sum) {
            *target = lanes.row(lanes.sub(lanes.load(target), sum));
        }
    }
}

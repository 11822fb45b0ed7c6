//! (L − σB) x = b for eight right-hand sides at once.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::ops::Range;

use super::{Factor, Symbolic, symbolic::Piece};
use crate::spectrum::{
    lanes::{Kernel, Lanes, Row, WIDTH, dispatch},
    poll::{Poll, Stop},
    timings::Cost,
};

/// Numbers of the factor that are read between two looks at the watch.
const CHUNK: usize = 1 << 18;

impl Factor {
    /// Overwrites the right-hand sides with the solutions. `x` has a row per row of the matrix.
    ///
    /// # Errors
    /// When cancelled.
    pub(in crate::spectrum) fn solve(&self, symbolic: &Symbolic, x: &mut [Row], poll: &mut Poll) -> Result<(), Stop> {
        let pieces = &symbolic.pieces;
        let total = symbolic.values();
        let value = |at: usize| pieces.get(at).map_or(total, |piece| piece.values);
        let mut start = 0;
        while start < pieces.len() {
            let limit = value(start) + CHUNK;
            let end = pieces.partition_point(|piece| piece.values <= limit).max(start + 1);
            dispatch(Forward { factor: self, symbolic, x, pieces: &pieces[start..end] });
            poll.spend(WIDTH * (value(end) - value(start)))?;
            start = end;
        }
        let mut end = pieces.len();
        while end > 0 {
            let limit = value(end).saturating_sub(CHUNK);
            let start = pieces.partition_point(|piece| piece.values < limit).min(end - 1);
            dispatch(Backward { factor: self, symbolic, x, pieces: &pieces[start..end] });
            poll.spend(WIDTH * (value(end) - value(start)))?;
            end = start;
        }
        poll.charge(Cost::Solves);
        Ok(())
    }

    /// The order in which the columns of a supernode became pivots, if it is not their own.
    #[inline(always)]
    fn moved(&self, symbolic: &Symbolic, piece: &Piece) -> Option<(Range<usize>, &[u32])> {
        let node = piece.node as usize;
        (piece.first && self.moved[node]).then(|| {
            let range = symbolic.begin[node] as usize..symbolic.begin[node + 1] as usize;
            (range.clone(), &self.order[range])
        })
    }
}

struct Forward<'a> {
    factor: &'a Factor,
    symbolic: &'a Symbolic,
    x: &'a mut [Row],
    pieces: &'a [Piece],
}

impl Kernel for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { factor, symbolic, x, pieces } = self;
        let all = factor.values.numbers();
        let mut room: Vec<Row> = Vec::new();
        for piece in pieces {
            if let Some((range, order)) = factor.moved(symbolic, piece) {
                let own = &mut x[range];
                room.clear();
                room.extend_from_slice(own);
                for (own, &was) in own.iter_mut().zip(order) {
                    *own = room[was as usize];
                }
            }
            let rows = &symbolic.piece_rows[piece.rows as usize..piece.end as usize];
            let values = &all[piece.values..];
            by_size(piece.width, ForwardPiece { lanes, x, begin: piece.begin as usize, rows, values });
        }
    }
}

struct Backward<'a> {
    factor: &'a Factor,
    symbolic: &'a Symbolic,
    x: &'a mut [Row],
    pieces: &'a [Piece],
}

impl Kernel for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { factor, symbolic, x, pieces } = self;
        let all = factor.values.numbers();
        let mut room: Vec<Row> = Vec::new();
        for piece in pieces.iter().rev() {
            let rows = &symbolic.piece_rows[piece.rows as usize..piece.end as usize];
            let values = &all[piece.values..];
            let (begin, inverse) = (piece.begin as usize, &factor.inverse[piece.begin as usize..]);
            by_size(piece.width, BackwardPiece { lanes, x, begin, rows, values, inverse });
            if let Some((range, order)) = factor.moved(symbolic, piece) {
                let own = &mut x[range];
                room.clear();
                room.extend_from_slice(own);
                for (room, &was) in room.iter().zip(order) {
                    own[was as usize] = *room;
                }
            }
        }
    }
}

/// Work on a piece: so many columns that the compiler knows.
///
/// Most supernodes have a few columns and a handful of rows. What their solves cost is less the arithmetic than what
/// comes before it and jumps that cannot be foretold, so that there is one jump for the number of columns, and then
/// one loop over rows.
pub(super) trait Columns {
    fn run<const W: usize>(self);
}

/// Calls the piece of the given size, 1 to 8.
#[inline(always)]
pub(super) fn by_size(size: u32, piece: impl Columns) {
    match size {
        1 => piece.run::<1>(),
        2 => piece.run::<2>(),
        3 => piece.run::<3>(),
        4 => piece.run::<4>(),
        5 => piece.run::<5>(),
        6 => piece.run::<6>(),
        7 => piece.run::<7>(),
        _ => piece.run::<8>(),
    }
}

struct ForwardPiece<'a, L> {
    lanes: L,
    x: &'a mut [Row],
    begin: usize,
    rows: &'a [u32],
    values: &'a [f64],
}

impl<L: Lanes> Columns for ForwardPiece<'_, L> {
    #[inline(always)]
    fn run<const W: usize>(self) {
        let Self { lanes, x, begin, rows, values } = self;
        let (triangle, values) = values.split_at(W * (W - 1) / 2);
        let own = &mut x[begin..begin + W];
        let mut solved = [lanes.zero(); W];
        for (solved, row) in solved.iter_mut().zip(&*own) {
            *solved = lanes.load(row);
        }
        for row in 1..W {
            for column in 0..row {
                let entry = lanes.splat(triangle[row * (row - 1) / 2 + column]);
                solved[row] = lanes.sub_mul(solved[row], entry, solved[column]);
            }
        }
        for (row, solved) in own.iter_mut().zip(solved) {
            *row = lanes.row(solved);
        }
        let (fours, rest) = rows.as_chunks::<UNROLLED>();
        let (values, values_rest) = values.as_chunks::<W>().0[..rows.len()].as_chunks::<UNROLLED>();
        for (rows, entries) in fours.iter().zip(values) {
            for (&row, entries) in rows.iter().zip(entries) {
                less(lanes, &mut x[row as usize], entries, &solved);
            }
        }
        for (&row, entries) in rest.iter().zip(values_rest) {
            less(lanes, &mut x[row as usize], entries, &solved);
        }
    }
}

/// Rows that are taken without a jump between them: there are often just more than so many.
const UNROLLED: usize = 4;

/// Columns of a piece from which on there is no waiting for additions to one of the sums.
const FEW: usize = 5;

/// What is left of a row when the columns of a piece are solved.
#[inline(always)]
fn less<L: Lanes, const W: usize>(lanes: L, row: &mut Row, entries: &[f64; W], solved: &[L::Reg; W]) {
    let mut left = lanes.load(row);
    for (&entry, &solved) in entries.iter().zip(solved) {
        left = lanes.sub_mul(left, lanes.splat(entry), solved);
    }
    *row = lanes.row(left);
}

struct BackwardPiece<'a, L> {
    lanes: L,
    x: &'a mut [Row],
    begin: usize,
    rows: &'a [u32],
    values: &'a [f64],
    inverse: &'a [f64],
}

impl<L: Lanes> Columns for BackwardPiece<'_, L> {
    #[inline(always)]
    fn run<const W: usize>(self) {
        let Self { lanes, x, begin, rows, values, inverse } = self;
        let (triangle, values) = values.split_at(W * (W - 1) / 2);
        let own = &x[begin..begin + W];
        let mut sum = [lanes.zero(); W];
        for (sum, (row, &inverse)) in sum.iter_mut().zip(own.iter().zip(&inverse[..W])) {
            *sum = lanes.mul(lanes.load(row), lanes.splat(inverse));
        }
        // From the last row on, for the first ones are what was solved last. Where there are few sums, rows are added
        // to two sets of them by turns, for additions to one wait for each other.
        let mut other = [lanes.zero(); W];
        let (rest, fours) = rows.as_rchunks::<UNROLLED>();
        let (values_rest, values) = values.as_chunks::<W>().0[..rows.len()].as_rchunks::<UNROLLED>();
        for (rows, entries) in fours.iter().zip(values).rev() {
            for (at, (&row, entries)) in rows.iter().zip(entries).enumerate().rev() {
                let sum = if W < FEW && at % 2 == 0 { &mut other } else { &mut sum };
                left(lanes, sum, entries, &x[row as usize]);
            }
        }
        for (&row, entries) in rest.iter().zip(values_rest).rev() {
            left(lanes, &mut sum, entries, &x[row as usize]);
        }
        if W < FEW {
            for (sum, other) in sum.iter_mut().zip(other) {
                *sum = lanes.add(*sum, other);
            }
        }
        for row in (1..W).rev() {
            for column in 0..row {
                let entry = lanes.splat(triangle[row * (row - 1) / 2 + column]);
                sum[column] = lanes.sub_mul(sum[column], entry, sum[row]);
            }
        }
        for (row, sum) in x[begin..begin + W].iter_mut().zip(sum) {
            *row = lanes.row(sum);
        }
    }
}

/// What is left of the columns of a piece when a row is solved.
#[inline(always)]
fn left<L: Lanes, const W: usize>(lanes: L, sum: &mut [L::Reg; W], entries: &[f64; W], row: &Row) {
    let row = lanes.load(row);
    for (sum, &entry) in sum.iter_mut().zip(entries) {
        *sum = lanes.sub_mul(*sum, lanes.splat(entry), row);
    }
}

//! (L − σB) x = b for eight right-hand sides at once.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use std::ops::Range;

use super::{Factor, Symbolic};
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
        let nodes = symbolic.len();
        let mut start = 0;
        while start < nodes {
            let limit = symbolic.value_start[start] + CHUNK;
            let end = symbolic.value_start.partition_point(|&at| at <= limit).clamp(start + 1, nodes);
            dispatch(Forward { factor: self, symbolic, x, nodes: start..end });
            poll.spend(WIDTH * (symbolic.value_start[end] - symbolic.value_start[start]))?;
            start = end;
        }
        let mut end = nodes;
        while end > 0 {
            let limit = symbolic.value_start[end].saturating_sub(CHUNK);
            let start = symbolic.value_start.partition_point(|&at| at < limit).min(end - 1);
            dispatch(Backward { factor: self, symbolic, x, nodes: start..end });
            poll.spend(WIDTH * (symbolic.value_start[end] - symbolic.value_start[start]))?;
            end = start;
        }
        poll.charge(Cost::Solves);
        Ok(())
    }
}

struct Forward<'a> {
    factor: &'a Factor,
    symbolic: &'a Symbolic,
    x: &'a mut [Row],
    nodes: Range<usize>,
}

impl Kernel for Forward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { factor, symbolic, x, nodes } = self;
        let mut room = Vec::new();
        for node in nodes {
            let (begin, width, rows) = symbolic.node(node);
            let (above, below) = x.split_at_mut(begin + width);
            let own = &mut above[begin..];
            if factor.moved[node] {
                room.clear();
                room.extend_from_slice(own);
                for (own, &was) in own.iter_mut().zip(&factor.order[begin..begin + width]) {
                    *own = room[was as usize];
                }
            }
            let mut values = &factor.values[symbolic.value_start[node]..symbolic.value_start[node + 1]];
            for first in (0..width).step_by(WIDTH) {
                values = by_size(WIDTH.min(width - first), ForwardDiagonal { lanes, own, first, values });
            }
            for rows in rows.chunks(WIDTH) {
                let shift = begin + width;
                values = by_size(rows.len(), ForwardBelow { lanes, own, below, rows, shift, values });
            }
        }
    }
}

struct Backward<'a> {
    factor: &'a Factor,
    symbolic: &'a Symbolic,
    x: &'a mut [Row],
    nodes: Range<usize>,
}

impl Kernel for Backward<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) {
        let Self { factor, symbolic, x, nodes } = self;
        let mut room: Vec<Row> = Vec::new();
        for node in nodes.rev() {
            let (begin, width, rows) = symbolic.node(node);
            let (above, below) = x.split_at_mut(begin + width);
            let own = &mut above[begin..];
            for (row, &inverse) in own.iter_mut().zip(&factor.inverse[begin..begin + width]) {
                *row = lanes.row(lanes.mul(lanes.load(row), lanes.splat(inverse)));
            }
            let all = &factor.values[symbolic.value_start[node]..symbolic.value_start[node + 1]];
            let (mut diagonal, mut values) = all.split_at(width * (width - 1) / 2);
            for rows in rows.chunks(WIDTH) {
                let shift = begin + width;
                values = by_size(rows.len(), BackwardBelow { lanes, own, below, rows, shift, values });
            }
            for first in (0..width).step_by(WIDTH).rev() {
                let count = WIDTH.min(width - first);
                let (rest, values) = diagonal.split_at(diagonal.len() - count * first - count * (count - 1) / 2);
                diagonal = rest;
                by_size(count, BackwardDiagonal { lanes, own, first, values });
            }
            if factor.moved[node] {
                room.clear();
                room.extend_from_slice(own);
                for (room, &was) in room.iter().zip(&factor.order[begin..begin + width]) {
                    own[was as usize] = *room;
                }
            }
        }
    }
}

/// Work on a group of rows whose number is known to the compiler.
trait Group<'a> {
    fn run<const R: usize>(self) -> &'a [f64];
}

/// Calls the group of the given size, 1 to 8; returns the values that it has not used.
#[inline(always)]
fn by_size<'a, G: Group<'a>>(size: usize, group: G) -> &'a [f64] {
    match size {
        1 => group.run::<1>(),
        2 => group.run::<2>(),
        3 => group.run::<3>(),
        4 => group.run::<4>(),
        5 => group.run::<5>(),
        6 => group.run::<6>(),
        7 => group.run::<7>(),
        _ => group.run::<8>(),
    }
}

/// Σ over the columns of the group's entries times the solved rows.
#[inline(always)]
fn gather<L: Lanes, const R: usize>(lanes: L, own: &[Row], values: &[[f64; R]]) -> [L::Reg; R] {
    let mut sum = [lanes.zero(); R];
    for (x, entries) in own.iter().zip(values) {
        let x = lanes.load(x);
        for (sum, &entry) in sum.iter_mut().zip(entries) {
            *sum = lanes.add_mul(*sum, lanes.splat(entry), x);
        }
    }
    sum
}

/// Subtracts from each of the rows the group's entries of that column times the solved group.
#[inline(always)]
fn spread<L: Lanes, const R: usize>(lanes: L, own: &mut [Row], values: &[[f64; R]], solved: [L::Reg; R]) {
    for (x, entries) in own.iter_mut().zip(values) {
        // Two chains hide the latency of half of the multiplications.
        let mut even = lanes.load(x);
        let mut odd = lanes.zero();
        for (at, (&solved, &entry)) in solved.iter().zip(entries).enumerate() {
            if at % 2 == 0 {
                even = lanes.sub_mul(even, lanes.splat(entry), solved);
            } else {
                odd = lanes.add_mul(odd, lanes.splat(entry), solved);
            }
        }
        *x = lanes.row(if R > 1 { lanes.sub(even, odd) } else { even });
    }
}

struct ForwardDiagonal<'a, 'x, L> {
    lanes: L,
    own: &'x mut [Row],
    first: usize,
    values: &'a [f64],
}

impl<'a, L: Lanes> Group<'a> for ForwardDiagonal<'a, '_, L> {
    #[inline(always)]
    fn run<const R: usize>(self) -> &'a [f64] {
        let Self { lanes, own, first, values } = self;
        let (block, rest) = values.split_at(first * R);
        let (triangle, rest) = rest.split_at(R * (R - 1) / 2);
        let (solved, group) = own.split_at_mut(first);
        let sum = gather::<L, R>(lanes, solved, block.as_chunks().0);
        let mut x: [L::Reg; R] = std::array::from_fn(|at| lanes.sub(lanes.load(&group[at]), sum[at]));
        for row in 1..R {
            for column in 0..row {
                x[row] = lanes.sub_mul(x[row], lanes.splat(triangle[row * (row - 1) / 2 + column]), x[column]);
            }
        }
        for (row, x) in group.iter_mut().zip(x) {
            *row = lanes.row(x);
        }
        rest
    }
}

struct BackwardDiagonal<'a, 'x, L> {
    lanes: L,
    own: &'x mut [Row],
    first: usize,
    values: &'a [f64],
}

impl<'a, L: Lanes> Group<'a> for BackwardDiagonal<'a, '_, L> {
    #[inline(always)]
    fn run<const R: usize>(self) -> &'a [f64] {
        let Self { lanes, own, first, values } = self;
        let (block, rest) = values.split_at(first * R);
        let (triangle, rest) = rest.split_at(R * (R - 1) / 2);
        let (earlier, group) = own.split_at_mut(first);
        let mut x: [L::Reg; R] = std::array::from_fn(|at| lanes.load(&group[at]));
        for row in (1..R).rev() {
            for column in 0..row {
                x[column] = lanes.sub_mul(x[column], lanes.splat(triangle[row * (row - 1) / 2 + column]), x[row]);
            }
        }
        for (row, x) in group.iter_mut().zip(x) {
            *row = lanes.row(x);
        }
        spread::<L, R>(lanes, earlier, block.as_chunks().0, x);
        rest
    }
}

struct ForwardBelow<'a, 'x, L> {
    lanes: L,
    own: &'x [Row],
    below: &'x mut [Row],
    rows: &'x [u32],
    shift: usize,
    values: &'a [f64],
}

impl<'a, L: Lanes> Group<'a> for ForwardBelow<'a, '_, L> {
    #[inline(always)]
    fn run<const R: usize>(self) -> &'a [f64] {
        let Self { lanes, own, below, rows, shift, values } = self;
        let (block, rest) = values.split_at(own.len() * R);
        let sum = gather::<L, R>(lanes, own, block.as_chunks().0);
        for (&row, sum) in rows.iter().zip(sum) {
            let row = &mut below[row as usize - shift];
            *row = lanes.row(lanes.sub(lanes.load(row), sum));
        }
        rest
    }
}

struct BackwardBelow<'a, 'x, L> {
    lanes: L,
    own: &'x mut [Row],
    below: &'x [Row],
    rows: &'x [u32],
    shift: usize,
    values: &'a [f64],
}

impl<'a, L: Lanes> Group<'a> for BackwardBelow<'a, '_, L> {
    #[inline(always)]
    fn run<const R: usize>(self) -> &'a [f64] {
        let Self { lanes, own, below, rows, shift, values } = self;
        let (block, rest) = values.split_at(own.len() * R);
        let x: [L::Reg; R] = std::array::from_fn(|at| lanes.load(&below[rows[at] as usize - shift]));
        spread::<L, R>(lanes, own, block.as_chunks().0, x);
        rest
    }
}

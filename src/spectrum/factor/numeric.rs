//! The factorisation for one shift.

use super::{
    Symbolic,
    front::{Clear, Front, largest},
    solve::{Columns, by_size},
};
use crate::{
    laplacian::{MassMatrix, Symmetric},
    spectrum::{
        lanes::{Buffer, WIDTH, dispatch},
        poll::{Poll, Stop},
        timings::Cost,
    },
};

/// The largest entry that M may have: errors of the counts and solves grow with it.
const GROWTH: f64 = 1e5;

/// L − σB = M D Mᵀ with a unit lower triangular M, and room to do it again for another shift.
#[derive(Debug, Default)]
pub(in crate::spectrum) struct Factor {
    /// M, packed for the solves: see [`pack`].
    pub(super) values: Buffer,
    /// 1 / D.
    pub(super) inverse: Vec<f64>,
    /// The columns of each supernode in the order in which they became pivots, counted from its first one.
    pub(super) order: Vec<u32>,
    /// Whether that differs from their own order, for each supernode.
    pub(super) moved: Vec<bool>,
    /// The largest entry of M: by how much rounding was amplified.
    pub(super) growth: f64,
    front: Buffer,
    scaled: Buffer,
    /// Update matrices that wait for their parents.
    stack: Buffer,
}

impl Factor {
    /// Factors L − σB and returns how many entries of D are negative: by Sylvester's law of inertia the number of
    /// eigenvalues below σ.
    ///
    /// # Errors
    /// When cancelled, or when a pivot is zero or not finite, so that the shift has to move.
    pub(in crate::spectrum) fn compute(
        &mut self,
        symbolic: &Symbolic,
        matrix: &Symmetric,
        sigma: f64,
        poll: &mut Poll,
    ) -> Result<usize, Stop> {
        let size = symbolic.front.next_multiple_of(WIDTH);
        self.values.reserve(symbolic.values());
        self.inverse.resize(matrix.order(), 0.0);
        self.order.resize(matrix.order(), 0);
        self.moved.resize(symbolic.len(), false);
        self.growth = 1.0;
        self.front.reserve(size * size);
        self.scaled.reserve(size * size);
        self.stack.reserve(symbolic.stack);
        let mut height = 0;
        let mut negative = 0;
        for at in 0..symbolic.len() {
            let (begin, width, rows) = symbolic.node(at);
            let used = width + rows.len();
            let size = used.next_multiple_of(WIDTH);
            poll.spend(used * used)?;
            let front = &mut self.front.flat()[..size * size];
            dispatch(Clear { values: front, size });
            entries(symbolic, matrix, sigma, begin..begin + width, size, front);
            for child in children(symbolic, at) {
                height = self.absorb(symbolic, child, size, height);
            }
            let pivots = &mut self.inverse[begin..begin + width];
            let order = &mut self.order[begin..begin + width];
            let values = &mut self.front.flat()[..size * size];
            let scaled = self.scaled.flat();
            Front { values, scaled, size, width, pivots: &mut *pivots, order: &mut *order }.eliminate(poll)?;
            self.moved[at] = order.iter().enumerate().any(|(at, &was)| at as u32 != was);
            for pivot in pivots {
                if !pivot.is_normal() {
                    return Err(Stop::Pivot);
                }
                negative += usize::from(*pivot < 0.0);
                *pivot = 1.0 / *pivot;
            }
            let front = &self.front.flat()[..size * size];
            let values = &mut self.values.flat()[symbolic.value_start[at]..symbolic.value_start[at + 1]];
            pack(front, size, width, rows.len(), values);
            self.growth = largest(values).max(self.growth);
            let update = &front[width * size..used * size];
            self.stack.flat()[height..height + update.len()].copy_from_slice(update);
            height += update.len();
        }
        poll.charge(Cost::Factorisation);
        Ok(negative)
    }

    /// Whether rounding left enough of the matrix: the entries of M amplify it.
    pub(in crate::spectrum) fn is_sound(&self) -> bool {
        self.growth < GROWTH
    }

    /// Adds the update matrix of the last child on the stack, which is so high, to the front. Returns how high it is
    /// without that.
    fn absorb(&mut self, symbolic: &Symbolic, child: usize, size: usize, height: usize) -> usize {
        let relative = &symbolic.relative[symbolic.row_start[child]..symbolic.row_start[child + 1]];
        let (_, width, _) = symbolic.node(child);
        let from = (width + relative.len()).next_multiple_of(WIDTH);
        let start = height - relative.len() * from;
        let (front, updates) = (self.front.flat(), &self.stack.numbers()[start..height]);
        for (at, (&column, values)) in relative.iter().zip(updates.chunks_exact(from)).enumerate() {
            let values = &values[width + at..];
            let target = &mut front[column as usize * size..(column as usize + 1) * size];
            let rows = &relative[at..];
            let last = column as usize + rows.len();
            if rows.last().is_some_and(|&row| row as usize + 1 == last) {
                // They follow each other.
                for (target, &value) in target[column as usize..last].iter_mut().zip(values) {
                    *target += value;
                }
                continue;
            }
            for (&row, &value) in rows.iter().zip(values) {
                target[row as usize] += value;
            }
        }
        start
    }
}

/// The children of a supernode, the last one on the stack first.
fn children(symbolic: &Symbolic, at: usize) -> impl Iterator<Item = usize> + '_ {
    let mut below = at;
    let mut left = symbolic.children[at];
    std::iter::from_fn(move || {
        if left == 0 {
            return None;
        }
        left -= 1;
        let child = below - 1;
        below = symbolic.first[child] as usize;
        Some(child)
    })
}

/// Puts the entries of the columns of L − σB into a front.
fn entries(
    symbolic: &Symbolic,
    matrix: &Symmetric,
    sigma: f64,
    columns: std::ops::Range<usize>,
    size: usize,
    front: &mut [f64],
) {
    for (at, column) in columns.enumerate() {
        let target = &mut front[at * size..(at + 1) * size];
        let range = matrix.range(column);
        let places = &symbolic.entry[range.clone()];
        match &matrix.mass {
            MassMatrix::Full(mass) => {
                for ((&place, l), b) in places.iter().zip(&matrix.stiffness[range.clone()]).zip(&mass[range]) {
                    target[place as usize] = l - sigma * b;
                }
            }
            other => {
                for (&place, l) in places.iter().zip(&matrix.stiffness[range]) {
                    target[place as usize] = *l;
                }
                let b = if let MassMatrix::Diagonal(mass) = other { mass[column] } else { 1.0 };
                target[at] -= sigma * b;
            }
        }
    }
}

/// Writes the columns of M of one supernode in the order in which the solves read them: in pieces of eight columns (the
/// last one as many as there are), of each its strictly lower triangle by rows, then all rows below that.
fn pack(front: &[f64], size: usize, width: usize, below: usize, mut values: &mut [f64]) {
    for first in (0..width).step_by(WIDTH) {
        let count = WIDTH.min(width - first);
        let all = width + below;
        let (triangle, rest) = values.split_at_mut(count * (count - 1) / 2);
        let mut to = triangle.iter_mut();
        for row in 1..count {
            for (column, to) in (0..row).zip(&mut to) {
                *to = front[(first + column) * size + first + row];
            }
        }
        let (rows, rest) = rest.split_at_mut(count * (all - first - count));
        let front = &front[first * size..(first + count) * size];
        by_size(count as u32, ByRows { front, size, first: first + count, to: rows });
        values = rest;
    }
}

/// Some columns of a front from a row on, and where to write them by rows.
struct ByRows<'a> {
    front: &'a [f64],
    size: usize,
    first: usize,
    to: &'a mut [f64],
}

impl Columns for ByRows<'_> {
    fn run<const W: usize>(self) {
        let Self { front, size, first, to } = self;
        let to = to.as_chunks_mut::<W>().0;
        let columns: [&[f64]; W] = std::array::from_fn(|at| &front[at * size + first..][..to.len()]);
        for (row, to) in to.iter_mut().enumerate() {
            for (to, column) in to.iter_mut().zip(columns) {
                *to = column[row];
            }
        }
    }
}

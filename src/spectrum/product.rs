//! Products of B with blocks.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::{
    block::Square,
    lanes::{Kernel, Lanes, Row, WIDTH},
};
use crate::{
    laplacian::Symmetric,
    watch::{Pulse, Stopped},
};

/// Rows of a product that are made together.
pub(super) const GROUP: usize = 16;

/// B, as what multiplies a block.
#[derive(Debug)]
pub(super) enum Product {
    /// The identity.
    Unit,
    /// A diagonal.
    Diagonal(Vec<f64>),
    /// Both triangles by rows.
    Rows(ByRows),
}

/// A matrix by rows, in pieces of eight entries, for the vertices of most meshes have seven. A loop whose length
/// changes from row to row costs more than the zeros that are multiplied here.
#[derive(Debug)]
pub(super) struct ByRows {
    /// The first entries of each row.
    first: Vec<Entries>,
    /// What rows have besides, by rows.
    more: Vec<(u32, Entries)>,
    /// Where in that the rows of each [`GROUP`] begin.
    starts: Vec<u32>,
}

#[derive(Debug, Clone, Copy)]
struct Entries {
    /// Where there is no entry the column is the row's own and the value zero.
    columns: [u32; WIDTH],
    values: [f64; WIDTH],
}

impl ByRows {
    /// B with these values, which belong to the entries of the matrix.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn new(matrix: &Symmetric, values: &[f64], pulse: &Pulse) -> Result<Self, Stopped> {
        let n = matrix.order();
        let mut counts = vec![0_u32; n];
        for column in 0..n {
            pulse.beat(20)?;
            for at in matrix.range(column) {
                let row = matrix.rows[at] as usize;
                counts[row] += 1;
                if row != column {
                    counts[column] += 1;
                }
            }
        }
        let none = |row: usize| Entries { columns: [row as u32; WIDTH], values: [0.0; WIDTH] };
        let first = (0..n).map(none).collect();
        let (mut more, mut starts) = (Vec::new(), Vec::with_capacity(n.div_ceil(GROUP) + 1));
        // Where the rest of each row begins.
        let mut rests = Vec::with_capacity(n);
        for (row, count) in counts.iter_mut().enumerate() {
            pulse.beat(30)?;
            if row % GROUP == 0 {
                starts.push(more.len() as u32);
            }
            rests.push(more.len());
            let pieces = count.div_ceil(WIDTH as u32).saturating_sub(1) as usize;
            more.extend(std::iter::repeat_n((row as u32, none(row)), pieces));
            *count = 0;
        }
        starts.push(more.len() as u32);
        let mut this = Self { first, more, starts };
        let mut put = |row: usize, column: usize, value: f64| {
            let at = counts[row] as usize;
            let entries = match (at / WIDTH).checked_sub(1) {
                None => &mut this.first[row],
                Some(piece) => &mut this.more[rests[row] + piece].1,
            };
            entries.columns[at % WIDTH] = column as u32;
            entries.values[at % WIDTH] = value;
            counts[row] += 1;
        };
        // By columns of the lower triangle: each row receives its left part in order, then diagonal and right part.
        for column in 0..n {
            pulse.beat(40)?;
            for at in matrix.range(column) {
                let row = matrix.rows[at] as usize;
                put(row, column, values[at]);
                if row != column {
                    put(column, row, values[at]);
                }
            }
        }
        Ok(this)
    }
}

impl Entries {
    /// What they give with a block.
    #[inline(always)]
    fn sum<L: Lanes>(&self, lanes: L, x: &[Row]) -> L::Reg {
        let mut sum = lanes.zero();
        for (&column, &value) in self.columns.iter().zip(&self.values) {
            sum = lanes.add_mul(sum, lanes.splat(value), lanes.load(&x[column as usize]));
        }
        sum
    }
}

impl Product {
    /// Rows of B x: a [`GROUP`], or what there is of it.
    #[inline(always)]
    pub(super) fn group<L: Lanes>(&self, lanes: L, x: &[Row], group: usize, to: &mut [Row]) {
        let rows = group * GROUP..group * GROUP + to.len();
        match self {
            Self::Unit => to.copy_from_slice(&x[rows]),
            Self::Diagonal(values) => {
                for (to, (x, &value)) in to.iter_mut().zip(x[rows.clone()].iter().zip(&values[rows])) {
                    *to = lanes.row(lanes.mul(lanes.load(x), lanes.splat(value)));
                }
            }
            Self::Rows(matrix) => {
                for (to, entries) in to.iter_mut().zip(&matrix.first[rows.clone()]) {
                    *to = lanes.row(entries.sum(lanes, x));
                }
                let rest = matrix.starts[group] as usize..matrix.starts[group + 1] as usize;
                for (row, entries) in &matrix.more[rest] {
                    let to = &mut to[*row as usize - rows.start];
                    *to = lanes.row(lanes.add(lanes.load(to), entries.sum(lanes, x)));
                }
            }
        }
    }
}

/// `to = B x`; returns xᵀBx.
pub(super) struct Multiply<'a> {
    pub mass: &'a Product,
    pub x: &'a [Row],
    pub to: &'a mut [Row],
}

impl Kernel for Multiply<'_> {
    type Output = Square;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Square {
        let Self { mass, x, to } = self;
        let mut gram = [lanes.zero(); WIDTH];
        for (group, (own, to)) in x.chunks(GROUP).zip(to.chunks_mut(GROUP)).enumerate() {
            mass.group(lanes, x, group, to);
            for (own, to) in own.iter().zip(to) {
                let to = lanes.load(to);
                for (gram, &own) in gram.iter_mut().zip(own) {
                    *gram = lanes.add_mul(*gram, lanes.splat(own), to);
                }
            }
        }
        gram.map(|sum| lanes.row(sum))
    }
}

//! The structure of the factor, found once per mesh.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::order::{Order, ROOT};
use crate::{
    laplacian::Symmetric,
    spectrum::lanes::WIDTH,
    watch::{Pulse, Stopped},
};

/// Supernodes, their rows and how their fronts are put together, of a matrix in its [order of elimination](Order).
#[derive(Debug)]
pub(in crate::spectrum) struct Symbolic {
    /// First column of every supernode, and n.
    pub begin: Vec<u32>,
    /// Where the rows below a supernode's diagonal block are in `rows`.
    pub row_start: Vec<usize>,
    /// Rows below the diagonal blocks, ascending per supernode.
    pub rows: Vec<u32>,
    /// For each of `rows` its place in the front of the parent supernode.
    pub relative: Vec<u32>,
    /// For each entry of the matrix its row in the front of its column's supernode.
    pub entry: Vec<u32>,
    /// How many children each supernode has; in postorder they are the last ones on the stack.
    pub children: Vec<u32>,
    /// The first supernode of the subtree below each.
    pub first: Vec<u32>,
    /// Where the packed values of each supernode start.
    pub value_start: Vec<usize>,
    /// What the solves go through, in the order of their values.
    pub(super) pieces: Vec<Piece>,
    /// The rows below the diagonal blocks of the pieces.
    pub(super) piece_rows: Vec<u32>,
    /// The largest front, in rows.
    pub front: usize,
    /// The most numbers that waiting update matrices hold together.
    pub stack: usize,
}

/// At most eight columns of a supernode, so that a solve can hold their rows in registers.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// First column and number of columns.
    pub begin: u32,
    pub width: u32,
    /// Its rows below its diagonal block in `piece_rows`: the other columns of the supernode, then its rows.
    pub rows: u32,
    pub end: u32,
    /// Where its values start.
    pub values: usize,
    /// The supernode.
    pub node: u32,
    /// Whether it is the supernode's first.
    pub first: bool,
}

impl Symbolic {
    /// Analyses.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(in crate::spectrum) fn new(matrix: &Symmetric, order: &Order, pulse: &Pulse) -> Result<Self, Stopped> {
        let begin = supernodes(&order.tree, &order.counts, pulse)?;
        let (row_start, rows, parent) = structure(matrix, &begin, pulse)?;
        Self::finish(matrix, begin, row_start, rows, &parent, pulse)
    }

    /// Supernodes.
    pub(super) fn len(&self) -> usize {
        self.children.len()
    }

    /// First column, number of columns and rows below of a supernode.
    #[inline(always)]
    pub(super) fn node(&self, at: usize) -> (usize, usize, &[u32]) {
        let begin = self.begin[at] as usize;
        let width = self.begin[at + 1] as usize - begin;
        (begin, width, &self.rows[self.row_start[at]..self.row_start[at + 1]])
    }

    /// Numbers in the factor.
    pub(in crate::spectrum) fn values(&self) -> usize {
        self.value_start.last().copied().unwrap_or(0)
    }

    /// Multiplications of a numeric factorisation: (r² + 3r)/2 for a column with r entries below its pivot.
    pub(in crate::spectrum) fn multiplications(&self) -> usize {
        let below = |at| {
            let (_, width, rows) = self.node(at);
            (0..width).map(move |column| rows.len() + column)
        };
        (0..self.len()).flat_map(below).map(|below| below * (below + 3) / 2).sum()
    }

    fn finish(
        matrix: &Symmetric,
        begin: Vec<u32>,
        row_start: Vec<usize>,
        rows: Vec<u32>,
        parent: &[u32],
        pulse: &Pulse,
    ) -> Result<Self, Stopped> {
        let count = parent.len();
        let mut relative = vec![0_u32; rows.len()];
        let mut children = vec![0_u32; count];
        let mut entry = vec![0_u32; matrix.rows.len()];
        let mut place = vec![0_u32; begin[count] as usize];
        // Children of a supernode precede it, so one pass over the parents with a list of children each suffices.
        let mut lists: Vec<Vec<u32>> = vec![Vec::new(); count];
        for (at, &above) in parent.iter().enumerate() {
            pulse.beat(30)?;
            if above != ROOT {
                lists[above as usize].push(at as u32);
                children[above as usize] += 1;
            }
        }
        for above in 0..count {
            let width = begin[above + 1] - begin[above];
            pulse.beat(60 * width as usize + 4 * (row_start[above + 1] - row_start[above]))?;
            for column in begin[above]..begin[above + 1] {
                place[column as usize] = column - begin[above];
            }
            for (at, &row) in rows[row_start[above]..row_start[above + 1]].iter().enumerate() {
                place[row as usize] = width + at as u32;
            }
            for column in begin[above]..begin[above + 1] {
                for at in matrix.range(column as usize) {
                    entry[at] = place[matrix.rows[at] as usize];
                }
            }
            for &child in &lists[above] {
                let range = row_start[child as usize]..row_start[child as usize + 1];
                for at in range {
                    relative[at] = place[rows[at] as usize];
                }
            }
        }
        let mut value_start = vec![0_usize; count + 1];
        let mut first: Vec<u32> = (0..count as u32).collect();
        let (mut front, mut stack, mut height) = (0, 0, 0);
        let mut waiting: Vec<usize> = Vec::new();
        for at in 0..count {
            pulse.beat(20)?;
            let width = (begin[at + 1] - begin[at]) as usize;
            let below = row_start[at + 1] - row_start[at];
            value_start[at + 1] = value_start[at] + width * (width - 1) / 2 + width * below;
            front = front.max(width + below);
            for _ in 0..children[at] {
                first[at] = first[first[at] as usize - 1];
                height -= waiting.pop().unwrap_or(0);
            }
            let update = below * (width + below).next_multiple_of(WIDTH);
            waiting.push(update);
            height += update;
            stack = stack.max(height);
        }
        let (pieces, piece_rows) = pieces(&begin, &row_start, &rows, &value_start, pulse)?;
        // While a front is assembled its children still wait, and its own update is pushed after they are gone.
        Ok(Self {
            begin,
            row_start,
            rows,
            relative,
            entry,
            children,
            first,
            value_start,
            pieces,
            piece_rows,
            front,
            stack,
        })
    }
}

/// Cuts the supernodes into pieces; also lists their rows.
///
/// # Errors
/// When the watch cancels.
fn pieces(
    begin: &[u32],
    row_start: &[usize],
    rows: &[u32],
    value_start: &[usize],
    pulse: &Pulse,
) -> Result<(Vec<Piece>, Vec<u32>), Stopped> {
    let (mut pieces, mut list) = (Vec::new(), Vec::new());
    for node in 0..begin.len() - 1 {
        let mut values = value_start[node];
        let below = &rows[row_start[node]..row_start[node + 1]];
        for first in (begin[node]..begin[node + 1]).step_by(WIDTH) {
            let end = (first + WIDTH as u32).min(begin[node + 1]);
            let start = list.len() as u32;
            list.extend(end..begin[node + 1]);
            list.extend_from_slice(below);
            pieces.push(Piece {
                begin: first,
                width: end - first,
                rows: start,
                end: list.len() as u32,
                values,
                node: node as u32,
                first: first == begin[node],
            });
            pulse.beat(20 + list.len() - start as usize)?;
            let width = (end - first) as usize;
            values += width * (width - 1) / 2 + width * (list.len() - start as usize);
        }
    }
    Ok((pieces, list))
}

/// Of more rows than these the factor is far larger than the caches, and a stored zero costs about twice as much.
const MANY: usize = 100_000;

/// Columns with nested patterns, then merged with their parents while few zeros are stored for it. Of small supernodes
/// many may be: a solve spends more on coming to another supernode than on some fifty zeros.
///
/// # Errors
/// When the watch cancels.
fn supernodes(parent: &[u32], counts: &[u32], pulse: &Pulse) -> Result<Vec<u32>, Stopped> {
    struct Node {
        begin: usize,
        end: usize,
        /// Rows below.
        below: usize,
        /// Stored zeros.
        zeros: usize,
    }
    let n = parent.len();
    let price = if n > MANY { 2.0 } else { 1.0 };
    let mut stack: Vec<Node> = Vec::new();
    let mut column = 0;
    while column < n {
        let begin = column;
        while column + 1 < n && parent[column] == column as u32 + 1 && counts[column] == counts[column + 1] + 1 {
            column += 1;
        }
        column += 1;
        pulse.beat(20 * (column - begin))?;
        let mut node = Node { begin, end: column, below: counts[column - 1] as usize - 1, zeros: 0 };
        while let Some(child) = stack.last() {
            let above = parent[child.end - 1];
            if above == ROOT || !(node.begin..node.end).contains(&(above as usize)) {
                break;
            }
            let (inner, outer) = (child.end - child.begin, node.end - node.begin);
            let zeros = child.zeros + node.zeros + inner * (outer + node.below - child.below);
            let width = inner + outer;
            let size = width * (width + 1) / 2 + width * node.below;
            let share = price * zeros as f64 / size as f64;
            let merge = match width {
                0..=4 => share < 0.9,
                5..=8 => share < 0.6,
                9..=16 => share < 0.3,
                17..=48 => share < 0.1,
                _ => share < 0.05,
            };
            if !merge {
                break;
            }
            node.begin = child.begin;
            node.zeros = zeros;
            stack.pop();
        }
        stack.push(node);
    }
    Ok(stack.iter().map(|node| node.begin as u32).chain([n as u32]).collect())
}

/// Where the rows below every supernode begin, these rows, and every supernode's parent.
type Structure = (Vec<usize>, Vec<u32>, Vec<u32>);

/// The rows below every supernode, and its parent.
fn structure(matrix: &Symmetric, begin: &[u32], pulse: &Pulse) -> Result<Structure, Stopped> {
    let n = matrix.order();
    let count = begin.len() - 1;
    let mut owner = vec![0_u32; n];
    for at in 0..count {
        owner[begin[at] as usize..begin[at + 1] as usize].fill(at as u32);
    }
    let mut row_start = vec![0_usize; count + 1];
    let mut rows: Vec<u32> = Vec::new();
    let mut parent = vec![ROOT; count];
    let mut children: Vec<Vec<u32>> = vec![Vec::new(); count];
    let mut seen = vec![ROOT; n];
    for at in 0..count {
        let end = begin[at + 1];
        let mut list = Vec::new();
        let mut add = |row: u32| {
            if row >= end && seen[row as usize] != at as u32 {
                seen[row as usize] = at as u32;
                list.push(row);
            }
        };
        for column in begin[at]..end {
            matrix.rows[matrix.range(column as usize)].iter().for_each(|&row| add(row));
        }
        for &child in &children[at] {
            let range = row_start[child as usize]..row_start[child as usize + 1];
            rows[range].iter().for_each(|&row| add(row));
        }
        pulse.beat(40 * list.len() + 40)?;
        list.sort_unstable();
        if let Some(&first) = list.first() {
            parent[at] = owner[first as usize];
            children[owner[first as usize] as usize].push(at as u32);
        }
        rows.extend_from_slice(&list);
        row_start[at + 1] = rows.len();
    }
    Ok((row_start, rows, parent))
}

//! The order of elimination.

mod coarse;
mod degree;
mod dissect;
mod refine;
mod separate;

use faer::{
    dyn_stack::{MemBuffer, MemStack},
    sparse::{SymbolicSparseColMatRef, linalg::amd},
};

use crate::{
    laplacian::Symmetric,
    watch::{Pulse, Stopped},
};

/// No parent: a root of the elimination forest.
pub(super) const ROOT: u32 = u32::MAX;

/// Up to so many rows faer's minimum degree is done in less time than a cancellation may take. It cannot be
/// interrupted, and knows nothing of parts.
const SHORT: usize = 55_000;

/// An order of elimination, and what it comes to.
#[derive(Debug)]
pub(in crate::spectrum) struct Order {
    /// The old indices of the rows.
    pub rows: Vec<u32>,
    /// The parent of every column in the elimination tree.
    pub(super) tree: Vec<u32>,
    /// The number of entries of every column of the factor, diagonal included.
    pub(super) counts: Vec<u32>,
}

/// A fill-reducing order of the rows: approximate minimum degree, [our own](degree) where
/// there are many rows and in the stages of a [dissection](dissect) where there are very many, then a postorder of the
/// elimination tree in which a column's heaviest child comes last.
///
/// Returns `None` when the ordering runs out of memory or of indices.
///
/// # Errors
/// When the watch cancels.
pub(in crate::spectrum) fn order(matrix: &Symmetric, pulse: &Pulse) -> Result<Option<Order>, Stopped> {
    let n = matrix.order();
    let (offsets, neighbours) = matrix.graph(pulse)?;
    pulse.ask()?;
    let found =
        if n <= SHORT { minimum_degree(&offsets, &neighbours) } else { dissect::order(&offsets, &neighbours, pulse)? };
    let Some(forward) = found else { return Ok(None) };
    pulse.ask()?;
    let mut inverse = vec![0_u32; n];
    for (new, &old) in forward.iter().enumerate() {
        inverse[old as usize] = new as u32;
    }
    let earlier = |column: usize, visit: &mut dyn FnMut(usize)| {
        let old = forward[column] as usize;
        for &neighbour in &neighbours[offsets[old]..offsets[old + 1]] {
            let row = inverse[neighbour as usize] as usize;
            if row < column {
                visit(row);
            }
        }
    };
    pulse.ask()?;
    let tree = elimination_tree(n, &earlier, pulse)?;
    let counts = column_counts(n, &tree, &earlier, pulse)?;
    let post = postorder(&tree, &counts, pulse)?;
    // The tree and the counts of what is in postorder are the same with other names.
    for (new, &old) in post.iter().enumerate() {
        inverse[old as usize] = new as u32;
    }
    let named = |&at: &u32| inverse.get(tree[at as usize] as usize).copied().unwrap_or(ROOT);
    let (tree, counts) = (post.iter().map(named).collect(), post.iter().map(|&at| counts[at as usize]).collect());
    let rows = post.iter().map(|&at| forward[at as usize]).collect();
    Ok(Some(Order { rows, tree, counts }))
}

fn minimum_degree(offsets: &[usize], neighbours: &[u32]) -> Option<Vec<u32>> {
    let n = offsets.len() - 1;
    let columns: Vec<u32> = offsets.iter().map(|&at| u32::try_from(at).ok()).collect::<Option<_>>()?;
    let pattern = SymbolicSparseColMatRef::<u32>::new_checked(n, n, &columns, None, neighbours);
    let mut forward = vec![0_u32; n];
    let mut inverse = vec![0_u32; n];
    let mut memory = MemBuffer::try_new(amd::order_maybe_unsorted_scratch::<u32>(n, neighbours.len())).ok()?;
    amd::order_maybe_unsorted(&mut forward, &mut inverse, pattern, amd::Control::default(), MemStack::new(&mut memory))
        .ok()?;
    Some(forward)
}

/// Calls back with the rows of a column above its diagonal.
trait Earlier: Fn(usize, &mut dyn FnMut(usize)) {}

impl<F: Fn(usize, &mut dyn FnMut(usize))> Earlier for F {}

/// The parent of every column (Liu 1986).
///
/// # Errors
/// When the watch cancels.
fn elimination_tree(n: usize, earlier: &impl Earlier, pulse: &Pulse) -> Result<Vec<u32>, Stopped> {
    let mut parent = vec![ROOT; n];
    let mut ancestor = vec![ROOT; n];
    for column in 0..n {
        pulse.beat(40)?;
        earlier(column, &mut |row| {
            let mut at = row;
            while ancestor[at] != column as u32 {
                let next = ancestor[at];
                ancestor[at] = column as u32;
                if next == ROOT {
                    parent[at] = column as u32;
                    break;
                }
                at = next as usize;
                if at == column {
                    break;
                }
            }
        });
    }
    Ok(parent)
}

/// The number of entries of every column of the factor, diagonal included, by walking the row subtrees.
///
/// # Errors
/// When the watch cancels.
fn column_counts(n: usize, parent: &[u32], earlier: &impl Earlier, pulse: &Pulse) -> Result<Vec<u32>, Stopped> {
    let mut counts = vec![1_u32; n];
    let mut seen = vec![ROOT; n];
    for column in 0..n {
        seen[column] = column as u32;
        let mut steps = 20;
        earlier(column, &mut |row| {
            let mut at = row;
            while seen[at] != column as u32 {
                counts[at] += 1;
                seen[at] = column as u32;
                at = parent[at] as usize;
                steps += 3;
            }
        });
        pulse.beat(steps)?;
    }
    Ok(counts)
}

/// A postorder of the forest as the list of old indices; the child with the most entries comes last.
fn postorder(parent: &[u32], counts: &[u32], pulse: &Pulse) -> Result<Vec<u32>, Stopped> {
    let n = parent.len();
    let mut by_weight: Vec<u32> = (0..n as u32).collect();
    pulse.sort(&mut by_weight, &|&a, &b| counts[a as usize].cmp(&counts[b as usize]).then(a.cmp(&b)))?;
    // Lists of children, heaviest first, because the walk below pushes them on a stack.
    let mut first = vec![ROOT; n];
    let mut next = vec![ROOT; n];
    let mut roots = Vec::new();
    for &at in &by_weight {
        pulse.beat(20)?;
        match parent[at as usize] {
            ROOT => roots.push(at),
            above => {
                next[at as usize] = first[above as usize];
                first[above as usize] = at;
            }
        }
    }
    let mut post = Vec::with_capacity(n);
    let mut stack = Vec::new();
    for &root in &roots {
        stack.push(root);
        while let Some(&at) = stack.last() {
            let mut child = first[at as usize];
            if child == ROOT {
                stack.pop();
                post.push(at);
                pulse.beat(30)?;
                continue;
            }
            first[at as usize] = ROOT;
            while child != ROOT {
                stack.push(child);
                child = next[child as usize];
            }
        }
    }
    Ok(post)
}

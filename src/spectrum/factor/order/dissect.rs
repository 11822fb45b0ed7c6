//! The rows of large graphs are ordered by parts.
//!
//! Minimum degree is the better order of few rows, but its fill grows faster than that of a nested dissection (George
//! 1973). A large graph is cut by light [separators](separate) until its parts are small. Then minimum degree orders
//! the rows of each part, knowing what surrounds it, and at last the rows of all separators together, which leaves less
//! fill than one separator after the other (Ashcraft and Liu 1998).

use super::{
    coarse::{Graph, NONE},
    degree::minimum_degree,
    refine::{CUT, Refiner},
    separate::separate,
};
use crate::watch::{Pulse, Stopped};

/// A graph of so many rows is not cut: finding separators would cost more than they save in a few hundred solves.
const WHOLE: usize = 150_000;

/// Parts of so many rows are not cut further.
const LARGEST: usize = 1_000;

/// A fill-reducing order, as the list of old indices, or `None` when indices run out.
///
/// # Errors
/// When the watch cancels.
pub(super) fn order(offsets: &[usize], neighbours: &[u32], pulse: &Pulse) -> Result<Option<Vec<u32>>, Stopped> {
    let largest = if offsets.len() <= WHOLE { WHOLE } else { LARGEST };
    order_by(largest, offsets, neighbours, pulse)
}

fn order_by(largest: usize, offsets: &[usize], neighbours: &[u32], pulse: &Pulse) -> Result<Option<Vec<u32>>, Stopped> {
    let Some(offsets) = offsets.iter().map(|&at| u32::try_from(at).ok()).collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let stages = dissect(largest, &offsets, neighbours, pulse)?;
    minimum_degree(&offsets, neighbours, &stages, pulse).map(Some)
}

/// The parts of a graph, and last the rows between them, ascending.
fn dissect(largest: usize, offsets: &[u32], neighbours: &[u32], pulse: &Pulse) -> Result<Vec<Vec<u32>>, Stopped> {
    let n = offsets.len() - 1;
    let (mut parts, mut cut) = (Vec::new(), Vec::new());
    let mut place = vec![NONE; n];
    let mut refiner = Refiner::default();
    let mut waiting: Vec<Vec<u32>> = vec![(0..n as u32).collect()];
    while let Some(rows) = waiting.pop() {
        if rows.len() <= largest {
            parts.push(rows);
            continue;
        }
        let graph = Graph::part(offsets, neighbours, &rows, &mut place, pulse)?;
        let sides = separate(&graph, &mut refiner, pulse)?;
        let [low, high, _] = sides.weight;
        pulse.beat(10 * rows.len())?;
        // A graph such as a complete one has no light separators.
        if 16 * low.min(high) as usize <= rows.len() {
            parts.push(rows);
            continue;
        }
        let list = |which| {
            let inside = rows.iter().zip(&sides.side).filter(move |&(_, &side)| side == which);
            inside.map(|(&row, _)| row)
        };
        cut.extend(list(CUT));
        waiting.push(list(1).collect());
        waiting.push(list(0).collect());
    }
    pulse.sort(&mut cut, &u32::cmp)?;
    parts.push(cut);
    Ok(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::{Patience, Unwatched};

    /// The graph of these edges.
    fn graph(n: usize, edges: &[(u32, u32)]) -> (Vec<usize>, Vec<u32>) {
        let mut lists = vec![Vec::new(); n];
        for &(a, b) in edges {
            lists[a as usize].push(b);
            lists[b as usize].push(a);
        }
        for list in &mut lists {
            list.sort_unstable();
        }
        let mut offsets = vec![0];
        offsets.extend(lists.iter().scan(0, |sum, list| {
            *sum += list.len();
            Some(*sum)
        }));
        (offsets, lists.concat())
    }

    /// A grid of triangles.
    fn grid(width: u32, height: u32) -> (Vec<usize>, Vec<u32>) {
        let mut edges = Vec::new();
        for at in 0..width * height {
            let (right, below) = (at % width + 1 < width, at + width < width * height);
            edges.extend(right.then_some((at, at + 1)));
            edges.extend(below.then_some((at, at + width)));
            edges.extend((right && below).then_some((at, at + width + 1)));
        }
        graph((width * height) as usize, &edges)
    }

    fn ordered(largest: usize, (offsets, neighbours): &(Vec<usize>, Vec<u32>)) -> Vec<u32> {
        let order = order_by(largest, offsets, neighbours, &Pulse::new(&Unwatched)).unwrap().unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..offsets.len() as u32 - 1), "every row once");
        order
    }

    /// The entries of the factor, by eliminating with the rows in sets.
    fn fill(order: &[u32], (offsets, neighbours): &(Vec<usize>, Vec<u32>)) -> usize {
        let mut place = vec![0; order.len()];
        for (at, &row) in order.iter().enumerate() {
            place[row as usize] = at;
        }
        let mut later: Vec<std::collections::BTreeSet<usize>> = vec![std::collections::BTreeSet::new(); order.len()];
        let mut sum = 0;
        for at in 0..order.len() {
            let row = order[at] as usize;
            let mut own = std::mem::take(&mut later[at]);
            let around = neighbours[offsets[row]..offsets[row + 1]].iter().map(|&other| place[other as usize]);
            own.extend(around.filter(|&other| other > at));
            sum += 1 + own.len();
            if let Some(first) = own.pop_first() {
                later[first].extend(own);
            }
        }
        sum
    }

    #[test]
    fn parts_are_not_neighbours() {
        let (offsets, neighbours) = grid(70, 50);
        let starts: Vec<u32> = offsets.iter().map(|&at| at as u32).collect();
        let mut stages = dissect(200, &starts, &neighbours, &Pulse::new(&Unwatched)).unwrap();
        let cut = stages.pop().unwrap();
        assert!((17..60).contains(&stages.len()), "{} parts", stages.len());
        assert!(cut.len() < 1000, "{} rows between them", cut.len());
        let mut part = vec![NONE; offsets.len() - 1];
        for (at, rows) in (0..).zip(&stages) {
            assert!(rows.len() <= 200);
            for &row in rows {
                part[row as usize] = at;
            }
        }
        for row in 0..part.len() {
            for &other in &neighbours[offsets[row]..offsets[row + 1]] {
                let pair = [part[row], part[other as usize]];
                assert!(pair[0] == pair[1] || pair.contains(&NONE), "{row} and {other}");
            }
        }
    }

    #[test]
    fn a_dissection_fills_less_than_its_bound_and_than_minimum_degree() {
        // Of a square of n rows a nested dissection fills at most 31/4 n log₂ n (George and Liu 1981).
        let grid = grid(150, 150);
        let dissected = fill(&ordered(600, &grid), &grid);
        let whole = fill(&ordered(22_500, &grid), &grid);
        let bound = 31.0 / 4.0 * 22_500.0 * 22_500_f64.log2();
        assert!(3 * dissected < bound as usize, "{dissected} of {bound}");
        assert!(50 * dissected < 49 * whole, "{dissected} of {whole}");
        let rows: Vec<u32> = (0..22_500).collect();
        assert!(3 * whole < fill(&rows, &grid), "{whole}");
    }

    #[test]
    fn a_tree_is_ordered_without_fill() {
        let edges: Vec<(u32, u32)> = (1..900).map(|at| ((at - 1) / 3, at)).collect();
        let tree = graph(900, &edges);
        assert_eq!(fill(&ordered(900, &tree), &tree), 900 + 899);
    }

    #[test]
    fn the_order_is_the_same_each_time() {
        let grid = grid(90, 60);
        assert_eq!(ordered(100, &grid), ordered(100, &grid));
    }

    #[test]
    fn graphs_without_light_separators_or_in_pieces_are_ordered_too() {
        let complete: Vec<(u32, u32)> = (0..90).flat_map(|a| (0..a).map(move |b| (a, b))).collect();
        let star: Vec<(u32, u32)> = (1..5000).map(|at| (0, at)).collect();
        let bristles: Vec<(u32, u32)> = (1..500).map(|at| (at % 7, at)).filter(|(a, b)| a != b).collect();
        let pieces: Vec<(u32, u32)> = (0..300).filter(|at| at % 75 != 74).map(|at| (at, at + 1)).collect();
        let close: Vec<(u32, u32)> = (0..2000).flat_map(|a| (a + 1..2000.min(a + 16)).map(move |b| (a, b))).collect();
        for (n, edges) in [(0, vec![]), (1, vec![]), (100, vec![]), (90, complete), (5000, star), (500, bristles)] {
            ordered(40, &graph(n, &edges));
        }
        for (n, edges) in [(300, pieces), (2000, close)] {
            let graph = graph(n, &edges);
            // Both have orders without fill; a cut costs at most its square.
            assert!(fill(&ordered(100, &graph), &graph) < 2 * (n + edges.len()));
        }
    }

    #[test]
    fn an_order_is_cancelled_wherever_it_is() {
        let (offsets, neighbours) = grid(150, 150);
        let all = Patience::of(usize::MAX);
        order_by(600, &offsets, &neighbours, &Pulse::new(&all)).unwrap();
        assert!(all.looks() > 5, "{} looks", all.looks());
        for granted in 0..all.looks() {
            let some = Patience::of(granted);
            assert_eq!(order_by(600, &offsets, &neighbours, &Pulse::new(&some)), Err(Stopped));
            assert_eq!(some.looks(), granted + 1);
        }
    }
}

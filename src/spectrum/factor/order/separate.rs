//! Separators by way of coarser graphs (Karypis and Kumar 1998).

use super::{
    coarse::Graph,
    refine::{CUT, Refiner, Sides, Task},
};
use crate::watch::{Pulse, Stopped};

/// A graph of so many vertices is not made coarser.
const COARSEST: usize = 60;

/// So many separators of the coarsest graph are tried.
const TRIES: usize = 8;

/// Parts a graph, if it can.
///
/// # Errors
/// When the watch cancels.
pub(super) fn separate(graph: &Graph, refiner: &mut Refiner, pulse: &Pulse) -> Result<Sides, Stopped> {
    let total: u32 = graph.weights.iter().sum();
    // A light separator off the middle is better than a heavy one in the middle.
    let limit = (u64::from(total) * 2 / 3) as u32;
    let heaviest = (3 * total / 2 / COARSEST as u32).max(1);
    let mut levels: Vec<(Graph, Vec<u32>)> = Vec::new();
    loop {
        let finer = levels.last().map_or(graph, |(graph, _)| graph);
        if finer.len() <= COARSEST {
            break;
        }
        let coarser = finer.coarser(heaviest, pulse)?;
        if 20 * coarser.0.len() > 19 * finer.len() {
            break;
        }
        levels.push(coarser);
    }
    let coarsest = levels.last().map_or(graph, |(graph, _)| graph);
    let (mut sides, mut cut) = start(coarsest, total, limit, refiner, pulse)?;
    while let Some((_, place)) = levels.pop() {
        let finer = levels.last().map_or(graph, |(graph, _)| graph);
        cut.clear();
        let of_place = |(vertex, &at): (u32, &u32)| {
            let side = sides.side[at as usize];
            if side == CUT {
                cut.push(vertex);
            }
            side
        };
        let side = (0..).zip(&place).map(of_place).collect();
        sides.side = side;
        pulse.beat(2 * place.len())?;
        refiner.refine(Task { graph: finer, limit, pulse }, &mut sides, &mut cut)?;
    }
    Ok(sides)
}

/// The best of some separators that are grown from single vertices.
fn start(
    graph: &Graph,
    total: u32,
    limit: u32,
    refiner: &mut Refiner,
    pulse: &Pulse,
) -> Result<(Sides, Vec<u32>), Stopped> {
    let n = graph.len();
    let mut best: Option<(Sides, Vec<u32>)> = None;
    // A graph of stars or of many pieces stays large; nearly everything parts it.
    let tries = if n <= 4 * COARSEST { TRIES } else { 1 };
    for at in 0..tries {
        let (mut sides, mut cut) = grow(graph, total, (n * at / tries) as u32, pulse)?;
        refiner.refine(Task { graph, limit, pulse }, &mut sides, &mut cut)?;
        if best.as_ref().is_none_or(|(best, _)| sides.cost(limit) < best.cost(limit)) {
            best = Some((sides, cut));
        }
    }
    Ok(best.unwrap_or_default())
}

/// Half of the rows, the nearest ones to a vertex, and those that separate them from the others.
fn grow(graph: &Graph, total: u32, start: u32, pulse: &Pulse) -> Result<(Sides, Vec<u32>), Stopped> {
    let n = graph.len();
    let mut sides = Sides { side: vec![1; n], weight: [0, total, 0] };
    let mut reached = vec![start];
    sides.side[start as usize] = 0;
    let (mut next, mut other) = (0, 0);
    while 2 * sides.weight[0] < total {
        let Some(&vertex) = reached.get(next) else {
            // Another piece.
            while sides.side[other as usize] == 0 {
                other += 1;
            }
            sides.side[other as usize] = 0;
            reached.push(other);
            continue;
        };
        next += 1;
        sides.weight[0] += graph.weights[vertex as usize];
        sides.weight[1] -= graph.weights[vertex as usize];
        for &other in graph.around(vertex) {
            if sides.side[other as usize] == 1 {
                sides.side[other as usize] = 0;
                reached.push(other);
            }
        }
        pulse.beat(20)?;
    }
    // Those that wait are the neighbours of those that were taken.
    let cut = reached.split_off(next);
    for &vertex in &cut {
        sides.side[vertex as usize] = CUT;
        sides.weight[1] -= graph.weights[vertex as usize];
        sides.weight[2] += graph.weights[vertex as usize];
    }
    Ok((sides, cut))
}

//! Separators are made lighter by moving their vertices to either side (Fiduccia and Mattheyses 1982; Hendrickson and
//! Rothberg 1998).

use std::collections::BinaryHeap;

use super::coarse::Graph;
use crate::watch::{Pulse, Stopped};

/// In the separator; the sides are 0 and 1.
pub(super) const CUT: u8 = 2;

/// At most so many passes over a separator.
const PASSES: usize = 4;

/// At most so many moves that gain nothing.
const PATIENCE: usize = 50;

/// Two sides that are not neighbours, and what separates them.
#[derive(Debug, Clone, Default)]
pub(super) struct Sides {
    /// For each vertex its side, or [`CUT`].
    pub side: Vec<u8>,
    /// The rows of either side and of the separator.
    pub weight: [u32; 3],
}

impl Sides {
    /// Less is better: what a side has too much, the separator, the difference of the sides.
    pub(super) fn cost(&self, limit: u32) -> (u32, u32, u32) {
        let [low, high, cut] = self.weight;
        (low.max(high).saturating_sub(limit), cut, low.abs_diff(high))
    }

    fn put(&mut self, graph: &Graph, vertex: u32, side: u8) {
        let own = &mut self.side[vertex as usize];
        self.weight[*own as usize] -= graph.weights[vertex as usize];
        *own = side;
        self.weight[side as usize] += graph.weights[vertex as usize];
    }
}

/// What is parted, and how many rows a side may have.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub graph: &'a Graph,
    pub limit: u32,
    pub pulse: &'a Pulse<'a>,
}

/// What a refinement needs to remember; kept for its memory.
#[derive(Debug, Default)]
pub(super) struct Refiner {
    /// For a vertex of the separator the rows of its neighbours on either side.
    pulled: Vec<[u32; 2]>,
    /// The last pass in which a vertex was moved out of the separator.
    moved: Vec<u32>,
    pass: u32,
    /// Moves to either side: the rows that the separator loses, and the vertex. Some are out of date.
    moves: [BinaryHeap<(i32, u32)>; 2],
    /// The vertices that changed, and where they were.
    log: Vec<(u32, u8)>,
}

impl Refiner {
    /// Makes a separator lighter. `cut` are the vertices of the separator, before and after.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn refine(&mut self, task: Task, sides: &mut Sides, cut: &mut Vec<u32>) -> Result<(), Stopped> {
        let n = task.graph.len();
        if self.moved.len() < n {
            self.moved.resize(n, 0);
            self.pulled.resize(n, [0; 2]);
        }
        for _ in 0..PASSES {
            let before = sides.cost(task.limit);
            self.pass(task, sides, cut)?;
            if sides.cost(task.limit) >= before {
                break;
            }
        }
        Ok(())
    }

    fn pass(&mut self, task: Task, sides: &mut Sides, cut: &mut Vec<u32>) -> Result<(), Stopped> {
        let Task { graph, limit, pulse } = task;
        self.pass += 1;
        self.log.clear();
        self.moves.iter_mut().for_each(BinaryHeap::clear);
        for &vertex in &*cut {
            self.enter(graph, sides, vertex);
        }
        pulse.beat(200 * cut.len())?;
        let patience = (2 * cut.len()).clamp(20, PATIENCE);
        let (mut best, mut kept, mut idle) = (sides.cost(limit), 0, 0);
        while idle < patience {
            let Some((vertex, to)) = self.next(graph, sides, limit) else { break };
            self.shift(graph, sides, vertex, to);
            pulse.beat(800)?;
            let cost = sides.cost(limit);
            idle += 1;
            if cost < best {
                (best, kept, idle) = (cost, self.log.len(), 0);
            }
        }
        for &(vertex, from) in self.log[kept..].iter().rev() {
            sides.put(graph, vertex, from);
        }
        // Each vertex that is there now once.
        self.pass += 1;
        cut.extend(self.log[..kept].iter().map(|&(vertex, _)| vertex));
        cut.retain(|&vertex| {
            let first = self.moved[vertex as usize] != self.pass;
            self.moved[vertex as usize] = self.pass;
            first && sides.side[vertex as usize] == CUT
        });
        Ok(())
    }

    /// Notes the moves of a vertex that is in the separator.
    fn enter(&mut self, graph: &Graph, sides: &Sides, vertex: u32) {
        let mut pulled = [0; 3];
        for &other in graph.around(vertex) {
            pulled[sides.side[other as usize] as usize] += graph.weights[other as usize];
        }
        self.pulled[vertex as usize] = [pulled[0], pulled[1]];
        self.offer(graph, vertex, 0);
        self.offer(graph, vertex, 1);
    }

    fn gain(&self, graph: &Graph, vertex: u32, to: usize) -> i32 {
        graph.weights[vertex as usize] as i32 - self.pulled[vertex as usize][1 - to] as i32
    }

    fn offer(&mut self, graph: &Graph, vertex: u32, to: usize) {
        if self.moved[vertex as usize] != self.pass {
            self.moves[to].push((self.gain(graph, vertex, to), vertex));
        }
    }

    /// The best move that leaves the sides in balance.
    fn next(&mut self, graph: &Graph, sides: &Sides, limit: u32) -> Option<(u32, usize)> {
        let lighter = usize::from(sides.weight[1] < sides.weight[0]);
        let mut best: Option<(i32, u32, usize)> = None;
        for to in [lighter, 1 - lighter] {
            while let Some(&(gain, vertex)) = self.moves[to].peek() {
                let at = vertex as usize;
                let stale = sides.side[at] != CUT
                    || self.moved[at] == self.pass
                    || gain != self.gain(graph, vertex, to)
                    || (to != lighter && sides.weight[to] + graph.weights[at] > limit);
                if !stale {
                    if best.is_none_or(|(most, ..)| gain > most) {
                        best = Some((gain, vertex, to));
                    }
                    break;
                }
                self.moves[to].pop();
            }
        }
        let (_, vertex, to) = best?;
        self.moves[to].pop();
        Some((vertex, to))
    }

    /// Moves a vertex from the separator to a side, and its neighbours of the other side into the separator.
    fn shift(&mut self, graph: &Graph, sides: &mut Sides, vertex: u32, to: usize) {
        let from = 1 - to;
        self.log.push((vertex, CUT));
        self.moved[vertex as usize] = self.pass;
        sides.put(graph, vertex, to as u8);
        for &other in graph.around(vertex) {
            match sides.side[other as usize] {
                CUT => {
                    self.pulled[other as usize][to] += graph.weights[vertex as usize];
                    self.offer(graph, other, from);
                }
                side if side as usize == from => {
                    self.log.push((other, side));
                    sides.put(graph, other, CUT);
                    for &next in graph.around(other) {
                        if sides.side[next as usize] == CUT && next != other {
                            let pulled = &mut self.pulled[next as usize][from];
                            *pulled = pulled.saturating_sub(graph.weights[other as usize]);
                            self.offer(graph, next, to);
                        }
                    }
                    self.enter(graph, sides, other);
                }
                _ => {}
            }
        }
    }
}

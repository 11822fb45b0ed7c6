//! Graphs with weights, and coarser ones of them.

use crate::watch::{Pulse, Stopped};

/// Not one of the vertices at hand.
pub(super) const NONE: u32 = u32::MAX;

/// A graph in which a vertex and an edge may stand for many.
#[derive(Debug, Default)]
pub(super) struct Graph {
    /// Where each vertex's neighbours start, and where the last one's end.
    pub offsets: Vec<u32>,
    pub neighbours: Vec<u32>,
    /// How many edges each of `neighbours` stands for.
    pub edges: Vec<u32>,
    /// How many rows each vertex stands for.
    pub weights: Vec<u32>,
}

impl Graph {
    pub(super) fn len(&self) -> usize {
        self.weights.len()
    }

    fn range(&self, vertex: u32) -> std::ops::Range<usize> {
        self.offsets[vertex as usize] as usize..self.offsets[vertex as usize + 1] as usize
    }

    pub(super) fn around(&self, vertex: u32) -> &[u32] {
        &self.neighbours[self.range(vertex)]
    }

    fn weighted(&self, vertex: u32) -> impl Iterator<Item = (u32, u32)> {
        let range = self.range(vertex);
        self.neighbours[range.clone()].iter().copied().zip(self.edges[range].iter().copied())
    }

    /// The graph between these rows, which are numbered as they come. `place` is all none, before and after.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn part(
        offsets: &[u32],
        neighbours: &[u32],
        rows: &[u32],
        place: &mut [u32],
        pulse: &Pulse,
    ) -> Result<Self, Stopped> {
        for (at, &row) in (0..).zip(rows) {
            place[row as usize] = at;
        }
        pulse.beat(2 * rows.len())?;
        let mut part = Self { offsets: Vec::with_capacity(rows.len() + 1), ..Self::default() };
        part.offsets.push(0);
        part.neighbours.reserve(6 * rows.len());
        for &row in rows {
            let around = &neighbours[offsets[row as usize] as usize..offsets[row as usize + 1] as usize];
            part.neighbours.extend(around.iter().map(|&other| place[other as usize]).filter(|&at| at != NONE));
            part.offsets.push(part.neighbours.len() as u32);
            pulse.beat(10 + 3 * around.len())?;
        }
        for &row in rows {
            place[row as usize] = NONE;
        }
        part.edges = vec![1; part.neighbours.len()];
        part.weights = vec![1; rows.len()];
        pulse.beat(4 * rows.len())?;
        Ok(part)
    }

    /// A graph of pairs of neighbours that many edges join, and for each vertex the one that stands for it there.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn coarser(&self, heaviest: u32, pulse: &Pulse) -> Result<(Self, Vec<u32>), Stopped> {
        let n = self.len();
        let mut place = vec![NONE; n];
        let mut pairs: Vec<[u32; 2]> = Vec::with_capacity(n);
        for vertex in 0..n as u32 {
            if place[vertex as usize] != NONE {
                continue;
            }
            let own = self.weights[vertex as usize];
            let (mut most, mut mate) = (0, vertex);
            for (other, edges) in self.weighted(vertex) {
                let fits = || place[other as usize] == NONE && own + self.weights[other as usize] <= heaviest;
                if edges > most && fits() {
                    (most, mate) = (edges, other);
                }
            }
            place[vertex as usize] = pairs.len() as u32;
            place[mate as usize] = pairs.len() as u32;
            pairs.push([vertex, mate]);
            pulse.beat(30)?;
        }
        let mut coarse = Self {
            offsets: Vec::with_capacity(pairs.len() + 1),
            neighbours: Vec::with_capacity(self.neighbours.len() * 3 / 4),
            edges: Vec::with_capacity(self.neighbours.len() * 3 / 4),
            weights: Vec::with_capacity(pairs.len()),
        };
        coarse.offsets.push(0);
        let mut found = vec![NONE; pairs.len()];
        for (at, &[first, second]) in (0_u32..).zip(&pairs) {
            let start = coarse.neighbours.len() as u32;
            // Nothing is an edge from a vertex to itself.
            found[at as usize] = start;
            let mut weight = 0;
            for vertex in [first, second].into_iter().take(1 + usize::from(first != second)) {
                weight += self.weights[vertex as usize];
                for (other, edges) in self.weighted(vertex) {
                    let other = place[other as usize];
                    if other == at {
                        continue;
                    }
                    let known = found[other as usize];
                    if known != NONE && known >= start {
                        coarse.edges[known as usize] += edges;
                    } else {
                        found[other as usize] = coarse.neighbours.len() as u32;
                        coarse.neighbours.push(other);
                        coarse.edges.push(edges);
                    }
                }
            }
            coarse.offsets.push(coarse.neighbours.len() as u32);
            coarse.weights.push(weight);
            pulse.beat(60)?;
        }
        Ok((coarse, place))
    }
}

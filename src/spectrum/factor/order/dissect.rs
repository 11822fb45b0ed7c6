//! Large graphs are cut into parts before the parts are ordered.
//!
//! Approximate minimum degree is the better order up to some 50 000 rows, but it cannot be interrupted, and its fill
//! grows faster than that of a dissection (George 1973). A part that is too large is cut at a level of a breadth-first
//! search from one of its ends, a short one near the middle: the rows of the cut come after those of both sides.

use super::minimum_degree;
use crate::watch::{Pulse, Stopped};

/// Parts of so many rows are not cut further.
const LARGEST: usize = 55_000;

/// What is to be done with rows.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    /// To be cut if they are many.
    Open,
    /// To be ordered, however many they are.
    Whole,
    /// To be put down as they are.
    Cut,
}

/// Not in the part at hand.
const OUT: u32 = u32::MAX;

/// In the part, but not reached yet.
const WAITING: u32 = u32::MAX - 1;

/// A fill-reducing order, as the list of old indices, or `None` when memory or indices run out.
///
/// # Errors
/// When the watch cancels.
pub(super) fn order(offsets: &[usize], neighbours: &[u32], pulse: &Pulse) -> Result<Option<Vec<u32>>, Stopped> {
    order_by(LARGEST, offsets, neighbours, pulse)
}

fn order_by(largest: usize, offsets: &[usize], neighbours: &[u32], pulse: &Pulse) -> Result<Option<Vec<u32>>, Stopped> {
    let n = offsets.len() - 1;
    let graph = Graph { offsets, neighbours };
    if n <= largest {
        return Ok(minimum_degree(n, offsets, neighbours));
    }
    let mut order: Vec<u32> = Vec::with_capacity(n);
    let mut level = vec![OUT; n];
    // Parts that wait, and cuts, which are put down when both of their sides are.
    let mut waiting: Vec<(Vec<u32>, Kind)> = vec![((0..n as u32).collect(), Kind::Open)];
    while let Some((mut part, kind)) = waiting.pop() {
        if kind == Kind::Cut {
            order.extend(part);
        } else if part.len() <= largest || kind == Kind::Whole {
            pulse.ask()?;
            // Ascending, so that the part's lists of neighbours are.
            pulse.sort(&mut part, &Ord::cmp)?;
            let (offsets, neighbours) = graph.part(&part, &mut level);
            pulse.ask()?;
            let Some(inner) = minimum_degree(part.len(), &offsets, &neighbours) else { return Ok(None) };
            order.extend(inner.into_iter().map(|at| part[at as usize]));
            pulse.ask()?;
        } else {
            let Some([low, cut, high]) = graph.cut(&part, &mut level, pulse)? else {
                graph.pieces(&part, largest, &mut level, &mut waiting, pulse)?;
                continue;
            };
            // A graph without levels, such as a complete one, has no short cuts.
            if 16 * low.len().min(high.len()) < part.len() {
                waiting.push((part, Kind::Whole));
                continue;
            }
            waiting.push((cut, Kind::Cut));
            waiting.push((high, Kind::Open));
            waiting.push((low, Kind::Open));
        }
    }
    Ok(Some(order))
}

struct Graph<'a> {
    offsets: &'a [usize],
    neighbours: &'a [u32],
}

impl Graph<'_> {
    fn around(&self, row: u32) -> &[u32] {
        &self.neighbours[self.offsets[row as usize]..self.offsets[row as usize + 1]]
    }

    /// The graph of a part. `place` is all out, before and after.
    fn part(&self, part: &[u32], place: &mut [u32]) -> (Vec<usize>, Vec<u32>) {
        for (at, &row) in (0..).zip(part) {
            place[row as usize] = at;
        }
        let mut offsets = Vec::with_capacity(part.len() + 1);
        let mut neighbours = Vec::with_capacity(6 * part.len());
        offsets.push(0);
        for &row in part {
            neighbours.extend(self.around(row).iter().map(|&other| place[other as usize]).filter(|&at| at != OUT));
            offsets.push(neighbours.len());
        }
        for &row in part {
            place[row as usize] = OUT;
        }
        (offsets, neighbours)
    }

    /// Two sides that are not neighbours of each other, and what is between them; none where the part is in pieces.
    /// `level` is all out, before and after.
    fn cut(&self, part: &[u32], level: &mut [u32], pulse: &Pulse) -> Result<Option<[Vec<u32>; 3]>, Stopped> {
        let mut reached = Vec::with_capacity(part.len());
        let mut start = part[0];
        // Of the last rows of a search one is nearly as far away as there are any; the third search is from there.
        for _ in 0..3 {
            for &row in part {
                level[row as usize] = WAITING;
            }
            reached.clear();
            reached.push(start);
            level[start as usize] = 0;
            let mut next = 0;
            while let Some(&row) = reached.get(next) {
                next += 1;
                for &other in self.around(row) {
                    if level[other as usize] == WAITING {
                        level[other as usize] = level[row as usize] + 1;
                        reached.push(other);
                    }
                }
                pulse.beat(40)?;
            }
            start = reached.last().copied().unwrap_or(start);
        }
        pulse.ask()?;
        let sides = (reached.len() == part.len()).then(|| self.cut_level(&reached, level));
        pulse.ask()?;
        for &row in part {
            level[row as usize] = OUT;
        }
        Ok(sides)
    }

    /// The connected pieces of a part: large ones alone, small ones together.
    fn pieces(
        &self,
        part: &[u32],
        largest: usize,
        level: &mut [u32],
        found: &mut Vec<(Vec<u32>, Kind)>,
        pulse: &Pulse,
    ) -> Result<(), Stopped> {
        for &row in part {
            level[row as usize] = WAITING;
        }
        let mut small = Vec::new();
        for &start in part {
            if level[start as usize] != WAITING {
                continue;
            }
            level[start as usize] = OUT;
            let mut piece = vec![start];
            let mut next = 0;
            while let Some(&row) = piece.get(next) {
                next += 1;
                for &other in self.around(row) {
                    if level[other as usize] == WAITING {
                        level[other as usize] = OUT;
                        piece.push(other);
                    }
                }
                pulse.beat(40)?;
            }
            if piece.len() > largest {
                found.push((piece, Kind::Open));
            } else {
                if small.len() + piece.len() > largest {
                    found.push((std::mem::take(&mut small), Kind::Whole));
                }
                small.extend(piece);
            }
        }
        found.push((small, Kind::Whole));
        Ok(())
    }

    /// Cuts rows that are sorted by their levels.
    fn cut_level(&self, reached: &[u32], level: &[u32]) -> [Vec<u32>; 3] {
        // The level that costs least: a short one, or a longer one nearer to the middle.
        let mut best = (f64::INFINITY, 0);
        let mut before = 0;
        for rows in reached.chunk_by(|&a, &b| level[a as usize] == level[b as usize]) {
            let after = reached.len() - before - rows.len();
            let lesser = before.min(after) as f64 / reached.len() as f64;
            let cost = rows.len() as f64 / (lesser * (1.0 - lesser)).powf(0.75);
            if lesser > 0.0 && cost < best.0 {
                best = (cost, level[rows[0] as usize]);
            }
            before += rows.len();
        }
        let at = best.1;
        let (mut low, mut cut, mut high) = (Vec::new(), Vec::new(), Vec::new());
        for &row in reached {
            let own = level[row as usize];
            let side = if own > at {
                &mut high
            } else if own < at
                || self.around(row).iter().all(|&other| level[other as usize] <= at || level[other as usize] == OUT)
            {
                &mut low
            } else {
                &mut cut
            };
            side.push(row);
        }
        [low, cut, high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::Unwatched;

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

    fn check(n: usize, edges: &[(u32, u32)]) -> Vec<u32> {
        let (offsets, neighbours) = graph(n, edges);
        let order = order_by(40, &offsets, &neighbours, &Pulse::new(&Unwatched)).unwrap().unwrap();
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..n as u32), "every row once");
        order
    }

    #[test]
    fn every_row_is_ordered_once_and_a_cut_parts_its_sides() {
        let (width, height) = (40, 25);
        let mut edges = Vec::new();
        for at in 0..width * height {
            edges.extend((at % width + 1 < width).then_some((at, at + 1)));
            edges.extend((at + width < width * height).then_some((at, at + width)));
        }
        let order = check((width * height) as usize, &edges);
        // The last cut: what is left without it falls into parts of less than two thirds.
        let (offsets, neighbours) = graph(order.len(), &edges);
        let mut level = vec![OUT; order.len()];
        let graph = Graph { offsets: &offsets, neighbours: &neighbours };
        let [low, cut, high] = graph.cut(&order, &mut level, &Pulse::new(&Unwatched)).unwrap().unwrap();
        assert!(low.len().max(high.len()) < 700 && cut.len() <= 25, "{} {} {}", low.len(), cut.len(), high.len());
        assert!(low.iter().all(|&row| graph.around(row).iter().all(|other| !high.contains(other))));
        assert!(level.iter().all(|&level| level == OUT));
    }

    #[test]
    fn graphs_without_short_cuts_or_in_pieces_are_ordered_too() {
        let complete: Vec<(u32, u32)> = (0..90).flat_map(|a| (0..a).map(move |b| (a, b))).collect();
        check(90, &complete);
        let star: Vec<(u32, u32)> = (1..200).map(|at| (0, at)).collect();
        check(200, &star);
        check(100, &[]);
        let bristles: Vec<(u32, u32)> = (1..500).map(|at| (at % 7, at)).filter(|(a, b)| a != b).collect();
        check(500, &bristles);
        let pieces: Vec<(u32, u32)> = (0..300).filter(|at| at % 75 != 74).map(|at| (at, at + 1)).collect();
        check(300, &pieces);
    }
}

//! Approximate minimum degree (Amestoy, Davis and Duff 1996) of rows that are eliminated in stages.
//!
//! Rows of a later stage count in the degrees, so the order within a part of a dissection knows what surrounds it.

use super::coarse::NONE;
use crate::watch::{Pulse, Stopped};

/// Rows and what became of those that are eliminated: elements, each of which joins its rows to each other.
struct Quotient<'a> {
    /// Where the list of each row starts: its elements, then its rows.
    start: &'a [u32],
    lists: Vec<u32>,
    /// How many elements and how many rows are in a list.
    elements: Vec<u32>,
    others: Vec<u32>,
    /// How many rows of equal patterns each stands for; none once it is eliminated or another stands for it.
    rows: Vec<u32>,
    /// About how many rows a row is joined to.
    degree: Vec<u32>,
    /// The rows that each element joins, and how many rows they stand for; none once it is part of another.
    joined: Vec<Vec<u32>>,
    size: Vec<u32>,
    /// The rows that one stands for, as chains, and their ends.
    next: Vec<u32>,
    last: Vec<u32>,
}

/// Rows by their degrees.
struct Buckets {
    first: Vec<u32>,
    next: Vec<u32>,
    before: Vec<u32>,
    least: usize,
}

impl Buckets {
    fn insert(&mut self, row: u32, degree: u32) {
        let first = std::mem::replace(&mut self.first[degree as usize], row);
        self.next[row as usize] = first;
        self.before[row as usize] = NONE;
        if first != NONE {
            self.before[first as usize] = row;
        }
        self.least = self.least.min(degree as usize);
    }

    fn remove(&mut self, row: u32, degree: u32) {
        let (before, next) = (self.before[row as usize], self.next[row as usize]);
        match before {
            NONE => self.first[degree as usize] = next,
            _ => self.next[before as usize] = next,
        }
        if next != NONE {
            self.before[next as usize] = before;
        }
    }

    fn pop(&mut self) -> Option<(u32, u32)> {
        while let Some(&row) = self.first.get(self.least) {
            if row != NONE {
                self.remove(row, self.least as u32);
                return Some((row, self.least as u32));
            }
            self.least += 1;
        }
        None
    }
}

/// The order as the list of old indices. `stages` are to be complete and disjoint.
///
/// # Errors
/// When the watch cancels.
pub(super) fn minimum_degree(
    offsets: &[u32],
    neighbours: &[u32],
    stages: &[Vec<u32>],
    pulse: &Pulse,
) -> Result<Vec<u32>, Stopped> {
    let n = offsets.len() - 1;
    let others: Vec<u32> = offsets.windows(2).map(|at| at[1] - at[0]).collect();
    // Rows that are joined to very many come last; each elimination would go through their lists.
    let dense = (10.0 * (n as f64).sqrt()).max(16.0) as u32;
    let mut stage = vec![0; n];
    for (at, rows) in (0_u32..).zip(stages) {
        for &row in rows {
            stage[row as usize] = at;
        }
    }
    let mut late = Vec::new();
    let mut rows = vec![1; n];
    for row in 0..n {
        if others[row] > dense {
            rows[row] = 0;
            late.push(row as u32);
        }
    }
    let mut left = (n - late.len()) as u32;
    let mut quotient = Quotient {
        start: offsets,
        lists: neighbours.to_vec(),
        elements: vec![0; n],
        degree: others.clone(),
        others,
        rows,
        joined: vec![Vec::new(); n],
        size: vec![0; n],
        next: vec![NONE; n],
        last: (0..n as u32).collect(),
    };
    let mut buckets = Buckets { first: vec![NONE; n + 1], next: vec![NONE; n], before: vec![NONE; n], least: 0 };
    let mut memory = Memory {
        step: 0,
        inside: vec![0; n],
        seen: vec![0; n],
        beyond: vec![0; n],
        first: vec![(0, NONE); n],
        chain: vec![NONE; n],
        hash: vec![0; n],
        tag: 0,
        tagged: vec![0; n],
    };
    let mut order = Vec::with_capacity(n);
    for (now, list) in (0_u32..).zip(stages) {
        for &row in list {
            if quotient.rows[row as usize] > 0 {
                buckets.insert(row, quotient.degree[row as usize]);
            }
        }
        pulse.beat(20 * list.len())?;
        while let Some((pivot, _)) = buckets.pop() {
            let work = quotient.eliminate(pivot, now, &stage, &mut left, &mut buckets, &mut memory);
            let mut at = pivot;
            while at != NONE {
                order.push(at);
                at = quotient.next[at as usize];
            }
            pulse.beat(100 + 4 * work)?;
        }
        buckets.least = 0;
    }
    order.extend(late);
    Ok(order)
}

/// What an elimination needs to remember.
struct Memory {
    step: u32,
    /// The last step in which a row was joined, or an element was seen.
    inside: Vec<u32>,
    seen: Vec<u32>,
    /// The rows of an element that the new one does not join.
    beyond: Vec<u32>,
    /// Rows of this step by the sums of their lists.
    first: Vec<(u32, u32)>,
    chain: Vec<u32>,
    hash: Vec<u32>,
    /// What is in the list at hand.
    tag: u32,
    tagged: Vec<u32>,
}

impl Quotient<'_> {
    /// Eliminates a row; tells how many entries of lists it went through.
    fn eliminate(
        &mut self,
        pivot: u32,
        now: u32,
        stage: &[u32],
        left: &mut u32,
        buckets: &mut Buckets,
        memory: &mut Memory,
    ) -> usize {
        memory.step += 1;
        let step = memory.step;
        let mut joined = self.join(pivot, step, &mut memory.inside);
        let mut size: u32 = joined.iter().map(|&row| self.rows[row as usize]).sum();
        *left -= self.rows[pivot as usize];
        self.rows[pivot as usize] = 0;
        let mut work = joined.len();
        for &row in &joined {
            if stage[row as usize] == now {
                buckets.remove(row, self.degree[row as usize]);
            }
            let start = self.start[row as usize] as usize;
            work += (self.elements[row as usize] + self.others[row as usize]) as usize;
            for &element in &self.lists[start..start + self.elements[row as usize] as usize] {
                let at = element as usize;
                if memory.seen[at] != step {
                    memory.seen[at] = step;
                    memory.beyond[at] = self.size[at];
                }
                // Dead ones have no size.
                memory.beyond[at] = memory.beyond[at].saturating_sub(self.rows[row as usize]);
            }
        }
        for &row in &joined {
            let (hash, beyond) = self.renew(row, pivot, step, memory);
            let own = self.rows[row as usize];
            if beyond == 0 {
                // Nothing but the new element: it can be eliminated at once.
                size -= own;
                *left -= own;
                self.take(pivot, row);
                continue;
            }
            let degree = &mut self.degree[row as usize];
            *degree = beyond.min(*degree);
            self.unite(row, hash, stage, memory);
        }
        joined.retain(|&row| self.rows[row as usize] > 0);
        for &row in &joined {
            let own = self.rows[row as usize];
            let degree = (self.degree[row as usize] + size - own).min(*left - own);
            self.degree[row as usize] = degree;
            if stage[row as usize] == now {
                buckets.insert(row, degree);
            }
        }
        self.size[pivot as usize] = size;
        self.joined[pivot as usize] = joined;
        work
    }

    /// The rows that a pivot joins.
    fn join(&mut self, pivot: u32, step: u32, inside: &mut [u32]) -> Vec<u32> {
        let start = self.start[pivot as usize] as usize;
        let (elements, others) = (self.elements[pivot as usize] as usize, self.others[pivot as usize] as usize);
        inside[pivot as usize] = step;
        let mut joined = Vec::new();
        let mut add = |row: u32| {
            if self.rows[row as usize] > 0 && inside[row as usize] != step {
                inside[row as usize] = step;
                joined.push(row);
            }
        };
        for &element in &self.lists[start..start + elements] {
            std::mem::take(&mut self.joined[element as usize]).into_iter().for_each(&mut add);
            self.size[element as usize] = 0;
        }
        self.lists[start + elements..start + elements + others].iter().for_each(|&row| add(row));
        joined
    }

    /// Brings the list of a row up to date; returns a sum over it, and how many rows it is joined to otherwise.
    fn renew(&mut self, row: u32, pivot: u32, step: u32, memory: &Memory) -> (u32, u32) {
        let start = self.start[row as usize] as usize;
        let (elements, others) = (self.elements[row as usize] as usize, self.others[row as usize] as usize);
        let (mut hash, mut beyond) = (pivot, 0);
        let mut end = start;
        for at in start..start + elements {
            let element = self.lists[at];
            if self.size[element as usize] == 0 {
                continue;
            }
            let more = memory.beyond[element as usize];
            if more == 0 {
                // All its rows are in the new element.
                self.size[element as usize] = 0;
                self.joined[element as usize] = Vec::new();
                continue;
            }
            beyond += more;
            hash = hash.wrapping_add(element);
            self.lists[end] = element;
            end += 1;
        }
        let middle = end;
        for at in start + elements..start + elements + others {
            let other = self.lists[at];
            if self.rows[other as usize] > 0 && memory.inside[other as usize] != step {
                beyond += self.rows[other as usize];
                hash = hash.wrapping_add(other);
                self.lists[end] = other;
                end += 1;
            }
        }
        // The pivot or one of its elements was in the list, so there is room.
        self.lists[end] = self.lists[middle];
        self.lists[middle] = pivot;
        self.elements[row as usize] = (middle + 1 - start) as u32;
        self.others[row as usize] = (end - middle) as u32;
        (hash, beyond)
    }

    /// Lets a row stand for another.
    fn take(&mut self, row: u32, other: u32) {
        self.rows[other as usize] = 0;
        let end = self.last[other as usize];
        let last = std::mem::replace(&mut self.last[row as usize], end);
        self.next[last as usize] = other;
    }

    /// Lets a row of this step with the same list stand for a row, if there is one.
    fn unite(&mut self, row: u32, hash: u32, stage: &[u32], memory: &mut Memory) {
        let key = hash as usize % memory.first.len();
        let (at, first) = memory.first[key];
        let mut other = if at == memory.step { first } else { NONE };
        memory.chain[row as usize] = other;
        memory.hash[row as usize] = hash;
        memory.first[key] = (memory.step, row);
        let list = |quotient: &Self, row: u32| {
            let start = quotient.start[row as usize] as usize;
            start..start + (quotient.elements[row as usize] + quotient.others[row as usize]) as usize
        };
        let mut marked = false;
        while other != NONE {
            let alike = self.rows[other as usize] > 0
                && memory.hash[other as usize] == hash
                && stage[other as usize] == stage[row as usize]
                && self.elements[other as usize] == self.elements[row as usize]
                && self.others[other as usize] == self.others[row as usize];
            if alike {
                if !marked {
                    marked = true;
                    memory.tag += 1;
                    for &entry in &self.lists[list(self, row)] {
                        memory.tagged[entry as usize] = memory.tag;
                    }
                }
                if self.lists[list(self, other)].iter().all(|&entry| memory.tagged[entry as usize] == memory.tag) {
                    let degree = self.degree[row as usize].min(self.degree[other as usize]);
                    let own = self.rows[row as usize];
                    self.rows[other as usize] += own;
                    self.degree[other as usize] = degree;
                    self.take(other, row);
                    return;
                }
            }
            other = memory.chain[other as usize];
        }
    }
}

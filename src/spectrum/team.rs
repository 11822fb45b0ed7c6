//! Several threads at one mesh: the owner of the solve, and others that help.
//!
//! The shifts of a chain are placed one after the other, which takes a factorisation each; the processes at them are
//! ten times dearer, and run at once; before it ends, each waits for what the one below it has seen. What is made of
//! them is joined in the order of the chain, so that every band is the same bits as on one thread. Which bands belong
//! to the answer is decided by the rule that one thread follows; what was solved beyond them is dropped.

use std::{
    collections::VecDeque,
    sync::{
        Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    time::Duration,
};

use super::{
    SpectrumError,
    band::Band,
    part::{End, Ending, Piece, Shift, Tools},
    poll::Poll,
    slice::{Side, Sides},
    timings::Timings,
};
use crate::watch::Watch;

mod ending;
mod work;

#[cfg(test)]
mod tests;

/// How long a thread without work waits before it looks around again.
const NAP: Duration = Duration::from_millis(2);

/// One solve, for all threads that work at it.
#[derive(Debug)]
pub(super) struct Team {
    pieces: Vec<Piece>,
    /// All eigenvalues of the small pieces.
    small: Option<Band>,
    /// How many eigenvalues are wanted.
    count: usize,
    state: Mutex<State>,
    changed: Condvar,
    /// Nothing is wanted any more.
    over: AtomicBool,
}

#[derive(Debug)]
struct State {
    /// By piece.
    chains: Vec<Chain>,
    /// Numbers slots.
    next: u64,
    helpers: usize,
    /// What helpers have spent.
    timings: Timings,
}

/// The chain of one piece.
#[derive(Debug)]
struct Chain {
    /// Finished bands, in order.
    bands: Vec<Band>,
    /// How many of them belong to the answer, as far as is known.
    needed: usize,
    /// For each band the right side of its upper shift, where it is known.
    rights: Vec<Option<Side>>,
    /// The answer ends in the next band that is needed, unless the count there says otherwise.
    ending: Option<Stop>,
    /// After so many bands the count has said otherwise.
    endless: usize,
    /// The shifts above, in order.
    slots: VecDeque<Slot>,
    /// A thread is placing the next shift.
    placing: bool,
    /// Where the next shift is to be tried, after it had to move.
    again: Option<(f64, u32)>,
    /// Where the chain ends for want of a certificate.
    failed: Option<f64>,
}

/// Where the answer ends, and whether a thread is counting there.
#[derive(Debug, Clone, Copy)]
struct Stop {
    at: Ending,
    counting: bool,
}

/// A process.
#[derive(Debug)]
struct Slot {
    number: u64,
    at: Place,
    stage: Stage,
}

#[derive(Debug, Clone, Copy)]
enum Place {
    /// A shift of the chain.
    Shift(Shift),
    /// The last shift of the known bands, once more for its right side.
    Again,
    /// There is no shift.
    Nowhere,
}

#[derive(Debug)]
enum Stage {
    /// For any thread to run.
    Open,
    Running,
    Done(Sides),
    /// Its band is being made.
    Making,
    Failed(f64),
}

/// What a thread does next.
enum Work {
    /// Place a shift at the end of a chain, then run its process.
    Place(usize, End, Option<(f64, u32)>),
    /// Run the process of a slot.
    Run(usize, u64, Place),
    /// Make the next band of what the processes at its ends saw.
    Make(usize, u64, Place, Sides, Side),
    /// Count where the answer ends.
    End(usize, Ending),
}

/// How a solve stands.
enum Standing {
    Going,
    Done,
    Failed(f64),
}

impl Chain {
    fn counted(&self) -> usize {
        self.bands.last().map_or(0, |band| band.above)
    }

    /// Where the last placed shift is, and how many eigenvalues are below it.
    fn placed(&self, unit: f64) -> (f64, usize) {
        let last = self.slots.iter().rev().find_map(|slot| match slot.at {
            Place::Shift(shift) => Some((shift.upper * unit, shift.above)),
            Place::Again | Place::Nowhere => None,
        });
        last.unwrap_or_else(|| (self.bands.last().map_or(0.0, |band| band.upper), self.counted()))
    }

    /// Where the first of its bands that are not needed yet begins; none when all eigenvalues are known.
    fn frontier(&self, piece: &Piece) -> Option<f64> {
        let last = self.needed.checked_sub(1).map(|last| &self.bands[last]);
        let finished = last.is_some_and(|last| last.above == piece.pencil.order());
        (!finished).then(|| last.map_or(0.0, |last| last.upper))
    }

    /// What is seen on the right of its first bands.
    fn right(&self, bands: usize) -> Option<&Side> {
        bands.checked_sub(1).and_then(|last| self.rights[last].as_ref())
    }

    fn take(&mut self, number: u64) -> Option<usize> {
        self.slots.iter().position(|slot| slot.number == number)
    }
}

impl Team {
    /// A solve of these pieces; `known` are bands that need not be solved again.
    pub(super) fn new(pieces: Vec<Piece>, small: Option<Band>, count: usize, known: &[Band]) -> Self {
        let chains = pieces
            .iter()
            .map(|piece| {
                let bands = piece.taken_over(known);
                let needed = bands.len();
                Chain {
                    rights: vec![None; needed],
                    bands,
                    needed,
                    ending: None,
                    endless: 0,
                    slots: VecDeque::new(),
                    placing: false,
                    again: None,
                    failed: None,
                }
            })
            .collect();
        let state = State { chains, next: 0, helpers: 0, timings: Timings::default() };
        let (changed, over) = (Condvar::new(), AtomicBool::new(false));
        let team = Self { pieces, small, count, state: Mutex::new(state), changed, over };
        team.drop_early();
        team
    }

    /// Drops known bands that end early, unless they are enough: no chain goes on from there.
    fn drop_early(&self) {
        let mut state = self.state();
        if matches!(self.judge(&mut state).0, Standing::Done) {
            return;
        }
        for chain in &mut state.chains {
            chain.bands.retain(|band| !band.early);
            chain.needed = chain.bands.len();
            chain.rights.truncate(chain.needed);
        }
    }

    /// Rows of the largest piece.
    pub(super) fn rows(&self) -> usize {
        self.pieces.iter().map(|piece| piece.pencil.order()).max().unwrap_or(0)
    }

    /// The dimensions of the pieces' kernels.
    pub(super) fn kernels(&self) -> usize {
        self.pieces.iter().map(|piece| piece.pencil.kernel).sum()
    }

    /// The bands of the answer, once they are there. The watch learns how many eigenvalues are certified so far, and
    /// `keep` of all bands that are finished when there is a new one.
    ///
    /// # Errors
    /// When the watch cancels, or when the certificate cannot be had.
    pub(super) fn lead(
        &self,
        tools: &mut Tools,
        poll: &mut Poll,
        watch: &dyn Watch,
        keep: &dyn Fn(&[Band]),
    ) -> Result<Vec<Band>, SpectrumError> {
        let over = Over(self);
        let mut kept = None;
        let outcome = loop {
            let mut state = self.state();
            let (standing, done) = self.judge(&mut state);
            let bands: usize = state.chains.iter().map(|chain| chain.bands.len()).sum();
            // Fewer when what was solved beyond the end is dropped.
            if kept.is_none_or(|kept| bands > kept) {
                let all = kept.is_some().then(|| self.bands(&state, |chain| chain.bands.len()));
                kept = Some(bands);
                drop(state);
                watch.progress(done.min(self.count), self.count);
                if let Some(all) = all {
                    keep(&all);
                }
                state = self.state();
            }
            match standing {
                Standing::Going => {}
                Standing::Done => break Ok(self.bands(&state, |chain| chain.needed)),
                Standing::Failed(at) => {
                    let finished = self.bands(&state, |chain| chain.bands.len());
                    break Err(SpectrumError::Uncertified { at, finished });
                }
            }
            let cancelled = if let Some(work) = self.next(&mut state) {
                drop(state);
                self.work(work, tools, poll).is_err()
            } else {
                drop(self.changed.wait_timeout(state, NAP).unwrap_or_else(PoisonError::into_inner));
                watch.cancelled()
            };
            if cancelled {
                let state = self.state();
                break Err(SpectrumError::Cancelled { finished: self.bands(&state, |chain| chain.bands.len()) });
            }
        };
        drop(over);
        poll.meter.timings.add(&self.state().timings);
        outcome
    }

    /// Helps until there is nothing to do at the moment, or the helper is wanted elsewhere. Returns whether it did
    /// anything.
    pub(super) fn help(&self, tools: &mut Tools, leave: &dyn Watch) -> bool {
        struct Both<'a>(&'a AtomicBool, &'a dyn Watch);
        impl Watch for Both<'_> {
            fn cancelled(&self) -> bool {
                self.0.load(Ordering::Relaxed) || self.1.cancelled()
            }
        }
        let watch = Both(&self.over, leave);
        let mut helped = false;
        self.state().helpers += 1;
        while !watch.cancelled() {
            let mut state = self.state();
            self.judge(&mut state);
            let Some(work) = self.next(&mut state) else { break };
            drop(state);
            helped = true;
            let mut poll = Poll::new(&watch);
            let outcome = self.work(work, tools, &mut poll);
            self.state().timings.add(&poll.meter.timings);
            if outcome.is_err() {
                break;
            }
        }
        self.state().helpers -= 1;
        helped
    }

    /// How many help.
    pub(super) fn helpers(&self) -> usize {
        self.state().helpers
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Bands of the answer so far: of the small pieces, and those that a chain has up to here.
    fn bands(&self, state: &State, count: impl Fn(&Chain) -> usize) -> Vec<Band> {
        self.small.iter().chain(state.chains.iter().flat_map(|chain| &chain.bands[..count(chain)])).cloned().collect()
    }

    /// Follows the rule that one thread follows, as far as there are bands: while too few eigenvalues are certified,
    /// that chain goes on which has come least far. Returns how many are certified.
    fn judge(&self, state: &mut State) -> (Standing, usize) {
        loop {
            // Below what is known of every piece that is not finished.
            let chains = state.chains.iter().zip(&self.pieces).enumerate();
            let ends = chains.filter_map(|(at, (chain, piece))| chain.frontier(piece).map(|end| (end, at)));
            let lowest = ends.min_by(|a, b| a.0.total_cmp(&b.0));
            let limit = lowest.map_or(f64::MAX, |lowest| lowest.0);
            let bands = state.chains.iter().flat_map(|chain| &chain.bands[..chain.needed]).chain(&self.small);
            let below = bands.map(|band| {
                if band.upper <= limit {
                    band.values.len()
                } else {
                    band.values.partition_point(|&value| value <= limit)
                }
            });
            let done = below.sum::<usize>();
            let Some((_, at)) = lowest.filter(|_| done < self.count) else { return (Standing::Done, done) };
            let ending = self.ending(state, at);
            let chain = &mut state.chains[at];
            if let Some(at) = ending {
                chain.ending.get_or_insert(Stop { at, counting: false });
                return (Standing::Going, done);
            } else if chain.bands.len() > chain.needed {
                chain.needed += 1;
            } else if let Some(failed) = chain.failed {
                return (Standing::Failed(failed), done);
            } else {
                return (Standing::Going, done);
            }
        }
    }

    /// What there is to do now, and notes that it is being done.
    fn next(&self, state: &mut State) -> Option<Work> {
        for (at, chain) in state.chains.iter_mut().enumerate() {
            if let Some(stop) = &mut chain.ending {
                if stop.counting {
                    continue;
                }
                stop.counting = true;
                return Some(Work::End(at, stop.at));
            }
            if let Some(slot) = chain.slots.front_mut() {
                match std::mem::replace(&mut slot.stage, Stage::Making) {
                    Stage::Done(sides) => {
                        let (number, place) = (slot.number, slot.at);
                        let right = chain.right(chain.bands.len()).cloned().unwrap_or_default();
                        return Some(Work::Make(at, number, place, sides, right));
                    }
                    Stage::Failed(failed) => {
                        chain.failed = Some(failed);
                        chain.slots.clear();
                        continue;
                    }
                    other => slot.stage = other,
                }
            }
            if let Some(slot) = chain.slots.iter_mut().find(|slot| matches!(slot.stage, Stage::Open)) {
                slot.stage = Stage::Running;
                return Some(Work::Run(at, slot.number, slot.at));
            }
        }
        self.next_shift(state)
    }

    /// The chain that has come least far goes on, if its bands will be needed.
    fn next_shift(&self, state: &mut State) -> Option<Work> {
        let placed: Vec<(f64, usize)> =
            state.chains.iter().zip(&self.pieces).map(|(chain, piece)| chain.placed(piece.unit)).collect();
        let (at, limit) = (0..placed.len())
            .filter(|&at| placed[at].1 < self.pieces[at].pencil.order())
            .map(|at| (at, placed[at].0))
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        let chain = &state.chains[at];
        let expected = self.expected(state, limit);
        // What the last process sees on its right side may be the end.
        let perhaps =
            if chain.slots.is_empty() { 0 } else { (0.5 * self.pieces[at].aims().above(placed[at].1)) as usize };
        if chain.failed.is_some() || chain.ending.is_some() || chain.placing || expected + perhaps >= self.count {
            return None;
        }
        let State { chains, next, .. } = state;
        let chain = &mut chains[at];
        if chain.slots.is_empty() && !chain.bands.is_empty() && chain.right(chain.bands.len()).is_none() {
            *next += 1;
            chain.slots.push_back(Slot { number: *next, at: Place::Again, stage: Stage::Running });
            return Some(Work::Run(at, *next, Place::Again));
        }
        let end = self.end_of(at, chain)?;
        chain.placing = true;
        Some(Work::Place(at, end, chain.again.take()))
    }

    /// How many eigenvalues up to here will be certified by the shifts that were placed.
    fn expected(&self, state: &State, limit: f64) -> usize {
        let mut sum = 0.0;
        for (chain, piece) in state.chains.iter().zip(&self.pieces) {
            for band in &chain.bands {
                sum += band.values.partition_point(|&value| value <= limit) as f64;
            }
            for slot in &chain.slots {
                let Place::Shift(shift) = slot.at else { continue };
                let (lower, upper, count) = shift.span();
                let share = ((limit / piece.unit - lower) / (upper - lower)).clamp(0.0, 1.0);
                sum += share * count as f64;
            }
        }
        let small = self.small.iter().map(|band| band.values.partition_point(|&value| value <= limit)).sum::<usize>();
        sum as usize + small
    }
}

/// Sends the helpers away.
struct Over<'a>(&'a Team);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.over.store(true, Ordering::Relaxed);
    }
}

//! What a thread does for a team, and how it gives that up.

use std::sync::PoisonError;

use super::{NAP, Place, Slot, Stage, State, Team, Work};
use crate::spectrum::{
    part::{Advance, End, Shift, Tools},
    poll::Poll,
    slice::{Side, Sides},
};

impl Team {
    /// Does it. An error says that the thread was cancelled; another one can then do it.
    pub(super) fn work(&self, work: Work, tools: &mut Tools, poll: &mut Poll) -> Result<(), Advance> {
        let mut undo = Undo { team: self, what: None };
        tools.largest = tools.largest.max(self.rows());
        match work {
            Work::Place(at, end, again) => {
                undo.what = Some(Undone::Place(at, again));
                let placed = self.pieces[at].place(&end, again, tools, poll);
                let (place, stage) = match placed {
                    Ok(shift) => (Place::Shift(shift), Stage::Running),
                    Err(Advance::Uncertified { at }) => (Place::Nowhere, Stage::Failed(at)),
                    Err(other) => return Err(other),
                };
                undo.what = None;
                let mut state = self.state();
                let State { chains, next, .. } = &mut *state;
                let chain = &mut chains[at];
                chain.placing = false;
                // The shift before it may have moved in the meantime.
                if chain.again.is_some() || self.end_of(at, chain).is_none_or(|now| !now.is(&end)) {
                    return Ok(());
                }
                *next += 1;
                let number = *next;
                chain.slots.push_back(Slot { number, at: place, stage });
                drop(state);
                self.changed.notify_all();
                let Place::Shift(shift) = place else { return Ok(()) };
                undo.what = Some(Undone::Run(at, number));
                let looked = self.look(at, number, &shift, tools, poll);
                self.store(at, number, looked, &mut undo)
            }
            Work::Run(at, number, place) => {
                undo.what = Some(Undone::Run(at, number));
                let looked = match place {
                    Place::Shift(shift) => {
                        let returned = self.pieces[at].return_to(&shift, tools, poll);
                        returned.and_then(|()| self.look(at, number, &shift, tools, poll))
                    }
                    Place::Again => {
                        let bands = self.state().chains[at].bands.clone();
                        self.pieces[at].resume(&bands, tools, poll)
                    }
                    Place::Nowhere => return Ok(()),
                };
                self.store(at, number, looked, &mut undo)
            }
            Work::Make(at, number, place, sides, right) => {
                undo.what = Some(Undone::Make(at, number, sides));
                self.make(at, place, &right, tools, poll, &mut undo)
            }
            Work::End(at, ending) => {
                undo.what = Some(Undone::End(at));
                self.end_at(at, ending, tools, poll, &mut undo)
            }
        }
    }

    /// Runs the process of a slot, at a shift whose factor is in the tools.
    fn look(
        &self,
        at: usize,
        number: u64,
        shift: &Shift,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<Sides, Advance> {
        self.pieces[at].look(shift, self.count, &mut |poll| self.seen(at, number, poll), tools, poll)
    }

    /// What is seen on the right side of the process before a slot. Waits for it while another thread runs that.
    ///
    /// # Errors
    /// When cancelled, or when no thread runs that process: this thread might be the only one.
    fn seen(&self, at: usize, number: u64, poll: &Poll) -> Result<usize, Advance> {
        loop {
            let mut state = self.state();
            let chain = &mut state.chains[at];
            let Some(place) = chain.take(number) else { return Err(Advance::Deferred) };
            let Some(before) = place.checked_sub(1) else {
                return Ok(chain.right(chain.bands.len()).map_or(0, |right| right.found.len()));
            };
            match &chain.slots[before].stage {
                Stage::Done(sides) => return Ok(sides.right.found.len()),
                // The chain ends there, and what is above it will be dropped.
                Stage::Failed(_) => return Ok(0),
                Stage::Running | Stage::Making => {}
                Stage::Open => return Err(Advance::Deferred),
            }
            drop(self.changed.wait_timeout(state, NAP).unwrap_or_else(PoisonError::into_inner));
            if poll.watch().cancelled() {
                return Err(Advance::Cancelled);
            }
        }
    }

    /// Where the chain goes on at the moment.
    pub(super) fn end_of(&self, at: usize, chain: &super::Chain) -> Option<End> {
        match chain.slots.back().map(|slot| slot.at) {
            Some(Place::Shift(shift)) => Some(shift.end()),
            Some(Place::Nowhere) => None,
            Some(Place::Again) | None => Some(self.pieces[at].end(&chain.bands)),
        }
    }

    /// Puts what a process saw into its slot.
    fn store(
        &self,
        at: usize,
        number: u64,
        looked: Result<Sides, Advance>,
        undo: &mut Undo<'_>,
    ) -> Result<(), Advance> {
        let stage = match looked {
            Ok(sides) => Some(Stage::Done(sides)),
            Err(Advance::TooNear) => None,
            Err(Advance::Uncertified { at }) => Some(Stage::Failed(at)),
            Err(Advance::Cancelled) => return Err(Advance::Cancelled),
            // Giving it up opens the slot again.
            Err(Advance::Deferred) => return Ok(()),
        };
        undo.what = None;
        let mut state = self.state();
        let chain = &mut state.chains[at];
        // Gone when a shift before it had to move.
        if let Some(place) = chain.take(number) {
            if let Some(stage) = stage {
                chain.slots[place].stage = stage;
            } else if let Place::Shift(shift) = chain.slots[place].at {
                chain.slots.truncate(place);
                chain.again = Some(shift.moved());
            } else {
                chain.slots[place].stage = Stage::Failed(chain.placed(self.pieces[at].unit).0);
            }
        }
        drop(state);
        self.changed.notify_all();
        Ok(())
    }

    /// Makes the band of the first slot of a chain; `right` is what is seen from its lower end.
    fn make(
        &self,
        at: usize,
        place: Place,
        right: &Side,
        tools: &mut Tools,
        poll: &mut Poll,
        undo: &mut Undo<'_>,
    ) -> Result<(), Advance> {
        let made = match (place, &undo.what) {
            (Place::Shift(shift), Some(Undone::Make(_, _, sides))) => {
                self.pieces[at].band(&shift, right, &sides.left, tools, poll).map(Some)
            }
            _ => Ok(None),
        };
        if matches!(made, Err(Advance::Cancelled)) {
            return Err(Advance::Cancelled);
        }
        let Some(Undone::Make(_, number, Sides { right, .. })) = undo.what.take() else { return Ok(()) };
        let mut state = self.state();
        let chain = &mut state.chains[at];
        // Gone when the chain has ended before it.
        if chain.slots.pop_front_if(|slot| slot.number == number).is_none() {
            return Ok(());
        }
        match made {
            Ok(Some(band)) => {
                chain.bands.push(band);
                chain.rights.push(Some(right));
            }
            Ok(None) => {
                if let Some(last) = chain.rights.last_mut() {
                    *last = Some(right);
                }
            }
            Err(error) => {
                chain.failed = Some(match error {
                    Advance::Uncertified { at } => at,
                    Advance::TooNear | Advance::Deferred | Advance::Cancelled => chain.placed(self.pieces[at].unit).0,
                });
                chain.slots.clear();
            }
        }
        drop(state);
        self.changed.notify_all();
        Ok(())
    }
}

/// Gives up what a thread was at, unless it is done: it was cancelled, or it panicked.
pub(super) struct Undo<'a> {
    team: &'a Team,
    pub(super) what: Option<Undone>,
}

pub(super) enum Undone {
    Place(usize, Option<(f64, u32)>),
    Run(usize, u64),
    Make(usize, u64, Sides),
    End(usize),
}

impl Drop for Undo<'_> {
    fn drop(&mut self) {
        let Some(what) = self.what.take() else { return };
        let mut state = self.team.state();
        match what {
            Undone::Place(at, again) => {
                let chain = &mut state.chains[at];
                chain.placing = false;
                chain.again = chain.again.or(again);
            }
            Undone::Run(at, number) => {
                let chain = &mut state.chains[at];
                if let Some(place) = chain.take(number) {
                    chain.slots[place].stage = Stage::Open;
                }
            }
            Undone::End(at) => {
                if let Some(stop) = &mut state.chains[at].ending {
                    stop.counting = false;
                }
            }
            Undone::Make(at, number, sides) => {
                if let Some(slot) = state.chains[at].slots.front_mut().filter(|slot| slot.number == number) {
                    slot.stage = Stage::Done(sides);
                }
            }
        }
        drop(state);
        self.team.changed.notify_all();
    }
}

//! What a thread does for a team, and how it gives that up.

use super::{Place, Slot, Stage, State, Team, Work};
use crate::spectrum::{
    part::{Advance, End, Tools},
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
                let looked = self.pieces[at].look(&shift, self.count, tools, poll);
                self.store(at, number, looked, &mut undo)
            }
            Work::Run(at, number, place) => {
                undo.what = Some(Undone::Run(at, number));
                let piece = &self.pieces[at];
                let looked = match place {
                    Place::Shift(shift) => {
                        piece.return_to(&shift, tools, poll).and_then(|()| piece.look(&shift, self.count, tools, poll))
                    }
                    Place::Again => {
                        let bands = self.state().chains[at].bands.clone();
                        piece.resume(&bands, tools, poll)
                    }
                    Place::Nowhere => return Ok(()),
                };
                self.store(at, number, looked, &mut undo)
            }
            Work::Make(at, place, sides, right) => {
                undo.what = Some(Undone::Make(at, sides, right));
                self.make(at, place, tools, poll, &mut undo)
            }
        }
    }

    /// Where the chain goes on at the moment.
    fn end_of(&self, at: usize, chain: &super::Chain) -> Option<End> {
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

    /// Makes the band of the first slot of a chain.
    fn make(
        &self,
        at: usize,
        place: Place,
        tools: &mut Tools,
        poll: &mut Poll,
        undo: &mut Undo<'_>,
    ) -> Result<(), Advance> {
        let made = match (place, &undo.what) {
            (Place::Shift(shift), Some(Undone::Make(_, sides, right))) => {
                self.pieces[at].band(&shift, right, &sides.left, tools, poll).map(Some)
            }
            _ => Ok(None),
        };
        if matches!(made, Err(Advance::Cancelled)) {
            return Err(Advance::Cancelled);
        }
        let right = match undo.what.take() {
            Some(Undone::Make(_, sides, _)) => Some(sides.right),
            _ => None,
        };
        let mut state = self.state();
        let chain = &mut state.chains[at];
        chain.slots.pop_front();
        match made {
            Ok(band) => {
                chain.bands.extend(band);
                chain.right = right;
            }
            Err(error) => {
                chain.failed = Some(match error {
                    Advance::Uncertified { at } => at,
                    Advance::TooNear | Advance::Cancelled => chain.placed(self.pieces[at].unit).0,
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
struct Undo<'a> {
    team: &'a Team,
    what: Option<Undone>,
}

enum Undone {
    Place(usize, Option<(f64, u32)>),
    Run(usize, u64),
    Make(usize, Sides, Side),
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
            Undone::Make(at, sides, right) => {
                let chain = &mut state.chains[at];
                chain.right = Some(right);
                if let Some(slot) = chain.slots.front_mut() {
                    slot.stage = Stage::Done(sides);
                }
            }
        }
        drop(state);
        self.team.changed.notify_all();
    }
}

//! Where the answer ends: above the last shift, without a process of its own.

use super::{State, Team, work::Undo};
use crate::spectrum::{
    part::{Advance, Ending, Tools},
    poll::Poll,
};

impl Team {
    /// Where the answer ends if it is what is certified up to there of the lowest chain, by what the process at the end
    /// of its bands saw on its right side. Of the gaps between eigenvalues where that may be it is the widest.
    pub(super) fn ending(&self, state: &State, at: usize) -> Option<Ending> {
        let (chain, piece) = (&state.chains[at], &self.pieces[at]);
        let found = &chain.right(chain.needed).filter(|_| chain.endless != chain.needed)?.found;
        let others = || state.chains.iter().zip(&self.pieces).enumerate().filter(|(other, _)| *other != at);
        let limit = others().filter_map(|(_, (chain, piece))| chain.frontier(piece)).fold(f64::MAX, f64::min);
        let mine = chain.needed.checked_sub(1).map_or(0, |last| chain.bands[last].above);
        let below = |lambda: f64| {
            let bands = others().flat_map(|(_, (chain, _))| &chain.bands[..chain.needed]).chain(&self.small);
            bands.map(|band| band.values.partition_point(|&value| value <= lambda)).sum::<usize>()
        };
        let spacing = found.last()?.value - found.first()?.value;
        let (least, mut best) = (0.02 * spacing / found.len() as f64, None);
        for (before, pair) in found.windows(2).enumerate() {
            let (sigma, count) = (0.5 * (pair[0].value + pair[1].value), before + 1);
            let gap = pair[1].value - pair[1].near - pair[0].value - pair[0].near;
            let enough = mine + count + below(sigma * piece.unit) >= self.count && sigma * piece.unit <= limit;
            if enough && gap > best.map_or(least, |(widest, _)| widest) {
                best = Some((gap, Ending { sigma, count }));
            }
        }
        best.map(|(_, ending)| ending)
    }

    /// Counts where the answer ends, and ends the chain there if that is as many as were seen.
    pub(super) fn end_at(
        &self,
        at: usize,
        ending: Ending,
        tools: &mut Tools,
        poll: &mut Poll,
        undo: &mut Undo<'_>,
    ) -> Result<(), Advance> {
        let (bands, right) = {
            let state = self.state();
            let chain = &state.chains[at];
            (chain.bands[..chain.needed].to_vec(), chain.right(chain.needed).cloned().unwrap_or_default())
        };
        let ended = self.pieces[at].ended(&bands, &right, ending, tools, poll)?;
        undo.what = None;
        let mut state = self.state();
        let chain = &mut state.chains[at];
        chain.ending = None;
        if let Some(band) = ended {
            // What others have solved beyond it depends on how many they are.
            chain.bands.truncate(chain.needed);
            chain.rights.truncate(chain.needed);
            chain.slots.clear();
            chain.bands.push(band);
            chain.rights.push(None);
            chain.needed += 1;
        } else {
            chain.endless = chain.needed;
        }
        drop(state);
        self.changed.notify_all();
        Ok(())
    }
}

//! Looking at the watch often enough, but not more.

use super::timings::{Cost, Meter};
use crate::watch::Watch;

/// Why a kernel came back without a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stop {
    /// The result is no longer wanted.
    Cancelled,
    /// A pivot of the factorisation was zero or not finite.
    Pivot,
}

/// Asks the watch once per so many multiplications: about every millisecond, where they wait for memory.
pub(super) struct Poll<'a> {
    watch: &'a dyn Watch,
    spent: usize,
    pub meter: Meter,
}

impl std::fmt::Debug for Poll<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Poll").field("spent", &self.spent).finish_non_exhaustive()
    }
}

impl<'a> Poll<'a> {
    const BUDGET: usize = 1 << 21;

    pub(super) fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, spent: 0, meter: Meter::start() }
    }

    /// What it asks.
    pub(super) fn watch(&self) -> &'a dyn Watch {
        self.watch
    }

    /// Charges the time since the last charge to a part of the work.
    pub(super) fn charge(&mut self, cost: Cost) {
        self.meter.charge(cost);
    }

    /// Notes work that was done or is about to be done, in multiplications.
    #[inline]
    pub(super) fn spend(&mut self, multiplications: usize) -> Result<(), Stop> {
        self.spent += multiplications;
        if self.spent < Self::BUDGET {
            return Ok(());
        }
        self.spent = 0;
        if self.watch.cancelled() { Err(Stop::Cancelled) } else { Ok(()) }
    }
}

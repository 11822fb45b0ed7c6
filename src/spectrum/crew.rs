//! Threads that help with the solves of other threads.

use std::{
    sync::{
        Arc, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use super::{part::Tools, team::Team};
use crate::watch::Watch;

/// How long a helper without work waits before it looks around again.
const NAP: Duration = Duration::from_millis(2);

/// Scratch memory is kept for the next mesh where the largest one has had no more rows: then it is about 40 MB.
const KEPT: usize = 12_000;

/// A mesh of this many times fewer rows begins anew rather than hold on to it.
const WASTED: usize = 3;

/// Lets threads that have nothing else to do take part in the solves of others, mesh by mesh of a data set or many
/// threads at one mesh, and keeps the threads' scratch memory from one mesh to the next.
///
/// A solve that is [given](super::Request::crew) a crew can be helped by any thread that calls [`Crew::help`]. Its
/// result is the same bits as without. Memory is bounded by the number of threads that solve or help.
#[derive(Debug, Default)]
pub struct Crew {
    open: Mutex<Vec<Arc<Team>>>,
    tools: Mutex<Vec<Tools>>,
}

impl Crew {
    /// Helps with the solves that are under way, and with those that begin, until `leave` cancels; then it returns
    /// within 50 ms.
    pub fn help(&self, leave: &dyn Watch) {
        let mut tools = None;
        while !leave.cancelled() {
            // To the one with the fewest helpers, the oldest of these.
            let team = self.open().iter().min_by_key(|team| team.helpers()).map(Arc::clone);
            let helped = team.is_some_and(|team| team.help(tools.get_or_insert_with(|| self.take(team.rows())), leave));
            if !helped {
                thread::sleep(NAP);
            }
        }
        if let Some(tools) = tools {
            self.give_back(tools);
        }
    }

    /// Runs `work` while so many threads in all are at the solves that it begins with this crew.
    pub fn with<T>(&self, threads: usize, work: impl FnOnce() -> T) -> T {
        struct Flag(AtomicBool);
        impl Watch for Flag {
            fn cancelled(&self) -> bool {
                self.0.load(Ordering::Relaxed)
            }
        }
        /// Set also when the work panics.
        struct Ends<'a>(&'a Flag);
        impl Drop for Ends<'_> {
            fn drop(&mut self) {
                self.0.0.store(true, Ordering::Relaxed);
            }
        }
        let over = Flag(AtomicBool::new(false));
        thread::scope(|scope| {
            let _ends = Ends(&over);
            for _ in 1..threads {
                // With fewer threads than were asked for it takes longer.
                let _ = thread::Builder::new().name("helper".into()).spawn_scoped(scope, || self.help(&over));
            }
            work()
        })
    }

    pub(super) fn open(&self) -> MutexGuard<'_, Vec<Arc<Team>>> {
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn tools(&self) -> MutexGuard<'_, Vec<Tools>> {
        self.tools.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Scratch memory for so many rows, of an earlier solve if there is any: the least that suffices, else the most
    /// there is. What is far too much is freed.
    pub(super) fn take(&self, rows: usize) -> Tools {
        let mut tools = self.tools();
        let nearest = (0..tools.len()).min_by_key(|&at| {
            let largest = tools[at].largest;
            (largest < rows, largest.abs_diff(rows))
        });
        let found = nearest.map(|at| tools.swap_remove(at));
        drop(tools);
        found.filter(|found| found.largest / WASTED <= rows).unwrap_or_default()
    }

    /// Frees all scratch memory that no solve has. Returns whether there was any.
    pub fn rest(&self) -> bool {
        let idle = std::mem::take(&mut *self.tools());
        !idle.is_empty()
    }

    /// Keeps scratch memory for later.
    pub(super) fn give_back(&self, tools: Tools) {
        if tools.largest <= KEPT {
            self.tools().push(tools);
        }
    }

    /// Lets others help with a solve, until what is returned is dropped.
    pub(super) fn opens(&self, team: &Arc<Team>) -> Opened<'_> {
        self.open().push(Arc::clone(team));
        Opened { crew: self, team: Arc::clone(team) }
    }
}

/// A solve that others can help with.
pub(super) struct Opened<'a> {
    crew: &'a Crew,
    team: Arc<Team>,
}

impl Drop for Opened<'_> {
    fn drop(&mut self) {
        self.crew.open().retain(|team| !Arc::ptr_eq(team, &self.team));
    }
}

//! The threads that read and solve, outside of the database's revisions.
//!
//! The pool has a list of wanted jobs. A new list cancels what is no longer wanted and leaves alone what still is, so
//! turning a knob that needs the same spectra costs them nothing.

use std::{
    collections::VecDeque,
    panic::{AssertUnwindSafe, catch_unwind},
    path::PathBuf,
    sync::{
        Arc, Condvar, Mutex, MutexGuard, PoisonError,
        atomic::{AtomicBool, AtomicUsize, Ordering},
    },
    thread::JoinHandle,
    time::{Duration, Instant},
};

use super::{
    Problem, Stage, heap,
    library::{Examined, Facts, Failure, FileAt, Found, Library, Missing},
    stamp::Stamp,
};
use crate::{mesh::Format, watch::Watch};

/// The nice value of polite threads: of a core they share with the screen's thread they get a tenth.
#[cfg(target_os = "linux")]
const NICE: i32 = 10;

/// One model's spectrum, from its file.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Job {
    pub(crate) path: PathBuf,
    pub(crate) format: Format,
    pub(crate) stamp: Option<Stamp>,
    pub(crate) problem: Problem,
    pub(crate) count: usize,
}

/// What the pool tells of a job. `list` is the list it was wanted by, `slot` its place there.
#[derive(Debug)]
pub(crate) struct News {
    pub(crate) list: u64,
    pub(crate) slot: usize,
    pub(crate) what: What,
}

#[derive(Debug)]
pub(crate) enum What {
    /// The mesh has been read.
    Read(Arc<Facts>),
    /// So many of the eigenvalues are there.
    Progress { done: usize, total: usize },
    /// The job is finished, or failed at a stage.
    Done { facts: Option<Arc<Facts>>, found: Result<Found, (Stage, Failure)> },
}

/// Receives the news, on the pool's threads. It must not wait, nor call the pool.
pub(crate) type Listener = Arc<dyn Fn(News) + Send + Sync>;

struct Running {
    job: Job,
    slot: usize,
    list: u64,
    cancel: Arc<AtomicBool>,
}

#[derive(Default)]
struct Wanted {
    list: u64,
    waiting: VecDeque<(usize, Job)>,
    running: Vec<Option<Running>>,
    closed: bool,
}

struct Shared {
    wanted: Mutex<Wanted>,
    changed: Condvar,
    /// Jobs that have ended since there was last nothing to do.
    ended: AtomicUsize,
    library: Library,
    listener: Listener,
}

/// Jobs after which free memory is given back: often enough to keep it small beside what is in use.
const BATCH: usize = 8;

impl Shared {
    fn wanted(&self) -> MutexGuard<'_, Wanted> {
        self.wanted.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The pool. Dropping it cancels everything and waits for the threads (at most the kernels' 50 ms).
pub(crate) struct Pool {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
}

impl Pool {
    /// Starts `threads` threads. Where somebody sits in front of the screen they are `polite`: they leave the
    /// processor to whoever has to answer at once.
    pub(crate) fn start(threads: usize, polite: bool, library: Library, listener: Listener) -> Self {
        let threads = threads.max(1);
        let mut wanted = Wanted::default();
        wanted.running.resize_with(threads, || None);
        let shared = Arc::new(Shared {
            wanted: Mutex::new(wanted),
            changed: Condvar::new(),
            ended: AtomicUsize::new(0),
            library,
            listener,
        });
        let threads = (0..threads)
            .filter_map(|thread| {
                let shared = Arc::clone(&shared);
                let body = move || {
                    if polite {
                        give_way();
                    }
                    work(&shared, thread);
                };
                std::thread::Builder::new().name(format!("solver-{thread}")).spawn(body).ok()
            })
            .collect();
        Self { shared, threads }
    }

    /// How many threads it has.
    pub(crate) fn size(&self) -> usize {
        self.threads.len()
    }

    /// Replaces the list of wanted jobs; the first is begun first. Returns the list's number.
    pub(crate) fn want(&self, jobs: Vec<(usize, Job)>) -> u64 {
        let mut wanted = self.shared.wanted();
        wanted.list += 1;
        let list = wanted.list;
        let mut waiting: VecDeque<_> = jobs.into();
        for running in wanted.running.iter_mut().flatten() {
            if let Some(at) = waiting.iter().position(|(_, job)| *job == running.job)
                && !running.cancel.load(Ordering::Relaxed)
            {
                running.slot = waiting[at].0;
                running.list = list;
                waiting.remove(at);
            } else {
                running.cancel.store(true, Ordering::Relaxed);
            }
        }
        wanted.waiting = waiting;
        drop(wanted);
        self.shared.changed.notify_all();
        list
    }
}

impl Drop for Pool {
    fn drop(&mut self) {
        self.want(Vec::new());
        self.shared.wanted().closed = true;
        self.shared.changed.notify_all();
        for thread in self.threads.drain(..) {
            let _ = thread.join();
        }
    }
}

/// Lowers this thread's priority. On Linux a thread has a nice value of its own; elsewhere it would be the whole
/// process that gives way, so there nothing is done.
fn give_way() {
    #[cfg(target_os = "linux")]
    {
        // Refused by nobody; and were it, the thread would only be less polite.
        let _ = rustix::process::setpriority_process(None, NICE);
    }
}

fn work(shared: &Shared, thread: usize) {
    loop {
        let (job, cancel) = {
            let mut wanted = shared.wanted();
            loop {
                if wanted.closed {
                    return;
                }
                if let Some((slot, job)) = wanted.waiting.pop_front() {
                    let cancel = Arc::new(AtomicBool::new(false));
                    let list = wanted.list;
                    wanted.running[thread] =
                        Some(Running { job: job.clone(), slot, list, cancel: Arc::clone(&cancel) });
                    break (job, cancel);
                }
                // No model is left to begin: it helps with those that others are at.
                if wanted.running.iter().any(Option::is_some) {
                    drop(wanted);
                    shared.library.crew().help(&Idle(shared));
                    wanted = shared.wanted();
                    continue;
                }
                // There is nothing to solve: what is kept for the next mesh is not needed either. Threads that helped
                // with the last one come here later than the one that solved it.
                let freed = shared.library.crew().rest();
                if shared.ended.swap(0, Ordering::Relaxed) > 0 || freed {
                    drop(wanted);
                    heap::give_back();
                    wanted = shared.wanted();
                    continue;
                }
                wanted = shared.changed.wait(wanted).unwrap_or_else(PoisonError::into_inner);
            }
        };
        let eye = Eye { shared, thread, cancel: &cancel, told: Mutex::new(Instant::now()) };
        let mut facts = None;
        // A defect of ours in one mesh's solve must not end the run: it becomes that model's reason.
        let found = catch_unwind(AssertUnwindSafe(|| solve(shared, &job, &eye, &mut facts))).unwrap_or_else(|panic| {
            let what = panic.downcast_ref::<&str>().copied();
            let what = what.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
            Err((Stage::Spectrum, Missing::Failed(format!("internal error, please report it: {what}").into())))
        });
        let found = match found {
            Ok(found) => Some(Ok(found)),
            Err((stage, Missing::Failed(reason))) => Some(Err((stage, reason))),
            Err((_, Missing::Unread(reason))) => Some(Err((Stage::Content, reason))),
            Err((_, Missing::Cancelled)) => None,
        };
        // Under the lock, so that a new list finds the job either still running or finished for the old list.
        let mut wanted = shared.wanted();
        if let (Some(running), Some(found)) = (wanted.running[thread].take(), found) {
            (shared.listener)(News { list: running.list, slot: running.slot, what: What::Done { facts, found } });
        }
        drop(wanted);
        if (shared.ended.fetch_add(1, Ordering::Relaxed) + 1).is_multiple_of(BATCH) {
            heap::give_back();
        }
    }
}

fn solve(shared: &Shared, job: &Job, eye: &Eye<'_>, facts: &mut Option<Arc<Facts>>) -> Result<Found, (Stage, Missing)> {
    let stamp = job.stamp.ok_or_else(|| (Stage::Content, Missing::Unread("the file is gone".into())))?;
    let Examined { content, facts: known, mesh } = shared.library.examine(&job.path, job.format, stamp, eye)?;
    let file = FileAt { path: &job.path, format: job.format, content };
    *facts = Some(Arc::clone(&known));
    eye.tell(What::Read(Arc::clone(&known)));
    let found = shared.library.spectrum(file, (&known, mesh), job.problem, job.count, eye);
    found.map_err(|missing| (Stage::Spectrum, missing))
}

/// Cancels when there is something better to do than to help, or nothing to help with.
struct Idle<'a>(&'a Shared);

impl Watch for Idle<'_> {
    fn cancelled(&self) -> bool {
        let wanted = self.0.wanted();
        wanted.closed || !wanted.waiting.is_empty() || wanted.running.iter().all(Option::is_none)
    }
}

/// Watches one job.
struct Eye<'a> {
    shared: &'a Shared,
    thread: usize,
    cancel: &'a AtomicBool,
    told: Mutex<Instant>,
}

impl Eye<'_> {
    fn tell(&self, what: What) {
        let wanted = self.shared.wanted();
        if let Some(running) = &wanted.running[self.thread] {
            (self.shared.listener)(News { list: running.list, slot: running.slot, what });
        }
    }
}

impl Watch for Eye<'_> {
    fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    fn progress(&self, done: usize, total: usize) {
        {
            let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
            if told.elapsed() < Duration::from_millis(100) {
                return;
            }
            *told = Instant::now();
        }
        self.tell(What::Progress { done, total });
    }
}

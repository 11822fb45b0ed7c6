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
    library::{Facts, Failure, FileAt, Found, Library, Missing},
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

impl Job {
    /// How much memory it takes to solve, beside others of its list: files of a data set are of like kinds, and what is
    /// re-meshed is all of one size.
    fn size(&self) -> f64 {
        if self.problem.remesh.is_some() { 1.0 } else { self.stamp.map_or(0.0, |stamp| stamp.bytes() as f64) }
    }
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
    /// Sizes of running jobs should not add up to more, so that the largest are not all solved at once.
    budget: f64,
    closed: bool,
}

/// So many of the waiting jobs are looked at for one that fits beside those that run.
const AHEAD: usize = 16;

/// How much more than they have on average the running jobs may have together. Tried on the sizes and costs of SHREC
/// 2007: with less, the large ones are left over and meet at the end.
const SLACK: f64 = 1.2;

impl Wanted {
    /// Sees to the budget of a new list. Time goes with size, so that a job that runs has on average the mean of sizes
    /// weighted by themselves.
    fn plan(&mut self) {
        let jobs = self.waiting.iter().map(|(_, job)| job).chain(self.running.iter().flatten().map(|run| &run.job));
        let (sum, squares) =
            jobs.map(Job::size).fold((0.0, 0.0), |(sum, squares), size| (sum + size, squares + size * size));
        self.budget = if sum > 0.0 { SLACK * self.running.len() as f64 * squares / sum } else { 0.0 };
    }

    /// Takes the next job: of the first few the first that fits beside those that run, else the smallest.
    fn next(&mut self) -> Option<(usize, Job)> {
        let left = self.budget - self.running.iter().flatten().map(|run| run.job.size()).sum::<f64>();
        let sizes: Vec<f64> = self.waiting.iter().take(AHEAD).map(|(_, job)| job.size()).collect();
        let fits = sizes.iter().position(|size| *size <= left);
        let at = fits.or_else(|| (0..sizes.len()).min_by(|a, b| sizes[*a].total_cmp(&sizes[*b])))?;
        self.waiting.remove(at)
    }
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

    /// Replaces the list of wanted jobs. They are begun in its order, but for large ones, which wait for each other.
    /// Returns the list's number.
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
        wanted.plan();
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
                if let Some((slot, job)) = wanted.next() {
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
    let (content, known) = shared.library.examine(&job.path, job.format, stamp, eye)?;
    let file = FileAt { path: &job.path, format: job.format, content };
    *facts = Some(Arc::clone(&known));
    eye.tell(What::Read(Arc::clone(&known)));
    shared.library.spectrum(file, &known, job.problem, job.count, eye).map_err(|missing| (Stage::Spectrum, missing))
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::Choice;

    /// A list of files of these sizes, on so many threads.
    fn wanted(sizes: &[u64], threads: usize) -> Wanted {
        let folder = tempfile::tempdir().unwrap();
        let job = |(slot, &size): (usize, &u64)| {
            let path = folder.path().join(slot.to_string());
            std::fs::File::create(&path).unwrap().set_len(size).unwrap();
            let (stamp, problem) = (Stamp::of(&path), Choice::default().into());
            (slot, Job { path, format: Format::Off, stamp, problem, count: 1 })
        };
        let mut wanted = Wanted { waiting: sizes.iter().enumerate().map(job).collect(), ..Wanted::default() };
        wanted.running.resize_with(threads, || None);
        wanted.plan();
        wanted
    }

    /// Lets a thread begin the next job; gives its place in the list.
    fn begin(wanted: &mut Wanted, thread: usize) -> Option<usize> {
        wanted.running[thread] = None;
        let (slot, job) = wanted.next()?;
        let (list, cancel) = (wanted.list, Arc::default());
        wanted.running[thread] = Some(Running { job, slot, list, cancel });
        Some(slot)
    }

    #[test]
    fn jobs_of_one_size_are_begun_in_their_order() {
        let mut wanted = wanted(&[10; 9], 3);
        let begun: Vec<usize> = (0..9).filter_map(|at| begin(&mut wanted, at % 3)).collect();
        assert_eq!(begun, (0..9).collect::<Vec<_>>());
        assert_eq!(begin(&mut wanted, 0), None);
    }

    #[test]
    fn large_jobs_wait_for_each_other_as_long_as_there_are_others() {
        // On average a running job has (2 · 90² + 6 · 10²) / 240 = 70, two and some slack 168: 90 and 90 are too many.
        let mut wanted = wanted(&[90, 90, 10, 10, 10, 10, 10, 10], 2);
        assert_eq!([0, 1, 1, 1].map(|thread| begin(&mut wanted, thread)), [Some(0), Some(2), Some(3), Some(4)]);
        assert_eq!(begin(&mut wanted, 0), Some(1), "the first large one is done");
        assert_eq!([1, 1, 1, 1].map(|thread| begin(&mut wanted, thread)), [Some(5), Some(6), Some(7), None]);
    }

    #[test]
    fn what_does_not_fit_is_begun_where_nothing_else_is_left() {
        let mut wanted = wanted(&[90, 10, 10, 10, 10, 10, 10, 90], 2);
        assert_eq!(begin(&mut wanted, 0), Some(0));
        let begun: Vec<usize> = (1..8).filter_map(|_| begin(&mut wanted, 1)).collect();
        assert_eq!(begun, (1..8).collect::<Vec<_>>());
    }
}

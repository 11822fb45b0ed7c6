//! How a long computation tells its progress and learns that its answer is no longer wanted.
//!
//! Kernels take a `&dyn Watch` and poll it at least every few milliseconds of work. They know nothing of threads,
//! databases or screens.

/// An observer of one long computation.
pub trait Watch: Sync {
    /// True once the result is no longer wanted; the kernel then returns its `Cancelled` error within 50 ms.
    fn cancelled(&self) -> bool {
        false
    }

    /// `done` of `total` units are finished. The unit is the kernel's own (eigenvalues, models, …).
    fn progress(&self, done: usize, total: usize) {
        let _ = (done, total);
    }
}

/// Watches nothing: never cancels, ignores progress.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Watch for Unwatched {}

/// Cancels everything from the first.
#[cfg(test)]
pub(crate) struct Unwanted;

#[cfg(test)]
impl Watch for Unwanted {
    fn cancelled(&self) -> bool {
        true
    }
}

/// Cancels for good after so many looks, and counts them.
#[cfg(test)]
#[derive(Debug)]
pub(crate) struct Patience {
    looks: std::sync::atomic::AtomicUsize,
    granted: usize,
}

#[cfg(test)]
impl Patience {
    /// Lets so many looks pass.
    pub(crate) const fn of(granted: usize) -> Self {
        Self { looks: std::sync::atomic::AtomicUsize::new(0), granted }
    }

    /// How often it was looked at.
    pub(crate) fn looks(&self) -> usize {
        self.looks.load(std::sync::atomic::Ordering::Relaxed)
    }
}

#[cfg(test)]
impl Watch for Patience {
    fn cancelled(&self) -> bool {
        self.looks.fetch_add(1, std::sync::atomic::Ordering::Relaxed) >= self.granted
    }
}

/// Hears of a cancellation as another watch does, but keeps the progress from it: that of a part, in another unit.
#[derive(Clone, Copy)]
pub struct Silent<'a>(pub &'a dyn Watch);

impl Watch for Silent<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

/// The watch said so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Stopped;

/// Asks a watch once per so much work: about every two milliseconds.
pub struct Pulse<'a> {
    watch: &'a dyn Watch,
    spent: std::cell::Cell<usize>,
}

impl<'a> Pulse<'a> {
    /// In nanoseconds, about.
    const BUDGET: usize = 2_000_000;

    /// A pulse of this watch.
    #[must_use]
    pub fn new(watch: &'a dyn Watch) -> Self {
        Self { watch, spent: std::cell::Cell::new(0) }
    }

    /// Notes work that was done or is about to be done, in nanoseconds, about.
    ///
    /// # Errors
    /// When the watch has cancelled.
    #[inline]
    pub fn beat(&self, nanoseconds: usize) -> Result<(), Stopped> {
        let spent = self.spent.get() + nanoseconds;
        self.spent.set(spent);
        if spent < Self::BUDGET { Ok(()) } else { self.ask() }
    }

    /// Asks now.
    ///
    /// # Errors
    /// When the watch has cancelled.
    #[cold]
    pub fn ask(&self) -> Result<(), Stopped> {
        self.spent.set(0);
        if self.watch.cancelled() { Err(Stopped) } else { Ok(()) }
    }

    /// Sorts items of which no two are equal, or equal ones are the same.
    ///
    /// # Errors
    /// When the watch has cancelled; the items are then in some order.
    pub fn sort<T>(&self, items: &mut [T], compare: &impl Fn(&T, &T) -> std::cmp::Ordering) -> Result<(), Stopped> {
        if self.sorted(items, compare)? {
            return Ok(());
        }
        if items.len() <= Self::RUN {
            items.sort_unstable_by(compare);
            return self.beat(60 * items.len());
        }
        let mut middle = self.part(items, compare)?;
        if 16 * middle.min(items.len() - middle) < items.len() {
            // The sample was no likeness of the items.
            middle = items.len() / 2;
            items.select_nth_unstable_by(middle, compare);
            self.beat(20 * items.len())?;
        }
        let (lower, upper) = items.split_at_mut(middle);
        self.sort(lower, compare)?;
        self.sort(&mut upper[1..], compare)
    }

    /// What is sorted between two looks at the watch: less than a millisecond of work.
    const RUN: usize = 1 << 14;

    fn sorted<T>(&self, items: &[T], compare: &impl Fn(&T, &T) -> std::cmp::Ordering) -> Result<bool, Stopped> {
        let ordered = |a: &T, b: &T| compare(a, b).is_le();
        for start in (0..items.len()).step_by(Self::RUN) {
            // The first of the next run too.
            let end = (start + Self::RUN + 1).min(items.len());
            if !items[start..end].is_sorted_by(ordered) {
                return Ok(false);
            }
            self.beat(3 * Self::RUN)?;
        }
        Ok(true)
    }

    /// Puts what is less than one of the items before it and the others after it; returns where it then is. It is the
    /// median of a sample.
    fn part<T>(&self, items: &mut [T], compare: &impl Fn(&T, &T) -> std::cmp::Ordering) -> Result<usize, Stopped> {
        const SAMPLE: usize = 63;
        let mut sample: [usize; SAMPLE] = std::array::from_fn(|at| at * (items.len() - 1) / (SAMPLE - 1));
        sample.sort_unstable_by(|&a, &b| compare(&items[a], &items[b]));
        items.swap(0, sample[SAMPLE / 2]);
        let Some((pivot, rest)) = items.split_first_mut() else { return Ok(0) };
        let mut less = 0;
        for start in (0..rest.len()).step_by(Self::RUN) {
            for at in start..(start + Self::RUN).min(rest.len()) {
                // Without a branch, which would be mispredicted every other time.
                let is_less = compare(&rest[at], pivot).is_lt();
                rest.swap(at, less);
                less += usize::from(is_less);
            }
            self.beat(5 * Self::RUN)?;
        }
        items.swap(0, less);
        Ok(less)
    }

    /// So many of the same. Memory that is new takes the system some time: a page of it about as long as to write it.
    ///
    /// # Errors
    /// When the watch has cancelled.
    pub fn filled<T: Copy>(&self, value: T, count: usize) -> Result<Vec<T>, Stopped> {
        let mut all = Vec::with_capacity(count);
        while all.len() < count {
            let next = (all.len() + Self::RUN).min(count);
            all.resize(next, value);
            self.beat(Self::RUN * size_of::<T>() / 2)?;
        }
        Ok(all)
    }
}

impl std::fmt::Debug for Pulse<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Pulse").field("spent", &self.spent).finish_non_exhaustive()
    }
}

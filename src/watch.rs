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

/// Hears of a cancellation as another watch does, but keeps the progress from it: that of a part, in another unit.
#[derive(Clone, Copy)]
pub struct Silent<'a>(pub &'a dyn Watch);

impl Watch for Silent<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}

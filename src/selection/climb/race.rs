//! The candidates of one move against each other.

use std::sync::{
    Mutex, PoisonError,
    atomic::{AtomicU64, AtomicUsize, Ordering},
};

use rayon::prelude::*;

use crate::metrics::Cancelled;

/// A total loss and the eigenvalue index that causes it: of two, the lesser is the better move.
pub(super) type Mark = (u128, u32);

/// How far a candidate came.
#[derive(Clone, Copy)]
pub(super) enum Outcome {
    /// Its total loss.
    Whole(u128),
    /// Given up: it can't stay below the bound. The loss it would come to, roughly.
    GivenUp(f64),
}

/// Finds the best move, giving up on candidates as soon as they can't be it.
///
/// What is given up depends on timing, the winner does not: it is the least [`Mark`] below the loss at the start.
pub(super) struct Race {
    /// By index: the loss last seen, as the bits of an `f64`. Whoever did well in the last race starts first.
    form: Vec<AtomicU64>,
}

impl Race {
    /// For indices 1…`cols`.
    pub(super) fn new(cols: usize) -> Self {
        Self { form: (0..=cols).map(|_| AtomicU64::new(0)).collect() }
    }

    /// The `keep` candidates with the least losses below `loss`, ascending; of equal ones the lowest indices.
    ///
    /// `evaluate` gets up to `together` candidates at once, and what is to be beaten; it returns an outcome for each.
    pub(super) fn run<F>(
        &self,
        candidates: &[u32],
        loss: u128,
        keep: usize,
        together: usize,
        evaluate: F,
    ) -> Result<Vec<Mark>, Cancelled>
    where
        F: Fn(&[u32], &dyn Fn() -> Mark) -> Result<Vec<Outcome>, Cancelled> + Sync,
    {
        // Index 0 comes before all: an equal loss is not below.
        let best = Mutex::new(vec![(loss, 0); keep]);
        let lock = || best.lock().unwrap_or_else(PoisonError::into_inner);
        let bound = || lock().last().copied().unwrap_or_default();
        let form = |index: u32| f64::from_bits(self.form[index as usize].load(Ordering::Relaxed));
        let mut order: Vec<(f64, u32)> = candidates.iter().map(|&index| (form(index), index)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let order: Vec<u32> = order.into_iter().map(|(_, index)| index).collect();
        let blocks: Vec<&[u32]> = order.chunks(together).collect();
        let next = AtomicUsize::new(0);
        (0..rayon::current_num_threads()).into_par_iter().try_for_each(|_| {
            while let Some(block) = blocks.get(next.fetch_add(1, Ordering::Relaxed)) {
                for (&index, outcome) in block.iter().zip(evaluate(block, &bound)?) {
                    let form = match outcome {
                        Outcome::GivenUp(form) => form,
                        Outcome::Whole(whole) => {
                            let mut best = lock();
                            best.push((whole, index));
                            best.sort_unstable();
                            best.truncate(keep);
                            whole as f64
                        }
                    };
                    self.form[index as usize].store(form.to_bits(), Ordering::Relaxed);
                }
            }
            Ok(())
        })?;
        let mut best = best.into_inner().unwrap_or_else(PoisonError::into_inner);
        best.retain(|&(_, index)| index > 0);
        Ok(best)
    }
}

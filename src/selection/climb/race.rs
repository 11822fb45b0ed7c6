//! The candidates of one move against each other.

use std::sync::{
    Mutex, MutexGuard, PoisonError,
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

/// The best moves so far, and what is to be beaten.
pub(super) struct Bound {
    best: Mutex<Vec<Mark>>,
}

impl Bound {
    /// For the `keep` best below `loss`.
    fn new(loss: u128, keep: usize) -> Self {
        // Index 0 comes before all: an equal loss is not below.
        Self { best: Mutex::new(vec![(loss, 0); keep]) }
    }

    /// What a candidate has to stay below.
    pub(super) fn mark(&self) -> Mark {
        self.lock().last().copied().unwrap_or_default()
    }

    /// Takes in what a candidate comes to. Once or again is the same.
    pub(super) fn lower(&self, mark: Mark) {
        let mut best = self.lock();
        if let Err(at) = best.binary_search(&mark) {
            best.insert(at, mark);
            best.pop();
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Mark>> {
        self.best.lock().unwrap_or_else(PoisonError::into_inner)
    }
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
        F: Fn(&[u32], &Bound) -> Result<Vec<Outcome>, Cancelled> + Sync,
    {
        let bound = Bound::new(loss, keep);
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
                            bound.lower((whole, index));
                            whole as f64
                        }
                    };
                    self.form[index as usize].store(form.to_bits(), Ordering::Relaxed);
                }
            }
            Ok(())
        })?;
        let mut best = bound.best.into_inner().unwrap_or_else(PoisonError::into_inner);
        best.retain(|&(_, index)| index > 0);
        Ok(best)
    }
}

#[cfg(test)]
mod tests {
    use super::Bound;

    #[test]
    fn the_bound_is_the_last_of_those_kept() {
        let bound = Bound::new(10, 2);
        assert_eq!(bound.mark(), (10, 0));
        bound.lower((7, 3));
        // Twice is once, and what is no better is none of them.
        bound.lower((7, 3));
        bound.lower((10, 1));
        assert_eq!(bound.mark(), (10, 0));
        bound.lower((7, 2));
        assert_eq!(bound.mark(), (7, 3));
        bound.lower((9, 1));
        assert_eq!(bound.mark(), (7, 3));
    }
}

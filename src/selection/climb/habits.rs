//! Whom to ask first.

use std::sync::{Mutex, MutexGuard, PoisonError};

/// What every candidate cost every model when it was last asked, in 256ths of what it can cost at most.
///
/// It says whom to ask first: whoever loses most, so that it shows soon who can't be the best. Any order gives the same
/// losses in the end.
pub(super) struct Habits {
    /// By index, then by model.
    seen: Vec<Mutex<Vec<u8>>>,
}

impl Habits {
    /// For indices 1…`cols`: nobody was asked yet.
    pub(super) fn new(models: usize, cols: usize) -> Self {
        Self { seen: (0..=cols).map(|_| Mutex::new(vec![0; models])).collect() }
    }

    /// What candidate `index` cost the models.
    pub(super) fn of(&self, index: u32) -> MutexGuard<'_, Vec<u8>> {
        self.seen[index as usize].lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The models `asked`, those first that some candidates cost most; of equal ones in the order given.
    pub(super) fn order(&self, indices: &[u32], asked: &[u32]) -> Vec<u32> {
        let mut costs = vec![0_u16; asked.len()];
        for &index in indices {
            costs.iter_mut().zip(&*self.of(index)).for_each(|(cost, &seen)| *cost += u16::from(seen));
        }
        let place = |(place, &model): (u64, &u32)| u64::from(u16::MAX - costs[model as usize]) << 32 | place;
        let mut places: Vec<u64> = (0..).zip(asked).map(place).collect();
        places.sort_unstable();
        places.into_iter().map(|place| asked[place as u32 as usize]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Habits;

    #[test]
    fn whoever_lost_most_comes_first() {
        let habits = Habits::new(4, 3);
        assert_eq!(habits.order(&[1, 2], &[3, 0, 2, 1]), [3, 0, 2, 1]);
        habits.of(1).copy_from_slice(&[0, 200, 9, 9]);
        habits.of(2).copy_from_slice(&[0, 200, 1, 1]);
        habits.of(3).copy_from_slice(&[255, 0, 0, 0]);
        assert_eq!(habits.order(&[1, 2], &[3, 0, 2, 1]), [1, 3, 2, 0]);
        assert_eq!(habits.order(&[1, 2, 3], &[3, 0, 2, 1]), [1, 0, 3, 2]);
    }
}

//! A set of indices that is gone through in their order while it grows.

/// The set, a bit for each index.
#[derive(Default)]
pub(super) struct Set {
    words: Vec<u64>,
}

impl Set {
    /// Empties the set, and makes room for indices below `end`.
    pub(super) fn clear(&mut self, end: u32) {
        self.words.clear();
        self.words.resize(end.div_ceil(64) as usize, 0);
    }

    /// Puts an index in, which is below the end.
    pub(super) fn insert(&mut self, index: u32) {
        self.words[(index / 64) as usize] |= 1 << (index % 64);
    }

    /// The least index in the set that is not below `from`.
    pub(super) fn from(&self, from: u32) -> Option<u32> {
        let mut at = from / 64;
        let mut word = self.words.get(at as usize)? >> (from % 64) << (from % 64);
        while word == 0 {
            at += 1;
            word = *self.words.get(at as usize)?;
        }
        Some(64 * at + word.trailing_zeros())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_come_in_their_order_and_new_ones_are_met() {
        let mut set = Set::default();
        set.clear(200);
        assert_eq!(set.from(0), None);
        for index in [199, 63, 64, 5] {
            set.insert(index);
        }
        let (mut met, mut next) = (Vec::new(), 0);
        while let Some(index) = set.from(next) {
            met.push(index);
            next = index + 1;
            if index == 63 {
                // One that is passed, one in the same word as what is met, one further on.
                for new in [5, 60, 65, 128] {
                    set.insert(new);
                }
            }
        }
        assert_eq!(met, [5, 63, 64, 65, 128, 199]);
        assert_eq!((set.from(6), set.from(200), set.from(10_000)), (Some(60), None, None));
        set.clear(65);
        assert_eq!(set.from(0), None);
    }
}

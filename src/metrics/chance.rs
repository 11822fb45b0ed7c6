//! Chance that can be repeated.

/// Draws numbers from a seed: the same ones on every machine and in every version.
///
/// `SplitMix64` (Steele, Lea and Flood, *Fast splittable pseudorandom number generators*, OOPSLA 2014).
#[derive(Debug, Clone)]
pub struct Chance(u64);

impl Chance {
    /// Draws that depend on the seed and on what they are for, so that two uses of one seed are not alike.
    #[must_use]
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut chance = Self(seed);
        Self(chance.next() ^ stream.wrapping_mul(0xa076_1d64_78bd_642f))
    }

    /// 64 random bits.
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mixed = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// A number below `end`, all equally likely; 0 when `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        // The excess of some numbers over others is below end / 2⁶⁴.
        ((u128::from(self.next()) * end as u128) >> 64) as usize
    }

    /// True or false.
    pub fn coin(&mut self) -> bool {
        self.next() >> 63 == 1
    }

    /// Puts the items in any order, all equally likely.
    pub fn shuffle<T>(&mut self, items: &mut [T]) {
        for end in (2..=items.len()).rev() {
            items.swap(end - 1, self.below(end));
        }
    }

    /// `count` of the numbers 1…`end`, ascending; all of them when there are fewer.
    pub fn choose(&mut self, count: usize, end: usize) -> Vec<u32> {
        let mut numbers: Vec<u32> = (1..=end as u32).collect();
        self.shuffle(&mut numbers);
        numbers.truncate(count);
        numbers.sort_unstable();
        numbers
    }
}

#[cfg(test)]
mod tests {
    use super::Chance;

    #[test]
    fn a_seed_always_draws_the_same() {
        // The first numbers of SplitMix64 from 1234567, as its authors' reference code gives them.
        let mut chance = Chance(1_234_567);
        assert_eq!([chance.next(), chance.next()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
        assert_ne!(Chance::new(1, 0).next(), Chance::new(1, 1).next());
    }

    #[test]
    fn draws_are_even() {
        let mut chance = Chance::new(1, 0);
        let (mut counts, mut heads) = ([0; 6], 0);
        for _ in 0..6000 {
            counts[chance.below(6)] += 1;
            heads += usize::from(chance.coin());
        }
        assert!(counts.iter().all(|count| (850..1150).contains(count)), "{counts:?}");
        assert!((2850..3150).contains(&heads), "{heads}");
        assert_eq!(chance.below(0), 0);
    }

    #[test]
    fn a_choice_has_no_number_twice() {
        let mut chance = Chance::new(3, 0);
        for count in 0..=9 {
            let chosen = chance.choose(count, 7);
            assert_eq!(chosen.len(), count.min(7));
            assert!(chosen.is_sorted_by(|a, b| a < b) && chosen.iter().all(|number| (1..=7).contains(number)));
        }
    }
}

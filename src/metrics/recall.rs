//! Average dynamic recall in exact integers.
//!
//! ADR = (1/Q) Σ_{i=1..Q} `r_i`/i, where `r_i` of the first i retrieved are relevant. A relevant model at rank p ≤ Q
//! adds 1/i to every i from p to Q, so that ADR is a sum of weights `w_Q(p)` = (1/Q) Σ_{i=p..Q} 1/i over the relevant
//! models among the first Q. In units of one over a common multiple of all denominators the weights are integers: sums
//! do not depend on their order, and equal figures are equal.

/// Greatest scale. Sums over 2³² models stay within 128 bits.
const SCALE_MAX: u128 = 1 << 96;

/// The weights of ranks for every number Q of relevant models in an exam.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Recall {
    scale: u128,
    /// By Q, then by rank − 1.
    weights: Vec<Vec<u128>>,
    /// How many of the asked models have something relevant to find.
    counted: usize,
}

impl Recall {
    /// For asked models with these numbers of relevant models.
    ///
    /// The weights are exact as long as a common multiple of the denominators stays below 2⁹⁶ (all classes up to about
    /// 40 models); beyond, they are rounded down to multiples of 2⁻⁹⁶.
    #[must_use]
    pub fn new(relevant: &[usize]) -> Self {
        let greatest = relevant.iter().copied().max().unwrap_or(0);
        let mut occurs = vec![false; greatest + 1];
        for &count in relevant {
            occurs[count] = true;
        }
        let counts = || (1..=greatest).filter(|&count| occurs[count]).map(|count| count as u128);
        let multiple = counts().try_fold(1, |multiple, count| {
            (1..=count).try_fold(multiple, |multiple, i| lcm(multiple, count * i).filter(|&m| m < SCALE_MAX))
        });
        let scale = multiple.unwrap_or(SCALE_MAX);
        let mut weights = vec![Vec::new(); greatest + 1];
        for count in counts() {
            let mut tail = 0;
            let mut ranks: Vec<u128> = (1..=count)
                .rev()
                .map(|i| {
                    tail += scale / (count * i);
                    tail
                })
                .collect();
            ranks.reverse();
            weights[count as usize] = ranks;
        }
        Self { scale, weights, counted: relevant.iter().filter(|&&count| count > 0).count() }
    }

    /// What the relevant models add at the ranks 1…Q, in units of 1 / [`Recall::scale`].
    ///
    /// # Panics
    /// When no asked model has `relevant` relevant models.
    #[must_use]
    pub fn weights(&self, relevant: usize) -> &[u128] {
        &self.weights[relevant]
    }

    /// The units in an ADR of 1.
    #[must_use]
    pub const fn scale(&self) -> u128 {
        self.scale
    }

    /// The sum over all asked models if each had an ADR of 1. Those with nothing relevant to find are left out.
    #[must_use]
    pub const fn full(&self) -> u128 {
        self.scale * self.counted as u128
    }

    /// Mean ADR from the sum over all asked models.
    #[must_use]
    pub fn mean(&self, sum: u128) -> f64 {
        if self.counted == 0 { 0.0 } else { sum as f64 / self.full() as f64 }
    }
}

fn lcm(a: u128, b: u128) -> Option<u128> {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    (a / x).checked_mul(b)
}

#[cfg(test)]
mod tests {
    use super::Recall;

    #[test]
    fn weights_by_hand() {
        // Q = 2: rank 1 adds (1 + 1/2)/2 = 3/4, rank 2 adds 1/4.
        let recall = Recall::new(&[2, 2, 0]);
        assert_eq!(recall.scale(), 4);
        assert_eq!(recall.weights(2), [3, 1]);
        assert_eq!(recall.mean(4 + 1), 5.0 / 8.0);
    }

    #[test]
    fn a_perfect_ranking_has_an_adr_of_one() {
        for greatest in [1, 5, 20, 33] {
            let recall = Recall::new(&(0..=greatest).collect::<Vec<_>>());
            for count in 1..=greatest {
                assert_eq!(recall.weights(count).iter().sum::<u128>(), recall.scale());
            }
        }
    }

    #[test]
    fn large_classes_round() {
        let recall = Recall::new(&[150, 49]);
        for count in [49, 150] {
            let sum = recall.weights(count).iter().sum::<u128>();
            assert!(sum <= recall.scale() && recall.scale() - sum < 150 * 150);
        }
        assert_eq!(recall.mean(recall.full()), 1.0);
    }

    #[test]
    fn nothing_to_find_is_the_worst() {
        assert_eq!(Recall::new(&[0, 0]).mean(0), 0.0);
        assert_eq!(Recall::new(&[]).mean(0), 0.0);
    }
}

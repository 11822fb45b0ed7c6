//! Distances between feature vectors: sums of one term per selected feature.

use pulp::Simd;
use serde::{Deserialize, Serialize};

/// The distance between the selected features of two models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Distance {
    /// Euclidean, the paper's.
    #[default]
    L2,
    /// Sum of absolute differences.
    L1,
    /// Σ (a − b)² / (|a| + |b|), terms with a = b = 0 left out.
    Chi2,
}

impl Distance {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::L2, Self::L1, Self::Chi2];

    /// The sum of the terms at `selection` (indices from 1), added in the order given.
    ///
    /// It orders pairs as the distance does: the distance itself for L1 and chi2, its square for L2.
    ///
    /// # Panics
    /// When an index is 0 or above the length of a row.
    #[must_use]
    pub fn sum(self, a: &[f64], b: &[f64], selection: &[u32]) -> f64 {
        by_distance!(self, T => {
            selection.iter().map(|&index| index as usize - 1).fold(0.0, |sum, j| sum + T::term(a[j], b[j]))
        })
    }

    /// The distance whose [`Distance::sum`] is `sum`.
    #[must_use]
    pub fn from_sum(self, sum: f64) -> f64 {
        match self {
            Self::L2 => sum.sqrt(),
            Self::L1 | Self::Chi2 => sum,
        }
    }
}

/// What one feature adds to the distance of two models: never negative, and the same either way round.
pub(crate) trait Term: Copy + Send + Sync {
    /// The term of the values `a` and `b`.
    fn term(a: f64, b: f64) -> f64;

    /// The same in every lane, to the last bit.
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s;
}

#[derive(Clone, Copy)]
pub(crate) struct L2;
#[derive(Clone, Copy)]
pub(crate) struct L1;
#[derive(Clone, Copy)]
pub(crate) struct Chi2;

impl Term for L2 {
    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        (a - b) * (a - b)
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        let difference = simd.sub_f64s(a, b);
        simd.mul_f64s(difference, difference)
    }
}

impl Term for L1 {
    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        (a - b).abs()
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        simd.abs_f64s(simd.sub_f64s(a, b))
    }
}

impl Term for Chi2 {
    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        let total = a.abs() + b.abs();
        if total > 0.0 { (a - b) * (a - b) / total } else { 0.0 }
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        let total = simd.add_f64s(simd.abs_f64s(a), simd.abs_f64s(b));
        let zero = simd.splat_f64s(0.0);
        simd.select_f64s(simd.greater_than_f64s(total, zero), simd.div_f64s(L2::terms(simd, a, b), total), zero)
    }
}

/// Evaluates an expression with the type `$term` bound to the [`Term`] of a [`Distance`], so that loops are compiled
/// for each distance.
macro_rules! by_distance {
    ($distance:expr, $term:ident => $body:expr) => {
        match $distance {
            $crate::metrics::Distance::L2 => {
                type $term = $crate::metrics::L2;
                $body
            }
            $crate::metrics::Distance::L1 => {
                type $term = $crate::metrics::L1;
                $body
            }
            $crate::metrics::Distance::Chi2 => {
                type $term = $crate::metrics::Chi2;
                $body
            }
        }
    };
}
pub(crate) use by_distance;

#[cfg(test)]
mod tests {
    use super::Distance;

    #[test]
    fn distances_by_hand() {
        let (a, b) = ([0.0, 1.0, 4.0], [0.0, 3.0, 1.0]);
        let whole = [1, 2, 3];
        assert_eq!(Distance::L1.sum(&a, &b, &whole), 5.0);
        assert_eq!(Distance::L2.sum(&a, &b, &whole), 13.0);
        assert_eq!(Distance::L2.from_sum(25.0), 5.0);
        assert_eq!(Distance::Chi2.sum(&a, &b, &whole), 4.0 / 4.0 + 9.0 / 5.0);
        assert_eq!(Distance::L1.sum(&a, &b, &[2]), 2.0);
        assert_eq!(Distance::Chi2.sum(&[-1.0], &[1.0], &[1]), 2.0);
        assert_eq!(Distance::L2.sum(&a, &b, &[]), 0.0);
    }
}

//! Distances between feature vectors: sums of one term per selected feature.

use pulp::Simd;
use serde::{Deserialize, Serialize};

pub(crate) use single::RELATIVELY;

mod single;

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
    /// Weighted spectral distance (Σ (|a − b| / |a b|)^1.5)^(1/1.5), terms with a = 0 or b = 0 left out: low
    /// eigenvalues count most (Konukoglu, Glocker, Criminisi and Pohl, *WESD*, PAMI 35(9), 2013). For eigenvalues, not
    /// logarithms.
    #[serde(rename = "wesd1.5")]
    Wesd15,
    /// The same with powers of 2.
    #[serde(rename = "wesd2")]
    Wesd2,
}

impl Distance {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::L2, Self::L1, Self::Chi2, Self::Wesd15, Self::Wesd2];

    /// Its name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::L2 => "l2",
            Self::L1 => "l1",
            Self::Chi2 => "chi2",
            Self::Wesd15 => "wesd1.5",
            Self::Wesd2 => "wesd2",
        }
    }

    /// The sum of the terms at `selection` (indices from 1), added in the order given.
    ///
    /// It orders pairs as the distance does: the distance itself for L1 and chi2, a power of it for the others.
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
            Self::L2 | Self::Wesd2 => sum.sqrt(),
            Self::Wesd15 => sum.cbrt() * sum.cbrt(),
            Self::L1 | Self::Chi2 => sum,
        }
    }
}

/// What one feature adds to the distance of two models: never negative, and the same either way round.
pub(crate) trait Term: Copy + Send + Sync {
    /// Whether it is computed so that it grows exactly, too, where it grows: in spite of rounding.
    const GROWS_EXACTLY: bool = false;

    /// Whether the term of one feature grows, or stays, as one walks away from one of these values to either side.
    fn grows(values: &[f64]) -> bool {
        let _ = values;
        true
    }

    /// The term of the values `a` and `b`.
    fn term(a: f64, b: f64) -> f64;

    /// The same in every lane, to the last bit.
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s;

    /// The values of one feature in single precision, and how much [`Term::single_terms`] of two of them is off their
    /// term at most, beside [`RELATIVELY`] so much. None where that is not known.
    fn singles(values: &[f64]) -> Option<(Vec<f32>, f64)>;

    /// The terms of values in single precision.
    fn single_terms<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s;
}

#[derive(Clone, Copy)]
pub(crate) struct L2;
#[derive(Clone, Copy)]
pub(crate) struct L1;
#[derive(Clone, Copy)]
pub(crate) struct Chi2;
#[derive(Clone, Copy)]
pub(crate) struct Wesd15;
#[derive(Clone, Copy)]
pub(crate) struct Wesd2;

impl Term for L2 {
    // Differences are rounded in their order, and so are their squares.
    const GROWS_EXACTLY: bool = true;

    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        (a - b) * (a - b)
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        let difference = simd.sub_f64s(a, b);
        simd.mul_f64s(difference, difference)
    }

    fn singles(values: &[f64]) -> Option<(Vec<f32>, f64)> {
        single::for_squares(values)
    }

    #[inline(always)]
    fn single_terms<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        let difference = simd.sub_f32s(a, b);
        simd.mul_f32s(difference, difference)
    }
}

impl Term for L1 {
    const GROWS_EXACTLY: bool = true;

    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        (a - b).abs()
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        simd.abs_f64s(simd.sub_f64s(a, b))
    }

    fn singles(values: &[f64]) -> Option<(Vec<f32>, f64)> {
        single::for_differences(values)
    }

    #[inline(always)]
    fn single_terms<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        simd.abs_f32s(simd.sub_f32s(a, b))
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

    fn singles(values: &[f64]) -> Option<(Vec<f32>, f64)> {
        single::for_ratios(values)
    }

    #[inline(always)]
    fn single_terms<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        let total = simd.add_f32s(simd.abs_f32s(a), simd.abs_f32s(b));
        let (difference, zero) = (simd.sub_f32s(a, b), simd.splat_f32s(0.0));
        // The square alone might be too small a number.
        let term = simd.mul_f32s(difference, simd.div_f32s(difference, total));
        simd.select_f32s(simd.greater_than_f32s(total, zero), term, zero)
    }
}

/// |a − b| / |a b|, 0 where a or b is.
#[inline(always)]
fn spectral(a: f64, b: f64) -> f64 {
    let product = (a * b).abs();
    if product > 0.0 { (a - b).abs() / product } else { 0.0 }
}

/// Whether these are values between which |a − b| / |a b| grows with how far apart they are: of one sign, as a zero is
/// as near as can be, and such that no product of two is too small or too great to be told from others.
fn one_sided(values: &[f64]) -> bool {
    let products = f64::MIN_POSITIVE.sqrt()..=f64::MAX.sqrt();
    let all = |sign: f64| values.iter().all(|&value| products.contains(&(sign * value)));
    all(1.0) || all(-1.0)
}

/// The same in every lane.
#[inline(always)]
fn spectrals<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
    let (product, zero) = (simd.abs_f64s(simd.mul_f64s(a, b)), simd.splat_f64s(0.0));
    let ratio = simd.div_f64s(simd.abs_f64s(simd.sub_f64s(a, b)), product);
    simd.select_f64s(simd.greater_than_f64s(product, zero), ratio, zero)
}

impl Term for Wesd15 {
    fn grows(values: &[f64]) -> bool {
        one_sided(values)
    }

    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        let ratio = spectral(a, b);
        ratio * ratio.sqrt()
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        let ratio = spectrals(simd, a, b);
        simd.mul_f64s(ratio, simd.sqrt_f64s(ratio))
    }

    fn singles(values: &[f64]) -> Option<(Vec<f32>, f64)> {
        single::for_inverse_powers(values)
    }

    #[inline(always)]
    fn single_terms<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        let ratio = L1::single_terms(simd, a, b);
        simd.mul_f32s(ratio, simd.sqrt_f32s(ratio))
    }
}

impl Term for Wesd2 {
    fn grows(values: &[f64]) -> bool {
        one_sided(values)
    }

    #[inline(always)]
    fn term(a: f64, b: f64) -> f64 {
        let ratio = spectral(a, b);
        ratio * ratio
    }

    #[inline(always)]
    fn terms<S: Simd>(simd: S, a: S::f64s, b: S::f64s) -> S::f64s {
        let ratio = spectrals(simd, a, b);
        simd.mul_f64s(ratio, ratio)
    }

    fn singles(values: &[f64]) -> Option<(Vec<f32>, f64)> {
        single::for_inverse_squares(values)
    }

    #[inline(always)]
    fn single_terms<S: Simd>(simd: S, a: S::f32s, b: S::f32s) -> S::f32s {
        L2::single_terms(simd, a, b)
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
            $crate::metrics::Distance::Wesd15 => {
                type $term = $crate::metrics::Wesd15;
                $body
            }
            $crate::metrics::Distance::Wesd2 => {
                type $term = $crate::metrics::Wesd2;
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
        // 2/3 and 3/4; the zeros are left out.
        assert_eq!(Distance::Wesd2.sum(&a, &b, &whole), (2.0 / 3.0) * (2.0 / 3.0) + 0.75 * 0.75);
        assert_eq!(Distance::Wesd15.sum(&a, &b, &[1, 3]), 0.75 * 0.75_f64.sqrt());
        assert!((Distance::Wesd15.from_sum(8.0) - 4.0).abs() < 1e-15);
    }
}

//! Features in single precision: how far off are their terms?
//!
//! With u = 2⁻²⁴, a value x is rounded by up to u|x|. Values around the middle of a column of range R are rounded by up
//! to uR/2 each, so that a difference Δ of two is off by δ ≤ 2uR. Then
//!
//! - Δ² is off by 2Δδ + δ² ≤ εΔ²/2 + (2/ε + 1)δ², for any ε;
//! - Δ^1.5 is off by 1.5δ√(Δ + δ) ≤ εΔ^1.5/2 + (ε^−0.5 + 1.5)δ^1.5, by Young's inequality;
//! - Δ²/S with S = |a| + |b| and values as they are, for which δ ≤ 2uS, is off by εΔ²/2S + (2/ε + 1)δ²/S.
//!
//! With ε = [`RELATIVELY`] the other half of ε is more than enough for the few roundings to u that follow. What does
//! not depend on Δ is rounded up to a power of two here.

use super::one_sided;

/// By which part of a term that in single precision may be off, beside what comes with the values.
pub(crate) const RELATIVELY: f64 = 1.0 / 65_536.0;

/// Values in single precision, and by how much their terms are off.
type Singles = Option<(Vec<f32>, f64)>;

/// For |a − b|.
pub(super) fn for_differences(values: &[f64]) -> Singles {
    centred(values).map(|(singles, range)| (singles, power(-23) * range))
}

/// For (a − b)².
pub(super) fn for_squares(values: &[f64]) -> Singles {
    centred(values).map(|(singles, range)| (singles, power(-28) * range * range))
}

/// For |1/a − 1/b|², which is (|a − b| / |a b|)².
pub(super) fn for_inverse_squares(values: &[f64]) -> Singles {
    for_squares(&inverses(values)?)
}

/// For |1/a − 1/b|^1.5.
pub(super) fn for_inverse_powers(values: &[f64]) -> Singles {
    centred(&inverses(values)?).map(|(singles, range)| (singles, power(-26) * range * range.sqrt()))
}

/// For (a − b)² / (|a| + |b|).
pub(super) fn for_ratios(values: &[f64]) -> Singles {
    let (least, range) = range(values)?;
    let greatest = least.abs().max((least + range).abs());
    Some((in_single(values.iter().copied()), power(-27) * greatest))
}

fn in_single(values: impl Iterator<Item = f64>) -> Vec<f32> {
    values.map(|value| value as f32).collect()
}

fn power(exponent: i32) -> f64 {
    2_f64.powi(exponent)
}

/// Values around their middle, and their range.
fn centred(values: &[f64]) -> Singles {
    let (least, range) = range(values)?;
    let middle = least + 0.5 * range;
    Some((in_single(values.iter().map(|value| value - middle)), range))
}

/// The inverses, if they are told apart well enough for what they are rounded by in double precision not to count.
fn inverses(values: &[f64]) -> Option<Vec<f64>> {
    if !one_sided(values) {
        return None;
    }
    let inverses: Vec<f64> = values.iter().map(|value| value.recip()).collect();
    let (least, range) = range(&inverses)?;
    (range == 0.0 || range > (least.abs() + range) * power(-20)).then_some(inverses)
}

/// The least of some values, and how far above it the greatest is, if all are finite.
fn range(values: &[f64]) -> Option<(f64, f64)> {
    let finite = values.iter().all(|value| value.is_finite());
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let greatest = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let range = greatest - least;
    (finite && range.is_finite()).then_some((least, range))
}

#[cfg(test)]
mod tests {
    use pulp::Scalar;

    use super::RELATIVELY;
    use crate::metrics::{Chi2, L1, L2, Term, Wesd2, Wesd15, samples::Lcg};

    /// The greatest share that any term takes of what it may be off. None where that is not known.
    fn share<T: Term>(values: &[f64]) -> Option<f64> {
        // Beyond, terms are too great for single precision.
        let (singles, off) = T::singles(values).filter(|(_, off)| *off < 1e18)?;
        let mut greatest: f64 = 0.0;
        for (&a, &single_a) in values.iter().zip(&singles) {
            for (&b, &single_b) in values.iter().zip(&singles) {
                let (term, single) = (T::term(a, b), T::single_terms(Scalar::new(), single_a, single_b));
                let difference = (f64::from(single) - term).abs();
                if difference > 0.0 {
                    greatest = greatest.max(difference / (RELATIVELY * term + off));
                }
            }
        }
        Some(greatest)
    }

    #[test]
    fn terms_are_off_by_less_than_is_said() {
        let mut random = Lcg(8);
        let mut least_slack: f64 = 0.0;
        for (from, range) in [(0.0, 1.0), (0.9, 0.1), (1e6, 1.0), (1e-9, 1e-3), (3e4, 1e9), (1e-12, 1e-15), (-0.5, 1.0)]
        {
            for power in [1, 8] {
                // Evenly spread, and most of them close together.
                let values: Vec<f64> = (0..90).map(|_| from + range * random.next().powi(power)).collect();
                let known = [share::<L2>(&values), share::<L1>(&values), share::<Chi2>(&values)];
                let inverses = [share::<Wesd15>(&values), share::<Wesd2>(&values)];
                assert!(known.iter().all(Option::is_some), "{from} {range}");
                for share in known.into_iter().chain(inverses).flatten() {
                    assert!(share < 1.0, "{from} {range} {power}: {share}");
                    least_slack = least_slack.max(share);
                }
            }
        }
        // What is said is not far from what happens.
        assert!(least_slack > 0.02, "{least_slack}");
    }

    #[test]
    fn nothing_is_said_of_what_is_not_known() {
        for values in [&[][..], &[1.0, f64::INFINITY], &[f64::NAN, 1.0], &[f64::MAX, f64::MIN]] {
            assert_eq!((L2::singles(values), Chi2::singles(values)), (None, None));
        }
        for values in [[0.0, 1.0], [-1.0, 1.0], [1.0, 1.0 + 1e-9]] {
            assert_eq!((Wesd2::singles(&values), Wesd15::singles(&values)), (None, None));
        }
        assert_eq!(Wesd2::singles(&[-2.0, -2.0]), Some((vec![0.0; 2], 0.0)));
    }
}

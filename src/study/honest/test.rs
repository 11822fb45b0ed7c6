//! Intervals and paired tests.

use super::{Interval, Plan, deal::interval};
use crate::metrics::Chance;

/// How far apart two methods are, and the p of the permutation test.
///
/// `first` and `second` say of the same models how often the methods were wrong in the plan's repeats. The difference
/// is ε of the first less that of the second.
#[must_use]
pub fn paired(first: &[u32], second: &[u32], plan: Plan) -> (Interval, f64) {
    let apart: Vec<i64> = first.iter().zip(second).map(|(&a, &b)| i64::from(a) - i64::from(b)).collect();
    let differences: Vec<f64> = apart.iter().map(|&d| d as f64 / plan.repeats.max(1) as f64).collect();
    (interval(&differences, plan, 0.0), permutation(&apart, plan.resamples, Chance::new(plan.seed, 1)))
}

/// The mean of the values with percentiles of its bootstrap: 2.5 % and 97.5 %. None without values or resamples.
pub(super) fn bootstrap(values: &[f64], resamples: usize, mut chance: Chance) -> Option<Interval> {
    if values.is_empty() || resamples == 0 {
        return None;
    }
    let count = values.len() as f64;
    let mut means: Vec<f64> = (0..resamples)
        .map(|_| (0..values.len()).map(|_| values[chance.below(values.len())]).sum::<f64>() / count)
        .collect();
    means.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| means[((share * resamples as f64) as usize).min(resamples - 1)];
    Some(Interval { mean: values.iter().sum::<f64>() / count, low: at(0.025), high: at(0.975) })
}

/// Two-sided p of the differences' sum when every sign may as well be the other.
///
/// With k of B throws as far out, p is (k + 1)/(B + 1): the differences as they are count as one throw, so that p is
/// never 0 (Phipson and Smyth, *Permutation p-values should never be zero*, 2010).
pub(super) fn permutation(differences: &[i64], throws: usize, mut chance: Chance) -> f64 {
    let seen = differences.iter().sum::<i64>().abs();
    let apart: Vec<i64> = differences.iter().copied().filter(|&difference| difference != 0).collect();
    let mut throw = || apart.iter().map(|&d| if chance.coin() { d } else { -d }).sum::<i64>().abs();
    let as_far = (0..throws).filter(|_| throw() >= seen).count();
    (as_far + 1) as f64 / (throws + 1) as f64
}

/// Two-sided p of McNemar's exact test: of the models that one method alone gets wrong, how likely is it that they are
/// shared out as unevenly when each is a coin's throw?
///
/// `first` and `second` say of the same models whether the methods were wrong.
#[must_use]
pub fn mcnemar(first: &[bool], second: &[bool]) -> f64 {
    let alone = |a: &[bool], b: &[bool]| a.iter().zip(b).filter(|&(&a, &b)| a && !b).count();
    let (b, c) = (alone(first, second), alone(second, first));
    let (least, count) = (b.min(c), b + c);
    // P(X ≤ least) for X binomial with ½: the terms C(count, i) / 2^count, one from another by their logarithms.
    let mut term = -(count as f64) * std::f64::consts::LN_2;
    let mut tail = term.exp();
    for i in 0..least {
        term += ((count - i) as f64 / (i + 1) as f64).ln();
        tail += term.exp();
    }
    (2.0 * tail).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::{bootstrap, mcnemar, permutation};
    use crate::metrics::Chance;

    #[test]
    fn mcnemar_by_hand() {
        let wrong = |b: usize, c: usize| {
            let first = (0..b + c + 3).map(|at| at < b).collect::<Vec<_>>();
            let second = (0..b + c + 3).map(|at| (b..b + c).contains(&at)).collect::<Vec<_>>();
            mcnemar(&first, &second)
        };
        assert_eq!(wrong(0, 0), 1.0);
        // 2 · (1 + 10) / 2^10
        assert!((wrong(1, 9) - 22.0 / 1024.0).abs() < 1e-14);
        assert_eq!(wrong(9, 1), wrong(1, 9));
        assert_eq!(wrong(4, 4), 1.0);
        assert!((wrong(0, 6) - 2.0 / 64.0).abs() < 1e-14);
    }

    #[test]
    fn the_permutation_test_is_close_to_all_permutations() {
        let differences = [3, 1, 2, 0, 2, -1, 4];
        let seen = 11_i64;
        let far = (0..1_u32 << 7).filter(|signs| {
            let sum: i64 =
                differences.iter().enumerate().map(|(at, d)| if signs >> at & 1 == 1 { *d } else { -d }).sum();
            sum.abs() >= seen
        });
        let exact = far.count() as f64 / 128.0;
        let drawn = permutation(&differences, 20_000, Chance::new(1, 1));
        assert!((drawn - exact).abs() < 0.01, "{drawn} {exact}");
        assert_eq!(permutation(&[0; 5], 100, Chance::new(1, 1)), 1.0);
    }

    #[test]
    fn the_bootstrap_covers_the_mean_of_a_known_spread() {
        // 100 coins: the standard error of their mean is 0.05.
        let values: Vec<f64> = (0..100).map(|at| f64::from(at % 2)).collect();
        let interval = bootstrap(&values, 4000, Chance::new(1, 0)).unwrap();
        assert_eq!(interval.mean, 0.5);
        assert!((interval.low - 0.402).abs() < 0.015 && (interval.high - 0.598).abs() < 0.015, "{interval:?}");
        assert_eq!(bootstrap(&[], 10, Chance::new(1, 0)), None);
    }
}

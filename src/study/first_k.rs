//! The first k eigenvalues, for every k (paper section 3.1).

use serde::{Deserialize, Serialize};

use super::Score;
use crate::{
    metrics::{Cancelled, Distance, Exam, Sample, Sweep, sweep},
    watch::Watch,
};

/// A figure for every k = 1…kmax; entry k − 1 belongs to k.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    /// On D, leave-one-out.
    pub train: Vec<f64>,
    /// On Q against D; empty where there are no query models.
    pub query: Vec<f64>,
}

impl Curve {
    /// The figures at `k`, counted from 1.
    #[must_use]
    pub fn at(&self, k: usize) -> Option<Score> {
        let index = k.checked_sub(1)?;
        Some(Score { train: *self.train.get(index)?, query: self.query.get(index).copied() })
    }
}

/// The first k eigenvalues, for all k in one pass.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FirstK {
    /// Classification error ε against k (Figure 3).
    pub error: Curve,
    /// Mean ADR against k (Figure 6).
    pub adr: Curve,
    /// The smallest k with the least ε on D.
    pub best_error: usize,
    /// The smallest k with the greatest mean ADR on D.
    pub best_adr: usize,
}

impl FirstK {
    /// From its curves.
    #[must_use]
    pub fn new(error: Curve, adr: Curve) -> Self {
        let best_error = best(&error.train, |figure, least| figure < least);
        let best_adr = best(&adr.train, |figure, greatest| figure > greatest);
        Self { error, adr, best_error, best_adr }
    }

    /// The same for k = 1…`kmax` only (all there are, if there are fewer), bit for bit as computed from the first
    /// `kmax` features.
    #[must_use]
    pub fn prefix(&self, kmax: usize) -> Self {
        let cut = |figures: &[f64]| figures[..kmax.min(figures.len())].to_vec();
        let curve = |curve: &Curve| Curve { train: cut(&curve.train), query: cut(&curve.query) };
        Self::new(curve(&self.error), curve(&self.adr))
    }
}

/// The smallest k, from 1, whose figure none is better than; 0 when there are no figures.
fn best(figures: &[f64], better: impl Fn(f64, f64) -> bool) -> usize {
    let mut best: Option<(usize, f64)> = None;
    for (k, &figure) in (1..).zip(figures) {
        if best.is_none_or(|(_, best)| better(figure, best)) {
            best = Some((k, figure));
        }
    }
    best.map_or(0, |(k, _)| k)
}

/// Computes ε and mean ADR of the first k features for every k, leave-one-out on D, and for Q against D.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
pub fn first_k(sample: &Sample, distance: Distance, watch: &dyn Watch) -> Result<FirstK, Cancelled> {
    let train = sweep(Exam::leave_one_out(sample), distance, watch)?;
    let queries = Exam::queries(sample);
    let query = if queries.is_empty() { Sweep::default() } else { sweep(queries, distance, watch)? };
    Ok(FirstK::new(Curve { train: train.error, query: query.error }, Curve { train: train.adr, query: query.adr }))
}

#[cfg(test)]
mod tests {
    use super::{Curve, FirstK, first_k};
    use crate::{
        metrics::{
            Distance,
            samples::{nobody, one_class, sample},
        },
        watch::Unwatched,
    };

    #[test]
    fn a_prefix_is_the_run_over_fewer_features() {
        let sample = sample(2, 7, 30, 0);
        for distance in Distance::ALL {
            let wide = first_k(&sample, distance, &Unwatched).unwrap();
            for kmax in 1..=30 {
                assert_eq!(wide.prefix(kmax), first_k(&sample.prefix(kmax), distance, &Unwatched).unwrap());
            }
            assert_eq!(wide.prefix(31), wide);
        }
    }

    #[test]
    fn the_best_k_is_the_smallest() {
        let curve = |train: &[f64]| Curve { train: train.to_vec(), query: Vec::new() };
        let first_k = FirstK::new(curve(&[0.5, 0.25, 0.25, 0.5]), curve(&[0.5, 0.5, 0.75, 0.75]));
        assert_eq!((first_k.best_error, first_k.best_adr), (2, 3));
        assert_eq!((first_k.prefix(1).best_error, first_k.prefix(2).best_adr), (1, 1));
        assert_eq!(first_k.prefix(0).best_error, 0);
    }

    #[test]
    fn without_queries_there_are_no_query_curves() {
        let first_k = first_k(&one_class(), Distance::L2, &Unwatched).unwrap();
        assert_eq!(first_k.error.train, [0.0, 0.0]);
        assert_eq!(first_k.adr.train, [1.0, 1.0]);
        assert!(first_k.error.query.is_empty() && first_k.adr.query.is_empty());
        assert_eq!(super::first_k(&nobody(), Distance::L2, &Unwatched), Ok(FirstK::default()));
    }
}

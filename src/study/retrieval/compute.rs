//! Every row of Table 5 in one pass over the models asked.

use self::pass::{Side, side};
use super::{Pick, ReadAs, Retrieved, Scheme};
use crate::{
    metrics::{Cancelled, Chance, Distance, Exam, Sample},
    selection::Strong,
    study::{Climbed, Curve, FirstK, Score},
    watch::Watch,
};

mod pass;
#[cfg(test)]
mod tests;

/// What was selected on D: the schemes rank by it.
#[derive(Debug, Clone, Copy)]
pub struct Sources<'a> {
    /// For the best k.
    pub first_k: &'a FirstK,
    /// Hill climbing for ε.
    pub climb_error: &'a Climbed,
    /// Hill climbing for mean ADR.
    pub climb_adr: &'a Climbed,
    /// One strong classifier per class.
    pub strong: &'a [Strong],
}

/// How random subsets are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Draws {
    /// What the draws depend on.
    pub seed: u64,
    /// How many there are.
    pub count: usize,
}

impl Default for Draws {
    fn default() -> Self {
        Self { seed: 1, count: 20 }
    }
}

/// The eigenvalue indices the schemes rank by, and the random ones.
struct Subsets {
    /// The first k for ε and for mean ADR.
    first_k: [Vec<u32>; 2],
    /// Hill climbing's, for ε and for mean ADR.
    hill: [Vec<u32>; 2],
    /// Random ones as large as hill climbing's for mean ADR.
    random: Vec<Vec<u32>>,
    /// Random ones of any size.
    any_size: Vec<Vec<u32>>,
}

/// Retrieves by every scheme of Table 5, in its order; `kmax` features take part in random draws.
///
/// Selections are as made on D. Models with nothing to find are left out of the means.
///
/// # Errors
/// [`Cancelled`] when the watch said so.
///
/// # Panics
/// When a selection has an index beyond the sample's features, or there is not one strong classifier per class.
pub fn retrieval(
    sample: &Sample,
    distance: Distance,
    sources: Sources<'_>,
    draws: Draws,
    watch: &dyn Watch,
) -> Result<Vec<Retrieved>, Cancelled> {
    let cols = sample.train.cols();
    let first = |k: usize| (1..=k as u32).collect::<Vec<_>>();
    let hill = [sources.climb_error.climb.order(), sources.climb_adr.climb.order()];
    let mut chance = [Chance::new(draws.seed, 0), Chance::new(draws.seed, 1)];
    let random = (0..draws.count).map(|_| chance[0].choose(hill[1].len().max(1), cols)).collect();
    let any_size = (0..draws.count).map(|_| {
        let count = 1 + chance[1].below(cols);
        chance[1].choose(count, cols)
    });
    let any_size = any_size.collect();
    let first_k = [first(sources.first_k.best_error), first(sources.first_k.best_adr)];
    let subsets = Subsets { first_k, hill, random, any_size };
    let side = |exam| side(sample, exam, distance, sources.strong, &subsets, watch);
    let train = side(Exam::leave_one_out(sample))?;
    let queries = Exam::queries(sample);
    let query = if queries.is_empty() { None } else { Some(side(queries)?) };
    let schemes = Scheme::published().into_iter().map(|(scheme, _)| scheme).enumerate();
    Ok(schemes.map(|(at, scheme)| row(scheme, &train[at], query.as_ref().map(|query| &query[at]))).collect())
}

fn row(scheme: Scheme, train: &Side, query: Option<&Side>) -> Retrieved {
    let readings = train.readings.iter().enumerate().map(|(at, &(reading, adr))| ReadAs {
        reading,
        adr: Score { train: adr, query: query.map(|query| query.readings[at].1) },
    });
    let readings: Vec<_> = readings.collect();
    let spread = Score { train: train.spread, query: query.map(|query| query.spread) };
    Retrieved {
        scheme,
        adr: readings[0].adr,
        spread: (scheme.pick == Pick::Random).then_some(spread),
        readings,
        precision: Curve {
            train: train.precision.clone(),
            query: query.map(|query| query.precision.clone()).unwrap_or_default(),
        },
    }
}

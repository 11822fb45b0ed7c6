//! Every row of Table 5 in one pass over the models asked.

use rayon::prelude::*;

use super::{Gate, Pick, ReadAs, Reading, Retrieved, Scheme};
use crate::{
    metrics::{
        Cancelled, Chance, Columns, Distance, Exam, Recall, Sample, gained, gained_with_itself, precision, ranking,
        ranks, sums,
    },
    selection::{Ranges, Strong},
    study::{Climbed, Curve, FirstK, Score},
    watch::Watch,
};

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

/// One side's figures of a scheme.
struct Side {
    readings: Vec<(Reading, f64)>,
    spread: f64,
    precision: Vec<f64>,
}

/// What one model asked adds to a scheme's figures, by reading or by draw; and its precision.
struct Share {
    gained: Vec<u128>,
    precision: Vec<f64>,
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

/// All schemes' figures of one exam.
fn side(
    sample: &Sample,
    exam: Exam<'_>,
    distance: Distance,
    strong: &[Strong],
    subsets: &Subsets,
    watch: &dyn Watch,
) -> Result<Vec<Side>, Cancelled> {
    let relevant = exam.relevant();
    // Knows each number of relevant models and one more.
    let both: Vec<usize> = relevant.iter().flat_map(|&count| [count, count + usize::from(count > 0)]).collect();
    let pass = Pass {
        exam,
        columns: Columns::new(&sample.train),
        ranges: Ranges::new(sample),
        recall: Recall::new(&both),
        levels: relevant.iter().copied().max().unwrap_or(0),
        relevant,
        distance,
        strong,
        subsets,
    };
    let shares: Vec<Vec<Share>> = (0..exam.len())
        .into_par_iter()
        .map(|asked| if watch.cancelled() { Err(Cancelled) } else { Ok(pass.ask(asked)) })
        .collect::<Result<_, _>>()?;
    let shares: Vec<_> = shares.into_iter().filter(|shares| !shares.is_empty()).collect();
    let schemes = Scheme::published().into_iter().enumerate();
    Ok(schemes.map(|(at, (scheme, _))| pass.figures(scheme, &shares, at)).collect())
}

struct Pass<'a> {
    exam: Exam<'a>,
    columns: Columns,
    ranges: Ranges,
    recall: Recall,
    relevant: Vec<usize>,
    levels: usize,
    distance: Distance,
    strong: &'a [Strong],
    subsets: &'a Subsets,
}

impl Pass<'_> {
    /// The shares of one model asked in every scheme; none when it has nothing to find.
    fn ask(&self, asked: usize) -> Vec<Share> {
        if self.relevant[asked] == 0 {
            return Vec::new();
        }
        let rank = |selection: &Vec<u32>| self.rank(asked, selection);
        let (first_k, hill) = (self.subsets.first_k.each_ref().map(rank), self.subsets.hill.each_ref().map(rank));
        let strong = self.by_strong(asked);
        let classes = |ranking: &[u32]| self.by_distance(ranking);
        let (by_first_k, by_hill) =
            (first_k.each_ref().map(|ranking| classes(ranking)), hill.each_ref().map(|ranking| classes(ranking)));
        let share = |(scheme, _): (Scheme, f64)| {
            if scheme.pick == Pick::Random {
                return self.by_chance(asked);
            }
            let retrieval = if scheme.pick == Pick::FirstK { &first_k[1] } else { &hill[1] };
            let (gate, one_subset) = match scheme.gate {
                Gate::None => return self.share(asked, scheme, retrieval, None, None),
                Gate::Strong => (&strong, None),
                Gate::FirstK => (&by_first_k[0], Some(&by_first_k[1])),
                Gate::Hill => (&by_hill[0], Some(&by_hill[1])),
            };
            self.share(asked, scheme, retrieval, Some(gate), one_subset)
        };
        Scheme::published().into_iter().map(share).collect()
    }

    /// The readings that make a difference to a scheme, the strict one first: the order of what [`Pass::share`] and
    /// [`Pass::by_chance`] say.
    fn readings(scheme: Scheme) -> &'static [Reading] {
        use Reading::{AnySize, ClassByClass, Itself, OneSubset, Strict};
        match (scheme.gate, scheme.pick) {
            (_, Pick::Random) => &[Strict, Itself, AnySize],
            (Gate::None, _) => &[Strict, Itself],
            (Gate::Strong, _) => &[Strict, Itself, ClassByClass],
            (Gate::FirstK | Gate::Hill, _) => &[Strict, Itself, ClassByClass, OneSubset],
        }
    }

    fn share(
        &self,
        asked: usize,
        scheme: Scheme,
        retrieval: &[u32],
        gate: Option<&Vec<u32>>,
        one_subset: Option<&Vec<u32>>,
    ) -> Share {
        let (labels, relevant) = (self.exam.labels(), self.relevant[asked]);
        let find = |ranking: Vec<u32>| ranks(ranking, labels, self.exam.label(asked));
        let Some(gate) = gate else {
            let ranks = find(retrieval.to_vec());
            return Share {
                gained: vec![
                    gained(&self.recall, relevant, &ranks),
                    gained_with_itself(&self.recall, relevant, &ranks),
                ],
                precision: precision(relevant, &ranks, self.levels),
            };
        };
        let within = |kept: &[u32]| {
            let members = retrieval.iter().copied().filter(|&model| kept.contains(&labels[model as usize]));
            members.collect::<Vec<_>>()
        };
        let keep = |classes: &[u32]| classes[..classes.len().min(scheme.kept as usize)].to_vec();
        let kept = keep(gate);
        let ranks = find(within(&kept));
        let one_by_one = find(kept.iter().flat_map(|&class| within(&[class])).collect());
        let mut of = vec![
            gained(&self.recall, relevant, &ranks),
            gained_with_itself(&self.recall, relevant, &ranks),
            gained(&self.recall, relevant, &one_by_one),
        ];
        of.extend(one_subset.map(|gate| gained(&self.recall, relevant, &find(within(&keep(gate))))));
        Share { gained: of, precision: precision(relevant, &ranks, self.levels) }
    }

    /// By random subsets: strictly, with itself and of any size, each draw after draw.
    fn by_chance(&self, asked: usize) -> Share {
        let relevant = self.relevant[asked];
        let find =
            |selection: &Vec<u32>| ranks(self.rank(asked, selection), self.exam.labels(), self.exam.label(asked));
        let drawn: Vec<Vec<usize>> = self.subsets.random.iter().map(find).collect();
        let strict = drawn.iter().map(|ranks| gained(&self.recall, relevant, ranks));
        let itself = drawn.iter().map(|ranks| gained_with_itself(&self.recall, relevant, ranks));
        let any_size = self.subsets.any_size.iter().map(|draw| gained(&self.recall, relevant, &find(draw)));
        let mut mean = vec![0.0; self.levels];
        for ranks in &drawn {
            for (mean, precision) in mean.iter_mut().zip(precision(relevant, ranks, self.levels)) {
                *mean += precision / drawn.len() as f64;
            }
        }
        Share { gained: strict.chain(itself).chain(any_size).collect(), precision: mean }
    }

    fn rank(&self, asked: usize, selection: &[u32]) -> Vec<u32> {
        let sums = sums(self.exam, &self.columns, asked, self.distance, selection);
        ranking(&sums, self.exam.left_out(asked))
    }

    /// The classes in the order of their nearest models.
    fn by_distance(&self, ranking: &[u32]) -> Vec<u32> {
        let mut seen = vec![false; self.strong.len()];
        let classes = ranking.iter().map(|&model| self.exam.labels()[model as usize]);
        classes.filter(|&class| !std::mem::replace(&mut seen[class as usize], true)).collect()
    }

    /// The classes by p(C|M), of several alike the lowest first.
    fn by_strong(&self, asked: usize) -> Vec<u32> {
        let known = (0..self.strong.len()).filter(|&class| self.ranges.known(class));
        let score = |class: usize| self.strong[class].score(class, &self.ranges, self.exam.row(asked));
        let mut scored: Vec<(f64, u32)> = known.map(|class| (score(class), class as u32)).collect();
        scored.sort_by(|a, b| b.0.total_cmp(&a.0));
        scored.into_iter().map(|(_, class)| class).collect()
    }

    /// Means over the models asked.
    fn figures(&self, scheme: Scheme, shares: &[Vec<Share>], at: usize) -> Side {
        let asked = shares.len();
        let mean = |nth: usize| {
            let sum: u128 = shares.iter().map(|share| share[at].gained[nth]).sum();
            if asked == 0 { 0.0 } else { sum as f64 / (self.recall.scale() * asked as u128) as f64 }
        };
        let readings = Self::readings(scheme);
        let draws = if scheme.pick == Pick::Random { self.subsets.random.len() } else { 1 };
        let means = |nth: usize| (nth * draws..(nth + 1) * draws).map(mean).collect::<Vec<_>>();
        let average = |values: &[f64]| values.iter().sum::<f64>() / values.len().max(1) as f64;
        let strict = means(0);
        let centre = average(&strict);
        let squares: f64 = strict.iter().map(|mean| (mean - centre).powi(2)).sum();
        let mut precision = vec![0.0; self.levels];
        for share in shares {
            for (mean, one) in precision.iter_mut().zip(&share[at].precision) {
                *mean += one;
            }
        }
        for mean in &mut precision {
            *mean /= asked.max(1) as f64;
        }
        let readings = (0..).zip(readings).map(|(nth, &reading)| (reading, average(&means(nth)))).collect();
        Side { readings, spread: (squares / draws.saturating_sub(1).max(1) as f64).sqrt(), precision }
    }
}

#[cfg(test)]
mod tests {
    use super::{Draws, Sources, retrieval};
    use crate::{
        metrics::{
            Cancelled, Distance, Exam, Features, Sample, adr, figures, rank,
            samples::{nobody, one_class, sample},
        },
        selection::{Climb, Cost, Step, Strong, boost, climb},
        study::{Climbed, FirstK, Gate, Pick, Reading, Retrieved, Scheme, climbed, first_k},
        watch::{Unwatched, Watch},
    };

    struct Selected {
        first_k: FirstK,
        climb_error: Climbed,
        climb_adr: Climbed,
        strong: Vec<Strong>,
    }

    impl Selected {
        fn on(sample: &Sample) -> Self {
            let climbed = |cost| {
                let climb = climb(sample, Distance::L1, cost, &Unwatched).unwrap();
                climbed(sample, Distance::L1, &climb)
            };
            Self {
                first_k: first_k(sample, Distance::L1, &Unwatched).unwrap(),
                climb_error: climbed(Cost::Error),
                climb_adr: climbed(Cost::Adr),
                strong: boost(sample, 6, &Unwatched).unwrap(),
            }
        }

        fn sources(&self) -> Sources<'_> {
            let Self { first_k, climb_error, climb_adr, strong } = self;
            Sources { first_k, climb_error, climb_adr, strong }
        }
    }

    fn of(sample: &Sample) -> Vec<Retrieved> {
        let draws = Draws { seed: 3, count: 5 };
        retrieval(sample, Distance::L1, Selected::on(sample).sources(), draws, &Unwatched).unwrap()
    }

    fn find(rows: &[Retrieved], gate: Gate, pick: Pick, kept: u32) -> &Retrieved {
        rows.iter().find(|row| row.scheme == Scheme { gate, pick, kept }).unwrap()
    }

    fn read(row: &Retrieved, reading: Reading) -> f64 {
        row.readings.iter().find(|read| read.reading == reading).unwrap().adr.query.unwrap()
    }

    #[test]
    fn without_classes_it_is_the_mean_adr_of_the_tables() {
        for seed in 0..3 {
            let sample = sample(seed, 8, 20, 0);
            let (rows, selected) = (of(&sample), Selected::on(&sample));
            assert_eq!(find(&rows, Gate::None, Pick::Hill, 0).adr, selected.climb_adr.adr);
            let best = selected.first_k.adr.at(selected.first_k.best_adr).unwrap();
            assert_eq!(find(&rows, Gate::None, Pick::FirstK, 0).adr, best);
            // There are 9 classes: 10 are all of them.
            for gate in [Gate::Strong, Gate::FirstK, Gate::Hill] {
                assert_eq!(find(&rows, gate, Pick::FirstK, 10).adr, best);
            }
        }
    }

    /// Mean ADR on the queries when the classes are ranked by the distance over `gate`.
    fn by_definition(sample: &Sample, gate: &[u32], subset: &[u32], kept: usize, one_by_one: bool) -> f64 {
        let exam = Exam::queries(sample);
        let (mut sum, mut counted) = (0.0, 0);
        for asked in 0..exam.len() {
            let label = exam.label(asked);
            let Some(_) = adr(&rank(exam, asked, Distance::L1, subset), exam.labels(), label) else { continue };
            let mut classes: Vec<u32> = Vec::new();
            for model in rank(exam, asked, Distance::L1, gate) {
                let class = exam.labels()[model as usize];
                if !classes.contains(&class) {
                    classes.push(class);
                }
            }
            classes.truncate(kept);
            let mut members = rank(exam, asked, Distance::L1, subset);
            let place = |model: &u32| classes.iter().position(|&class| class == exam.labels()[*model as usize]);
            members.retain(|model| place(model).is_some());
            if one_by_one {
                members.sort_by_key(place);
            }
            // Q counts those that were not kept, too.
            let relevant = exam.labels().iter().filter(|&&other| other == label).count();
            let found = |i: usize| members.iter().take(i).filter(|&&m| exam.labels()[m as usize] == label).count();
            sum += (1..=relevant).map(|i| found(i) as f64 / i as f64).sum::<f64>() / relevant as f64;
            counted += 1;
        }
        sum / f64::from(counted)
    }

    #[test]
    fn classes_are_kept_as_defined() {
        for seed in 0..3 {
            let sample = sample(seed, 8, 20, 0);
            let (rows, selected) = (of(&sample), Selected::on(&sample));
            let first = |k: usize| (1..=k as u32).collect::<Vec<_>>();
            let (k_error, k_adr) = (first(selected.first_k.best_error), first(selected.first_k.best_adr));
            let row = find(&rows, Gate::FirstK, Pick::FirstK, 5);
            let near = |ours: f64, theirs: f64| assert!((ours - theirs).abs() < 1e-13, "{ours} {theirs}");
            near(row.adr.query.unwrap(), by_definition(&sample, &k_error, &k_adr, 5, false));
            near(read(row, Reading::OneSubset), by_definition(&sample, &k_adr, &k_adr, 5, false));
            near(read(row, Reading::ClassByClass), by_definition(&sample, &k_error, &k_adr, 5, true));
            let row = find(&rows, Gate::Hill, Pick::FirstK, 5);
            near(row.adr.query.unwrap(), by_definition(&sample, &selected.climb_error.climb.order(), &k_adr, 5, false));
        }
    }

    #[test]
    fn random_subsets_are_scored_draw_by_draw() {
        let sample = sample(1, 6, 12, 0);
        let (rows, selected) = (of(&sample), Selected::on(&sample));
        let row = find(&rows, Gate::None, Pick::Random, 0);
        let size = selected.climb_adr.climb.selected.len();
        let mut chance = crate::metrics::Chance::new(3, 0);
        let adrs: Vec<f64> =
            (0..5).map(|_| figures(Exam::queries(&sample), Distance::L1, &chance.choose(size, 12)).1).collect();
        let mean = adrs.iter().sum::<f64>() / 5.0;
        assert!((row.adr.query.unwrap() - mean).abs() < 1e-13);
        let variance = adrs.iter().map(|adr| (adr - mean).powi(2)).sum::<f64>() / 4.0;
        assert!((row.spread.unwrap().query.unwrap() - variance.sqrt()).abs() < 1e-13);
        assert!(rows.iter().all(|row| row.spread.is_some() == (row.scheme.pick == Pick::Random)));
    }

    /// Two classes of two on a line, and a query of each: everything by hand.
    #[test]
    fn by_hand() {
        let sample = Sample {
            train: Features::from_rows([[0.0], [4.0], [1.0], [9.0]]),
            train_labels: vec![0, 0, 1, 1],
            query: Features::from_rows([[0.4]]),
            query_labels: vec![0],
            classes: 2,
        };
        let climb = Climb { selected: vec![1], steps: vec![Step { index: 1, added: true, cost: 0.5 }] };
        let climb = climbed(&sample, Distance::L1, &climb);
        let first_k = first_k(&sample, Distance::L1, &Unwatched).unwrap();
        let strong = boost(&sample, 1, &Unwatched).unwrap();
        let sources = Sources { first_k: &first_k, climb_error: &climb, climb_adr: &climb, strong: &strong };
        let rows = retrieval(&sample, Distance::L1, sources, Draws::default(), &Unwatched).unwrap();
        // The query finds 0 (right), 1 (wrong), 4 (right): ADR = (1 + 1/2)/2; found at ranks 1 and 3.
        let row = find(&rows, Gate::None, Pick::FirstK, 0);
        assert_eq!(row.adr.query, Some(0.75));
        assert_eq!(row.precision.query, [1.0, 2.0 / 3.0]);
        // With itself: right, right, wrong of 3: (1 + 1 + 2/3)/3.
        assert!((read(row, Reading::Itself) - 8.0 / 9.0).abs() < 1e-15);
        // Both classes kept, one after the other: 0 4 1 9.
        let row = find(&rows, Gate::Hill, Pick::FirstK, 5);
        assert_eq!((row.adr.query, read(row, Reading::ClassByClass)), (Some(0.75), 1.0));
        assert_eq!(row.closest(0.99).unwrap().reading, Reading::ClassByClass);
        assert_eq!(row.closest(0.7).unwrap().reading, Reading::Strict);
        // There is one subset of one feature to draw.
        let row = find(&rows, Gate::None, Pick::Random, 0);
        assert_eq!((row.adr.query, row.spread.unwrap().query), (Some(0.75), Some(0.0)));
    }

    #[test]
    fn the_published_schemes_differ_and_hold_those_of_figure_7() {
        let schemes: Vec<_> = Scheme::published().into_iter().map(|(scheme, _)| scheme).collect();
        assert!(schemes.iter().enumerate().all(|(at, scheme)| !schemes[..at].contains(scheme)));
        assert!(Scheme::figure_7().iter().all(|scheme| schemes.contains(scheme)));
    }

    #[test]
    fn few_or_no_models() {
        for row in of(&one_class()) {
            assert_eq!((row.adr.train, row.adr.query), (1.0, None));
            assert_eq!((row.precision.train, row.precision.query), (vec![1.0; 2], Vec::new()));
        }
        assert!(of(&nobody()).iter().all(|row| row.adr.train == 0.0 && row.precision.train.is_empty()));
    }

    #[test]
    fn stops_when_cancelled() {
        struct Stop;
        impl Watch for Stop {
            fn cancelled(&self) -> bool {
                true
            }
        }
        let sample = sample(5, 5, 5, 0);
        let selected = Selected::on(&sample);
        let stopped = retrieval(&sample, Distance::L1, selected.sources(), Draws::default(), &Stop);
        assert_eq!(stopped, Err(Cancelled));
    }
}

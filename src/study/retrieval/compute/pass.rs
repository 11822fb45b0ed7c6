//! One exam: every model asked once, in every scheme.

use rayon::prelude::*;

use super::{
    super::{Gate, Pick, Reading, Scheme},
    Subsets,
};
use crate::{
    metrics::{
        Cancelled, Columns, Distance, Exam, Recall, Sample, gained, gained_with_itself, precision, ranking, ranks, sums,
    },
    selection::{Ranges, Strong},
    watch::Watch,
};

/// One side's figures of a scheme.
pub(super) struct Side {
    pub(super) readings: Vec<(Reading, f64)>,
    pub(super) spread: f64,
    pub(super) precision: Vec<f64>,
}

/// What one model asked adds to a scheme's figures, by reading or by draw; and its precision.
struct Share {
    gained: Vec<u128>,
    precision: Vec<f64>,
}

/// All schemes' figures of one exam.
pub(super) fn side(
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

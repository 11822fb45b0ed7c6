//! The few models that may be among the nearest, kept while distances grow.

use std::hint::black_box;

use pulp::Simd;

/// How much longer than needed a new list is: the longer, the more to compare, the shorter, the sooner it is outgrown.
const SPARE: usize = 3;

/// Distance sums that only grow, and a list of models that holds the nearest.
///
/// When it was made, the list held all models within a reach. Whoever is not on it is beyond that for good, so the list
/// holds the nearest as long as enough of its models are within.
#[derive(Debug, Clone)]
pub(super) struct Shortlist {
    /// The sum of every model, then padding. What is not to be found stands at infinity.
    pub(super) sums: Vec<f64>,
    /// How many models are looked for.
    looks: usize,
    reach: f64,
    /// The relatives on the list, then the strangers.
    list: Vec<u32>,
    relatives: usize,
    /// Their sums, padded at the end of the relatives, and whole.
    near: Vec<f64>,
    /// By relative on the list, padded: how many models of the list are nearer, and how many no farther, itself too.
    before: Vec<u64>,
    level: Vec<u64>,
    spare: Vec<f64>,
}

impl Shortlist {
    /// For rows of `stride` sums.
    pub(super) fn new(stride: usize) -> Self {
        Self {
            sums: vec![0.0; stride],
            looks: 0,
            reach: -1.0,
            list: Vec::new(),
            relatives: 0,
            near: Vec::new(),
            before: Vec::new(),
            level: Vec::new(),
            spare: Vec::new(),
        }
    }

    /// Begins a row in which the nearest `looks` of `models` models are looked for: all sums are 0, but for the padding
    /// and the model left out.
    pub(super) fn begin(&mut self, models: usize, left_out: Option<usize>, looks: usize) {
        self.sums[..models].fill(0.0);
        self.sums[models..].fill(f64::INFINITY);
        if let Some(model) = left_out {
            self.sums[model] = f64::INFINITY;
        }
        self.looks = looks.min(models - usize::from(left_out.is_some()));
        // Nobody is within.
        (self.reach, self.relatives) = (-1.0, 0);
        self.list.clear();
    }

    /// Calls `found` with the rank, from 0, of each relative among the nearest; equal sums are ordered by model. In any
    /// order of the ranks.
    #[inline(always)]
    pub(super) fn find<S: Simd>(&mut self, simd: S, related: impl Fn(u32) -> bool, mut found: impl FnMut(usize)) {
        self.gather(simd);
        let within = self.near.iter().fold(0, |count, &sum| count + usize::from(sum <= self.reach));
        if within < self.looks {
            self.renew(&related);
            self.gather(simd);
        }
        self.rank(simd);
        let ranks = || self.before[..self.relatives].iter().zip(&self.level);
        // Itself is as near as itself.
        if ranks().all(|(&before, &level)| level == before + 1 || before >= self.looks as u64) {
            ranks().filter(|(before, _)| **before < self.looks as u64).for_each(|(&before, _)| found(before as usize));
            return;
        }
        let entry = |&model: &u32| (self.sums[model as usize], model);
        let mut order: Vec<(f64, u32)> = self.list.iter().map(entry).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let ranked = order.iter().take(self.looks).enumerate();
        ranked.filter(|(_, (_, model))| related(*model)).for_each(|(rank, _)| found(rank));
    }

    /// Takes the sums of the list together.
    #[inline(always)]
    fn gather<S: Simd>(&mut self, _: S) {
        let padded = self.relatives.next_multiple_of(S::F64_LANES);
        let (relatives, strangers) = self.list.split_at(self.relatives);
        self.near.clear();
        self.near.extend(relatives.iter().map(|&model| self.sums[model as usize]));
        self.near.resize(padded, f64::INFINITY);
        self.near.extend(strangers.iter().map(|&model| self.sums[model as usize]));
        let whole = self.near.len().next_multiple_of(S::F64_LANES);
        self.near.resize(whole, f64::INFINITY);
    }

    /// Counts for the relatives on the list how many of its models are before them.
    #[inline(always)]
    fn rank<S: Simd>(&mut self, simd: S) {
        let padded = self.relatives.next_multiple_of(S::F64_LANES);
        self.before.resize(padded, 0);
        self.level.resize(padded, 0);
        let (relatives, _) = S::as_simd_f64s(&self.near[..padded]);
        let (before, _) = S::as_mut_simd_u64s(&mut self.before[..padded]);
        let (level, _) = S::as_mut_simd_u64s(&mut self.level[..padded]);
        // Were it known to be one, masks would be made numbers to be subtracted: one instruction more.
        let one = simd.splat_u64s(black_box(1));
        for ((&relatives, before), level) in relatives.iter().zip(before).zip(level) {
            let mut nearer = simd.splat_u64s(0);
            let mut as_near = simd.splat_u64s(0);
            for &sum in &self.near {
                let sum = simd.splat_f64s(sum);
                let less = simd.less_than_f64s(sum, relatives);
                nearer = simd.select_u64s(less, simd.add_u64s(nearer, one), nearer);
                let no_more = simd.less_than_or_equal_f64s(sum, relatives);
                as_near = simd.select_u64s(no_more, simd.add_u64s(as_near, one), as_near);
            }
            (*before, *level) = (nearer, as_near);
        }
    }

    /// Makes the list anew, of all models within a reach that holds somewhat more than are looked for.
    fn renew(&mut self, related: impl Fn(u32) -> bool) {
        let length = self.looks + self.looks / 2 + SPARE;
        // What is left of the last list is near, so that few others are nearer than its farthest.
        self.reach = match self.list.len() {
            count if count > length => self.nth(length),
            0 => f64::MAX,
            _ => self.list.iter().fold(0.0, |reach, &model| self.sums[model as usize].max(reach)),
        };
        self.collect();
        if self.list.len() > 2 * length {
            self.reach = self.nth(length);
            self.collect();
        }
        self.relatives = 0;
        for at in 0..self.list.len() {
            if related(self.list[at]) {
                self.list.swap(at, self.relatives);
                self.relatives += 1;
            }
        }
    }

    /// The `nth` least sum of the list, from 0.
    fn nth(&mut self, nth: usize) -> f64 {
        self.spare.clear();
        self.spare.extend(self.list.iter().map(|&model| self.sums[model as usize]));
        *self.spare.select_nth_unstable_by(nth, f64::total_cmp).1
    }

    /// Lists all models within reach.
    fn collect(&mut self) {
        self.list.clear();
        self.list.resize(self.sums.len(), 0);
        let mut count = 0;
        for (model, &sum) in (0..).zip(&self.sums) {
            self.list[count] = model;
            count += usize::from(sum <= self.reach);
        }
        self.list.truncate(count);
    }
}

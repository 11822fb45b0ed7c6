//! The nearest few models of a row of distances, found again after the distances have changed a little.

/// Distances looked at in one go.
const CHUNK: usize = 16;

/// A row of distance sums and the list of its nearest models.
///
/// The row is padded to a multiple of 16; padding and the model left out stand at infinity.
#[derive(Debug, Clone)]
pub(crate) struct Nearest {
    models: usize,
    left_out: Option<usize>,
    /// The distance sum of every model.
    pub(crate) sums: Vec<f64>,
    /// Ascending by distance, then by model.
    top: Vec<(f64, u32)>,
    /// Models whose entry equals `stamp` were in the list when the search began.
    stamps: Vec<u32>,
    stamp: u32,
}

impl Nearest {
    /// For rows of `stride` sums, of which the first `models` are models.
    pub(crate) fn new(models: usize, stride: usize) -> Self {
        Self { models, left_out: None, sums: vec![0.0; stride], top: Vec::new(), stamps: vec![0; stride], stamp: 0 }
    }

    /// Begins a row: all sums are 0, but for the padding and the model left out. The list is empty.
    pub(crate) fn begin(&mut self, left_out: Option<usize>) {
        self.left_out = left_out;
        self.sums[..self.models].fill(0.0);
        self.sums[self.models..].fill(f64::INFINITY);
        if let Some(model) = left_out {
            self.sums[model] = f64::INFINITY;
        }
        self.top.clear();
    }

    /// How many models a list can hold at most.
    const fn available(&self) -> usize {
        self.models - self.left_out.is_some() as usize
    }

    /// Starts the list with models that are likely to be near, and fills it up to `count` with any others.
    ///
    /// The models must differ from one another and from the one left out.
    pub(crate) fn seed(&mut self, count: usize, likely: impl IntoIterator<Item = u32>) {
        let count = count.min(self.available());
        self.top.clear();
        self.top.extend(likely.into_iter().take(count).map(|model| (0.0, model)));
        if self.top.len() < count {
            self.mark();
            let others = (0..self.models).filter(|&model| Some(model) != self.left_out);
            let others = others.filter(|&model| self.stamps[model] != self.stamp);
            self.top.extend(others.take(count - self.top.len()).map(|model| (0.0, model as u32)));
        }
    }

    fn mark(&mut self) {
        if self.stamp == u32::MAX {
            self.stamps.fill(0);
            self.stamp = 0;
        }
        self.stamp += 1;
        for &(_, model) in &self.top {
            self.stamps[model as usize] = self.stamp;
        }
    }

    /// Makes the list that of the nearest models by the sums as they are now; its length stays.
    ///
    /// Whatever the list held before, the result is exact. The closer it was, the less there is to do.
    #[inline(always)]
    #[expect(clippy::needless_bitwise_bool, reason = "a lazy operator is a branch, and branches are not vectorised")]
    pub(crate) fn update(&mut self) -> &[(f64, u32)] {
        for at in 0..self.top.len() {
            let model = self.top[at].1;
            self.sift(at, (self.sums[model as usize], model));
        }
        self.mark();
        let Some(&(mut reach, _)) = self.top.last() else { return &self.top };
        for first in (0..self.sums.len()).step_by(CHUNK) {
            let near = self.sums[first..first + CHUNK].iter().fold(false, |near, &sum| near | (sum <= reach));
            if near {
                reach = self.take(first, reach);
            }
        }
        &self.top
    }

    /// Takes what belongs into the list from one chunk; returns the list's greatest distance.
    fn take(&mut self, first: usize, mut reach: f64) -> f64 {
        for model in first..(first + CHUNK).min(self.models) {
            let sum = self.sums[model];
            if sum <= reach && self.stamps[model] != self.stamp && Some(model) != self.left_out {
                let last = self.top.len() - 1;
                if before((sum, model as u32), self.top[last]) {
                    self.sift(last, (sum, model as u32));
                    reach = self.top[last].0;
                }
            }
        }
        reach
    }

    /// Puts `entry` where it belongs among the first `at` entries, in the place of the one at `at`.
    #[inline(always)]
    fn sift(&mut self, mut at: usize, entry: (f64, u32)) {
        while at > 0 && before(entry, self.top[at - 1]) {
            self.top[at] = self.top[at - 1];
            at -= 1;
        }
        self.top[at] = entry;
    }
}

/// Whether `a` comes before `b`: the smaller distance, then the lower model.
#[inline(always)]
pub(crate) fn before(a: (f64, u32), b: (f64, u32)) -> bool {
    a.0 < b.0 || (a.0 == b.0 && a.1 < b.1)
}

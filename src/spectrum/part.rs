//! The chain of shifts along the λ axis of one connected piece, and the bands between them.

use super::{
    band::Band,
    factor::Factor,
    krylov::{Krylov, Purpose, Scratch},
    lanes::WIDTH,
    pencil::Pencil,
    poll::{Poll, Stop},
    slice::{Found, Scales, Side, Sides, join, sharpen},
    thorough::thorough,
};

/// Eigenvalues that a slice aims at.
const TARGET: f64 = 48.0;
/// Eigenvalues that a slice may have before it is made narrower.
const MOST: usize = 76;
/// Blocks of a basis after which a process gives up.
const BLOCKS: usize = 36;
/// Blocks after which it looks at its Ritz values for the first time; as many as most processes need but one.
const FIRST_LOOK: usize = 18;

/// Everything that the parts share while one of them works.
#[derive(Debug, Default)]
pub(super) struct Tools {
    pub factor: Factor,
    pub scratch: Scratch,
}

/// A connected piece with a sparse solver.
#[derive(Debug)]
pub(super) struct Part {
    number: u32,
    pencil: Pencil,
    /// 1ᵀB1 in the scaled unit.
    measure: f64,
    /// What turns its λ into the mesh's.
    unit: f64,
    bands: Vec<Band>,
    /// Where the chain begins, in the scaled unit, and how many eigenvalues are below: zero and none, unless only a
    /// stretch of the spectrum is wanted.
    origin: (f64, usize),
    /// The right side of the last shift, if that process ran in this session.
    right: Option<Side>,
}

impl Part {
    pub(super) fn new(number: u32, pencil: Pencil, unit: f64, known: &[Band]) -> Self {
        let measure = pencil.matrix.total_mass();
        let mut mine: Vec<&Band> = known.iter().filter(|band| band.part == number).collect();
        mine.sort_by_key(|band| band.place);
        let mut bands: Vec<Band> = Vec::new();
        for band in mine {
            if band.follows(bands.last()) && band.above <= pencil.order() {
                bands.push(band.clone());
            }
        }
        Self { number, pencil, measure, unit, bands, origin: (0.0, 0), right: None }
    }

    pub(super) fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// Below which λ of the mesh all eigenvalues are known.
    pub(super) fn frontier(&self) -> f64 {
        self.bands.last().map_or(self.origin.0 * self.unit, |band| band.upper)
    }

    /// Whether its smallest eigenvalue is zero.
    pub(super) fn has_kernel(&self) -> bool {
        self.pencil.kernel
    }

    pub(super) fn finished(&self) -> bool {
        self.counted() == self.pencil.order()
    }

    fn counted(&self) -> usize {
        self.bands.last().map_or(self.origin.1, |band| band.above)
    }

    /// Lets the chain begin below a λ of the mesh, at a shift that is returned with the number of eigenvalues below it.
    ///
    /// # Errors
    /// When cancelled, or when no shift there will do.
    pub(super) fn begin_below(
        &mut self,
        lambda: f64,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<(f64, usize), Advance> {
        let mut sigma = lambda / self.unit;
        let half = self.first_half();
        for _ in 0..60 {
            sigma -= 0.013 * half;
            if sigma <= 0.0 {
                return Ok((0.0, 0));
            }
            let Some(below) = self.factor(tools, sigma, poll)? else { continue };
            let near = 1e-6 * half / TARGET;
            let task = Task { sigma, above: below, left: 0.0, right: Some(half), near };
            match self.process(tools, task, poll) {
                Ok(sides) => self.right = Some(sides.right),
                Err(Advance::TooNear) => continue,
                Err(other) => return Err(other),
            }
            self.origin = (sigma, below);
            return Ok((sigma * self.unit, below));
        }
        Err(Advance::Uncertified { at: lambda })
    }

    /// Half of what a slice spans by Weyl's law: λ grows by 4π over the area from one eigenvalue to the next.
    fn first_half(&self) -> f64 {
        0.5 * TARGET * 4.0 * std::f64::consts::PI / self.measure
    }

    /// Ends of the last band in the scaled unit, and its eigenvalues.
    fn last(&self) -> Option<(f64, f64, usize)> {
        self.bands.last().map(|band| (band.lower / self.unit, band.upper / self.unit, band.values.len()))
    }

    /// The distance to the next shift, from what the slice before had: `(lower, upper, eigenvalues)`.
    fn step(lower: f64, upper: f64, count: usize) -> f64 {
        // The first slice begins at zero and is half as wide as the ones after it.
        let width = if lower == 0.0 { 2.0 * upper } else { upper - lower };
        let count = if lower == 0.0 { 2 * count } else { count };
        (TARGET / (count.max(1) as f64) * width).clamp(0.5 * width, 2.5 * width)
    }

    /// Solves the next band, knowing that no more than `count` eigenvalues are wanted in all: that spares work which
    /// only bands above it need.
    ///
    /// # Errors
    /// When cancelled, or when the certificate cannot be had.
    pub(super) fn advance(&mut self, tools: &mut Tools, count: usize, poll: &mut Poll) -> Result<(), Advance> {
        if self.right.is_none()
            && let Some((lower, upper, within)) = self.last()
        {
            // The process at the last shift once more: it ran in another session, and took the same course there.
            let found = self.factor(tools, upper, poll)?;
            if found != Some(self.counted()) {
                return Err(Advance::Uncertified { at: upper * self.unit });
            }
            let task = Task {
                sigma: upper,
                above: self.counted(),
                left: upper - self.middle(self.bands.len() - 1),
                right: Some(0.5 * Self::step(lower, upper, within)),
                near: 0.0,
            };
            self.right = Some(self.process(tools, task, poll)?.right);
        }
        let (lower, mut upper) = match self.last() {
            None if self.origin.0 > 0.0 => (self.origin.0, self.origin.0 + 2.0 * self.first_half()),
            None => (0.0, self.first_half()),
            Some((lower, upper, count)) => (upper, upper + Self::step(lower, upper, count)),
        };
        let below = self.counted();
        let middle = self.middle(self.bands.len());
        let right = self.right.take().unwrap_or_default();
        // A shift on top of an eigenvalue, or one with too many before it, is moved by a rule that knows nothing but
        // this part, so that it moves the same way every time.
        for attempt in 0..60 {
            let Some(above) = self.factor(tools, upper, poll)? else {
                upper += 0.013 * (upper - lower);
                continue;
            };
            let Some(total) = above.checked_sub(below) else {
                return Err(Advance::Uncertified { at: upper * self.unit });
            };
            let most = if lower == 0.0 { MOST / 2 } else { MOST };
            if total > most && upper - lower > 1e-7 * upper && attempt < 40 {
                upper = lower + (upper - lower) * (0.8 * TARGET / total as f64).clamp(0.1, 0.8);
                continue;
            }
            let half = 0.5 * Self::step(lower, upper, total);
            let task = Task {
                sigma: upper,
                above,
                left: upper - middle,
                right: (above < count).then_some(half),
                near: 1e-6 * (upper - lower) / total.max(1) as f64,
            };
            let sides = match self.process(tools, task, poll) {
                Ok(sides) => sides,
                Err(Advance::TooNear) => {
                    upper += 0.013 * (upper - lower);
                    continue;
                }
                Err(other) => return Err(other),
            };
            let joined = join(&right.found, &sides.left.found, total);
            let mut found = match joined {
                Some(found) => found,
                None => thorough(&self.pencil, tools, lower..upper, total, self.seed(1), poll)?
                    .ok_or(Advance::Uncertified { at: upper * self.unit })?,
            };
            sharpen(&mut found, if below == 0 { f64::NEG_INFINITY } else { lower }, upper);
            self.right = task.right.map(|_| sides.right);
            return self.finish(lower, upper, above, found);
        }
        Err(Advance::Uncertified { at: upper * self.unit })
    }

    /// Where the right side of the process below a band gives over to the left side of the one above it.
    fn middle(&self, place: usize) -> f64 {
        let start = if self.origin.0 > 0.0 { self.origin.0 + self.first_half() } else { 0.0 };
        place.checked_sub(1).map_or(start, |before| {
            let band = &self.bands[before];
            let (lower, upper) = (band.lower / self.unit, band.upper / self.unit);
            upper + 0.5 * Self::step(lower, upper, band.values.len())
        })
    }

    /// Factors at σ and counts; `None` when rounding may have spoilt the factor, so that σ has to move.
    fn factor(&self, tools: &mut Tools, sigma: f64, poll: &mut Poll) -> Result<Option<usize>, Advance> {
        match tools.factor.compute(&self.pencil.symbolic, &self.pencil.matrix, sigma, poll) {
            Ok(negative) => {
                #[cfg(test)]
                let negative = tools.scratch.tamper.count(negative);
                Ok(tools.factor.is_sound().then_some(negative))
            }
            Err(Stop::Pivot) => Ok(None),
            Err(Stop::Cancelled) => Err(Advance::Cancelled),
        }
    }

    fn seed(&self, kind: u64) -> u64 {
        (kind << 62) ^ (u64::from(self.number) << 32) ^ self.bands.len() as u64
    }

    /// Runs Lanczos at a factored shift until both sides reach as far as they are asked to.
    fn process(&self, tools: &mut Tools, task: Task, poll: &mut Poll) -> Result<Sides, Advance> {
        let Task { sigma, above, left, right, near } = task;
        let beyond = self.pencil.order() - above;
        let seed = sigma.to_bits().rotate_left(17) ^ u64::from(self.number);
        let Tools { factor, scratch } = tools;
        poll.meter.timings.processes += 1;
        let mut krylov = Krylov::start(&self.pencil, factor, sigma, seed, Purpose::Values, scratch, poll)?;
        let most = BLOCKS.min((self.pencil.order() - 1) / WIDTH);
        let mut done = Sides::default();
        let spacing = (left + right.unwrap_or(left)) / TARGET;
        let mut look = FIRST_LOOK;
        for blocks in 1..=most {
            krylov.step(poll)?;
            if blocks != most && blocks != look {
                continue;
            }
            let Some(ritz) = krylov.ritz(poll) else { break };
            let scales = Scales { sigma, spacing, least: 1e-4 * sigma, accuracy: krylov.accuracy() };
            #[cfg_attr(not(test), expect(unused_mut, reason = "a test changes what was found"))]
            let mut sides = Sides::new(&ritz, scales);
            #[cfg(test)]
            krylov.tamper(&mut sides);
            if sides.nearest < near {
                return Err(Advance::TooNear);
            }
            // Each side is taken as it is when it has reached far enough, however long the other one takes.
            if done.left.reach < left && done.left.found.len() < above {
                done.left = sides.left;
            }
            if right.is_some_and(|right| done.right.reach < right) && done.right.found.len() < beyond {
                done.right = sides.right;
            }
            let wanting = |side: &Side, reach: f64, all: usize| side.reach < reach && side.found.len() < all;
            let share = if wanting(&done.left, left, above) {
                done.left.reach / left
            } else if let Some(right) = right.filter(|right| wanting(&done.right, *right, beyond)) {
                done.right.reach / right
            } else {
                break;
            };
            // What is looked at, and when, must not depend on the right side before the left one is done: whether
            // that is wanted depends on how many eigenvalues are asked for.
            look = blocks + if share < 0.6 { 3 } else { 1 + usize::from(share < 0.85) };
        }
        Ok(done)
    }

    /// Appends the band.
    fn finish(&mut self, lower: f64, upper: f64, above: usize, mut found: Vec<Found>) -> Result<(), Advance> {
        let first = self.bands.is_empty() && self.origin.0 == 0.0;
        let failed = Advance::Uncertified { at: upper * self.unit };
        let zeros = usize::from(first && self.pencil.kernel);
        if zeros == 1 {
            // It is the smallest eigenvalue, and every other one is above it.
            let Some(zero) = found.first_mut() else { return Err(failed) };
            if zero.value.abs() > 1e-7 * upper {
                return Err(failed);
            }
            *zero = Found::exactly(0.0, 0.0);
        }
        if found.get(zeros).is_some_and(|next| next.value <= 0.0) {
            return Err(failed);
        }
        self.bands.push(Band {
            part: self.number,
            place: self.bands.len() as u32,
            lower: lower * self.unit,
            upper: if above == self.pencil.order() { f64::MAX } else { upper * self.unit },
            below: self.counted(),
            above,
            zeros,
            values: found.iter().map(|found| found.value * self.unit).collect(),
            errors: found.iter().map(|found| found.error * self.unit).collect(),
        });
        Ok(())
    }
}

/// One process.
#[derive(Clone, Copy)]
struct Task {
    sigma: f64,
    /// Eigenvalues below σ.
    above: usize,
    /// How far it is to see on its left side.
    left: f64,
    /// How far it is to see on its right side, if that is wanted.
    right: Option<f64>,
    /// An eigenvalue nearer than this moves the shift.
    near: f64,
}

/// Why a part does not advance.
#[derive(Debug)]
pub(super) enum Advance {
    Cancelled,
    TooNear,
    Uncertified { at: f64 },
}

impl From<Stop> for Advance {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Cancelled => Self::Cancelled,
            Stop::Pivot => Self::TooNear,
        }
    }
}

//! The chain of shifts along the λ axis of one connected piece, and the bands between them.

use super::{
    band::Band,
    factor::Factor,
    krylov::{Krylov, Scratch},
    lanes::WIDTH,
    pencil::Pencil,
    poll::{Poll, Stop},
    slice::{Found, Side, Sides, join},
    thorough::thorough,
};

/// Eigenvalues that a slice aims at.
const TARGET: f64 = 40.0;
/// Eigenvalues that a slice may have before it is made narrower.
const MOST: usize = 64;
/// Blocks of a basis after which a process gives up.
const BLOCKS: usize = 30;
/// The largest entry that the triangular factor may have: errors of the counts and solves grow with it.
const GROWTH: f64 = 1e5;
/// Blocks after which it looks at its Ritz values for the first time, and every how many then.
const FIRST_LOOK: usize = 10;
const LOOK: usize = 2;

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
        Self { number, pencil, measure, unit, bands, right: None }
    }

    pub(super) fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// Below which λ of the mesh all eigenvalues are known.
    pub(super) fn frontier(&self) -> f64 {
        self.bands.last().map_or(0.0, |band| band.upper)
    }

    /// Whether its smallest eigenvalue is zero.
    pub(super) fn has_kernel(&self) -> bool {
        self.pencil.kernel
    }

    pub(super) fn finished(&self) -> bool {
        self.counted() == self.pencil.order()
    }

    fn counted(&self) -> usize {
        self.bands.last().map_or(0, |band| band.above)
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
            && let Some((lower, upper, count)) = self.last()
        {
            // The process at the last shift once more: it ran in another session, and took the same course there.
            let found = self.factor(tools, upper, poll)?;
            if found != Some(self.counted()) {
                return Err(Advance::Uncertified { at: upper * self.unit });
            }
            let ahead = Ahead { width: Self::step(lower, upper, count), wanted: true };
            let at = (upper, self.counted());
            self.right = self.process(tools, at, ahead, &mut |_| Verdict::Settled, poll)?.1;
        }
        let (lower, mut upper) = match self.last() {
            None => (0.0, 0.5 * TARGET * 4.0 * std::f64::consts::PI / self.measure),
            Some((lower, upper, count)) => (upper, upper + Self::step(lower, upper, count)),
        };
        let below = self.counted();
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
            let ahead = Ahead { width: Self::step(lower, upper, total), wanted: above < count };
            let spacing = (upper - lower) / total.max(1) as f64;
            let near = 1e-6 * spacing;
            let mut joined = None;
            let mut judge = |sides: &Sides| {
                if sides.nearest < near {
                    return Verdict::TooNear;
                }
                joined = join(&right.found, &sides.left.found, total);
                if joined.is_some() { Verdict::Settled } else { Verdict::More }
            };
            let next = match self.process(tools, (upper, above), ahead, &mut judge, poll) {
                Ok((_, next)) => next,
                Err(Advance::TooNear) => {
                    upper += 0.013 * (upper - lower);
                    continue;
                }
                Err(other) => return Err(other),
            };
            let found = match joined {
                Some(found) => found,
                None => thorough(&self.pencil, tools, lower..upper, total, self.seed(1), poll)?
                    .ok_or(Advance::Uncertified { at: upper * self.unit })?,
            };
            self.right = next;
            return self.finish(lower, upper, above, found);
        }
        Err(Advance::Uncertified { at: upper * self.unit })
    }

    /// Factors at σ and counts; `None` when rounding may have spoilt the factor, so that σ has to move.
    fn factor(&self, tools: &mut Tools, sigma: f64, poll: &mut Poll) -> Result<Option<usize>, Advance> {
        match tools.factor.compute(&self.pencil.symbolic, &self.pencil.matrix, sigma, poll) {
            Ok(negative) => Ok((tools.factor.growth() < GROWTH).then_some(negative)),
            Err(Stop::Pivot) => Ok(None),
            Err(Stop::Cancelled) => Err(Advance::Cancelled),
        }
    }

    fn seed(&self, kind: u64) -> u64 {
        (kind << 62) ^ (u64::from(self.number) << 32) ^ self.bands.len() as u64
    }

    /// Runs Lanczos at a factored shift until the left side satisfies `judge` and the right side reaches half of the
    /// step ahead. Returns whether the left side did, and the right side as it was when it had reached so far:
    /// neither depends on how long the other took.
    fn process(
        &self,
        tools: &mut Tools,
        (sigma, above): (f64, usize),
        ahead: Ahead,
        judge: &mut dyn FnMut(&Sides) -> Verdict,
        poll: &mut Poll,
    ) -> Result<(bool, Option<Side>), Advance> {
        let beyond = self.pencil.order() - above;
        let seed = sigma.to_bits().rotate_left(17) ^ u64::from(self.number);
        let Tools { factor, scratch } = tools;
        poll.meter.timings.processes += 1;
        let mut krylov = Krylov::start(&self.pencil, factor, sigma, seed, &[], scratch, poll)?;
        let most = BLOCKS.min((self.pencil.order() - 1) / WIDTH);
        let mut settled = false;
        let mut right = None;
        let mut latest = Side::default();
        let half = 0.5 * ahead.width;
        while krylov.blocks() <= most {
            krylov.step(poll)?;
            let blocks = krylov.blocks() - 1;
            if blocks != most && (blocks < FIRST_LOOK || !(blocks - FIRST_LOOK).is_multiple_of(LOOK)) {
                continue;
            }
            let Some(ritz) = krylov.ritz(poll) else { break };
            let sides = Sides::new(&ritz, sigma, ahead.width / TARGET, 1e-4 * sigma);
            if !settled {
                match judge(&sides) {
                    Verdict::Settled => settled = true,
                    Verdict::More => {}
                    Verdict::TooNear => return Err(Advance::TooNear),
                }
            }
            if right.is_none() && ahead.wanted {
                latest = sides.right;
                if latest.reach >= half || latest.found.len() >= beyond {
                    right = Some(std::mem::take(&mut latest));
                }
            }
            if settled && (right.is_some() || !ahead.wanted) {
                break;
            }
        }
        Ok((settled, ahead.wanted.then(|| right.unwrap_or(latest))))
    }

    /// Appends the band.
    fn finish(&mut self, lower: f64, upper: f64, above: usize, mut found: Vec<Found>) -> Result<(), Advance> {
        let first = self.bands.is_empty();
        let failed = Advance::Uncertified { at: upper * self.unit };
        let zeros = usize::from(first && self.pencil.kernel);
        if zeros == 1 {
            // It is the smallest eigenvalue, and every other one is above it.
            let Some(zero) = found.first_mut() else { return Err(failed) };
            if zero.value.abs() > 1e-7 * upper {
                return Err(failed);
            }
            *zero = Found { value: 0.0, near: 0.0, error: 0.0 };
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

/// What a process is to find right of its shift.
#[derive(Clone, Copy)]
struct Ahead {
    /// The distance to the next shift.
    width: f64,
    /// Whether there will be one in this session.
    wanted: bool,
}

/// What is thought of the left side of a process.
enum Verdict {
    /// It has what the slice needs.
    Settled,
    /// Go on.
    More,
    /// The shift has to move away from an eigenvalue.
    TooNear,
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

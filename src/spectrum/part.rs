//! The chain of shifts along the λ axis of one connected piece, and the bands between them.
//!
//! A band takes three steps. Its upper shift is [placed](Piece::place) by what the band before counts, without looking
//! at any eigenvalue; a process [looks](Piece::look) at the eigenvalues near that shift; and the band is
//! [made](Piece::band) of what the processes at its two ends have seen. So processes at several shifts can run at
//! once ([`team`](super::team)); only at its end a process has to know how much the one below it has seen, for it goes
//! on until it has seen the rest. [`Stretch`](super::window) takes the steps one after the other.

use self::shift::Aims;
pub(super) use self::shift::{End, Ending, Shift};
use super::{
    band::Band,
    factor::Factor,
    krylov::{Basis, Krylov, LONGEST, Scratch},
    lanes::WIDTH,
    pencil::Pencil,
    poll::{Poll, Stop},
    slice::{Found, Scales, Side, Sides, join, sharpen},
    thorough::thorough,
};

mod shift;

/// Eigenvalues that a slice may have before it is made narrower, as a multiple of what it aims at.
const MOST: f64 = 1.4;
/// Blocks of a basis after which a process gives up. One more is made of the last one.
const BLOCKS: usize = LONGEST - 1;
/// Blocks after which a process looks at its Ritz values for the first time, as many as most processes need between
/// slices of [`USUAL`] eigenvalues, and for how many more eigenvalues it waits for one more; and in the lowest process,
/// which needs fewer, for nothing is beyond its left side.
const FIRST_LOOK: f64 = 26.0;
const USUAL: f64 = 72.0;
const PER_BLOCK: f64 = 4.5;
const LOWEST_LOOK: usize = 19;
/// A process with b blocks has mostly seen 2 b eigenvalues on each side, but for so many.
const UNSEEN: usize = 17;
/// How much of what a process is to see on its right side it has to see. The process above sees the rest.
const ENOUGH: f64 = 0.9;
/// What one more block adds to what is seen of a side, as a share of what is wanted.
const SHARE: f64 = 0.06;

/// With fewer rows a basis is kept in double precision. It may come to hold a good part of the space, and what is left
/// of that is then so little that single precision does not know it from rounding.
const FEW_ROWS: usize = 1408;

/// What a thread works with: the memory of a factorisation and of a process, for one piece after the other.
#[derive(Debug, Default)]
pub(super) struct Tools {
    pub factor: Factor,
    pub scratch: Scratch,
    /// The most rows of a piece that they were used for.
    pub largest: usize,
}

/// A connected piece with a sparse solver; nothing of it changes while it is solved.
#[derive(Debug)]
pub(super) struct Piece {
    pub number: u32,
    pub pencil: Pencil,
    /// 1ᵀB1 in the scaled unit.
    measure: f64,
    /// What turns its λ into the mesh's.
    pub unit: f64,
}

impl Piece {
    pub(super) fn new(number: u32, pencil: Pencil, unit: f64) -> Self {
        let measure = pencil.matrix.total_mass();
        Self { number, pencil, measure, unit }
    }

    /// Those of the known bands that are of this piece and continue each other from zero.
    pub(super) fn taken_over(&self, known: &[Band]) -> Vec<Band> {
        let mut mine: Vec<&Band> = known.iter().filter(|band| band.part == self.number).collect();
        mine.sort_by_key(|band| (band.place, band.early));
        let mut bands: Vec<Band> = Vec::new();
        for band in mine {
            if band.follows(bands.last()) && band.above <= self.pencil.order() {
                bands.push(band.clone());
            }
        }
        bands
    }

    /// The end of a chain with these bands.
    pub(super) fn end(&self, bands: &[Band]) -> End {
        match bands.last() {
            None => End { place: 0, upper: 0.0, above: 0, step: self.first_half(), middle: 0.0 },
            Some(band) => {
                let counts = (band.below, band.above);
                End::new(band.place, band.lower / self.unit, band.upper / self.unit, counts, self.aims())
            }
        }
    }

    /// Half of what a slice spans by Weyl's law: λ grows by 4π over the area from one eigenvalue to the next.
    fn first_half(&self) -> f64 {
        0.5 * Aims::LOWEST * 4.0 * std::f64::consts::PI / self.measure
    }

    /// How many eigenvalues lie below a λ of the mesh, or below one a little above it where a shift there will not do.
    ///
    /// # Errors
    /// When cancelled, or when no shift there will do.
    pub(super) fn below(&self, lambda: f64, tools: &mut Tools, poll: &mut Poll) -> Result<usize, Advance> {
        let (sigma, step) = (lambda / self.unit, 0.013 * self.first_half());
        for attempt in 0..60 {
            if let Some(count) = self.factor(tools, sigma + f64::from(attempt) * step, poll)? {
                return Ok(count);
            }
        }
        Err(Advance::Uncertified { at: lambda })
    }

    /// A beginning of a chain below a λ of the mesh: its end, and what the process there sees on its right side. `None`
    /// when it is at zero.
    ///
    /// # Errors
    /// When cancelled, or when no shift there will do.
    pub(super) fn begin_below(
        &self,
        lambda: f64,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<Option<(End, Side)>, Advance> {
        let mut sigma = lambda / self.unit;
        let half = self.first_half();
        for _ in 0..60 {
            sigma -= 0.013 * half;
            if sigma <= 0.0 {
                return Ok(None);
            }
            let Some(above) = self.factor(tools, sigma, poll)? else { continue };
            let near = 1e-6 * half / Aims::LOWEST;
            let task = Task { sigma, above, left: 0.0, right: half, both: true, aim: Aims::LOWEST, near };
            match self.process(tools, task, &mut |_| Ok(0), poll) {
                Ok(sides) => {
                    let end = End { place: 0, upper: sigma, above, step: 2.0 * half, middle: sigma + half };
                    return Ok(Some((end, sides.right)));
                }
                Err(Advance::TooNear) => {}
                Err(other) => return Err(other),
            }
        }
        Err(Advance::Uncertified { at: lambda })
    }

    /// The process at the last shift of these bands once more, for its right side: it ran in another session, and takes
    /// the same course as there.
    ///
    /// # Errors
    /// When cancelled, or when the count is another one than the bands say.
    pub(super) fn resume(&self, bands: &[Band], tools: &mut Tools, poll: &mut Poll) -> Result<Sides, Advance> {
        let end = self.end(bands);
        let found = self.factor(tools, end.upper, poll)?;
        if found != Some(end.above) {
            return Err(Advance::Uncertified { at: end.upper * self.unit });
        }
        let before = self.end(&bands[..bands.len() - 1]);
        let (left, right) = (end.upper - before.middle, 0.5 * end.step);
        let aim = self.aims().between(before.above, end.above);
        let task = Task { sigma: end.upper, above: end.above, left, right, both: true, aim, near: 0.0 };
        let wanted = bands.last().map_or(0, |last| last.values.len() - last.seen);
        self.process(tools, task, &mut |_| Ok(wanted), poll)
    }

    /// Places the shift after an end, and leaves its factor in the tools. `again` is where to try first, and how often
    /// it was tried, when the shift had to move.
    ///
    /// # Errors
    /// When cancelled, or when no shift there will do.
    pub(super) fn place(
        &self,
        end: &End,
        again: Option<(f64, u32)>,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<Shift, Advance> {
        let (lower, below) = (end.upper, end.above);
        let (mut upper, first) = again.unwrap_or((end.upper + end.step, 0));
        // A shift on top of an eigenvalue, or one with too many before it, is moved.
        for attempt in first..60 {
            let Some(above) = self.factor(tools, upper, poll)? else {
                upper += 0.013 * (upper - lower);
                continue;
            };
            let Some(total) = above.checked_sub(below) else { break };
            let target = if lower == 0.0 { 0.5 * Aims::LOWEST } else { self.aims().above(below) };
            if total as f64 > MOST * target && upper - lower > 1e-7 * upper && attempt < 40 {
                upper = lower + (upper - lower) * (0.8 * target / total as f64).clamp(0.1, 0.8);
                continue;
            }
            return Ok(Shift {
                place: end.place,
                lower,
                upper,
                below,
                above,
                middle: end.middle,
                attempt,
                aims: self.aims(),
            });
        }
        Err(Advance::Uncertified { at: upper * self.unit })
    }

    /// Factors at a shift that was placed, once more.
    ///
    /// # Errors
    /// When cancelled, or when the count is another one than before.
    pub(super) fn return_to(&self, shift: &Shift, tools: &mut Tools, poll: &mut Poll) -> Result<(), Advance> {
        let found = self.factor(tools, shift.upper, poll)?;
        if found == Some(shift.above) { Ok(()) } else { Err(Advance::Uncertified { at: shift.upper * self.unit }) }
    }

    /// Looks at the eigenvalues near a shift whose factor is in the tools. No more than `count` eigenvalues are wanted
    /// in all: that spares work which only bands above need. `seen` is asked how many eigenvalues of the slice below
    /// the process before has seen on its right side, so that this one has to see the others only.
    ///
    /// # Errors
    /// When cancelled, when an eigenvalue is too near, or what `seen` gives.
    pub(super) fn look(
        &self,
        shift: &Shift,
        count: usize,
        seen: &mut dyn FnMut(&mut Poll) -> Result<usize, Advance>,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<Sides, Advance> {
        let &Shift { lower, upper, below, above, middle, .. } = shift;
        let task = Task {
            sigma: upper,
            above,
            left: upper - middle,
            right: 0.5 * shift.end().step,
            both: above < count,
            aim: self.aims().between(below, above),
            near: 1e-6 * (upper - lower) / (above - below).max(1) as f64,
        };
        self.process(tools, task, &mut |poll| Ok((above - below).saturating_sub(seen(poll)?)), poll)
    }

    /// The band below a shift, from the right side of the process at its lower end and the left side of that at the
    /// shift.
    ///
    /// # Errors
    /// When cancelled, or when the certificate cannot be had.
    pub(super) fn band(
        &self,
        shift: &Shift,
        right: &Side,
        left: &Side,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<Band, Advance> {
        let &Shift { lower, upper, below, above, .. } = shift;
        let total = above - below;
        let mut found = match join(&right.found, &left.found, total) {
            Some(found) => found,
            None => thorough(&self.pencil, tools, lower..upper, total, self.seed(1, shift.place), poll)?
                .ok_or(Advance::Uncertified { at: upper * self.unit })?,
        };
        sharpen(&mut found, if below == 0 { f64::NEG_INFINITY } else { lower }, upper);
        let seen = right.found.len().min(total);
        self.finish(shift, found).map(|band| Band { seen, ..band })
    }

    /// The beginning of the band after these, up to σ: the first `count` eigenvalues on the right side of the process
    /// at their end. `None` when the count at σ is another one.
    ///
    /// # Errors
    /// When cancelled.
    pub(super) fn ended(
        &self,
        bands: &[Band],
        right: &Side,
        ending: Ending,
        tools: &mut Tools,
        poll: &mut Poll,
    ) -> Result<Option<Band>, Advance> {
        let End { place, upper: lower, above: below, middle, .. } = self.end(bands);
        let Ending { sigma: upper, count } = ending;
        let above = below + count;
        if self.factor(tools, upper, poll)? != Some(above) {
            return Ok(None);
        }
        let Some(mut found) = join(&right.found[..count], &[], count) else { return Ok(None) };
        sharpen(&mut found, if below == 0 { f64::NEG_INFINITY } else { lower }, upper);
        let shift = Shift { place, lower, upper, below, above, middle, attempt: 0, aims: self.aims() };
        Ok(self.finish(&shift, found).ok().map(|band| Band { early: true, ..band }))
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

    fn seed(&self, kind: u64, place: u32) -> u64 {
        (kind << 62) ^ (u64::from(self.number) << 32) ^ u64::from(place)
    }

    /// Runs Lanczos at a factored shift until both sides have come as far as they are asked to. `wanted` says at the
    /// first look how many eigenvalues are wanted on the left side.
    fn process(
        &self,
        tools: &mut Tools,
        task: Task,
        wanted: &mut dyn FnMut(&mut Poll) -> Result<usize, Advance>,
        poll: &mut Poll,
    ) -> Result<Sides, Advance> {
        let Task { sigma, above, left, right, both, aim, near } = task;
        let beyond = self.pencil.order() - above;
        let seed = sigma.to_bits().rotate_left(17) ^ u64::from(self.number);
        let Tools { factor, scratch, .. } = tools;
        poll.meter.timings.processes += 1;
        let basis =
            if self.pencil.order() < FEW_ROWS { Basis::Double(&[]) } else { Basis::Single { reach: left.max(right) } };
        let mut krylov = Krylov::start(&self.pencil, factor, sigma, seed, basis, scratch, poll)?;
        let most = BLOCKS.min((self.pencil.order() - 1) / WIDTH);
        let mut done = Sides::default();
        let mut needed = None;
        let enough = if both { ENOUGH * right } else { 0.0 };
        let spacing = (left + right) / aim;
        let lowest = sigma <= left;
        let mut look = if lowest { LOWEST_LOOK } else { (FIRST_LOOK + (aim - USUAL) / PER_BLOCK) as usize };
        for blocks in 1..=most {
            krylov.step(poll)?;
            if blocks != most && blocks != look {
                continue;
            }
            let count = match needed {
                Some(count) => count,
                None => *needed.insert(wanted(poll)?.min(above)),
            };
            if !lowest && blocks != most && 2 * blocks < count + UNSEEN {
                look = (count + UNSEEN).div_ceil(2);
                continue;
            }
            let Some(ritz) = krylov.ritz(poll) else { break };
            let scales =
                Scales { sigma, spacing, least: 1e-4 * sigma, accuracy: krylov.accuracy(), leak: krylov.leak() };
            #[cfg_attr(not(test), expect(unused_mut, reason = "a test changes what was found"))]
            let mut sides = Sides::new(&ritz, scales);
            #[cfg(test)]
            krylov.tamper(&mut sides);
            if sides.nearest < near {
                return Err(Advance::TooNear);
            }
            // Each side is taken as it is when it has come far enough, however long the other one takes.
            if done.left.found.len() < count {
                done.left = sides.left;
            }
            if done.right.reach < enough && done.right.found.len() < beyond {
                done.right = sides.right;
            }
            let share = if done.left.found.len() < count {
                done.left.found.len() as f64 / count as f64
            } else if done.right.reach < enough && done.right.found.len() < beyond {
                done.right.reach / enough
            } else {
                break;
            };
            // What is looked at, and when, must not depend on the right side before the left one is done: whether
            // that is wanted depends on how many eigenvalues are asked for.
            look = blocks + ((1.0 - share) / SHARE).round().max(1.0) as usize;
        }
        Ok(done)
    }

    /// The band of these eigenvalues.
    fn finish(&self, shift: &Shift, mut found: Vec<Found>) -> Result<Band, Advance> {
        let &Shift { place, lower, upper, below, above, .. } = shift;
        let failed = Advance::Uncertified { at: upper * self.unit };
        let zeros = if lower == 0.0 { self.pencil.kernel } else { 0 };
        // They are the smallest eigenvalues, and every other one is above them.
        let Some(kernel) = found.get_mut(..zeros) else { return Err(failed) };
        for zero in kernel {
            if zero.value.abs() > zero.near.max(1e-7 * upper) {
                return Err(failed);
            }
            *zero = Found::exactly(0.0, 0.0);
        }
        if found.get(zeros).is_some_and(|next| next.value <= 0.0) {
            return Err(failed);
        }
        Ok(Band {
            part: self.number,
            place,
            lower: lower * self.unit,
            upper: if above == self.pencil.order() { f64::MAX } else { upper * self.unit },
            below,
            above,
            seen: 0,
            early: false,
            zeros,
            values: found.iter().map(|found| found.value * self.unit).collect(),
            errors: found.iter().map(|found| found.error * self.unit).collect(),
        })
    }
}

/// One process.
#[derive(Clone, Copy)]
struct Task {
    sigma: f64,
    /// Eigenvalues below σ.
    above: usize,
    /// How far from σ the middle of the slice below it is.
    left: f64,
    /// The same of the slice above it.
    right: f64,
    /// Whether its right side is wanted.
    both: bool,
    /// How many eigenvalues there may be on both sides.
    aim: f64,
    /// An eigenvalue nearer than this moves the shift.
    near: f64,
}

/// Why a part does not advance.
#[derive(Debug, Clone, Copy)]
pub(super) enum Advance {
    Cancelled,
    TooNear,
    /// Another process has to come first.
    Deferred,
    Uncertified {
        at: f64,
    },
}

impl From<Stop> for Advance {
    fn from(stop: Stop) -> Self {
        match stop {
            Stop::Cancelled => Self::Cancelled,
            Stop::Pivot => Self::TooNear,
        }
    }
}

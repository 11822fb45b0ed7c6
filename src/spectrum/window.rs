//! The eigenvalues of a stretch of the λ axis, without those below it.

use std::ops::Range;

use super::{
    Count, SpectrumError,
    band::Band,
    dense::dense,
    part::{Advance, End, Piece, Tools},
    poll::Poll,
    slice::Side,
    solve::{pencil, pieces},
    timings::{Cost, Timings},
};
use crate::{
    laplacian::Laplacian,
    watch::{Pulse, Watch},
};

/// All eigenvalues between two numbers, certified complete by inertia counts on both sides.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// The eigenvalues, ascending and with their multiplicities.
    pub values: Vec<f64>,
    /// For each of them a bound on its error.
    pub errors: Vec<f64>,
    /// How many eigenvalues of the mesh lie below the first one.
    pub below: usize,
    /// The counts: one below the stretch and one above it, at least, for every piece that is not solved whole.
    pub certificate: Vec<Count>,
    /// As in [`Spectrum::order`](super::Spectrum::order).
    pub order: usize,
    /// As in [`Spectrum::measure`](super::Spectrum::measure).
    pub measure: f64,
    /// As in [`Spectrum::notes`](super::Spectrum::notes).
    pub notes: Vec<String>,
    /// What it took, by part.
    pub timings: Timings,
}

fn cancelled() -> SpectrumError {
    SpectrumError::Cancelled { finished: Vec::new() }
}

/// Why the stretch from this λ has no certificate.
fn refused(advance: Advance, start: f64) -> SpectrumError {
    match advance {
        Advance::Cancelled => cancelled(),
        Advance::TooNear | Advance::Deferred => SpectrumError::Uncertified { at: start, finished: Vec::new() },
        Advance::Uncertified { at } => SpectrumError::Uncertified { at, finished: Vec::new() },
    }
}

/// The pieces of a mesh, ready to be looked at anywhere.
struct Pieces<'a> {
    laplacian: &'a Laplacian,
    /// All eigenvalues of the small ones, with bounds.
    small: Vec<(f64, f64)>,
    large: Vec<Piece>,
    tools: Tools,
    poll: Poll<'a>,
}

impl<'a> Pieces<'a> {
    fn new(laplacian: &'a Laplacian, watch: &'a dyn Watch) -> Result<Self, SpectrumError> {
        let unit = laplacian.unit();
        let (mut poll, pulse) = (Poll::new(watch), Pulse::new(watch));
        let (rows, large_rows) = pieces(laplacian);
        let mut small: Vec<(f64, f64)> = Vec::new();
        for rows in &rows {
            if watch.cancelled() {
                return Err(cancelled());
            }
            let all = dense(&laplacian.matrix.select(rows, &pulse)?)
                .ok_or_else(|| SpectrumError::Refused("a small piece is too degenerate to solve".to_owned()))?;
            small.extend(all.iter().map(|one| (one.value * unit, one.error * unit)));
        }
        poll.charge(Cost::Dense);
        let mut large = Vec::with_capacity(large_rows.len());
        for (at, rows) in large_rows.iter().enumerate() {
            let pencil = pencil(&laplacian.matrix.select(rows, &pulse)?, watch)?;
            poll.charge(Cost::Ordering);
            large.push(Piece::new(at as u32 + 1, pencil, unit));
        }
        Ok(Self { laplacian, small, large, tools: Tools::default(), poll })
    }

    /// How many eigenvalues lie below λ, or below one a little above it where λ is too near to an eigenvalue.
    fn below(&mut self, lambda: f64) -> Result<usize, SpectrumError> {
        let mut count = self.small.iter().filter(|(value, _)| *value < lambda).count();
        for piece in &self.large {
            count +=
                piece.below(lambda, &mut self.tools, &mut self.poll).map_err(|advance| refused(advance, lambda))?;
        }
        Ok(count)
    }

    /// A target that is not far above all eigenvalues, with the same ones nearest to it.
    fn within(&mut self, target: f64) -> Result<f64, SpectrumError> {
        let order = self.laplacian.matrix.order();
        let (mut some, mut all) = (4.0 * std::f64::consts::PI / self.laplacian.measure(), target);
        if self.below(all)? < order {
            return Ok(target);
        }
        while all > 2.0 * some {
            let mid = some.sqrt() * all.sqrt();
            if self.below(mid)? == order {
                all = mid;
            } else {
                some = mid;
            }
        }
        Ok(all)
    }

    /// All eigenvalues in a range, ends included.
    fn between(&mut self, range: &Range<f64>) -> Result<Window, SpectrumError> {
        let mut found: Vec<(f64, f64)> = Vec::new();
        let mut below = 0;
        let mut certificate = Vec::new();
        let mut take = |value: f64, error: f64, below: &mut usize| {
            if value < range.start {
                *below += 1;
            } else if value <= range.end {
                found.push((value, error));
            }
        };
        for &(value, error) in &self.small {
            take(value, error, &mut below);
        }
        for piece in &self.large {
            let mut stretch = Stretch::new(piece);
            let failed = |advance| refused(advance, range.start);
            if range.start > 0.0 {
                let (shift, count) =
                    stretch.begin_below(range.start, &mut self.tools, &mut self.poll).map_err(failed)?;
                below += count;
                certificate.push(Count { part: piece.number, shift, below: count });
            }
            while !stretch.finished() && stretch.frontier() <= range.end {
                let done = stretch.bands.len();
                stretch.advance(&mut self.tools, &mut self.poll).map_err(failed)?;
                for band in &stretch.bands[done..] {
                    certificate.push(Count { part: piece.number, shift: band.upper, below: band.above });
                    for (&value, &error) in band.values.iter().zip(&band.errors) {
                        take(value, error, &mut below);
                    }
                }
            }
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (values, errors) = found.into_iter().unzip();
        self.poll.charge(Cost::Rest);
        Ok(Window {
            values,
            errors,
            below,
            certificate,
            order: self.laplacian.matrix.order(),
            measure: self.laplacian.measure(),
            notes: self.laplacian.notes.clone(),
            timings: self.poll.meter.timings.clone(),
        })
    }
}

pub(super) fn between(laplacian: &Laplacian, range: &Range<f64>, watch: &dyn Watch) -> Result<Window, SpectrumError> {
    Pieces::new(laplacian, watch)?.between(range)
}

/// The `count` eigenvalues nearest to a target. Inertia counts, at a tenth of the price of a process each, say first
/// how far from it they reach.
pub(super) fn near(
    laplacian: &Laplacian,
    target: f64,
    count: usize,
    watch: &dyn Watch,
) -> Result<Window, SpectrumError> {
    let order = laplacian.matrix.order();
    let count = count.min(order);
    let mut pieces = Pieces::new(laplacian, watch)?;
    let target = pieces.within(target)?;
    // By Weyl's law λ grows by 4π over the area from one eigenvalue to the next.
    let mut half = 4.0 * std::f64::consts::PI / laplacian.measure() * (0.5 * count as f64 + 2.0);
    loop {
        let start = (target - half).max(0.0);
        let below = if start == 0.0 { 0 } else { pieces.below(start)? };
        let inside = pieces.below(target + half)?.saturating_sub(below);
        if inside < count && below + inside < order {
            half *= (1.1 * count as f64 / inside.max(1) as f64).clamp(1.2, 8.0);
            continue;
        }
        let mut window = pieces.between(&(start..target + half))?;
        if window.values.len() < count {
            // A count was taken a little above where it was asked for.
            half *= 1.2;
            continue;
        }
        let mut by_distance: Vec<usize> = (0..window.values.len()).collect();
        by_distance.sort_by(|&a, &b| {
            let distance = |at: usize| (window.values[at] - target).abs();
            distance(a).total_cmp(&distance(b))
        });
        by_distance.truncate(count);
        // The nearest ones are neighbours of each other.
        let first = by_distance.iter().copied().min().unwrap_or(0);
        window.below += first;
        window.values = window.values[first..first + count].to_vec();
        window.errors = window.errors[first..first + count].to_vec();
        return Ok(window);
    }
}

/// A stretch of the chain of one piece, band by band on one thread.
#[derive(Debug)]
struct Stretch<'a> {
    piece: &'a Piece,
    bands: Vec<Band>,
    end: End,
    /// The right side of the last shift.
    right: Side,
}

impl<'a> Stretch<'a> {
    /// Begins at zero.
    fn new(piece: &'a Piece) -> Self {
        let end = piece.end(&[]);
        Self { piece, bands: Vec::new(), end, right: Side::default() }
    }

    /// Below which λ of the mesh all eigenvalues are known that are not below the beginning.
    fn frontier(&self) -> f64 {
        self.bands.last().map_or(self.end.upper() * self.piece.unit, |band| band.upper)
    }

    fn finished(&self) -> bool {
        self.end.above() == self.piece.pencil.order()
    }

    /// Lets the chain begin below a λ of the mesh, at a shift that is returned with the number of eigenvalues below it.
    fn begin_below(&mut self, lambda: f64, tools: &mut Tools, poll: &mut Poll) -> Result<(f64, usize), Advance> {
        let Some((end, right)) = self.piece.begin_below(lambda, tools, poll)? else { return Ok((0.0, 0)) };
        (self.end, self.right) = (end, right);
        Ok((self.frontier(), end.above()))
    }

    /// Makes the next band.
    ///
    /// # Errors
    /// When cancelled, or when the certificate cannot be had.
    fn advance(&mut self, tools: &mut Tools, poll: &mut Poll) -> Result<(), Advance> {
        let mut again = None;
        let (shift, sides) = loop {
            let shift = self.piece.place(&self.end, again, tools, poll)?;
            match self.piece.look(&shift, usize::MAX, &mut |_| Ok(self.right.found.len()), tools, poll) {
                Ok(sides) => break (shift, sides),
                Err(Advance::TooNear) => again = Some(shift.moved()),
                Err(other) => return Err(other),
            }
        };
        self.bands.push(self.piece.band(&shift, &self.right, &sides.left, tools, poll)?);
        self.end = shift.end();
        self.right = sides.right;
        Ok(())
    }
}

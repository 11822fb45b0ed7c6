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
    /// What it took, by part.
    pub timings: Timings,
}

pub(super) fn between(laplacian: &Laplacian, range: Range<f64>, watch: &dyn Watch) -> Result<Window, SpectrumError> {
    let unit = laplacian.unit();
    let cancelled = || SpectrumError::Cancelled { finished: Vec::new() };
    let (mut poll, pulse) = (Poll::new(watch), Pulse::new(watch));
    let mut tools = Tools::default();
    let (small, large) = pieces(laplacian);
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
    for rows in &small {
        if watch.cancelled() {
            return Err(cancelled());
        }
        let all = dense(&laplacian.matrix.select(rows, &pulse)?)
            .ok_or_else(|| SpectrumError::Refused("a small piece is too degenerate to solve".to_owned()))?;
        for one in all {
            take(one.value * unit, one.error * unit, &mut below);
        }
    }
    poll.charge(Cost::Dense);
    for (at, rows) in large.iter().enumerate() {
        let number = at as u32 + 1;
        let pencil = pencil(&laplacian.matrix.select(rows, &pulse)?, watch)?;
        poll.charge(Cost::Ordering);
        let mut stretch = Stretch::new(Piece::new(number, pencil, unit));
        let failed = |advance| match advance {
            Advance::Cancelled => cancelled(),
            Advance::TooNear => SpectrumError::Uncertified { at: range.start, finished: Vec::new() },
            Advance::Uncertified { at } => SpectrumError::Uncertified { at, finished: Vec::new() },
        };
        if range.start > 0.0 {
            let (shift, count) = stretch.begin_below(range.start, &mut tools, &mut poll).map_err(failed)?;
            below += count;
            certificate.push(Count { part: number, shift, below: count });
        }
        while !stretch.finished() && stretch.frontier() <= range.end {
            let done = stretch.bands.len();
            stretch.advance(&mut tools, &mut poll).map_err(failed)?;
            for band in &stretch.bands[done..] {
                certificate.push(Count { part: number, shift: band.upper, below: band.above });
                for (&value, &error) in band.values.iter().zip(&band.errors) {
                    take(value, error, &mut below);
                }
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (values, errors) = found.into_iter().unzip();
    poll.charge(Cost::Rest);
    Ok(Window { values, errors, below, certificate, timings: poll.meter.timings })
}

/// The `count` eigenvalues nearest to a target, by windows around it that widen until they hold as many.
pub(super) fn near(
    laplacian: &Laplacian,
    target: f64,
    count: usize,
    watch: &dyn Watch,
) -> Result<Window, SpectrumError> {
    let count = count.min(laplacian.matrix.order());
    // By Weyl's law λ grows by 4π over the area from one eigenvalue to the next.
    let mut half = 4.0 * std::f64::consts::PI / laplacian.measure() * (0.5 * count as f64 + 2.0);
    let mut timings = Timings::default();
    loop {
        let mut window = between(laplacian, (target - half).max(0.0)..target + half, watch)?;
        timings.add(&window.timings);
        let whole = window.below == 0 && window.values.len() == laplacian.matrix.order();
        if window.values.len() >= count || whole {
            let mut by_distance: Vec<usize> = (0..window.values.len()).collect();
            by_distance.sort_by(|&a, &b| {
                let distance = |at: usize| (window.values[at] - target).abs();
                distance(a).total_cmp(&distance(b))
            });
            by_distance.truncate(count);
            // The nearest ones are neighbours of each other.
            let first = by_distance.iter().copied().min().unwrap_or(0);
            window.below += first;
            window.values = window.values[first..first + by_distance.len()].to_vec();
            window.errors = window.errors[first..first + by_distance.len()].to_vec();
            return Ok(Window { timings, ..window });
        }
        half *= 1.6;
    }
}

/// A stretch of the chain of one piece, band by band on one thread.
#[derive(Debug)]
struct Stretch {
    piece: Piece,
    bands: Vec<Band>,
    end: End,
    /// The right side of the last shift.
    right: Side,
}

impl Stretch {
    /// Begins at zero.
    fn new(piece: Piece) -> Self {
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
            match self.piece.look(&shift, usize::MAX, tools, poll) {
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

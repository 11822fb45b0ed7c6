//! The eigenvalues of a stretch of the λ axis, without those below it.

use std::ops::Range;

use super::{
    Count, SpectrumError,
    dense::dense,
    part::{Advance, Part, Tools},
    pencil::Pencil,
    poll::Poll,
    solve::pieces,
    timings::{Cost, Timings},
};
use crate::{laplacian::Laplacian, watch::Watch};

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
    let mut poll = Poll::new(watch);
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
        let all = dense(&laplacian.matrix.select(rows))
            .ok_or_else(|| SpectrumError::Refused("a small piece is too degenerate to solve".to_owned()))?;
        for one in all {
            take(one.value * unit, one.error * unit, &mut below);
        }
    }
    poll.charge(Cost::Dense);
    for (at, rows) in large.iter().enumerate() {
        let number = at as u32 + 1;
        let pencil = Pencil::new(&laplacian.matrix.select(rows))
            .ok_or_else(|| SpectrumError::Refused("not enough memory to order the vertices".to_owned()))?;
        poll.charge(Cost::Ordering);
        let mut part = Part::new(number, pencil, unit, &[]);
        let failed = |advance| match advance {
            Advance::Cancelled => cancelled(),
            Advance::TooNear => SpectrumError::Uncertified { at: range.start, finished: Vec::new() },
            Advance::Uncertified { at } => SpectrumError::Uncertified { at, finished: Vec::new() },
        };
        if range.start > 0.0 {
            let (shift, count) = part.begin_below(range.start, &mut tools, &mut poll).map_err(failed)?;
            below += count;
            certificate.push(Count { part: number, shift, below: count });
        }
        while !part.finished() && part.frontier() <= range.end {
            let done = part.bands().len();
            part.advance(&mut tools, usize::MAX, &mut poll).map_err(failed)?;
            for band in &part.bands()[done..] {
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

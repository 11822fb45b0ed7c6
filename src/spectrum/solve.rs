//! A mesh's pieces, and which of them is solved further.

use std::sync::Arc;

use super::{
    Request, Spectrum, SpectrumError,
    band::Band,
    dense::{LARGEST, dense},
    part::{Piece, Tools},
    pencil::Pencil,
    poll::Poll,
    slice::Found,
    team::Team,
    timings::Cost,
};
use crate::{
    laplacian::{Laplacian, Symmetric},
    watch::{Pulse, Stopped, Watch},
};

/// Solves as much of (L, B) as is asked for.
pub(super) fn solve(
    laplacian: &Laplacian,
    request: &Request,
    watch: &dyn Watch,
    tools: &mut Tools,
) -> Result<Spectrum, SpectrumError> {
    let known = request.known;
    let order = laplacian.matrix.order();
    let count = request.count.min(order);
    let (mut poll, pulse) = (Poll::new(watch), Pulse::new(watch));
    let stopped = |stopped: Stopped| SpectrumError::from(stopped).keeping(known);
    let (small, large) = pieces(laplacian);
    let small = if small.is_empty() { None } else { Some(small_pieces(laplacian, &small, known, watch)?) };
    poll.charge(Cost::Dense);
    let mut parts = Vec::with_capacity(large.len());
    for rows in &large {
        let number = parts.len() as u32 + 1;
        let matrix = if large.len() == 1 && small.is_none() {
            None
        } else {
            Some(laplacian.matrix.select(rows, &pulse).map_err(stopped)?)
        };
        let pencil =
            pencil(matrix.as_ref().unwrap_or(&laplacian.matrix), watch).map_err(|error| error.keeping(known))?;
        poll.charge(Cost::Ordering);
        poll.meter.timings.entries += pencil.symbolic.values();
        poll.meter.timings.multiplications += pencil.symbolic.multiplications();
        parts.push(Piece::new(number, pencil, laplacian.unit()));
    }
    let pieces = parts.len() as u32 + 1;
    let team = Arc::new(Team::new(parts, small, count, known));
    let opened = request.crew.map(|crew| crew.opens(&team));
    let bands = team.lead(tools, &mut poll, watch, request.keep)?;
    drop(opened);
    Ok(Spectrum {
        zeros: bands.iter().find(|band| band.part == 0).map_or(0, |band| band.zeros) + team.kernels(),
        bands,
        parts: pieces,
        order,
        measure: laplacian.measure(),
        notes: laplacian.notes.clone(),
        timings: {
            poll.charge(Cost::Rest);
            poll.meter.timings
        },
    })
}

/// L and B of a piece, ready for the solver.
pub(super) fn pencil(matrix: &Symmetric, watch: &dyn Watch) -> Result<Pencil, SpectrumError> {
    Pencil::watched(matrix, &Pulse::new(watch))?
        .ok_or_else(|| SpectrumError::Refused("not enough memory to order the vertices".to_owned()))
}

/// The rows of the connected components: those for the dense solver, and those for the sparse one.
pub(super) fn pieces(laplacian: &Laplacian) -> (Vec<Vec<u32>>, Vec<Vec<u32>>) {
    let mut rows: Vec<Vec<u32>> =
        vec![Vec::new(); laplacian.component.iter().max().map_or(0, |last| *last as usize + 1)];
    for (row, &component) in laplacian.component.iter().enumerate() {
        rows[component as usize].push(row as u32);
    }
    rows.into_iter().partition(|rows| rows.len() <= LARGEST)
}

/// All eigenvalues of all small pieces, as the only band of part 0.
fn small_pieces(
    laplacian: &Laplacian,
    small: &[Vec<u32>],
    known: &[Band],
    watch: &dyn Watch,
) -> Result<Band, SpectrumError> {
    let rows: usize = small.iter().map(Vec::len).sum();
    if let Some(band) = known.iter().find(|band| band.part == 0 && band.follows(None) && band.above == rows) {
        return Ok(band.clone());
    }
    let pulse = Pulse::new(watch);
    let mut all: Vec<Found> = Vec::with_capacity(rows);
    for rows in small {
        if watch.cancelled() {
            return Err(SpectrumError::Cancelled { finished: known.to_vec() });
        }
        let matrix =
            laplacian.matrix.select(rows, &pulse).map_err(|stopped| SpectrumError::from(stopped).keeping(known))?;
        let found = dense(&matrix).ok_or_else(|| {
            let vertex = rows.first().map_or(0, |&row| laplacian.vertices[row as usize]);
            SpectrumError::Refused(format!(
                "the piece of {} vertices at vertex {vertex} is too degenerate to solve",
                rows.len()
            ))
        })?;
        all.extend(found);
    }
    all.sort_by(|a, b| a.value.total_cmp(&b.value));
    let unit = laplacian.unit();
    Ok(Band {
        part: 0,
        place: 0,
        lower: 0.0,
        upper: f64::MAX,
        below: 0,
        above: rows,
        seen: 0,
        early: false,
        zeros: all.iter().take_while(|found| found.value == 0.0).count(),
        values: all.iter().map(|found| found.value * unit).collect(),
        errors: all.iter().map(|found| found.error * unit).collect(),
    })
}

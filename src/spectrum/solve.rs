//! A mesh's pieces, and which of them is solved further.

use super::{
    Spectrum, SpectrumError,
    band::Band,
    dense::{LARGEST, dense},
    part::{Advance, Part, Tools},
    pencil::Pencil,
    poll::Poll,
    slice::Found,
    timings::Cost,
};
use crate::{laplacian::Laplacian, watch::Watch};

pub(super) fn solve(
    laplacian: &Laplacian,
    count: usize,
    known: &[Band],
    watch: &dyn Watch,
    tools: &mut Tools,
) -> Result<Spectrum, SpectrumError> {
    let order = laplacian.matrix.order();
    let count = count.min(order);
    let mut poll = Poll::new(watch);
    let (small, large) = pieces(laplacian);
    let mut state = State { small: None, parts: Vec::with_capacity(large.len()), order };
    if !small.is_empty() {
        state.small = Some(small_pieces(laplacian, &small, known, watch)?);
        poll.charge(Cost::Dense);
    }
    for rows in &large {
        let number = state.parts.len() as u32 + 1;
        if watch.cancelled() {
            return Err(SpectrumError::Cancelled { finished: known.to_vec() });
        }
        let matrix = if large.len() == 1 && small.is_empty() { None } else { Some(laplacian.matrix.select(rows)) };
        let pencil = Pencil::new(matrix.as_ref().unwrap_or(&laplacian.matrix))
            .ok_or_else(|| SpectrumError::Refused("not enough memory to order the vertices".to_owned()))?;
        poll.charge(Cost::Ordering);
        poll.meter.timings.entries += pencil.symbolic.values();
        poll.meter.timings.multiplications += pencil.symbolic.multiplications();
        state.parts.push(Part::new(number, pencil, laplacian.unit(), known));
    }
    loop {
        let done = state.certified();
        watch.progress(done.min(count), count);
        if done >= count {
            break;
        }
        let Some(part) = state.lowest() else { break };
        match part.advance(tools, count, &mut poll) {
            Ok(()) => {}
            Err(Advance::Cancelled) => return Err(SpectrumError::Cancelled { finished: state.bands() }),
            Err(Advance::Uncertified { at }) => {
                return Err(SpectrumError::Uncertified { at, finished: state.bands() });
            }
            Err(Advance::TooNear) => {
                return Err(SpectrumError::Uncertified { at: part.frontier(), finished: state.bands() });
            }
        }
    }
    let zeros =
        state.small.as_ref().map_or(0, |band| band.zeros) + state.parts.iter().filter(|part| part.has_kernel()).count();
    Ok(Spectrum {
        bands: state.bands(),
        parts: state.parts.len() as u32 + 1,
        order,
        measure: laplacian.measure(),
        zeros,
        notes: laplacian.notes.clone(),
        timings: {
            poll.charge(Cost::Rest);
            poll.meter.timings
        },
    })
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
    let mut all: Vec<Found> = Vec::with_capacity(rows);
    for rows in small {
        if watch.cancelled() {
            return Err(SpectrumError::Cancelled { finished: known.to_vec() });
        }
        let found = dense(&laplacian.matrix.select(rows)).ok_or_else(|| {
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
        zeros: all.iter().take_while(|found| found.value == 0.0).count(),
        values: all.iter().map(|found| found.value * unit).collect(),
        errors: all.iter().map(|found| found.error * unit).collect(),
    })
}

/// What is known so far.
struct State {
    small: Option<Band>,
    parts: Vec<Part>,
    order: usize,
}

impl State {
    /// The unfinished part of which the least is known.
    fn lowest(&mut self) -> Option<&mut Part> {
        self.parts.iter_mut().filter(|part| !part.finished()).min_by(|a, b| a.frontier().total_cmp(&b.frontier()))
    }

    /// How many eigenvalues of the whole mesh are certified: those below what is known of every part.
    fn certified(&self) -> usize {
        let limit = self.parts.iter().filter(|part| !part.finished()).map(Part::frontier).fold(f64::MAX, f64::min);
        let bands = self.parts.iter().flat_map(Part::bands).chain(&self.small);
        let below = bands.map(|band| {
            if band.upper <= limit { band.values.len() } else { band.values.partition_point(|&value| value <= limit) }
        });
        below.sum::<usize>().min(self.order)
    }

    fn bands(&self) -> Vec<Band> {
        self.small.iter().chain(self.parts.iter().flat_map(Part::bands)).cloned().collect()
    }
}

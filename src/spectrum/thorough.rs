//! The slow way to a slice that resists: processes at several poles, each orthogonal to everything found before.
//!
//! It is for eigenvalues of a multiplicity above the block size and for clusters, of which one Krylov space holds no
//! more copies than its blocks have vectors.

use std::ops::Range;

use super::{
    krylov::{Basis, Krylov, Ritz},
    lanes::{Buffer, WIDTH},
    part::Tools,
    pencil::Pencil,
    poll::{Poll, Stop},
    slice::{Found, Scales, Sides},
};

/// Processes without a new eigenvalue after which it gives up.
const IDLE: usize = 4;
/// Blocks per process.
const BLOCKS: usize = 24;

/// The `total` eigenvalues in a slice, or `None` when they are not found.
///
/// # Errors
/// When cancelled.
pub(super) fn thorough(
    pencil: &Pencil,
    tools: &mut Tools,
    slice: Range<f64>,
    total: usize,
    seed: u64,
    poll: &mut Poll,
) -> Result<Option<Vec<Found>>, Stop> {
    let mut locked: Vec<Buffer> = Vec::new();
    let mut found: Vec<Found> = Vec::new();
    let mut idle = 0;
    let mut round = 0_u64;
    let width = slice.end - slice.start;
    while found.len() < total && idle < IDLE {
        round += 1;
        // Van der Corput's sequence spreads the poles over the slice.
        let place = (round.reverse_bits() >> 11) as f64 / (1_u64 << 53) as f64;
        let pole = slice.start + width * place;
        idle += 1;
        match tools.factor.compute(&pencil.symbolic, &pencil.matrix, pole, poll) {
            Ok(_) => {}
            Err(Stop::Pivot) => continue,
            Err(stop) => return Err(stop),
        }
        let room = (pencil.order() - 1) / WIDTH;
        let blocks = BLOCKS.min(room.saturating_sub(locked.len())).max(1);
        let seed = seed ^ round.rotate_left(40);
        let Tools { factor, scratch, .. } = tools;
        let mut krylov = Krylov::start(pencil, factor, pole, seed, Basis::Double(&locked), scratch, poll)?;
        for _ in 0..blocks {
            krylov.step(poll)?;
        }
        let Some(ritz) = krylov.ritz(poll) else { continue };
        let scales = Scales {
            sigma: pole,
            spacing: width / total as f64,
            least: 1e-4 * slice.end,
            accuracy: krylov.accuracy(),
            leak: krylov.leak(),
        };
        #[cfg_attr(not(test), expect(unused_mut, reason = "a test changes what was found"))]
        let mut sides = Sides::new(&ritz, scales);
        #[cfg(test)]
        krylov.tamper(&mut sides);
        let new: Vec<Found> = sides
            .left
            .found
            .into_iter()
            .chain(sides.right.found)
            .filter(|found| found.value > slice.start && found.value < slice.end)
            .collect();
        if new.is_empty() {
            continue;
        }
        idle = 0;
        let wanted: Vec<Ritz> =
            ritz.into_iter().filter(|ritz| new.iter().any(|found| found.value == ritz.value)).collect();
        if wanted.len() != new.len() {
            return Ok(None);
        }
        let Some(vectors) = krylov.vectors(&wanted) else { return Ok(None) };
        locked.extend(vectors);
        found.extend(new);
    }
    found.sort_by(|a, b| a.value.total_cmp(&b.value));
    Ok((found.len() == total).then_some(found))
}

//! Eigenvectors of chosen eigenvalues, after the fact.
//!
//! A spectrum's bands say where the eigenvalues are and that none is missing. The eigenvectors of a few of them come
//! from a short Lanczos process in their middle and two steps of inverse iteration with Rayleigh–Ritz projections in
//! double precision, which leave residuals at rounding level.
//!
//! The eigenvalues of a band are cut into windows of about eight by a rule that knows nothing of what is wanted, and
//! a window is computed whole. So an eigenvector is the same bits in whatever company it was asked for.

use self::forms::{mass_product, rayleigh, residual};
use super::{
    Spectrum, SpectrumError,
    band::Band,
    dense::direct,
    krylov::{Basis, Krylov, Ritz},
    lanes::{Buffer, WIDTH},
    part::Tools,
    pencil::{FreeParts, Pencil, free_parts},
    poll::{Poll, Stop},
    solve::pieces,
    timings::Cost,
};
use crate::{
    laplacian::{Laplacian, Symmetric},
    watch::{Pulse, Stopped, Watch},
};

mod forms;

/// One eigenvector, with xᵀBx = 1.
///
/// Its sign makes the entry of largest magnitude positive; of entries that tie but for rounding the first one. Where
/// an eigenvalue is multiple, its vectors are some B-orthonormal basis of its eigenspace.
#[derive(Debug, Clone, PartialEq)]
pub struct Eigenvector {
    /// Which of the spectrum's [eigenvalues](Spectrum::eigenvalues), from 0.
    pub index: usize,
    /// Its Rayleigh quotient: λ.
    pub value: f64,
    /// A bound on the distance of `value` from an eigenvalue: ‖Lx − λBx‖ in the norm of B⁻¹, or somewhat more.
    pub residual: f64,
    /// The function's values at the vertices of the mesh, or at the rows of the matrices. Zero where the surface is
    /// held by a boundary condition, off the piece of the mesh that it lives on, and at vertices without triangles.
    pub values: Vec<f64>,
}

/// Fewest and most eigenvalues in a window; more only where they coincide.
const FEWEST: usize = 6;
const MOST: usize = 12;
/// Steps of a process before it gives up.
const STEPS: usize = 24;

/// By rows of the matrices.
pub(super) fn eigenvectors(
    laplacian: &Laplacian,
    spectrum: &Spectrum,
    wanted: &[usize],
    watch: &dyn Watch,
) -> Result<Vec<Eigenvector>, SpectrumError> {
    let mut poll = Poll::new(watch);
    let mut tools = Tools::default();
    let places = places(spectrum);
    let (small, large) = pieces(laplacian);
    let mut found: Vec<Option<Eigenvector>> = vec![None; wanted.len()];
    let mut parts: Vec<u32> = Vec::new();
    for &index in wanted {
        let place = places.get(index).ok_or_else(|| {
            SpectrumError::Refused(format!("eigenvalue {index} is not among the {} that are known", places.len()))
        })?;
        parts.push(place.part);
    }
    parts.sort_unstable();
    parts.dedup();
    for part in parts {
        // What is wanted of this part: (place in the answer, index in the part).
        let mine: Vec<(usize, usize)> = wanted
            .iter()
            .enumerate()
            .filter(|&(_, &index)| places[index].part == part)
            .map(|(at, &index)| (at, places[index].at))
            .collect();
        let made = match part.checked_sub(1) {
            None => of_small_pieces(laplacian, &small, &mine, &Pulse::new(watch)),
            Some(large_one) => large
                .get(large_one as usize)
                .map_or(Ok(Vec::new()), |rows| of_part(laplacian, rows, spectrum, part, &mine, &mut tools, &mut poll)),
        };
        for (at, mut vector) in made.map_err(|missing| missing.error(laplacian.unit()))? {
            vector.index = wanted[at];
            turn(&mut vector.values);
            found[at] = Some(vector);
        }
    }
    found
        .into_iter()
        .collect::<Option<_>>()
        .ok_or_else(|| SpectrumError::Refused("the bands are not of these matrices".to_owned()))
}

/// Why a vector is missing.
enum Missing {
    Cancelled,
    Lost(f64),
}

impl From<Stopped> for Missing {
    fn from(_: Stopped) -> Self {
        Self::Cancelled
    }
}

impl Missing {
    fn error(&self, unit: f64) -> SpectrumError {
        match self {
            Self::Cancelled => SpectrumError::Cancelled { finished: Vec::new() },
            Self::Lost(at) => SpectrumError::Uncertified { at: at * unit, finished: Vec::new() },
        }
    }
}

/// Where an eigenvalue of the whole mesh is.
struct Place {
    value: f64,
    part: u32,
    /// Its index in the part.
    at: usize,
}

/// In the order of [`Spectrum::eigenvalues`].
fn places(spectrum: &Spectrum) -> Vec<Place> {
    let limit = spectrum.frontier();
    let place = |band: &Band| {
        let (part, below) = (band.part, band.below);
        let values = band.values.clone();
        values.into_iter().enumerate().map(move |(at, value)| Place { value, part, at: below + at })
    };
    let mut all: Vec<Place> = spectrum.bands.iter().flat_map(place).filter(|place| place.value <= limit).collect();
    all.sort_by(|a, b| a.value.total_cmp(&b.value));
    all
}

/// Makes the entry of largest magnitude positive.
fn turn(values: &mut [f64]) {
    let largest = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let first = values.iter().find(|value| value.abs() >= (1.0 - 1e-6) * largest);
    if first.is_some_and(|first| *first < 0.0) {
        for value in values {
            *value = -*value;
        }
    }
}

type Made = Result<Vec<(usize, Eigenvector)>, Missing>;

/// Puts a vector of a piece in its place among all rows, in the mesh's unit.
fn placed(laplacian: &Laplacian, rows: &[u32], (value, residual): (f64, f64), x: &[f64]) -> Eigenvector {
    let unit = laplacian.unit();
    let mut values = vec![0.0; laplacian.matrix.order()];
    for (&row, &x) in rows.iter().zip(x) {
        values[row as usize] = x * unit.sqrt();
    }
    Eigenvector { index: 0, value: value * unit, residual: residual * unit, values }
}

fn of_small_pieces(laplacian: &Laplacian, small: &[Vec<u32>], mine: &[(usize, usize)], pulse: &Pulse) -> Made {
    let mut all = Vec::new();
    for (piece, rows) in small.iter().enumerate() {
        let matrix = laplacian.matrix.select(rows, pulse)?;
        let values = super::dense::dense(&matrix).ok_or(Missing::Lost(0.0))?;
        all.extend(values.iter().enumerate().map(|(at, found)| (found.value, piece, at)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut made = Vec::new();
    for &(answer, index) in mine {
        let &(value, piece, at) = all.get(index).ok_or(Missing::Lost(0.0))?;
        let matrix = laplacian.matrix.select(&small[piece], pulse)?;
        let x = direct(&matrix, at).ok_or(Missing::Lost(value))?;
        let bound = residual(&matrix, value, &x);
        made.push((answer, placed(laplacian, &small[piece], (value, bound), &x)));
    }
    Ok(made)
}

fn of_part(
    laplacian: &Laplacian,
    rows: &[u32],
    spectrum: &Spectrum,
    part: u32,
    mine: &[(usize, usize)],
    tools: &mut Tools,
    poll: &mut Poll,
) -> Made {
    // The rows of the piece in the order of elimination.
    let pulse = &Pulse::new(poll.watch());
    let matrix = laplacian.matrix.select(rows, pulse)?;
    let order = super::factor::order(&matrix, pulse)?.ok_or(Missing::Lost(0.0))?;
    let rows: Vec<u32> = order.rows.iter().map(|&at| rows[at as usize]).collect();
    let pencil = Pencil::ordered(&matrix, &order, pulse)?;
    poll.charge(Cost::Ordering);
    let mut made = Vec::new();
    for band in spectrum.bands.iter().filter(|band| band.part == part) {
        let inside = |index: usize| (band.below..band.above).contains(&index);
        if !mine.iter().any(|&(_, index)| inside(index)) {
            continue;
        }
        let values: Vec<f64> = band.values.iter().map(|value| value / laplacian.unit()).collect();
        let spacing = (band.upper.min(2.0 * band.values.last().copied().unwrap_or(0.0)) - band.lower)
            / laplacian.unit()
            / values.len() as f64;
        for (first, end) in windows(&values, band.zeros, spacing) {
            let range = band.below + first..band.below + end;
            let mut here = mine.iter().filter(|(_, index)| range.contains(index)).peekable();
            if here.peek().is_none() {
                continue;
            }
            let pairs = if first < band.zeros {
                vec![(true, constant(&pencil.matrix, first))]
            } else {
                window(&pencil, &values, first..end, spacing, tools, poll)?
            };
            for &(answer, index) in here {
                let (zero, x) = &pairs[index - range.start];
                let value = if *zero { 0.0 } else { rayleigh(&pencil.matrix, x) };
                let bound = residual(&pencil.matrix, value, x);
                made.push((answer, placed(laplacian, &rows, (value, bound), x)));
            }
            poll.charge(Cost::Vectors);
        }
    }
    Ok(made)
}

/// Cuts the eigenvalues of a band into windows, between values that lie apart. Zeros have windows of their own.
fn windows(values: &[f64], zeros: usize, spacing: f64) -> Vec<(usize, usize)> {
    let mut cut: Vec<(usize, usize)> = (0..zeros).map(|at| (at, at + 1)).collect();
    let mut first = zeros;
    for end in zeros + 1..=values.len() {
        let gap = values.get(end).map_or(f64::INFINITY, |next| next - values[end - 1]);
        let size = end - first;
        if gap == f64::INFINITY || size >= FEWEST && gap > 0.5 * spacing || size >= MOST && gap > 1e-3 * spacing {
            cut.push((first, end));
            first = end;
        }
    }
    cut
}

/// A vector of the kernel of a connected piece: constant on each of its free parts up to the one with that number, with
/// xᵀBx = 1 and orthogonal to those of the parts before.
fn constant(matrix: &Symmetric, number: usize) -> Vec<f64> {
    let FreeParts { of, count } = free_parts(matrix);
    if count <= 1 {
        return vec![1.0 / matrix.total_mass().sqrt(); matrix.order()];
    }
    // B between the constants of the parts, and Cholesky's decomposition of it by the Gram–Schmidt process.
    let place = |row: usize| (of[row] != FreeParts::HELD).then_some(of[row] as usize);
    let mut gram = vec![0.0; count * count];
    for (row, column, _, mass) in matrix.entries() {
        if let (Some(a), Some(b)) = (place(row), place(column)) {
            gram[a * count + b] += mass;
            gram[b * count + a] += if row == column { 0.0 } else { mass };
        }
    }
    let inner = |x: &[f64], y: &[f64]| -> f64 {
        (0..count).flat_map(|a| (0..count).map(move |b| (a, b))).map(|(a, b)| x[a] * gram[a * count + b] * y[b]).sum()
    };
    let mut all: Vec<Vec<f64>> = Vec::new();
    for at in 0..=number.min(count - 1) {
        let mut x: Vec<f64> = (0..count).map(|part| f64::from(u8::from(part == at))).collect();
        for other in &all {
            let along = inner(&x, other);
            x.iter_mut().zip(other).for_each(|(x, other)| *x -= along * other);
        }
        let norm = inner(&x, &x).sqrt();
        for x in &mut x {
            *x /= norm;
        }
        all.push(x);
    }
    let last = all.pop().unwrap_or_default();
    (0..of.len()).map(|row| place(row).map_or(0.0, |part| last[part])).collect()
}

/// Poles for a window, best first: in the middle of wide gaps near its centre.
fn poles(values: &[f64], window: &std::ops::Range<usize>, spacing: f64) -> Vec<f64> {
    let before = window.start.checked_sub(1).map_or(values[window.start] - spacing, |at| values[at]);
    let after = values.get(window.end).copied().unwrap_or(values[window.end - 1] + spacing);
    let ends: Vec<f64> = std::iter::once(before).chain(values[window.clone()].iter().copied()).chain([after]).collect();
    let centre = f64::midpoint(values[window.start], values[window.end - 1]);
    let mut scored: Vec<(f64, f64)> = ends
        .windows(2)
        .map(|pair| (f64::midpoint(pair[0], pair[1]), (pair[1] - pair[0]).min(spacing)))
        .map(|(pole, width)| (width / (spacing + (pole - centre).abs()), pole))
        .collect();
    scored.sort_by(|a, b| b.0.total_cmp(&a.0));
    scored.into_iter().map(|(_, pole)| pole).collect()
}

/// The eigenvectors of one window by ascending eigenvalues, and that they are not of the kernel.
fn window(
    pencil: &Pencil,
    values: &[f64],
    window: std::ops::Range<usize>,
    spacing: f64,
    tools: &mut Tools,
    poll: &mut Poll,
) -> Result<Vec<(bool, Vec<f64>)>, Missing> {
    let stopped = |stop| match stop {
        Stop::Cancelled => Missing::Cancelled,
        Stop::Pivot => Missing::Lost(values[window.start]),
    };
    let (low, high) = (values[window.start], values[window.end - 1]);
    let lost = || Missing::Lost(low);
    let poles = poles(values, &window, spacing);
    let mut pole = None;
    for &sigma in poles.iter().take(4) {
        match tools.factor.compute(&pencil.symbolic, &pencil.matrix, sigma, poll) {
            Ok(_) if tools.factor.is_sound() => {
                pole = Some(sigma);
                break;
            }
            Ok(_) | Err(Stop::Pivot) => {}
            Err(stop) => return Err(stopped(stop)),
        }
    }
    let sigma = pole.ok_or_else(lost)?;
    let margin = 1e-4 * spacing;
    let seed = sigma.to_bits().rotate_left(29);
    let Tools { factor, scratch, .. } = tools;
    let mut krylov = Krylov::start(pencil, factor, sigma, seed, Basis::Double(&[]), scratch, poll).map_err(stopped)?;
    let room = (pencil.order() - 1) / WIDTH;
    let mut chosen: Vec<Ritz> = Vec::new();
    for step in 1..=STEPS.min(room) {
        krylov.step(poll).map_err(stopped)?;
        if step < 3 && step < room {
            continue;
        }
        let ritz = krylov.ritz(poll).ok_or_else(lost)?;
        let inside = |ritz: &Ritz| ritz.value > low - margin && ritz.value < high + margin;
        chosen = ritz.into_iter().filter(inside).collect();
        if chosen.len() == window.len() && chosen.iter().all(|ritz| ritz.residual < 1e-11 * ritz.theta.abs()) {
            break;
        }
    }
    if chosen.len() != window.len() {
        return Err(lost());
    }
    let mut x = columns(&krylov.vectors(&chosen).ok_or_else(lost)?, chosen.len());
    poll.charge(Cost::Vectors);
    for _ in 0..2 {
        let y = inverse_step(pencil, factor, &x, poll).map_err(stopped)?;
        x = project(&pencil.matrix, &x, &y).ok_or_else(lost)?;
        poll.charge(Cost::Vectors);
    }
    Ok(x.into_iter().map(|x| (false, x)).collect())
}

/// The first so many vectors of some blocks.
fn columns(blocks: &[Buffer], count: usize) -> Vec<Vec<f64>> {
    (0..count).map(|at| blocks[at / WIDTH].rows().iter().map(|row| row[at % WIDTH]).collect()).collect()
}

/// (L − σB)⁻¹ B x for every vector.
fn inverse_step(
    pencil: &Pencil,
    factor: &super::factor::Factor,
    x: &[Vec<f64>],
    poll: &mut Poll,
) -> Result<Vec<Vec<f64>>, Stop> {
    let mut blocks = Vec::new();
    for group in x.chunks(WIDTH) {
        let mut block = Buffer::default();
        block.reserve(pencil.order() * WIDTH);
        block.flat().fill(0.0);
        for (at, x) in group.iter().enumerate() {
            for (row, value) in block.rows_mut().iter_mut().zip(mass_product(&pencil.matrix, x)) {
                row[at] = value;
            }
        }
        poll.charge(Cost::Vectors);
        factor.solve(&pencil.symbolic, block.rows_mut(), poll)?;
        blocks.push(block);
    }
    Ok(columns(&blocks, x.len()))
}

/// Rayleigh–Ritz with y = (L − σB)⁻¹Bx, for which yᵀ(L − σB)y = yᵀBx: B-orthonormal vectors by ascending
/// eigenvalues.
fn project(matrix: &Symmetric, x: &[Vec<f64>], y: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let k = x.len();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).fold(0.0, |sum, (a, b)| sum + a * b);
    // With columns of one norm the Gram matrix is well scaled.
    let mass: Vec<Vec<f64>> = y.iter().map(|y| mass_product(matrix, y)).collect();
    let scale: Vec<f64> = y.iter().zip(&mass).map(|(y, by)| 1.0 / dot(y, by).sqrt()).collect();
    let (mut gram, mut form) = (vec![0.0; k * k], vec![0.0; k * k]);
    for i in 0..k {
        for j in 0..k {
            gram[i * k + j] = dot(&y[i], &mass[j]) * scale[i] * scale[j];
            form[i * k + j] = dot(&mass[i], &x[j]) * scale[i] * scale[j];
        }
    }
    for i in 0..k {
        for j in 0..i {
            let mean = f64::midpoint(form[i * k + j], form[j * k + i]);
            form[i * k + j] = mean;
            form[j * k + i] = mean;
        }
    }
    let pairs = super::dense::pairs(&form, &gram, k)?;
    let vectors = pairs.iter().map(|(_, factors)| {
        let mut sum = vec![0.0; matrix.order()];
        for ((y, factor), scale) in y.iter().zip(factors).zip(&scale) {
            for (sum, y) in sum.iter_mut().zip(y) {
                *sum += factor * scale * y;
            }
        }
        sum
    });
    Some(vectors.collect())
}

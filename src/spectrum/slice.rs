//! What one Lanczos process at a shift says about the eigenvalues on its two sides.

use super::krylov::Ritz;

/// The relative error that an eigenvalue may have.
const TOLERANCE: f64 = 2e-11;

/// An eigenvalue with a bound on its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// λ.
    pub value: f64,
    /// Bound on the distance of an eigenvalue from `value`, of first order in the residual.
    pub near: f64,
    /// Bound on the error, of second order where the distance to the other eigenvalues allows.
    pub error: f64,
}

/// The converged eigenvalues on one side of a shift, nearest first, without a gap.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Side {
    pub found: Vec<Found>,
    /// How far from the shift nothing is missing, as far as the process can see.
    pub reach: f64,
}

/// Both sides at one moment of a process.
#[derive(Debug, Clone, Default)]
pub(super) struct Sides {
    pub left: Side,
    pub right: Side,
    /// Distance of the nearest eigenvalue.
    pub nearest: f64,
}

impl Sides {
    /// Sorts Ritz values (by distance) into converged ones left and right of the shift. `spacing` is about the mean
    /// distance of neighbouring eigenvalues, `scale` a λ below which relative accuracy is not asked for.
    pub(super) fn new(ritz: &[Ritz], sigma: f64, spacing: f64, scale: f64) -> Self {
        let Some(first) = ritz.first() else { return Self::default() };
        let floor = 8.0 * f64::EPSILON * first.theta.abs();
        let side = |right: bool| {
            let list: Vec<Ritz> = ritz.iter().copied().filter(|ritz| (ritz.theta > 0.0) == right).collect();
            converged(&list, sigma, spacing, scale, floor)
        };
        Self { left: side(false), right: side(true), nearest: 1.0 / first.theta.abs() }
    }
}

/// The leading Ritz values whose errors are small enough. `list` is one side's, by distance.
fn converged(list: &[Ritz], sigma: f64, spacing: f64, scale: f64, floor: f64) -> Side {
    let mut side = Side::default();
    let mut at = 0;
    while at < list.len() {
        // Eigenvalues that nearly coincide are judged together, by their distance to the others.
        let mut end = at + 1;
        while end < list.len() && (list[end].value - list[end - 1].value).abs() < 0.02 * spacing {
            end += 1;
        }
        let square: f64 = list[at..end].iter().map(|ritz| ritz.residual * ritz.residual).sum();
        let before = if at == 0 { f64::INFINITY } else { list[at - 1].theta.abs() - list[at].theta.abs() };
        let after = list[end - 1].theta.abs() - list.get(end).map_or(0.0, |next| next.theta.abs());
        let gap = before.min(after);
        let group = list[at..end].iter().map(|ritz| {
            let per = 1.0 / (ritz.theta * ritz.theta);
            let near = (ritz.residual + floor) * per;
            Found { value: ritz.value, near, error: near.min((square / gap + floor) * per) }
        });
        let good = list[at..end].iter().zip(group.clone()).all(|(ritz, found)| {
            let rounding = floor / (ritz.theta * ritz.theta);
            ritz.residual < 1e-3 * ritz.theta.abs()
                && found.error <= TOLERANCE * found.value.abs().max(scale) + 2.0 * rounding
        });
        if !good {
            break;
        }
        side.found.extend(group);
        side.reach = (list[end - 1].value - sigma).abs();
        at = end;
    }
    side
}

/// Takes the eigenvalues between two shifts from the right side of the lower and the left side of the upper one, if
/// together they are `total` and leave a clear gap in between: then neither list can have missed one or share one with
/// the other.
pub(super) fn join(right: &[Found], left: &[Found], total: usize) -> Option<Vec<Found>> {
    let mut from_right = right.len().min(total);
    loop {
        let from_left = total - from_right;
        if from_left > left.len() {
            return None;
        }
        let apart = match (from_right.checked_sub(1).map(|at| right[at]), from_left.checked_sub(1).map(|at| left[at])) {
            (Some(below), Some(above)) => below.value + below.near < above.value - above.near,
            _ => true,
        };
        if apart {
            let above = left[..from_left].iter().rev();
            return Some(right[..from_right].iter().chain(above).copied().collect());
        }
        from_right = from_right.checked_sub(1)?;
    }
}

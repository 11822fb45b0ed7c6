//! What Lanczos processes say about the eigenvalues of a slice, and how far that can be wrong.
//!
//! # What the bounds rest on
//!
//! A process at a shift σ ends with B-orthonormal vectors X, numbers Θ and residuals `R = S X − X Θ`, where
//! S = (L − σB)⁻¹B has the eigenvalues θ = 1/(λ − σ).
//!
//! 1. **First order.** To the columns of X belong as many eigenvalues of S, each within ‖R‖ of its θ (Kahan 1967; in
//!    Parlett, *The Symmetric Eigenvalue Problem*, theorem 11.5.1). ‖R‖ is taken as the Frobenius norm over all of
//!    one side of the process. This is [`Found::near`].
//! 2. **Completeness.** Where such intervals of two processes do not meet, their eigenvalues are different ones. The
//!    difference of the inertia counts at both ends of the slice says how many there are. When as many are found as
//!    are counted, every eigenvalue of the slice is in one of the intervals ([`join()`]), and all others are beyond
//!    the ends.
//! 3. **Second order.** So for values that hang together it is known how near any other eigenvalue of S can be: at a
//!    distance η of θ at least. Then each of them is within ‖R‖²/(η − 2‖R‖) of its eigenvalue, with R their own
//!    residuals (Mathias 1998, *Quadratic residual bounds for the Hermitian eigenvalue problem*, theorem 1, whose gap
//!    is to the rest of the projected operator, so that 1 is applied to it first). This is [`Found::error`].
//!
//! Rounding is added to both:
//!
//! - that of the dense eigenproblem, 16 ε times the largest θ;
//! - that of λ = σ + 1/θ and of the entries of L − σB, [32 ε](ROUNDING) times λ or σ;
//! - that of the factorisation and the solves. These solve a neighbouring problem, (L − σB + E) x = Bx. E shifts an
//!   eigenvalue by xᵀEx, which is [measured](super::krylov::Krylov::accuracy) on the vectors of the first block and
//!   taken [sixteenfold](SAFETY);
//! - where the basis is in single precision and not quite orthogonal, what this
//!   [leaves out](super::krylov::Krylov::leak), taken as it is.
//!
//! The last two are the parts of the bound that are estimates.

use super::krylov::Ritz;

/// The relative error that truncation may leave in an eigenvalue.
const TOLERANCE: f64 = 2e-11;

/// What the measured error of the solves is multiplied with: it is seen on 64 products of vectors, and the largest of
/// some hundred eigenvalues is asked for. With half of it, spectra of one mesh from other shifts have been seen to
/// differ by 1.1 times the sum of their bounds, in the last two digits.
const SAFETY: f64 = 16.0;

/// What is lost where λ = σ + 1/θ and the entries of L − σB are rounded, relative to them.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// An eigenvalue with bounds on its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Found {
    /// λ.
    pub value: f64,
    /// Bound on the distance of its own eigenvalue from `value`, of first order in the residuals.
    pub near: f64,
    /// Bound on the error, of second order where the distance to the other eigenvalues allows.
    pub error: f64,
    /// Where it comes from.
    origin: Origin,
}

/// What is needed to sharpen the bound of an eigenvalue once all others are known.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
struct Origin {
    /// The shift of the process.
    sigma: f64,
    /// Square of the norm of the residuals of the values that this one hangs together with.
    square: f64,
    /// Which values hang together: the first one's distance from the shift.
    group: f64,
    /// What rounding adds.
    rounding: f64,
}

impl Found {
    /// A value that needs no further bounds.
    pub(super) fn exactly(value: f64, error: f64) -> Self {
        Self { value, near: error, error, origin: Origin::default() }
    }

    /// Whether they were found together.
    fn hangs_with(&self, other: &Self) -> bool {
        let (one, two) = (&self.origin, &other.origin);
        (one.sigma, one.group, one.square) == (two.sigma, two.group, two.square)
    }
}

/// The converged eigenvalues on one side of a shift, nearest first, without a gap.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Side {
    pub found: Vec<Found>,
    /// How far from the shift nothing is missing, as far as the process can see.
    pub reach: f64,
}

/// How accurate a process is, and what is asked of it.
#[derive(Debug, Clone, Copy)]
pub(super) struct Scales {
    pub sigma: f64,
    /// About the mean distance of neighbouring eigenvalues.
    pub spacing: f64,
    /// A λ below which relative accuracy is not asked for.
    pub least: f64,
    /// By how much the solves shift eigenvalues.
    pub accuracy: f64,
    /// By how much the projected operator is off.
    pub leak: f64,
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
    /// Sorts Ritz values (by distance) into converged ones left and right of the shift.
    pub(super) fn new(ritz: &[Ritz], scales: Scales) -> Self {
        let Some(first) = ritz.first() else { return Self::default() };
        let side = |right: bool| {
            let list: Vec<Ritz> = ritz.iter().copied().filter(|ritz| (ritz.theta > 0.0) == right).collect();
            converged(&list, scales, 16.0 * f64::EPSILON * first.theta.abs())
        };
        Self { left: side(false), right: side(true), nearest: 1.0 / first.theta.abs() }
    }
}

/// The leading Ritz values whose errors are small enough. `list` is one side's, by distance.
fn converged(list: &[Ritz], scales: Scales, floor: f64) -> Side {
    let mut side = Side::default();
    let mut at = 0;
    let mut squares = 0.0;
    while at < list.len() {
        // Eigenvalues that nearly coincide are judged together, by their distance to the others.
        let mut end = at + 1;
        while end < list.len() && (list[end].value - list[end - 1].value).abs() < 0.02 * scales.spacing {
            end += 1;
        }
        let square: f64 = list[at..end].iter().map(|ritz| ritz.residual * ritz.residual).sum();
        let before = if at == 0 { f64::INFINITY } else { list[at - 1].theta.abs() - list[at].theta.abs() };
        let after = list[end - 1].theta.abs() - list.get(end).map_or(0.0, |next| next.theta.abs());
        let gap = before.min(after);
        let good = list[at..end].iter().all(|ritz| {
            let per = 1.0 / (ritz.theta * ritz.theta);
            let (first, second) = (square.sqrt() * per, square / gap * per);
            let rounding = floor * per + SAFETY * scales.accuracy;
            ritz.residual < 1e-3 * ritz.theta.abs()
                && first.min(second) <= TOLERANCE * ritz.value.abs().max(scales.least) + rounding
        });
        if !good {
            break;
        }
        squares += square;
        side.found.extend(list[at..end].iter().map(|ritz| {
            let rounding = (floor + scales.leak) / (ritz.theta * ritz.theta)
                + SAFETY * scales.accuracy
                + ROUNDING * ritz.value.abs().max(scales.sigma);
            let origin = Origin { sigma: scales.sigma, square, group: 1.0 / list[at].theta.abs(), rounding };
            Found { value: ritz.value, near: 0.0, error: 0.0, origin }
        }));
        side.reach = (list[end - 1].value - scales.sigma).abs();
        at = end;
    }
    for found in &mut side.found {
        let distance = (found.value - scales.sigma).abs();
        found.near = in_lambda(squares.sqrt(), distance) + found.origin.rounding;
        found.error = found.near;
    }
    side
}

/// An error of θ at a distance from the shift, as one of λ = σ + 1/θ; infinite where θ may as well be zero.
pub(super) fn in_lambda(error: f64, distance: f64) -> f64 {
    // 1/(θ − e) − 1/θ = e/(θ (θ − e))
    let shrunk = 1.0 / distance - error;
    if shrunk > 0.0 { error * distance / shrunk } else { f64::INFINITY }
}

/// Takes the eigenvalues between two shifts from the right side of the lower and the left side of the upper one, if
/// together they are `total` and leave a clear gap in between: then neither list can have missed one or share one with
/// the other. What a list has beyond the gap, the other one must have too.
pub(super) fn join(right: &[Found], left: &[Found], total: usize) -> Option<Vec<Found>> {
    let apart = |below: &Found, above: &Found| below.value + below.near < above.value - above.near;
    for from_right in (0..=right.len().min(total)).rev() {
        let from_left = total - from_right;
        if from_left > left.len() {
            return None;
        }
        let (below, above) = (&right[..from_right], &left[..from_left]);
        let gap = below.last().zip(above.last()).is_none_or(|(below, above)| apart(below, above));
        if gap {
            let same = |(one, other): (&Found, &Found)| !apart(one, other) && !apart(other, one);
            let agree = right[from_right..].iter().zip(above.iter().rev()).all(same)
                && left[from_left..].iter().zip(below.iter().rev()).all(same);
            let all: Vec<Found> = below.iter().chain(above.iter().rev()).copied().collect();
            let ascending = all.is_sorted_by(|one, next| !apart(next, one));
            return (agree && ascending).then_some(all);
        }
    }
    None
}

/// Gives the eigenvalues of a slice, all of them and ascending, bounds of second order: nothing else is between `lower`
/// and `upper`. Below the lowest slice there is nothing at all, so that `lower` is −∞ there.
pub(super) fn sharpen(found: &mut [Found], lower: f64, upper: f64) {
    let mut at = 0;
    while at < found.len() {
        let mut end = at + 1;
        while end < found.len() && found[end].hangs_with(&found[at]) {
            end += 1;
        }
        let below = at.checked_sub(1).map_or(lower, |before| found[before].value + found[before].near);
        let above = found.get(end).map_or(upper, |after| after.value - after.near);
        let Origin { sigma, square, .. } = found[at].origin;
        let (first, last) = (found[at].value, found[end - 1].value);
        // Distances from the shift: of these values, and of what is next to them towards the shift and away from it.
        let right = first > sigma;
        let (nearest, farthest) = if right { (first - sigma, last - sigma) } else { (sigma - last, sigma - first) };
        let (towards, away) = if right { (below - sigma, above - sigma) } else { (sigma - above, sigma - below) };
        let before = if towards > 0.0 { 1.0 / towards - 1.0 / nearest } else { f64::INFINITY };
        let after = 1.0 / farthest - 1.0 / away;
        let gap = before.min(after) - 2.0 * square.sqrt();
        for found in &mut found[at..end] {
            if gap > 0.0 {
                let sharp = in_lambda(square / gap, (found.value - sigma).abs()) + found.origin.rounding;
                found.error = found.near.min(sharp);
            }
        }
        at = end;
    }
}

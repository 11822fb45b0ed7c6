//! The implicit QL iteration for symmetric tridiagonal matrices, several shifts at a time.
//!
//! A sweep with a shift chases one rotation after the other through the matrix, and each has to wait for the square
//! root and the division of the one before it. So [`SWEEPS`] sweeps follow one another at a distance of two rows, like
//! the bulges of a multishift iteration (Braman, Byers and Mathias 2002), and the processor works on them at once.
//! Their shifts are the eigenvalues of the block at the end that they run to. There are a third more sweeps than with
//! a shift of its own for each, and they take half the time.

#![expect(clippy::inline_always, reason = "a kernel is compiled for an instruction set only where it is inlined")]

use super::lanes::{Kernel, Lanes, Row};

/// Sweeps at a time.
const SWEEPS: usize = 4;
/// A matrix of no more rows is left to single sweeps.
const SINGLE: usize = 4;
/// Rounds without an eigenvalue after which single sweeps with Wilkinson's shift go on, which always converge.
const PATIENCE: usize = 12;
const ROUNDS: usize = 80;

/// How accurate shifts are, in proportion to the entries they come from.
const ROUGHLY: f64 = 1e-6;

/// A number that is nothing to a sine, and keeps the product of many small ones away from denormal numbers.
const SMALLEST: f64 = 1e-200;

/// A square that is nothing in a matrix whose largest entry is 1, and far from denormal numbers.
pub(super) const NOTHING: f64 = 1e-280;

/// The eigenvalues of a symmetric tridiagonal matrix, in the place of its diagonal. True when the iteration converged,
/// as it does for finite numbers.
///
/// An entry beside the diagonal is taken for zero when it is a rounding of its neighbours on the diagonal.
pub(super) struct ImplicitQl<'a> {
    /// For each row of the matrix `per` rows of eight values: a matrix Z by columns, which is multiplied by the
    /// eigenvectors.
    pub vectors: &'a mut [Row],
    pub per: usize,
    pub diagonal: &'a mut [f64],
    /// Subdiagonal in 0..n−1, and a number of no meaning.
    pub beside: &'a mut [f64],
}

impl Kernel for ImplicitQl<'_> {
    type Output = bool;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> bool {
        let Self { vectors, per, diagonal: d, beside: e } = self;
        let n = d.len();
        e[n - 1] = 0.0;
        let Some(scale) = unit_scale(d.iter().chain(e.iter())) else { return false };
        for x in d.iter_mut().chain(e.iter_mut()) {
            *x *= scale;
        }
        let (mut low, mut rounds) = (0, 0);
        while low < n {
            let mut high = low;
            while high + 1 < n && !is_nothing(e[high], d[high], d[high + 1]) {
                high += 1;
            }
            if high == low {
                low += 1;
                rounds = 0;
                continue;
            }
            rounds += 1;
            if rounds > ROUNDS {
                return false;
            }
            let mut matrix = Matrix { d: &mut *d, e: &mut *e, vectors: &mut *vectors, per };
            if high - low < SINGLE || rounds > PATIENCE {
                let shift = wilkinson(&matrix.d[low..], matrix.e[low]);
                matrix.sweep(lanes, low, high, [shift]);
            } else {
                let shifts = leading(&matrix.d[low..], &matrix.e[low..]);
                matrix.sweep(lanes, low, high, shifts);
            }
        }
        for x in d.iter_mut() {
            *x /= scale;
        }
        d.iter().all(|x| x.is_finite())
    }
}

/// Whether an entry beside the diagonal is rounding of its neighbours on the diagonal, or nothing at all.
#[inline(always)]
fn is_nothing(e: f64, above: f64, below: f64) -> bool {
    e.abs() <= f64::EPSILON * (above.abs() + below.abs()).max(1e-40)
}

/// The power of two that brings the largest of these numbers to between 1 and 2, if they are finite.
pub(super) fn unit_scale<'a>(mut numbers: impl Iterator<Item = &'a f64>) -> Option<f64> {
    let largest = numbers.try_fold(0.0_f64, |most, x| x.is_finite().then(|| most.max(x.abs())))?;
    let exponent = (largest.to_bits() >> 52).clamp(1, 2045);
    Some(f64::from_bits((2046 - exponent) << 52))
}

/// The eigenvalue of the leading block of two rows that is nearer to its first entry.
#[inline(always)]
fn wilkinson(d: &[f64], e: f64) -> f64 {
    let half = 0.5 * (d[1] - d[0]);
    d[0] - e * (e / (half + e.hypot(half).copysign(half)))
}

/// The eigenvalues of the leading block of [`SWEEPS`] rows, roughly.
#[inline(always)]
fn leading(d: &[f64], e: &[f64]) -> [f64; SWEEPS] {
    let mut d: [f64; SWEEPS] = std::array::from_fn(|at| d[at]);
    let mut e: [f64; SWEEPS] = std::array::from_fn(|at| e[at]);
    let (mut low, mut rounds) = (0, 0);
    while low < SWEEPS && rounds < 4 * SWEEPS {
        let nothing = |at: usize| e[at].abs() <= ROUGHLY * (d[at].abs() + d[at + 1].abs());
        let high = (low..SWEEPS - 1).find(|&at| nothing(at)).unwrap_or(SWEEPS - 1);
        if high == low {
            low += 1;
            continue;
        }
        rounds += 1;
        let mut sweep = Sweep::start(d[high], wilkinson(&d[low..], e[low]));
        for at in (low..high).rev() {
            sweep.turn(&mut d[at..at + 2], &mut e[at..at + 2]);
        }
        sweep.finish(&mut d[low], &mut e[low]);
    }
    d
}

/// A sweep on its way through the matrix.
#[derive(Clone, Copy)]
struct Sweep {
    sine: f64,
    cosine: f64,
    /// The entry that the next rotation is chosen by, with the one below it.
    g: f64,
    /// What the newest rotation has taken from the diagonal.
    p: f64,
}

impl Sweep {
    #[inline(always)]
    fn start(last: f64, shift: f64) -> Self {
        Self { sine: 1.0, cosine: 1.0, g: last - shift, p: 0.0 }
    }

    /// The rotation of two rows and columns, given the diagonal and subdiagonal entries in both.
    #[inline(always)]
    fn turn(&mut self, d: &mut [f64], e: &mut [f64]) {
        let f = self.sine * e[0];
        let b = self.cosine * e[0];
        let square = f.mul_add(f, self.g * self.g);
        let root = square.sqrt();
        e[1] = root;
        if square > NOTHING {
            // The root's reciprocal, without waiting for the root.
            let inverse = root * (1.0 / square);
            self.sine = f.mul_add(inverse, SMALLEST);
            self.cosine = self.g * inverse;
        } else {
            // The sweep before has found an eigenvalue exactly.
            (self.sine, self.cosine) = (0.0, 1.0);
        }
        let g = d[1] - self.p;
        let r = (d[0] - g).mul_add(self.sine, self.cosine * (b + b));
        self.p = self.sine * r;
        d[1] = g + self.p;
        self.g = self.cosine.mul_add(r, -b);
    }

    #[inline(always)]
    fn finish(self, d: &mut f64, e: &mut f64) {
        *d -= self.p;
        *e = self.g;
    }
}

struct Matrix<'a> {
    d: &'a mut [f64],
    e: &'a mut [f64],
    vectors: &'a mut [Row],
    per: usize,
}

impl Matrix<'_> {
    /// One sweep for each shift through the rows from `low` to `high`.
    #[inline(always)]
    fn sweep<L: Lanes, const M: usize>(&mut self, lanes: L, low: usize, high: usize, shifts: [f64; M]) {
        let Self { d, e, vectors, per } = self;
        let per = *per;
        let steps = high - low;
        let mut sweeps = [Sweep::start(0.0, 0.0); M];
        for step in 0..steps + 2 * (M - 1) {
            if step > 2 * (M - 1) && step + 1 < steps {
                let (first, end) = (high - 1 - step, high - 1 - step + 2 * M);
                let (d, e, z) = (&mut d[first..end], &mut e[first..end], &mut vectors[first * per..end * per]);
                for (k, sweep) in sweeps.iter_mut().enumerate() {
                    sweep.turn(&mut d[2 * k..2 * k + 2], &mut e[2 * k..2 * k + 2]);
                }
                for (k, sweep) in sweeps.iter().enumerate() {
                    rotate(lanes, *sweep, &mut z[2 * k * per..(2 * k + 2) * per]);
                }
                continue;
            }
            for (k, sweep) in sweeps.iter_mut().enumerate() {
                let own = step.wrapping_sub(2 * k);
                if own >= steps {
                    continue;
                }
                if own == 0 {
                    *sweep = Sweep::start(d[high], shifts[k]);
                }
                let at = high - 1 - own;
                sweep.turn(&mut d[at..at + 2], &mut e[at..at + 2]);
                rotate(lanes, *sweep, &mut vectors[at * per..(at + 2) * per]);
                if at == low {
                    sweep.finish(&mut d[low], &mut e[low]);
                }
            }
        }
        e[high] = 0.0;
    }
}

#[inline(always)]
fn rotate<L: Lanes>(lanes: L, sweep: Sweep, vectors: &mut [Row]) {
    let (sine, cosine) = (lanes.splat(sweep.sine), lanes.splat(sweep.cosine));
    let (left, right) = vectors.split_at_mut(vectors.len() / 2);
    for (left, right) in left.iter_mut().zip(right) {
        let (x, y) = (lanes.load(left), lanes.load(right));
        *right = lanes.row(lanes.add_mul(lanes.mul(cosine, y), sine, x));
        *left = lanes.row(lanes.sub_mul(lanes.mul(cosine, x), sine, y));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::lanes::dispatch;

    fn values(diagonal: &[f64], beside: &[f64]) -> Option<Vec<f64>> {
        let mut d = diagonal.to_vec();
        let mut e: Vec<f64> = beside.iter().copied().chain([0.0]).collect();
        dispatch(ImplicitQl { vectors: &mut [], per: 0, diagonal: &mut d, beside: &mut e }).then(|| {
            d.sort_by(f64::total_cmp);
            d
        })
    }

    #[test]
    fn shifts_may_be_exact() {
        // With zeros on the diagonal and ones beside it sweeps come upon exact eigenvalues.
        for n in [1, 2, 3, 4, 5, 6, 7, 8, 9, 31, 64] {
            let found = values(&vec![0.0; n], &vec![1.0; n - 1]).unwrap();
            for (at, value) in found.iter().rev().enumerate() {
                let expected = 2.0 * (std::f64::consts::PI * (at + 1) as f64 / (n + 1) as f64).cos();
                assert!((value - expected).abs() < 2e-14, "{n}: {value} {expected}");
            }
            let steps: Vec<f64> = (0..n).map(|at| (at / 2) as f64).collect();
            assert_eq!(values(&steps, &vec![0.0; n - 1]).unwrap(), steps);
            assert_eq!(values(&vec![0.0; n], &vec![0.0; n - 1]).unwrap(), vec![0.0; n]);
        }
    }

    #[test]
    fn a_sweep_goes_on_where_both_entries_are_zero() {
        let mut sweep = Sweep::start(1.0, 1.0);
        let (mut d, mut e) = ([2.0, 1.0], [0.0, 0.0]);
        sweep.turn(&mut d, &mut e);
        assert_eq!((sweep.sine, sweep.cosine, d, e), (0.0, 1.0, [2.0, 1.0], [0.0, 0.0]));
    }
}

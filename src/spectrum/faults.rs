//! Faults put into the solver on purpose, to see whether it notices.

use std::ops::Range;

use super::{krylov::Random, lanes::Row, slice::Sides, solve, tests::potato, *};
use crate::{laplacian::assemble, watch::Unwatched};

/// What goes wrong.
#[derive(Debug, Clone, Default)]
pub(super) enum Fault {
    #[default]
    None,
    /// One converged eigenvalue is overlooked, in these looks at the Ritz values of a run.
    Drop { looks: Range<usize>, right: bool, index: usize },
    /// An eigenvalue is never seen by any process.
    Hide(Range<f64>),
    /// One converged eigenvalue is seen twice.
    Repeat { looks: Range<usize>, right: bool, index: usize },
    /// One converged eigenvalue is off by about three others.
    Move { looks: Range<usize>, right: bool, index: usize },
    /// One factorisation miscounts.
    Miscount { factorisation: usize, by: isize },
    /// One entry of one solve is wrong by so much of itself.
    Spoil { solve: usize, entry: usize, by: f64 },
}

/// A fault, and how far the run has come.
#[derive(Debug, Default)]
pub(super) struct Tamper {
    pub fault: Fault,
    looks: usize,
    factorisations: usize,
    solves: usize,
    /// How often the fault has happened.
    pub happened: usize,
}

impl Tamper {
    pub(super) fn sides(&mut self, sides: &mut Sides) {
        let look = self.looks;
        self.looks += 1;
        let mut change = |looks: &Range<usize>, right: bool, index: usize, what: &dyn Fn(&mut Vec<slice::Found>)| {
            let side = if right { &mut sides.right } else { &mut sides.left };
            if looks.contains(&look) && index < side.found.len() {
                what(&mut side.found);
                self.happened += 1;
            }
        };
        match self.fault.clone() {
            Fault::Drop { looks, right, index } => change(&looks, right, index, &|found| {
                found.remove(index);
            }),
            Fault::Repeat { looks, right, index } => {
                change(&looks, right, index, &|found| found.insert(index, found[index]));
            }
            Fault::Move { looks, right, index } => change(&looks, right, index, &|found| {
                if let Some(other) = found.get(index + 3).map(|other| other.value) {
                    found[index].value = other + 1e-3 * (other - found[index].value);
                }
            }),
            Fault::Hide(range) => {
                for side in [&mut sides.left, &mut sides.right] {
                    let before = side.found.len();
                    side.found.retain(|found| !range.contains(&found.value));
                    self.happened += before - side.found.len();
                }
            }
            _ => {}
        }
    }

    pub(super) fn count(&mut self, count: usize) -> usize {
        self.factorisations += 1;
        match self.fault {
            Fault::Miscount { factorisation, by } if factorisation + 1 == self.factorisations => {
                self.happened += 1;
                count.saturating_add_signed(by)
            }
            _ => count,
        }
    }

    pub(super) fn solution(&mut self, x: &mut [Row]) {
        self.solves += 1;
        if let Fault::Spoil { solve, entry, by } = self.fault
            && solve + 1 == self.solves
        {
            let rows = x.len();
            x[(entry / 8) % rows][entry % 8] *= 1.0 + by;
            self.happened += 1;
        }
    }
}

/// Runs with one fault: whether it happened, and whether the eigenvalues are certified all the same. Panics when they
/// are, or were until the solver stopped, and are wrong.
fn run(laplacian: &Laplacian, expected: &Spectrum, fault: Fault) -> (bool, bool) {
    let (values, errors) = (expected.eigenvalues(), expected.residuals());
    let mut tools = part::Tools::default();
    tools.scratch.tamper.fault = fault;
    let result = solve::solve(laplacian, &Request::new(100), &Unwatched, &mut tools);
    let tamper = &tools.scratch.tamper;
    let check = |at: usize, value: f64, error: f64| {
        let off = (value - values[at]).abs();
        assert!(
            off <= error + errors[at],
            "{at}: {value} is off by {off:e}, not {error:e} or {:e}, {tamper:?}",
            errors[at]
        );
    };
    match result {
        Ok(spectrum) => {
            for (at, (value, error)) in spectrum.eigenvalues().into_iter().zip(spectrum.residuals()).enumerate() {
                check(at, value, error);
            }
            (tamper.happened > 0, true)
        }
        Err(SpectrumError::Uncertified { finished, .. }) => {
            for band in &finished {
                for (at, (&value, &error)) in band.values.iter().zip(&band.errors).enumerate() {
                    check(band.below + at, value, error);
                }
            }
            (tamper.happened > 0, false)
        }
        Err(other) => panic!("{other}"),
    }
}

fn try_faults(cases: usize) {
    let mesh = potato(3);
    let laplacian = assemble(&mesh, Choice::default()).unwrap();
    let expected = solve(&mesh, Choice::default(), 300, &[], &Unwatched).unwrap();
    let values = expected.eigenvalues();
    let mut random = Random(11);
    let mut pick = |below: usize| ((random.next() + 1.0) * 0.5 * below as f64) as usize;
    let (mut happened, mut mended, mut refused) = (0, 0, 0);
    for case in 0..cases {
        let first = pick(8);
        let (looks, right, index) = (first..first + 1 + pick(6), pick(2) == 1, pick(20));
        let fault = match case % 6 {
            0 => Fault::Drop { looks, right, index },
            1 => {
                let at = values[1 + pick(98)] / laplacian.unit();
                Fault::Hide(at * (1.0 - 1e-9)..at * (1.0 + 1e-9))
            }
            2 => Fault::Repeat { looks, right, index },
            3 => Fault::Move { looks: 0..1000, right, index },
            4 => Fault::Miscount { factorisation: pick(4), by: [-2, -1, 1, 2][pick(4)] },
            _ => Fault::Spoil { solve: pick(70), entry: pick(5000), by: [10.0, 1e3, 1e6][pick(3)] },
        };
        let (did, certified) = run(&laplacian, &expected, fault);
        happened += usize::from(did);
        mended += usize::from(did && certified);
        refused += usize::from(!certified);
    }
    println!("{happened} of {cases} faults happened: {mended} were mended or did no harm, {refused} refused");
    assert!(happened > cases / 2 && mended > 0 && refused > 0);
}

#[test]
fn faults_are_noticed_or_mended() {
    try_faults(36);
}

#[test]
#[ignore = "takes minutes"]
fn a_thousand_faults_are_noticed_or_mended() {
    try_faults(1000);
}

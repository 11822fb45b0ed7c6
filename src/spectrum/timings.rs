//! What a solve costs, by part.

use rustix::time::{ClockId, clock_gettime};

/// A part of the work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// L and B from the mesh.
    Assembly,
    /// The order of elimination and the structure of the factor.
    Ordering,
    /// Numeric factorisations.
    Factorisation,
    /// Triangular solves.
    Solves,
    /// Products with B.
    Products,
    /// Keeping the Lanczos basis orthogonal, and the three-term recurrence.
    Orthogonalisation,
    /// Orthonormal bases of single blocks.
    Blocks,
    /// Eigenproblems of projected, dense matrices.
    Dense,
    /// Eigenvectors from a basis, where they are asked for.
    Vectors,
    /// Everything else.
    Rest,
}

impl Cost {
    /// All parts, in the order of a table.
    pub const ALL: [Self; 10] = [
        Self::Assembly,
        Self::Ordering,
        Self::Factorisation,
        Self::Solves,
        Self::Products,
        Self::Orthogonalisation,
        Self::Blocks,
        Self::Dense,
        Self::Vectors,
        Self::Rest,
    ];

    /// A short name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Assembly => "assembly",
            Self::Ordering => "ordering",
            Self::Factorisation => "factorisation",
            Self::Solves => "solves",
            Self::Products => "products",
            Self::Orthogonalisation => "orthogonalisation",
            Self::Blocks => "blocks",
            Self::Dense => "dense",
            Self::Vectors => "vectors",
            Self::Rest => "rest",
        }
    }
}

/// Processor time by part, and how often the dear parts were done.
///
/// Timings say how a result came about, not what it is: they are not stored with it, and all of them compare equal, so
/// that two spectra are the same when their numbers are.
#[derive(Debug, Clone, Default)]
pub struct Timings {
    seconds: [f64; Cost::ALL.len()],
    /// Numeric factorisations.
    pub factorisations: usize,
    /// Solves with eight right-hand sides.
    pub solves: usize,
    /// Lanczos processes.
    pub processes: usize,
    /// Older blocks of a basis that another block was made orthogonal to, once for each pair.
    pub pairs: usize,
    /// Older blocks that were read for that: two new ones may need one at a time.
    pub passed: usize,
    /// Numbers in one factor; the sum over the pieces of a mesh.
    pub entries: usize,
    /// Multiplications of one numeric factorisation, likewise.
    pub multiplications: usize,
}

impl PartialEq for Timings {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Timings {
    /// Seconds of processor time of one part.
    #[must_use]
    pub fn seconds(&self, cost: Cost) -> f64 {
        self.seconds[cost as usize]
    }

    /// Seconds of processor time of all parts.
    #[must_use]
    pub fn total(&self) -> f64 {
        self.seconds.iter().sum()
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, other) in self.seconds.iter_mut().zip(other.seconds) {
            *sum += other;
        }
        self.factorisations += other.factorisations;
        self.solves += other.solves;
        self.processes += other.processes;
        self.pairs += other.pairs;
        self.passed += other.passed;
        self.entries += other.entries;
        self.multiplications += other.multiplications;
    }
}

/// Charges the time between two looks at the clock to what was done in it.
#[derive(Debug)]
pub(super) struct Meter {
    pub timings: Timings,
    last: f64,
}

impl Meter {
    pub(super) fn start() -> Self {
        Self { timings: Timings::default(), last: now() }
    }

    /// What was done since the last charge was this.
    pub(super) fn charge(&mut self, cost: Cost) {
        let now = now();
        self.timings.seconds[cost as usize] += now - self.last;
        self.last = now;
        match cost {
            Cost::Factorisation => self.timings.factorisations += 1,
            Cost::Solves => self.timings.solves += 1,
            _ => {}
        }
    }
}

/// Processor time of this thread in seconds.
fn now() -> f64 {
    let time = clock_gettime(ClockId::ThreadCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

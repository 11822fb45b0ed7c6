//! Retrieval, with and without classification before it (paper section 4.2, Table 5 and Figure 7).
//!
//! A [`Scheme`] says how the classes are ranked, how many of them are kept, and by which eigenvalues their members are
//! then ranked. What the paper leaves open is a [`Reading`]; every figure is the strict one's, and the others stand
//! beside it.

use serde::{Deserialize, Serialize};

pub use self::compute::{Draws, Sources, retrieval};
use super::{Curve, Score};

mod compute;

/// What ranks the classes before retrieval.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Gate {
    /// Nothing: every class is kept.
    None,
    /// The strong classifiers, by p(C|M).
    Strong,
    /// The distance d̃ to a class over the first k eigenvalues that minimise ε.
    FirstK,
    /// The distance d̃ to a class over the eigenvalues that hill climbing for ε selected.
    Hill,
}

/// The eigenvalues by which models are ranked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pick {
    /// The first k that maximise mean ADR on D.
    FirstK,
    /// Those that hill climbing for mean ADR selected.
    Hill,
    /// As many as hill climbing selected, drawn at random, several times.
    Random,
}

/// A row of Table 5.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Scheme {
    /// What ranks the classes.
    pub gate: Gate,
    /// What ranks their members.
    pub pick: Pick,
    /// How many classes are kept; 0 when nothing ranks them.
    pub kept: u32,
}

/// How the paper's words are understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Reading {
    /// A model never finds itself; classes are ranked by what classifies best; the members of all kept classes are
    /// ranked together by distance; random subsets are as large as hill climbing's.
    Strict,
    /// The model asked is the first that it finds, and counts.
    Itself,
    /// Classes, too, are ranked by the eigenvalues that retrieve best.
    OneSubset,
    /// The members of the best class come first, then those of the next.
    ClassByClass,
    /// Random subsets are of any size.
    AnySize,
}

/// Mean ADR under one reading.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ReadAs {
    /// How the words are understood.
    pub reading: Reading,
    /// Mean ADR, on D and on Q; for random subsets the mean over the draws.
    pub adr: Score,
}

/// What a scheme retrieves.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Retrieved {
    /// How models are retrieved.
    pub scheme: Scheme,
    /// Mean ADR under the strict reading: every model of D against the others, and the queries against D (Table 5).
    pub adr: Score,
    /// Standard deviation of `adr` over the draws, of random subsets alone.
    pub spread: Option<Score>,
    /// Mean ADR under every reading that makes a difference, the strict one first.
    pub readings: Vec<ReadAs>,
    /// Precision averaged over the models asked (Figure 7): entry i − 1 belongs to a recall of i over its length. What
    /// is not retrieved has a precision of 0. For random subsets averaged over the draws, too.
    pub precision: Curve,
}

impl Gate {
    /// As Table 5 writes it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::None => "–",
            Self::Strong => "SC",
            Self::FirstK => "first-k",
            Self::Hill => "HCBw",
        }
    }
}

impl Pick {
    /// As Table 5 writes it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::FirstK => "first-k",
            Self::Hill => "HCBw",
            Self::Random => "random",
        }
    }
}

impl Reading {
    /// What it means, in one line.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::Strict => "strict",
            Self::Itself => "the model asked is the first that it finds",
            Self::OneSubset => "classes are ranked by the eigenvalues that retrieve best",
            Self::ClassByClass => "the members of the best class come first, then those of the next",
            Self::AnySize => "random subsets of any size",
        }
    }
}

impl Scheme {
    /// How many classes the paper keeps.
    pub const KEPT: [u32; 3] = [5, 10, 15];

    /// The rows of Table 5 in the paper's order, which is that of its figures, with the published mean ADR (re-meshed
    /// models, normalised FEM spectra).
    #[must_use]
    pub fn published() -> [(Self, f64); 21] {
        use Gate::{None, Strong};
        let of = |gate, pick, kept| Self { gate, pick, kept };
        [
            (of(Strong, Pick::FirstK, 5), 0.584),
            (of(Strong, Pick::Hill, 5), 0.580),
            (of(Gate::FirstK, Pick::Hill, 5), 0.571),
            (of(Gate::Hill, Pick::FirstK, 5), 0.565),
            (of(Strong, Pick::FirstK, 10), 0.563),
            (of(Strong, Pick::Hill, 10), 0.560),
            (of(Gate::Hill, Pick::Hill, 5), 0.560),
            (of(Gate::Hill, Pick::Hill, 10), 0.555),
            (of(Gate::Hill, Pick::Hill, 15), 0.555),
            (of(Gate::FirstK, Pick::Hill, 10), 0.555),
            (of(Gate::FirstK, Pick::Hill, 15), 0.555),
            (of(None, Pick::Hill, 0), 0.555),
            (of(Strong, Pick::Hill, 15), 0.546),
            (of(Strong, Pick::FirstK, 15), 0.542),
            (of(Gate::Hill, Pick::FirstK, 10), 0.540),
            (of(Gate::FirstK, Pick::FirstK, 5), 0.532),
            (of(Gate::Hill, Pick::FirstK, 15), 0.530),
            (of(Gate::FirstK, Pick::FirstK, 10), 0.530),
            (of(Gate::FirstK, Pick::FirstK, 15), 0.530),
            (of(None, Pick::FirstK, 0), 0.530),
            (of(None, Pick::Random, 0), 0.337),
        ]
    }

    /// The schemes of Figure 7, in its order.
    #[must_use]
    pub const fn figure_7() -> [Self; 7] {
        const fn of(gate: Gate, pick: Pick, kept: u32) -> Scheme {
            Scheme { gate, pick, kept }
        }
        [
            of(Gate::Strong, Pick::FirstK, 5),
            of(Gate::Strong, Pick::Hill, 5),
            of(Gate::FirstK, Pick::Hill, 5),
            of(Gate::Hill, Pick::FirstK, 5),
            of(Gate::None, Pick::Hill, 0),
            of(Gate::None, Pick::FirstK, 0),
            of(Gate::None, Pick::Random, 0),
        ]
    }
}

impl Retrieved {
    /// The reading whose mean ADR on the queries (on D where there are none) lies closest to a published one; of
    /// several the first.
    #[must_use]
    pub fn closest(&self, published: f64) -> Option<ReadAs> {
        let off = |read: &ReadAs| (read.adr.query.unwrap_or(read.adr.train) - published).abs();
        self.readings.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)))
    }
}

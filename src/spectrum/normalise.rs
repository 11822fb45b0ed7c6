//! What is made of the eigenvalues before shapes are compared.

use serde::{Deserialize, Serialize};

/// How eigenvalues become features.
///
/// *Measure* is the total mass 1ᵀB1: the area of the surface for FEM, the number of vertices for cot (where B is the
/// identity), so that every normalisation but `None` is free of the mesh's scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Default, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Normalisation {
    /// λ as it is.
    None,
    /// λ · measure.
    Area,
    /// λ / λ_kmax, the paper's "norm.".
    #[default]
    Max,
    /// λ · measure / (4π k), which is 1 for a perfect Weyl law.
    Weyl,
    /// ln(λ · measure); zero eigenvalues have no logarithm and become 0 in every model.
    Log,
}

impl Normalisation {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 5] = [Self::None, Self::Area, Self::Max, Self::Weyl, Self::Log];

    /// Whether a feature changes when kmax does. Where it does not, a smaller kmax is a prefix.
    #[must_use]
    pub const fn depends_on_kmax(self) -> bool {
        matches!(self, Self::Max)
    }

    /// The features made of the first `kmax` of `eigenvalues` (ascending, zeros exactly 0).
    ///
    /// Returns `kmax` values. `measure` is 1ᵀB1.
    ///
    /// # Panics
    /// When fewer than `kmax` eigenvalues are given.
    #[must_use]
    pub fn apply(self, eigenvalues: &[f64], measure: f64, kmax: usize) -> Vec<f64> {
        let values = &eigenvalues[..kmax];
        let scaled = |scale: f64| values.iter().map(|v| v * scale).collect();
        match self {
            Self::None => values.to_vec(),
            Self::Area => scaled(measure),
            Self::Max => match values.last() {
                Some(&top) if top > 0.0 => values.iter().map(|v| v / top).collect(),
                _ => vec![0.0; kmax],
            },
            Self::Weyl => {
                (1..).zip(values).map(|(k, v)| v * measure / (4.0 * std::f64::consts::PI * f64::from(k))).collect()
            }
            Self::Log => values.iter().map(|&v| if v > 0.0 { (v * measure).ln() } else { 0.0 }).collect(),
        }
    }
}

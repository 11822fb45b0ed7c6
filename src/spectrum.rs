//! (L, B) → the first eigenvalues, certified complete.

pub use self::normalise::Normalisation;

mod normalise;

//! The paper's own figures, Tables 1 to 5.
//!
//! Its data set has 20 classes of 15 training and 5 query models. Re-meshed models have 10 000 vertices. Cot spectra
//! are not normalised in its tables.

/// A figure as published, with the number of eigenvalues it was reached with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Published {
    /// ε or mean ADR.
    pub value: f64,
    /// k0, or the (mean) number of eigenvalues selected.
    pub count: f64,
}

/// Which published column a spectrum belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Column {
    /// Original models, FEM, not normalised.
    OriginalFem,
    /// Original models, FEM, normalised.
    OriginalFemNormalised,
    /// Original models, cotangent weights.
    OriginalCot,
    /// Re-meshed models, FEM, not normalised.
    RemeshedFem,
    /// Re-meshed models, FEM, normalised.
    RemeshedFemNormalised,
    /// Re-meshed models, cotangent weights.
    RemeshedCot,
}

/// A row of a published table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Row {
    /// Table 1.
    FirstKError,
    /// Table 2.
    ClimbError,
    /// Table 3, T = 20.
    Boosted,
    /// Table 4.
    FirstKAdr,
    /// Table 4.
    ClimbAdr,
}

/// One of Tables 1 to 4's values.
#[must_use]
pub const fn published(row: Row, column: Column) -> Published {
    // In the order of `Column`.
    let values = match row {
        Row::FirstKError => [(0.30, 11.0), (0.27, 13.0), (0.37, 13.0), (0.29, 9.0), (0.22, 15.0), (0.32, 59.0)],
        Row::ClimbError => [(0.40, 8.0), (0.28, 5.0), (0.34, 17.0), (0.37, 13.0), (0.22, 10.0), (0.34, 7.0)],
        Row::Boosted => [(0.63, 6.8), (0.14, 27.15), (0.50, 8.35), (0.68, 7.3), (0.03, 30.6), (0.05, 32.1)],
        Row::FirstKAdr => [(0.55, 10.0), (0.61, 10.0), (0.50, 12.0), (0.56, 10.0), (0.62, 15.0), (0.57, 12.0)],
        Row::ClimbAdr => [(0.56, 8.0), (0.65, 16.0), (0.54, 17.0), (0.56, 8.0), (0.66, 15.0), (0.57, 6.0)],
    };
    let (value, count) = match column {
        Column::OriginalFem => values[0],
        Column::OriginalFemNormalised => values[1],
        Column::OriginalCot => values[2],
        Column::RemeshedFem => values[3],
        Column::RemeshedFemNormalised => values[4],
        Column::RemeshedCot => values[5],
    };
    Published { value, count }
}

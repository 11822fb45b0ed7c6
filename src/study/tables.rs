//! Tables 1 to 4 of the paper, for one spectrum.

use serde::{Deserialize, Serialize};

use super::{Boosted, Climbed, Curve, FirstK, Score};
use crate::selection::SelCount;

/// A cell of a table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Cell {
    /// There is no such figure (no query models, say).
    Missing,
    /// A count.
    Count(u64),
    /// A figure, shown with this many decimals.
    Number {
        /// The figure itself, unrounded.
        value: f64,
        /// Decimals shown.
        decimals: u8,
    },
    /// Words.
    Text(String),
}

/// A table of the paper, ready to be shown or written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Its number in the paper.
    pub number: u32,
    /// What it shows.
    pub title: String,
    /// The heads of the columns.
    pub columns: Vec<String>,
    /// As many cells in each row as there are columns.
    pub rows: Vec<Vec<Cell>>,
}

/// Decimals of ε and mean ADR.
const DECIMALS: u8 = 3;

fn figure(value: Option<f64>) -> Cell {
    value.map_or(Cell::Missing, |value| Cell::Number { value, decimals: DECIMALS })
}

/// Figures on D and on Q with a count between them.
fn scored(score: Option<Score>, count: Cell) -> [Cell; 3] {
    [figure(score.map(|score| score.train)), count, figure(score.and_then(|score| score.query))]
}

fn text(words: &str) -> Cell {
    Cell::Text(words.to_owned())
}

/// The first-k figures: at the best k, then at the k that was chosen.
fn first_k_row(curve: Option<(&Curve, usize)>, k: usize) -> Vec<Cell> {
    let Some((curve, best)) = curve else { return missing("first-k", 6) };
    let at_best = scored(curve.at(best), if best == 0 { Cell::Missing } else { Cell::Count(best as u64) });
    let chosen = curve.at(k);
    let at_chosen = [figure(chosen.map(|score| score.train)), figure(chosen.and_then(|score| score.query))];
    [text("first-k")].into_iter().chain(at_best).chain(at_chosen).collect()
}

fn hill_row(climbed: Option<(Score, &Climbed)>) -> Vec<Cell> {
    let Some((score, climbed)) = climbed else { return missing("HCBw", 4) };
    let count = Cell::Count(climbed.climb.selected.len() as u64);
    [text("HCBw")].into_iter().chain(scored(Some(score), count)).collect()
}

/// The row of a method whose figures are not there.
fn missing(method: &str, columns: usize) -> Vec<Cell> {
    std::iter::once(text(method)).chain(vec![Cell::Missing; columns - 1]).collect()
}

fn table(number: u32, title: &str, columns: &[&str], rows: Vec<Vec<Cell>>) -> Table {
    Table { number, title: title.to_owned(), columns: columns.iter().map(|&head| head.to_owned()).collect(), rows }
}

/// Tables 1 to 4 with the figure on D, the number of eigenvalues, and beside it the figure on Q.
///
/// For first-k also the figures at the chosen `k` (none beyond the curves' end). `rounds` is the T of Table 3, whose
/// number of eigenvalues is the mean over the classes, counted as `sel` says.
#[must_use]
pub fn tables(
    first_k: &FirstK,
    climb_error: &Climbed,
    climb_adr: &Climbed,
    boosted: &Boosted,
    k: usize,
    rounds: usize,
    sel: SelCount,
) -> Vec<Table> {
    tables_of(Some(first_k), Some(climb_error), Some(climb_adr), Some(boosted), k, rounds, sel)
}

/// As [`tables`], of the parts that are there: the figures of the others are missing.
#[must_use]
pub fn tables_of(
    first_k: Option<&FirstK>,
    climb_error: Option<&Climbed>,
    climb_adr: Option<&Climbed>,
    boosted: Option<&Boosted>,
    k: usize,
    rounds: usize,
    sel: SelCount,
) -> Vec<Table> {
    let at = |figure: &str, side: &str| format!("{figure} on {side}, k = {k}");
    let (sel_head, mean) = match sel {
        SelCount::Chosen => ("mean sel (chosen)", boosted.map(|boosted| boosted.mean_chosen)),
        SelCount::Ties => ("mean sel (ties)", boosted.map(|boosted| boosted.mean_ties)),
    };
    let mean = mean.map_or(Cell::Missing, |value| Cell::Number { value, decimals: 2 });
    let boosted_cells = scored(boosted.map(|boosted| boosted.error), mean);
    let mut hill_adr = hill_row(climb_adr.map(|climbed| (climbed.adr, climbed)));
    hill_adr.extend([Cell::Missing, Cell::Missing]);
    vec![
        table(
            1,
            "Classification error ε with the first k eigenvalues",
            &["method", "ε on D", "k0", "ε on Q", &at("ε", "D"), &at("ε", "Q")],
            vec![first_k_row(first_k.map(|found| (&found.error, found.best_error)), k)],
        ),
        table(
            2,
            "Classification error ε after hill climbing with backward steps",
            &["method", "ε on D", "sel", "ε on Q"],
            vec![hill_row(climb_error.map(|climbed| (climbed.error, climbed)))],
        ),
        table(
            3,
            &format!("Classification error ε of AdaBoost, T = {rounds}"),
            &["method", "ε on D", sel_head, "ε on Q"],
            vec![[text("AdaBoost")].into_iter().chain(boosted_cells).collect()],
        ),
        table(
            4,
            "Mean ADR",
            &["method", "ADR on D", "k0 or sel", "ADR on Q", &at("ADR", "D"), &at("ADR", "Q")],
            vec![first_k_row(first_k.map(|found| (&found.adr, found.best_adr)), k), hill_adr],
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::{Cell, tables};
    use crate::{
        metrics::{
            Distance, Sample,
            samples::{nobody, sample},
        },
        selection::{Cost, SelCount, boost, climb},
        study::{Table, boosted, climbed, first_k},
        watch::Unwatched,
    };

    fn of(sample: &Sample, k: usize, sel: SelCount) -> Vec<Table> {
        let (distance, rounds) = (Distance::L2, 6);
        let climbed = |cost| climbed(sample, distance, &climb(sample, distance, cost, &Unwatched).unwrap());
        let boosted = boosted(sample, &boost(sample, rounds, &Unwatched).unwrap());
        let first_k = first_k(sample, distance, &Unwatched).unwrap();
        tables(&first_k, &climbed(Cost::Error), &climbed(Cost::Adr), &boosted, k, rounds, sel)
    }

    #[test]
    fn every_row_has_a_cell_for_every_column() {
        for sample in [sample(1, 5, 9, 0), nobody()] {
            let tables = of(&sample, 4, SelCount::Chosen);
            assert_eq!(tables.iter().map(|table| table.number).collect::<Vec<_>>(), [1, 2, 3, 4]);
            for table in tables {
                assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{table:?}");
            }
        }
    }

    #[test]
    fn the_figures_are_those_of_the_parts() {
        let sample = sample(1, 5, 9, 0);
        let first_k = first_k(&sample, Distance::L2, &Unwatched).unwrap();
        let number = |value, decimals| Cell::Number { value, decimals };
        let tables = of(&sample, 4, SelCount::Ties);
        let best = first_k.best_error;
        let expected = [
            Cell::Text("first-k".to_owned()),
            number(first_k.error.train[best - 1], 3),
            Cell::Count(best as u64),
            number(first_k.error.query[best - 1], 3),
            number(first_k.error.train[3], 3),
            number(first_k.error.query[3], 3),
        ];
        assert_eq!(tables[0].rows, [expected]);
        let boosted = boosted(&sample, &boost(&sample, 6, &Unwatched).unwrap());
        assert_eq!(tables[2].columns[2], "mean sel (ties)");
        assert_eq!(tables[2].rows[0][2], number(boosted.mean_ties, 2));
        assert_eq!(of(&sample, 4, SelCount::Chosen)[2].rows[0][2], number(boosted.mean_chosen, 2));
        assert_eq!(tables[3].rows.len(), 2);
    }

    #[test]
    fn a_k_beyond_the_curves_has_no_figures() {
        let tables = of(&sample(1, 5, 9, 0), 10, SelCount::Chosen);
        assert_eq!(tables[0].rows[0][4..], [Cell::Missing, Cell::Missing]);
        assert_eq!(tables[0].columns[4], "ε on D, k = 10");
    }

    #[test]
    fn without_models_nothing_is_there() {
        let tables = of(&nobody(), 1, SelCount::Chosen);
        assert_eq!(tables[0].rows[0][1..], vec![Cell::Missing; 5]);
    }
}

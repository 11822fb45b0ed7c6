//! Tables 1 to 4 under the settings of pins, and the present ones beside them.

use super::{Pin, present};
use crate::{
    study::{self, Cell, Method, Table},
    workbench::State,
};

/// Tables 1 to 4 under the settings of a pin; none before its figures are there.
#[must_use]
pub fn tables(pin: &Pin) -> Option<Vec<Table>> {
    let (figures, settings) = (&pin.figures, &pin.settings);
    Some(study::tables(
        figures.first_k.as_deref()?,
        figures.climb_error.as_deref()?,
        figures.climb_adr.as_deref()?,
        figures.boosted.as_deref()?,
        settings.k,
        settings.rounds,
        settings.sel,
    ))
}

/// The method whose decisions a table's ε is made of. Table 4 has no decisions.
const fn method(number: u32) -> Option<Method> {
    match number {
        1 => Some(Method::BestK),
        2 => Some(Method::ClimbError),
        3 => Some(Method::Boost),
        _ => None,
    }
}

/// What a cell holds as a number, and its decimals.
fn number(cell: &Cell) -> Option<(f64, usize)> {
    match cell {
        Cell::Count(count) => Some((*count as f64, 0)),
        Cell::Number { value, decimals } => Some((*value, usize::from(*decimals))),
        Cell::Missing | Cell::Text(_) => None,
    }
}

/// The tables with a row more for each row and pin: the present figure less the pin's, and, where a table has
/// decisions, two columns with the p of the paired test ([`study::mcnemar`]) on D and on Q.
#[must_use]
pub fn against(state: &State, tables: &[Table]) -> Vec<Table> {
    let pinned: Vec<(&Pin, Vec<Table>)> = state.pins.iter().filter_map(|pin| Some((pin, self::tables(pin)?))).collect();
    if pinned.is_empty() {
        return tables.to_vec();
    }
    let now = present(state);
    tables.iter().enumerate().map(|(at, table)| beside(&now, table, at, &pinned)).collect()
}

fn beside(now: &super::Figures, table: &Table, at: usize, pinned: &[(&Pin, Vec<Table>)]) -> Table {
    let method = method(table.number);
    let mut out = Table { rows: Vec::new(), ..table.clone() };
    if method.is_some() {
        out.columns.extend(["p on D", "p on Q"].map(String::from));
    }
    for (place, row) in table.rows.iter().enumerate() {
        let mut whole = row.clone();
        whole.extend(method.iter().flat_map(|_| [Cell::Missing, Cell::Missing]));
        out.rows.push(whole);
        for (pin, tables) in pinned {
            let Some(theirs) = tables.get(at).and_then(|table| table.rows.get(place)) else { continue };
            let difference = |(mine, theirs): (&Cell, &Cell)| match (number(mine), number(theirs)) {
                (Some((mine, decimals)), Some((theirs, _))) => signed(mine - theirs, decimals),
                _ => Cell::Missing,
            };
            let mut cells: Vec<Cell> = row.iter().zip(theirs).map(difference).collect();
            if let (Some(first), Some(Cell::Text(name))) = (cells.first_mut(), row.first()) {
                *first = Cell::Text(format!("{name} − {}", pin.letter));
            }
            if let Some(method) = method {
                let test = |queries: bool| now.test(&pin.figures, method, queries);
                let cell = |p: Option<f64>| p.map_or(Cell::Missing, |value| Cell::Number { value, decimals: 3 });
                cells.extend([cell(test(false)), cell(test(true))]);
            }
            out.rows.push(cells);
        }
    }
    out
}

/// A difference with its sign.
fn signed(value: f64, decimals: usize) -> Cell {
    Cell::Text(format!("{value:+.decimals$}").replace('-', "−"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_have_a_sign() {
        let shown = [0.021, -0.021, 0.0].map(|value| signed(value, 3));
        assert_eq!(shown, ["+0.021", "−0.021", "+0.000"].map(|text| Cell::Text(text.to_owned())));
        assert_eq!(signed(-3.0, 0), Cell::Text("−3".to_owned()));
    }
}

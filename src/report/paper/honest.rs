//! What the paper could not see: how much of each figure is selection bias.

use super::{
    Examined, Section,
    tables::{maybe, number},
};
use crate::{
    figure::{Axis, Dash, Figure, Layer, Mark, Panel, Style},
    study::{Cell, Honest, HonestRow, Interval, Table},
};

pub(super) fn sections(honest: &[Examined]) -> Vec<Section> {
    let Some(Examined { honest: first, .. }) = honest.first() else { return Vec::new() };
    let plan = first.plan;
    let words = vec![
        format!(
            "The paper selects and scores on the same models. Here all models, D and Q together, are dealt into {} folds {} \
             times; every selection is made without the fold that is then asked, so each model is judged by a selection \
             that has not seen it (nested cross-validation). Intervals are 95 % percentiles of {} bootstrap draws over \
             models.",
            plan.folds, plan.repeats, plan.resamples
        ),
        best(honest),
    ];
    let rows = honest
        .iter()
        .flat_map(|Examined { features, honest, .. }| honest.rows.iter().map(move |row| cells(features, row)));
    let rows = rows.collect();
    let columns = [
        "features",
        "method",
        "ε on D, selected on D",
        "ε on Q",
        "honest ε",
        "from",
        "to",
        "honest mean ADR",
        "from",
        "to",
        "selected",
    ];
    let title = "Error by the paper's protocol and by nested cross-validation".to_owned();
    let table = Table { number: 0, title, columns: columns.map(String::from).to_vec(), rows };
    vec![
        Section {
            heading: "Honest figures".to_owned(),
            words,
            table: Some(("honest".to_owned(), table)),
            figure: Some(("honest".to_owned(), figure(honest))),
        },
        pairs(honest),
    ]
}

fn best(honest: &[Examined]) -> String {
    let rows =
        honest.iter().flat_map(|Examined { features, honest, .. }| honest.rows.iter().map(move |row| (features, row)));
    let least = rows.min_by(|(_, a), (_, b)| a.error.mean.total_cmp(&b.error.mean));
    least.map_or_else(String::new, |(name, row)| {
        let Interval { mean, low, high } = row.error;
        format!(
            "The least honest ε of this table is {mean:.3} ({low:.3} to {high:.3}): {} on {name}. As the least of many it \
             is a little too good; the part after the next one chooses without that.",
            row.method.name()
        )
    })
}

fn cells(name: &str, row: &HonestRow) -> Vec<Cell> {
    let interval = |interval: Option<Interval>| {
        [interval.map(|i| i.mean), interval.map(|i| i.low), interval.map(|i| i.high)].map(|value| maybe(value, 3))
    };
    let mut cells =
        vec![Cell::Text(name.to_owned()), Cell::Text(row.method.name()), number(row.apparent, 3), maybe(row.query, 3)];
    cells.extend(interval(Some(row.error)));
    cells.extend(interval(row.adr));
    cells.push(number(row.selected, 1));
    cells
}

/// The figure on D, where it was selected, beside the honest one with its interval.
fn figure(honest: &[Examined]) -> Figure {
    // One axis for all, as long as the figures need: differences of hundredths are to be seen.
    let rows = honest.iter().flat_map(|examined| &examined.honest.rows);
    let most = rows.flat_map(|row| [row.apparent, row.error.high]).fold(0.0, f64::max);
    let top = ((most * 5.0).ceil() / 5.0).clamp(0.2, 1.0);
    let panel = |Examined { features: name, honest, .. }: &Examined| {
        let at = |offset: f64| (0..honest.rows.len()).map(move |at| at as f64 + offset).collect::<Vec<_>>();
        let bars = at(0.12).into_iter().zip(&honest.rows);
        let bars = bars.map(|(x, row)| [x, row.error.low, row.error.mean, row.error.high]).collect();
        let points = at(-0.12).into_iter().zip(&honest.rows).map(|(x, row)| [x, row.apparent]).collect();
        Panel {
            title: name.clone(),
            x: Axis::names("", honest.rows.iter().map(|row| row.method.name()).collect()),
            y: Axis::linear("ε").within(0.0, top),
            layers: vec![
                Layer::Points { name: "on D, selected on D".to_owned(), style: Style::marks(0, Mark::Cross), points },
                Layer::Intervals {
                    name: "nested cross-validation, 95 %".to_owned(),
                    style: Style { hue: 1, dash: Dash::Solid, mark: Some(Mark::Circle) },
                    bars,
                },
            ],
        }
    };
    Figure { title: String::new(), panels: honest.iter().map(panel).collect(), across: 3 }
}

/// Every two methods on the same features: a table of differences with a row and a column for each.
fn pairs(honest: &[Examined]) -> Section {
    let names = |honest: &Honest| honest.rows.iter().map(|row| row.method.name()).collect::<Vec<_>>();
    let heads = honest.first().map(|examined| names(&examined.honest)).unwrap_or_default();
    let row = |name: &str, honest: &Honest, at: usize| {
        let cell = |other: usize| {
            let pair = honest.pairs.iter().find(|pair| (pair.first, pair.second) == (at, other))?;
            let p = p_value(pair.permutation);
            Some(Cell::Text(format!("{} ({p})", signed(pair.difference.mean))))
        };
        let method = Cell::Text(honest.rows[at].method.name());
        let cells = (1..honest.rows.len()).map(|other| cell(other).unwrap_or(Cell::Missing));
        [Cell::Text(name.to_owned()), method].into_iter().chain(cells).collect::<Vec<_>>()
    };
    let rows = honest.iter().flat_map(|Examined { features, honest, .. }| {
        (0..honest.rows.len().saturating_sub(1)).map(move |at| row(features, honest, at))
    });
    let columns = ["features", "method"].map(str::to_owned).into_iter();
    let columns = columns.chain(heads.iter().skip(1).map(|name| format!("less {name}")));
    let title = "Every two methods on the same models".to_owned();
    let table = Table { number: 0, title: title.clone(), columns: columns.collect(), rows: rows.collect() };
    let words = vec![
        "The honest ε of the method in the row less that of the method in the column, and in brackets the two-sided p of \
         a permutation test on the models: negative is in favour of the row. p is for each pair by itself, of so many \
         pairs some are small by chance, and 0.0005 is the least that 2000 throws can give. The file pairs.csv has any \
         two methods, across features too, with intervals, and McNemar's test on Q where the features are the same."
            .to_owned(),
    ];
    Section { heading: title, words, table: Some(("pairs-matrix".to_owned(), table)), figure: None }
}

/// A difference with its sign.
fn signed(value: f64) -> String {
    format!("{value:+.3}").replace('-', "−")
}

/// p with as many decimals as it needs.
fn p_value(p: f64) -> String {
    if p < 0.01 { format!("{p:.4}") } else { format!("{p:.2}") }
}

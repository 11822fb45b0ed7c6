//! What the paper could not see: how much of each figure is selection bias.

use std::sync::Arc;

use super::{
    Section,
    tables::{maybe, number},
};
use crate::{
    figure::{Axis, Dash, Figure, Layer, Mark, Panel, Style},
    study::{Cell, Honest, HonestPair, HonestRow, Interval, Table},
};

pub(super) fn sections(honest: &[(String, Arc<Honest>)]) -> Vec<Section> {
    let Some((_, first)) = honest.first() else { return Vec::new() };
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
    let rows = honest.iter().flat_map(|(name, honest)| honest.rows.iter().map(move |row| cells(name, row))).collect();
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

fn best(honest: &[(String, Arc<Honest>)]) -> String {
    let rows = honest.iter().flat_map(|(name, honest)| honest.rows.iter().map(move |row| (name, row)));
    let least = rows.min_by(|(_, a), (_, b)| a.error.mean.total_cmp(&b.error.mean));
    least.map_or_else(String::new, |(name, row)| {
        let Interval { mean, low, high } = row.error;
        format!("The least honest ε is {mean:.3} ({low:.3} to {high:.3}): {} on {name}.", row.method.name())
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
fn figure(honest: &[(String, Arc<Honest>)]) -> Figure {
    let panel = |(name, honest): &(String, Arc<Honest>)| {
        let at = |offset: f64| (0..honest.rows.len()).map(move |at| at as f64 + offset).collect::<Vec<_>>();
        let bars = at(0.12).into_iter().zip(&honest.rows);
        let bars = bars.map(|(x, row)| [x, row.error.low, row.error.mean, row.error.high]).collect();
        let points = at(-0.12).into_iter().zip(&honest.rows).map(|(x, row)| [x, row.apparent]).collect();
        Panel {
            title: name.clone(),
            x: Axis::names("", honest.rows.iter().map(|row| row.method.name()).collect()),
            y: Axis::linear("ε").within(0.0, 1.0),
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
    Figure { title: String::new(), panels: honest.iter().map(panel).collect(), across: 2 }
}

fn pairs(honest: &[(String, Arc<Honest>)]) -> Section {
    let row = |name: &str, honest: &Honest, pair: &HonestPair| {
        let method = |at: usize| Cell::Text(honest.rows[at].method.name());
        let Interval { mean, low, high } = pair.difference;
        vec![
            Cell::Text(name.to_owned()),
            method(pair.first),
            method(pair.second),
            number(mean, 3),
            number(low, 3),
            number(high, 3),
            number(pair.permutation, 4),
            maybe(pair.mcnemar, 4),
        ]
    };
    let rows = honest.iter().flat_map(|(name, honest)| honest.pairs.iter().map(move |pair| row(name, honest, pair)));
    let columns =
        ["features", "first", "second", "difference of honest ε", "from", "to", "permutation p", "McNemar p on Q"];
    let title = "Every two methods on the same models".to_owned();
    let table =
        Table { number: 0, title: title.clone(), columns: columns.map(String::from).to_vec(), rows: rows.collect() };
    let words =
        "A negative difference is in favour of the first. p is two-sided and for each pair by itself: of so many \
                 pairs some are small by chance."
            .to_owned();
    Section { heading: title, words: vec![words], table: Some(("pairs".to_owned(), table)), figure: None }
}

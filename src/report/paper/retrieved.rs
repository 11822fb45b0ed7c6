//! Table 5 and Figure 7: retrieval, with and without classification before it.

use super::{
    Section, Variant, figures,
    tables::{maybe, number},
};
use crate::{
    figure::{Axis, Dash, Figure, Layer, Mark, Panel, Style},
    study::{Cell, Reading, Retrieved, Scheme, Table},
};

pub(super) fn sections(retrieved: &[Retrieved]) -> Vec<Section> {
    if retrieved.is_empty() {
        return Vec::new();
    }
    vec![table_5(retrieved), figure_7(retrieved)]
}

fn name(scheme: Scheme) -> String {
    let Scheme { gate, pick, kept } = scheme;
    if kept == 0 { format!("– / {}", pick.name()) } else { format!("{} / {} / {kept}", gate.name(), pick.name()) }
}

fn table_5(retrieved: &[Retrieved]) -> Section {
    let published = Scheme::published();
    let row = |&(scheme, paper): &(Scheme, f64)| {
        let found = retrieved.iter().find(|found| found.scheme == scheme)?;
        let ours = found.adr.query;
        let closest = found.closest(paper)?;
        let kept = if scheme.kept == 0 { Cell::Missing } else { Cell::Count(u64::from(scheme.kept)) };
        Some(vec![
            Cell::Text(scheme.gate.name().to_owned()),
            Cell::Text(scheme.pick.name().to_owned()),
            kept,
            maybe(ours, 3),
            maybe(found.spread.and_then(|spread| spread.query), 3),
            number(paper, 3),
            maybe(ours.map(|ours| ours - paper), 3),
            number(found.adr.train, 3),
            maybe(closest.adr.query.or(Some(closest.adr.train)), 3),
            Cell::Text(closest.reading.about().to_owned()),
        ])
    };
    let columns = [
        "classification",
        "retrieval",
        "classes",
        "mean ADR on Q",
        "spread",
        "paper's",
        "difference",
        "mean ADR on D",
        "closest reading",
        "which is",
    ];
    let title = format!("Mean ADR with classification before retrieval, {}", Variant::BEST.name());
    let words = vec![
        "Classes are ranked by the classifier, and only the models of the first 5, 10 or 15 classes are ranked by distance, \
         with the eigenvalues that maximise mean ADR on D (Table 4). For random subsets: the mean and the standard \
         deviation over the draws."
            .to_owned(),
        format!(
            "Where the paper can be understood in several ways, the figure is that of the strict reading, and the last \
             columns have the one closest to the published value. Readings: {}.",
            [Reading::Strict, Reading::Itself, Reading::OneSubset, Reading::ClassByClass, Reading::AnySize]
                .map(Reading::about)
                .join("; ")
        ),
    ];
    let table = Table {
        number: 5,
        title: title.clone(),
        columns: columns.map(String::from).to_vec(),
        rows: published.iter().filter_map(row).collect(),
    };
    Section {
        heading: format!("Table 5: {title}"),
        words,
        table: Some(("table-5-retrieval".to_owned(), table)),
        figure: None,
    }
}

/// Looks of the seven curves in the paper's order.
const LOOKS: [Style; 7] = [
    Style { hue: 0, dash: Dash::Solid, mark: Some(Mark::Circle) },
    Style { hue: 1, dash: Dash::Solid, mark: Some(Mark::Square) },
    Style { hue: 2, dash: Dash::Solid, mark: Some(Mark::Triangle) },
    Style { hue: 3, dash: Dash::Solid, mark: Some(Mark::Diamond) },
    Style { hue: 1, dash: Dash::Dashed, mark: None },
    Style { hue: 2, dash: Dash::DashDot, mark: None },
    Style { hue: 0, dash: Dash::Dotted, mark: None },
];

fn figure_7(retrieved: &[Retrieved]) -> Section {
    let schemes = Scheme::figure_7();
    let lines = schemes.iter().zip(LOOKS).filter_map(|(scheme, style)| {
        let found = retrieved.iter().find(|found| found.scheme == *scheme)?;
        let precision = if found.precision.query.is_empty() { &found.precision.train } else { &found.precision.query };
        let steps = precision.len() as f64;
        let points = precision.iter().enumerate().map(|(at, &value)| [(at + 1) as f64 / steps, value]).collect();
        Some(Layer::Line { name: name(*scheme), style, points })
    });
    let panel = Panel {
        title: String::new(),
        x: Axis::linear("recall").within(0.0, 1.0),
        y: Axis::linear("precision").within(0.0, 1.0),
        layers: lines.collect(),
    };
    figures::section(
        "figure-7",
        "Figure 7: Precision and recall",
        &format!(
            "{}, queries against D: classification / retrieval / classes kept. A relevant model that is not retrieved \
             counts with a precision of 0.",
            Variant::BEST.name()
        ),
        Figure { title: String::new(), panels: vec![panel], across: 1 },
    )
}

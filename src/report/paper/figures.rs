//! Figures 3 to 6.

use super::{Head, Rows, Section, Variant};
use crate::{
    figure::{Axis, Cell, Dash, Figure, Layer, Mark, Panel, Style},
    laplacian::Operator,
    study::{Curve, Mark as Selected},
};

/// The paper's classes in Figure 4, by words that data sets have for them.
const SHOWN: [&[&str]; 3] = [&["human"], &["humanoid", "armadillo"], &["bird"]];
/// Its marks.
const MARKS: [Mark; 3] = [Mark::Cross, Mark::Circle, Mark::Square];

pub(super) fn sections(head: &Head, rows: &[Rows]) -> Vec<Section> {
    let mut sections = vec![section(
        "figure-3",
        "Figure 3: Classification error on the first k eigenvalues",
        "ε on D (leave-one-out) against k.",
        curves(rows, "ε", |rows| &rows.first_k.error),
    )];
    // The paper shows its selections on one spectrum: the one that it finds best.
    if let Some(best) = rows.iter().find(|rows| rows.spectrum == Variant::BEST) {
        sections.push(section(
            "figure-4",
            "Figure 4: Eigenvalues that AdaBoost selected",
            &format!("{}: the mean over the class of each selected eigenvalue, against its index.", best.name),
            selections(head, best),
        ));
        sections.push(section(
            "figure-5",
            "Figure 5: Selection of the relevant eigenvalues",
            &format!(
                "{}: for each class the range of each selected eigenvalue over its training models; the darker, the \
                 greater its weight Σ α.",
                best.name
            ),
            map(head, best),
        ));
    }
    sections.push(section(
        "figure-6",
        "Figure 6: Mean ADR on the first k eigenvalues",
        "Mean ADR on D, each model against all the others, against k.",
        curves(rows, "mean ADR", |rows| &rows.first_k.adr),
    ));
    sections
}

pub(super) fn section(stem: &str, heading: &str, words: &str, figure: Figure) -> Section {
    Section {
        heading: heading.to_owned(),
        words: vec![words.to_owned()],
        table: None,
        figure: Some((stem.to_owned(), figure)),
    }
}

/// Colour by operator and normalisation, dashes and marks by the mesh: pairs that belong together look alike.
fn style(variant: Variant) -> Style {
    let (hue, mark) = match (variant.operator, variant.normalised) {
        (Operator::Fem, false) => (0, None),
        (Operator::Fem, true) => (1, Some(Mark::Circle)),
        (Operator::Cot, false) => (2, Some(Mark::Triangle)),
        (Operator::Cot, true) => (3, Some(Mark::Cross)),
    };
    Style { hue, dash: if variant.remeshed { Dash::Dashed } else { Dash::Solid }, mark }
}

fn curves(rows: &[Rows], label: &str, curve: fn(&Rows) -> &Curve) -> Figure {
    let line = |rows: &Rows| Layer::Line {
        name: rows.name.clone(),
        style: style(rows.spectrum),
        points: curve(rows).train.iter().enumerate().map(|(at, &value)| [(at + 1) as f64, value]).collect(),
    };
    let layers = rows.iter().map(line).collect();
    let (x, y) = (Axis::log("k"), Axis::linear(label).within(0.0, 1.0));
    Figure { title: String::new(), panels: vec![Panel { title: String::new(), x, y, layers }], across: 1 }
}

/// The classes of Figure 4 where the data set has them, filled up with its first ones.
fn shown(head: &Head, rows: &Rows) -> Vec<usize> {
    let selected = |class: &usize| rows.marks.get(*class).is_some_and(|marks| !marks.is_empty());
    let mut shown: Vec<usize> = Vec::new();
    for words in SHOWN {
        let named = |name: &String| {
            words.iter().any(|word| name.eq_ignore_ascii_case(word) || name.eq_ignore_ascii_case(&format!("{word}s")))
        };
        shown.extend(head.classes.iter().position(named).filter(selected));
    }
    let others = (0..head.classes.len()).filter(selected).filter(|class| !shown.contains(class));
    let others: Vec<usize> = others.take(SHOWN.len().saturating_sub(shown.len())).collect();
    shown.extend(others);
    shown
}

fn selections(head: &Head, rows: &Rows) -> Figure {
    let layer = |(turn, &class): (usize, &usize)| Layer::Points {
        name: head.classes[class].clone(),
        style: Style::marks(turn, MARKS[turn % MARKS.len()]),
        points: rows.marks[class].iter().map(|mark| [f64::from(mark.index), mark.mean]).collect(),
    };
    let shown = shown(head, rows);
    let all: Vec<Layer> = shown.iter().enumerate().map(layer).collect();
    let width = rows.first_k.error.train.len() as f64;
    let panel = |title: String, layers: Vec<Layer>| Panel {
        title,
        x: Axis::linear("index k").within(0.0, width.max(1.0)),
        y: Axis::linear("λ/max").within(0.0, 1.0),
        layers,
    };
    let mut panels: Vec<Panel> =
        shown.iter().zip(&all).map(|(&class, layer)| panel(head.classes[class].clone(), vec![layer.clone()])).collect();
    panels.push(panel("together".to_owned(), all));
    Figure { title: String::new(), panels, across: 2 }
}

fn map(head: &Head, rows: &Rows) -> Figure {
    let column = |(class, marks): (usize, &Vec<Selected>)| {
        let most = marks.iter().map(|mark| mark.alpha).fold(0.0, f64::max);
        let cell = move |mark: &Selected| Cell {
            x: [class as f64 - 0.38, class as f64 + 0.38],
            y: [mark.low, mark.high],
            weight: if most > 0.0 { mark.alpha / most } else { 0.0 },
        };
        let mut cells: Vec<Cell> = marks.iter().map(cell).collect();
        // The weightiest in front.
        cells.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        cells
    };
    let cells = rows.marks.iter().enumerate().flat_map(column).collect();
    let panel = Panel {
        title: String::new(),
        x: Axis::names("", head.classes.to_vec()),
        y: Axis::linear("λ/max").within(0.0, 1.0),
        layers: vec![Layer::Map { cells }],
    };
    Figure { title: String::new(), panels: vec![panel], across: 1 }
}

//! Figures 3 to 6.

use super::{Head, Rows, Section, Variant};
use crate::{
    figure::{Dash, Figure, Mark, Style},
    laplacian::Operator,
    report::figures as drawn,
    study::Curve,
};

/// The paper's classes in Figure 4, by words that data sets have for them.
const SHOWN: [&[&str]; 3] = [&["human"], &["humanoid", "armadillo"], &["bird"]];

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
            drawn::selections(&head.classes, &shown(head, best), &best.marks, best.first_k.error.train.len(), "λ/max"),
        ));
        sections.push(section(
            "figure-5",
            "Figure 5: Selection of the relevant eigenvalues",
            &format!(
                "{}: for each class the range of each selected eigenvalue over its training models; the darker, the \
                 greater its weight Σ α.",
                best.name
            ),
            drawn::bands(&head.classes, &best.marks, "λ/max"),
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

impl Variant {
    /// How its curve looks. Colour and mark by operator and normalisation, dashes by the mesh: pairs that belong
    /// together look alike.
    #[must_use]
    pub const fn style(self) -> Style {
        let (hue, mark) = match (self.operator, self.normalised) {
            (Operator::Fem, false) => (0, None),
            (Operator::Fem, true) => (1, Some(Mark::Circle)),
            (Operator::Cot, false) => (2, Some(Mark::Triangle)),
            (Operator::Cot, true) => (3, Some(Mark::Cross)),
        };
        Style { hue, dash: if self.remeshed { Dash::Dashed } else { Dash::Solid }, mark }
    }
}

fn curves(rows: &[Rows], label: &str, curve: fn(&Rows) -> &Curve) -> Figure {
    let curved = |rows: &Rows| drawn::curve(rows.name.clone(), rows.spectrum.style(), &curve(rows).train);
    let panel = drawn::against_k("", label, true, rows.iter().map(curved).collect());
    Figure { title: String::new(), panels: vec![panel], across: 1 }
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

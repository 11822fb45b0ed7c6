//! Figures 3 to 6.

use super::{Head, Rows, Section, Variant};
use crate::{
    figure::{Dash, Figure, Mark, Style},
    laplacian::Operator,
    report::{figures as drawn, markdown},
    spectrum::Normalisation,
    study::{Curve, Mark as Selected},
};

/// The paper's classes in Figure 4, by words that data sets have for them.
const SHOWN: [&[&str]; 3] = [&["human"], &["humanoid", "armadillo"], &["bird"]];

pub(super) fn sections(head: &Head, rows: &[Rows]) -> Vec<Section> {
    let mut sections = vec![section(
        "figure-3",
        "Figure 3: Classification error on the first k eigenvalues",
        format!("ε on D (leave-one-out) against k. {LEGEND} {}", ends(rows, true, "ε", |rows| &rows.first_k.error)),
        curves(rows, "classification error ε", |rows| &rows.first_k.error),
    )];
    // The paper shows its selections on one spectrum: the one that it finds best.
    if let Some(best) = rows.iter().find(|rows| rows.spectrum == Variant::BEST) {
        let (shown, kmax) = (shown(head, best), best.first_k.error.train.len());
        sections.push(section(
            "figure-4",
            "Figure 4: Eigenvalues that AdaBoost selected",
            format!(
                "{}: each eigenvalue that a class's strong classifier uses, against its index; both axes logarithmic. The \
                 mark is the mean over the class's training models, the bar their range: a model is taken for one of the \
                 class where it lies within. {}",
                best.name,
                indices(head, best, &shown)
            ),
            drawn::selections(&head.classes, &shown, &best.marks, kmax, Normalisation::Max),
        ));
        sections.push(section(
            "figure-5",
            "Figure 5: Selection of the relevant eigenvalues",
            format!(
                "{}: for each class the range of each selected eigenvalue over its training models, on a logarithmic \
                 axis; the darker, the greater its weight Σ α among those of the class. {}",
                best.name,
                share(best)
            ),
            drawn::bands(&head.classes, &best.marks, Normalisation::Max),
        ));
    }
    sections.push(section(
        "figure-6",
        "Figure 6: Mean ADR on the first k eigenvalues",
        format!(
            "Mean ADR on D, each model against all the others, against k. {LEGEND} {}",
            ends(rows, false, "mean ADR", |rows| &rows.first_k.adr)
        ),
        curves(rows, "mean ADR", |rows| &rows.first_k.adr),
    ));
    sections
}

/// How to read the curves of Figures 3 and 6.
const LEGEND: &str = "Solid lines are of the original models, dashed ones of the re-meshed; colour and mark tell operator \
                      and normalisation. Marks lie anywhere along a curve, for it to be known by; k is logarithmic.";

/// Where curves have their best and how they end, in words.
fn ends(rows: &[Rows], least: bool, label: &str, curve: fn(&Rows) -> &Curve) -> String {
    let best = |rows: &Rows| if least { rows.first_k.best_error } else { rows.first_k.best_adr };
    let known = |rows: &'_ Rows| {
        let (k, values) = (best(rows), &curve(rows).train);
        Some((*values.get(k.checked_sub(1)?)?, k, *values.last()?))
    };
    let mut found: Vec<_> =
        rows.iter().filter_map(|rows| known(rows).map(|found| (rows.name.as_str(), found))).collect();
    found.sort_by(|(_, a), (_, b)| if least { a.0.total_cmp(&b.0) } else { b.0.total_cmp(&a.0) });
    let (Some((first, (best, at, _))), Some((last, (worst, of, _)))) = (found.first(), found.last()) else {
        return String::new();
    };
    let from = found.iter().map(|(_, (_, k, _))| *k).min().unwrap_or(0);
    let to = found.iter().map(|(_, (_, k, _))| *k).max().unwrap_or(0);
    let lowest = found.iter().map(|(_, (_, _, end))| *end).fold(f64::INFINITY, f64::min);
    let highest = found.iter().map(|(_, (_, _, end))| *end).fold(0.0, f64::max);
    let word = if least { "least" } else { "greatest" };
    format!(
        "Each curve has its best at some k from {from} to {to}: the {word} {label} is {best:.3} ({first}, k = {at}), the \
         best of the worst {worst:.3} ({last}, k = {of}). With all eigenvalues they are at {lowest:.3} to {highest:.3}."
    )
}

/// Which indices the classes of Figure 4 select, in words.
fn indices(head: &Head, best: &Rows, shown: &[usize]) -> String {
    let of = |class: usize| best.marks.get(class).map_or(&[][..], Vec::as_slice);
    let named = |&class: &usize| {
        let (count, last) = (of(class).len(), of(class).iter().map(|mark| mark.index).max()?);
        Some(format!("{} has {count}, the last of index {last}", markdown::escape(head.classes.get(class)?)))
    };
    let named: Vec<String> = shown.iter().filter_map(named).collect();
    let others = |class: usize| shown.iter().filter(move |&&other| other != class).flat_map(|&other| of(other));
    let shared =
        |class: usize| of(class).iter().filter(move |mark| others(class).any(|other| other.index == mark.index));
    let common: usize = shown.iter().map(|&class| shared(class).count()).sum();
    let all: usize = shown.iter().map(|&class| of(class).len()).sum();
    format!("{}; of all {all}, {common} have an index that another of these classes has, too.", named.join("; "))
}

/// How much of the spectrum the bands of a class cover, in words.
fn share(best: &Rows) -> String {
    let covered = |marks: &Vec<Selected>| {
        let mut bands: Vec<(f64, f64)> = marks.iter().map(|mark| (mark.low, mark.high)).collect();
        bands.sort_by(|a, b| a.0.total_cmp(&b.0));
        let add = |(sum, reach): (f64, f64), (low, high): (f64, f64)| {
            (sum + (high - low.max(reach)).max(0.0), reach.max(high))
        };
        100.0 * bands.into_iter().fold((0.0, 0.0), add).0
    };
    let mut shares: Vec<f64> = best.marks.iter().filter(|marks| !marks.is_empty()).map(covered).collect();
    shares.sort_by(f64::total_cmp);
    let (Some(least), Some(most)) = (shares.first(), shares.last()) else { return String::new() };
    let median = shares[shares.len() / 2];
    format!(
        "The bands of a class cover {least:.1} to {most:.1} % of the spectrum from 0 to 1, {median:.1} % in the median: a \
         small part of it is enough to tell a class of D apart."
    )
}

pub(super) fn section(stem: &str, heading: &str, words: String, figure: Figure) -> Section {
    Section { heading: heading.to_owned(), words: vec![words], table: None, figure: Some((stem.to_owned(), figure)) }
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

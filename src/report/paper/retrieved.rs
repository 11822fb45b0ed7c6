//! Table 5 and Figure 7: retrieval, with and without classification before it.

use super::{
    Section, Variant, figures,
    tables::{maybe, number},
};
use crate::{
    report::figures as drawn,
    study::{Cell, Reading, Retrieved, Scheme, Table},
};

pub(super) fn sections(retrieved: &[Retrieved]) -> Vec<Section> {
    if retrieved.is_empty() {
        return Vec::new();
    }
    vec![table_5(retrieved), figure_7(retrieved)]
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

fn figure_7(retrieved: &[Retrieved]) -> Section {
    figures::section(
        "figure-7",
        "Figure 7: Precision and recall",
        format!(
            "{}, queries against D: classification / retrieval / classes kept. A relevant model that is not retrieved \
             counts with a precision of 0.{}",
            Variant::BEST.name(),
            ends(retrieved).unwrap_or_default()
        ),
        drawn::precision(retrieved),
    )
}

/// Which schemes are the most precise at either end, in words.
fn ends(retrieved: &[Retrieved]) -> Option<String> {
    let known = |wanted: Scheme| {
        let found = retrieved.iter().find(|found| found.scheme == wanted)?;
        let points = drawn::recall(found);
        Some((drawn::scheme(wanted), points.first()?[1], points.last()?[1]))
    };
    let found: Vec<(String, f64, f64)> = Scheme::figure_7().into_iter().filter_map(known).collect();
    let first = found.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let last = found.iter().max_by(|a, b| a.2.total_cmp(&b.2))?;
    Some(format!(
        " The first model found is relevant most often with {} ({:.3}); when all relevant ones are wanted, {} is the most \
         precise ({:.3}).",
        first.0, first.1, last.0, last.2
    ))
}

//! The report as Markdown (GitHub's dialect: pipe tables). Sections as in [`super::text`].

use std::fmt::Write as _;

use super::{
    ClimbPart, Document, ModelStatus,
    layout::{cell, count, duration, is_figure, maybe, number, plain},
    text::{both, chosen, drawn, lines, read_at},
};
use crate::{query::Parameter, study::Table};

/// The report as Markdown.
#[must_use]
pub fn render(document: &Document) -> String {
    let mut text = String::new();
    head(document, &mut text);
    text.push_str("\n## Parameters\n\n");
    let pairs = document.parameters.pairs().map(|(parameter, value)| {
        let class = document.class();
        let value = match parameter {
            Parameter::Class if !class.is_empty() => format!("{value} ({})", escape(class)),
            _ => escape(&value),
        };
        vec![format!("`{}`", parameter.name()), value, escape(parameter.about())]
    });
    text.push_str(&table(&["parameter", "value", "meaning"], &[false; 3], pairs));
    for one in &document.tables {
        let _ = writeln!(text, "\n## Table {}: {}\n", one.number, escape(&one.title));
        text.push_str(&rows(one));
    }
    if document.tables.is_empty() {
        text.push_str("\nNo tables: there are no models to compare.\n");
    }
    curves(document, &mut text);
    climbs(document, &mut text);
    adaboost(document, &mut text);
    models(document, &mut text);
    run(document, &mut text);
    text
}

/// The rows of a table under its heads.
pub(super) fn rows(one: &Table) -> String {
    let heads: Vec<String> = one.columns.iter().map(|head| escape(head)).collect();
    let figures = |column| one.rows.iter().all(|row| row.get(column).is_none_or(is_figure));
    let right: Vec<bool> = (0..heads.len()).map(figures).collect();
    table(&heads, &right, one.rows.iter().map(|row| row.iter().map(|c| escape(&cell(c))).collect()))
}

/// Text that Markdown and HTML show as it is, on one line.
pub(super) fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in plain(text).chars() {
        if matches!(c, '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '~' | '&') {
            escaped.push('\\');
        }
        escaped.push(c);
    }
    escaped
}

/// A pipe table of cells that are escaped already.
pub(super) fn table<H: AsRef<str>>(heads: &[H], right: &[bool], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = String::from("|");
    for head in heads {
        let _ = write!(text, " {} |", head.as_ref());
    }
    text.push_str("\n|");
    text.extend(right.iter().map(|&right| if right { " ---: |" } else { " --- |" }));
    text.push('\n');
    for row in rows {
        text.push('|');
        for cell in row {
            let _ = write!(text, " {cell} |");
        }
        text.push('\n');
    }
    text
}

fn head(document: &Document, text: &mut String) {
    let data = &document.data;
    let _ = writeln!(text, "# Eigenselect report: {}\n", escape(&data.root));
    let _ = writeln!(text, "- Layout: {}", escape(&data.layout));
    let _ = writeln!(
        text,
        "- {} models in {} classes: {} train (D), {} query (Q), {} skipped",
        data.models, data.classes, data.train, data.query, data.skipped
    );
    let classes =
        document.classes.iter().map(|class| format!("{} {}+{}", escape(&class.name), class.train, class.query));
    let _ = writeln!(text, "- Classes (D+Q): {}", classes.collect::<Vec<_>>().join(", "));
    let _ = writeln!(text, "- {} {}", document.program.name, document.program.version);
    let waiting = document.models.iter().filter(|model| model.state == ModelStatus::Waiting).count();
    if waiting > 0 {
        let _ = writeln!(text, "- Unfinished: {} not computed yet", count(waiting, "model", "models"));
    }
    for warning in &document.warnings {
        let _ = writeln!(text, "- Note: {}", escape(warning));
    }
}

fn curves(document: &Document, text: &mut String) {
    let Some(curves) = &document.curves else { return };
    text.push_str("\n## Curves of the first k eigenvalues\n\n");
    let ks = read_at(curves.error.train.len(), document.parameters.0.k);
    let mut heads = vec!["k".to_owned()];
    heads.extend(ks.iter().map(ToString::to_string));
    heads.push("at k0".to_owned());
    let mut right = vec![true; heads.len()];
    right[0] = false;
    let rows = lines(document).into_iter().map(|(name, values, best)| {
        let mut row = vec![name.to_owned()];
        row.extend(ks.iter().map(|&k| maybe(values.get(k - 1).copied(), 3)));
        row.push(best);
        row
    });
    text.push_str(&table(&heads, &right, rows));
    text.push_str("\nk0 is chosen on D: the smallest k with the least ε, or with the greatest mean ADR.\n\n```text\n");
    text.push_str(&drawn("ε on D", &curves.error));
    text.push_str(&drawn("ADR on D", &curves.adr));
    text.push_str("```\n");
}

fn climbs(document: &Document, text: &mut String) {
    let climbs = &document.selections.hill_climbing;
    if climbs.error.is_none() && climbs.adr.is_none() {
        return;
    }
    text.push_str("\n## Hill climbing with backward steps (HCBw)\n");
    for (cost, climbed) in [("ε", &climbs.error), ("1 − mean ADR", &climbs.adr)] {
        if let Some(climbed) = climbed {
            climb(cost, climbed, text);
        }
    }
}

fn climb(cost: &str, climbed: &ClimbPart, text: &mut String) {
    let selected: Vec<String> = climbed.selected.iter().map(ToString::to_string).collect();
    let _ = writeln!(
        text,
        "\nFor {cost}: {} ({}); ε {}; mean ADR {}.\n",
        count(selected.len(), "eigenvalue", "eigenvalues"),
        selected.join(", "),
        both(climbed.error),
        both(climbed.adr)
    );
    let rows = climbed.steps.iter().enumerate().map(|(at, step)| {
        let word = if step.added { "add" } else { "remove" };
        vec![(at + 1).to_string(), word.to_owned(), step.index.to_string(), number(step.cost, 4)]
    });
    text.push_str(&table(&["step", "move", "eigenvalue", "cost after"], &[true, false, true, true], rows));
}

fn adaboost(document: &Document, text: &mut String) {
    let Some(boost) = &document.selections.adaboost else { return };
    let _ = writeln!(text, "\n## AdaBoost, T = {}\n", document.parameters.0.rounds);
    let _ = writeln!(
        text,
        "ε {}; eigenvalues a class, mean: {} chosen, {} with ties.\n",
        both(boost.error),
        number(boost.mean_chosen, 2),
        number(boost.mean_ties, 2)
    );
    let rows = boost.classes.iter().map(|class| {
        let marks = chosen(&class.rounds).into_iter().map(|(index, alpha)| format!("{index} ({})", number(alpha, 2)));
        vec![escape(&class.class), class.rounds.len().to_string(), marks.collect::<Vec<_>>().join(", ")]
    });
    text.push_str(&table(&["class", "rounds", "chosen eigenvalues (sum of α)"], &[false, true, false], rows));
}

fn models(document: &Document, text: &mut String) {
    let rows: Vec<Vec<String>> = document
        .models
        .iter()
        .filter(|model| model.state != ModelStatus::Skipped && !model.defects.is_empty())
        .map(|model| {
            let size = |size: Option<usize>| size.map_or_else(String::new, |size| size.to_string());
            let defects = model.defects.iter().map(|defect| escape(defect)).collect::<Vec<_>>().join("<br>");
            vec![escape(&model.file), size(model.vertices), size(model.triangles), defects]
        })
        .collect();
    if !rows.is_empty() {
        let _ = writeln!(text, "\n## Models with defects that take part ({})\n", rows.len());
        text.push_str(&table(&["file", "vertices", "triangles", "defects"], &[false, true, true, false], rows));
    }
    let kmax = document.parameters.0.kmax;
    let fewer = document.models.iter().filter_map(|model| Some((model, model.eigenvalues.filter(|&n| n < kmax)?)));
    let rows: Vec<Vec<String>> = fewer.map(|(model, n)| vec![escape(&model.file), n.to_string()]).collect();
    if !rows.is_empty() {
        let _ = writeln!(text, "\n## Models with fewer than kmax eigenvalues ({})\n", rows.len());
        text.push_str(&table(&["file", "eigenvalues"], &[false, true], rows));
    }
    if !document.skipped.is_empty() {
        let _ = writeln!(text, "\n## Skipped models ({})\n", document.skipped.len());
        let rows = document.skipped.iter().map(|model| vec![escape(&model.file), escape(&model.reason)]);
        text.push_str(&table(&["file", "reason"], &[false; 2], rows));
    }
}

fn run(document: &Document, text: &mut String) {
    let run = &document.run;
    let spectra = run.spectra;
    let _ = writeln!(
        text,
        "\n## This run\n\n- Spectra: {} computed, {} from memory, {} from disk",
        spectra.computed, spectra.memory, spectra.disk
    );
    if let Some(cache) = &run.cache {
        let _ = writeln!(text, "- Cache: {}", escape(cache));
    }
    let _ = writeln!(text, "- Time: {}", duration(run.seconds));
    for warning in &run.warnings {
        let _ = writeln!(text, "- Warning: {}", escape(warning));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::example;

    #[test]
    fn everything_is_shown() {
        insta::assert_snapshot!(render(&example::document()));
    }

    #[test]
    fn names_cannot_break_out_of_their_cell() {
        assert_eq!(escape("a|b\n<b>*x*_y_</b>"), "a\\|b\u{fffd}\\<b\\>\\*x\\*\\_y\\_\\</b\\>");
    }
}

//! The report as aligned plain text.
//!
//! Sections in order: the data set, the parameters, Tables 1 to 4, the curves, hill climbing, AdaBoost, models with
//! defects, skipped models, the run. Names from files cannot steer the terminal: control characters are replaced.

use std::fmt::Write as _;

use super::{
    Boost, ClimbPart, Climbs, Curves, Document, ModelRecord, ModelStatus, Read,
    layout::{NONE, cell, columns, count, duration, is_figure, maybe, number, plain, wrap},
    plot,
};
use crate::{
    query::Parameter,
    study::{Curve, Score, Table},
};

/// The k at which curves are read off, besides kmax and the parameter k.
const READ_AT: [usize; 12] = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000];
/// Lines of one model's defects that are shown; JSON has them all.
const DEFECTS_SHOWN: usize = 4;
/// Characters a drawn curve is wide and high.
const PLOT: (usize, usize) = (72, 4);

/// The report as text.
#[must_use]
pub fn render(document: &Document) -> String {
    let mut text = String::new();
    head(document, &mut text);
    parameters(document, &mut text);
    for table in &document.tables {
        let _ = writeln!(text, "\nTable {}  {}", table.number, plain(&table.title));
        text.push_str(&aligned(table));
    }
    if document.tables.is_empty() {
        text.push_str("\nNo tables: there are no models to compare.\n");
    }
    if let Some(curves) = &document.curves {
        text.push_str(&self::curves(document, curves));
    }
    climbs(&document.selections.hill_climbing, &mut text);
    if let Some(boost) = &document.selections.adaboost {
        adaboost(document, boost, &mut text);
    }
    models(document, &mut text);
    run(document, &mut text);
    text
}

fn head(document: &Document, text: &mut String) {
    let data = &document.data;
    let _ = writeln!(text, "Eigenselect {}: which eigenvalues tell the classes apart?\n", document.program.version);
    let _ = writeln!(text, "Data set    {}", plain(&data.root));
    let _ = writeln!(text, "Layout      {}", plain(&data.layout));
    let _ = writeln!(
        text,
        "Models      {}: {} train (D), {} query (Q), {} skipped",
        data.models, data.train, data.query, data.skipped
    );
    let classes =
        document.classes.iter().map(|class| format!("{} {}+{}", plain(&class.name), class.train, class.query));
    text.push_str(&wrap(&format!("Classes     {} (D+Q): ", data.classes), classes, ", "));
    let waiting = document.models.iter().filter(|model| model.state == ModelStatus::Waiting).count();
    if waiting > 0 {
        let _ = writeln!(text, "Unfinished  {} not computed yet", count(waiting, "model", "models"));
    }
    for warning in &document.warnings {
        let _ = writeln!(text, "Note        {}", plain(warning));
    }
}

fn parameters(document: &Document, text: &mut String) {
    text.push_str("\nParameters\n");
    for (parameter, value) in document.parameters.pairs() {
        let class = document.class();
        let value = match parameter {
            Parameter::Class if !class.is_empty() => format!("{value} ({})", plain(class)),
            _ => value,
        };
        let _ = writeln!(text, "  {:<14} {value:<12} {}", parameter.name(), parameter.about());
    }
}

/// A table of the paper.
fn aligned(table: &Table) -> String {
    let heads: Vec<String> = table.columns.iter().map(|head| plain(head).into_owned()).collect();
    let rows: Vec<Vec<String>> = table.rows.iter().map(|row| row.iter().map(cell).collect()).collect();
    let figures = |column| table.rows.iter().all(|row| row.get(column).is_none_or(is_figure));
    let right: Vec<bool> = (0..heads.len()).map(figures).collect();
    columns(&heads, &rows, &right, "  ")
}

/// The k to read curves off: round ones, the parameter k and the last, ascending.
pub(super) fn read_at(kmax: usize, k: usize) -> Vec<usize> {
    let mut ks: Vec<usize> = READ_AT.into_iter().chain([k, kmax]).filter(|&k| k >= 1 && k <= kmax).collect();
    ks.sort_unstable();
    ks.dedup();
    ks
}

/// Name, values and the best k of each curve that has values.
pub(super) fn lines(document: &Document) -> Vec<(&'static str, &[f64], String)> {
    let Some(Curves { error, adr }) = &document.curves else { return Vec::new() };
    let first = document.selections.first_k;
    let best = |read: Option<Read>, value: fn(&Read) -> Score| {
        let on_train = read.map_or_else(String::new, |at| format!("{} at {}", number(value(&at).train, 3), at.k));
        let on_query = read.and_then(|at| Some(format!("{} at {}", number(value(&at).query?, 3), at.k)));
        (on_train, on_query.unwrap_or_default())
    };
    let (error_train, error_query) = best(first.and_then(|first| first.best_error), |at| at.error);
    let (adr_train, adr_query) = best(first.and_then(|first| first.best_adr), |at| at.adr);
    let mut lines = vec![("ε on D", &error.train[..], error_train)];
    if !error.query.is_empty() {
        lines.push(("ε on Q", &error.query[..], error_query));
    }
    lines.push(("ADR on D", &adr.train[..], adr_train));
    if !adr.query.is_empty() {
        lines.push(("ADR on Q", &adr.query[..], adr_query));
    }
    lines
}

fn curves(document: &Document, curves: &Curves) -> String {
    let settings = &document.parameters.0;
    let kmax = curves.error.train.len();
    let mut text =
        String::from("\nCurves of the first k eigenvalues (k0 is chosen on D: the least ε, the greatest mean ADR)\n");
    let ks = read_at(kmax, settings.k);
    let mut heads = vec!["k".to_owned()];
    heads.extend(ks.iter().map(ToString::to_string));
    heads.push("at k0".to_owned());
    let rows: Vec<Vec<String>> = lines(document)
        .into_iter()
        .map(|(name, values, best)| {
            let mut row = vec![name.to_owned()];
            row.extend(ks.iter().map(|&k| maybe(values.get(k - 1).copied(), 3)));
            row.push(best);
            row
        })
        .collect();
    let mut right = vec![true; heads.len()];
    right[0] = false;
    text.push_str(&columns(&heads, &rows, &right, "  "));
    text.push('\n');
    text.push_str(&drawn("ε on D", &curves.error));
    text.push_str(&drawn("ADR on D", &curves.adr));
    text
}

/// A curve on D as Braille with its least and greatest value.
pub(super) fn drawn(name: &str, curve: &Curve) -> String {
    let drawn = plot::braille(&curve.train, PLOT.0, PLOT.1);
    let fold = |f: fn(f64, f64) -> f64, start| curve.train.iter().copied().filter(|v| v.is_finite()).fold(start, f);
    let (low, high) = (fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY));
    let last = drawn.len().saturating_sub(1);
    let mut text = String::new();
    for (at, line) in drawn.iter().enumerate() {
        let name = if at == 0 { name } else { "" };
        let scale = match at {
            0 => number(high, 3),
            _ if at == last => number(low, 3),
            _ => String::new(),
        };
        let _ = writeln!(text, "  {name:<9} {scale:>6} ┤{line}");
    }
    if !drawn.is_empty() {
        let end = curve.train.len().to_string();
        let gap = PLOT.0.saturating_sub(1);
        let _ = writeln!(text, "  {:<9} {:>6}  1{end:>gap$}", "", "k");
    }
    text
}

fn climbs(climbs: &Climbs, text: &mut String) {
    if climbs.error.is_none() && climbs.adr.is_none() {
        return;
    }
    text.push_str("\nHill climbing with backward steps (HCBw)\n");
    for (cost, climbed) in [("ε", &climbs.error), ("1 − mean ADR", &climbs.adr)] {
        if let Some(climbed) = climbed {
            text.push_str(&climb(cost, climbed));
        }
    }
}

/// A score as `0.263 on D, 0.347 on Q`.
pub(super) fn both(score: Score) -> String {
    match score.query {
        Some(query) => format!("{} on D, {} on Q", number(score.train, 3), number(query, 3)),
        None => format!("{} on D", number(score.train, 3)),
    }
}

fn climb(cost: &str, climbed: &ClimbPart) -> String {
    let selected = &climbed.selected;
    let mut text = format!(
        "  for {cost}: {}; ε {}; mean ADR {}\n",
        count(selected.len(), "eigenvalue", "eigenvalues"),
        both(climbed.error),
        both(climbed.adr)
    );
    text.push_str(&wrap("    selected  ", selected.iter().map(ToString::to_string), ", "));
    let path = climbed.steps.iter().map(|step| {
        let sign = if step.added { '+' } else { '−' };
        format!("{sign}{} {}", step.index, number(step.cost, 4))
    });
    text.push_str(&wrap("    path      ", path, " · "));
    text
}

fn adaboost(document: &Document, boost: &Boost, text: &mut String) {
    let rounds = document.parameters.0.rounds;
    let _ = writeln!(text, "\nAdaBoost, a strong classifier for each class, T = {rounds}");
    let _ = writeln!(
        text,
        "  ε {}; eigenvalues a class, mean: {} chosen, {} with ties",
        both(boost.error),
        number(boost.mean_chosen, 2),
        number(boost.mean_ties, 2)
    );
    text.push_str("  chosen eigenvalues, each with the sum of its α:\n");
    let widest = boost.classes.iter().map(|class| plain(&class.class).chars().count()).max().unwrap_or(0);
    for class in &boost.classes {
        let name = plain(&class.class);
        let first = format!("    {name:<widest$}  T={:<3}  ", class.rounds.len());
        if class.rounds.is_empty() {
            let _ = writeln!(text, "{first}none: no weak classifier is better than chance");
            continue;
        }
        let marks = chosen(&class.rounds).into_iter().map(|(index, alpha)| format!("{index} ({})", number(alpha, 2)));
        text.push_str(&wrap(&first, marks, ", "));
    }
}

/// The distinct eigenvalues of the rounds, ascending, with the sum of their weights.
pub(super) fn chosen(rounds: &[crate::selection::Round]) -> Vec<(u32, f64)> {
    let mut sums = std::collections::BTreeMap::new();
    for round in rounds {
        *sums.entry(round.index).or_insert(0.0) += round.alpha;
    }
    sums.into_iter().collect()
}

fn models(document: &Document, text: &mut String) {
    let with_defects: Vec<&ModelRecord> =
        document.models.iter().filter(|m| m.state != ModelStatus::Skipped && !m.defects.is_empty()).collect();
    if !with_defects.is_empty() {
        let _ = writeln!(text, "\nModels with defects that take part ({})", with_defects.len());
        for model in with_defects {
            let size = match (model.vertices, model.triangles) {
                (Some(vertices), Some(triangles)) => format!("  ({vertices} vertices, {triangles} triangles)"),
                _ => String::new(),
            };
            let _ = writeln!(text, "  {}{size}", plain(&model.file));
            defects(model, text);
        }
    }
    let fewer: Vec<&ModelRecord> = document
        .models
        .iter()
        .filter(|model| model.eigenvalues.is_some_and(|count| count < document.parameters.0.kmax))
        .collect();
    if !fewer.is_empty() {
        let _ = writeln!(text, "\nModels with fewer than kmax eigenvalues ({})", fewer.len());
        for model in fewer {
            let _ = writeln!(text, "  {}  {}", plain(&model.file), maybe_count(model.eigenvalues));
        }
    }
    if !document.skipped.is_empty() {
        let _ = writeln!(text, "\nSkipped models ({})", document.skipped.len());
        for model in &document.skipped {
            let words: Vec<_> = plain(&model.reason).split_whitespace().map(str::to_owned).collect();
            text.push_str(&wrap(&format!("  {}: ", plain(&model.file)), words, " "));
        }
    }
}

fn maybe_count(count: Option<usize>) -> String {
    count.map_or_else(|| NONE.to_owned(), |count| count.to_string())
}

fn defects(model: &ModelRecord, text: &mut String) {
    for defect in model.defects.iter().take(DEFECTS_SHOWN) {
        let words: Vec<_> = plain(defect).split_whitespace().map(str::to_owned).collect();
        text.push_str(&wrap("    - ", words, " "));
    }
    if let Some(more) = model.defects.len().checked_sub(DEFECTS_SHOWN).filter(|&more| more > 0) {
        let _ = writeln!(text, "    … and {more} more (the JSON report has them all)");
    }
}

fn run(document: &Document, text: &mut String) {
    let run = &document.run;
    let spectra = run.spectra;
    text.push_str("\nThis run\n");
    let _ = writeln!(
        text,
        "  spectra  {} computed, {} from memory, {} from disk",
        spectra.computed, spectra.memory, spectra.disk
    );
    if let Some(cache) = &run.cache {
        let _ = writeln!(text, "  cache    {}", plain(cache));
    }
    let threads =
        if run.threads == 0 { String::new() } else { format!(", {}", count(run.threads, "thread", "threads")) };
    let _ = writeln!(text, "  time     {}{threads}", duration(run.seconds));
    for warning in &run.warnings {
        let _ = writeln!(text, "  warning  {}", plain(warning));
    }
}

#[cfg(test)]
mod tests {
    use unicode_width::UnicodeWidthStr;

    use super::*;
    use crate::{
        query::Answer,
        report::{Origin, example, layout::WIDTH},
    };

    #[test]
    fn everything_is_shown() {
        insta::assert_snapshot!(render(&example::document()));
    }

    #[test]
    fn lines_fit_and_names_cannot_steer_the_terminal() {
        let text = render(&example::document());
        assert!(text.lines().all(|line| line.width() <= WIDTH), "{text}");
        assert!(!text.contains('\u{1b}'));
    }

    #[test]
    fn a_report_of_nothing_says_so() {
        let text = render(&Document::new(&Answer::default(), &Origin { root: "void", ..Origin::default() }));
        assert!(text.contains("No tables"), "{text}");
    }

    #[test]
    fn curves_are_read_at_round_k_and_at_the_parameter() {
        assert_eq!(read_at(60, 13), [1, 2, 5, 10, 13, 20, 50, 60]);
        assert_eq!(read_at(3, 100), [1, 2, 3]);
        assert!(read_at(0, 1).is_empty());
    }
}

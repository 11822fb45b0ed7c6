//! Where the figures differ from the published ones, and what may be why.

use super::{
    Head, Published, Rows, Section, Variant,
    published::Row,
    tables::{Plan, maybe, number, paper, plans},
};
use crate::{
    laplacian::Operator,
    selection::Search,
    study::{Cell, SPLITS, Searched, Spread, Table},
};

/// Differences from the paper beyond this are named in words.
const NOTABLE: f64 = 0.05;
/// Published figures are rounded to hundredths.
const ROUNDED: f64 = 0.005;

/// Differences with their reasons, and the other readings of Tables 2 to 4.
pub(super) fn sections(head: &Head, rows: &[Rows]) -> Vec<Section> {
    let plans = plans(head.parameters.0.rounds);
    let mut sections = vec![differences(&plans, head, rows)];
    sections.extend(readings(&plans, rows));
    sections
}

/// The name of the reading that takes the paper at its word.
const STRICT: &str = "strict";

/// A way to read the paper, and what it gives.
struct Reading {
    name: &'static str,
    value: f64,
}

/// The readings of a table's figure, the strict one first; none where there is one way to read the paper, or where
/// nothing was computed.
fn readings_of(plan: &Plan, rows: &Rows) -> Vec<Reading> {
    let Some(splits) = rows.splits.as_deref() else { return Vec::new() };
    let climbs = |value: fn(&Searched) -> f64| {
        let reading = move |searched: &Searched| {
            let name = match searched.search {
                Search::Strict => STRICT,
                Search::Level => "over level ground",
                Search::Beam => "with a beam",
            };
            Reading { name, value: value(searched) }
        };
        splits.searches.iter().map(reading).collect()
    };
    match plan.row {
        Row::FirstKError | Row::FirstKAdr => Vec::new(),
        Row::ClimbError => climbs(|searched| searched.error),
        Row::ClimbAdr => climbs(|searched| searched.adr),
        Row::Boosted => vec![
            Reading { name: STRICT, value: (plan.entry)(rows).score.train },
            Reading { name: "decided by S as a share of its Σ α", value: splits.decisions.share },
            Reading { name: "decided for the first class with S > 0", value: splits.decisions.first },
        ],
    }
}

/// Why a figure may differ, by what was computed to find out.
fn reason(plan: &Plan, rows: &Rows, known: Published, ours: f64) -> String {
    let mut reasons = Vec::new();
    if let Some(Spread { low, high, .. }) = rows.spread(plan.spread) {
        let within = (low - ROUNDED..=high + ROUNDED).contains(&known.value);
        let verdict = if within { "the split may be why" } else { "the split is not why" };
        reasons.push(format!("{verdict}: other ones give {low:.3} to {high:.3}"));
    }
    // What does not show in print is no closer.
    let closer = |reading: &Reading| (reading.value - known.value).abs() + ROUNDED < (ours - known.value).abs();
    let closest = readings_of(plan, rows).into_iter().filter(closer);
    let closest = closest.min_by(|a, b| (a.value - known.value).abs().total_cmp(&(b.value - known.value).abs()));
    if let Some(Reading { name, value }) = closest {
        reasons.push(format!("{name} it would be {value:.3}"));
    }
    if rows.spectrum.remeshed && rows.spectrum.operator == Operator::Cot {
        reasons.push("cot eigenvalues depend on the re-mesher (see above)".to_owned());
    }
    reasons.join("; ")
}

/// Where a figure on D is further from the paper's than [`NOTABLE`], and what may be why.
fn differences(plans: &[Plan], head: &Head, rows: &[Rows]) -> Section {
    let mut cells = Vec::new();
    for plan in plans {
        for rows in rows {
            let Some(known) = paper(plan, rows) else { continue };
            let ours = (plan.entry)(rows).score.train;
            if (ours - known.value).abs() > NOTABLE {
                cells.push(vec![
                    Cell::Text(format!("Table {}: {}", plan.number, plan.title)),
                    Cell::Text(rows.name.clone()),
                    number(ours, 3),
                    number(known.value, 2),
                    number(ours - known.value, 3),
                    Cell::Text(reason(plan, rows, known, ours)),
                ]);
            }
        }
    }
    let compared = plans.len() * rows.iter().filter(|rows| rows.spectrum.column().is_some()).count();
    let words = words(cells.len(), compared, head, rows);
    let columns = ["table", "spectrum", "here", "paper", "difference", "why"].map(String::from).to_vec();
    let title = "Figures that differ from the paper's".to_owned();
    let table =
        (!cells.is_empty()).then(|| ("differences".to_owned(), Table { number: 0, title, columns, rows: cells }));
    Section { heading: "Differences from the paper".to_owned(), words, table, figure: None }
}

fn words(count: usize, compared: usize, head: &Head, rows: &[Rows]) -> Vec<String> {
    let most = rows.iter().map(|rows| rows.train).max().unwrap_or(0);
    let classes = head.classes.len();
    let mut words = vec![
        format!("{count} of {compared} figures on D differ from the paper's by more than {NOTABLE}."),
        format!(
            "The paper's D has 300 models in 20 classes; this one has {most} in {classes}. Figures on Q are of models that \
             no selection has seen; the paper has none. What may be behind a difference was computed where it can be: \
             {SPLITS} other splits of the same models, and the other ways to read a passage, which the next table has. A \
             class of 15 models more, all of them wrong and none of the others touched, would add 0.05 to an ε at most. \
             The published k0 and numbers of eigenvalues are of those figures, and differ with them."
        ),
    ];
    let least = |operator, normalised| {
        let wanted = Variant { remeshed: true, operator, normalised };
        let rows = rows.iter().find(|rows| rows.spectrum == wanted)?;
        Some(rows.first_k.error.at(rows.first_k.best_error)?.train)
    };
    if let (Some(cot), Some(fem)) = (least(Operator::Cot, false), least(Operator::Fem, true)) {
        words.push(format!(
            "On triangles of one size and shape the mass matrix acts on smooth functions as the number area/n, so the low \
             cot eigenvalues of n vertices are those of FEM times area/n: free of scale, and about as good as normalised \
             FEM. Here the re-meshed models are nearly that even, and the first k eigenvalues reach {cot:.3} with cot and \
             {fem:.3} with normalised FEM. The paper has 0.32 and 0.22, which suggests that its re-meshed models were less \
             even and that cot kept some of what it has on the original ones (0.37)."
        ));
    }
    words
}

/// What Tables 2 to 4 would have by other readings.
fn readings(plans: &[Plan], rows: &[Rows]) -> Option<Section> {
    let mut cells = Vec::new();
    // For each reading of a table how many figures it has, and how many of them are near the paper's.
    let mut tally: Vec<(u32, &str, usize, usize)> = Vec::new();
    for plan in plans {
        for rows in rows {
            let (Some(known), all) = (paper(plan, rows), readings_of(plan, rows)) else { continue };
            let [strict, others @ ..] = &all[..] else { continue };
            let apart = |reading: &Reading| (reading.value - known.value).abs();
            let values = others.iter().map(|reading| number(reading.value, 3)).collect::<Vec<_>>();
            let mut row = vec![
                Cell::Text(format!("Table {}", plan.number)),
                Cell::Text(rows.name.clone()),
                number(known.value, 2),
                number(strict.value, 3),
            ];
            let (searches, decisions) = match plan.row {
                Row::Boosted => (vec![Cell::Missing; 2], values),
                _ => (values, vec![Cell::Missing; 2]),
            };
            row.extend(searches);
            row.extend(decisions);
            for reading in &all {
                let near = usize::from(apart(reading) <= NOTABLE);
                match tally.iter_mut().find(|(number, name, ..)| (*number, *name) == (plan.number, reading.name)) {
                    Some((.., all, few)) => (*all, *few) = (*all + 1, *few + near),
                    None => tally.push((plan.number, reading.name, 1, near)),
                }
            }
            // The strict one is first, and taken where others are no closer.
            let closest = all.iter().min_by(|a, b| apart(a).total_cmp(&apart(b)));
            row.push(Cell::Text(closest.map_or("", |closest| closest.name).to_owned()));
            row.push(maybe(closest.map(|closest| closest.value - known.value), 3));
            cells.push(row);
        }
    }
    let columns =
        ["table", "spectrum", "paper", "strict", "level", "beam", "share", "first", "closest", "its difference"];
    let title = "Other readings of Tables 2 to 4".to_owned();
    let words = vec![
        "Hill climbing ends where no one move lowers the cost. *Level* also takes moves that leave it as it is, *beam* keeps \
         several selections; the paper says neither. For AdaBoost the paper says how a class's probability is computed, \
         not how the ε of Table 3 is: *strict* goes by the greatest p(C|M), *share* by the greatest S as a share of its \
         Σ α, *first* takes the first class with S > 0."
            .to_owned(),
        format!("Figures within {NOTABLE} of the paper's: {}.", near(&tally)),
    ];
    let table = Table { number: 0, title: title.clone(), columns: columns.map(String::from).to_vec(), rows: cells };
    let some = !table.rows.is_empty();
    some.then(|| Section { heading: title, words, table: Some(("readings".to_owned(), table)), figure: None })
}

/// How many figures of each table each reading brings near the paper's, in words.
fn near(tally: &[(u32, &str, usize, usize)]) -> String {
    let words = tally.iter().map(|(table, name, all, few)| format!("Table {table} {name} {few} of {all}"));
    words.collect::<Vec<_>>().join("; ")
}

//! Which features, which weights, which distance, which k: chosen where it can be chosen honestly, inside the fold.

use super::{
    Examined, Section,
    tables::{maybe, number},
};
use crate::{
    figure::{Dash, Mark, Style},
    metrics::{Distance, Scale},
    report::figures as drawn,
    spectrum::Normalisation,
    study::{Cell, HonestRow, Interval, Table, Tuned, TunedRow, paired},
};

/// The numbers of first eigenvalues that the table has.
const SHOWN: [usize; 6] = [10, 20, 50, 70, 100, 200];

/// What the method is called beside the others.
const NAME: &str = "nearest neighbour, tuned inside the fold";
/// Its features: those that are tried.
const FEATURES: &str = "original FEM";

/// What was tuned, and the places of its models.
type Known<'a> = (&'a Tuned, &'a [usize]);

pub(super) fn sections(tuned: Known<'_>, honest: &[Examined]) -> Vec<Section> {
    vec![table(tuned.0), against(tuned, honest)]
}

fn normalisation(normalisation: Normalisation) -> &'static str {
    drawn::unit(normalisation)
}

const fn weights(scale: Scale) -> &'static str {
    match scale {
        Scale::None => "none",
        Scale::Standard => "standard",
        Scale::Within => "within",
        Scale::Fisher => "fisher",
    }
}

fn table(tuned: &Tuned) -> Section {
    let width = tuned.rows.iter().map(|row| row.curve.len()).max().unwrap_or(0);
    let shown: Vec<usize> = SHOWN.into_iter().filter(|k| *k < width).chain([width]).collect();
    let interval = |Interval { mean, low, high }: Interval| [mean, low, high].map(|value| number(value, 3));
    let folds = (tuned.plan.folds * tuned.plan.repeats) as u64;
    let row = |row: &TunedRow| {
        let recipe = row.recipe;
        let mut cells = vec![
            Cell::Text(normalisation(recipe.normalisation).to_owned()),
            Cell::Text(weights(recipe.scale).to_owned()),
            Cell::Text(recipe.distance.name().to_owned()),
            Cell::Count(row.taken as u64),
            Cell::Count(row.k as u64),
        ];
        cells.extend(interval(row.error));
        cells.extend(shown.iter().map(|k| maybe(row.curve.get(k - 1).copied(), 3)));
        cells
    };
    let mut rows: Vec<&TunedRow> = tuned.rows.iter().collect();
    rows.sort_by(|a, b| a.error.mean.total_cmp(&b.error.mean));
    let mut cells: Vec<Vec<Cell>> = rows.into_iter().map(row).collect();
    let mut first = vec![
        Cell::Text("chosen inside the fold".to_owned()),
        Cell::Missing,
        Cell::Missing,
        Cell::Count(folds),
        Cell::Count(tuned.k[1] as u64),
    ];
    first.extend(interval(tuned.error));
    first.extend(shown.iter().map(|_| Cell::Missing));
    cells.insert(0, first);
    let mut columns =
        ["features", "weights", "distance", "folds", "median k", "honest ε", "from", "to"].map(str::to_owned).to_vec();
    columns.extend(shown.iter().map(|k| if *k == width { "all".to_owned() } else { format!("first {k}") }));
    let title = "Nearest neighbours, tuned inside the fold".to_owned();
    Section {
        heading: title.clone(),
        words: words(tuned, width),
        table: Some(("tuned".to_owned(), Table { number: 0, title, columns, rows: cells })),
        figure: Some(("tuned".to_owned(), figure(tuned))),
    }
}

fn words(tuned: &Tuned, width: usize) -> Vec<String> {
    let Tuned { plan, error, adr, k: [least, median, most], .. } = tuned;
    let mut words = vec![format!(
        "Which features, which weights, which distance, and which k? In each of the {} folds times {} repeats, the {} \
         ways below and every k from 1 to {width} are compared by leave-one-out among the other folds, and the best is \
         asked for the fold: nothing is chosen by what scores it. That reaches ε = {:.3} ({:.3} to {:.3}) with a mean ADR \
         of {:.3} ({:.3} to {:.3}); k was {median} in the median ({least} to {most}). This is the honest answer to how \
         well these eigenvalues tell shapes apart by nearest neighbours.",
        plan.folds,
        plan.repeats,
        tuned.rows.len(),
        error.mean,
        error.low,
        error.high,
        adr.mean,
        adr.low,
        adr.high,
    )];
    words.push(
        "In the table, *folds* says in how many folds a way was taken; *honest ε* has k alone chosen inside the fold; the \
         columns after it have the first so many eigenvalues and choose nothing. Each number is honest by itself; the \
         least of them is not, for it was looked for."
            .to_owned(),
    );
    let least = tuned.rows.iter().flat_map(|row| (1..).zip(&row.curve).map(move |(k, error)| (row.recipe, k, *error)));
    if let Some((recipe, k, error)) = least.min_by(|a: &(_, usize, f64), b| a.2.total_cmp(&b.2)) {
        words.push(format!(
            "The figure has ε on models not seen against k, by Euclidean distance without weights. The least of all ways \
             and all k, {error:.3} ({}, weights {}, {}, first {k}), is beyond what can be promised.",
            normalisation(recipe.normalisation),
            weights(recipe.scale),
            recipe.distance.name(),
        ));
    }
    words
}

/// ε on models not seen against k.
fn figure(tuned: &Tuned) -> crate::figure::Figure {
    const LOOKS: [Style; 5] = [
        Style { hue: 0, dash: Dash::Solid, mark: None },
        Style { hue: 1, dash: Dash::Dashed, mark: Some(Mark::Square) },
        Style { hue: 2, dash: Dash::Solid, mark: Some(Mark::Circle) },
        Style { hue: 3, dash: Dash::DashDot, mark: None },
        Style { hue: 4, dash: Dash::Solid, mark: Some(Mark::Diamond) },
    ];
    let plain = tuned.rows.iter().filter(|row| (row.recipe.scale, row.recipe.distance) == (Scale::None, Distance::L2));
    let layers = plain
        .zip(LOOKS)
        .map(|(row, style)| drawn::curve(normalisation(row.recipe.normalisation).to_owned(), style, &row.curve));
    drawn::alone(drawn::against_k("", "ε on models not seen", true, layers.collect()))
}

/// A method on some features: its name, its models, and how often each was given a wrong class.
struct Contestant<'a> {
    features: &'a str,
    method: String,
    models: &'a [usize],
    wrong: &'a [u32],
}

impl Contestant<'_> {
    /// Whether both were asked for the same models: where a spectrum had to do without one, they were not.
    fn meets(&self, other: &Self) -> bool {
        self.models == other.models && self.wrong.len() == other.wrong.len()
    }
}

fn contestants<'a>(honest: &'a [Examined], tuned: Option<Known<'a>>) -> Vec<Contestant<'a>> {
    let of = |Examined { features, models, honest }: &'a Examined| {
        let row =
            move |row: &'a HonestRow| Contestant { features, method: row.method.name(), models, wrong: &row.wrong };
        honest.rows.iter().map(row)
    };
    honest.iter().flat_map(of).chain(tuned.map(contestant)).collect()
}

fn contestant((tuned, models): Known<'_>) -> Contestant<'_> {
    Contestant { features: FEATURES, method: NAME.to_owned(), models, wrong: &tuned.wrong }
}

/// The tuned method against every other.
fn against(known: Known<'_>, honest: &[Examined]) -> Section {
    let (tuned, mine) = (known.0, contestant(known));
    let row = |other: Contestant<'_>| {
        let (Interval { mean, low, high }, p) = paired(&tuned.wrong, other.wrong, tuned.plan);
        let mut cells = vec![Cell::Text(other.features.to_owned()), Cell::Text(other.method)];
        cells.extend([mean, low, high].map(|value| number(value, 3)));
        cells.push(number(p, 4));
        cells
    };
    let others = contestants(honest, None).into_iter().filter(|other| other.meets(&mine));
    let columns = ["features", "method", "difference", "from", "to", "permutation p"].map(String::from).to_vec();
    let heading = "Tuned nearest neighbours against every other method".to_owned();
    let words = vec![
        "The honest ε of nearest neighbours tuned inside the fold less that of the other method, on the same models in \
         the same folds: negative is in favour of tuning."
            .to_owned(),
    ];
    let table = Table { number: 0, title: heading.clone(), columns, rows: others.map(row).collect() };
    Section { heading, words, table: Some(("tuned-against".to_owned(), table)), figure: None }
}

/// Any two methods, across features too, for those who want another pair than the document has.
pub(super) fn pairs(honest: &[Examined], tuned: Option<Known<'_>>) -> Table {
    let all = contestants(honest, tuned);
    let plan = honest.first().map(|examined| examined.honest.plan).unwrap_or_default();
    let mcnemar = |first: &Contestant<'_>, second: &Contestant<'_>| {
        let on_both = |features: &str| features == first.features && features == second.features;
        let honest = &honest.iter().find(|examined| on_both(&examined.features))?.honest;
        let at = |method: &str| honest.rows.iter().position(|row| row.method.name() == method);
        let (first, second) = (at(&first.method)?, at(&second.method)?);
        honest.pairs.iter().find(|pair| (pair.first, pair.second) == (first, second))?.mcnemar
    };
    let mut rows = Vec::new();
    for (at, first) in all.iter().enumerate() {
        for second in all[at + 1..].iter().filter(|second| second.meets(first)) {
            let (Interval { mean, low, high }, p) = paired(first.wrong, second.wrong, plan);
            let mut cells: Vec<Cell> = [first, second]
                .into_iter()
                .flat_map(|of| [Cell::Text(of.features.to_owned()), Cell::Text(of.method.clone())])
                .collect();
            cells.extend([mean, low, high].map(|value| number(value, 3)));
            cells.extend([number(p, 4), maybe(mcnemar(first, second), 4)]);
            rows.push(cells);
        }
    }
    let columns = [
        "features",
        "method",
        "other features",
        "other method",
        "difference of honest ε",
        "from",
        "to",
        "permutation p",
        "McNemar p on Q",
    ];
    Table { number: 0, title: "Any two methods".to_owned(), columns: columns.map(String::from).to_vec(), rows }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::study::{Honest, Learner, Plan};

    #[test]
    fn methods_meet_on_the_same_models_alone() {
        let row = |method| HonestRow {
            method,
            apparent: 0.0,
            query: None,
            error: Interval::default(),
            adr: None,
            repeats: Vec::new(),
            wrong: vec![0, 1, 2],
            selected: 1.0,
        };
        let examined = |features: &str, models: [usize; 3]| Examined {
            features: features.to_owned(),
            models: Arc::new(models.to_vec()),
            honest: Arc::new(Honest {
                plan: Plan::default(),
                rows: vec![row(Learner::HILL), row(Learner::ALL)],
                pairs: vec![],
            }),
        };
        let honest = [examined("a", [0, 1, 2]), examined("b", [0, 1, 3]), examined("c", [0, 1, 2])];
        let names = |row: &[Cell]| match (&row[0], &row[2]) {
            (Cell::Text(first), Cell::Text(second)) => format!("{first}{second}"),
            other => panic!("{other:?}"),
        };
        let met: Vec<String> = pairs(&honest, None).rows.iter().map(|row| names(row)).collect();
        assert_eq!(met, ["aa", "ac", "ac", "ac", "ac", "bb", "cc"]);
    }
}

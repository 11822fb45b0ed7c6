//! Tables 1 to 4: a row per spectrum, each figure beside the published one.

use super::{Head, Published, Row, Rows, Section, published};
use crate::study::{Cell, SPLITS, Score, Splits, Spread, Table};

pub(super) fn number(value: f64, decimals: u8) -> Cell {
    Cell::Number { value, decimals }
}

pub(super) fn maybe(value: Option<f64>, decimals: u8) -> Cell {
    value.map_or(Cell::Missing, |value| number(value, decimals))
}

/// What one table shows of a spectrum.
pub(super) struct Entry {
    pub(super) score: Score,
    count: f64,
}

/// How one of the tables is made.
pub(super) struct Plan {
    stem: &'static str,
    pub(super) number: u32,
    pub(super) title: String,
    figure: &'static str,
    count: &'static str,
    /// Decimals of the count: the mean over the classes has two.
    decimals: u8,
    pub(super) row: Row,
    pub(super) entry: fn(&Rows) -> Entry,
    /// The figure on other splits.
    pub(super) spread: fn(&Splits) -> Spread,
}

fn first_k(k: usize, score: Option<Score>) -> Entry {
    Entry { score: score.unwrap_or(Score { train: f64::NAN, query: None }), count: k as f64 }
}

pub(super) fn plans(rounds: usize) -> [Plan; 5] {
    [
        Plan {
            stem: "table-1-first-k",
            number: 1,
            title: "Classification error ε with the first k eigenvalues".to_owned(),
            figure: "ε",
            count: "k0",
            decimals: 0,
            row: Row::FirstKError,
            entry: |rows| first_k(rows.first_k.best_error, rows.first_k.error.at(rows.first_k.best_error)),
            spread: |splits| splits.first_k_error,
        },
        Plan {
            stem: "table-2-hcbw",
            number: 2,
            title: "Classification error ε after hill climbing with backward steps (HCBw)".to_owned(),
            figure: "ε",
            count: "sel",
            decimals: 0,
            row: Row::ClimbError,
            entry: |rows| Entry { score: rows.climb_error.error, count: rows.climb_error.climb.selected.len() as f64 },
            spread: |splits| splits.climb_error,
        },
        Plan {
            stem: "table-3-adaboost",
            number: 3,
            title: format!("Classification error ε of AdaBoost, T = {rounds}"),
            figure: "ε",
            count: "mean sel",
            decimals: 2,
            row: Row::Boosted,
            entry: |rows| Entry { score: rows.boosted.error, count: rows.boosted.mean_chosen },
            spread: |splits| splits.boosted,
        },
        Plan {
            stem: "table-4-first-k",
            number: 4,
            title: "Mean ADR with the first k eigenvalues".to_owned(),
            figure: "mean ADR",
            count: "k0",
            decimals: 0,
            row: Row::FirstKAdr,
            entry: |rows| first_k(rows.first_k.best_adr, rows.first_k.adr.at(rows.first_k.best_adr)),
            spread: |splits| splits.first_k_adr,
        },
        Plan {
            stem: "table-4-hcbw",
            number: 4,
            title: "Mean ADR after hill climbing with backward steps (HCBw)".to_owned(),
            figure: "mean ADR",
            count: "sel",
            decimals: 0,
            row: Row::ClimbAdr,
            entry: |rows| Entry { score: rows.climb_adr.adr, count: rows.climb_adr.climb.selected.len() as f64 },
            spread: |splits| splits.climb_adr,
        },
    ]
}

/// Tables 1 to 4.
pub(super) fn sections(head: &Head, rows: &[Rows]) -> Vec<Section> {
    let plans = plans(head.parameters.0.rounds);
    let standing = standing(&plans, rows);
    plans.iter().map(|plan| section(plan, rows, head.parameters.0.rounds, standing.as_deref())).collect()
}

/// Whether D is easier or harder than random splits: how often its figure is beyond those of all of them.
fn standing(plans: &[Plan], rows: &[Rows]) -> Option<String> {
    let (mut all, mut easier, mut harder) = (0_u32, 0_u32, 0_u32);
    for plan in plans {
        for rows in rows {
            let Some(spread) = rows.spread(plan.spread) else { continue };
            let ours = (plan.entry)(rows).score.train;
            let (below, above) = (ours < spread.low, ours > spread.high);
            let (better, worse) = if plan.figure == "ε" { (below, above) } else { (above, below) };
            all += 1;
            easier += u32::from(better);
            harder += u32::from(worse);
        }
    }
    // Of SPLITS + 1 draws each is as likely to be the first of them.
    let chance = f64::from(all) / (SPLITS + 1) as f64;
    let (verdict, so) = match f64::from(easier) - f64::from(harder) {
        lead if lead > 2.0 * chance => {
            ("easier than", " Part of the way from the figures on D to those on Q may be that, and not the selection.")
        }
        lead if -lead > 2.0 * chance => ("harder than", ""),
        _ => ("about as hard as", ""),
    };
    (all > 0).then(|| {
        format!(
            "This D is {verdict} such splits: of the {all} figures on D in Tables 1 to 4 that were computed on splits too, \
             {easier} are better than on every split and {harder} worse than on any; a D drawn like them would have about \
             {chance:.0} of each.{so}"
        )
    })
}

pub(super) fn paper(plan: &Plan, rows: &Rows) -> Option<Published> {
    rows.spectrum.column().map(|column| published(plan.row, column))
}

fn section(plan: &Plan, rows: &[Rows], rounds: usize, standing: Option<&str>) -> Section {
    let row = |rows: &Rows| {
        let Entry { score, count } = (plan.entry)(rows);
        let known = paper(plan, rows);
        let mut cells = vec![
            Cell::Text(rows.name.clone()),
            number(score.train, 3),
            number(count, plan.decimals),
            maybe(known.map(|known| known.value), 2),
            maybe(known.map(|known| known.count), if plan.decimals == 0 { 0 } else { 2 }),
            maybe(known.map(|known| score.train - known.value), 3),
            maybe(score.query, 3),
        ];
        let spread = rows.spread(plan.spread);
        cells.extend([spread.map(|spread| spread.low), spread.map(|spread| spread.high)].map(|end| maybe(end, 3)));
        if plan.row == Row::Boosted {
            cells.push(number(rows.boosted.mean_ties, 2));
        }
        cells
    };
    let (figure, count) = (plan.figure, plan.count);
    let mut columns = vec![
        "spectrum".to_owned(),
        format!("{figure} on D"),
        count.to_owned(),
        format!("paper's {figure}"),
        format!("paper's {count}"),
        "difference".to_owned(),
        format!("{figure} on Q"),
        "splits from".to_owned(),
        "to".to_owned(),
    ];
    let mut words = Vec::new();
    if plan.row == Row::FirstKError {
        words.push(format!(
            "*Splits* are {SPLITS} random choices of as many models of each class for D, from D and Q together: which models \
             the authors had in D is not published. From the least to the greatest figure that they give."
        ));
        words.extend(standing.map(str::to_owned));
    }
    if plan.row == Row::Boosted {
        columns.push("mean sel with ties".to_owned());
        words.push(
            "`sel` counts the distinct eigenvalues that a class's strong classifier uses; *with ties* also counts those \
             that had the same least error in a round."
                .to_owned(),
        );
        let known = rows.iter().filter_map(|rows| paper(plan, rows)).collect::<Vec<_>>();
        let beyond = known.iter().filter(|known| known.count > rounds as f64).count();
        if beyond > 0 {
            words.push(format!(
                "The paper's is greater than T = {rounds} for {beyond} of its {} spectra, so it cannot be the former.",
                known.len()
            ));
        }
    }
    let table = Table { number: plan.number, title: plan.title.clone(), columns, rows: rows.iter().map(row).collect() };
    let heading = format!("Table {}: {}", plan.number, plan.title);
    Section { heading, words, table: Some((plan.stem.to_owned(), table)), figure: None }
}

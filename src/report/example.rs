//! A made-up answer for the writers' tests: small, with everything a report can hold.

use std::{path::PathBuf, sync::Arc};

use super::{Document, Origin};
use crate::{
    dataset::Role,
    query::{Answer, ModelRow, ModelState, Part, Progress, Settings, Source, Stage, StageRow},
    selection::{Climb, Round, Step, Strong},
    study::{Boosted, Cell, Climbed, Curve, FirstK, Mark, Score, Table},
};

fn part<T>(value: T) -> Part<T> {
    Part { value: Some(Arc::new(value)), stale: false }
}

fn model(name: &str, class: u32, role: Role, defects: &[&str]) -> ModelRow {
    let eigenvalues = (0..12).map(|k| f64::from(k) * 0.1 + f64::from(class) / 3.0 * f64::from(k)).collect();
    ModelRow {
        name: name.to_owned(),
        path: PathBuf::from(format!("shapes/{name}.off")),
        class,
        role,
        state: ModelState::Ready { source: Source::Ran, count: 12, seconds: 0.25 },
        size: Some((1000 + class as usize, 1996 + 2 * class as usize)),
        defects: Arc::new(defects.iter().map(|&defect| defect.to_owned()).collect()),
        measure: Some(1.5 + f64::from(class)),
        eigenvalues: Some(Arc::new(eigenvalues)),
    }
}

fn table(number: u32, method: &str, measure: &str, count: Cell) -> Table {
    let figure = |value| Cell::Number { value, decimals: 3 };
    Table {
        number,
        title: format!("{method}, {measure}"),
        columns: ["method", measure, "sel", &format!("{measure} on Q")].map(str::to_owned).to_vec(),
        rows: vec![vec![Cell::Text(method.to_owned()), figure(1.0 / 3.0), count, figure(0.5)]],
    }
}

/// The answer.
pub(super) fn answer() -> Answer {
    let mut models = vec![
        model("ant/a1", 0, Role::Train, &[]),
        model("ant/a2", 0, Role::Train, &["2 faces have no area (first: face 17); their edges were lengthened"]),
        model("ant/a3", 0, Role::Query, &[]),
        model("cup/c1", 1, Role::Train, &["boundary: 12 edges", "d2", "d3", "d4", "d5", "d6"]),
        model("cup/c2", 1, Role::Train, &[]),
        model("cup/c\u{1b}[31m3", 1, Role::Query, &[]),
        model("ring|x/r1", 2, Role::Train, &[]),
        model("ring|x/r2", 2, Role::Train, &[]),
    ];
    models[7].state =
        ModelState::Out { reason: "shapes/ring|x/r2.off: line 3: expected three numbers, found \"nan x\"".to_owned() };
    (models[7].size, models[7].measure, models[7].eigenvalues) = (None, None, None);
    models[4].state = ModelState::Ready { source: Source::Disk, count: 12, seconds: 0.0 };

    let score = |train, query| Score { train, query: Some(query) };
    let step = |index, added, cost| Step { index, added, cost };
    let curve = |start: f64, slope: f64, query: f64| Curve {
        train: (0..12).map(|k| start + slope * f64::from((k - 4_i32).pow(2)) / 60.0).collect(),
        query: (0..12).map(|k| query + slope * f64::from((k - 6_i32).pow(2)) / 70.0).collect(),
    };
    let climbed = |steps: &[Step], selected: &[u32]| Climbed {
        climb: Climb { selected: selected.to_vec(), steps: steps.to_vec() },
        error: score(0.2, 0.25),
        adr: score(0.7, 0.6),
    };
    let round = |index, error: f64, ties: &[u32]| Round {
        index,
        error,
        alpha: 0.5 * ((1.0 - error) / error).ln(),
        ties: ties.to_vec(),
        test: None,
    };
    let mark = |index, alpha| Mark { index, alpha, low: 0.1, mean: 0.15, high: 0.3 };

    Answer {
        serial: 3,
        settings: Settings { kmax: 12, k: 10, rounds: 3, class: 1, ..Settings::default() },
        layout: "class folders, first three quarters train".to_owned(),
        classes: Arc::new(["ant", "cup", "ring|x"].map(str::to_owned).to_vec()),
        members: Arc::new((0..7).collect()),
        progress: Progress { ready: 7, out: 1, total: 8, rate: None, left: None },
        short: None,
        memory: None,
        stages: vec![StageRow {
            stage: Stage::Spectrum,
            ran: 6,
            memory: 0,
            disk: 1,
            stale: 0,
            failed: 1,
            seconds: 1.5,
            saved: 0.0,
        }],
        first_k: part(FirstK { error: curve(0.2, 1.0, 0.3), adr: curve(0.8, -0.5, 0.7), best_error: 5, best_adr: 5 }),
        climb_error: part(climbed(
            &[step(3, true, 0.4), step(5, true, 0.25), step(3, false, 0.2), step(9, true, 0.2)],
            &[5, 9],
        )),
        climb_adr: part(climbed(&[step(2, true, 0.3)], &[2])),
        boosted: part(Boosted {
            classes: vec![
                Strong { rounds: vec![round(4, 0.1, &[4, 6]), round(7, 0.25, &[7]), round(4, 0.3, &[4])] },
                Strong { rounds: vec![round(2, 0.2, &[2])] },
                Strong::default(),
            ],
            error: score(0.1, 0.5),
            mean_chosen: 1.0,
            mean_ties: 4.0 / 3.0,
            decided: vec![0, 0, 1, 1, 1, 1, 2],
        }),
        marks: part(vec![vec![mark(4, 1.5), mark(7, 0.5)], vec![mark(2, 0.7)], vec![]]),
        tables: part(vec![
            table(1, "first-k", "ε", Cell::Count(5)),
            table(2, "HCBw", "ε", Cell::Count(2)),
            table(3, "AdaBoost", "ε", Cell::Number { value: 1.0, decimals: 2 }),
            table(4, "first-k", "mean ADR", Cell::Missing),
        ]),
        warnings: Arc::new(passed_over().into_iter().chain(["the cache cannot be written".to_owned()]).collect()),
        models: Arc::new(models),
    }
}

fn passed_over() -> Vec<String> {
    vec!["shapes/readme.txt: not a mesh".to_owned()]
}

/// Its origin.
pub(super) fn origin() -> Origin<'static> {
    static PASSED_OVER: std::sync::LazyLock<Vec<String>> = std::sync::LazyLock::new(passed_over);
    Origin {
        root: "shapes/",
        passed_over: &PASSED_OVER,
        seconds: 2.5,
        threads: 2,
        cache: Some("shapes/cache"),
        spectra: true,
    }
}

/// Its report.
pub(super) fn document() -> Document {
    let mut document = Document::new(&answer(), &origin());
    document.program.version = "1.2.3";
    document
}

//! Every method against an example small enough for a sheet of paper, and against `independent/evaluate.py`, an
//! evaluation from the definitions with array operations in Python, on a sample full of ties and corner cases.

#![allow(clippy::unwrap_used)]

use eigenselect::{
    metrics::{Distance, Features},
    selection::{Cost, boost, climb},
    study::{Climbed, Draws, FirstK, Pick, Sample, Scheme, Score, Sources, boosted, climbed, first_k, retrieval},
    watch::Unwatched,
};
use serde_json::Value;

const TOLERANCE: f64 = 1e-12;

fn read() -> Sample {
    let mut sample = Sample::default();
    let (mut train, mut query) = (Vec::new(), Vec::new());
    let mut classes: Vec<String> = Vec::new();
    for record in csv::Reader::from_path("tests/independent/features.csv").unwrap().records() {
        let record = record.unwrap();
        let class = classes.iter().position(|class| class == &record[1]).unwrap_or_else(|| {
            classes.push(record[1].to_owned());
            classes.len() - 1
        });
        let row: Vec<f64> = record.iter().skip(3).map(|value| value.parse().unwrap()).collect();
        let (rows, labels) = match &record[2] {
            "train" => (&mut train, &mut sample.train_labels),
            _ => (&mut query, &mut sample.query_labels),
        };
        rows.push(row);
        labels.push(class as u32);
    }
    Sample { train: Features::from_rows(train), query: Features::from_rows(query), classes: classes.len(), ..sample }
}

fn expected() -> Value {
    serde_json::from_str(&std::fs::read_to_string("tests/independent/expected.json").unwrap()).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

fn indices(value: &Value) -> Vec<u32> {
    value.as_array().unwrap().iter().map(|value| value.as_u64().unwrap() as u32).collect()
}

fn assert_near(ours: &[f64], theirs: &[f64]) {
    assert_eq!(ours.len(), theirs.len());
    for (at, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
        assert!((ours - theirs).abs() <= TOLERANCE, "entry {at}: {ours} is not {theirs}");
    }
}

#[test]
fn first_k_agrees() {
    let (sample, expected) = (read(), expected());
    for distance in Distance::ALL {
        let (ours, theirs) = (first_k(&sample, distance, &Unwatched).unwrap(), &expected[distance.name()]);
        assert_eq!(ours.error.train, numbers(&theirs["error"][0]));
        assert_eq!(ours.error.query, numbers(&theirs["error"][1]));
        assert_near(&ours.adr.train, &numbers(&theirs["adr"][0]));
        assert_near(&ours.adr.query, &numbers(&theirs["adr"][1]));
        assert_eq!(Some(ours.best_error as u64), theirs["best_error"].as_u64());
        assert_eq!(Some(ours.best_adr as u64), theirs["best_adr"].as_u64());
    }
}

#[test]
fn hill_climbing_agrees() {
    let (sample, expected) = (read(), expected());
    for distance in Distance::ALL {
        for (cost, key) in [(Cost::Error, "climb_error"), (Cost::Adr, "climb_adr")] {
            let climb = climb(&sample, distance, cost, &Unwatched).unwrap();
            let Climbed { climb, error, adr } = climbed(&sample, distance, &climb);
            let theirs = &expected[distance.name()][key];
            assert_eq!(climb.selected, indices(&theirs["selected"]));
            let steps = theirs["steps"].as_array().unwrap();
            assert_eq!(climb.steps.len(), steps.len());
            for (ours, theirs) in climb.steps.iter().zip(steps) {
                assert_eq!(Some(u64::from(ours.index)), theirs[0].as_u64());
                assert_eq!(Some(ours.added), theirs[1].as_bool());
                assert_near(&[ours.cost], &[theirs[2].as_f64().unwrap()]);
            }
            assert_eq!([error.train, error.query.unwrap()], numbers(&theirs["error"])[..]);
            assert_near(&[adr.train, adr.query.unwrap()], &numbers(&theirs["adr"]));
        }
    }
}

#[test]
fn adaboost_agrees() {
    let (sample, expected) = (read(), expected());
    let theirs = &expected["boost"];
    let ours = boosted(&sample, &boost(&sample, 20, &Unwatched).unwrap());
    let classes = theirs["rounds"].as_array().unwrap();
    assert_eq!(ours.classes.len(), classes.len());
    for (ours, theirs) in ours.classes.iter().zip(classes) {
        let theirs = theirs.as_array().unwrap();
        assert_eq!(ours.rounds.len(), theirs.len());
        for (ours, theirs) in ours.rounds.iter().zip(theirs) {
            assert_eq!(Some(u64::from(ours.index)), theirs[0].as_u64());
            assert_near(&[ours.error], &[theirs[1].as_f64().unwrap()]);
            assert!((ours.alpha - theirs[2].as_f64().unwrap()).abs() < 1e-9);
            assert_eq!(ours.ties, indices(&theirs[3]));
        }
    }
    assert_eq!(ours.decided, indices(&theirs["decided"]));
    assert_eq!([ours.error.train, ours.error.query.unwrap()], numbers(&theirs["error"])[..]);
    assert_near(&[ours.mean_chosen], &[theirs["mean_chosen"].as_f64().unwrap()]);
    assert_near(&[ours.mean_ties], &[theirs["mean_ties"].as_f64().unwrap()]);
}

/// Three long shapes (class 0) and three flat ones (class 1), two features, one query of each class.
///
/// | model | class | first | second |
/// |---|---|---|---|
/// | 0, 1, 2 | 0 | 0, 0, 0 | 1, 2, 6 |
/// | 3, 4, 5 | 1 | 0, 0, 9 | 7, 9, 8 |
fn by_hand() -> Sample {
    Sample {
        train: Features::from_rows([[0.0, 1.0], [0.0, 2.0], [0.0, 6.0], [0.0, 7.0], [0.0, 9.0], [9.0, 8.0]]),
        train_labels: vec![0, 0, 0, 1, 1, 1],
        query: Features::from_rows([[0.0, 3.0], [0.0, 6.4]]),
        query_labels: vec![0, 1],
        classes: 2,
    }
}

#[test]
fn retrieval_agrees() {
    let (sample, expected) = (read(), expected());
    let strong = boost(&sample, 20, &Unwatched).unwrap();
    for distance in Distance::ALL {
        let curves = first_k(&sample, distance, &Unwatched).unwrap();
        let climbed = |cost| climbed(&sample, distance, &climb(&sample, distance, cost, &Unwatched).unwrap());
        let (climb_error, climb_adr) = (climbed(Cost::Error), climbed(Cost::Adr));
        let sources = Sources { first_k: &curves, climb_error: &climb_error, climb_adr: &climb_adr, strong: &strong };
        let theirs = &expected[distance.name()]["retrieval"];
        let ours = retrieval(&sample, distance, sources, Draws::default(), &Unwatched).unwrap();
        let mut compared = 0;
        // Random subsets are drawn by the program's own chance.
        for found in ours.iter().filter(|found| found.scheme.pick != Pick::Random) {
            let Scheme { gate, pick, kept } = found.scheme;
            let name = format!("{} {} {kept}", gate.name(), pick.name());
            let theirs = [0, 1].map(|side| theirs[side][&name].as_f64().unwrap());
            assert_near(&[found.adr.train, found.adr.query.unwrap()], &theirs);
            compared += 1;
        }
        assert_eq!(compared, 20);
    }
}

#[test]
fn first_k_by_hand() {
    let FirstK { error, adr, best_error, best_adr } = first_k(&by_hand(), Distance::L1, &Unwatched).unwrap();
    // k = 1. Models 0 to 4 lie together, so the lowest of the others is nearest: 1, 0, 0, 0, 0; for 5 it is 0. The
    // three of class 1 are wrong. Q = 2, and the first two found are 1 2, 0 2, 0 1, then 0 1 for all of class 1.
    // k = 2. Nearest: 0 → 1, 1 → 0, 2 → 3 (wrong), 3 → 2 (wrong), 4 → 3, 5 → 3 (at 10, as is 4).
    assert_eq!(error.train, [0.5, 2.0 / 6.0]);
    // First two at k = 2: 0: 1 2 → 1. 1: 0 2 → 1. 2: 3 4 (1 and 3) → 0. 3: 2 4 → (0 + 1/2)/2. 4: 3 2 → (1 + 1/2)/2.
    // 5: 3 4 → 1.
    assert_near(&adr.train, &[0.5, (1.0 + 1.0 + 0.0 + 0.25 + 0.75 + 1.0) / 6.0]);
    assert_eq!((best_error, best_adr), (2, 2));
    // Queries at k = 1: all at 0, model 0 first: one right; first three 0 1 2. At k = 2: 3 → 1 (right), first three
    // 1 0 2; 6.4 → 2 (wrong), first three 2 (0.4) 3 (0.6) 4 (2.6): (0 + 1/2 + 2/3)/3.
    assert_eq!(error.query, [0.5, 0.5]);
    assert_near(&adr.query, &[0.5, 0.5 * (1.0 + (0.5 + 2.0 / 3.0) / 3.0)]);
}

#[test]
fn hill_climbing_by_hand() {
    let climb = climb(&by_hand(), Distance::L1, Cost::Error, &Unwatched).unwrap();
    // The second feature alone: 0 → 1, 1 → 0, 2 → 3 (wrong), 3 → 2 (wrong; 5 is as near, but comes later), 4 → 5,
    // 5 → 3: two wrong. The first alone has three wrong. Both together have two, which is no lower.
    assert_eq!(climb.selected, [2]);
    assert_eq!(climb.steps.len(), 1);
    let climbed = climbed(&by_hand(), Distance::L1, &climb);
    assert_eq!(climbed.error, Score { train: 2.0 / 6.0, query: Some(0.5) });
}

#[test]
fn adaboost_by_hand() {
    // Class 0, range of the first feature: 0 to 0 holds two of three others; of the second: 1 to 6 holds none.
    // Class 1: 0 to 9 holds all others, ½; 7 to 9 holds none.
    let strong = boost(&by_hand(), 2, &Unwatched).unwrap();
    for strong in &strong {
        assert_eq!(strong.rounds.iter().map(|round| (round.index, round.error)).collect::<Vec<_>>(), [(2, 0.0); 2]);
    }
    let boosted = boosted(&by_hand(), &strong);
    // 3 lies in the range of class 0. 6.4 lies in none, and the lower class takes it.
    assert_eq!(boosted.decided, [0, 0, 0, 1, 1, 1, 0, 0]);
    assert_eq!(boosted.error, Score { train: 0.0, query: Some(0.5) });
    assert_eq!((boosted.mean_chosen, boosted.mean_ties), (1.0, 1.0));
}

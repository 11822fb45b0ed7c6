//! Table 5 against its definition, row by row.

use super::{Draws, Sources, retrieval};
use crate::{
    metrics::{
        Cancelled, Distance, Exam, Features, Sample, adr, figures, rank,
        samples::{nobody, one_class, sample},
    },
    selection::{Climb, Cost, Step, Strong, boost, climb},
    study::{Climbed, FirstK, Gate, Pick, Reading, Retrieved, Scheme, climbed, first_k},
    watch::{Unwanted, Unwatched},
};

struct Selected {
    first_k: FirstK,
    climb_error: Climbed,
    climb_adr: Climbed,
    strong: Vec<Strong>,
}

impl Selected {
    fn on(sample: &Sample) -> Self {
        let climbed = |cost| {
            let climb = climb(sample, Distance::L1, cost, &Unwatched).unwrap();
            climbed(sample, Distance::L1, &climb)
        };
        Self {
            first_k: first_k(sample, Distance::L1, &Unwatched).unwrap(),
            climb_error: climbed(Cost::Error),
            climb_adr: climbed(Cost::Adr),
            strong: boost(sample, 6, &Unwatched).unwrap(),
        }
    }

    fn sources(&self) -> Sources<'_> {
        let Self { first_k, climb_error, climb_adr, strong } = self;
        Sources { first_k, climb_error, climb_adr, strong }
    }
}

fn of(sample: &Sample) -> Vec<Retrieved> {
    let draws = Draws { seed: 3, count: 5 };
    retrieval(sample, Distance::L1, Selected::on(sample).sources(), draws, &Unwatched).unwrap()
}

fn find(rows: &[Retrieved], gate: Gate, pick: Pick, kept: u32) -> &Retrieved {
    rows.iter().find(|row| row.scheme == Scheme { gate, pick, kept }).unwrap()
}

fn read(row: &Retrieved, reading: Reading) -> f64 {
    row.readings.iter().find(|read| read.reading == reading).unwrap().adr.query.unwrap()
}

#[test]
fn without_classes_it_is_the_mean_adr_of_the_tables() {
    for seed in 0..3 {
        let sample = sample(seed, 8, 20, 0);
        let (rows, selected) = (of(&sample), Selected::on(&sample));
        assert_eq!(find(&rows, Gate::None, Pick::Hill, 0).adr, selected.climb_adr.adr);
        let best = selected.first_k.adr.at(selected.first_k.best_adr).unwrap();
        assert_eq!(find(&rows, Gate::None, Pick::FirstK, 0).adr, best);
        // There are 9 classes: 10 are all of them.
        for gate in [Gate::Strong, Gate::FirstK, Gate::Hill] {
            assert_eq!(find(&rows, gate, Pick::FirstK, 10).adr, best);
        }
    }
}

/// Mean ADR on the queries when the classes are ranked by the distance over `gate`.
fn by_definition(sample: &Sample, gate: &[u32], subset: &[u32], kept: usize, one_by_one: bool) -> f64 {
    let exam = Exam::queries(sample);
    let (mut sum, mut counted) = (0.0, 0);
    for asked in 0..exam.len() {
        let label = exam.label(asked);
        let Some(_) = adr(&rank(exam, asked, Distance::L1, subset), exam.labels(), label) else { continue };
        let mut classes: Vec<u32> = Vec::new();
        for model in rank(exam, asked, Distance::L1, gate) {
            let class = exam.labels()[model as usize];
            if !classes.contains(&class) {
                classes.push(class);
            }
        }
        classes.truncate(kept);
        let mut members = rank(exam, asked, Distance::L1, subset);
        let place = |model: &u32| classes.iter().position(|&class| class == exam.labels()[*model as usize]);
        members.retain(|model| place(model).is_some());
        if one_by_one {
            members.sort_by_key(place);
        }
        // Q counts those that were not kept, too.
        let relevant = exam.labels().iter().filter(|&&other| other == label).count();
        let found = |i: usize| members.iter().take(i).filter(|&&m| exam.labels()[m as usize] == label).count();
        sum += (1..=relevant).map(|i| found(i) as f64 / i as f64).sum::<f64>() / relevant as f64;
        counted += 1;
    }
    sum / f64::from(counted)
}

#[test]
fn classes_are_kept_as_defined() {
    for seed in 0..3 {
        let sample = sample(seed, 8, 20, 0);
        let (rows, selected) = (of(&sample), Selected::on(&sample));
        let first = |k: usize| (1..=k as u32).collect::<Vec<_>>();
        let (k_error, k_adr) = (first(selected.first_k.best_error), first(selected.first_k.best_adr));
        let row = find(&rows, Gate::FirstK, Pick::FirstK, 5);
        let near = |ours: f64, theirs: f64| assert!((ours - theirs).abs() < 1e-13, "{ours} {theirs}");
        near(row.adr.query.unwrap(), by_definition(&sample, &k_error, &k_adr, 5, false));
        near(read(row, Reading::OneSubset), by_definition(&sample, &k_adr, &k_adr, 5, false));
        near(read(row, Reading::ClassByClass), by_definition(&sample, &k_error, &k_adr, 5, true));
        let row = find(&rows, Gate::Hill, Pick::FirstK, 5);
        near(row.adr.query.unwrap(), by_definition(&sample, &selected.climb_error.climb.order(), &k_adr, 5, false));
    }
}

#[test]
fn random_subsets_are_scored_draw_by_draw() {
    let sample = sample(1, 6, 12, 0);
    let (rows, selected) = (of(&sample), Selected::on(&sample));
    let row = find(&rows, Gate::None, Pick::Random, 0);
    let size = selected.climb_adr.climb.selected.len();
    let mut chance = crate::metrics::Chance::new(3, 0);
    let adrs: Vec<f64> =
        (0..5).map(|_| figures(Exam::queries(&sample), Distance::L1, &chance.choose(size, 12)).1).collect();
    let mean = adrs.iter().sum::<f64>() / 5.0;
    assert!((row.adr.query.unwrap() - mean).abs() < 1e-13);
    let variance = adrs.iter().map(|adr| (adr - mean).powi(2)).sum::<f64>() / 4.0;
    assert!((row.spread.unwrap().query.unwrap() - variance.sqrt()).abs() < 1e-13);
    assert!(rows.iter().all(|row| row.spread.is_some() == (row.scheme.pick == Pick::Random)));
}

/// Two classes of two on a line, and a query of each: everything by hand.
#[test]
fn by_hand() {
    let sample = Sample {
        train: Features::from_rows([[0.0], [4.0], [1.0], [9.0]]),
        train_labels: vec![0, 0, 1, 1],
        query: Features::from_rows([[0.4]]),
        query_labels: vec![0],
        classes: 2,
    };
    let climb = Climb { selected: vec![1], steps: vec![Step { index: 1, added: true, cost: 0.5 }] };
    let climb = climbed(&sample, Distance::L1, &climb);
    let first_k = first_k(&sample, Distance::L1, &Unwatched).unwrap();
    let strong = boost(&sample, 1, &Unwatched).unwrap();
    let sources = Sources { first_k: &first_k, climb_error: &climb, climb_adr: &climb, strong: &strong };
    let rows = retrieval(&sample, Distance::L1, sources, Draws::default(), &Unwatched).unwrap();
    // The query finds 0 (right), 1 (wrong), 4 (right): ADR = (1 + 1/2)/2; found at ranks 1 and 3.
    let row = find(&rows, Gate::None, Pick::FirstK, 0);
    assert_eq!(row.adr.query, Some(0.75));
    assert_eq!(row.precision.query, [1.0, 2.0 / 3.0]);
    // With itself: right, right, wrong of 3: (1 + 1 + 2/3)/3.
    assert!((read(row, Reading::Itself) - 8.0 / 9.0).abs() < 1e-15);
    // Both classes kept, one after the other: 0 4 1 9.
    let row = find(&rows, Gate::Hill, Pick::FirstK, 5);
    assert_eq!((row.adr.query, read(row, Reading::ClassByClass)), (Some(0.75), 1.0));
    assert_eq!(row.closest(0.99).unwrap().reading, Reading::ClassByClass);
    assert_eq!(row.closest(0.7).unwrap().reading, Reading::Strict);
    // There is one subset of one feature to draw.
    let row = find(&rows, Gate::None, Pick::Random, 0);
    assert_eq!((row.adr.query, row.spread.unwrap().query), (Some(0.75), Some(0.0)));
}

#[test]
fn the_published_schemes_differ_and_hold_those_of_figure_7() {
    let schemes: Vec<_> = Scheme::published().into_iter().map(|(scheme, _)| scheme).collect();
    assert!(schemes.iter().enumerate().all(|(at, scheme)| !schemes[..at].contains(scheme)));
    assert!(Scheme::figure_7().iter().all(|scheme| schemes.contains(scheme)));
}

#[test]
fn few_or_no_models() {
    for row in of(&one_class()) {
        assert_eq!((row.adr.train, row.adr.query), (1.0, None));
        assert_eq!((row.precision.train, row.precision.query), (vec![1.0; 2], Vec::new()));
    }
    assert!(of(&nobody()).iter().all(|row| row.adr.train == 0.0 && row.precision.train.is_empty()));
}

#[test]
fn stops_when_cancelled() {
    let sample = sample(5, 5, 5, 0);
    let selected = Selected::on(&sample);
    let stopped = retrieval(&sample, Distance::L1, selected.sources(), Draws::default(), &Unwanted);
    assert_eq!(stopped, Err(Cancelled));
}

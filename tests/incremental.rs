//! What runs again after which change, and that the answer never depends on how one came to it.

#![allow(clippy::unwrap_used)]

mod common;

use std::{
    fs,
    path::Path,
    sync::atomic::{AtomicUsize, Ordering},
    time::Duration,
};

use eigenselect::{
    dataset,
    query::{Answer, Config, Finding, Host, ModelState, Parameter, Query, Question, Settings, Source, Stage},
    store::Store,
    watch::{Unwatched, Watch},
};
use proptest::prelude::*;

fn host(data: &Path, cache: &Path, settings: Settings) -> Host {
    let store = Store::open(cache, eigenselect::store::Options::default());
    let data = dataset::open(data, &dataset::Options::default()).unwrap();
    Host::new(Config { data, settings, store, threads: 2 })
}

fn small(kmax: usize) -> Settings {
    let mut settings = Settings { kmax, k: 5, ..Settings::default() };
    settings.set(Parameter::Normalisation, "area", 3).unwrap();
    settings
}

fn after(host: &mut Host, parameter: Parameter, value: &str) -> Vec<Query> {
    let mut settings = host.settings().clone();
    settings.set(parameter, value, 3).unwrap();
    assert!(host.set(settings), "{} was {value} already", parameter.name());
    host.run(&Unwatched).unwrap();
    let mut log = host.log();
    log.sort();
    log
}

fn stage(answer: &Answer, stage: Stage) -> (usize, usize, usize) {
    let row = answer.stages.iter().find(|row| row.stage == stage).unwrap();
    (row.ran, row.memory, row.disk)
}

use Query::{
    Boost, BoostRows, Climb, ClimbRows, Content, Facts, FirstK, FirstKRows, HeldOut, MarkRows, Sample, Spectrum,
    TableRows,
};

const MODELS: usize = 12;

/// The learning stages and the rows above them.
const LEARNING: [Query; 11] =
    [Sample, FirstK, Climb, Climb, Boost, FirstKRows, ClimbRows, ClimbRows, BoostRows, MarkRows, TableRows];

fn with_spectra(count: usize, rest: &[Query]) -> Vec<Query> {
    let mut log = vec![Spectrum; count];
    log.extend(rest);
    log.sort();
    log
}

#[test]
fn each_parameter_runs_exactly_what_reads_it() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 4);
    let mut host = host(&data, &cache, small(30));
    let answer = host.run(&Unwatched).unwrap();
    assert_eq!(answer.progress.ready, MODELS);
    assert_eq!(stage(&answer, Stage::Spectrum), (MODELS, 0, 0));

    let none: Vec<Query> = Vec::new();
    // Slices.
    assert_eq!(after(&mut host, Parameter::Rounds, "9"), [BoostRows, MarkRows, TableRows]);
    assert_eq!(after(&mut host, Parameter::Rounds, "64"), [BoostRows, MarkRows, TableRows]);
    assert_eq!(after(&mut host, Parameter::K, "7"), [TableRows]);
    assert_eq!(after(&mut host, Parameter::Sel, "ties"), [TableRows]);
    // What only the screen reads.
    assert_eq!(after(&mut host, Parameter::Cost, "adr"), none);
    assert_eq!(after(&mut host, Parameter::Class, "2"), none);
    // A smaller kmax: no spectrum and no features; selections are cut unless they had reached further.
    let log = after(&mut host, Parameter::Kmax, "29");
    assert!(!log.contains(&Spectrum) && !log.contains(&FirstK), "{log:?}");
    // Further stages.
    let mut learning = LEARNING.to_vec();
    learning.sort();
    after(&mut host, Parameter::Kmax, "30");
    assert_eq!(
        after(&mut host, Parameter::Distance, "l1"),
        [FirstK, Climb, Climb, FirstKRows, ClimbRows, ClimbRows, TableRows]
    );
    assert_eq!(after(&mut host, Parameter::Weights, "fisher"), learning);
    let log = after(&mut host, Parameter::Weights, "none");
    assert!(!log.iter().any(|q| [Spectrum, Sample, FirstK, Climb, Boost].contains(q)), "{log:?}");
    // The tables are made again only where another way of selecting selects something else.
    let mut but_tables = |parameter, value| {
        let mut log = after(&mut host, parameter, value);
        log.retain(|query| *query != TableRows);
        log
    };
    assert_eq!(but_tables(Parameter::Search, "level"), [Climb, Climb, ClimbRows, ClimbRows]);
    but_tables(Parameter::Search, "strict");
    assert_eq!(but_tables(Parameter::Weak, "interval"), [Boost, BoostRows, MarkRows]);
    but_tables(Parameter::Weak, "range");
    assert_eq!(but_tables(Parameter::Stop, "early"), [HeldOut, BoostRows, MarkRows]);
    after(&mut host, Parameter::Stop, "fixed");
    assert_eq!(after(&mut host, Parameter::Normalisation, "max"), learning);
    assert_eq!(after(&mut host, Parameter::Mass, "lumped"), with_spectra(MODELS, &LEARNING));
    // Back to what was: only the rows that read the parameter are made again, of results in memory.
    let log = after(&mut host, Parameter::Mass, "consistent");
    assert!(!log.iter().any(|q| [Spectrum, Sample, FirstK, Climb, Boost].contains(q)), "{log:?}");
    assert_eq!(after(&mut host, Parameter::Operator, "cot"), with_spectra(MODELS, &LEARNING));
    // Under cot the mass matrix means nothing.
    assert_eq!(after(&mut host, Parameter::Mass, "lumped"), none);
    // More eigenvalues: every spectrum is asked for again, and everything above.
    let log = after(&mut host, Parameter::Kmax, "35");
    assert_eq!(log, with_spectra(MODELS, &LEARNING));
    // `max` changes every feature with kmax, but no spectrum.
    assert_eq!(after(&mut host, Parameter::Kmax, "25"), learning);
    // Re-meshed models have spectra of their own, which live beside those of the models as they are.
    assert_eq!(after(&mut host, Parameter::Remesh, "120"), with_spectra(MODELS, &LEARNING));
    let answer = host.run(&Unwatched).unwrap();
    let defects = answer.models.iter().flat_map(|model| model.defects.iter());
    assert_eq!(defects.filter(|defect| defect.contains("re-meshed")).count(), 0, "what was asked for is no defect");
    let log = after(&mut host, Parameter::Remesh, "original");
    assert!(!log.iter().any(|q| [Content, Facts, Spectrum, Sample, FirstK, Climb, Boost].contains(q)), "{log:?}");
    let log = after(&mut host, Parameter::Remesh, "120");
    assert!(!log.iter().any(|q| [Content, Facts, Spectrum, Sample, FirstK, Climb, Boost].contains(q)), "{log:?}");
}

#[test]
fn what_is_examined_runs_again_only_for_what_it_depends_on() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 8);
    let mut host = host(&data, &cache, small(20));
    host.run(&Unwatched).unwrap();
    let find = |host: &mut Host, question: Question| host.find(question, &Unwatched).unwrap().unwrap();
    let ran = |host: &Host| {
        host.log().into_iter().filter(|query| matches!(query, Query::RetrievalRows | Query::HonestRows)).count()
    };
    let (retrieved, honest) = (find(&mut host, Question::Retrieval), find(&mut host, Question::Honest));
    assert_eq!(ran(&host), 2);
    let Finding::Honest(table) = &honest else { panic!("{honest:?}") };
    assert!(table.rows.iter().all(|row| row.error.low <= row.error.mean && row.error.mean <= row.error.high));
    // Nothing of it depends on the k that is read off.
    after(&mut host, Parameter::K, "7");
    assert_eq!(
        (find(&mut host, Question::Retrieval), find(&mut host, Question::Honest)),
        (retrieved.clone(), honest.clone())
    );
    assert_eq!(ran(&host), 0);
    // Both do on the distance.
    after(&mut host, Parameter::Distance, "l1");
    assert_ne!(find(&mut host, Question::Retrieval), retrieved);
    assert_ne!(find(&mut host, Question::Honest), honest);
    assert_eq!(ran(&host), 2);
    // In the next session the store has what took long, bit for bit.
    let mut next = self::host(&data, &cache, small(20));
    next.run(&Unwatched).unwrap();
    assert_eq!(find(&mut next, Question::Honest), honest);
}

#[test]
fn a_smaller_kmax_is_cut_from_what_is_there() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 4);
    let mut host = host(&data, &cache, small(40));
    let answer = host.run(&Unwatched).unwrap();
    let touched = |answer: &Answer| {
        let climbs = [&answer.climb_error, &answer.climb_adr].map(|part| part.value.as_ref().unwrap().climb.reach());
        let strong = answer.boosted.value.as_ref().unwrap();
        climbs.into_iter().chain(strong.classes.iter().map(eigenselect::selection::Strong::reach)).max().unwrap()
    };
    let reach = touched(&answer);
    assert!(reach < 40, "this test wants selections that leave room: {reach}");
    let log = after(&mut host, Parameter::Kmax, &reach.max(5).to_string());
    assert!(!log.iter().any(|q| [Spectrum, Sample, FirstK, Climb, Boost].contains(q)), "{log:?}");
}

#[test]
fn a_second_start_solves_nothing_and_a_touched_file_is_only_hashed() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    let files = common::write_data(&data, 3, 4);
    // Until then a file may be written again without its times telling, and every look hashes it anew.
    std::thread::sleep(Duration::from_millis(2100));
    let first = host(&data, &cache, small(30)).run(&Unwatched).unwrap();
    let mut host = host(&data, &cache, small(30));
    let second = host.run(&Unwatched).unwrap();
    assert_eq!(stage(&second, Stage::Survey), (0, 0, MODELS));
    assert_eq!(stage(&second, Stage::Spectrum), (0, 0, MODELS));
    assert_eq!(essence(&first), essence(&second));

    // Touched: the same bytes at another time.
    let bytes = fs::read(&files[5]).unwrap();
    fs::write(&files[5], &bytes).unwrap();
    host.update(dataset::open(&data, &dataset::Options::default()).unwrap());
    let touched = host.run(&Unwatched).unwrap();
    assert_eq!(host.log(), [Content]);
    assert_eq!(stage(&touched, Stage::Spectrum), (0, MODELS, 0));
    assert_eq!(essence(&first), essence(&touched));

    // Changed: one solve, and what depends on it.
    fs::write(&files[5], common::off(2, 1.77, 0.2, 6)).unwrap();
    host.update(dataset::open(&data, &dataset::Options::default()).unwrap());
    let changed = host.run(&Unwatched).unwrap();
    assert_eq!(stage(&changed, Stage::Spectrum), (1, MODELS - 1, 0));
    let mut log = host.log();
    log.sort();
    let mut expected = vec![Content, Facts, Spectrum];
    expected.extend(LEARNING);
    expected.sort();
    assert_eq!(log.iter().filter(|q| **q == Spectrum).count(), 1, "{log:?}");
    assert!(log.iter().all(|q| expected.contains(q)), "{log:?}");
    assert_ne!(essence(&first), essence(&changed));
}

#[test]
fn the_same_shape_twice_is_solved_once() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    let files = common::write_data(&data, 2, 4);
    fs::copy(&files[0], &files[1]).unwrap();
    let answer = host(&data, &cache, small(20)).run(&Unwatched).unwrap();
    assert_eq!(stage(&answer, Stage::Spectrum), (7, 1, 0));
}

#[test]
fn one_bad_mesh_is_a_row_with_its_reason() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    let files = common::write_data(&data, 3, 4);
    fs::write(&files[2], "OFF\n3 1 0\n0 0 0\n1 0 nan\n0 1 0\n3 0 1 2\n").unwrap();
    fs::write(&files[7], "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n").unwrap();
    let mut host = host(&data, &cache, small(30));
    let answer = host.run(&Unwatched).unwrap();
    assert_eq!(answer.progress.out, 2);
    assert_eq!(answer.members.len(), MODELS - 2);
    assert!(answer.tables.value.is_some() && !answer.tables.stale);
    let reasons = answer.models.iter().filter_map(|row| match &row.state {
        ModelState::Out { reason } => Some((row.name.as_str(), reason.as_str())),
        _ => None,
    });
    let reasons: Vec<_> = reasons.collect();
    assert!(reasons[1].1.contains("4 eigenvalues, fewer than kmax = 30"), "{reasons:?}");
    // With few enough eigenvalues the small one comes back.
    let mut settings = host.settings().clone();
    settings.kmax = 4;
    host.set(settings);
    assert_eq!(host.run(&Unwatched).unwrap().members.len(), MODELS - 1);
}

/// Everything in an answer but how and when it was come by.
fn essence(answer: &Answer) -> String {
    let models: Vec<_> = answer
        .models
        .iter()
        .map(|row| {
            let state = match &row.state {
                ModelState::Ready { count, .. } => format!("ready {}", *count >= answer.settings.kmax),
                state => format!("{state:?}"),
            };
            // How many more there are than asked for depends on what was asked before.
            let kmax = answer.settings.kmax;
            let values = row.eigenvalues.as_ref().map(|v| v.iter().take(kmax).map(|v| v.to_bits()).collect::<Vec<_>>());
            (row.name.clone(), row.class, row.role, state, row.size, row.measure.map(f64::to_bits), values)
        })
        .collect();
    let parts = (
        answer.first_k.value.as_deref(),
        answer.climb_error.value.as_deref(),
        answer.climb_adr.value.as_deref(),
        answer.boosted.value.as_deref(),
        answer.marks.value.as_deref(),
        answer.tables.value.as_deref(),
    );
    format!("{models:?}\n{:?}\n{}\n", answer.members, serde_json::to_string(&parts).unwrap())
}

/// One edit of a session.
#[derive(Debug, Clone)]
enum Edit {
    Set(usize, usize),
    Undo,
    Change(usize, usize),
    Add(usize, usize),
    Remove(usize),
    Run,
    Cancel(usize),
    Reopen,
}

fn edits() -> impl Strategy<Value = Vec<Edit>> {
    let edit = prop_oneof![
        4 => (0..12_usize, 0..5_usize).prop_map(|(parameter, value)| Edit::Set(parameter, value)),
        1 => Just(Edit::Undo),
        2 => (0..9_usize, 0..12_usize).prop_map(|(file, shape)| Edit::Change(file, shape)),
        1 => (0..3_usize, 0..12_usize).prop_map(|(class, shape)| Edit::Add(class, shape)),
        1 => (0..9_usize).prop_map(Edit::Remove),
        2 => Just(Edit::Run),
        2 => (0..60_usize).prop_map(Edit::Cancel),
        1 => Just(Edit::Reopen),
    ];
    prop::collection::vec(edit, 1..9)
}

/// Some shapes: most are fine, one is not a mesh, one has few vertices, and two are the same.
fn shape(index: usize) -> String {
    match index {
        0 => "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n".into(),
        1 => "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n".into(),
        2 | 3 => common::off(0, 1.5, 0.3, 4),
        _ => common::off(index % 3, 0.8 + 0.1 * index as f64, 0.1 * index as f64, 4),
    }
}

/// Cancels after so many looks.
struct Patience(AtomicUsize);

impl Watch for Patience {
    fn cancelled(&self) -> bool {
        self.0.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |left| left.checked_sub(1)).is_err()
    }
}

fn open(data: &Path) -> dataset::DataSet {
    dataset::open(data, &dataset::Options::default()).unwrap()
}

/// Plays a script; true when the last answer equals a computation from scratch.
fn play(script: &[Edit]) {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    let files = common::write_data(&data, 3, 3);
    for (at, file) in files.iter().enumerate() {
        fs::write(file, shape(at + 3)).unwrap();
    }
    let mut settings = small(12);
    let mut history = vec![settings.clone()];
    let mut session = host(&data, &cache, settings.clone());
    let mut added = 0;
    for edit in script {
        match *edit {
            Edit::Set(parameter, value) => {
                let (parameter, values) = [
                    (Parameter::Operator, ["fem", "cot", "fem", "cot", "fem"]),
                    (Parameter::Mass, ["consistent", "lumped", "consistent", "lumped", "consistent"]),
                    (Parameter::Kmax, ["4", "12", "7", "20", "15"]),
                    (Parameter::Normalisation, ["none", "area", "max", "weyl", "log"]),
                    (Parameter::Weights, ["none", "standard", "within", "fisher", "none"]),
                    (Parameter::Distance, ["l2", "l1", "chi2", "wesd1.5", "wesd2"]),
                    (Parameter::Search, ["strict", "level", "beam", "strict", "level"]),
                    (Parameter::Weak, ["range", "interval", "threshold", "range", "interval"]),
                    (Parameter::Stop, ["fixed", "early", "fixed", "early", "fixed"]),
                    (Parameter::K, ["1", "3", "5", "7", "30"]),
                    (Parameter::Rounds, ["1", "5", "20", "63", "70"]),
                    (Parameter::Sel, ["chosen", "ties", "chosen", "ties", "chosen"]),
                ][parameter];
                settings.set(parameter, values[value], 3).unwrap();
                history.push(settings.clone());
                session.set(settings.clone());
            }
            Edit::Undo => {
                if history.len() > 1 {
                    history.pop();
                }
                settings = history[history.len() - 1].clone();
                session.set(settings.clone());
            }
            Edit::Change(file, with) => {
                if files[file].exists() {
                    fs::write(&files[file], shape(with)).unwrap();
                    session.update(open(&data));
                }
            }
            Edit::Add(class, with) => {
                added += 1;
                fs::write(data.join(format!("class{class}/x{added}.off")), shape(with)).unwrap();
                session.update(open(&data));
            }
            Edit::Remove(file) => {
                // One model of each class stays, else there is no data set.
                if file % 3 != 0 && files[file].exists() {
                    fs::remove_file(&files[file]).unwrap();
                    session.update(open(&data));
                }
            }
            Edit::Run => {
                session.run(&Unwatched).unwrap();
            }
            Edit::Cancel(after) => {
                let _ = session.run(&Patience(AtomicUsize::new(after)));
            }
            Edit::Reopen => {
                drop(session);
                session = host(&data, &cache, settings.clone());
            }
        }
    }
    let answer = session.run(&Unwatched).unwrap();
    let scratch = host(&data, &folder.path().join("empty"), settings).run(&Unwatched).unwrap();
    assert!(scratch.models.iter().all(|row| !matches!(row.state, ModelState::Ready { source: Source::Disk, .. })));
    assert_eq!(essence(&answer), essence(&scratch), "after {script:?}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, max_shrink_iters: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_session_ends_in_the_answer_from_scratch(script in edits()) {
        play(&script);
    }
}

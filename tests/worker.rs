//! The worker behind the screen: partial answers, knobs turned in the middle of the solving, quick ends.

#![allow(clippy::unwrap_used)]

mod common;

use std::{
    path::Path,
    sync::{Arc, mpsc},
    time::{Duration, Instant},
};

use eigenselect::{
    dataset,
    laplacian::{Mass, Operator},
    query::{Answer, Config, Finding, Host, ModelState, Question, Reply, Settings, Stage},
    report::paper::{
        self,
        variation::{Subject, solves},
    },
    spectrum::Normalisation,
    store::Store,
    study::Method,
    watch::Unwatched,
    workbench::{
        Command, Update,
        experiment::Told,
        worker::{Setup, Worker},
    },
};

fn setup(data: &Path, cache: &Path, settings: &Settings) -> Setup {
    Setup {
        root: data.to_owned(),
        options: dataset::Options::default(),
        settings: settings.clone(),
        store: Store::open(cache, eigenselect::store::Options::default()),
        threads: 2,
    }
}

fn spawn(setup: Setup) -> (Worker, mpsc::Receiver<Update>) {
    let (sender, updates) = mpsc::channel();
    let worker = Worker::spawn(setup, move |update| {
        let _ = sender.send(update);
    });
    (worker.unwrap(), updates)
}

/// The first answer for which `right` holds.
fn wait_for(updates: &mpsc::Receiver<Update>, right: impl Fn(&Answer) -> bool) -> Arc<Answer> {
    let deadline = Instant::now() + Duration::from_mins(1);
    loop {
        match updates.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(Update::Answer(answer)) if right(&answer) => return answer,
            Ok(Update::Fatal(reason)) => panic!("{reason}"),
            Ok(_) => {}
            Err(error) => panic!("no such answer came: {error}"),
        }
    }
}

fn settled(answer: &Answer) -> bool {
    answer.progress.complete() && !answer.tables.stale && !answer.marks.stale && answer.tables.value.is_some()
}

fn small() -> Settings {
    Settings { kmax: 30, normalisation: Normalisation::Area, ..Settings::default() }
}

#[test]
fn answers_follow_the_knobs_and_equal_those_without_a_screen() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 5);
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    let before = wait_for(&updates, settled);
    assert_eq!(before.members.len(), 15);
    let settings = Settings { rounds: 3, normalisation: Normalisation::Log, ..small() };
    worker.send(Command::Set(settings.clone()));
    let after = wait_for(&updates, |answer| answer.settings == settings && settled(answer));
    assert!(after.serial > before.serial);
    assert!(after.boosted.value.as_ref().unwrap().classes.iter().all(|strong| strong.rounds.len() <= 3));
    let config = Config {
        data: dataset::open(&data, &dataset::Options::default()).unwrap(),
        settings,
        store: Store::open(&folder.path().join("other"), eigenselect::store::Options::default()),
        threads: 1,
    };
    let alone = Host::new(config).run(&Unwatched).unwrap();
    assert_eq!(after.tables, alone.tables);
    assert_eq!(after.first_k, alone.first_k);
    assert_eq!(after.climb_adr, alone.climb_adr);
    assert_eq!(after.boosted, alone.boosted);
    assert_eq!(after.marks, alone.marks);
}

#[test]
fn knobs_turned_while_spectra_are_solved_lose_nothing() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 4, 6);
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    let mut settings = small();
    for turn in 0..40 {
        settings.rounds = 1 + turn;
        settings.k = 1 + turn % 9;
        worker.send(Command::Set(settings.clone()));
        std::thread::sleep(Duration::from_millis(3));
    }
    let answer = wait_for(&updates, |answer| answer.settings == settings && settled(answer));
    assert_eq!(answer.progress.ready, 24);
    assert_eq!(answer.members.len(), 24);
}

#[test]
fn stopping_keeps_what_is_there_and_resuming_finishes() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 8);
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    worker.send(Command::Stop);
    worker.send(Command::Rescan);
    worker.send(Command::Resume);
    let answer = wait_for(&updates, settled);
    assert_eq!(answer.progress.ready, 24);
}

#[test]
fn ends_at_once_in_the_middle_of_a_run() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 8);
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    drop(updates.recv_timeout(Duration::from_mins(1)).unwrap());
    let start = Instant::now();
    drop(worker);
    assert!(start.elapsed() < Duration::from_millis(200), "{:?}", start.elapsed());
}

/// The first reply for which `right` holds.
fn wait_for_reply(updates: &mpsc::Receiver<Update>, right: impl Fn(&Reply) -> bool) -> Arc<Reply> {
    let deadline = Instant::now() + Duration::from_mins(1);
    loop {
        match updates.recv_timeout(deadline.saturating_duration_since(Instant::now())) {
            Ok(Update::Reply(reply)) if right(&reply) => return reply,
            Ok(Update::Fatal(reason)) => panic!("{reason}"),
            Ok(_) => {}
            Err(error) => panic!("no such reply came: {error}"),
        }
    }
}

#[test]
fn questions_are_answered_again_when_a_knob_changes_their_answer() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 5);
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    let method = Method::FirstK;
    // Asked before there is a study: the answer comes with it.
    worker.send(Command::Ask(vec![Question::Decisions(method), Question::Reasons { method, model: 3 }]));
    let reply =
        wait_for_reply(&updates, |reply| reply.question == Question::Decisions(method) && reply.places.len() == 15);
    let Ok(Finding::Decisions(decisions)) = &reply.finding else { panic!("{reply:?}") };
    assert_eq!(decisions.truth.len(), 15);
    let at =
        |k: usize| move |reply: &Reply| reply.settings.k == k && matches!(reply.question, Question::Reasons { .. });
    worker.send(Command::Set(Settings { k: 2, ..small() }));
    let reply = wait_for_reply(&updates, at(2));
    let Ok(Finding::Neighbours(found)) = &reply.finding else { panic!("{reply:?}") };
    assert_eq!((found.selection.as_slice(), reply.places[found.asked]), ([1, 2].as_slice(), 3));
    worker.send(Command::Set(Settings { k: 31, ..small() }));
    let reply = wait_for_reply(&updates, at(31));
    assert_eq!(reply.finding.as_ref().unwrap_err().as_ref(), "k = 31 is beyond kmax = 30");
    // A surface needs no study.
    worker.send(Command::Look(vec![
        Question::Shape(99),
        Question::Shape(0),
        Question::Function { model: 0, index: 4 },
        Question::Function { model: 1, index: 9999 },
    ]));
    let reply = wait_for_reply(&updates, |reply| reply.question == Question::Shape(0));
    let Ok(Finding::Shape(mesh)) = &reply.finding else { panic!("{reply:?}") };
    let vertices = mesh.vertices().len();
    let function = |reply: &Reply| matches!(reply.question, Question::Function { .. });
    let reply = wait_for_reply(&updates, function);
    assert!(matches!(&reply.finding, Ok(Finding::Function(values)) if values.len() == vertices), "{reply:?}");
    let reply = wait_for_reply(&updates, function);
    assert_eq!(reply.finding.as_ref().unwrap_err().as_ref(), "the model has no eigenvalue 9999");
}

#[test]
fn a_data_set_that_changes_shows_by_itself() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 2, 4);
    let (_worker, updates) = spawn(setup(&data, &cache, &small()));
    let before = wait_for(&updates, |answer| settled(answer) && answer.members.len() == 8);
    let first = before.models[0].path.clone();
    std::fs::write(first.with_file_name("added.off"), common::off(0, 1.77, 0.3, 6)).unwrap();
    let after = wait_for(&updates, |answer| settled(answer) && answer.members.len() == 9);
    let spectra = after.stages.iter().find(|row| row.stage == Stage::Spectrum).unwrap();
    assert_eq!((spectra.ran, spectra.memory), (1, 8), "the others are known");
    std::fs::remove_file(&first).unwrap();
    let gone = wait_for(&updates, |answer| settled(answer) && answer.models.len() == 8);
    assert!(gone.models.iter().all(|model| model.path != first));
}

#[test]
fn trials_are_made_beside_the_screen() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 5);
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    let whole = |answer: &Answer| settled(answer) && answer.members.len() == 15 && !answer.climb_error.stale;
    let before = wait_for(&updates, whole);
    let others = [1, 4].map(|rounds| Settings { rounds, ..small() });
    worker.send(Command::Try(others.to_vec()));
    let mut trials = Vec::new();
    while trials.len() < 2 {
        match updates.recv_timeout(Duration::from_mins(1)).unwrap() {
            Update::Trial(trial) => trials.push(trial),
            Update::Answer(answer) => assert_eq!(answer.settings, small(), "the screen's settings stay"),
            Update::Note(_) | Update::Trying(..) => {}
            other => panic!("{other:?}"),
        }
    }
    for (trial, settings) in trials.iter().zip(&others) {
        assert_eq!(trial.settings, *settings);
        assert!(trial.figures.complete());
        assert_eq!(trial.figures.climb_error, before.climb_error.value, "T does not change hill climbing");
    }
    // The same as when the screen's own knob is turned.
    worker.send(Command::Set(others[0].clone()));
    let after = wait_for(&updates, |answer| answer.settings == others[0] && settled(answer));
    assert_eq!(trials[0].figures.boosted, after.boosted.value);
    assert_eq!(trials[0].figures.test(&trials[0].figures, Method::Boost, false), Some(1.0));
}

/// The first piece of news that `right` picks.
fn wait_for_news<T>(updates: &mpsc::Receiver<Update>, mut right: impl FnMut(Update) -> Option<T>) -> T {
    let deadline = Instant::now() + Duration::from_mins(1);
    loop {
        let update = updates.recv_timeout(deadline.saturating_duration_since(Instant::now())).unwrap();
        if let Some(found) = right(update) {
            return found;
        }
    }
}

fn told(update: Update) -> Option<Result<usize, String>> {
    match update {
        Update::Paper(Told::Done(outcome)) => Some(outcome),
        _ => None,
    }
}

#[test]
fn the_document_is_written_while_the_screen_stays_live() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 5);
    let settings = Settings { kmax: 20, rounds: 5, remesh: Some(150), ..Settings::default() };
    let (worker, updates) = spawn(setup(&data, &cache, &settings));
    wait_for(&updates, settled);
    let paper = folder.path().join("paper");
    worker.send(Command::Paper(paper.clone()));
    let turned = Settings { k: 3, ..settings.clone() };
    worker.send(Command::Set(turned.clone()));
    let mut answered = false;
    let files = loop {
        match updates.recv_timeout(Duration::from_mins(1)).unwrap() {
            Update::Answer(answer) => answered |= answer.settings == turned && settled(&answer),
            other => {
                if let Some(outcome) = told(other) {
                    break outcome.unwrap();
                }
            }
        }
    };
    assert!(answered, "the knob was answered before the document was there");
    assert_eq!(std::fs::read_dir(&paper).unwrap().count(), files);
    assert!(std::fs::read_to_string(paper.join("paper.md")).unwrap().contains("## Figure 7:"));
    // Called off, it leaves nothing and says why.
    let other = folder.path().join("other");
    worker.send(Command::Paper(other.clone()));
    worker.send(Command::StopPaper);
    assert_eq!(wait_for_news(&updates, told), Err("interrupted".to_owned()));
    assert!(!other.exists());
}

#[test]
fn figure_1_is_made_once_it_is_asked_for_and_is_the_documents() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 2, 4);
    // The first training model is none.
    std::fs::write(data.join("class1/m0.off"), "OFF\nnothing").unwrap();
    // Its cot spectra are not those on the screen, nor is it of the models as they are.
    let settings = Settings { kmax: 20, remesh: Some(150), class: 1, mass: Mass::Lumped, ..Settings::default() };
    let (worker, updates) = spawn(setup(&data, &cache, &settings));
    let answer = wait_for(&updates, settled);
    let subject = Subject::new(&settings, &answer);
    worker.send(Command::Vary(subject.clone()));
    let mut heard = Vec::new();
    let varied = wait_for_news(&updates, |update| match update {
        Update::Varying(told, done) => {
            assert_eq!(*told, subject);
            heard.push(done);
            None
        }
        Update::Varied(varied) => Some(varied),
        _ => None,
    });
    assert!(!heard.is_empty() && heard.is_sorted() && heard.iter().all(|done| *done <= solves(subject.models.len())));
    assert_eq!(varied.subject, subject);
    let variation = varied.variation.as_ref().unwrap();
    let figure = variation.figure();
    assert_eq!(figure.panels.len(), 6, "{:?}", figure.panels.iter().map(|panel| &panel.title).collect::<Vec<_>>());
    assert_eq!((variation.model.as_str(), variation.variants.len()), ("class1/m1", 9));
    assert!(variation.variants[0].fem.is_some() && variation.variants[0].cot.is_some());
    assert!(variation.members[0].why.as_ref().unwrap().contains("line 2"), "{:?}", variation.members[0]);
    assert!(variation.members[1..].iter().all(|member| member.fem.is_some() && member.cot.is_some()));
    assert_eq!(variation.members[1].cot, variation.variants[0].cot);

    // From a store of its own and with the other operator set, the document has the same.
    let config = Config {
        data: dataset::open(&data, &dataset::Options::default()).unwrap(),
        settings: Settings { operator: Operator::Cot, ..settings },
        store: Store::open(&folder.path().join("other"), eigenselect::store::Options::default()),
        threads: 1,
    };
    let base = config.settings.clone();
    let found = paper::collect(&mut Host::new(config), &base, &Unwatched).unwrap();
    assert_eq!(found.variation.as_ref(), Ok(variation));
}

#[test]
fn what_is_done_is_told_for_the_journal() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 2, 4);
    std::fs::write(data.join("class0/m9.off"), "OFF\nnothing").unwrap();
    let (worker, updates) = spawn(setup(&data, &cache, &small()));
    let mut lines: Vec<String> = Vec::new();
    let mut wait = |word: &str| {
        let found = |line: &String| line.contains(word);
        while !lines.iter().any(found) {
            lines.push(wait_for_news(&updates, |update| match update {
                Update::Note(line) => Some(format!("{} {}", line.weight.name(), line.text)),
                _ => None,
            }));
        }
    };
    wait("9 models of 2 classes");
    wait("note spectra: 8 computed");
    wait("warning class0/m9");
    wait("study of 8 models");
    worker.send(Command::Set(Settings { rounds: 7, ..small() }));
    wait("note T = 7");
}

#[test]
fn a_folder_that_is_not_there_is_told() {
    let folder = common::scratch();
    let (_worker, updates) = spawn(setup(&folder.path().join("nowhere"), folder.path(), &small()));
    match updates.recv_timeout(Duration::from_mins(1)).unwrap() {
        Update::Fatal(reason) => assert!(reason.contains("nowhere"), "{reason}"),
        _ => panic!("an answer from nowhere"),
    }
}

#[test]
fn files_that_vanish_after_they_were_solved_are_studied_and_others_are_out_by_name() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    let files = common::write_data(&data, 3, 60);
    let mut setup = setup(&data, &cache, &small());
    setup.threads = 1;
    let (worker, updates) = spawn(setup.clone());
    // In the middle of the solving all files go, those that are solved and those that are not.
    let answer = wait_for(&updates, |answer| answer.progress.ready >= 8);
    let away = folder.path().join("away");
    std::fs::rename(&data, &away).unwrap();
    // Where everything was done before it went, there is no further answer to wait for.
    let answer = if settled(&answer) { answer } else { wait_for(&updates, settled) };
    assert!(answer.progress.ready >= 8, "{:?}", answer.progress);
    assert_eq!(answer.members.len(), answer.progress.ready);
    for model in answer.models.iter() {
        if let ModelState::Out { reason } = &model.state {
            assert!(reason.contains("cannot be read") || reason.contains("gone"), "{reason}");
        }
    }
    // Once they are back they come in by themselves.
    std::fs::rename(&away, &data).unwrap();
    let whole = |answer: &Answer| answer.progress.ready == files.len() && settled(answer);
    let answer = if whole(&answer) { answer } else { wait_for(&updates, whole) };
    assert_eq!(answer.members.len(), files.len());
    drop(worker);
    // In the next session one of them is missing from the start.
    std::fs::remove_file(&files[0]).unwrap();
    let (_worker, updates) = spawn(setup);
    let answer = wait_for(&updates, settled);
    assert_eq!(answer.members.len(), files.len() - 1);
}

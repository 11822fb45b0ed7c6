//! What each action does to the state, and what it asks of the engine.

use std::{path::PathBuf, time::Duration};

use super::*;
use crate::{
    dataset::Role,
    query::{ModelRow, ModelState, Stage},
    workbench::{
        Filter,
        journal::{Line, Weight},
    },
};

fn model(name: &str, defects: &[&str], out: bool) -> ModelRow {
    ModelRow {
        name: name.to_owned(),
        path: PathBuf::from(name),
        class: 0,
        role: Role::Train,
        state: if out { ModelState::Out { reason: "broken".to_owned() } } else { ModelState::Waiting },
        size: None,
        defects: Arc::new(defects.iter().map(|&d| d.to_owned()).collect()),
        measure: None,
        eigenvalues: None,
    }
}

fn answer(serial: u64, settings: &Settings) -> Arc<Answer> {
    Arc::new(Answer {
        serial,
        settings: settings.clone(),
        classes: Arc::new(["human", "humanoid", "ant"].map(str::to_owned).to_vec()),
        models: Arc::new(vec![
            model("a", &[], false),
            model("b", &["a hole"], false),
            model("c", &[], true),
            model("d", &[], false),
        ]),
        ..Answer::default()
    })
}

fn opened() -> State {
    let mut state = State::new("data", Settings::default());
    let first = answer(1, &state.settings);
    update(&mut state, Action::News(Update::Answer(first)));
    state
}

fn sent(effects: &[Effect]) -> Option<&Settings> {
    match effects {
        [Effect::Send(Command::Set(settings))] => Some(settings),
        _ => None,
    }
}

fn play(state: &mut State, actions: impl IntoIterator<Item = Action>) -> Vec<Effect> {
    actions.into_iter().flat_map(|action| update(state, action)).collect()
}

#[test]
fn arrows_scroll_what_is_open_above_the_view() {
    let mut state = opened();
    state.view = View::Pipeline;
    for at in 0..3 {
        let line = Line { at: Duration::from_secs(at), weight: Weight::Note, text: format!("line {at}") };
        update(&mut state, Action::News(Update::Note(line)));
    }
    update(&mut state, Action::Journal);
    update(&mut state, Action::Down);
    assert_eq!((state.told, state.stage), (Some(1), 0));
}

#[test]
fn turning_shows_at_once_and_asks_the_engine() {
    let mut state = opened();
    let effects = play(&mut state, [Action::Choose(Parameter::Rounds), Action::Turn(1)]);
    assert_eq!(state.settings.rounds, 21);
    assert_eq!(sent(&effects), Some(&state.settings));
    let effects = update(&mut state, Action::Leap(-1));
    assert_eq!(sent(&effects).map(|settings| settings.rounds), Some(11));
}

#[test]
fn only_what_depends_on_the_turned_parameter_is_stale_and_only_until_its_answer() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::Rounds), Action::Turn(1)]);
    assert!(state.awaits(Stage::Boost) && state.awaits(Stage::Tables));
    assert!(!state.awaits(Stage::FirstK) && !state.awaits(Stage::Spectrum));
    let late = answer(2, &Settings::default());
    update(&mut state, Action::News(Update::Answer(late)));
    assert!(state.awaits(Stage::Boost));
    let right = answer(3, &state.settings);
    update(&mut state, Action::News(Update::Answer(right)));
    assert!(!state.awaits(Stage::Boost) && !state.awaits(Stage::Tables));
}

#[test]
fn an_answer_that_was_overtaken_is_dropped() {
    let mut state = opened();
    let newer = answer(7, &state.settings);
    update(&mut state, Action::News(Update::Answer(Arc::clone(&newer))));
    let older = answer(6, &state.settings);
    update(&mut state, Action::News(Update::Answer(older)));
    assert_eq!(state.answer.serial, newer.serial);
}

#[test]
fn an_end_is_said_and_sends_nothing() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::K)]);
    let effects = play(&mut state, [Action::Leap(-5), Action::Turn(-1)]);
    assert_eq!(state.settings.k, 1);
    assert!(sent(&effects).is_some(), "the first turn moved, the second did not: {effects:?}");
    assert_eq!(state.notice.as_ref().map(|notice| notice.text.as_str()), Some("k ends at 1"));
}

#[test]
fn k_stops_at_kmax() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::K), Action::Leap(1000)]);
    assert_eq!(state.settings.k, state.settings.kmax);
}

#[test]
fn words_go_round() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::Distance), Action::Turn(-1)]);
    assert_eq!(state.settings.get(Parameter::Distance), "wesd2");
    play(&mut state, [Action::Turn(1)]);
    assert_eq!(state.settings.get(Parameter::Distance), "l2");
}

#[test]
fn the_class_ends_with_the_classes() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::Class), Action::Leap(9)]);
    assert_eq!(state.class(), Some("ant"));
}

#[test]
fn undo_and_redo_send_the_settings_and_choose_the_parameter() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::Rounds), Action::Turn(1), Action::Turn(1)]);
    play(&mut state, [Action::Choose(Parameter::Distance), Action::Turn(1)]);
    let effects = update(&mut state, Action::Undo);
    assert_eq!(sent(&effects).map(|settings| settings.get(Parameter::Distance)).as_deref(), Some("l2"));
    assert_eq!(state.notice.as_ref().map(|notice| notice.text.as_str()), Some("undone: distance l2"));
    play(&mut state, [Action::Undo]);
    assert_eq!(state.settings, Settings::default());
    assert_eq!(state.parameter, Parameter::Rounds);
    assert_eq!(update(&mut state, Action::Undo), []);
    play(&mut state, [Action::Redo]);
    assert_eq!(state.settings.rounds, 22);
    play(&mut state, [Action::Redo, Action::Redo]);
    assert_eq!(state.settings.get(Parameter::Distance), "l1");
}

#[test]
fn a_run_that_comes_back_is_still_one_undo() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::Rounds), Action::Turn(1), Action::Choose(Parameter::K)]);
    play(&mut state, [Action::Choose(Parameter::Rounds), Action::Turn(1), Action::Undo]);
    assert_eq!(state.settings.rounds, 21, "choosing another parameter ends the run");
}

#[test]
fn reset_goes_back_to_the_first_values() {
    let first = Settings { rounds: 33, ..Settings::default() };
    let mut state = State::new("data", first.clone());
    play(&mut state, [Action::Choose(Parameter::Rounds), Action::Turn(4), Action::Reset]);
    assert_eq!(state.settings, first);
    play(&mut state, [Action::Turn(4), Action::Choose(Parameter::K), Action::Turn(4), Action::ResetAll]);
    assert_eq!(state.settings, first);
    assert_eq!(update(&mut state, Action::ResetAll), []);
    play(&mut state, [Action::Undo]);
    assert_eq!((state.settings.rounds, state.settings.k), (37, 14));
}

#[test]
fn a_typed_value_is_taken_or_refused_with_a_reason() {
    let mut state = opened();
    let typing = |text: &str| text.chars().map(Action::Insert).collect::<Vec<_>>();
    play(&mut state, [Action::Choose(Parameter::Rounds), Action::Edit]);
    play(&mut state, typing("5000"));
    assert_eq!(update(&mut state, Action::Commit), []);
    let entry = state.entry.as_ref().unwrap();
    assert_eq!(entry.error.as_deref(), Some("T takes a number from 1 to 1000"));
    play(&mut state, [Action::Erase]);
    let effects = update(&mut state, Action::Commit);
    assert_eq!(sent(&effects).map(|settings| settings.rounds), Some(500));
    assert_eq!(state.entry, None);
}

#[test]
fn a_class_is_typed_by_its_name() {
    let mut state = opened();
    play(&mut state, [Action::Choose(Parameter::Class), Action::Edit]);
    play(&mut state, "ant".chars().map(Action::Insert));
    play(&mut state, [Action::Commit]);
    assert_eq!(state.settings.class, 2);
}

#[test]
fn an_empty_entry_leaves_the_value() {
    let mut state = opened();
    assert_eq!(play(&mut state, [Action::Edit, Action::Commit]), []);
    assert_eq!(state.entry, None);
    assert_eq!(play(&mut state, [Action::Edit, Action::Erase]), []);
    assert_eq!(state.entry, None);
    assert_eq!(play(&mut state, [Action::Edit, Action::Insert('3'), Action::Close]), []);
    assert_eq!((state.entry.clone(), state.settings.clone()), (None, Settings::default()));
}

#[test]
fn the_list_of_models_moves_and_filters() {
    let mut state = opened();
    play(&mut state, [Action::Show(View::Models), Action::Down]);
    assert_eq!(state.model(), Some(1));
    play(&mut state, [Action::CycleFilter]);
    assert_eq!(state.models.filter, Filter::Defects);
    assert_eq!(state.model(), Some(1), "it keeps looking at the same model");
    play(&mut state, [Action::CycleFilter]);
    assert_eq!(state.model(), Some(2));
    play(&mut state, [Action::CycleFilter]);
    assert_eq!(state.models.filter, Filter::Working);
    play(&mut state, [Action::CycleFilter, Action::Last, Action::Down]);
    assert_eq!(state.model(), Some(3));
    play(&mut state, [Action::First, Action::Up]);
    assert_eq!(state.model(), Some(0));
    let gone = Arc::new(Answer { serial: 9, ..Answer::default() });
    update(&mut state, Action::News(Update::Answer(gone)));
    assert_eq!(state.model(), None);
}

#[test]
fn up_and_down_choose_parameters_elsewhere_and_go_round() {
    let mut state = opened();
    let all: Vec<_> = parameters::in_order().collect();
    state.parameter = all[0];
    update(&mut state, Action::Up);
    assert_eq!(Some(&state.parameter), all.last());
    for expected in &all {
        update(&mut state, Action::Down);
        assert_eq!(state.parameter, *expected);
    }
}

#[test]
fn classes_are_compared_and_vanish_with_their_class() {
    let mut state = opened();
    play(&mut state, [Action::Compare, Action::Choose(Parameter::Class), Action::Turn(2), Action::Compare]);
    assert_eq!(state.shown_classes(), [2, 0]);
    play(&mut state, [Action::Turn(-1)]);
    assert_eq!(state.shown_classes(), [1, 0, 2]);
    play(&mut state, [Action::Turn(1), Action::Compare]);
    assert_eq!(state.shown_classes(), [2, 0]);
    let fewer = Arc::new(Answer { serial: 9, ..Answer::default() });
    update(&mut state, Action::News(Update::Answer(fewer)));
    assert_eq!(state.shown_classes(), Vec::<usize>::new());
    update(&mut state, Action::Compare);
    assert!(state.compared.is_empty());
}

#[test]
fn solving_stops_and_goes_on_until_the_engine_is_gone() {
    let mut state = opened();
    assert_eq!(update(&mut state, Action::ToggleSolving), [Effect::Send(Command::Stop)]);
    assert!(state.stopped);
    assert_eq!(update(&mut state, Action::ToggleSolving), [Effect::Send(Command::Resume)]);
    update(&mut state, Action::News(Update::Fatal("no more".to_owned())));
    assert_eq!(update(&mut state, Action::ToggleSolving), []);
}

#[test]
fn a_notice_lasts_until_the_next_key_and_not_until_the_next_answer() {
    let mut state = opened();
    update(&mut state, Action::Undo);
    assert!(state.notice.is_some());
    let next = answer(2, &state.settings);
    update(&mut state, Action::News(Update::Answer(next)));
    assert!(state.notice.is_some());
    update(&mut state, Action::Down);
    assert_eq!(state.notice, None);
    assert_eq!(update(&mut state, Action::Rescan), [Effect::Send(Command::Rescan)]);
    assert!(state.notice.is_some());
    let found = answer(3, &state.settings);
    update(&mut state, Action::News(Update::Answer(found)));
    assert_eq!(state.notice, None, "this one only fills the time until the next answer");
}

#[test]
fn the_help_scrolls_within_its_lines() {
    let mut state = opened();
    play(&mut state, [Action::Help, Action::Up, Action::Down, Action::Down]);
    assert_eq!(state.help, Some(2));
    play(&mut state, [Action::Last]);
    assert_eq!(state.help, Some(crate::workbench::keymap::lines()));
    play(&mut state, [Action::First, Action::Help]);
    assert_eq!(state.help, None);
}

#[test]
fn views_go_round() {
    let mut state = opened();
    update(&mut state, Action::PreviousView);
    assert_eq!(state.view, View::ALL[View::ALL.len() - 1]);
    update(&mut state, Action::NextView);
    assert_eq!(state.view, View::Overview);
}

//! Every key does what its help says.

use std::{collections::HashSet, mem};

use super::*;
use crate::{
    query::{Parameter, Settings},
    workbench::{Entry, Palette, update},
};

fn state(view: View) -> State {
    State { view, ..State::new("data", Settings::default()) }
}

/// States in which between them every context holds.
fn moods() -> Vec<State> {
    let mut moods: Vec<State> = View::ALL.into_iter().map(state).collect();
    moods.push(State { help: Some(0), ..state(View::Overview) });
    moods.push(State { entry: Some(Entry::default()), ..state(View::Overview) });
    moods.push(State { palette: Some(Palette::default()), ..state(View::Overview) });
    moods.push(State { told: Some(0), ..state(View::Overview) });
    moods
}

#[test]
fn no_key_means_two_things_in_one_place() {
    // A view with a cursor of its own moves it with the arrows and opens what is under it; the wheel goes where it is.
    let arrows = [Key::Up, Key::Down, Key::Left, Key::Right, Key::Enter, Key::PageUp, Key::PageDown, Key::Home];
    let cursor = [&arrows[..], &[Key::WheelUp, Key::WheelDown]].concat();
    for state in moods() {
        let contexts = contexts(&state);
        let mut seen = HashSet::new();
        for context in &contexts {
            let mut here = HashSet::new();
            for (key, _) in bindings().iter().filter(|b| b.context == *context).flat_map(|b| &b.keys) {
                assert!(here.insert(*key), "{} has two meanings in {context:?}", key.name());
                assert!(seen.insert(*key) || cursor.contains(key), "{} has two in {contexts:?}", key.name());
            }
        }
    }
}

#[test]
fn every_binding_is_reached_by_its_keys() {
    let mut reached = HashSet::new();
    for state in moods() {
        let contexts = contexts(&state);
        for (row, binding) in bindings().iter().enumerate().filter(|(_, b)| contexts.contains(&b.context)) {
            for (key, bound) in &binding.keys {
                // What a nearer context has taken is reached elsewhere.
                if action(&state, *key).as_ref() == Some(bound) {
                    reached.insert(row);
                }
            }
        }
    }
    assert_eq!(reached.len(), bindings().len());
}

#[test]
fn every_action_of_a_key_is_bound() {
    let bound: HashSet<_> = bindings().iter().flat_map(|b| &b.keys).map(|(_, a)| mem::discriminant(a)).collect();
    let by_key = [
        Action::Quit,
        Action::Interrupt,
        Action::Suspend,
        Action::Redraw,
        Action::Help,
        Action::Close,
        Action::Show(View::Curves),
        Action::NextView,
        Action::PreviousView,
        Action::Choose(Parameter::K),
        Action::Turn(1),
        Action::Leap(1),
        Action::Edit,
        Action::Reset,
        Action::ResetAll,
        Action::Undo,
        Action::Redo,
        Action::Rescan,
        Action::ToggleSolving,
        Action::Up,
        Action::Down,
        Action::PageUp,
        Action::PageDown,
        Action::First,
        Action::Last,
        Action::ToggleAxis,
        Action::ToggleFigure,
        Action::Compare,
        Action::CompareNone,
        Action::CycleFilter,
        Action::CycleSort,
        Action::ReverseSort,
        Action::TellApart,
        Action::ListAll,
        Action::TurnMethod(1),
        Action::CycleSide,
        Action::Cell(1, 0),
        Action::NextConfusion,
        Action::ToggleOverlay,
        Action::Open,
        Action::Back,
        Action::Step(1),
        Action::Orbit(1, 0),
        Action::Approach(1),
        Action::FirstLook,
        Action::ToggleStyle,
        Action::ShowShape,
        Action::ToggleAlone,
        Action::TurnFunction(1),
        Action::WriteView,
        Action::NextEnding,
        Action::TurnFace,
        Action::StepSpectrum(1),
        Action::Switch,
        Action::SwitchOff,
        Action::WritePaper,
        Action::Journal,
        Action::ToggleMouse,
        Action::Scroll(1),
        Action::WriteRecipe,
        Action::Copy,
        Action::Restore,
        Action::NoFunction,
        Action::Palette,
        Action::Pick,
        Action::Find,
        Action::Pin,
        Action::Unpin,
        Action::Recall,
        Action::Sweep,
        Action::ToggleSweep,
        Action::Erase,
        Action::EraseAll,
        Action::Left,
        Action::Right,
        Action::Commit,
    ];
    for action in &by_key {
        assert!(bound.contains(&mem::discriminant(action)), "{action:?} has no key");
    }
    assert_eq!(bound.len(), by_key.len(), "a bound action is missing from this test");
    for view in View::ALL {
        assert!(bindings().iter().flat_map(|b| &b.keys).any(|(_, a)| *a == Action::Show(view)), "{view:?}");
    }
    for parameter in Parameter::ALL {
        assert!(bindings().iter().flat_map(|b| &b.keys).any(|(_, a)| *a == Action::Choose(parameter)));
    }
}

#[test]
fn labels_name_the_keys() {
    for binding in bindings() {
        let (first, _) = binding.keys.first().unwrap();
        let last = binding.keys.last().unwrap().0;
        assert!(binding.label.contains(&first.name().replace("Shift-", "")), "{} {}", binding.label, first.name());
        assert!(binding.label.contains(&last.name()), "{} {}", binding.label, last.name());
        assert!(!binding.about.is_empty());
    }
}

#[test]
fn digits_are_views_until_a_value_is_typed() {
    let mut state = state(View::Overview);
    assert_eq!(action(&state, Key::Char('2')), Some(Action::Show(View::Curves)));
    update(&mut state, Action::Edit);
    assert_eq!(action(&state, Key::Char('2')), Some(Action::Insert('2')));
    assert_eq!(action(&state, Key::Char('q')), Some(Action::Insert('q')));
    assert_eq!(action(&state, Key::Ctrl('c')), Some(Action::Interrupt));
    assert_eq!(action(&state, Key::F(9)), None);
}

#[test]
fn q_closes_the_help_before_it_quits() {
    let mut state = state(View::Tables);
    update(&mut state, Action::Help);
    assert_eq!(action(&state, Key::Char('q')), Some(Action::Close));
    assert_eq!(action(&state, Key::Char('Z')), None);
    update(&mut state, Action::Close);
    assert_eq!(action(&state, Key::Char('q')), Some(Action::Quit));
}

#[test]
fn hints_come_from_the_table() {
    let line = |state: &State| {
        hints(state).into_iter().map(|(keys, word)| format!("{keys} {word}")).collect::<Vec<_>>().join(" · ")
    };
    let overview = line(&state(View::Overview));
    assert_eq!(overview, "g axis · ←→ turn · ↑↓ choose · Enter type · u undo · 1–0 view · : find · ? help · q quit");
    assert_eq!(line(&moods()[10]), "↑↓ scroll · Esc close");
    assert_eq!(line(&moods()[11]), "Enter take it · Esc leave it");
}

//! Every list and table can be sorted, reversed and narrowed.

use eigenselect::{
    query::Parameter,
    workbench::{Action, State, View, keymap, lists, update},
};

use super::{LARGE, MEDIUM, compare, drawn, replies, sample};

fn at(view: View, size: (u16, u16)) -> State {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(size.0, size.1));
    update(&mut state, Action::Show(view));
    replies::served(state)
}

fn press(state: &mut State, keys: &str) {
    for key in keys.chars() {
        let key = if key == '\r' { keymap::Key::Enter } else { keymap::Key::Char(key) };
        let action = keymap::action(state, key).unwrap_or_else(|| panic!("{key:?} means nothing"));
        update(state, action);
    }
}

/// The screen without its last two lines, where the order is told.
fn body(state: &State) -> String {
    let screen = drawn(state, state.size);
    let lines: Vec<&str> = screen.lines().collect();
    lines[..lines.len() - 2].join("\n")
}

#[test]
fn every_list_can_be_sorted_and_reversed() {
    let listing = [
        View::Overview,
        View::Tables,
        View::Selection,
        View::Pipeline,
        View::Confusion,
        View::Neighbours,
        View::Models,
    ];
    for view in listing {
        let mut state = at(view, LARGE);
        let first = body(&state);
        press(&mut state, "V");
        assert_ne!(body(&state), first, "{view:?} reversed");
        press(&mut state, "V");
        assert_eq!(body(&state), first, "{view:?} and back");
        let columns = if view == View::Models { 5 } else { lists::columns(&state).len() };
        let mut orders = vec![first.clone()];
        for _ in 1..columns {
            press(&mut state, "v");
            orders.push(body(&state));
        }
        press(&mut state, "v");
        assert_eq!(body(&state), first, "{view:?} goes round");
        orders.sort();
        orders.dedup();
        assert!(orders.len() > 1, "{view:?} has {} orders", orders.len());
    }
}

#[test]
fn every_list_can_be_narrowed_by_typing() {
    for (view, typed, stays, goes) in [
        (View::Tables, "ada", "AdaBoost", "first-k  "),
        (View::Pipeline, "cache", "the cache at", "passed over"),
        (View::Confusion, "cup", "Cup → ", "Human → Glasses"),
        (View::Neighbours, "vase", "Vase", "Mechanic"),
        (View::Models, "vase", "Vase", "Mechanic"),
    ] {
        let mut state = at(view, MEDIUM);
        press(&mut state, &format!("/{typed}\r"));
        assert_eq!(state.view, view);
        let list = |state: &State| {
            let panel = if view == View::Confusion || view == View::Neighbours { 34 } else { 0 };
            drawn(state, LARGE)
                .lines()
                .map(|l| l.chars().skip(panel).collect::<String>())
                .collect::<Vec<_>>()
                .join("\n")
        };
        assert!(list(&state).contains(stays), "{view:?}\n{}", list(&state));
        assert!(drawn(&state, MEDIUM).contains(&format!("\"{typed}\"")), "{view:?} says what it lists");
        if view != View::Confusion {
            assert!(!list(&state).contains(goes), "{view:?}\n{}", list(&state));
        }
    }
    let mut state = at(View::Curves, MEDIUM);
    press(&mut state, "/vase");
    assert_eq!(state.view, View::Models, "where there is no list models are found");
}

#[test]
fn the_cursor_goes_along_the_order_shown() {
    let mut state = at(View::Neighbours, MEDIUM);
    press(&mut state, "/vase\r");
    update(&mut state, Action::First);
    let classes: Vec<_> = (0..4)
        .map(|_| {
            let rank = state.why.neighbour;
            update(&mut state, Action::Down);
            rank
        })
        .collect();
    assert!(classes.is_sorted() && classes[0] < classes[3], "{classes:?}: ranks of vases alone");
    update(&mut state, Action::Open);
    let model = state.model().map(|model| state.answer.models[model].class);
    assert_eq!(model.map(|class| state.class_name(class as usize).to_owned()), Some("Vase".to_owned()));
    // Pins, the best first.
    let mut state = at(View::Compare, MEDIUM);
    update(&mut state, Action::Pin);
    update(&mut state, Action::Set(Parameter::K, "3".to_owned()));
    update(&mut state, Action::Pin);
    assert_eq!(lists::pinned(&state), [0, 1]);
    press(&mut state, "V");
    assert_eq!(lists::pinned(&state), [1, 0]);
}

#[test]
fn from_a_wrong_cell_to_what_tells_its_classes_apart() {
    let mut state = at(View::Confusion, MEDIUM);
    assert!(drawn(&state, MEDIUM).contains("most often wrong: "));
    press(&mut state, ".");
    let (truth, decided) = state.why.cell;
    press(&mut state, "a");
    assert_eq!((state.view, state.settings.class, state.opposed()), (View::Selection, truth, Some(decided)));
    let state = replies::served(state);
    compare("Apart-120x40", &drawn(&state, MEDIUM));
    // The meaning of the signs is shortened, and no word of it cut, where there is little room.
    assert!(drawn(&state, (80, 24)).lines().any(|line| line.contains("+ greater, − smaller") && !line.contains('…')));
    let mut state = state;
    update(&mut state, Action::Back);
    assert_eq!(state.view, View::Confusion);
}

//! What a click does, wherever something can be clicked.

use eigenselect::{
    query::Parameter,
    ui::{self, Look},
    workbench::{Action, State, View, experiment::Face, update},
};
use unicode_width::UnicodeWidthStr;

use super::{MEDIUM, SMALL, drawn, experiment, replies, sample, shown};

fn begin(view: View, size: (u16, u16)) -> State {
    let mut state = sample::state(sample::full());
    update(&mut state, Action::Resize(size.0, size.1));
    shown(state, view)
}

fn at(state: &mut State, place: (u16, u16)) -> Vec<Action> {
    let clicked = ui::clicked(state, Look::default(), place);
    clicked.iter().cloned().for_each(|action| drop(update(state, action)));
    clicked
}

/// Clicks on the first place where the screen has this text.
fn click(state: &mut State, text: &str) {
    let screen = drawn(state, state.size);
    let found = screen.lines().enumerate().find_map(|(row, line)| Some((row, line[..line.find(text)?].width())));
    let (row, column) = found.unwrap_or_else(|| panic!("no {text:?} on\n{screen}"));
    at(state, (column as u16, row as u16));
}

#[test]
fn tabs_parameters_rows_and_spectra_can_be_clicked() {
    let mut state = begin(View::Overview, MEDIUM);
    click(&mut state, "Confusion");
    assert_eq!(state.view, View::Confusion);
    click(&mut state, "distance");
    assert_eq!((state.parameter, state.entry.is_some()), (Parameter::Distance, false));
    click(&mut state, "distance");
    assert!(state.entry.is_some(), "a second click is for the value");

    let mut state = begin(View::Models, MEDIUM);
    let (before, row) = (state.model(), (60, 8));
    let clicked = at(&mut state, row);
    assert!(matches!(clicked[..], [Action::Scroll(by)] if by > 0), "{clicked:?}");
    assert_ne!(state.model(), before);
    assert_eq!(at(&mut state, row), [Action::Open], "the row of the cursor is opened");
    let mut state = replies::served(state);
    update(&mut state, Action::Scroll(2));
    assert_eq!((state.view, state.why.neighbour), (View::Neighbours, 2));

    let mut state = experiment::faced(Face::Spectra, MEDIUM);
    click(&mut state, "c original cot");
    assert!(state.experiment.on.contains(&2));
    click(&mut state, "c original cot");
    assert!(!state.experiment.on.contains(&2));
}

#[test]
fn what_is_open_above_the_view_is_clicked_and_not_what_it_covers() {
    let mut state = begin(View::Overview, SMALL);
    update(&mut state, Action::Palette);
    "undo the last".chars().for_each(|c| drop(update(&mut state, Action::Insert(c))));
    click(&mut state, "undo the last change");
    assert!(state.palette.is_none() && state.notice.is_some_and(|notice| notice.text == "nothing to undo"));
}

#[test]
fn no_click_does_harm() {
    for view in View::ALL {
        for size in [(20, 5), (44, 14), SMALL] {
            let state = begin(view, size);
            for place in (0..90).step_by(9).flat_map(|column| (0..26).step_by(2).map(move |row| (column, row))) {
                at(&mut state.clone(), place);
            }
        }
    }
}

//! Going from a figure to the models behind it, and back.

use std::sync::Arc;

use super::{
    Action, Answered, Effect, Figure, Filter, Only, Sort, State, Sweep, View, Why, lists, pins, shape::Camera, update,
    why::Matrix,
};
use crate::{
    query::{Finding, Parameter, Question, Settings, Stage},
    study::Method,
};

/// So many steps back are remembered.
const TRAIL: usize = 100;

/// What only the views that list and explain understand.
pub(super) fn look(state: &mut State, action: &Action) {
    let classes = state.answer.classes.len();
    match action {
        Action::CycleFilter => change(state, |list| list.filter = list.filter.next()),
        Action::CycleSort => lists::cycle(state, false),
        Action::ReverseSort => lists::cycle(state, true),
        Action::ListAll => {
            change(state, |list| (list.filter, list.only, list.needle) = Default::default());
        }
        Action::TurnMethod(by) => {
            state.why.method = state.why.method.turned(*by);
            state.why.neighbour = 0;
        }
        Action::CycleSide => state.why.side = state.why.side.next(),
        Action::ToggleOverlay => state.why.overlaid = !state.why.overlaid,
        Action::Cell(down, right) => state.why.shift(*down, *right, classes),
        Action::NextConfusion => next_confusion(state),
        Action::Orbit(right, up) => state.camera.turn(*right, *up),
        Action::Approach(steps) => state.camera.approach(*steps),
        Action::FirstLook => state.camera = Camera::default(),
        Action::TurnFunction(by) => turn_function(state, *by),
        Action::Eigenfunction(index) => state.function = Some((*index).clamp(1, state.settings.kmax)),
        Action::NoFunction => state.function = None,
        Action::Find => lists::begin_to_find(state),
        Action::LookAt(model) => look_at(state, *model),
        Action::Pin | Action::Unpin | Action::Sweep | Action::ToggleSweep => compare(state, action),
        Action::ToggleStyle => state.style = state.style.turned(state.styles),
        Action::ToggleAlone => state.alone = !state.alone,
        Action::ShowShape => {
            remember(state);
            update::show(state, View::Shape);
        }
        Action::Open => open(state),
        Action::Back => back(state),
        Action::Step(by) => {
            let answer = Arc::clone(&state.answer);
            state.models.shift(*by, &answer);
            state.why.neighbour = 0;
        }
        _ => {}
    }
}

fn look_at(state: &mut State, model: usize) {
    remember(state);
    let answer = Arc::clone(&state.answer);
    state.models.look_at(model, &answer);
    state.why.neighbour = 0;
    if !matches!(state.view, View::Neighbours | View::Shape) {
        update::show(state, View::Neighbours);
    }
}

fn compare(state: &mut State, action: &Action) {
    match action {
        Action::Pin => {
            let said = pins::pin(state).map(|letter| format!("these settings are pin {letter}; 0 compares"));
            update::say(state, said.unwrap_or_else(|reason| reason));
        }
        Action::Unpin if !state.pins.is_empty() => {
            let at = state.pin.min(state.pins.len() - 1);
            state.pins.remove(at);
        }
        Action::Sweep => {
            state.sweep = Some(Sweep::over(state.parameter, &state.settings, state.answer.classes.len()));
            state.why.swept = true;
            // The method that the parameter says something of.
            state.why.method = match state.parameter {
                Parameter::Rounds => Method::Boost,
                Parameter::K => Method::FirstK,
                _ => state.why.method,
            };
            update::show(state, View::Compare);
        }
        Action::ToggleSweep => state.why.swept = !state.why.swept,
        _ => {}
    }
}

/// The first eigenfunction shown is that of the first eigenvalue selected that is not 0.
fn turn_function(state: &mut State, by: isize) {
    let selected = || state.answer.climb_error.value.as_ref()?.climb.selected.iter().copied().find(|&index| index > 1);
    state.function = match state.function {
        None => Some(selected().unwrap_or(2) as usize),
        Some(index) => Some(index.saturating_add_signed(by).clamp(1, state.settings.kmax)),
    };
}

pub(super) fn change(state: &mut State, change: impl FnOnce(&mut super::ModelList)) {
    let answer = Arc::clone(&state.answer);
    state.models.change(&answer, change);
}

/// Forgets everything that names models by their place.
pub(super) fn forget(state: &mut State) {
    state.replies.clear();
    state.pictures.clear();
    state.looked_for.clear();
    state.scenes.clear();
    state.trail.clear();
    state.models.only = None;
    state.why = Why { neighbour: 0, ..state.why };
    // The same questions mean other models now.
    state.asked.clear();
}

/// Remembers the view and its model, to come back to.
fn remember(state: &mut State) {
    if state.trail.len() == TRAIL {
        state.trail.remove(0);
    }
    let here = (state.view, state.model());
    state.trail.push(here);
}

fn back(state: &mut State) {
    let Some((view, model)) = state.trail.pop() else { return };
    if let Some(model) = model {
        let answer = Arc::clone(&state.answer);
        state.models.look_at(model, &answer);
    }
    state.why.neighbour = 0;
    update::show(state, view);
}

/// The decisions shown, with the place of the model of each.
fn decisions(state: &State) -> Option<(&crate::study::why::Decisions, &[usize])> {
    match state.answered(&Question::Decisions(state.why.method)) {
        Answered::Found(Finding::Decisions(decisions), places, _) => Some((decisions, places)),
        _ => None,
    }
}

fn next_confusion(state: &mut State) {
    let Some((decisions, places)) = decisions(state) else { return };
    let worst = Matrix::new(state.why.side, &state.answer, decisions, places).worst;
    let at = worst.iter().position(|&(truth, decided, _)| (truth, decided) == state.why.cell);
    let next = at.map_or(0, |at| at + 1) % worst.len().max(1);
    if let Some(&(truth, decided, _)) = worst.get(next) {
        state.why.cell = (truth, decided);
    }
}

fn open(state: &mut State) {
    match state.view {
        View::Confusion => open_cell(state),
        View::Models if state.model().is_some() => {
            remember(state);
            state.why.neighbour = 0;
            update::show(state, View::Neighbours);
        }
        View::Neighbours => open_neighbour(state),
        View::Pipeline => open_stage(state),
        _ => {}
    }
}

/// What a stage makes: the models behind the first stages, the slowest first or those that are not there; else the view
/// of its values.
fn open_stage(state: &mut State) {
    let Some(row) = state.answer.stages.get(state.stage).copied() else { return };
    remember(state);
    let view = match row.stage {
        Stage::Content | Stage::Survey | Stage::Spectrum => {
            change(state, |list| {
                (list.only, list.needle) = Default::default();
                list.filter = match (row.failed, row.stale) {
                    (1.., _) => Filter::Out,
                    (0, 1..) => Filter::Working,
                    (0, 0) => Filter::All,
                };
                list.sort = Sort::Time;
            });
            state.models.at = 0;
            View::Models
        }
        Stage::FirstK => View::Curves,
        Stage::Tables => View::Tables,
        Stage::Features | Stage::ClimbError | Stage::ClimbAdr | Stage::Boost => {
            state.figure = match row.stage {
                Stage::Features => Figure::Shared,
                Stage::Boost => Figure::Map,
                _ => Figure::Climb,
            };
            View::Selection
        }
    };
    update::show(state, view);
}

/// From a cell of the confusion matrix to the eigenvalues that tell its two classes apart.
pub(super) fn tell_apart(state: &mut State) -> Vec<Effect> {
    let (truth, decided) = state.why.cell;
    if truth == decided || truth.max(decided) >= state.answer.classes.len() {
        update::say(state, "move to a cell of two classes: . goes to the fullest");
        return Vec::new();
    }
    remember(state);
    state.compared = [decided].into();
    state.figure = Figure::Shared;
    update::show(state, View::Selection);
    let next = Settings { class: truth, ..state.settings.clone() };
    update::adopt(state, next, None)
}

fn open_cell(state: &mut State) {
    let Some((decisions, places)) = decisions(state) else { return };
    let models = state.why.models(&state.answer, decisions, places);
    if models.is_empty() {
        update::say(state, "no models in this cell");
        return;
    }
    let class = |class: usize| state.answer.classes.get(class).map_or("", String::as_str);
    let (truth, decided) = state.why.cell;
    let label = if truth == decided {
        format!("{} recognised by {}", class(truth), state.why.method.name())
    } else {
        format!("{} taken for {} by {}", class(truth), class(decided), state.why.method.name())
    };
    remember(state);
    let first = models.first().copied();
    change(state, |list| {
        (list.filter, list.needle) = Default::default();
        list.only = Some(Only { label, models });
    });
    if let Some(first) = first {
        let answer = Arc::clone(&state.answer);
        state.models.look_at(first, &answer);
    }
    update::show(state, View::Models);
}

/// The neighbours shown: how many there are, and the place of the model of each.
pub(super) fn neighbours(state: &State) -> Option<(usize, Vec<usize>)> {
    let model = state.model()?;
    let Answered::Found(finding, places, _) = state.answered(&Question::Reasons { method: state.why.method, model })
    else {
        return None;
    };
    match finding {
        Finding::Neighbours(found) => {
            let models: Vec<usize> = found.found.iter().filter_map(|n| places.get(n.model).copied()).collect();
            Some((models.len(), models))
        }
        Finding::Votes(votes) => Some((votes.votes.len(), Vec::new())),
        _ => None,
    }
}

pub(super) fn shift_neighbour(state: &mut State, by: isize) {
    let listed = listed_neighbours(state);
    let at = listed.iter().position(|rank| *rank == state.why.neighbour).unwrap_or(0);
    let next = at.saturating_add_signed(by).min(listed.len().saturating_sub(1));
    state.why.neighbour = listed.get(next).copied().unwrap_or(0);
}

/// The ranks of the neighbours, or of the classes for AdaBoost, in the order in which they are listed.
fn listed_neighbours(state: &State) -> Vec<usize> {
    let Some(model) = state.model() else { return Vec::new() };
    match state.answered(&Question::Reasons { method: state.why.method, model }) {
        Answered::Found(Finding::Neighbours(found), places, _) => lists::ranks(state, found, places),
        Answered::Found(Finding::Votes(votes), ..) => lists::voted(state, votes),
        _ => Vec::new(),
    }
}

fn open_neighbour(state: &mut State) {
    let Some((_, models)) = neighbours(state) else { return };
    let Some(&model) = models.get(state.why.neighbour.min(models.len().saturating_sub(1))) else { return };
    remember(state);
    let answer = Arc::clone(&state.answer);
    state.models.look_at(model, &answer);
    state.why.neighbour = 0;
}

//! The only place where the state changes.

use std::sync::Arc;

use super::{
    Action, Change, Command, Effect, Entry, Figure, Leave, Mouse, Notice, Palette, Purpose, State, Update, View,
    asking, experiment, explore, leave, lists, palette, parameters, pins,
};
use crate::query::{Answer, Parameter, Settings};

/// Lets an action happen. Returns what must now happen outside; never waits.
pub fn update(state: &mut State, action: Action) -> Vec<Effect> {
    let mut effects = happen(state, action);
    // What the screen wants to know follows from what it shows.
    let questions = asking::questions(state);
    if questions != state.asked {
        state.asked.clone_from(&questions);
        effects.push(Effect::Send(Command::Ask(questions)));
    }
    let surfaces = asking::surfaces(state);
    if !surfaces.is_empty() {
        state.looked_for.extend(surfaces.iter().cloned());
        effects.push(Effect::Send(Command::Look(surfaces)));
    }
    let untried = pins::untried(state);
    if untried != state.tried {
        // What has come in meanwhile makes the list shorter, and nothing need be said.
        let known = untried.iter().all(|settings| state.tried.contains(settings));
        state.tried.clone_from(&untried);
        if !known {
            effects.push(Effect::Send(Command::Try(untried)));
        }
    }
    let scenes = asking::scenes(state);
    if scenes != state.scenes {
        let missing: Vec<_> = scenes.iter().filter(|scene| !state.pictures.has(scene)).cloned().collect();
        state.scenes = scenes;
        effects.push(Effect::Send(Command::Paint(missing)));
    }
    effects
}

fn happen(state: &mut State, action: Action) -> Vec<Effect> {
    if !matches!(action, Action::News(_) | Action::Resize(..) | Action::Pictures(_) | Action::Report(_)) {
        state.notice = None;
    }
    match action {
        Action::Quit => return vec![Effect::Leave(Leave::Quit)],
        Action::Interrupt => return vec![Effect::Leave(Leave::Interrupt)],
        Action::Suspend => return vec![Effect::Suspend],
        Action::Redraw => return vec![Effect::Redraw],
        Action::Rescan => {
            state.notice = Some(Notice { text: "looking at the files again".to_owned(), bad: false, brief: true });
            return vec![Effect::Send(Command::Rescan)];
        }
        Action::ToggleSolving => return toggle_solving(state),
        Action::Choose(parameter) => choose(state, parameter),
        Action::Turn(by) => return turn(state, by * parameters::steps(state.parameter).0),
        Action::Leap(by) => return turn(state, by * parameters::steps(state.parameter).1),
        Action::Reset => return reset(state),
        Action::ResetAll => {
            let first = state.first.clone();
            return adopt(state, first, None);
        }
        Action::Undo => return travel(state, true),
        Action::Redo => return travel(state, false),
        Action::Commit => return commit(state),
        Action::News(news) => return hear(state, news),
        Action::Switch => return experiment::switch(state),
        Action::SwitchOff => return experiment::switch_off(state),
        Action::WritePaper => return experiment::document(state),
        Action::ToggleMouse => {
            state.mouse = if state.mouse == Mouse::Screen { Mouse::Terminal } else { Mouse::Screen };
            let ours = state.mouse == Mouse::Screen;
            let selects = "the mouse is listened to: wheel and click; most terminals select text with Shift";
            say(state, if ours { selects } else { "the mouse belongs to the terminal" });
            return vec![Effect::Mouse(ours)];
        }
        Action::WriteView => {
            let proposed = leave::proposed(state);
            leave::name(state, &proposed);
        }
        Action::NextEnding => leave::next_ending(state),
        Action::WriteRecipe => leave::name(state, "eigenselect.toml"),
        Action::Copy => return leave::copy(state),
        Action::Restore => return leave::restore(state),
        Action::Palette => state.palette = Some(Palette::default()),
        Action::Pick => return pick(state),
        Action::Set(parameter, value) => return set(state, parameter, &value),
        Action::TellApart => return explore::tell_apart(state),
        Action::Recall => return recall(state),
        Action::Report(text) => state.notice = Some(Notice { text, bad: true, brief: false }),
        Action::Resize(columns, rows) => state.size = (columns, rows),
        Action::Pictures(raster) => state.take_pictures(raster),
        Action::Insert(_) | Action::Erase | Action::EraseAll | Action::Left | Action::Right => typed(state, &action),
        Action::Edit => {
            state.purpose = Purpose::Value;
            state.entry = Some(Entry::default());
        }
        other => look(state, &other),
    }
    Vec::new()
}

/// Takes in what the engine tells.
fn hear(state: &mut State, news: Update) -> Vec<Effect> {
    match news {
        Update::Answer(answer) => receive(state, answer),
        Update::Reply(reply) => {
            state.looked_for.retain(|question| *question != reply.question);
            state.replies.take(reply);
            pins::complete(state);
        }
        Update::Rescanned => {
            state.changed = Some(Change::of_files());
            state.replies.clear_surfaces();
            state.looked_for.clear();
            return experiment::vary_again(state);
        }
        Update::Trial(trial) => pins::take(state, &trial),
        Update::Trying(settings, done, total) => state.experiment.trying = Some((settings, done, total)),
        Update::Paper(told) => experiment::told(state, told),
        Update::Varying(subject, done) => experiment::varying(state, &subject, done),
        Update::Varied(varied) => experiment::varied(state, varied),
        Update::Note(line) => state.journal.take(line),
        Update::Written(path, outcome) => leave::told(state, &path, outcome),
        // A picture of a scene that is no longer wanted would replace a newer one.
        Update::Picture(scene, picture) if state.scenes.contains(&scene) => state.pictures.take(scene, picture),
        Update::Picture(..) => {}
        Update::Fatal(reason) => state.fatal = Some(reason),
    }
    Vec::new()
}

/// What changes only how the state is looked at.
fn look(state: &mut State, action: &Action) {
    match action {
        Action::Help => state.help = if state.help.is_some() { None } else { Some(0) },
        Action::Journal => state.told = if state.told.is_some() { None } else { Some(0) },
        Action::TurnFace => state.experiment.face = state.experiment.face.next(),
        Action::StepSpectrum(by) => experiment::step(state, *by),
        Action::Close => {
            if state.entry.is_some() && state.purpose == Purpose::Needle {
                lists::find(state, String::new());
            }
            state.help = None;
            state.told = None;
            state.entry = None;
            state.palette = None;
        }
        Action::Show(view) => show(state, *view),
        Action::NextView => show(state, state.view.turned(1)),
        Action::PreviousView => show(state, state.view.turned(-1)),
        Action::ToggleAxis => state.logarithmic = !state.logarithmic,
        Action::ToggleFigure => {
            state.figure = match state.figure {
                Figure::Map => Figure::Marks,
                Figure::Marks => Figure::Climb,
                Figure::Climb => Figure::Shared,
                Figure::Shared => Figure::Map,
            }
        }
        Action::Compare => {
            let class = state.settings.class;
            if !state.compared.remove(&class) && class < state.answer.classes.len() {
                state.compared.insert(class);
            }
        }
        Action::CompareNone => state.compared.clear(),
        Action::Up => step(state, -1),
        Action::Down => step(state, 1),
        Action::Scroll(by) => scroll(state, *by),
        Action::PageUp => page(state, -1),
        Action::PageDown => page(state, 1),
        Action::First => scroll(state, -(isize::MAX / 2)),
        Action::Last => scroll(state, isize::MAX / 2),
        other => explore::look(state, other),
    }
}

pub(super) fn say(state: &mut State, text: impl Into<String>) {
    state.notice = Some(Notice { text: text.into(), bad: false, brief: false });
}

fn toggle_solving(state: &mut State) -> Vec<Effect> {
    if state.fatal.is_some() {
        return Vec::new();
    }
    state.stopped = !state.stopped;
    vec![Effect::Send(if state.stopped { Command::Stop } else { Command::Resume })]
}

pub(super) fn show(state: &mut State, view: View) {
    if state.view != view {
        state.view = view;
        state.scroll = 0;
    }
}

fn choose(state: &mut State, parameter: Parameter) {
    if state.parameter != parameter {
        state.parameter = parameter;
        state.history.pause();
    }
}

/// One line up or down: in what is open above the view, in its list, else in the panel of parameters.
fn step(state: &mut State, by: isize) {
    let open = state.help.is_some() || state.told.is_some() || state.palette.is_some();
    if state.view == View::Pipeline && !open {
        let listed = lists::stages(state);
        let at = listed.iter().position(|place| *place == state.stage).unwrap_or(0);
        let next = at.saturating_add_signed(by).min(listed.len().saturating_sub(1));
        state.stage = listed.get(next).copied().unwrap_or(0);
        return;
    }
    if open || matches!(state.view, View::Models | View::Neighbours | View::Compare) {
        scroll(state, by);
        return;
    }
    let order: Vec<Parameter> = parameters::in_order().collect();
    let at = order.iter().position(|parameter| *parameter == state.parameter).unwrap_or(0) as isize;
    choose(state, order[(at + by).rem_euclid(order.len() as isize) as usize]);
}

fn page(state: &mut State, by: isize) {
    let rows = isize::try_from(state.size.1).unwrap_or(24);
    scroll(state, by * (rows / 2 - 3).max(1));
}

fn scroll(state: &mut State, by: isize) {
    if state.palette.is_some() {
        let last = palette::picks(state).len().saturating_sub(1);
        if let Some(palette) = &mut state.palette {
            palette.at = palette.at.saturating_add_signed(by).min(last);
        }
    } else if let Some(line) = &mut state.help {
        *line = line.saturating_add_signed(by).min(super::keymap::lines());
    } else if let Some(line) = &mut state.told {
        *line = line.saturating_add_signed(by).min(state.journal.len());
    } else if state.view == View::Models {
        let answer = Arc::clone(&state.answer);
        state.models.shift(by, &answer);
    } else if state.view == View::Neighbours {
        explore::shift_neighbour(state, by);
    } else if state.view == View::Compare {
        let listed = lists::pinned(state);
        let at = listed.iter().position(|place| *place == state.pin).unwrap_or(0);
        let next = at.saturating_add_signed(by).min(listed.len().saturating_sub(1));
        state.pin = listed.get(next).copied().unwrap_or(0);
    } else {
        state.scroll = state.scroll.saturating_add_signed(by).min(furthest(state));
    }
}

/// No view has more lines than this; a view that ends earlier stops there by itself.
fn furthest(state: &State) -> usize {
    match state.view {
        View::Tables => {
            let rows = |rows: usize| rows * (1 + state.pins.len()) + 4;
            state.answer.tables.value.iter().flat_map(|t| t.iter()).map(|t| rows(t.rows.len())).sum()
        }
        View::Pipeline => state.answer.warnings.len(),
        View::Selection => state.answer.marks.value.iter().flat_map(|m| m.iter()).map(Vec::len).max().unwrap_or(0),
        View::Overview
        | View::Curves
        | View::Models
        | View::Confusion
        | View::Neighbours
        | View::Shape
        | View::Compare => 0,
    }
}

fn turn(state: &mut State, steps: isize) -> Vec<Effect> {
    let classes = state.answer.classes.len();
    let parameter = state.parameter;
    let mut next = state.settings.clone();
    next.step(parameter, steps, classes);
    if parameter == Parameter::K {
        // Beyond kmax there is nothing to read off. A k that is beyond it already may still be turned down.
        next.k = next.k.min(state.settings.kmax);
    }
    let turned = next != state.settings;
    if !turned && parameter.choices().is_empty() {
        let (least, greatest) = parameters::range(parameter, &state.settings, classes);
        let end = if steps < 0 { least } else { greatest };
        say(state, format!("{} ends at {end}", parameter.name()));
    }
    adopt(state, next, Some(parameter))
}

fn reset(state: &mut State) -> Vec<Effect> {
    let mut next = state.settings.clone();
    let first = state.first.get(state.parameter);
    if next.set(state.parameter, &first, state.answer.classes.len()).is_err() {
        return Vec::new();
    }
    adopt(state, next, None)
}

/// Takes new settings as the ones on the screen, and asks the engine for them.
pub(super) fn adopt(state: &mut State, next: Settings, turned: Option<Parameter>) -> Vec<Effect> {
    if next == state.settings {
        return Vec::new();
    }
    state.history.remember(&state.settings, turned);
    state.changed = Some(Change::between(&state.settings, &next));
    state.settings = next.clone();
    vec![Effect::Send(Command::Set(next))]
}

fn travel(state: &mut State, back: bool) -> Vec<Effect> {
    let settings = state.settings.clone();
    let found = if back { state.history.undo(&settings) } else { state.history.redo(&settings) };
    let Some(next) = found else {
        say(state, if back { "nothing to undo" } else { "nothing to redo" });
        return Vec::new();
    };
    let changed: Vec<String> = Parameter::ALL
        .into_iter()
        .filter(|parameter| next.get(*parameter) != settings.get(*parameter))
        .map(|parameter| format!("{} {}", parameter.name(), next.get(parameter)))
        .collect();
    if let [_] = changed[..]
        && let Some(only) = Parameter::ALL.into_iter().find(|p| next.get(*p) != settings.get(*p))
    {
        state.parameter = only;
    }
    let word = if back { "undone" } else { "redone" };
    say(state, format!("{word}: {}", changed.join(", ")));
    state.changed = Some(Change::between(&state.settings, &next));
    state.settings = next.clone();
    vec![Effect::Send(Command::Set(next))]
}

fn typed(state: &mut State, action: &Action) {
    let entry = match (&mut state.palette, &mut state.entry) {
        (Some(palette), _) => {
            palette.at = 0;
            &mut palette.entry
        }
        (None, Some(entry)) => entry,
        (None, None) => return,
    };
    match action {
        Action::Insert(character) => entry.insert(*character),
        Action::Erase => {
            let erased = entry.erase();
            if !erased && entry.text().is_empty() {
                state.entry = None;
                state.palette = None;
                return;
            }
        }
        Action::EraseAll => entry.erase_all(),
        Action::Left => entry.shift(-1),
        Action::Right => entry.shift(1),
        _ => {}
    }
    if let Some(entry) = state.entry.as_ref().filter(|_| state.purpose == Purpose::Needle) {
        let needle = entry.text();
        lists::find(state, needle);
    }
}

fn commit(state: &mut State) -> Vec<Effect> {
    let Some(entry) = &mut state.entry else { return Vec::new() };
    let text = entry.text();
    match state.purpose {
        Purpose::Needle => {
            state.entry = None;
            return Vec::new();
        }
        Purpose::File if !text.trim().is_empty() => return leave::write(state, text.trim()),
        Purpose::Folder if !text.trim().is_empty() => return experiment::begin(state, text.trim()),
        Purpose::File | Purpose::Folder | Purpose::Value => {}
    }
    if text.trim().is_empty() {
        state.entry = None;
        return Vec::new();
    }
    let mut next = state.settings.clone();
    let set = parameters::parse(state.parameter, &text, &state.settings, &state.answer.classes)
        .and_then(|value| next.set(state.parameter, &value, state.answer.classes.len()));
    match set {
        Ok(()) => {
            state.entry = None;
            adopt(state, next, None)
        }
        Err(message) => {
            entry.error = Some(message);
            Vec::new()
        }
    }
}

/// Lets everything happen that the palette's line stands for.
fn pick(state: &mut State) -> Vec<Effect> {
    let picks = palette::picks(state);
    let Some(open) = state.palette.take() else { return Vec::new() };
    let pick = picks.into_iter().nth(open.at);
    pick.map_or_else(Vec::new, |pick| pick.does.into_iter().flat_map(|action| happen(state, action)).collect())
}

fn set(state: &mut State, parameter: Parameter, value: &str) -> Vec<Effect> {
    let mut next = state.settings.clone();
    match next.set(parameter, value, state.answer.classes.len()) {
        Ok(()) => adopt(state, next, None),
        Err(reason) => {
            say(state, reason);
            Vec::new()
        }
    }
}

fn recall(state: &mut State) -> Vec<Effect> {
    let Some(pin) = state.pins.get(state.pin.min(state.pins.len().saturating_sub(1))) else { return Vec::new() };
    let (letter, settings) = (pin.letter, pin.settings.clone());
    say(state, format!("the settings of pin {letter}; u undoes"));
    adopt(state, settings, None)
}

fn receive(state: &mut State, answer: Arc<Answer>) {
    // An answer that was overtaken on its way says nothing new.
    if answer.serial < state.answer.serial {
        return;
    }
    // Answers name models by their place, which must still be theirs.
    let places = |answer: &Answer| answer.models.iter().map(|model| model.path.clone()).collect::<Vec<_>>();
    if state.answer.models.len() != answer.models.len() || places(&state.answer) != places(&answer) {
        explore::forget(state);
    }
    state.answer = answer;
    state.notice.take_if(|notice| notice.brief);
    let classes = state.answer.classes.len();
    state.compared.retain(|class| *class < classes);
    state.scroll = state.scroll.min(furthest(state));
}

#[cfg(test)]
mod tests;

//! Leaving with results: what is written to files, copied, and kept for the next session.

use super::{
    Command, Content, Effect, Entry, Notice, Purpose, State,
    export::{self, Written},
    recipe, update,
};

/// The most bytes that are copied: many terminals take no more at once.
const COPIED: usize = 74_000;

/// Begins to type the name of a file.
pub(super) fn name(state: &mut State, proposed: &str) {
    state.purpose = Purpose::File;
    state.entry = Some(Entry::of(proposed));
}

/// The name proposed for what the view shows.
pub(super) fn proposed(state: &State) -> String {
    format!("{}.csv", state.view.name().to_lowercase())
}

/// Turns the ending of the name being typed to the next one.
pub(super) fn next_ending(state: &mut State) {
    if let Some(entry) = state.entry.as_mut().filter(|_| state.purpose == Purpose::File) {
        *entry = Entry::of(&export::next_ending(&entry.text()));
    }
}

/// What is to be written under a name: a recipe, or what the view shows.
fn content(state: &State, name: &str) -> Result<Content, String> {
    if name.to_ascii_lowercase().ends_with(".toml") {
        return recipe::write(state).map(Content::Text);
    }
    Ok(match Written::of(name)? {
        Written::Table(format) => Content::Text(export::table(state)?.write(format)),
        Written::Svg => Content::Svg(Box::new(export::drawing(state)?)),
        Written::Png => Content::Png(Box::new(export::drawing(state)?)),
    })
}

/// Writes the file whose name was typed.
pub(super) fn write(state: &mut State, name: &str) -> Vec<Effect> {
    match content(state, name) {
        Ok(content) => {
            state.entry = None;
            // What this session wrote may be written again; what was there before is left alone.
            let overwrite = !state.written.insert(name.to_owned());
            vec![Effect::Send(Command::Write { path: name.into(), content, overwrite })]
        }
        Err(reason) => {
            if let Some(entry) = &mut state.entry {
                entry.error = Some(reason);
            }
            Vec::new()
        }
    }
}

/// A file was written, or why it could not be.
pub(super) fn told(state: &mut State, path: &std::path::Path, outcome: Result<(), String>) {
    let shown = path.display();
    let (text, bad) = match outcome {
        Ok(()) => (format!("{shown} is written"), false),
        Err(reason) => {
            state.written.remove(&*path.to_string_lossy());
            (format!("{shown}: {reason}"), true)
        }
    };
    notice(state, text, bad);
}

pub(super) fn notice(state: &mut State, text: String, bad: bool) {
    state.notice = Some(Notice { text, bad, brief: false });
}

/// Copies what the view shows as text.
pub(super) fn copy(state: &mut State) -> Vec<Effect> {
    let text = export::table(state).map(|table| table.write(export::Format::Text));
    let (said, effects) = match text {
        Ok(text) if text.len() > COPIED => {
            ("too much for a terminal to copy; W writes it to a file".to_owned(), vec![])
        }
        Ok(text) => {
            let lines = text.lines().count();
            (format!("{lines} lines given to the terminal to copy"), vec![Effect::Copy(text)])
        }
        Err(reason) => (reason, Vec::new()),
    };
    update::say(state, said);
    effects
}

/// Takes up the last session.
pub(super) fn restore(state: &mut State) -> Vec<Effect> {
    let Some(last) = state.last.take() else {
        update::say(state, "there is no last session of this data set");
        return Vec::new();
    };
    let settings = last.settings.clone();
    last.show(state);
    update::say(state, "as the last session was left; u undoes");
    update::adopt(state, settings, None)
}

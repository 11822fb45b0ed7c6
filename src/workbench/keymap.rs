//! Which key does what: one table, from which come the look-up, the help and the footer's hints.

use std::collections::HashSet;

use super::{Action, State, View};

/// A key as a terminal can tell it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the names are those on the keys")]
pub enum Key {
    /// A character, with Shift already in it.
    Char(char),
    /// A letter with Ctrl.
    Ctrl(char),
    Enter,
    Esc,
    Tab,
    BackTab,
    Backspace,
    Up,
    Down,
    Left,
    Right,
    ShiftLeft,
    ShiftRight,
    PageUp,
    PageDown,
    Home,
    End,
    F(u8),
    WheelUp,
    WheelDown,
}

impl Key {
    /// Its name in the help.
    #[must_use]
    pub fn name(self) -> String {
        match self {
            Self::Char(' ') => "Space".to_owned(),
            Self::Char(c) => c.to_string(),
            Self::Ctrl(c) => format!("Ctrl-{}", c.to_ascii_uppercase()),
            Self::Enter => "Enter".to_owned(),
            Self::Esc => "Esc".to_owned(),
            Self::Tab => "Tab".to_owned(),
            Self::BackTab => "Shift-Tab".to_owned(),
            Self::Backspace => "Backspace".to_owned(),
            Self::Up => "↑".to_owned(),
            Self::Down => "↓".to_owned(),
            Self::Left => "←".to_owned(),
            Self::Right => "→".to_owned(),
            Self::ShiftLeft => "Shift-←".to_owned(),
            Self::ShiftRight => "Shift-→".to_owned(),
            Self::PageUp => "PgUp".to_owned(),
            Self::PageDown => "PgDn".to_owned(),
            Self::Home => "Home".to_owned(),
            Self::End => "End".to_owned(),
            Self::F(number) => format!("F{number}"),
            Self::WheelUp => "Wheel ↑".to_owned(),
            Self::WheelDown => "Wheel ↓".to_owned(),
        }
    }
}

/// Where a binding holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Context {
    /// In one view.
    In(View),
    /// In every view, unless something is open above it.
    Views,
    /// While a value is typed.
    Entry,
    /// While the command palette is open.
    Palette,
    /// While the help is open.
    Help,
    /// While the journal is open.
    Journal,
    /// Always.
    Always,
}

impl Context {
    /// All contexts, in the order of the help.
    pub const ALL: [Self; 16] = [
        Self::Views,
        Self::In(View::Overview),
        Self::In(View::Curves),
        Self::In(View::Tables),
        Self::In(View::Selection),
        Self::In(View::Pipeline),
        Self::In(View::Models),
        Self::In(View::Confusion),
        Self::In(View::Neighbours),
        Self::In(View::Shape),
        Self::In(View::Compare),
        Self::Entry,
        Self::Palette,
        Self::Help,
        Self::Journal,
        Self::Always,
    ];

    /// Its heading in the help.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::In(view) => view.name(),
            Self::Views => "Everywhere",
            Self::Entry => "Typing",
            Self::Palette => "Command palette",
            Self::Help => "Help",
            Self::Journal => "Journal",
            Self::Always => "Always",
        }
    }
}

/// One line of the help: keys that belong together.
#[derive(Debug, Clone, PartialEq)]
pub struct Binding {
    /// Where it holds.
    pub context: Context,
    /// Each key with its action.
    pub keys: Vec<(Key, Action)>,
    /// The keys as the help shows them.
    pub label: String,
    /// What they do.
    pub about: String,
    /// What they do in one word, where the footer shows them.
    pub hint: Option<&'static str>,
}

/// A row of the table: context, keys, label (empty: the keys' names), description, hint (empty: none).
type Row = (Context, Vec<(Key, Action)>, &'static str, &'static str, &'static str);

/// The table.
#[must_use]
pub fn bindings() -> Vec<Binding> {
    table::rows()
        .into_iter()
        .map(|(context, keys, label, about, hint)| Binding {
            context,
            label: if label.is_empty() { table::names(&keys) } else { label.to_owned() },
            keys,
            about: about.to_owned(),
            hint: (!hint.is_empty()).then_some(hint),
        })
        .collect()
}

/// The contexts that hold now, the nearest first.
#[must_use]
pub fn contexts(state: &State) -> Vec<Context> {
    if state.help.is_some() {
        vec![Context::Help, Context::Always]
    } else if state.told.is_some() {
        vec![Context::Journal, Context::Always]
    } else if state.palette.is_some() {
        vec![Context::Palette, Context::Always]
    } else if state.entry.is_some() {
        vec![Context::Entry, Context::Always]
    } else {
        vec![Context::In(state.view), Context::Views, Context::Always]
    }
}

/// What a key means now.
#[must_use]
pub fn action(state: &State, key: Key) -> Option<Action> {
    let bindings = bindings();
    let bound = contexts(state).into_iter().find_map(|context| {
        let here = bindings.iter().filter(|binding| binding.context == context);
        here.flat_map(|binding| &binding.keys).find(|(bound, _)| *bound == key).map(|(_, action)| action.clone())
    });
    match (bound, key) {
        (Some(action), _) => Some(action),
        (None, Key::Char(character))
            if (state.entry.is_some() || state.palette.is_some()) && state.help.is_none() && state.told.is_none() =>
        {
            Some(Action::Insert(character))
        }
        _ => None,
    }
}

/// Keys and their meanings in a word each, for the footer, the nearest context first.
#[must_use]
pub fn hints(state: &State) -> Vec<(String, &'static str)> {
    let bindings = bindings();
    let mut taken = HashSet::new();
    let mut hints = Vec::new();
    for context in contexts(state) {
        for binding in bindings.iter().filter(|binding| binding.context == context) {
            // A key that means something else here is not announced with its general meaning.
            let fresh = binding.keys.iter().filter(|(key, _)| taken.insert(*key)).count();
            if let Some(hint) = binding.hint.filter(|_| fresh == binding.keys.len()) {
                hints.push((short(binding), hint));
            }
        }
    }
    hints
}

/// The label without its second spelling.
fn short(binding: &Binding) -> String {
    match binding.keys.first() {
        Some((Key::Left | Key::Up, _)) => binding.label.replace(" PgUp PgDn", "").replace(' ', ""),
        _ if binding.label.contains('–') => binding.label.replace(' ', ""),
        // Keys of punctuation that go two ways are shown as a pair.
        Some((Key::Char(a), _)) if a.is_ascii_punctuation() && matches!(binding.keys[..], [_, (Key::Char(_), _)]) => {
            binding.keys.iter().map(|(key, _)| key.name()).collect()
        }
        Some((key, _)) => key.name(),
        None => binding.label.clone(),
    }
}

/// How many lines the help has at most: a heading and a gap for each context, a line for each binding.
#[must_use]
pub fn lines() -> usize {
    bindings().len() + 2 * Context::ALL.len()
}

mod table;
#[cfg(test)]
mod tests;

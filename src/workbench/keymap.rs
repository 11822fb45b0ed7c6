//! Which key does what: one table, from which come the look-up, the help and the footer's hints.

use super::{Action, State, View, parameters};
use crate::query::Parameter;

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
    /// While the help is open.
    Help,
    /// Always.
    Always,
}

impl Context {
    /// All contexts, in the order of the help.
    pub const ALL: [Self; 10] = [
        Self::Views,
        Self::In(View::Overview),
        Self::In(View::Curves),
        Self::In(View::Tables),
        Self::In(View::Selection),
        Self::In(View::Pipeline),
        Self::In(View::Models),
        Self::Entry,
        Self::Help,
        Self::Always,
    ];

    /// Its heading in the help.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::In(view) => view.name(),
            Self::Views => "Everywhere",
            Self::Entry => "Typing a value",
            Self::Help => "Help",
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
    in_views()
        .into_iter()
        .chain(in_one_view())
        .chain(elsewhere())
        .map(|(context, keys, label, about, hint)| Binding {
            context,
            label: if label.is_empty() { names(&keys) } else { label.to_owned() },
            keys,
            about: about.to_owned(),
            hint: (!hint.is_empty()).then_some(hint),
        })
        .collect()
}

fn in_views() -> Vec<Row> {
    use Context::Views;
    use Key::{BackTab, Char, Ctrl, Down, End, Enter, F, Home, Left, PageDown, PageUp, Right, Tab, Up};
    vec![
        (Views, vec![(Left, Action::Turn(-1)), (Right, Action::Turn(1))], "← →", "turn the parameter", "turn"),
        (Views, vec![(Char('-'), Action::Turn(-1)), (Char('+'), Action::Turn(1))], "- +", "the same", ""),
        (
            Views,
            vec![
                (Key::ShiftLeft, Action::Leap(-1)),
                (Key::ShiftRight, Action::Leap(1)),
                (Char('<'), Action::Leap(-1)),
                (Char('>'), Action::Leap(1)),
            ],
            "< >  Shift-← →",
            "turn it by a big step",
            "",
        ),
        (
            Views,
            vec![(Up, Action::Up), (Down, Action::Down)],
            "↑ ↓",
            "the parameter before, after; in Models the model",
            "choose",
        ),
        (Views, letters(), "", "choose that parameter: operator, mass, kmax, …", ""),
        (Views, vec![(Enter, Action::Edit), (Char('='), Action::Edit)], "", "type a value", "type"),
        (Views, vec![(Char('r'), Action::Reset)], "", "the parameter's first value", ""),
        (Views, vec![(Char('R'), Action::ResetAll)], "", "every parameter's first value", ""),
        (Views, vec![(Char('u'), Action::Undo)], "", "undo the last change of parameters", "undo"),
        (Views, vec![(Char('U'), Action::Redo), (Ctrl('r'), Action::Redo)], "", "redo", ""),
        (Views, numbers(), "1 – 6", "show that view", "view"),
        (
            Views,
            vec![(Tab, Action::NextView), (BackTab, Action::PreviousView)],
            "",
            "the next view, the one before",
            "",
        ),
        (
            Views,
            vec![(PageUp, Action::PageUp), (PageDown, Action::PageDown)],
            "",
            "scroll the view, or page through the models",
            "",
        ),
        (Views, vec![(Home, Action::First), (End, Action::Last)], "", "to the beginning, to the end", ""),
        (Views, vec![(Char(' '), Action::ToggleSolving)], "", "stop solving spectra, go on", ""),
        (Views, vec![(F(5), Action::Rescan)], "", "look at the files again", ""),
        (Views, vec![(Char('?'), Action::Help), (F(1), Action::Help)], "", "this help", "help"),
        (Views, vec![(Char('q'), Action::Quit)], "", "quit", "quit"),
    ]
}

fn in_one_view() -> Vec<Row> {
    use Context::In;
    use Key::Char;
    vec![
        (In(View::Overview), vec![(Char('g'), Action::ToggleAxis)], "", "the k axis logarithmic or linear", "axis"),
        (In(View::Curves), vec![(Char('g'), Action::ToggleAxis)], "", "the k axis logarithmic or linear", "axis"),
        (
            In(View::Selection),
            vec![(Char('f'), Action::ToggleFigure)],
            "",
            "the map (Figure 5), the eigenvalues (Figure 4), or hill climbing",
            "figure",
        ),
        (
            In(View::Selection),
            vec![(Char('a'), Action::Compare)],
            "",
            "keep the class in the figure beside others, or no longer",
            "add class",
        ),
        (In(View::Selection), vec![(Char('A'), Action::CompareNone)], "", "the parameter's class alone", ""),
        (
            In(View::Models),
            vec![(Char('w'), Action::CycleFilter)],
            "",
            "all models, those with defects, those that take no part",
            "filter",
        ),
    ]
}

fn elsewhere() -> Vec<Row> {
    use Context::{Always, Entry, Help};
    use Key::{Char, Ctrl, Down, End, Enter, Esc, F, Home, Left, PageDown, PageUp, Right, Up};
    vec![
        (Entry, vec![(Enter, Action::Commit)], "", "take the value", "take it"),
        (Entry, vec![(Esc, Action::Close)], "", "leave the value as it was", "leave it"),
        (Entry, vec![(Key::Backspace, Action::Erase)], "", "erase a character", ""),
        (Entry, vec![(Ctrl('u'), Action::EraseAll)], "", "erase everything before the caret", ""),
        (Entry, vec![(Left, Action::Left), (Right, Action::Right)], "← →", "move the caret", ""),
        (
            Help,
            vec![(Up, Action::Up), (Down, Action::Down), (PageUp, Action::PageUp), (PageDown, Action::PageDown)],
            "",
            "scroll",
            "scroll",
        ),
        (Help, vec![(Home, Action::First), (End, Action::Last)], "", "to the beginning, to the end", ""),
        (
            Help,
            vec![(Esc, Action::Close), (Char('?'), Action::Close), (Char('q'), Action::Close), (F(1), Action::Close)],
            "",
            "close the help",
            "close",
        ),
        (Always, vec![(Ctrl('c'), Action::Interrupt)], "", "quit at once", ""),
        (Always, vec![(Ctrl('z'), Action::Suspend)], "", "back to the shell; fg returns", ""),
        (Always, vec![(Ctrl('l'), Action::Redraw)], "", "draw the screen anew", ""),
    ]
}

fn letters() -> Vec<(Key, Action)> {
    parameters::in_order().map(|parameter| (Key::Char(parameters::letter(parameter)), choose(parameter))).collect()
}

const fn choose(parameter: Parameter) -> Action {
    Action::Choose(parameter)
}

fn numbers() -> Vec<(Key, Action)> {
    ('1'..).zip(View::ALL).map(|(digit, view)| (Key::Char(digit), Action::Show(view))).collect()
}

fn names(keys: &[(Key, Action)]) -> String {
    keys.iter().map(|(key, _)| key.name()).collect::<Vec<_>>().join(" ")
}

/// The contexts that hold now, the nearest first.
#[must_use]
pub fn contexts(state: &State) -> Vec<Context> {
    if state.help.is_some() {
        vec![Context::Help, Context::Always]
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
        (None, Key::Char(character)) if state.entry.is_some() && state.help.is_none() => {
            Some(Action::Insert(character))
        }
        _ => None,
    }
}

/// Keys and their meanings in a word each, for the footer, the nearest context first.
#[must_use]
pub fn hints(state: &State) -> Vec<(String, &'static str)> {
    let bindings = bindings();
    let of = |context: Context| {
        let here = bindings.iter().filter(move |binding| binding.context == context);
        here.filter_map(|binding| binding.hint.map(|hint| (short(binding), hint))).collect::<Vec<_>>()
    };
    contexts(state).into_iter().flat_map(of).collect()
}

/// The label without its second spelling.
fn short(binding: &Binding) -> String {
    match binding.keys.first() {
        Some((Key::Left | Key::Up, _)) => binding.label.replace(" PgUp PgDn", "").replace(' ', ""),
        _ if binding.label.contains('–') => binding.label.replace(' ', ""),
        Some((key, _)) => key.name(),
        None => binding.label.clone(),
    }
}

/// How many lines the help has at most: a heading and a gap for each context, a line for each binding.
#[must_use]
pub fn lines() -> usize {
    bindings().len() + 2 * Context::ALL.len()
}

#[cfg(test)]
mod tests;

//! The command palette: everything that a key can do, and every place that can be gone to, found by typing.
//!
//! The commands come from the keymap's table, so none can be missing; the places are views, parameters' values, classes
//! and models.

use super::{
    Action, Entry, State, View,
    keymap::{self, Binding, Context},
    parameters,
};
use crate::query::Parameter;

/// So many are listed at most.
const MOST: usize = 200;

/// The palette: what was typed, and which of the lines found is chosen.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Palette {
    /// The text.
    pub entry: Entry,
    /// The line; may lie beyond the end of what is found.
    pub at: usize,
}

/// A line of the palette.
#[derive(Debug, Clone, PartialEq)]
pub struct Pick {
    /// What it does.
    pub text: String,
    /// The key that does the same where there is one.
    pub key: String,
    /// What happens when it is picked.
    pub does: Vec<Action>,
}

impl Pick {
    fn to(text: String, does: Vec<Action>) -> Self {
        Self { text, key: String::new(), does }
    }
}

/// The lines that fit what was typed, the best first.
#[must_use]
pub fn picks(state: &State) -> Vec<Pick> {
    let typed = state.palette.as_ref().map(|palette| palette.entry.text()).unwrap_or_default();
    let words: Vec<String> = typed.split_whitespace().map(str::to_lowercase).collect();
    let mut found: Vec<(usize, usize, Pick)> = Vec::new();
    let all = commands(state).into_iter().chain(numbers(state, &typed)).chain(values(state));
    // Places are many: they are offered once something was typed.
    let places = if words.is_empty() { Vec::new() } else { places(state) };
    for (order, pick) in all.chain(places).enumerate() {
        if let Some(rank) = rank(&pick.text, &words) {
            found.push((rank, order, pick));
        }
    }
    found.sort_by_key(|(rank, order, _)| (*rank, *order));
    found.into_iter().take(MOST).map(|(.., pick)| pick).collect()
}

/// How well a text fits: 0 is best; none when a word is not in it. A word fits at the text's beginning, at a word's
/// beginning, within a word, or letter by letter, in this order.
fn rank(text: &str, words: &[String]) -> Option<usize> {
    let text = text.to_lowercase();
    let mut sum = 0;
    for word in words {
        sum += if text.starts_with(word.as_str()) {
            0
        } else if text.split(|c: char| !c.is_alphanumeric()).any(|part| part.starts_with(word.as_str())) {
            1
        } else if text.contains(word.as_str()) {
            2
        } else {
            let mut letters = text.chars();
            let scattered = word.chars().all(|wanted| letters.any(|letter| letter == wanted));
            if scattered && word.chars().count() >= 3 { 6 } else { return None }
        };
    }
    Some(sum)
}

/// Every command that a key has, those of the view shown first.
fn commands(state: &State) -> Vec<Pick> {
    let place = |context: Context| match context {
        Context::In(view) if view == state.view => Some(0),
        Context::Views => Some(1),
        Context::In(_) => Some(2),
        Context::Always => Some(3),
        _ => None,
    };
    let mut bindings: Vec<(u8, Binding)> =
        keymap::bindings().into_iter().filter_map(|binding| Some((place(binding.context)?, binding))).collect();
    bindings.sort_by_key(|(place, _)| *place);
    bindings.iter().flat_map(|(_, binding)| of_binding(state, binding)).collect()
}

fn of_binding(state: &State, binding: &Binding) -> Vec<Pick> {
    let mut seen: Vec<&Action> = Vec::new();
    let mut picks = Vec::new();
    for (key, action) in &binding.keys {
        // What another key does as well is there once.
        if seen.contains(&action) || matches!(action, Action::Palette) || binding.about == "the same" {
            continue;
        }
        seen.push(action);
        let several = binding.keys.iter().any(|(_, other)| other != action);
        let (mut text, mut does) = match action {
            Action::Choose(parameter) => (format!("choose {}: {}", parameter.name(), parameter.about()), Vec::new()),
            Action::Show(view) => (format!("show {}", view.name()), Vec::new()),
            _ if several => (format!("{} ({})", binding.about, key.name()), Vec::new()),
            _ => (binding.about.clone(), Vec::new()),
        };
        if let Context::In(view) = binding.context {
            text = format!("{}: {text}", view.name());
            if view != state.view {
                does.push(Action::Show(view));
            }
        }
        does.push(action.clone());
        picks.push(Pick { text, key: key.name(), does });
    }
    picks
}

/// What a number alone can mean.
fn numbers(state: &State, typed: &str) -> Vec<Pick> {
    let digits = typed.trim().trim_start_matches(['λ', 'k', '=']).trim();
    let Ok(number) = digits.parse::<usize>() else { return Vec::new() };
    let mut picks = Vec::new();
    if (1..=state.settings.kmax).contains(&number) {
        let does = vec![Action::Set(Parameter::K, number.to_string()), Action::Show(View::Curves)];
        picks.push(Pick::to(format!("{number}: read off the curves at k = {number}"), does));
        let does = vec![Action::Show(View::Shape), Action::Eigenfunction(number)];
        picks.push(Pick::to(format!("{number}: eigenfunction {number} on the shape"), does));
    }
    picks
}

/// Every word that a parameter takes.
fn values(state: &State) -> Vec<Pick> {
    let of = |parameter: Parameter| {
        parameter.choices().iter().map(move |choice| {
            let does = vec![Action::Choose(parameter), Action::Set(parameter, (*choice).to_owned())];
            Pick::to(format!("{} = {choice}", parameter.name()), does)
        })
    };
    let same = |pick: &Pick| match &pick.does[..] {
        [_, Action::Set(parameter, value)] => state.settings.get(*parameter) == *value,
        _ => false,
    };
    parameters::in_order().flat_map(of).filter(|pick| !same(pick)).collect()
}

/// Classes and models by name.
fn places(state: &State) -> Vec<Pick> {
    let answer = &state.answer;
    let classes = answer.classes.iter().enumerate().map(|(class, name)| {
        let does = vec![
            Action::Choose(Parameter::Class),
            Action::Set(Parameter::Class, (class + 1).to_string()),
            Action::Show(View::Selection),
        ];
        Pick::to(format!("class {} {name}", class + 1), does)
    });
    let models = answer.models.iter().enumerate().map(|(model, row)| {
        let class = answer.classes.get(row.class as usize).map_or("", String::as_str);
        Pick::to(format!("model {} {class}", row.name), vec![Action::LookAt(model)])
    });
    classes.chain(models).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::Settings;

    fn state(typed: &str) -> State {
        let mut entry = Entry::default();
        typed.chars().for_each(|c| entry.insert(c));
        State { palette: Some(Palette { entry, at: 0 }), ..State::new("data", Settings::default()) }
    }

    #[test]
    fn every_command_of_the_keymap_can_be_picked() {
        let picks = picks(&state(""));
        for binding in keymap::bindings() {
            if matches!(binding.context, Context::Entry | Context::Help | Context::Palette | Context::Journal) {
                continue;
            }
            for (_, action) in &binding.keys {
                let there = picks.iter().any(|pick| pick.does.last() == Some(action));
                assert!(there || *action == Action::Palette, "{action:?}");
            }
        }
    }

    #[test]
    fn words_find_what_begins_with_them_first() {
        let first = |typed: &str| picks(&state(typed)).first().map(|pick| pick.text.clone()).unwrap_or_default();
        assert_eq!(first("show cur"), "show Curves");
        assert_eq!(first("dist l1"), "distance = l1");
        assert_eq!(first("undo"), "undo the last change of parameters");
        assert_eq!(first("qit"), "quit");
        assert_eq!(first("quit"), "quit");
        assert!(first("143").contains("k = 143"));
        assert!(picks(&state("501")).iter().all(|pick| !pick.text.contains("k = 501")), "beyond kmax");
    }

    #[test]
    fn a_command_of_another_view_goes_there_first() {
        let picks = picks(&state("D alone"));
        assert_eq!(picks[0].does, [Action::Show(View::Confusion), Action::CycleSide]);
    }
}

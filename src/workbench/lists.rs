//! In which order the views list what they list, and which of it.
//!
//! Models have a list of their own ([`ModelList`]); the lists and tables of all other views share
//! this: an order that goes through what can be compared, its reverse, and a text that a line must have.

use std::cmp::Ordering;

use super::{Entry, Matrix, Purpose, State, View, explore, pins, update};
use crate::{
    study::{Method, why::Neighbours},
    workbench::ModelList,
};

/// How one view lists.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Order {
    /// What lines are compared by: 0 is the view's own order, the others are [`columns`] of it.
    pub by: usize,
    /// The other way round.
    pub reversed: bool,
    /// Only lines with this in a name are listed, whatever the case; all when it is empty.
    pub needle: String,
}

impl Order {
    /// Puts lines in order; `compare` is asked for the column compared by, from 1.
    pub fn sort<T>(&self, lines: &mut [T], compare: impl Fn(usize, &T, &T) -> Ordering) {
        if self.by > 0 {
            lines.sort_by(|a, b| compare(self.by, a, b));
        }
        if self.reversed {
            lines.reverse();
        }
    }

    /// Whether a line with these names is listed.
    #[must_use]
    pub fn takes<'a>(&self, names: impl IntoIterator<Item = &'a str>) -> bool {
        let needle = self.needle.to_lowercase();
        needle.is_empty() || names.into_iter().any(|name| name.to_lowercase().contains(&needle))
    }

    /// What is unusual about it, in a few words; empty when nothing is.
    #[must_use]
    pub fn said(&self, columns: &[String]) -> String {
        let mut words = Vec::new();
        if self.by > 0 || self.reversed {
            let by = columns.get(self.by).map_or("", String::as_str);
            words.push(format!("by {by}{}", if self.reversed { ", reversed" } else { "" }));
        }
        if !self.needle.is_empty() {
            words.push(format!("with \"{}\"", self.needle));
        }
        words.join(" ")
    }
}

/// Numbers with those that are not there last.
#[must_use]
pub fn ascending(a: Option<f64>, b: Option<f64>) -> Ordering {
    match (a, b) {
        (Some(a), Some(b)) => a.total_cmp(&b),
        (a, b) => b.is_some().cmp(&a.is_some()),
    }
}

/// What the lines of the view shown can be compared by, its own order first; empty where it lists nothing.
#[must_use]
pub fn columns(state: &State) -> Vec<String> {
    let own = |words: &[&str]| words.iter().map(|word| (*word).to_owned()).collect();
    match state.view {
        View::Overview => own(&["method", "ε D", "ε Q", "ADR D", "ADR Q"]),
        View::Tables => {
            let tables = state.answer.tables.value.iter().flat_map(|tables| tables.iter());
            let mut heads: Vec<String> = vec!["place".to_owned()];
            for head in tables.flat_map(|table| &table.columns) {
                if !heads.contains(head) {
                    heads.push(head.clone());
                }
            }
            heads
        }
        View::Selection => own(&["weight", "index", "width of the range"]),
        View::Pipeline => own(&["place", "time", "saved", "ran"]),
        View::Confusion => own(&["models", "class", "class decided"]),
        View::Neighbours if state.why.method == Method::Boost => own(&["S", "class"]),
        View::Neighbours => own(&["distance", "class", "name"]),
        View::Compare => own(&["letter", "ε D", "ε Q", "ADR D", "ADR Q"]),
        View::Curves | View::Shape | View::Models => Vec::new(),
    }
}

impl State {
    /// How the view shown lists.
    #[must_use]
    pub fn order(&self) -> &Order {
        &self.lists[self.view as usize]
    }

    /// The name of a class; empty when there is none of this place.
    #[must_use]
    pub fn class_name(&self, class: usize) -> &str {
        self.answer.classes.get(class).map_or("", String::as_str)
    }
}

/// The next column to compare by, or the reverse order; says which.
pub(super) fn cycle(state: &mut State, reverse: bool) {
    if state.view == View::Models {
        let change = |list: &mut ModelList| {
            if reverse {
                list.reversed = !list.reversed;
            } else {
                list.sort = list.sort.next();
            }
        };
        explore::change(state, change);
        return;
    }
    let columns = columns(state);
    if columns.is_empty() {
        update::say(state, "this view lists nothing");
        return;
    }
    let order = &mut state.lists[state.view as usize];
    if reverse {
        order.reversed = !order.reversed;
    } else {
        order.by = (order.by + 1) % columns.len();
    }
    let way = if order.reversed { ", reversed" } else { "" };
    let said = format!("listed by {}{way}", columns.get(order.by).map_or("", String::as_str));
    update::say(state, said);
}

/// Begins to type what the lines of the view must have; models are listed where a view has no such lines.
pub(super) fn begin_to_find(state: &mut State) {
    if columns(state).is_empty() || state.view == View::Overview {
        update::show(state, View::Models);
    }
    state.purpose = Purpose::Needle;
    state.entry = Some(Entry::default());
}

/// Lists what has this in it.
pub(super) fn find(state: &mut State, needle: String) {
    if state.view == View::Models {
        explore::change(state, |list| list.needle = needle);
    } else {
        state.lists[state.view as usize].needle = needle;
    }
    state.scroll = 0;
}

/// The wrong cells of a confusion matrix as they are listed: true class, class decided, models.
#[must_use]
pub fn confusions(state: &State, matrix: &Matrix) -> Vec<(usize, usize, u32)> {
    let order = &state.lists[View::Confusion as usize];
    let mut cells = matrix.worst.clone();
    cells.retain(|&(truth, decided, _)| order.takes([state.class_name(truth), state.class_name(decided)]));
    order.sort(&mut cells, |by, a, b| match by {
        1 => state.class_name(a.0).cmp(state.class_name(b.0)),
        _ => state.class_name(a.1).cmp(state.class_name(b.1)),
    });
    cells
}

/// The neighbours as they are listed, by their ranks from 0; `places` names the model of each.
#[must_use]
pub fn ranks(state: &State, found: &Neighbours, places: &[usize]) -> Vec<usize> {
    let order = &state.lists[View::Neighbours as usize];
    let name = |rank: usize| {
        let model = places.get(found.found[rank].model).and_then(|&place| state.answer.models.get(place));
        model.map_or("", |model| model.name.as_str())
    };
    let class = |rank: usize| state.class_name(found.found[rank].class as usize);
    let mut ranks: Vec<usize> = (0..found.found.len()).filter(|&rank| order.takes([name(rank), class(rank)])).collect();
    order.sort(&mut ranks, |by, &a, &b| if by == 1 { class(a).cmp(class(b)) } else { name(a).cmp(name(b)) });
    ranks
}

/// The classes that AdaBoost weighs for a model as they are listed, by their places among `votes`.
#[must_use]
pub fn voted(state: &State, votes: &crate::study::why::Votes) -> Vec<usize> {
    let order = &state.lists[View::Neighbours as usize];
    let class = |place: usize| state.class_name(votes.votes[place].class as usize);
    let mut places: Vec<usize> = (0..votes.votes.len()).filter(|&place| order.takes([class(place)])).collect();
    order.sort(&mut places, |_, &a, &b| class(a).cmp(class(b)));
    places
}

/// The stages of the pipeline as they are listed, by their places: what took, or saved, most comes first.
#[must_use]
pub fn stages(state: &State) -> Vec<usize> {
    let order = &state.lists[View::Pipeline as usize];
    let rows = &state.answer.stages;
    let mut places: Vec<usize> = (0..rows.len()).collect();
    order.sort(&mut places, |by, &a, &b| match by {
        1 => rows[b].seconds.total_cmp(&rows[a].seconds),
        2 => rows[b].saved.total_cmp(&rows[a].saved),
        _ => rows[b].ran.cmp(&rows[a].ran),
    });
    places
}

/// The pins as they are listed, by their places.
#[must_use]
pub fn pinned(state: &State) -> Vec<usize> {
    let order = &state.lists[View::Compare as usize];
    let score = |place: usize, column: usize| pins::scores(&state.pins[place], state.why.method)[column];
    let mut places: Vec<usize> = (0..state.pins.len()).collect();
    order.sort(&mut places, |by, &a, &b| {
        let column = by.saturating_sub(1).min(3);
        let (a, b) = (score(a, column), score(b, column));
        // The best first: the least ε, the greatest ADR.
        if column < 2 { ascending(a, b) } else { ascending(a.map(|a| -a), b.map(|b| -b)) }
    });
    places
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_sorted_reversed_and_narrowed() {
        let mut order = Order::default();
        let sorted = |order: &Order| {
            let mut lines = vec![(2, "b"), (1, "c"), (3, "a")];
            order.sort(&mut lines, |by, a, b| if by == 1 { a.0.cmp(&b.0) } else { a.1.cmp(b.1) });
            lines.iter().map(|line| line.0).collect::<Vec<_>>()
        };
        assert_eq!(sorted(&order), [2, 1, 3]);
        order.by = 1;
        assert_eq!(sorted(&order), [1, 2, 3]);
        order.by = 2;
        order.reversed = true;
        assert_eq!(sorted(&order), [1, 2, 3]);
        order.needle = "Arm".to_owned();
        assert!(order.takes(["cup", "armadillo"]) && !order.takes(["cup"]));
        assert_eq!(order.said(&["a".into(), "b".into(), "c".into()]), "by c, reversed with \"Arm\"");
        assert_eq!(Order::default().said(&[]), "");
    }

    #[test]
    fn what_is_missing_comes_last() {
        let mut values = [None, Some(2.0), None, Some(1.0)];
        values.sort_by(|a, b| ascending(*a, *b));
        assert_eq!(values, [Some(1.0), Some(2.0), None, None]);
    }
}

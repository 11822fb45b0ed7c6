//! The table behind each view.

use serde_json::{Value, json};

use super::{Table, experiment, figure};
use crate::{
    dataset::Role,
    query::{Finding, ModelState, Question, Source},
    study::{Cell, Curve, Method, Score, why::Decisions},
    workbench::{Answered, Figures, Matrix, State, View, experiment::Face, pins},
};

/// The table behind the view shown.
///
/// # Errors
/// A line that says why there is nothing to write yet.
pub fn table(state: &State) -> Result<Table, String> {
    let table = match state.view {
        View::Overview => methods(state),
        View::Curves if state.experiment.face != Face::Own => experiment::table(state)?,
        View::Curves => curves(state).ok_or("the curves are not there yet")?,
        View::Tables => tables(state),
        View::Selection => selected(state),
        View::Pipeline => stages(state),
        View::Models => models(state),
        View::Confusion => confusion(state).ok_or("the decisions are not there yet")?,
        View::Neighbours => neighbours(state).ok_or("the neighbours are not there yet")?,
        View::Shape => eigenvalues(state).ok_or("the model has no eigenvalues yet")?,
        View::Compare => compared(state),
    };
    if table.rows.is_empty() { Err("there is nothing to write yet".to_owned()) } else { Ok(table) }
}

fn class(state: &State, class: usize) -> Value {
    state.answer.classes.get(class).map_or(Value::Null, |name| json!(name))
}

const fn set(role: Role) -> &'static str {
    match role {
        Role::Train => "train",
        Role::Query => "query",
    }
}

/// The five figures of a method.
fn scores(figures: &Figures, method: Method, settings: &crate::query::Settings) -> [Value; 5] {
    let (error, adr) = (figures.error(method, settings), figures.adr(method, settings));
    let train = |score: Option<Score>| figure(score.map(|score| score.train));
    let query = |score: Option<Score>| figure(score.and_then(|score| score.query));
    [train(error), query(error), train(adr), query(adr), figure(figures.selected(method, settings))]
}

const SCORES: [&str; 5] = ["error_train", "error_query", "adr_train", "adr_query", "selected"];

fn methods(state: &State) -> Table {
    let mut table = Table::new(&[&["method"], &SCORES[..]].concat());
    let figures = Figures::of(&state.answer);
    for method in Method::ALL {
        let scores = scores(&figures, method, &state.answer.settings);
        table.rows.push(std::iter::once(json!(method.name())).chain(scores).collect());
    }
    table
}

fn curves(state: &State) -> Option<Table> {
    let first_k = state.answer.first_k.value.as_ref()?;
    let at = |curve: &[f64], place: usize| figure(curve.get(place).copied());
    let mut table = Table::new(&["k", "error_train", "error_query", "adr_train", "adr_query"]);
    let of = |curve: &Curve, place: usize| [at(&curve.train, place), at(&curve.query, place)];
    let pinned: Vec<_> =
        state.pins.iter().filter_map(|pin| Some((pin.letter, pin.figures.first_k.as_ref()?))).collect();
    for (letter, _) in &pinned {
        table.columns.extend(["error_train", "error_query", "adr_train", "adr_query"].map(|n| format!("{n}_{letter}")));
    }
    for place in 0..first_k.error.train.len() {
        let mut row = vec![json!(place + 1)];
        for figures in std::iter::once(first_k).chain(pinned.iter().map(|(_, figures)| *figures)) {
            row.extend(of(&figures.error, place));
            row.extend(of(&figures.adr, place));
        }
        table.rows.push(row);
    }
    Some(table)
}

fn tables(state: &State) -> Table {
    let mut out = Table::new(&["table", "row", "column", "value"]);
    // The pins have a column only where there are pins.
    let pinned = !state.pins.is_empty();
    if pinned {
        out.columns.insert(0, "pin".to_owned());
    }
    let now = state.answer.tables.value.iter().map(|tables| (None, tables.as_ref().clone()));
    let pins = state.pins.iter().filter_map(|pin| Some((Some(pin.letter), pins::tables(pin)?)));
    for (pin, table) in now.chain(pins).flat_map(|(pin, tables)| tables.into_iter().map(move |table| (pin, table))) {
        for row in &table.rows {
            let name = row.iter().find_map(|cell| if let Cell::Text(text) = cell { Some(text.as_str()) } else { None });
            for (column, cell) in table.columns.iter().zip(row) {
                let value = match cell {
                    Cell::Count(count) => json!(count),
                    Cell::Number { value, .. } => figure(Some(*value)),
                    Cell::Missing => Value::Null,
                    Cell::Text(_) => continue,
                };
                let pin = pinned.then(|| json!(pin.map(String::from)));
                let rest = [json!(table.number), json!(name), json!(column), value];
                out.rows.push(pin.into_iter().chain(rest).collect());
            }
        }
    }
    out
}

fn selected(state: &State) -> Table {
    let mut table = Table::new(&["class", "index", "alpha", "low", "mean", "high"]);
    for (place, marks) in state.answer.marks.value.iter().flat_map(|marks| marks.iter()).enumerate() {
        for mark in marks {
            let figures = [mark.alpha, mark.low, mark.mean, mark.high].map(|value| figure(Some(value)));
            table.rows.push([class(state, place), json!(mark.index)].into_iter().chain(figures).collect());
        }
    }
    table
}

fn stages(state: &State) -> Table {
    let mut table = Table::new(&["stage", "ran", "memory", "disk", "stale", "failed", "seconds", "saved"]);
    for row in &state.answer.stages {
        let counts = [row.ran, row.memory, row.disk, row.stale, row.failed].map(|count| json!(count));
        let times = [row.seconds, row.saved].map(|seconds| figure(Some(seconds)));
        table.rows.push(std::iter::once(json!(row.stage.name())).chain(counts).chain(times).collect());
    }
    table
}

/// Seconds that are 0 where nobody knows them.
fn known(seconds: f64) -> Option<f64> {
    (seconds > 0.0).then_some(seconds)
}

fn models(state: &State) -> Table {
    let mut table =
        Table::new(&["model", "class", "set", "vertices", "triangles", "state", "seconds", "defects", "reason"]);
    for place in state.models.listed(&state.answer) {
        let model = &state.answer.models[place];
        let (standing, seconds, reason) = match &model.state {
            ModelState::Waiting => ("waiting", None, None),
            ModelState::Working { .. } => ("working", None, None),
            ModelState::Ready { source: Source::Ran, seconds, .. } => ("ran", Some(*seconds), None),
            ModelState::Ready { source: Source::Memory, seconds, .. } => ("memory", known(*seconds), None),
            ModelState::Ready { source: Source::Disk, seconds, .. } => ("disk", known(*seconds), None),
            ModelState::Out { reason } => ("out", None, Some(reason)),
        };
        table.rows.push(vec![
            json!(model.name),
            class(state, model.class as usize),
            json!(set(model.role)),
            json!(model.size.map(|size| size.0)),
            json!(model.size.map(|size| size.1)),
            json!(standing),
            figure(seconds),
            json!(model.defects.len()),
            json!(reason),
        ]);
    }
    table
}

fn decisions(state: &State) -> Option<(&Decisions, &[usize])> {
    match state.answered(&Question::Decisions(state.why.method)) {
        Answered::Found(Finding::Decisions(decisions), places, _) => Some((decisions, places)),
        _ => None,
    }
}

fn confusion(state: &State) -> Option<Table> {
    let (decisions, places) = decisions(state)?;
    let matrix = Matrix::new(state.why.side, &state.answer, decisions, places);
    let mut table = Table::new(&["method", "class", "decided", "models"]);
    for (truth, row) in matrix.counts.iter().enumerate() {
        for (decided, count) in row.iter().enumerate().filter(|(_, count)| **count > 0) {
            let method = json!(state.why.method.name());
            table.rows.push(vec![method, class(state, truth), class(state, decided), json!(count)]);
        }
    }
    Some(table)
}

fn neighbours(state: &State) -> Option<Table> {
    let model = state.model()?;
    let (method, name) = (state.why.method, &state.answer.models.get(model)?.name);
    let Answered::Found(finding, places, _) = state.answered(&Question::Reasons { method, model }) else {
        return None;
    };
    let mut table = Table::default();
    match finding {
        Finding::Neighbours(found) => {
            table = Table::new(&["model", "method", "rank", "neighbour", "class", "distance"]);
            for (rank, neighbour) in (1..).zip(&found.found) {
                let of = places.get(neighbour.model).and_then(|&place| state.answer.models.get(place));
                table.rows.push(vec![
                    json!(name),
                    json!(method.name()),
                    json!(rank),
                    json!(of.map(|model| &model.name)),
                    class(state, neighbour.class as usize),
                    figure(Some(neighbour.distance)),
                ]);
            }
        }
        Finding::Votes(votes) => {
            table = Table::new(&["model", "method", "rank", "class", "score", "probability"]);
            for (rank, vote) in (1..).zip(&votes.votes) {
                table.rows.push(vec![
                    json!(name),
                    json!(method.name()),
                    json!(rank),
                    class(state, vote.class as usize),
                    figure(Some(vote.score)),
                    figure(Some(vote.probability)),
                ]);
            }
        }
        _ => {}
    }
    Some(table)
}

fn eigenvalues(state: &State) -> Option<Table> {
    let model = state.answer.models.get(state.model()?)?;
    let mut table = Table::new(&["model", "index", "eigenvalue"]);
    for (index, value) in (1..).zip(model.eigenvalues.as_ref()?.iter()) {
        table.rows.push(vec![json!(model.name), json!(index), figure(Some(*value))]);
    }
    Some(table)
}

fn compared(state: &State) -> Table {
    if let Some(sweep) = state.sweep.as_ref().filter(|_| state.why.swept || state.pins.is_empty()) {
        let mut table = Table::new(&[&[sweep.parameter.name(), "method"], &SCORES[..]].concat());
        for ((value, settings), figures) in sweep.values.iter().zip(&sweep.settings).zip(&sweep.figures) {
            let Some(figures) = figures else { continue };
            let value: Value = value.parse::<u64>().map_or_else(|_| json!(value), |number| json!(number));
            for method in Method::ALL {
                let scores = scores(figures, method, settings);
                table.rows.push([value.clone(), json!(method.name())].into_iter().chain(scores).collect());
            }
        }
        return table;
    }
    let mut table = Table::new(&[&["pin", "method"], &SCORES[..]].concat());
    let present = pins::present(state);
    let all = std::iter::once(("now".to_owned(), &present, &state.settings))
        .chain(state.pins.iter().map(|pin| (pin.letter.to_string(), &pin.figures, &pin.settings)));
    for (name, figures, settings) in all {
        for method in Method::ALL {
            let scores = scores(figures, method, settings);
            table.rows.push([json!(name), json!(method.name())].into_iter().chain(scores).collect());
        }
    }
    table
}

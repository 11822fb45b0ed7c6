//! The way that hill climbing with backward steps took: the cost after each accepted move, and the moves.
//!
//! ```text
//!  Hill climbing for ε: 5 eigenvalues
//!  0.6 ┤⢄
//!  0.3 ┤ ⠉⠒⠤⣀⣀⣀
//!      1  2  3  4  5
//!  +2 0.612  +5 0.450  +9 0.333  −5 0.321 …
//! ```

use super::super::{
    dots::Stroke,
    heading::{Note, heading, note, nothing},
    look::Role,
    number,
    pane::{self, Pane},
    plot::{self, Axis, Plot, Series},
    text,
};
use crate::{query::Stage, selection::Cost, workbench::State};

pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let (part, stage, name) = match state.settings.cost {
        Cost::Error => (&state.answer.climb_error, Stage::ClimbError, "ε"),
        Cost::Adr => (&state.answer.climb_adr, Stage::ClimbAdr, "1 − mean ADR"),
    };
    let stale = state.stale(part, stage);
    let Some(climbed) = &part.value else {
        heading(pane, 0, &format!("Hill climbing for {name}"), Note::Settled);
        return nothing(state, pane, 1);
    };
    let climb = &climbed.climb;
    let title = format!("Hill climbing for {name}: {}", number::count(climb.selected.len(), "eigenvalue"));
    heading(pane, 0, &title, note(state, stale));
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let moves: Vec<String> = climb
        .steps
        .iter()
        .map(|step| format!("{}{} {}", if step.added { '+' } else { '−' }, step.index, number::ratio(Some(step.cost))))
        .collect();
    let room = (rest.width as usize).saturating_sub(2);
    let lines = packed(&moves, room);
    let below = (lines.len() as u16).min(rest.height / 2);
    let list = pane::cut_bottom(&mut rest, below);
    if rest.height >= 4 {
        way(climb.steps.iter().map(|step| step.cost)).draw(&mut pane.part(pane::inset(rest, 1)));
    }
    let mut list = pane.part(list);
    for (y, line) in (0..).zip(lines.iter().take(below as usize)) {
        let last = y + 1 == below && lines.len() > below as usize;
        list.put(1, y, &if last { text::fit(&format!("{line} …"), room) } else { line.clone() }, Role::Plain);
    }
    if stale {
        pane.fade();
    }
}

/// The moves, as many to a line as fit.
fn packed(moves: &[String], room: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for step in moves {
        match lines.last_mut() {
            Some(line) if text::width(line) + 2 + text::width(step) <= room => *line = format!("{line}  {step}"),
            _ => lines.push(text::fit(step, room)),
        }
    }
    lines
}

fn way(costs: impl Iterator<Item = f64>) -> Plot {
    let points: Vec<(f64, f64)> = (1..).map(f64::from).zip(costs).collect();
    let mark = |&at: &(f64, f64)| plot::Mark { at, character: '●', role: Role::Strong };
    Plot {
        x: Axis::indices(points.len(), false),
        y: Axis::ratios(points.iter().map(|(_, cost)| *cost)),
        marks: points.iter().map(mark).collect(),
        series: vec![Series { points, role: Role::Train, stroke: Stroke::Solid, plain: '#' }],
        guide: None,
    }
}

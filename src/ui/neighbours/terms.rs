//! What each eigenvalue adds, along the spectrum; and the two spectra over each other.

use super::{
    super::{
        dots::Stroke,
        look::Role,
        names,
        pane::{self, Pane},
        plot::{Axis, Mark, Plot, Series},
        selection::unit,
        text,
    },
    Reasons,
};
use crate::{query::ModelRow, study::why::Neighbours, workbench::State};

/// What the terms say, and the words for what is above and below 0.
struct Said {
    terms: Vec<(u32, f64)>,
    above: String,
    below: Option<String>,
    /// Terms are shares of a whole and are written in percent.
    percent: bool,
}

fn said(state: &State, row: &ModelRow, reasons: Reasons<'_>, at: usize) -> Option<Said> {
    let class = |class: u32| text::clean(names::class(&state.answer, class as usize));
    match reasons {
        Reasons::Votes(votes) => {
            let vote = votes.votes.get(at)?;
            let name = class(vote.class);
            let below = Some(format!("against {name}"));
            Some(Said { terms: votes.terms(at).to_vec(), above: format!("for {name}"), below, percent: false })
        }
        Reasons::Neighbours(found, _) => {
            let neighbour = found.found.get(at)?;
            if neighbour.class == row.class || found.own().is_none() {
                let above = "what the distance is made of".to_owned();
                return Some(Said { terms: found.shares(at), above, below: None, percent: true });
            }
            Some(Said {
                terms: relative(found, at),
                above: format!("for {}", class(neighbour.class)),
                below: Some(format!("for {}", class(row.class))),
                percent: true,
            })
        }
    }
}

/// The differences in shares of the distance to the nearest model of the own class, so that they can be read.
fn relative(found: &Neighbours, at: usize) -> Vec<(u32, f64)> {
    let whole: f64 = found.own().map_or(0.0, |own| found.terms(own).iter().map(|(_, term)| term).sum());
    let scale = if whole > 0.0 { whole } else { 1.0 };
    found.difference(at).into_iter().map(|(index, term)| (index, term / scale)).collect()
}

/// The terms along the spectrum, and the greatest in words.
pub(super) fn draw(state: &State, row: &ModelRow, reasons: Reasons<'_>, at: usize, pane: &mut Pane<'_>) {
    let Some(said) = said(state, row, reasons, at) else { return };
    let x = pane.spans(1, 0, [("▲ ", Role::Query), (&said.above, Role::Strong)]);
    if let Some(below) = &said.below {
        pane.spans(x + 2, 0, [("▼ ", Role::Train), (below, Role::Strong)]);
    }
    if said.percent {
        pane.put_right(pane.width().saturating_sub(1), 0, "in %", Role::Faint);
    }
    if said.terms.is_empty() {
        pane.put(1, 1, "no distance at all", Role::Faint);
        return;
    }
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let high = u16::from(rest.height >= 4);
    let words = pane::cut_bottom(&mut rest, high);
    greatest(&said, &mut pane.part(words));
    spikes(&said).draw(&mut pane.part(pane::inset(rest, 1)));
}

/// The terms of greatest size, as many as fit.
fn greatest(said: &Said, pane: &mut Pane<'_>) {
    let mut terms = said.terms.clone();
    terms.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
    let mut x = 1;
    // What rounds to nothing, in percent or in hundredths, says nothing.
    for (index, term) in terms.iter().filter(|(_, term)| term.abs() >= 0.005) {
        let value = if said.percent { format!("{:+.0} %", 100.0 * term) } else { format!("{term:+.2}") };
        let value = value.replace('-', "−");
        let wide = text::width(&value) as u16 + 3 + (index.ilog10() + 1) as u16;
        if x + wide > pane.width() {
            break;
        }
        let role = if *term > 0.0 { Role::Query } else { Role::Train };
        x = pane.spans(x, 0, [("λ", Role::Faint), (&index.to_string(), Role::Strong), (" ", role), (&value, role)]) + 2;
    }
}

fn spikes(said: &Said) -> Plot {
    let scale = if said.percent { 100.0 } else { 1.0 };
    let last = said.terms.iter().map(|(index, _)| *index).max().unwrap_or(1) as usize;
    let values = said.terms.iter().map(|(_, term)| term * scale);
    let role = |term: f64| if term > 0.0 { Role::Query } else { Role::Train };
    let few = said.terms.len() <= 40;
    Plot {
        x: Axis::indices(last + usize::from(few), false),
        y: Axis::around(values.chain([0.0])),
        series: said
            .terms
            .iter()
            .map(|&(index, term)| Series {
                points: vec![(f64::from(index), 0.0), (f64::from(index), term * scale)],
                role: role(term),
                stroke: Stroke::Solid,
                plain: '|',
            })
            .collect(),
        marks: said
            .terms
            .iter()
            .filter(|(_, term)| few && *term != 0.0)
            .map(|&(index, term)| Mark {
                at: (f64::from(index), term * scale),
                character: if term > 0.0 { '▲' } else { '▼' },
                role: role(term),
            })
            .collect(),
        guide: None,
    }
}

/// The features of the two models against the index.
pub(super) fn overlay(state: &State, row: &ModelRow, reasons: Reasons<'_>, at: usize, pane: &mut Pane<'_>) {
    let Reasons::Neighbours(found, places) = reasons else { return };
    let (Some((asked, other)), Some(neighbour)) = (found.features(at), found.found.get(at)) else { return };
    let names = names::Names::new(&state.answer);
    let of = places.get(neighbour.model).and_then(|&model| state.answer.models.get(model));
    let name = of.map_or("", |row| names.of(row));
    let room = (pane.width() as usize).saturating_sub(20) / 2;
    let label = |name: &str, class: u32| {
        let class = names::class(&state.answer, class as usize);
        text::fit(&format!("{name} {class}"), room)
    };
    pane.spans(
        1,
        0,
        [
            ("━ ", Role::Train),
            (&label(names.of(row), row.class), Role::Train),
            ("  ┅ ", Role::Query),
            (&label(name, neighbour.class), Role::Query),
            (&format!("  {}", unit(state.settings.normalisation)), Role::Faint),
        ],
    );
    let count = asked.len().min(state.answer.settings.kmax);
    // As far as the selection looks, and a little further: there the difference was made.
    let reach = found.selection.iter().max().map_or(count, |&last| (last as usize + last as usize / 4 + 2).min(count));
    let points = |values: &[f64]| (1..).map(f64::from).zip(values.iter().copied()).take(reach).collect::<Vec<_>>();
    let few = found.selection.len() <= 40;
    let marks = found.selection.iter().filter(|_| few).map(|&index| Mark {
        at: (f64::from(index), asked[index as usize - 1]),
        character: '●',
        role: Role::Strong,
    });
    let plot = Plot {
        x: Axis::indices(reach, false),
        y: Axis::around(asked[..reach].iter().chain(&other[..reach]).copied()),
        series: vec![
            Series { points: points(other), role: Role::Query, stroke: Stroke::Dotted, plain: '.' },
            Series { points: points(asked), role: Role::Train, stroke: Stroke::Solid, plain: '#' },
        ],
        marks: marks.collect(),
        guide: None,
    };
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    plot.draw(&mut pane.part(pane::inset(rest, 1)));
}

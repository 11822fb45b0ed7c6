//! ε and mean ADR against k, on the training models and on the queries.
//!
//! ```text
//!  ε against k                        ━ D  ┅ Q
//!  ◆ best k 8: D 0.242 Q 0.300  ● k 10: D 0.274 Q 0.311
//!  0.60 ┤⡄        ┊
//!  0.40 ┤⠘⢄      ┊
//!  0.20 ┤   ⠉⠒◆⠤⠔●⠉⠉⠉⠉
//!       └┬──┬───┬──┴──┬──
//!        1  2   5  10 20
//!  mean ADR against k
//!  (the same)
//! ```

use super::{
    dots::Stroke,
    heading::{Note, heading, note, nothing},
    look::Role,
    number,
    pane::{self, Pane},
    plot::{Axis, Mark, Plot, Series},
    text,
};
use crate::{
    query::Stage,
    study::{Curve, FirstK, Score},
    workbench::{State, experiment::Face},
};

/// Which of the two figures.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Figure {
    /// Figure 3.
    Error,
    /// Figure 6.
    Adr,
}

impl Figure {
    const fn name(self) -> &'static str {
        match self {
            Self::Error => "ε",
            Self::Adr => "mean ADR",
        }
    }

    const fn curve(self, first_k: &FirstK) -> (&Curve, usize) {
        match self {
            Self::Error => (&first_k.error, first_k.best_error),
            Self::Adr => (&first_k.adr, first_k.best_adr),
        }
    }
}

mod lettered;
mod recall;
mod spectra;
mod variation;

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    match state.experiment.face {
        Face::Own => own(state, pane),
        Face::Spectra => spectra::draw(state, pane),
        Face::Recall => recall::draw(state, pane),
        Face::Variation => variation::draw(state, pane),
    }
}

/// ε and mean ADR of the parameters on the screen.
fn own(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let half = rest.height.div_ceil(2);
    let upper = pane::cut_top(&mut rest, half);
    chart(state, Figure::Error, &mut pane.part(upper), false);
    chart(state, Figure::Adr, &mut pane.part(rest), false);
}

fn both(score: Option<Score>) -> String {
    let (train, query) = number::score(score);
    match score.and_then(|score| score.query) {
        Some(_) => format!("D {train} Q {query}"),
        None => format!("D {train}"),
    }
}

/// One figure; `small` has one line of words above the plot.
pub(super) fn chart(state: &State, figure: Figure, pane: &mut Pane<'_>, small: bool) {
    let stale = state.stale(&state.answer.first_k, Stage::FirstK);
    let title = if small { figure.name().to_owned() } else { format!("{} against k", figure.name()) };
    let Some(first_k) = &state.answer.first_k.value else {
        heading(pane, 0, &title, Note::Settled);
        return nothing(state, pane, 1);
    };
    let after = heading(pane, 0, &title, note(state, stale));
    let (curve, best) = figure.curve(first_k);
    let kmax = curve.train.len();
    let k = state.settings.k;
    let end = pane.width().saturating_sub(1);
    let said = if small {
        best_in_short(curve, best)
    } else if curve.query.is_empty() {
        "━ D".to_owned()
    } else {
        "━ D  ┅ Q".to_owned()
    };
    if end > after + text::width(&said) as u16 {
        if small {
            pane.put_right(end, 0, &said, Role::Plain);
        } else {
            let query = said.find('┅').map_or("", |at| &said[at..]);
            let train = &said[..said.len() - query.len()];
            let x = end - text::width(&said) as u16;
            pane.spans(x, 0, [(train, Role::Train), (query, Role::Query)]);
        }
    }
    if !small {
        let at_k = if k > kmax { format!("k {k} is beyond {kmax}") } else { format!("k {k}: {}", both(curve.at(k))) };
        let roomy = pane.width() >= 70;
        let (word, gap) = if roomy { ("best at ", "     ● ") } else { ("", "  ● ") };
        let at_best = format!("{word}k {best}: {}", both(curve.at(best)));
        let room = (pane.width() as usize).saturating_sub(3);
        let x =
            pane.spans(1, 1, [("◆ ", Role::Strong), (&text::fit(&at_best, room), Role::Plain), (gap, Role::Strong)]);
        pane.put(x, 1, &text::fit(&at_k, pane.width().saturating_sub(x) as usize), Role::Plain);
    }
    let mut area = pane.area();
    pane::cut_top(&mut area, if small { 1 } else { 2 });
    let area = pane::inset(area, 1);
    let mut pane = pane.part(area);
    let mut plot = plot(curve, best, k, state.logarithmic);
    pinned(state, figure, &mut plot);
    plot.draw(&mut pane);
    if stale {
        pane.fade();
    }
}

/// Adds the curves on D of the pins, each with its letter at its end.
fn pinned(state: &State, figure: Figure, plot: &mut Plot) {
    for pin in &state.pins {
        let Some(first_k) = &pin.figures.first_k else { continue };
        let (curve, _) = figure.curve(first_k);
        let points: Vec<(f64, f64)> = (1..).map(f64::from).zip(curve.train.iter().copied()).collect();
        // Letters stand apart, so that pins with like curves do not cover each other's.
        let place = (pin.letter as usize).saturating_sub('A' as usize);
        let at = points.get(points.len().saturating_sub(1).min(2 + 3 * place)).copied();
        plot.marks.extend(at.map(|at| Mark { at, character: pin.letter, role: Role::Strong }));
        // Below the curves of the present settings.
        plot.series.insert(0, Series { points, role: Role::Faint, stroke: Stroke::Dotted, plain: ':' });
    }
}

fn best_in_short(curve: &Curve, best: usize) -> String {
    format!("◆ {}, k {best}", number::ratio(curve.at(best).map(|score| score.train)))
}

fn plot(curve: &Curve, best: usize, k: usize, logarithmic: bool) -> Plot {
    let points = |values: &[f64]| (1..).map(f64::from).zip(values.iter().copied()).collect::<Vec<_>>();
    let mut marks = Vec::new();
    if let Some(score) = curve.at(k) {
        if let Some(query) = score.query {
            marks.push(Mark { at: (k as f64, query), character: '○', role: Role::Strong });
        }
        marks.push(Mark { at: (k as f64, score.train), character: '●', role: Role::Strong });
    }
    if let Some(score) = curve.at(best) {
        marks.push(Mark { at: (best as f64, score.train), character: '◆', role: Role::Strong });
    }
    Plot {
        x: Axis::indices(curve.train.len(), logarithmic),
        y: Axis::ratios(curve.train.iter().chain(&curve.query).copied()),
        series: vec![
            Series { points: points(&curve.query), role: Role::Query, stroke: Stroke::Dotted, plain: '.' },
            Series { points: points(&curve.train), role: Role::Train, stroke: Stroke::Solid, plain: '#' },
        ],
        marks,
        guide: Some(k as f64),
    }
}

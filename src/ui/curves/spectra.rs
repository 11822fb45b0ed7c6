//! Figures 3 and 6: the curves of the paper's spectra over each other, switched on and off.
//!
//! ```text
//!  Figure 3: ε on D against k
//!  1.0 ┤a
//!  0.5 ┤ ⠉b⠒⠤c⣀
//!       1  10  100
//!  ▸ ● a original FEM un-norm.     best 0.302, k 11
//!    ○ b original FEM norm.        off: ≤ 2 min of processor time
//! ```

use ratatui::layout::Rect;

use super::super::{
    dots::Stroke,
    heading::{Note, heading},
    look::Role,
    number,
    pane::{self, Pane},
    plot::Axis,
    text,
};
use super::lettered::{self, Lettered, letter};
use crate::{
    report::paper::Variant,
    study::FirstK,
    workbench::{Action, State, experiment::Standing},
};

/// Columns of a plot from which on two stand side by side.
const BESIDE: u16 = 74;

pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let all = Variant::all();
    let mut rest = pane.area();
    // The plots keep seven lines at least; the list shows what is around its cursor.
    let listed = (all.len() as u16 + 1).min(rest.height.saturating_sub(8));
    let list = pane::cut_bottom(&mut rest, listed);
    if rest.height >= 20 {
        let half = rest.height.div_ceil(2);
        let upper = pane::cut_top(&mut rest, half);
        chart(state, &all, false, &mut pane.part(upper));
        chart(state, &all, true, &mut pane.part(rest));
    } else if rest.width >= BESIDE {
        let half = rest.width / 2;
        let left = pane::cut_left(&mut rest, half);
        chart(state, &all, false, &mut pane.part(left));
        chart(state, &all, true, &mut pane.part(rest));
    } else {
        chart(state, &all, false, &mut pane.part(rest));
    }
    self::list(state, &all, &mut pane.part(list));
}

/// Colour by operator and normalisation, the stroke by the mesh.
fn look(place: usize) -> (Role, Stroke) {
    let half = Variant::all().len() / 2;
    (Role::Class(place % half), if place < half { Stroke::Solid } else { Stroke::Dotted })
}

fn chart(state: &State, all: &[Variant], adr: bool, pane: &mut Pane<'_>) {
    let title = if adr { "Figure 6: mean ADR on D against k" } else { "Figure 3: ε on D against k" };
    heading(pane, 0, title, Note::Settled);
    let curves: Vec<Lettered> = (0..all.len())
        .filter(|place| state.experiment.on.contains(place))
        .filter_map(|place| {
            let Standing::There(first_k) = state.standing(place) else { return None };
            let curve = if adr { &first_k.adr } else { &first_k.error };
            let points = (1..).map(f64::from).zip(curve.train.iter().copied()).collect();
            let (role, stroke) = look(place);
            Some(Lettered { letter: Some(letter(place)), points, role, stroke })
        })
        .collect();
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    if curves.is_empty() {
        let said = if state.experiment.on.is_empty() {
            "no spectrum is switched on: , and . choose one below, a switches it on"
        } else {
            "the first spectrum is being computed"
        };
        for (y, line) in (0..).zip(text::wrap(said, (rest.width as usize).saturating_sub(2))) {
            pane.part(rest).put(1, y, &line, Role::Faint);
        }
        return;
    }
    let count = curves.iter().map(|curve| curve.points.len()).max().unwrap_or(2);
    let values: Vec<f64> = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| *value)).collect();
    let plot = lettered::plot(curves, Axis::indices(count, state.logarithmic), Axis::ratios(values));
    plot.draw(&mut pane.part(pane::inset(rest, 1)));
}

fn list(state: &State, all: &[Variant], pane: &mut Pane<'_>) {
    let width = pane.width();
    let head = format!("spectra, kmax {}", state.settings.kmax);
    heading(pane, 0, &head, Note::Settled);
    let rows = (pane.height() as usize).saturating_sub(1);
    let first = state.experiment.at.saturating_sub(rows / 2).min(all.len().saturating_sub(rows));
    for (y, (place, variant)) in (1..).zip(all.iter().enumerate().skip(first).take(rows)) {
        let on = state.experiment.on.contains(&place);
        let by = place as isize - state.experiment.at as isize;
        pane.target(Rect::new(0, y, width, 1), [Action::StepSpectrum(by), Action::Switch]);
        let (role, _) = look(place);
        let x = pane.spans(
            1,
            y,
            [
                (if place == state.experiment.at { "▸ " } else { "  " }, Role::Strong),
                (if on { "● " } else { "○ " }, if on { Role::Good } else { Role::Faint }),
                (&letter(place).to_string(), role),
                (" ", Role::Plain),
            ],
        );
        pane.put(x, y, &text::fit(&variant.name(), 26), if on { Role::Plain } else { Role::Faint });
        let ([long, short], role) = said(&state.standing(place));
        let at = x + 27;
        let room = width.saturating_sub(at + 1) as usize;
        pane.put(at, y, &text::fit(if text::width(&long) <= room { &long } else { &short }, room), role);
    }
}

/// How a spectrum stands, at length and in short.
fn said(standing: &Standing) -> ([String; 2], Role) {
    let same = |said: &str| [said.to_owned(), said.to_owned()];
    match standing {
        Standing::There(first_k) => (best(first_k), Role::Plain),
        Standing::Computing(done, total) => {
            ([format!("computing {done}/{total}"), format!("{done} of {total}")], Role::Warn)
        }
        Standing::Waiting => (["waits for those before it".to_owned(), "waits".to_owned()], Role::Warn),
        Standing::Off(seconds) if *seconds <= 0.0 => (same("off: a moment"), Role::Faint),
        Standing::Off(seconds) => {
            let about = about(*seconds);
            ([format!("off: {about} of processor time"), format!("off: {about}")], Role::Faint)
        }
    }
}

fn best(first_k: &FirstK) -> [String; 2] {
    let error = number::ratio(first_k.error.at(first_k.best_error).map(|score| score.train));
    let adr = number::ratio(first_k.adr.at(first_k.best_adr).map(|score| score.train));
    let short = format!("ε {error} at k {}", first_k.best_error);
    [format!("{short}, ADR {adr} at k {}", first_k.best_adr), short]
}

/// A time that is an estimate from above: nothing of it may be in the store.
fn about(seconds: f64) -> String {
    match seconds {
        s if s < 60.0 => format!("≤ {:.0} s", s.max(1.0)),
        s if s < 5400.0 => format!("≤ {:.0} min", s / 60.0),
        s => format!("≤ {:.0} h", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::about;

    #[test]
    fn estimates_are_round() {
        assert_eq!([0.2, 59.0, 61.0, 5000.0, 7300.0].map(about), ["≤ 1 s", "≤ 59 s", "≤ 1 min", "≤ 83 min", "≤ 2 h"]);
    }
}

//! Which eigenvalues tell the class from the one it is compared with.
//!
//! ```text
//!  1 human against 14 armadillo: 15 and 15 models
//!   1.0 ┤   ⡇⡇              separation against index: 1 where every human lies above every armadillo
//!   0.0 ┼⡇⡇⡇⡇⡇⣿⣿⡇
//!  −1.0 ┤      ⡇⡇
//!  λ4 +1.00  λ7 −0.98  λ9 −0.91
//! ```

use super::{
    super::{
        dots::Stroke,
        heading::{Note, heading, note, nothing},
        look::Role,
        names,
        pane::{self, Pane},
        plot::{Axis, Plot, Series},
        text,
    },
    shared::packed,
};
use crate::{
    query::{Finding, Question},
    study::why::Apart,
    workbench::{Answered, State},
};

/// From this share of the strongest separation on a spike stands out.
const STRONG: f64 = 0.9;

pub(super) fn draw(state: &State, class: usize, other: usize, pane: &mut Pane<'_>) {
    let name = |class: usize| format!("{} {}", class + 1, text::clean(names::class(&state.answer, class)));
    let title = format!("{} against {}", name(class), name(other));
    let (apart, stale) = match state.answered(&Question::Apart { class, other }) {
        Answered::Found(Finding::Apart(apart), _, stale) => (apart, stale),
        Answered::Nothing(reason) => {
            heading(pane, 0, &title, Note::Settled);
            pane.put(1, 1, &text::fit(reason, (pane.width() as usize).saturating_sub(2)), Role::Faint);
            return;
        }
        _ => {
            heading(pane, 0, &title, Note::Settled);
            return nothing(state, pane, 1);
        }
    };
    let (mine, others) = apart.models;
    heading(pane, 0, &format!("{title}: {mine} and {others} models"), note(state, stale));
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let room = (rest.width as usize).saturating_sub(2);
    let words: Vec<String> = bands(&apart.strongest()).iter().take(60).map(said).collect();
    let lines = packed(&words, room);
    let high = (lines.len() as u16).min((rest.height / 3).max(1));
    let below = pane::cut_bottom(&mut rest, high + 1);
    let mut below = pane.part(below);
    let signs = format!("+ greater, − smaller in {}", names::class(&state.answer, class));
    let keys = [format!("λ with {signs}; 1: in all pairs"), format!("{signs}; 1: in all pairs")];
    let key = keys.iter().find(|key| text::width(key) <= room).unwrap_or(&signs);
    below.put(1, 0, &text::fit(key, room), Role::Faint);
    for (y, line) in (1..=high).zip(&lines) {
        below.put(1, y, &text::fit(line, room), Role::Plain);
    }
    if rest.height >= 4 {
        spikes(apart, state.logarithmic).draw(&mut pane.part(pane::inset(rest, 1)));
    }
    if stale {
        pane.fade();
    }
}

/// Eigenvalues in a row that separate as well, to a hundredth: the first, the last, and the hundredths. The strongest
/// first.
fn bands(strongest: &[(u32, f64)]) -> Vec<(u32, u32, i32)> {
    let mut rounded: Vec<(u32, i32)> = strongest.iter().map(|&(at, by)| (at, (100.0 * by).round() as i32)).collect();
    rounded.sort_by_key(|&(at, by)| (-by.abs(), at));
    let mut bands: Vec<(u32, u32, i32)> = Vec::new();
    for (at, by) in rounded {
        match bands.last_mut() {
            Some((_, last, same)) if *last + 1 == at && *same == by => *last = at,
            _ => bands.push((at, at, by)),
        }
    }
    bands
}

fn said(&(first, last, by): &(u32, u32, i32)) -> String {
    let sign = if by < 0 { '−' } else { '+' };
    let by = f64::from(by.abs()) / 100.0;
    if first == last { format!("λ{first} {sign}{by:.2}") } else { format!("λ{first}–{last} {sign}{by:.2}") }
}

fn spikes(apart: &Apart, logarithmic: bool) -> Plot {
    let best = apart.separation.iter().fold(0.0_f64, |best, by| best.max(by.abs()));
    let strong = |by: f64| best > 0.0 && by.abs() >= STRONG * best;
    let spike = |(index, &by): (u32, &f64)| Series {
        points: vec![(f64::from(index), 0.0), (f64::from(index), by)],
        role: if strong(by) { Role::Query } else { Role::Train },
        stroke: Stroke::Solid,
        plain: if strong(by) { '#' } else { ':' },
    };
    let mut series: Vec<Series> = (1..).zip(&apart.separation).map(spike).collect();
    // Several eigenvalues share a column: the strongest must stay to be seen.
    series.sort_by(|a, b| a.points[1].1.abs().total_cmp(&b.points[1].1.abs()));
    let x = Axis::indices(apart.separation.len(), logarithmic);
    Plot { x, y: Axis::linear(-1.0, 1.0), series, marks: Vec::new(), guide: None }
}

#[cfg(test)]
mod tests {
    use super::{bands, said};

    #[test]
    fn neighbours_that_separate_as_well_are_named_together() {
        let strongest = [(7, -1.0), (3, 0.998), (9, 0.996), (8, 0.995), (4, -0.904), (5, 0.9), (6, 0.899)];
        let words: Vec<String> = bands(&strongest).iter().map(said).collect();
        assert_eq!(words, ["λ3 +1.00", "λ7 −1.00", "λ8–9 +1.00", "λ4 −0.90", "λ5–6 +0.90"]);
    }
}

//! Where along the spectrum the models of the class keep together, apart from all others.
//!
//! ```text
//!  1 human: 15 models keep apart at 4 bands
//!  1.0 ┤ ⡇ ⡄              purity against index; the bold line is the level of a band
//!  0.5 ┤┅⣷┅⣧┅┅┅┅┅┅┅┅
//!  0.0 ┤⣿⣿⣿⣶⣤⣤⣤⣀
//!  λ2–5 0.94  λ9 0.88  λ13–14 0.71
//! ```

use super::{
    super::{
        dots::Stroke,
        heading::{Note, heading, note, nothing},
        look::Role,
        names, number,
        pane::{self, Pane},
        plot::{Axis, Plot, Series},
        text,
    },
    apart,
};
use crate::{
    query::{Finding, Question},
    study::why::{Band, Shared},
    workbench::{Answered, State},
};

pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let class = state.settings.class;
    if let Some(other) = state.opposed() {
        return apart::draw(state, class, other, pane);
    }
    let name = format!("{} {}", class + 1, text::clean(names::class(&state.answer, class)));
    let (shared, stale) = match state.answered(&Question::Shared(class)) {
        Answered::Found(Finding::Shared(shared), _, stale) => (shared, stale),
        Answered::Nothing(reason) => {
            heading(pane, 0, &format!("{name}: shared bands"), Note::Settled);
            pane.put(1, 1, &text::fit(reason, (pane.width() as usize).saturating_sub(2)), Role::Faint);
            return;
        }
        _ => {
            heading(pane, 0, &format!("{name}: shared bands"), Note::Settled);
            return nothing(state, pane, 1);
        }
    };
    let count = number::count(shared.bands.len(), "band");
    let title = format!("{name}: {} keep apart at {count}", number::count(shared.models, "model"));
    heading(pane, 0, &title, note(state, stale));
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let words: Vec<String> = shared.bands.iter().map(said).collect();
    let lines = packed(&words, (rest.width as usize).saturating_sub(2));
    let high = (lines.len() as u16).min((rest.height / 3).max(1));
    let below = pane::cut_bottom(&mut rest, high);
    let mut below = pane.part(below);
    for (y, line) in (0..high).zip(&lines) {
        let cut = y + 1 == high && lines.len() > high as usize;
        let line = if cut { format!("{line} …") } else { line.clone() };
        below.put(1, y, &text::fit(&line, (rest.width as usize).saturating_sub(2)), Role::Plain);
    }
    if rest.height >= 4 {
        purity(shared, state.logarithmic).draw(&mut pane.part(pane::inset(rest, 1)));
    }
    if stale {
        pane.fade();
    }
}

fn said(band: &Band) -> String {
    if band.first == band.last {
        format!("λ{} {:.2}", band.first, band.purity)
    } else {
        format!("λ{}–{} {:.2}", band.first, band.last, band.purity)
    }
}

pub(super) fn packed(words: &[String], room: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if text::width(line) + 2 + text::width(word) <= room => *line = format!("{line}  {word}"),
            _ => lines.push(word.clone()),
        }
    }
    lines
}

fn purity(shared: &Shared, logarithmic: bool) -> Plot {
    let count = shared.purity.len();
    let spike = |(index, &purity): (u32, &f64)| Series {
        points: vec![(f64::from(index), 0.0), (f64::from(index), purity)],
        role: if purity >= shared.level { Role::Query } else { Role::Train },
        stroke: Stroke::Solid,
        plain: if purity >= shared.level { '#' } else { ':' },
    };
    let mut series: Vec<Series> = (1..).zip(&shared.purity).map(spike).collect();
    // Several eigenvalues share a column: those that keep apart must stay to be seen.
    series.sort_by(|a, b| a.points[1].1.total_cmp(&b.points[1].1));
    series.push(Series {
        points: vec![(1.0, shared.level), (count as f64, shared.level)],
        role: Role::Strong,
        stroke: Stroke::Dotted,
        plain: '.',
    });
    Plot { x: Axis::indices(count, logarithmic), y: Axis::linear(0.0, 1.0), series, marks: Vec::new(), guide: None }
}

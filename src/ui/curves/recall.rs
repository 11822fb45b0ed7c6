//! Figure 7: precision against recall of the paper's schemes, for the parameters on the screen.
//!
//! ```text
//!  Figure 7: precision against recall, queries Q
//!  1.0 ┤a
//!  0.5 ┤  ⠉b⠒⠤c⣀
//!       0.2 0.4 0.6
//!  a SC / first-k / 5   mean ADR D 0.66  Q 0.58
//! ```

use super::super::{
    dots::Stroke,
    heading::{Note, heading, note, nothing},
    look::Role,
    number,
    pane::{self, Pane},
    plot::Axis,
    text,
};
use super::lettered::{self, Lettered, letter};
use crate::{
    query::{Finding, Question},
    report::figures,
    study::{Retrieved, Scheme},
    workbench::{Answered, State},
};

pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let (found, stale) = match state.answered(&Question::Retrieval) {
        Answered::Found(Finding::Retrieval(found), _, stale) => (found, stale),
        Answered::Nothing(reason) => {
            heading(pane, 0, "Figure 7: precision against recall", Note::Settled);
            pane.put(1, 1, &text::fit(reason, (pane.width() as usize).saturating_sub(2)), Role::Warn);
            return;
        }
        _ => {
            heading(pane, 0, "Figure 7: precision against recall", Note::Settled);
            return nothing(state, pane, 1);
        }
    };
    let schemes = Scheme::figure_7();
    let shown: Vec<(usize, &Retrieved)> = schemes
        .iter()
        .enumerate()
        .filter_map(|(place, scheme)| Some((place, found.iter().find(|found| found.scheme == *scheme)?)))
        .collect();
    let queries = shown.iter().any(|(_, found)| !found.precision.query.is_empty());
    let side = match (queries, pane.width() >= 66) {
        (true, true) => "queries Q against D",
        (true, false) => "Q",
        (false, true) => "D, each against the others",
        (false, false) => "D",
    };
    heading(pane, 0, &format!("Figure 7: precision against recall, {side}"), note(state, stale));
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let listed = (shown.len() as u16 + 1).min(rest.height.saturating_sub(7));
    let list = pane::cut_bottom(&mut rest, listed);
    let curves = shown
        .iter()
        .map(|&(place, found)| Lettered {
            letter: Some(letter(place)),
            points: figures::recall(found).into_iter().map(|[x, y]| (x, y)).collect(),
            role: Role::Class(place),
            stroke: if place < 4 { Stroke::Solid } else { Stroke::Dotted },
        })
        .collect();
    let plot = lettered::plot(curves, Axis::linear(0.0, 1.0), Axis::linear(0.0, 1.0));
    plot.draw(&mut pane.part(pane::inset(rest, 1)));
    names(&shown, &mut pane.part(list));
    if stale {
        pane.fade();
    }
}

fn names(shown: &[(usize, &Retrieved)], pane: &mut Pane<'_>) {
    pane.put(3, 0, &text::fit("classification / retrieval / classes", 37), Role::Faint);
    pane.put(40, 0, &text::fit("mean ADR", (pane.width().saturating_sub(41)) as usize), Role::Faint);
    for (y, &(place, found)) in (1..).zip(shown) {
        pane.put(1, y, &letter(place).to_string(), Role::Class(place));
        pane.put(3, y, &text::fit(&figures::scheme(found.scheme), 36), Role::Plain);
        let (train, query) = number::score(Some(found.adr));
        if pane.width() > 56 {
            pane.spans(
                40,
                y,
                [("D ", Role::Train), (&train, Role::Train), ("  Q ", Role::Query), (&query, Role::Query)],
            );
        } else {
            pane.spans(27, y, [("  Q ", Role::Query), (&query, Role::Query)]);
        }
    }
}

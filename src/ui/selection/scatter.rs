//! Figure 4: the selected eigenvalues of chosen classes, eigenvalue against index, a mark per class.

use super::{
    super::{
        dots::Stroke,
        look::Role,
        pane::{self, Pane},
        plot::{self, Axis, Plot, Series},
        text,
    },
    bands,
};
use crate::{study::Mark, workbench::State};

pub(super) fn draw(state: &State, marks: &[Vec<Mark>], pane: &mut Pane<'_>) {
    let classes: Vec<usize> = state.shown_classes().into_iter().filter(|class| *class < marks.len()).collect();
    let mut rest = pane.area();
    let names = legend(state, &classes, &mut pane.part(rest));
    pane::cut_top(&mut rest, names);
    let shown = || classes.iter().flat_map(|class| &marks[*class]);
    let y = Axis::growing(shown().flat_map(|mark| [mark.low, mark.high]));
    // A logarithmic axis has no zero: what begins there begins at its end.
    let floor = if y.logarithmic { y.low } else { f64::NEG_INFINITY };
    let mut series = Vec::new();
    let mut points = Vec::new();
    // The parameter's class comes first in the list and is drawn last, over the others.
    for (place, &class) in classes.iter().enumerate().rev() {
        for mark in &marks[class] {
            let index = f64::from(mark.index);
            series.push(Series {
                points: vec![(index, mark.low.max(floor)), (index, mark.high.max(floor))],
                role: Role::Class(place),
                stroke: Stroke::Solid,
                plain: '|',
            });
            points.push(plot::Mark {
                at: (index, mark.mean.max(floor)),
                character: pane.look().mark(place),
                role: Role::Class(place),
            });
        }
    }
    let plot = Plot { x: Axis::indices(state.answer.settings.kmax, true), y, series, marks: points, guide: None };
    plot.draw(&mut pane.part(rest));
}

/// Which mark is which class; returns the lines it took.
fn legend(state: &State, classes: &[usize], pane: &mut Pane<'_>) -> u16 {
    let unit = format!("{} against index", bands::unit(state.settings.normalisation));
    let mut x = pane.put(0, 0, &unit, Role::Faint) + 2;
    let mut y = 0;
    let most = if pane.height() > 10 { 3 } else { 1 };
    for (place, &class) in classes.iter().enumerate() {
        let name = state.answer.classes.get(class).map_or("", String::as_str);
        let label = format!("{} {}", pane.look().mark(place), text::fit(name, 14));
        let wide = text::width(&label) as u16 + 2;
        if x + wide > pane.width() + 2 {
            if y + 1 >= most {
                break;
            }
            y += 1;
            x = 0;
        }
        x = pane.put(x, y, &label, Role::Class(place)) + 2;
    }
    if classes.len() == 1 {
        let hint = "a keeps a class, then turn to another";
        if x + text::width(hint) as u16 + 2 <= pane.width() {
            pane.put(x + 1, y, hint, Role::Faint);
        }
    }
    y + 1
}

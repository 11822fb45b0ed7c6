//! Figure 5: the selected bands along the spectrum, a column per class.
//!
//! Each cell is as dense as the weight that falls into it: the sum of α over the selected intervals, each in
//! proportion to how much of the cell it covers, against the class's heaviest cell. Thin intervals stay visible, and
//! heavy ones stand out without colour.

use ratatui::layout::Rect;

use super::super::{look::Role, pane::Pane, plot::Axis, text};
use crate::{spectrum::Normalisation, study::Mark, workbench::State};

/// From a little weight to the most.
const SHADES: [char; 4] = ['░', '▒', '▓', '█'];

/// Columns of the labels and the axis.
const GUTTER: u16 = 7;
/// Columns of the frame for each class from which on its name fits below.
const NAMED: u16 = 5;

pub(super) fn draw(state: &State, marks: &[Vec<Mark>], pane: &mut Pane<'_>) {
    let axis = Axis::growing(marks.iter().flatten().flat_map(|mark| [mark.low, mark.high]));
    let (step, first, count) = columns(state, marks.len(), pane.width().saturating_sub(GUTTER));
    let named = step >= NAMED && pane.height() >= 8;
    let height = pane.height().saturating_sub(1 + u16::from(named));
    if height < 2 || pane.width() < GUTTER + 4 || count == 0 {
        return;
    }
    side(&axis, pane, height);
    let weights: Vec<Vec<f64>> =
        marks.iter().skip(first).take(count).map(|marks| weights(&axis, marks, height as usize)).collect();
    for (place, column) in weights.iter().enumerate() {
        let class = first + place;
        let x = GUTTER + place as u16 * step;
        let own = class == state.settings.class;
        let role = match (own, class % 2) {
            (true, _) => Role::Query,
            (false, 0) => Role::Train,
            _ => Role::Plain,
        };
        let wide = (step - 1).max(1);
        // A class that one eigenvalue alone tells from all others would leave the rest pale: each has its own scale.
        let most = column.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        for (row, weight) in column.iter().enumerate().filter(|(_, weight)| **weight > 0.0) {
            let level = (weight / most).sqrt() * SHADES.len() as f64;
            let shade = SHADES[(level as usize).min(SHADES.len() - 1)];
            let style = pane.style(role);
            for dx in 0..wide {
                pane.dot(x + dx, height - 1 - row as u16, shade, style);
            }
        }
        foot(state, class, x, (step, named), height, pane);
    }
    if first > 0 || first + count < marks.len() {
        pane.put(0, height, "…", Role::Faint);
    }
}

/// What the vertical axis shows.
pub(in crate::ui) const fn unit(normalisation: Normalisation) -> &'static str {
    match normalisation {
        Normalisation::None => "λ",
        Normalisation::Area => "λ·area",
        Normalisation::Max => "λ/max",
        Normalisation::Weyl => "weyl",
        Normalisation::Log => "ln λ",
    }
}

/// Columns of the frame for each class, the first class shown and how many: all, or those around the chosen one.
fn columns(state: &State, classes: usize, room: u16) -> (u16, usize, usize) {
    let room = room as usize;
    if classes == 0 || room == 0 {
        return (1, 0, 0);
    }
    let step = (room / classes).clamp(1, 9);
    let count = classes.min(room / step);
    let first = (state.settings.class.min(classes - 1)).saturating_sub(count / 2).min(classes - count);
    (step as u16, first, count)
}

/// The weight in each row, from the bottom.
fn weights(axis: &Axis, marks: &[Mark], rows: usize) -> Vec<f64> {
    let mut weights = vec![0.0; rows];
    for mark in marks.iter().filter(|mark| mark.low.is_finite() && mark.high.is_finite()) {
        let (low, high) = (axis.place(mark.low) * rows as f64, axis.place(mark.high) * rows as f64);
        let first = (low.max(0.0) as usize).min(rows - 1);
        let last = (high.max(0.0) as usize).min(rows - 1);
        for (row, weight) in weights.iter_mut().enumerate().take(last + 1).skip(first) {
            let covered = high.min(row as f64 + 1.0) - low.max(row as f64);
            // Even an interval of no length belongs to its row.
            *weight += mark.alpha.max(0.0) * covered.clamp(0.05, 1.0);
        }
    }
    weights
}

fn side(axis: &Axis, pane: &mut Pane<'_>, height: u16) {
    let style = pane.style(Role::Faint);
    for row in 0..height {
        pane.dot(GUTTER - 2, row, '│', style);
    }
    let ticks = if axis.logarithmic {
        axis.ticks(height as usize / 2)
    } else {
        let value = |part: f64| axis.low + part * (axis.high - axis.low);
        [0.0, 0.5, 1.0].map(|part| (value(part), format!("{:.*}", decimals(axis), value(part)))).to_vec()
    };
    for (value, label) in ticks {
        // The row that holds the weight at this value; the topmost one that at the upper end, too.
        let row = height - 1 - ((axis.place(value) * f64::from(height)) as u16).min(height - 1);
        pane.put_right(GUTTER - 3, row, &label, Role::Faint);
        pane.dot(GUTTER - 2, row, '┤', style);
    }
}

fn decimals(axis: &Axis) -> usize {
    let span = axis.high - axis.low;
    if span >= 100.0 {
        0
    } else if span >= 5.0 {
        1
    } else {
        2
    }
}

/// The number of a class below its column, and its name where the columns are wide.
fn foot(state: &State, class: usize, x: u16, (step, named): (u16, bool), height: u16, pane: &mut Pane<'_>) {
    let own = class == state.settings.class;
    let number = (class + 1).to_string();
    let role = if own { Role::Strong } else { Role::Faint };
    let every = if step > 2 { 1 } else { 4 };
    if own || class.is_multiple_of(every) {
        pane.put(x, height, &number, role);
    }
    if named && let Some(name) = state.answer.classes.get(class) {
        pane.put(x, height + 1, &text::fit(name, step as usize - 1), role);
    }
    if own {
        let style = pane.style(Role::Chosen);
        let wide = text::width(&number) as u16;
        pane.paint(Rect::new(x, height, wide, 1), style);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(low: f64, high: f64) -> Mark {
        Mark { index: 1, alpha: 1.0, low, mean: low, high }
    }

    #[test]
    fn weight_falls_where_the_interval_lies() {
        let axis = Axis::linear(0.0, 1.0);
        assert_eq!(weights(&axis, &[mark(0.25, 0.75)], 4), [0.0, 1.0, 1.0, 0.05]);
        assert_eq!(weights(&axis, &[mark(1.0, 1.0)], 4), [0.0, 0.0, 0.0, 0.05]);
        assert_eq!(weights(&axis, &[mark(f64::NAN, 1.0)], 2), [0.0, 0.0]);
        assert_eq!(weights(&axis, &[mark(0.0, 0.5), mark(0.0, 0.25)], 2), [1.5, 0.05]);
    }

    #[test]
    fn the_chosen_class_is_always_among_the_columns() {
        let mut state = State::new("", crate::query::Settings::default());
        for class in [0, 7, 63, 99] {
            state.settings.class = class;
            let (step, first, count) = columns(&state, 100, 20);
            assert_eq!((step, count), (1, 20));
            assert!((first..first + count).contains(&class));
        }
    }
}

//! A plot with axes.
//!
//! ```text
//! 0.40 ┤⡄        ┊          labels of y, a tick for each
//! 0.30 ┤⠘⢄  ◆    ●          curves in Braille, marks over them
//! 0.20 ┤   ⠉⠒⠤⠤⠔┊⠉⠉⠉⠉      guides at a chosen x
//!      └┬──┬───┬─┴──┬──
//!       1  2   5 10 20      labels of x
//! ```

use super::{
    dots::{Dots, Stroke},
    look::Role,
    number,
    pane::Pane,
    text,
};

/// A curve through points in ascending order of x.
pub(super) struct Series {
    pub(super) points: Vec<(f64, f64)>,
    pub(super) role: Role,
    pub(super) stroke: Stroke,
    /// What stands for it in ASCII.
    pub(super) plain: char,
}

/// A character at a point, over the curves.
pub(super) struct Mark {
    pub(super) at: (f64, f64),
    pub(super) character: char,
    pub(super) role: Role,
}

/// A span of one axis, and whether it is logarithmic.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Axis {
    pub(super) low: f64,
    pub(super) high: f64,
    pub(super) logarithmic: bool,
    /// Only whole numbers mean something.
    whole: bool,
}

impl Axis {
    pub(super) fn linear(low: f64, high: f64) -> Self {
        Self { low, high: if high > low { high } else { low + 1.0 }, logarithmic: false, whole: false }
    }

    /// From 1 or more.
    pub(super) fn indices(high: usize, logarithmic: bool) -> Self {
        Self { low: 1.0, high: high.max(2) as f64, logarithmic, whole: true }
    }

    /// A linear axis around all finite values, ending at round numbers.
    pub(super) fn around(values: impl IntoIterator<Item = f64>) -> Self {
        let ends = values.into_iter().filter(|v| v.is_finite()).fold(None, |ends: Option<(f64, f64)>, v| {
            Some(ends.map_or((v, v), |(low, high)| (low.min(v), high.max(v))))
        });
        let Some((low, high)) = ends else { return Self::linear(0.0, 1.0) };
        if high - low < 1e-12 * high.abs().max(1e-300) {
            return Self::linear(low - 0.5 * low.abs().max(1e-3), high + 0.5 * high.abs().max(1e-3));
        }
        let step = round_step((high - low) / 4.0);
        Self::linear((low / step).floor() * step, (high / step).ceil() * step)
    }

    /// For values that grow like a power: logarithmic, as far as the positive ones reach and a little beyond, where
    /// they span more than a decade or so and none is negative; else as [`Axis::around`].
    pub(super) fn growing(values: impl IntoIterator<Item = f64> + Clone) -> Self {
        let finite = || values.clone().into_iter().filter(|v| v.is_finite());
        let negative = finite().any(|v| v < 0.0);
        let positive = finite().filter(|v| *v > 0.0);
        let ends = positive.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), v| (low.min(v), high.max(v)));
        let (low, high) = (ends.0 / 1.25, ends.1 * 1.25);
        if negative || high < 20.0 * low || !low.is_finite() {
            return Self::around(values);
        }
        Self { low, high, logarithmic: true, whole: false }
    }

    /// As [`Axis::around`] for values that lie between 0 and 1, and where 0 and 1 mean something.
    pub(super) fn ratios(values: impl IntoIterator<Item = f64> + Clone) -> Self {
        let mut finite = values.clone().into_iter().filter(|v| v.is_finite());
        let first = finite.next();
        if first.is_none_or(|first| finite.all(|v| v == first)) {
            return Self::linear(0.0, 1.0);
        }
        let axis = Self::around(values);
        Self { low: axis.low.max(0.0), high: axis.high.min(1.0), ..axis }
    }

    /// Where a value lies, 0 at the low end and 1 at the high end.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.logarithmic {
            (value / self.low).ln() / (self.high / self.low).ln()
        } else {
            (value - self.low) / (self.high - self.low)
        }
    }

    /// Round values on the axis, at most about `most` of them, with their labels.
    pub(super) fn ticks(&self, most: usize) -> Vec<(f64, String)> {
        if self.logarithmic {
            return self.decades(most);
        }
        let least = if self.whole { 1.0 } else { 0.0 };
        let step = round_step((self.high - self.low) / most.max(1) as f64).max(least);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let large = self.high.abs().max(self.low.abs()) >= 1e5 || step < 1e-4;
        let first = (self.low / step - 1e-9).ceil() as i64;
        let last = (self.high / step + 1e-9).floor() as i64;
        (first..=last.min(first + 100))
            .map(|n| n as f64 * step)
            .map(|tick| (tick, if large { number::short(tick) } else { format!("{tick:.decimals$}") }))
            .map(|(tick, label)| (tick, label.replacen('-', if tick < 0.0 { "−" } else { "-" }, 1)))
            .collect()
    }

    /// 1, 2 and 5 times powers of ten; the powers alone where there would be too many of a value that is no index.
    fn decades(&self, most: usize) -> Vec<(f64, String)> {
        let ticks = |digits: &[i32]| {
            let powers = self.low.log10().floor() as i32..=self.high.log10().floor() as i32;
            let all = powers.flat_map(|power| digits.iter().map(move |&digit| (digit, power)));
            let ticks = all.map(|(digit, power)| {
                let tick = f64::from(digit) * 10_f64.powi(power);
                // Four columns at most.
                let label = match power {
                    0..4 => format!("{tick:.0}"),
                    -2..0 => format!("{tick:.*}", power.unsigned_abs() as usize),
                    _ => format!("{digit}e{power}"),
                };
                (tick, label)
            });
            ticks.filter(|(tick, _)| (self.low..=self.high).contains(tick)).collect::<Vec<_>>()
        };
        let all = ticks(&[1, 2, 5]);
        if self.whole || all.len() <= most { all } else { ticks(&[1]) }
    }
}

/// The least of 1, 2, 5 times a power of ten that is not below `step`.
fn round_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.max(1e-300).log10().floor());
    [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|round| *round >= step * (1.0 - 1e-9)).unwrap_or(step)
}

/// Everything in one plot.
pub(super) struct Plot {
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) series: Vec<Series>,
    pub(super) marks: Vec<Mark>,
    /// A vertical line at this x.
    pub(super) guide: Option<f64>,
}

/// Where the raster of a plot lies in its pane.
struct Field {
    x: u16,
    width: u16,
    height: u16,
}

impl Plot {
    /// Fills the pane.
    pub(super) fn draw(&self, pane: &mut Pane<'_>) {
        let line = pane.height() >= 6;
        let below = if line { 2 } else { 1 };
        let height = pane.height().saturating_sub(below);
        if height == 0 {
            return;
        }
        let ticks = self.y.ticks((height as usize / 2).clamp(1, 8));
        let gutter = ticks.iter().map(|(_, label)| text::width(label)).max().unwrap_or(0).max(4) as u16 + 2;
        let field = Field { x: gutter, width: pane.width().saturating_sub(gutter), height };
        if field.width < 4 {
            return;
        }
        self.side(pane, &field, &ticks);
        self.bottom(pane, &field, line);
        self.guide(pane, &field);
        self.curves(pane, &field);
        for mark in &self.marks {
            if let Some((column, row)) = self.cell(&field, mark.at) {
                let style = pane.style(mark.role);
                pane.dot(field.x + column, row, mark.character, style);
            }
        }
    }

    fn side(&self, pane: &mut Pane<'_>, field: &Field, ticks: &[(f64, String)]) {
        let style = pane.style(Role::Faint);
        for row in 0..field.height {
            pane.dot(field.x - 1, row, '│', style);
        }
        let mut last = None;
        for (value, label) in ticks.iter().rev() {
            let row = row_of(self.y.place(*value), field.height);
            // Two labels on one row would write over each other.
            if last != Some(row) {
                pane.put_right(field.x - 2, row, label, Role::Faint);
                pane.dot(field.x - 1, row, '┤', style);
            }
            last = Some(row);
        }
    }

    fn bottom(&self, pane: &mut Pane<'_>, field: &Field, line: bool) {
        let style = pane.style(Role::Faint);
        if line {
            pane.dot(field.x - 1, field.height, '└', style);
            for column in 0..field.width {
                pane.dot(field.x + column, field.height, '─', style);
            }
        }
        let labels = field.height + u16::from(line);
        let mut free = 0;
        for (value, label) in self.x.ticks((field.width as usize / 9).max(1)) {
            let column = column_of(self.x.place(value), field.width);
            let wide = text::width(&label) as u16;
            // At its middle below the tick, or as near to it as there is room.
            let start = (field.x + column).saturating_sub(wide / 2).min(pane.width().saturating_sub(wide));
            if start < free || start + wide > pane.width() {
                continue;
            }
            if line {
                pane.dot(field.x + column, field.height, '┬', style);
            }
            free = pane.put(start, labels, &label, Role::Faint) + 1;
        }
    }

    fn guide(&self, pane: &mut Pane<'_>, field: &Field) {
        let place = self.guide.map(|x| self.x.place(x)).filter(|place| (0.0..=1.0).contains(place));
        if let Some(place) = place {
            let style = pane.style(Role::Faint);
            for row in 0..field.height {
                pane.dot(field.x + column_of(place, field.width), row, '┊', style);
            }
        }
    }

    fn curves(&self, pane: &mut Pane<'_>, field: &Field) {
        let mut dots = Dots::new(field.width, field.height);
        let (wide, high) = dots.size();
        for series in &self.series {
            let mut before: Option<(i32, i32)> = None;
            let mut count = 0;
            for &(x, y) in &series.points {
                let (px, py) = (self.x.place(x), self.y.place(y));
                if !px.is_finite() || !py.is_finite() {
                    before = None;
                    continue;
                }
                let dot =
                    ((px * f64::from(wide - 1)).round() as i32, ((1.0 - py) * f64::from(high - 1)).round() as i32);
                // A step of one dot begins after the dot that is there already.
                count = match before {
                    Some(from) if from == dot => count,
                    Some(from) => dots.line(from, dot, series.stroke, count, series.role, series.plain),
                    None => dots.line(dot, dot, Stroke::Solid, count, series.role, series.plain),
                };
                before = Some(dot);
            }
        }
        dots.draw(pane, field.x, 0);
    }

    /// The cell of a point that lies on the plot.
    fn cell(&self, field: &Field, (x, y): (f64, f64)) -> Option<(u16, u16)> {
        let (px, py) = (self.x.place(x), self.y.place(y));
        let inside = |p: f64| (-1e-9..=1.0 + 1e-9).contains(&p);
        (inside(px) && inside(py)).then(|| (column_of(px, field.width), row_of(py, field.height)))
    }
}

fn column_of(place: f64, width: u16) -> u16 {
    // The same dot as the curve's, then its cell.
    let dots = f64::from(2 * width) - 1.0;
    ((place.clamp(0.0, 1.0) * dots).round() as u16 / 2).min(width.saturating_sub(1))
}

fn row_of(place: f64, height: u16) -> u16 {
    let dots = f64::from(4 * height) - 1.0;
    (((1.0 - place.clamp(0.0, 1.0)) * dots).round() as u16 / 4).min(height.saturating_sub(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_axis_around_values_ends_at_round_numbers() {
        let axis = Axis::around([0.242, 0.61, f64::NAN]);
        assert!((axis.low - 0.2).abs() < 1e-12 && (axis.high - 0.7).abs() < 1e-12, "{axis:?}");
        assert_eq!(Axis::around([]), Axis::linear(0.0, 1.0));
        let flat = Axis::around([0.5, 0.5]);
        assert!(flat.low < 0.5 && flat.high > 0.5);
        assert_eq!(Axis::ratios([0.9, 0.9]), Axis::linear(0.0, 1.0));
        assert_eq!(Axis::ratios([0.01, 1.0]), Axis::linear(0.0, 1.0));
        let zero = Axis::around([0.0]);
        assert!(zero.low < 0.0 && zero.high > 0.0);
    }

    #[test]
    fn an_axis_of_growing_values_is_logarithmic_where_they_span_decades() {
        let axis = Axis::growing([0.0, 0.0008, f64::NAN, 0.8]);
        assert!(axis.logarithmic && axis.low < 0.0008 && axis.high > 0.8, "{axis:?}");
        let labels = |most| axis.ticks(most).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(4), ["1e-3", "0.01", "0.1", "1"]);
        assert_eq!(labels(20).len(), 10);
        assert_eq!(Axis::growing([2e-5, 2.0]).ticks(3)[0].1, "1e-4");
        assert_eq!(Axis::growing([1.0, 3.0]), Axis::around([1.0, 3.0]));
        assert_eq!(Axis::growing([-1.0, 0.01, 100.0]), Axis::around([-1.0, 0.01, 100.0]));
        assert_eq!(Axis::growing([0.0]), Axis::around([0.0]));
    }

    #[test]
    fn ticks_are_round() {
        let labels = |axis: Axis, most| axis.ticks(most).into_iter().map(|(_, label)| label).collect::<Vec<_>>();
        assert_eq!(labels(Axis::linear(0.2, 0.7), 5), ["0.2", "0.3", "0.4", "0.5", "0.6", "0.7"]);
        assert_eq!(labels(Axis::indices(60, true), 9), ["1", "2", "5", "10", "20", "50"]);
        assert_eq!(labels(Axis::indices(4, false), 9), ["1", "2", "3", "4"]);
        assert_eq!(labels(Axis::linear(0.0, 500.0), 5), ["0", "100", "200", "300", "400", "500"]);
        assert_eq!(labels(Axis::linear(0.0, 1e-7), 2), ["0", "5.0e-8", "1.0e-7"]);
    }

    #[test]
    fn the_ends_of_an_axis_are_its_first_and_last_cell() {
        assert_eq!((column_of(0.0, 40), column_of(1.0, 40)), (0, 39));
        assert_eq!((row_of(0.0, 10), row_of(1.0, 10)), (9, 0));
    }
}

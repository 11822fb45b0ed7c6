//! The legend below the panels.

use super::{
    Figure, Layer, Style,
    draw::{draw_mark, stroke},
    svg::{Anchor, Svg, TEXT, width},
};

const LEGEND_LINE: f64 = 13.5;
/// The sample of a curve.
const SAMPLE: f64 = 22.0;

impl Figure {
    /// Names and looks of the layers, each name once.
    pub(super) fn legend(&self) -> Vec<(&str, Style, bool)> {
        let mut entries: Vec<(&str, Style, bool)> = Vec::new();
        for layer in self.panels.iter().flat_map(|panel| &panel.layers) {
            let (name, style, line) = match layer {
                Layer::Line { name, style, .. } | Layer::Stems { name, style, .. } => (name, style, true),
                Layer::Points { name, style, .. } | Layer::Intervals { name, style, .. } => (name, style, false),
                Layer::Map { .. } | Layer::Labels { .. } => continue,
            };
            if !name.is_empty() && !entries.iter().any(|(known, ..)| known == name) {
                entries.push((name, *style, line));
            }
        }
        entries
    }
}

/// The legend: entries row by row in columns of one width.
pub(super) struct LegendLayout {
    column: f64,
    columns: usize,
    rows: usize,
}

impl LegendLayout {
    pub(super) fn new(entries: &[(&str, Style, bool)], room: f64) -> Self {
        let widest = entries.iter().map(|(name, ..)| width(name)).fold(0.0, f64::max);
        let column = (SAMPLE + 5.0 + widest + 6.0).min(room);
        let columns = ((room - 6.0) / column).floor().max(1.0) as usize;
        Self { column, columns, rows: entries.len().div_ceil(columns) }
    }

    pub(super) fn height(&self) -> f64 {
        if self.rows == 0 { 0.0 } else { self.rows as f64 * LEGEND_LINE + 8.0 }
    }

    pub(super) fn draw(&self, svg: &mut Svg, entries: &[(&str, Style, bool)], top: f64) {
        for (at, (name, style, line)) in entries.iter().enumerate() {
            let x = 8.0 + (at % self.columns) as f64 * self.column;
            let y = top + (at / self.columns) as f64 * LEGEND_LINE + 7.0;
            if *line {
                svg.line([x, y], [x + SAMPLE, y], &stroke(*style));
            }
            if let Some(mark) = style.mark {
                draw_mark(svg, mark, [x + SAMPLE / 2.0, y], style.hue);
            }
            svg.text([x + SAMPLE + 5.0, y + 0.36 * TEXT], Anchor::Start, 0.0, "", name);
        }
    }
}

//! A figure drawn: where the panels, axes, layers and the legend go.

use super::{
    Axis, Dash, Figure, Layer, Mark, Panel, Scale, Style,
    axis::Ruler,
    legend::LegendLayout,
    svg::{Anchor, MILLIMETRE, Svg, TEXT, width},
};

/// Okabe and Ito's colours without their yellow, which is too light for a line on white.
/// Grey and wine follow, for the few figures that have more curves.
const HUES: [&str; 9] =
    ["#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7f7f7f", "#882255"];
const AXIS: &str = "stroke=\"#000000\" stroke-width=\"0.8\"";
const GRID: &str = "stroke=\"#dddddd\" stroke-width=\"0.5\"";
/// The width of a column and of the type area of a journal's page, millimetres.
const COLUMN: f64 = 85.0;
const PAGE: f64 = 178.0;
/// Names along an axis that a column has room for.
const NAMES: usize = 24;
/// Between two sparse marks on a curve.
const MARK_DISTANCE: f64 = 54.0;
const TITLE: f64 = 22.0;

/// Where the axes of a panel are.
#[derive(Debug, Clone, Copy)]
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

impl Frame {
    fn x(self, place: f64) -> f64 {
        self.left + place * self.width
    }

    fn y(self, place: f64) -> f64 {
        self.top + (1.0 - place) * self.height
    }
}

/// What the axes need around them.
#[derive(Debug, Clone, Copy, Default)]
struct Margins {
    left: f64,
    right: f64,
    top: f64,
    bottom: f64,
}

impl Figure {
    /// The figure as an SVG document.
    #[must_use]
    pub fn svg(&self) -> String {
        let across = self.across.clamp(1, self.panels.len().max(1));
        let page = across > 1 || self.panels.iter().any(|panel| names(panel) > NAMES);
        let whole = if page { PAGE } else { COLUMN } * MILLIMETRE;
        // One set of margins for all, so that the axes of a row and of a column line up.
        let mut margins = Margins { left: 0.0, right: 12.0, top: 8.0, bottom: 0.0 };
        for panel in &self.panels {
            let needs = needs(panel);
            margins.left = margins.left.max(needs.left);
            margins.top = margins.top.max(needs.top);
            margins.bottom = margins.bottom.max(needs.bottom);
        }
        let cell_width = whole / across as f64;
        // Names may take more room than there is for axes.
        let inner_width = (cell_width - margins.left - margins.right).max(60.0);
        let square = self.panels.iter().any(|panel| matches!(panel.y.scale, Scale::Names(_)));
        let inner_height = inner_width * if square { 1.0 } else { 0.72 };
        let cell_height = margins.top + inner_height + margins.bottom;
        let rows = self.panels.len().div_ceil(across);
        let title = if self.title.is_empty() { 0.0 } else { TITLE };
        let entries = self.legend();
        let legend = LegendLayout::new(&entries, cell_width * across as f64);
        let size = (cell_width * across as f64, title + cell_height * rows as f64 + legend.height());
        let mut svg = Svg::new(size.0, size.1);
        if title > 0.0 {
            svg.text([size.0 / 2.0, 15.0], Anchor::Middle, 0.0, "font-size=\"10.5\"", &self.title);
        }
        for (at, panel) in self.panels.iter().enumerate() {
            let frame = Frame {
                left: cell_width * (at % across) as f64 + margins.left,
                top: title + cell_height * (at / across) as f64 + margins.top,
                width: inner_width,
                height: inner_height,
            };
            draw_panel(&mut svg, panel, frame);
        }
        legend.draw(&mut svg, &entries, size.1 - legend.height());
        svg.finish()
    }
}

/// The values that decide the ends of the axes.
fn values(panel: &Panel) -> (Vec<f64>, Vec<f64>) {
    let (mut x, mut y) = (Vec::new(), Vec::new());
    for layer in &panel.layers {
        match layer {
            Layer::Line { points, .. } | Layer::Points { points, .. } => {
                x.extend(points.iter().map(|point| point[0]));
                y.extend(points.iter().map(|point| point[1]));
            }
            Layer::Intervals { bars, .. } => {
                x.extend(bars.iter().map(|bar| bar[0]));
                y.extend(bars.iter().flat_map(|bar| [bar[1], bar[2], bar[3]]));
            }
            Layer::Stems { points, .. } => {
                x.extend(points.iter().map(|point| point[0]));
                y.extend(points.iter().map(|point| point[1]).chain([0.0]));
            }
            Layer::Labels { labels } => {
                x.extend(labels.iter().map(|label| label.at[0]));
                y.extend(labels.iter().map(|label| label.at[1]));
            }
            Layer::Map { cells } => {
                x.extend(cells.iter().flat_map(|cell| cell.x));
                y.extend(cells.iter().flat_map(|cell| cell.y));
            }
        }
    }
    (x, y)
}

/// How many names stand below the axes.
fn names(panel: &Panel) -> usize {
    match &panel.x.scale {
        Scale::Names(names) => names.len(),
        Scale::Linear | Scale::Log => 0,
    }
}

/// Texts along the axes: a number of five digits has room beside the next.
const TICKS_ACROSS: usize = 9;
const TICKS_DOWN: usize = 6;

fn needs(panel: &Panel) -> Margins {
    let (_, y) = values(panel);
    let ruler = Ruler::new(&panel.y, y.into_iter());
    let widest = ruler.ticks(TICKS_DOWN).iter().filter_map(|tick| tick.text.as_deref()).map(width).fold(0.0, f64::max);
    let names = match &panel.x.scale {
        Scale::Names(names) => names.iter().map(|name| width(name)).fold(0.0, f64::max) * 0.71 + 8.0,
        Scale::Linear | Scale::Log => 12.0,
    };
    let label = |axis: &Axis| if axis.label.is_empty() { 0.0 } else { 14.0 };
    Margins {
        left: widest + 9.0 + label(&panel.y),
        right: 12.0,
        top: if panel.title.is_empty() { 8.0 } else { 20.0 },
        bottom: names + 8.0 + label(&panel.x),
    }
}

fn draw_panel(svg: &mut Svg, panel: &Panel, frame: Frame) {
    let (x_values, y_values) = values(panel);
    let (x, y) = (Ruler::new(&panel.x, x_values.into_iter()), Ruler::new(&panel.y, y_values.into_iter()));
    if !panel.title.is_empty() {
        svg.text([frame.x(0.5), frame.top - 6.0], Anchor::Middle, 0.0, "", &panel.title);
    }
    draw_axes(svg, panel, frame, &x, &y);
    let at = |&[a, b]: &[f64; 2]| Some([frame.x(x.place(a)?), frame.y(y.place(b)?)]);
    let marked = |layer: &&Layer| matches!(layer, Layer::Line { style, .. } if style.mark.is_some());
    let (lines, mut line) = (panel.layers.iter().filter(marked).count(), 0.5);
    for layer in &panel.layers {
        match layer {
            Layer::Line { style, points, .. } => {
                svg.polyline(points.iter().map(at), &stroke(*style));
                if let Some(mark) = style.mark {
                    // Each curve's marks have places of their own: curves that coincide show all of theirs.
                    let first = frame.left + MARK_DISTANCE * line / lines as f64;
                    line += 1.0;
                    sparse(points.iter().map(at), first, |point| draw_mark(svg, mark, point, style.hue));
                }
            }
            Layer::Points { style, points, .. } => {
                for point in points.iter().filter_map(at) {
                    draw_mark(svg, style.mark.unwrap_or(Mark::Circle), point, style.hue);
                }
            }
            Layer::Stems { style, points, .. } => {
                if let Some(zero) = y.place(0.0).map(|place| frame.y(place)) {
                    svg.line([frame.left, zero], [frame.x(1.0), zero], AXIS);
                }
                for &[place, value] in points {
                    if let (Some(foot), Some(head)) = (at(&[place, 0.0]), at(&[place, value])) {
                        svg.line(foot, head, &stroke(*style));
                        style.mark.into_iter().for_each(|mark| draw_mark(svg, mark, head, style.hue));
                    }
                }
            }
            Layer::Labels { labels } => {
                for label in labels {
                    let Some([x, y]) = at(&label.at) else { continue };
                    let ink = if label.light { "#ffffff" } else { "#000000" };
                    let place = [x, y + 0.36 * TEXT];
                    svg.inked(place, Anchor::Middle, 0.0, ink, "font-size=\"8\"", &label.text);
                }
            }
            Layer::Intervals { style, bars, .. } => {
                for &[place, low, middle, high] in bars {
                    // What reaches below the axes goes on to their edge, without an end.
                    let foot = at(&[place, low]).or_else(|| Some([frame.x(x.place(place)?), frame.y(0.0)]));
                    if let (Some(foot), Some(head)) = (foot, at(&[place, high])) {
                        svg.line(foot, head, &stroke(*style));
                        for [x, y] in [at(&[place, low]), Some(head)].into_iter().flatten() {
                            svg.line([x - 2.2, y], [x + 2.2, y], &stroke(*style));
                        }
                    }
                    if let Some(point) = at(&[place, middle]) {
                        draw_mark(svg, style.mark.unwrap_or(Mark::Circle), point, style.hue);
                    }
                }
            }
            Layer::Map { cells } => {
                for cell in cells {
                    let edge = || Some([frame.x(x.place(cell.x[0])?), frame.y(0.0)]);
                    let corners = at(&[cell.x[0], cell.y[0]]).or_else(edge).zip(at(&[cell.x[1], cell.y[1]]));
                    if let Some(([left, bottom], [right, top])) = corners {
                        // A band that is thinner than a line can be seen all the same.
                        let height = (bottom - top).max(0.8);
                        svg.rect([left, bottom - height], right - left, height, &shade(cell.weight));
                    }
                }
            }
        }
    }
    // Over what fills the panel to its edge.
    svg.rect([frame.left, frame.top], frame.width, frame.height, AXIS);
}

fn draw_axes(svg: &mut Svg, panel: &Panel, frame: Frame, x: &Ruler<'_>, y: &Ruler<'_>) {
    let bottom = frame.y(0.0);
    let named = matches!(panel.x.scale, Scale::Names(_));
    for tick in x.ticks(TICKS_ACROSS) {
        let Some(place) = x.place(tick.value).map(|place| frame.x(place)) else { continue };
        let Some(text) = tick.text else {
            svg.line([place, bottom], [place, bottom + 2.0], AXIS);
            continue;
        };
        if !named {
            svg.line([place, frame.top], [place, bottom], GRID);
        }
        svg.line([place, bottom], [place, bottom + 3.5], AXIS);
        if named {
            svg.text([place + 2.5, bottom + 11.0], Anchor::End, 45.0, "", &text);
        } else {
            svg.text([place, bottom + 13.0], Anchor::Middle, 0.0, "", &text);
        }
    }
    for tick in y.ticks(TICKS_DOWN) {
        let Some(place) = y.place(tick.value).map(|place| frame.y(place)) else { continue };
        let Some(text) = tick.text else {
            svg.line([frame.left - 2.0, place], [frame.left, place], AXIS);
            continue;
        };
        if !matches!(panel.y.scale, Scale::Names(_)) {
            svg.line([frame.left, place], [frame.x(1.0), place], GRID);
        }
        svg.line([frame.left - 3.5, place], [frame.left, place], AXIS);
        svg.text([frame.left - 6.0, place + 0.36 * TEXT], Anchor::End, 0.0, "", &text);
    }
    let below = needs(panel).bottom - 6.0;
    svg.text([frame.x(0.5), bottom + below], Anchor::Middle, 0.0, "", &panel.x.label);
    let beside = needs(panel).left - 9.0;
    svg.text([frame.left - beside, frame.y(0.5)], Anchor::Middle, 90.0, "", &panel.y.label);
}

/// Every so many pixels across, from `first` on: along a curve's length a jagged one would have more than a smooth one.
fn sparse(points: impl Iterator<Item = Option<[f64; 2]>>, first: f64, mut mark: impl FnMut([f64; 2])) {
    let mut next = first;
    let mut last: Option<[f64; 2]> = None;
    for point in points {
        if let (Some([a, b]), Some([c, d])) = (last, point) {
            // Where the curve was lifted, or begins, marks are passed over.
            while next < a {
                next += MARK_DISTANCE;
            }
            while next <= c {
                mark([next, b + (next - a) / (c - a).max(f64::MIN_POSITIVE) * (d - b)]);
                next += MARK_DISTANCE;
            }
        }
        last = point;
    }
}

fn hue(style: usize) -> &'static str {
    HUES[style % HUES.len()]
}

pub(super) fn stroke(style: Style) -> String {
    let dash = match style.dash {
        Dash::Solid => "",
        Dash::Dashed => " stroke-dasharray=\"4.5 2.6\"",
        Dash::Dotted => " stroke-dasharray=\"0.9 2.6\"",
        Dash::DashDot => " stroke-dasharray=\"6 2.5 0.9 2.5\"",
    };
    format!("stroke=\"{}\" stroke-width=\"1.1\"{dash}", hue(style.hue))
}

/// From light to dark blue, even in lightness, so that grey keeps the order.
fn shade(weight: f64) -> String {
    let weight = if weight.is_finite() { weight.clamp(0.0, 1.0) } else { 0.0 };
    let (light, dark): ([f64; 3], [f64; 3]) = ([198.0, 219.0, 239.0], [8.0, 48.0, 107.0]);
    let mix = |at: usize| (light[at] + weight * (dark[at] - light[at])).round() as u8;
    format!("fill=\"#{:02x}{:02x}{:02x}\"", mix(0), mix(1), mix(2))
}

pub(super) fn draw_mark(svg: &mut Svg, mark: Mark, [x, y]: [f64; 2], colour: usize) {
    let r = 2.6;
    let data = match mark {
        Mark::Cross => {
            let r = 0.85 * r;
            let (l, t, e, b) = (x - r, y - r, x + r, y + r);
            format!("M{l:.2} {t:.2}L{e:.2} {b:.2}M{l:.2} {b:.2}L{e:.2} {t:.2}")
        }
        Mark::Plus => format!("M{:.2} {y:.2}H{:.2}M{x:.2} {:.2}V{:.2}", x - r, x + r, y - r, y + r),
        Mark::Circle => {
            let (l, d) = (x - r, 2.0 * r);
            format!("M{l:.2} {y:.2}a{r} {r} 0 1 0 {d:.2} 0a{r} {r} 0 1 0 -{d:.2} 0Z")
        }
        Mark::Square => {
            let r = 0.88 * r;
            format!("M{:.2} {:.2}h{d:.2}v{d:.2}h-{d:.2}Z", x - r, y - r, d = 2.0 * r)
        }
        Mark::Triangle => {
            let (top, low) = (y - 1.15 * r, y + 0.75 * r);
            format!("M{x:.2} {top:.2}L{:.2} {low:.2}H{:.2}Z", x + 1.1 * r, x - 1.1 * r)
        }
        Mark::Diamond => {
            let r = 1.15 * r;
            format!("M{x:.2} {:.2}L{:.2} {y:.2}L{x:.2} {:.2}L{:.2} {y:.2}Z", y - r, x + r, y + r, x - r)
        }
    };
    let fill = if matches!(mark, Mark::Cross | Mark::Plus) { "" } else { " fill=\"#ffffff\"" };
    svg.path(&data, &format!("stroke=\"{}\" stroke-width=\"0.9\"{fill}", hue(colour)));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Cell;

    fn example() -> Figure {
        let curve = |hue, dash, mark, phase: f64| Layer::Line {
            name: format!("curve & {hue}"),
            style: Style { hue, dash, mark },
            points: (1..=500).map(|k| [f64::from(k), 0.5 + 0.4 * (f64::from(k).ln() + phase).sin()]).collect(),
        };
        let dashes = [Dash::Solid, Dash::Dashed, Dash::Dotted, Dash::DashDot];
        let marks = [Some(Mark::Cross), None, Some(Mark::Triangle), Some(Mark::Diamond), Some(Mark::Square)];
        let curves = (0..8).map(|at| curve(at, dashes[at % 4], marks[at % 5], 0.3 * at as f64)).collect();
        let names = ["airplane", "octopus <i>", "four\u{1b}leg"].map(String::from).to_vec();
        let cells = (0..30)
            .map(|at| {
                let (x, y) = (f64::from(at % 3), f64::from(at) / 30.0);
                Cell { x: [x - 0.35, x + 0.35], y: [y, y + 0.02], weight: f64::from(at) / 30.0 }
            })
            .collect();
        let bars = vec![[0.0, 0.1, 0.2, 0.35], [1.0, 0.3, 0.4, 0.5]];
        let intervals = Layer::Intervals { name: "95 %".into(), style: Style::marks(2, Mark::Circle), bars };
        Figure {
            title: "An example".into(),
            panels: vec![
                Panel { title: "a".into(), x: Axis::log("k"), y: Axis::linear("ε").within(0.0, 1.0), layers: curves },
                Panel {
                    title: "b".into(),
                    x: Axis::names("", names),
                    y: Axis::linear("λ/max"),
                    layers: vec![Layer::Map { cells }, intervals],
                },
            ],
            across: 2,
        }
    }

    #[test]
    fn a_figure_is_drawn_the_same_every_time_and_is_not_empty() {
        let (first, second) = (example().png(2.0).unwrap(), example().png(2.0).unwrap());
        assert_eq!(first, second);
        assert!(first.starts_with(b"\x89PNG") && first.len() > 20_000, "{}", first.len());
        let empty = Figure { panels: vec![], ..example() }.png(1.0).unwrap();
        assert!(empty.len() < first.len() / 4);
        if let Some(folder) = std::env::var_os("EIGENSELECT_FIGURES") {
            std::fs::write(std::path::Path::new(&folder).join("example.png"), &first).unwrap();
        }
    }

    #[test]
    fn names_from_files_cannot_break_the_document() {
        let svg = example().svg();
        assert!(svg.contains("octopus &lt;i&gt;") && svg.contains("curve &amp; 3") && !svg.contains('\u{1b}'));
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
    }

    #[test]
    fn what_is_not_finite_or_beyond_the_axes_is_left_out() {
        let points = vec![[1.0, 0.5], [2.0, f64::NAN], [3.0, 0.6], [4.0, 7.0], [5.0, 0.4], [6.0, 0.3]];
        let layer = Layer::Line { name: "n".into(), style: Style::line(0, Dash::Solid), points };
        let y = Axis::linear("y").within(0.0, 1.0);
        let panel = Panel { title: String::new(), x: Axis::linear("x"), y, layers: vec![layer] };
        let svg = Figure { title: String::new(), panels: vec![panel], across: 1 }.svg();
        let curve = svg.lines().find(|line| line.contains("stroke-width=\"1.1\"")).unwrap();
        assert_eq!((curve.matches('M').count(), curve.matches('L').count()), (3, 1), "{curve}");
    }
}

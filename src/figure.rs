//! Figures for print: axes, curves, marks, maps and a legend, written as SVG and drawn as PNG.
//!
//! A [`Figure`] is plain data and its SVG follows from it byte for byte. Curves differ by dash and mark as well as by
//! colour, so that they can be told apart in grey; the colours are those of Okabe and Ito (2008), which readers with a
//! colour vision deficiency can tell apart too.
//!
//! ```
//! use eigenselect::figure::{Axis, Dash, Figure, Layer, Panel, Style};
//!
//! let points = (1..=50).map(|k| [f64::from(k), 1.0 / f64::from(k)]).collect();
//! let curve = Layer::Line { name: "1/k".into(), style: Style::line(1, Dash::Solid), points };
//! let panel = Panel { title: String::new(), x: Axis::log("k"), y: Axis::linear("value"), layers: vec![curve] };
//! let figure = Figure { title: "Falling".into(), panels: vec![panel], across: 1 };
//! assert!(figure.svg().starts_with("<svg"));
//! ```

pub use png::FigureError;
pub use portrait::{Bar, Portrait, pixels_png};

mod axis;
pub(crate) mod base64;
mod draw;
mod legend;
mod png;
mod portrait;
pub(crate) mod sixel;
mod svg;

/// Pixels of a PNG for each of the SVG's that make 600 dots an inch, what journals ask of line drawings.
pub const PRINT: f32 = 6.25;

/// A figure: panels in rows of `across`, and one legend for all below them.
///
/// It has the size that it is printed in: as wide as a column, 85 mm, or as a page, 178 mm, where panels stand side by
/// side or an axis has more names than a column has room for.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    /// Above everything; empty for none.
    pub title: String,
    /// Row by row.
    pub panels: Vec<Panel>,
    /// Panels in a row, 1 at least.
    pub across: usize,
}

/// A pair of axes and what is drawn between them.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Above the axes; empty for none.
    pub title: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// From the back to the front.
    pub layers: Vec<Layer>,
}

/// One axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// What it shows, with its unit.
    pub label: String,
    /// How values become places.
    pub scale: Scale,
    /// Its ends; `None` where the data say.
    pub range: Option<[f64; 2]>,
}

/// How values become places on an axis.
#[derive(Debug, Clone, PartialEq)]
pub enum Scale {
    /// Evenly.
    Linear,
    /// By the logarithm; values that are not positive are not drawn.
    Log,
    /// Entry i at i, with its name instead of a number.
    Names(Vec<String>),
}

impl Axis {
    /// An evenly divided axis.
    #[must_use]
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Linear, range: None }
    }

    /// A logarithmic axis.
    #[must_use]
    pub fn log(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Log, range: None }
    }

    /// An axis of names.
    #[must_use]
    pub fn names(label: &str, names: Vec<String>) -> Self {
        Self { label: label.to_owned(), scale: Scale::Names(names), range: None }
    }

    /// The same with fixed ends.
    #[must_use]
    pub fn within(self, low: f64, high: f64) -> Self {
        Self { range: Some([low, high]), ..self }
    }
}

/// What is drawn. A layer without a name is not in the legend; values that are not finite are left out.
#[derive(Debug, Clone, PartialEq)]
pub enum Layer {
    /// Points joined by lines, with sparse marks if the style has them.
    Line {
        /// Its name in the legend.
        name: String,
        /// How it looks.
        style: Style,
        /// `[x, y]` in the order in which they are joined.
        points: Vec<[f64; 2]>,
    },
    /// A mark at each point.
    Points {
        /// Its name in the legend.
        name: String,
        /// How it looks.
        style: Style,
        /// `[x, y]`.
        points: Vec<[f64; 2]>,
    },
    /// A mark with a vertical bar: an estimate and its interval.
    Intervals {
        /// Its name in the legend.
        name: String,
        /// How it looks.
        style: Style,
        /// `[x, low, estimate, high]`.
        bars: Vec<[f64; 4]>,
    },
    /// A line from 0 to each value.
    Stems {
        /// Its name in the legend.
        name: String,
        /// How it looks; the mark is at the value.
        style: Style,
        /// `[x, value]`.
        points: Vec<[f64; 2]>,
    },
    /// Rectangles, the darker the greater their weight.
    Map {
        /// Each rectangle.
        cells: Vec<Cell>,
    },
    /// Words in the middle of places.
    Labels {
        /// Each with its place.
        labels: Vec<Label>,
    },
}

/// A word of a [`Layer::Labels`].
#[derive(Debug, Clone, PartialEq)]
pub struct Label {
    /// Its middle.
    pub at: [f64; 2],
    /// The word.
    pub text: String,
    /// White, for dark ground.
    pub light: bool,
}

/// A rectangle of a [`Layer::Map`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cell {
    /// Its left and right side.
    pub x: [f64; 2],
    /// Its lower and upper side.
    pub y: [f64; 2],
    /// From 0, the lightest, to 1.
    pub weight: f64,
}

/// How a curve looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Style {
    /// Which colour, taken round and round; 0 is black.
    pub hue: usize,
    /// How its line is broken.
    pub dash: Dash,
    /// The shape of its marks.
    pub mark: Option<Mark>,
}

impl Style {
    /// A line without marks.
    #[must_use]
    pub const fn line(hue: usize, dash: Dash) -> Self {
        Self { hue, dash, mark: None }
    }

    /// Marks, on a solid line where there is one.
    #[must_use]
    pub const fn marks(hue: usize, mark: Mark) -> Self {
        Self { hue, dash: Dash::Solid, mark: Some(mark) }
    }
}

/// How a line is broken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dash {
    /// Not at all.
    Solid,
    /// Into dashes.
    Dashed,
    /// Into dots.
    Dotted,
    /// Into dashes and dots.
    DashDot,
}

/// The shape of a mark.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Mark {
    /// ×
    Cross,
    /// ○
    Circle,
    /// □
    Square,
    /// △
    Triangle,
    /// ◇
    Diamond,
    /// +
    Plus,
}

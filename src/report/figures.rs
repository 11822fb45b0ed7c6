//! Figures for print, made of plain rows: the paper's, and those that the screen shows.

use crate::{
    figure::{Axis, Cell, Dash, Figure, Label, Layer, Mark, Panel, Scale, Style},
    spectrum::Normalisation,
    study::{Mark as Selected, Retrieved, Scheme, why::Shared},
};

/// Marks in the order in which they tell things apart best.
pub const MARKS: [Mark; 6] = [Mark::Circle, Mark::Triangle, Mark::Square, Mark::Cross, Mark::Diamond, Mark::Plus];

/// What the normalised eigenvalues of a model are, as the label of an axis.
#[must_use]
pub const fn unit(normalisation: Normalisation) -> &'static str {
    match normalisation {
        Normalisation::None => "λ",
        Normalisation::Area => "λ·area",
        Normalisation::Max => "λ/max",
        Normalisation::Weyl => "λ·area/(4πk)",
        Normalisation::Log => "ln(λ·area)",
    }
}

/// A panel alone.
#[must_use]
pub fn alone(panel: Panel) -> Figure {
    Figure { title: String::new(), panels: vec![panel], across: 1 }
}

/// A curve whose first value belongs to k = 1.
#[must_use]
pub fn curve(name: String, style: Style, values: &[f64]) -> Layer {
    let points = values.iter().enumerate().map(|(at, &value)| [(at + 1) as f64, value]).collect();
    Layer::Line { name, style, points }
}

/// Figures 3 and 6: shares against k, from 0 to the tenth above the greatest.
#[must_use]
pub fn against_k(title: &str, label: &str, logarithmic: bool, layers: Vec<Layer>) -> Panel {
    let x = if logarithmic { Axis::log("k") } else { Axis::linear("k") };
    let points = layers.iter().flat_map(|layer| match layer {
        Layer::Line { points, .. } | Layer::Points { points, .. } => &points[..],
        _ => &[],
    });
    let most = points.map(|point| point[1]).filter(|value| value.is_finite()).fold(0.1, f64::max);
    Panel { title: title.to_owned(), x, y: Axis::linear(label).within(0.0, (10.0 * most).ceil() / 10.0), layers }
}

/// The vertical axis of normalised eigenvalues. Those that grow like k are shown by their logarithm: AdaBoost selects
/// most of them near the beginning, where an even axis has no room for them.
fn spectrum_axis(normalisation: Normalisation) -> Axis {
    let unit = unit(normalisation);
    match normalisation {
        Normalisation::None | Normalisation::Area | Normalisation::Max => Axis::log(unit),
        Normalisation::Weyl | Normalisation::Log => Axis::linear(unit),
    }
}

/// The axis from `least` to `most` with room for marks at either end, where it is logarithmic; else the data say.
fn roomy(axis: Axis, least: f64, most: f64) -> Axis {
    if axis.scale == Scale::Log && least < most { axis.within(least / 1.25, most * 1.25) } else { axis }
}

/// Figure 4: each selected eigenvalue against its index, its mean over the class and its range there, for the classes
/// `shown`, one by one and together.
#[must_use]
pub fn selections(
    classes: &[String],
    shown: &[usize],
    marks: &[Vec<Selected>],
    kmax: usize,
    normalisation: Normalisation,
) -> Figure {
    // The paper's marks first.
    const LOOKS: [Mark; 6] = [Mark::Cross, Mark::Circle, Mark::Square, Mark::Triangle, Mark::Diamond, Mark::Plus];
    let bar = |mark: &Selected| [f64::from(mark.index), mark.low, mark.mean, mark.high];
    let layer = |(turn, &class): (usize, &usize)| Layer::Intervals {
        name: classes.get(class).cloned().unwrap_or_default(),
        style: Style::marks(turn, LOOKS[turn % LOOKS.len()]),
        bars: marks.get(class).into_iter().flatten().map(bar).collect(),
    };
    let all: Vec<Layer> = shown.iter().enumerate().map(layer).collect();
    // One scale for all panels, so that a place is the same eigenvalue in each.
    let selected = || shown.iter().filter_map(|&class| marks.get(class)).flatten();
    let least = selected().map(|mark| mark.low).filter(|low| *low > 0.0).fold(f64::INFINITY, f64::min);
    let most = selected().map(|mark| mark.high).fold(0.0, f64::max);
    let axis = roomy(spectrum_axis(normalisation), least, most);
    let panel = |title: &str, layers: Vec<Layer>| Panel {
        title: title.to_owned(),
        x: Axis::log("index k").within(1.0, kmax.max(2) as f64),
        y: axis.clone(),
        layers,
    };
    let name = |class: usize| classes.get(class).map_or("", String::as_str);
    if let ([class], [layer]) = (shown, &all[..]) {
        return alone(panel(name(*class), vec![layer.clone()]));
    }
    let lettered = |(letter, (&class, layer)): (char, (&usize, &Layer))| {
        panel(&format!("({letter}) {}", name(class)), vec![layer.clone()])
    };
    let mut panels: Vec<Panel> = ('a'..).zip(shown.iter().zip(&all)).map(lettered).collect();
    let last = char::from(b'a'.saturating_add(u8::try_from(panels.len()).unwrap_or(u8::MAX)));
    panels.push(panel(&format!("({last}) together"), all));
    Figure { title: String::new(), panels, across: 2 }
}

/// Figure 5: for each class the range of each selected eigenvalue; the darker, the greater its weight in the class.
#[must_use]
pub fn bands(classes: &[String], marks: &[Vec<Selected>], normalisation: Normalisation) -> Figure {
    let column = |(class, marks): (usize, &Vec<Selected>)| {
        let most = marks.iter().map(|mark| mark.alpha).fold(0.0, f64::max);
        let cell = move |mark: &Selected| Cell {
            x: [class as f64 - 0.38, class as f64 + 0.38],
            y: [mark.low, mark.high],
            weight: if most > 0.0 { mark.alpha / most } else { 0.0 },
        };
        let mut cells: Vec<Cell> = marks.iter().map(cell).collect();
        // The weightiest in front.
        cells.sort_by(|a, b| a.weight.total_cmp(&b.weight));
        cells
    };
    let cells: Vec<Cell> = marks.iter().enumerate().flat_map(column).collect();
    let least = cells.iter().map(|cell| cell.y[0]).filter(|low| *low > 0.0).fold(f64::INFINITY, f64::min);
    let most = cells.iter().map(|cell| cell.y[1]).fold(0.0, f64::max);
    alone(Panel {
        title: String::new(),
        x: Axis::names("", classes.to_vec()),
        y: roomy(spectrum_axis(normalisation), least, most),
        layers: vec![Layer::Map { cells }],
    })
}

/// The name of a scheme of Table 5: classification / retrieval / classes kept.
#[must_use]
pub fn scheme(scheme: Scheme) -> String {
    let Scheme { gate, pick, kept } = scheme;
    if kept == 0 { format!("– / {}", pick.name()) } else { format!("{} / {} / {kept}", gate.name(), pick.name()) }
}

/// Looks of the seven curves of Figure 7, in the paper's order.
const LOOKS: [Style; 7] = [
    Style { hue: 0, dash: Dash::Solid, mark: Some(Mark::Circle) },
    Style { hue: 1, dash: Dash::Solid, mark: Some(Mark::Square) },
    Style { hue: 2, dash: Dash::Solid, mark: Some(Mark::Triangle) },
    Style { hue: 3, dash: Dash::Solid, mark: Some(Mark::Diamond) },
    Style { hue: 1, dash: Dash::Dashed, mark: None },
    Style { hue: 2, dash: Dash::DashDot, mark: None },
    Style { hue: 0, dash: Dash::Dotted, mark: None },
];

/// The points of a precision-recall curve: on the queries, on D where there are none.
#[must_use]
pub fn recall(found: &Retrieved) -> Vec<[f64; 2]> {
    let precision = if found.precision.query.is_empty() { &found.precision.train } else { &found.precision.query };
    let steps = precision.len() as f64;
    precision.iter().enumerate().map(|(at, &value)| [(at + 1) as f64 / steps, value]).collect()
}

/// Figure 7: precision against recall of the paper's seven schemes.
#[must_use]
pub fn precision(retrieved: &[Retrieved]) -> Figure {
    let lines = Scheme::figure_7().into_iter().zip(LOOKS).filter_map(|(wanted, style)| {
        let found = retrieved.iter().find(|found| found.scheme == wanted)?;
        Some(Layer::Line { name: scheme(wanted), style, points: recall(found) })
    });
    alone(Panel {
        title: String::new(),
        x: Axis::linear("recall").within(0.0, 1.0),
        y: Axis::linear("precision").within(0.0, 1.0),
        layers: lines.collect(),
    })
}

/// A confusion matrix: true classes down, decided classes across, the number of models in each cell.
#[must_use]
pub fn confusion(title: &str, classes: &[String], counts: &[Vec<u32>]) -> Figure {
    let last = counts.len().saturating_sub(1);
    let row_sum = |row: &[u32]| row.iter().sum::<u32>().max(1);
    let (mut cells, mut labels) = (Vec::new(), Vec::new());
    for (truth, row) in counts.iter().enumerate() {
        let sum = row_sum(row);
        for (decided, &count) in row.iter().enumerate().filter(|(_, count)| **count > 0) {
            let (x, y) = (decided as f64, (last - truth) as f64);
            let share = f64::from(count) / f64::from(sum);
            cells.push(Cell { x: [x - 0.5, x + 0.5], y: [y - 0.5, y + 0.5], weight: share });
            labels.push(Label { at: [x, y], text: count.to_string(), light: share > 0.5 });
        }
    }
    let down = classes.iter().rev().cloned().collect();
    alone(Panel {
        title: title.to_owned(),
        x: Axis::names("class decided", classes.to_vec()),
        y: Axis::names("true class", down),
        layers: vec![Layer::Map { cells }, Layer::Labels { labels }],
    })
}

/// What each eigenvalue adds along the spectrum: what is above 0 in one look, what is below in another.
#[must_use]
pub fn terms(title: &str, label: &str, terms: &[(u32, f64)], above: &str, below: &str) -> Panel {
    let side = |positive: bool| {
        terms
            .iter()
            .filter(move |(_, term)| *term != 0.0 && (*term > 0.0) == positive)
            .map(|&(index, term)| [f64::from(index), term])
            .collect::<Vec<_>>()
    };
    let few = terms.len() <= 60;
    let stems = |name: &str, hue, dash, mark, points| Layer::Stems {
        name: name.to_owned(),
        style: Style { hue, dash, mark: Some(mark).filter(|_| few) },
        points,
    };
    let last = terms.iter().map(|(index, _)| *index).max().unwrap_or(1);
    Panel {
        title: title.to_owned(),
        x: Axis::linear("index k").within(0.0, f64::from(last) + 1.0),
        y: Axis::linear(label),
        layers: vec![
            stems(above, 2, Dash::Solid, Mark::Triangle, side(true)),
            stems(below, 1, Dash::Dashed, Mark::Circle, side(false)),
        ]
        .into_iter()
        .filter(|layer| matches!(layer, Layer::Stems { points, .. } if !points.is_empty()))
        .collect(),
    }
}

/// The purity of a class at each eigenvalue, with the level of a band.
#[must_use]
pub fn purity(title: &str, shared: &Shared, logarithmic: bool) -> Figure {
    let points = |pure: bool| {
        (1_u32..)
            .zip(&shared.purity)
            .filter(move |(_, purity)| (**purity >= shared.level) == pure)
            .map(|(index, &purity)| [f64::from(index), purity])
            .collect::<Vec<_>>()
    };
    let count = shared.purity.len().max(2) as f64;
    let level = vec![[1.0, shared.level], [count, shared.level]];
    let stems = |name: &str, hue, mark, points| Layer::Stems {
        name: name.to_owned(),
        style: Style { hue, dash: Dash::Solid, mark },
        points,
    };
    let x = if logarithmic { Axis::log("index k") } else { Axis::linear("index k") };
    alone(Panel {
        title: title.to_owned(),
        x: x.within(1.0, count),
        y: Axis::linear("purity").within(0.0, 1.0),
        layers: vec![
            stems("elsewhere", 1, None, points(false)),
            stems("in a band", 2, Some(Mark::Circle), points(true)),
            Layer::Line { name: "level of a band".to_owned(), style: Style::line(0, Dash::Dashed), points: level },
        ],
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Curve, Score};

    #[test]
    fn a_confusion_matrix_has_a_number_in_each_cell_that_holds_something() {
        let classes = ["a", "<b>"].map(str::to_owned);
        let svg = confusion("ε", &classes, &[vec![3, 1], vec![0, 12]]).svg();
        assert!([">3<", ">1<", ">12<", "&lt;b&gt;"].iter().all(|text| svg.contains(text)), "{svg}");
        assert!(!svg.contains(">0<"));
    }

    #[test]
    fn terms_are_told_apart_by_their_sign() {
        let panel = terms("", "S", &[(2, 0.5), (7, -0.25), (9, 0.0)], "for", "against");
        let [Layer::Stems { name, points, .. }, Layer::Stems { points: below, .. }] = &panel.layers[..] else {
            panic!("{:?}", panel.layers)
        };
        assert_eq!((name.as_str(), &points[..], &below[..]), ("for", &[[2.0, 0.5]][..], &[[7.0, -0.25]][..]));
        assert!(terms("", "S", &[(2, 0.5)], "for", "against").layers.len() == 1);
    }

    #[test]
    fn precision_is_that_of_the_queries_where_there_are_any() {
        let found = Retrieved {
            scheme: Scheme::figure_7()[4],
            adr: Score { train: 0.5, query: None },
            spread: None,
            readings: Vec::new(),
            precision: Curve { train: vec![1.0, 0.5], query: Vec::new() },
        };
        assert_eq!(recall(&found), [[0.5, 1.0], [1.0, 0.5]]);
        assert_eq!(scheme(found.scheme), "– / HCBw");
        assert!(precision(&[found]).svg().contains("– / HCBw"));
    }
}

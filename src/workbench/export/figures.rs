//! The view as a figure for print, drawn from the same rows as the screen's.

use super::experiment;
use crate::{
    figure::{Axis, Dash, Figure, Layer, Mark, PRINT, Panel, Style},
    query::{Finding, ModelRow, Parameter, Question},
    report::figures::{self as drawn, MARKS, unit},
    selection::Cost,
    study::{
        Curve, FirstK, Method,
        why::{Neighbours, Votes},
    },
    workbench::{
        Answered, Figure as Shown, Matrix, State, Sweep, View, experiment::Face, explore, parameters, pins,
        shape::Scene,
    },
};

/// What a figure file is made of.
#[derive(Debug, Clone, PartialEq)]
pub enum Drawing {
    /// Axes and what is between them.
    Figure(Figure),
    /// A shape.
    Shape {
        /// What is painted.
        scene: Scene,
        /// Above it.
        title: String,
        /// Below it.
        caption: String,
    },
}

impl Drawing {
    /// The figure as the bytes of an SVG file.
    ///
    /// # Errors
    /// A line that says why it cannot be drawn.
    pub fn svg(&self) -> Result<Vec<u8>, String> {
        match self {
            Self::Figure(figure) => Ok(figure.svg().into_bytes()),
            Self::Shape { scene, title, caption } => {
                scene.portrait(title, caption).svg().map(String::into_bytes).map_err(|error| error.to_string())
            }
        }
    }

    /// The figure as the bytes of a PNG file.
    ///
    /// # Errors
    /// A line that says why it cannot be drawn.
    pub fn png(&self) -> Result<Vec<u8>, String> {
        let drawn = match self {
            Self::Figure(figure) => figure.png(PRINT),
            Self::Shape { scene, title, caption } => scene.portrait(title, caption).png(),
        };
        drawn.map_err(|error| error.to_string())
    }
}

/// The view shown as a figure.
///
/// # Errors
/// A line that says why there is none.
pub fn drawing(state: &State) -> Result<Drawing, String> {
    let none = || "this view has no figure; .csv, .json and .txt write its table".to_owned();
    let yet = |what: &str| format!("{what} not there yet");
    let figure = match state.view {
        View::Curves if state.experiment.face != Face::Own => experiment::drawing(state)?,
        View::Overview | View::Curves => curves(state).ok_or_else(|| yet("the curves are"))?,
        View::Selection => selection(state).ok_or_else(|| yet("the selection is"))?,
        View::Models => spectrum(state).ok_or_else(|| yet("the model's spectrum is"))?,
        View::Confusion => confusion(state).ok_or_else(|| yet("the decisions are"))?,
        View::Neighbours => neighbours(state).ok_or_else(|| yet("the neighbours are"))?,
        View::Compare => compared(state),
        View::Shape => return shape(state).ok_or_else(|| yet("the shape is")),
        View::Tables | View::Pipeline => return Err(none()),
    };
    Ok(Drawing::Figure(figure))
}

fn class(state: &State, class: u32) -> &str {
    state.answer.classes.get(class as usize).map_or("?", String::as_str)
}

/// What a pin is called: its letter, and the parameters in which it differs from the settings on the screen.
fn pin_name(state: &State, at: usize) -> String {
    let pin = &state.pins[at];
    let differs = |parameter: &Parameter| pin.settings.get(*parameter) != state.settings.get(*parameter);
    let said = parameters::in_order()
        .filter(differs)
        .map(|parameter| format!("{} = {}", parameter.name(), pin.settings.get(parameter)))
        .collect::<Vec<_>>();
    match said.len() {
        0 => format!("pin {}", pin.letter),
        1..=3 => format!("pin {}: {}", pin.letter, said.join(", ")),
        more => format!("pin {}: {}, {} more", pin.letter, said[..2].join(", "), more - 2),
    }
}

/// ε and mean ADR against k, on D and Q, with the curves on D of the pins.
fn curves(state: &State) -> Option<Figure> {
    let first_k = state.answer.first_k.value.as_deref()?;
    let panel = |title: &str, label: &str, of: fn(&FirstK) -> (&Curve, usize)| {
        let (curve, best) = of(first_k);
        let (train, query) = (Style { hue: 1, dash: Dash::Solid, mark: None }, Style::line(2, Dash::Dashed));
        let mut layers = vec![drawn::curve("training models D, leave-one-out".to_owned(), train, &curve.train)];
        if !curve.query.is_empty() {
            layers.push(drawn::curve("queries Q".to_owned(), query, &curve.query));
        }
        for (at, pin) in state.pins.iter().enumerate() {
            let Some(pinned) = pin.figures.first_k.as_deref() else { continue };
            let dash = [Dash::Dotted, Dash::DashDot][at % 2];
            let style = Style { hue: 3 + at, dash, mark: Some(MARKS[(at + 1) % MARKS.len()]) };
            layers.push(drawn::curve(format!("{}, D", pin_name(state, at)), style, &of(pinned).0.train));
        }
        if let Some(score) = curve.at(best) {
            let points = vec![[best as f64, score.train]];
            layers.push(Layer::Points { name: "best on D".to_owned(), style: Style::marks(0, Mark::Diamond), points });
        }
        let title = format!("{title}: best {:.3} at k = {best}", curve.at(best).map_or(f64::NAN, |score| score.train));
        drawn::against_k(&title, label, state.logarithmic, layers)
    };
    let panels = vec![
        panel("ε", "classification error ε", |first_k| (&first_k.error, first_k.best_error)),
        panel("mean ADR", "mean ADR", |first_k| (&first_k.adr, first_k.best_adr)),
    ];
    Some(Figure { title: "The first k eigenvalues".to_owned(), panels, across: 2 })
}

/// The figure that the selection view shows where there is room for one.
fn selection(state: &State) -> Option<Figure> {
    let answer = &state.answer;
    let normalisation = answer.settings.normalisation;
    match state.figure {
        Shown::Map => Some(drawn::bands(&answer.classes, answer.marks.value.as_deref()?, normalisation)),
        Shown::Marks => {
            let marks = answer.marks.value.as_deref()?;
            Some(drawn::selections(&answer.classes, &state.shown_classes(), marks, answer.settings.kmax, normalisation))
        }
        Shown::Climb => {
            let (part, label) = match state.settings.cost {
                Cost::Error => (&answer.climb_error, "ε on D"),
                Cost::Adr => (&answer.climb_adr, "1 − mean ADR on D"),
            };
            let steps = &part.value.as_deref()?.climb.steps;
            let points = |added: bool| {
                let of = (1_u32..).zip(steps).filter(move |(_, step)| step.added == added);
                of.map(|(at, step)| [f64::from(at), step.cost]).collect::<Vec<_>>()
            };
            let way = (1_u32..).zip(steps).map(|(at, step)| [f64::from(at), step.cost]).collect();
            let marks = |name: &str, hue, mark, points| Layer::Points {
                name: name.to_owned(),
                style: Style::marks(hue, mark),
                points,
            };
            let layers = vec![
                Layer::Line { name: String::new(), style: Style::line(0, Dash::Solid), points: way },
                marks("an eigenvalue added", 1, Mark::Circle, points(true)),
                marks("one removed", 2, Mark::Square, points(false)),
            ];
            let x = Axis::linear("accepted move").within(0.0, steps.len() as f64 + 1.0);
            Some(drawn::alone(Panel { title: String::new(), x, y: Axis::linear(label), layers }))
        }
        Shown::Shared => match state.answered(&Question::Shared(state.settings.class)) {
            Answered::Found(Finding::Shared(shared), ..) => {
                let title = format!("{}: {} training models", class(state, shared.class as u32), shared.models);
                Some(drawn::purity(&title, shared, state.logarithmic))
            }
            _ => None,
        },
    }
}

/// The eigenvalues of the model looked at, with the line of Weyl's law.
fn spectrum(state: &State) -> Option<Figure> {
    let model = state.answer.models.get(state.model()?)?;
    let eigenvalues = model.eigenvalues.as_deref().filter(|values| !values.is_empty())?;
    let mut layers = Vec::new();
    if let Some(measure) = model.measure.filter(|measure| *measure > 0.0) {
        let (slope, count) = (4.0 * std::f64::consts::PI / measure, eigenvalues.len() as f64);
        let (style, points) = (Style::line(2, Dash::Dashed), vec![[1.0, slope], [count, slope * count]]);
        layers.push(Layer::Line { name: "Weyl's law, 4πk/area".to_owned(), style, points });
    }
    layers.push(drawn::curve("eigenvalues λ".to_owned(), Style::line(1, Dash::Solid), eigenvalues));
    let (x, y) = (Axis::linear("index k"), Axis::linear("λ"));
    Some(drawn::alone(Panel { title: label(state, model), x, y, layers }))
}

fn label(state: &State, model: &ModelRow) -> String {
    format!("{} ({})", model.name, class(state, model.class))
}

fn confusion(state: &State) -> Option<Figure> {
    let method = state.why.method;
    let Answered::Found(Finding::Decisions(decisions), places, _) = state.answered(&Question::Decisions(method)) else {
        return None;
    };
    let matrix = Matrix::new(state.why.side, &state.answer, decisions, places);
    let share = f64::from(matrix.wrong) / f64::from(matrix.total.max(1));
    let title = format!(
        "{} on {}: ε = {share:.3} ({} of {})",
        method.name(),
        state.why.side.name(),
        matrix.wrong,
        matrix.total
    );
    Some(drawn::confusion(&title, &state.answer.classes, &matrix.counts))
}

/// What each eigenvalue adds to the distance of the neighbour looked at, and the two spectra.
fn neighbours(state: &State) -> Option<Figure> {
    let model = state.model()?;
    let row = state.answer.models.get(model)?;
    let method = state.why.method;
    let Answered::Found(finding, places, _) = state.answered(&Question::Reasons { method, model }) else {
        return None;
    };
    let at = state.why.neighbour.min(explore::neighbours(state)?.0.saturating_sub(1));
    match finding {
        Finding::Neighbours(found) => distances(state, row, (found, places), at),
        Finding::Votes(votes) => votes_for(state, row, votes, at),
        _ => None,
    }
}

fn distances(state: &State, row: &ModelRow, (found, places): (&Neighbours, &[usize]), at: usize) -> Option<Figure> {
    let neighbour = found.found.get(at)?;
    let other = places.get(neighbour.model).and_then(|&place| state.answer.models.get(place))?;
    let own = found.own().filter(|_| neighbour.class != found.class);
    let (terms, above, below, title) = if let Some(own) = own {
        let whole: f64 = found.terms(own).iter().map(|(_, term)| term).sum();
        let scale = if whole > 0.0 { whole } else { 1.0 };
        let terms = found.difference(at).into_iter().map(|(index, term)| (index, 100.0 * term / scale)).collect();
        let (above, below) = (class(state, neighbour.class), class(state, found.class));
        (terms, format!("for {above}"), format!("for {below}"), "what each eigenvalue says")
    } else {
        let terms: Vec<_> = found.shares(at).into_iter().map(|(index, term)| (index, 100.0 * term)).collect();
        (terms, "share of the distance".to_owned(), String::new(), "what the distance is made of")
    };
    let upper = drawn::terms(title, "percent of the distance", &terms, &above, &below);
    let (asked, theirs) = found.features(at)?;
    let reach = found.selection.iter().max().map_or(asked.len(), |&last| {
        // As far as the selection looks, and a little further.
        (last as usize + last as usize / 4 + 2).min(asked.len())
    });
    let chosen = found.selection.iter().filter(|_| found.selection.len() <= 60);
    let points = chosen.map(|&index| [f64::from(index), asked[index as usize - 1]]).collect();
    let layers = vec![
        drawn::curve(label(state, other), Style::line(2, Dash::Dashed), &theirs[..reach]),
        drawn::curve(label(state, row), Style::line(1, Dash::Solid), &asked[..reach]),
        Layer::Points { name: "selected".to_owned(), style: Style::marks(0, Mark::Circle), points },
    ];
    let unit = unit(state.answer.settings.normalisation);
    let lower = Panel {
        title: format!("the two spectra, distance {:.4}", neighbour.distance),
        x: Axis::linear("index k"),
        y: Axis::linear(unit),
        layers,
    };
    let title = format!("{} and its neighbour no. {}, {}", label(state, row), at + 1, label(state, other));
    Some(Figure { title: format!("{title}: {}", state.why.method.name()), panels: vec![upper, lower], across: 2 })
}

fn votes_for(state: &State, row: &ModelRow, votes: &Votes, at: usize) -> Option<Figure> {
    let vote = votes.votes.get(at)?;
    let name = class(state, vote.class);
    let title = format!("{}: S = {:.2} for {name}, p = {:.3}", label(state, row), vote.score, vote.probability);
    let (above, below) = (format!("for {name}"), format!("against {name}"));
    Some(drawn::alone(drawn::terms(&title, "Σ α h", votes.terms(at), &above, &below)))
}

/// The figures of every method now and under the pins, or the sweep.
fn compared(state: &State) -> Figure {
    if let Some(sweep) = state.sweep.as_ref().filter(|_| state.why.swept || state.pins.is_empty()) {
        return swept(state, sweep);
    }
    let present = pins::present(state);
    let names: Vec<String> = Method::ALL.iter().map(|method| method.name().to_owned()).collect();
    let panel = |title: &str, adr: bool, query: bool| {
        let points = |figures: &crate::workbench::Figures, settings: &crate::query::Settings, shift: f64| {
            let of = |(at, &method): (usize, &Method)| {
                let score = if adr { figures.adr(method, settings) } else { figures.error(method, settings) }?;
                let value = if query { score.query } else { Some(score.train) }?;
                Some([at as f64 + shift, value])
            };
            Method::ALL.iter().enumerate().filter_map(of).collect::<Vec<_>>()
        };
        let step = 0.5 / (state.pins.len() + 1) as f64;
        let shift = |at: usize| step * (at as f64 - state.pins.len() as f64 / 2.0);
        let mut layers = vec![Layer::Points {
            name: "now".to_owned(),
            style: Style::marks(0, MARKS[0]),
            points: points(&present, &state.settings, shift(0)),
        }];
        for (at, pin) in state.pins.iter().enumerate() {
            layers.push(Layer::Points {
                name: pin_name(state, at),
                style: Style::marks(at + 1, MARKS[(at + 1) % MARKS.len()]),
                points: points(&pin.figures, &pin.settings, shift(at + 1)),
            });
        }
        let (x, y) = (Axis::names("", names.clone()), Axis::linear(if adr { "mean ADR" } else { "ε" }));
        Panel { title: title.to_owned(), x, y: y.within(0.0, 1.0), layers }
    };
    let panels = vec![
        panel("ε on D", false, false),
        panel("ε on Q", false, true),
        panel("mean ADR on D", true, false),
        panel("mean ADR on Q", true, true),
    ];
    Figure { title: String::new(), panels, across: 2 }
}

/// ε and mean ADR of the method over the values of the parameter.
fn swept(state: &State, sweep: &Sweep) -> Figure {
    let (method, name) = (state.why.method, sweep.parameter.name());
    let words = !sweep.parameter.choices().is_empty();
    let panel = |title: &str, adr: bool| {
        let points = |query: bool| {
            let all = sweep.values.iter().zip(&sweep.settings).zip(&sweep.figures).enumerate();
            all.filter_map(|(at, ((value, settings), figures))| {
                let figures = figures.as_ref()?;
                let score = if adr { figures.adr(method, settings) } else { figures.error(method, settings) }?;
                let x = if words { at as f64 } else { value.parse().ok()? };
                Some([x, if query { score.query? } else { score.train }])
            })
            .collect::<Vec<_>>()
        };
        let line = |name: &str, style: Style, points: Vec<[f64; 2]>| {
            let name = name.to_owned();
            // Words have no order that a line would mean.
            if words { Layer::Points { name, style, points } } else { Layer::Line { name, style, points } }
        };
        let styles = [
            Style { hue: 1, dash: Dash::Solid, mark: Some(Mark::Circle) },
            Style { hue: 2, dash: Dash::Dashed, mark: Some(Mark::Triangle) },
        ];
        let x = match (words, state.logarithmic) {
            (true, _) => Axis::names(name, sweep.values.clone()),
            (false, true) => Axis::log(name),
            (false, false) => Axis::linear(name),
        };
        let layers =
            vec![line("training models D", styles[0], points(false)), line("queries Q", styles[1], points(true))];
        Panel { title: String::new(), x, y: Axis::linear(title).within(0.0, 1.0), layers }
    };
    let mut panels = vec![panel("ε", false)];
    // AdaBoost ranks no models.
    if method != Method::Boost {
        panels.push(panel("mean ADR", true));
    }
    let across = panels.len();
    Figure { title: format!("{} over {name}", method.name()), panels, across }
}

fn shape(state: &State) -> Option<Drawing> {
    let model = state.model()?;
    let scene = state.scenes.iter().find(|scene| scene.model == model)?.clone();
    let row = state.answer.models.get(model)?;
    let caption = match (&scene.function, row.size) {
        (Some(function), _) => {
            let value = row.eigenvalues.as_ref().and_then(|values| values.get(function.index - 1));
            let value = value.map_or_else(String::new, |value| format!(" = {value:.4e}"));
            format!("eigenfunction of λ_{}{value}; black where it is 0", function.index)
        }
        (None, Some((vertices, triangles))) => format!("{vertices} vertices, {triangles} triangles"),
        (None, None) => String::new(),
    };
    Some(Drawing::Shape { title: label(state, row), caption, scene })
}

//! The settings on the screen beside those that were put aside, and a sweep over one parameter.
//!
//! ```text
//!  HCBw for ε against the pins                       [] method
//!           ε D     ε Q   ADR D   ADR Q  selected
//!  now    0.263   0.347   0.524   0.486  5
//!  A      0.242   0.368   0.563   0.470  7
//!        +0.021  −0.021  −0.039  +0.016  p 0.42 on D, 0.73 on Q
//!
//!  differs  now  A  B
//!  T        100  20 20
//!
//!  HCBw for ε over kmax 20 – 500           (the curve as it fills)
//! ```

use ratatui::layout::Rect;

use super::{
    dots::Stroke,
    heading::{Note, heading},
    look::Role,
    number,
    pane::{self, Pane},
    plot::{Axis, Mark, Plot, Series},
    text,
};
use crate::{
    query::Settings,
    study::Method,
    workbench::{
        Action, Figures, State, lists,
        pins::{self, Sweep},
    },
};

/// Columns of a figure.
const FIGURE: u16 = 8;
/// Columns before the figures.
const NAME: u16 = 5;

/// The view.
pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let mut rest = pane.area();
    let rows = 2 + state.pins.len() as u16 * 2 + 2;
    let differing = pins::differing(state);
    if state.sweep.is_some() && (state.why.swept || rest.height < 12) {
        return sweep(state, &mut pane.part(rest));
    }
    let upper = pane::cut_top(&mut rest, rows);
    table(state, &mut pane.part(upper));
    if !state.pins.is_empty() {
        legend(&mut pane.part(upper), rows - 1);
    }
    if state.pins.is_empty() {
        let hint = "P puts the present settings aside as pin A; Y sweeps over the chosen parameter";
        for (y, line) in (1..).zip(text::wrap(hint, (rest.width as usize).saturating_sub(2))) {
            pane.part(rest).put(1, y, &line, Role::Faint);
        }
    } else if rest.height > 2 {
        pane::cut_top(&mut rest, 1);
        let list = pane::cut_top(&mut rest, differing.len() as u16 + 1);
        differences(state, &differing, &mut pane.part(list));
    }
    if state.sweep.is_some() && rest.height >= 9 {
        pane::cut_top(&mut rest, 1);
        sweep(state, &mut pane.part(rest));
    }
}

fn selected(figures: &Figures, method: Method, settings: &Settings) -> String {
    let count = figures.selected(method, settings);
    count.map_or_else(
        || number::NONE.to_owned(),
        |count| {
            if count.fract() == 0.0 { format!("{count:.0}") } else { format!("{count:.1}") }
        },
    )
}

/// The figures now and of each pin, with the differences below each pin's.
fn table(state: &State, pane: &mut Pane<'_>) {
    let method = state.why.method;
    heading(pane, 0, &format!("{} against the pins", method.name()), Note::Settled);
    let end = |column: u16| NAME + FIGURE * (column + 1);
    for (column, head) in (0..).zip(["ε D", "ε Q", "ADR D", "ADR Q"]) {
        pane.put_right(end(column), 1, head, Role::Faint);
    }
    let after = end(3) + 2;
    pane.put(after, 1, &text::fit("selected", pane.width().saturating_sub(after) as usize), Role::Faint);
    let present = pins::present(state);
    let now = present.scores(method, &state.settings);
    line(pane, 2, "now", now, &selected(&present, method, &state.settings));
    let at = state.pin.min(state.pins.len().saturating_sub(1));
    let lines = lists::pinned(state);
    let at_line = lines.iter().position(|place| *place == at).unwrap_or(0);
    for (line_of, place) in (0_u16..).zip(lines) {
        let pin = &state.pins[place];
        let y = 3 + 2 * line_of;
        let values = pin.figures.scores(method, &pin.settings);
        line(pane, y, &pin.letter.to_string(), values, &selected(&pin.figures, method, &pin.settings));
        pane.target(Rect::new(0, y, pane.width(), 2), [Action::Scroll(line_of as isize - at_line as isize)]);
        if place == at {
            let style = pane.style(Role::Chosen);
            pane.paint(Rect::new(0, y, 3, 1), style);
        }
        for (column, (now, then)) in (0..).zip(now.into_iter().zip(values)) {
            let (Some(now), Some(then)) = (now, then) else { continue };
            let difference = now - then;
            // Less ε is better, more ADR is.
            let better = if column < 2 { difference < 0.0 } else { difference > 0.0 };
            let role = match (difference == 0.0, better) {
                (true, _) => Role::Faint,
                (_, true) => Role::Good,
                _ => Role::Bad,
            };
            pane.put_right(end(column), y + 1, &format!("{difference:+.3}").replace('-', "−"), role);
        }
        let test = |queries: bool| present.test(&pin.figures, method, queries);
        let roomy = pane.width() >= after + 24;
        let said = match (test(false), test(true)) {
            (Some(train), Some(query)) if roomy => format!("p {train:.3} on D, {query:.3} on Q"),
            (Some(train), Some(query)) => format!("p {train:.2} {query:.2}"),
            (Some(train), None) => format!("p {train:.3} on D"),
            _ => String::new(),
        };
        pane.put(after, y + 1, &text::fit(&said, pane.width().saturating_sub(after) as usize), Role::Plain);
    }
}

fn line(pane: &mut Pane<'_>, y: u16, name: &str, values: [Option<f64>; 4], selected: &str) {
    pane.put(1, y, name, Role::Strong);
    for (column, value) in (0..).zip(values) {
        let role = if column % 2 == 0 { Role::Train } else { Role::Query };
        pane.put_right(NAME + FIGURE * (column + 1), y, &number::ratio(value), role);
    }
    let after = NAME + FIGURE * 4 + 2;
    pane.put(after, y, &text::fit(selected, pane.width().saturating_sub(after) as usize), Role::Plain);
}

/// What the differences and p are.
fn legend(pane: &mut Pane<'_>, y: u16) {
    let room = (pane.width() as usize).saturating_sub(2);
    let long = "now less the pin; p: McNemar's paired test of ε on D, Q";
    let said = if text::width(long) <= room { long } else { "now less the pin; p: McNemar's test of ε on D, Q" };
    pane.put(1, y, &text::fit(said, room), Role::Faint);
}

/// The parameters that differ, now and in each pin.
fn differences(state: &State, differing: &[(crate::query::Parameter, Vec<String>)], pane: &mut Pane<'_>) {
    if differing.is_empty() {
        pane.put(1, 0, "no parameter differs", Role::Faint);
        return;
    }
    pane.put(1, 0, "differs", Role::Faint);
    let columns = 1 + state.pins.len() as u16;
    let wide = (pane.width().saturating_sub(16) / columns).clamp(5, 12);
    let x = |column: u16| 16 + wide * column;
    for (column, name) in
        (0..).zip(std::iter::once("now".to_owned()).chain(state.pins.iter().map(|p| p.letter.to_string())))
    {
        pane.put(x(column), 0, &name, Role::Faint);
    }
    let listed = differing.iter().filter(|(parameter, _)| state.order().takes([parameter.name()]));
    for (y, (parameter, values)) in (1..).zip(listed) {
        pane.put(1, y, parameter.name(), Role::Plain);
        for (column, value) in (0..).zip(values) {
            let role = if *value == values[0] { Role::Plain } else { Role::Strong };
            pane.put(x(column), y, &text::fit(value, wide as usize - 1), role);
        }
    }
}

/// ε of the method over the values of the parameter, on D and on Q.
fn sweep(state: &State, pane: &mut Pane<'_>) {
    let Some(swept) = &state.sweep else { return };
    let method = state.why.method;
    let done = swept.done();
    let title = format!("ε of {} over {}", method.name(), swept.parameter.name());
    let note = if done < swept.values.len() { format!("  {done} of {}", swept.values.len()) } else { String::new() };
    let x = heading(pane, 0, &title, Note::Settled);
    let x = pane.put(x, 0, &note, Role::Warn);
    if pane.width() > x + 12 {
        let x = pane.width() - 10;
        pane.spans(x, 0, [("━ D", Role::Train), ("  ", Role::Plain), ("┅ Q", Role::Query)]);
    }
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    if swept.parameter.choices().is_empty() {
        curve(state, swept, method).draw(&mut pane.part(pane::inset(rest, 1)));
    } else {
        words(state, swept, method, &mut pane.part(rest));
    }
}

/// A line for each word, with bars.
fn words(state: &State, swept: &Sweep, method: Method, pane: &mut Pane<'_>) {
    for (y, ((value, settings), figures)) in (0..).zip(swept.values.iter().zip(&swept.settings).zip(&swept.figures)) {
        let chosen = state.settings.get(swept.parameter) == *value;
        pane.put(1, y, if chosen { "▸" } else { " " }, Role::Plain);
        pane.put(3, y, &text::fit(value, 12), Role::Plain);
        let Some(figures) = figures else {
            pane.put(17, y, "…", Role::Faint);
            continue;
        };
        let [train, query, ..] = figures.scores(method, settings);
        let x = pane.spans(
            17,
            y,
            [
                ("D ", Role::Faint),
                (&number::ratio(train), Role::Train),
                ("  Q ", Role::Faint),
                (&number::ratio(query), Role::Query),
            ],
        );
        let room = (pane.width() as usize).saturating_sub(x as usize + 4).min(30);
        let (bar, _) = super::footer::bar(train.unwrap_or(0.0), room);
        pane.put(x + 2, y, &bar, Role::Train);
    }
}

fn curve(state: &State, swept: &Sweep, method: Method) -> Plot {
    let number = |text: &str| text.parse::<f64>().ok();
    let points = |side: usize| {
        let of = |((value, settings), figures): ((&String, &Settings), &Option<Figures>)| {
            let score = figures.as_ref()?.scores(method, settings)[side]?;
            Some((number(value)?, score))
        };
        swept.values.iter().zip(&swept.settings).zip(&swept.figures).filter_map(of).collect::<Vec<_>>()
    };
    let (train, query) = (points(0), points(1));
    let last = swept.values.last().and_then(|value| number(value)).unwrap_or(2.0);
    let mark = |at: &(f64, f64), character: char, role: Role| Mark { at: *at, character, role };
    let marks = query.iter().map(|at| mark(at, '○', Role::Query));
    let marks = marks.chain(train.iter().map(|at| mark(at, '●', Role::Train))).collect();
    Plot {
        x: Axis::indices(last as usize, state.logarithmic),
        y: Axis::ratios(train.iter().chain(&query).map(|(_, y)| *y).collect::<Vec<_>>()),
        series: vec![
            Series { points: query, role: Role::Query, stroke: Stroke::Dotted, plain: '.' },
            Series { points: train, role: Role::Train, stroke: Stroke::Solid, plain: '#' },
        ],
        marks,
        guide: number(&state.settings.get(swept.parameter)),
    }
}

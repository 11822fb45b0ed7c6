//! All parameters, and what turning the chosen one means.
//!
//! ```text
//!  spectra                        group, the dearest first
//!    operator      fem            the underlined letter chooses
//!  …
//!  ▸ T           ‹ 20 ›           the chosen one
//!    sel           chosen •       • differs from its first value
//!
//!  rounds of AdaBoost             what it does
//!  1 – 1000, big step 10          what it takes
//!  a slice of AdaBoost's run      what it costs
//! ```
//!
//! On narrow screens a strip: the values in as many lines as they need, then the chosen one in words.

use ratatui::{layout::Rect, style::Modifier};

use super::{footer, look::Role, pane, pane::Pane, text};
use crate::{
    laplacian::Operator,
    query::Parameter,
    workbench::{Action, State, parameters},
};

/// Lines kept for the chosen parameter in words, with the gap above.
const WORDS: usize = 5;
/// Columns of the longest name.
const NAME: usize = 13;

/// The value as shown: classes with their name.
fn value(state: &State, parameter: Parameter) -> String {
    match (parameter, state.class()) {
        (Parameter::Class, Some(name)) => format!("{} {name}", state.settings.class + 1),
        _ => state.settings.get(parameter),
    }
}

/// True where the value has no effect now.
fn idle(state: &State, parameter: Parameter) -> bool {
    match parameter {
        Parameter::Mass => state.settings.operator == Operator::Cot,
        Parameter::K => state.settings.k > state.settings.kmax,
        _ => false,
    }
}

/// A line of the panel.
enum Line {
    Gap,
    Title(&'static str),
    Knob(Parameter),
}

/// The lines of the panel, with gaps between the groups where there is room for all.
fn lines(roomy: bool) -> Vec<Line> {
    let mut lines = Vec::new();
    for (title, group) in parameters::GROUPS {
        if roomy && !lines.is_empty() {
            lines.push(Line::Gap);
        }
        lines.push(Line::Title(title));
        lines.extend(group.iter().copied().map(Line::Knob));
    }
    lines
}

/// The panel beside the view: the parameters, those around the chosen one where not all fit, and the chosen one in
/// words.
pub(super) fn column(state: &State, pane: &mut Pane<'_>) {
    let height = pane.height() as usize;
    let roomy = lines(true).len() + WORDS < height;
    let lines = lines(roomy);
    let rows = lines.len().min(height.saturating_sub(WORDS).max(3));
    let at = lines.iter().position(|line| matches!(line, Line::Knob(p) if *p == state.parameter)).unwrap_or(0);
    let first = at.saturating_sub(rows / 2).min(lines.len() - rows);
    for (y, line) in (0..).zip(lines.iter().skip(first).take(rows)) {
        match line {
            Line::Gap => {}
            Line::Title(title) => {
                pane.put(1, y, title, Role::Faint);
            }
            Line::Knob(parameter) => {
                // A second click on the chosen one is for its value.
                let action = if *parameter == state.parameter { Action::Edit } else { Action::Choose(*parameter) };
                pane.target(Rect::new(0, y, pane.width(), 1), [action]);
                row(state, *parameter, y, pane);
            }
        }
    }
    let end = pane.width().saturating_sub(1);
    if first > 0 {
        pane.put_right(end, 0, "↑", Role::Faint);
    }
    if first + rows < lines.len() {
        pane.put_right(end, rows as u16 - 1, "↓", Role::Faint);
    }
    let y = rows as u16 + u16::from(height > rows + WORDS || rows < lines.len());
    let mut rest = pane.area();
    pane::cut_top(&mut rest, y);
    words(state, &mut pane.part(pane::inset(rest, 1)));
}

fn row(state: &State, parameter: Parameter, y: u16, pane: &mut Pane<'_>) {
    let chosen = parameter == state.parameter;
    let changed = state.settings.get(parameter) != state.first.get(parameter);
    let width = pane.width();
    let room = (width as usize).saturating_sub(NAME + 5);
    let shown = text::fit(&value(state, parameter), room);
    let role = if idle(state, parameter) { Role::Faint } else { Role::Plain };
    let name_at = 2;
    let value_at = name_at + NAME as u16 + 1;
    pane.put(name_at, y, parameter.name(), role);
    let letter = parameter.name().to_lowercase().find(parameters::letter(parameter));
    if let Some(at) = letter {
        let style = pane.style(Role::Letter);
        pane.paint(Rect::new(name_at + at as u16, y, 1, 1), style);
    }
    let end = pane.put(value_at, y, &shown, role);
    if chosen {
        pane.put(0, y, "▸", Role::Plain);
        pane.put(value_at - 1, y, "‹", Role::Plain);
        pane.put(end, y, "›", Role::Plain);
        let style = pane.style(Role::Chosen);
        pane.paint(Rect::new(0, y, width, 1), style);
    }
    if changed {
        let style = pane.style(Role::Strong).remove_modifier(Modifier::DIM);
        pane.styled(width - 1, y, "•", style);
    }
}

/// What the chosen parameter does, takes and costs.
fn words(state: &State, pane: &mut Pane<'_>) {
    let parameter = state.parameter;
    let width = pane.width() as usize;
    let (small, big) = parameters::steps(parameter);
    let mut takes = if parameter == Parameter::Class || !parameter.choices().is_empty() {
        footer::range(state)
    } else {
        format!("{}, steps {small} and {big}", footer::range(state))
    };
    if text::width(&takes) > width {
        takes = footer::range(state);
    }
    let mut y = 0;
    // The words of a parameter's choices are in its description already where they need explaining.
    let explained = !parameter.choices().is_empty() && parameter != Parameter::Operator;
    let takes = if explained { String::new() } else { takes };
    let about = match (parameter, idle(state, parameter)) {
        (Parameter::Mass, true) => "without effect on cot, which has no mass matrix",
        (Parameter::K, true) => "beyond kmax, where there is nothing to read off",
        _ => parameter.about(),
    };
    let about = about.split_once(':').filter(|_| parameter == Parameter::Operator).map_or(about, |(head, _)| head);
    for (text, role) in
        [(about, Role::Strong), (takes.as_str(), Role::Plain), (parameters::price(parameter), Role::Faint)]
    {
        for line in text::wrap(text, width) {
            pane.put(0, y, &line, role);
            y += 1;
        }
    }
}

/// Names short enough for a strip.
const fn brief(parameter: Parameter) -> &'static str {
    match parameter {
        Parameter::Normalisation => "norm",
        Parameter::Distance => "dist",
        Parameter::Operator => "op",
        _ => parameter.name(),
    }
}

/// The strip's entries, line by line, with the column of each.
fn packed(state: &State, width: u16) -> Vec<Vec<(u16, Parameter, String)>> {
    let mut lines = vec![Vec::new()];
    let mut x = 1;
    for parameter in parameters::in_order() {
        let shown = text::fit(&value(state, parameter), 12);
        let wide = (text::width(brief(parameter)) + 1 + text::width(&shown) + 2) as u16;
        if x + wide > width && x > 1 {
            lines.push(Vec::new());
            x = 1;
        }
        if let Some(line) = lines.last_mut() {
            line.push((x, parameter, shown));
        }
        x += wide;
    }
    lines
}

/// How many lines the strip takes of a screen of this size.
pub(super) fn strip_height(state: &State, width: u16, height: u16) -> u16 {
    let lines = packed(state, width).len() as u16;
    match height {
        0..8 => 1,
        8..16 => lines.min(2),
        _ => lines + 1,
    }
}

/// The strip above the view.
pub(super) fn strip(state: &State, pane: &mut Pane<'_>) {
    let lines = packed(state, pane.width());
    let whole = lines.len() as u16 <= pane.height();
    let shown: Vec<_> = if whole {
        lines.iter().collect()
    } else {
        // The line with the chosen parameter must be among those shown.
        let at = lines.iter().position(|line| line.iter().any(|(_, p, _)| *p == state.parameter)).unwrap_or(0);
        lines.iter().skip(at.min(lines.len().saturating_sub(pane.height() as usize))).collect()
    };
    for (y, line) in (0..).zip(shown) {
        for (x, parameter, value) in line {
            let chosen = *parameter == state.parameter;
            let end = pane.put(*x, y, brief(*parameter), Role::Faint);
            pane.put(end + 1, y, value, if idle(state, *parameter) { Role::Faint } else { Role::Strong });
            if chosen {
                let wide = (text::width(brief(*parameter)) + text::width(value) + 3) as u16;
                let style = pane.style(Role::Chosen).remove_modifier(Modifier::DIM);
                pane.paint(Rect::new(x - 1, y, wide, 1), style);
            }
        }
    }
    let below = lines.len() as u16;
    if pane.height() > below {
        let room = (pane.width() as usize).saturating_sub(2);
        let about = format!("{}  {}", state.parameter.about(), footer::range(state));
        let about = if text::width(&about) > room { state.parameter.about().to_owned() } else { about };
        pane.put(1, below, &text::fit(&about, room), Role::Plain);
    }
}

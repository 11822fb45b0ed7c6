//! Figure 1: how much the first eigenvalues of a shape vary, over variants made of it and over its class.
//!
//! ```text
//!  Figure 1: the first 100 eigenvalues of 1 Human
//!  (a) variants, FEM         (b) variants, cot
//!  1.0 ┤        ⢀⣠⠔          2.0 ┤       ⣀⠤⠒
//!  mean change of λ against a     FEM    cot
//!  a original
//!  b bent by 60°                1.7 %  1.2 %
//! ```

use super::super::{
    dots::Stroke,
    heading::{Note, heading},
    look::Role,
    names::Names,
    pane::{self, Pane},
    plot::Axis,
    text,
};
use super::lettered::{self, Lettered, letter};
use crate::{
    laplacian::Operator,
    report::paper::variation::{EIGENVALUES, Spectra, Variation, solves},
    workbench::State,
};

/// Columns of a variant and its change, at least and at most, and of a figure.
const WIDE: u16 = 42;
const WIDEST: u16 = 48;
const FIGURE: u16 = 6;

pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let width = (pane.width() as usize).saturating_sub(2);
    let said = match state.variation() {
        Some(Ok(variation)) => return charts(state, variation, pane),
        Some(Err(reason)) => (reason.to_owned(), Role::Warn),
        None => match &state.experiment.varying {
            Some(varying) => {
                let said = format!("{} of {} spectra are there; a calls it off", varying.done, varying.total);
                (said, Role::Warn)
            }
            None => (offer(state), Role::Faint),
        },
    };
    heading(pane, 0, &format!("Figure 1: variation of the first {EIGENVALUES} eigenvalues"), Note::Settled);
    for (y, line) in (1..).zip(text::wrap(&said.0, width)) {
        pane.put(1, y, &line, said.1);
    }
}

/// What the key makes, and what that takes.
fn offer(state: &State) -> String {
    let spectra = solves(state.subject().models.len());
    format!(
        "a makes variants of the first training model of {}: rotated, scaled, bent, smoothed, noisy, refined, \
         simplified, re-meshed, and has the class beside them, under FEM and cot. That is {spectra} spectra of \
         {EIGENVALUES} eigenvalues; those that are not known yet take some seconds of all processors.",
        text::clean(state.class().unwrap_or("the class"))
    )
}

fn charts(state: &State, variation: &Variation, pane: &mut Pane<'_>) {
    let names = Names::new(&state.answer);
    let model = state.answer.models.iter().find(|model| model.name == variation.model);
    let model = text::clean(model.map_or(&variation.model, |model| names.of(model)));
    let class = text::clean(&variation.class);
    heading(
        pane,
        0,
        &format!("Figure 1: the first {} eigenvalues of {model} {class}", variation.count()),
        Note::Settled,
    );
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let across = (rest.width / WIDE).max(1);
    let lines = ((variation.variants.len() as u16).div_ceil(across) + 1).min(rest.height.saturating_sub(8));
    let list = pane::cut_bottom(&mut rest, lines);
    let columns = if rest.width >= 70 { 2 } else { 1 };
    let shown = panels(variation, columns, rest.height);
    let rows = (shown.len() as u16).div_ceil(columns);
    for (row, line) in (0..).zip(shown.chunks(columns as usize)) {
        let high = rest.height / (rows - row);
        let mut strip = pane::cut_top(&mut rest, high);
        for (place, panel) in line.iter().enumerate() {
            let width = strip.width / (line.len() - place) as u16;
            let area = pane::cut_left(&mut strip, width);
            panel.draw(variation.count(), &mut pane.part(area));
        }
    }
    changes(variation, across, &mut pane.part(list));
}

/// What stands for each variant, and how far it is from the original, in so many columns beside each other.
fn changes(variation: &Variation, across: u16, pane: &mut Pane<'_>) {
    let wide = (pane.width() / across).min(WIDEST);
    // The ends of the two figures.
    let [fem_at, cot_at] = [FIGURE + 3, 1].map(|before| wide.saturating_sub(before));
    let room = fem_at.saturating_sub(FIGURE + 3) as usize;
    pane.put(1, 0, &text::fit("mean change of λ against a", room + 2), Role::Faint);
    for column in 0..across {
        pane.put_right(column * wide + fem_at, 0, "FEM", Role::Faint);
        pane.put_right(column * wide + cot_at, 0, "cot", Role::Faint);
    }
    for (place, (spectra, [fem, cot])) in variation.variants.iter().zip(variation.differences()).enumerate() {
        let (x, y) = ((place as u16 % across) * wide, 1 + place as u16 / across);
        pane.put(x + 1, y, &letter(place).to_string(), Role::Class(place));
        let end = pane.put(x + 3, y, &text::fit(&spectra.name, room), Role::Plain);
        match &spectra.why {
            Some(why) if fem.is_none() && cot.is_none() => {
                let room = (x + cot_at).saturating_sub(end + 1) as usize;
                pane.put(end + 1, y, &text::fit(&text::clean(why), room), Role::Faint);
            }
            _ if place > 0 => {
                pane.put_right(x + fem_at, y, &percent(fem), Role::Faint);
                pane.put_right(x + cot_at, y, &percent(cot), Role::Faint);
            }
            _ => {}
        }
    }
}

/// A part in percent, of two digits or three.
fn percent(part: Option<f64>) -> String {
    match part.map(|part| 100.0 * part) {
        None => "none".to_owned(),
        Some(percent) if percent < 1.0 => format!("{percent:.2} %"),
        Some(percent) if percent < 10.0 => format!("{percent:.1} %"),
        Some(percent) => format!("{percent:.0} %"),
    }
}

/// One of the figure's panels: what is above it, its curves, and whether they have letters.
struct Panel {
    title: &'static str,
    curves: Vec<(usize, Vec<[f64; 2]>)>,
    lettered: bool,
}

/// The panels that there is room for, `across` of them beside each other, named as in print. The change is left out
/// first: the list has its mean.
fn panels(variation: &Variation, across: u16, height: u16) -> Vec<Panel> {
    let panel = |title, all: &[Spectra], lettered, of: &dyn Fn(&Spectra) -> Option<Vec<[f64; 2]>>| Panel {
        title,
        curves: all.iter().enumerate().filter_map(|(place, spectra)| Some((place, of(spectra)?))).collect(),
        lettered,
    };
    let variants =
        |title, operator| panel(title, &variation.variants, true, &|spectra| Variation::curve(spectra, operator));
    let change =
        |title, operator| panel(title, &variation.variants, true, &|spectra| variation.change(spectra, operator));
    let class =
        |title, operator| panel(title, &variation.members, false, &|spectra| Variation::curve(spectra, operator));
    let (fem, cot) = (Operator::Fem, Operator::Cot);
    let mut panels = vec![variants("(a) variants, FEM λ/max", fem), variants("(b) variants, cot λ", cot)];
    let rows = |least: u16| usize::from((height / least).max(1));
    if rows(11) >= usize::from(6 / across) {
        panels.extend([change("(c) change of λ, %, FEM", fem), change("(d) change of λ, %, cot", cot)]);
    }
    panels.extend([class("(e) the class, FEM λ/max", fem), class("(f) the class, cot λ", cot)]);
    panels.retain(|panel| !panel.curves.is_empty());
    panels.truncate(rows(8) * usize::from(across));
    panels
}

impl Panel {
    fn draw(&self, count: usize, pane: &mut Pane<'_>) {
        pane.put(1, 0, &text::fit(self.title, (pane.width() as usize).saturating_sub(2)), Role::Plain);
        let curve = |(place, points): &(usize, Vec<[f64; 2]>)| Lettered {
            letter: self.lettered.then(|| letter(*place)),
            points: points.iter().map(|&[k, value]| (k, value)).collect(),
            role: Role::Class(*place),
            stroke: if self.lettered && *place > 0 { Stroke::Dotted } else { Stroke::Solid },
        };
        let values = self.curves.iter().flat_map(|(_, points)| points.iter().map(|point| point[1]));
        let y = Axis::around(values.chain([0.0]));
        let mut rest = pane.area();
        pane::cut_top(&mut rest, 1);
        let plot = lettered::plot(self.curves.iter().map(curve).collect(), Axis::indices(count, false), y);
        plot.draw(&mut pane.part(pane::inset(rest, 1)));
    }
}

//! Figure 1: how much the first eigenvalues of a shape vary, over variants made of it and over its class.
//!
//! ```text
//!  Figure 1: the first 100 eigenvalues of 1 Human
//!  (a) variants, FEM         (b) variants, cot
//!  1.0 ┤        ⢀⣠⠔          2.0 ┤       ⣀⠤⠒
//!  a original   b rotated 0.0 %   c scaled by 2 0.0 %
//! ```

use super::super::{
    dots::Stroke,
    heading::{Note, heading},
    look::Role,
    pane::{self, Pane},
    plot::Axis,
    text,
};
use super::lettered::{self, Lettered, letter};
use crate::{
    laplacian::Operator,
    report::paper::variation::{EIGENVALUES, Spectra, Variation},
    workbench::{State, experiment::variants},
};

pub(super) fn draw(state: &State, pane: &mut Pane<'_>) {
    let width = (pane.width() as usize).saturating_sub(2);
    let said = match state.variation() {
        Some(Ok(variation)) => return charts(&variation, pane),
        Some(Err(reason)) => (reason.to_owned(), Role::Warn),
        None if state.experiment.varying.is_some() => {
            ("the variants are being made and solved; a calls it off".to_owned(), Role::Warn)
        }
        None => {
            let (solves, count) = variants();
            let said = format!(
                "a makes variants of the first training model of {}: rotated, scaled, bent, smoothed, noisy, refined, \
                 simplified, re-meshed. That is {solves} solves of {count} eigenvalues, some seconds of all processors.",
                text::clean(state.class().unwrap_or("the class"))
            );
            (said, Role::Faint)
        }
    };
    heading(pane, 0, &format!("Figure 1: variation of the first {EIGENVALUES} eigenvalues"), Note::Settled);
    for (y, line) in (1..).zip(text::wrap(&said.0, width)) {
        pane.put(1, y, &line, said.1);
    }
}

fn charts(variation: &Variation, pane: &mut Pane<'_>) {
    let (model, class) = (text::clean(&variation.model), text::clean(&variation.class));
    heading(pane, 0, &format!("Figure 1: the first {EIGENVALUES} eigenvalues of {model} {class}"), Note::Settled);
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let differences = variation.differences();
    let wide = 38;
    let across = (rest.width / wide).max(1);
    let lines = (variation.variants.len() as u16).div_ceil(across).min(rest.height.saturating_sub(8));
    let list = pane::cut_bottom(&mut rest, lines);
    let mut panels = vec![
        ("(a) variants, FEM λ/max", Operator::Fem, &variation.variants, true),
        ("(b) variants, cot λ", Operator::Cot, &variation.variants, true),
        ("(c) the class, FEM λ/max", Operator::Fem, &variation.members, false),
        ("(d) the class, cot λ", Operator::Cot, &variation.members, false),
    ];
    panels.retain(|(_, operator, spectra, _)| spectra.iter().any(|spectra| spectra.of(*operator).is_some()));
    let beside = rest.width >= 70;
    let stacked = if beside { panels.len().div_ceil(2) } else { panels.len() };
    let rows = stacked.min((rest.height / 8).max(1) as usize);
    let shown = panels.into_iter().take(rows * if beside { 2 } else { 1 }).collect::<Vec<_>>();
    let high = rest.height / rows.max(1) as u16;
    for line in shown.chunks(if beside { 2 } else { 1 }) {
        let mut strip = pane::cut_top(&mut rest, high);
        for (place, (title, operator, spectra, named)) in line.iter().enumerate() {
            let width = strip.width / (line.len() - place) as u16;
            let area = pane::cut_left(&mut strip, width);
            chart(title, *operator, spectra, *named, &mut pane.part(area));
        }
    }
    let mut list = pane.part(list);
    for (place, (spectra, [fem, _])) in variation.variants.iter().zip(differences).enumerate() {
        let (x, y) = ((place as u16 % across) * wide + 1, place as u16 / across);
        list.put(x, y, &letter(place).to_string(), Role::Class(place));
        let percent = match fem {
            Some(part) if place > 0 => format!(" {:.2} %", 100.0 * part),
            Some(_) => String::new(),
            None => " none".to_owned(),
        };
        let x = list.put(x + 2, y, &text::fit(&spectra.name, wide as usize - 13), Role::Plain);
        list.put(x, y, &percent, Role::Faint);
    }
}

fn chart(title: &str, operator: Operator, spectra: &[Spectra], named: bool, pane: &mut Pane<'_>) {
    pane.put(1, 0, &text::fit(title, (pane.width() as usize).saturating_sub(2)), Role::Plain);
    let curves: Vec<Lettered> = spectra
        .iter()
        .enumerate()
        .filter_map(|(place, spectra)| Some((place, spectra.of(operator)?)))
        .map(|(place, values)| Lettered {
            letter: named.then(|| letter(place)),
            points: (1..).map(f64::from).zip(values.iter().copied()).collect(),
            role: Role::Class(place),
            stroke: if named && place > 0 { Stroke::Dotted } else { Stroke::Solid },
        })
        .collect();
    let values: Vec<f64> = curves.iter().flat_map(|curve| curve.points.iter().map(|(_, value)| *value)).collect();
    let mut rest = pane.area();
    pane::cut_top(&mut rest, 1);
    let plot = lettered::plot(curves, Axis::indices(EIGENVALUES, false), Axis::around(values.into_iter().chain([0.0])));
    plot.draw(&mut pane.part(pane::inset(rest, 1)));
}

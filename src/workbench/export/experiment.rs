//! The faces of the view of curves that show the paper's experiment, as tables and as figures.

use serde_json::json;

use super::{Table, figure};
use crate::{
    figure::{Figure, Layer},
    query::{Finding, Question},
    report::{
        figures as drawn,
        paper::{Variant, variation::Variation},
    },
    study::{Curve, FirstK, Retrieved},
    workbench::{
        Answered, State,
        experiment::{Face, Standing},
    },
};

/// The spectra that are switched on and there.
fn spectra(state: &State) -> Vec<(Variant, std::sync::Arc<FirstK>)> {
    let all = Variant::all().into_iter().enumerate();
    let on = all.filter(|(place, _)| state.experiment.on.contains(place));
    on.filter_map(|(place, variant)| match state.standing(place) {
        Standing::There(first_k) => Some((variant, first_k)),
        _ => None,
    })
    .collect()
}

fn retrieved(state: &State) -> Option<&[Retrieved]> {
    match state.answered(&Question::Retrieval) {
        Answered::Found(Finding::Retrieval(found), ..) => Some(found),
        _ => None,
    }
}

fn variation(state: &State) -> Result<&Variation, String> {
    state.variation().unwrap_or(Err("Figure 1 is not there yet: a makes it")).map_err(str::to_owned)
}

const NO_SPECTRUM: &str = "no spectrum that is switched on is there yet";
const NO_RETRIEVAL: &str = "precision and recall are not there yet";

/// The table behind the face.
///
/// # Errors
/// A line that says why there is none yet.
pub(super) fn table(state: &State) -> Result<Table, String> {
    match state.experiment.face {
        Face::Own => Err("the curves are not there yet".to_owned()),
        Face::Spectra => {
            let spectra = spectra(state);
            let mut table = Table::new(&["spectrum", "k", "error_train", "error_query", "adr_train", "adr_query"]);
            for (variant, first_k) in &spectra {
                let FirstK { error, adr, .. } = &**first_k;
                for place in 0..error.train.len() {
                    let at = |curve: &[f64]| figure(curve.get(place).copied());
                    let values = [at(&error.train), at(&error.query), at(&adr.train), at(&adr.query)];
                    table.rows.push([json!(variant.name()), json!(place + 1)].into_iter().chain(values).collect());
                }
            }
            if table.rows.is_empty() { Err(NO_SPECTRUM.to_owned()) } else { Ok(table) }
        }
        Face::Recall => {
            let found = retrieved(state).ok_or(NO_RETRIEVAL)?;
            let mut table = Table::new(&["scheme", "side", "recall", "precision"]);
            for row in found {
                for (side, precision) in [("train", &row.precision.train), ("query", &row.precision.query)] {
                    let steps = precision.len() as f64;
                    for (at, &value) in precision.iter().enumerate() {
                        let recall = (at + 1) as f64 / steps;
                        let name = drawn::scheme(row.scheme);
                        table.rows.push(vec![json!(name), json!(side), json!(recall), figure(Some(value))]);
                    }
                }
            }
            Ok(table)
        }
        Face::Variation => {
            let variation = variation(state)?;
            let mut table = Table::new(&["kind", "shape", "operator", "index", "value"]);
            for (kind, all) in [("variant", &variation.variants), ("class", &variation.members)] {
                for spectra in all {
                    for (operator, values) in [("fem", &spectra.fem), ("cot", &spectra.cot)] {
                        for (index, &value) in (1..).zip(values.iter().flatten()) {
                            let value = figure(Some(value));
                            table.rows.push(vec![
                                json!(kind),
                                json!(spectra.name),
                                json!(operator),
                                json!(index),
                                value,
                            ]);
                        }
                    }
                }
            }
            Ok(table)
        }
    }
}

/// The face as a figure for print.
///
/// # Errors
/// A line that says why there is none yet.
pub(super) fn drawing(state: &State) -> Result<Figure, String> {
    match state.experiment.face {
        Face::Own => Err("the curves are not there yet".to_owned()),
        Face::Spectra => {
            let spectra = spectra(state);
            if spectra.is_empty() {
                return Err(NO_SPECTRUM.to_owned());
            }
            let panel = |title: &str, label: &str, of: fn(&FirstK) -> &Curve| {
                let layers: Vec<Layer> = spectra
                    .iter()
                    .map(|(variant, first_k)| drawn::curve(variant.name(), variant.style(), &of(first_k).train))
                    .collect();
                drawn::against_k(title, label, state.logarithmic, layers)
            };
            let panels = vec![
                panel("Classification error on D", "ε", |first_k| &first_k.error),
                panel("Mean ADR on D", "mean ADR", |first_k| &first_k.adr),
            ];
            Ok(Figure { title: String::new(), panels, across: 2 })
        }
        Face::Recall => Ok(drawn::precision(retrieved(state).ok_or(NO_RETRIEVAL)?)),
        Face::Variation => Ok(variation(state)?.figure()),
    }
}

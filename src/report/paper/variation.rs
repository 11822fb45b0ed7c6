//! Figure 1: how much the spectrum of one shape varies, over variants made of it and over its class.

use serde::Serialize;

pub use self::make::{Subject, of_class, solves};
use super::Section;
use crate::{
    figure::{Axis, Dash, Figure, Layer, Mark, Panel, Style},
    laplacian::Operator,
    report::{figures, markdown},
    spectrum::Normalisation,
    study::{Cell, Table},
};

mod make;

/// Eigenvalues of each variant, as in the paper.
pub const EIGENVALUES: usize = 100;

/// The spectra of one shape's variants and of its class; made by [`of_class`].
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Variation {
    /// The model that the variants are made of.
    pub model: String,
    /// Its class.
    pub class: String,
    /// Itself, then its variants.
    pub variants: Vec<Spectra>,
    /// The training models of its class.
    pub members: Vec<Spectra>,
}

/// The first eigenvalues of one shape under both operators.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Spectra {
    /// What it is.
    pub name: String,
    /// Vertices.
    pub vertices: usize,
    /// `λ/λ_max` of FEM (the area drops out), or none where they cannot be had.
    pub fem: Option<Vec<f64>>,
    /// λ of cot.
    pub cot: Option<Vec<f64>>,
    /// Why there is none.
    pub why: Option<String>,
}

impl Spectra {
    /// A shape of which no eigenvalue is known yet.
    #[must_use]
    pub fn of(name: &str, vertices: usize) -> Self {
        Self { name: name.to_owned(), vertices, ..Self::default() }
    }

    /// Takes in the eigenvalues of one operator; they may be more than are shown.
    pub fn put(&mut self, operator: Operator, eigenvalues: &[f64]) {
        let count = EIGENVALUES.min(eigenvalues.len());
        match operator {
            Operator::Fem => self.fem = Some(normalisation(operator).apply(eigenvalues, 1.0, count)),
            Operator::Cot => self.cot = Some(eigenvalues[..count].to_vec()),
        }
    }

    /// What is shown of one operator.
    #[must_use]
    pub fn under(&self, operator: Operator) -> Option<&[f64]> {
        match operator {
            Operator::Fem => self.fem.as_deref(),
            Operator::Cot => self.cot.as_deref(),
        }
    }
}

/// The part of the document, or why there is no figure in it.
pub(super) fn section(variation: Result<&Variation, &String>) -> Section {
    let heading = |count: usize| format!("Figure 1: Variation of the first {count} eigenvalues");
    let variation = match variation {
        Ok(variation) => variation,
        Err(reason) => {
            let words = vec![format!("There is none: {}.", markdown::escape(reason))];
            return Section { heading: heading(EIGENVALUES), words, table: None, figure: None };
        }
    };
    let count = variation.count();
    let (model, class) = (markdown::escape(&variation.model), markdown::escape(&variation.class));
    let mut words = vec![format!(
        "(a, b) The first {count} eigenvalues of {model} and of variants made of it: FEM divided by the last of \
         them, cot as they are. (c, d) The same as a change against the original. (e, f) {model} among the training \
         models of its class, {class}. The table has the mean over k of |λ − λ'|/λ' against the original λ', with the \
         zeros left out."
    )];
    words.extend(variation.seen());
    Section {
        heading: heading(count),
        words,
        table: Some(("figure-1-variation".to_owned(), variation.table())),
        figure: Some(("figure-1".to_owned(), variation.figure())),
    }
}

/// How the eigenvalues of an operator are shown.
const fn normalisation(operator: Operator) -> Normalisation {
    match operator {
        Operator::Fem => Normalisation::Max,
        Operator::Cot => Normalisation::None,
    }
}

/// What is above it is not a zero that was rounded.
fn least(eigenvalues: &[f64]) -> f64 {
    1e-9 * eigenvalues.last().copied().unwrap_or(0.0)
}

/// Colours, dashes and marks that tell the variants apart.
const LOOKS: [Style; 9] = [
    Style { hue: 0, dash: Dash::Solid, mark: None },
    Style { hue: 1, dash: Dash::Dashed, mark: Some(Mark::Cross) },
    Style { hue: 2, dash: Dash::Dotted, mark: Some(Mark::Plus) },
    Style { hue: 3, dash: Dash::Solid, mark: Some(Mark::Circle) },
    Style { hue: 4, dash: Dash::Dashed, mark: None },
    Style { hue: 5, dash: Dash::DashDot, mark: None },
    Style { hue: 6, dash: Dash::Solid, mark: Some(Mark::Square) },
    Style { hue: 7, dash: Dash::Solid, mark: Some(Mark::Triangle) },
    Style { hue: 8, dash: Dash::Dashed, mark: Some(Mark::Diamond) },
];

impl Variation {
    /// How many eigenvalues are shown: [`EIGENVALUES`], or all of a shape that has fewer.
    #[must_use]
    pub fn count(&self) -> usize {
        self.variants.first().and_then(|original| original.under(Operator::Fem)).map_or(EIGENVALUES, <[f64]>::len)
    }

    /// The eigenvalues of one of the shapes under an operator, each with its index.
    #[must_use]
    pub fn curve(spectra: &Spectra, operator: Operator) -> Option<Vec<[f64; 2]>> {
        let values = spectra.under(operator)?;
        Some((1_u32..).zip(values).map(|(k, &value)| [f64::from(k), value]).collect())
    }

    /// By how many percent they differ from the original's; its zeros are left out.
    #[must_use]
    pub fn change(&self, spectra: &Spectra, operator: Operator) -> Option<Vec<[f64; 2]>> {
        let (values, original) = (spectra.under(operator)?, self.variants.first()?.under(operator)?);
        let least = least(original);
        let known = (1_u32..).zip(values.iter().zip(original)).filter(|(_, (_, original))| **original > least);
        Some(known.map(|(k, (value, original))| [f64::from(k), 100.0 * (value / original - 1.0)]).collect())
    }

    /// The figure: variants, how far they are from the original, and the class, under both operators, as far as they
    /// are there.
    #[must_use]
    pub fn figure(&self) -> Figure {
        let variants = |of: &dyn Fn(&Spectra) -> Option<Vec<[f64; 2]>>| -> Vec<Layer> {
            let known = |(at, spectra): (usize, &Spectra)| {
                Some(Layer::Line { name: spectra.name.clone(), style: LOOKS[at % LOOKS.len()], points: of(spectra)? })
            };
            self.variants.iter().enumerate().filter_map(known).collect()
        };
        // The others first, so that the model shown lies over them.
        let members = |operator: Operator| -> Vec<Layer> {
            let known = |spectra: &Spectra| {
                let (hue, name) = if spectra.name == self.model { (0, "original") } else { (6, "its class") };
                let points = Self::curve(spectra, operator)?;
                Some((hue, Layer::Line { name: name.to_owned(), style: Style::line(hue, Dash::Solid), points }))
            };
            let mut known: Vec<_> = self.members.iter().filter_map(known).collect();
            known.sort_by_key(|(hue, _)| std::cmp::Reverse(*hue));
            known.into_iter().map(|(_, layer)| layer).collect()
        };
        let panel = |title: String, operator: Operator, layers: Vec<Layer>| Panel {
            title,
            x: Axis::linear("index k").within(0.0, self.count() as f64),
            y: Axis::linear(figures::unit(normalisation(operator))),
            layers,
        };
        let itself = |title: String, operator: Operator| {
            panel(title, operator, variants(&|spectra| Self::curve(spectra, operator)))
        };
        let changed = |title: &str, operator: Operator| Panel {
            y: Axis::linear("change of λ, %"),
            ..panel(title.to_owned(), operator, variants(&|spectra| self.change(spectra, operator)))
        };
        let (model, class) = (&self.model, &self.class);
        let (fem, cot) = (Operator::Fem, Operator::Cot);
        let mut panels = vec![
            itself(format!("(a) variants of {model}, FEM"), fem),
            itself(format!("(b) variants of {model}, cot"), cot),
            changed("(c) against the original, FEM", fem),
            changed("(d) against the original, cot", cot),
            panel(format!("(e) {model} and its class, {class}, FEM"), fem, members(fem)),
            panel(format!("(f) {model} and its class, {class}, cot"), cot, members(cot)),
        ];
        panels.retain(|panel| !panel.layers.is_empty());
        Figure { title: String::new(), panels, across: 2 }
    }

    /// What the figure shows, in words.
    fn seen(&self) -> Option<String> {
        let differences = self.differences();
        let named = || self.variants.iter().zip(&differences).skip(1);
        let most = |operator: usize, wanted: &dyn Fn(&Spectra) -> bool| {
            let known = named().filter(|(spectra, _)| wanted(spectra));
            let known = known.filter_map(|(spectra, of)| Some((spectra.name.as_str(), of[operator]?)));
            known.max_by(|(_, a), (_, b)| a.total_cmp(b))
        };
        let ((fem, fem_by), (cot, cot_by)) = (most(0, &|_| true)?, most(1, &|_| true)?);
        let vertices = self.variants.first()?.vertices;
        let (alike, alike_by) = most(1, &|spectra| spectra.vertices == vertices)?;
        Some(format!(
            "No variant moves the FEM eigenvalues by more than {:.1} % in the mean ({fem}). Cot eigenvalues have no mass \
             matrix, so they fall as vertices are added and rise as they are taken away: by {:.0} % in the mean where \
             that is most ({cot}), and by {:.1} % at most where the vertices stay ({alike}).",
            100.0 * fem_by,
            100.0 * cot_by,
            100.0 * alike_by
        ))
    }

    /// For each variant the mean over k of |λ − λ'|/λ' against the original λ', the zeros left out: of FEM and of cot.
    #[must_use]
    pub fn differences(&self) -> Vec<[Option<f64>; 2]> {
        let difference = |spectra: &Spectra, operator| {
            let (ours, theirs) = (spectra.under(operator)?, self.variants.first()?.under(operator)?);
            let least = least(theirs);
            let terms: Vec<f64> =
                ours.iter().zip(theirs).filter(|(_, b)| **b > least).map(|(a, b)| (a - b).abs() / b).collect();
            (!terms.is_empty()).then(|| terms.iter().sum::<f64>() / terms.len() as f64)
        };
        let both = |spectra: &Spectra| [Operator::Fem, Operator::Cot].map(|operator| difference(spectra, operator));
        self.variants.iter().map(both).collect()
    }

    fn table(&self) -> Table {
        let cell = |value: Option<f64>| value.map_or(Cell::Missing, |value| Cell::Number { value, decimals: 5 });
        // Reasons only where there are any.
        let reasons = self.variants.iter().any(|spectra| spectra.why.is_some());
        let row = |(spectra, [fem, cot]): (&Spectra, [Option<f64>; 2])| {
            let mut cells =
                vec![Cell::Text(spectra.name.clone()), Cell::Count(spectra.vertices as u64), cell(fem), cell(cot)];
            if reasons {
                cells.push(Cell::Text(spectra.why.clone().unwrap_or_default()));
            }
            cells
        };
        let mut columns = ["variant", "vertices", "mean relative change, FEM", "mean relative change, cot"].to_vec();
        if reasons {
            columns.push("why there is none");
        }
        Table {
            number: 0,
            title: format!("Mean relative difference of the first {} eigenvalues", self.count()),
            columns: columns.into_iter().map(String::from).collect(),
            rows: self.variants.iter().zip(self.differences()).map(row).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_small_shape_has_as_many_as_it_has() {
        let mut original = Spectra::of("original", 42);
        let values: Vec<f64> = (0..42).map(f64::from).collect();
        original.put(Operator::Fem, &values);
        original.put(Operator::Cot, &values);
        let variation = Variation { variants: vec![original], ..Variation::default() };
        let section = section(Ok(&variation));
        assert_eq!(section.heading, "Figure 1: Variation of the first 42 eigenvalues");
        assert!(section.words[0].contains("first 42 eigenvalues") && variation.table().title.contains("first 42"));
        assert_eq!(Variation::default().count(), EIGENVALUES);
    }
}

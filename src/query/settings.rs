//! The parameters that are turned.

use serde::{Deserialize, Serialize};

use super::Problem;
use crate::{
    laplacian::{Boundary, Choice, Mass, Operator, Triangulation},
    metrics::{Distance, Scale},
    remesh,
    selection::{Cost, Search, SelCount, Stop, Weak},
    spectrum::Normalisation,
};

/// Greatest kmax and k that can be asked for.
const KMAX_MAX: usize = 5000;
/// The value of `remesh` that leaves the models as they are.
const ORIGINAL: &str = "original";
/// Greatest number of rounds.
const ROUNDS_MAX: usize = 1000;

/// One value for each parameter.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Settings {
    /// Re-mesh every model to so many vertices first; none for the models as they are.
    pub remesh: Option<usize>,
    /// Which eigenproblem.
    pub operator: Operator,
    /// Which mass matrix.
    pub mass: Mass,
    /// What holds on the boundary.
    pub boundary: Boundary,
    /// Which triangles are summed over.
    pub triangulation: Triangulation,
    /// How many eigenvalues of each model are used.
    pub kmax: usize,
    /// What is made of them.
    pub normalisation: Normalisation,
    /// How much each feature counts.
    pub weights: Scale,
    /// How features are compared.
    pub distance: Distance,
    /// The k at which the first-k figures are read off.
    pub k: usize,
    /// Which moves hill climbing takes.
    pub search: Search,
    /// What AdaBoost's weak classifiers may ask.
    pub weak: Weak,
    /// When AdaBoost's rounds end.
    pub stop: Stop,
    /// AdaBoost's rounds T.
    pub rounds: usize,
    /// Which of the two hill climbings is shown in detail.
    pub cost: Cost,
    /// Which number of selected eigenvalues Table 3 shows.
    pub sel: SelCount,
    /// The class whose selection is shown in detail, an index.
    pub class: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            remesh: None,
            operator: Operator::Fem,
            mass: Mass::Consistent,
            boundary: Boundary::Neumann,
            triangulation: Triangulation::Auto,
            kmax: 500,
            normalisation: Normalisation::Max,
            weights: Scale::None,
            distance: Distance::L2,
            search: Search::Strict,
            weak: Weak::Range,
            stop: Stop::Fixed,
            k: 10,
            rounds: 20,
            cost: Cost::Error,
            sel: SelCount::Chosen,
            class: 0,
        }
    }
}

/// Names a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Parameter {
    /// [`Settings::remesh`].
    Remesh,
    /// [`Settings::operator`].
    Operator,
    /// [`Settings::mass`].
    Mass,
    /// [`Settings::boundary`].
    Boundary,
    /// [`Settings::triangulation`].
    Triangulation,
    /// [`Settings::kmax`].
    Kmax,
    /// [`Settings::normalisation`].
    Normalisation,
    /// [`Settings::weights`].
    Weights,
    /// [`Settings::distance`].
    Distance,
    /// [`Settings::search`].
    Search,
    /// [`Settings::weak`].
    Weak,
    /// [`Settings::stop`].
    Stop,
    /// [`Settings::k`].
    K,
    /// [`Settings::rounds`].
    Rounds,
    /// [`Settings::cost`].
    Cost,
    /// [`Settings::sel`].
    Sel,
    /// [`Settings::class`].
    Class,
}

impl Parameter {
    /// All of them, in the order in which they are shown.
    pub const ALL: [Self; 17] = [
        Self::Remesh,
        Self::Operator,
        Self::Mass,
        Self::Boundary,
        Self::Triangulation,
        Self::Kmax,
        Self::Normalisation,
        Self::Weights,
        Self::Distance,
        Self::Search,
        Self::Weak,
        Self::Stop,
        Self::K,
        Self::Rounds,
        Self::Cost,
        Self::Sel,
        Self::Class,
    ];

    /// Its name on the command line and in reports.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Remesh => "remesh",
            Self::Operator => "operator",
            Self::Mass => "mass",
            Self::Boundary => "boundary",
            Self::Triangulation => "triangulation",
            Self::Kmax => "kmax",
            Self::Normalisation => "normalisation",
            Self::Weights => "weights",
            Self::Distance => "distance",
            Self::Search => "search",
            Self::Weak => "weak",
            Self::Stop => "stop",
            Self::K => "k",
            Self::Rounds => "T",
            Self::Cost => "cost",
            Self::Sel => "sel",
            Self::Class => "class",
        }
    }

    /// What it does, in one line.
    #[must_use]
    pub const fn about(self) -> &'static str {
        match self {
            Self::Remesh => "vertices that every model is re-meshed to, or original",
            Self::Operator => "eigenproblem: fem (L f = λ B f) or cot (L f = λ f)",
            Self::Mass => "mass matrix of fem: consistent, lumped, or blended (their mean)",
            Self::Boundary => "condition at open edges: neumann (no slope) or dirichlet (zero)",
            Self::Triangulation => "triangles summed over: auto, given, delaunay or tufted",
            Self::Kmax => "eigenvalues of each model that are used",
            Self::Normalisation => "what is made of λ: none, area (λ·area), max (λ/λ_kmax), weyl, log",
            Self::Weights => "how much each feature counts: none, standard, within, fisher",
            Self::Distance => "how features are compared: l2, l1, chi2, wesd1.5, wesd2",
            Self::Search => "moves of hill climbing: strict (downwards), level, beam",
            Self::Weak => "what AdaBoost asks of an eigenvalue: range, interval, threshold",
            Self::Stop => "AdaBoost ends after T rounds (fixed) or where it is best (early)",
            Self::K => "the k at which the first-k figures are read off",
            Self::Rounds => "rounds of AdaBoost",
            Self::Cost => "what the hill climbing shown minimises: error or adr",
            Self::Sel => "eigenvalues AdaBoost is said to select: chosen, or all ties",
            Self::Class => "the class shown in detail",
        }
    }

    /// The words it takes, or none for a number.
    #[must_use]
    pub const fn choices(self) -> &'static [&'static str] {
        match self {
            Self::Operator => &["fem", "cot"],
            Self::Mass => &["consistent", "lumped", "blended"],
            Self::Boundary => &["neumann", "dirichlet"],
            Self::Triangulation => &["auto", "given", "delaunay", "tufted"],
            Self::Normalisation => &["none", "area", "max", "weyl", "log"],
            Self::Weights => &["none", "standard", "within", "fisher"],
            Self::Distance => &["l2", "l1", "chi2", "wesd1.5", "wesd2"],
            Self::Search => &["strict", "level", "beam"],
            Self::Weak => &["range", "interval", "threshold"],
            Self::Stop => &["fixed", "early"],
            Self::Cost => &["error", "adr"],
            Self::Sel => &["chosen", "ties"],
            Self::Remesh | Self::Kmax | Self::K | Self::Rounds | Self::Class => &[],
        }
    }

    /// The least and the greatest number it takes; `classes` is how many classes there are. `(0, 0)` for words.
    #[must_use]
    pub const fn range(self, classes: usize) -> (usize, usize) {
        match self {
            Self::Remesh => (*remesh::VERTICES.start(), *remesh::VERTICES.end()),
            Self::Kmax | Self::K => (1, KMAX_MAX),
            Self::Rounds => (1, ROUNDS_MAX),
            Self::Class => (1, if classes == 0 { 1 } else { classes }),
            _ => (0, 0),
        }
    }

    /// The parameter of that name (any case).
    #[must_use]
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|parameter| parameter.name().eq_ignore_ascii_case(name))
    }
}

impl Settings {
    /// The eigenproblem.
    #[must_use]
    pub const fn choice(&self) -> Choice {
        Choice::new(self.operator, self.mass).with_boundary(self.boundary).with_triangulation(self.triangulation)
    }

    /// What the spectra are of, besides the meshes.
    #[must_use]
    pub const fn problem(&self) -> Problem {
        Problem { remesh: self.remesh, choice: self.choice() }
    }

    /// The value of a parameter as text: what [`Settings::set`] takes. Classes count from 1.
    #[must_use]
    pub fn get(&self, parameter: Parameter) -> String {
        let word = |index: usize| parameter.choices()[index].to_owned();
        match parameter {
            Parameter::Operator => word(self.operator as usize),
            Parameter::Mass => word(self.mass as usize),
            Parameter::Boundary => word(self.boundary as usize),
            Parameter::Triangulation => word(self.triangulation as usize),
            Parameter::Normalisation => word(self.normalisation as usize),
            Parameter::Weights => word(self.weights as usize),
            Parameter::Distance => word(self.distance as usize),
            Parameter::Search => word(self.search as usize),
            Parameter::Weak => word(self.weak as usize),
            Parameter::Stop => word(self.stop as usize),
            Parameter::Cost => word(self.cost as usize),
            Parameter::Sel => word(self.sel as usize),
            Parameter::Remesh => self.remesh.map_or_else(|| ORIGINAL.to_owned(), |vertices| vertices.to_string()),
            Parameter::Kmax => self.kmax.to_string(),
            Parameter::K => self.k.to_string(),
            Parameter::Rounds => self.rounds.to_string(),
            Parameter::Class => (self.class + 1).to_string(),
        }
    }

    /// Sets a parameter from text.
    ///
    /// # Errors
    /// A line that says which words or numbers the parameter takes.
    pub fn set(&mut self, parameter: Parameter, value: &str, classes: usize) -> Result<(), String> {
        let choices = parameter.choices();
        if choices.is_empty() {
            if parameter == Parameter::Remesh && value.trim().eq_ignore_ascii_case(ORIGINAL) {
                self.remesh = None;
                return Ok(());
            }
            let (least, greatest) = parameter.range(classes);
            let number =
                value.trim().parse::<usize>().ok().filter(|number| (least..=greatest).contains(number)).ok_or_else(
                    || format!("{} takes a number from {least} to {greatest}, not {value:?}", parameter.name()),
                )?;
            match parameter {
                Parameter::Remesh => self.remesh = Some(number),
                Parameter::Kmax => self.kmax = number,
                Parameter::K => self.k = number,
                Parameter::Rounds => self.rounds = number,
                _ => self.class = number - 1,
            }
            return Ok(());
        }
        let index = choices
            .iter()
            .position(|choice| choice.eq_ignore_ascii_case(value.trim()))
            .ok_or_else(|| format!("{} takes {}, not {value:?}", parameter.name(), choices.join(", ")))?;
        match parameter {
            Parameter::Operator => self.operator = [Operator::Fem, Operator::Cot][index],
            Parameter::Mass => self.mass = Mass::ALL[index],
            Parameter::Boundary => self.boundary = [Boundary::Neumann, Boundary::Dirichlet][index],
            Parameter::Triangulation => self.triangulation = Triangulation::ALL[index],
            Parameter::Normalisation => self.normalisation = Normalisation::ALL[index],
            Parameter::Weights => self.weights = Scale::ALL[index],
            Parameter::Distance => self.distance = Distance::ALL[index],
            Parameter::Search => self.search = Search::ALL[index],
            Parameter::Weak => self.weak = Weak::ALL[index],
            Parameter::Stop => self.stop = [Stop::Fixed, Stop::Early][index],
            Parameter::Cost => self.cost = [Cost::Error, Cost::Adr][index],
            _ => self.sel = [SelCount::Chosen, SelCount::Ties][index],
        }
        Ok(())
    }

    /// Moves a parameter by `steps`: words go round, numbers stop at their ends. Says whether it changed.
    pub fn step(&mut self, parameter: Parameter, steps: isize, classes: usize) -> bool {
        let before = self.clone();
        let choices = parameter.choices();
        let next = if parameter == Parameter::Remesh {
            // Below the least number there are the models as they are.
            let (least, greatest) = parameter.range(classes);
            match self.remesh.unwrap_or(0).saturating_add_signed(steps) {
                0 => ORIGINAL.to_owned(),
                _ if self.remesh.is_some_and(|vertices| vertices == least) && steps < 0 => ORIGINAL.to_owned(),
                number => number.clamp(least, greatest).to_string(),
            }
        } else if choices.is_empty() {
            let (least, greatest) = parameter.range(classes);
            let number = self.get(parameter).parse::<usize>().unwrap_or(least);
            number.saturating_add_signed(steps).clamp(least, greatest).to_string()
        } else {
            let at = choices.iter().position(|choice| *choice == self.get(parameter)).unwrap_or(0);
            choices[(at as isize + steps).rem_euclid(choices.len() as isize) as usize].to_owned()
        };
        self.set(parameter, &next, classes).is_ok() && *self != before
    }
}

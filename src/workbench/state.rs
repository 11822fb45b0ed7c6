//! What the screen shows, apart from its size and colours.

use std::{collections::BTreeSet, sync::Arc};

use super::{
    Entry, History, ModelList, Palette, Pin, Replies, Sweep, Why,
    experiment::Experiment,
    journal::Journal,
    lists::Order,
    parameters,
    recipe::Loaded,
    shape::{self, Camera, Pictures, Raster, Scene, Style},
};
use crate::query::{Answer, Parameter, Part, Question, Settings, Stage};

/// A page of the screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum View {
    /// A little of everything.
    #[default]
    Overview,
    /// ε and mean ADR against k.
    Curves,
    /// Tables 1 to 4.
    Tables,
    /// Which eigenvalues AdaBoost selected.
    Selection,
    /// What ran, and what was there already.
    Pipeline,
    /// Every model and what is wrong with it.
    Models,
    /// Which classes are taken for which.
    Confusion,
    /// Why one model is put where it is.
    Neighbours,
    /// One model as a shape.
    Shape,
    /// The settings beside others that were put aside, and a sweep.
    Compare,
}

impl View {
    /// All of them, in the order of their keys.
    pub const ALL: [Self; 10] = [
        Self::Overview,
        Self::Curves,
        Self::Tables,
        Self::Selection,
        Self::Pipeline,
        Self::Models,
        Self::Confusion,
        Self::Neighbours,
        Self::Shape,
        Self::Compare,
    ];

    /// Its name on the tab.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Overview => "Overview",
            Self::Curves => "Curves",
            Self::Tables => "Tables",
            Self::Selection => "Selection",
            Self::Pipeline => "Pipeline",
            Self::Models => "Models",
            Self::Confusion => "Confusion",
            Self::Neighbours => "Neighbours",
            Self::Shape => "Shape",
            Self::Compare => "Compare",
        }
    }

    /// A name of at most six letters for narrow screens.
    #[must_use]
    pub const fn brief(self) -> &'static str {
        match self {
            Self::Overview => "Main",
            Self::Selection => "Bands",
            Self::Pipeline => "Runs",
            Self::Confusion => "Errors",
            Self::Neighbours => "Near",
            Self::Compare => "Pins",
            other => other.name(),
        }
    }

    /// The view so many tabs further, going round.
    #[must_use]
    pub fn turned(self, by: isize) -> Self {
        let count = Self::ALL.len() as isize;
        Self::ALL[(self as isize + by).rem_euclid(count) as usize]
    }
}

/// What the selection view shows where there is room for one figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Figure {
    /// Figure 5: a column per class, the selected bands along the spectrum.
    #[default]
    Map,
    /// Figure 4: eigenvalue against index, a mark per class.
    Marks,
    /// The way that hill climbing took.
    Climb,
    /// Where the class's models keep together, or what tells them from those of the class compared.
    Shared,
}

/// What a line that is typed is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Purpose {
    /// A value of the chosen parameter.
    #[default]
    Value,
    /// What the models listed have in their name or class.
    Needle,
    /// The name of a file to write.
    File,
    /// The name of a folder to write the paper's document to.
    Folder,
}

/// The last change of what the study is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Change {
    /// In words.
    pub what: String,
    /// The stages that it runs again.
    pub stages: Vec<Stage>,
}

impl Change {
    /// From some settings to others.
    #[must_use]
    pub fn between(before: &Settings, after: &Settings) -> Self {
        let changed: Vec<Parameter> = Parameter::ALL.into_iter().filter(|p| before.get(*p) != after.get(*p)).collect();
        let word = |p: &Parameter| format!("{} {} → {}", p.name(), before.get(*p), after.get(*p));
        let runs = |stage: &Stage| changed.iter().any(|p| parameters::invalidates(*p).contains(stage));
        Self {
            what: changed.iter().map(word).collect::<Vec<_>>().join(", "),
            stages: Stage::ALL.into_iter().filter(runs).collect(),
        }
    }

    /// The files were looked at again.
    #[must_use]
    pub fn of_files() -> Self {
        Self { what: "the files".to_owned(), stages: Stage::ALL.to_vec() }
    }
}

/// Whose the mouse is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mouse {
    /// The terminal's, which selects text with it.
    #[default]
    Terminal,
    /// The screen's: wheel and click.
    Screen,
}

/// A line for the user, shown until the next key, or only until the next answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Notice {
    /// What it says.
    pub text: String,
    /// True when something went wrong.
    pub bad: bool,
    /// True when the next answer says more.
    pub brief: bool,
}

/// Everything the screen shows.
#[derive(Debug, Clone)]
pub struct State {
    /// The data set's name, as the user gave it.
    pub title: String,
    /// The parameters as they were turned; shown at once, answered later.
    pub settings: Settings,
    /// What the parameters go back to.
    pub first: Settings,
    /// The newest answer.
    pub answer: Arc<Answer>,
    /// The view shown.
    pub view: View,
    /// The parameter that the keys turn.
    pub parameter: Parameter,
    /// A value being typed for it.
    pub entry: Option<Entry>,
    /// The help is open, scrolled down by so many lines.
    pub help: Option<usize>,
    /// Undo and redo.
    pub history: History,
    /// Classes shown beside the one of the parameter.
    pub compared: BTreeSet<usize>,
    /// The k axis is logarithmic.
    pub logarithmic: bool,
    /// The figure of the selection view.
    pub figure: Figure,
    /// The list of models.
    pub models: ModelList,
    /// What the explaining views look at.
    pub why: Why,
    /// What was looked at before: the views and their models, the newest last.
    pub trail: Vec<(View, Option<usize>)>,
    /// What the engine was asked for the view.
    pub asked: Vec<Question>,
    /// What it answered.
    pub replies: Replies,
    /// What it was asked of shapes and has not answered yet.
    pub looked_for: Vec<Question>,
    /// What was changed last.
    pub changed: Option<Change>,
    /// The stage of the pipeline that the keys act on.
    pub stage: usize,
    /// How each view lists, in the order of [`View::ALL`].
    pub lists: [Order; View::ALL.len()],
    /// The eigenfunction that colours the shape, the index of its eigenvalue from 1.
    pub function: Option<usize>,
    /// The command palette, while it is open.
    pub palette: Option<Palette>,
    /// What the entry is for.
    pub purpose: Purpose,
    /// Settings put aside.
    pub pins: Vec<Pin>,
    /// The pin that the keys act on; may lie beyond the end.
    pub pin: usize,
    /// A sweep over one parameter.
    pub sweep: Option<Sweep>,
    /// The paper's experiment.
    pub experiment: Experiment,
    /// What the engine did.
    pub journal: Journal,
    /// The journal is open, scrolled down by so many lines.
    pub told: Option<usize>,
    /// Files that this session wrote.
    pub written: BTreeSet<String>,
    /// The last session of the data set, until it is taken up.
    pub last: Option<Loaded>,
    /// The settings that are being tried for pins and sweep.
    pub tried: Vec<Settings>,
    /// Where shapes are seen from.
    pub camera: Camera,
    /// How shapes become characters.
    pub style: Style,
    /// The styles that the screen has.
    pub styles: &'static [Style],
    /// How it takes pictures, where pixels are among its styles.
    pub raster: Raster,
    /// What was wanted painted.
    pub scenes: Vec<Scene>,
    /// What was painted.
    pub pictures: Pictures,
    /// The view has the screen for itself, without the parameters.
    pub alone: bool,
    /// Whose the mouse is.
    pub mouse: Mouse,
    /// Lines by which the view is scrolled down; a view stops at its own end.
    pub scroll: usize,
    /// Solving was stopped by the user.
    pub stopped: bool,
    /// The last thing the user should know.
    pub notice: Option<Notice>,
    /// The engine has ended, and why.
    pub fatal: Option<String>,
    /// Columns and rows of the screen.
    pub size: (u16, u16),
}

impl State {
    /// Whether pictures are among the styles, and taken in this way.
    #[must_use]
    pub fn pictured(&self, raster: Raster) -> bool {
        self.styles.contains(&Style::Pixels) && self.raster == raster
    }

    /// The screen takes pictures in this way. Shapes become pictures where they could not be before.
    pub(super) fn take_pictures(&mut self, raster: Raster) {
        self.raster = raster;
        if !self.styles.contains(&Style::Pixels) {
            (self.style, self.styles) = (Style::Pixels, shape::PICTURES);
        }
    }

    /// The state before the first answer.
    #[must_use]
    pub fn new(title: impl Into<String>, settings: Settings) -> Self {
        Self {
            title: title.into(),
            first: settings.clone(),
            answer: Arc::new(Answer { settings: settings.clone(), ..Answer::default() }),
            settings,
            view: View::default(),
            parameter: Parameter::Rounds,
            entry: None,
            help: None,
            history: History::default(),
            compared: BTreeSet::new(),
            logarithmic: true,
            figure: Figure::default(),
            models: ModelList::default(),
            why: Why::default(),
            trail: Vec::new(),
            asked: Vec::new(),
            replies: Replies::default(),
            looked_for: Vec::new(),
            lists: Default::default(),
            changed: None,
            stage: 0,
            function: None,
            palette: None,
            purpose: Purpose::default(),
            pins: Vec::new(),
            pin: 0,
            sweep: None,
            experiment: Experiment::default(),
            journal: Journal::default(),
            told: None,
            written: BTreeSet::new(),
            last: None,
            tried: Vec::new(),
            camera: Camera::default(),
            style: Style::default(),
            styles: shape::CHARACTERS,
            raster: Raster::default(),
            scenes: Vec::new(),
            pictures: Pictures::default(),
            alone: false,
            mouse: Mouse::default(),
            scroll: 0,
            stopped: false,
            notice: None,
            fatal: None,
            size: (80, 24),
        }
    }

    /// Offers to take up the last session.
    pub fn offer(&mut self, last: Loaded) {
        self.last = Some(last);
        let text = "L takes up the last session of this data set".to_owned();
        self.notice = Some(Notice { text, bad: false, brief: false });
    }

    /// True while the value that a stage makes belongs to other parameters than those on the screen.
    #[must_use]
    pub fn awaits(&self, stage: Stage) -> bool {
        let differs = |parameter: &Parameter| self.settings.get(*parameter) != self.answer.settings.get(*parameter);
        self.settings != self.answer.settings
            && Parameter::ALL.iter().filter(|p| differs(p)).any(|p| parameters::invalidates(*p).contains(&stage))
    }

    /// True while a part of the answer, made by `stage`, is not yet what the parameters on the screen ask for.
    #[must_use]
    pub fn stale<T>(&self, part: &Part<T>, stage: Stage) -> bool {
        part.stale || self.awaits(stage)
    }

    /// The class that the parameter names, when there is one.
    #[must_use]
    pub fn class(&self) -> Option<&str> {
        self.answer.classes.get(self.settings.class).map(String::as_str)
    }

    /// Classes shown in Figure 4: the parameter's first, then those it is compared with.
    #[must_use]
    pub fn shown_classes(&self) -> Vec<usize> {
        let count = self.answer.classes.len();
        let others = self.compared.iter().copied().filter(|class| *class != self.settings.class);
        std::iter::once(self.settings.class).chain(others).filter(|class| *class < count).collect()
    }

    /// The class that the parameter's class is told from, where one is compared with it.
    #[must_use]
    pub fn opposed(&self) -> Option<usize> {
        self.shown_classes().get(1).copied()
    }

    /// The model that the list looks at.
    #[must_use]
    pub fn model(&self) -> Option<usize> {
        self.models.model(&self.answer)
    }
}

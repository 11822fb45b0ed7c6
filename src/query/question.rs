//! What a view wants to know beyond the study: asked for only while the view is shown, memoised like all else.

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    sync::Arc,
};

use super::{
    Problem, Settings,
    db::{Cohort, Database, ModelFile},
    examined,
    inquiry::Members,
    library::{Failure, FileAt, Library, Missing},
    reasons,
    stamp::Stamp,
};
use crate::{
    dataset::Role,
    mesh::{Format, Mesh},
    spectrum,
    study::{
        Honest, Method, Retrieved, Splits, Tuned,
        why::{Apart, Decisions, Neighbours, Shared, Votes},
    },
    watch::Unwatched,
};

/// Something that a view wants to know. Models are named by their place in [`Answer::models`](super::Answer::models).
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Question {
    /// What a method decides for every model.
    Decisions(Method),
    /// Why a method decides for a model as it does.
    Reasons {
        /// The method.
        method: Method,
        /// The model.
        model: usize,
    },
    /// Where the models of a class, an index, keep together.
    Shared(usize),
    /// Which eigenvalues tell two classes, two indices, apart.
    Apart {
        /// The class.
        class: usize,
        /// The other one.
        other: usize,
    },
    /// How well each scheme of Table 5 retrieves.
    Retrieval,
    /// How much of each method's error is selection bias.
    Honest,
    /// What nearest neighbours reach when features, weights, distance and k are tuned without the models asked.
    Tuned,
    /// What the paper's figures would be on other splits of the models.
    Splits,
    /// The surface of a model, in the canonical form that its eigenfunctions live on.
    Shape(usize),
    /// An eigenfunction on the surface of a model.
    Function {
        /// The model.
        model: usize,
        /// The index of its eigenvalue, from 1.
        index: usize,
    },
}

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub enum Finding {
    /// Of [`Question::Decisions`].
    Decisions(Arc<Decisions>),
    /// Of [`Question::Reasons`] for the methods that compare models.
    Neighbours(Arc<Neighbours>),
    /// Of [`Question::Reasons`] for AdaBoost.
    Votes(Arc<Votes>),
    /// Of [`Question::Shared`].
    Shared(Arc<Shared>),
    /// Of [`Question::Apart`].
    Apart(Arc<Apart>),
    /// Of [`Question::Retrieval`].
    Retrieval(Arc<Vec<Retrieved>>),
    /// Of [`Question::Honest`].
    Honest(Arc<Honest>),
    /// Of [`Question::Tuned`].
    Tuned(Arc<Tuned>),
    /// Of [`Question::Splits`].
    Splits(Arc<Splits>),
    /// Of [`Question::Shape`].
    Shape(Arc<Mesh>),
    /// Of [`Question::Function`]: a value for each vertex of the shape.
    Function(Arc<Vec<f64>>),
}

/// The answer to a question.
#[derive(Debug, Clone, PartialEq)]
pub struct Reply {
    /// The question.
    pub question: Question,
    /// The parameters it was answered for.
    pub settings: Settings,
    /// For every row of the finding (training models first, then query models) the place of its model.
    pub places: Arc<Vec<usize>>,
    /// What was found, or why there is nothing.
    pub finding: Result<Finding, Arc<str>>,
}

/// A question that can be answered on another thread while the host goes on.
///
/// It holds the database: the host's next write waits until it has noticed and is dropped.
pub(crate) struct Asking {
    database: Database,
    members: Members,
    settings: Settings,
    question: Question,
}

impl Asking {
    pub(crate) const fn new(database: Database, members: Members, settings: Settings, question: Question) -> Self {
        Self { database, members, settings, question }
    }

    /// Answers; none when the host wants to write meanwhile.
    pub(crate) fn answer(self) -> Option<Reply> {
        let Self { database, members, settings, question } = self;
        let rows = rows(&database, &members);
        let asked = catch_unwind(AssertUnwindSafe(|| {
            salsa::Cancelled::catch(AssertUnwindSafe(|| find(&database, &members, &rows, &question)))
        }));
        let finding = match asked {
            Ok(Ok(found)) => found,
            Ok(Err(_)) => return None,
            Err(_) => Err("internal error in the study, please report it".into()),
        };
        let places = rows.iter().map(|&member| members.places[member]).collect();
        Some(Reply { question, settings, places: Arc::new(places), finding })
    }
}

/// The members in the order of a sample's rows: training models first, then query models.
fn rows(db: &Database, members: &Members) -> Vec<usize> {
    let side = |role: Role| members.files.iter().enumerate().filter(move |(_, file)| file.role(db) == role);
    side(Role::Train).chain(side(Role::Query)).map(|(member, _)| member).collect()
}

fn find(db: &Database, members: &Members, rows: &[usize], question: &Question) -> Result<Finding, Failure> {
    let cohort = Cohort::new(db, Arc::clone(&members.files), members.reach);
    let row = |model: usize| {
        let row = rows.iter().position(|&member| members.places[member] == model);
        row.ok_or_else(|| Failure::from("the model takes no part"))
    };
    match *question {
        Question::Decisions(method) => reasons::decision_rows(db, cohort, method).map(Finding::Decisions),
        Question::Reasons { method: Method::Boost, model } => {
            reasons::vote_rows(db, cohort, row(model)?).map(Finding::Votes)
        }
        Question::Reasons { method, model } => {
            reasons::neighbour_rows(db, cohort, method, row(model)?).map(Finding::Neighbours)
        }
        Question::Shared(class) => reasons::shared_rows(db, cohort, class).map(Finding::Shared),
        Question::Apart { class, other } => reasons::apart_rows(db, cohort, class, other).map(Finding::Apart),
        Question::Retrieval => examined::retrieval_rows(db, cohort).map(Finding::Retrieval),
        Question::Honest => examined::honest_rows(db, cohort).map(Finding::Honest),
        Question::Tuned => examined::tuned_rows(db, cohort).map(Finding::Tuned),
        Question::Splits => examined::split_rows(db, cohort).map(Finding::Splits),
        Question::Shape(_) | Question::Function { .. } => Err("a surface is read from its file".into()),
    }
}

/// A surface to be read on another thread.
pub(crate) struct Looking {
    pub(crate) library: Library,
    pub(crate) file: ModelAt,
    pub(crate) settings: Settings,
    pub(crate) problem: Problem,
    /// Of a shape, or of a function on it.
    pub(crate) question: Question,
}

/// Where a model's mesh is.
pub(crate) struct ModelAt {
    pub(crate) path: std::path::PathBuf,
    pub(crate) format: Format,
    pub(crate) stamp: Option<Stamp>,
}

impl ModelAt {
    pub(crate) fn of(db: &Database, file: ModelFile) -> Self {
        Self { path: file.path(db).clone(), format: file.format(db), stamp: file.stamp(db) }
    }
}

impl Looking {
    /// Reads the mesh, and computes the function where one is asked for.
    pub(crate) fn answer(self) -> Reply {
        let finding = self.find();
        Reply { question: self.question, settings: self.settings, places: Arc::default(), finding }
    }

    fn find(&self) -> Result<Finding, Failure> {
        let ModelAt { path, format, stamp } = &self.file;
        let stamp = stamp.ok_or_else(|| Failure::from("the file is not there"))?;
        let file = FileAt { path, format: *format, content: self.library.content(path, stamp)? };
        let missing = |missing: Missing| match missing {
            Missing::Failed(reason) | Missing::Unread(reason) => reason,
            Missing::Cancelled => "it is no longer wanted".into(),
        };
        let mesh = self.library.prepared(file, self.problem).map_err(missing)?;
        let Question::Function { index, .. } = self.question else { return Ok(Finding::Shape(mesh)) };
        let facts = self.library.facts(file).map_err(|unread| unread.reason)?;
        let count = self.settings.kmax.max(index);
        let found = self.library.spectrum(file, (&facts, None), self.problem, count, &Unwatched).map_err(missing)?;
        let place = index.checked_sub(1).filter(|&place| place < found.spectrum.count());
        let place = place.ok_or_else(|| Failure::from(format!("the model has no eigenvalue {index}")))?;
        let vectors = spectrum::eigenvectors(&mesh, self.problem.choice, &found.spectrum, &[place], &Unwatched);
        let vectors = vectors.map_err(|error| Failure::from(error.to_string()))?;
        let first = vectors.into_iter().next().ok_or_else(|| Failure::from("no eigenfunction was found"))?;
        Ok(Finding::Function(Arc::new(first.values)))
    }
}

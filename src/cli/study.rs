//! From arguments to a study: the data set, the parameters, the store, the threads.

use std::{
    num::NonZero,
    path::{Path, PathBuf},
};

use super::{
    args::{Setting, StudyArguments},
    exit::{Failure, chain, complain},
};
use crate::{
    dataset::{self, DataSet},
    query::{Config, Parameter, Settings},
    store::{self, Store},
    workbench::{
        recipe::{self, Loaded},
        worker::Setup,
    },
};

/// What the engine needs to know, found to be in order.
pub(super) struct Study {
    root: PathBuf,
    options: dataset::Options,
    pub(super) data: DataSet,
    pub(super) settings: Settings,
    /// The recipe to begin with.
    pub(super) recipe: Option<Loaded>,
    pub(super) store: Store,
    pub(super) threads: usize,
}

impl Study {
    /// Reads the folder and checks the arguments against it.
    pub(super) fn open(root: &Path, arguments: &StudyArguments) -> Result<Self, Failure> {
        check_folder(root)?;
        let options = dataset::Options { train: arguments.train.clone(), query: arguments.query.clone() };
        let data = dataset::open(root, &options).map_err(|error| Failure::Failed(chain(&error)))?;
        let classes = data.classes.len();
        let recipe = arguments.recipe.as_deref().map(|file| read_recipe(file, classes)).transpose()?;
        let first = recipe.as_ref().map_or_else(Settings::default, |recipe| recipe.settings.clone());
        let settings = settings(first, &arguments.set, &data)?;
        let store = open_store(&store::locate(root, arguments.cache.as_deref()));
        let threads = threads(arguments.threads);
        Ok(Self { root: root.to_owned(), options, data, settings, recipe, store, threads })
    }

    /// For the engine without a screen.
    pub(super) fn into_config(self) -> Config {
        Config { data: self.data, settings: self.settings, store: self.store, threads: self.threads }
    }

    /// For the engine behind the screen, which looks at the folder by itself.
    pub(super) fn into_setup(self) -> Setup {
        Setup {
            root: self.root,
            options: self.options,
            settings: self.settings,
            store: self.store,
            threads: self.threads,
        }
    }
}

/// Says early and plainly what is wrong with the folder's name.
fn check_folder(root: &Path) -> Result<(), Failure> {
    let shown = root.display();
    if root.is_dir() {
        return Ok(());
    }
    Err(Failure::Failed(if root.is_file() {
        format!("{shown}: a file, not a folder; 'tui spectrum {shown}' computes the eigenvalues of a mesh")
    } else {
        format!("{shown}: no such folder")
    }))
}

/// The store.
pub(super) fn open_store(folder: &Path) -> Store {
    Store::open(folder, store::Options::default())
}

/// Says what is wrong with the store: a warning, never a failure.
pub(super) fn warn_of_store(store: &Store) {
    store.warnings().iter().for_each(|warning| complain(warning));
}

/// How many threads: as many as asked for, or as there are processors.
pub(super) fn threads(asked: Option<u16>) -> usize {
    asked.map_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get), usize::from)
}

/// Reads a recipe.
fn read_recipe(file: &Path, classes: usize) -> Result<Loaded, Failure> {
    let text = std::fs::read_to_string(file)
        .map_err(|error| Failure::caused(format!("{}: cannot be read", file.display()), error))?;
    let read = recipe::read(&text, &Settings::default(), classes);
    read.map_err(|error| Failure::Failed(format!("{}: {error}", file.display())))
}

/// The parameters to begin with, with those that were set. A class can be given by its name.
fn settings(mut settings: Settings, set: &[Setting], data: &DataSet) -> Result<Settings, Failure> {
    for Setting { parameter, value } in set {
        let named = (*parameter == Parameter::Class).then(|| data.classes.iter().position(|class| class == value));
        let value = named.flatten().map_or_else(|| value.clone(), |at| (at + 1).to_string());
        settings.set(*parameter, &value, data.classes.len()).map_err(|error| {
            Failure::Usage(if *parameter == Parameter::Class {
                format!("--set: {error}, nor is it the name of a class ({})", data.classes.join(", "))
            } else {
                format!("--set: {error}")
            })
        })?;
    }
    Ok(settings)
}

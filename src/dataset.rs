//! A folder of meshes → labelled models with their split.
//!
//! | layout | classes | split |
//! |---|---|---|
//! | Princeton: `train.cla` and `query.cla` (or `test.cla`) in the folder, or by [`Options`] | the files' | the files' |
//! | `DIR/train/<class>/…`, `DIR/query/<class>/…` (or `test`) | folders | folders |
//! | `DIR/<class>/train/…`, `DIR/<class>/query/…` (or `test`) | folders | folders |
//! | `DIR/<class>/…` | folders | the first three quarters of each class train |
//!
//! Below a class folder a mesh may lie at any depth. Hidden files, and files that are no mesh by their name's ending,
//! are passed over without a word.

use std::{
    io,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

mod folders;
mod name;
mod princeton;
mod walk;

/// Whether a model trains or asks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// In D: selection and leave-one-out scores.
    Train,
    /// In Q: asked against D, never learnt from.
    Query,
}

/// One labelled mesh file.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct Model {
    /// Path below the root without its ending: unique in the data set.
    pub name: String,
    /// The file.
    pub path: PathBuf,
    /// Index into [`DataSet::classes`].
    pub class: u32,
    /// Its side of the split.
    pub role: Role,
}

/// The labelled models of one folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DataSet {
    /// The folder.
    pub root: PathBuf,
    /// Class names; a model's label is an index into them.
    pub classes: Vec<String>,
    /// Ordered by class, then train before query, then name in natural order. Ties between models go to the first.
    pub models: Vec<Model>,
    /// How the folder was understood, in one line ("Princeton .cla", "class folders, first three quarters train").
    pub layout: String,
    /// What was passed over, and why; each names the file.
    pub warnings: Vec<String>,
}

/// What the user says about a folder.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Options {
    /// The `.cla` file of the training models, instead of `train.cla` in the folder. A relative path counts from the
    /// working directory or, where there is no such file, from the folder.
    pub train: Option<PathBuf>,
    /// The `.cla` file of the query models. Without it the folder's own is not used either, once `train` is given.
    pub query: Option<PathBuf>,
}

/// Why a folder is no data set.
#[derive(Debug, thiserror::Error)]
pub enum DataSetError {
    /// The folder or a `.cla` file cannot be read.
    #[error("{}: {source}", path.display())]
    Io {
        /// Which.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The root is a file.
    #[error("{}: not a folder", .0.display())]
    NotAFolder(PathBuf),
    /// A `.cla` file that cannot be understood.
    #[error("{}, line {line}: {defect}", path.display())]
    Cla {
        /// Which.
        path: PathBuf,
        /// Where, counted from 1.
        line: usize,
        /// What is wrong, with the words.
        defect: String,
    },
    /// Query models are named, training models are not.
    #[error("{}: names the query models, but no file names the training models", .0.display())]
    NoTrainingFile(PathBuf),
    /// Meshes lie in the folder itself, so nothing says of which class they are.
    #[error(
        "{}: meshes lie in the folder itself ({count}: {example}, …), so their classes are unknown. Make it\n{LAYOUTS}",
        root.display()
    )]
    Unsorted {
        /// The folder.
        root: PathBuf,
        /// How many meshes.
        count: usize,
        /// The first one's file name.
        example: String,
    },
    /// There is nothing to learn from.
    #[error("{}: no mesh (.obj, .off, .ply, .stl) to train with. Make it\n{LAYOUTS}", .0.display())]
    Empty(PathBuf),
}

/// What a data set may look like, as errors tell it.
const LAYOUTS: &str = "  DIR/<class>/<model>.obj               (the first three quarters of each class train), or
  DIR/train/<class>/… and DIR/query/<class>/…, or
  DIR/<class>/train/… and DIR/<class>/query/…, or
  DIR/train.cla and DIR/query.cla       (Princeton format) with the models anywhere below DIR";

/// Finds the labelled models of a folder. No mesh is opened.
///
/// # Errors
/// [`DataSetError`]: the folder cannot be read, a `.cla` file is malformed, or there are no labelled training models.
/// What is wrong with single files or folders is a warning.
pub fn open(root: &Path, options: &Options) -> Result<DataSet, DataSetError> {
    let metadata = root.metadata().map_err(|source| DataSetError::Io { path: root.to_owned(), source })?;
    if !metadata.is_dir() {
        return Err(DataSetError::NotAFolder(root.to_owned()));
    }
    let found = match princeton::files(root, options)? {
        Some(files) => princeton::open(root, &files)?,
        None => folders::open(root)?,
    };
    found.finish(root)
}

/// What a layout yields: models without their final names, in any order. A class's models have a role all or none.
#[derive(Debug, Default)]
struct Found {
    classes: Vec<String>,
    files: Vec<Labelled>,
    layout: String,
    warnings: Vec<String>,
}

/// A mesh file with its label.
#[derive(Debug, Clone)]
struct Labelled {
    path: PathBuf,
    class: usize,
    /// Its side of the split, where the layout says one.
    role: Option<Role>,
}

impl Found {
    /// Names the models, orders and splits them, and leaves out classes without any.
    fn finish(self, root: &Path) -> Result<DataSet, DataSetError> {
        let Self { classes, files, layout, mut warnings } = self;
        let names = name::unique(root, files.iter().map(|file| file.path.as_path()));
        let mut named: Vec<(String, Labelled)> = names.into_iter().zip(files).collect();
        named.sort_by(|(a, x), (b, y)| {
            (x.class, x.role).cmp(&(y.class, y.role)).then_with(|| name::natural(a.as_bytes(), b.as_bytes()))
        });
        let mut kept = Vec::new();
        let mut models = Vec::with_capacity(named.len());
        for of_class in named.chunk_by(|a, b| a.1.class == b.1.class) {
            let name = &classes[of_class[0].1.class];
            let train = three_quarters(of_class.len());
            let role = |place: usize| if place < train { Role::Train } else { Role::Query };
            let class = kept.len() as u32;
            models.extend(of_class.iter().enumerate().map(|(place, (name, file))| Model {
                name: name.clone(),
                path: file.path.clone(),
                class,
                role: file.role.unwrap_or_else(|| role(place)),
            }));
            if of_class.iter().all(|(_, file)| file.role == Some(Role::Query)) {
                warnings.push(format!("class {name}: no model to train with, only queries"));
            }
            kept.push(name.clone());
        }
        if !models.iter().any(|model| model.role == Role::Train) {
            return Err(DataSetError::Empty(root.to_owned()));
        }
        if let [only] = &kept[..] {
            warnings.push(format!("{}: only one class ({only}), so there is nothing to tell apart", root.display()));
        }
        Ok(DataSet { root: root.to_owned(), classes: kept, models, layout, warnings })
    }
}

/// Three quarters, rounded to the nearest whole number, and at least one.
fn three_quarters(count: usize) -> usize {
    ((3 * count + 2) / 4).max(1)
}

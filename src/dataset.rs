//! A folder of meshes → labelled models with their split.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

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

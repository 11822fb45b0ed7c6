//! Folders and what lies below them.

use std::{
    collections::HashSet,
    ffi::OsStr,
    fs, io,
    path::{Path, PathBuf},
};

use super::name;
use crate::mesh::Format;

/// Deeper than this nobody keeps meshes; it bounds the walk's recursion.
const DEEPEST: usize = 64;

/// What a folder holds, without hidden entries, each in natural order.
#[derive(Debug, Default)]
pub(super) struct Folder {
    /// Folders, and links to folders.
    pub folders: Vec<PathBuf>,
    /// Files that are meshes by their ending, and links to such files.
    pub meshes: Vec<PathBuf>,
}

impl Folder {
    /// Reads a folder; entries that cannot be looked at become warnings if they might be meshes.
    pub(super) fn read(path: &Path, warnings: &mut Vec<String>) -> io::Result<Self> {
        let mut folder = Self::default();
        for entry in fs::read_dir(path)? {
            let entry = entry?;
            if hidden(&entry.file_name()) {
                continue;
            }
            let path = entry.path();
            // Through links, and without opening: a pipe of a mesh's name must not be waited for.
            match fs::metadata(&path) {
                Ok(metadata) if metadata.is_dir() => folder.folders.push(path),
                Ok(metadata) if metadata.is_file() && Format::of(&path).is_some() => folder.meshes.push(path),
                Err(error) if Format::of(&path).is_some() => warnings.push(format!("{}: {error}", path.display())),
                Ok(_) | Err(_) => {}
            }
        }
        folder.folders.sort_by(|a, b| by_name(a, b));
        folder.meshes.sort_by(|a, b| by_name(a, b));
        Ok(folder)
    }
}

fn by_name(a: &Path, b: &Path) -> std::cmp::Ordering {
    name::natural(a.as_os_str().as_encoded_bytes(), b.as_os_str().as_encoded_bytes())
}

/// Names that begin with a dot, and the folder in which macOS archives keep their resource forks.
fn hidden(name: &OsStr) -> bool {
    name.as_encoded_bytes().starts_with(b".") || name == "__MACOSX"
}

/// Walks each folder once, however links lead back to it.
#[derive(Debug, Default)]
pub(super) struct Walk {
    seen: HashSet<PathBuf>,
}

impl Walk {
    /// A walk that does not enter `outside` again, which lies around what is walked.
    pub(super) fn within(outside: &Path) -> Self {
        Self { seen: outside.canonicalize().into_iter().collect() }
    }

    /// All meshes in and below a folder.
    pub(super) fn meshes(&mut self, path: &Path, warnings: &mut Vec<String>) -> Vec<PathBuf> {
        let mut meshes = Vec::new();
        self.visit(path, 0, &mut meshes, warnings);
        meshes
    }

    fn visit(&mut self, path: &Path, depth: usize, meshes: &mut Vec<PathBuf>, warnings: &mut Vec<String>) {
        let read = path.canonicalize().and_then(|real| {
            if depth <= DEEPEST && self.seen.insert(real) { Folder::read(path, warnings).map(Some) } else { Ok(None) }
        });
        match read {
            Ok(Some(folder)) => {
                meshes.extend(folder.meshes);
                for folder in folder.folders {
                    self.visit(&folder, depth + 1, meshes, warnings);
                }
            }
            Ok(None) => {}
            Err(error) => warnings.push(format!("{}: {error}", path.display())),
        }
    }
}

//! Classes that are folders.

use std::path::{Path, PathBuf};

use super::{
    DataSetError, Found, Labelled, Role, name,
    walk::{Folder, Walk},
};

/// Finds the models of a folder whose classes are folders.
pub(super) fn open(root: &Path) -> Result<Found, DataSetError> {
    let mut found = Found::default();
    let top =
        Folder::read(root, &mut found.warnings).map_err(|source| DataSetError::Io { path: root.to_owned(), source })?;
    let split: Vec<(PathBuf, Role)> = top.folders.iter().filter_map(|path| Some((path.clone(), role(path)?))).collect();
    let has = |wanted| split.iter().any(|(_, role)| *role == wanted);
    // A folder "train" alone among others may be a class of locomotives.
    if has(Role::Train) && (has(Role::Query) || top.folders.len() == 1) {
        found.split_of_classes(root, &split, &top);
    } else {
        found.classes_of_splits(root, &top);
    }
    if found.files.is_empty() {
        unsorted(root, &top)?;
        for (side, _) in &split {
            // A folder that cannot be read has its warning, and none of what is looked for.
            let Ok(folder) = Folder::read(side, &mut found.warnings) else { continue };
            unsorted(side, &folder)?;
        }
    }
    found.pass_over(root, &top.meshes, "lies in no class folder");
    Ok(found)
}

/// Refuses a folder that holds meshes itself where it should hold classes.
fn unsorted(path: &Path, folder: &Folder) -> Result<(), DataSetError> {
    let Some(first) = folder.meshes.first() else { return Ok(()) };
    let example = name::text(first.file_name().unwrap_or_default());
    Err(DataSetError::Unsorted { root: path.to_owned(), count: folder.meshes.len(), example })
}

/// The side of the split that a folder's name says.
fn role(folder: &Path) -> Option<Role> {
    let name = folder.file_name()?;
    if name.eq_ignore_ascii_case("train") {
        Some(Role::Train)
    } else if name.eq_ignore_ascii_case("query") || name.eq_ignore_ascii_case("test") {
        Some(Role::Query)
    } else {
        None
    }
}

impl Found {
    /// `DIR/train/<class>/…` and `DIR/query/<class>/…`.
    fn split_of_classes(&mut self, root: &Path, split: &[(PathBuf, Role)], top: &Folder) {
        "train and query folders of class folders".clone_into(&mut self.layout);
        for (side, role) in split {
            let folder = match Folder::read(side, &mut self.warnings) {
                Ok(folder) => folder,
                Err(error) => {
                    self.warnings.push(format!("{}: {error}", side.display()));
                    continue;
                }
            };
            self.pass_over(root, &folder.meshes, "lies in no class folder");
            for path in folder.folders {
                let meshes = Walk::within(root).meshes(&path, &mut self.warnings);
                let class = self.class(&path);
                self.files.extend(meshes.into_iter().map(|path| Labelled { path, class, role: Some(*role) }));
            }
        }
        for path in top.folders.iter().filter(|path| role(path).is_none()) {
            let meshes = Walk::within(root).meshes(path, &mut self.warnings);
            self.pass_over(root, &meshes, "lies neither in train nor in query");
        }
        self.order_classes();
    }

    /// `DIR/<class>/…`, with or without `train` and `query` inside.
    fn classes_of_splits(&mut self, root: &Path, top: &Folder) {
        let mut whole = Vec::new();
        let mut with_split = 0;
        for path in &top.folders {
            let inner = match Folder::read(path, &mut self.warnings) {
                Ok(folder) => folder,
                Err(error) => {
                    self.warnings.push(format!("{}: {error}", path.display()));
                    continue;
                }
            };
            let class = self.class(path);
            let sides: Vec<(&PathBuf, Role)> =
                inner.folders.iter().filter_map(|path| Some((path, role(path)?))).collect();
            let mut labelled = Vec::new();
            for (side, role) in sides {
                let meshes = Walk::within(root).meshes(side, &mut self.warnings);
                labelled.extend(meshes.into_iter().map(|path| Labelled { path, class, role: Some(role) }));
            }
            if labelled.iter().any(|file| file.role == Some(Role::Train)) {
                with_split += 1;
                self.files.extend(labelled);
                let mut others = inner.meshes;
                for path in inner.folders.iter().filter(|path| role(path).is_none()) {
                    others.extend(Walk::within(root).meshes(path, &mut self.warnings));
                }
                self.pass_over(root, &others, "lies neither in train nor in query");
            } else {
                let meshes = Walk::within(root).meshes(path, &mut self.warnings);
                if !meshes.is_empty() {
                    whole.push(path.clone());
                }
                self.files.extend(meshes.into_iter().map(|path| Labelled { path, class, role: None }));
            }
        }
        let layout = match (with_split, whole.len()) {
            (0, _) => "class folders, the first three quarters of each train",
            (_, 0) => "class folders with train and query folders inside",
            _ => "class folders with train and query folders inside, or else the first three quarters train",
        };
        layout.clone_into(&mut self.layout);
        if with_split > 0 {
            for path in &whole {
                let name = path.display();
                self.warnings.push(format!("{name}: has no folder train, so the first three quarters of it train"));
            }
        }
    }

    /// The number of the class of a folder's name.
    fn class(&mut self, folder: &Path) -> usize {
        let name = name::text(folder.file_name().unwrap_or_default());
        self.classes.iter().position(|class| *class == name).unwrap_or_else(|| {
            self.classes.push(name);
            self.classes.len() - 1
        })
    }

    /// Puts the classes in natural order: those of the second folder came after those of the first.
    fn order_classes(&mut self) {
        let mut order: Vec<usize> = (0..self.classes.len()).collect();
        order.sort_by(|&a, &b| name::natural(self.classes[a].as_bytes(), self.classes[b].as_bytes()));
        let mut place = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new;
        }
        for file in &mut self.files {
            file.class = place[file.class];
        }
        self.classes = order.into_iter().map(|old| std::mem::take(&mut self.classes[old])).collect();
    }

    /// Warns of meshes that take no part: in one line, for they may be many.
    fn pass_over(&mut self, root: &Path, meshes: &[PathBuf], why: &str) {
        let Some(first) = meshes.first() else { return };
        let name = name::joined(first.strip_prefix(root).unwrap_or(first));
        let others = match meshes.len() - 1 {
            0 => String::new(),
            others => format!(", and {others} more like it"),
        };
        self.warnings.push(format!("{name}: passed over, for it {why}{others}"));
    }
}

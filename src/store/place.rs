//! Where the store of a data set is.

use std::path::{Component, Path, PathBuf};

/// The store's folder for the data set in `data_root`: `given` if there is one, else the folder `cache` beside the data
/// set if it exists, else the user's cache folder for this program. Without a home folder it is `cache` beside the data
/// set, to be made.
pub fn locate(data_root: &Path, given: Option<&Path>) -> PathBuf {
    let user = directories::ProjectDirs::from("", "", "eigenselect").map(|dirs| dirs.cache_dir().to_path_buf());
    choose(data_root, given, user)
}

fn choose(data_root: &Path, given: Option<&Path>, user: Option<PathBuf>) -> PathBuf {
    if let Some(given) = given {
        return given.to_path_buf();
    }
    let siblings = siblings(data_root);
    let existing = siblings.iter().find(|sibling| sibling.is_dir()).cloned();
    existing.or(user).or_else(|| siblings.into_iter().next()).unwrap_or_else(|| PathBuf::from("cache"))
}

/// `cache` beside the data set as it is written and, where that is another place (a link, `..`), as it really is.
fn siblings(data_root: &Path) -> Vec<PathBuf> {
    let written = std::path::absolute(data_root).ok();
    let written = written.filter(|path| matches!(path.components().next_back(), Some(Component::Normal(_))));
    let real = data_root.canonicalize().ok();
    [written, real].into_iter().flatten().filter_map(|path| Some(path.parent()?.join("cache"))).collect()
}

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    use super::choose;

    #[test]
    fn given_then_sibling_then_user() {
        let room = tempfile::tempdir().unwrap();
        let root = room.path().canonicalize().unwrap();
        let data = root.join("data");
        fs::create_dir_all(data.join("inner")).unwrap();
        let user = root.join("home");
        let place = |given: Option<&Path>| choose(&data, given, Some(user.clone()));

        assert_eq!(place(None), user);
        assert_eq!(choose(&data, None, None), root.join("cache"));
        fs::write(root.join("cache"), "a file is no folder").unwrap();
        assert_eq!(place(None), user);
        fs::remove_file(root.join("cache")).unwrap();
        fs::create_dir(root.join("cache")).unwrap();
        assert_eq!(place(None), root.join("cache"));
        assert_eq!(choose(&data.join("inner").join(".."), None, None), root.join("cache"));
        assert_eq!(choose(&data.join("."), None, None), root.join("cache"));
        assert_eq!(place(Some(Path::new("x/y"))), Path::new("x/y"));
    }

    #[cfg(unix)]
    #[test]
    fn a_linked_data_set_is_found_by_its_name_first() {
        let room = tempfile::tempdir().unwrap();
        let root = room.path().canonicalize().unwrap();
        fs::create_dir_all(root.join("far/shapes")).unwrap();
        fs::create_dir_all(root.join("far/cache")).unwrap();
        fs::create_dir_all(root.join("near")).unwrap();
        std::os::unix::fs::symlink(root.join("far/shapes"), root.join("near/data")).unwrap();
        assert_eq!(choose(&root.join("near/data"), None, None), root.join("far/cache"));
        fs::create_dir(root.join("near/cache")).unwrap();
        assert_eq!(choose(&root.join("near/data"), None, None), root.join("near/cache"));
    }

    #[test]
    fn a_data_set_that_does_not_exist_still_has_a_place() {
        let room = tempfile::tempdir().unwrap();
        let user = room.path().join("home");
        assert_eq!(choose(&room.path().join("no/data"), None, Some(user.clone())), user);
    }
}

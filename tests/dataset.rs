//! Folders → labelled models.

// Helpers of tests, which clippy does not know as tests.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::{
    fs,
    path::{Path, PathBuf},
};

use eigenselect::dataset::{DataSet, DataSetError, Options, Role, open};
use tempfile::TempDir;

/// A folder with files, empty ones: no mesh is opened here.
fn folder(files: &[&str]) -> TempDir {
    let root = tempfile::tempdir().unwrap();
    for file in files {
        put(root.path(), file, "");
    }
    root
}

fn put(root: &Path, file: &str, text: &str) {
    let path = root.join(file);
    fs::create_dir_all(path.parent().unwrap()).unwrap();
    fs::write(path, text).unwrap();
}

fn models(root: &TempDir) -> DataSet {
    open(root.path(), &Options::default()).unwrap()
}

/// The models as "class role name", in order.
fn listed(set: &DataSet) -> Vec<String> {
    let role = |role| if role == Role::Train { "train" } else { "query" };
    set.models.iter().map(|m| format!("{} {} {}", set.classes[m.class as usize], role(m.role), m.name)).collect()
}

#[test]
fn class_folders_are_split_at_three_quarters_in_natural_order() {
    let root = folder(&[
        "cat/m1.off",
        "cat/m2.OFF",
        "cat/m10.obj",
        "cat/m9.ply",
        "ant10/x.stl",
        "ant9/1.off",
        "ant9/2.off",
        "ant9/3.off",
        "README.md",
        "cat/notes.txt",
        "cat/.hidden.off",
        ".git/x.off",
        "cat/._m1.off",
        "__MACOSX/cat/m1.off",
        "empty/readme",
    ]);
    let set = models(&root);
    assert_eq!(set.classes, ["ant9", "ant10", "cat"]);
    assert_eq!(
        listed(&set),
        [
            "ant9 train ant9/1",
            "ant9 train ant9/2",
            "ant9 query ant9/3",
            "ant10 train ant10/x",
            "cat train cat/m1",
            "cat train cat/m2",
            "cat train cat/m9",
            "cat query cat/m10",
        ]
    );
    assert_eq!(set.models[3].path, root.path().join("ant10/x.stl"));
    assert_eq!(set.layout, "class folders, the first three quarters of each train");
    assert_eq!(set.warnings, Vec::<String>::new());
}

#[test]
fn three_quarters_are_rounded_and_at_least_one() {
    for (count, train) in [(1, 1), (2, 2), (3, 2), (4, 3), (5, 4), (6, 5), (7, 5), (8, 6), (20, 15)] {
        let files: Vec<String> = (0..count).map(|i| format!("a/{i}.off")).chain(["b/0.off".into()]).collect();
        let set = models(&folder(&files.iter().map(String::as_str).collect::<Vec<_>>()));
        let found = set.models.iter().filter(|model| model.class == 0 && model.role == Role::Train).count();
        assert_eq!(found, train, "{count}");
    }
}

#[test]
fn the_split_follows_the_order_of_names_not_of_files() {
    // With their endings, a-b.obj comes before a.obj.
    let set = models(&folder(&["x/a.obj", "x/a-b.obj", "x/a-b-c.obj", "y/1.off"]));
    assert_eq!(listed(&set)[..3], ["x train x/a", "x train x/a-b", "x query x/a-b-c"]);
}

#[test]
fn split_folders_of_class_folders() {
    let root = folder(&[
        "Train/cup/2.off",
        "Train/cup/1.off",
        "Train/ant/5.off",
        "test/cup/3.off",
        "test/zebra/9.off",
        "query/ant/6.off",
        "test/loose.off",
        "val/cup/7.off",
        "val/cup/8.off",
    ]);
    let set = models(&root);
    assert_eq!(set.classes, ["ant", "cup", "zebra"]);
    assert_eq!(
        listed(&set),
        [
            "ant train Train/ant/5",
            "ant query query/ant/6",
            "cup train Train/cup/1",
            "cup train Train/cup/2",
            "cup query test/cup/3",
            "zebra query test/zebra/9",
        ]
    );
    assert_eq!(set.layout, "train and query folders of class folders");
    assert_eq!(
        set.warnings,
        [
            "test/loose.off: passed over, for it lies in no class folder",
            "val/cup/7.off: passed over, for it lies neither in train nor in query, and 1 more like it",
            "class zebra: no model to train with, only queries",
        ]
    );
}

#[test]
fn class_folders_with_a_split_inside() {
    let root = folder(&[
        "cup/train/2.off",
        "cup/train/deep/1.off",
        "cup/test/3.off",
        "ant/train/5.off",
        "ant/query/6.off",
        "cup/loose.off",
        "cup/old/4.off",
    ]);
    let set = models(&root);
    assert_eq!(
        listed(&set),
        [
            "ant train ant/train/5",
            "ant query ant/query/6",
            "cup train cup/train/2",
            "cup train cup/train/deep/1",
            "cup query cup/test/3",
        ]
    );
    assert_eq!(set.layout, "class folders with train and query folders inside");
    assert_eq!(
        set.warnings,
        ["cup/loose.off: passed over, for it lies neither in train nor in query, and 1 more like it"]
    );
}

#[test]
fn a_class_without_a_split_among_others_is_split_and_named() {
    let set =
        models(&folder(&["cup/train/1.off", "cup/test/2.off", "ant/1.off", "ant/2.off", "ant/3.off", "ant/4.off"]));
    assert_eq!(listed(&set)[..4], ["ant train ant/1", "ant train ant/2", "ant train ant/3", "ant query ant/4"]);
    assert!(set.warnings[0].ends_with("ant: has no folder train, so the first three quarters of it train"));
}

#[test]
fn a_class_may_be_called_train() {
    let set = models(&folder(&["car/1.off", "train/1.off", "train/2.off", "plane/1.off"]));
    assert_eq!(set.classes, ["car", "plane", "train"]);
}

#[test]
fn meshes_may_lie_deep_in_a_class() {
    let set = models(&folder(&["a/x/models/m.obj", "a/y/models/m.obj", "b/z.obj"]));
    assert_eq!(listed(&set), ["a train a/x/models/m", "a train a/y/models/m", "b train b/z"]);
}

#[test]
fn two_files_of_one_stem_both_stay() {
    let set = models(&folder(&["a/m.obj", "a/m.off", "a/n.off", "b/m.off"]));
    assert_eq!(listed(&set), ["a train a/m.obj", "a train a/m.off", "a query a/n", "b train b/m"]);
}

#[test]
fn folders_that_are_no_data_set_are_told_what_one_looks_like() {
    let error = |root: &TempDir| open(root.path(), &Options::default()).unwrap_err();
    let unsorted = error(&folder(&["1.off", "2.off", "notes/x.txt"]));
    assert!(matches!(&unsorted, DataSetError::Unsorted { count: 2, example, .. } if example == "1.off"));
    let inside = error(&folder(&["train/1.off", "test/2.off"]));
    assert!(matches!(&inside, DataSetError::Unsorted { count: 1, root, .. } if root.ends_with("test")), "{inside:?}");
    let empty = error(&folder(&["a/x.txt"]));
    assert!(matches!(empty, DataSetError::Empty(_)));
    for error in [unsorted, inside, empty] {
        let text = error.to_string();
        for layout in ["DIR/<class>/<model>.obj", "DIR/train/<class>/", "DIR/<class>/train/", "DIR/train.cla"] {
            assert!(text.contains(layout), "{text}");
        }
    }
    let root = folder(&["a.off"]);
    assert!(matches!(open(&root.path().join("a.off"), &Options::default()), Err(DataSetError::NotAFolder(_))));
    let missing = open(&root.path().join("nowhere"), &Options::default()).unwrap_err().to_string();
    assert!(missing.contains("nowhere: "), "{missing}");
}

#[test]
fn loose_meshes_beside_classes_are_named() {
    let set = models(&folder(&["a/1.off", "b/1.off", "x.off"]));
    assert_eq!(set.warnings, ["x.off: passed over, for it lies in no class folder"]);
    let one = models(&folder(&["a/1.off"]));
    assert!(one.warnings[0].ends_with("only one class (a), so there is nothing to tell apart"));
}

const TRAIN: &str = "PSB 1\n3 4\n\nanimal 0 0\n\nhuman animal 2\n10\n9\n\ncup 0 2\n2\n1\n";
const QUERY: &str = "PSB 1\r\n2 2\r\n\r\ncup 0 1\r\n3\r\nhuman animal 1\r\n11\r\n";

#[test]
fn princeton_files_name_models_anywhere_below() {
    let root = folder(&[
        "db/1.off",
        "db/2.off",
        "db/deep/3.off",
        "9.obj",
        "m10.off",
        "db/m11/m11.off",
        "db/other.off",
        "db/.old/1.off",
    ]);
    put(root.path(), "train.cla", TRAIN);
    put(root.path(), "query.cla", QUERY);
    let set = models(&root);
    assert_eq!(set.classes, ["human", "cup"]);
    assert_eq!(
        listed(&set),
        [
            "human train 9",
            "human train m10",
            "human query db/m11/m11",
            "cup train db/1",
            "cup train db/2",
            "cup query db/deep/3",
        ]
    );
    assert_eq!(set.layout, "Princeton .cla: train.cla and query.cla");
    assert_eq!(set.warnings, Vec::<String>::new());
}

#[test]
fn princeton_files_may_be_named_and_may_name_paths() {
    let root = folder(&["a/1.off", "b/1.off", "b/2.off"]);
    put(root.path(), "lists/t.cla", "PSB 1\n2 2\n\nx 0 1\na/1\n\ny 0 1\nb/1.off\n");
    put(root.path(), "lists/q.cla", "PSB 1\n1 1\n\ny 0 1\n2.off\n");
    put(root.path(), "train.cla", "nonsense that is not looked at");
    let named = |train: Option<&str>, query: Option<&str>| Options {
        train: train.map(PathBuf::from),
        query: query.map(|query| root.path().join(query)),
    };
    let set = open(root.path(), &named(Some("lists/t.cla"), Some("lists/q.cla"))).unwrap();
    assert_eq!(listed(&set), ["x train a/1", "y train b/1", "y query b/2"]);
    let alone = open(root.path(), &named(Some("lists/t.cla"), None)).unwrap();
    assert_eq!(alone.models.len(), 2);
    assert!(alone.warnings[0].contains("no queries"), "{:?}", alone.warnings);
    let error = open(root.path(), &named(None, Some("lists/q.cla"))).unwrap_err();
    assert!(matches!(error, DataSetError::NoTrainingFile(_)));
    let error = open(root.path(), &named(Some("lists/none.cla"), None)).unwrap_err().to_string();
    assert!(error.contains("lists/none.cla: "), "{error}");
}

#[test]
fn what_princeton_files_get_wrong_is_a_warning_that_names_it() {
    let root = folder(&["1.off", "1.obj", "2.off", "3.off"]);
    put(root.path(), "train.cla", "PSB 1\n2 9\n\na 0 4\n1\n2\n17\n2\n\nb 0 1\n3\n");
    put(root.path(), "test.cla", "PSB 1\n2 1\n\nb 0 1\n2\n");
    let set = models(&root);
    assert_eq!(listed(&set), ["a train 1", "a train 2", "b train 3"]);
    assert_eq!(
        set.warnings,
        [
            "train.cla: announces 9 models and names 5",
            "train.cla: model 1 is 1.obj; passed over is 1.off",
            "train.cla: model 17 of class a has no mesh file",
            "train.cla: model 2 of class a is already in train.cla in class a",
            "test.cla: model 2 of class b is already in train.cla in class a",
        ]
    );
}

#[test]
fn classes_of_one_name_are_told_apart_by_their_parents() {
    let root = folder(&["1.off", "2.off", "3.off"]);
    put(
        root.path(),
        "train.cla",
        "PSB 1\n5 3\n\nland 0 0\nsea 0 0\n\nother land 1\n1\nother sea 1\n2\n\nplane 0 1\n3\n",
    );
    put(root.path(), "query.cla", "PSB 1\n0 0\n");
    assert_eq!(models(&root).classes, ["land/other", "sea/other", "plane"]);
}

#[test]
fn malformed_princeton_files_are_refused_with_their_line() {
    let root = folder(&["1.off"]);
    for (text, expected) in [
        ("", "line 1: the file is empty"),
        ("\n\nPBS 1\n", "line 3: the file does not begin with PSB, but with \"PBS 1\""),
        ("PSB 1\n", "line 1: the file ends before its counts"),
        ("PSB 1\nmany 3\n", "line 2: needs the numbers of classes and of models, not \"many 3\""),
        ("PSB 1\n1 2\n\na 0 2\n1\n", "line 5: class a announces 2 models, but the file ends after 1"),
        ("PSB 1\n1 2\n\na 0 1\n1\n2\n", "line 6: needs a class, its parent and its number of models, not \"2\""),
        ("PSB 1\n1 2\n\na 0 x\n", "line 4: needs a class, its parent and its number of models, not \"a 0 x\""),
    ] {
        put(root.path(), "train.cla", text);
        let error = open(root.path(), &Options::default()).unwrap_err().to_string();
        assert_eq!(error, format!("{}, {expected}", root.path().join("train.cla").display()));
    }
    put(root.path(), "train.cla", "PSB 1\n1 1\na 0 1\n99\n");
    assert!(matches!(open(root.path(), &Options::default()), Err(DataSetError::Empty(_))));
    fs::rename(root.path().join("train.cla"), root.path().join("query.cla")).unwrap();
    assert!(matches!(open(root.path(), &Options::default()), Err(DataSetError::NoTrainingFile(_))));
}

#[cfg(unix)]
mod unix {
    use std::{
        ffi::OsStr,
        os::unix::{
            ffi::OsStrExt,
            fs::{PermissionsExt, symlink},
            net::UnixListener,
        },
    };

    use super::*;

    #[test]
    fn links_are_followed_and_their_loops_end() {
        let root = folder(&["a/1.off", "b/2.off"]);
        let at = |path: &str| root.path().join(path);
        symlink("../a", at("a/again")).unwrap();
        symlink("..", at("b/up")).unwrap();
        symlink(root.path(), at("a/root")).unwrap();
        symlink("self", at("a/self")).unwrap();
        symlink("../b/2.off", at("a/3.off")).unwrap();
        symlink("nowhere.off", at("b/4.off")).unwrap();
        symlink("a", at("c")).unwrap();
        let set = models(&root);
        let names = listed(&set);
        assert_eq!(
            names,
            ["a train a/1", "a train a/3", "b train b/2", "c train c/1", "c train c/3"],
            "a link to a class is a class of its own"
        );
        assert!(set.warnings.iter().any(|line| line.contains("4.off")), "{:?}", set.warnings);
        put(root.path(), "train.cla", "PSB 1\n1 1\na 0 1\n1\n");
        assert_eq!(models(&root).models.len(), 1);
    }

    #[test]
    fn names_need_not_be_utf8() {
        let root = folder(&["a/1.off"]);
        let odd = root.path().join(OsStr::from_bytes(b"caf\xe9"));
        fs::create_dir(&odd).unwrap();
        fs::write(odd.join(OsStr::from_bytes(b"\xff1.off")), "").unwrap();
        fs::write(odd.join(OsStr::from_bytes(b"\xfe1.off")), "").unwrap();
        let set = models(&root);
        assert_eq!(set.classes, ["a", "caf\\xe9"]);
        assert_eq!(listed(&set)[1..], ["caf\\xe9 train caf\\xe9/\\xfe1", "caf\\xe9 train caf\\xe9/\\xff1"]);
        assert_eq!(set.models[1].path, odd.join(OsStr::from_bytes(b"\xfe1.off")));
    }

    #[test]
    fn what_is_no_file_or_cannot_be_read_does_not_stop_the_rest() {
        let root = folder(&["a/1.off", "b/1.off", "shut/1.off"]);
        let _socket = UnixListener::bind(root.path().join("a/2.off")).unwrap();
        fs::create_dir(root.path().join("a/folder.off")).unwrap();
        let shut = root.path().join("shut");
        fs::set_permissions(&shut, fs::Permissions::from_mode(0o0)).unwrap();
        // A superuser reads it all the same.
        let readable = fs::read_dir(&shut).is_ok();
        let set = models(&root);
        fs::set_permissions(&shut, fs::Permissions::from_mode(0o755)).unwrap();
        assert_eq!(listed(&set)[..2], ["a train a/1", "b train b/1"]);
        assert!(readable || set.warnings.iter().any(|line| line.contains("shut")), "{:?}", set.warnings);
    }
}

#[test]
fn shrec_2007_by_its_princeton_files() {
    let shared = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/shrec07"));
    if !shared.exists() {
        println!("skipped: {} is not there", shared.display());
        return;
    }
    let root = tempfile::tempdir().unwrap();
    for list in ["train.cla", "query.cla"] {
        fs::copy(shared.join(list), root.path().join(list)).unwrap();
    }
    for number in (1..=400).filter(|number| !(261..=280).contains(number)) {
        put(root.path(), &format!("shrec07/{number}.off"), "");
    }
    let set = models(&root);
    assert_eq!((set.classes.len(), set.models.len(), set.warnings.len()), (19, 380, 0));
    assert_eq!((set.classes[0].as_str(), set.classes[18].as_str()), ("human", "four-leg"));
    for class in 0..19 {
        let roles: Vec<Role> = set.models.iter().filter(|model| model.class == class).map(|model| model.role).collect();
        assert_eq!(roles, [[Role::Train; 15].as_slice(), &[Role::Query; 5]].concat());
    }
    assert_eq!(set.models[0].name, "shrec07/1");
    assert_eq!(set.models[379].name, "shrec07/400");
}

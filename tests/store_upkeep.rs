//! `stats`, `verify` and `prune` on folders in every condition.

#![allow(clippy::unwrap_used)] // Helpers of tests are tests.

use std::{
    fs::{self, File},
    path::{Path, PathBuf},
    time::{Duration, SystemTime},
};

use eigenselect::store::{Error, Key, Limits, Options, Repair, Store, Tally, prune, stats, verify};

const HOUR: Duration = Duration::from_hours(1);

/// Puts a value of `bytes` bytes that was used `age` ago.
fn put(store: &Store, key: &Key, bytes: usize, age: Duration) -> PathBuf {
    store.put(key, &vec![1_u8; bytes]);
    let path = path(store, key);
    set_age(&path, age);
    path
}

fn path(store: &Store, key: &Key) -> PathBuf {
    let hex = key.digest().iter().fold(String::new(), |hex, byte| format!("{hex}{byte:02x}"));
    store.dir().join(&hex[..2]).join(format!("{}.entry", &hex[2..]))
}

fn set_age(path: &Path, age: Duration) {
    File::options().append(true).open(path).unwrap().set_modified(SystemTime::now() - age).unwrap();
}

fn length(path: &Path) -> u64 {
    fs::metadata(path).unwrap().len()
}

fn damage(path: &Path, at: usize) {
    let mut bytes = fs::read(path).unwrap();
    bytes[at] ^= 1;
    fs::write(path, bytes).unwrap();
}

#[test]
fn an_absent_folder_is_an_error_that_names_it() {
    let room = tempfile::tempdir().unwrap();
    let dir = room.path().join("absent");
    let errors = [
        stats(&dir).err(),
        verify(&dir, Repair::Remove).err(),
        prune(&dir, &Limits { max_bytes: Some(0), older_than: None }).err(),
    ];
    for error in errors {
        let Some(Error::Folder { dir: named, .. }) = &error else { panic!("{error:?}") };
        assert_eq!(*named, dir);
        assert!(error.unwrap().to_string().contains("absent"));
    }
    assert!(!dir.exists());
}

#[test]
fn an_empty_folder_is_empty() {
    let room = tempfile::tempdir().unwrap();
    fs::write(room.path().join("README.md"), "not an entry").unwrap();
    let found = stats(room.path()).unwrap();
    assert!(found.kinds.is_empty());
    assert_eq!(found.entries, Tally::default());
    assert_eq!(verify(room.path(), Repair::Remove).unwrap(), eigenselect::store::Verification::default());
    let pruned = prune(room.path(), &Limits { max_bytes: Some(0), older_than: Some(Duration::ZERO) }).unwrap();
    assert_eq!(pruned, eigenselect::store::Pruned::default());
    assert!(room.path().join("README.md").exists());
}

#[test]
fn stats_count_by_kind_with_ages() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(room.path(), Options::default());
    let now = SystemTime::now();
    let mut bytes = 0;
    for i in 0..5 {
        bytes += length(&put(&store, &Key::new("spectrum").number(i), 100, HOUR * (i as u32 + 1)));
    }
    let survey = put(&store, &Key::new("survey"), 10, HOUR * 9);
    let unreadable = put(&store, &Key::new("bad"), 10, HOUR);
    damage(&unreadable, 0);
    let other = put(&store, &Key::new("other"), 10, HOUR);
    damage(&other, 8);
    let folder = survey.parent().unwrap();
    fs::write(folder.join(".tmp-abc"), "half").unwrap();
    fs::write(folder.join("notes.txt"), "hello").unwrap();

    let found = stats(room.path()).unwrap();
    let kinds: Vec<_> =
        found.kinds.iter().map(|kind| (kind.kind.as_str(), kind.tally.files, kind.tally.bytes)).collect();
    assert_eq!(kinds, [("spectrum", 5, bytes), ("survey", 1, length(&survey))]);
    assert_eq!(found.entries, Tally { files: 6, bytes: bytes + length(&survey) });
    assert_eq!(found.version, 1);
    assert_eq!(found.unreadable, Tally { files: 1, bytes: length(&unreadable) });
    assert_eq!(found.other_versions, Tally { files: 1, bytes: length(&other) });
    assert_eq!(found.temporaries, Tally { files: 1, bytes: 4 });
    assert_eq!(found.foreign, Tally { files: 1, bytes: 5 });
    let hours = |time: SystemTime| (now.duration_since(time).unwrap().as_secs_f64() / 3600.0).round();
    assert_eq!((hours(found.kinds[0].oldest_use), hours(found.kinds[0].newest_use)), (5.0, 1.0));
}

#[test]
fn verify_names_what_is_damaged_and_removes_only_that() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(room.path(), Options::default());
    let paths: Vec<_> = (0..8).map(|i| put(&store, &Key::new("spectrum").number(i), 500, HOUR)).collect();
    damage(&paths[0], 300);
    damage(&paths[1], 20);
    fs::copy(&paths[2], &paths[3]).unwrap();
    File::options().append(true).open(&paths[4]).unwrap().set_len(77).unwrap();
    damage(&paths[5], 8);
    let foreign = paths[6].parent().unwrap().join("notes.txt");
    fs::write(&foreign, "hello").unwrap();

    let reported = verify(room.path(), Repair::Report).unwrap();
    assert_eq!((reported.right.files, reported.other_versions.files, reported.problems.len()), (3, 1, 0));
    let mut named: Vec<_> = reported.damaged.iter().map(|damaged| (&damaged.path, damaged.removed)).collect();
    let mut expected = [0, 1, 3, 4].map(|i| (&paths[i], false));
    named.sort();
    expected.sort();
    assert_eq!(named, expected);
    let reason = |i: usize| &reported.damaged.iter().find(|damaged| damaged.path == paths[i]).unwrap().reason;
    assert!(reason(0).contains("checksum"), "{}", reason(0));
    assert!(reason(3).contains("another key"), "{}", reason(3));
    assert!(reason(4).contains("77 bytes"), "{}", reason(4));
    assert!(paths.iter().all(|path| path.exists()));

    let removed = verify(room.path(), Repair::Remove).unwrap();
    assert_eq!(removed.damaged.iter().filter(|damaged| damaged.removed).count(), 4);
    let left: Vec<_> = (0..8).filter(|i| paths[*i].exists()).collect();
    assert_eq!(left, [2, 5, 6, 7]);
    assert!(foreign.exists());
    assert_eq!(verify(room.path(), Repair::Report).unwrap().damaged, vec![]);
}

#[test]
fn prune_removes_by_age() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(room.path(), Options::default());
    let paths: Vec<_> =
        (0..6).map(|i| put(&store, &Key::new("spectrum").number(i), 100, HOUR * 24 * i as u32)).collect();
    let bytes = length(&paths[0]);
    let limits = Limits { max_bytes: None, older_than: Some(HOUR * 24 * 3 + HOUR) };
    let pruned = prune(room.path(), &limits).unwrap();
    assert_eq!(pruned.removed, Tally { files: 2, bytes: 2 * bytes });
    assert_eq!(pruned.kept, Tally { files: 4, bytes: 4 * bytes });
    assert_eq!(paths.iter().map(|path| path.exists()).collect::<Vec<_>>(), [true, true, true, true, false, false]);
    assert_eq!(prune(room.path(), &limits).unwrap().removed, Tally::default());
    // A clock that was set back makes nothing old.
    File::options().append(true).open(&paths[0]).unwrap().set_modified(SystemTime::now() + HOUR * 48).unwrap();
    assert_eq!(prune(room.path(), &limits).unwrap().removed, Tally::default());
}

#[test]
fn prune_keeps_what_was_used_last() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(room.path(), Options::default());
    let keys: Vec<_> = (0..5).map(|i| Key::new("spectrum").number(i)).collect();
    let paths: Vec<_> = keys.iter().zip(1..).map(|(key, age)| put(&store, key, 1000, HOUR * 2 * age)).collect();
    let bytes = length(&paths[0]);
    // The oldest is asked for again, and so is the youngest.
    assert!(store.get::<Vec<u8>>(&keys[4]).is_some());
    let pruned = prune(room.path(), &Limits { max_bytes: Some(3 * bytes + 10), older_than: None }).unwrap();
    assert_eq!((pruned.removed.files, pruned.kept.files, pruned.kept.bytes), (2, 3, 3 * bytes));
    assert_eq!(paths.iter().map(|path| path.exists()).collect::<Vec<_>>(), [true, true, false, false, true]);
    let pruned = prune(room.path(), &Limits { max_bytes: Some(0), older_than: None }).unwrap();
    assert_eq!((pruned.removed.files, pruned.kept.files), (3, 0));
    assert!(keys.iter().all(|key| store.get::<Vec<u8>>(key).is_none()));
    assert_eq!(store.warnings(), Vec::<String>::new());
}

#[test]
fn prune_sweeps_only_what_killed_writers_left_long_ago() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(room.path(), Options::default());
    let folder = put(&store, &Key::new("spectrum"), 100, HOUR).parent().unwrap().to_path_buf();
    let (old, young, foreign) = (folder.join(".tmp-old"), folder.join(".tmp-young"), folder.join("tmp-old"));
    for (path, age) in [(&old, HOUR * 2), (&young, HOUR / 2), (&foreign, HOUR * 1000)] {
        fs::write(path, "half an entry").unwrap();
        set_age(path, age);
    }
    let pruned = prune(room.path(), &Limits::default()).unwrap();
    assert_eq!(pruned.abandoned, Tally { files: 1, bytes: 13 });
    assert_eq!((pruned.removed.files, pruned.kept.files), (0, 1));
    assert_eq!((old.exists(), young.exists(), foreign.exists()), (false, true, true));
}

#[cfg(unix)]
#[test]
fn links_are_not_followed_out_of_the_folder() {
    let room = tempfile::tempdir().unwrap();
    let elsewhere = Store::open(&room.path().join("elsewhere"), Options::default());
    let key = Key::new("spectrum");
    let entry = put(&elsewhere, &key, 100, HOUR * 1000);
    let dir = room.path().join("cache");
    fs::create_dir(&dir).unwrap();
    std::os::unix::fs::symlink(entry.parent().unwrap(), dir.join(entry.parent().unwrap().file_name().unwrap()))
        .unwrap();
    let inner = dir.join("00");
    fs::create_dir(&inner).unwrap();
    std::os::unix::fs::symlink(&entry, inner.join(entry.file_name().unwrap())).unwrap();
    let pruned = prune(&dir, &Limits { max_bytes: Some(0), older_than: Some(Duration::ZERO) }).unwrap();
    assert_eq!(pruned.removed, Tally::default());
    assert_eq!(verify(&dir, Repair::Remove).unwrap().damaged, vec![]);
    assert!(entry.exists());
}

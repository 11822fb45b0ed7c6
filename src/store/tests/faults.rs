//! Every step of the disk fails in every way: a warning, and no wrong value.

use std::{fs, io, time::Duration};

use super::{Fault, Room, Shaky, Step, none, open};
use crate::store::{
    Key, Limits, Options, Store,
    disk::{Disk, Local},
    entry, prune,
};

/// The numbers of ENOENT (for a removed folder), EIO, EACCES, EROFS, ENOSPC and EDQUOT on Linux; any others would do.
const CODES: [i32; 6] = [2, 5, 13, 30, 28, 122];
const WRITING: [Step; 6] = [Step::Folder, Step::Create, Step::Write, Step::Sync, Step::Rename, Step::SyncFolder];

fn key(number: u64) -> Key {
    Key::new("fault").number(number)
}

#[test]
fn a_failing_write_costs_one_warning_and_nothing_else() {
    for step in WRITING {
        for fault in CODES.map(Fault::Fails).into_iter().chain(CODES.map(Fault::Short)) {
            let room = Room::new();
            room.store.put(&key(0), &"old".to_owned());
            room.disk.set(Some((step, fault)));
            for number in 0..20 {
                room.store.put(&key(number), &"new".to_owned());
                room.store.update(&key(number), |current: Option<String>| current.map(|text| text + "er"));
            }
            let warnings = room.store.warnings();
            let error = io::Error::from_raw_os_error(match fault {
                Fault::Fails(code) | Fault::Short(code) => code,
                _ => unreachable!(),
            });
            assert!(
                matches!(&warnings[..], [one] if one.contains("cannot write") && one.contains(&error.to_string())),
                "{step:?} {fault:?}: {warnings:?}"
            );
            // Only the last step is too late to keep the new value from being there.
            for number in 0..20 {
                let expected = match (step, number) {
                    (Step::SyncFolder, _) => Some("newer".to_owned()),
                    (_, 0) => Some("old".to_owned()),
                    _ => None,
                };
                assert_eq!(room.store.get(&key(number)), expected, "{step:?} {fault:?}");
            }
            assert_eq!(room.temporaries(), 0, "{step:?} {fault:?}");

            room.disk.set(None);
            room.store.put(&key(0), &"healed".to_owned());
            assert_eq!(room.store.get(&key(0)), Some("healed".to_owned()), "{step:?} {fault:?}");
        }
    }
}

#[test]
fn a_read_only_disk_costs_one_warning_and_is_still_read() {
    let mut room = Room::new();
    room.store.put(&key(0), &0_u64);
    room.reopen();
    room.disk.set([Step::Create, Step::Lock, Step::Mark].map(|step| (step, Fault::Fails(30))));
    for number in 0..20 {
        room.store.update(&key(number), |current: Option<u64>| Some(current.unwrap_or_default() + 1));
        assert_eq!(room.store.get(&key(number)), (number == 0).then_some(0_u64));
    }
    let warnings = room.store.warnings();
    assert!(matches!(&warnings[..], [one] if one.contains("cannot write")), "{warnings:?}");
}

#[test]
fn a_failing_read_is_a_miss_with_one_warning() {
    for code in CODES.into_iter().filter(|code| *code != 2) {
        let room = Room::new();
        room.store.put(&key(0), &1_u64);
        room.disk.set(Some((Step::Read, Fault::Fails(code))));
        for _ in 0..20 {
            assert_eq!(room.store.get::<u64>(&key(0)), None);
        }
        let warnings = room.store.warnings();
        assert!(matches!(&warnings[..], [one] if one.contains("cannot read")), "{code}: {warnings:?}");
        room.disk.set(None);
        assert_eq!(room.store.get(&key(0)), Some(1_u64));
    }
}

#[test]
fn a_disk_that_lies_about_writing_gives_a_miss() {
    let mut room = Room::new();
    room.store.put(&key(0), &"old".to_owned());
    room.disk.set(Some((Step::Write, Fault::Lies)));
    room.store.put(&key(0), &"new".to_owned());
    room.store.put(&key(1), &"new".to_owned());
    assert_eq!(room.store.warnings(), none());
    room.disk.set(None);
    room.reopen();
    for number in 0..2 {
        assert_eq!(room.store.get::<String>(&key(number)), None);
        room.store.put(&key(number), &"newer".to_owned());
        assert_eq!(room.store.get(&key(number)), Some("newer".to_owned()));
    }
}

#[test]
fn a_process_that_dies_at_any_step_leaves_the_old_value_or_the_new() {
    for step in WRITING {
        let mut room = Room::new();
        room.store.put(&key(0), &"old".to_owned());
        room.disk.set(Some((step, Fault::Dies)));
        room.store.put(&key(0), &"new".to_owned());
        room.store.put(&key(1), &"new".to_owned());
        room.disk.set(None);
        room.reopen();
        let (done, left) = match step {
            Step::SyncFolder => (true, 0),
            Step::Folder | Step::Create => (false, 0),
            _ => (false, 2),
        };
        assert_eq!(room.store.get(&key(0)), Some(if done { "new" } else { "old" }.to_owned()), "{step:?}");
        assert_eq!(room.store.get(&key(1)), done.then(|| "new".to_owned()), "{step:?}");
        assert_eq!(room.temporaries(), left, "{step:?}");

        // What is left goes when it is old, and not before: its writer might be alive.
        prune(room.dir.path(), &Limits::default()).unwrap();
        assert_eq!(room.temporaries(), left, "{step:?}");
        let hour_ago = std::time::SystemTime::now() - Duration::from_mins(61);
        for number in 0..2 {
            let Ok(files) = fs::read_dir(entry::folder(room.dir.path(), &key(number))) else { continue };
            for file in files {
                Local.mark_used(&file.unwrap().path(), hour_ago).unwrap();
            }
        }
        let pruned = prune(room.dir.path(), &Limits::default()).unwrap();
        assert_eq!((pruned.abandoned.files, pruned.removed.files), (left, 0), "{step:?}");
        assert_eq!(room.temporaries(), 0, "{step:?}");
        assert_eq!(room.store.get(&key(0)), Some(if done { "new" } else { "old" }.to_owned()), "{step:?}");
    }
}

#[test]
fn a_mark_that_cannot_be_made_costs_nothing() {
    let room = Room::new();
    room.store.put(&key(0), &1_u8);
    Local.mark_used(&room.path(&key(0)), std::time::SystemTime::UNIX_EPOCH).unwrap();
    room.disk.set(Some((Step::Mark, Fault::Fails(30))));
    assert_eq!(room.store.get(&key(0)), Some(1_u8));
    assert_eq!(room.store.warnings(), none());
}

#[test]
fn without_locks_it_goes_on_with_a_warning() {
    let room = Room::new();
    room.disk.set(Some((Step::Lock, Fault::Fails(37))));
    for number in 0..20 {
        room.store.put(&key(number), &number);
        room.store.update(&key(number), |current: Option<u64>| current.map(|value| value + 1));
        assert_eq!(room.store.get(&key(number)), Some(number + 1));
    }
    let warnings = room.store.warnings();
    assert!(matches!(&warnings[..], [one] if one.contains("cannot lock")), "{warnings:?}");
}

#[test]
fn a_lock_that_is_never_released_is_not_waited_for_for_ever() {
    let room = Room::new();
    room.store.put(&key(0), &1_u8);
    let file = entry::folder(room.dir.path(), &key(0)).join(entry::LOCK);
    let held = Local.lock(&file, Duration::ZERO).unwrap();
    let start = std::time::Instant::now();
    room.store.put(&key(0), &2_u8);
    let waited = start.elapsed();
    assert!(waited >= Duration::from_millis(200), "{waited:?}");
    assert_eq!(room.store.get(&key(0)), Some(2_u8));
    assert_eq!(room.store.warnings().len(), 1, "{:?}", room.store.warnings());
    drop(held);
    room.store.put(&key(0), &3_u8);
    assert_eq!(room.store.get(&key(0)), Some(3_u8));
}

#[test]
fn a_folder_that_cannot_be_made_gives_a_store_that_keeps_nothing() {
    let room = tempfile::tempdir().unwrap();
    let file = room.path().join("file");
    fs::write(&file, "not a folder").unwrap();
    let shaky = Shaky::default();
    shaky.set(Some((Step::Folder, Fault::Fails(30))));
    let under_a_file = Store::open(&file.join("cache"), Options::default());
    let on_a_file = Store::open(&file, Options::default());
    for store in [under_a_file, on_a_file, open(&room.path().join("cache"), &shaky)] {
        for number in 0..10 {
            store.put(&key(number), &number);
            store.update(&key(number), |_: Option<u64>| Some(number));
            assert_eq!(store.get::<u64>(&key(number)), None);
        }
        let warnings = store.warnings();
        assert!(matches!(&warnings[..], [one] if one.contains("cannot be used")), "{warnings:?}");
    }
    assert_eq!(fs::read_to_string(&file).unwrap(), "not a folder");
}

#[test]
fn a_folder_of_entries_that_is_a_file_is_a_miss_with_warnings() {
    let room = Room::new();
    let folder = entry::folder(room.dir.path(), &key(0));
    fs::write(&folder, "in the way").unwrap();
    assert_eq!(room.store.get::<u64>(&key(0)), None);
    room.store.put(&key(0), &1_u64);
    assert_eq!(room.store.get::<u64>(&key(0)), None);
    assert_eq!(room.store.warnings().len(), 2, "{:?}", room.store.warnings());
    assert_eq!(fs::read_to_string(&folder).unwrap(), "in the way");
}

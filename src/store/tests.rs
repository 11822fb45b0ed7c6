//! The store against a disk on which any step can fail.

mod damage;
mod faults;

use std::{
    collections::BTreeMap,
    fs::{self, File},
    io,
    path::{Path, PathBuf},
    sync::{Arc, Mutex},
    time::{Duration, SystemTime},
};

use proptest::prelude::*;
use serde::{Deserialize, Serialize};
use tempfile::{NamedTempFile, TempDir};

use super::{
    Key, Limits, Options, Store,
    disk::{Disk, Found, Local, Lock},
    entry, prune,
};

/// A step of reading or writing an entry.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    Folder,
    Read,
    Create,
    Write,
    Sync,
    Rename,
    SyncFolder,
    Mark,
    Lock,
}

/// What a step does in place of its work.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Fault {
    /// It fails with this system error and does nothing.
    Fails(i32),
    /// It writes half of the bytes, then fails.
    Short(i32),
    /// It writes half of the bytes and says that all is well.
    Lies,
    /// The process dies: a temporary file stays behind.
    Dies,
}

/// The local disk without its syncs (they are slow), and with faults.
#[derive(Clone, Default)]
struct Shaky {
    faults: Arc<Mutex<Vec<(Step, Fault)>>>,
}

impl Shaky {
    fn set(&self, faults: impl IntoIterator<Item = (Step, Fault)>) {
        *self.faults.lock().unwrap() = faults.into_iter().collect();
    }

    fn now(&self, step: Step) -> Option<Fault> {
        self.faults.lock().unwrap().iter().find(|(at, _)| *at == step).map(|(_, fault)| *fault)
    }

    /// Fails where the step has no bytes of its own.
    fn pass(&self, step: Step) -> io::Result<()> {
        match self.now(step) {
            Some(Fault::Fails(code) | Fault::Short(code)) => Err(io::Error::from_raw_os_error(code)),
            Some(Fault::Dies) => Err(io::Error::other("killed")),
            Some(Fault::Lies) | None => Ok(()),
        }
    }
}

impl Disk for Shaky {
    fn make_folder(&self, folder: &Path) -> io::Result<()> {
        self.pass(Step::Folder)?;
        fs::create_dir_all(folder)
    }

    fn read(&self, file: &Path, most: u64) -> io::Result<Found> {
        self.pass(Step::Read)?;
        Local.read(file, most)
    }

    fn create(&self, folder: &Path) -> io::Result<NamedTempFile> {
        self.pass(Step::Create)?;
        let mut file = Local.create(folder)?;
        if self.faults.lock().unwrap().iter().any(|(_, fault)| *fault == Fault::Dies) {
            file.disable_cleanup(true);
        }
        Ok(file)
    }

    fn write(&self, file: &mut File, bytes: &[u8]) -> io::Result<()> {
        match self.now(Step::Write) {
            Some(Fault::Fails(_)) => self.pass(Step::Write),
            Some(fault) => {
                Local.write(file, &bytes[..bytes.len() / 2])?;
                if fault == Fault::Lies { Ok(()) } else { self.pass(Step::Write) }
            }
            None => Local.write(file, bytes),
        }
    }

    fn sync(&self, _: &File) -> io::Result<()> {
        self.pass(Step::Sync)
    }

    fn rename(&self, from: NamedTempFile, to: &Path) -> io::Result<()> {
        self.pass(Step::Rename)?;
        Local.rename(from, to)
    }

    fn sync_folder(&self, _: &Path) -> io::Result<()> {
        self.pass(Step::SyncFolder)
    }

    fn mark_used(&self, file: &Path, at: SystemTime) -> io::Result<()> {
        self.pass(Step::Mark)?;
        Local.mark_used(file, at)
    }

    fn lock(&self, file: &Path, patience: Duration) -> io::Result<Lock> {
        self.pass(Step::Lock)?;
        Local.lock(file, patience)
    }
}

/// A store in a folder of its own, on a disk that can be made to fail.
struct Room {
    store: Store,
    disk: Shaky,
    dir: TempDir,
}

impl Room {
    fn new() -> Self {
        // In memory where there is such a folder: the thousands of files need no medium.
        let dir = tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap();
        let disk = Shaky::default();
        Self { store: open(dir.path(), &disk), disk, dir }
    }

    /// The store as the next process finds it.
    fn reopen(&mut self) {
        self.store = open(self.dir.path(), &self.disk);
    }

    fn path(&self, key: &Key) -> PathBuf {
        entry::path(self.dir.path(), key)
    }

    /// The names of temporary files in all folders.
    fn temporaries(&self) -> usize {
        let folders = fs::read_dir(self.dir.path()).unwrap().map(|folder| folder.unwrap().path());
        let files = folders.flat_map(|folder| fs::read_dir(folder).unwrap()).map(|file| file.unwrap().file_name());
        files.filter(|name| name.to_str().unwrap().starts_with(entry::TEMPORARY)).count()
    }
}

fn open(dir: &Path, disk: &Shaky) -> Store {
    Store::on(Box::new(disk.clone()), dir, Options { patience: Duration::from_millis(200), ..Options::default() })
}

fn none() -> Vec<String> {
    Vec::new()
}

#[test]
fn what_was_put_is_got_bit_for_bit() {
    let room = tempfile::tempdir().unwrap();
    let store = Store::open(&room.path().join("made/on/the/way"), Options::default());
    let key = Key::new("test").number(1);
    let value = vec![0.0_f64, -0.0, f64::MIN_POSITIVE, f64::INFINITY, f64::from_bits(0x7ff8_dead_beef_0001)];
    assert!(store.get::<Vec<f64>>(&key).is_none());
    store.put(&key, &value);
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(store.get::<Vec<f64>>(&key).map(|got| bits(&got)), Some(bits(&value)));
    store.put(&key, &vec![1.0_f64]);
    assert_eq!(store.get::<Vec<f64>>(&key), Some(vec![1.0]));
    assert!(store.get::<Vec<f64>>(&Key::new("test").number(2)).is_none());
    assert_eq!(store.warnings(), none());
}

#[test]
fn update_sees_the_current_value_and_may_leave_it() {
    let room = Room::new();
    let key = Key::new("test");
    for i in 0..5_u32 {
        room.store.update(&key, |current: Option<Vec<u32>>| {
            assert_eq!(current.is_none(), i == 0);
            let mut list = current.unwrap_or_default();
            list.push(i);
            Some(list)
        });
    }
    room.store.update(&key, |current: Option<Vec<u32>>| {
        assert_eq!(current, Some(vec![0, 1, 2, 3, 4]));
        None
    });
    assert_eq!(room.store.get(&key), Some(vec![0_u32, 1, 2, 3, 4]));
    assert_eq!(room.store.warnings(), none());
}

#[test]
fn a_value_over_the_limit_is_not_kept_and_not_read() {
    let dir = tempfile::tempdir().unwrap();
    let small = Store::open(dir.path(), Options { max_entry_bytes: 100, ..Options::default() });
    let large = Store::open(dir.path(), Options::default());
    let (key, other) = (Key::new("test"), Key::new("test").number(1));
    // Eight bytes of length precede the list's own.
    for (bytes, kept) in [(92, true), (93, false)] {
        let value = vec![7_u8; bytes];
        small.put(&key, &value);
        small.put(&key, &value);
        assert_eq!(small.get(&key) == Some(value.clone()), kept);
        assert_eq!(small.warnings().len(), usize::from(!kept), "{:?}", small.warnings());
        large.put(&other, &value);
        assert_eq!(large.get(&other), Some(value.clone()));
        assert_eq!(small.get(&other) == Some(value), kept);
    }
}

#[test]
fn a_value_without_an_encoding_costs_a_warning() {
    struct Refuses;
    impl Serialize for Refuses {
        fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
            Err(serde::ser::Error::custom("no such thing"))
        }
    }
    let room = Room::new();
    room.store.put(&Key::new("odd"), &Refuses);
    let warnings = room.store.warnings();
    assert!(matches!(&warnings[..], [one] if one.contains("odd") && one.contains("no such thing")), "{warnings:?}");
}

#[test]
fn a_folder_that_vanishes_is_made_again() {
    let room = Room::new();
    let key = Key::new("test");
    room.store.put(&key, &1_u8);
    fs::remove_dir_all(room.dir.path()).unwrap();
    assert_eq!(room.store.get::<u8>(&key), None);
    room.store.put(&key, &2_u8);
    assert_eq!(room.store.get(&key), Some(2_u8));
    assert_eq!(room.store.warnings(), none());
}

#[test]
fn reading_marks_an_entry_as_used_once_an_hour() {
    let room = Room::new();
    let key = Key::new("test");
    room.store.put(&key, &1_u8);
    let modified = || fs::metadata(room.path(&key)).unwrap().modified().unwrap();
    let now = SystemTime::now();
    for (age, marked) in [(30, false), (90, true), (60 * 24 * 400, true)] {
        let then = now - Duration::from_mins(age);
        Local.mark_used(&room.path(&key), then).unwrap();
        assert_eq!(room.store.get(&key), Some(1_u8));
        assert_eq!(modified() > then + Duration::from_secs(1), marked, "{age} minutes");
    }
    // What cannot be read is not used.
    let then = now - Duration::from_hours(5);
    Local.mark_used(&room.path(&key), then).unwrap();
    assert_eq!(room.store.get::<String>(&key), None);
    assert!(modified() < then + Duration::from_secs(1));
}

/// A payload with every shape that serde has.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Odd {
    numbers: Vec<f64>,
    small: (u8, i16, u32, i64, u128),
    text: String,
    maybe: Option<Box<Odd>>,
    map: BTreeMap<String, Vec<Sort>>,
    pair: [char; 2],
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
enum Sort {
    Unit,
    One(bool),
    Two(f32, ()),
    Named { a: u64 },
}

fn odd() -> impl Strategy<Value = Odd> {
    let sort = prop_oneof![
        Just(Sort::Unit),
        any::<bool>().prop_map(Sort::One),
        any::<f32>().prop_map(|x| Sort::Two(x, ())),
        any::<u64>().prop_map(|a| Sort::Named { a }),
    ];
    let map = proptest::collection::btree_map(any::<String>(), proptest::collection::vec(sort, 0..4), 0..4);
    let numbers = proptest::collection::vec(any::<f64>(), 0..50);
    let leaf = (numbers, any::<(u8, i16, u32, i64, u128)>(), any::<String>(), map, any::<[char; 2]>())
        .prop_map(|(numbers, small, text, map, pair)| Odd { numbers, small, text, maybe: None, map, pair });
    leaf.prop_recursive(3, 8, 1, |inner| {
        (inner.clone(), inner).prop_map(|(inner, outer)| Odd { maybe: Some(Box::new(inner)), ..outer })
    })
}

/// One step of a script that two processes run on one folder.
#[derive(Debug, Clone)]
enum Move {
    Put(u64, Vec<u32>),
    Push(u64, u32),
    Get(u64),
    Flip(u64, usize, u8),
    Cut(u64, usize),
    Copy(u64, u64),
    Prune(u64),
    Reopen,
}

fn a_move() -> impl Strategy<Value = Move> {
    let key = || 0_u64..4;
    prop_oneof![
        3 => (key(), proptest::collection::vec(any::<u32>(), 0..9)).prop_map(|(key, value)| Move::Put(key, value)),
        4 => (key(), any::<u32>()).prop_map(|(key, value)| Move::Push(key, value)),
        4 => key().prop_map(Move::Get),
        1 => (key(), any::<usize>(), 1_u8..).prop_map(|(key, at, mask)| Move::Flip(key, at, mask)),
        1 => (key(), any::<usize>()).prop_map(|(key, at)| Move::Cut(key, at)),
        1 => (key(), key()).prop_map(|(from, to)| Move::Copy(from, to)),
        1 => (0_u64..800).prop_map(Move::Prune),
        1 => Just(Move::Reopen),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 256, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_value_comes_back(value in odd()) {
        let room = Room::new();
        let key = Key::new("odd");
        room.store.put(&key, &value);
        prop_assert_eq!(room.store.get::<Odd>(&key), Some(value));
        prop_assert_eq!(room.store.warnings(), none());
    }

    /// The store beside a map in memory: equal, or a miss where the disk was tampered with or pruned.
    #[test]
    fn any_script_of_use_and_misuse_gives_the_last_value_or_a_miss(
        script in proptest::collection::vec((any::<bool>(), a_move()), 1..60),
    ) {
        let mut room = Room::new();
        let mut other = open(room.dir.path(), &room.disk);
        let mut model = BTreeMap::<u64, Vec<u32>>::new();
        let key = |number| Key::new("script").number(number);
        for (first, step) in script {
            let store = if first { &room.store } else { &other };
            match step {
                Move::Put(at, value) => {
                    store.put(&key(at), &value);
                    model.insert(at, value);
                }
                Move::Push(at, value) => {
                    let expected = model.entry(at).or_default();
                    store.update(&key(at), |current: Option<Vec<u32>>| {
                        assert_eq!(current.clone().unwrap_or_default(), *expected);
                        expected.push(value);
                        Some(expected.clone())
                    });
                }
                Move::Get(at) => prop_assert_eq!(store.get::<Vec<u32>>(&key(at)), model.get(&at).cloned()),
                Move::Flip(at, byte, mask) => if model.remove(&at).is_some() {
                    let path = room.path(&key(at));
                    let mut bytes = fs::read(&path).unwrap();
                    let byte = byte % bytes.len();
                    bytes[byte] ^= mask;
                    fs::write(&path, bytes).unwrap();
                    prop_assert_eq!(store.get::<Vec<u32>>(&key(at)), None);
                    fs::remove_file(&path).unwrap();
                }
                Move::Cut(at, length) => if model.remove(&at).is_some() {
                    let path = room.path(&key(at));
                    let bytes = fs::read(&path).unwrap();
                    fs::write(&path, &bytes[..length % bytes.len()]).unwrap();
                }
                Move::Copy(from, to) => if from != to && model.contains_key(&from) && model.remove(&to).is_some() {
                    fs::copy(room.path(&key(from)), room.path(&key(to))).unwrap();
                }
                Move::Prune(bytes) => {
                    prune(room.dir.path(), &Limits { max_bytes: Some(bytes), older_than: None }).unwrap();
                    model.retain(|at, _| room.path(&key(*at)).exists());
                }
                Move::Reopen => {
                    room.reopen();
                    other = open(room.dir.path(), &room.disk);
                }
            }
        }
        for at in 0..4 {
            prop_assert_eq!(other.get::<Vec<u32>>(&key(at)), model.get(&at).cloned());
        }
    }
}

//! Several processes on one store, and processes killed in the middle of writing.
//!
//! The other processes are this test program itself, started with `--ignored --exact child` and a task in its
//! environment.

#![allow(clippy::unwrap_used, clippy::expect_used)] // Helpers of tests are tests.

use std::{
    collections::BTreeSet,
    env, fs,
    io::{BufRead, BufReader, Write},
    path::Path,
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use eigenselect::store::{Key, Limits, Options, Repair, Store, prune, verify};
use serde::{Deserialize, Serialize};

const TASK: &str = "EIGENSELECT_TEST_STORE_TASK";

/// A value that tells if it is wrong: the numbers follow from the first.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Run {
    seed: u64,
    numbers: Vec<u64>,
}

impl Run {
    fn new(seed: u64, length: usize) -> Self {
        let next = |x: &u64| Some(x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407));
        Self { seed, numbers: std::iter::successors(Some(seed), next).take(length).collect() }
    }

    fn assert_right(&self) {
        assert_eq!(*self, Self::new(self.seed, self.numbers.len()), "a wrong value came out of the store");
    }
}

fn spawn(task: &str, dir: &Path, number: u64, count: u64) -> Child {
    Command::new(env::current_exe().unwrap())
        .args(["child", "--exact", "--ignored", "--nocapture", "--test-threads=1"])
        .env(TASK, format!("{task} {number} {count} {}", dir.display()))
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap()
}

/// Not a test: what the other processes do.
#[test]
#[ignore = "run by the other tests as a process of its own"]
fn child() {
    let Ok(task) = env::var(TASK) else { return };
    let mut words = task.splitn(4, ' ');
    let mut word = || words.next().unwrap();
    let (what, number, count) = (word(), word().parse().unwrap(), word().parse().unwrap());
    let store = Store::open(Path::new(word()), Options::default());
    match what {
        "extend" => extend(&store, number, count),
        "hammer" => hammer(&store, number, count),
        "write" => write(&store, number, count),
        _ => panic!("unknown task {what}"),
    }
    assert_eq!(store.warnings(), Vec::<String>::new());
}

/// Adds `count` members of its own to three shared sets.
fn extend(store: &Store, number: u64, count: u64) {
    for i in 0..count {
        store.update(&Key::new("set").number(i % 3), |current: Option<BTreeSet<(u64, u64)>>| {
            let mut set = current.unwrap_or_default();
            set.insert((number, i));
            Some(set)
        });
    }
}

/// Puts and gets the same eight entries as everybody else.
fn hammer(store: &Store, number: u64, count: u64) {
    for i in 0..count {
        let key = Key::new("run").number((number + i) % 8);
        store.put(&key, &Run::new(number * count + i, (i * 37 % 900) as usize));
        for other in 0..8 {
            if let Some(run) = store.get::<Run>(&Key::new("run").number(other)) {
                run.assert_right();
            }
        }
    }
}

/// Writes entries of its own and extends a list, telling of each when it is complete, until it is killed.
fn write(store: &Store, number: u64, count: u64) {
    let mut out = std::io::stdout();
    for i in number.. {
        store.put(&Key::new("run").number(i), &Run::new(i, (i * 131 % 4000) as usize));
        writeln!(out, "done {i}").unwrap();
        store.update(&Key::new("list").number(i % count), |current: Option<Vec<u64>>| {
            let mut list = current.unwrap_or_default();
            list.push(i);
            Some(list)
        });
        writeln!(out, "listed {i}").unwrap();
    }
}

#[test]
fn processes_that_extend_the_same_entries_lose_nothing() {
    let room = tempfile::tempdir().unwrap();
    let (processes, count) = (4, 60);
    let children: Vec<_> = (0..processes).map(|number| spawn("extend", room.path(), number, count)).collect();
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
    let store = Store::open(room.path(), Options::default());
    for set in 0..3 {
        let found = store.get::<BTreeSet<(u64, u64)>>(&Key::new("set").number(set)).unwrap();
        let all = (0..processes).flat_map(|p| (0..count).filter(|i| i % 3 == set).map(move |i| (p, i)));
        assert_eq!(found, all.collect(), "set {set}");
    }
}

#[test]
fn threads_with_stores_of_their_own_lose_nothing() {
    let room = tempfile::tempdir().unwrap();
    let dir = room.path();
    thread::scope(|scope| {
        for number in 0..8 {
            scope.spawn(move || extend(&Store::open(dir, Options::default()), number, 15));
        }
        // One store shared by many threads, beside.
        let shared = Store::open(room.path(), Options::default());
        for number in 8..12 {
            let shared = shared.clone();
            scope.spawn(move || extend(&shared, number, 15));
        }
    });
    let store = Store::open(room.path(), Options::default());
    let sets = (0..3).map(|set| store.get::<BTreeSet<(u64, u64)>>(&Key::new("set").number(set)).unwrap().len());
    assert_eq!(sets.collect::<Vec<_>>(), [60, 60, 60]);
}

#[test]
fn processes_that_replace_the_same_entries_read_whole_values() {
    let room = tempfile::tempdir().unwrap();
    let mut children: Vec<_> = (0..4).map(|number| spawn("hammer", room.path(), number, 60)).collect();
    // Somebody cleans up and checks all the while.
    while children.iter_mut().any(|child| child.try_wait().unwrap().is_none()) {
        let verified = verify(room.path(), Repair::Remove).unwrap();
        assert_eq!((verified.damaged, verified.problems), (vec![], vec![]));
        let pruned = prune(room.path(), &Limits { max_bytes: Some(9000), older_than: None }).unwrap();
        assert_eq!(pruned.problems, Vec::<String>::new());
        thread::sleep(Duration::from_millis(5));
    }
    for child in children {
        let output = child.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}

#[test]
fn a_process_killed_while_writing_loses_no_completed_entry() {
    let room = tempfile::tempdir().unwrap();
    let (lists, mut first, mut done, mut listed) = (5_u64, 0, BTreeSet::new(), BTreeSet::new());
    let mut state = 0x9e37_79b9_7f4a_7c15_u64;
    for _ in 0..50 {
        let mut child = spawn("write", room.path(), first, lists);
        // The moment falls among the writes however slow the disk is: some lines, then a part of the time of one line.
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap);
        let started = lines.find(|line| line.contains("done ")).expect("nothing was written");
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let start = Instant::now();
        let seen: Vec<_> = lines.by_ref().take(1 + (state % 5) as usize).collect();
        thread::sleep(start.elapsed().mul_f64((state >> 32) as f64 / f64::from(u32::MAX)) / seen.len() as u32);
        // SIGKILL on Unix.
        child.kill().unwrap();
        child.wait().unwrap();
        for line in [started].into_iter().chain(seen).chain(lines) {
            // The harness's own words may stand before the first line; the last line may be cut.
            if let Some((_, number)) = line.rsplit_once("done ") {
                done.insert(number.parse::<u64>().unwrap());
            } else if let Some((_, number)) = line.rsplit_once("listed ") {
                listed.insert(number.parse::<u64>().unwrap());
            }
        }
        let last = *done.last().expect("no entry was written before the kill");

        let store = Store::open(room.path(), Options::default());
        for number in 0..last + 3 {
            let run = store.get::<Run>(&Key::new("run").number(number));
            assert!(run.is_some() || !done.contains(&number), "entry {number} was lost");
            if let Some(run) = run {
                assert_eq!(run, Run::new(number, (number * 131 % 4000) as usize));
            }
        }
        let mut found = BTreeSet::new();
        for list in 0..lists {
            found.extend(store.get::<Vec<u64>>(&Key::new("list").number(list)).unwrap_or_default());
        }
        assert!(found.is_superset(&listed), "lost: {:?}", listed.difference(&found).collect::<Vec<_>>());
        assert!(found.iter().all(|number| *number <= last + 1), "{found:?}");
        let verified = verify(room.path(), Repair::Report).unwrap();
        assert_eq!((verified.damaged, store.warnings()), (vec![], vec![]));
        first = last + 2;
    }
}

/// The kernel itself refuses the bytes, in the middle of a write.
#[cfg(target_os = "linux")]
#[test]
fn a_write_cut_short_by_the_system_costs_a_warning() {
    let room = tempfile::tempdir().unwrap();
    // Files may have 4 blocks of at most 1024 bytes; without the signal, the write that passes them fails.
    let script = r#"trap "" XFSZ; ulimit -f 4; exec "$@""#;
    let output = Command::new("bash")
        .args(["-c", script, "bash"])
        .arg(env::current_exe().unwrap())
        .args(["child", "--exact", "--ignored", "--nocapture", "--test-threads=1"])
        .env(TASK, format!("hammer 0 30 {}", room.path().display()))
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    // The child panics for it expects no warnings, and shows the one it has.
    assert!(!output.status.success());
    assert!(text.matches("cannot write").count() == 1 && text.contains("not kept"), "{text}");
    assert!(!text.contains("a wrong value"), "{text}");
    let verified = verify(room.path(), Repair::Report).unwrap();
    assert_eq!(verified.damaged, vec![]);
    assert!(verified.right.files > 0 && verified.right.bytes <= 8 * 4096);
    let left = fs::read_dir(room.path()).unwrap().flat_map(|folder| fs::read_dir(folder.unwrap().path()).unwrap());
    let left = left.filter(|file| file.as_ref().unwrap().file_name().to_str().unwrap().starts_with(".tmp")).count();
    assert_eq!(left, 0);
}

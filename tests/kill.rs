//! `tui report` killed at random moments of a cold run: the next run finishes, solves nothing again that was solved,
//! and shows the figures of an undisturbed run, byte for byte.
//!
//! `EIGENSELECT_KILLS` sets the number of moments.

#![allow(clippy::unwrap_used, clippy::expect_used)] // Helpers of tests are tests.

use std::{
    env,
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
    thread,
    time::{Duration, Instant},
};

use eigenselect::store::{Repair, Tally, stats, verify};
use serde_json::Value;
use tempfile::TempDir;

/// Chance without a seed from outside, so that a failure comes again.
struct Dice(u64);

impl Dice {
    fn roll(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// In [0, 1).
    fn share(&mut self) -> f64 {
        (self.roll() >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A data set and what an undisturbed run says of it.
struct Bench {
    room: TempDir,
    /// How long a model takes, about.
    pace: Duration,
    models: usize,
}

/// One report.
struct Outcome {
    /// All but what may differ from run to run.
    figures: Value,
    computed: usize,
    from_disk: usize,
    warnings: Value,
}

impl Bench {
    fn new() -> Self {
        let room = tempfile::tempdir().unwrap();
        let options = ["--classes", "vase,fish,gear", "--models", "4", "--vertices", "400"];
        let made = tui(room.path()).args(["synth", "data"]).args(options).output().unwrap();
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        Self { room, pace: Duration::ZERO, models: 12 }
    }

    fn cache(&self, name: &str) -> PathBuf {
        self.room.path().join(name)
    }

    fn command(&self, cache: &str, kmax: usize) -> Command {
        let mut command = tui(self.room.path());
        command.args(["report", "data", "--format", "json", "--spectra", "--cache", cache]);
        command.arg("--set").arg(format!("kmax={kmax}"));
        command
    }

    fn report(&self, cache: &str, kmax: usize) -> Outcome {
        let output = self.command(cache, kmax).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let mut figures: Value = serde_json::from_slice(&output.stdout).unwrap();
        let run = figures.as_object_mut().unwrap().remove("run").unwrap();
        let number = |name: &str| run["spectra"][name].as_u64().unwrap() as usize;
        let (computed, from_disk) = (number("computed"), number("disk"));
        Outcome { figures, computed, from_disk, warnings: run["warnings"].clone() }
    }

    /// How many spectra are in the store.
    fn kept(&self, cache: &str) -> usize {
        // Absent before the first run has made it.
        let Ok(stats) = stats(&self.cache(cache)) else { return 0 };
        stats.kinds.iter().find(|kind| kind.kind == "spectrum").map_or(0, |kind| kind.tally.files)
    }

    /// Starts a run and kills it at a random moment: some while after a random number of further spectra were kept.
    fn kill_a_run(&self, cache: &str, kmax: usize, dice: &mut Dice) {
        let before = self.kept(cache);
        let target = before + dice.roll() as usize % (self.models - before).max(1);
        let mut child = self.command(cache, kmax).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        while self.kept(cache) < target && !ended(&mut child) {
            thread::sleep(Duration::from_micros(200));
        }
        thread::sleep(self.pace.mul_f64(2.0 * dice.share()));
        // SIGKILL on Unix.
        child.kill().unwrap();
        child.wait().unwrap();
        let verified = verify(&self.cache(cache), Repair::Report);
        assert!(
            verified.is_ok_and(|verified| verified.damaged.is_empty() && verified.problems.is_empty()) || before == 0
        );
    }
}

fn tui(home: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tui"));
    command.current_dir(home).env("HOME", home).stdin(Stdio::null());
    command
}

fn ended(child: &mut Child) -> bool {
    child.try_wait().unwrap().is_some()
}

fn assert_same(outcome: &Outcome, expected: &Value, what: &str) {
    // Not `assert_eq`, which would print both reports.
    assert!(outcome.figures == *expected, "{what}: other figures than those of an undisturbed run");
    assert_eq!(outcome.warnings, Value::Array(vec![]), "{what}");
}

#[test]
fn a_run_killed_at_any_moment_costs_only_what_was_unfinished() {
    let moments = env::var("EIGENSELECT_KILLS").map_or(50, |text| text.parse().expect("a number of moments"));
    let mut bench = Bench::new();
    let start = Instant::now();
    let undisturbed = bench.report("undisturbed", 100);
    bench.pace = start.elapsed() / bench.models as u32;
    assert_eq!((undisturbed.computed, undisturbed.from_disk), (bench.models, 0));
    assert_same(&undisturbed, &undisturbed.figures, "undisturbed");

    let mut dice = Dice(0x2545_f491_4f6c_dd1d);
    let mut partly = 0;
    for moment in 0..moments {
        let cache = format!("cache-{moment}");
        // Some runs are killed again while they go on where the last one was killed.
        for _ in 0..=dice.roll() % 2 {
            bench.kill_a_run(&cache, 100, &mut dice);
        }
        let kept = bench.kept(&cache);
        partly += usize::from(0 < kept && kept < bench.models);
        let next = bench.report(&cache, 100);
        assert_same(&next, &undisturbed.figures, &format!("moment {moment}"));
        assert_eq!((next.from_disk, next.computed), (kept, bench.models - kept), "moment {moment}");
        let verified = verify(&bench.cache(&cache), Repair::Report).unwrap();
        assert_eq!(verified.damaged, vec![], "moment {moment}");
    }
    assert!(5 * partly >= moments, "only {partly} of {moments} moments were in the middle of a run");
    println!("{partly} of {moments} moments left some spectra and not all");
}

#[test]
fn a_run_killed_while_it_extends_spectra_loses_none_of_their_beginnings() {
    let moments = env::var("EIGENSELECT_KILLS").map_or(10, |text| text.parse().expect("a number of moments"));
    let mut bench = Bench::new();
    let start = Instant::now();
    let long = bench.report("long", 120);
    bench.pace = start.elapsed() / bench.models as u32;
    let short = bench.report("short", 30);
    let mut dice = Dice(0x9e37_79b9_7f4a_7c15);
    for moment in 0..moments {
        let (what, cache) = (format!("moment {moment}"), format!("cache-{moment}"));
        assert_same(&bench.report(&cache, 30), &short.figures, &what);
        let mut child = bench.command(&cache, 120).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
        thread::sleep(bench.pace.mul_f64(bench.models as f64 * dice.share()));
        child.kill().unwrap();
        child.wait().unwrap();
        assert_eq!(verify(&bench.cache(&cache), Repair::Report).unwrap().damaged, vec![], "{what}");
        let again = bench.report(&cache, 30);
        assert_same(&again, &short.figures, &what);
        assert_eq!((again.computed, again.from_disk), (0, bench.models), "{what}");
        assert_same(&bench.report(&cache, 120), &long.figures, &what);
        let warm = bench.report(&cache, 120);
        assert_same(&warm, &long.figures, &what);
        assert_eq!((warm.computed, warm.from_disk), (0, bench.models), "{what}");
    }
}

#[test]
fn a_killed_solve_has_left_bands_with_which_the_next_one_ends_as_if_undisturbed() {
    let room = tempfile::tempdir().unwrap();
    let made = tui(room.path())
        .args(["synth", "data", "--classes", "vase", "--models", "1", "--vertices", "6000"])
        .output()
        .unwrap();
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let command = |cache: &str, count: usize| {
        let mut command = tui(room.path());
        let count = count.to_string();
        command.args(["spectrum", "data/train/vase/vase-01.obj", "--threads", "1", "--format", "json"]);
        command.args(["--count", &count, "--cache", cache]);
        command
    };
    let begun = |cache: &str| {
        let stats = stats(&room.path().join(cache));
        // Some 50 eigenvalues with their bounds are a band: three of them at least.
        let enough = |tally: &Tally| tally.files == 1 && tally.bytes > 3 * 50 * 16;
        stats.is_ok_and(|stats| stats.kinds.iter().any(|kind| kind.kind == "begun" && enough(&kind.tally)))
    };
    let mut child = command("killed", 5000).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    while !begun("killed") && !ended(&mut child) {
        thread::sleep(Duration::from_millis(5));
    }
    assert!(!ended(&mut child), "it ended before it could be killed");
    child.kill().unwrap();
    child.wait().unwrap();

    let solve = |cache: &str, count: usize| {
        let output = command(cache, count).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let json: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["run"]["spectra"]["computed"], 1, "{cache}");
        (json["spectra"][0]["eigenvalues"].clone(), json["run"]["processes"][0].as_u64().unwrap())
    };
    let (resumed, anew) = (solve("killed", 600), solve("undisturbed", 600));
    assert_eq!(resumed.0, anew.0);
    // A band lies between two shifts, each with its process: the one where the killed run stopped is done again.
    assert!(resumed.1 + 1 < anew.1, "{} processes after the kill, {} without", resumed.1, anew.1);
    println!("{} processes after the kill, {} without", resumed.1, anew.1);
}

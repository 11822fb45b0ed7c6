//! The program as its users meet it: the real binary, its output, its exit codes.

#![allow(clippy::unwrap_used, clippy::expect_used)]

#[path = "cli/room.rs"]
mod room;

use std::{fs, process::Stdio};

use serde_json::Value;

use room::{Outcome, Room, ball, ring, spawn, tui};

/// Everything but what differs from run to run.
fn without_run(json: &str) -> &str {
    json.split_once("\n  \"run\": ").expect("the report ends in `run`").0
}

fn json(outcome: &Outcome) -> Value {
    serde_json::from_str(&outcome.out).expect("JSON")
}

#[test]
fn a_wrong_command_line_exits_with_2_and_says_what_is_wrong() {
    let room = Room::new();
    for (arguments, hint) in [
        (&["--colour"][..], "--colour"),
        (&["report"], "DATA"),
        (&["spectrum"], "MESH"),
        (&["report", "data", "--format", "xml"], "text, md, csv, json"),
        (
            &["report", "data", "--set", "kmx=3"],
            "operator, mass, boundary, triangulation, kmax, normalisation, weights, distance, search, weak, stop, k, T, cost, \
             sel, class",
        ),
        (&["data", "--set", "T"], "NAME=VALUE"),
        (&["data", "--set", "T=0"], "T takes a number from 1"),
        (&["data", "--set", "operator=fen"], "operator takes fem, cot"),
        (&["data", "--threads", "0"], "1..=1024"),
        (&["report", "data", "--spectra"], "--spectra needs --format csv or json"),
        (&["spectrum", "a.off", "--count", "0"], "a number from 1"),
        (&["spectrum", "a.off", "b.off", "--format", "ev"], "--out"),
        (&["spectrum", "a.off", "--near", "-3"], "a number from 0"),
        (&["spectrum", "a.off", "--near", "3", "--out", "a.ev"], "--near"),
        (&["cache", "prune", "--max-size", "lots"], "800M"),
        (&["cache"], "stats"),
    ] {
        let outcome = tui(&room, arguments);
        assert_eq!(outcome.code, Some(2), "{arguments:?}: {}", outcome.err);
        assert!(outcome.err.contains(hint), "{arguments:?}: {}", outcome.err);
        assert!(outcome.out.is_empty(), "{arguments:?}: {}", outcome.out);
    }
    let nothing = tui(&room, &[]);
    assert_eq!(nothing.code, Some(2));
    assert!(nothing.err.starts_with("Which Laplace-Beltrami eigenvalues"), "{}", nothing.err);
    assert!(nothing.err.contains("Usage: tui") && nothing.err.contains("Examples:"), "{}", nothing.err);
}

#[test]
fn a_recipe_of_the_screen_gives_the_same_report_bit_for_bit() {
    use eigenselect::{
        query::{Parameter, Settings},
        workbench::{Action, State, recipe, update},
    };
    let room = Room::with_study();
    let mut state = State::new("shapes", Settings { kmax: 30, ..Settings::default() });
    for (parameter, value) in
        [(Parameter::Normalisation, "area"), (Parameter::Distance, "l1"), (Parameter::Rounds, "7")]
    {
        update(&mut state, Action::Set(parameter, value.to_owned()));
    }
    fs::write(room.path("mine.toml"), recipe::write(&state).unwrap()).unwrap();
    let report = ["report", "shapes", "--cache", "cache", "--format", "json"];
    let by_recipe = tui(&room, &[&report[..], &["--recipe", "mine.toml"]].concat());
    let set = ["--set", "kmax=30", "--set", "normalisation=area", "--set", "distance=l1", "--set", "T=7"];
    let by_hand = tui(&room, &[&report[..], &set].concat());
    assert_eq!((by_recipe.code, by_recipe.err.as_str()), (Some(0), ""));
    assert_eq!(without_run(&by_recipe.out), without_run(&by_hand.out));
    let further = tui(&room, &[&report[..], &["--recipe", "mine.toml", "--set", "T=8"]].concat());
    assert_ne!(without_run(&further.out), without_run(&by_hand.out), "--set goes on from the recipe");
    fs::write(room.path("bad.toml"), "version = 1\n[set]\nT = 0\n").unwrap();
    let bad = tui(&room, &["report", "shapes", "--recipe", "bad.toml"]);
    assert_eq!(bad.code, Some(1));
    assert_eq!(bad.err, "tui: bad.toml: set.T: T takes a number from 1 to 1000, not \"0\"\n");
}

#[test]
fn the_doctor_says_what_it_finds() {
    let room = Room::with_study();
    let well = tui(&room, &["doctor", "shapes", "--cache", "cache"]);
    assert_eq!(well.code, Some(0), "{}", well.out);
    assert!(well.out.contains("2 classes, D "), "{}", well.out);
    let ill = tui(&room, &["doctor", "nowhere"]);
    assert_eq!(ill.code, Some(1));
    assert!(ill.out.lines().any(|line| line.starts_with("BAD  data") && line.contains("nowhere")), "{}", ill.out);
}

#[test]
fn a_configuration_is_read_and_its_errors_name_the_line() {
    let room = Room::with_study();
    let file = room.home().join("config/eigenselect/config.toml");
    fs::create_dir_all(file.parent().unwrap()).unwrap();
    fs::write(&file, "threads = 1\n[set]\nkmax = 7\n[cache]\ndir = \"kept\"\nlimit = \"1M\"\n").unwrap();
    let well = tui(&room, &["doctor", "shapes"]);
    let line = |word: &str| well.out.lines().find(|line| line.contains(word)).unwrap_or_default().to_owned();
    assert!(line("config ").ends_with("config.toml: kmax=7"), "{}", well.out);
    assert!(line("threads").contains("1 model is solved") && line("cache").contains("kept"), "{}", well.out);
    // A report gives everybody the same figures: of the configuration it takes the place of the cache.
    let report = tui(&room, &["report", "shapes", "--set", "kmax=20", "--format", "json"]);
    assert_eq!(report.code, Some(0), "{}", report.err);
    assert!(room.path("kept").is_dir() && report.out.contains("\"kmax\": 20"));
    fs::write(&file, "threads = 1\n[set]\nkmax = 0\n").unwrap();
    let wrong = tui(&room, &["report", "shapes"]);
    assert_eq!(wrong.code, Some(1));
    assert!(wrong.err.contains("config.toml:3: kmax takes"), "{}", wrong.err);
    let ill = tui(&room, &["doctor", "shapes"]);
    assert!(ill.out.lines().any(|line| line.starts_with("BAD  config") && line.contains(":3:")), "{}", ill.out);
}

#[test]
fn completions_and_manual_are_made_from_the_arguments() {
    let room = Room::new();
    for shell in ["bash", "zsh", "fish"] {
        let made = tui(&room, &["completions", shell]);
        assert!(made.code == Some(0) && made.out.contains("report"), "{shell}: {}", made.err);
    }
    let manual = tui(&room, &["man"]);
    assert!(manual.code == Some(0) && manual.out.contains(".TH tui 1"), "{}", manual.out);
}

#[test]
fn what_is_not_there_exits_with_1_and_one_line() {
    let room = Room::new();
    fs::create_dir(room.path("void")).unwrap();
    fs::write(room.path("ball.off"), ball(6, 8, 1.0)).unwrap();
    for (arguments, line) in [
        (&["nowhere/"][..], "tui: nowhere/: no such folder\n"),
        (&["report", "nowhere"], "tui: nowhere: no such folder\n"),
        (
            &["ball.off"],
            "tui: ball.off: a file, not a folder; 'tui spectrum ball.off' computes the eigenvalues of a mesh\n",
        ),
        (&["report", "void", "--out", "no/report.json"], "tui: no: no such folder to write to\n"),
        (&["report", "void", "--out", "void", "--format", "json"], "tui: void: a folder, where a file was expected\n"),
        (&["cache", "stats", "--cache", "nowhere"], "tui: nowhere: no such folder\n"),
    ] {
        let outcome = tui(&room, arguments);
        assert_eq!((outcome.code, outcome.err.as_str()), (Some(1), line), "{arguments:?}");
        assert!(outcome.out.is_empty());
    }
    let empty = tui(&room, &["report", "void"]);
    assert_eq!(empty.code, Some(1));
    assert!(empty.err.starts_with("tui: void: no mesh"), "{}", empty.err);
    let spectrum = tui(&room, &["spectrum", "nowhere.off", "--no-cache"]);
    assert_eq!(spectrum.code, Some(1));
    assert!(spectrum.err.starts_with("tui: nowhere.off: cannot be read"), "{}", spectrum.err);
}

#[test]
fn a_study_with_one_broken_mesh_completes_and_names_it() {
    let room = Room::with_study();
    fs::write(room.path("shapes/ring/ring-7.off"), "OFF\n3 1 0\n0 0 0\n1 0 zero\n0 1 0\n3 0 1 2\n").unwrap();
    let report = tui(&room, &["report", "shapes", "--set", "kmax=16"]);
    assert_eq!(report.code, Some(0), "{}", report.err);
    assert!(report.out.contains("13: 10 train (D), 2 query (Q), 1 skipped"), "{}", report.out);
    assert!(report.out.contains("Skipped models (1)\n  ring/ring-7.off: "), "{}", report.out);
    for section in ["Parameters\n", "Table 1 ", "Table 4 ", "Curves of", "Hill climbing", "AdaBoost, ", "This run\n"] {
        assert!(report.out.contains(&format!("\n{section}")), "{section}: {}", report.out);
    }
    // The same without a command: standard output is no terminal.
    let plain = tui(&room, &["shapes", "--set", "kmax=16"]);
    assert_eq!(plain.code, Some(0), "{}", plain.err);
    let head = |text: &str| text.split("\nThis run\n").next().unwrap().to_owned();
    assert_eq!(head(&plain.out), head(&report.out));
    assert!(plain.out.contains("spectra  0 computed, 0 from memory, 12 from disk"), "{}", plain.out);
}

#[test]
fn a_kmax_beyond_every_mesh_fails_and_says_which_would_do() {
    let room = Room::with_study();
    let outcome = tui(&room, &["report", "shapes"]);
    assert_eq!(outcome.code, Some(1));
    assert!(outcome.out.contains("No tables") && outcome.out.contains("Skipped models (12)"), "{}", outcome.out);
    let line = "tui: shapes: no training model could be used; 12 of 12 models have fewer than kmax = 500 eigenvalues";
    assert!(outcome.err.starts_with(line) && outcome.err.contains("with kmax = 72 all would"), "{}", outcome.err);
    assert_eq!(outcome.err.lines().count(), 1, "{}", outcome.err);
}

#[test]
fn json_holds_everything_and_a_warm_run_gives_the_same_bytes() {
    let room = Room::with_study();
    let arguments = ["report", "shapes", "--set", "kmax=16", "--set", "k=3", "--format", "json", "--spectra"];
    let cold = tui(&room, &arguments);
    assert_eq!((cold.code, cold.err.as_str()), (Some(0), ""));
    let warm = tui(&room, &[&arguments[..], &["--threads", "1"]].concat());
    assert_eq!(without_run(&cold.out), without_run(&warm.out));

    let (cold, warm) = (json(&cold), json(&warm));
    assert_eq!(cold["run"]["spectra"]["computed"], 12);
    assert_eq!(warm["run"]["spectra"]["disk"], 12);
    assert_eq!(cold["schema"]["version"], 1);
    assert_eq!(cold["complete"], true);
    assert_eq!(cold["parameters"]["kmax"], 16);
    assert_eq!(cold["data"]["root"], "shapes");
    assert_eq!(cold["tables"].as_array().unwrap().len(), 4);
    assert_eq!(cold["curves"]["error"]["train"].as_array().unwrap().len(), 16);
    assert_eq!(cold["curves"]["adr"]["query"].as_array().unwrap().len(), 16);
    assert_eq!(cold["selections"]["adaboost"]["classes"].as_array().unwrap().len(), 2);
    for (spectrum, model) in cold["spectra"].as_array().unwrap().iter().zip(cold["models"].as_array().unwrap()) {
        assert_eq!(spectrum["name"], model["name"]);
        let values: Vec<f64> =
            spectrum["eigenvalues"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
        assert_eq!((values.len(), values[0]), (16, 0.0));
        assert!(values.is_sorted() && values[1] > 0.0, "{values:?}");
        assert!(model["measure"].as_f64().unwrap() > 0.0);
    }
}

#[test]
fn figures_follow_from_the_spectra_that_are_handed_out() {
    // First-k of the training models, evaluated here from `spectra`, with the default normalisation λ/λ_kmax.
    let room = Room::with_study();
    let report = json(&tui(&room, &["report", "shapes", "--set", "kmax=12", "--format", "json", "--spectra"]));
    let models = report["models"].as_array().unwrap();
    let train: Vec<(&str, Vec<f64>)> = models
        .iter()
        .zip(report["spectra"].as_array().unwrap())
        .filter(|(model, _)| model["role"] == "train")
        .map(|(model, spectrum)| {
            let values = spectrum["eigenvalues"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap());
            let values: Vec<f64> = values.collect();
            (model["class"].as_str().unwrap(), values.iter().map(|v| v / values[11]).collect())
        })
        .collect();
    for k in 1..=12 {
        let wrong = train.iter().enumerate().filter(|(at, (class, features))| {
            let distance =
                |other: &[f64]| -> f64 { features[..k].iter().zip(&other[..k]).map(|(a, b)| (a - b) * (a - b)).sum() };
            let others = train.iter().enumerate().filter(|(other, _)| other != at);
            let nearest = others.min_by(|a, b| distance(&a.1.1).total_cmp(&distance(&b.1.1))).unwrap();
            nearest.1.0 != *class
        });
        let error = wrong.count() as f64 / train.len() as f64;
        assert_eq!(report["curves"]["error"]["train"][k - 1].as_f64().unwrap(), error, "k = {k}");
    }
}

#[test]
fn csv_is_one_tidy_table_or_a_folder_of_tables() {
    let room = Room::with_study();
    let long = tui(&room, &["report", "shapes", "--set", "kmax=10", "--format", "csv"]);
    assert_eq!(long.code, Some(0), "{}", long.err);
    let mut reader = csv::Reader::from_reader(long.out.as_bytes());
    assert_eq!(reader.headers().unwrap(), vec!["section", "item", "index", "measure", "set", "value"]);
    let curve = reader.records().map(Result::unwrap).filter(|row| &row[0] == "curve").count();
    assert_eq!(curve, 4 * 10);

    let folder = tui(&room, &["report", "shapes", "--set", "kmax=10", "--format", "csv", "--out", "tables"]);
    assert_eq!((folder.code, folder.out.as_str()), (Some(0), ""));
    let mut names: Vec<String> = fs::read_dir(room.path("tables"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected = "adaboost_rounds adaboost_selected classes curves hill_climbing models parameters skipped table1 \
                    table2 table3 table4";
    assert_eq!(names, expected.split(' ').map(|name| format!("{name}.csv")).collect::<Vec<_>>());
    for name in names {
        let mut reader = csv::Reader::from_path(room.path("tables").join(&name)).unwrap();
        assert!(reader.records().all(|row| row.is_ok()), "{name}");
    }
}

#[test]
fn the_ending_of_out_chooses_the_format() {
    let room = Room::with_study();
    for (name, beginning) in
        [("r.json", "{\n"), ("r.md", "# Eigenselect"), ("r.csv", "section,"), ("r.txt", "Eigenselect ")]
    {
        let outcome = tui(&room, &["report", "shapes", "--set", "kmax=8", "--out", name]);
        assert_eq!((outcome.code, outcome.out.as_str(), outcome.err.as_str()), (Some(0), "", ""), "{name}");
        assert!(fs::read_to_string(room.path(name)).unwrap().starts_with(beginning), "{name}");
    }
}

#[test]
fn a_class_is_set_by_number_or_name() {
    let room = Room::with_study();
    for value in ["class=2", "class=ring"] {
        let report = tui(&room, &["report", "shapes", "--set", "kmax=8", "--set", value, "--format", "json"]);
        assert_eq!(json(&report)["parameters"]["class"], 2, "{value}: {}", report.err);
    }
    let wrong = tui(&room, &["report", "shapes", "--set", "class=cube"]);
    assert_eq!(wrong.code, Some(2));
    assert!(wrong.err.contains("from 1 to 2") && wrong.err.contains("ball, ring"), "{}", wrong.err);
}

#[test]
fn a_folder_named_like_a_command_is_opened_by_its_path() {
    let room = Room::with_study();
    fs::rename(room.path("shapes"), room.path("report")).unwrap();
    let outcome = tui(&room, &["./report", "--set", "kmax=8"]);
    assert_eq!(outcome.code, Some(0), "{}", outcome.err);
    assert!(outcome.out.contains("\nData set    ./report\n"), "{}", outcome.out);
}

#[test]
fn spectra_are_written_in_every_format() {
    let room = Room::new();
    fs::write(room.path("ball.off"), ball(10, 16, 1.0)).unwrap();
    fs::write(room.path("ring.off"), ring(14, 9, 0.4)).unwrap();
    let text = tui(&room, &["spectrum", "ball.off", "--count", "9"]);
    assert_eq!((text.code, text.err.as_str()), (Some(0), ""));
    assert!(text.out.contains("closed, genus 0") && text.out.contains("9 of 146 eigenvalues"), "{}", text.out);

    let json_out = tui(&room, &["spectrum", "ball.off", "ring.off", "--count", "9", "--format", "json"]);
    let value = json(&json_out);
    assert_eq!(value["schema"]["name"], "eigenselect-spectra");
    assert_eq!(value["spectra"][1]["genus"], 1);
    assert_eq!(value["run"]["spectra"], serde_json::json!({"computed": 1, "memory": 0, "disk": 1}));
    let values: Vec<f64> =
        value["spectra"][0]["eigenvalues"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    // A coarse unit sphere: 0, then 2 three times, then 6 five times, nearly.
    assert_eq!(values[0], 0.0);
    assert!(values[1..4].iter().all(|v| (v - 2.0).abs() < 0.25), "{values:?}");
    assert!(values[4..9].iter().all(|v| (v - 6.0).abs() < 1.2), "{values:?}");

    let csv_out = tui(&room, &["spectrum", "ball.off", "--count", "9", "--format", "csv"]);
    let mut reader = csv::Reader::from_reader(csv_out.out.as_bytes());
    let read: Vec<f64> = reader.records().map(|row| row.unwrap()[2].parse().unwrap()).collect();
    assert_eq!(read, values);

    // Of the five about 6, the middle three; `k` counts those below them.
    let target = values[6].to_string();
    let near = tui(&room, &["spectrum", "ball.off", "--near", &target, "--count", "3", "--format", "json"]);
    let near = &json(&near)["spectra"][0];
    let below = near["below"].as_u64().unwrap() as usize;
    let close = near["eigenvalues"].as_array().unwrap();
    assert!(close.len() == 3 && (4..=6).contains(&below), "{near}");
    for (value, expected) in close.iter().zip(&values[below..]) {
        assert!((value.as_f64().unwrap() / expected - 1.0).abs() < 1e-10, "{near}");
    }
    let csv_near = tui(&room, &["spectrum", "ball.off", "--near", &target, "--count", "3", "--format", "csv"]);
    assert!(csv_near.out.lines().nth(1).unwrap().starts_with(&format!("ball.off,{},", below + 1)), "{}", csv_near.out);

    let ev = tui(&room, &["spectrum", "ball.off", "--count", "9", "--out", "ball.ev"]);
    assert_eq!((ev.code, ev.out.as_str()), (Some(0), ""));
    let ev = fs::read_to_string(room.path("ball.ev")).unwrap();
    let list = ev.split_once("Eigenvalues:\n{ ").unwrap().1.trim_end().strip_suffix(" }").unwrap();
    assert_eq!(list.split(" ; ").map(|value| value.parse().unwrap()).collect::<Vec<f64>>(), values);

    let several = tui(&room, &["spectrum", "ball.off", "ring.off", "--format", "ev", "--out", "evs"]);
    assert_eq!(several.code, Some(0), "{}", several.err);
    assert!(room.path("evs/ball.ev").is_file() && room.path("evs/ring.ev").is_file());
}

#[test]
fn spectra_of_some_meshes_survive_the_failure_of_others() {
    let room = Room::new();
    fs::write(room.path("ball.off"), ball(8, 12, 1.0)).unwrap();
    fs::write(room.path("flat.off"), "OFF\n2 0 0\n0 0 0\n1 0 0\n").unwrap();
    let outcome = tui(
        &room,
        &["spectrum", "flat.off", "ball.off", "notes.txt", "--count", "500", "--no-cache", "--format", "json"],
    );
    assert_eq!(outcome.code, Some(1));
    assert!(outcome.err.contains("tui: flat.off: there are no faces"), "{}", outcome.err);
    assert!(outcome.err.contains("tui: notes.txt: the name ends in none of"), "{}", outcome.err);
    assert!(outcome.err.contains("tui: ball.off: the mesh has 86 eigenvalues, fewer than the 500"), "{}", outcome.err);
    let value = json(&outcome);
    assert_eq!(value["spectra"][0]["eigenvalues"].as_array().unwrap().len(), 86);
    assert_eq!(value["failed"].as_array().unwrap().len(), 2);
    assert!(!room.home().join("cache").exists(), "--no-cache leaves nothing behind");
}

#[cfg(unix)]
#[test]
fn names_cannot_command_the_terminal() {
    let room = Room::new();
    let name = "\u{1b}[2J\u{7}\u{202e}x.off";
    fs::write(room.path(name), "OFF\n2 0 0\n0 0 0\n1 0 0\n").unwrap();
    let outcome = tui(&room, &["spectrum", name, "--no-cache"]);
    assert_eq!(outcome.code, Some(1));
    let shown = "\u{fffd}[2J\u{fffd}\u{fffd}x.off: there are no faces";
    assert!(outcome.err.contains(shown) && !outcome.err.contains(['\u{1b}', '\u{7}', '\u{202e}']), "{:?}", outcome.err);
}

#[test]
fn the_cache_is_counted_checked_and_emptied() {
    let room = Room::with_study();
    let none = tui(&room, &["cache", "stats", "shapes"]);
    assert_eq!(none.code, Some(0));
    assert!(none.out.contains("nothing is kept yet"), "{}", none.out);

    fs::create_dir(room.path("cache")).unwrap();
    assert_eq!(tui(&room, &["report", "shapes", "--set", "kmax=8"]).code, Some(0));
    let stats = tui(&room, &["cache", "stats", "shapes"]);
    assert!(
        stats.out.lines().any(|line| line.trim_start().starts_with("spectrum") && line.contains(" 12 ")),
        "{}",
        stats.out
    );
    assert_eq!(tui(&room, &["cache", "verify", "shapes"]).code, Some(0));

    let entry = room.entries().pop().unwrap();
    let mut bytes = fs::read(&entry).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(&entry, bytes).unwrap();
    let verify = tui(&room, &["cache", "verify", "--cache", "cache"]);
    assert_eq!(verify.code, Some(1));
    assert!(verify.out.contains("1 damaged") && verify.out.contains(entry.file_name().unwrap().to_str().unwrap()));
    assert_eq!(tui(&room, &["cache", "verify", "--cache", "cache", "--remove"]).code, Some(0));

    let prune = tui(&room, &["cache", "prune", "--cache", "cache", "--max-size", "0"]);
    assert_eq!(prune.code, Some(0), "{}", prune.err);
    assert!(room.entries().is_empty());
}

#[test]
fn a_reader_that_leaves_early_is_no_failure() {
    let room = Room::with_study();
    // Longer than a pipe holds, so that writing meets the closed end for certain.
    let arguments = ["report", "shapes", "--set", "kmax=40", "--format", "csv", "--spectra"];
    let mut child = spawn(&room, &arguments, Stdio::piped());
    drop(child.stdout.take());
    let outcome = Outcome::of(child);
    assert_eq!((outcome.code, outcome.err.as_str()), (Some(0), ""));
}

#[test]
fn synth_makes_a_set_that_reports() {
    let room = Room::new();
    let arguments = ["synth", "made", "--classes", "2", "--models", "3", "--vertices", "400", "--seed", "5"];
    let made = tui(&room, &arguments);
    assert_eq!(made.code, Some(0), "{}", made.err);
    let again = tui(&room, &arguments);
    assert_eq!(again.code, Some(1));
    assert!(again.err.contains("already there"), "{}", again.err);
    let report = tui(&room, &["report", "made", "--set", "kmax=10", "--format", "json"]);
    assert_eq!(json(&report)["data"]["models"], 6, "{}", report.err);
    let wrong = tui(&room, &["synth", "made", "--classes", "unicorn"]);
    assert_eq!(wrong.code, Some(2), "{}", wrong.err);
}

#[cfg(unix)]
#[test]
fn ctrl_c_stops_soon_with_130_and_keeps_what_is_finished() {
    use std::time::{Duration, Instant};
    let room = Room::new();
    fs::create_dir(room.path("cache")).unwrap();
    for class in ["ball", "ring"] {
        fs::create_dir_all(room.path("shapes").join(class)).unwrap();
    }
    for model in 0..4 {
        let flat = 1.0 + f64::from(model) / 8.0;
        fs::write(room.path(&format!("shapes/ball/{model}.off")), ball(10, 12, flat)).unwrap();
        // Large enough to be under way for long after the small ones are done.
        fs::write(room.path(&format!("shapes/ring/{model}.off")), ring(400, 160, 0.2 * flat)).unwrap();
    }
    let child = spawn(&room, &["report", "shapes", "--set", "kmax=100", "--threads", "2"], Stdio::piped());
    let start = Instant::now();
    while room.entries().len() < 3 && start.elapsed() < Duration::from_mins(1) {
        std::thread::sleep(Duration::from_millis(5));
    }
    std::thread::sleep(Duration::from_millis(100));
    let spent = room::spent(&child);
    room::interrupt(&child);
    let asked = Instant::now();
    let after = room::spent_until_its_end(&child);
    let outcome = Outcome::of(child);
    // What a busy machine gives to others is no fault of ours: where the system tells processor time, that counts.
    let took = after.zip(spent).map_or_else(|| asked.elapsed(), |(after, spent)| after.saturating_sub(spent));
    assert_eq!(outcome.code, Some(130), "{} {}", outcome.out, outcome.err);
    assert!(outcome.err.starts_with("tui: interrupted; finished spectra are kept in "), "{}", outcome.err);
    assert!(outcome.out.is_empty());
    // The promise is 50–100 ms, for each of the two threads.
    assert!(took < Duration::from_millis(600), "{took:?} of the processor after the interrupt");
    assert!(asked.elapsed() < Duration::from_secs(5), "and it does end");
    assert!(!room.entries().is_empty());
}

#[test]
fn version_and_help_stay() {
    let room = Room::new();
    let version = tui(&room, &["--version"]);
    assert_eq!(version.out, format!("tui {} (Eigenselect)\n", env!("CARGO_PKG_VERSION")));
    for (name, arguments) in [
        ("help", &["--help"][..]),
        ("help_report", &["report", "--help"]),
        ("help_spectrum", &["spectrum", "--help"]),
        ("help_synth", &["synth", "--help"]),
        ("help_cache", &["cache", "--help"]),
        ("help_cache_prune", &["cache", "prune", "--help"]),
    ] {
        let help = tui(&room, arguments);
        assert_eq!((help.code, help.err.as_str()), (Some(0), ""));
        assert!(help.out.lines().all(|line| line.chars().count() <= 120), "{}", help.out);
        insta::assert_snapshot!(name, help.out);
    }
}

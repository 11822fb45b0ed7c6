//! The layout of the code: floors, files and where each dependency may be named. A failure says what to move where.

#![allow(clippy::unwrap_used, clippy::expect_used)]

#[path = "tidy/paths.rs"]
mod paths;

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
};

/// Modules beside the floors, with all that they may import. They may be imported from floor 1 on, the store only where
/// results are kept.
const BESIDE: [(&str, &[&str]); 2] = [("dataset", &["watch", "mesh"]), ("store", &[])];
/// The lowest floors that may import a module beside the floors.
const BESIDE_FROM: [(&str, u32); 2] = [("dataset", 1), ("store", 6)];

/// Where a dependency may be named (a module, or one file), and why only there.
const HOMES: [(&str, &[&str], &str); 8] = [
    ("bincode", &["store/codec.rs"], "another codec must be able to take its place in an hour"),
    ("salsa", &["query"], "all other floors are plain functions of plain values"),
    ("faer", &["laplacian", "spectrum"], "matrices end where eigenvalues begin"),
    ("ratatui", &["ui", "terminal", "cli"], "the workbench and all below it know no terminal"),
    ("crossterm", &[], "it is used as `ratatui::crossterm`, so that there is one version of it"),
    ("clap", &["cli"], "arguments are read in one place"),
    ("color_eyre", &["cli", "terminal"], "a library's errors are typed, one enum per floor"),
    ("anyhow", &[], "a library's errors are typed, one enum per floor"),
];

/// The most lines of code and comments a file may have, tests not counted.
const LINES: usize = 450;
/// The most lines with the tests at its end.
const LINES_WITH_TESTS: usize = 800;
const LINES_OF_MAIN: usize = 40;
const COLUMNS: usize = 120;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The files below `folder` of the repository, as paths from its root with `/`, sorted. An absent folder has none.
fn files(folder: &str) -> Vec<String> {
    let mut found = Vec::new();
    let mut folders = vec![PathBuf::from(folder)];
    while let Some(folder) = folders.pop() {
        let Ok(items) = fs::read_dir(root().join(&folder)) else { continue };
        for item in items.map(Result::unwrap) {
            let path = folder.join(item.file_name());
            if item.file_type().unwrap().is_dir() {
                folders.push(path);
            } else {
                found.push(path.to_str().expect("a file name is UTF-8").replace('\\', "/"));
            }
        }
    }
    found.sort();
    found
}

fn rust_files(folder: &str) -> Vec<String> {
    files(folder)
        .into_iter()
        .filter(|file| Path::new(file).extension().is_some_and(|extension| extension == "rs"))
        .collect()
}

fn read(file: &str) -> String {
    fs::read_to_string(root().join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

/// Fails with all complaints at once.
fn assert_tidy(complaints: &[String]) {
    assert!(complaints.is_empty(), "\n\n{}\n", complaints.join("\n"));
}

/// The module of the crate's root that a file of `src` belongs to; none for `lib.rs` and `main.rs`.
fn module_of(file: &str) -> Option<&str> {
    let inside = file.strip_prefix("src/")?;
    match inside.split_once('/') {
        Some((module, _)) => Some(module),
        None => inside.strip_suffix(".rs").filter(|module| !matches!(*module, "lib" | "main")),
    }
}

/// The modules of the table in `src/lib.rs` with their floors, in its order. None stands for the sign of those beside.
fn floors() -> Vec<(String, Option<u32>)> {
    let mut floors = Vec::new();
    for line in read("src/lib.rs").lines() {
        let cells: Vec<_> = line.trim_start_matches("//!").split('|').map(str::trim).collect();
        let [_, floor, modules, _, _] = cells[..] else { continue };
        let floor = match floor {
            "–" => None,
            number => match number.parse() {
                Ok(number) => Some(number),
                Err(_) => continue,
            },
        };
        let names = modules.split("[`").skip(1).filter_map(|rest| rest.split_once("`]"));
        floors.extend(names.map(|(name, _)| (name.to_owned(), floor)));
    }
    floors
}

#[test]
fn the_table_of_floors_names_every_module_once() {
    let floors = floors();
    let mut complaints = Vec::new();
    let mut named: Vec<_> = floors.iter().map(|(module, _)| module.as_str()).collect();
    named.sort_unstable();
    let all = rust_files("src");
    let mut modules: Vec<_> = all.iter().filter_map(|file| module_of(file)).collect();
    modules.dedup();
    modules.sort_unstable();
    modules.dedup();
    for module in &modules {
        if named.iter().filter(|name| name == &module).count() != 1 {
            complaints.push(format!("src/lib.rs: give `{module}` one row in the table of floors"));
        }
    }
    for module in named.iter().filter(|name| !modules.contains(name)) {
        complaints.push(format!("src/lib.rs: the table of floors names `{module}`, which does not exist: remove it"));
    }
    for (module, _) in floors.iter().filter(|(_, floor)| floor.is_none()) {
        if !BESIDE.iter().any(|(known, _)| known == module) || !BESIDE_FROM.iter().any(|(known, _)| known == module) {
            complaints.push(format!("tests/tidy.rs: say in BESIDE what `{module}` may import, and who may import it"));
        }
    }
    let numbers: Vec<_> = floors.iter().filter_map(|(_, floor)| *floor).collect();
    if !numbers.is_sorted() || numbers.is_empty() {
        complaints.push("src/lib.rs: order the table of floors by number, the lowest first".to_owned());
    }
    assert_tidy(&complaints);
}

/// Why `from` may not import `module`, if it may not.
fn forbidden(floors: &[(String, Option<u32>)], from: &str, module: &str) -> Option<String> {
    let place = |name: &str| floors.iter().position(|(module, _)| module == name);
    let Some(there) = place(module) else {
        return Some(format!("the table of floors in src/lib.rs has no `{module}`: import from a module of the table"));
    };
    // A module that is missing in the table is another test's complaint.
    let here = place(from)?;
    let (mine, its) = (floors[here].1, floors[there].1);
    match (mine, its) {
        _ if from == module => None,
        (None, _) => {
            let may = BESIDE.iter().find(|(name, _)| *name == from).map_or(&[][..], |(_, may)| may);
            let only = if may.is_empty() { "nothing of ours".to_owned() } else { format!("only {}", may.join(", ")) };
            (!may.contains(&module)).then(|| {
                format!("`{from}` may import {only}: hand what it needs of `{module}` in as an argument, or move this code up")
            })
        }
        (Some(mine), None) => {
            let least = BESIDE_FROM.iter().find(|(name, _)| *name == module).map_or(0, |(_, least)| *least);
            (mine < least).then(|| {
                format!("`{module}` is for floors from {least} on, and `{from}` is floor {mine}: move this code up")
            })
        }
        (Some(mine), Some(its)) if its > mine => Some(format!(
            "`{module}` is floor {its}, above `{from}` on floor {mine}: move what is needed of it down to floor {mine} or \
             below, or this code up to floor {its} or above"
        )),
        (Some(mine), Some(_)) if there > here => Some(format!(
            "`{module}` stands beside `{from}` on floor {mine} and after it in the table of src/lib.rs: move what both need \
             to a lower floor"
        )),
        _ => None,
    }
}

#[test]
fn each_floor_imports_only_floors_below_it() {
    let floors = floors();
    let mut complaints = Vec::new();
    for file in rust_files("src") {
        let Some(from) = module_of(&file) else { continue };
        let depth = file.matches('/').count();
        for import in paths::imports(&read(&file), depth) {
            if let Some(why) = forbidden(&floors, from, &import.module) {
                complaints.push(format!("{file}:{}: imports `crate::{}`. {why}", import.line, import.module));
            }
        }
    }
    assert_tidy(&complaints);
}

#[test]
fn a_forbidden_import_is_told_with_its_remedy() {
    let table = [("mesh", Some(0)), ("metrics", Some(3)), ("dataset", None), ("store", None)];
    let table = table.into_iter().chain([("query", Some(6)), ("workbench", Some(7)), ("report", Some(7))]);
    let floors: Vec<_> = table.map(|(module, floor)| (module.to_owned(), floor)).collect();
    let why = |from, module| forbidden(&floors, from, module);
    for (from, module) in [("metrics", "mesh"), ("mesh", "mesh"), ("query", "store"), ("metrics", "dataset")] {
        assert_eq!(why(from, module), None, "{from} {module}");
    }
    assert_eq!((why("dataset", "mesh"), why("report", "workbench")), (None, None));
    assert!(why("metrics", "query").unwrap().contains("up to floor 6"));
    assert!(why("workbench", "report").unwrap().contains("lower floor"));
    assert!(why("metrics", "store").unwrap().contains("from 6 on"));
    assert!(why("mesh", "dataset").unwrap().contains("from 1 on"));
    assert!(why("store", "mesh").unwrap().contains("nothing of ours"));
    assert!(why("dataset", "metrics").unwrap().contains("only watch, mesh"));
    assert!(why("mesh", "typo").unwrap().contains("no `typo`"));
}

#[test]
fn dependencies_are_named_only_in_their_homes() {
    let mut complaints = Vec::new();
    for file in rust_files("src") {
        let inside = file.strip_prefix("src/").unwrap();
        for root in paths::roots(&read(&file)) {
            let Some((name, homes, why)) = HOMES.iter().find(|(name, _, _)| *name == root.module) else { continue };
            if !homes.iter().any(|home| *home == inside || Some(*home) == module_of(&file)) {
                let homes = homes.iter().map(|home| format!("src/{home}")).collect::<Vec<_>>();
                let remedy =
                    if homes.is_empty() { "remove it".into() } else { format!("move it to {}", homes.join(", ")) };
                complaints.push(format!("{file}:{}: names `{name}`: {remedy} ({why})", root.line));
            }
        }
    }
    assert_tidy(&complaints);
}

#[test]
fn a_module_is_a_file_and_a_folder_of_its_name() {
    let mut complaints = Vec::new();
    let files = rust_files("src");
    for file in &files {
        if let Some(folder) = file.strip_suffix("/mod.rs") {
            complaints.push(format!("{file}: move it to {folder}.rs"));
        }
        if let Some((folder, _)) = file.rsplit_once('/').filter(|(folder, _)| *folder != "src") {
            let parent = format!("{folder}.rs");
            if !files.contains(&parent) {
                complaints.push(format!("{file}: has no parent module: add {parent}"));
            }
        }
    }
    assert_tidy(&complaints);
}

/// The lines before the tests at the end of the file.
fn lines_of_code(source: &str) -> usize {
    let lines: Vec<_> = source.lines().collect();
    let tests = lines.windows(2).position(|pair| pair[0] == "#[cfg(test)]" && pair[1].starts_with("mod "));
    tests.unwrap_or(lines.len())
}

#[test]
fn no_file_is_two_rooms() {
    let mut complaints = Vec::new();
    for file in rust_files("src") {
        let source = read(&file);
        let (code, all) = (lines_of_code(&source), source.lines().count());
        let folder = file.strip_suffix(".rs").unwrap();
        if code > LINES {
            complaints
                .push(format!("{file}: {code} lines of code, over {LINES}: move a part of it to {folder}/<part>.rs"));
        } else if all > LINES_WITH_TESTS {
            complaints
                .push(format!("{file}: {all} lines, over {LINES_WITH_TESTS}: move its tests to {folder}/tests.rs"));
        }
        if file == "src/main.rs" && all > LINES_OF_MAIN {
            complaints.push(format!("{file}: {all} lines, over {LINES_OF_MAIN}: move what it does to src/cli/"));
        }
    }
    assert_tidy(&complaints);
}

#[test]
fn every_file_begins_by_saying_what_lives_in_it() {
    let mut complaints = Vec::new();
    for file in rust_files("src").into_iter().chain(rust_files("tests")) {
        let first = read(&file).lines().next().unwrap_or_default().to_owned();
        if first.strip_prefix("//! ").is_none_or(|text| text.trim().len() < 10) {
            complaints.push(format!("{file}:1: begin it with a line `//! …` that says what lives here"));
        }
    }
    assert_tidy(&complaints);
}

#[test]
fn prose_keeps_to_the_width_of_the_page() {
    let mut complaints = Vec::new();
    for file in rust_files("src").into_iter().chain(rust_files("tests")) {
        for (number, line) in read(&file).lines().enumerate() {
            let text = line.trim_start().trim_start_matches(['/', '!']).trim_start();
            let comment = line.trim_start().starts_with("//");
            // Accents that stand on the character before them take no column.
            let columns = line.chars().filter(|c| !matches!(c, '\u{300}'..='\u{36f}')).count();
            // Rows of a table and addresses cannot be broken.
            if comment && columns > COLUMNS && !text.starts_with('|') && !text.contains("://") {
                complaints.push(format!("{file}:{}: break the comment before column {COLUMNS}", number + 1));
            }
        }
    }
    assert_tidy(&complaints);
}

#[test]
fn nothing_names_the_machine_it_was_written_on() {
    // Put together here, so that this file does not name them.
    let homes = ["work", "root", "Users"].map(|folder| format!("/{folder}/"));
    let mut all: Vec<String> = ["src", "tests", ".ci"].into_iter().flat_map(files).collect();
    all.extend(fs::read_dir(root()).unwrap().filter_map(|item| {
        let name = item.unwrap().file_name().into_string().ok()?;
        let text = [".md", ".toml", ".lock"].iter().any(|end| name.ends_with(end));
        text.then_some(name)
    }));
    let mut complaints = Vec::new();
    for file in all {
        // A file that is no text names nothing.
        let Ok(source) = fs::read_to_string(root().join(&file)) else { continue };
        for (number, line) in source.lines().enumerate() {
            for home in homes.iter().filter(|home| line.contains(*home)) {
                complaints
                    .push(format!("{file}:{}: names a place below {home}: use a path from the repository", number + 1));
            }
        }
    }
    assert_tidy(&complaints);
}

#[test]
fn the_codec_is_pinned() {
    let manifest = read("Cargo.toml");
    let pins: BTreeMap<_, _> = manifest.lines().filter_map(|line| line.split_once(" = ")).collect();
    for name in ["bincode", "salsa"] {
        let version = pins.get(name).unwrap_or_else(|| panic!("Cargo.toml: no `{name}`"));
        assert!(version.contains("\"="), "Cargo.toml: pin `{name}` to one version: \"=…\"");
    }
}

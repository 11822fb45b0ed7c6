//! The whole experiment of the paper in one command, on a small data set.

#![allow(clippy::unwrap_used)]

mod common;

use std::{collections::BTreeMap, fs, path::Path, process::Command};

fn report(data: &Path, out: &Path, cache: &Path) -> std::process::Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_tui"));
    command.arg("report").arg(data).args(["--study", "paper", "--threads", "2", "--out"]).arg(out);
    command.arg("--cache").arg(cache).args(["--set", "kmax=20", "--set", "remesh=150", "--set", "T=5"]);
    command.output().unwrap()
}

fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    files.map(|path| (path.file_name().unwrap().to_str().unwrap().to_owned(), fs::read(&path).unwrap())).collect()
}

/// From the files of Tables 1 to 4: the figures on D that splits were computed of, those that are better than all of
/// them, and those that are worse.
fn beyond_splits(files: &BTreeMap<String, Vec<u8>>) -> (usize, usize, usize) {
    let (mut all, mut better, mut worse) = (0, 0, 0);
    for (name, bytes) in files.iter().filter(|(name, _)| name.starts_with("table-") && !name.starts_with("table-5")) {
        for line in String::from_utf8_lossy(bytes).lines().skip(1) {
            let cells = line.split(',').map(|cell| cell.parse::<f64>().ok()).collect::<Vec<_>>();
            let (Some(ours), Some(low), Some(high)) = (cells[1], cells[7], cells[8]) else { continue };
            // Tables 1 to 3 have errors, Table 4 has mean ADR.
            let (below, above) = (usize::from(ours < low), usize::from(ours > high));
            let turned = name.starts_with("table-4");
            (all, better, worse) =
                (all + 1, better + if turned { above } else { below }, worse + if turned { below } else { above });
        }
    }
    (all, better, worse)
}

#[test]
fn every_table_and_figure_is_there_and_a_second_run_gives_the_same_bytes() {
    let folder = common::scratch();
    let (data, cache) = (folder.path().join("data"), folder.path().join("cache"));
    common::write_data(&data, 3, 5);
    // Names that Markdown would read as something else, of the class and the model that Figure 1 shows.
    fs::rename(data.join("class0/m0.off"), data.join("class0/m*0_<b>.off")).unwrap();
    fs::rename(data.join("class0"), data.join("c*a_<i>")).unwrap();
    let (first, second) = (folder.path().join("first"), folder.path().join("second"));
    let output = report(&data, &first, &cache);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(report(&data, &second, &cache).status.success());
    let (first, second) = (files(&first), files(&second));
    assert_eq!(first.keys().collect::<Vec<_>>(), second.keys().collect::<Vec<_>>());
    for (name, bytes) in &first {
        assert!(*bytes == second[name], "{name} differs");
    }

    let text = String::from_utf8(first["paper.md"].clone()).unwrap();
    for name in [r"c\*a\_\<i\>", r"m\*0\_\<b\>"] {
        assert!(text.contains(name), "no {name}");
    }
    assert!(!text.contains("<i>") && !text.contains("<b>"), "names are not taken for markup");
    for wanted in
        ["Table 1", "Table 2", "Table 3", "Table 4", "Figure 1", "Figure 3", "Figure 4", "Figure 5", "Figure 6"]
    {
        assert!(text.contains(&format!("\n## {wanted}:")), "no {wanted}");
    }
    let linked = |line: &str| Some(line.strip_prefix("<img src=\"")?.split_once('"')?.0.to_owned());
    let links: Vec<String> = text.lines().filter_map(linked).collect();
    assert_eq!(links.len(), 8, "{links:?}");
    for link in links {
        assert!(first[&link].starts_with(b"<svg"), "{link}");
        assert!(first[&link.replace(".svg", ".png")].starts_with(b"\x89PNG"), "{link}");
    }
    let (all, better, worse) = beyond_splits(&first);
    let said = format!(
        "of the {all} figures on D in Tables 1 to 4 that were computed on splits too, {better} are better than on every split and {worse} worse"
    );
    assert!(all > 0 && text.contains(&said), "no {said}");
    let json: serde_json::Value = serde_json::from_slice(&first["paper.json"]).unwrap();
    let spectra = json["spectra"].as_array().unwrap();
    assert_eq!(spectra.len(), 8);
    // The same shapes have other spectra when they are re-meshed, and other figures at the same k.
    let curve = |at: usize| &spectra[at]["first_k"]["error"]["train"];
    assert_eq!(curve(0).as_array().unwrap().len(), 20);
    assert_ne!(curve(0), curve(4));
    // The cells of the CSV are those of the Markdown, unrounded.
    let table = String::from_utf8(first["table-1-first-k.csv"].clone()).unwrap();
    let least = curve(1).as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).fold(f64::INFINITY, f64::min);
    let row = table.lines().find(|line| line.starts_with("original FEM norm.")).unwrap();
    assert_eq!(row.split(',').nth(1).unwrap().parse::<f64>().unwrap(), least);
    // A model rotated has the spectrum it had, a bent one another.
    let variants = json["variation"]["variants"].as_array().unwrap();
    let fem = |variant: &serde_json::Value| {
        variant["fem"].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect::<Vec<_>>()
    };
    let variation: Vec<Vec<f64>> = variants[..4].iter().map(fem).collect();
    let difference =
        |at: usize| variation[at].iter().zip(&variation[0]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(
        difference(1) < 1e-9 && difference(2) < 1e-9 && difference(3) > 1e-3,
        "{} {}",
        difference(1),
        difference(3)
    );
    // However few the study is made of, and whichever is set, the class is there under both operators.
    let members = json["variation"]["members"].as_array().unwrap();
    assert_eq!(members.len(), 4);
    for member in members {
        assert_eq!(fem(member).len(), variation[0].len());
        assert_eq!(member["cot"].as_array().unwrap().len(), variation[0].len());
    }
    // A mesh of a quarter of the vertices has too few eigenvalues to be compared.
    assert!(variants[7]["fem"].is_null() && variants[7]["why"].as_str().unwrap().starts_with("it has "));
}

#[test]
fn a_folder_is_needed() {
    let folder = common::scratch();
    let data = folder.path().join("data");
    common::write_data(&data, 2, 2);
    let output = Command::new(env!("CARGO_BIN_EXE_tui")).arg("report").arg(&data).args(["--study", "paper"]).output();
    let output = output.unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("--out"));
}

/// Where there are no queries every split is the same one and says nothing; a document made by other moves than the
/// paper's still has the strict ones where it says so.
#[test]
fn readings_are_what_they_are_called_and_splits_need_queries() {
    let folder = common::scratch();
    let (data, out) = (folder.path().join("data"), folder.path().join("out"));
    common::write_data(&data.join("train"), 3, 4);
    let mut command = Command::new(env!("CARGO_BIN_EXE_tui"));
    command.args(["report", "--study", "paper", "--threads", "2"]).arg(&data).arg("--out").arg(&out);
    command.arg("--cache").arg(folder.path().join("cache"));
    command.args(["--set", "kmax=12", "--set", "remesh=120", "--set", "T=3", "--set", "search=beam"]);
    let output = command.output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let files = files(&out);
    let csv = |name: &str| String::from_utf8(files[name].clone()).unwrap();
    let table = csv("table-2-hcbw.csv");
    let place = |head: &str| table.lines().next().unwrap().split(',').position(|column| column == head).unwrap();
    let ends = |row: &str| [place("splits from"), place("to")].map(|at| row.split(',').nth(at).unwrap().to_owned());
    assert!(table.lines().skip(1).all(|row| ends(row) == ["", ""]), "{table}");
    assert!(!csv("paper.md").contains("such splits"), "nothing is said of splits that are one");
    let json: serde_json::Value = serde_json::from_slice(&files["paper.json"]).unwrap();
    let spectra = json["spectra"].as_array().unwrap();
    let mut compared = 0;
    for row in csv("readings.csv").lines().filter(|row| row.starts_with("Table 4,") || row.starts_with("Table 2,")) {
        let cells: Vec<&str> = row.split(',').collect();
        let figure = if cells[0] == "Table 2" { "error" } else { "adr" };
        let searches = &spectra.iter().find(|rows| rows["name"] == cells[1]).unwrap()["splits"]["searches"];
        let values: Vec<f64> = (0..3).map(|at| searches[at][figure].as_f64().unwrap()).collect();
        let shown: Vec<f64> = cells[3..6].iter().map(|cell| cell.parse().unwrap()).collect();
        assert_eq!(shown, values, "{row}");
        compared += 1;
    }
    assert_eq!(compared, 12);
}

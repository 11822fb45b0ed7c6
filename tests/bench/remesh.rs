//! Re-meshes given meshes and measures the results:
//!
//!     cargo bench --bench remesh -- [--count N] [--solve] [--rounds N] [--out FOLDER] [--samples N] MESH…
//!
//! A line for each mesh, then what of the set was measured and how. Times are CPU seconds of this one thread. With
//! `--solve` each round re-meshes the original, then solves it and the result for 500 eigenvalues (FEM, consistent
//! masses), so that all see the same machine; the medians of the rounds (1) are taken, and their quotients. Whatever
//! else the machine does then cancels, all but.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

use std::path::{Path, PathBuf};

use eigenselect::{
    mesh::{Format, read, write},
    remesh::{self, quality, remesh},
    spectrum::{Choice, solve},
    watch::Unwatched,
};

/// CPU seconds of this process so far.
fn cpu() -> f64 {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ProcessCPUTime);
    time.tv_sec as f64 + 1e-9 * time.tv_nsec as f64
}

/// One mesh's figures.
struct Row {
    vertices: usize,
    kept: bool,
    angle: f64,
    least: f64,
    variation: f64,
    hausdorff: f64,
    area: f64,
    seconds: f64,
    /// CPU seconds for 500 eigenvalues of the original and of the result.
    solves: Option<[f64; 2]>,
}

/// What is asked for.
struct Task {
    count: usize,
    samples: usize,
    rounds: usize,
    with_solve: bool,
    out: Option<PathBuf>,
}

/// What a task's rounds took, in their order; the median is what counts.
#[derive(Default)]
struct Times(Vec<f64>);

impl Times {
    fn take<T>(&mut self, work: impl FnOnce() -> T) -> T {
        let start = cpu();
        let result = work();
        self.0.push(cpu() - start);
        result
    }

    fn median(&mut self) -> f64 {
        self.0.sort_unstable_by(f64::total_cmp);
        self.0[self.0.len() / 2]
    }
}

/// Reads one figure off a row.
type Figure = fn(&Row) -> f64;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let mut task = Task { count: remesh::USUAL, samples: 40_000, rounds: 1, with_solve: false, out: None };
    let mut files = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--count" => task.count = arguments.next().unwrap().parse().unwrap(),
            "--samples" => task.samples = arguments.next().unwrap().parse().unwrap(),
            "--rounds" => task.rounds = arguments.next().unwrap().parse().unwrap(),
            "--solve" => task.with_solve = true,
            "--out" => task.out = arguments.next().map(PathBuf::from),
            _ => files.push(PathBuf::from(argument)),
        }
    }
    println!("mesh n0 n components/euler/loops kept angle1 least cv hausdorff% in% out% area% seconds [solve] [its]");
    let rows: Vec<Row> = files.iter().filter_map(|file| measure(file, &task)).collect();
    summarise(&rows, &task, files.len());
}

fn measure(file: &Path, task: &Task) -> Option<Row> {
    let name = file.file_stem().unwrap().to_string_lossy();
    let mesh = match read(&std::fs::read(file).unwrap(), Format::of(file).unwrap()) {
        Ok(mesh) => mesh.canonical(),
        Err(error) => {
            println!("{name} not read: {error}");
            return None;
        }
    };
    let [mut times, mut original, mut its] = [Times::default(), Times::default(), Times::default()];
    let mut result = None;
    for _ in 0..task.rounds {
        match times.take(|| remesh(&mesh, task.count, &Unwatched)) {
            Ok(made) => {
                if task.with_solve {
                    original.take(|| solve(&mesh, Choice::default(), 500, &[], &Unwatched)).unwrap();
                    its.take(|| solve(&made, Choice::default(), 500, &[], &Unwatched)).unwrap();
                }
                result = Some(made);
            }
            Err(error) => {
                println!("{name} {} {error}", mesh.vertices().len());
                return None;
            }
        }
    }
    let (result, seconds) = (result?, times.median());
    let solves = task.with_solve.then(|| [original.median(), its.median()]);
    let (before, after) = (quality::topology(&mesh), quality::topology(&result));
    let shape = quality::shape(&result);
    let fidelity = quality::fidelity(&mesh, &result, task.samples).unwrap();
    let kept = before == after;
    if let Some(out) = &task.out {
        let mut file = std::fs::File::create(out.join(format!("{name}.obj"))).unwrap();
        write::obj(&result, &mut file).unwrap();
    }
    println!(
        "{name} {} {} {}/{}/{} {} {:.1} {:.1} {:.3} {:.3} {:.3} {:.3} {:.2} {seconds:.4} {}",
        mesh.vertices().len(),
        result.vertices().len(),
        before.components,
        before.euler,
        before.loops,
        if kept { "yes" } else { "NO" },
        shape.angle_1,
        shape.least_angle,
        shape.edge_variation,
        100.0 * fidelity.hausdorff(),
        100.0 * fidelity.inwards,
        100.0 * fidelity.outwards,
        100.0 * fidelity.area_change,
        solves.map_or(String::new(), |[original, its]| format!("{original:.3} {its:.3}")),
    );
    Some(Row {
        vertices: result.vertices().len(),
        kept,
        angle: shape.angle_1,
        least: shape.least_angle,
        variation: shape.edge_variation,
        hausdorff: 100.0 * fidelity.hausdorff(),
        area: 100.0 * fidelity.area_change.abs(),
        seconds,
        solves,
    })
}

fn summarise(rows: &[Row], task: &Task, files: usize) {
    let count = task.count;
    let exact = rows.iter().filter(|row| row.vertices == count).count();
    let kept = rows.iter().filter(|row| row.kept).count();
    println!("\nmeshes {files}, re-meshed {}, exactly {count} vertices {exact}, topology kept {kept}", rows.len());
    println!("CPU seconds of one thread, medians of {} rounds; distances at {} points", task.rounds, task.samples);
    let table: [(&str, Figure); 8] = [
        ("least angle, 1st percentile, degrees", |row| row.angle),
        ("least angle of all, degrees", |row| row.least),
        ("variation of edge lengths", |row| row.variation),
        ("Hausdorff distance, % of diagonal", |row| row.hausdorff),
        ("change of area, %", |row| row.area),
        ("CPU seconds", |row| row.seconds),
        ("the same over the original's solve", |row| {
            row.solves.map_or(f64::NAN, |[original, _]| row.seconds / original)
        }),
        ("the same over the result's solve", |row| row.solves.map_or(f64::NAN, |[_, its]| row.seconds / its)),
    ];
    let shares = [0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0];
    let heads = ["least", "5 %", "25 %", "median", "75 %", "95 %", "greatest"].map(|head| format!("{head:>9}"));
    println!("{:38}{}", "", heads.concat());
    for (name, figure) in table {
        let mut all: Vec<f64> = rows.iter().map(figure).filter(|figure| !figure.is_nan()).collect();
        all.sort_unstable_by(f64::total_cmp);
        if let [.., _] = all[..] {
            let at = |share: f64| format!("{:9.4}", all[(share * (all.len() - 1) as f64).round() as usize]);
            println!("{name:38}{}", shares.map(at).concat());
        }
    }
}

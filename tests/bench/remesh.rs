//! Re-meshes given meshes and measures the results: `remesh [--count N] [--solve] [--out FOLDER] [--samples N] MESH…`.
//!
//! A line for each mesh, then the figures of the whole set. Times are CPU seconds of this one thread; with `--solve`
//! also of the 500-eigenvalue solve of the original, right after, so that both see the same machine.
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
    solve: Option<f64>,
}

/// Reads one figure off a row.
type Figure = fn(&Row) -> f64;

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut count, mut with_solve, mut samples) = (remesh::USUAL, false, 40_000);
    let mut out: Option<PathBuf> = None;
    let mut files = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--count" => count = arguments.next().unwrap().parse().unwrap(),
            "--samples" => samples = arguments.next().unwrap().parse().unwrap(),
            "--solve" => with_solve = true,
            "--out" => out = arguments.next().map(PathBuf::from),
            _ => files.push(PathBuf::from(argument)),
        }
    }
    println!("mesh n0 n components/euler/loops kept angle1 least cv hausdorff% in% out% area% seconds [solve]");
    let rows: Vec<Row> =
        files.iter().filter_map(|file| measure(file, count, samples, with_solve, out.as_deref())).collect();
    summarise(&rows, count, files.len());
}

fn measure(file: &Path, count: usize, samples: usize, with_solve: bool, out: Option<&Path>) -> Option<Row> {
    let name = file.file_stem().unwrap().to_string_lossy();
    let mesh = match read(&std::fs::read(file).unwrap(), Format::of(file).unwrap()) {
        Ok(mesh) => mesh.canonical(),
        Err(error) => {
            println!("{name} not read: {error}");
            return None;
        }
    };
    let start = cpu();
    let result = match remesh(&mesh, count, &Unwatched) {
        Ok(result) => result,
        Err(error) => {
            println!("{name} {} {error}", mesh.vertices().len());
            return None;
        }
    };
    let seconds = cpu() - start;
    let (before, after) = (quality::topology(&mesh), quality::topology(&result));
    let shape = quality::shape(&result);
    let fidelity = quality::fidelity(&mesh, &result, samples).unwrap();
    let kept = before == after;
    let solve = with_solve.then(|| {
        let start = cpu();
        solve(&mesh, Choice::default(), 500, &[], &Unwatched).unwrap();
        cpu() - start
    });
    if let Some(out) = out {
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
        solve.map_or(String::new(), |seconds| format!("{seconds:.3}")),
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
        solve,
    })
}

fn summarise(rows: &[Row], count: usize, files: usize) {
    let exact = rows.iter().filter(|row| row.vertices == count).count();
    let kept = rows.iter().filter(|row| row.kept).count();
    println!("\nmeshes {files}, re-meshed {}, exactly {count} vertices {exact}, topology kept {kept}", rows.len());
    let table: [(&str, Figure); 7] = [
        ("least angle, 1st percentile, degrees", |row| row.angle),
        ("least angle of all, degrees", |row| row.least),
        ("variation of edge lengths", |row| row.variation),
        ("Hausdorff distance, % of diagonal", |row| row.hausdorff),
        ("change of area, %", |row| row.area),
        ("CPU seconds", |row| row.seconds),
        ("share of the solve", |row| row.solve.map_or(f64::NAN, |solve| row.seconds / solve)),
    ];
    println!("{:38} {:>9} {:>9} {:>9} {:>9} {:>9}", "", "least", "5 %", "median", "95 %", "greatest");
    for (name, figure) in table {
        let mut all: Vec<f64> = rows.iter().map(figure).filter(|figure| !figure.is_nan()).collect();
        all.sort_unstable_by(f64::total_cmp);
        if let [first, .., last] = all[..] {
            let at = |share: f64| all[(share * (all.len() - 1) as f64).round() as usize];
            println!("{name:38} {first:9.4} {:9.4} {:9.4} {:9.4} {last:9.4}", at(0.05), at(0.5), at(0.95));
        }
    }
}

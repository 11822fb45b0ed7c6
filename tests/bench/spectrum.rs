//! Times the solver on given meshes.
//!
//!     cargo bench --bench spectrum -- [--count N] [--rounds N] [--choice fem|lumped|cot] [--json | --values] MESH…
//!
//! For every mesh and round it tells the processor time of the solve by part, from the mesh in memory to the
//! certified eigenvalues and on one thread, and at the end of a mesh the median of the rounds. `--json` prints one
//! object per round instead, `--values` the eigenvalues with their bounds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

use std::time::Instant;

use eigenselect::{
    laplacian::{Mass, Operator},
    mesh::{Format, Mesh, read},
    spectrum::{Choice, Cost, Spectrum, SpectrumError, solve},
    watch::Unwatched,
};

/// The most memory that the process has had, in bytes, where the system tells.
fn peak() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? * 1024)
}

#[derive(Clone, Copy, PartialEq)]
enum Output {
    Text,
    Json,
    Values,
}

struct Options {
    count: usize,
    rounds: usize,
    choice: Choice,
    output: Output,
    files: Vec<String>,
}

fn options() -> Options {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let mut options =
        Options { count: 500, rounds: 1, choice: Choice::default(), output: Output::Text, files: Vec::new() };
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().expect("an option needs a value");
        match argument.as_str() {
            "--count" => options.count = value().parse().unwrap(),
            "--rounds" => options.rounds = value().parse().unwrap(),
            "--values" => options.output = Output::Values,
            "--json" => options.output = Output::Json,
            "--choice" => {
                options.choice = match value().as_str() {
                    "fem" => Choice::new(Operator::Fem, Mass::Consistent),
                    "lumped" => Choice::new(Operator::Fem, Mass::Lumped),
                    "cot" => Choice::new(Operator::Cot, Mass::Consistent),
                    other => panic!("no choice is called {other}"),
                }
            }
            _ => options.files.push(argument),
        }
    }
    options
}

fn main() {
    let options = options();
    for file in &options.files {
        let format = Format::of(file.as_ref()).unwrap();
        let mesh = match read(&std::fs::read(file).unwrap(), format) {
            Ok(mesh) => mesh.canonical(),
            Err(error) => {
                println!("{file} not read: {error}");
                continue;
            }
        };
        measure(&options, file, &mesh);
    }
}

fn measure(options: &Options, file: &str, mesh: &Mesh) {
    let mut all = Vec::new();
    for _ in 0..options.rounds {
        let start = Instant::now();
        let result = solve(mesh, options.choice, options.count, &[], &Unwatched);
        let wall = start.elapsed().as_secs_f64();
        match result {
            Ok(spectrum) => {
                all.push(spectrum.timings.total());
                tell(options, file, &spectrum, wall);
            }
            Err(SpectrumError::Refused(reason)) => println!("{file} refused: {reason}"),
            Err(error) => println!("{file} failed after {wall:.4} s: {error}"),
        }
    }
    all.sort_by(f64::total_cmp);
    if options.output == Output::Text && all.len() > 1 {
        println!("{file} median {:.4} s of processor time in {} rounds", all[all.len() / 2], all.len());
    }
}

fn tell(options: &Options, file: &str, spectrum: &Spectrum, wall: f64) {
    let timings = &spectrum.timings;
    let parts = || Cost::ALL.into_iter().map(|cost| (cost.name(), timings.seconds(cost)));
    match options.output {
        Output::Values => {
            for (value, error) in spectrum.eigenvalues().iter().zip(spectrum.residuals()) {
                println!("{value:e} {error:e}");
            }
        }
        Output::Json => {
            let parts: serde_json::Map<_, _> =
                parts().map(|(name, seconds)| (name.to_owned(), seconds.into())).collect();
            let line = serde_json::json!({
                "mesh": file, "order": spectrum.order, "asked": options.count, "found": spectrum.count(),
                "bands": spectrum.bands.len(), "processor": timings.total(), "wall": wall, "parts": parts,
                "factorisations": timings.factorisations, "solves": timings.solves, "processes": timings.processes,
                "pairs": timings.pairs, "passed": timings.passed,
                "entries": timings.entries, "multiplications": timings.multiplications,
                "peak": peak(), "eigenvalues": spectrum.eigenvalues(), "errors": spectrum.residuals(),
            });
            println!("{line}");
        }
        Output::Text => {
            let pairs = spectrum.eigenvalues().into_iter().zip(spectrum.residuals()).skip(spectrum.zeros);
            let worst = pairs.fold(0.0_f64, |most, (value, error)| most.max(error / value));
            println!(
                "{file} n {} found {} bands {} processor {:.4} wall {wall:.4} peak {:.0} MB worst bound {worst:.0e}",
                spectrum.order,
                spectrum.count(),
                spectrum.bands.len(),
                timings.total(),
                peak().unwrap_or(0) as f64 / 1e6
            );
            let parts: Vec<String> = parts().map(|(name, seconds)| format!("{name} {:.1}", 1e3 * seconds)).collect();
            println!(
                "    ms: {}; {} factorisations, {} solves, {} processes",
                parts.join(", "),
                timings.factorisations,
                timings.solves,
                timings.processes
            );
        }
    }
}

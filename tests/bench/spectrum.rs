//! Times the solver on given meshes: `spectrum [--count N] [--rounds N] [--choice fem|lumped|cot] [--values] MESH…`.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout)]

use std::time::Instant;

use eigenselect::{
    laplacian::{Mass, Operator},
    mesh::{Format, read},
    spectrum::{Choice, solve},
    watch::Unwatched,
};

fn main() {
    let mut arguments = std::env::args().skip(1).filter(|argument| argument != "--bench");
    let (mut count, mut rounds, mut values) = (500, 1, false);
    let mut choice = Choice::default();
    let mut files = Vec::new();
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--count" => count = arguments.next().unwrap().parse().unwrap(),
            "--rounds" => rounds = arguments.next().unwrap().parse().unwrap(),
            "--values" => values = true,
            "--choice" => {
                choice = match arguments.next().unwrap().as_str() {
                    "fem" => Choice::new(Operator::Fem, Mass::Consistent),
                    "lumped" => Choice::new(Operator::Fem, Mass::Lumped),
                    _ => Choice::new(Operator::Cot, Mass::Consistent),
                }
            }
            _ => files.push(argument),
        }
    }
    for file in files {
        let format = Format::of(file.as_ref()).unwrap();
        let mesh = match read(&std::fs::read(&file).unwrap(), format) {
            Ok(mesh) => mesh.canonical(),
            Err(error) => {
                println!("{file} not read: {error}");
                continue;
            }
        };
        for _ in 0..rounds {
            let start = Instant::now();
            let result = solve(&mesh, choice, count, &[], &Unwatched);
            let seconds = start.elapsed().as_secs_f64();
            match result {
                Ok(spectrum) if values => {
                    for (value, error) in spectrum.eigenvalues().iter().zip(spectrum.residuals()) {
                        println!("{value:e} {error:e}");
                    }
                }
                Ok(spectrum) => println!(
                    "{file} n {} found {} bands {} seconds {seconds:.4} {:?}",
                    spectrum.order,
                    spectrum.count(),
                    spectrum.bands.len(),
                    spectrum.notes
                ),
                Err(error) => println!("{file} seconds {seconds:.4} failed: {error}"),
            }
        }
    }
}

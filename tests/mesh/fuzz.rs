//! Random bytes and random triangle lists, for as long as one likes.
//!
//! `EIGENSELECT_FUZZ_SECONDS=1800 cargo test --release --test mesh fuzz -- --nocapture` runs each test for half an
//! hour instead of a fixed number of cases. A case is made of its number alone: `EIGENSELECT_FUZZ_FROM=N` begins with
//! the one that failed.

use std::{
    panic::{AssertUnwindSafe, catch_unwind, resume_unwind},
    time::{Duration, Instant},
};

use eigenselect::{
    laplacian::{Boundary, Choice, Mass, Operator, Triangulation, assemble},
    mesh::{Format, Mesh, survey},
    spectrum::{SpectrumError, solve},
    watch::Watch,
};
use proptest::{
    prelude::*,
    strategy::ValueTree,
    test_runner::{RngAlgorithm, TestRng, TestRunner},
};

use crate::{
    hostile::{Memory, apply, digest, edit, seeds},
    memory::bound,
    shapes,
};

/// Longer than any case may take on a busy machine.
const PATIENCE: Duration = Duration::from_mins(1);

/// What the case of this number draws from.
fn runner(number: u64) -> TestRunner {
    let seed: Vec<u8> = number.to_le_bytes().repeat(4);
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &seed);
    TestRunner::new_with_rng(ProptestConfig::default(), rng)
}

/// Runs cases until the budget is spent; `case` gives what it came to. The fixed cases must all end in a result or a
/// refusal; of the many others of a long run those that end in "not …" are told.
fn run(name: &str, cases: u64, case: impl Fn(&mut TestRunner) -> &'static str) {
    let variable = |name: &str| std::env::var(name).ok().and_then(|value| value.parse::<u64>().ok());
    let budget = variable("EIGENSELECT_FUZZ_SECONDS").map(Duration::from_secs);
    let first = variable("EIGENSELECT_FUZZ_FROM").unwrap_or(0);
    let start = Instant::now();
    let mut outcomes = std::collections::BTreeMap::<&str, u64>::new();
    let mut slowest = (Duration::ZERO, 0);
    for number in first.. {
        if budget.map_or(number >= first + cases, |budget| start.elapsed() >= budget) {
            break;
        }
        let mut runner = runner(number);
        let begun = Instant::now();
        match catch_unwind(AssertUnwindSafe(|| case(&mut runner))) {
            Ok(outcome) => {
                *outcomes.entry(outcome).or_default() += 1;
                if outcome.starts_with("not ") {
                    println!("{name}: case {number}: {outcome}");
                }
            }
            Err(panic) => {
                println!("{name}: case {number} failed; EIGENSELECT_FUZZ_FROM={number} repeats it");
                resume_unwind(panic);
            }
        }
        slowest = slowest.max((begun.elapsed(), number));
        assert!(slowest.0 < PATIENCE, "{name}: case {number} took {:?}", slowest.0);
    }
    println!("{name}: {outcomes:?}; the slowest, case {}, took {:?}", slowest.1, slowest.0);
    let unsolved: u64 =
        outcomes.iter().filter(|(outcome, _)| outcome.starts_with("not ")).map(|(_, count)| count).sum();
    assert!(unsolved == 0 || budget.is_some() || first > 0, "{name}: {unsolved} of the fixed cases are not solved");
}

/// A value of a strategy.
fn draw<T: std::fmt::Debug>(runner: &mut TestRunner, strategy: impl Strategy<Value = T>) -> T {
    strategy.new_tree(runner).unwrap().current()
}

#[test]
fn readers() {
    let seeds = seeds();
    run("readers", 2000, |runner| {
        let (format, bytes) = match draw(runner, 0..4_u8) {
            0 => {
                let bytes = draw(runner, prop::collection::vec(any::<u8>(), 0..2000));
                (draw(runner, prop::sample::select(Format::ALL.to_vec())), bytes)
            }
            1 => {
                // Text of the characters that formats are made of.
                let text = draw(runner, "(OFF|ply|solid|v |f |# )?[-+0-9.eE \n\tvfxyz/,]{0,400}");
                (draw(runner, prop::sample::select(Format::ALL.to_vec())), text.into_bytes())
            }
            _ => {
                let (format, mut bytes) = draw(runner, prop::sample::select(seeds.clone()));
                for edit in draw(runner, prop::collection::vec(edit(), 1..20)) {
                    apply(&mut bytes, &edit);
                }
                (format, bytes)
            }
        };
        if digest(&bytes, format) { "meshes" } else { "refused" }
    });
}

/// A coordinate: good, repeated, tiny, huge, or none.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -1.0..1.0f64,
        8 => (-3..4i8).prop_map(f64::from),
        2 => (-1.0..1.0f64, -20..1i32).prop_map(|(value, power)| value * 10_f64.powi(power)),
        1 => Just(-0.0),
    ]
}

/// Triangles between few or many points, at random or those of a mesh that has been ill-treated.
fn mesh(runner: &mut TestRunner) -> Mesh {
    let mesh = match draw(runner, 0..12_u8) {
        0..=3 => {
            let count = draw(runner, prop_oneof![6 => 1..12usize, 3 => 12..60usize, 1 => 60..300usize]);
            let points = draw(runner, prop::collection::vec(prop::array::uniform3(coordinate()), count));
            let corner = 0..count as u32;
            let most = if draw(runner, any::<bool>()) { 3 * count } else { count };
            Mesh::new(points, draw(runner, prop::collection::vec(prop::array::uniform3(corner), 0..most.max(1))))
        }
        4 => {
            let apart = draw(runner, -1.0..3.0f64);
            let other = shapes::moved(&shapes::disk(3), |[x, y, z]| [x + apart, y, z]);
            shapes::joined(&[shapes::icosphere(draw(runner, 0..3usize)), other])
        }
        8 => shapes::cap(draw(runner, 1..10usize), draw(runner, 1e-6..3.1f64)),
        9 => shapes::soup(&shapes::icosphere(1)),
        5 => shapes::rectangle(draw(runner, 1..20usize), draw(runner, 1..12usize)),
        6 => shapes::disk(draw(runner, 1..12usize)),
        7 => Mesh::new(shapes::icosphere(2).vertices().to_vec(), Vec::new()),
        _ => shapes::icosphere(draw(runner, 0..4usize)),
    };
    let (mut points, mut triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    let edits = draw(runner, 0..40usize);
    for _ in 0..edits {
        let vertex = draw(runner, 0..points.len());
        let other = draw(runner, 0..points.len());
        let face = (!triangles.is_empty()).then(|| draw(runner, 0..triangles.len()));
        match (draw(runner, 0..9_u8), face) {
            (0, _) => points[vertex] = draw(runner, prop::array::uniform3(coordinate())),
            (1, _) => points[vertex] = points[other],
            (2, _) => points[vertex] = [0, 1, 2].map(|axis| f64::midpoint(points[vertex][axis], points[other][axis])),
            (3, Some(face)) => drop(triangles.swap_remove(face)),
            (4, Some(face)) => triangles.push(triangles[face]),
            (5, Some(face)) => triangles[face].swap(0, 1),
            (6, Some(face)) => triangles[face][0] = vertex as u32,
            (7, Some(face)) => triangles.push([triangles[face][0], triangles[face][1], vertex as u32]),
            _ => points.push(points[vertex]),
        }
    }
    // The whole of it squeezed, stretched or scaled.
    let scale: Vec<f64> =
        (0..3).map(|_| 10_f64.powi(draw(runner, prop_oneof![6 => Just(0), 1 => -12..13i32]))).collect();
    let all = 10_f64.powi(draw(runner, prop_oneof![8 => Just(0), 1 => -150..150i32]));
    for point in &mut points {
        *point = [0, 1, 2].map(|axis| point[axis] * scale[axis] * all);
    }
    if draw(runner, 0..50_u8) == 0 {
        points[0][0] = f64::NAN;
    }
    Mesh::new(points, triangles)
}

fn choice(runner: &mut TestRunner) -> Choice {
    let operator = draw(runner, prop::sample::select(vec![Operator::Fem, Operator::Fem, Operator::Cot]));
    let mass = draw(runner, prop::sample::select(Mass::ALL.to_vec()));
    let boundary = draw(runner, prop::sample::select(vec![Boundary::Neumann, Boundary::Neumann, Boundary::Dirichlet]));
    let triangulation = draw(runner, prop::sample::select(Triangulation::ALL.to_vec()));
    Choice::new(operator, mass).with_boundary(boundary).with_triangulation(triangulation)
}

/// Stops what takes too long.
struct Deadline(Instant);

impl Watch for Deadline {
    fn cancelled(&self) -> bool {
        self.0.elapsed() > PATIENCE
    }
}

#[test]
fn operators_and_spectra() {
    run("operators and spectra", 300, solved);
}

/// Masses that differ by many orders, so that most eigenvalues hardly differ beside the shift.
#[test]
fn graded_meshes_of_which_eigenvalues_were_once_wrong_or_not_certified() {
    let sparse = [5_000_345, 5_001_704, 5_002_750, 5_003_995, 6_286_382, 20_191_592];
    // Tips of triangles that hang on by weights of zero, and a zero that is off by more than a ten-millionth.
    let zeros = [970_003_912, 970_005_545, 970_025_972, 970_027_607, 970_032_601, 970_044_235];
    // Small pieces: one that is held by a ten-million-millionth of its weights, others with eigenvalues of all orders.
    let dense = [970_048_747, 970_006_294, 970_006_801, 970_007_400, 970_007_435, 970_018_229, 970_022_913];
    for case in sparse.into_iter().chain(zeros).chain(dense) {
        assert_eq!(solved(&mut runner(case)), "certified", "case {case}");
    }
}

/// Solves some mesh under some choice and checks what can be checked.
fn solved(runner: &mut TestRunner) -> &'static str {
    let (mesh, choice) = (mesh(runner).canonical(), choice(runner));
    let count = draw(runner, prop_oneof![1..30usize, Just(usize::MAX)]);
    assert!(!survey(&mesh).defects.iter().any(|defect| defect.to_string().is_empty()));
    let memory = Memory::start();
    let found = solve(&mesh, choice, count, &[], &Deadline(Instant::now()));
    let most = memory.most();
    // What the solver holds for a small mesh whatever its size, and for each vertex and face.
    let allowed = found.as_ref().map_or(usize::MAX, |spectrum| bound(&mesh, spectrum));
    // Where the slow way did not help either it has kept what it found.
    let allowed = allowed.min(8_000_000 + 30_000 * (mesh.vertices().len() + mesh.triangles().len()));
    assert!(most < allowed, "{most} bytes for {} vertices", mesh.vertices().len());
    let describe = |error: &SpectrumError| {
        let (vertices, faces) = (mesh.vertices().len(), mesh.triangles().len());
        println!("{choice:?}, {vertices} vertices, {faces} faces: {error}");
    };
    let spectrum = match found {
        Ok(spectrum) => spectrum,
        Err(SpectrumError::Refused(reason)) => {
            assert!(reason.len() > 10, "{reason}");
            if reason.contains("degenerate") {
                describe(&SpectrumError::Refused(reason));
                return "not solved";
            }
            return "refused";
        }
        Err(error @ SpectrumError::Uncertified { .. }) => {
            describe(&error);
            return "not certified";
        }
        Err(error) => panic!("{error}"),
    };
    let values = spectrum.eigenvalues();
    assert!(values.is_sorted() && values.iter().all(|value| value.is_finite() && *value >= 0.0), "{values:?}");
    assert!(values.len() >= count.min(spectrum.order));
    assert_eq!(values.iter().filter(|value| **value == 0.0).count(), spectrum.zeros.min(values.len()));
    let laplacian = assemble(&mesh, choice).unwrap();
    assert!(laplacian.matrix.entries().all(|entry| entry.2.is_finite() && entry.3.is_finite()));
    if choice.boundary == Boundary::Neumann {
        // Parts of a component may hang together by weights that are zero in double precision.
        assert!(spectrum.zeros >= laplacian.components);
    }
    // The sum of all eigenvalues is the trace of B⁻¹L.
    let diagonal = choice.operator == Operator::Cot || choice.mass == Mass::Lumped;
    if values.len() == spectrum.order && diagonal {
        let on = laplacian.matrix.entries().filter(|entry| entry.0 == entry.1);
        let trace: f64 = on.map(|entry| entry.2 / entry.3).sum::<f64>() * laplacian.unit();
        let sum: f64 = values.iter().sum();
        let bound: f64 = spectrum.residuals().iter().sum();
        assert!((sum - trace).abs() <= 1e-8 * trace + bound, "{choice:?}: {sum} {trace}, bounds {bound:e}");
    }
    "certified"
}

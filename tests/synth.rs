//! The procedural shapes, and the starter set made of them.

// Helpers of tests, which clippy does not know as tests.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    sync::atomic::{AtomicUsize, Ordering},
};

use eigenselect::{
    mesh::{
        Format, Mesh, read, survey,
        synth::{self, Options, SynthError},
        write,
    },
    watch::{Unwatched, Watch},
};
use rayon::prelude::*;

fn starter() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("data")
}

fn bytes(mesh: &Mesh) -> Vec<u8> {
    let mut bytes = Vec::new();
    write::obj(mesh, &mut bytes).unwrap();
    bytes
}

/// The least angle of any triangle, in degrees.
fn least_angle(mesh: &Mesh) -> f64 {
    let mut least = f64::INFINITY;
    for triangle in mesh.triangles() {
        let corners = triangle.map(|i| mesh.vertices()[i as usize]);
        let side = |i: usize, j: usize| (0..3).map(|x| (corners[i][x] - corners[j][x]).powi(2)).sum::<f64>().sqrt();
        for i in 0..3 {
            let (p, q, across) = (side(i, (i + 1) % 3), side(i, (i + 2) % 3), side((i + 1) % 3, (i + 2) % 3));
            least = least.min(((p * p + q * q - across * across) / (2.0 * p * q)).acos().to_degrees());
        }
    }
    least
}

/// Six times the enclosed volume; negative where the triangles face inwards.
fn volume6(mesh: &Mesh) -> f64 {
    let corner = |i: u32| mesh.vertices()[i as usize];
    let triple = |[a, b, c]: [[f64; 3]; 3]| {
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    };
    mesh.triangles().iter().map(|t| triple(t.map(corner))).sum()
}

/// What every generated mesh is promised to be.
fn assert_sound(mesh: &Mesh, name: &str, genus: usize, vertices: usize) {
    let found = survey(mesh);
    assert!(found.closed_manifold() && found.oriented, "{name} is no closed oriented manifold: {:?}", found.defects);
    assert_eq!(found.components, 1, "{name}");
    assert_eq!(found.genus, Some(genus as u64), "{name}");
    assert!(found.defects.is_empty(), "{name}: {:?}", found.defects);
    assert!(volume6(mesh) > 0.0, "{name} is inside out");
    let angle = least_angle(mesh);
    assert!(angle > synth::LEAST_ANGLE - 1e-6, "{name} has an angle of {angle} degrees");
    let off = mesh.vertices().len() as f64 / vertices as f64 - 1.0;
    assert!(off.abs() <= synth::WITHIN, "{name} has {} vertices", mesh.vertices().len());
}

/// All files below a folder, with their bytes.
fn tree(root: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut folders = vec![root.to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                found.insert(path.strip_prefix(root).unwrap().to_path_buf(), fs::read(&path).unwrap());
            }
        }
    }
    found
}

#[test]
fn the_starter_set_is_complete_sound_and_small() {
    let options = Options::default();
    let mut expected = BTreeMap::new();
    for &class in &options.classes {
        for index in 0..options.models {
            expected.insert(synth::model_path(&options, class, index), synth::genus(class).unwrap());
        }
    }
    let mut found = tree(&starter());
    found.retain(|path, _| path.extension().is_some_and(|ending| ending == "obj"));
    assert_eq!(found.keys().collect::<Vec<_>>(), expected.keys().collect::<Vec<_>>());
    assert!(found.values().map(Vec::len).sum::<usize>() <= 8_000_000);

    let hashes: Vec<_> = found
        .par_iter()
        .map(|(path, bytes)| {
            let mesh = read(bytes, Format::Obj).unwrap();
            assert_sound(&mesh, &path.display().to_string(), expected[path], options.vertices);
            mesh.hash()
        })
        .collect();
    let distinct: std::collections::BTreeSet<_> = hashes.iter().collect();
    assert_eq!(distinct.len(), hashes.len(), "two models are the same shape");
    let genera: std::collections::BTreeSet<_> = expected.values().collect();
    assert!(genera.len() >= 4, "genera {genera:?}");
}

#[test]
fn the_starter_set_is_what_the_generator_makes() {
    let options = Options::default();
    options.classes.par_iter().for_each(|&class| {
        // One of each class, so that all manners of tessellation and both roles are among them.
        let index = class % options.models;
        let path = synth::model_path(&options, class, index);
        let mesh = synth::generate(&options, class, index).unwrap();
        let committed = fs::read(starter().join(&path)).unwrap();
        assert!(bytes(&mesh) == committed, "{} differs from what the generator makes", path.display());
        assert_eq!(read(&committed, Format::Obj).unwrap(), mesh, "{}", path.display());
    });
}

#[test]
fn other_seeds_and_sizes_are_sound_too() {
    let jobs: Vec<(u64, usize, usize, usize)> = (0..synth::class_names().len())
        .flat_map(|class| [(7, 400), (8, 1500)].map(|(seed, vertices)| (seed, vertices, class, class + seed as usize)))
        .collect();
    jobs.par_iter().for_each(|&(seed, vertices, class, index)| {
        let options = Options { vertices, seed, ..Options::default() };
        let mesh = synth::generate(&options, class, index).unwrap();
        let name = format!("{} {index} of seed {seed}", synth::class_names()[class]);
        assert_sound(&mesh, &name, synth::genus(class).unwrap(), vertices);
    });
}

#[test]
fn a_model_depends_on_nothing_but_its_own_options() {
    let all = Options { vertices: 400, ..Options::default() };
    let cup = synth::parse_classes("cup").unwrap();
    let alone = Options { classes: cup.clone(), models: 1, vertices: 400, seed: 1 };
    let mesh = synth::generate(&all, cup[0], 3).unwrap();
    assert_eq!(synth::generate(&alone, cup[0], 3).unwrap(), mesh);
    assert_ne!(synth::generate(&Options { seed: 2, ..alone.clone() }, cup[0], 3).unwrap(), mesh);
    assert_ne!(synth::generate(&alone, cup[0], 4).unwrap(), mesh);

    // On one thread and on three: the same bytes.
    let options = Options { classes: synth::parse_classes("vase,bracket").unwrap(), models: 3, vertices: 400, seed: 5 };
    let written = [1, 3].map(|threads| {
        let folder = tempfile::tempdir().unwrap();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let count = pool.install(|| synth::write_all(folder.path(), &options, false, &Unwatched)).unwrap();
        assert_eq!(count, 6);
        tree(folder.path())
    });
    assert_eq!(written[0], written[1]);
    let names: Vec<_> = written[0].keys().map(|path| path.to_str().unwrap().replace('\\', "/")).collect();
    assert_eq!(
        names,
        [
            "train/bracket/bracket-01.obj",
            "train/bracket/bracket-02.obj",
            "train/bracket/bracket-03.obj",
            "train/vase/vase-01.obj",
            "train/vase/vase-02.obj",
            "train/vase/vase-03.obj"
        ]
    );
}

#[test]
fn the_pose_does_not_depend_on_the_number_of_vertices() {
    let volume = |vertices: usize| {
        let options = Options { vertices, ..Options::default() };
        volume6(&synth::generate(&options, 1, 0).unwrap())
    };
    let (coarse, fine) = (volume(800), volume(4000));
    assert!((coarse / fine - 1.0).abs() < 0.03, "{coarse} {fine}");
}

/// Counts models and cancels after some.
struct After {
    models: usize,
    heard: AtomicUsize,
}

impl Watch for After {
    fn cancelled(&self) -> bool {
        self.heard.load(Ordering::SeqCst) >= self.models
    }

    fn progress(&self, done: usize, total: usize) {
        assert!(done <= total);
        self.heard.store(done, Ordering::SeqCst);
    }
}

#[test]
fn files_are_kept_unless_they_may_be_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { classes: synth::parse_classes("cup").unwrap(), models: 2, vertices: 300, seed: 1 };
    let first = folder.path().join("train/cup/cup-01.obj");
    let second = folder.path().join("train/cup/cup-02.obj");
    fs::create_dir_all(second.parent().unwrap()).unwrap();
    fs::write(&second, "mine").unwrap();
    let refused = synth::write_all(folder.path(), &options, false, &Unwatched).unwrap_err();
    assert!(matches!(&refused, SynthError::Exists { path } if *path == second), "{refused}");
    assert!(!first.exists(), "nothing may be written when one file is in the way");
    assert_eq!(fs::read(&second).unwrap(), b"mine");

    let watch = After { models: usize::MAX, heard: AtomicUsize::new(0) };
    assert_eq!(synth::write_all(folder.path(), &options, true, &watch).unwrap(), 2);
    assert_eq!(watch.heard.load(Ordering::SeqCst), 2);
    assert_eq!(fs::read(&second).unwrap(), bytes(&synth::generate(&options, options.classes[0], 1).unwrap()));
}

#[test]
fn cancelling_leaves_whole_models() {
    let folder = tempfile::tempdir().unwrap();
    let options = Options { classes: synth::parse_classes("cup").unwrap(), models: 6, vertices: 300, seed: 1 };
    let watch = After { models: 1, heard: AtomicUsize::new(0) };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let stopped = pool.install(|| synth::write_all(folder.path(), &options, false, &watch)).unwrap_err();
    assert!(matches!(stopped, SynthError::Cancelled), "{stopped}");
    let written = tree(folder.path());
    assert_eq!(written.len(), 2, "the batch at hand is finished, no other is begun");
    assert!(written.values().all(|bytes| survey(&read(bytes, Format::Obj).unwrap()).closed_manifold()));
}

#[test]
fn wrong_options_are_named() {
    assert_eq!(synth::parse_classes("3").unwrap(), [0, 1, 2]);
    assert_eq!(synth::parse_classes("octopus, human,octopus").unwrap(), [2, 0]);
    let said = |text: &str| synth::parse_classes(text).unwrap_err().to_string();
    assert!(said("human,unicorn").starts_with("there is no class \"unicorn\" to generate; there are human, cup,"));
    assert_eq!(said("0"), format!("0 classes asked for; there are 1 to {}", synth::class_names().len()));
    let options = Options { vertices: 20, ..Options::default() };
    let refused = synth::generate(&options, 0, 0).unwrap_err().to_string();
    assert_eq!(refused, "20 vertices asked for; a model has 300 to 200000");
    assert!(matches!(synth::generate(&Options::default(), 99, 0), Err(SynthError::ClassCount { count: 100 })));
}

//! Small data sets for tests.

use std::{
    fmt::Write as _,
    fs,
    path::{Path, PathBuf},
};

/// A closed surface with few vertices whose shape turns with three numbers: an ellipsoid with dents or a torus.
pub fn off(kind: usize, size: f64, bend: f64, rings: usize) -> String {
    let torus = kind == 1;
    let (u_count, v_count) = (rings + 3, rings + 1);
    let mut points = Vec::new();
    for u in 0..u_count {
        let a = std::f64::consts::TAU * u as f64 / u_count as f64;
        for v in 0..v_count {
            if torus {
                let b = std::f64::consts::TAU * v as f64 / v_count as f64;
                let r = 1.0 + (0.3 + 0.1 * bend) * b.cos() + 0.05 * size * (2.0 * a).sin();
                points.push([r * a.cos(), r * a.sin(), (0.3 + 0.1 * bend) * b.sin() * size]);
            } else {
                let b = std::f64::consts::PI * (v + 1) as f64 / (v_count + 1) as f64;
                let r = 1.0 + 0.2 * bend * (3.0 * b).cos() * (2.0 * a).cos();
                points.push([r * b.sin() * a.cos(), size * r * b.sin() * a.sin(), (1.0 + kind as f64) * r * b.cos()]);
            }
        }
    }
    let at = |u: usize, v: usize| (u % u_count) * v_count + v % v_count;
    let mut faces = Vec::new();
    for u in 0..u_count {
        for v in 0..if torus { v_count } else { v_count - 1 } {
            faces.push([at(u, v), at(u, v + 1), at(u + 1, v)]);
            faces.push([at(u + 1, v), at(u, v + 1), at(u + 1, v + 1)]);
        }
    }
    if !torus {
        let (north, south) = (points.len(), points.len() + 1);
        points.push([0.0, 0.0, 1.0 + kind as f64]);
        points.push([0.0, 0.0, -1.0 - kind as f64]);
        for u in 0..u_count {
            faces.push([north, at(u, 0), at(u + 1, 0)]);
            faces.push([south, at(u + 1, v_count - 1), at(u, v_count - 1)]);
        }
    }
    let mut text = format!("OFF\n{} {} 0\n", points.len(), faces.len());
    for [x, y, z] in points {
        writeln!(text, "{x:.6} {y:.6} {z:.6}").unwrap();
    }
    for [a, b, c] in faces {
        writeln!(text, "3 {a} {b} {c}").unwrap();
    }
    text
}

/// Writes `classes` classes of `models` models each, and returns the files in the data set's order.
pub fn write_data(root: &Path, classes: usize, models: usize) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for class in 0..classes {
        let folder = root.join(format!("class{class}"));
        fs::create_dir_all(&folder).unwrap();
        for model in 0..models {
            let file = folder.join(format!("m{model}.off"));
            let turn = (class * models + model) as f64;
            fs::write(&file, off(class, 1.0 + 0.13 * model as f64, 0.4 * (turn * 1.7).sin(), 6)).unwrap();
            files.push(file);
        }
    }
    files
}

/// A temporary folder, in memory where the system has such a place: a store waits for the disk at every write, and
/// tests of other things than the disk make thousands of them.
pub fn scratch() -> tempfile::TempDir {
    tempfile::tempdir_in("/dev/shm").or_else(|_| tempfile::tempdir()).unwrap()
}

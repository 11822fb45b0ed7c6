//! Eigenvalues of SHREC 2007 meshes against SciPy's.

use std::{path::Path, process::Command};

use eigenselect::{
    mesh::{Format, read},
    spectrum::{Choice, solve},
    watch::Unwatched,
};

/// Made by `tests/reference/spectrum.py`: name, number of vertices, 500 eigenvalues of consistent finite elements.
const REFERENCE: &str = include_str!("reference/spectrum.txt");

/// Rounding of ARPACK and of the factors, in proportion to an eigenvalue or, where that is larger, to the shift of the
/// inverted problem (1/area).
const REFERENCE_ERROR: f64 = 2e-12;

#[test]
fn ten_meshes_agree_with_scipy_in_every_eigenvalue() {
    let archive = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../shared/shrec07/meshes.tar.xz"));
    if !archive.exists() {
        println!("skipped: there is no {}", archive.display());
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let names: Vec<&str> = REFERENCE.lines().map(|line| line.split(' ').next().unwrap()).collect();
    assert_eq!(names.len(), 10);
    let unpacked = Command::new("tar")
        .arg("-xJf")
        .arg(archive)
        .arg("-C")
        .arg(folder.path())
        .args(names.iter().map(|name| format!("shrec07/{name}.off")))
        .status()
        .unwrap();
    assert!(unpacked.success());
    for line in REFERENCE.lines() {
        let mut words = line.split(' ');
        let name = words.next().unwrap();
        let order: usize = words.next().unwrap().parse().unwrap();
        let expected: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
        assert_eq!(expected.len(), 500);
        let bytes = std::fs::read(folder.path().join(format!("shrec07/{name}.off"))).unwrap();
        let mesh = read(&bytes, Format::Off).unwrap().canonical();
        let spectrum = solve(&mesh, Choice::default(), 500, &[], &Unwatched).unwrap();
        assert_eq!((spectrum.order, spectrum.zeros), (order, 1));
        let (found, unit) = (spectrum.eigenvalues(), 1.0 / spectrum.measure);
        assert!(expected[0].abs() < 1e-9 && found[0] == 0.0);
        let mut worst = 0.0_f64;
        for (found, expected) in found[1..500].iter().zip(&expected[1..]) {
            worst = worst.max((found - expected).abs() / expected);
        }
        println!("{name}: {worst:.1e}");
        assert!(worst < 1e-9, "mesh {name}: {worst:e}");
        // Each lies within its own bound, but for what the reference itself may be off.
        for ((k, found), (expected, bound)) in (1..).zip(&found[..500]).zip(expected.iter().zip(spectrum.residuals())) {
            let apart = (found - expected).abs();
            let allowed = bound + REFERENCE_ERROR * expected.abs().max(unit);
            assert!(apart <= allowed, "mesh {name}, λ_{k}: {apart:e} apart, bound {bound:e}");
        }
        // The bounds are small, too. They are widest at λ_2 where that is far from the first shift in proportion to
        // itself, as of the elongated 101 with 0.006 of it: there they say 3000 times more than is seen.
        let shares: Vec<f64> =
            spectrum.residuals()[1..500].iter().zip(&found[1..500]).map(|(error, value)| error / value).collect();
        let widest = shares[1..].iter().fold(0.0_f64, |most, share| most.max(*share));
        println!("{name}: bounds up to {:.1e} and {widest:.1e}", shares[0]);
        assert!(shares[0] < 1e-8 && widest < 1e-9, "mesh {name}: {:e}, {widest:e}", shares[0]);
    }
}

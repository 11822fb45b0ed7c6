//! Operators on meshes of every kind, by their spectra: known ones where there are, else those of better meshes.

// Helpers of tests, which clippy does not know as tests.
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::f64::consts::PI;

use eigenselect::{
    laplacian::{Boundary, Choice, Mass, Operator, Triangulation, assemble},
    mesh::Mesh,
    spectrum::{Spectrum, SpectrumError, solve},
    watch::Unwatched,
};

#[path = "operators/shapes.rs"]
mod shapes;

use shapes::{cap, disk, icosphere, joined, moved, rectangle, soup};

const FEM: Choice = Choice::new(Operator::Fem, Mass::Consistent);
const DIRICHLET: Choice = FEM.with_boundary(Boundary::Dirichlet);

fn spectrum(mesh: &Mesh, choice: Choice, count: usize) -> Spectrum {
    solve(&mesh.canonical(), choice, count, &[], &Unwatched).unwrap()
}

fn values(mesh: &Mesh, choice: Choice, count: usize) -> Vec<f64> {
    let mut values = spectrum(mesh, choice, count).eigenvalues();
    values.truncate(count);
    values
}

/// The largest relative difference; zeros have to be zeros.
fn worst(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).fold(0.0, |worst, (found, expected)| {
        if *expected == 0.0 {
            assert_eq!(*found, 0.0);
            worst
        } else {
            worst.max((found - expected).abs() / expected)
        }
    })
}

/// Errors at widths h, h/2 and h/4 go down with their square.
fn assert_second_order(errors: [f64; 3]) {
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.3).contains(&order), "{errors:?}");
    }
}

/// π²(m²/4 + n²) over m, n from `first` on, ascending.
fn of_rectangle(first: u32, count: usize) -> Vec<f64> {
    let mut squares: Vec<f64> =
        (first..60).flat_map(|m| (first..60).map(move |n| f64::from(m * m) / 4.0 + f64::from(n * n))).collect();
    squares.sort_by(f64::total_cmp);
    squares[..count].iter().map(|square| square * PI * PI).collect()
}

#[test]
fn the_rectangle_has_both_its_spectra() {
    for (choice, expected) in [(FEM, of_rectangle(0, 40)), (DIRICHLET, of_rectangle(1, 40))] {
        assert_second_order([16, 32, 64].map(|n| worst(&values(&rectangle(2 * n, n), choice, 40), &expected)));
    }
    let found = spectrum(&rectangle(40, 20), DIRICHLET, 10);
    assert_eq!((found.order, found.zeros), (39 * 19, 0));
    assert!((found.measure - 2.0).abs() < 1e-12, "the boundary counts to the area: {}", found.measure);
    assert!(found.notes.iter().any(|note| note == "120 boundary vertices are held at zero"), "{:?}", found.notes);
}

/// Squares of zeros of Bessel functions, or of their derivatives, with multiplicities; the zeros as in Abramowitz and
/// Stegun, tables 9.5 and 9.6, with more digits.
fn of_disk(zeros: &[(f64, usize)]) -> Vec<f64> {
    zeros.iter().flat_map(|&(zero, times)| std::iter::repeat_n(zero * zero, times)).collect()
}

#[test]
fn the_disk_has_bessel_zeros() {
    let dirichlet = of_disk(&[
        (2.404_825_557_695_773, 1),
        (3.831_705_970_207_512, 2),
        (5.135_622_301_840_683, 2),
        (5.520_078_110_286_311, 1),
        (6.380_161_895_923_984, 2),
        (7.015_586_669_815_619, 2),
    ]);
    let neumann = of_disk(&[
        (0.0, 1),
        (1.841_183_781_340_659, 2),
        (3.054_236_928_227_14, 2),
        (3.831_705_970_207_512, 1),
        (4.201_188_941_210_528, 2),
        (5.317_553_126_083_994, 2),
        (5.331_442_773_525_033, 2),
    ]);
    for (choice, expected) in [(DIRICHLET, dirichlet), (FEM, neumann)] {
        assert_second_order([10, 20, 40].map(|n| worst(&values(&disk(n), choice, expected.len()), &expected)));
    }
}

#[test]
fn the_hemisphere_has_half_of_the_spheres_spectrum() {
    // Of the 2l + 1 functions of degree l, l + 1 are even across the equator and l odd.
    let neumann: Vec<f64> = (0..7_u32).flat_map(|l| vec![f64::from(l * (l + 1)); l as usize + 1]).collect();
    let dirichlet: Vec<f64> = (1..8_u32).flat_map(|l| vec![f64::from(l * (l + 1)); l as usize]).collect();
    for (choice, expected) in [(FEM, neumann), (DIRICHLET, dirichlet)] {
        for mass in [Mass::Consistent, Mass::Lumped] {
            let choice = Choice { mass, ..choice };
            let errors = [10, 20, 40].map(|n| worst(&values(&cap(n, PI / 2.0), choice, expected.len()), &expected));
            assert_second_order(errors);
        }
    }
}

#[test]
fn a_dirichlet_condition_holds_the_parts_that_have_a_boundary() {
    // A closed sphere, and a disk whose inner vertices fall into two parts: two disks that touch in one edge's ends.
    let (sphere, sheet) = (icosphere(2), disk(6));
    let both = joined(&[sphere.clone(), moved(&sheet, |[x, y, z]| [x + 5.0, y, z])]);
    let found = spectrum(&both, DIRICHLET, 40);
    assert_eq!(found.zeros, 1);
    let mut expected = [values(&sphere, FEM, 40), values(&sheet, DIRICHLET, 40)].concat();
    expected.sort_by(f64::total_cmp);
    assert!(worst(&found.eigenvalues()[..40], &expected[..40]) < 1e-11);
    // A closed surface has no boundary: nothing changes.
    let closed = spectrum(&sphere, DIRICHLET, 40);
    assert_eq!(closed.eigenvalues(), spectrum(&sphere, FEM, 40).eigenvalues());
    assert!(closed.notes[0].contains("no boundary"));
    // One triangle is all boundary.
    let triangle = Mesh::new(sphere.vertices()[..3].to_vec(), vec![[0, 1, 2]]);
    match solve(&triangle, DIRICHLET, 3, &[], &Unwatched) {
        Err(SpectrumError::Refused(reason)) => assert!(reason.contains("every vertex is on the boundary")),
        other => panic!("{other:?}"),
    }
    // One inner vertex: one eigenvalue, L_ii/B_ii.
    let fan = disk(1);
    let laplacian = assemble(&fan, DIRICHLET).unwrap();
    let [entry] = laplacian.matrix.entries().collect::<Vec<_>>()[..] else { panic!("one row was expected") };
    let only = spectrum(&fan, DIRICHLET, 1).eigenvalues();
    assert_eq!(only.len(), 1);
    assert!((only[0] - entry.2 / entry.3 * laplacian.unit()).abs() < 1e-12 * only[0]);
}

const ALL: [Triangulation; 3] = [Triangulation::Given, Triangulation::Delaunay, Triangulation::Tufted];

#[test]
fn all_triangulations_are_one_on_a_delaunay_mesh() {
    // No angle of these is obtuse.
    for mesh in [icosphere(3), rectangle(24, 12), cap(12, 1.0)] {
        let expected = assemble(&mesh, FEM).unwrap();
        for triangulation in ALL {
            for mass in Mass::ALL {
                let choice = Choice { mass, ..FEM };
                let expected = assemble(&mesh, choice).unwrap();
                let found = assemble(&mesh, choice.with_triangulation(triangulation)).unwrap();
                let largest = expected.matrix.entries().map(|entry| entry.2.abs()).fold(0.0, f64::max);
                let heaviest = expected.matrix.entries().map(|entry| entry.3).fold(0.0, f64::max);
                for (a, b) in found.matrix.entries().zip(expected.matrix.entries()) {
                    assert_eq!((a.0, a.1), (b.0, b.1));
                    assert!((a.2 - b.2).abs() < 1e-13 * largest, "{triangulation:?} {a:?} {b:?}");
                    assert!((a.3 - b.3).abs() < 1e-13 * heaviest, "{triangulation:?} {a:?} {b:?}");
                }
            }
        }
        // The automatic choice is the given triangles, bit for bit.
        assert_eq!(assemble(&mesh, FEM.with_triangulation(Triangulation::Given)).unwrap(), expected);
    }
}

#[test]
fn bad_triangles_are_mended_by_flips() {
    // Squeezed to a sixth, a rectangle's right triangles become flat ones with angles near π; sheared as well, no edge
    // is good. The shape is a parallelogram folded out of the same points, so a good mesh of it is a fine reference.
    let shear = |[x, y, z]: [f64; 3]| [x + 3.0 * y, y, z];
    let coarse = moved(&rectangle(48, 24), shear);
    let fine = values(&moved(&rectangle(192, 96), shear), FEM.with_triangulation(Triangulation::Delaunay), 40);
    let error = |choice: Choice| worst(&values(&coarse, choice, 40), &fine);
    let given = error(FEM.with_triangulation(Triangulation::Given));
    let delaunay = error(FEM.with_triangulation(Triangulation::Delaunay));
    let tufted = error(FEM.with_triangulation(Triangulation::Tufted));
    println!("given {given:.4}, Delaunay {delaunay:.4}, tufted {tufted:.4}");
    assert!(delaunay < 0.25 * given && tufted < 0.25 * given, "{given} {delaunay} {tufted}");
}

#[test]
fn caps_without_area_do_not_matter() {
    // Each edge of every third triangle gets a vertex at its middle in that triangle alone: a face without area.
    let good = icosphere(3);
    let (mut points, mut triangles) = (good.vertices().to_vec(), Vec::new());
    for (at, &[a, b, c]) in good.triangles().iter().enumerate() {
        if at % 3 == 0 {
            let m = points.len() as u32;
            let (p, q) = (points[a as usize], points[b as usize]);
            points.push([0, 1, 2].map(|axis| f64::midpoint(p[axis], q[axis])));
            triangles.extend([[a, m, c], [m, b, c], [a, b, m]]);
        } else {
            triangles.push([a, b, c]);
        }
    }
    let bad = Mesh::new(points, triangles);
    let expected = values(&good, FEM, 30);
    for triangulation in ALL {
        let found = spectrum(&bad, FEM.with_triangulation(triangulation), 30);
        assert!(found.notes.iter().any(|note| note.contains("area")), "{:?}", found.notes);
        let error = worst(&found.eigenvalues()[..30], &expected);
        println!("{triangulation:?}: {error:.1e}");
        assert!(error < 0.02, "{triangulation:?}: {error}");
    }
}

#[test]
fn a_sphere_with_a_membrane_is_the_same_whatever_its_faces_orientations() {
    // Non-manifold along the equator: a disk inside of a sphere, and every second face turned.
    let rim = 24;
    let dome = moved(&cap(4, PI / 2.0), |[x, y, z]| [x, y, if z < 1e-12 { 0.0 } else { z }]);
    let shell = joined(&[dome.clone(), moved(&dome, |[x, y, z]| [x, y, -z]), moved(&dome, |[x, y, _]| [x, y, 0.0])]);
    let turned = Mesh::new(
        shell.vertices().to_vec(),
        shell
            .triangles()
            .iter()
            .enumerate()
            .map(|(at, &[a, b, c])| if at % 2 == 0 { [a, b, c] } else { [b, a, c] })
            .collect(),
    );
    for triangulation in ALL {
        let choice = FEM.with_triangulation(triangulation);
        let (straight, other) = (spectrum(&shell, choice, 40), spectrum(&turned, choice, 40));
        assert!(worst(&other.eigenvalues()[..40], &straight.eigenvalues()[..40]) < 1e-10);
        // Only tufted joins what lies at one position.
        let pieces = if triangulation == Triangulation::Tufted { 1 } else { 3 };
        assert_eq!((straight.zeros, straight.order), (pieces, 3 * 61 - 2 * rim * usize::from(pieces == 1)));
    }
}

#[test]
fn a_soup_is_the_mesh_it_was_made_of() {
    let mesh = moved(&icosphere(3), |[x, y, z]| [x, 0.7 * y + 0.1 * x * x, z]);
    let soup = soup(&mesh);
    let (whole, loose) = (spectrum(&mesh, FEM, 50), spectrum(&soup, FEM, 50));
    assert_eq!(loose.zeros, 1);
    assert!(loose.notes[0].contains("soup"), "{:?}", loose.notes);
    assert!(worst(&loose.eigenvalues()[..50], &whole.eigenvalues()[..50]) < 1e-11);
    let given = spectrum(&soup, FEM.with_triangulation(Triangulation::Given), 50);
    assert_eq!(given.zeros, mesh.triangles().len());
    let tufted = spectrum(&soup, FEM.with_triangulation(Triangulation::Tufted), 50);
    assert!(worst(&tufted.eigenvalues()[..50], &whole.eigenvalues()[..50]) < 1e-2);
}

#[test]
fn blended_mass_is_the_mean_and_far_more_accurate_on_good_triangles() {
    let expected: Vec<f64> = (0..10_u32).flat_map(|l| vec![f64::from(l * (l + 1)); 2 * l as usize + 1]).collect();
    let error = |levels: usize, mass: Mass| {
        let found = values(&icosphere(levels), Choice::new(Operator::Fem, mass), 100);
        worst(&found, &expected)
    };
    for levels in [3, 4, 5] {
        let [consistent, lumped, blended] = Mass::ALL.map(|mass| error(levels, mass));
        println!("levels {levels}: consistent {consistent:.1e}, lumped {lumped:.1e}, blended {blended:.1e}");
        assert!(blended < 0.2 * consistent.min(lumped));
    }
    let mesh = icosphere(2);
    let [consistent, lumped, blended] =
        Mass::ALL.map(|mass| assemble(&mesh, Choice::new(Operator::Fem, mass)).unwrap());
    for ((a, b), c) in consistent.matrix.entries().zip(lumped.matrix.entries()).zip(blended.matrix.entries()) {
        assert!((0.5 * (a.3 + b.3) - c.3).abs() < 1e-16);
    }
}

fn of_sphere(count: usize) -> Vec<f64> {
    (0..).flat_map(|l: u32| vec![f64::from(l * (l + 1)); 2 * l as usize + 1]).take(count).collect()
}

/// Points of the unit sphere that are no mesh's: on a spiral, or at random.
fn points(count: usize, random: bool) -> Mesh {
    let mut state = 5_u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let place = |at: usize| {
        let (height, turn) = if random {
            (2.0 * next() - 1.0, next())
        } else {
            (1.0 - (2 * at + 1) as f64 / count as f64, at as f64 * 0.5 * (5_f64.sqrt() - 1.0))
        };
        let ((sine, cosine), radius) = ((2.0 * PI * turn).sin_cos(), (1.0 - height * height).sqrt());
        [radius * cosine, radius * sine, height]
    };
    Mesh::new((0..count).map(place).collect(), Vec::new())
}

#[test]
fn points_of_a_sphere_have_its_spectrum() {
    let expected = of_sphere(49);
    // The vertices of a good mesh give that mesh.
    let mesh = icosphere(4);
    let cloud = Mesh::new(mesh.vertices().to_vec(), Vec::new());
    let found = spectrum(&cloud, FEM, 49);
    assert!(found.notes[0].contains("point cloud"), "{:?}", found.notes);
    assert!(worst(&found.eigenvalues()[..49], &values(&mesh, FEM, 49)) < 1e-10);
    for (random, tolerance) in [(false, 0.02), (true, 0.05)] {
        let errors = [1000, 4000].map(|count| worst(&values(&points(count, random), FEM, 49), &expected));
        println!("random {random}: {errors:?}");
        assert!(errors[1] < tolerance && errors[1] < 0.6 * errors[0], "random {random}: {errors:?}");
    }
}

#[test]
fn a_grid_of_points_covers_its_rectangle_once() {
    // Every four of them lie on a circle. The rim of local triangulations reaches no further than the points.
    let cloud = Mesh::new(rectangle(40, 20).vertices().to_vec(), Vec::new());
    let found = spectrum(&cloud, FEM, 20);
    assert!((found.measure - 2.0).abs() < 0.01, "{}", found.measure);
    let error = worst(&found.eigenvalues()[..20], &of_rectangle(0, 20));
    assert!(error < 0.05, "{error}");
}

#[test]
fn what_points_cannot_have_is_said() {
    let refused = |mesh: &Mesh, choice: Choice| match solve(mesh, choice, 5, &[], &Unwatched) {
        Err(SpectrumError::Refused(reason)) => reason,
        other => panic!("{other:?}"),
    };
    let cloud = points(100, true);
    for triangulation in [Triangulation::Given, Triangulation::Delaunay] {
        assert!(refused(&cloud, FEM.with_triangulation(triangulation)).contains("only 100 vertices"));
    }
    assert!(refused(&cloud, DIRICHLET).contains("no boundary for a Dirichlet condition"));
    let line = Mesh::new((0..50).map(|at| [f64::from(at), 2.0 * f64::from(at), 0.0]).collect(), Vec::new());
    assert!(refused(&line, FEM).contains("no triangles can be made of the 50 vertices"));
    let spot = Mesh::new(vec![[1.0, 2.0, 3.0]; 50], Vec::new());
    assert!(refused(&spot, FEM).contains("no triangles can be made of the 50 vertices"));
}

#[test]
fn scale_and_flatness_do_not_matter() {
    let mesh = moved(&icosphere(3), |[x, y, z]| [x, 0.8 * y + 0.1 * x * z, z]);
    for triangulation in ALL {
        for mass in Mass::ALL {
            let choice = Choice { mass, ..FEM }.with_triangulation(triangulation);
            let scaled = |mesh: &Mesh| {
                let found = spectrum(mesh, choice, 40);
                found.eigenvalues()[..40].iter().map(|value| value * found.measure).collect::<Vec<f64>>()
            };
            let expected = scaled(&mesh);
            for factor in [1e-100, 1e-9, 3.7, 1e12, 1e100] {
                let error = worst(&scaled(&moved(&mesh, |point| point.map(|x| factor * x))), &expected);
                assert!(error < 1e-10, "{triangulation:?} {mass:?} {factor:e}: {error:e}");
            }
        }
    }
    // Two unit disks on one another, sewn along their rims: functions that are even across come from the Neumann
    // spectrum of the disk, odd ones from the Dirichlet spectrum. The same with a height that nearly vanishes.
    let pillow = |height: f64| {
        let disk = disk(12);
        let lens = |[x, y, _]: [f64; 3], side: f64| [x, y, side * height * (1.0 - x * x - y * y).max(0.0)];
        let rim = disk.vertices().len() - 72;
        let mut points: Vec<[f64; 3]> = disk.vertices().iter().map(|&point| lens(point, 1.0)).collect();
        points.extend(disk.vertices()[..rim].iter().map(|&point| lens(point, -1.0)));
        let below = |vertex: u32| if (vertex as usize) < rim { vertex + (rim + 72) as u32 } else { vertex };
        let under = disk.triangles().iter().map(|&[a, b, c]| [below(a), below(c), below(b)]);
        Mesh::new(points, disk.triangles().iter().copied().chain(under).collect())
    };
    let mut expected = [values(&disk(12), FEM, 30), values(&disk(12), DIRICHLET, 30)].concat();
    expected.sort_by(f64::total_cmp);
    for triangulation in ALL {
        // Without height the tufted cover joins both disks: they are at one place.
        let heights: &[f64] = if triangulation == Triangulation::Tufted { &[1e-14, 1e-9] } else { &[0.0, 1e-14, 1e-9] };
        for &height in heights {
            let found = values(&pillow(height), FEM.with_triangulation(triangulation), 30);
            let error = worst(&found, &expected[..30]);
            assert!(error < 1e-9, "{triangulation:?} {height:e}: {error:e}");
        }
    }
}

/// A million vertices take minutes: `cargo test --release --test operators -- --ignored`.
#[test]
#[ignore = "takes minutes and gigabytes"]
fn a_million_vertices() {
    let mesh = rectangle(1414, 707);
    for triangulation in ALL {
        let start = std::time::Instant::now();
        let found = spectrum(&mesh, FEM.with_triangulation(triangulation), 20);
        println!("{triangulation:?}: {} vertices in {:?}", found.order, start.elapsed());
        assert!(found.order > 1_000_000);
        assert!(worst(&found.eigenvalues()[..20], &of_rectangle(0, 20)) < 1e-4);
    }
}

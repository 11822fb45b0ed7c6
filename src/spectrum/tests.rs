//! The solver as a whole, on shapes whose spectra are known.

use super::{shapes, *};
use crate::{
    laplacian::{Mass, Operator, assemble},
    watch::{Patience, Pulse, Unwatched},
};

pub(super) const FEM: Choice = Choice::new(Operator::Fem, Mass::Consistent);
const LUMPED: Choice = Choice::new(Operator::Fem, Mass::Lumped);
const COT: Choice = Choice::new(Operator::Cot, Mass::Consistent);

fn values(mesh: &Mesh, choice: Choice, count: usize) -> Vec<f64> {
    let spectrum = solve(mesh, choice, count, &[], &Unwatched).unwrap();
    assert!(spectrum.count() >= count.min(spectrum.order));
    let mut values = spectrum.eigenvalues();
    values.truncate(count);
    values
}

pub(super) fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

fn moved(mesh: &Mesh, place: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    Mesh::new(mesh.vertices().iter().map(|&point| place(point)).collect(), mesh.triangles().to_vec())
}

/// A shape without any symmetry.
pub(super) fn potato(levels: usize) -> Mesh {
    moved(&shapes::icosphere(levels), |[x, y, z]| {
        let radius = 1.0 + 0.3 * (2.3 * x + 0.4).sin() * (1.7 * y - z).cos() + 0.1 * (5.0 * z + x).sin();
        [radius * x, 0.8 * radius * y, 1.3 * radius * z]
    })
}

fn worst(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    found.iter().zip(expected).fold(0.0, |worst, (a, b)| f64::max(worst, (a - b).abs() / b.abs().max(expected[1])))
}

#[test]
fn the_sphere_has_its_multiplicities_and_converges_with_the_square_of_the_edges() {
    let expected: Vec<f64> = (0..9_usize).flat_map(|l| vec![(l * (l + 1)) as f64; 2 * l + 1]).collect();
    for choice in [FEM, LUMPED] {
        let errors: Vec<f64> =
            (3..=5).map(|levels| worst(&values(&shapes::icosphere(levels), choice, 81), &expected)).collect();
        for pair in errors.windows(2) {
            let order = (pair[0] / pair[1]).log2();
            assert!((1.8..2.2).contains(&order), "{errors:?}");
        }
        assert!(errors[2] < 0.02, "{errors:?}");
    }
}

#[test]
fn two_spheres_that_touch_in_a_vertex_have_eigenvalues_between_those_of_two_that_do_not() {
    let ball = shapes::icosphere(3);
    let (points, faces) = (ball.vertices(), ball.triangles());
    // The second sphere is the first one turned about the vertex 0, so that they have it in common.
    let [x, y, z] = points[0];
    let other = points.iter().map(|[a, b, c]| [2.0 * x - a, 2.0 * y - b, 2.0 * z - c]);
    let count = points.len() as u32;
    let shifted =
        |face: &[u32; 3], joined: bool| face.map(|corner| if joined && corner == 0 { 0 } else { corner + count });
    let both = |joined: bool| {
        let second = faces.iter().map(|face| shifted(face, joined));
        Mesh::new(points.iter().copied().chain(other.clone()).collect(), faces.iter().copied().chain(second).collect())
    };
    for choice in [FEM, LUMPED] {
        let (apart, touching) = (values(&both(false), choice, 301), values(&both(true), choice, 300));
        let slack = 1e-10 * apart[300];
        assert!(touching[0].abs() < slack && touching[1] > slack, "it is one piece: {:?}", &touching[..3]);
        // One vertex in common is one linear condition: Cauchy's interlacing.
        for (index, value) in touching.iter().enumerate() {
            let (low, high) = (apart[index] - slack, apart[index + 1] + slack);
            assert!((low..=high).contains(value), "{index}: {low} {value} {high}");
        }
    }
}

#[test]
fn eigenvalues_that_a_perturbation_has_parted_by_a_billionth_are_all_found() {
    let ball = shapes::icosphere(4);
    let nearly = moved(&ball, |[x, y, z]| [x * (1.0 + 1e-9), y, z * (1.0 - 1e-9 * x)]);
    for choice in [FEM, LUMPED] {
        let (even, parted) = (values(&ball, choice, 300), values(&nearly, choice, 300));
        assert_ne!(bits(&even), bits(&parted));
        let apart = worst(&parted, &even);
        assert!(apart < 1e-8, "{apart:e}");
    }
}

#[test]
fn a_rectangle_has_the_neumann_spectrum() {
    let pi = std::f64::consts::PI;
    let mut expected: Vec<f64> =
        (0..40).flat_map(|i| (0..40).map(move |j| f64::from(i * i) / 4.0 + f64::from(j * j))).collect();
    expected.sort_by(f64::total_cmp);
    let expected: Vec<f64> = expected[..60].iter().map(|square| square * pi * pi).collect();
    let errors: Vec<f64> =
        [16, 32, 64].iter().map(|&b| worst(&values(&shapes::rectangle(2 * b, b), FEM, 60), &expected)).collect();
    for pair in errors.windows(2) {
        assert!((1.8..2.2).contains(&(pair[0] / pair[1]).log2()), "{errors:?}");
    }
}

#[test]
fn a_prism_has_the_spectrum_of_the_flat_cylinder() {
    let (sides, rows) = (96, 32);
    let pi = std::f64::consts::PI;
    let mesh = shapes::prism(sides, rows);
    // Circumference 3, height 1: periodic one way, Neumann the other.
    let mut expected: Vec<f64> = (-40..=40)
        .flat_map(|i| (0..40).map(move |j| f64::from(4 * i * i) / 9.0 + f64::from(j * j)))
        .map(|square| square * pi * pi)
        .collect();
    expected.sort_by(f64::total_cmp);
    let found = values(&mesh, FEM, 40);
    assert!(worst(&found, &expected[..40]) < 0.02);
    // Waves around it come in pairs, as the mesh has the symmetry too.
    assert!((found[1] - found[2]).abs() < 1e-10 * found[1]);
}

#[test]
fn scaling_moving_and_renumbering_change_nothing() {
    let mesh = potato(4);
    let reference = solve(&mesh, FEM, 120, &[], &Unwatched).unwrap();
    let expected: Vec<f64> = reference.eigenvalues()[..120].iter().map(|value| value * reference.measure).collect();
    let check = |mesh: &Mesh| {
        let found = solve(mesh, FEM, 120, &[], &Unwatched).unwrap();
        let scaled: Vec<f64> = found.eigenvalues()[..120].iter().map(|value| value * found.measure).collect();
        assert!(worst(&scaled, &expected) < 1e-10, "{:e}", worst(&scaled, &expected));
    };
    for factor in [1e-100, 0.37, 1e5, 1e100] {
        check(&moved(&mesh, |point| point.map(|x| factor * x)));
    }
    let (sine, cosine) = 0.7_f64.sin_cos();
    check(&moved(&mesh, |[x, y, z]| [cosine * x - z * sine + 4.0, z * cosine + x * sine, y - 7.0]));
    let n = mesh.vertices().len() as u32;
    let shuffle = |vertex: u32| (vertex * 701 + 13) % n;
    let mut points = vec![[0.0; 3]; n as usize];
    for (at, &point) in mesh.vertices().iter().enumerate() {
        points[shuffle(at as u32) as usize] = point;
    }
    let turned = mesh.triangles().iter().rev().map(|&[a, b, c]| [b, a, c].map(shuffle)).collect();
    check(&Mesh::new(points, turned));
}

#[test]
fn more_eigenvalues_are_the_same_ones_and_further_ones() {
    let mesh = potato(4);
    for choice in [FEM, LUMPED, COT] {
        let direct = solve(&mesh, choice, 400, &[], &Unwatched).unwrap();
        let short = solve(&mesh, choice, 90, &[], &Unwatched).unwrap();
        assert!(short.count() >= 90 && short.count() < 200);
        let longer = solve(&mesh, choice, 400, &short.bands, &Unwatched).unwrap();
        assert!(longer == direct);
        assert_eq!(bits(&longer.eigenvalues()), bits(&direct.eigenvalues()));
        assert_eq!(bits(&direct.eigenvalues()[..short.count()]), bits(&short.eigenvalues()));
        let mut early = 0;
        for count in [23, 47, 71, 95, 110] {
            let short = solve(&mesh, choice, count, &[], &Unwatched).unwrap();
            assert!(short.count() >= count);
            assert_eq!(bits(&direct.eigenvalues()[..short.count()]), bits(&short.eigenvalues()));
            if short.bands.last().is_some_and(|last| last.early) {
                early += 1;
                // The last band took no process of its own.
                assert_eq!(short.timings.processes, short.bands.len() - 1);
                assert!(solve(&mesh, choice, count + 200, &short.bands, &Unwatched).unwrap().count() >= count + 200);
                assert!(solve(&mesh, choice, 400, &short.bands, &Unwatched).unwrap() == direct);
                assert!(solve(&mesh, choice, count, &short.bands[..1], &Unwatched).unwrap() == short);
            }
        }
        assert!(early > 1, "{early}");
        // Known bands are taken over, not solved again, and those that do not follow each other are not used.
        let torn = [&direct.bands[1..], &direct.bands[..1]].concat();
        assert!(solve(&mesh, choice, 400, &torn, &Unwatched).unwrap() == direct);
        assert!(solve(&mesh, choice, 400, &direct.bands[1..], &Unwatched).unwrap() == direct);
        let mut damaged = direct.bands.clone();
        damaged[2].values.pop();
        assert!(solve(&mesh, choice, 400, &damaged, &Unwatched).unwrap() == direct);
    }
}

#[test]
fn what_a_cancelled_run_has_finished_is_kept_and_nothing_else_changes() {
    let mesh = potato(4);
    let direct = solve(&mesh, FEM, 300, &[], &Unwatched).unwrap();
    let mut kept: Vec<Band> = Vec::new();
    let mut cancelled = 0;
    let mut patience = 3;
    loop {
        let watch = Patience::of(patience);
        match solve(&mesh, FEM, 300, &kept, &watch) {
            Ok(spectrum) => {
                assert!(spectrum == direct);
                break;
            }
            Err(SpectrumError::Cancelled { finished }) => {
                assert!(finished.len() >= kept.len());
                assert!(finished == direct.bands[..finished.len()]);
                kept = finished;
                cancelled += 1;
                patience += 2;
            }
            Err(other) => panic!("{other}"),
        }
    }
    assert!(cancelled > 5 && kept.len() > 2, "{cancelled} {}", kept.len());
}

#[test]
fn small_meshes_give_what_there_is() {
    let tetrahedron = Mesh::new(
        vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
    );
    for choice in [FEM, LUMPED, COT] {
        let spectrum = solve(&tetrahedron, choice, 500, &[], &Unwatched).unwrap();
        assert_eq!((spectrum.count(), spectrum.order, spectrum.zeros), (4, 4, 1));
        assert_eq!(spectrum.eigenvalues()[0], 0.0);
        assert!(spectrum.eigenvalues()[1] > 0.0);
    }
    let triangle = Mesh::new(tetrahedron.vertices()[..3].to_vec(), vec![[0, 1, 2]]);
    assert_eq!(solve(&triangle, FEM, 9, &[], &Unwatched).unwrap().count(), 3);
    // The whole spectrum of a mesh for the sparse solver: its sum is the trace.
    let mesh = potato(2);
    let laplacian = assemble(&mesh, LUMPED).unwrap();
    let trace: f64 = laplacian.matrix.entries().filter(|entry| entry.0 == entry.1).map(|entry| entry.2 / entry.3).sum();
    let all = solve(&mesh, LUMPED, usize::MAX, &[], &Unwatched).unwrap();
    assert_eq!(all.count(), all.order);
    let sum: f64 = all.eigenvalues().iter().sum();
    assert!((sum - trace * laplacian.unit()).abs() < 1e-9 * sum, "{sum} {trace}");
}

#[test]
fn dense_and_sparse_agree() {
    // 162 vertices go to the sparse solver; as half of a larger mesh's matrices they go to the dense one.
    let mesh = potato(2);
    let laplacian = assemble(&mesh, FEM).unwrap();
    let dense = dense::dense(&laplacian.matrix).unwrap();
    let sparse = values(&mesh, FEM, usize::MAX);
    for (dense, sparse) in dense.iter().zip(&sparse) {
        let dense = dense.value * laplacian.unit();
        assert!((dense - sparse).abs() < 1e-10 * sparse.max(1e-3), "{dense} {sparse}");
    }
}

#[test]
fn pieces_are_merged() {
    let (large, small) = (potato(3), shapes::icosphere(1));
    let copies = 12;
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for copy in 0..copies {
        for part in [&large, &small] {
            let first = points.len() as u32;
            points.extend(part.vertices().iter().map(|&[x, y, z]| [x + 5.0 * f64::from(copy), y, z]));
            triangles.extend(part.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
        }
    }
    let mut expected: Vec<f64> = [values(&large, FEM, 80), values(&small, FEM, 42)]
        .iter()
        .flat_map(|values| values.iter().copied())
        .flat_map(|value| std::iter::repeat_n(value, copies as usize))
        .collect();
    expected.sort_by(f64::total_cmp);
    let mesh = Mesh::new(points, triangles);
    let spectrum = solve(&mesh, FEM, 500, &[], &Unwatched).unwrap();
    assert_eq!(spectrum.zeros, 24);
    assert!(spectrum.notes.iter().any(|note| note.contains("24 connected components")), "{:?}", spectrum.notes);
    let found = spectrum.eigenvalues();
    assert!(found[..24].iter().all(|&value| value == 0.0) && found[24] > 0.0);
    for (found, expected) in found.iter().zip(&expected[..500]) {
        assert!((found - expected).abs() < 1e-10 * expected.max(1.0), "{found} {expected}");
    }
    let short = solve(&mesh, FEM, 40, &[], &Unwatched).unwrap();
    let longer = solve(&mesh, FEM, 500, &short.bands, &Unwatched).unwrap();
    assert!(longer == spectrum);
}

#[test]
fn bad_meshes_are_refused_by_name() {
    let refused = |points: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>| match solve(
        &Mesh::new(points, triangles),
        FEM,
        5,
        &[],
        &Unwatched,
    ) {
        Err(SpectrumError::Refused(text)) => text,
        other => panic!("{other:?}"),
    };
    let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(refused(points[..2].to_vec(), vec![]).contains("no triangle"));
    assert!(refused(points.clone(), vec![[0, 1, 1]]).contains("no triangle"));
    assert!(refused(points.clone(), vec![[0, 1, 2], [0, 1, 9]]).contains("triangle 1 names vertex 9"));
    let broken = vec![[0.0; 3], [f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]];
    assert!(refused(broken, vec![[0, 1, 2]]).contains("vertex 1"));
    assert!(refused(vec![[1.0; 3]; 3], vec![[0, 1, 2]]).contains("extends"));
    assert!(refused(points.iter().map(|p| p.map(|x| 1e300 * x)).collect(), vec![[0, 1, 2]]).contains("extends"));
}

#[test]
fn a_piece_that_is_held_has_no_zero() {
    // Vertices of the rectangle's boundary removed: zero on the boundary (Dirichlet). λ = π² (i²/4 + j²), i, j ≥ 1.
    let square = std::f64::consts::PI.powi(2);
    let mut expected: Vec<f64> =
        (1..40).flat_map(|i| (1..40).map(move |j| square * (f64::from(i * i) / 4.0 + f64::from(j * j)))).collect();
    expected.sort_by(f64::total_cmp);
    let held = |b: usize| {
        let mut laplacian = assemble(&shapes::rectangle(2 * b, b), Choice::default()).unwrap();
        let inside = |row: &u32| {
            let (x, y) = (*row as usize % (2 * b + 1), *row as usize / (2 * b + 1));
            x > 0 && x < 2 * b && y > 0 && y < b
        };
        let rows: Vec<u32> = (0..laplacian.matrix.order() as u32).filter(inside).collect();
        laplacian.matrix = laplacian.matrix.select(&rows, &Pulse::new(&Unwatched)).unwrap();
        laplacian.vertices = rows;
        laplacian.component.truncate(laplacian.matrix.order());
        laplacian
    };
    // The coarsest ones go to the dense solver.
    for (b, tolerance) in [(8, 0.3), (32, 0.02), (64, 0.005)] {
        let spectrum = solve_laplacian(&held(b), 20, &[], &Unwatched).unwrap();
        assert_eq!(spectrum.zeros, 0);
        assert!(worst(&spectrum.eigenvalues()[..20], &expected[..20]) < tolerance);
        assert!(spectrum.bands.iter().all(|band| band.zeros == 0));
    }
}

#[test]
fn eigenvectors_are_orthonormal_and_their_residuals_true() {
    let (potato, sphere, tetrahedron) = (potato(4), shapes::icosphere(3), shapes::icosphere(0));
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for (copy, part) in [&potato, &tetrahedron, &sphere].into_iter().enumerate() {
        let first = points.len() as u32;
        points.extend(part.vertices().iter().map(|&[x, y, z]| [3.0 * x + 20.0 * copy as f64, 3.0 * y, 3.0 * z]));
        triangles.extend(part.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    points.push([0.0; 3]);
    let mesh = Mesh::new(points, triangles);
    for choice in [FEM, LUMPED, COT] {
        let spectrum = solve(&mesh, choice, 120, &[], &Unwatched).unwrap();
        let wanted: Vec<usize> = (0..60).rev().chain(100..120).collect();
        let vectors = eigenvectors(&mesh, choice, &spectrum, &wanted, &Unwatched).unwrap();
        let laplacian = assemble(&mesh, choice).unwrap();
        let scale = if choice.operator == Operator::Cot { 1.0 } else { laplacian.unit() };
        let product = |x: &[f64], which: usize| {
            let mut product = vec![0.0; mesh.vertices().len()];
            for (row, column, l, b) in laplacian.matrix.entries() {
                let value = if which == 0 { l } else { b / scale };
                let (row, column) = (laplacian.vertices[row] as usize, laplacian.vertices[column] as usize);
                product[row] += value * x[column];
                if row != column {
                    product[column] += value * x[row];
                }
            }
            product
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let values = spectrum.eigenvalues();
        for (vector, &index) in vectors.iter().zip(&wanted) {
            assert_eq!((vector.index, vector.values.len()), (index, mesh.vertices().len()));
            assert_eq!(vector.values.last(), Some(&0.0));
            let off = (vector.value - values[index]).abs();
            assert!(
                off <= spectrum.residuals()[index] + vector.residual.min(1e-14 * vector.value),
                "{index}: {off:e} {:e}",
                vector.residual
            );
            assert!(vector.residual < 1e-9 * values[3].max(values[index]), "{index}: {:e}", vector.residual);
            let (lx, bx) = (product(&vector.values, 0), product(&vector.values, 1));
            let size = dot(&lx, &lx).sqrt();
            let left: f64 = lx.iter().zip(&bx).map(|(l, b)| (l - vector.value * b).powi(2)).sum::<f64>().sqrt();
            assert!(left <= 1e-9 * size.max(1e-3), "{index}: {left:e} {size:e}");
            let largest = vector.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            assert!(vector.values.iter().any(|&value| value > 0.999_999 * largest));
            for other in &vectors {
                let unit = f64::from(u8::from(other.index == index));
                assert!((dot(&bx, &other.values) - unit).abs() < 1e-8, "{index} {}", other.index);
            }
        }
        let alone = eigenvectors(&mesh, choice, &spectrum, &[17], &Unwatched).unwrap();
        assert_eq!(Some(&alone[0]), vectors.iter().find(|vector| vector.index == 17));
        let beyond = eigenvectors(&mesh, choice, &spectrum, &[4000], &Unwatched);
        assert!(matches!(beyond, Err(SpectrumError::Refused(_))));
    }
}

#[test]
fn a_stretch_of_the_spectrum_needs_nothing_below_it() {
    let mesh = potato(4);
    for choice in [FEM, COT] {
        let all = solve(&mesh, choice, 400, &[], &Unwatched).unwrap();
        let (values, errors) = (all.eigenvalues(), all.residuals());
        // Nearer to one of them than rounding could make the other.
        let target = 0.6 * values[250] + 0.4 * values[251];
        for count in [1, 20, 90] {
            let window = near(&mesh, choice, target, count, &Unwatched).unwrap();
            assert_eq!(window.values.len(), count);
            assert!(window.certificate.len() >= 2);
            let mut by_distance = values.clone();
            by_distance.sort_by(|a, b| (a - target).abs().total_cmp(&(b - target).abs()));
            let mut expected = by_distance[..count].to_vec();
            expected.sort_by(f64::total_cmp);
            for (at, (found, expected)) in window.values.iter().zip(&expected).enumerate() {
                let index = window.below + at;
                assert_eq!(*expected, values[index]);
                assert!((found - expected).abs() <= window.errors[at] + errors[index], "{index}");
            }
        }
        let range = between(&mesh, choice, values[100]..=values[120] * (1.0 + 1e-9), &Unwatched).unwrap();
        assert!((range.below == 100 || range.below == 101) && range.below + range.values.len() == 121);
        let last = near(&mesh, choice, 1e300, 3, &Unwatched).unwrap();
        assert_eq!((last.below + 3, last.values.len()), (last.order, 3));
        let start = near(&mesh, choice, 0.0, 5, &Unwatched).unwrap();
        assert_eq!((start.below, start.values[0]), (0, 0.0));
        let everything = near(&potato(1), choice, 1.0, 999, &Unwatched).unwrap();
        assert_eq!(everything.values.len(), 42);
    }
}

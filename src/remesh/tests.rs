//! What re-meshing promises, on shapes that can be written down.

use std::f64::consts::TAU;

use proptest::prelude::*;

use super::{quality::Topology, *};
use crate::watch::{Patience, Unwatched};

/// A grid of m × n vertices, closed in the first direction, and in the second where `both`.
fn grid(m: u32, n: u32, both: bool, at: impl Fn(f64, f64) -> [f64; 3]) -> Mesh {
    let index = |i: u32, j: u32| (i % m) * n + j % n;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..m {
        for j in 0..n {
            let rows = if both { n } else { n - 1 };
            vertices.push(at(f64::from(i) / f64::from(m), f64::from(j) / f64::from(rows)));
            if j < rows {
                triangles.push([index(i, j), index(i + 1, j), index(i + 1, j + 1)]);
                triangles.push([index(i, j), index(i + 1, j + 1), index(i, j + 1)]);
            }
        }
    }
    Mesh::new(vertices, triangles)
}

fn torus(m: u32, n: u32) -> Mesh {
    grid(m, n, true, |u, w| {
        let ((su, cu), (sw, cw)) = ((u * TAU).sin_cos(), (w * TAU).sin_cos());
        [(1.0 + 0.35 * cw) * cu, (1.0 + 0.35 * cw) * su, 0.35 * sw]
    })
}

/// An open tube.
fn tube(m: u32, n: u32) -> Mesh {
    grid(m, n, false, |u, w| [(u * TAU).cos(), (u * TAU).sin(), 2.0 * w])
}

fn sphere(m: u32, n: u32) -> Mesh {
    let mut mesh = grid(m, n, false, |u, w| {
        let (height, around) = ((0.05 + 0.9 * w) * TAU / 2.0, u * TAU);
        [height.sin() * around.cos(), height.sin() * around.sin(), height.cos()]
    });
    let (mut vertices, mut triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    vertices.extend([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]);
    for i in 0..m {
        let (here, there) = (i * n, (i + 1) % m * n);
        triangles.push([here, m * n, there]);
        triangles.push([here + n - 1, there + n - 1, m * n + 1]);
    }
    mesh = Mesh::new(vertices, triangles);
    mesh
}

fn cube() -> Mesh {
    let vertices = (0..8).map(|i| [i & 1, (i >> 1) & 1, (i >> 2) & 1].map(f64::from)).collect();
    let squares = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Mesh::new(vertices, squares.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// Both meshes side by side.
fn beside(one: &Mesh, two: &Mesh) -> Mesh {
    let shift = one.vertices().len() as u32;
    let vertices = one.vertices().iter().copied().chain(two.vertices().iter().map(|&[x, y, z]| [x + 4.0, y, z]));
    let triangles = one.triangles().iter().copied().chain(two.triangles().iter().map(|t| t.map(|a| a + shift)));
    Mesh::new(vertices.collect(), triangles.collect())
}

fn remeshed(mesh: &Mesh, count: usize) -> Mesh {
    let result = remesh(mesh, count, &Unwatched).unwrap();
    assert_eq!(result.vertices().len(), count);
    assert_eq!(quality::topology(&result), quality::topology(mesh));
    assert!(crate::mesh::survey(&result).oriented);
    result
}

#[test]
fn a_sphere_up_and_down_is_even_and_round() {
    let mesh = sphere(60, 30);
    for (count, hausdorff) in [(100, 0.05), (700, 0.01), (5000, 0.004)] {
        let result = remeshed(&mesh, count);
        let shape = quality::shape(&result);
        assert!(shape.angle_1 > 30.0 && shape.least_angle > 20.0, "{count}: {shape:?}");
        assert!(shape.edge_variation < 0.15, "{count}: {shape:?}");
        let fidelity = quality::fidelity(&mesh, &result, 10_000).unwrap();
        assert!(fidelity.hausdorff() < hausdorff, "{count}: {fidelity:?}");
    }
}

#[test]
fn a_torus_keeps_its_hole() {
    let mesh = torus(40, 20);
    for count in [60, 800, 3000] {
        let result = remeshed(&mesh, count);
        let topology = quality::topology(&result);
        assert_eq!(topology, Topology { euler: 0, components: 1, loops: 0, closed_manifold: true });
    }
}

#[test]
fn an_open_mesh_keeps_its_boundary() {
    let mesh = tube(40, 12);
    for count in [60, 900] {
        let result = remeshed(&mesh, count);
        assert_eq!(quality::topology(&result).loops, 2);
        // Both rims are where they were.
        let rim = |height: f64| result.vertices().iter().filter(|p| p[2] == height).count();
        assert!(rim(0.0) > 6 && rim(2.0) > 6, "{} {}", rim(0.0), rim(2.0));
        let fidelity = quality::fidelity(&mesh, &result, 5000).unwrap();
        assert!(fidelity.hausdorff() < 4.0 / count as f64, "{count}: {fidelity:?}");
    }
}

#[test]
fn a_cube_keeps_its_edges_and_corners() {
    let mesh = cube();
    let result = remeshed(&mesh, 2000);
    for corner in mesh.vertices() {
        assert!(result.vertices().contains(corner), "{corner:?}");
    }
    let fidelity = quality::fidelity(&mesh, &result, 10_000).unwrap();
    assert!(fidelity.hausdorff() < 1e-12 && fidelity.area_change.abs() < 1e-12, "{fidelity:?}");
    let shape = quality::shape(&result);
    assert!(shape.angle_1 > 30.0 && shape.edge_variation < 0.2, "{shape:?}");
    // And back: the corners alone do not make twelve vertices, creases are given up only where they must be.
    assert_eq!(remeshed(&result, 200).area().round(), 6.0);
    remeshed(&result, 12);
}

#[test]
fn pieces_stay_apart() {
    let mesh = beside(&sphere(20, 10), &torus(30, 12));
    let result = remeshed(&mesh, 1500);
    let topology = quality::topology(&result);
    assert_eq!((topology.components, topology.euler), (2, 2));
}

#[test]
fn the_order_of_the_file_does_not_matter() {
    let mesh = torus(24, 14);
    let count = mesh.vertices().len() as u32;
    let turned = Mesh::new(
        mesh.vertices().iter().rev().copied().collect(),
        mesh.triangles().iter().rev().map(|&[a, b, c]| [b, c, a].map(|x| count - 1 - x)).collect(),
    );
    assert_eq!(remeshed(&mesh, 500), remeshed(&turned, 500));
}

#[test]
fn meshes_are_the_same_bits_as_long_as_the_version_is() {
    // Points that no sine goes into: a circle's, and those of a ball with dents.
    let circle = |turn: f64| {
        let quarter = (4.0 * turn).floor();
        let t = 4.0 * turn - quarter;
        let (x, y) = ((1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t));
        [[x, y], [-y, x], [-x, -y], [y, -x]][quarter as usize % 4]
    };
    let open = grid(24, 9, false, |u, w| [circle(u)[0], circle(u)[1], 2.0 * w]);
    let dented = grid_with_poles(40, 20, |u, w| {
        let ([x, y], [z, r]) = (circle(u), circle(0.5 * w));
        let dent = 1.0 - 0.3 * (x * x - 0.2) * (z - 0.1) * r;
        [x * r * dent, y * r * dent, z * dent]
    });
    let hashes: Vec<String> = [(&cube(), 300), (&open, 500), (&dented, 90), (&dented, 3000)]
        .into_iter()
        .map(|(mesh, count)| remeshed(mesh, count).hash().to_string()[..16].to_owned())
        .collect();
    assert_eq!(
        (KERNEL, hashes.join(" ").as_str()),
        (3, "759d5ea7ef126972 71b9ce0ccf0b19f9 0a480dfccacfd2f9 93d134110d5fcf59")
    );
}

#[test]
fn triangles_without_area_and_repeated_corners_do_no_harm() {
    let mesh = sphere(24, 12);
    let (mut vertices, mut triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    // A vertex on the middle of an edge of its first triangle makes one of its two halves flat.
    let [a, b, c] = triangles[0];
    let middle: [f64; 3] = std::array::from_fn(|x| 0.5 * (vertices[a as usize][x] + vertices[b as usize][x]));
    let m = vertices.len() as u32;
    vertices.push(middle);
    triangles[0] = [a, m, c];
    triangles.extend([[m, b, c], [a, b, m], [a, a, b]]);
    let mesh = Mesh::new(vertices, triangles);
    let result = remesh(&mesh, 1000, &Unwatched).unwrap();
    assert_eq!(quality::topology(&result).euler, 2);
    assert!(quality::shape(&result).least_angle > 20.0);
}

#[test]
fn orientations_that_disagree_are_made_to_agree() {
    let mesh = torus(20, 10);
    let mut triangles = mesh.triangles().to_vec();
    triangles.iter_mut().step_by(3).for_each(|triangle| triangle.swap(0, 2));
    let mixed = Mesh::new(mesh.vertices().to_vec(), triangles);
    let result = remesh(&mixed, 400, &Unwatched).unwrap();
    assert!(crate::mesh::survey(&result).oriented);
    assert_eq!(quality::topology(&result).euler, 0);
    let open = tube(20, 6);
    let mut triangles = open.triangles().to_vec();
    triangles.iter_mut().step_by(2).for_each(|triangle| triangle.swap(1, 2));
    assert_eq!(
        quality::topology(&remesh(&Mesh::new(open.vertices().to_vec(), triangles), 200, &Unwatched).unwrap()).loops,
        2
    );
}

#[test]
fn what_is_no_manifold_is_refused() {
    let refused = |vertices: &[[f64; 3]], triangles: &[[u32; 3]]| {
        remesh(&Mesh::new(vertices.to_vec(), triangles.to_vec()), 100, &Unwatched).unwrap_err()
    };
    let points =
        [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [3.0, 3.0, 1.0]];
    let error = refused(&points, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!(error, RemeshError::Edge { faces: 3, at: [1.0, 0.0, 0.0] });
    assert_eq!(error.to_string(), "cannot be re-meshed: not a manifold: 3 faces share the edge at (1, 0, 0)");
    // Two triangles that touch in a vertex; two tetrahedra that do.
    assert_eq!(refused(&points, &[[0, 1, 2], [0, 4, 3]]), RemeshError::Vertex { at: [0.0; 3] });
    let tetrahedron = |[a, b, c, d]: [u32; 4]| [[a, c, b], [a, b, d], [b, c, d], [a, d, c]];
    let both = [tetrahedron([0, 1, 2, 3]), tetrahedron([0, 4, 5, 6])].concat();
    let seven = [&points[..], &[[-1.0, -1.0, -1.0]]].concat();
    assert_eq!(refused(&seven, &both), RemeshError::Vertex { at: [0.0; 3] });
    assert!(matches!(refused(&points, &[[0, 1, 2], [0, 2, 1]]), RemeshError::Doubled { .. }));
    assert_eq!(refused(&points, &[[0, 0, 1]]), RemeshError::NoArea);
    assert_eq!(refused(&[[0.0; 3]; 3], &[[0, 1, 2]]), RemeshError::NoArea);
    assert_eq!(refused(&[[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN; 3]], &[[0, 1, 2]]), RemeshError::NotFinite);
    assert_eq!(refused(&[], &[]), RemeshError::NoArea);
    // A strip that is joined to itself with a half turn.
    let strip = tube(9, 3);
    let twisted = strip.triangles().iter().map(|t| {
        let last = t.iter().any(|&a| a >= 24);
        t.map(|a| if last && a < 3 { 2 - a } else { a })
    });
    assert!(matches!(refused(strip.vertices(), &twisted.collect::<Vec<_>>()), RemeshError::OneSided { .. }));
}

#[test]
fn counts_that_cannot_be_had_are_refused() {
    let mesh = beside(&torus(20, 10), &torus(20, 10));
    assert_eq!(remesh(&mesh, 11, &Unwatched), Err(RemeshError::Count { count: 11 }));
    // A torus has 7 vertices at least.
    let Err(RemeshError::TooFew { wanted: 12, least }) = remesh(&mesh, 12, &Unwatched) else {
        panic!("two tori do not go with twelve vertices")
    };
    assert!((14..40).contains(&least), "{least}");
    remeshed(&mesh, least.max(40));
}

#[test]
fn it_can_be_cancelled_at_any_time() {
    let mesh = limb(0.05);
    let looks = |granted: usize| {
        let watch = Patience::of(granted);
        let result = remesh(&mesh, 30_000, &watch);
        (result, watch.looks())
    };
    let (result, all) = looks(usize::MAX);
    assert_eq!(result.unwrap().vertices().len(), 30_000);
    // One in about two milliseconds.
    assert!(all > 50, "{all}");
    let mut state = 7_u64;
    let random = (0..16).map(|_| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % all
    });
    for granted in [0, 1, all - 1].into_iter().chain(random) {
        assert_eq!(looks(granted), (Err(RemeshError::Cancelled), granted + 1));
    }
}

#[test]
fn few_and_many_vertices_can_be_asked_for() {
    for mesh in [limb(0.1), torus(30, 15), tube(30, 10), beside(&sphere(20, 10), &tube(20, 8))] {
        for (count, angle) in [(100, 15.0), (50_000, 25.0)] {
            let result = remeshed(&mesh, count);
            let shape = quality::shape(&result);
            assert!(shape.angle_1 > angle, "{count}: {shape:?}");
            let fidelity = quality::fidelity(&mesh, &result, 5000).unwrap();
            // What the chords of so few edges miss.
            let missed = if count == 100 { 0.08 } else { 0.002 };
            assert!(fidelity.hausdorff() < missed, "{count}: {fidelity:?}");
        }
    }
}

/// A ball with a thin limb: of radius 1, and from its pole a tube of `radius` that ends in a tip.
fn limb(radius: f64) -> Mesh {
    grid_with_poles(16, 60, |u, w| {
        let around = u * TAU;
        // Half of the rows are on the ball, up to where the limb begins.
        let (r, z) = if w < 0.5 {
            let turn = 2.0 * w * (TAU / 2.0 - radius);
            (turn.sin(), -turn.cos())
        } else {
            let along = 2.0 * w - 1.0;
            (radius * (1.0 - along.powi(8)).max(0.02), (1.0 - radius * radius).sqrt() + 1.5 * along)
        };
        [r * around.cos(), r * around.sin(), z]
    })
}

/// A sphere-like grid of m × n vertices without poles, and a vertex for each pole.
fn grid_with_poles(m: u32, n: u32, at: impl Fn(f64, f64) -> [f64; 3]) -> Mesh {
    let mesh = grid(m, n, false, |u, w| at(u, (w * f64::from(n - 1) + 0.5) / f64::from(n)));
    let (mut vertices, mut triangles) = (mesh.vertices().to_vec(), mesh.triangles().to_vec());
    vertices.extend([at(0.0, 0.0), at(0.0, 1.0)].map(|[_, _, z]| [0.0, 0.0, z]));
    for i in 0..m {
        let (here, there) = (i * n, (i + 1) % m * n);
        triangles.push([here, m * n, there]);
        triangles.push([here + n - 1, there + n - 1, m * n + 1]);
    }
    Mesh::new(vertices, triangles)
}

#[test]
fn thin_limbs_keep_their_tips() {
    // An even mesh of 1 000 vertices has edges of 0.13: the thinnest limb is half as thick as they are long.
    for radius in [0.1, 0.05, 0.03] {
        let mesh = limb(radius);
        let result = remeshed(&mesh, 1000);
        let tip = |mesh: &Mesh| mesh.vertices().iter().map(|p| p[2]).fold(0.0, f64::max);
        assert!((tip(&mesh) - tip(&result)).abs() < 0.06, "{radius}: {} {}", tip(&mesh), tip(&result));
        let fidelity = quality::fidelity(&mesh, &result, 20_000).unwrap();
        assert!(fidelity.hausdorff() < 0.015 && fidelity.area_change.abs() < 0.002, "{radius}: {fidelity:?}");
        let shape = quality::shape(&result);
        assert!(shape.angle_1 > 25.0 && shape.least_angle > 10.0, "{radius}: {shape:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn any_count_is_reached_and_the_topology_kept(
        shape in 0..4_usize,
        count in 40..900_usize,
        bumps in prop::collection::vec(-0.02..0.02_f64, 40),
    ) {
        let mesh = match shape {
            0 => sphere(22, 11),
            1 => torus(26, 12),
            2 => tube(18, 8),
            _ => beside(&cube(), &tube(12, 5)),
        };
        let vertices = mesh.vertices().iter().enumerate();
        let vertices = vertices.map(|(i, p)| std::array::from_fn(|x| p[x] + bumps[(3 * i + x) % bumps.len()])).collect();
        let mesh = Mesh::new(vertices, mesh.triangles().to_vec());
        let result = remesh(&mesh, count, &Unwatched).unwrap();
        prop_assert_eq!(result.vertices().len(), count);
        prop_assert_eq!(quality::topology(&result), quality::topology(&mesh));
        prop_assert_eq!(&result, &remesh(&mesh.canonical(), count, &Unwatched).unwrap());
    }
}

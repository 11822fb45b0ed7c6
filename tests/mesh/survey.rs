//! What is said of meshes with known defects.

use eigenselect::mesh::{DefectKind, Mesh, Spot, Survey, survey};
use proptest::prelude::*;

use crate::tetrahedron;

/// The defects as text.
fn lines(survey: &Survey) -> Vec<String> {
    survey.defects.iter().map(ToString::to_string).collect()
}

/// A grid of `rows` × `columns` quads, each of two triangles, whose vertex (row, column) is number `at(row, column)`.
fn grid(rows: u32, columns: u32, at: impl Fn(u32, u32) -> u32) -> Vec<[u32; 3]> {
    (0..rows)
        .flat_map(|row| (0..columns).map(move |column| (row, column)))
        .flat_map(|(r, c)| [[at(r, c), at(r + 1, c), at(r, c + 1)], [at(r + 1, c), at(r + 1, c + 1), at(r, c + 1)]])
        .collect()
}

/// Positions in general: no two alike, no three in a line.
fn general(count: u32) -> Vec<[f64; 3]> {
    (1..=count).map(f64::from).map(|i| [(i * 1.7).sin(), (i * i * 0.9).cos(), (i * 2.3).sin() + 0.1 * i]).collect()
}

fn torus() -> Mesh {
    Mesh::new(general(30), grid(5, 6, |row, column| row % 5 * 6 + column % 6))
}

#[test]
fn a_closed_surface_has_nothing_to_say() {
    let survey = survey(&tetrahedron());
    assert_eq!(lines(&survey), Vec::<String>::new());
    assert_eq!((survey.vertices, survey.triangles, survey.components, survey.euler), (4, 4, 1, 2));
    assert_eq!((survey.genus, survey.oriented, survey.closed_manifold()), (Some(0), true, true));
    assert_eq!(survey.refusal(), None);
}

#[test]
fn genus_sums_over_components() {
    let one = survey(&torus());
    assert_eq!((one.genus, one.euler, one.closed_manifold()), (Some(1), 0, true));
    let (a, b) = (torus(), tetrahedron());
    let shifted = |mesh: &Mesh, by: usize| {
        mesh.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + by as u32)).collect::<Vec<_>>()
    };
    let vertices = [a.vertices(), a.vertices(), b.vertices()].concat().into_iter().enumerate();
    let three = Mesh::new(
        vertices.map(|(i, [x, y, z])| [x + 10.0 * i as f64, y, z]).collect(),
        [shifted(&a, 0), shifted(&a, 30), shifted(&b, 60)].concat(),
    );
    let survey = survey(&three);
    assert_eq!((survey.genus, survey.components, survey.euler), (Some(2), 3, 2));
    let last = lines(&survey).into_iter().find(|line| line.contains("components"));
    assert_eq!(
        last.as_deref(),
        Some("3 components, each adding a zero eigenvalue: first faces 0, 60, 120 (counted from 0)")
    );
}

#[test]
fn boundaries_are_counted_in_loops() {
    // An annulus: closed in its columns, open in its rows.
    let annulus = Mesh::new(general(18), grid(2, 6, |row, column| row * 6 + column % 6));
    let survey = survey(&annulus);
    assert_eq!((survey.boundary_edges, survey.boundary_loops, survey.euler, survey.genus), (12, 2, 0, None));
    assert!(!survey.closed_manifold());
    assert_eq!(
        lines(&survey),
        ["open boundary: 12 edges in 2 loops: edges 0–1, 0–5, 1–2, 2–3, 3–4, … (counted from 0)"]
    );
}

#[test]
fn orientation_is_inconsistent_or_impossible() {
    let mut triangles = torus().triangles().to_vec();
    triangles[7].swap(0, 1);
    let turned = survey(&Mesh::new(general(30), triangles));
    assert!(!turned.oriented);
    assert_eq!((turned.count(DefectKind::Inconsistent), turned.count(DefectKind::NonOrientable)), (3, 0));
    assert_eq!(turned.genus, Some(1));
    assert!(
        lines(&turned)[0]
            .starts_with("inconsistent orientation: 3 edges between faces that face opposite ways: edges ")
    );

    // A Klein bottle: the rows close with the columns reversed.
    let at = |row: u32, column: u32| if row < 5 { row * 6 + column % 6 } else { (6 - column % 6) % 6 };
    let klein = survey(&Mesh::new(general(30), grid(5, 6, at)));
    assert!(!klein.oriented && klein.closed_manifold());
    assert_eq!((klein.euler, klein.genus, klein.count(DefectKind::Inconsistent)), (0, None, 0));
    assert!(klein.count(DefectKind::NonOrientable) > 0);
    assert!(lines(&klein)[0].starts_with("not orientable: "));
}

#[test]
fn edges_of_three_triangles_and_vertices_where_surfaces_touch() {
    let fin = Mesh::new(general(5), vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let fin = survey(&fin);
    assert_eq!(fin.count(DefectKind::NonManifoldEdge), 1);
    assert_eq!(lines(&fin)[0], "1 non-manifold edge (more than two faces): edge 0–1 (counted from 0)");
    assert_eq!(fin.count(DefectKind::NonManifoldVertex), 0);

    // Two tetrahedra that share vertex 0.
    let twin = |offset: u32| {
        tetrahedron()
            .triangles()
            .iter()
            .map(move |t| t.map(|v| if v == 0 { 0 } else { v + offset }))
            .collect::<Vec<_>>()
    };
    let touching = Mesh::new(general(7), [twin(0), twin(3)].concat());
    let touching = survey(&touching);
    assert_eq!(
        lines(&touching),
        ["1 non-manifold vertex (where the surface touches itself): vertex 0 (counted from 0)"]
    );
    assert_eq!((touching.components, touching.boundary_edges, touching.genus), (1, 0, None));
    assert!(!touching.closed_manifold());
}

#[test]
fn single_triangles_and_vertices() {
    let mut vertices = tetrahedron().vertices().to_vec();
    vertices.extend([[0.5, 0.0, 0.0], [0.0, 1.0, -0.0], [0.5, 4e-4, 0.0], [0.5, 5e-13, 0.0], [9.0, 9.0, 9.0]]);
    let triangles = vec![
        [0, 1, 2],
        [0, 1, 3],
        [2, 1, 0],
        [1, 2, 0], // of the first one's vertices
        [0, 0, 1],
        [3, 2, 3], // naming one twice
        [0, 4, 1],
        [0, 7, 1], // of height 0, and of 5e-13 of its length
        [0, 6, 1], // its least angle is 0.046°
        [0, 5, 1],
    ];
    let survey = survey(&Mesh::new(vertices, triangles));
    let lines = lines(&survey);
    for expected in [
        "2 faces naming a vertex twice: triangles 4, 5 (counted from 0)",
        "2 zero-area faces (height below 1e-12 of the longest edge): triangles 6, 7 (counted from 0)",
        "1 sliver (an angle below 0.05°): triangle 8 (counted from 0)",
        "2 duplicate faces: triangles 2, 3 (counted from 0)",
        "1 vertex at the position of an earlier one: vertex 5 (counted from 0)",
        "1 unused vertex: vertex 8 (counted from 0)",
    ] {
        assert!(lines.iter().any(|line| line == expected), "{expected}\nin {lines:#?}");
    }
    assert_eq!(survey.refusal(), None);
}

#[test]
fn slivers_are_judged_by_their_angle_and_not_by_their_size() {
    for size in [1e-9, 1.0, 1e9] {
        for (height, kind) in [(8e-4, None), (4e-4, Some(DefectKind::Sliver)), (4e-13, Some(DefectKind::ZeroArea))] {
            let vertices = vec![[0.0; 3], [size, 0.0, 0.0], [0.5 * size, height * size, 0.0]];
            let survey = survey(&Mesh::new(vertices, vec![[0, 1, 2]]));
            let found: Vec<DefectKind> = survey.defects.iter().map(|defect| defect.kind).collect();
            let expected: Vec<DefectKind> = kind.into_iter().chain([DefectKind::Boundary]).collect();
            assert_eq!(found, expected, "size {size}, height {height}");
        }
    }
}

#[test]
fn what_has_no_spectrum_is_refused_with_a_reason() {
    let refusal = |vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>| survey(&Mesh::new(vertices, triangles)).refusal();
    let square = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    for (vertices, triangles, expected) in [
        (vec![], vec![], "there are no vertices"),
        (square[..2].to_vec(), vec![], "there are no faces, only 2 vertices"),
        (square.clone(), vec![[0, 1, 2], [3, 3, 0]], "no face has an area"),
        (
            square.clone(),
            vec![[0, 1, 3], [0, 1, 4]],
            "1 face naming a vertex that does not exist: triangle 1 (counted from 0)",
        ),
        (
            vec![[0.0; 3], [f64::NAN, 0.0, 0.0], [0.0, 1.0, 0.0]],
            vec![[0, 1, 2]],
            "1 vertex position not finite: vertex 1 (counted from 0)",
        ),
        (
            vec![[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1e300, 0.0]],
            vec![[0, 1, 2]],
            "the coordinates are too large for an area to be computed",
        ),
    ] {
        assert_eq!(refusal(vertices, triangles).as_deref(), Some(expected));
    }
    assert_eq!(refusal(square.clone(), vec![[0, 1, 2], [0, 1, 3]]), None);
    assert_eq!(refusal(square, vec![]), None);
}

#[test]
fn places_are_few_and_a_survey_can_be_stored() {
    let mesh = Mesh::new(vec![[0.0; 3]; 53], vec![[50, 51, 52]]);
    let survey = survey(&mesh);
    let unused = survey.defects.iter().find(|defect| defect.kind == DefectKind::UnusedVertex).unwrap();
    assert_eq!((unused.count, unused.places.len(), unused.places[4]), (50, 5, Spot::Vertex(4)));
    assert!(unused.to_string().ends_with("vertices 0, 1, 2, 3, 4, … (counted from 0)"));
    let text = serde_json::to_string(&survey).unwrap();
    assert_eq!(serde_json::from_str::<Survey>(&text).unwrap(), survey);
}

proptest! {
    /// Against counts made in the plainest way.
    #[test]
    fn small_meshes_are_counted_right(triangles in prop::collection::vec(prop::array::uniform3(0..7u32), 0..12)) {
        let survey = survey(&Mesh::new(general(7), triangles.clone()));
        let sound: Vec<[u32; 3]> =
            triangles.iter().copied().filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let has = |triangle: &[u32; 3], vertices: &[u32]| vertices.iter().all(|vertex| triangle.contains(vertex));
        let mut edges = 0;
        let mut open = 0;
        let mut crowded = 0;
        for a in 0..7 {
            for b in a + 1..7 {
                let count = sound.iter().filter(|triangle| has(triangle, &[a, b])).count();
                edges += usize::from(count > 0);
                open += usize::from(count == 1);
                crowded += usize::from(count > 2);
            }
        }
        let used = (0..7).filter(|vertex| sound.iter().any(|triangle| has(triangle, &[*vertex]))).count();
        prop_assert_eq!(survey.boundary_edges, open);
        prop_assert_eq!(survey.count(DefectKind::NonManifoldEdge), crowded);
        prop_assert_eq!(survey.euler, used as i64 - edges as i64 + sound.len() as i64);
        prop_assert_eq!(survey.count(DefectKind::RepeatedVertex), triangles.len() - sound.len());

        // Components by spreading from vertex to vertex.
        let mut reached = [false; 7];
        let mut components = 0;
        for start in 0..7 {
            if reached[start as usize] || !sound.iter().any(|triangle| has(triangle, &[start])) {
                continue;
            }
            components += 1;
            let mut ahead = vec![start];
            while let Some(vertex) = ahead.pop() {
                if !std::mem::replace(&mut reached[vertex as usize], true) {
                    ahead.extend(sound.iter().filter(|triangle| has(triangle, &[vertex])).flatten().copied());
                }
            }
        }
        prop_assert_eq!(survey.components, components);

        // Orientability by trying all ways of turning triangles.
        let directed = |turned: usize| {
            let mut sides = Vec::new();
            for (i, &[a, b, c]) in sound.iter().enumerate() {
                let [a, b, c] = if turned >> i & 1 == 1 { [b, a, c] } else { [a, b, c] };
                sides.extend([(a, b), (b, c), (c, a)]);
            }
            sides
        };
        let consistent = |turned: usize| {
            let sides = directed(turned);
            sides.iter().enumerate().all(|(i, &(a, b))| {
                let of_edge = sides.iter().filter(|&&side| side == (a, b) || side == (b, a)).count();
                of_edge != 2 || !sides[..i].contains(&(a, b))
            })
        };
        prop_assert_eq!(survey.oriented, consistent(0));
        let orientable = (0..1 << sound.len()).any(consistent);
        prop_assert_eq!(survey.count(DefectKind::NonOrientable) == 0, orientable);
        prop_assert_eq!(survey.count(DefectKind::Inconsistent) > 0, orientable && !consistent(0));
    }
}

//! What connectivity and moves promise, on a torus that is shaken.

use super::*;
use crate::{mesh::vector::v, watch::Unwatched};

fn made(points: Vec<V3>, triangles: &[[u32; 3]]) -> Option<HalfEdges> {
    HalfEdges::new(points, triangles, &Pulse::new(&Unwatched)).unwrap()
}

/// A torus of m × n vertices, each square cut in two.
fn torus(m: u32, n: u32) -> HalfEdges {
    let at = |i: u32, j: u32| (i % m) * n + j % n;
    let mut points = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..m {
        for j in 0..n {
            let (u, w) = (f64::from(i) / f64::from(m), f64::from(j) / f64::from(n));
            let [(su, cu), (sw, cw)] = [u, w].map(|turn| (turn * std::f64::consts::TAU).sin_cos());
            points.push(v((1.0 + 0.4 * cw) * cu, (1.0 + 0.4 * cw) * su, 0.4 * sw));
            triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
            triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
        }
    }
    made(points, &triangles).unwrap()
}

fn ring() -> HalfEdges {
    torus(12, 8)
}

/// Two tips over a polygon of so many corners.
fn spindle(corners: u32) -> HalfEdges {
    let rim = (0..corners).map(|at| {
        let (y, x) = (f64::from(at) / f64::from(corners) * std::f64::consts::TAU).sin_cos();
        v(x, y, 0.0)
    });
    let points = rim.chain([v(0.0, 0.0, 1.0), v(0.0, 0.0, -1.0)]).collect();
    let sides = (0..corners).map(|at| (at, (at + 1) % corners));
    let triangles: Vec<_> = sides.flat_map(|(a, b)| [[a, b, corners], [b, a, corners + 1]]).collect();
    made(points, &triangles).unwrap()
}

/// The half-edge from `a` to `b`.
fn between(mesh: &HalfEdges, a: u32, b: u32) -> u32 {
    mesh.around(a).find(|&h| mesh.end(h) == b).unwrap()
}

/// What keeps the mesh from being a closed oriented manifold without degenerate or doubled faces and edges: all that a
/// half-edge, a face, a vertex' star and Euler's characteristic have to hold.
fn defect(mesh: &HalfEdges, genus: i64) -> Option<String> {
    let slots = mesh.slots();
    let (mut half_edges, mut fans) = (0_i64, vec![0_usize; mesh.vertex_slots() as usize]);
    for triangle in 0..mesh.triangle_slots() {
        let sides = sides(triangle);
        let here = sides.map(|h| mesh.has(h));
        if here == [false; 3] {
            continue;
        }
        let [a, b, c] = mesh.corners(triangle);
        if here != [true; 3] || a == b || b == c || c == a {
            return Some(format!("face {triangle}: {a} {b} {c}"));
        }
        for h in sides {
            let t = mesh.twin(h);
            let turns = next(prev(h)) == h
                && prev(next(h)) == h
                && next(next(next(h))) == h
                && triangle_of(next(h)) == triangle;
            let names = mesh.end(h) == mesh.start(next(h)) && mesh.apex(h) == mesh.start(prev(h));
            if !turns || !names {
                return Some(format!("half-edge {h}: next or previous"));
            }
            if t >= slots || !mesh.has(t) || mesh.twin(t) != h || triangle_of(t) == triangle {
                return Some(format!("half-edge {h}: twin {t}"));
            }
            if (mesh.start(t), mesh.end(t)) != (mesh.end(h), mesh.start(h)) || mesh.is_marked(h) != mesh.is_marked(t) {
                return Some(format!("half-edge {h}: its twin {t} is another edge, or marked otherwise"));
            }
            if mesh.apex(h) == mesh.apex(t) {
                return Some(format!("half-edge {h}: one face on both sides"));
            }
            if !mesh.has_vertex(mesh.start(h)) {
                return Some(format!("half-edge {h}: starts at a vertex that is gone"));
            }
            half_edges += 1;
            fans[mesh.start(h) as usize] += 1;
        }
    }
    let mut vertices = 0;
    for a in 0..mesh.vertex_slots() {
        let fan = fans[a as usize];
        if !mesh.has_vertex(a) {
            if fan > 0 {
                return Some(format!("vertex {a}: gone, with {fan} half-edges"));
            }
            continue;
        }
        vertices += 1;
        // One fan that holds all half-edges from here, and no neighbour twice.
        let star: Vec<u32> = mesh.around(a).take(fan + 1).collect();
        let mut beside: Vec<u32> = star.iter().map(|&h| mesh.end(h)).collect();
        beside.sort_unstable();
        beside.dedup();
        if star.len() != fan || beside.len() != fan || fan < 3 || star.iter().any(|&h| mesh.start(h) != a) {
            return Some(format!("vertex {a}: {fan} half-edges, around it {}, to {}", star.len(), beside.len()));
        }
    }
    let euler = vertices - half_edges / 2 + half_edges / 3;
    let wrong = mesh.vertex_count() as i64 != vertices || euler != 2 - 2 * genus || mesh.topology() != (1, genus);
    wrong.then(|| format!("{vertices} vertices of {}, {half_edges} half-edges", mesh.vertex_count()))
}

fn assert_sound(mesh: &HalfEdges) {
    assert_eq!(defect(mesh, 1), None);
}

/// Splits, flips and collapses edges at will, in so many rounds, so that the mesh grows and then shrinks; a collapse
/// may leave vertices with `least` neighbours. Looks at all of the mesh after every move; gives how many there were of
/// each.
fn shake(mesh: &mut HalfEdges, rounds: u32, least: usize) -> [usize; 3] {
    let mut state = 12_345_u64;
    let mut below = |n: u32| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % u64::from(n)) as u32
    };
    let mut moves = [0; 3];
    for round in 0..rounds {
        let h = below(mesh.slots());
        if !mesh.has(h) {
            continue;
        }
        let middle = mesh.point(mesh.start(h)).lerp(mesh.point(mesh.end(h)), 0.5);
        match (below(4), round < rounds / 2) {
            (0 | 1, true) => {
                mesh.split(h, middle);
                moves[0] += 1;
            }
            (2, _) if mesh.can_flip(h) => {
                mesh.flip(h);
                moves[1] += 1;
            }
            (3, _) | (_, false) if mesh.can_collapse_to(h, least) => {
                mesh.collapse(h, middle);
                moves[2] += 1;
            }
            _ => continue,
        }
        assert_eq!(defect(mesh, 1), None, "round {round}");
        let fewest = (0..mesh.vertex_slots()).filter(|&a| mesh.has_vertex(a)).map(|a| mesh.degree(a)).min();
        assert!(fewest >= Some(least), "round {round}: {fewest:?} neighbours");
    }
    moves
}

#[test]
fn random_moves_keep_a_torus() {
    let mut mesh = ring();
    assert_sound(&mesh);
    let moves = shake(&mut mesh, 4000, 4);
    assert!(moves.iter().all(|&count| count > 100), "{moves:?}");
    let (points, triangles) = mesh.parts(0..0);
    assert_eq!(points.len(), mesh.vertex_count());
    assert_sound(&made(points, &triangles).unwrap());
}

#[test]
fn an_edge_is_collapsed_where_that_leaves_a_manifold_and_nowhere_else() {
    let (mut pinched, mut few) = (0, 0);
    // Around a tube of three or four vertices, and where moves have made it narrow.
    let mut shaken = ring();
    shake(&mut shaken, 500, 3);
    // With eight vertices or fewer none is taken away.
    assert!((12..150).contains(&shaken.vertex_count()), "{}", shaken.vertex_count());
    for mesh in [torus(12, 3), torus(12, 4), shaken] {
        for h in (0..mesh.slots()).filter(|&h| mesh.has(h)) {
            let (b, c, d) = (mesh.end(h), mesh.apex(h), mesh.apex(mesh.twin(h)));
            let mut collapsed = mesh.clone();
            collapsed.collapse(h, mesh.point(b));
            let defect = defect(&collapsed, 1);
            pinched += usize::from(defect.is_some());
            let fewest = [b, c, d].map(|a| if defect.is_none() { collapsed.degree(a) } else { 0 }).into_iter().min();
            for least in [3, 4] {
                let keeps = defect.is_none() && fewest >= Some(least);
                assert_eq!(mesh.can_collapse_to(h, least), keeps, "{h} to {least}: {fewest:?} {defect:?}");
                few += usize::from(defect.is_none() && !keeps);
            }
        }
    }
    assert!(pinched > 72 && few > 20, "{pinched} {few}");
}

#[test]
fn neighbours_in_common_are_found_among_many() {
    let mesh = spindle(40);
    assert_eq!(defect(&mesh, 0), None);
    let spokes: Vec<u32> = mesh.around(40).collect();
    assert_eq!(spokes.len(), 40);
    for h in spokes {
        assert!(mesh.can_collapse_to(h, 3) && mesh.can_collapse_to(mesh.twin(h), 3));
        // The ends of the polygon's sides have four neighbours.
        assert!(!mesh.can_collapse(h));
    }
}

#[test]
fn a_collapse_lays_marks_together() {
    let mesh = ring();
    let h = between(&mesh, 9, 10);
    let t = mesh.twin(h);
    let [c, d] = [mesh.apex(h), mesh.apex(t)];
    for (side, apex) in [(next(h), c), (prev(h), c), (next(t), d), (prev(t), d)] {
        let mut mesh = mesh.clone();
        mesh.mark(side, true);
        mesh.collapse(h, mesh.point(10));
        assert_sound(&mesh);
        let left = between(&mesh, 10, apex);
        let marked: Vec<u32> = (0..mesh.slots()).filter(|&o| mesh.has(o) && mesh.is_marked(o)).collect();
        assert_eq!(marked, [left.min(mesh.twin(left)), left.max(mesh.twin(left))]);
    }
    // What leaves the vertex that goes, leaves the one that stays.
    let mut mesh = ring();
    let away = mesh.around(9).find(|&o| ![10, c, d].contains(&mesh.end(o))).unwrap();
    let end = mesh.end(away);
    mesh.mark(away, true);
    mesh.collapse(h, mesh.point(10));
    assert!(mesh.is_marked(between(&mesh, 10, end)));
}

#[test]
fn marks_go_where_their_edges_go() {
    let mut mesh = ring();
    // The circle j = 0 around the hole.
    let circle = |a: u32| a.is_multiple_of(8);
    for h in (0..mesh.triangle_slots())
        .flat_map(sides)
        .filter(|&h| circle(mesh.start(h)) && circle(mesh.end(h)))
        .collect::<Vec<_>>()
    {
        mesh.mark(h, true);
    }
    for _ in 0..3 {
        for h in (0..mesh.triangle_slots()).flat_map(sides) {
            let middle = mesh.point(mesh.start(h)).lerp(mesh.point(mesh.end(h)), 0.5);
            match h % 5 {
                0 => _ = mesh.split(h, middle),
                1 if !mesh.is_marked(h) && mesh.can_flip(h) => mesh.flip(h),
                _ => {}
            }
        }
    }
    assert_sound(&mesh);
    let marked: Vec<u32> = (0..mesh.slots()).filter(|&h| mesh.is_marked(h)).collect();
    assert!(marked.len() > 24, "some were split: {}", marked.len());
    // Still one closed line, each vertex with its two neighbours on it.
    for &h in &marked {
        assert_eq!(mesh.around(mesh.start(h)).filter(|&o| mesh.is_marked(o)).count(), 2);
    }
    let mut at = marked[0];
    let mut length = 0;
    while length == 0 || at != marked[0] {
        let back = mesh.twin(at);
        at = mesh.around(mesh.end(at)).find(|&o| mesh.is_marked(o) && o != back).unwrap();
        length += 1;
    }
    assert_eq!(2 * length, marked.len());
}

#[test]
fn open_surfaces_are_refused() {
    assert!(made(vec![V3::default(); 3], &[[0, 1, 2]]).is_none());
    // Each edge has another, but in the same direction.
    assert!(made(vec![V3::default(); 3], &[[0, 1, 2], [0, 1, 2]]).is_none());
}

#[test]
fn some_vertices_can_be_left_out() {
    let mesh = ring();
    let (points, triangles) = mesh.parts(5..6);
    assert_eq!((points.len(), triangles.len()), (95, 186));
}

//! Shapes whose spectra are known, for the tests of this floor.

use std::collections::HashMap;

use crate::mesh::Mesh;

/// The unit sphere: an icosahedron, each triangle cut in four so many times.
pub(crate) fn sphere(levels: usize) -> Mesh {
    let golden = f64::midpoint(1.0, 5_f64.sqrt());
    let unit = |[x, y, z]: [f64; 3]| {
        let length = (x * x + y * y + z * z).sqrt();
        [x / length, y / length, z / length]
    };
    let mut points = Vec::new();
    for (a, b) in [(1.0, golden), (-1.0, golden), (1.0, -golden), (-1.0, -golden)] {
        points.extend([unit([0.0, a, b]), unit([a, b, 0.0]), unit([b, 0.0, a])]);
    }
    let distance = |a: [f64; 3], b: [f64; 3]| (0..3).map(|at| (a[at] - b[at]).powi(2)).sum::<f64>().sqrt();
    let edge = distance([0.0, 1.0, golden], [0.0, -1.0, golden]) / (1.0 + golden * golden).sqrt() * 1.001;
    let mut triangles = Vec::new();
    for a in 0..12_u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let near = |i: u32, j: u32| distance(points[i as usize], points[j as usize]) < edge;
                if near(a, b) && near(b, c) && near(c, a) {
                    triangles.push([a, b, c]);
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middle = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for [a, b, c] in triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, j): (u32, u32)| {
                *middle.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    let (p, q) = (points[i as usize], points[j as usize]);
                    points.push(unit([p[0] + q[0], p[1] + q[1], p[2] + q[2]]));
                    points.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    Mesh::new(points, triangles)
}

/// The flat rectangle of a × b cells with its shorter side of length one, squares cut along alternating diagonals.
pub(crate) fn grid(a: usize, b: usize) -> Mesh {
    let step = 1.0 / a.min(b) as f64;
    let points = (0..=b).flat_map(|y| (0..=a).map(move |x| [x as f64 * step, y as f64 * step, 0.0])).collect();
    let at = |x: usize, y: usize| (y * (a + 1) + x) as u32;
    let mut triangles = Vec::new();
    for y in 0..b {
        for x in 0..a {
            let [p, q, r, s] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            if (x + y) % 2 == 0 {
                triangles.extend([[p, q, r], [p, r, s]]);
            } else {
                triangles.extend([[p, q, s], [q, r, s]]);
            }
        }
    }
    Mesh::new(points, triangles)
}

/// The side of a prism over a regular polygon, in as many rows, of circumference 3 and height 1: flat inside, so
/// isometric to a cylinder.
pub(crate) fn prism(sides: usize, rows: usize) -> Mesh {
    let radius = 1.5 / sides as f64 / (std::f64::consts::PI / sides as f64).sin();
    let points = (0..=rows)
        .flat_map(|y| {
            (0..sides).map(move |x| {
                let (sine, cosine) = (std::f64::consts::TAU * x as f64 / sides as f64).sin_cos();
                [radius * cosine, radius * sine, y as f64 / rows as f64]
            })
        })
        .collect();
    let at = |x: usize, y: usize| (y * sides + x % sides) as u32;
    let mut triangles = Vec::new();
    for y in 0..rows {
        for x in 0..sides {
            let [p, q, r, s] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            triangles.extend([[p, q, r], [p, r, s]]);
        }
    }
    Mesh::new(points, triangles)
}

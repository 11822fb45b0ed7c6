//! Shapes whose spectra are known, for tests of the library from within and from without.

// Each test uses some.
#![allow(dead_code)]

use std::{
    collections::HashMap,
    f64::consts::{PI, TAU},
};

use super::Mesh;

/// The same faces on other points.
pub fn moved(mesh: &Mesh, place: impl Fn([f64; 3]) -> [f64; 3]) -> Mesh {
    Mesh::new(mesh.vertices().iter().map(|&point| place(point)).collect(), mesh.triangles().to_vec())
}

/// Several meshes in one, sharing no vertex.
pub fn joined(parts: &[Mesh]) -> Mesh {
    let (mut points, mut triangles) = (Vec::new(), Vec::new());
    for part in parts {
        let first = points.len() as u32;
        points.extend_from_slice(part.vertices());
        triangles.extend(part.triangles().iter().map(|triangle| triangle.map(|vertex| vertex + first)));
    }
    Mesh::new(points, triangles)
}

/// Every face with vertices of its own.
pub fn soup(mesh: &Mesh) -> Mesh {
    let points = mesh.triangles().iter().flat_map(|&triangle| mesh.corners(triangle).unwrap()).collect();
    Mesh::new(points, (0..mesh.triangles().len() as u32).map(|at| [3 * at, 3 * at + 1, 3 * at + 2]).collect())
}

/// The flat rectangle of a × b square cells, its second side of length one, with alternating diagonals.
pub fn rectangle(a: usize, b: usize) -> Mesh {
    let step = 1.0 / b as f64;
    let points = (0..=b).flat_map(|y| (0..=a).map(move |x| [x as f64 * step, y as f64 * step, 0.0])).collect();
    let at = |x: usize, y: usize| (y * (a + 1) + x) as u32;
    let mut triangles = Vec::new();
    for y in 0..b {
        for x in 0..a {
            let [p, q, r, s] = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
            triangles.extend(if (x + y) % 2 == 0 { [[p, q, r], [p, r, s]] } else { [[p, q, s], [q, r, s]] });
        }
    }
    Mesh::new(points, triangles)
}

/// The side of a prism over a regular polygon, in as many rows, of circumference 3 and height 1: flat inside, so
/// isometric to a cylinder.
pub fn prism(sides: usize, rows: usize) -> Mesh {
    let radius = 1.5 / sides as f64 / (PI / sides as f64).sin();
    let points = (0..=rows)
        .flat_map(|y| {
            (0..sides).map(move |x| {
                let (sine, cosine) = (TAU * x as f64 / sides as f64).sin_cos();
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

/// The unit disk in so many rings of nearly equal triangles.
pub fn disk(rings: usize) -> Mesh {
    let mut points = vec![[0.0; 3]];
    for ring in 1..=rings {
        let radius = ring as f64 / rings as f64;
        points.extend((0..6 * ring).map(|at| {
            let (sine, cosine) = (TAU * at as f64 / (6 * ring) as f64).sin_cos();
            [radius * cosine, radius * sine, 0.0]
        }));
    }
    let at = |ring: usize, place: usize| match ring {
        0 => 0,
        _ => (1 + 3 * ring * (ring - 1) + place % (6 * ring)) as u32,
    };
    let mut triangles = Vec::new();
    for ring in 0..rings {
        for sector in 0..6 {
            for k in 0..=ring {
                let (inner, outer) = (ring * sector + k, (ring + 1) * sector + k);
                triangles.push([at(ring, inner), at(ring + 1, outer), at(ring + 1, outer + 1)]);
                if k < ring {
                    triangles.push([at(ring, inner), at(ring + 1, outer + 1), at(ring, inner + 1)]);
                }
            }
        }
    }
    Mesh::new(points, triangles)
}

/// The part of the unit sphere within an angle of its pole, meshed as the disk is.
pub fn cap(rings: usize, angle: f64) -> Mesh {
    moved(&disk(rings), |[x, y, _]| {
        let radius = x.hypot(y);
        if radius == 0.0 {
            return [0.0, 0.0, 1.0];
        }
        let (sine, cosine) = (angle * radius).sin_cos();
        [x / radius * sine, y / radius * sine, cosine]
    })
}

/// The unit sphere: an icosahedron, each triangle cut in four so many times.
pub fn icosphere(levels: usize) -> Mesh {
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
    let mut triangles = Vec::new();
    for a in 0..12_u32 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let near = |i: u32, j: u32| distance(points[i as usize], points[j as usize]) < 1.06;
                if near(a, b) && near(b, c) && near(c, a) {
                    // Outwards.
                    let [p, q, r] = [a, b, c].map(|at| points[at as usize]);
                    let volume = p[0] * (q[1] * r[2] - q[2] * r[1])
                        + p[1] * (q[2] * r[0] - q[0] * r[2])
                        + p[2] * (q[0] * r[1] - q[1] * r[0]);
                    triangles.push(if volume > 0.0 { [a, b, c] } else { [a, c, b] });
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

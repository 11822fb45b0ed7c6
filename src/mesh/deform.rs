//! Variants of one shape: what a spectrum should hardly notice, and what it should not notice at all.

use std::collections::HashMap;

use super::{
    Mesh,
    vector::{cross, dot, length, sub},
};

/// Bends the shape by `angle` radians around an arc in the plane of its two longest box sides.
///
/// Lengths along the middle surface stay, so a thin shape is bent nearly isometrically. Nothing happens to a mesh
/// without an extent or with an angle of 0.
#[must_use]
pub fn bend(mesh: &Mesh, angle: f64) -> Mesh {
    let Some((least, greatest)) = mesh.bounding_box() else { return mesh.clone() };
    let side = sub(greatest, least);
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| side[b].total_cmp(&side[a]));
    let [along, across, _] = axes;
    let radius = side[along] / angle;
    if !radius.is_finite() || radius == 0.0 {
        return mesh.clone();
    }
    let middle: [f64; 3] = std::array::from_fn(|axis| 0.5 * (least[axis] + greatest[axis]));
    moved(mesh, |_, point| {
        let (s, t) = (point[along] - middle[along], point[across] - middle[across]);
        let (sin, cos) = (s / radius).sin_cos();
        let mut bent = point;
        bent[along] = middle[along] + (radius - t) * sin;
        bent[across] = middle[across] + radius - (radius - t) * cos;
        bent
    })
}

/// Smooths by Taubin's λ|μ steps (Taubin 1995, § 4), which keep the size of the shape: `steps` pairs of them.
#[must_use]
pub fn smooth(mesh: &Mesh, steps: usize) -> Mesh {
    let neighbours = neighbours(mesh);
    let mut points = mesh.vertices().to_vec();
    for _ in 0..steps {
        for factor in [0.5, -0.53] {
            let before = points.clone();
            for (point, around) in points.iter_mut().zip(&neighbours) {
                if around.is_empty() {
                    continue;
                }
                for axis in 0..3 {
                    let sum: f64 = around.iter().map(|&other| before[other as usize][axis]).sum();
                    point[axis] += factor * (sum / around.len() as f64 - point[axis]);
                }
            }
        }
    }
    Mesh::new(points, mesh.triangles().to_vec())
}

/// Moves every vertex by a random vector of up to `share` of the mean edge's length in each coordinate.
#[must_use]
pub fn noise(mesh: &Mesh, share: f64, seed: u64) -> Mesh {
    let reach = share * mean_edge(mesh);
    moved(mesh, |at, point| std::array::from_fn(|axis| point[axis] + reach * random(seed, 3 * at as u64 + axis as u64)))
}

/// Divides every triangle into four at the middles of its edges. The surface stays as it is.
#[must_use]
pub fn refine(mesh: &Mesh) -> Mesh {
    let mut points = mesh.vertices().to_vec();
    let mut middles = HashMap::new();
    let mut triangles = Vec::with_capacity(4 * mesh.triangles().len());
    for &triangle in mesh.triangles() {
        if mesh.corners(triangle).is_none() {
            continue;
        }
        let [a, b, c] = triangle;
        let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
            *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                let (p, q) = (points[from as usize], points[to as usize]);
                points.push(std::array::from_fn(|axis| 0.5 * (p[axis] + q[axis])));
                (points.len() - 1) as u32
            })
        });
        triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
    }
    Mesh::new(points, triangles)
}

/// Multiplies all coordinates.
#[must_use]
pub fn scale(mesh: &Mesh, factor: f64) -> Mesh {
    moved(mesh, |_, point| point.map(|value| factor * value))
}

/// Turns by `angle` radians around an axis through the origin (Rodrigues' formula). The axis need not be of length one.
#[must_use]
pub fn rotate(mesh: &Mesh, axis: [f64; 3], angle: f64) -> Mesh {
    let size = length(axis);
    if size == 0.0 {
        return mesh.clone();
    }
    let axis = axis.map(|value| value / size);
    let (sin, cos) = angle.sin_cos();
    moved(mesh, |_, point| {
        let turned = cross(axis, point);
        let along = dot(axis, point);
        std::array::from_fn(|at| cos * point[at] + sin * turned[at] + (1.0 - cos) * along * axis[at])
    })
}

fn moved(mesh: &Mesh, place: impl Fn(usize, [f64; 3]) -> [f64; 3]) -> Mesh {
    let points = mesh.vertices().iter().enumerate().map(|(at, &point)| place(at, point)).collect();
    Mesh::new(points, mesh.triangles().to_vec())
}

/// Ends of every edge, each edge as often as there are triangles at it.
fn edges(mesh: &Mesh) -> impl Iterator<Item = (u32, u32)> + '_ {
    let whole = mesh.triangles().iter().filter(|&&triangle| mesh.corners(triangle).is_some());
    whole.flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
}

fn neighbours(mesh: &Mesh) -> Vec<Vec<u32>> {
    let mut around = vec![Vec::new(); mesh.vertices().len()];
    for (a, b) in edges(mesh) {
        around[a as usize].push(b);
        around[b as usize].push(a);
    }
    for list in &mut around {
        list.sort_unstable();
        list.dedup();
    }
    around
}

fn mean_edge(mesh: &Mesh) -> f64 {
    let (mut sum, mut count) = (0.0, 0_u32);
    for (a, b) in edges(mesh) {
        sum += length(sub(mesh.vertices()[a as usize], mesh.vertices()[b as usize]));
        count += 1;
    }
    if count == 0 { 0.0 } else { sum / f64::from(count) }
}

/// Evenly distributed between −1 and 1: splitmix64 (Steele, Lea and Flood 2014) of a counter.
fn random(seed: u64, at: u64) -> f64 {
    let mut z = seed.wrapping_add(at.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 * (2.0 / (1_u64 << 53) as f64) - 1.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::synth;

    fn shape() -> Mesh {
        synth::generate(&synth::Options { vertices: 800, ..synth::Options::default() }, 1, 0).unwrap()
    }

    fn edge_lengths(mesh: &Mesh) -> Vec<f64> {
        edges(mesh).map(|(a, b)| length(sub(mesh.vertices()[a as usize], mesh.vertices()[b as usize]))).collect()
    }

    #[test]
    fn rotation_and_scale_keep_all_lengths_in_proportion() {
        let mesh = shape();
        for (variant, factor) in [(rotate(&mesh, [1.0, 2.0, -0.5], 1.1), 1.0), (scale(&mesh, 3.5), 3.5)] {
            for (before, after) in edge_lengths(&mesh).iter().zip(edge_lengths(&variant)) {
                assert!((after - factor * before).abs() <= 1e-13 * (1.0 + after), "{before} {after}");
            }
        }
        assert_eq!(rotate(&mesh, [0.0; 3], 1.0), mesh);
    }

    #[test]
    fn a_thin_strip_is_bent_isometrically_and_a_bend_moves_it() {
        let points = (0..40).flat_map(|i| [[f64::from(i) * 0.25, 0.0, 0.0], [f64::from(i) * 0.25, 0.0, 1.0]]).collect();
        let triangles =
            (0..39).flat_map(|i| [[2 * i, 2 * i + 2, 2 * i + 1], [2 * i + 1, 2 * i + 2, 2 * i + 3]]).collect();
        let strip = Mesh::new(points, triangles);
        // Its second longest side is z, around whose middle the bend is no isometry: turn it.
        let flat = rotate(&strip, [1.0, 0.0, 0.0], std::f64::consts::FRAC_PI_2);
        let bent = bend(&flat, 1.5);
        assert!(bent != flat && (bent.area() / flat.area() - 1.0).abs() < 0.01);
        assert_eq!(bend(&flat, 0.0), flat);
        assert_eq!(bend(&Mesh::default(), 1.0), Mesh::default());
    }

    #[test]
    fn refining_keeps_the_surface_and_its_topology() {
        let mesh = shape();
        let fine = refine(&mesh);
        assert_eq!(fine.triangles().len(), 4 * mesh.triangles().len());
        let edges = mesh.triangles().len() * 3 / 2;
        assert_eq!(fine.vertices().len(), mesh.vertices().len() + edges, "a closed mesh has a middle per edge");
        assert!((fine.area() - mesh.area()).abs() < 1e-12 * mesh.area());
    }

    #[test]
    fn smoothing_removes_noise_and_keeps_the_size() {
        let mesh = shape();
        let rough = noise(&mesh, 0.2, 7);
        assert_eq!(rough, noise(&mesh, 0.2, 7));
        assert!(rough != noise(&mesh, 0.2, 8) && rough.area() > mesh.area());
        let calm = smooth(&rough, 5);
        assert!(calm.area() < rough.area() && calm.area() > 0.9 * mesh.area(), "{} {}", calm.area(), mesh.area());
    }
}

//! How good a triangle mesh is, and how far from the mesh that it was made of.

use std::{collections::HashSet, f64::consts::FRAC_PI_2};

use self::tree::Tree;
use super::surface::nearest_of_triangle;
use crate::mesh::{Mesh, survey, vector::V3};

mod tree;

/// The shape of a mesh's triangles. Angles in degrees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// The least of the triangles' least angles.
    pub least_angle: f64,
    /// The first percentile of the triangles' least angles: one triangle in a hundred has a smaller one.
    pub angle_1: f64,
    /// The fifth percentile.
    pub angle_5: f64,
    /// The median; 60 is the most there can be.
    pub angle_50: f64,
    /// The mean length of the edges, in the mesh's unit.
    pub edge: f64,
    /// The coefficient of variation of the edges' lengths: their standard deviation over their mean.
    pub edge_variation: f64,
}

/// The topology of a mesh.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Topology {
    /// Vertices − edges + triangles.
    pub euler: i64,
    /// Connected parts.
    pub components: usize,
    /// Connected pieces of the boundary.
    pub loops: usize,
    /// No boundary, no edge of three triangles, no vertex where surfaces touch.
    pub closed_manifold: bool,
}

/// How far a mesh is from the one that it was made of. Lengths are shares of the diagonal of the original's bounding
/// box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Fidelity {
    /// The greatest distance of a point of the result from the original.
    pub outwards: f64,
    /// The greatest distance of a point of the original from the result.
    pub inwards: f64,
    /// The mean distance of both ways, points weighted as they were sampled: evenly.
    pub mean: f64,
    /// Area of the result over that of the original, less 1.
    pub area_change: f64,
}

impl Fidelity {
    /// The symmetric Hausdorff distance: the greater of both ways.
    #[must_use]
    pub fn hausdorff(&self) -> f64 {
        self.outwards.max(self.inwards)
    }
}

/// The shape of the triangles. All 0 without triangles; a triangle without an area has the least angle 0.
#[must_use]
pub fn shape(mesh: &Mesh) -> Shape {
    let mut angles: Vec<f64> = corners(mesh).map(least_angle).collect();
    angles.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| angles.get((share * angles.len() as f64) as usize).copied().unwrap_or(0.0);
    let mut seen = HashSet::new();
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for &[a, b, c] in mesh.triangles() {
        for (a, b) in [(a, b), (b, c), (c, a)] {
            if seen.insert((a.min(b), a.max(b)))
                && let Some([p, q, _]) = mesh.corners([a, b, a])
            {
                let length = (V3::from(p) - V3::from(q)).norm();
                count += 1.0;
                sum += length;
                squares += length * length;
            }
        }
    }
    let edge: f64 = if count > 0.0 { sum / count } else { 0.0 };
    let variance = if count > 0.0 { (squares / count - edge * edge).max(0.0) } else { 0.0 };
    Shape {
        least_angle: at(0.0),
        angle_1: at(0.01),
        angle_5: at(0.05),
        angle_50: at(0.5),
        edge,
        edge_variation: if edge > 0.0 { variance.sqrt() / edge } else { 0.0 },
    }
}

/// The topology of a mesh.
#[must_use]
pub fn topology(mesh: &Mesh) -> Topology {
    let survey = survey(mesh);
    Topology {
        euler: survey.euler,
        components: survey.components,
        loops: survey.boundary_loops,
        closed_manifold: survey.closed_manifold(),
    }
}

/// Measures `result` against `original` at about `samples` points of each, spread evenly, besides their vertices.
///
/// Distances are exact at these points; the greatest distance of all is that much greater at most as the points lie
/// apart. `None` when one of them has no area.
#[must_use]
pub fn fidelity(original: &Mesh, result: &Mesh, samples: usize) -> Option<Fidelity> {
    let (low, high) = original.bounding_box()?;
    let diagonal = (V3::from(high) - V3::from(low)).norm();
    let areas = [original.area(), result.area()];
    if areas.iter().any(|area| !area.is_finite() || *area <= 0.0) {
        return None;
    }
    let (outwards, mean_out) = farthest(result, original, areas[1] / samples as f64);
    let (inwards, mean_in) = farthest(original, result, areas[0] / samples as f64);
    Some(Fidelity {
        outwards: outwards / diagonal,
        inwards: inwards / diagonal,
        mean: 0.5 * (mean_out + mean_in) / diagonal,
        area_change: areas[1] / areas[0] - 1.0,
    })
}

fn corners(mesh: &Mesh) -> impl Iterator<Item = [V3; 3]> {
    mesh.triangles().iter().filter_map(|&triangle| mesh.corners(triangle)).map(|corners| corners.map(V3::from))
}

/// The least angle of a triangle, in degrees.
fn least_angle([a, b, c]: [V3; 3]) -> f64 {
    let angle = |at: V3, one: V3, two: V3| {
        let (u, w) = (one - at, two - at);
        let sine = u.cross(w).norm();
        if sine > 0.0 { FRAC_PI_2 - (u.dot(w) / sine).atan() } else { 0.0 }
    };
    angle(a, b, c).min(angle(b, c, a)).min(angle(c, a, b)).to_degrees()
}

/// The greatest and the mean distance of points of `from`, one per `cell` of area, to `to`.
fn farthest(from: &Mesh, to: &Mesh, cell: f64) -> (f64, f64) {
    let tree = Tree::new(&corners(to).collect::<Vec<_>>());
    let (mut greatest, mut sum, mut count) = (0.0_f64, 0.0, 0.0);
    let mut guess = 0;
    for corners in corners(from) {
        let [a, b, c] = corners;
        let area = 0.5 * (b - a).cross(c - a).norm();
        // n² triangles, each with a point in its middle.
        let n = ((area / cell).sqrt().ceil() as u32).clamp(1, 1000);
        let step = 1.0 / f64::from(n);
        let mut look = |x: f64, y: f64, weight: f64| {
            let p = a + (b - a) * x + (c - a) * y;
            let (distance2, nearest) = tree.nearest(p, guess);
            guess = nearest;
            greatest = greatest.max(distance2);
            sum += weight * distance2.sqrt();
            count += weight;
        };
        for i in 0..n {
            for j in 0..n - i {
                let (x, y) = (f64::from(i), f64::from(j));
                look((x + 1.0 / 3.0) * step, (y + 1.0 / 3.0) * step, area * step * step);
                if i + j + 1 < n {
                    look((x + 2.0 / 3.0) * step, (y + 2.0 / 3.0) * step, area * step * step);
                }
            }
        }
        // Corners are where the greatest distance is likely.
        for (x, y) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)] {
            look(x, y, 0.0);
        }
    }
    (greatest.sqrt(), if count > 0.0 { sum / count } else { 0.0 })
}

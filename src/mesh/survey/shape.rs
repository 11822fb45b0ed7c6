//! Defects of single vertices and triangles.

use std::collections::HashSet;

use super::{Defect, DefectKind, Spot};
use crate::mesh::{
    Mesh,
    vector::{cross, dot, length, sub},
};

/// A triangle has no area where its height is at most this part of its longest edge: the rounding of its corners'
/// differences alone can make as much.
pub(super) const ZERO_HEIGHT: f64 = 1e-12;
/// A sliver has an angle below this many degrees.
pub(super) const SLIVER_DEGREES: f64 = 0.05;

/// Records defects; gives the triangles of three different vertices that exist, each with its number.
pub(super) fn look(mesh: &Mesh, defects: &mut Vec<Defect>) -> Vec<(u32, [u32; 3])> {
    let count = mesh.vertices().len();
    let mut used = vec![false; count];
    let mut missing = Vec::new();
    let mut repeated = Vec::new();
    let mut flat = Vec::new();
    let mut slivers = Vec::new();
    let mut sound = Vec::with_capacity(mesh.triangles().len());
    for (number, &triangle) in (0..).zip(mesh.triangles()) {
        let Some(corners) = mesh.corners(triangle) else {
            missing.push(Spot::Triangle(number));
            continue;
        };
        let [a, b, c] = triangle;
        for vertex in triangle {
            used[vertex as usize] = true;
        }
        if a == b || b == c || c == a {
            repeated.push(Spot::Triangle(number));
            continue;
        }
        sound.push((number, triangle));
        match quality(corners) {
            Quality::Flat => flat.push(Spot::Triangle(number)),
            Quality::Sliver => slivers.push(Spot::Triangle(number)),
            Quality::Good => {}
        }
    }
    let unused = (0..).zip(&used).filter(|&(_, used)| !used).map(|(vertex, _)| Spot::Vertex(vertex));
    Defect::record(DefectKind::UnusedVertex, unused, defects);
    Defect::record(DefectKind::MissingVertex, missing, defects);
    Defect::record(DefectKind::RepeatedVertex, repeated, defects);
    Defect::record(DefectKind::ZeroArea, flat, defects);
    Defect::record(DefectKind::Sliver, slivers, defects);
    let not_finite = (0..)
        .zip(mesh.vertices())
        .filter(|(_, position)| !position.iter().all(|coordinate| coordinate.is_finite()))
        .map(|(vertex, _)| Spot::Vertex(vertex));
    Defect::record(DefectKind::NotFinite, not_finite, defects);
    Defect::record(DefectKind::DuplicatePosition, duplicate_positions(mesh.vertices()), defects);
    Defect::record(DefectKind::DuplicateFace, duplicate_faces(&sound), defects);
    sound
}

enum Quality {
    Good,
    Sliver,
    Flat,
}

fn quality([a, b, c]: [[f64; 3]; 3]) -> Quality {
    let mut edges = [sub(b, a), sub(c, b), sub(a, c)];
    edges.sort_by(|p, q| dot(*p, *p).total_cmp(&dot(*q, *q)));
    let [_, middle, longest] = edges;
    let twice_area = length(cross(middle, longest));
    if twice_area <= ZERO_HEIGHT * dot(longest, longest) {
        return Quality::Flat;
    }
    // The least angle is opposite the shortest edge, between the two others; it is acute.
    let adjacent = dot(middle, longest).abs();
    if twice_area < SLIVER_DEGREES.to_radians().tan() * adjacent { Quality::Sliver } else { Quality::Good }
}

/// Vertices at an earlier one's position, ascending.
fn duplicate_positions(vertices: &[[f64; 3]]) -> impl Iterator<Item = Spot> {
    let mut seen = HashSet::with_capacity(vertices.len());
    // −0 is 0.
    (0..)
        .zip(vertices)
        .filter(move |(_, position)| !seen.insert(position.map(|coordinate| (coordinate + 0.0).to_bits())))
        .map(|(vertex, _)| Spot::Vertex(vertex))
}

/// Triangles of an earlier one's vertices, ascending.
fn duplicate_faces(sound: &[(u32, [u32; 3])]) -> Vec<Spot> {
    let mut keys: Vec<([u32; 3], u32)> = sound
        .iter()
        .map(|&(number, mut triangle)| {
            triangle.sort_unstable();
            (triangle, number)
        })
        .collect();
    keys.sort_unstable();
    let mut later: Vec<u32> =
        keys.array_windows().filter(|[before, this]| before.0 == this.0).map(|[_, this]| this.1).collect();
    later.sort_unstable();
    later.into_iter().map(Spot::Triangle).collect()
}

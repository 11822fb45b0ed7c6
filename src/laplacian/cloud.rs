//! Points without faces → the triangles of local triangulations (Sharp and Crane 2020, § 5.7).
//!
//! Around each point its nearest neighbours are laid into the plane that fits them best, and those triangles of their
//! Delaunay triangulation are taken that have the point as a corner. Where the points sample a surface well, each
//! triangle is found from each of its three corners, so all triangles together cover the surface three times.

mod near;
mod star;

use self::near::Tree;
use super::{
    LaplacianError,
    surface::{Surface, VERTICES_ARE, counted, first_at_position, scaled},
};
use crate::{
    mesh::{Mesh, vector::sub},
    watch::{Pulse, Stopped},
};

/// How many neighbours a local triangulation is made of, as in the reference implementation of the paper.
pub(super) const NEIGHBOURS: usize = 30;

/// By which part of the distance to its nearest neighbour a point is moved before triangles are chosen. Points of
/// a grid lie four on a circle, and neighbouring local triangulations have to decide alike; they do so less often where
/// the surface bends more. (Measured on a 40 × 80 grid on a torus: the area is 9.8 % too large with a thousandth, 0.2 %
/// with a twentieth.)
const NUDGE: f64 = 0.05;

/// The triangles around every point; a triangle may be there up to three times.
pub(super) fn surface(mesh: &Mesh, pulse: &Pulse) -> Result<Surface, LaplacianError> {
    let mut notes = Vec::new();
    let count = mesh.vertices().len();
    if count > (u32::MAX / 256) as usize {
        return Err(LaplacianError::TooLarge { triangles: 6 * count });
    }
    let (first, later) = first_at_position(mesh, pulse)?;
    if later > 0 {
        notes.push(format!("{} at the position of another one: left out", counted(later, VERTICES_ARE)));
    }
    let vertices: Vec<u32> =
        (0..).zip(&first).filter(|&(vertex, &first)| vertex == first).map(|(vertex, _)| vertex).collect();
    if vertices.len() < 3 {
        return Err(LaplacianError::NoCloud { vertices: count });
    }
    let (points, exponent) = scaled(mesh, &vertices)?;
    pulse.beat(10 * points.len())?;
    let triangles = triangles(&points, pulse)?;
    if triangles.is_empty() {
        return Err(LaplacianError::NoCloud { vertices: count });
    }
    let mut place = vec![u32::MAX; points.len()];
    triangles.iter().flatten().for_each(|&point| place[point as usize] = 0);
    let used: Vec<u32> = (0..points.len() as u32).filter(|&point| place[point as usize] == 0).collect();
    if used.len() < points.len() {
        notes.push(format!("{} in no triangle: left out", counted(points.len() - used.len(), VERTICES_ARE)));
    }
    for (at, &point) in (0..).zip(&used) {
        place[point as usize] = at;
    }
    pulse.beat(6 * triangles.len())?;
    let triangles: Vec<_> = triangles.into_iter().map(|triangle| triangle.map(|point| place[point as usize])).collect();
    pulse.beat(6 * triangles.len())?;
    Ok(Surface {
        points: used.iter().map(|&point| points[point as usize]).collect(),
        triangles,
        vertices: used.iter().map(|&point| vertices[point as usize]).collect(),
        exponent,
        notes,
    })
}

fn triangles(points: &[[f64; 3]], pulse: &Pulse) -> Result<Vec<[u32; 3]>, Stopped> {
    let tree = Tree::new(points, pulse)?;
    let mut found = Vec::new();
    let mut nudged: Vec<[f64; 3]> = Vec::with_capacity(points.len());
    for at in 0..points.len() as u32 {
        tree.nearest(points[at as usize], 2, &mut found);
        let reach = found.iter().find(|near| near.1 != at).map_or(0.0, |near| near.0.sqrt());
        nudged.push(nudge(points[at as usize], NUDGE * reach));
        pulse.beat(400)?;
    }
    let mut triangles = Vec::with_capacity(6 * points.len());
    let mut ring = Vec::new();
    for at in 0..points.len() as u32 {
        tree.nearest(points[at as usize], NEIGHBOURS + 1, &mut found);
        ring.clear();
        let arm = |ends: &[[f64; 3]], to: u32| sub(ends[to as usize], ends[at as usize]);
        let others = found.iter().map(|near| near.1).filter(|&other| other != at);
        ring.extend(others.map(|other| (other, arm(points, other), arm(&nudged, other))));
        star::star(&ring, |b, c| triangles.push([at, b, c]));
        pulse.beat(8000)?;
    }
    Ok(triangles)
}

/// The point moved by less than `by` along each axis, in a way that depends on nothing but the point.
fn nudge(point: [f64; 3], by: f64) -> [f64; 3] {
    let mut state = point.iter().fold(0_u64, |state, x| (state ^ x.to_bits()).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    point.map(|x| {
        // SplitMix64.
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^= z >> 31;
        x + by * ((z >> 11) as f64 / (1_u64 << 52) as f64 - 1.0)
    })
}

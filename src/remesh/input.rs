//! Mesh → half-edges, or the reason why it is no manifold.
//!
//! Every loop of the boundary is closed by a fan of triangles around a vertex that is not there, its ghost. The moves
//! on edges then need to know nothing of boundaries: that two boundary vertices must not meet across the surface is
//! that they have the ghost in common, and a loop lives as long as its ghost.

use std::ops::Range;

use super::RemeshError;
use crate::{
    mesh::{
        Mesh,
        by_vertex::ByVertex,
        halfedge::{HalfEdges, sides, triangle_of},
        vector::V3,
    },
    watch::{Pulse, Stopped},
};

const NONE: u32 = u32::MAX;

/// A mesh that can be worked on.
pub(super) struct Input {
    pub(super) mesh: HalfEdges,
    /// Triangles from here on belong to ghosts.
    pub(super) faces: u32,
    /// The vertices that stand for the loops of the boundary.
    pub(super) ghosts: Range<u32>,
}

/// Checks the mesh and takes it over in its canonical order.
pub(super) fn take(mesh: &Mesh, pulse: &Pulse) -> Result<Input, RemeshError> {
    if mesh.vertices().iter().flatten().any(|coordinate| !coordinate.is_finite()) {
        return Err(RemeshError::NotFinite);
    }
    let mesh = mesh.canonical_watched(pulse)?;
    let points: Vec<V3> = mesh.vertices().iter().map(|&p| p.into()).collect();
    let mut triangles = mesh.triangles().to_vec();
    triangles.retain(|[a, b, c]| a != b && b != c && c != a);
    if triangles.is_empty() {
        return Err(RemeshError::NoArea);
    }
    pulse.beat(10 * triangles.len())?;
    let mut mates = mates(&points, &triangles, pulse)?;
    let faces = triangles.len() as u32;
    let (mut mesh, ghosts) = if is_oriented_and_closed(&triangles, &mates, pulse)? {
        let ghosts = points.len() as u32..points.len() as u32;
        (HalfEdges::of_twins(points, &triangles, &mates, pulse)?, ghosts)
    } else {
        orient(&points, &mut triangles, &mut mates, pulse)?;
        let ghosts = close(&points, &mut triangles, &mates, pulse)?;
        let mut all = points;
        all.resize(ghosts.end as usize, V3::default());
        // Every edge has its two sides by now.
        let Some(mesh) = HalfEdges::new(all, &triangles, pulse)? else { return Err(RemeshError::NoArea) };
        (mesh, ghosts)
    };
    let degrees = degrees(ghosts.end as usize, &triangles, pulse)?;
    for a in (0..mesh.vertex_slots()).filter(|&a| mesh.has_vertex(a)) {
        pulse.beat(30)?;
        if mesh.degree(a) != degrees[a as usize] as usize {
            return Err(RemeshError::Vertex { at: mesh.point(a).into() });
        }
    }
    for triangle in 0..mesh.triangle_slots() {
        pulse.beat(24)?;
        for h in sides(triangle) {
            let t = mesh.twin(h);
            if mesh.apex(h) == mesh.apex(t) {
                return Err(RemeshError::Doubled { at: mesh.point(mesh.start(h)).into() });
            }
            if (triangle < faces) != (triangle_of(t) < faces) {
                mesh.mark(h, true);
            }
        }
    }
    Ok(Input { mesh, faces, ghosts })
}

fn degrees(points: usize, triangles: &[[u32; 3]], pulse: &Pulse) -> Result<Vec<u32>, Stopped> {
    let mut degrees = vec![0; points];
    for &a in triangles.as_flattened() {
        degrees[a as usize] += 1;
        pulse.beat(2)?;
    }
    Ok(degrees)
}

/// The half-edge from corner `h` to the next of its triangle.
fn ends(triangles: &[[u32; 3]], h: u32) -> (u32, u32) {
    let [triangle, corner] = [h / 3, h % 3].map(|x| x as usize);
    (triangles[triangle][corner], triangles[triangle][(corner + 1) % 3])
}

/// For each half-edge the one of the other triangle at its edge, in whatever direction; `NONE` at the boundary.
fn mates(points: &[V3], triangles: &[[u32; 3]], pulse: &Pulse) -> Result<Vec<u32>, RemeshError> {
    let count = 3 * triangles.len() as u32;
    let by_low = || {
        (0..).step_by(3).zip(triangles).flat_map(|(h, &[a, b, c])| {
            [(a, b, h), (b, c, h + 1), (c, a, h + 2)].map(|(a, b, h): (u32, u32, u32)| (a.min(b), (a.max(b), h)))
        })
    };
    let mut fans = ByVertex::new(points.len(), by_low, pulse)?;
    let mut mates = vec![NONE; count as usize];
    for (a, edges) in fans.lists().enumerate() {
        edges.sort_unstable();
        pulse.beat(30 * edges.len())?;
        for edge in edges.chunk_by(|x, y| x.0 == y.0) {
            match *edge {
                [_] => {}
                [(_, h), (_, t)] => {
                    mates[h as usize] = t;
                    mates[t as usize] = h;
                }
                _ => {
                    let at = points[a].lerp(points[edge[0].0 as usize], 0.5);
                    return Err(RemeshError::Edge { faces: edge.len(), at: at.into() });
                }
            }
        }
    }
    Ok(mates)
}

/// Whether each half-edge has a mate that goes back.
fn is_oriented_and_closed(triangles: &[[u32; 3]], mates: &[u32], pulse: &Pulse) -> Result<bool, Stopped> {
    for (h, &mate) in (0..).zip(mates) {
        pulse.beat(5)?;
        if mate == NONE || ends(triangles, h).0 == ends(triangles, mate).0 {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Turns triangles round so that all of a component agree with its first. Of `mates`, only which are `NONE` holds
/// after.
fn orient(points: &[V3], triangles: &mut [[u32; 3]], mates: &mut [u32], pulse: &Pulse) -> Result<(), RemeshError> {
    let mut turned: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut open = Vec::new();
    for seed in 0..triangles.len() {
        if turned[seed].is_some() {
            continue;
        }
        turned[seed] = Some(false);
        open.push(seed as u32);
        while let Some(face) = open.pop() {
            let mine = turned[face as usize] == Some(true);
            pulse.beat(40)?;
            for h in 3 * face..3 * face + 3 {
                let mate = mates[h as usize];
                if mate == NONE {
                    continue;
                }
                let (a, b) = ends(triangles, h);
                let its = mine != (a == ends(triangles, mate).0);
                match &mut turned[mate as usize / 3] {
                    Some(known) if *known != its => {
                        let at = points[a as usize].lerp(points[b as usize], 0.5);
                        return Err(RemeshError::OneSided { at: at.into() });
                    }
                    Some(_) => {}
                    unknown @ None => {
                        *unknown = Some(its);
                        open.push(mate / 3);
                    }
                }
            }
        }
    }
    for (face, turned) in turned.into_iter().enumerate() {
        if turned == Some(true) {
            // The edge between the two keeps its slot, the others change theirs.
            triangles[face].swap(0, 1);
            mates.swap(3 * face + 1, 3 * face + 2);
        }
    }
    Ok(())
}

/// Adds a ghost and its triangles for every loop of the boundary; gives the ghosts.
fn close(
    points: &[V3],
    triangles: &mut Vec<[u32; 3]>,
    mates: &[u32],
    pulse: &Pulse,
) -> Result<Range<u32>, RemeshError> {
    let first = points.len() as u32;
    // The next vertex along the boundary.
    let mut after = vec![NONE; points.len()];
    let faces = triangles.len();
    for face in 0..faces {
        let [a, b, c] = triangles[face];
        pulse.beat(6)?;
        for (corner, (x, y)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
            let free = mates[3 * face + corner] == NONE;
            if free && std::mem::replace(&mut after[x as usize], y) != NONE {
                return Err(RemeshError::Vertex { at: points[x as usize].into() });
            }
        }
    }
    let mut ghost = first;
    for seed in 0..points.len() {
        if after[seed] == NONE {
            continue;
        }
        let mut a = seed as u32;
        while after[a as usize] != NONE {
            let b = std::mem::replace(&mut after[a as usize], NONE);
            triangles.push([b, a, ghost]);
            pulse.beat(5)?;
            a = b;
        }
        ghost += 1;
    }
    Ok(first..ghost)
}

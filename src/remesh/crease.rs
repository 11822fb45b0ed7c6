//! Which edges of the input are creases, and where creases meet, bend or end.
//!
//! A crease is sharp and stays so when looked at from as far as the edges to come are long: the surface is about flat
//! on both of its sides. A thin limb of few triangles has sharp edges too, but turns on beside them; it is round.

use super::surface::Surface;
use crate::{
    mesh::{
        halfedge::{HalfEdges, next, sides, triangle_of},
        vector::V3,
    },
    watch::{Pulse, Stopped},
};

/// Cosine of the angle between the normals from which on an edge is sharp: 45°.
const SHARP: f64 = 0.71;
/// Cosine of the angle by which the normal may turn within [`BESIDE`] of a crease: 30°.
const FLAT: f64 = 0.87;
/// How far beside an edge the surface must be flat, in wanted edges.
const BESIDE: f64 = 1.2;
/// Cosine of the angle by which a crease turns in a corner: 72°.
const BEND: f64 = 0.3;
/// Cosine of the angle between two creases below which one of them is none: 35°.
const ACUTE: f64 = 0.82;
/// Creases shorter than this many wanted edges are none.
const SHORT: f64 = 6.0;

/// Marks the creases of the surface besides its boundary, which is marked already, and tells it the corners.
///
/// `length` is that of the edges to come: what is too short for them is no crease but noise.
///
/// # Errors
/// When the watch cancels.
pub(super) fn find(surface: &mut Surface, length: f64, pulse: &Pulse) -> Result<(), Stopped> {
    let mut sharp = Vec::new();
    for triangle in 0..surface.mesh.triangle_slots() {
        pulse.beat(40)?;
        for h in sides(triangle) {
            if surface.mesh.is_edge(h) && !surface.mesh.is_marked(h) && is_crease(surface, h, length, pulse)? {
                sharp.push(h);
            }
        }
    }
    let mesh = &mut surface.mesh;
    for &h in &sharp {
        mesh.mark(h, true);
    }
    forget_forks(mesh, &sharp, pulse)?;
    forget_ends(mesh, &sharp, SHORT * length, pulse)?;
    forget_short(mesh, &sharp, SHORT * length, pulse)?;
    surface.set_creases(is_corner, pulse)
}

/// Whether an edge within the surface is sharp, and the surface flat on both sides.
fn is_crease(surface: &Surface, h: u32, length: f64, pulse: &Pulse) -> Result<bool, Stopped> {
    let t = surface.mesh.twin(h);
    if !surface.is_real(h) || !surface.is_real(t) {
        return Ok(false);
    }
    let ((one, n1), (two, n2)) = (surface.span(triangle_of(h)), surface.span(triangle_of(t)));
    if one.dot(two) >= SHARP * n1 * n2 || n1 <= 0.0 || n2 <= 0.0 {
        return Ok(false);
    }
    pulse.beat(2000)?;
    let mesh = &surface.mesh;
    let (p, q) = (mesh.point(mesh.start(h)), mesh.point(mesh.start(next(h))));
    let (middle, along) = (p.lerp(q, 0.5), q - p);
    Ok([(h, one), (t, two)].into_iter().all(|(side, normal)| {
        // Into the triangle, at a right angle to the edge.
        let inwards = if side == h { normal.cross(along) } else { along.cross(normal) }.unit();
        [0.5, 1.0].into_iter().all(|share| {
            let (_, face) = surface.nearest_point(middle + inwards * (share * BESIDE * length), side);
            let there: V3 = surface.face_normal(face);
            there.dot(normal) > FLAT * there.norm() * normal.norm()
        })
    }))
}

/// Takes away the mark of the blunter one of two creases that leave a vertex at an acute angle: no even triangle fits
/// between them.
fn forget_forks(mesh: &mut HalfEdges, sharp: &[u32], pulse: &Pulse) -> Result<(), Stopped> {
    for &h in sharp {
        pulse.beat(300)?;
        for side in [h, mesh.twin(h)] {
            let a = mesh.start(side);
            let along = |o: u32| (mesh.point(mesh.end(o)) - mesh.point(a)).unit();
            let fork = mesh.around(a).any(|o| {
                o != side && mesh.is_marked(o) && along(o).dot(along(side)) > ACUTE && bend(mesh, o) < bend(mesh, side)
            });
            if fork {
                mesh.mark(h, false);
            }
        }
    }
    Ok(())
}

/// Cosine of the dihedral angle's supplement: less, the sharper.
fn bend(mesh: &HalfEdges, h: u32) -> f64 {
    let normal = |side: u32| {
        let [p, q, r] = [mesh.start(side), mesh.end(side), mesh.apex(side)].map(|a| mesh.point(a));
        (q - p).cross(r - p).unit()
    };
    normal(h).dot(normal(mesh.twin(h)))
}

/// Takes away the marks of creases shorter than `least` that end in nothing.
fn forget_ends(mesh: &mut HalfEdges, sharp: &[u32], least: f64, pulse: &Pulse) -> Result<(), Stopped> {
    let degree = |mesh: &HalfEdges, a: u32| mesh.around(a).filter(|&o| mesh.is_marked(o)).count();
    for &h in sharp {
        pulse.beat(100)?;
        for side in [h, mesh.twin(h)] {
            if !mesh.is_marked(side) || degree(mesh, mesh.start(side)) != 1 {
                continue;
            }
            // From the end to where it meets others.
            let (mut branch, mut sum, mut at) = (vec![side], mesh.length(side), side);
            while sum < least && degree(mesh, mesh.end(at)) == 2 {
                pulse.beat(50)?;
                let back = mesh.twin(at);
                let Some(on) = mesh.around(mesh.end(at)).find(|&o| mesh.is_marked(o) && o != back) else { break };
                sum += mesh.length(on);
                branch.push(on);
                at = on;
            }
            if sum < least {
                for o in branch {
                    mesh.mark(o, false);
                }
            }
        }
    }
    Ok(())
}

/// Takes away the marks of the connected pieces of creases that are shorter than `least`.
fn forget_short(mesh: &mut HalfEdges, sharp: &[u32], least: f64, pulse: &Pulse) -> Result<(), Stopped> {
    let mut seen = vec![false; mesh.vertex_slots() as usize];
    for &h in sharp {
        let seed = mesh.start(h);
        if std::mem::replace(&mut seen[seed as usize], true) {
            continue;
        }
        let (mut open, mut piece, mut sum) = (vec![seed], Vec::new(), 0.0);
        while let Some(a) = open.pop() {
            pulse.beat(60)?;
            for o in mesh.around(a).filter(|&o| mesh.is_marked(o)) {
                piece.push(o);
                sum += 0.5 * mesh.length(o);
                if !std::mem::replace(&mut seen[mesh.end(o) as usize], true) {
                    open.push(mesh.end(o));
                }
            }
        }
        if sum < least {
            for o in piece {
                pulse.beat(20)?;
                // The boundary stays.
                if sharp.binary_search(&o.min(mesh.twin(o))).is_ok() {
                    mesh.mark(o, false);
                }
            }
        }
    }
    Ok(())
}

/// Whether creases meet, bend or end in a vertex.
fn is_corner(mesh: &HalfEdges, a: u32) -> bool {
    let mut creases = mesh.around(a).filter(|&h| mesh.is_marked(h));
    match [creases.next(), creases.next(), creases.next()] {
        [None, ..] => false,
        [Some(h), Some(o), None] => {
            let here = mesh.point(a);
            let (one, two) = ((mesh.point(mesh.end(h)) - here).unit(), (here - mesh.point(mesh.end(o))).unit());
            one.dot(two) < BEND
        }
        _ => true,
    }
}

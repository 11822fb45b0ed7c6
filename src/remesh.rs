//! Mesh → a mesh of the same surface with a given number of vertices, evenly spread, its triangles near equilateral.
//!
//! ```text
//! mesh ─► input ─────► surface ───────► rounds of split, collapse, ─► exact count ─► flip, relax, ─► area ─► mesh
//!         manifold?    creases, sizes   flip, relax                                  mend
//! ```
//!
//! The rounds are those of Botsch and Kobbelt (*A Remeshing Approach to Multiresolution Modeling*, 2004). Every
//! vertex knows where on the input it lies, and a new or moved one walks from there to the nearest point near by,
//! so all vertices lie on the input's surface; only at the very end free ones are moved a little off it, so that
//! the area is that of the input. Sharp edges and boundaries are lines that vertices only move along; where lines
//! meet, bend or end, vertices stay. The moves on edges keep the topology by construction: a closed manifold stays
//! one, with its components and their genus, and a boundary keeps its loops.
//!
//! Edges are of one length but where that would cost a limb its tip or a tube its area: there they are as short as
//! it takes, to a tenth of the others, and grow longer gradually. So many vertices as that may take is bounded: the
//! others' edges come out longer by 30 % at most. What area is still lost on relief that is finer than the triangles
//! is given back by making the relief a little stronger.
//!
//! The arithmetic is IEEE's own (`+ − × ÷ √`) in one fixed order, so the result depends on the canonical form of the
//! mesh and the count alone: not on the platform, the order of the file, or other threads.

pub mod quality;

use std::ops::RangeInclusive;

use crate::{
    mesh::{Mesh, halfedge::AREA_PER_VERTEX},
    watch::{Pulse, Stopped, Watch},
};

use self::{input::Input, surface::Surface, work::Work};

mod count;
mod crease;
mod edge;
mod flip;
mod input;
mod relax;
mod set;
mod shape;
mod sizing;
mod surface;
#[cfg(test)]
mod tests;
mod work;

/// Numbers of vertices that can be asked for.
pub const VERTICES: RangeInclusive<usize> = 12..=2_000_000;

/// The usual number of vertices to ask for.
pub const USUAL: usize = 10_000;

/// Changes whenever another version of this code gives other meshes; part of the key of what is computed of them.
pub const KERNEL: u32 = 3;

/// Why a mesh was not re-meshed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RemeshError {
    /// The watch said so.
    #[error("interrupted")]
    Cancelled,
    /// The number asked for is out of [`VERTICES`].
    #[error("{count} vertices cannot be asked for: from {} to {}", VERTICES.start(), VERTICES.end())]
    Count {
        /// That number.
        count: usize,
    },
    /// There is no triangle with an area.
    #[error("no face has an area")]
    NoArea,
    /// A coordinate is not finite, or a triangle names a vertex that does not exist.
    #[error("some coordinates are not finite, or so large that their products are not")]
    NotFinite,
    /// Three or more triangles share an edge.
    #[error("cannot be re-meshed: not a manifold: {faces} faces share the edge at {}", place(.at))]
    Edge {
        /// How many.
        faces: usize,
        /// The middle of the edge.
        at: [f64; 3],
    },
    /// Surfaces touch in a vertex without sharing an edge there.
    #[error("cannot be re-meshed: not a manifold: surfaces touch in the vertex at {}", place(.at))]
    Vertex {
        /// The vertex.
        at: [f64; 3],
    },
    /// Two triangles lie on the same three vertices.
    #[error("cannot be re-meshed: two faces have the same corners, one of them at {}", place(.at))]
    Doubled {
        /// The corner.
        at: [f64; 3],
    },
    /// The surface has one side, as a Möbius strip.
    #[error("cannot be re-meshed: the surface has one side only (found at {})", place(.at))]
    OneSided {
        /// The middle of an edge where the sides meet.
        at: [f64; 3],
    },
    /// Fewer vertices would change the surface's topology.
    #[error("cannot be re-meshed to {wanted} vertices: its pieces, holes and handles need {least}")]
    TooFew {
        /// How many were asked for.
        wanted: usize,
        /// How many were left when no edge could be collapsed any more.
        least: usize,
    },
}

impl From<Stopped> for RemeshError {
    fn from(Stopped: Stopped) -> Self {
        Self::Cancelled
    }
}

fn place(at: &[f64; 3]) -> String {
    format!("({}, {}, {})", at[0], at[1], at[2])
}

/// The surface of `mesh` with `count` vertices, in its canonical form.
///
/// Faces that name a vertex twice are left out, faces without an area are surface like others. Orientations that
/// disagree are made to agree. A surface with a boundary keeps its loops. The progress is told in steps of equal cost,
/// about.
///
/// # Errors
/// [`RemeshError`]: the mesh is not a manifold, or the count cannot be had.
pub fn remesh(mesh: &Mesh, count: usize, watch: &dyn Watch) -> Result<Mesh, RemeshError> {
    if !VERTICES.contains(&count) {
        return Err(RemeshError::Count { count });
    }
    let pulse = &Pulse::new(watch);
    let Input { mesh, faces, ghosts } = input::take(mesh, pulse)?;
    let mut surface = Surface::new(mesh, faces, pulse)?;
    let area = surface.area(pulse)?;
    if !area.is_finite() {
        return Err(RemeshError::NotFinite);
    }
    if area <= 0.0 {
        return Err(RemeshError::NoArea);
    }
    let length = (area / (AREA_PER_VERTEX * count as f64)).sqrt();
    crease::find(&mut surface, length, pulse)?;
    surface.set_limits(sizing::find(&surface, length, pulse)?);
    let work = Work::new(&surface, ghosts.clone(), length, pulse)?;
    let mesh = work.run(count, watch)?;
    let (points, triangles) = mesh.parts(ghosts);
    let result = Mesh::new(points.into_iter().map(Into::into).collect(), triangles);
    Ok(result.canonical_watched(pulse)?)
}

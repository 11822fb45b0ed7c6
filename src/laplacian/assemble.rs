//! From a mesh and a choice to L and B.

use thiserror::Error;

use super::{
    Boundary, Choice, Laplacian, Triangulation,
    cloud::{self, NEIGHBOURS},
    cover::{Rims, cover},
    element::element,
    joins::Joins,
    restrict::{on_boundary, restrict},
    surface::{Extent, Surface, first_at_position},
};
use crate::{
    mesh::Mesh,
    watch::{Pulse, Stopped, Unwatched, Watch},
};

/// Why a mesh has no Laplacian.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LaplacianError {
    /// The watch said so.
    #[error(transparent)]
    Cancelled(#[from] Stopped),
    /// There is nothing to integrate over.
    #[error("the mesh has no triangle with three distinct vertices")]
    Empty,
    /// Points without faces, where triangles of the mesh were asked for.
    #[error("there are no faces, only {vertices} vertices: points need the triangulation auto or tufted")]
    NoFaces {
        /// How many vertices there are.
        vertices: usize,
    },
    /// Points among which no triangle can be made.
    #[error("there are no faces, and no triangles can be made of the {vertices} vertices")]
    NoCloud {
        /// How many vertices there are.
        vertices: usize,
    },
    /// A boundary condition for points.
    #[error("there are no faces: points have no boundary for a Dirichlet condition")]
    CloudBoundary,
    /// The Dirichlet condition leaves nothing.
    #[error("every vertex is on the boundary, where the Dirichlet condition holds it at zero")]
    AllHeld,
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {vertices}")]
    OutOfRange {
        /// 0-based position of the triangle.
        triangle: usize,
        /// The 0-based index it names.
        vertex: u32,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} has a coordinate that is not finite")]
    NotFinite {
        /// 0-based position of the vertex.
        vertex: usize,
    },
    /// All used vertices are at one point, or so far apart that squares of lengths leave the range of numbers.
    #[error("the mesh extends over {extent:e}, outside of 1e-140 to 1e140")]
    Extent {
        /// The largest side of its bounding box, as text so that the error is comparable.
        extent: Extent,
    },
    /// More triangles than indices.
    #[error("the mesh has {triangles} triangles, more than fit")]
    TooLarge {
        /// How many.
        triangles: usize,
    },
}

/// L and B of a mesh: `L_ij = −(cot α + cot β)/2` over the angles opposite of the edge, rows summing to zero, and the
/// mass matrix that the choice names (for [`Operator::Cot`](super::Operator::Cot) the identity), over the triangles and
/// with the boundary condition that it names.
///
/// # Errors
/// When the mesh has no proper triangle, an index out of range, a used vertex that is not finite, or an extent whose
/// square is not a number; when a Dirichlet condition leaves no vertex; when points without faces are to be taken as
/// a mesh, or make no triangle.
pub fn assemble(mesh: &Mesh, choice: Choice) -> Result<Laplacian, LaplacianError> {
    assemble_watched(mesh, choice, &Unwatched)
}

/// [`assemble()`] that ends soon after the watch cancels.
///
/// # Errors
/// As [`assemble()`], and when the watch cancels.
pub fn assemble_watched(mesh: &Mesh, choice: Choice, watch: &dyn Watch) -> Result<Laplacian, LaplacianError> {
    let pulse = &Pulse::new(watch);
    if mesh.triangles().is_empty() && !mesh.vertices().is_empty() {
        return of_points(mesh, choice, pulse);
    }
    let soup = choice.triangulation == Triangulation::Auto && is_soup(mesh, pulse)?;
    let mut surface = Surface::of(mesh, soup || choice.triangulation == Triangulation::Tufted, pulse)?;
    if soup {
        surface.notes.insert(0, "a soup of faces that share no vertices".to_owned());
    }
    let joins = match choice.triangulation {
        Triangulation::Auto | Triangulation::Given => as_given(&mut surface, pulse)?,
        Triangulation::Delaunay => intrinsic(&mut surface, Rims::Open, 1.0, pulse)?,
        Triangulation::Tufted => intrinsic(&mut surface, Rims::Tufted, 1.0, pulse)?,
    };
    let held = match choice.boundary {
        Boundary::Dirichlet => Some(on_boundary(surface.points.len(), &surface.triangles, pulse)?),
        Boundary::Neumann => None,
    };
    let whole = finish(surface, joins, choice, pulse)?;
    pulse.ask()?;
    match held {
        Some(held) => restrict(whole, &held, pulse),
        None => Ok(whole),
    }
}

/// The same for points without faces.
fn of_points(mesh: &Mesh, choice: Choice, pulse: &Pulse) -> Result<Laplacian, LaplacianError> {
    let vertices = mesh.vertices().len();
    if matches!(choice.triangulation, Triangulation::Given | Triangulation::Delaunay) {
        return Err(LaplacianError::NoFaces { vertices });
    }
    if choice.boundary == Boundary::Dirichlet {
        return Err(LaplacianError::CloudBoundary);
    }
    let mut surface = cloud::surface(mesh, pulse)?;
    surface.notes.insert(
        0,
        format!(
            "point cloud: {} local triangulations of {NEIGHBOURS} neighbours each, {} triangles, each counting a third",
            surface.points.len(),
            surface.triangles.len()
        ),
    );
    // A triangle is there once for each of its corners, where these agree on it.
    let joins = intrinsic(&mut surface, Rims::Tufted, 3.0, pulse)?;
    Ok(finish(surface, joins, choice, pulse)?)
}

/// Whether faces hang together by the positions of their vertices, not by their numbers: so many vertices that most
/// faces share none, most of them at the position of an earlier one.
fn is_soup(mesh: &Mesh, pulse: &Pulse) -> Result<bool, Stopped> {
    let vertices = mesh.vertices().len();
    if vertices < 2 * mesh.triangles().len() {
        return Ok(false);
    }
    let later = first_at_position(mesh, pulse)?.1;
    Ok(later > vertices / 2 && vertices - later > 2)
}

/// The faces as they are; flat ones get a metric of their own.
fn as_given(surface: &mut Surface, pulse: &Pulse) -> Result<Joins, Stopped> {
    let (mean, longest) = surface.edge_lengths(pulse)?;
    let floor = if mean > 0.0 { 1e-3 * mean } else { longest };
    let mut flat = 0_usize;
    let mut joins = Joins::new(surface.points.len(), surface.triangles.len());
    for corners in &surface.triangles {
        let found = element(corners.map(|corner| surface.points[corner as usize]), floor);
        pulse.beat(40)?;
        flat += usize::from(found.mollified);
        joins.add(*corners, found.cotangents.map(|cotangent| 0.5 * cotangent), found.area);
    }
    if flat > 0 {
        let faces = surface.triangles.len();
        surface.notes.push(format!("{flat} of {faces} faces have no area: their edge lengths were mollified"));
    }
    Ok(joins)
}

/// The triangles after edges were flipped to Delaunay; each counts one `layers`-th.
fn intrinsic(surface: &mut Surface, rims: Rims, layers: f64, pulse: &Pulse) -> Result<Joins, Stopped> {
    let cover = cover(surface, rims, pulse)?;
    let mut glued = cover.glued;
    let opened = glued.mollify(pulse)?;
    let flips = glued.flip_to_delaunay(pulse)?;
    let notes = &mut surface.notes;
    notes.push(match rims {
        Rims::Open => {
            format!("intrinsic Delaunay triangulation: {} edges flipped", flips.count / cover.sheets as usize)
        }
        Rims::Tufted => format!("tufted cover, intrinsic Delaunay triangulation: {} edges flipped", flips.count),
    });
    if opened > 0.0 {
        let length = opened * 2_f64.powi(surface.exponent);
        notes.push(format!("faces without area: all edges were lengthened by {length:.1e} (mollification)"));
    }
    if !flips.complete {
        notes.push("flipping ended before all edges were Delaunay".to_owned());
    }
    let share = 1.0 / (layers * f64::from(cover.sheets));
    let mut joins = Joins::new(surface.points.len(), glued.corners.len());
    for (corners, found) in glued.elements() {
        joins.add(corners, found.cotangents.map(|cotangent| 0.5 * share * cotangent), share * found.area);
        pulse.beat(40)?;
    }
    Ok(joins)
}

fn finish(surface: Surface, joins: Joins, choice: Choice, pulse: &Pulse) -> Result<Laplacian, Stopped> {
    let (component, components) = surface.components(pulse)?;
    let Surface { vertices, exponent, mut notes, .. } = surface;
    if components > 1 {
        notes.push(format!("{components} connected components: as many zeros"));
    }
    let matrix = joins.finish(choice, pulse)?;
    let total = matrix.total_mass();
    pulse.beat(4 * matrix.rows.len())?;
    Ok(Laplacian { matrix, vertices, component, components, total, exponent, notes })
}

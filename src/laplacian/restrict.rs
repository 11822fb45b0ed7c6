//! The Dirichlet condition: rows of boundary vertices are left out.

use super::{Laplacian, LaplacianError, surface::components};
use crate::watch::{Pulse, Stopped};

/// True for each point on an edge of exactly one triangle.
///
/// # Errors
/// When the watch cancels.
pub(super) fn on_boundary(points: usize, triangles: &[[u32; 3]], pulse: &Pulse) -> Result<Vec<bool>, Stopped> {
    let mut edges: Vec<(u32, u32)> =
        triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).map(|(a, b)| (a.min(b), a.max(b))).collect();
    pulse.sort(&mut edges, &Ord::cmp)?;
    let mut on = vec![false; points];
    for edge in edges.chunk_by(|a, b| a == b).filter(|edge| edge.len() == 1) {
        on[edge[0].0 as usize] = true;
        on[edge[0].1 as usize] = true;
    }
    Ok(on)
}

/// The same eigenproblem for functions that are zero at the rows that are `out`.
///
/// # Errors
/// When no row is left.
pub(super) fn restrict(whole: Laplacian, out: &[bool], pulse: &Pulse) -> Result<Laplacian, LaplacianError> {
    let held_rows = out.iter().filter(|&&out| out).count();
    let mut notes = whole.notes;
    if held_rows == 0 {
        notes.push("there is no boundary: the Dirichlet condition changes nothing".to_owned());
        return Ok(Laplacian { notes, ..whole });
    }
    if held_rows == out.len() {
        return Err(LaplacianError::AllHeld);
    }
    let keep: Vec<u32> = (0..out.len() as u32).filter(|&row| !out[row as usize]).collect();
    let matrix = whole.matrix.select(&keep, pulse)?;
    let off_diagonal = matrix.entries().map(|(row, column, ..)| (row as u32, column as u32));
    let (component, components) = components(keep.len(), off_diagonal, pulse)?;
    notes.retain(|note| !note.ends_with("as many zeros"));
    notes.push(format!("{held_rows} boundary vertices are held at zero"));
    if components > 1 {
        notes.push(format!("{components} connected components of other vertices: zeros for those without boundary"));
    }
    let vertices = keep.iter().map(|&row| whole.vertices[row as usize]).collect();
    Ok(Laplacian { matrix, vertices, component, components, notes, ..whole })
}

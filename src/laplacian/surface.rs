//! A mesh made ready: no face twice, no vertex unused, coordinates near one.

use std::collections::HashMap;

use super::LaplacianError;
use crate::{
    mesh::{
        Mesh,
        vector::{length, sub},
    },
    watch::{Pulse, Stopped},
};

/// A length inside of an error; equal when its bits are.
#[derive(Debug, Clone, Copy)]
pub struct Extent(pub f64);

impl PartialEq for Extent {
    fn eq(&self, other: &Self) -> bool {
        self.0.to_bits() == other.0.to_bits()
    }
}

impl Eq for Extent {}

impl std::fmt::LowerExp for Extent {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.0.fmt(f)
    }
}

/// Points and triangles, with what was done to have them.
#[derive(Debug)]
pub(super) struct Surface {
    /// Positions over 2^`exponent`.
    pub points: Vec<[f64; 3]>,
    /// Triangles of three different points; every point is in one.
    pub triangles: Vec<[u32; 3]>,
    /// Which vertex of the mesh each point is, ascending.
    pub vertices: Vec<u32>,
    /// The coordinates were divided by two to this power.
    pub exponent: i32,
    /// What was done, one line each.
    pub notes: Vec<String>,
}

impl Surface {
    /// The faces of a mesh; with `weld`, vertices at one position are one.
    pub(super) fn of(mesh: &Mesh, weld: bool, pulse: &Pulse) -> Result<Self, LaplacianError> {
        let mut notes = Vec::new();
        let mut triangles = in_range(mesh)?;
        if weld {
            join(mesh, &mut triangles, &mut notes, pulse)?;
        }
        pulse.beat(4 * triangles.len())?;
        let triangles = distinct(proper(triangles, &mut notes)?, &mut notes, pulse)?;
        let (vertices, triangles) = compact(mesh, triangles, weld, &mut notes);
        pulse.beat(10 * triangles.len())?;
        let (points, exponent) = scaled(mesh, &vertices)?;
        pulse.beat(10 * points.len())?;
        Ok(Self { points, triangles, vertices, exponent, notes })
    }

    /// Mean and largest edge length over the triangles.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn edge_lengths(&self, pulse: &Pulse) -> Result<(f64, f64), Stopped> {
        let mut sum = 0.0;
        let mut longest = 0.0_f64;
        for triangle in &self.triangles {
            for at in 0..3 {
                let length = self.distance(triangle[at], triangle[(at + 1) % 3]);
                sum += length;
                longest = longest.max(length);
            }
            pulse.beat(20)?;
        }
        Ok((sum / (3 * self.triangles.len()) as f64, longest))
    }

    /// The distance of two points.
    pub(super) fn distance(&self, a: u32, b: u32) -> f64 {
        length(sub(self.points[a as usize], self.points[b as usize]))
    }

    /// Connected components of the points through triangles, numbered by their first point, and how many.
    ///
    /// # Errors
    /// When the watch cancels.
    pub(super) fn components(&self, pulse: &Pulse) -> Result<(Vec<u32>, usize), Stopped> {
        components(self.points.len(), self.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (a, c)]), pulse)
    }
}

/// The triangles, if all their vertices exist and there are not too many.
fn in_range(mesh: &Mesh) -> Result<Vec<[u32; 3]>, LaplacianError> {
    let count = mesh.vertices().len();
    if mesh.triangles().len() > (u32::MAX / 4) as usize || count > (u32::MAX / 4) as usize {
        return Err(LaplacianError::TooLarge { triangles: mesh.triangles().len() });
    }
    for (at, &triangle) in mesh.triangles().iter().enumerate() {
        if let Some(&vertex) = triangle.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(LaplacianError::OutOfRange { triangle: at, vertex, vertices: count });
        }
    }
    Ok(mesh.triangles().to_vec())
}

/// Numbers vertices at one position by the first of them.
pub(super) fn first_at_position(mesh: &Mesh, pulse: &Pulse) -> Result<(Vec<u32>, usize), Stopped> {
    let mut seen = HashMap::with_capacity(mesh.vertices().len());
    let mut later = 0;
    let mut all = Vec::with_capacity(mesh.vertices().len());
    for (vertex, position) in (0..).zip(mesh.vertices()) {
        // Adding 0 turns −0 into 0.
        let key = position.map(|coordinate| (coordinate + 0.0).to_bits());
        let first = *seen.entry(key).or_insert(vertex);
        later += usize::from(first != vertex);
        all.push(first);
        pulse.beat(100)?;
    }
    Ok((all, later))
}

/// The beginning of a note on so many vertices.
pub(super) const VERTICES_ARE: [&str; 2] = ["vertex is", "vertices are"];

/// A number, and the words for one or for many.
pub(super) fn counted(count: usize, [one, many]: [&str; 2]) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}

/// Replaces each vertex by the first one at its position.
fn join(mesh: &Mesh, triangles: &mut [[u32; 3]], notes: &mut Vec<String>, pulse: &Pulse) -> Result<(), Stopped> {
    let (first, later) = first_at_position(mesh, pulse)?;
    if later > 0 {
        notes.push(format!("{} at the position of another one: joined with it", counted(later, VERTICES_ARE)));
    }
    for vertex in triangles.iter_mut().flatten() {
        *vertex = first[*vertex as usize];
    }
    Ok(())
}

/// The triangles with three distinct vertices.
fn proper(mut triangles: Vec<[u32; 3]>, notes: &mut Vec<String>) -> Result<Vec<[u32; 3]>, LaplacianError> {
    let all = triangles.len();
    triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
    let collapsed = all - triangles.len();
    if collapsed > 0 {
        notes.push(format!("{} a vertex twice: left out", counted(collapsed, ["face names", "faces name"])));
    }
    if triangles.is_empty() { Err(LaplacianError::Empty) } else { Ok(triangles) }
}

/// The first triangle of each set of three vertices.
fn distinct(mut triangles: Vec<[u32; 3]>, notes: &mut Vec<String>, pulse: &Pulse) -> Result<Vec<[u32; 3]>, Stopped> {
    let mut order: Vec<([u32; 3], u32)> = (0..)
        .zip(&triangles)
        .map(|(at, &triangle)| {
            let mut sorted = triangle;
            sorted.sort_unstable();
            (sorted, at)
        })
        .collect();
    pulse.beat(10 * order.len())?;
    pulse.sort(&mut order, &Ord::cmp)?;
    let mut again = vec![false; triangles.len()];
    for pair in order.windows(2) {
        again[pair[1].1 as usize] = pair[0].0 == pair[1].0;
        pulse.beat(6)?;
    }
    let repeated = again.iter().filter(|&&is| is).count();
    if repeated > 0 {
        notes.push(format!("{} another one: left out", counted(repeated, ["face repeats", "faces repeat"])));
        let mut at = 0;
        triangles.retain(|_| {
            at += 1;
            !again[at - 1]
        });
    }
    Ok(triangles)
}

/// Drops the vertices that no triangle names; those that were joined are not told of again.
fn compact(
    mesh: &Mesh,
    mut triangles: Vec<[u32; 3]>,
    welded: bool,
    notes: &mut Vec<String>,
) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut new = vec![u32::MAX; mesh.vertices().len()];
    for &vertex in triangles.iter().flatten() {
        new[vertex as usize] = 0;
    }
    let vertices: Vec<u32> = (0..new.len() as u32).filter(|&vertex| new[vertex as usize] == 0).collect();
    if vertices.len() < new.len() && !welded {
        let left = counted(new.len() - vertices.len(), ["vertex belongs", "vertices belong"]);
        notes.push(format!("{left} to no face: left out"));
    }
    for (at, &vertex) in vertices.iter().enumerate() {
        new[vertex as usize] = at as u32;
    }
    for vertex in triangles.iter_mut().flatten() {
        *vertex = new[*vertex as usize];
    }
    (vertices, triangles)
}

/// The positions of `vertices` over the power of two that brings their extent to between 1 and 2, and its exponent.
pub(super) fn scaled(mesh: &Mesh, vertices: &[u32]) -> Result<(Vec<[f64; 3]>, i32), LaplacianError> {
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for &vertex in vertices {
        let point = mesh.vertices()[vertex as usize];
        if point.iter().any(|coordinate| !coordinate.is_finite()) {
            return Err(LaplacianError::NotFinite { vertex: vertex as usize });
        }
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let extent = (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max);
    if !(1e-140..=1e140).contains(&extent) {
        return Err(LaplacianError::Extent { extent: Extent(extent) });
    }
    let exponent = extent.log2().floor() as i32;
    let factor = 2_f64.powi(-exponent);
    let points =
        vertices.iter().map(|&vertex| mesh.vertices()[vertex as usize].map(|coordinate| coordinate * factor)).collect();
    Ok((points, exponent))
}

/// Connected components of a graph, numbered by their first item, and how many.
///
/// # Errors
/// When the watch cancels.
pub(super) fn components(
    count: usize,
    edges: impl Iterator<Item = (u32, u32)>,
    pulse: &Pulse,
) -> Result<(Vec<u32>, usize), Stopped> {
    let mut leader: Vec<u32> = (0..count as u32).collect();
    let find = |leader: &mut Vec<u32>, mut at: u32| {
        while leader[at as usize] != at {
            leader[at as usize] = leader[leader[at as usize] as usize];
            at = leader[at as usize];
        }
        at
    };
    for (a, b) in edges {
        let (x, y) = (find(&mut leader, a), find(&mut leader, b));
        leader[x.max(y) as usize] = x.min(y);
        pulse.beat(10)?;
    }
    let mut number = vec![u32::MAX; count];
    let mut next = 0;
    let mut component = Vec::with_capacity(count);
    for item in 0..count as u32 {
        let root = find(&mut leader, item) as usize;
        if number[root] == u32::MAX {
            number[root] = next;
            next += 1;
        }
        component.push(number[root]);
        pulse.beat(6)?;
    }
    Ok((component, next as usize))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::watch::Unwatched;

    #[test]
    fn notes_tell_one_from_many() {
        let said = |stray: usize| {
            let mut vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
            vertices.resize(3 + stray, [5.0; 3]);
            let mesh = Mesh::new(vertices, vec![[0, 1, 2]]);
            let mut notes = Vec::new();
            compact(&mesh, mesh.triangles().to_vec(), false, &mut notes);
            join(&mesh, &mut mesh.triangles().to_vec(), &mut notes, &Pulse::new(&Unwatched)).unwrap();
            notes
        };
        assert_eq!(said(1), ["1 vertex belongs to no face: left out"]);
        let two =
            ["2 vertices belong to no face: left out", "1 vertex is at the position of another one: joined with it"];
        assert_eq!(said(2), two);
    }
}

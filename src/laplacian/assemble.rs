//! The sum over the triangles.

use thiserror::Error;

use super::{Laplacian, Mass, Operator, element::element, matrix::MassMatrix, matrix::Symmetric};
use crate::mesh::Mesh;

/// Why a mesh has no Laplacian.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum LaplacianError {
    /// There is nothing to integrate over.
    #[error("the mesh has no triangle with three distinct vertices")]
    Empty,
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

/// L and B of a mesh: `L_ij = −(cot α + cot β)/2` over the angles opposite of the edge, rows summing to zero, and the
/// mass matrix that `operator` and `mass` name (for [`Operator::Cot`] the identity).
///
/// # Errors
/// When the mesh has no proper triangle, an index out of range, a used vertex that is not finite, or an extent whose
/// square is not a number.
pub fn assemble(mesh: &Mesh, operator: Operator, mass: Mass) -> Result<Laplacian, LaplacianError> {
    let mut notes = Vec::new();
    let triangles = proper(mesh, &mut notes)?;
    let (vertices, triangles) = compact(mesh, triangles, &mut notes);
    let (points, exponent) = scaled(mesh, &vertices)?;

    let (mean, longest) = edge_lengths(&points, &triangles);
    let floor = if mean > 0.0 { 1e-3 * mean } else { longest };
    let mut flat = 0_usize;
    let mut joins = Joins::new(points.len(), triangles.len());
    for corners in &triangles {
        let found = element(corners.map(|corner| points[corner as usize]), floor);
        flat += usize::from(found.mollified);
        joins.add(*corners, found.cotangents.map(|cotangent| 0.5 * cotangent), found.area);
    }
    if flat > 0 {
        notes.push(format!("{flat} of {} faces have no area: their edge lengths were mollified", triangles.len()));
    }

    let (component, components) = components(points.len(), &triangles);
    if components > 1 {
        notes.push(format!("{components} connected components: as many zeros"));
    }
    Ok(Laplacian { matrix: joins.finish(operator, mass), vertices, component, components, exponent, notes })
}

/// The triangles with three distinct vertices, each set of three once.
fn proper(mesh: &Mesh, notes: &mut Vec<String>) -> Result<Vec<[u32; 3]>, LaplacianError> {
    let count = mesh.vertices().len();
    if mesh.triangles().len() > (u32::MAX / 4) as usize || count > (u32::MAX / 4) as usize {
        return Err(LaplacianError::TooLarge { triangles: mesh.triangles().len() });
    }
    let mut kept = Vec::with_capacity(mesh.triangles().len());
    for (at, &triangle) in mesh.triangles().iter().enumerate() {
        if let Some(&vertex) = triangle.iter().find(|&&vertex| vertex as usize >= count) {
            return Err(LaplacianError::OutOfRange { triangle: at, vertex, vertices: count });
        }
        let [a, b, c] = triangle;
        if a != b && b != c && c != a {
            kept.push(triangle);
        }
    }
    let collapsed = mesh.triangles().len() - kept.len();
    if collapsed > 0 {
        notes.push(format!("{collapsed} faces name a vertex twice: left out"));
    }
    if kept.is_empty() {
        return Err(LaplacianError::Empty);
    }
    let mut order: Vec<([u32; 3], u32)> = kept
        .iter()
        .enumerate()
        .map(|(at, &triangle)| {
            let mut sorted = triangle;
            sorted.sort_unstable();
            (sorted, at as u32)
        })
        .collect();
    order.sort_unstable();
    let mut again = vec![false; kept.len()];
    for pair in order.windows(2) {
        again[pair[1].1 as usize] = pair[0].0 == pair[1].0;
    }
    let repeated = again.iter().filter(|&&is| is).count();
    if repeated > 0 {
        notes.push(format!("{repeated} faces repeat another one: left out"));
        let mut at = 0;
        kept.retain(|_| {
            at += 1;
            !again[at - 1]
        });
    }
    Ok(kept)
}

/// Drops the vertices that no triangle names.
fn compact(mesh: &Mesh, mut triangles: Vec<[u32; 3]>, notes: &mut Vec<String>) -> (Vec<u32>, Vec<[u32; 3]>) {
    let mut new = vec![u32::MAX; mesh.vertices().len()];
    for &vertex in triangles.iter().flatten() {
        new[vertex as usize] = 0;
    }
    let vertices: Vec<u32> = (0..new.len() as u32).filter(|&vertex| new[vertex as usize] == 0).collect();
    if vertices.len() < new.len() {
        notes.push(format!("{} vertices belong to no face: left out", new.len() - vertices.len()));
    }
    for (at, &vertex) in vertices.iter().enumerate() {
        new[vertex as usize] = at as u32;
    }
    for vertex in triangles.iter_mut().flatten() {
        *vertex = new[*vertex as usize];
    }
    (vertices, triangles)
}

/// The used positions over the power of two that brings their extent to between 1 and 2, and its exponent.
fn scaled(mesh: &Mesh, vertices: &[u32]) -> Result<(Vec<[f64; 3]>, i32), LaplacianError> {
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

/// Mean and largest edge length over the triangles.
fn edge_lengths(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> (f64, f64) {
    let mut sum = 0.0;
    let mut longest = 0.0_f64;
    for triangle in triangles {
        for at in 0..3 {
            let (a, b) = (points[triangle[at] as usize], points[triangle[(at + 1) % 3] as usize]);
            let length = (0..3).map(|axis| (a[axis] - b[axis]).powi(2)).sum::<f64>().sqrt();
            sum += length;
            longest = longest.max(length);
        }
    }
    (sum / (3 * triangles.len()) as f64, longest)
}

/// Connected components of the vertices through triangles, numbered by their first vertex.
fn components(count: usize, triangles: &[[u32; 3]]) -> (Vec<u32>, usize) {
    let mut leader: Vec<u32> = (0..count as u32).collect();
    let find = |leader: &mut Vec<u32>, mut at: u32| {
        while leader[at as usize] != at {
            leader[at as usize] = leader[leader[at as usize] as usize];
            at = leader[at as usize];
        }
        at
    };
    for &[a, b, c] in triangles {
        for other in [b, c] {
            let (x, y) = (find(&mut leader, a), find(&mut leader, other));
            leader[x.max(y) as usize] = x.min(y);
        }
    }
    let mut number = vec![u32::MAX; count];
    let mut next = 0;
    let component = (0..count as u32)
        .map(|vertex| {
            let root = find(&mut leader, vertex) as usize;
            if number[root] == u32::MAX {
                number[root] = next;
                next += 1;
            }
            number[root]
        })
        .collect();
    (component, next as usize)
}

/// Collects the contributions of the triangles to the edges, in the order of the triangles.
struct Joins {
    /// Per contribution: smaller vertex, larger vertex, weight of L, area.
    edges: Vec<(u32, u32, f64, f64)>,
    /// Per vertex: the area of its triangles.
    area: Vec<f64>,
}

impl Joins {
    fn new(vertices: usize, triangles: usize) -> Self {
        Self { edges: Vec::with_capacity(3 * triangles), area: vec![0.0; vertices] }
    }

    fn add(&mut self, corners: [u32; 3], weights: [f64; 3], area: f64) {
        for at in 0..3 {
            let (a, b) = (corners[(at + 1) % 3], corners[(at + 2) % 3]);
            self.edges.push((a.min(b), a.max(b), weights[at], area));
            self.area[corners[at] as usize] += area;
        }
    }

    fn finish(self, operator: Operator, mass: Mass) -> Symmetric {
        let n = self.area.len();
        let mut start = vec![0_usize; n + 1];
        for edge in &self.edges {
            start[edge.0 as usize + 1] += 1;
        }
        for at in 0..n {
            start[at + 1] += start[at];
        }
        let mut next = start.clone();
        let mut sorted = vec![(0_u32, 0.0, 0.0); self.edges.len()];
        for &(low, high, weight, area) in &self.edges {
            sorted[next[low as usize]] = (high, weight, area);
            next[low as usize] += 1;
        }
        let mut columns = Vec::with_capacity(n + 1);
        columns.push(0);
        let mut rows = Vec::with_capacity(n + self.edges.len() / 2);
        let mut stiffness = Vec::with_capacity(rows.capacity());
        let mut coupling = Vec::with_capacity(rows.capacity());
        let mut diagonal = vec![0.0; n];
        for column in 0..n {
            let list = &mut sorted[start[column]..start[column + 1]];
            list.sort_by_key(|entry| entry.0);
            rows.push(column as u32);
            stiffness.push(0.0);
            coupling.push(self.area[column] / 6.0);
            for group in list.chunk_by(|a, b| a.0 == b.0) {
                let weight = group.iter().fold(0.0, |sum, entry| sum + entry.1);
                rows.push(group[0].0);
                stiffness.push(-weight);
                coupling.push(group.iter().fold(0.0, |sum, entry| sum + entry.2) / 12.0);
                diagonal[column] += weight;
                diagonal[group[0].0 as usize] += weight;
            }
            columns.push(rows.len());
        }
        for column in 0..n {
            stiffness[columns[column]] = diagonal[column];
        }
        let mass = match (operator, mass) {
            (Operator::Cot, _) => MassMatrix::Unit,
            (Operator::Fem, Mass::Consistent) => MassMatrix::Full(coupling),
            (Operator::Fem, Mass::Lumped) => MassMatrix::Diagonal(self.area.iter().map(|area| area / 3.0).collect()),
        };
        Symmetric { columns, rows, stiffness, mass }
    }
}

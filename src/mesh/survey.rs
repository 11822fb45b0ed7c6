//! What is wrong with a mesh, and where.

use serde::{Deserialize, Serialize};

pub use self::defect::{Defect, DefectKind, Spot};
use super::Mesh;

mod defect;
mod shape;
mod topology;

/// What a mesh is and what is wrong with it. Numbers of vertices and triangles count from 0.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Survey {
    /// Vertices, used or not.
    pub vertices: usize,
    /// Triangles, after polygons have been cut.
    pub triangles: usize,
    /// Sum of the triangles' areas, in the file's unit squared.
    pub area: f64,
    /// Connected parts, by shared vertices; unused vertices are none.
    pub components: usize,
    /// Edges of one triangle.
    pub boundary_edges: usize,
    /// Connected pieces of the boundary.
    pub boundary_loops: usize,
    /// Used vertices − edges + triangles. Triangles that name a vertex twice count for nothing.
    pub euler: i64,
    /// The sum of the components' genus: components − χ/2. Only for a closed, orientable manifold.
    pub genus: Option<u64>,
    /// True where no edge of two triangles is run through by both in the same direction.
    pub oriented: bool,
    /// What is wrong, or worth knowing, each with its places.
    pub defects: Vec<Defect>,
}

impl Survey {
    /// Why no spectrum can be had of this mesh, in one line; `None` where one can.
    #[must_use]
    pub fn refusal(&self) -> Option<String> {
        let fatal = |kind: DefectKind| self.defects.iter().find(|defect| defect.kind == kind).map(ToString::to_string);
        if self.vertices == 0 {
            return Some("there are no vertices".to_owned());
        }
        if self.triangles == 0 && self.vertices < 3 {
            return Some(format!("there are no faces, only {} vertices", self.vertices));
        }
        fatal(DefectKind::NotFinite).or_else(|| fatal(DefectKind::MissingVertex)).or_else(|| {
            if !self.area.is_finite() {
                return Some("the coordinates are too large for an area to be computed".to_owned());
            }
            let flat = self.count(DefectKind::ZeroArea) + self.count(DefectKind::RepeatedVertex);
            (self.triangles > 0 && (self.area == 0.0 || flat >= self.triangles))
                .then(|| "no face has an area".to_owned())
        })
    }

    /// How often a defect is there.
    #[must_use]
    pub fn count(&self, kind: DefectKind) -> usize {
        self.defects.iter().filter(|defect| defect.kind == kind).map(|defect| defect.count).sum()
    }

    /// True for a closed manifold: no boundary, no edge of more than two triangles, no vertex where surfaces touch.
    #[must_use]
    pub fn closed_manifold(&self) -> bool {
        self.triangles > 0
            && self.boundary_edges == 0
            && self.count(DefectKind::NonManifoldEdge) + self.count(DefectKind::NonManifoldVertex) == 0
    }
}

/// Looks for every defect there is, in time that grows like sorting.
#[must_use]
pub fn survey(mesh: &Mesh) -> Survey {
    let mut defects = Vec::new();
    let sound = shape::look(mesh, &mut defects);
    if mesh.triangles().is_empty() && !mesh.vertices().is_empty() {
        defects.retain(|defect: &Defect| defect.kind != DefectKind::UnusedVertex);
        defects.push(Defect::of_all(DefectKind::NoFaces, mesh.vertices().len()));
    }
    let topology = topology::look(mesh.vertices().len(), &sound, &mut defects);
    defects.sort_by_key(|defect: &Defect| defect.kind);
    Survey {
        vertices: mesh.vertices().len(),
        triangles: mesh.triangles().len(),
        area: mesh.area(),
        components: topology.components,
        boundary_edges: topology.boundary_edges,
        boundary_loops: topology.boundary_loops,
        euler: topology.euler,
        genus: topology.genus,
        oriented: topology.oriented,
        defects,
    }
}

//! One kind of defect with its count and places.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::shape::{SLIVER_DEGREES, ZERO_HEIGHT};

/// How many places a defect names.
const SHOWN: usize = 5;

/// What can be wrong with a mesh, or worth knowing; the gravest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DefectKind {
    /// Vertices with a coordinate that is infinite or not a number.
    NotFinite,
    /// Triangles that name a vertex that does not exist.
    MissingVertex,
    /// Vertices without any face: a point cloud.
    NoFaces,
    /// Triangles that name a vertex twice.
    RepeatedVertex,
    /// Triangles of three vertices without area.
    ZeroArea,
    /// Triangles with an angle below 0.05°, and with an area.
    Sliver,
    /// Triangles that have the vertices of an earlier one, in any order.
    DuplicateFace,
    /// Edges of more than two triangles.
    NonManifoldEdge,
    /// Vertices at which parts of the surface touch that share no edge there.
    NonManifoldVertex,
    /// Edges that both their triangles run through in the same direction, although turning triangles could mend it.
    Inconsistent,
    /// The same where no turning of triangles can mend it: the surface has one side.
    NonOrientable,
    /// Edges of one triangle.
    Boundary,
    /// Parts that share no vertex: each adds a zero eigenvalue.
    Components,
    /// Vertices that have an earlier one's position.
    DuplicatePosition,
    /// Vertices that no triangle names.
    UnusedVertex,
}

/// A place in a mesh; vertices and triangles count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Spot {
    /// A vertex.
    Vertex(u32),
    /// The edge between two vertices.
    Edge(u32, u32),
    /// A triangle.
    Triangle(u32),
}

impl fmt::Display for Spot {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(number) | Self::Triangle(number) => write!(f, "{number}"),
            Self::Edge(from, to) => write!(f, "{from}–{to}"),
        }
    }
}

/// A kind of defect, how often it is there, and where first. [`fmt::Display`] says it in one line.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Defect {
    /// What it is.
    pub kind: DefectKind,
    /// How often.
    pub count: usize,
    /// The first places, at most five, in ascending order.
    pub places: Vec<Spot>,
    /// What else there is to say: the number of boundary loops.
    pub loops: usize,
}

impl Defect {
    /// A defect of so many vertices, without places.
    pub(super) fn of_all(kind: DefectKind, count: usize) -> Self {
        Self { kind, count, places: Vec::new(), loops: 0 }
    }

    /// Records a defect, unless `spots` is empty.
    pub(super) fn record(kind: DefectKind, spots: impl IntoIterator<Item = Spot>, into: &mut Vec<Self>) {
        let mut spots = spots.into_iter();
        let places: Vec<Spot> = spots.by_ref().take(SHOWN).collect();
        if !places.is_empty() {
            into.push(Self { kind, count: places.len() + spots.count(), places, loops: 0 });
        }
    }
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = self.count;
        let plural = if count == 1 { "" } else { "s" };
        match self.kind {
            DefectKind::NotFinite => write!(f, "{count} vertex position{plural} not finite")?,
            DefectKind::MissingVertex => write!(f, "{count} face{plural} naming a vertex that does not exist")?,
            DefectKind::NoFaces => write!(f, "no faces: a point cloud of {count} vertices")?,
            DefectKind::RepeatedVertex => write!(f, "{count} face{plural} naming a vertex twice")?,
            DefectKind::ZeroArea => {
                write!(f, "{count} zero-area face{plural} (height below {ZERO_HEIGHT:e} of the longest edge)")?;
            }
            DefectKind::Sliver => write!(f, "{count} sliver{plural} (an angle below {SLIVER_DEGREES}°)")?,
            DefectKind::DuplicateFace => write!(f, "{count} duplicate face{plural}")?,
            DefectKind::NonManifoldEdge => write!(f, "{count} non-manifold edge{plural} (more than two faces)")?,
            DefectKind::NonManifoldVertex => {
                let word = if count == 1 { "vertex" } else { "vertices" };
                write!(f, "{count} non-manifold {word} (where the surface touches itself)")?;
            }
            DefectKind::Inconsistent => {
                write!(f, "inconsistent orientation: {count} edge{plural} between faces that face opposite ways")?;
            }
            DefectKind::NonOrientable => {
                write!(f, "not orientable: {count} edge{plural} between faces that face opposite ways")?;
            }
            DefectKind::Boundary => {
                let loops = self.loops;
                let s = if loops == 1 { "" } else { "s" };
                write!(f, "open boundary: {count} edge{plural} in {loops} loop{s}")?;
            }
            DefectKind::Components => write!(f, "{count} components, each adding a zero eigenvalue")?,
            DefectKind::DuplicatePosition => {
                let word = if count == 1 { "vertex" } else { "vertices" };
                write!(f, "{count} {word} at the position of an earlier one")?;
            }
            DefectKind::UnusedVertex => {
                let word = if count == 1 { "vertex" } else { "vertices" };
                write!(f, "{count} unused {word}")?;
            }
        }
        let s = if self.places.len() == 1 { "" } else { "s" };
        match self.places.first() {
            None => return Ok(()),
            Some(_) if self.kind == DefectKind::Components => write!(f, ": first face{s}")?,
            Some(Spot::Vertex(_)) => write!(f, ": {}", if s.is_empty() { "vertex" } else { "vertices" })?,
            Some(Spot::Edge(..)) => write!(f, ": edge{s}")?,
            Some(Spot::Triangle(_)) => write!(f, ": triangle{s}")?,
        }
        for (i, place) in self.places.iter().enumerate() {
            write!(f, "{} {place}", if i == 0 { "" } else { "," })?;
        }
        write!(f, "{} (counted from 0)", if self.count > self.places.len() { ", …" } else { "" })
    }
}

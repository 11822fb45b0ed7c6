//! Polygons → triangles.

use std::{cmp::Ordering, collections::HashMap};

use earcut::Earcut;

use crate::mesh::{
    Mesh,
    vector::{cross, dot, sub},
};

/// The polygons of a file, their corners one after the other.
#[derive(Debug, Default)]
pub(super) struct Faces {
    corners: Vec<u32>,
    arities: Vec<u32>,
}

impl Faces {
    /// How many polygons there are.
    pub(super) fn len(&self) -> usize {
        self.arities.len()
    }

    /// Makes room for triangles.
    pub(super) fn reserve(&mut self, triangles: usize) {
        self.arities.reserve(triangles);
        self.corners.reserve(3 * triangles);
    }

    /// Adds a corner to the polygon that [`Faces::close`] ends.
    #[inline]
    pub(super) fn corner(&mut self, vertex: u32) {
        self.corners.push(vertex);
    }

    /// Ends the polygon of the last `arity` corners.
    #[inline]
    pub(super) fn close(&mut self, arity: u32) {
        self.arities.push(arity);
    }

    /// Adds a polygon.
    pub(super) fn push(&mut self, polygon: &[u32]) {
        self.corners.extend_from_slice(polygon);
        self.close(polygon.len() as u32);
    }

    /// The mesh of these polygons. Every corner must be one of `vertices`, and every position finite.
    pub(super) fn into_mesh(self, vertices: Vec<[f64; 3]>) -> Mesh {
        let mut cutter = Cutter { vertices: &vertices, triangles: Vec::new(), ..Cutter::default() };
        cutter.triangles.reserve(self.corners.len().saturating_sub(2 * self.arities.len()));
        let mut rest = &self.corners[..];
        for arity in self.arities {
            let (polygon, others) = rest.split_at(arity as usize);
            rest = others;
            match *polygon {
                [a, b, c] => cutter.triangles.push([a, b, c]),
                [] | [_] | [_, _] => {}
                _ => cutter.cut(polygon),
            }
        }
        let triangles = cutter.triangles;
        Mesh::new(vertices, triangles)
    }
}

/// Cuts polygons and keeps what it allocates.
#[derive(Default)]
struct Cutter<'a> {
    vertices: &'a [[f64; 3]],
    triangles: Vec<[u32; 3]>,
    ring: Vec<u32>,
    points: Vec<[f64; 3]>,
    ears: Vec<u32>,
    cut: Vec<[u32; 3]>,
    earcut: Earcut<f64>,
}

impl Cutter<'_> {
    fn position(&self, vertex: u32) -> [f64; 3] {
        self.vertices[vertex as usize]
    }

    /// Cuts a polygon of four corners or more.
    fn cut(&mut self, polygon: &[u32]) {
        self.ring.clear();
        self.ring.extend_from_slice(polygon);
        // "4 0 1 2 2" is a triangle.
        self.ring.dedup();
        while self.ring.len() > 1 && self.ring.first() == self.ring.last() {
            self.ring.pop();
        }
        if self.ring.len() < 3 {
            // Kept, for the survey to name it.
            self.triangles.push([polygon[0], polygon[1], polygon[2]]);
            return;
        }
        self.begin_at_least_position();
        match *self.ring {
            [a, b, c] => self.triangles.push([a, b, c]),
            [a, b, c, d] => {
                let pair = if self.cut_quad([a, b, c, d]) { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
                self.triangles.extend(pair);
            }
            _ => self.cut_large(),
        }
    }

    /// Turns the ring so that it begins at the corner that is least by (x, y, z), as [`Mesh::canonical`] sorts:
    /// what follows then depends on the shape, not on where the file begins the polygon.
    fn begin_at_least_position(&mut self) {
        /// Corners looked at where several have the least position; a bound, for a hostile ring may have that one only.
        const LOOK: usize = 8;
        let position = |corner: usize| self.vertices[self.ring[corner % self.ring.len()] as usize];
        let least = (0..self.ring.len()).min_by(|&i, &j| {
            (0..LOOK)
                .map(|step| position(i + step).partial_cmp(&position(j + step)).unwrap_or(Ordering::Equal))
                .find(|order| order.is_ne())
                .unwrap_or(Ordering::Equal)
        });
        self.ring.rotate_left(least.unwrap_or(0));
    }

    /// True where the diagonal from the first to the third corner is the better one.
    fn cut_quad(&self, quad: [u32; 4]) -> bool {
        let [a, b, c, d] = quad.map(|vertex| self.position(vertex));
        let agree = |[p, q, r]: [[f64; 3]; 3], [s, t, u]: [[f64; 3]; 3]| {
            dot(cross(sub(q, p), sub(r, p)), cross(sub(t, s), sub(u, s))) > 0.0
        };
        let first = agree([a, b, c], [a, c, d]);
        let second = agree([a, b, d], [b, c, d]);
        let (ac, bd) = (sub(c, a), sub(d, b));
        if first == second { dot(ac, ac) <= dot(bd, bd) } else { first }
    }

    /// Cuts the ring, of five corners or more, in the plane of its greatest projection.
    fn cut_large(&mut self) {
        self.cut.clear();
        if self.cut_ears().is_none() {
            self.cut.clear();
            self.cut.extend((2..self.ring.len() as u32).map(|corner| [0, corner - 1, corner]));
        }
        self.triangles.extend(self.cut.iter().map(|triangle| triangle.map(|corner| self.ring[corner as usize])));
    }

    /// Ear cutting; `None` where it does not end in two triangles fewer than there are corners: the ring then crosses
    /// itself or has no area.
    fn cut_ears(&mut self) -> Option<()> {
        let corners = self.ring.len();
        self.points.clear();
        self.points.extend(self.ring.iter().map(|&vertex| self.vertices[vertex as usize]));
        let flat = project(&self.points)?;
        self.earcut.earcut(flat, &[], &mut self.ears);
        // Three corners in the ring's order have the ring's orientation.
        self.cut.extend(self.ears.as_chunks::<3>().0.iter().map(|&ear| {
            let mut ear = ear;
            ear.sort_unstable();
            ear
        }));
        self.restore_straight_corners();
        (self.cut.len() == corners - 2).then_some(())
    }

    /// Puts back the corners that ear cutting leaves out because they lie on a straight line: the neighbour across
    /// has them too, and without them the surface would have a slit there.
    fn restore_straight_corners(&mut self) {
        let corners = self.ring.len() as u32;
        let mut kept = vec![false; corners as usize];
        for corner in self.cut.iter().flatten() {
            kept[*corner as usize] = true;
        }
        let present: Vec<u32> = (0..corners).filter(|&corner| kept[corner as usize]).collect();
        if present.len() == corners as usize {
            return;
        }
        let edge = |p: u32, q: u32| (p.min(q), p.max(q));
        // Which triangle has an edge; outer edges, the only ones asked for, have one.
        let mut owner: HashMap<(u32, u32), usize> = HashMap::new();
        for (at, &[a, b, c]) in self.cut.iter().enumerate() {
            owner.extend([(edge(a, b), at), (edge(b, c), at), (edge(c, a), at)]);
        }
        for (i, &p) in present.iter().enumerate() {
            let q = present[(i + 1) % present.len()];
            let end = if q > p { q } else { q + corners };
            let Some(&at) = owner.get(&edge(p, q)).filter(|_| end > p + 1) else { continue };
            let Some(apex) = self.cut[at].into_iter().find(|corner| *corner != p && *corner != q) else { continue };
            for next in p + 1..=end {
                let (last, next) = ((next - 1) % corners, next % corners);
                let mut triangle = [last, next, apex];
                triangle.sort_unstable();
                // The first takes the old one's place. The last has the edge from q to the apex.
                let place = if last == p { at } else { self.cut.len() };
                if last == p {
                    self.cut[at] = triangle;
                } else {
                    self.cut.push(triangle);
                }
                owner.insert(edge(next, apex), place);
            }
        }
    }
}

/// A polygon's corners in the coordinate plane in which its shadow is greatest, so turned that the shadow runs
/// counterclockwise; `None` where it has no area.
fn project(points: &[[f64; 3]]) -> Option<impl Iterator<Item = [f64; 2]>> {
    let mut least = points[0];
    let mut extent = 0.0f64;
    for axis in 0..3 {
        least[axis] = points.iter().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
        let greatest = points.iter().map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max);
        extent = extent.max(greatest - least[axis]);
    }
    // In units of the extent nothing overflows below.
    if !(extent > 0.0 && extent.is_finite()) {
        return None;
    }
    let unit = move |point: [f64; 3]| sub(point, least).map(|coordinate| coordinate / extent);
    let mut normal = [0.0; 3];
    for (i, &point) in points.iter().enumerate() {
        let (p, q) = (unit(point), unit(points[(i + 1) % points.len()]));
        for (sum, part) in normal.iter_mut().zip(cross(p, q)) {
            *sum += part;
        }
    }
    let axis = (0..3).max_by(|&i, &j| normal[i].abs().total_cmp(&normal[j].abs()))?;
    if normal[axis] == 0.0 {
        return None;
    }
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let (u, v) = if normal[axis] > 0.0 { (u, v) } else { (v, u) };
    Some(points.iter().map(move |&point| {
        let point = unit(point);
        [point[u], point[v]]
    }))
}

//! One polygon → triangles.

use std::{cmp::Ordering, collections::HashMap};

use earcut::Earcut;

use crate::mesh::vector::{cross, dot, sub};

/// Cuts polygons and keeps what it allocates.
#[derive(Default)]
pub(super) struct Cutter<'a> {
    vertices: &'a [[f64; 3]],
    /// The triangles of all polygons so far.
    pub triangles: Vec<[u32; 3]>,
    ring: Vec<u32>,
    points: Vec<[f64; 3]>,
    ears: Vec<u32>,
    cut: Vec<[u32; 3]>,
    earcut: Earcut<f64>,
}

impl<'a> Cutter<'a> {
    /// With room for `triangles`.
    pub(super) fn new(vertices: &'a [[f64; 3]], triangles: usize) -> Self {
        Self { vertices, triangles: Vec::with_capacity(triangles), ..Self::default() }
    }

    fn position(&self, vertex: u32) -> [f64; 3] {
        self.vertices[vertex as usize]
    }

    /// Cuts a polygon of four corners or more.
    pub(super) fn cut(&mut self, polygon: &[u32]) {
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

    /// Ear cutting; `None` where its triangles do not fill the ring: it then crosses itself or has no area.
    fn cut_ears(&mut self) -> Option<()> {
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
        self.fills_ring().then_some(())
    }

    /// Whether the triangles are two fewer than the ring's corners, and their sides are the ring's sides once and
    /// diagonals twice, there and back.
    fn fills_ring(&self) -> bool {
        let corners = self.ring.len() as u32;
        let mut sides: Vec<(u32, u32)> = self.cut.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        sides.sort_unstable();
        let once = sides.is_sorted_by(|a, b| a < b);
        once && self.cut.len() as u32 == corners - 2
            && sides.iter().all(|&(from, to)| (from + 1) % corners == to || sides.binary_search(&(to, from)).is_ok())
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

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Cuts the polygon of all points; gives the corners of each triangle.
    fn cut(points: &[[f64; 3]]) -> Vec<[u32; 3]> {
        let ring: Vec<u32> = (0..points.len() as u32).collect();
        let mut cutter = Cutter::new(points, 0);
        cutter.cut(&ring);
        cutter.triangles
    }

    /// Twice the signed area of triangles in the plane z = 0.
    fn areas(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<f64> {
        let corner = |vertex: u32| points[vertex as usize];
        triangles.iter().map(|&[a, b, c]| cross(sub(corner(b), corner(a)), sub(corner(c), corner(a)))[2]).collect()
    }

    fn flat(points: &[[f64; 2]]) -> Vec<[f64; 3]> {
        points.iter().map(|&[x, y]| [x, y, 0.0]).collect()
    }

    /// The same triangles as sets of positions, whatever the numbers of the vertices.
    fn placed(points: &[[f64; 3]], triangles: &[[u32; 3]]) -> Vec<[[u64; 3]; 3]> {
        let mut placed: Vec<_> = triangles
            .iter()
            .map(|triangle| {
                let [a, b, c] = triangle.map(|vertex| points[vertex as usize].map(f64::to_bits));
                [a, b, c].min([b, c, a]).min([c, a, b])
            })
            .collect();
        placed.sort_unstable();
        placed
    }

    #[test]
    fn a_quad_takes_its_shorter_diagonal() {
        let points = flat(&[[0.0, 0.0], [2.0, -0.5], [4.0, 0.0], [2.0, 0.5]]);
        assert_eq!(cut(&points), [[0, 1, 3], [1, 2, 3]]);
    }

    #[test]
    fn a_concave_quad_takes_the_diagonal_inside_though_it_is_longer() {
        let points = flat(&[[0.0, 0.0], [4.0, 2.0], [0.0, 1.0], [-4.0, 2.0]]);
        let triangles = cut(&points);
        assert!(areas(&points, &triangles).into_iter().all(|area| area > 0.0), "{triangles:?}");
    }

    #[test]
    fn a_quad_with_a_straight_corner_has_no_flat_triangle() {
        let points = flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.1]]);
        assert!(areas(&points, &cut(&points)).into_iter().all(|area| area > 0.0));
    }

    #[test]
    fn corners_named_twice_in_a_row_count_once() {
        let points = flat(&[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]);
        let cut = |polygon: &[u32]| {
            let mut cutter = Cutter::new(&points, 0);
            cutter.cut(polygon);
            cutter.triangles
        };
        assert_eq!(cut(&[0, 1, 2, 2]), [[0, 2, 1]].map(|[a, b, c]| [a, c, b]));
        assert_eq!(cut(&[0, 0, 1, 1, 2, 2, 0]), [[0, 1, 2]]);
        // Of less than three corners something is kept, for the survey to name.
        assert_eq!(cut(&[1, 1, 2, 2]), [[1, 1, 2]]);
    }

    #[test]
    fn a_comb_is_filled_and_not_more() {
        let mut points = vec![[0.0, 0.0], [10.0, 0.0]];
        for tooth in (0..10).rev() {
            let x = f64::from(tooth);
            points.extend([[x + 1.0, 1.0], [x + 0.9, 3.0], [x + 0.8, 1.0]]);
        }
        points.push([0.0, 1.0]);
        let points = flat(&points);
        let triangles = cut(&points);
        let areas = areas(&points, &triangles);
        assert_eq!(triangles.len(), points.len() - 2);
        assert!(areas.iter().all(|area| *area > -1e-12));
        assert!((areas.iter().sum::<f64>() - 2.0 * (10.0 + 10.0 * 0.2)).abs() < 1e-12);
    }

    #[test]
    fn straight_corners_stay() {
        // A square with corners along its sides: neighbours across have them too.
        let points = flat(&[
            [0.0, 0.0],
            [1.0, 0.0],
            [2.0, 0.0],
            [3.0, 0.0],
            [3.0, 1.0],
            [3.0, 3.0],
            [2.0, 3.0],
            [0.0, 3.0],
            [0.0, 1.5],
        ]);
        let triangles = cut(&points);
        assert_eq!(triangles.len(), 7);
        let areas = areas(&points, &triangles);
        assert!(areas.iter().all(|area| *area > 0.0), "{triangles:?}");
        assert_eq!(areas.iter().sum::<f64>(), 18.0);
    }

    #[test]
    fn rings_without_area_or_crossing_themselves_are_fans() {
        for points in [
            flat(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0], [4.0, 0.0]]),
            flat(&[[0.0, 0.0]; 6]),
            flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0], [0.5, 2.0]]),
            vec![[1e308, 0.0, 0.0], [-1e308, 0.0, 0.0], [0.0, 1e308, 0.0], [0.0, -1e308, 1.0], [5.0, 0.0, 1e308]],
        ] {
            let triangles = cut(&points);
            assert_eq!(triangles.len(), points.len() - 2);
            let mut cutter = Cutter::new(&points, 0);
            cutter.ring = (0..points.len() as u32).collect();
            cutter.cut = triangles;
            assert!(cutter.fills_ring());
        }
    }

    proptest! {
        /// Star-shaped polygons, concave at random, in random planes, begun at any corner.
        #[test]
        fn any_simple_polygon_is_filled(
            radii in prop::collection::vec(0.05..1.0f64, 4..40),
            axis in 0..3usize,
            start in any::<prop::sample::Index>(),
            reversed in any::<bool>(),
        ) {
            let count = radii.len();
            let mut points: Vec<[f64; 3]> = radii
                .iter()
                .enumerate()
                .map(|(i, radius)| {
                    let angle = std::f64::consts::TAU * i as f64 / count as f64;
                    let (x, y) = (radius * angle.cos(), radius * angle.sin());
                    // In the plane whose normal is 2 in one axis and 1 in the others, seen along that axis.
                    let mut point = [0.0; 3];
                    point[(axis + 1) % 3] = x;
                    point[(axis + 2) % 3] = y;
                    point[axis] = -0.5 * (x + y);
                    point
                })
                .collect();
            if reversed {
                points.reverse();
            }
            let triangles = cut(&points);
            prop_assert_eq!(triangles.len(), count - 2);
            let sign = if reversed { -1.0 } else { 1.0 };
            let position = |vertex: u32| points[vertex as usize];
            let areas: Vec<f64> = triangles
                .iter()
                .map(|&[a, b, c]| sign * cross(sub(position(b), position(a)), sub(position(c), position(a)))[axis])
                .collect();
            prop_assert!(areas.iter().all(|area| *area > -1e-12), "{:?}", areas);
            let whole: f64 = (0..count)
                .map(|i| sign * cross(points[i], points[(i + 1) % count])[axis])
                .sum();
            prop_assert!((areas.iter().sum::<f64>() - whole).abs() < 1e-12);

            let mut turned = points.clone();
            turned.rotate_left(start.index(count));
            prop_assert_eq!(placed(&turned, &cut(&turned)), placed(&points, &triangles));
        }

        /// Rings that may cross and touch themselves, on a coarse grid so that they do.
        #[test]
        fn any_ring_at_all_is_filled_by_its_sides(
            points in prop::collection::vec(prop::array::uniform3(-2..2i8), 4..12),
        ) {
            let points: Vec<[f64; 3]> = points.into_iter().map(|point| point.map(f64::from)).collect();
            let mut cutter = Cutter::new(&points, 0);
            cutter.ring = (0..points.len() as u32).collect();
            cutter.cut = cut(&points);
            prop_assert!(cutter.fills_ring());
        }
    }
}

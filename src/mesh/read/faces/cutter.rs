//! One polygon → triangles.

use std::cmp::Ordering;

use super::ears::Ears;
use crate::mesh::vector::{cross, dot, sub};

/// Cuts polygons and keeps what it allocates.
#[derive(Default)]
pub(super) struct Cutter<'a> {
    vertices: &'a [[f64; 3]],
    /// The triangles of all polygons so far.
    pub triangles: Vec<[u32; 3]>,
    ring: Vec<u32>,
    ears: Ears,
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
            _ => {
                let points = self.ring.iter().map(|&vertex| self.vertices[vertex as usize]);
                self.ears.cut(points, |ear| self.triangles.push(ear.map(|corner| self.ring[corner as usize])));
            }
        }
    }

    /// Turns the ring so that it begins at the corner that is least by (x, y, z), as
    /// [`Mesh::canonical`](crate::mesh::Mesh::canonical) sorts: what follows then depends on the shape, not on where
    /// the file begins the polygon.
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
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Whether triangles are two fewer than a ring's corners, and their sides are the ring's sides once and diagonals
    /// twice, there and back.
    fn fill(triangles: &[[u32; 3]], corners: u32) -> bool {
        let mut sides: Vec<(u32, u32)> = triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        sides.sort_unstable();
        let once = sides.is_sorted_by(|a, b| a < b);
        once && triangles.len() as u32 == corners - 2
            && sides.iter().all(|&(from, to)| (from + 1) % corners == to || sides.binary_search(&(to, from)).is_ok())
    }

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
    fn straight_corners_stay_though_decimals_round() {
        // Along the sides of a triangle, at tenths that no f64 holds.
        let corners: [[f64; 2]; 3] = [[0.1, 0.7], [1.3, 0.3], [0.9, 1.9]];
        let points: Vec<[f64; 2]> = (0..30)
            .map(|i| {
                let (p, q, t) = (corners[i / 10], corners[(i / 10 + 1) % 3], (i % 10) as f64 / 10.0);
                [p[0] + t * (q[0] - p[0]), p[1] + t * (q[1] - p[1])]
            })
            .collect();
        let points = flat(&points);
        let triangles = cut(&points);
        assert!(fill(&triangles, 30));
        assert!(areas(&points, &triangles).into_iter().all(|area| area > 1e-3));
    }

    #[test]
    fn a_bridge_to_a_hole_keeps_the_hole() {
        // A square with a square hole; the ring goes to the hole and back by way of corner 0.
        let points =
            flat(&[[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [0.0, 3.0], [1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0]]);
        let mut cutter = Cutter::new(&points, 0);
        cutter.cut(&[0, 1, 2, 3, 0, 4, 5, 6, 7, 4]);
        let areas = areas(&points, &cutter.triangles);
        assert!(areas.iter().all(|area| *area > 0.0), "{:?}", cutter.triangles);
        assert_eq!(areas.iter().sum::<f64>(), 2.0 * (9.0 - 1.0));
    }

    #[test]
    fn a_ring_that_runs_over_itself_takes_no_longer_than_others() {
        let points = flat(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let mut cutter = Cutter::new(&points, 0);
        let start = std::time::Instant::now();
        cutter.cut(&[0, 1, 2, 3].repeat(1000));
        assert_eq!(cutter.triangles.len(), 3998);
        // Milliseconds; the bound is for a busy machine.
        assert!(start.elapsed().as_secs() < 5);
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
            assert!(fill(&triangles, points.len() as u32));
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
            prop_assert!(fill(&cut(&points), points.len() as u32));
        }
    }
}

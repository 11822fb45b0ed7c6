//! The triangles around a point in the Delaunay triangulation of its neighbours, laid into a plane.
//!
//! Only the triangles at one point are needed, and inversion at that point gives them directly: circles through it
//! become lines, so the triangles with an empty circumcircle are the edges of the convex hull of the inverted
//! neighbours that have the point on their inner side.

use crate::mesh::vector::dot;

/// The sine below which two directions are one.
const PARALLEL: f64 = 1e-9;

/// Points whose spread across is no more than this part of their spread along are on a line.
const LINE: f64 = 1e-5;

/// A neighbour: its number, the vector to it, and the one that decides which triangles there are, which may be another
/// one by little.
pub(super) type Neighbour = (u32, [f64; 3], [f64; 3]);

/// Calls `triangle` with the two other corners of each triangle around a point; none if all lie on a line.
pub(super) fn star(ring: &[Neighbour], mut triangle: impl FnMut(u32, u32)) {
    let arms: Vec<[f64; 3]> = ring.iter().map(|neighbour| neighbour.1).collect();
    let Some([first, second]) = plane(&arms) else { return };
    let flat = ring.iter().map(|&(_, _, arm)| [dot(arm, first), dot(arm, second)]);
    let reach = arms.iter().map(|&arm| dot(arm, arm)).fold(0.0, f64::max);
    let mut inverted: Vec<([f64; 2], u32)> = flat
        .zip(ring)
        .filter_map(|([x, y], &(number, ..))| {
            let square = x * x + y * y;
            (square > 1e-20 * reach).then(|| ([x / square, y / square], number))
        })
        .collect();
    let hull = hull(&mut inverted);
    for (at, &(a, from)) in hull.iter().enumerate() {
        let (b, to) = hull[(at + 1) % hull.len()];
        let turn = a[0] * b[1] - a[1] * b[0];
        if turn > PARALLEL * (a[0].hypot(a[1]) * b[0].hypot(b[1])) {
            triangle(from, to);
        }
    }
}

/// The corners of the convex hull, counterclockwise (Andrew's monotone chain).
fn hull(points: &mut [([f64; 2], u32)]) -> Vec<([f64; 2], u32)> {
    points.sort_unstable_by(|(a, i), (b, j)| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(i.cmp(j)));
    let mut hull: Vec<([f64; 2], u32)> = Vec::with_capacity(points.len() + 1);
    let mut chain = |points: &mut dyn Iterator<Item = &([f64; 2], u32)>| {
        let start = hull.len();
        for &(point, number) in points {
            while let [.., (a, _), (b, _)] = hull[start..] {
                if (b[0] - a[0]) * (point[1] - a[1]) - (b[1] - a[1]) * (point[0] - a[0]) > 0.0 {
                    break;
                }
                hull.pop();
            }
            hull.push((point, number));
        }
        // The last one begins the other chain.
        hull.pop();
    };
    chain(&mut points.iter());
    chain(&mut points.iter().rev());
    hull
}

/// Two orthonormal directions of the plane that fits the ends of the arms and the origin best: those that belong to the
/// two greater eigenvalues of their covariance. `None` where they are on a line.
fn plane(arms: &[[f64; 3]]) -> Option<[[f64; 3]; 2]> {
    let mean = arms.iter().fold([0.0; 3], |sum, arm| [0, 1, 2].map(|at: usize| sum[at] + arm[at]));
    let count = (arms.len() + 1) as f64;
    let mut a = [[0.0; 3]; 3];
    for row in 0..3 {
        for column in 0..3 {
            // About the mean of all points, the centre included.
            let products: f64 = arms.iter().map(|arm| arm[row] * arm[column]).sum();
            a[row][column] = products - mean[row] * mean[column] / count;
        }
    }
    let trace = a[0][0] + a[1][1] + a[2][2];
    if !(trace > 0.0 && trace.is_finite()) {
        return None;
    }
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // Jacobi's rotations converge quadratically: a few rounds do.
    for _ in 0..8 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if a[p][q].abs() <= f64::EPSILON * f64::EPSILON * trace {
                continue;
            }
            let theta = 0.5 * (a[q][q] - a[p][p]) / a[p][q];
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            for row in &mut a {
                (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
            }
            for rows in [&mut a, &mut vectors] {
                let (x, y) = (rows[p], rows[q]);
                rows[p] = [0, 1, 2].map(|at: usize| c * x[at] - s * y[at]);
                rows[q] = [0, 1, 2].map(|at: usize| s * x[at] + c * y[at]);
            }
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&p: &usize, &q: &usize| a[p][p].total_cmp(&a[q][q]));
    let [least, middle, largest] = order;
    (a[middle][middle] > LINE * LINE * a[largest][largest])
        .then_some([vectors[(least + 1) % 3], vectors[(least + 2) % 3]])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles around the origin by testing all circles.
    fn by_circles(points: &[[f64; 2]]) -> Vec<(u32, u32)> {
        let mut found = Vec::new();
        for (i, a) in points.iter().enumerate() {
            for (j, b) in points.iter().enumerate() {
                let turn = a[0] * b[1] - a[1] * b[0];
                if turn <= 0.0 {
                    continue;
                }
                let (aa, bb) = (a[0] * a[0] + a[1] * a[1], b[0] * b[0] + b[1] * b[1]);
                let centre = [(aa * b[1] - bb * a[1]) / (2.0 * turn), (bb * a[0] - aa * b[0]) / (2.0 * turn)];
                let square = centre[0] * centre[0] + centre[1] * centre[1];
                let empty = points
                    .iter()
                    .enumerate()
                    .all(|(k, c)| k == i || k == j || (c[0] - centre[0]).powi(2) + (c[1] - centre[1]).powi(2) > square);
                if empty {
                    found.push((i as u32, j as u32));
                }
            }
        }
        found.sort_unstable();
        found
    }

    #[test]
    fn the_triangles_have_empty_circles() {
        let mut state = 3_u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as f64 / f64::from(1 << 30) - 1.0
        };
        for round in 0..200 {
            // Every other time the origin is outside of the others' hull.
            let shift = if round % 2 == 0 { 0.0 } else { 1.2 };
            let points: Vec<[f64; 2]> = (0..3 + round % 30).map(|_| [next() + shift, next()]).collect();
            let ring: Vec<Neighbour> =
                (0..).zip(&points).map(|(at, p)| (at, [p[0], p[1], 0.0], [p[0], p[1], 0.0])).collect();
            let mut found = Vec::new();
            star(&ring, |a, b| {
                // The plane may be seen from either side.
                let (p, q) = (points[a as usize], points[b as usize]);
                found.push(if p[0] * q[1] - p[1] * q[0] > 0.0 { (a, b) } else { (b, a) });
            });
            found.sort_unstable();
            assert_eq!(found, by_circles(&points), "round {round}");
        }
    }

    #[test]
    fn a_tilted_plane_is_found() {
        let normal = [2.0 / 7.0, 3.0 / 7.0, 6.0 / 7.0];
        let arms: Vec<[f64; 3]> = (0..12)
            .map(|at| {
                let (y, x) = f64::from(at).sin_cos();
                // In the plane: orthogonal to the normal by construction.
                [3.0 * x + 6.0 * y, -2.0 * x, -2.0 * y]
            })
            .collect();
        for direction in plane(&arms).unwrap() {
            assert!(dot(direction, normal).abs() < 1e-12 && (dot(direction, direction) - 1.0).abs() < 1e-12);
        }
        assert_eq!(plane(&[]), None);
        assert_eq!(plane(&[[0.0; 3]; 4]), None);
        assert_eq!(plane(&[[1.0, 2.0, 3.0], [-1.0, -2.0, -3.0], [0.1, 0.2, 0.3]]), None);
    }
}

//! One triangle: its area and the cotangents of its angles.

use crate::mesh::vector::{cross, dot, length, sub};

/// Below this ratio of a triangle's height to its longest edge its metric is mollified. Areas and cotangents of
/// flatter triangles would carry errors above 1e-9.
pub(super) const FLAT: f64 = 1e-7;

/// By how much of its longest edge a flat triangle is opened.
const OPENING: f64 = 1e-6;

/// The metric of one triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct Element {
    /// Area.
    pub area: f64,
    /// Cotangents of the angles at the three corners.
    pub cotangents: [f64; 3],
    /// The lengths were changed.
    pub mollified: bool,
}

/// The metric of the triangle with these corners. `floor` is the smallest length that a triangle without any extent is
/// given.
pub(super) fn element(corners: [[f64; 3]; 3], floor: f64) -> Element {
    let edges = [1, 2, 0].map(|at: usize| sub(corners[(at + 1) % 3], corners[at]));
    let longest = edges.iter().map(|&edge| dot(edge, edge)).fold(0.0, f64::max);
    // The cross product of the two shorter edges loses the least to cancellation.
    let apex = (0..3).max_by(|&a, &b| dot(edges[a], edges[a]).total_cmp(&dot(edges[b], edges[b]))).unwrap_or(0);
    let normal = cross(edges[(apex + 1) % 3], edges[(apex + 2) % 3]);
    let twice = length(normal);
    if twice > FLAT * longest {
        let cotangents = [0, 1, 2].map(|at: usize| -dot(edges[(at + 1) % 3], edges[(at + 2) % 3]) / twice);
        return Element { area: 0.5 * twice, cotangents, mollified: false };
    }
    mollified(edges.map(length), floor)
}

/// Intrinsic mollification (Sharp and Crane 2020, § 4.5) of one triangle: the smallest length that, added to its three
/// edges, makes every triangle inequality hold with room to spare. The paper adds the largest such length of the mesh
/// to all its edges; here only the flat triangles change, so that a good triangle keeps its exact metric.
fn mollified(lengths: [f64; 3], floor: f64) -> Element {
    let longest = lengths.iter().copied().fold(0.0, f64::max).max(floor);
    let room = OPENING * longest;
    let short =
        (0..3).map(|at| lengths[at] - lengths[(at + 1) % 3] - lengths[(at + 2) % 3]).fold(f64::NEG_INFINITY, f64::max);
    let opened = lengths.map(|length| length + (short + room).max(0.0));
    Element { mollified: true, ..of_lengths(opened) }
}

/// The metric of the triangle with these edge lengths, each opposite of its corner. Where they make no triangle, its
/// area is zero and its cotangents are not finite.
pub(super) fn of_lengths(lengths: [f64; 3]) -> Element {
    let area = heron(lengths);
    let cotangents = [0, 1, 2].map(|at: usize| {
        let [a, b, c] = [lengths[at], lengths[(at + 1) % 3], lengths[(at + 2) % 3]];
        (b * b + c * c - a * a) / (4.0 * area)
    });
    Element { area, cotangents, mollified: false }
}

/// Area from the edge lengths, in Kahan's stable order of operations.
fn heron(mut lengths: [f64; 3]) -> f64 {
    lengths.sort_by(|a, b| b.total_cmp(a));
    let [a, b, c] = lengths;
    0.25 * ((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c))).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_right_triangle_has_its_cotangents() {
        let found = element([[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], 1e-3);
        assert!((found.area - 0.5).abs() < 1e-15);
        for (at, cotangent) in [0.0, 1.0, 1.0].into_iter().enumerate() {
            assert!((found.cotangents[at] - cotangent).abs() < 1e-15, "{found:?}");
        }
    }

    #[test]
    fn triangles_without_area_get_a_finite_positive_metric() {
        let [a, b, c] = [[0.0; 3], [1.0, 0.0, 0.0], [0.5, 0.0, 0.0]];
        for corners in [[a, b, c], [a, a, b], [a, b, b], [a, a, a], [c, a, b]] {
            let found = element(corners, 1e-3);
            assert!(found.mollified && found.area > 0.0, "{found:?}");
            // The stiffness of the element is positive semi-definite if and only if no pair of weights sums below 0
            // and the angles add up: cot a cot b + cot b cot c + cot c cot a = 1.
            let [x, y, z] = found.cotangents;
            assert!(x.is_finite() && y.is_finite() && z.is_finite());
            assert!((x * y + y * z + z * x - 1.0).abs() < 1e-3, "{found:?}");
        }
    }

    #[test]
    fn mollified_and_plain_agree_on_a_good_triangle() {
        let corners = [[0.1, 0.2, 0.0], [1.3, -0.2, 0.4], [0.3, 0.9, 0.1]];
        let plain = element(corners, 1e-3);
        let lengths = [1, 2, 0].map(|at: usize| length(sub(corners[(at + 1) % 3], corners[at])));
        let area = heron(lengths);
        assert!((plain.area - area).abs() < 1e-14);
    }
}

//! A surface made ready to be painted.

use crate::mesh::Mesh;

/// A surface in the unit sphere around its centre, with a normal for each vertex.
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    pub(super) points: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Solid {
    /// Centres the surface and scales it into the unit sphere. Triangles that name a missing vertex or a place that is
    /// no number are left out.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let (low, high) = mesh.bounding_box().unwrap_or_default();
        let centre: [f64; 3] = std::array::from_fn(|axis| f64::midpoint(low[axis], high[axis]));
        let far = |point: &[f64; 3]| (0..3).map(|axis| (point[axis] - centre[axis]).powi(2)).sum::<f64>().sqrt();
        let radius = mesh.vertices().iter().map(far).filter(|far| far.is_finite()).fold(0.0, f64::max);
        let scale = if radius > 0.0 { radius.recip() } else { 1.0 };
        let points: Vec<[f32; 3]> = mesh
            .vertices()
            .iter()
            .map(|point| std::array::from_fn(|axis| ((point[axis] - centre[axis]) * scale) as f32))
            .collect();
        let there = |vertex: u32| points.get(vertex as usize).is_some_and(|p| p.iter().all(|x| x.is_finite()));
        let triangles: Vec<[u32; 3]> =
            mesh.triangles().iter().copied().filter(|corners| corners.iter().all(|&v| there(v))).collect();
        let mut normals = vec![[0.0_f32; 3]; points.len()];
        for corners in &triangles {
            let [a, b, c] = corners.map(|vertex| points[vertex as usize]);
            // Its length is twice the area: large triangles weigh more.
            let normal = cross(sub(b, a), sub(c, a));
            for &vertex in corners {
                for (sum, part) in normals[vertex as usize].iter_mut().zip(normal) {
                    *sum += part;
                }
            }
        }
        for normal in &mut normals {
            let length = dot(*normal, *normal).sqrt();
            if length > 0.0 {
                *normal = normal.map(|part| part / length);
            }
        }
        Self { points, normals, triangles }
    }
}

pub(super) fn sub(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(super) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(super) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_shape_of_any_size_fills_the_unit_sphere() {
        let mesh = Mesh::new(vec![[1e6, 0.0, 0.0], [1e6 + 8.0, 0.0, 0.0], [1e6, 6.0, 0.0]], vec![[0, 1, 2], [0, 1, 9]]);
        let solid = Solid::new(&mesh);
        assert_eq!(solid.triangles, [[0, 1, 2]]);
        assert_eq!(solid.normals, [[0.0, 0.0, 1.0]; 3]);
        let far = solid.points.iter().map(|p| dot(*p, *p).sqrt()).fold(0.0, f32::max);
        assert!((far - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_is_no_surface_is_empty() {
        assert!(Solid::new(&Mesh::default()).triangles.is_empty());
        let odd = Mesh::new(vec![[f64::NAN; 3], [0.0; 3], [1.0; 3]], vec![[0, 1, 2]]);
        assert!(Solid::new(&odd).triangles.is_empty());
        assert!(Solid::new(&Mesh::new(vec![[2.0; 3]; 3], vec![[0, 1, 2]])).points.iter().flatten().all(|x| *x == 0.0));
    }
}

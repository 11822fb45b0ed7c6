//! How long edges shall be where: shorter where the surface bends more, and as the tessellation's taste will have it.

use super::random::Random;
use super::vector::{V3, sin_cos};
use crate::mesh::halfedge::{AREA_PER_VERTEX, HalfEdges};

/// How one model is cut into triangles. Two models of one class differ in this too.
#[derive(Debug, Clone)]
pub struct Tessellation {
    /// The number of vertices aimed at.
    pub vertices: usize,
    /// 0: edges of one length everywhere; 1: as long as the radius of curvature.
    pub adapt: f64,
    /// Waves that lengthen edges here and shorten them there: wave vector and phase, in the shape's own unit.
    pub waves: Vec<(V3, f64)>,
    /// The greatest factor of each wave is 1 + this.
    pub depth: f64,
    /// How far vertices are pushed along the surface at the end, in edge lengths.
    pub jitter: f64,
    /// How far vertices are pushed off the surface at the end, in edge lengths.
    pub noise: f64,
}

impl Tessellation {
    /// The tessellation of one model: about `vertices`, in one of four manners, which follow each other in a class.
    pub fn draw(random: &mut Random, index: usize, vertices: usize, size: f64) -> Self {
        let vertices = (random.near(vertices as f64, 0.1)) as usize;
        let plain =
            Self { vertices, adapt: random.between(0.45, 0.7), waves: Vec::new(), depth: 0.0, jitter: 0.0, noise: 0.0 };
        match index % 4 {
            // Even.
            0 => Self { adapt: random.between(0.2, 0.4), ..plain },
            // Fine where it bends, and a little rough, as a scan is.
            1 => Self { adapt: random.between(0.7, 0.9), noise: random.between(0.015, 0.035), ..plain },
            // Irregular triangles.
            2 => Self { jitter: random.between(0.15, 0.3), ..plain },
            // Fine in places and coarse in others.
            _ => {
                let wave = |random: &mut Random| {
                    let along = V3 { x: random.bell(), y: random.bell(), z: random.bell() }.unit();
                    (along * (random.between(3.0, 9.0) / size), random.between(0.0, 6.0))
                };
                let waves = (0..2).map(|_| wave(random)).collect();
                Self { waves, depth: random.between(0.2, 0.4), noise: random.between(0.0, 0.02), ..plain }
            }
        }
    }

    /// The taste for long edges at `p`: 1 on average.
    fn taste(&self, p: V3) -> f64 {
        self.waves.iter().map(|(wave, phase)| 1.0 + self.depth * sin_cos(wave.dot(p) + phase).0).product()
    }
}

/// The wanted length of the edges at every vertex of `mesh`, such that meshes of those lengths have about `count`
/// vertices; `bends` are the curvatures there. Slots of removed vertices hold 0.
pub fn sizes(mesh: &HalfEdges, style: &Tessellation, bends: &[f64], count: f64) -> Vec<f64> {
    let areas = vertex_areas(mesh);
    let mean = even_length(mesh, count);
    let slots = mesh.vertex_slots() as usize;
    let mut taste = vec![0.0; slots];
    let mut longest = vec![0.0; slots];
    for a in (0..slots).filter(|&a| mesh.has_vertex(a as u32)) {
        let radius = (1.0 / bends[a].max(1e-9)).clamp(0.45 * mean, 4.0 * mean);
        // radius^adapt, between its geometric neighbours, without a power function.
        let eased = ease(radius / mean, style.adapt) * mean;
        taste[a] = eased * style.taste(mesh.points[a]);
        longest[a] = (1.1 * radius).min(0.6 * mean + 0.45 * radius);
    }
    let vertices_at = |scale: f64| -> f64 {
        let of = |a: usize| (scale * taste[a]).min(longest[a]);
        (0..slots).filter(|&a| areas[a] > 0.0).map(|a| areas[a] / (AREA_PER_VERTEX * of(a) * of(a))).sum()
    };
    let (mut low, mut high) = (0.02, 50.0);
    for _ in 0..40 {
        let middle = 0.5 * (low + high);
        if vertices_at(middle) > count { low = middle } else { high = middle }
    }
    // Where the curvature alone asks for more than `count`, its bound gives way.
    let excess = (vertices_at(high) / count).max(1.0).sqrt();
    let mut wanted: Vec<f64> =
        (0..slots).map(|a| if taste[a] > 0.0 { (high * taste[a]).min(longest[a]) * excess } else { 0.0 }).collect();
    grade(mesh, &mut wanted);
    wanted
}

/// The length of the edges of an even mesh of the same area with `count` vertices.
pub fn even_length(mesh: &HalfEdges, count: f64) -> f64 {
    (vertex_areas(mesh).iter().sum::<f64>() / (AREA_PER_VERTEX * count)).sqrt()
}

/// About `x` to the power `t` in 0…1, for x between 1/4 and 4: Padé's approximant of the logarithm's flow.
fn ease(x: f64, t: f64) -> f64 {
    // The weighted harmonic–arithmetic mean of x and 1 is within 8 % of the power there, and monotonic.
    let arithmetic = 1.0 + t * (x - 1.0);
    let harmonic = x / (t + (1.0 - t) * x);
    (arithmetic * harmonic).sqrt()
}

/// Lets sizes grow along the surface by no more than 0.45 per unit of length.
fn grade(mesh: &HalfEdges, wanted: &mut [f64]) {
    for _ in 0..4 {
        for h in (0..mesh.slots()).filter(|&h| mesh.has(h)) {
            let (a, b) = (mesh.start(h) as usize, mesh.end(h) as usize);
            wanted[b] = wanted[b].min(wanted[a] + 0.45 * mesh.length(h));
        }
    }
}

/// A third of the area around each vertex.
fn vertex_areas(mesh: &HalfEdges) -> Vec<f64> {
    let mut areas = vec![0.0; mesh.vertex_slots() as usize];
    for [a, b, c] in mesh.triangles() {
        let (p, q, r) = (mesh.point(a), mesh.point(b), mesh.point(c));
        let third = (q - p).cross(r - p).norm() / 6.0;
        for corner in [a, b, c] {
            areas[corner as usize] += third;
        }
    }
    areas
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn easing_is_a_power_between_its_ends() {
        for x in [0.25, 0.5, 1.0, 2.0, 4.0_f64] {
            assert!((ease(x, 0.0) - 1.0).abs() < 1e-12 && (ease(x, 1.0) - x).abs() < 1e-12);
            assert!((ease(x, 0.5) / x.powf(0.5) - 1.0).abs() < 0.08, "{x}");
        }
    }
}

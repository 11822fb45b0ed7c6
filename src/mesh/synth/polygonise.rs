//! Field → closed oriented surface, by marching tetrahedra.
//!
//! Every cube of a grid is cut into the six tetrahedra around its main diagonal, so that neighbours agree on their
//! common face. Inside a tetrahedron the field is taken as linear; its zero set is then a closed oriented 2-manifold
//! for any values at the grid's points, as none counts as zero. (Doi and Koide 1991.)

use super::solid::{Bounds, Solid};
use super::vector::{V3, v};

/// A triangle surface under construction.
#[derive(Debug, Clone, Default)]
pub struct Surface {
    pub points: Vec<V3>,
    pub triangles: Vec<[u32; 3]>,
}

/// The edges from a grid point, as steps along x, y, z in bits 0, 1, 2: kind 1…7.
const KINDS: usize = 8;

/// The corners of the six tetrahedra, as bits of the steps from the cube's low corner, and whether they are
/// right-handed.
const TETRAHEDRA: [([usize; 4], bool); 6] = [
    ([0, 1, 3, 7], true),
    ([0, 2, 6, 7], true),
    ([0, 4, 5, 7], true),
    ([0, 2, 3, 7], false),
    ([0, 4, 6, 7], false),
    ([0, 1, 5, 7], false),
];

/// Cells to a side of the blocks that are skipped as a whole when the surface cannot pass through them.
const BLOCK: usize = 8;

/// The field on a regular grid.
struct Grid {
    origin: V3,
    step: f64,
    /// Points along x, y, z.
    counts: [usize; 3],
    values: Vec<f64>,
}

impl Grid {
    fn sample(solid: &Solid, bounds: Bounds, step: f64) -> Self {
        let bounds = bounds.grown(1.5 * step);
        let size = bounds.extent();
        let counts = [size.x, size.y, size.z].map(|s| (s / step).ceil() as usize + 1);
        let mut grid = Self { origin: bounds.low, step, counts, values: vec![f64::NAN; counts.iter().product()] };
        for z in (0..counts[2]).step_by(BLOCK) {
            for y in (0..counts[1]).step_by(BLOCK) {
                for x in (0..counts[0]).step_by(BLOCK) {
                    grid.fill_block(solid, [x, y, z]);
                }
            }
        }
        grid
    }

    /// Samples the block that starts at `low`; where the field at its middle says that the surface is far, that value
    /// stands for all.
    fn fill_block(&mut self, solid: &Solid, low: [usize; 3]) {
        let half = 0.5 * (BLOCK - 1) as f64;
        let middle = self.origin + v(low[0] as f64 + half, low[1] as f64 + half, low[2] as f64 + half) * self.step;
        let there = solid.distance(middle);
        // The half diagonal of the block and one cell around it, with room for a slope up to 1.3.
        let far = there.abs() > 1.3 * 1.733 * (half + 1.0) * self.step;
        for z in low[2]..(low[2] + BLOCK).min(self.counts[2]) {
            for y in low[1]..(low[1] + BLOCK).min(self.counts[1]) {
                for x in low[0]..(low[0] + BLOCK).min(self.counts[0]) {
                    let index = self.index(x, y, z);
                    self.values[index] = if far { there } else { solid.distance(self.point(x, y, z)) };
                }
            }
        }
    }

    fn index(&self, x: usize, y: usize, z: usize) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    fn point(&self, x: usize, y: usize, z: usize) -> V3 {
        self.origin + v(x as f64, y as f64, z as f64) * self.step
    }
}

/// The vertices on the edges that start in one layer of the grid, and in the next.
struct Layers {
    width: usize,
    here: Vec<u32>,
    above: Vec<u32>,
}

const UNSET: u32 = u32::MAX;

/// The zero set of `solid` on a grid of the given `step`: closed, oriented outwards, manifold; of several components
/// and of another genus than the solid's where the solid is thinner than the grid.
pub fn polygonise(solid: &Solid, step: f64) -> Surface {
    let grid = Grid::sample(solid, solid.bounds(), step);
    let [nx, ny, nz] = grid.counts;
    let mut surface = Surface::default();
    let mut layers = Layers { width: nx, here: vec![UNSET; nx * ny * KINDS], above: vec![UNSET; nx * ny * KINDS] };
    for z in 0..nz.saturating_sub(1) {
        for y in 0..ny - 1 {
            for x in 0..nx - 1 {
                march_cube(&grid, [x, y, z], &mut layers, &mut surface);
            }
        }
        std::mem::swap(&mut layers.here, &mut layers.above);
        layers.above.fill(UNSET);
    }
    surface
}

fn march_cube(grid: &Grid, low: [usize; 3], layers: &mut Layers, surface: &mut Surface) {
    let values: [f64; 8] =
        std::array::from_fn(|c| grid.values[grid.index(low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2))]);
    let inside = values.iter().filter(|&&value| value < 0.0).count();
    if inside == 0 || inside == 8 {
        return;
    }
    for (corners, right_handed) in TETRAHEDRA {
        // In an even permutation: the corners inside first, then those outside.
        let mut order = corners;
        let mut even = right_handed;
        for end in (1..4).rev() {
            for i in 0..end {
                if values[order[i]] >= 0.0 && values[order[i + 1]] < 0.0 {
                    order.swap(i, i + 1);
                    even = !even;
                }
            }
        }
        let [a, b, c, d] = order;
        let mut edge = |p: usize, q: usize| vertex_on(grid, low, &values, p.min(q), p.max(q), layers, surface);
        let facets: &[[u32; 3]] = match order.iter().filter(|&&corner| values[corner] < 0.0).count() {
            1 => &[[edge(a, b), edge(a, c), edge(a, d)]],
            2 => {
                let (ac, ad, bd, bc) = (edge(a, c), edge(a, d), edge(b, d), edge(b, c));
                &[[ac, ad, bd], [ac, bd, bc]]
            }
            3 => &[[edge(a, d), edge(b, d), edge(c, d)]],
            _ => &[],
        };
        surface.triangles.extend(facets.iter().map(|&[p, q, r]| if even { [p, q, r] } else { [p, r, q] }));
    }
}

/// The vertex where the surface crosses the edge between two corners of the cube at `low`, made at its first use.
fn vertex_on(
    grid: &Grid,
    low: [usize; 3],
    values: &[f64; 8],
    from: usize,
    to: usize,
    layers: &mut Layers,
    surface: &mut Surface,
) -> u32 {
    let [x, y] = [low[0] + (from & 1), low[1] + (from >> 1 & 1)];
    let slot = (y * layers.width + x) * KINDS + (to ^ from);
    let known = if from & 4 == 0 { &mut layers.here[slot] } else { &mut layers.above[slot] };
    if *known == UNSET {
        *known = surface.points.len() as u32;
        let corner = |c: usize| grid.point(low[0] + (c & 1), low[1] + (c >> 1 & 1), low[2] + (c >> 2));
        // Away from the ends, where vertices would crowd around the grid's points: re-meshing projects them anyway.
        let t = (values[from] / (values[from] - values[to])).clamp(0.15, 0.85);
        surface.points.push(corner(from).lerp(corner(to), t));
    }
    *known
}

#[cfg(test)]
mod tests {
    use super::super::primitive::Primitive;
    use super::super::vector::Frame;
    use super::*;

    /// Six times the volume that the surface encloses.
    fn volume6(surface: &Surface) -> f64 {
        let p = |i: u32| surface.points[i as usize];
        surface.triangles.iter().map(|&[a, b, c]| p(a).dot(p(b).cross(p(c)))).sum()
    }

    /// V − E + F, after checking that every edge is met once in each direction.
    fn euler(surface: &Surface) -> i64 {
        let mut edges: Vec<(u32, u32)> =
            surface.triangles.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        edges.sort_unstable();
        assert!(edges.windows(2).all(|w| w[0] != w[1]), "an edge is met twice in one direction");
        assert!(edges.iter().all(|&(a, b)| edges.binary_search(&(b, a)).is_ok()), "an edge has one side only");
        surface.points.len() as i64 - edges.len() as i64 / 2 + surface.triangles.len() as i64
    }

    #[test]
    fn a_ball_is_a_sphere() {
        let surface = polygonise(&Primitive::ellipsoid(Frame::at(v(0.1, 0.2, 0.3)), v(1.0, 1.0, 1.0)).into(), 0.1);
        assert_eq!(euler(&surface), 2);
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume6(&surface) / 6.0 / exact - 1.0).abs() < 0.01);
    }

    #[test]
    fn a_ring_is_a_torus() {
        let frame = Frame::at(v(0.0, 0.0, 0.0)).turned(v(0.6, 0.0, 0.8), 0.4);
        let surface = polygonise(&Primitive::ring(frame, 1.0, 0.3).into(), 0.09);
        assert_eq!(euler(&surface), 0);
        assert!(volume6(&surface) > 0.0);
    }

    #[test]
    fn a_body_thinner_than_the_grid_is_still_closed() {
        let needle = Primitive::limb(v(-1.0, -0.7, 0.1), v(1.0, 0.9, 0.4), 0.03, 0.01);
        let surface = polygonise(&needle.into(), 0.1);
        assert_eq!(euler(&surface) % 2, 0);
    }
}

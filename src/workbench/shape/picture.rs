//! A z-buffer: the nearest surface at each pixel, its shade, and the value of a function on it.

use std::sync::Arc;

use super::{
    Camera, Packed, Solid,
    solid::{dot, sub},
};

/// The part of the width and height that the unit sphere takes.
const FILL: f32 = 0.96;
/// Light that comes from everywhere.
const AMBIENT: f32 = 0.18;
/// Where the light comes from, in the screen's axes: over the left shoulder.
const LIGHT: [f32; 3] = [-0.48, 0.62, 0.62];
/// A neighbour that is nearer by so much casts a line: limbs before a body stand out without colour.
const STEP: f32 = 0.05;
/// So far outside of a triangle, in parts of it, a pixel still belongs to it.
const EDGE: f32 = 1e-4;
/// How dark such a line is.
const LINE: f32 = 0.45;

/// What is seen at each pixel, row after row from the upper left.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// From 0, dark, to 1, lit; below 0 where nothing is seen.
    pub shades: Vec<f32>,
    /// The function's value, from −1 to 1; 0 without one.
    pub values: Vec<f32>,
    /// The picture as the terminal takes it, for [`Style::Pixels`](super::Style::Pixels) alone.
    pub packed: Option<Arc<Packed>>,
}

impl Picture {
    /// Paints a surface. `aspect` is how much higher than wide a pixel is; `values` has a value for each vertex, of any
    /// size.
    #[must_use]
    pub fn paint(
        solid: &Solid,
        camera: Camera,
        (width, height): (usize, usize),
        aspect: f32,
        values: Option<&[f64]>,
    ) -> Self {
        let mut picture =
            Self { width, height, shades: vec![-1.0; width * height], values: vec![0.0; width * height], packed: None };
        let mut depths = vec![f32::NEG_INFINITY; width * height];
        let axes = camera.axes();
        let half = (width as f32).min(height as f32 * aspect) / 2.0 * FILL * camera.scale();
        let (mid_x, mid_y) = (width as f32 / 2.0, height as f32 / 2.0);
        let seen: Vec<Corner> = solid
            .points
            .iter()
            .zip(&solid.normals)
            .enumerate()
            .map(|(vertex, (point, normal))| Corner {
                x: mid_x + half * dot(axes[0], *point),
                y: mid_y - half * dot(axes[1], *point) / aspect,
                depth: dot(axes[2], *point),
                shade: shade(axes.map(|axis| dot(axis, *normal))),
                value: values.and_then(|values| values.get(vertex)).map_or(0.0, |value| *value as f32),
            })
            .collect();
        for corners in &solid.triangles {
            picture.triangle(&mut depths, corners.map(|vertex| seen[vertex as usize]));
        }
        if solid.triangles.is_empty() {
            for corner in &seen {
                picture.point(&mut depths, *corner);
            }
        }
        picture.scale_values();
        picture.lines(&depths);
        picture
    }

    /// Fills a triangle where nothing nearer is.
    fn triangle(&mut self, depths: &mut [f32], [a, b, c]: [Corner; 3]) {
        let area = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let range = |low: f32, high: f32, end: usize| {
            // Pixels whose centre lies between the two.
            let first = (low - 0.5).ceil().max(0.0) as usize;
            let last = (high - 0.5).floor().min(end as f32 - 1.0);
            if last < 0.0 { 0..0 } else { first..(last as usize + 1) }
        };
        let columns = range(a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x), self.width);
        for row in range(a.y.min(b.y).min(c.y), a.y.max(b.y).max(c.y), self.height) {
            let y = row as f32 + 0.5;
            for column in columns.clone() {
                let x = column as f32 + 0.5;
                let u = ((b.x - x) * (c.y - y) - (c.x - x) * (b.y - y)) / area;
                let v = ((c.x - x) * (a.y - y) - (a.x - x) * (c.y - y)) / area;
                let w = 1.0 - u - v;
                // A pixel on an edge between two triangles belongs to one of them at least, however it is rounded.
                if u.min(v).min(w) < -EDGE {
                    continue;
                }
                let mix = |of: fn(&Corner) -> f32| u * of(&a) + v * of(&b) + w * of(&c);
                let depth = mix(|corner| corner.depth);
                let at = row * self.width + column;
                if depth > depths[at] {
                    depths[at] = depth;
                    self.shades[at] = mix(|corner| corner.shade).clamp(0.0, 1.0);
                    self.values[at] = mix(|corner| corner.value);
                }
            }
        }
    }

    /// A point of a cloud: nearer ones are lighter.
    fn point(&mut self, depths: &mut [f32], point: Corner) {
        let (column, row) = (point.x.floor(), point.y.floor());
        if column < 0.0 || row < 0.0 || column >= self.width as f32 || row >= self.height as f32 {
            return;
        }
        let at = row as usize * self.width + column as usize;
        if point.depth > depths[at] {
            depths[at] = point.depth;
            self.shades[at] = (0.6 + 0.4 * point.depth).clamp(0.0, 1.0);
            self.values[at] = point.value;
        }
    }

    /// Scales the values so that the greatest that is seen, whatever its sign, is 1.
    fn scale_values(&mut self) {
        let most = self.values.iter().map(|value| value.abs()).filter(|value| value.is_finite()).fold(0.0, f32::max);
        for value in &mut self.values {
            *value = if most > 0.0 && value.is_finite() { *value / most } else { 0.0 };
        }
    }

    /// Darkens what lies just behind an edge.
    fn lines(&mut self, depths: &[f32]) {
        let (width, height) = (self.width, self.height);
        for row in 0..height {
            for column in 0..width {
                let at = row * width + column;
                if self.shades[at] < 0.0 {
                    continue;
                }
                let sides = [
                    (column > 0).then(|| at - 1),
                    (column + 1 < width).then(|| at + 1),
                    (row > 0).then(|| at - width),
                    (row + 1 < height).then(|| at + width),
                ];
                if sides.into_iter().flatten().any(|side| depths[side] > depths[at] + STEP) {
                    self.shades[at] *= LINE;
                }
            }
        }
    }

    /// The shade and the value of a pixel; none where nothing is seen.
    #[must_use]
    pub fn at(&self, column: usize, row: usize) -> Option<(f32, f32)> {
        let at = (column < self.width && row < self.height).then(|| row * self.width + column)?;
        (self.shades[at] >= 0.0).then(|| (self.shades[at], self.values[at]))
    }
}

/// A vertex as it is seen.
#[derive(Clone, Copy)]
struct Corner {
    x: f32,
    y: f32,
    depth: f32,
    shade: f32,
    value: f32,
}

/// How light a surface with this normal is. Which way round a surface lies is not known: what faces away is turned.
fn shade(normal: [f32; 3]) -> f32 {
    let facing = if normal[2] < 0.0 { sub([0.0; 3], normal) } else { normal };
    let lit = dot(facing, LIGHT).max(0.0);
    // A little from the eye as well, so that nothing that is seen is black.
    AMBIENT + 0.62 * lit + 0.2 * facing[2]
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;
    use crate::mesh::{Mesh, synth};

    const FRONT: Camera = Camera { yaw: 0, pitch: 0, zoom: 0 };

    /// A square in the plane of the screen at a height.
    fn square(z: f64, size: f64) -> (Vec<[f64; 3]>, Vec<[u32; 3]>) {
        (vec![[-size, -size, z], [size, -size, z], [size, size, z], [-size, size, z]], vec![[0, 1, 2], [0, 2, 3]])
    }

    #[test]
    fn a_square_is_filled_without_gaps() {
        let (vertices, triangles) = square(0.0, 1.0);
        let solid = Solid::new(&Mesh::new(vertices, triangles));
        let picture = Picture::paint(&solid, FRONT, (40, 40), 1.0, None);
        // Half the diagonal is the unit: the side is 40 · 0.96 / √2 = 27.2 pixels, from 6.4 to 33.6.
        let within =
            |row: usize, column: usize, rim: usize| (rim..40 - rim).contains(&row) && (rim..40 - rim).contains(&column);
        for row in 0..40 {
            for column in 0..40 {
                let seen = picture.at(column, row).is_some();
                assert!(seen || !within(row, column, 7), "a gap at {column} {row}");
                assert!(!seen || within(row, column, 6), "more than the square at {column} {row}");
            }
        }
        let (shade, value) = picture.at(20, 20).unwrap();
        assert!(shade > 0.5 && value == 0.0);
        assert!(picture.at(40, 0).is_none());
    }

    #[test]
    fn what_is_nearer_hides_what_is_farther_whatever_the_order() {
        let (mut vertices, mut triangles) = square(0.5, 0.3);
        let (far, others) = square(-0.5, 1.0);
        vertices.extend(far);
        triangles.extend(others.into_iter().map(|corners| corners.map(|vertex| vertex + 4)));
        let values = [1.0, 1.0, 1.0, 1.0, -0.5, -0.5, -0.5, -0.5];
        for reversed in [false, true] {
            let mut triangles = triangles.clone();
            if reversed {
                triangles.reverse();
            }
            let solid = Solid::new(&Mesh::new(vertices.clone(), triangles));
            let picture = Picture::paint(&solid, FRONT, (60, 60), 1.0, Some(&values));
            assert_eq!(picture.at(30, 30).unwrap().1, 1.0);
            assert_eq!(picture.at(15, 15).unwrap().1, -0.5);
            // Just beside the near square the far one is darker than in its middle.
            let row: Vec<f32> = (0..60).filter_map(|column| picture.at(column, 30)).map(|(shade, _)| shade).collect();
            assert!(row.iter().any(|shade| *shade < 0.5 * row[0]), "{row:?}");
        }
    }

    #[test]
    fn pixels_that_are_higher_than_wide_keep_the_proportions() {
        let (vertices, triangles) = square(0.0, 1.0);
        let solid = Solid::new(&Mesh::new(vertices, triangles));
        let picture = Picture::paint(&solid, FRONT, (80, 40), 2.0, None);
        let wide = (0..80).filter(|&column| picture.at(column, 20).is_some()).count();
        let high = (0..40).filter(|&row| picture.at(40, row).is_some()).count();
        assert!(wide.abs_diff(2 * high) <= 2, "{wide} {high}");
    }

    #[test]
    fn a_cloud_is_drawn_point_by_point() {
        let cloud = Mesh::new(vec![[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]], Vec::new());
        let picture = Picture::paint(&Solid::new(&cloud), FRONT, (40, 40), 1.0, None);
        assert_eq!(picture.shades.iter().filter(|shade| **shade >= 0.0).count(), 2);
    }

    #[test]
    fn nothing_to_see_and_no_room_are_empty() {
        let solid = Solid::new(&Mesh::default());
        assert!(Picture::paint(&solid, FRONT, (9, 9), 1.0, None).shades.iter().all(|shade| *shade < 0.0));
        assert_eq!(Picture::paint(&solid, FRONT, (0, 0), 1.0, None), Picture::default());
    }

    #[test]
    fn ten_thousand_vertices_take_a_few_milliseconds() {
        let options = synth::Options { vertices: 10_000, ..synth::Options::default() };
        let solid = Solid::new(&synth::generate(&options, 0, 0).unwrap());
        let quickest = (0..9)
            .map(|yaw| {
                let start = Instant::now();
                let picture = Picture::paint(&solid, Camera { yaw, ..FRONT }, (240, 200), 1.0, None);
                assert!(picture.shades.iter().any(|shade| *shade >= 0.0));
                start.elapsed()
            })
            .min()
            .unwrap();
        // A frame of 60 to the second has 16 ms; the bound leaves room for a busy machine and debug assertions.
        assert!(quickest < Duration::from_millis(16), "{quickest:?}");
    }
}

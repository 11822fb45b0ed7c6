//! A shape for print: painted finely on white ground.

use std::ops::Range;

use super::{Picture, Scene, Solid};
use crate::figure::{Bar, Portrait};

/// Pixels of the side; each is the mean of [`FINE`] × [`FINE`] painted ones.
const SIDE: usize = 1440;
const FINE: usize = 2;
/// Ends and middle of the colours of a function: dark blue, grey, yellow. Their lightness grows with the value, so that
/// grey print keeps the order, and colour-blind readers see it (after cividis, Nuñez, Anderton and Renslow 2018).
const COLOURS: [[f32; 3]; 3] = [[0.0, 34.0, 78.0], [124.0, 123.0, 120.0], [255.0, 233.0, 69.0]];
/// A surface without a function.
const PLAIN: [f32; 3] = [222.0, 226.0, 232.0];
/// Where a function is 0.
const NODAL: [f32; 3] = [0.0, 0.0, 0.0];

impl Scene {
    /// Paints the scene for print, cut to what is seen, whatever cells it has on the screen. Takes some tenths of a
    /// second.
    #[must_use]
    pub fn portrait(&self, title: &str, caption: &str) -> Portrait {
        let solid = Solid::new(&self.mesh);
        let values = self.function.as_ref().map(|function| function.values.as_slice());
        let side = SIDE * FINE;
        let picture = Picture::paint(&solid, self.camera, (side, side), 1.0, values);
        let (rows, columns) = bounds(&picture);
        let mut pixels = Vec::with_capacity(3 * rows.len() * columns.len());
        for (row, column) in rows.clone().flat_map(|row| columns.clone().map(move |column| (row, column))) {
            let mut sum = [0.0_f32; 3];
            for (dy, dx) in (0..FINE).flat_map(|dy| (0..FINE).map(move |dx| (dy, dx))) {
                let seen = seen(&picture, column * FINE + dx, row * FINE + dy, values.is_some());
                sum.iter_mut().zip(seen).for_each(|(sum, part)| *sum += part);
            }
            pixels.extend(sum.map(|sum| (sum / (FINE * FINE) as f32).round().clamp(0.0, 255.0) as u8));
        }
        let colours = (0..64).map(|at| colour(at as f32 / 31.5 - 1.0).map(|part| part.round() as u8)).collect();
        let bar = self.function.as_ref().map(|function| Bar {
            label: format!("eigenfunction {}, of its greatest value", function.index),
            ends: ["−1", "0", "1"].map(str::to_owned),
            colours,
        });
        let (width, height) = (columns.len() as u32, rows.len() as u32);
        Portrait { title: title.to_owned(), caption: caption.to_owned(), width, height, pixels, bar }
    }
}

/// Rows and columns of the print that hold something, with a margin; at least a third of the side each way.
fn bounds(picture: &Picture) -> (Range<usize>, Range<usize>) {
    let seen = |row: usize, column: usize| picture.at(column * FINE, row * FINE).is_some();
    let cut = |any: &dyn Fn(usize) -> bool| {
        let first = (0..SIDE).find(|&at| any(at)).unwrap_or(0);
        let last = (0..SIDE).rev().find(|&at| any(at)).unwrap_or(SIDE - 1);
        let margin = SIDE / 40;
        let (from, to) = (first.saturating_sub(margin), (last + 1 + margin).min(SIDE));
        let lacking = (SIDE / 3).saturating_sub(to - from).div_ceil(2);
        from.saturating_sub(lacking)..(to + lacking).min(SIDE)
    };
    (cut(&|row| (0..SIDE).any(|column| seen(row, column))), cut(&|column| (0..SIDE).any(|row| seen(row, column))))
}

/// What a painted pixel is drawn with.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Ink {
    /// A surface without a function, from 0, dark, to 1, lit.
    Plain { shade: f32 },
    /// The value of a function, from −1 to 1, and the shade.
    Valued { shade: f32, value: f32 },
    /// Where a function is 0.
    Nodal,
}

/// What a painted pixel is drawn with; none where nothing is seen.
pub(super) fn ink(picture: &Picture, column: usize, row: usize, coloured: bool) -> Option<Ink> {
    let (shade, value) = picture.at(column, row)?;
    if !coloured {
        return Some(Ink::Plain { shade });
    }
    let crosses = |other: Option<(f32, f32)>| other.is_some_and(|(_, other)| (other < 0.0) != (value < 0.0));
    let nodal = crosses(picture.at(column + 1, row)) || crosses(picture.at(column, row + 1));
    Some(if nodal { Ink::Nodal } else { Ink::Valued { shade, value } })
}

impl Ink {
    /// Red, green and blue, from 0 to 255.
    fn colour(self) -> [f32; 3] {
        match self {
            Self::Plain { shade } => PLAIN.map(|part| part * (0.25 + 0.75 * shade)),
            Self::Valued { shade, value } => colour(value).map(|part| part * (0.5 + 0.5 * shade)),
            Self::Nodal => NODAL,
        }
    }

    /// The same in whole numbers.
    pub(super) fn parts(self) -> [u8; 3] {
        self.colour().map(|part| part.round().clamp(0.0, 255.0) as u8)
    }
}

/// The colour of a painted pixel on white ground.
fn seen(picture: &Picture, column: usize, row: usize, coloured: bool) -> [f32; 3] {
    ink(picture, column, row, coloured).map_or([255.0; 3], Ink::colour)
}

/// The colour of a value from −1 to 1.
fn colour(value: f32) -> [f32; 3] {
    let value = value.clamp(-1.0, 1.0);
    let (from, to, part) =
        if value < 0.0 { (COLOURS[0], COLOURS[1], value + 1.0) } else { (COLOURS[1], COLOURS[2], value) };
    std::array::from_fn(|at| from[at] + part * (to[at] - from[at]))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::{
        super::{Camera, Function, Raster, Style},
        *,
    };
    use crate::mesh::Mesh;

    #[test]
    fn colours_grow_lighter_with_the_value() {
        let light = |value: f32| {
            let [r, g, b] = colour(value);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let lights: Vec<f32> = (0..=20).map(|at| light(at as f32 / 10.0 - 1.0)).collect();
        assert!(lights.windows(2).all(|pair| pair[0] < pair[1]), "{lights:?}");
    }

    #[test]
    fn a_function_is_split_where_it_is_zero() {
        let vertices = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        let values = vertices.iter().map(|vertex| vertex[0]).collect();
        let scene = Scene {
            model: 0,
            mesh: Arc::new(Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]])),
            function: Some(Function { index: 2, values: Arc::new(values) }),
            camera: Camera { yaw: 0, pitch: 0, zoom: 0 },
            cells: (4, 2),
            style: Style::Dots,
            raster: Raster::default(),
        };
        let portrait = scene.portrait("a square", "");
        let (wide, high) = (portrait.width as usize, portrait.height as usize);
        assert_eq!(portrait.pixels.len(), 3 * wide * high);
        assert!(wide.abs_diff(high) < 3 && wide < SIDE, "cut to the square");
        let at = |x: usize, y: usize| &portrait.pixels[3 * (y * wide + x)..][..3];
        let (left, right) = (at(wide / 4, high / 2), at(3 * wide / 4, high / 2));
        assert!(left[0] < left[2] && right[0] > right[2], "{left:?} {right:?}");
        let dark = |x: usize| at(x, high / 2).iter().all(|part| *part < 90);
        assert!((wide / 2 - 2..wide / 2 + 2).any(dark), "a line where it is 0");
        assert_eq!(at(3, 3), [255; 3]);
        assert!(portrait.bar.is_some());
    }
}

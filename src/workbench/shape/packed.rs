//! Pictures as terminals take them: the same pixels, as a PNG that the terminal scales or as sixels that it does not.

use super::{
    Picture,
    portrait::{self, Ink},
};
use crate::figure::{
    self,
    sixel::{CLEAR, Indexed},
};

/// How a terminal takes pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Packing {
    /// As a PNG, which it fits to so many cells.
    Png,
    /// As sixels of so many colours at most, 2 at least, each a pixel of its own.
    Sixels {
        /// Registers for colours.
        colours: u16,
    },
}

/// How a terminal takes pictures, and the size of its cells.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Raster {
    /// How.
    pub packing: Packing,
    /// Pixels of a cell, across and down.
    pub cell: (u16, u16),
}

impl Default for Raster {
    /// A PNG for the size of a common cell: the terminal fits the picture to its own.
    fn default() -> Self {
        Self { packing: Packing::Png, cell: (8, 16) }
    }
}

/// A picture on its way to a terminal.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Packed {
    /// One that is a PNG; or any number, each the sequence that draws it at the cursor.
    pub parts: Vec<Part>,
    /// What it covers of each of its cells, row after row.
    pub cover: Vec<Cover>,
}

/// A part of a picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// Its upper left corner, a column and a row of the picture's cells.
    pub cell: (u16, u16),
    /// What it is.
    pub bytes: Vec<u8>,
}

impl Packed {
    /// Bytes of all parts.
    #[must_use]
    pub fn bytes(&self) -> usize {
        self.parts.iter().map(|part| part.bytes.len()).sum()
    }
}

/// What a picture covers of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cover {
    /// Nothing.
    Clear,
    /// Something.
    Part,
    /// All of it.
    Whole,
}

/// Packs a picture whose pixels are `scale` × `scale` of the terminal's, over so many cells. `rough` saves bytes. None
/// where there are no pixels.
pub(super) fn pack(
    picture: &Picture,
    coloured: bool,
    raster: Raster,
    cells: (u16, u16),
    (scale, rough): (usize, bool),
) -> Option<Packed> {
    let size = (cells.0 as usize * raster.cell.0 as usize, cells.1 as usize * raster.cell.1 as usize);
    if picture.shades.is_empty() || size.0 * size.1 == 0 {
        return None;
    }
    let cover = cover(picture, raster, cells, scale);
    let parts = match raster.packing {
        Packing::Png => vec![Part { cell: (0, 0), bytes: png(picture, coloured)? }],
        Packing::Sixels { colours } => {
            let colours = colours.min(u16::from(CLEAR));
            let colours = if rough { (colours / 4).max(colours.min(16)) } else { colours };
            sixels(
                picture,
                &Inks::new(coloured, usize::from(colours)),
                raster.cell,
                &tiles(&cover, cells.0, raster.cell),
                scale,
            )
        }
    };
    Some(Packed { parts, cover })
}

/// A rectangle of cells: column, row, columns and rows.
type Tile = (u16, u16, u16, u16);

/// More pixels each way xterm refuses in one picture (its resource maxGraphicSize).
const LARGEST: u16 = 1000;

/// The cells that a picture covers, as rectangles that terminals take in one.
fn tiles(cover: &[Cover], columns: u16, cell: (u16, u16)) -> Vec<Tile> {
    let seen =
        || (0..).zip(cover).filter(|(_, cover)| **cover != Cover::Clear).map(|(at, _)| (at % columns, at / columns));
    let span = |of: fn((u16, u16)) -> u16| Some((seen().map(of).min()?, seen().map(of).max()? + 1));
    let (Some((left, right)), Some((top, bottom))) = (span(|(x, _)| x), span(|(_, y)| y)) else { return Vec::new() };
    let (wide, high) = ((LARGEST / cell.0).max(1), (LARGEST / cell.1).max(1));
    let rows = (top..bottom).step_by(usize::from(high));
    rows.flat_map(|y| (left..right).step_by(usize::from(wide)).map(move |x| (x, y)))
        .map(|(x, y)| (x, y, wide.min(right - x), high.min(bottom - y)))
        .collect()
}

/// The picture in sixels, tile by tile.
fn sixels(picture: &Picture, inks: &Inks, cell: (u16, u16), tiles: &[Tile], scale: usize) -> Vec<Part> {
    let pixels = (0..picture.height).flat_map(|row| (0..picture.width).map(move |column| (row, column)));
    let colour = |(row, column)| portrait::ink(picture, column, row, inks.coloured).map_or(CLEAR, |ink| inks.of(ink));
    let (colours, palette): (Vec<u8>, _) = (pixels.map(colour).collect(), inks.palette());
    let size = |x: u16, y: u16| (usize::from(x) * usize::from(cell.0), usize::from(y) * usize::from(cell.1));
    let part = |&(column, row, columns, rows): &Tile| {
        let (origin, size) = (size(column, row), size(columns, rows));
        let part = Indexed { across: picture.width, colours: &colours, palette: &palette, scale, origin, size };
        Part { cell: (column, row), bytes: part.sixels() }
    };
    tiles.iter().map(part).collect()
}

/// The picture as a PNG whose ground is clear.
fn png(picture: &Picture, coloured: bool) -> Option<Vec<u8>> {
    let mut pixels = Vec::with_capacity(4 * picture.width * picture.height);
    for (row, column) in (0..picture.height).flat_map(|row| (0..picture.width).map(move |column| (row, column))) {
        if let Some(ink) = portrait::ink(picture, column, row, coloured) {
            let [red, green, blue] = ink.parts();
            pixels.extend([red, green, blue, 255]);
        } else {
            pixels.extend([0; 4]);
        }
    }
    figure::pixels_png(picture.width as u32, picture.height as u32, pixels).ok()
}

fn cover(picture: &Picture, raster: Raster, (columns, rows): (u16, u16), scale: usize) -> Vec<Cover> {
    // As large as a terminal says that its cells are.
    let pixels = |cell: u16, size: u16, end: usize| {
        let (cell, size) = (usize::from(cell), usize::from(size));
        let (first, last) = (cell * size / scale, (cell * size + size - 1) / scale);
        first.min(end)..(last + 1).min(end)
    };
    let of = |(row, column): (u16, u16)| {
        let (down, across) = (pixels(row, raster.cell.1, picture.height), pixels(column, raster.cell.0, picture.width));
        let all = down.len() * across.len();
        let seen = down.map(|y| across.clone().filter(|&x| picture.at(x, y).is_some()).count()).sum::<usize>();
        match seen {
            0 => Cover::Clear,
            seen if seen == all => Cover::Whole,
            _ => Cover::Part,
        }
    };
    (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))).map(of).collect()
}

/// The colours of sixels: so many values of the function times so many shades of each, and the line where it is 0; or
/// shades alone. They are fixed, so that nothing flickers while a shape turns.
struct Inks {
    coloured: bool,
    values: usize,
    shades: usize,
}

impl Inks {
    /// Shades that the eye tells apart on a surface; more would be more bytes.
    const SHADES: usize = 64;

    fn new(coloured: bool, most: usize) -> Self {
        let most = most.clamp(2, usize::from(CLEAR));
        if !coloured {
            return Self { coloured, values: 1, shades: most.min(Self::SHADES) };
        }
        // More values than shades: the value is what is read off.
        let shades = (((most - 1) as f32 / 1.6).sqrt() as usize).max(1);
        Self { coloured, values: (most - 1) / shades, shades }
    }

    /// The place of a colour.
    fn of(&self, ink: Ink) -> u8 {
        let step = |part: f32, steps: usize| (part.clamp(0.0, 1.0) * (steps - 1) as f32).round() as usize;
        let at = match ink {
            Ink::Nodal => self.values * self.shades,
            Ink::Plain { shade } => step(shade, self.shades),
            Ink::Valued { shade, value } => {
                step(f32::midpoint(value, 1.0), self.values) * self.shades + step(shade, self.shades)
            }
        };
        at as u8
    }

    fn palette(&self) -> Vec<[u8; 3]> {
        let part = |at: usize, steps: usize| if steps > 1 { at as f32 / (steps - 1) as f32 } else { 0.5 };
        let ink = |value: usize, shade: usize| {
            let shade = part(shade, self.shades);
            if self.coloured {
                Ink::Valued { shade, value: 2.0 * part(value, self.values) - 1.0 }
            } else {
                Ink::Plain { shade }
            }
        };
        let inks = (0..self.values).flat_map(|value| (0..self.shades).map(move |shade| ink(value, shade)));
        inks.chain(self.coloured.then_some(Ink::Nodal)).map(Ink::parts).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 40 × 40 pixels, of which the middle 20 × 20 show a shade and a value that grow to the right.
    fn picture() -> Picture {
        let mut picture =
            Picture { width: 40, height: 40, shades: vec![-1.0; 1600], values: vec![0.0; 1600], packed: None };
        for (row, column) in (10..30).flat_map(|row| (10..30).map(move |column| (row, column))) {
            picture.shades[40 * row + column] = (column - 10) as f32 / 19.0;
            picture.values[40 * row + column] = (column - 10) as f32 / 9.5 - 1.0;
        }
        picture
    }

    #[test]
    fn every_ink_has_a_colour_near_to_its_own() {
        for (coloured, most, off) in
            [(false, 16, 8), (false, 256, 3), (true, 256, 16), (true, 64, 30), (true, 16, 80), (true, 2, 255)]
        {
            let inks = Inks::new(coloured, most);
            let palette = inks.palette();
            assert!(palette.len() <= most.min(255) && palette.len() + palette.len() / 3 + 2 > most.min(64), "{most}");
            for (shade, value) in (0..=20).flat_map(|s| (0..=20).map(move |v| (s as f32 / 20.0, v as f32 / 10.0 - 1.0)))
            {
                let ink = if coloured { Ink::Valued { shade, value } } else { Ink::Plain { shade } };
                let near = palette[inks.of(ink) as usize];
                let worst = near.iter().zip(ink.parts()).map(|(a, b)| a.abs_diff(b)).max().unwrap();
                assert!(worst <= off, "{ink:?} of {most}: {near:?} for {:?}", ink.parts());
            }
            if coloured {
                assert_eq!(palette[inks.of(Ink::Nodal) as usize], [0; 3]);
            }
        }
    }

    #[test]
    fn a_cell_knows_what_covers_it() {
        use Cover::{Clear, Part, Whole};
        let raster = Raster { packing: Packing::Sixels { colours: 256 }, cell: (8, 10) };
        let packed = pack(&picture(), true, raster, (5, 4), (1, false)).unwrap();
        let middle = [Clear, Part, Whole, Part, Clear];
        assert_eq!(packed.cover, [[Clear; 5], middle, middle, [Clear; 5]].concat());
        // Twice as large, the same picture covers the same parts of cells twice as large.
        let raster = Raster { cell: (16, 20), ..raster };
        assert_eq!(pack(&picture(), true, raster, (5, 4), (2, false)).unwrap().cover, packed.cover);
        assert!(pack(&Picture::default(), true, raster, (5, 4), (1, false)).is_none());
        let raster = Raster { cell: (u16::MAX, u16::MAX), ..raster };
        assert!(pack(&picture(), true, raster, (5, 4), (u16::MAX.into(), false)).is_some());
    }

    #[test]
    fn a_picture_is_cut_to_what_is_seen_and_into_parts_that_terminals_take() {
        let raster = Raster { packing: Packing::Sixels { colours: 256 }, cell: (8, 10) };
        let packed = pack(&picture(), true, raster, (5, 4), (1, false)).unwrap();
        assert_eq!(packed.parts.iter().map(|part| part.cell).collect::<Vec<_>>(), [(1, 1)]);
        assert!(packed.parts[0].bytes.starts_with(b"\x1bP0;1q\"1;1;24;20"));
        let whole = [Cover::Whole; 6 * 3];
        let six = [(0, 0, 2, 2), (2, 0, 2, 2), (4, 0, 2, 2), (0, 2, 2, 1), (2, 2, 2, 1), (4, 2, 2, 1)];
        assert_eq!(tiles(&whole, 6, (400, 500)), six);
        assert_eq!(tiles(&whole, 6, (10, 20)), [(0, 0, 6, 3)]);
        assert_eq!(tiles(&whole, 6, (2000, 2000)).len(), 18);
        assert_eq!(tiles(&[Cover::Clear; 18], 6, (10, 20)), []);
    }

    #[test]
    fn a_rough_picture_has_fewer_bytes() {
        let raster = Raster { packing: Packing::Sixels { colours: 256 }, cell: (8, 10) };
        let bytes = |rough| pack(&picture(), true, raster, (5, 4), (1, rough)).unwrap().bytes();
        assert!(bytes(true) < bytes(false), "{} {}", bytes(true), bytes(false));
        let png = pack(&picture(), true, Raster::default(), (5, 4), (1, false)).unwrap();
        assert!(png.parts[0].bytes.starts_with(b"\x89PNG"));
    }
}

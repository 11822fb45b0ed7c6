//! A raster of dots, finer than the cells: 2 × 4 to a cell in Braille.

use super::{look::Role, pane::Pane};

/// How the dots of a line follow each other.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Stroke {
    Solid,
    Dotted,
}

/// Dots with a role for each cell; the last one drawn decides. `(0, 0)` is the upper left dot.
pub(super) struct Dots {
    columns: usize,
    rows: usize,
    bits: Vec<u8>,
    roles: Vec<Role>,
    plain: Vec<char>,
}

/// Bits of Unicode's Braille patterns, by column and row of the dot.
const BRAILLE: [[u8; 4]; 2] = [[0x01, 0x02, 0x04, 0x40], [0x08, 0x10, 0x20, 0x80]];

impl Dots {
    /// A raster of so many cells.
    pub(super) fn new(columns: u16, rows: u16) -> Self {
        let (columns, rows) = (columns as usize, rows as usize);
        let cells = columns * rows;
        Self { columns, rows, bits: vec![0; cells], roles: vec![Role::Plain; cells], plain: vec![' '; cells] }
    }

    /// Dots across and down.
    pub(super) const fn size(&self) -> (i32, i32) {
        (2 * self.columns as i32, 4 * self.rows as i32)
    }

    /// Sets one dot; `plain` stands for its cell in ASCII.
    pub(super) fn set(&mut self, x: i32, y: i32, role: Role, plain: char) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x < 2 * self.columns && y < 4 * self.rows {
            let cell = y / 4 * self.columns + x / 2;
            self.bits[cell] |= BRAILLE[x % 2][y % 4];
            self.roles[cell] = role;
            self.plain[cell] = plain;
        }
    }

    /// Draws a line between two dots, `already` dots after the stroke's beginning; returns that count at its end.
    pub(super) fn line(
        &mut self,
        from: (i32, i32),
        to: (i32, i32),
        stroke: Stroke,
        already: u32,
        role: Role,
        plain: char,
    ) -> u32 {
        // Ends far outside would take long to reach and show nothing.
        let (wide, high) = self.size();
        let hold = |(x, y): (i32, i32)| (x.clamp(-1, wide), y.clamp(-1, high));
        let ((mut x, mut y), to) = (hold(from), hold(to));
        let (dx, dy) = ((to.0 - x).abs(), -(to.1 - y).abs());
        let (sx, sy) = ((to.0 - x).signum(), (to.1 - y).signum());
        let mut error = dx + dy;
        let mut count = already;
        loop {
            if stroke == Stroke::Solid || count % 4 < 2 {
                self.set(x, y, role, plain);
            }
            if (x, y) == to {
                return count;
            }
            count += 1;
            let twice = 2 * error;
            if twice >= dy {
                error += dy;
                x += sx;
            }
            if twice <= dx {
                error += dx;
                y += sy;
            }
        }
    }

    /// Writes the cells that have a dot.
    pub(super) fn draw(&self, pane: &mut Pane<'_>, x: u16, y: u16) {
        let ascii = pane.look().ascii;
        for (cell, &bits) in self.bits.iter().enumerate().filter(|(_, bits)| **bits != 0) {
            let fine = char::from_u32(0x2800 + u32::from(bits)).unwrap_or(' ');
            let style = pane.style(self.roles[cell]);
            let (column, row) = ((cell % self.columns) as u16, (cell / self.columns) as u16);
            pane.dot(x + column, y + row, if ascii { self.plain[cell] } else { fine }, style);
        }
    }
}

#[cfg(test)]
mod tests {
    use ratatui::{buffer::Buffer, layout::Rect};

    use super::*;
    use crate::ui::Look;

    fn drawn(dots: &Dots, ascii: bool) -> String {
        let mut buffer = Buffer::empty(Rect::new(0, 0, 3, 1));
        dots.draw(&mut Pane::new(&mut buffer, Rect::new(0, 0, 3, 1), Look { ascii, ..Look::default() }), 0, 0);
        buffer.content.iter().map(ratatui::buffer::Cell::symbol).collect()
    }

    #[test]
    fn a_diagonal_is_made_of_dots() {
        let mut dots = Dots::new(2, 1);
        assert_eq!(dots.line((0, 3), (3, 0), Stroke::Solid, 0, Role::Train, '*'), 3);
        assert_eq!(drawn(&dots, false), "⡠⠊ ");
        assert_eq!(drawn(&dots, true), "** ");
    }

    #[test]
    fn lines_from_afar_end() {
        let mut dots = Dots::new(2, 1);
        dots.line((i32::MIN / 4, 0), (i32::MAX / 4, i32::MAX / 4), Stroke::Dotted, 0, Role::Train, '*');
        dots.set(-1, 0, Role::Train, '*');
        dots.set(4, 4, Role::Train, '*');
    }

    #[test]
    fn a_dotted_line_has_gaps() {
        let mut dots = Dots::new(3, 1);
        dots.line((0, 0), (5, 0), Stroke::Dotted, 0, Role::Query, 'o');
        assert_eq!(drawn(&dots, false), "⠉ ⠉");
    }
}

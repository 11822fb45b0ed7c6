//! The surface of the terminal: changed cells in, few bytes out.
//!
//! What a frame costs on a slow line is its bytes. The canvas knows what every cell shows, and so writes colours and
//! attributes only where they change, walks over short gaps by writing what is there already, and erases what is blank
//! instead of writing spaces. It uses what every terminal since the VT220 knows: CUP, CUF, EL, ECH, ED and SGR of
//! ECMA-48.

use std::{
    cell::RefCell,
    io::{self, Write as _},
    rc::Rc,
};

use ratatui::{
    backend::{Backend, ClearType, WindowSize},
    buffer::Cell,
    layout::{Position, Size},
    style::Modifier,
};
use unicode_width::{UnicodeWidthChar as _, UnicodeWidthStr as _};

use self::pen::Pen;

mod pen;

/// From so many blanks on, erasing them is shorter than writing them and moving on.
const BLANKS: usize = 12;
/// Attributes that show on a cell without a character.
const SHOWING: Modifier = Modifier::REVERSED
    .union(Modifier::UNDERLINED)
    .union(Modifier::CROSSED_OUT)
    .union(Modifier::SLOW_BLINK)
    .union(Modifier::RAPID_BLINK);

/// What is to be written, until it is written in one piece.
pub(super) type Pending = Rc<RefCell<Vec<u8>>>;

/// Tells columns and rows.
pub(super) type Measure = Box<dyn Fn() -> io::Result<Size>>;

/// What a cell shows.
#[derive(Debug, Clone, PartialEq)]
enum Shown {
    /// A character of one column.
    Plain(Cell),
    /// Something else: terminals may differ in how far it reaches.
    Odd,
    /// The second half of a wide character before it.
    Covered,
}

static EMPTY: Cell = Cell::EMPTY;

/// The surface. The cursor is hidden, and nobody else writes on it between [`Canvas::clear`] and the end.
pub(super) struct Canvas {
    pending: Pending,
    measure: Measure,
    size: Size,
    shown: Vec<Shown>,
    pen: Pen,
    /// Where the next character goes, when that is known.
    at: Option<(u16, u16)>,
}

impl Shown {
    const fn plain(&self) -> Option<&Cell> {
        match self {
            Self::Plain(cell) => Some(cell),
            Self::Odd | Self::Covered => None,
        }
    }
}

impl Canvas {
    /// A canvas on a terminal that shows nothing.
    pub(super) fn new(pending: Pending, measure: Measure) -> io::Result<Self> {
        let mut canvas =
            Self { pending, measure, size: Size::default(), shown: Vec::new(), pen: Pen::default(), at: None };
        canvas.forget()?;
        Ok(canvas)
    }

    /// Takes every cell for empty.
    fn forget(&mut self) -> io::Result<()> {
        self.size = (self.measure)()?;
        self.shown = vec![Shown::Plain(EMPTY.clone()); self.size.width as usize * self.size.height as usize];
        self.pen = Pen::default();
        self.at = None;
        Ok(())
    }

    fn place(&self, x: u16, y: u16) -> usize {
        y as usize * self.size.width as usize + x as usize
    }

    fn say(&self, text: &str) {
        self.pending.borrow_mut().extend_from_slice(text.as_bytes());
    }

    /// Takes the changes in; returns those that can be seen.
    fn take<'a>(&mut self, content: impl Iterator<Item = (u16, u16, &'a Cell)>) -> Vec<(u16, u16, &'a Cell)> {
        let mut changed = Vec::new();
        for (x, y, cell) in content {
            if x >= self.size.width || y >= self.size.height {
                continue;
            }
            let place = self.place(x, y);
            if self.shown[place].plain().is_some_and(|shown| alike(shown, cell)) {
                continue;
            }
            changed.push((x, y, cell));
            let row_end = self.place(self.size.width - 1, y) + 1;
            let mut next = place + 1;
            if simple(cell).is_some() {
                self.shown[place] = Shown::Plain(cell.clone());
            } else {
                self.shown[place] = Shown::Odd;
                let end = (place + cell.symbol().width().max(1)).min(row_end);
                self.shown[next..end].fill(Shown::Covered);
                next = end;
            }
            // The halves that are left of a wide character that was here: terminals differ in what they make of them.
            while next < row_end && self.shown[next] == Shown::Covered {
                self.shown[next] = Shown::Plain(EMPTY.clone());
                changed.push((x + (next - place) as u16, y, &EMPTY));
                next += 1;
            }
        }
        changed
    }

    /// Writes the changes of one row, in their order.
    fn row(&mut self, changes: &[(u16, u16, &Cell)]) {
        let Some(&(_, y, _)) = changes.first() else { return };
        let (start, end) = (self.place(0, y), self.place(self.size.width - 1, y) + 1);
        let empty = |shown: &Shown| shown.plain().is_some_and(blank);
        let rest = self.shown[start..end].iter().rev().take_while(|shown| empty(shown)).count();
        let blank_from = self.size.width - rest as u16;
        let mut left = changes;
        while let [(x, _, cell), ..] = left {
            if *x >= blank_from && left.len() > 3 {
                self.reach(*x, y);
                self.clean();
                self.say("\x1b[K");
                return;
            }
            let run = (*x..).zip(left).take_while(|(x, (at, _, cell))| x == at && blank(cell)).count();
            if run >= BLANKS {
                self.reach(*x, y);
                self.clean();
                self.say(&format!("\x1b[{run}X"));
                left = &left[run..];
                continue;
            }
            self.reach(*x, y);
            self.write(cell);
            self.at = (simple(cell).is_some() && x + 1 < self.size.width).then_some((x + 1, y));
            left = &left[1..];
        }
    }

    /// Writes a cell where the cursor is.
    fn write(&mut self, cell: &Cell) {
        if blank(cell) {
            self.clean();
        } else {
            self.draw_with(Pen::of(cell));
        }
        self.say(cell.symbol());
    }

    fn draw_with(&mut self, pen: Pen) {
        self.pending.borrow_mut().extend(self.pen.change(pen));
        self.pen = pen;
    }

    /// Sees to it that a blank shows nothing; its colour does not matter.
    fn clean(&mut self) {
        if self.pen.shows_on_blanks() {
            self.draw_with(Pen::default());
        }
    }

    /// Brings the cursor there by the fewest bytes.
    fn reach(&mut self, x: u16, y: u16) {
        if self.at == Some((x, y)) {
            return;
        }
        let mut way = match x {
            0 => format!("\x1b[{}H", y + 1),
            _ => format!("\x1b[{};{}H", y + 1, x + 1),
        };
        if let Some((from, row)) = self.at
            && (row == y && from < x || row + 1 == y)
        {
            let (turn, from) = if row == y { ("", from) } else { ("\r\n", 0) };
            let forward = match x - from {
                0 => String::new(),
                1 => "\x1b[C".to_owned(),
                by => format!("\x1b[{by}C"),
            };
            let over = self.over(from, x, y).filter(|over| over.len() <= forward.len());
            let other = format!("{turn}{}", over.unwrap_or(forward));
            if other.len() < way.len() {
                way = other;
            }
        }
        self.say(&way);
        self.at = Some((x, y));
    }

    /// What these cells show, where it can be written with the pen as it is.
    fn over(&self, from: u16, to: u16, y: u16) -> Option<String> {
        let cells = &self.shown[self.place(from, y)..self.place(to, y)];
        if cells.len() > 5 {
            return None;
        }
        let same = |cell: &Cell| if blank(cell) { !self.pen.shows_on_blanks() } else { Pen::of(cell) == self.pen };
        cells.iter().map(|shown| shown.plain().filter(|cell| same(cell)).map(Cell::symbol)).collect()
    }
}

/// The character of a cell that is one character of one column.
fn simple(cell: &Cell) -> Option<char> {
    let mut characters = cell.symbol().chars();
    characters.next().filter(|c| c.width() == Some(1) && characters.next().is_none())
}

/// True when nothing is to be seen of the cell.
fn blank(cell: &Cell) -> bool {
    cell.symbol() == " " && !Pen::of(cell).shows_on_blanks()
}

/// True when the cells look the same.
fn alike(one: &Cell, other: &Cell) -> bool {
    one.symbol() == other.symbol() && (Pen::of(one) == Pen::of(other) || blank(one) && blank(other))
}

impl Backend for Canvas {
    type Error = io::Error;

    fn draw<'a, I: Iterator<Item = (u16, u16, &'a Cell)>>(&mut self, content: I) -> io::Result<()> {
        let changed = self.take(content);
        for row in changed.chunk_by(|a, b| a.1 == b.1) {
            self.row(row);
        }
        // What others write after this, as at the end, has no colour of ours.
        self.draw_with(Pen::default());
        // The frame is written in one piece, and where the cursor is then is not relied on.
        self.at = None;
        Ok(())
    }

    fn hide_cursor(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn show_cursor(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn get_cursor_position(&mut self) -> io::Result<Position> {
        Ok(self.at.map_or(Position::ORIGIN, Position::from))
    }

    fn set_cursor_position<P: Into<Position>>(&mut self, position: P) -> io::Result<()> {
        let Position { x, y } = position.into();
        self.reach(x, y);
        Ok(())
    }

    fn clear(&mut self) -> io::Result<()> {
        self.forget()?;
        self.pending.borrow_mut().write_all(b"\x1b[m\x1b[2J")
    }

    fn clear_region(&mut self, _: ClearType) -> io::Result<()> {
        // The viewport is the whole screen: there are no other regions.
        self.clear()
    }

    fn size(&self) -> io::Result<Size> {
        (self.measure)()
    }

    fn window_size(&mut self) -> io::Result<WindowSize> {
        Ok(WindowSize { columns_rows: (self.measure)()?, pixels: Size::default() })
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests;
